"""For one variable: whether anything better can lie between the points of a scan."""

from typing import Any

from plgwear_jax.optimise.namespace import namespace

__all__ = ["nothing_hides"]


def nothing_hides(
    axis: Any, values: Any, slopes: Any, best: Any, best_values: Any, multipliers: Any, slack: Any
) -> Any:
    """Whether no interval of the scan can contain a point that keeps the limits and is lower than the best.

    An interval is excluded if a limit is broken everywhere in it, if a lower bound of the objective, or of the
    Lagrangian, lies above the best, or if the Lagrangian is convex from there to the best, where it is stationary. The
    bounds are Taylor polynomials from both ends, with the least second derivative that the interval can have.

    Args:
        axis: Points of the scan, (samples,).
        values: Of the objective and the limits there, (samples, 1 + m).
        slopes: Their derivatives, (samples, 1 + m).
        best: The best point.
        best_values: The objective and the limits there, (1 + m,).
        multipliers: Of the limits there, (m,).
        slack: The amount by which a point may be lower than the best.
    """
    xp = namespace(values, best)
    step = axis[1] - axis[0]
    # the objective, the limits, and last the Lagrangian
    weights = xp.concatenate([xp.ones_like(best_values[:1]), multipliers])
    values, slopes = (xp.concatenate([x, (weights * x).sum(1)[:, None]], axis=1) for x in (values, slopes))

    # The mean second derivative of each interval is known. Its least value inside is taken as the least mean of the
    # interval and its neighbours, minus the larger difference between the means of neighbours.
    mean = (slopes[1:] - slopes[:-1]) / step
    beside = xp.concatenate([mean[:1], mean, mean[-1:]])
    change = xp.abs(mean[1:] - mean[:-1])
    change = xp.concatenate([change[:1], change, change[-1:]])
    lowest = xp.minimum(mean, xp.minimum(beside[:-2], beside[2:]))
    least = lowest - xp.maximum(change[:-1], change[1:])

    def bound(value: Any, inward: Any) -> Any:
        """The least value in each interval, from one of its ends."""
        bowl = xp.clip(-inward / xp.where(least > 0.0, least, 1.0), 0.0, step)
        ends = xp.minimum(0.0, step * (inward + 0.5 * least * step))
        return value + xp.where(least > 0.0, bowl * (inward + 0.5 * least * bowl), ends)

    bounds = xp.maximum(bound(values[:-1], slopes[:-1]), bound(values[1:], -slopes[1:]))
    above = (bounds[:, 0] >= best_values[0] - slack) | (bounds[:, -1] >= best_values[0] - slack)
    above = above | xp.any(bounds[:, 1:-1] > 0.0, axis=1)
    intervals = xp.arange(axis.size - 1)
    home = xp.clip(xp.sum(axis <= best) - 1, 0, axis.size - 2)
    bent = least[:, -1] < 0.0
    before = xp.max(xp.where(bent & (intervals <= home), intervals, -1))
    behind = xp.min(xp.where(bent & (intervals >= home), intervals, axis.size))
    return xp.all(above | ((intervals > before) & (intervals < behind)))
