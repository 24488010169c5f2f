"""Scenes of elastic indenters, measured moduli, layers and free gradients: what they mean, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from plgwear_jax import Layered, scene

POWER_LAW = "E0 = 110e9\nz0 = 1e-4\nk = 0.0"
LAYERS = "thickness = [2e-6, 3e-6]\nmodulus = [400e9, 200e9, 110e9]"
TABLE = 'table = "E.csv"'
CSV = "depth (um),modulus [GPa]\n0,400\n10,110\n"
STEEL = "indenter = { E = 210e9, nu = 0.3 }"
FREE = "vary = { modulus = { at = [1e-6, 1e-5, 1e-4], between = [[1e9, 2e9], [1e9, 2e9], [1e9, 2e9]] } }"
POWER_DESIGN = 'vary = { k = [-0.5, 0.5] }\nminimise = "wear_volume"'


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("E.csv").write_text(CSV)
    return Path("scene.toml")


def written(
    material: str = POWER_LAW, indenter: str = "", design: str = "", load: str = "tangential_force = 0.32"
) -> str:
    section = f"[design]\n{design}\n" if design else ""
    contact = f'kind = "fretting"\nradius = 5e-3\nnormal_force = 10.0\nfriction = 0.4\n{indenter}'
    return f"[material]\n{material}\nnu = 0.3\n[contact]\n{contact}\n[load]\n{load}\n{section}"


def loaded(file: Path, **given: str) -> scene.Scene:
    file.write_text(written(**given))
    return scene.load(file)


def complaint(file: Path, **given: str) -> str:
    with pytest.raises(scene.SceneError) as caught:
        loaded(file, **given)
    return str(caught.value)


def test_the_contact_is_that_of_the_scene(file):
    contact = loaded(file, material=TABLE, indenter=STEEL).build_contact()
    np.testing.assert_array_equal(contact.material.depth, [0.0, 1e-5])
    np.testing.assert_array_equal(contact.material.modulus, [400e9, 110e9])
    assert (contact.material.nu, contact.indenter.E, contact.indenter.nu) == (0.3, 210e9, 0.3)
    layered = loaded(file, material=LAYERS).material.record()
    assert isinstance(layered, Layered) and layered.nu == 0.3
    np.testing.assert_array_equal(layered.thickness, [2e-6, 3e-6])
    np.testing.assert_array_equal(layered.modulus, [400e9, 200e9, 110e9])
    homogeneous = loaded(file, material="thickness = []\nmodulus = [110e9]").material.record()
    assert homogeneous.modulus_at(1e-5) == 110e9


@pytest.mark.parametrize("indenter", ["", 'indenter = "rigid"'])
def test_a_rigid_indenter_is_none(file, indenter):
    assert loaded(file, indenter=indenter).build_contact().indenter is None


def test_two_homogeneous_bodies_are_their_moduli_in_series(file):
    series = POWER_LAW.replace("110e9", repr(1.0 / (1.0 / 110e9 + 1.0 / 210e9)))
    wanted = '[output]\nquantities = ["contact_radius", "wear_volume"]\n'
    both = []
    for given in ({"indenter": STEEL}, {"material": series}):
        file.write_text(written(**given) + wanted)
        both.append([float(quantity.value) for quantity in scene.load(file).solve().values()])
    np.testing.assert_allclose(*both, rtol=1e-12)


def test_a_table_of_one_modulus_is_a_half_space_of_it(file):
    Path("E.csv").write_text("depth,modulus\n1e-6,110e9\n1e-4,110e9\n")
    found, closed = loaded(file, material=TABLE).solve(digits=2), loaded(file).solve()
    for name in ("contact_radius", "worn_radius", "wear_volume"):
        np.testing.assert_allclose(found[name].value, closed[name].value, rtol=2e-2)


INDENTER = 'must be "rigid" or { E = 210e9, nu = 0.3 }, with E > 0 in Pa and -1 < nu <= 0.5'
THICKNESSES = (
    "must be a list of finite numbers > 0 such as [2e-6, 3e-6], "
    "the thicknesses of the layers in m from the surface downwards"
)
MODULI = (
    "must be a list of finite numbers > 0 such as [400e9, 200e9, 110e9], "
    "the moduli of the layers and, last, of the substrate in Pa"
)
ELEMENT = "must be [lower, upper] with 0 < lower < upper, finite, in"


def needs(kind: str) -> str:
    return (
        f'needs a power law under [material], not {kind}; vary "material.thickness[0]" and "material.modulus[0]" '
        "and so on, or give three depths or more in vary.modulus for a free gradient"
    )


def varied(name: str, bounds: str = "[1e-6, 1e-5]", more: str = "") -> dict[str, str]:
    return {"material": LAYERS, "design": f'vary = {{ "{name}" = {bounds} }}\nminimise = "wear_volume"\n{more}'}


BESIDE = "the modulus is a power law, a table or layers"


@pytest.mark.parametrize(
    "given, said",
    [
        ({"indenter": 'indenter = "steel"'}, f'[contact] indenter = "steel": {INDENTER}'),
        ({"indenter": "indenter = { E = 210e9 }"}, f"[contact] indenter = {{ E = 210000000000.0 }}: {INDENTER}"),
        ({"indenter": "indenter = { E = 0, nu = 0.3 }"}, f"[contact] indenter = {{ E = 0, nu = 0.3 }}: {INDENTER}"),
        ({"material": f"{TABLE}\nE0 = 1e9"}, f"[material] E0 = 1000000000.0: cannot be combined with table; {BESIDE}"),
        ({"material": "thickness = 2e-6\nmodulus = [1e9, 2e9]"}, f"[material] thickness = 2e-06: {THICKNESSES}"),
        ({"material": "thickness = [0]\nmodulus = [1e9, 2e9]"}, f"[material] thickness = [0]: {THICKNESSES}"),
        ({"material": "thickness = [inf]\nmodulus = [1e9, 2e9]"}, f"[material] thickness = [inf]: {THICKNESSES}"),
        ({"material": "thickness = [1e-6]"}, f"[material] modulus: missing; it {MODULI}"),
        ({"material": "modulus = [1e9, 2e9]"}, f"[material] thickness: missing; it {THICKNESSES}"),
        (
            {"material": "thickness = [1e-6]\nmodulus = [1, 2, 3]"},
            "[material] modulus = [1, 2, 3]: must hold 2 moduli for 1 thicknesses, the last one that of the substrate, "
            "not 3",
        ),
        (
            varied("material.thickness[2]"),
            '[design] vary."material.thickness[2]" = [1e-06, 1e-05]: there is no such number: [material], layers, '
            "has 2 of thickness",
        ),
        (
            varied("material.depth[0]"),
            '[design] vary."material.depth[0]" = [1e-06, 1e-05]: there is no such number: [material], layers, '
            "has no depth",
        ),
        (
            varied("material.thickness[0]", "[1e-5, 1e-6]"),
            f'[design] vary."material.thickness[0]" = [1e-05, 1e-06]: {ELEMENT} m',
        ),
        (
            varied("material.modulus[0]", "[-1, 1e9]"),
            f'[design] vary."material.modulus[0]" = [-1, 1000000000.0]: {ELEMENT} Pa',
        ),
        (varied("material.modulus[0]", "1e9"), f'[design] vary."material.modulus[0]" = 1000000000.0: {ELEMENT} Pa'),
        (
            varied("material.moduli[0]"),
            '[design] vary."material.moduli[0]" = [1e-06, 1e-05]: there is no such key; '
            'did you mean "material.modulus[0]"?',
        ),
        (
            varied("material.modulus[0]", "[1e9, 2e9]", 'hold = "contact_radius"'),
            f'[design] hold = "contact_radius": {needs("layers")}',
        ),
        (
            varied(
                "material.modulus[0]", "[1, 2]", "limits = { modulus = { at = [1, 2], between = [[1, 2], [1, 2]] } }"
            ),
            f"[design] limits.modulus = {{ at = [1, 2], between = [[1, 2], [1, 2]] }}: {needs('layers')}",
        ),
        ({"material": f"{LAYERS}\nk = 0"}, f"[material] k = 0: cannot be combined with layers; {BESIDE}"),
        ({"material": f"{TABLE}\nx = 0"}, "[material] x = 0: there is no such key; allowed are table, nu"),
        (
            {"material": TABLE, "design": POWER_DESIGN},
            f"[design] vary.k = [-0.5, 0.5]: {needs('a table')}",
        ),
        (
            {"design": FREE.replace("vary = {", "vary = { k = [0, 0.5],") + '\nminimise = "wear_volume"'},
            "[design] vary.k = [0, 0.5]: cannot vary beside a free gradient, which is no power law",
        ),
        (
            {"design": FREE.replace("at = ", "steepness = -1, at = ") + '\nminimise = "wear_volume"'},
            "[design] vary.modulus.steepness = -1: must be a finite number > 0, "
            "the largest |log(E2/E1)/log(z2/z1)| between depths of a free gradient",
        ),
    ],
)  # fmt: skip
def test_what_is_refused(file, given, said):
    assert complaint(file, **given) == f"scene.toml: {said}"


@pytest.mark.parametrize(
    "content, said",
    [
        ("depth (um),modulus (GPa)\n0,400\n", "row 2: is the only one; a graded modulus needs two depths or more"),
        (
            "depth (um),modulus (GPa)\n0,400\n5,300\n5,110\n",
            "row 4: depth = 5e-06 m after 5e-06 m: "
            "the depths must increase from row to row, from the surface downwards",
        ),
        ("depth_um,modulus_GPa\n0,400\n5,-3\n", "row 3: modulus = -3: must be a finite number > 0, Young's modulus"),
        ("depth_um,modulus_GPa\n0,400\n5,nan\n", "row 3: modulus = nan: must be a finite number > 0, Young's modulus"),
        ("depth_um,modulus_GPa\n0,400\n5,0\n", "row 3: modulus = 0: must be a finite number > 0, Young's modulus"),
        ("depth (in),modulus\n0,4e11\n", 'row 1: column "depth (in)": the unit must be m or mm or um or nm'),
        ("depth,modulus [m]\n0,4e11\n", 'row 1: column "modulus [m]": the unit must be Pa or kPa or MPa or GPa'),
        (
            "depth,modulus\n0,400\n1e-5,110\n",
            "row 2: modulus = 400: is no modulus of a coating in Pa, the unit of a column without one; "
            "write modulus (GPa)",
        ),
        (
            "depth,modulus\n0,4e11\n10,1e11\n",
            "row 3: depth = 10: is no depth of a coating in m, the unit of a column without one; write depth (um)",
        ),
        ("z,E\n0,4e11\n", "row 1: column z: there is no such column; allowed are depth, modulus"),
        ("depth,depth (um),modulus\n", "row 1: column depth: stands there more than once"),
    ],
)
def test_bad_tables_are_refused_in_a_line(file, content, said):
    Path("E.csv").write_text(content)
    assert complaint(file, material=TABLE) == f"E.csv: {said}"


@pytest.mark.parametrize(
    "content",
    [
        "depth,modulus\n0,4e11\n1e-5,1.1e11\n",
        "depth (m),modulus (Pa)\n0,4e11\n1e-5,1.1e11\n",
        "modulus_GPa;depth_mm\n400;0\n110;0.01\n",
        "depth (\N{MICRO SIGN}m)\tmodulus [MPa]\n0\t400e3\n10\t110e3\n",
        "depth[nm] , modulus(kPa)\n0,4e8\n10000,1.1e8\n",
    ],
)
def test_units_of_a_table(file, content):
    Path("E.csv").write_text(content, encoding="utf-8")
    read = loaded(file, material=TABLE).material.read
    np.testing.assert_allclose(read["depth"], [0.0, 1e-5], rtol=1e-15)
    np.testing.assert_allclose(read["modulus"], [400e9, 110e9], rtol=1e-15)
    assert read == loaded(file, material=TABLE).material.read


def test_a_punch_takes_a_power_law_alone(file):
    file.write_text(
        '[material]\ntable = "E.csv"\nnu = 0.3\n[contact]\nkind = "gross-slip"\nradius = 1e-3\ndepth = 1e-6\n'
    )
    with pytest.raises(
        scene.SceneError, match=r'kind = "gross-slip": needs a power law under \[material\], not a table'
    ):
        scene.load(file)


def test_a_free_gradient_has_no_other_commands(file):
    given = loaded(file, design=f'{FREE}\nminimise = "wear_volume"')
    for ask in (given.design, lambda: given.front(distance=1e-6)):
        with pytest.raises(scene.SceneError, match="only plgwear design takes that"):
            ask()
