"""The command `plgwear front`: the trade-off between wear and the pressure beside the stick edge."""

import csv
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from plgwear_jax._core.words import one_line
from plgwear_jax._files import check_targets
from plgwear_jax._files import write as write_whole
from plgwear_jax.cli import drawing
from plgwear_jax.cli.computing import computing
from plgwear_jax.cli.question import (
    UNITS,
    AsJson,
    Picture,
    SceneFile,
    amplitudes_told,
    asked,
    refusing_scene,
    words_of,
)
from plgwear_jax.cli.terminal import console, measure, print_json, refuse, refusing_targets, table_of, warn, working

if TYPE_CHECKING:
    import numpy as np

__all__ = ["front"]


def front(
    scene_file: SceneFile,
    distance: Annotated[
        float | None,
        typer.Option(
            help="Distance from the stick edge in m; by default that of the scene's limit.", show_default=False
        ),
    ] = None,
    points: Annotated[int, typer.Option(min=2, max=10_000, help="How many designs.")] = 21,
    as_json: AsJson = False,
    picture: Picture = None,
    csv_file: Annotated[
        Path | None,
        typer.Option("--csv", help="A .csv file to write the front to, in SI units.", show_default=False),
    ] = None,
) -> None:
    """Show what less wear costs: the least wear for each pressure allowed beside the stick edge.

    Singularities of different order are compared by the pressure at a critical distance inside the stick edge. All else
    is as for `plgwear design`; the limit of this pressure in the scene is ignored. The exit code is 1 if any point of
    the front is not certain.

    Example: plgwear front design/electrical_contact.toml --distance 1e-6 --csv front.csv
    """
    given = asked(scene_file)
    if distance is not None and not 0.0 < distance < math.inf:
        refuse(f"--distance {distance}: must be a finite number > 0, in m")
    if distance is None and given.contact.kind == "fretting" and given.asked().edge_distance is None:
        refuse(f"{scene_file}: name the distance from the stick edge with --distance, in m")
    with refusing_scene(scene_file):
        place = given.edge_distance(distance)
    picture = picture or Path(f"{scene_file.stem}-front.png")
    with refusing_targets():
        check_targets(picture, csv_file)
        with computing("looking for the least wear at each pressure", one_question=True):
            import numpy as np

            with refusing_scene(scene_file):
                found = given.front(distance=distance, points=points)
        columns: dict[str, Any] = {"edge_pressure": found.edge_pressure, found.objective: found.value}
        columns = {name: np.asarray(column) for name, column in (columns | found.variables).items()}
        flags = {"converged": np.asarray(found.converged), "certified": np.asarray(found.certified)}
        with working("drawing it beside the reference"):
            plots = drawing.plots()
            plots.save(plots.front_picture(found), picture)
        if csv_file is not None:
            _write_csv(columns | flags, csv_file)
    certain, reference = flags["certified"], (float(found.reference_edge_pressure), float(found.reference_value))
    if as_json:
        units = {name: UNITS[name] for name in columns}
        asked_for = {"scene": str(scene_file), "edge_distance": place, "objective": found.objective}
        compared = {"reference": dict(zip(columns, reference, strict=False)), "units": units}
        print_json({**asked_for, **columns, **flags, **compared, "picture": str(picture)})
    else:
        measured = amplitudes_told(given, found.objective)
        if measured is not None:
            typer.echo(measured)
        window = given.asked().vary.modulus
        _print_front(
            scene_file,
            columns,
            certain,
            reference,
            words_of(place, window and (window.at[0], window.at[1])),
            found.ends,
        )
        for kind, file in (("picture", picture), ("table", csv_file)):
            if file is not None:
                typer.echo(f"{kind}: {one_line(str(file))}")
    if not certain.all():
        warn(f"{scene_file}: {np.sum(~certain)} of {certain.size} points of the front are NOT CERTAIN")
        raise typer.Exit(1)


def _print_front(
    scene_file: Path,
    columns: "dict[str, np.ndarray]",
    certain: "np.ndarray",
    reference: tuple[float, float],
    words: dict[str, str],
    ends: tuple[str, str],
) -> None:
    import numpy as np

    table = table_of(scene_file)
    for name in columns:
        table.add_column(words[name], justify="right")
    table.add_column("")
    pressures = columns["edge_pressure"]
    same = bool(np.ptp(pressures) <= 1e-9 * np.max(pressures))
    for row, sure in enumerate(certain[:1] if same else certain):
        cells = (measure(float(column[row]), UNITS[name]) for name, column in columns.items())
        table.add_row(*cells, "" if sure else "NOT CERTAIN")
    table.add_section()
    cells = [measure(value, UNITS[name]) for name, value in zip(columns, reference, strict=False)]
    table.add_row(*cells, *(len(columns) - len(cells)) * [""], "reference")
    console().print(table)
    if not same:
        typer.echo(f"what ends the front: {ends[0]} (first row); {ends[1]} (last row)")
    else:
        typer.echo("one design has both the least wear and the least pressure: there is nothing to trade")


def _write_csv(columns: "dict[str, np.ndarray]", path: Path) -> None:
    def write(target: Path) -> None:
        with target.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(columns)
            writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))

    write_whole(path, write)
