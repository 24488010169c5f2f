"""The parameters of a search."""

from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jax.typing import DTypeLike


class SearchPlan(NamedTuple):
    """The parameters of a search; they determine its program.

    Attributes:
        variables: n, how many variables.
        limits: m, how many limits.
        samples: Points of the scan along each variable.
        starts: How many valleys to descend from.
        max_steps: Evaluations allowed on each descent.
        noise: Relative error of the objective, below which differences have no meaning.
        dtype: The dtype of all numbers.
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
        """The number of evaluations of the scan."""
        return -(-(self.samples**self.variables) // self.lanes)

    @property
    def eps(self) -> float:
        """Relative rounding error."""
        return float(jnp.finfo(self.dtype).eps)

    @property
    def width(self) -> float:
        """The width of the stencil, whose differences of slopes stand for second derivatives."""
        return self.eps ** (1.0 / 3.0)

    @property
    def tolerance(self) -> float:
        """The relative slope at which it has converged: well above rounding errors, well below what users need."""
        return self.eps**0.625

    def axis_points(self) -> np.ndarray:
        """Points of the scan along a variable."""
        return np.linspace(-1.0, 1.0, self.samples).astype(self.dtype)

    def mesh(self) -> np.ndarray:
        """Points of the scan, (passes, lanes, n); the last evaluation is filled up with the first points."""
        points = np.stack(np.meshgrid(*self.variables * (self.axis_points(),), indexing="ij"), axis=-1)
        return np.resize(points, (self.passes, self.lanes, self.variables))

    def lengths(self) -> np.ndarray:
        """The lengths of the trial steps of a descent, in units of the longest."""
        return 0.25 ** np.arange(self.trials, dtype=self.dtype)


def plan_of(
    n: int,
    limits: int,
    dtype: Any = None,
    samples: int | None = None,
    starts: int | None = None,
    max_steps: int = 200,
    noise: float | None = None,
) -> SearchPlan:
    """The plan of the search for so many variables and limits."""
    dtype = np.dtype(jnp.result_type(float)) if dtype is None else dtype
    along = samples or {1: 65, 2: 33, 3: 17}.get(n, max(3, int(4096 ** (1.0 / n))))
    begun = min(along**n, starts or (3 if n == 1 else 24))
    noise = 16.0 * float(jnp.finfo(dtype).eps) if noise is None else noise
    return SearchPlan(n, limits, along, begun, max_steps, noise, dtype)
