"""The quantities of a scene, computed in one program. Not in `scene`, which has to check a file without JAX."""

import dataclasses
import functools
from collections.abc import Mapping
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.catalogue import PEAKS, laws_of, read
from plgwear_jax._core.startup.programs import program
from plgwear_jax.contact import FrettingContact, GrossSlipContact
from plgwear_jax.loads import Displacement, Force
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.surfaces import Elastic

_RELATIVE = 0.01  # distance from the edge in contact radii where none is given


@program(static=3)
def scene_values(
    names: tuple[str, ...],
    points: int,
    digits: int | None,
    contact: FrettingContact | GrossSlipContact,
    load: Force | None,
    weights: np.ndarray | None,
    places: Mapping[str, float | None],
) -> dict[str, Array]:
    """The named quantities; weighted sums where the load has weights.

    With them come the "radii" in m, if any quantity needs them, and of the edge where any quantity is unbounded, which
    is the stick radius at the largest amplitude or that of the punch, its "edge radius" and the "edge distance" inside
    it: without a distance this is a hundredth of the contact radius. The last of the radii is there, 0 without an edge.
    Of the peaks of stresses x and z in m come along, as "peak_tension at", without weights.

    The `places` are the distance, those in the half-space, and for quantities over cycles these and Archard's wear
    coefficient in 1/Pa.
    """
    frets, laws, solved = isinstance(contact, FrettingContact), laws_of(contact), {}
    given: dict[str, Any] = {**places}
    value_of = functools.partial(read, contact, load=load, places=given, digits=digits, solved=solved)
    found, beside, punch = {}, jnp.asarray(0.0), jnp.asarray(contact.radius)
    if any(laws[name].unbounded_at for name in names):
        found["edge radius"] = jnp.min(value_of("stick_radius")) if frets else punch
        relative = _RELATIVE * (value_of("contact_radius") if frets else punch)
        found["edge distance"] = relative if given["distance"] is None else jnp.asarray(given["distance"])
        beside = jnp.maximum(found["edge radius"] - found["edge distance"], 0.0)
    if any("r" in laws[name].arguments for name in names):
        if frets:  # half of them in the worn ring, which may be narrow, and none at its ends
            inner, outer = (jnp.max(value_of(name)) for name in ("stick_radius", "worn_radius"))
            even = max(2, points - points // 2)
            ring = jnp.linspace(inner, outer, points - even + 2)[1:-1]
            radii = jnp.sort(jnp.append(jnp.linspace(0.0, 1.25 * outer, even), ring))
        else:
            radii = jnp.linspace(0.0, 2.0 * punch, points)
        given["r"] = found["radii"] = jnp.append(radii, beside)
    for name in names:
        value, mean = value_of(name), weights is not None and "F_x" in laws[name].arguments
        found[name] = jnp.vdot(weights, value) if mean else value  # pyright: ignore[reportArgumentType]
        if name in PEAKS and weights is None:
            found[f"{name} at"] = jnp.stack(getattr(solved[False, True], f"{name}_at"))
    return found


def homogeneous(contact: Any) -> Any:
    """The contact; k = 0 in a file under an elastic parabola is a homogeneous half-space, which has closed forms."""
    material, elastic = contact.material, getattr(contact, "indenter", None) is not None and contact.shape is None
    if elastic and isinstance(material, PowerLawGraded) and material.k == 0.0 and material.nu != "holl":
        return dataclasses.replace(contact, material=Elastic(material.E0, material.nu))
    return contact


class DisplacementEffect(NamedTuple):
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
def displacement_effect(
    contact: FrettingContact, displacement: np.ndarray, rig_stiffness: float | None
) -> DisplacementEffect:
    """What displacement amplitudes in m do to the unworn contact, of the rig if its stiffness in N/m is given."""
    force = jnp.asarray(contact.steady(Displacement(displacement, rig_stiffness)).tangential_force)
    limit = contact.steady(Force(0.0, rig_stiffness)).gross_slip_displacement
    # The energy of a cycle over mu F_N: that of the last cycle of partial slip, and that of sliding beyond it.
    at_rest = contact.steady(0.0)
    last = 4.0 * at_rest.gross_slip_energy_ratio * at_rest.gross_slip_displacement
    return DisplacementEffect(force, limit, last + 4.0 * (displacement - limit))
