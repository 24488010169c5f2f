"""Which gradient wears least at which amplitude, and what does it save against a homogeneous material?

The contact radius is held, so only the amplitude phi = F_x/(mu F_N) counts: one map for all contacts. It is drawn for
two ranges that the exponent may be chosen from.
"""

from pathlib import Path

import jax.numpy as jnp
import numpy as np
from drawing import BLUE, ORANGE, letters, page, print_table, run, save

from plgwear_jax import fretting, optimise

GAIN = 0.85  # the amplitude of the title
RANGES = {0.95: (BLUE, "-"), 0.5: (ORANGE, (0, (4, 1.5)))}  # abs(k) at most
TURNS = {
    "leaves_lower": "best k leaves the lower bound",
    "reaches_upper": "best k reaches the upper bound",
    "ends_equal": "both bounds wear the same, best k jumps back",
}
# At which bound each stands in the picture, and how far beside that, in points.
PLACES = {"leaves_lower": (-1, (9, 1)), "reaches_upper": (1, (4, -9)), "ends_equal": (-1, (-32, 3))}


ROOM = {"facecolor": "w", "edgecolor": "none", "pad": 0.4}  # behind a number, where a line would cross it


def main(out: Path, points: int = 10_000) -> None:
    phi = (jnp.arange(points) + 0.5) / points
    ends = jnp.array([*RANGES, 1.0])
    turns = optimise.critical_amplitudes((-ends, ends))
    rows = [[words, *(f"{x:.8f}" for x in getattr(turns, name))] for name, words in TURNS.items()]
    print_table(["critical amplitude phi, abs(k) up to", *(f"{end:g}" for end in ends)], rows)

    homogeneous = fretting.wear_volume(0.0, phi)
    gains = []  # at GAIN, of each range
    figure = page(14.0, 11.0)
    # Close to gross slip the curve changes within a narrow range: a panel of its own, drawn wider.
    (above, above_end), (below, below_end) = figure.subplots(2, 2, sharex="col", sharey="row", width_ratios=(4, 1))
    for n, (end, (colour, dashes)) in enumerate(RANGES.items()):
        best = optimise.optimal_exponent(phi, (-end, end))
        saving = 100.0 * (1.0 - np.asarray(best.wear_volume / homogeneous))
        gains.append(float(np.interp(GAIN, phi, saving)))
        certain, proven = (int(jnp.sum(x)) for x in (best.certified, best.scan_found_nothing_better))
        print(f"abs(k) up to {end:g}: {points} designs; nothing better found for {certain}, nor expected for {proven}")
        for axes, values in ((above, best.k), (above_end, best.k), (below, saving), (below_end, saving)):
            axes.plot(phi, values, color=colour, linestyle=dashes, linewidth=1.4)
        for name, (side, shift) in PLACES.items():
            at = float(getattr(turns, name)[n])
            top, bottom = (above_end, below_end) if name == "ends_equal" else (above, below)
            for axes in (top, bottom):
                axes.axvline(at, color=colour, linewidth=0.7, linestyle=":")
            top.annotate(
                f"{at:.4f}", (at, side * end), shift, textcoords="offset points", color=colour, fontsize=7, bbox=ROOM
            )
        below.plot([], [], color=colour, linestyle=dashes, label=rf"$-{end:g} \leq k \leq {end:g}$")
    above.axhline(0.0, color="0.75", linewidth=0.6, zorder=0)
    above_end.axhline(0.0, color="0.75", linewidth=0.6, zorder=0)
    above.set(xlim=(0.0, 0.97), ylabel="best exponent $k^*$", ylim=(-1.15, 1.15))
    below.set(ylim=(0.0, 100.0), ylabel="less wear than at $k = 0$ (%)")
    below.set_xlabel(r"amplitude of the tangential force $\varphi = F_x/(\mu F_N)$")
    above_end.set(xlim=(0.97, 1.0), xticks=(0.98, 0.99, 1.0))
    below_end.set_xlabel("close to gross slip")
    below.legend(title="exponents to choose from")
    letters([above, below])
    least, most = (float(np.asarray(turn)[0]) for turn in (turns.leaves_lower, turns.reaches_upper))
    words = rf"least wear: stiff up to $\varphi = {least:.4f}$, compliant from {most:.4f}"
    above.set_title(words, loc="right")
    words = rf"$\varphi = {GAIN:g}$: {gains[0]:.0f} % less wear; within $|k| \leq 0.5$ {gains[1]:.0f} % less"
    below.set_title(words, loc="right")
    save(figure, out / "amplitude_map.png")


if __name__ == "__main__":
    run(main)
