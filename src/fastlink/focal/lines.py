"""How straight the path of a joint is."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fastlink.planar.designs import broadcast

__all__ = ["StraightLine", "straight_line"]


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


def straight_line(x: Any, y: Any) -> StraightLine:
    """Return the straight line that fits points best: the sum of their squared distances is least.

    Parameters
    ----------
    x, y : array_like
        Points [m] in the last axis, such as T_x and T_y over phi or sigma. NaN is left out.

    Returns
    -------
    StraightLine
        One line for each row of points; NaN without points.

    Notes
    -----
    The greatest distance is ``abs(line.deviation).max(axis=-1)``; `fastlink.planar.straightness` is the half-width of
    the narrowest strip, which is less.

    Examples
    --------
    Chebyshev's linkage with the midpoint T of its coupler, over a whole turn of the crank:

    >>> import numpy as np
    >>> import fastlink as fl
    >>> sigma = np.arange(360) * np.pi / 180.0
    >>> design = {"a": 5.0, "b": 5.0, "c": 2.0, "d": 4.0, "rho": 1.0, "completion": 1}
    >>> path = fl.evaluate("focal", ["T_x", "T_y"], input="sigma", sigma=sigma, **design)
    >>> line = fl.focal.straight_line(path["T_x"], path["T_y"])
    >>> round(float(line.y), 4), round(float(np.abs(line.deviation).max()), 4)
    (4.2537, 0.6453)
    """
    x, y = broadcast("straight_line", x=x, y=y)
    there = np.isfinite(x) & np.isfinite(y)
    count = np.where(there.any(axis=-1), there.sum(axis=-1), np.nan)
    middle_x, middle_y = (np.where(there, values, 0.0).sum(axis=-1) / count for values in (x, y))
    along = np.where(there, x - middle_x[..., None], 0.0)
    across = np.where(there, y - middle_y[..., None], 0.0)
    squares = ((along - across) * (along + across)).sum(axis=-1)
    direction = 0.5 * np.arctan2(2.0 * (along * across).sum(axis=-1), squares) + 0.0 * middle_x
    cosine, sine = np.cos(direction)[..., None], np.sin(direction)[..., None]
    deviation = np.where(there, across * cosine - along * sine, np.nan)
    return StraightLine(middle_x, middle_y, direction, deviation)
