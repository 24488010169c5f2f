"""The command `plgwear wear`, and the wear coefficient from measured volumes."""

import functools
from pathlib import Path

import commands
import numpy as np
import pytest
from commands import write
from kinds import COEFFICIENT, dome
from marks import compiled, compiled_case, parametrize
from matplotlib import image
from numpy.testing import assert_allclose
from refusals import cases, is_told

from plgwear_jax import fitting
from plgwear_jax.loads import Block, Displacement
from plgwear_jax.wear_laws import PressurePower

SCENE = """
material = { E0 = 110e9, z0 = 1e-4, k = 0.0, nu = 0.3 }
contact = { kind = "fretting", radius = 0.005, normal_force = 10.0, friction = 0.4 }
load = { tangential_force = 2.0 }
wear = { coefficient = 1e-14, cycles = 5e5 }
"""
FITTED = SCENE.partition("wear =")[0]  # what is looked for need not be there
OF_HISTORY = SCENE.replace("tangential_force = 2.0", 'history = "h.csv"')
SLIDING = SCENE.replace("tangential_force = 2.0", "displacement = 1e-5")
FORCE, CONTACT = 2.0, dome()
plgwear, refused, told, printed = (
    functools.partial(run, "wear mine.toml")
    for run in (commands.plgwear, commands.refused, commands.told, commands.printed)
)


@pytest.fixture(autouse=True)
def _scene(_folder):
    write(SCENE)


def written(file, columns, *rows):
    """Write a table."""
    Path(file).write_text("\n".join([columns, *(",".join(map(str, row)) for row in zip(*rows, strict=True))]))


# --- the course -------------------------------------------------------------------------------------------------------


@compiled
def test_the_course_is_told_written_and_drawn():
    found, steady = told("--csv course.csv --picture course.png"), CONTACT.steady(FORCE)
    run, cycles, end = CONTACT.over_cycles(FORCE, COEFFICIENT), np.array(found["cycles"]), found["steady_state"]
    assert found["cycles"] == [1e3, 1e4, 1e5, 5e5, 1e6] and found["life"] == 5e5
    of_run = {"volume_per_cycle": run.rate} | {name: getattr(run, name) for name in ("volume", *SAME)}
    for name, after in of_run.items():
        assert_allclose(found[name], after(cycles), rtol=1e-9, err_msg=name)
    known = steady.wear_volume, steady.deepest_wear, steady.worn_radius
    assert_allclose([end[name] for name in ("volume", "deepest_wear", "worn_radius")], known, rtol=1e-3)
    assert found["cycles_to"].keys() == {"0.5", "0.9", "0.99"}
    course = np.genfromtxt("course.csv", delimiter=",", names=True)
    assert {*found["cycles"]} <= {*course["cycles"]} and np.all(np.diff(course["cycles"]) > 0.0)
    half = np.interp(found["cycles_to"]["0.5"], course["cycles"], course["volume"])
    assert_allclose(half, 0.5 * end["volume"], rtol=2e-3)
    drawn = image.imread("course.png")
    assert drawn.shape[:2] == (1003, 2125) and drawn[..., :3].std() > 0.1

    table = printed("--picture course.png")
    assert max(map(len, table.splitlines()[:-3])) <= 80
    assert ["steady state", "555.1", "100"] in [row[:3] for row in commands.table_rows(table)]
    assert "521 µm³ after the life of 500,000 cycles: 93.9 %" in table
    assert table.splitlines()[-1] == "picture: course.png"

    write(SCENE.replace("5e5", "1e199"))  # more decades than there are rows
    assert told("--picture course.png")["life"] == 1e199


SAME = "energy_per_cycle", "contact_radius", "deepest_wear"
PLAIN = "cycles,tangential_force\n5e4,1.0\n5e5,2.0\n0,1.0\n"
CHANGING = "displacement (um),cycles,normal_force (N),friction\n0.1,1e5,10,0.4\n10,1e4,5,0.3\n0.2,1e5,20,0.5\n"


@compiled
@parametrize(
    "history, blocks, own",
    [
        (PLAIN, [Block(1.0, 5e4), Block(2.0, 5e5), Block(1.0, 0.0)], {"blocks_in_gross_slip": []}),
        (
            CHANGING,
            [
                Block(Displacement(1e-7), 1e5, 10.0, 0.4),
                Block(Displacement(1e-5), 1e4, 5.0, 0.3),
                Block(Displacement(2e-7), 1e5, 20.0, 0.5),
            ],
            {"normal_force": [10.0, 5.0, 20.0], "friction": [0.4, 0.3, 0.5], "blocks_in_gross_slip": [2]},
        ),
    ],
)
def test_a_history_with_cycles_is_worn_block_by_block(history, blocks, own):
    Path("h.csv").write_text(history)
    write(OF_HISTORY)
    found, run = told("--csv blocks.csv"), CONTACT.over_cycles(blocks, COEFFICIENT)
    ends = np.cumsum([block.cycles for block in blocks])
    assert found == found | own | {"cycles": ends.tolist()}
    read = {"volume": run.volume, "tangential_force": run.force_amplitude, "contact_radius": run.contact_radius}
    for name, after in read.items():
        assert_allclose(found[name], after(ends), rtol=1e-6)
    assert len(Path("blocks.csv").read_text().splitlines()) == 4
    table, slides = printed(), "block 2: gross slip, at a constant displacement amplitude"
    assert "[wear] cycles: the history has cycles of its own, which count here" in table and "…" not in table
    assert (slides in table) == ("friction" in own)
    written("v.csv", "cycles,volume", [1e6], [1e-16])
    line = f"v.csv: cycles: up to 1e+06, more than the {ends[-1]:g} of the blocks"
    assert refused("--fit v.csv") == line


