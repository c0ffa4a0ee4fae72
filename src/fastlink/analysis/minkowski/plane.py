"""Double numbers as vectors of the Minkowskian plane: products, norm, causal type, angles (section 2 of the paper)."""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.analysis.minkowski.vectors import angle_of, grown, length_of, number, product_difference, read
from fastlink.doors import door

__all__ = [
    "causal_type",
    "conjugate",
    "hyperbolic_angle",
    "multiply",
    "norm",
    "orientation",
    "polar",
    "rapidity",
    "scalar_product",
]


@door
def multiply(z: Any, w: Any) -> Any:
    """Multiply two double numbers, j^2 = 1.

    Hegedues and Moore, section 2.1: (x + yj)(r + sj) = (xr + ys) + j(xs + yr).

    Parameters
    ----------
    z, w : array_like, shape (..., 2)
        Double numbers as vectors x, y; NaN where there is none. They broadcast.

    Returns
    -------
    ndarray, shape (..., 2)
        The product, each coordinate right to 2 roundings.

    Raises
    ------
    InputError
        A vector has not two coordinates along its last axis, is not finite, or the shapes do not broadcast.

    Examples
    --------
    >>> import fastlink as fl
    >>> fl.minkowski.multiply([0.0, 1.0], [0.0, 1.0]), fl.minkowski.multiply([1.0, 1.0], [1.0, -1.0])
    (array([1., 0.]), array([0., 0.]))
    """
    (x, y), (r, s) = read("multiply", {"z": z, "w": w})
    return np.stack([_plain(x, r, -y, s), _plain(x, s, -y, r)], axis=-1)


@door
def conjugate(z: Any) -> Any:
    """Return the hyperbolic conjugate x - yj of double numbers x + yj.

    Hegedues and Moore, section 2.1.

    Parameters
    ----------
    z : array_like, shape (..., 2)
        Double numbers as vectors x, y.

    Returns
    -------
    ndarray, shape (..., 2)
        The conjugates.

    Examples
    --------
    >>> import fastlink as fl
    >>> fl.minkowski.multiply([5.0, 3.0], fl.minkowski.conjugate([5.0, 3.0]))
    array([16.,  0.])
    """
    ((x, y),) = read("conjugate", {"z": z})
    return np.stack([x, -y], axis=-1)


@door
def polar(r: Any, phi: Any) -> Any:
    """Return the double number r e^(j phi) = r (ch phi + j sh phi).

    Hegedues and Moore, section 2.1: the analogue of Euler's formula. It is the point of rapidity phi on the Minkowskian
    circle x^2 - y^2 = r^2 about the origin, on its future-pointing arm x > 0 (the paper prints y > 0).

    Parameters
    ----------
    r : float or array_like
        The radius [m], not negative.
    phi : float or array_like
        The rapidity.

    Returns
    -------
    ndarray, shape (..., 2)
        The points.

    Examples
    --------
    >>> import fastlink as fl, numpy as np
    >>> fl.minkowski.polar(4.0, np.log(2.0))
    array([5., 3.])
    """
    radius = number("r", "radius of a Minkowskian circle", "m", "non-negative")
    r, phi = read("polar", {}, [(radius, r), (number("phi", "rapidity"), phi)])
    size = abs(phi)
    ahead, behind = grown(0.5 * r, size), grown(0.5 * r, -size)
    small = r * np.sinh(np.minimum(size, 1.0))
    across = np.where(size < 1.0, small, ahead - behind)
    return np.stack([ahead + behind, np.copysign(across, phi)], axis=-1)


@door
def scalar_product(z: Any, w: Any) -> Any:
    """Return the hyperbolic scalar product <z, w> = Re(z conj(w)) = x u - y v.

    Hegedues and Moore, section 2.1. Vectors are double-orthogonal where it is 0.

    Parameters
    ----------
    z, w : array_like, shape (..., 2)
        Vectors x, y and u, v; NaN where there is none. They broadcast.

    Returns
    -------
    ndarray, shape (...)
        The product [m^2], right to 2 roundings: its sign is exact, also of vectors that are nearly orthogonal.

    Raises
    ------
    InputError
        A vector has not two coordinates along its last axis, is not finite, or the shapes do not broadcast.

    Examples
    --------
    >>> import fastlink as fl
    >>> float(fl.minkowski.scalar_product([5.0, 3.0], [2.0, 1.0]))
    7.0
    """
    (x, y), (u, v) = read("scalar_product", {"z": z, "w": w})
    return _plain(x, u, y, v)[()]


@door
def norm(z: Any) -> Any:
    """Return the hyperbolic modulus of vectors, sqrt(abs(x^2 - y^2)).

    Hegedues and Moore, eq. (1): the hyperbolic distance from the origin, which no motion changes. It is 0 for isotropic
    vectors, on the lines y = x and y = -x.

    Parameters
    ----------
    z : array_like, shape (..., 2)
        Vectors x, y; NaN where there is none.

    Returns
    -------
    ndarray, shape (...)
        The modulus [m], right to 3 roundings, however near to the light cone.

    Raises
    ------
    InputError
        The vector has not two coordinates along its last axis, or is not finite.

    Examples
    --------
    >>> import fastlink as fl
    >>> fl.minkowski.norm([[5.0, 3.0], [3.0, 5.0], [1.0, -1.0]])
    array([4., 4., 0.])
    """
    ((x, y),) = read("norm", {"z": z})
    with np.errstate(over="ignore", under="ignore"):
        return np.ldexp(*length_of(x, y))[()]


