"""All that can be asked or given: quantities of a contact, axes of sweeps and variables of designs.

The one place for their names, symbols, units, equations and meanings; scenes, sweeps, tables and pictures read it.
Imports nothing that takes time: the command line reads its options from here.
"""

from collections.abc import Mapping
from typing import Any, Literal, NamedTuple

from plgwear_jax._core.ranges import (
    AMPLITUDE,
    AMPLITUDE_OF_FORCE,
    EXPONENT,
    NUMBER,
    POISSON_RATIO,
    POSITIVE,
    RADIUS,
    Domain,
)

__all__ = [
    "AXES",
    "DESIGNED",
    "FRETTING",
    "GROSS_SLIP",
    "MATERIAL",
    "QUANTITIES",
    "TANGENTIAL",
    "TRANSIENT",
    "Argument",
    "AxisKind",
    "Entry",
    "Kind",
    "Law",
    "derivative",
    "entry",
    "kind_of",
    "read",
]

Kind = Literal["fretting", "gross-slip"]

Argument = Literal["r", "distance", "F_x", "cycles", "wear_coefficient"]


class Law(NamedTuple):
    """A quantity: how it is called and what it returns.

    Attributes:
        words: What it is called in tables, with a remark behind a comma.
        symbol: Its symbol as a formula of TeX; empty if it has none.
        arguments: Those of the method of the contact; the dimensionless function takes k besides, and phi for F_x.
        unit: The SI unit of the method; None if no contact has it.
        scale: The unit of the dimensionless function; None if there is none.
        equation: Its number in the paper.
        description: What it is, in words.
        unbounded_at: The place where it is infinite, so that its largest value has no meaning.
    """

    words: str
    symbol: str
    arguments: tuple[Argument, ...]
    unit: str | None
    scale: str | None
    equation: str
    description: str
    unbounded_at: str | None = None


_HEIGHT, _STRESS = "a_0^2/R", "F_N/(pi a_0^2)"

FRETTING = {
    "contact_radius": Law("contact radius", "a_0", (), "m", None, "12", "contact radius a_0 before any wear"),
    "peak_initial_pressure": Law(
        "peak initial pressure",
        "p_0(0)",
        (),
        "Pa",
        None,
        "13",
        "largest contact pressure before any wear, in the middle",
    ),
    "stick_radius": Law(
        "stick radius, inner edge of the ring",
        "c",
        ("F_x",),
        "m",
        "a_0",
        "16, 23",
        "stick radius c, the inner edge of the worn ring",
    ),
    "worn_radius": Law(
        "worn radius, outer edge of the ring",
        r"a_\infty",
        ("F_x",),
        "m",
        "a_0",
        "26",
        "outer radius a_inf of the worn ring",
    ),
    "penetration": Law(
        "penetration", r"d_\infty", ("F_x",), "m", _HEIGHT, "11, 25", "penetration d_inf of the worn indenter"
    ),
    "wear_volume": Law(
        "wear volume", r"\Delta V", ("F_x",), "m^3", "a_0^4/R", "28", "volume worn off until the steady state"
    ),
    "deepest_wear": Law("deepest wear", "", ("F_x",), "m", _HEIGHT, "24, 25", "deepest wear of the worn profile"),
    "edge_intensity": Law(
        "edge intensity",
        "",
        ("F_x",),
        "Pa",
        _STRESS,
        "20, 21",
        "strength of the pressure singularity at the stick edge",
    ),
    "edge_pressure": Law(
        "edge pressure",
        r"p_\infty",
        ("distance", "F_x"),
        "Pa",
        _STRESS,
        "17",
        "pressure p_inf at a distance inside the stick edge",
        "the stick edge",
    ),
    "profile": Law(
        "profile", r"f_\infty", ("r", "F_x"), "m", _HEIGHT, "25", "shape f_inf of the worn indenter above its apex"
    ),
    "wear_depth": Law(
        "wear depth", r"f_\infty-f_0", ("r", "F_x"), "m", _HEIGHT, "24, 25", "depth f_inf - f_0 worn off the indenter"
    ),
    "initial_displacement": Law(
        "initial displacement",
        "w_0",
        ("r",),
        "m",
        _HEIGHT,
        "14",
        "normal displacement w_0 of the surface before any wear",
    ),
    "steady_displacement": Law(
        "steady displacement",
        r"w_\infty",
        ("r", "F_x"),
        "m",
        _HEIGHT,
        "24",
        "normal displacement w_inf of the surface in the worn state",
    ),
    "initial_pressure": Law(
        "initial pressure", "p_0", ("r",), "Pa", _STRESS, "13", "contact pressure p_0 before any wear"
    ),
    "steady_pressure": Law(
        "steady pressure",
        r"p_\infty",
        ("r", "F_x"),
        "Pa",
        _STRESS,
        "17",
        "contact pressure p_inf in the worn state",
        "the stick edge",
    ),
    "steady_traction": Law(
        "steady traction",
        r"\tau_\infty",
        ("r", "F_x"),
        "Pa",
        "mu F_N/(pi a_0^2)",
        "19",
        "tangential traction tau_inf in the worn state",
        "the stick edge",
    ),
}

