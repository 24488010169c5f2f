"""The command `plgwear design`: the best coating for a scene, and a picture of it."""

from pathlib import Path
from typing import Annotated

import typer

from plgwear_jax.cli.computing import computing
from plgwear_jax.cli.free_design import free_design
from plgwear_jax.cli.question import AsJson, Picture, SceneFile, asked, doubt_units
from plgwear_jax.cli.report import Report
from plgwear_jax.cli.terminal import refuse, warn, working

__all__ = ["design"]


def design(
    scene_file: SceneFile,
    as_json: AsJson = False,
    picture: Picture = None,
    sensitivities: Annotated[
        bool, typer.Option("--sensitivities", help="Also print how the design changes with every input; takes longer.")
    ] = False,
) -> None:
    """Find the coating that wears least, within the bounds that a scene gives under [design], and draw it.

    It is compared with the reference, the [material] of the scene. The exit code is 1 if the search did not end at a
    minimum that keeps the limits, or found something better elsewhere.

    Example: plgwear design design/electrical_contact.toml --picture best.pdf
    """
    given = asked(scene_file)
    picture = picture or Path(f"{scene_file.stem}-design.png")
    if given.design_space is not None and given.design_space.free is not None:
        if sensitivities:
            refuse("--sensitivities: only for a power law; of a free gradient the picture shows where E(z) counts")
        free_design(scene_file, given, Report(scene_file, as_json, picture))
        return
    report = Report(scene_file, as_json, picture)
    with computing("looking for the coating that wears least", one_question=True):
        from plgwear_jax import optimise

        found = given.design()
    with working("comparing it with the reference"):
        from plgwear_jax.cli import design_report as told

        comparison = optimise.compared(found)
        one = told.findings(given, found, comparison)
        slopes = optimise.sensitivities(found) if sensitivities else None
    report.draw("design_picture", found, comparison)
    doubt_units(scene_file, given, one.reference.get("contact_radius"))
    told.tell_design(report, one)
    if slopes is not None:
        told.tell_sensitivities(report, slopes)
    report.end()
    for line in told.uncertain(one):
        warn(f"{scene_file}: {line}")
    if not found.certified:
        raise typer.Exit(1)
