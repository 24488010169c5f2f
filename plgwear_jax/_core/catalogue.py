"""All quantities of a contact, with their arguments, units, meanings and equations, and the axes of sweeps.

Imports nothing that takes time: the command line reads its options from here.
"""

from typing import Literal, NamedTuple

__all__ = ["AXES", "FRETTING", "GROSS_SLIP", "MATERIAL", "Argument", "AxisKind", "Law"]

Argument = Literal["r", "distance", "F_x"]


class Law(NamedTuple):
    """A quantity: how it is called and what it returns.

    Attributes:
        arguments: Those of the method of the contact; the dimensionless function takes k besides, and phi for F_x.
        unit: The SI unit of the method; None if no contact has it.
        scale: The unit of the dimensionless function; None if there is none.
        equation: Its number in the paper.
        description: What it is, in words.
        unbounded_at: The place where it is infinite, so that its largest value has no meaning.
    """

    arguments: tuple[Argument, ...]
    unit: str | None
    scale: str | None
    equation: str
    description: str
    unbounded_at: str | None = None


_HEIGHT, _STRESS = "a_0^2/R", "F_N/(pi a_0^2)"

FRETTING = {
    "contact_radius": Law((), "m", None, "12", "contact radius a_0 before any wear"),
    "stick_radius": Law(("F_x",), "m", "a_0", "16, 23", "stick radius c, the inner edge of the worn ring"),
    "worn_radius": Law(("F_x",), "m", "a_0", "26", "outer radius a_inf of the worn ring"),
    "penetration": Law(("F_x",), "m", _HEIGHT, "11, 25", "penetration d_inf of the worn indenter"),
    "wear_volume": Law(("F_x",), "m^3", "a_0^4/R", "28", "volume worn off until the steady state"),
    "deepest_wear": Law(("F_x",), "m", _HEIGHT, "24, 25", "deepest wear of the worn profile"),
    "edge_intensity": Law(("F_x",), "Pa", _STRESS, "20, 21", "strength of the pressure singularity at the stick edge"),
    "edge_pressure": Law(
        ("distance", "F_x"), "Pa", _STRESS, "17", "pressure p_inf at a distance inside the stick edge", "the stick edge"
    ),
    "profile": Law(("r", "F_x"), "m", _HEIGHT, "25", "shape f_inf of the worn indenter above its apex"),
    "wear_depth": Law(("r", "F_x"), "m", _HEIGHT, "24, 25", "depth f_inf - f_0 worn off the indenter"),
    "initial_displacement": Law(("r",), "m", _HEIGHT, "14", "normal displacement w_0 of the surface before any wear"),
    "steady_displacement": Law(
        ("r", "F_x"), "m", _HEIGHT, "24", "normal displacement w_inf of the surface in the worn state"
    ),
    "initial_pressure": Law(("r",), "Pa", _STRESS, "13", "contact pressure p_0 before any wear"),
    "steady_pressure": Law(
        ("r", "F_x"), "Pa", _STRESS, "17", "contact pressure p_inf in the worn state", "the stick edge"
    ),
    "steady_traction": Law(
        ("r", "F_x"),
        "Pa",
        "mu F_N/(pi a_0^2)",
        "19",
        "tangential traction tau_inf in the worn state",
        "the stick edge",
    ),
}

_MEAN_PRESSURE = "F_N0/(pi a^2)"

GROSS_SLIP = {
    "initial_force": Law((), "N", None, "8", "normal force before any wear"),
    "steady_force": Law((), "N", None, "9", "normal force on the worn punch at the same depth"),
    "force_ratio": Law((), "1", "1", "10", "steady over initial normal force"),
    "force_drop": Law((), "1", "1", "10", "share of the normal force lost at the same depth"),
    "volume_change": Law((), "m^3", "pi a^2 d", "7", "effective volume worn off the punch"),
    "initial_displacement": Law(("r",), "m", "d", "3", "normal displacement w_0 of the surface before any wear"),
    "steady_displacement": Law(
        ("r",), "m", "d", "5", "normal displacement w_inf of the surface, the shape of the worn punch"
    ),
    "initial_pressure": Law(
        ("r",), "Pa", _MEAN_PRESSURE, "2", "contact pressure p_0 before any wear", "the edge of the punch"
    ),
    "steady_pressure": Law(("r",), "Pa", _MEAN_PRESSURE, "10", "uniform contact pressure in the worn state"),
}

MATERIAL = {
    "h_N": Law((), None, "1", "29-31", "factor h_N of the normal compliance"),
    "holl_ratio": Law((), None, "1", "1/(2+k)", "Holl's ratio, at which normal and tangential contact uncouple"),
}


class AxisKind(NamedTuple):
    """The values of an axis.

    Attributes:
        unit: Their SI unit.
        description: What they are, in words.
        scale: Their unit in a sweep without a contact, if it is not the SI unit.
        interval: The open interval whose ends logit spacing approaches; None if logit spacing is not possible.
    """

    unit: str
    description: str
    scale: str | None = None
    interval: tuple[float, float] | None = None


AXES = {
    "k": AxisKind("1", "exponent k of the modulus", interval=(-1.0, 1.0)),
    "phi": AxisKind("1", "amplitude F_x/(mu F_N) of the tangential force", interval=(0.0, 1.0)),
    "nu": AxisKind("1", "Poisson's ratio"),
    "r": AxisKind("m", "distance from the axis of the contact", scale="a_0"),
    "distance": AxisKind("m", "distance inside the stick edge", scale="a_0"),
    "E0": AxisKind("Pa", "modulus E0 at the depth z0"),
    "z0": AxisKind("m", "characteristic depth z0"),
    "radius": AxisKind("m", "radius of the indenter"),
    "normal_force": AxisKind("N", "normal force F_N"),
    "friction": AxisKind("1", "coefficient of friction mu"),
    "depth": AxisKind("m", "indentation depth d"),
    "tangential_force": AxisKind("N", "amplitude F_x of the tangential force"),
}
