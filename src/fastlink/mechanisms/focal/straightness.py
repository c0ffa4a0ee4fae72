"""How straight the path of T is: the line of least squares through all its positions, and what stands off it."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fastlink.mechanisms.focal.declare import focal
from fastlink.mechanisms.focal.drives import by_crank
from fastlink.mechanisms.focal.points import POSITION


class StraightLine(NamedTuple):
    """A line through given points, and how far they stand off it.

    Attributes
    ----------
    x, y : ndarray
        A point of the line: the centre of the points [m].
    direction : ndarray
        Its direction, in (-pi/2, pi/2] [rad].
    deviation : ndarray
        Distance of each point to the left of it [m]; NaN where the point is.
    """

    x: Any
    y: Any
    direction: Any
    deviation: Any


def fitted_line(x: Any, y: Any) -> StraightLine:
    """Return the line of the least sum of squared distances for each row of points; NaN is left out."""
    there = np.isfinite(x) & np.isfinite(y)
    count = np.where(there.any(axis=-1), there.sum(axis=-1), np.nan)
    middle_x, middle_y = (np.where(there, values, 0.0).sum(axis=-1) / count for values in (x, y))
    along = np.where(there, x - middle_x[..., None], 0.0)
    across = np.where(there, y - middle_y[..., None], 0.0)
    # over a power of two, so that no square leaves the range of doubles
    power = np.frexp(np.maximum(abs(along), abs(across)).max(axis=-1))[1]
    along, across = (np.ldexp(values, -power[..., None]) for values in (along, across))
    squares = ((along - across) * (along + across)).sum(axis=-1)
    direction = 0.5 * np.arctan2(2.0 * (along * across).sum(axis=-1), squares) + 0.0 * middle_x
    cosine, sine = np.cos(direction)[..., None], np.sin(direction)[..., None]
    deviation = np.where(there, np.ldexp(across * cosine - along * sine, power[..., None]), np.nan)
    return StraightLine(middle_x, middle_y, direction, deviation)


def T_deviation(T_x: Any, T_y: Any) -> Any:
    """Distance of T to the left of the straight line that fits all its positions best."""
    return fitted_line(T_x, T_y).deviation


for _drive in (focal, by_crank):
    _drive.over_positions(units="m", symbol="delta_T", source=POSITION)(T_deviation)
