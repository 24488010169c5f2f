"""Errors of random numerical contacts: against more digits, balances of force, energy and volume, and similarity.

    python benchmarks/random_contacts.py                       numbers to be quoted
    python benchmarks/random_contacts.py --quick
    python benchmarks/random_contacts.py --only layers --count 200

Bodies are power laws, 1 to 12 layers and tables of 3 to 12 rows, with moduli within a ratio of up to 20, thicknesses
from 1e-5 to 10 contact radii and Poisson's ratios from 0 to 0.49; indenters are rigid or of steel and have all shapes;
the amplitude goes from 1e-6 to 0.999 mu F_N. Contacts of one kind are solved by one compiled program, one after the
other. An error of a pressure is relative to the mean pressure F_N/(pi a_0^2), that of a volume over cycles to the final
volume, that of a derivative of log(V) to 1 or itself, whichever is larger, and every other one to the quantity. The
worst contacts are printed as Python expressions.
"""

import collections
import dataclasses
import re
from collections.abc import Callable
from typing import Annotated, Any, NamedTuple

import harness
import jax
import jax.numpy as jnp
import numpy as np
import typer
from harness import Report

from plgwear_jax import DepthGraded, Elastic, FrettingContact, Layered, PowerLawGraded, Profile
from plgwear_jax.shapes import Cone, PowerShape, RoundedFlat, TruncatedSphere

FRICTION, COEFFICIENT = 0.4, 1e-14
INDENTER = Elastic(210e9, 0.3)
FORCE, RADIUS, MEAN = 10.0, 5e-3, 110e9  # the sizes about which contacts are drawn
WIDTH = (0.75 * FORCE * RADIUS * 0.91 / MEAN) ** (1.0 / 3.0)  # about a_0


# --- drawing ----------------------------------------------------------------------------------------------------------


class Kind(NamedTuple):
    """Contacts of one program."""

    body: str  # "power law", "layers", "table"
    size: int  # number of layers or rows
    shape: str
    elastic: bool

    @property
    def group(self) -> str:
        """How tables call it."""
        smooth = self.shape in ("parabola", "power")
        return f"{self.body}, {'smooth' if smooth else 'with a kink or a tip'}"

    def __str__(self) -> str:
        size = f" of {self.size}" if self.size else ""
        return f"{self.body}{size}, {self.shape}, {'steel' if self.elastic else 'rigid'}"


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


def moduli(rng: np.random.Generator, count: int) -> np.ndarray:
    """Moduli within a ratio that is random itself."""
    return MEAN * np.exp(rng.uniform(-0.5, 0.5, count) * rng.uniform(0.0, np.log(20.0)))


def drawn(kind: Kind, rng: np.random.Generator) -> tuple[FrettingContact, float]:
    """(A contact, its force amplitude)."""
    nu, n = rng.uniform(0.0, 0.49), kind.size
    if kind.body == "power law":
        material: Any = PowerLawGraded(MEAN, 1e-4, rng.uniform(-0.8, 0.8), nu)
    elif kind.body == "layers":
        lowest = -5.0 if rng.random() < 0.25 else -1.5
        material = Layered(WIDTH * 10.0 ** rng.uniform(lowest, 1.0, n) / n, moduli(rng, n + 1), nu)
    else:
        depth = WIDTH * np.sort(10.0 ** rng.uniform(-1.5, 1.0, n))
        material = DepthGraded(depth * (1.0 + 1e-3 * np.arange(n)), moduli(rng, n), nu)
    radius, shape = RADIUS, None
    if kind.shape == "power":
        exponent = rng.uniform(1.2, 6.0)
        radius = (WIDTH ** (exponent - 2.0) * 2.0 * RADIUS / exponent) ** (1.0 / (exponent - 1.0))
        shape = PowerShape(exponent)
    elif kind.shape == "cone":
        shape = Cone(WIDTH / RADIUS * 10.0 ** rng.uniform(-0.7, 0.7))
    elif kind.shape in ("rounded flat", "truncated sphere"):
        shape = {"rounded flat": RoundedFlat, "truncated sphere": TruncatedSphere}[kind.shape](
            WIDTH * 10.0 ** rng.uniform(-1.5, 0.3)
        )
    elif kind.shape == "heights":
        r = WIDTH * np.append(0.0, np.cumsum(rng.uniform(0.3, 1.0, 16)))
        shape = Profile(r, np.append(0.0, np.cumsum(np.diff(r * r) * rng.uniform(0.7, 1.3, 16))) / (2.0 * RADIUS))
    ends = 10.0 ** rng.uniform(-6.0, -1.0), rng.uniform(0.02, 0.98), 1.0 - 10.0 ** rng.uniform(-3.0, -1.0)
    phi = ends[rng.choice(3, p=(0.25, 0.5, 0.25))]
    indenter = INDENTER if kind.elastic else None
    return FrettingContact(material, radius, FORCE, FRICTION, indenter, shape), phi * FRICTION * FORCE


