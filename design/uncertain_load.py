"""For which load should a coating be designed if the amplitude is uncertain, and what does the wrong choice cost?

A fleet of connectors vibrates as loads/connector_vibration.csv says. Designing for the mean amplitude is the usual
thing to do; but wear grows faster than the amplitude does, so the few that vibrate most count more. Three measures
take that into account: the mean wear, the mean of the worst tenth (CVaR 0.9), and the worst case. The contact radius is
held, by E0, so that all designs differ in k alone; the modulus stays within what can be made, as in the scene.
"""

from pathlib import Path

import jax.numpy as jnp
import numpy as np
from drawing import BLUE, GREEN, HERE, ORANGE, legend_above, letters, page, print_table, run, save
from matplotlib.ticker import PercentFormatter

from plgwear_jax import FrettingContact, fretting, optimise, scene, tables

LEVELS = {"mean wear": 0.0, "worst tenth": 0.9, "worst case": 1.0}
NAMES = ("mean amplitude", *LEVELS)
STYLES = (("0.45", "-", ""), (BLUE, "-", "///"), (ORANGE, (0, (4, 1.5)), "..."), (GREEN, (0, (1, 1)), "xxx"))


def main(out: Path, samples: int = 200) -> None:
    asked = scene.load(HERE / "electrical_contact.toml").arguments()
    contact = asked["contact"]
    load = tables.read(HERE / "loads" / "connector_vibration.csv", tables.LOADS)
    assert isinstance(contact, FrettingContact)
    probability = load["weight"] / load["weight"].sum()
    # The mean amplitude is appended to the amplitudes of the table: the four designs differ in their weights.
    force = jnp.append(load["tangential_force"], probability @ load["tangential_force"])
    phi = contact.steady(force).amplitude
    measures = [jnp.append(optimise.tail_weights(phi[:-1], probability, level), 0.0) for level in LEVELS.values()]
    weights = jnp.stack([jnp.zeros_like(phi).at[-1].set(1.0), *measures])
    found = optimise.designs(**dict(asked, load=force, weight=weights))
    print(f"a global search found nothing better for any design: {bool(jnp.all(found.certified))}")
    k = np.asarray(found.variables["k"])
    a_0 = float(contact.steady(0.0).contact_radius)
    unit = a_0**4 / float(np.asarray(contact.radius)) * 1e18  # µm³
    # Of each design (row) by each measure (column).
    wear = unit * np.asarray(fretting.wear_volume(k[:, None], phi) @ jnp.stack(measures).T)
    excess = np.round(wear / wear.min(axis=0) - 1.0, 6)
    rows = [[name, f"{x:+.3f}", *(f"{v:.3f} ({100.0 * e:+.2g} %)" for v, e in zip(row, over, strict=True))]
            for name, x, row, over in zip(NAMES, k, wear, excess, strict=True)]  # fmt: skip
    print_table(["designed for", "k", *(f"{name}, µm³" for name in LEVELS)], rows)

    figure = page(18.0, 9.5)
    panels = figure.subplot_mosaic([["a", "c"], ["b", "c"]], width_ratios=(1.2, 1))
    curve, bars, costs = panels["a"], panels["b"], panels["c"]
    along = jnp.linspace(0.6 * phi.min(), 1.05 * phi.max(), samples)
    newtons = np.asarray(along) * float(force[0] / phi[0])
    # Designs with the same exponent are one.
    _, one_of = np.unique(k.round(4), return_index=True)
    for place, n in enumerate(sorted(one_of)):
        colour, dashes, hatch = STYLES[place]
        words = " and ".join(name for name, other in zip(NAMES, k, strict=True) if abs(other - k[n]) < 1e-4)
        relative = fretting.wear_volume(k[n], along) / fretting.wear_volume(0.0, along)
        label = f"designed for the {words}: $k = {k[n]:.2f}$"
        curve.plot(newtons, relative, color=colour, linestyle=dashes, label=label)
        # bars lie, so that each has its number beside it
        places = -np.arange(3) * 4.0 - place
        beside = costs.barh(places, 100.0 * excess[n], 0.8, color=colour, hatch=hatch, edgecolor="w")
        costs.bar_label(beside, [f"{100.0 * x:.2g}" for x in excess[n]], fontsize=7, padding=3)
    curve.axhline(1.0, color="0.75", linewidth=0.6, zorder=0)
    curve.set_ylabel("wear over that at $k = 0$")
    legend_above(figure, curve, 2)
    mean_wear = probability * np.asarray(fretting.wear_volume(k[1], phi[:-1]))
    width = 0.4 * np.diff(load["tangential_force"]).min()
    for shift, share, colour, label in (
        (-0.5, probability, "0.7", "of the contacts"),
        (0.5, mean_wear / mean_wear.sum(), "#CC79A7", f"of the wear, $k = {k[1]:.2f}$"),
    ):
        bars.bar(load["tangential_force"] + shift * width, share, width, color=colour, label=label)
    bars.axvline(float(force[-1]), color="0.3", linewidth=0.8, linestyle=":")
    bars.text(float(force[-1]), 0.96, " mean", transform=bars.get_xaxis_transform(), fontsize=7, va="top")
    bars.set(xlabel="amplitude of the tangential force $F_x$ (N)", ylabel="share")
    bars.yaxis.set_major_formatter(PercentFormatter(1.0, decimals=0))
    bars.legend()
    bars.sharex(curve)
    curve.set_xlim(newtons[0], newtons[-1])
    curve.tick_params(labelbottom=False)
    costs.set(
        xlim=(0.0, 112.0 * excess.max()),
        yticks=[-0.5 * (one_of.size - 1) - 4.0 * n for n in range(3)],
        ylabel="judged by",
        xlabel="wear above the least by this measure (%)",
    )
    costs.set_yticklabels(LEVELS, rotation=90, va="center")
    letters([curve, bars, costs])
    costs.tick_params(axis="y", length=0.0)
    costs.set_title(f"wrong choice: up to {100.0 * excess.max():.0f} % more wear", loc="right")
    save(figure, out / "uncertain_load.png")


if __name__ == "__main__":
    run(main)
