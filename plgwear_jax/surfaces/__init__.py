"""Surfaces beyond the power law under a rigid indenter: elastic indenters and any E(z), solved numerically.

Compliances of two bodies add. The contact of fixed radius is solved by Galerkin's method with pressures whose Hankel
transforms are Bessel functions, and what is beside it by Abel's transform: `docs/explanation/numerics.md` derives both.
"""

from .bodies import DepthGraded, Elastic, Layered, in_series

__all__ = ["DepthGraded", "Elastic", "Layered", "in_series"]
