"""What every public function promises to JAX: broadcasting, dtypes, jit, vmap, derivatives of both modes, `digits`.

Functions and the names of their arguments are read from the modules, so a new public function is tested as well.
EPS is the rounding unit of float64. Compilation is what these tests pay for: shapes are few, and what is compiled is
kept for all tests of a function.
"""

import dataclasses
import functools
import json
import os

import functions
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from dependence import GOOD, PLACES, build
from functions import COMPILED, FUNCTIONS, arguments, by_one_rule, of_each_kind
from marks import compiled, compiled_case, long, long_case, parametrize
from numpy.testing import assert_allclose, assert_array_equal
from processes import output
from refusals import data

from plgwear_jax import FrettingContact, GrossSlipContact, fretting, gross_slip, optimise
from plgwear_jax._core.catalogue import laws_of, read
from plgwear_jax._core.leaves import leaf_of, paths_of, with_leaf

EPS = np.finfo(np.float64).eps
EPS32 = float(np.finfo(np.float32).eps)

each_function = parametrize("name", FUNCTIONS)


BULK = 40


@functools.cache
def bulk(name, dtype=np.float64):
    """Points inside the domain, away from its edges and from those of the contact."""
    rng = np.random.default_rng(20240229)
    at = {
        "k": rng.uniform(-0.97, 0.97, BULK),
        "phi": rng.uniform(0.005, 0.995, BULK),
        "nu": rng.uniform(-0.9, 0.49, BULK),
        "compliance": rng.uniform(0.01, 5.0, BULK),
        "displacement": rng.uniform(0.005, 0.995, BULK),
    }
    if "distance" in arguments(name):
        at["distance"] = rng.uniform(0.02, 1.5, BULK) * functions.fretting.stick_radius(at["k"], at["phi"])
    if "r" in arguments(name):
        c = a = np.ones(BULK)
        if "phi" in arguments(name):
            c, a = (
                radius(at["k"], at["phi"])
                for radius in (functions.fretting.stick_radius, functions.fretting.worn_radius)
            )
        # A third under the contact, a third in the ring (or just beside), a third beyond.
        part, where = rng.uniform(0.02, 0.98, BULK), np.arange(BULK) % 3
        ring = np.where(a > c, c + part * (a - c), 1.0 + part)
        at["r"] = np.choose(where, [part * c, ring, a * (1.0 + 4.0 * part)])
    return tuple(np.asarray(at[key], dtype) for key in arguments(name))


# --- broadcasting and dtypes ----------------------------------------------------------------------------------------


@each_function
def test_scalars_give_zero_dimensional_arrays(name):
    at = [GOOD[key] for key in arguments(name)]
    for values in (at, [np.asarray(x) for x in at], [jnp.asarray(x) for x in at]):
        result = FUNCTIONS[name](*values)
        assert isinstance(result, jax.Array) and result.shape == () and result.dtype == jnp.float64
    assert FUNCTIONS[name](**dict(zip(arguments(name), at, strict=True))) == result


@of_each_kind
def test_arguments_broadcast_as_in_numpy(name):
    names = arguments(name)
    column, row = np.array([[-0.4], [0.0], [0.4]]), np.array([0.1, 0.2, 0.4, 0.45])
    values = [np.abs(v) if key != "k" else v for key, v in zip(names, [column, row, 0.3], strict=False)]
    expected = np.broadcast_arrays(*values)
    result = FUNCTIONS[name](*values)
    assert result.shape == expected[0].shape
    # Another vectorisation of the same operations: a few ulp, and what the wear depth loses towards a_inf.
    one_by_one = [FUNCTIONS[name](*point) for point in zip(*(x.ravel() for x in expected), strict=True)]
    assert_allclose(np.ravel(result), one_by_one, rtol=64 * EPS, atol=4 * EPS)


@parametrize("name", [name for name in FUNCTIONS if len(arguments(name)) > 1])
def test_shapes_that_do_not_broadcast_are_refused(name):
    values = [np.full(2 + i, GOOD[key]) for i, key in enumerate(arguments(name))]
    with pytest.raises((TypeError, ValueError), match=r"shape|broadcast"):
        FUNCTIONS[name](*values)


