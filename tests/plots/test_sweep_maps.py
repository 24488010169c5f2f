"""Pictures of sweeps: they show the values, on fitting scales, in readable units, and read no more than is seen."""

import re

import dask.array as da
import numpy as np
import pytest
import xarray as xr
from functions import values
from kinds import dome
from marks import parametrize
from matplotlib.collections import QuadMesh
from matplotlib.colors import AsinhNorm, LogNorm, Normalize
from matplotlib.contour import ContourSet
from numpy.testing import assert_allclose, assert_array_equal
from refusals import cases, refusal

from plgwear_jax import plots, sweep
from plgwear_jax._core.catalogue import AXES, leaf
from plgwear_jax._core.units import text_cells
from plgwear_jax.plots.maps import MapError, map_picture
from plgwear_jax.sweep.axes import read_axis, spacing_of
from plgwear_jax.sweep.names import label_of

K, PHI = np.linspace(-0.9, 0.9, 13), np.linspace(0.1, 0.9, 9)


def made(values, name="penetration", units="1", attrs=None, unfinished=None, **axes):
    """A sweep as it would be if the quantity had these values, by default over k and phi."""
    axes, known = axes or {"k": K, "phi": PHI}, {"quantity": name, "label": label_of(name), "units": units}
    variables = {name.replace(".", "_"): (tuple(axes), values, known | (attrs or {}))}
    found = xr.Dataset(variables, axes, {"unfinished": unfinished})
    for axis, row in found.coords.items():
        row.attrs["label"] = "load"
        if row.dtype.kind == "f":
            kind = leaf(str(axis))
            row.attrs |= {"units": kind.unit, "label": kind.label, "spacing": spacing_of(str(axis), row.to_numpy())}
    return found


def drawn(*values, **axes):
    return map_picture(made(*values, **axes))


def plane(*rows):
    """Positive values of less than two decades, which rise along each axis."""
    return 2.0 + sum(np.ix_(*((row - row[0]) / (row[-1] - row[0]) for row in rows)))


PLANE = plane(K, PHI)


def mesh(figure):
    (found,) = (artist for artist in figure.axes[0].collections if isinstance(artist, QuadMesh))
    return found


def contours(figure):
    return [artist for artist in figure.axes[0].collections if isinstance(artist, ContourSet)]


def entries(figure):
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def line(figure, label=None):
    """Abscissae and ordinates of a curve, by default of the first one."""
    found = next(one for one in figure.axes[0].lines if label in (None, one.get_label()))
    return np.asarray(found.get_data(), float)


def ticks(axis):
    return [text.get_text() for text in axis.get_ticklabels()]


# --- maps -----------------------------------------------------------------------------------------------------------


@parametrize(
    "across, upwards",
    [
        *text_cells("""
    phi               k
    k                 nu
    r                 k
    r                 phi
    tangential_force  z0
    k                 E0
    """)
    ],
)
def test_a_map_shows_the_values_in_either_order_of_its_axes(across, upwards):
    rows = {across: np.linspace(0.1, 0.4, 8), upwards: np.linspace(0.1, 0.4, 11)}
    shown = plane(*rows.values())
    for figure in (drawn(shown, **rows), drawn(shown.T, **dict(reversed(rows.items())))):
        found = mesh(figure)
        assert_array_equal(found.get_array(), shown.T)
        assert type(found.norm) is Normalize and (found.norm.vmin, found.norm.vmax) == (2.0, 4.0)


def test_labels_say_words_symbols_and_units():
    figure = drawn(PLANE, "stick_radius", "a_0", {"equation": "16"})
    axes, bar = figure.axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == (r"amplitude $\varphi$", "exponent $k$")
    assert bar.get_ylabel() == "stick radius $c$ ($a_0$)"
    assert figure.get_suptitle() == "stick radius $c$, Eq. (16)"
    assert drawn(PLANE, "wear_rate", "1/Pa").axes[1].get_ylabel().endswith(r"($\mathrm{1/Pa}$)")  # of SI, upright
    assert (axes.get_xlim(), axes.get_ylim()) == ((PHI[0], PHI[-1]), (K[0], K[-1]))
    assert figure.get_size_inches() == pytest.approx([8.6 / 2.54, 7.0 / 2.54], abs=0.01)


