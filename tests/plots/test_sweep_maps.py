"""Pictures of sweeps: they show the values, on fitting scales, in readable units, and read no more than is seen."""

import itertools
import re

import dask.array as da
import numpy as np
import pytest
import xarray as xr
from functions import values
from matplotlib.collections import QuadMesh
from matplotlib.colors import AsinhNorm, CenteredNorm, LogNorm, Normalize
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from optima import optima

from plgwear_jax import FrettingContact, PowerLawGraded, plots, sweep
from plgwear_jax.catalogue import AXES
from plgwear_jax.plots.maps import MapError, map_picture
from plgwear_jax.plots.style import plain_ticks
from plgwear_jax.sweep.axes import read_axis

K, PHI = np.linspace(-0.9, 0.9, 13), np.linspace(0.1, 0.9, 9)
CONTACT = FrettingContact(PowerLawGraded(110e9, 1e-4, 0.0, 0.3), 0.005, 10.0, 0.4)


def made(values, name="penetration", units="1", attrs=None, unfinished=None, axis_units=None, **axes) -> xr.Dataset:
    """A sweep as it would be if the quantity had these values."""
    coords = {}
    for axis, row in axes.items():
        unit = (axis_units or {}).get(axis, AXES[axis].unit if axis in AXES else None)
        coords[axis] = (axis, row, {"units": unit} if unit else {})
    found = xr.Dataset({name: (tuple(axes), values, {"units": units, **(attrs or {})})}, coords)
    return found if unfinished is None else found.assign_attrs(unfinished=unfinished)


def plane(*rows: np.ndarray) -> np.ndarray:
    """Positive values of less than two decades, which rise along each axis."""
    return 2.0 + sum(np.ix_(*((row - row[0]) / (row[-1] - row[0]) for row in rows)))


def mesh(figure: Figure) -> QuadMesh:
    (found,) = (artist for artist in figure.axes[0].collections if isinstance(artist, QuadMesh))
    return found


def lines_at_levels(figure: Figure) -> ContourSet | None:
    found = [artist for artist in figure.axes[0].collections if isinstance(artist, ContourSet)]
    return found[0] if found else None


def entries(figure: Figure) -> list[str]:
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def line(figure: Figure, label: str) -> tuple[np.ndarray, np.ndarray]:
    (found,) = (artist for artist in figure.axes[0].lines if artist.get_label() == label)
    x, y = found.get_data()
    return np.asarray(x), np.asarray(y)


def title(figure: Figure) -> str:
    return figure.get_suptitle().replace("\N{NO-BREAK SPACE}", " ")


# --- maps -----------------------------------------------------------------------------------------------------------


def test_a_map_shows_the_values_with_the_amplitude_across_and_k_upwards():
    values = plane(K, PHI)
    figure = map_picture(
        made(values, "wear_volume", "a_0^4/R", {"equation": "28", "long_name": "volume"}, k=K, phi=PHI)
    )
    drawn = mesh(figure)
    np.testing.assert_array_equal(drawn.get_array(), values)
    corners = drawn.get_coordinates()
    middles = 0.5 * (PHI[1:] + PHI[:-1])
    np.testing.assert_allclose(corners[0, :, 0], [PHI[0], *middles, PHI[-1]], rtol=1e-14)
    np.testing.assert_allclose(corners[:, 0, 1], [K[0], *(0.5 * (K[1:] + K[:-1])), K[-1]], rtol=1e-14, atol=1e-15)
    axes, bar = figure.axes
    assert axes.get_xlabel() == r"amplitude $\varphi = F_x/(\mu F_N)$"
    assert axes.get_ylabel() == "exponent $k$"
    assert bar.get_ylabel() == r"wear volume $\Delta V$ ($a_0^4/R$)"
    assert title(figure) == "volume, Eq. (28)"
    assert (axes.get_xlim(), axes.get_ylim()) == ((PHI[0], PHI[-1]), (K[0], K[-1]))
    assert type(drawn.norm) is Normalize
    assert (drawn.norm.vmin, drawn.norm.vmax) == (2.0, 4.0)
    assert drawn.get_rasterized()
    assert figure.get_size_inches() == pytest.approx([8.6 / 2.54, 7.0 / 2.54])


@pytest.mark.parametrize(
    "axis, unit, label",
    [
        ("material.modulus[1]", "Pa", "modulus 2 $E_{2}$ (GPa)"),
        ("indenter.nu", "1", r"Poisson's ratio of the indenter $\nu_i$"),
        ("displacement", "m", "displacement $u_x$ (µm)"),
        ("shape.bend_of", "1", "shape.bend of"),
    ],
)
def test_axes_are_called_as_in_the_catalogue(axis, unit, label):
    size = {"Pa": 1e11, "m": 1e-6}.get(unit, 0.3)
    rows = {axis: size * np.linspace(1.0, 2.0, 8)}
    axes = map_picture(made(plane(*rows.values()), axis_units={axis: unit}, **rows)).axes[0]
    assert axes.get_xlabel() == label


@pytest.mark.parametrize(
    "across, upwards", [("phi", "k"), ("k", "nu"), ("r", "k"), ("r", "phi"), ("tangential_force", "z0"), ("k", "E0")]
)
def test_either_order_of_the_axes_gives_the_same_picture(across, upwards):
    rows = {across: np.linspace(0.1, 0.4, 8), upwards: np.linspace(0.1, 0.4, 11)}
    values = plane(*rows.values())
    for ds in (made(values, **rows), made(values.T, **dict(reversed(rows.items())))):
        np.testing.assert_array_equal(mesh(map_picture(ds)).get_array(), values.T)


