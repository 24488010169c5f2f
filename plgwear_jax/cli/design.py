"""The command `plgwear design`: the best coating for an input file, and a picture of it."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from plgwear_jax.catalogue import entry
from plgwear_jax.cli.computing import computing
from plgwear_jax.cli.question import AsJson, Picture, SceneFile, amplitudes_told, asked, doubt_units, saved
from plgwear_jax.cli.report import Column, Report, by_quantity, each, fields, measure
from plgwear_jax.cli.terminal import refuse, warn, working

if TYPE_CHECKING:
    import numpy as np

    from plgwear_jax.optimise import FreeDesign
    from plgwear_jax.scene import Scene


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
    given = asked(scene_file)
    picture = picture or Path(f"{scene_file.stem}-design.png")
    if given.design_space is not None and given.design_space.free is not None:
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


# --- a modulus that is free at three depths or more -------------------------------------------------------------------


def _design_freely(scene_file: Path, given: "Scene", report: Report) -> None:
    """Find the best free gradient; report and draw it next to the best power law and the reference."""
    with computing("looking for the gradient that wears least", one_question=True):
        assert given.load is not None
        found = given.free_design()
        import numpy as np

        from plgwear_jax import coating
        from plgwear_jax._core import doubts

        force = given.load.largest
        counts = coating.where_it_counts(found.contact, force)
        rings = [coating.worn(contact, force) for contact in (found.contact, found.power_law, found.reference)]
        worn = [[one[name] for name in ("radii", "wear_depth", "stick_radius", "worn_radius")] for one in rings]
        curves = _curves(found)
    report.draw("free_picture", found, curves, counts, worn)
    doubt_units(scene_file, given, found.contact_radii[2])
    load = amplitudes_told(given, found.objective)
    units = {"value": entry(found.objective).unit, "contact_radius": entry("contact_radius").unit}
    report.put(units, load=load, **_as_json(found, counts))
    report.say(load)
    if report.in_words:
        _say(report, found)
        depths, moduli, *_ = curves
        report.say(doubts.of_design(depths, moduli, found.contact_radii[0], float(np.max(rings[0]["wear_depth"]))))
    report.end()
    if not found.certified:
        warn(f"{scene_file}: {_verdict(found)}")
        raise typer.Exit(1)


def _curves(found: "FreeDesign") -> "list[np.ndarray]":
    import numpy as np

    at = np.asarray(found.profile.at)
    least = min(0.5 * at[at > 0.0][0], 0.03 * found.contact_radii[0])
    depths = np.geomspace(least, max(2.0 * at[-1], 3.0 * found.contact_radii[0]), 300)
    return [depths, *(_modulus(contact, depths) for contact in (found.contact, found.power_law, found.reference))]


def _modulus(contact: Any, depths: "np.ndarray") -> "np.ndarray":
    import numpy as np

    return np.asarray(contact.material.modulus_at(depths))


def _verdict(found: "FreeDesign") -> str:
    best = found.minima[0]
    if not found.converged:
        return "the search DID NOT CONVERGE; this is the best gradient that it found"
    other = f"the best of {len(found.minima)} minima" if len(found.minima) > 1 else "the same minimum"
    some = f"{best.starts} of {found.starts} descents ended in {other}"
    if not found.certified:
        return f"the search converged, but only one of {found.starts} descents ended here: THERE MAY BE A BETTER ONE"
    return f"the search converged; {some}; with several variables a better one elsewhere cannot be excluded"


_SIDES = "best", "power_law", "reference"


def _values(found: "FreeDesign") -> tuple[float, float, float]:
    """The objective on the free gradient, on the best power law and on the reference."""
    return found.value, found.power_law_value, found.reference_value


def _say(report: Report, found: "FreeDesign") -> None:
    import numpy as np

    compared = {found.objective: _values(found), "contact_radius": found.contact_radii}
    report.table(*by_quantity(("free gradient", f"power law, k = {found.exponent:.3g}", "reference"), compared))
    law = np.asarray(found.power_law.material.modulus)  # pyright: ignore[reportAttributeAccessIssue]
    at, lower, upper = (np.asarray(x) for x in (found.profile.at, found.profile.lower, found.profile.upper))
    reference = _modulus(found.reference, at)
    allowed = [
        f"{measure(low, 'modulus')} to {measure(high, 'modulus')}" for low, high in zip(lower, upper, strict=True)
    ]
    report.table(
        each("depth", at),
        each("modulus", found.modulus, "free gradient"),
        each("modulus", law, "power law"),
        each("modulus", reference, "reference"),
        Column("allowed", allowed),
        Column("", [f"at the {side} bound" if side else "between" for side in found.at_bound], left=True),
        title="modulus at a depth",
    )
    freedom = "no power law within these bounds keeps the limits"
    if found.power_law_value == found.power_law_value:
        freedom = (
            f"the free gradient wears {100.0 * found.freedom:.3g} % less than the best power law within these bounds"
        )
    report.say(saved(found.saving, entry(found.objective).words), freedom, _verdict(found))
    for rival in found.minima[1:2]:
        report.say(f"the next best minimum is {100.0 * (rival.value / found.value - 1.0):.2g} % worse")


def _as_json(found: "FreeDesign", counts: Any) -> dict[str, Any]:
    profile, law = found.profile, found.power_law.material
    return {
        **fields(found, "objective", "modulus"),
        "depth": profile.at,
        "at_bound": list(found.at_bound),
        **fields(profile, "lower", "upper", "steepness"),
        "value": dict(zip(_SIDES, _values(found), strict=True)),
        "contact_radius": dict(zip(_SIDES, found.contact_radii, strict=True)),
        "power_law": {"k": found.exponent, "modulus": law.modulus},  # pyright: ignore[reportAttributeAccessIssue]
        "less_wear_percent": 100.0 * found.saving,
        "less_than_power_law_percent": 100.0 * found.freedom,
        "minima": [minimum._asdict() for minimum in found.minima],
        **fields(found, "starts", "evaluations", "converged", "certified"),
        "verdict": _verdict(found),
        "where_it_counts": {"depth": counts[0], "dlogV_dlogE_per_decade": counts[1]},
    }
