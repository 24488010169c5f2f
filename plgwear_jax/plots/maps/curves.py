"""Curves along one axis."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from plgwear_jax.plots.maps.colours import BLANK, Span, note, span_of
from plgwear_jax.plots.maps.rows import Row, edges_of, set_scale
from plgwear_jax.plots.maps.subject import Subject
from plgwear_jax.plots.maps.texts import plain_number, unit_of, words_of
from plgwear_jax.plots.style import (
    BEST,
    LABEL_SIZE,
    REFERENCE,
    labelled,
)

__all__ = [
    "draw_curves",
    "runs",
]


# Colours of Okabe and Ito; dashes besides, for grey prints.
_CURVES: tuple[dict[str, Any], ...] = (
    BEST,
    REFERENCE,
    {"color": "#009E73", "linestyle": (0, (6, 1.5, 1, 1.5)), "linewidth": 1.4},
    {"color": "#AA4499", "linestyle": (0, (1, 1.2)), "linewidth": 1.6},
    {"color": "k", "linestyle": (0, (9, 2)), "linewidth": 1.0},
    {"color": "#E69F00", "linestyle": (0, (3, 1.2, 1, 1.2, 1, 1.2)), "linewidth": 1.6},
)
# --- curves ---------------------------------------------------------------------------------------------------------


def draw_curves(axes: Axes, subject: Subject, across: Row, other: Row | None) -> list[Any]:
    """Draw one curve, or one for each value of the other axis; the entries of the legend."""
    values = subject.values
    curves = range(values.shape[0])
    axes.set_xmargin(0.0)
    set_scale(axes, "x", across)
    if values.dtype.kind == "b":
        factor = 1.0
        axes.set_yticks([0.0, 1.0], ["no", "yes"])
        axes.set_ylim(-0.2, 1.2)
        axes.set_ylabel(words_of(subject.variable), fontsize=LABEL_SIZE)
        notes = []
    else:
        span = span_of(values, subject.variable)
        factor, unit = unit_of(subject, span)
        axes.set_ylabel(labelled(words_of(subject.variable), unit), fontsize=LABEL_SIZE)
        notes = _stand_up(axes, span, factor)
    handles: list[Any] = []
    for place in curves:
        style: dict[str, Any] = {
            **_CURVES[place % len(_CURVES)],
            "label": "" if other is None else _entry(other, place),
        }
        if across.names is not None:
            style |= {"linestyle": "", "marker": "osD^v*"[place % 6], "markersize": 5.0}
        elif across.places.size <= 12:  # so few that people want to see where they are
            style |= {"marker": "osD^v*"[place % 6], "markersize": 3.0}
        if values.dtype.kind == "b" and across.names is None:
            style["drawstyle"] = "steps-mid"
        (line,) = axes.plot(across.shown, np.asarray(values[place], float) / factor, **style)
        if other is not None:
            handles.append(line)
    blank = np.isnan(np.asarray(values, float))
    if across.names is None and np.any(np.all(blank, axis=0)):
        edges = edges_of(across)
        for first, last in runs(np.all(blank, axis=0)):
            axes.axvspan(edges[first], edges[last + 1], color=BLANK, linewidth=0.0, zorder=0)
        handles.append(Patch(facecolor=BLANK, label=f"grey: {subject.missing}"))
    elif np.any(blank):
        notes.append(f"gaps: {subject.missing}")
    return [*handles, *(note(text) for text in notes)]


def _stand_up(axes: Axes, span: "Span", factor: float) -> list[str]:
    """The scale upwards, and what there is to say about it."""
    if span.log:
        axes.set_yscale("log")
        if span.clipped:
            axes.set_ylim(span.lower / factor, span.upper / factor)
        return [span.clipped] if span.clipped else []
    if span.signed:
        axes.axhline(0.0, color="0.7", linewidth=0.6, zorder=0)
    if span.bend:
        axes.set_yscale("asinh", linear_width=span.bend / factor)
        return []
    if span.clipped:
        margin = 0.03 * (span.upper - span.lower)
        axes.set_ylim((span.lower - margin) / factor, (span.upper + margin) / factor)
    axes.yaxis.set_major_locator(MaxNLocator(6))
    return [span.clipped] if span.clipped else []


def _entry(row: Row, place: int) -> str:
    if row.names is not None:
        return row.names[place]
    return f"${row.symbol}$ = {plain_number(row.shown[place], 4)} {row.unit}".rstrip()


def runs(true: np.ndarray) -> list[tuple[int, int]]:
    """First and last place of every row of neighbours that are true."""
    ends = np.flatnonzero(np.diff(np.concatenate([[False], true, [False]]).astype(int)))
    return [(int(first), int(last) - 1) for first, last in zip(ends[::2], ends[1::2], strict=True)]
