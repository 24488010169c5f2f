"""The rooms of the library: which of them may use which, without circles, and how long a file is."""

import ast
import functools
import graphlib
from importlib import util
from pathlib import Path

from marks import parametrize

import plgwear_jax

PACKAGE = Path(plgwear_jax.__file__).parent

# Each room may use those above it; those in one line do not know each other.
FLOORS = """
    _version
    _core
    special
    material gross_slip fretting
    partial_slip shapes
    surfaces
    loads wear_laws stresses
    steady
    wear
    contact
    optimise
    tables fitting coating
    scene sweep
    plots
    cli
    __main__
"""
FLOOR = {room: floor for floor, rooms in enumerate(FLOORS.strip().splitlines()) for room in rooms.split()}


def module_of(file):
    parts = file.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


FILES = {module_of(file): file for file in sorted(PACKAGE.rglob("*.py"))}


@functools.cache
def imports_of(module):
    """The modules of the package that a module imports, also within its functions, and those it names for pyright."""
    found = set()
    for node in ast.walk(ast.parse(FILES[module].read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom):
            # From its own room a module imports by relative paths.
            source = util.resolve_name("." * node.level + (node.module or ""), util.find_spec(module).parent)
            for alias in node.names:
                whole = f"{source}.{alias.name}"
                found.add(whole if whole in FILES else source)
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
    return {one for one in found if one.startswith("plgwear_jax")}


def room_of(module):
    return module.split(".")[1]


def test_every_room_has_its_floor():
    assert {room_of(module) for module in FILES if module != "plgwear_jax"} == FLOOR.keys()


@parametrize("module", sorted(FILES.keys() - {"plgwear_jax"}))
def test_a_room_uses_those_above_it_alone(module):
    room = room_of(module)
    assert "plgwear_jax" not in imports_of(module)  # the root knows all others
    used = {room_of(other) for other in imports_of(module)} - {room}
    assert {other for other in used if FLOOR[other] >= FLOOR[room]} == set()


def test_there_is_no_circle():
    """But for a room and its own files: `cli` imports its commands, and these import each other by way of `cli`."""
    within = {module: {other for other in imports_of(module) if not module.startswith(f"{other}.")} for module in FILES}
    graphlib.TopologicalSorter(within).prepare()


SUBJECTS = {"plgwear_jax.optimise.evaluation", "plgwear_jax.optimise.search"}


def test_files_have_one_subject():
    """Few are longer: those whose subject the house draws as one file."""
    assert {module for module, file in FILES.items() if len(file.read_text("utf-8").splitlines()) > 600} <= SUBJECTS
