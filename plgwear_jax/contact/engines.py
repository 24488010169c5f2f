"""The only place that chooses between closed forms and numerical solutions, by the types of the bodies alone."""

from typing import TYPE_CHECKING, Any

from plgwear_jax.loads import load_of
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.shapes.of_contact import shape_of
from plgwear_jax.shapes.powers import Parabola
from plgwear_jax.steady.solution import Steady

if TYPE_CHECKING:
    from plgwear_jax.wear.run import Run


# An engine is imported by the first contact that needs it.


def is_closed(contact: Any) -> bool:
    """Whether a contact has closed forms: a rigid parabola or punch on a power law, or two homogeneous bodies."""
    if not isinstance(shape_of(contact), Parabola):
        return False
    if isinstance(contact.material, PowerLawGraded):
        return getattr(contact, "indenter", None) is None
    from plgwear_jax.surfaces import Elastic

    return isinstance(contact.material, Elastic)


def steady_of(contact: Any, load: Any, digits: int | None) -> Steady:
    """The steady state by the engine of the contact."""
    if is_closed(contact):
        from plgwear_jax.steady.closed import ClosedSteady as Engine
    else:
        from plgwear_jax.steady.numeric import NumericSteady as Engine
    return Engine(contact, load_of(load), digits)


def run_of(contact: Any, load: Any, law: Any, digits: int | None) -> "Run":
    """The wear over cycles by the engine of the contact, its load and its law."""
    from plgwear_jax.wear_laws import Archard, WearLaw, law_of

    if not isinstance(law, WearLaw) and (isinstance(law, str | type | None) or callable(law)):
        raise TypeError(f"law takes a wear coefficient K in 1/Pa or an instance of a WearLaw, not {law!r}")
    load, law = load_of(load), law_of(law)
    if not (load.holds_force and isinstance(law, Archard)):
        from plgwear_jax.wear.marched import MarchedRun as Engine
    elif is_closed(contact):
        from plgwear_jax.wear.closed_ring import ClosedRun as Engine
    else:
        from plgwear_jax.wear.numeric_ring import NumericRun as Engine
    return Engine(contact, load, law, digits)
