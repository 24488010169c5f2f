"""Batches of contacts under `jit(vmap(value_and_grad))`: they return, with little memory, and LAPACK gets no batch.

LAPACK divides a batch of matrices among the threads that run the program itself, and both may wait for each other for
ever: a question of chance, so what is lowered is looked at as well as run.
"""

import json
import re
import sys

import batches
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from kinds import KINDS
from marks import compiled, compiled_case, long_case, parametrize
from numpy.testing import assert_allclose, assert_array_equal
from processes import output

from plgwear_jax._core.sequential import sequential_forward_mode, sequential_vmap
from plgwear_jax.optimise.conditions import solved_by_elimination
from plgwear_jax.special import cholesky

COUNT, ROUNDS = 100, 12

QUICK = [("layers under steel", "steady"), ("a power law under steel", "over_cycles")]
ALL = [
    (compiled_case if (kind, question) in QUICK else long_case)(kind, question)
    for kind in KINDS
    for question in batches.QUESTIONS
]


@parametrize("kind, question", ALL)
def test_a_batch_returns_again_and_again(kind, question):
    digits = 4 if question in ("steady", "unworn") else 2
    told = json.loads(output(batches.__file__, kind, question, digits, COUNT, ROUNDS).splitlines()[-1])
    assert told["program in GB"] < 1.4
    assert told["away"] < (1e-4 if digits == 4 else 2e-2)


def calls_of_lapack(lowered):
    """The shapes of the arrays of each call."""
    lines = [line for line in lowered.splitlines() if re.search(r"@(lapack|blas)_", line)]
    return [re.findall(r"tensor<((?:\d+x)*)f(?:32|64)>", line) for line in lines]


@parametrize(
    "kind, question",
    [
        ("layers under steel", "unworn"),
        compiled_case("a power law under steel", "fields"),
        compiled_case("a table under steel", "over_cycles"),
        compiled_case("a shape", "held"),
        compiled_case("closed forms", "held"),
    ],
)
@pytest.mark.skipif(jax.default_backend() != "cpu", reason="others have no LAPACK")
def test_no_batch_of_matrices_reaches_lapack(kind, question):
    calls = calls_of_lapack(batches.program(question, 2).lower(*batches.scattered(kind, 3)).as_text())
    assert calls and all(shape.count("x") <= 2 for call in calls for shape in call)
    batch = calls_of_lapack(jax.jit(jnp.linalg.cholesky).lower(np.ones((3, 4, 4))).as_text())
    assert any(shape.count("x") > 2 for call in batch for shape in call)  # which would be seen


# --- what makes it so ---------------------------------------------------------------------------------------------


def systems(seed):
    random = np.random.default_rng(seed)
    half = random.normal(size=(5, 6, 6))
    return jnp.asarray(half @ half.swapaxes(1, 2) + np.eye(6)), jnp.asarray(random.normal(size=(5, 6, 3)))


def ours(matrix, right):
    factor = cholesky.cholesky(matrix)
    found = cholesky.backward(factor, cholesky.forward(factor, right))
    vector = cholesky.forward(factor, right[:, 0])
    return jnp.sum(found**3) + jnp.sum(cholesky.solve_symmetric(matrix, right) ** 2) + jnp.sum(factor**2 @ vector)


def plain(matrix, right):
    factor, found = jnp.linalg.cholesky(matrix), jnp.linalg.solve(matrix, right)
    return jnp.sum(found**3) + jnp.sum(found**2) + jnp.sum(factor**2 @ jnp.linalg.solve(factor, right[:, 0]))


@parametrize(
    "transform",
    [
        lambda f: jax.value_and_grad(f, (0, 1)),
        compiled_case(lambda f: jax.jacfwd(jax.grad(f), 1)),
        compiled_case(lambda f: jax.jacrev(jax.jacrev(f))),
        compiled_case(lambda f: jax.jacfwd(jax.jacfwd(f))),
    ],
)
def test_factors_and_their_derivatives_are_those_of_jax(transform, seed):
    def symmetric(function):
        return lambda matrix, right: function(0.5 * (matrix + matrix.T), right)

    matrix, right = systems(seed)
    one_by_one = jax.jit(transform(symmetric(plain)))
    expected = [one_by_one(*system) for system in zip(matrix, right, strict=True)]
    expected = jax.tree.map(lambda *parts: np.stack(parts), *expected)
    found = jax.jit(jax.vmap(transform(symmetric(ours))))(matrix, right)
    crossed = jax.jit(jax.vmap(jax.vmap(transform(symmetric(ours)), (None, 0)), (0, None)))(matrix, right)
    for one, other, both in zip(*map(jax.tree.leaves, (found, expected, crossed)), strict=True):
        scale = np.max(abs(other))
        assert_allclose(one, other, rtol=0.0, atol=1e-11 * scale)
        assert_allclose(both[np.arange(5), np.arange(5)], other, rtol=0.0, atol=1e-11 * scale)


@parametrize("twice", [jax.hessian, lambda f: jax.jacrev(jax.jacrev(f))])
def test_systems_in_a_loop_have_second_derivatives(twice, seed):
    matrix, right = systems(seed)

    def total(x):
        return jnp.sum(jax.lax.map(lambda one: cholesky.solve_symmetric(x * matrix[0], one), right))

    assert_allclose(jax.jit(twice(total))(1.0), 2.0 * total(1.0), rtol=1e-12)  # it is as 1/x


# --- threads of OpenBLAS ------------------------------------------------------------------------------------------


