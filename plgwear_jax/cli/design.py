"""The command `plgwear design`: the best coating for an input file, and a picture of it."""

from typing import Annotated, Any

import typer

from plgwear_jax.cli.question import AsJson, Picture, SceneFile, read_scene
from plgwear_jax.cli.report import Report
from plgwear_jax.cli.terminal import computing, refuse, warn, working


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
        from plgwear_jax.cli.design_report import tell_design, tell_freely

        told = tell_freely(report, given, found) if space.free else tell_design(report, given, found, sensitivities)
        doubts, radius, *picture_of = told
    report.draw(*picture_of)
    report.doubt(given, radius)
    report.end()
    if not found.certified:
        for line in doubts:
            warn(f"{scene_file}: {line}")
        raise typer.Exit(1)
