"""The commands `plgwear new`, a scene to start from, and `plgwear schema`, with which editors check it."""

import json
import shlex
from pathlib import Path
from typing import Annotated, Literal

import typer

from plgwear_jax._core import files
from plgwear_jax._core.words import one_line

from .terminal import refuse

FRETTING = """\
[material]                  # the coating of today, for comparison
E0 = 200e9                  # Pa, the modulus at the depth z0
z0 = 1e-4                   # m
k = 0.0                     # the exponent, -1 < k < 1
nu = 0.25                   # Poisson's ratio, or "holl"

                            # instead of E0, z0 and k a measured E(z):
# table = "E_of_z.csv"      # columns depth, modulus, such as modulus (GPa)
                            # or instead of E0, z0 and k layers:
# thickness = [5e-4]        # m, of each layer, from the surface downwards
# modulus = [200e9, 210e9]  # Pa, of each layer, and last of the substrate

[contact]                   # the indenter wears: a ball of steel
kind = "fretting"           # "gross-slip" is a flat punch at a fixed depth
radius = 0.0125             # m, of the indenter
normal_force = 50.0         # N
friction = 0.6
indenter = { E = 210e9, nu = 0.3 }  # elastic; without this line rigid
# shape = { kind = "power", exponent = 4 }  # or "cone", "rounded_flat", ...

[load]
tangential_force = 22.0     # N, amplitude, below friction * normal_force
                            # instead of the force a displacement; beyond
                            # what plgwear regimes says it is gross slip:
# displacement = 1e-6       # m, amplitude (half the stroke) at the contact,
# rig_stiffness = 2e7       # N/m; with this line that of the actuator
                            # or instead a file of many amplitudes:
# table = "loads.csv"       # with weights: columns tangential_force, weight
# history = "cycles.csv"    # in their order: tangential_force, cycles

[wear]                      # for plgwear wear, and design for a life
coefficient_mm3_per_N_m = 3e-5      # a placeholder: put in a measured one
                            # instead of it coefficient, in 1/Pa,
                            # or energy_coefficient_mm3_per_J
# cycles = 1e6              # the life; else until nothing wears any more

[design]
vary = { k = [-0.9, 0.9] }  # between these bounds; of layers such as
                            # { "material.thickness[0]" = [1e-4, 1e-3] }
hold = "contact_radius"     # keep it by adjusting E0. Delete this line for
                            # layers, a table, or to vary E0 or z0 as well
minimise = "wear_volume"    # or "worn_radius", "deepest_wear"
# over = { cvar = 0.9 }     # for a table; or "mean", "worst"

[design.limits]             # moduli that your process can make; delete
                            # both lines for layers or a table
modulus.at = [1.6e-6, 4.9e-4]                        # m, two depths
modulus.between = [[80e9, 350e9], [80e9, 350e9]]     # Pa, at each
# edge_pressure = { below = 2.5e9, distance = 1e-5 } # Pa, m
# penetration = { below = 3e-6 }                     # m
# contact_radius = { above = 1e-4, below = 2e-4 }    # m, without hold

[output]
quantities = ["contact_radius", "peak_initial_pressure", "stick_radius",
              "worn_radius", "wear_volume", "deepest_wear"]
# distance = 1e-5  # m, inside the stick-slip boundary, for "edge_pressure"
"""

_GROSS_SLIP = """\
[material]
E0 = 100e9                  # Pa, the modulus at the depth z0
z0 = 1e-3                   # m
k = 0.0                     # the exponent, -1 < k < 1
nu = 0.3                    # Poisson's ratio, or "holl"

[contact]
kind = "gross-slip"         # a rigid flat punch that wears until its pressure is uniform; or "fretting"
radius = 0.002              # m, of the punch
depth = 1e-6                # m, held while it slides

[design]
vary = { k = [-0.9, 0.9] }  # between these bounds
minimise = "volume_change"  # or "force_drop"

[design.limits]             # moduli that your process can make
modulus.at = [2e-5, 6e-3]                           # m, two depths
modulus.between = [[50e9, 200e9], [50e9, 200e9]]    # Pa, at each

[output]
quantities = ["volume_change", "initial_force", "steady_force", "steady_displacement"]
"""

_HEAD = """\
# A contact for plgwear. All numbers are in SI units. Text after # is a comment.
#
#   plgwear solve {name}     the quantities under [output]: is the contact what you think it is?
#   plgwear design {name}    the best coating within [design], and a picture of it
#
# To have an editor check and complete this file, run `plgwear schema > scene.schema.json` in this folder and make this
# the first line of the file:
#:schema ./scene.schema.json

"""


def new(
    scene_file: Annotated[
        Path,
        typer.Argument(metavar="SCENE.toml", help="The file to write. It must not exist yet.", show_default=False),
    ],
    kind: Annotated[
        Literal["fretting", "gross-slip"],
        typer.Option(
            help="A ball that vibrates, in partial or gross slip, or a flat punch that slides at a fixed depth."
        ),
    ] = "fretting",
) -> None:
    """Write an input file to start from, complete and with comments.

    Example: plgwear new contact.toml, then change its numbers, then plgwear solve contact.toml
    """
    if scene_file.exists():
        refuse(f"{scene_file}: exists already; name another file")
    text = _HEAD.format(name=shlex.quote(one_line(scene_file.name))) + (FRETTING if kind == "fretting" else _GROSS_SLIP)
    files.check_target(scene_file, (".toml",))
    files.write(scene_file, lambda path: path.write_text(text, encoding="utf-8"))
    name = one_line(str(scene_file))
    file = shlex.quote(name)
    typer.echo(f"{name}: written; next: plgwear solve {file}, then plgwear design {file}")


def schema() -> None:
    """Print the JSON schema of an input file, with which editors check and complete it.

    Example: plgwear schema > scene.schema.json
    """
    from plgwear_jax import scene

    typer.echo(json.dumps(scene.json_schema(), indent=2))
