"""What the fields of the contacts and the arguments of their methods may be."""

from typing import Any

from plgwear_jax._core.domains import AMPLITUDE, CYCLES, DISTANCE, POSITIVE, RADIUS, SHARE, Domain, check
from plgwear_jax.material import PowerLawGraded

__all__ = [
    "ARGUMENTS",
    "DISPLACEMENT",
    "FORCE",
    "NUMBER",
    "PARTIAL_SLIP",
    "check_again",
    "check_bodies",
    "check_fields",
    "check_life",
    "check_power_law",
]

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
    if getattr(contact, "indenter", None) is not None:
        contact.indenter.__post_init__()


def check_bodies(contact: Any) -> None:
    """Check that the material and the indenter are ones that touch."""
    if isinstance(contact.material, PowerLawGraded) and contact.indenter is None:
        return
    from plgwear_jax.surfaces import DepthGraded, Elastic

    if not isinstance(contact.material, PowerLawGraded | DepthGraded):
        raise TypeError(f"material takes a PowerLawGraded or a DepthGraded, not {contact.material!r}")
    if not isinstance(contact.indenter, Elastic | None):
        raise TypeError(f"indenter takes an Elastic, or None for a rigid one, not {contact.indenter!r}")


def check_closed(contact: Any, what: str) -> None:
    """Check that a contact has closed forms: a power law under a rigid indenter."""
    if not isinstance(contact.material, PowerLawGraded) or getattr(contact, "indenter", None) is not None:
        raise ValueError(f"{what}: takes a PowerLawGraded material under a rigid indenter alone")


def check_power_law(material: Any) -> None:
    """Check that a material is a power law."""
    if not isinstance(material, PowerLawGraded):
        raise TypeError(f"material takes a PowerLawGraded, not {material!r}")


def check_fields(contact: Any, *names: str) -> None:
    """Check that the named fields are positive."""
    for name in names:
        check(name, getattr(contact, name), POSITIVE)
