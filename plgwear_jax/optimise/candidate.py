"""A choice of the variables: what is minimised there, and how far each limit is broken.

Every quantity is that of the contact with these variables, by its name in the catalogue. Two short cuts give the same
numbers in less time. Closed forms are taken in units of a_0, which is computed once, and not at all where it is held.
A power law under an elastic indenter, of which only the half-space varies, is solved with its slopes by the half-space.
"""

import dataclasses
import functools
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.typing import ArrayLike

from plgwear_jax import fretting, gross_slip
from plgwear_jax.catalogue import TANGENTIAL, laws_of, read
from plgwear_jax.contact import is_closed
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.optimise.life import Life
from plgwear_jax.optimise.loads import solved_at, without_padding
from plgwear_jax.optimise.minimum import Interval
from plgwear_jax.optimise.question import (
    DEEP,
    SHALLOW,
    Limit,
    Question,
    leaf_of,
    limits_by_name,
    solved_one_by_one,
    with_leaf,
)
from plgwear_jax.rules import BY_THEN, is_after_cycles, is_linear
from plgwear_jax.wear_laws import Archard

if TYPE_CHECKING:  # designs for the steady state do not need it
    from plgwear_jax.optimise.along_exponent import RunsAlongExponent

# Units of the dimensionless functions, as powers of what they consist of.
_UNITS: dict[str | None, dict[str, float]] = {
    "1": {},
    "a_0": {"a_0": 1.0},
    "a_0^2/R": {"a_0": 2.0, "radius": -1.0},
    "a_0^4/R": {"a_0": 4.0, "radius": -1.0},
    "F_N/(pi a_0^2)": {"normal_force": 1.0, "pi": -1.0, "a_0": -2.0},
    "mu F_N/(pi a_0^2)": {"friction": 1.0, "normal_force": 1.0, "pi": -1.0, "a_0": -2.0},
    "pi a^2 d": {"pi": 1.0, "radius": 2.0, "depth": 1.0},
}
HALF_SPACE = {"k", "E0", "z0", "nu", SHALLOW, DEEP}
_DIGITS = 4  # of contacts that are solved numerically


