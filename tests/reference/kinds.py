"""Contacts of every kind: what one test asks of both engines, of all bodies and shapes, it asks of these."""

from plgwear_jax import DepthGraded, Elastic, FrettingContact, Layered, PowerLawGraded, PowerShape, WearLaw

FORCE, FRICTION, RADIUS = 10.0, 0.4, 5e-3
LIMIT = FRICTION * FORCE  # N, at which all of the contact slips
COEFFICIENT = 1e-14
STEEL = Elastic(210e9, 0.3)
LAW = PowerLawGraded(110e9, 1e-4, 0.2, 0.3)
LAYERS = Layered([2e-5, 3e-5], [50e9, 300e9, 100e9], 0.3)
TABLE = DepthGraded([1e-5, 3e-5, 8e-5, 2e-4], [90e9, 150e9, 120e9, 210e9], 0.3)


def contact_of(body, indenter=None, shape=None, force=FORCE):
    return FrettingContact(body, RADIUS, force, FRICTION, indenter, shape)


def dome(k=0.0, indenter=None, shape=None):
    """On a power law."""
    return contact_of(PowerLawGraded(110e9, 1e-4, k, 0.3), indenter, shape)


KINDS = {
    "closed forms": contact_of(LAW),
    "a power law under steel": contact_of(LAW, STEEL),
    "layers under steel": contact_of(LAYERS, STEEL),
    "a table": contact_of(TABLE),
    "a table under steel": contact_of(TABLE, STEEL),
    "a shape": contact_of(LAYERS, STEEL, PowerShape(4.0)),
}


class Linear(WearLaw):
    """Archard's law, which only the march does not know."""

    linear = True
    coefficient: float

    def rate(self, pressure, slip):
        return self.coefficient * pressure * slip
