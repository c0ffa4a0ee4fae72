"""Coupler curves of the planar 4R as curves: equation, cognates, length, area, straightness.

Nothing here is per configuration; the coupler point and its derivatives are facts of the mechanism.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fastlink.errors import InputError
from fastlink.reading import evaluate

__all__ = ["Cognate", "cognates", "curve_area", "curve_length", "sextic", "straightness"]


def _designs(*values: Any) -> list[Any]:
    """Broadcast the numbers of one or many designs against each other."""
    return list(np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in values)))


def _polynomial(size: int, **terms: Any) -> Any:
    """Return coefficients (..., size, size) from terms named by their powers, x1y2 for X Y^2."""
    first = np.asarray(next(iter(terms.values())))
    result = np.zeros((*first.shape, size, size))
    for powers, coefficient in terms.items():
        result[..., int(powers[1]), int(powers[3])] = coefficient
    return result


def _product(f: Any, g: Any) -> Any:
    """Multiply two polynomials in X and Y of total degree n - 1, coefficients (..., n, n)."""
    n, m = f.shape[-1], g.shape[-1]
    result = np.zeros((*f.shape[:-2], n + m - 1, n + m - 1))
    for i in range(n):
        for j in range(n - i):
            result[..., i : i + m, j : j + m] += f[..., i, j, None, None] * g
    return result


def sextic(a1: Any, a2: Any, a3: Any, a4: Any, P_u: Any, P_v: Any) -> Any:
    r"""Return the tricircular sextic that every coupler point of a linkage satisfies.

    Parameters
    ----------
    a1, a2, a3, a4 : float or array_like
        Lengths of crank, coupler, output link and ground [m], broadcast with the coupler point.
    P_u, P_v : float or array_like
        The coupler point, along AB from A and to the left of AB [m].

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
    >>> c = fl.planar.sextic(3.0, 4.0, 5.0, 6.0, 0.0, 0.0)  # P = A, on the circle of radius 3
    >>> float(np.polynomial.polynomial.polyval2d(0.0, 3.0, c))
    0.0
    """
    a1, a2, a3, a4, u, v = _designs(a1, a2, a3, a4, P_u, P_v)
    square = u * u + v * v
    k = square - a1 * a1
    middle = 2.0 * a2 * u - (a1 - a3) * (a1 + a3) - a2 * a2 - a4 * a4
    along, across = u / a2, v / a2
    # g = a4 z^2 + middle z - k a4, then W = (z conj(z) + k)(z - a4) - (along - i across) g.
    real = _polynomial(4, x2y0=a4, x0y2=-a4, x1y0=middle, x0y0=-k * a4)
    imaginary = _polynomial(4, x1y1=2.0 * a4, x0y1=middle)
    one = np.ones_like(a4)
    along, across = along[..., None, None], across[..., None, None]
    W_real = _polynomial(4, x3y0=one, x1y2=one, x2y0=-a4, x0y2=-a4, x1y0=k, x0y0=-k * a4)
    W_real -= along * real + across * imaginary
    W_imaginary = _polynomial(4, x2y1=one, x0y3=one, x0y1=k) - (along * imaginary - across * real)
    V = _polynomial(4, x0y1=a4 * (square / a2 - u), x2y0=-v, x0y2=-v, x1y0=v * a4)
    return _product(W_real, W_real) + _product(W_imaginary, W_imaginary) - 4.0 * _product(V, V)


@dataclass(frozen=True)
class Cognate:
    """One of the three linkages that trace the same coupler curve; `cognates` makes them.

    Attributes
    ----------
    a1, a2, a3, a4, P_u, P_v : ndarray
        Lengths and coupler point [m], as inputs of planar_4r, in the linkage's own ground frame.
    O_x, O_y, D_x, D_y : ndarray
        Ground pivots of its input and output link [m] in the ground frame of the original.
    number : int
        1 for the original, 2 and 3 for its cognates.
    """

    a1: Any
    a2: Any
    a3: Any
    a4: Any
    P_u: Any
    P_v: Any
    O_x: Any
    O_y: Any
    D_x: Any
    D_y: Any
    number: int

    def configuration(self, theta1: Any, theta2: Any, theta4: Any) -> tuple[Any, Any]:
        """Return the input angle [rad] and the branch that put this linkage's coupler point on the original's.

        Parameters
        ----------
        theta1, theta2, theta4 : float or array_like
            Directions of crank, coupler and output link of the original [rad].

        Returns
        -------
        theta1, branch : ndarray
            In the linkage's own frame. The coupler's direction drives both cognates; their branch changes where
            crank and output link of the original are parallel, which is a toggle of theirs.
        """
        t1, t2, t4 = _designs(theta1, theta2, theta4)
        if self.number == 1:
            return t1, np.where(np.sin(t4 - t2) > 0.0, 2, 1)
        turn = np.sin(t4 - t1) if self.number == 2 else np.sin(t1 - t4)
        return t2, np.where(turn > 0.0, 2, 1)

    def to_ground(self, x: Any, y: Any) -> tuple[Any, Any]:
        """Return a point (x, y) [m] of the linkage's own ground frame in that of the original."""
        cosine, sine = (self.D_x - self.O_x) / self.a4, (self.D_y - self.O_y) / self.a4
        return self.O_x + (cosine * x - sine * y), self.O_y + (sine * x + cosine * y)


