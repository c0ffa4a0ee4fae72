"""Reductions of a whole cycle at once, not of one input position after the other; lanes are designs."""

from __future__ import annotations

from typing import Any

from fastlink.numerics.compiler import lanes, outlined
from fastlink.numerics.elementary import TWO_PI

__all__ = ["fluctuation_lanes"]

MEAN, TOTAL, LOW, HIGH = range(4)


@outlined
def fluctuation_lanes(curve: Any, result: Any, count: int, width: int, sums: Any) -> None:
    """Store the greatest minus the least value of the integral of a curve less its mean.

    The integral from sample to sample is that of the cubic through four samples (an error of the fourth order in the
    step); between samples, it is greatest or least where the straight line through two of them passes the mean (third
    order). A lane with a NaN gives NaN.

    Parameters
    ----------
    curve : array (positions, lanes)
        Samples at equal steps of one turn.
    result : array (lanes,)
        Written.
    count, width : int
        Numbers of positions and of lanes.
    sums : array (4, lanes)
        Scratch.
    """
    for i in lanes(width):
        sums[MEAN, i] = 0.0
        sums[TOTAL, i] = 0.0
        sums[LOW, i] = 0.0
        sums[HIGH, i] = 0.0
    for j in range(count):
        for i in lanes(width):
            sums[MEAN, i] += curve[j, i] / count
    for j in range(count):
        before = j - 1 if j > 0 else count - 1
        after = j + 1 if j + 1 < count else j + 1 - count
        # With one position or two the samples repeat.
        later = after + 1 if after + 1 < count else after + 1 - count
        for i in lanes(width):
            excess, following = curve[j, i] - sums[MEAN, i], curve[after, i] - sums[MEAN, i]
            passes = excess * following < 0.0
            turn = sums[TOTAL, i] + (0.5 * (excess * excess) / (excess - following) if passes else 0.0)
            sums[LOW, i] = turn if turn < sums[LOW, i] else sums[LOW, i]
            sums[HIGH, i] = turn if turn > sums[HIGH, i] else sums[HIGH, i]
            near, far = curve[j, i] + curve[after, i], curve[before, i] + curve[later, i]
            sums[TOTAL, i] += (13.0 * near - far) / 24.0 - sums[MEAN, i]
    for i in lanes(width):
        # Zero times the mean is the NaN of a curve that has one.
        result[i] = (sums[HIGH, i] - sums[LOW, i]) * (TWO_PI / count) + 0.0 * sums[MEAN, i]
