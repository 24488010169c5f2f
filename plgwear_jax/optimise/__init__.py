"""Gradients that wear least, with what may vary, what is held, the limits and the load."""

from plgwear_jax.optimise.amplitudes import CriticalAmplitudes, critical_amplitudes
from plgwear_jax.optimise.comparison import Comparison, compared
from plgwear_jax.optimise.designing import (
    Course,
    Design,
    Designs,
    LimitState,
    Misjudged,
    along,
    design,
    designs,
    misjudged,
)
from plgwear_jax.optimise.exponent import OptimalExponent, optimal_exponent
from plgwear_jax.optimise.frontier import Front, front
from plgwear_jax.optimise.loads import tail_weights
from plgwear_jax.optimise.minimum import Interval, Minimum, minimise
from plgwear_jax.optimise.problem import Limits, ModulusWindow
from plgwear_jax.optimise.sensitivity import Sensitivities, sensitivities

__all__ = [
    "Comparison",
    "Course",
    "CriticalAmplitudes",
    "Design",
    "Designs",
    "Front",
    "Interval",
    "LimitState",
    "Limits",
    "Minimum",
    "Misjudged",
    "ModulusWindow",
    "OptimalExponent",
    "Sensitivities",
    "along",
    "compared",
    "critical_amplitudes",
    "design",
    "designs",
    "front",
    "minimise",
    "misjudged",
    "optimal_exponent",
    "sensitivities",
    "tail_weights",
]
