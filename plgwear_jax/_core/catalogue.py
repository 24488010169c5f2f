"""All that can be asked or given: quantities of a contact, leaves of it, arguments, and variables of designs.

The one place for their names, symbols, units, equations and meanings; scenes, sweeps, designs, tables and pictures read
it. Imports nothing that takes time: the command line reads its options from here.
"""

import dataclasses
import re
from collections.abc import Mapping
from typing import Any, Literal

from . import ranges
from .units import text_cells, written


@dataclasses.dataclass(frozen=True)
class Entry:
    """How something is written.

    Attributes:
        words: What it is called in tables, with a remark behind a comma.
        symbol: Its symbol as a formula of TeX; empty if it has none.
        unit: Its SI unit; "1" for a plain number.
        description: What it is, in words.
        scale: Its unit without a contact, in the paper's terms; None if it is the SI unit, or there is no such thing.
    """

    words: str
    symbol: str
    unit: str
    description: str = ""
    scale: str | None = None

    @property
    def name(self) -> str:
        """What it is called."""
        return self.words.partition(",")[0]

    @property
    def label(self) -> str:
        """What it is called, with its symbol, for pictures."""
        return f"{self.name} ${self.symbol}$" if self.symbol else self.name


# --- quantities -----------------------------------------------------------------------------------------------------

Kind = Literal["fretting", "gross-slip"]


@dataclasses.dataclass(frozen=True)
class Law(Entry):
    """A quantity: how it is written, and what it takes.

    A contact answers by what is called so in its `Steady` or its `Run`, see `read`. Its `scale` is the unit of the
    dimensionless function of its name; None if there is none.

    Attributes:
        equation: Its number in the paper; empty if it is not in it.
        arguments: Those of the method of the contact; the dimensionless function takes k besides, and phi for F_x.
        unbounded_at: The place where it is infinite, so that its largest value has no meaning.
    """

    equation: str = ""
    arguments: tuple[str, ...] = ()
    unbounded_at: str | None = None


_UNITS = {  # of the contact, and of the dimensionless function
    kind: (unit, scale)
    for kind, unit, scale in text_cells("""
    radius        m    a_0
    height        m    a_0^2/R
    volume        m^3  a_0^4/R
    stress        Pa   F_N/(pi a_0^2)
    traction      Pa   mu F_N/(pi a_0^2)
    slip          m    mu theta a_0^2/R
    displacement  m    mu theta a_0^2/((1+k) R)
    energy        J    mu^2 theta F_N a_0^2/R
    number        1    1
    depth         m    d
    punched       m^3  pi a^2 d
    pressed       Pa   F_N0/(pi a^2)
    """)
}
_CALLED = dict(  # if not by their names
    text_cells("""
    wear_rate      wear rate
    stick_radius   stick radius, inner edge of the ring
    worn_radius    worn radius, outer edge of the ring
    modulus_at     modulus
    penetration    indentation depth
    deepest_wear   wear depth, largest
    edge_intensity       generalised stress intensity factor
    loop_aperture        sliding ratio
    gross_slip_aperture  sliding ratio at the transition to gross slip
    force_drop     normal force lost, as a share
    volume_change  effective volume worn off
    h_N            factor
    holl_ratio     Holl's ratio
    peak_mises     peak von Mises stress
    mises          von Mises stress
    peak_mises_between  peak von Mises stress
    cycles_to      cycles to a share of the wear
    """)
)


def _laws_in(text: str, *, unbounded_at: str | None = None, when: str = "") -> dict[str, Law]:
    """Laws by name, from a line for each.

    The columns are the name, with * if the quantity is unbounded; its symbol; the kind of its units, or the SI unit if
    there is no dimensionless function; equations; arguments; and what it is.
    """
    found = {}
    for name, symbol, kind, equation, taken, description in text_cells(text):
        place = unbounded_at if name.endswith("*") else None
        name = name.rstrip("*")
        unit, scale = _UNITS.get(kind, (kind, None))
        words = _CALLED.get(name, name.replace("_", " ") + when)
        found[name] = Law(words, symbol, unit, description, scale, equation, tuple(taken.split()), place)
    return found


