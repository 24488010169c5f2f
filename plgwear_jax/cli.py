"""The script `plgwear`: a scene file in, a table, a JSON object or a picture out.

What is wrong with the input is said in one line on standard error, and the exit code is then 2.
"""

import contextlib
import csv
import dataclasses
import io
import json
import math
import sys
import textwrap
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, Any, NamedTuple, TypeVar

import jax
import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from plgwear_jax import __version__, _cli_figures, _cli_new, _cli_sweep, _files, optimise, plots, scene
from plgwear_jax._sections import GrossSlip
from plgwear_jax._terminal import console, refuse, warn
from plgwear_jax.contact import FrettingContact, GrossSlipContact

__all__ = ["app", "asked", "main", "read_scene"]

app = typer.Typer(
    name="plgwear",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
)

_Found = TypeVar("_Found", optimise.Design, optimise.Front)
_Described = tuple[dict[str, float], dict[str, float]]  # quantities of the best contact, and of the reference

SceneFile = Annotated[Path, typer.Argument(metavar="SCENE.toml", help="The scene file.", show_default=False)]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object, in SI units, instead of tables.")]


def main() -> None:
    """Run the script, in double precision."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # a terminal without µ
    jax.config.update("jax_enable_x64", True)
    app(prog_name="plgwear")


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"plgwear {__version__}")
        raise typer.Exit


_HELP = f"""Wear of contacts with graded coatings whose modulus follows a power of the depth, E(z) = E0 (z/z0)^k.

A scene file in TOML says what the coating, the contact and the load are; `plgwear new SCENE.toml` writes one to start
from. A complete one:

