"""Pictures: what they show, in which units, and that a file is whole or not there."""

import dataclasses
import functools
import os
from pathlib import Path

import jax
import jax.numpy as jnp
import matplotlib
import numpy as np
import pytest
from matplotlib import image
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from plgwear_jax import FrettingContact, GrossSlipContact, PowerLawGraded, gross_slip, optimise, plots, scene
from plgwear_jax.loads import Force
from plgwear_jax.optimise import Design
from plgwear_jax.optimise.question import limits_of, question_of

FORCE = 0.32
REFERENCE = FrettingContact(PowerLawGraded(110e9, 1e-4, 0.0, 0.3), 0.005, 10.0, 0.4)
PUNCH = GrossSlipContact(PowerLawGraded(1e9, 1e-3, -0.5, "holl"), 2e-3, 1e-6)


@functools.cache
def slipping() -> optimise.Design:
    """A design that is quickly found."""
    return optimise.design(PUNCH, None, {"k": (-0.9, 0.9)}, minimise="force_drop")


def designed(bounds, force: float = FORCE, hold=None, limits=None, **material) -> Design:
    """A design of the fretting contact as the optimiser would hand it over, without its search."""
    found = slipping()
    best = dataclasses.replace(REFERENCE, material=dataclasses.replace(REFERENCE.material, **material))
    question = question_of(REFERENCE, force, bounds, hold=hold, limits=limits)
    values = {"E0": 110e9, "z0": 1e-4} | material
    return dataclasses.replace(
        found,
        contact=best,
        value=best.steady(force).wear_volume,
        reference_value=REFERENCE.steady(force).wear_volume,
        minimum=dataclasses.replace(found.minimum, variables={name: values[name] for name in bounds}),
        question=question,
    )


def curve(axes: Axes) -> tuple[np.ndarray, np.ndarray]:
    """Abscissae and ordinates of the first curve of a panel."""
    x, y = axes.lines[0].get_data()
    return np.asarray(x), np.asarray(y)


def best_held() -> Design:
    return designed({"k": (-0.9, 0.9)}, hold="contact_radius", k=-0.816, E0=31.546e9)


@pytest.fixture(scope="module")
def held() -> Figure:
    return plots.design_picture(best_held())


def test_panels_are_labelled_with_symbols_and_units(held):
    labels = [(axes.get_xlabel(), axes.get_ylabel()) for axes in held.axes]
    assert labels == [
        ("depth $z$ (µm)", "Young's modulus $E(z)$ (GPa)"),
        ("exponent $k$", r"wear volume $\Delta V$ (µm³)"),
        ("radius $r$ (µm)", "wear depth (nm)"),
    ]
    assert [axes.get_title(loc="left") for axes in held.axes] == ["(a)", "(b)", "(c)"]
    assert [text.get_text() for text in held.axes[2].texts] == ["$c$", "$c$", r"$a_\infty$", r"$a_\infty$"]
    assert held.axes[1].get_title(loc="right") == "best: 18.4 % less"
    (legend,) = held.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        "best, $k = -0.816$",
        "reference, $k = 0$",
    ]
    assert held.get_figwidth() == pytest.approx(18 / 2.54)


def test_a_mean_over_amplitudes_is_called_so():
    best = best_held()
    for weight, word in (([0.3, 0.7], "mean wear volume"), ([1.0, 0.0], "wear volume")):
        load = optimise.WeightedLoad(Force(np.array([2.0, 0.4])), np.array(weight))
        question = dataclasses.replace(best.question, load=load)
        label = plots.design_picture(dataclasses.replace(best, question=question)).axes[1].get_ylabel()
        assert label.startswith(f"{word} $")


def test_panels_show_the_contacts(held):
    modulus, wear, depth = held.axes
    best = best_held().contact
    z, modulus_of_best = curve(modulus)
    np.testing.assert_allclose(modulus_of_best * 1e9, best.material.modulus(z * 1e-6))
    k, volume = curve(wear)
    assert k[0] == -0.9 and k[-1] == 0.9
    at_zero = np.interp(0.0, k, volume) * 1e-18
    np.testing.assert_allclose(at_zero, REFERENCE.steady(FORCE).wear_volume, rtol=1e-3)
    # Both marks lie on the curve, since the contact radius is held.
    for mark in wear.lines[1:]:
        (where,), (what,) = mark.get_data()
        assert what == pytest.approx(np.interp(where, k, volume), rel=1e-2)
    r, worn = curve(depth)
    np.testing.assert_allclose(worn * 1e-9, best.steady(FORCE).wear_depth(r * 1e-6), atol=1e-15)
    edges = sorted(line.get_xdata()[0] for line in depth.lines if len(line.get_xdata()) == 2)
    expected = [contact.steady(FORCE).stick_radius for contact in (best, REFERENCE)]
    expected += [contact.steady(FORCE).worn_radius for contact in (REFERENCE, best)]
    np.testing.assert_allclose(edges, np.array(expected) * 1e6, rtol=1e-12)


