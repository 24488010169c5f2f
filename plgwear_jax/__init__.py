"""Wear of an indenter on a half-space or coating with E(z) = E0 (z/z0)^k, in closed form and differentiable.

Dimensionless functions for gross slip (`gross_slip`) and fretting wear (`fretting`); the same in SI units as
`GrossSlipContact` and `FrettingContact`; the gradients that wear least (`optimise`); and maps of all these over any
axes (`sweep`, which needs the extra of that name). Everything is `jax.numpy` and can be compiled, batched and
differentiated. float64 needs `jax_enable_x64`.

Each module is imported on first use, so that importing the package alone costs nothing.
"""

import importlib
from typing import TYPE_CHECKING, Any

from plgwear_jax._version import __version__ as __version__

if TYPE_CHECKING:
    from plgwear_jax import fretting, gross_slip, loads, material, optimise, partial_slip, shapes, surfaces, wear_laws
    from plgwear_jax._core.doubts import DoubtfulInputWarning
    from plgwear_jax._core.startup.programs import compiler_options
    from plgwear_jax.contact import FrettingContact, GrossSlipContact
    from plgwear_jax.material import PowerLawGraded
    from plgwear_jax.shapes import Cone, Parabola, PowerShape, Profile, RoundedFlat, Shape, TruncatedSphere
    from plgwear_jax.surfaces import DepthGraded, Elastic, Layered
    from plgwear_jax.wear_laws import WearLaw

__all__ = [
    "Cone",
    "DepthGraded",
    "DoubtfulInputWarning",
    "Elastic",
    "FrettingContact",
    "GrossSlipContact",
    "Layered",
    "Parabola",
    "PowerLawGraded",
    "PowerShape",
    "Profile",
    "RoundedFlat",
    "Shape",
    "TruncatedSphere",
    "WearLaw",
    "compiler_options",
    "fretting",
    "gross_slip",
    "loads",
    "material",
    "optimise",
    "partial_slip",
    "shapes",
    "surfaces",
    "wear_laws",
]

_SELDOM = "contact", "special", "sweep"  # which a star does not import
_CLASSES = {
    "DepthGraded": "surfaces",
    "Elastic": "surfaces",
    "Layered": "surfaces",
    "FrettingContact": "contact",
    "GrossSlipContact": "contact",
    "PowerLawGraded": "material",
    "Cone": "shapes",
    "Parabola": "shapes",
    "PowerShape": "shapes",
    "Profile": "shapes",
    "RoundedFlat": "shapes",
    "Shape": "shapes",
    "TruncatedSphere": "shapes",
    "WearLaw": "wear_laws",
    "DoubtfulInputWarning": "_core.doubts",
    "compiler_options": "_core.startup.programs",
}


def __getattr__(name: str) -> Any:
    """A module or a class, on first use."""
    if name not in (*__all__, *_SELDOM):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = importlib.import_module(f"{__name__}.{_CLASSES.get(name, name)}")
    found = getattr(module, name) if name in _CLASSES else module
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