# of the unworn contact, from its tangential compliance
TANGENTIAL = {
    "displacement_amplitude": Law(
        "displacement amplitude", "u_x", ("F_x",), "m", None, "", "amplitude of the tangential displacement"
    ),
    "gross_slip_displacement": Law(
        "displacement at gross slip", "", (), "m", None, "", "displacement amplitude at which the whole contact slips"
    ),
    "slip_amplitude": Law("slip amplitude", "s", ("r", "F_x"), "m", None, "", "amplitude of the slip in the ring"),
    "energy_per_cycle": Law("energy per cycle", "", ("F_x",), "J", None, "", "energy that friction takes in a cycle"),
}

_MEAN_PRESSURE = "F_N0/(pi a^2)"

GROSS_SLIP = {
    "initial_force": Law("initial force", "F_{N0}", (), "N", None, "8", "normal force before any wear"),
    "steady_force": Law(
        "steady force", r"F_{N\infty}", (), "N", None, "9", "normal force on the worn punch at the same depth"
    ),
    "force_ratio": Law("force ratio", r"F_{N\infty}/F_{N0}", (), "1", "1", "10", "steady over initial normal force"),
    "force_drop": Law(
        "normal force lost, as a share",
        r"1-F_{N\infty}/F_{N0}",
        (),
        "1",
        "1",
        "10",
        "share of the normal force lost at the same depth",
    ),
    "volume_change": Law(
        "effective volume worn off", r"\Delta V", (), "m^3", "pi a^2 d", "7", "effective volume worn off the punch"
    ),
    "initial_displacement": Law(
        "initial displacement", "w_0", ("r",), "m", "d", "3", "normal displacement w_0 of the surface before any wear"
    ),
    "steady_displacement": Law(
        "steady displacement",
        r"w_\infty",
        ("r",),
        "m",
        "d",
        "5",
        "normal displacement w_inf of the surface, the shape of the worn punch",
    ),
    "initial_pressure": Law(
        "initial pressure",
        "p_0",
        ("r",),
        "Pa",
        _MEAN_PRESSURE,
        "2",
        "contact pressure p_0 before any wear",
        "the edge of the punch",
    ),
    "steady_pressure": Law(
        "steady pressure",
        r"p_\infty",
        ("r",),
        "Pa",
        _MEAN_PRESSURE,
        "10",
        "uniform contact pressure in the worn state",
    ),
}

# all that can be asked of a contact of each kind
QUANTITIES: dict[Kind, dict[str, Law]] = {"fretting": FRETTING | TANGENTIAL, "gross-slip": GROSS_SLIP}


