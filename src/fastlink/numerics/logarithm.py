"""Logarithms that vectorise, with the three readings of `fastlink.numerics.elementary`.

The compiled reading splits the exponent off by the bits of the number and takes the rest by one division and a
polynomial, as FDLIBM does; it calls nothing, so a loop around it vectorises.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.numerics.compiler import inlined
from fastlink.numerics.elementary import (
    INFINITY,
    NOT_A_NUMBER,
    bits_of,
    context_of,
    double_of,
    of_mpmath,
    select,
    sqrt,
)

# Minimax coefficients of (log((1 + s)/(1 - s))/s - 2)/s^2 in s^2 for |s| <= 0.2005: 2^-55.8 of the logarithm.
(_L0, _L1, _L2, _L3, _L4, _L5, _L6) = (
    0.666666666666729,
    0.39999999996057706,
    0.2857142941420829,
    0.2222213693929062,
    0.18186420619325075,
    0.1524888774956877,
    0.15378368156080974,
)
# log(2) = high + low; high has 32 bits, so that multiples of it up to 2^21 are exact.
LN_2_HIGH = float.fromhex("0x1.62e42feep-1")
LN_2_LOW = float.fromhex("0x1.a39ef35793c76p-33")
LN_2 = LN_2_HIGH + LN_2_LOW
# Beyond it sqrt(1 + x x) is x, so that arsinh x is log(2 x), and x x may overflow.
GREATEST_SQUARED = 2.0**500
# The bits of 2^-1021, and the distance to those of 2^1022: between them a change of exponent brings two numbers close.
BITS_OF_LEAST, BITS_OF_RANGE = 2 << 52, np.uint64(2043 << 52)
HALF_AN_EXPONENT = 1 << 51
BITS_OF_ONE, BITS_OF_ROOT_HALF, FRACTION_BITS = 0x3FF0000000000000, 0x3FE6A09E667F3BCD, 0x000FFFFFFFFFFFFF


@inlined
def _binary_parts(x: Any) -> Any:
    """Return k and f of x = 2^k (1 + f) > 0, 1 + f between the roots of 1/2 and 2."""
    tiny = x < 2.0**-1022
    bits = bits_of(select(tiny, x * 2.0**54, x)) + (BITS_OF_ONE - BITS_OF_ROOT_HALF)
    k = ((bits >> 52) - 1023) * 1.0 - select(tiny, 54.0, 0.0)
    return k, double_of((bits & FRACTION_BITS) + BITS_OF_ROOT_HALF) - 1.0


@inlined
def _series(z: Any) -> Any:
    """Return (log((1 + s)/(1 - s))/s - 2)/z for z = s s."""
    z2 = z * z
    return ((_L0 + _L1 * z) + (_L2 + _L3 * z) * z2) + ((_L4 + _L5 * z) + _L6 * z2) * (z2 * z2)


@inlined
def _log_of_parts(k: Any, f: Any, more: Any) -> Any:
    """Return k log(2) + log(1 + f) + more, for a small last term."""
    half_square = 0.5 * f * f
    s = f / (2.0 + f)
    z = s * s
    return k * LN_2_HIGH + (((s * (half_square + _series(z) * z) + (k * LN_2_LOW + more)) - half_square) + f)


@inlined
def _polynomial_log(x: Any) -> Any:
    k, f = _binary_parts(x)
    value = select(x < INFINITY, _log_of_parts(k, f, 0.0), x)
    return select(x > 0.0, value, select(x == 0.0, -INFINITY, NOT_A_NUMBER))


@inlined
def _in_range(x_bits: Any, y_bits: Any) -> Any:
    """Tell by the bits of two positive numbers whether both are in range."""
    x_above, y_above = np.uint64(x_bits - BITS_OF_LEAST), np.uint64(y_bits - BITS_OF_LEAST)
    return select(x_above > y_above, x_above, y_above) < BITS_OF_RANGE


@inlined
def _polynomial_log_quotient(x: Any, y: Any, twos: Any) -> Any:
    x, y = abs(x), abs(y)
    x_bits, y_bits = bits_of(x), bits_of(y)
    # The difference of the bits is that of the logarithms to 0.09 doublings: x/(2^k y) is between 1/1.51 and 1.51.
    k = (x_bits - y_bits + HALF_AN_EXPONENT) >> 52
    near = double_of(y_bits + (k << 52))
    s = (x - near) / (x + near)
    z = s * s
    value = (k + twos) * LN_2 + ((s + s) + (s * z) * _series(z))
    return select(_in_range(x_bits, y_bits), value, NOT_A_NUMBER)


@inlined
def _signed_quotient(x: Any, y: Any) -> Any:
    in_range = _in_range(bits_of(abs(x)), bits_of(abs(y)))
    return select(in_range, np.copysign(1.0, x) * np.copysign(1.0, y), 0.0)


@inlined
def _polynomial_log1p(x: Any) -> Any:
    y = 1.0 + x
    t = y - 1.0
    lost = (1.0 - (y - t)) + (x - t)
    k, f = _binary_parts(y)
    near = k == 0.0
    value = _log_of_parts(k, select(near, x, f), select(near, 0.0, lost / y))
    value = select(x == 0.0, x, select(x < INFINITY, value, x))
    return select(x > -1.0, value, select(x == -1.0, -INFINITY, NOT_A_NUMBER))


@of_mpmath(_polynomial_log)
def log(x: Any) -> Any:
    """Natural logarithm, within 2 units in the last place; -inf at zero, NaN below."""
    context = context_of(x)
    below = -context.inf if x == 0 else context.nan
    return context.log(x) if x > 0 else below


@of_mpmath(_polynomial_log_quotient)
def log_quotient(x: Any, y: Any, twos: Any) -> Any:
    """Natural logarithm of abs(x/y) times an integer power of two.

    NaN unless x and y are between 2^-1021 and 2^1022 in magnitude. One division takes the place of two, that of the
    quotient and that of its logarithm.
    """
    context = context_of(x, y)
    return context.nan if x == 0 or y == 0 else context.log(abs(x / y)) + twos * context.ln2


@of_mpmath(_signed_quotient)
def quotient_sign(x: Any, y: Any) -> Any:
    """1 or -1, the sign of x/y; 0 where `log_quotient` is NaN."""
    context = context_of(x, y)
    return context.sign(x) * context.sign(y) if x == x and y == y else context.zero


@of_mpmath(_polynomial_log1p)
def log1p(x: Any) -> Any:
    """Natural logarithm of 1 + x, within 2 units in the last place, also for small x."""
    context = context_of(x)
    below = -context.inf if x == -1 else context.nan
    return context.log1p(x) if x > -1 else below


@inlined
def arsinh(x: Any) -> Any:
    """Area hyperbolic sine of x >= 0, within 3 units in the last place."""
    return log1p(x + x * select(x < GREATEST_SQUARED, x / (1.0 + sqrt(1.0 + x * x)), 1.0))
