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
from functions import COMPILED, FUNCTIONS, arguments, by_one_rule, of_each_kind
from marks import compiled, long, parametrize
from numpy.testing import assert_allclose, assert_array_equal
from processes import output

from plgwear_jax import FrettingContact, GrossSlipContact, PowerLawGraded, fretting, gross_slip, optimise
from plgwear_jax._core.catalogue import QUANTITIES
from plgwear_jax._core.leaves import leaf_of, paths_of, with_leaf

EPS = float(np.finfo(np.float64).eps)
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


def scalar(name):
    return {"r": 0.7, "distance": 0.1, "k": 0.3, "phi": 0.4, "nu": 0.25, "compliance": 0.5, "displacement": 0.4}[name]


# --- broadcasting and dtypes ----------------------------------------------------------------------------------------


@each_function
def test_scalars_give_zero_dimensional_arrays(name):
    at = [scalar(key) for key in arguments(name)]
    for values in (at, [np.asarray(x) for x in at], [jnp.asarray(x) for x in at]):
        result = FUNCTIONS[name](*values)
        assert isinstance(result, jax.Array) and result.shape == () and result.dtype == jnp.float64
    assert float(FUNCTIONS[name](**dict(zip(arguments(name), at, strict=True)))) == float(result)


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
    values = [np.full(2 + i, scalar(key)) for i, key in enumerate(arguments(name))]
    with pytest.raises((TypeError, ValueError), match=r"shape|broadcast"):
        FUNCTIONS[name](*values)


@by_one_rule
def test_dtype_of_the_result(name):
    function, at = FUNCTIONS[name], [scalar(key) for key in arguments(name)]
    for dtype in (jnp.float16, jnp.bfloat16, jnp.float32, jnp.float64):
        arrays = [jnp.asarray(np.full(functions.LENGTH, x, dtype)) for x in at]
        assert jax.eval_shape(function, *arrays).dtype == dtype
        if name in COMPILED:
            assert function(*arrays).dtype == dtype
        # A Python number takes the type of its partners, as everywhere in JAX.
        first = jax.ShapeDtypeStruct((), dtype)
        assert jax.eval_shape(lambda first: function(first, *at[1:]), first).dtype == dtype
        assert jax.eval_shape(lambda first: function(first, *(0 for _ in at[1:])), first).dtype == dtype
    assert function(*(0 for _ in at)).dtype == jnp.float64
    assert function(*(np.int32(0) for _ in at)).dtype == jnp.float64
    assert function(*(np.zeros(functions.LENGTH, np.int64) for _ in at)).dtype == jnp.float64
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
    assert_allclose(seen["radius"], reference_contact().steady(0.0).contact_radius, rtol=64 * EPS32)


# --- jit, vmap and derivatives --------------------------------------------------------------------------------------


def special_points(name):
    """Every edge and limit that the library names, each with ordinary values of the other arguments."""
    K = [-1.0 + 1e-12, -0.999, -0.5, -1e-300, 0.0, 1e-9, 0.5, 0.999, 1.0 - 1e-12]
    PHI = [0.0, 1e-300, 1e-16, 1e-8, 0.25, 0.5, 0.9, 1.0 - 1e-12]
    NU = [-1.0 + 1e-12, -0.5, 0.0, 0.3, 0.5]
    R = [0.0, 1e-300, 1e-8, 0.5, 1.0, 2.0**0.5, 2.0, 1e8, 1e16, 1e100, 1e154, 1e300]
    DISTANCE = [0.0, 1e-90, 1e-12, 0.01, 0.5, 1.0, 2.0, 1e300]
    SOFT = [0.0, 1e-300, 1e-8, 1.0, 1e12]
    near = [np.nextafter(1.0, 0.0), np.nextafter(1.0, 2.0)]
    names, labels = arguments(name), []
    place = names[0]
    if place in ("r", "distance") and "phi" in names:
        k, phi = (x.ravel() for x in np.meshgrid(K, PHI))
        c, a = functions.fretting.stick_radius(k, phi), functions.fretting.worn_radius(k, phi)
        radii = {f"{place} = {r:g}": np.full_like(k, r) for r in (R + near if place == "r" else DISTANCE)}
        for label, edge in (("c", c), ("a_inf", a)):
            radii |= {
                f"{place} = {label}": edge,
                f"{place} = {label} -": np.nextafter(edge, 0.0),
                f"{place} = {label} +": np.nextafter(edge, 9e9),
            }
        labels = np.repeat(list(radii), k.size)
        r, k, phi = np.concatenate(list(radii.values())), np.tile(k, len(radii)), np.tile(phi, len(radii))
        at = {place: r, "k": k, "phi": phi}
    else:
        lists = {"r": R + near, "k": K, "phi": PHI, "nu": NU, "displacement": PHI, "compliance": SOFT}
        at = dict(zip(names, (x.ravel() for x in np.meshgrid(*(lists[key] for key in names))), strict=True))
        labels = np.array([f"r = {r:g}" for r in at["r"]]) if "r" in at else np.full(at["k"].size, "any r")
    return labels, tuple(at[key] for key in names)


