"""Functions of Burmester's focal mechanism: its cubic, constructions on it, conics, the five-bar, straight lines.

Positions of the four-bar MABN are given as for `cubic`. Lengths are 1e-24 to 1e24 m. Others, values that are no finite
numbers and shapes that do not broadcast are refused with `fastlink.InputError`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from fastlink import papers
from fastlink.engine.evaluate import evaluate, like
from fastlink.errors import InputError, Pair, check_choice, door
from fastlink.facts.fact import Input
from fastlink.io.reader import as_dataset
from fastlink.mechanisms.focal import focal
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.numerics.vectors import cross
from fastlink.plan.request import branch_codes
from fastlink.space.design_space import ends_of

__all__ = [
    "Construction",
    "InscribedConic",
    "Involution",
    "StraightLine",
    "T_deviation",
    "best_point",
    "cubic",
    "cubic_points",
    "five_bar",
    "from_five_bar",
    "from_point",
    "held_at_AB",
    "inscribed_conics",
    "involution",
    "straight_line",
]


def __dir__() -> list[str]:
    return __all__


# -- Read a position of the four-bar MABN, as functions of its focal cubic are given it


MODE = papers.number("branch", "assembly mode")


def point(name: str) -> Input:
    """Return the declaration of a coordinate of a point in the plane."""
    return papers.number(name, f"coordinate {name} of the point", "m")


def read_position(function: str, *numbers: Any, further: Iterable[tuple[Input, Any]] = ()) -> list[Any]:
    """Return a, b, c, d, phi, branch and further numbers as arrays of one shape."""
    *position, branch = numbers
    declared = [*(focal.inputs[name] for name in "abcd"), focal.position, MODE, *(one for one, _ in further)]
    codes = like(branch, branch_codes(planar_4r, branch))
    arrays = papers.broadcast(function, declared, *position, codes, *(value for _, value in further))
    papers.check_lengths(function, declared, arrays, "four lengths")
    bars = np.array(arrays[:4])
    if (bars.min(axis=0) <= papers.LEAST_LENGTH * bars.max(axis=0)).any():
        remedy = "write lengths within a factor of 1e24 of each other"
        raise InputError("a, b, c and d are too unlike", (function,), remedy)
    return arrays


def _joints(position: Sequence[Any], *further: str) -> list[Any]:
    """Return the coordinates of A and B and further quantities of the four-bar, NaN where it does not assemble."""
    bars = dict(zip(("a1", "a3", "a2", "a4", "theta1", "branch"), position, strict=True))
    found = evaluate("planar_4r", ["A_x", "A_y", "B_x", "B_y", *further], **bars)
    return [np.asarray(value) for value in found.values()]


def corners(position: Sequence[Any]) -> tuple[Any, Any]:
    """Return the joints A and B as complex numbers, NaN where the four-bar does not assemble."""
    A_x, A_y, B_x, B_y = _joints(position)
    return np.where(np.isfinite(B_x), A_x + 1j * A_y, np.nan), B_x + 1j * B_y


# -- The focal cubic of a position of the four-bar: all points that F can be

# It is the locus of the foci of the conics that touch the lines MA, AB, BN and NM (Wunderlich, sections 4
# and 5).


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
    >>> k = fl.focal.cubic(3.0, 5.0, 4.0, 6.0, 0.0, branch=2)  # A = (3, 0), B = (3, 4)
    >>> on_it = [(0.0, 0.0), (6.0, 0.0), (3.0, 0.0), (3.0, 4.0)]
    >>> [round(abs(float(np.polynomial.polynomial.polyval2d(x, y, k))), 9) for x, y in on_it]
    [0.0, 0.0, 0.0, 0.0]
    """
    return coefficients(read_position("cubic", a, b, c, d, phi, branch))


