"""Functions of the planar 4R alone: algebraic equations, coupler curves, balancing.

Designs are given as for `cognates`: inputs that a function does not need are not read. Branches are given as
numbers or arrays that are broadcast with the designs.
Lengths are 1e-24 to 1e24 m, coordinates at most 1e24 m: others are refused with `fastlink.InputError`, as their
products may leave the range of doubles. So is what is missing, is not a finite number, or does not broadcast.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr
from scipy.spatial import ConvexHull, QhullError

from fastlink import papers
from fastlink._text import short_repr
from fastlink.engine.evaluate import broadcast_inputs, evaluate, like
from fastlink.engine.sweep import sweep
from fastlink.errors import InputError, KeyPath, Piece, Problems, Setting, Wording, check_switch, door, listed
from fastlink.facts.catalogue import ELIMINATED
from fastlink.facts.evaluate import read_facts, stack_rows
from fastlink.facts.fact import Input
from fastlink.facts.names import ListOfExtrema, Quantity, Reduced
from fastlink.io.reader import as_dataset, as_map
from fastlink.maps.units import check_units
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.numerics.elementary import PI
from fastlink.numerics.vectors import cross
from fastlink.plan.request import branch_codes, check_model, constants_of, selected_variants
from fastlink.space.design_space import MOST_DIMS, DesignSpace, Links, constant, ends_of, in_unit, numbers_of
from fastlink.space.tables import as_space
from fastlink.space.units import RADIANS

__all__ = [
    "Cognate",
    "bar_properties",
    "cognates",
    "crunode_count",
    "crunodes",
    "curve_area",
    "curve_length",
    "curve_straightness",
    "cusp_count",
    "cusps",
    "flywheel_inertia",
    "force_balance",
    "force_equations",
    "force_hypothesis",
    "inflections",
    "io_coefficients",
    "rate_extrema",
    "sextic",
    "straightness",
]


def __dir__() -> list[str]:
    return __all__


# -- Coefficients of the six algebraic input-output equations of the planar 4R


#: Products of which factors multiply v_i^2 v_j^2, v_i^2, v_j^2 and 1; and what v_i v_j: a number times two lengths.
IO_PRODUCTS = {
    "12": ("A1 B2", "A2 B1", "C1 D2", "C2 D1", (-8.0, 2, 4)),
    "13": ("A1 B1", "A2 B2", "C2 D2", "C1 D1", (0.0, 1, 1)),
    "14": ("A1 A2", "B1 B2", "C1 C2", "D1 D2", (-8.0, 1, 3)),
    "23": ("A1 D2", "B2 C1", "B1 C2", "A2 D1", (-8.0, 1, 3)),
    "24": ("A1 C1", "B2 D2", "A2 C2", "B1 D1", (0.0, 1, 1)),
    "34": ("A1 C2", "B1 D2", "A2 C1", "B2 D1", (8.0, 2, 4)),
}


@door(hint=papers.BY_NAME)
def io_coefficients(design: Any = None, *, pair: str = "14", **inputs: Any) -> Any:
    """Return the coefficients of an input-output equation, eqs. (1) to (6) of Hayes.

    With v_i = tan(joint_angle_i/2) for the joint angles of the closed polygon a1, a2, a3, a4 (quantities ``v1``
    ... ``v4``), the equation of joints i and j is::

        c[0] v_i^2 v_j^2 + c[1] v_i^2 + c[2] v_j^2 + c[3] v_i v_j + c[4] = 0

    In terms of the ground-frame angles, joint_angle_1 = theta1 - pi and joint_angle_4 = -theta4. Each
    coefficient is the product of two factors that are summed without loss, and right to three roundings, near change
    points too; a factor is zero only where the lengths as given are at a change point exactly.

    Parameters
    ----------
    pair : {"12", "13", "14", "23", "24", "34"}
        The two joints: eqs. (2), (3), (1), (4), (5), (6).

    Returns
    -------
    ndarray
        The five coefficients in m2, shape (..., 5).

    Examples
    --------
    >>> fl.planar.io_coefficients(a1=4.0, a2=12.0, a3=8.0, a4=10.0, pair="14")
    array([-140.,   52., -108., -256.,  340.])
    """
    if not isinstance(pair, str) or pair not in IO_PRODUCTS:
        where, remedy = ("io_coefficients", "pair"), listed(list(IO_PRODUCTS))
        raise InputError(f"{short_repr(pair)} is unknown", where, remedy)
    needed = ("a1", "a2", "a3", "a4")
    lengths = [*papers.read_design("io_coefficients", planar_4r, design, inputs, needed).values()]
    *products, (number, i, j) = IO_PRODUCTS[pair]
    *squares, last = (_factor_product(names, lengths) for names in products)
    cross = number * (lengths[i - 1] * lengths[j - 1])
    return np.stack(np.broadcast_arrays(*squares, cross, last), axis=-1)


def _factor_product(names: str, lengths: Iterable[Any]) -> Any:
    """Return the product of two factors of the equations, such as A1 and B2, of the four lengths."""
    given = {f"s{i}": length for i, length in enumerate(lengths, 1)}
    one, other = (f"factor_{name}" for name in names.split())
    return planar_4r.facts[one].values(given)[one] * planar_4r.facts[other].values(given)[other]


# -- Roberts' cognates: the three planar 4R that trace one coupler curve


@dataclass(frozen=True)
class Cognate:
    """One of the three linkages that trace the same coupler curve; see `cognates`.

    Attributes
    ----------
    design : dict of str to ndarray
        Lengths a1 ... a4 and coupler point P_u, P_v [m], as inputs of planar_4r in the linkage's own ground frame.
    O_x, O_y, D_x, D_y : ndarray
        Ground pivots of its input and output link [m] in the ground frame of the original.
    number : int
        1 for the original, 2 and 3 for its cognates.
    """

    design: dict[str, Any]
    O_x: Any
    O_y: Any
    D_x: Any
    D_y: Any
    number: int

    def configuration(self, theta1: Any, theta2: Any, theta4: Any) -> tuple[Any, Any]:
        """Return the input angle [rad] and branch at a configuration of the original.

        Parameters
        ----------
        theta1, theta2, theta4 : float or array_like
            Directions of crank, coupler and output link of the original [rad].

        Returns
        -------
        theta1, branch : ndarray
            In the linkage's own frame. The coupler's direction drives both cognates; their branch changes where
            crank and output link of the original are parallel, which is a toggle of theirs. The branch is NaN where
            a direction is, such as where the original does not assemble.
        """
        names = ("theta1", "theta2", "theta4")
        directions = (papers.number(name, "direction of a link", "rad") for name in names)
        t1, t2, t4 = papers.broadcast("configuration", directions, theta1, theta2, theta4, gaps=True)
        own = t1 if self.number == 1 else t2
        one, other = {1: (t2, t4), 2: (t1, t4), 3: (t4, t1)}[self.number]
        with np.errstate(over="ignore"):  # of directions beyond 1e308
            turn = other - one
        known = np.isfinite(turn) & ~np.isnan(own)
        return own, np.where(known, np.where(np.sin(np.where(known, turn, 0.0)) > 0.0, 2.0, 1.0), np.nan)

    def to_ground(self, x: Any, y: Any) -> tuple[Any, Any]:
        """Return a point (x, y) [m] of the linkage's own ground frame in that of the original."""
        declared = (papers.number(name, "coordinate", "m") for name in "xy")
        x, y = papers.broadcast("to_ground", declared, x, y, gaps=True)
        ground = self.design["a4"]
        cosine, sine = (self.D_x - self.O_x) / ground, (self.D_y - self.O_y) / ground
        return self.O_x + (cosine * x - sine * y), self.O_y + (sine * x + cosine * y)