def together(contacts: list[Any]) -> Any:
    """Contacts of one kind along a first axis."""
    return jax.tree.map(lambda *x: np.stack([np.asarray(one, float) for one in x]), *contacts)


def scaled(one: FrettingContact, length: float, modulus: float) -> FrettingContact:
    """The contact with all lengths and moduli scaled, and the force with them."""
    by: dict[str, float] = {"exponent": 1.0, "k": 1.0, "nu": 1.0, "slope": 1.0, "friction": 1.0}
    by |= dict.fromkeys(("E", "E0", "modulus"), modulus) | {"normal_force": modulus * length**2}

    def times(path: Any, x: Any) -> Any:
        return np.asarray(x) * by.get(path[-1].name, length)

    return jax.tree_util.tree_map_with_path(times, one)


def split(one: FrettingContact) -> FrettingContact:
    """The contact with each layer in two equal halves."""
    material: Any = one.material
    thickness = np.repeat(np.asarray(material.thickness) / 2.0, 2, -1)
    modulus = np.asarray(material.modulus)
    whole = np.concatenate([np.repeat(modulus[..., :-1], 2, -1), modulus[..., -1:]], -1)
    return dataclasses.replace(one, material=Layered(thickness, whole, material.nu))


def told(one: FrettingContact, force: float) -> str:
    """The contact as a Python expression."""
    with np.printoptions(linewidth=10_000):
        return f"{one!r}.steady({force!r})".replace("array(", "np.array(")


# --- what is computed -------------------------------------------------------------------------------------------------

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


def edge_exponent(one: Any) -> Any:
    """s of the pressure at the edge, (1 - (r/c)^2)^(s-1)."""
    k = getattr(one.material, "k", 0.0)
    return 0.5 * (1.0 + (k if one.indenter is None else jnp.maximum(k, 0.0)))


def steady(digits: int, one: Any, force: Any, along: Any) -> dict[str, Any]:
    """Quantities of the steady state, their derivative along a direction, and the integrals of fields."""
    solved = one.steady(force, digits=digits)
    found = {name: jnp.stack([getattr(solved, part) for part in parts]) for name, parts in SCALARS.items()}
    a, c, end = found["radii"]
    mean = one.normal_force / (jnp.pi * a * a)
    found["pressure before"] = solved.initial_pressure(jnp.asarray(PLACES, a.dtype) * a) / mean
    found["pressure worn"] = solved.pressure(jnp.asarray(PLACES, a.dtype) * c) / mean

    def volume(step: Any) -> Any:
        moved = jax.tree.map(lambda x, by: x * (1.0 + step * by), (one, force), along)
        return jnp.log(moved[0].steady(moved[1], digits=digits).wear_volume)

    found["derivatives"] = jax.jvp(volume, (0.0 * a,), (1.0 + 0.0 * a,))[1][None]
    # --- balances, by integrals over 1 - (r/c)^2 = v^m, which take the edge's power off
    nodes, weights = jnp.asarray(NODES, a.dtype), jnp.asarray(WEIGHTS, a.dtype)
    m = 2.0 / edge_exponent(one)
    z = nodes**m
    inside = z / (1.0 + jnp.sqrt(1.0 - z))
    measure = jnp.pi * m * nodes ** (m - 1.0) * weights
    before = a * a * (measure @ solved.initial_pressure(a * (1.0 - inside)))
    worn = c * c * (measure @ solved.edge_pressure(c * inside))
    ring = (end - c) * (end + c)
    depths = solved.wear_depth(jnp.sqrt(c * c + ring * nodes**2))
    whole = jnp.pi * ring * ((2.0 * nodes * weights) @ depths)
    sums = before / one.normal_force, worn / one.normal_force, whole / found["wear volume"][0]
    return found | {"balances": jnp.stack(sums)}


