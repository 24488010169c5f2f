"""Threads that ask different contacts at the same time have the answers of one thread.

What is remembered of the last question must not be that of another thread. Python changes threads as often as it can
meanwhile. The answers are the expected ones up to what rounding may change where XLA takes a program over from NumPy
meanwhile, as the page "Digits and speed" says; another contact would have an answer that differs by percents.
"""

import dataclasses
import functools
import itertools
import random
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from kinds import COEFFICIENT, KINDS
from marks import compiled, compiled_case, long, parametrize

from plgwear_jax import optimise
from plgwear_jax.loads import Displacement

THREADS = 8
FEWEST = 2  # digits: what is remembered is the same, and computed in less time


@functools.cache
def loaded(kind, number):
    """One of several contacts of a kind; what is remembered is that of the same object."""
    return dataclasses.replace(KINDS[kind], normal_force=8.0 + 0.25 * number)


F_X = 1.5


def volume(contact):
    return contact.steady(F_X, digits=FEWEST).wear_volume


def radius(contact):
    return contact.steady(F_X, digits=FEWEST).worn_radius


def unworn(contact):
    return contact.steady(0.0, digits=FEWEST).contact_radius


def over_cycles(contact):
    return contact.over_cycles(F_X, COEFFICIENT, digits=FEWEST).volume(1e4)


def held(contact):
    return contact.over_cycles(Displacement(2e-7, 3e7), COEFFICIENT, digits=FEWEST).volume(1e4)


def best(contact):
    found = optimise.design(contact, F_X, {"k": (-0.2, 0.2)})
    return np.array([found.value, found.reference_value])


STEADY = volume, radius, unworn
DESIGNED = "closed forms", "a power law under steel"


def questions(kinds, asked, contacts):
    """All that is asked of one contact, one after the other, for each contact: (its kind, what is asked, which one)."""
    return [tuple((kind, ask, number) for ask in asked) for kind in kinds for number in range(contacts)]


def answered(question):
    kind, ask, number = question
    return np.asarray(ask(loaded(kind, number)))


@pytest.fixture(autouse=True)
def _often():
    """Python changes threads as often as it can."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(before)


def wrong_answers(asked):
    """How many questions there were, and those with wrong answers or none."""
    expected = {question: answered(question) for question in itertools.chain(*asked)}
    asked = random.Random(1).sample(asked, len(asked))
    begin = threading.Barrier(THREADS)

    def ask(thread):
        begin.wait()
        told = []
        for question in itertools.chain(*asked[thread::THREADS]):
            try:
                rtol = 1e-13 if question[0] == "closed forms" else 1e-9
                told.append((question, np.allclose(answered(question), expected[question], rtol=rtol, atol=0.0)))
            except Exception:
                told.append((question, False))
        return told

    with ThreadPoolExecutor(THREADS) as pool:
        answers = list(itertools.chain(*pool.map(ask, range(THREADS))))
    return len(answers), [question for question, right in answers if not right]


@parametrize("asked, count", [(STEADY, 72), compiled_case((over_cycles,), 24)], ids=["steady", "over cycles"])
def test_threads_have_the_answers_of_one_thread(asked, count):
    assert wrong_answers(4 * questions(("closed forms", "layers under steel"), asked, 3)) == (count, [])


@compiled
def test_threads_have_the_designs_of_one_thread():
    asked = 4 * questions(DESIGNED, (best,), 4) + 4 * questions(DESIGNED, STEADY, 4)
    assert wrong_answers(asked)[1] == []


@long
def test_ten_thousand_questions_of_threads():
    asked = 60 * questions(KINDS, STEADY, 8) + 20 * questions(KINDS, (over_cycles,), 8)
    asked += 25 * questions(KINDS, (held,), 2) + 10 * questions(DESIGNED, (best,), 5)
    assert wrong_answers(asked) == (10_000, [])
