"""The command `plgwear wear`: how a contact wears over its cycles, and the wear coefficient from measured volumes."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from plgwear_jax._core.units import readable
from plgwear_jax.catalogue import entry
from plgwear_jax.cli.computing import computing
from plgwear_jax.cli.question import AsJson, Picture, SceneFile, csv_option, doubt_units, read_scene, refuse_extremes
from plgwear_jax.cli.report import Column, Report, counted, fields, measure, rounded, shared, units_of
from plgwear_jax.cli.terminal import refuse, warn

if TYPE_CHECKING:
    import numpy as np

    from plgwear_jax.contact import FrettingContact, WearOverCycles
    from plgwear_jax.scene import Scene
    from plgwear_jax.tables import Measured

_SHARES = (0.01, 0.1, 0.5, 0.9, 0.99)
_REPORTED = (0.5, 0.9, 0.99)
_LENGTH = 96  # numbers of cycles that are computed: always as many, so that all scenes need the same program


def wear(
    scene_file: SceneFile,
    as_json: AsJson = False,
    picture: Picture = None,
    csv_file: Annotated[Path | None, csv_option("the course")] = None,
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
    wear per cycle first rises. It then falls, since the worn ring sheds its load to the stick zone, and ends in the
    steady state.

    Example: plgwear wear design/electrical_contact.toml --csv course.csv
    """
    given = read_scene(scene_file)
    load, stem = _load_of(scene_file, given, one=measured is not None), scene_file.stem
    if measured is not None:
        from plgwear_jax import tables

        if csv_file is not None:
            refuse("--csv: a fit writes no course; put the coefficient that it finds into the scene")
        data = tables.read_measured(measured)
        if not (data.volume[data.cycles > 0.0] > 0.0).any():
            refuse(f"{data.name}: volume: nothing is worn after any cycles, so that no wear coefficient can be told")
        _fit(scene_file, given, data, Report(scene_file, as_json, picture or Path(f"{stem}-fit.png")))
        return
    if given.wear is None:
        refuse(f"{scene_file}: [wear]: missing; it gives the wear coefficient, such as coefficient = 1e-14 in 1/Pa")
    report = Report(scene_file, as_json, picture or Path(f"{stem}-wear.png"), csv_file)
    (_course if load.cycles is None else _blocks)(scene_file, given, report)


def _load_of(scene_file: Path, given: "Scene", one: bool) -> Any:
    """The load of a scene; refused unless it is one amplitude or, if not `one`, blocks with numbers of cycles."""
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
    return load


def _contact(given: "Scene") -> "tuple[FrettingContact, float, dict[str, Any]]":
    """(The contact of a scene, its wear coefficient or NaN, keyword arguments for the control of its load)."""
    from plgwear_jax.contact import FrettingContact

    contact, load = given.build_contact(), given.load
    assert isinstance(contact, FrettingContact) and load is not None
    friction = float(contact.friction)  # pyright: ignore[reportArgumentType]
    held = {} if load.control == "force" else {"control": load.control, "rig_stiffness": load.rig_stiffness}
    return contact, math.nan if given.wear is None else given.wear.archard(friction), held


# --- one amplitude --------------------------------------------------------------------------------------------------


