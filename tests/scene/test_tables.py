"""Tables of amplitudes: how they may be written, what is refused, in which words, and how large ones are read."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from marks import long_case, parametrize
from numpy.testing import assert_allclose, assert_array_equal
from refusals import cases, data, is_told, refusal

from plgwear_jax import tables
from plgwear_jax._core.units import PREFIXED

TABLE = "tangential_force,weight\n0.1,2\n0.4,1\n0.2,0\n"


def read(content, form=tables.LOADS):
    Path("loads.csv").write_bytes(content if isinstance(content, bytes) else content.encode())
    return tables.read("loads.csv", form)


def complaint(content, form=tables.LOADS):
    return refusal(tables.TableError, read, content, form)


def numbers(found):
    return np.stack([found["tangential_force"], found["weight"]], axis=1)


# --- what is read ---------------------------------------------------------------------------------------------------


def test_a_table_is_read_however_it_is_written():
    for case in data("scene/tables.toml")["tables"]:
        found = read(case["content"], getattr(tables, case["form"]))
        assert found.name == "loads.csv" and found.row.tolist() == case["rows"], case
        assert found.columns.keys() == case["columns"].keys()
        for name, values in case["columns"].items():
            assert_allclose(found[name], values, rtol=1e-15, err_msg=case["content"])
            assert found[name].dtype == float and not found[name].flags.writeable


def test_scenarios_name_their_units():
    columns = dict.fromkeys(
        ("friction", "radius", "E0", "indenter.E", "normal_force", "depth"), tables.Domain("> 0", np.isfinite)
    )
    content = "friction,radius (mm),E0_GPa,indenter.E [GPa],normal_force (kN),depth\n0.4,5,110,210,1,0.2\n"
    found = read(content, tables.scenarios(columns)).columns
    assert [*found] == [*columns]
    assert_allclose(np.ravel([*found.values()]), [0.4, 5e-3, 110e9, 210e9, 1e3, 0.2], rtol=1e-15)


positive = st.floats(0, 1e300)


@given(st.lists(st.tuples(positive, positive), min_size=1).filter(lambda rows: any(weight for _, weight in rows)))
def test_round_trip(rows):
    found = read("tangential_force,weight\n" + "".join(f"{force},{weight}\n" for force, weight in rows))
    assert_array_equal(numbers(found), rows)


@parametrize("rows", [20_000, long_case(1_000_000)])
def test_large_tables_are_read(rows):
    expected = np.random.default_rng(1).random((rows, 2))
    content = "tangential_force,weight\n" + "".join(f"{force!r},{weight!r}\n" for force, weight in expected.tolist())
    assert_array_equal(numbers(read(content)), expected)
    assert complaint(f"{content}0.1,-1\n") == f"loads.csv: row {rows + 2}: weight = -1: {WEIGHT}"


# --- what is refused ------------------------------------------------------------------------------------------------

WEIGHT = "must be a finite number >= 0"


@cases("scene/refused_tables.toml", "loads")
def test_refusal_says_file_row_column_value_and_what_is_allowed(case):
    """Of loads, where nothing else is said, of histories and of measured volumes."""
    assert is_told(complaint(case["content"], getattr(tables, case.get("form", "LOADS"))), case, "loads.csv")


def test_refusal_of_a_cell_that_is_too_long():
    line = complaint(f"tangential_force,weight\n0.1,{200_000 * '1'}\n")
    assert line == "loads.csv: row 2: is not valid CSV: field larger than field limit (131072)"


def test_the_first_wrong_row_is_refused():
    found = read(TABLE)
    found.refuse(found["weight"] > 2.0, lambda place: f"weight {place}")
    with pytest.raises(tables.TableError, match=r"^loads.csv: row 3: weight 1 is wrong$"):
        found.refuse(found["weight"] < 2.0, lambda place: f"weight {place} is wrong")
    with pytest.raises(tables.TableError, match=r"^loads.csv: has no column volume, but tangential_force, weight$"):
        found["volume"]


@given(st.binary(max_size=60) | st.text(alphabet='tangeilforcw_h,;\t"#\n\r 01.-x', max_size=60).map(str.encode))
def test_any_bytes_are_refused_in_one_line_or_read(content):
    for start in (b"", b"tangential_force,weight\n"):
        try:
            found = read(start + content)
        except tables.TableError as error:
            line = str(error)
            assert line.startswith("loads.csv: ") and line.isprintable()
        else:
            assert numbers(found).shape == (found.row.size, 2)


def test_prefixes_are_those_of_si():
    assert data("scene/units.toml") == {"read": tables._UNITS, "written": PREFIXED}