@by_one_rule
def test_dtype_of_the_result(name):
    function, at = FUNCTIONS[name], [GOOD[key] for key in arguments(name)]
    for dtype in (jnp.float16, jnp.bfloat16, jnp.float32, jnp.float64):
        arrays = [jnp.asarray(np.full(functions.LENGTH, x, dtype)) for x in at]
        assert jax.eval_shape(function, *arrays).dtype == dtype
        if name in COMPILED:
            assert function(*arrays).dtype == dtype
        # A Python number takes the type of its partners, as everywhere in JAX.
        first = jax.ShapeDtypeStruct((), dtype)
        for rest in (at[1:], [0 for _ in at[1:]]):
            assert jax.eval_shape(lambda first, rest=rest: function(first, *rest), first).dtype == dtype
    for zero in (0, np.int32(0), np.zeros(functions.LENGTH, np.int64)):
        assert function(*(zero for _ in at)).dtype == jnp.float64
    if len(at) > 1:
        assert function(np.float32(at[0]), *(np.float64(x) for x in at[1:])).dtype == jnp.float64


@by_one_rule
def test_single_and_half_precision_follow_double(name):
    fine = bulk(name, np.float32)
    expected = functions.values(name, *(x.astype(np.float64) for x in fine))
    result = functions.values(name, *fine)
    assert result.dtype == np.float32
    # Conditioning in r, k and phi of the bulk stays below some hundreds; the wear depth vanishes at the ring's edges.
    assert_allclose(result, expected, rtol=300 * EPS32, atol=2 * EPS32)
    # Half precision is single, rounded: at the very same points in float16.
    half = [x.astype(np.float16) for x in fine]
    inside = np.all(
        [x < 1.0 for key, x in zip(arguments(name), half, strict=True) if key not in ("r", "compliance")], axis=0
    )
    half = [np.where(inside, x, np.float16(0.25)) for x in half]
    single = functions.values(name, *(x.astype(np.float32) for x in half))
    assert_array_equal(functions.values(name, *half), single.astype(np.float16))


DEFAULT_SINGLE = """
import json, jax
before = dict(jax.config.values)
import plgwear_jax
changed = [key for key, value in jax.config.values.items() if key in before and before[key] != value]
import jax.numpy as jnp, numpy as np
from plgwear_jax import fretting, gross_slip, material, optimise
functions = [getattr(m, n) for m in (gross_slip, fretting) for n in m.__all__]
dtypes = set()
at = {"r": 0.7, "distance": 0.1, "k": 0.3, "phi": 0.4}
import inspect
for f in functions:
    names = [n for n in inspect.signature(f).parameters if n != "digits"]
    dtypes.add(str(jax.eval_shape(f, *(at[n] for n in names)).dtype))
dtypes.add(str(fretting.wear_volume(0, 0).dtype))
dtypes.add(str(fretting.wear_volume(np.float64(0.3), np.array(0.4)).dtype))
dtypes.add(str(jax.grad(fretting.wear_volume)(0.3, 0.4).dtype))
dtypes.add(str(material.h_N(0.3, 0.3).dtype))
contact = plgwear_jax.FrettingContact(plgwear_jax.PowerLawGraded(110e9, 1e-4, 0.3, 0.3), 5e-3, 10.0, 0.4)
dtypes.add(str(contact.steady(2.0).wear_volume.dtype))
refused = False
try:
    fretting.wear_volume(0.3, 0.4, digits=7)
except ValueError:
    refused = True
half = str(fretting.wear_volume(jnp.float16(0.3), 0.4).dtype)
volume, radius = float(fretting.wear_volume(0.3, 0.4)), float(contact.steady(0.0).contact_radius)
print(json.dumps(dict(changed=changed, dtypes=list(dtypes), refused=refused, half=half, volume=volume, radius=radius)))
"""


def test_without_64_bits_everything_is_single_and_importing_changes_no_setting():
    strict = "-W", "error", "-W", os.environ["PYTHONWARNINGS"]
    seen = json.loads(output(*strict, "-c", DEFAULT_SINGLE, without=("JAX_ENABLE_X64",)))
    assert seen["changed"] == []
    assert seen["dtypes"] == ["float32"] and seen["half"] == "float16"
    assert seen["refused"]  # float32 holds 6 digits
    assert_allclose(seen["volume"], fretting.wear_volume(0.3, 0.4), rtol=32 * EPS32)
    # the exponential of a logarithm of about 10
    assert_allclose(seen["radius"], build(FrettingContact).steady(0.0).contact_radius, rtol=64 * EPS32)


# --- jit, vmap and derivatives --------------------------------------------------------------------------------------


POINTS = data("core/points.toml")


