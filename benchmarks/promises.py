"""Figures that the library promises and that users meet before accuracy or time: what is found, refused, and how large.

    python benchmarks/promises.py
    python benchmarks/promises.py designs rows --questions 150 --rows 2000

Runs with the library that is on the path, so that two states can be compared. Each program is a process of its own with
at most 14 GB and 3 minutes of the processor; times are seconds of the processor, of which imports take 2 to 3.
"""

import argparse
import os
import subprocess
import sys

BEFORE = """
import os, resource, time
resource.setrlimit(resource.RLIMIT_AS, (14 * 2**30,) * 2)
resource.setrlimit(resource.RLIMIT_CPU, (180, 180))
import numpy as np
import jax
import jax.numpy as jnp
from plgwear_jax import *
from plgwear_jax.loads import Displacement
from plgwear_jax import fitting, optimise, scene, sweep, wear_laws
jax.config.update("jax_enable_x64", True)
ball = FrettingContact(PowerLawGraded(110e9, 1e-4, 0.0, 0.3), 5e-3, 10.0, 0.4)
depths, moduli = 1e-6 * np.array([0.0, 1.0, 3.0, 10.0, 20.0, 50.0, 100.0, 200.0]), np.linspace(110e9, 240e9, 8)
K, N = 1e-14, 1e5
def show(what, ask, more=lambda: ""):
    try:
        said = " ".join(f"{x:.4g}" for x in np.ravel(np.asarray(ask())))
    except Exception as error:
        said = f"{type(error).__name__}: {error}"[:110]
    print(f"  {what:45s} {said} {more()}", flush=True)
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
show("possible, but called impossible", lambda: [wrong, asked])
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
def spent():
    return f"  {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20:.1f} GB, {time.process_time():.0f} s"
show(f"{ROWS} rows on a {'table' if TABLE else 'power law'}, {ASK}", asks[ASK], spent)
"""

GRADIENT = """
slopes = jax.grad(lambda contact: contact.over_cycles(2.0, K).volume(N))
taken = []
for share in (1.0, 1.01, 1.02):
    begin = time.perf_counter(), time.process_time()
    jax.block_until_ready(slopes(FrettingContact(DepthGraded(depths, share * moduli, 0.3), 5e-3, 10.0 * share, 0.4)))
    taken.append((time.perf_counter() - begin[0], time.process_time() - begin[1]))
show("gradient over cycles, OPENBLAS_NUM_THREADS=" + os.environ.get("OPENBLAS_NUM_THREADS", ""),
     lambda: np.array(taken).T, lambda: "s: three times by the clock, then of the processor")
"""

LIMITS = """
class Threshold(wear_laws.WearLaw):
    coefficient: float
    threshold: float
    def rate(self, pressure, slip):
        return self.coefficient * jnp.maximum(pressure - self.threshold, 0.0) * slip
def worn(load, cycles, law=K):
    return lambda: ball.over_cycles(load, law).volume(cycles)
show("Displacement(inf)", lambda: worn(Displacement(np.inf), N)())
show("beyond the widest scar, m^3", worn(Displacement(1e-5), 1e12))
show("phi = 1 - 3e-4, m^3", worn(4.0 * (1.0 - 3e-4), 1e9))
show("phi = 1 - 1e-8, m^3", worn(4.0 * (1.0 - 1e-8), 1e9))
show("nothing wears, m^3", worn(Displacement(1e-5), N, Threshold(K, 1e12)))
"""

FITS = """
cycles = np.array([6e5, 12e5, 40e5])
volume = np.asarray(ball.over_cycles(2.0, K).volume(cycles))
fit = lambda: fitting.fit_wear_coefficient(ball, 2.0, cycles, volume, 0.05 * volume).wear_coefficient
show("K of exact data of 1e-14 1/Pa", fit)
show("cycles to a depth of 0.02 um", lambda: ball.over_cycles(2.0, K).cycles_to(depth=2e-8))
"""

SLIP = """
import pathlib, tempfile
text = '''material = {{ E0 = 110e9, z0 = 1e-4, k = 0.0, nu = 0.3 }}
contact = {{ kind = "fretting", radius = 5e-3, normal_force = 10.0, friction = {} }}
load = {{ displacement = {} }}
wear = {{ coefficient = 1e-14, cycles = 1e5 }}'''
def read(friction, moved):
    file = pathlib.Path(tempfile.mkdtemp()) / "scene.toml"
    file.write_text(text.format(friction, moved))
    return scene.load(file)
def solved():
    try:
        return read(0.4, 5e-6).solve()
    except scene.SceneError as error:
        raise ValueError(str(error).partition("such sliding")[2]) from None
show("solve in gross slip", solved)
run = read(0.4, 5e-6).over_cycles()
show("wear of it: first rate, volume/cycles, m^3", lambda: [run.rate(0.0), run.volume(N) / N])
given = {"contact": ball, "displacement": 4e-7, "friction": (0.15, 0.4), "wear_coefficient": K, "cycles": N}
show("sweep, friction 0.15 and 0.4, m^3", lambda: sweep.sweep("transient.wear_volume", **given).transient_wear_volume)
show("wear of these, m^3", lambda: [read(f, 4e-7).over_cycles().volume(N) for f in (0.15, 0.4)])
"""


def programs(asked: argparse.Namespace) -> dict[str, list[tuple[str, dict[str, str]]]]:
    """Those of each table, with what they want of the environment."""
    asks = "volume", "deepest wear", "energy", "pressure", "initial pressure", "profile", "volume over cycles"
    rows = [
        f"ROWS, TABLE, ASK = {count}, {table}, {ask!r}\n{ROWS}"
        for count in asked.rows
        for table in (False, True)
        for ask in asks
    ]
    return {
        "designs": [(f"QUESTIONS = {asked.questions}\n{DESIGNS}", {})],
        "limits": [(LIMITS, {})],
        "rows": [(program, {}) for program in rows],
        "threads": [(GRADIENT, {}), (GRADIENT, {"OPENBLAS_NUM_THREADS": "1"})],
        "fits": [(FITS, {})],
        "slip": [(SLIP, {})],
    }


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("tables", nargs="*", help="of: designs, limits, rows, threads, fits, slip; by default all")
    parser.add_argument("--questions", type=int, default=150, help="how many designs are asked for")
    parser.add_argument("--rows", type=int, nargs="+", default=[121, 401, 2000], help="of a table of heights")
    asked = parser.parse_args()
    tables = programs(asked)
    for name in asked.tables or tables:
        print(f"\n{name}", flush=True)
        for program, more in tables[name]:
            command = [sys.executable, "-W", "ignore", "-c", BEFORE + program]
            ran = subprocess.run(command, env=os.environ | more, stderr=subprocess.PIPE, text=True, check=False)
            if ran.returncode:
                why = ran.stderr.strip().splitlines()[-1:] or ["too long"]
                print(f"  {program.partition(chr(10))[0]:45s} ended with {ran.returncode}: {why[0][:120]}", flush=True)


if __name__ == "__main__":
    main()
