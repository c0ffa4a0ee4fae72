"""Rank the designs of a region of a picture, and choose some of them to be drawn."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fastlink.exploring.values import Values
from fastlink.maps.best import least

__all__ = ["region_of"]

#: Designs of a region that are drawn, and those that are listed as the best; values that are read at once.
MOST_ROWS, MOST_BEST, BLOCK = 1500, 12, 1 << 22

Ranges = dict[str, range]


def region_of(
    values: Values,
    name: str,
    axes: tuple[str, ...],
    at: Mapping[str, int],
    window: Mapping[str, tuple[int, int]],
    *,
    largest: bool,
) -> dict[str, Any]:
    """Return some designs of a region with all variables, and the best of all of them.

    Parameters
    ----------
    values : Values
        The map.
    name : str
        The variable by which they are ranked; it has all axes.
    axes, at, window
        As for `Values.picture`, but of any number of axes.
    largest : bool
        Whether the greatest are the best.
    """
    ranges = {dim: range(window[dim][0], window[dim][1] + 1) for dim in axes}
    some = _some(ranges)
    grid = np.meshgrid(*some.values(), indexing="ij")
    found = {
        one: _along(values, one, at, some).ravel().tolist()
        for one in values.names
        if {str(dim) for dim in values.maps[one].dims} <= {*at, *axes}
    }
    numbers = _best(values, name, at, ranges, -1.0 if largest else 1.0)
    places = [
        {**at, **{dim: ranges[dim][int(k)] for dim, k in zip(axes, one, strict=True)}} for one in numbers
    ]
    return {
        "count": math.prod(map(len, ranges.values())),
        "values": {key: [v if math.isfinite(v) else None for v in one] for key, one in found.items()},
        "axes": {dim: along.ravel().tolist() for dim, along in zip(axes, grid, strict=True)},
        "best": [{"at": place, "row": values.row(place)} for place in places],
    }


def _some(ranges: Ranges) -> Ranges:
    """Return ranges with steps that leave about so many designs as are drawn; the shortest keep most."""
    found, left = dict(ranges), MOST_ROWS
    for number, dim in enumerate(sorted(ranges, key=lambda one: len(ranges[one]))):
        most = math.floor(left ** (1.0 / (len(ranges) - number)) + 1e-9)
        found[dim] = ranges[dim][:: -(-len(ranges[dim]) // most)]
        left //= len(found[dim])
    return found


def _best(
    values: Values, name: str, at: Mapping[str, int], ranges: Ranges, sign: float
) -> Iterator[tuple[Any, ...]]:
    """Yield the numbers along each axis of the designs of least value times sign; of equal ones the first."""
    shape = tuple(map(len, ranges.values()))
    first = next(dim for dim in map(str, values.maps[name].dims) if dim in ranges)
    whole, axis = ranges[first], list(ranges).index(first)
    step = max(1, BLOCK // max(1, math.prod(shape) // len(whole)))
    ranked, chosen = np.empty(0), np.empty(0, dtype=np.int64)
    for start in range(0, len(whole), step):
        part = {**ranges, first: whole[start : start + step]}
        flat = sign * _along(values, name, at, part).ravel().astype(float)
        bound = ranked.max() if len(ranked) == MOST_BEST else np.inf
        finite = np.flatnonzero((flat <= bound) & np.isfinite(flat))
        numbers = list(np.unravel_index(finite, tuple(map(len, part.values()))))
        numbers[axis] = numbers[axis] + start
        ranked = np.concatenate([ranked, flat[finite]])
        chosen = np.concatenate([chosen, np.ravel_multi_index(tuple(numbers), shape)])
        order = np.argsort(chosen)
        kept = order[least(ranked[order], MOST_BEST)]
        ranked, chosen = ranked[kept], chosen[kept]
    return iter([np.unravel_index(one, shape) for one in chosen[np.lexsort((chosen, ranked))]])


def _along(values: Values, name: str, at: Mapping[str, int], ranges: Ranges) -> NDArray[Any]:
    """Return the values of a variable over ranges of places, in their order."""
    dims = [str(dim) for dim in values.maps[name].dims]
    slices = {dim: slice(one.start, one.stop, one.step) for dim, one in ranges.items()}
    found = values.part(name, {dim: slices.get(dim, at.get(dim, 0)) for dim in dims})
    own = [dim for dim in dims if dim in ranges]
    found = found.transpose([own.index(dim) for dim in ranges if dim in own])
    whole = found[tuple(slice(None) if dim in own else None for dim in ranges)]
    return np.broadcast_to(whole, tuple(map(len, ranges.values())))
