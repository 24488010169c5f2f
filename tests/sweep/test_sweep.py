"""Sweeps: every quantity at every point, labelled, in memory and in a store, and what is refused."""

import functools
import importlib
import json
import math
import os
import sys

import numpy as np
import pytest
import xarray as xr
from functions import FUNCTIONS, arguments, fretting, gross_slip, values
from hypothesis import given
from hypothesis import strategies as st
from kinds import KINDS
from marks import compiled, long_case, parametrize
from numpy.testing import assert_allclose
from optima import optima
from refusals import cases, data, is_told, refusal
from stores import AXES, CHUNKS, QUANTITIES

from plgwear_jax import GrossSlipContact, PowerLawGraded, optimise, sweep
from plgwear_jax._core.catalogue import FRETTING, GROSS_SLIP, MATERIAL
from plgwear_jax._core.leaves import with_leaf
from plgwear_jax._core.units import text_cells
from plgwear_jax.loads import Block, Displacement
from plgwear_jax.sweep.plan import chunk_shape

K, PHI = np.array([-0.6, 0.1, 0.7]), np.array([0.2, 0.8])
CONTACT = KINDS["closed forms"]
PUNCH = GrossSlipContact(PowerLawGraded(E0=1e9, z0=1e-3, k=0.2, nu="holl"), radius=2e-3, depth=1e-6)
VALUES = {"k": K, "phi": PHI, "nu": 0.3, "r": np.array([0.5, 1.1]), "distance": 0.01}


grid = functools.partial(np.meshgrid, indexing="ij")


# --- values ---------------------------------------------------------------------------------------------------------


# One for each set of arguments; the others, which go the same way, take seconds each to compile.
OF_A_SWEEP = (
    {f"fretting.{x}" for x in FRETTING} | {f"gross_slip.{x}" for x in GROSS_SLIP} | {f"material.{x}" for x in MATERIAL}
)
SWEPT = [name for name in FUNCTIONS if name in OF_A_SWEEP]
FIRST = {arguments(name): name for name in reversed(SWEPT)}.values()


@parametrize("name", [name if name in FIRST else long_case(name) for name in SWEPT])
def test_every_function_can_be_swept(name):
    needs = arguments(name)
    (found,) = sweep.sweep(name, **{axis: VALUES[axis] for axis in needs}).values()
    assert found.dims == tuple(axis for axis in needs if np.ndim(VALUES[axis])) and set(found.coords) == set(needs)
    at = (x.values for x in xr.broadcast(*(found[axis] for axis in needs)))
    assert_allclose(found, values(name, *at), rtol=1e-13)
    attributes = {"quantity", "units", "long_name", "equation", "digits"}
    assert attributes <= set(found.attrs) <= attributes | {"label"} and all(found.attrs.values())
    assert found.attrs["quantity"] == name and str(found.name).isidentifier()


def test_short_names_are_those_of_fretting_first():
    ds = sweep.sweep(["initial_pressure", "gross_slip.initial_pressure", "force_ratio"], k=K, r=[0.3, 0.6])
    r, k = grid([0.3, 0.6], K)
    assert_allclose(ds["initial_pressure"].T, fretting.initial_pressure(r, k), rtol=1e-13)
    assert_allclose(ds.gross_slip_initial_pressure.T, gross_slip.initial_pressure(r, k), rtol=1e-13)
    assert ds["force_ratio"].dims == ("k",)


def test_derivatives_are_those_of_the_formula():
    ds = sweep.sweep(["stick_radius.dk", "stick_radius.dphi", "stick_radius.dk.dphi"], k=K, phi=PHI)
    k, phi = grid(K, PHI)
    c, sticks = (1.0 - phi) ** (1.0 / (k + 3.0)), (1.0 - phi) * (k + 3.0)
    by_k = -c * np.log1p(-phi) / (k + 3.0) ** 2
    mixed = (np.log1p(-phi) / (k + 3.0) + 1.0) * c / (sticks * (k + 3.0))
    assert_allclose([*ds.values()], [by_k, -c / sticks, mixed], rtol=1e-12)
    assert ds.stick_radius_dk.attrs["long_name"].startswith("derivative by k of: stick radius")


@compiled
def test_derivatives_by_what_is_not_swept():
    names, force = ["stick_radius.dE0", "stick_radius.dnormal_force", "stick_radius.dtangential_force"], [0.5, 2.0]
    ds = sweep.sweep(names, contact=CONTACT, tangential_force=force)
    # c = a_0 (1 - phi)^(1/(k+3)), and a_0^(k+3) goes with F_N/E0
    phi = np.array(force) / 4.0
    c = CONTACT.steady(np.array(force)).stick_radius / (CONTACT.material.k + 3.0)
    expected = [-c / 110e9, c / (1.0 - phi) / 10.0, -c / (1.0 - phi) / 4.0]
    assert_allclose([*ds.values()], expected, rtol=1e-12)
    assert [variable.attrs["units"] for variable in ds.values()] == ["m/Pa", "m/N", "m/N"]

    units = sweep.sweep("steady_displacement.dr", k=[0.1], phi=0.3, r=[0.5]).steady_displacement_dr.attrs["units"]
    assert units == "(a_0^2/R)/a_0"


