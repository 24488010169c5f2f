"""Which contacts have closed forms, and who answers for the others."""

import functools
import inspect
from collections.abc import Callable
from typing import Any, ParamSpec

import jax
import numpy as np
from jax import Array
from jax.core import Tracer

from plgwear_jax._core.formula import compiled
from plgwear_jax.contact.arguments import refuse_control
from plgwear_jax.material import PowerLawGraded

__all__ = ["quantity"]

Signature = ParamSpec("Signature")


def quantity(method: Callable[Signature, Array]) -> Callable[Signature, Array]:
    """A method in closed form; for contacts without one the function of its name in `contact.numeric`."""
    closed, name = compiled(method), method.__name__
    signature = inspect.signature(method)
    unchecked = {"digits", *(name for name, one in signature.parameters.items() if isinstance(one.default, bool | str))}

    @functools.wraps(method)
    def public(*args: Signature.args, **kwargs: Signature.kwargs) -> Array:
        contact: Any = args[0]
        if contact.indenter is None and isinstance(contact.material, PowerLawGraded):
            return closed(*args, **kwargs)
        from plgwear_jax.contact import numeric

        same = _in_series(contact)
        if same is not None:
            return closed(same, *args[1:], **kwargs)  # pyright: ignore[reportCallIssue]
        bound: dict[str, Any] = signature.bind(*args, **kwargs).arguments
        del bound["self"]
        contact._check(**{name: value for name, value in bound.items() if name not in unchecked})
        if "control" in signature.parameters:
            _refuse_cycles(name, bound)
        return getattr(numeric, name)(contact, **bound)

    return public


_OVER_CYCLES = "cycles", "wear_coefficient", "control", "rig_stiffness"


def _refuse_cycles(name: str, arguments: dict[str, Any]) -> None:
    """Take what belongs to wear over cycles out of the arguments, and refuse it."""
    cycles, _, control, rig_stiffness = (arguments.pop(key, None) for key in _OVER_CYCLES)
    if name != "cycles_to":
        refuse_control(control or "force", cycles is not None, rig_stiffness is not None)
    if cycles is not None or name == "cycles_to":
        raise ValueError("wear over cycles is computed for a power law under a rigid indenter alone; leave out cycles")


def _in_series(contact: Any) -> Any:
    """The contact of a rigid indenter that does the same as this one between two homogeneous bodies, or None."""
    material, indenter = contact.material, contact.indenter
    if not isinstance(material, PowerLawGraded) or isinstance(material.k, Tracer):
        return None
    if any(isinstance(leaf, Tracer) for leaf in jax.tree.leaves(indenter)) or np.any(np.asarray(material.k) != 0.0):
        return None
    if isinstance(contact.material.nu, str):
        return None
    from plgwear_jax.surfaces import in_series

    contact._check()
    return type(contact)(in_series(material, indenter), contact.radius, contact.normal_force, contact.friction)
