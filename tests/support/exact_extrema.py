"""Every extreme of a quantity of the planar 4R by exact algebra: no sample may miss one, no rounding make one up.

With t = tan(theta1/2) and y the area of the triangle ABD times a factor, whose square is a polynomial of t, every
quantity here is (A + B y)/D with polynomials A, B, D of t over the rationals: sums, products, quotients and derivatives
are of that kind again. Where its derivative vanishes is a root of A^2 - B^2 y^2, and the sign of -A/B there tells the
branch. Real roots are isolated by balls. Magnitudes are taken by their squares.

A gap of the lengths within their rounding is zero, as for the kernels: lengths are moved, by parts of their last bits.
"""

from __future__ import annotations

import contextlib
import functools
import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import flint
import numpy as np
from flint import arb, fmpq, fmpq_poly, fmpz, fmpz_poly
from flint.utils.flint_exceptions import DomainError

__all__ = ["LISTED", "Place", "exact_extrema", "zeroed"]

#: Of balls; where a sign is not settled with the first, with the next: beside a fold much cancels. Roots that need more
#: than the first take minutes to isolate, with however many.
BITS = (1024, 16384, 65536)
#: What vanishes at change points: signs of a1 ... a4.
GAPS = ((1, -1, 1, -1), (1, 1, -1, -1), (1, -1, -1, 1))
#: Kernels take what is within 2^-52 of the scale from a fold for the fold itself, and what is within 2^-26 from a
#: toggle, where the quantity is as great as there but for a rounding, for the toggle. Here by the sine of the
#: transmission angle, which is some tens of that at most.
AT_FOLD, AT_TOGGLE = 2.0**-46, 2.0**-20
#: Quantities of which the exact extremes are known here.
LISTED = ("omega2", "omega4", "alpha2", "alpha4", "P_speed", "curvature", "T41", "F41", "F21", "F32", "F43")
LISTED += ("shaking_force", "F41_x", "F32_y", "P_ax")


@dataclass(frozen=True)
class Place:
    """An extreme: the branch, tan(theta1/2) as a ball (None for pi), and whether it is a maximum (1) or not (-1).

    `at_end` tells whether it is nearer to where links align than kernels tell apart: no list needs to hold it.
    """

    branch: int
    t: Any
    kind: int
    at_end: bool

    @property
    def theta1(self) -> float:
        """The input angle, from 0 to a full turn; what differs from 0 by nothing is 0, on either side."""
        if self.t is not None and abs(self.t) < 2**-200:
            return 0.0
        return float(np.pi) if self.t is None else float((2 * self.t.atan()).mid()) % (2 * np.pi)


class Field:
    """Numbers (A + B y)/D, where y^2 is a polynomial; t goes from the polynomials' variable."""

    def __init__(self, square: fmpq_poly) -> None:
        self.square, self.slope = square, square.derivative()

    def __call__(self, a: Any, b: Any = 0, d: Any = 1) -> Number:
        return Number(self, fmpq_poly(a), fmpq_poly(b), fmpq_poly(d))


