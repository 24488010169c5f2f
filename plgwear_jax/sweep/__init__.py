"""Maps of quantities, their derivatives and optimal designs over any axes, of any size: labelled and resumable.

Needs the extra `sweep`: xarray, zarr, Dask. A sweep in memory is an `xarray.Dataset`. A sweep into a Zarr store is
computed and written chunk by chunk; after a stop, finished chunks are not computed again.
"""

from plgwear_jax._core.extras import needs

with needs("sweeps", "sweep"):
    import dask  # noqa: F401
    import filelock  # noqa: F401
    import xarray  # noqa: F401
    import zarr  # noqa: F401

from .axes import AxisError
from .names import QuantityError
from .store import SweepError, UnfinishedWarning, open_sweep
from .sweeping import Progress, sweep

__all__ = ["AxisError", "Progress", "QuantityError", "SweepError", "UnfinishedWarning", "open_sweep", "sweep"]
