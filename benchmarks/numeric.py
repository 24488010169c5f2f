"""Time and error of contacts without closed forms, on one core: two tables.

    python benchmarks/numeric.py
    python benchmarks/numeric.py random_contacts --quick

surfaces: errors by digits are the largest relative ones of contact radius, stick radius, outer radius, penetration and
worn volume over amplitudes from 0.01 to 0.98 of the limit, and over cycles of the worn volume over the final one. The
first two contacts have closed forms; the others are held to more digits than the library offers.

random_contacts: bodies are power laws, 1 to 12 layers and tables of 3 to 12 rows, with moduli within a ratio of up to
20, thicknesses from 1e-8 to 10 contact radii and Poisson's ratios from 0 to 0.49; indenters are rigid or of steel and
have all shapes; the amplitude goes from 1e-6 to 0.999 mu F_N. Contacts of one kind are solved by one compiled program,
one after the other. They are held to more digits, to balances and to float32. Errors of pressures are
relative to the mean pressure F_N/(pi a_0^2), and all others to the quantity, but errors of derivatives of log(V) to 1
where the derivative is below 1. Balances compare the integral of the pressure with the force, before any wear and worn;
the integral of the depth with the volume; the integral of pressure times slip with the energy of a cycle; the contact
with one of 1.1 times the size, and with one whose layers are each divided in two; the last volume of a march with that
of the steady state; derivatives with differences.
The worst contacts and those that are refused are printed as Python expressions.
"""

import dataclasses
import importlib
import re
import warnings
from contextlib import ExitStack
from typing import Any, NamedTuple
from unittest import mock

import harness  # before jax: pins the process
import jax
import jax.numpy as jnp
import numpy as np
from harness import Part, Report, seconds, short, worst

from plgwear_jax import DepthGraded, Elastic, FrettingContact, Layered, PowerLawGraded, Profile
from plgwear_jax.shapes import Cone, PowerShape, RoundedFlat, TruncatedSphere
from plgwear_jax.surfaces.effort import EFFORTS, Effort
from plgwear_jax.wear import ring_cells
from plgwear_jax.wear_laws import PressurePower

rigid_shapes: Any = importlib.import_module("rigid_shapes")  # which harness makes known

FORCE, FRICTION, COEFFICIENT = 10.0, 0.4, 1e-14
STEEL = Elastic(210e9, 0.3)

# --- errors and times by digits --------------------------------------------------------------------------------------

PHI = np.array([0.01, 0.1, 0.5, 0.9, 0.98])
LIFE_PHI = np.array([0.02, 0.3, 0.9])[:, None]
SHARES = np.array([0.001, 0.01, 0.1, 0.3, 0.5, 0.8, 0.95, 0.999])
FINEST = Effort(5, 64, 0.15, 64)


def contact(coating: Any, indenter: Elastic | None) -> FrettingContact:
    """A ball of 5 mm under 10 N."""
    return FrettingContact(coating, 5e-3, FORCE, FRICTION, indenter)


def power_law(*k: float) -> PowerLawGraded:
    """Power laws of these exponents, with axes for amplitudes and cycles."""
    return PowerLawGraded(110e9, 1e-4, np.reshape(k, (-1, 1, 1)), 0.3)


TABLE = DepthGraded([1e-5, 3e-5, 8e-5, 2e-4], [90e9, 150e9, 120e9, 210e9], 0.3)
MANY = power_law(-0.6, -0.3, 0.02, 0.4, 0.8)
CLOSED = {
    "k from -0.6 to 0.8, E = 1e20 Pa": (contact(MANY, Elastic(1e20, 0.3)), contact(MANY, None)),
    "one modulus at all depths, rigid": (
        contact(DepthGraded([1e-5, 2e-5, 5e-5, 1e-4], np.full(4, 110e9), 0.3), None),
        contact(PowerLawGraded(110e9, 1e-4, 0.0, 0.3), None),
    ),
}
OPEN = {
    "k from -0.8 to 0.8, steel": contact(power_law(-0.8, -0.4, 0.1, 0.4, 0.8), STEEL),
    "three layers, steel": contact(Layered([2e-5, 3e-5], [50e9, 300e9, 100e9], 0.3), STEEL),
    "a table, steel": contact(TABLE, STEEL),
}
CASES = {
    "power law, steel": contact(PowerLawGraded(110e9, 1e-4, 0.2, 0.3), STEEL),
    "a table, steel": contact(TABLE, STEEL),
}


