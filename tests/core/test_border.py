"""What happens to arguments outside their range: an error that names them, or NaN where they are traced.

Domains are those of the paper; every public function and class is asked. A traced argument cannot raise, so it must
turn the result, and its derivatives, into NaN: never into a number that somebody could take for an answer.
"""

import dataclasses
import functools
import math
import re

import functions
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from dependence import FRETTING, GOOD, GROSS_SLIP, MATERIAL, PLACES, build, depends, quantities
from functions import FUNCTIONS, arguments
from kinds import KINDS
from marks import compiled_case, parametrize
from numpy.testing import assert_array_equal
from processes import output
from refusals import data, refusal

from plgwear_jax import Elastic, FrettingContact, GrossSlipContact, PowerLawGraded, fretting, material, optimise
from plgwear_jax._core import domains

POINTS = data("core/points.toml")
RANGE, BAD = POINTS["range"], POINTS["bad"]
NO_NUMBERS = [1j, "abc", None, np.array(["abc"]), np.array([1.0 + 0j]), object]


each_function = parametrize("name", FUNCTIONS)
each_argument = parametrize("name, key", [(name, key) for name in FUNCTIONS for key in arguments(name)])


def call(name, **changed):
    return FUNCTIONS[name](*({**GOOD, **changed}[key] for key in arguments(name)))


# --- concrete values ------------------------------------------------------------------------------------------------


@each_argument
def test_a_value_outside_is_refused_by_name_value_and_range(name, key):
    whole = 1 if key in ("k", "phi", "displacement") else -1
    for value in [*BAD[key], whole]:
        for given in (value, np.float64(value), np.asarray(value), jnp.asarray(value)):
            message = refusal(ValueError, call, name, **{key: given})
            flushed = abs(value) < 1e-290  # shown as JAX or NumPy would print it
            assert message.startswith(f"{key} = ") and (flushed or str(value) in message), message
            assert RANGE[key] in message, message


@each_argument
def test_the_bad_element_of_an_array_is_named_by_its_index(name, key):
    value = BAD[key][1]
    array = np.full((2, 3), GOOD[key])
    array[1, 2] = value
    for given in (array, jnp.asarray(array), np.float32(array)):
        with pytest.raises(ValueError, match=rf"^{key} = .* at index 1, 2\b"):
            call(name, **{key: given})


@each_argument
@parametrize("given", NO_NUMBERS, ids=repr)
def test_what_is_no_real_number_is_refused(name, key, given):
    with pytest.raises((TypeError, ValueError)):
        call(name, **{key: given})


def test_a_string_that_is_not_holl_is_no_ratio_of_poisson():
    for ask in (material.h_N, lambda k, nu: build(PowerLawGraded, nu=nu)):
        with pytest.raises(ValueError, match=r'nu = "hall".*holl'):
            ask(0.3, "hall")


@each_function
def test_the_number_of_arguments_is_checked_as_python_does(name):
    good = [GOOD[key] for key in arguments(name)]
    for wrong in ([*good, 0.1], []):
        with pytest.raises(TypeError):
            FUNCTIONS[name](*wrong)
    with pytest.raises(TypeError, match="unknown"):
        FUNCTIONS[name](*good, unknown=1)
    with pytest.raises(TypeError):
        FUNCTIONS[name](*good, **{arguments(name)[0]: good[0]})


@each_function
def test_the_ends_that_belong_to_the_range_are_allowed(name):
    ends = {"r": 0.0, "phi": 0.0, "nu": 0.5, "k": math.nextafter(-1.0, 0.0), "compliance": 0.0, "displacement": 0.0}
    for key, value in ends.items():
        if key in arguments(name):
            assert np.isfinite(call(name, **{key: value})), key


def test_the_stick_edge_itself_is_allowed():
    assert call("fretting.edge_pressure", distance=0.0) == math.inf


class Spy:
    """NumPy, which notes how much of arrays of JAX is read."""

    def __init__(self):
        self.read = []

    def __getattr__(self, name):
        return getattr(np, name)

    def asarray(self, value, dtype=None):
        if isinstance(value, jax.Array):
            self.read.append((value.dtype, value.size))
        return np.asarray(value, dtype)


