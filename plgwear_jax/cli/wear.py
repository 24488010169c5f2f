"""The command `plgwear wear`: how a contact wears over its cycles, and the wear coefficient from measured volumes."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from plgwear_jax._core.catalogue import entry, measured

from .report import Column, Report, about, counted, fields, rounded, shared
from .terminal import (
    AsJson,
    CsvFile,
    Digits,
    Picture,
    SceneFile,
    computing,
    option,
    positive,
    read_scene,
    refuse,
    refuse_extremes,
    warn,
)

if TYPE_CHECKING:
    import numpy as np

    from plgwear_jax.scene import Scene
    from plgwear_jax.wear import Run

_SHARES = (0.01, 0.1, 0.5, 0.9, 0.99)
_REPORTED = _SHARES[2:]
_LENGTH = 96  # numbers of cycles that are computed: always as many, so that all scenes need the same program


def wear(
    scene_file: SceneFile,
    as_json: AsJson = False,
    digits: Digits = None,
    picture: Picture = None,
    csv_file: CsvFile = None,
    volumes: Annotated[
        Path | None,
        option(
            "--fit",
            help="A CSV file of measured volumes, with the columns cycles, volume, such as volume (um^3), and if known "
            "deviation: find the wear coefficient instead.",
        ),
    ] = None,
    deviation: Annotated[
        float | None,
        option(help="With --fit: the standard deviation of all volumes as a share of them, such as 0.05."),
    ] = None,
    until: Annotated[
        float | None,
        option(metavar="DEPTH", help="Also tell after how many cycles the wear is this deep, such as 5e-6, in m."),
    ] = None,
) -> None:
    """Show how the contact of an input file wears over its cycles, by the wear law under [wear].

    The amplitude under [load], of the force or of the displacement, is constant, but for blocks. In partial slip the
    wear per cycle first rises. It then falls, since the worn ring sheds its load to the stick area, and ends in the
    steady state. In gross slip it goes on, and is followed until the contact is ten times as wide. The life is cycles
    under [wear].

    Example: plgwear wear design/steel_ball.toml --csv course.csv
    """
    given = read_scene(scene_file)
    positive("--until", until, "a depth in m")
    positive("--deviation", deviation, "a share of the volumes")
    kind = "wear" if volumes is None else "fit"
    if volumes and csv_file:
        refuse("--csv: a fit writes no table; put the coefficient that it finds into the input file")
    report = Report(scene_file, as_json, f"{scene_file.stem}-{kind}", picture=picture, table=csv_file)
    if volumes:
        if digits:
            refuse("--digits: a fit computes the volumes as exactly as it can")
        _fit(given, volumes, deviation, report, until)
    elif deviation:
        refuse("--deviation: is that of volumes that --fit reads")
    else:
        _course(given, report, until, digits)


def _tell_until(given: "Scene", report: Report, depth: float, cycles: float, deepest: str, more: str = "") -> None:
    """Say after how many cycles the wear is so deep, and more of that; or that it never is, and how deep it becomes."""
    report.put(until={"depth": depth, "cycles": cycles})
    both = ", both bodies together," if given.wear and given.wear.half_space_share else ""
    worn = measured("depth", depth)
    if cycles < math.inf:
        report.say(f"{worn} deep{both} after {about(cycles)} cycles{more}")
    else:
        reached = "is never reached" if math.isinf(cycles) else "is not reached while this gross slip is followed"
        report.say(f"a depth of {worn}{both} {reached}{deepest}")


def _share_out(given: "Scene", share: float, worn: dict[str, float]) -> str:
    """The line that says what each body loses; refused where the half-space loses too much of its gradient."""
    import numpy as np

    from plgwear_jax.scene import SceneError

    # The least depth over which the modulus changes: a layer, a spacing of a table, a_0 of a power law.
    rows: Any = given.material.rows
    lengths = rows.get("thickness", np.diff(rows.get("depth", ())))
    if getattr(given.material, "k", 0.0):
        lengths = [given.build_contact().steady(0.0).contact_radius]  # pyright: ignore
    deepest, least = share * worn["deepest_wear"], min(lengths, default=math.inf)
    if deepest > 0.1 * least:
        depth, most = measured("depth", deepest), measured("depth", least)
        text = f"it would wear {depth} deep, more than a tenth of the {most} over which its modulus changes"
        raise SceneError(f"[wear] half_space_coefficient: {text}; this wear of a gradient is not modelled")
    indenter, half_space = (measured("volume", part * worn["volume"]) for part in (1.0 - share, share))
    return f"the indenter loses {indenter} of it, the half-space {half_space} ({100.0 * share:.3g} %)"


# --- the course -------------------------------------------------------------------------------------------------------

_READ = {"tangential_force": "force_amplitude", "volume_per_cycle": "rate"}  # of a `Run`; others by their own names
_COURSE = "volume", "deepest_wear", "contact_radius", "volume_per_cycle", "energy_per_cycle", "stick_radius"
_BLOCKS = "tangential_force", "volume", "volume_per_cycle", "deepest_wear", "contact_radius", "stick_radius"


def _course(given: "Scene", report: Report, until: float | None, digits: int | None) -> None:
    """Report how the contact wears under one amplitude, or over the blocks of a history."""
    load, contact = given.tested(), given.contact
    blocks = load.cycles is not None
    closed = given.material.kind == "a power law" and contact.indenter is None and contact.shape is None
    # The closed forms are many small programs, which JAX's cache keeps.
    with computing("wearing it", one_question=not (closed or blocks)):
        import numpy as np

        from plgwear_jax._core.doubts import of_wear

        run, wear = given.over_cycles(digits=digits), given.wear
        assert wear is not None
        life, share = None if blocks else wear.cycles, wear.half_space_share
        shares, cycles, printed = ({}, load.cycles.cumsum(), ()) if blocks else _times(report, run, life)  # pyright: ignore
        columns = {"cycles": cycles, **load.pressed}
        for name in _BLOCKS if blocks else _COURSE:
            columns[name] = np.asarray(getattr(run, _READ.get(name, name))(cycles)) + 0.0 * cycles
        steady = run.final and {name: float(value) for name, value in run.final._asdict().items()}
        at_end = cycles.searchsorted(life or cycles[-1])
        end = {name: values[at_end] for name, values in columns.items()}
        worn = steady or end
        both = _share_out(given, share, end if life else worn) if share else None
    refuse_extremes(np.all(np.isfinite(columns["volume"])) and (blocks or worn["volume"] > 0.0))
    report.write_table(columns)
    law = vars(wear.law)
    report.put({"coefficient": _unit(law["exponent"]), "exponent": "1"} if "exponent" in law else {}, **law)
    if share:
        report.put(half_space_share=share)
    slips = columns["stick_radius"] <= 0.0
    if blocks:
        report.draw("blocks_picture", run)
        report.doubt(given)
        sliding = (slips & (columns["volume_per_cycle"] > 0.0)).nonzero()[0] + 1
        report.put(history=load.history, **columns, blocks_in_gross_slip=sliding)
        left_out = ("cycles", "deepest_wear", *(("volume_per_cycle", "stick_radius") if load.pressed else ()))
        report.table(
            Column("block\n\n", [f"{i + 1}" for i in range(cycles.size)]),
            Column("cycles\nso far\n", [*map(counted, cycles)]),
            *(shared(name, values) for name, values in columns.items() if name not in left_out),
            more="blocks",
        )
        if sliding.size:
            which = f"block{'s' if sliding[1:].size else ''} {', '.join(map(str, sliding[:9]))}"
            more = f" and {sliding.size - 9} more" if sliding.size > 9 else ""
            report.say(f"{which}{more}: gross slip, at a constant displacement amplitude")
    else:
        drawn = [shares[share] for share in (0.1, 0.5, 0.9)] if shares else [end["cycles"] / x for x in (100, 10, 1)]
        report.draw("wear_picture", run, cycles, drawn, life)
        report.doubt(given, worn.get("worn_radius", columns["contact_radius"][-1]))
        # few cycles after which nearly all is worn, or to which gross slip is followed
        doubtful = of_wear(shares[0.99]) if shares else of_wear(math.inf if life else end["cycles"], grows=True)
        if doubtful:
            warn(f"{report.scene}: [wear]: {doubtful}")
        changes = "gross slip, then partial slip" if slips[0] else "mixed slip"
        regime = "gross slip" if slips.all() else changes if slips.any() else "partial slip"
        rows = {name: values[np.searchsorted(cycles, printed)] for name, values in columns.items()}
        if not load.in_gross_slip.any():
            report.put(tangential_force=load.largest)
        report.put(regime=regime, life=life, **rows)
        report.say(load.remark)
        report.table(*_course_columns(rows, steady))
        held = f"at a constant {'displacement' if load.of_displacement else 'force'} amplitude"
        if steady is None:
            much = f"{measured('volume', end['volume'])} after {counted(end['cycles'])} cycles"
            on = "the wear goes on" if life else "it is followed no further; set your life by cycles under [wear]"
            report.say(f"{regime} {held}: {much}; {on}")
        else:
            report.put(steady_state=steady, cycles_to={f"{share:g}": shares[share] for share in _REPORTED})
            if life:
                after = f"{measured('volume', end['volume'])} after the life of {counted(life)} cycles"
                report.say(f"{after}: {100.0 * end['volume'] / steady['volume']:.3g} %")
            told = (f"{100.0 * share:g} % after {about(shares[share])} cycles" for share in _REPORTED)
            report.say(f"{held} the wear reaches {', '.join(told)}")
    report.say(both)
    if until:
        ends = f": the largest wear depth is {measured('depth', worn['deepest_wear'])}" if steady or blocks else ""
        _tell_until(given, report, until, float(run.cycles_to(depth=until)), ends)
    if blocks and wear.cycles:
        report.say("[wear] cycles: the history has cycles of its own, which count here")
    report.end()


def _unit(exponent: float) -> str:
    """The unit of a wear coefficient with this exponent of the pressure."""
    unit = entry("wear_coefficient").unit
    return unit if exponent == 1.0 else f"{unit}^{exponent:g}"


# the share of the last volume of gross slip at which its scar is about as wide as the contact before any wear
_EARLY = 1e-5


def _times(report: Report, run: "Run", life: float | None) -> "tuple[dict[float, float], np.ndarray, np.ndarray]":
    """The cycles to some shares of the final volume, none without one; the cycles of the course; and those printed.

    Printed are decades of cycles, and the life or else the last cycle of gross slip.
    """
    import numpy as np

    shares, printed = {}, [life] if life else []
    if run.steady is None:
        last = float(run.lasting_cycles)
        if life and life > last:
            why = "the scar is then ten times as wide as the unworn contact, or as wide as its table of heights"
            told = f"the wear is followed no further than {last:.3g} cycles; {why}"
            refuse(f"{report.scene}: [wear] cycles = {life:g}: {told}")
        printed = printed or [last]
        known = [float(np.clip(run.cycles_to(_EARLY), 1e-4 * printed[0], 0.1 * printed[0])), *printed]
    else:
        shares = dict(zip(_SHARES, run.cycles_to(np.array(_SHARES)).tolist(), strict=True))
        known = [*shares.values(), *printed]
    first, last = min(known), max(known)
    refuse_extremes(1e-100 < first <= last < 1e200)  # whose decades a picture can show
    decades = 10.0 ** np.arange(math.floor(math.log10(first)), math.ceil(math.log10(last)) + 1)
    decades = decades if shares else decades[(decades >= first) & (decades <= last)]
    decades = decades[:: 1 + decades.size // 50]  # at most 50, which leave room for those that are known
    known = np.unique([*known, *decades])
    between = np.geomspace(known[0], known[-1], _LENGTH - known.size)
    return shares, np.unique([*known, *between]), np.unique([*printed, *decades])


def _course_columns(rows: "dict[str, np.ndarray]", steady: dict[str, float] | None) -> list[Column]:
    """The course in rows, and the steady state below them where there is one."""
    ends, share = {}, []
    if steady:
        still = dict.fromkeys(("volume_per_cycle", "energy_per_cycle"), 0.0)
        ends = steady | still | {"contact_radius": steady["worn_radius"]}
        share = [Column("share\n\n%", [*map(rounded, 100.0 * rows["volume"] / steady["volume"])], "100")]
    cycles = Column("cycles\n\n", [*map(counted, rows["cycles"])], "steady state" if steady else "")
    volume, *others = (shared(name, rows[name], ends.get(name)) for name in _COURSE if name != "stick_radius")
    return [cycles, volume, *share, *others]


# --- the wear coefficient from measured volumes ---------------------------------------------------------------------


def _interval_in_words(interval: tuple[float, float], told: Callable[[float], str]) -> str:
    """An interval of confidence in words; empty if nothing limits it."""
    low, high = interval
    one_sided = f"at least {told(low)}" if low else f"at most {told(high)}"
    said = f"{told(low)} to {told(high)}" if low and high < math.inf else one_sided
    return f"95 % confidence: {said}" if low > 0.0 or high < math.inf else ""  # NaN is neither


def _fit(given: "Scene", volumes: Path, share: float | None, report: Report, until: float | None) -> None:
    """Find the wear coefficient of the test of a scene; report it, and draw the data with the fit."""
    from plgwear_jax import tables

    data = tables.read(volumes, tables.MEASURED)
    cycles, volume = data["cycles"], data["volume"]
    if not (volume[cycles > 0.0] > 0.0).any():
        refuse(f"{data.name}: volume: nothing is worn after any cycles, so that no wear coefficient can be told")
    if share and {"deviation", "relative_deviation"} & data.columns.keys():
        refuse(f"--deviation: {data.name} has a column of deviations")
    load, exponent = given.tested(), getattr(given.wear, "exponent", None) or 1.0
    with computing("fitting the wear coefficient", one_question=False):
        import numpy as np

        from plgwear_jax.fitting import fit_wear_coefficient
        from plgwear_jax.wear_laws import law_of

        contact: Any = given.build_contact()
        test = load.record()
        if load.cycles is not None and cycles.max() > load.cycles.sum():
            refuse(f"{data.name}: cycles: up to {cycles.max():g}, more than the {load.cycles.sum():g} of the blocks")
        relative: Any = data.columns.get("relative_deviation", share)
        if relative is not None:
            data.refuse((cycles > 0.0) & (volume == 0.0), lambda _: "volume = 0: has no relative deviation")
        known = {"deviation": data.columns.get("deviation", relative), "relative": relative is not None}
        found = fit_wear_coefficient(contact, test, cycles, volume, **known, exponent=exponent)
        K, (low, high) = found.wear_coefficient, found.interval
    unit = _unit(exponent)
    refuse_extremes(K > 0.0)
    report.draw("fit_picture", found)
    of_volume = 1e9 * K if exponent == 1.0 else None
    of_energy = None if of_volume is None or "friction" in load.pressed else of_volume / contact.friction
    report.put(
        {"wear_coefficient": unit},
        measured=data.name,
        tangential_force=None if load.cycles is not None or load.in_gross_slip.any() else load.largest,
        wear_coefficient=K,
        exponent=exponent,
        interval_95_percent=found.interval,
        wear_coefficient_mm3_per_N_m=of_volume,
        energy_coefficient_mm3_per_J=of_energy,
        **fields(found, "cycles", "volume", "fitted", "deviation", "steady_volume", "doubt"),
    )
    report.say(load.remark if load.cycles is None else f"history {load.history}: {load.given.size} blocks")
    volumes_told = {"measured": found.volume, "fitted": found.fitted, "difference": found.volume - found.fitted}
    columns = [shared("volume", values, heading=heading) for heading, values in volumes_told.items()]
    if found.steady_volume:
        columns.append(Column("share (%)", [f"{x:.3g}" for x in 100.0 * found.fitted / found.steady_volume]))
    report.table(Column("cycles", [*map(counted, found.cycles)]), *columns, more="rows")
    others = {"mm³/(N m)": of_volume, "mm³ per J of friction": of_energy}
    also = ", ".join(f"{x:.4g} {other}" for other, x in others.items() if x)
    report.say(f"wear coefficient: {K:.4g} {unit}{' = ' if also else ''}{also}")
    report.say(_interval_in_words(found.interval, lambda K: f"{K:.4g} {unit}"))
    if until:
        tried = np.array([x if 0.0 < x < math.inf else K for x in (K, high, low)])
        best, first, last = contact.over_cycles(test, law_of(tried, exponent)).cycles_to(depth=until).tolist()
        reached = (first if high < math.inf else 0.0, last if low > 0.0 else math.inf) if low == low else None
        report.put(interval_95_percent_until=reached)
        within = reached and _interval_in_words(reached, about)
        _tell_until(given, report, until, best, "", f", {within}" if within else "")
    report.end()
    if found.doubt:
        warn(f"{data.name}: {found.doubt}")