def finest() -> ExitStack:
    """The most digits are those of finer contacts and marches meanwhile."""
    stack, march = ExitStack(), ring_cells.MarchResolution(12, 32, 7.0, (2, 3, 4))
    stack.enter_context(mock.patch.dict(EFFORTS, {5: FINEST, 4: FINEST._replace(digits=4, modes=56)}))
    stack.enter_context(mock.patch.dict(ring_cells.RESOLUTIONS, {4: march}))
    return stack


def steady(one: FrettingContact, digits: int | None) -> list[np.ndarray]:
    """What errors are told of."""
    names = "contact_radius", "stick_radius", "worn_radius", "penetration", "wear_volume"
    solved = one.steady(FRICTION * FORCE * PHI, digits=digits)
    return [np.asarray(getattr(solved, name)) for name in names]


def shares(one: FrettingContact, cycles: np.ndarray, digits: int) -> np.ndarray:
    """The worn shares of the final volume after so many cycles, those of each force along a last axis."""
    force = FRICTION * FORCE * LIFE_PHI
    worn = one.over_cycles(force, COEFFICIENT, digits=digits).volume(cycles)
    return np.asarray(worn / one.steady(force).wear_volume)


def errors(report: Report, quick: bool) -> None:
    """Errors of each number of digits, in the steady state and over cycles."""
    pairs = dict(list(CLOSED.items())[quick:])
    contacts = {name: one for name, (one, _) in pairs.items()} | ({} if quick else OPEN)
    exact = {name: steady(known, None) for name, (_, known) in pairs.items()}
    cycles = {
        name: np.asarray(one.over_cycles(FRICTION * FORCE * LIFE_PHI, COEFFICIENT, digits=2).cycles_to(SHARES))
        for name, one in contacts.items()
    }
    later = {name: shares(known, cycles[name], 5) for name, (_, known) in pairs.items()}
    with finest():
        for name in contacts.keys() - pairs.keys():
            exact[name] = steady(contacts[name], 5)
            later[name] = shares(contacts[name], cycles[name], 4)
    choices = sorted(EFFORTS)[: 1 if quick else None]
    rows = [[name, str(n), worst(steady(one, n), exact[name])] for name, one in contacts.items() for n in choices]
    report.table("Largest errors of a_0, c, a_inf, d_inf, V", ("contact", "digits", "errors"), rows)
    rows = []
    for name, one in contacts.items():
        known = np.isfinite(later[name])  # where the finest march fails, nothing is compared
        for digits in choices[:3]:
            error = np.abs(shares(one, cycles[name], digits) - later[name])[known].max()
            rows.append([name, str(digits), f"{error:.0e}", f"{known.sum()} of {known.size}"])
    report.table("Largest errors of V(N) over the final one", ("contact", "digits", "error", "points"), rows)


def times(report: Report, quick: bool) -> None:
    """Times of each number of digits; what first answers and derivatives take is told by `waits.py`."""
    rows, force = [], iter(np.linspace(1.0, 2.0, 1000))
    for name, one in list(CASES.items())[-1 if quick else 0 :]:
        for digits in (4,) if quick else sorted(EFFORTS):
            _, again = seconds(lambda o=one, d=digits: o.steady(next(force), digits=d).wear_volume, 3 if quick else 20)
            rows.append([name, str(digits), short(1e3 * again)])
    report.table("Processor time of a worn volume", ("contact", "digits", "ms"), rows)


