"""Replace infinite values of maps by NaN, which plots and statistics leave out."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import xarray as xr

from fastlink.doors import door
from fastlink.io.reader import as_dataset

__all__ = ["REPLACED", "finite"]

REPLACED = "infinite_values"  # attribute: how many infinite values a variable had


@door
def finite(maps: Any) -> Any:
    """Replace infinite values by NaN, and note how many there were.

    A quantity that grows without bound at a toggle has an infinite extreme. Matplotlib has no colour for it, and a mean
    over designs is infinite too.

    Parameters
    ----------
    maps : xarray.Dataset, xarray.DataArray or path
        A map, one of its variables, or the file of a map.

    Returns
    -------
    xarray.Dataset or xarray.DataArray
        A copy in memory, in which each variable that had infinite values has their number as attribute
        ``infinite_values``. Variables in dask chunks stay so, and are not counted.

    Raises
    ------
    InputError
        Neither a map nor its path.

    Examples
    --------
    >>> import fastlink as fl
    >>> space = fl.grid(a1=[0.5, 1.5], a2=1.2, a3=0.8, a4=1.0, omega1=25.0)
    >>> maps = fl.sweep("planar_4r", space, ["omega4_max"], branch=1)
    >>> maps.omega4_max.values.ravel().round(2), fl.finite(maps).omega4_max.values.ravel().round(2)
    (array([16.91,   inf]), array([16.91,   nan]))
    >>> fl.finite(maps).omega4_max.attrs["infinite_values"]
    1
    """
    if isinstance(maps, xr.DataArray):
        return _finite(maps)
    with as_dataset(maps) as dataset:
        result = dataset.assign({name: _finite(array).variable for name, array in dataset.data_vars.items()})
        return result.load() if isinstance(maps, (str, os.PathLike)) else result


def _finite(array: xr.DataArray) -> xr.DataArray:
    if array.dtype.kind != "f":
        return array
    if array.chunks is not None:
        return array.where(~np.isinf(array))
    infinite = np.isinf(array.values)
    count = int(np.count_nonzero(infinite))
    if not count:
        return array
    result = array.copy(data=np.where(infinite, np.nan, array.values).astype(array.dtype))
    result.attrs[REPLACED] = count + int(array.attrs.get(REPLACED, 0))
    return result