@functools.cache
def evaluated(name):
    """(labels, arguments, value, beside a gradient, reverse, forward), the special points first, then the bulk."""
    labels, special = special_points(name)
    at = tuple(np.concatenate([a, b]) for a, b in zip(special, bulk(name), strict=True))
    labels = np.concatenate([labels, np.full(BULK, "bulk")])
    return labels, at, *functions.derivatives(name, *at)


@functools.cache
def hessians(name):
    """At the same points."""
    return functions.hessians(name, *evaluated(name)[1])


def in_bulk(name):
    """What is evaluated, of the bulk alone."""
    _, at, *results = evaluated(name)
    return tuple(x[-BULK:] for x in at), *(x[-BULK:] for x in results)


def worst(labels, at, bad):
    """What went wrong, by label, with one point each."""
    return {
        str(label): [float(x[np.flatnonzero(bad & (labels == label))[0]]) for x in at]
        for label in np.unique(labels[bad])
    }


# The second derivatives of these take seconds to compile and are left to the long run; those of `wear_volume` go
# through all that the others are made of.
LONG_TWICE = (
    "fretting.profile",
    "fretting.worn_radius",
    "fretting.deepest_wear",
    "fretting.edge_pressure",
    "fretting.wear_depth",
    "fretting.initial_displacement",
    "fretting.steady_displacement",
    "fretting.steady_traction",
    "fretting.steady_pressure",
    "gross_slip.initial_displacement",
    "gross_slip.steady_displacement",
    "material.h_N",
    "material.tangential_ratio",
    "partial_slip.amplitude",
    "partial_slip.slip_amplitude",
    "partial_slip.energy_per_cycle",
    "partial_slip.contact_share",
    "partial_slip.energy_ratio",
    "partial_slip.loop_aperture",
)
COMPILED_TWICE = ("fretting.penetration", "partial_slip.displacement_amplitude")
slow_twice = parametrize(
    "name",
    [
        pytest.param(name, marks=getattr(pytest.mark, "long" if name in LONG_TWICE else "compiled"))
        if name in LONG_TWICE + COMPILED_TWICE
        else name
        for name in FUNCTIONS
    ],
)


def test_second_derivative_of_the_worn_punch_is_finite_at_its_edge():
    k = jnp.array([-0.999, -0.5, 0.0, 0.5, 0.999])
    slope = jax.grad(gross_slip.steady_displacement)
    first, second = functions.by_numpy(jax.vmap(lambda r, k: jax.value_and_grad(slope)(r, k)))(jnp.ones(5), k)
    assert np.all(np.isfinite(first))
    assert np.all(np.isfinite(second)), second


@each_function
def test_values_at_the_edges_are_numbers(name):
    labels, at, value, beside_gradient, *_ = evaluated(name)
    for found in (value, beside_gradient):
        assert not np.any(np.isnan(found)), worst(labels, at, np.isnan(found))


@each_function
def test_gradients_are_finite_wherever_the_value_is(name):
    labels, at, value, _, reverse, forward = evaluated(name)
    for gradient in (reverse, forward):
        bad = np.isfinite(value) & ~np.all(np.isfinite(gradient), axis=-1)
        assert not np.any(bad), worst(labels, at, bad)