@door
def causal_type(z: Any) -> Any:
    """Return 1 for spacelike, 0 for lightlike and -1 for timelike vectors.

    Hegedues and Moore, section 2.2: the sign of <z, z>, exact. The vector 0 is lightlike.

    Parameters
    ----------
    z : array_like, shape (..., 2)
        Vectors x, y; NaN where there is none.

    Returns
    -------
    ndarray, shape (...)
        The sign; NaN where the vector is.

    Examples
    --------
    >>> import fastlink as fl
    >>> fl.minkowski.causal_type([[5.0, 3.0], [1.0, -1.0], [3.0, 5.0]])
    array([ 1.,  0., -1.])
    """
    ((x, y),) = read("causal_type", {"z": z})
    return np.where(np.isnan(x + y), np.nan, np.sign(abs(x) - abs(y)))[()]


@door
def orientation(z: Any) -> Any:
    """Return 1 for future-pointing, -1 for past-pointing and 0 for lightlike vectors.

    Hegedues and Moore, section 2.2: the sign of y of a timelike vector, of x of a spacelike one.

    Parameters
    ----------
    z : array_like, shape (..., 2)
        Vectors x, y; NaN where there is none.

    Returns
    -------
    ndarray, shape (...)
        The sign; NaN where the vector is.

    Examples
    --------
    >>> import fastlink as fl
    >>> fl.minkowski.orientation([[5.0, 3.0], [1.0, -1.0], [3.0, -5.0]])
    array([ 1.,  0., -1.])
    """
    ((x, y),) = read("orientation", {"z": z})
    ahead = np.where(abs(x) > abs(y), x, np.where(abs(y) > abs(x), y, 0.0))
    return np.where(np.isnan(x + y), np.nan, np.sign(ahead))[()]


@door
def rapidity(z: Any) -> Any:
    """Return the angle of vectors from the axis of their causal type.

    The rapidity phi of a spacelike vector ±r (ch phi, sh phi), of a timelike one ±r (sh phi, ch phi): artanh(y/x), or
    artanh(x/y).

    Parameters
    ----------
    z : array_like, shape (..., 2)
        Vectors x, y; NaN where there is none.

    Returns
    -------
    ndarray, shape (...)
        The rapidity, right to 7 roundings; NaN of lightlike vectors, which have none.

    Examples
    --------
    >>> import fastlink as fl, numpy as np
    >>> bool(np.isclose(fl.minkowski.rapidity([5.0, 3.0]), np.log(2.0)))
    True
    """
    ((x, y),) = read("rapidity", {"z": z})
    size, exponent = length_of(x, y)
    there = size > 0.0
    short = np.ldexp(np.minimum(abs(x), abs(y)), -exponent)
    angle = np.arcsinh(short / np.where(there, size, 1.0))
    return np.where(there, np.sign(x) * np.sign(y) * angle, np.nan)[()]


@door
def hyperbolic_angle(z: Any, w: Any) -> Any:
    """Return the oriented angle phi from one vector to another, A(phi) z/|z| = w/|w|.

    Hegedues and Moore, section 2.2, where both are future-pointing: ch phi = <z, w>/(|z| |w|) of spacelike vectors and
    ch phi = -<z, w>/(|z| |w|) of timelike ones. Here they may both be past-pointing as well. The unoriented angle is
    its absolute value.

    Parameters
    ----------
    z, w : array_like, shape (..., 2)
        Vectors; NaN where there is none. They broadcast.

    Returns
    -------
    ndarray, shape (...)
        The angle, right to 12 roundings, of nearly parallel vectors too; NaN where one vector is lightlike, or both are
        of unlike causal types or orientations: no boost leads from one to the other.

    Raises
    ------
    InputError
        A vector has not two coordinates along its last axis, is not finite, or the shapes do not broadcast.

    Examples
    --------
    >>> import fastlink as fl, numpy as np
    >>> angle = fl.minkowski.hyperbolic_angle([1.0, 0.0], [5.0, 3.0])
    >>> bool(np.isclose(np.cosh(angle), 5 / 4))
    True
    >>> float(fl.minkowski.hyperbolic_angle([1.0, 0.0], [3.0, 5.0]))
    nan
    """
    (x, y), (u, v) = read("hyperbolic_angle", {"z": z, "w": w})
    return angle_of(x, y, u, v)[()]


def _plain(a: Any, b: Any, c: Any, d: Any) -> Any:
    """Return a b - c d as doubles."""
    with np.errstate(over="ignore", under="ignore"):
        return np.ldexp(*product_difference(a, b, c, d))