class Candidate:
    """Choices of the variables: their contacts, objective and limits. Only what is used is computed.

    The variables are scalars, or for closed forms arrays of one shape.
    """

    def __init__(
        self,
        question: Question,
        variables: Mapping[str, ArrayLike],
        radii: tuple[Array | None, Array] | None = None,  # a_0 with nothing held, and the held a_0, where known
        runs: "RunsAlongExponent | None" = None,
    ) -> None:
        self.question, self.variables, self.radii, self.runs = question, variables, radii, runs
        self.laws = laws_of(question.contact)
        self.numeric, self._fast = not is_closed(question.contact), by_half_space(question)
        self._known: dict[Any, Any] = {}  # what was solved of the contact, for all quantities

    @functools.cached_property
    def free(self) -> Any:
        """Their contacts with nothing held."""
        contact, changes = self.question.contact, dict(self.variables)
        if SHALLOW in changes:
            assert self.question.depths is not None
            z1, z2 = self.question.depths
            E1, E2 = changes.pop(SHALLOW), changes.pop(DEEP)
            k = jnp.log(jnp.asarray(E2) / E1) / jnp.log(jnp.asarray(z2) / z1)
            changes |= {"E0": E1, "z0": z1, "k": k}
        for name, value in changes.items():
            contact = with_leaf(contact, name, value)
        return contact

    @functools.cached_property
    def contact(self) -> Any:
        """Their contacts, with E0 or z0 adjusted to hold the contact radius."""
        hold, free = self.question.hold, self.free
        if hold is None:
            return free
        material, log_stiffening = free.material, self._log_stiffening()
        if hold == "contact_radius_by_E0":
            material = dataclasses.replace(material, E0=material.E0 * jnp.exp(log_stiffening))
        else:
            material = dataclasses.replace(material, z0=material.z0 * jnp.exp(-log_stiffening / material.k))
        return dataclasses.replace(free, material=material)

    def _log_stiffening(self) -> Array:
        """The logarithm of the factor by which the half-space has to be stiffer for the held radius."""
        if self.numeric:
            return self._half_space[1] - self.free.material.log_stiffness()
        # a_0 depends on E0/z0^k alone, Eq. (12).
        radius = self.radii[0] if self.radii else None
        radius = self.free.contact_radius() if radius is None else radius
        return (3.0 + jnp.asarray(self.free.material.k)) * jnp.log(radius / self.contact_radius)

    @functools.cached_property
    def contact_radius(self) -> Array:
        """Their initial contact radii a_0 in m."""
        if self.question.hold is not None:
            return self.radii[1] if self.radii else self.question.contact.contact_radius()
        if not self.numeric:
            return self.contact.contact_radius()
        return jnp.exp(self.solved.contact_radius) if self._fast else self.contact.contact_radius(digits=_DIGITS)

    @property
    def phi(self) -> Any:
        """The amplitudes F_x/(mu F_N) along a last axis, the largest first."""
        assert self.question.load is not None
        return self.question.load.tangential_force / jnp.asarray(self.free.friction * self.free.normal_force)[..., None]

    # --- what is minimised, and the limits --------------------------------------------------------------------------

    def objective(self) -> Array:
        """The logarithm of what is minimised, divided by a constant; see `log_unit`."""
        name, places, load = self.question.objective, self.question.places, self.question.load
        if solved_one_by_one(self.question):
            assert load is not None
            logs, between = self._all_logs() - self.log_unit(), self._amplitudes[1]
            return jnp.log(jnp.exp(logs if between is None else logs @ between.T) @ load.weight)
        value = self._in_units(name, places, load is not None)
        return jnp.log(value if load is None else (load.weight * value).sum(-1)) + self._log_unit(name, True)

    def amounts(self) -> Array:
        """What is minimised at each amplitude along a last axis, in SI units; its mean is not taken."""
        name, places, load = self.question.objective, self.question.places, self.question.load
        if load is None:
            return self.value(name, places)[..., None]
        if not solved_one_by_one(self.question):
            return self._in_units(name, places, True) * jnp.exp(jnp.asarray(self._log_unit(name, None)))[..., None]
        logs, between = self._all_logs(), self._amplitudes[1]
        return jnp.exp(logs if between is None else logs @ between.T)

    def log_unit(self) -> ArrayLike:
        """The logarithm of that constant, in SI units; of the size of the contact where it is solved numerically."""
        return self._log_unit(self.question.objective, False)

    def states(self) -> dict[str, tuple[Array, ArrayLike, int]]:
        """For each limit the value at the largest amplitude, the limit, and the allowed side: -1 below, +1 above."""
        found: dict[str, tuple[Array, ArrayLike, int]] = {}
        allowed, window = limits_by_name(self.question.limits), self.question.window
        for name, limit in self.question.limits.items():
            value = self.value(name, limit.places) if isinstance(limit, Limit) else None
            for which in (name, f"{name}_lowest", f"{name}_highest"):
                if value is not None and which in allowed:
                    found[which] = value, allowed[which], 1 if which.endswith("_lowest") else -1
        if window is not None:
            for name, depth in zip((SHALLOW, DEEP), window.at, strict=True):
                modulus = self.contact.material.modulus(depth)
                for which, side in ((f"{name}_lowest", 1), (f"{name}_highest", -1)):
                    found[which] = modulus, allowed[which], side
        return {name: found[name] for name in allowed}

    def excess(self) -> list[Array]:
        """log(value/limit) for each limit, with the sign that is positive where the limit is broken."""
        return [-side * _log(value / bound) for value, bound, side in self.states().values()]

    def rows(self) -> Array:
        """The objective and the excess of each limit, along a last axis of 1 + m."""
        return jnp.stack(jnp.broadcast_arrays(self.objective(), *self.excess()), axis=-1)

    def value(self, name: str, places: Mapping[str, ArrayLike]) -> Array:
        """A quantity in SI units at the largest amplitude."""
        if is_after_cycles(name):
            return jnp.exp(self._logs_by_then(name, places)[..., 0])
        if name == "contact_radius":
            return self.contact_radius
        if self.numeric:
            return jnp.exp(self._logs(name, places)[0])
        return self._in_units(name, places, False) * jnp.exp(self._log_unit(name, None))

    # --- closed forms -----------------------------------------------------------------------------------------------

    def _in_units(self, name: str, places: Mapping[str, ArrayLike], every: bool) -> Any:
        """A quantity in its unit of `_UNITS`, else in SI units: at every amplitude on a last axis, or the largest."""
        law, contact, load = self.laws[name], self.free, self.question.load

        def spread(x: Any) -> Array:
            return jnp.asarray(x)[..., None] if every else jnp.asarray(x)

        force = None if load is None else load.tangential_force if every else load.tangential_force[0]
        if law.scale not in _UNITS or name in TANGENTIAL:
            return read(jax.tree.map(spread, self.contact), name, force, places)
        if load is None:
            return getattr(gross_slip, name)(contact.material.k)
        at = [spread(places[one] / self.contact_radius) for one in law.arguments if one in places]
        amplitude = [self.phi if every else self.phi[..., 0]] if "F_x" in law.arguments else []
        return getattr(fretting, name)(*at, spread(contact.material.k), *amplitude)

    def _log_unit(self, name: str, varies: bool | None) -> Any:
        """The logarithm of a unit: of the part that varies or of the rest, or of all of it."""
        total: Any = 0.0
        for part, power in _UNITS.get(self.laws[name].scale, {}).items():
            moves = part in self.question.bounds if part != "a_0" else self.question.hold is None
            if varies is None or varies == (moves and not self.numeric):
                total = total + power * self._log_part(part)
        return total

    def _log_part(self, part: str) -> Any:
        contact = self.question.contact if self.numeric else self.free
        if part == "pi":
            return np.log(np.pi)
        if part != "a_0":
            return jnp.log(jnp.asarray(getattr(contact, part)))
        if not self.numeric:
            return jnp.log(self.contact_radius)
        if contact.indenter is not None:
            modulus = contact.indenter.plane_modulus
        elif isinstance(contact.material, PowerLawGraded):
            return jnp.log(jnp.asarray(contact.radius))
        else:
            modulus = jnp.max(jnp.asarray(contact.material.modulus))
        return jnp.log(contact.normal_force * jnp.asarray(contact.radius) / modulus) / 3.0

    # --- one by one -------------------------------------------------------------------------------------------------

    @functools.cached_property
    def _amplitudes(self) -> tuple[Array, Array | None]:
        """(phi at which it is solved, the largest first, the matrix from there to those of the load)."""
        life = self.question.life
        return solved_at(self._counting(self.phi), life is None or life.load is None)

    def _logs(self, name: str, places: Mapping[str, ArrayLike]) -> Array:
        """The logarithm of a quantity at these amplitudes."""
        phi = self._amplitudes[0]
        if name == "contact_radius":
            return jnp.broadcast_to(jnp.log(self.contact_radius), phi.shape)
        if self._fast:
            return self.solved.worn[:, [one for one, _ in _quantities(self.question)].index(name)]
        value = read(self.contact, name, self._force, places, digits=_DIGITS, solved=self._known)
        return jnp.broadcast_to(_log(value), phi.shape)

    def _all_logs(self) -> Array:
        """The logarithm of what is minimised at these amplitudes."""
        name, places, life = self.question.objective, self.question.places, self.question.life
        lasts = life is not None and (name in BY_THEN or is_after_cycles(name))
        return self._logs_by_then(name, places) if lasts else self._logs(name, places)

    @functools.cached_property
    def _life(self) -> Life:
        life = self.question.life
        assert life is not None
        return life if life.control == "blocks" else life.with_amplitudes(self._counting)

    def _logs_by_then(self, name: str, places: Mapping[str, ArrayLike]) -> Array:
        """The logarithm of a quantity at these amplitudes after the life."""
        if self.runs is not None:
            contact, life, unit = self.contact, self._life, jnp.asarray(self._log_unit("wear_volume", None))
            assert isinstance(life.law, Archard)
            pressed = 4.0 * jnp.asarray(contact.friction) * contact.normal_force * life.law.wear_coefficient
            log_n = jnp.log(pressed * life.cycles / jnp.pi) - 2.0 * jnp.log(self.contact_radius)
            return unit[..., None] + self.runs.log_worn(*jnp.broadcast_arrays(contact.material.k, log_n))
        value = self._life.read(self.contact, self._force, name, places, solved=self._known)
        return jnp.broadcast_to(_log(value), self._amplitudes[0].shape)

    def _counting(self, amplitudes: Any) -> Array:
        assert self.question.load is not None
        return without_padding(amplitudes, self.question.load.weight)

    @property
    def _force(self) -> Array:
        return self._amplitudes[0] * self.free.friction * self.free.normal_force

    @functools.cached_property
    def given(self) -> Any:
        """What the half-space is pressed by."""
        from plgwear_jax.shapes.of_contact import outline_of
        from plgwear_jax.steady.slopes import Given

        contact, dtype = self.free, self._amplitudes[0].dtype
        places = tuple(jnp.asarray(next(iter(at.values()), 0.0), dtype) for _, at in _quantities(self.question))
        return Given(
            force=jnp.asarray(contact.normal_force),
            radius=jnp.asarray(contact.radius),
            friction=jnp.asarray(contact.friction),
            plane_modulus=None if contact.indenter is None else contact.indenter.plane_modulus,
            phi=self._amplitudes[0],
            places=places,
            outline=outline_of(contact),
        )

    @property
    def log_radius(self) -> Array:
        """log(a_0) of a power law, alone."""
        if not self.numeric:
            return jnp.log(self.contact_radius)
        from plgwear_jax.steady.slopes import unworn_log_radius
        from plgwear_jax.surfaces.effort import effort_of

        return unworn_log_radius(effort_of(_DIGITS), self._half_space, self.given)

    @functools.cached_property
    def _half_space(self) -> Array:
        """(k, log(stiffness)) of a power law under an elastic indenter."""
        k = jnp.asarray(self.free.material.k)
        if self.question.hold is None:
            return jnp.stack([k, self.free.material.log_stiffness()])
        from plgwear_jax.steady.slopes import stiffness_for
        from plgwear_jax.surfaces.effort import effort_of

        # Not by way of E0 or z0: at k = 0 z0 is without effect.
        return jnp.stack([k, stiffness_for(effort_of(_DIGITS), k, jnp.log(self.contact_radius), self.given)])

    @functools.cached_property
    def solved(self) -> Any:
        """What a power law under an elastic indenter does at these amplitudes, as `Logs`."""
        from plgwear_jax.steady.slopes import worn_logs
        from plgwear_jax.surfaces.effort import effort_of

        names = tuple(name for name, _ in _quantities(self.question))
        return worn_logs(effort_of(_DIGITS), names, self._half_space, self.given)


