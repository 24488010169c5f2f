"""The wear of a contact over cycles, which is solved once and then read at any number of cycles."""

import abc
from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

from plgwear_jax._core.domains import CYCLES, RADIUS, SHARE, ArrayLike, Numbers, guarded
from plgwear_jax._startup.programs import follows, program, read_with_slopes
from plgwear_jax.steady.arguments import refuse_control
from plgwear_jax.steady.batch import dtype_of
from plgwear_jax.steady.solution import Solution, Steady
from plgwear_jax.transient.amount import cycles_of, rate_of, volume_of
from plgwear_jax.transient.curves import RunCurves
from plgwear_jax.transient.fields import radius_of, stick_of


class Solved(NamedTuple):
    """The solution of a run. All leaves but `per_cycle` begin with the axes of the contacts."""

    curves: RunCurves
    k: Array  # exponent of a power law; for other bodies any array of this shape
    phi: Array  # amplitudes before any wear
    per_cycle: Array  # reduced cycles, or time, of one cycle; broadcasts against the contacts
    volume: Array  # unit of the volumes of the curves in m^3
    contact_radius: Array  # a_0 in m
    stick_radius: Array  # c before any wear in m
    more: Any  # further results that only one engine uses

    @property
    def flat(self) -> RunCurves:
        """The curves with the contacts along one axis, on which there is at least one."""
        axes, count = self.phi.ndim, self.phi.size
        if not count:
            return jax.tree.map(lambda x: jnp.zeros((1, *x.shape[axes:]), x.dtype), self.curves)
        return jax.tree.map(lambda x: x.reshape(count, *x.shape[axes:]), self.curves)


@program()
def _volume(run: Solved, cycles: Array) -> Array:
    return run.volume * volume_of(run.flat, run.k, run.phi, run.per_cycle * cycles)


@program()
def _rate(run: Solved, cycles: Array) -> Array:
    return run.volume * run.per_cycle * rate_of(run.flat, run.k, run.phi, run.per_cycle * cycles)


@program()
def _contact_radius(run: Solved, cycles: Array) -> Array:
    return run.contact_radius * radius_of(run.flat, run.k, run.phi, run.per_cycle * cycles)


@program()
def _stick_radius(run: Solved, cycles: Array) -> Array:
    return run.stick_radius * stick_of(run.flat, run.phi, run.per_cycle * cycles)


@program()
def _cycles_to(run: Solved, share: Array) -> Array:
    return cycles_of(run.flat, run.k, run.phi, share) / run.per_cycle


@program()
def _lasting(run: Solved) -> Array:
    return _LONG * run.curves.scales.unit / run.per_cycle


_LONG = 1e6  # units of time after which nothing wears any more


