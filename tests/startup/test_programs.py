"""Only what is asked for: what compiled programs are made of, and which numbers enter them.

A lowered program tells its arguments, the functions that it calls, and the line of source of every operation. Besides,
a scene must solve while all that it does not ask for is a trap.
"""

import functools
import logging
import re
from pathlib import Path
from typing import NamedTuple

import jax
import pytest
from functions import FUNCTIONS, arguments

import plgwear_jax
from plgwear_jax import FrettingContact, GrossSlipContact, PowerLawGraded, fretting, optimise, scene
from plgwear_jax.loads import Force
from plgwear_jax.scene import solving

PACKAGE = Path(plgwear_jax.__file__).parent
PUBLIC = {name.partition(".")[2] for name in FUNCTIONS} - {"amplitude"}  # a method of contacts as well
OWN = {name for path in PACKAGE.rglob("*.py") for name in re.findall(r"def (\w+)", path.read_text(encoding="utf-8"))}


class Made(NamedTuple):
    """What a program is made of."""

    arguments: set[str]  # the numbers that enter it: "material.k"
    functions: set[str]  # the public functions among those that it calls: "wear_volume"
    files: set[str]  # of the package, that some operation comes from: "special/gamma.py"
    text: str


def made_of(lowered) -> Made:
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


def files_of(place: str, places: dict[str, str]) -> set[str]:
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


@functools.cache
def of_function(name: str) -> Made:
    at = {"r": 0.7, "distance": 0.1, "k": 0.3, "phi": 0.4, "nu": 0.25, "compliance": 0.5, "displacement": 0.4}
    # Within another function, so that the program itself does not count as a call.
    program = jax.jit(lambda **at: FUNCTIONS[name](**at))
    return made_of(program.lower(**{key: at[key] for key in arguments(name)}))


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_is_made_of_no_other_one(name):
    made = of_function(name)
    module, _, own = name.partition(".")
    assert made.functions - {own} == PARTS.get(name, set())
    rooms = {file.removesuffix(".py").partition("/")[0] for file in made.files}
    allowed = {module, "fretting"} if PARTS.get(name) else {module}
    assert rooms & {"fretting", "gross_slip", "material", "partial_slip", "contact"} <= allowed
    assert made.arguments == set(arguments(name))


@pytest.mark.parametrize("name", FUNCTIONS)
def test_gamma_functions_and_series_are_only_where_the_formula_has_them(name):
    made = of_function(name)
    assert ("special/gamma.py" in made.files) == (name in GAMMA)
    assert ("special/disc.py" in made.files) == (name == DISC)
    series = {"special/arcsine.py", "special/lerch.py", "special/disc.py"}
    assert bool(made.files & series) == (name in WITH_SERIES)


def operations(function, *at: float) -> int:
    """Operations in a program before XLA simplifies it, those of a function as often as it is called."""
    text = jax.jit(function).lower(*at).as_text()
    bodies = dict(re.findall(r"^  func\.func \w+ @(\w+)\(.*?\{$(.*?)^  \}", text, re.MULTILINE | re.DOTALL))

    @functools.cache
    def count(name: str) -> int:
        called = re.findall(r"call @(\w+)\(", bodies[name])
        return len(re.findall(r"^ *%\S+ = ", bodies[name], re.MULTILINE)) + sum(map(count, called))

    return count("main")


@pytest.mark.compiled
@pytest.mark.parametrize("name", ["wear_volume", "worn_radius", "deepest_wear", "penetration"])
def test_a_derivative_that_nobody_asks_for_is_not_in_the_program(name):
    function = getattr(fretting, name)
    by_k, by_phi, by_both = (operations(jax.grad(function, i), 0.3, 0.4) for i in (0, 1, (0, 1)))
    assert max(by_k, by_phi) < 0.9 * by_both


@pytest.mark.compiled
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

COATING = PowerLawGraded(E0=110e9, z0=1e-4, k=0.25, nu=0.3)
DOME = FrettingContact(COATING, radius=5e-3, normal_force=10.0, friction=0.4)
PUNCH = GrossSlipContact(COATING, radius=2e-3, depth=1e-6)

MATERIAL = {"material.E0", "material.z0", "material.k", "material.nu"}
SCALE = MATERIAL | {"radius", "normal_force"}  # what sets the contact radius
SLIP = SCALE | {"friction", "load.tangential_force"}
FLAT, PRESSED = {"material.k", "radius", "depth"}, MATERIAL | {"radius", "depth"}

ENTERS_DOME = {
    "amplitude": {"normal_force", "friction", "load.tangential_force"},
    "contact_radius": SCALE,
    "peak_initial_pressure": SCALE,
    "stick_radius": SLIP,
    "worn_radius": SLIP,
    "penetration": SLIP,
    "wear_volume": SLIP,
    "deepest_wear": SLIP,
    "edge_intensity": SLIP,
    "edge_pressure": SLIP | {"distance"},
    "initial_displacement": SCALE | {"r"},
    "initial_pressure": SCALE | {"r"},
    "steady_displacement": SLIP | {"r"},
    "pressure": SLIP | {"r"},
    "traction": SLIP | {"r"},
    "profile": SLIP | {"r"},
    "wear_depth": SLIP | {"r"},
}
ENTERS_PUNCH = {
    "force_ratio": {"material.k"},
    "force_drop": {"material.k"},
    "volume_change": FLAT,
    "initial_force": PRESSED,
    "steady_force": PRESSED,
    "initial_displacement": FLAT | {"r"},
    "steady_displacement": FLAT | {"r"},
    "initial_pressure": PRESSED | {"r"},
    "steady_pressure": PRESSED | {"r"},
}
METHODS = [(DOME, name, enters) for name, enters in ENTERS_DOME.items()]
METHODS += [(PUNCH, name, enters) for name, enters in ENTERS_PUNCH.items()]


