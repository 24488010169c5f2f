"""Which coating is best among those that a maker can produce, if he states the modulus at two depths?

The window, the contact and its limit are those of hip_taper.toml. Both moduli together are k and E0/z0^k in other
words: their ratio is k, and their size the contact radius, which may not become too small.
"""

from pathlib import Path

import jax.numpy as jnp
import numpy as np
from drawing import BLUE, HERE, MARK, ORANGE, legend_above, letters, page, print_table, run, save, show_units

from plgwear_jax import FrettingContact, PowerLawGraded, scene

EXPONENTS = (-0.2, -0.1, 0.0, 0.1)
MORE = 0.05  # wear above the least, on the edge of the plateau


def main(out: Path, points: int = 121) -> None:
    given = scene.load(HERE / "hip_taper.toml")
    found = given.design()
    reference, best = found.reference, found.contact
    assert isinstance(reference, FrettingContact) and isinstance(best, FrettingContact)
    assert given.load is not None and given.design_space is not None
    force, window = given.load.largest, given.design_space.variables["modulus"]
    print(f"converged: {found.converged}; a global search found nothing better: {found.certified}")
    depths, between = window["at"], window["between"]
    (z1, z2), smallest = depths, float(np.asarray(found.limits["contact_radius_lowest"].allowed))

    # All coatings of the window at once: the fields of a contact broadcast.
    E1, E2 = (jnp.geomspace(*ends, num=points) for ends in between)
    k = jnp.log(E2[:, None] / E1) / np.log(z2 / z1)
    coatings = FrettingContact(
        PowerLawGraded(E1, z1, k, reference.material.nu), reference.radius, reference.normal_force, reference.friction
    )
    wear, radius = (np.asarray(x) for x in (coatings.steady(force).wear_volume, coatings.steady(0.0).contact_radius))
    permitted = np.where(radius >= smallest, wear, np.inf)
    print(f"least wear on a grid of {points} x {points} coatings that keep the limit: {permitted.min() * 1e18:.1f} µm³")

    figure = page(18.0, 8.5)
    left, right = figure.subplots(1, 2, width_ratios=(1.25, 1))
    bar = figure.colorbar(left.contourf(E1, E2, wear, levels=14, cmap="viridis"), ax=left, pad=0.02)
    show_units(bar.ax.yaxis, "wear_volume")
    shown = np.where(radius >= smallest, k, np.nan)
    lines = left.contour(E1, E2, shown, levels=EXPONENTS, colors="w", linewidths=0.8, linestyles="-")
    rises = [(z2 / z1) ** exponent for exponent in EXPONENTS]
    feet = [1.17 * max(between[0][0], between[1][0] / rise) for rise in rises]
    places = [(foot, foot * rise) for foot, rise in zip(feet, rises, strict=True)]
    left.contourf(E1, E2, radius, levels=[0.0, smallest], colors=["0.85"], hatches=["///"])
    left.contour(E1, E2, radius, levels=[smallest], colors="k", linewidths=1.2)
    least = float(best.steady(force).wear_volume)
    plateau = np.where(radius >= 0.98 * smallest, wear / least - 1.0, np.nan)
    left.contour(E1, E2, plateau, levels=[MORE], colors="w", linewidths=1.2, linestyles="--")
    words = f"(a) hatched: contact radius below {smallest * 1e6:g} µm; dashed: {100 * MORE:g} % more wear than the best"
    figure.supxlabel(words, fontsize=7, color="0.3")
    depth = np.geomspace(z1, z2, 121)
    rows = []
    for name, contact, colour, dashes, marker in (
        ("best", best, BLUE, "-", "o"),
        ("reference", reference, ORANGE, (0, (4, 1.5)), "s"),
    ):
        at = [float(contact.material.modulus_at(z)) for z in depths]
        left.plot(*at, marker, color=colour, markersize=6, clip_on=False, **MARK)
        right.plot(depths, at, marker, color=colour, markersize=6, **MARK)
        exponent = float(np.asarray(contact.material.k))
        moduli = contact.material.modulus_at(depth)
        right.loglog(depth, moduli, color=colour, linestyle=dashes, label=f"{name}, $k = {exponent:.2g}$")
        volume, a_0 = float(contact.steady(force).wear_volume) * 1e18, float(contact.steady(0.0).contact_radius) * 1e6
        rows.append([name, f"{exponent:+.3f}", *(f"{x / 1e9:.1f}" for x in at), f"{a_0:.1f}", f"{volume:.1f}"])
    columns = ["", "k", *(f"E({z * 1e6:g} µm), GPa" for z in depths), "contact radius, µm", "wear volume, µm³"]
    print_table(columns, rows)
    print(f"less wear than the reference: {100.0 * found.saving:.1f} %")
    for z, ends in zip(depths, between, strict=True):
        right.plot(
            [z] * 2, ends, color="0.6", linewidth=5, zorder=0, solid_capstyle="butt",
            label="can be produced" if z == z1 else None,
        )  # fmt: skip
    a_0 = float(best.steady(0.0).contact_radius)
    right.axvline(a_0, color="0.5", linewidth=0.7, linestyle=":", label="contact radius of the best")
    left.set(xscale="log", yscale="log")
    for axis, z in ((left.xaxis, z1), (left.yaxis, z2)):
        show_units(axis, "modulus", f"modulus at {z * 1e6:g} µm depth")
    left.clabel(lines, fmt=lambda value: f"$k = {value:g}$", fontsize=7, manual=places)
    show_units(right.xaxis, "depth", size=1e-6)
    show_units(right.yaxis, "modulus")
    legend_above(figure, right, 4)
    letters([left, right])
    right.set_title(f"best: {100.0 * found.saving:.0f} % less wear than the reference", loc="right")
    save(figure, out / "coating_window.png")


if __name__ == "__main__":
    run(main)
