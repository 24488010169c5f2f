"""The values of an axis as they are written on a command line."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from refusals import cases, is_told, refusal
from scipy.special import expit, logit

from plgwear_jax.sweep.axes import AxisError, check_axis, read_axis


def test_a_number_is_a_single_value():
    assert read_axis("k", " -0.5 ").shape == () and read_axis("k", "-0.5") == -0.5
    assert read_axis("z0", "1e-4") == 1e-4


def test_ranges_hold_both_ends():
    assert_array_equal(read_axis("k", "-0.95:0.95:5"), np.linspace(-0.95, 0.95, 5))
    assert_array_equal(read_axis("z0", "1e-5:1e-3:7:log"), np.geomspace(1e-5, 1e-3, 7))
    assert_array_equal(read_axis("phi", "0.9:0.1:3:linear"), [0.9, 0.5, 0.1])
    assert_array_equal(read_axis("phi", "0.3:0.3:1"), [0.3])


@given(st.floats(-13.0, 13.0), st.floats(-13.0, 13.0), st.integers(2, 50))
def test_logit_spacing_is_even_in_the_logit(first, last, count):
    for name, lower, width in (("phi", 0.0, 1.0), ("k", -1.0, 2.0)):
        start, stop = (lower + width * expit([first, last])).tolist()
        values = read_axis(name, f"{start!r}:{stop!r}:{count}:logit")
        assert values[0] == start and values[-1] == stop
        share = (values - lower) / width
        steps = logit(share)
        # A share near 1 is stored to 1e-16 only, and its logit to that over 1 - share.
        coarse = 4e-16 / np.minimum(share, 1.0 - share).min() + 1e-13
        assert_allclose(steps, np.linspace(steps[0], steps[-1], count), rtol=0.0, atol=coarse)


def test_a_file_holds_a_value_a_line(here):
    (here / "values.txt").write_text("# amplitudes\n0.1\n\n  0.25\n1e-3\n")
    assert_array_equal(read_axis("phi", "values.txt"), [0.1, 0.25, 1e-3])
    (here / "0:1").write_text("0.5\n")
    assert refusal(AxisError, read_axis, "phi", "0:1").startswith("phi = 0:1: must be a number, start:stop:count")
    assert_array_equal(read_axis("phi", "./0:1"), [0.5])


@cases("sweep/refused.toml", "axes")
def test_refusals(here, case):
    for name, content in {"nan": "0.1\nnan\n", "word": "soft\n", "empty": "# nothing\n\n"}.items():
        (here / f"{name}.txt").write_text(content)
    (here / "folder").mkdir()
    assert is_told(refusal(AxisError, read_axis, case["name"], case["text"]), case)


@cases("sweep/refused.toml", "arrays")
def test_refusals_of_arrays(case):
    assert is_told(refusal(AxisError, check_axis, "k", case["values"]), case)


def test_values_keep_their_precision():
    assert check_axis("k", np.array([0.1], np.float32)).dtype == np.float32
    assert check_axis("normal_force", [1, 2]).dtype == np.float64
