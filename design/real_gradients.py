"""Does the paper's rule survive in coatings that can be made: of a finite ratio of moduli, and of a finite thickness?

The rule: a stiff surface (k < 0) wears less at small amplitudes, a compliant one (k > 0) at larger amplitudes. Here the
modulus of the surface is 2 or 5 times that of the substrate, or a half or a fifth of it, and goes over to the substrate
within a thickness of 0.3, 1 or 3 contact radii, gradually or at once. All have the same contact radius: each is as
stiff as a whole as this needs. The indenter is rigid.
"""

from pathlib import Path

import numpy as np
from drawing import letters, page, print_table, run, save

from plgwear_jax import DepthGraded, FrettingContact, fretting

RATIOS = (5.0, 2.0, 0.5, 0.2)  # of the modulus of the surface to that of the substrate
THICKNESSES = (0.3, 1.0, 3.0)  # in contact radii
EXPONENTS = (-0.2, 0.2)  # of power laws beside those that are gradual
# Those that are drawn; the table has all.
STYLES = {
    5.0: ("#08306b", "-", "surface 5 times as stiff"),
    0.2: ("#a63603", (0, (4, 1.2)), "surface 5 times as compliant"),
}
RADIUS, FORCE, FRICTION, NU = 5e-3, 10.0, 0.4, 0.3
HELD = 7e-5  # m, the contact radius of all


def shape(ratio: float, thickness: float, gradual: bool) -> tuple[np.ndarray, np.ndarray]:
    """Depths in m, and the modulus there in units of that of the substrate."""
    share = np.array([0.0, 0.25, 0.5, 0.75, 1.0, 1.0, 1.5])
    modulus = ratio ** np.clip(1.0 - share, 0.0, 1.0) if gradual else np.where(np.arange(7) < 5, ratio, 1.0)
    return thickness * HELD * share, modulus


def held(depth: np.ndarray, modulus: np.ndarray, force: np.ndarray, digits: int) -> np.ndarray:
    """The volumes worn on this half-space, in m^3, if it is as stiff as a whole as the contact radius needs."""
    stiffness = 1.1e11
    while True:
        contact = FrettingContact(DepthGraded(depth, stiffness * modulus, NU), RADIUS, FORCE, FRICTION)
        missed = float(contact.steady(0.0, digits=digits).contact_radius) / HELD
        if abs(missed - 1.0) < 1e-5:  # the wear goes with the fourth power of the radius
            return np.asarray(contact.steady(force, digits=digits).wear_volume) / missed**4
        stiffness *= missed**3


def main(out: Path, points: int = 25, digits: int = 4) -> None:
    phi = 1.0 / (1.0 + np.exp(-np.linspace(np.log(0.01), np.log(9.0), points)))
    cases = [(t, ratio, gradual) for t in THICKNESSES for ratio in RATIOS for gradual in (True, False)]
    worn = [held(*shape(ratio, t, gradual), phi * FRICTION * FORCE, digits) for t, ratio, gradual in cases]
    volume = np.array(worn) * RADIUS / HELD**4
    homogeneous = np.asarray(fretting.wear_volume(0.0, phi))
    more = {case: 100.0 * (row / homogeneous - 1.0) for case, row in zip(cases, volume, strict=True)}

    figure = page(18.0, 12.5)
    grid = figure.subplots(2, 3, sharex=True, sharey="row")
    for kind, row in zip((True, False), grid, strict=True):
        for axes, t in zip(row, THICKNESSES, strict=True):
            axes.axhline(0.0, color="0.4", linewidth=0.6)
            for k, dash in zip(EXPONENTS if kind else (), (":", "-."), strict=False):
                law = 100.0 * (np.asarray(fretting.wear_volume(k, phi)) / homogeneous - 1.0)
                axes.plot(phi, law, color="0.5", linewidth=0.9, linestyle=dash, label=f"power law, $k = {k:g}$")
            for ratio, (color, dash, named) in STYLES.items():
                axes.semilogx(phi, more[t, ratio, kind], color=color, linestyle=dash, label=named)
            axes.set(xlim=(phi[0], phi[-1]), xticks=(0.01, 0.1, 0.5), xticklabels=("0.01", "0.1", "0.5"))
            stiff, compliant = (more[t, ratio, kind][0] for ratio in STYLES)
            words = f"stiff {stiff:+.0f} %, compliant {compliant:+.0f} %".replace("-", "−")
            axes.set_title(rf"thickness {t:g} $a_0$; at $\varphi = {phi[0]:.2f}$:" f"\n{words}", loc="right")
    for axes in grid[1]:
        axes.set_xlabel(r"force amplitude $\varphi = F_x/(\mu F_N)$")
    for axes, kind in zip(grid[:, 0], ("gradual", "layer"), strict=True):
        axes.set_ylabel(f"{kind}: change of wear (%)")
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
    letters(grid.ravel())
    save(figure, out / "real_gradients.png")

    rows = []
    for t, ratio, gradual in cases:
        row = more[t, ratio, gradual]
        turns = [float(np.interp(0.0, *sorted_pair)) for sorted_pair in crossings(row, phi)]
        rows.append(
            (
                f"{t:g}", f"{ratio:g}", "gradual" if gradual else "layer",
                *(f"{np.interp(x, phi, row):+.1f} %" for x in (0.02, 0.1, 0.3, 0.6, 0.9)),
                ", ".join(f"{turn:.2f}" for turn in turns) or "never",
            )
        )  # fmt: skip
    heads = (
        "thickness/a_0",
        "surface/substrate",
        "",
        *(f"phi = {x}" for x in (0.02, 0.1, 0.3, 0.6, 0.9)),
        "turns at phi",
    )
    print_table(heads, rows)
    survives = [more[t, high, gradual][0] < more[t, low, gradual][0] for t, high, low, gradual in pairs()]
    print(f"stiff beats compliant at phi = {phi[0]:.2f} in {sum(survives)} of {len(survives)} pairs of coatings")


def pairs() -> list[tuple[float, float, float, bool]]:
    """A stiff surface beside a compliant one, of the same ratio, thickness and kind."""
    return [(t, r, 1.0 / r, gradual) for t in THICKNESSES for r in (5.0, 2.0) for gradual in (True, False)]


def crossings(row: np.ndarray, phi: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Neighbouring values between which the sign changes, rising, with their amplitudes."""
    places = np.flatnonzero(np.sign(row[1:]) != np.sign(row[:-1]))
    return [(row[i : i + 2][order], phi[i : i + 2][order]) for i in places for order in [np.argsort(row[i : i + 2])]]


if __name__ == "__main__":
    run(main)
