"""Functions of the Minkowskian plane and of its planar 4R: vectors, motions, triangles, the coupler curve.

A vector or point is an array with its two coordinates x, y along the last axis, the double number x + j y, j^2 = 1;
NaN stands for none. Arguments broadcast. Values that are not finite or beyond 1e300, and other shapes, are refused with
`fastlink.InputError`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fastlink._text import in_words
from fastlink.engine.evaluate import broadcast_inputs
from fastlink.errors import InputError, Problems, door
from fastlink.facts.fact import Input
from fastlink.io.reader import as_dataset
from fastlink.mechanisms.minkowski_4r import minkowski_4r
from fastlink.numerics.compensated import sum_of_four, two_product
from fastlink.papers import broadcast, check_lengths, coupler_sextic, number, read_numbers

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "CouplerCircles",
    "PureTriangle",
    "boost",
    "causal_type",
    "conjugate",
    "cosine_rule",
    "cosine_rule_angle",
    "coupler_circles",
    "hyperbolic_angle",
    "linkage_table",
    "motion",
    "moved",
    "multiply",
    "norm",
    "orientation",
    "polar",
    "pure_triangle",
    "quadrilateral_excess",
    "rapidity",
    "scalar_product",
    "sextic",
    "triangle_excess",
]


def __dir__() -> list[str]:
    return __all__


# -- Vectors of the Minkowskian plane: how they are read, and differences of products that lose no digit

#: The exponent of a product that is zero: below that of every other.
NO_EXPONENT = -10000
#: Greatest coordinate and length: sums of four stay in the range of doubles.
GREATEST = 1e300
#: Up to it e^angle and its reciprocal are ordinary doubles.
MOST_OF_EXP = 700.0


def read(function: str, vectors: Mapping[str, Any], numbers: Iterable[tuple[Input, Any]] = ()) -> list[Any]:
    """Return the coordinates of each vector, then the numbers, as arrays of one shape; NaN may stand among them."""
    given = [(number(name, "coordinates x, y of a vector", "m"), value) for name, value in vectors.items()]
    given += numbers
    declared, values = {one.name: one for one, _ in given}, {one.name: value for one, value in given}
    first, second = read_numbers(
        function, declared, values, Problems(), gaps=True, vectors=vectors, greatest=GREATEST
    )
    ordinates = {f"{name}, y": y for name, y in second.items()}
    _, plain, shape = broadcast_inputs(function, first | ordinates)
    arrays = {name: np.broadcast_to(value, shape) for name, value in plain.items()}
    return [(arrays[name], arrays[f"{name}, y"]) if name in second else arrays[name] for name in first]


def grown(x: Any, angle: Any) -> Any:
    """Return x e^angle, which may be a double where e^angle is not."""
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        half = np.exp(0.5 * angle)
        product = np.where(abs(angle) < MOST_OF_EXP, x * np.exp(angle), (x * half) * half)
        return np.where(x == 0.0, 0.0 * angle, product)


def product_difference(a: Any, b: Any, c: Any, d: Any) -> tuple[Any, Any]:
    """Return v and n with a b - c d = v 2^n: right to 2 roundings, exact where it is zero, never out of range."""
    (a, i), (b, j), (c, k), (d, m) = (np.frexp(value) for value in (a, b, c, d))
    (p, p_low), (q, q_low) = two_product(a, b), two_product(c, d)
    exponents = np.where(p == 0.0, NO_EXPONENT, i + j), np.where(q == 0.0, NO_EXPONENT, k + m)
    common = np.maximum(*exponents)
    up, down = exponents[0] - common, exponents[1] - common
    p, p_low, q, q_low = np.ldexp(p, up), np.ldexp(p_low, up), np.ldexp(q, down), np.ldexp(q_low, down)
    return sum_of_four(p, p_low, -q, -q_low)[0], common


def length_of(x: Any, y: Any) -> tuple[Any, Any]:
    """Return v and n of the norm v 2^n of a vector: right to 3 roundings, however near the light cone."""
    exponent = np.frexp(np.maximum(abs(x), abs(y)))[1]
    x, y = np.ldexp(x, -exponent), np.ldexp(y, -exponent)
    return np.sqrt(abs(x - y) * abs(x + y)), exponent


def same_arm(x: Any, y: Any, u: Any, v: Any) -> Any:
    """Tell where two vectors are both spacelike or both timelike, and of one orientation."""
    spacelike = (abs(x) > abs(y)) & (abs(u) > abs(v)) & ((x > 0.0) == (u > 0.0))
    timelike = (abs(y) > abs(x)) & (abs(v) > abs(u)) & ((y > 0.0) == (v > 0.0))
    return spacelike | timelike


def angle_of(x: Any, y: Any, u: Any, v: Any) -> Any:
    """Return the oriented angle from (x, y) to (u, v): right to 12 roundings; NaN where they are not on one arm."""
    moment, exponent = product_difference(x, v, y, u)
    (one, i), (other, j) = length_of(x, y), length_of(u, v)
    alike = same_arm(x, y, u, v)
    sine = np.ldexp(moment / np.where(alike, one * other, 1.0), np.where(alike, exponent - i - j, 0))
    return np.where(alike, np.where(abs(x) > abs(y), 1.0, -1.0) * np.arcsinh(sine), np.nan)


def null_between(start: tuple[Any, Any], end: tuple[Any, Any]) -> tuple[Any, Any]:
    """Return the null coordinates x + y and x - y of the vector between two points, each to a rounding."""
    (x, y), (u, v) = start, end
    return sum_of_four(u, -x, v, -y)[0], sum_of_four(u, -x, -v, y)[0]


# -- Double numbers as vectors of the Minkowskian plane: products, norm, causal type, angles (section 2 of
#    the paper)


@door
def multiply(z: Any, w: Any) -> Any:
    """Multiply two double numbers, j^2 = 1.

    Hegedues and Moore, section 2.1: (x + yj)(r + sj) = (xr + ys) + j(xs + yr), each coordinate right to 2 roundings.

    Examples
    --------
    >>> fl.minkowski.multiply([0.0, 1.0], [0.0, 1.0]), fl.minkowski.multiply([1.0, 1.0], [1.0, -1.0])
    (array([1., 0.]), array([0., 0.]))
    """
    (x, y), (r, s) = read("multiply", {"z": z, "w": w})
    return np.stack([_plain(x, r, -y, s), _plain(x, s, -y, r)], axis=-1)


@door
def conjugate(z: Any) -> Any:
    """Return the hyperbolic conjugate x - yj of double numbers x + yj.

    Hegedues and Moore, section 2.1.

    Examples
    --------
    >>> fl.minkowski.multiply([5.0, 3.0], fl.minkowski.conjugate([5.0, 3.0]))
    array([16.,  0.])
    """
    ((x, y),) = read("conjugate", {"z": z})
    return np.stack([x, -y], axis=-1)


@door
def polar(r: Any, phi: Any) -> Any:
    """Return the double number r e^(j phi) = r (ch phi + j sh phi).

    Hegedues and Moore, section 2.1: the analogue of Euler's formula. It is the point of rapidity phi on the Minkowskian
    circle x^2 - y^2 = r^2 about the origin, r >= 0 [m], on its future-pointing arm x > 0 (the paper prints y > 0).

    Examples
    --------
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
    """Return the hyperbolic scalar product <z, w> = Re(z conj(w)) = x u - y v [m^2].

    Hegedues and Moore, section 2.1. Vectors are double-orthogonal where it is 0. It is right to 2 roundings: its sign
    is exact, also of vectors that are nearly orthogonal.

    Examples
    --------
    >>> float(fl.minkowski.scalar_product([5.0, 3.0], [2.0, 1.0]))
    7.0
    """
    (x, y), (u, v) = read("scalar_product", {"z": z, "w": w})
    return _plain(x, u, y, v)[()]


