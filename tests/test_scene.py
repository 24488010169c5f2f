"""Scene files: what is refused and in which words, and that only what is asked for is computed."""

import functools
import re
from pathlib import Path

import jax
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from plgwear_jax import FrettingContact, GrossSlipContact, PowerLawGraded, scene

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

FRETTING_QUANTITIES = {
    "contact_radius": "m",
    "stick_radius": "m",
    "worn_radius": "m",
    "penetration": "m",
    "wear_volume": "m^3",
    "edge_intensity": "Pa",
    "profile": "m",
    "wear_depth": "m",
    "initial_displacement": "m",
    "steady_displacement": "m",
    "initial_pressure": "Pa",
    "steady_pressure": "Pa",
    "steady_traction": "Pa",
}
GROSS_SLIP_QUANTITIES = {
    "initial_force": "N",
    "steady_force": "N",
    "force_ratio": "1",
    "volume_change": "m^3",
    "initial_displacement": "m",
    "steady_displacement": "m",
    "initial_pressure": "Pa",
    "steady_pressure": "Pa",
}


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return Path("scene.toml")


def complaint(file: Path, content: str | bytes) -> str:
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(scene.SceneError) as caught:
        scene.load(file)
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
DEPTHS = "must be [lower, upper] with 0 < lower < upper, finite, in m"
POISSON = 'must be a number with -1 < nu <= 0.5, or "holl"'
NAMES = "must be a list of one or more names of quantities"
POINTS = "must be a whole number from 2 to 100000"

