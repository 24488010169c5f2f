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


# Which fields a result depends on: only those can make it NaN.
UNWORN, LOADED = {*MATERIAL, *FRETTING} - {"friction"}, {"normal_force", "friction", "tangential_force"}
DEPENDS = {
    "amplitude": LOADED,
    "tangential_force": set(),
    **dict.fromkeys(("contact_radius", "peak_initial_pressure"), UNWORN),
    **dict.fromkeys(("initial_pressure", "initial_displacement"), UNWORN | {"r"}),
    **{key: {"k"} for key in ("gross_slip_energy_ratio", "gross_slip_aperture")},
    **dict.fromkeys(("energy_ratio", "loop_aperture"), LOADED | {"k"}),
    "gross_slip_displacement": {*MATERIAL, *FRETTING},
    "force_at": {*MATERIAL, *FRETTING, "displacement_amplitude"},
    "modulus_at": {"E0", "z0", "k", "z"},
}
OF_PUNCH = {
    **{key: {"k"} for key in ("force_ratio", "force_drop")},
    "volume_change": {"k", "radius", "depth"},
    "modulus_at": {"E0", "z0", "k", "z"},
    **{key: {"k", "radius", "depth", "r"} for key in ("initial_displacement", "steady_displacement")},
}


def depends(cls, name):
    if cls is GrossSlipContact:
        return OF_PUNCH.get(name, {*MATERIAL, *GROSS_SLIP, *quantities(cls)[name]})
    return DEPENDS.get(name, {*MATERIAL, *FRETTING, "tangential_force", *quantities(cls)[name]})