def test_a_falling_or_shuffled_axis_is_put_in_order():
    for order in (np.arange(K.size)[::-1], np.random.default_rng(0).permutation(K.size)):
        figure = drawn(PLANE[order], k=K[order], phi=PHI)
        assert_array_equal(mesh(figure).get_array(), PLANE)
        assert figure.axes[0].get_ylim() == (K[0], K[-1])


def test_contour_lines_run_where_the_values_are_those_of_their_numbers():
    (lines,) = contours(drawn(PLANE))
    assert 3 <= len(lines.allsegs) <= 9 and lines.labelTexts
    (level,) = contours(drawn(np.ones(401) + K[:, None], k=K, phi=np.linspace(0.1, 0.9, 401)))
    assert_allclose([text.get_position()[0] for text in level.labelTexts], 0.5)  # off the frame
    for level, segments in zip(lines.levels, lines.allsegs, strict=True):
        x, y = np.concatenate(segments).T
        assert_allclose(2.0 + (x - PHI[0]) / 0.8 + (y - K[0]) / 1.8, level, atol=1e-9)
    assert {float(re.findall(r"\d\.\d+", text.get_text())[0]) for text in lines.labelTexts} <= {*lines.levels.round(9)}


_SHARE = PLANE - 2.5


@parametrize(
    "shown, units, norm, ends",
    [
        (10.0 ** (3.0 * (_SHARE + 0.5)), "Pa", LogNorm, (1.0, 1e6)),
        (10.0 ** (3.0 * (_SHARE - 2.0)), "1", Normalize, None),  # a share, which may be very small
        (_SHARE, "1", Normalize, (-1.5, 1.5)),
        (np.sinh(6.0 * _SHARE), "Pa", AsinhNorm, (-np.sinh(9.0), np.sinh(9.0))),
        (np.ones_like(_SHARE), "1", Normalize, (0.5, 1.5)),
        (_SHARE + 0.5 - 1e-9, "1", Normalize, None),  # rounding errors below zero
    ],
)
def test_colours_fit_the_values(shown, units, norm, ends):
    found = mesh(drawn(shown, units=units, attrs={"label": "any"}))
    assert type(found.norm) is norm
    if ends:
        assert_allclose([found.norm.vmin, found.norm.vmax], ends)
    assert (found.cmap.name == "RdBu_r") is bool(shown.min() < -1e-6 and shown.max() > 1e-6)
    assert not np.ma.getmaskarray(found.get_array()).any()
    row = np.sort(shown.ravel())
    curve = drawn(row, units=units, attrs={"label": "any"}, phi=np.linspace(0.1, 0.9, row.size))
    assert curve.axes[0].get_yscale() == {Normalize: "linear", LogNorm: "log", AsinhNorm: "asinh"}[norm]
    assert_array_equal(line(curve)[1], row)


def test_zero_has_the_lowest_colour_and_infinite_values_those_of_the_ends():
    shown = 10.0 ** (3.0 * (_SHARE + 0.5))
    shown[0, 0] = 0.0
    found = mesh(drawn(shown, units="a_0"))
    assert found.norm.vmin == shown[shown > 0.0].min() == found.get_array().min()
    shown = PLANE.copy()
    shown[3, 4], shown[5, 5] = np.inf, -np.inf
    found = mesh(drawn(shown))
    assert found.norm.vmax == np.quantile(shown[np.isfinite(shown)], 0.99)
    assert found.colorbar.extend == "both"
    assert np.isfinite(found.get_array()).all()


