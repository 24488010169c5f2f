"""Tangential loads of a contact over cycles: a constant amplitude of the force or of the displacement, or blocks."""

from plgwear_jax._core.domains import CYCLES, POSITIVE, ArrayLike, Domain, Numbers, check
from plgwear_jax._core.ranges import NUMBER
from plgwear_jax._core.record import record

__all__ = ["AMPLITUDE_OF_DISPLACEMENT", "AMPLITUDE_OF_FORCE", "Block", "Displacement", "Force"]

AMPLITUDE_OF_FORCE = Domain(">= 0, the amplitude of a force in N", lambda force: force >= 0.0)
AMPLITUDE_OF_DISPLACEMENT = Domain("displacement_amplitude >= 0 and finite", NUMBER.contains)


@record
class Force:
    """Force control: the amplitude of the tangential force is constant.

    Attributes:
        tangential_force: The amplitude F_x in N, 0 <= F_x < mu F_N.

    Raises:
        ValueError: A concrete amplitude is negative. Traced ones turn results into NaN.

    Examples:
        >>> from plgwear_jax import loads
        >>> print(loads.Force(0.32).tangential_force)  # N
        0.32

    References:
        `docs/explanation/theory.md`, "Wear over cycles".
    """

    tangential_force: Numbers

    def __post_init__(self) -> None:
        check("tangential_force", self.tangential_force, AMPLITUDE_OF_FORCE)


@record
class Displacement:
    """Displacement control: the amplitude of the tangential displacement is constant.

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
        `docs/explanation/theory.md`, "Wear over cycles".
    """

    displacement_amplitude: Numbers
    rig_stiffness: ArrayLike | None = None

    def __post_init__(self) -> None:
        check("displacement_amplitude", self.displacement_amplitude, AMPLITUDE_OF_DISPLACEMENT)
        if self.rig_stiffness is not None:
            check("rig_stiffness", self.rig_stiffness, POSITIVE)


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
        `docs/explanation/theory.md`, "Any test".
    """

    load: ArrayLike | Force | Displacement
    cycles: Numbers
    normal_force: ArrayLike | None = None
    friction: ArrayLike | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.load, Force | Displacement):
            check("load", self.load, AMPLITUDE_OF_FORCE)
        check("cycles", self.cycles, CYCLES)
        for name in ("normal_force", "friction"):
            if getattr(self, name) is not None:
                check(name, getattr(self, name), POSITIVE)