@door(hint=papers.BY_NAME)
def cognates(design: Any = None, **inputs: Any) -> tuple[Cognate, Cognate, Cognate]:
    """Return the three linkages that trace one coupler curve (Roberts, Chebyshev).

    Parameters
    ----------
    design, **inputs : mapping, pandas.DataFrame or xarray.Dataset, or values by name
        Inputs of ``planar_4r`` by name: lengths ``a1`` ... ``a4`` and coupler point ``P_u``, ``P_v`` [m], broadcast.
        Other inputs are not read.

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
    >>> design = {"a1": 0.5, "a2": 1.0, "a3": 0.75, "a4": 2.0, "P_u": 0.0, "P_v": 2.0}
    >>> first, second, third = fl.planar.cognates(design)
    >>> [float(second.design[name]) for name in ("a1", "a2", "a3", "a4")]
    [2.0, 1.0, 1.5, 4.0]
    >>> float(second.D_x), float(second.D_y)
    (0.0, 4.0)
    """
    a1, a2, a3, a4, u, v = papers.read_design("cognates", planar_4r, design, inputs, papers.CURVE).values()
    zero = np.zeros_like(a4)
    along, across = u / a2, v / a2
    E_x, E_y = along * a4, across * a4
    rest = (a2 - u) / a2
    with np.errstate(invalid="ignore"):  # zero over zero: a cognate of lengths zero
        size = np.hypot(u, v) / a2
        second = (size * a2, size * a1, size * a3, size * a4, a1 * (along / size), -a1 * (across / size))
        size = np.hypot(a2 - u, v) / a2
        third = (size * a2, size * a3, size * a1, size * a4, a3 * (rest / size), a3 * (across / size))
    pivots = ((zero, zero, a4, zero), (zero, zero, E_x, E_y), (a4, zero, E_x, E_y))
    numbers = ((a1, a2, a3, a4, u, v), second, third)
    one, two, three = (
        Cognate(dict(zip(papers.CURVE, own, strict=True)), *pivot, number)
        for number, (own, pivot) in enumerate(zip(numbers, pivots, strict=True), 1)
    )
    return one, two, three


# -- Coupler curves of the planar 4R: equation and straightness

# The coupler point and its derivatives are facts of the mechanism, and so is the bounding box of the curve:
# ``P_x_min``, ``P_x_max``, ``P_y_min`` and ``P_y_max`` of a sweep.


@door(hint=papers.BY_NAME)
def sextic(design: Any = None, **inputs: Any) -> Any:
    r"""Return the tricircular sextic that every coupler point of a linkage satisfies.

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
    >>> c = fl.planar.sextic(a1=3.0, a2=4.0, a3=5.0, a4=6.0, P_u=0.0, P_v=0.0)  # P = A, on the circle of radius 3
    >>> float(np.polynomial.polynomial.polyval2d(0.0, 3.0, c))
    0.0
    """
    numbers = [*papers.read_design("sextic", planar_4r, design, inputs, papers.CURVE).values()]
    return papers.coupler_sextic(-1, numbers[:4], numbers[4:])


def curve_inputs(function: str, design: Any, inputs: Mapping[str, Any], branch: Any) -> dict[str, Any]:
    """Return what determines a coupler curve, with its branch, as arrays of one shape."""
    read = papers.read_design(function, planar_4r, design, inputs, papers.CURVE)
    _, arrays, shape = broadcast_inputs(function, read | {"branch": branch_codes(planar_4r, branch)})
    return {name: np.broadcast_to(values, shape) for name, values in arrays.items()}


def _half_width(points: Any) -> float:
    """Return half the width of the narrowest strip that holds all points (n, 2)."""
    if points.size == 0:
        return float("nan")
    power = np.frexp(np.abs(points).max())[1] + 1  # so that no difference leaves the range of doubles
    points = np.ldexp(points, -power)
    points = points - points[0]
    distance = np.hypot(*points.T)
    size = distance.max()
    if size == 0.0:
        return 0.0
    points = points / size
    try:
        corners = points[ConvexHull(points).vertices]
    except QhullError:  # all in one line, up to roundings
        width = np.ptp(cross(*points[np.argmax(distance)], *points.T))
    else:
        # The nearest lines run along an edge of the convex hull and through the corner where its edges turn back.
        edges = np.roll(corners, -1, axis=0) - corners
        angle = np.unwrap(np.arctan2(edges[:, 1], edges[:, 0]))
        opposite = np.searchsorted(np.concatenate([angle, angle + 2.0 * np.pi]), angle + np.pi) % len(angle)
        width = np.min(np.abs(cross(*edges.T, *(corners[opposite] - corners).T)) / np.hypot(*edges.T))
    return float(np.ldexp(0.5 * size * width, power))


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
    >>> float(fl.planar.straightness([0.0, 2.0, 4.0, 6.0], [1.0, -1.0, -1.0, 1.0]))
    1.0
    """
    points = np.stack(papers.broadcast_points("straightness", x, y), axis=-1)
    curves = points.reshape(math.prod(points.shape[:-2]), *points.shape[-2:])
    half_widths = [_half_width(curve[np.isfinite(curve).all(axis=-1)]) for curve in curves]
    return np.array(half_widths).reshape(points.shape[:-2])[()]


@door(hint=papers.BY_NAME)
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
    theta1 : (float, float), optional
        Least and greatest input angle [rad] of the part; the whole curve of the branch unless given.
    samples : int
        Input angles.

    Returns
    -------
    ndarray
        The greatest distance from the best line. Angles at which the linkage does not assemble are skipped.

    Examples
    --------
    Chebyshev's straight line of the lambda linkage, 1 : 2.5 : 2.5 : 2 with P at 2 a2:

    >>> design = dict(a1=1.0, a2=2.5, a3=2.5, a4=2.0, P_u=5.0, P_v=0.0)
    >>> part = fl.planar.curve_straightness(design, theta1=(2.1, 4.2), branch=2)
    >>> whole = fl.planar.curve_straightness(design, branch=2)
    >>> round(float(part), 4), round(float(whole), 4)
    (0.0049, 0.4495)
    """
    curve = curve_inputs("curve_straightness", design, inputs, branch)
    # half a step off theta1 = 0, where rates may not exist
    count = papers.check_samples("curve_straightness", samples)
    angles = (np.arange(count) + 0.5) * (2.0 * np.pi / count)
    if theta1 is not None:
        ends = ends_of("curve_straightness", "theta1", theta1, RADIANS, "write (least, greatest) in rad")
        angles = np.linspace(ends[0], ends[1], count)
    columns = {name: values[..., None] for name, values in curve.items()}
    path = evaluate("planar_4r", ["P_x", "P_y"], theta1=angles, allow_invalid=True, **columns)
    return straightness(path["P_x"], path["P_y"])


# -- The path of a coupler point as pieces between the ends of the input's range, free of poles at toggles

# With q = sin^2(theta1/2) the distance AD has the square f^2 = (a4 - a1)^2 + 4 a1 a4 q. The triangle ABD is
# flat at q- and at q+,
#
#     4 a1 a4 (q - q-) = f^2 - (a2 - a3)^2,    4 a1 a4 (q+ - q) = (a2 + a3)^2 - f^2,
#
# and the linkage assembles from max(q-, 0) to min(q+, 1). Near a toggle the point moves as the root of the
# distance d of the angle from there: its path is smooth in v = sqrt(d). All factors are written with d, so
# that the digits of theta1 set no limit: the facts of the mechanism take theta1 itself, which has none left
# of d there.


