"""The command `plgwear design`: the best coating for an input file, and a picture of it."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from plgwear_jax.catalogue import entry
from plgwear_jax.cli.computing import computing
from plgwear_jax.cli.question import AsJson, Picture, SceneFile, amplitudes_told, asked, doubt_units, saved
from plgwear_jax.cli.report import Column, Report, by_quantity, each_with_unit, fields, measure
from plgwear_jax.cli.terminal import refuse, warn, working

if TYPE_CHECKING:
    from plgwear_jax.optimise import FreeDesign
    from plgwear_jax.scene import Scene


def design_command(
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
    given = asked(scene_file)
    picture = picture or Path(f"{scene_file.stem}-design.png")
    if given.design_space is not None and given.design_space.free:
        if sensitivities:
            refuse("--sensitivities: only for a power law; of a free gradient the picture shows where E(z) counts")
        if given.wears_otherwise:
            text = "a free gradient under blocks, or in gross slip, has no steady state to report"
            refuse(f"{scene_file}: [load]: {text}; in Python, scene.load(file).free_design() finds it")
        _design_freely(scene_file, given, Report(scene_file, as_json, picture))
        return
    if sensitivities and given.design_space is not None and given.design_space.scatter is not None:
        refuse("--sensitivities: not for scenarios; where two of them are equally bad, a design has no derivatives")
    report = Report(scene_file, as_json, picture)
    with computing("looking for the coating that wears least", one_question=True):
        from plgwear_jax import optimise

        found = given.design()
    with working("comparing it with the reference"):
        from plgwear_jax.cli.design_report import DesignReport, tell_sensitivities

        comparison = optimise.compared(found)
        told = DesignReport(given, found, comparison)
        slopes = optimise.sensitivities(found) if sensitivities and found.keeps_limits else None
    report.draw("design_picture", found, comparison)
    doubt_units(scene_file, given, told.reference.get("contact_radius"))
    told.tell(report)
    if slopes is not None:
        tell_sensitivities(report, slopes)
    report.end()
    for line in told.doubts:
        warn(f"{scene_file}: {line}")
    if not found.certified:
        raise typer.Exit(1)


# --- a modulus that is free at three depths or more -------------------------------------------------------------------


def _design_freely(scene_file: Path, given: "Scene", report: Report) -> None:
    """Find the best free gradient; report and draw it next to the best power law and the reference."""
    with computing("looking for the gradient that wears least", one_question=True):
        import numpy as np

        assert given.load is not None
        found = given.free_design()
        from plgwear_jax import coating
        from plgwear_jax._core import doubts

        force, profile, widest = given.load.largest, found.profile, found.contact_radii[0]
        contacts = found.contact, found.power_law, found.reference
        depth, shares = coating.where_it_counts(found.contact, force)
        rings = [coating.worn(contact, force) for contact in contacts]
        worn = [[one[name] for name in ("radii", "wear_depth", "stick_radius", "worn_radius")] for one in rings]
        at = np.asarray(profile.at)
        depths = np.geomspace(min(0.5 * at[at > 0.0][0], 0.03 * widest), max(2.0 * at[-1], 3.0 * widest), 300)
        curves = [depths, *(np.asarray(contact.material.modulus_at(depths)) for contact in contacts)]
        moduli = found.modulus, found.power_law.material.modulus, found.reference.material.modulus_at(at)
    report.draw("free_picture", found, curves, (depth, shares), worn)
    doubt_units(scene_file, given, found.contact_radii[2])
    load, verdict, sides = (
        amplitudes_told(given, found.objective),
        _free_verdict(found),
        ("best", "power_law", "reference"),
    )
    values = found.value, found.power_law_value, found.reference_value
    report.put(
        {"value": entry(found.objective).unit, "contact_radius": entry("contact_radius").unit},
        load=load,
        **fields(found, "objective", "modulus"),
        depth=profile.at,
        at_bound=list(found.at_bound),
        **fields(profile, "lower", "upper", "steepness"),
        value=dict(zip(sides, values, strict=True)),
        contact_radius=dict(zip(sides, found.contact_radii, strict=True)),
        power_law={"k": found.exponent, "modulus": moduli[1]},
        less_wear_percent=100.0 * found.saving,
        less_than_power_law_percent=100.0 * found.freedom,
        minima=[minimum._asdict() for minimum in found.minima],
        **fields(found, "starts", "evaluations", "converged", "certified"),
        verdict=verdict,
        where_it_counts={"depth": depth, "dlogV_dlogE_per_decade": shares},
    )
    report.say(load)
    headings = "free gradient", "power law", "reference"
    compared = {found.objective: values, "contact_radius": found.contact_radii}
    report.table(*by_quantity((headings[0], f"power law, k = {found.exponent:.3g}", headings[2]), compared))
    ends = ([measure(float(end), "modulus") for end in np.asarray(ends)] for ends in (profile.lower, profile.upper))
    report.table(
        each_with_unit("depth", at),
        *(each_with_unit("modulus", np.asarray(row), name) for row, name in zip(moduli, headings, strict=True)),
        Column("allowed", [f"{low} to {high}" for low, high in zip(*ends, strict=True)]),
        Column("", [f"at the {side} bound" if side else "between" for side in found.at_bound], left=True),
        title="modulus at a depth",
    )
    freedom = f"the free gradient wears {100.0 * found.freedom:.3g} % less than the best power law within these bounds"
    if found.power_law_value != found.power_law_value:  # NaN
        freedom = "no power law within these bounds keeps the limits"
    report.say(saved(found.saving, entry(found.objective).words), freedom, verdict)
    for rival in found.minima[1:2]:
        report.say(f"the next best minimum is {100.0 * (rival.value / found.value - 1.0):.2g} % worse")
    report.say(doubts.of_design(depths, curves[1], widest, float(np.max(rings[0]["wear_depth"]))))
    report.end()
    if not found.certified:
        warn(f"{scene_file}: {verdict}")
        raise typer.Exit(1)


def _free_verdict(found: "FreeDesign") -> str:
    best = found.minima[0]
    if not found.converged:
        return "the search DID NOT CONVERGE; this is the best gradient that it found"
    if not found.certified:
        return f"the search converged, but only one of {found.starts} descents ended here: THERE MAY BE A BETTER ONE"
    other = f"the best of {len(found.minima)} minima" if len(found.minima) > 1 else "the same minimum"
    some = f"{best.starts} of {found.starts} descents ended in {other}"
    return f"the search converged; {some}; with several variables a better one elsewhere cannot be excluded"