class Run(Solution, abc.ABC):
    """The wear of a contact over cycles, in SI units: `FrettingContact.over_cycles`.

    The contact begins unworn, under a constant normal force and a constant amplitude of the tangential force or of the
    displacement. It is solved once, when the first quantity is read; what nobody reads is not computed.

    Numbers of `cycles` are >= 0 and finite, radii r in m and >= 0; they broadcast against each other and against the
    fields of the contact.

    Attributes:
        contact: The contact.
        tangential_force: The force amplitude F_x in N; under displacement control the amplitude before any wear.
        wear_coefficient: Archard's K in 1/Pa.
        rig_stiffness: Rig stiffness in N/m, if the displacement is measured at the
            actuator of the rig; None otherwise.
        control: Which amplitude is constant, that of the "force" or of the "displacement".
        digits: Correct digits wanted of the volume.

    Raises:
        ValueError: A concrete number is outside its range. Under `jit` the result is NaN there.
    """

    numbers: ClassVar = ("contact", "tangential_force", "wear_coefficient", "rig_stiffness")
    words: ClassVar = ("control", "digits")

    wear_coefficient: Numbers
    rig_stiffness: ArrayLike | None
    control: str

    def __init__(
        self,
        contact: Any,
        tangential_force: ArrayLike,
        wear_coefficient: ArrayLike,
        control: str = "force",
        rig_stiffness: ArrayLike | None = None,
        digits: int | None = None,
    ) -> None:
        refuse_control(control, True, rig_stiffness is not None)
        super().__init__(
            contact=contact,
            tangential_force=tangential_force,
            wear_coefficient=wear_coefficient,
            rig_stiffness=rig_stiffness,
            control=control,
            digits=digits,
        )
        self._check_question(wear_coefficient=wear_coefficient, rig_stiffness=rig_stiffness)

    @property
    def steady(self) -> Steady:
        """The steady state under this force amplitude, which a run under displacement control does not reach."""
        return self.contact.steady(self.tangential_force, digits=self._steady_digits)

    @property
    def ends_otherwise(self) -> bool:
        """Whether the run ends in another state than `steady`."""
        return self.control == "displacement"

    @property
    def _steady_digits(self) -> int | None:
        return self.digits

    def _cycles(self, cycles: ArrayLike) -> Array:
        self._check(cycles=cycles)
        return jnp.asarray(guarded("cycles", cycles, CYCLES), self._dtype)

    @property
    def _dtype(self) -> Any:
        return dtype_of([getattr(self, name) for name in self.numbers])

    @abc.abstractmethod
    def _given(self) -> Any:
        """The numbers of the question, as arrays of one dtype."""

    @abc.abstractmethod
    def _solved(self, given: Any) -> Any:
        """The solution for such numbers, by programs alone."""

    def _solve(self) -> Any:
        return self._solved(self._given())

    def _after(self, program: Callable[[Solved, Array], Array], cycles: ArrayLike) -> Array:
        return self._read(program, self._cycles(cycles))

    def _read(self, program: Callable[[Any, Array], Array], at: Array) -> Array:
        """What a program reads from the solution at the numbers `at`."""
        given = self._given()
        if "solved" in vars(self) or not follows((given, at)):
            return program(self._solution, at)
        return read_with_slopes(self._solved, program, given, at, vars(self))

    def _radii(self, r: ArrayLike) -> Array:
        self._check(r=r)
        return jnp.asarray(guarded("r", r, RADIUS), self._dtype)

    def volume(self, cycles: ArrayLike) -> Array:
        """Volume worn off the indenter in m^3."""
        return self._after(_volume, cycles)

    def rate(self, cycles: ArrayLike) -> Array:
        """Volume in m^3 that the next cycle wears."""
        return self._after(_rate, cycles)

    def contact_radius(self, cycles: ArrayLike) -> Array:
        """Radius of the contact in m."""
        return self._after(_contact_radius, cycles)

    def stick_radius(self, cycles: ArrayLike) -> Array:
        """Stick radius in m: constant under force control, growing under displacement control."""
        return self._after(_stick_radius, cycles)

    def energy_per_cycle(self, cycles: ArrayLike) -> Array:
        """Energy in J that friction dissipates in the next cycle: by Archard's law mu/K times the volume it wears."""
        return self.rate(cycles) * jnp.asarray(self.contact.friction) / jnp.asarray(self.wear_coefficient)

    def cycles_to(self, share: ArrayLike) -> Array:
        """Cycles after which a share of the final volume is worn, 0 <= share < 1; NaN where nothing wears."""
        self._check(share=share)
        return self._read(_cycles_to, jnp.asarray(guarded("share", share, SHARE), self._dtype))

    @property
    def lasting_cycles(self) -> Array:
        """Cycles after which nothing wears any more."""
        return _lasting(self._solution)

    @abc.abstractmethod
    def depth(self, r: ArrayLike, cycles: ArrayLike) -> Array:
        """Depth in m worn off the indenter."""

    @abc.abstractmethod
    def profile(self, r: ArrayLike, cycles: ArrayLike) -> Array:
        """Shape of the worn indenter in m above its apex."""

    @abc.abstractmethod
    def pressure(self, r: ArrayLike, cycles: ArrayLike) -> Array:
        """Pressure in Pa, nowhere negative."""