def volume(digits: int, one: Any, force: Any) -> Any:
    """The worn volume alone."""
    return one.steady(force, digits=digits).wear_volume


def mapped(function: Callable[..., Any], digits: int) -> Callable[..., Any]:
    """One program for all contacts of a kind, which are solved one after the other."""
    return jax.jit(lambda *given: jax.lax.map(lambda one: function(digits, *one), given))


def volumes(digits: int, one: Any, force: Any, cycles: Any) -> Any:
    """What `over_cycles` errors are measured by."""
    run = one.over_cycles(force, COEFFICIENT, digits=digits)
    solved = one.steady(force, digits=digits)
    zero = jnp.zeros_like(cycles[:1])
    worn = run.volume(jnp.concatenate([cycles, 1e3 * cycles[-1:]])) / solved.wear_volume
    return jnp.concatenate([worn, run.energy_per_cycle(zero) / solved.energy_per_cycle])


# --- errors -----------------------------------------------------------------------------------------------------------


class Errors:
    """Errors by group and quantity, with the contacts that have them."""

    def __init__(self) -> None:
        self.found: dict[tuple[str, str], list[tuple[float, str]]] = collections.defaultdict(list)

    def add(self, kind: Kind, name: str, errors: Any, asked: list[tuple[Any, float]]) -> None:
        """One error for each contact; NaN where none is known."""
        for error, one in zip(np.asarray(errors, float), asked, strict=True):
            if not np.isnan(error):
                self.found[kind.group, name].append((float(error), told(*one)))

    def rows(self) -> list[list[str]]:
        """Group, quantity, contacts, the 95th percentile and the worst."""
        rows = []
        for (group, name), found in sorted(self.found.items()):
            errors = np.array([error for error, _ in found])
            rows.append(
                [
                    group,
                    name,
                    str(errors.size),
                    *(f"{x:.0e}" for x in np.quantile(errors, (0.95, 1.0), method="higher")),
                ]
            )
        return rows

    def worst(self, count: int) -> list[str]:
        """The worst contacts of each quantity."""
        lines = []
        for (group, name), found in sorted(self.found.items()):
            for error, text in sorted(found, reverse=True)[:count]:
                lines.append(f"{group}, {name}, {error:.1e}: {text}")
        return lines


def most(x: Any) -> np.ndarray:
    """The largest along all axes but the first; NaN where one is NaN."""
    return np.abs(np.asarray(x, float)).reshape(np.shape(x)[0], -1).max(-1)


def compare(kind: Kind, errors: Errors, found: Any, exact: Any, asked: Any, what: str = "") -> None:
    """Errors of all quantities of `steady`."""
    for name in exact:
        x, y = np.asarray(found[name], float), np.asarray(exact[name], float)
        if name == "balances":
            continue
        size = np.abs(y) if name in SCALARS else np.maximum(np.abs(y), 1.0) if name == "derivatives" else 1.0
        with np.errstate(divide="ignore", invalid="ignore"):  # a quantity that is lost is 0
            errors.add(kind, name + what, most((x - y) / size), asked)


