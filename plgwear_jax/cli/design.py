"""The command `plgwear design`: the best coating for a scene, and a picture of it."""

import dataclasses
from pathlib import Path
from typing import Annotated

import typer

from plgwear_jax._core.words import one_line
from plgwear_jax._files import check_targets
from plgwear_jax.cli import drawing
from plgwear_jax.cli.computing import computing
from plgwear_jax.cli.free_design import free_design
from plgwear_jax.cli.life import life_as_json, life_lines
from plgwear_jax.cli.question import (
    AsJson,
    Picture,
    SceneFile,
    asked,
    doubt_units,
    refusing_scene,
    words_of,
)
from plgwear_jax.cli.terminal import counted, print_json, refuse, refusing_targets, warn, working

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
        free_design(scene_file, given, as_json, picture)
        return
    with refusing_targets():
        check_targets(picture)
        with computing("looking for the coating that wears least", one_question=True):
            from plgwear_jax import optimise

            with refusing_scene(scene_file):
                found = given.design()
        with working("comparing it with the reference"):
            from plgwear_jax.cli import design_report as report

            comparison = optimise.compared(found)
            distance, described = report.edge_distance(found, comparison), report.described(found, comparison)
            words = words_of(distance or 0.0, report.floats(found.question.depths))
            if given.life is not None:
                words["wear_volume"] = f"wear volume after {counted(given.life[1])} cycles"
            why = optimise.conflict(found)
            forever = optimise.for_ever(found) if given.life is not None and found.keeps_limits else None
            higher = report.if_higher(given, found, words)
            slopes = optimise.sensitivities(found) if sensitivities else None
        with working("drawing it"):
            plots = drawing.plots()
            plots.save(plots.design_picture(found, comparison), picture)
    doubt_units(scene_file, given, described[1].get("contact_radius"))
    if as_json:
        told = report.design_as_json(given, found, described, distance, higher, why)
        told = {"scene": str(scene_file), **told, "picture": str(picture)}
        if given.life is not None and forever is not None:
            told |= {"life": life_as_json(given.life, found, forever)}
        print_json(told if slopes is None else told | {"sensitivities": dataclasses.asdict(slopes)})
    else:
        report.print_design(scene_file, given, found, described, words, higher, why)
        for line in life_lines(given, found, forever):
            typer.echo(line)
        if slopes is not None:
            report.print_sensitivities(slopes)
        typer.echo(f"picture: {one_line(str(picture))}")
    if not found.certified:
        warn(f"{scene_file}: {report.verdict(found)}")
        if why is not None:
            warn(f"{scene_file}: {report.conflict_told(why, report.limit_words(found, words))}")
        raise typer.Exit(1)