# before any wear, in a cycle under partial slip
TANGENTIAL = _laws_in(r"""
    slip_amplitude           \delta  slip          -  r F_x  amplitude of the slip in the ring before any wear
    displacement_amplitude   u_x     displacement  -  F_x    amplitude of the tangential displacement before any wear
    gross_slip_displacement  u_g     m             -  -      displacement amplitude at which gross slip begins
    energy_per_cycle         W       energy        -  F_x    energy that friction takes in a cycle before any wear
    energy_ratio             A       number        -  F_x    energy of a cycle over 4 F_x u_x, before any wear
    loop_aperture            D       number        -  F_x    displacement at no force over u_x, before any wear
    gross_slip_energy_ratio  A_g     1             -  -      energy ratio at which gross slip begins
    gross_slip_aperture      D_g     1             -  -      sliding ratio at which gross slip begins
""")

FRETTING = (
    _laws_in(
        r"""
    contact_radius         a_0           m         12  -  contact radius a_0 before any wear
    peak_initial_pressure  p_0(0)        Pa        13  -  largest pressure before any wear, in the middle
    peak_tension           \sigma_1     Pa        -  F_x  largest principal stress anywhere before any wear
    peak_mises             \sigma_M     Pa        -  F_x  von Mises' stress before any wear where it is largest
    peak_mises_between     \sigma_M     Pa        -  least most F_x  its largest value between two depths
    tension                \sigma_1     Pa        -  x z F_x  largest principal stress before any wear at a place
    mises                  \sigma_M     Pa        -  x z F_x  von Mises' stress before any wear at a place
    stick_radius           c             radius    16, 23  F_x  stick radius c, inner edge of the worn ring
    worn_radius            a_\infty      radius    26  F_x  outer radius a_inf of the worn ring
    penetration            d_\infty      height    11, 25  F_x  indentation depth d_inf of the worn indenter
    wear_volume            \Delta V      volume    28  F_x  volume worn off until the steady state
    deepest_wear           -             height    24, 25  F_x  largest wear depth
    edge_intensity         -             stress    20, 21  F_x  factor of the singularity at the stick-slip boundary
    edge_pressure*       p_\infty  stress  17  distance F_x  pressure p_inf at a distance inside the stick-slip boundary
    profile                f_\infty      height    25  r F_x  shape f_inf of the worn indenter above its apex
    wear_depth             f_\infty-f_0  height    24, 25  r F_x  depth f_inf - f_0 worn off the indenter
    initial_displacement   w_0           height    14  r  normal displacement w_0 before any wear
    steady_displacement    w_\infty      height    24  r F_x  normal displacement w_inf in the worn state
    initial_pressure       p_0           stress    13  r  contact pressure p_0 before any wear
    pressure*              p_\infty      stress    17  r F_x  contact pressure p_inf in the worn state
    traction*              \tau_\infty   traction  19  r F_x  tangential traction tau_inf in the worn state
    modulus_at             E             Pa        1  z  Young's modulus of the half-space at a depth
    """,
        unbounded_at="the stick-slip boundary",
    )
    | TANGENTIAL
)

PEAKS = {"peak_tension", "peak_mises"}  # whose places are known
SEARCHED = PEAKS | {"peak_mises_between"}  # on grids that narrow
STRESSES = SEARCHED | {"tension", "mises"}  # which take longer than all others

GROSS_SLIP = _laws_in(
    r"""
    initial_force         F_{N0}                N        8   -  normal force before any wear
    steady_force          F_{N\infty}           N        9   -  normal force on the worn punch at the same depth
    force_ratio           F_{N\infty}/F_{N0}    number   10  -  steady over initial normal force
    force_drop            1-F_{N\infty}/F_{N0}  number   10  -  share of the normal force lost at the same depth
    volume_change         \Delta V              punched  7   -  effective volume worn off the punch
    initial_displacement  w_0                   depth    3   r  normal displacement w_0 before any wear
    steady_displacement   w_\infty              depth    5   r  normal displacement w_inf, the shape of the worn punch
    initial_pressure*     p_0                   pressed  2   r  contact pressure p_0 before any wear
    steady_pressure       p_\infty              pressed  10  r  uniform contact pressure in the worn state
    modulus_at            E                     Pa       1   z  Young's modulus of the half-space at a depth
    """,
    unbounded_at="the edge of the punch",
)

# of the half-space alone: dimensionless functions
MATERIAL = _laws_in(r"""
    h_N         h_N  number  29-31    -  factor h_N of the normal compliance
    holl_ratio  \nu  number  1/(2+k)  -  Holl's ratio, at which normal and tangential contact uncouple
""")