#: Roundings of each term of a velocity, counted: S by its factors 12, AD 4, the turn of conj(BD) 6, twice that in f^2.
ROUNDINGS = 24.0


@dataclass(frozen=True, eq=False)
class Paths:
    """Paths of designs, each in up to four pieces: theta1 below or above 0, from its least or greatest size."""

    lengths: Any  # a1 to a4 of each design, and its coupler point u + iv, divided by a power of two
    p: Any
    side: Any  # 1 in branch 2, -1 in branch 1
    exponent: Any  # of that power
    toggles: Any  # whether the least size of theta1 is a toggle; and the greatest
    outside: Any  # -q- and q+ - 1: how far the flat triangles are outside of the turn
    low: Any  # the least size of theta1; as it is, and as its distance from pi
    high: Any  # the greatest
    extent: Any  # their difference; NaN where the linkage does not assemble

    def pieces(self) -> tuple[Any, Any, Any, Any, Any]:
        """Return design, sign of theta1 and end (0: least, 1: greatest) of each piece, its width and layer in v."""
        own = np.flatnonzero(self.extent > 0.0)
        owner, sign, end = (
            part.ravel() for part in np.meshgrid(own, np.array([-1.0, 1.0]), np.array([0, 1]), indexing="ij")
        )
        toggle = self.toggles[end, owner]
        half = 0.5 * self.extent[owner]
        near = np.where(end == 0, self.low[0, owner], self.high[1, owner])
        gap = 2.0 * np.sqrt(np.maximum(self.outside[end, owner], 0.0))
        layer = np.where(toggle, np.sqrt(near), np.where(gap > 0.0, gap, np.inf))
        return owner, sign, end, np.where(toggle, np.sqrt(half), half), layer

    def samples(self, count: int) -> tuple[Any, Any]:
        """Return input angles of each design, about so many, closer together near toggles; and which follow on.

        They ascend from -pi or the least angle, and the first one follows a turn later as the last.
        """
        steps = max(count // 4, 1)
        v = np.concatenate([[1e-3], np.arange(1, 2 * steps, 2)]) / (2.0 * steps)
        half = 0.5 * self.extent[:, None]
        d = [half * np.where(toggle[:, None], v * v, v) for toggle in self.toggles]
        upper = np.pi - (self.high[1][:, None] + d[1])
        angles = np.concatenate([self.low[0][:, None] + d[0], upper[:, ::-1]], axis=1)
        around = np.concatenate([-angles[:, ::-1], angles, 2.0 * np.pi - angles[:, -1:]], axis=1)
        follows = np.ones((angles.shape[0], around.shape[1] - 1), dtype=bool)
        follows[:, angles.shape[1] - 1], follows[:, -1] = ~self.toggles
        return around, follows

    def motion(self, owner: Any, sign: Any, end: Any, v: Any) -> tuple[Any, Any, Any]:
        """Return the point P, its derivative by v with theta1 growing, and a bound of that one's roundings."""
        a1, a2, a3, a4 = self.lengths[:, owner]
        toggle, side = self.toggles[end, owner], self.side[owner]
        d = np.where(toggle, v * v, v)
        rest = self.extent[owner] - d
        first = end == 0
        angle = self.low[0, owner] + np.where(first, d, rest)
        complement = self.high[1, owner] + np.where(first, rest, d)
        q, sine = np.sin(0.5 * angle) ** 2, np.sin(np.minimum(angle, complement))
        below = self._gap(0, owner, np.where(first, d, rest), angle, complement)
        above = self._gap(1, owner, np.where(first, rest, d), angle, complement)
        crank = np.where(angle < complement, np.cos(angle), -np.cos(complement)) + 1j * sign * sine
        S = 4.0 * a1 * a4 * np.sqrt(below) * np.sqrt(above)
        x, y = (a4 - a1) + 2.0 * a1 * q, -sign * a1 * sine  # AD
        gaps = x * x + y * y, 4.0 * a1 * a4 * below, 4.0 * a1 * a4 * above
        (at_A, size_A), (at_D, size_D) = _projection(a2, a3, *gaps), _projection(a3, a2, *gaps)
        half, step = 0.5 / gaps[0], np.where(toggle, 2.0 * v, 1.0)
        AB, BD = (
            (x + 1j * y) * (along + 1j * across) * half
            for along, across in ((at_A, side * S), (at_D, -side * S))
        )
        # theta2' = 2 a1 Im(e^(i theta1) conj(B - D)) / S
        turn = -2.0 * a1 * side * (crank * BD.conj()).imag * (step / S)
        arm, reach = AB * (self.p[owner] / a2), np.abs(self.p[owner] / a2)
        velocity = 1j * (a1 * crank * step + turn * arm)
        # Bounds of components: |x| and |y| for those of AD, size_A and size_D for the projections
        x, y = np.abs(x), np.abs(y)
        along, across = (x * size_D + y * S) * half, (x * S + y * size_D) * half
        unsure = 2.0 * a1 * (sine * along + (np.abs(crank.real) + sine) * across) * (step / S)
        noise = a1 * step + (np.abs(turn) * (x + y) * (size_A + S) * half + unsure * np.abs(AB)) * reach
        return a1 * crank + arm, velocity, ROUNDINGS * UNIT_ROUNDING * noise

    def _gap(self, end: int, owner: Any, d: Any, angle: Any, complement: Any) -> Any:
        """Return q - q- (end 0) or q+ - q (end 1) at the distance d from that end of the range."""
        there, complement_there = (self.low if end == 0 else self.high)[:, owner]
        between = np.minimum(0.5 * (angle + there), 0.5 * (complement + complement_there))
        at_toggle = np.sin(0.5 * d) * np.sin(between)
        passing = np.sin(0.5 * d) ** 2 + self.outside[end, owner]
        return np.where(self.toggles[end, owner], at_toggle, passing)


def _projection(one: Any, other: Any, square: Any, below: Any, above: Any) -> tuple[Any, Any]:
    """Return f^2 + one^2 - other^2, twice f times a link's projection on AD, and the size of its terms: the least.

    As it stands, and by f^2 = (one - other)^2 + below = (one + other)^2 - above, for a link far shorter than the other.
    """
    difference, total = one - other, one + other
    terms = (square, difference * total), (below, 2.0 * one * difference), (2.0 * one * total, -above)
    size = np.stack([np.abs(a) + np.abs(b) for a, b in terms])
    best = np.argmin(size, axis=0)
    return np.choose(best, [a + b for a, b in terms]), size.min(axis=0)


def paths_of(curve: dict[str, Any]) -> Paths:
    """Return the paths of designs: lengths, coupler points and branches (n,) by name."""
    lengths = np.stack([curve[f"a{i}"] for i in (1, 2, 3, 4)])
    exponent = np.frexp(lengths.max(axis=0))[1]
    lengths = np.ldexp(lengths, -exponent)
    a1, a2, a3, a4 = lengths
    p = np.ldexp(curve["P_u"], -exponent) + 1j * np.ldexp(curve["P_v"], -exponent)
    # -q-, 1 - q-, 1 - q+ and -q+, each by its factors: none cancels.
    least, from_least, beyond, greatest = (
        _factor_product(names, lengths) / (4.0 * a1 * a4) for names in ("A1 B1", "C2 D2", "C1 D1", "A2 B2")
    )
    greatest = -greatest
    low, high = (
        2.0 * np.arctan2([_root(sine), _root(cosine)], [_root(cosine), _root(sine)])
        for sine, cosine in ((-least, from_least), (greatest, beyond))
    )
    toggles = np.stack([least < 0.0, beyond > 0.0])
    # sin^2(high/2) - sin^2(low/2) = a2 a3/(a1 a4) between two toggles
    narrow = a2 * a3 / (a1 * a4) / np.sin(np.minimum(0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])))
    extent = np.where(toggles[0], low[1], np.where(toggles[1], high[0], np.pi))
    by_both = np.where(narrow < 0.5, 2.0 * np.arcsin(np.minimum(narrow, 0.5)), high[0] - low[0])
    extent = np.where(toggles.all(axis=0), by_both, extent)
    extent = np.where((greatest >= 0.0) & (from_least >= 0.0), extent, np.nan)
    side = np.where(curve["branch"] == 2, 1.0, -1.0)
    outside = np.stack([least, -beyond])
    return Paths(lengths, p, side, exponent, toggles, outside, low, high, extent)


