"""The coefficients of `fretting.deepest._deepest_starter`: a least-squares fit, reweighted to reduce the largest error.

    python tools/deepest_starter.py

The first approximation of y, too large near phi = 1, is divided by
1 + s^2 q (c_0 + c_1 s) w^2, w = y/(y + c_2 + c_3 s).
The weighted errors are those of y, relative to y; q H(y) = y (q + s (1+y) 2F1(1, q; 1+q; -y)) gives the load of each y.
"""

import numpy as np
from scipy import optimize, special

ROUNDS = 200
FIRST = (0.14, -0.05, 2.3, -1.6)


def fit() -> tuple[np.ndarray, float]:
    """(coefficients, largest relative error of y)."""
    near = 10.0 ** -np.arange(3.0, 7.0)
    s, y = np.meshgrid(np.concatenate([near, np.linspace(0.002, 0.998, 120), 1 - near]), np.logspace(-3, 16, 200))
    q = 1 - s
    load = y * (q + s * (1 + y) * special.hyp2f1(1, q, 1 + q, -y))
    scale = 0.5 * (1 + q)
    start = scale * np.expm1(np.log1p((1 + s) * load / scale) / (1 + s))

    def errors(c: np.ndarray) -> np.ndarray:
        way = start / (start + c[2] + c[3] * s)
        return start / (1 + s * s * q * (c[0] + c[1] * s) * way * way) / y - 1

    best, at, weights = (np.zeros(4), np.inf), np.array(FIRST), np.ones(s.shape)
    for _ in range(ROUNDS):
        at = optimize.least_squares(lambda c: (weights * errors(c)).ravel(), at, method="lm").x  # noqa: B023
        error = np.abs(errors(at))
        if error.max() < best[1]:
            best = at, float(error.max())
        weights *= np.sqrt(error / error.max() + 0.05)
        weights = np.maximum(weights / weights.max(), 1e-4)
    return best


def main() -> None:
    coefficients, error = fit()
    print("_LATE = (" + ", ".join(f"{c:.4f}" for c in coefficients) + ")")
    print(f"# largest error of y: {error:.1e} of it")


if __name__ == "__main__":
    main()
