"""The wear of a contact over cycles, which is solved once and then read at any number of cycles."""

import abc
import functools
from typing import Any, ClassVar, NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array

from plgwear_jax._core.domains import NOT_NEGATIVE, ArrayLike, nan_outside, whole
from plgwear_jax._core.doubts import doubt, of_contact, of_wear, one_question
from plgwear_jax._core.startup.programs import follows, program, read_with_slopes, traced
from plgwear_jax.loads import Load
from plgwear_jax.shapes import outline_of
from plgwear_jax.steady.batch import dtype_of
from plgwear_jax.steady.closed import Steady
from plgwear_jax.steady.solution import Solution
from plgwear_jax.wear_laws import WearLaw

NEARLY = 0.99  # share of the final volume by which a scar is worn


@program(static=1)
def _read_from(what: tuple[str, ...], solution: Any, *at: Array) -> Array:
    """What a solution tells: a `number` or a `field` of a name, the `cycles_to` what is worn, its `last` cycles."""
    method, *name = what
    return getattr(solution, method)(*name, *at)


class Final(NamedTuple):
    """The scar at the end of a run, in SI units."""

    volume: Array
    deepest_wear: Array
    stick_radius: Array
    worn_radius: Array


class Run(Solution, abc.ABC):
    """The wear of a contact over cycles, in SI units: `FrettingContact.over_cycles`.

    The contact begins unworn. It is solved once, when the first quantity is read; what nobody reads is not computed.

    Numbers of `cycles` are >= 0 and finite, radii r in m and >= 0; they broadcast against each other and against the
    fields of the contact.

    Attributes:
        contact: The contact.
        load: A `Force`, a `Displacement`, or `Blocks` of cycles.
        law: The wear law.
        digits: Correct digits wanted of the volume.

    Raises:
        ValueError: A concrete number is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> run = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4).over_cycles(2.0, 1e-14)
        >>> print(f"{run.volume(1e5) / run.steady.wear_volume:.2f}")  # the share that 100,000 cycles wear
        0.26

    References:
        `docs/explanation/numerics.md`, "Wear over cycles" and "Any test".
    """

    numbers: ClassVar = ("contact", "load", "law")

    law: WearLaw
    known: ClassVar[tuple[Any, ...]] = ()  # the most digits, and what is said of more

    def __init__(self, contact: Any, load: Load, law: WearLaw, digits: int | None = None) -> None:
        digits = None if digits is None else whole("digits", digits, 1, *self.known)
        super().__init__(contact, load, law, digits=digits)

    def _check(self, **given: Any) -> None:
        super()._check(**given)
        self.law.__post_init__()  # pyright: ignore[reportAttributeAccessIssue]

    @property
    def steady(self) -> Steady | None:
        """The steady state under the force amplitude before any wear; None in gross slip, and for blocks of cycles."""
        with one_question(*of_contact(self.contact)):
            return self.contact.steady(self.load, digits=self.digits)

    @property
    def final(self) -> "Final | None":
        """The end of the run, which is `steady` where the force amplitude is constant; None where `steady` is None."""
        steady = self.steady
        if steady is None:
            return None
        if self.load.holds_force:
            return Final(steady.wear_volume, steady.deepest_wear, steady.stick_radius, steady.worn_radius)
        last = self.lasting_cycles
        return Final(self.volume(last), self.deepest_wear(last), self.stick_radius(last), self.contact_radius(last))

    @abc.abstractmethod
    def _given(self) -> Any:
        """The numbers of the question, as arrays of one dtype."""

    @abc.abstractmethod
    def _solved(self, given: Any) -> Any:
        """The solution for such numbers, by programs alone."""

    def _solve(self) -> Any:
        return self._solved(self._given())

    def _read(self, method: str, name: str, at: Array) -> Array:
        """What the solution tells at such numbers."""
        given, read = self._given(), functools.partial(_read_from, (method, name))
        if "solved" in vars(self) or not follows((given, at)):
            found = read(self._solution, at)
            if "solved" in vars(self) and "doubted" not in vars(self) and not traced(vars(self)["solved"]):
                vars(self)["doubted"] = True  # first, since what follows reads the solution too
                doubt(self._doubt())
            return found
        return read_with_slopes(self._solved, read, given, at, vars(self))

    @abc.abstractmethod
    def _doubt(self) -> str | None:
        """What is doubtful of how soon so much is worn."""

    def _doubt_of_soon(self) -> str | None:
        return of_wear(np.fmin.reduce(self.cycles_to(NEARLY), axis=None, initial=np.inf))

    def _argument(self, name: str, value: ArrayLike) -> Array:
        return jnp.asarray(super()._argument(name, value), dtype_of([getattr(self, one) for one in self.numbers]))

    def _at(self, name: str, cycles: ArrayLike) -> Array:
        return self._read("number", name, self._argument("cycles", cycles))

    def volume(self, cycles: ArrayLike) -> Array:
        """Volume worn off the indenter in m^3."""
        return self._at("volume", cycles)

    def rate(self, cycles: ArrayLike) -> Array:
        """Volume in m^3 that the next cycle wears."""
        return self._at("rate", cycles)

    def contact_radius(self, cycles: ArrayLike) -> Array:
        """Radius of the contact in m."""
        return self._at("contact_radius", cycles)

    def stick_radius(self, cycles: ArrayLike) -> Array:
        """Radius in m inside which the contact sticks; 0 in gross slip."""
        return self._at("stick_radius", cycles)

    def force_amplitude(self, cycles: ArrayLike) -> Array:
        """Amplitude of the tangential force in N."""
        return self._at("force_amplitude", cycles)

    def energy_per_cycle(self, cycles: ArrayLike) -> Array:
        """Energy in J that friction dissipates in the next cycle."""
        return self._at("energy_per_cycle", cycles)

    def deepest_wear(self, cycles: ArrayLike) -> Array:
        """Largest depth in m worn off the indenter at any radius."""
        return self._at("deepest_wear", cycles)

    def cycles_to(
        self, share: ArrayLike | None = None, *, depth: ArrayLike | None = None, volume: ArrayLike | None = None
    ) -> Array:
        """Cycles after which so much is worn for the first time; one of the arguments is given.

        Args:
            share: Share of the final volume, 0 <= share < 1; of blocks that of their last volume.
            depth: Depth in m, >= 0 and finite, that is worn at the deepest place.
            volume: Volume in m^3, >= 0 and finite.

        Returns:
            The cycles, broadcast against the contacts. Infinite for a depth or a volume that is never reached, or not
            within the blocks. NaN for a share where nothing wears, and in gross slip beyond the end of the run.
        """
        goals = {"share": share, "depth": depth, "volume": volume}
        goals = {name: goal for name, goal in goals.items() if goal is not None}
        if len(goals) != 1:
            told = " and ".join(goals) or "none of them"
            raise ValueError(f"cycles_to takes one of share, depth in m and volume in m^3, not {told}")
        ((name, goal),) = goals.items()
        return self._read("cycles_to", name, self._argument(name, goal))

    @property
    def lasting_cycles(self) -> Array:
        """Cycles at the end of the run, after which nothing wears any more or after which it is not followed."""
        return _read_from(("last",), self._solution)

    def _over_radii(self, name: str, r: ArrayLike, cycles: ArrayLike) -> Array:
        at = self._argument("r", r), self._argument("cycles", cycles)
        return _read_from(("field", name), self._solution, *at)

    def depth(self, r: ArrayLike, cycles: ArrayLike) -> Array:
        """Depth in m worn off the indenter."""
        return self._over_radii("depth", r, cycles)

    def profile(self, r: ArrayLike, cycles: ArrayLike) -> Array:
        """Shape of the worn indenter in m above its apex."""
        return self.depth(r, cycles) + outline_of(self.contact).height(nan_outside("r", r, NOT_NEGATIVE))

    def pressure(self, r: ArrayLike, cycles: ArrayLike) -> Array:
        """Pressure in Pa, nowhere negative."""
        return self._over_radii("pressure", r, cycles)