@parametrize("rows, columns", [(28, 1176), (84, 20), (130, 40)])
def test_lapack_gets_no_more_than_openblas_does_in_one_thread(rows, columns, seed):
    random = np.random.default_rng(seed)
    half, right = random.normal(size=(rows, rows)), random.normal(size=(rows, columns))
    matrix = half @ half.T + rows * np.eye(rows)

    def function(matrix, right):
        factor = cholesky.cholesky(matrix)
        return factor, cholesky.backward(factor, cholesky.forward(factor, right))

    lowered = jax.jit(function).lower(matrix, right)
    for call in calls_of_lapack(lowered.as_text()):
        sizes = [[int(size) for size in shape.split("x")[:-1]] for shape in call]
        assert sizes[0][0] < 100  # of a matrix
        assert len(call) < 3 or sizes[1][0] * sizes[1][1] < 1024  # of right sides
    factor, found = lowered.compile()(matrix, right)
    assert_allclose(factor, np.linalg.cholesky(matrix), rtol=0.0, atol=1e-12)
    assert_allclose(found, np.linalg.solve(matrix, right), rtol=0.0, atol=1e-13)


IDLE = """
import os

def tasks():
    return set(os.listdir("/proc/self/task"))

before = tasks()
import numpy, scipy.linalg
threads = tasks() - before
assert threads

def taken():
    lines = [open(f"/proc/self/task/{task}/stat").read().rpartition(")")[2].split() for task in threads]
    return sum(int(line[11]) + int(line[12]) for line in lines) / os.sysconf("SC_CLK_TCK")

import jax
jax.config.update("jax_enable_x64", True)
from kinds import KINDS
for i in range(5):  # the first one inverts two matrices of constants, the last ones are compiled programs
    jax.block_until_ready(jax.grad(lambda contact: contact.over_cycles(1.5, 1e-14).volume(1e4))(KINDS["a table"]))
    begin = taken() if i == 0 else begin
print(taken() - begin)
"""


@compiled
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux tells what its threads have done")
def test_the_threads_of_openblas_stay_idle():
    assert float(output("-c", IDLE, OPENBLAS_NUM_THREADS="4")) < 0.1  # s of the processor


def test_a_matrix_that_is_not_positive_gives_nan():
    assert np.all(np.isnan(jax.jit(cholesky.solve_symmetric)(-np.eye(3), np.ones((3, 1)))))
    jax.vmap(lambda one: cholesky.forward(jnp.eye(3), one))(jnp.ones((0, 3, 2)))  # nothing is solved, and no error


@parametrize("mapped", [sequential_vmap, sequential_forward_mode])
@parametrize("count", [compiled_case(0), compiled_case(1), 4])
def test_one_after_the_other_is_what_vmap_gives(mapped, count):
    def function(numbers, table):
        return {"sum": jnp.sum(table) * numbers["a"], "each": jnp.sin(table * numbers["b"])}

    numbers = {"a": jnp.linspace(0.5, 2.0, count), "b": jnp.asarray(0.7)}
    table = jnp.arange(3.0 * count).reshape(count, 3)
    axes = {"a": 0, "b": None}, 0

    def total(function):
        found = jax.vmap(function, axes)
        return lambda numbers, table: (
            jnp.sum(found(numbers, table)["each"] ** 2) + jnp.sum(found(numbers, table)["sum"])
        )

    of, plainly = mapped(function), function
    jax.tree.map(assert_array_equal, jax.vmap(of, axes)(numbers, table), jax.vmap(plainly, axes)(numbers, table))
    for transform in (jax.grad, jax.hessian):
        found, expected = (jax.jit(transform(total(f), (0, 1)))(numbers, table) for f in (of, plainly))
        jax.tree.map(lambda a, b: assert_allclose(a, b, rtol=1e-12, atol=1e-12), found, expected)


def test_derivatives_are_by_what_moves_alone():
    def slopes(number):
        return jax.jacfwd(lambda x: sequential_forward_mode(lambda a, b: jnp.sin(a) * b)(x, jnp.ones(50)))(number)

    assert jax.eval_shape(slopes, 1.0).shape == (50,) and "50,50" not in str(jax.make_jaxpr(slopes)(1.0))


@parametrize("n", [1, 2, compiled_case(3), compiled_case(5)])
def test_elimination_solves_small_systems(n, seed):
    random = np.random.default_rng(seed)
    matrix, right = random.normal(size=(40, n, n)), random.normal(size=(40, n))
    matrix[:, 0, 0] = 0.0 if n > 1 else 1.0  # a pivot has to be sought
    expected = np.linalg.solve(matrix, right[..., None])[..., 0]
    traced = jax.jit(solved_by_elimination)
    for found in (solved_by_elimination(matrix, right), traced(matrix, right)):
        assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * np.max(abs(expected)))
    by_right = jax.grad(lambda right: jnp.sum(traced(matrix[0], right)))(right[0])
    assert_allclose(by_right, np.linalg.solve(matrix[0].T, np.ones(n)), rtol=1e-9, atol=1e-9)
    # The derivatives of minima solve for tangents, and reverse mode transposes that.
    transposed = jax.linear_transpose(lambda right: traced(matrix[0], right), right[0])
    assert_allclose(transposed(jnp.ones(n))[0], by_right, rtol=1e-12)


@parametrize("solved", [solved_by_elimination, jax.jit(solved_by_elimination)], ids=["NumPy", "JAX"])
def test_a_singular_system_is_not_finite(solved):
    found = np.asarray(solved(np.stack([np.ones((3, 3)), np.eye(3)]), np.ones((2, 3))))
    assert not np.any(np.isfinite(found[0])) and np.all(found[1] == 1.0)