@slow_twice
def test_second_derivatives_are_finite_wherever_the_value_is(name):
    labels, at, value, *_ = evaluated(name)
    bad = np.isfinite(value) & ~np.all(np.isfinite(hessians(name)), axis=(-1, -2))
    assert not np.any(bad), worst(labels, at, bad)


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


@parametrize("name", ["fretting.stick_radius", "fretting.wear_depth", "gross_slip.force_ratio", "material.h_N"])
def test_alone_under_jit_the_bits_are_the_same(name):
    under_jit = functions.in_rounds(jax.jit(FUNCTIONS[name], compiler_options=functions.AS_USERS), *bulk(name))
    assert_array_equal(under_jit, functions.values(name, *bulk(name)))


def single_points(name):
    """(labels, arguments) in float32, at edges and limits."""
    K, PHI, NU = [-0.99, -0.5, 0.0, 0.5, 0.99], [0.0, 1e-30, 1e-8, 0.5, 0.99], [-0.99, 0.0, 0.3, 0.5]
    R = [0.0, 1e-30, 0.5, 1.0, 2.0, 1e8, 1e18, 1e30]
    lists = {"r": R, "distance": [0.0, 1e-8, 0.5, 1.0, 2.0, 1e30], "k": K, "phi": PHI, "nu": NU}
    lists |= {"displacement": PHI, "compliance": [0.0, 1e-8, 1.0, 1e6]}
    at = [np.float32(x.ravel()) for x in np.meshgrid(*(lists[key] for key in arguments(name)))]
    return np.array([f"r = {r:g}" for r in at[0]]) if "r" in arguments(name) else np.full(at[0].size, "any r"), at


CHEAP_IN_SINGLE = ("fretting.stick_radius", "gross_slip.volume_change")
# The accuracy of these in single precision is measured at the edges, by the same program.
MEASURED_IN_SINGLE = ("fretting.wear_volume", "fretting.worn_radius", "fretting.steady_pressure")


def long_but_for(names):
    return parametrize("name", [pytest.param(name, marks=() if name in names else long) for name in FUNCTIONS])


@long_but_for(CHEAP_IN_SINGLE + MEASURED_IN_SINGLE)
def test_gradients_are_finite_in_single_precision(name):
    labels, at = single_points(name)
    value, beside_gradient, reverse, forward = functions.derivatives(name, *at)
    assert value.dtype == beside_gradient.dtype == reverse.dtype == forward.dtype == np.float32
    for gradient in (reverse, forward):
        bad = np.isfinite(value) & ~np.all(np.isfinite(gradient), axis=-1)
        assert not np.any(bad), worst(labels, at, bad)


@long_but_for(CHEAP_IN_SINGLE)
def test_second_derivatives_are_finite_in_single_precision(name):
    labels, at = single_points(name)
    value, hessian = functions.values(name, *at), functions.hessians(name, *at)
    assert value.dtype == hessian.dtype == np.float32
    bad = np.isfinite(value) & ~np.all(np.isfinite(hessian), axis=(-1, -2))
    assert not np.any(bad), worst(labels, at, bad)


# --- digits ---------------------------------------------------------------------------------------------------------


@each_function
def test_digits_are_accepted_and_the_wrong_ones_refused(name):
    at = [scalar(key) for key in arguments(name)]
    if name in COMPILED:  # test_digits.py has all of them
        assert_allclose(FUNCTIONS[name](*at, digits=5), FUNCTIONS[name](*at), rtol=1e-5)
    for wrong in (0, -1, 16, 2.5, "a", True):
        with pytest.raises((ValueError, TypeError), match="digits"):
            FUNCTIONS[name](*at, digits=wrong)
    with pytest.raises((ValueError, TypeError), match="digits"):  # float32 holds 6
        FUNCTIONS[name](*map(np.float32, at), digits=7)