@parametrize("unfinished, said", [(None, "undefined"), (0, "undefined"), (3, "not computed yet")])
def test_what_is_no_number_is_grey_and_said_to_be(unfinished, said):
    shown = PLANE.copy()
    shown[2:5, 3] = np.nan
    figure = drawn(shown, unfinished=unfinished)
    assert_array_equal(np.ma.getmaskarray(np.ma.masked_invalid(mesh(figure).get_array())), np.isnan(shown))
    assert entries(figure) == [f"grey: {said}"]
    assert entries(drawn(shown[:3], unfinished=unfinished, k=K[:3], phi=PHI))[3:] == [f"gaps: {said}"]
    drawn(np.full_like(shown, np.nan), unfinished=unfinished)
    assert entries(drawn(PLANE, unfinished=unfinished)) == []


def test_yes_and_no_are_two_colours():
    figure = drawn(PLANE > 3.0, "optimal_exponent.certified")
    assert_array_equal(mesh(figure).get_array(), PLANE > 3.0)
    curve = drawn(PHI > 0.5, "optimal_exponent.scan_found_nothing_better", phi=PHI)
    assert ticks(figure.axes[1].yaxis) == ticks(curve.axes[0].yaxis) == ["no", "yes"]
    assert_array_equal(line(curve)[1], PHI > 0.5)


# --- scales ---------------------------------------------------------------------------------------------------------


@parametrize(
    "axis, text, scale",
    [
        *text_cells("""
    phi  0.1:0.9:9              linear
    phi  1e-4:0.5:30:log        log
    phi  1e-4:0.9999:30:logit   logit
    k    -0.999:0.999:30:logit  function
    z0   1e-6:1e-3:7:log        log
    nu   0:0.5:2                linear
    """)
    ],
)
@parametrize("dtype", [np.float64, np.float32])
def test_an_axis_is_stretched_as_its_values_are_spaced(axis, text, scale, dtype):
    row = read_axis(axis, text).astype(dtype)
    figure = drawn(plane(row), **{axis: row})
    axes, (x, y) = figure.axes[0], line(figure)
    assert axes.get_xscale() == scale
    assert_array_equal(y, plane(row))
    assert_allclose(x, row, rtol=1e-6 if dtype == np.float32 else 1e-14)
    screen = axes.transData.transform(np.column_stack([x, np.full(x.size, 2.5)]))[:, 0]
    assert_allclose(np.diff(screen), np.ptp(screen) / (row.size - 1), rtol=0.01)
    assert_allclose(axes.get_xlim(), (x[0], x[-1]), rtol=1e-6)


def test_cells_meet_halfway_on_a_stretched_axis():
    z0, k = np.geomspace(1e-6, 1e-3, 10), read_axis("k", "-0.999:0.999:12:logit")
    shown = plane(k, z0)
    figure = drawn(shown, k=k, z0=z0)
    corners = mesh(figure).get_coordinates()
    assert_allclose(corners[1:-1, 0, 1], np.sqrt(z0[1:] * z0[:-1]), rtol=1e-12)
    depth = np.arctanh(k)
    assert_allclose(corners[0, 1:-1, 0], np.tanh(0.5 * (depth[1:] + depth[:-1])), rtol=1e-12, atol=1e-15)
    assert figure.axes[0].get_ylabel() == "characteristic depth $z_0$ (mm)"
    for power, number in ((0.6, "20"), (0.18, "4"), (0.22, "4")):
        assert number in ticks(drawn(shown, k=k, z0=0.02 * z0**power).axes[0].yaxis)
    assert r"$3 \times 10^{5}$" in ticks(drawn(shown, k=k, cycles=1e7 * z0**0.4).axes[0].yaxis)


