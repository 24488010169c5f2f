"""The command `plgwear wear`: how a contact wears over its cycles, and the wear coefficient of a measured course."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from plgwear_jax._core.units import readable
from plgwear_jax._core.words import one_line
from plgwear_jax._files import check_targets, write_table
from plgwear_jax.cli import drawing
from plgwear_jax.cli.blocks import wear_blocks
from plgwear_jax.cli.computing import computing
from plgwear_jax.cli.fit import fit
from plgwear_jax.cli.question import AsJson, Picture, SceneFile, doubt_units, read_scene, refusing_scene
from plgwear_jax.cli.terminal import (
    console,
    counted,
    print_json,
    refuse,
    refusing_targets,
    table_of,
    warn,
    working,
)

if TYPE_CHECKING:
    import numpy as np

    from plgwear_jax.contact import WearOverCycles
    from plgwear_jax.scene import Scene

__all__ = ["wear"]

_SHARES = (0.01, 0.1, 0.5, 0.9, 0.99)
_TOLD = (0.5, 0.9, 0.99)
_LENGTH = 96  # numbers of cycles that are computed: one length, and so one program
_UNITS = {
    "cycles": "1",
    "volume": "m^3",
    "deepest_wear": "m",
    "contact_radius": "m",
    "volume_per_cycle": "m^3",
    "energy_per_cycle": "J",
}

_HEADINGS = {
    "volume": "worn\nvolume",
    "deepest_wear": "deepest\nwear",
    "contact_radius": "contact\nradius",
    "volume_per_cycle": "wear\na cycle",
    "energy_per_cycle": "energy\na cycle",
}


def wear(
    scene_file: SceneFile,
    as_json: AsJson = False,
    picture: Picture = None,
    csv_file: Annotated[
        Path | None,
        typer.Option("--csv", help="A .csv file to write the course to, in SI units.", show_default=False),
    ] = None,
    measured: Annotated[
        Path | None,
        typer.Option(
            "--fit",
            help="A CSV file of measured volumes, with the columns cycles, volume (m^3) and if known deviation (m^3): "
            "find the wear coefficient instead.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Show how the contact of a scene wears over its cycles, by Archard's law with the coefficient under [wear].

    The amplitude of the force is constant, or with control = "displacement" under [load] that of the displacement. The
    wear a cycle first rises and then falls, since the worn ring gives its load away, and ends in the steady state.

    Example: plgwear wear design/electrical_contact.toml --csv course.csv
    """
    given = read_scene(scene_file)
    _refuse_without_amplitude(scene_file, given, one=measured is not None)
    if measured is not None:
        if csv_file is not None:
            refuse("--csv: a fit writes no course; put the coefficient that it finds into the scene")
        fit(scene_file, given, measured, picture, as_json)
        return
    if given.wear is None:
        refuse(f"{scene_file}: [wear]: missing; it gives the wear coefficient, such as coefficient = 1e-14 in 1/Pa")
    if given.load is not None and given.load.cycles is not None:
        wear_blocks(scene_file, given, picture, csv_file, as_json)
        return
    picture = picture or Path(f"{scene_file.stem}-wear.png")
    with refusing_targets():
        check_targets(picture, csv_file)
        # The closed forms are many small programs, which JAX's cache keeps.
        with computing("wearing it", one_question=not given.is_closed):
            with refusing_scene(scene_file):
                assert given.load is not None
                given.load.largest  # noqa: B018
            coefficient = given.wear.archard(given.contact.friction)  # pyright: ignore[reportAttributeAccessIssue]
            shares, course = _computed(given, coefficient)
        import numpy as np

        _refuse_extremes(scene_file, course)
        with working("drawing it"):
            plots = drawing.plots()
            plots.save(plots.wear_picture(course, [shares[x] for x in (0.1, 0.5, 0.9)], given.wear.cycles), picture)
        if csv_file is not None:
            write_table(csv_file, {name: _of(course, name) for name in _UNITS})
    doubt_units(scene_file, given, course.worn_radius)
    if shares[0.99] < 100.0:
        doubt = "is its unit right? 1e-5 mm^3/(N m) is 1e-14 1/Pa"
        warn(f"{scene_file}: [wear]: 99 % is worn after {shares[0.99]:.2g} cycles with {coefficient:g} 1/Pa; {doubt}")
    told = _rows_told(course, shares, given.wear.cycles)
    if as_json:
        print_json(_as_json(scene_file, given, coefficient, course, shares, told) | {"picture": str(picture)})
        return
    if given.load is not None and given.load.remark is not None:
        typer.echo(given.load.remark)
    _print_course(scene_file, course, told)
    if given.wear.cycles is not None:
        worn = float(course.volume[np.argmin(np.abs(course.cycles - given.wear.cycles))])
        share = 100.0 * worn / course.steady_volume
        unit, name = readable(course.steady_volume, "m^3")  # that of the table
        life = f"the life of {counted(given.wear.cycles)} cycles"
        typer.echo(f"{_rounded(worn / unit)} {name} after {life}: {share:.3g} %")
    reached = ", ".join(f"{100.0 * share:g} % after {counted(float(f'{shares[share]:.3g}'))}" for share in _TOLD)
    assert given.load is not None
    typer.echo(f"at a constant {given.load.control} amplitude {reached} cycles are worn")
    for kind, file in (("picture", picture), ("table", csv_file)):
        if file is not None:
            typer.echo(f"{kind}: {one_line(str(file))}")