def test_digits_are_static_under_jit():
    coarse = jax.jit(fretting.worn_radius, static_argnames="digits")(0.3, 0.4, digits=3)
    assert float(coarse) == float(fretting.worn_radius(0.3, 0.4, digits=3)) != float(fretting.worn_radius(0.3, 0.4))
    with pytest.raises((TypeError, ValueError), match="digits"):  # a traced number is no number of digits
        jax.jit(fretting.worn_radius)(0.3, 0.4, digits=3)


# --- contacts -------------------------------------------------------------------------------------------------------


def reference_contact(kind="fretting", nu=0.3, k=0.3):
    graded = PowerLawGraded(E0=110e9, z0=1e-4, k=k, nu=nu)
    if kind == "fretting":
        return FrettingContact(graded, radius=5e-3, normal_force=10.0, friction=0.4)
    return GrossSlipContact(graded, radius=2e-3, depth=1e-6)


KINDS = {"fretting": FrettingContact, "gross_slip": GrossSlipContact}
FORCE = 2.0


def all_results(contact, names=None):
    """All that the steady state answers (or some), with a radius in the middle of it and a middling force."""
    frets = isinstance(contact, FrettingContact)
    steady = contact.steady(FORCE) if frets else contact.steady()
    given = {"r": 4e-5 if frets else 1e-3, "distance": 1e-6, "x": -3e-5, "z": 1e-5, "least": 1e-6, "most": 1e-4}
    results = {}
    for name, law in QUANTITIES["fretting" if frets else "gross-slip"].items():
        if names is None or name in names:
            at = [given[key] for key in law.arguments if key in given]
            results[name] = getattr(steady, name)(*at) if at else getattr(steady, name)
    return results


compiled_results = jax.jit(all_results, static_argnames="names")


MIDDLING = ("worn_radius", "wear_volume", "penetration", "edge_pressure", "pressure", "displacement_amplitude")


@parametrize(
    "kind, nu, names",
    [
        ("fretting", 0.3, MIDDLING),
        pytest.param("gross_slip", "holl", None, marks=compiled),
    ],
)
def test_contacts_are_arguments_of_compiled_functions(kind, nu, names):
    contact = reference_contact(kind, nu)
    eager, jitted = all_results(contact, names), compiled_results(contact, names)
    assert eager.keys() == jitted.keys() and len(eager) >= len(names or range(8))
    for name in eager:
        # the constants are arguments instead of numbers: the exponential of a logarithm of some tens
        assert_allclose(jitted[name], eager[name], rtol=256 * EPS, err_msg=name)


SOME = ("contact_radius", "stick_radius", "initial_displacement")  # of the contact, its slip, and a radius in it


@compiled
@parametrize("kind, names", [("fretting", SOME), ("gross_slip", None)], ids=KINDS)
def test_contacts_are_batched_by_vmap_and_by_array_fields(kind, names):
    scale, contact = np.array([1.0, 1.1, 0.9]), reference_contact(kind, k=np.array([-0.6, 0.0, 0.45]))
    material = dataclasses.replace(contact.material, E0=110e9 * scale)
    contact = dataclasses.replace(contact, radius=contact.radius * scale, material=material)
    by_fields = all_results(contact, names)
    batch = jax.tree.map(lambda x: np.broadcast_to(x, (3,)), contact)
    by_vmap = jax.jit(jax.vmap(functools.partial(all_results, names=names)))(batch)
    single = [all_results(jax.tree.map(lambda x, i=i: x[i], batch), names) for i in range(3)]
    for name, value in by_vmap.items():
        one_by_one = np.array([one[name] for one in single])
        assert_allclose(value, one_by_one, rtol=256 * EPS, err_msg=name)
        assert_allclose(np.broadcast_to(by_fields[name], (3,)), one_by_one, rtol=256 * EPS, err_msg=name)


