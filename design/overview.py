"""The contact with its symbols, and the result that matters: which gradient wears least at which amplitude.

The contact is drawn by the closed forms, with its heights enlarged: on the left before any wear, on the right in the
steady state. The wear is that of the ball of `steel_ball.toml`, on the stiffest and on the most compliant surface that
its limits allow.
"""

from pathlib import Path
from typing import Any

import numpy as np
from drawing import BLUE, HERE, MARK, NOTE, ORANGE, letters, page, print_table, run, save
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from plgwear_jax import FrettingContact, fretting, optimise, scene

K, PHI, HEIGHT = 0.3, 0.75, 0.62  # of the sketch; its heights are in units of a_0^2/R, times HEIGHT
SIDES, TOP, LID, BOTTOM = 2.2, -1.35, -0.75, 1.72
LINE: dict[str, Any] = {"color": "0.25", "linewidth": 0.6, "zorder": 5}
ARROW: dict[str, Any] = {"arrowstyle": "-|>", "linewidth": 1.0, "color": "k", "shrinkA": 0.0, "shrinkB": 0.0}
SPAN: dict[str, Any] = ARROW | {"arrowstyle": "<->", "linewidth": 0.7}
WORN_OFF: dict[str, Any] = {"facecolor": "#f6d0b5", "edgecolor": ORANGE, "hatch": "//////", "linewidth": 0.0}
STIFF = {"color": ORANGE, "linestyle": (0, (4, 1.5)), "linewidth": 1.4}
COMPLIANT = {"color": BLUE, "linestyle": "-", "linewidth": 1.4}
TOLD = (0.05, 0.2, 0.5)  # amplitudes of the table


def main(out: Path, points: int = 49) -> None:
    figure = page(18.0, 7.2)
    sketch, wear = figure.subplots(1, 2, width_ratios=(1.25, 1.0))
    draw_contact(sketch)
    draw_wear(wear, points)
    letters([sketch, wear])
    save(figure, out / "overview.png")


# --- the contact ----------------------------------------------------------------------------------------------------


def draw_contact(axes: Axes) -> None:
    """A section through the contact, before any wear on the left and worn on the right."""
    r = np.linspace(0.0, 1.0, 401) ** 2 * SIDES
    stick, edge = float(fretting.stick_radius(K, PHI)), float(fretting.worn_radius(K, PHI))
    unworn = HEIGHT * 0.5 * r**2
    d_0, d_inf = (HEIGHT * float(fretting.penetration(K, phi)) for phi in (0.0, PHI))
    fresh, worn = d_0 - unworn, d_inf - HEIGHT * np.asarray(fretting.profile(r, K, PHI))
    _half_space(axes, -r[::-1], HEIGHT * np.asarray(fretting.initial_displacement(r, K))[::-1])
    _half_space(axes, r, HEIGHT * np.asarray(fretting.steady_displacement(r, K, PHI)))
    _indenter(axes, -r, fresh)
    _indenter(axes, r, worn)
    ring = (stick <= r) & (r <= edge)
    axes.fill_between(r[ring], (d_inf - unworn)[ring], worn[ring], zorder=3.5, **WORN_OFF)
    axes.plot(r[ring], (d_inf - unworn)[ring], color="k", linewidth=0.7, linestyle="--", zorder=5)
    middle = 0.55 * stick + 0.45 * edge
    lost = middle, float(np.interp(middle, r, 0.5 * (worn + d_inf - unworn)))
    axes.annotate("worn off", lost, (1.72, 0.62), ha="center", arrowprops={"arrowstyle": "-", "linewidth": 0.6}, **NOTE)
    axes.plot([0.0, 0.0], [LID, 1.3], color="0.35", linewidth=0.6, linestyle=(0, (7, 1.5, 1.2, 1.5)), zorder=5)
    axes.annotate("", (0.0, LID), (0.0, TOP + 0.05), arrowprops=ARROW, zorder=6)
    axes.annotate("", (0.62, -0.22), (-0.62, -0.22), arrowprops=ARROW | {"arrowstyle": "<|-|>"}, zorder=6)
    _symbol(axes, (0.12, -1.2), "$F_N$", ha="left", va="center")
    _symbol(axes, (0.68, -0.22), r"$\pm F_x$", ha="left", va="center")
    _radius(axes, (-1.0, float(np.interp(1.0, r, fresh))), 0.95, "$a_0$")
    _radius(axes, (stick, float(np.interp(stick, r, worn))), 0.95, "$c$")
    _radius(axes, (edge, float(np.interp(edge, r, worn))), 1.24, r"$a_\infty$")
    axes.annotate("", (-1.95, 1.35), (-1.95, 0.06), arrowprops=ARROW, zorder=6)
    _symbol(axes, (-1.87, 1.27), "$z$", ha="left", va="center")
    axes.text(-0.95, -0.56, "indenter, radius $R$", ha="center", va="center", fontsize=8, zorder=8)
    axes.text(0.0, 1.58, "coating with Young's modulus $E(z)$", ha="center", va="center", fontsize=8, zorder=8)
    axes.text(-1.2, -0.92, "before any wear", ha="center", va="center", **NOTE)
    axes.text(1.2, -0.92, "in the steady state", ha="center", va="center", **NOTE)
    axes.set(xlim=(-SIDES, SIDES), ylim=(BOTTOM, TOP), aspect="equal")
    axes.set_axis_off()


