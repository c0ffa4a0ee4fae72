"""Inflections of the coupler curve of a planar 4R: where its curvature changes sign."""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.analysis.designs import BY_NAME, check_samples
from fastlink.analysis.planar.curves import curve_inputs
from fastlink.analysis.planar.path import paths_of
from fastlink.doors import door
from fastlink.engine.evaluate import evaluate

__all__ = ["inflections"]

#: Most steps of the regula falsi, whose order is 1.44: from a step of 2 pi/720 some ten suffice.
STEPS = 40


def _turn(curve: dict[str, Any], theta1: Any) -> Any:
    """Return P' x P'', whose only poles are those of the rates."""
    names = ["curvature", "P_speed"]
    path = evaluate("planar_4r", names, theta1=theta1, omega1=1.0, allow_invalid=True, **curve)
    return path["curvature"] * path["P_speed"] ** 3


def _refined(curve: dict[str, Any], low: Any, high: Any, at_low: Any, at_high: Any) -> Any:
    """Return the zeros between angles of opposite signs by the Illinois algorithm."""
    for _ in range(STEPS):
        middle = high - at_high * ((high - low) / (at_high - at_low))
        at_middle = _turn(curve, middle)
        crossed = np.signbit(at_middle) != np.signbit(at_high)
        # The newest point is `high`; an end that stays twice counts half, so that it moves next time.
        low, at_low = np.where(crossed, high, low), np.where(crossed, at_high, 0.5 * at_low)
        done = np.abs(middle - high) <= 4.0 * np.spacing(middle)
        high, at_high = middle, at_middle
        if np.all(done | (at_middle == 0.0)):
            break
        # Where a zero is met exactly, both ends stay there.
        low = np.where(at_high == 0.0, high, low)
        at_low = np.where(at_high == 0.0, 1.0, at_low)
    return high


@door(hint=BY_NAME)
def inflections(
    design: Any = None, *, branch: Any = 1, samples: int = 720, **inputs: Any
) -> tuple[Any, Any, Any, Any]:
    """Return the points where the curvature of the coupler curve changes sign.

    Parameters
    ----------
    design : mapping, pandas.DataFrame or xarray.Dataset, optional
        Inputs of ``planar_4r`` by name: lengths ``a1`` ... ``a4`` and coupler point ``P_u``, ``P_v`` [m], broadcast.
        Other inputs are not read.
    branch : int or array_like
        Assembly mode, broadcast with the design.
    samples : int
        About how many input angles, closer together near toggles, the sign of the curvature is read at; two changes
        within one step are missed.
    **inputs : float, array_like or xarray.DataArray
        The same by name.

    Returns
    -------
    theta1 : ndarray, shape (..., k)
        The input angles [rad] in [0, 2 pi) by growing theta1, NaN-padded; k is the greatest number of them.
    X, Y : ndarray, shape (..., k)
        The points in the ground frame [m].
    count : ndarray of int, shape (...)
        Their number.

    Notes
    -----
    At a cusp the curvature is infinite and keeps its sign. P lies on the inflection circle of the coupler there.

    Examples
    --------
    >>> import fastlink as fl
    >>> links = dict(a1=0.4, a2=1.2, a3=0.8, a4=1.0)
    >>> theta1, X, Y, count = fl.planar.inflections(links, P_u=0.7, P_v=0.5)
    >>> int(count), fl.planar.inflections(links, P_u=0.0, P_v=0.0)[3].tolist()  # P = A: a circle
    (2, 0)
    """
    arrays = curve_inputs("inflections", design, inputs, branch)
    shape = arrays["a1"].shape
    columns = {name: value.reshape(-1) for name, value in arrays.items()}
    with np.errstate(all="ignore"):
        ends, follows = paths_of(columns).samples(check_samples("inflections", samples))
    turn = _turn({name: value[:, None] for name, value in columns.items()}, ends)
    changes = np.isfinite(turn[:, :-1] * turn[:, 1:]) & (np.signbit(turn[:, :-1]) != np.signbit(turn[:, 1:]))
    changes &= follows
    row, k = np.nonzero(changes)
    curve = {name: value[row] for name, value in columns.items()}
    theta1 = _refined(curve, ends[row, k], ends[row, k + 1], turn[row, k], turn[row, k + 1])
    theta1 = np.mod(theta1, 2.0 * np.pi)
    point = evaluate("planar_4r", ["P_x", "P_y"], theta1=theta1, allow_invalid=True, **curve)
    # NaN: between the two angles the linkage does not assemble.
    assembles = np.isfinite(point["P_x"])
    row = row[assembles]
    count = np.bincount(row, minlength=turn.shape[0])
    rank = np.arange(row.size) - (np.cumsum(count) - count)[row]
    width = int(count.max(initial=0))
    padded = np.full((3, count.size, width), np.nan)
    padded[:, row, rank] = theta1[assembles], point["P_x"][assembles], point["P_y"][assembles]
    order = np.argsort(padded[0], axis=-1)
    angle, X, Y = np.take_along_axis(padded, order[None], axis=-1).reshape(3, *shape, width)
    return angle, X, Y, count.reshape(shape)
