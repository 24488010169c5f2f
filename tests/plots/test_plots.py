"""Pictures: what they show, in which units, and that a file is whole or not there."""

import dataclasses
import os
from pathlib import Path
from types import SimpleNamespace

import jax.numpy as jnp
import known
import numpy as np
import pytest
from kinds import dome
from marks import compiled, parametrize
from matplotlib.figure import Figure
from numpy.testing import assert_allclose
from refusals import data

from plgwear_jax import Cone, PowerLawGraded, gross_slip, loads, optimise, plots
from plgwear_jax._core.units import text_cells
from plgwear_jax.fitting import Fit
from plgwear_jax.optimise.question import Limit
from plgwear_jax.plots import designs

FORCE = 0.32
REFERENCE = dome()
LABELS = data("plots/labels.toml")


def curve(axes, n=0):
    """Abscissae and ordinates of a curve of a panel."""
    x, y = axes.lines[n].get_data()
    return np.asarray(x, float), np.asarray(y, float)


def labels(figure):
    return [[axes.get_xlabel(), axes.get_ylabel()] for axes in figure.axes]


def legend(figure):
    (found,) = figure.legends
    return [text.get_text() for text in found.get_texts()]


@pytest.fixture(scope="module")
def best():
    return optimise.design(REFERENCE, FORCE, {"k": (-0.9, 0.9)}, hold="contact_radius")


@pytest.fixture(scope="module")
def held(best):
    return plots.design_picture(best)


def test_panels_are_labelled_with_symbols_and_units(held):
    assert labels(held) == LABELS["held"]
    assert [axes.get_title(loc="left") for axes in held.axes] == ["(a)", "(b)", "(c)"]
    assert [text.get_text() for text in held.axes[2].texts] == ["$c$", r"$a_\infty$"]
    assert held.axes[1].get_title(loc="right") == "18.4 % less"
    assert legend(held) == ["best, $k = -0.816$", "reference, $k = 0$"]
    assert held.axes[2].get_title(loc="right") == "below the roughness, 50 nm"
    assert_allclose(held.get_figwidth(), 18 / 2.54, rtol=1e-6)


def test_panels_show_the_contacts(held, best):
    modulus, wear, depth = held.axes
    z, drawn = curve(modulus)
    assert_allclose(drawn, best.contact.material.modulus(z))
    k, change = curve(wear)
    assert k[0] == -0.9 and k[-1] == 0.9
    assert_allclose(change, 100.0 * (optimise.along(best, "k", k).value / best.reference_value - 1.0), atol=1e-5)
    # Both marks lie on the curve, since the contact radius is held, and the reference is at no change.
    for n, (where, what) in enumerate([(0.0, 0.0), (best.variables["k"], -100.0 * best.saving)]):
        assert_allclose(curve(wear, 1 + n), [[where], [what]])
    for n, contact in enumerate((best.contact, REFERENCE)):
        its = contact.steady(FORCE)
        r, worn = curve(depth, 3 * n)
        assert_allclose(worn, its.wear_depth(r), atol=1e-15)
        edges = [curve(depth, 3 * n + one)[0][0] for one in (1, 2)]
        assert_allclose(edges, [its.stick_radius, its.worn_radius], rtol=1e-12)


def test_a_picture_costs_one_batch_of_contacts(best, monkeypatch):
    asked = []
    along = designs.evaluated_along
    monkeypatch.setattr(designs, "evaluated_along", lambda *one: asked.append(one[2]) or along(*one))
    monkeypatch.setattr(optimise, "design", lambda *_, **__: pytest.fail("it searches"))
    plots.design_picture(best)
    assert len(asked) == 1 and asked[0].size <= 35


@compiled
def test_characteristic_depth_is_drawn_where_it_alone_varies():
    wear = plots.design_picture(optimise.design(dome(0.3), [0.2, FORCE], {"z0": (1e-5, 1e-3)})).axes[1]
    assert wear.get_xlabel() == "characteristic depth $z_0$ (mm)" and wear.get_xscale() == "log"
    assert wear.get_ylabel().startswith("change of mean wear volume (%)")
    z0, _ = curve(wear)
    assert_allclose([z0[0], z0[-1]], [1e-5, 1e-3])


