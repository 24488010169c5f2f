"""Scene files: what is refused and in which words, and that only what is asked for is computed."""

import copy
import json
import tomllib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from dependence import PLACES
from hypothesis import given
from hypothesis import strategies as st
from inputs import DESIGNS, changed, scene_of
from kinds import dome
from marks import compiled, compiled_case, parametrize
from numpy.testing import assert_allclose, assert_array_equal
from refusals import cases, data, is_told, refusal

from plgwear_jax import GrossSlipContact, PowerLawGraded, loads, optimise, scene, sweep
from plgwear_jax._core import catalogue
from plgwear_jax._core.catalogue import QUANTITIES as LAWS
from plgwear_jax.optimise.evaluation import evaluate
from plgwear_jax.optimise.question import question_of

FRETTING = """
[material]
E0 = 110e9
z0 = 1e-4
k = 0.25
nu = 0.3

[contact]
kind = "fretting"
radius = 0.005
normal_force = 10.0
friction = 0.4

[load]
tangential_force = 0.32

[design]
vary = { k = [-0.9, 0.9] }
hold = "contact_radius"
minimise = "wear_volume"

[output]
quantities = ["wear_volume", "profile"]
"""

SINGLE_NUMBERS = FRETTING.partition("[output]")[0]

GROSS_SLIP = """
[material]
E0 = 1e9
z0 = 1e-3
k = -0.5
nu = "holl"

[contact]
kind = "gross-slip"
radius = 2e-3
depth = 1e-6
"""

PUNCH_DESIGN = """
[design]
vary = { k = [0, 0.5] }
minimise = "force_drop"
"""

FRETTING_LAWS, PUNCH_LAWS = LAWS.values()
AT_PLACES = "\n".join(f"{place} = {value}" for place, value in PLACES.items() if place != "r")
WITHOUT_LOAD = [name for name, law in FRETTING_LAWS.items() if not {"F_x", "r"} & {*law.arguments}]
UNSTRESSED = [name for name in FRETTING_LAWS if name not in catalogue.STRESSES]
SINGLE = [name for name in UNSTRESSED if {*FRETTING_LAWS[name].arguments} <= {"F_x"}]


SCENE = Path("scene.toml")


def read(content):
    SCENE.write_bytes(content if isinstance(content, bytes) else content.encode())
    return scene.load(SCENE)


def complaint(content):
    return refusal(scene.SceneError, lambda: read(content).asked())


# --- what is refused ------------------------------------------------------------------------------------------------

QUANTITIES = 'quantities = ["wear_volume", "profile"]'
HOLD = 'hold = "contact_radius"\n'
MINIMISE = 'minimise = "wear_volume"'


@cases("scene/refused.toml", "fretting")
def test_refusal_says_file_section_key_value_and_what_is_allowed(case):
    assert is_told(complaint(changed(FRETTING, (case["old"], case["new"]))), case, "scene.toml")


@cases("scene/refused.toml", "punch")
def test_refusal_for_gross_slip(case):
    text = GROSS_SLIP.replace("depth = 1e-6", case.get("depth", "depth = 1e-6"))
    assert is_told(complaint(f"{text}{case['more']}"), case, "scene.toml")


def with_files(text, load, **files):
    """The scene with another load, whose tables are written."""
    for name, content in files.items():
        Path(f"{name}.csv").write_text(content)
    return changed(text, ("tangential_force = 0.32", load))


LOADS = "tangential_force,weight\n0.1,2\n0.4,1\n# broken\n0.6,0\n0.2,5\n"
CYCLES = "tangential_force\n0.1\n\n0.4\n0.4\n0.2\n"


@cases("scene/refused.toml", "loads")
def test_refusal_of_a_table_names_its_file_and_row(case):
    """Before it is read, the keys of all sections are checked."""
    text = changed(FRETTING, *case.get("changes", ()))
    assert is_told(complaint(with_files(text, case["load"], loads=case.get("content", ""))), case)


