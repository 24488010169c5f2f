"""The pictures of single pages: a map of a sweep, the regimes of slip, a synthetic laboratory test, a measured coating.

They go into the folder above that of the studies, but for the coating. Its contact radius, and that of its test, are
those that Jitcharoen et al. (1998) measured: 0.3895 mm.
"""

from pathlib import Path

import numpy as np
from drawing import HERE, run, save
from matplotlib.figure import Figure

from plgwear_jax import FrettingContact, PowerLawGraded, coating, fitting, loads, plots, scene, tables
from plgwear_jax.contact import slip_regimes
from plgwear_jax.plots.maps import map_picture
from plgwear_jax.sweep import sweep

MEASURED = 0.3895e-3  # m


def main(out: Path, points: int = 401) -> None:
    folder = out.parent
    volume = sweep(["wear_volume"], k=np.linspace(-0.95, 0.95, points), phi=np.linspace(0.01, 0.99, points))
    save(map_picture(volume), folder / "map.png")

    contact = FrettingContact(PowerLawGraded(110e9, 1e-4, 0.5, 0.3), radius=5e-3, normal_force=10.0, friction=0.4)
    onset = float(contact.steady(0.0).gross_slip_displacement)
    found = slip_regimes(contact, onset * np.geomspace(0.03, 30.0, 81), np.geomspace(1.0, 100.0, 41))
    cut = slip_regimes(contact, onset * np.linspace(0.01, 2.5, 201), [10.0])
    save(plots.regimes_picture(found, cut, np.array([0.5 * onset])), folder / "regimes.png")

    laboratory = HERE.parent / "docs" / "laboratory"
    tested = scene.load(laboratory / "test.toml").build_contact()
    assert isinstance(tested, FrettingContact)
    volumes = tables.read(laboratory / "volumes.csv", tables.MEASURED)
    test = loads.Displacement(1e-5, rig_stiffness=2e7)
    columns = (volumes[name] for name in ("cycles", "volume", "deviation"))
    fit = fitting.fit_wear_coefficient(tested, test, *columns)
    save(plots.fit_picture(fit, points="synthetic"), folder / "laboratory_test.png")

    save(draw_coating(), out / "alumina_glass-coating.png")


def draw_coating() -> Figure:
    """The coating of alumina_glass.csv under the ball of alumina_glass.toml, with the measured contact radius."""
    given = scene.load(HERE / "coatings" / "alumina_glass.toml")
    contact = given.build_contact()
    assert isinstance(contact, FrettingContact) and given.load is not None
    return plots.coating_picture(*coating.studied(contact, given.load.largest), measured_radius=MEASURED)


if __name__ == "__main__":
    run(main)
