"""Coupler curves of the planar 4R: equation and straightness.

The coupler point and its derivatives are facts of the mechanism, and so is the bounding box of the curve: ``P_x_min``,
``P_x_max``, ``P_y_min`` and ``P_y_max`` of a sweep.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from fastlink.analysis.designs import BY_NAME, CURVE, broadcast_points, check_samples, read_design
from fastlink.analysis.sextics import coupler_sextic
from fastlink.doors import door
from fastlink.engine.broadcast import broadcast_inputs
from fastlink.engine.evaluate import evaluate
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.numerics.vectors import cross
from fastlink.plan.validate import branch_codes
from fastlink.space.degrees import RADIANS, ends_of

__all__ = ["curve_inputs", "curve_straightness", "one_turn", "sextic", "straightness"]


@door(hint=BY_NAME)
def sextic(design: Any = None, **inputs: Any) -> Any:
    r"""Return the tricircular sextic that every coupler point of a linkage satisfies.

    Parameters
    ----------
    design : mapping, pandas.DataFrame or xarray.Dataset, optional
        Inputs of ``planar_4r`` by name: lengths ``a1`` ... ``a4`` and coupler point ``P_u``, ``P_v`` [m], broadcast.
        Other inputs are not read.
    **inputs : float, array_like or xarray.DataArray
        The same by name.

    Returns
    -------
    ndarray, shape (..., 7, 7)
        c with ``sum(c[..., i, j] X**i Y**j) = 0`` for the points (X, Y) [m] of the curve in the ground frame
        (origin O, X along OD), of both branches. c[i, j] has the unit m^(6 - i - j); the terms of degree six
        are (X^2 + Y^2)^3, so nothing is left to normalise.

    Notes
    -----
    In complex numbers let z = X + iY, p = P_u + i P_v and q = p - a2 be the coupler point seen from A and
    from B, and e = exp(i theta2). Then A = z - p e and B = z - q e, and the circles abs(A) = a1 and
    abs(B - a4) = a3 become two linear equations for cos theta2 and sin theta2,

    .. math::
        A_k \cos\theta_2 + B_k \sin\theta_2 = C_k, \quad
        (A_1 + iB_1)/2 = z \bar p, \quad C_1 = z \bar z + |p|^2 - a_1^2, \quad
        (A_2 + iB_2)/2 = (z - a_4) \bar q, \quad C_2 = |z - a_4|^2 + |q|^2 - a_3^2.

    Cramer's rule and cos^2 + sin^2 = 1 give

    .. math::
        (C_1 B_2 - C_2 B_1)^2 + (A_1 C_2 - A_2 C_1)^2 = (A_1 B_2 - A_2 B_1)^2,

    S. Roberts' sextic (Proc. London Math. Soc. 7, 1875, 14-23). Here it is divided by 4 a2^2, with what cancels
    in it cancelled by hand: abs(W)^2 - 4 V^2 = 0 with

    .. math::
        W &= (z \bar z + k)(z - a_4) - (\bar p/a_2)(a_4 z^2 + (2 a_2 P_u - a_1^2 - a_2^2 + a_3^2 - a_4^2) z
             - k a_4), \quad k = |p|^2 - a_1^2, \\
        V &= a_4 Y (|p|^2/a_2 - P_u) - P_v (z \bar z - a_4 X).

    Examples
    --------
    >>> import numpy as np
    >>> import fastlink as fl
    >>> c = fl.planar.sextic(a1=3.0, a2=4.0, a3=5.0, a4=6.0, P_u=0.0, P_v=0.0)  # P = A, on the circle of radius 3
    >>> float(np.polynomial.polynomial.polyval2d(0.0, 3.0, c))
    0.0
    """
    numbers = [*read_design("sextic", planar_4r, design, inputs, CURVE).values()]
    return coupler_sextic(-1, numbers[:4], numbers[4:])


def curve_inputs(function: str, design: Any, inputs: Mapping[str, Any], branch: Any) -> dict[str, Any]:
    """Return what determines a coupler curve, with its assembly mode, as arrays of one shape."""
    read = read_design(function, planar_4r, design, inputs, CURVE)
    _, arrays, shape = broadcast_inputs(function, read | {"branch": branch_codes(planar_4r, branch)})
    return {name: np.broadcast_to(values, shape) for name, values in arrays.items()}


def along_curve(names: list[str], curve: Mapping[str, Any], theta1: Any) -> dict[str, Any]:
    """Return quantities of each curve at unit speed, with angles in the last axis."""
    columns = {name: values[..., None] for name, values in curve.items()}
    return evaluate("planar_4r", names, theta1=theta1, omega1=1.0, allow_invalid=True, **columns)


def one_turn(function: str, samples: Any) -> Any:
    """Return input angles half a step off theta1 = 0, where rates may not exist."""
    count = check_samples(function, samples)
    return (np.arange(count) + 0.5) * (2.0 * np.pi / count)


def _half_width(points: Any) -> float:
    """Return half the width of the narrowest strip that holds all points (n, 2)."""
    if points.size == 0:
        return float("nan")
    power = np.frexp(np.abs(points).max())[1] + 1  # so that no difference leaves the range of doubles
    return float(np.ldexp(_half_width_of_small(np.ldexp(points, -power)), power))


def _half_width_of_small(points: Any) -> float:
    """Return half the width of the narrowest strip that holds all points (n, 2), which are less than 1."""
    points = points - points[0]
    distance = np.hypot(*points.T)
    size = distance.max()
    if size == 0.0:
        return 0.0
    points = points / size
    try:
        corners = points[ConvexHull(points).vertices]
    except QhullError:  # all in one line, up to roundings
        return float(0.5 * size * np.ptp(cross(*points[np.argmax(distance)], *points.T)))
    # The nearest lines run along an edge of the convex hull and through the corner where its edges turn back.
    edges = np.roll(corners, -1, axis=0) - corners
    angle = np.unwrap(np.arctan2(edges[:, 1], edges[:, 0]))
    opposite = np.searchsorted(np.concatenate([angle, angle + 2.0 * np.pi]), angle + np.pi) % len(angle)
    widths = np.abs(cross(*edges.T, *(corners[opposite] - corners).T)) / np.hypot(*edges.T)
    return float(0.5 * size * widths.min())


@door
def straightness(x: Any, y: Any) -> Any:
    """Return the greatest distance of points from the line that makes it least [m].

    Parameters
    ----------
    x, y : array_like
        Points [m] of a curve or a part of it in the last axis, such as P_x and P_y over theta1. NaN is
        skipped.

    Returns
    -------
    ndarray
        Half the width of the narrowest strip that holds the points (the minimum zone of ISO 1101 is the whole width).
        NaN without points.

    Examples
    --------
    >>> import fastlink as fl
    >>> float(fl.planar.straightness([0.0, 2.0, 4.0, 6.0], [1.0, -1.0, -1.0, 1.0]))
    1.0
    """
    points = np.stack(broadcast_points("straightness", x, y), axis=-1)
    curves = points.reshape(math.prod(points.shape[:-2]), *points.shape[-2:])
    half_widths = [_half_width(curve[np.isfinite(curve).all(axis=-1)]) for curve in curves]
    return np.array(half_widths).reshape(points.shape[:-2])[()]


@door(hint=BY_NAME)
def curve_straightness(
    design: Any = None,
    *,
    theta1: tuple[float, float] | None = None,
    branch: Any = 1,
    samples: int = 720,
    **inputs: Any,
) -> Any:
    """Return the `straightness` of the coupler curve or of a part of it [m].

    Parameters
    ----------
    design : mapping, pandas.DataFrame or xarray.Dataset, optional
        Inputs of ``planar_4r`` by name: lengths ``a1`` ... ``a4`` and coupler point ``P_u``, ``P_v`` [m], broadcast.
        Other inputs are not read.
    theta1 : (float, float), optional
        Least and greatest input angle [rad] of the part; the whole curve of the branch unless given.
    branch : int or array_like
        Assembly mode, broadcast with the design.
    samples : int
        Input angles.
    **inputs : float, array_like or xarray.DataArray
        The same by name.

    Returns
    -------
    ndarray
        The greatest distance from the best line. Angles at which the linkage does not assemble are skipped.

    Examples
    --------
    Chebyshev's straight line of the lambda linkage, 1 : 2.5 : 2.5 : 2 with P at 2 a2:

    >>> import fastlink as fl
    >>> design = dict(a1=1.0, a2=2.5, a3=2.5, a4=2.0, P_u=5.0, P_v=0.0)
    >>> part = fl.planar.curve_straightness(design, theta1=(2.1, 4.2), branch=2)
    >>> whole = fl.planar.curve_straightness(design, branch=2)
    >>> round(float(part), 4), round(float(whole), 4)
    (0.0049, 0.4495)
    """
    curve, angles = (
        curve_inputs("curve_straightness", design, inputs, branch),
        one_turn("curve_straightness", samples),
    )
    if theta1 is not None:
        ends = ends_of("curve_straightness", "theta1", theta1, RADIANS, "write (least, greatest) in rad")
        angles = np.linspace(ends[0], ends[1], angles.size)
    path = along_curve(["P_x", "P_y"], curve, angles)
    return straightness(path["P_x"], path["P_y"])
