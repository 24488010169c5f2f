"""The only place that chooses between closed forms and numerical solutions, by the types of the bodies alone."""

from typing import TYPE_CHECKING, Any

import numpy as np
from jax import Array

from plgwear_jax._core.domains import ArrayLike, as_array
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


def check_closed(contact: Any, what: str) -> None:
    """Refuse a contact without closed forms."""
    if not is_closed(contact):
        raise ValueError(f"{what}: takes a PowerLawGraded material under a rigid indenter alone")


def steady_of(contact: Any, tangential_force: ArrayLike, digits: int | None) -> Steady:
    """The steady state by the engine of the contact."""
    if is_closed(contact):
        from plgwear_jax.steady.closed import ClosedSteady as Engine
    else:
        from plgwear_jax.steady.numeric import NumericSteady as Engine
    return Engine(contact, tangential_force, digits)


def run_of(
    contact: Any,
    tangential_force: ArrayLike,
    wear_coefficient: ArrayLike,
    control: str = "force",
    rig_stiffness: ArrayLike | None = None,
    digits: int | None = None,
) -> "Run":
    """The wear over cycles by the engine of the contact; the arguments are those of `Run`."""
    if is_closed(contact):
        from plgwear_jax.wear.closed import ClosedRun as Engine
    else:
        from plgwear_jax.wear.numeric import NumericRun as Engine
    return Engine(contact, tangential_force, wear_coefficient, control, rig_stiffness, digits)


def test_of(contact: Any, load: Any, law: Any, digits: int | None) -> "Run":
    """The wear over cycles of a test; the arguments are those of `FrettingContact.over_cycles`."""
    from plgwear_jax.loads import Block, Displacement, Force
    from plgwear_jax.wear_laws import Archard, WearLaw, law_of

    if not isinstance(law, WearLaw) and (isinstance(law, str | type | None) or callable(law)):
        raise TypeError(f"law takes a wear coefficient K in 1/Pa or an instance of a WearLaw, not {law!r}")
    law, several = law_of(law), isinstance(load, list | tuple)
    if several and not load:
        raise ValueError("load takes one Block or more, not an empty list")
    load = as_array(load)
    if several and not isinstance(load, Array | np.ndarray):
        load = tuple(load)
        for block in load:
            if not isinstance(block, Block):
                raise TypeError(f"load takes numbers or a list of Block(load, cycles), not of {block!r}")
    elif not isinstance(load, Displacement):
        load = load if isinstance(load, Force) else Force(load)
        if isinstance(law, Archard):
            return run_of(contact, load.tangential_force, law.wear_coefficient, "force", None, digits)
    from plgwear_jax.wear.marched import MarchedRun

    return MarchedRun(contact, load, law, digits)