@parametrize("end", [1e-3, 1e-6])
def test_no_numbers_touch_and_no_label_is_cut_off(end):
    k, phi = read_axis("k", "-0.999:0.999:30:logit"), read_axis("phi", f"{end}:{1.0 - end}:30:logit")
    shown = np.sinh(np.add.outer(np.arctanh(k), np.arctanh(2.0 * phi - 1.0)))
    figure = drawn(shown, "wear_volume.dk.dphi", "a_0^4/R", k=k, phi=phi)
    figure.draw_without_rendering()
    axes, bar = figure.axes
    for axis in (axes.xaxis, axes.yaxis, bar.yaxis):
        boxes = [text.get_window_extent() for text in axis.get_ticklabels()]
        assert all(box.count_overlaps(boxes) == 1 for box in boxes)
        assert figure.bbox.count_contains(axis.label.get_window_extent().corners()) == 4
    assert all(line.count("$") % 2 == 0 for line in figure.get_suptitle().splitlines())


# --- curves ---------------------------------------------------------------------------------------------------------


def test_an_axis_of_few_values_makes_curves_that_grey_prints_tell_apart():
    z0 = np.array([1e-6, 2e-6, 1e-5, 2e-5, 1e-4, 2.5e-4])
    shown = plane(K, z0)
    figure = drawn(shown, "stick_radius", "a_0", k=K, z0=z0)
    assert entries(figure) == [f"$z_0$ = {x} µm" for x in (1, 2, 10, 20, 100, 250)]
    lines = figure.axes[0].lines
    for curve, column in zip(lines, shown.T, strict=True):
        assert_array_equal(curve.get_ydata(), column)
    dashes = {str(curve._unscaled_dash_pattern) for curve in lines}
    assert len({curve.get_color() for curve in lines}) == z0.size and len(dashes) >= 4
    more = np.append(z0, 1e-3)
    assert mesh(drawn(plane(K, more), k=K, z0=more)).get_array().shape == (more.size, K.size)


def test_loads_have_their_names():
    names, shown = np.array(["belt", "cost in $", "tail"], object), plane(K, np.arange(3.0))
    ds = made(shown, "contact_radius", "m", k=K, load_case=names)
    figure = map_picture(ds)
    assert entries(figure) == ["belt", r"cost in \$", "tail"]
    assert_allclose(line(figure, r"cost in \$")[1], shown[:, 1], rtol=1e-14)
    with pytest.raises(MapError, match=r"^load_case = tial: is not in the sweep; did you mean tail\?$"):
        map_picture(ds, at={"load_case": "tial"})
    one = map_picture(ds, at={"load_case": "tail"})
    assert_allclose(line(one)[1], shown[:, 2], rtol=1e-14)
    assert one.get_suptitle() == "contact radius $a_0$, load = tail"
    assert ticks(map_picture(ds.isel(k=0, drop=True)).axes[0].xaxis) == ["belt", r"cost in \$", "tail"]
    many = np.array([f"case {number}" for number in range(8)], object)
    assert ticks(drawn(plane(np.arange(8.0), K), load_case=many, k=K).axes[0].yaxis) == list(many)


# --- what is chosen -------------------------------------------------------------------------------------------------

Z0 = np.geomspace(1e-5, 1e-3, 8)


def cube():
    return made(plane(K, PHI, Z0), attrs={"label": "shape"}, k=K, phi=PHI, z0=Z0)


def test_values_of_other_axes_are_chosen_and_told():
    figure = map_picture(cube(), at={"z0": Z0[3]})
    assert_array_equal(mesh(figure).get_array(), plane(K, PHI, Z0)[:, :, 3])
    assert figure.get_suptitle() == "shape, $z_0$ = 71.97 µm"
    figure = map_picture(cube(), at={"z0": "7.5e-5", "k": 0.3})
    assert_array_equal(line(figure)[1], plane(K, PHI, Z0)[8, :, 3])
    assert figure.get_suptitle() == "shape, $k$ = 0.3, $z_0$ = 71.97 µm (nearest to 75 µm)"
    single = drawn(PLANE[:, :, None], attrs={"label": "shape"}, k=K, phi=PHI, z0=[1e5])
    assert single.get_suptitle() == r"shape, $z_0$ = 1$\times 10^{5}$ m"