def special_points(name):
    """Every edge and limit that the library names, each with ordinary values of the other arguments."""
    lists = POINTS["special"]
    names = arguments(name)
    at = [x.ravel() for x in np.meshgrid(*(lists[key] for key in names))]
    if names[0] in ("r", "distance") and "phi" in names:
        k, phi = (x.ravel() for x in np.meshgrid(lists["k"], lists["phi"]))
        for radius in (functions.fretting.stick_radius, functions.fretting.worn_radius):
            edge = radius(k, phi)
            beside = [edge, np.nextafter(edge, 0.0), np.nextafter(edge, 9e9)]
            at = [np.append(x, y) for x, y in zip(at, (beside, np.tile(k, 3), np.tile(phi, 3)), strict=True)]
    return at


@functools.cache
def evaluated(name):
    """(Arguments, value, beside a gradient, reverse, forward), the special points first, then the bulk."""
    at = tuple(np.concatenate(both) for both in zip(special_points(name), bulk(name), strict=True))
    return at, *functions.derivatives(name, *at)


@functools.cache
def hessians(name):
    """At the same points."""
    return functions.hessians(name, *evaluated(name)[0])


def in_bulk(name):
    """What is evaluated, of the bulk alone."""
    at, *results = evaluated(name)
    return tuple(x[-BULK:] for x in at), *(x[-BULK:] for x in results)


def told(at, bad):
    """Some of the points at which something went wrong."""
    return np.stack(at, -1)[bad][:5]


# The second derivatives of all others take seconds to compile; those of `wear_volume` go through all that they are made
# of.
TWICE = {f"gross_slip.{name}" for name in ("initial_pressure", "steady_pressure", "volume_change", "force_ratio")}
TWICE |= {f"fretting.{name}" for name in ("wear_volume", "stick_radius", "edge_intensity", "initial_pressure")}
TWICE |= {"gross_slip.force_drop", "material.holl_ratio"}
COMPILED_TWICE = ("fretting.penetration", "partial_slip.displacement_amplitude")
slow_twice = parametrize(
    "name",
    [
        name if name in TWICE else compiled_case(name) if name in COMPILED_TWICE else long_case(name)
        for name in FUNCTIONS
    ],
)


def test_second_derivative_of_the_worn_punch_is_finite_at_its_edge():
    k = jnp.array([-0.999, -0.5, 0.0, 0.5, 0.999])
    slope = jax.grad(gross_slip.steady_displacement)
    found = functions.by_numpy(jax.vmap(jax.value_and_grad(slope)))(jnp.ones(5), k)
    assert np.all(np.isfinite(found))


def test_second_derivatives_keep_their_digits_near_the_centre():
    second = jax.grad(jax.grad(gross_slip.initial_pressure, 1), 1)
    assert np.isclose(second(1e-6, 0.0), -5e-13, 1e-9, 0.0)


@each_function
def test_values_at_the_edges_are_numbers(name):
    at, value, beside_gradient, *_ = evaluated(name)
    for found in (value, beside_gradient):
        assert not np.any(np.isnan(found)), told(at, np.isnan(found))


def are_finite(at, value, slopes):
    """Wherever the value is."""
    bad = np.isfinite(value) & ~np.isfinite(slopes).reshape(*value.shape, -1).all(-1)
    assert not np.any(bad), told(at, bad)


@each_function
def test_gradients_are_finite_wherever_the_value_is(name):
    at, value, _, reverse, forward = evaluated(name)
    for gradient in (reverse, forward):
        are_finite(at, value, gradient)


@slow_twice
def test_second_derivatives_are_finite_wherever_the_value_is(name):
    at, value, *_ = evaluated(name)
    are_finite(at, value, hessians(name))


@each_function
def test_forward_and_reverse_mode_agree(name):
    *_, reverse, forward = in_bulk(name)
    # The same partial derivatives, multiplied by ones in another order.
    assert_allclose(forward, reverse, rtol=16 * EPS, atol=16 * EPS * np.max(np.abs(reverse)))


@slow_twice
def test_the_hessian_is_symmetric(name):
    hessian = hessians(name)[-BULK:]
    # Mixed derivatives are taken along two ways, each with the rounding of a second derivative: 1e4 EPS.
    scale = np.max(np.abs(hessian), axis=(-1, -2), keepdims=True)
    assert np.all(np.abs(hessian - np.swapaxes(hessian, -1, -2)) <= 1e4 * EPS * scale)


def differences(name, which):
    """Central differences at the bulk, by each argument, of the value (0) or of the gradient (1)."""
    at, *_ = in_bulk(name)
    for i in range(len(at)):
        # The step keeps the point on its side of every edge.
        step = 2e-5 * np.minimum(
            np.abs(at[i]), 1.0 - np.abs(at[i]) if arguments(name)[i] in ("k", "phi", "displacement") else np.inf
        )
        step = np.maximum(step, 1e-9)
        shifted = []
        for sign in (1.0, -1.0):
            moved = [x + sign * step if j == i else x for j, x in enumerate(at)]
            value, _, gradient, _ = functions.derivatives(name, *moved)
            shifted.append((value, gradient)[which])
        yield (shifted[0] - shifted[1]) / (2.0 * step).reshape((-1,) + (1,) * which)


