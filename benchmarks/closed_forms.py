"""What closed forms cost and how exact they are, on one core beside SciPy and jax.scipy: three tables.

    python benchmarks/closed_forms.py
    python benchmarks/closed_forms.py digits kernels --quick

digits: speed against accuracy of the wear volume, its gradient and its Hessian; every `digits=` of both dtypes with its
time a point and the worst error that it really has, and the programs of `scipy_programs.py` beside them.

kernels: the two special functions of the problem against the general ones of SciPy and jax.scipy. The tail of the
arcsine law, y from 1e-3 to 1e3 evenly in log y, s uniform:

    Q(y; s) = I_x(q, s), q = 1 - s, x = y/(1+y)                     by an incomplete beta function

The displacement under and beside the uniformly pressed disc, Eq. (5), 0 <= r <= 3, k = 2s - 1:

    2F1(s-1, s; 1; r^2)  for r <= 1,      (1-s) r^(-2s) 2F1(s, s; 2; 1/r^2)  beside

SciPy and jax get one hypergeometric function a point, its arguments chosen by r. Those that take long get the first of
the points. The iteration in jax.scipy ends with the slowest point of a batch, so it takes longer on more points.

size: what a point costs by the number of points, 1 to 10^8, and what a contact costs that is solved numerically, on one
core, on all, and on an accelerator if there is one.
"""

import itertools
import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

import harness  # before jax: pins the process
import jax
import jax.numpy as jnp
import jax.scipy.special as jax_special
import mpmath as mp
import numpy as np
import scipy.special as scipy_special
import scipy_programs
from harness import Compared, Exact, Part, Points, Program, Report, Timing, interleave, short, worst
from matplotlib.figure import Figure
from numeric import CASES

from plgwear_jax import fretting, gross_slip
from plgwear_jax.plots import COLOURS
from plgwear_jax.special.arcsine import arcsine_tail, fold

DTYPES = ("float64", "float32")

# --- digits ---------------------------------------------------------------------------------------------------------

VALUE, GRADIENT, HESSIAN = KINDS = ("value", "with gradient", "Hessian")
ORDERS = {VALUE: (0,), GRADIENT: (0, 1), HESSIAN: (2,)}
ASKED = {"float64": (*range(1, 16), None), "float32": (*range(1, 7), None)}


class Case(NamedTuple):
    """A result that the library is asked for."""

    kind: str
    dtype: str
    digits: int | None

    def __str__(self) -> str:
        return f"{self.dtype}, {self.digits or 'all'}"


def function(case: Case) -> Callable[..., Any]:
    volume = partial(fretting.wear_volume, digits=case.digits)
    if case.kind == VALUE:
        return jax.jit(volume)
    derivative = jax.value_and_grad if case.kind == GRADIENT else jax.hessian
    return jax.jit(jax.vmap(derivative(volume, (0, 1))))


def by_digits(points: Points, exact: dict[str, Exact], quick: bool) -> dict[Any, Program]:
    """The library by `Case`, SciPy by name and kind."""
    found: dict[Any, Program] = {}
    for dtype in DTYPES:
        for kind in KINDS[: 2 if quick else None]:
            count = len(points[0]) // (2 if kind == HESSIAN else 1)
            given = tuple(jnp.asarray(x[:count], dtype) for x in points)
            # A Hessian compiles for seconds, and what matters is seen from every other one.
            asked = ASKED[dtype][::-2][::-1] if kind == HESSIAN else ASKED[dtype][-2 if quick else 0 :]
            for case in (Case(kind, dtype, digits) for digits in asked):
                found[case] = Program(function(case), given, exact[dtype], ORDERS[kind])
    return found | scipy_programs.programs(points, exact["float64"], quick)