def test_tables_lie_beside_the_scene():
    text = with_files(SINGLE_NUMBERS, 'table = "below/loads.csv"')
    Path("inside/below").mkdir(parents=True)
    inside, loads = Path("inside/scene.toml"), Path("inside/below/loads.csv")
    inside.write_text(text)
    assert refusal(scene.SceneError, scene.load, inside) == "inside/below/loads.csv: there is no such file"
    loads.write_text(LOADS)
    absolute = changed(text, ("below/loads.csv", str(loads.absolute())))
    for found in (scene.load(inside), scene.load(inside.absolute()), read(absolute)):
        assert found.load.amplitudes.tolist() == [0.1, 0.4, 0.2]


@cases("scene/refused.toml", "files")
def test_refusal_of_what_is_not_toml(case):
    assert is_told(complaint(case["content"]), case, "scene.toml")


def test_refusal_of_what_no_reader_of_toml_can_take():
    assert (
        complaint(b"[material]\nE0 = '\xff'\n") == "scene.toml: is not a text file in UTF-8 (byte 17); save it as UTF-8"
    )
    for digit in "1[":
        line = complaint(f"a = {5000 * digit}\n")
        assert line == "scene.toml: is not valid TOML: a number too long or brackets too deep"


MISTAKES = data("scene/mistakes.toml")


def test_refusal_of_what_cannot_be_read():
    Path("folder.toml").mkdir()
    SCENE.write_text(FRETTING)
    for path, line in MISTAKES["unread"].items():
        assert refusal(scene.SceneError, scene.load, path) == line


def test_first_mistake_in_the_file_is_told():
    wrong = MISTAKES["first"]
    sections = changed(FRETTING, *wrong.values()).split("\n\n")
    for place, first in enumerate(wrong):
        text = "\n\n".join([*sections[place:], *sections[:place]])
        assert complaint(text).startswith(f"scene.toml: {first}")
    # What is missing comes after what is there.
    contact = FRETTING.split("\n\n")[1]
    assert complaint(changed(contact, ("friction", "fricton"))).startswith("scene.toml: [contact] fricton = 0.4: ")
    assert complaint(contact) == "scene.toml: [material]: missing; every input file needs this section"


def test_windows_text_is_read():
    assert read(b"\xef\xbb\xbf" + FRETTING.replace("\n", "\r\n").encode()).material.k == 0.25


# --- what is computed -----------------------------------------------------------------------------------------------


def test_contact_has_the_numbers_of_the_file():
    assert read(FRETTING).build_contact() == dome(0.25)
    assert read(GROSS_SLIP).build_contact() == GrossSlipContact(PowerLawGraded(1e9, 1e-3, -0.5, "holl"), 2e-3, 1e-6)


def test_design_has_what_the_search_takes():
    begin = with_files(SINGLE_NUMBERS, 'table = "loads.csv"', loads=LOADS).partition("[design]")[0]
    for case in data("scene/designs.toml")["designs"]:
        found, told = read(f"{begin}[design]\n{case['design']}").design_space, json.loads(case["told"])
        assert json.loads(json.dumps({name: getattr(found, name) for name in told})) == told, case


def test_load_has_the_amplitudes_of_the_file():
    def load(given, **files):
        return read(with_files(SINGLE_NUMBERS, given, **files)).load

    one = load("tangential_force = 0.32")
    assert one.amplitudes.tolist() == [0.32] and one.weights is None
    assert one.largest == 0.32 and one.remark is None
    history = load('history = "cycles.csv"', cycles=CYCLES)
    assert history.amplitudes.tolist() == [0.1, 0.4, 0.4, 0.2] and history.weights is None
    assert history.acting(False).amplitude == history.largest == 0.4
    assert history.remark == "history cycles.csv: 4 amplitudes; the largest, 0.4 N (row 4), decides the worn state"
    single = load('history = "a\\nb.csv"', **{"a\nb": "tangential_force\n0.125\n"})
    assert single.remark == "history a\\nb.csv: 1 amplitude; the largest, 0.125 N (row 2), decides the worn state"
    heavy = LOADS.replace("5\n", "1e308\n").replace("1\n", "1e308\n")
    for content, weights in ((LOADS, [0.25, 0.125, 0.625]), (heavy, [1e-308, 0.5, 0.5])):
        table = load('table = "loads.csv"', loads=content)
        assert table.amplitudes.tolist() == [0.1, 0.4, 0.2]
        assert_allclose(table.weights, weights, rtol=1e-15)
        assert table.largest == 0.4 and table.remark is None and table.tangential_force is None  # 0.6 has no weight


