"""The figures of the paper: what is drawn is what the paper's equations give, and what is said of it is checked."""

import re
from itertools import product
from pathlib import Path

import numpy as np
import oracle
import paper_numbers
import pytest
from commands import plgwear, refused
from inputs import ROOT
from marks import compiled, long, long_case, parametrize
from matplotlib import image
from numpy.testing import assert_allclose
from refusals import cases, is_told

from plgwear_jax import gross_slip, plots
from plgwear_jax.plots import figures
from plgwear_jax.plots.figures import drawings
from plgwear_jax.plots.figures.drawings import AMPLITUDES, DEPTHS, EXPONENTS, PAIRS
from plgwear_jax.plots.style import BLUE, ORANGE

PAGE = ROOT / "docs" / "reference" / "hess_numbers.md"
IN_PART = "table-1", "7", "9"  # figures of which not all that is said holds


@pytest.fixture
def known(monkeypatch):
    """The numbers of the text as the oracle gives them: the library takes a minute to compile all that they need."""
    numbers = {name: float(value) for name, value in paper_numbers.from_oracle().items()}
    for module in (drawings, figures):
        monkeypatch.setattr(module, "numbers", lambda: numbers)


# --- what is drawn --------------------------------------------------------------------------------------------------


def curves(key, panels):
    """Curves of a figure, the abscissae between which they are compared, and the paper's equations."""
    named = {(axes, line.get_label()): line for axes in panels for line in axes.lines}
    first, *beside = panels
    if key in ("2", "3"):
        for name in ("initial", "steady"):
            field, k = getattr(oracle, f"gross_{name}_displacement"), {"2": -0.5, "3": 0.5}[key]
            yield named[first, name], (0.0, 2.0), lambda r, k=k, field=field: field(r, k)
    elif key == "4":
        yield first.lines[0], (-0.99, 0.99), lambda k: 100 * oracle.volume_change(k)
    elif key == "5":
        for (axes, most), depth, name in product(zip(panels, (0.5, 1.0), strict=True), DEPTHS, ("initial", "steady")):
            force = getattr(oracle, f"gross_{name}_force")
            yield (
                named[axes, f"{name}, $z_0/a = {depth:g}$"],
                (-0.9, 0.9),
                lambda k, force=force, z0=depth, most=most: force(1, z0, k, min(1 / (2 + k), most), 1, 1) / 2,
            )
    elif key == "7":
        for line, (radius, k) in zip(
            first.lines, product((oracle.worn_radius, oracle.stick_radius), EXPONENTS), strict=False
        ):
            yield line, (0.01, 0.99), lambda phi, k=k, radius=radius: radius(k, phi)
    elif key == "9":
        for k in PAIRS:
            line = named[first, f"$k = {k:g}$"]
            assert line.get_color() == {1: BLUE, 0: "k", -1: ORANGE}[int(np.sign(k))]
            yield line, (0.01, 0.95), lambda phi, k=k: oracle.wear_volume(k, phi)
            for axes, start, sign in zip(beside, (0.0, 1.0), (1.0, -1.0), strict=True):
                yield (
                    axes.lines[first.lines.index(line)],
                    (0.01, 0.09),
                    lambda x, k=k, start=start, sign=sign: (
                        oracle.wear_volume(k, start + sign * x) / oracle.wear_volume(0, start + sign * x)
                    ),
                )
    else:
        field = {"8": oracle.profile, "10": oracle.steady_pressure}[key]
        for (axes, k), phi in product(zip(panels, EXPONENTS, strict=True), AMPLITUDES):
            line = named[axes, rf"$F_x/(\mu F_N) = {phi:g}$"]
            # next to the stick-slip boundary the radius itself is rounded
            within = np.quantile(np.asarray(line.get_xdata())[[0, -1]], (0.02, 0.98))
            yield line, tuple(within), lambda r, k=k, phi=phi: field(r, k, phi)


LONG = [long_case(key) for key in ("3", "5", "8", "9", "10")]


@pytest.mark.usefixtures("known")
@parametrize("key", ["2", "4", "7", *LONG])
def test_curves_are_those_of_the_equations(key):
    figure = figures.FIGURES[key].draw()
    for line, (lower, upper), equation in curves(key, figure.axes):
        x, y = np.asarray(line.get_data(), float)
        inside = np.flatnonzero((x > lower) & (x < upper))
        places = inside[np.linspace(0, inside.size - 1, 4).astype(int)]  # also next to both ends
        assert_allclose(y[places], [float(equation(x[n])) for n in places], rtol=1e-11)
    if key == "2":
        lower, upper = figure.axes[0].get_ylim()
        assert lower > upper  # downwards
    if key == "4":
        assert any("15.5 % at $k = 0.169$" in text.get_text() for text in figure.axes[0].texts)


# --- what is said of it ---------------------------------------------------------------------------------------------


