"""How straight the path of a joint is."""

from __future__ import annotations

from typing import Any

from fastlink.analysis.planar.designs import broadcast
from fastlink.mechanisms.focal.straightness import StraightLine, fitted_line

__all__ = ["StraightLine", "straight_line"]


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
    A sweep gives the distances as the quantity ``T_deviation``. The greatest one is
    ``abs(line.deviation).max(axis=-1)``; `fastlink.planar.straightness` is the half-width of the narrowest strip, which
    is less.

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
    return fitted_line(*broadcast("straight_line", x=x, y=y))
