"""The catalogue: all that stands in it can be swept, over any leaf of a contact, in its units."""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from functions import FUNCTIONS
from kinds import KINDS, LAW
from marks import compiled, parametrize
from numpy.testing import assert_allclose, assert_array_equal
from refusals import cases, data, is_told, refusal

from plgwear_jax import (
    Cone,
    DepthGraded,
    Elastic,
    FrettingContact,
    GrossSlipContact,
    PowerShape,
    Profile,
    RoundedFlat,
    sweep,
)
from plgwear_jax._core.catalogue import AXES, FRETTING, GROSS_SLIP, PEAKS, derivative, entry, laws_of, leaf, read
from plgwear_jax._core.domains import record
from plgwear_jax._core.leaves import leaf_of, paths_of, with_leaf
from plgwear_jax._core.units import PREFIXED

CLOSED, PUNCH = KINDS["closed forms"], GrossSlipContact(LAW, radius=2e-3, depth=1e-6)
LAYERED = FrettingContact(
    DepthGraded([0.0, 2e-5, 1e-4], [90e9, 120e9, 150e9], 0.3), 5e-3, 10.0, 0.4, Elastic(210e9, 0.28), PowerShape(3.0)
)
FORCE = np.array([0.5, 2.0])
NAMES = data("sweep/names.toml")
GIVEN = NAMES["given"]


# --- every quantity -------------------------------------------------------------------------------------------------


def check_all(names, contact, digits=None, **given):
    arguments = {x for name in names for x in laws_of(contact)[name].arguments} - {"F_x"}
    ds = sweep.sweep(names, contact=contact, digits=digits, **{x: GIVEN[x] for x in arguments}, **given)
    for name in names:
        found, law = ds[name.replace(".", "_")], laws_of(contact)[name]
        rows = {x: np.asarray(ds[x]) for x in found.dims}
        full = dict(zip(rows, np.meshgrid(*rows.values(), indexing="ij"), strict=True))
        changed = contact
        for path in full.keys() - GIVEN.keys() - {"tangential_force"}:
            changed = with_leaf(changed, path if path in paths_of(contact) else f"material.{path}", full[path])
        rtol = 1e-9 if digits is None else 10.0 ** (1 - digits)
        if digits is None and name in {*PEAKS, "peak_mises_between"}:  # whose places are those of a search
            rtol = 1e-7
        expected = read(changed, name, full.get("tangential_force", 0.0), GIVEN | full)
        assert_allclose(found, expected, rtol=rtol, atol=1e-30)
        assert found.attrs["units"] == law.unit and found.attrs["long_name"] == law.description


STEADY = [name for name, law in FRETTING.items() if "r" not in law.arguments]
FIELDS = [name for name, law in FRETTING.items() if "r" in law.arguments]


@compiled
@parametrize("names", [STEADY, FIELDS], ids=["numbers", "over the radius"])
def test_every_quantity_of_a_closed_contact_can_be_swept(names):
    check_all(names, CLOSED, tangential_force=FORCE, z0=np.array([1e-5, 1e-3]), k=np.array([-0.3, 0.4]))


@compiled
@parametrize("name", [name for name in laws_of(CLOSED) if name.startswith("transient.")])
def test_every_quantity_over_cycles_can_be_swept(name):
    check_all([name], CLOSED, tangential_force=FORCE)


def test_every_quantity_of_a_punch_can_be_swept():
    check_all(list(GROSS_SLIP), PUNCH, k=np.array([-0.3, 0.4]))


@compiled
def test_quantities_of_a_numeric_contact_can_be_swept():
    names = ["contact_radius", "wear_volume", "energy_per_cycle", "displacement_amplitude", "slip_amplitude"]
    check_all(names, dataclasses.replace(LAYERED, shape=None), digits=3, tangential_force=FORCE)


# --- every leaf -----------------------------------------------------------------------------------------------------


def of_shape(shape):
    return dataclasses.replace(CLOSED, shape=shape)


