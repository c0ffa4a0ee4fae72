"""Broadcast the numbers of a call: arrays by their shapes, DataArrays by the names of their dimensions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fastlink._text import counted
from fastlink.errors import InputError

__all__ = ["MOST_CONFIGURATIONS", "broadcast_inputs", "like", "too_many"]

#: Most configurations at once; every value on the way is an array of as many.
MOST_CONFIGURATIONS = 10**8


def like(value: Any, numbers: NDArray[np.float64]) -> Any:
    """Return numbers with the labels of the value that they were read from."""
    if not hasattr(value, "dims"):
        return numbers
    import xarray as xr

    labelled = value if isinstance(value, xr.DataArray) else xr.DataArray(value)
    return labelled.copy(data=np.asarray(numbers))


def too_many(count: int, *inside: str) -> InputError:
    """Return the error of so many configurations that their arrays would fill the memory."""
    what = f"{counted(count, 'configuration')} are too many at once"
    remedy = f"write at most {MOST_CONFIGURATIONS}, or sweep them by fastlink.sweep"
    return InputError(what, where=inside, remedy=remedy)


def broadcast_inputs(function: str, values: Mapping[str, Any]) -> tuple[Any, dict[str, Any], tuple[int, ...]]:
    """Return a DataArray of the broadcast shape or else None, plain arrays, and the shape.

    Parameters
    ----------
    function : str
        The function that was called, for messages.
    values : mapping
        Names to numbers, arrays or DataArrays, checked. Arrays are broadcast by the caller; DataArrays here.

    Raises
    ------
    InputError
        Shapes do not broadcast, or coordinates do not agree; the two inputs are named.
    """
    if not any(hasattr(value, "dims") for value in values.values()):
        return None, dict(values), _shape(function, {name: np.shape(of) for name, of in values.items()})
    import xarray as xr

    wrapped = [value if hasattr(value, "dims") else xr.DataArray(value) for value in values.values()]
    lengths: dict[Any, tuple[str, Any]] = {}
    for name, value in zip(values, wrapped, strict=True):
        for dim in value.dims:
            first, other = lengths.setdefault(dim, (name, value))
            if other.sizes[dim] != value.sizes[dim]:
                lengths_of = f"{counted(value.sizes[dim], 'value')} along {dim!r}, {first} {other.sizes[dim]}"
                raise InputError(f"has {lengths_of}", where=(function, name), remedy="give equal lengths")
            if (
                dim in other.indexes
                and dim in value.indexes
                and not value.indexes[dim].equals(other.indexes[dim])
            ):
                what = f"has other coordinates along {dim!r} than {first}"
                raise InputError(what, where=(function, name), remedy="select those that both have")
            if dim in value.indexes and dim not in other.indexes:
                lengths[dim] = name, value
    shape = tuple(other.sizes[dim] for dim, (_, other) in lengths.items())
    if math.prod(shape) > MOST_CONFIGURATIONS:
        raise too_many(math.prod(shape), function)
    arrays = dict(zip(values, xr.broadcast(*wrapped), strict=True))
    template = next(iter(arrays.values())).astype(float)
    template.attrs = {}
    return template, {name: value.data for name, value in arrays.items()}, template.shape


def _shape(function: str, shapes: Mapping[str, tuple[int, ...]]) -> tuple[int, ...]:
    """Return the shape that all shapes broadcast to, or name two that do not broadcast."""
    try:
        shape = np.broadcast_shapes(*shapes.values())
    except ValueError:
        names = list(shapes)
        for k, name in enumerate(names):
            for other in names[:k]:
                try:
                    np.broadcast_shapes(shapes[name], shapes[other])
                except ValueError:
                    what = f"has the shape {shapes[name]}, which does not broadcast with {shapes[other]} of {other}"
                    remedy = "give equal lengths, or 1, along each axis"
                    raise InputError(what, where=(function, name), remedy=remedy) from None
        raise
    if shape and math.prod(shape) > MOST_CONFIGURATIONS:
        raise too_many(math.prod(shape), function)
    return shape