class Number:
    """One number of a field."""

    def __init__(self, field: Field, a: fmpq_poly, b: fmpq_poly, d: fmpq_poly) -> None:
        common = d.gcd(a).gcd(b) if d.degree() > 0 else d
        if common.degree() > 0:
            a, b, d = a // common, b // common, d // common
        scale = shared_factor(a, b, d)  # without it, integers grow to a million bits
        self.field, self.a, self.b, self.d = field, a / scale, b / scale, d / scale

    def _of(self, other: Any) -> Number:
        return other if isinstance(other, Number) else self.field([other])

    def __add__(self, other: Any) -> Number:
        o = self._of(other)
        if self.d == o.d:
            return Number(self.field, self.a + o.a, self.b + o.b, self.d)
        g = self.d.gcd(o.d)
        one, two = o.d // g, self.d // g
        return Number(self.field, self.a * one + o.a * two, self.b * one + o.b * two, self.d * one)

    def __neg__(self) -> Number:
        return Number(self.field, -self.a, -self.b, self.d)

    def __sub__(self, other: Any) -> Number:
        return self + (-self._of(other))

    def __mul__(self, other: Any) -> Number:
        o = self._of(other)
        a = self.a * o.a + self.b * o.b * self.field.square
        return Number(self.field, a, self.a * o.b + self.b * o.a, self.d * o.d)

    __radd__, __rmul__ = __add__, __mul__

    def __rsub__(self, other: Any) -> Number:
        return self._of(other) - self

    def inverse(self) -> Number:
        """Return 1 over the number."""
        norm = self.a * self.a - self.b * self.b * self.field.square
        return Number(self.field, self.a * self.d, -(self.b * self.d), norm)

    def __truediv__(self, other: Any) -> Number:
        return self * self._of(other).inverse()

    def derivative(self) -> Number:
        """Return the derivative by t; y' is y y^2'/(2 y^2)."""
        a, b, d, square = self.a, self.b, self.d, self.field.square
        top, slope = a.derivative() * d - a * d.derivative(), b.derivative() * d - b * d.derivative()
        one = Number(self.field, top, slope, d * d)
        return one + Number(self.field, fmpq_poly([0]), b * self.field.slope, 2 * d * square)

    def by_theta(self) -> Number:
        """Return the derivative by theta1 = 2 atan t."""
        return Number(self.field, fmpq_poly([1, 0, 1]), fmpq_poly([0]), fmpq_poly([2])) * self.derivative()


