"""What the tests of designs share: a coated contact, others on its half-space, a punch, and a life."""

import dataclasses

import kinds
import numpy as np
from kinds import dome

from plgwear_jax import GrossSlipContact, PowerLawGraded

RIGID, STEEL = dome(), dome(0.0, kinds.STEEL)
PUNCH = GrossSlipContact(PowerLawGraded(1e9, 1e-3, 0.1, 0.3), radius=1e-3, depth=1e-6)
LIFE = {"cycles": 4e5, "law": kinds.COEFFICIENT}
HOLD = "contact_radius"


def on(contact, **fields):
    """The contact with other numbers, its own or those of its half-space."""
    below = {name: fields.pop(name) for name in [*fields] if hasattr(contact.material, name)}
    return dataclasses.replace(contact, material=dataclasses.replace(contact.material, **below), **fields)


def held(k):
    """Contacts with these exponents and the contact radius of `RIGID`."""
    ratio = on(RIGID, k=k).steady(0.0).contact_radius / RIGID.steady(0.0).contact_radius
    return on(RIGID, k=k, E0=110e9 * ratio ** (3.0 + k))


def is_least(found, worn, within, *, run=False):
    """The design is no worse than the best of a scan that keeps the limits, and hardly better; of runs to 6 digits."""
    assert found.converged and found.keeps_limits and (run or found.certified)
    least = np.nanmin(worn)
    assert least * (1.0 - within) < found.value < least * (1.0 + (1e-6 if run else 1e-9))


def over(amounts, weight, level):
    """The mean of the worst 1 - level along the first axis, by Rockafellar and Uryasev: the CVaR.

    The least over t of t + E[(X - t)+]/(1 - level), which is at one of the amounts.
    """
    if level == 1.0:
        return amounts.max(0)
    beyond = np.maximum(amounts - amounts[:, None], 0.0)  # by what, and which
    return np.min(amounts + np.tensordot(beyond, weight / weight.sum(), (1, 0)) / (1.0 - level), axis=0)
