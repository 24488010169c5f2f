"""Shared by several commands: reading a scene and doubting it, options, and the names of its quantities."""

import functools
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from plgwear_jax._core.catalogue import entry
from plgwear_jax._core.words import one_line
from plgwear_jax.cli.terminal import refuse

if TYPE_CHECKING:
    from plgwear_jax.scene import Scene


# An option without a default that is worth showing.
option = functools.partial(typer.Option, show_default=False)


def csv_option(what: str) -> Any:
    """The option that has a command write a table of this."""
    return option("--csv", help=f"A .csv file to write {what} to, in SI units.")


SceneFile = Annotated[Path, typer.Argument(metavar="SCENE.toml", help="The input file.", show_default=False)]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object, in SI units, instead of tables.")]
Digits = Annotated[
    int | None,
    option(min=1, max=15, help="Correct digits wanted; fewer run faster. By default all there are, 4 if numerical."),
]
Picture = Annotated[
    Path | None,
    option(help="Where to draw the picture: a .png, .pdf or .svg file. By default it is named after the input, here."),
]


def read_scene(scene_file: Path) -> "Scene":
    """The scene of a file."""
    from plgwear_jax import scene

    return scene.load(scene_file)


def refuse_extremes(finite: Any, what: str = "the wear exceeds") -> None:
    """Refuse a scene whose results are not finite, or nothing where they should be something."""
    if not finite:
        from plgwear_jax.scene import SceneError

        raise SceneError(f"{what} the range of numbers: some value in the input file is too extreme")


def interval(key: str, text: str | None, ends: tuple[float, float], form: str) -> tuple[float, float] | None:
    """The numbers of LOWEST:HIGHEST between these ends, or a line that says so, with a form behind it."""
    if text is None:
        return None
    try:
        lower, upper = map(float, text.split(":"))
    except ValueError:
        lower = upper = math.nan
    if not ends[0] < lower < upper < ends[1]:
        refuse(f"{key} {one_line(text)}: must be LOWEST:HIGHEST{form}")
    return lower, upper


def positive(key: str, value: float | None, what: str) -> None:
    """Refuse a number that is not positive, or not finite."""
    if value is not None and not 0.0 < value < math.inf:
        refuse(f"{key} = {value:g}: must be a finite number > 0, {what}")


def _part(level: float) -> str:
    return {0.0: "mean", 1.0: "worst"}.get(level, f"mean over the worst {100.0 * (1.0 - level):.3g} %")


def _slipping(given: "Scene", rows: Any) -> str:
    """Which of these rows of scenarios slip as a whole under a displacement, in words."""
    from numpy import isnan

    from plgwear_jax.scene.designing import forces_in_scenarios

    forces = forces_in_scenarios(given)
    if forces is None:
        return ""
    slip = rows[isnan(forces)].tolist()
    if len(slip) in (0, rows.size):
        return f", {'all' if slip else 'none'} in gross slip"
    which = f"row{'s' if slip[1:] else ''} {', '.join(map(str, slip[:9]))}{' and others' if slip[9:] else ''}"
    return f", {len(slip)} in gross slip ({which})"


def amplitudes_told(given: "Scene", objective: str) -> str | None:
    """Which amplitudes count, and how, if there are several."""
    load, space, name = given.load, given.asked(), entry(objective).name
    if space.scatter:
        rows = space.scatter.row
        said = (
            f"the {name} is its {_part(space.level)} over them, limits are for the worst, all else is for the reference"
        )
        return f"scenarios {one_line(str(space.scenarios))}: {rows.size}{_slipping(given, rows)}; {said}"
    if load is None:
        return None
    if load.cycles is not None and given.life:
        return f"history {one_line(str(load.history))}: {load.cycles.size} blocks, {given.life:g} cycles in all"
    if load.table is None:
        kept = f"; every coating is given this {'displacement' if given.wears_otherwise else 'force'}"
        return load.remark if load.displacement is None else f"{load.remark}{kept}"
    count, part = load.amplitudes.size, _part(space.level) if space.level < 1.0 else "value at the largest"
    told = f"the {name} is its {part}, all else is for the largest, {load.largest:g} N"
    return f"table {one_line(load.table)}: {count} amplitude{'s' if count > 1 else ''}; {told}"
