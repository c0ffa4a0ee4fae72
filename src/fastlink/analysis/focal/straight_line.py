"""Fit a straight line to the path of a joint, and measure the deviation."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fastlink.analysis.designs import broadcast_points
from fastlink.doors import door
from fastlink.errors import InputError
from fastlink.io.reader import as_dataset

__all__ = ["StraightLine", "T_deviation", "straight_line"]


class StraightLine(NamedTuple):
    """A line through given points, and their distances from it.

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


def _fitted_line(x: Any, y: Any) -> StraightLine:
    """Return the line of least squares for each row of points; NaN is skipped."""
    finite = np.isfinite(x) & np.isfinite(y)
    count = np.where(finite.any(axis=-1), finite.sum(axis=-1), np.nan)
    # over a power of two, so that no sum and no difference leaves the range of doubles
    x, y = (np.where(finite, values, 0.0) for values in (x, y))
    scale = np.frexp(np.maximum(abs(x), abs(y)).max(axis=-1, initial=0.0))[1]
    x, y = (np.ldexp(values, -scale[..., None]) for values in (x, y))
    middle_x, middle_y = (values.sum(axis=-1) / count for values in (x, y))
    along = np.where(finite, x - middle_x[..., None], 0.0)
    across = np.where(finite, y - middle_y[..., None], 0.0)
    # and so that no square does
    power = np.frexp(np.maximum(abs(along), abs(across)).max(axis=-1, initial=0.0))[1]
    along, across = (np.ldexp(values, -power[..., None]) for values in (along, across))
    squares = ((along - across) * (along + across)).sum(axis=-1)
    direction = 0.5 * np.arctan2(2.0 * (along * across).sum(axis=-1), squares) + 0.0 * middle_x
    cosine, sine = np.cos(direction)[..., None], np.sin(direction)[..., None]
    with np.errstate(over="ignore"):  # points beyond 1e308 may be farther off than a double says
        deviation = np.ldexp(across * cosine - along * sine, (power + scale)[..., None])
    middle_x, middle_y = (np.ldexp(values, scale) for values in (middle_x, middle_y))
    return StraightLine(middle_x, middle_y, direction, np.where(finite, deviation, np.nan))


@door
def straight_line(x: Any, y: Any) -> StraightLine:
    """Return the straight line whose sum of squared distances from points is least.

    Parameters
    ----------
    x, y : array_like
        Points [m] in the last axis, such as T_x and T_y over phi or sigma. NaN is skipped.

    Returns
    -------
    StraightLine
        One line for each row of points; NaN without points.

    Notes
    -----
    `T_deviation` computes the distances for a map. The greatest distance is
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
    return _fitted_line(*broadcast_points("straight_line", x, y))


@door
def T_deviation(maps: Any) -> Any:
    """Return the distance of T from the straight line that fits its path best.

    Parameters
    ----------
    maps : xarray.Dataset or path
        A sweep of ``"focal"`` with ``T_x`` and ``T_y``, by either input, or its file.

    Returns
    -------
    xarray.DataArray
        In the units of ``T_x``; positive to the left of the line, whose direction is in (-pi/2, pi/2]. NaN where the
        mechanism does not assemble. Each design and assembly mode has a line of its own, through all its positions.

    Raises
    ------
    InputError
        Not a map or a path; a name is missing, or the positions of T are not a curve.

    Examples
    --------
    >>> import numpy as np
    >>> import fastlink as fl
    >>> part = fl.sweep(
    ...     "focal",
    ...     fl.grid(a=5.0, b=5.0, c=2.0, d=4.0, rho=1.0, completion=1),
    ...     ["T_x", "T_y"],
    ...     input="sigma",
    ...     sigma=np.linspace(3.23, 6.19, 200),
    ...     branch=1,
    ... )
    >>> print(f"within {float(abs(fl.focal.T_deviation(part)).max()):.4f} m of a straight line")
    within 0.0140 m of a straight line
    """
    with as_dataset(maps) as dataset:
        for name in ("T_x", "T_y"):
            if name not in dataset.data_vars:
                remedy = "sweep 'T_x' and 'T_y', and give the whole result"
                raise InputError(f"{name!r} is missing", where=("T_deviation", "maps"), remedy=remedy)
        path, height = dataset["T_x"], dataset["T_y"]
        along = [str(dim) for dim in path.dims if dim in ("phi", "sigma")]
        if len(along) != 1 or set(path.dims) != set(height.dims):
            remedy = "sweep it over phi or sigma, and give the whole result"
            raise InputError("'T_x' has no positions", where=("T_deviation", "maps"), remedy=remedy)
        units = path.attrs.get("units", "m")
        if height.attrs.get("units", "m") != units:
            what = f"'T_x' is in {units}, 'T_y' in {height.attrs['units']}"
            raise InputError(what, where=("T_deviation", "maps"), remedy="give both in the same units")
        path = path.transpose(..., *along)
        values = _fitted_line(path.values, height.transpose(*path.dims).values).deviation
    deviation = path.copy(data=values).rename("T_deviation")
    deviation.attrs = {
        "units": units,
        "long_name": "Distance of T from its straight line",
        "symbol": "delta_T",
    }
    return deviation