def _half_space(axes: Axes, x: np.ndarray, z: np.ndarray) -> None:
    """The coating below its surface z(x), darker with the depth."""
    body = Polygon([*zip(x, z, strict=True), (x[-1], BOTTOM), (x[0], BOTTOM)], facecolor="none", edgecolor="none")
    axes.add_patch(body)
    shade = np.sqrt(np.linspace(0.0, 1.0, 256))[:, None]
    extent = float(x[0]), float(x[-1]), BOTTOM, 0.0
    image = axes.imshow(shade, cmap="Blues", vmin=-0.25, vmax=2.4, extent=extent, aspect="auto", zorder=0)
    image.set_clip_path(body)
    axes.plot(x, z, color=BLUE, linewidth=1.2, zorder=4)


def _indenter(axes: Axes, x: np.ndarray, z: np.ndarray) -> None:
    """Half of the indenter, up to its lid."""
    x, z = x[z > LID], z[z > LID]
    axes.add_patch(Polygon([*zip(x, z, strict=True), (x[-1], LID), (0.0, LID)], facecolor="0.88", zorder=3))
    axes.plot([*x, x[-1], 0.0], [*z, LID, LID], color="k", linewidth=0.9, zorder=3.2)


def _radius(axes: Axes, place: tuple[float, float], level: float, symbol: str) -> None:
    """A dimension from the axis to a place on the indenter, drawn at a level below it."""
    x, z = place
    axes.plot([x, x], [z, level + 0.06], **LINE)
    axes.annotate("", (x, level), (0.0, level), arrowprops=SPAN, zorder=6)
    _symbol(axes, (x - 0.3 * np.sign(x), level + 0.02), symbol, ha="center", va="top")


def _symbol(axes: Axes, place: tuple[float, float], symbol: str, ha: str, va: str) -> None:
    axes.text(*place, symbol, ha=ha, va=va, fontsize=9, zorder=8)


# --- the result -----------------------------------------------------------------------------------------------------


def draw_wear(axes: Axes, points: int) -> None:
    """The wear volume of the example on two gradients over the force amplitude, compared with a homogeneous body."""
    given = scene.load(HERE / "steel_ball.toml")
    assert given.load is not None and given.design_space is not None
    asked, force = given.arguments(), given.load.largest
    contact = asked["contact"]
    assert isinstance(contact, FrettingContact)
    most = float(np.asarray(contact.friction * contact.normal_force))
    best = optimise.design(**asked)
    # Under a small amplitude the stiffest surface allowed is the best one; with E(0) the tension there is infinite.
    asked["load"] = 0.05 * most
    asked["limits"] = {name: limit for name, limit in asked["limits"].items() if name != "peak_tension"}
    stiff = optimise.design(**asked)
    phi = np.concatenate([np.geomspace(0.005, 0.1, points // 4, endpoint=False), np.linspace(0.1, 0.97, points)])
    reference = _volumes(contact, phi * most)
    depths, rows = [depth for depth, *_ in best.windows], []
    curves = (stiff, STIFF, "stiff surface", (0.97, 8.6)), (best, COMPLIANT, "compliant surface", (0.97, -10.8))
    for found, style, words, place in curves:
        assert isinstance(found.contact, FrettingContact)
        change = 100.0 * (_volumes(found.contact, phi * most) / reference - 1.0)
        axes.plot(phi, change, **style)
        moduli = (f"{float(found.contact.material.modulus(z)) / 1e9:.0f} GPa at {z * 1e6:.3g} µm" for z in depths)
        axes.text(
            *place, f"{words}:\n{',  '.join(moduli)}", color=style["color"], fontsize=7.5, ha="right", va="center"
        )
        rows.append(
            [words, f"{float(found.variables['k']):+.3f}", *(f"{np.interp(x, phi, change):+.1f} %" for x in TOLD)]
        )
    print_table(["change of the wear volume", "k", *(f"phi = {x:g}" for x in TOLD)], rows)
    here = force / most, -100.0 * float(best.saving)
    axes.plot(*here, "o", color=COMPLIANT["color"], markersize=6, **MARK)
    axes.text(here[0], here[1] + 2.3, f"best for this ball: {here[1]:.1f} %".replace("-", "−"), ha="center", **NOTE)
    axes.axhline(0.0, color="0.45", linewidth=0.7, zorder=0)
    axes.text(0.97, 0.3, "homogeneous", ha="right", va="bottom", **NOTE)
    axes.set(xlim=(0.0, 1.0), ylim=(-15.0, 20.0), ylabel="change of the wear volume (%)")
    axes.set_title("power laws, to any depth", loc="right")
    axes.set_xlabel(r"force amplitude over friction force, $F_x/(\mu F_N)$")


def _volumes(contact: FrettingContact, forces: np.ndarray) -> np.ndarray:
    return np.array([float(contact.steady(force).wear_volume) for force in forces])


if __name__ == "__main__":
    run(main)
