"""Sine, cosine, and their hyperbolic kin, as unevaluated sums of three doubles with bounds of their errors.

An argument is n steps of a table and a rest x. With w = -x^2 for angles, x^2 for rapidities, both kinds have the
series cos x = 1 + w/2 + w^2/24 + ..., sin x = x + x (w/6 + w^2/120 + ...), and turn what the table has by the same
rule. All is straight-line arithmetic on doubles, one or arrays of them: a result has the same bits in any company.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from fastlink.numerics.compensated import product_rest, split, two_product, two_sum
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER, ROUNDING_SHIFT, select

Parts = tuple[Any, Any, Any]

#: Binary places of the integers that constants and tables are made of.
PLACES = 256
HALF_PI = 0x1921FB54442D18469898CC51701B839A252049C1114CF98E804177D4C76273645
LOG_2 = 0xB17217F7D1CF79ABC9E3B39803F2F6AF40F343267298B62D8A0D175B8BAAFA2C
#: A step is pi/2 or log(2) over 2^11. The rest of an argument is at most half of it, 2^-11.3 or 2^-12.5.
HALVINGS = 11
STEPS = 1 << HALVINGS
#: A step is a sum of pieces of so many bits: multiples up to 2^27 of a piece are exact.
PIECE_BITS, PIECES, MOST_STEPS = 26, 7, 2.0**27 - 1.0
#: Rests of lesser arguments have powers that underflow.
LEAST_ARGUMENT = 2.0**-300


def doubles_of(value: int) -> Parts:
    """Return an integer times 2^-PLACES as three doubles, to within 2^-106 of the second."""
    parts = []
    for _ in range(3):
        parts.append(float(value))
        value -= int(parts[-1])
    return math.ldexp(parts[0], -PLACES), math.ldexp(parts[1], -PLACES), math.ldexp(parts[2], -PLACES)


def _inverse(n: int) -> tuple[tuple[float, float, float], float]:
    """Return 1/n as a double with its halves, and the next double."""
    first, second, _ = doubles_of((1 << PLACES) // n)
    return (first, *split(first)), second


(PER_6, *_), PER_6_LOW = _inverse(6)
(PER_24, *PER_24_HALVES), PER_24_LOW = _inverse(24)
(PER_120, *PER_120_HALVES), PER_120_LOW = _inverse(120)


@dataclass(frozen=True)
class Grid:
    """A table of (cosine, sine) at multiples of a step, and what divides an argument by the step."""

    step: float
    #: The step, but for less than 2^-191.
    pieces: tuple[float, ...]
    #: Three doubles of each cosine, and of each sine.
    columns: Any
    sign: float

    def at(self, index: Any) -> tuple[Parts, Parts]:
        """Return cosine and sine of an entry, or of many."""
        if isinstance(index, float):
            c0, c1, c2, s0, s1, s2 = self.columns[:, int(index)].tolist()
        else:
            place = index.astype(np.intp)
            c0, c1, c2, s0, s1, s2 = (np.take(column, place) for column in self.columns)
        return (c0, c1, c2), (s0, s1, s2)


def _grid(step: int, cosines: Any, sines: Any, sign: float) -> Grid:
    nearest, lowest, pieces = doubles_of(step)[0], step.bit_length() - PIECE_BITS, []
    for _ in range(PIECES):
        pieces.append(math.ldexp(float(step >> lowest << lowest), -PLACES))
        step, lowest = step & (1 << lowest) - 1, lowest - PIECE_BITS
    return Grid(nearest, tuple(pieces), np.concatenate([cosines, sines]), sign)


@cache
def _circle() -> Grid:
    """Return cosines and sines of a turn: 1,024 rotations by a step, which lose less than 2^-240, and mirrors."""
    step, one = HALF_PI >> HALVINGS, 1 << PLACES
    series, term = [0, 0], one
    for k in range(40):
        series[k % 2] += -term if k & 2 else term
        term = (term * step >> PLACES) // (k + 1)
    octant = [(one, 0)]
    for _ in range(STEPS // 2):
        c, s = octant[-1]
        turned = c * series[0] - s * series[1], s * series[0] + c * series[1]
        octant.append((turned[0] >> PLACES, turned[1] >> PLACES))
    cosine, sine = (np.array([doubles_of(pair[k]) for pair in octant]).T for k in (0, 1))
    quarter = np.concatenate([cosine, sine[:, -2::-1]], axis=1)
    onwards, backwards = quarter[:, :-1], quarter[:, :0:-1]
    cosines = np.concatenate([onwards, -backwards, -onwards, backwards], axis=1)
    return _grid(step, cosines, np.roll(cosines, STEPS, axis=1), -1.0)


@cache
def _hyperbola() -> Grid:
    """Return hyperbolic cosines and sines from -log(2)/2 to log(2)/2: powers of 2, which lose less than 2^-240."""
    one = 1 << PLACES
    root = 2 * one
    for _ in range(HALVINGS):
        root = math.isqrt(root << PLACES)
    powers = [one]
    for _ in range(STEPS):
        powers.append(powers[-1] * root >> PLACES)
    half = STEPS // 2
    exponentials = [power >> 1 for power in powers[half:STEPS]] + powers[: half + 1]
    pairs = list(zip(exponentials, exponentials[::-1], strict=True))
    cosines = np.array([doubles_of((up + down) >> 1) for up, down in pairs]).T
    sines = np.array([doubles_of((up - down) >> 1) for up, down in pairs]).T
    return _grid(LOG_2 >> HALVINGS, cosines, sines, 1.0)


def nearest_integer(x: Any) -> Any:
    """Return the integer nearest to a number of less than 2^51."""
    return (x + ROUNDING_SHIFT) - ROUNDING_SHIFT


def _divided(x: Any, grid: Grid) -> tuple[Any, Parts]:
    """Return the number n of steps nearest to an argument, and the rest.

    x and n pieces[0] are multiples of one number, and their difference, at most 2^-10, has less than 2^53 of it: it is
    exact. The other pieces follow by sums of which no error is lost but those of terms below 2^-130 of x. The rest has
    an error of at most 2^-190 n, for the pieces that are left out, and 2^-105 of its second part, for the third.
    """
    n = nearest_integer(x / grid.step)
    p0, p1, p2, p3, p4, p5, p6 = grid.pieces
    t3, e4 = two_sum(-n * p4, -(n * p5 + n * p6))
    t3, e3 = two_sum(-n * p3, t3)
    t2, e2 = two_sum(-n * p2, t3)
    t1, e1 = two_sum(-n * p1, t2)
    t0, e0 = two_sum(x - n * p0, t1)
    e3, f3 = two_sum(e3, e4)
    e2, f2 = two_sum(e2, e3)
    e1, f1 = two_sum(e1, e2)
    e0, f0 = two_sum(e0, e1)
    x0, x1 = two_sum(t0, e0)
    x1, x2 = two_sum(x1, f0)
    return n, (x0, x1, x2 + (f1 + (f2 + f3)))


def _series(x: Parts, sign: float) -> tuple[Any, Any, Parts]:
    """Return the two doubles of cos x - 1, and the three of sin x.

    w has three roundings of its second double, 2^-102 x^2 with that of the first, and half of this is in the
    cosine. The rest of the series is x^4 / 24 < 2^-27 x^2: its double-double products, and the doubles in its tail
    (2^-51 of x^6/720, 2^-60 x^6 < 2^-105 x^2), are in the other half. Terms from x^12/12! on are left out: 2^-142
    x^2. The sine is x and x w (1/6 + ...), a product with an error of at most 2^-101 of itself.
    """
    x0, x1, x2 = x
    a1, a2 = split(x0)
    square = x0 * x0
    w = sign * square
    w_low = sign * (product_rest(square, a1, a2, a1, a2) + (x1 * (2.0 * x0 + x1) + 2.0 * x0 * x2))
    w1, w2 = split(w)
    w_square = w * w
    # cosine: w/2 + w (w/24 + ...)
    q = w * PER_24
    tail = w_square * (1.0 / 720.0 + w * (1.0 / 40320.0 + w * (1.0 / 3628800.0)))
    q_low = product_rest(q, w1, w2, *PER_24_HALVES) + (w * PER_24_LOW + w_low * PER_24) + tail
    d = w * q
    d_low = product_rest(d, w1, w2, *split(q)) + (w * q_low + w_low * q)
    c0, c1 = two_sum(0.5 * w, d)
    c1 = c1 + (0.5 * w_low + d_low)
    # sine: x + x w (1/6 + w/120 + ...)
    q = w * PER_120
    tail = w_square * (1.0 / 5040.0 + w * (1.0 / 362880.0 + w * (1.0 / 39916800.0)))
    q_low = product_rest(q, w1, w2, *PER_120_HALVES) + (w * PER_120_LOW + w_low * PER_120) + tail
    q, r = two_sum(PER_6, q)
    q_low = r + (PER_6_LOW + q_low)
    d = w * q
    d_low = product_rest(d, w1, w2, *split(q)) + (w * q_low + w_low * q)
    q = x0 * d
    q_low = product_rest(q, a1, a2, *split(d)) + (x0 * d_low + x1 * d)
    s0, r0 = two_sum(x0, q)
    s1, r1 = two_sum(x1, r0)
    s1, r2 = two_sum(s1, q_low)
    return c0, c1, (s0, s1, x2 + (r1 + r2))


Halved = tuple[tuple[Any, Any, Any], tuple[Any, Any, Any], Any]


def _halved(x: Parts) -> Halved:
    """Return three doubles, the first two with their halves."""
    return (x[0], *split(x[0])), (x[1], *split(x[1])), x[2]


def _turned(along: Halved, across: Halved, c: Any, s: Halved) -> tuple[Parts, Any]:
    """Return F + F c + T s of three doubles F and T, and the sum of the magnitudes of all second doubles.

    Products of two first doubles are exact, and those of a first and a second but for F c: its c is below 2^-22.
    """
    (f0, f01, f02), (f1, _, _), f2 = along
    (t0, t01, t02), (t1, t11, t12), t2 = across
    (c0, c01, c02), c1 = c
    (s0, s01, s02), (s1, s11, s12), s2 = s
    p, q, u, v = f0 * c0, t0 * s0, t0 * s1, t1 * s0
    p_rest, q_rest = product_rest(p, f01, f02, c01, c02), product_rest(q, t01, t02, s01, s02)
    high, r1 = two_sum(f0, q)
    high, r2 = two_sum(high, p)
    middle, e1 = two_sum(f1, r1)
    middle, e2 = two_sum(middle, r2)
    middle, e3 = two_sum(middle, q_rest)
    middle, e4 = two_sum(middle, u)
    middle, e5 = two_sum(middle, v)
    middle, e6 = two_sum(middle, p_rest)
    seconds = (abs(f1) + abs(r1) + abs(r2)) + (abs(u) + abs(v)) + (abs(p_rest) + abs(q_rest))
    lost = product_rest(u, t01, t02, s11, s12) + product_rest(v, t11, t12, s01, s02)
    low = (f2 + ((t0 * s2 + t2 * s0) + t1 * s1)) + (lost + ((e1 + e2) + (e3 + e4) + (e5 + e6)))
    middle, low = two_sum(middle, low + (f0 * c1 + f1 * c0))
    high, middle = two_sum(high, middle)
    return (high, middle, low), seconds


def _rotated(n: Any, x: Parts, start: tuple[Parts, Parts], sign: float) -> tuple[Any, ...]:
    """Return cosine, its greatest error, sine, and its greatest error, of n steps and a rest.

    The errors of F + F c + T s, all zero where it is exact:
    - 2^-100 x^2 F, for c (2^-102 x^2), for c1 among the thirds, of which a sum has eight roundings, and for f1 c1;
    - 2^-100 of the seconds: six errors of 2^-53 of them and f2 have those roundings; the table's error is 2^-106 f1;
    - of T s: 2^-101 x^2 of it for the series; 2^-100 t0 s1 for its thirds, their rounding and what is left out;
    - T times the error of x.
    """
    c0, c1, s = _series(x, sign)
    cosine, sine, c, halved = _halved(start[0]), _halved(start[1]), ((c0, *split(c0)), c1), _halved(s)
    first, first_seconds = _turned(cosine, sine, c, _signed(halved, sign))
    second, second_seconds = _turned(sine, cosine, c, halved)
    of_c = x[0] * x[0] * 2.0**-100
    of_x = abs(n) * 2.0**-190 + abs(x[1]) * 2.0**-105
    of_s = abs(x[0]) * of_c + abs(s[1]) * 2.0**-100 + of_x
    abs_c, abs_s = abs(start[0][0]), abs(start[1][0])
    first_error = of_c * abs_c + first_seconds * 2.0**-100 + of_s * abs_s
    second_error = of_c * abs_s + second_seconds * 2.0**-100 + of_s * abs_c
    return first, first_error, second, second_error


def _signed(s: Halved, sign: float) -> Halved:
    if sign == 1.0:
        return s
    (s0, s01, s02), (s1, s11, s12), s2 = s
    return (-s0, -s01, -s02), (-s1, -s11, -s12), -s2


def _in_range(x: Any, grid: Grid) -> tuple[Any, Any]:
    """Return an argument, or zero where it is out of range, and an error of infinity there."""
    size = abs(x)
    fit = ((size < MOST_STEPS * grid.step) & (size > LEAST_ARGUMENT)) | (size == 0.0)
    return select(fit, x, 0.0), select(fit, 0.0, INFINITY)


def circular(x: Any) -> tuple[Any, ...]:
    """Return the cosine of an angle in three doubles, its greatest error, the sine, and its greatest error.

    The error is infinite beyond 100,000 rad, and below 2^-300 except at zero.
    """
    grid = _circle()
    x, without = _in_range(x, grid)
    n, rest = _divided(x, grid)
    cosine, of_cosine, sine, of_sine = _rotated(n, rest, grid.at(_modulo(n, 4.0 * STEPS)), grid.sign)
    return cosine, of_cosine + without, sine, of_sine + without


def hyperbolic(x: Any) -> tuple[Any, ...]:
    """Return cosh(y) in three doubles, its greatest error, sinh(y), its greatest error, and k: y = x - k log(2).

    y is at most half of log(2). The error is infinite beyond 45,000, and below 2^-300 except at zero.
    """
    grid = _hyperbola()
    x, without = _in_range(x, grid)
    n, rest = _divided(x, grid)
    k = nearest_integer(n / STEPS)
    cosine, of_cosine, sine, of_sine = _rotated(n, rest, grid.at(n - k * STEPS + STEPS / 2.0), grid.sign)
    return cosine, of_cosine + without, sine, of_sine + without, k


def _modulo(n: Any, count: float) -> Any:
    """Return an integer modulo a power of two, from 0."""
    return n - count * np.floor(n / count) if isinstance(n, np.ndarray) else n % count


# -- Unevaluated sums of three doubles with bounds of their errors, for tables of the input position

# The text of a table runs on them as on numbers of mpmath, one angle or an array of them: some hundred
# operations on doubles and no integer of many places. Whether the rounding of a result is certain is known:
# where it is not, the caller uses mpmath.


#: Beyond these exponents a number of about 1 overflows, or is nearer to zero than to any double.
OVERFLOWS, UNDERFLOWS = 1030, -1100


class _Comparison:
    """The result of a comparison, for `fastlink.numerics.elementary.select`."""

    def __init__(self, holds: Any) -> None:
        self.holds = holds

    def choose(self, if_true: Any, if_false: Any) -> TripleDouble:
        """Return the first number where the comparison holds, else the second."""
        a, b = _number(if_true), _number(if_false)
        if not isinstance(self.holds, np.ndarray):
            return a if self.holds else b
        chosen = [
            select(self.holds, x, y) for x, y in zip((*a.parts, a.error), (*b.parts, b.error), strict=True)
        ]
        return TripleDouble((chosen[0], chosen[1], chosen[2]), chosen[3], _same(a.twos, b.twos))


class _Functions:
    """The functions of tables, in place of those of mpmath."""

    ln2: TripleDouble

    @staticmethod
    def cos(x: TripleDouble) -> TripleDouble:
        return x.of_circle[0]

    @staticmethod
    def sin(x: TripleDouble) -> TripleDouble:
        return x.of_circle[1]

    @staticmethod
    def exp(x: TripleDouble) -> TripleDouble:
        cosh, sinh, k = x.of_hyperbola
        return (cosh + sinh).shifted(k)

    @staticmethod
    def cosh(x: TripleDouble) -> TripleDouble:
        return _half_sum(x, 1.0)

    @staticmethod
    def sinh(x: TripleDouble) -> TripleDouble:
        return _half_sum(x, -1.0)

    @staticmethod
    def nint(x: TripleDouble) -> TripleDouble:
        """Return the nearest integer, with an infinite error unless it is certain."""
        integer = nearest_integer(x.parts[0])
        certain = (abs(x.parts[0] - integer) + x.error < 0.5) & (abs(integer) < 2.0**50)
        return TripleDouble((integer, 0.0, 0.0), select(certain, 0.0, INFINITY))

    @staticmethod
    def integer(x: TripleDouble) -> TripleDouble:
        return x

    @staticmethod
    def ldexp(x: Any, times: TripleDouble) -> TripleDouble:
        return _number(x).shifted(times.parts[0], times.error)


def _half_sum(x: TripleDouble, sign: float) -> TripleDouble:
    """Return (e^x + sign e^-x)/2, over the power of two of its greater term.

    Where that is 1 it is a hyperbolic function of x itself, which does not cancel.
    """
    cosh, sinh, k = x.of_hyperbola
    falls = k < 0.0
    greater, lesser = cosh + sinh, cosh + -sinh
    greater, lesser = _Comparison(falls).choose(lesser, greater), _Comparison(falls).choose(greater, lesser)
    away = abs(k)
    both = greater.times(0.5) + lesser.times(_power_of_two(-2.0 * away - 1.0) * sign)
    both = _Comparison(falls).choose(both.times(sign), both)
    return _Comparison(away == 0.0).choose(cosh if sign > 0.0 else sinh, both).shifted(away)


class TripleDouble:
    """Numbers (high + middle + low) 2^twos; an operation without a rule is a TypeError or AttributeError."""

    context = _Functions
    #: What is computed once; here, as an instance that sets less is made in a third of the time.
    _circle: tuple[TripleDouble, TripleDouble] | None = None
    _hyperbola: tuple[TripleDouble, TripleDouble, Any] | None = None
    _half: TripleDouble | None = None
    _square: TripleDouble | None = None
    _is_half = False
    #: The number that this one is but for a sign, and the sign.
    _signed: tuple[TripleDouble, Any] | None = None
    #: Whether the first part is the number, for all numbers alike.
    is_argument = False

    def __init__(self, parts: Parts, error: Any = 0.0, twos: Any = 0.0) -> None:
        self.parts, self.error, self.twos = parts, error, twos

    @classmethod
    def of(cls, position: Any) -> TripleDouble:
        """Return input positions, or half of them, as numbers that may be arguments of functions."""
        number = cls((position, 0.0, 0.0))
        number.is_argument = True
        return number

    @property
    def argument(self) -> Any:
        """The double that is the number."""
        if not self.is_argument:
            raise TypeError("functions and comparisons are of the input position, or of half of it")
        return self.parts[0]

    @property
    def of_circle(self) -> tuple[TripleDouble, TripleDouble]:
        """Cosine and sine, computed once: by the half angle, of which tables have squares."""
        if self._circle is None:
            if self._is_half or not self.is_argument:
                cosine, of_cosine, sine, of_sine = circular(self.argument)
                self._circle = TripleDouble(cosine, of_cosine), TripleDouble(sine, of_sine)
            else:
                c, s = (self / 2).of_circle
                self._circle = c * c - s * s, (s * c).times(2.0)
        return self._circle

    @property
    def of_hyperbola(self) -> tuple[TripleDouble, TripleDouble, Any]:
        """cosh(y), sinh(y) and k of y + k log(2), computed once for a number and its opposite."""
        if self._hyperbola is None and self._signed is not None:
            base, sign = self._signed
            cosh, sinh, k = base.of_hyperbola
            self._hyperbola = cosh, sinh.times(sign), k * sign
        if self._hyperbola is None:
            cosine, of_cosine, sine, of_sine, k = hyperbolic(self.argument)
            self._hyperbola = TripleDouble(cosine, of_cosine), TripleDouble(sine, of_sine), k
        return self._hyperbola

    def times(self, factor: Any) -> TripleDouble:
        """Return the number times a power of two, or one with a sign."""
        if self.is_argument:
            return TripleDouble.of(self.parts[0] * factor)
        high, middle, low = (x if _is_zero(x) else x * factor for x in self.parts)
        error = self.error if _is_zero(self.error) else self.error * abs(factor)
        return TripleDouble((high, middle, low), error, self.twos)

    def shifted(self, twos: Any, error: Any = 0.0) -> TripleDouble:
        """Return the number times 2^twos, of which an infinite error is one of the number."""
        return TripleDouble(self.parts, self.error + error, self.twos + twos)

    def _with_sign(self, sign: Any) -> TripleDouble:
        signed = self.times(sign)
        signed._signed = self, sign
        return signed

    def __neg__(self) -> TripleDouble:
        return self._with_sign(-1.0)

    def __abs__(self) -> TripleDouble:
        return self._with_sign(select(self.parts[0] < 0.0, -1.0, 1.0))

    def __truediv__(self, other: Any) -> TripleDouble:
        if isinstance(other, TripleDouble):  # to a double: by its rounding, and that of the divisor
            quotient = self.argument / other.parts[0]
            return TripleDouble((quotient, 0.0, 0.0), abs(quotient) * 2.0**-50)
        if other != 2:
            return NotImplemented
        if self._half is None:
            half = self.times(0.5)
            if self.is_argument:  # the least numbers have no half
                high = half.parts[0]
                half = TripleDouble.of(select(high + high == self.parts[0], high, NOT_A_NUMBER))
                half._is_half = True
            self._half = half
        return self._half

    def __lt__(self, other: float) -> _Comparison:
        return _Comparison(self.argument < other)

    def __add__(self, other: Any) -> TripleDouble:
        """Return a sum: three roundings of sums of third parts, 2^-51 of their magnitudes."""
        if not isinstance(other, TripleDouble):
            return NotImplemented
        (a0, a1, a2), (b0, b1, b2) = self.parts, other.parts
        high, e0 = two_sum(a0, b0)
        middle, e1 = two_sum(a1, b1)
        middle, e2 = two_sum(middle, e0)
        thirds = (abs(a2) + abs(b2)) + (abs(e1) + abs(e2))
        parts = _normalised(high, middle, (a2 + b2) + (e1 + e2))
        return TripleDouble(
            parts, (self.error + other.error) + thirds * 2.0**-51, _same(self.twos, other.twos)
        )

    def __sub__(self, other: Any) -> TripleDouble:
        return self + other.times(-1.0) if isinstance(other, TripleDouble) else NotImplemented

    def __mul__(self, other: Any) -> TripleDouble:
        if isinstance(other, TripleDouble):
            return self._squared() if other is self else self._product(other)
        if other != 0:
            return NotImplemented
        return self.times(0.0)

    __rmul__ = __mul__

    def _squared(self) -> TripleDouble:
        if self._square is None:
            self._square = self._product(self)
        return self._square

    def _product(self, other: TripleDouble) -> TripleDouble:
        """Return a product.

        Exact are a0 b0 and the products of 2^-53 of it, a0 b1 and a1 b0. Of the third parts, of 2^-106, three are
        rounded products, and four are errors of `seconds`: below 2^-51 of these. Their sum has eight roundings,
        2^-50 of them. Left out are a1 b2, a2 b1 and a2 b2.
        """
        (a0, a1, a2), (b0, b1, b2) = self.parts, other.parts
        high, e0 = two_product(a0, b0)
        q1, e1 = two_product(a0, b1)
        q2, e2 = (q1, e1) if other is self else two_product(a1, b0)
        middle, e3 = two_sum(q1, q2)
        middle, e4 = two_sum(middle, e0)
        t1, t2, t3 = a0 * b2, a2 * b0, a1 * b1
        parts = _normalised(high, middle, ((t1 + t2) + t3) + ((e1 + e2) + (e3 + e4)))
        size_a, size_b, seconds = abs(a0), abs(b0), (abs(q1) + abs(q2)) + abs(e0)
        left_out = (abs(a1) + abs(a2)) * abs(b2) + abs(a2 * b1)
        own = ((abs(t1) + abs(t2)) + abs(t3)) * 2.0**-50 + seconds * 2.0**-101 + left_out
        # a margin of 2^-20 is more than the lesser parts of a and b, and the rounding of the bound
        given = (size_a * other.error + size_b * self.error) * (1.0 + 2.0**-20) + self.error * other.error
        return TripleDouble(parts, own * (1.0 + 2.0**-20) + given, self.twos + other.twos)

    def doubles(self) -> tuple[Any, Any, Any, Any]:
        """Return the nearest doubles, those nearest to the rest, and whether each is certain.

        The parts are summed to s + t + v, t within half a place of s, and v of t: the number is between s + t + v -
        e and s + t + v + e, where rounding is monotonous. It rounds to s if both ends do, and the rest to t if both
        of its ends do. The ends are moved out by what their own roundings may be.
        """
        s, t, v = _normalised(*self.parts)
        t, v = two_sum(t, v)
        s, t = two_sum(s, t)
        beside = self.error + abs(t) * 2.0**-50
        sure = (s + (t + beside) == s) & (s + (t - beside) == s)
        beside = self.error * (1.0 + 2.0**-20) + abs(v) * 2.0**-51
        low_sure = sure & (t + (v + beside) == t) & (t + (v - beside) == t)
        if _is_zero(self.twos):
            return s, t, sure, low_sure
        return _scaled(s, t, self.twos, (sure, low_sure))


def _scaled(s: Any, t: Any, twos: Any, certain: tuple[Any, Any]) -> tuple[Any, Any, Any, Any]:
    """Return s and t times 2^twos, and whether they are certain: not rounded again, or beyond all doubles."""
    sure, low_sure = certain
    about_1 = (abs(s) > 0.1) & (abs(s) < 10.0)
    great, small = about_1 & (twos > OVERFLOWS), about_1 & (twos < UNDERFLOWS)
    with np.errstate(all="ignore"):
        twos = np.clip(twos, -9999.0, 9999.0).astype(np.int64)
        high, low = np.ldexp(s, twos), np.ldexp(t, twos)
        sure = sure & ((np.ldexp(high, -twos) == s) | great | small)
        low_sure = sure & low_sure & ((np.ldexp(low, -twos) == t) | great | small)
    return high, np.where(great, -high, low), sure, low_sure


def _normalised(high: Any, middle: Any, low: Any) -> Parts:
    middle, low = two_sum(middle, low)
    high, middle = two_sum(high, middle)
    return high, middle, low


def _is_zero(x: Any) -> bool:
    """Tell whether a part is zero for all numbers alike."""
    return type(x) is float and x == 0.0


def _power_of_two(exponent: Any) -> Any:
    return 2.0**exponent if isinstance(exponent, float) else np.ldexp(1.0, exponent.astype(np.int64))


def _same(a: Any, b: Any) -> Any:
    if a is not b and not (_is_zero(a) and _is_zero(b)):
        raise TypeError("sums are of numbers with one exponent")
    return a


def _number(x: Any) -> TripleDouble:
    return x if isinstance(x, TripleDouble) else TripleDouble((x, 0.0, 0.0))


_Functions.ln2 = TripleDouble(doubles_of(LOG_2))
