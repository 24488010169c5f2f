"""The command `plgwear front`: the trade-off between wear and the pressure near the stick edge."""

import math
from pathlib import Path
from typing import Annotated, Any

import typer

from plgwear_jax.cli.computing import computing
from plgwear_jax.cli.question import AsJson, Picture, SceneFile, amplitudes_told, asked, csv_option, option, words_of
from plgwear_jax.cli.report import Column, Report, counted, each, units_of
from plgwear_jax.cli.terminal import refuse, warn


def front(
    scene_file: SceneFile,
    distance: Annotated[
        float | None, option(help="Distance from the stick edge in m; by default that of the limit in the input file.")
    ] = None,
    points: Annotated[int, typer.Option(min=2, max=10_000, help="How many designs.")] = 21,
    as_json: AsJson = False,
    picture: Picture = None,
    csv_file: Annotated[Path | None, csv_option("the trade-off curve")] = None,
) -> None:
    """Show what less wear costs: the least wear for each pressure allowed beside the stick edge.

    Singularities of different order are compared by the pressure at a critical distance inside the stick edge. All else
    is as for `plgwear design`; the limit of this pressure in the input file is ignored. The exit code is 1 if any point
    of this trade-off curve is not certain to be the best.

    Example: plgwear front design/electrical_contact.toml --distance 1e-6 --csv front.csv
    """
    given = asked(scene_file)
    if distance is not None and not 0.0 < distance < math.inf:
        refuse(f"--distance {distance}: must be a finite number > 0, in m")
    if distance is None and given.contact.kind == "fretting" and given.asked().edge_distance is None:
        refuse(f"{scene_file}: name the distance from the stick edge with --distance, in m")
    place = given.edge_distance(distance)
    report = Report(scene_file, as_json, picture or Path(f"{scene_file.stem}-front.png"), csv_file)
    with computing("looking for the least wear at each pressure", one_question=True, drawn=True):
        import numpy as np

        found = given.front(distance=distance, points=points)
    report.draw("front_picture", found)
    columns: dict[str, Any] = {"edge_pressure": found.edge_pressure, found.objective: found.value}
    columns = {name: np.asarray(column) for name, column in (columns | found.variables).items()}
    flags = {"converged": np.asarray(found.converged), "certified": np.asarray(found.certified)}
    reference = {"edge_pressure": float(found.reference_edge_pressure), found.objective: float(found.reference_value)}
    report.write_table(columns | flags)
    report.put(edge_distance=place, objective=found.objective, **columns, **flags)
    report.put(reference=reference, units=units_of(columns))

    pressures, certain, window = columns["edge_pressure"], flags["certified"], given.asked().vary.modulus
    same = bool(np.ptp(pressures) <= 1e-9 * np.max(pressures))
    shown = slice(1 if same else None)
    words = words_of(place, window and (window.at[0], window.at[1]))
    if given.life is not None:
        words[found.objective] += f" after {counted(given.life)} cycles"
    sure = Column("", ["" if one else "NOT CERTAIN" for one in certain[shown]], "reference", left=True, wrap=True)
    cells = (each(name, by[shown], words[name], reference.get(name), wrap=True) for name, by in columns.items())
    report.say(amplitudes_told(given, found.objective))
    report.table(*cells, sure)
    if not same:
        report.say(f"what ends the trade-off curve: {found.ends[0]} (first row); {found.ends[1]} (last row)")
    else:
        report.say("one design has both the least wear and the least pressure: there is nothing to trade")
    report.end()
    if not certain.all():
        warn(f"{scene_file}: {np.sum(~certain)} of {certain.size} points of the trade-off curve are NOT CERTAIN")
        raise typer.Exit(1)
