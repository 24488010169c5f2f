"""Programs that NumPy runs step by step: the numbers of XLA, and XLA itself for all else."""

import pickle

import jax
import jax.numpy as jnp
import numpy as np
from kinds import KINDS
from marks import parametrize
from numpy.testing import assert_allclose, assert_array_equal

from plgwear_jax._core.startup import programs
from plgwear_jax._core.startup.stepwise import SteppedProgram, stepwise
from plgwear_jax.special import cholesky
from plgwear_jax.steady.state import solved_states
from plgwear_jax.surfaces.effort import effort_of

ODD = np.array([0.0, -0.0, 1.0, -2.5, 3.5, 0.3, 1e300, -1e300, 7e18, np.inf, -np.inf, np.nan])
PLAIN = np.linspace(0.1, 0.9, 7)


def bits(x):
    return jax.lax.bitcast_convert_type(x, jnp.int64)


def shaped(x, y):
    return (
        (x[:, None] + jnp.arange(3.0), jnp.stack([x, y], -1).T, jnp.append(x, y[2:5]), jnp.flip(x), jnp.squeeze(x[:1])),
        (jax.lax.slice(x.reshape(3, -1), (1, 0), (3, 4), (1, 2)), jax.lax.split(x.reshape(2, 6), (1, 2, 3), axis=1)),
        jax.lax.reshape(x.reshape(3, 4), (2, 6), (1, 0)),  # as in the derivatives of `jnp.prod`
    )


# What the formulas are made of, at all odd numbers, alone or in pairs.
EXACT = {
    "arithmetic": lambda x, y: (x + y, x - y, x * y, x / y, -x, abs(x), x**2, x**-1, jnp.sqrt(x)),
    "order": lambda x, y: (jnp.maximum(x, y), jnp.minimum(x, y), x < y, x <= y, x > y, x >= y, x == y, x != y),
    "logic": lambda x, y: ((x < y) & ~(y > 0), (x < y) | (y > 0), jnp.where(x < y, x, y), jnp.isfinite(x)),
    "integers": lambda x, y: (
        (jnp.round(x).astype(jnp.int32), x.astype(jnp.int64) + 3, bits(x) >> 52),
        (jax.lax.shift_left(bits(x), jnp.int64(3)), jax.lax.bitcast_convert_type(bits(x) - 1, jnp.float64)),
    ),
    "dtypes": lambda x, y: (x.astype(jnp.float32) * 3, (x < y).astype(jnp.float64), x.astype(jnp.float32) + y),
    "shapes": shaped,
    "sums": lambda x, y: (x.sum(), jnp.max(x), jnp.min(y), jnp.max(x.reshape(3, 4), 0), x @ y),
}


def looped(x, y):
    """Loops, branches, and batches of both."""

    def doubled(x):
        return jax.lax.while_loop(lambda x: x < 3.0, lambda x: 2.0 * x, x)

    def added(x, y):
        return jax.lax.scan(lambda total, each: (total + each * x, total), x, y, reverse=True)

    def branched(x):
        return jax.lax.switch((4.0 * x).astype(int), [jnp.sin, jnp.cos, jnp.exp], x)

    one = doubled(x[0]), added(x[0], y), branched(x[1]), jax.lax.platform_dependent(x, cpu=jnp.exp, default=jnp.sin)
    return one, jax.vmap(doubled)(x), jax.vmap(added, (0, None))(x, y), jax.vmap(branched)(x)


