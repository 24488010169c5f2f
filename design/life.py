"""Which gradient wears least after how many cycles? At a held contact radius, for one Poisson's ratio.

What stays when the gradient changes is the life x = n/theta = 4 K mu F_N N/(pi a_0^2). For long lives the best exponent
is that of the steady state; before, the stiff surface wears least at every amplitude.
"""

from pathlib import Path

import jax.numpy as jnp
import numpy as np
from drawing import NOTE, finish, page, print_table, run, save

from plgwear_jax import fretting, material, transient

NU, BOUND = 0.3, 0.9
TOLD = (0.1, 0.3, 0.6, 0.9)
LIVES = (1.0, 10.0, 30.0, 100.0)


def main(out: Path, points: int = 31, exponents: int = 37) -> None:
    k = np.linspace(-BOUND, BOUND, exponents)
    phi = np.unique([*np.linspace(0.03, 0.95, points - len(TOLD)), *TOLD])
    x = np.unique([*np.geomspace(0.1, 1000.0, 2 * points), *LIVES])
    n = x * np.asarray(material.tangential_ratio(k, NU))[:, None, None]
    worn = np.asarray(transient.wear_volume(k[:, None, None], phi[:, None], n))  # (k, phi, x)
    steady = np.asarray(fretting.wear_volume(jnp.asarray(k)[:, None], phi))
    best, least = _least(k, worn)
    by_steady = _at(worn, steady.argmin(axis=0))
    homogeneous = worn[exponents // 2]
    saved, lost = 100.0 * (1.0 - least / homogeneous), 100.0 * (by_steady / least - 1.0)

    rows = []
    for amplitude in TOLD:
        j = int(np.argmin(np.abs(phi - amplitude)))
        cells = [f"{k[steady[:, j].argmin()]:+.2f}"]
        for life in LIVES:
            i = int(np.argmin(np.abs(x - life)))
            cells.append(f"{best[j, i]:+.2f}, {saved[j, i]:.0f} %, {lost[j, i]:.0f} %")
        rows.append([f"{amplitude:g}", *cells])
    print("best exponent, what it saves against k = 0, what the choice by the steady state wears more")
    print_table(["amplitude", "for ever", *(f"x = {life:g}" for life in LIVES)], rows)
    print(f"the choice by the steady state wears up to {1.0 + lost.max() / 100.0:.1f} times as much")

    figure = page(18.0, 7.0)
    panels = figure.subplots(1, 3, sharey=True)
    shown = (
        (best, np.linspace(-BOUND, BOUND, 19), "RdBu_r", "best exponent $k$", (-0.8, 0.0, 0.8)),
        (saved, np.linspace(0.0, 100.0, 11), "viridis", "less wear than $k = 0$ (%)", (20, 40, 60, 80)),
        (lost, (0, 10, 25, 50, 100, 200, 300, 400, 500), "magma_r", "lost by the best for ever (%)", (10, 100, 300)),
    )
    for axes, (values, levels, colours, label, lines) in zip(panels, shown, strict=True):
        shades = axes.contourf(x, phi, values, levels=levels, cmap=colours, extend="max" if "lost" in label else None)
        drawn = axes.contour(x, phi, values, levels=lines, colors="k", linewidths=0.6)
        axes.clabel(drawn, fmt="%g", **{"fontsize": NOTE["fontsize"]})
        bar = figure.colorbar(shades, ax=axes, location="top", pad=0.02, aspect=25)
        bar.set_label(label, fontsize=8)
        bar.ax.tick_params(labelsize=7)
        axes.set(xscale="log", xlabel=r"life $x = 4 K \mu F_N N/(\pi a_0^2)$")
    panels[0].set_ylabel(r"amplitude $\varphi = F_x/(\mu F_N)$")
    finish(panels)
    save(figure, out / "life.png")


def _least(k: np.ndarray, worn: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The best exponent, by a parabola through the three best points, and the least wear at the points themselves."""
    i = worn.argmin(axis=0)
    inner = np.clip(i, 1, len(k) - 2)
    before, here, after = (_at(worn, inner + shift) for shift in (-1, 0, 1))
    bend = np.maximum(before - 2.0 * here + after, np.finfo(float).tiny)
    vertex = k[inner] + 0.5 * (k[1] - k[0]) * np.clip((before - after) / bend, -1.0, 1.0)
    return np.where(i == inner, vertex, k[i]), _at(worn, i)


def _at(worn: np.ndarray, i: np.ndarray) -> np.ndarray:
    """The wear of the i-th exponent for each amplitude, or for each amplitude and life."""
    i = np.broadcast_to(i[:, None] if i.ndim == 1 else i, worn.shape[1:])
    return np.take_along_axis(worn, i[None], axis=0)[0]


if __name__ == "__main__":
    run(main)
