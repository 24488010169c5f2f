"""What does less wear cost in stress beside the stick edge, where fretting cracks begin?

Gradients have singularities of different order there, so they are compared by the pressure at a critical distance
inside the edge, which is a property of the material. Every point of a front is a design of the electrical contact at
its contact radius and with a modulus that can be made: the least wear for the edge pressure that is allowed.
"""

from pathlib import Path
from typing import Any

import numpy as np
from drawing import HERE, LEGEND, MARK, NOTE, SCALE, finish, page, print_table, run, save
from matplotlib.axes import Axes

from plgwear_jax import optimise, scene

DISTANCES = (0.5e-6, 1e-6, 2e-6, 5e-6)  # m
AMPLITUDES = (0.05, 0.08, 0.15, 0.25)  # F_x/(mu F_N)
DISTANCE = 1e-6  # m, for several amplitudes
MARKED = (-0.3, 0.0, 0.4)  # values of k


def main(out: Path, points: int = 41) -> None:
    given = scene.load(HERE / "electrical_contact.toml")
    arguments = given.arguments()
    contact = arguments["contact"]
    assert given.load is not None
    limit = float(np.asarray(contact.friction) * np.asarray(contact.normal_force))

    def front(distance: float, force: float) -> optimise.Front:
        found = optimise.front(**dict(arguments, load=force), distance=distance, points=points)
        if not np.all(np.asarray(found.certified)):
            print(f"{np.sum(~np.asarray(found.certified))} points of a front are not certain")
        return found

    figure = page(18.0, 8.0)
    left, right = figure.subplots(1, 2)
    rows, highest = [], []

    def draw(axes: Axes, distance: float, force: float, label: str, colour: str, relative: bool) -> None:
        found = front(distance, force)
        k = np.asarray(found.variables["k"])
        highest.append(k.max())
        homogeneous = float(contact.edge_pressure(distance, force)), float(contact.wear_volume(force))
        units = homogeneous if relative else (1e6, 1e-18)
        pressure, wear = (np.asarray(x) / unit for x, unit in zip((found.x, found.y), units, strict=True))
        axes.plot(pressure, wear, color=colour, linewidth=1.4, label=label)
        for value, marker in zip(MARKED, "os^", strict=True):
            if k.min() < value < k.max():
                falling = np.argsort(k)
                where = (np.interp(value, k[falling], x[falling]) for x in (pressure, wear))
                axes.plot(*where, marker, color=colour, markersize=5, **MARK)
        ends = (f"{found.x[n] / 1e6:.0f} MPa, {found.y[n] * 1e18:.3g} µm³, {k[n]:+.2f}" for n in (0, -1))
        rows.append([f"{distance * 1e6:g} µm", f"{force / limit:.2f}", *ends])

    assert given.load.tangential_force is not None
    for distance, colour in zip(DISTANCES, SCALE, strict=False):
        draw(left, distance, given.load.tangential_force, f"{distance * 1e6:g} µm", colour, relative=False)
    for phi, colour in zip(AMPLITUDES, SCALE, strict=False):
        draw(right, DISTANCE, phi * limit, f"{phi:g}", colour, relative=True)
    print_table(["distance", "phi", "lowest pressure: pressure, wear, k", "least wear: pressure, wear, k"], rows)

    left.set_ylim(top=1.08 * left.get_ylim()[1])
    left.text(
        0.03,
        0.88,
        f"upper ends: $k = {max(highest):.2f}$,\nthe highest that can be made",
        transform=left.transAxes,
        **NOTE,
    )
    left.text(0.03, 0.05, "lower ends: the least wear\nthat can be made", transform=left.transAxes, **NOTE)
    left.set(xlabel="pressure inside the stick edge (MPa)", ylabel="least wear volume (µm³)")
    left.legend(**LEGEND, title="critical distance")
    right.axhline(1.0, color="0.75", linewidth=0.6, zorder=0)
    right.axvline(1.0, color="0.75", linewidth=0.6, zorder=0)
    right.set(
        xlabel=f"pressure {DISTANCE * 1e6:g} µm inside the edge, over that at $k = 0$",
        ylabel="least wear volume, over that at $k = 0$",
    )
    amplitudes = right.legend(**LEGEND, title=r"amplitude $\varphi$", loc="upper right")
    right.add_artist(amplitudes)
    keys: list[Any] = [
        right.plot([], [], marker, color="w", markersize=5, **MARK, label=f"$k = {value:g}$")[0]
        for value, marker in zip(MARKED, "os^", strict=True)
    ]
    right.legend(handles=keys, loc="upper center", **LEGEND)
    right.autoscale(False)
    right.fill_between((0.0, 1.0), 0.0, 1.0, color="0.92", zorder=-1)
    right.text(0.03, 0.05, "less of both", transform=right.transAxes, **NOTE)
    finish([left, right])
    save(figure, out / "wear_against_edge_stress.png")


if __name__ == "__main__":
    run(main)
