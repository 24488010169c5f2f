"""No question leaves a tracer behind: JAX looks for traced values that outlive their trace.

What is remembered of the last question must not be of a trace that has ended. Nothing is compiled in the default run,
since tracing is what leaks.
"""

import dataclasses
import functools
import gc

import batches
import jax
import jax.numpy as jnp
import numpy as np
from kinds import KINDS
from marks import compiled, parametrize
from rigid_shapes import Blend

from plgwear_jax import optimise
from plgwear_jax.loads import Displacement

OWN = KINDS | {"a shape of one's own": dataclasses.replace(KINDS["a shape"], shape=Blend(flat=2e-5))}
FORCES = np.array([1.0, batches.F_X])


def transformed(ask, contact):
    """Functions with arguments."""

    def closed(force):
        return ask(contact, force)

    def within(load, force):
        """The question in a program within a program, of a contact of the outer one."""
        loaded = dataclasses.replace(contact, normal_force=load)
        return jax.jit(lambda force: ask(loaded, force))(force) + ask(loaded, force)

    return {
        "jit": (jax.jit(ask), (contact, batches.F_X)),
        "a contact from outside": (jax.jit(closed), (batches.F_X,)),
        "grad": (jax.grad(closed), (batches.F_X,)),
        "vmap": (jax.vmap(closed), (FORCES,)),
        "jit in vmap": (jax.vmap(lambda force: jax.jit(closed)(force)), (FORCES,)),
        "jit in jit": (jax.jit(within), (10.0, batches.F_X)),
        "jit in vmap in jit": (jax.jit(jax.vmap(within, (None, 0))), (10.0, FORCES)),
        "grad in jit": (jax.jit(jax.grad(within, 1)), (10.0, batches.F_X)),
    }


def nothing_leaks(question, kind, run=False, ways=None):
    found = transformed(functools.partial(batches.QUESTIONS[question], digits=None), OWN[kind])
    for function, given in (found[way] for way in ways or found):
        gc.freeze()  # JAX looks for garbage at the end of every trace, which need not be that of the suite
        with jax.checking_leaks():
            value = function(*given) if run else jax.eval_shape(function, *given)
        assert not run or np.all(np.isfinite(value))


@parametrize("kind", ["closed forms", "layers under steel"])
def test_no_steady_question_leaks(kind):
    nothing_leaks("steady", kind, ways=("jit", "a contact from outside", "vmap", "jit in jit"))


@parametrize(
    "ask",
    [
        lambda contact: contact.steady(2.0).wear_volume,
        lambda contact: contact.steady(Displacement(1e-7)).wear_volume,
        lambda contact: contact.over_cycles(jnp.asarray(2.0), 1e-14).volume(1e5),
        lambda contact: contact.over_cycles(Displacement(1e-7), 1e-14).steady.wear_volume,
    ],
)
def test_arrays_of_jax_may_be_known_while_it_traces(ask):
    """What is asked of them there is traced, and cannot decide anything."""
    contact = jax.tree.map(jnp.asarray, KINDS["layers under steel"])
    assert jax.eval_shape(lambda x: x * ask(contact), 1.0).shape == ()


@compiled
@parametrize("kind", OWN)
@parametrize("question", batches.QUESTIONS)
def test_no_question_leaks(question, kind):
    nothing_leaks(question, kind)


@compiled
@parametrize("kind", ["closed forms", "a power law under steel", "a shape"])
def test_no_question_that_runs_leaks(kind):
    nothing_leaks("steady", kind, run=True)


def best_exponents(phi):
    return optimise.optimal_exponent(phi, (-0.9, 0.9)).k


def best_materials(force):
    return optimise.designs(KINDS["closed forms"], force, {"k": (-0.5, 0.5)}).variables["k"]


@compiled
@parametrize("best", [best_exponents, best_materials])
def test_no_design_leaks(best):
    for function in (best, jax.vmap(best), lambda x: jax.vmap(lambda x: jax.jit(best)(x))(x)):
        gc.freeze()
        with jax.checking_leaks():
            jax.eval_shape(function, jnp.array([0.4, 0.5]))


@compiled
def test_no_derivative_of_a_design_leaks():
    with jax.checking_leaks():
        jax.eval_shape(jax.grad(best_exponents), 0.5)