# over cycles; asked for as `transient.wear_volume`
TRANSIENT = _laws_in(
    r"""
    wear_volume       \Delta V  volume  -  F_x cycles wear_coefficient    volume worn after the cycles
    wear_rate         dV/dN     volume  -  F_x cycles wear_coefficient    volume worn per cycle after the cycles
    energy_per_cycle  W         J       -  F_x cycles wear_coefficient    energy of friction per cycle after the cycles
    contact_radius    a         radius  -  F_x cycles wear_coefficient    radius of the contact after the cycles
    profile           f         height  -  r F_x cycles wear_coefficient  shape of the indenter after the cycles
    wear_depth        h         height  -  r F_x cycles wear_coefficient  depth worn off after the cycles
    pressure          p         stress  -  r F_x cycles wear_coefficient  pressure after the cycles
    cycles_to         N         1       -  share F_x wear_coefficient     cycles after which a share of all wear is worn
    """,
    when=" after the cycles",
)


# all that can be asked of a contact of each kind in its steady state, and also over cycles
QUANTITIES: dict[Kind, dict[str, Law]] = {"fretting": FRETTING, "gross-slip": GROSS_SLIP}
_ALL_LAWS = QUANTITIES | {"fretting": FRETTING | {f"transient.{name}": law for name, law in TRANSIENT.items()}}


def kind_of(contact: Any) -> Kind:
    """The kind of a contact, or of the section [contact] of a scene."""
    return "fretting" if hasattr(contact, "normal_force") else "gross-slip"


def laws_of(contact: Any) -> dict[str, Law]:
    """All quantities of a contact, or of the section [contact] of a scene, also those over cycles."""
    return _ALL_LAWS[kind_of(contact)]


def read(
    contact: Any,
    name: str,
    load: Any,
    places: Mapping[str, Any],
    *,
    digits: int | None = None,
    solved: dict[Any, Any] | None = None,
) -> Any:
    """A quantity of a contact in SI units, read from its `Steady` or its `Run`.

    Args:
        contact: A `FrettingContact` or a `GrossSlipContact`.
        name: Such as "wear_volume", or "transient.wear_volume" of a fretting contact, which is `volume` of its `Run`.
        load: The force amplitude in N or a load, if the quantity depends on it.
        places: Values of the other arguments by name, among others.
        digits: Correct digits wanted.
        solved: What other quantities of the same question have solved; it is kept here.
    """
    arguments, asked = laws_of(contact)[name].arguments, name.rpartition(".")[2]
    at = {one: places[one] for one in arguments if one not in ("F_x", "wear_coefficient")}
    solved, lasts = {} if solved is None else solved, "wear_coefficient" in arguments
    key = lasts, "F_x" in arguments
    if key not in solved:
        if kind_of(contact) == "gross-slip":
            solved[key] = contact.steady(digits=digits)
        elif lasts:
            solved[key] = contact.over_cycles(load, places["wear_coefficient"], digits=digits)
        else:
            rigged = getattr(load, "rig_stiffness", None) is not None
            at_rest = load.with_amplitude(lambda amplitude: 0.0 * amplitude) if rigged else 0.0
            solved[key] = contact.steady(load if key[1] else at_rest, digits=digits)
    return read_from(solved[key], asked.removeprefix("wear_") if lasts else asked, at)


def read_from(solution: Any, name: str, places: Mapping[str, Any]) -> Any:
    """A quantity of a `Steady` or a `Run`, by the name that it has there, at places by the names of its arguments."""
    found = getattr(solution, name)
    return found(**places) if places else found


# --- leaves and arguments -------------------------------------------------------------------------------------------

AMPLITUDES = "phi", "tangential_force", "displacement"  # what can set the amplitude
BODIES = "material", "indenter", "shape"  # the fields of a contact that are no numbers


@dataclasses.dataclass(frozen=True)
class AxisKind(Entry):
    """The values of an axis, or of a variable of designs: a leaf of a contact, or an argument.

    Its `scale` is the unit in a sweep without a contact, if it is not the SI unit.

    Attributes:
        domain: Which values are allowed.
        interval: The open interval whose ends logit spacing approaches; None if logit spacing is not possible.
        listed: It is a row of values, with # for the number of each in words and symbol.
    """

    domain: ranges.Domain = ranges.FINITE
    interval: tuple[float, float] | None = None
    listed: bool = False