# --- scenarios --------------------------------------------------------------------------------------------------------


def rows_of(
    question: Question,
    variables: Mapping[str, ArrayLike],
    radii: tuple[Array | None, Array] | None = None,
    runs: "RunsAlongExponent | None" = None,
) -> Array:
    """`Candidate.rows`; of scenarios the amounts at all amplitudes and the excess of each limit, one after the other.

    These have a last axis of scenarios times (amplitudes + limits). The amounts have the unit of `Candidate.log_unit`.
    """
    chosen = Candidate(question, variables, radii, runs)
    if question.cases is None:
        return chosen.rows()
    cases, unit = question.cases, jnp.exp(-jnp.asarray(Candidate(question, {}).log_unit()))

    def scenario(given: tuple[Any, Any, Any]) -> Array:
        there, law, force = given
        for name in _set(question):
            own, base, value = (leaf_of(contact, name) for contact in (there, question.contact, chosen.contact))
            value = value + (own - base) if is_linear(name) else value * (own / base)
            there = with_leaf(there, name, value)
        load = question.load
        if load is not None and load.life is not None and law is not None:
            load = dataclasses.replace(load, life=dataclasses.replace(load.life, law=law))
        if load is not None and force is not None:
            load = load.under(force)
        # The names of what varies stay: they decide how a contact is solved.
        candidate = Candidate(dataclasses.replace(question, contact=there, load=load, hold=None, cases=None), {})
        amounts = candidate.amounts() * unit
        excess = [jnp.broadcast_to(x, amounts.shape[:-1])[..., None] for x in candidate.excess()]
        return jnp.concatenate([amounts, *excess], axis=-1)

    each = jax.lax.map if solved_one_by_one(question) else lambda one, given: jax.vmap(one)(given)
    rows = jnp.moveaxis(each(scenario, (cases.contact, cases.law, cases.tangential_force)), 0, -2)
    return rows.reshape(*rows.shape[:-2], -1)