def test_a_falling_or_shuffled_axis_is_put_in_order():
    values = plane(K, PHI)
    shuffled = np.random.default_rng(0).permutation(K.size)
    assert not np.all(np.diff(shuffled) == -1)
    for order in (np.arange(K.size)[::-1], shuffled):
        figure = map_picture(made(values[order], k=K[order], phi=PHI))
        np.testing.assert_array_equal(mesh(figure).get_array(), values)
        assert figure.axes[0].get_ylim() == (K[0], K[-1])


@pytest.mark.parametrize("decades", [0.3, 7.0])
def test_contour_lines_run_where_the_values_are_those_of_their_numbers(decades):
    # the logarithm is a plane, which interpolation does not change; without it, the values are one
    log = decades > 2.0
    share = (plane(K, PHI) - 2.0) / 2.0
    values = 10.0 ** (decades * share) if log else 1.0 + share
    figure = map_picture(made(values, units="a_0", k=K, phi=PHI), contours=6)
    lines = lines_at_levels(figure)
    assert lines is not None
    assert 3 <= len(lines.allsegs) <= 9
    norm = mesh(figure).norm
    assert isinstance(norm, LogNorm) is log
    for height, segments in zip(lines.levels, lines.allsegs, strict=True):
        level = float(norm.inverse(height))
        for x, y in np.concatenate(segments):
            here = 0.5 * ((x - PHI[0]) / 0.8 + (y - K[0]) / 1.8)
            assert here == pytest.approx(np.log10(level) / decades if log else level - 1.0, abs=1e-9)
    numbers = [text.get_text() for text in lines.labelTexts]
    assert numbers
    levels = [f"{float(norm.inverse(height)):.6g}" for height in lines.levels]
    for number in numbers:
        power = re.fullmatch(r"\$10\^\{(\d)\}\$", number)
        assert (f"{10.0 ** int(power[1]):.6g}" if power else number) in levels
    assert lines_at_levels(map_picture(made(values, k=K, phi=PHI), contours=0)) is None


def test_more_than_two_decades_of_positive_values_have_logarithmic_colours_and_zero_the_lowest():
    values = 10.0 ** (3.0 * (plane(K, PHI) - 2.0))
    values[0, 0] = 0.0
    drawn = mesh(map_picture(made(values, "wear_volume", "a_0^4/R", k=K, phi=PHI)))
    assert isinstance(drawn.norm, LogNorm)
    assert (drawn.norm.vmin, drawn.norm.vmax) == (values[values > 0.0].min(), values.max())
    np.testing.assert_array_equal(drawn.get_array(), np.maximum(values, drawn.norm.vmin))
    assert not np.ma.getmaskarray(drawn.get_array()).any()
    share = mesh(map_picture(made(values / values.max(), "design.saving", k=K, phi=PHI)))
    assert type(share.norm) is Normalize


def test_values_of_both_signs_have_colours_centred_on_zero_and_a_thick_line_there():
    values = plane(K, PHI) - 2.5
    figure = map_picture(made(values, "optimal_exponent.k.dphi", k=K, phi=PHI))
    norm = mesh(figure).norm
    assert isinstance(norm, CenteredNorm)
    assert (norm.vmin, norm.vmax) == (-1.5, 1.5)
    lines = lines_at_levels(figure)
    assert lines is not None
    thick = [float(norm.inverse(x)) for x, width in zip(lines.levels, lines.get_linewidths(), strict=True) if width > 1]
    assert thick == [0.0]
    rounding = mesh(map_picture(made(plane(K, PHI) - 2.0 - 1e-9, k=K, phi=PHI)))
    assert type(rounding.norm) is Normalize


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_values_crowded_about_zero_are_still_told_apart(sign):
    share = plane(K, PHI) - 2.5
    values = sign * np.sinh(6.0 * share)
    norm = mesh(map_picture(made(values, "wear_volume.dk", "a_0^4/R", k=K, phi=PHI))).norm
    assert isinstance(norm, AsinhNorm)
    assert norm.vmax == -norm.vmin == np.abs(values).max()
    assert float(norm(0.0)) == pytest.approx(0.5)
    negative = -(10.0 ** (2.0 * (plane(K, PHI) - 2.0)))
    figure = map_picture(made(negative, "wear_volume.dk", "a_0^4/R", k=K, phi=PHI))
    norm = mesh(figure).norm
    assert isinstance(norm, AsinhNorm)
    assert (norm.vmin, norm.vmax) == (negative.min(), negative.max())
    numbers = [text.get_text() for text in figure.axes[1].get_yticklabels()]
    assert {"$-10^{4}$", "−1000", "−100", "−10"} <= {*numbers}
    assert figure.axes[1].get_ylim() == pytest.approx((norm.vmin, norm.vmax))