TWO_LIMITS = (
    f"{HOLD}limits = {{ edge_pressure = {{ below = 5e8, distance = 1e-6 }}, penetration = {{ below = 2e-6 }} }}\n"
)


def test_a_scene_asks_for_its_design_and_its_front(monkeypatch):
    monkeypatch.setattr(optimise, "front", lambda **given: SimpleNamespace(y=np.ones(2), reference_y=1.0, **given))
    text = changed(SINGLE_NUMBERS, (HOLD, TWO_LIMITS), (MINIMISE, f"{MINIMISE}\nover = {{ cvar = 0.9 }}"))
    given = read(with_files(text, 'table = "loads.csv"', loads=LOADS))
    design, front = given.arguments(), vars(given.front(points=5))
    for found in (design, front):
        assert_array_equal(found.pop("load").tangential_force, [0.1, 0.4, 0.2])
        assert_allclose(found.pop("weight"), [0.25, 0.125, 0.625])
        assert found.pop("contact") == given.build_contact()
    asked = {"vary": {"k": (-0.9, 0.9)}, "level": 0.9, "hold": "contact_radius", "minimise": "wear_volume"}
    depth, x = {"penetration": {"below": 2e-6}}, {"edge_pressure": {"distance": 1e-6}}
    pressure = {"edge_pressure": {"below": 5e8, "distance": 1e-6}}
    assert design == asked | {"limits": {name: [limit] for name, limit in (pressure | depth).items()}}
    assert [front.pop("reference_y"), *front.pop("y")] == [1.0, 1.0, 1.0]
    assert front == asked | {
        "x": x,
        "larger": "",
        "points": 5,
        "limits": {"edge_pressure": [], "penetration": [{"below": 2e-6}]},
    }
    assert vars(given.front(distance=2e-6))["x"] == {"edge_pressure": {"distance": 2e-6}}
    other = vars(given.front(x="penetration", y="edge_pressure", larger="y"))
    assert (other["x"], other["minimise"], other["larger"]) == ({"penetration": {}}, x, "y")
    assert other["limits"] == {"edge_pressure": [*pressure.values()], "penetration": []}
    # A window is two limits of the modulus, beside those that stand there as such.
    window = "modulus = { at = [1e-5, 1e-3], between = [[60e9, 400e9], [70e9, 300e9]] }"
    text = changed(
        SINGLE_NUMBERS, (HOLD, f"{HOLD}limits = {{ modulus_at = {{ below = 3e11, z = 1e-4 }}, {window} }}\n")
    )
    ends = [{"z": 1e-5, "between": (60e9, 400e9)}, {"z": 1e-3, "between": (70e9, 300e9)}]
    assert read(text).arguments()["limits"] == {"modulus_at": [{"below": 3e11, "z": 1e-4}, *ends]}
    near, far = ({"below": 5e8, "distance": distance} for distance in (1e-6, 2e-6))
    both = ", ".join(f"{{ below = 5e8, distance = {at['distance']} }}" for at in (near, far))
    several = read(changed(SINGLE_NUMBERS, (HOLD, f"{HOLD}limits = {{ pressure = [{both}] }}\n")))
    assert vars(several.front(distance=1e-6))["limits"] == {"pressure": [far]}


@cases("scene/refused.toml", "designs")
def test_a_design_that_cannot_be_looked_for_is_refused(monkeypatch, case):
    monkeypatch.setattr(optimise, "design", lambda **given: SimpleNamespace(value=case["value"], reference_value=1.0))
    given = read(case.get("text") or changed(SINGLE_NUMBERS, *case["changes"].items()))
    assert is_told(refusal(scene.SceneError, getattr(given, case["ask"]), **case.get("given", {})), case)


@parametrize(
    "text, load, content, said, rtol",
    [
        (FRETTING, 'history = "few.csv"', CYCLES, "", 0.0),
        (SINGLE_NUMBERS, 'table = "few.csv"', "weight,tangential_force\n3,0.4\n", "mean over few.csv: ", 1e-14),
    ],
)
def test_a_history_is_its_largest_amplitude_and_a_table_of_one_row_that_one(text, load, content, said, rtol):
    one = read(changed(text, ("0.32", "0.4"))).solve()
    several = read(with_files(text, load, few=content)).solve()
    for name, quantity in one.items():
        assert_allclose(several[name].value, quantity.value, rtol=rtol)
        assert several[name].description == f"{'' if name in WITHOUT_LOAD else said}{quantity.description}"


