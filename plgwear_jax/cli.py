"""The script `plgwear`: a scene file in, a table, a JSON object or a picture out.

What is wrong with the input is said in one line on standard error, and the exit code is then 2.
"""

import io
import json
import math
import sys
from pathlib import Path
from typing import Annotated, Any, NoReturn

import jax
import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from plgwear_jax import __version__, optimise, plots, scene
from plgwear_jax.contact import FrettingContact

__all__ = ["app", "main"]

app = typer.Typer(
    name="plgwear",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
)

SceneFile = Annotated[Path, typer.Argument(metavar="SCENE.toml", help="The scene file.", show_default=False)]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object, in SI units, instead of tables.")]


def main() -> None:
    """Run the script, in double precision."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # a terminal without µ
    jax.config.update("jax_enable_x64", True)
    app()


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"plgwear {__version__}")
        raise typer.Exit


@app.callback()
def plgwear(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Print the version and leave.")
    ] = False,
) -> None:
    """Wear of contacts with graded coatings whose modulus follows a power of the depth, E(z) = E0 (z/z0)^k.

    A scene file in TOML says what the coating, the contact and the load are. A complete one:

        [material]
        E0 = 110e9                  # Pa, the modulus at the depth z0
        z0 = 1e-4                   # m
        k = 0.0                     # the exponent, -1 < k < 1
        nu = 0.3                    # Poisson's ratio, or "holl"

        [contact]
        kind = "fretting"           # or "gross-slip", with radius and depth
        radius = 0.005              # m, of the indenter
        normal_force = 10.0         # N
        friction = 0.4

        [load]
        tangential_force = 0.32     # N, below friction times normal_force

        [design]
        vary = { k = [-0.9, 0.9] }  # between these bounds
        hold = "contact_radius"     # by the choice of E0; may be left out
        minimise = "wear_volume"

        [output]
        quantities = ["wear_volume", "profile"]

    Then `plgwear solve SCENE.toml` computes the quantities, `plgwear design SCENE.toml` finds the best coating.
    """


# --- solve ----------------------------------------------------------------------------------------------------------


@app.command()
def solve(
    scene_file: SceneFile,
    as_json: AsJson = False,
    digits: Annotated[
        int | None,
        typer.Option(
            min=1, max=15, help="Correct digits wanted; fewer run faster. By default all.", show_default=False
        ),
    ] = None,
) -> None:
    """Compute the quantities that a scene asks for under [output], or all single numbers if it has no such section.

    Functions of the radius are summed up by their largest value; --json gives them whole.

    Example: plgwear solve design/electrical_contact.toml
    """
    quantities = _read(scene_file).solve(digits=digits)
    for name, quantity in quantities.items():
        values = np.asarray(quantity.value)
        if np.any(np.isnan(values)) or (quantity.radii is None and np.isinf(values)):
            _refuse(f"{scene_file}: {name} exceeds the range of numbers: some value in the scene is too extreme")
    if as_json:
        _print_json({"scene": str(scene_file), "quantities": {name: _listed(q) for name, q in quantities.items()}})
    else:
        _print_quantities(scene_file, quantities)


def _listed(quantity: scene.Quantity) -> dict[str, Any]:
    known = {"value": quantity.value, "unit": quantity.unit, "description": quantity.description}
    return known if quantity.radii is None else known | {"radii": quantity.radii, "radii_unit": "m"}


def _print_quantities(scene_file: Path, quantities: dict[str, scene.Quantity]) -> None:
    table = _table(scene_file)
    table.add_column("quantity", no_wrap=True)
    table.add_column("value", justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    along = any(quantity.radii is not None for quantity in quantities.values())
    if along:
        table.add_column("at r", no_wrap=True)
    table.add_column("meaning")
    for name, quantity in quantities.items():
        value, place, meaning = quantity.value, "", quantity.description
        if isinstance(value, np.ndarray) and quantity.radii is not None:
            extreme = 0 if quantity.unbounded_at else int(np.argmax(np.abs(value)))
            value, place = float(value[extreme]), _measure(quantity.radii[extreme], "m")
            meaning += f"; unbounded at {quantity.unbounded_at}" if quantity.unbounded_at else "; largest"
        number, _, unit = _measure(float(value), quantity.unit).partition(" ")
        table.add_row(name, number, unit, *([place] if along else []), meaning)
    _console().print(table)


# --- design ---------------------------------------------------------------------------------------------------------


@app.command()
def design(
    scene_file: SceneFile,
    as_json: AsJson = False,
    picture: Annotated[
        Path | None,
        typer.Option(
            help="Where to draw the picture: a .png, .pdf or .svg file. By default SCENE-design.png in this folder.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Find the coating that wears least, within the bounds that a scene gives under [design], and draw it.

    The reference that it is compared with is the scene's own [material]. The exit code is 1 if the search did not end
    at a minimum, or a scan of the whole design space found less wear elsewhere.

    Example: plgwear design design/electrical_contact.toml --picture best.pdf
    """
    given = _read(scene_file)
    contact = given.build_contact()
    if given.design is None:
        _refuse(f"{scene_file}: [design]: missing; it says what may vary")
    assert given.load is not None and isinstance(contact, FrettingContact)  # a scene with [design] has both
    force, bounds, hold = given.load.tangential_force, given.design.vary.bounds, given.design.hold
    if force == 0.0:
        _refuse(f"{scene_file}: [load] tangential_force = {force}: nothing wears, so there is nothing to design")
    picture = picture or Path(f"{scene_file.stem}-design.png")
    try:
        plots.check_target(picture)
        found = _search(scene_file, contact, force, given.design)
        plots.save(plots.design_picture(found, force, bounds, hold=hold), picture)
    except plots.PictureError as error:
        _refuse(str(error))

    best, reference = _described(found.contact, force), _described(found.reference, force)
    less_wear = 100.0 * (1.0 - best["wear_volume"] / reference["wear_volume"])
    if as_json:
        vary = {name: {"bounds": bounds[name], "at_bound": found.at_bound[name]} for name in bounds}
        _print_json(
            {
                "scene": str(scene_file),
                "best": best,
                "reference": reference,
                "units": _UNITS,
                "less_wear_percent": less_wear,
                "vary": vary,
                "hold": hold,
                "converged": found.converged,
                "certified": found.certified,
                "picture": str(picture),
            }
        )
    else:
        _print_design(scene_file, found, best, reference, less_wear, bounds)
        typer.echo(f"picture: {scene.one_line(str(picture))}")
    if not found.converged:
        _warn(f"{scene_file}: the search did not converge; this is the best found")
    elif not found.certified:
        _warn(f"{scene_file}: a scan found less wear elsewhere between the bounds")
    if not found.certified:
        raise typer.Exit(1)