@pytest.mark.parametrize("unfinished, said", [(None, "undefined"), (0, "undefined"), (3, "not computed yet")])
def test_what_is_no_number_is_grey_and_said_to_be(unfinished, said):
    values = plane(K, PHI)
    values[2:5, 3] = np.nan
    figure = map_picture(made(values, unfinished=unfinished, k=K, phi=PHI))
    drawn = mesh(figure).get_array()
    np.testing.assert_array_equal(np.ma.getmaskarray(drawn), np.isnan(values))
    assert entries(figure) == [f"grey: {said}"]
    assert figure.axes[0].get_facecolor()[:3] == pytest.approx((0.86,) * 3)
    nothing = map_picture(made(np.full_like(values, np.nan), unfinished=unfinished, k=K, phi=PHI))
    assert len(nothing.axes) == 1  # no colours
    assert entries(map_picture(made(plane(K, PHI), unfinished=unfinished, k=K, phi=PHI))) == []


def test_values_without_bound_do_not_take_all_the_colours():
    values = plane(np.linspace(0.1, 0.9, 40), np.linspace(0.0, 0.9, 30))
    values[3, 4], values[5, 5] = np.inf, -np.inf
    axes = {"k": np.linspace(0.1, 0.9, 40), "phi": np.linspace(0.0, 0.9, 30)}
    figure = map_picture(made(values, **axes))
    drawn = mesh(figure)
    finite = values[np.isfinite(values)]
    assert drawn.norm.vmax == np.quantile(finite, 0.99)
    assert drawn.norm.vmin == finite.min()
    assert not np.ma.getmaskarray(drawn.get_array()).any()
    assert drawn.colorbar is not None
    assert drawn.colorbar.extend == "both"
    assert entries(figure) == ["scale ends with 99 % of the values"]
    values = -plane(axes["k"], axes["phi"])
    values[3, 4] = 1e4  # a peak, and both signs
    assert mesh(map_picture(made(np.abs(values), units="1", **axes))).norm.vmax == 1e4
    decades = 10.0 ** (3 * (-values - 2))
    decades[2, 2] = np.inf
    figure = map_picture(made(decades, units="Pa", **axes))
    assert isinstance(mesh(figure).norm, LogNorm)
    assert entries(figure) == ["infinite values are left out of the scale"]


def test_yes_and_no_are_two_colours():
    values = plane(K, PHI) > 3.0
    ds = made(values, "optimal_exponent.certified", k=K, phi=PHI)
    figure = map_picture(ds)
    drawn = mesh(figure)
    np.testing.assert_array_equal(drawn.get_array(), values.astype(float))
    assert entries(figure) == ["certified: yes", "no"]
    patches = [patch for patch in figure.legends[0].get_patches() if isinstance(patch, Patch)]
    colours = [drawn.cmap(drawn.norm(x)) for x in (1.0, 0.0)]
    assert [patch.get_facecolor() for patch in patches] == colours
    assert len(figure.axes) == 1
    assert entries(map_picture(ds.assign_attrs(unfinished=2))) == ["certified: yes", "no, or not computed yet"]


# --- scales ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "axis, text, scale",
    [
        ("phi", "0.1:0.9:9", "linear"),
        ("phi", "0:0.99:50", "linear"),
        ("phi", "1e-4:0.5:30:log", "log"),
        ("phi", "1e-4:0.9999:30:logit", "logit"),
        ("k", "-0.999:0.999:30:logit", "function"),
        ("k", "-0.9:0.9:7", "linear"),
        ("z0", "1e-6:1e-3:7:log", "log"),
        ("E0", "1e9:2e11:3", "linear"),
        ("nu", "0:0.5:2", "linear"),
    ],
)
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_an_axis_is_stretched_as_its_values_are_spaced(axis, text, scale, dtype):
    row = read_axis(axis, text).astype(dtype)
    figure = map_picture(made(plane(row), **{axis: row}))
    axes = figure.axes[0]
    assert axes.get_xscale() == scale
    x, y = (np.asarray(z) for z in axes.lines[0].get_data())
    np.testing.assert_array_equal(y, plane(row))
    unit = {"z0": 1e-6 if scale == "log" else 1e-3, "E0": 1e9}.get(axis, 1.0)
    np.testing.assert_allclose(x, row / unit, rtol=1e-6 if dtype == np.float32 else 1e-14)
    screen = axes.transData.transform(np.column_stack([x, np.full(x.size, 2.5)]))[:, 0]
    np.testing.assert_allclose(np.diff(screen), np.ptp(screen) / (row.size - 1), rtol=0.01)
    assert axes.get_xlim() == pytest.approx((x[0], x[-1]))


def test_cells_meet_halfway_on_a_stretched_axis():
    z0, k = np.geomspace(1e-6, 1e-3, 10), read_axis("k", "-0.999:0.999:12:logit")
    figure = map_picture(made(plane(k, z0), k=k, z0=z0))
    corners = mesh(figure).get_coordinates()
    np.testing.assert_allclose(corners[1:-1, 0, 1], 1e6 * np.sqrt(z0[1:] * z0[:-1]), rtol=1e-13)
    depth = np.arctanh(k)
    np.testing.assert_allclose(corners[0, 1:-1, 0], np.tanh(0.5 * (depth[1:] + depth[:-1])), rtol=1e-12, atol=1e-15)
    assert (figure.axes[0].get_xscale(), figure.axes[0].get_yscale()) == ("function", "log")
    assert [text.get_text() for text in figure.axes[0].get_xticklabels()] == [
        *("−0.999", "−0.99", "−0.9"),
        "0",
        *("0.9", "0.99", "0.999"),
    ]
    assert figure.axes[0].get_ylabel() == "characteristic depth $z_0$ (µm)"


