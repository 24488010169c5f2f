"""Derivatives at single known numbers, which NumPy computes: they are those of the compiled programs."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from dependence import GOOD
from functions import FUNCTIONS, arguments
from kinds import contact_of, dome
from marks import compiled, long_case, parametrize
from numpy.testing import assert_allclose

from plgwear_jax import Layered, fretting
from plgwear_jax._core.startup import programs

EPS = np.finfo(np.float64).eps


@pytest.fixture
def ran(monkeypatch):
    """Of each derivative at known numbers whether NumPy was to compute it."""
    found = []
    plain = programs.Program.by

    def by(itself, static, numbers):
        made = plain(itself, static, numbers)
        found.append(isinstance(made, programs.SteppedProgram))
        return made

    monkeypatch.setattr(programs.Program, "by", by)
    return found


@parametrize(
    "name",
    [name if name in ("fretting.stick_radius", "fretting.wear_volume") else long_case(name) for name in FUNCTIONS],
)
def test_they_are_those_of_the_compiled_program(name, ran):
    at, every = tuple(GOOD[key] for key in arguments(name)), tuple(range(len(arguments(name))))
    ask = jax.value_and_grad(FUNCTIONS[name], every)
    value, slopes = ask(*at)
    assert ran == [True]
    expected, compiled = jax.jit(ask)(*at)
    assert ran == [True]
    assert_allclose(value, expected, rtol=64 * EPS)
    assert_allclose(slopes, compiled, rtol=512 * EPS)
    for one, other in zip((value, *slopes), (expected, *compiled), strict=True):
        assert (one.dtype, one.shape, one.weak_type) == (other.dtype, other.shape, other.weak_type)


def test_shapes_and_dtypes_are_those_of_the_arguments(ran):
    def ask(k, phi):
        return fretting.stick_radius(k, phi).sum()

    for k, phi in (
        (jnp.array([0.3]), jnp.array([[0.4]])),
        (jnp.float32(0.3), 0.4),
        (jnp.float16(0.3), jnp.float32(0.4)),
        (jnp.array([0.3], jnp.float16), np.float64(0.4)),
    ):
        ran.clear()
        slopes = jax.grad(ask, (0, 1))(k, phi)
        assert ran == [True]
        assert [(x.shape, x.dtype) for x in slopes] == [(jnp.shape(x), jnp.asarray(x).dtype) for x in (k, phi)]
        compiled = jax.jit(jax.grad(ask, (0, 1)))(k, phi)
        precise = jnp.finfo(ask(k, phi).dtype).eps  # of what is computed, whatever the dtype of a slope
        for slope, other in zip(slopes, compiled, strict=True):
            assert_allclose(slope, other, rtol=8 * precise)


def test_forward_mode_and_higher_derivatives(ran):
    def value(k):
        return fretting.stick_radius(k, 0.4)

    slope, second = jax.grad(value)(0.3), jax.grad(jax.grad(value))(0.3)
    assert jax.jvp(value, (0.3,), (2.0,))[1] == 2.0 * slope
    assert jax.jacfwd(value)(0.3) == slope
    curvature = jax.hessian(fretting.stick_radius, (0, 1))
    found = curvature(0.3, 0.4)
    assert ran == 5 * [True]
    assert_allclose(found, jax.jit(curvature)(0.3, 0.4), rtol=64 * EPS)
    assert_allclose(found[0][0], second, rtol=64 * EPS)
    assert_allclose(jax.vmap(jax.grad(value))(jnp.array([0.3])), [slope], rtol=64 * EPS)


def test_some_numbers_are_each_differentiated(ran):
    k, phi = jnp.array([0.3, 0.4, 0.5]), jnp.array([[0.2], [0.7]])
    slopes = jax.grad(lambda *at: fretting.wear_volume(*at).sum(), (0, 1))(k, phi)
    assert ran == [True]
    alone = jax.grad(fretting.wear_volume, (0, 1))
    each = np.array([[alone(x, y) for x in (0.3, 0.4, 0.5)] for y in (0.2, 0.7)])
    assert_allclose(slopes[0], each[..., 0].sum(0), rtol=64 * EPS)
    assert_allclose(slopes[1], each[..., 1].sum(1, keepdims=True), rtol=64 * EPS)


def test_outside_they_are_nan():
    value, slopes = jax.value_and_grad(fretting.stick_radius, (0, 1))(1.3, 0.4)
    assert np.isnan([value, *slopes]).all()


def test_many_numbers_and_those_on_a_device_of_their_own_are_left_to_xla(ran):
    def total(k):
        return fretting.stick_radius(k, 0.4).sum()

    jax.grad(total)(jnp.linspace(0.3, 0.4, 200))
    assert ran == []
    slope = jax.grad(total)(jax.device_put(0.3, jax.devices()[0]))
    assert ran == [] and slope.committed
    assert_allclose(slope, jax.grad(total)(0.3), rtol=64 * EPS)


def test_who_asks_often_gets_a_compiled_program(ran, monkeypatch):
    ask = jax.grad(fretting.stick_radius, 1)
    first = ask(0.3, 0.4, digits=5)
    monkeypatch.setattr(programs.SteppedProgram, "worthwhile", False)
    again = ask(0.3, 0.4, digits=5)
    assert ran == [True, False]
    assert_allclose(first, again, rtol=64 * EPS)


@compiled
def test_a_run_is_solved_once_for_all_that_is_read_with_slopes(monkeypatch):
    solved = []
    plain = programs.Program.__call__

    def call(itself, *given):
        if itself.name.endswith("ring_curves.curves_by_parts"):
            solved.append(given)
        return plain(itself, *given)

    def read(friction, cycles):
        run = dataclasses.replace(dome(0.2), friction=friction).over_cycles(1.0, 1e-14)
        return 1e16 * run.volume(cycles) + 1e4 * run.contact_radius(cycles) + run.cycles_to(0.4) / cycles

    monkeypatch.setattr(programs.Program, "__call__", call)
    by_friction = jax.grad(read)(0.4, 2e5)
    assert len(solved) == 1
    slopes = jax.grad(read, (0, 1))(0.4, 2e5)
    assert len(solved) == 3  # with and without the cycles among the numbers that move
    monkeypatch.undo()
    assert_allclose(by_friction, slopes[0], rtol=1e-12)
    assert_allclose(slopes, jax.jit(jax.grad(read, (0, 1)))(0.4, 2e5), rtol=1e-10)


def test_over_cycles_they_can_be_left_to_jax(monkeypatch):
    """The parts that follow each other for known numbers are not reversed."""
    monkeypatch.setenv("PLGWEAR_STARTUP", "")
    contact = contact_of(Layered([2e-6], [400e9, 110e9], 0.3))
    slope = jax.grad(lambda force: contact.over_cycles(force, 1e-14, digits=2).volume(1e5))
    assert jax.eval_shape(slope, 1.0).shape == ()