def _root(x: Any) -> Any:
    return np.sqrt(np.maximum(x, 0.0))


# -- Length and area of coupler curves, to the last digits and with their errors


#: Designs that are integrated at a time: their nodes fit the cache.
BLOCK = 256


@door(hint=papers.BY_NAME)
def curve_length(design: Any = None, *, branch: Any = 1, error: bool = False, **inputs: Any) -> Any:
    """Return the length of the path of the coupler point in a branch [m].

    Returns
    -------
    length : ndarray
        One turn where the input turns fully, else all input angles at which the linkage assembles, once: the whole
        curve is that of both modes. NaN where it assembles nowhere.
    error : ndarray
        With ``error=True``: a bound of the absolute error [m].

    Notes
    -----
    The integral of the speed by adaptive Gauss rules, each design on panels of its own; between toggles by the root
    of the distance from these. The error is below 1e-12 of the length, also with cusps and next to change
    points, but where the point hardly moves for the lengths of the links, and their roundings count:
    docs/numerics.md#integrals-along-coupler-curves.

    Examples
    --------
    >>> design = dict(a1=0.5, a2=1.2, a3=0.8, a4=1.0, P_u=0.0, P_v=0.0)
    >>> length, error = fl.planar.curve_length(design, error=True)
    >>> round(float(length), 12), bool(error < 1e-12)  # P = A: 2 pi a1
    (3.14159265359, True)
    """
    return _integral("curve_length", design, inputs, branch, error, 1, _speed)


@door(hint=papers.BY_NAME)
def curve_area(design: Any = None, *, branch: Any = 1, error: bool = False, **inputs: Any) -> Any:
    """Return the area that the coupler curve encloses over one turn of the input [m2].

    Returns
    -------
    area : ndarray
        The signed area, half the integral of x dy - y dx: parts that the curve runs around to the left
        as theta1 grows count positive, to the right negative (the loops of a figure eight subtract). NaN where
        the input does not turn fully: the path of one branch is not closed then.
    error : ndarray
        With ``error=True``: a bound of the absolute error [m2].

    Notes
    -----
    Computed as in `curve_length`; the error is below 1e-12 of the area that the ray from O to P sweeps, forth and
    back added.

    Examples
    --------
    >>> design = dict(a1=0.5, a2=1.2, a3=0.8, a4=1.0, P_u=0.0, P_v=0.0)
    >>> round(float(fl.planar.curve_area(design)), 12)  # P = A: pi a1^2
    0.785398163397
    """
    return _integral("curve_area", design, inputs, branch, error, 2, _swept)


def _speed(point: Any, velocity: Any, noise: Any) -> tuple[Any, Any]:
    """Return the speed along a path and a bound of its roundings."""
    return np.hypot(velocity.real, velocity.imag), noise


def _swept(point: Any, velocity: Any, noise: Any) -> tuple[Any, Any]:
    """Return the area that the ray from O sweeps per step, and a bound of its roundings."""
    size = np.abs(point)
    return 0.5 * (point.conj() * velocity).imag, size * (noise + 16.0 * UNIT_ROUNDING * np.abs(velocity))


def _integral(
    function: str,
    design: Any,
    inputs: Mapping[str, Any],
    branch: Any,
    with_error: Any,
    power: int,
    integrand: Callable[[Any, Any, Any], Any],
) -> Any:
    """Return an integral along coupler curves, a power of a length, with its error where that is asked for."""
    with_error = check_switch((function, "error"), with_error)
    curve = curve_inputs(function, design, inputs, branch)
    columns = {name: values.reshape(-1) for name, values in curve.items()}
    results = np.empty((2, columns["a1"].size))
    with np.errstate(all="ignore"):
        for block in papers.blocks(results.shape[1], BLOCK):
            part = {name: values[block] for name, values in columns.items()}
            results[:, block] = _of_block(part, power, integrand)
    value, bound = (of.reshape(curve["a1"].shape)[()] for of in results)
    return (value, bound) if with_error else value


def _of_block(curve: dict[str, Any], power: int, integrand: Callable[[Any, Any, Any], Any]) -> Any:
    paths = paths_of(curve)
    owner, sign, end, width, layer = paths.pieces()

    def along(piece: Any, v: Any) -> Any:
        return integrand(*paths.motion(owner[piece], sign[piece], end[piece], v))

    exists = np.isfinite(paths.extent) & ((power == 1) | ~paths.toggles.any(axis=0))
    sums = np.array(papers.integrate(along, owner, width, layer, exists.size))
    return np.where(exists, np.ldexp(sums, power * paths.exponent), np.nan)


# -- Inflections of the coupler curve of a planar 4R: where its curvature changes sign


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


@door(hint=papers.BY_NAME)
def inflections(
    design: Any = None, *, branch: Any = 1, samples: int = 720, **inputs: Any
) -> tuple[Any, Any, Any, Any]:
    """Return the points where the curvature of the coupler curve changes sign.

    Parameters
    ----------
    samples : int
        About how many input angles, closer together near toggles, the sign of the curvature is read at; two changes
        within one step are missed.

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
    >>> links = dict(a1=0.4, a2=1.2, a3=0.8, a4=1.0)
    >>> theta1, X, Y, count = fl.planar.inflections(links, P_u=0.7, P_v=0.5)
    >>> int(count), fl.planar.inflections(links, P_u=0.0, P_v=0.0)[3].tolist()  # P = A: a circle
    (2, 0)
    """
    arrays = curve_inputs("inflections", design, inputs, branch)
    shape = arrays["a1"].shape
    columns = {name: value.reshape(-1) for name, value in arrays.items()}
    with np.errstate(all="ignore"):
        ends, follows = paths_of(columns).samples(papers.check_samples("inflections", samples))
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


# -- Double points of the coupler curve of a planar 4R: crunodes and cusps