def test_ticks_close_to_gross_slip_are_told_apart():
    phi = read_axis("phi", "1e-6:0.999999:40:logit")
    axes = map_picture(made(plane(phi), phi=phi)).axes[0]
    texts = [text.get_text() for text in axes.get_xticklabels()]
    assert texts == ["$10^{-6}$", "0.001", "0.5", "0.999", "$1-10^{-6}$"]
    np.testing.assert_allclose(axes.get_xticks(), [1e-6, 1e-3, 0.5, 0.999, 1 - 1e-6], rtol=1e-12)
    k = read_axis("k", "-0.99999:0.9:40:logit")
    texts = [text.get_text() for text in map_picture(made(plane(k), k=k)).axes[0].get_xticklabels()]
    assert texts == ["$-1+10^{-4}$", "−0.99", "0", "0.9"]
    few = read_axis("phi", "0.15:0.45:12:logit")  # too short for powers of ten
    assert len(map_picture(made(plane(few), phi=few)).axes[0].get_xticks()) >= 3


@pytest.mark.parametrize("first, last", [(1e-6, 9e-4), (4.2e-5, 4.9e-5), (1.1e-5, 9e-5), (2e-7, 3e-1), (8e-4, 8.1e-4)])
def test_a_logarithmic_axis_has_at_least_three_numbers(first, last):
    z0 = np.geomspace(first, last, 9)
    axes = map_picture(made(plane(z0), "wear_volume", "m^3", z0=z0)).axes[0]
    axes.set_xscale("log")
    axes.set_xlim(z0[0] / 1e-6, z0[-1] / 1e-6)
    plain_ticks(axes.xaxis)
    axes.figure.draw_without_rendering()
    lower, upper = axes.get_xlim()
    texts = [label.get_text() for label in axes.get_xticklabels() if lower <= label.get_position()[0] <= upper]
    assert 3 <= len(texts) <= 9 and len({*texts}) == len(texts)


# --- curves ---------------------------------------------------------------------------------------------------------


def test_an_axis_of_few_values_makes_curves_that_grey_prints_tell_apart():
    k = np.array([-0.9, -0.5, 0.0, 0.3, 0.6, 0.9])
    values = plane(PHI, k)
    figure = map_picture(made(values, "stick_radius", "a_0", phi=PHI, k=k))
    axes = figure.axes[0]
    assert entries(figure) == [f"$k$ = {x}" for x in ("−0.9", "−0.5", "0", "0.3", "0.6", "0.9")]
    for curve, column in zip(axes.lines, values.T, strict=True):
        np.testing.assert_array_equal(curve.get_xdata(), PHI)
        np.testing.assert_array_equal(curve.get_ydata(), column)
    dashes = [str(curve._unscaled_dash_pattern) for curve in axes.lines]  # pyright: ignore[reportAttributeAccessIssue]
    assert len(set(dashes)) == len({curve.get_color() for curve in axes.lines}) == k.size
    assert axes.get_ylabel() == "stick radius $c$ ($a_0$)"
    assert figure.get_size_inches() == pytest.approx([8.6 / 2.54, 6.5 / 2.54])
    long = map_picture(made(values, attrs={"long_name": "many words " * 16}, phi=PHI, k=k))  # in three lines
    assert long.get_figheight() == pytest.approx((6.5 + 2 * 0.4) / 2.54)
    more = np.append(k, 0.95)
    assert mesh(map_picture(made(plane(PHI, more), phi=PHI, k=more))).get_array().shape == (more.size, PHI.size)


def test_curves_of_values_with_units_say_these():
    z0 = np.array([1e-6, 1e-5, 2.5e-4])
    assert entries(map_picture(made(plane(K, z0), k=K, z0=z0))) == [
        "$z_0$ = 1 µm",
        "$z_0$ = 10 µm",
        "$z_0$ = 250 µm",
    ]


@pytest.mark.parametrize(
    "values, scale",
    [
        (10.0 ** np.linspace(0, 3, 20), "log"),
        (np.linspace(-1, 1, 20), "linear"),
        (np.sinh(np.linspace(-9, 9, 20)), "asinh"),
    ],
)
def test_a_curve_stands_on_a_fitting_scale(values, scale):
    axes = map_picture(made(values, "wear_volume.dk", "a_0^4/R", phi=np.linspace(0.1, 0.9, 20))).axes[0]
    assert axes.get_yscale() == scale
    np.testing.assert_array_equal(axes.lines[-1].get_ydata(), values)
    assert len(axes.lines) == (1 if scale == "log" else 2)  # a thin one at zero


def test_gaps_of_curves_are_grey_or_said():
    values = np.stack([plane(PHI), plane(PHI)])
    values[:, 3:5] = np.nan
    figure = map_picture(made(values, k=K[:2], phi=PHI))
    assert entries(figure)[2:] == ["grey: undefined"]
    (strip,) = figure.axes[0].patches
    ends = strip.get_extents().transformed(figure.axes[0].transData.inverted())
    np.testing.assert_allclose([ends.x0, ends.x1], [0.35, 0.55])
    values[1, 3:5] = 2.0
    figure = map_picture(made(values, unfinished=1, k=K[:2], phi=PHI))
    assert entries(figure)[2:] == ["gaps: not computed yet"]
    assert not figure.axes[0].patches