@door
def norm(z: Any) -> Any:
    """Return the hyperbolic modulus of vectors, sqrt(abs(x^2 - y^2)) [m].

    Hegedues and Moore, eq. (1): the hyperbolic distance from the origin, which no motion changes. It is 0 for isotropic
    vectors, on the lines y = x and y = -x; and right to 3 roundings, however near to the light cone.

    Examples
    --------
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

    Examples
    --------
    >>> fl.minkowski.causal_type([[5.0, 3.0], [1.0, -1.0], [3.0, 5.0]])
    array([ 1.,  0., -1.])
    """
    ((x, y),) = read("causal_type", {"z": z})
    return np.where(np.isnan(x + y), np.nan, np.sign(abs(x) - abs(y)))[()]


@door
def orientation(z: Any) -> Any:
    """Return 1 for future-pointing, -1 for past-pointing and 0 for lightlike vectors.

    Hegedues and Moore, section 2.2: the sign of y of a timelike vector, of x of a spacelike one.

    Examples
    --------
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
    artanh(x/y), right to 7 roundings; NaN of lightlike vectors, which have none.

    Examples
    --------
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
    its absolute value. It is right to 12 roundings, of nearly parallel vectors too; NaN where one vector is lightlike,
    or both are of unlike causal types or orientations: no boost leads from one to the other.

    Examples
    --------
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


# -- Motions of the Minkowskian plane: boosts and translations (section 2.2 of the paper)


@door
def boost(phi: Any) -> Any:
    """Return the matrix A(phi) of the proper Lorentzian group SO+(1, 1).

    Hegedues and Moore, section 2.2: rows (ch phi, sh phi) and (sh phi, ch phi). Products of boosts add their angles,
    the inverse is A(-phi), and scalar products, causal types and orientations stay.

    Examples
    --------
    >>> fl.minkowski.boost(np.log(2.0)) @ [4.0, 0.0]
    array([5., 3.])
    """
    (phi,) = read("boost", {}, [(number("phi", "angle of a boost"), phi)])
    return motion(phi)[..., :2, :2]


@door
def motion(t: Any, a: Any = 0.0, b: Any = 0.0) -> Any:
    """Return the matrix of a motion of the Minkowskian plane in homogeneous coordinates.

    Hegedues and Moore, section 2.2: the group of the matrices with rows (ch t, sh t, a), (sh t, ch t, b) and (0, 0, 1),
    a boost by t followed by a translation [m].

    Returns
    -------
    ndarray, shape (..., 3, 3)
        The matrices; what is beyond the range of doubles is infinite.

    Examples
    --------
    >>> fl.minkowski.motion(np.log(2.0), 1.0, -3.0) @ [4.0, 0.0, 1.0]
    array([6., 0., 1.])
    """
    t, a, b = read("motion", {}, _numbers(t, a, b))
    with np.errstate(over="ignore"):
        ch, sh = np.cosh(t), np.sinh(t)
    rows = [[ch, sh, a], [sh, ch, b], [0.0 * t, 0.0 * t, 0.0 * t + 1.0]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


@door
def moved(z: Any, t: Any, a: Any = 0.0, b: Any = 0.0) -> Any:
    """Move points by a boost and a translation, in null coordinates.

    The motion of `fastlink.minkowski.motion`, Hegedues and Moore, section 2.2: x + y is multiplied by e^t, x - y by
    e^-t. A point near the light cone keeps its digits where the matrix cancels.

    Returns
    -------
    ndarray, shape (..., 2)
        The points [m]; what is beyond the range of doubles is infinite.

    Examples
    --------
    >>> fl.minkowski.moved([4.0, 0.0], np.log(2.0), 1.0, -3.0)
    array([6., 0.])
    """
    (x, y), t, a, b = read("moved", {"z": z}, _numbers(t, a, b))
    u, v = grown(0.5 * x + 0.5 * y, t), grown(0.5 * x - 0.5 * y, -t)
    with np.errstate(over="ignore", invalid="ignore"):
        return np.stack([(u + v) + a, (u - v) + b], axis=-1)


def _numbers(t: Any, a: Any, b: Any) -> list[Any]:
    """Return the declarations of the numbers of a motion, with their values."""
    along, across = number("a", "translation along x", "m"), number("b", "translation along y", "m")
    return [(number("t", "angle of a boost"), t), (along, a), (across, b)]


# -- Pure triangles, the Minkowskian cosine rule, and the reversed triangle inequality (section 2.2 of the
#    paper)


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

    Returns
    -------
    PureTriangle
        Whether each triangle is pure, by exact signs, its sides, angles and b - a - c, right to some 20 roundings
        of each, however flat the triangle and however near its sides to the light cone.

    Examples
    --------
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
        The angle C between them.

    Returns
    -------
    ndarray, shape (...)
        The length of AB [m], as sqrt((d - s)(d + s)) with d = abs(a - b) and s = 2 sqrt(a b) sh(C/2): what the
        rounding of a, b and C does to it, and 4 roundings. NaN where d < s: no such triangle.

    Examples
    --------
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
        Lengths of BC, AC and AB [m].

    Returns
    -------
    ndarray, shape (...)
        The angle, right to 10 roundings; 0 where A, B and C are in line, NaN where d < c: by the reversed triangle
        inequality there is no such triangle.

    Examples
    --------
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
    it is not negative, and 0 if and only if w = c z for some c > 0. So too for past-pointing vectors. It is computed as
    4 (x v - y u)^2 over sums of positive terms [m]: right to 20 roundings, also of nearly parallel vectors. NaN where
    the vectors are not both spacelike or both timelike, of one orientation.

    Examples
    --------
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
    all points are in line. It is the sum of those of the triangles OAB and OBC [m]; NaN where OA, AB or BC is not a
    future-pointing spacelike vector (OC then is one).

    Examples
    --------
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


# -- The coupler curve of the Minkowskian planar 4R as an algebraic curve


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
    a, b, g, h, x, y : float or array_like
        As for `sextic`, but AX spacelike (abs(x) > abs(y)).
    X, Y : float or array_like
        A point of the ground frame [m].

    Returns
    -------
    CouplerCircles
        Arrays A1 to C2, right to 8 roundings of the sizes of their terms; NaN where AX is not spacelike. They hold with
        (ch(lambda), sh(lambda)) for a future-pointing AX, and its opposite for a past-pointing one.

    Examples
    --------
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
    >>> c = fl.minkowski.sextic(3.0, 5.0, 6.0, 4.0, 0.0, 0.0)  # X = A, on the circle of radius 3: X^2 - Y^2 = 9
    >>> float(np.polynomial.polynomial.polyval2d(5.0, 4.0, c))
    0.0
    """
    declared = [minkowski_4r.inputs[name] for name in "abghxy"]
    a, b, g, h, x, y = numbers = broadcast("sextic", declared, a, b, g, h, x, y)
    check_lengths("sextic", declared, numbers)
    return coupler_sextic(1, (a, h, b, g), (x, y))