@each_function
def test_derivatives_are_those_of_the_value(name):
    """Central differences of values; h^2 of them costs 1e-8, rounding over h another 1e-9."""
    *_, gradient, _ = in_bulk(name)
    for i, by_value in enumerate(differences(name, 0)):
        scale = 1e-6 * (np.abs(gradient[:, i]) + np.max(np.abs(gradient), axis=-1)) + 1e-9
        # A point may be a step away from an edge, where the curvature jumps: 9 of 10 have to agree.
        assert np.mean(np.abs(by_value - gradient[:, i]) <= scale) >= 0.9


@slow_twice
def test_second_derivatives_are_those_of_the_gradient(name):
    hessian = hessians(name)[-BULK:]
    for i, by_gradient in enumerate(differences(name, 1)):
        scale = 1e-5 * np.max(np.abs(hessian), axis=(-1, -2))[:, None] + 1e-7
        assert np.mean(np.abs(by_gradient - hessian[:, i]) <= scale) >= 0.9


@each_function
def test_jit_and_vmap_equal_the_plain_call(name):
    # Fused with other work XLA may contract products: a few ulp, not bit for bit; the wear depth cancels towards a_inf.
    at, value, beside_gradient, *_ = in_bulk(name)
    plain = functions.values(name, *at)
    assert_allclose(value, plain, rtol=64 * EPS, atol=4 * EPS)
    assert_allclose(beside_gradient, plain, rtol=64 * EPS, atol=4 * EPS)
    loop = [FUNCTIONS[name](*point) for point in zip(*(map(float, x[:6]) for x in at), strict=True)]
    assert_allclose(plain[:6], loop, rtol=64 * EPS, atol=4 * EPS)


def single_points(name):
    """In float32, at edges and limits."""
    return [np.float32(x.ravel()) for x in np.meshgrid(*(POINTS["single"][key] for key in arguments(name)))]


CHEAP_IN_SINGLE = ("fretting.stick_radius", "gross_slip.volume_change")
# The accuracy of these in single precision is measured at the edges, by the same program.
MEASURED_IN_SINGLE = ("fretting.wear_volume", "fretting.worn_radius", "fretting.steady_pressure")


def long_but_for(names):
    return parametrize("name", [name if name in names else long_case(name) for name in FUNCTIONS])


@long_but_for(CHEAP_IN_SINGLE + MEASURED_IN_SINGLE)
def test_gradients_are_finite_in_single_precision(name):
    at = single_points(name)
    value, beside_gradient, reverse, forward = functions.derivatives(name, *at)
    assert value.dtype == beside_gradient.dtype == reverse.dtype == forward.dtype == np.float32
    for gradient in (reverse, forward):
        are_finite(at, value, gradient)


@long_but_for(CHEAP_IN_SINGLE)
def test_second_derivatives_are_finite_in_single_precision(name):
    at = single_points(name)
    value, hessian = functions.values(name, *at), functions.hessians(name, *at)
    assert value.dtype == hessian.dtype == np.float32
    are_finite(at, value, hessian)


# --- digits ---------------------------------------------------------------------------------------------------------


@each_function
def test_wrong_numbers_of_digits_are_refused(name):
    at = [GOOD[key] for key in arguments(name)]
    for wrong in (0, -1, 16, 2.5, "a", True):
        with pytest.raises((ValueError, TypeError), match="digits"):
            FUNCTIONS[name](*at, digits=wrong)
    with pytest.raises((ValueError, TypeError), match="digits"):  # float32 holds 6
        FUNCTIONS[name](*map(np.float32, at), digits=7)


def test_digits_are_static_under_jit():
    coarse = jax.jit(fretting.worn_radius, static_argnames="digits")(0.3, 0.4, digits=3)
    assert coarse == fretting.worn_radius(0.3, 0.4, digits=3) != fretting.worn_radius(0.3, 0.4)
    with pytest.raises((TypeError, ValueError), match="digits"):  # a traced number is no number of digits
        jax.jit(fretting.worn_radius)(0.3, 0.4, digits=3)


# --- contacts -------------------------------------------------------------------------------------------------------


FORCE = 2.0


def all_results(contact, names=None):
    """All that the steady state answers (or some), with a radius in the middle of it and a middling force."""
    known = laws_of(contact)
    return {name: read(contact, name, FORCE, PLACES) for name in names or known if not name.startswith("transient.")}


