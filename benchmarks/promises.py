"""Figures that the library promises and that users meet before accuracy or time: what is found, refused, and how large.

    python benchmarks/promises.py
    python benchmarks/promises.py designs rows --questions 150 --rows 2000

Runs with the library that is on the path, so that two states can be compared. Each row is a process of its own on all
cores, with at most 14 GB and 3 minutes; times are seconds of the processor, of which the imports take 2 to 3.
"""

import argparse
import os
import subprocess
import sys

BEFORE = """
import resource, time
resource.setrlimit(resource.RLIMIT_AS, (14 * 2**30,) * 2)
import numpy as np
import jax
import jax.numpy as jnp
from plgwear_jax import *
from plgwear_jax import fitting, optimise, scene, sweep, wear_laws
jax.config.update("jax_enable_x64", True)
ball = FrettingContact(PowerLawGraded(110e9, 1e-4, 0.0, 0.3), 5e-3, 10.0, 0.4)
depths, moduli = 1e-6 * np.array([0.0, 1.0, 3.0, 10.0, 20.0, 50.0, 100.0, 200.0]), np.linspace(110e9, 240e9, 8)
K, N = 1e-14, 1e5
def told(ask):
    try:
        return " ".join(f"{x:.4g}" for x in np.ravel(np.asarray(ask())))
    except Exception as error:
        return f"{type(error).__name__}: {error}"[:110]
"""

DESIGNS = """
rng, wrong, asked = np.random.default_rng(1), 0, 0
names = "worn_radius", "deepest_wear", "penetration", "stick_radius", "contact_radius", "edge_intensity"
while asked < QUESTIONS:
    material = PowerLawGraded(10 ** rng.uniform(9.5, 11.5), 10 ** rng.uniform(-5, -3), 0.0, rng.uniform(0.0, 0.49))
    one = FrettingContact(material, 10 ** rng.uniform(-3, -1), 10 ** rng.uniform(0, 2), rng.uniform(0.1, 0.9))
    force, width = float(rng.uniform(0.01, 0.99)) * one.friction * one.normal_force, 10 ** rng.uniform(-1.7, 0.25)
    low, above, name = rng.uniform(-0.95, 0.95 - width), bool(rng.integers(2)), str(rng.choice(names))
    k = np.linspace(low, low + width, 2001)
    value = np.asarray(getattr(FrettingContact(PowerLawGraded(material.E0, material.z0, k, material.nu), one.radius,
                                               one.normal_force, one.friction).steady(force), name))
    share = 10 ** rng.uniform(-3, -0.3)
    allowed = float(np.quantile(value, 1.0 - share if above else share))
    limits = {name: {"above" if above else "below": allowed}}
    found = optimise.design(one, force, {"k": (low, low + width)}, limits=limits)
    reached = float(getattr(found.contact.steady(force), name)) / allowed - 1.0
    wrong, asked = wrong + ((-reached if above else reached) > 1e-6), asked + 1
print(f"{wrong} of {asked}")
"""

ROWS = """
r = np.linspace(0.0, 1.5e-4, ROWS)
shape = Profile(r, r**2 / 1e-2 * (1.0 + 0.1 * (r / 1e-4) ** 2))
material = DepthGraded(depths[1:], moduli[1:], 0.3) if TABLE else PowerLawGraded(110e9, 1e-4, 0.1, 0.3)
one, x = FrettingContact(material, 5e-3, 10.0, 0.4, shape=shape), np.linspace(1e-6, 1e-4, 100)
steady, run = one.steady(1.6), one.over_cycles(1.6, K)
asks = {
    "volume": lambda: steady.wear_volume,
    "deepest wear": lambda: steady.deepest_wear,
    "energy": lambda: steady.energy_per_cycle,
    "pressure": lambda: steady.pressure(x)[50],
    "initial pressure": lambda: steady.initial_pressure(x)[50],
    "profile": lambda: steady.profile(x)[60],
    "volume over cycles": lambda: run.volume(N),
}
value = told(asks[ASK])
memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
print(f"{value}   {memory:.1f} GB, {time.process_time():.0f} s")
"""

GRADIENT = """
slopes = jax.grad(lambda contact: contact.over_cycles(2.0, K).volume(N))
taken = []
for share in (1.0, 1.01, 1.02):
    begin = time.perf_counter(), time.process_time()
    jax.block_until_ready(slopes(FrettingContact(DepthGraded(depths, share * moduli, 0.3), 5e-3, 10.0 * share, 0.4)))
    taken.append((time.perf_counter() - begin[0], time.process_time() - begin[1]))
print("first, second, third:", *(f"{wall:.1f} ({processor:.1f})" for wall, processor in taken), "s (of the processor)")
"""

NOTHING = """
class Threshold(wear_laws.WearLaw):
    coefficient: float
    threshold: float
    def rate(self, pressure, slip):
        return self.coefficient * jnp.maximum(pressure - self.threshold, 0.0) * slip
"""

