"""No question leaves a tracer behind: JAX looks for traced values that outlive their trace.

What is remembered of the last question must not be of a trace that has ended. Nothing is compiled in the default run,
since tracing is what leaks.
"""

import dataclasses
import gc
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from kinds import COEFFICIENT, KINDS
from rigid_shapes import Blend

from plgwear_jax import FrettingContact, optimise
from plgwear_jax.loads import Displacement, Force

OWN = KINDS | {"a shape of one's own": dataclasses.replace(KINDS["a shape"], shape=Blend(flat=2e-5))}
F_X = 1.5
FORCES = np.array([1.0, F_X])

Asked = Callable[[FrettingContact, Any], Any]


def steady(contact: FrettingContact, force: Any) -> Any:
    """Several quantities one after the other, which share what is remembered."""
    steady = contact.steady(force)
    told = steady.wear_volume, contact.steady(force).worn_radius, contact.steady(0.0).contact_radius
    return sum(told) + steady.edge_pressure(1e-6)


def unworn(contact: FrettingContact, force: Any) -> Any:
    steady = contact.steady(force)
    return steady.displacement_amplitude + steady.slip_amplitude(0.0) + steady.energy_per_cycle + steady.deepest_wear


def over_cycles(contact: FrettingContact, force: Any) -> Any:
    return contact.over_cycles(force, COEFFICIENT).volume(1e4) + contact.steady(force).wear_volume


def shares(contact: FrettingContact, force: Any) -> Any:
    return contact.over_cycles(force, COEFFICIENT).cycles_to(0.5)


def held(contact: FrettingContact, force: Any) -> Any:
    moved = contact.steady(Force(force, 3e7)).displacement_amplitude
    return contact.over_cycles(Displacement(moved, 3e7), COEFFICIENT).volume(1e4)


def within(ask: Asked, contact: FrettingContact) -> Callable[[Any, Any], Any]:
    """The question in a program within a program, of a contact of the outer one."""

    def outer(load: Any, force: Any) -> Any:
        loaded = dataclasses.replace(contact, normal_force=load)
        return jax.jit(lambda force: ask(loaded, force))(force) + ask(loaded, force)

    return outer


def transformed(ask: Asked, contact: FrettingContact) -> dict[str, tuple[Callable[..., Any], tuple[Any, ...]]]:
    """Functions with arguments."""

    def closed(force: Any) -> Any:
        return ask(contact, force)

    return {
        "jit": (jax.jit(ask), (contact, F_X)),
        "a contact from outside": (jax.jit(closed), (F_X,)),
        "grad": (jax.grad(closed), (F_X,)),
        "vmap": (jax.vmap(closed), (FORCES,)),
        "jit in vmap": (jax.vmap(lambda force: jax.jit(closed)(force)), (FORCES,)),
        "jit in jit": (jax.jit(within(ask, contact)), (10.0, F_X)),
        "jit in vmap in jit": (jax.jit(jax.vmap(within(ask, contact), (None, 0))), (10.0, FORCES)),
        "grad in jit": (jax.jit(jax.grad(lambda force, load: within(ask, contact)(load, force))), (F_X, 10.0)),
    }


def nothing_leaks(ask: Asked, kind: str, run: bool = False, ways: tuple[str, ...] | None = None) -> None:
    found = transformed(ask, OWN[kind])
    for function, given in (found[way] for way in ways or found):
        gc.freeze()  # JAX looks for garbage at the end of every trace, which need not be that of the suite
        with jax.checking_leaks():
            value = function(*given) if run else jax.eval_shape(function, *given)
        assert not run or np.all(np.isfinite(value))


@pytest.mark.parametrize("kind", ["closed forms", "layers under steel"])
def test_no_steady_question_leaks(kind):
    nothing_leaks(steady, kind, ways=("jit", "a contact from outside", "vmap", "jit in jit"))


@pytest.mark.compiled
@pytest.mark.parametrize("kind", OWN)
@pytest.mark.parametrize("ask", [steady, unworn, over_cycles, shares, held], ids=lambda ask: ask.__name__)
def test_no_question_leaks(ask, kind):
    nothing_leaks(ask, kind)


@pytest.mark.compiled
@pytest.mark.parametrize("kind", ["closed forms", "a power law under steel", "a shape"])
def test_no_question_that_runs_leaks(kind):
    nothing_leaks(steady, kind, run=True)


def best_exponents(phi: Any) -> Any:
    return optimise.optimal_exponent(phi, (-0.9, 0.9)).k


def best_materials(force: Any) -> Any:
    return optimise.designs(KINDS["closed forms"], force, {"k": (-0.5, 0.5)}).variables["k"]


@pytest.mark.compiled
@pytest.mark.parametrize("best", [best_exponents, best_materials])
def test_no_design_leaks(best):
    for function in (best, jax.vmap(best), lambda x: jax.vmap(lambda x: jax.jit(best)(x))(x)):
        gc.freeze()
        with jax.checking_leaks():
            jax.eval_shape(function, jnp.array([0.4, 0.5]))
    with jax.checking_leaks():
        jax.eval_shape(jax.grad(best), 0.5)
