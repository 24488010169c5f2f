"""A few random design problems against SciPy's searches on SciPy's formulas; `benchmarks/designs.py` takes hundreds."""

import sys

from inputs import ROOT
from marks import compiled, long_case, parametrize
from numpy.testing import assert_allclose

sys.path.append(str(ROOT / "benchmarks"))

import random_designs
import scipy_designs
from random_designs import Program

SEED = 6
PROGRAMS = {
    "gross slip": Program("k, gross slip", "volume_change", "gross slip", 0),
    "k at a held radius, pressure limited": Program("k, radius held", "wear_volume", limits=("edge_pressure",)),
    "E0, pressure limited": Program("E0", "wear_volume", "worst", 7, ("edge_pressure",)),
    "k at a held radius": long_case(Program("k, radius held", "wear_volume", "mean", 5)),
    "k and E0": Program("k and E0", "worn_radius", limits=("edge_pressure",)),
    # SciPy takes its time.
    "modulus": long_case(Program("k and z0", "wear_volume", limits=("penetration", "modulus"))),
}


@compiled
@parametrize("program", PROGRAMS.values(), ids=PROGRAMS.keys())
def test_no_search_by_scipy_finds_a_better_design(program):
    for number in range(4):
        problem = random_designs.draw(program, SEED, number)
        best = random_designs.design(problem)
        mine, theirs = random_designs.valued(problem, best), scipy_designs.best(problem, starts=2)
        assert_allclose(best.value, mine.value, rtol=1e-11)
        assert mine.violation <= 1e-9
        assert theirs.feasible
        assert mine.value <= theirs.value * (1 + 1e-9)
        assert best.converged
        assert best.certified
