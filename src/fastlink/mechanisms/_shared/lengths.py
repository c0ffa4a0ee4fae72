"""Facts of the four lengths of a linkage, of whatever plane: validity, and a scale that is exact.

Lengths enter the kinematics as ratios only. They are first divided by a power of two near the longest, which keeps
their products from overflow and underflow.
"""

from __future__ import annotations

from typing import Any

from fastlink.numerics.compensated import power_of_two_below
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER, select
from fastlink.numerics.vectors import largest

# Powers of two: beyond SMALL and LARGE the products of lengths need a lift.
SMALL, LARGE = 2.0**-500, 2.0**500
UP, DOWN = 2.0**540, 2.0**-540


def valid(a1: Any, a2: Any, a3: Any, a4: Any) -> Any:
    """1 where all four lengths are positive and finite, else NaN."""
    positive = (a1 > 0.0) & (a2 > 0.0) & (a3 > 0.0) & (a4 > 0.0)
    finite = (a1 < INFINITY) & (a2 < INFINITY) & (a3 < INFINITY) & (a4 < INFINITY)
    return select(positive & finite, 1.0, NOT_A_NUMBER)


def lift(a1: Any, a2: Any, a3: Any, a4: Any) -> Any:
    """A power of two that brings the longest link into the middle of the exponents."""
    longest = largest(a1, a2, a3, a4)
    return select(longest < SMALL, UP, select(longest > LARGE, DOWN, 1.0))


def unit(a1: Any, a2: Any, a3: Any, a4: Any, lift: Any) -> Any:
    """The power of two at or below the longest link, times lift."""
    return power_of_two_below(largest(a1, a2, a3, a4) * lift)


def scaled(length: Any, lift: Any, unit: Any) -> Any:
    """Length over the power of two near the longest."""
    return length * lift / unit