def test_a_curve_of_yes_and_no_has_two_steps():
    axes = map_picture(made(PHI > 0.5, "optimal_exponent.proven", phi=PHI)).axes[0]
    assert [text.get_text() for text in axes.get_yticklabels()] == ["no", "yes"]
    np.testing.assert_array_equal(axes.lines[0].get_ydata(), PHI > 0.5)
    assert axes.get_ylabel() == "proven"


def test_loads_have_their_names():
    names = np.array(["belt", "cost in $", "tail"], object)
    values = plane(K, np.arange(3.0))
    ds = made(values, "wear_volume", "m^3", {"long_name": "volume"}, k=K, load_case=names)
    figure = map_picture(ds)
    assert entries(figure) == ["belt", r"cost in \$", "tail"]
    np.testing.assert_allclose(figure.axes[0].lines[1].get_ydata(), values[:, 1], rtol=1e-14)
    assert figure.axes[0].get_ylabel() == r"wear volume $\Delta V$ (m³)"
    one = map_picture(ds, at={"load_case": "tail"})
    np.testing.assert_allclose(one.axes[0].lines[0].get_ydata(), values[:, 2], rtol=1e-14)
    assert title(one) == "volume\nload = tail"
    with pytest.raises(MapError, match=r"^load_case = tial: is not in the sweep; did you mean tail\?$"):
        map_picture(ds, at={"load_case": "tial"})
    alone = map_picture(ds.isel(k=0, drop=True)).axes[0]
    assert [text.get_text() for text in alone.get_xticklabels()] == ["belt", r"cost in \$", "tail"]
    assert (alone.lines[0].get_marker(), alone.lines[0].get_linestyle()) == ("o", "None")
    many = np.array([f"case {number}" for number in range(8)], object)
    figure = map_picture(made(plane(np.arange(8.0), K), load_case=many, k=K))
    assert [text.get_text() for text in figure.axes[0].get_yticklabels()] == list(many)
    assert mesh(figure).get_array().shape == (8, K.size)
    assert figure.axes[0].get_xlabel() == "exponent $k$"


# --- what is chosen -------------------------------------------------------------------------------------------------

Z0 = np.geomspace(1e-5, 1e-3, 8)


def cube() -> xr.Dataset:
    return made(plane(K, PHI, Z0), attrs={"long_name": "shape"}, k=K, phi=PHI, z0=Z0)


def test_values_of_other_axes_are_chosen_and_told():
    figure = map_picture(cube(), at={"z0": Z0[3]})
    np.testing.assert_array_equal(mesh(figure).get_array(), plane(K, PHI, Z0)[:, :, 3])
    assert title(figure) == "shape\n$z_0$ = 71.97 µm"
    figure = map_picture(cube(), at={"z0": "7.5e-5", "k": 0.3})
    np.testing.assert_array_equal(figure.axes[0].lines[0].get_ydata(), plane(K, PHI, Z0)[8, :, 3])
    assert title(figure) == "shape\n$k$ = 0.3, $z_0$ = 71.97 µm (nearest to 75 µm)"
    single = made(plane(K, PHI)[:, :, None], k=K, phi=PHI, z0=[1e-4])
    assert title(map_picture(single)) == "penetration\n$z_0$ = 100 µm"
    np.testing.assert_array_equal(mesh(map_picture(single)).get_array(), plane(K, PHI))


@pytest.mark.parametrize(
    "quantity, at, message",
    [
        ("penetrtion", {}, "penetrtion: is not in the sweep; did you mean penetration?"),
        (
            None,
            {},
            "penetration: choose a value for 1 of its 3 axes: k (-0.9 to 0.9); phi (0.1 to 0.9); z0 (1e-05 to 0.001 m)",
        ),
        (None, {"ph": 0.5}, "ph: is no axis of penetration; did you mean phi?"),
        (None, {"nu": 0.3}, "nu: is no axis of penetration; allowed are k, phi, z0"),
        (None, {"z0": 0.1}, "z0 = 0.1: is outside of the sweep: z0 (1e-05 to 0.001 m)"),
        (None, {"z0": "deep"}, "z0 = deep: is outside of the sweep: z0 (1e-05 to 0.001 m)"),
        (None, {"z0": np.nan}, "z0 = nan: is outside of the sweep: z0 (1e-05 to 0.001 m)"),
        (
            None,
            {"z0": 1e-4, "k": 0, "phi": 0.5},
            "penetration: every axis has a single value; there is nothing to draw",
        ),
    ],
)
def test_what_cannot_be_drawn_is_refused_in_a_line(quantity, at, message):
    with pytest.raises(MapError, match=f"^{re.escape(message)}$"):
        map_picture(cube(), quantity, at=at)


def test_other_refusals():
    with pytest.raises(MapError, match=r"^the sweep holds no quantity$"):
        map_picture(xr.Dataset())
    with pytest.raises(MapError, match=r"^contours = -1: must be >= 0$"):
        map_picture(cube(), contours=-1)
    with pytest.raises(MapError, match=r"^h_N: is a single number, 0.91; there is nothing to draw$"):
        map_picture(xr.Dataset({"h_N": 0.91}))
    assert issubclass(MapError, ValueError)


# --- how much is read -----------------------------------------------------------------------------------------------


