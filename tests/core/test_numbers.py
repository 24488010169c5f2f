"""What is for numbers alone refuses traced values in one line; everything else that is public can be traced."""

import dataclasses
import importlib
import inspect

import jax
import numpy as np
import pytest
from kinds import LAW, contact_of
from marks import parametrize

from plgwear_jax._core.units import text_cells
from plgwear_jax.contact import slip_regimes
from plgwear_jax.optimise import ModulusProfile, designs

CONTACT = contact_of(LAW)
FORCE, COEFFICIENT = 1.5, 1e-13

# What these of all public functions take may be traced, or is no number: paths, pictures, Python's own.
OTHERS = {
    room: {*names}
    for room, *names in text_cells("""
    coating   felt  worn
    contact   is_closed
    fitting   log_likelihood
    optimise  critical_amplitudes  designs  minimise  optimal_exponent  tail_weights
    plots     check_target  readable  save  use_style
    sweep     open_sweep
    """)
}


def functions(room):
    module = importlib.import_module(f"plgwear_jax.{room}")
    return {name: getattr(module, name) for name in module.__all__ if inspect.isfunction(getattr(module, name))}


def line_of(function, at=1.0, how=jax.jit):
    with pytest.raises(TypeError) as error:
        how(function)(at)
    line = str(error.value)
    assert type(error.value) is TypeError and "\n" not in line and "numbers alone" in line
    return line


@parametrize("room", OTHERS)
def test_every_public_function_is_for_numbers_or_can_be_traced(room):
    """It says so in its description, and in a line with its name and what works instead."""
    for name, function in functions(room).items():
        alone, parameters = name not in OTHERS[room], inspect.signature(function).parameters.values()
        assert ("It takes numbers, not traced values" in (inspect.getdoc(function) or "")) == alone, name
        needed = [p for p in parameters if p.default is p.empty and p.kind != p.VAR_KEYWORD]

        def asked(x, function=function, needed=needed):
            by_place = [x for p in needed if p.kind != p.KEYWORD_ONLY]
            function(*by_place, **{p.name: x for p in needed if p.kind == p.KEYWORD_ONLY})
            return x

        for how in (jax.jit, jax.grad) if alone else ():
            said, instead = line_of(asked, how=how).split(": ", 1)
            assert said == f"{name} is for numbers alone, not under jit, grad or vmap" and instead
            assert line_of(asked, np.ones(2), jax.vmap)


QUESTIONS = {
    "the contact": lambda x: slip_regimes(dataclasses.replace(CONTACT, normal_force=10.0 * x), [1e-7], [10.0]),
    "in a list": lambda x: slip_regimes(CONTACT, [1e-7, 1e-6 * x], [10.0]),
    "by its name": lambda x: slip_regimes(CONTACT, [1e-7], [10.0], rig_stiffness=1e7 * x),
    "bounds": lambda x: designs(CONTACT, FORCE, {"k": (-0.5, 0.5 * x)}),
    "a profile": lambda x: ModulusProfile((1e-6, 1e-5, 1e-4), (6e10 * x,) * 3, (4e11,) * 3),
}


@parametrize("question", QUESTIONS)
def test_traced_values_anywhere_are_refused(question):
    def asked(x):
        QUESTIONS[question](x)
        return x

    assert len({line_of(asked), line_of(asked, how=jax.grad), line_of(asked, np.ones(2), jax.vmap)}) == 1


def test_numbers_are_refused_while_jax_traces_and_taken_where_they_stay_numbers():
    def asked(x):
        return x * slip_regimes(CONTACT, [1e-7], [10.0]).energy_per_cycle[0, 0]

    assert "numbers alone" in line_of(asked)
    known = asked(1.0)
    assert np.all(jax.vmap(asked)(np.ones(2)) == known) and jax.grad(asked)(1.0) == known