@compiled
@parametrize(
    "contact, path, values",
    [
        (LAYERED, "material.modulus[1]", [60e9, 150e9]),
        (LAYERED, "indenter.nu", [0.1, 0.4]),
        (LAYERED, "shape.exponent", [2.5, 4.0]),
        (LAYERED, "radius", [4e-3, 6e-3]),
        (of_shape(Cone(0.01)), "shape.slope", [0.009, 0.011]),
        (of_shape(RoundedFlat(3e-5)), "shape.flat_radius", [2.7e-5, 3.3e-5]),
        (of_shape(Profile([0.0, 5e-5, 1e-4, 2e-4], [0.0, 2.5e-7, 1e-6, 4e-6])), "shape.heights[2]", [0.9e-6, 1.1e-6]),
    ],
    ids=str,
)
def test_every_leaf_can_be_an_axis(contact, path, values):
    ds = sweep.sweep("stick_radius", contact=contact, digits=2, tangential_force=1.0, **{path: values})
    assert ds.stick_radius.dims == (path,) and ds[path].attrs["units"] == leaf(path).unit
    alone = [with_leaf(contact, path, value).steady(1.0, digits=2).stick_radius for value in values]
    assert_allclose(ds.stick_radius, alone, rtol=1e-9)
    assert not np.isclose(*alone, rtol=1e-4)


@compiled
def test_elements_are_axes_beside_each_other_and_have_derivatives():
    first, last = np.array([80e9, 100e9]), np.array([140e9, 160e9, 180e9])
    given = {"material.modulus[0]": first, "material.modulus[2]": last}
    names = ["contact_radius", "contact_radius.dmaterial.modulus[2]", "contact_radius.dmaterial.modulus[1]"]
    found, slope, slope_of_another = sweep.sweep(names, contact=LAYERED, digits=3, **given).values()
    assert found.dims == tuple(given) and slope.attrs["units"] == "m/Pa"
    radius_and_slopes = jax.value_and_grad(lambda contact: contact.steady(0.0, digits=3).contact_radius)
    for i, j in ((0, 1), (1, 2)):
        radius, by = radius_and_slopes(with_leaf(LAYERED, "material.modulus", np.array([first[i], 120e9, last[j]])))
        assert_allclose(found[i, j], radius, rtol=1e-9)
        assert_allclose([slope_of_another[i, j], slope[i, j]], by.material.modulus[1:], rtol=1e-6)


def test_a_leaf_has_one_name_or_its_path():
    names, by = ["stick_radius", "stick_radius.dk"], dict[str, Any]
    long, short = (sweep.sweep(names, contact=CLOSED, phi=0.5, **by({k: [0.1, 0.3]})) for k in ("material.k", "k"))
    assert_array_equal(long.stick_radius, short.stick_radius)
    assert "k" not in long.coords and long["material.k"].attrs == short.k.attrs
    assert_allclose(long.stick_radius_dk, short.stick_radius_dk, rtol=1e-14)
    assert_allclose(short.stick_radius, with_leaf(CLOSED, "material.k", short.k.values).steady(2.0).stick_radius)
    holl = sweep.sweep("contact_radius", contact=with_leaf(CLOSED, "material.nu", "holl"), nu=np.array([0.2, 0.3]))
    expected = [with_leaf(CLOSED, "material.nu", nu).steady(0.0).contact_radius for nu in (0.2, 0.3)]
    assert_allclose(holl.contact_radius, expected, rtol=1e-13)


@cases("sweep/refused.toml", "leaves")
def test_unknown_leaves_and_quantities_are_refused_in_a_line(case):
    assert is_told(refusal(ValueError, sweep.sweep, case["names"], contact=LAYERED, **case["given"]), case)


# --- leaves by path -------------------------------------------------------------------------------------------------


@record
class Holder:
    inner: Any
    rows: Any