{textwrap.indent(_cli_new.FRETTING, "    ")}
Then `plgwear solve SCENE.toml` computes the quantities, `plgwear design SCENE.toml` finds the best coating, and
`plgwear front SCENE.toml` shows what less wear costs in edge pressure. `plgwear sweep` needs no scene: it maps any
quantity over any axes, and `plgwear plot` draws the map.
"""


@app.callback(help=_HELP)
def plgwear(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Print the version and leave.")
    ] = False,
) -> None:
    del version


app.command()(_cli_new.new)


# --- solve ----------------------------------------------------------------------------------------------------------


@app.command()
def solve(
    scene_file: SceneFile,
    as_json: AsJson = False,
    digits: Annotated[
        int | None,
        typer.Option(
            min=1, max=15, help="Correct digits wanted; fewer run faster. By default all.", show_default=False
        ),
    ] = None,
) -> None:
    """Compute the quantities that a scene asks for under [output], or all single numbers if it has no such section.

    Functions of the radius are summed up by their largest value; --json gives them whole.

    Example: plgwear solve design/electrical_contact.toml
    """
    given = read_scene(scene_file)
    try:
        quantities = given.solve(digits=digits)
    except scene.SceneError as error:
        refuse(f"{scene_file}: {error}")
    radius = quantities.get("contact_radius")
    _doubt_units(scene_file, given, None if radius is None else float(radius.value))
    for name, quantity in quantities.items():
        values = np.asarray(quantity.value)
        if np.any(np.isnan(values)) or (quantity.radii is None and np.isinf(values)):
            refuse(f"{scene_file}: {name} exceeds the range of numbers: some value in the scene is too extreme")
    if as_json:
        _print_json({"scene": str(scene_file), "quantities": {name: _listed(q) for name, q in quantities.items()}})
    else:
        _print_quantities(scene_file, quantities)


def _listed(quantity: scene.Quantity) -> dict[str, Any]:
    known = {"value": quantity.value, "unit": quantity.unit, "description": quantity.description}
    return known if quantity.radii is None else known | {"radii": quantity.radii, "radii_unit": "m"}


def _print_quantities(scene_file: Path, quantities: dict[str, scene.Quantity]) -> None:
    table = _table(scene_file)
    table.add_column("quantity", no_wrap=True)
    table.add_column("value", justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    along = any(quantity.radii is not None for quantity in quantities.values())
    if along:
        table.add_column("at r", no_wrap=True)
    table.add_column("meaning")
    for name, quantity in quantities.items():
        value, place, meaning = quantity.value, "", quantity.description
        if isinstance(value, np.ndarray) and quantity.radii is not None:
            extreme = 0 if quantity.unbounded_at else int(np.argmax(np.abs(value)))
            value, place = float(value[extreme]), _measure(quantity.radii[extreme], "m")
            meaning += f"; unbounded at {quantity.unbounded_at}" if quantity.unbounded_at else "; largest"
        number, _, unit = _measure(float(value), quantity.unit).partition(" ")
        table.add_row(name, number, unit, *([place] if along else []), meaning)
    console().print(table)


# --- design ---------------------------------------------------------------------------------------------------------

Picture = Annotated[
    Path | None,
    typer.Option(
        help="Where to draw the picture: a .png, .pdf or .svg file. By default it is named after the scene, here.",
        show_default=False,
    ),
]


@app.command()
def design(
    scene_file: SceneFile,
    as_json: AsJson = False,
    picture: Picture = None,
    sensitivities: Annotated[
        bool, typer.Option("--sensitivities", help="Also tell how the design changes with every input; takes longer.")
    ] = False,
) -> None:
    """Find the coating that wears least, within the bounds that a scene gives under [design], and draw it.

    The reference that it is compared with is the scene's own [material]. The exit code is 1 if the search did not end
    at a minimum that keeps the limits, or met something better elsewhere.

    Example: plgwear design design/electrical_contact.toml --picture best.pdf
    """
    given, arguments = asked(scene_file)
    picture = picture or Path(f"{scene_file.stem}-design.png")
    with _refusing_targets():
        plots.check_target(picture)
        found = _search(scene_file, lambda: optimise.design(**arguments))
        plots.save(plots.design_picture(found), picture)
    described = _described(given, found)
    _doubt_units(scene_file, given, described[1].get("contact_radius"))
    higher = _if_higher(given, found)
    slopes = optimise.sensitivities(found) if sensitivities else None
    if as_json:
        report = {"scene": str(scene_file), **_design_as_json(given, found, described, higher), "picture": str(picture)}
        _print_json(report if slopes is None else report | {"sensitivities": dataclasses.asdict(slopes)})
    else:
        _print_design(scene_file, given, found, described, higher)
        if slopes is not None:
            _print_sensitivities(slopes)
        typer.echo(f"picture: {scene.one_line(str(picture))}")
    if not found.certified:
        warn(f"{scene_file}: {_verdict(found)}")
        raise typer.Exit(1)


_UNITS = {
    "k": "1",
    "E0": "Pa",
    "z0": "m",
    "modulus_at_radius": "Pa",
    "shallow_modulus": "Pa",
    "deep_modulus": "Pa",
    "wear_volume": "m^3",
    "deepest_wear": "m",
    "volume_change": "m^3",
    "force_drop": "1",
    "contact_radius": "m",
    "stick_radius": "m",
    "worn_radius": "m",
    "edge_exponent": "1",
    "edge_pressure": "Pa",
    "penetration": "m",
}
_MEANINGS = {
    "k": "exponent k",
    "E0": "modulus E0 ...",
    "z0": "... at the depth z0",
    "modulus_at_radius": "modulus as deep as the contact radius",
    "wear_volume": "wear volume",
    "deepest_wear": "deepest wear",
    "volume_change": "effective volume worn off",
    "force_drop": "normal force lost, as a share",
    "contact_radius": "contact radius",
    "stick_radius": "stick radius, inside the worn ring",
    "worn_radius": "worn radius, outside of it",
    "edge_exponent": "stress at the edge, exponent (k-1)/2",
    "penetration": "penetration",
}


def _words(distance: float, depths: tuple[float, float] | None) -> dict[str, str]:
    """What each quantity is called, with the place of those that have one."""
    moduli = zip(("shallow_modulus", "deep_modulus"), depths or (), strict=False)
    placed = {name: f"modulus at {_measure(depth, 'm')}" for name, depth in moduli}
    return _MEANINGS | placed | {"edge_pressure": f"pressure {_measure(distance, 'm')} inside the stick edge"}


def asked(scene_file: Path) -> tuple[scene.Scene, dict[str, Any]]:
    """The scene and the arguments of `optimise.design`."""
    given = read_scene(scene_file)
    space, load = given.design, given.load
    if space is None:
        refuse(f"{scene_file}: [design]: missing; it says what may vary")
    if load is not None and load.largest == 0.0:
        key = "tangential_force = 0.0" if load.tangential_force is not None else "all amplitudes are 0"
        refuse(f"{scene_file}: [load] {key}: nothing wears, so there is nothing to design")
    contact, distance = given.build_contact(), (space.allowed or {}).get("distance")
    if distance is not None:
        _refuse_beyond_the_middle(f"{scene_file}: [design] limits.edge_pressure.distance", distance, given, contact)
    return given, {
        "contact": contact,
        "tangential_force": None if load is None else load.force,
        "vary": _with_window(space.variables),
        "weight": None if load is None else load.weights,
        "level": space.level,
        "hold": space.held,
        "minimise": space.minimise,
        "limits": optimise.Limits(**_with_window(space.allowed or {})),
    }


def _refuse_beyond_the_middle(key: str, distance: float, given: scene.Scene, contact: Any) -> None:
    """A place inside the stick edge has to be inside the contact."""
    assert given.load is not None
    widest = float(contact.stick_radius(given.load.largest))
    if distance >= widest:
        refuse(f"{key} = {distance:g}: must be below the stick radius of the reference, {widest:.3g} m")


def _doubt_units(scene_file: Path, given: scene.Scene, contact_radius: float | None = None) -> None:
    """Say what is out of all proportion, as numbers in wrong units are."""
    material, contact = given.material, given.contact
    high, about = (contact.depth, "depth") if isinstance(contact, GrossSlip) else (contact_radius, "contact radius")
    if high is not None and high > 0.3 * contact.radius:
        times = f"{high / contact.radius:.2g} times the radius of the indenter"
        said = f"the {about}, {_measure(high, 'm')}, is {times}; the formulas hold for small ones"
        warn(f"{scene_file}: {said}; is E0 = {material.E0:g} in Pa, is all else in m and N?")
    if material.z0 > 0.1:
        warn(f"{scene_file}: [material] z0 = {material.z0:g}: a coating {material.z0:g} m thick? z0 is in m")


def _with_window(named: dict[str, Any]) -> dict[str, Any]:
    return {name: optimise.ModulusWindow(**x) if name == "modulus" else x for name, x in named.items()}


def _search(scene_file: Path, search: Callable[[], _Found]) -> _Found:
    try:
        with Console(stderr=True).status("looking for the least wear ..."):
            found = search()
    except ValueError as error:  # such as a modulus beyond the range of numbers
        refuse(f"{scene_file}: some value in the scene is too extreme: {error}")
    values = np.asarray(found.value)
    if not (np.all(values > 0.0) and np.all(np.isfinite(values))):
        refuse(f"{scene_file}: the wear exceeds the range of numbers: some value in the scene is too extreme")
    return found


def _edge_distance(found: optimise.Design) -> float | None:
    """Where inside the stick edge stresses are compared: as the scene says, else at 1 % of the contact radius."""
    if isinstance(found.reference, GrossSlipContact):
        return None
    distance = found.task.limits.distance
    return float(0.01 * found.reference.contact_radius() if distance is None else np.asarray(distance))


def _described(given: scene.Scene, found: optimise.Design) -> _Described:
    """What the best design and the reference are judged by, in SI units; but for the objective at the largest load."""
    described = []
    for contact, objective in ((found.contact, found.value), (found.reference, found.reference_value)):
        material = contact.material
        quantities: dict[str, Any] = {"k": material.k, "E0": material.E0, "z0": material.z0}
        if isinstance(contact, GrossSlipContact):
            quantities |= {name: getattr(contact, name)() for name in ("volume_change", "force_drop")}
            depth = contact.radius
        else:
            assert given.load is not None
            force = given.load.largest
            for name in dict.fromkeys((found.objective, "wear_volume", "stick_radius", "worn_radius")):
                quantities[name] = objective if name == found.objective else getattr(contact, name)(force)
            quantities["contact_radius"] = depth = contact.contact_radius()
            quantities["edge_exponent"] = 0.5 * (material.k - 1.0)
            quantities["edge_pressure"] = contact.edge_pressure(_edge_distance(found), force)  # pyright: ignore[reportArgumentType]
        quantities["modulus_at_radius"] = material.modulus(depth)
        described.append({name: float(quantities[name]) for name in _UNITS if name in quantities})
    best, reference = described
    return best, reference


class _Higher(NamedTuple):
    """What happens if all amplitudes are 10 % higher than thought."""

    line: str
    loss: float | None = None


def _if_higher(given: scene.Scene, found: optimise.Design) -> _Higher | None:
    if given.load is None or not isinstance(found.contact, FrettingContact):
        return None
    said = "if the amplitude is 10 % higher than you think,"
    try:
        higher = optimise.misjudged(found, 1.1)
    except ValueError:
        return _Higher(f"{said} the contact slips as a whole")
    force, limits = 1.1 * given.load.largest, found.task.limits
    broken = []
    if limits.edge_pressure is not None and limits.distance is not None:
        broken.append(("edge_pressure", found.contact.edge_pressure(limits.distance, force), limits.edge_pressure))
    if limits.penetration is not None:
        broken.append(("penetration", found.contact.penetration(force), limits.penetration))
    words = _words(_edge_distance(found) or 0.0, None)
    for name, value, allowed in broken:
        if value > allowed * 1.000001:
            over = f"the {words[name]} is {_measure(float(value), _UNITS[name])}"
            return _Higher(f"{said} this design breaks a limit: {over}")
    if not higher.best.converged:
        return _Higher(f"{said} what it loses is not known: the search for the best one did not converge")
    loss = max(higher.loss, 0.0)
    lost = f"{100.0 * loss:.2g} %" if loss > 1e-6 else "nothing"
    return _Higher(f"{said} this design loses {lost} against the best one for it", loss)


def _saving(found: optimise.Design, best: dict[str, float], reference: dict[str, float], words: dict[str, str]) -> str:
    """What the design gains, and what that costs in edge stress."""
    much = f"{abs(100.0 * found.saving):.3g} % {'less' if found.saving >= 0.0 else 'MORE'}"
    line = f"{much} {words[found.objective].partition(',')[0]} than the reference"
    if "edge_pressure" not in best:
        return line
    times = best["edge_pressure"] / reference["edge_pressure"]
    return f"{line}, at {times:.3g} times its {words['edge_pressure']}"


def _measured(given: scene.Scene, objective: str) -> str | None:
    """Which amplitudes count, and how, where there are many."""
    load, space = given.load, given.design
    if load is None or space is None or load.table is None:
        return None if load is None else load.remark
    level, count = space.level, load.amplitudes.size
    worst = f"mean over the worst {100.0 * (1.0 - level):.3g} %"
    part = {0.0: "mean", 1.0: "value at the largest"}.get(level, worst)
    told = f"the {_MEANINGS[objective].partition(',')[0]} is its {part}, all else is at the largest, {load.largest:g} N"
    return f"table {scene.one_line(load.table)}: {count} amplitude{'s' if count > 1 else ''}; {told}"


def _verdict(found: optimise.Design) -> str:
    """Whether this is the best design, and why one can believe it."""
    if not found.keeps_limits:
        return "NO DESIGN THAT KEEPS THE LIMITS was found; the one that comes nearest is shown"
    if not found.converged:
        return "the search DID NOT CONVERGE; this is the best design that it met"
    if not found.certified:
        return "the search converged, but there MAY BE LESS WEAR ELSEWHERE between the bounds"
    if found.proven:
        return "the search converged; nothing better was met, and nothing better can hide between the points scanned"
    hiding = "; that nothing better hides between the points scanned is not proven" if len(found.variables) == 1 else ""
    return f"the search converged; nothing better was met{hiding}"


def _rival(found: optimise.Design) -> str | None:
    """The next best minimum, in words."""
    if found.rival is None:
        return None
    where = ", ".join(f"{name} = {_measure(value, _UNITS[name])}" for name, value in found.rival.items())
    more = found.rival_value / float(found.value) - 1.0
    return f"the next best minimum, at {where}, is {f'{100.0 * more:.2g} % worse' if more > 1e-9 else 'as good'}"


def _broken(name: str, state: optimise.LimitState) -> bool:
    excess = math.log(float(state.value) / float(np.asarray(state.allowed)))
    return (-excess if name.endswith("_lowest") else excess) > 1e-6


def _design_as_json(
    given: scene.Scene, found: optimise.Design, described: _Described, higher: _Higher | None
) -> dict[str, Any]:
    best, reference = described
    bounds = {name: np.asarray(ends).tolist() for name, ends in found.task.bounds.items()}
    return {
        "best": best,
        "reference": reference,
        "units": {name: unit for name, unit in _UNITS.items() if name in best | bounds},
        "edge_distance": _edge_distance(found),
        "objective": found.objective,
        "load": _measured(given, found.objective),
        "less_wear_percent": 100.0 * found.saving,
        "vary": {
            name: {"value": found.variables[name], "bounds": ends, "at_bound": found.at_bound[name]}
            for name, ends in bounds.items()
        },
        "hold": found.question.hold,
        "limits": {
            name: {
                "value": float(state.value),
                "allowed": float(np.asarray(state.allowed)),
                "kept": not _broken(name, state),
                "active": state.active,
                "multiplier": float(state.multiplier),
            }
            for name, state in found.limits.items()
        },
        "verdict": _verdict(found),
        "converged": found.converged,
        "certified": found.certified,
        "proven": found.proven,
        "projected_gradient": float(found.minimum.projected_gradient),
        "steps": int(found.minimum.steps),
        "rival": None if found.rival is None else {"variables": found.rival, "value": found.rival_value},
        "if_10_percent_higher": None if higher is None else {"line": higher.line, "loss": higher.loss},
    }


def _print_design(
    scene_file: Path, given: scene.Scene, found: optimise.Design, described: _Described, higher: _Higher | None
) -> None:
    words = _words(_edge_distance(found) or 0.0, _floats(found.task.depths))
    best, reference = described
    measured = _measured(given, found.objective)
    if measured is not None:
        typer.echo(measured)
    table = _table(scene_file)
    table.add_column("")
    for heading in (_found_as(found), "reference"):
        table.add_column(heading, justify="right", no_wrap=True)
    for name, value in best.items():
        table.add_row(words[name], *_measures((value, reference[name]), _UNITS[name]))
    console().print(table)
    _print_allowed(found, words)
    if found.keeps_limits:
        lines = _saving(found, best, reference, words), _verdict(found), _rival(found), higher and higher.line
    else:  # what it would save, and for how long, is of no use
        lines = (_verdict(found),)
    for line in (*lines, _too_stiff(best)):
        if line:
            typer.echo(line)


def _found_as(found: optimise.Design) -> str:
    return "best" if found.keeps_limits else "nearest"


_DIAMOND = 1.2e12  # Pa


def _too_stiff(best: dict[str, float]) -> str | None:
    """A line about moduli that nobody can make."""
    modulus = best["modulus_at_radius"]
    if modulus < _DIAMOND:
        return None
    return f"{_measure(modulus, 'Pa')} is stiffer than diamond: bound what can be made by limits = {{ modulus = ... }}"


def _print_allowed(found: optimise.Design, words: dict[str, str]) -> None:
    """What was varied and limited, and which of the bounds and limits hold the design back."""
    table = Table()
    table.add_column("varied and limited" if found.limits else "varied")
    table.add_column(_found_as(found), justify="right", no_wrap=True)
    table.add_column("allowed", no_wrap=True)
    table.add_column("")
    for name, ends in found.task.bounds.items():
        lower, upper = (_measure(float(np.asarray(end)), _UNITS[name]) for end in ends)
        side = found.at_bound[name]
        symbol = name if name in ("k", "E0", "z0") else words[name]
        value = _measure(found.variables[name], _UNITS[name])
        standing = f"at the {side} bound" if side else "between"
        if side and found.keeps_limits:
            # the slope of the objective's logarithm by k, or by the logarithm of the variable
            gain = abs(float(found.minimum.bound_multipliers[name]))
            standing += f"; {'0.01' if name == 'k' else '1 %'} wider saves {gain:.2g} %"
        table.add_row(symbol, value, f"{lower} to {upper}", standing)
    window = found.task.limits.modulus
    words = words if window is None else words | _words(_edge_distance(found) or 0.0, _floats(window.at))
    for name, state in found.limits.items():
        what, least = name.removesuffix("_lowest").removesuffix("_highest"), name.endswith("_lowest")
        value, allowed = (_measure(float(np.asarray(x)), _UNITS[what]) for x in (state.value, state.allowed))
        standing = "BROKEN" if _broken(name, state) else "kept"
        if state.active and found.keeps_limits:
            standing = f"reached; 1 % looser saves {float(state.multiplier):.2g} %"
        table.add_row(words[what], value, f"at {'least' if least else 'most'} {allowed}", standing)
    console().print(table)


def _floats(pair: Any) -> tuple[float, float] | None:
    return None if pair is None else (float(np.asarray(pair[0])), float(np.asarray(pair[1])))


_NEGLIGIBLE = 1e-6  # of a change that is told


def _print_sensitivities(slopes: optimise.Sensitivities) -> None:
    """What changes if an input grows by 1 %; inputs that change nothing are only named."""
    typer.echo("what changes if an input grows by 1 % (k, nu: by 0.01):")
    table = Table()
    table.add_column("input", no_wrap=True)
    table.add_column("saving (points)", justify="right", no_wrap=True)
    for name in next(iter(slopes.variables.values())):
        table.add_column(name if name == "k" else f"{name} (%)", justify="right", no_wrap=True)
    idle = []
    for source, by in slopes.variables.items():
        changes = [slopes.saving[source], *(0.01 * x if name == "k" else x for name, x in by.items())]
        if all(abs(change) < _NEGLIGIBLE for change in changes):
            idle.append(source)
        else:
            # the best one's is an outcome
            label = "k of the reference" if source == "k" else source
            table.add_row(label, *(f"{x:+.2g}" if abs(x) >= _NEGLIGIBLE else "0" for x in changes))
    console().print(table)
    if idle:
        typer.echo(f"without effect: {', '.join(idle)}")


# --- front ----------------------------------------------------------------------------------------------------------


@app.command()
def front(
    scene_file: SceneFile,
    distance: Annotated[
        float | None,
        typer.Option(
            help="Distance from the stick edge in m; by default that of the scene's limit.", show_default=False
        ),
    ] = None,
    points: Annotated[int, typer.Option(min=2, max=10_000, help="How many designs.")] = 21,
    as_json: AsJson = False,
    picture: Picture = None,
    csv_file: Annotated[
        Path | None,
        typer.Option("--csv", help="A .csv file to write the front to, in SI units.", show_default=False),
    ] = None,
) -> None:
    """Show what less wear costs: the least wear for each pressure that may be allowed beside the stick edge.

    Singularities of different order are compared by the pressure at a critical distance inside the stick edge. All else
    is as for `plgwear design`, but for the scene's own limit of that pressure. The exit code is 1 if any point of the
    front is not certain.

    Example: plgwear front design/electrical_contact.toml --distance 1e-6 --csv front.csv
    """
    given, arguments = asked(scene_file)
    contact, limits = arguments["contact"], arguments["limits"]
    if not isinstance(contact, FrettingContact):
        refuse(f'{scene_file}: [contact] kind = "gross-slip": there is no stick edge, and so nothing to trade')
    if distance is None:
        distance = limits.distance
    elif not 0.0 < distance < math.inf:
        refuse(f"--distance {distance}: must be a finite number > 0, in m")
    else:
        _refuse_beyond_the_middle(f"{scene_file}: distance", distance, given, contact)
    if distance is None:
        refuse(f"{scene_file}: name the distance from the stick edge with --distance, in m")
    arguments["limits"] = dataclasses.replace(limits, edge_pressure=None, distance=None)
    picture = picture or Path(f"{scene_file.stem}-front.png")
    with _refusing_targets():
        plots.check_target(picture)
        if csv_file is not None:
            _files.check_target(csv_file, (".csv",))
        found = _search(scene_file, lambda: optimise.front(**arguments, distance=distance, points=points))
        columns: dict[str, Any] = {"edge_pressure": found.edge_pressure, found.objective: found.value}
        columns = {name: np.asarray(column) for name, column in (columns | found.variables).items()}
        flags = {"converged": np.asarray(found.converged), "certified": np.asarray(found.certified)}
        reference = _reference_of_front(given, arguments, distance)
        plots.save(plots.front_picture(found, reference), picture)
        if csv_file is not None:
            _write_csv(columns | flags, csv_file)
    certain = flags["certified"]
    if as_json:
        units = {name: _UNITS[name] for name in columns}
        place = {"scene": str(scene_file), "edge_distance": distance, "objective": found.objective}
        compared = {"reference": dict(zip(columns, reference, strict=False)), "units": units}
        _print_json({**place, **columns, **flags, **compared, "picture": str(picture)})
    else:
        measured = _measured(given, found.objective)
        if measured is not None:
            typer.echo(measured)
        window = arguments["vary"].get("modulus")
        _print_front(scene_file, columns, certain, reference, _words(distance, window and window.at))
        for kind, file in (("picture", picture), ("table", csv_file)):
            if file is not None:
                typer.echo(f"{kind}: {scene.one_line(str(file))}")
    if not certain.all():
        warn(f"{scene_file}: {np.sum(~certain)} of {certain.size} points of the front are NOT CERTAIN")
        raise typer.Exit(1)


def _reference_of_front(given: scene.Scene, arguments: dict[str, Any], distance: float) -> tuple[float, float]:
    """Edge pressure and objective of the scene's own material."""
    assert given.load is not None
    contact, force, weight = (arguments[name] for name in ("contact", "tangential_force", "weight"))
    objective = np.asarray(getattr(contact, arguments["minimise"])(force))
    if weight is not None:
        objective = np.vdot(np.asarray(optimise.tail_weights(force, weight, arguments["level"])), objective)
    return float(contact.edge_pressure(distance, given.load.largest)), float(objective)