_OPEN_AT = {"EXPONENT": (-1.0, 1.0), "AMPLITUDE": (0.0, 1.0), "SHARE": (0.0, 1.0)}
# Leaves, those of the material by their own names and those of other bodies by their paths; then arguments: name,
# symbol, unit, range, scale, words, and what it is if not that.
AXES = {
    name: AxisKind(
        words,
        symbol,
        unit,
        about[0] if about else words,
        scale or None,
        getattr(ranges, allowed),
        _OPEN_AT.get(allowed),
        "#" in words,
    )
    for name, symbol, unit, allowed, scale, words, *about in text_cells(r"""
k                   k           1   EXPONENT       -  exponent  exponent k
nu                  \nu         1   POISSON_RATIO  -  Poisson's ratio
E0                  E_0         Pa  POSITIVE       -  modulus  modulus E0 at the depth z0
z0                  z_0         m   POSITIVE       -  characteristic depth  characteristic depth z0
E                   E           Pa  POSITIVE       -  modulus  Young's modulus of the half-space
material.thickness  t_{#}       m   POSITIVE       -  thickness #  thickness of layer # from above
material.modulus    E_{#}       Pa  POSITIVE       -  modulus #  Young's modulus of layer #, or at depth #
material.depth      z_{#}       m   NOT_NEGATIVE  -  depth #  depth # below the surface
indenter.E          E_i         Pa  POSITIVE       -  modulus of the indenter  Young's modulus of an elastic indenter
indenter.nu         \nu_i       1   POISSON_RATIO  -  Poisson's ratio of the indenter
shape.exponent      n           1   SHAPE_EXPONENT  -  exponent of the shape  exponent n of the indenter's shape
shape.slope         \tan\alpha  1   POSITIVE       -  slope of the cone  slope of a conical indenter
shape.flat_radius   b           m   NUMBER         -  radius of the flat  radius b of the indenter's flat middle
shape.r             r_{#}       m   NOT_NEGATIVE  -  radius # of the table  radius # of the table of heights
shape.heights       f_{#}       m   NOT_NEGATIVE  -  height #  height # of the indenter above its apex
radius              R           m   POSITIVE       -  radius of the indenter
normal_force        F_N         N   POSITIVE       -  normal force  normal force F_N
friction            \mu         1   POSITIVE       -  coefficient of friction  coefficient of friction mu
depth               d           m   POSITIVE       -  indentation depth  indentation depth d
phi               \varphi  1  AMPLITUDE  -  amplitude  amplitude F_x/(mu F_N) of the tangential force
tangential_force  F_x  N  NUMBER  -  tangential force  amplitude F_x of the tangential force
displacement      u_x  m  NUMBER  -  displacement  amplitude of the tangential displacement
rig_stiffness     k_r  N/m  POSITIVE  -  stiffness of the rig  stiffness of the rig of a displacement
factor            \lambda  1  POSITIVE  -  factor of the load  factor on all amplitudes of a load
r                 r  m  NOT_NEGATIVE  a_0  radius  distance from the axis of the contact
distance          s  m  NOT_NEGATIVE  a_0  distance inside the stick-slip boundary
x                   x  m  FINITE  -  place along the motion  distance along the motion, negative behind the contact
z                 z  m  NOT_NEGATIVE  -  depth  depth below the surface
least             z_1  m  NOT_NEGATIVE  -  smallest depth
most              z_2  m  NOT_NEGATIVE  -  largest depth
cycles            N  1  NUMBER  -  cycles  number of cycles N
wear_coefficient  K  1/Pa  POSITIVE  -  wear coefficient  Archard's wear coefficient K
share             \Delta V/\Delta V_\infty  1  SHARE  -  share of the final volume
""")
}
_IN_BLOCKS = {"load": "tangential_force", "displacement_amplitude": "displacement"}


