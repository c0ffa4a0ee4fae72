"""Select the best designs of a map, block by block, so that it may be larger than memory."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from fastlink._text import short_repr
from fastlink.errors import InputError
from fastlink.maps.flags import check_flags, flags_of, has_flag
from fastlink.options import check_choice, check_switch, check_whole
from fastlink.space.design_space import DESIGN

__all__ = ["top"]

#: Values that are read at once.
MOST_VALUES = 1 << 22
STATUS = "status"


def top(maps: xr.Dataset, n: int, by: str, *, largest: bool, where: Any, infinite: bool) -> xr.Dataset:
    """Return the rows of a map with the greatest or least values of one variable; see `MapAccessor.top`."""
    n = check_whole(("n",), n, 1)
    check_switch(("largest",), largest)
    check_switch(("infinite",), infinite)
    key = _key(maps, by)
    mask = _mask(maps, key, where)
    best, kept = np.empty(0, dtype=np.int64), np.empty(0)
    left_out = {"not a number": 0, "infinite": 0}
    considered = 0
    for index, first in _blocks(key.shape, MOST_VALUES):
        values = np.asarray(key.variable[index].values, dtype=float).ravel()
        inside = _inside(mask, key, index)
        absent = np.isnan(values) & inside
        boundless = np.isinf(values) & inside & (not infinite)
        left_out["not a number"] += int(absent.sum())
        left_out["infinite"] += int(boundless.sum())
        considered += int(inside.sum())
        usable = np.flatnonzero(inside & ~absent & ~boundless)
        order = -values[usable] if largest else values[usable]
        chosen = _least(order, n)
        best = np.concatenate((best, first + usable[chosen]))
        kept = np.concatenate((kept, order[chosen]))
        again = _least(kept, n)
        best, kept = best[again], kept[again]
    rows = _rows(maps, key, best[np.lexsort((best, kept))])
    noted = ", ".join(f"{count:,} {kind}" for kind, count in left_out.items() if count)
    word = "greatest" if largest else "least"
    rows.attrs["selection"] = (
        f"{len(best)} {word} of {considered:,} values of {by}{f', without {noted}' if noted else ''}"
    )
    return rows


def _key(maps: xr.Dataset, by: Any) -> xr.DataArray:
    """Return the variable to rank by, or refuse it."""
    numeric = [
        str(name)
        for name, array in maps.data_vars.items()
        if array.dtype.kind in "iuf" and array.ndim and not flags_of(array)
    ]
    if not isinstance(by, str):
        remedy = "write the name of a variable; a new one is maps.assign(NAME=...)"
        raise InputError(f"is {short_repr(by)}", where=("by",), remedy=remedy)
    if by in maps.data_vars and by not in numeric:
        what = f"{short_repr(by)} is {'a code' if flags_of(maps[by]) else 'not a number for each design'}"
        remedy = f"select by where='MEANING', and rank by a number: {', '.join(numeric[:8])}"
        raise InputError(what, where=("by",), remedy=remedy)
    return maps[check_choice(("by",), by, numeric)]


def _mask(maps: xr.Dataset, key: xr.DataArray, where: Any) -> xr.DataArray | None:
    """Return the mask of the rows to consider, or None for all."""
    if where is None:
        return None
    if isinstance(where, str) or (isinstance(where, (list, tuple)) and where):
        if STATUS not in maps:
            what = "the map has no variable 'status'"
            raise InputError(what, where=("where",), remedy="give a mask, such as maps.a1 < 0.5")
        codes = check_flags(maps[STATUS], "where", [where] if isinstance(where, str) else where)
        where = has_flag(maps[STATUS], codes)
    if not isinstance(where, xr.DataArray) or where.dtype.kind != "b":
        remedy = "write a meaning of status, or a mask such as maps.a1 < 0.5"
        raise InputError(f"is {short_repr(where)}, not a mask", where=("where",), remedy=remedy)
    for dim, length in where.sizes.items():
        if key.sizes.get(dim) != length:
            what = (
                f"has {length} along {str(dim)!r}, {key.name} has {key.sizes.get(dim, 'no such dimension')}"
            )
            raise InputError(what, where=("where",), remedy="give a mask made from the same map")
    return where.transpose(*(dim for dim in key.dims if dim in where.dims))


def _blocks(shape: tuple[int, ...], most: int) -> Iterator[tuple[tuple[int | slice, ...], int]]:
    """Yield index and first flat number of consecutive pieces of an array, in C order.

    Examples
    --------
    >>> list(_blocks((2, 3), 2))[:2]
    [((0, slice(0, 2, None)), 0), ((0, slice(2, 4, None)), 2)]
    """
    lead = next(k for k in range(len(shape)) if math.prod(shape[k + 1 :]) <= most or k == len(shape) - 1)
    below = math.prod(shape[lead + 1 :])
    rows = max(1, most // max(1, below))
    for number, outer in enumerate(np.ndindex(shape[:lead])):
        for start in range(0, shape[lead], rows):
            yield (*outer, slice(start, start + rows)), (number * shape[lead] + start) * below


def _inside(
    mask: xr.DataArray | None, key: xr.DataArray, index: tuple[int | slice, ...]
) -> NDArray[np.bool_]:
    """Return which values of a block are considered, flat."""
    shape = np.broadcast_to(np.empty(()), key.shape)[index].shape
    if mask is None:
        return np.ones(math.prod(shape), dtype=bool)
    full = (*index, *(slice(None),) * (key.ndim - len(index)))
    of_mask = tuple(part for part, dim in zip(full, key.dims, strict=True) if dim in mask.dims)
    values = mask.variable[of_mask].values
    spread = [dim in mask.dims for part, dim in zip(full, key.dims, strict=True) if isinstance(part, slice)]
    values = values[tuple(slice(None) if there else None for there in spread)]
    return np.broadcast_to(values, shape).ravel()


def _least(values: NDArray[np.float64], n: int) -> NDArray[np.int64]:
    """Return the places of the n least values by growing place; of equal values the first."""
    if len(values) <= n:
        return np.arange(len(values))
    bound = np.partition(values, n - 1)[n - 1]
    below = np.flatnonzero(values < bound)
    equal = np.flatnonzero(values == bound)[: n - len(below)]
    return np.sort(np.concatenate((below, equal)))


def _rows(maps: xr.Dataset, key: xr.DataArray, flat: NDArray[np.int64]) -> xr.Dataset:
    """Return everything that a map says of some places of a variable, along ``design``."""
    places = dict(zip(key.dims, np.unravel_index(flat, key.shape), strict=True))

    def taken(array: xr.Variable) -> Any:
        if not array.dims:
            return array.copy(deep=False)
        picked = [
            array.isel({dim: int(places[dim][row]) for dim in array.dims}).values for row in range(len(flat))
        ]
        return (DESIGN,), np.array(picked, dtype=array.dtype), dict(array.attrs)

    def of_them(arrays: Any) -> dict[Any, Any]:
        return {name: taken(a.variable) for name, a in arrays.items() if set(a.dims) <= set(key.dims)}

    return xr.Dataset(of_them(maps.data_vars), of_them(maps.coords), dict(maps.attrs))