# Roberts' sextic has three double points besides the circular points. With the notation of
# `fastlink.planar.sextic`, two coupler angles for one point make its two linear equations one: (A_2, B_2,
# C_2) is a multiple of (A_1, B_1, C_1). The first two say that the point z lies on the circle of singular
# foci, through O, D and the third pivot of the cognates,
#
#     z = a4/(1 + sigma g),  g = conj(p) q/(|p||q|),  sigma real,  A_2 + i B_2 = -sigma (|q|/|p|)(A_1 + i B_1),
#
# and the third is then a cubic for sigma:
#
#     a4^2 sigma (|q| + sigma |p|)
#         + (1 + 2 sigma Re g + sigma^2) [(|q|^2 - a3^2)|p| + sigma |q| (|p|^2 - a1^2)] = 0.
#
# In the triangle O A P with the sides a1, |p|, |z| the angle at P has the cosine c = (|z|^2 + |p|^2 -
# a1^2)/(2 |z||p|), at a double point that of D B P but for the sign. The two coupler angles are twice that
# angle apart: two configurations of the linkage meet at z where |c| < 1, none does where |c| > 1; where |c|
# = 1 they are one, with O, A, P and D, B, P in line: P is the pole of the coupler, on its moving centrode,
# and rests. The curve has a cusp there.


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
    a1, a2, a3, a4, u, v = papers.read_design(function, planar_4r, design, inputs, papers.CURVE).values()
    p, q = np.hypot(u, v), np.hypot(u - a2, v)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):  # P is A or B, or nearly
        cosine, sine = (u * (u - a2) + v * v) / (p * q), a2 * v / (p * q)
        first, last = (q - a3) * (q + a3) * p, (p - a1) * (p + a1) * q
        square = a4 * a4
        inner = 2.0 * cosine * first + last + square * q, first + 2.0 * cosine * last + square * p
        k = np.stack([first, *inner, last], axis=-1)
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


def _nodes(
    function: str, design: Any, inputs: Mapping[str, Any], tolerance: Any, *, cusps: bool
) -> tuple[Any, Any, Any]:
    """Return the cusps or crunodes by growing X, NaN-padded, and their number."""
    where = (function, "tolerance")
    limit = float(in_unit(where, tolerance, np.asarray(constant(*where, tolerance)), "1"))
    if not 0.0 < limit < 0.1:
        raise InputError(f"is {limit}", where, "write a number between 0 and 0.1, such as 1e-9")
    X, Y, excess = _double_points(function, design, inputs)
    chosen = np.abs(excess) <= limit if cusps else excess > limit
    X, Y = np.where(chosen, X, np.nan), np.where(chosen, Y, np.nan)
    order = np.argsort(X, axis=-1)
    X, Y = (np.take_along_axis(part, order, axis=-1) for part in (X, Y))
    return X, Y, np.sum(chosen, axis=-1)


@door(hint=papers.BY_NAME)
def crunodes(design: Any = None, *, tolerance: float = TOLERANCE, **inputs: Any) -> tuple[Any, Any, Any]:
    """Return the points where the coupler curve of a linkage crosses itself.

    Parameters
    ----------
    tolerance : float
        Double points within it count as cusps, see `cusps`.

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
    >>> X, Y, count = fl.planar.crunodes(a1=1.0, a2=2.5, a3=2.5, a4=2.0, P_u=1.25, P_v=1.0)
    >>> int(count), round(float(X[0]), 4), round(float(Y[0]), 4)
    (1, 1.7287, -0.9459)
    """
    return _nodes("crunodes", design, inputs, tolerance, cusps=False)


@door(hint=papers.BY_NAME)
def cusps(design: Any = None, *, tolerance: float = TOLERANCE, **inputs: Any) -> tuple[Any, Any, Any]:
    """Return the cusps of the coupler curve of a linkage, where P rests.

    Parameters
    ----------
    tolerance : float
        A double point of the curve is a cusp if its two coupler directions differ by an angle 2 x with 1 - cos x at
        most this. Only designs that satisfy an equation have a cusp; one within the tolerance has a cusp, or a loop
        of length about tolerance times the lengths, or a turn as sharp without a double point.

    Returns
    -------
    X, Y : ndarray, shape (..., 3)
        The cusps in the ground frame [m] by growing X, NaN-padded, of both branches.
    count : ndarray of int, shape (...)
        Their number. It is 0 if P is A or B, which move on circles.

    Examples
    --------
    At theta1 = 90 degrees OA and DB meet in (0, 8), the pole of the coupler, which is its point (0, 6):

    >>> X, Y, count = fl.planar.cusps(a1=2.0, a2=4.5, a3=2.5, a4=6.0, P_u=0.0, P_v=6.0)
    >>> int(count), round(float(X[0]), 9), round(float(Y[0]), 9)
    (1, 0.0, 8.0)
    """
    return _nodes("cusps", design, inputs, tolerance, cusps=True)


@door(hint=papers.BY_NAME)
def crunode_count(design: Any = None, **inputs: Any) -> Any:
    """Return the number of crunodes of the coupler curve of a linkage, 0 to 3: the last of what `crunodes` returns.

    Examples
    --------
    >>> fl.planar.crunode_count(a1=1.0, a2=2.5, a3=2.5, a4=2.0, P_u=1.25, P_v=[1.0, 9.0])
    array([1, 0])
    """
    return _nodes("crunode_count", design, inputs, TOLERANCE, cusps=False)[2]


@door(hint=papers.BY_NAME)
def cusp_count(design: Any = None, **inputs: Any) -> Any:
    """Return the number of cusps of the coupler curve of a linkage, 0 to 3: the last of what `cusps` returns.

    Examples
    --------
    >>> fl.planar.cusp_count(a1=2.0, a2=4.5, a3=2.5, a4=6.0, P_u=0.0, P_v=[6.0, 7.0])
    array([1, 0])
    """
    return _nodes("cusp_count", design, inputs, TOLERANCE, cusps=True)[2]


# -- Balance the shaking force of the four-bar by counterweights (Berkof and Lowen)

# With complex numbers in the links' frames, g_i the mass centres and e_i the links' directions, the moment
# of mass
#
#     m1 g1 e1 + m2 (a1 e1 + g2 e2) + m3 (a4 + g3 e3),    a2 e2 = a4 + a3 e3 - a1 e1
#
# is constant, and its second derivative, the shaking force, zero, if the coefficients of e1 and e3 vanish.


NEEDED = ("a1", "a2", "a3", "m1", "G1_u", "G1_v", "m2", "G2_u", "G2_v", "m3", "G3_u", "G3_v")


@door(hint=papers.BY_NAME)
def force_balance(
    design: Any = None,
    *,
    links: Links | None = None,
    radius1: Any = None,
    mass1: Any = None,
    radius3: Any = None,
    mass3: Any = None,
    **inputs: Any,
) -> dict[str, Any]:
    """Return the counterweights that make the shaking force of a planar 4R zero.

    The crank's product of mass and radius is |m1 g1 + m2 a1 (1 - g2/a2)|, the output link's |m3 g3 + m2 a3 g2/a2|
    (Berkof and Lowen, 1969). Either the radius or the mass of each is free.

    Parameters
    ----------
    links : Links, optional
        The source of masses and mass centres that the design does not give.
    radius1, mass1 : float or array_like, optional
        Radius in m or mass in kg of the counterweight on the crank, one of them; a1 is the radius unless given.
    radius3, mass3 : float or array_like, optional
        The same of the counterweight on the output link; a3 is the radius unless given.

    Returns
    -------
    dict
        The inputs ``counterweight1_mass``, ``counterweight1_radius``, ``counterweight1_direction`` and the same of
        ``counterweight3``: add them to the design.

    Examples
    --------
    >>> design = dict(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=25.0)
    >>> bars = fl.round_bar(density=7750.0, radius=0.01)
    >>> weights = fl.planar.force_balance(design, links=bars, radius1=0.1, radius3=0.2)
    >>> round(float(weights["counterweight1_mass"]), 3)
    7.791
    >>> found = fl.evaluate("planar_4r", ["shaking_force"], **design, **weights, links=bars, theta1=1.0)
    >>> bool(found["shaking_force"] < 1e-10)
    True
    """
    check_model(planar_4r, links, ELIMINATED)
    variants = selected_variants(planar_4r, links, ELIMINATED, ())
    needed = [name for name in NEEDED if planar_4r.resolve(name, variants) is None]
    further = [*_chosen(1, radius1, mass1), *_chosen(3, radius3, mass3)]
    optional = [*set(NEEDED).difference(needed), *planar_4r.variant_inputs["round_bar"]]
    given = papers.read_design(
        "force_balance", planar_4r, design, inputs, needed, optional=optional, further=further
    )
    with np.errstate(over="ignore", invalid="ignore"):  # of masses beyond 1e200, which are refused
        facts = read_facts(planar_4r, NEEDED, constants_of(planar_4r, links, variants) | given, variants)
        g1, g2, g3 = (np.asarray(facts[f"G{i}_u"]) + 1j * np.asarray(facts[f"G{i}_v"]) for i in (1, 2, 3))
        share = g2 / facts["a2"]
        crank = -(facts["m1"] * g1 + facts["m2"] * facts["a1"] * (1.0 - share))
        output = -(facts["m3"] * g3 + facts["m2"] * facts["a3"] * share)
        weights = _counterweight(1, crank, given, facts["a1"]) | _counterweight(3, output, given, facts["a3"])
    problems = Problems()
    for name, values in weights.items():
        if not np.all(np.isfinite(values)):
            problems.add(
                f"{name} is not finite", ("force_balance",), "write masses and a radius of usual sizes"
            )
    problems.stop()
    return weights