@compiled
def test_limits_of_the_modulus_are_drawn_as_bars_with_their_values():
    limits = {"modulus_at": {"between": (60e9, 400e9), "z": 1e-5}}
    figure = plots.design_picture(
        optimise.design(REFERENCE, FORCE, {"k": (-0.5, 0.5), "E0": (5e10, 2e11)}, limits=limits)
    )
    modulus, change, _ = figure.axes
    assert change.get_xlabel() == "exponent $k$\nall else as in the best design"
    assert "allowed modulus: 60 to 400 GPa" in legend(figure)
    ((bar,),) = (lines.get_segments() for lines in modulus.collections)
    assert_allclose(bar, [(1e-5, 6e10), (1e-5, 4e11)])


@compiled
def test_what_breaks_a_limit_is_drawn_as_such():
    limits = {"contact_radius": {"above": 7e-5}}
    wear = plots.design_picture(optimise.design(REFERENCE, FORCE, {"k": (-0.5, 0.5)}, limits=limits)).axes[1]
    k, kept = curve(wear)
    assert np.array_equal(np.isfinite(kept), np.asarray(dome(k).steady(0.0).contact_radius) >= 7e-5 * (1.0 - 1e-6))
    assert 0 < np.isfinite(kept).sum() < k.size
    assert legend(wear.figure)[-1] == "breaks a limit"
    saved, limits, contact, symbols = wear.figure.get_supxlabel().splitlines()
    assert saved.endswith("wear volume than the reference, which breaks a limit")
    assert limits == "limits: contact radius at least 70 µm"
    assert (
        contact == r"amplitude $F_x$ = 320 mN (8 % of $\mu F_N$), $F_N$ = 10 N, $\mu$ = 0.4, $R$ = 5 mm, rigid indenter"
    )
    assert symbols.startswith("$a_0$: contact radius before wear; $c$, ")


@compiled
def test_a_worn_punch_is_drawn():
    design = known.punch_design()
    figure = plots.design_picture(design)
    assert labels(figure) == LABELS["punch"]
    k, change = curve(figure.axes[1])
    drop = np.asarray(gross_slip.force_drop(k)) / gross_slip.force_drop(-0.5)
    assert_allclose(change, 100.0 * (drop - 1.0), atol=0.03)  # what cubics leave near k = -1
    r, worn = curve(figure.axes[2])
    exact = 1e-6 - design.contact.steady().steady_displacement(r)
    assert_allclose(worn, exact, rtol=1e-5, atol=1e-20)  # enough for a picture


@compiled
def test_the_end_of_a_run_is_drawn_as_its_steady_state():
    run = REFERENCE.over_cycles(FORCE, 1e-14)
    figure = plots.wear_picture(run, np.geomspace(1e3, 1e7, 20), [1e5])
    by_ordinate = {axes.get_ylabel().split(" (")[0]: axes for axes in figure.axes}
    for label, field in (("wear depth", run.steady.wear_depth), ("pressure", run.steady.pressure)):
        (end,) = (line for line in by_ordinate[label].lines if line.get_label() == "steady state")
        r, drawn = np.asarray(end.get_data(), float)
        beside = np.abs(r / run.steady.stick_radius - 1.0) > 1e-6  # at the edge a rounding is a step
        seen = beside & (drawn < by_ordinate[label].get_ylim()[1])
        assert_allclose(drawn[seen], field(r[seen]), rtol=1e-3, atol=1e-3 * drawn[seen].max())
    assert legend(figure)[1:3] == ["worn volume", "before wear"] and "steady state" in legend(figure)


@compiled
def test_a_run_of_a_pointed_indenter_is_drawn():
    run = dome(shape=Cone(0.01)).over_cycles(3.6, 1e-14)
    low, high = plots.wear_picture(run, np.geomspace(1e3, 1e7, 20), [1e5]).axes[-1].get_ylim()
    assert low == 0.0 and np.isfinite(high)


