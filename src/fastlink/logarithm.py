"""Logarithms that vectorise: compiled, NumPy, and mpmath readings, as everything of `fastlink.jit`.

The compiled reading splits the exponent off by the bits of the number and takes the rest by one division and a
polynomial, as FDLIBM does; it calls nothing, so a loop around it vectorises.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.jit import INFINITY, NOT_A_NUMBER, compiled_as, context_of, inlined, select, sqrt

__all__ = ["arsinh", "log", "log1p", "log_scaled"]

# Minimax coefficients of (log((1 + s)/(1 - s))/s - 2)/s^2 in s^2 for |s| <= tanh(log(2)/4): 2^-58.5 of the logarithm.
LOG_COEFFICIENTS = (
    0.6666666666666734,
    0.39999999999414687,
    0.28571428742385296,
    0.22222198573435217,
    0.18183564312537193,
    0.15314050911953672,
    0.14795945995518506,
)
(_L0, _L1, _L2, _L3, _L4, _L5, _L6) = LOG_COEFFICIENTS
# log(2) = high + low; high has 32 bits, so that multiples of it up to 2^21 are exact.
LN_2_HIGH = float.fromhex("0x1.62e42feep-1")
LN_2_LOW = float.fromhex("0x1.a39ef35793c76p-33")
# Beyond it sqrt(1 + x x) is x, and x x may overflow.
LARGE = 2.0**500
BITS_OF_ONE, BITS_OF_ROOT_HALF, FRACTION_BITS = 0x3FF0000000000000, 0x3FE6A09E667F3BCD, 0x000FFFFFFFFFFFFF


@inlined
def _binary_parts(x: Any) -> Any:
    """Return k and f for a positive x = 2^k (1 + f) with 1 + f between the roots of 1/2 and 2."""
    tiny = x < 2.0**-1022
    bits = np.float64(select(tiny, x * 2.0**54, x)).view(np.int64) + (BITS_OF_ONE - BITS_OF_ROOT_HALF)
    k = ((bits >> 52) - 1023) * 1.0 - select(tiny, 54.0, 0.0)
    return k, np.int64((bits & FRACTION_BITS) + BITS_OF_ROOT_HALF).view(np.float64) - 1.0


@inlined
def _log_of_parts(k: Any, f: Any, more: Any) -> Any:
    """Return k log(2) + log(1 + f) + more, for a small last term."""
    half_square = 0.5 * f * f
    s = f / (2.0 + f)
    z = s * s
    z2 = z * z
    series = ((_L0 + _L1 * z) + (_L2 + _L3 * z) * z2) + ((_L4 + _L5 * z) + _L6 * z2) * (z2 * z2)
    return k * LN_2_HIGH + (((s * (half_square + series * z) + (k * LN_2_LOW + more)) - half_square) + f)


@inlined
def _polynomial_log(x: Any, twos: Any) -> Any:
    k, f = _binary_parts(x)
    found = select(x < INFINITY, _log_of_parts(k + twos, f, 0.0), x)
    return select(x > 0.0, found, select(x == 0.0, -INFINITY, NOT_A_NUMBER))


@inlined
def _polynomial_log1p(x: Any) -> Any:
    y = 1.0 + x
    t = y - 1.0
    lost = (1.0 - (y - t)) + (x - t)
    k, f = _binary_parts(y)
    near = k == 0.0
    found = _log_of_parts(k, select(near, x, f), select(near, 0.0, lost / y))
    found = select(x == 0.0, x, select(x < INFINITY, found, x))
    return select(x > -1.0, found, select(x == -1.0, -INFINITY, NOT_A_NUMBER))


@compiled_as(_polynomial_log)
def log_scaled(x: Any, twos: Any) -> Any:
    """Natural logarithm of x times 2 to a whole number: of what may be beyond the range of doubles."""
    context = context_of(x)
    if context is not None:
        below = -context.inf if x == 0 else context.nan
        return context.log(x) + twos * context.ln2 if x > 0 else below
    with np.errstate(all="ignore"):
        return np.asarray(_polynomial_log(np.asarray(x, dtype=float), twos))[()]


@compiled_as(_polynomial_log1p)
def log1p(x: Any) -> Any:
    """Natural logarithm of 1 + x, within 2 units in the last place, also for small x."""
    context = context_of(x)
    if context is not None:
        below = -context.inf if x == -1 else context.nan
        return context.log1p(x) if x > -1 else below
    with np.errstate(all="ignore"):
        return np.asarray(_polynomial_log1p(np.asarray(x, dtype=float)))[()]


@inlined
def log(x: Any) -> Any:
    """Natural logarithm, within 2 units in the last place; -inf at zero, NaN below."""
    return log_scaled(x, 0.0)


@inlined
def arsinh(x: Any) -> Any:
    """Area hyperbolic sine of x >= 0, within 3 units in the last place; beyond 2^500 it is log(2 x)."""
    return log1p(x + x * select(x < LARGE, x / (1.0 + sqrt(1.0 + x * x)), 1.0))
