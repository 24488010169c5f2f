"""A batch of contacts as a user differentiates and compiles it: `python batches.py KIND QUESTION DIGITS COUNT ROUNDS`.

In a process of its own, since what went wrong here once was a program that never returned. It prints a line of JSON: GB
of memory of the program, and how far the derivatives by the force are from differences, relative to the largest.
"""

import json
import sys

import jax
import jax.numpy as jnp
import numpy as np
from kinds import COEFFICIENT, KINDS

from plgwear_jax.loads import Displacement, Force

F_X = 1.5


def steady(contact, force, digits):
    state = contact.steady(force, digits=digits)
    told = state.wear_volume, state.worn_radius, state.edge_pressure(1e-6), state.penetration, state.deepest_wear
    return sum(map(jnp.log, told))


def unworn(contact, force, digits):
    state = contact.steady(Force(force, 3e7), digits=digits)
    moved = state.displacement_amplitude
    again = contact.steady(Displacement(0.9 * moved, 3e7), digits=digits).tangential_force
    return jnp.log(again) + jnp.log(state.energy_per_cycle) + jnp.log(moved)


def over_cycles(contact, force, digits):
    return jnp.log(contact.over_cycles(force, COEFFICIENT, digits=digits).volume(1e4))


def fields(contact, force, digits):
    run, state = contact.over_cycles(force, COEFFICIENT, digits=digits), contact.steady(force, digits=digits)
    beside = 0.5 * (state.stick_radius + state.contact_radius)
    told = run.pressure(0.9 * state.stick_radius, 1e4), run.cycles_to(0.5), run.depth(beside, 1e4)
    return sum(map(jnp.log, told))


def held(contact, force, digits):
    moved = contact.steady(Force(force, 3e7), digits=digits).displacement_amplitude
    return jnp.log(contact.over_cycles(Displacement(moved, 3e7), COEFFICIENT, digits=digits).volume(1e4))


QUESTIONS = {ask.__name__: ask for ask in (steady, unworn, over_cycles, fields, held)}


def scattered(kind, count):
    """So many contacts of a kind, each number of which is scattered by 5 %, with their forces."""
    random = np.random.default_rng(7)

    def scatter(path, x):
        # One factor for all depths of a contact, whose order must stay.
        own = () if "depth" in jax.tree_util.keystr(path) else np.shape(x)
        factor = 1.0 + 0.05 * random.uniform(-1.0, 1.0, (count, *own))
        return np.asarray(x) * factor.reshape(count, *own, *(1,) * (np.ndim(x) - len(own)))

    return jax.tree_util.tree_map_with_path(scatter, KINDS[kind]), F_X * (1.0 + 0.05 * random.uniform(-1, 1, count))


def program(question, digits):
    """Values and derivatives by all numbers of the contact and by the force."""
    ask = QUESTIONS[question]
    return jax.jit(jax.vmap(jax.value_and_grad(lambda contact, force: ask(contact, force, digits), (0, 1))))


def main():
    kind, question, digits, count, rounds = sys.argv[1], sys.argv[2], *map(int, sys.argv[3:])
    jax.config.update("jax_enable_x64", True)
    contacts, forces = scattered(kind, count)
    ask = program(question, digits).lower(contacts, forces).compile()
    used = ask.memory_analysis()
    for _ in range(rounds):
        values, (slopes, by_force) = jax.block_until_ready(ask(contacts, forces))
    assert all(np.all(np.isfinite(x)) for x in jax.tree.leaves((values, slopes, by_force)))
    above, below = (ask(contacts, forces * (1.0 + step))[0] for step in (1e-5, -1e-5))
    away = np.max(abs((above - below) / (2e-5 * forces) - by_force)) / np.max(abs(by_force))
    memory = used.temp_size_in_bytes + used.argument_size_in_bytes + used.output_size_in_bytes
    print(json.dumps({"program in GB": memory / 1e9, "away": float(away)}))


if __name__ == "__main__":
    main()