def test_a_leaf_is_set_by_its_path_or_that_of_jax():
    paths, _ = jax.tree_util.tree_flatten_with_path(LAYERED)
    assert [jax.tree_util.keystr(path)[1:] for path, _ in paths] == list(paths_of(LAYERED))
    for path, value in paths:
        changed, text = with_leaf(LAYERED, path, 1.1 * value), jax.tree_util.keystr(path)[1:]
        assert_array_equal(leaf_of(changed, text), 1.1 * value)
        jax.tree.map(assert_array_equal, paths_of(changed), paths_of(LAYERED) | {text: 1.1 * value})


def test_a_leaf_within_lists_dictionaries_and_arrays():
    held = Holder({"a": [1.0, (2.0, 3.0)]}, np.array([[1.0, 2.0], [3.0, 4.0]]))
    assert leaf_of(held, "inner['a'][1][0]") == 2.0
    assert with_leaf(held, "inner['a'][1][0]", 5.0).inner == {"a": [1.0, (5.0, 3.0)]}
    assert_array_equal(with_leaf(held, "rows[1]", 9.0).rows, [[1.0, 9.0], [3.0, 9.0]])
    assert_array_equal(with_leaf(held, "rows[0]", np.array([[7.0], [8.0]])).rows[:, :, 0], [[7.0, 7.0], [8.0, 8.0]])
    for path in ("rows[2]", "inner['b']", "other", "rows.x"):
        with pytest.raises((LookupError, AttributeError)):
            with_leaf(held, path, 1.0)


def test_a_leaf_is_set_under_jit_and_grad():
    def radius(value):
        return with_leaf(CLOSED, "material.E0", value).steady(0.0).contact_radius

    whole = jax.grad(lambda contact: contact.steady(0.0).contact_radius)(CLOSED).material.E0
    assert_allclose(jax.jit(jax.grad(radius))(110e9), whole, rtol=1e-12)

    moduli = jax.vmap(lambda value: with_leaf(LAYERED, "material.modulus[2]", value).material.modulus)
    assert_array_equal(moduli(jnp.array([1e9, 2e9]))[:, 2], [1e9, 2e9])
    with pytest.raises(ValueError, match="modulus"):
        with_leaf(LAYERED, "material.modulus[2]", -1.0)


# --- words, symbols and units ---------------------------------------------------------------------------------------


def test_a_leaf_is_called_what_it_is():
    for one in NAMES["leaves"]:
        kind = leaf(one["path"])
        told = {"words": kind.words, "symbol": kind.symbol, "unit": kind.unit, "allowed": kind.domain.text}
        assert kind.description and one == {"path": one["path"], **told}
        assert one["path"] == "depth" or entry(one["path"]).unit == kind.unit


def test_every_quantity_has_words_and_its_unit():
    laws = laws_of(CLOSED)
    known = {**AXES, **GROSS_SLIP, **laws}
    units = {name: unit for unit, names in NAMES["units"].items() for name in names}
    assert {name: law.unit for name, law in known.items()}.items() <= units.items()
    assert {name: entry(name).unit for name in units} == units and {*units.values()} == {*PREFIXED, "1/Pa", "N/m"}
    assert all(law.description for law in known.values()) and all(entry(name).words for name in units)
    assert {name: entry(name) for name in laws} == laws
    with pytest.raises(KeyError):
        entry("wear_volum")


def test_scales_of_functions_are_those_of_contacts():
    a = CLOSED.steady(0.0).contact_radius
    sizes = {"a_0": a, "R": 5e-3, "F_N": 10.0, "mu": 0.4, "k": 0.2, "theta": LAW.tangential_ratio(), "pi": np.pi}
    for one in NAMES["scales"]:
        name, at = one["name"], one["at"]
        scale = eval(str(laws_of(CLOSED)[name].scale).replace("^", "**").replace(" ", "*"), sizes)
        found = read(CLOSED, name, 2.0, {"r": at.get("r", 0.0) * a})
        assert_allclose(found, scale * FUNCTIONS[one["function"]](**at), rtol=1e-9)


def test_what_a_name_differentiates():
    for one in NAMES["derivatives"]:
        assert derivative(one["name"]) == (one["stem"], one["slopes"])