def counted(shape, chunks) -> tuple[da.Array, list[int]]:
    """A lazy array of the numbers of its chunks, and how many values were read so far."""
    numbers, read = itertools.count(), []

    def load(block_info=None):
        place = block_info[None]["array-location"]
        size = [last - first for first, last in place]
        read.append(int(np.prod(size)))
        rows = [np.arange(first, last) for first, last in place]
        next(numbers)
        return 1.0 + sum(np.ix_(*rows)) / sum(shape)

    return da.map_blocks(load, chunks=da.core.normalize_chunks(chunks, shape), dtype=float), read


def test_only_what_is_seen_is_read_and_both_ends_are():
    k, phi = np.linspace(-0.9, 0.9, 6_000), np.linspace(0.0, 0.9, 30)
    values, read = counted((6_000, 30), (1, 30))
    ds = made(values, k=k, phi=phi)
    assert not read
    drawn = mesh(map_picture(ds))
    assert 500 <= len(read) <= 1500
    corners = drawn.get_coordinates()
    assert (corners[0, 0, 1], corners[-1, 0, 1]) == (k[0], k[-1])
    array = drawn.get_array()
    assert array.shape == (len(read), 30)
    assert (array[0, 0], array[-1, -1]) == (1.0, 1.0 + (5_999 + 29) / 6_030)

    values, read = counted((6_000,), (1,))
    x, y = (np.asarray(z) for z in map_picture(made(values, k=k)).axes[0].lines[0].get_data())
    assert 1000 <= len(read) == x.size <= 1500
    assert (x[0], x[-1], y[-1]) == (k[0], k[-1], 1.0 + 5_999 / 6_000)
    np.testing.assert_allclose(y, np.interp(x, k, 1.0 + np.arange(6_000) / 6_000), rtol=1e-12)

    values, read = counted((10, 30, 8), (10, 30, 1))
    map_picture(made(values, k=k[:10], phi=phi, z0=Z0), at={"z0": Z0[2]})
    assert sum(read) == 300


# --- the least wear -------------------------------------------------------------------------------------------------

LEAST, AT_BOUND, PLATEAU = "least wear, $k^*$", "$k^*$ at a bound", "5 % more wear"


def worn(rows: dict[str, np.ndarray]) -> np.ndarray:
    k, phi = np.meshgrid(rows["k"], rows["phi"], indexing="ij")
    return np.asarray(values("fretting.wear_volume", k.astype(float), phi.astype(float)))


@pytest.mark.compiled
@pytest.mark.parametrize(
    "rows",
    [
        {"k": np.linspace(-0.9, 0.9, 25), "phi": np.linspace(0.0, 0.99, 20)},
        {"k": np.linspace(-0.4, 0.8, 25, dtype=np.float32), "phi": np.linspace(0.9, 0.9999, 20, dtype=np.float32)},
        {"k": read_axis("k", "-0.999:0.99:25:logit"), "phi": read_axis("phi", "1e-3:0.999:20:logit")},
    ],
)
def test_the_line_of_least_wear_is_that_of_the_optimiser(rows):
    """As well as a parabola through the values of the map tells it."""
    bounds = float(rows["k"][0]), float(rows["k"][-1])
    figure = map_picture(made(worn(rows), "wear_volume", "a_0^4/R", axis_units={}, **rows))
    shown = {*entries(figure)} & {LEAST, AT_BOUND}
    assert AT_BOUND in shown and {*entries(figure)} <= {LEAST, AT_BOUND, PLATEAU}
    for label in shown:
        phi, k = line(figure, label)
        drawn = np.isfinite(phi)
        found = optima(phi[drawn], bounds)
        np.testing.assert_allclose(k[drawn], found.k, atol=0.01 * (bounds[1] - bounds[0]), rtol=0)
        least = values("fretting.wear_volume", k[drawn], phi[drawn])
        np.testing.assert_allclose(least, found.wear_volume, rtol=2e-4)
        ended = np.isin(k[drawn], bounds)
        assert ended.all() if label == AT_BOUND else ended.mean() < 0.5
    # where the other end wears less the line is broken: no step across
    for curve in (line(figure, label) for label in shown):
        assert np.nanmax(np.abs(np.diff(curve[1])), initial=0.0) < 0.4 * (bounds[1] - bounds[0])


def plateau(figure: Figure) -> np.ndarray:
    """The points of the line on which 5 % more is worn."""
    drawn = [artist for artist in figure.axes[0].collections if isinstance(artist, ContourSet)]
    (found,) = (artist for artist in drawn if list(artist.levels) == [0.05])
    return np.concatenate(found.allsegs[0])


def test_a_map_of_designs_shows_the_least_wear_and_its_plateau():
    k, z0 = np.linspace(-0.9, 0.9, 37), np.geomspace(1e-6, 1e-4, 41)
    bowl = 1.0 + (k[:, None] - 0.2) ** 2 + (0.5 * np.log10(z0 / 1e-5)) ** 2
    figure = map_picture(made(3e-18 * bowl, "wear_volume", "m^3", k=k, z0=z0))
    assert entries(figure) == ["least wear", PLATEAU]
    np.testing.assert_allclose(line(figure, "least wear"), [[0.2], [10.0]], rtol=1e-12)
    x, y = plateau(figure).T
    np.testing.assert_allclose((x - 0.2) ** 2 + (0.5 * np.log10(y / 10.0)) ** 2, 0.05, rtol=0.05)
    assert entries(map_picture(made(np.ones_like(bowl), "wear_volume", "m^3", k=k, z0=z0))) == []


