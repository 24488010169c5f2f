"""Tangential loads of a contact: a constant amplitude of the force or of the displacement, or blocks of cycles."""

import dataclasses
from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from plgwear_jax._core.domains import (
    AMPLITUDE,
    NUMBER,
    POSITIVE,
    ArrayLike,
    Domain,
    Numbers,
    RecordFamily,
    RefusedError,
    as_array,
    check,
    field_nan_outside,
    nan_outside,
    nan_unless,
    real_dtype,
    record,
)
from plgwear_jax._core.startup.programs import holds_tracers, traced

__all__ = ["Block", "Blocks", "Control", "Displacement", "Force", "Load"]

AMPLITUDE_OF_FORCE = Domain(">= 0, the amplitude of a force in N", lambda force: force >= 0.0)
PARTIAL_SLIP = Domain("0 <= F_x/(mu F_N) < 1, beyond which the slip is gross", AMPLITUDE.contains)


class Control(NamedTuple):
    """What stays constant over the cycles: displacement_factor u + force_factor F_x = value."""

    displacement_factor: Any
    force_factor: Any
    value: Any


class Stage(NamedTuple):
    """Some cycles under one load; without a normal force or a friction of its own it has those of the contact."""

    load: "Load"
    cycles: Any = np.nan  # NaN without an end
    normal_force: Any = None
    friction: Any = None


class Load(RecordFamily):
    """What moves a contact: `FrettingContact.steady` and `over_cycles` take an instance of any subclass.

    A subclass says which force it needs before any wear and what it keeps constant over the cycles. Without a decorator
    it becomes a frozen dataclass and a pytree of its fields, by which results can be differentiated. The first field is
    its amplitude.

    Attributes:
        holds_force: Whether the force amplitude stays constant, so that the steady state of this force is the end.
        lasts: Whether the load has no last cycle.
        ranges: What fields may be, by their names.

    Examples:
        >>> from plgwear_jax import FrettingContact, PowerLawGraded
        >>> from plgwear_jax.loads import Control, Load
        >>> class Spring(Load):  # a leaf spring beside the contact takes its share of the force
        ...     total_force: float
        ...     stiffness: float
        ...
        ...     def control(self, limit):
        ...         return Control(self.stiffness, 1.0, self.total_force)
        >>> coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
        >>> contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
        >>> run = contact.over_cycles(Spring(3.0, 2e6), 1e-14)
        >>> print(bool(run.force_amplitude(1e5) < run.force_amplitude(0.0)))  # the worn contact gives way more
        True

    References:
        `docs/explanation/numerics.md`, "Any test".
    """

    holds_force: ClassVar[bool] = False
    lasts: ClassVar[bool] = True
    rig_stiffness = None

    def check(self, friction: ArrayLike, normal_force: ArrayLike, shares: Domain = PARTIAL_SLIP) -> None:
        """Refuse concrete values outside their ranges: JAX rebuilds records without asking `__post_init__`."""
        self.__post_init__()  # pyright: ignore[reportAttributeAccessIssue]

    def check_at_rest(self, at_rest: Any) -> None:
        """Refuse concrete values of gross slip; `at_rest` is the `Steady` in this rig under no force."""

    def force_before_wear(self, at_rest: Any) -> ArrayLike:
        """The force amplitude F_x in N before any wear; `at_rest` is the `Steady` in this rig under no force."""
        raise TypeError(f"{type(self).__name__} has no steady state: it has no force amplitude of its own")

    def control(self, limit: Any) -> Control:
        """What stays constant over the cycles; `limit` is mu F_N in N."""
        raise NotImplementedError(f"{type(self).__name__} has no control(limit)")

    def with_amplitude(self, change: Callable[[Any], Any]) -> Self:
        """The load with a changed amplitude."""
        name, amplitude = next(iter(vars(self).items()))
        return dataclasses.replace(self, **{name: change(amplitude)})  # pyright: ignore[reportArgumentType]

    def stages(self) -> tuple[Any, ...]:
        """The load as cycles under one load after the other: one `Stage` or several `Block`."""
        return (Stage(self),)

    @property
    def amplitude(self) -> Any:
        """The amplitude of the force in N, or of the displacement in m; None if there are several."""
        return next(iter(vars(self).values()))

    @property
    def rig_compliance(self) -> Any:
        """The compliance in m/N of a rig in series, at whose actuator displacements are measured; 0 without a rig."""
        return 0.0 if self.rig_stiffness is None else 1.0 / nan_outside("rig_stiffness", self.rig_stiffness, POSITIVE)