REFUSED = {
    # a number that is none, or not finite, or out of range
    ("E0 = 110e9", 'E0 = "110e9"'): f'[material] E0 = "110e9": {MODULUS}',
    ("E0 = 110e9", "E0 = true"): f"[material] E0 = true: {MODULUS}",
    ("E0 = 110e9", "E0 = 0"): f"[material] E0 = 0: {MODULUS}",
    ("E0 = 110e9", "E0 = -1.5"): f"[material] E0 = -1.5: {MODULUS}",
    ("E0 = 110e9", "E0 = inf"): f"[material] E0 = inf: {MODULUS}",
    ("E0 = 110e9", "E0 = nan"): f"[material] E0 = nan: {MODULUS}",
    ("E0 = 110e9", f"E0 = 0x1{300 * '0'}"): f"[material] E0 = 0x1{54 * '0'}...: {MODULUS}",
    ("E0 = 110e9", "E0 = 2024-02-29"): f"[material] E0 = 2024-02-29: {MODULUS}",
    ("E0 = 110e9", "E0 = [1, {a = 'b'}]"): f'[material] E0 = [1, {{ a = "b" }}]: {MODULUS}',
    ("E0 = 110e9", 'E0 = "1\\n2"'): f'[material] E0 = "1\\n2": {MODULUS}',
    ("z0 = 1e-4", "z0 = 0.0"): "[material] z0 = 0.0: must be a finite number > 0, the characteristic depth in m",
    ("k = 0.25", "k = 1"): "[material] k = 1: must be a number with -1 < k < 1",
    ("k = 0.25", "k = -1.0"): "[material] k = -1.0: must be a number with -1 < k < 1",
    ("nu = 0.3", "nu = 0.51"): f"[material] nu = 0.51: {POISSON}",
    ("nu = 0.3", "nu = -1"): f"[material] nu = -1: {POISSON}",
    ("nu = 0.3", 'nu = "hull"'): f'[material] nu = "hull": {POISSON}',
    ("nu = 0.3", "nu = false"): f"[material] nu = false: {POISSON}",
    ("radius = 0.005", "radius = -0.005"): (
        "[contact] radius = -0.005: must be a finite number > 0, the radius of curvature of the indenter in m"
    ),
    ("normal_force = 10.0", "normal_force = 0.0"): (
        "[contact] normal_force = 0.0: must be a finite number > 0, the normal force in N"
    ),
    ("friction = 0.4", "friction = -0.4"): (
        "[contact] friction = -0.4: must be a finite number > 0, the coefficient of friction"
    ),
    ("friction = 0.4", "friction = 1e308"): (
        "[contact] friction = 1e+308: times normal_force exceeds the range of numbers"
    ),
    ("tangential_force = 0.32", "tangential_force = -0.1"): (
        "[load] tangential_force = -0.1: must be a finite number >= 0, the amplitude of the force in N"
    ),
    ("tangential_force = 0.32", "tangential_force = 5"): (
        "[load] tangential_force = 5: this is gross slip, F_x = 5 N is not below mu F_N = 4 N; "
        'use a scene with contact kind = "gross-slip"'
    ),
    ("tangential_force = 0.32", "tangential_force = 4.0"): (
        "[load] tangential_force = 4.0: this is gross slip, F_x = 4 N is not below mu F_N = 4 N; "
        'use a scene with contact kind = "gross-slip"'
    ),
    # keys and sections that are unknown, missing, or in the wrong place
    ("normal_force = 10.0", "normalforce = 10.0"): (
        "[contact] normalforce = 10.0: there is no such key; did you mean normal_force?"
    ),
    ("friction = 0.4", "friction = 0.4\nzzz = 1"): (
        "[contact] zzz = 1: there is no such key; allowed are kind, radius, normal_force, friction"
    ),
    ("friction = 0.4", 'friction = 0.4\n"a\\nb c" = 1'): (
        '[contact] "a\\nb c" = 1: there is no such key; allowed are kind, radius, normal_force, friction'
    ),
    ("friction = 0.4", ""): "[contact] friction: missing; it must be a finite number > 0, the coefficient of friction",
    ("E0 = 110e9\n", ""): f"[material] E0: missing; it {MODULUS}",
    ("nu = 0.3", ""): f"[material] nu: missing; it {POISSON}",
    ('kind = "fretting"\n', ""): '[contact] kind: missing; it must be "fretting" or "gross-slip"',
    ('kind = "fretting"', 'kind = "freting"'): (
        '[contact] kind = "freting": must be "fretting" or "gross-slip"; did you mean fretting?'
    ),
    ('kind = "fretting"', "kind = 7"): '[contact] kind = 7: must be "fretting" or "gross-slip"',
    ('kind = "fretting"', "kind = ['fretting']"): '[contact] kind = ["fretting"]: must be "fretting" or "gross-slip"',
    ("tangential_force = 0.32", ""): (
        "[load] tangential_force: missing; it must be a finite number >= 0, the amplitude of the force in N"
    ),
    ("[load]\ntangential_force = 0.32\n", ""): "[load]: missing; a fretting contact needs its key tangential_force",
    ("[material]", "[materail]"): "[materail]: there is no such section; did you mean material?",
    ("[material]", "[x]"): "[x]: there is no such section; allowed are material, contact, load, design, output",
    ("[material]", "k_0 = 1\n[material]"): (
        "k_0 = 1: stands outside the sections; allowed are material, contact, load, design, output"
    ),
    ("[material]\nE0 = 110e9\nz0 = 1e-4\nk = 0.25\nnu = 0.3", "material = 3"): (
        "material = 3: must be a section, written as [material]"
    ),
    ("[material]\nE0 = 110e9\nz0 = 1e-4\nk = 0.25\nnu = 0.3", ""): (
        "[material]: missing; every scene needs this section"
    ),
    ("[load]", "[[load]]"): "load = [{ tangential_force = 0.32 }]: must be a section, written as [load]",
    # the design space
    (VARY, "vary = {}"): (
        "[design] vary = {}: must be a table of bounds such as { k = [-0.9, 0.9] }, with k, z0 or both"
    ),
    (VARY, "vary = 3"): (
        "[design] vary = 3: must be a table of bounds such as { k = [-0.9, 0.9] }, with k, z0 or both"
    ),
    (VARY, ""): (
        "[design] vary: missing; it must be a table of bounds such as { k = [-0.9, 0.9] }, with k, z0 or both"
    ),
    (VARY, "vary = { k = [0.9, -0.9] }"): f"[design] vary.k = [0.9, -0.9]: {EXPONENTS}",
    (VARY, "vary = { k = [0.5, 0.5] }"): f"[design] vary.k = [0.5, 0.5]: {EXPONENTS}",
    (VARY, "vary = { k = [-1, 0.9] }"): f"[design] vary.k = [-1, 0.9]: {EXPONENTS}",
    (VARY, "vary = { k = [-0.9, true] }"): f"[design] vary.k = [-0.9, true]: {EXPONENTS}",
    (VARY, "vary = { k = [0.9] }"): f"[design] vary.k = [0.9]: {EXPONENTS}",
    (VARY, "vary = { k = 0.9 }"): f"[design] vary.k = 0.9: {EXPONENTS}",
    (VARY, "vary = { z0 = [0, 1e-3] }"): f"[design] vary.z0 = [0, 0.001]: {DEPTHS}",
    (VARY, "vary = { z0 = [1e-5, inf] }"): f"[design] vary.z0 = [1e-05, inf]: {DEPTHS}",
    (VARY, "vary = { nu = [0, 0.5] }"): "[design] vary.nu = [0, 0.5]: there is no such key; allowed are k, z0",
    (VARY, "vary = { k = [-0.9, 0.9], z0 = [1e-5, 1e-3] }"): (
        '[design] vary.z0 = [1e-05, 0.001]: cannot vary while hold = "contact_radius" sets E0: '
        "only E0/z0^k counts for the contact"
    ),
    (HOLD, 'hold = "contact_area"\n'): '[design] hold = "contact_area": must be "contact_radius", or left out',
    ('minimise = "wear_volume"', 'minimise = "depth"'): '[design] minimise = "depth": must be "wear_volume"',
    # the quantities
    (QUANTITIES, 'quantities = ["wear_volum"]'): (
        '[output] quantities = ["wear_volum"]: "wear_volum" is not a quantity of a fretting contact; '
        "did you mean wear_volume?"
    ),
    (QUANTITIES, 'quantities = ["initial_force"]'): (
        '[output] quantities = ["initial_force"]: "initial_force" is not a quantity of a fretting contact; '
        "did you mean initial_pressure?"
    ),
    (QUANTITIES, 'quantities = ["profile", "wear_volume", "profile"]'): (
        '[output] quantities = ["profile", "wear_volume", "profile"]: "profile" is asked for more than once'
    ),
    (QUANTITIES, "quantities = []"): f"[output] quantities = []: {NAMES}",
    (QUANTITIES, 'quantities = "profile"'): f'[output] quantities = "profile": {NAMES}',
    (QUANTITIES, "quantities = [1]"): f"[output] quantities = [1]: {NAMES}",
    (QUANTITIES, "points = 11"): f"[output] quantities: missing; it {NAMES}",
    (QUANTITIES, f"{QUANTITIES}\npoints = 1"): f"[output] points = 1: {POINTS}",
    (QUANTITIES, f"{QUANTITIES}\npoints = 10.0"): f"[output] points = 10.0: {POINTS}",
    (QUANTITIES, f"{QUANTITIES}\npoints = 100001"): f"[output] points = 100001: {POINTS}",
}