def kind_of(contact: Any) -> Kind:
    """The kind of a contact."""
    return "fretting" if hasattr(contact, "normal_force") else "gross-slip"


def read(contact: Any, name: str, tangential_force: Any, places: Mapping[str, Any], **options: Any) -> Any:
    """A quantity of a contact.

    Args:
        contact: A `FrettingContact` or a `GrossSlipContact`.
        name: The name of the quantity.
        tangential_force: The force amplitude in N, if the quantity depends on it.
        places: The place in m if it has one: "r" or "distance".
        options: Keywords of the method, such as `digits`.

    Returns:
        The quantity in SI units.
    """
    given = {"F_x": tangential_force, **places}
    arguments = QUANTITIES[kind_of(contact)][name].arguments
    return getattr(contact, name)(*(given[argument] for argument in arguments), **options)


MATERIAL = {
    "h_N": Law("factor", "h_N", (), None, "1", "29-31", "factor h_N of the normal compliance"),
    "holl_ratio": Law(
        "Holl's ratio",
        r"\nu",
        (),
        None,
        "1",
        "1/(2+k)",
        "Holl's ratio, at which normal and tangential contact uncouple",
    ),
}


_OVER = ("cycles", "wear_coefficient")

# of sweeps; the dimensionless functions take n in place of cycles and wear_coefficient
TRANSIENT = {
    "wear_volume": Law(
        "volume worn by then", r"\Delta V", ("F_x", *_OVER), "m^3", "a_0^4/R", "", "volume worn after the cycles"
    ),
    "wear_rate": Law("wear rate", r"dV/dn", ("F_x", *_OVER), None, "a_0^4/R", "", "volume worn in a reduced cycle"),
    "contact_radius": Law(
        "contact radius by then", "a", ("F_x", *_OVER), None, "a_0", "", "radius of the contact after the cycles"
    ),
    "profile": Law(
        "profile by then", "f", ("r", "F_x", *_OVER), "m", _HEIGHT, "", "shape of the indenter after the cycles"
    ),
    "wear_depth": Law(
        "wear depth by then", "h", ("r", "F_x", *_OVER), "m", _HEIGHT, "", "depth worn off after the cycles"
    ),
    "pressure": Law("pressure by then", "p", ("r", "F_x", *_OVER), "Pa", _STRESS, "", "pressure after the cycles"),
}


class AxisKind(NamedTuple):
    """The values of an axis, or of a variable of designs.

    Attributes:
        words: What it is called.
        symbol: Its symbol as a formula of TeX.
        unit: Their SI unit.
        domain: Which values are allowed.
        description: What they are, in words.
        scale: Their unit in a sweep without a contact, if it is not the SI unit.
        interval: The open interval whose ends logit spacing approaches; None if logit spacing is not possible.
    """

    words: str
    symbol: str
    unit: str
    domain: Domain
    description: str
    scale: str | None = None
    interval: tuple[float, float] | None = None


