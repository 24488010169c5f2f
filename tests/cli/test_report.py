"""Reports of the command line: tables, JSON objects and CSV files from one renderer, with units from the catalogue."""

import ast
import gc
import json
import re
import signal
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from commands import table_rows
from marks import parametrize
from typer.testing import CliRunner

import plgwear_jax
from plgwear_jax import cli
from plgwear_jax._core.catalogue import AXES, FRETTING, GROSS_SLIP, entry
from plgwear_jax._core.units import text_cells
from plgwear_jax.cli.report import Column, Report, by_quantity, each_with_unit, shared
from plgwear_jax.cli.terminal import refusing

PACKAGE = Path(plgwear_jax.__file__).parent


@pytest.fixture(autouse=True)
def _narrow(monkeypatch):
    monkeypatch.setenv("COLUMNS", "20")


@parametrize("file", sorted([*PACKAGE.glob("cli/*.py"), *PACKAGE.glob("plots/*.py")]), ids=lambda f: f.stem)
def test_units_are_written_in_the_catalogue_alone(file):
    units = {entry(name).unit for name in (*FRETTING, *GROSS_SLIP, *AXES)} - {"1"}
    assert {"m", "m^3", "Pa", "N", "1/Pa"} <= units
    written = {node.value for node in ast.walk(ast.parse(file.read_text("utf-8"))) if isinstance(node, ast.Constant)}
    assert written & units == set()


def test_people_read_tables_and_programs_one_object(capsys):
    for as_json in (False, True):
        report = Report(Path("a.toml"), as_json, picture=Path("a.png"), table=Path("a.csv"))
        report.put(volume=np.array([1.0, np.inf]))
        report.say("a line", None, "")
        report.table(
            each_with_unit("contact_radius", [1e-6, 2e-3], end=3e-9),
            shared("volume", np.array([1e-18, 2e-22]), end=0.0),
            Column(
                "",
                ["first of more words than a narrow terminal has room for, of which none may be cut", "second"],
                "end",
            ),
        )
        report.write_table({"volume": np.array([1.0, 1.0])})
        report.end()
        printed = capsys.readouterr().out
        if as_json:
            assert json.loads(printed) == {
                "scene": "a.toml", "volume": [1.0, None], "units": {"volume": "m^3"}, "picture": "a.png",
            }  # fmt: skip
        else:
            lines = printed.splitlines()
            assert lines[0] == "a line" and lines[-2:] == ["picture: a.png", "table: a.csv"]
            assert [line[16:28].split() for line in lines[3:6]] == [["worn"], ["volume"], ["µm³"]]
            assert table_rows(printed) == [
                *text_cells("""
                1 µm  1        first of more words than a narrow terminal has room for, of which none may be cut
                2 mm  2.0e-04  second
                3 nm  0        end
                """)
            ]
        assert Path("a.csv").read_text() == "volume\n1.0\n1.0\n"


def test_quantities_are_compared_in_one_prefix(capsys):
    compared = by_quantity(("best", "reference"), {"E0": (2e12, 110e9), "k": (-0.5, 0.0)}, {"E0": "stiffness"})
    report = Report(Path("a.toml"), False)
    report.table(*compared, title="")
    report.end()
    assert table_rows(capsys.readouterr().out) == [
        *text_cells("""
        stiffness   2000 GPa  110 GPa
        exponent k  -0.5      0
        """)
    ]


def test_a_long_table_is_cut_where_that_is_said(capsys):
    cells = [f"{i}" for i in range(43)]
    for more, printed, last in (("rows", 40, "and 3 more rows"), ("", 43, None)):
        report = Report(Path("a.toml"), False)
        report.table(Column("i", cells), more=more)
        report.end()
        out = capsys.readouterr().out
        assert len(table_rows(out)) == printed and (last is None or out.splitlines()[-1] == last)


def test_an_error_of_the_program_is_not_called_one_of_the_input():
    def fails(**_):
        raise ValueError("a matrix is singular")

    with pytest.raises(ValueError, match="a matrix is singular"):
        refusing(fails)(scene_file=Path("a.toml"))


def test_an_interrupt_that_a_callback_loses_comes_again(monkeypatch):
    """As in the one that JAX has called at each collection of garbage: Python ignores what it raises."""
    lost = []
    monkeypatch.setattr("os._exit", sys.exit)

    def callback(phase, _):
        if phase == "start" and not lost:
            lost.append("an interrupt")
            raise KeyboardInterrupt

    def works(**_):
        gc.callbacks.append(callback)
        gc.collect(0)
        assert lost
        threading.Event().wait(60.0)
        raise AssertionError("it went on")

    # A shell that starts the tests in the background has them ignore the signal.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(SystemExit, match="130"):
            refusing(works)(scene_file=Path("a.toml"))
    finally:
        signal.signal(signal.SIGINT, before)
        gc.callbacks.remove(callback)


def test_every_axis_of_the_catalogue_is_an_option_of_sweeps():
    told = CliRunner().invoke(cli.app, ["sweep", "--help"], env={"COLUMNS": "200", "NO_COLOR": "1"}).stdout
    assert re.findall(r"--([\w-]+) +VALUES", told) == [name.replace("_", "-") for name in AXES if "." not in name]
