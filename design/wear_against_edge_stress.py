"""What does less wear cost in stress beside the stick edge, where fretting cracks begin?

Gradients have singularities of different order there, so they are compared by the pressure at a critical distance
inside the edge, which is a property of the material. Every point of a front is a design of the electrical contact at
its contact radius and with a modulus that can be made: the least wear for the edge pressure that is allowed.
"""

from pathlib import Path
from typing import Any

import numpy as np
from drawing import HERE, LEGEND, MARK, NOTE, SCALE, finish, page, print_table, run, save
from matplotlib import colormaps
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
    gains: dict[tuple[float, float], tuple[float, float]] = {}  # times the pressure, less wear in %

    def draw(axes: Axes, distance: float, force: float, label: str, style: tuple[str, Any], relative: bool) -> None:
        found = front(distance, force)
        k = np.asarray(found.variables["k"])
        highest.append(k.max())
        homogeneous = float(contact.steady(force).edge_pressure(distance)), float(contact.steady(force).wear_volume)
        units = homogeneous if relative else (1e6, 1e-18)
        pressure, wear = (np.asarray(x) / unit for x, unit in zip((found.x, found.y), units, strict=True))
        colour, dashes = style
        axes.plot(pressure, wear, color=colour, linestyle=dashes, linewidth=1.4)
        top = int(np.argmax(wear))
        # where there is room
        place: dict[str, Any] = {"xytext": (-4, -6 if wear[top] < 1.0 else 1), "ha": "right", "va": "center"}
        if not relative and distance == DISTANCES[1]:
            place = {"xytext": (0, 4), "ha": "center", "va": "bottom"}
        elif not relative and distance > DISTANCES[1]:
            place |= {"xytext": (3, 1), "ha": "left"}
        axes.annotate(
            label, (pressure[top], wear[top]), textcoords="offset points", fontsize=7.5, color=colour, **place
        )
        for value, marker in zip(MARKED, "os^", strict=True):
            if k.min() < value < k.max():
                falling = np.argsort(k)
                where = (np.interp(value, k[falling], x[falling]) for x in (pressure, wear))
                axes.plot(*where, marker, color=colour, markersize=5, **MARK)
        ends = (f"{found.x[n] / 1e6:.0f} MPa, {found.y[n] * 1e18:.3g} µm³, {k[n]:+.2f}" for n in (0, -1))
        gains[distance, force] = (
            float(found.x[-1]) / homogeneous[0],
            100.0 * (1.0 - float(found.y[-1]) / homogeneous[1]),
        )
        rows.append([f"{distance * 1e6:g} µm", f"{force / limit:.2f}", *ends])

    assert given.load.tangential_force is not None
    # Shades of one colour in each panel, since the curves of one are distances and those of the other amplitudes.
    for distance, style in zip(DISTANCES, _shades("Blues"), strict=True):
        draw(left, distance, given.load.tangential_force, f"{distance * 1e6:g} µm", style, relative=False)
    for phi, style in zip(AMPLITUDES, _shades("Oranges"), strict=True):
        draw(right, DISTANCE, phi * limit, rf"$\varphi = {phi:g}$", style, relative=True)
    print_table(["distance", "phi", "lowest pressure: pressure, wear, k", "least wear: pressure, wear, k"], rows)

    left.set(xlim=(100.0, None), ylim=(None, 1.06 * left.get_ylim()[1]))
    right.set_xlim(left=0.33)
    left.text(
        0.97,
        0.96,
        f"upper ends: $k = {max(highest):.2f}$, the highest that can be made",
        transform=left.transAxes,
        ha="right",
        va="top",
        **NOTE,
    )
    words = f"$\\varphi = {given.load.tangential_force / limit:.2g}$; lower ends:\nthe least wear that can be made"
    left.text(0.03, 0.05, words, transform=left.transAxes, **NOTE)
    left.set(xlabel="pressure at a critical distance inside the stick edge (MPa)", ylabel="least wear volume (µm³)")
    given_force = given.load.tangential_force
    more, less = gains[DISTANCE, given_force]
    words = f"{less:.0f} % less wear: {more:.2g} times the pressure at 1 µm"
    left.set_title(words, fontsize=8, loc="right")
    right.axhline(1.0, color="0.75", linewidth=0.6, zorder=0)
    right.axvline(1.0, color="0.75", linewidth=0.6, zorder=0)
    right.set(
        xlabel=f"pressure {DISTANCE * 1e6:g} µm inside the edge, over that at $k = 0$",
        ylabel="least wear volume, over that at $k = 0$",
    )
    most, fewest = (gains[DISTANCE, phi * limit][1] for phi in (AMPLITUDES[0], AMPLITUDES[-2]))
    words = f"least wear: {most:.0f} % less at $\\varphi = {AMPLITUDES[0]:g}$, {fewest:.1g} % at {AMPLITUDES[-2]:g}"
    right.set_title(words, fontsize=8, loc="right")
    keys: list[Any] = [
        right.plot([], [], marker, color="w", markersize=5, **MARK, label=f"$k = {value:g}$")[0]
        for value, marker in zip(MARKED, "os^", strict=True)
    ]
    right.legend(handles=keys, loc="upper right", **LEGEND)
    right.autoscale(False)
    right.fill_between((0.0, 1.0), 0.0, 1.0, color="0.92", zorder=-1)
    right.text(0.03, 0.05, "less of both", transform=right.transAxes, **NOTE)
    finish([left, right])
    save(figure, out / "wear_against_edge_stress.png")


def _shades(name: str) -> list[tuple[Any, Any]]:
    """Four shades of a colour with their dashes."""
    return [(colormaps[name](shade), dashes) for shade, (_, dashes) in zip((1.0, 0.8, 0.6, 0.5), SCALE, strict=True)]


if __name__ == "__main__":
    run(main)
