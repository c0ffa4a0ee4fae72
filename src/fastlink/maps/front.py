"""The Pareto front: rows that no other row beats in every objective."""

from __future__ import annotations

import math
from bisect import bisect_right

import numpy as np
from numpy.typing import NDArray

__all__ = ["nondominated", "strongest", "unbeaten", "undominated"]

#: Rows that are compared with each other at once.
CHUNK = 512
MOST_AT_ONCE = 1 << 14
#: A block is thinned by the rows of the front that beat most: in steps, as the first ones leave little.
STEPS = (4, 16, 64)
#: Rows of a block of which the first front is made.
SAMPLED = 4096


def nondominated(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the rows that no other row beats, by growing values; of equal ones the first.

    A row beats another one if it is nowhere greater, and less somewhere.

    Parameters
    ----------
    points : array (rows, objectives)
        Numbers, to be as small as possible.

    Examples
    --------
    >>> import numpy as np
    >>> nondominated(np.array([[1.0, 3.0], [2.0, 2.0], [2.0, 3.0], [1.0, 3.0]]))
    array([0, 1])
    """
    order = np.lexsort(points.T[::-1])  # stable: equal rows by their places
    # no later row beats an earlier one, and what is before has the first objective no greater
    rest = points[order, 1:]
    if rest.shape[1] == 1:
        least = np.minimum.accumulate(rest[:, 0])
        return (
            order[np.flatnonzero(np.concatenate(([True], rest[1:, 0] < least[:-1])))] if len(order) else order
        )
    if rest.shape[1] == 2:
        return order[_above_stairs(rest)]
    kept = np.empty(0, dtype=np.int64)
    for start in range(0, len(rest), CHUNK):
        chunk = np.arange(start, min(start + CHUNK, len(rest)))
        for other in (*np.split(kept, range(MOST_AT_ONCE, len(kept), MOST_AT_ONCE)), chunk):
            before = (rest[other][:, None] <= rest[chunk][None]).all(axis=2)
            chunk = chunk[~(before & (other[:, None] < chunk[None])).any(axis=0)]
        kept = np.concatenate((kept, chunk))
    return order[kept]


def _above_stairs(rest: NDArray[np.float64]) -> list[int]:
    """Return the rows that none before them equals or betters in both columns.

    Those that none before beats are stairs, which fall in the second column where they grow in the first: one search
    among these tells of each row (Kung, Luccio and Preparata, On finding the maxima of a set of vectors, 1975).
    """
    kept, first, second = list[int](), [-math.inf], [math.inf]
    for row, (y, z) in enumerate(zip(*rest.T.tolist(), strict=True)):
        place = bisect_right(first, y)
        if second[place - 1] <= z and kept and place > 1:
            continue
        kept.append(row)
        last = place
        while last < len(second) and second[last] >= z:
            last += 1
        start = place - 1 if place > 1 and first[place - 1] == y else place
        first[start:last], second[start:last] = [y], [z]
    return kept


def undominated(points: NDArray[np.float64], front: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return rows among which are all that neither the others nor a front beat, in their order.

    Rows are compared with the few that beat most of them.
    """
    places = np.arange(len(points))
    if not len(points):
        return places
    some = points[:: -(-len(points) // SAMPLED)]
    known = np.concatenate((front, some))
    known = known[nondominated(known)]
    for count in STEPS:
        if not len(places):
            break
        places = places[unbeaten(points[places], strongest(known, points[places], count))]
    return places


def unbeaten(points: NDArray[np.float64], few: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the rows that none of a few beats, which are taken one by one."""
    places = np.arange(len(points))
    for best in few:
        beaten = (points[places] >= best).all(axis=1) & (points[places] > best).any(axis=1)
        places = places[~beaten]
    return places


def strongest(front: NDArray[np.float64], points: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Return the rows of a front that beat most, if points fill the box about them evenly."""
    with np.errstate(all="ignore"):
        high, low = points.max(axis=0), front.min(axis=0)
        shares = (high - front) / np.where(high > low, high - low, 1.0)
    beaten = np.prod(np.clip(np.nan_to_num(shares, nan=0.0), 0.0, 1.0), axis=1)
    best: NDArray[np.float64] = front[np.argsort(-beaten, kind="stable")[:count]]
    return best