def law_of(name):
    return (PUNCH_LAWS | FRETTING_LAWS)[name]


def test_a_table_is_solved_for_its_mean():
    wanted = 'quantities = ["contact_radius", "wear_volume", "edge_pressure", "initial_pressure"]\ndistance = 1e-6'
    given = read(with_files(changed(FRETTING, (QUANTITIES, wanted)), 'table = "loads.csv"', loads=LOADS))
    steady, found = given.build_contact().steady([0.1, 0.4, 0.2]), given.solve()
    radius, volume, pressure, before = found.values()
    assert [one.description.startswith("mean over loads.csv: ") for one in found.values()] == [False, True, True, False]
    assert_allclose(radius.value, steady.contact_radius, rtol=1e-14)
    for one, each in ((volume, steady.wear_volume), (pressure, steady.edge_pressure(1e-6))):
        assert_allclose(one.value, np.dot([0.25, 0.125, 0.625], each), rtol=1e-14)
    # As far as the worn ring reaches at worst.
    assert_allclose(before.radii[-1], 1.25 * np.max(steady.worn_radius), rtol=1e-14)
    assert_allclose(before.value, steady.initial_pressure(before.radii[:, None])[:, 0], rtol=1e-12)
    assert list(read(with_files(SINGLE_NUMBERS, 'table = "loads.csv"')).solve()) == SINGLE


@parametrize(
    "text, names",
    [
        (FRETTING, UNSTRESSED),
        compiled_case(FRETTING, sorted(catalogue.STRESSES)),
        (GROSS_SLIP, [*PUNCH_LAWS]),
    ],
)
def test_every_quantity_is_that_of_the_contact(text, names):
    wanted = f"[output]\nquantities = {names}\npoints = 7\n{AT_PLACES}\n"
    given = read(text.partition("[output]")[0] + wanted)
    contact, found = given.build_contact(), given.solve()
    steady = contact.steady(*([0.32] if given.load else []))
    assert list(found) == names
    edge = 1.25 * contact.steady(0.32).worn_radius if given.load else 2.0 * contact.radius
    inside = 0.786 if given.load else 0.6667  # the middle of the ring
    for name, quantity in found.items():
        assert quantity.unit == law_of(name).unit and quantity.description
        if quantity.radii is None:
            assert isinstance(quantity.value, float)
            assert quantity.edge_distance == (1e-6 if name == "edge_pressure" else None)
        else:
            assert_allclose(quantity.radii[[0, 4, 6]], [0.0, inside * edge, edge], rtol=1e-3)
        # A peak is searched for, and rounding decides where it is found.
        rtol = 1e-9 if name in catalogue.STRESSES else 1e-12
        # At the places of [output], or over the radius.
        at = {x: quantity.radii if x == "r" else PLACES[x] for x in law_of(name).arguments if x in PLACES}
        said = getattr(steady, name)
        assert_allclose(quantity.value, said(**at) if at else said, rtol=rtol, atol=1e-30)


def test_without_output_all_single_numbers_are_computed():
    assert list(read(GROSS_SLIP).solve()) == list(PUNCH_LAWS)[:5]
    assert list(read(SINGLE_NUMBERS).solve()) == SINGLE
    limited = changed(SINGLE_NUMBERS, (MINIMISE, f"{MINIMISE}\n{LIMITED}"))
    assert list(read(limited).solve()) == [*SINGLE[:8], "edge_pressure", *SINGLE[8:]]


