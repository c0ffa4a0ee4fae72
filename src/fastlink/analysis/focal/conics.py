"""Conics that touch the four lines of a position of the four-bar, and the pairs of tangents from a point.

With M, N, A, B as complex numbers, the conics that touch MA, AB, BN and NM are one for each real t, and its foci are
the roots of

    (1 - t)(f - M)(f - B) + t (f - A)(f - N) = 0:

the equation in lines of a conic is that of its foci for the lines through a circular point, it is linear in t, and the
conics t = 0 and t = 1 are the pairs of points M, B and A, N (Wunderlich, section 5).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fastlink.analysis.designs import broadcast
from fastlink.analysis.focal.nearest import nearest_point
from fastlink.analysis.focal.position import corners, point, read_position
from fastlink.catalogue.catalogue import Input
from fastlink.doors import door
from fastlink.errors import InputError

__all__ = ["InscribedConic", "Involution", "inscribed_conics", "involution"]

#: What t is, for messages.
PARAMETER = Input("t", "1", "t", "number of the conic")
#: One of the double rays, for the shape of the points.
RAY = Input("first", "rad", "first", "direction of a double ray")


class InscribedConic(NamedTuple):
    """Conics that touch the lines MA, AB, BN and NM; see `inscribed_conics`.

    Attributes
    ----------
    t : ndarray
        Their numbers.
    kind : ndarray
        0: ellipse, 1: hyperbola, 2: two points (its foci).
    x1, y1, x2, y2 : ndarray
        The foci [m], which lie on the focal cubic; a given one first.
    centre_x, centre_y : ndarray
        The centre [m], on the line through the middles of MB and AN.
    direction : ndarray
        Direction of the line through the foci, in (-pi/2, pi/2] [rad].
    major, minor : ndarray
        Semi-axes along that line and across it [m].
    """

    t: Any
    kind: Any
    x1: Any
    y1: Any
    x2: Any
    y2: Any
    centre_x: Any
    centre_y: Any
    direction: Any
    major: Any
    minor: Any


@door
def inscribed_conics(
    a: Any, b: Any, c: Any, d: Any, phi: Any, branch: Any = 1, *, t: Any = None, x: Any = None, y: Any = None
) -> InscribedConic:
    """Return the conics that touch the four lines of a position of the four-bar MABN.

    Parameters
    ----------
    a, b, c, d : float or array_like
        Lengths of MA, NB, AB and MN [m], broadcast with the position and the conic.
    phi : float or array_like
        Direction of MA, seen from MN [rad].
    branch : int or array_like
        1: B to the right of the directed line from A to N; 2: to the left.
    t : float or array_like, optional
        Numbers of conics: 0 and 1 are the pairs of points M, B and A, N, and the centre goes in proportion to t from
        the middle of MB to that of AN. Towards infinity the conics become the parabola.
    x, y : float or array_like, optional
        Instead of t one focus, origin in M and x along MN [m]; of points off the focal cubic the nearest point of it.

    Returns
    -------
    InscribedConic
        NaN where the four-bar does not assemble.

    Raises
    ------
    InputError
        Neither t nor a focus is given, or both; a length is not in 1e-70 ... 1e70, a number is not valid, or the
        numbers do not broadcast.

    Examples
    --------
    One of the kite with M = (0, 0), A = (0, 1), B = (3, 3), N = (1, 0):

    >>> import numpy as np
    >>> import fastlink as fl
    >>> side = np.sqrt(13.0)
    >>> conic = fl.focal.inscribed_conics(1.0, side, side, 1.0, np.pi / 2, branch=2, t=0.75)
    >>> [round(float(value), 4) for value in (conic.x1, conic.y1, conic.x2, conic.y2)]
    [1.183, 1.183, 0.317, 0.317]
    """
    focus = _check_choice(t, x, y)
    if focus:
        *position, x, y = read_position("inscribed_conics", a, b, c, d, phi, branch, further=focus)
        A, B = corners(*position)
        first = nearest_point(tuple(position), x + 1j * y)
        return _conic(A, B, position[3], _number(A, B, position[3], first), first)
    *position, t = read_position("inscribed_conics", a, b, c, d, phi, branch, further=[(PARAMETER, t)])
    A, B = corners(*position)
    return _conic(A, B, position[3], t)


def _check_choice(t: Any, x: Any, y: Any) -> list[tuple[Input, Any]]:
    """Return the declared coordinates of a focus, none where t is given."""
    missing = [name for name, value in (("x", x), ("y", y)) if value is None]
    if (t is None) == bool(missing) or (t is not None and len(missing) < 2):
        what = (
            "are given together"
            if t is not None
            else "and t are missing"
            if len(missing) > 1
            else "is missing"
        )
        names = "x and y" if len(missing) != 1 else missing[0]
        raise InputError(
            f"{names} {what}", where=("inscribed_conics",), remedy="give t=..., or a focus x=..., y=..."
        )
    return [] if missing else [(point("x"), x), (point("y"), y)]


def _number(A: Any, B: Any, N: Any, focus: Any) -> Any:
    """Return the number t of the conics with a focus."""
    one, other = focus * (focus - B), (focus - A) * (focus - N)
    # of one sign where the focus is on the cubic: their ratio is real
    first = np.copysign(np.abs(one), (one * np.conj(other)).real)
    with np.errstate(divide="ignore", over="ignore"):  # the focus of the parabola
        return first / (first - np.abs(other))


def _conic(A: Any, B: Any, N: Any, t: Any, first: Any = None) -> InscribedConic:
    """Return the conics of numbers t, with the focus that is given as the first one."""
    size, of_MB, of_AN = _shares(t)
    half, product = 0.5 * (of_MB * B + of_AN * (A + N)), of_AN * (A * N)
    # half^2 - product, without its cancelling where t is 1 and A next to N
    apart = 0.5 * (of_MB * B + of_AN * (A - N))
    rest = of_AN * of_MB * N * (B - A)
    # which cancels instead near the parabola of a parallelogram, whose centre stays where it is
    cancels = 4.0 * (np.abs(half) ** 2 + np.abs(product) / size) < np.abs(apart) ** 2 + np.abs(rest)
    root = np.sqrt(np.where(cancels, half * half - product / size, apart * apart + rest))
    # the greater root first, as it does not cancel
    one = half + np.where((half * np.conj(root)).real < 0.0, -root, root)
    with np.errstate(
        all="ignore"
    ):  # NaN, where the four-bar does not assemble; infinite, beyond the range of doubles
        two = product / np.where(one == 0.0, 1.0, one)
        if first is not None:
            given = np.abs(one - first / size) <= np.abs(two - first) / size
            one, two = np.where(given, one, two / size), np.where(given, two, one * size)
        apart = 0.5 * (one - two / size)
        squared = one.imag * two.imag  # the distances of both foci from the tangent MN, over the size
        major = np.sqrt(np.maximum(np.abs(apart) ** 2 + squared / size, 0.0)) * size
        kind = np.where(squared == 0.0, 2.0, np.where(squared > 0.0, 0.0, 1.0)) + 0.0 * squared
        minor = np.sqrt(np.abs(squared)) * np.sqrt(size)
        foci = (one.real * size, one.imag * size, two.real, two.imag, half.real * size, half.imag * size)
    return InscribedConic(t + 0.0 * squared, kind, *foci, _direction(apart.real, apart.imag), major, minor)


def _shares(t: Any) -> tuple[Any, Any, Any]:
    """Return a power of 4 of the size of t, at least 1, and 1 - t and t divided by it."""
    size = np.ldexp(1.0, (np.frexp(np.maximum(np.abs(t), 1.0))[1] - 1) // 2 * 2)
    return size, (1.0 - t) / size, t / size


class Involution:
    """Pairs of tangents from points to the conics that touch MA, AB, BN and NM; see `involution`.

    Attributes
    ----------
    first, second : ndarray
        Directions of the double rays, each paired with itself, in (-pi/2, pi/2] [rad]; NaN where they are not real.
    asymmetry : ndarray
        Cosine of the angle that the double rays enclose, greater than 1 where they are not real. At points of the
        focal cubic it is 0: the involution is symmetric, and pairs have common bisectors.
    """

    def __init__(self, one: Any, other: Any) -> None:
        self._forms = one, other
        (p1, q1, r1), (p2, q2, r2) = one, other
        # the double rays: where both quadratic forms have one gradient
        self._double = (p1 * q2 - q1 * p2, 0.5 * (p1 * r2 - r1 * p2), q1 * r2 - r1 * q2)
        self.first, self.second = _rays(*self._double)
        xx, xy, yy = self._double
        with np.errstate(all="ignore"):
            self.asymmetry = (xx + yy) / np.sqrt((xx - yy) ** 2 + 4.0 * xy * xy)

    def partner(self, direction: Any) -> Any:
        """Return the direction of the ray that is paired with the ray of a direction [rad]."""
        declared = [Input("direction", "rad", "direction", "direction of a ray"), RAY]
        angle, _ = broadcast("partner", declared, direction, self.first, gaps=True)
        xx, xy, yy = self._double
        x, y = np.cos(angle), np.sin(angle)
        return _direction(-(xy * x + yy * y), xx * x + xy * y)

    def tangents(self, t: Any) -> tuple[Any, Any]:
        """Return the directions of both tangents to the conic of number t [rad]; NaN where they are not real."""
        t, _ = broadcast("tangents", [PARAMETER, RAY], t, self.first, gaps=True)
        _, of_one, of_other = _shares(t)
        return _rays(*(of_one * one + of_other * other for one, other in zip(*self._forms, strict=True)))


@door
def involution(a: Any, b: Any, c: Any, d: Any, phi: Any, branch: Any = 1, *, x: Any, y: Any) -> Involution:
    """Return the involution of the tangents from a point to the conics in a position of MABN.

    Two rays through the point (x, y) are paired if they are the tangents to one of the conics that touch MA, AB, BN
    and NM (Desargues); the rays to M and B are a pair, and those to A and N.

    Parameters
    ----------
    a, b, c, d, phi, branch
        As for `inscribed_conics`.
    x, y : float or array_like
        The point [m], origin in M and x along MN.

    Returns
    -------
    Involution
        NaN where the four-bar does not assemble.

    Raises
    ------
    InputError
        A length is not in 1e-70 ... 1e70, a number is not valid, or the numbers do not broadcast.

    Examples
    --------
    At F of Figure 4, a point of the focal cubic, pairs have common bisectors, here at 45 degrees:

    >>> import numpy as np
    >>> import fastlink as fl
    >>> rays = fl.focal.involution(5.0, 5.0, 2.0, 4.0, np.arccos(0.2), branch=2, x=2.0, y=0.449489742783178)
    >>> np.degrees([rays.first, rays.second]).round(9), bool(abs(rays.asymmetry) < 1e-15)
    (array([-45.,  45.]), True)
    >>> to_M, to_B = np.arctan2([0.449489742783178, 4.449489742783178], [2.0, 1.0])
    >>> round(float(rays.partner(to_M) - to_B), 9)
    0.0
    """
    further = ((point("x"), x), (point("y"), y))
    *position, x, y = read_position("involution", a, b, c, d, phi, branch, further=further)
    A, B = corners(*position)
    G, N = x + 1j * y, position[3]
    size = np.max(np.abs([A, B, G, N + 0j]), axis=0)
    with np.errstate(invalid="ignore"):  # NaN, where the four-bar does not assemble
        M_G, N_G, A_G, B_G = (-G / size, (N - G) / size, (A - G) / size, (B - G) / size)
    return Involution(_pair(M_G, B_G), _pair(A_G, N_G))


def _pair(one: Any, other: Any) -> tuple[Any, Any, Any]:
    """Return the quadratic form p x^2 + 2 q x y + r y^2 that vanishes along two vectors."""
    return (
        one.imag * other.imag,
        -0.5 * (one.imag * other.real + one.real * other.imag),
        one.real * other.real,
    )


def _rays(p: Any, q: Any, r: Any) -> tuple[Any, Any]:
    """Return the directions along which p x^2 + 2 q x y + r y^2 vanishes, NaN where they are not real."""
    with np.errstate(invalid="ignore"):
        root = np.sqrt(q * q - p * r)
        # the greater sum first, as it does not cancel
        double = -(q + np.where(q < 0.0, -root, root))
    return _direction(double, p), _direction(r, double)


def _direction(x: Any, y: Any) -> Any:
    """Return the direction of a line along (x, y), in (-pi/2, pi/2]; NaN of (0, 0)."""
    angle = np.arctan2(np.where(x < 0.0, -y, y), np.abs(x))
    angle = np.where(angle == -0.5 * np.pi, 0.5 * np.pi, angle)
    return np.where((x == 0.0) & (y == 0.0), np.nan, angle)
