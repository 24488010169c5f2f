"""Tables of amplitudes: how they may be written, what is refused, in which words, and how large ones are read."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from refusals import cases, is_told

from plgwear_jax import tables

TABLE = "tangential_force,weight\n0.1,2\n0.4,1\n0.2,0\n"
REFUSED = Path(__file__).with_name("refused_tables.toml")
WRITTEN = tomllib.loads(Path(__file__).with_name("tables.toml").read_text("utf-8"))


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return Path("loads.csv")


def read(file: Path, content: str | bytes, columns: int = 2) -> tables.Table:
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    return tables.read(file, tables.LOADS if columns == 2 else tables.HISTORY)


def complaint(file: Path, content: str | bytes, columns: int = 2) -> str:
    with pytest.raises(tables.TableError) as caught:
        read(file, content, columns)
    return str(caught.value)


def numbers(found: tables.Table) -> np.ndarray:
    return np.stack([found["tangential_force"], found["weight"]], axis=1)


# --- what is read ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", WRITTEN)
def test_a_table_is_read_however_it_is_written(file, kind):
    expected = {"tangential_force": [0.1, 0.4, 0.2]} | ({"weight": [2.0, 1.0, 0.0]} if kind == "loads" else {})
    for case in WRITTEN[kind]:
        found = read(file, case["content"], len(expected))
        assert found.name == "loads.csv" and found.row.tolist() == case["rows"]
        assert {column: values.tolist() for column, values in found.columns.items()} == expected
        assert found["tangential_force"].dtype == float and not found["tangential_force"].flags.writeable


@pytest.mark.parametrize(
    "heading, factor",
    [("volume", 1.0), ("volume (mm^3)", 1e-9), ("volume [um3]", 1e-18), ("volume_mm3", 1e-9), ("volume(nm^3)", 1e-27),
     ("volume (\N{MICRO SIGN}m\N{SUPERSCRIPT THREE})", 1e-18)],
)  # fmt: skip
def test_measured_volumes_name_their_unit(file, heading, factor):
    file.write_text(f"{heading},cycles,deviation (mm^3)\n2,10,3\n4,20,5\n", encoding="utf-8")
    found = tables.read(file, tables.MEASURED)
    np.testing.assert_allclose(found["volume"], np.array([2.0, 4.0]) * factor, rtol=1e-15)
    np.testing.assert_allclose(found["deviation"], [3e-9, 5e-9], rtol=1e-15)
    assert "relative_deviation" not in found.columns
    for column, share in (("relative_deviation", 1.0), ("deviation (%)", 0.01), ("relative_deviation [%]", 0.01)):
        file.write_text(f"cycles,{heading},{column}\n10,2,0.5\n", encoding="utf-8")
        found = tables.read(file, tables.MEASURED)
        assert found["relative_deviation"] == pytest.approx([0.5 * share], rel=1e-15)


def test_loads_and_scatter_name_their_units(file):
    found = read(file, "tangential_force (mN),weight\n100,2\n400,1\n200,0\n")
    np.testing.assert_allclose(found["tangential_force"], [0.1, 0.4, 0.2], rtol=1e-15)
    np.testing.assert_allclose(read(file, "weight,displacement_um\n1,2\n")["displacement"], [2e-6], rtol=1e-15)
    columns = dict.fromkeys(
        ("friction", "radius", "E0", "indenter.E", "normal_force"), tables.Domain("> 0", np.isfinite)
    )
    file.write_text("friction,radius (mm),E0_GPa,indenter.E [GPa],normal_force (kN)\n0.4,5,110,210,1\n")
    scatter = tables.read(file, tables.scenarios(columns))
    assert [*scatter.columns] == ["friction", "radius", "E0", "indenter.E", "normal_force"]
    np.testing.assert_allclose(np.ravel([*scatter.columns.values()]), [0.4, 5e-3, 110e9, 210e9, 1e3], rtol=1e-15)


@cases(REFUSED, "measured")
def test_refusal_of_measured_volumes(file, case):
    file.write_text(case["content"])
    with pytest.raises(tables.TableError) as caught:
        tables.read(file, tables.MEASURED)
    assert is_told(str(caught.value), case, "loads.csv")


positive = st.floats(0, 1e300)


@given(st.lists(st.tuples(positive, positive), min_size=1).filter(lambda rows: any(weight for _, weight in rows)))
def test_round_trip(tmp_path_factory, rows):
    file = tmp_path_factory.getbasetemp() / "round-trip.csv"
    found = read(file, "tangential_force,weight\n" + "".join(f"{force},{weight}\n" for force, weight in rows))
    np.testing.assert_array_equal(numbers(found), rows)


@pytest.mark.parametrize("rows", [100_000, pytest.param(1_000_000, marks=pytest.mark.long)])
def test_large_tables_are_read(file, rows):
    expected = np.random.default_rng(1).random((rows, 2))
    content = "tangential_force,weight\n" + "".join(f"{force!r},{weight!r}\n" for force, weight in expected.tolist())
    np.testing.assert_array_equal(numbers(read(file, content)), expected)
    line = complaint(file, f"{content}0.1,-1\n")
    assert line == f"loads.csv: row {rows + 2}: weight = -1: {WEIGHT}"


# --- what is refused ------------------------------------------------------------------------------------------------

FORCE = "must be a finite number >= 0, the amplitude of the force in N"
WEIGHT = "must be a finite number >= 0"


@cases(REFUSED, "loads")
def test_refusal_says_file_row_column_value_and_what_is_allowed(file, case):
    assert is_told(complaint(file, case["content"]), case, "loads.csv")


def test_refusal_of_a_cell_that_is_too_long(file):
    line = complaint(file, f"tangential_force,weight\n0.1,{200_000 * '1'}\n")
    assert line == "loads.csv: row 2: is not valid CSV: field larger than field limit (131072)"


@cases(REFUSED, "history")
def test_refusal_of_a_history(file, case):
    assert is_told(complaint(file, case["content"], columns=1), case, "loads.csv")


def test_refusal_far_down_the_file(file):
    rows = 10 * ["0.1,1"]
    assert read(file, "\n".join(["tangential_force,weight", *rows])).row.tolist() == list(range(2, 12))
    for row in range(2, 12):
        wrong = [*rows[: row - 2], "", "x,1", *rows[row - 1 :], "y,1"]
        line = complaint(file, "\n".join(["tangential_force,weight", *wrong]))
        assert line == f"loads.csv: row {row + 1}: tangential_force = x: {FORCE}"


def test_the_first_wrong_row_is_refused(file):
    found = read(file, TABLE)
    found.refuse(found["weight"] > 2.0, lambda place: f"weight {place}")
    with pytest.raises(tables.TableError, match=r"^loads.csv: row 3: weight 1 is wrong$"):
        found.refuse(found["weight"] < 2.0, lambda place: f"weight {place} is wrong")
    with pytest.raises(tables.TableError, match=r"^loads.csv: has no column volume, but tangential_force, weight$"):
        found["volume"]


@given(st.binary(max_size=60) | st.text(alphabet='tangeilforcw_h,;\t"#\n\r 01.-x', max_size=60).map(str.encode))
def test_any_bytes_are_refused_in_one_line_or_read(tmp_path_factory, content):
    file = tmp_path_factory.getbasetemp() / "bytes.csv"
    for start in (b"", b"tangential_force,weight\n"):
        try:
            found = read(file, start + content)
        except tables.TableError as error:
            line = str(error)
            assert line.startswith(f"{file}: ") and line.isprintable()
        else:
            assert numbers(found).shape == (found.row.size, 2)
