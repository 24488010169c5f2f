"""What the fields of the contacts and the arguments of their methods may be."""

from typing import Any

from plgwear_jax._core.domains import AMPLITUDE, CYCLES, DISTANCE, POSITIVE, RADIUS, SHARE, Domain, check
from plgwear_jax.material import PowerLawGraded

__all__ = ["ARGUMENTS", "DISPLACEMENT", "FORCE", "NUMBER", "PARTIAL_SLIP", "check_again", "check_fields", "check_life"]

FORCE = Domain(">= 0, the amplitude of a force in N", lambda force: force >= 0.0)
PARTIAL_SLIP = Domain("0 <= F_x/(mu F_N) < 1, beyond which the slip is gross", AMPLITUDE.contains)
DISPLACEMENT = Domain("displacement_amplitude >= 0", lambda displacement: displacement >= 0.0)
NUMBER = Domain("cycles >= 0 and finite", CYCLES.contains)

ARGUMENTS = {
    "r": RADIUS,
    "distance": DISTANCE,
    "displacement_amplitude": DISPLACEMENT,
    "rig_stiffness": POSITIVE,
    "cycles": NUMBER,
    "wear_coefficient": POSITIVE,
    "share": SHARE,
}


def check_life(cycles: Any, wear_coefficient: Any) -> None:
    """Refuse one of the two without the other."""
    if (cycles is None) != (wear_coefficient is None):
        raise TypeError("cycles and wear_coefficient go together: one needs the other")


def check_again(contact: Any) -> None:
    """Check the fields of a record that JAX rebuilt without."""
    contact.__post_init__()
    contact.material.__post_init__()


def check_fields(contact: Any, *names: str) -> None:
    """Check that the material is one and that the named fields are positive."""
    if not isinstance(contact.material, PowerLawGraded):
        raise TypeError(f"material takes a PowerLawGraded, not {contact.material!r}")
    for name in names:
        check(name, getattr(contact, name), POSITIVE)
