"""Pictures for people: what a design changed, drawn for print, and files that are whole or not there at all."""

import dataclasses
import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from plgwear_jax import fretting
from plgwear_jax.contact import FrettingContact
from plgwear_jax.optimise import Design

__all__ = ["PictureError", "check_target", "design_picture", "readable", "save"]

# Two colours of Okabe and Ito that everybody can tell apart, also in grey, and dashes besides.
BEST = {"color": "#0072B2", "linestyle": "-", "linewidth": 1.4}
REFERENCE = {"color": "#D55E00", "linestyle": (0, (4, 1.5)), "linewidth": 1.4}
UNWORN = {"color": "0.55", "linestyle": "-", "linewidth": 0.9}
GUIDE = {"linewidth": 0.7, "linestyle": ":", "zorder": 0}
DOT = {"markersize": 5.5, "markeredgewidth": 0.7, "markeredgecolor": "k"}
LABEL_SIZE, TICK_SIZE = 8, 7.5  # points

CENTIMETRE = 1.0 / 2.54


# --- units ----------------------------------------------------------------------------------------------------------

_PREFIXED = {
    "m": {1.0: "m", 1e-3: "mm", 1e-6: "µm", 1e-9: "nm", 1e-12: "pm"},
    "m^3": {1.0: "m³", 1e-9: "mm³", 1e-18: "µm³", 1e-27: "nm³"},
    "Pa": {1e12: "TPa", 1e9: "GPa", 1e6: "MPa", 1e3: "kPa", 1.0: "Pa"},
    "N": {1e6: "MN", 1e3: "kN", 1.0: "N", 1e-3: "mN", 1e-6: "µN"},
    "1": {1.0: ""},
}


def readable(size: float, unit: str) -> tuple[float, str]:
    """The SI prefix with which a person reads a number of this size.

    Args:
        size: The number, or the largest of several, in the unit.
        unit: "m", "m^3", "Pa", "N", or "1" for a plain number.

    Returns:
        What one of the prefixed unit is in the unit, to divide by, and the name of the prefixed unit.

    Example:
        >>> from plgwear_jax import plots
        >>> plots.readable(6.8e-5, "m")
        (1e-06, 'µm')
    """
    scales = _PREFIXED[unit]
    if size == 0.0:
        return 1.0, scales[1.0]
    smallest = 0.1 if unit == "m^3" else 1.0  # between the prefixes of a volume there are nine decades
    for factor, name in scales.items():
        if abs(size) >= smallest * factor:
            return factor, name
    return min(scales.items())


# --- the picture of a design ----------------------------------------------------------------------------------------


def design_picture(
    design: Design,
    tangential_force: float,
    bounds: Mapping[str, tuple[float, float]],
    *,
    hold: Literal["contact_radius"] | None = None,
) -> Figure:
    """Draw a design beside its reference: the modulus over the depth, the wear over the exponent, the worn profiles.

    Where only z0 varies, the wear is drawn over z0. Dotted lines mark the contact radius and the edges of the rings.

    Args:
        design: The result of `optimise.design`.
        tangential_force: The amplitude F_x in N that it was made for.
        bounds: The bounds that it was made within, as for `optimise.design`.
        hold: What was held, as for `optimise.design`.

    Returns:
        A figure 18 cm wide; `save` writes it.
    """
    figure = Figure(figsize=(18.0 * CENTIMETRE, 7.6 * CENTIMETRE), dpi=300, layout="constrained")
    panels = figure.subplot_mosaic([["a", "b", "c"], ["a", "b", "depth"]], height_ratios=[1, 1])
    panels["depth"].sharex(panels["c"])
    _draw_modulus(panels["a"], design, hold)
    _draw_wear(panels["b"], design, tangential_force, bounds, hold)
    _draw_ring(panels["c"], panels["depth"], design, tangential_force)
    for name, axes in panels.items():
        if len(name) == 1:
            axes.set_title(f"({name})", loc="left", fontsize=9, fontweight="bold")
        axes.tick_params(which="both", direction="in", top=True, right=True, labelsize=TICK_SIZE)
        for side in axes.spines.values():
            side.set_linewidth(0.6)
    figure.align_ylabels([panels["c"], panels["depth"]])
    entries = [
        Line2D([], [], label=f"{label}, $k = {np.asarray(contact.material.k):.3g}$", marker=marker, **DOT, **style)
        for contact, label, marker, style in _both(design)
    ]
    entries.append(Line2D([], [], label="unworn indenter", **UNWORN))
    figure.legend(
        handles=entries, loc="outside upper center", ncols=3, handlelength=3.5, frameon=False, fontsize=LABEL_SIZE
    )
    return figure


def _draw_modulus(axes: Axes, design: Design, hold: str | None) -> None:
    a_0 = float(design.reference.contact_radius())
    depth = a_0 * np.geomspace(0.01, 10.0, 121)
    unit, name = readable(a_0, "m")
    for contact, _, _, style in _both(design):
        axes.loglog(depth / unit, np.asarray(contact.material.modulus(depth)) / 1e9, **style)
        color = "0.5" if hold == "contact_radius" else style["color"]
        axes.axvline(float(contact.contact_radius()) / unit, color=color, **GUIDE)
    foot = axes.get_xaxis_transform()
    axes.text(1.1 * a_0 / unit, 0.02, "$a_0$", transform=foot, fontsize=LABEL_SIZE, va="bottom", color="0.3")
    axes.set_xlim(depth[0] / unit, depth[-1] / unit)
    axes.set_xlabel(f"depth $z$ ({name})", fontsize=LABEL_SIZE)
    axes.set_ylabel("Young's modulus $E(z)$ (GPa)", fontsize=LABEL_SIZE)


