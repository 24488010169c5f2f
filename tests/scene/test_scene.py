"""Scene files: what is refused and in which words, and that only what is asked for is computed."""

import copy
import functools
import re
import tomllib
from pathlib import Path
from types import SimpleNamespace

import jax
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from refusals import cases, is_told

from plgwear_jax import FrettingContact, GrossSlipContact, PowerLawGraded, catalogue, loads, optimise, scene
from plgwear_jax.catalogue import QUANTITIES as LAWS
from plgwear_jax.scene import solving

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

FRETTING_QUANTITIES, GROSS_SLIP_QUANTITIES = ({name: law.unit for name, law in laws.items()} for laws in LAWS.values())
PLACES = {"distance": 1e-6, "x": -3e-5, "z": 1e-5, "least": 1e-6, "most": 1e-4}
AT_PLACES = "\n".join(f"{place} = {value}" for place, value in PLACES.items())
WITHOUT_LOAD = [name for name, law in LAWS["fretting"].items() if not {"F_x", "r"} & {*law.arguments}]
DEPEND_ON_RADIUS_AND_LOAD = [name for name, law in LAWS["fretting"].items() if {"r", "F_x"} <= {*law.arguments}]
SINGLE = [
    name for name, law in LAWS["fretting"].items() if {*law.arguments} <= {"F_x"} and name not in catalogue.STRESSES
]


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return Path("scene.toml")


def complaint(file: Path, content: str | bytes) -> str:
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(scene.SceneError) as caught:
        scene.load(file).asked()
    return str(caught.value)


def changed(text: str, *replacements: tuple[str, str]) -> str:
    for old, new in replacements:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


# --- what is refused ------------------------------------------------------------------------------------------------

QUANTITIES = 'quantities = ["wear_volume", "profile"]'
VARY = "vary = { k = [-0.9, 0.9] }"
HOLD = 'hold = "contact_radius"\n'
MODULUS = "must be a finite number > 0, the modulus at the depth z0 in Pa"
EXPONENTS = "must be [lower, upper] with -1 < lower < upper < 1"
SOME = f"{', '.join([*LAWS['fretting']][:12])}, and {len(LAWS['fretting']) - 12} more"
MINIMISE = 'minimise = "wear_volume"'
WINDOW = "{ at = [1, 2], between = [[3, 4], [3, 4]] }"
EXAMPLE = "{ at = [1e-5, 1e-3], between = [[60e9, 400e9], [60e9, 400e9]] }"
AT = "must be [z1, z2] with 0 < z1 < z2, finite, two depths in m, or for a free gradient three to eight"
BETWEEN = "must be [[lower, upper], [lower, upper]] with 0 < lower < upper, finite, in Pa at either depth"
BOUNDS = (
    "must be a table of bounds such as { k = [-0.9, 0.9] }: numbers of the material and the contact, "
    "or bounds of the modulus"
)
MODULI = "must be [lower, upper] with 0 < lower < upper, finite, in Pa"
HELD = 'must be "contact_radius", or left out'
OVER = 'must be "mean", "worst", or { cvar = level } with 0 <= level < 1'
LIMITS = "must be a table of limits such as { deepest_wear = { below = 2e-6 } }, of any quantities, or of the modulus"
HIGHEST = "must be a finite number > 0, the highest value in the SI unit of the quantity"
LENGTH = "must be { below = ... } in m, or with above, or with between = [lowest, highest]"
GOAL = 'must be a quantity such as "wear_volume", or one with its place, { edge_pressure = { distance = 1e-6 } }'
LOWEST = "must be a finite number > 0, the lowest value in the SI unit of the quantity"
DEPTHS = "must be [lower, upper] with 0 < lower < upper, finite, in m"
POISSON = 'must be a number with -1 < nu <= 0.5, or "holl"'
NAMES = "must be a list of one or more names of quantities"
POINTS = "must be a whole number from 2 to 100000"

REFUSED = Path(__file__).with_name("refused.toml")


@cases(REFUSED, "fretting")
def test_refusal_says_file_section_key_value_and_what_is_allowed(file, case):
    assert is_told(complaint(file, changed(FRETTING, (case["old"], case["new"]))), case, "scene.toml")


@cases(REFUSED, "punch")
def test_refusal_for_gross_slip(file, case):
    text = GROSS_SLIP.replace("depth = 1e-6", case.get("depth", "depth = 1e-6"))
    assert is_told(complaint(file, f"{text}{case['more']}"), case, "scene.toml")


