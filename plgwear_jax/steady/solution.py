"""Objects that hold a question and its solution, which is computed when a result is first read."""

import abc
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ClassVar, Self

import jax
import jax.numpy as jnp
from jax import Array
from jax.core import Tracer

from plgwear_jax._core.domains import ArrayLike, Domain, as_array, check, check_digits, guarded, one_or_nan, real_dtype
from plgwear_jax._core.doubts import doubt, of_contact, of_onset
from plgwear_jax._core.formula import compiled
from plgwear_jax.loads import PARTIAL_SLIP, Force, Load
from plgwear_jax.steady.arguments import ARGUMENTS, amplitude_of, check_arguments
from plgwear_jax.steady.batch import as_numbers

if TYPE_CHECKING:
    from plgwear_jax.stresses.field import Pressed, Stress
    from plgwear_jax.stresses.peaks import Peak


_THICKNESS = Domain("> 0", lambda h: h > 0.0)


class Solution:
    """A question asked of a contact, and its solution.

    A pytree of the question's numbers and of the solution: passing an object through `jit`, `vmap` or a pickle solves
    it, and it is not solved again on the other side. Instances are immutable.
    """

    numbers: ClassVar[tuple[str, ...]] = ("contact", "load")
    words: ClassVar[tuple[str, ...]] = ("digits",)
    shares: ClassVar[Domain] = PARTIAL_SLIP  # of F_x/(mu F_N) that it takes

    contact: Any
    load: Load
    digits: int | None

    def __init_subclass__(cls) -> None:
        jax.tree_util.register_pytree_with_keys(cls, cls._flatten, cls._unflatten)

    def __init__(self, **question: Any) -> None:
        vars(self).update({name: as_array(value) for name, value in question.items()})
        doubt(*of_contact(self.contact))

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"{type(self).__name__} cannot be changed")

    def __repr__(self) -> str:
        arguments = ", ".join(f"{name}={getattr(self, name)!r}" for name in (*self.numbers, *self.words))
        return f"{type(self).__name__}({arguments})"

    def _solve(self) -> Any:
        """The solution, a pytree; None for closed forms, which need no solution."""

    @property
    def _solution(self) -> Any:
        return self._once("solved", self._solve)

    def _once(self, name: str, solve: Callable[[], Any]) -> Any:
        """What is solved at the first time and then kept under a name."""
        if name in vars(self):
            return vars(self)[name]
        found = solve()
        if _traces(found) <= _traces(self.contact) | _traces([getattr(self, one) for one in self.numbers]):
            vars(self)[name] = found  # kept only if it belongs to no other trace, which would end before the object
        return found

    def _flatten(self) -> tuple[list[tuple[Any, Any]], tuple[Any, ...]]:
        children = [(jax.tree_util.GetAttrKey(name), getattr(self, name)) for name in self.numbers]
        solved = jax.tree_util.GetAttrKey("solution"), self._solution
        return [*children, solved], tuple(getattr(self, name) for name in self.words)

    @classmethod
    def _unflatten(cls, words: tuple[Any, ...], children: Any) -> Self:
        instance = object.__new__(cls)
        names = *cls.words, *cls.numbers, "solved"
        vars(instance).update(zip(names, (*words, *children), strict=True))
        return instance

    def _check_question(self) -> None:
        """Check the question itself."""
        self._check()
        if self.digits is not None:
            numbers = jax.tree.leaves([getattr(self, name) for name in self.numbers])
            vars(self)["digits"] = check_digits(self.digits, real_dtype("digits", tuple(numbers)))

    def _check(self, **given: ArrayLike | None) -> None:
        """Check concrete arguments of a method, and the question itself, since JAX rebuilds records without checks."""
        check_arguments(self.contact, **given)
        if "load" in self.numbers:
            self.load.check(self.contact.friction, self.contact.normal_force, self.shares)


def _traces(tree: Any) -> set[int]:
    return {id(getattr(leaf, "_trace", None)) for leaf in jax.tree.leaves(tree) if isinstance(leaf, Tracer)}


