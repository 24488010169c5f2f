"""The report of `plgwear design` where the modulus is free at three depths or more."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from plgwear_jax._core.words import one_line
from plgwear_jax._files import check_targets
from plgwear_jax.cli import drawing
from plgwear_jax.cli.computing import computing
from plgwear_jax.cli.question import MEANINGS, UNITS, amplitudes_told, doubt_units, refusing_scene
from plgwear_jax.cli.terminal import console, measure, measures, print_json, refusing_targets, table_of, warn, working

if TYPE_CHECKING:
    import numpy as np

    from plgwear_jax.optimise import FreeDesign
    from plgwear_jax.scene import Scene

__all__ = ["free_design"]


def free_design(scene_file: Path, given: "Scene", as_json: bool, picture: Path) -> None:
    """Find the best free gradient; print and draw it beside the best power law and the reference."""
    with refusing_targets():
        check_targets(picture)
        with computing("looking for the gradient that wears least", one_question=True):
            with refusing_scene(scene_file):
                assert given.load is not None
                found = given.free_design()
            from plgwear_jax import coating

            force = given.load.largest
            counts = coating.where_it_counts(found.contact, force)
            worn, curves = _worn(found, force), _curves(found)
        with working("drawing it"):
            plots = drawing.plots()
            plots.save(plots.free_picture(found, curves, counts, worn), picture)
    doubt_units(scene_file, given, found.contact_radii[2])
    if as_json:
        print_json(
            {
                "scene": str(scene_file),
                "load": amplitudes_told(given, found.objective),
                **_as_json(found, counts),
                "picture": str(picture),
            }
        )
    else:
        measured = amplitudes_told(given, found.objective)
        if measured is not None:
            typer.echo(measured)
        _print(scene_file, found)
        typer.echo(f"picture: {one_line(str(picture))}")
    if not found.converged:
        warn(f"{scene_file}: {_verdict(found)}")
        raise typer.Exit(1)


def _curves(found: "FreeDesign") -> "list[np.ndarray]":
    import numpy as np

    at = np.asarray(found.profile.at)
    least = min(0.5 * at[at > 0.0][0], 0.03 * found.contact_radii[0])
    depths = np.geomspace(least, max(2.0 * at[-1], 3.0 * found.contact_radii[0]), 300)
    curves = [depths]
    for contact in (found.contact, found.power_law, found.reference):
        curves.append(_modulus(contact, depths))
    return curves


def _modulus(contact: Any, depths: "np.ndarray") -> "np.ndarray":
    import numpy as np

    from plgwear_jax.material import PowerLawGraded

    material = contact.material
    return np.asarray(material.modulus(depths) if isinstance(material, PowerLawGraded) else material.modulus_at(depths))


def _worn(found: "FreeDesign", force: float) -> list[Any]:
    from plgwear_jax import coating

    return [
        (one["radii"], one["wear_depth"], float(one["stick_radius"]), float(one["worn_radius"]))
        for one in (coating.worn(contact, force) for contact in (found.contact, found.power_law, found.reference))
    ]


def _verdict(found: "FreeDesign") -> str:
    best = found.minima[0]
    if not found.converged:
        return "the search DID NOT CONVERGE; this is the best gradient that it found"
    other = f"the best of {len(found.minima)} minima" if len(found.minima) > 1 else "the same minimum"
    some = f"{best.starts} of {found.starts} descents ended in {other}"
    if not found.certified:
        return f"the search converged, but only one of {found.starts} descents ended here: THERE MAY BE A BETTER ONE"
    return f"the search converged; {some}; for several variables there is no proof"


def _print(scene_file: Path, found: "FreeDesign") -> None:
    import numpy as np

    table = table_of(scene_file)
    table.add_column("")
    for heading in ("free gradient", f"power law, k = {found.exponent:.3g}", "reference"):
        table.add_column(heading, justify="right", no_wrap=True)
    values = found.value, found.power_law_value, found.reference_value
    table.add_row(MEANINGS[found.objective], *measures(values, UNITS[found.objective]))
    table.add_row(MEANINGS["contact_radius"], *measures(found.contact_radii, "m"))
    law = np.asarray(found.power_law.material.modulus)  # pyright: ignore[reportAttributeAccessIssue]
    at, lower, upper = (np.asarray(x) for x in (found.profile.at, found.profile.lower, found.profile.upper))
    reference = _modulus(found.reference, at)
    bounds = table_of(Path("modulus at a depth"))
    for heading in ("depth", "free gradient", "power law", "reference", "allowed", ""):
        bounds.add_column(heading, justify="right" if heading else "left", no_wrap=True)
    for i, side in enumerate(found.at_bound):
        three = (measure(float(E), "Pa") for E in (found.modulus[i], law[i], reference[i]))
        allowed = f"{measure(lower[i], 'Pa')} to {measure(upper[i], 'Pa')}"
        bounds.add_row(measure(at[i], "m"), *three, allowed, f"at the {side} bound" if side else "between")
    console().print(table)
    console().print(bounds)
    much = f"{abs(100.0 * found.saving):.3g} % {'less' if found.saving >= 0.0 else 'MORE'}"
    typer.echo(f"{much} {MEANINGS[found.objective].partition(',')[0]} than the reference")
    if found.power_law_value == found.power_law_value:
        typer.echo(f"the freedom saves {100.0 * found.freedom:.3g} % against the best power law within these bounds")
    else:
        typer.echo("no power law within these bounds keeps the limits")
    typer.echo(_verdict(found))
    for rival in found.minima[1:2]:
        typer.echo(f"the next best minimum is {100.0 * (rival.value / found.value - 1.0):.2g} % worse")


def _as_json(found: "FreeDesign", counts: Any) -> dict[str, Any]:
    profile, law = found.profile, found.power_law.material
    return {
        "objective": found.objective,
        "depth": profile.at,
        "modulus": found.modulus,
        "at_bound": list(found.at_bound),
        "lower": profile.lower,
        "upper": profile.upper,
        "steepness": profile.steepness,
        "value": {"best": found.value, "power_law": found.power_law_value, "reference": found.reference_value},
        "contact_radius": dict(zip(("best", "power_law", "reference"), found.contact_radii, strict=True)),
        "power_law": {"k": found.exponent, "modulus": law.modulus},  # pyright: ignore[reportAttributeAccessIssue]
        "less_wear_percent": 100.0 * found.saving,
        "less_than_power_law_percent": 100.0 * found.freedom,
        "minima": [minimum._asdict() for minimum in found.minima],
        "starts": found.starts,
        "evaluations": found.evaluations,
        "converged": found.converged,
        "certified": found.certified,
        "verdict": _verdict(found),
        "where_it_counts": {"depth": counts[0], "dlogV_dlogE_per_decade": counts[1]},
        "units": {"depth": "m", "modulus": "Pa", "contact_radius": "m", "value": UNITS[found.objective]},
    }
