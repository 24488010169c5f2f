"""Cones and rounded flats on a homogeneous half-space by ContactMechanics, a program with a square grid.

In an environment of its own, with `pip install ContactMechanics==1.8.3`,

    python tools/contact_mechanics.py

prints what `tests/steady/test_any_shape.py` has recorded, in half a minute. Nothing here imports plgwear, and
no test imports this program. Lengths are in units of a length, forces in units of E* times its square. The grid has so
many cells a side; two are printed, to show what the grid leaves open. Radii come from the number of cells that touch,
pressures are means over narrow rings.
"""

from collections.abc import Callable

import numpy as np

SIZE, GRIDS = 3.0, (256, 512)
HEIGHTS: dict[str, tuple[Callable[[np.ndarray], np.ndarray], float]] = {
    # f(r), and the force
    "cone": (lambda r: 0.1 * r, 0.15),
    "rounded flat": (lambda r: np.maximum(r - 0.6, 0.0) ** 2 / 2.0, 0.4),
}
RADII = 0.2, 0.4, 0.6, 0.8  # of the contact radius


def solve(height: Callable[[np.ndarray], np.ndarray], force: float, cells: int) -> list[float]:
    """(contact radius, penetration, pressures at the radii) on one grid."""
    from ContactMechanics import FreeFFTElasticHalfSpace  # pyright: ignore[reportMissingImports]
    from ContactMechanics.Systems import NonSmoothContactSystem  # pyright: ignore[reportMissingImports]
    from SurfaceTopography import Topography  # pyright: ignore[reportMissingImports]

    h = SIZE / cells
    x = (np.arange(cells) + 0.5) * h - 0.5 * SIZE
    r = np.hypot(x[:, None], x[None, :])
    half_space = FreeFFTElasticHalfSpace((cells, cells), 1.0, (SIZE, SIZE))
    system = NonSmoothContactSystem(half_space, Topography(-height(r), (SIZE, SIZE)))
    found = system.minimize_proxy(external_force=force, pentol=1e-7 * force)
    if not found.success:
        raise RuntimeError(found.message)
    pressure = np.asarray(system.force)[:cells, :cells] / h**2
    pressure *= np.sign(pressure.sum())
    sunk = np.abs(np.asarray(found.x))[:cells, :cells]
    touches = pressure > 1e-9 * pressure.max()
    radius = float(np.sqrt(touches.sum() * h**2 / np.pi))
    # The surface follows the shape where it touches: u = d - f.
    depth = float(np.mean((sunk + height(r))[touches & (r < 0.5 * radius)]))
    rings = [np.abs(r - share * radius) < 1.5 * h for share in RADII]
    return [radius, depth, *(float(pressure[ring].mean()) for ring in rings)]


if __name__ == "__main__":
    for name, (height, force) in HEIGHTS.items():
        for cells in GRIDS:
            print(name, force, cells, [float(f"{x:.5g}") for x in solve(height, force, cells)], flush=True)
