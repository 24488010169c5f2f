"""Contacts without closed forms, by rings of constant pressure: what the default tests compare with.

    python tools/record_rings.py

writes `tests/reference/ring_contacts.json`, in a minute, by programs that share nothing with the library.
"""

import importlib
import json
import sys
from pathlib import Path
from typing import Any

import jax
import numpy as np
from scipy.interpolate import PchipInterpolator

from plgwear_jax import DepthGraded

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "reference"))
march_oracle: Any = importlib.import_module("march_oracle")
surface_oracle: Any = importlib.import_module("surface_oracle")
contacts: Any = importlib.import_module("ring_contacts")
A, FRICTION, RIG, COEFFICIENT = contacts.A, contacts.FRICTION, contacts.RIG, contacts.COEFFICIENT
RADII, BESIDE = contacts.RADII, contacts.BESIDE
STICK, TIMES = 0.8, np.array([0.5, 2.0, 6.0])  # c over A, and times in the unit of its march


def tangential_ratio(kind: Any, parts: Any, a: float, count: int) -> float:
    """theta: both bodies share in it as in the energy of a flat punch of the radius a."""
    edges, middle, area = surface_oracle.rings(a, count)
    discs = [part.of_discs(edges[1:], middle) for part in parts]
    both = discs[0] + discs[1]
    both[:, 1:] -= both[:, :-1].copy()
    pressures = np.linalg.solve(both, np.ones(count))
    shares = [area * pressures @ (disc @ surface_oracle.steps(pressures)) for disc in discs]
    return float(np.dot(shares, kind.ratios) / np.sum(shares))


def edge_intensity(both: Any, c: float, F_N: float, n: float, count: int = 480) -> float:
    """The factor of z^-1/2, z = 1 - (r/c)^2, in the pressure of the worn contact on a surface of finite modulus."""
    inner = surface_oracle.contact_of(both, c, count, n)
    more = inner.held(F_N)[0] - inner.held(inner.force)[0]
    z, near = 1.0 - (surface_oracle.rings(c, count)[1] / c) ** 2, slice(-count // 4, -count // 20)
    return float(np.polyfit(z[near], (more * np.sqrt(z))[near], 2)[-1])


def computed(kind: Any, count: int = 240) -> dict[str, Any]:
    """What the rings give, in SI units."""
    parts, both, n, c = kind.parts, kind.both, kind.exponent, STICK * A
    end = surface_oracle.steady(both, A, c, count, n)
    F_N, mu = float(end.force), FRICTION
    F_x = mu * F_N * end.phi
    whole, inner = surface_oracle.contact_of(both, A, count, n), end.inner
    theta = tangential_ratio(kind, parts, A, count)
    before, _ = whole.held(F_N)
    worn, depth = inner.held(F_N)
    first, _ = inner.held(inner.force)

    def sunk(discs: Any, pressures: np.ndarray, r: np.ndarray) -> np.ndarray:
        return both.of_discs(discs, r) @ surface_oracle.steps(pressures)

    def at(pressures: np.ndarray, radius: float, power: float, r: np.ndarray) -> np.ndarray:
        # Over a power of the distance to the edge the pressures of rings are a smooth function of their middles.
        middle = surface_oracle.rings(radius, count)[1]
        smooth = PchipInterpolator(middle[:-1], (pressures * (1.0 - (middle / radius) ** 2) ** -power)[:-1])
        return smooth(r) * (1.0 - (r / radius) ** 2) ** power

    ring = c + BESIDE * (end.worn_radius - c)
    around = np.linspace(c, end.worn_radius, 2001)[1:]
    slipping = c + BESIDE * (A - c)
    slip = slipping**n / n - (inner.depth - sunk(inner.discs, first, slipping))

    # The displacement grows as less and less of the contact sticks.
    radii = A * np.append(1.0 - np.linspace(0.0, 1.0, 40)[:-1] ** 2, 0.0)[::-1]
    loads, depths_of = np.zeros((2, radii.size))
    for i, radius in enumerate(radii[1:], 1):
        contact = surface_oracle.contact_of(both, radius, count // 2, n)
        loads[i], depths_of[i] = contact.force, contact.depth
    forces, moved = mu * (loads[-1] - loads)[::-1], mu * theta * (depths_of[-1] - depths_of)[::-1]
    u = PchipInterpolator(forces, moved)

    def ratio(force: float) -> float:
        return float(1.0 - 2.0 * u.integrate(0.0, force) / force / u(force))

    def aperture(force: float) -> float:
        return float(1.0 - 2.0 * u(0.5 * force) / u(force))

    amplitude = mu * theta * (whole.depth - inner.depth)
    per_cycle = 4.0 * COEFFICIENT * mu * theta * F_N / (np.pi * A**2)

    def wearing(count: int) -> Any:
        return kind.rings(both, whole, march_oracle.edges_beside(c / A, end.worn_radius / A, count))

    fewer, rings = wearing(80), wearing(160)
    coarse, fine = (each.volumes_at(TIMES, 40, force=end.phi) for each in (fewer, rings))
    held = fewer.volumes_at(TIMES, 40, displacement=1.0 - inner.depth / whole.depth)
    finite = isinstance(kind.half_space, DepthGraded)
    return {
        "normal_force": F_N,
        "tangential_force": F_x,
        "steady": {
            "contact_radius": A,
            "stick_radius": c,
            "worn_radius": end.worn_radius,
            "penetration": end.penetration,
            "wear_volume": end.volume,
            "deepest_wear": np.max(end.worn(around)),
            "peak_initial_pressure": np.max(before),
            "gross_slip_displacement": mu * theta * whole.depth,
            "displacement_amplitude": amplitude,
            "worn_displacement_amplitude": mu * theta * (depth - inner.depth),
            "energy_per_cycle": 4.0 * F_x * amplitude * ratio(F_x),
            "energy_ratio": ratio(F_x),
            "loop_aperture": aperture(F_x),
            "gross_slip_energy_ratio": ratio(forces[-1]),
            "gross_slip_aperture": aperture(forces[-1]),
            "contact_share": amplitude / (amplitude + F_x / RIG),
            **({"edge_intensity": edge_intensity(both, c, F_N, n)} if finite else {}),
        },
        "fields": {
            "initial_pressure": at(before, A, 0.5, RADII * A),
            "pressure": at(worn, c, -0.5, RADII * A),
            "traction": mu * at(worn - first, c, -0.5, RADII * A),
            "initial_displacement": sunk(whole.discs, before, A * np.array([0.5, 1.5, 3.0])),
            "wear_depth": end.worn(ring),
            "slip_amplitude": mu * theta * slip,
        },
        "cycles": TIMES / per_cycle,
        "volumes": A ** (2.0 + n) * (fine + (fine - coarse) / 3.0),
        "held": A ** (2.0 + n) * held,
    }


def listed(found: Any) -> Any:
    """With lists in place of arrays."""
    return jax.tree.map(lambda x: x.tolist() if isinstance(x, np.ndarray) else float(x), found)


def main() -> None:
    """Record all kinds."""
    jax.config.update("jax_enable_x64", True)
    found = {name: listed(computed(kind)) for name, kind in contacts.KINDS.items()}
    found = jax.tree.map(lambda x: float(f"{x:.7g}"), found)
    contacts.FILE.write_text(json.dumps(found, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main()