def with_files(text: str, load: str, **files: str) -> str:
    """The scene with another load, whose tables are written."""
    for name, content in files.items():
        Path(f"{name}.csv").write_text(content)
    return changed(text, ("tangential_force = 0.32", load))


LOADS = "tangential_force,weight\n0.1,2\n0.4,1\n# broken\n0.6,0\n0.2,5\n"
CYCLES = "tangential_force\n0.1\n\n0.4\n0.4\n0.2\n"


@pytest.mark.parametrize(
    "load, loads, line",
    [
        ('table = "loads.csv"', "", "loads.csv: is empty; it must begin with the row tangential_force,weight"),
        ('table = "loads.csv"', "tangential_force,weight\n0.1,1\n0.2,-0.5\n",
         "loads.csv: row 3: weight = -0.5: must be a finite number >= 0"),
        ('history = "loads.csv"', LOADS,
         "loads.csv: row 1: column weight: there is no such column; "
         "allowed are tangential_force, displacement, cycles, normal_force, friction"),
        ('table = "loads.csv"', CYCLES,
         "loads.csv: row 1: column weight: missing; the first row must be tangential_force,weight"),
        ('table = "loads.csv"', LOADS.replace("0.6", "4"),
         "loads.csv: row 5: tangential_force = 4.0: this is gross slip, it must be below mu F_N = 4 N"),
        ('history = "loads.csv"', CYCLES.replace("0.4", "5.5"),
         "loads.csv: row 4: tangential_force = 5.5: this is gross slip, it must be below mu F_N = 4 N"),
        ('table = "load.csv"', LOADS, "load.csv: there is no such file"),
        ('table = "."', LOADS, ".: is a folder; a table is a CSV file"),
        ('table = "scene.toml"', LOADS,
         'scene.toml: row 2: column "[material]": there is no such column; '
         "allowed are tangential_force, displacement, weight"),
    ],
)  # fmt: skip
def test_refusal_of_a_table_names_its_file_and_row(file, load, loads, line):
    assert complaint(file, with_files(FRETTING, load, loads=loads)) == line


def test_tables_lie_beside_the_scene(file):
    text = with_files(SINGLE_NUMBERS, 'table = "below/loads.csv"')
    Path("inside/below").mkdir(parents=True)
    inside = Path("inside/scene.toml")
    assert complaint(inside, text) == "inside/below/loads.csv: there is no such file"
    Path("inside/below/loads.csv").write_text(LOADS)
    absolute = changed(text, ("below/loads.csv", str(Path("inside/below/loads.csv").absolute())))
    for found in (scene.load(inside), scene.load(inside.absolute()), read(file, absolute)):
        assert found.load is not None and found.load.amplitudes.tolist() == [0.1, 0.4, 0.2]


def test_a_table_is_read_after_the_section_that_names_it_is_checked(file):
    text = with_files(FRETTING, 'table = "missing.csv"')
    assert complaint(file, changed(text, ("k = 0.25", "k = 2"))).startswith("scene.toml: [material] k = 2: ")
    assert complaint(file, changed(text, ('hold = "contact_radius"', "hold = 1"))) == (
        "missing.csv: there is no such file"  # [load] comes before [design]
    )


def test_refusal_of_what_does_not_go_with_a_load(file):
    text = with_files(FRETTING, 'history = "amplitudes.csv"', amplitudes=CYCLES)
    line = (
        'over = "worst": only for a load with a table, which gives the amplitudes and their weights, or for scenarios'
    )
    assert complaint(file, changed(text, (MINIMISE, f'{MINIMISE}\nover = "worst"'))) == f"scene.toml: [design] {line}"


def test_refusal_of_profiles_over_a_table(file):
    """By what computes them alone: a design doesn't care."""
    found = read(file, with_files(FRETTING, 'table = "amplitudes.csv"', amplitudes=LOADS))
    with pytest.raises(scene.SceneError) as refusal:
        found.solve()
    assert str(refusal.value) == (
        '[output] quantities = ["wear_volume", "profile"]: "profile" is a function of r, and so has no mean '
        "over a table of amplitudes; ask for single numbers"
    )