@pytest.mark.compiled
def test_characteristic_depth_is_drawn_where_it_alone_varies():
    reference = dataclasses.replace(REFERENCE, material=PowerLawGraded(110e9, 1e-4, 0.3, 0.3))
    design = designed({"z0": (1e-5, 1e-3)}, z0=1e-5, k=0.3)
    design = dataclasses.replace(design, question=dataclasses.replace(design.question, contact=reference))
    wear = plots.design_picture(design).axes[1]
    assert wear.get_xlabel() == "characteristic depth $z_0$ (mm)" and wear.get_xscale() == "log"
    z0, volume = curve(wear)
    np.testing.assert_allclose([z0[0], z0[-1]], [0.01, 1.0])
    np.testing.assert_allclose(volume[0] * 1e-18, design.value, rtol=1e-12)


@pytest.mark.compiled
def test_nothing_held_draws_the_wear_of_the_modulus_as_it_is():
    best = designed({"k": (-0.5, 0.5)}, k=0.5)
    k, volume = curve(plots.design_picture(best).axes[1])
    np.testing.assert_allclose(volume[-1] * 1e-18, best.value, rtol=1e-12)
    assert k[-1] == 0.5


@pytest.mark.compiled
def test_moduli_at_two_depths_are_drawn_with_their_windows():
    window = [{"between": (low, high), "z": z} for z, low, high in ((2e-5, 50e9, 500e9), (1e-3, 70e9, 300e9))]
    design = designed({"k": (-0.4, 0.4), "E0": (60e9, 400e9)}, limits={"modulus_at": window}, k=0.1)
    modulus, wear, *_ = plots.design_picture(design).axes
    assert wear.get_xlabel() == "exponent $k$; best $E_0$ for each"
    bars = [line.get_xydata() for line in modulus.lines if line.get_marker() == "_"]
    expected = [(20, 50, 500), (1000, 70, 300)]
    assert jax.jit(lambda design: design)(design).windows == design.windows
    np.testing.assert_allclose(bars, [[(z, low), (z, high)] for z, low, high in expected])
    deepest = curve(modulus)[0][-1]
    assert deepest == pytest.approx(2000.0)


def test_large_volumes_carry_their_power_of_ten_in_the_label():
    figure = plots.design_picture(designed({"k": (-0.5, 0.5)}, force=3.9, k=0.5))
    assert figure.axes[1].get_ylabel() == r"wear volume $\Delta V$ ($10^{5}$ µm³)"


def test_the_style_for_pictures_of_your_own_does_not_move_panels_of_ours():
    with matplotlib.rc_context():
        plots.use_style()
        assert plots.design_picture(designed({"k": (-0.5, 0.5)}, k=0.5)).get_layout_engine() is None


@pytest.mark.compiled
def test_a_worn_punch_is_drawn():
    design = slipping()
    labels = [(axes.get_xlabel(), axes.get_ylabel()) for axes in plots.design_picture(design).axes]
    assert labels == [
        ("depth $z$ (mm)", "Young's modulus $E(z)$ (GPa)"),
        ("exponent $k$", r"normal force lost $1-F_{N\infty}/F_{N0}$"),
        ("radius $r$ (mm)", r"worn off the face, $d - w_\infty$ (µm)"),
    ]
    _, drop, punch = plots.design_picture(design).axes
    k, share = curve(drop)
    np.testing.assert_allclose(share, gross_slip.force_drop(k), rtol=1e-12)
    r, worn = curve(punch)
    assert isinstance(design.contact, GrossSlipContact)
    exact = 1e-6 - design.contact.steady_displacement(r * 1e-3)
    np.testing.assert_allclose(worn * 1e-6, exact, rtol=1e-5, atol=1e-20)  # enough for a picture


def test_a_front_is_drawn_with_the_reference_and_what_is_uncertain():
    front = optimise.Front(
        x=jnp.array([1e8, 2e8, 4e8]),
        y=jnp.array([5e-18, 3e-18, 2e-18]),
        variables={"E0": jnp.array([4e11, 2e11, 1e11]), "k": jnp.array([0.5, 0.0, -0.5])},
        at_bound={"E0": jnp.array([1, 0, 0]), "k": jnp.array([1, 0, 0])},
        active={"contact_radius_lowest": jnp.array([False, False, True])},
        converged=jnp.array([True, True, True]),
        certified=jnp.array([True, False, True]),
        reference_x=jnp.array(3e8),
        reference_y=jnp.array(4e-18),
        x_places={"distance": 1e-6},
        y_places={},
        x_name="edge_pressure",
        y_name="wear_volume",
    )
    figure = plots.front_picture(front)
    assert figure.get_suptitle() == "" and figure.get_supxlabel() == "pressure 1 µm inside the stick edge (MPa)"
    assert [axes.get_ylabel() for axes in figure.axes] == [
        r"wear volume $\Delta V$ (µm³)",
        "modulus $E_0$ (GPa)",
        "exponent $k$",
    ]
    drawn = [np.asarray(line.get_xydata()).round(9).tolist() for line in figure.axes[0].lines]
    along, certain, uncertain, reference = drawn
    assert along == [[100, 5], [200, 3], [400, 2]]
    assert certain == [[100, 5], [400, 2]] and uncertain == [[200, 3]] and reference == [[300, 4]]
    legend = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert legend == ["least wear volume for this edge pressure", "reference"]
    assert [text.get_text() for text in figure.axes[0].texts] == [
        "E0 at its upper bound\nk at its upper bound",
        "lowest contact radius allowed",
    ]
    assert figure.axes[0].get_ylim()[1] > 6.0  # nothing is cut, and the legend has room


