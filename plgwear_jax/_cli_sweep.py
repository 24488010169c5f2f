"""The commands `plgwear sweep` and `plgwear plot`: maps of quantities in Zarr stores, and pictures of them."""

import contextlib
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, Task, TextColumn, TimeRemainingColumn
from rich.text import Text

from plgwear_jax import tables
from plgwear_jax._axes import AXES, AxisError, read_axis
from plgwear_jax._terminal import refuse, warn
from plgwear_jax._words import one_line

__all__ = ["plot", "sweep"]

ContactOf = Callable[[Path], tuple[Any, Any, dict[str, Any] | None]]


def _axis(name: str, extra: str = "") -> Any:
    kind = AXES[name]
    unit = "" if kind.unit == "1" else f", in {kind.unit}" if kind.scale is None else f", in {kind.scale} or m"
    return typer.Option(
        f"--{name.replace('_', '-')}",
        metavar="VALUES",
        help=f"{kind.description[0].upper()}{kind.description[1:]}{unit}{extra}.",
        rich_help_panel="Axes: a number, start:stop:count, start:stop:count:log, ...:logit, or a file of values",
        show_default=False,
    )


_WITH_SCENE = "; with --scene"


def sweep(
    quantity: Annotated[
        list[str],
        typer.Option(
            "--quantity",
            "-q",
            help="What to compute, separated by commas, such as wear_volume,wear_volume.dk,optimal_exponent.k.",
            show_default=False,
        ),
    ],
    out: Annotated[
        Path, typer.Option(help="The Zarr store to write, a folder that ends in .zarr.", show_default=False)
    ],
    scene_file: Annotated[
        Path | None,
        typer.Option(
            "--scene", help="A scene: quantities are then those of its contact, in SI units.", show_default=False
        ),
    ] = None,
    k: Annotated[str | None, _axis("k")] = None,
    phi: Annotated[str | None, _axis("phi")] = None,
    nu: Annotated[str | None, _axis("nu", ", or holl")] = None,
    r: Annotated[str | None, _axis("r")] = None,
    distance: Annotated[str | None, _axis("distance")] = None,
    modulus: Annotated[str | None, _axis("E0", _WITH_SCENE)] = None,
    z0: Annotated[str | None, _axis("z0", _WITH_SCENE)] = None,
    radius: Annotated[str | None, _axis("radius", _WITH_SCENE)] = None,
    normal_force: Annotated[str | None, _axis("normal_force", _WITH_SCENE)] = None,
    friction: Annotated[str | None, _axis("friction", _WITH_SCENE)] = None,
    depth: Annotated[str | None, _axis("depth", _WITH_SCENE)] = None,
    tangential_force: Annotated[str | None, _axis("tangential_force", _WITH_SCENE)] = None,
    load: Annotated[
        list[Path] | None,
        typer.Option(
            help="A CSV file of amplitudes and weights; several are an axis. With --scene.", show_default=False
        ),
    ] = None,
    bounds: Annotated[
        str, typer.Option(metavar="LOWEST:HIGHEST", help="Of the exponent, for optimal_exponent.")
    ] = "-0.95:0.95",
    digits: Annotated[
        int | None,
        typer.Option(
            min=1, max=15, help="Correct digits wanted; fewer run faster. By default all.", show_default=False
        ),
    ] = None,
    single: Annotated[bool, typer.Option("--float32", help="Compute in single precision.")] = False,
    chunk: Annotated[
        int | None,
        typer.Option(min=1, help="Points computed at a time and stored in a file. By default some megabytes."),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="A Dask scheduler whose workers compute the chunks, such as tcp://host:8786.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Compute quantities at every combination of the values along some axes, into a Zarr store.

    The same line goes on where it was stopped, and refuses a store that holds another sweep. What it wrote is read by
    `plgwear plot`, by xarray, or by anything else that reads Zarr.

    Example: plgwear sweep --k=-0.95:0.95:2001 --phi=0.01:0.99:2001 -q wear_volume,wear_volume.dk --out map.zarr
    """
    texts = {
        "k": k,
        "phi": phi,
        "nu": nu,
        "r": r,
        "distance": distance,
        "E0": modulus,
        "z0": z0,
        "radius": radius,
        "normal_force": normal_force,
        "friction": friction,
        "depth": depth,
        "tangential_force": tangential_force,
    }
    names = [name.strip() for some in quantity for name in some.split(",") if name.strip()]
    library = _library()
    with _refusing():
        axes = {name: _values(name, text, single) for name, text in texts.items() if text is not None}
        asked = {"bounds": _bounds(bounds), "digits": digits, "chunk": chunk, "scheduler": scheduler}
        subject = _subject(scene_file, load, axes, names)
        began, bar = time.perf_counter(), _Bar(names)
        try:
            with bar:
                library.sweep(names, out=out, progress=bar, **asked, **subject, **axes)
        except KeyboardInterrupt:
            warn(f"{out}: stopped with {bar.share} done; the same line goes on")
            raise typer.Exit(130) from None
    said = bar.said(time.perf_counter() - began)
    typer.echo(f"{one_line(str(out))}: {one_line(', '.join(names))} at {bar.points:,} points: {said}")


class _Bar:
    """A progress bar on standard error with rate and time left, from when there is something to do."""

    def __init__(self, names: list[str]) -> None:
        self.first: int | None = None
        self.done = self.points = 0
        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.percentage:>3.0f} %"),
            _Speed(),
            TimeRemainingColumn(),
        )
        self._shown = Progress(*columns, console=Console(stderr=True))
        self._names = one_line(", ".join(names))

    def __enter__(self) -> None:
        pass

    def __call__(self, done: int, points: int) -> None:
        if self.first is None:
            self.first = done  # what was there already was not computed at this rate
            if done < points:
                self._task = self._shown.add_task(self._names, total=points - done)
                self._shown.start()
        self.done, self.points = done, points
        if self._shown.tasks:
            self._shown.update(self._task, completed=done - self.first)

    def __exit__(self, *error: object) -> None:
        if self._shown.tasks:
            self._shown.stop()

    @property
    def share(self) -> str:
        return f"{100.0 * self.done / self.points if self.points else 0.0:.1f} %"

    def said(self, seconds: float) -> str:
        computed = self.done - (self.first or 0)
        if computed == 0:
            return "all were there already"
        there = f", {self.first:,} were there already" if self.first else ""
        return f"{computed:,} computed in {seconds:.3g} s, compiling included{there}"


def _rate(speed: float) -> str:
    for unit, name in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if speed >= unit:
            return f"{speed / unit:.3g} {name} points/s"
    return f"{speed:.3g} points/s"


class _Speed(ProgressColumn):
    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        return Text(_rate(speed) if speed else "")


def _values(name: str, text: str, single: bool) -> Any:
    if name == "nu" and text.strip() == "holl":
        return "holl"
    values = read_axis(name, text)
    return values.astype(np.float32) if single and values.ndim else values


def _bounds(text: str) -> tuple[float, float]:
    lower, colon, upper = text.partition(":")
    try:
        pair = float(lower), float(upper)
    except ValueError:
        pair = None
    if not colon or pair is None or not -1.0 < pair[0] < pair[1] < 1.0:
        raise AxisError(f"--bounds = {one_line(text)}: must be LOWEST:HIGHEST, -1 < LOWEST < HIGHEST < 1")
    return pair


def _subject(
    scene_file: Path | None, loads: list[Path] | None, axes: Mapping[str, Any], names: list[str]
) -> dict[str, Any]:
    """The contact of a scene with its load and, where a design is asked for, what may vary."""
    if scene_file is None:
        if loads:
            refuse("--load: needs a contact, --scene")
        return {}
    from plgwear_jax import cli

    kinds = {name: name.split(".")[0] for name in names}
    designed, of_scene = "design" in kinds.values(), not {"phi", "tangential_force"} & axes.keys()
    given, arguments = cli.asked(scene_file) if designed else (cli.read_scene(scene_file), {})
    others = [name for name, kind in kinds.items() if kind not in ("design", "optimal_exponent")]
    if given.design is not None and others:
        if given.design.held and "k" in axes and not {"E0", "z0"} & axes.keys():
            warn(
                f"{scene_file}: {', '.join(others)}: E0 and z0 are those of [material] for every k; hold counts for "
                "design.* alone (at a held contact radius a map over k and phi needs no scene)"
            )
        if given.design.level and not loads and of_scene:
            warn(f"{scene_file}: {', '.join(others)}: the mean over the table; over counts for design.* alone")
    found: dict[str, Any] = {"contact": given.build_contact()}
    if designed:
        found["design"] = {name: arguments[name] for name in ("vary", "level", "hold", "minimise", "limits")}
    if loads:
        read = {str(file): tables.read_table(file) for file in loads}
        found["loads"] = {name: (table.tangential_force, table.weight) for name, table in read.items()}
    elif given.load is not None and of_scene:
        if given.load.weights is None:
            found["tangential_force"] = given.load.force
        else:
            found["loads"] = {str(given.load.table): (given.load.force, given.load.weights)}
    return found


# --- plot -----------------------------------------------------------------------------------------------------------


def plot(
    store: Annotated[Path, typer.Argument(metavar="MAP.zarr", help="The sweep.", show_default=False)],
    quantity: Annotated[
        str | None, typer.Option("--quantity", "-q", help="Which one. By default the first.", show_default=False)
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option(
            metavar="AXIS=VALUE", help="Where to cut an axis, if there are more than two.", show_default=False
        ),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option(
            help="Where to draw: a .png, .pdf or .svg file. By default it is named after the sweep, here.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Draw a sweep: a heat map with contours over two axes, lines over one.

    On maps of the wear volume over k and the amplitude the exponent that wears least is drawn on top.

    Example: plgwear plot map.zarr --quantity wear_volume --picture map.pdf
    """
    library = _library()
    from plgwear_jax import _maps, plots

    picture = picture or Path(f"{store.stem}.png")
    cuts = dict(_cut(text) for text in at or [])
    with _refusing():
        plots.check_target(picture)
        found = library.open_sweep(store)
        plots.save(_maps.map_picture(found, quantity, at=cuts), picture)
    typer.echo(f"picture: {one_line(str(picture))}")
    if found.attrs["unfinished"]:
        warn(f"{store}: is not finished: {found.attrs['unfinished']} files of chunks are missing")


def _cut(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals:
        refuse(f"--at {one_line(text)}: must be AXIS=VALUE, such as z0=1e-4")
    return name.strip(), value.strip()


# --- common ---------------------------------------------------------------------------------------------------------


def _library() -> Any:
    try:
        from plgwear_jax import sweep
    except ModuleNotFoundError as error:
        refuse(str(error))
    return sweep


@contextlib.contextmanager
def _refusing() -> Iterator[None]:
    """Refuse what the library refuses."""
    try:
        yield
    except ValueError as error:
        refuse(str(error))