def test_of_arrays_on_another_device_one_truth_value_each_is_read(monkeypatch):
    """As if the processor were an accelerator."""
    spy = Spy()
    monkeypatch.setattr(domains, "np", spy)
    monkeypatch.setattr(domains, "on_accelerator", lambda value: isinstance(value, jax.Array))
    k, phi = jnp.full((2, 3), 0.3), jnp.full((2, 3), 0.4)
    jax.eval_shape(lambda: fretting.stick_radius(k, phi))  # they are known in there too
    assert spy.read == [(np.bool_, 2)]
    spy.read.clear()
    with pytest.raises(ValueError, match=r"^phi = 1.5 at index 1, 2 is outside the allowed range 0 <= phi < 1$"):
        fretting.stick_radius(k, phi.at[1, 2].set(1.5))
    assert sum(size for _, size in spy.read) == 3  # and the element outside


WHOLE_NUMBERS = """
import jax
import jax.numpy as jnp
import numpy as np
from plgwear_jax import Elastic, FrettingContact, PowerLawGraded
from plgwear_jax.contact import slip_regimes
from plgwear_jax.loads import Force

def results(E0, limit, body=PowerLawGraded):
    coating = body(E0, 1e-4, 0, 0.3) if body is PowerLawGraded else body(E0, 0.3)
    contact = FrettingContact(coating, 5e-3, 10, 0.4)
    state, run = contact.steady(Force(1.5, limit)), contact.over_cycles(1.5, 1e-14, digits=2)
    return np.stack([state.contact_radius, state.displacement_amplitude, run.volume(limit)])

def loop(rig_stiffness):
    contact = FrettingContact(PowerLawGraded(1e11, 1e-4, 0, 0.3), 5e-3, 10, 0.4)
    return slip_regimes(contact, [1e-7], [10], rig_stiffness=rig_stiffness).energy_ratio

np.testing.assert_allclose(loop(10**10), loop(1e10), rtol=1e-6)

one, two = 100 * 10**9, [100 * 10**9, 200 * 10**9]
for same, bodies in ((one, np.int64(one)), (PowerLawGraded, Elastic)), ((two, np.array(two)), (PowerLawGraded,)):
    for body in bodies:
        expected = results(np.asarray(same[0], float), 1e10, body)
        for whole in same:
            np.testing.assert_allclose(results(whole, 10**10, body), expected, rtol=1e-6)

def energy(kind):
    contact = FrettingContact(PowerLawGraded(1e11, 1e-4, 0, 0.3), 5e-3, kind(100_000), friction=kind(50_000))
    return contact.steady(8e8).energy_per_cycle

for wide in False, True:
    jax.config.update("jax_enable_x64", wide)
    for kind in np.int32, np.uint32, jnp.int32:  # their product has more than 32 bits
        np.testing.assert_allclose(energy(kind), energy(float), rtol=1e-6)
"""


def test_whole_numbers_are_not_cut_to_32_bits():
    output("-c", WHOLE_NUMBERS, JAX_ENABLE_X64="0")


# --- traced values --------------------------------------------------------------------------------------------------


@functools.cache
def bad_rows(name):
    """Every bad value, with the others good; r once under the contact, in the ring, at its edges and far beyond."""
    names = arguments(name)
    place = next((key for key in ("r", "distance") if key in names), None)
    rows = []
    for key in names:
        for value in BAD[key]:
            for x in (0.0, 0.7, 0.9, 1.0, 7.0, 1e9) if place and key != place else (0.7,):
                row = {**GOOD, place: x, key: value}
                rows.append([row[n] for n in names])
    return np.array(rows).T


def assert_nan(name, rows, result):
    result = np.reshape(result, (rows.shape[1], -1))
    plausible = ~np.all(np.isnan(result), axis=1)
    points = [dict(zip(arguments(name), row.tolist(), strict=True)) for row in rows.T[plausible][:3]]
    assert not np.any(plausible), f"{np.sum(plausible)} of {result.size}, as {points} -> {result[plausible][:3]}"


@each_function
def test_traced_values_outside_give_nan(name):
    rows = bad_rows(name)
    program = jax.jit if name in functions.COMPILED else functions.by_numpy
    assert_nan(name, rows, program(FUNCTIONS[name])(*rows))