def coefficients(position: Sequence[Any]) -> Any:
    """Return the equations of focal cubics of positions that are read; see `cubic`."""
    A_x, A_y, B_x, B_y, direction = _joints(position, "theta2")
    c, d = position[2:4]
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
    >>> lines = fl.focal.cubic_points(5.0, 5.0, 2.0, 4.0, np.pi / 3, samples=40)
    >>> lines.shape
    (328, 2)
    """
    samples = papers.check_samples("cubic_points", samples, 2)
    return trace(read_position("cubic_points", a, b, c, d, phi, branch), samples)


def trace(position: Iterable[Any], samples: int) -> Any:
    """Return points of the focal cubics of positions that are read; see `cubic_points`."""
    a, b, c, d, phi, branch = position
    size = np.maximum(np.maximum(a, b), np.maximum(c, d))
    k = coefficients((a / size, b / size, c / size, d / size, phi, branch))
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


# -- Find the point of a focal cubic that is nearest to a given point


#: Points that are searched at once; each has some thousand points of its cubic beside it.
BLOCK = 500
#: Points on each of eight arcs from which Newton's iteration starts, and its steps.
SAMPLES, STEPS = 100, 12
#: Over the longest bar, what is no farther off than this is on the cubic.
ON_IT = 1e-9


def nearest_point(position: Sequence[Any], z: Any) -> Any:
    """Return the points of focal cubics that are nearest to points z, as complex numbers."""
    shape = z.shape
    *lengths, phi, branch = (np.ravel(value) for value in position)
    z = np.ravel(z)
    size = 2.0 ** np.ceil(np.log2(np.max(lengths, axis=0)))
    plain = (*(length / size for length in lengths), phi, branch)
    k = np.moveaxis(coefficients(plain), 0, -1)
    start = z / size
    found = onto(k, start)
    # on which side of the curve a point lies is rounding; farther ones need the whole curve
    off = np.abs(found - start)
    far = np.flatnonzero(~(off <= ON_IT) & np.isfinite(k[0, 1]))
    for some in (far[part] for part in papers.blocks(far.size, BLOCK)):
        traced = trace((value[some] for value in plain), SAMPLES)
        found[some] = _nearest_of(k[..., some], start[some], traced[..., 0] + 1j * traced[..., 1])
    return (found * size).reshape(shape)


def _nearest_of(k: Any, start: Any, traced: Any) -> Any:
    """Return the point of each cubic that is nearest to a point, from points all along the cubic."""
    distances = np.abs(traced - start[:, None])
    distances[np.isnan(distances)] = np.inf
    sample = np.take_along_axis(traced, distances.argmin(axis=1)[:, None], axis=1)[:, 0]
    # far out the cubic is traced in great steps, and next to its asymptote
    with np.errstate(all="ignore"):
        asymptote = (k[0, 3] - 1j * k[3, 0]) / np.hypot(k[0, 3], k[3, 0])
        far = asymptote * (start * np.conj(asymptote)).real
    found = [
        onto(k, way(begin)) for begin in (sample, far) for way in (lambda z: _foot(k, start, z), np.copy)
    ]
    off = np.stack([np.where(_is_on(k, z), np.abs(z - start), np.inf) for z in found])
    return np.take_along_axis(np.stack(found), off.argmin(axis=0)[None], axis=0)[0]


def _is_on(k: Any, z: Any) -> Any:
    """Tell whether points are on cubics, but for roundings."""
    value, slope, *_ = gradient(k, z)
    with np.errstate(all="ignore"):
        return np.abs(value) <= ON_IT * np.abs(slope) * (1.0 + np.abs(z))


def gradient(k: Any, z: Any) -> tuple[Any, Any, Any, Any, Any]:
    """Return the polynomial k of cubics, its gradient as a complex number, and its second derivatives xx, xy, yy."""
    x, y = z.real, z.imag
    (_, k01, k02, k03), (k10, k11, k12, _), (k20, k21, *_), (k30, *_) = k
    value = k01 * y + x * (k10 + x * (k20 + x * k30))
    value = value + y * (k11 * x + k21 * x * x + y * (k02 + k12 * x + k03 * y))
    by_x = k10 + 2.0 * k20 * x + 3.0 * k30 * x * x + y * (k11 + 2.0 * k21 * x + k12 * y)
    by_y = k01 + 2.0 * k02 * y + 3.0 * k03 * y * y + x * (k11 + k21 * x + 2.0 * k12 * y)
    xx = 2.0 * k20 + 6.0 * k30 * x + 2.0 * k21 * y
    xy = k11 + 2.0 * k21 * x + 2.0 * k12 * y
    yy = 2.0 * k02 + 6.0 * k03 * y + 2.0 * k12 * x
    return value, by_x + 1j * by_y, xx, xy, yy


def onto(k: Any, z: Any) -> Any:
    """Return points of the cubics, from points near them along the gradient."""
    for _ in range(4):
        value, slope, *_ = gradient(k, z)
        with np.errstate(all="ignore"):
            step = value * slope / (slope.real**2 + slope.imag**2)
        z = z - np.where(np.isfinite(step), step, 0.0)
    return z


def _foot(k: Any, start: Any, z: Any) -> Any:
    """Return the point where the normal of each cubic goes through a point, by Newton's iteration."""
    _, slope, *_ = gradient(k, z)
    with np.errstate(all="ignore"):
        multiplier = ((start - z) * np.conj(slope)).real / np.abs(slope) ** 2
        for _ in range(STEPS):
            value, slope, xx, xy, yy = gradient(k, z)
            # z - start + multiplier slope = 0 and value = 0
            left = start - z - multiplier * slope
            a, b, c = 1.0 + multiplier * xx, multiplier * xy, 1.0 + multiplier * yy
            determinant = a * c - b * b
            # the first two equations by the change of the multiplier
            by_left, by_slope = (
                ((c * side.real - b * side.imag) + 1j * (a * side.imag - b * side.real)) / determinant
                for side in (left, slope)
            )
            change = ((by_left * np.conj(slope)).real + value) / (by_slope * np.conj(slope)).real
            step = by_left - change * by_slope
            sure = np.isfinite(step)
            z = z + np.where(sure, step, 0.0)
            multiplier = multiplier + np.where(sure, change, 0.0)
    return z


# -- Construct a focal mechanism on a position of a four-bar: from a point F of its focal cubic (Wunderlich,
#    section 4)

# With complex numbers M = 0, N = d, A, B, F, the triangles MPF ~ FQB and NQF ~ FPA say that F - A = -(p/n)
# E (F - N)* and F - B = (q/m) E (F - M)*, |E| = 1 and * the conjugate. So both ratios are products of
# distances, and nothing cancels:
#
#     rho = mp/(nq) = -(F - A)(F - M)*/((F - B)(F - N)*),    lambda - 1 = pq/(mn) = -(F - B)(F - A)*/((F - N)(F - M)*).
#
# They are real for points of the cubic, by (4.5).