def test_refusal_of_a_depth_without_effect(file):
    text = changed(FRETTING, ("k = 0.25", "k = 0"), (f"{VARY}\n{HOLD}", "vary = { z0 = [1e-5, 1e-3] }\n"))
    assert complaint(file, text) == (
        "scene.toml: [design] vary.z0 = [1e-05, 0.001]: has no effect at k = 0, the exponent of the reference; "
        "vary k as well, or E0"
    )
    text = changed(text, ("z0 = [1e-5, 1e-3]", "z0 = [1e-5, 1e-3], k = [-0.5, 0.5]"))
    design = read(file, text).design_space
    assert design is not None and design.variables == {"k": (-0.5, 0.5), "z0": (1e-5, 1e-3)}


@pytest.mark.parametrize(
    "content, line",
    [
        ("", "[material]: missing; every input file needs this section"),
        ("[material]\nE0 = \n", "is not valid TOML: Invalid value (at line 2, column 6)"),
        (
            "[contact]\nfriction = 0,4\n",
            "is not valid TOML: Expected newline or end of document after a statement (at line 2, column 13); "
            "decimals are set off by a point",
        ),
        ("k = 1\nk = 2\n", "is not valid TOML: Cannot overwrite a value (at line 2, column 6)"),
        (b"[material]\nE0 = '\xff'\n", "is not a text file in UTF-8 (byte 17)"),
        (f"a = {5000 * '1'}\n", "is not valid TOML: a number too long or brackets too deep"),
        (f"a = {5000 * '['}\n", "is not valid TOML: a number too long or brackets too deep"),
    ],
)
def test_refusal_of_what_is_not_toml(file, content, line):
    assert complaint(file, content) == f"scene.toml: {line}"


def test_refusal_of_what_cannot_be_read(file):
    def line(path):
        with pytest.raises(scene.SceneError) as caught:
            scene.load(path)
        return str(caught.value)

    assert line("missing.toml") == "missing.toml: there is no such file"
    Path("folder.toml").mkdir()
    assert line("folder.toml") == "folder.toml: is a folder; an input file is a TOML file"
    file.write_text(FRETTING)
    assert line("scene.toml/inside") == "scene.toml/inside: cannot be read: Not a directory"
    assert line("a\0b") == "a\\x00b: cannot be read: embedded null byte"
    assert line("a\nb") == "a\\nb: there is no such file"


def test_first_mistake_in_the_file_is_told(file):
    wrong = {
        "[material] k = 2: ": "[material]\nE0 = 1e9\nz0 = 1e-3\nk = 2\nnu = 0.3\n",
        "[contact] fricton = 0.4: ": '[contact]\nkind = "fretting"\nfricton = 0.4\nradius = 1\nnormal_force = -1\n',
        "[load] tangential_force = -1: ": "[load]\ntangential_force = -1\n",
        "[design] hold = 1: ": '[design]\nhold = 1\nvary = { k = 1 }\nminimise = "wear_volume"\n',
        "[output] points = 0: ": '[output]\npoints = 0\nquantities = ["profile"]\n',
    }
    for first in wrong:
        others = [text for start, text in wrong.items() if start != first]
        assert complaint(file, "".join([wrong[first], *others])).startswith(f"scene.toml: {first}")
    # What is missing comes after what is there.
    contact = wrong["[contact] fricton = 0.4: "]
    assert complaint(file, contact).startswith("scene.toml: [contact] fricton = 0.4: ")
    right = contact.replace("fricton", "friction").replace("-1", "1")
    assert complaint(file, right) == "scene.toml: [material]: missing; every input file needs this section"


def test_windows_text_is_read(file):
    file.write_bytes(b"\xef\xbb\xbf" + FRETTING.replace("\n", "\r\n").encode())
    assert scene.load(file).material.k == 0.25


# --- what is computed -----------------------------------------------------------------------------------------------


def read(file: Path, text: str) -> scene.Scene:
    file.write_text(text)
    return scene.load(file)


def test_contact_has_the_numbers_of_the_file(file):
    material = PowerLawGraded(110e9, 1e-4, 0.25, 0.3)
    assert read(file, FRETTING).build_contact() == FrettingContact(material, 0.005, 10.0, 0.4)
    material = PowerLawGraded(1e9, 1e-3, -0.5, "holl")
    assert read(file, GROSS_SLIP).build_contact() == GrossSlipContact(material, 2e-3, 1e-6)


