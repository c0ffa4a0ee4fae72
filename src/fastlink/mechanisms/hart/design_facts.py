"""Facts of one design of Hart's linkage, over a power of two near its longest given bar.

Whether it assembles, where its toggles are, how long its line is: all of it follows from r - e and r + e for four
reaches r = (1 +- K)(m +- n), with K = |kappa| and e = d, or -d where K > 1. They are products of sums in twice the
working precision, so no difference from d cancels. But for factors 1 +- K they are the eight factors of the four-bar
MABN (eq. (1) of Hayes et al.), which lose all digits where kappa is near 1 or -1; these do not.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared import lengths
from fastlink.mechanisms._shared.laws import opposite, product, size
from fastlink.mechanisms.hart.inputs import PAGE, hart
from fastlink.numerics.compensated import (
    UNIT_ROUNDING,
    gap_product_quotient,
    pair_product,
    sum_of_four,
    two_sum,
)
from fastlink.numerics.elementary import NOT_A_NUMBER, select
from fastlink.numerics.vectors import zero_where

NUMERICS = f"{PAGE}#numerics"
#: Beyond these powers of two the fourth power of kappa, or of its inverse, is not a double.
LEAST_KAPPA, GREATEST_KAPPA = 2.0**-200, 2.0**200

step = hart.steps(units="1", source=NUMERICS)
# the facts of the scale are made for four lengths: three are given
step(lengths.valid, "lengths_are_valid", "lengths_are_valid", a1="m", a2="n", a3="d", a4="d")
step(lengths.lift, "lift", "lift", a1="m", a2="n", a3="d", a4="d")
step(lengths.unit, "unit", "unit", a1="m", a2="n", a3="d", a4="d", units="m")
step(lengths.scaled, "s_m", "s_m", "scaled length m", length="m")
step(lengths.scaled, "s_n", "s_n", "scaled length n", length="n")
step(lengths.scaled, "s_d", "s_d", "scaled length d", length="d")
step(size, "K", "K", "Size of kappa", x="kappa")


@hart.quantity(units="1", symbol="valid", source=NUMERICS, internal=True)
def valid(lengths_are_valid: Any, K: Any) -> Any:
    """1 where the lengths are, and kappa is not 0, 1 or -1, nor beyond its limits; else NaN."""
    within = (K >= LEAST_KAPPA) & (K <= GREATEST_KAPPA) & (K != 1.0)
    return select(within & (lengths_are_valid == 1.0), 1.0, NOT_A_NUMBER)


@hart.quantity(units="1", symbol="sgn lambda", source=NUMERICS, internal=True)
def lambda_sign(K: Any) -> Any:
    """1 where P lies on the ray from M through A, -1 where it lies beyond M; and alike for Q."""
    return select(K < 1.0, 1.0, -1.0)


step(opposite, "minus_K", "minus_K", "-K", x="K")
step(opposite, "minus_s_n", "minus_s_n", "minus the scaled length n", x="s_n")
step(product, "e", "e", "d, or -d where K > 1, scaled", x="lambda_sign", y="s_d")
step(opposite, "minus_e", "minus_e", "-e", x="e")


@hart.quantity(units="1", symbol="|lambda|", source=NUMERICS, internal=True, low="size_lambda_low")
def size_lambda(K: Any, lambda_sign: Any) -> Any:
    """Size of 1 - kappa^2."""
    less, less_low = two_sum(1.0, -K)
    more, more_low = two_sum(1.0, K)
    high, low = pair_product(less, less_low, more, more_low)
    return lambda_sign * high, lambda_sign * low


# -- reaches --------------------------------------------------------------------------------------------------


def reach(K: Any, s_m: Any, s_n: Any) -> Any:
    """Return (1 + K)(m + n)."""
    k, k_low = two_sum(1.0, K)
    sum_, sum_low = two_sum(s_m, s_n)
    return pair_product(k, k_low, sum_, sum_low)


@hart.quantity(units="1", symbol="u P", source=NUMERICS, internal=True)
def gap_rounding(far_sum: Any, s_d: Any) -> Any:
    """Effect of half a unit in the last place of each length on a reach less d, which counts as 0 below it."""
    return UNIT_ROUNDING * (far_sum + s_d)


def unless_rounding(reach: Any, reach_low: Any, other: Any, gap_rounding: Any) -> Any:
    """Return the sum of a reach and another length, 0 within the rounding of the lengths."""
    total, _low = sum_of_four(reach, reach_low, other, 0.0)
    return zero_where(abs(total) <= gap_rounding, total)


def declare_reach(name: str, text: str, **given: str) -> None:
    """Declare a reach, its excess over e and -e, and the excess of its square over that of d."""
    low, less, plus = f"{name}_low", f"{name}_less", f"{name}_plus"
    step(reach, name, text, text, low=low, **given)
    step(unless_rounding, less, text, f"{text} - e", reach=name, reach_low=low, other="minus_e")
    step(unless_rounding, plus, text, f"{text} + e", reach=name, reach_low=low, other="e")
    step(product, f"{name}_excess", text, f"square of {text} less that of d", x=less, y=plus)


declare_reach("far_sum", "(1 + K)(m + n)", K="K", s_n="s_n")
declare_reach("far_difference", "(1 + K)(m - n)", K="K", s_n="minus_s_n")
declare_reach("near_sum", "(1 - K)(m + n)", K="minus_K", s_n="s_n")
declare_reach("near_difference", "(1 - K)(m - n)", K="minus_K", s_n="minus_s_n")


@hart.quantity(units="1", symbol="assembles", source=f"{PAGE}#stroke", internal=True)
def assembles(far_sum_excess: Any, near_difference_excess: Any, valid: Any) -> Any:
    """1 where |1 - K||m - n| <= d <= (1 + K)(m + n), else 0."""
    within = (far_sum_excess >= 0.0) & (near_difference_excess <= 0.0)
    return select(within & (valid == 1.0), 1.0, 0.0)


# -- toggles of the four-bar MABN by phi ----------------------------------------------------------------------


def toggle(
    near_sum: Any, near_sum_low: Any, far_difference: Any, far_difference_low: Any, other: Any, divisor: Any,
    s_m: Any, gap_rounding: Any, valid: Any,
) -> Any:  # fmt: skip
    """Return (near_sum + other)(far_difference + other)/(4 m divisor)."""
    f, f_low = sum_of_four(near_sum, near_sum_low, other, 0.0)
    g, g_low = sum_of_four(far_difference, far_difference_low, other, 0.0)
    high, low = gap_product_quotient(f, f_low, g, g_low, s_m, divisor)
    none = (abs(f) <= gap_rounding) | (abs(g) <= gap_rounding)
    return select(valid == 1.0, zero_where(none, high), NOT_A_NUMBER), zero_where(none, low)


_INNER = "squared sine of half of phi at the inner toggle, negative if none"
_OUTER = "squared cosine of half of phi at the outer toggle, negative if none"
step(toggle, "Z0", "Z_0", _INNER, other="minus_e", divisor="minus_e", low="Z0_low")
step(toggle, "C0", "C_0", _OUTER, other="e", divisor="e", low="C0_low")