#: What may determine the completion beside its number.
RATIOS = ("rho", "s", "lambda_")
LENGTHS = ("status", "lambda_", "m", "n", "p", "q", "s", "r", "FT", "T_ratio")
ANGLES = ("psi", "sigma", "omega_angle", "alpha", "beta", "chi")
DRIVE = ("crank_type", "transmission_angle_PQ_least", "transmission_angle_F_least")
JOINTS = tuple(f"{joint}_{axis}" for joint in "ABPQTF" for axis in "xy")


@dataclass(frozen=True)
class Construction:
    """A focal mechanism constructed on a four-bar in a position; see `from_point` and `best_point`.

    Attributes
    ----------
    design : dict of str to ndarray
        The inputs of ``focal``: ``a``, ``b``, ``c``, ``d``, one of ``rho``, ``s`` and ``lambda_``, and ``completion``.
        `fastlink.sweep` takes them, and so does `fastlink.evaluate`.
    position : dict of str to ndarray
        ``phi`` and ``branch``.
    values : dict of str to ndarray
        Lengths, angles, joints and properties of the drive in that position, by their names as quantities of ``focal``.
    """

    design: dict[str, Any]
    position: dict[str, Any]
    values: dict[str, Any]


@door
def from_point(
    a: Any, b: Any, c: Any, d: Any, phi: Any, branch: Any = 1, *, x: Any, y: Any, by: str = "rho"
) -> Construction:
    """Construct the focal mechanism of a four-bar in a position, from its joint F.

    Parameters
    ----------
    x, y : float or array_like
        F, origin in M and x along MN [m]. Of points off the focal cubic (`cubic_points` traces it) the nearest point
        of the cubic is taken.
    by : {"rho", "s", "lambda_"}
        The input that the design has beside ``completion``.

    Returns
    -------
    Construction
        Its ``values["F_x"]``, ``values["F_y"]`` are the point that was taken. There is no mechanism, and
        ``values["status"]`` tells why, where F is M, N, A or B (bars of length 0) and where the four-bar does not
        assemble in this position (``invalid_input``: no ratio).

    Notes
    -----
    Both ratios are products of distances of F from the corners, rho = -+FA FM/(FB FN) and lambda - 1 = -+FB FA/(FN FM),
    with signs by (4.4); lengths and joints then are those of ``focal``. Where both completions meet, a design by rho
    has half the digits of the point, one by lambda all of them, and the other way round where both roots of rho meet.

    Examples
    --------
    The mechanism of Figure 4, from the point in which circles on MA and NB as diameters meet:

    >>> made = fl.focal.from_point(5.0, 5.0, 2.0, 4.0, np.arccos(0.2), branch=2, x=2.0, y=0.449489742783178)
    >>> {name: round(float(made.values[name]), 4) for name in ("lambda_", "m", "p", "r")}
    {'lambda_': 5.9495, 'm': 0.8404, 'p': 1.8697, 'r': 0.4495}
    >>> {name: round(float(value), 9) for name, value in made.design.items()}
    {'a': 5.0, 'b': 5.0, 'c': 2.0, 'd': 4.0, 'rho': 1.0, 'completion': 1.0}
    >>> turn = fl.sweep("focal", made.design, ["T_y"], input="sigma", branch=1)
    """
    check_choice(("from_point", "by"), by, RATIOS)
    further = ((point("x"), x), (point("y"), y))
    *position, x, y = read_position("from_point", a, b, c, d, phi, branch, further=further)
    a, b, c, d, phi, branch = position
    A, B = corners(position)
    F = nearest_point(position, x + 1j * y)
    size = np.maximum(np.maximum(a, b), np.maximum(c, d))
    to_A, to_B, to_M, to_N = (_apart(F - corner, size) for corner in (A, B, 0.0, d))
    with np.errstate(all="ignore"):
        rho = -_real_ratio(to_A * np.conj(to_M), to_B * np.conj(to_N))
        excess = -_real_ratio(to_B * np.conj(to_A), to_N * np.conj(to_M))
        completion = np.where(np.abs(excess) * d >= c, 1.0, 2.0)  # the roots have the product (c/d)^2
    design = {"a": a, "b": b, "c": c, "d": d, "rho": rho, "completion": completion}
    return construction(design, {"phi": phi, "branch": branch}, by, 1.0 + excess)


def _apart(vector: Any, size: Any) -> Any:
    """Return a vector from a corner to F over a size, 0 where F is the corner but for roundings."""
    vector = vector / size
    return np.where(np.abs(vector) <= 8.0 * UNIT_ROUNDING, 0.0, vector)


def _real_ratio(above: Any, below: Any) -> Any:
    """Return a ratio that is real but for roundings; infinite over 0."""
    size = np.abs(below)
    real = (above * np.conj(below)).real
    return np.where((size == 0.0) & (above != 0.0), np.inf, np.copysign(np.abs(above) / size, real))


def ratio_of_share(share: Any) -> Any:
    """Return rho of MS over MN."""
    with np.errstate(divide="ignore"):
        return share / (1.0 - share)


def construction(
    design: dict[str, Any], position: dict[str, Any], by: str, lambda_: Any = None
) -> Construction:
    """Return a design by rho as one by another ratio, with its lengths, angles and joints in a position."""
    if by != "rho":
        design = _by_other_ratio(design, by, lambda_)
    names = [name for name in (*LENGTHS, *ANGLES, *DRIVE, *JOINTS) if name not in design]
    values = evaluate("focal", names, **design, **position, allow_invalid=True)
    return Construction(design, position, values | {by: design[by]})