def test_no_radius_of_a_block_is_cut_off():
    blocks = loads.Blocks([loads.Block(1.0, 1e5), loads.Block(2.0, 1e4)])
    values = np.array([[1e-18, 3e-18], [0.5, 2.0], [1e-4, 2e-4], [6e-5, 0.0]])
    names = "volume", "force_amplitude", "contact_radius", "stick_radius"
    read = {name: lambda _, row=row: row for name, row in zip(names, values, strict=True)}
    figure = plots.blocks_picture(SimpleNamespace(load=blocks, **read))
    for axes in figure.axes:
        low, high = axes.get_ylim()
        assert low == 0.0 and high > 1.01 * axes.dataLim.y1 and not axes.get_legend()
    drawn = np.array([line.get_data() for axes in figure.axes for line in axes.lines])
    assert_allclose(drawn[:, 0], np.tile([0.0, 1e5, 1.1e5], (4, 1)))
    assert_allclose(drawn[:, 1], np.insert(values, 0, [0.0, *values[1:, 0]], axis=1))


def test_a_run_is_drawn_beside_the_wear_of_its_first_cycles():
    start = SimpleNamespace(profile=lambda r: r, initial_pressure=lambda r: 1e9 + 0.0 * r)
    run = SimpleNamespace(
        volume=lambda n: 1e-20 * np.sqrt(n),
        stick_radius=lambda n: 5e-5,
        contact_radius=lambda n: 1e-4,
        depth=lambda r, n: 1e-6 * n * r,
        pressure=lambda r, n: 0.0 * n * r,
        final=SimpleNamespace(volume=1e-16),
        lasting_cycles=1e9,
        contact=SimpleNamespace(steady=lambda _: start),
    )
    figure = plots.wear_picture(run, np.array([1e4, 1e6]), [1e6])
    volumes, profiles, _, depths = figure.axes
    assert_allclose([curve(volumes, n)[1] for n in (0, 1)], [[1e-18, 1e-16], [1e-18, 1e-17]])
    assert "1,000,000 cycles (10 %)" in legend(figure)
    r, drawn = curve(profiles, 1)
    assert_allclose([drawn, curve(depths, 2)[1]], [2.0 * r, r])


def test_a_fit_is_drawn_with_its_interval_and_what_it_leaves():
    cycles, volume = np.array([1e4, 3e4]), np.array([2e-18, 5e-18])
    curves = np.array([[1.0], [0.8], [1.3]]) * volume
    fit = Fit(1e-14, (9e-15, 2e-14), cycles, volume, 0.9 * volume, 0.1 * volume, None, None, cycles, curves)
    left, right = plots.fit_picture(fit).axes
    assert_allclose(curve(left), [cycles, volume])
    assert_allclose(left.collections[0].get_datalim(left.transData).get_points(), [[1e4, 1.6e-18], [3e4, 6.5e-18]])
    for axes, points in ((left, volume), (right, np.full(2, 100.0 / 9.0))):  # in percent of the fitted ones
        assert_allclose(axes.containers[0][0].get_data(), [cycles, points])


def test_a_coating_is_drawn_as_given_and_as_its_power_law():
    z, law = np.geomspace(1e-6, 1e-4, 3), PowerLawGraded(1e11, 1e-5, 0.5, 0.3)
    radii, depths = np.arange(1.0, 9.0).reshape(2, 2, 2)
    fit = SimpleNamespace(material=law, depth=z, modulus=z, felt=(7e-6, 2e-4))
    both = SimpleNamespace(quantities={"contact_radius": radii[:, 1]}, radii=radii, wear_depth=depths)
    modulus, influence, worn = plots.coating_picture(fit, (z, 3e11 * z), (z, 2.0 * z), both).axes
    assert_allclose([curve(modulus, n)[1] for n in (0, 1)], [3e11 * z, law.modulus(z)])
    assert_allclose(curve(influence, 1), [z, 2.0 * z])
    assert_allclose([np.ravel(axes.patches[0].get_xy())[0] for axes in (modulus, influence)], 7e-6)
    assert_allclose([worn.lines[n].get_ydata()[-1] for n in (0, 3)], depths[:, 1])