# --- optima ---------------------------------------------------------------------------------------------------------


def survives_netcdf(ds, folder):
    ds.to_netcdf(folder / "map.nc", engine="scipy")
    with xr.open_dataset(folder / "map.nc", engine="scipy") as back:
        xr.testing.assert_identical(back.load(), ds)


@compiled
def test_the_optimal_exponent_with_its_certificate(tmp_path):
    fields = [f"optimal_exponent.{name}" for name in ("k", "wear_volume", "at_bound", "scan_found_nothing_better")]
    ds = sweep.sweep(fields, phi=PHI, bounds=(-0.5, 0.5))
    best, (*values, found) = optima(PHI, (-0.5, 0.5)), ds.values()
    assert_allclose(values, [best.k, best.wear_volume, best.at_bound], rtol=1e-12)
    assert found.dtype == bool and found.all()
    survives_netcdf(ds, tmp_path)


LOADS = {
    "calm": (np.array([0.1, 0.2, 0.4]), np.array([6.0, 3.0, 1.0])),
    "storm": (np.array([1.0, 3.2]), np.array([1.0, 1.0])),
}
DESIGN = {"vary": {"k": (-0.5, 0.5)}, "hold": "contact_radius"}


@compiled
def test_designs_of_loads_are_those_of_optimise():
    ds = sweep.sweep(
        ["design.k", "design.wear_volume", "design.saving", "design.certified", "design.scan_found_nothing_better"],
        contact=CONTACT,
        loads=LOADS,
        design={**DESIGN, "level": 0.5},
        z0=[1e-5, 1e-4],
    )
    for name, (force, weight) in LOADS.items():
        best = optimise.design(with_leaf(CONTACT, "material.z0", 1e-5), force, weight=weight, level=0.5, **DESIGN)
        found = ds.sel(z0=1e-5, load_case=name)
        assert_allclose(found.design_k, best.variables["k"], rtol=1e-9)
        assert_allclose(found.design_wear_volume, best.value, rtol=1e-12)
        assert_allclose(found.design_saving, best.saving, rtol=1e-9)
        flags = found.design_certified, found.design_scan_found_nothing_better
        assert tuple(map(bool, flags)) == (best.certified, best.scan_found_nothing_better)
    assert ds.design_wear_volume.attrs["units"] == "m^3"


# --- labels ---------------------------------------------------------------------------------------------------------


def test_what_users_of_xarray_expect(tmp_path):
    ds = sweep.sweep("wear_volume", k=K, phi=PHI)
    volume = ds.wear_volume
    assert float(volume.sel(k=0.0, method="nearest").sel(phi=0.8)) == float(volume[1, 1])
    assert {"volume": volume.attrs, "phi": ds.phi.attrs} == data("sweep/attributes.toml")
    survives_netcdf(ds, tmp_path)


def test_fewer_digits_are_said():
    ds = sweep.sweep("stick_radius", k=K, phi=PHI, digits=5)
    assert ds.stick_radius.attrs["digits"] == "5" and json.loads(ds.attrs["plgwear_sweep"])["digits"] == 5


def test_loads_and_ratios_of_holl_survive_netcdf(tmp_path):
    ds = sweep.sweep("wear_volume", contact=CONTACT, loads=LOADS, nu="holl")
    assert ds.attrs["nu"] == "holl" and "nu" not in ds.coords
    force, weight = LOADS["calm"]
    expected = np.average(with_leaf(CONTACT, "material.nu", "holl").steady(force).wear_volume, weights=weight)
    assert_allclose(ds.wear_volume.sel(load_case="calm"), expected, rtol=1e-13)
    ds.to_netcdf(tmp_path / "map.nc", engine="scipy")
    with xr.open_dataset(tmp_path / "map.nc", engine="scipy") as back:
        assert list(back.load_case.astype(str).values) == ["calm", "storm"]


def test_single_precision_is_that_of_the_axes():
    ds = sweep.sweep("wear_volume", k=K.astype(np.float32), phi=PHI.astype(np.float32))
    assert ds.wear_volume.dtype == ds.k.dtype == np.float32
    exact = sweep.sweep("wear_volume", k=ds.k.astype(float), phi=ds.phi.astype(float)).wear_volume
    assert_allclose(ds.wear_volume, exact, rtol=5e-6)
    assert sweep.sweep("wear_volume", k=K.astype(np.float32), phi=PHI).wear_volume.dtype == np.float64