def _chosen(link: int, radius: Any, mass: Any) -> list[tuple[Input, Any]]:
    """Return what is chosen of a counterweight: its radius, its mass or neither."""
    if radius is not None and mass is not None:
        what, where = f"mass{link} is given too", ("force_balance", f"radius{link}")
        raise InputError(what, where, "write one of them, the other follows")
    name, units, value = ("mass", "kg", mass) if mass is not None else ("radius", "m", radius)
    meaning = f"{name} of the counterweight of link {link}"
    return [] if value is None else [(papers.number(f"{name}{link}", meaning, units, "positive"), value)]


def _counterweight(link: int, product: Any, given: Mapping[str, Any], length: Any) -> dict[str, Any]:
    """Return the inputs of a counterweight of a given complex mass times radius."""
    mass = given.get(f"mass{link}")
    chosen = given.get(f"radius{link}", length) if mass is None else mass
    names = ("radius", "mass") if mass is None else ("mass", "radius")
    arrays = np.broadcast_arrays(chosen, np.abs(product) / chosen, np.angle(product))
    values = dict(zip((*names, "direction"), arrays, strict=True))
    return {f"counterweight{link}_{key}": values[key][()] for key in ("mass", "radius", "direction")}


# -- The flywheel that keeps the speed of a crank within bounds


@door
def flywheel_inertia(maps: Any, C_s: Any) -> Any:
    """Return the moment of inertia for a given coefficient of speed fluctuation.

    The greatest swing of the energy, ``T41_fluctuation``, is to change the speed by C_s omega1 in all:
    I = T41_fluctuation/(C_s omega1^2), on the crank; omega of a slider-crank stands for omega1. The linkage's own
    inertia, which varies, is counted on neither side; the torque is that at constant speed.

    Parameters
    ----------
    maps : xarray.Dataset or path
        A sweep with ``T41_fluctuation`` and the speed of the crank, ``omega1`` or ``omega``, or its file; or any
        mapping with both names.
    C_s : float or array_like
        Coefficient of fluctuation: greatest less least speed over the mean speed, positive.

    Returns
    -------
    array or xarray.DataArray
        In kg m2, like ``T41_fluctuation``; NaN for an input that does not turn fully.

    Examples
    --------
    >>> maps = fl.sweep(
    ...     "planar_4r",
    ...     fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=25.0),
    ...     ["T41_fluctuation"],
    ...     links=fl.round_bar(density=7750.0, radius=0.01),
    ...     branch=1,
    ... )
    >>> round(float(fl.planar.flywheel_inertia(maps, C_s=0.02)), 2)
    26.34
    """
    bound = papers.number("C_s", "coefficient of speed fluctuation", rule="positive")
    checked, _ = papers.read_numbers("flywheel_inertia", {"C_s": bound}, {"C_s": C_s}, Problems())
    if isinstance(maps, Mapping) and not hasattr(maps, "data_vars"):
        return _inertia(maps, checked["C_s"])
    with as_dataset(maps) as dataset:
        inertia = _inertia(dataset, checked["C_s"])
        inertia.attrs = {"units": "kg m2", "long_name": "Moment of inertia of the flywheel", "symbol": "I_S"}
        return inertia.rename("flywheel_inertia").load()


def _inertia(maps: Mapping[Any, Any], C_s: Any) -> Any:
    """Return the moment of inertia from the swing of the energy and the speed of the crank."""
    where = ("flywheel_inertia", "maps")
    crank_speed = "omega" if "omega" in maps else "omega1"
    units_of = {"T41_fluctuation": "N m", crank_speed: "rad s-1"}
    for name, units in units_of.items():
        if name not in maps:
            raise InputError(f"{name!r} is missing", where, f"sweep {name!r} and give the whole result")
        check_units(maps[name], units, (*where, name))
    swing, speed = (
        like(maps[name], numbers_of(*where[:1], name, maps[name], MOST_DIMS)) for name in units_of
    )
    try:
        # a square of the speed may leave the range of doubles where the inertia does not
        with np.errstate(all="ignore"):
            return swing / speed / speed / C_s
    except ValueError as error:  # arrays of other shapes, or DataArrays of other coordinates
        remedy = "write one number, or one for each value of the maps"
        what = f"does not go with the maps ({error})"
        raise InputError(what, ("flywheel_inertia", "C_s"), remedy) from None


# -- Extremes of the rates of any pair of joints, by the names of the paper's input-output equations


#: Input and output: the equation of a pair holds in both directions.
PAIRS = tuple(sorted([*IO_PRODUCTS, *(pair[::-1] for pair in IO_PRODUCTS)]))


@door
def rate_extrema(space: Any, *, pair: str = "14", **options: Any) -> Any:
    """Return all extremes of rate and acceleration of one joint over a turn of another.

    These are the algorithms of section 3 of Hayes for each of the six equations, with either joint as the input: joint
    angles of the closed polygon a1, a2, a3, a4, see docs/conventions.md. In the ground frame, `omega4_extrema` and
    `alpha4_extrema` of a sweep by theta1 are those of Table 2.

    Parameters
    ----------
    space : DesignSpace, mapping, DataFrame or others
        The designs, as in `fastlink.sweep`: the lengths ``a1`` ... ``a4`` and the constant rate of the first joint of
        the pair, such as ``joint_omega_1``, which may be called ``omega1``, too.
    pair : {"12", "13", "14", "21", "23", "24", "31", "32", "34", "41", "42", "43"}
        Input and output joint: eqs. (1) to (6) are those of 14, 12, 13, 23, 24 and 34.
    **options
        Options of `fastlink.sweep`, such as ``branch`` or ``to``.

    Returns
    -------
    xarray.Dataset
        The map of that sweep: of pair "14" ``joint_omega_4_extrema``, ``joint_alpha_4_extrema``, the places
        ``joint_angle_1_at_joint_omega_4_extrema`` and so on, their numbers and kinds, along `extremum`.

    Examples
    --------
    The example of the paper in branch 2, rates of joint 3 at B over a turn of joint 1 at O:

    >>> design = dict(a1=0.4, a2=1.2, a3=0.8, a4=1.0, joint_omega_1=25.0)
    >>> found = fl.planar.rate_extrema(design, pair="13", branch=2)
    >>> found.joint_omega_3_extrema.squeeze().dropna("extremum").values.round(3).tolist()
    [-12.506, 12.506]
    """
    if not isinstance(pair, str) or pair not in PAIRS:
        raise InputError(f"{short_repr(pair)} is unknown", ("rate_extrema", "pair"), listed(PAIRS))
    i, j = pair[0], pair[1]
    names = [str(ListOfExtrema(Quantity(f"{rate}_{j}"))) for rate in ("joint_omega", "joint_alpha")]
    if i == "1":
        with contextlib.suppress(InputError):  # what is no design space the sweep refuses
            designs = as_space(space, allow_invalid=bool(options.get("allow_invalid", False)))
            space = _renamed(designs, {"omega1": "joint_omega_1"})
    return sweep("planar_4r", space, names, input=f"joint_angle_{i}", **options)