def indexed(x, y):
    """Numbers taken from arrays, and put into them."""
    at, table = jnp.array([2, 0, 7, -1]), jnp.outer(x, y)

    def of_each_row(row, at):
        return row[at], row[:, at], row.at[at].set(0.0), row.at[:, at].add(y[0])

    moved = jnp.round(3.0 * x[:3]).astype(int)
    return (
        (x[at], table[at], table[:, moved], table[moved, moved], x.at[moved].get(mode="fill")),
        (x.at[:2].set(y[:2]), table.at[1].set(y), table.at[2, -1].set(0.0), x.at[moved].set(y[:3], mode="clip")),
        (x.at[0].add(y[1]), table.at[:, 1].add(y), x.at[jnp.array([1, 1])].add(y[:2])),
        jax.vmap(lambda row: (row[moved], jax.lax.dynamic_slice(row, (moved[0],), (2,))))(table),
        jax.vmap(of_each_row)(jnp.stack([table, 2.0 * table, table]), moved),
        jax.vmap(jax.vmap(lambda row, at: row[at]), (1, 0))(
            jnp.stack([table[:3], table[2:5]], 1), jnp.stack([moved, 1 - moved])
        ),
        jax.lax.dynamic_slice(table, (moved[0], moved[1]), (2, 6)),
        jax.lax.pad(table, 0.5, ((1, 3, 2), (0, 1, 0))),
    )


def accumulated(x, y):
    """Sums up to each number, and what is in order."""
    sums = jnp.cumsum(jnp.outer(x, y), 0), jnp.cumprod(y), jax.lax.cumsum(x, reverse=True), jax.lax.cummax(y)
    found = [function(jnp.outer(x, y), 1) for function in (jnp.argmax, jnp.argmin, jnp.sort)]
    places = jnp.searchsorted(jnp.sort(x), y, side="right", method="compare_all"), jnp.tile(x, 2)
    return sums, found, places, jnp.any(x > 0.4), jnp.all(x > 0.4), jnp.clip(x, 0.2, 0.6)


def special(x, y):
    """Functions beyond those of arithmetic."""
    names = jnp.sin, jnp.cos, jnp.tanh, jnp.exp2, jax.lax.rsqrt, jax.lax.lgamma, jax.lax.digamma
    return [function(x) for function in names]


def powers(x, y):
    return jnp.exp(x), jnp.log(x), jnp.expm1(x), jnp.log1p(x), x**1.7


def solved_for(x, y):
    """Systems of equations, of a matrix and of a batch with one that has no factor."""
    matrix = jnp.diag(x) + 0.1 * jnp.outer(y, y)
    many, right = jnp.stack([matrix, -matrix]), jnp.stack([x, y], -1)
    products = jnp.einsum("ij,kj->ik", right, many[0, :, :2]), jnp.einsum("bij,bj->bi", many, right.T)
    solved = (
        cholesky.solve_symmetric(matrix, right),
        jax.vmap(cholesky.cholesky)(many),
        jax.vmap(cholesky.forward)(many, many),
    )
    return products, solved


EPS = np.finfo(float).eps
CASES = {name: (function, ODD, EPS, 0.0) for name, function in EXACT.items()}
CASES |= {each.__name__: (each, PLAIN, 9 * EPS, 1e-15) for each in (looped, indexed, accumulated, special, solved_for)}
CASES["powers"] = powers, np.geomspace(1e-3, 30.0, 40), 4 * EPS, 0.0


def steps_of(function, *at):
    return stepwise(jax.jit(function).trace(*at))


@parametrize("function, at, relative, absolute", CASES.values(), ids=CASES)
def test_every_operation_is_that_of_xla(function, at, relative, absolute):
    x, y = at, np.roll(at, 5)
    steps = steps_of(function, x, y)
    assert steps is not None
    with jax.default_device(jax.devices("cpu")[0]):
        mine, theirs = steps(x, y), jax.jit(function)(x, y)
    assert jax.tree.structure(mine) == jax.tree.structure(theirs)
    for one, other in zip(jax.tree.leaves(mine), jax.tree.leaves(theirs), strict=True):
        assert isinstance(one, jax.Array) and (one.dtype, one.shape) == (other.dtype, other.shape)
        floats = np.issubdtype(one.dtype, np.floating)
        error = max(relative, np.finfo(one.dtype).eps) if floats else 0.0
        assert_allclose(one, other, rtol=error, atol=absolute * floats)


@parametrize("kind", [kind for kind in KINDS if kind != "closed forms"])
def test_states_are_solved_in_steps(kind):
    given = KINDS[kind], 1.0
    assert stepwise(solved_states.jitted.trace(effort_of(None), *given))(*given).volume > 0.0


