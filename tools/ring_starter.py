"""The coefficients of `fretting.ring._ring_starter`: a least-squares fit, reweighted to reduce the largest error.

    python tools/ring_starter.py

w in the starter's docstring goes from (1+q)/((1+s) (2+q)) to 1. The fraction of the way is fitted by

    v (c_0 + c_1 s + e (c_2 + c_3 s) + v (c_4 + c_5 s + e (c_6 + c_7 s))),   v = 1 - sqrt(1-phi),  e = 1 - (1-phi)^s,

over all exponents and amplitudes, up to the edges of both. The weighted errors are those of y, relative to y.
"""

import jax
import numpy as np

from plgwear_jax import fretting

ROUNDS = 300


def points(count: int) -> tuple[np.ndarray, np.ndarray]:
    """k and phi: uniform, and towards every edge."""
    rng = np.random.default_rng(1)
    distance = 10.0 ** -rng.uniform(0.0, 6.0, count)
    middle = rng.uniform(-1, 1, count)
    k = np.choose(np.arange(count) % 4, [middle, middle, distance - 1, 1 - distance])
    odds = 10.0 ** np.where(rng.random(count) < 0.5, rng.uniform(-3, 3, count), rng.uniform(-1, 15, count))
    return np.clip(k, -1 + 1e-6, 1 - 1e-6), odds / (1 + odds)


def fit(count: int = 40_000) -> tuple[np.ndarray, float]:
    """(coefficients, largest relative error of y)."""
    k, phi = points(count)
    s, q = (1 + k) / 2, (1 - k) / 2
    c, a = np.asarray(fretting.stick_radius(k, phi)), np.asarray(fretting.worn_radius(k, phi))
    y = (a - c) / c * (a + c) / c
    load = phi / ((1 - phi) * (1 + s))
    e = -np.expm1(s * np.log1p(-phi))
    narrow, v = (1 + q) / ((1 + s) * (2 + q)), 1 - np.sqrt(1 - phi)

    # y/load = 1 + q + q^2 e/s (narrow + (1 - narrow) way)
    slope = q * q * e / s * (1 - narrow) * load / y
    goal = (y / load - 1 - q - q * q * e / s * narrow) * load / y
    basis = np.stack([v ** (1 + i) * e**j * s**n for i in (0, 1) for j in (0, 1) for n in (0, 1)], axis=1)
    matrix, weights = basis * slope[:, None], np.ones(count)
    best = (np.zeros(8), np.inf)
    for _ in range(ROUNDS):
        coefficients = np.linalg.lstsq(matrix * weights[:, None], goal * weights, rcond=None)[0]
        error = np.abs(matrix @ coefficients - goal)
        if error.max() < best[1]:
            best = coefficients, float(error.max())
        weights *= np.sqrt(error / error.max() + 0.05)
        weights = np.maximum(weights / weights.max(), 1e-4)
    return best


def main() -> None:
    jax.config.update("jax_enable_x64", True)
    coefficients, error = fit()
    print("_WAY = (" + ", ".join(f"{c:.4f}" for c in coefficients) + ")")
    print(f"# largest error of y: {error:.1e} of it")


if __name__ == "__main__":
    main()
