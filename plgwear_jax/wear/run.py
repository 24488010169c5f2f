"""The wear of a contact over cycles, which is solved once and then read at any number of cycles."""

import abc
import functools
from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import CYCLES, RADIUS, ArrayLike, Numbers, guarded
from plgwear_jax._core.doubts import SOON, doubt, of_contact, of_wear, one_question
from plgwear_jax._startup.programs import follows, program, read_with_slopes, traced
from plgwear_jax.special.elementary import crest
from plgwear_jax.special.root import first_at
from plgwear_jax.steady.arguments import ARGUMENTS, refuse_control
from plgwear_jax.steady.batch import dtype_of
from plgwear_jax.steady.solution import Solution, Steady
from plgwear_jax.transient.amount import cycles_of, rate_of, volume_of
from plgwear_jax.transient.batch import run_numbers
from plgwear_jax.transient.curves import RunCurves, end_of
from plgwear_jax.transient.fields import depth_by, radius_of, stick_of


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


@program(static=1)
def _cycles_to(name: str, run: Solved, goal: Array) -> Array:
    if name == "share":
        return cycles_of(run.flat, run.k, run.phi, goal) / run.per_cycle
    share = goal / (run.volume * run.flat.scales.volume.reshape(run.phi.shape))
    never = share >= 1.0
    found = cycles_of(run.flat, run.k, run.phi, jnp.where(never, 0.5, share))
    return _if_it_wears(run, jnp.where(never, jnp.inf, found), goal)


def cycles_to_depth(run: Solved, goal: Array, *ring: Array) -> Array:
    """The cycles after which the deepest of some places is so deep.

    Args:
        run: The solution.
        goal: Depths in m.
        *ring: y, the gap g_0 in m, and the final depth in m at the places, along a first axis.
    """
    numbers = run_numbers(run.phi, run.phi)

    def deepest(given: Any, n: Array) -> Array:
        curves, (y, gap, steady) = given
        return crest(depth_by(curves, numbers, y, n, gap, steady))

    found = first_at(deepest, (run.flat, ring), goal, end_of(run.flat, numbers))
    return _if_it_wears(run, found, goal)


def places_in_ring(run: Solved, goal: Array) -> Array:
    """y at places over the ring, along a first axis before those of the contacts and the goals."""
    axes = (1,) * max(goal.ndim, run.phi.ndim)
    places = np.linspace(0.0, 1.0, _PLACES)[1:-1] ** 2  # the deepest is near c after a few cycles
    return jnp.asarray(places.reshape(-1, *axes), goal.dtype) * run.flat.scales.width.reshape(run.phi.shape)


def _if_it_wears(run: Solved, n: Array, goal: Array) -> Array:
    """n in cycles; where nothing wears, no goal above 0 is reached."""
    return jnp.where(run.phi == 0.0, jnp.where(goal > 0.0, jnp.inf, 0.0), n) / run.per_cycle + 0.0 * run.phi


@program()
def _lasting(run: Solved) -> Array:
    return _LONG * run.curves.scales.unit / run.per_cycle


NEARLY = 0.99  # share of the final volume by which a scar is worn
_LONG = 1e6  # units of time after which nothing wears any more
_PLACES = 242  # over the ring, among which the deepest wear is looked for


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
        with one_question(*of_contact(self.contact)):
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
            found = program(self._solution, at)
            if "solved" in vars(self) and "doubted" not in vars(self) and not traced(vars(self)["solved"]):
                vars(self)["doubted"] = True  # first, since what follows reads the solution too
                doubt(self._doubt())
            return found
        return read_with_slopes(self._solved, program, given, at, vars(self))

    def _doubt(self) -> str | None:
        """What is doubtful of how soon so much is worn."""
        run = self._solution
        unit = np.min(run.curves.scales.unit, initial=np.inf) / np.max(run.per_cycle, initial=0.0)
        # The cycles to 99 % are several units, and only few questions are to pay for them.
        return of_wear(np.fmin.reduce(self.cycles_to(NEARLY), axis=None, initial=np.inf)) if unit < SOON else None

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

    def cycles_to(
        self, share: ArrayLike | None = None, *, depth: ArrayLike | None = None, volume: ArrayLike | None = None
    ) -> Array:
        """Cycles after which so much is worn for the first time; one of the arguments is given.

        Args:
            share: Share of the final volume, 0 <= share < 1.
            depth: Depth in m, >= 0 and finite, that is worn at the deepest place.
            volume: Volume in m^3, >= 0 and finite.

        Returns:
            The cycles, broadcast against the contacts. A depth or a volume that is never worn gives infinity. A share
            of nothing, where nothing wears, is NaN.
        """
        return self._cycles_to(*self._goal(share=share, depth=depth, volume=volume))

    def _goal(self, **given: ArrayLike | None) -> tuple[str, Array]:
        """What is to be reached, and its value."""
        goals = {name: goal for name, goal in given.items() if goal is not None}
        if len(goals) != 1:
            told = " and ".join(goals) or "none of them"
            raise ValueError(f"cycles_to takes one of share, depth in m and volume in m^3, not {told}")
        self._check(**goals)
        ((name, goal),) = goals.items()
        return name, jnp.asarray(guarded(name, goal, ARGUMENTS[name]), self._dtype)

    def _cycles_to(self, name: str, goal: Array) -> Array:
        return self._read(functools.partial(_cycles_to, name), goal)

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
