"""Gradients that wear least, with what may vary, the constraint, the limits and the load."""

from .afterwards import (
    InSteadyState,
    ObjectiveCurve,
    Sensitivities,
    UnderOtherLoad,
    along,
    in_steady_state,
    sensitivities,
    under_other_load,
)
from .batches import Designs, designs
from .best import Comparison, Design, LimitState, compared, design
from .exponent import CriticalAmplitudes, OptimalExponent, critical_amplitudes, optimal_exponent
from .free import FreeDesign, LocalMinimum, ModulusProfile, free_design
from .question import Keywords, Limit, Question, WearHorizon
from .scenarios import Scenarios, WeightedLoad, tail_weights
from .search import Interval, Minimum, minimise
from .tradeoffs import Conflict, Front, conflict, front

__all__ = [
    "Comparison",
    "Conflict",
    "CriticalAmplitudes",
    "Design",
    "Designs",
    "FreeDesign",
    "Front",
    "InSteadyState",
    "Interval",
    "Keywords",
    "Limit",
    "LimitState",
    "LocalMinimum",
    "Minimum",
    "ModulusProfile",
    "ObjectiveCurve",
    "OptimalExponent",
    "Question",
    "Scenarios",
    "Sensitivities",
    "UnderOtherLoad",
    "WearHorizon",
    "WeightedLoad",
    "along",
    "compared",
    "conflict",
    "critical_amplitudes",
    "design",
    "designs",
    "free_design",
    "front",
    "in_steady_state",
    "minimise",
    "optimal_exponent",
    "sensitivities",
    "tail_weights",
    "under_other_load",
]