def rigid(report: Report, quick: bool) -> None:
    """Errors of rigid indenters of all shapes on power laws."""
    rows = []
    for name, (shape, *_) in rigid_shapes.SHAPES.items():
        # With a lower k and phi = 0.99 a truncated sphere sticks up to its flat face, to all digits of a radius.
        lowest = -0.7 if name == "truncated sphere" else -0.9
        for k in (0.3,) if quick else (lowest, 0.0, 0.9):
            one, found = rigid_shapes.contact_with(shape, k), []
            for phi in (0.4,) if quick else (0.01, 0.5, 0.99):
                mine = rigid_shapes.steady(one, phi * rigid_shapes.FRICTION * rigid_shapes.FORCE)
                found.append(np.abs(mine / rigid_shapes.exact(name, k, phi) - 1))
            rows.append([name, f"{k:g}", ", ".join(f"{x:.0e}" for x in np.max(found, 0))])
    columns = "rigid indenter", "k", "a_0, c, a_inf, d_inf, V"
    report.table("Largest errors on a power law, phi from 0.01 to 0.99, against integrals in mpmath", columns, rows)


# --- random contacts -------------------------------------------------------------------------------------------------

RADIUS, MEAN = 5e-3, 110e9  # the sizes about which contacts are drawn
WIDTH = (0.75 * FORCE * RADIUS * 0.91 / MEAN) ** (1.0 / 3.0)  # about a_0


class Kind(NamedTuple):
    """Contacts of one program."""

    body: str  # "power law", "layers", "table"
    size: int  # number of layers or rows
    shape: str
    elastic: bool

    def group(self, one: FrettingContact) -> str:
        """How tables call one of them."""
        if self.shape in ("parabola", "power"):
            return f"{self.body}, smooth"
        thin = self.body == "layers" and np.min(np.asarray(one.material.thickness)) < 0.05 * WIDTH  # pyright: ignore
        return f"{'thin ' if thin else ''}{self.body}, kinks"


KINDS = (
    Kind("layers", 3, "parabola", True),
    Kind("table", 6, "parabola", True),
    Kind("layers", 8, "truncated sphere", False),
    Kind("power law", 0, "parabola", True),
    Kind("layers", 1, "parabola", False),
    Kind("layers", 12, "parabola", True),
    Kind("layers", 2, "power", True),
    Kind("layers", 2, "cone", True),
    Kind("layers", 4, "rounded flat", True),
    Kind("table", 3, "parabola", False),
    Kind("table", 12, "heights", True),
    Kind("power law", 0, "truncated sphere", True),
    Kind("power law", 0, "power", True),
)


def drawn(kind: Kind, rng: np.random.Generator) -> tuple[FrettingContact, float]:
    """(A contact, its force amplitude)."""
    nu, n = rng.uniform(0.0, 0.49), kind.size
    moduli = MEAN * np.exp(rng.uniform(-0.5, 0.5, n + 1) * rng.uniform(0.0, np.log(20.0)))
    if kind.body == "power law":
        material: Any = PowerLawGraded(MEAN, 1e-4, rng.uniform(-0.8, 0.8), nu)
    elif kind.body == "layers":
        lowest = -8.0 if rng.random() < 0.25 else -1.5
        material = Layered(WIDTH * 10.0 ** rng.uniform(lowest, 1.0, n) / n, moduli, nu)
    else:
        depth = WIDTH * np.sort(10.0 ** rng.uniform(-1.5, 1.0, n))
        material = DepthGraded(depth * (1.0 + 1e-3 * np.arange(n)), moduli[1:], nu)
    radius, shape, flat = RADIUS, None, WIDTH * 10.0 ** rng.uniform(-1.5, 0.3)
    if kind.shape == "power":
        exponent = rng.uniform(1.2, 6.0)
        radius = (WIDTH ** (exponent - 2.0) * 2.0 * RADIUS / exponent) ** (1.0 / (exponent - 1.0))
        shape = PowerShape(exponent)
    elif kind.shape == "cone":
        shape = Cone(WIDTH / RADIUS * 10.0 ** rng.uniform(-0.7, 0.7))
    elif kind.shape == "heights":
        r = WIDTH * np.append(0.0, np.cumsum(rng.uniform(0.3, 1.0, 16)))
        shape = Profile(r, np.append(0.0, np.cumsum(np.diff(r * r) * rng.uniform(0.7, 1.3, 16))) / (2.0 * RADIUS))
    elif kind.shape != "parabola":
        shape = RoundedFlat(flat) if kind.shape == "rounded flat" else TruncatedSphere(flat)
    ends = 10.0 ** rng.uniform(-6.0, -1.0), rng.uniform(0.02, 0.98), 1.0 - 10.0 ** rng.uniform(-3.0, -1.0)
    force = ends[rng.choice(3, p=(0.25, 0.5, 0.25))] * FRICTION * FORCE
    return FrettingContact(material, radius, FORCE, FRICTION, STEEL if kind.elastic else None, shape), force


