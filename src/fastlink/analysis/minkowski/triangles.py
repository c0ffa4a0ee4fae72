"""Pure triangles, the Minkowskian cosine rule, and the reversed triangle inequality (section 2.2 of the paper)."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fastlink.analysis.minkowski.vectors import null_between, number, product_difference, read, same_arm
from fastlink.doors import door
from fastlink.numerics.compensated import sum_of_four

__all__ = [
    "PureTriangle",
    "cosine_rule",
    "cosine_rule_angle",
    "pure_triangle",
    "quadrilateral_excess",
    "triangle_excess",
]


#: Up to it the sine of half an angle by sides is an ordinary double.
MOST_DOUBLINGS = 1000


class PureTriangle(NamedTuple):
    """Sides and angles of pure triangles ABC, NaN where a triangle is not pure.

    Attributes
    ----------
    pure : ndarray of bool
        Whether AB and BC are future-pointing timelike vectors.
    a, b, c : ndarray
        Lengths of BC, AC and AB [m].
    angle_A, angle_B, angle_C : ndarray
        Angles between the lines at A, B and C, not oriented; that at B is the exterior one, the sum of the others.
    excess : ndarray
        The reversed triangle inequality: b - a - c >= 0 [m].
    """

    pure: Any
    a: Any
    b: Any
    c: Any
    angle_A: Any
    angle_B: Any
    angle_C: Any
    excess: Any


@door
def pure_triangle(A: Any, B: Any, C: Any) -> PureTriangle:
    """Return sides and angles of triangles whose AB and BC are future-pointing timelike vectors.

    Hegedues and Moore, section 2.2: the class of triangles of the cosine rule, Theorem 2.4. By Lemma 2.1 AC is timelike
    and future-pointing too.

    Parameters
    ----------
    A, B, C : array_like, shape (..., 2)
        Vertices x, y [m]; NaN where there is none. They broadcast.

    Returns
    -------
    PureTriangle
        Whether each triangle is pure, by exact signs, its sides, angles and b - a - c, right to some 20 roundings
        of each, however flat the triangle and however near its sides to the light cone.

    Raises
    ------
    InputError
        A vertex has not two coordinates along its last axis, is not finite, or the shapes do not broadcast.

    Examples
    --------
    >>> import fastlink as fl
    >>> found = fl.minkowski.pure_triangle([0.0, 0.0], [3.0, 5.0], [0.0, 10.0])
    >>> bool(found.pure), float(found.a), float(found.b), float(found.c), float(found.excess)
    (True, 4.0, 10.0, 4.0, 2.0)
    """
    A, B, C = read("pure_triangle", {"A": A, "B": B, "C": C})
    with np.errstate(all="ignore"):
        AB, BC, AC = null_between(A, B), null_between(B, C), null_between(A, C)
        pure = (AB[0] > 0.0) & (AB[1] < 0.0) & (BC[0] > 0.0) & (BC[1] < 0.0)
        AB, BC, AC = (_where(pure, side) for side in (AB, BC, AC))
        a, b, c = _null_length(BC), _null_length(AC), _null_length(AB)
        angles = abs(_null_angle(AB, AC)), abs(_null_angle(AB, BC)), abs(_null_angle(BC, AC))
        parts = pure, a, b, c, *angles, _null_excess(AB, BC)
    return PureTriangle(*(part[()] for part in parts))


@door
def cosine_rule(a: Any, b: Any, angle: Any) -> Any:
    """Return the third side c of pure triangles, c^2 = a^2 + b^2 - 2 a b ch(C).

    Hegedues and Moore, Theorem 2.4, for the angle C between the sides a and b. The same rule holds for triangles of
    spacelike sides, which are mirror images of pure ones at the line y = x.

    Parameters
    ----------
    a, b : float or array_like
        Lengths of BC and AC [m].
    angle : float or array_like
        The angle C between them. All broadcast.

    Returns
    -------
    ndarray, shape (...)
        The length of AB [m], as sqrt((d - s)(d + s)) with d = abs(a - b) and s = 2 sqrt(a b) sh(C/2): what the
        rounding of a, b and C does to it, and 4 roundings. NaN where d < s: no such triangle.

    Raises
    ------
    InputError
        A length is not positive, a value not finite, or the shapes do not broadcast.

    Examples
    --------
    >>> import fastlink as fl, numpy as np
    >>> round(float(fl.minkowski.cosine_rule(4.0, 10.0, np.log(2.0))), 12)
    4.0
    """
    declared = [*_sides("ab"), number("angle", "angle between two sides")]
    a, b, angle = read("cosine_rule", {}, zip(declared, (a, b, angle), strict=True))
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        exponent = np.frexp(np.maximum(a, b))[1]
        a, b = np.ldexp(a, -exponent), np.ldexp(b, -exponent)
        difference, arm = abs(a - b), 2.0 * (np.sqrt(a) * np.sqrt(b)) * np.sinh(0.5 * abs(angle))
        return np.ldexp(np.sqrt((difference - arm) * (difference + arm)), exponent)[()]


@door
def cosine_rule_angle(a: Any, b: Any, c: Any) -> Any:
    """Return the angle C of pure triangles by their sides, ch(C) = (a^2 + b^2 - c^2)/(2 a b).

    Hegedues and Moore, Theorem 2.4, as 4 a b sh^2(C/2) = (d - c)(d + c) with d = abs(a - b), where nothing cancels near
    C = 0.

    Parameters
    ----------
    a, b, c : float or array_like
        Lengths of BC, AC and AB [m]. They broadcast.

    Returns
    -------
    ndarray, shape (...)
        The angle, right to 10 roundings; 0 where A, B and C are in line, NaN where d < c: by the reversed triangle
        inequality there is no such triangle.

    Raises
    ------
    InputError
        A length is not positive and finite, or the shapes do not broadcast.

    Examples
    --------
    >>> import fastlink as fl, numpy as np
    >>> float(np.exp(fl.minkowski.cosine_rule_angle(4.0, 10.0, 4.0)).round(12))
    2.0
    """
    a, b, c = read("cosine_rule_angle", {}, zip(_sides("abc"), (a, b, c), strict=True))
    with np.errstate(all="ignore"):
        shortest, exponent = np.minimum(a, b), np.frexp(np.maximum(np.maximum(a, b), c))[1]
        a, b, c = (np.ldexp(side, -exponent) for side in (a, b, c))
        long, short = np.maximum(a, b), np.minimum(a, b)
        less, more = (sum_of_four(long, -short, side, 0.0 * c)[0] for side in (-c, c))
        least, doublings = np.frexp(shortest)
        doublings = exponent - doublings
        ratio = np.sqrt(less / long) * np.sqrt(np.ldexp(more / least, doublings % 2))
        # of links so unequal that the sine is beyond doubles, its logarithm
        far = 2.0 * np.log(ratio) + (doublings - doublings % 2) * np.log(2.0)
        near = 2.0 * np.arcsinh(np.ldexp(0.5 * ratio, doublings // 2))
        return np.where(doublings < MOST_DOUBLINGS, near, far)[()]


@door
def triangle_excess(z: Any, w: Any) -> Any:
    """Return by how much the reversed triangle inequality holds, |z + w| - |z| - |w|.

    Hegedues and Moore, Lemma 2.1 of future-pointing timelike vectors and Lemma 2.2 of future-pointing spacelike ones:
    it is not negative, and 0 if and only if w = c z for some c > 0. So too for past-pointing vectors.

    Parameters
    ----------
    z, w : array_like, shape (..., 2)
        Vectors x, y [m]; NaN where there is none. They broadcast.

    Returns
    -------
    ndarray, shape (...)
        The excess [m], as 4 (x v - y u)^2 over sums of positive terms: right to 20 roundings, also of nearly parallel
        vectors. NaN where the vectors are not both spacelike or both timelike, of one orientation.

    Raises
    ------
    InputError
        A vector has not two coordinates along its last axis, is not finite, or the shapes do not broadcast.

    Examples
    --------
    >>> import fastlink as fl
    >>> fl.minkowski.triangle_excess([[3.0, 5.0], [3.0, 5.0]], [[-3.0, 5.0], [6.0, 10.0]])
    array([2., 0.])
    """
    (x, y), (u, v) = read("triangle_excess", {"z": z, "w": w})
    alike = same_arm(x, y, u, v)
    x, y, u, v = (np.where(alike, part, np.nan) for part in (x, y, u, v))
    with np.errstate(all="ignore"):
        return _excess((x, y), (u, v), (x + y, x - y), (u + v, u - v))[()]


@door
def quadrilateral_excess(O: Any, A: Any, B: Any, C: Any) -> Any:
    """Return g - a - b - h of quadrilaterals OABC with future-pointing spacelike OA, AB, BC.

    Hegedues and Moore, Corollary 2.3: with a = |OA|, b = |BC|, g = |OC| and h = |AB| it is not negative, and 0 only if
    all points are in line.

    Parameters
    ----------
    O, A, B, C : array_like, shape (..., 2)
        Vertices x, y [m]; NaN where there is none. They broadcast.

    Returns
    -------
    ndarray, shape (...)
        The excess [m], the sum of those of the triangles OAB and OBC; NaN where OA, AB or BC is not a future-pointing
        spacelike vector (OC then is one).

    Raises
    ------
    InputError
        A vertex has not two coordinates along its last axis, is not finite, or the shapes do not broadcast.

    Examples
    --------
    >>> import fastlink as fl
    >>> float(fl.minkowski.quadrilateral_excess([0.0, 0.0], [5.0, 3.0], [10.0, 0.0], [12.0, 0.0]))
    2.0
    """
    O, A, B, C = read("quadrilateral_excess", {"O": O, "A": A, "B": B, "C": C})
    with np.errstate(all="ignore"):
        sides = null_between(O, A), null_between(A, B), null_between(B, C)
        ahead = np.logical_and.reduce([part > 0.0 for side in sides for part in side])
        OA, AB, BC = (_where(ahead, side) for side in sides)
        return (_null_excess(OA, AB) + _null_excess(null_between(O, B), BC))[()]


def _sides(names: str) -> list[Any]:
    """Return the declarations of sides of a triangle."""
    return [number(name, "length of a side", "m", "positive") for name in names]


def _where(condition: Any, null: tuple[Any, Any]) -> tuple[Any, Any]:
    """Return null coordinates where a condition holds, elsewhere NaN."""
    return np.where(condition, null[0], np.nan), np.where(condition, null[1], np.nan)


def _null_length(null: tuple[Any, Any]) -> Any:
    """Return the length of a vector by its null coordinates."""
    (u, i), (v, j) = np.frexp(abs(null[0])), np.frexp(abs(null[1]))
    exponent = i + j
    return np.ldexp(np.sqrt(np.ldexp(u * v, exponent % 2)), exponent // 2)


def _null_angle(one: tuple[Any, Any], other: tuple[Any, Any]) -> Any:
    """Return the angle between vectors on one arm by their null coordinates: e^(2 phi) = (u' v)/(u v')."""
    difference, exponent = product_difference(other[0], one[1], one[0], other[1])
    product = _null_length(one) * _null_length(other)
    return np.arcsinh(0.5 * np.ldexp(difference / product, exponent))


def _null_excess(one: tuple[Any, Any], other: tuple[Any, Any]) -> Any:
    """Return |z + w| - |z| - |w| of vectors on one arm by their null coordinates."""
    (u, v), (r, s) = one, other
    return _excess((u, v), (r, s), one, other, moment=0.5)


def _excess(
    one: tuple[Any, Any],
    other: tuple[Any, Any],
    null: tuple[Any, Any],
    null_other: tuple[Any, Any],
    moment: float = 1.0,
) -> Any:
    """Return (u s - v r)^2/((sqrt(abs(u s)) + sqrt(abs(v r)))^2 (|z + w| + |z| + |w|)) with null (u, v) and (r, s).

    2 (x y' - y x') is v r - u s; moment is what one x other is multiplied by to be x y' - y x'.
    """
    cross, exponent = product_difference(one[0], other[1], one[1], other[0])
    (u, v), (r, s) = null, null_other
    lengths = _null_length((u + r, v + s)) + (_null_length(null) + _null_length(null_other))
    mean = _null_length((u, s)) + _null_length((v, r))
    ratio = np.ldexp(2.0 * moment * cross / mean, exponent)
    return ratio * (ratio / lengths)