@pytest.mark.parametrize("change, line", REFUSED.items(), ids=[line[:50] for line in REFUSED.values()])
def test_refusal_says_file_section_key_value_and_what_is_allowed(file, change, line):
    assert complaint(file, changed(FRETTING, change)) == f"scene.toml: {line}"


@pytest.mark.parametrize(
    "text, line",
    [
        (f"{GROSS_SLIP}\n[load]\ntangential_force = 1.0\n",
         '[load]: only a contact with kind = "fretting" has a tangential force'),
        (f'{GROSS_SLIP}\n[design]\nvary = {{ k = [0, 0.5] }}\nminimise = "wear_volume"\n',
         '[design]: only for a contact with kind = "fretting"'),
        (f'{GROSS_SLIP}\n[output]\nquantities = ["wear_volume"]\n',
         '[output] quantities = ["wear_volume"]: "wear_volume" is not a quantity of a gross-slip contact; '
         f"allowed are {', '.join(GROSS_SLIP_QUANTITIES)}"),
        (changed(GROSS_SLIP, ("depth = 1e-6", "depht = 1e-6")),
         "[contact] depht = 1e-06: there is no such key; did you mean depth?"),
        (changed(GROSS_SLIP, ("depth = 1e-6", "depth = 0")),
         "[contact] depth = 0: must be a finite number > 0, the indentation depth in m"),
    ],
)  # fmt: skip
def test_refusal_for_gross_slip(file, text, line):
    assert complaint(file, text) == f"scene.toml: {line}"


