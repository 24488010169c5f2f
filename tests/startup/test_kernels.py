"""What XLA makes of the closed forms: kernels, each a pass through memory, and instructions, which it has to compile.

The numbers are of the pinned JAX: they fail when somebody makes XLA compile much more. Each trick of `_core/xla.py`
is taken away in turn, and XLA must then make more of the same formula; one that does no good any more is to be removed.
"""

import functools
import itertools
import re
from typing import NamedTuple

import functions
import jax
import jax.numpy as jnp
import pytest
from inputs import ROOT
from marks import compiled, parametrize
from numpy.testing import assert_allclose
from processes import output

from plgwear_jax import fretting, gross_slip, material
from plgwear_jax._core import formula
from plgwear_jax.fretting import ring
from plgwear_jax.special import elementary

PINNED = re.search(r"^jax==(\S+)", (ROOT / "constraints.txt").read_text("utf-8"), re.MULTILINE)[1]
OF_PINNED = [
    pytest.mark.skipif(jax.__version__ != PINNED, reason=f"the numbers are those of JAX {PINNED}"),
    pytest.mark.skipif(jax.default_backend() != "cpu", reason="the numbers are those of a processor"),
]

pytestmark = OF_PINNED

AS_USERS_BUT_FOR_LLVM = functions.AS_USERS | {"xla_backend_optimization_level": 0}  # which comes after what is counted

LANES = itertools.count(23)  # of no other test: what was traced before knows no taken trick


class Size(NamedTuple):
    """Of a compiled program."""

    kernels: int
    instructions: int


def size_in(text):
    """The size of a program in words."""
    return Size(len(re.findall(r" fusion\(", text)), len(re.findall(r"^ .* = ", text, re.MULTILINE)))


@functools.cache
def plain_size(function, *ends):
    """The size with all tricks, always at the same length, so that it is compiled once."""
    return size_of(function, *ends, lanes=22)


def size_of(function, *ends, lanes):
    """The size for arrays that run between these ends."""
    at = (jnp.linspace(low, high, lanes) for low, high in ends)
    text = jax.jit(lambda *at: function(*at)).lower(*at).compile(compiler_options=AS_USERS_BUT_FOR_LLVM).as_text()
    entry = text[text.index("ENTRY") :]
    return size_in(text)._replace(kernels=size_in(entry).kernels)


K, PHI, R = (-0.5, 0.5), (0.1, 0.9), (0.2, 1.8)


def with_slope(k, phi):
    return jax.jvp(lambda k: fretting.wear_volume(k, phi), (k,), (jnp.ones_like(k),))


with_gradient = functools.partial(functions.with_gradient, fretting.wear_volume)


def along_two(k, phi):
    """Derivatives in two directions, as a Jacobian takes them."""
    one = jnp.ones_like(k)
    return [jax.jvp(fretting.worn_radius, (k, phi), (one, sign * one))[1] for sign in (1.0, -1.0)]


AT_MOST = {
    "wear volume": (fretting.wear_volume, (K, PHI), Size(3, 1500)),
    "wear volume, slope in k": (with_slope, (K, PHI), Size(5, 2200)),
    "wear volume, gradient": (with_gradient, (K, PHI), Size(6, 3050)),
    "worn radius": (fretting.worn_radius, (K, PHI), Size(4, 1550)),
    "deepest wear": (fretting.deepest_wear, (K, PHI), Size(5, 1500)),
    "steady displacement": (fretting.steady_displacement, (R, K, PHI), Size(8, 1050)),
    "worn punch": (gross_slip.steady_displacement, (R, K), Size(1, 1250)),
}


@parametrize("name", AT_MOST)
def test_a_program_grows_no_further(name):
    function, ends, most = AT_MOST[name]
    found = plain_size(function, *ends)
    assert found.kernels <= most.kernels and found.instructions <= most.instructions, found


TRICKS = {
    "separate kernels, within a result": (
        (ring, formula),
        "separate_kernels",
        lambda copy, *values: values,
        fretting.wear_volume,
    ),
    "separate kernels, between results": (
        (ring, formula),
        "separate_kernels",
        lambda copy, *values: values,
        with_gradient,
    ),
    "one kernel": ((formula,), "one_kernel", lambda one, other: (one, other), with_slope),
    "kept in register": ((elementary,), "kept_in_register", lambda ratio: ratio, fretting.wear_volume),
    "materialised": ((formula,), "materialised", lambda value: value, along_two),
}


@compiled
@parametrize("name", TRICKS)
def test_a_trick_still_does_good(monkeypatch, name):
    modules, trick, nothing, function = TRICKS[name]
    with_it = plain_size(function, K, PHI)
    for module in modules:
        monkeypatch.setattr(module, trick, nothing)
    without = size_of(function, K, PHI, lanes=next(LANES))
    assert without.kernels > 1.5 * with_it.kernels or without.instructions > 1.5 * with_it.instructions, (
        with_it,
        without,
    )


AT_TWO_NUMBERS = """
import jax, jax.numpy as jnp
from plgwear_jax import material
jax.config.update("jax_enable_x64", True)
k, nu = jnp.linspace(-0.5, 0.5, 1536), jnp.linspace(0.3, 0.4, 1536)
value, slope = jax.jit(lambda k, nu: jax.jvp(lambda k: material.h_N(k, nu), (k,), (jnp.ones_like(k),)))(k, nu)
print(value[0], slope[0])
"""


@compiled
def test_a_pair_is_compiled_where_a_register_holds_two_numbers():
    """Without what `one_kernel` does for LLVM this had not ended after seven minutes; it takes seconds."""
    # On ARM the flag says nothing, and is not needed.
    found = output("-c", AT_TWO_NUMBERS, limit=300.0, XLA_FLAGS="--xla_cpu_max_isa=SSE4_2")
    value, slope = jax.value_and_grad(material.h_N)(-0.5, 0.3)
    assert_allclose([float(x) for x in found.split()], [float(value), float(slope)], rtol=1e-12)