class Force(Load):
    """Force control: the amplitude of the tangential force is constant.

    Attributes:
        tangential_force: The amplitude F_x in N, 0 <= F_x < mu F_N.
        rig_stiffness: Stiffness of the rig in N/m, in series with the contact, if displacements are measured at the
            actuator of the rig; None if they are measured at the contact. It changes no wear.

    Raises:
        ValueError: A concrete field is outside its range. Traced ones turn results into NaN.

    Examples:
        >>> from plgwear_jax import loads
        >>> print(loads.Force(0.32).tangential_force)  # N
        0.32

    References:
        `docs/explanation/numerics.md`, "Wear over cycles".
    """

    holds_force: ClassVar[bool] = True
    ranges: ClassVar = {"tangential_force": AMPLITUDE_OF_FORCE, "rig_stiffness": POSITIVE}

    tangential_force: Numbers
    rig_stiffness: Any = None

    def check(self, friction: ArrayLike, normal_force: ArrayLike, shares: Domain = PARTIAL_SLIP) -> None:
        """Refuse concrete values outside their ranges, among them amplitudes of gross slip."""
        super().check(friction, normal_force, shares)
        values = tuple(map(as_array, (self.tangential_force, friction, normal_force)))
        if holds_tracers(values):
            return
        dtype = real_dtype("tangential_force", values)
        force, mu, normal = (np.asarray(value, dtype) for value in values)  # NumPy compiles nothing
        try:
            check("tangential_force/(friction * normal_force)", force / (mu * normal), shares)
        except ValueError as error:  # of numbers that are allowed one by one
            raise RefusedError(str(error)) from None

    def force_before_wear(self, at_rest: Any) -> ArrayLike:
        """The amplitude itself."""
        return self.tangential_force

    def control(self, limit: Any) -> Control:
        """F_x is constant."""
        amplitude = field_nan_outside(self, "tangential_force")
        return Control(0.0, 1.0, nan_unless(PARTIAL_SLIP.contains(amplitude / limit), amplitude))


class Displacement(Load):
    """Displacement control: the amplitude of the tangential displacement is constant.

    `FrettingContact.steady` gives the contact under the force amplitude that this displacement needs before any wear,
    which has to be one of partial slip. Over the cycles the displacement is kept, and less is worn than by that force.

    Attributes:
        displacement_amplitude: The amplitude in m. From `gross_slip_displacement` on the contact slips as a whole.
        rig_stiffness: Stiffness of the rig in N/m, in series with the contact, if the displacement is measured at the
            actuator of the rig; None if it is measured at the contact.

    Raises:
        ValueError: A concrete field is outside its range. Traced ones turn results into NaN.

    Examples:
        >>> from plgwear_jax import loads
        >>> print(loads.Displacement(1e-6, rig_stiffness=1e7).rig_stiffness)  # N/m
        10000000.0

    References:
        `docs/explanation/numerics.md`, "Wear over cycles".
    """

    ranges: ClassVar = {"displacement_amplitude": NUMBER, "rig_stiffness": POSITIVE}

    displacement_amplitude: Numbers
    rig_stiffness: Any = None

    def check_at_rest(self, at_rest: Any) -> None:
        """Refuse concrete amplitudes under which the unworn contact slips as a whole."""
        if not traced((at_rest.contact, self)):
            limit = at_rest.gross_slip_displacement
            where = f"{float(limit):.4g} m, where" if limit.ndim == 0 else "gross_slip_displacement, where"
            allowed = Domain(f"0 <= displacement_amplitude < {where} gross slip begins", lambda u: u / limit < 1.0)
            check("displacement_amplitude", self.displacement_amplitude, allowed)

    def force_before_wear(self, at_rest: Any) -> ArrayLike:
        """The force amplitude in N at which the unworn contact has this displacement amplitude."""
        self.check_at_rest(at_rest)
        return at_rest.force_at(self.displacement_amplitude)

    def control(self, limit: Any) -> Control:
        """The displacement of the contact and of the rig together is constant."""
        return Control(1.0, self.rig_compliance, field_nan_outside(self, "displacement_amplitude"))


