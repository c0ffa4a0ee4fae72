"""Truncated power series of the drive, Newton's iteration on equations between them, and the laws of moving links.

Numbers are those of a context, `MPContext` of mpmath or one with the same functions: real and complex numbers, `mpf`,
`mpc`, `sqrt`, `cos_sin`, `exp`, `atan2`. Derivatives follow from the equations themselves: no formula of a rate
stands anywhere.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from math import factorial, pi
from typing import Any

from mpmath import MPContext

from fastlink.facts.evaluate import Singular as Singular
from fastlink.facts.evaluate import linear_solution

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
    """A truncated power series, by its terms."""

    __slots__ = ("terms",)

    def __init__(self, terms: Iterable[Any]) -> None:
        self.terms = tuple(terms)

    def derivative(self, order: int) -> Any:
        """Return a derivative where the drive is 0."""
        return self.terms[order] * factorial(order)

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


def rotation(ctx: Any, angle: Any) -> Any:
    """Return the direction e^(i x) of an angle or of a series: a complex number of size 1."""
    if isinstance(angle, Series):
        return _exponential(rotation(ctx, angle.terms[0]), angle * ctx.mpc(0, 1))
    return ctx.mpc(*ctx.cos_sin(angle))


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


def drive_of(ctx: Any, value: Any, order: int) -> Series:
    """Return the series of the drive itself."""
    return Series((value, *(ctx.mpf(k == 1) for k in range(1, order + 1))))


def rates(curve: Series, names: Iterable[str]) -> dict[str, Any]:
    """Return the derivatives of a curve by their names, as many as its series has."""
    return {name: curve.derivative(k) for k, name in zip(range(1, len(curve.terms)), names, strict=False)}


# -- Vectors as complex numbers, triangles, and the closed polygon of four links


def cross(one: Any, other: Any) -> Any:
    """Return the cross product of two vectors."""
    return one.real * other.imag - one.imag * other.real


def wrapped(ctx: Any, angle: Any) -> Any:
    """Return an angle within (-pi, pi]."""
    cosine, sine = ctx.cos_sin(angle)
    return ctx.atan2(sine, cosine)


def angle_between(ctx: Any, one: Any, other: Any) -> Any:
    """Return the angle from one vector to another, within (-pi, pi]."""
    return ctx.atan2(cross(one, other), one.real * other.real + one.imag * other.imag)


def argument(ctx: Any, vector: Series) -> Series:
    """Return the direction of a vector as an angle, over the drive."""
    first = ctx.atan2(vector.terms[0].imag, vector.terms[0].real)
    turning = (Series(k * term for k, term in enumerate(vector.terms[1:], 1)) / vector).imag
    return Series((first, *(term / k for k, term in enumerate(turning.terms, 1))))


def triangle_angle(ctx: Any, one: Any, other: Any, opposite: Any) -> Any:
    """Return the angle between two sides of a triangle; 0 or pi where it folds."""
    least = max((opposite - one + other) * (opposite + one - other), 0 * one)
    greatest = max((one + other - opposite) * (one + other + opposite), 0 * one)
    return 2 * ctx.atan2(ctx.sqrt(least), ctx.sqrt(greatest))


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
    """Return the directions of the four links of a closed polygon, as angles from that of the first link.

    Newton's iteration starts where two circles meet.
    """
    first, second, third, fourth = lengths
    to_start = -(first + second * rotation(ctx, turn.terms[0]))
    apex = corner(ctx, to_start, third, fourth, -1 if branch == 1 else 1)
    last = to_start - apex
    start = [ctx.atan2(one.imag, one.real) for one in (apex, last)]

    def closure(unknown: list[Series], drive: Series) -> list[Series]:
        end = first + second * rotation(ctx, drive)
        end = end + third * rotation(ctx, unknown[0]) + fourth * rotation(ctx, unknown[1])
        return [end.real, end.imag]

    return [0 * turn, turn, *solved(ctx, closure, start, turn)]


def coordinates(places: Mapping[str, Any]) -> dict[str, Any]:
    """Return the components of vectors, and of points as series, by the names of quantities."""
    at = {name: place.terms[0] if isinstance(place, Series) else place for name, place in places.items()}
    found = {f"{name}_x": place.real for name, place in at.items()}
    return found | {f"{name}_y": place.imag for name, place in at.items()}


# -- Newton's and Euler's laws of a chain of links, as the linear system of Hayes, Hninn, Irani, eq. (9)


@dataclass
class Link:
    """A link as curves of its masses over time, with the forces and torques on it.

    A joint is the number of its force, 1 or -1 as the force or its reaction acts on the link, and where.
    """

    masses: list[tuple[Any, Series]]
    #: Moment of inertia times angular acceleration.
    spin: Any
    #: The mass centre of all masses.
    centre: Any
    joints: list[tuple[int, int, Any]]
    #: The number of an unknown torque on the link.
    torque: int | None = None
    #: Forces and where they act, and a torque.
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
        return [[*row, side] for row, side in zip(rows, (force.real, force.imag, moment), strict=True)]


def chain(
    ctx: Any,
    at: Mapping[str, Any],
    lengths: Sequence[Any],
    origins: Sequence[Series],
    directions: Sequence[Series],
    joints: Sequence[Any],
    speed: tuple[Any, ...],
) -> list[Link]:
    """Return the links of a chain by their frames; the first joint is at the ground, a torque drives the first link."""
    links: list[Link] = []
    for i, (length, origin, direction) in enumerate(zip(lengths, origins, directions, strict=True), 1):
        mass, inertia, local = bar_data(ctx, at, i, length)
        points = [(mass, local)]
        if f"counterweight{i}_mass" in at:
            turn = at.get(f"counterweight{i}_direction", ctx.mpf(pi))
            arm = at[f"counterweight{i}_radius"] * rotation(ctx, turn)
            points.append((at[f"counterweight{i}_mass"], arm))
        curves = [(each, (origin + arm * direction).at_speed(*speed)) for each, arm in points]
        whole = sum(each for each, _ in curves)
        centre = curves[0][1].terms[0] if len(curves) == 1 else origin.terms[0]
        if whole != 0:
            centre = sum(each * curve.terms[0] for each, curve in curves) / whole
        turning = direction.at_speed(*speed)
        # of a direction u the second derivative is i alpha u - omega^2 u
        spin = inertia * (turning.derivative(2) / turning.terms[0]).imag
        ends = [(i - 1, 1 if i == 1 else -1, joints[i - 1]), (i, 1, joints[i])]
        links.append(Link(curves, spin, centre, ends, 2 * len(joints) if i == 1 else None))
    return links


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