FIT = """
cycles = np.array([6e5, 12e5, 40e5])
volume = np.asarray(ball.over_cycles(2.0, K).volume(cycles))
"""

SCENE = """
text = '''material = {{ E0 = 110e9, z0 = 1e-4, k = 0.0, nu = 0.3 }}
contact = {{ kind = "fretting", radius = 5e-3, normal_force = 10.0, friction = {} }}
load = {{ displacement = {} }}
wear = {{ coefficient = 1e-14, cycles = 1e5 }}'''
import pathlib, tempfile
def read(friction, moved):
    file = pathlib.Path(tempfile.mkdtemp()) / "scene.toml"
    file.write_text(text.format(friction, moved))
    return scene.load(file)
def solved():
    try:
        return read(0.4, 5e-6).solve()
    except scene.SceneError as error:
        raise ValueError(str(error).partition("such sliding")[2]) from None
sweeps = lambda: sweep.sweep("transient.wear_volume", contact=ball, displacement=4e-7,
    friction=(0.15, 0.4), wear_coefficient=K, cycles=N).transient_wear_volume
"""


def rows_of(asked: argparse.Namespace) -> dict[str, list[tuple[str, str, dict[str, str]]]]:
    """The rows of each table: (what, program, variables of the environment)."""
    one, none = {"OPENBLAS_NUM_THREADS": "1"}, dict[str, str]()
    tables = [(count, table) for count in asked.rows for table in (False, True)]
    asks = "volume", "deepest wear", "energy", "pressure", "initial pressure", "profile", "volume over cycles"
    near = "ball.over_cycles((1.0 - {}) * 4.0, K).volume(1e9)"
    return {
        "designs": [("possible, but called impossible", f"QUESTIONS = {asked.questions}\n{DESIGNS}", none)],
        "limits": [
            ("nothing wears, m^3", f"{NOTHING}print(told(lambda: ball.over_cycles(2.0, Threshold(K, 1e12)).volume(N)))", none),
            *((f"1 - phi = {x}, m^3", f"print(told(lambda: {near.format(x)}))", none) for x in ("3e-4", "1e-8")),
            ("Displacement(inf)", "print(told(lambda: ball.over_cycles(Displacement(np.inf), K).volume(N)))", none),
            ("beyond the widest scar", "print(told(lambda: ball.over_cycles(Displacement(1e-5), K).volume(1e12)))", none),
        ],
        "rows": [
            (f"{count} rows on a {'table' if table else 'power law'}, {ask}", f"ROWS, TABLE, ASK = {count}, {table}, {ask!r}\n{ROWS}", none)
            for count, table in tables for ask in asks
        ],
        "threads": [("gradient over cycles", GRADIENT, none), ("OPENBLAS_NUM_THREADS=1", GRADIENT, one)],
        "fits": [
            ("K of exact data of 1e-14, 1/Pa", f"{FIT}print(told(lambda: fitting.fit_wear_coefficient(ball, 2.0, cycles, volume, 0.05 * volume).wear_coefficient))", none),
            ("cycles to 0.1 um", "print(told(lambda: ball.over_cycles(2.0, K).cycles_to(depth=1e-7)))", none),
        ],
        "gross slip": [
            ("solve", f"{SCENE}print(told(solved))", none),
            ("wear: rate, volume/cycles, m^3", f"{SCENE}run = read(0.4, 5e-6).over_cycles(); print(told(lambda: [run.rate(0.0), run.volume(N) / N]))", none),
            ("sweep, friction 0.15 and 0.4, m^3", f"{SCENE}print(told(sweeps))", none),
            ("wear of the same, m^3", f"{SCENE}print(told(lambda: [read(f, 4e-7).over_cycles().volume(N) for f in (0.15, 0.4)]))", none),
        ],
    }  # fmt: skip


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument(
        "tables", nargs="*", help="of: designs, limits, rows, threads, fits, gross slip; by default all"
    )
    parser.add_argument("--questions", type=int, default=150, help="how many designs are asked for")
    parser.add_argument("--rows", type=int, nargs="+", default=[121, 401, 2000], help="of a table of heights")
    asked = parser.parse_args()
    tables = rows_of(asked)
    for name in asked.tables or tables:
        print(f"\n{name}", flush=True)
        for what, program, more in tables[name]:
            command = [sys.executable, "-W", "ignore", "-c", BEFORE + program]
            try:
                ran = subprocess.run(command, env=os.environ | more, capture_output=True, text=True, timeout=180)
                said = (ran.stdout or ran.stderr).strip().splitlines() or [f"ended with {ran.returncode}"]
            except subprocess.TimeoutExpired:
                said = ["more than 3 minutes"]
            print(f"  {what:45s} {said[-1][:150]}", flush=True)


if __name__ == "__main__":
    main()
