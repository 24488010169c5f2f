"""The commands that tell of a contact: `plgwear solve`, its quantities, and `plgwear regimes`, how it slips."""

import dataclasses
import math
from pathlib import Path
from typing import Annotated, Any

import typer

from plgwear_jax._core.catalogue import entry, measured
from plgwear_jax._core.ranges import POSITIVE

from .report import Column, Report, by_rows, each_with_unit, fields, rounded
from .terminal import (
    AsJson,
    CsvFile,
    Digits,
    Picture,
    SceneFile,
    computing,
    interval,
    message,
    option,
    positive,
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
    gives the value at a distance inside the edge: distance under [output], else that at which [design] minimises or
    limits the edge pressure, else a hundredth of the contact radius. --json gives all values.

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
    known_of = map(quantities.get, ("contact_radius", "gross_slip_displacement"))
    report.doubt(given, *(one and float(one.value) for one in known_of))
    report.put(quantities=known)
    if not slides:
        report.say(given.load and given.load.remark)
    columns = by_rows(("quantity", "value", "at r", "meaning"), rows, left=(0, 2, 3))
    report.table(*(column for column in columns if any(column.cells)))
    if picture and given.load:
        contact: Any = given.build_contact()
        report.draw("stress_picture", contact.steady(given.load.hardest, digits=digits))
    report.end()
    if slides:
        warn(f"{message(slides, scene_file)}; all else exists in partial slip only")
        raise typer.Exit(1)


# --- regimes ----------------------------------------------------------------------------------------------------------

_AMPLITUDES, _CUT = 121, 201  # displacement amplitudes of the map, and of the cut at the file's own normal force
_FORCES = 31  # normal forces of the map
_SHARES = (0.1, 0.2, 0.5, 0.8, 1.0, 1.2, 1.5, 2.0)  # rows of the table, over the transition
_DECADE = 10.0  # how far the default range of normal forces goes to both sides
_NAMES = "gross_slip", "tangential_force", "energy_ratio", "loop_aperture"


def regimes(
    scene_file: SceneFile,
    displacement: Annotated[
        str | None,
        option(
            metavar="LOWEST:HIGHEST", help="Displacement amplitudes of the map, in m; by default around the transition."
        ),
    ] = None,
    normal_force: Annotated[
        str | None,
        option(metavar="LOWEST:HIGHEST", help="Normal forces of the map, in N; by default a decade to both sides."),
    ] = None,
    rig_stiffness: Annotated[
        float | None,
        option(help="Rig stiffness in N/m, if displacement and loop are measured at the actuator."),
    ] = None,
    as_json: AsJson = False,
    picture: Picture = None,
    csv_file: CsvFile = None,
) -> None:
    """Show where the slip is partial and where gross, over displacement amplitude and normal force.

    At each point the energy ratio is the energy of a cycle over 4 F_x times the displacement amplitude, and the
    sliding ratio is the displacement at no force over the displacement amplitude. Laboratories tell partial from
    gross slip by 0.2 and 0.26, which are right for a homogeneous body under a parabola. Gradients, other shapes and the
    compliance of the rig shift both. All is of the contact before any wear.

    Example: plgwear regimes design/electrical_contact.toml --normal-force 1:100
    """
    given = read_scene(scene_file)
    load = given.load
    if load is None:
        refuse(f'{scene_file}: [contact] kind = "gross-slip": only a fretting contact changes between the regimes')
    moves = interval("--displacement", displacement, 0.0, math.inf, " in m")
    forces = interval("--normal-force", normal_force, 0.0, math.inf, " in N")
    positive("--rig-stiffness", rig_stiffness, "in N/m")
    rig = rig_stiffness or load.rig_stiffness
    report = Report(scene_file, as_json, f"{scene_file.stem}-regimes", picture=picture, table=csv_file)
    with computing("computing the loops"):
        import numpy as np

        from plgwear_jax.contact import CRITERIA, slip_regimes
        from plgwear_jax.loads import Force
        from plgwear_jax.scene.solving import homogeneous

        contact = homogeneous(given.build_contact())
        moved = load.of_displacement and not load.pressed
        own = np.unique(load.given if moved else contact.steady(Force(load.amplitudes, rig)).displacement_amplitude)
        own = own[own > 0.0]
        force = float(contact.normal_force)
        first, last = forces or (force / _DECADE, force * _DECADE)
        three = dataclasses.replace(contact, normal_force=np.array([first, last, force]))
        onsets = np.asarray(three.steady(Force(0.0, rig)).gross_slip_displacement)
        refuse_extremes(POSITIVE.contains(onsets).all(), "the loops exceed")
        if moves is None:
            # Both ends of the transition stay well inside, and so does the load.
            inside = np.append(onsets, own)
            moves = inside.min() / 3.0, 3.0 * inside.max()
        rows = np.geomspace(first, last, _FORCES)
        found = slip_regimes(contact, np.geomspace(*moves, _AMPLITUDES), rows, rig_stiffness=rig)
        refuse_extremes(POSITIVE.contains(found.energy_ratio).all(), "the loops exceed")
        told = np.unique(np.append(onsets[2] * np.array(_SHARES), own))
        # Always as many, so that all files need the same program.
        between = np.linspace(0.0, max(2.5 * onsets[2], 1.1 * told[-1]), max(_CUT - told.size, 2))[1:]
        cut = slip_regimes(contact, np.sort(np.append(told, between)), [force], rig_stiffness=rig)
    report.draw("regimes_picture", found, cut, own, rig)
    every, at_each = np.meshgrid(found.normal_force, found.displacement_amplitude, indexing="ij")
    columns = {"normal_force": every, "displacement_amplitude": at_each} | fields(found, *_NAMES)
    report.write_table({name: values.ravel() for name, values in columns.items()})
    onset = cut.gross_slip_displacement[0]
    report.doubt(given, onset=onset)
    at_onset = dict(zip(CRITERIA, (cut.gross_slip_energy_ratio[0], cut.gross_slip_aperture[0]), strict=True))
    where = {name: cut.displacement_where(name, level)[0] for name, level in CRITERIA.items()}
    report.put(
        rig_stiffness=rig,
        load={"normal_force": force, "displacement_amplitude": own},
        onset={"normal_force": force, "displacement_amplitude": onset, **at_onset},
        criteria={name: {"value": level, "displacement_amplitude": where[name]} for name, level in CRITERIA.items()},
        **fields(found, "normal_force", "displacement_amplitude", "gross_slip_displacement", *_NAMES),
    )
    at = np.searchsorted(cut.displacement_amplitude, told)
    slips = ["gross" if slips else "partial" for slips in cut.gross_slip[0, at]]
    heading = "displacement\namplitude" if rig is None else "displacement\nof the rig"
    report.table(
        each_with_unit("displacement_amplitude", cut.displacement_amplitude[at], heading),
        Column("slip\n", slips, left=True),
        each_with_unit("tangential_force", cut.tangential_force[0, at], "tangential\nforce"),
        *(
            Column(entry(name).name.replace(" ", "\n"), [f"{x:.3f}" for x in getattr(cut, name)[0, at]])
            for name in where
        ),
        title=f"{report.scene} at the normal force {measured('normal_force', force)}",
    )
    energy, sliding = map(rounded, at_onset.values())
    begins = f"gross slip begins at {measured('displacement_amplitude', onset)}"
    report.say(f"{begins}, where the energy ratio is {energy} and the sliding ratio {sliding}")
    for name, level in CRITERIA.items():
        by = where[name] / onset - 1.0
        shift = f"{100.0 * abs(by):.3g} % {'above' if by > 0.0 else 'below'}" if abs(by) >= 1e-3 else "at"
        at = measured("displacement_amplitude", where[name])
        report.say(f"the {entry(name).name} is {level:g} at {at}, {shift} the transition")
    report.end()
