"""Differentiable contact mechanics for the wear of contacts with power-law graded materials.

Closed forms of gross slip (`gross_slip`) and of fretting wear (`fretting`) on a half-space with E(z) = E0 (z/z0)^k,
without units; the same in SI units as `GrossSlipContact` and `FrettingContact`; and the gradients that wear least
(`optimise`). Everything is `jax.numpy`: it compiles, batches and differentiates. float64 needs `jax_enable_x64`.
"""

from plgwear_jax import fretting, gross_slip, material, optimise
from plgwear_jax.contact import FrettingContact, GrossSlipContact
from plgwear_jax.material import PowerLawGraded

__all__ = [
    "FrettingContact",
    "GrossSlipContact",
    "PowerLawGraded",
    "fretting",
    "gross_slip",
    "material",
    "optimise",
]

__version__ = "0.1.0"
