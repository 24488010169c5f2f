"""What the tests of designs share: a coated contact, others on its half-space, and a life."""

import dataclasses

import numpy as np

from plgwear_jax import Elastic, FrettingContact, PowerLawGraded

COATING = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=0.3)
RIGID = FrettingContact(COATING, radius=5e-3, normal_force=10.0, friction=0.4)
STEEL = dataclasses.replace(RIGID, indenter=Elastic(210e9, 0.3))
COEFFICIENT = 1e-14
LIFE = {"cycles": 4e5, "law": COEFFICIENT}
HOLD = "contact_radius"


def on(contact, **fields):
    """The contact on another half-space."""
    return dataclasses.replace(contact, material=dataclasses.replace(contact.material, **fields))


def held(k):
    """Contacts with these exponents and the contact radius of `RIGID`."""
    ratio = np.asarray(on(RIGID, k=k).steady(0.0).contact_radius) / float(RIGID.steady(0.0).contact_radius)
    return on(RIGID, k=k, E0=110e9 * ratio ** (3.0 + k))


def is_least(found, worn, within, *, run=False):
    """The design is no worse than the best of a scan that keeps the limits, and hardly better; of runs to 6 digits."""
    assert found.converged and found.keeps_limits and (run or found.certified)
    least = float(np.nanmin(worn))
    assert least * (1.0 - within) < float(found.value) < least * (1.0 + (1e-6 if run else 1e-9))