@compiled
def test_a_life_is_solved_for_what_is_worn_by_then():
    names = [f"transient.{name}" for name in ("wear_volume", "energy_per_cycle", "profile", "pressure")]
    wear = "[wear]\nenergy_coefficient_mm3_per_J = 1e-4\ncycles = 1e5\n\n[output]"
    text = changed(FRETTING, (QUANTITIES, f"quantities = {names}\npoints = 5"))
    given = read(text.replace("[output]", wear))
    contact, found = given.build_contact(), given.solve()
    assert given.contact.friction == contact.friction
    coefficient = contact.friction * 1e-13
    run = contact.over_cycles(0.32, coefficient)
    assert_allclose(found["transient.wear_volume"].value, run.volume(1e5), rtol=1e-12)
    for name in ("profile", "pressure"):
        quantity = found[f"transient.{name}"]
        assert_allclose(quantity.value, getattr(run, name)(quantity.radii, 1e5), rtol=1e-9)
    (worn,) = np.diff(run.volume([0.999e5, 1.001e5]))
    energy = worn / 200.0 * contact.friction / coefficient
    assert_allclose(found["transient.energy_per_cycle"].value, energy, rtol=1e-4)
    assert [found[name].unit for name in names] == ["m^3", "J", "m", "Pa"]
    held = read(changed(text, ("[output]", wear), ("tangential_force = 0.32", "displacement = 1e-7"))).solve()
    kept = contact.over_cycles(loads.Displacement(1e-7), coefficient).volume(1e5)
    assert_allclose(held["transient.wear_volume"].value, kept, rtol=1e-6)
    said = '"transient.wear_volume" counts after the cycles under [wear]'
    assert said in complaint(text)  # which has no life


LIMITED = "limits = { edge_pressure = { below = 5e8, distance = 2e-6 } }"


@parametrize(
    "changes, distance",
    [
        ((), None),
        (((MINIMISE, f"{MINIMISE}\n{LIMITED}"),), 2e-6),
        (((MINIMISE, f"{MINIMISE}\n{LIMITED}"), ("[output]", "[output]\ndistance = 1e-6")), 1e-6),
    ],
)
def test_what_is_unbounded_is_given_at_a_distance(changes, distance):
    wanted = 'quantities = ["pressure", "traction", "initial_pressure"]'
    text = changed(FRETTING, (QUANTITIES, wanted), *changes)
    given = read(text)
    contact, found = given.build_contact(), given.solve()
    inside = 0.01 * float(contact.steady(0.0).contact_radius) if distance is None else distance
    pressure, traction, bounded = found.values()
    assert pressure.unbounded_at == "the stick-slip boundary"
    assert bounded.unbounded_at is bounded.edge_value is bounded.edge_distance is None
    assert read(changed(text, ("0.32", "0.0"))).solve()["pressure"].unbounded_at is None
    assert pressure.edge_distance == traction.edge_distance == pytest.approx(inside, rel=1e-14)
    steady = contact.steady(0.32)
    expected = steady.edge_pressure(inside), steady.traction(steady.stick_radius - inside)
    assert_allclose([pressure.edge_value, traction.edge_value], expected, rtol=1e-10)
    assert np.shape(pressure.value) == (201,)  # by default


def test_the_punch_has_its_pressure_beside_its_edge():
    given = read(f'{GROSS_SLIP}\n[output]\nquantities = ["initial_pressure"]\ndistance = 1e-5\n')
    expected = given.build_contact().steady().initial_pressure(2e-3 - 1e-5)
    assert_allclose(given.solve()["initial_pressure"].edge_value, expected, rtol=1e-10)


@cases("scene/refused.toml", "solved")
def test_refusal_of_what_cannot_be_solved(case):
    """By what computes it alone: a design doesn't care."""
    Path("loads.csv").write_text(LOADS)
    text = changed(FRETTING, (case["old"], case["new"])) if "old" in case else f"{GROSS_SLIP}{case['more']}"
    assert is_told(refusal(scene.SceneError, read(text).solve), case)


# --- whatever a file holds ------------------------------------------------------------------------------------------


WHOLE = [tomllib.loads(file.read_text()) for file in DESIGNS.glob("*.toml")]
WHOLE += [tomllib.loads(text) for text in (FRETTING, f"{GROSS_SLIP}{PUNCH_DESIGN}")]


@parametrize("sections", WHOLE, ids=lambda sections: sections["contact"]["kind"])
def test_a_scene_holds_what_its_file_holds(sections):
    found = scene.scene_of(sections, folder=DESIGNS)
    for name, body in sections.items():
        told = vars(getattr(found, "design_space" if name == "design" else name))
        for key in body.keys() - {"vary", "limits", "over", "indenter", "shape", "table"}:
            assert told[key] == (tuple(body[key]) if isinstance(body[key], list) else body[key])