def _course(scene_file: Path, given: "Scene", report: Report) -> None:
    """Report how the contact wears under one amplitude."""
    load = given.load
    assert load is not None and given.wear is not None
    life = given.wear.cycles
    # The closed forms are many small programs, which JAX's cache keeps.
    with computing("wearing it", one_question=not given.is_closed):
        import numpy as np

        coefficient, shares, course = _computed(given, life)
    refuse_extremes(scene_file, np.all(np.isfinite(course.volume)) and course.steady_volume > 0.0)
    report.draw("wear_picture", course, [shares[share] for share in (0.1, 0.5, 0.9)], life)
    names = "cycles", "volume", "deepest_wear", "contact_radius", "volume_per_cycle", "energy_per_cycle"
    columns: dict[str, np.ndarray] = fields(course, *names)
    _, once = np.unique(course.cycles, return_index=True)
    report.write_table({name: values[once] for name, values in columns.items()})
    doubt_units(scene_file, given, course.worn_radius)
    if shares[0.99] < 100.0:
        doubt = "is its unit right? 1e-5 mm^3/(N m) is 1e-14 1/Pa"
        warn(f"{scene_file}: [wear]: 99 % is worn after {shares[0.99]:.2g} cycles with {coefficient:g} 1/Pa; {doubt}")
    at = _rows(course, shares, life)
    rows = {name: values[at] for name, values in columns.items()}
    steady = {
        "volume": course.steady_volume,
        "deepest_wear": float(course.steady_depth.max()),
        "stick_radius": course.stick_radius,
        "worn_radius": course.worn_radius,
    }
    report.put(
        tangential_force=load.largest,
        control=load.control,
        wear_coefficient=coefficient,
        life=life,
        **rows,
        units=units_of((*names, "tangential_force", "wear_coefficient")),
        steady_state=steady,
        cycles_to={f"{share:g}": shares[share] for share in _REPORTED},
    )
    report.say(load.remark)
    if report.in_words:
        report.table(*_columns(rows, steady))
        if life is not None:
            worn = float(course.volume[np.argmin(np.abs(course.cycles - life))])
            unit, name = readable(course.steady_volume, entry("volume").unit)  # that of the table
            share = 100.0 * worn / course.steady_volume
            report.say(f"{rounded(worn / unit)} {name} after the life of {counted(life)} cycles: {share:.3g} %")
    reached = ", ".join(f"{100.0 * share:g} % after {counted(float(f'{shares[share]:.3g}'))}" for share in _REPORTED)
    report.say(f"at a constant {load.control} amplitude {reached} cycles are worn")
    report.end()


def _computed(given: "Scene", life: float | None) -> "tuple[float, dict[float, float], WearOverCycles]":
    """(The wear coefficient, the cycles to some shares of the final volume, the course at these cycles and between)."""
    import numpy as np

    from plgwear_jax.contact.engines import run_of
    from plgwear_jax.contact.over_cycles import read

    assert given.load is not None
    contact, coefficient, held = _contact(given)
    run = run_of(contact, given.load.largest, coefficient, **held)
    found = np.asarray(run.cycles_to(np.array(_SHARES)))
    ends = [*found, *([] if life is None else [life])]
    first, last = min(ends), max(ends)
    if not (0.0 < first <= last < math.inf):
        first = last = 1.0  # refused as too extreme by whoever reads the volumes
    decades = 10.0 ** np.arange(math.floor(math.log10(first)), math.ceil(math.log10(last)) + 1)
    known = np.unique(np.concatenate([ends, decades]))[: _LENGTH - 2]
    between = np.geomspace(known[0], known[-1], _LENGTH - known.size)
    cycles = np.sort(np.concatenate([known, between]))
    shares = dict(zip(_SHARES, found.tolist(), strict=True))
    return coefficient, shares, read(run, cycles)


def _rows(course: "WearOverCycles", shares: dict[float, float], life: float | None) -> list[int]:
    """The indices in the course of the decades of cycles and of the life."""
    import numpy as np

    first, last = shares[0.01], max(shares[0.99], life or 0.0)
    decades = [10.0**i for i in range(math.floor(math.log10(first)), math.ceil(math.log10(last)) + 1)]
    wanted = sorted({*decades, *([] if life is None else [life])})
    return [int(np.argmin(np.abs(np.log(course.cycles / number)))) for number in wanted]


def _columns(rows: "dict[str, np.ndarray]", steady: dict[str, float]) -> list[Column]:
    volume, wear = steady["volume"], rows["volume_per_cycle"]
    largest = max(volume, float(rows["volume"].max()))
    # The wear is given per `count` cycles, a power of ten, so that it is readable in the unit of the volume.
    unit, most = readable(largest, entry("volume").unit)[0], float(wear.max())
    count = 10.0 ** max(0, math.ceil(math.log10(unit / most))) if most > 0.0 else 1.0
    heading = f"wear of\n{count:g} cycles" if count > 1.0 else None
    return [
        Column("cycles\n\n", [counted(cycles) for cycles in rows["cycles"].tolist()], "steady state"),
        shared("volume", rows["volume"], end=volume),
        Column("share\n\n%", [rounded(share) for share in (100.0 * rows["volume"] / volume).tolist()], "100"),
        shared("deepest_wear", rows["deepest_wear"], end=steady["deepest_wear"]),
        shared("contact_radius", rows["contact_radius"], end=steady["worn_radius"]),
        shared("volume_per_cycle", count * wear, heading, end=0.0, size=largest),
        shared("energy_per_cycle", rows["energy_per_cycle"], end=0.0),
    ]