SCALARS = {
    "radii": ("contact_radius", "stick_radius", "worn_radius"),
    "penetration": ("penetration",),
    "wear volume": ("wear_volume",),
    "deepest wear": ("deepest_wear",),
    "energy": ("energy_per_cycle",),
    "ratios": ("energy_ratio", "loop_aperture"),
}
PLACES = np.array([0.0, 0.3, 0.5, 0.7, 0.85])  # r/c
NODES, WEIGHTS = (0.5 * x for x in np.polynomial.legendre.leggauss(32))
NODES = 0.5 + NODES
STEPS = np.array([-2e-4, -1e-4, 1e-4, 2e-4, np.log(1.1)])  # the last one of all sizes
SIZES: dict[str, float] = dict.fromkeys(("radius", "z0", "thickness", "depth", "r", "heights", "flat_radius"), 1.0)
SIZES["normal_force"] = 2.0
NOT_MOVED = {"r", "heights", "depth", "nu", "friction", "exponent", "k"}  # by the step of a derivative
BALANCES = "force before", "force worn", "volume", "energy", "similarity", "derivatives"


def answers(digits: int, one: Any, force: Any, along: Any) -> dict[str, Any]:
    """Quantities of the steady state, their derivative along a direction, and the balances."""
    solved = one.steady(force, digits=digits)
    found = {name: jnp.stack([getattr(solved, part) for part in parts]) for name, parts in SCALARS.items()}
    a, c, end = found["radii"]
    mean = one.normal_force / (jnp.pi * a * a)
    found["pressure before"] = solved.initial_pressure(jnp.asarray(PLACES, a.dtype) * a) / mean
    found["pressure worn"] = solved.pressure(jnp.asarray(PLACES, a.dtype) * c) / mean

    def volume(step: Any, along: Any = along) -> Any:
        moved = jax.tree.map(lambda x, by: x * jnp.exp(step * by), (one, force), along)
        return jnp.log(moved[0].steady(moved[1], digits=digits).wear_volume)

    slope = jax.jvp(volume, (0.0 * a,), (1.0 + 0.0 * a,))[1]
    size = jax.tree_util.tree_map_with_path(
        lambda path, x: SIZES.get(getattr(path[-1], "name", ""), 0.0) + 0.0 * x, (one, force)
    )
    size = size[0], 2.0 + size[1]
    # Close to gross slip V is a power of 1 - phi, which a step of F_x has to change by a little only.
    lack = 1.0 - force / (one.friction * one.normal_force)
    steps = jnp.asarray(STEPS, a.dtype).at[:4].multiply(lack)
    ways = jax.tree.map(lambda x, y: jnp.stack([x, x, x, x, y]), along, size)
    *near, larger = jax.lax.map(lambda given: volume(*given), (steps, ways))
    by = (8.0 * (near[2] - near[1]) - (near[3] - near[0])) / (12e-4 * lack)
    # Integrals over 1 - (r/c)^2 = v^m take the power of the pressure at the edge off, and end at that of a flat face.
    nodes, weights = jnp.asarray(NODES, a.dtype), jnp.asarray(WEIGHTS, a.dtype)
    k, flat = getattr(one.material, "k", 0.0), getattr(one.shape, "flat_radius", 0.0)
    m = 4.0 / (1.0 + (k if one.indenter is None else jnp.maximum(k, 0.0)))
    shares, rates = nodes * nodes * (3.0 - 2.0 * nodes), 6.0 * nodes * (1.0 - nodes) * weights

    def carried(radius: Any, pressure: Any) -> Any:
        end = jnp.clip(1.0 - (flat / radius) ** 2, 0.0, 1.0 - 1e-6) ** (1.0 / m)
        v = jnp.append(end * shares, end + (1.0 - end) * shares)
        z, measure = v**m, jnp.append(end * rates, (1.0 - end) * rates) * v ** (m - 1.0)
        found = pressure(radius * z / (1.0 + jnp.sqrt(1.0 - z)))
        return jnp.pi * m * radius**2 * (measure @ found) / one.normal_force - 1.0

    slip, wide = c + (a - c) * shares, end * end - c * c
    worn = solved.wear_depth(jnp.sqrt(c * c + wide * nodes**2))
    work = solved.initial_pressure(slip) * solved.slip_amplitude(slip) * slip * rates
    sums = (
        carried(a, lambda distance: solved.initial_pressure(a - distance)),
        carried(c, solved.edge_pressure),
        jnp.pi * wide * ((2.0 * nodes * weights) @ worn) / found["wear volume"][0] - 1.0,
        8.0 * jnp.pi * one.friction * (a - c) * jnp.sum(work) / found["energy"][0] - 1.0,
        jnp.expm1(larger - jnp.log(found["wear volume"][0]) - 3.0 * steps[-1]),
        (slope - by) / jnp.maximum(abs(by), 1.0),
    )
    return found | {"derivatives": slope[None], "balances": jnp.stack(sums)}


