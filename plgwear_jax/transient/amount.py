"""Worn volume and wear rate after n reduced cycles, and the cycles after which a share of the volume is worn."""

import jax
import jax.numpy as jnp
from jax import Array

from plgwear_jax._core.domains import AMPLITUDE, CYCLES, EXPONENT, SHARE, ArrayLike
from plgwear_jax._core.formula import ruled
from plgwear_jax._startup.programs import program
from plgwear_jax.partial_slip import SOFTNESS
from plgwear_jax.special.elementary import at_least
from plgwear_jax.special.root import first_at
from plgwear_jax.transient.batch import run_numbers
from plgwear_jax.transient.curves import RunCurves, end_of, share_at
from plgwear_jax.transient.held_displacement import curves_under


@program()
def volume_of(curves: RunCurves, k: Array, phi: Array, n: Array) -> Array:
    """The worn volume after n reduced cycles, read from the runs of all k and phi."""
    run = run_numbers(k, phi)
    return jnp.where(
        phi > 0.0, curves.scales.volume[run] * share_at(curves.shares, run, n), 0.0 * phi
    )  # NaN where phi is


@program()
def rate_of(curves: RunCurves, k: Array, phi: Array, n: Array) -> Array:
    """The wear rate dV/dn at n, read from the runs of all k and phi."""
    n = jnp.broadcast_to(n, jnp.broadcast_shapes(k.shape, phi.shape, n.shape))
    return at_least(0.0, jax.jvp(lambda n: volume_of(curves, k, phi, n), (n,), (jnp.ones_like(n),))[1])


@ruled(k=EXPONENT, phi=AMPLITUDE, n=CYCLES, compliance=SOFTNESS)
def wear_volume(
    k: ArrayLike,
    phi: ArrayLike,
    n: ArrayLike,
    *,
    control: str = "force",
    compliance: ArrayLike = 0.0,
    digits: int | None = None,
) -> Array:
    """Volume worn off the indenter in n reduced cycles.

    Each pair of k and phi takes one run of the transient, whatever the number of n in a call.

    Args:
        k: Exponent of the modulus, -1 < k < 1; accurate for abs(k) < 0.97.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1; accurate for 0.005 <= phi <= 0.99.
        n: Reduced cycles, n >= 0 and finite.
        control: Which amplitude is constant, that of the "force" or of the "displacement"; phi holds before any wear.
        compliance: Rig compliance X of `partial_slip.displacement_amplitude`, X >= 0; 0 without a rig in series.
        digits: The error is below 10^-digits of the final volume: 2 to 5, by default 4. Under displacement control
            2. One digit is computed as two. Between phi = 0.99 and 1 - 1e-8 it is up to 2.5 times as large.

    Returns:
        The volume in units of a_0^4/R, broadcast over all arguments: it grows from 0 to `fretting.wear_volume`.

    Raises:
        ValueError: A concrete argument, or `digits`, is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import fretting, transient
        >>> print(f"{transient.wear_volume(0.0, 0.5, 5.0) / fretting.wear_volume(0.0, 0.5):.3f}")
        0.843

    References:
        `docs/explanation/theory.md`, "Wear over cycles". The wear law: Archard, Journal of Applied Physics 24 (1953)
        981.
    """
    k, phi, n = jnp.asarray(k), jnp.asarray(phi), jnp.asarray(n)
    curves, phi = curves_under(control, k, phi, jnp.asarray(compliance), digits)
    return volume_of(curves, k, phi, n)


@ruled(k=EXPONENT, phi=AMPLITUDE, n=CYCLES, compliance=SOFTNESS)
def wear_rate(
    k: ArrayLike,
    phi: ArrayLike,
    n: ArrayLike,
    *,
    control: str = "force",
    compliance: ArrayLike = 0.0,
    digits: int | None = None,
) -> Array:
    """Volume worn off per reduced cycle after n reduced cycles: the slope dV/dn of `wear_volume`.

    Args:
        k: Exponent of the modulus, -1 < k < 1; accurate for abs(k) < 0.97.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1; accurate for 0.005 <= phi <= 0.99.
        n: Reduced cycles, n >= 0 and finite.
        control: Which amplitude is constant, that of the "force" or of the "displacement"; phi holds before any wear.
        compliance: Rig compliance X of `partial_slip.displacement_amplitude`, X >= 0; 0 without a rig in series.
        digits: See `wear_volume`. Measured at 4 digits the error is below 5e-3 of the first rate, mostly 5e-4.

    Returns:
        The rate in units of a_0^4/R, broadcast over all arguments.

    Raises:
        ValueError: A concrete argument, or `digits`, is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import transient
        >>> print(f"{transient.wear_rate(0.3, 0.4, 1.0):.3f}")
        0.009

    References:
        `docs/explanation/theory.md`, "Wear over cycles".
    """
    k, phi, n = jnp.asarray(k), jnp.asarray(phi), jnp.asarray(n)
    curves, phi = curves_under(control, k, phi, jnp.asarray(compliance), digits)
    return rate_of(curves, k, phi, n)


@program()
def cycles_of(curves: RunCurves, k: Array, phi: Array, share: Array) -> Array:
    """The reduced cycles n after which a share of the final volume is worn, read from the runs of all k and phi."""
    run = run_numbers(k, phi)
    found = first_at(lambda shares, n: share_at(shares, run, n), curves.shares, share, end_of(curves, run))
    return jnp.where(phi > 0.0, found, jnp.nan)


@ruled(k=EXPONENT, phi=AMPLITUDE, share=SHARE, compliance=SOFTNESS)
def cycles(
    k: ArrayLike,
    phi: ArrayLike,
    share: ArrayLike,
    *,
    control: str = "force",
    compliance: ArrayLike = 0.0,
    digits: int | None = None,
) -> Array:
    """Reduced cycles after which a share of the final volume is worn: the inverse of `wear_volume`.

    Args:
        k: Exponent of the modulus, -1 < k < 1; accurate for abs(k) < 0.97.
        phi: Amplitude F_x/(mu F_N), 0 <= phi < 1; accurate for 0.005 <= phi <= 0.99.
        share: Share of the final volume, 0 <= share < 1.
        control: Which amplitude is constant, that of the "force" or of the "displacement"; phi holds before any wear.
        compliance: Rig compliance X of `partial_slip.displacement_amplitude`, X >= 0; 0 without a rig in series.
        digits: See `wear_volume`. If 1 - share is below that accuracy, only the order of magnitude of n is right.

    Returns:
        n, broadcast over all arguments; NaN at phi = 0, where nothing wears.

    Raises:
        ValueError: A concrete argument, or `digits`, is outside its range. Under `jit` the result is NaN there.

    Examples:
        >>> from plgwear_jax import transient
        >>> print(f"{transient.cycles(0.3, 0.4, 0.5):.3f}")
        3.071

    References:
        `docs/explanation/theory.md`, "Wear over cycles".
    """
    k, phi, share = jnp.asarray(k), jnp.asarray(phi), jnp.asarray(share)
    curves, phi = curves_under(control, k, phi, jnp.asarray(compliance), digits)
    return cycles_of(curves, k, phi, share)
