"""The command `plgwear wear`, and the wear coefficient from measured volumes."""

import csv
import functools
import json
from pathlib import Path

import commands
import numpy as np
import pytest
from matplotlib import image
from refusals import cases, is_told

from plgwear_jax import FrettingContact, PowerLawGraded, fitting, scene
from plgwear_jax.loads import Block, Displacement
from plgwear_jax.wear_laws import PressurePower

SCENE = """
material = { E0 = 110e9, z0 = 1e-4, k = 0.0, nu = 0.3 }
contact = { kind = "fretting", radius = 0.005, normal_force = 10.0, friction = 0.4 }
load = { tangential_force = 2.0 }
wear = { coefficient = 1e-14, cycles = 5e5 }
"""
COEFFICIENT, FORCE = 1e-14, 2.0
REFUSED = Path(__file__).with_name("refused.toml")


@pytest.fixture(autouse=True)
def _scene(_folder: None) -> None:
    write(SCENE)


def write(text: str) -> None:
    Path("mine.toml").write_text(text)


plgwear, refused = (functools.partial(run, "wear", "mine.toml") for run in (commands.plgwear, commands.refused))


def the_contact() -> FrettingContact:
    found = scene.load("mine.toml").build_contact()
    assert isinstance(found, FrettingContact)
    return found


# --- the course -------------------------------------------------------------------------------------------------------


@pytest.mark.compiled
def test_the_course_is_told_written_and_drawn():
    result = plgwear("--json", "--csv", "course.csv", "--picture", "course.png")
    assert result.exit_code == 0 and result.stderr == ""
    told = json.loads(result.stdout)
    assert told["cycles"] == [1e3, 1e4, 1e5, 5e5, 1e6] and told["life"] == 5e5
    assert told["tangential_force"] == FORCE and told["wear_coefficient"] == COEFFICIENT
    its = the_contact()
    worn = its.over_cycles(FORCE, COEFFICIENT).volume(np.array(told["cycles"]))
    np.testing.assert_allclose(told["volume"], worn, rtol=1e-12)
    end = told["steady_state"]
    assert end["volume"] == pytest.approx(float(its.steady(FORCE).wear_volume), rel=1e-12)
    assert end["deepest_wear"] == pytest.approx(float(its.steady(FORCE).deepest_wear), rel=1e-3)
    assert end["worn_radius"] == pytest.approx(float(its.steady(FORCE).worn_radius), rel=1e-12)
    # Archard's law and the energy of friction say the same.
    np.testing.assert_allclose(
        np.array(told["energy_per_cycle"]) * COEFFICIENT, 0.4 * np.array(told["volume_per_cycle"]), rtol=1e-12
    )
    assert told["energy_per_cycle"][0] == pytest.approx(float(its.steady(FORCE).energy_per_cycle), rel=0.01)
    assert np.all(np.diff(told["contact_radius"]) >= 0.0) and np.all(np.diff(told["deepest_wear"]) > 0.0)
    assert told["cycles_to"].keys() == {"0.5", "0.9", "0.99"}
    rows = list(csv.DictReader(Path("course.csv").read_text().splitlines()))
    cycles, volume = (np.array([float(row[name]) for row in rows]) for name in ("cycles", "volume"))
    assert set(told["cycles"]) <= set(cycles) and np.all(np.diff(cycles) > 0.0)
    half = np.interp(told["cycles_to"]["0.5"], cycles, volume)
    assert half == pytest.approx(0.5 * end["volume"], rel=2e-3)
    drawn = image.imread("course.png")
    assert drawn.shape[:2] == (1003, 2125) and drawn[..., :3].std() > 0.1

    table = plgwear("--picture", "course.png")
    assert table.exit_code == 0 and max(map(len, table.stdout.splitlines()[:-3])) <= 80
    assert ["steady state", "555.1", "100"] in [row[:3] for row in commands.table_rows(table.stdout)]
    assert "521 µm³ after the life of 500,000 cycles: 93.9 %" in table.stdout
    assert table.stdout.splitlines()[-1] == "picture: course.png"


