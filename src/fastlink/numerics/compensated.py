"""Sums and products that keep every digit.

All functions are straight-line code with the three readings of `fastlink.numerics.elementary`. An unevaluated sum of
two doubles ``(high, low)`` carries about 32 digits; one of mpmath numbers carries twice their digits, too, and is
computed with so many: these steps as written were half the time of a verification.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any

from fastlink.numerics.compiler import compiled_as, inlined
from fastlink.numerics.elementary import context_of, select

__all__ = [
    "gap_product_quotient",
    "pair_product",
    "pair_quotient",
    "power_of_two_below",
    "square_sum",
    "sum_of_four",
    "two_product",
    "two_sum",
]


# Veltkamp's constant splits a double into two halves of 26 bits, whose products are exact.
SPLITTER = 134217729.0
#: The greatest relative error of one operation on doubles.
UNIT_ROUNDING = 2.0**-53


def _kept(exact: Callable[..., Any]) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Let a text that keeps every digit of doubles be `exact` with twice the digits on mpmath numbers."""

    def declare(text: Callable[..., Any]) -> Callable[..., Any]:
        @compiled_as(text)
        @wraps(text)
        def function(*args: Any) -> Any:
            context = context_of(*args)
            if not hasattr(context, "workprec"):
                return text(*args)
            with context.workprec(2 * context.prec):
                value = exact(*args)
            high = +value
            return high, value - high

        return function

    return declare


@_kept(lambda a, b: a + b)
def two_sum(a: Any, b: Any) -> Any:
    """Return the rounded sum and its exact rounding error."""
    s = a + b
    t = s - a
    return s, (a - (s - t)) + (b - t)


@inlined
def split(a: Any) -> Any:
    """Return two halves of a double, whose products with such halves are exact."""
    c = SPLITTER * a
    a1 = c - (c - a)
    return a1, a - a1


@inlined
def product_rest(p: Any, a1: Any, a2: Any, b1: Any, b2: Any) -> Any:
    """Return the rounding error of a product p of doubles, which are given split."""
    return a2 * b2 - (((p - a1 * b1) - a2 * b1) - a1 * b2)


@_kept(lambda a, b: a * b)
def two_product(a: Any, b: Any) -> Any:
    """Return the rounded product and its rounding error, without fused multiply-add."""
    p = a * b
    a1, a2 = split(a)
    b1, b2 = split(b)
    return p, product_rest(p, a1, a2, b1, b2)


@_kept(lambda a, b, c, d: (a + b) + (c + d))
def sum_of_four(a: Any, b: Any, c: Any, d: Any) -> Any:
    """Return a + b + c + d as (high, low): exact to twice the working precision.

    The eight factors of the input-output coefficients are such sums; near a change point they cancel.
    """
    s1, e1 = two_sum(a, b)
    s2, e2 = two_sum(c, d)
    s, e = two_sum(s1, s2)
    # e1 + e2 may be as large as the sum itself where everything else cancels: keep its error too.
    f, g = two_sum(e1, e2)
    h, k = two_sum(e, f)
    high, low = two_sum(s, h)
    return two_sum(high, low + (k + g))


@_kept(lambda a, a_low, b, b_low: (a + a_low) * (b + b_low))
def pair_product(a: Any, a_low: Any, b: Any, b_low: Any) -> Any:
    """Return the product of two unevaluated sums, as one."""
    p, e = two_product(a, b)
    return two_sum(p, e + (a * b_low + a_low * b))


@_kept(lambda a, a_low, b, b_low: (a + a_low) / (b + b_low))
def pair_quotient(a: Any, a_low: Any, b: Any, b_low: Any) -> Any:
    """Return the quotient of two unevaluated sums, as one; infinite where b is zero."""
    quotient = a / b
    p, e = two_product(quotient, b)
    correction = ((a - p) - e + (a_low - quotient * b_low)) / b
    return two_sum(quotient, select(correction == correction, correction, 0.0))


@_kept(lambda a, f, f_low, b: a * a + (f + f_low) * (b * b))
def square_sum(a: Any, f: Any, f_low: Any, b: Any) -> Any:
    """Return a^2 + f b^2 as (high, low), for an unevaluated sum f."""
    a_square, a_square_low = two_product(a, a)
    b_square, b_square_low = two_product(b, b)
    product, product_low = pair_product(f, f_low, b_square, b_square_low)
    return sum_of_four(a_square, a_square_low, product, product_low)


@_kept(lambda f, f_low, g, g_low, x, y: (f + f_low) * (g + g_low) / (4 * x * y))
def gap_product_quotient(f: Any, f_low: Any, g: Any, g_low: Any, x: Any, y: Any) -> Any:
    """Return f g / (4 x y) as (high, low), for unevaluated sums f and g."""
    n, n_low = pair_product(f, f_low, g, g_low)
    m, m_low = two_product(4.0 * x, y)
    quotient = n / m
    p, e = two_product(quotient, m)
    correction = ((n - p) - e + (n_low - quotient * m_low)) / m
    return two_sum(quotient, correction)


@inlined
def _unit_in_first_place(x: Any) -> Any:
    q = (2.0**52 + 1.0) * x
    return abs(q - (1.0 - UNIT_ROUNDING) * q)


@compiled_as(_unit_in_first_place)
def power_of_two_below(x: Any) -> Any:
    """Return the greatest power of two up to x > 0: its unit in the first place."""
    context = context_of(x)
    if hasattr(context, "ldexp") and 0 < x < context.inf:
        return context.ldexp(1, context.frexp(x)[1] - 1)
    return _unit_in_first_place(x)