PLAIN_WINDOW = {"at": (1e-5, 1e-3), "lower": (60e9, 60e9), "upper": (400e9, 400e9)}
DESIGNED = {"variables": {"k": (-0.9, 0.9)}, "minimise": "wear_volume", "hold": "contact_radius", "level": 0.0}
FREE_HOLD = (HOLD, "")


def limited(text: str) -> tuple[str, str]:
    return MINIMISE, f"{MINIMISE}\nlimits = {{ {text} }}"


@pytest.mark.parametrize(
    "changes, told",
    [
        *((given, DESIGNED | {"allowed": None}) for given in ([], [limited("")])),
        ([(VARY, "vary = { E0 = [1e9, 2e9], k = [-0.5, 0.5] }"), FREE_HOLD, (MINIMISE, "minimise='worn_radius'")],
         {"hold": None, "variables": {"k": (-0.5, 0.5), "E0": (1e9, 2e9)}, "minimise": "worn_radius"}),
        ([(VARY, f"vary = {{ modulus = {EXAMPLE} }}"), FREE_HOLD], {"variables": {"modulus": PLAIN_WINDOW}}),
        *(([(MINIMISE, f"{MINIMISE}\nover = {over}")], DESIGNED | {"level": level})
          for over, level in (('"mean"', 0.0), ('"worst"', 1.0), ("{ cvar = 0.9 }", 0.9), ("{ cvar = 0 }", 0.0))),
        ([limited("edge_pressure = { below = 5e8, distance = 1e-6 }, penetration = { below = 2e-6 }, "
                  f"modulus = {EXAMPLE}")],
         {"allowed": {"edge_pressure": {"below": 5e8, "distance": 1e-6}, "penetration": {"below": 2e-6},
                      "modulus": PLAIN_WINDOW}}),
        *(([FREE_HOLD, limited(f"contact_radius = {{ {radii} }}")], {"allowed": {"contact_radius": ends}})
          for radii, ends in (("above = 5e-5, below = 8e-5", {"above": 5e-5, "below": 8e-5}),
                              ("between = [5e-5, 8e-5]", {"between": (5e-5, 8e-5)}))),
    ],
)  # fmt: skip
def test_design_has_what_the_search_takes(file, changes, told):
    text = with_files(SINGLE_NUMBERS, 'table = "loads.csv"', loads=LOADS)
    found = read(file, changed(text, *changes)).design_space
    assert {name: getattr(found, name) for name in told} == told


def test_load_has_the_amplitudes_of_the_file(file):
    one = read(file, FRETTING).load
    assert one is not None and one.amplitudes.tolist() == [0.32] and one.weights is None
    assert one.force == one.largest == 0.32 and one.remark is None
    history = read(file, with_files(FRETTING, 'history = "cycles.csv"', cycles=CYCLES)).load
    assert history is not None and history.amplitudes.tolist() == [0.1, 0.4, 0.4, 0.2] and history.weights is None
    assert history.force == history.largest == 0.4 and isinstance(history.force, float)
    assert history.remark == "history cycles.csv: 4 amplitudes; the largest, 0.4 N (row 4), decides the worn state"
    single = read(file, with_files(FRETTING, 'history = "a\\nb.csv"', **{"a\nb": "tangential_force\n0.125\n"})).load
    assert single is not None
    assert single.remark == "history a\\nb.csv: 1 amplitude; the largest, 0.125 N (row 2), decides the worn state"
    table = read(file, with_files(SINGLE_NUMBERS, 'table = "loads.csv"', loads=LOADS)).load
    assert table is not None and table.amplitudes.tolist() == [0.1, 0.4, 0.2] and table.weights is not None
    np.testing.assert_allclose(table.weights, [0.25, 0.125, 0.625], rtol=1e-15)
    np.testing.assert_array_equal(table.force, table.amplitudes)
    assert table.largest == 0.4 and table.remark is None and table.tangential_force is None  # 0.6 has no weight
    heavy = LOADS.replace("5\n", "1e308\n").replace("1\n", "1e308\n")
    table = read(file, with_files(SINGLE_NUMBERS, 'table = "loads.csv"', loads=heavy)).load
    assert table is not None and table.weights is not None
    np.testing.assert_allclose(table.weights, [1e-308, 0.5, 0.5], rtol=1e-15)


TWO_LIMITS = (
    f"{HOLD}limits = {{ edge_pressure = {{ below = 5e8, distance = 1e-6 }}, penetration = {{ below = 2e-6 }} }}\n"
)