def marched(digits: int, one: Any, force: Any) -> Any:
    """The last volume by the march of any test, to which `PressurePower` is another law."""
    run = one.over_cycles(force, PressurePower(COEFFICIENT, 1.0), digits=digits)
    return run.volume(run.lasting_cycles)


def mapped(function: Any, digits: int) -> Any:
    """One program for all contacts of a kind, which are solved one after the other."""
    return jax.jit(lambda *given: jax.lax.map(lambda one: function(digits, *one), given))


Tables = dict[str, dict[tuple[str, str], list[tuple[float, str]]]]  # errors with contacts, by group and quantity


def solve(kind: Kind, count: int, tables: Tables, lines: dict[str, list[str]]) -> None:
    """All that is asked of the contacts of one kind, and what those that are refused are told."""
    rng = np.random.default_rng([1, *map(ord, repr(kind))])
    asked = [drawn(kind, rng) for _ in range(count)]
    phi = np.array([force for _, force in asked]) / (FRICTION * FORCE)

    def together(contacts: list[Any]) -> Any:
        return jax.tree.map(lambda *x: np.stack([np.asarray(one, float) for one in x]), *contacts)

    def add(table: str, name: str, found: Any, which: Any = True) -> None:
        size = np.abs(np.asarray(found, float)).reshape(count, -1).max(-1)
        for x, (a, f), mine in zip(size, asked, np.broadcast_to(which, count), strict=True):
            if mine and not np.isnan(x):
                text = f"{a!r}.steady({f!r})".replace("array(", "np.array(")
                tables[table].setdefault((kind.group(a), name), []).append((float(x), text))

    def compare(table: str, found: Any, exact: Any, which: Any = True) -> None:
        for name in exact.keys() - {"balances"}:
            x, y = np.asarray(found[name], float), np.asarray(exact[name], float)
            size = np.abs(y) if name in SCALARS else np.maximum(np.abs(y), 1.0) if name == "derivatives" else 1.0
            add(table, name, (x - y) / size, which)

    contacts, forces = together([one for one, _ in asked]), np.array([force for _, force in asked])
    along = jax.tree_util.tree_map_with_path(
        lambda path, x: rng.uniform(-1.0, 1.0, x.shape) * (getattr(path[-1], "name", "") not in NOT_MOVED),
        (contacts, forces),
    )
    given = contacts, forces, along
    program = mapped(answers, 4)
    with warnings.catch_warnings(action="ignore"):  # a quantity that is lost is 0
        found, exact = (jax.device_get(f(*given)) for f in (program, mapped(answers, 5)))
        volume = found["wear volume"][:, 0]
        compare("digits", found, exact)
        for name, part in zip(BALANCES, found["balances"].T, strict=True):
            add("balances", name, part)
        if kind.body == "layers":
            layers = contacts.material
            halves = np.repeat(0.5 * layers.thickness, 2, -1), np.repeat(layers.modulus, 2, -1)[:, :-1]
            divided = dataclasses.replace(contacts, material=Layered(*halves, layers.nu))
            again = mapped(lambda digits, one, force: one.steady(force, digits=digits).wear_volume, 4)(divided, forces)
            add("balances", "layers in two", again / volume - 1.0)
        add("balances", "last of a march", mapped(marched, 2)(contacts, forces) / volume - 1.0)
        single = jax.tree.map(lambda x: np.asarray(x, np.float32), given)
        compare("float32", jax.device_get(program(*single)), found, phi >= 0.1)
    lost = np.isnan(volume)
    add("refused", "NaN", lost)
    for one, force in (asked[i] for i in np.flatnonzero(lost)):
        try:
            told = f"nothing, V = {one.steady(force).wear_volume}"
        except ValueError as error:
            told = re.sub(r" at r = .*?\)|r = \S+ m", " at r", str(error))
        lines.setdefault(told, []).append(f"{one!r}.steady({force!r})")


