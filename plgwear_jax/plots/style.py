"""The common style of all pictures, of designs and of sweeps: colours, sizes, ticks."""

from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

__all__ = [
    "BEST",
    "CENTIMETRE",
    "DOT",
    "FORBIDDEN",
    "GUIDE",
    "LABEL_SIZE",
    "REFERENCE",
    "TICK_SIZE",
    "UNWORN",
    "for_print",
    "labelled",
    "plain_ticks",
]

# Two colours of Okabe and Ito, which everybody can tell apart, and different dashes for grey prints.
BEST = {"color": "#0072B2", "linestyle": "-", "linewidth": 1.4}
REFERENCE = {"color": "#D55E00", "linestyle": (0, (4, 1.5)), "linewidth": 1.4}
UNWORN = {"color": "0.55", "linestyle": "-", "linewidth": 0.9}
FORBIDDEN = {"color": "0.65", "linestyle": (0, (2, 1.5)), "linewidth": 0.9}
GUIDE = {"linewidth": 0.7, "linestyle": ":", "zorder": 0}
DOT = {"markersize": 5.5, "markeredgewidth": 0.7, "markeredgecolor": "k"}
LABEL_SIZE, TICK_SIZE = 8, 7.5  # points

CENTIMETRE = 1.0 / 2.54


def for_print(axes: Axes) -> None:
    """Ticks inwards on all sides, thin frames."""
    axes.tick_params(which="both", direction="in", top=True, right=True, labelsize=TICK_SIZE)
    for side in axes.spines.values():
        side.set_linewidth(0.6)


def plain_ticks(axis: Axis) -> None:
    """On a logarithmic axis over less than two decades, label few ticks, with plain numbers."""
    lower, upper = axis.get_view_interval()
    if upper < 100.0 * lower:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def labelled(words: str, unit_name: str) -> str:
    """Words with the unit behind, if there is one."""
    return f"{words} ({unit_name})" if unit_name else words