def test_a_scene_asks_for_its_design_and_its_front(file, monkeypatch):
    monkeypatch.setattr(optimise, "design", lambda **given: SimpleNamespace(value=1.0, **given))
    monkeypatch.setattr(optimise, "front", lambda **given: SimpleNamespace(y=np.ones(2), **given))
    text = changed(SINGLE_NUMBERS, (HOLD, TWO_LIMITS), (MINIMISE, f"{MINIMISE}\nover = {{ cvar = 0.9 }}"))
    given = read(file, with_files(text, 'table = "loads.csv"', loads=LOADS))
    design, front = vars(given.design()), vars(given.front(points=5))
    depth = {"penetration": {"below": 2e-6}}
    assert design.pop("limits") == {"edge_pressure": {"below": 5e8, "distance": 1e-6}} | depth
    assert front.pop("limits") == depth
    assert given.arguments().keys() == {*design, "limits"} - {"value"}
    for found in (design, front):
        np.testing.assert_array_equal(found.pop("load"), [0.1, 0.4, 0.2])
        np.testing.assert_allclose(found.pop("weight"), [0.25, 0.125, 0.625])
        assert found.pop("contact") == given.build_contact()
    asked = {"vary": {"k": (-0.9, 0.9)}, "level": 0.9, "hold": "contact_radius", "minimise": "wear_volume"}
    assert design == {"value": 1.0} | asked
    np.testing.assert_array_equal(front.pop("y"), np.ones(2))
    assert front == asked | {"x": {"edge_pressure": {"distance": 1e-6}}, "larger": "", "points": 5}
    assert vars(given.front(distance=2e-6))["x"] == {"edge_pressure": {"distance": 2e-6}}
    other = vars(given.front(x="penetration", y="edge_pressure", larger="y"))
    assert other["x"] == {"penetration": {}} and other["minimise"] == {"edge_pressure": {"distance": 1e-6}}
    assert [*other["limits"]] == ["edge_pressure"] and other["larger"] == "y"


def test_a_design_that_cannot_be_looked_for_is_refused(file, monkeypatch):
    monkeypatch.setattr(optimise, "design", lambda **given: SimpleNamespace(value=np.inf))
    design = SINGLE_NUMBERS.partition("[design]")[0]
    far = changed(SINGLE_NUMBERS, (HOLD, changed(TWO_LIMITS, ("distance = 1e-6", "distance = 1e-3"))))
    for text, ask, message in (
        (design, "design", "[design]: missing; it says what may vary"),
        (changed(SINGLE_NUMBERS, ("0.32", "0.0")), "design", "[load] tangential_force = 0.0: nothing wears"),
        (far, "design", "[design] limits.edge_pressure.distance = 0.001: must be below the stick radius"),
        (SINGLE_NUMBERS, "design", "the wear exceeds the range of numbers"),
        (SINGLE_NUMBERS, "front", "x.distance: must be a finite number, as edge_pressure needs the distance from the"),
        (f"{GROSS_SLIP}{PUNCH_DESIGN}", "front", "x: edge_pressure is no quantity of a gross-slip contact"),
    ):
        with pytest.raises(scene.SceneError, match=re.escape(message)):
            getattr(read(file, text), ask)()
    with pytest.raises(scene.SceneError, match="from the stick-slip boundary in m must be a finite number > 0"):
        read(file, SINGLE_NUMBERS).front(distance=0.0)


def test_a_history_is_solved_for_its_largest_amplitude(file):
    one = read(file, changed(FRETTING, ("0.32", "0.4"))).solve()
    history = read(file, with_files(FRETTING, 'history = "cycles.csv"', cycles=CYCLES)).solve()
    for name, quantity in one.items():
        np.testing.assert_array_equal(history[name].value, quantity.value)
        assert history[name].description == quantity.description


def places_of(name):
    """Those of [output] that a quantity takes."""
    law = next(laws[name] for laws in LAWS.values() if name in laws)
    return {place: PLACES[place] for place in law.arguments if place in PLACES}


