"""The picture of the stresses under a contact, in the plane of the motion."""

import numpy as np
from matplotlib.figure import Figure

from plgwear_jax._core.units import written
from plgwear_jax.catalogue import entry
from plgwear_jax.plots.style import BEST, DOT, GREEN, GUIDE, page, picture, show_units
from plgwear_jax.steady.solution import Steady

_WIDE, _DEEP, _PLACES = 1.6, 1.6, (161, 81)  # of the picture in contact radii
_TICKS = 17, 9  # directions that are drawn
_LEVELS = 0.05, 0.1, 0.2, 0.4, 0.8


@picture
def stress_picture(steady: Steady) -> Figure:
    """Draw the stresses before any wear under the largest tangential force, of one contact.

    Colours are von Mises' stress, contours the largest principal stress, and ticks its direction in the plane, where it
    is a tension. The contact and its stick area lie on top, interfaces are dotted, and both peaks are marked.
    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        steady: Of one contact; where the surface modulus is infinite, for k < 0, the picture begins below it.

    Returns:
        A figure 18 cm wide; `save` writes it.
    """
    a, c, p_0 = (float(x) for x in (steady.contact_radius, steady.stick_radius, steady.peak_initial_pressure))
    x, z = (a * np.linspace(low, high, n) for low, high, n in zip((-_WIDE, 2e-3), (_WIDE, _DEEP), _PLACES, strict=True))
    stress = steady.stress(x, z[:, None])
    mises, tension = np.asarray(stress.mises), np.asarray(stress.principal)
    figure = page(18.0, 10.0)
    axes = figure.subplots()
    colours = axes.pcolormesh(x, z, mises / p_0, shading="gouraud", cmap="viridis")
    figure.colorbar(colours, ax=axes, label="von Mises stress / largest pressure")
    axes.contour(x, z, tension / p_0, levels=_LEVELS, colors="w", linewidths=0.7)
    shares = ", ".join(f"{level:g}" for level in _LEVELS)
    axes.plot([], color="w", linewidth=0.7, label=f"principal stress {shares}")
    some = [np.linspace(0, at.size - 1, count).astype(int)[1:-1] for at, count in ((z, _TICKS[1]), (x, _TICKS[0]))]
    xx, zz, xz, first = (np.asarray(part)[np.ix_(*some)] for part in (stress.xx, stress.zz, stress.xz, tension))
    turn = np.where(first > 0.0, 0.5 * np.arctan2(2.0 * xz, xx - zz), np.nan)
    places = x[some[1]], z[some[0]]
    axes.quiver(
        *places,
        np.cos(turn),
        np.sin(turn),
        angles="xy",
        pivot="mid",
        color="w",
        scale=45.0,
        width=1.2e-3,
        headwidth=0.0,
        headlength=0.0,
        headaxislength=0.0,
    )
    for depth in _interfaces(steady.contact.material):
        if depth < z[-1]:
            axes.axhline(depth, **GUIDE | {"color": "w", "zorder": 2})
    axes.plot([-a, a], [0.0, 0.0], color="k", linewidth=5.0, solid_capstyle="butt", label="contact", clip_on=False)
    axes.plot([-c, c], [0.0, 0.0], color=GREEN, linewidth=5.0, solid_capstyle="butt", label="stick area", clip_on=False)
    told = []
    for name, words, marker in (("peak_tension", "tension", "D"), ("peak_mises", "von Mises stress", "o")):
        peak, place = float(getattr(steady, name)), [float(at) for at in getattr(steady, f"{name}_at")]
        own = DOT | {"marker": marker, "linestyle": "", "zorder": 5, "clip_on": False}
        axes.plot(*([at] for at in place), label=f"largest {words}", **(BEST | own))
        told.append(f"largest {words} {written(peak, entry(name).unit)}")
    axes.set(xlim=x[[0, -1]], ylim=(z[-1], 0.0), title="; ".join(told))
    axes.set_aspect("equal")
    for axis, words in ((axes.xaxis, "along the motion"), (axes.yaxis, "depth")):
        show_units(axis, words=words, unit=entry("r").unit, size=a)
    axes.legend(loc="lower right", frameon=True, facecolor="0.2", edgecolor="none", labelcolor="w")
    return figure


def _interfaces(material: object) -> np.ndarray:
    """Depths in m at which the modulus jumps."""
    depth = np.asarray(getattr(material, "depth", []))
    return np.append(
        np.cumsum(getattr(material, "thickness", [])), depth[1:][np.diff(depth) == 0.0] if depth.size else []
    )