def test_a_coefficient_in_another_unit_is_doubted(undrawn):
    write(SCENE.replace("1e-14", "1e-5"))
    result = plgwear("--json")
    assert result.exit_code == 0
    assert result.stderr.startswith("mine.toml: [wear]: 99 % is worn after 0.00074 cycles; is the unit of the ")


@cases("cli/refused.toml", "wear")
def test_refusal(case):
    written("l.csv", "tangential_force,weight", [0.3], [1])
    written("h.csv", "tangential_force", [0.3])
    written("v.csv", "cycles,volume", [1e5], [1e-16])
    written("share.csv", "cycles,volume (um^3),deviation (%)", [0, 1e5, 2e5], [0, 0, 1], [5, 5, 5])
    write(case.get("scene") or SCENE.replace(case.get("old", ""), case.get("new", "")))
    assert is_told(refused(*case.get("arguments", ())), case)


# --- the fit ----------------------------------------------------------------------------------------------------------

CYCLES = np.array([0.0, 2e4, 5e4, 1e5, 2e5, 4e5, 8e5])


@pytest.fixture(scope="module")
def volume():
    """What is worn after CYCLES with a coefficient of 1e-14 1/Pa."""
    return np.asarray(CONTACT.over_cycles(FORCE, COEFFICIENT).volume(CYCLES))


@parametrize("known", [True, False])
def test_an_interval_reaches_to_where_the_squares_have_risen(volume, known):
    """By the squared quantile of the normal distribution, or of Student's."""
    from scipy import stats  # takes half a second

    noise = 0.05 * np.random.default_rng(1).standard_normal(volume.size)
    noisy = volume * (1.0 + noise) if known else np.abs(volume + noise * volume[-1])
    found = fitting.fit_wear_coefficient(CONTACT, FORCE, CYCLES, noisy, 0.05 * volume + 1e-22 if known else None)
    # The volume with another coefficient is that after other cycles.
    run = CONTACT.over_cycles(FORCE, COEFFICIENT)
    ends = np.array([found.wear_coefficient, *found.interval])[:, None] / COEFFICIENT
    z = (run.volume(ends * CYCLES) - noisy)[:, 1:] / found.deviation[1:]
    least, *rise = np.sum(z**2, axis=-1)
    quantile = (stats.norm() if known else stats.t(5)).ppf(0.975)
    assert_allclose(np.array(rise) - least, quantile**2, rtol=1e-3)
    assert known or least == pytest.approx(5.0, rel=1e-3)  # which makes the scatter that of each
    assert_allclose(found.curve, run.volume(ends * found.curve_cycles), rtol=1e-3)


@parametrize(
    "load, change, doubt",
    [
        (FORCE, lambda N, v: (100.0 * N, np.full_like(v, v.max())), "all points lie beyond 9"),
        (FORCE, lambda N, v: (N[:2], v[:2]), "one point and one unknown"),
        (FORCE, lambda N, v: (N[3:6:2], v[3:6:2] * np.array([0.1, 1.0])), "the scatter is too large"),
        (FORCE, lambda N, v: (N, 3.0 * v), "up to 2.98 times the volume of the steady state is measured"),
        *(
            compiled_case(load, lambda N, v: (N[1:3], 1e8 * v[1:3]), "more is measured than")
            for load in (Displacement(1e-5), [Block(2.0, 1e5)])
        ),
    ],
)  # fmt: skip
def test_a_fit_says_what_the_data_cannot_tell(volume, load, change, doubt):
    found = fitting.fit_wear_coefficient(CONTACT, load, *change(CYCLES, volume))
    assert found.doubt.startswith(doubt) and found.wear_coefficient > 0.0
    assert np.isnan(found.interval).all() == ("one unknown" in doubt)


def test_the_command_fits(volume):
    write(FITTED)
    scattered = volume * 1.03 ** np.resize([1.0, -1.0], CYCLES.size)
    written("v.csv", "cycles,volume,deviation", CYCLES, scattered, 0.05 * volume + 1e-22)
    found = told("--fit v.csv")
    low, high = found["interval_95_percent"]
    assert low < COEFFICIENT < high and found["doubt"] is None
    assert_allclose(found["energy_coefficient_mm3_per_J"], 1e9 * found["wear_coefficient"] / 0.4, rtol=1e-6)
    assert image.imread(found["picture"]).shape[:2] == (826, 1653)
    table = printed("--fit v.csv")
    assert f"wear coefficient: {found['wear_coefficient']:.4g} 1/Pa" in table and "95 % confidence: " in table