@pytest.mark.compiled
def test_a_table_is_solved_for_its_mean(file):
    wanted = [name for name in FRETTING_QUANTITIES if name not in DEPEND_ON_RADIUS_AND_LOAD]
    text = changed(FRETTING, (QUANTITIES, f"quantities = {wanted}\npoints = 5\n{AT_PLACES}"))
    given = read(file, with_files(text, 'table = "loads.csv"', loads=LOADS))
    contact, found = given.build_contact(), given.solve()
    assert isinstance(contact, FrettingContact) and list(found) == wanted
    for name, quantity in found.items():
        each = [getattr(contact.steady(force), name) for force in (0.1, 0.4, 0.2)]
        places = places_of(name)
        each = [one(**places) for one in each] if places else each
        if name in WITHOUT_LOAD:
            np.testing.assert_allclose(quantity.value, each[0], rtol=1e-14)
            assert not quantity.description.startswith("mean")
        elif quantity.radii is None:
            expected = np.dot([0.25, 0.125, 0.625], each)
            # Peaks are those of a fine grid: which of its places is the highest, roundings may decide.
            np.testing.assert_allclose(quantity.value, expected, rtol=1e-5 if name in catalogue.STRESSES else 1e-14)
            assert quantity.description.startswith("mean over loads.csv: ")
        else:  # before any wear, as far as the worn ring reaches at worst
            np.testing.assert_allclose(quantity.radii[-1], 1.25 * contact.steady(0.4).worn_radius, rtol=1e-14)
            np.testing.assert_allclose(quantity.value, each[0](quantity.radii), rtol=1e-12)
    assert list(read(file, with_files(SINGLE_NUMBERS, 'table = "loads.csv"')).solve()) == SINGLE


def test_a_table_of_one_row_is_that_amplitude(file):
    one = read(file, SINGLE_NUMBERS).solve()
    table = read(file, with_files(SINGLE_NUMBERS, 'table = "t.csv"', t="weight,tangential_force\n3,0.32\n")).solve()
    for name, quantity in one.items():
        np.testing.assert_allclose(table[name].value, quantity.value, rtol=1e-14)


@pytest.mark.parametrize(
    "text, units",
    [
        (FRETTING, {name: unit for name, unit in FRETTING_QUANTITIES.items() if name not in catalogue.STRESSES}),
        pytest.param(FRETTING, dict.fromkeys(catalogue.STRESSES, "Pa"), marks=pytest.mark.compiled),
        (GROSS_SLIP, GROSS_SLIP_QUANTITIES),
    ],
)
def test_every_quantity_is_that_of_the_contact(file, text, units):
    wanted = f"[output]\nquantities = {list(units)}\npoints = 7\n{AT_PLACES}\n"
    given = read(file, text.partition("[output]")[0] + wanted)
    contact, found = given.build_contact(), given.solve()
    steady = contact.steady(*([0.32] if given.load else []))
    assert list(found) == list(units)
    edge = 1.25 * contact.steady(0.32).worn_radius if isinstance(contact, FrettingContact) else 2.0 * contact.radius
    for name, quantity in found.items():
        assert quantity.unit == units[name] and quantity.description
        expected, places = getattr(steady, name), places_of(name)
        if quantity.radii is None:
            assert isinstance(quantity.value, float)
            expected = expected(**places) if places else expected
            assert quantity.edge_distance == (1e-6 if name == "edge_pressure" else None)
        else:
            np.testing.assert_allclose(quantity.radii, np.linspace(0.0, 1.0, 7) * np.asarray(edge), rtol=1e-14)
            expected = expected(quantity.radii)
        # A peak is searched for, and rounding decides where it is found.
        rtol = 1e-9 if name in catalogue.STRESSES else 1e-12
        np.testing.assert_allclose(quantity.value, expected, rtol=rtol, atol=1e-30)


def test_without_output_all_single_numbers_are_computed(file):
    assert list(read(file, GROSS_SLIP).solve()) == list(GROSS_SLIP_QUANTITIES)[:5]
    found = read(file, SINGLE_NUMBERS).solve()
    assert list(found) == SINGLE
    limited = changed(SINGLE_NUMBERS, (MINIMISE, f"{MINIMISE}\n{LIMITED}"))
    assert list(read(file, limited).solve()) == [*SINGLE[:8], "edge_pressure", *SINGLE[8:]]