@each_function
def test_in_a_program_the_value_and_all_slopes_are_nan(name):
    """The value alone and beside a gradient, and the slopes in every argument, wherever any argument is outside."""
    rows = bad_rows(name)
    for result in functions.derivatives(name, *rows):
        assert_nan(name, rows, result)


# --- the material and the contacts ----------------------------------------------------------------------------------

NOT_POSITIVE = [0.0, -1.0, math.inf, -math.inf, math.nan]
FIELDS = [
    *((PowerLawGraded, name, value) for name in ("E0", "z0") for value in NOT_POSITIVE),
    *((PowerLawGraded, name, value) for name in ("k", "nu") for value in BAD[name]),
    *((FrettingContact, name, value) for name in FRETTING for value in NOT_POSITIVE),
    *((GrossSlipContact, name, value) for name in GROSS_SLIP for value in NOT_POSITIVE),
]


@parametrize("cls, field, value", FIELDS, ids=lambda x: getattr(x, "__name__", str(x)))
def test_a_field_outside_is_refused(cls, field, value):
    text = RANGE.get(field, "> 0")
    line = refusal(ValueError, build, cls, **{field: value})
    assert line.startswith(f"{field} = {value}") and text in line
    good = {**MATERIAL, **FRETTING, **GROSS_SLIP}[field]
    with pytest.raises(ValueError, match=rf"^{field} = .* at index 1\b"):
        build(cls, **{field: np.array([good, value])})
    with pytest.raises(ValueError, match=rf"^{field} = "):  # replaced fields are checked as well
        dataclasses.replace(build(cls), **{field: value})


@parametrize("given", NO_NUMBERS, ids=repr)
@parametrize("cls, field", sorted({(c, f) for c, f, _ in FIELDS}, key=str), ids=lambda x: getattr(x, "__name__", x))
def test_a_field_that_is_no_real_number_is_refused(cls, field, given):
    with pytest.raises((TypeError, ValueError)):
        build(cls, **{field: given})


@parametrize("modulus_at", [build(PowerLawGraded).modulus, Elastic(110e9, 0.3).modulus_at])
def test_depths_below_zero_are_refused(modulus_at):
    for value in (-1e-9, math.nan):
        with pytest.raises(ValueError, match=r"^z = .* range >= 0"):
            modulus_at(value)
    with pytest.raises(ValueError, match=r"^z = -1.0 at index 1\b"):
        modulus_at(np.array([0.0, -1.0]))
    assert np.isnan(jax.jit(modulus_at)(-1.0))


INSIDE = {
    FrettingContact: PLACES | {"tangential_force": 2.0, "displacement_amplitude": 1e-8},
    GrossSlipContact: {"r": 1e-3, "z": 1e-5},
}


def ask(contact, name, **changed):
    cls = type(contact)
    at = INSIDE[cls] | changed
    steady = contact.steady(at["tangential_force"]) if cls is FrettingContact else contact.steady()
    found, names = getattr(steady, name), quantities(cls)[name]
    return found(*(at[key] for key in names)) if names else found


def test_a_force_of_gross_slip_is_refused():
    contact = build(FrettingContact)
    for force in (-1.0, math.nan, np.array([1.0, -1.0])):
        with pytest.raises(ValueError, match=r"^tangential_force = .* range >= 0, the amplitude of a force in N"):
            contact.steady(force)
    for force in (4.0, 5.0, math.inf):
        line = refusal(ValueError, contact.steady, force)
        assert "F_x/(mu F_N) < 1, beyond which the slip is gross" in line and str(force / 4.0) in line
    with pytest.raises(ValueError, match=r"at index 1\b.*gross"):
        contact.steady(np.array([1.0, 4.0]))
    for wrong in (1j, "abc", None):
        with pytest.raises((TypeError, ValueError)):
            contact.steady(wrong)


@parametrize("cls", INSIDE, ids=lambda cls: cls.__name__)
def test_a_negative_length_is_refused(cls):
    for name, keys in quantities(cls).items():
        for key in {"r", "distance"} & set(keys):
            for value in (-1e-9, math.nan):
                with pytest.raises(ValueError, match=rf"^{key} = .* range >= 0"):
                    ask(build(cls), name, **{key: value})
            with pytest.raises(ValueError, match=rf"^{key} = -1.0 at index 1\b"):
                ask(build(cls), name, **{key: np.array([0.0, -1.0])})