@pytest.mark.long  # to compile
def test_less_is_worn_at_a_held_displacement():
    write(SCENE.replace("tangential_force = 2.0", "displacement = 2e-7, rig_stiffness = 3e7"))
    told = json.loads(plgwear("--json").stdout)
    its = the_contact()
    force = float(its.steady(Displacement(2e-7, 3e7)).tangential_force)
    assert told["tangential_force"] == pytest.approx(force, rel=1e-9)
    assert told["steady_state"]["volume"] < 0.99 * float(its.steady(force).wear_volume)
    assert told["steady_state"]["worn_radius"] < float(its.steady(force).worn_radius)
    printed = plgwear().stdout
    assert printed.startswith(f"displacement 2e-07 m of the rig: a force amplitude of {force:.4g} N before wear\n")
    assert "at a constant displacement amplitude 50 % is worn after" in printed


@pytest.mark.compiled
def test_a_history_with_cycles_is_worn_block_by_block():
    Path("h.csv").write_text("cycles,tangential_force\n5e4,1.0\n5e5,2.0\n0,1.0\n")
    write(SCENE.replace("tangential_force = 2.0", 'history = "h.csv"'))
    told = json.loads(plgwear("--json", "--csv", "blocks.csv").stdout)
    blocks = [Block(1.0, 5e4), Block(2.0, 5e5), Block(1.0, 0.0)]
    run = the_contact().over_cycles(blocks, COEFFICIENT)
    np.testing.assert_allclose(told["volume"], run.volume(np.array(told["cycles"])), rtol=1e-12)
    assert told["cycles"] == [5e4, 5.5e5, 5.5e5] and told["volume"][1] == told["volume"][2]
    assert image.imread(told["picture"]).std() > 0.1
    assert len(Path("blocks.csv").read_text().splitlines()) == 4
    printed = plgwear().stdout
    assert "[wear] cycles: the history has cycles of its own, which count here" in printed
    Path("volumes.csv").write_text("cycles,volume\n1e6,1e-16\n")
    assert refused("--fit", "volumes.csv") == "volumes.csv: cycles: up to 1e+06, more than the 550000 of the blocks"


def test_a_coefficient_in_another_unit_is_doubted():
    write(SCENE.replace("1e-14", "1e-5"))
    result = plgwear("--json")
    assert result.exit_code == 0
    assert result.stderr.startswith("mine.toml: [wear]: 99 % is worn after 0.00074 cycles; is the unit of the ")


@cases(REFUSED, "wear")
def test_refusal(case):
    Path("l.csv").write_text("tangential_force,weight\n0.3,1\n")
    Path("h.csv").write_text("tangential_force\n0.3\n")
    Path("o.csv").write_text("tangential_force,cycles\n0.3,1\n")
    write(SCENE.replace(case["old"], case["new"]))
    assert is_told(refused(), case)


def test_refusal_for_gross_slip_and_of_targets():
    assert refused("--csv", "course.txt") == "course.txt: must end in .csv"
    assert refused("--picture", "course.bmp").startswith("course.bmp: must end in")
    write("material = { E0 = 1e9, z0 = 1e-3, k = -0.5, nu = 0.3 }\ncontact = { kind = 'gross-slip', radius = 2e-3, "
          "depth = 1e-6 }")  # fmt: skip
    assert refused() == 'mine.toml: [contact] kind = "gross-slip": only a fretting contact wears over cycles'


# --- the fit ----------------------------------------------------------------------------------------------------------

CYCLES = np.array([0.0, 2e4, 5e4, 1e5, 2e5, 4e5, 8e5])


@pytest.fixture(scope="module")
def measured():
    """A contact, and what it wears with a coefficient of 1e-14 1/Pa after CYCLES."""
    its = FrettingContact(PowerLawGraded(110e9, 1e-4, 0.0, 0.3), 5e-3, 10.0, 0.4)
    return its, np.asarray(its.over_cycles(FORCE, COEFFICIENT).volume(CYCLES))


def test_an_interval_reaches_to_where_the_squares_have_risen(measured):
    """By 1.96^2."""
    its, volume = measured
    noisy = volume * (1.0 + 0.05 * np.random.default_rng(1).standard_normal(volume.size))
    found = fitting.fit_wear_coefficient(its, FORCE, CYCLES, noisy, 0.05 * volume + 1e-22)
    ends = found.wear_coefficient, *found.interval
    least, *rise = (np.sum(((fitting_curve(found, end) - noisy)[1:] / found.deviation[1:]) ** 2) for end in ends)
    np.testing.assert_allclose(np.array(rise) - least, 1.96**2, rtol=0.05)


def fitting_curve(found: fitting.Fit, coefficient: float) -> np.ndarray:
    """The volume after CYCLES with another coefficient: that of the fit after other cycles."""
    at = CYCLES * coefficient / found.wear_coefficient
    return np.interp(at, np.append(0.0, found.curve_cycles), np.append(0.0, found.curve[0]))


