"""How much of the package an answer takes: operations that JAX traces, and functions that are entered on the way.

    python tools/operations.py

prints, in half a minute, the operations of a steady state of a table of moduli under steel, of its value with its
gradient, and of the same over cycles; and how many functions of the package are entered from a modulus in an input file
to the worn volume that is printed, by the steady state of that table in Python, and from the exponent in a design for a
life to its best value. XLA is not asked to compile any of the first three.
"""

import contextlib
import io
import itertools
import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp

import plgwear_jax
from plgwear_jax import DepthGraded, Elastic, FrettingContact
from plgwear_jax.cli import main

jax.config.update("jax_enable_x64", True)

os.environ["PLGWEAR_NO_CACHE"] = "1"
PACKAGE = str(Path(plgwear_jax.__file__).parent)
SCENE = """
[material]
E0 = 200e9
z0 = 1e-4
k = 0.1
nu = 0.25

[contact]
kind = "fretting"
radius = 0.0125
normal_force = 50.0
friction = 0.6

[load]
tangential_force = 22.0
"""
LIFE = """
[wear]
coefficient_mm3_per_N_m = 3e-5
cycles = 1e5

[design]
vary = { k = [-0.9, 0.9] }
hold = "contact_radius"
minimise = "wear_volume"
"""


def contact(moduli: Any) -> FrettingContact:
    """A ball of steel on a table of moduli."""
    coating = DepthGraded(jnp.array([0.0, 1e-5, 1e-4, 1e-3]), moduli, 0.3)
    return FrettingContact(coating, 5e-3, 10.0, 0.4, indenter=Elastic(210e9, 0.3))


def steady(moduli: Any) -> Any:
    """The worn volume in the end."""
    return contact(moduli).steady(1.2).wear_volume


def over_cycles(moduli: Any) -> Any:
    """The worn volume after some cycles."""
    return contact(moduli).over_cycles(1.2, 1e-13).volume(1e5)


def operations(jaxpr: Any) -> int:
    """All operations of a program, with those within others."""
    leaves = [jax.tree.leaves(list(one.params.values()), is_leaf=_is) for one in jaxpr.eqns]
    inner = [getattr(each, "jaxpr", each) for each in itertools.chain(*leaves) if _is(each)]
    return len(jaxpr.eqns) + sum(map(operations, inner))


def _is(value: Any) -> bool:
    return hasattr(value, "eqns") or hasattr(getattr(value, "jaxpr", None), "eqns")


def entered(ask: Callable[[], Any]) -> int:
    """How many functions of the package are entered by a question."""
    found: set[tuple[str, int]] = set()

    def note(frame: Any, event: str, argument: Any) -> None:
        del argument
        code = frame.f_code
        if event == "call" and code.co_filename.startswith(PACKAGE) and not code.co_name.startswith("<"):
            found.add((code.co_filename, code.co_firstlineno))

    sys.setprofile(note)
    try:
        ask()
    finally:
        sys.setprofile(None)
    return len(found)


def command(name: str, scene: str) -> None:
    """A command on an input file, whose answer is not shown."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        Path("scene.toml").write_text(scene)
        sys.argv = ["plgwear", name, "scene.toml"]
        with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(SystemExit):
            main()


if __name__ == "__main__":
    moduli = jnp.array([1e11, 1.2e11, 1.5e11, 2e11])
    functions = steady, jax.value_and_grad(steady), jax.value_and_grad(over_cycles)
    for told, function in zip(("value", "value and gradient", "the same over cycles"), functions, strict=True):
        print(f"operations traced, {told}: {operations(jax.make_jaxpr(function)(moduli).jaxpr):,}")
    jax.clear_caches()
    asked = {
        "steady state of a table": lambda: steady(moduli),
        "a modulus in an input file to the printed volume": lambda: command("solve", SCENE),
        "k in a design for a life": lambda: command("design", SCENE + LIFE),
    }
    for told, ask in asked.items():
        print(f"functions entered, {told}: {entered(ask)}")
