"""Gradients that wear least, with what may vary, what is held, the limits and the load."""

from plgwear_jax.optimise.comparison import Comparison, compared
from plgwear_jax.optimise.designing import (
    Course,
    Design,
    ForEver,
    LimitState,
    Misjudged,
    along,
    design,
    for_ever,
    misjudged,
)
from plgwear_jax.optimise.exponent import CriticalAmplitudes, OptimalExponent, critical_amplitudes, optimal_exponent
from plgwear_jax.optimise.free import FreeDesign, LocalMinimum, ModulusProfile, free_design
from plgwear_jax.optimise.frontier import Conflict, Front, conflict, front
from plgwear_jax.optimise.loads import WeightedLoad, tail_weights
from plgwear_jax.optimise.many import Designs, designs
from plgwear_jax.optimise.minimum import Interval, Minimum, differentiable, minimise
from plgwear_jax.optimise.question import Keywords, Limit, Question, WearHorizon
from plgwear_jax.optimise.scenarios import Scenarios
from plgwear_jax.optimise.sensitivity import Sensitivities, sensitivities

__all__ = [
    "Comparison",
    "Conflict",
    "Course",
    "CriticalAmplitudes",
    "Design",
    "Designs",
    "ForEver",
    "FreeDesign",
    "Front",
    "Interval",
    "Keywords",
    "Limit",
    "LimitState",
    "LocalMinimum",
    "Minimum",
    "Misjudged",
    "ModulusProfile",
    "OptimalExponent",
    "Question",
    "Scenarios",
    "Sensitivities",
    "WearHorizon",
    "WeightedLoad",
    "along",
    "compared",
    "conflict",
    "critical_amplitudes",
    "design",
    "designs",
    "differentiable",
    "for_ever",
    "free_design",
    "front",
    "minimise",
    "misjudged",
    "optimal_exponent",
    "sensitivities",
    "tail_weights",
]