def test_the_plateau_of_each_amplitude_is_that_of_its_least_wear():
    valley = (1.0 + (K[:, None] - PHI) ** 2) * 10.0**PHI
    x, y = plateau(map_picture(made(valley, "worn_radius", "m", k=K, phi=PHI))).T
    nearest = 1.0 + np.min((K[:, None] - x) ** 2, axis=0)
    inside = (1.0 + (y - x) ** 2) / nearest - 1.0
    assert np.all((inside > 0.0) & (inside < 0.1)) and abs(inside.mean() - 0.05) < 0.02


def test_other_maps_have_no_least_wear():
    for name, unit in (("penetration", "a_0^2/R"), ("wear_volume.dk", "a_0^4/R")):
        figure = map_picture(made(plane(K, PHI), name, unit, k=K, phi=PHI))
        assert not figure.axes[0].lines and entries(figure) == []
    nu = map_picture(made(plane(K, PHI), "wear_volume", "m^3", k=K, nu=PHI))
    assert not nu.axes[0].lines


def test_the_least_wear_is_that_of_what_is_drawn():
    force = np.linspace(0.4, 3.6, 40)
    k = np.linspace(-0.9, 0.9, 37)
    # a valley that moves on, and another one at the bound, which is the deeper one from 2.5 N on
    bottom = np.clip(0.6 * (force - 0.9), -0.25, 0.6)
    valley = (k[:, None] - bottom) ** 2
    values = 1e-12 * (1.5 + np.minimum(valley, k[:, None] + 0.9 + np.where(force < 2.5, 0.1, -0.1)))
    values[:, 7] = np.nan
    figure = map_picture(made(values, "wear_volume", "m^3", k=k, tangential_force=force))
    assert entries(figure) == [LEAST, AT_BOUND, PLATEAU, "grey: undefined"]
    x, y = line(figure, LEAST)
    inner = np.flatnonzero((force < 2.5) & ~np.isnan(values[0]))
    np.testing.assert_array_equal(x[np.isfinite(x)], force[inner])
    np.testing.assert_allclose(y[np.isfinite(y)], bottom[inner], atol=1e-9)  # also between the rows
    assert np.isnan(x).sum() == 1  # broken where there are no values
    x, y = line(figure, AT_BOUND)
    np.testing.assert_array_equal(x, force[force >= 2.5])
    assert set(y) == {k[0]}
    valley[:, 0] = 1.0  # where nothing wears, no exponent is the best
    figure = map_picture(made(valley, "worn_radius", "a_0", k=k, phi=force / 4.0))
    np.testing.assert_array_equal(line(figure, LEAST)[0], force[1:] / 4.0)


# --- words and units ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name, unit, size, label, factor",
    [
        ("wear_volume", "m^3", 3e-17, r"wear volume $\Delta V$ (µm³)", 1e-18),
        ("contact_radius", "m", 8e-5, "contact radius $a_0$ (µm)", 1e-6),
        ("edge_pressure", "Pa", 2e8, r"edge pressure $p_\infty$ (MPa)", 1e6),
        ("steady_pressure", "F_N/(pi a_0^2)", 2.0, r"steady pressure $p_\infty$ ($F_N/(\pi a_0^2)$)", 1.0),
        ("wear_volume", "a_0^4/R", 2e-7, r"wear volume $\Delta V$ ($10^{-7}$ $a_0^4/R$)", 1e-7),
        ("gross_slip.force_drop", "1", 0.3, r"normal force lost $1-F_{N\infty}/F_{N0}$", 1.0),
        ("design.E0", "Pa", 3e10, "best modulus $E_0^*$ (GPa)", 1e9),
        ("optimal_exponent.k", "1", 0.5, "best exponent $k^*$", 1.0),
        ("optimal_exponent.wear_volume", "a_0^4/R", 0.5, r"least wear volume $\Delta V$ ($a_0^4/R$)", 1.0),
        ("wear_volume.dk", "a_0^4/R", 0.5, r"$\partial \Delta V/\partial k$ ($a_0^4/R$)", 1.0),
        ("wear_volume.dk.dk", "a_0^4/R", 0.5, r"$\partial^2 \Delta V/\partial {k}^2$ ($a_0^4/R$)", 1.0),
        (
            "wear_volume.dk.dphi",
            "a_0^4/R",
            0.5,
            r"$\partial^2 \Delta V/(\partial k\,\partial \varphi)$ ($a_0^4/R$)",
            1.0,
        ),
        ("wear_volume.dE0", "m^3/Pa", 2e-27, r"$\partial \Delta V/\partial E_0$ (µm³/GPa)", 1e-27),
        (
            "wear_volume.dE0.dz0",
            "(m^3/Pa)/m",
            2e-21,
            r"$\partial^2 \Delta V/(\partial E_0\,\partial z_0)$ (µm³/(GPa µm))",
            1e-21,
        ),
        ("deepest_wear.dk", "m", 2e-9, r"$\partial/\partial k$ of deepest wear (nm)", 1e-9),
        ("slip_amplitude", "mu theta a_0^2/R", 2.0, r"slip amplitude $\delta$ ($\mu \theta a_0^2/R$)", 1.0),
        ("energy_per_cycle.dk", "J", 2e-9, r"$\partial W/\partial k$ (nJ)", 1e-9),
        ("transient.wear_volume", "m^3", 3e-17, r"wear volume by then $\Delta V$ (µm³)", 1e-18),
        ("design.indenter.E", "Pa", 3e10, "best modulus of the indenter $E_i^*$ (GPa)", 1e9),
        ("wear_volume.dshape.bend", "m^3", 3e-17, r"$\partial \Delta V/\partial \mathrm{shape.bend}$ (µm³)", 1e-18),
    ],
)
def test_quantities_have_symbols_and_readable_units(name, unit, size, label, factor):
    values = size * (0.5 + 0.5 * (plane(K) - 2.0))
    ds = made(values, name, unit, k=K).assign_coords(E0=((), 110e9), z0=((), 1e-4))
    axes = map_picture(ds).axes[0]
    assert axes.get_ylabel() == label
    np.testing.assert_allclose(axes.lines[0].get_ydata(), values / factor, rtol=1e-13)


