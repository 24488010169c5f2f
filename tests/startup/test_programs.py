"""Only what is asked for: what compiled programs are made of, and which numbers enter them.

A lowered program tells its arguments, the functions that it calls, and the line of source of every operation. Besides,
a scene must solve while all that it does not ask for is a trap.
"""

import logging
import re
from pathlib import Path
from typing import NamedTuple

import jax
import pytest
from dependence import FRETTING, GOOD, GROSS_SLIP, MATERIAL, build, depends
from functions import FUNCTIONS, arguments
from marks import compiled, parametrize

import plgwear_jax
from plgwear_jax import FrettingContact, GrossSlipContact, optimise, scene
from plgwear_jax._core import catalogue
from plgwear_jax.loads import Force
from plgwear_jax.scene import solving

PACKAGE = Path(plgwear_jax.__file__).parent
PUBLIC = {name.partition(".")[2] for name in FUNCTIONS} - {"amplitude"}  # a method of contacts as well
OWN = {name for path in PACKAGE.rglob("*.py") for name in re.findall(r"def (\w+)", path.read_text("utf-8"))}


class Made(NamedTuple):
    """What a program is made of."""

    arguments: set[str]  # the numbers that enter it: "material.k"
    functions: set[str]  # the public functions among those that it calls: "wear_volume"
    files: set[str]  # of the package, that some operation comes from: "special/gamma.py"
    text: str


def made_of(lowered):
    text = lowered.as_text(debug_info=True)
    places = dict(re.findall(r"^(#loc\d*) = (loc\(.*\))$", text, re.MULTILINE))
    called, files = set(), set()
    for head, body in re.findall(r"^  func\.func (.*?\{)$(.*?)^  \}", text, re.MULTILINE | re.DOTALL):
        name = re.search(r'@"?([^"(]+?)(?:_\d+)?"?\(', head)[1]
        called.add(name)
        # The body of a function of jax.numpy is of whoever traced it first.
        if name in OWN or not hasattr(jax.numpy, name.removeprefix("_")):
            files.update(*(files_of(place, places) for place in set(re.findall(r"loc\((#loc\d*)\)", body))))
        if name == "main":
            arguments = re.findall(r'%arg\d+: [^%]*?loc\("(?:contact\.|\w+\[\')?([\w.]+)(?:\'\])?"\)', head)
            assert len(arguments) == head.count("%arg")
    return Made(set(arguments), called & PUBLIC, files, text)


def files_of(place, places):
    """The files of the package that a place in a program refers to."""
    said = places[place]
    paths = [Path(path) for path in re.findall(r'"([^"]+\.py)":\d', said)]
    found = {path.relative_to(PACKAGE).as_posix() for path in paths if path.is_relative_to(PACKAGE)}
    return found.union(*(files_of(other, places) for other in re.findall(r"#loc\d*", said)))


@pytest.fixture(autouse=True)
def _innermost_lines():
    """Let an operation be of the line that it is written in, not of whoever traced it first."""
    name = "jax_include_full_tracebacks_in_locations"
    before = getattr(jax.config, name)
    jax.config.update(name, False)
    yield
    jax.config.update(name, before)


# --- dimensionless functions ----------------------------------------------------------------------------------------

DISC = "gross_slip.steady_displacement"
GAMMA = {DISC, "gross_slip.volume_change", "material.h_N", "material.tangential_ratio"}
WITH_SERIES = {
    DISC,
    "gross_slip.initial_displacement",
    "fretting.wear_volume",
    "fretting.worn_radius",
    "fretting.deepest_wear",
    "fretting.profile",
    "fretting.wear_depth",
    "fretting.initial_displacement",
    "fretting.steady_displacement",
    "partial_slip.slip_amplitude",
}
PARTS = {"partial_slip.slip_amplitude": {"stick_radius"}}


@parametrize("name", FUNCTIONS)
def test_a_function_is_made_of_no_other_one(name):
    # Within another function, so that the program itself does not count as a call.
    program = jax.jit(lambda **at: FUNCTIONS[name](**at))
    made = made_of(program.lower(**{key: GOOD[key] for key in arguments(name)}))
    module, _, own = name.partition(".")
    assert made.functions - {own} == PARTS.get(name, set())
    rooms = {file.removesuffix(".py").partition("/")[0] for file in made.files}
    allowed = {module, "fretting"} if PARTS.get(name) else {module}
    assert rooms & {"fretting", "gross_slip", "material", "partial_slip", "contact"} <= allowed
    assert made.arguments == set(arguments(name))
    # Gamma functions and series are only where the formula has them.
    assert ("special/gamma.py" in made.files) == (name in GAMMA)
    assert ("special/disc.py" in made.files) == (name == DISC)
    series = {"special/arcsine.py", "special/lerch.py", "special/disc.py"}
    assert bool(made.files & series) == (name in WITH_SERIES)


@compiled
def test_the_optimal_exponent_needs_the_wear_volume_alone():
    made = made_of(jax.jit(optimise.optimal_exponent).lower(0.3))
    assert made.functions == {"wear_volume"}
    assert made.arguments == {"phi"}
    assert not made.files & {
        "material.py",
        "contact/fretting_contact.py",
        "gross_slip.py",
        "special/gamma.py",
        "special/disc.py",
    }


