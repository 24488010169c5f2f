"""Questions about designs that make no sense are refused in a line, before anything is searched."""

import re

import numpy as np
from coated import HOLD, PUNCH, RIGID, on
from kinds import contact_of
from marks import parametrize
from refusals import cases, refusal

from plgwear_jax import Layered, optimise
from plgwear_jax.loads import Block, Displacement

NAMED = {
    "NONE": None,
    "PUNCH": PUNCH,
    "GRADED": on(RIGID, k=0.3),
    "LAYERS": contact_of(Layered([5e-6, 5e-6], [220e9, 55e9, 110e9], 0.3)),
    "GROSS": Displacement(1e-5),
    "BLOCKS": [Block(1.0, 3e5)],
}
DESIGN = {"contact": RIGID, "load": 1.0, "vary": {"k": (-0.9, 0.9)}, "hold": HOLD}
# What is asked where a case gives nothing else.
ASKED = {
    "design": DESIGN,
    "front": DESIGN,
    "optimal_exponent": {"phi": 0.5},
    "minimise": {"objective": lambda v: v["x"]},
}


def given(case):
    found = {name: NAMED.get(x, x) if isinstance(x, str) else x for name, x in case["given"].items()}
    for name in {"tangential_force", "weight"} & found.keys():
        found[name] = np.array(found[name])
    return found


def refused(ask, case, asked):
    assert re.search(case["line"], refusal((TypeError, ValueError), ask, **asked | given(case)))


@cases("optimise/refused.toml", "asked")
def test_what_makes_no_sense_is_refused(case):
    def ask(space=None, **asked):
        if space is not None:
            boxed = isinstance(space, dict)
            asked["space"] = {name: optimise.Interval(*bounds) for name, bounds in space.items()} if boxed else space
        return getattr(optimise, case["ask"])(**asked)

    refused(ask, case, ASKED.get(case["ask"], {}))


@cases("optimise/refused.toml", "arguments")
@parametrize("more", [{}, {"distance": 1e-6}], ids=["designs", "a front"])
def test_what_an_argument_takes_is_said(more, case):
    for ask in (optimise.front,) if more else (optimise.design, optimise.designs):
        refused(ask, case, DESIGN | {"hold": None, "load": 2.0} | more)