def test_what_nobody_needs_is_no_step_and_arguments_take_the_dtype_of_the_program():
    def function(x):
        jnp.exp(x)
        return x / 3 + 1.0

    steps = steps_of(function, np.float32(0.5))
    assert steps is not None and [step[0] for step in steps._block.steps] == ["div", "add"]
    assert steps(2.0).dtype == jnp.float32


@parametrize("shape, other", [((300, 40), (40, 700)), ((3, 90, 90), (3, 90, 90)), ((600, 600), (600,))])
def test_no_product_is_large_enough_for_the_threads_of_openblas(shape, other, monkeypatch, seed):
    random = np.random.default_rng(seed)
    x, y = random.normal(size=shape), random.normal(size=other)
    steps, counts, plain = steps_of(lambda x, y: x @ y, x, y), [], np.matmul
    assert steps is not None

    def counted(x, y, out):
        counts.append(x.shape[-2] * x.shape[-1] * y.shape[-1])
        return plain(x, y, out=out)

    monkeypatch.setattr(np, "matmul", counted)
    assert_allclose(steps(x, y), plain(x, y), rtol=0.0, atol=1e-12)
    assert max(counts) < 2**18 and sum(counts) == plain(x, y).size * shape[-1] / (shape[0] if len(shape) > 2 else 1)


REST = {
    "quotient of integers": lambda x: x.astype(int) // 3,
    "large": lambda x: jnp.outer(jnp.ones(3_000_000), x).sum(1)[:2],
    "long": lambda x: jax.lax.scan(lambda sum, _: (sum + x, None), x, length=10_000)[0],
    "a loop that does not end soon": lambda x: jax.lax.while_loop(lambda n: n < 1000.0, lambda n: n + 1.0, 0.0 * x[0]),
    "places beyond an array": lambda x: x.at[jnp.array([1, 9])].get(mode="fill"),
    "cut off": lambda x: jax.lax.pad(x, 0.0, ((-1, 0, 0),)),
    "rounded away from zero": jax.lax.round,
}


@parametrize("function", REST.values(), ids=REST)
def test_xla_has_the_rest(function):
    x, asked = np.array([0.5, 1.5, 2.5]), programs.program()(function)
    assert_array_equal(asked(x), jax.jit(function)(x))
    assert not isinstance(asked.by((), (x,)), SteppedProgram)


@programs.program(static=1)
def scaled(name, of, by):
    return jnp.sqrt(of[name]) * by


def test_steps_are_kept_and_taken_over(tmp_path, monkeypatch):
    given = ("x", {"x": np.linspace(0.0, 1.0, 5), "y": 2.0}, 3.0)
    plain = scaled(*given)
    for place in (None, tmp_path / "kept", tmp_path / "kept"):
        programs.keep_in(place, 2**20)
        if place is None or place.exists():
            monkeypatch.setattr(scaled, "jitted", None)  # nothing is traced
        assert np.array_equal(scaled(*given), plain)
        monkeypatch.undo()
    assert len(list((tmp_path / "kept").iterdir())) == 1


def test_a_table_that_a_program_has_twice_is_kept_once():
    table = np.random.default_rng(0).normal(size=1000)
    steps = steps_of(lambda x: jax.jit(lambda x: x * table)(x) + jax.jit(lambda x: x - table.copy())(x), 0.5)
    assert len(pickle.dumps(steps)) < 1.5 * table.nbytes


def test_what_is_asked_very_often_is_compiled():
    of = {"x": np.linspace(0.0, 1.0, 7)}
    steps = scaled.by(("x",), (of, 2.0))
    assert isinstance(steps, SteppedProgram)
    made = []
    while steps.worthwhile:
        made.append(scaled("x", of, 2.0))
    assert 100 <= len(made) <= 1000 and not isinstance(scaled.by(("x",), (of, 2.0)), SteppedProgram)
    assert all(np.array_equal(one, made[0]) for one in [scaled("x", of, 2.0), *made])