def _refuse_without_amplitude(scene_file: Path, given: "Scene", one: bool) -> None:
    """Refuse a scene that has not one amplitude of partial slip, or blocks of cycles where that will do."""
    load = given.load
    if load is None:
        refuse(f'{scene_file}: [contact] kind = "gross-slip": only a fretting contact wears over cycles')
    if load.table is not None:
        refuse(f"{scene_file}: [load] table: wear over cycles is of one amplitude: tangential_force or displacement")
    if load.history is not None and (one or load.cycles is None):
        text = "its amplitudes have no cycles: add a column cycles to it, or give one amplitude"
        if load.cycles is not None:
            text = "a coefficient is fitted to a test with one amplitude, tangential_force or displacement"
        refuse(f"{scene_file}: [load] history: {text}")
    if load.is_zero:
        refuse(f"{scene_file}: [load]: an amplitude of 0: nothing wears")


def _computed(given: "Scene", coefficient: float) -> "tuple[dict[float, float], WearOverCycles]":
    """The cycles to some shares of the final volume, and the course at those, at decades and between."""
    import numpy as np

    from plgwear_jax.contact import FrettingContact, cycles_to_shares, wear_over_cycles

    contact, load = given.build_contact(), given.load
    assert isinstance(contact, FrettingContact) and load is not None and given.wear is not None
    held: dict[str, Any] = {"control": load.control} | (
        {"rig_stiffness": load.rig_stiffness} if load.control != "force" else {}
    )
    found = cycles_to_shares(contact, load.largest, coefficient, np.array(_SHARES), **held)
    shares = dict(zip(_SHARES, found.tolist(), strict=True))
    life = given.wear.cycles
    ends = [*found, *([] if life is None else [life])]
    first, last = min(ends), max(ends)
    if not (0.0 < first <= last < math.inf):
        first = last = 1.0  # refused as too extreme by whoever reads the volumes
    decades = 10.0 ** np.arange(math.floor(math.log10(first)), math.ceil(math.log10(last)) + 1)
    known = np.unique(np.concatenate([ends, decades]))[: _LENGTH - 2]
    between = np.geomspace(known[0], known[-1], _LENGTH - known.size)
    cycles = np.sort(np.concatenate([known, between]))
    return shares, wear_over_cycles(contact, load.largest, coefficient, cycles, **held)


def _refuse_extremes(scene_file: Path, course: "WearOverCycles") -> None:
    import numpy as np

    if not np.all(np.isfinite(course.volume)) or not course.steady_volume > 0.0:
        refuse(f"{scene_file}: the wear exceeds the range of numbers: some value in the scene is too extreme")


def _rows_told(course: "WearOverCycles", shares: dict[float, float], life: float | None) -> list[int]:
    """The places of the decades, of the life and of the end in the course."""
    import numpy as np

    first, last = shares[0.01], max(shares[0.99], life or 0.0)
    decades = [10.0**i for i in range(math.floor(math.log10(first)), math.ceil(math.log10(last)) + 1)]
    wanted = sorted({*decades, *([] if life is None else [life])})
    return [int(np.argmin(np.abs(np.log(course.cycles / number)))) for number in wanted]


def _print_course(scene_file: Path, course: "WearOverCycles", told: list[int]) -> None:
    table = table_of(scene_file)
    steady = {
        "volume": course.steady_volume,
        "deepest_wear": float(course.steady_depth.max()),
        "contact_radius": course.worn_radius,
        "volume_per_cycle": 0.0,
        "energy_per_cycle": 0.0,
    }
    table.add_column("cycles\n\n", justify="right", no_wrap=True)
    factors, units = {}, {}
    for name, heading in _HEADINGS.items():
        largest = max(steady[name], float(_of(course, name)[told].max()))
        factors[name], units[name] = readable(largest, _UNITS[name])
        if (
            name == "volume_per_cycle" and largest > 0.0
        ):  # in the unit of the volume, of so many cycles that it can be read there
            count = 10.0 ** max(0, math.ceil(math.log10(factors["volume"] / largest)))
            factors[name], units[name] = factors["volume"] / count, units["volume"]
            heading = f"wear of\n{count:g} cycles" if count > 1.0 else heading
        unit = units[name]
        table.add_column(f"{heading}\n{unit}", justify="right", no_wrap=True)
        if name == "volume":
            table.add_column("share\n\n%", justify="right", no_wrap=True)

    def row(cycles: str, values: dict[str, float]) -> list[str]:
        share = 100.0 * values["volume"] / course.steady_volume
        numbers = [f"{_rounded(values[name] / factor)}" for name, factor in factors.items()]
        return [cycles, numbers[0], _rounded(share), *numbers[1:]]

    for i in told:
        table.add_row(*row(counted(float(course.cycles[i])), {name: float(_of(course, name)[i]) for name in factors}))
    table.add_section()
    table.add_row(*row("steady state", steady))
    console().print(table)


def _rounded(number: float) -> str:
    return f"{number:.4g}" if abs(number) >= 1e-3 else f"{number:.1e}" if number else "0"


def _as_json(
    scene_file: Path,
    given: "Scene",
    coefficient: float,
    course: "WearOverCycles",
    shares: dict[float, float],
    told: list[int],
) -> dict[str, Any]:
    assert given.load is not None and given.wear is not None
    return {
        "scene": str(scene_file),
        "tangential_force": given.load.largest,
        "control": given.load.control,
        "wear_coefficient": coefficient,
        "life": given.wear.cycles,
        **{name: _of(course, name)[told] for name in _UNITS},
        "units": _UNITS | {"tangential_force": "N", "wear_coefficient": "1/Pa"},
        "steady_state": {
            "volume": course.steady_volume,
            "deepest_wear": course.steady_depth.max(),
            "stick_radius": course.stick_radius,
            "worn_radius": course.worn_radius,
        },
        "cycles_to": {f"{share:g}": shares[share] for share in _TOLD},
    }


def _of(course: "WearOverCycles", name: str) -> "np.ndarray":
    return getattr(course, name)