def digits(report: Report, quick: bool) -> Figure:
    """Time over error for all digits."""
    count, sample, rounds = (100_000, 64, 3) if quick else (200_000, 1000, 5)
    points = harness.bulk(count, sample)
    exact = {
        dtype: harness.exact_wear_volume(harness.head(points, sample, dtype), 1 if quick else 2) for dtype in DTYPES
    }
    found = harness.compared(by_digits(points, exact, quick), rounds)
    for kind in KINDS[: 2 if quick else None]:
        others = [(name, kind) for name in scipy_programs.VALUES if (name, kind) in found]
        rows = []
        for name in [name for name in found if isinstance(name, Case) and name.kind == kind] + others:
            ratios = (_times(found, other, name) for other in (() if name in others else others))
            rows.append([_told(name), *_time(found[name]), f"{_error(found, name):.1e}", *map(short, ratios)])
        columns = ["dtype, digits", "ns a point", "quartiles", "worst error", *(f"x {name}" for name, _ in others)]
        report.table(kind, columns, rows)
    report.print("Worst relative errors: of a value, and of the derivatives themselves. x: times faster than SciPy's.")
    report.print("\nThe value, for a page:\n")
    report.markdown(*_summary(found))
    return _over_errors(found)


def _told(name: Any) -> str:
    return str(name) if isinstance(name, Case) else f"SciPy: {name[0]}"


def _time(program: Compared) -> tuple[str, str]:
    return short(program.timing.median), program.timing.quartiles


def _times(found: Mapping[Any, Compared], slow: Any, fast: Any) -> float:
    """How many times longer `slow` takes, from rounds in which both ran."""
    return float(np.median(found[slow].timing.ns / found[fast].timing.ns))


def _error(found: Mapping[Any, Compared], name: Any) -> float:
    """The worst error of what a program is about: of its highest derivative."""
    return found[name].errors[max(found[name].errors)]


def _summary(found: dict[Any, Compared]) -> tuple[list[str], list[list[str]]]:
    """The value in few columns, for a page."""
    columns = ["digits"]
    for dtype in DTYPES:
        columns += [f"{dtype}: worst error", "ns a point"]
    rows = []
    for asked in (case.digits for case in found if isinstance(case, Case) and case[:2] == (VALUE, "float64")):
        row = [f"{asked or 'all'}"]
        for case in (Case(VALUE, dtype, asked) for dtype in DTYPES):
            row += [f"{_error(found, case):.0e}", short(found[case].timing.median)] if case in found else ["", ""]
        rows.append(row)
    return columns, rows


def _over_errors(found: Mapping[Any, Compared]) -> Figure:
    """Time a point over worst error."""
    points: dict[str, dict[str, tuple[float, float]]] = {kind: {} for kind in KINDS}
    for name, one in found.items():
        kind = name.kind if isinstance(name, Case) else name[1]
        points[kind][_told(name)] = _error(found, name), one.timing.median
    figure = harness.figure(6.4, 3.6)
    axes = figure.subplots(1, 3, sharex=True, sharey=True)
    for panel, (kind, programs) in zip(axes, points.items(), strict=False):
        for dtype, colour, line in zip(DTYPES, COLOURS, ("o-", "s--"), strict=False):
            own = {name.partition(", ")[2]: at for name, at in programs.items() if name.startswith(dtype)}
            panel.plot(*np.reshape([*own.values()], (-1, 2)).T, line, color=colour, markersize=3, lw=0.8,
                       label=f"plgwear {dtype}")  # fmt: skip
            labelled, shift = (("2", "4", "8", "all"), 5) if dtype == "float64" else (("2", "all"), -11)
            for asked in labelled:
                if asked in own:
                    panel.annotate(asked, own[asked], (0, shift), textcoords="offset points", ha="center", fontsize=7)
        for name, marker in zip(scipy_programs.VALUES, "s^", strict=True):
            if f"SciPy: {name}" in programs:
                panel.plot(*programs[f"SciPy: {name}"], marker, color="0.4", markersize=4, label=f"SciPy: {name}")
        panel.set(xscale="log", yscale="log", title=kind, xlabel="worst relative error")
    axes[0].set_ylabel("time per point on one core (ns)")
    axes[0].set_xlim(1e-16, 1.0)
    axes[0].set_ylim(bottom=0.35 * axes[0].dataLim.y0)  # room for the numbers of digits below
    figure.suptitle("wear_volume; at the points: the digits that are asked for", fontsize=8)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


