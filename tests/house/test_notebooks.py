"""The notebooks run from top to bottom, and are committed as they ran: in order, with outputs, without complaints."""

import base64
import re

import nbformat
import processes
import pytest
from inputs import ROOT
from marks import compiled, long, parametrize

FOLDER = ROOT / "notebooks"
NAMES = sorted(path.stem for path in FOLDER.glob("*.ipynb"))

execute = processes.module_at(FOLDER / "execute.py")


def read(name):
    return nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)


def code_cells(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def outputs(notebook):
    return [output for cell in code_cells(notebook) for output in cell.outputs]


def pictures(cells):
    """The PNG files among the outputs of some cells."""
    found = [output.data.get("image/png") for cell in cells for output in cell.outputs if "data" in output]
    return [base64.b64decode(picture) for picture in found if picture]


def printed(notebook):
    return "".join(output.text for output in outputs(notebook) if output.output_type == "stream")


def assert_clean(notebook):
    """No errors, nothing on stderr, pictures that are pictures, something printed."""
    for output in outputs(notebook):
        assert output.output_type in ("stream", "display_data", "execute_result"), output
        assert output.get("name", "stdout") == "stdout", output
    assert pictures(code_cells(notebook)) and printed(notebook).strip()
    assert all(picture.startswith(b"\x89PNG") for picture in pictures(code_cells(notebook)))
    assert not re.search(r"\b(warning|traceback)\b", printed(notebook), re.IGNORECASE)


def run(notebook, folder):
    """The notebook as it ran in this interpreter's kernel; in a process of its own, as `make notebooks` does it."""
    path = folder / "notebook.ipynb"
    nbformat.write(notebook, path)
    processes.output(FOLDER / "execute.py", path)
    return nbformat.read(path, as_version=4)


def assert_runs_as_committed(name, folder, *more):
    """Run a notebook, with some more cells at its end; all cells, as they ran."""
    committed, notebook = read(name), read(name)
    notebook.cells += [nbformat.v4.new_code_cell(code) for code in more]
    again = run(notebook, folder)
    cells = list(again.cells)
    del again.cells[len(committed.cells) :]
    assert_clean(again)
    # The same cells draw and print; the numbers are those of another machine.
    assert kinds(again) == kinds(committed)
    return cells


def kinds(notebook):
    return [
        [(output.output_type, sorted(output.get("data", {}))) for output in cell.outputs]
        for cell in code_cells(notebook)
    ]


@parametrize("name", NAMES)
def test_committed_as_it_ran(name):
    notebook = read(name)
    nbformat.validate(notebook)
    assert_clean(notebook)
    assert [cell.execution_count for cell in code_cells(notebook)] == list(range(1, len(code_cells(notebook)) + 1))
    assert notebook.cells[0].cell_type == "markdown" and notebook.cells[0].source.startswith("# ")
    assert notebook == execute.tidy(read(name))  # no times, no versions, no sliders without a kernel


@parametrize("name", NAMES)
def test_only_what_everybody_has_is_used(name):
    """Nothing that only one machine has, public names, and links that lead somewhere."""
    text = (FOLDER / f"{name}.ipynb").read_text("utf-8")
    text = re.sub(r'"image/png": "[^"]*"', "", text)
    assert not re.search(r"/(home|Users|root|tmp|work|usr|opt|var|private)/|\b[A-Z]:\\\\", text)
    code = "\n".join(cell.source for cell in code_cells(read(name)))
    assert "plgwear_jax" in code
    assert not re.search(r"plgwear_jax(\.\w+)*\._|import _|\b(question|task)\b", code)
    prose = "\n".join(cell.source for cell in read(name).cells if cell.cell_type == "markdown")
    for link in re.findall(r"\]\(([^)#]+)\)", prose):
        assert (FOLDER / link).exists(), link


# These compile derivatives of whole models, and numeric contacts; then searches.
SLOW = dict.fromkeys(
    ("05_in_your_model", "06_wear_over_cycles", "07_real_coatings", "08_from_test_to_design"),
    long,
)
SLOW |= dict.fromkeys(("01_first_steps", "03_best_for_what", "04_sweeps"), compiled)


WITH_SLIDERS = "02_optimum"


@parametrize(
    "name",
    [pytest.param(name, marks=SLOW.get(name, ())) for name in NAMES if name != WITH_SLIDERS],
)
def test_they_run(name, tmp_path):
    if "import blackjax" in "".join(cell.source for cell in code_cells(read(name))):
        pytest.importorskip("blackjax")  # of the extras notebooks and dev
    assert_runs_as_committed(name, tmp_path)


@compiled
def test_the_one_with_sliders_runs_and_they_redraw_the_picture(tmp_path):
    move = "amplitude.value = 0.5\nbounds.value = (-0.5, 0.5)"
    wanted = "display(draw(0.5, (-0.5, 0.5)))"
    other = "display(draw(0.15, (-0.9, 0.9)))"  # what they start with
    cells = assert_runs_as_committed(WITH_SLIDERS, tmp_path, move, wanted, other)
    (shown,), (wanted,), (other,) = (pictures([cells[place]]) for place in (-4, -2, -1))
    assert shown == wanted != other


def test_an_error_in_a_cell_is_told(tmp_path):
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell("1 / 0")])
    with pytest.raises(AssertionError, match="ZeroDivisionError"):
        run(notebook, tmp_path)
