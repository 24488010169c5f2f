"""The quantities of a scene, computed in one program. Not in `scene`, which has to check a file without JAX."""

import dataclasses
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._startup.programs import program
from plgwear_jax.catalogue import STRESSES, laws_of, read, read_from
from plgwear_jax.contact import FrettingContact, GrossSlipContact
from plgwear_jax.loads import Displacement, Force
from plgwear_jax.material import PowerLawGraded

_RELATIVE = 0.01  # distance from the edge in contact radii where none is given


class Edge(NamedTuple):
    """What lies beside the edge where quantities are unbounded.

    Attributes:
        radius: Of the edge in m: the stick radius at the largest amplitude, or the radius of the punch.
        distance: The distance inside it in m.
        values: The unbounded functions of the radius at this distance, by name.
    """

    radius: Array
    distance: Array
    values: dict[str, Array]


class Solved(NamedTuple):
    """The result of `evaluate`.

    Attributes:
        radii: In m, if any quantity needs them.
        values: The quantities by name; weighted sums where the load has weights.
        edge: What is known of the edge, if any quantity needs it.
        where: Of stresses x and z of the largest value in m, without weights.
    """

    radii: Array | None
    values: dict[str, Array]
    edge: Edge | None
    where: dict[str, tuple[Array, Array]]


@program(static=3)
def evaluate(
    names: tuple[str, ...],
    points: int,
    digits: int | None,
    contact: FrettingContact | GrossSlipContact,
    load: Force | None,
    weights: np.ndarray | None,
    distance: float | None = None,
    life: tuple[float, float] | None = None,
) -> Solved:
    """The named quantities; without a distance from the edge it is a hundredth of the contact radius.

    The `life` is for quantities over cycles: the cycles, and Archard's wear coefficient in 1/Pa.
    """
    frets, laws = isinstance(contact, FrettingContact), laws_of(contact)
    solved: dict[Any, Any] = {}
    given: dict[str, Any] = {"distance": distance}
    if life is not None:
        given["cycles"], given["wear_coefficient"] = life
    edge, unbounded = None, [name for name in names if laws[name].unbounded_at]
    if unbounded:
        radius = inside = jnp.asarray(contact.radius)
        if frets:
            radius = jnp.min(read(contact, "stick_radius", load, given, digits=digits, solved=solved))
            inside = read(contact, "contact_radius", load, given, digits=digits, solved=solved)
        edge = Edge(radius, _RELATIVE * inside if distance is None else jnp.asarray(distance), {})
    radii = None
    if any("r" in laws[name].arguments for name in names):
        widest = 2.0 * jnp.asarray(contact.radius)
        if frets:
            widest = 1.25 * jnp.max(read(contact, "worn_radius", load, given, digits=digits, solved=solved))
        radii = widest * jnp.linspace(0.0, 1.0, points)
    values = {}
    for name in names:
        beside = edge if name in unbounded and "r" in laws[name].arguments else None
        at = radii
        if beside is not None:
            assert radii is not None
            at = jnp.append(radii, jnp.maximum(beside.radius - beside.distance, 0.0))
        found = read(contact, name, load, given | {"r": at}, digits=digits, solved=solved)
        if beside is not None:
            beside.values[name], found = found[-1], found[:-1]
        values[name] = found if weights is None or "F_x" not in laws[name].arguments else jnp.vdot(weights, found)
    alone = [name for name in names if name in STRESSES and weights is None]
    where = {name: read_from(solved[False, True], f"{name}_at", ()) for name in alone}
    return Solved(radii, values, edge, where)


def homogeneous(contact: Any) -> Any:
    """The contact; k = 0 in a file under an elastic parabola is a homogeneous half-space, which has closed forms."""
    if isinstance(contact, GrossSlipContact) or contact.indenter is None or contact.shape is not None:
        return contact
    material = contact.material
    if not isinstance(material, PowerLawGraded) or material.k != 0.0 or material.nu == "holl":
        return contact
    from plgwear_jax.surfaces import Elastic

    return dataclasses.replace(contact, material=Elastic(material.E0, material.nu))


class Moved(NamedTuple):
    """What a displacement amplitude does to the unworn contact.

    Attributes:
        force: The amplitude of the force in N; NaN where the contact slips as a whole.
        gross_slip: The amplitude in m from which on it does.
        path: The way in m that the contact then slides in a cycle: Archard's worn volume over K F_N.
    """

    force: Array
    gross_slip: Array
    path: Array


@program()
def moved(contact: FrettingContact, displacement: np.ndarray, rig_stiffness: float | None) -> Moved:
    """What displacement amplitudes in m do to the unworn contact, of the rig if its stiffness in N/m is given."""
    force = jnp.asarray(contact.steady(Displacement(displacement, rig_stiffness)).tangential_force)
    limit = contact.steady(Force(0.0, rig_stiffness)).gross_slip_displacement
    # The energy of a cycle over mu F_N: that of the last cycle of partial slip, and that of sliding beyond it.
    at_rest = contact.steady(0.0)
    last = 4.0 * at_rest.gross_slip_energy_ratio * at_rest.gross_slip_displacement
    return Moved(force, limit, last + 4.0 * (displacement - limit))