@pytest.mark.parametrize(
    "change, doubt, bounded",
    [
        (lambda N, v: (100.0 * N, np.full_like(v, v.max())), "all points lie beyond 9", None),
        (lambda N, v: (N[:2], v[:2]), "one point and one unknown", False),
        (lambda N, v: (N[3:6:2], v[3:6:2] * np.array([0.1, 1.0])), "the scatter is too large", None),
        (lambda N, v: (N, 3.0 * v), "up to 2.98 times the volume of the steady state is measured", None),
    ],
)
def test_a_fit_says_what_the_data_cannot_tell(measured, change, doubt, bounded):
    its, volume = measured
    found = fitting.fit_wear_coefficient(its, FORCE, *change(CYCLES, volume))
    assert found.doubt is not None and found.doubt.startswith(doubt)
    assert found.wear_coefficient > 0.0
    assert bounded is None or np.isnan(found.interval).all()


def test_the_command_fits(measured):
    _, volume = measured
    write(SCENE.partition("wear =")[0])  # what it looks for need not be there
    rows = (f"{N},{v * 1.03 ** (-1) ** i},{0.05 * v + 1e-22}" for i, (N, v) in enumerate(zip(CYCLES, volume)))  # noqa: B905
    Path("volumes.csv").write_text("\n".join(["cycles,volume,deviation", *rows]))
    result = plgwear("--fit", "volumes.csv", "--json")
    assert result.exit_code == 0 and result.stderr == ""
    told = json.loads(result.stdout)
    low, high = told["interval_95_percent"]
    assert low < COEFFICIENT < high and told["doubt"] is None
    assert told["energy_coefficient_mm3_per_J"] == pytest.approx(1e9 * told["wear_coefficient"] / 0.4)
    assert image.imread(told["picture"]).shape[:2] == (826, 1653)
    printed = plgwear("--fit", "volumes.csv").stdout
    assert f"wear coefficient: {told['wear_coefficient']:.4g} 1/Pa" in printed and "95 % confidence: " in printed


@cases(REFUSED, "volumes")
def test_refusal_of_measured_volumes(case):
    Path("v.csv").write_text(case["content"])
    assert is_told(refused("--fit", "v.csv"), case)
    assert refused("--fit", "v.csv", "--csv", "c.csv").startswith("--csv: a fit writes no course")


def test_a_share_stands_for_deviations_and_the_life_of_a_coating_follows(measured):
    its, volume = measured
    write(SCENE.partition("wear =")[0])
    rows = (f"{N},{1e18 * v}" for N, v in zip(CYCLES, volume, strict=True))
    Path("v.csv").write_text("\n".join(["cycles,volume (um^3)", *rows]))
    result = plgwear("--fit", "v.csv", "--deviation", "0.05", "--until", "5e-8", "--json")
    assert result.exit_code == 0 and result.stderr == ""
    told = json.loads(result.stdout)
    np.testing.assert_allclose(told["deviation"], 0.05 * volume, rtol=1e-12)
    np.testing.assert_allclose(told["wear_coefficient"], COEFFICIENT, rtol=1e-6)
    needed = float(its.over_cycles(FORCE, COEFFICIENT).cycles_to(depth=5e-8))
    assert told["until"] == {"depth": 5e-8, "cycles": pytest.approx(needed, rel=1e-5)}
    # Only K times the cycles counts.
    expected = [needed * COEFFICIENT / K for K in reversed(told["interval_95_percent"])]
    np.testing.assert_allclose(told["interval_95_percent_until"], expected, rtol=1e-5)
    printed = plgwear("--fit", "v.csv", "--deviation", "0.05", "--until", "5e-8").stdout
    assert f"50 nm deep after {needed:,.0f} cycles, 95 % confidence: " in printed
    assert (
        refused("--fit", "v.csv", "--deviation", "0")
        == "--deviation = 0: must be a finite number > 0, a share of the volumes"
    )
    assert refused("--deviation", "0.1") == "--deviation: is that of volumes that --fit reads"
    assert refused("--until", "nan") == "--until = nan: must be a finite number > 0, a depth in m"
    Path("v.csv").write_text("cycles,volume (um^3),deviation (%)\n0,0,5\n1e5,0,5\n2e5,1,5\n")
    assert refused("--fit", "v.csv") == "v.csv: row 3: volume = 0: has no relative deviation"
    assert refused("--fit", "v.csv", "--deviation", "0.1") == "--deviation: v.csv has a column of deviations"