# --- special functions ----------------------------------------------------------------------------------------------

LIBRARY = "plgwear"
# The functions, and how many points they get, of which the slowest takes half a second.
BETA = {
    "scipy betainc": (scipy_special.betainc, 100_000),
    "jax.scipy betainc": (jax_special.betainc, 100_000),
}
HYPER = {
    "scipy hyp2f1": (scipy_special.hyp2f1, 100_000),
    "jax.scipy hyp2f1": (jax_special.hyp2f1, 10_000),
}


def tail(y: jax.Array, s: jax.Array) -> jax.Array:
    return arcsine_tail(fold(y), s, 1.0 - s)[0]


def tail_by_beta(betainc: Callable[..., Any], y: Any, s: Any) -> Any:
    return betainc(1.0 - s, s, y / (1.0 + y))


def exact_tail(points: Points) -> Exact:
    def at(y: float, s: float) -> tuple[float, float]:
        x, p = mp.mpf(y) / (1 + mp.mpf(y)), mp.mpf(s)
        return harness.oracle.as_pairs(mp.betainc(1 - p, p, 0, x, regularized=True))

    with mp.workdps(50):
        return [np.array([at(float(y), float(s)) for y, s in zip(*points, strict=True)])[:, None]]


def disc_by_hypergeometric(hyp2f1: Callable[..., Any], r: Any, k: Any) -> Any:
    xp = jnp if isinstance(r, jax.Array) else np
    s, under = (1.0 + k) / 2.0, r <= 1.0
    outer = xp.where(under, 1.0, r)
    argument = xp.where(under, r, 1.0 / outer) ** 2
    factor = xp.where(under, 1.0, (1.0 - s) * outer ** (-2.0 * s))
    return factor * hyp2f1(xp.where(under, s - 1.0, s), s, xp.where(under, 1.0, 2.0), argument)


def exact_disc(points: Points) -> Exact:
    pairs = np.stack(points, 1).astype(float).tolist()
    return [np.array(harness.oracle.map_points("gross_steady_displacement", pairs, processes=1))[:, None]]


