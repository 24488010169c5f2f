"""A picture of the wear over blocks of cycles."""

import numpy as np
from matplotlib.figure import Figure

from plgwear_jax._core.numbers import for_numbers
from plgwear_jax.catalogue import entry
from plgwear_jax.contact import WearByBlocks
from plgwear_jax.plots.style import BEST, LABEL_SIZE, REFERENCE, TICK_SIZE, for_print, page, scaled

__all__ = ["blocks_picture"]


@for_numbers("draw what the program returns")
def blocks_picture(found: WearByBlocks) -> Figure:
    """Draw the worn volume over the cycles, and the force amplitude and the two radii at the end of each block.

    It takes numbers, not traced values: not under `jit`, `grad` or `vmap`.

    Args:
        found: The result of `contact.wear_by_blocks`.

    Returns:
        A figure 16 cm wide; `save` writes it.
    """
    figure = page(16.0, 6.5)
    places = {"left": 0.085, "right": 0.985, "bottom": 0.155, "top": 0.92, "wspace": 0.36}
    panels = figure.subplots(1, 3, gridspec_kw=places)
    cycles = np.append(0.0, found.cycles)
    worn, forces, radii = panels
    unit, label = scaled("volume", float(found.volume[-1]))
    worn.plot(cycles, np.append(0.0, found.volume) / unit, marker="o", markersize=3.0, **BEST)
    worn.set_ylabel(label, fontsize=LABEL_SIZE)
    unit, label = scaled("tangential_force", float(found.tangential_force.max()), entry("tangential_force").name)
    forces.stairs(found.tangential_force / unit, cycles, baseline=None, **BEST)
    forces.set_ylabel(label, fontsize=LABEL_SIZE)
    unit, label = scaled("r", float(found.contact_radius.max()), entry("r").name)
    radii.stairs(found.contact_radius / unit, cycles, baseline=None, label="contact", **BEST)
    radii.stairs(found.stick_radius / unit, cycles, baseline=None, label="stick", **REFERENCE)
    radii.set_ylabel(label, fontsize=LABEL_SIZE)
    radii.legend(frameon=False, fontsize=TICK_SIZE)
    for letter, axes in zip("abc", panels, strict=True):
        axes.set_xlabel(entry("cycles").label, fontsize=LABEL_SIZE)
        axes.ticklabel_format(axis="x", scilimits=(0, 4), useMathText=True)
        axes.xaxis.get_offset_text().set_fontsize(TICK_SIZE)
        axes.set_ylim(bottom=0.0)
        if cycles[-1] > 0.0:
            axes.set_xlim(0.0, 1.02 * cycles[-1])
        axes.set_title(f"({letter})", loc="left", y=1.0, fontsize=9, fontweight="bold")
        for_print(axes)
    return figure