def _by_other_ratio(design: dict[str, Any], by: str, lambda_: Any) -> dict[str, Any]:
    """Return a design by s or lambda instead of rho."""
    rho, completion, a, b, d = (design[name] for name in ("rho", "completion", "a", "b", "d"))
    bars = {name: design[name] for name in "abcd"}
    with np.errstate(all="ignore"):
        if by == "s":
            share = np.where(np.abs(rho) > 1.0, 1.0 / (1.0 + 1.0 / rho), rho / (1.0 + rho))
            return bars | {"s": d * share, "completion": completion}
        if lambda_ is None:
            lambda_ = evaluate("focal", ["lambda_"], **design, phi=0.0, allow_invalid=True)["lambda_"]
        # of a given lambda the roots of rho have the product (a/b)^2
        return bars | {"lambda_": lambda_, "completion": np.where(np.abs(rho) * b >= a, 1.0, 2.0)}


# -- Conics that touch the four lines of a position of the four-bar, and the pairs of tangents from a point

# With M, N, A, B as complex numbers, the conics that touch MA, AB, BN and NM are one for each real t, and
# its foci are the roots of
#
#     (1 - t)(f - M)(f - B) + t (f - A)(f - N) = 0:
#
# the equation in lines of a conic is that of its foci for the lines through a circular point, it is linear
# in t, and the conics t = 0 and t = 1 are the pairs of points M, B and A, N (Wunderlich, section 5).


