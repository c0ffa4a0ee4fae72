"""From which of the best rows a refinement starts, and which of its ends are one design."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.searching.descent import FIRST_REACH, MARGIN, Descent, Outcome

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.searching.points import Points

__all__ = ["Starts", "candidates", "is_one_design"]

#: Rows among which the starts of one result are, and the least number of them.
FOR_EACH, LEAST = 64, 512
#: Starts for each different design that is wanted, at most, and further ones.
MOST_STARTS, FURTHER = 2, 4
#: The farthest of two rows of which one start is enough, of the ranges.
FARTHEST = 0.2
#: The sigma of Rinnooy Kan and Timmer: above it the number of starts stays finite however many rows there are.
WIDENED = 4.0
#: By how much of their size results may rise, or limits be missed, on the way from one end to another that is the
#: same. Ends are within the margin of their limits, and each moves the others by some times as much.
RISE = 10.0 * MARGIN
#: Points of that way.
ON_THE_WAY = np.arange(1, 9)[:, None] / 8.0


def candidates(top: int) -> int:
    """Return the number of rows among which the starts for some different designs are."""
    return max(FOR_EACH * top, LEAST) if top > 1 else 1


class Starts:
    """The order in which rows are starts: by their values, but from one neighbourhood only the best one.

    A row near which is a better one most likely leads to where that one leads (Rinnooy Kan and Timmer, Stochastic
    global optimization methods part II: multi level methods, Mathematical Programming 39, 1987): such rows come last.
    What is near any earlier start or end is left out.

    Parameters
    ----------
    rows : array (rows, inputs)
        The inputs that may change, of their ranges, the best row first.
    groups : sequence
        What else must be equal of rows that are neighbours.
    searched : int
        How many rows the sample or map has.
    top : int
        How many different designs are wanted.
    """

    def __init__(self, rows: NDArray[np.float64], groups: Sequence[Any], searched: int, top: int) -> None:
        keys = {key: k for k, key in enumerate(dict.fromkeys(groups))}
        self.rows, self.groups = rows, np.array([keys[key] for key in groups])
        self.reach, self.top = _reach(rows.shape[1], max(searched, len(rows), 2)), top
        self.near = np.zeros(len(rows), dtype=bool)

    def __iter__(self) -> Iterator[int]:
        """Yield the numbers of rows; between them tell of each end by `ended`."""
        linked = np.zeros(len(self.rows), dtype=bool)
        for row in range(len(self.rows)):
            linked[row] = bool(self._about(self.rows[row], self.groups[row])[:row].any())
        count = 0
        for row in np.argsort(linked, kind="stable").tolist():
            if self.near[row]:
                continue
            if count == MOST_STARTS * self.top + FURTHER:
                return
            count += 1
            self.near |= self._about(self.rows[row], self.groups[row])
            yield row

    def ended(self, row: int, end: NDArray[np.float64]) -> None:
        """Leave out what is near the end of a start."""
        self.near |= self._about(end, self.groups[row])

    def _about(self, point: NDArray[np.float64], group: int) -> NDArray[np.bool_]:
        apart = np.linalg.norm(self.rows - point, axis=1)
        near: NDArray[np.bool_] = (apart <= self.reach) & (self.groups == group)
        return near


def _reach(inputs: int, searched: int) -> float:
    """Return the radius within which one row of an even sample is near another one for sure, as it grows."""
    if not inputs:
        return FARTHEST
    ball = math.gamma(1.0 + inputs / 2.0) * WIDENED * math.log(searched) / searched
    return min(FARTHEST, float(ball ** (1.0 / inputs)) / math.sqrt(math.pi))


def is_one_design(points: Points, end: Descent, other: NDArray[np.float64]) -> bool:
    """Tell whether from an end another design is reached without a rise: then the two are one, the other as good.

    They are closer than a refinement looks about, and what rises between them, or is missed of limits, is within what a
    refinement leaves undone: the margin of limits, and to second order of their distance what a bent way adds.

    Parameters
    ----------
    points : Points
        The designs that can be reached from the start of the first end.
    end : Descent
        The first end.
    other : array
        All inputs of the other design.
    """
    if end.outcome is Outcome.NOT_REPRODUCED:
        return False
    place = points.place_of(other)
    if place is None:
        return False
    step = place - end.point
    distance = float(np.abs(step).max(initial=0.0))
    if not distance <= FIRST_REACH:
        return False
    values, counts = points.values(end.point + ON_THE_WAY * step)
    low, high, signs = points.limits
    room = (RISE + distance**2) * end.size
    kept = (values >= low - room) & (values <= high + room)
    flat = signs * (values - end.values) <= np.where(signs == 0.0, np.inf, room)
    return bool(counts.all() and np.isfinite(values).all() and kept.all() and flat.all())