@pytest.mark.compiled
def test_a_life_is_solved_for_what_is_worn_by_then(file):
    names = [f"transient.{name}" for name in ("wear_volume", "energy_per_cycle", "profile", "pressure")]
    wear = "[wear]\nenergy_coefficient_mm3_per_J = 1e-4\ncycles = 1e5\n\n[output]"
    text = changed(FRETTING, (QUANTITIES, f"quantities = {names}\npoints = 5"))
    given = read(file, text.replace("[output]", wear))
    contact, found = given.build_contact(), given.solve()
    assert isinstance(contact, FrettingContact) and given.contact.friction == contact.friction
    coefficient = contact.friction * 1e-13
    run = contact.over_cycles(0.32, coefficient)
    assert found["transient.wear_volume"].value == pytest.approx(float(run.volume(1e5)), rel=1e-12)
    for name in ("profile", "pressure"):
        quantity = found[f"transient.{name}"]
        np.testing.assert_allclose(quantity.value, getattr(run, name)(quantity.radii, 1e5), rtol=1e-9)
    energy = float(np.diff(run.volume([0.999e5, 1.001e5]))[0]) / 200.0 * contact.friction / coefficient
    assert found["transient.energy_per_cycle"].value == pytest.approx(energy, rel=1e-4)
    assert [found[name].unit for name in names] == ["m^3", "J", "m", "Pa"]
    said = '"transient.wear_volume" is not a quantity of a fretting contact'
    assert said in complaint(file, text)  # which has no life


def test_default_points_and_singular_edges(file):
    wanted = '"pressure", "initial_pressure"'
    found = read(file, changed(FRETTING, ('"wear_volume", "profile"', wanted))).solve()
    assert found["pressure"].unbounded_at == "the stick-slip boundary"
    assert found["initial_pressure"].unbounded_at is None
    assert np.shape(found["pressure"].value) == (201,)
    assert found["initial_pressure"].edge_value is found["initial_pressure"].edge_distance is None
    still = changed(FRETTING, ('"wear_volume", "profile"', wanted), ("0.32", "0.0"))
    assert read(file, still).solve()["pressure"].unbounded_at is None


LIMITED = "limits = { edge_pressure = { below = 5e8, distance = 2e-6 } }"


@pytest.mark.parametrize(
    "changes, distance",
    [
        ((), None),
        (((MINIMISE, f"{MINIMISE}\n{LIMITED}"),), 2e-6),
        (((MINIMISE, f"{MINIMISE}\n{LIMITED}"), ("[output]", "[output]\ndistance = 1e-6")), 1e-6),
    ],
)
def test_what_is_unbounded_is_given_at_a_distance(file, changes, distance):
    wanted = 'quantities = ["pressure", "traction"]'
    given = read(file, changed(FRETTING, (QUANTITIES, wanted), *changes))
    contact, found = given.build_contact(), given.solve()
    assert isinstance(contact, FrettingContact)
    inside = 0.01 * float(contact.steady(0.0).contact_radius) if distance is None else distance
    pressure, traction = found["pressure"], found["traction"]
    assert pressure.edge_distance == traction.edge_distance == pytest.approx(inside, rel=1e-14)
    assert pressure.edge_value == pytest.approx(float(contact.steady(0.32).edge_pressure(inside)), rel=1e-10)
    expected = contact.steady(0.32).traction(contact.steady(0.32).stick_radius - inside)
    assert traction.edge_value == pytest.approx(float(expected), rel=1e-10)
    assert np.shape(pressure.value) == (201,)


def test_the_punch_has_its_pressure_beside_its_edge(file):
    given = read(file, f'{GROSS_SLIP}\n[output]\nquantities = ["initial_pressure"]\ndistance = 1e-5\n')
    contact, found = given.build_contact(), given.solve()["initial_pressure"]
    assert isinstance(contact, GrossSlipContact)
    assert found.edge_value == pytest.approx(float(contact.steady().initial_pressure(2e-3 - 1e-5)), rel=1e-10)


@pytest.mark.parametrize(
    "text, line",
    [
        (changed(FRETTING, (QUANTITIES, 'quantities = ["edge_pressure"]\ndistance = 1e-4')),
         "[output] distance = 0.0001: must be below the stick radius, 7.58e-05 m"),
        (changed(SINGLE_NUMBERS, (MINIMISE, f"{MINIMISE}\n{LIMITED}".replace("2e-6", "1"))),
         "[design] limits.edge_pressure.distance = 1: must be below the stick radius, 7.58e-05 m"),
        (f'{GROSS_SLIP}\n[output]\nquantities = ["initial_pressure"]\ndistance = 1\n',
         "[output] distance = 1: must be below the radius of the punch, 0.002 m"),
    ],
)  # fmt: skip
def test_refusal_of_a_place_that_is_not_in_the_contact(file, text, line):
    with pytest.raises(scene.SceneError) as refusal:
        read(file, text).solve()
    assert str(refusal.value) == line


