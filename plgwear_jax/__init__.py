"""Differentiable contact mechanics for the wear of contacts with power-law graded materials.

Closed forms of gross slip (`gross_slip`) and of fretting wear (`fretting`) on a half-space with E(z) = E0 (z/z0)^k,
without units; the same in SI units as `GrossSlipContact` and `FrettingContact`; and the gradients that wear least
(`optimise`); and maps of all these over any axes (`sweep`, which needs the extra of that name). Everything is
`jax.numpy`: it compiles, batches and differentiates. float64 needs `jax_enable_x64`.
"""

import importlib
from types import ModuleType
from typing import TYPE_CHECKING

from plgwear_jax import fretting, gross_slip, material, optimise
from plgwear_jax.contact import FrettingContact, GrossSlipContact
from plgwear_jax.material import PowerLawGraded

if TYPE_CHECKING:
    from plgwear_jax import sweep

__all__ = [
    "FrettingContact",
    "GrossSlipContact",
    "PowerLawGraded",
    "fretting",
    "gross_slip",
    "material",
    "optimise",
    "sweep",
]

__version__ = "0.1.0"


def __getattr__(name: str) -> ModuleType:
    """`sweep`, when it is first looked at: the core does without what it needs."""
    if name != "sweep":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    try:
        return importlib.import_module("plgwear_jax.sweep")
    except ModuleNotFoundError as error:
        how = "pip install 'plgwear-jax[sweep]', in a clone '.[sweep]'"
        text = f"sweeps need the extra sweep ({error.name} is missing): {how}"
        raise ModuleNotFoundError(text, name=error.name) from None
