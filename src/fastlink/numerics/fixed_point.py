"""Numbers of 192 binary places for tables of the input angle: Python integers, or arrays of them.

The text of a table runs on them as on numbers of mpmath. Sine and cosine take 6 us instead of 30, one table's cosine
serves the others, and whether a rounding is certain is known: where it is not, the caller uses mpmath.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np

__all__ = ["Fixed", "fixed"]

PLACES = 192
ONE = 1 << PLACES
#: pi / 2 of 256 places, rounded to 192 of them.
HALF_PI = (0x1921FB54442D18469898CC51701B839A252049C1114CF98E804177D4C76273645 + (1 << 63)) >> 64
#: The greatest error of a result, in the last place: 300 by the turns times that of pi, some dozens by the operations.
DOUBT = 1 << 12
#: Greater angles have more turns, lesser ones fewer places than the doubt allows for.
GREATEST_ANGLE, LEAST_ANGLE = 2.0**10, 2.0**-130
#: By this many places the 40 digits of mpmath are rounded, a few times each.
MPMATH_PLACES = 130
#: Cosine and sine are known at multiples of 2^-STEP; the rest is at most half of that.
STEP = 6
TERMS = 11


def _series(first: int) -> list[int]:
    """Return the coefficients in x^2 of the cosine (0) or of the sine over x (1)."""
    return [(-1) ** k * ONE // math.factorial(2 * k + first) for k in range(TERMS)]


COSINE, SINE = _series(0), _series(1)


def _near_zero(x: Any) -> tuple[Any, Any]:
    """Return cosine and sine of at most 2^-(STEP + 1)."""
    square = x * x >> PLACES
    cosine, sine = COSINE[-1], SINE[-1]
    for k in range(TERMS - 2, -1, -1):
        cosine = COSINE[k] + (cosine * square >> PLACES)
        sine = SINE[k] + (sine * square >> PLACES)
    return cosine, sine * x >> PLACES


@cache
def _known() -> tuple[Any, Any]:
    """Return cosine and sine at the multiples of 2^-STEP from -pi/4 to pi/4."""
    most = math.ceil(math.pi / 4 * 2**STEP)
    half_cosine, half_sine = _near_zero(1 << (PLACES - STEP - 1))
    cosine_step = ONE - (2 * half_sine * half_sine >> PLACES)
    sine_step = 2 * half_sine * half_cosine >> PLACES
    cosines, sines = [ONE], [0]
    for _ in range(most):
        c, s = cosines[-1], sines[-1]
        cosines.append((c * cosine_step - s * sine_step) >> PLACES)
        sines.append((s * cosine_step + c * sine_step) >> PLACES)
    both = cosines[:0:-1] + cosines, [-s for s in sines[:0:-1]] + sines
    return np.array(both[0], dtype=object), np.array(both[1], dtype=object)


def _cos_sin(x: Any) -> tuple[Any, Any]:
    """Return cosine and sine of an angle."""
    turns = (x + (HALF_PI >> 1)) // HALF_PI
    rest = x - turns * HALF_PI
    nearest = (rest + (1 << (PLACES - STEP - 1))) >> (PLACES - STEP)
    c, s = _near_zero(rest - (nearest << (PLACES - STEP)))
    cosines, sines = _known()
    at = nearest + len(cosines) // 2
    at = at if isinstance(at, int) else at.astype(np.intp)
    known_c, known_s = cosines[at], sines[at]
    cosine = (known_c * c - known_s * s) >> PLACES
    sine = (known_s * c + known_c * s) >> PLACES
    quarter = turns & 3
    if isinstance(quarter, int):
        return ((cosine, sine), (-sine, cosine), (-cosine, -sine), (sine, -cosine))[quarter]
    quarter = quarter.astype(np.intp)
    odd = quarter & 1 == 1
    first, second = np.where(odd, sine, cosine), np.where(odd, cosine, sine)
    return np.where((quarter + 1) & 2 == 2, -first, first), np.where(quarter & 2 == 2, -second, second)


class _Comparison:
    """The result of a comparison, for `fastlink.numerics.elementary.select`."""

    def __init__(self, holds: Any) -> None:
        self.holds = holds

    def choose(self, if_true: Fixed, if_false: Fixed) -> Fixed:
        """Return the first number where the comparison holds, else the second."""
        if isinstance(self.holds, np.ndarray):
            chosen = np.where(self.holds, if_true.value, if_false.value)
            return Fixed(chosen, if_true.lost + if_false.lost)
        return if_true if self.holds else if_false


class _Functions:
    """The functions of angles, in place of those of mpmath."""

    @staticmethod
    def cos(x: Fixed) -> Fixed:
        return Fixed(x.cos_sin[0])

    @staticmethod
    def sin(x: Fixed) -> Fixed:
        return Fixed(x.cos_sin[1])


class Fixed:
    """Numbers; an operation without a rule is a TypeError or AttributeError."""

    __slots__ = ("_cos_sin", "_half", "lost", "value")
    context = _Functions

    def __init__(self, value: Any, lost: Any = 0) -> None:
        # `lost` is how much 40 digits lose where the terms of a sum undo each other, in the last place
        self.value, self.lost = value, lost
        self._cos_sin: tuple[Any, Any] | None = None
        self._half: Fixed | None = None

    @property
    def cos_sin(self) -> tuple[Any, Any]:
        """Cosine and sine, computed once."""
        if self._cos_sin is None:
            self._cos_sin = _cos_sin(self.value)
        return self._cos_sin

    def __mul__(self, other: Any) -> Fixed:
        if isinstance(other, Fixed):
            lost = (abs(self.value) * other.lost + abs(other.value) * self.lost) >> PLACES
            return Fixed(self.value * other.value >> PLACES, lost)
        return Fixed(self.value * other, self.lost * abs(other)) if isinstance(other, int) else NotImplemented

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Fixed:
        if other != 2:
            return NotImplemented
        if self._half is None:
            self._half = Fixed(self.value >> 1, self.lost)
        return self._half

    def __add__(self, other: Any) -> Fixed:
        if not isinstance(other, Fixed):
            return NotImplemented
        lost = ((abs(self.value) + abs(other.value)) >> MPMATH_PLACES) + self.lost + other.lost
        return Fixed(self.value + other.value, lost)

    def __sub__(self, other: Any) -> Fixed:
        return self + -other if isinstance(other, Fixed) else NotImplemented

    def __neg__(self) -> Fixed:
        return Fixed(-self.value, self.lost)

    def __abs__(self) -> Fixed:
        return Fixed(abs(self.value), self.lost)

    def __lt__(self, other: Any) -> _Comparison:
        return _Comparison(self.value < math.floor(math.ldexp(other, PLACES)))

    def doubles(self, doubt: Any) -> tuple[Any, Any, Any]:
        """Return the nearest doubles, their low parts, and whether both are certain.

        Parameters
        ----------
        doubt : int or array of int
            The greatest error of the value, in units of the last place.
        """
        value = self.value
        doubt = doubt + ((abs(value) >> MPMATH_PLACES) + self.lost) * (doubt > 0)
        high, other_high = _double(value - doubt), _double(value + doubt)
        rest = value - _integer(high)
        low, other_low = _double(rest - doubt), _double(rest + doubt)
        sure = (high == other_high) & (low == other_low)
        return np.ldexp(high, -PLACES), np.ldexp(low, -PLACES), sure


def _double(value: Any) -> Any:
    return float(value) if isinstance(value, int) else value.astype(np.float64)


def _integer(value: Any) -> Any:
    return int(value) if isinstance(value, float) else np.frompyfunc(int, 1, 1)(value)


def fixed(angles: Any) -> tuple[Fixed, Any]:
    """Return doubles as fixed-point numbers, and the doubt of their results.

    Angles out of range count as 0, with a doubt that leaves no rounding certain.
    """
    size = abs(angles)
    fit = (size < GREATEST_ANGLE) & (size > LEAST_ANGLE)
    if isinstance(angles, float):
        if not fit:
            return Fixed(0), 0 if angles == 0.0 else ONE
        mantissa, exponent = math.frexp(angles)
        return Fixed(int(mantissa * 2.0**53) << (exponent + PLACES - 53)), DOUBT
    mantissas, exponents = np.frexp(np.where(fit, angles, 0.0))
    shifts = np.where(fit, exponents + (PLACES - 53), 0).astype(object)
    values = (mantissas * 2.0**53).astype(np.int64).astype(object) << shifts
    doubts = np.array([0, DOUBT, ONE], dtype=object)
    return Fixed(values), doubts[np.where(angles == 0.0, 0, np.where(fit, 1, 2))]