def of_quantity(contact, name: str, **given: float) -> Made:
    def read(contact, load, **given):
        steady = contact.steady() if isinstance(contact, GrossSlipContact) else contact.steady(load)
        return getattr(steady, name)(**given) if given else getattr(steady, name)

    made = made_of(
        jax.jit(lambda contact, load, **given: read(contact, load, **given)).lower(contact, Force(0.3), **given)
    )
    return made


@pytest.mark.parametrize("contact, name, enters", METHODS, ids=[f"{type(c).__name__}.{n}" for c, n, _ in METHODS])
def test_only_what_a_result_depends_on_enters_its_program(contact, name, enters):
    made = of_quantity(contact, name, **{key: 1e-5 for key in ("r", "distance") if key in enters})
    assert made.arguments == enters
    # h_N is there where the stiffness of the half-space is.
    assert ("material.py" in made.files) == (enters >= MATERIAL)


def test_poissons_ratio_does_not_enter_where_it_follows_from_the_exponent():
    holl = FrettingContact(PowerLawGraded(110e9, 1e-4, 0.25, "holl"), 5e-3, 10.0, 0.4)
    assert of_quantity(holl, "wear_volume").arguments == SLIP - {"material.nu"}


# --- scenes ---------------------------------------------------------------------------------------------------------

BODY = {"E0": 110e9, "z0": 1e-4, "k": 0.25, "nu": 0.3}
SCENES = {
    "fretting": {
        "material": BODY,
        "contact": {"kind": "fretting", "radius": 5e-3, "normal_force": 10.0, "friction": 0.4},
        "load": {"tangential_force": 0.32},
    },
    "gross-slip": {"material": BODY, "contact": {"kind": "gross-slip", "radius": 2e-3, "depth": 1e-6}},
}
QUANTITIES = [("fretting", name) for name in ENTERS_DOME if name not in ("amplitude", "edge_pressure")]
QUANTITIES += [("gross-slip", name) for name in ENTERS_PUNCH if name != "force_drop"]
each_quantity = pytest.mark.parametrize("kind, name", QUANTITIES)

POINTS = 37  # of no other test, and no series has as many terms


def asking_for(kind: str, *names: str) -> scene.Scene:
    return scene.scene_of(SCENES[kind] | {"output": {"quantities": names, "points": POINTS}})


def along_radius(kind: str, name: str) -> bool:
    return "r" in (ENTERS_DOME if kind == "fretting" else ENTERS_PUNCH)[name]


def needed(kind: str, name: str) -> set[str]:
    """The dimensionless functions behind a quantity of a scene."""
    if kind == "gross-slip":
        return {"initial_force": set(), "steady_force": {"force_ratio"}}.get(name, {name})
    # A function of the radius is given to beyond the worn ring.
    own = {"initial_pressure"} if name == "peak_initial_pressure" else {name} - {"contact_radius"}
    own = {f"steady_{name}"} if name in ("pressure", "traction") else own
    # What is unbounded at the stick-slip boundary is given beside it as well.
    edge = {"stick_radius"} if name in ("pressure", "traction") else set()
    return own | edge | ({"worn_radius"} if along_radius(kind, name) else set())


def is_unitless(kind: str, name: str) -> bool:
    """Whether the half-space's stiffness cancels, and h_N with it."""
    return kind == "gross-slip" and not ENTERS_PUNCH[name] >= MATERIAL


def program_of(monkeypatch, given: scene.Scene) -> Made:
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


@each_quantity
def test_the_program_of_a_scene_holds_what_is_asked_for(monkeypatch, kind, name):
    made = program_of(monkeypatch, asking_for(kind, name))
    assert made.functions == needed(kind, name)
    assert ("material.py" in made.files) == (not is_unitless(kind, name))
    gamma = {"steady_displacement", "volume_change"} if kind == "gross-slip" else set()
    assert ("special/gamma.py" in made.files) == (name in gamma or not is_unitless(kind, name))
    assert (f"tensor<{POINTS}x" in made.text) == along_radius(kind, name)
    if kind == "gross-slip":
        assert made.arguments == ENTERS_PUNCH[name] - {"r"}
    else:  # the worn radius bounds the radii, so whatever runs along them feels the slip
        assert made.arguments == (SLIP if along_radius(kind, name) else ENTERS_DOME[name])


@pytest.mark.parametrize("kind, name", [("fretting", "wear_volume"), ("gross-slip", "force_ratio")])
def test_solving_compiles_nothing(caplog, kind, name):
    given = asking_for(kind, name)
    with jax.log_compiles(), caplog.at_level(logging.WARNING):
        given.solve(digits=13)
    compiled = re.findall(r"Finished XLA compilation of (?:jit\()?(\w+)", caplog.text)
    assert not compiled