def fading(contact, r):
    """All that ends far away."""
    names = {name for name, keys in quantities(type(contact)).items() if keys == ["r"]}
    return jnp.stack([ask(contact, name, r=r) for name in sorted(names - {"profile"})])


UNDER_STEEL = KINDS["layers under steel"]


@parametrize("contact", [build(FrettingContact), build(GrossSlipContact), UNDER_STEEL])
def test_infinitely_far_away_all_but_the_profile_ends(contact):
    assert isinstance(contact, GrossSlipContact) or ask(contact, "profile", r=math.inf) == math.inf
    program, contact = functions.by_numpy(fading), jax.tree.map(jnp.asarray, contact)
    assert_array_equal(program(contact, jnp.array(math.inf)), 0.0)
    assert np.all(np.isnan(program(contact, jnp.array(math.nan))))


@parametrize("contact", [build(FrettingContact), build(GrossSlipContact), compiled_case(UNDER_STEEL)])
def test_infinitely_far_away_nothing_changes(contact):
    found = jax.value_and_grad(lambda contact: jnp.sum(fading(contact, math.inf)))(contact)
    assert not any(map(np.any, jax.tree.leaves(found)))


TRACED = {
    **BAD,
    **dict.fromkeys(("E0", "z0", "radius", "normal_force", "friction", "depth"), NOT_POSITIVE),
    **{key: [-1e-9, -1.0, math.nan] for key in ("r", "distance", "z", "least", "most")},
    "x": [math.nan],
    "tangential_force": [4.0, 5.0, -1.0, math.inf, math.nan],
    "displacement_amplitude": [-1e-9, 1.0, math.inf, math.nan],
}


STRESSES = {name for name in quantities(FrettingContact) if re.search("stress|tension|mises", name)}


@parametrize(
    "cls, names",
    [
        pytest.param(FrettingContact, quantities(FrettingContact).keys() - STRESSES, id="fretting"),
        compiled_case(FrettingContact, STRESSES, id="stresses"),
        pytest.param(GrossSlipContact, quantities(GrossSlipContact).keys(), id="gross slip"),
    ],
)
def test_a_traced_field_or_argument_outside_gives_nan(cls, names):
    """All quantities at once, at every bad value of every field and argument."""
    fields = {**MATERIAL, **(FRETTING if cls is FrettingContact else GROSS_SLIP), **INSIDE[cls]}
    rows = [(key, value) for key in fields for value in TRACED[key]]
    table = {name: jnp.array([value if key == name else x for key, value in rows]) for name, x in fields.items()}

    def everything(at):
        contact = build(cls, **at)
        given = {key: at[key] for key in INSIDE[cls]}
        return {name: jnp.ravel(jnp.asarray(ask(contact, name, **given)))[0] for name in sorted(names)}

    results = functions.by_numpy(jax.vmap(everything))(table)
    wrong = {
        f"{name} at {key} = {value}": float(result)
        for name in names
        for (key, value), result in zip(rows, np.asarray(results[name]), strict=True)
        if key in depends(cls, name) and not np.isnan(result)
    }
    assert not wrong


# --- optimisation ---------------------------------------------------------------------------------------------------


def test_words_belong_to_the_structure_of_a_record_where_they_are_declared():
    of_holl, interval = build(PowerLawGraded, nu="holl"), optimise.Interval(1.0, 2.0, "logarithmic")
    assert len(jax.tree.leaves(of_holl)) == 3 and len(jax.tree.leaves(build(PowerLawGraded))) == 4
    assert jax.tree.leaves(interval) == [1.0, 2.0] and jax.tree.map(lambda x: x, interval) == interval
    assert jax.tree.structure(interval) != jax.tree.structure(optimise.Interval(1.0, 2.0))
    assert jax.jit(lambda material: material)(of_holl).nu == "holl"
    question = optimise.Question(of_holl, None, {"k": (-0.5, 0.5)}, (), {}, objective="force_drop")
    assert len(jax.tree.leaves(question)) == 5
