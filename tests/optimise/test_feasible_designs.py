"""Designs under limits against grids: a design that exists is found, and none on the grid is better."""

import dataclasses

import numpy as np
from coated import on
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from kinds import STEEL, dome
from marks import compiled, parametrize
from numpy.testing import assert_allclose
from refusals import cases, data

from plgwear_jax import FrettingContact, PowerLawGraded, optimise
from plgwear_jax.optimise.question import with_variables

NAMES = data("optimise/numbers.toml")["names"]


@dataclasses.dataclass
class Asked:
    """A question, with the contacts of a grid over its bounds."""

    contact: FrettingContact
    force: float
    vary: dict[str, tuple[float, float]]
    hold: str | None
    grid: FrettingContact
    distance: float

    def on_grid(self, name):
        value = getattr(self.grid.steady(self.force), name)
        return value(self.distance) if name == "edge_pressure" else value

    def place(self, name):
        return {"distance": self.distance} if name == "edge_pressure" else {}


@st.composite
def asked(draw, variables, points):
    """A contact, a load, bounds of k and perhaps of another number, and the contacts of a grid between them."""

    def log_float(low, high):
        return 10.0 ** draw(st.floats(low, high))

    E0, z0, nu = log_float(9.5, 11.5), log_float(-5.0, -3.0), draw(st.floats(0.0, 0.49))
    radius, normal_force, friction = log_float(-3.0, -1.0), log_float(0.0, 2.0), draw(st.floats(0.1, 0.3))
    phi = draw(st.floats(0.001, 0.99))
    width = log_float(np.log10(0.02), np.log10(1.8))
    lowest = -0.95 + (1.9 - width) * draw(st.floats(0.0, 1.0))
    vary = {"k": (lowest, lowest + width)}
    k = draw(st.sampled_from([0.0, lowest + 0.5 * width]))
    contact = FrettingContact(PowerLawGraded(E0, z0, k, nu), radius, normal_force, friction)
    other = draw(st.sampled_from(["E0", "radius", "friction"])) if variables == 2 else None
    hold = None if other == "E0" else draw(st.sampled_from([None, "contact_radius"]))
    axes = [np.linspace(*vary["k"], points)]
    if other is not None:
        ratio = log_float(0.05, 1.0)
        value = {"E0": E0, "radius": radius, "friction": friction}[other]
        # A friction below that of the contact might not hold the load.
        vary[other] = (value if other == "friction" else value / ratio, value * ratio)
        axes.append(np.geomspace(*vary[other], points))
    at = dict(zip(vary, (axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")), strict=True))
    grid = with_variables(contact, at)
    force = phi * friction * normal_force
    if hold:  # Eq. (12): a_0^(3+k) is inversely proportional to E0
        ratio = grid.steady(0.0).contact_radius / contact.steady(0.0).contact_radius
        grid = on(grid, E0=E0 * ratio ** (3.0 + at["k"]))
    distance = log_float(-3.0, -0.5) * float(np.min(grid.steady(force).stick_radius))
    return Asked(contact, force, vary, hold, grid, distance)


def limited(question, name, above, log_share, most):
    """A limit that a share of the grid keeps, and which of its contacts do; None where the quantity does not change."""
    value = question.on_grid(name)
    if not np.all(np.isfinite(value)) or np.ptp(np.log(value)) < 1e-3:
        return None
    share = max(1e-3, 1.0 - 10.0**log_share if most else 10.0**log_share)
    allowed = np.quantile(value, 1.0 - share if above else share)
    kept = value >= allowed if above else value <= allowed
    return {"above" if above else "below": allowed, **question.place(name)}, kept


def compared(question, objective, limits, kept, rounding=1e-8):
    """The design, which keeps the limits, and is as good as the best on the grid."""
    goal = {objective: question.place(objective)} if question.place(objective) else objective
    found = optimise.design(
        question.contact, question.force, question.vary, hold=question.hold, minimise=goal, limits=limits
    )
    assert found.keeps_limits
    best = np.min(np.where(kept, question.on_grid(objective), np.inf))
    assert found.value <= best * (1.0 + rounding)


def asks_at_random(variables, points):
    sides = st.tuples(st.booleans(), st.floats(-3.0, 0.0), st.booleans())
    names = st.lists(st.sampled_from(NAMES), min_size=2, max_size=3, unique=True)

    @given(asked(variables, points), names, st.lists(sides, min_size=2, max_size=2))
    def test(question, names, sides):
        objective, *others = (name for name in names if not (question.hold and name == "contact_radius"))
        limits, kept = {}, np.ones(1, bool)
        for name, side in zip(others, sides, strict=False):
            one = limited(question, name, *side)
            if one is not None and np.mean(kept & one[1]) >= 1e-3:
                limits[name], kept = one[0], kept & one[1]
        assume(limits)
        compared(question, objective, limits, kept)

    return test


def test_designs_of_one_variable_that_exist_are_found():
    settings(max_examples=2)(asks_at_random(1, 2001))()


@compiled
def test_many_designs_that_exist_are_found():
    settings(max_examples=300)(asks_at_random(1, 2001))()
    settings(max_examples=100)(asks_at_random(2, 101))()


BENT = FrettingContact(PowerLawGraded(10e9, 1.4e-4, 0.0, 0.07), 0.07, 32.0, 0.52)  # the worn radius over k


@parametrize("lowest", [0.1, 0.22, 0.3])
def test_a_limit_that_is_not_monotone(lowest):
    """The worn radius first falls with k; the objective pulls to where no step would lead to contacts that keep it."""
    found = optimise.design(BENT, 14.3, {"k": (lowest, 0.7)}, limits={"worn_radius": {"above": 8.15e-4}})
    assert found.keeps_limits and found.certified
    assert_allclose(found.variables["k"], 0.61991, atol=1e-5)
    assert_allclose(found.value, 2.66768e-12, rtol=1e-5)


@cases("optimise/valleys.toml", "valleys", "name")
def test_lower_valleys_are_left_alone_and_hills_are_not_crossed(case):
    contact = FrettingContact(PowerLawGraded(*case["material"]), *case["contact"])
    assert optimise.design(contact, case["force"], case["vary"], **case["question"]).certified


def test_a_limit_next_to_the_bound_to_which_the_objective_pulls():
    found = optimise.design(
        dome(), 2.8, {"k": (-0.47, -0.42)}, hold="contact_radius", limits={"deepest_wear": {"above": 2.07003e-7}}
    )
    assert found.keeps_limits and found.certified
    assert_allclose(found.contact.steady(2.8).deepest_wear, 2.07003e-7, rtol=1e-9)
    assert -0.4203 < found.variables["k"] < -0.42


def test_limits_that_few_contacts_keep_are_found_by_a_descent():
    """Between two points of the scan: the peak of a quantity along k, of which one part in 1e5 is allowed."""
    k = np.linspace(0.05, 0.7, 20001)
    radius = on(BENT, k=k).steady(14.3).worn_radius
    least = np.argmin(radius)
    assert 100 < least < 19900
    found = optimise.design(
        BENT, 14.3, {"k": (0.05, 0.7)}, limits={"worn_radius": {"below": radius[least] * (1.0 + 2e-6)}}
    )
    assert found.keeps_limits
    assert_allclose(found.variables["k"], k[least], atol=5e-3)


@compiled
@parametrize("log_share", [-2.5, -1.0])
@parametrize("above", [False, True])
@parametrize("name", ["worn_radius", "deepest_wear", "penetration"])
def test_designs_of_an_elastic_pair_that_exist_are_found(name, above, log_share):
    contact = dome(0.0, STEEL)
    grid = dome(np.linspace(-0.5, 0.1, 61), STEEL)
    question = Asked(contact, 2.8, {"k": (-0.5, 0.1)}, None, grid, 1e-6)
    limit, kept = limited(question, name, above, log_share, most=False)
    compared(question, "wear_volume", {name: limit}, kept, rounding=1e-6)


def test_the_ends_of_a_front_are_chosen_among_equals():
    """At a held radius the pressure before wear does not depend on the friction, the wear does."""
    vary = {"k": (-0.3, 0.3), "friction": (0.4, 0.8)}
    curve = optimise.front(dome(), 2.0, vary, "peak_initial_pressure", points=3, hold="contact_radius")
    assert curve.converged.all()
    assert_allclose(curve.variables["friction"][0], 0.8)