def solve(kind: Kind, count: int, seed: int, quick: bool, tables: dict[str, Errors], refused: Any) -> None:
    """All that is asked of the contacts of one kind."""
    rng = np.random.default_rng([seed, *map(ord, str(kind))])
    asked = [drawn(kind, rng) for _ in range(count)]
    contacts, forces = together([one for one, _ in asked]), np.array([force for _, force in asked])
    along = jax.tree.map(lambda x: rng.uniform(-1.0, 1.0, x.shape), (contacts, forces))
    along = jax.tree_util.tree_map_with_path(_moved, along)
    given = contacts, forces, along
    exact = jax.device_get(mapped(steady, 5)(*given))
    program = mapped(steady, 4)
    found = jax.device_get(program(*given))
    compare(kind, tables["digits"], found, exact, asked)
    for name, part in zip(("force before", "force worn", "volume"), found["balances"].T, strict=True):
        tables["balances"].add(kind, name, np.abs(part - 1.0), asked)
    larger = jax.tree.map(lambda *x: np.stack(x), *[scaled(one, 3.7, 0.21) for one, _ in asked])
    alike = jax.device_get(program(larger, forces * 0.21 * 3.7**2, along))
    ratio = alike["wear volume"] / found["wear volume"] / 3.7**3
    tables["balances"].add(kind, "similarity", most(ratio - 1.0), asked)
    for number in np.flatnonzero(np.isnan(found["wear volume"][:, 0])):
        one, force = asked[number]
        try:
            one.steady(force).wear_volume.block_until_ready()
            line = "NaN without a line"
        except ValueError as error:
            line = re.sub(r"-?\d[\d.]*(e[+-]?\d+)?", "...", str(error))
        refused[kind.group, line].append(told(one, force))
    refused[kind.group, ""] += [""] * count
    if quick:
        return
    for digits in (2, 3):
        rough = jax.device_get(mapped(volume, digits)(contacts, forces))
        error = np.abs(rough / exact["wear volume"][:, 0] - 1.0)
        tables["each"].add(kind, f"{digits} digits", error, asked)
    tables["each"].add(kind, "4 digits", most(found["wear volume"] / exact["wear volume"] - 1.0), asked)
    if kind.body == "layers":
        halves = together([split(one) for one, _ in asked])
        error = np.abs(jax.device_get(mapped(volume, 4)(halves, forces)) / found["wear volume"][:, 0] - 1.0)
        tables["balances"].add(kind, "layers in halves", error, asked)
    single = jax.tree.map(lambda x: np.asarray(x, np.float32), given)
    compare(kind, tables["float32"], jax.device_get(program(*single)), found, asked)
    rate = found["energy"][:, 0] / FRICTION * COEFFICIENT
    cycles = found["wear volume"] / rate[:, None] * np.geomspace(0.01, 30.0, 8)
    worn = {digits: jax.device_get(mapped(volumes, digits)(contacts, forces, cycles)) for digits in (3, 4)}
    tables["cycles"].add(kind, "3 digits against 4", most((worn[3] - worn[4])[:, :-2]), asked)
    tables["cycles"].add(kind, "the last volume", np.abs(worn[4][:, -2] - 1.0), asked)
    tables["cycles"].add(kind, "the first rate beside the energy", np.abs(worn[4][:, -1] - 1.0), asked)
    lost = np.isnan(worn[4]).any(-1) & ~np.isnan(found["wear volume"][:, 0])
    for number in np.flatnonzero(lost):
        refused[kind.group, "NaN over cycles"].append(told(*asked[number]))


def _moved(path: Any, by: Any) -> Any:
    """Directions of derivatives: numbers that are no sizes stay."""
    return by * (getattr(path[-1], "name", "") not in ("r", "heights", "depth", "nu", "friction", "exponent", "k"))


TITLES = {
    "digits": "Errors at the default 4 digits, against 5",
    "each": "Errors of the worn volume, against 5 digits",
    "balances": "Balances at 4 digits",
    "cycles": "Over cycles",
    "float32": "float32 against float64",
}


def main(
    quick: harness.Quick = False,
    out: harness.Out = harness.DEFAULT_OUT,
    count: Annotated[int, typer.Option(help="Contacts of each kind.", show_default="40, 6 with --quick")] = 0,
    only: Annotated[str, typer.Option(help="A regular expression for the kinds, such as 'layers of 3'.")] = "",
    seed: Annotated[int, typer.Option(help="Of the random numbers.")] = 1,
) -> None:
    """Errors of random contacts."""
    report = Report("random_contacts", out, "Random contacts without closed forms", quick)
    tables, refused = {name: Errors() for name in TITLES}, collections.defaultdict(list)
    kinds = [kind for kind in KINDS if re.search(only, str(kind))]
    for kind in kinds[: 2 if quick and not only else None]:
        solve(kind, count or (6 if quick else 40), seed, quick, tables, refused)
    for name, title in TITLES.items():
        if tables[name].found:
            report.table(title, ("contacts", "quantity", "number", "95 of 100", "worst"), tables[name].rows())
    rows = []
    for (group, line), found in sorted(refused.items()):
        if line:
            rows.append([f"{group}: {line}", f"{len(found) / len(refused[group, '']):.1%}"])
    report.table("Shares of contacts that are refused", ("contacts: the line", "share"), rows)
    report.print("The worst contacts:")
    for name in TITLES:
        for line in tables[name].worst(1):
            report.console.print(f"{name}: {line}", soft_wrap=True)
    for (group, line), found in sorted(refused.items()):
        for text in found[:1] if line else ():
            report.console.print(f"refused: {group}: {text}", soft_wrap=True)
    report.close()


if __name__ == "__main__":
    harness.run(main)