# -- Tables 1 to 3 of the paper, filled from a map of linkages


SUMS = ("T1", "T2", "T3", "T4", "T5")
#: Where the paper has each kind, and how its condition is written.
KINDS = {
    "strange": ("Table 1", ">"),
    "rigid": ("Table 2", "="),
    "reducible": ("Theorems 3.20, 3.21", ""),
    "irreducible": ("Table 3", ""),
}
#: The link that the sign of a sum tells of, with that sign; b is left.
LONG_LINKS = {"T3": (1, "g > a + b + h"), "T4": (-1, "a > b + g + h"), "T5": (-1, "h > a + b + g")}
REMAINING = "b > a + g + h"


@door
def linkage_table(maps: Any) -> pd.DataFrame:
    """Return the linkages of a map by type and signs of T1 to T5, as Tables 1 to 3.

    Hegedues and Moore, section 3.6: the space of linkages. Each combination that occurs has a row, in the order of the
    tables: strange linkages (one link longer than the others together), rigid ones (as long), reducible ones (T1 = 0 or
    T2 = 0), and what is left, irreducible ones. Invalid designs are not counted.

    Parameters
    ----------
    maps : xarray.Dataset or path
        A sweep of ``"minkowski_4r"`` with ``linkage_type`` and ``T1`` to ``T5``, or its file.

    Returns
    -------
    pandas.DataFrame
        Columns: ``paper`` (the table or theorem), ``kind``, ``input``, ``output`` (how the cranks move), ``T1`` to
        ``T5`` (+, 0 or -, as they are, whatever the ``tolerance``), ``condition`` (on the lengths) and ``linkages``.

    Examples
    --------
    >>> names = ["linkage_type", "T1", "T2", "T3", "T4", "T5"]
    >>> part = fl.sweep("minkowski_4r", fl.grid(a=1.0, b=[1.0, 7.0], g=[4.0, 3.0], h=1.0), names)
    >>> print(fl.minkowski.linkage_table(part).drop(columns="paper").to_string(index=False))
       kind       input output T1 T2 T3 T4 T5     condition  linkages
    strange       crank  crank  +  +  -  +  + b > a + g + h         2
    strange superrocker  crank  +  -  +  +  + g > a + b + h         1
      rigid      rocker  crank  +  -  0  +  + g = a + b + h         1
    """
    import pandas as pd

    with as_dataset(maps) as dataset:
        for name in ("linkage_type", *SUMS):
            if name not in dataset.data_vars:
                remedy = "sweep 'linkage_type' and 'T1' to 'T5', and give the whole result"
                raise InputError(f"{name!r} is missing", ("linkage_table", "maps"), remedy)
        types = dataset["linkage_type"]
        signs = [np.sign(dataset[name].broadcast_like(types).transpose(*types.dims).values) for name in SUMS]
        codes = types.values
    linkages = minkowski_4r.facts["linkage_type"].flags
    valid = (codes >= 0) & (codes < max(linkages))
    key = codes[valid].astype(int)  # one number for a type and five signs, in base 3
    for sign in signs:
        key = 3 * key + 1 + sign[valid].astype(int)
    rows = [
        _row(int(one), int(count)) for one, count in zip(*np.unique(key, return_counts=True), strict=True)
    ]
    return pd.DataFrame(rows, columns=["paper", "kind", "input", "output", *SUMS, "condition", "linkages"])


def _row(key: int, count: int) -> list[Any]:
    """Return a row of the table from a type and the signs of the sums as one number."""
    code, rest = divmod(key, 3 ** len(SUMS))
    kind, *motions = in_words(minkowski_4r.facts["linkage_type"].flags[code]).split()
    signs = {name: rest // 3**k % 3 - 1 for name, k in zip(SUMS, (4, 3, 2, 1, 0), strict=True)}
    paper, relation = KINDS[kind]
    if relation:
        wanted = {name: sign if relation == ">" else 0 for name, (sign, _) in LONG_LINKS.items()}
        links = [text for name, (_, text) in LONG_LINKS.items() if signs[name] == wanted[name]]
        condition = (*links, REMAINING)[0].replace(">", relation)
    else:
        equal = {"T1": "b + g = a + h", "T2": "a + b = g + h"}
        condition = ", ".join(text for name, text in equal.items() if signs[name] == 0)
    return [paper, kind, *motions, *("-0+"[sign + 1] for sign in signs.values()), condition, count]
