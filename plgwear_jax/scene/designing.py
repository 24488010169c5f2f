"""The designs that a scene asks for. Not in `scene`, which has to check a file without JAX."""

from typing import TYPE_CHECKING, Any

import numpy as np

from plgwear_jax import optimise
from plgwear_jax._core.ranges import POSITIVE
from plgwear_jax._core.rules import WrongKeyError, exponents_within
from plgwear_jax.optimise.question import with_variables
from plgwear_jax.wear_laws import law_of

from . import solving
from .keys import ArgumentError, OtherFileError, SceneError

if TYPE_CHECKING:
    from plgwear_jax.tables import Table

    from . import Scene


def arguments_of(
    given: "Scene", key: str, distance: float | None, refusal: type[SceneError] = SceneError
) -> dict[str, Any]:
    """The arguments of `optimise.design`.

    Refused, by this error, is a distance from the stick-slip boundary, of this key, that is larger than the stick
    radius of the reference.
    """
    space = given.asked()
    if space.free:
        raise SceneError("[design] vary.modulus: is free at three depths or more; only plgwear design takes that")
    asked, contact = keywords_of(given), given.build_contact()
    if distance is not None:
        widest = float(contact.steady(given.load.largest).stick_radius)  # pyright: ignore
        if distance >= widest:
            raise refusal(f"{key} = {distance:g}: must be below the stick radius of the reference, {widest:.3g} m")
    vary, scatter = dict(space.variables), space.scatter
    window = vary.pop("modulus", None)
    if window is not None:  # within it k and E0 vary, as far as it reaches
        (first, second), (above, below) = np.log(window["at"]), np.log(window["between"])
        part = (np.log(contact.material.z0) - first) / (second - first)
        reached = np.exp((1.0 - part) * above[:, None] + part * below)  # at z0, from all bounds of both depths
        vary = {"k": exponents_within(**window), "E0": (float(reached.min()), float(reached.max())), **vary}
    asked["vary"] = vary
    if scatter is None:
        return asked
    own, laws = scatter.columns, None
    if "wear_coefficient" in own:
        laws = law_of(own["wear_coefficient"], given.wear.exponent)  # pyright: ignore[reportOptionalMemberAccess]
    # Each has the force that the displacement needs there before any wear, as if it were the contact of the input file.
    forces = None if given.life is not None else forces_in_scenarios(given)
    if forces is not None and np.isnan(forces).any():
        text = "the whole contact slips; a design for the wear of its cycles, with [wear] cycles, takes that"
        raise OtherFileError(f"{scatter.name}: row {scatter.row[np.argmax(np.isnan(forces))]}: {text}")
    return {**asked, "scenarios": optimise.Scenarios(_in_scenarios(given, scatter), own.get("weight"), laws, forces)}


def keywords_of(given: "Scene") -> dict[str, Any]:
    """The arguments of a design of any kind, by name."""
    space, load, wear = given.asked(), given.load, given.wear
    lasting = {}
    if wear is not None and given.life is not None:
        scattered = {} if space.scatter is None else space.scatter.columns
        own = () if "wear_coefficient" in scattered else scattered  # which has a coefficient for each friction
        wear.refuse_frictions([*space.variables, *own, *(load.pressed if load else ())])
        lasting = {"cycles": given.life, "law": wear.law}
    return {
        "contact": given.build_contact(),
        "load": load and load.acting(given.life is not None),
        "weight": load and load.weights,
        "level": space.level,
        "hold": space.hold,
        "minimise": space.minimise,
        "limits": space.allowed,
        **lasting,
    }


def _in_scenarios(given: "Scene", scatter: "Table") -> Any:
    """The contact of a scene in all its scenarios, along a first axis of those numbers that differ."""
    own = {name: x for name, x in scatter.columns.items() if name not in ("wear_coefficient", "weight")}
    return with_variables(given.build_contact(), own)


def forces_in_scenarios(given: "Scene") -> np.ndarray | None:
    """The force amplitude in N that a displacement needs before any wear in each scenario; NaN in gross slip.

    None without scenarios, and under forces.
    """
    scatter, load = given.asked().scatter, given.load
    if scatter is None or load is None or load.pressed or not load.of_displacement:
        return None
    if load.table and given.life is None:
        raise SceneError(
            "[load] table: displacements need other forces in each scenario; give forces, or [wear] cycles"
        )
    contacts = _in_scenarios(given, scatter)
    found = solving.displacement_effect(contacts, load.counting(load.given).max(), load.rig_stiffness)
    return np.broadcast_to(found.force, scatter.row.shape)


def answer(question: str, **arguments: Any) -> Any:
    """What `optimise` answers; refused are numbers that it refuses, such as a modulus beyond the range of numbers."""
    try:
        found = getattr(optimise, question)(**arguments)
    except WrongKeyError as error:
        if error.key == "x":
            raise ArgumentError(str(error)) from None
        raise SceneError(f"[design] {error}") from None
    except ValueError as error:
        of_front = str(error).startswith(("larger", "points"))
        raise SceneError(f"{'' if of_front else 'some value in the input file is too extreme: '}{error}") from None
    values = np.hstack([found.y, found.reference_y] if question == "front" else [found.value, found.reference_value])
    if not POSITIVE.contains(values).all():
        if arguments["load"] is not None and "cycles" not in arguments:
            _ = arguments["contact"].steady(arguments["load"]).wear_volume  # says where it would have to pull
        if np.isfinite(values).all():
            raise SceneError("[design] vary: what is minimised must be > 0 everywhere between the bounds")
        raise SceneError("the wear exceeds the range of numbers: some value in the input file is too extreme")
    return found
