"""What is drawn."""

from typing import NamedTuple

import numpy as np
import xarray as xr

__all__ = ["DECADES", "MapError", "Subject"]

DECADES = 2.0  # values over more decades need a logarithmic scale


class MapError(ValueError):
    """Why a picture cannot be drawn, in one line."""


class Subject(NamedTuple):
    """A quantity, its values with the rows from bottom to top, the sweep, and what a NaN means."""

    variable: xr.DataArray
    values: np.ndarray
    ds: xr.Dataset
    missing: str