@record
class Block:
    """A number of cycles under one load, of a test in blocks: `contact.over_cycles([Block(...), ...], law)`.

    Attributes:
        load: A force amplitude F_x in N, a `Force` or a `Displacement`.
        cycles: Number of cycles, >= 0 and finite.
        normal_force: Normal force F_N in N in this block, positive; that of the contact if None.
        friction: Coefficient of friction mu in this block, positive; that of the contact if None.

    Raises:
        ValueError: A concrete field is outside its range. Traced ones turn results into NaN.

    Examples:
        >>> from plgwear_jax import loads
        >>> print(loads.Block(0.32, cycles=1e5, friction=0.3).friction)
        0.3

    References:
        `docs/explanation/numerics.md`, "Any test".
    """

    ranges: ClassVar = {"cycles": NUMBER, "normal_force": POSITIVE, "friction": POSITIVE}

    load: Any
    cycles: Numbers
    normal_force: ArrayLike | None = None
    friction: ArrayLike | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "load", load_of(self.load))
        if not self.load.lasts:
            raise TypeError("a Block takes one load; give the blocks of several as one list")


class Blocks(Load):
    """A test in blocks, each of which begins with the worn shape that the blocks before have left.

    Attributes:
        of: One `Block` or more.

    Examples:
        >>> from plgwear_jax import loads
        >>> test = loads.Blocks([loads.Block(0.32, cycles=1e5), loads.Block(loads.Displacement(1e-6), cycles=1e4)])
        >>> print(len(test.stages()))  # `over_cycles` takes the list as well
        2

    References:
        `docs/explanation/numerics.md`, "Any test".
    """

    lasts: ClassVar[bool] = False

    of: Any

    def __post_init__(self) -> None:
        object.__setattr__(self, "of", tuple(self.of) if np.iterable(self.of) else (self.of,))
        if not self.of:
            raise ValueError("load takes one Block or more, not an empty list")
        for block in self.of:
            if not isinstance(block, Block):
                raise TypeError(f"load takes numbers or a list of Block(load, cycles), not of {block!r}")

    def check(self, friction: ArrayLike, normal_force: ArrayLike, shares: Domain = PARTIAL_SLIP) -> None:
        """Refuse concrete values outside their ranges, and say in which block they are."""
        for number, block in enumerate(self.of, 1):
            try:
                block.__post_init__()
                own = friction if block.friction is None else block.friction
                block.load.check(own, normal_force if block.normal_force is None else block.normal_force)
            except ValueError as error:
                raise RefusedError(f"block {number}: {error}") from None

    @property
    def amplitude(self) -> None:
        """Each block has its own."""

    def stages(self) -> tuple[Any, ...]:
        """The blocks."""
        return self.of

    def with_amplitude(self, change: Callable[[Any], Any]) -> Self:
        """The blocks with changed amplitudes."""
        blocks = [dataclasses.replace(block, load=block.load.with_amplitude(change)) for block in self.of]
        return dataclasses.replace(self, of=blocks)


def load_of(given: Any) -> Load:
    """The load as it is; of numbers, these force amplitudes; of a list of `Block`, the test in blocks."""
    if isinstance(given, Load):
        return given
    numbers = as_array(given)
    of_blocks = isinstance(given, list | tuple) and (numbers is given or not given)
    return Blocks(given) if of_blocks else Force(numbers)
