"""Double points of the coupler curve of a planar 4R: crunodes and cusps.

Roberts' sextic has three double points besides the circular points. With the notation of `fastlink.planar.sextic`,
two coupler angles for one point make its two linear equations one: (A_2, B_2, C_2) is a multiple of
(A_1, B_1, C_1). The first two say that the point z lies on the circle of singular foci, through O, D and the third
pivot of the cognates,

    z = a4/(1 + sigma g),  g = conj(p) q/(|p||q|),  sigma real,  A_2 + i B_2 = -sigma (|q|/|p|)(A_1 + i B_1),

and the third is then a cubic for sigma:

    a4^2 sigma (|q| + sigma |p|)
        + (1 + 2 sigma Re g + sigma^2) [(|q|^2 - a3^2)|p| + sigma |q| (|p|^2 - a1^2)] = 0.

In the triangle O A P with the sides a1, |p|, |z| the angle at P has the cosine c = (|z|^2 + |p|^2 - a1^2)/(2 |z||p|),
at a double point that of D B P but for the sign.
The two coupler angles are twice that angle apart: two configurations of the linkage meet at z where |c| < 1, none
does where |c| > 1; where |c| = 1 they are one, with O, A, P and D, B, P in line: P is the pole of the coupler,
on its moving centrode, and rests. The curve has a cusp there.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fastlink.analysis.designs import BY_NAME, CURVE, read_design
from fastlink.doors import door
from fastlink.errors import InputError
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.space.degrees import in_unit
from fastlink.space.values import constant

__all__ = ["crunode_count", "crunodes", "cusp_count", "cusps"]

#: Of 1 - |c|. The cubic's root and the triangle are right to roundings times their condition numbers, rarely above
#: 1e5: 1e-11. A crunode with 1 - |c| below it has a loop shorter than some 1e-9 of the lengths.
TOLERANCE = 1e-9

#: Directions of which one at least is far from the roots of any cubic form.
DIRECTIONS = np.arange(7) * (np.pi / 7.0)


def _cubic_form(k: Any, x: Any, y: Any) -> Any:
    """Return k3 x^3 + k2 x^2 y + k1 x y^2 + k0 y^3."""
    return ((k[..., 3] * x + k[..., 2] * y) * x + k[..., 1] * y * y) * x + k[..., 0] * y * y * y


def _turned(k: Any, c: Any, s: Any) -> Any:
    """Return the coefficients of a cubic form in t, for x = c t - s and y = s t + c."""
    result = np.zeros(k.shape)
    for power in range(4):
        term = [k[..., power]]
        for low, high in [(-s, c)] * power + [(c, s)] * (3 - power):
            lower, higher = [part * low for part in term], [part * high for part in term]
            term = [lower[0], *(one + two for one, two in zip(lower[1:], higher, strict=False)), higher[-1]]
        for i in range(4):
            result[..., i] += term[i]
    return result


def _real_roots(k: Any) -> tuple[Any, Any]:
    """Return the real zeros (x, y) of cubic forms, three in the last axis or NaN."""
    values = _cubic_form(k[..., None, :], np.cos(DIRECTIONS), np.sin(DIRECTIONS))
    best = DIRECTIONS[np.argmax(np.abs(values), axis=-1)]
    c, s = np.cos(best), np.sin(best)
    turned = _turned(k, c, s)
    companion = np.zeros((*k.shape[:-1], 3, 3))
    companion[..., 1, 0] = companion[..., 2, 1] = 1.0
    companion[..., :, 2] = -turned[..., :3] / turned[..., 3:]
    good: Any = np.isfinite(companion).all(axis=(-2, -1))
    roots = np.linalg.eigvals(np.where(good[..., None, None], companion, 0.0))
    t = np.where((roots.imag == 0.0) & good[..., None], roots.real, np.nan)
    x, y = c[..., None] * t - s[..., None], s[..., None] * t + c[..., None]
    size = np.hypot(x, y)
    return x / size, y / size


def _double_points(function: str, design: Any, inputs: Mapping[str, Any]) -> tuple[Any, Any, Any]:
    """Return the real double points X, Y and 1 - |c|, three in the last axis or NaN."""
    a1, a2, a3, a4, u, v = read_design(function, planar_4r, design, inputs, CURVE).values()
    p, q = np.hypot(u, v), np.hypot(u - a2, v)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):  # P is A or B, or nearly
        cosine, sine = (u * (u - a2) + v * v) / (p * q), a2 * v / (p * q)
        first, last = (q - a3) * (q + a3) * p, (p - a1) * (p + a1) * q
        square = a4 * a4
        k = np.stack(
            [
                first,
                2.0 * cosine * first + last + square * q,
                first + 2.0 * cosine * last + square * p,
                last,
            ],
            axis=-1,
        )
        x, y = _real_roots(k)
        # z = a4 y/(y + x g)
        real, imaginary = y + x * cosine[..., None], x * sine[..., None]
        scale = a4[..., None] * y / (real * real + imaginary * imaginary)
        X, Y = scale * real, -scale * imaginary
        # From the farther ground pivot: at z = 0 the triangle O A P is degenerate.
        z, w = np.hypot(X, Y), np.hypot(X - a4[..., None], Y)
        far, near, link = (
            np.where(z < w, of_D, of_O)
            for of_D, of_O in ((w, z), (q[..., None], p[..., None]), (a3[..., None], a1[..., None]))
        )
        # 1 - c and 1 + c; the less of them is 1 - |c|.
        acute = (link - (far - near)) * (link + (far - near)) / (2.0 * far * near)
        obtuse = ((far + near) - link) * ((far + near) + link) / (2.0 * far * near)
    return X, Y, np.fmin(acute, obtuse)


def _selected(X: Any, Y: Any, chosen: Any) -> tuple[Any, Any, Any]:
    """Return the chosen points by growing X, NaN-padded, and their number."""
    X, Y = np.where(chosen, X, np.nan), np.where(chosen, Y, np.nan)
    order = np.argsort(X, axis=-1)
    count = np.sum(chosen, axis=-1)
    return np.take_along_axis(X, order, axis=-1), np.take_along_axis(Y, order, axis=-1), count


def _crunodes(
    function: str, design: Any, inputs: Mapping[str, Any], tolerance: float
) -> tuple[Any, Any, Any]:
    limit = _check_tolerance(function, tolerance)
    X, Y, excess = _double_points(function, design, inputs)
    return _selected(X, Y, excess > limit)


def _cusps(function: str, design: Any, inputs: Mapping[str, Any], tolerance: float) -> tuple[Any, Any, Any]:
    limit = _check_tolerance(function, tolerance)
    X, Y, excess = _double_points(function, design, inputs)
    return _selected(X, Y, np.abs(excess) <= limit)


def _check_tolerance(function: str, tolerance: Any) -> float:
    where = (function, "tolerance")
    limit = float(in_unit(where, tolerance, np.asarray(constant(*where, tolerance)), "1"))
    if not 0.0 < limit < 0.1:
        remedy = "write a number between 0 and 0.1, such as 1e-9"
        raise InputError(f"is {limit}", where=where, remedy=remedy)
    return limit


@door(hint=BY_NAME)
def crunodes(design: Any = None, *, tolerance: float = TOLERANCE, **inputs: Any) -> tuple[Any, Any, Any]:
    """Return the points where the coupler curve of a linkage crosses itself.

    Parameters
    ----------
    design : mapping, pandas.DataFrame or xarray.Dataset, optional
        Inputs of ``planar_4r`` by name: lengths ``a1`` ... ``a4`` and coupler point ``P_u``, ``P_v`` [m], broadcast.
        Other inputs are not read.
    tolerance : float
        Double points within it count as cusps, see `cusps`.
    **inputs : float, array_like or xarray.DataArray
        The same by name.

    Returns
    -------
    X, Y : ndarray, shape (..., 3)
        The crunodes in the ground frame [m] by growing X, NaN-padded. The curve is that of both branches: two
        configurations of the linkage meet there, of one branch or of both.
    count : ndarray of int, shape (...)
        Their number. Where it changes from one design to the next, the curve has a cusp (a crunode turns into an
        isolated double point) or touches itself. It is 0 if P is A or B, which move on circles.

    Notes
    -----
    Roberts' double points on the circle of singular foci, which the linkage reaches with two coupler angles; one
    that it does not reach is an isolated point of the sextic. Where the sextic falls apart into curves of lower
    degree (parallelogram and kite), double points coincide; they are listed as often as the cubic has them.

    Examples
    --------
    >>> import fastlink as fl
    >>> X, Y, count = fl.planar.crunodes(a1=1.0, a2=2.5, a3=2.5, a4=2.0, P_u=1.25, P_v=1.0)
    >>> int(count), round(float(X[0]), 4), round(float(Y[0]), 4)
    (1, 1.7287, -0.9459)
    """
    return _crunodes("crunodes", design, inputs, tolerance)


@door(hint=BY_NAME)
def cusps(design: Any = None, *, tolerance: float = TOLERANCE, **inputs: Any) -> tuple[Any, Any, Any]:
    """Return the cusps of the coupler curve of a linkage, where P rests.

    Parameters
    ----------
    design : mapping, pandas.DataFrame or xarray.Dataset, optional
        Inputs of ``planar_4r`` by name: lengths ``a1`` ... ``a4`` and coupler point ``P_u``, ``P_v`` [m], broadcast.
        Other inputs are not read.
    tolerance : float
        A double point of the curve is a cusp if its two coupler directions differ by an angle 2 x with 1 - cos x at
        most this. Only designs that satisfy an equation have a cusp; one within the tolerance has a cusp, or a loop
        of length about tolerance times the lengths, or a turn as sharp without a double point.
    **inputs : float, array_like or xarray.DataArray
        The same by name.

    Returns
    -------
    X, Y : ndarray, shape (..., 3)
        The cusps in the ground frame [m] by growing X, NaN-padded, of both branches.
    count : ndarray of int, shape (...)
        Their number. It is 0 if P is A or B, which move on circles.

    Examples
    --------
    At theta1 = 90 degrees OA and DB meet in (0, 8), the pole of the coupler, which is its point (0, 6):

    >>> import fastlink as fl
    >>> X, Y, count = fl.planar.cusps(a1=2.0, a2=4.5, a3=2.5, a4=6.0, P_u=0.0, P_v=6.0)
    >>> int(count), round(float(X[0]), 9), round(float(Y[0]), 9)
    (1, 0.0, 8.0)
    """
    return _cusps("cusps", design, inputs, tolerance)


@door(hint=BY_NAME)
def crunode_count(design: Any = None, **inputs: Any) -> Any:
    """Return the number of crunodes of the coupler curve of a linkage.

    Parameters
    ----------
    design : mapping, pandas.DataFrame or xarray.Dataset, optional
        Inputs of ``planar_4r`` by name: lengths ``a1`` ... ``a4`` and coupler point ``P_u``, ``P_v`` [m], broadcast.
        Other inputs are not read.
    **inputs : float, array_like or xarray.DataArray
        The same by name.

    Returns
    -------
    ndarray of int
        0 to 3.

    Examples
    --------
    >>> import fastlink as fl
    >>> fl.planar.crunode_count(a1=1.0, a2=2.5, a3=2.5, a4=2.0, P_u=1.25, P_v=[1.0, 9.0])
    array([1, 0])
    """
    return _crunodes("crunode_count", design, inputs, TOLERANCE)[2]


@door(hint=BY_NAME)
def cusp_count(design: Any = None, **inputs: Any) -> Any:
    """Return the number of cusps of the coupler curve of a linkage.

    Parameters
    ----------
    design : mapping, pandas.DataFrame or xarray.Dataset, optional
        Inputs of ``planar_4r`` by name: lengths ``a1`` ... ``a4`` and coupler point ``P_u``, ``P_v`` [m], broadcast.
        Other inputs are not read.
    **inputs : float, array_like or xarray.DataArray
        The same by name.

    Returns
    -------
    ndarray of int
        0 to 3.

    Examples
    --------
    >>> import fastlink as fl
    >>> fl.planar.cusp_count(a1=2.0, a2=4.5, a3=2.5, a4=6.0, P_u=0.0, P_v=[6.0, 7.0])
    array([1, 0])
    """
    return _cusps("cusp_count", design, inputs, TOLERANCE)[2]
