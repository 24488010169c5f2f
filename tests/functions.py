"""The public dimensionless functions by name, for the tests that hold of every one of them."""

import inspect

from plgwear_jax import fretting, gross_slip, material

FUNCTIONS = {
    f"{module.__name__.rpartition('.')[2]}.{name}": getattr(module, name)
    for module, names in (
        (gross_slip, gross_slip.__all__),
        (fretting, fretting.__all__),
        (material, ("h_N", "holl_ratio")),
    )
    for name in names
}


def arguments(name: str) -> tuple[str, ...]:
    """The array arguments of a function, in their order."""
    return tuple(p for p in inspect.signature(FUNCTIONS[name]).parameters if p != "digits")
