"""The commands `plgwear design`, the best coating for an input file, and `plgwear front`, a trade-off curve."""

from typing import Annotated, Any

import typer

from plgwear_jax._core.catalogue import entry, placed
from plgwear_jax._core.rules import LARGER

from .report import Column, Report, counted, each_with_unit, fields
from .terminal import (
    AsJson,
    CsvFile,
    Picture,
    SceneFile,
    computing,
    option,
    positive,
    read_scene,
    refuse,
    warn,
    working,
)


def design(
    scene_file: SceneFile,
    as_json: AsJson = False,
    picture: Picture = None,
    sensitivities: Annotated[
        bool, typer.Option("--sensitivities", help="Also print how the design changes with every input; takes longer.")
    ] = False,
) -> None:
    """Find the coating that wears least, within the bounds under [design] of an input file, and draw it.

    It is compared with the reference, the [material] of the input file. The exit code is 1 if the search did not end
    at a minimum that keeps the limits, or may well have missed a better one; the report says so.

    Example: plgwear design design/steel_ball.toml --picture best.pdf
    """
    given = read_scene(scene_file)
    space = given.asked()
    if space.free and sensitivities:
        refuse("--sensitivities: only for a power law; of a free gradient the picture shows where E(z) counts")
    if space.free and given.wears_otherwise:
        text = "a free gradient under blocks, or in gross slip, has no steady state to report"
        refuse(f"{scene_file}: [load]: {text}; in Python, scene.load(file).free_design() finds it")
    if sensitivities and space.scatter:
        refuse("--sensitivities: not for scenarios; where two of them are equally bad, a design has no derivatives")
    report = Report(scene_file, as_json, f"{scene_file.stem}-design", picture=picture)
    with computing(f"looking for the {'gradient' if space.free else 'coating'} that wears least"):
        found: Any = given.free_design() if space.free else given.design()
    with working("comparing it with the reference"):
        from .design_report import tell_design, tell_freely

        told = tell_freely(report, given, found) if space.free else tell_design(report, given, found, sensitivities)
        doubts, radius, *picture_of = told
    report.draw(*picture_of)
    report.doubt(given, radius)
    report.end()
    if not found.certified:
        for line in doubts:
            warn(f"{scene_file}: {line}")
        raise typer.Exit(1)


def front(
    scene_file: SceneFile,
    x: Annotated[
        str, typer.Option(help="First quantity of the trade-off, with its place in m if it needs one: wear_depth@5e-5.")
    ] = "edge_pressure",
    y: Annotated[str | None, option(help="Second quantity; by default what the input file minimises.")] = None,
    larger: Annotated[str, option(help="Quantities of which a larger value is better: x, y or xy.")] = "",
    distance: Annotated[
        float | None,
        option(help="Distance from the stick-slip boundary of x in m; by default that of its limit in the input file."),
    ] = None,
    points: Annotated[int, typer.Option(min=2, max=10_000, help="Number of designs.")] = 21,
    as_json: AsJson = False,
    picture: Picture = None,
    csv_file: CsvFile = None,
) -> None:
    """Show what less wear costs: the least wear for each pressure, or any two quantities.

    The pressure is that at a critical distance inside the stick-slip boundary, so that singularities of different order
    are compared. All else is as for `plgwear design`; a limit of x in the input file is ignored. The exit code is 1 if
    any point of this trade-off curve is not certain to be the best.

    Example: plgwear front design/electrical_contact.toml --distance 1e-6 --csv front.csv

    Example: plgwear front design/electrical_contact.toml --x penetration --y deepest_wear
    """
    given = read_scene(scene_file)
    if larger not in LARGER:
        refuse(f"--larger {larger}: must be x, y or xy")
    positive("--distance", distance, "in m")
    if y is not None:
        given = given.minimising("y", y)
    given.traded("x", x, distance)
    report = Report(scene_file, as_json, f"{scene_file.stem}-front", picture=picture, table=csv_file)
    with computing("looking for the best y for each x"):
        import numpy as np

        from .design_report import amplitudes_told

        found = given.front(x=x, larger=larger, distance=distance, points=points)  # pyright: ignore[reportArgumentType]
    report.draw("front_picture", found)
    report.doubt(given)
    # The two have one name where only their places differ, or x is that of the steady state and y that after a life.
    x_column = found.x_name if found.x_name != found.y_name else f"{found.x_name}_x"
    columns: dict[str, Any] = {x_column: found.x, found.y_name: found.y, **found.variables}
    flags = fields(found, "converged", "certified")
    reference = {x_column: found.reference_x, found.y_name: found.reference_y}
    report.write_table(columns | flags)
    report.put(
        {x_column: entry(found.x_name).unit},
        x=found.x_name,
        **fields(found, "x_places", "larger"),
        objective=found.y_name,
        objective_places=found.y_places,
        **columns,
        **flags,
        reference=reference,
    )

    along, certain = found.x, np.asarray(found.certified)
    same = np.ptp(along) <= 1e-9 * np.max(along)
    shown = slice(1 if same else None)
    words = {x_column: placed(found.x_name, found.x_places), found.y_name: placed(found.y_name, found.y_places)}
    if given.life:
        words[found.y_name] += f" after {counted(given.life)} cycles"
    sure = Column("", ["" if one else "NOT CERTAIN" for one in certain[shown]], "reference", left=True)
    cells = (
        each_with_unit(
            found.x_name if column == x_column else column, by[shown], words.get(column), reference.get(column)
        )._replace(wrap=True)
        for column, by in columns.items()
    )
    report.say(amplitudes_told(given, found.y_name))
    report.table(*cells, sure)
    report.say(
        f"one design has both the {found.best[1]} and the {found.best[0]}: there is nothing to trade"
        if same
        else f"what ends the trade-off curve: {found.ends[0]} (first row); {found.ends[1]} (last row)"
    )
    report.end()
    if not certain.all():
        warn(f"{scene_file}: {np.sum(~certain)} of {certain.size} points of the trade-off curve are NOT CERTAIN")
        raise typer.Exit(1)