@pytest.mark.compiled
def test_how_long_until_a_depth_is_worn():
    run, steady = the_contact().over_cycles(FORCE, COEFFICIENT), the_contact().steady(FORCE)
    told = json.loads(plgwear("--until", "5e-8", "--json").stdout)
    assert told["until"] == {"depth": 5e-8, "cycles": pytest.approx(float(run.cycles_to(depth=5e-8)), rel=1e-9)}
    assert f"50 nm deep after {told['until']['cycles']:,.0f} cycles" in plgwear("--until", "5e-8").stdout
    told = plgwear("--until", "1e-5").stdout
    assert f"a depth of 10 µm is never reached: the deepest wear is {1e9 * steady.deepest_wear:.4g} nm" in told
    assert json.loads(plgwear("--until", "1e-5", "--json").stdout)["until"]["cycles"] is None
    Path("h.csv").write_text("cycles,tangential_force\n2e5,1\n2e5,2\n")
    write(SCENE.replace("tangential_force = 2.0", 'history = "h.csv"'))
    assert "a depth of 10 µm is never reached: the deepest wear is " in plgwear("--until", "1e-5").stdout
    assert 2e5 < json.loads(plgwear("--until", "3e-8", "--json").stdout)["until"]["cycles"] < 4e5


# --- gross slip, changing forces, other wear laws ---------------------------------------------------------------------

SLIDING = SCENE.replace("tangential_force = 2.0", "displacement = 1e-5")
CHANGING = "displacement (um),cycles,normal_force (N),friction\n0.1,1e5,10,0.4\n10,1e4,5,0.3\n0.2,1e5,20,0.5\n"


@pytest.mark.compiled
def test_gross_slip_is_worn_and_has_no_steady_state():
    write(SLIDING)
    result = plgwear("--json", "--csv", "course.csv", "--picture", "course.png")
    assert result.exit_code == 0 and result.stderr == ""
    told = json.loads(result.stdout)
    assert told["regime"] == "gross slip"
    assert not {"steady_state", "cycles_to", "tangential_force"} & told.keys() and told["cycles"][-1] == 5e5
    its = the_contact()
    run = its.over_cycles(Displacement(1e-5), COEFFICIENT)
    np.testing.assert_allclose(told["volume"], run.volume(np.array(told["cycles"])), rtol=1e-9)
    # Archard's law for a ball that slides by four times the displacement less what the contact takes.
    sliding = COEFFICIENT * 10.0 * 4.0 * (1e-5 - float(its.steady(0.0).gross_slip_displacement))
    assert told["volume_per_cycle"][0] == pytest.approx(sliding, rel=0.05)
    assert told["contact_radius"][-1] ** 4 == pytest.approx(4.0 * told["volume"][-1] * 5e-3 / np.pi, rel=0.1)
    np.testing.assert_array_equal(told["stick_radius"], 0.0)
    assert len(Path("course.csv").read_text().splitlines()) > 50
    assert image.imread("course.png")[..., :3].std() > 0.1
    printed, onset = plgwear().stdout, 1e9 * float(its.steady(0.0).gross_slip_displacement)
    assert f"the contact slips as a whole, from {onset:.4g} nm on" in printed
    assert "gross slip at a constant displacement amplitude: " in printed and "steady" not in printed
    assert "; the wear goes on\n" in printed
    write(SLIDING.replace(", cycles = 5e5", ""))
    assert "; it is followed no further; set your life by cycles under [wear]\n" in plgwear().stdout


@pytest.mark.compiled
def test_blocks_change_normal_force_friction_and_amplitude():
    Path("h.csv").write_text(CHANGING)
    write(SCENE.replace("tangential_force = 2.0", 'history = "h.csv"'))
    told = json.loads(plgwear("--json", "--csv", "blocks.csv").stdout)
    its = the_contact()
    blocks = [
        Block(Displacement(1e-7), 1e5, 10.0, 0.4),
        Block(Displacement(1e-5), 1e4, 5.0, 0.3),
        Block(Displacement(2e-7), 1e5, 20.0, 0.5),
    ]
    run, ends = its.over_cycles(blocks, COEFFICIENT), np.array(told["cycles"])
    np.testing.assert_allclose(told["volume"], run.volume(ends), rtol=1e-6)
    np.testing.assert_allclose(told["tangential_force"], run.force_amplitude(ends), rtol=1e-6)
    np.testing.assert_allclose(told["contact_radius"], run.contact_radius(ends), rtol=1e-6)
    assert (told["normal_force"], told["friction"]) == ([10.0, 5.0, 20.0], [0.4, 0.3, 0.5])
    assert told["blocks_in_gross_slip"] == [2]
    printed = plgwear().stdout
    assert "block 2: gross slip, at a constant displacement amplitude" in printed and "…" not in printed