AXES = {
    "k": AxisKind("exponent", "k", "1", EXPONENT, "exponent k of the modulus", interval=(-1.0, 1.0)),
    "phi": AxisKind(
        "amplitude", r"\varphi", "1", AMPLITUDE, "amplitude F_x/(mu F_N) of the tangential force", interval=(0.0, 1.0)
    ),
    "nu": AxisKind("Poisson's ratio", r"\nu", "1", POISSON_RATIO, "Poisson's ratio"),
    "r": AxisKind("radius", "r", "m", RADIUS, "distance from the axis of the contact", scale="a_0"),
    "distance": AxisKind(
        "distance inside the stick edge", "s", "m", RADIUS, "distance inside the stick edge", scale="a_0"
    ),
    "E0": AxisKind("modulus", "E_0", "Pa", POSITIVE, "modulus E0 at the depth z0"),
    "z0": AxisKind("characteristic depth", "z_0", "m", POSITIVE, "characteristic depth z0"),
    "radius": AxisKind("radius of the indenter", "R", "m", POSITIVE, "radius of the indenter"),
    "normal_force": AxisKind("normal force", "F_N", "N", POSITIVE, "normal force F_N"),
    "friction": AxisKind("coefficient of friction", r"\mu", "1", POSITIVE, "coefficient of friction mu"),
    "indenter_E": AxisKind("modulus of the indenter", "E_i", "Pa", POSITIVE, "Young's modulus of an elastic indenter"),
    "depth": AxisKind("indentation depth", "d", "m", POSITIVE, "indentation depth d"),
    "tangential_force": AxisKind(
        "tangential force", "F_x", "N", AMPLITUDE_OF_FORCE, "amplitude F_x of the tangential force"
    ),
    "n": AxisKind("reduced cycles", "n", "1", NUMBER, "reduced cycles n = 4 K mu theta F_N N/(pi a_0^2)"),
    "cycles": AxisKind("cycles", "N", "1", NUMBER, "number of cycles N"),
    "wear_coefficient": AxisKind("wear coefficient", "K", "1/Pa", POSITIVE, "Archard's wear coefficient K"),
}


class Entry(NamedTuple):
    """How something is written.

    Attributes:
        words: What it is called in tables, with a remark behind a comma.
        symbol: Its symbol as a formula of TeX; empty if it has none.
        unit: Its SI unit.
    """

    words: str
    symbol: str
    unit: str

    @property
    def name(self) -> str:
        """What it is called."""
        return self.words.partition(",")[0]

    @property
    def label(self) -> str:
        """What it is called, with its symbol, for pictures."""
        return f"{self.name} ${self.symbol}$" if self.symbol else self.name


# what belongs to designs alone
_OF_DESIGNS = {
    "k": Entry("exponent k", "k", "1"),
    "E0": Entry(AXES["E0"].description, "E_0", "Pa"),
    "z0": Entry(AXES["z0"].description, "z_0", "m"),
    "modulus_at_radius": Entry("modulus at z = contact radius", "E(a_0)", "Pa"),
    "shallow_modulus": Entry("modulus at the first depth", "E(z_1)", "Pa"),
    "deep_modulus": Entry("modulus at the second depth", "E(z_2)", "Pa"),
    "edge_exponent": Entry("stress at the edge, exponent", "", "1"),
}


def entry(name: str) -> Entry:
    """How a quantity of a contact or of a design, or a variable of designs such as "indenter.E", is written."""
    if name in _OF_DESIGNS:
        return _OF_DESIGNS[name]
    law = (FRETTING | TANGENTIAL | GROSS_SLIP).get(name)
    if law is not None:
        return Entry(law.words, law.symbol, law.unit or "1")
    axis = AXES.get(name.replace(".", "_"))
    if axis is not None:
        return Entry(axis.description, axis.symbol, axis.unit)
    leaf = name.rpartition(".")[2].partition("[")[0]
    return Entry(name, "", {"modulus": "Pa", "depth": "m"}.get(leaf, "1"))


# what a design is described by, in the order in which it is printed
DESIGNED = (
    "k",
    "E0",
    "z0",
    "modulus_at_radius",
    "shallow_modulus",
    "deep_modulus",
    "wear_volume",
    "deepest_wear",
    "volume_change",
    "force_drop",
    "contact_radius",
    "stick_radius",
    "worn_radius",
    "edge_exponent",
    "edge_pressure",
    "penetration",
)


def derivative(name: str) -> tuple[str, list[str]]:
    """The quantity that a name differentiates, and by what: of `wear_volume.dk.dphi` `wear_volume`, k and phi."""
    stem, slopes = name.split("."), []
    while len(stem) > 1 and stem[-1][:1] == "d" and stem[-1][1:] in AXES:
        slopes.insert(0, stem.pop()[1:])
    return ".".join(stem), slopes