junk = st.recursive(
    st.booleans() | st.integers() | st.floats() | st.text(max_size=8) | st.sampled_from(["holl", "fretting", "k"]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)
keys = st.text(max_size=6) | st.sampled_from(MISTAKES["keys"])


@given(st.sampled_from(WHOLE), st.data())
def test_junk_is_refused_in_one_line_or_read(sections, data):
    spot = sections = copy.deepcopy(sections)
    for _ in range(data.draw(st.integers(0, 4))):
        nested = [item for item in spot.values() if isinstance(item, dict)]
        if nested:
            spot = data.draw(st.sampled_from(nested))
    spot[data.draw(st.sampled_from(list(spot)) | keys)] = data.draw(junk)
    try:
        found = scene.scene_of(sections, "scene.toml", DESIGNS)
        if found.design_space is not None:
            found.design_space.checked()
    except scene.SceneError as error:
        line = str(error)
        assert line.startswith("scene.toml: ") or "table" in spot or "history" in spot or "scenarios" in spot
        assert line.isprintable() and len(line) < 410


@given(st.binary(max_size=60) | st.text(alphabet="[]{}=\"'#.\n abk01_-", max_size=60).map(str.encode))
def test_any_bytes_are_refused_in_one_line(content):
    line = complaint(content)
    assert line.startswith("scene.toml: ") and line.isprintable()


def test_what_does_not_depend_on_the_amplitude_is_read_in_the_rig_of_the_load():
    contact = dome(0.2)
    alone, load = contact.steady(0.0), loads.Displacement(1e-7, rig_stiffness=1e7)
    names = "gross_slip_displacement", "gross_slip_energy_ratio"
    onset, ratio = (catalogue.read(contact, name, load, {}) for name in names)
    assert_allclose(onset, alone.gross_slip_displacement + 0.4 * 10.0 / 1e7, rtol=1e-14)
    assert_allclose(ratio * onset, alone.gross_slip_energy_ratio * alone.gross_slip_displacement, rtol=1e-14)
    # In sweeps and for limits of designs too.
    swept = sweep.sweep([*names, "contact_radius"], contact=contact, displacement=[1e-7, 2e-7], rig_stiffness=1e7)
    assert_allclose([swept[name] for name in names], [onset, ratio], rtol=1e-14)
    steady = contact.steady(load)
    limits = {name: {"below": 1.0} for name in ("gross_slip_displacement", "displacement_amplitude", "energy_ratio")}
    question = question_of(contact, loads.Force(steady.tangential_force, 1e7), {"k": (0.1, 0.3)}, limits=limits)
    found = evaluate(question, {"k": np.array([0.2])}).values[0, 1:]
    assert_allclose(np.exp(found), [getattr(steady, one.quantity) for one in question.limits], rtol=1e-7)


@parametrize("varies", ["h.csv", "scatter", "vary"])
def test_an_energy_coefficient_belongs_to_one_friction(varies):
    tables = {"h": "tangential_force,cycles,friction\n1,1e5,0.4\n1,1e5,0.3\n", "s": "friction\n0.4\n0.5\n"}
    load = 'history = "h.csv"' if varies == "h.csv" else "tangential_force = 0.3"
    more = 'scenarios = "s.csv"\n' if varies == "scatter" else ""
    vary = "{ friction = [0.3, 0.5] }" if varies == "vary" else "{ k = [-0.5, 0.5] }"
    text = f"""
material = {{ E0 = 110e9, z0 = 1e-4, k = 0.25, nu = 0.3 }}
contact = {{ kind = "fretting", radius = 5e-3, normal_force = 10.0, friction = 0.4 }}
load = {{ {load} }}
wear = {{ energy_coefficient_mm3_per_J = 1e-5, cycles = 1e5 }}
design = {{ vary = {vary}, minimise = "wear_volume", {more.strip() or "limits = {}"} }}
"""
    given = scene_of(text, **tables)
    with pytest.raises(scene.SceneError, match="energy_coefficient_mm3_per_J = 1e-05: is not for a friction that chan"):
        given.over_cycles() if varies == "h.csv" else given.arguments()