def test_the_least_favourable_claim_counts():
    claims = [figures.Claim("", "", *how) for how in ((True,), (False,), (False, True))]
    assert [figures.verdict(claims[:1]), figures.verdict(claims), figures.verdict(claims[::2])] == [
        "agrees",
        "differs",
        "agrees in part",
    ]


@long
def test_a_wrong_library_would_not_agree(monkeypatch):
    right = gross_slip.force_ratio
    monkeypatch.setattr(gross_slip, "force_ratio", lambda k: right(k) * 1.3)
    monkeypatch.setattr(drawings, "numbers", lambda: dict.fromkeys(figures.NUMBERS, 0.3))
    for key in ("4", "5", "eq-27", "9"):
        assert figures.FIGURES[key].check()[0].verdict == "differs"


@long
def test_numbers_are_those_of_the_oracle():
    library, exact = figures.numbers(), paper_numbers.from_oracle()
    assert library.keys() == exact.keys() == figures.NUMBERS.keys()
    for name, value in library.items():
        assert value == pytest.approx(float(exact[name]), rel=1e-11), name


def test_numbers_are_printed_as_the_paper_prints_them():
    exact = paper_numbers.from_oracle()
    for name, asked in figures.NUMBERS.items():
        if re.fullmatch(r"\d\.\d+", asked.printed) and asked.where != "Table 1":
            digits = len(asked.printed.partition(".")[2])
            assert f"{float(exact[name]):.{digits}f}" == asked.printed
    assert f"{100 * float(exact['best_change']):.1f} %" == figures.NUMBERS["best_change"].printed


@compiled
@parametrize("number, words, ratio", paper_numbers.EQUATIONS)
def test_equations_agree_but_for_two_misprints(number, words, ratio):
    expected = 1
    if "as printed" in words:
        expected = {"(2)": 1 / paper_numbers.A, "(22)": paper_numbers.mpf("0.4")}[number]
    with paper_numbers.mp.workdps(40):
        off = [abs(x / expected - 1) for x in paper_numbers.ratios(ratio)]
    assert max(off) < (1e-14 if "as printed" in words else paper_numbers.EQUAL)


@long
def test_the_page_holds_what_the_program_prints():
    page = PAGE.read_text("utf-8")
    tables = {"numbers": paper_numbers.number_table(), "equations": paper_numbers.equation_table()}
    assert paper_numbers.renewed(page, tables) == page
    assert "off by" not in page


# --- the command ----------------------------------------------------------------------------------------------------


def run(*arguments):
    return plgwear("figures", *arguments)


@pytest.mark.usefixtures("known")
def test_command_writes_pictures_and_a_report(here):
    found = run("--out", "drawn", "--only", "04")
    assert found.exit_code == 0 and found.stderr == ""
    assert found.stdout.splitlines() == ["Fig. 4    Effective volume change over the exponent: agrees"]
    pictures = {f"{stem}.{kind}" for stem in ("contact-sheet", "fig-04") for kind in ("pdf", "png")}
    assert {path.name for path in Path("drawn").iterdir()} == {*pictures, "figures.md"}
    assert image.imread("drawn/fig-04.png").shape[1] == int(8.6 / 2.54 * 300)
    assert Path("drawn/fig-04.pdf").read_bytes().startswith(b"%PDF")
    report = Path("drawn/figures.md").read_text("utf-8")
    for link in re.findall(r"\]\((.*?)\)", report):
        assert Path("drawn", link).is_file()
    assert "| 0.169 | 0.16890194 |" in report and "Fig. 9:" not in report

    again = figures.FIGURES["4"].draw()
    for kind in ("pdf", "png"):
        plots.save(again, f"again.{kind}")
        assert Path(f"again.{kind}").read_bytes() == Path(f"drawn/fig-04.{kind}").read_bytes()


@cases("plots/refused.toml", "figures")
def test_command_refuses_in_one_line_what_it_cannot_write(here, case):
    Path("file").write_text("mine")
    Path("full/fig-04.pdf").mkdir(parents=True)
    assert is_told(refused("figures", *case["arguments"]), case)
    assert Path("file").read_text() == "mine"


@long
def test_command_draws_all_figures(tmp_path):
    found = run("--out", str(tmp_path / "all"))
    assert found.exit_code == 0
    verdicts = [line.rpartition(": ")[2] for line in found.stdout.splitlines()]
    assert verdicts == ["agrees in part" if key in IN_PART else "agrees" for key in figures.FIGURES]
    pictures = [*(tmp_path / "all").glob("*.png")]
    assert len(pictures) == len(figures.FIGURES) + 1
    widths = {image.imread(path).shape[1] for path in pictures if path.stem != "contact-sheet"}
    assert widths == {int(cm / 2.54 * 300) for cm in (8.6, 17.8)}  # of a column and of a page
    for key in ("1", "6"):  # the set-ups
        assert any("F_" in text.get_text() for text in figures.FIGURES[key].draw().axes[0].texts)
