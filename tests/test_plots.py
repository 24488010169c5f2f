"""Pictures: what they show, in which units, and that a file is whole or not there."""

import dataclasses
import os
from pathlib import Path

import numpy as np
import pytest
from matplotlib import image
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from plgwear_jax import FrettingContact, PowerLawGraded, plots
from plgwear_jax.optimise import Design

FORCE = 0.32
REFERENCE = FrettingContact(PowerLawGraded(110e9, 1e-4, 0.0, 0.3), 0.005, 10.0, 0.4)


def designed(**material: float) -> Design:
    """A design as the optimiser would hand it over, without the search."""
    best = dataclasses.replace(REFERENCE, material=dataclasses.replace(REFERENCE.material, **material))
    volumes = best.wear_volume(FORCE), REFERENCE.wear_volume(FORCE)
    return Design(best, REFERENCE, material, *volumes, dict.fromkeys(material), True, True)


def curve(axes: Axes) -> tuple[np.ndarray, np.ndarray]:
    """Abscissae and ordinates of the first curve of a panel."""
    x, y = axes.lines[0].get_data()
    return np.asarray(x), np.asarray(y)


@pytest.fixture(scope="module")
def held() -> Figure:
    return plots.design_picture(designed(k=-0.816, E0=31.5e9), FORCE, {"k": (-0.9, 0.9)}, hold="contact_radius")


def test_panels_are_labelled_with_symbols_and_units(held):
    labels = [(axes.get_xlabel(), axes.get_ylabel()) for axes in held.axes]
    assert labels == [
        ("depth $z$ (µm)", "Young's modulus $E(z)$ (GPa)"),
        ("exponent $k$", r"wear volume $\Delta V$ (µm³)"),
        ("", r"profile $f_\infty$ (nm)"),
        ("radius $r$ (µm)", r"$f_\infty - f_0$ (nm)"),
    ]
    assert [axes.get_title(loc="left") for axes in held.axes] == ["(a)", "(b)", "(c)", ""]
    (legend,) = held.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        "best, $k = -0.816$",
        "reference, $k = 0$",
        "unworn indenter",
    ]
    assert held.get_figwidth() == pytest.approx(18 / 2.54)


def test_panels_show_the_contacts(held):
    modulus, wear, _, depth = held.axes
    best = designed(k=-0.816, E0=31.5e9).contact
    z, modulus_of_best = curve(modulus)
    np.testing.assert_allclose(modulus_of_best * 1e9, best.material.modulus(z * 1e-6))
    k, volume = curve(wear)
    assert k[0] == -0.9 and k[-1] == 0.9
    at_zero = np.interp(0.0, k, volume) * 1e-18
    np.testing.assert_allclose(at_zero, REFERENCE.wear_volume(FORCE), rtol=1e-3)
    # Both marks lie on the curve, since the contact radius is held.
    for mark in wear.lines[1:]:
        (where,), (what,) = mark.get_data()
        assert what == pytest.approx(np.interp(where, k, volume), rel=1e-2)
    r, worn = curve(depth)
    np.testing.assert_allclose(worn * 1e-9, best.wear_depth(r * 1e-6, FORCE), atol=1e-15)
    edges = sorted(line.get_xdata()[0] for line in depth.lines if len(line.get_xdata()) == 2)
    expected = [contact.stick_radius(FORCE) for contact in (best, REFERENCE)]
    expected += [contact.worn_radius(FORCE) for contact in (REFERENCE, best)]
    np.testing.assert_allclose(edges, np.array(expected) * 1e6, rtol=1e-12)


def test_characteristic_depth_is_drawn_where_it_alone_varies():
    figure = plots.design_picture(designed(z0=1e-5), FORCE, {"z0": (1e-5, 1e-3)})
    wear = figure.axes[1]
    assert wear.get_xlabel() == "characteristic depth $z_0$ (mm)" and wear.get_xscale() == "log"
    z0, _ = curve(wear)
    np.testing.assert_allclose([z0[0], z0[-1]], [0.01, 1.0])


def test_nothing_held_draws_the_wear_of_the_modulus_as_it_is():
    best = designed(k=0.5)
    k, volume = curve(plots.design_picture(best, FORCE, {"k": (-0.5, 0.5)}).axes[1])
    np.testing.assert_allclose(volume[-1] * 1e-18, best.wear_volume, rtol=1e-12)
    assert k[-1] == 0.5


def test_large_volumes_carry_their_power_of_ten_in_the_label():
    force = 3.9
    figure = plots.design_picture(designed(k=0.5), force, {"k": (-0.5, 0.5)})
    assert figure.axes[1].get_ylabel() == r"wear volume $\Delta V$ ($10^{5}$ µm³)"


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
        "folder.png": "folder.png: is a folder, not a file to write a picture to",
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