@pytest.mark.compiled
def test_a_pressure_exponent_and_wear_of_both_bodies():
    write(SCENE.replace("coefficient = 1e-14", "coefficient = 2e-19, exponent = 1.5, half_space_coefficient = 6e-19"))
    told = json.loads(plgwear("--json").stdout)
    assert told["exponent"] == 1.5 and told["units"]["coefficient"] == "1/Pa^1.5"
    assert told["coefficient"] == pytest.approx(8e-19) and told["half_space_share"] == pytest.approx(0.75)
    run = the_contact().over_cycles(FORCE, PressurePower(8e-19, 1.5))
    np.testing.assert_allclose(told["volume"], run.volume(np.array(told["cycles"])), rtol=1e-9)
    assert told["steady_state"]["volume"] == pytest.approx(float(the_contact().steady(FORCE).wear_volume), rel=1e-9)
    assert "the half-space " in plgwear().stdout


@pytest.mark.compiled
def test_a_half_space_that_loses_too_much_of_its_gradient_is_refused():
    both = "coefficient = 1e-14, half_space_coefficient = 1e-14"
    graded = SLIDING.replace("k = 0.0", "k = 0.3").replace("cycles = 5e5", "cycles = 5e6")
    write(graded.replace("coefficient = 1e-14", both))
    line = refused()
    assert line.startswith("mine.toml: [wear] half_space_coefficient: it would wear ") and "than a tenth of the" in line
    write(SLIDING.replace("coefficient = 1e-14", both))
    assert plgwear("--json").exit_code == 0  # nothing changes over the depth
    layers = "material = { thickness = [1e-6], modulus = [200e9, 110e9], nu = 0.3 }\n"
    rest = SLIDING[SLIDING.index("contact =") :]
    write(layers + rest.replace("coefficient = 1e-14", both))
    assert "of the 1 µm over which its modulus changes" in refused()


@pytest.mark.compiled
def test_gross_slip_is_followed_to_a_scar_of_some_radii():
    write(SLIDING.replace("cycles = 5e5", "cycles = 5e12"))
    assert refused().startswith("mine.toml: [wear] cycles = 5e+12: after ")


@pytest.mark.compiled
def test_the_command_fits_gross_slip_and_blocks():
    its = the_contact()
    cycles = np.array([1e4, 1e5, 2e5])
    Path("h.csv").write_text("cycles,displacement\n2e5,1e-7\n2e5,1e-5\n")
    force = float(its.steady(Displacement(1e-7)).tangential_force)
    for load, test in (
        ("displacement = 1e-5", Displacement(1e-5)),
        ('history = "h.csv"', [Block(force, 2e5), Block(Displacement(1e-5), 2e5)]),
    ):
        write(SCENE.partition("wear =")[0].replace("tangential_force = 2.0", load))
        at = cycles if isinstance(test, Displacement) else cycles + 1e5
        rows = zip(at, np.asarray(its.over_cycles(test, COEFFICIENT).volume(at)), strict=True)
        Path("v.csv").write_text("cycles,volume\n" + "".join(f"{N},{v}\n" for N, v in rows))
        told = json.loads(plgwear("--fit", "v.csv", "--json").stdout)
        assert told["wear_coefficient"] == pytest.approx(COEFFICIENT, rel=0.01) and told["steady_volume"] is None
        assert "wear coefficient: " in plgwear("--fit", "v.csv").stdout


@pytest.mark.compiled
def test_a_fit_doubts_more_wear_than_any_coefficient_explains():
    its, cycles = the_contact(), np.array([1e4, 1e5])
    for load in (Displacement(1e-5), [Block(2.0, 1e5)]):
        found = fitting.fit_wear_coefficient(its, load, cycles, np.array([1e-9, 1e-8]))
        assert found.doubt == "more is measured than any wear coefficient explains: the test is another than given"


def test_a_displacement_too_small_for_numbers_is_refused():
    write(SLIDING.replace("1e-5", "1e-300"))
    assert refused().startswith("mine.toml: the wear exceeds the range of numbers")
