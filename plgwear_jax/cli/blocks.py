"""What `plgwear wear` says about a history whose rows have cycles."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from plgwear_jax._core.units import readable
from plgwear_jax._core.words import one_line
from plgwear_jax._files import check_targets, write_table
from plgwear_jax.cli import drawing
from plgwear_jax.cli.computing import computing
from plgwear_jax.cli.question import refusing_scene
from plgwear_jax.cli.terminal import console, counted, print_json, refuse, refusing_targets, table_of, working

if TYPE_CHECKING:
    from plgwear_jax.contact import WearByBlocks
    from plgwear_jax.scene import Scene

__all__ = ["wear_blocks"]

_UNITS = {
    "cycles": "1",
    "tangential_force": "N",
    "volume": "m^3",
    "volume_per_cycle": "m^3",
    "contact_radius": "m",
    "stick_radius": "m",
}
_HEADINGS = {
    "tangential_force": "force\namplitude",
    "volume": "worn\nvolume",
    "volume_per_cycle": "wear\na cycle",
    "contact_radius": "contact\nradius",
    "stick_radius": "stick\nradius",
}
_MOST = 40  # rows that are printed


def wear_blocks(scene_file: Path, given: "Scene", picture: Path | None, csv_file: Path | None, as_json: bool) -> None:
    """Show the wear over the blocks of the history of a scene, one after the other."""
    load, wear = given.load, given.wear
    assert load is not None and load.cycles is not None and wear is not None
    picture = picture or Path(f"{scene_file.stem}-wear.png")
    with refusing_targets():
        check_targets(picture, csv_file)
        with computing("wearing it", one_question=False):
            import numpy as np

            from plgwear_jax.contact import FrettingContact, wear_by_blocks

            with refusing_scene(scene_file):
                forces = load.forces
            contact = given.build_contact()
            assert isinstance(contact, FrettingContact)
            coefficient = wear.archard(float(contact.friction))  # pyright: ignore[reportArgumentType]
            held: dict[str, Any] = {} if load.control == "force" else {"rig_stiffness": load.rig_stiffness}
            found = wear_by_blocks(contact, forces, load.cycles, coefficient, control=load.control, **held)
        if not np.all(np.isfinite(found.volume)):
            refuse(f"{scene_file}: the wear exceeds the range of numbers: some value in the scene is too extreme")
        with working("drawing it"):
            plots = drawing.plots()
            plots.save(plots.blocks_picture(found), picture)
        if csv_file is not None:
            write_table(csv_file, {name: getattr(found, name) for name in _UNITS})
    if as_json:
        print_json(
            {
                "scene": str(scene_file),
                "history": load.history,
                "control": load.control,
                "wear_coefficient": coefficient,
                **{name: getattr(found, name) for name in _UNITS},
                "units": _UNITS | {"wear_coefficient": "1/Pa"},
                "picture": str(picture),
            }
        )
        return
    _print(scene_file, found)
    if wear.cycles is not None:
        typer.echo("[wear] cycles: the history has cycles of its own, which count here")
    for kind, file in (("picture", picture), ("table", csv_file)):
        if file is not None:
            typer.echo(f"{kind}: {one_line(str(file))}")


def _print(scene_file: Path, found: "WearByBlocks") -> None:
    table = table_of(scene_file)
    for heading in ("block\n\n", "cycles\nso far\n"):
        table.add_column(heading, justify="right", no_wrap=True)
    columns = []
    for name, heading in _HEADINGS.items():
        values = getattr(found, name)
        factor, unit = readable(float(values.max()), _UNITS[name])
        table.add_column(f"{heading}\n{unit}", justify="right", no_wrap=True)
        columns.append(values / factor)
    for i, (cycles, *row) in enumerate(list(zip(found.cycles, *columns, strict=True))[:_MOST]):
        table.add_row(f"{i + 1}", counted(float(cycles)), *(f"{number:.4g}" for number in row))
    console().print(table)
    if found.cycles.size > _MOST:
        typer.echo(f"and {found.cycles.size - _MOST} more blocks")