def cognates(a1: Any, a2: Any, a3: Any, a4: Any, P_u: Any, P_v: Any) -> tuple[Cognate, Cognate, Cognate]:
    """Return the three linkages that trace one coupler curve (theorem of Roberts and Chebyshev).

    Parameters
    ----------
    a1, a2, a3, a4 : float or array_like
        Lengths of crank, coupler, output link and ground [m], broadcast with the coupler point.
    P_u, P_v : float or array_like
        The coupler point, along AB from A and to the left of AB [m].

    Returns
    -------
    tuple of Cognate
        The original; the one on O and E; the one on D and E, where E is the third ground pivot, the triangle
        O D E being similar to A B P. If P is A, the second has lengths zero and no direction (NaN); if P is B,
        the third.

    Notes
    -----
    With complex numbers, let lambda = (P_u + i P_v)/a2 and mu = 1 - lambda, so that P = A + lambda AB =
    B + mu BA, and E = lambda OD. The second linkage has the links OA' = lambda AB, A'B' = lambda OA and
    EB' = lambda DB, and P = A' + OA; the third has DA" = mu BA, A"B" = mu DB and EB" = mu OA, and P = A" + DB.
    Both loops close because the original does (S. Roberts, Proc. London Math. Soc. 7, 1875, 14-23).

    Examples
    --------
    >>> import fastlink as fl
    >>> first, second, third = fl.planar.cognates(0.5, 1.0, 0.75, 2.0, 0.0, 2.0)
    >>> [float(second.a1), float(second.a2), float(second.a3), float(second.a4)]
    [2.0, 1.0, 1.5, 4.0]
    >>> float(second.D_x), float(second.D_y)
    (0.0, 4.0)
    """
    a1, a2, a3, a4, u, v = _designs(a1, a2, a3, a4, P_u, P_v)
    zero = np.zeros_like(a4)
    along, across = u / a2, v / a2
    E_x, E_y = along * a4, across * a4
    rest = (a2 - u) / a2
    with np.errstate(invalid="ignore"):  # zero over zero: a cognate of lengths zero
        size = np.hypot(u, v) / a2
        second = (size * a2, size * a1, size * a3, size * a4, a1 * (along / size), -a1 * (across / size))
        size = np.hypot(a2 - u, v) / a2
        third = (size * a2, size * a3, size * a1, size * a4, a3 * (rest / size), a3 * (across / size))
    return (
        Cognate(a1, a2, a3, a4, u, v, zero, zero, a4, zero, 1),
        Cognate(*second, zero, zero, E_x, E_y, 2),
        Cognate(*third, a4, zero, E_x, E_y, 3),
    )


def _one_turn(quantities: list[str], numbers: tuple[Any, ...], branch: int, samples: int) -> dict[str, Any]:
    """Evaluate over one turn of the input at unit speed, angles in the last axis."""
    if samples < 1:
        raise InputError(f"samples is {samples}; give at least 1")
    names = ("a1", "a2", "a3", "a4", "P_u", "P_v")
    inputs = {name: value[..., None] for name, value in zip(names, _designs(*numbers), strict=True)}
    # Half a step off theta1 = 0, where a change point may have no rates.
    theta1 = (np.arange(samples) + 0.5) * (2.0 * np.pi / samples)
    return evaluate("planar_4r", quantities, branch=branch, theta1=theta1, omega1=1.0, **inputs)