#: What t is, for messages.
PARAMETER = papers.number("t", "number of the conic")
#: One of the double rays, for the shape of the points.
RAY = papers.number("first", "direction of a double ray", "rad")


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
    t : float or array_like, optional
        Numbers of conics: 0 and 1 are the pairs of points M, B and A, N, and the centre goes in proportion to t from
        the middle of MB to that of AN. Towards infinity the conics become the parabola.
    x, y : float or array_like, optional
        Instead of t one focus, origin in M and x along MN [m]; of points off the focal cubic the nearest point of it.

    Returns
    -------
    InscribedConic
        NaN where the four-bar does not assemble.

    Examples
    --------
    One of the kite with M = (0, 0), A = (0, 1), B = (3, 3), N = (1, 0):

    >>> side = np.sqrt(13.0)
    >>> conic = fl.focal.inscribed_conics(1.0, side, side, 1.0, np.pi / 2, branch=2, t=0.75)
    >>> [round(float(value), 4) for value in (conic.x1, conic.y1, conic.x2, conic.y2)]
    [1.183, 1.183, 0.317, 0.317]
    """
    further = _number_or_focus(t, x, y)
    arrays = read_position("inscribed_conics", a, b, c, d, phi, branch, further=further)
    position, N = arrays[:6], arrays[3]
    A, B = corners(position)
    if t is not None:
        return _conic(A, B, N, arrays[6])
    focus = nearest_point(position, arrays[6] + 1j * arrays[7])
    return _conic(A, B, N, _number(A, B, N, focus), focus)


def _number_or_focus(t: Any, x: Any, y: Any) -> list[tuple[Input, Any]]:
    """Return the declarations of what is given with its values: t, or the coordinates of a focus."""
    missing = [name for name, value in (("x", x), ("y", y)) if value is None]
    if (t is None) == bool(missing) or (t is not None and len(missing) < 2):
        names = "x and y" if len(missing) != 1 else missing[0]
        lacks = "and t are missing" if len(missing) > 1 else "is missing"
        what = f"{names} {'are given together' if t is not None else lacks}"
        raise InputError(what, ("inscribed_conics",), "give t=..., or a focus x=..., y=...")
    return [(PARAMETER, t)] if missing else [(point("x"), x), (point("y"), y)]


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
    ):  # NaN where the four-bar does not assemble, or beyond the range of doubles
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
        declared = [papers.number("direction", "direction of a ray", "rad"), RAY]
        angle, _ = papers.broadcast("partner", declared, direction, self.first, gaps=True)
        xx, xy, yy = self._double
        x, y = np.cos(angle), np.sin(angle)
        return _direction(-(xy * x + yy * y), xx * x + xy * y)

    def tangents(self, t: Any) -> tuple[Any, Any]:
        """Return the directions of both tangents to the conic of number t [rad]; NaN where they are not real."""
        t, _ = papers.broadcast("tangents", [PARAMETER, RAY], t, self.first, gaps=True)
        _, of_one, of_other = _shares(t)
        return _rays(*(of_one * one + of_other * other for one, other in zip(*self._forms, strict=True)))


@door
def involution(a: Any, b: Any, c: Any, d: Any, phi: Any, branch: Any = 1, *, x: Any, y: Any) -> Involution:
    """Return the involution of the tangents from a point to the conics in a position of MABN.

    Two rays through the point (x, y) are paired if they are the tangents to one of the conics that touch MA, AB, BN
    and NM (Desargues); the rays to M and B are a pair, and those to A and N.

    Parameters
    ----------
    x, y : float or array_like
        The point [m], origin in M and x along MN.

    Returns
    -------
    Involution
        NaN where the four-bar does not assemble.

    Examples
    --------
    At F of Figure 4, a point of the focal cubic, pairs have common bisectors, here at 45 degrees:

    >>> rays = fl.focal.involution(5.0, 5.0, 2.0, 4.0, np.arccos(0.2), branch=2, x=2.0, y=0.449489742783178)
    >>> np.degrees([rays.first, rays.second]).round(9), bool(abs(rays.asymmetry) < 1e-15)
    (array([-45.,  45.]), True)
    >>> to_M, to_B = np.arctan2([0.449489742783178, 4.449489742783178], [2.0, 1.0])
    >>> round(float(rays.partner(to_M) - to_B), 9)
    0.0
    """
    further = ((point("x"), x), (point("y"), y))
    *position, x, y = read_position("involution", a, b, c, d, phi, branch, further=further)
    A, B = corners(position)
    G, N = x + 1j * y, position[3]
    size = np.max(np.abs([A, B, G, N + 0j]), axis=0)
    with np.errstate(invalid="ignore"):  # NaN, where the four-bar does not assemble
        M_G, N_G, A_G, B_G = (-G / size, (N - G) / size, (A - G) / size, (B - G) / size)
    return Involution(_pair(M_G, B_G), _pair(A_G, N_G))


def _pair(one: Any, other: Any) -> tuple[Any, Any, Any]:
    """Return the quadratic form p x^2 + 2 q x y + r y^2 that vanishes along two vectors."""
    middle = -0.5 * (one.imag * other.real + one.real * other.imag)
    return one.imag * other.imag, middle, one.real * other.real


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


# -- Find the point of a focal cubic from which a crank drives the four-bar best


LEAST_ANGLE = "transmission_angle_PQ_least"
#: Supports that are compared between the limits, next to the best one, and how often: 8 times as closely each time.
SAMPLES_OF_DRIVES, FEW, ROUNDS = 129, 17, 14
#: Designs that are searched at once.
BLOCK_OF_DRIVES = 1000


@door
def best_point(
    a: Any, b: Any, c: Any, d: Any, phi: Any, branch: Any = 1, *, between: Any = (0.1, 0.9), by: str = "rho"
) -> Construction:
    """Find the joint F from which a crank drives a four-bar with the best transmission angle.

    It is the point of the focal cubic of the position whose crank SF turns fully, and whose least transmission angle
    at P and Q over the whole turn, ``transmission_angle_PQ_least``, is the greatest. The transmission angle at F is
    that of the rockers MA and NB alone, whatever F is. phi decides where F is, but not which crank is best.

    Parameters
    ----------
    between : (float, float)
        The least and greatest MS over MN: where the support S may stand, M being at 0 and N at 1.
    by : {"rho", "s", "lambda_"}
        The input that the design has beside ``completion``.

    Returns
    -------
    Construction
        NaN, and ``values["status"]`` is ``invalid_input``, where no crank between the limits turns fully: only
        four-bars of Grashof's kind have one, every double rocker and double crank among them.

    Notes
    -----
    Both completions of 129 supports are compared, then supports ever closer to the best one: to 1e-14 of the range
    where the angles of both ends of the stroke are equal, to 1e-8 where one of them is stationary.

    Examples
    --------
    >>> best = fl.focal.best_point(4.0, 5.0, 2.0, 4.0, 1.2, branch=2)
    >>> {name: round(float(best.values[name]), 3) for name in ("s", "r", "m", "n", "p", "q")}
    {'s': 3.135, 'r': 0.307, 'm': 0.487, 'n': 0.609, 'p': 3.112, 'q': 0.687}
    >>> round(float(np.degrees(best.values["transmission_angle_PQ_least"])), 1)
    50.6
    """
    check_choice(("best_point", "by"), by, RATIOS)
    limits = ends_of("best_point", "between", between, "1", ("write ", Pair(), " with lo < hi"))
    position = read_position("best_point", a, b, c, d, phi, branch)
    a, b, c, d, phi, branch = position
    bars = np.stack([np.ravel(length) for length in (a, b, c, d)])
    blocks = papers.blocks(max(bars.shape[1], 1), BLOCK_OF_DRIVES)
    found = np.concatenate([_best(bars[:, block], limits) for block in blocks], axis=1)
    share, completion = found.reshape(2, *np.shape(a))
    design = {"a": a, "b": b, "c": c, "d": d, "rho": ratio_of_share(share), "completion": completion}
    return construction(design, {"phi": phi, "branch": branch}, by)


def _best(bars: Any, limits: tuple[float, float]) -> Any:
    """Return the shares of the best supports and their completions, NaN without a crank that turns fully."""
    first, last = (np.full(bars.shape[1], limit) for limit in limits)
    shares = np.linspace(first, last, SAMPLES_OF_DRIVES)
    angles = np.stack([_least_angles(bars, shares, completion) for completion in (1.0, 2.0)])
    completion = np.where(angles[0].max(axis=0) >= angles[1].max(axis=0), 1.0, 2.0)
    angles = np.where(completion == 1.0, *angles)
    for _ in range(ROUNDS):
        step = (last - first) / (len(shares) - 1)
        share = np.take_along_axis(shares, angles.argmax(axis=0)[None], axis=0)[0]
        first, last = np.maximum(share - step, limits[0]), np.minimum(share + step, limits[1])
        shares = np.linspace(first, last, FEW)
        angles = _least_angles(bars, shares, completion)
    share = np.take_along_axis(shares, angles.argmax(axis=0)[None], axis=0)[0]
    return np.stack([np.where(angles.max(axis=0) > 0.0, share, np.nan), completion])


def _least_angles(bars: Any, shares: Any, completion: Any) -> Any:
    """Return the least transmission angle of each support, -1 where there is no crank."""
    a, b, c, d = bars
    rho = ratio_of_share(shares)
    given = {"rho": rho, "completion": completion, "phi": 0.0, "allow_invalid": True}
    angles = evaluate("focal", [LEAST_ANGLE], a=a, b=b, c=c, d=d, **given)[LEAST_ANGLE]
    return np.where(np.isnan(angles), -1.0, angles)


# -- The five-bar MPFQN of section 1: free, with two inputs, and with Hart's condition, by which it has a
#    four-bar


#: The bars by the names of their lengths.
BARS = {"m": "MP", "p": "PF", "q": "FQ", "n": "QN", "d": "MN"}
#: MF is at least this of the longest bar: what is shorter moves F by less than any rounding.
SHORTEST = 2.0**-100


def _bars(names: str, rule: Literal["positive", "any"] = "positive") -> list[Input]:
    """Return the declarations of bars; d is always a length."""
    return [
        papers.number(name, f"length {BARS[name]}", "m", "positive" if name == "d" else rule)
        for name in names
    ]


@door
def five_bar(
    m: Any, p: Any, q: Any, n: Any, d: Any, phi: Any, *, omega_angle: Any, branch: Any = 1
) -> dict[str, Any]:
    """Return positions of the free five-bar MPFQN, which has two inputs.

    Parameters
    ----------
    m, p, q, n, d : float or array_like
        Lengths of MP, PF, FQ, QN and MN [m], broadcast with the inputs.
    phi : float or array_like
        Direction of MP, seen from MN [rad].
    omega_angle : float or array_like
        The angle omega of MP and PF at P: F = exp(i phi)(m - p exp(i omega)) [rad].
    branch : int or array_like
        1: Q to the right of the directed line from F to N; 2: to the left.

    Returns
    -------
    dict of str to ndarray
        ``P_x``, ``P_y``, ``F_x``, ``F_y``, ``Q_x``, ``Q_y`` [m], ``psi`` (the direction of NQ) and ``angle_FQN`` in 0
        to pi [rad]. Q is NaN where FQ and QN do not reach from F to N.

    Notes
    -----
    F comes from M by two bars, Q is where circles about F and N meet (eqs. (1.2) to (1.4) with another angle at Q).
    Hart's condition (1.1) takes one freedom: where ``angle_FQN`` is pi - omega, F lies on the circle about S.
    With omega fixed it is the four-bar of a1 = MF, a2 = q, a3 = n, a4 = d, a ``planar_4r`` for `fastlink.sweep`.

    Examples
    --------
    The five-bar of Figure 4, where omega and the angle at Q are right angles:

    >>> m, p = 0.8404082057734577, 1.8696938456699069
    >>> at = fl.focal.five_bar(m, p, p, m, 4.0, np.arccos(0.2), omega_angle=np.pi / 2, branch=[1, 2])
    >>> at["F_x"].round(9), at["F_y"].round(9), np.degrees(at["angle_FQN"]).round(9)
    (array([2., 2.]), array([0.44948974, 0.44948974]), array([90., 90.]))
    """
    directions = {"phi": "direction of MP", "omega_angle": "angle of MP and PF"}
    angles = (papers.number(name, meaning, "rad") for name, meaning in directions.items())
    declared = [*_bars("mpqnd"), *angles, MODE]
    given = (m, p, q, n, d, phi, omega_angle, like(branch, branch_codes(planar_4r, branch)))
    m, p, q, n, d, phi, omega_angle, branch = arrays = papers.broadcast("five_bar", declared, *given)
    papers.check_lengths("five_bar", declared, arrays, "four lengths")
    u = np.exp(1j * phi)
    P = m * u
    # m - p + p (1 - w), in which the first difference alone cancels
    half = np.sin(0.5 * omega_angle)
    F = u * ((m - p) + 2.0 * p * half * (half - 1j * np.cos(0.5 * omega_angle)))
    longest = np.max([m, p, q, n, d], axis=0)
    reach = np.maximum(np.abs(F), SHORTEST * longest)
    four_bar = {"a1": reach, "a2": q, "a3": n, "a4": d, "theta1": np.angle(F), "branch": branch}
    rest = evaluate("planar_4r", ["B_x", "B_y", "theta4", "transmission_angle"], **four_bar)
    Q_x, Q_y, psi, angle = (np.asarray(value) for value in rest.values())
    joints = {"P_x": P.real, "P_y": P.imag, "F_x": F.real, "F_y": F.imag, "Q_x": Q_x, "Q_y": Q_y}
    return {**joints, "psi": psi, "angle_FQN": angle}


@door
def from_five_bar(m: Any, n: Any, p: Any, q: Any, d: Any) -> dict[str, Any]:
    r"""Return the focal mechanism of a five-bar MPFQN whose angles at P and Q have the sum pi.

    Parameters
    ----------
    m, n, p, q : float or array_like
        Lengths of MP, NQ, PF and QF [m], broadcast, with the signs of eqs. (1.3) and (1.4): m and p, n and q, or p and
        q may change theirs together.
    d : float or array_like
        Length of MN [m].

    Returns
    -------
    dict of str to ndarray
        The inputs ``a``, ``b``, ``c``, ``d``, ``rho``, ``completion`` of ``focal``, as `fastlink.sweep` takes them; c
        is NaN where the five-bar never assembles.

    Notes
    -----
    Eq. (2.6), lambda = (m n + p q)/(m n), a = lambda m, b = lambda n, and with its sums made products

    .. math:: (m n)^2 c^2 = (m n + p q)(m p + n q)(m q + n p) - m n p q\,d^2.

    Examples
    --------
    >>> m, p = 0.8404082057734577, 1.8696938456699069
    >>> design = fl.focal.from_five_bar(m, m, p, p, 4.0)
    >>> {name: round(float(value), 9) for name, value in design.items()}
    {'a': 5.0, 'b': 5.0, 'c': 2.0, 'd': 4.0, 'rho': 1.0, 'completion': 1.0}
    >>> round(float(fl.evaluate("focal", ["r"], **design, phi=1.0)["r"]), 4)
    0.4495
    """
    declared = _bars("mnpqd", "any")
    m, n, p, q, d = papers.broadcast("from_five_bar", declared, m, n, p, q, d)
    sizes = [np.abs(length) for length in (m, n, p, q, d)]
    papers.check_lengths("from_five_bar", _bars("mnpqd"), sizes, "four lengths")
    size = 2.0 ** np.ceil(np.log2(np.max(sizes, axis=0)))
    m, n, p, q, d = (length / size for length in (m, n, p, q, d))
    with np.errstate(all="ignore"):
        excess = (p / m) * (q / n)
        lambda_ = (m * n + p * q) / (m * n)
        c = np.sqrt(lambda_ * (p / n + q / m) * (m * q + n * p) - excess * (d * d))
        completion = np.where(np.abs(excess) * d >= c, 1.0, 2.0)
        rho = (m / n) * (p / q)
        bars = {"a": np.abs(lambda_ * m), "b": np.abs(lambda_ * n), "c": c, "d": d}
    return {name: bar * size for name, bar in bars.items()} | {"rho": rho, "completion": completion}


# -- Exchange the ground for the coupler: the focal mechanism with AB held fixed (Wunderlich, section 3)


@door(hint="inputs are given by name, such as a=5.0, or as one mapping")
def held_at_AB(design: Any = None, **inputs: Any) -> dict[str, Any]:
    """Return the focal mechanism that a focal mechanism is with AB held fixed.

    Its M, N, A, B, S, T are A, B, M, N, T, S of the other one; P, Q and F stay.

    Parameters
    ----------
    design, **inputs
        Inputs of ``focal`` in a mapping, pandas.DataFrame or xarray.Dataset, or by name: ``a``, ``b``, ``c``, ``d``,
        one of ``rho``, ``s`` and ``lambda_``, and ``completion`` unless it is to be both. Others are not read.

    Returns
    -------
    dict of str to ndarray
        The same inputs of the mechanism that stands on AB, as `fastlink.sweep` takes them.

    Notes
    -----
    c and d are exchanged, rho stays, lambda becomes lambda/(lambda - 1), and so completions by rho or s are exchanged.
    Where the one is at phi and psi, with AB in the direction theta, the other is at phi + pi - theta, in branch 1 where
    sin(psi) > 0, else in branch 2. `F_along_AB`, `F_across_AB` and their like are quantities of the first.

    Examples
    --------
    >>> chebyshev = {"a": 5.0, "b": 5.0, "c": 2.0, "d": 4.0, "rho": 1.0, "completion": 1}
    >>> held = fl.focal.held_at_AB(chebyshev)
    >>> {name: float(value) for name, value in held.items()}
    {'a': 5.0, 'b': 5.0, 'c': 4.0, 'd': 2.0, 'rho': 1.0, 'completion': 2.0}
    >>> radius = fl.evaluate("focal", ["r"], **held, phi=1.0)["r"]  # F runs on a circle about T
    >>> bool(radius == fl.evaluate("focal", ["FT"], **chebyshev, phi=1.0)["FT"])
    True
    """
    bars, optional = ("a", "b", "c", "d"), (*RATIOS, "completion")
    given = papers.read_design("held_at_AB", focal, design, inputs, bars, optional=optional)
    by = next((name for name in RATIOS if name in given), "")
    if not by:
        what = f"{', '.join(RATIOS[:-1])} and {RATIOS[-1]} are missing"
        raise InputError(what, ("held_at_AB",), "give one of them")
    ratio, completion = given[by], given.get("completion")
    with np.errstate(all="ignore"):
        held = {"rho": ratio, "s": ratio / given["d"] * given["c"], "lambda_": 1.0 + 1.0 / (ratio - 1.0)}[by]
    found = {"a": given["a"], "b": given["b"], "c": given["d"], "d": given["c"], by: held}
    if completion is not None:
        found["completion"] = completion if by == "lambda_" else 3.0 - completion
    return found


# -- Fit a straight line to the path of a joint, and measure the deviation


class StraightLine(NamedTuple):
    """A line through given points, and their distances from it.

    Attributes
    ----------
    x, y : ndarray
        A point of the line: the centre of the points [m].
    direction : ndarray
        Its direction, in (-pi/2, pi/2] [rad].
    deviation : ndarray
        Distance of each point to the left of it [m]; NaN where the point is.
    """

    x: Any
    y: Any
    direction: Any
    deviation: Any


def _fitted_line(x: Any, y: Any) -> StraightLine:
    """Return the line of least squares for each row of points; NaN is skipped."""
    finite = np.isfinite(x) & np.isfinite(y)
    count = np.where(finite.any(axis=-1), finite.sum(axis=-1), np.nan)
    # over a power of two, so that no sum and no difference leaves the range of doubles
    x, y = (np.where(finite, values, 0.0) for values in (x, y))
    scale = np.frexp(np.maximum(abs(x), abs(y)).max(axis=-1, initial=0.0))[1]
    x, y = (np.ldexp(values, -scale[..., None]) for values in (x, y))
    middle_x, middle_y = (values.sum(axis=-1) / count for values in (x, y))
    along = np.where(finite, x - middle_x[..., None], 0.0)
    across = np.where(finite, y - middle_y[..., None], 0.0)
    # and so that no square does
    power = np.frexp(np.maximum(abs(along), abs(across)).max(axis=-1, initial=0.0))[1]
    along, across = (np.ldexp(values, -power[..., None]) for values in (along, across))
    squares = ((along - across) * (along + across)).sum(axis=-1)
    direction = 0.5 * np.arctan2(2.0 * (along * across).sum(axis=-1), squares) + 0.0 * middle_x
    cosine, sine = np.cos(direction)[..., None], np.sin(direction)[..., None]
    with np.errstate(over="ignore"):  # points beyond 1e308 may be farther off than a double says
        deviation = np.ldexp(across * cosine - along * sine, (power + scale)[..., None])
    middle_x, middle_y = (np.ldexp(values, scale) for values in (middle_x, middle_y))
    return StraightLine(middle_x, middle_y, direction, np.where(finite, deviation, np.nan))


@door
def straight_line(x: Any, y: Any) -> StraightLine:
    """Return the straight line whose sum of squared distances from points is least.

    Parameters
    ----------
    x, y : array_like
        Points [m] in the last axis, such as T_x and T_y over phi or sigma. NaN is skipped.

    Returns
    -------
    StraightLine
        One line for each row of points; NaN without points.

    Notes
    -----
    `T_deviation` computes the distances for a map. The greatest distance is
    ``abs(line.deviation).max(axis=-1)``; `fastlink.planar.straightness` is the half-width of the narrowest strip, which
    is less.

    Examples
    --------
    Chebyshev's linkage with the midpoint T of its coupler, over a whole turn of the crank:

    >>> sigma = np.arange(360) * np.pi / 180.0
    >>> design = {"a": 5.0, "b": 5.0, "c": 2.0, "d": 4.0, "rho": 1.0, "completion": 1}
    >>> path = fl.evaluate("focal", ["T_x", "T_y"], input="sigma", sigma=sigma, **design)
    >>> line = fl.focal.straight_line(path["T_x"], path["T_y"])
    >>> round(float(line.y), 4), round(float(np.abs(line.deviation).max()), 4)
    (4.2537, 0.6453)
    """
    return _fitted_line(*papers.broadcast_points("straight_line", x, y))


@door
def T_deviation(maps: Any) -> Any:
    """Return the distance of T from the straight line that fits its path best.

    Parameters
    ----------
    maps : xarray.Dataset or path
        A sweep of ``"focal"`` with ``T_x`` and ``T_y``, by either input, or its file.

    Returns
    -------
    xarray.DataArray
        In the units of ``T_x``; positive to the left of the line, whose direction is in (-pi/2, pi/2]. NaN where the
        mechanism does not assemble. Each design and branch has a line of its own, through all its positions.

    Examples
    --------
    >>> part = fl.sweep(
    ...     "focal",
    ...     fl.grid(a=5.0, b=5.0, c=2.0, d=4.0, rho=1.0, completion=1),
    ...     ["T_x", "T_y"],
    ...     input="sigma",
    ...     sigma=np.linspace(3.23, 6.19, 200),
    ...     branch=1,
    ... )
    >>> print(f"within {float(abs(fl.focal.T_deviation(part)).max()):.4f} m of a straight line")
    within 0.0140 m of a straight line
    """
    with as_dataset(maps) as dataset:
        for name in ("T_x", "T_y"):
            if name not in dataset.data_vars:
                remedy = "sweep 'T_x' and 'T_y', and give the whole result"
                raise InputError(f"{name!r} is missing", where=("T_deviation", "maps"), remedy=remedy)
        path, height = dataset["T_x"], dataset["T_y"]
        along = [str(dim) for dim in path.dims if dim in ("phi", "sigma")]
        if len(along) != 1 or set(path.dims) != set(height.dims):
            remedy = "sweep it over phi or sigma, and give the whole result"
            raise InputError("'T_x' has no positions", ("T_deviation", "maps"), remedy)
        units = path.attrs.get("units", "m")
        if height.attrs.get("units", "m") != units:
            what = f"'T_x' is in {units}, 'T_y' in {height.attrs['units']}"
            raise InputError(what, ("T_deviation", "maps"), "give both in the same units")
        path = path.transpose(..., *along)
        values = _fitted_line(path.values, height.transpose(*path.dims).values).deviation
    deviation = path.copy(data=values).rename("T_deviation")
    meaning = "Distance of T from its straight line"
    deviation.attrs = {"units": units, "long_name": meaning, "symbol": "delta_T"}
    return deviation
