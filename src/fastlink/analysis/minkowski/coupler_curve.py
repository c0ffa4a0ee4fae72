"""The coupler curve of the Minkowskian planar 4R as an algebraic curve."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fastlink.analysis.designs import broadcast, check_lengths
from fastlink.analysis.minkowski.vectors import number
from fastlink.analysis.sextics import coupler_sextic
from fastlink.doors import door
from fastlink.mechanisms.minkowski_4r import minkowski_4r

__all__ = ["CouplerCircles", "coupler_circles", "sextic"]


def __dir__() -> list[str]:
    return __all__


class CouplerCircles(NamedTuple):
    """The coefficients of eq. (14): A1 ch(lambda) + B1 sh(lambda) = C1 and A2 ch(lambda) + B2 sh(lambda) = C2.

    Attributes
    ----------
    A1, B1, C1 : ndarray
        Of the circle of B about C, eq. (10) [m^2].
    A2, B2, C2 : ndarray
        Of the circle of A about O, eq. (11) [m^2].
    """

    A1: Any
    B1: Any
    C1: Any
    A2: Any
    B2: Any
    C2: Any


@door
def coupler_circles(a: Any, b: Any, g: Any, h: Any, x: Any, y: Any, *, X: Any, Y: Any) -> CouplerCircles:
    """Return the coefficients of the two circles, eq. (14), that a coupler point at (X, Y) has to meet.

    Hegedues and Moore, section 3.5, with both corrections of docs/minkowski.md: eq. (10) with b, and A1 and B1 as the
    coefficients of ch and sh. The elimination of lambda, the rapidity of AX, is `sextic`.

    Parameters
    ----------
    a, b, g, h : float or array_like
        Hyperbolic lengths of OA, CB, OC and AB [m].
    x, y : float or array_like
        The coupler point in the frame at A with its first axis along AB [m], AX spacelike (abs(x) > abs(y)), BX of any
        causal type.
    X, Y : float or array_like
        A point of the ground frame [m]. All broadcast.

    Returns
    -------
    CouplerCircles
        Arrays A1 to C2, right to 8 roundings of the sizes of their terms; NaN where AX is not spacelike. They hold with
        (ch(lambda), sh(lambda)) for a future-pointing AX, and its opposite for a past-pointing one.

    Raises
    ------
    InputError
        A length is not in 1e-25 ... 1e25, a coordinate not in -1e25 ... 1e25, or they do not broadcast.

    Examples
    --------
    >>> import fastlink as fl
    >>> found = fl.minkowski.coupler_circles(1.0, 2.0, 4.0, 1.5, -1.0, 0.5, X=9.0, Y=8.5)
    >>> float(found.C2), round(float(found.A2), 12) == round(2 * 0.75**0.5 * 9.0, 12)
    (8.5, True)
    """
    declared = [minkowski_4r.inputs[name] for name in "abghxy"]
    declared += [number(name, "coordinate of the point", "m") for name in "XY"]
    numbers = broadcast("coupler_circles", declared, a, b, g, h, x, y, X, Y)
    check_lengths("coupler_circles", declared, numbers)
    a, b, g, h, x, y, X, Y = numbers
    with np.errstate(invalid="ignore"):
        r = np.where(abs(x) > abs(y), np.sqrt((x - y) * (x + y)), np.nan)
    end = x - h
    s_ch, s_sh = (x * end - y * y) / r, h * y / r  # s ch(gamma) and s sh(gamma)
    from_C = X - g
    A1, B1 = 2.0 * (from_C * s_ch - Y * s_sh), 2.0 * (from_C * s_sh - Y * s_ch)
    C1 = (from_C - Y) * (from_C + Y) - b * b + (end - y) * (end + y)
    C2 = (X - Y) * (X + Y) - a * a + r * r
    return CouplerCircles(A1, B1, C1, 2.0 * r * X, -2.0 * r * Y, C2)


@door
def sextic(a: Any, b: Any, g: Any, h: Any, x: Any, y: Any) -> Any:
    r"""Return the sextic that every coupler point of a Minkowskian planar 4R satisfies.

    Parameters
    ----------
    a, b, g, h : float or array_like
        Hyperbolic lengths of OA, CB, OC and AB [m], broadcast with the coupler point.
    x, y : float or array_like
        The coupler point X in the frame at A with its first axis along AB [m]. AX and BX may be spacelike, lightlike
        or timelike, of either orientation.

    Returns
    -------
    ndarray, shape (..., 7, 7)
        c with ``sum(c[..., i, j] X**i Y**j) = 0`` for the points (X, Y) [m] of the curve in the ground frame
        (origin O, X along OC), of both branches and both orientations of OA, AB and CB. c[i, j] has the unit
        m^(6 - i - j); the terms of degree six are (X^2 - Y^2)^3, so nothing is left to normalise.

    Raises
    ------
    InputError
        A length is not in 1e-25 ... 1e25, x or y not in -1e25 ... 1e25 (the coefficients, products of six lengths
        over h^2, then are finite), or they do not broadcast.

    Notes
    -----
    Hegedues and Moore, section 3.5, with both corrections of docs/minkowski.md, in double numbers (j^2 = 1):
    z = X + jY, p = x + jy and q = p - h are the coupler point seen from O, A and B, and e is AB/h, so that
    N(e) = e conj(e) = 1. The circles N(z - p e) = a^2 and N(z - q e - g) = b^2 are two linear equations for the parts
    of e, whose elimination is that of `fastlink.planar.sextic` sign by sign: divided by 4 h^2, with what cancels in it
    cancelled by hand, N(W) + 4 V^2 = 0 with

    .. math::
        W &= (N(z) + k)(z - g) - (\bar p/h)(g z^2 + (2 h x - a^2 - h^2 + b^2 - g^2) z - k g), \quad
             k = x^2 - y^2 - a^2, \\
        V &= g Y ((x^2 - y^2)/h - x) - y (N(z) - g X).

    The paper's r, s, gamma enter through r s ch(gamma) = x (x - h) - y^2 and r s sh(gamma) = h y alone, which need
    no r and no s: hence any causal type.

    Examples
    --------
    >>> import numpy as np
    >>> import fastlink as fl
    >>> c = fl.minkowski.sextic(3.0, 5.0, 6.0, 4.0, 0.0, 0.0)  # X = A, on the circle of radius 3: X^2 - Y^2 = 9
    >>> float(np.polynomial.polynomial.polyval2d(5.0, 4.0, c))
    0.0
    """
    declared = [minkowski_4r.inputs[name] for name in "abghxy"]
    a, b, g, h, x, y = numbers = broadcast("sextic", declared, a, b, g, h, x, y)
    check_lengths("sextic", declared, numbers)
    return coupler_sextic(1, (a, h, b, g), (x, y))