def kernels(report: Report, quick: bool) -> None:
    """Print times and errors of the arcsine tail, and of the displacement under a uniformly loaded disc."""
    count, sample, rounds = (100_000, 64, 3) if quick else (1_000_000, 1000, 15)
    rng, share = harness.generator(), 10 if quick else 1
    k = rng.uniform(-0.97, 0.97, count)
    asked = {
        "arcsine tail": (
            tail,
            tail_by_beta,
            BETA,
            (10.0 ** rng.uniform(-3.0, 3.0, count), (1.0 + k) / 2.0),
            exact_tail,
        ),
        "disc": (
            gross_slip.steady_displacement,
            disc_by_hypergeometric,
            HYPER,
            (rng.uniform(0.0, 3.0, count), k),
            exact_disc,
        ),
    }
    for title, (library, by, others, points, exact) in asked.items():
        truth, programs = {}, {}
        for dtype, name in zip(DTYPES, (LIBRARY, f"{LIBRARY} float32"), strict=True):
            truth[dtype] = exact(harness.head(points, sample, dtype))
            programs[name] = Program(jax.jit(library), [jnp.asarray(x, dtype) for x in points], truth[dtype])
        for name, (special, most) in others.items():
            few = harness.head(points, most // share)
            given = [jnp.asarray(x) for x in few] if name.startswith("jax") else few
            call = partial(by, special)
            programs[name] = Program(jax.jit(call) if name.startswith("jax") else call, given, truth["float64"])
        measured = harness.compared(programs, rounds)
        rows = []
        for name, program in measured.items():
            rows.append([name, *_time(program), f"{program.errors[0]:.1e}", short(_times(measured, name, LIBRARY))])
        report.table(title, ("program", "ns a point", "quartiles", "worst error", "x plgwear"), rows)
    report.print("Errors are relative; inf stands for a result that is no finite number. x: times as long as plgwear.")


# --- size -----------------------------------------------------------------------------------------------------------

MILLION = 1_000_000


def cost_over_size(sizes: list[int], counts: list[int]) -> dict[str, Any]:
    """Find the cells of both tables, the results of the last contacts, and how much of the core others used."""
    points, contacts, results = [], [], []
    for count in sizes:
        calls = {}
        for dtype in DTYPES:
            argument = jax.ShapeDtypeStruct((count,), dtype)
            compiled = jax.jit(fretting.wear_volume).lower(argument, argument).compile()
            k, phi = (jnp.resize(jnp.asarray(x, dtype), (count,)) for x in harness.bulk(min(count, MILLION), 0))
            calls[dtype] = partial(compiled, k, phi)
        taken = interleave(calls, 15 if count <= MILLION else 3)
        timings = [Timing(seconds / count * 1e9) for seconds in taken.values()]
        points.append([f"{short(one.median)} ({one.quartiles})" for one in timings])
    programs = {}
    for dtype in DTYPES:
        sample = harness.head(harness.bulk(200, 200), 200, dtype)
        programs[dtype] = Program(jax.jit(fretting.wear_volume), sample, harness.exact_wear_volume(sample, 1))
    points.append([f"{one.errors[0]:.0e}" for one in harness.compared(programs, 1).values()])

    contact = CASES["a table, steel"]
    steady = jax.jit(jax.vmap(jax.value_and_grad(lambda contact: contact.steady(1.0).wear_volume)))
    for count in counts:
        shares = np.linspace(0.98, 1.02, count)
        several = jax.tree.map(lambda x, by=shares: jnp.asarray(np.multiply.outer(by, x)), contact)
        begin = time.perf_counter()
        value, slopes = jax.block_until_ready(steady(several))
        first = time.perf_counter() - begin
        again = np.median(interleave({"": partial(steady, several)}, 3)[""])
        contacts.append([short(first), short(float(again) / count * 1e3)])
        results = [np.asarray(x).tolist() for x in (value, slopes.material.modulus)]
    return {"points": points, "contacts": contacts, "results": results, "others": harness.taken_by_others()}


def size(report: Report, quick: bool) -> None:
    """Print the time per point for rising numbers of points, and per contact for rising numbers of contacts."""
    sizes, counts = [10**n for n in (range(0, 7, 2) if quick else range(9))], [1, 100] if quick else [1, 100, 1000]
    places = {"one core": {"on": "1", "JAX_PLATFORMS": "cpu"}, "all cores": {"JAX_PLATFORMS": "cpu"}}
    places |= {name: {} for name in harness.accelerators()}
    found = {where: harness.in_new_process(cost_over_size, sizes, counts, **how) for where, how in places.items()}

    def table(title: str, what: str, lines: list[Any], kinds: Sequence[str]) -> None:
        columns = [what, *(f"{where}: {kind}" for where in found for kind in kinds)]
        cells = zip(lines, *(one[what] for one in found.values()), strict=True)
        report.table(title, columns, ([str(line), *itertools.chain(*of_each)] for line, *of_each in cells))

    title = "wear_volume, ns a point (quartiles), and errors at 200 points"
    table(title, "points", [*(f"{n:,}" for n in sizes), "worst error"], DTYPES)
    title = "Steady worn volume of tables of moduli under steel with its gradient, jit(vmap)"
    table(title, "contacts", counts, ("first, s", "again, ms a contact"))
    for where in list(found)[1:]:
        mine, exact = ([np.array(x) for x in found[at]["results"]] for at in (where, "one core"))
        report.print(f"{where}: value and slopes differ from those on one core by at most {worst(mine, exact)}")
    report.others = max(one["others"] for one in found.values())


PARTS = {
    "digits": Part("Speed against accuracy, one core", [digits]),
    "kernels": Part("Special functions, one core", [kernels]),
    "size": Part("Cost against size", [size]),
}

if __name__ == "__main__":
    harness.run(PARTS, [cost_over_size])