_UNITS = {
    "k": "1",
    "z0": "m",
    "E0": "Pa",
    "wear_volume": "m^3",
    "contact_radius": "m",
    "stick_radius": "m",
    "worn_radius": "m",
    "edge_exponent": "1",
}


def _search(scene_file: Path, contact: FrettingContact, force: float, space: scene.Design) -> optimise.Design:
    try:
        with Console(stderr=True).status("looking for the least wear ..."):
            found = optimise.design(contact, force, space.vary.bounds, hold=space.hold)
    except ValueError as error:  # such as a modulus beyond the range of numbers
        _refuse(f"{scene_file}: some value in the scene is too extreme: {error}")
    if not (found.wear_volume > 0.0 and math.isfinite(found.wear_volume + found.reference_wear_volume)):
        _refuse(f"{scene_file}: the wear exceeds the range of numbers: some value in the scene is too extreme")
    return found


def _described(contact: FrettingContact, force: float) -> dict[str, float]:
    """What a design is judged by, in SI units."""
    material = contact.material
    quantities = {
        "k": material.k,
        "z0": material.z0,
        "E0": material.E0,
        "wear_volume": contact.wear_volume(force),
        "contact_radius": contact.contact_radius(),
        "stick_radius": contact.stick_radius(force),
        "worn_radius": contact.worn_radius(force),
        "edge_exponent": 0.5 * (material.k - 1.0),
    }
    return {name: float(value) for name, value in quantities.items()}


def _print_design(
    scene_file: Path,
    found: optimise.Design,
    best: dict[str, float],
    reference: dict[str, float],
    less_wear: float,
    bounds: dict[str, tuple[float, float]],
) -> None:
    meanings = {
        "k": "exponent k",
        "E0": "modulus E0 ...",
        "z0": "... at the depth z0",
        "wear_volume": "wear volume",
        "contact_radius": "contact radius",
        "stick_radius": "worn ring, inner (stick) radius",
        "worn_radius": "worn ring, outer radius",
        "edge_exponent": "stress at the edge, exponent (k-1)/2",
    }
    table = _table(scene_file)
    table.add_column("")
    table.add_column("best", justify="right", no_wrap=True)
    table.add_column("reference", justify="right", no_wrap=True)
    for name, meaning in meanings.items():
        table.add_row(meaning, _measure(best[name], _UNITS[name]), _measure(reference[name], _UNITS[name]))
    table.add_section()
    table.add_row("less wear than the reference", f"{less_wear:.3g} %")
    for name, ends in bounds.items():
        lower, upper = (_measure(end, _UNITS[name]) for end in ends)
        side = found.at_bound[name]
        table.add_row(f"{name} from {lower} to {upper}", f"at the {side} bound" if side else "between")
    table.add_row("the search converged", "yes" if found.converged else "NO")
    table.add_row("a scan found nothing better", "yes" if found.certified else "NO")
    _console().print(table)


# --- words ----------------------------------------------------------------------------------------------------------


def _read(scene_file: Path) -> scene.Scene:
    try:
        return scene.load(scene_file)
    except scene.SceneError as error:
        _refuse(str(error))


def _refuse(line: str) -> NoReturn:
    _warn(line)
    raise typer.Exit(2)


def _warn(line: str) -> None:
    typer.echo(scene.one_line(line), err=True)


def _console() -> Console:
    return Console(markup=False, highlight=False, emoji=False)


def _table(scene_file: Path) -> Table:
    return Table(title=scene.one_line(str(scene_file)), title_justify="left", title_style="bold")


def _measure(value: float, unit: str) -> str:
    """A number with its unit, as a person writes it."""
    factor, name = plots.readable(value, unit)
    return f"{value / factor:.4g} {name}".rstrip()


def _print_json(found: dict[str, Any]) -> None:
    typer.echo(json.dumps(_plain(found), allow_nan=False))


def _plain(value: Any) -> Any:
    """The same in what JSON has; a number that is not finite becomes null."""
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items()}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