def _print_front(
    scene_file: Path,
    columns: dict[str, np.ndarray],
    certain: np.ndarray,
    reference: tuple[float, float],
    words: dict[str, str],
) -> None:
    table = _table(scene_file)
    for name in columns:
        table.add_column(words[name].removesuffix(" ..."), justify="right")
    table.add_column("")
    pressures = columns["edge_pressure"]
    same = bool(np.ptp(pressures) <= 1e-9 * np.max(pressures))
    for row, sure in enumerate(certain[:1] if same else certain):
        cells = (_measure(float(column[row]), _UNITS[name]) for name, column in columns.items())
        table.add_row(*cells, "" if sure else "NOT CERTAIN")
    table.add_section()
    cells = [_measure(value, _UNITS[name]) for name, value in zip(columns, reference, strict=False)]
    table.add_row(*cells, *(len(columns) - len(cells)) * [""], "reference")
    console().print(table)
    if same:
        typer.echo("one design has both the least wear and the least pressure: there is nothing to trade")


def _write_csv(columns: dict[str, np.ndarray], path: Path) -> None:
    def write(target: Path) -> None:
        with target.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(columns)
            writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))

    _files.write(path, write)


@contextlib.contextmanager
def _refusing_targets() -> Iterator[None]:
    """Refuse what cannot be written to."""
    try:
        yield
    except _files.TargetError as error:
        refuse(str(error))


