"""The picture of the stresses under a contact, in the plane of the motion."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from plgwear_jax._core.units import written
from plgwear_jax.catalogue import entry
from plgwear_jax.plots.style import BLUE, DOT, GREEN, GUIDE, Style, page, picture, show_units
from plgwear_jax.steady.closed import Steady

_PEAK: Style = DOT | {"color": BLUE, "clip_on": False, "zorder": 5}
_REACH = 1.6  # of the picture to both sides and downwards, in contact radii
_TICKS = slice(10, -10, 10), slice(10, -10, 10)  # of the places, those whose directions are drawn
_LEVELS = 0.05, 0.1, 0.2, 0.4, 0.8
_COLOURS = 20  # about as many shades; a continuous scale makes files of three times the size


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
    x, z = a * np.linspace(-_REACH, _REACH, 161), a * np.linspace(2e-3, _REACH, 81)
    stress = steady.stress(x, z[:, None])
    tension = np.asarray(stress.principal) / p_0
    figure = page(18.0, 10.0, "compressed")
    axes = figure.subplots()
    colours = axes.contourf(x, z, np.asarray(stress.mises) / p_0, levels=_COLOURS)
    figure.colorbar(colours, ax=axes, label="von Mises stress / largest pressure", ticks=MaxNLocator(6))
    axes.contour(x, z, tension, levels=_LEVELS, colors="w", linewidths=0.7)
    shares = ", ".join(f"{level:g}" for level in _LEVELS)
    axes.plot([], color="w", linewidth=0.7, label=f"principal stress {shares}")
    turn = np.where(tension > 0.0, 0.5 * np.arctan2(2.0 * stress.xz, stress.xx - stress.zz), np.nan)[_TICKS]
    lines: Style = {"color": "w", "width": 1.2e-3, "headwidth": 0.0, "headlength": 0.0, "headaxislength": 0.0}
    axes.quiver(x[_TICKS[1]], z[_TICKS[0]], np.cos(turn), np.sin(turn), angles="xy", pivot="mid", scale=45.0, **lines)
    for depth in _interfaces(steady.contact.material):
        axes.axhline(depth, **GUIDE | {"color": "w", "zorder": 2})
    for edge, colour, words in ((a, "k", "contact"), (c, GREEN, "stick area")):
        axes.hlines(0.0, -edge, edge, color=colour, linewidth=5.0, label=words, clip_on=False)
    told = []
    for name, words, marker in (("peak_tension", "tension", "D"), ("peak_mises", "von Mises stress", "o")):
        place = (float(at) for at in getattr(steady, f"{name}_at"))
        axes.plot(*place, marker, label=f"largest {words}", **_PEAK)
        told.append(f"largest {words} {written(float(getattr(steady, name)), entry(name).unit)}")
    axes.set(xlim=x[[0, -1]], ylim=(z[-1], 0.0), title="; ".join(told), aspect="equal")
    for axis, words in ((axes.xaxis, "along the motion"), (axes.yaxis, "depth")):
        show_units(axis, words=words, unit=entry("r").unit, size=a)
    axes.legend(loc="lower right", frameon=True, facecolor="0.2", edgecolor="none", labelcolor="w")
    return figure


def _interfaces(material: object) -> np.ndarray:
    """Depths in m at which the modulus jumps."""
    depth = np.asarray(getattr(material, "depth", [0.0]))
    return np.append(np.cumsum(getattr(material, "thickness", [])), depth[1:][np.diff(depth) == 0.0])
