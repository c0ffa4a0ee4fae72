"""Truncated power series of the drive, and Newton's iteration on equations between them.

Numbers are those of a context, `MPContext` of mpmath or one with the same functions: real and complex numbers, `mpf`,
`mpc`, `sqrt`, `cos_sin`, `exp`, `atan2`. Derivatives follow from the equations themselves: no formula of a rate
stands anywhere.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from math import factorial
from typing import TYPE_CHECKING, Any

from mpmath import MPContext

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = [
    "CIRCLES",
    "MEETING",
    "SEEN",
    "Link",
    "Open",
    "Position",
    "Series",
    "Singular",
    "angle_between",
    "argument",
    "bar_data",
    "between_rockers",
    "by_F",
    "circles",
    "closed",
    "closing",
    "context",
    "coordinates",
    "corner",
    "cross",
    "exponential",
    "meeting",
    "points",
    "polygon",
    "reactions",
    "rotation",
    "seen_from_AB",
    "solved",
    "triangle_angle",
    "unit_vector",
    "wrapped",
]


MOST_STEPS = 12
#: Of so many roundings of its terms a value may come that vanishes, where two links are in line.
ROUNDINGS = 64
#: So many square roots of a rounding an angle may be off there.
IN_LINE = 1024


@lru_cache(maxsize=8)
def context(digits: int) -> Any:
    """Return numbers of so many digits, whatever precision others set for theirs."""
    ctx = MPContext()
    ctx.dps = digits
    return ctx


class Open(ArithmeticError):
    """The loop does not close: there is no such configuration."""


class Singular(ArithmeticError):
    """The equations do not determine the unknowns, at a toggle or where joints coincide."""


def closed(ctx: Any, value: Any, size: Any, otherwise: str) -> Any:
    """Return a value that is not negative where a loop closes: 0 where it is so but for the rounding of its terms."""
    if not value < 0:
        return value
    if value < -ROUNDINGS * ctx.eps * size:
        raise Open(otherwise)
    return 0 * value


def of_rounding(ctx: Any, value: Any, size: Any) -> bool:
    """Tell whether a value may differ from 0 by rounding alone, where its terms are of a size and links in line."""
    return bool(abs(value) <= _rounding_in_line(ctx) * size)


def _rounding_in_line(ctx: Any) -> Any:
    """Return the rounding of an angle where links are in line: it is known to the root of that of its cosine."""
    return IN_LINE * ctx.sqrt(ctx.mpf(ctx.eps))


class Series:
    """A truncated power series, by its terms.

    Examples
    --------
    >>> square = Series((3.0, 1.0, 0.0)) * Series((3.0, 1.0, 0.0))
    >>> square.terms, square.derivative(2)
    ((9.0, 6.0, 1.0), 2.0)
    """

    __slots__ = ("terms",)

    def __init__(self, terms: Iterable[Any]) -> None:
        self.terms = tuple(terms)

    def derivative(self, order: int) -> Any:
        """Return a derivative where the drive is 0."""
        return self.terms[order] * factorial(order)

    def differentiated(self) -> Series:
        """Return the series of the derivative, which has one term less."""
        return Series(k * term for k, term in enumerate(self.terms[1:], 1))

    def __add__(self, other: Any) -> Series:
        if isinstance(other, Series):
            return Series([a + b for a, b in zip(self.terms, other.terms, strict=False)])
        return Series((self.terms[0] + other, *self.terms[1:]))

    __radd__ = __add__

    def __neg__(self) -> Series:
        return Series([-term for term in self.terms])

    def __sub__(self, other: Any) -> Series:
        return self.__add__(-other)

    def __rsub__(self, other: Any) -> Series:
        return self.__neg__().__add__(other)

    def __mul__(self, other: Any) -> Series:
        if not isinstance(other, Series):
            return Series([term * other for term in self.terms])
        count = min(len(self.terms), len(other.terms))
        return Series([_convolved(self.terms, other.terms, k) for k in range(count)])

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Series:
        if not isinstance(other, Series):
            return Series(term / other for term in self.terms)
        quotient: list[Any] = []
        for k in range(min(len(self.terms), len(other.terms))):
            known = sum(quotient[i] * other.terms[k - i] for i in range(k))
            quotient.append((self.terms[k] - known) / other.terms[0])
        return Series(quotient)

    def __rtruediv__(self, other: Any) -> Series:
        one = Series((other, *(0 * term for term in self.terms[1:])))
        return one.__truediv__(self)

    def at_speed(self, rate: Any, acceleration: Any = 0) -> Series:
        """Return the series in time where the drive is rate t + acceleration t^2/2."""
        drive = Series((0 * rate, rate, acceleration / 2, 0 * rate)[: len(self.terms)])
        total = Series((self.terms[-1], *(0 * rate for _ in self.terms[1:])))
        for term in self.terms[-2::-1]:
            total = total * drive + term
        return total

    @property
    def real(self) -> Series:
        """The real part."""
        return Series(term.real for term in self.terms)

    @property
    def imag(self) -> Series:
        """The imaginary part."""
        return Series(term.imag for term in self.terms)


def _convolved(a: Sequence[Any], b: Sequence[Any], k: int) -> Any:
    total = a[0] * b[k]
    for i in range(1, k + 1):
        total += a[i] * b[k - i]
    return total


def _exponential(first: Any, exponent: Series) -> Series:
    """Return the exponential of a series from its first term, by its differential equation."""
    terms = [first]
    for k in range(1, len(exponent.terms)):
        terms.append(sum(i * exponent.terms[i] * terms[k - i] for i in range(1, k + 1)) / k)
    return Series(terms)


def exponential(ctx: Any, exponent: Series) -> Series:
    """Return e^x of a series x."""
    return _exponential(ctx.exp(exponent.terms[0]), exponent)


def rotation(ctx: Any, angle: Series) -> Series:
    """Return the direction e^(i x) of a series x, a complex number of size 1."""
    return _exponential(unit_vector(ctx, angle.terms[0]), angle * ctx.mpc(0, 1))


def unit_vector(ctx: Any, angle: Any) -> Any:
    """Return the complex number of size 1 of an angle."""
    return ctx.mpc(*ctx.cos_sin(angle))


def linear_solution(rows: Sequence[Sequence[Any]], least: Any = 0) -> list[Any]:
    """Solve a linear system by LU with partial pivoting.

    Examples
    --------
    >>> linear_solution([[0.0, 2.0, 4.0], [1.0, 1.0, 5.0]])
    [3.0, 2.0]
    """
    table = [list(row) for row in rows]
    size = len(table)
    for k in range(size):
        pivot = max(range(k, size), key=lambda r: abs(table[r][k]))
        table[k], table[pivot] = table[pivot], table[k]
        if abs(table[k][k]) <= least:
            raise Singular("the matrix of the equations is singular")
        for row in table[k + 1 :]:
            if row[k] != 0:
                factor = row[k] / table[k][k]
                for c in range(k + 1, size + 1):
                    if table[k][c] != 0:
                        row[c] -= factor * table[k][c]
    unknowns: list[Any] = [None] * size
    for k in reversed(range(size)):
        known = sum(table[k][c] * unknowns[c] for c in range(k + 1, size) if table[k][c] != 0)
        unknowns[k] = (table[k][size] - known) / table[k][k]
    return unknowns


Equations = Callable[[list[Series], Series], list[Series]]


def solved(ctx: Any, equations: Equations, start: Sequence[Any], drive: Series) -> list[Series]:
    """Solve equations by Newton's iteration, and for the series of their unknowns, term by term."""
    values = list(start)
    enough = ctx.mpf(10) ** -(6 * ctx.dps // 10)
    for _ in range(MOST_STEPS):
        matrix, residuals = _linearized(equations, values, drive)
        steps = linear_solution([[*row, -r] for row, r in zip(matrix, residuals, strict=True)])
        values = [value + step for value, step in zip(values, steps, strict=True)]
        if all(abs(step) <= enough * (1 + abs(value)) for step, value in zip(steps, values, strict=True)):
            break
    else:
        raise Singular("Newton's iteration does not converge")
    unknowns = [Series((value,)) for value in values]
    least = _rounding_in_line(ctx) * max(abs(entry) for row in matrix for entry in row)
    for k in range(1, len(drive.terms)):
        guess = [Series((*x.terms, 0 * x.terms[0])) for x in unknowns]
        found = equations(guess, Series(drive.terms[: k + 1]))
        rows = [[*row, -one.terms[k]] for row, one in zip(matrix, found, strict=True)]
        further = linear_solution(rows, least)
        unknowns = [Series((*x.terms, term)) for x, term in zip(unknowns, further, strict=True)]
    return unknowns


def _linearized(
    equations: Equations, values: Sequence[Any], drive: Series
) -> tuple[list[list[Any]], list[Any]]:
    """Return the matrix of derivatives by the unknowns, and the residuals."""
    zero = 0 * drive.terms[0]
    held = Series((drive.terms[0], zero))
    columns = []
    for i in range(len(values)):
        moved = [Series((value, zero + (k == i))) for k, value in enumerate(values)]
        columns.append(equations(moved, held))
    matrix = [[column[row].terms[1] for column in columns] for row in range(len(values))]
    return matrix, [one.terms[0] for one in columns[0]]


# -- Newton's and Euler's laws of a chain of links, as the linear system of Hayes, Hninn, Irani, eq. (9)


def cross(one: Any, other: Any) -> Any:
    """Return the cross product of two vectors, given as complex numbers."""
    return one.real * other.imag - one.imag * other.real


@dataclass
class Link:
    """A link as point masses and a moment of inertia, with its loads and its joints.

    Attributes
    ----------
    masses : list of (mass, Series)
        Its own mass at its mass centre first, then its counterweight, as curves of time.
    spin : number
        Moment of inertia times angular acceleration.
    centre : complex number
        The mass centre of all masses.
    joints : list of (int, int, complex number)
        The number of the force in the joint, 1 or -1 as it or its reaction acts on the link, and where.
    torque : int, optional
        The number of an unknown torque on the link.
    loads : list of (complex number, complex number)
        Forces and where they act.
    load_torque : number
        A torque on the link.
    """

    masses: list[tuple[Any, Series]]
    spin: Any
    centre: Any
    joints: list[tuple[int, int, Any]]
    torque: int | None = None
    loads: list[tuple[Any, Any]] = field(default_factory=list)
    load_torque: Any = 0

    def rows(self, unknowns: int, gravity: Any) -> list[list[Any]]:
        """Return the equations of force, x and y, and of moment about the mass centre."""
        force, moment = -sum(load for load, _ in self.loads), self.spin - self.load_torque
        moment -= sum(cross(at - self.centre, load) for load, at in self.loads)
        for mass, place in self.masses:
            supplied = mass * (place.derivative(2) - gravity)
            force += supplied
            moment += cross(place.terms[0] - self.centre, supplied)
        rows: list[list[Any]] = [[0] * unknowns for _ in range(3)]
        for number, sign, at in self.joints:
            arm = at - self.centre
            rows[0][2 * number], rows[1][2 * number + 1] = sign, sign
            rows[2][2 * number], rows[2][2 * number + 1] = -sign * arm.imag, sign * arm.real
        if self.torque is not None:
            rows[2][self.torque] = 1
        for row, side in zip(rows, (force.real, force.imag, moment), strict=True):
            row.append(side)
        return rows


def reactions(links: Sequence[Link], further: Sequence[Sequence[Any]], gravity: Any) -> list[Any]:
    """Return the unknown forces, x and y of each, and the torque, by LU."""
    unknowns = 3 * len(links) + len(further)
    rows = [row for link in links for row in link.rows(unknowns, gravity)]
    return linear_solution([*rows, *further])


def bar_data(ctx: Any, at: Mapping[str, Any], number: int, length: Any) -> tuple[Any, Any, Any]:
    """Return mass, moment of inertia and mass centre of a link in its frame, given or those of a round bar."""
    mass = inertia = None
    if "density" in at and "radius" in at:
        mass = at["density"] * ctx.pi * at["radius"] ** 2 * length
    mass = at.get(f"m{number}", mass)
    if "radius" in at and mass is not None:
        inertia = mass * (length**2 / 12 + at["radius"] ** 2 / 4)
    inertia = at.get(f"I{number}", inertia)
    centre = ctx.mpc(at.get(f"G{number}_u", length / 2), at.get(f"G{number}_v", 0))
    if mass is None or inertia is None:
        raise LookupError(f"no mass of link {number}")
    return mass, inertia, centre


# -- Points and circles through the joints of Wunderlich's figures, and joints in the frame of AB, from
#    joints alone


#: Quantities by the order of the derivatives that they need.
MEETING = dict.fromkeys(("X_x", "X_y", "Y_x"), 0)
CIRCLES = {f"{name}_{part}": 0 for name in ("PFQX", "SFTY", "PSQT") for part in ("x", "y", "radius")}
SEEN = {f"{joint}_{way}_AB": 0 for joint in "MNSF" for way in ("along", "across")}


def _cross(one: Any, other: Any) -> Any:
    """Return the third component of the product of two vectors."""
    return one.real * other.imag - one.imag * other.real


def meeting(ctx: Any, A: Any, B: Any, d: Any) -> dict[str, Any]:
    """Return where MA and NB meet, and MN and AB, as far as they do."""
    found: dict[str, Any] = {}
    to_B = B - d
    sine = _cross(A, to_B)
    if not of_rounding(ctx, sine, abs(A) * abs(to_B)):
        X = A * (d * to_B.imag / sine)
        found |= {"X_x": X.real, "X_y": X.imag}
    if not of_rounding(ctx, B.imag - A.imag, abs(A.imag) + abs(B.imag)):
        found["Y_x"] = A.real - A.imag * (B.real - A.real) / (B.imag - A.imag)
    return found


def circles(ctx: Any, joints: Mapping[str, Any]) -> dict[str, Any]:
    """Return centre and radius of the circles whose first three points are known and not in line."""
    found: dict[str, Any] = {}
    for name in ("PFQX", "SFTY", "PSQT"):
        if any(joint not in joints for joint in name[:3]):
            continue
        one, two, three = (joints[joint] for joint in name[:3])
        to_two, to_three = two - one, three - one
        area = _cross(to_two, to_three)
        if of_rounding(ctx, area, abs(to_two) * abs(to_three)):
            continue
        # as far from the second and third point as from the first
        squares = (abs(to_two) ** 2, abs(to_three) ** 2)
        x = (squares[0] * to_three.imag - squares[1] * to_two.imag) / (2 * area)
        y = (squares[1] * to_two.real - squares[0] * to_three.real) / (2 * area)
        found |= {
            f"{name}_x": one.real + x,
            f"{name}_y": one.imag + y,
            f"{name}_radius": (x * x + y * y) ** 0.5,
        }
    return found


def seen_from_AB(joints: Mapping[str, Any], A: Any, B: Any) -> dict[str, Any]:
    """Return joints in the frame of AB."""
    found: dict[str, Any] = {}
    for name, joint in joints.items():
        seen = (joint - A) * (B - A).conjugate() / abs(B - A)
        found |= {f"{name}_along_AB": seen.real, f"{name}_across_AB": seen.imag}
    return found


# -- The closed polygon of four links: positions by circle and circle, then Newton's iteration on its
#    closure


def corner(ctx: Any, base: Any, first: Any, second: Any, side: int) -> Any:
    """Return the vector from the start of a base to the apex of the triangle over it."""
    square = base.real * base.real + base.imag * base.imag
    if square == 0:
        raise Singular("the ends of the base coincide")
    along = (square + first * first - second * second) / (2 * square)
    reach = first * first / square
    size = reach + abs(along) * (1 + reach + second * second / square)
    across = closed(ctx, reach - along * along, size, "the lengths do not make a triangle")
    return base * ctx.mpc(along, side * ctx.sqrt(across))


def polygon(ctx: Any, lengths: Sequence[Any], turn: Series, branch: int) -> list[Series]:
    """Return the directions of the four links of a closed polygon, as angles from that of the first link."""
    first, second, third, fourth = lengths
    to_start = -(first + second * unit_vector(ctx, turn.terms[0]))
    apex = corner(ctx, to_start, third, fourth, -1 if branch == 1 else 1)
    last = to_start - apex
    start = [ctx.atan2(one.imag, one.real) for one in (apex, last)]

    def closure(unknown: list[Series], drive: Series) -> list[Series]:
        end = first + second * rotation(ctx, drive)
        end = end + third * rotation(ctx, unknown[0]) + fourth * rotation(ctx, unknown[1])
        return [end.real, end.imag]

    return [0 * turn, turn, *solved(ctx, closure, start, turn)]


def wrapped(ctx: Any, angle: Any) -> Any:
    """Return an angle within (-pi, pi]."""
    cosine, sine = ctx.cos_sin(angle)
    return ctx.atan2(sine, cosine)


def angle_between(ctx: Any, one: Any, other: Any) -> Any:
    """Return the angle from one vector to another, within (-pi, pi]."""
    cross = one.real * other.imag - one.imag * other.real
    return ctx.atan2(cross, one.real * other.real + one.imag * other.imag)


def triangle_angle(ctx: Any, one: Any, other: Any, opposite: Any) -> Any:
    """Return the angle between two sides of a triangle; 0 or pi where it folds."""
    least = max((opposite - one + other) * (opposite + one - other), 0 * one)
    greatest = max((one + other - opposite) * (one + other + opposite), 0 * one)
    return 2 * ctx.atan2(ctx.sqrt(least), ctx.sqrt(greatest))


# -- Five-bar linkages with Hart's relation of angles: Wunderlich's (1.2) to (1.4), from which F follows

# M = 0, N = d, P = m u, Q = d + n v and F = P - p u w = Q + q v w, with u, v, w complex numbers of size 1.


@dataclass(frozen=True)
class Position:
    """Directions MP, NQ and e^(i omega), as series of the drive."""

    u: Series
    v: Series
    w: Series


def between_rockers(ctx: Any, lengths: Sequence[Any], phi: Series, branch: int) -> Series:
    """Return the direction of NB of a four-bar MABN where that of MA is given."""
    # traversed from N: what is an angle from NM to BN here is one from MN to NB
    return polygon(ctx, lengths, phi - ctx.pi, branch)[3]


def closing(bars: Mapping[str, Any], u: Series, v: Series) -> Position:
    """Return the position of the dyads where the directions of MP and NQ are given."""
    m, n, p, q, d = (bars[name] for name in "mnpqd")
    opening = p * u + q * v
    if opening.terms[0] == 0:
        raise Singular("PF and QF coincide")
    return Position(u, v, (m * u - n * v - d) / opening)


def by_F(
    ctx: Any, bars: Mapping[str, Any], joint_F: Callable[[Series], Series], drive: Series, omega_sign: int
) -> tuple[Position, list[Series]]:
    """Return the position where F is given, and the angles of MP and NQ."""
    m, n, p, q, d = (bars[name] for name in "mnpqd")
    F = joint_F(drive)
    at = F.terms[0]
    square = at.real * at.real + at.imag * at.imag
    cosine = (m * m + p * p - square) / (2 * m * p)
    size = (m * m + p * p + square) / abs(2 * m * p)
    sine_squared = closed(ctx, (1 - cosine) * (1 + cosine), size, "the dyad MPF does not reach F")
    omega = ctx.atan2(omega_sign * ctx.sqrt(sine_squared), cosine)
    seen = m - p * unit_vector(ctx, omega)

    def dyad(unknown: list[Series], drive: Series) -> list[Series]:
        missed = rotation(ctx, unknown[0]) * (m - p * rotation(ctx, unknown[1])) - joint_F(drive)
        return [missed.real, missed.imag]

    phi, turned = solved(ctx, dyad, (angle_between(ctx, seen, at), omega), drive)
    u, w = rotation(ctx, phi), rotation(ctx, turned)
    seen_from_N = n + q * w
    if seen_from_N.terms[0] == 0:
        raise Singular("F is N")
    v = (F - d) / seen_from_N
    return Position(u, v, w), [phi, argument(ctx, v)]


def argument(ctx: Any, vector: Series) -> Series:
    """Return the direction of a vector as an angle, over the drive."""
    first = ctx.atan2(vector.terms[0].imag, vector.terms[0].real)
    if len(vector.terms) == 1:
        return Series((first,))
    turning = (vector.differentiated() / vector).imag
    return Series((first, *(term / k for k, term in enumerate(turning.terms, 1))))


def points(bars: Mapping[str, Any], ratio: Any, at: Position) -> dict[str, Series]:
    """Return the joints A, B, P, Q and F."""
    m, n, d = (bars[name] for name in "mnd")
    places = {"P": m * at.u, "Q": n * at.v + d, "A": ratio * m * at.u, "B": ratio * n * at.v + d}
    return places | {"F": places["P"] - bars["p"] * at.u * at.w}


def coordinates(places: Mapping[str, Series]) -> dict[str, Any]:
    """Return the coordinates of points by the names of quantities."""
    found = {f"{name}_x": place.terms[0].real for name, place in places.items()}
    return found | {f"{name}_y": place.terms[0].imag for name, place in places.items()}