@pytest.mark.parametrize(
    "size, unit, expected",
    [
        (6.8e-5, "m", (1e-6, "µm")),
        (1e-3, "m", (1e-3, "mm")),
        (-3e-9, "m", (1e-9, "nm")),
        (1e-20, "m", (1e-12, "pm")),
        (0.0, "m", (1.0, "m")),
        (3e-18, "m^3", (1e-18, "µm³")),
        (2e-10, "m^3", (1e-9, "mm³")),
        (2e11, "Pa", (1e9, "GPa")),
        (0.32, "N", (1e-3, "mN")),
        (0.32, "1", (1.0, "")),
        (-0.5, "1", (1.0, "")),
    ],
)
def test_readable_units(size, unit, expected):
    assert plots.readable(size, unit) == expected


@pytest.fixture
def small() -> Figure:
    figure = Figure(figsize=(1, 1))
    figure.add_subplot().plot([0, 1])
    return figure


def test_png_of_a_design_is_valid(held, tmp_path):
    file = tmp_path / "design.png"
    plots.save(held, file)
    pixels = image.imread(file)
    assert pixels.shape[1] == pytest.approx(18 / 2.54 * 300, abs=2)
    assert 0.5 < pixels[..., :3].mean() < 1.0  # ink on white
    assert os.listdir(tmp_path) == ["design.png"]


@pytest.mark.parametrize("name, start", [("a.PNG", b"\x89PNG"), ("a.pdf", b"%PDF"), ("a.svg", b"<?xml")])
def test_suffix_makes_the_format(small, tmp_path, name, start):
    plots.save(small, tmp_path / name)
    assert (tmp_path / name).read_bytes().startswith(start)
    assert os.listdir(tmp_path) == [name]


@pytest.mark.parametrize("write", [lambda figure, path: plots.check_target(path), plots.save])
def test_bad_targets_are_refused_in_one_line(small, tmp_path, monkeypatch, write):
    monkeypatch.chdir(tmp_path)
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


def test_check_leaves_an_old_picture_alone(tmp_path):
    file = tmp_path / "a.png"
    file.write_bytes(b"old")
    plots.check_target(file)
    assert file.read_bytes() == b"old" and os.listdir(tmp_path) == ["a.png"]


def test_failed_write_keeps_the_old_picture_and_no_parts(small, tmp_path, monkeypatch):
    file = tmp_path / "a.png"
    file.write_bytes(b"old")

    def fills_the_disk(target, **_):
        Path(target).write_bytes(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(small, "savefig", fills_the_disk)
    with pytest.raises(plots.PictureError, match=r"a\.png: cannot be written: No space left on device$"):
        plots.save(small, file)
    assert file.read_bytes() == b"old" and os.listdir(tmp_path) == ["a.png"]


@pytest.mark.compiled
def test_what_breaks_a_limit_is_drawn_as_such():
    design = designed({"k": (-0.5, 0.5)}, k=0.2)
    limits = limits_of({"contact_radius": {"above": 7e-5}}, "fretting")
    state = optimise.LimitState(jnp.asarray(7.1e-5), 7e-5, jnp.asarray(0.0), "contact_radius", True)
    question = dataclasses.replace(design.question, limits=limits)
    wear = plots.design_picture(
        dataclasses.replace(design, question=question, limits={"contact_radius_lowest": state})
    ).axes[1]
    k, volume = curve(wear)
    radius = [
        dataclasses.replace(REFERENCE, material=PowerLawGraded(110e9, 1e-4, x, 0.3)).steady(0.0).contact_radius
        for x in k
    ]
    assert np.array_equal(np.isfinite(volume), np.array(radius) >= 7e-5) and 0 < np.isfinite(volume).sum() < len(k)
    (legend,) = wear.get_legend().get_texts()
    assert legend.get_text() == "breaks a limit"


@pytest.mark.compiled
def test_a_second_variable_is_chosen_again_so_that_the_optimum_lies_on_the_curve():
    design = scene.load(Path(__file__).parents[2] / "design" / "hip_taper.toml").design()
    wear = plots.design_picture(design).axes[1]
    modulus, volume = curve(wear)
    assert np.isfinite(volume).all()
    assert np.nanmin(volume) == pytest.approx(float(design.value) * 1e18, rel=1e-6)
    at = np.interp(float(design.variables["shallow_modulus"]) / 1e9, modulus, volume)
    assert at == pytest.approx(float(design.value) * 1e18, rel=1e-6)
    # along the reference's modulus the best other one wears no more than the reference
    there = np.interp(float(design.reference_variables["shallow_modulus"]) / 1e9, modulus, volume)
    assert there < float(design.reference_value) * 1e18
