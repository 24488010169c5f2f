"""What is for numbers alone refuses traced values in one line; everything else that is public can be traced."""

import dataclasses
import importlib
import inspect

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from marks import parametrize

from plgwear_jax import FrettingContact, GrossSlipContact, PowerLawGraded
from plgwear_jax.contact import slip_regimes
from plgwear_jax.fitting import fit_wear_coefficient
from plgwear_jax.optimise import ModulusProfile, design, designs

LAW = PowerLawGraded(E0=110e9, z0=1e-4, k=0.2, nu=0.3)
CONTACT = FrettingContact(LAW, radius=5e-3, normal_force=10.0, friction=0.4)
FORCE, COEFFICIENT = 1.5, 1e-13

# Public functions by room.
REFUSING = {
    "coating": {"fit_power_law", "idealised", "studied", "where_it_counts"},
    "contact": {"slip_regimes"},
    "fitting": {"fit_wear_coefficient"},
    "optimise": {
        "along",
        "compared",
        "conflict",
        "design",
        "in_steady_state",
        "free_design",
        "front",
        "under_other_load",
    }
    | {"sensitivities"},
    "plots": {"blocks_picture", "coating_picture", "design_picture", "fit_picture", "free_picture", "front_picture"}
    | {"regimes_picture", "stress_picture", "wear_picture"},
    "sweep": {"sweep"},
}
# What these take may be traced, or is no number: paths, pictures, Python's own.
OTHERS = {
    "coating": {"felt", "worn"},
    "fitting": {"log_likelihood"},
    "contact": {"is_closed"},
    "optimise": {"critical_amplitudes", "designs", "minimise", "optimal_exponent", "tail_weights"},
    "plots": {"check_target", "readable", "save", "use_style"},
    "sweep": {"open_sweep"},
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


@parametrize("room", REFUSING)
def test_every_public_function_is_for_numbers_or_can_be_traced(room):
    found = functions(room)
    assert set(found) == REFUSING[room] | OTHERS.get(room, set())
    for name in REFUSING[room]:
        doc = inspect.getdoc(found[name]) or ""
        assert "It takes numbers, not traced values" in doc, name


@parametrize("room, name", [(room, name) for room, names in REFUSING.items() for name in sorted(names)])
def test_it_says_so_in_a_line_with_its_name_and_what_works(room, name):
    function = functions(room)[name]
    parameters = inspect.signature(function).parameters.values()
    needed = [p for p in parameters if p.default is p.empty and p.kind != p.VAR_KEYWORD]

    def asked(x):
        by_place = [x for p in needed if p.kind != p.KEYWORD_ONLY]
        function(*by_place, **{p.name: x for p in needed if p.kind == p.KEYWORD_ONLY})
        return x

    for how in (jax.jit, jax.grad):
        said, instead = line_of(asked, how=how).split(": ", 1)
        assert said == f"{name} is for numbers alone, not under jit, grad or vmap" and instead
    assert line_of(asked, np.ones(2), jax.vmap)


def with_load(x):
    return dataclasses.replace(CONTACT, normal_force=10.0 * x)


def of_a_batch(x):
    return dataclasses.replace(CONTACT, material=dataclasses.replace(LAW, k=0.2 * x))


QUESTIONS = {
    "the contact": lambda x: slip_regimes(with_load(x), [1e-7], [10.0]),
    "the material": lambda x: slip_regimes(of_a_batch(x), [1e-7], [10.0]),
    "in a list": lambda x: slip_regimes(CONTACT, [1e-7, 1e-6 * x], [10.0]),
    "by its name": lambda x: slip_regimes(CONTACT, [1e-7], [10.0], rig_stiffness=1e7 * x),
    "a fit": lambda x: fit_wear_coefficient(CONTACT, FORCE, [1e4, 1e5], jnp.array([1e-17, 2e-17]) * x),
    "a design": lambda x: design(with_load(x), FORCE, {"k": (-0.5, 0.5)}),
    "gross slip": lambda x: design(GrossSlipContact(LAW, 2e-3, 1e-6 * x), None, {"k": (-0.5, 0.5)}),
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
