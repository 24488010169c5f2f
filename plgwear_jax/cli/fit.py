"""The wear coefficient from measured volumes: `plgwear wear SCENE.toml --fit measured.csv`."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from plgwear_jax._core.units import readable
from plgwear_jax._core.words import one_line
from plgwear_jax._files import check_targets
from plgwear_jax.cli import drawing
from plgwear_jax.cli.computing import computing
from plgwear_jax.cli.question import refusing_scene
from plgwear_jax.cli.terminal import console, counted, print_json, refuse, refusing_targets, table_of, warn, working

if TYPE_CHECKING:
    from plgwear_jax.fitting import Fit
    from plgwear_jax.scene import Scene

__all__ = ["fit"]

_MOST = 40  # rows that are printed


def fit(scene_file: Path, given: "Scene", measured: Path, picture: Path | None, as_json: bool) -> None:
    """Find the wear coefficient of a scene with one amplitude; print it, and draw the data beside the fit."""
    from plgwear_jax import tables

    try:
        data = tables.read_measured(measured)
    except tables.TableError as error:
        refuse(str(error))
    if not (data.volume[data.cycles > 0.0] > 0.0).any():
        refuse(f"{data.name}: volume: nothing is worn after any cycles, so that no wear coefficient can be told")
    picture = picture or Path(f"{scene_file.stem}-fit.png")
    assert given.load is not None
    with refusing_targets():
        check_targets(picture)
        with computing("fitting the wear coefficient", one_question=False):
            from plgwear_jax.contact import FrettingContact
            from plgwear_jax.fitting import fit_wear_coefficient

            with refusing_scene(scene_file):
                assert given.load is not None
                given.load.largest  # noqa: B018
            contact = given.build_contact()
            assert isinstance(contact, FrettingContact)
            friction = float(contact.friction)  # pyright: ignore[reportArgumentType]
            load = given.load
            held: dict[str, Any] = {"control": load.control} if load.control != "force" else {}
            if held and load.rig_stiffness is not None:
                held["rig_stiffness"] = load.rig_stiffness
            found = fit_wear_coefficient(contact, load.largest, data.cycles, data.volume, data.deviation, **held)
        if not found.wear_coefficient > 0.0:
            refuse(f"{scene_file}: the wear exceeds the range of numbers: some value in the scene is too extreme")
        with working("drawing it"):
            plots = drawing.plots()
            plots.save(plots.fit_picture(found), picture)
    if as_json:
        print_json(
            {
                "scene": str(scene_file),
                "measured": data.name,
                "tangential_force": given.load.largest,
                "wear_coefficient": found.wear_coefficient,
                "interval_95_percent": found.interval,
                "wear_coefficient_mm3_per_N_m": 1e9 * found.wear_coefficient,
                "energy_coefficient_mm3_per_J": 1e9 * found.wear_coefficient / friction,
                "cycles": found.cycles,
                "volume": found.volume,
                "fitted": found.fitted,
                "deviation": found.deviation,
                "steady_volume": found.steady_volume,
                "units": {"tangential_force": "N", "wear_coefficient": "1/Pa", "volume": "m^3", "cycles": "1"},
                "doubt": found.doubt,
                "picture": str(picture),
            }
        )
    else:
        if given.load.remark is not None:
            typer.echo(given.load.remark)
        _print(scene_file, friction, found)
        typer.echo(f"picture: {one_line(str(picture))}")
    if found.doubt is not None:
        warn(f"{data.name}: {found.doubt}")


def _print(scene_file: Path, friction: float, found: "Fit") -> None:
    unit, name = readable(max(float(found.volume.max()), float(found.fitted.max())), "m^3")
    table = table_of(scene_file)
    for heading in ("cycles", f"measured ({name})", f"fitted ({name})", f"difference ({name})", "share (%)"):
        table.add_column(heading, justify="right", no_wrap=True)
    for cycles, volume, fitted in list(zip(found.cycles, found.volume, found.fitted, strict=True))[:_MOST]:
        numbers = f"{volume / unit:.4g}", f"{fitted / unit:.4g}", f"{(volume - fitted) / unit:+.2g}"
        table.add_row(counted(float(cycles)), *numbers, f"{100.0 * fitted / found.steady_volume:.3g}")
    console().print(table)
    if found.cycles.size > _MOST:
        typer.echo(f"and {found.cycles.size - _MOST} more rows")
    K, (low, high) = found.wear_coefficient, found.interval
    units = f"{1e9 * K:.4g} mm³/(N m), {1e9 * K / friction:.4g} mm³ per J of friction"
    typer.echo(f"wear coefficient: {K:.4g} 1/Pa = {units}")
    if low == low:  # not NaN
        typer.echo(
            f"95 % confidence: {low:.4g} to {high:.4g} 1/Pa" if high < float("inf") else f"at least {low:.4g} 1/Pa"
        )
