"""Which gradient wears least after how many cycles? At a held contact radius, for one Poisson's ratio.

What stays when the gradient changes is the life x = n/theta = 4 K mu F_N N/(pi a_0^2). For long lives the best exponent
is that of the steady state; before, the stiff surface wears least at every amplitude.
"""

import dataclasses
from pathlib import Path

import numpy as np
from drawing import letters, page, print_table, run, save
from matplotlib.colors import BoundaryNorm

from plgwear_jax import FrettingContact, PowerLawGraded, optimise, plots

NU, BOUND = 0.3, 0.9
TOLD = (0.1, 0.3, 0.6, 0.9)
LIVES = (1.0, 10.0, 30.0, 100.0)


def worn(k: np.ndarray | float, phi: np.ndarray, x: np.ndarray) -> np.ndarray:
    """The volume in a_0^4/R that is worn in a life x, by a contact in which a_0 and R are 1 m."""
    one = FrettingContact(PowerLawGraded(E0=1.0, z0=1.0, k=k, nu=NU), radius=1.0, normal_force=1.0, friction=1.0)
    force = np.asarray(one.steady(0.0).contact_radius) ** -(3.0 + k)
    run = dataclasses.replace(one, normal_force=force).over_cycles(phi * force, 1e-6 * np.pi / (4.0 * force))
    return np.asarray(run.volume(1e6 * x))


def main(out: Path, points: int = 101) -> None:
    phi = np.unique([*np.linspace(0.02, 0.95, points - len(TOLD)), *TOLD])
    x = np.unique([*np.geomspace(0.1, 1000.0, 2 * points), *LIVES])
    found = optimise.optimal_exponent(phi[:, None], (-BOUND, BOUND), life=x, nu=NU)
    best, least = np.asarray(found.k), np.asarray(found.wear_volume)
    for_ever = np.asarray(optimise.optimal_exponent(phi, (-BOUND, BOUND)).k)
    by_steady, homogeneous = (worn(k, phi[:, None], x) for k in (for_ever[:, None], 0.0))
    saved, lost = 100.0 * (1.0 - least / homogeneous), np.maximum(by_steady / least, 1.0)

    rows = []
    for amplitude in TOLD:
        j = int(np.argmin(np.abs(phi - amplitude)))
        cells = [f"{for_ever[j]:+.2f}"]
        for life in LIVES:
            i = int(np.argmin(np.abs(x - life)))
            cells.append(f"{best[j, i]:+.2f}, {saved[j, i]:.0f} %, {lost[j, i]:.2f}")
        rows.append([f"{amplitude:g}", *cells])
    print("best exponent, what it saves against k = 0, wear of the steady-state over the finite-life optimum")
    print_table(["amplitude", "steady state", *(f"x = {life:g}" for life in LIVES)], rows)
    print(f"the steady-state optimum wears up to {lost.max():.1f} times as much as the finite-life optimum")

    figure = page(18.0, 7.4)
    panels = figure.subplots(1, 3, sharey=True)
    shown = (
        (best, np.linspace(-BOUND, BOUND, 19), "RdBu_r", "best exponent $k$", (-0.9, -0.5, 0.0, 0.5, 0.9)),
        (saved, np.linspace(0.0, 100.0, 11), "cividis", "wear less than at $k = 0$ (%)", (0, 20, 40, 60, 80, 100)),
        (
            lost,
            (1.0, 1.1, 1.5, 2.0, 3.0, 5.0, 10.0, 30.0),
            "magma_r",
            "steady-state optimum's wear\nover finite-life optimum's",
            (1.0, 1.1, 1.5, 2.0, 3.0, 5.0, 10.0, 30.0),
        ),
    )
    for axes, (values, levels, colours, label, ticks) in zip(panels, shown, strict=True):
        norm = BoundaryNorm(levels, 256)
        if values is best:  # it jumps, and there is nothing between both sides
            shades = axes.pcolormesh(x, phi, values, cmap=colours, norm=norm, shading="nearest", rasterized=True)
            axes.set(xlim=(x[0], x[-1]), ylim=(phi[0], phi[-1]))
        else:
            shades = axes.contourf(x, phi, values, levels=levels, cmap=colours, norm=norm, extend="neither")
        bar = figure.colorbar(shades, ax=axes, location="top", pad=0.02, aspect=25, ticks=ticks)
        bar.ax.set_xticks(ticks, labels=[f"{tick:g}".replace("-", "−") for tick in ticks])
        bar.set_label(label)
        bar.ax.tick_params(labelsize=7)
        axes.set(xscale="log", xlabel=r"life $x = 4 K \mu F_N N/(\pi a_0^2)$")
    jump = np.abs(np.diff(best, axis=1)) > 0.15
    edge = [(phi[j], np.sqrt(x[i] * x[i + 1])) for j, row in enumerate(jump) for i in np.flatnonzero(row)[-1:]]
    panels[0].plot([at for _, at in edge], [where for where, _ in edge], color="k", linewidth=1.0)
    panels[0].text(1.2, 0.55, "stiff surface:\n$k = -0.9$", color="w", ha="center", fontsize=7.5)
    panels[0].text(130.0, 0.6, "compliant\nsurface:\n$k = 0.9$", color="w", ha="center", fontsize=7.5)
    for axes, values, level, words, place, color in (
        (panels[1], saved, 20, "20 %", (130.0, 0.44), "w"),
        (panels[1], saved, 50, "50 %", (10.0, 0.65), "k"),
        (panels[2], lost, 1.1, "1.1", (14.5, 0.7), "k"),
        (panels[2], lost, 3.0, "3", (5.8, 0.55), "w"),
    ):
        drawn = axes.contour(x, phi, values, levels=[level], colors=color, linewidths=0.8)
        axes.clabel(drawn, fmt={level: words}, fontsize=7, manual=[place], inline_spacing=3)
    panels[0].set_ylabel(r"amplitude $\varphi = F_x/(\mu F_N)$")
    words = "$K$: wear coefficient, $N$: cycles, $a_0$: contact radius before wear, held by the choice of $E_0$"
    figure.supxlabel(words, fontsize=7, color="0.3")
    letters(panels)
    panels[2].set_title(f"up to {lost.max():.0f} times", loc="right")
    save(figure, out / "life.png")

    # one contact on its way
    coating = PowerLawGraded(E0=110e9, z0=1e-4, k=0.0, nu=NU)
    contact = FrettingContact(coating, radius=5e-3, normal_force=10.0, friction=0.4)
    force, coefficient, life = 2.0, 1e-14, 5e5
    wear = contact.over_cycles(force, coefficient)
    first, *cycles, last = np.asarray(wear.cycles_to([0.003, 0.1, 0.5, 0.9, 0.999])).tolist()
    save(plots.wear_picture(wear, np.geomspace(first, last, 97), cycles, life), out / "over_cycles.png")


if __name__ == "__main__":
    run(main)