def _renamed(space: DesignSpace, names: dict[str, str]) -> DesignSpace:
    """Return a design space with other names of inputs."""
    by_name = ("constants", "axes", "columns", "units", "doubtful", "comments")
    renamed: dict[str, Any] = {
        part: {names.get(name, name): of for name, of in getattr(space, part).items()} for part in by_name
    }
    return replace(space, dims=tuple(names.get(name, name) for name in space.dims), **renamed)


# -- The 9x9 system of the joint forces as it is printed, and the bars of which its masses are


#: The system, with the names on which its rows depend.
SYSTEM: Any = planar_4r.variants["dense"]["T41"]
#: The right-hand side, vector b.
RIGHT_SIDE = tuple(
    f"inertia_{kind}{i}{of}"
    for i in (1, 2, 3)
    for kind, of in (("force", "_x"), ("force", "_y"), ("moment", ""))
)
LINKS, ROUND_BAR = (1, 2, 3), "round_bar"
BARS = [name.format(i) for i in LINKS for name in ("m{}", "I{}", "G{}_u", "G{}_v")]


class _Wording(Wording):
    """The wording of what `evaluate` refuses, for callers of `force_equations`, who have no such option."""

    def path(self, where: KeyPath) -> str:
        """Return a path that begins with the function that was called."""
        return super().path(("force_equations", *where[1:]) if where[:1] == ("evaluate",) else where)

    def piece(self, piece: Piece) -> str | None:
        """Return a piece of a remedy, or None where it names an option of `evaluate` alone."""
        return None if isinstance(piece, Setting) else super().piece(piece)


@door(hint=papers.BY_NAME)
def force_equations(
    design: Any = None, *, branch: Any = 1, links: Links | None = None, **inputs: Any
) -> xr.Dataset:
    """Return matrix A and vector b of eq. (9) of Hayes: the joint forces are A^-1 b.

    Designs give lengths, speed, masses, loads and ``theta1``, as in `fastlink.evaluate`.

    Parameters
    ----------
    links : Links, optional
        The source of mass data that the design does not give.

    Returns
    -------
    xarray.Dataset
        ``A``, along the dimensions of the inputs, `equation` and `unknown`, and ``b``, along those and `equation`.
        An unknown is called as the quantity that it is, an equation as the quantity on its right-hand side: the forces
        and the moment about its mass centre of link 1, 2 and 3. With loads, b is less the loads. NaN where the loop
        does not close.

    Examples
    --------
    >>> design = dict(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=25.0, theta1=1.0, links=fl.round_bar(7750.0, 0.01))
    >>> equations = fl.planar.force_equations(**design)
    >>> forces = np.linalg.solve(equations.A, equations.b)
    >>> T41 = fl.evaluate("planar_4r", ["T41"], **design)["T41"]
    >>> bool(np.isclose(forces[-1], T41)), str(equations.unknown.values[-1])
    (True, 'T41')
    """
    problems = Problems()
    known = (*planar_4r.known_inputs(planar_4r.variant_inputs), planar_4r.position.name)
    given = papers.all_entries("force_equations", design, inputs, known, problems)
    problems.stop()
    try:
        found = evaluate(planar_4r.name, SYSTEM.depends_on, branch=branch, links=links, **given)
    except InputError as error:
        raise InputError.of(error.problems, _Wording()) from None
    first = next(iter(found.values()))
    template = first if isinstance(first, xr.DataArray) else xr.DataArray(np.asarray(first))
    system = stack_rows(SYSTEM.formula(*(np.asarray(found[name]) for name in SYSTEM.depends_on)))
    dims = (*template.dims, "equation")
    source = planar_4r.facts["r11_x"].source
    of_matrix = {"references": source, "long_name": "Matrix of the joint forces"}
    of_vector = {"references": source, "long_name": "Inertia forces and moments"}
    matrix = (*dims, "unknown"), system[..., :-1], of_matrix
    coords = {**template.coords, "equation": list(RIGHT_SIDE), "unknown": list(SYSTEM.unknowns)}
    return xr.Dataset({"A": matrix, "b": (dims, system[..., -1], of_vector)}, coords)


@door(hint=papers.BY_NAME)
def bar_properties(design: Any = None, *, links: Links, **inputs: Any) -> dict[str, Any]:
    """Return volumes, masses, moments of inertia and mass centres of links that are round bars of lengths a1, a2, a3.

    Parameters
    ----------
    links : Links
        The bars, `fastlink.round_bar`.

    Returns
    -------
    dict
        ``volume1`` [m3], and the inputs ``m1`` [kg], ``I1`` [kg m2], ``G1_u`` and ``G1_v`` [m] of the crank; the same
        of coupler (2) and output link (3). These inputs may stand in a design in place of `links`.

    Examples
    --------
    Table 1 of Hayes, where the volumes are pi/25000, 3 pi/25000 and pi/12500:

    >>> bars = fl.planar.bar_properties(a1=0.4, a2=1.2, a3=0.8, links=fl.round_bar(7750.0, 0.01))
    >>> round(float(bars["volume1"]), 9), round(float(bars["m1"]), 6)
    (0.000125664, 0.973894)
    """
    check_model(planar_4r, links, ELIMINATED)
    needed = [f"a{i}" for i in LINKS]
    if not isinstance(links, Links):
        remedy = "write fl.round_bar(density=..., radius=...)"
        raise InputError("is missing", ("bar_properties", "links"), remedy)
    needed += [name for name in planar_4r.variant_inputs[ROUND_BAR] if name not in links.values]
    given = papers.read_design("bar_properties", planar_4r, design, inputs, needed)
    values = constants_of(planar_4r, links, (ROUND_BAR,)) | given
    with np.errstate(all="ignore"):  # of bars beyond the range of doubles
        facts = read_facts(planar_4r, BARS, values, (ROUND_BAR,))
        volumes = {f"volume{i}": PI * (values["radius"] * values["radius"]) * values[f"a{i}"] for i in LINKS}
    return {name: np.asarray(of)[()] for name, of in (volumes | {name: facts[name] for name in BARS}).items()}


# -- Do forces have their extremes where rates have theirs? The hypothesis of Hayes, Hninn and Irani,
#    measured


WHERE = ("force_hypothesis", "maps")
THETA1 = planar_4r.position.name
ENDS = ("max", "min")
#: What designs are swept with.
LOADS, RATES = ("shaking_force", "shaking_moment", "F41", "F43"), ("omega4", "alpha4")
#: Configurations that are evaluated at once, each of which takes some hundred doubles.
BLOCK_OF_FORCES = 50_000