def leaf(path: str) -> AxisKind:
    """What a leaf of a contact, or an argument, is called, its symbol, its unit and its range.

    Args:
        path: Such as "material.k" or just "k", "radius", "indenter.E", "shape.exponent", "material.modulus[2]" with
            places counted from 0, an argument such as "cycles", or a number of a block, "load[0].cycles". One that is
            not in the catalogue is called by its name and has any finite values, without a unit.
    """
    block = re.fullmatch(r"load\[(\d+)\]\.(?:load\.)?(\w+)", path)
    if block:
        own = AXES.get(_IN_BLOCKS.get(block[2], block[2]), AxisKind(path, "", "1", path))
        number = int(block[1]) + 1
        return dataclasses.replace(
            own,
            words=f"{own.words} of block {number}",
            symbol=own.symbol and f"{own.symbol}^{{({number})}}",
            description=f"{own.description}, of block {number}",
        )
    place = re.fullmatch(r"([^\[]*)\[(\d+)\]", path)
    stem = place[1] if place else path
    unknown = AxisKind(f"{stem} #" if place else stem, "", "1", stem, listed=place is not None)
    known = AXES.get(stem) or AXES.get(stem.removeprefix("material.")) or unknown
    if not known.listed:
        return known
    number = str(int(place[2]) + 1) if place else "i"
    told = {part: getattr(known, part).replace("#", number) for part in ("words", "symbol", "description")}
    return dataclasses.replace(known, **told)


def derivative(name: str) -> tuple[str, list[str]]:
    """The quantity that a name differentiates, and by what: of `wear_volume.dk.dindenter.E` k and indenter.E."""
    stem, slopes = [], []
    for word in name.split("."):
        first = word[1:].partition("[")[0]
        if slopes and (slopes[-1] in BODIES or word[:1] != "d"):
            slopes[-1] += f".{word}"
        elif stem and word[:1] == "d" and (first in AXES or first in BODIES):
            slopes.append(word[1:])
        elif slopes:
            return name, []
        else:
            stem.append(word)
    return ".".join(stem), slopes


# --- designs and courses --------------------------------------------------------------------------------------------

# what belongs to designs, to wear over cycles, and to a modulus that depends on the depth
_BESIDES = {
    name: Entry(words, symbol, unit)
    for name, symbol, unit, words in text_cells("""
    k                  k       1    exponent k
    E0                 E_0     Pa   modulus E0 at the depth z0
    z0                 z_0     m    characteristic depth z0
    modulus_at_radius  E(a_0)  Pa   modulus at z = contact radius
    edge_exponent      -       1    exponent of the edge singularity
    tangential_force   F_x     N    force amplitude
    volume             -       m^3  worn volume
    volume_per_cycle   -       m^3  wear a cycle
    depth              z       m    depth
    modulus            E(z)    Pa   Young's modulus
    """)
}

# what a design is described by, in the order in which it is printed
DESIGNED = (
    *("k", "E0", "z0", "modulus_at_radius", "wear_volume", "deepest_wear"),
    *("volume_change", "force_drop", "contact_radius", "stick_radius", "worn_radius", "edge_exponent"),
    *("edge_pressure", "penetration"),
)


def quantity(name: str) -> Law | None:
    """The quantity of this name, such as "wear_volume" or "transient.wear_volume"; None if there is none."""
    head, _, tail = name.rpartition(".")
    laws = {"transient": TRANSIENT, "gross_slip": GROSS_SLIP}.get(head, MATERIAL | GROSS_SLIP | FRETTING)
    return laws.get("" if head in BODIES else tail)


def entry(name: str) -> Entry:
    """How a quantity, a leaf of a contact, an argument or a figure of a design or of a course is written.

    Args:
        name: Such as "wear_volume", "transient.wear_volume", "material.k" or "modulus_at_radius".

    Raises:
        KeyError: There is none of this name, and it is no path.
    """
    return _BESIDES.get(name) or quantity(name) or (leaf(name) if {".", "["} & {*name} else AXES[name])


def measured(name: str, value: Any) -> str:
    """A value of what `entry` knows with its unit, as a person writes it; of several the range."""
    import numpy as np

    ends = {written(float(end), entry(name).unit): None for end in (np.min(value), np.max(value))}
    return " to ".join(ends)


def placed(name: str, places: Mapping[str, Any]) -> str:
    """What a quantity is called at its place in m, such as "wear depth at r = 50 µm"."""
    called, at = entry(name).name, {place: written(float(value), "m") for place, value in places.items()}
    if "distance" in at:
        return f"pressure {at['distance']} inside the stick-slip boundary"
    if "least" in at:
        return f"{called} between {at['least']} and {at['most']}"
    told = at["z"] if [*at] == ["z"] else ", ".join(f"{place} = {value}" for place, value in at.items())
    return f"{called} at {told}" if at else called