# --- the other commands -----------------------------------------------------------------------------------------------

app.command()(_cli_sweep.sweep)
app.command()(_cli_sweep.plot)
app.command()(_cli_figures.figures)
app.command()(_cli_new.schema)


# --- words ----------------------------------------------------------------------------------------------------------


def read_scene(scene_file: Path) -> scene.Scene:
    """The scene of a file, or a line that refuses it."""
    try:
        return scene.load(scene_file)
    except scene.SceneError as error:
        refuse(str(error))


def _table(scene_file: Path) -> Table:
    return Table(title=scene.one_line(str(scene_file)), title_justify="left", title_style="bold")


def _measure(value: float, unit: str) -> str:
    """A number with its unit, as a person writes it."""
    factor, name = plots.readable(value, unit)
    return f"{value / factor:.4g} {name}".rstrip()


def _measures(values: tuple[float, ...], unit: str) -> list[str]:
    """Numbers to be compared with each other, all with the prefix of the smallest unless others become too long."""
    smallest, largest = min(values, key=abs), max(values, key=abs)
    factor, name = plots.readable(smallest, unit)
    if smallest == 0.0 or abs(largest) >= 1e4 * factor:
        return [_measure(value, unit) for value in values]
    return [f"{value / factor:.4g} {name}".rstrip() for value in values]


def _print_json(found: dict[str, Any]) -> None:
    typer.echo(json.dumps(_plain(found), allow_nan=False))


def _plain(value: Any) -> Any:
    """The same in what JSON has; a number that is not finite becomes null."""
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items()}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
