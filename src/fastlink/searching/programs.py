"""Linear programs over the pieces of extremes about a design."""

from __future__ import annotations

from functools import cache
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = ["Program", "Surroundings"]

Floats = NDArray[np.float64]

#: A multiplier above which a limit holds the design back; it is a share of all, which add to 1.
HOLDS = 1e-6
#: How near to its end an input is at it.
AT_END = 1e-6


class Surroundings(Protocol):
    """A point of a walk, with the measures of its results.

    Attributes
    ----------
    best : array
        The point about which it is.
    aims : array
        The numbers of the objectives.
    signs, low, high, first, size, margin : array
        Of each result: its aim, its limits, its value at the start, its size, and how far within limits it is kept.
    """

    best: Floats
    aims: NDArray[Any]
    signs: Floats
    low: Floats
    high: Floats
    first: Floats
    size: Floats
    margin: Floats

    def measured(self, points: Floats) -> tuple[Floats, Floats]:
        """Return values, NaN where a design does not count, and slopes."""


@cache
def _pattern(count: int) -> Floats:
    """Return the points about a design at which it is looked at: along each input, and all about."""
    from scipy.stats import qmc

    about: Any = qmc.Sobol(count, scramble=False).random_base2(max(3, (count - 1).bit_length() + 2))
    return np.concatenate((np.zeros((1, count)), np.eye(count), -np.eye(count), 2.0 * about - 1.0))


class Program:
    """A linear program over the pieces about a point.

    Attributes
    ----------
    step : array
        Where it leads.
    height : float
        The height that it promises there.
    left_out : bool
        Whether a point about it does not count, or has no number or slope.
    """

    def __init__(
        self, walk: Surroundings, reach: float, points: Floats, values: Floats, slopes: Floats
    ) -> None:
        self.walk = walk
        count, offsets = points.shape[1], points - walk.best
        # of each result at each point: its value by that piece at the best point, so that steps start there
        here = values - np.einsum("pri,pi->pr", slopes, offsets)
        rows, ends, of = [], [], []
        for k in walk.aims:
            scale = walk.signs[k] / walk.size[k]
            rows.append(np.column_stack((scale * slopes[:, k], np.full(len(points), -1.0))))
            ends.append(-scale * (here[:, k] - walk.first[k]))
            of += [(int(k), 0)] * len(points)
        for sign, limits in ((-1, walk.low), (1, walk.high)):
            for k in np.flatnonzero(np.isfinite(limits)):
                rows.append(np.column_stack((sign * slopes[:, k], np.zeros(len(points)))) / walk.size[k])
                ends.append((sign * (limits[k] - here[:, k]) - walk.margin[k]) / walk.size[k])
                of += [(int(k), sign)] * len(points)
        self.rows, self.ends, self.of = np.concatenate(rows), np.concatenate(ends), of
        self.bounds = [*zip(np.maximum(-reach, -walk.best), np.minimum(reach, 1.0 - walk.best), strict=True)]
        self.count, self.reach, self.left_out = count, reach, False

    @classmethod
    def about(cls, walk: Surroundings, reach: float) -> Program | None:
        """Return that of a reach, None where too few points have numbers."""
        points = np.clip(walk.best + reach * _pattern(len(walk.best)), 0.0, 1.0)
        values, slopes = walk.measured(points)
        good: Any = np.isfinite(values).all(axis=1) & np.isfinite(slopes).all(axis=(1, 2))
        if not good[0]:
            return None
        program = cls(walk, reach, points[good], values[good], slopes[good])
        program.left_out = not good.all()
        return program

    def solve(self, missed: Floats) -> bool:
        """Solve it with limits that are closer by what a step has missed, and tell whether there is a solution."""
        from scipy.optimize import linprog

        closer = np.array([missed[k] / self.walk.size[k] if sign else 0.0 for k, sign in self.of])
        cost = np.append(np.zeros(self.count), 1.0)
        found = linprog(
            cost, A_ub=self.rows, b_ub=self.ends - closer, bounds=[*self.bounds, (None, None)], method="highs"
        )
        if found.status != 0:
            return False
        self.step, self.height, self.found = found.x[:-1], float(found.x[-1]), found
        return True

    def limits(self) -> tuple[set[tuple[int, int]], set[tuple[int, int]]]:
        """Return what holds the point back: limits of results that have a multiplier, and ends at which inputs are.

        Returns
        -------
        results, inputs : set of (int, int)
            The number of each, with -1 for a lower limit and 1 for an upper one.
        """
        weights: dict[tuple[int, int], float] = {}
        for key, weight in zip(self.of, -self.found.ineqlin.marginals, strict=True):
            weights[key] = weights.get(key, 0.0) + float(weight)
        results = {key for key, weight in weights.items() if key[1] and weight > HOLDS}
        lower, upper, best = self.found.lower.marginals, self.found.upper.marginals, self.walk.best
        ends = {(j, -1) for j in range(self.count) if best[j] <= AT_END and lower[j] > HOLDS}
        ends |= {(j, 1) for j in range(self.count) if best[j] >= 1.0 - AT_END and upper[j] < -HOLDS}
        return results, ends
