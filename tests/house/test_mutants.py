"""The program of `make test-mutants`: which errors it plants."""

import ast

import pytest
from inputs import ROOT
from processes import module_at

from plgwear_jax._core.units import text_cells

SOURCE = b'''
_STEP = 0.5

def outer(x, y):
    """Not 2.0 * 3.0."""
    def inner(z: float = -1.0) -> float:
        if (z + 1) < y:
            raise ValueError(f"{z * 2.0}" + "no")
        return jnp.where(z > 0.0, (x - 2.0) * z, 1.0)
    return 0.0 * x + inner(x / _STEP)
'''

PLANTED = [
    *text_cells("""
    : factor                 0.5                         0.525
    outer.inner: sign        z + 1                       (z - 1)
    outer.inner: term        z + 1                       (z)
    outer.inner: term        z + 1                       (1)
    outer.inner: comparison  (z + 1) < y                 ((z + 1) > y)
    outer.inner: comparison  z > 0.0                     (z < 0.0)
    outer.inner: sign        x - 2.0                     (x + 2.0)
    outer.inner: term        x - 2.0                     (x)
    outer.inner: term        x - 2.0                     (-(2.0))
    outer.inner: factor      2.0                         2.1
    outer.inner: quotient    (x - 2.0) * z               ((x - 2.0) / z)
    outer.inner: factor      (x - 2.0) * z               (1.05 * ((x - 2.0) * z))
    outer: sign              0.0 * x + inner(x / _STEP)  (0.0 * x - inner(x / _STEP))
    outer: term              0.0 * x + inner(x / _STEP)  (0.0 * x)
    outer: term              0.0 * x + inner(x / _STEP)  (inner(x / _STEP))
""")
]


@pytest.fixture(scope="module")
def mutants():
    return module_at(ROOT / "tools" / "mutants.py")


def test_errors_are_planted_in_arithmetic_alone(mutants):
    found = mutants.errors_in("room/file.py", SOURCE)
    told = {(f"{e.function.replace('.<locals>', '')}: {e.kind}", e.old, e.new) for e in found}
    assert told == {*map(tuple, PLANTED)} and len(found) == len(told)
    for error in found:
        ast.parse(mutants.planted(error, SOURCE))
    with pytest.raises(ValueError, match=r"file\.py has changed"):
        mutants.planted(found[0], b"\n" + SOURCE)


def test_the_draw_depends_on_the_seed_alone(mutants):
    errors = mutants.all_errors()
    assert {mutants.room_of(error.path) for error in errors} == set(mutants.ROOMS)
    first, other = (mutants.drawn(errors, seed)[:20] for seed in (1, 2))
    assert mutants.drawn(errors[::-1], 1)[:20] == first != other