@door
def force_hypothesis(maps: Any, **options: Any) -> xr.Dataset:
    """Compare the greatest forces of a planar 4R with those where its rates are extreme.

    Hayes, Hninn and Irani propose that shaking force and moment are greatest in the configurations where the
    angular velocity and acceleration of the output are extreme, and that ground forces can be estimated there.

    Parameters
    ----------
    maps : xarray.Dataset or path
        A sweep of ``"planar_4r"``, or its file, with ``theta1_at_NAME_max`` and ``theta1_at_NAME_min`` of one or more
        rates (such as ``omega4``, ``alpha4``), and the same with ``NAME_max`` and ``NAME_min`` of one or more forces
        or moments (such as ``shaking_force``, ``shaking_moment``, ``F41``). Designs instead, as a design space or a
        mapping, are swept first, with all of these.
    **options
        Of designs, the options of `fastlink.sweep`, such as ``links``.

    Returns
    -------
    xarray.Dataset
        For each design and branch, each `load` and each `extreme` of a rate (such as ``"omega4_max"``):
        ``distance``, the angle of the input between the greatest magnitude of the load and the extreme, 0 to pi [rad];
        ``ratio``, the magnitude of the load at the extreme over the greatest: how good an estimate it is. NaN where the
        design does not assemble, and where a load grows without bound at a toggle.

    Examples
    --------
    The example of the paper: its shaking force is greatest 2.2 degrees from the greatest angular acceleration, but 27
    degrees from the greatest angular velocity.

    >>> paper, bars = dict(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=25.0), fl.round_bar(density=7750.0, radius=0.01)
    >>> found = fl.planar.force_hypothesis(paper, links=bars, branch=2).sel(load="shaking_force").squeeze()
    >>> np.degrees(found.distance).round(1).to_series().to_dict()
    {'omega4_max': 89.2, 'omega4_min': 27.4, 'alpha4_max': 2.2, 'alpha4_min': 54.3}
    >>> float(found.ratio.sel(extreme="alpha4_max").round(3))
    0.995
    """
    if isinstance(maps, (DesignSpace, Mapping)) and not isinstance(maps, xr.Dataset):
        of_all = [each for name in (*LOADS, *RATES) for each in _named(name)]
        maps, options = sweep(planar_4r.name, maps, of_all, **options), {}
    if options:
        remedy = "leave it out, or give designs instead of a map"
        raise InputError(
            "is an option of the sweep that made the map", ("force_hypothesis", next(iter(options))), remedy
        )
    with as_map(maps) as dataset:
        loads, extremes = _loads_and_extremes(dataset)
        known = planar_4r.known_inputs(planar_4r.variant_inputs)
        inputs = {str(name): dataset[name] for name in dataset.variables if name in known}
        inputs["branch"] = dataset["branch"]
        read = {name: dataset[name] for load in loads for name in _named(load)}
        read |= {place: dataset[place] for place in (_place(*extreme) for extreme in extremes)}
        arrays = dict(zip([*read, *inputs], xr.broadcast(*read.values(), *inputs.values()), strict=True))
        template = arrays[_place(*extremes[0])]
        # the others are not evaluated
        bounded = np.all([np.isfinite(arrays[name].values) for name in read], axis=0)
        design = {name: array.values[bounded] for name, array in arrays.items()}
    found = np.full((2, *template.shape, len(loads), len(extremes)), np.nan)
    greatest = [_greatest(load, design) for load in loads]
    for k, extreme in enumerate(extremes):
        place = design[_place(*extreme)]
        there = _magnitudes(loads, {name: design[name] for name in inputs}, place)
        for i, (size, at) in enumerate(greatest):
            turn = abs(at - place) % (2.0 * np.pi)
            found[0][bounded, i, k] = np.minimum(turn, 2.0 * np.pi - turn)
            with np.errstate(all="ignore"):  # a load that vanishes everywhere
                found[1][bounded, i, k] = there[i] / size
    dims = (*template.dims, "load", "extreme")
    coords = {**template.coords, "load": loads, "extreme": [_extreme(*extreme) for extreme in extremes]}
    of_distance = "Angle of the input between the greatest magnitude of the load and the extreme"
    of_ratio = "Magnitude of the load at the extreme over the greatest"
    results = {
        "distance": (dims, found[0], {"units": "rad", "long_name": of_distance}),
        "ratio": (dims, found[1], {"units": "1", "long_name": of_ratio}),
    }
    return xr.Dataset(results, coords)


def _extreme(name: str, end: str) -> str:
    """Return the name of the greatest or least value of a quantity."""
    return str(Reduced(Quantity(name), end))


def _place(name: str, end: str) -> str:
    """Return the name of the position of an extreme."""
    return str(Reduced(Quantity(name), end, THETA1))


def _named(load: str) -> list[str]:
    """Return what is read of a load: its extremes and their places."""
    return [name for end in ENDS for name in (_extreme(load, end), _place(load, end))]


def _loads_and_extremes(dataset: xr.Dataset) -> tuple[list[str], list[tuple[str, str]]]:
    """Return the loads of a map, and the extremes of its rates as name and end, or refuse the map."""
    mechanism, position = dataset.attrs.get("mechanism"), dataset.attrs.get("input")
    if (mechanism, position) != (planar_4r.name, THETA1):
        what = f"is of {short_repr(mechanism)} by {short_repr(position)}"
        raise InputError(what, WHERE, f"sweep {planar_4r.name!r} by {THETA1}")
    trees = (planar_4r.parse(str(name)) for name in dataset.data_vars)
    placed = dict.fromkeys(str(tree.of) for tree in trees if isinstance(tree, Reduced) and tree.position)
    units = {name: planar_4r.public_fact(name).units for name in placed}
    loads, rates = ([name for name in units if (units[name] in ("N", "N m")) is of] for of in (True, False))
    problems = Problems()
    for kind, names, example in (("forces", loads, "shaking_force"), ("rates", rates, "omega4")):
        if not names:
            what = f"has no extremes of {kind} with their places"
            names_of = f"{_extreme(example, 'max')!r}, {_place(example, 'max')!r}"
            problems.add(what, WHERE, f"sweep {names_of} and those of its minimum")
    needed = {_place(name, end): "rad" for name in units for end in ENDS}
    needed |= {_extreme(load, end): units[load] for load in loads for end in ENDS}
    for name, unit in needed.items():
        if name not in dataset:
            problems.add(
                f"{name!r} is missing", WHERE, f"sweep {name!r} too, and give the whole result of the sweep"
            )
            continue
        problems.attempt(check_units, dataset[name], unit, (*WHERE, name))
    problems.stop()
    return loads, [(rate, end) for rate in rates for end in ENDS]


def _greatest(load: str, values: Mapping[str, Any]) -> tuple[Any, Any]:
    """Return the greatest magnitude of a load, and the position where it is."""
    high, low = (abs(values[_extreme(load, end)]) for end in ENDS)
    at_high, at_low = (values[_place(load, end)] for end in ENDS)
    return np.maximum(high, low), np.where(high >= low, at_high, at_low)


def _magnitudes(loads: Sequence[str], design: Mapping[str, Any], theta1: Any) -> Any:
    """Return the magnitudes of loads at a position of each design."""
    links = Links("round_bar", {}) if "density" in design or "radius" in design else None
    found = np.full((len(loads), theta1.size), np.nan)
    for part in papers.blocks(theta1.size, BLOCK_OF_FORCES):
        inputs = {name: values[part] for name, values in design.items()}
        at = evaluate(planar_4r.name, loads, links=links, allow_invalid=True, theta1=theta1[part], **inputs)
        for i, load in enumerate(loads):
            found[i, part] = abs(at[load])
    return found
