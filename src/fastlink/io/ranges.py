"""Ranges of numbers, such as those of designs that are written: each from its start to before its stop."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

__all__ = ["Range", "Ranges", "joined", "missing", "pieces"]

Range = tuple[int, int]
#: Ranges that are kept apart until they are joined.
FEW = 64


def joined(ranges: list[Range]) -> list[Range]:
    """Return ranges in order, and join those that touch.

    Examples
    --------
    >>> joined([(4, 6), (0, 2), (2, 4), (8, 9)])
    [(0, 6), (8, 9)]
    """
    result: list[Range] = []
    for start, stop in sorted(ranges):
        if result and start <= result[-1][1]:
            result[-1] = result[-1][0], max(stop, result[-1][1])
        else:
            result.append((start, stop))
    return result


def missing(written: list[Range], size: int) -> list[Range]:
    """Return the parts of 0 to `size` that ordered ranges leave out.

    Examples
    --------
    >>> missing([(0, 6), (8, 9)], 12)
    [(6, 8), (9, 12)]
    """
    ends = [0, *(stop for _, stop in written)]
    starts = [*(start for start, _ in written), size]
    return [(a, b) for a, b in zip(ends, starts, strict=True) if a < b]


class Ranges:
    """Ranges that are added one by one; joined from time to time, not each time, which would take ever longer.

    Examples
    --------
    >>> ranges = Ranges([(0, 2)])
    >>> ranges.add(4, 6)
    >>> ranges.add(2, 4)
    >>> ranges.joined()
    [(0, 6)]
    """

    def __init__(self, ranges: Iterable[Range] = ()) -> None:
        self._ranges, self._most = list(ranges), FEW

    def add(self, start: int, stop: int) -> None:
        """Add a range."""
        self._ranges.append((start, stop))
        if len(self._ranges) > self._most:
            self._ranges = joined(self._ranges)
            self._most = 2 * len(self._ranges) + FEW

    def joined(self) -> list[Range]:
        """Return all ranges in order, those that touch joined."""
        return joined(self._ranges)


def pieces(
    shape: tuple[int, ...], most: int, steps: tuple[int, ...] = ()
) -> Iterator[tuple[tuple[int | slice, ...], int]]:
    """Yield index and first flat number of consecutive pieces of an array, in C order.

    Parameters
    ----------
    shape : tuple of int
        Of the array.
    most : int
        Values of a piece; a piece has one row at least.
    steps : tuple of int, optional
        By dimension: a piece has a multiple of so many rows, where they fit.

    Examples
    --------
    >>> list(pieces((2, 3), 2))[:2]
    [((0, slice(0, 2, None)), 0), ((0, slice(2, 3, None)), 2)]
    """
    if not math.prod(shape):
        return
    if not shape:
        yield (), 0
        return
    lead = next(k for k in range(len(shape)) if math.prod(shape[k + 1 :]) <= most or k == len(shape) - 1)
    below = math.prod(shape[lead + 1 :])
    rows = max(1, most // below)
    if steps:
        rows = rows // steps[lead] * steps[lead] or rows
    for number, outer in enumerate(np.ndindex(shape[:lead])):
        for start in range(0, shape[lead], rows):
            stop = min(start + rows, shape[lead])
            yield (*outer, slice(start, stop)), (number * shape[lead] + start) * below