# --- stores ---------------------------------------------------------------------------------------------------------


def test_a_store_holds_what_memory_does_bit_for_bit(tmp_path):
    steps = []
    told = {"out": tmp_path / "map.zarr", "progress": lambda *step: steps.append(step)}
    stored = sweep.sweep(QUANTITIES, **AXES, chunk=100, **told)
    in_memory = sweep.sweep(QUANTITIES, **AXES, chunk=100)
    xr.testing.assert_identical(stored.load().drop_attrs(), in_memory.drop_attrs())
    assert stored.attrs["unfinished"] == 0 and list(stored) == [name.replace(".", "_") for name in QUANTITIES]
    assert stored.gross_slip_force_ratio.dims == ("k",)
    done, points = zip(*steps, strict=True)
    assert points == (1200,) * (1 + CHUNKS) and (done[0], done[-1]) == (0, 1200) and [*done] == sorted(done)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["map.zarr"]
    assert stored.stick_radius.attrs == in_memory.stick_radius.attrs


def test_chunks_of_zeros_and_of_nan_are_finished_chunks(tmp_path):
    # Nothing wears at phi = 0; and what is no number there is no reason to compute it again.
    asked = {"k": [0.1, 0.2], "phi": [0.0], "r": [0.0, 1.0], "chunk": 1, "out": tmp_path / "map.zarr"}
    for _ in range(2):
        found = sweep.sweep(["wear_volume", "steady_pressure"], **asked)
        assert found.attrs["unfinished"] == 0 and not found.wear_volume.any()


@given(st.lists(st.integers(1, 10**4), min_size=1, max_size=4), st.integers(1, 10**7))
def test_chunks_cover_a_sweep_with_little_to_fill_up(shape, points):
    chunk = chunk_shape(shape, points)
    assert math.prod(chunk) <= points and all(1 <= size <= length for size, length in zip(chunk, shape, strict=True))
    parts = [-(-length // size) for length, size in zip(shape, chunk, strict=True)]
    assert all((count - 1) * size < length for count, size, length in zip(parts, chunk, shape, strict=True))
    # The next larger chunks would be too large: no axis is cut more often than needed, but for steps of 2 %.
    if math.prod(shape) > points:
        assert math.prod(chunk) * 1.03 * max(1 + 1 / size for size in chunk) ** len(chunk) > points / 2 ** len(shape)


# --- what is refused ------------------------------------------------------------------------------------------------


complaint = functools.partial(refusal, ValueError, sweep.sweep)


WEAR = "wear_volume"


@cases("sweep/refused.toml", "sweeps")
@pytest.mark.usefixtures("here")
def test_refusals(case):
    blocks = [Block(1.0, 2e5), Block(Displacement(1e-8), 2e5, normal_force=8.0)]
    many = with_leaf(CONTACT, "normal_force", np.array([1.0, 2.0]))
    named = {"CONTACT": CONTACT, "MANY": many, "PUNCH": PUNCH, "LOADS": LOADS, "DESIGN": DESIGN, "BLOCKS": blocks}
    given = {name: named.get(x, x) if isinstance(x, str) else x for name, x in case["given"].items()}
    if "bounds" in given:
        given["bounds"] = tuple(given["bounds"])
    assert is_told(complaint(case["names"], **(AXES if case.get("axes") else {}), **given), case)
    assert os.listdir() == []


def test_more_than_memory_holds_is_refused_with_what_to_do():
    k, phi, r = (np.linspace(0.1, 0.9, size) for size in (10**4, 10**4, 5 * 10**4))
    assert (
        complaint("profile", k=k, phi=phi, r=r)
        == "5000000000000 points take 4e+04 GB of memory; name a Zarr store, out"
    )


@parametrize(
    "module, package, what, extra",
    [
        *text_cells("""
    plgwear_jax.sweep       xarray      sweeps              sweep
    plgwear_jax.plots.maps  xarray      pictures of sweeps  sweep
    plgwear_jax.plots       matplotlib  pictures            plots
    """)
    ],
)
def test_what_lacks_its_extra_says_so_however_it_is_imported(monkeypatch, module, package, what, extra):
    for name in [name for name in sys.modules if name.startswith(module)]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ModuleNotFoundError) as lacking:
        importlib.import_module(module)
    line = f"{what} need the extra {extra} ({package} is missing)"
    assert str(lacking.value) == f"{line}: pip install 'plgwear-jax[{extra}]', in a clone '.[{extra}]'"
    assert lacking.value.name == package