def _draw_wear(
    axes: Axes,
    design: Design,
    tangential_force: float,
    bounds: Mapping[str, tuple[float, float]],
    hold: str | None,
) -> None:
    name = "k" if "k" in bounds else "z0"
    values = np.linspace(*bounds["k"], 121) if name == "k" else np.geomspace(*bounds["z0"], 121)
    if hold is None:
        material = dataclasses.replace(design.contact.material, **{name: values})
        volumes = dataclasses.replace(design.contact, material=material).wear_volume(tangential_force)
    else:
        unit_volume = design.reference.contact_radius() ** 4 / design.reference.radius
        volumes = unit_volume * fretting.wear_volume(values, design.reference.amplitude(tangential_force))
    volumes = np.asarray(volumes)
    largest = max(float(volumes.max()), float(design.reference_wear_volume))
    unit, unit_name = readable(largest, "m^3")
    if largest >= 1e4 * unit:
        decades = math.floor(math.log10(largest / unit))
        unit, unit_name = unit * 10.0**decades, f"$10^{{{decades}}}$ {unit_name}"
    if name == "k":
        along = 1.0
        axes.set_xlabel("exponent $k$", fontsize=LABEL_SIZE)
    else:
        along, along_name = readable(float(values[-1]), "m")
        axes.set_xscale("log")
        axes.set_xlabel(f"characteristic depth $z_0$ ({along_name})", fontsize=LABEL_SIZE)
    axes.plot(values / along, volumes / unit, color="0.2", linewidth=1.1)
    for contact, _, marker, style in _both(design):
        where, volume = getattr(contact.material, name) / along, contact.wear_volume(tangential_force) / unit
        axes.plot(float(where), float(volume), marker, color=style["color"], zorder=4, **DOT)
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel(f"wear volume $\\Delta V$ ({unit_name})", fontsize=LABEL_SIZE)


def _draw_ring(above: Axes, below: Axes, design: Design, tangential_force: float) -> None:
    rings = [
        np.array([float(contact.stick_radius(tangential_force)), float(contact.worn_radius(tangential_force))])
        for contact, *_ in _both(design)
    ]
    inner, outer = np.min(rings), np.max(rings)
    margin = 0.12 * (outer - inner)
    widest = np.linspace(max(inner - margin, 0.0), outer + margin, 201)
    r = np.sort(np.concatenate([widest, *(np.linspace(ring[0], ring[1], 201) for ring in rings)]))
    unworn = 0.5 * r**2 / np.asarray(design.reference.radius)
    depths = [np.asarray(contact.wear_depth(r, tangential_force)) for contact, *_ in _both(design)]
    (along, along_name), (height, height_name) = readable(outer, "m"), readable(float(unworn[-1]), "m")
    depth, depth_name = readable(float(np.max(depths)), "m")

    above.plot(r / along, unworn / height, **UNWORN)
    for (*_, style), worn, ring in zip(_both(design), depths, rings, strict=True):
        above.plot(r / along, (unworn + worn) / height, **style)
        below.plot(r / along, worn / depth, **style)
        for edge in ring:
            above.axvline(edge / along, color=style["color"], **GUIDE)
            below.axvline(edge / along, color=style["color"], **GUIDE)
    above.set_xlim(r[0] / along, r[-1] / along)
    above.tick_params(labelbottom=False)
    above.set_ylabel(f"profile $f_\\infty$ ({height_name})", fontsize=LABEL_SIZE)
    below.set_ylim(bottom=0.0)
    below.set_xlabel(f"radius $r$ ({along_name})", fontsize=LABEL_SIZE)
    below.set_ylabel(f"$f_\\infty - f_0$ ({depth_name})", fontsize=LABEL_SIZE)


def _both(design: Design) -> tuple[tuple[FrettingContact, str, str, dict[str, Any]], ...]:
    return (design.contact, "best", "o", BEST), (design.reference, "reference", "s", REFERENCE)


# --- files ----------------------------------------------------------------------------------------------------------

_SUFFIXES = (".png", ".pdf", ".svg")


class PictureError(ValueError):
    """Why a picture cannot be written, in one line that begins with the file."""


def check_target(path: str | os.PathLike[str]) -> None:
    """See whether a picture could be written to a file, and leave nothing there.

    Raises:
        PictureError: The suffix is not that of a picture, or the place cannot be written to.
    """
    path = Path(path)
    if path.suffix.lower() not in _SUFFIXES:
        raise PictureError(f"{path}: must end in {', '.join(_SUFFIXES[:-1])} or {_SUFFIXES[-1]}")
    try:
        if path.is_dir():
            raise PictureError(f"{path}: is a folder, not a file to write a picture to")
        sibling = _sibling(path)
        sibling.touch(exist_ok=False)
        sibling.unlink()
    except OSError as error:
        raise PictureError(f"{path}: cannot be written: {error.strerror}") from None


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a figure to a file, which afterwards is either whole or as it was before.

    Args:
        figure: The figure.
        path: The file; its suffix says what it becomes: .png, .pdf or .svg.

    Raises:
        PictureError: The suffix is none of these, or the place cannot be written to.
    """
    check_target(path)
    path = Path(path)
    sibling = _sibling(path)
    try:
        figure.savefig(sibling, format=path.suffix[1:].lower())
        sibling.replace(path)
    except OSError as error:
        raise PictureError(f"{path}: cannot be written: {error.strerror}") from None
    finally:
        sibling.unlink(missing_ok=True)


def _sibling(path: Path) -> Path:
    """A file beside this one that nobody else writes to."""
    return path.with_name(f".{path.name}.{os.getpid()}.part")