class Steady(Solution, abc.ABC):
    """A contact under a load, unworn and worn to its steady state, in SI units: `FrettingContact.steady`.

    What nobody reads is neither computed nor traced. A contact without closed forms is solved once, when the first
    result is read.

    Args:
        contact: The contact.
        load: A force amplitude F_x, 0 <= F_x < mu F_N, broadcast against the fields of the contact, or a displacement
            amplitude. The steady state is that under the force amplitude which the load has before any wear.
        digits: Correct digits wanted; by default all that the solver has, see `FrettingContact`.

    Radii r and distances are in m, >= 0. A distance from the stick-slip boundary beyond the stick radius gives the
    value at the centre. Where the load has a rig stiffness, displacement amplitudes are those at the actuator of the
    rig, and energy ratios and sliding ratios are those of the loop that is measured there.

    Raises:
        ValueError: A concrete number is outside its range, or the contact would have to pull: where the pressure before
            any wear would be negative there is no result, where that in the steady state would be, none of what is
            worn. Under `jit`, and for members of batches, the result is NaN there.

    Examples:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> steady = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4).steady(0.32)
        >>> print(f"{steady.stick_radius:.3e} m, {steady.wear_volume:.3e} m^3")
        6.584e-05 m, 2.961e-18 m^3

    References:
        Heß, Facta Universitatis, Mechanical Engineering 17 (2019) 47: Eqs. (11) to (28); other bodies and shapes:
        `docs/explanation/numerics.md`, "Elastic indenters and any E(z)".
    """

    def __init__(self, contact: Any, load: Load, digits: int | None = None) -> None:
        super().__init__(contact=contact, load=load, digits=digits)
        self._check_question()

    @property
    def tangential_force(self) -> Any:
        """Force amplitude F_x in N, of a displacement amplitude that before any wear."""
        return self.load.force_before_wear(self if self.load.holds_force else self._at_rest)

    @property
    def _at_rest(self) -> Self:
        return type(self)(self.contact, Force(0.0, self.load.rig_stiffness), self.digits)

    @property
    @compiled
    def amplitude(self) -> Array:
        """phi = F_x/(mu F_N), dimensionless."""
        return amplitude_of(self.contact, self.tangential_force)

    @property
    def _limiting_friction(self) -> Array:
        """mu F_N."""
        return jnp.asarray(self.contact.friction) * jnp.asarray(self.contact.normal_force)

    @property
    @abc.abstractmethod
    def contact_radius(self) -> Array:
        """Contact radius a_0 before any wear in m, Eq. (12)."""

    @property
    @abc.abstractmethod
    def stick_radius(self) -> Array:
        """Stick radius c in m, Eqs. (16) and (23)."""

    @property
    @abc.abstractmethod
    def worn_radius(self) -> Array:
        """Outer radius a_inf of the worn ring in m, Eq. (26)."""

    @property
    @abc.abstractmethod
    def penetration(self) -> Array:
        """Indentation depth d_inf in m, Eqs. (11) and (25); at F_x = 0 it is d_0 of Eq. (11)."""

    @property
    @abc.abstractmethod
    def wear_volume(self) -> Array:
        """Volume worn off the indenter in m^3, Eq. (28)."""

    @property
    @abc.abstractmethod
    def deepest_wear(self) -> Array:
        """Largest depth worn off the indenter in m, from Eqs. (24) and (25)."""

    @property
    @abc.abstractmethod
    def edge_intensity(self) -> Array:
        """Factor in Pa of (2 delta)^((k-1)/2) in the pressure at r = c (1 - delta), Eq. (20).

        Of a power law under an elastic indenter the body that gives way most at the edge decides: for k < 0 the
        exponent is that of k = 0. At k = 0 both bodies count and the factor jumps, so that its slope by k means nothing
        there; `edge_pressure` does not jump.
        """

    @property
    @abc.abstractmethod
    def peak_initial_pressure(self) -> Array:
        """Largest pressure before any wear in Pa, Eq. (13)."""

    # --- displacements, with those of a rig ---------------------------------------------------------------------------

    @property
    def gross_slip_displacement(self) -> Array:
        """Displacement amplitude in m at which the unworn contact begins to slip as a whole."""
        alone = self._onset
        doubt(of_onset(alone))
        return self._with_rig(alone, self._limiting_friction)

    @property
    def displacement_amplitude(self) -> Array:
        """Displacement amplitude in m of the unworn contact, measured far from it."""
        return self._with_rig(self._moved, self.tangential_force)

    @property
    def worn_displacement_amplitude(self) -> Array:
        """Displacement amplitude in m of the worn contact."""
        return self._with_rig(self._worn_moved, self.tangential_force)

    @property
    def energy_ratio(self) -> Array:
        """Energy of a cycle of the unworn contact over 4 F_x u_x, dimensionless; 0 at F_x = 0."""
        return self._energy_ratio * self._share

    @property
    def loop_aperture(self) -> Array:
        """Displacement of the unworn contact at no force over its displacement amplitude; 0 at F_x = 0."""
        return self._aperture * self._share

    @property
    def gross_slip_energy_ratio(self) -> Array:
        """The energy ratio at which the unworn contact begins to slip as a whole, (1+k)/(5+k) for a parabola."""
        return self._onset_energy_ratio * self._share_at_onset

    @property
    def gross_slip_aperture(self) -> Array:
        """The sliding ratio at which the unworn contact begins to slip, 2^((1+k)/(3+k)) - 1 for a parabola."""
        return self._onset_aperture * self._share_at_onset

    @property
    def _share(self) -> Array | float:
        """The share of the unworn contact in the displacement amplitude."""
        return 1.0 if self.load.rig_stiffness is None else self._share_of_contact

    @property
    def _share_at_onset(self) -> Array | float:
        if self.load.rig_stiffness is None:
            return 1.0
        alone = self._onset
        return alone / self._with_rig(alone, self._limiting_friction)

    def _with_rig(self, alone: Array, force: ArrayLike) -> Array:
        """The displacement in m at the actuator of the rig under a force."""
        return alone if self.load.rig_stiffness is None else alone + jnp.asarray(force) * self.load.rig_compliance

    # --- the same without a rig ---------------------------------------------------------------------------------------

    @property
    @abc.abstractmethod
    def _onset(self) -> Array: ...

    @property
    @abc.abstractmethod
    def _moved(self) -> Array: ...

    @property
    @abc.abstractmethod
    def _worn_moved(self) -> Array: ...

    @property
    @abc.abstractmethod
    def _energy_ratio(self) -> Array: ...

    @property
    @abc.abstractmethod
    def _aperture(self) -> Array: ...

    @property
    @abc.abstractmethod
    def _onset_energy_ratio(self) -> Array: ...

    @property
    @abc.abstractmethod
    def _onset_aperture(self) -> Array: ...

    @property
    @abc.abstractmethod
    def _share_of_contact(self) -> Array: ...

    # --- further quantities -------------------------------------------------------------------------------------------

    @property
    @abc.abstractmethod
    def energy_per_cycle(self) -> Array:
        """Energy in J that friction dissipates in a cycle of the unworn contact."""

    def modulus_at(self, z: ArrayLike) -> Array:
        """Young's modulus of the half-space in Pa at a depth z in m, Eq. (1)."""
        return self.contact.material.modulus_at(z)

    @abc.abstractmethod
    def edge_pressure(self, distance: ArrayLike) -> Array:
        """Worn pressure in Pa at a distance inside the stick-slip boundary, r = c - distance, Eq. (17)."""

    @abc.abstractmethod
    def initial_displacement(self, r: ArrayLike) -> Array:
        """Normal displacement w_0 of the surface in m before any wear, Eq. (14)."""

    @abc.abstractmethod
    def steady_displacement(self, r: ArrayLike) -> Array:
        """Normal displacement w_inf of the surface in m, Eq. (24)."""

    @abc.abstractmethod
    def profile(self, r: ArrayLike) -> Array:
        """Shape f_inf of the worn indenter in m above its apex, Eq. (25)."""

    @abc.abstractmethod
    def wear_depth(self, r: ArrayLike) -> Array:
        """Depth f_inf - f_0 in m worn off, from Eqs. (24) and (25)."""

    @abc.abstractmethod
    def initial_pressure(self, r: ArrayLike) -> Array:
        """Pressure p_0 in Pa before any wear, Eq. (13)."""

    @abc.abstractmethod
    def pressure(self, r: ArrayLike) -> Array:
        """Pressure p_inf in Pa, Eq. (17); infinite at r = c."""

    @abc.abstractmethod
    def traction(self, r: ArrayLike) -> Array:
        """Tangential traction tau_inf in Pa, Eq. (19); infinite at r = c."""

    @abc.abstractmethod
    def slip_amplitude(self, r: ArrayLike) -> Array:
        """Slip amplitude in m in the ring c < r < a_0 of the unworn contact; 0 where nothing slips."""

    # --- stresses -----------------------------------------------------------------------------------------------------

    def stress(self, x: ArrayLike, z: ArrayLike, *, worn: bool = False) -> "Stress":
        """Stresses in Pa in the plane of the motion, under the largest tangential force.

        Args:
            x: Along the motion in m, from the axis of the contact, negative behind it.
            z: Depth in m, z >= 0; broadcasts against x.
            worn: In the steady state, infinite at the surface at the stick-slip boundary, not before any wear.

        A grid is fast as x of shape (n,) and z of shape (m, 1).
        """
        from plgwear_jax.steady.stressed import stresses_of  # imported by the first contact that needs it

        if worn:
            self._check_worn()
        return stresses_of(self, *self._places(x, z), worn)

    def tension(self, x: ArrayLike, z: ArrayLike) -> Array:
        """Largest principal stress in Pa before any wear at x and z, see `stress`."""
        return self.stress(x, z).principal

    def mises(self, x: ArrayLike, z: ArrayLike) -> Array:
        """Von Mises' stress in Pa before any wear at x and z, see `stress`."""
        return self.stress(x, z).mises

    @property
    def peak_tension(self) -> Array:
        """Largest principal stress anywhere before any wear in Pa; infinite where the surface modulus is (k < 0)."""
        return self._peak("principal").value

    @property
    def peak_mises(self) -> Array:
        """Largest von Mises stress anywhere before any wear in Pa; infinite like `peak_tension`."""
        return self._peak("mises").value

    @property
    def peak_tension_at(self) -> tuple[Array, Array]:
        """Where the largest principal stress is, (x, z) in m."""
        return self._peak("principal")[1:]

    @property
    def peak_mises_at(self) -> tuple[Array, Array]:
        """Where von Mises' stress is largest, (x, z) in m."""
        return self._peak("mises")[1:]

    def peak_mises_between(self, least: ArrayLike, most: ArrayLike) -> Array:
        """Von Mises' stress in Pa before any wear where it is largest between two depths in m, least < most.

        At an interface `least` is just below it and `most` just above, so that the depths of a layer are those of its
        stresses alone. Scalars, or one pair for each contact of a batch.
        """
        self._check(least=least, most=most)
        low, high = (guarded(name, z, ARGUMENTS[name]) for name, z in (("least", least), ("most", most)))
        check("most - least", high - low, _THICKNESS)
        from plgwear_jax.steady.stressed import peak_stress_of

        inside = 16.0 * jnp.finfo(real_dtype("least", tuple(jax.tree.leaves(self.contact)))).eps
        high = high * (1.0 - inside) * one_or_nan(high > low)
        return peak_stress_of(self, "mises", low * (1.0 + inside), high).value

    def _peak(self, name: str) -> "Peak":
        from plgwear_jax.steady.stressed import peak_stress_of

        return self._once(f"peak {name}", lambda: peak_stress_of(self, name))  # for its value and its place

    def _places(self, x: ArrayLike, z: ArrayLike) -> tuple[Array, Array]:
        self._check(x=x, z=z)
        return guarded("x", x, ARGUMENTS["x"]), guarded("z", z, ARGUMENTS["z"])

    def _given(self) -> Any:
        """The numbers of the question, as arrays of one dtype."""
        return as_numbers((self.contact, self.load, self._solution))

    def _solved(self, given: Any) -> Self:
        """What programs of stresses take, of such numbers and by programs alone."""
        return self._unflatten((self.digits,), given)

    @property
    def _known(self) -> Self:
        """The same of the solution that is known."""
        return self._solved(self._given())

    @property
    @abc.abstractmethod
    def _pressed(self) -> "Pressed":
        """What the stresses follow from."""

    def _check_worn(self) -> None:
        """Refuse a contact that would have to pull."""

    @abc.abstractmethod
    def force_at(self, displacement_amplitude: ArrayLike) -> Array:
        """Force amplitude F_x in N at which the unworn contact has a displacement amplitude in m."""
