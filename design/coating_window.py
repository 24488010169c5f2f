"""Which coating is best among those that a maker can produce, if he states the modulus at two depths?

The window, the contact and its limit are those of hip_taper.toml. Both moduli together are k and E0/z0^k in other
words: their ratio is k, and their size the contact radius, which may not become too small.
"""

from pathlib import Path
from types import SimpleNamespace

import jax.numpy as jnp
import numpy as np
from drawing import COLOURS, HERE, LEGEND, MARK, finish, page, plain_ticks, print_table, run, save

from plgwear_jax import FrettingContact, PowerLawGraded, scene

EXPONENTS = (-0.2, -0.1, 0.0, 0.1)
MORE = 0.05  # wear above the least, on the edge of the plateau


def main(out: Path, points: int = 121) -> None:
    given = scene.load(HERE / "hip_taper.toml")
    found = given.design()
    reference, best = found.reference, found.contact
    assert isinstance(reference, FrettingContact) and isinstance(best, FrettingContact)
    assert given.load is not None and given.design_space is not None
    force, window = given.load.largest, SimpleNamespace(**given.design_space.variables["modulus"])
    print(f"converged: {found.converged}; a global search found nothing better: {found.certified}")
    (z1, z2), smallest = window.at, float(np.asarray(found.limits["contact_radius_lowest"].allowed))

    # All coatings of the window at once: the fields of a contact broadcast.
    E1, E2 = (
        jnp.geomspace(lowest, highest, points)
        for lowest, highest in zip(window.lower, window.upper, strict=True)
    )  # fmt: skip
    k = jnp.log(E2[:, None] / E1) / np.log(z2 / z1)
    coatings = FrettingContact(
        PowerLawGraded(E1, z1, k, reference.material.nu), reference.radius, reference.normal_force, reference.friction
    )
    wear, radius = (
        np.asarray(x) for x in (coatings.steady(force).wear_volume * 1e18, coatings.steady(0.0).contact_radius)
    )
    permitted = np.where(radius >= smallest, wear, np.inf)
    print(f"least wear on a grid of {points} x {points} coatings that keep the limit: {permitted.min():.1f} µm³")

    figure = page(18.0, 8.5)
    left, right = figure.subplots(1, 2, width_ratios=(1.25, 1))
    shades = left.contourf(E1 / 1e9, E2 / 1e9, wear, levels=14, cmap="viridis")
    bar = figure.colorbar(shades, ax=left, pad=0.02)
    bar.set_label("wear volume (µm³)", fontsize=8)
    bar.ax.tick_params(labelsize=7.5)
    shown = np.where(radius >= smallest, k, np.nan)
    lines = left.contour(E1 / 1e9, E2 / 1e9, shown, levels=EXPONENTS, colors="w", linewidths=0.8, linestyles="-")
    rises = [(z2 / z1) ** exponent for exponent in EXPONENTS]
    feet = [1.17 * max(window.lower[0], window.lower[1] / rise) / 1e9 for rise in rises]
    places = [(foot, foot * rise) for foot, rise in zip(feet, rises, strict=True)]
    left.clabel(lines, fmt=lambda value: f"$k = {value:g}$", fontsize=7, manual=places)
    left.contourf(E1 / 1e9, E2 / 1e9, radius, levels=[0.0, smallest], colors=["0.85"], hatches=["///"])
    left.contour(E1 / 1e9, E2 / 1e9, radius, levels=[smallest], colors="k", linewidths=1.2)
    least = float(best.steady(force).wear_volume) * 1e18
    plateau = np.where(radius >= 0.98 * smallest, wear / least - 1.0, np.nan)
    left.contour(E1 / 1e9, E2 / 1e9, plateau, levels=[MORE], colors="w", linewidths=1.2, linestyles=":")
    left.text(
        0.97, 0.04, f"hatched: contact radius below {smallest * 1e6:g} µm", transform=left.transAxes, ha="right",
        fontsize=7.5, bbox={"facecolor": "w", "edgecolor": "none", "pad": 2.0},
    )  # fmt: skip
    depth = np.geomspace(z1, z2, 121)
    rows = []
    for name, contact, colour, dashes, marker in (
        ("best", best, "blue", "-", "o"),
        ("reference", reference, "orange", (0, (4, 1.5)), "s"),
    ):
        at = [float(contact.material.modulus(z)) / 1e9 for z in window.at]
        left.plot(*at, marker, color=COLOURS[colour], markersize=6, clip_on=False, **MARK)
        right.plot([z * 1e6 for z in window.at], at, marker, color=COLOURS[colour], markersize=6, **MARK)
        exponent = float(np.asarray(contact.material.k))
        right.loglog(
            depth * 1e6, contact.material.modulus(depth) / 1e9, color=COLOURS[colour], linestyle=dashes, linewidth=1.4,
            label=f"{name}, $k = {exponent:.2g}$",
        )  # fmt: skip
        volume, a_0 = float(contact.steady(force).wear_volume) * 1e18, float(contact.steady(0.0).contact_radius) * 1e6
        rows.append([name, f"{exponent:+.3f}", *(f"{x:.1f}" for x in at), f"{a_0:.1f}", f"{volume:.1f}"])
    columns = ["", "k", *(f"E({z * 1e6:g} µm), GPa" for z in window.at), "contact radius, µm", "wear volume, µm³"]
    print_table(columns, rows)
    print(f"less wear than the reference: {100.0 * found.saving:.1f} %")
    for depth_of_window, lowest, highest in zip(window.at, window.lower, window.upper, strict=True):
        right.plot(
            [depth_of_window * 1e6] * 2, [lowest / 1e9, highest / 1e9], color="0.6", linewidth=5, zorder=0,
            solid_capstyle="butt", label="can be produced" if depth_of_window == z1 else None,
        )  # fmt: skip
    left.set(xscale="log", yscale="log")
    plain_ticks(left.xaxis, (40, 60, 80, 100, 140))
    plain_ticks(left.yaxis, (40, 50, 60, 70))
    plain_ticks(right.xaxis, (1, 10, 100, 1000))
    plain_ticks(right.yaxis, (40, 60, 80, 100, 150))
    left.set_xlabel(f"modulus at {z1 * 1e6:g} µm depth (GPa)")
    left.set_ylabel(f"modulus at {z2 * 1e6:g} µm depth (GPa)")
    right.set(xlabel="depth $z$ (µm)", ylabel="Young's modulus $E(z)$ (GPa)")
    right.axvline(
        float(best.steady(0.0).contact_radius) * 1e6, color="0.5", linewidth=0.7, linestyle=":", label="contact radius"
    )
    figure.legend(**LEGEND, loc="outside upper center", ncols=5)
    finish([left, right])
    left.set_title(f"dotted: {100 * MORE:g} % more wear than the best", loc="right", fontsize=7.5)
    right.set_title(f"best: {100.0 * found.saving:.0f} % less wear", loc="right", fontsize=7.5)
    save(figure, out / "coating_window.png")


if __name__ == "__main__":
    run(main)