@cases("plots/refused.toml", "maps")
def test_what_cannot_be_drawn_is_refused_in_a_line(case):
    assert refusal(MapError, map_picture, cube(), **case["asked"]) == case["line"] and issubclass(MapError, ValueError)


def test_sweeps_without_axes_are_refused():
    for ds, message in (
        (xr.Dataset(), "the sweep holds no quantity"),
        (xr.Dataset({"h_N": 0.91}), "h_N: is a single number, 0.91; there is nothing to draw"),
    ):
        with pytest.raises(MapError, match=f"^{message}$"):
            map_picture(ds)


def counted(shape, chunks):
    """A lazy array whose values rise along each axis, and how many of them were read so far, chunk by chunk."""
    read = []

    def load(block_info=None):
        place = block_info[None]["array-location"]
        read.append(int(np.prod([last - first for first, last in place])))
        return 1.0 + sum(np.ix_(*(np.arange(first, last) for first, last in place))) / sum(shape)

    return da.map_blocks(load, chunks=da.core.normalize_chunks(chunks, shape), dtype=float), read


def test_only_what_is_seen_is_read_and_both_ends_are():
    k, phi = np.linspace(-0.9, 0.9, 6_000), np.linspace(0.0, 0.9, 30)
    lazy, read = counted((6_000, 30), (3, 30))
    ds = made(lazy, k=k, phi=phi)
    assert not read
    array = mesh(map_picture(ds)).get_array()
    assert 500 <= len(read) <= 1500 and array.shape == (len(read), 30)
    assert (array[0, 0], array[-1, -1]) == (1.0, 1.0 + (5_999 + 29) / 6_030)
    lazy, read = counted((6_000,), (3,))
    x, y = line(drawn(lazy, k=k))
    assert 1000 <= len(read) == x.size <= 1500
    assert (x[0], x[-1], y[-1]) == (k[0], k[-1], 1.0 + 5_999 / 6_000)
    lazy, read = counted((10, 30, 8), (10, 30, 1))
    map_picture(made(lazy, k=k[:10], phi=phi, z0=Z0), at={"z0": Z0[2]})
    assert sum(read) == 300


# --- the least wear -------------------------------------------------------------------------------------------------

LEAST, PLATEAU = "least wear, $k^*$", "5 % more wear"


def worn(k, phi):
    return np.asarray(values("fretting.wear_volume", *np.meshgrid(k.astype(float), phi.astype(float), indexing="ij")))


def test_a_map_of_the_wear_volume_is_over_that_of_no_gradient():
    k, phi = np.linspace(-0.9, 0.9, 13), np.linspace(0.0, 0.9, 9)
    volume = worn(k, phi)
    figure = drawn(volume, "wear_volume", "a_0^4/R", k=k, phi=phi)
    assert_allclose(mesh(figure).get_array(), volume[:, 1:] / volume[6, 1:], rtol=1e-14)
    assert figure.axes[1].get_ylabel() == r"wear volume $\Delta V/\Delta V(k=0)$"
    without = drawn(np.delete(volume, 6, axis=0), "wear_volume", "a_0^4/R", k=np.delete(k, 6), phi=phi)
    assert without.axes[1].get_ylabel() == r"wear volume $\Delta V$ ($a_0^4/R$)"


def plateau(figure):
    """The points of the line on which 5 % more is worn."""
    (found,) = (artist for artist in contours(figure) if list(artist.levels) == [0.05])
    return np.concatenate(found.allsegs[0])


