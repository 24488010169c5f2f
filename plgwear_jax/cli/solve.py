"""The command `plgwear solve`: the quantities that a scene asks for."""

from pathlib import Path
from typing import Annotated, Any

import typer

from plgwear_jax._core.catalogue import entry, measured
from plgwear_jax.cli.report import Report, by_rows
from plgwear_jax.cli.terminal import (
    AsJson,
    Digits,
    SceneFile,
    computing,
    message,
    option,
    read_scene,
    refuse,
    refuse_extremes,
    warn,
)


def solve(
    scene_file: SceneFile,
    as_json: AsJson = False,
    digits: Digits = None,
    picture: Annotated[
        Path | None, option(help="Where to draw the stresses under the contact: a .png, .pdf or .svg file.")
    ] = None,
) -> None:
    """Compute the quantities that an input file asks for under [output], or all single numbers without that section.

    Of a function of the radius the table gives the largest value. If it is infinite at an edge, the table says so and
    gives the value at a distance inside the edge: distance under [output], else that of the limit of the edge pressure
    under [design], else a hundredth of the contact radius. --json gives all values.

    Where the contact slips as a whole, only what does not depend on the amplitude is given, with the peaks of stresses,
    and the exit code is 1.

    Example: plgwear solve design/electrical_contact.toml
    """
    given = read_scene(scene_file)
    if picture and not given.load:
        refuse("--picture: stresses are those of a fretting contact")
    report = Report(scene_file, as_json, picture=picture)
    with computing("computing the quantities"):
        import numpy as np

        quantities, slides = given.solve(digits=digits), given.load and given.load.slides
    known, rows = {}, []
    for name, quantity in quantities.items():
        value, place, meaning = np.asarray(quantity.value), "", quantity.description
        # At the tip of a cone the largest pressure is infinite, on an infinite modulus stresses, of other numbers none.
        endless = quantity.radii is None and not name.startswith("peak_") and np.isinf(value)
        refuse_extremes(not (np.any(np.isnan(value)) or endless), f"{name} exceeds")
        known[name] = {key: one for key, one in quantity._asdict().items() if one is not None}
        if quantity.edge_distance:
            place = f"edge - {measured('distance', quantity.edge_distance)}"
        if quantity.radii is not None:
            known[name]["radii_unit"] = entry("r").unit
            extreme = np.argmax(np.abs(value))
            if quantity.edge_value is None:
                value, place = value[extreme], measured("r", quantity.radii[extreme])
                meaning += "; largest"
            else:
                value = quantity.edge_value
                meaning += f"; unbounded at {quantity.unbounded_at}"
        rows.append([name, measured(name, value), place, meaning])
    radius, onset = map(quantities.get, ("contact_radius", "gross_slip_displacement"))
    report.doubt(given, *(one and float(one.value) for one in (radius, onset)))
    report.put(quantities=known)
    if not slides:
        report.say(given.load and given.load.remark)
    columns = by_rows(("quantity", "value", "at r", "meaning"), rows, left=(0, 2, 3), wrap=(3,))
    report.table(*(column for column in columns if any(column.cells)))
    if picture and given.load:
        contact: Any = given.build_contact()
        report.draw("stress_picture", contact.steady(given.load.hardest, digits=digits))
    report.end()
    if slides:
        warn(f"{message(slides, scene_file)}; all else exists in partial slip only")
        raise typer.Exit(1)
