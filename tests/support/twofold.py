"""Arrays of unevaluated sums of two doubles, 31 digits: a reference for millions of configurations.

Facts run on them as they are; of their angles and logarithms 19 digits are right.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fastlink.numerics import compensated
from fastlink.numerics.compensated import two_sum
from fastlink.numerics.elementary import PI, TWO_PI

#: What the double nearest to pi lacks.
PI_LOW = 1.2246467991473532e-16


def two_product(a, b):
    """Return the rounded product and its rounding error, of great numbers too."""
    # splitting what is greater would overflow
    up, other = (np.where(np.abs(x) > 2.0**900, 2.0**100, 1.0) for x in (a, b))
    p, e = compensated.two_product(a / up, b / other)
    return p * up * other, e * up * other


@dataclass(frozen=True, eq=False)
class Truth:
    """Truth values that `select` chooses by, and what they are to a function that asks but once."""

    values: Any
    alone: bool = True

    def choose(self, if_true, if_false):
        a, b = twofold(if_true), twofold(if_false)
        return Twofold(*(np.where(self.values, x, y) for x, y in ((a.high, b.high), (a.low, b.low))))

    def __and__(self, other):
        return Truth(self.values & other.values)

    def __or__(self, other):
        return Truth(self.values | other.values)

    def __eq__(self, other):
        return Truth(self.values == other.values)

    def __bool__(self):
        return self.alone


@dataclass(frozen=True, eq=False)
class Twofold:
    """Numbers high + low."""

    high: Any
    low: Any

    @property
    def context(self):
        return Functions

    def __add__(self, other):
        other = twofold(other)
        s, e = two_sum(self.high, other.high)
        t, f = two_sum(self.low, other.low)
        s, e = two_sum(s, e + t)
        return normal(s, e + f)

    def __mul__(self, other):
        other = twofold(other)
        p, e = two_product(self.high, other.high)
        return normal(p, e + (self.high * other.low + self.low * other.high))

    def __truediv__(self, other):
        other = twofold(other)
        first = self.high / other.high
        rest = self - other * first
        second = rest.high / other.high
        rest = rest - other * second
        return Twofold(first, np.zeros_like(first)) + normal(second, rest.high / other.high)

    def __neg__(self):
        return Twofold(-self.high, -self.low)

    def __abs__(self):
        return Truth(self.high < 0).choose(-self, self)

    def __sub__(self, other):
        return self + -twofold(other)

    def __rsub__(self, other):
        return twofold(other) - self

    def __rtruediv__(self, other):
        return twofold(other) / self

    __radd__, __rmul__ = __add__, __mul__

    def _compare(self, other, operation):
        other = twofold(other)
        equal = self.high == other.high
        return Truth(
            np.where(equal, operation(self.low, other.low), operation(self.high, other.high)).astype(bool)
        )

    def __lt__(self, other):
        return self._compare(other, np.less)

    def __le__(self, other):
        return self._compare(other, np.less_equal)

    def __gt__(self, other):
        return self._compare(other, np.greater)

    def __ge__(self, other):
        return self._compare(other, np.greater_equal)

    def __eq__(self, other):
        return Truth(self._compare(other, np.equal).values, alone=False)

    def __ne__(self, other):
        other = twofold(other)
        return Truth((self.high != other.high) | (self.low != other.low))

    def long(self):
        return self.high.astype(np.longdouble) + self.low


def normal(high, low):
    """Return a sum; where it is infinite the low word is zero."""
    s = high + low
    return Twofold(s, np.where(np.isfinite(s), low - (s - high), 0.0))


def twofold(x):
    if isinstance(x, Twofold):
        return x
    # Pi in the text of a fact stands for all its digits, as in the reference with 50.
    low = PI_LOW * (x / PI) if isinstance(x, float) and x in (PI, TWO_PI) else 0.0
    return Twofold(np.asarray(x, dtype=float), np.asarray(low))


def rounded(x):
    """Return long doubles as unevaluated sums."""
    high = x.astype(float)
    return Twofold(high, np.where(np.isfinite(high), (x - high).astype(float), 0.0))


class Functions:
    """The elementary functions of `fastlink.numerics.elementary` for these numbers."""

    nan, inf, ln2 = (
        np.nan,
        np.inf,
        Twofold(np.asarray(0.6931471805599453), np.asarray(2.3190468138462996e-17)),
    )

    @staticmethod
    def sqrt(x):
        root = np.sqrt(x.high)
        change = (x - Twofold(*two_product(root, root))).high / np.where(root > 0, 2 * root, 1.0)
        return normal(root, np.where((root > 0) & (root < np.inf), change, 0.0))

    @staticmethod
    def atan2(y, x):
        return rounded(np.arctan2(twofold(y).long(), twofold(x).long()))

    @staticmethod
    def log(x):
        # log(high + low) = log(high) + low/high to 32 digits; long doubles near 1 have their digits of high - 1
        near = np.abs(x.high - 1.0) < 0.5
        beside = np.log1p((x.high.astype(np.longdouble) - 1.0) + x.low)
        return rounded(np.where(near, beside, np.log(x.long())))

    @staticmethod
    def log1p(x):
        return rounded(np.log1p(x.long()))

    @staticmethod
    def sign(x):
        return Twofold(np.sign(x.high), np.zeros_like(x.high))

    @staticmethod
    def cos(x):
        return rounded(np.cos(x.long()))

    @staticmethod
    def sin(x):
        return rounded(np.sin(x.long()))