def test_a_map_of_designs_shows_the_least_wear_and_its_plateau():
    k, z0 = np.linspace(-0.9, 0.9, 36), np.geomspace(1e-6, 1e-4, 41)
    bowl = 1.0 + (k[:, None] - k[22]) ** 2 + (0.5 * np.log10(z0 / 1e-5)) ** 2
    figure = drawn(3e-18 * bowl, "wear_volume", "m^3", k=k, z0=z0)
    assert entries(figure) == ["least wear", PLATEAU]
    assert_allclose(line(figure, "least wear"), [[k[22]], [1e-5]], rtol=1e-12)
    x, y = plateau(figure).T
    assert_allclose((x - k[22]) ** 2 + (0.5 * np.log10(y / 1e-5)) ** 2, 0.05, rtol=0.05)
    assert entries(drawn(np.ones_like(bowl), "wear_volume", "m^3", k=k, z0=z0)) == []


def test_the_least_wear_of_each_amplitude_and_its_plateau():
    k = read_axis("k", "-0.97:0.97:25:logit")
    valley = (1.0 + (k[:, None] - PHI) ** 2) * 10.0**PHI
    figure = drawn(valley, "worn_radius", "m", k=k, phi=PHI)
    assert_allclose(line(figure, LEAST), [PHI, PHI], atol=0.02)  # as well as a parabola through three values tells it
    x, y = plateau(figure).T
    nearest = 1.0 + np.min((k[:, None] - x) ** 2, axis=0)
    inside = (1.0 + (y - x) ** 2) / nearest - 1.0
    assert np.all((inside > 0.0) & (inside < 0.1)) and abs(inside.mean() - 0.05) < 0.02


def test_the_line_of_least_wear_is_broken_where_it_goes_over_to_the_other_end():
    ends = np.where(PHI < 0.5, K[0], K[-1]).astype(np.float32)
    x, y = line(drawn(1.0 + (K[:, None] - ends) ** 2, "worn_radius", "m"), LEAST)
    assert_allclose(y, np.where(x == 0.5, np.nan, ends), rtol=1e-6)


def test_other_maps_have_no_least_wear():
    for name, rows in (("penetration", {"k": K, "phi": PHI}), ("wear_volume.dk", {"k": K, "phi": PHI}),
                       ("worn_radius", {"k": K, "nu": PHI})):  # fmt: skip
        figure = drawn(PLANE, name, "m", **rows)
        assert not figure.axes[0].lines and entries(figure) == []


# --- what a sweep stores --------------------------------------------------------------------------------------------


@cases("sweep/names.toml", "labels", "label")
def test_quantities_are_stored_with_their_names_and_symbols(case):
    assert label_of(case["name"]) == case["label"]


def test_a_sweep_is_drawn_by_what_it_stores(tmp_path):
    force = np.geomspace(0.1, 3.9, 8)
    ds = sweep.sweep(["worn_radius", "contact_radius"], contact=dome(), k=K, tangential_force=force)
    assert ds.tangential_force.attrs["spacing"] == "log" and ds.worn_radius.attrs["label"] == r"worn radius $a_\infty$"
    figure = map_picture(ds)
    assert figure.axes[0].get_xlabel() == "tangential force $F_x$ (N)" and figure.axes[0].get_xscale() == "log"
    assert figure.axes[1].get_ylabel() == r"worn radius $a_\infty$ (µm)"
    assert_allclose(mesh(figure).get_array(), ds.worn_radius.to_numpy(), rtol=1e-14)
    assert "$F_N$ = 10 N" in figure.get_suptitle()
    plots.save(figure, tmp_path / "map.pdf")
    assert map_picture(ds, "contact_radius").axes[0].get_ylabel() == "contact radius $a_0$ (µm)"


@parametrize("axis", [axis for axis in AXES if AXES[axis].symbol])
def test_labels_of_axes_are_formulas_that_can_be_drawn(axis):
    label = drawn(plane(K), **{axis: np.linspace(0.1, 0.2, K.size)}).axes[0].xaxis.label
    assert f"${leaf(axis).symbol}$" in label.get_text() and label.get_window_extent().width > 0.0
