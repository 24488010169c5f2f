"""Contacts in closed form with their numbers, and which of them each quantity depends on."""

import inspect

from refusals import data

from plgwear_jax import FrettingContact, GrossSlipContact, PowerLawGraded
from plgwear_jax.contact.gross_slip_contact import SteadyPunch
from plgwear_jax.steady.closed import Steady

MATERIAL, FRETTING, GROSS_SLIP, PLACES, GOOD = data("reference/middle.toml").values()


def build(cls, **changed):
    graded, *fields = (
        known | {name: x for name, x in changed.items() if name in known}
        for known in (MATERIAL, *{FrettingContact: [FRETTING], GrossSlipContact: [GROSS_SLIP]}.get(cls, ()))
    )
    graded = PowerLawGraded(**graded)
    return cls(graded, **fields[0]) if fields else graded


def quantities(cls):
    """What the steady state of a contact answers, and the names of the arguments that it takes."""
    found = {}
    for name, one in inspect.getmembers(Steady if cls is FrettingContact else SteadyPunch):
        if name[0] != "_" and isinstance(one, property):
            found[name] = []
        elif name[0] != "_" and inspect.isfunction(one):
            parameters = inspect.signature(one).parameters.items()
            found[name] = [key for key, one in parameters if key != "self" and one.kind != one.KEYWORD_ONLY]
    return found


DEPENDS = data("reference/dependence.toml")


def depends(cls, name):
    kind, own = ("punch", GROSS_SLIP) if cls is GrossSlipContact else ("contact", {*FRETTING, "tangential_force"})
    return {*DEPENDS[kind].get(name, (*MATERIAL, *own, *quantities(cls)[name]))}