@long
@parametrize("nu", [0.3, "holl"])
@parametrize("kind", KINDS)
def test_a_gradient_with_respect_to_a_contact_is_a_contact(kind, nu):
    contact = reference_contact(kind, nu)

    def quantity(contact):
        return contact.steady(FORCE).wear_volume if kind == "fretting" else contact.steady().steady_force

    value = jax.jit(quantity)
    slope = jax.grad(quantity)(contact)
    assert type(slope) is KINDS[kind] and type(slope.material) is PowerLawGraded
    assert jax.tree.structure(slope) == jax.tree.structure(contact)
    for path, x in paths_of(contact).items():
        up, down = (value(with_leaf(contact, path, x * (1.0 + side))) for side in (1e-5, -1e-5))
        # Central differences: h^2 and EPS/h, both 1e-10 times a few tens.
        assert_allclose(x * leaf_of(slope, path), (up - down) / 2e-5, rtol=1e-7, err_msg=path)


# --- the optimal exponent -------------------------------------------------------------------------------------------

LOWEST, HIGHEST = -0.95, 0.95
# On the lower bound, four between, on the upper bound; then what is outside: phi, phi, phi, bounds, lower, upper.
GOOD_PHI = np.array([0.05, 0.1, 0.2, 0.3, 0.36, 0.97])
PHI = np.concatenate([GOOD_PHI, [1.0, -0.1, np.nan, 0.5, 0.5, 0.5]])
LOWER = np.array([LOWEST] * 9 + [0.5, -1.0, LOWEST])
UPPER = np.array([HIGHEST] * 9 + [-0.5, HIGHEST, np.nan])
GOOD, BETWEEN = slice(0, 6), slice(1, 5)


@jax.jit
def designs(phi, lower, upper):
    """Optima, and the slopes of k and of the wear volume in phi, lower and upper."""

    def numbers(phi, lower, upper):
        found = optimise.optimal_exponent(phi, (lower, upper))
        return (found.k, found.wear_volume), found

    _, back, found = jax.vjp(numbers, phi, lower, upper, has_aux=True)
    one, zero = jnp.ones_like(phi), jnp.zeros_like(phi)
    by_both = jax.vmap(back)((jnp.stack([one, zero]), jnp.stack([zero, one])))
    return found, *(jax.tree.map(lambda slope, row=row: slope[row], by_both) for row in (0, 1))


@long
def test_the_optimum_is_differentiable():
    found, (by_phi, by_lower, by_upper), by_volume = jax.tree.map(np.asarray, designs(PHI, LOWER, UPPER))
    volume_by_phi, _, volume_by_upper = by_volume
    # Outside there is nothing.
    assert np.all(np.isnan([found.k, found.wear_volume, by_phi, volume_by_phi])[:, 6:])
    flags = found.converged, found.certified, found.scan_found_nothing_better, found.at_bound
    assert not np.any(np.stack(flags)[:, 6:])
    single = optimise.optimal_exponent(np.float32(GOOD_PHI))
    assert single.k.dtype == single.wear_volume.dtype == jnp.float32
    assert_allclose(single.k, found.k[GOOD], atol=2e-3)  # eps^(5/8) = 5e-5 of slope; the volume is flat
    h = 1e-4 * np.where(np.arange(12) < 6, 1.0, 0.0)
    up, down = (designs(PHI + sign * h, LOWER, UPPER)[0] for sign in (1.0, -1.0))
    # h^2 times third derivatives of some tens, and k to 1e-9 over h: 1e-5 both.
    assert_allclose(by_phi[BETWEEN], (np.asarray(up.k) - down.k)[BETWEEN] / 2e-4, rtol=1e-4)
    change = (np.asarray(up.wear_volume) - down.wear_volume)[GOOD] / 2e-4
    assert_allclose(volume_by_phi[GOOD], change, rtol=1e-4)
    # On a bound k follows that bound and nothing else, and so does the volume; elsewhere it knows of none but rounding.
    assert_array_equal(by_phi[[0, 5]], 0.0)
    assert_allclose(by_lower[GOOD], [1.0, 0.0, 0.0, 0.0, 0.0, 0.0], rtol=0, atol=64 * EPS)
    assert_allclose(by_upper[GOOD], [0.0, 0.0, 0.0, 0.0, 0.0, 1.0], rtol=0, atol=64 * EPS)
    by_k = float(jax.grad(fretting.wear_volume)(HIGHEST, 0.97))
    assert_allclose(volume_by_upper[5], by_k, rtol=1e-12)