# --- blocks ---------------------------------------------------------------------------------------------------------


def _blocks(scene_file: Path, given: "Scene", report: Report) -> None:
    """Report how the contact wears over the blocks of the history of a scene, one after the other."""
    load, wear = given.load, given.wear
    assert load is not None and load.cycles is not None and wear is not None
    with computing("wearing it", one_question=False):
        import numpy as np

        from plgwear_jax.contact import wear_by_blocks

        forces, (contact, coefficient, held) = load.forces, _contact(given)
        found = wear_by_blocks(contact, forces, load.cycles, coefficient, **held)
    refuse_extremes(scene_file, np.all(np.isfinite(found.volume)))
    report.draw("blocks_picture", found)
    names = "cycles", "tangential_force", "volume", "volume_per_cycle", "contact_radius", "stick_radius"
    columns: dict[str, np.ndarray] = fields(found, *names)
    report.write_table(columns)
    report.put(
        history=load.history,
        control=load.control,
        wear_coefficient=coefficient,
        **columns,
        units=units_of((*names, "wear_coefficient")),
    )
    report.table(
        Column("block\n\n", [f"{i + 1}" for i in range(found.cycles.size)]),
        Column("cycles\nso far\n", [counted(cycles) for cycles in found.cycles.tolist()]),
        *(shared(name, columns[name]) for name in names[1:]),
        more="blocks",
    )
    report.say(
        "[wear] cycles: the history has cycles of its own, which count here" if wear.cycles is not None else None
    )
    report.end()


# --- the wear coefficient from measured volumes ---------------------------------------------------------------------


def _fit(scene_file: Path, given: "Scene", data: "Measured", report: Report) -> None:
    """Find the wear coefficient of a scene with one amplitude; report it, and draw the data with the fit."""
    with computing("fitting the wear coefficient", one_question=False):
        from plgwear_jax.fitting import fit_wear_coefficient

        assert given.load is not None
        force, (contact, _, held) = given.load.largest, _contact(given)
        found = fit_wear_coefficient(contact, force, data.cycles, data.volume, data.deviation, **held)
    K, (low, high), name = found.wear_coefficient, found.interval, "wear_coefficient"
    refuse_extremes(scene_file, K > 0.0)
    report.draw("fit_picture", found)
    of_volume, of_energy = 1e9 * K, 1e9 * K / float(contact.friction)  # pyright: ignore[reportArgumentType]
    report.put(
        measured=data.name,
        tangential_force=force,
        wear_coefficient=K,
        interval_95_percent=found.interval,
        wear_coefficient_mm3_per_N_m=of_volume,
        energy_coefficient_mm3_per_J=of_energy,
        **fields(found, "cycles", "volume", "fitted", "deviation", "steady_volume"),
        units=units_of(("tangential_force", "wear_coefficient", "volume", "cycles")),
        doubt=found.doubt,
    )
    report.say(given.load.remark)
    size = max(float(found.volume.max()), float(found.fitted.max()))
    report.table(
        Column("cycles", [counted(cycles) for cycles in found.cycles.tolist()]),
        shared("volume", found.volume, "measured", size=size, number=".4g"),
        shared("volume", found.fitted, "fitted", size=size, number=".4g"),
        shared("volume", found.volume - found.fitted, "difference", size=size, number="+.2g"),
        Column("share (%)", [f"{100.0 * share:.3g}" for share in found.fitted / found.steady_volume]),
        more="rows",
    )
    report.say(
        f"wear coefficient: {measure(K, name)} = {of_volume:.4g} mm³/(N m), {of_energy:.4g} mm³ per J of friction"
    )
    if low == low:  # not NaN
        bounded = f"95 % confidence: {low:.4g} to {measure(high, name)}"
        report.say(bounded if high < math.inf else f"at least {measure(low, name)}")
    report.end()
    if found.doubt is not None:
        warn(f"{data.name}: {found.doubt}")
