"""Unevaluated sums of three doubles with bounds of their errors, for tables of the input position.

The text of a table runs on them as on numbers of mpmath, one angle or an array of them: some hundred operations on
doubles and no integer of many places. Whether the rounding of a result is certain is known: where it is not, the
caller uses mpmath.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.numerics.compensated import two_product, two_sum
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER, select
from fastlink.numerics.rotation import LOG_2, Parts, circular, doubles_of, hyperbolic, nearest_integer

__all__ = ["TripleDouble"]

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
    """Numbers (high + middle + low) 2^twos; an operation without a rule is a TypeError or AttributeError.

    Parameters
    ----------
    parts : tuple
        Three doubles, or arrays of them.
    error : float or array
        The greatest error of their sum; zero where it is exact.
    twos : float or array
        An exponent of two.
    """

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