@pytest.mark.parametrize(
    "content, line",
    [
        ("", "[material]: missing; every scene needs this section"),
        ("[material]\nE0 = \n", "is not valid TOML: Invalid value (at line 2, column 6)"),
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
    assert line("folder.toml") == "folder.toml: is a folder; a scene is a TOML file"
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
    assert complaint(file, right) == "scene.toml: [material]: missing; every scene needs this section"


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


@pytest.mark.parametrize("text, units", [(FRETTING, FRETTING_QUANTITIES), (GROSS_SLIP, GROSS_SLIP_QUANTITIES)])
def test_every_quantity_is_that_of_the_contact(file, text, units):
    wanted = f"[output]\nquantities = {list(units)}\npoints = 7\n"
    given = read(file, text.partition("[output]")[0] + wanted)
    contact, force = given.build_contact(), [0.32] if given.load else []
    found = given.solve()
    assert list(found) == list(units)
    edge = 1.25 * contact.worn_radius(0.32) if isinstance(contact, FrettingContact) else 2.0 * contact.radius
    for name, quantity in found.items():
        assert quantity.unit == units[name] and quantity.description
        method = getattr(contact, name)
        if quantity.radii is None:
            assert isinstance(quantity.value, float)
            expected = method() if name in ("contact_radius", *GROSS_SLIP_QUANTITIES) else method(*force)
        else:
            np.testing.assert_allclose(quantity.radii, np.linspace(0.0, 1.0, 7) * np.asarray(edge), rtol=1e-14)
            expected = method(quantity.radii, *(force if "initial" not in name else []))
        np.testing.assert_allclose(quantity.value, expected, rtol=1e-12, atol=1e-30)


def test_without_output_all_single_numbers_are_computed(file):
    assert list(read(file, GROSS_SLIP).solve()) == list(GROSS_SLIP_QUANTITIES)[:4]
    found = read(file, FRETTING.partition("[output]")[0]).solve()
    assert list(found) == list(FRETTING_QUANTITIES)[:6]


def test_default_points_and_singular_edges(file):
    wanted = '"steady_pressure", "initial_pressure"'
    found = read(file, changed(FRETTING, ('"wear_volume", "profile"', wanted))).solve()
    assert found["steady_pressure"].unbounded_at == "the stick edge" and found["initial_pressure"].unbounded_at is None
    assert np.shape(found["steady_pressure"].value) == (201,)
    still = changed(FRETTING, ('"wear_volume", "profile"', wanted), ("0.32", "0.0"))
    assert read(file, still).solve()["steady_pressure"].unbounded_at is None


def traced(given: scene.Scene, names: tuple[str, ...]) -> set[str]:
    """The names of the compiled functions in what is traced for these quantities."""
    evaluate = functools.partial(scene._evaluate, names=names, points=11, digits=None)
    force = None if given.load is None else given.load.tangential_force
    return set(re.findall(r"name=(\w+)", str(jax.make_jaxpr(evaluate)(given.build_contact(), force))))


def test_only_what_is_asked_for_is_traced(file):
    given = read(file, FRETTING)
    kernels = set(FRETTING_QUANTITIES)
    assert traced(given, ("wear_volume",)) & kernels == {"wear_volume"}
    assert traced(given, ("contact_radius",)) & kernels == set()
    assert traced(given, ("stick_radius", "penetration")) & kernels == {"stick_radius", "penetration"}
    assert traced(given, ("profile",)) & kernels == {"profile", "worn_radius"}  # the radii reach beyond the ring
    flat = read(file, GROSS_SLIP)
    assert traced(flat, ("force_ratio",)) & (set(GROSS_SLIP_QUANTITIES) | {"_reduced_h_N_holl"}) == {"force_ratio"}


def test_fewer_digits_are_still_right(file):
    given = read(file, FRETTING)
    few, all_of_them = given.solve(digits=6), given.solve()
    for name in few:
        np.testing.assert_allclose(few[name].value, all_of_them[name].value, rtol=2e-6)


# --- whatever a file holds ------------------------------------------------------------------------------------------


def toml(value) -> str:
    """A value in TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        escaped = "".join(f"\\U{ord(char):08x}" if not char.isalnum() else char for char in value)
        return f'"{escaped}"'
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(toml, value))}]"
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{toml(key)} = {toml(item)}' for key, item in value.items())} }}"
    return repr(value)


def document(sections: dict) -> str:
    return "\n".join(f"{toml(name)} = {toml(body)}" for name, body in sections.items()) + "\n"


positive = st.floats(1e-12, 1e12)
exponents = st.floats(-1, 1, exclude_min=True, exclude_max=True)
materials = st.fixed_dictionaries(
    {
        "E0": positive,
        "z0": positive,
        "k": exponents,
        "nu": st.just("holl") | st.floats(-1, 0.5, exclude_min=True),
    }
)


def pairs(values: st.SearchStrategy[float]) -> st.SearchStrategy[list[float]]:
    return st.lists(values, min_size=2, max_size=2, unique=True).map(sorted)


@st.composite
def scenes(draw) -> dict:
    """Scenes as they should be."""
    found = {"material": draw(materials)}
    if draw(st.booleans()):
        found["contact"] = {"kind": "gross-slip", "radius": draw(positive), "depth": draw(positive)}
        names = GROSS_SLIP_QUANTITIES
    else:
        force, friction = draw(positive), draw(positive)
        found["contact"] = {"kind": "fretting", "radius": draw(positive), "normal_force": force, "friction": friction}
        found["load"] = {"tangential_force": draw(st.floats(0, 0.999)) * friction * force}
        names = FRETTING_QUANTITIES
        if draw(st.booleans()):
            held = draw(st.booleans())
            bounds = {"k": pairs(exponents)} if held else {"k": pairs(exponents), "z0": pairs(positive)}
            found["design"] = {"vary": draw(st.fixed_dictionaries(bounds)), "minimise": "wear_volume"}
            if held:
                found["design"]["hold"] = "contact_radius"
    if draw(st.booleans()):
        found["output"] = {"quantities": draw(st.lists(st.sampled_from(list(names)), min_size=1, unique=True))}
    return found


@given(scenes())
def test_round_trip(tmp_path_factory, sections):
    file = tmp_path_factory.getbasetemp() / "round-trip.toml"
    file.write_text(document(sections))
    read_back = scene.load(file)
    dumped = read_back.model_dump(mode="json", exclude_unset=True)
    assert dumped == sections
    assert scene.Scene.model_validate(sections) == read_back


junk = st.recursive(
    st.booleans() | st.integers() | st.floats() | st.text(max_size=8) | st.sampled_from(["holl", "fretting", "k"]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)
keys = st.text(max_size=6) | st.sampled_from(["E0", "k", "kind", "fretting", "vary", "hold", "radius", "quantities"])


@given(scenes(), st.data())
def test_junk_is_refused_in_one_line_or_read(tmp_path_factory, sections, data):
    spot = sections
    for _ in range(data.draw(st.integers(0, 2))):
        nested = [item for item in spot.values() if isinstance(item, dict)]
        if nested:
            spot = data.draw(st.sampled_from(nested))
    spot[data.draw(st.sampled_from(list(spot)) | keys)] = data.draw(junk)
    file = tmp_path_factory.getbasetemp() / "junk.toml"
    file.write_text(document(sections), encoding="utf-8")
    try:
        scene.load(file)
    except scene.SceneError as error:
        line = str(error)
        assert line.startswith(f"{file}: ") and line.isprintable() and len(line) < len(str(file)) + 400


@given(st.binary(max_size=60) | st.text(alphabet="[]{}=\"'#.\n abk01_-", max_size=60).map(str.encode))
def test_any_bytes_are_refused_in_one_line(tmp_path_factory, content):
    file = tmp_path_factory.getbasetemp() / "bytes.toml"
    file.write_bytes(content)
    with pytest.raises(scene.SceneError) as caught:
        scene.load(file)
    assert str(caught.value).startswith(f"{file}: ") and str(caught.value).isprintable()