SOME = ("contact_radius", "stick_radius", "initial_displacement")  # of the contact, its slip, and a radius in it


@parametrize(
    "cls, nu, names",
    [(FrettingContact, 0.3, SOME), compiled_case(GrossSlipContact, "holl", None)],
    ids=["fretting", "gross slip"],
)
def test_contacts_are_arguments_batched_by_vmap_and_by_array_fields(cls, nu, names):
    scale, contact = np.array([1.0, 1.1, 0.9]), build(cls, k=np.array([-0.6, 0.0, 0.45]), nu=nu)
    material = dataclasses.replace(contact.material, E0=110e9 * scale)
    contact = dataclasses.replace(contact, radius=contact.radius * scale, material=material)
    by_fields = all_results(contact, names)
    batch = jax.tree.map(lambda x: np.broadcast_to(x, (3,)), contact)
    by_vmap = jax.jit(jax.vmap(functools.partial(all_results, names=names)))(batch)
    single = [all_results(jax.tree.map(lambda x, i=i: x[i], batch), names) for i in range(3)]
    for name, value in by_vmap.items():
        # the constants are arguments instead of numbers: the exponential of a logarithm of some tens
        one_by_one = np.array([one[name] for one in single])
        assert_allclose(value, one_by_one, rtol=256 * EPS, err_msg=name)
        assert_allclose(np.broadcast_to(by_fields[name], (3,)), one_by_one, rtol=256 * EPS, err_msg=name)


@compiled
def test_a_gradient_with_respect_to_a_contact_is_a_contact():
    """Where Poisson's ratio is Holl's it follows k."""
    contact = build(GrossSlipContact, nu="holl")
    slope = jax.grad(lambda contact: contact.steady().steady_force)(contact)
    assert jax.tree.structure(slope) == jax.tree.structure(contact)
    for path, x in paths_of(contact).items():
        up, down = (with_leaf(contact, path, x * (1.0 + side)).steady().steady_force for side in (1e-5, -1e-5))
        # Central differences: h^2 and EPS/h, both 1e-10 times a few tens.
        assert_allclose(x * leaf_of(slope, path), (up - down) / 2e-5, rtol=1e-7, err_msg=path)


# --- the optimal exponent -------------------------------------------------------------------------------------------

# On the lower bound, four between, on the upper bound; then what is outside: phi, and both bounds.
PHI = np.array([0.05, 0.1, 0.2, 0.3, 0.36, 0.97, 1.0, 0.5, 0.5])
LOWER, UPPER = np.append(np.full(7, -0.95), [0.5, -0.95]), np.append(np.full(7, 0.95), [-0.5, np.nan])


@jax.jit
def designs(phi):
    """k and the wear volume of optima, and the slopes of both by phi and the bounds."""

    def numbers(*at):
        found = optimise.optimal_exponent(at[0], at[1:])
        return jnp.stack([found.k, found.wear_volume])

    value, back = jax.vjp(numbers, phi, LOWER, UPPER)
    return value, *(jnp.stack(back(jnp.zeros_like(value).at[row].set(1.0))) for row in range(2))


@long
def test_the_optimum_is_differentiable():
    (value, of_k, of_volume), h = map(np.asarray, designs(PHI)), 1e-4 * (np.arange(9) < 6)
    assert np.all(np.isnan([*value, *of_k[:1], *of_volume[:1]])[:, 6:])
    by_k, by_volume = (designs(PHI + h)[0] - designs(PHI - h)[0])[:, :6] / 2e-4
    # h^2 times third derivatives of some tens, and k to 1e-9 over h: 1e-5 both.
    assert_allclose(of_k[0, 1:5], by_k[1:5], rtol=1e-4)
    assert_allclose(of_volume[0, :6], by_volume, rtol=1e-4)
    # On a bound k follows that bound and nothing else, and so does the volume; elsewhere it knows of none but rounding.
    assert_array_equal(of_k[0, [0, 5]], 0.0)
    assert_allclose(of_k[1:, :6], np.stack([np.arange(6) == 0, np.arange(6) == 5]), rtol=0, atol=64 * EPS)
    assert_allclose(of_volume[2, 5], jax.grad(fretting.wear_volume)(0.95, 0.97), rtol=1e-12)
    single = optimise.optimal_exponent(np.float32(PHI[:6]))
    assert single.k.dtype == single.wear_volume.dtype == jnp.float32
    assert_allclose(single.k, value[0, :6], atol=2e-3)  # eps^(5/8) = 5e-5 of slope; the volume is flat