def _set(question: Question) -> list[str]:
    """The numbers of the contact that a design sets: what varies, and by what the contact radius is held."""
    moduli = question.depths is not None
    varied = [name for name in question.bounds if not (moduli and name in (SHALLOW, DEEP))]
    held = [] if question.hold is None else [question.hold.rpartition("_")[2]]
    return [*varied, *(("E0", "z0", "k") if moduli else ()), *held]


def _log(x: Any) -> Array:
    """log(x), finite where x is 0 or negative, as a depth of wear is outside of the ring."""
    x = jnp.asarray(x)
    return jnp.where(x <= 0.0, -1e3, jnp.log(jnp.where(x <= 0.0, 1.0, x)))


def _quantities(question: Question) -> list[tuple[str, Mapping[str, ArrayLike]]]:
    """The quantities but the contact radius that are minimised and limited, with their places."""
    limits = ((name, limit.places) for name, limit in question.limits.items() if isinstance(limit, Limit))
    named = [(question.objective, question.places), *limits]
    return [one for one in named if one[0] != "contact_radius"]


def by_half_space(question: Question) -> bool:
    """A power law under an elastic indenter of which only the half-space varies, and no quantity needs the slip."""
    contact = question.contact
    if is_closed(contact) or not isinstance(contact.material, PowerLawGraded) or question.life is not None:
        return False
    from plgwear_jax.steady.slopes import NAMES

    names = [name for name, _ in _quantities(question)]
    return question.bounds.keys() <= HALF_SPACE and len({*names}) == len(names) and {*names} <= {*NAMES}


def moved(variables: Mapping[str, Any], steps: Mapping[str, Any]) -> dict[str, Any]:
    """The variables after steps on the scale on which each of them is searched."""
    return {
        name: value if name not in steps else value + steps[name] if is_linear(name) else value * jnp.exp(steps[name])
        for name, value in variables.items()
    }


def reference_variables(question: Question) -> dict[str, ArrayLike]:
    """The values of the variables for the contact as given."""
    contact, found = question.contact, {}
    for name in question.bounds:
        if question.depths is not None and name in (SHALLOW, DEEP):
            # Eq. (1), for numbers of NumPy as well as for traced ones
            depth, material = question.depths[name == DEEP], contact.material
            found[name] = material.E0 * (depth / material.z0) ** material.k
        else:
            found[name] = leaf_of(contact, name)
    return found


def space(question: Question) -> dict[str, Interval]:
    """The box of the variables: what spans a ratio is searched on a logarithmic scale."""
    scales: dict[bool, Literal["linear", "logarithmic"]] = {True: "linear", False: "logarithmic"}
    return {name: Interval(*bounds, scales[is_linear(name)]) for name, bounds in question.bounds.items()}
