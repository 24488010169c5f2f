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
from plgwear_jax.contact.arguments import is_closed, refuse_control
from plgwear_jax.material import PowerLawGraded
from plgwear_jax.shapes import Parabola, shape_of

__all__ = ["closed_form_of", "quantity"]

Signature = ParamSpec("Signature")


def quantity(method: Callable[Signature, Array]) -> Callable[Signature, Array]:
    """A method in closed form; for contacts without one the function of its name in `numeric` or `numeric_cycles`."""
    closed, name = compiled(method), method.__name__
    signature = inspect.signature(method)
    unchecked = {"digits", *(name for name, one in signature.parameters.items() if isinstance(one.default, bool | str))}

    @functools.wraps(method)
    def public(*args: Signature.args, **kwargs: Signature.kwargs) -> Array:
        contact: Any = args[0]
        if is_closed(contact):
            return closed(*args, **kwargs)
        same = closed_form_of(contact)
        if same is not None:
            return closed(same, *args[1:], **kwargs)  # pyright: ignore[reportCallIssue]
        bound: dict[str, Any] = signature.bind(*args, **kwargs).arguments
        del bound["self"]
        contact._check(**{name: value for name, value in bound.items() if name not in unchecked})
        if "control" in signature.parameters and _over_cycles(name, bound):
            from plgwear_jax.wear import numeric
        else:
            from plgwear_jax.steady import numeric
        return getattr(numeric, name)(contact, **bound)

    return public


def _over_cycles(name: str, arguments: dict[str, Any]) -> bool:
    """Whether wear over cycles is asked for; without it the arguments lose what is of that alone."""
    over_cycles = arguments.get("cycles") is not None or name == "cycles_to"
    refuse_control(arguments.get("control", "force"), over_cycles, arguments.get("rig_stiffness") is not None)
    if not over_cycles:
        for name in ("cycles", "wear_coefficient", "control", "rig_stiffness"):
            arguments.pop(name, None)
    return over_cycles


def closed_form_of(contact: Any) -> Any:
    """The contact of a rigid indenter that does the same as this one between two homogeneous bodies, or None."""
    material, indenter = contact.material, contact.indenter
    parabola = isinstance(shape_of(contact), Parabola)
    if not isinstance(material, PowerLawGraded) or not parabola or isinstance(material.k, Tracer):
        return None
    if any(isinstance(leaf, Tracer) for leaf in jax.tree.leaves(indenter)) or np.any(np.asarray(material.k) != 0.0):
        return None
    if isinstance(contact.material.nu, str):
        return None
    from plgwear_jax.surfaces import in_series

    contact._check()
    return type(contact)(in_series(material, indenter), contact.radius, contact.normal_force, contact.friction)