# --- contacts in SI units -------------------------------------------------------------------------------------------

DOME, PUNCH = build(FrettingContact), build(GrossSlipContact)
OTHERS = {"modulus_at"} | catalogue.STRESSES | catalogue.TANGENTIAL.keys()  # whose programs are long
ASKED = [(DOME, name) for name in ("amplitude", *catalogue.FRETTING) if name not in OTHERS]
ASKED += [(PUNCH, name) for name in catalogue.GROSS_SLIP if name not in OTHERS]
PATHS = {name: f"material.{name}" for name in MATERIAL} | {"tangential_force": "load.tangential_force"}


def enters(contact, name):
    """The numbers that a quantity depends on, by their paths."""
    return {PATHS.get(number, number) for number in depends(type(contact), name)}


def has_stiffness(contact, name):
    """Whether that of the half-space does not cancel, and h_N with it."""
    return {*MATERIAL} <= depends(type(contact), name)


def about(contact, name):
    return f"{type(contact).__name__}.{name}"


def of_quantity(contact, name, **given):
    def read(contact, load, **given):
        steady = contact.steady() if isinstance(contact, GrossSlipContact) else contact.steady(load)
        return getattr(steady, name)(**given) if given else getattr(steady, name)

    program = jax.jit(lambda contact, load, **given: read(contact, load, **given))
    return made_of(program.lower(contact, Force(0.3), **given))


@parametrize("contact, name", ASKED, ids=[about(*one) for one in ASKED])
def test_only_what_a_result_depends_on_enters_its_program(contact, name):
    known = enters(contact, name)
    made = of_quantity(contact, name, **{key: 1e-5 for key in ("r", "distance") if key in known})
    assert made.arguments == known
    assert ("material.py" in made.files) == has_stiffness(contact, name)


def test_poissons_ratio_does_not_enter_where_it_follows_from_the_exponent():
    holl = build(FrettingContact, nu="holl")
    assert of_quantity(holl, "wear_volume").arguments == enters(DOME, "wear_volume") - {"material.nu"}


# --- scenes ---------------------------------------------------------------------------------------------------------

SCENES = {
    FrettingContact: {"contact": {"kind": "fretting", **FRETTING}, "load": {"tangential_force": 0.32}},
    GrossSlipContact: {"contact": {"kind": "gross-slip", **GROSS_SLIP}},
}
OF_SCENES = [one for one in ASKED if one[1] not in ("amplitude", "edge_pressure", "force_drop")]

POINTS = 37  # of no other test, and no series has as many terms


def asking_for(contact, name):
    wanted = {"material": MATERIAL, "output": {"quantities": [name], "points": POINTS}}
    return scene.scene_of(SCENES[type(contact)] | wanted)


def needed(contact, name):
    """The dimensionless functions behind a quantity of a scene."""
    if contact is PUNCH:
        return {"initial_force": set(), "steady_force": {"force_ratio"}}.get(name, {name})
    # What is unbounded at the stick-slip boundary is given beside it as well.
    own = {f"steady_{name}", "stick_radius"} if name in ("pressure", "traction") else {name} - {"contact_radius"}
    own = {"initial_pressure"} if name == "peak_initial_pressure" else own
    # A function of the radius is given in the worn ring and beyond it.
    return own | ({"stick_radius", "worn_radius"} if "r" in enters(contact, name) else set())


def program_of(monkeypatch, given):
    """The program that solving a scene comes down to, not run."""
    lower, programs = solving.scene_values.jitted.lower, []

    class LoweredError(Exception):
        pass

    def lowered(*args, **kwargs):
        programs.append(made_of(lower(*args, **kwargs)))
        raise LoweredError

    monkeypatch.setattr(solving, "scene_values", lowered)
    with pytest.raises(LoweredError):
        given.solve()
    return programs[0]


@parametrize("contact, name", OF_SCENES, ids=[about(*one) for one in OF_SCENES])
def test_the_program_of_a_scene_holds_what_is_asked_for(monkeypatch, contact, name):
    made, stiffness = program_of(monkeypatch, asking_for(contact, name)), has_stiffness(contact, name)
    along_radius = "r" in enters(contact, name)
    stiffness |= contact is DOME  # whose lengths are in the contact radius
    assert made.functions == needed(contact, name)
    assert ("material.py" in made.files) == stiffness
    assert ("special/gamma.py" in made.files) == (stiffness or name in ("steady_displacement", "volume_change"))
    assert (f"tensor<{POINTS}x" in made.text) == along_radius
    # The worn radius bounds the radii, so whatever runs along them feels the slip.
    feels = "wear_volume" if contact is DOME and along_radius else name
    assert made.arguments == enters(contact, feels) - {"r"}


@parametrize("contact, name", [(DOME, "wear_volume"), (PUNCH, "force_ratio")])
def test_solving_compiles_nothing(caplog, contact, name):
    given = asking_for(contact, name)
    with jax.log_compiles(), caplog.at_level(logging.WARNING):
        given.solve(digits=13)
    compiled = re.findall(r"Finished XLA compilation of (?:jit\()?(\w+)", caplog.text)
    assert not compiled
