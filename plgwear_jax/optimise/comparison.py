"""A contact beside its reference: all numbers for tables and pictures of both."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import ArrayLike
from plgwear_jax._core.record import record
from plgwear_jax._startup.programs import program
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.optimise.evaluation import Evaluator, concrete, reference_variables, tells_states
from plgwear_jax.optimise.question import Question

_SAMPLES = 201


@record
class Comparison:
    """The quantities of the best contact of a design and of its reference, in SI units, at the largest amplitude.

    The first entry of every array is of the best contact, the second of the reference.

    Attributes:
        quantities: By name, each of shape (2,): "contact_radius", "stick_radius", "worn_radius", "wear_volume",
            "edge_pressure", "modulus_at_radius" and the objective, which is over the whole load. For gross slip
            "volume_change", "force_drop" and "modulus_at_radius"; for a displacement or blocks "contact_radius".
        distance: At which the edge pressure is taken, in m inside the stick-slip boundary; NaN where there is none.
        radii: Places in the worn ring, or on the face of the punch, shape (2, n); from the axis on after a displacement
            or blocks.
        depth: The wear depth there, shape (2, n).
        depths: Depths in the half-space at which the pictures show the modulus, shape (m,): two of a power law.
        modulus: Young's modulus there, shape (2, m).
    """

    quantities: dict[str, Array]
    distance: ArrayLike
    radii: Array
    depth: Array
    depths: Array
    modulus: Array


def side_by_side(question: Question, contact: Any, variables: dict[str, Any]) -> Comparison:
    """A contact with these variables beside the reference of the question, but for what is minimised.

    Raises:
        ValueError: Both have different bodies.
    """
    jax.tree.map(lambda *_: None, contact, question.contact)  # raises a ValueError for different bodies
    pair, evaluator, load = (concrete(contact), concrete(question.contact)), Evaluator(question), question.load
    distance, found = concrete(np.nan if question.distance is None else question.distance), []
    for one, values in zip(reversed(pair), (reference_variables(question), variables), strict=True):
        if load is None:
            found.append(_face(one))
        elif not question.by_force:
            found.append(_worn_by_then(question, one))
        else:
            steady = one.steady(concrete(load.amplitudes)[0])
            if tells_states(question):  # by the program of the search
                told = evaluator.told(evaluator.points(values)).state
                vars(steady)["solved"] = jax.tree.map(lambda x: x[0], told)
            distance, *ring = _ring(steady, distance)  # both at the place of the reference
            found.append(ring)
    quantities, edge, radii, depth = jax.tree.map(lambda *parts: np.stack(parts[::-1]), *map(tuple, found))
    marked = [float(np.asarray(one.places["z"])) for one in question.limits if one.quantity == "modulus_at"]
    ends = min([0.01 * edge[1], *(0.5 * z for z in marked)]), max([10.0 * edge[1], *(2.0 * z for z in marked)])
    depths = concrete(np.geomspace(*ends, 2 if isinstance(contact.material, PowerLawGraded) else _SAMPLES))
    moduli = [_moduli(one.material, np.append(at, depths)) for one, at in zip(pair, edge, strict=True)]
    modulus: Any = np.stack(moduli)
    quantities["modulus_at_radius"] = modulus[:, 0]
    return Comparison(quantities, np.asarray(distance), radii, depth, depths, modulus[:, 1:])


# Each gives quantities, the edge of the contact before any wear, radii and wear depths there.


@program(level=1)
def _ring(steady: Any, distance: Array) -> Any:
    quantities = {name: getattr(steady, name) for name in ("contact_radius", "stick_radius", "worn_radius")}
    radius, inner, outer = quantities.values()
    distance = jnp.where(jnp.isnan(distance), 0.01 * radius, distance)
    quantities |= {"wear_volume": steady.wear_volume, "edge_pressure": steady.edge_pressure(distance)}
    radii = inner + (outer - inner) * jnp.linspace(0.0, 1.0, _SAMPLES)
    return distance, quantities, radius, radii, steady.wear_depth(radii)


@program()
def _face(punch: Any) -> Any:
    steady = punch.steady()
    quantities = {name: getattr(steady, name) for name in ("volume_change", "force_drop")}
    radii = punch.radius * jnp.sin(jnp.linspace(0.0, 0.5 * jnp.pi, _SAMPLES))
    return quantities, punch.radius, radii, punch.depth - steady.steady_displacement(radii)


def _worn_by_then(question: Question, contact: Any) -> Any:
    """Under a load without a steady state: what is worn after the life."""
    horizon, load = question.horizon, question.load
    largest = load.load if load.amplitudes is None else load.with_amplitudes(load.amplitudes[0], None).load
    run, radius = contact.over_cycles(largest, horizon.law), contact.steady(0.0).contact_radius
    radii = run.contact_radius(horizon.cycles) * np.linspace(0.0, 1.0, _SAMPLES)
    return {"contact_radius": radius}, radius, radii, run.depth(radii, horizon.cycles)


@program()
def _moduli(material: Any, depths: Array) -> Array:
    return material.modulus_at(depths)
