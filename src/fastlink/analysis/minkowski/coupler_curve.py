"""The coupler curve of the Minkowskian planar 4R as an algebraic curve."""

from __future__ import annotations

from typing import Any

from fastlink.analysis.designs import broadcast, check_lengths
from fastlink.analysis.sextics import coupler_sextic
from fastlink.doors import door
from fastlink.mechanisms.minkowski_4r import minkowski_4r

__all__ = ["sextic"]


def __dir__() -> list[str]:
    return __all__


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
