"""The commands `plgwear sweep`, maps of quantities in Zarr stores, and `plgwear plot`, pictures of them."""

import inspect
import time
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from plgwear_jax._core.catalogue import AMPLITUDES, AXES
from plgwear_jax._core.files import PICTURES, check_target
from plgwear_jax._core.words import one_line

from .terminal import Digits, Picture, computing, interval, option, plots, read_scene, refuse, warn

_BOUNDS = "-0.95:0.95"


def sweep(
    *,
    quantity: Annotated[
        list[str],
        option(
            "--quantity",
            "-q",
            help="What to compute, separated by commas, such as wear_volume,wear_volume.dk,optimal_exponent.k.",
        ),
    ],
    out: Annotated[Path, option(help="The Zarr store to write, a folder that ends in .zarr.")],
    scene_file: Annotated[
        Path | None, option("--scene", help="An input file: quantities are then those of its contact, in SI units.")
    ] = None,
    axis: Annotated[
        list[str] | None,
        option(
            metavar="NAME=VALUES",
            help="Any other number of the contact of an input file, such as material.modulus[2]=1e9:1e11:5:log or "
            "shape.exponent=2:4:9.",
        ),
    ] = None,
    load: Annotated[
        list[Path] | None,
        option(help="A CSV file of force amplitudes and weights; several form an axis. With --scene."),
    ] = None,
    bounds: Annotated[
        str, typer.Option(metavar="LOWEST:HIGHEST", help="Bounds of the exponent for optimal_exponent.")
    ] = _BOUNDS,
    digits: Digits = None,
    single: Annotated[bool, typer.Option("--float32", help="Compute in single precision.")] = False,
    chunk: Annotated[
        int | None,
        typer.Option(min=1, help="Points computed at a time and stored in a file. By default some megabytes."),
    ] = None,
    scheduler: Annotated[
        str | None,
        option(metavar="ADDRESS", help="A Dask scheduler whose workers compute the chunks, such as tcp://host:8786."),
    ] = None,
    **given: str | None,
) -> None:
    """Compute quantities at every combination of the values along some axes, into a Zarr store.

    The same command continues a sweep that was stopped, and raises an error if the store holds another one. The store
    is read by `plgwear plot`, by xarray, or by anything else that reads Zarr.

    Example: plgwear sweep --k=-0.95:0.95:2001 --phi=0.01:0.99:2001 -q wear_volume,wear_volume.dk --out map.zarr
    """
    names = [name.strip() for some in quantity for name in some.split(",") if name.strip()]
    between: Any = interval("--bounds =", bounds, -1.0, 1.0)
    if bounds != _BOUNDS and not any(name.startswith("optimal_exponent.") for name in names):
        refuse(f"--bounds = {bounds}: none of {', '.join(names)} depends on it")
    with computing("getting ready", one_question=False):
        from rich.console import Console
        from rich.progress import Progress

        from plgwear_jax import sweep as library
        from plgwear_jax._core.doubts import of_contact
        from plgwear_jax.sweep.axes import read_axis

    texts, axes = {name: text for name, text in given.items() if text is not None}, {}
    for text in axis or ():
        name, values = _name_and_text("--axis =", text, "NAME=VALUES, such as shape.exponent=2:4:9")
        if name in texts:
            refuse(f"--axis = {one_line(text)}: {name} is given more than once")
        if name in inspect.signature(library.sweep).parameters:
            refuse(f"--axis = {one_line(text)}: {name} is no axis")
        texts[name] = values
    for name, text in texts.items():
        if name in ("nu", "material.nu") and text.strip() == "holl":
            axes[name] = "holl"
        else:
            values = read_axis(name, text)
            axes[name] = values.astype("float32") if single and values.ndim else values
    subject = _subject(scene_file, load, axes, names)
    began, told, before = time.perf_counter(), one_line(", ".join(names)), []
    bar = Progress(console=Console(stderr=True))
    bar.add_task(told, total=None)
    (task,) = bar.tasks

    def follow(done: int, points: int) -> None:
        before.append(done)
        bar.update(task.id, completed=done, total=points)
        if done < points:  # else there is nothing to do
            bar.start()

    try:
        found = library.sweep(
            names,
            bounds=between,
            digits=digits,
            out=out,
            chunk=chunk,
            scheduler=scheduler,
            progress=follow,
            **axes | subject | axes,  # in the order of the axes, which replace what the file gives
        )
    except KeyboardInterrupt:
        bar.stop()
        warn(f"{out}: stopped with {task.percentage:.1f} % done; the same command continues it")
        raise
    finally:
        if bar.live.is_started:
            bar.stop()
    first, *_ = before
    computed, there = int(task.completed) - first, f", {first:,} were computed already" if first else ""
    said = f"{computed:,} computed in {time.perf_counter() - began:.3g} s, compiling included{there}"
    said = said if computed else "all were computed already"
    typer.echo(f"{one_line(str(out))}: {told} at {int(task.total or 0):,} points: {said}")
    for line in of_contact(subject["contact"]) if "contact" in subject else ():
        warn(f"{scene_file}: {line}")
    for values in found.values():
        undefined = int(values.isnull().sum())
        if undefined and "gross_slip" not in found:
            typer.echo(f"{values.attrs['quantity']} is undefined at {undefined:,} of {values.size:,} points")
    slips = found.get("gross_slip")
    if slips is not None:
        along = f" along {', '.join(map(str, slips.dims))}" if slips.ndim else ""
        typer.echo(f"gross slip at {int(slips.sum()):,} of {slips.size:,} points{along}, partial slip at the others")