def shared_factor(*polynomials: fmpq_poly) -> fmpq:
    """Return the greatest rational number that leaves polynomials with integers for coefficients."""
    denominator = functools.reduce(fmpz.lcm, (p.denom() for p in polynomials))
    contents = (p.numer().content() * (denominator // p.denom()) for p in polynomials)
    return fmpq(functools.reduce(fmpz.gcd, contents), denominator)


def exact(x: Any) -> fmpq:
    """Return a double or fraction as a rational number."""
    fraction = Fraction(x)
    return fmpq(fraction.numerator, fraction.denominator)


def zeroed(lengths: Any) -> tuple[Fraction, ...]:
    """Return lengths in which each gap within their rounding is zero: the nearest ones in the sum of squares."""
    a = [Fraction(float(length)) for length in lengths]
    rounding = Fraction(2) ** -53 * sum(a)
    rows: list[list[Fraction]] = []
    for signs in GAPS:
        gap = sum(s * length for s, length in zip(signs, a, strict=True))
        if abs(gap) <= rounding:
            row = [Fraction(s) for s in signs]
            for other in rows:  # orthogonal to those before
                share = sum(x * y for x, y in zip(row, other, strict=True)) / sum(x * x for x in other)
                row = [x - share * y for x, y in zip(row, other, strict=True)]
            if any(row):
                rows.append(row)
    for row in rows:
        share = sum(x * y for x, y in zip(row, a, strict=True)) / sum(x * x for x in row)
        a = [x - share * y for x, y in zip(a, row, strict=True)]
    return tuple(a)


Vector = tuple[Number, Number]


def add(*vectors: Vector) -> Vector:
    return sum((v[0] for v in vectors[1:]), vectors[0][0]), sum((v[1] for v in vectors[1:]), vectors[0][1])


def times(factor: Any, v: Vector) -> Vector:
    return factor * v[0], factor * v[1]


def turned(v: Vector) -> Vector:
    return -v[1], v[0]


def cross(v: Vector, w: Vector) -> Number:
    return v[0] * w[1] - v[1] * w[0]


def dot(v: Vector, w: Vector) -> Number:
    return v[0] * w[0] + v[1] * w[1]


class Linkage:
    """The planar 4R of some inputs over its field."""

    def __init__(
        self, inputs: Mapping[str, float], turn: int = 0, *, zeroes: bool = True, sense: int = 1
    ) -> None:
        self.sense = sense
        self.given = {name: exact(value) for name, value in inputs.items()}
        lengths = [inputs[f"a{i}"] for i in (1, 2, 3, 4)]
        a1, a2, a3, a4 = map(exact, zeroed(lengths) if zeroes else lengths)
        one, square = fmpq_poly([1, 0, 1]), fmpq_poly([(a1 - a4) ** 2, 0, (a1 + a4) ** 2])  # |AD|^2 times one
        outer, inner = (a2 + a3) ** 2 * one - square, square - (a2 - a3) ** 2 * one
        self.square = outer * inner
        self.root = square_root(self.square)
        # where y is a polynomial the field is that of the rational functions, on each of the two curves
        self.field = field = Field(self.square)
        unit = (field([1, 0, -1], 0, one), field([0, 2], 0, one))
        zero = field([0])
        self.A, self.D = times(a1, unit), (a4 + zero, zero)
        along = add(self.D, times(-1, self.A))
        share = field((a2**2 - a3**2) * one + square, 0, 2 * square)
        area = Number(field, fmpq_poly([0]), fmpq_poly([1]), 2 * square)
        across = area if self.root is None else Number(field, turn * self.root, fmpq_poly([0]), 2 * square)
        self.B = add(self.A, times(share, along), times(across, turned(along)))
        self.crank = unit
        self.coupler = times(1 / a2, add(self.B, times(-1, self.A)))
        self.output = times(1 / a3, add(self.B, times(-1, self.D)))
        self.omega, self.alpha = (self.of(name) for name in ("omega1", "alpha1"))

    def of(self, name: str) -> fmpq:
        """Return an input, 0 where it is not given."""
        return self.given.get(name, fmpq(0))

    def rate(self, x: Number) -> Number:
        return self.omega * x.by_theta()

    def second(self, x: Number) -> Number:
        first = x.by_theta()
        return self.omega**2 * first.by_theta() + self.alpha * first

    def turning(self, direction: Vector) -> Number:
        """Return how fast a direction turns over theta1."""
        return cross(direction, tuple(x.by_theta() for x in direction))

    def spin(self, direction: Vector) -> Number:
        """Return the angular acceleration of a direction."""
        first = self.turning(direction)
        return self.omega**2 * first.by_theta() + self.alpha * first

    def point(self, at: Vector, along: Vector, name: str) -> Vector:
        """Return a point of a link."""
        return add(at, times(self.of(f"{name}_u"), along), times(self.of(f"{name}_v"), turned(along)))

    def quantity(self, name: str) -> Number:
        """Return a quantity, or the square of a magnitude; the curvature by its slope, see `slope`."""
        if name in ("omega2", "omega4"):
            return self.omega * self.turning(self.coupler if name == "omega2" else self.output)
        if name in ("alpha2", "alpha4"):
            return self.spin(self.coupler if name == "alpha2" else self.output)
        P = self.point(self.A, self.coupler, "P")
        if name == "P_speed":
            velocity = tuple(map(self.rate, P))
            return dot(velocity, velocity)
        if name == "P_ax":
            return self.second(P[0])
        return self.force(name, P)

    def slope(self, name: str) -> Number:
        """Return what has the sign of the slope over theta1."""
        if name != "curvature":
            return self.quantity(name).derivative()
        P = self.point(self.A, self.coupler, "P")
        first = tuple(x.by_theta() for x in P)
        area, square = cross(first, tuple(x.by_theta() for x in first)), dot(first, first)
        return 2 * area.by_theta() * square - 3 * area * square.by_theta()

    def force(self, name: str, P: Vector) -> Number:
        """Return a force, a component or the square of its size, or the torque."""
        starts, directions = (self.A, self.D), (self.crank, self.coupler, self.output)
        zero = self.field([0])
        at = ((zero, zero), *starts)
        centres = [self.point(at[k], directions[k], f"G{k + 1}") for k in range(3)]
        pulls = [
            times(self.of(f"m{k + 1}"), add(tuple(map(self.second, centres[k])), self.against("gravity")))
            for k in range(3)
        ]
        turns = [
            self.of(f"I{k + 1}") * self.spin(directions[k])
            + cross(add(centres[k], times(-1, at[k])), pulls[k])
            for k in range(3)
        ]
        load = self.against("FP")
        turns[1] = turns[1] + cross(add(P, times(-1, self.A)), load)
        rate = self.omega * self.turning(self.output)
        # the quadratic part turns with the rate
        by_rate = self.of("T_load_linear") + self.of("T_load_quadratic") * self.sense * rate
        loads = self.of("T_load") + by_rate * rate
        turns[2] = turns[2] - loads
        # at B on the coupler: its moments about A and those of the output link about D
        AB, DB = add(self.B, times(-1, self.A)), add(self.B, times(-1, self.D))
        area = cross(DB, AB).inverse()

        at_B = tuple((AB[k] * (-turns[2]) - DB[k] * turns[1]) * area for k in range(2))
        at_A = add(pulls[1], load, times(-1, at_B))  # on the coupler
        at_O = add(pulls[0], at_A)
        at_D = add(pulls[2], at_B)
        if name == "T41":
            return turns[0] + cross(self.A, at_A)
        forces = {"F41": at_O, "F21": at_A, "F32": at_B, "F43": at_D, "shaking_force": add(at_O, at_D)}
        if name in forces:
            return dot(forces[name], forces[name])
        force, part = name.split("_")
        return forces[force]["xy".index(part)]

    def against(self, name: str) -> Vector:
        """Return a load or gravity with its sign changed."""
        return tuple(self.field([-self.of(f"{name}_{axis}")]) for axis in "xy")


def real_roots(polynomial: fmpq_poly) -> list[arb]:
    """Return the real roots of a polynomial without multiplicity, as balls apart from each other."""
    whole = fmpz_poly([int(c) for c in (polynomial * polynomial.denom()).coeffs()])
    factors = (factor for factor, _ in whole.factor_squarefree()[1])
    return [root.real for factor in factors for root, _ in factor.complex_roots() if root.imag == 0]


def value_at(polynomial: fmpq_poly, t: arb) -> arb:
    """Return the value at a ball."""
    value = arb(0)
    for c in reversed(polynomial.coeffs()):
        value = value * t + arb(c)
    return value


def square_root(polynomial: fmpq_poly) -> fmpq_poly | None:
    """Return the square root of a polynomial where it is one."""
    try:
        return polynomial.sqrt()
    except (ValueError, DomainError):
        return None


class Unsettled(Exception):
    """Balls are too wide to tell a sign or an order."""


class Slopes:
    """The slope of a quantity on both branches: one number of a field, or two rational functions.

    With a load that goes with the square of a rate there are as many for each sense of the rate.
    """

    def __init__(self, inputs: Mapping[str, float], name: str, zeroes: bool) -> None:
        first = Linkage(inputs, 1, zeroes=zeroes)
        self.square, self.root = first.square, first.root
        self.lengths = [inputs[f"a{i}"] for i in (2, 3)]
        square = first.square if zeroes else Linkage(inputs).square
        self.folds = square[0] == 0, square[4] == 0
        senses = (1, -1) if inputs.get("T_load_quadratic", 0.0) else (1,)
        turns = (1, -1) if self.root is not None else (1,)
        _, *further = itertools.product(senses, turns)
        cases = [first, *(Linkage(inputs, turn, zeroes=zeroes, sense=sense) for sense, turn in further)]
        self.numbers = [case.slope(name) for case in cases]
        self.rates = [case.omega * case.turning(case.output) for case in cases[: len(turns)]]

    @cached_property
    def limits(self) -> fmpq_poly:
        """What vanishes where the slope has no value."""
        return self.square * math.prod((number.d for number in self.numbers), start=fmpq_poly([1]))

    @cached_property
    def zeros(self) -> list[fmpq_poly]:
        """What vanishes where a slope does, but at limits; no two of them have a root in common."""
        found: list[fmpq_poly] = []
        for n in self.numbers:
            norm = n.a * n.a - n.b * n.b * self.square
            for other in (self.limits, *found) if norm != 0 else ():
                while (common := norm.gcd(other)).degree() > 0:
                    norm = norm // common
            found += [norm] if norm != 0 else []
        return found

    def at_end(self, t: arb | None) -> bool:
        """Tell whether a place is next to where links align, see `AT_FOLD`."""
        share = arb(self.square[4]) if t is None else value_at(self.square, t) / (1 + t * t) ** 2
        sine = float(share.sqrt().mid()) / (2.0 * self.lengths[0] * self.lengths[1])
        at_0, at_pi = t is not None and abs(t) < 2**-10, t is None or abs(t) > 2**10
        fold = (at_0 and self.folds[0]) or (at_pi and self.folds[1])
        return sine < (AT_FOLD if fold else AT_TOGGLE)

    def sign(self, branch: int, t: arb) -> int:
        """Return the sign on a branch, 0 where the linkage does not assemble or the quantity is constant."""
        under, side = value_at(self.square, t), 1 if branch == 2 else -1
        if not under > 0:
            if not under < 0:
                raise Unsettled
            return 0
        area = side * under.sqrt()
        k = 1 if self.root is not None and not side * value_at(self.root, t) > 0 else 0
        if len(self.numbers) > len(self.rates) and _sign(self.rates[k], t, area) < 0:
            k += len(self.rates)
        return _sign(self.numbers[k], t, area)


def _sign(number: Number, t: arb, area: arb) -> int:
    """Return the sign of a number where y is `area`."""
    if number.a == 0 and number.b == 0:
        return 0
    value = (value_at(number.a, t) + area * value_at(number.b, t)) * value_at(number.d, t)
    if not value != 0:  # a ball around 0 differs from it neither way
        raise Unsettled
    return 1 if value > 0 else -1


def exact_extrema(inputs: Mapping[str, float], name: str, *, zeroes: bool = True) -> list[Place]:
    """Return every extreme of a quantity of one design, by branch and input angle.

    Places where the linkage folds or toggles are none. `zeroes` tells whether a gap within the rounding of the lengths
    is zero.
    """
    slopes = Slopes(inputs, name, zeroes)
    for bits in BITS:
        with flint.ctx.workprec(bits), contextlib.suppress(Unsettled):
            marks = [(root, False) for root in real_roots(slopes.limits)]
            marks += [(root, True) for zeros in slopes.zeros for root in real_roots(zeros)]
            marks.sort(key=lambda mark: mark[0].mid())
            return sorted(_changes(slopes, marks), key=lambda place: (place.branch, place.theta1, place.kind))
    raise AssertionError(f"a sign is not settled with {BITS[-1]} bits")


def _changes(slopes: Slopes, marks: list[tuple[Any, bool]]) -> Iterator[Place]:
    """Yield where the slope changes its sign; a mark tells whether it is 0 there, or has no value."""
    places = [root for root, _ in marks]
    if not all(one < other for one, other in itertools.pairwise(places)):
        raise Unsettled
    between = [exact_mid(one, other) for one, other in itertools.pairwise(places)]
    first = [places[0].lower() - 1] if places else [arb(0)]
    beside = [*first, *between, *([places[-1].upper() + 1] if places else [])]
    # once round the turn: pi is between the last and the first
    marks = [*marks, (None, slopes.square.degree() == 4)]
    for branch in (1, 2):
        signs = [slopes.sign(branch, t) for t in beside]
        after = [*signs[1:], signs[0]]
        for (root, is_zero), before, then in zip(marks, signs, after, strict=True):
            if is_zero and before and then and before != then:
                yield Place(branch, root, before, slopes.at_end(root))


def exact_mid(one: arb, other: arb) -> arb:
    """Return a number between two, of few bits, nearer in ratio than in distance where they are far from each other."""
    low, high = one.upper(), other.lower()
    return (low * high).sqrt() * (1 if low > 0 else -1) if low * high > 0 else (low + high) / 2