TITLES = {
    "digits": "Errors at the default 4 digits, against 5",
    "balances": "Balances at 4 digits",
    "float32": "float32 against float64, where phi >= 0.1",
    "refused": "Contacts that are refused",
}


def random_contacts(report: Report, quick: bool) -> None:
    """Errors of random contacts."""
    tables: Tables = {name: {} for name in TITLES}
    lines: dict[str, list[str]] = {}
    for kind in KINDS[: 1 if quick else None]:
        solve(kind, 6 if quick else 12, tables, lines)
    refused = tables.pop("refused")
    for table, groups in tables.items():
        rows = []
        for (group, name), found in sorted(groups.items()):
            ends = np.quantile([error for error, _ in found], (0.5, 0.95, 1.0), method="higher")
            rows.append([group, name, str(len(found)), *(f"{x:.0e}" for x in ends)])
        report.table(TITLES[table], ("contacts", "quantity", "number", "half", "95 of 100", "worst"), rows)
    rows = [
        [group, str(len(found)), f"{sum(x for x, _ in found):.0f}"] for (group, _), found in sorted(refused.items())
    ]
    report.table(TITLES["refused"], ("contacts", "number", "refused"), rows)
    report.print("The worst contacts at 4 digits, and one of each that is refused:")
    for name in sorted({name for _, name in tables["digits"]}):
        error, text = max(max(found) for (_, other), found in tables["digits"].items() if other == name)
        report.console.print(f"{name}, {error:.1e}: {text}", soft_wrap=True)
    for line, contacts in lines.items():
        report.console.print(f"{len(contacts)} are told: {line}: {contacts[0]}", soft_wrap=True)


PARTS = {
    "surfaces": Part("Elastic indenters and any E(z)", [times, errors, rigid]),
    "random_contacts": Part("Random contacts without closed forms", [random_contacts]),
}

if __name__ == "__main__":
    harness.run(PARTS)
