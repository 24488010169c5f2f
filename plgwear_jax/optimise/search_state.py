"""How a search is planned, and how far it has come.

The same code serves arrays of NumPy, which compile nothing, and of JAX, for use in compiled programs.
"""

from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax.typing import DTypeLike

if TYPE_CHECKING:
    import optax


SCAN, DESCENT, POLISH, DONE = range(4)  # the phases


class Plan(NamedTuple):
    """The parameters of a search; they determine its program.

    Attributes:
        variables: n, how many variables.
        limits: m, how many limits.
        samples: Points of the scan along each variable.
        starts: How many valleys to descend from.
        max_steps: Evaluations allowed on each descent.
        noise: Relative error of the objective, below which differences have no meaning.
        dtype: The dtype of all numbers.
        solver: An optax transformation; None for L-BFGS with a backtracking line search.
        axis: Name of the axis along which `jax.vmap` batches problems, which then change phase together; None if there
            is no such axis or it is not known.
    """

    variables: int
    limits: int
    samples: int
    starts: int
    max_steps: int
    noise: float
    dtype: DTypeLike
    solver: "optax.GradientTransformation | None" = None
    axis: str | None = None

    @property
    def trials(self) -> int:
        """Points for each start: steps of several lengths in a descent, a stencil in Newton's method."""
        return 2 * self.variables + 1

    @property
    def lanes(self) -> int:
        """The number of points in each evaluation."""
        return self.starts * self.trials

    @property
    def passes(self) -> int:
        """The number of evaluations of the scan; the last one is padded."""
        return -(-(self.samples**self.variables) // self.lanes)

    @property
    def eps(self) -> float:
        """Relative rounding error."""
        return float(jnp.finfo(self.dtype).eps)

    @property
    def width(self) -> float:
        """The width of the stencil, whose differences of slopes stand for second derivatives."""
        return self.eps ** (1.0 / 3.0)

    def axis_points(self) -> np.ndarray:
        """Points of the scan along a variable."""
        return np.linspace(-1.0, 1.0, self.samples).astype(self.dtype)

    def mesh(self) -> np.ndarray:
        """Points of the scan, (passes, lanes, n)."""
        axes = np.meshgrid(*self.variables * (self.axis_points(),), indexing="ij")
        points = np.stack([axis.ravel() for axis in axes], axis=-1)
        filled = np.pad(points, ((0, self.passes * self.lanes - len(points)), (0, 0)), mode="edge")
        return filled.reshape(self.passes, self.lanes, self.variables)


class Scanned(NamedTuple):
    """The results of the scan; slopes are kept only for one variable, where the proof needs them."""

    values: Any  # (passes, lanes, 1 + m)
    slopes: Any  # (passes, lanes, 1 + m), or empty for several variables


class Descent(NamedTuple):
    """The state of each descent: the point, its values, the next trial steps, multipliers and penalty of the limits."""

    u: Any  # (starts, n)
    values: Any  # (starts, 1 + m)
    slopes: Any  # (starts, 1 + m, n)
    free: Any  # (starts, n), variables that are not on a bound
    direction: Any  # (starts, n)
    length: Any  # (starts,), of the longest of the next trial steps
    memory: tuple[Any, ...]  # the leaves of the solver's state, (starts, ...) each
    fresh: Any  # (starts,), the memory has to be reset
    multipliers: Any  # (starts, m)
    penalty: Any  # (starts,)
    violation: Any  # (starts,)
    steps: Any  # (starts,)
    done: Any  # (starts,)


class Point(NamedTuple):
    """Stationary points and their values, one for each start."""

    u: Any
    multipliers: Any
    side: Any
    values: Any
    slopes: Any
    residual: Any


class Polish(NamedTuple):
    """The state of Newton's method, and the points with the least residual of the conditions."""

    u: Any
    multipliers: Any
    best: Point
    count: Any  # (starts,), steps


class Kept(NamedTuple):
    """The lowest point that keeps the limits among all at which there are values; infinite if none does."""

    u: Any  # (n,)
    values: Any  # (1 + m,)
    slopes: Any  # (1 + m, n)


class State(NamedTuple):
    """A search under way."""

    phase: Any
    passes: Any  # evaluations so far
    points: Any  # whose values the search needs next, (lanes, n)
    scanned: Scanned
    kept: Kept | None  # None without limits
    scale: Any  # the change of the objective and of each limit over the scan, (1 + m,)
    valleys: Any  # the number of valleys that the scan found
    descent: Descent
    polish: Polish


class Solution(NamedTuple):
    """The best minimum and its rival, and how the search ended."""

    u: Any  # (2, n), the same point twice if there is no rival
    multipliers: Any  # (2, m), of the functions over their scales
    values: Any  # (2, 1 + m)
    slopes: Any  # (2, 1 + m, n)
    side: Any  # of the best
    scale: Any  # of the objective and of the limits, (1 + m,)
    residual: Any
    converged: Any
    certified: Any
    proven: Any
    has_rival: Any
    steps: Any


def tolerance(dtype: DTypeLike) -> float:
    """The relative slope at which a search has converged: well above rounding errors, well below what users need."""
    return float(np.finfo(np.dtype(dtype)).eps) ** 0.625


def with_row(scanned: Scanned, row: Any, scanning: Any, values: Any, slopes: Any) -> Scanned:
    """The scan with one more row."""

    def written(rows: Any, new: Any) -> Any:
        if rows.size == 0:
            return rows
        if isinstance(rows, np.ndarray) and isinstance(new, np.ndarray):
            return np.where((scanning & (np.arange(len(rows)) == row))[:, None, None], new, rows)
        old = jax.lax.dynamic_index_in_dim(rows, row, keepdims=False)
        return jax.lax.dynamic_update_index_in_dim(rows, jnp.where(scanning, new, old), row, 0)

    return Scanned(written(scanned.values, values), written(scanned.slopes, slopes))


def all_done(plan: Plan, done: Any) -> Any:
    """Whether all starts are done, in all problems of the batch."""
    everybody = done.all()
    return everybody if plan.axis is None else jax.lax.pmin(everybody.astype(int), plan.axis) > 0


def in_lanes(points: Any) -> Any:
    """Trials of all starts, (starts, trials, n), as points of one evaluation."""
    return points.reshape(-1, points.shape[-1])


def of_starts(plan: Plan, state: State, values: Any, slopes: Any) -> tuple[Any, Any]:
    """The values and slopes for each start and its trials, divided by the scale of each function."""
    values, slopes = values / state.scale, slopes / state.scale[:, None]
    return tuple(x.reshape(plan.starts, plan.trials, *x.shape[1:]) for x in (values, slopes))


# --- NumPy or JAX -----------------------------------------------------------------------------------------------------


def namespace(*arrays: Any) -> ModuleType:
    """`numpy` if all arrays (or numbers) are of NumPy, else `jax.numpy`."""
    return jnp if any(isinstance(array, jax.Array) for array in arrays) else np


def select(condition: Any, these: Any, those: Any) -> Any:
    """Leaf by leaf, these where the condition holds, along the first axes of each leaf, and those elsewhere."""
    xp = namespace(condition)

    def chosen(this: Any, that: Any) -> Any:
        return xp.where(xp.reshape(condition, condition.shape + (1,) * (this.ndim - condition.ndim)), this, that)

    return jax.tree.map(chosen, these, those)