@pytest.mark.parametrize(
    "meaning, equation, text",
    [
        ("outer radius a_inf of the worn ring", "26", r"outer radius $a_\infty$ of the worn ring, Eq. (26)"),
        ("stick radius c", "16, 23", "stick radius c, Eqs. (16), (23)"),
        ("factor h_N of the normal compliance", "29-31", "factor $h_N$ of the normal compliance, Eqs. (29)–(31)"),
        ("depth f_inf - f_0 worn off", "", r"depth $f_\infty$ − $f_0$ worn off"),
        ("share of the wear_volume saved", "", "share of the wear volume saved"),
        (
            "derivative by phi of: traction tau_inf",
            "19",
            r"derivative by $\varphi$ of: traction $\tau_\infty$, Eq. (19)",
        ),
    ],
)
def test_the_title_says_what_is_drawn_and_its_equation(meaning, equation, text):
    figure = map_picture(made(plane(K), attrs={"long_name": meaning, "equation": equation}, k=K))
    assert title(figure).replace("\n", " ") == text


# --- whole pictures -------------------------------------------------------------------------------------------------


def pictures() -> dict[str, xr.Dataset]:
    short = {"k": np.linspace(-0.9, 0.9, 8), "phi": np.linspace(0.0, 0.99, 9)}
    found = {"paper": sweep.sweep("wear_volume", **short)}
    both = sweep.sweep(
        ["wear_volume", "contact_radius"], contact=CONTACT, k=K, tangential_force=np.linspace(0.1, 3.9, 8)
    )
    found |= {"contact": both, "one axis": both[["contact_radius"]]}
    holes = made(np.where(plane(K, PHI) > 3.0, np.nan, plane(K, PHI)), k=K, phi=PHI)
    stretched = {"k": read_axis("k", "-0.999:0.999:9:logit"), "phi": read_axis("phi", "1e-5:0.99999:9:logit")}
    same = made(np.ones((K.size, PHI.size)), k=K, phi=PHI)
    zero = made(np.zeros((K.size, PHI.size)), k=K, phi=PHI)
    infinite = np.where(plane(K, PHI) > 3.5, np.inf, 10.0 ** (5 * plane(K, PHI)))
    return found | {
        "holes": holes,
        "nothing yet": made(np.full((K.size, PHI.size), np.nan), unfinished=1, k=K, phi=PHI),
        "stretched": made(plane(*stretched.values()), "wear_volume", "a_0^4/R", **stretched),
        "yes and no": made(plane(K, PHI) > 3.0, "optimal_exponent.certified", k=K, phi=PHI),
        "the same everywhere": same,
        "zero everywhere": zero,
        "zero along a curve": made(np.zeros(K.size), k=K),
        "infinite": made(infinite, "steady_pressure", "Pa", k=K, phi=PHI),
        "curves": made(plane(K, np.geomspace(1e-5, 1e-3, 5)), k=K, z0=np.geomspace(1e-5, 1e-3, 5)),
        "infinite curve": made(infinite[-1], "steady_pressure", "Pa", phi=PHI),
        "all infinite": made(np.full(PHI.size, np.inf), "steady_pressure", "Pa", phi=PHI),
    }


@pytest.mark.compiled
def test_every_kind_is_drawn_without_a_warning_as_sweeps_make_them(tmp_path):
    drawn = {name: map_picture(ds) for name, ds in pictures().items()}
    for figure in drawn.values():
        figure.set_dpi(60)
        figure.draw_without_rendering()
        width, height = figure.bbox.size
        for part in (*figure.legends, *figure.axes, *figure.texts):
            box = part.get_tightbbox()
            assert -0.5 <= box.x0 < box.x1 <= width + 0.5, part
            assert -0.5 <= box.y0 < box.y1 <= height + 0.5, part
    plots.save(drawn["holes"], tmp_path / "holes.pdf")
    assert (tmp_path / "holes.pdf").stat().st_size < 60_000
    assert drawn["contact"].axes[0].get_xlabel() == "tangential force $F_x$ (N)"
    assert drawn["contact"].axes[1].get_ylabel() == r"wear volume $\Delta V$ (µm³)"
    assert drawn["one axis"].axes[0].get_ylabel() == "contact radius $a_0$ (µm)"
    assert title(drawn["paper"]) == "volume worn off until the steady state, Eq. (28)"
