"""Stresses in a layered half-space by brute force: 4x4 matrices up the layers, and integrals over all wavenumbers.

Shares no code and no idea with the library but the plane-strain equations: a basis of the solutions that decay with the
depth goes upwards by matrix exponentials, made orthonormal after each layer; Bessel functions are those of SciPy.
"""

import numpy as np
from scipy.special import gamma, jv


def _rates(xi, modulus, nu):
    """The matrix of (U, W, T, S)' for each wavenumber, with U and W times a modulus of 1."""
    mu, lame = modulus / (2 + 2 * nu), modulus * nu / ((1 + nu) * (1 - 2 * nu))
    g = lame + 2 * mu
    m = np.zeros((xi.size, 4, 4))
    m[:, 0, 1], m[:, 0, 2] = xi, 1 / mu
    m[:, 1, 0], m[:, 1, 3] = -lame * xi / g, 1 / g
    m[:, 2, 0], m[:, 2, 3] = 4 * mu * (lame + mu) / g * xi**2, lame * xi / g
    m[:, 3, 2] = -xi
    return m


def _upwards(m, xi, h):
    """exp(-m h) exp(-xi h), as (m^2 - xi^2)^2 = 0."""
    one, x = np.eye(4), (xi * h)[:, None, None]
    xi = xi[:, None, None]
    n = m @ m - xi**2 * one
    down = np.exp(-2 * x)
    cosh, sinh = 0.5 * (1 + down), 0.5 * (1 - down)
    even = cosh * one + n * (h * sinh / (2 * xi))
    odd = sinh / xi * one + n * (h * cosh / (2 * xi**2) - sinh / (2 * xi**3))
    return even - m @ odd


def responses(xi, z, tops, moduli, nu, own=None):
    """(A, B, S, T) of n and of t, (G, tau) of h at one depth, each an array over xi.

    Args:
        xi: Wavenumbers, (n,).
        z: A depth.
        tops: The depth at which each layer begins, the first one 0.
        moduli: Young's modulus of each.
        nu: Poisson's ratio, below 1/2.
        own: Young's modulus at the depth itself, where layers stand for one that varies.
    """
    if xi.size > 200:  # at once, the matrices of all would take much memory
        parts = [responses(q, z, tops, moduli, nu, own) for q in np.array_split(xi, 1 + xi.size // 200)]
        return [np.concatenate(rows) for rows in zip(*parts, strict=True)]
    tops, moduli = np.asarray(tops, float), np.asarray(moduli, float)
    place = max(np.searchsorted(tops, z, side="right") - 1, 0)
    tops = np.concatenate([tops[: place + 1], [z], tops[place + 1 :]])
    moduli = np.concatenate([moduli[: place + 1], moduli[place:]])
    # The decaying solutions below: of m with the eigenvalue -xi, which is double.
    m = _rates(xi, moduli[-1], nu)
    square = (m - xi[:, None, None] * np.eye(4)) @ (m - xi[:, None, None] * np.eye(4))
    basis = np.linalg.svd(square)[0][:, :, :2]
    there, compliance = basis, 0.0
    across, chain, shares = -1.0 / moduli[-1] * np.ones_like(xi), np.zeros((xi.size, 2, 2)), 0.0
    for i in range(len(tops) - 2, -1, -1):
        h = tops[i + 1] - tops[i]
        if i == place:  # at the depth z
            there, chain, shares, compliance = basis, np.broadcast_to(np.eye(2), (xi.size, 2, 2)), 1.0, across
        basis, back = np.linalg.qr(_upwards(_rates(xi, moduli[i], nu), xi, h) @ basis)
        # Across the wave V = H tau over the shear modulus of 1/(2 (1 + nu)), with exponentials.
        y = across * moduli[i]
        turned = np.exp(-2 * xi * h) * (1 + y) / (1 - y)
        across = (turned - 1) / (turned + 1) / moduli[i]
        if i <= place:
            chain = chain @ (np.linalg.inv(back) * np.exp(-xi * h)[:, None, None])
            shares = shares * 2 * np.exp(-xi * h) / ((1 - y) * (1 + turned))
    modulus = moduli[place + 1] if own is None else own
    mu, lame = modulus / (2 + 2 * nu), modulus * nu / ((1 + nu) * (1 - 2 * nu))
    g, found = lame + 2 * mu, []
    for tractions in ([0.0, 1.0], [1.0, 0.0]):
        right = np.broadcast_to(tractions, (xi.size, 2))[..., None]
        u, _, t, s = (there @ chain @ np.linalg.solve(basis[:, 2:], right))[..., 0].T
        along = 4 * mu * (lame + mu) / g * xi * u
        found += [lame * s / g + along, lame * s / g + 2 * mu * lame / g * xi * u, s, t]
    return [*found, modulus * compliance * shares, shares * np.ones_like(xi)]


def bowl(m, a):
    """The transform of (1 - (r/a)^2)^m."""
    return lambda xi: 2**m * gamma(m + 1) * jv(m + 1, xi * a) / (xi * a) ** (m + 1) * a * a


def transform(r, weight, pressure):
    """The transform of pressures at radii of a rule of integration."""
    return lambda xi: np.concatenate(
        [jv(0, np.outer(part, r)) @ (weight * pressure * r) for part in np.array_split(xi, 20)]
    )


def stresses(p, q, respond, x, z, most, scale=1.0):
    """(xx, yy, zz, xz) at one depth and places x, under the pressure and the traction with the transforms p and q."""
    edges = np.concatenate([np.geomspace(1e-5, 0.5, 25), np.arange(1.0, most, 2.0)])
    node, weight = np.polynomial.legendre.leggauss(6)
    half = 0.5 * np.diff(np.append(0.0, edges))
    xi = ((np.append(0.0, edges[:-1]) + half)[:, None] + half[:, None] * node).ravel() / scale
    weight = (half[:, None] * weight).ravel() / scale * np.exp(-((xi * scale / (0.5 * most)) ** 6))
    an, bn, sn, tn, at, bt, st, tt, g, tau = respond(xi, z)
    p, q, found = xi * p(xi) * weight, xi * q(xi) * weight, []
    for place in np.atleast_1d(x):
        j0, j1, j2, j3 = (jv(i, xi * abs(place)) for i in range(4))
        sign = np.sign(place)
        found.append(
            [
                -p @ (an * (j0 - j2) / 2 + bn * (j0 + j2) / 2)
                + sign * q @ (at * (3 * j1 - j3) / 4 + bt * (j1 + j3) / 4 + g * (j1 + j3) / 2),
                -p @ (an * (j0 + j2) / 2 + bn * (j0 - j2) / 2)
                + sign * q @ (at * (j1 + j3) / 4 + bt * (3 * j1 - j3) / 4 - g * (j1 + j3) / 2),
                -p @ (sn * j0) + sign * q @ (st * j1),
                -sign * p @ (tn * j1) - q @ (tt * (j0 - j2) / 2 + tau * (j0 + j2) / 2),
            ]
        )
    return np.array(found).T
