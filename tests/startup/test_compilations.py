"""How many programs a question compiles: the first one a few, another one of the same kind none.

"First" means in a process of its own, which runs all questions in turn and tells what each of them has compiled.
"""

import json
import logging
import os
import re

import jax
import jax.numpy as jnp
import numpy as np
import optima
from inputs import DESIGNS
from kinds import contact_of, dome
from marks import compiled, compiled_case, parametrize
from processes import output
from test_kernels import OF_PINNED, Size, size_in

from plgwear_jax import DepthGraded, FrettingContact, PowerLawGraded, optimise, scene
from plgwear_jax.optimise import evaluation, exponent
from plgwear_jax.optimise.question import question_of
from plgwear_jax.scene import solving

pytestmark = OF_PINNED

CONTACT = dome()
OTHER = FrettingContact(PowerLawGraded(90e9, 2e-4, 0.1, 0.2), radius=6e-3, normal_force=11.0, friction=0.5)
HELD = {"vary": {"k": (-0.9, 0.9)}, "hold": "contact_radius"}
ALLOWED = {"edge_pressure": {"below": 5.5e8, "distance": 1e-6}}
FORCE = [0.2, 0.5, 1.0]
LIFE = {"cycles": 4e5, "law": 1e-14}

# What hands numbers to JAX: an identity for each shape and dtype, of a few milliseconds.
TINY = {"stage", "convert_element_type"}


def questions():
    """Each after those before it."""
    found = []

    def first_design():
        found.append(optimise.design(CONTACT, FORCE, **HELD, limits=ALLOWED))

    def other_numbers():
        vary, limits = {"k": (-0.5, 0.6)}, {"edge_pressure": {"below": 9e8, "distance": 2e-6}}
        force, weight = [0.3, 0.4, 1.5], [0.1, 0.2, 0.3]
        more = {"hold": HELD["hold"], "weight": weight, "level": 0.3, "limits": limits}
        found.append(optimise.design(OTHER, force, vary, **more))

    return {
        "an amplitude": lambda: optimise.optimal_exponent(0.3),
        "other amplitudes": lambda: optimise.optimal_exponent(np.linspace(0.1, 0.9, 5)),
        "other bounds": lambda: optimise.optimal_exponent(0.4, (-0.5, 0.5)),
        "a design": first_design,
        "a design with other numbers": other_numbers,
        "sensitivities": lambda: optimise.sensitivities(found[0]),
        "under_other_load": lambda: optimise.under_other_load(found[1], 1.1),
        "along": lambda: optimise.along(found[0], "k", np.linspace(-0.5, 0.5, 50)),
        "limits that cannot be kept": lambda: optimise.conflict(
            optimise.design(CONTACT, FORCE, **HELD, limits={"edge_pressure": {"below": 1e6, "distance": 1e-6}})
        ),
        "a front": lambda: optimise.front(CONTACT, FORCE, **HELD, distance=1e-6, points=3),
        "a design for a life": lambda: optimise.design(CONTACT, 0.5, {"k": (-0.5, 0.5)}, **LIFE),
        "a design for another life": lambda: optimise.design(OTHER, 0.7, {"k": (-0.7, 0.3)}, **LIFE | {"cycles": 3e5}),
        "beside the reference": lambda: optimise.compared(found[0]),
        "another beside its reference": lambda: optimise.compared(found[1]),
    }


EXPECTED = {
    "an amplitude": ["_next_directions", "_wear"],
    "a front": ["_at_points"],  # until then it ran in steps, of which there are so many at most
    "a design for a life": ["_shares_at_nodes"],
}


def tell_compilations():
    """What each question compiles, in the order of their names; printed as JSON."""
    jax.config.update("jax_enable_x64", True)
    jax.config.update("jax_log_compiles", True)
    said = []
    handler = logging.Handler()
    handler.emit = lambda record: said.append(record.getMessage())
    logger = logging.getLogger("jax")
    logger.handlers, logger.propagate = [handler], False
    told = {}
    for name, ask in questions().items():
        said.clear()
        ask()
        told[name] = sorted(re.findall(r"Finished XLA compilation of (?:jit\()?(\w+)", "\n".join(said)))
    print(json.dumps(told))


@compiled
def test_what_was_compiled_for_one_question_serves_all_others_of_its_kind():
    code = "import test_compilations as t; t.tell_compilations()"
    told = json.loads(output("-W", "error", "-W", os.environ["PYTHONWARNINGS"], "-c", code))
    assert told.keys() == questions().keys()
    for name, programs in told.items():
        large = [program for program in programs if program not in TINY]
        assert large == EXPECTED.get(name, []), name
        if "amplitude" not in name and name != "other bounds":
            assert programs == large, name


@compiled
def test_a_second_gradient_over_cycles_compiles_nothing(caplog):
    moduli = np.array([110e9, 150e9, 200e9, 240e9, 210e9, 180e9, 205e9, 210e9])
    coating = DepthGraded(1e-6 * np.array([0.0, 1.0, 3.0, 10.0, 20.0, 50.0, 100.0, 200.0]), moduli, 0.3)
    slopes = jax.grad(lambda contact: contact.over_cycles(2.0, 1e-14).volume(1e5))
    slopes(contact_of(coating))
    with jax.log_compiles():
        slopes(FrettingContact(coating, 6e-3, 11.0, 0.5))
    assert "Finished XLA compilation" not in caplog.text


# --- how large they are -----------------------------------------------------------------------------------------------


def size_of(lowered):
    """Of the whole program, loops and branches included."""
    return size_in(lowered.compile().as_text())


@parametrize(
    "asked, most",
    [
        compiled_case(HELD, Size(26, 3900)),
        (HELD | {"limits": ALLOWED}, Size(38, 6000)),
        compiled_case({"vary": {"k": (-0.5, 0.5), "E0": (50e9, 200e9)}, **LIFE}, Size(90, 5600)),
    ],
    ids=["no limit", "pressure limited", "a life"],
)
def test_an_evaluation_grows_no_further(asked, most):
    evaluator = evaluation.Evaluator(question_of(CONTACT, 1.0, **asked))
    points = np.full((evaluator.lanes, len(asked["vary"])), 0.1)
    names = tuple(asked["vary"])
    found = size_of(evaluation._together.jitted.lower(names, evaluator.question, evaluator.shared, points))
    assert found.kernels <= most.kernels and found.instructions <= most.instructions, found


def test_what_is_asked_once_takes_few_steps(monkeypatch):
    monkeypatch.setattr(solving.scene_values, "known", {})
    scene.load(DESIGNS / "electrical_contact.toml").solve()
    (steps,) = solving.scene_values.known.values()
    assert len(steps._block.steps) <= 9500, len(steps._block.steps)


@compiled
def test_the_loop_of_a_batch_holds_the_objective_once():
    phi = jnp.full(optima.LENGTH, 0.3)
    found = size_of(exponent._many_optimal_exponents.part.lower(None, phi, phi - 1.25, phi + 0.65))
    assert found.kernels <= 245 and found.instructions <= 7200, found