@pytest.mark.parametrize("k", [-0.9, -0.25, 0.0, 0.9])
def test_the_initial_pressure_has_its_peak_in_the_middle(k):
    contact = FrettingContact(PowerLawGraded(110e9, 1e-4, k, 0.3), 5e-3, 10.0, 0.4)
    along = contact.steady(0.0).initial_pressure(contact.steady(0.0).contact_radius * np.linspace(0.0, 1.0, 101))
    assert float(contact.steady(0.0).peak_initial_pressure) == pytest.approx(float(np.max(along)), rel=1e-14)


def traced(given: scene.Scene, names: tuple[str, ...]) -> set[str]:
    """The names of the compiled functions in what is traced for these quantities."""
    evaluate = functools.partial(solving.scene_values, names, 11, None)
    force = None if given.load is None else given.load.tangential_force
    return set(re.findall(r"name=(\w+)", str(jax.make_jaxpr(evaluate)(given.build_contact(), force, None))))


def test_only_what_is_asked_for_is_traced(file):
    given = read(file, FRETTING)
    kernels = set(FRETTING_QUANTITIES)
    assert traced(given, ("wear_volume",)) & kernels == {"wear_volume", "contact_radius"}  # its unit
    assert traced(given, ("contact_radius",)) & kernels == {"contact_radius"}
    two = {"stick_radius", "penetration"}
    assert traced(given, tuple(two)) & kernels == two | {"contact_radius"}
    # the radii reach beyond the ring
    assert traced(given, ("profile",)) & kernels == {"profile", "worn_radius", "contact_radius"}
    flat = read(file, GROSS_SLIP)
    assert traced(flat, ("force_ratio",)) & (set(GROSS_SLIP_QUANTITIES) | {"_reduced"}) == {"force_ratio"}


def test_fewer_digits_are_still_right(file):
    given = read(file, FRETTING)
    few, all_of_them = given.solve(digits=6), given.solve()
    for name in few:
        np.testing.assert_allclose(few[name].value, all_of_them[name].value, rtol=2e-6)


# --- whatever a file holds ------------------------------------------------------------------------------------------


DESIGNS = Path(__file__).parents[2] / "design"
WHOLE = [tomllib.loads(file.read_text()) for file in DESIGNS.glob("*.toml")]
WHOLE += [tomllib.loads(text) for text in (FRETTING, f"{GROSS_SLIP}{PUNCH_DESIGN}")]


@pytest.mark.parametrize("sections", WHOLE, ids=lambda sections: sections["contact"]["kind"])
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
keys = st.text(max_size=6) | st.sampled_from(
    ["E0", "k", "kind", "fretting", "vary", "hold", "radius", "quantities", "modulus", "at", "between", "over", "cvar",
     "limits", "edge_pressure", "contact_radius", "table", "history", "design", "load"]
)  # fmt: skip


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
def test_any_bytes_are_refused_in_one_line(tmp_path_factory, content):
    file = tmp_path_factory.getbasetemp() / "bytes.toml"
    file.write_bytes(content)
    with pytest.raises(scene.SceneError) as caught:
        scene.load(file)
    assert str(caught.value).startswith(f"{file}: ") and str(caught.value).isprintable()


def test_what_does_not_depend_on_the_amplitude_is_read_in_the_rig_of_the_load():
    contact = FrettingContact(PowerLawGraded(110e9, 1e-4, 0.2, 0.3), 5e-3, 10.0, 0.4)
    load = loads.Displacement(1e-7, rig_stiffness=1e7)
    onset = catalogue.read(contact, "gross_slip_displacement", load, {})
    alone = contact.steady(0.0)
    np.testing.assert_allclose(onset, alone.gross_slip_displacement + 0.4 * 10.0 / 1e7, rtol=1e-14)
    ratio = catalogue.read(contact, "gross_slip_energy_ratio", load, {})
    np.testing.assert_allclose(ratio * onset, alone.gross_slip_energy_ratio * alone.gross_slip_displacement, rtol=1e-14)