def test_a_front_is_drawn_with_the_reference_and_what_is_uncertain():
    variables = {"E0": jnp.array([4e11, 2e11, 1e11]), "k": jnp.array([0.5, 0.0, -0.5])}
    front = known.front(
        variables=variables,
        at_bound=dict.fromkeys(variables, jnp.array([1, 0, 0])),
        active={"stiff": jnp.array([False, False, True])},
        limits=(Limit(1e11, {"z": 5e-6}, "modulus_at", "stiff", True),),
    )
    figure = plots.front_picture(front)
    assert figure.get_supxlabel().splitlines() == [
        "pressure 1 µm inside the stick-slip boundary (MPa)",
        "least edge pressure: E0 at its upper bound, k at its upper bound",
        "least wear volume: lowest modulus at 5 µm allowed",
    ]
    assert labels(figure) == [
        ["", words] for words in (r"wear volume $\Delta V$ (µm³)", "modulus $E_0$ (GPa)", "exponent $k$")
    ]
    along, reference = (np.asarray(line.get_xydata()) for line in figure.axes[0].lines)
    assert_allclose(along, [[1e8, 5e-18], [2e8, 3e-18], [4e8, 2e-18]])
    assert_allclose(reference, [[3e8, 4e-18]])
    (dots,) = figure.axes[0].collections
    assert_allclose(dots.get_offsets(), along)
    assert np.all(dots.get_facecolors() == 1.0, axis=1).tolist() == [False, True, False]
    assert legend(figure) == ["least wear volume for this edge pressure", "reference"]
    told = plots.front_picture(dataclasses.replace(front, at_bound={})).get_supxlabel()
    assert told.splitlines()[1] == "least edge pressure"


@parametrize(
    "size, unit, factor, prefixed",
    [
        *text_cells("""
    6.8e-5  m    1e-6   µm
    -3e-9   m    1e-9   nm
    1e-20   m    1e-12  pm
    0.0     m    1.0    m
    3e-18   m^3  1e-18  µm³
    2e-10   m^3  1e-9   mm³
    0.32    N    1e-3   mN
    0.32    1    1.0    -
    """)
    ],
)
def test_readable_units(size, unit, factor, prefixed):
    assert plots.readable(float(size), unit) == (float(factor), prefixed)


@pytest.fixture
def small():
    figure = Figure(figsize=(1, 1))
    figure.add_subplot().plot([0, 1])
    return figure


@parametrize("name, start", [("a.PNG", b"\x89PNG"), ("a.pdf", b"%PDF"), ("a.svg", b"<?xml")])
def test_suffix_makes_the_format(small, tmp_path, name, start):
    plots.save(small, tmp_path / name)
    assert (tmp_path / name).read_bytes().startswith(start)
    assert os.listdir(tmp_path) == [name]


@parametrize("write", [lambda figure, path: plots.check_target(path), plots.save])
def test_bad_targets_are_refused_in_one_line(small, here, write):
    Path("folder.png").mkdir()
    for target, line in {
        "a.jpg": "a.jpg: must end in .png, .pdf or .svg",
        "a": "a: must end in .png, .pdf or .svg",
        "folder.png": "folder.png: is a folder, not a file to write to",
        "missing/a.png": "missing/a.png: cannot be written: No such file or directory",
        f"{300 * 'a'}.png": f"{300 * 'a'}.png: cannot be written: File name too long",
    }.items():
        with pytest.raises(plots.PictureError) as caught:
            write(small, target)
        assert str(caught.value) == line
    assert os.listdir() == ["folder.png"]


def test_checks_and_failed_writes_keep_the_old_picture_and_leave_no_parts(small, tmp_path, monkeypatch):
    file = tmp_path / "a.png"
    file.write_bytes(b"old")

    def fills_the_disk(target, **_):
        Path(target).write_bytes(b"half")
        raise OSError(28, "No space left on device")

    plots.check_target(file)
    monkeypatch.setattr(small, "savefig", fills_the_disk)
    with pytest.raises(plots.PictureError, match=r"a\.png: cannot be written: No space left on device$"):
        plots.save(small, file)
    assert file.read_bytes() == b"old" and os.listdir(tmp_path) == ["a.png"]