def curve_length(
    a1: Any, a2: Any, a3: Any, a4: Any, P_u: Any, P_v: Any, *, branch: int = 1, samples: int = 720
) -> Any:
    """Return the length of the path of the coupler point over one turn of the input [m].

    Parameters
    ----------
    a1, a2, a3, a4, P_u, P_v : float or array_like
        Lengths and coupler point [m], broadcast.
    branch : int
        Assembly mode.
    samples : int
        Input angles over the turn.

    Returns
    -------
    ndarray
        The mean speed times the period; NaN where the input does not turn fully.

    Notes
    -----
    The periodic trapezoidal rule: the error falls geometrically with the samples, the faster the farther the
    curve is from a cusp and the linkage from a change point. At a cusp it falls with their square.

    Examples
    --------
    >>> import fastlink as fl
    >>> round(float(fl.planar.curve_length(0.5, 1.2, 0.8, 1.0, 0.0, 0.0)), 12)  # P = A: 2 pi a1
    3.14159265359
    """
    found = _one_turn(["P_speed"], (a1, a2, a3, a4, P_u, P_v), branch, samples)
    return 2.0 * np.pi * np.mean(found["P_speed"], axis=-1)


def curve_area(
    a1: Any, a2: Any, a3: Any, a4: Any, P_u: Any, P_v: Any, *, branch: int = 1, samples: int = 720
) -> Any:
    """Return the area that the coupler curve encloses over one turn of the input [m2].

    Parameters
    ----------
    a1, a2, a3, a4, P_u, P_v : float or array_like
        Lengths and coupler point [m], broadcast.
    branch : int
        Assembly mode.
    samples : int
        Input angles over the turn.

    Returns
    -------
    ndarray
        The signed area, half the integral of x dy - y dx: parts that the curve runs around to the left
        as theta1 grows count positive, to the right negative (the loops of a figure eight subtract). NaN where
        the input does not turn fully.

    Notes
    -----
    The periodic trapezoidal rule, as in `curve_length`; the integrand is smooth at cusps too.

    Examples
    --------
    >>> import fastlink as fl
    >>> round(float(fl.planar.curve_area(0.5, 1.2, 0.8, 1.0, 0.0, 0.0)), 12)  # P = A: pi a1^2
    0.785398163397
    """
    found = _one_turn(["P_x", "P_y", "P_vx", "P_vy"], (a1, a2, a3, a4, P_u, P_v), branch, samples)
    return np.pi * np.mean(found["P_x"] * found["P_vy"] - found["P_y"] * found["P_vx"], axis=-1)


def straightness(x: Any, y: Any) -> Any:
    """Return the greatest distance of points from their best line in the least-squares sense [m].

    Parameters
    ----------
    x, y : array_like
        Points [m] of a curve or a part of it in the last axis, such as P_x and P_y over theta1. NaN is left
        out.

    Returns
    -------
    ndarray
        The greatest distance from the line through the centroid along which the points spread most (least sum of
        squared distances), which is at least that from the line of least greatest distance. NaN without
        points.

    Examples
    --------
    >>> import fastlink as fl
    >>> float(fl.planar.straightness([0.0, 2.0, 4.0, 6.0], [1.0, -1.0, -1.0, 1.0]))
    1.0
    """
    x, y = _designs(x, y)
    there = np.isfinite(x) & np.isfinite(y)
    count = np.sum(there, axis=-1, keepdims=True)
    with np.errstate(invalid="ignore"):  # zero over zero: no points
        x = np.where(there, x - np.sum(x, axis=-1, keepdims=True, where=there) / count, 0.0)
        y = np.where(there, y - np.sum(y, axis=-1, keepdims=True, where=there) / count, 0.0)
    # The principal direction halves the angle of the vector (S_xx - S_yy, 2 S_xy).
    excess = np.sum((x - y) * (x + y), axis=-1, keepdims=True)
    angle = 0.5 * np.arctan2(2.0 * np.sum(x * y, axis=-1, keepdims=True), excess)
    distance = np.max(np.abs(np.cos(angle) * y - np.sin(angle) * x), axis=-1)
    return np.where(count[..., 0] > 0, distance, np.nan)[()]