# Endings of the axes' help texts; an axis without an entry here needs a scene.
_EXTRA = dict.fromkeys(("k", "phi", "r", "distance"), "") | {"nu": ", or holl"}
_EXTRA |= dict.fromkeys(("cycles", "wear_coefficient"), ", for transient.*; with --scene, by default that under [wear]")


def _with_axes(command: Any) -> inspect.Signature:
    """The signature of the command with an option for each axis of the catalogue that has a plain name."""
    *options, _ = inspect.signature(command).parameters.values()
    for name, kind in AXES.items():
        if "." in name:
            continue
        unit = "" if kind.unit == "1" else f", in {kind.unit}" if kind.scale is None else f", in {kind.scale} or m"
        axis_option = option(
            f"--{name.replace('_', '-')}",
            metavar="VALUES",
            help=f"{kind.description[0].upper()}{kind.description[1:]}{unit}{_EXTRA.get(name, '; with --scene')}.",
            rich_help_panel="Axes: a number, start:stop:count, start:stop:count:log, ...:logit, or a file of values",
        )
        annotation = Annotated[str | None, axis_option]
        options.append(inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=annotation))
    return inspect.Signature(options)


sweep.__signature__ = _with_axes(sweep)  # pyright: ignore[reportFunctionMemberAccess]


def _name_and_text(given: str, text: str, form: str) -> tuple[str, str]:
    """The name and the values in the text of an option, or a line that says which form it must have."""
    name, equals, values = text.partition("=")
    if not equals:
        refuse(f"{given} {one_line(text)}: must be {form}")
    return name.strip(), values.strip()


def _subject(
    scene_file: Path | None, loads: list[Path] | None, axes: Mapping[str, Any], names: list[str]
) -> dict[str, Any]:
    """The contact of a scene with its load and, where a design is asked for, what may vary."""
    if scene_file is None:
        if loads:
            refuse("--load: needs a contact, --scene")
        return {}
    designed, lasts = (any(name.startswith(f"{head}.") for name in names) for head in ("design", "transient"))
    given = read_scene(scene_file)
    if designed:
        given.asked()
    others, space = ", ".join(name for name in names if not name.startswith("design.")), given.design_space
    if others and space and space.hold and "k" in axes and not {"E0", "z0"} & axes.keys():
        warn(
            f"{scene_file}: {others}: E0 and z0 are those of [material] for every k; hold counts for "
            "design.* alone (at a held contact radius a map over k and phi needs no input file)"
        )
    if others and space and space.level and not loads and not {*AMPLITUDES} & axes.keys():
        warn(f"{scene_file}: {others}: the mean over the table; over counts for design.* alone")
    found: dict[str, Any] = {"contact": given.build_contact()}
    followed = lasts or (designed and given.life is not None)
    blocks = given.load is not None and given.load.cycles is not None
    if given.wear and "wear_coefficient" not in axes and followed:
        given.wear.refuse_frictions(axes)
    if given.wear and lasts:
        found["wear_coefficient"] = given.wear.archard
        if given.wear.cycles and not blocks:
            found["cycles"] = given.wear.cycles
    if designed:
        own = "contact", "load", "weight", *(["cycles"] if blocks else [])  # which a sweep has otherwise
        found["design"] = {name: value for name, value in given.arguments().items() if name not in own}
    # The load as the library takes it, but for what is an axis; a displacement, and blocks, last in a test or a life.
    load, forces = given.load, [name for name in ("phi", "tangential_force") if name in axes]
    if loads:
        from plgwear_jax import tables

        read = ((str(file), tables.read(file, tables.LOADS)) for file in loads)
        found["loads"] = {name: (table["tangential_force"], table["weight"]) for name, table in read}
    elif load is None:
        return found
    elif forces or load.table:
        if followed and load.of_displacement:
            refuse(f"{scene_file}: [load]: a displacement holds no force over cycles; give one, and sweep it")
        if not forces:
            found["loads"] = {str(load.table): (load.amplitudes, load.weights)}
    elif (held := followed if blocks else load.of_displacement) or "displacement" not in axes:
        found["load"] = load.acting(held)
    rig = load and load.rig_stiffness
    if rig and "load" not in found:
        found["rig_stiffness"] = rig
    return found


def plot(
    store: Annotated[Path, typer.Argument(metavar="MAP.zarr", help="The sweep.", show_default=False)],
    quantity: Annotated[str | None, option("--quantity", "-q", help="Which one. By default the first.")] = None,
    at: Annotated[
        list[str] | None, option(metavar="AXIS=VALUE", help="Where to cut an axis, if there are more than two.")
    ] = None,
    picture: Picture = None,
) -> None:
    """Draw a sweep: a heat map with contours over two axes, lines over one.

    On maps of the wear volume over k and the amplitude the exponent that wears least is drawn on top.

    Example: plgwear plot map.zarr --quantity wear_volume --picture map.pdf
    """
    picture = picture or Path(f"{store.resolve().stem}.png")  # also of "."
    cuts = dict(_name_and_text("--at", text, "AXIS=VALUE, such as z0=1e-4") for text in at or ())
    check_target(picture, PICTURES)
    with computing("drawing the map", one_question=False):
        from plgwear_jax import sweep as library

        drawing = plots()
        from plgwear_jax.plots import maps

        with warnings.catch_warnings(record=True) as heard:
            warnings.simplefilter("always", library.UnfinishedWarning)
            found = library.open_sweep(store)
        drawing.save(maps.map_picture(found, quantity, at=cuts), picture)
    typer.echo(f"picture: {one_line(str(picture))}")
    for said in heard:
        warn(str(said.message))
