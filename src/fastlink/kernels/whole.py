"""What needs a whole cycle at once, not one input position after the other; lanes are designs."""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.jit import TWO_PI, called

__all__ = ["fluctuation_lanes"]


@called
def fluctuation_lanes(curve: Any, result: Any) -> None:
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
    """
    count, lanes = curve.shape
    mean, total, low, high = np.zeros(lanes), np.zeros(lanes), np.zeros(lanes), np.zeros(lanes)
    for j in range(count):
        for i in range(lanes):
            mean[i] += curve[j, i] / count
    for j in range(count):
        before, here = curve[j - 1], curve[j]
        after, later = curve[(j + 1) % count], curve[(j + 2) % count]
        for i in range(lanes):
            excess, following = here[i] - mean[i], after[i] - mean[i]
            passes = excess * following < 0.0
            turn = total[i] + (0.5 * (excess * excess) / (excess - following) if passes else 0.0)
            low[i] = turn if turn < low[i] else low[i]
            high[i] = turn if turn > high[i] else high[i]
            total[i] += (13.0 * (here[i] + after[i]) - (before[i] + later[i])) / 24.0 - mean[i]
    for i in range(lanes):
        # Zero times the mean is the NaN of a curve that has one.
        result[i] = (high[i] - low[i]) * (TWO_PI / count) + 0.0 * mean[i]