@cases("cli/refused.toml", "volumes")
def test_refusal_of_measured_volumes(case):
    Path("v.csv").write_text(case["content"])
    assert is_told(refused("--fit v.csv"), case)


def test_a_share_stands_for_deviations_and_the_life_of_a_coating_follows(volume, undrawn):
    write(FITTED)
    written("v.csv", "cycles,volume (um^3)", CYCLES, 1e18 * volume)
    given = "--fit v.csv --deviation 0.05 --until 5e-8"
    found, needed = told(given), float(CONTACT.over_cycles(FORCE, COEFFICIENT).cycles_to(depth=5e-8))
    assert_allclose(found["deviation"], 0.05 * volume, rtol=1e-12)
    assert_allclose(found["wear_coefficient"], COEFFICIENT, rtol=1e-6)
    assert found["until"] == {"depth": 5e-8, "cycles": pytest.approx(needed, rel=1e-5)}
    # Only K times the cycles counts.
    expected = [needed * COEFFICIENT / K for K in reversed(found["interval_95_percent"])]
    assert_allclose(found["interval_95_percent_until"], expected, rtol=1e-5)
    assert f"50 nm deep after {float(f'{needed:.3g}'):,.0f} cycles, 95 % confidence: " in printed(given)


@compiled
def test_how_long_until_a_depth_is_worn():
    run, deepest = CONTACT.over_cycles(FORCE, COEFFICIENT), 1e9 * CONTACT.steady(FORCE).deepest_wear
    needed = told("--until 5e-8")["until"]
    assert needed == {"depth": 5e-8, "cycles": pytest.approx(float(run.cycles_to(depth=5e-8)), rel=1e-9)}
    about = float(f"{needed['cycles']:.3g}")
    assert f"50 nm deep after {about:,.0f} cycles" in printed("--until 5e-8")
    never = "a depth of 10 µm is never reached: the largest wear depth is "
    assert f"{never}{deepest:.4g} nm" in printed("--until 1e-5")
    assert told("--until 1e-5")["until"]["cycles"] is None
    written("h.csv", "cycles,tangential_force", [2e5, 2e5], [1, 2])
    write(OF_HISTORY)
    assert never in printed("--until 1e-5")
    assert 2e5 < told("--until 3e-8")["until"]["cycles"] < 4e5


# --- gross slip and other wear laws -----------------------------------------------------------------------------------


@compiled
def test_gross_slip_is_worn_and_has_no_steady_state():
    write(SLIDING)
    found = told("--csv course.csv --picture course.png")
    assert found["regime"] == "gross slip" and found["cycles"][-1] == 5e5
    assert not {"steady_state", "cycles_to", "tangential_force"} & found.keys()
    run, onset = CONTACT.over_cycles(Displacement(1e-5), COEFFICIENT), CONTACT.steady(0.0).gross_slip_displacement
    assert_allclose(found["volume"], run.volume(np.array(found["cycles"])), rtol=1e-9)
    table = printed()
    assert f"the contact slips as a whole, from {1e9 * onset:.4g} nm on" in table and "; the wear goes on\n" in table
    assert "gross slip at a constant displacement amplitude: " in table and "steady" not in table
    write(SLIDING.replace(", cycles = 5e5", ""))
    assert "; it is followed no further; set your life by cycles under [wear]\n" in printed()
    write(SLIDING.replace("cycles = 5e5", "cycles = 5e12"))
    assert refused().startswith("mine.toml: [wear] cycles = 5e+12: the wear is followed no further than ")


@compiled
def test_a_pressure_exponent_and_wear_of_both_bodies():
    write(SCENE.replace("coefficient = 1e-14", "coefficient = 2e-19, exponent = 1.5, half_space_coefficient = 6e-19"))
    found, run = told(), CONTACT.over_cycles(FORCE, PressurePower(8e-19, 1.5))
    assert found["units"]["coefficient"] == "1/Pa^1.5"
    assert_allclose(found["half_space_share"], 0.75, rtol=1e-6)
    assert_allclose(found["volume"], run.volume(np.array(found["cycles"])), rtol=1e-9)
    assert "the half-space " in printed()


@compiled
def test_a_half_space_that_loses_too_much_of_its_gradient_is_refused():
    both = SLIDING.replace("coefficient = 1e-14", "coefficient = 1e-14, half_space_coefficient = 1e-14")
    write(both.replace("k = 0.0", "k = 0.3").replace("cycles = 5e5", "cycles = 5e6"))
    line = refused()
    assert line.startswith("mine.toml: [wear] half_space_coefficient: it would wear ") and "than a tenth of the" in line
    write(both)
    told()  # nothing changes over the depth
    write("material = { thickness = [1e-6], modulus = [200e9, 110e9], nu = 0.3 }\n" + both[both.index("contact =") :])
    assert "of the 1 µm over which its modulus changes" in refused()
