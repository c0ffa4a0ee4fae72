"""The focal cubic of a position of the four-bar: all points that F can be.

It is the locus of the foci of the conics that touch the lines MA, AB, BN and NM (Wunderlich, sections 4 and 5).
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from fastlink.analysis.designs import check_samples
from fastlink.analysis.focal.position import read_position
from fastlink.doors import door
from fastlink.engine.evaluate import evaluate
from fastlink.numerics.vectors import cross

__all__ = ["cubic", "cubic_points"]

#: Between the four directions in which both points of a line through M meet.
ARCS = 4


@door
def cubic(a: Any, b: Any, c: Any, d: Any, phi: Any, branch: Any = 1) -> Any:
    r"""Return the equation of the focal cubic of a position of the four-bar MABN.

    Parameters
    ----------
    a, b, c, d : float or array_like
        Lengths of MA, NB, AB and MN [m], broadcast with the position.
    phi : float or array_like
        Direction of MA, seen from MN [rad].
    branch : int or array_like
        1: B to the right of the directed line from A to N; 2: to the left.

    Returns
    -------
    ndarray, shape (..., 4, 4)
        k with ``sum(k[..., i, j] x**i y**j) = 0`` for the points (x, y) [m] of the cubic, origin in M, x along MN.
        k[i, j] has the unit m^(4 - i - j). NaN where the four-bar does not assemble.

    Raises
    ------
    InputError
        A length is not in 1e-70 ... 1e70, or the numbers do not broadcast.

    Notes
    -----
    Eq. (4.6) says that z (z - z_B) times the conjugate of (z - d)(z - z_A) is real. Multiplied out, with
    V = d - AB and the products of vectors written out,

    .. math::
        (V_y x - V_x y)(x^2 + y^2) + (d\,AB_y + A \times AB)\,x^2 + 2 d A_x x y
            + (d (A_y + B_y) + A \times AB)\,y^2 - d\,(A \times AB)\,x - d\,(A \cdot B)\,y = 0.

    It goes through M, N, A, B, through X = MA.NB and Y = MN.AB, and through the circular points. Where MN and AB are
    equal and parallel it is a conic (and the line at infinity); where all bars lie in one line it is that line
    and a circle.

    Examples
    --------
    >>> import numpy as np
    >>> import fastlink as fl
    >>> k = fl.focal.cubic(3.0, 5.0, 4.0, 6.0, 0.0, branch=2)  # A = (3, 0), B = (3, 4)
    >>> on_it = [(0.0, 0.0), (6.0, 0.0), (3.0, 0.0), (3.0, 4.0)]
    >>> [round(abs(float(np.polynomial.polynomial.polyval2d(x, y, k))), 9) for x, y in on_it]
    [0.0, 0.0, 0.0, 0.0]
    """
    return coefficients(*read_position("cubic", a, b, c, d, phi, branch))


def coefficients(a: Any, b: Any, c: Any, d: Any, phi: Any, branch: Any) -> Any:
    """Return the equations of focal cubics of positions that are read; see `cubic`."""
    values = evaluate(
        "planar_4r",
        ["A_x", "A_y", "B_x", "B_y", "theta2"],
        **dict(a1=a, a2=c, a3=b, a4=d, theta1=phi, branch=branch),
    )
    A_x, A_y, B_x, B_y, direction = (np.asarray(value) for value in values.values())
    half = np.sin(0.5 * direction)
    AB_x, AB_y = c * np.cos(direction), c * np.sin(direction)
    area = cross(A_x, A_y, AB_x, AB_y)
    k = np.zeros((*d.shape, 4, 4))
    k[..., 3, 0] = k[..., 1, 2] = -AB_y
    k[..., 2, 1] = k[..., 0, 3] = (c - d) - 2.0 * c * (half * half)
    k[..., 2, 0] = d * AB_y + area
    k[..., 1, 1] = 2.0 * (d * A_x)
    k[..., 0, 2] = d * (A_y + B_y) + area
    k[..., 1, 0] = -(d * area)
    k[..., 0, 1] = -(d * (A_x * B_x + A_y * B_y))
    k[np.isnan(direction)] = np.nan
    return k


@door
def cubic_points(a: Any, b: Any, c: Any, d: Any, phi: Any, branch: Any = 1, *, samples: int = 100) -> Any:
    """Return points of the focal cubic of a position, in the order of its branches.

    Parameters
    ----------
    a, b, c, d, phi, branch
        As for `cubic`.
    samples : int
        Points on each of up to eight arcs, at least 2.

    Returns
    -------
    ndarray, shape (..., 8 (samples + 1), 2)
        Points (x, y) [m]. Arcs follow each other, NaN between them, and in place of those that are not real and of
        points at infinity.

    Notes
    -----
    A line through M, itself a point of the cubic, meets it in two further points: the roots of a quadratic equation,
    real or not. Both roots meet in at most four directions, the roots of a quartic: the arcs run between these, with
    samples that are dense at their ends. Every point of the cubic but M is reached.

    Examples
    --------
    >>> import numpy as np
    >>> import fastlink as fl
    >>> lines = fl.focal.cubic_points(5.0, 5.0, 2.0, 4.0, np.pi / 3, samples=40)
    >>> lines.shape
    (328, 2)
    """
    samples = check_samples("cubic_points", samples, 2)
    return trace(read_position("cubic_points", a, b, c, d, phi, branch), samples)


def trace(position: Iterable[Any], samples: int) -> Any:
    """Return points of the focal cubics of positions that are read; see `cubic_points`."""
    a, b, c, d, phi, branch = position
    size = np.maximum(np.maximum(a, b), np.maximum(c, d))
    k = coefficients(a / size, b / size, c / size, d / size, phi, branch)
    ends = _double_directions(k)
    # from each of the directions to the next one, round half a turn
    width = np.diff(ends, axis=-1, append=ends[..., :1] + np.pi)
    share = np.sin(np.linspace(0.0, 0.5 * np.pi, samples)) ** 2
    angle = ends[..., None] + width[..., None] * share
    cosine, sine = np.cos(angle), np.sin(angle)
    cubed, squared, linear = _on_lines(k[..., None, None, :, :], cosine, sine)
    discriminant = squared * squared - 4.0 * cubed * linear
    inside = discriminant[..., samples // 2 : samples // 2 + 1] > 0.0
    root = np.where(inside, np.sqrt(np.maximum(discriminant, 0.0)), np.nan)
    # the greater root first, as it does not cancel
    double = -(squared + np.where(squared < 0.0, -root, root))
    with np.errstate(all="ignore"):
        far, near = double / (2.0 * cubed), 2.0 * linear / double
        plus = np.where(squared < 0.0, far, near)
        minus = np.where(squared < 0.0, near, far)
        distance = np.stack([plus, minus], axis=-2) * size[..., None, None, None]
        arcs = np.stack([distance * cosine[..., None, :], distance * sine[..., None, :]], axis=-1)
    turned = (cubed[..., 1:] * cubed[..., :-1] < 0.0)[..., None, :]
    sides = np.sign(distance)
    through_infinity = turned & (sides[..., 1:] * sides[..., :-1] < 0.0)
    arcs[..., 1:, :][through_infinity] = np.nan
    arcs[~np.isfinite(distance)] = np.nan
    gaps = np.full((*arcs.shape[:-2], 1, 2), np.nan)
    return np.concatenate([arcs, gaps], axis=-2).reshape(*d.shape, 2 * ARCS * (samples + 1), 2)


def _on_lines(k: Any, x: Any, y: Any) -> tuple[Any, Any, Any]:
    """Return the coefficients of the three powers of the distance from M along (x, y)."""
    cubed = k[..., 3, 0] * x + k[..., 0, 3] * y
    squared = k[..., 2, 0] * (x * x) + k[..., 1, 1] * (x * y) + k[..., 0, 2] * (y * y)
    return cubed, squared, k[..., 1, 0] * x + k[..., 0, 1] * y


def _double_directions(k: Any) -> Any:
    """Return four directions, among them all of lines through M that touch the cubic.

    The discriminant is a trigonometric polynomial of degree 2 in twice the direction, whose coefficient of that degree
    is (a d)^2/4 in magnitude: never 0. A zero that is not real counts as the direction nearest to it.
    """
    constant = 0.5 * (k[..., 2, 0] + k[..., 0, 2])
    wave = 0.25 * (k[..., 2, 0] - k[..., 0, 2] - 1j * k[..., 1, 1])
    # cubed times linear, of the same form
    xx, yy = k[..., 3, 0] * k[..., 1, 0], k[..., 0, 3] * k[..., 0, 1]
    xy = k[..., 3, 0] * k[..., 0, 1] + k[..., 0, 3] * k[..., 1, 0]
    middle, slope = 0.5 * (xx + yy), 0.25 * (xx - yy - 1j * xy)
    zeroth = constant * constant + 2.0 * np.abs(wave) ** 2 - 4.0 * middle
    first = 2.0 * constant * wave - 4.0 * slope
    second = wave * wave
    closes = np.isfinite(zeroth)
    below = [np.conj(second), np.conj(first), zeroth, first]
    matrix = np.zeros((*zeroth.shape, 4, 4), dtype=complex)
    matrix[..., 1:, :3] = np.eye(3)
    for row, coefficient in enumerate(below):
        matrix[..., row, 3] = np.where(closes, -coefficient / np.where(closes, second, 1.0), 0.0)
    turns = 0.5 * np.angle(np.linalg.eigvals(matrix))
    return np.where(closes[..., None], np.sort(turns, axis=-1), np.nan)
