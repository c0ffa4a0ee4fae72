"""The elementary functions of the facts.

Every function here has three readings: compiled (vectorisable, no libm call), NumPy, and mpmath. Arithmetic is strict
IEEE: a quantity has the same bits whatever else is requested and however a sweep is cut.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any

import numpy as np

from fastlink.numerics.compiler import compiled_as, inlined

PI, TWO_PI = 3.141592653589793, 6.283185307179586
#: Of an angle that is a sum or difference of refined angles: some dozens of roundings, over their size.
ANGLE_ROUNDING = 2.0**-47
INFINITY = float("inf")
NOT_A_NUMBER = float("nan")


def context_of(*values: Any) -> Any:
    """Return the mpmath context of the first value that has one, else None."""
    for value in values:
        context = getattr(value, "context", None)
        if context is not None:
            return context
    return None


def of_mpmath(text: Callable[..., Any]) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Let kernels and NumPy read a function as `text`; its own body is for numbers of mpmath."""

    def declare(exact: Callable[..., Any]) -> Callable[..., Any]:
        @compiled_as(text)
        @wraps(exact)
        def function(*args: Any) -> Any:
            if context_of(*args) is not None:
                return exact(*args)
            with np.errstate(all="ignore"):  # of branches that are not selected
                return np.asarray(text(*(np.asarray(x, dtype=float) for x in args)))[()]

        return function

    return declare


def sqrt(x: Any) -> Any:
    """Square root; NaN below zero in every reading."""
    context = context_of(x)
    if context is None:
        return np.sqrt(x)
    return context.sqrt(x) if x >= 0 else context.nan


def select(condition: Any, if_true: Any, if_false: Any) -> Any:
    """Return `if_true` where the condition holds, else `if_false`; both are evaluated."""
    if isinstance(condition, np.ndarray):
        return np.where(condition, if_true, if_false)
    if isinstance(condition, np.bool_):
        chosen = if_true if condition else if_false
        return (
            np.float64(chosen) if type(chosen) is float else chosen
        )  # by which a quotient by zero is no exception
    if hasattr(condition, "choose"):  # numbers without a value
        return condition.choose(if_true, if_false)
    return if_true if condition else if_false


def bits_of(x: Any) -> Any:
    """Return the 64 bits of doubles as signed integers."""
    return np.asarray(x, dtype=np.float64).view(np.int64)[()]


def double_of(bits: Any) -> Any:
    """Return the doubles that have these bits."""
    return np.asarray(bits, dtype=np.int64).view(np.float64)[()]


def trailing_zeros(bits: Any) -> Any:
    """Return the number of zero bits below the lowest set bit of a nonzero integer."""
    return (int(bits) & -int(bits)).bit_length() - 1


def _of_tables(name: str) -> Callable[[Any], Any]:
    """Return an elementary function by NumPy, or by the context of an mpmath number; kernels never call it."""

    def function(x: Any) -> Any:
        return getattr(context_of(x) or np, name)(x)

    return function


sin, cos, exp, sinh, cosh = (_of_tables(name) for name in ("sin", "cos", "exp", "sinh", "cosh"))


def binary_exponent(x: Any) -> Any:
    """Integer nearest to x/log(2), the binary exponent of e^x, for tables."""
    context = context_of(x)
    return np.rint(x / np.log(2.0)) if context is None else context.nint(x / context.ln2)


def ldexp(x: Any, times: Any) -> Any:
    """Return x times an integer power of two, for tables: never called in a kernel."""
    context = context_of(x, times)
    return x * 2.0**times if context is None else context.ldexp(x, getattr(context, "integer", int)(times))


# Minimax coefficients of (atan(r)/r - 1)/r^2 in r^2 for |r| <= tan(pi/8), degree 23 in r: 0.012 units of rounding.
(_C0, _C1, _C2, _C3, _C4, _C5, _C6, _C7, _C8, _C9, _C10) = (
    -0.333333333333332,
    0.19999999999953252,
    -0.14285714280166908,
    0.11111110782169847,
    -0.09090897725629557,
    0.0769205972347186,
    -0.06663099266120752,
    0.058478596883792075,
    -0.05039192147993848,
    0.03806218041026196,
    -0.017905080787384044,
)
TAN_PI_8 = 0.41421356237309503
# pi/4 = high + low; high has 46 bits, so that small multiples of it are exact.
PI_4_HIGH = float.fromhex("0x1.921fb54442d00p-1")
PI_4_LOW = float.fromhex("0x1.8469898cc5170p-49")


def _magnitudes_atan2(y: Any, x: Any) -> Any:
    abs_x, abs_y = abs(x), abs(y)
    steep = abs_y > abs_x
    small = select(steep, abs_x, abs_y)
    large = select(steep, abs_y, abs_x)
    # Near the overflow threshold small + large would overflow; 2^-30 leaves the quotient as it is.
    shrink = select(large > 1e300, 2.0**-30, 1.0)
    small, large = small * shrink, large * shrink
    diagonal = (small > TAN_PI_8 * large) | (small == np.inf)
    # Both infinite: the direction is the diagonal. Both zero: the direction is the axis.
    difference = select(small == np.inf, 0.0, small - large)
    numerator = select(diagonal, difference, small)
    denominator = select(diagonal, small + large, large)
    left = np.copysign(1.0, x) < 0.0
    # The two reflections that turn the direction round; the third, of y, comes last.
    numerator = select(steep != left, -numerator, numerator)
    r = numerator / select(large == 0.0, 1.0, denominator)
    z = r * r
    # Estrin's scheme: Horner's chain of 20 operations is longer than the processor looks ahead (8 % slower).
    z2 = z * z
    z4 = z2 * z2
    first = (_C0 + _C1 * z) + (_C2 + _C3 * z) * z2
    second = (_C4 + _C5 * z) + (_C6 + _C7 * z) * z2
    third = (_C8 + _C9 * z) + _C10 * z2
    tail = (first + (second + third * z4) * z4) * (z * r)
    # The angle is `octants` * pi/4 + r + tail.
    octants = select(diagonal, 1.0, 0.0)
    octants = select(steep, 2.0 - octants, octants)
    octants = select(left, 4.0 - octants, octants)
    # The first sum is exact where r >= 1/4, where its rounding would cost the second ulp.
    angle = (octants * PI_4_HIGH + r) + (tail + octants * PI_4_LOW)
    return np.copysign(angle, y)


@of_mpmath(_magnitudes_atan2)
def atan2(y: Any, x: Any) -> Any:
    """Angle of the vector (x, y) in [-pi, pi], within 2 units in the last place.

    Signed zeros and infinities as IEEE 754 has them. A libm call in a loop stops its vectorisation
    (10 ns a call, measured); this takes about 1 ns.
    """
    return context_of(y, x).atan2(y, x)


# pi/2 in three parts of 33 bits: multiples up to 2^20 of the first two are exact.
PI_2_HIGH = float.fromhex("0x1.921fb54400000p+0")
PI_2_MIDDLE = float.fromhex("0x1.0b4611a600000p-34")
PI_2_LOW = float.fromhex("0x1.3198a2e037073p-69")
PER_PI_2 = 0.6366197723675814
GREATEST_DIRECTION = 1e6
# Adding and subtracting it rounds to an integer.
ROUNDING_SHIFT = 1.5 * 2.0**52


@inlined
def _polynomial_cos_sin(x: Any) -> Any:
    quarters = (x * PER_PI_2 + ROUNDING_SHIFT) - ROUNDING_SHIFT
    r = ((x - quarters * PI_2_HIGH) - quarters * PI_2_MIDDLE) - quarters * PI_2_LOW
    r = select(abs(x) <= GREATEST_DIRECTION, r, NOT_A_NUMBER)
    z = r * r
    # Taylor's series for |r| <= pi/4: the remainder is below 2^-57 of the value.
    odd = -1.0 / 1307674368000.0 * z + 1.0 / 6227020800.0
    odd = ((odd * z - 1.0 / 39916800.0) * z + 1.0 / 362880.0) * z - 1.0 / 5040.0
    sine = r + r * (z * ((odd * z + 1.0 / 120.0) * z - 1.0 / 6.0))
    even = 1.0 / 20922789888000.0 * z - 1.0 / 87178291200.0
    even = ((even * z + 1.0 / 479001600.0) * z - 1.0 / 3628800.0) * z + 1.0 / 40320.0
    cosine = (1.0 - 0.5 * z) + z * (z * ((even * z - 1.0 / 720.0) * z + 1.0 / 24.0))
    fourth = quarters - 4.0 * ((quarters * 0.25 + ROUNDING_SHIFT) - ROUNDING_SHIFT)
    odd_quarter = (fourth == 1.0) | (fourth == -1.0)
    c = select(odd_quarter, sine, cosine)
    s = select(odd_quarter, cosine, sine)
    half_turn = (fourth == 2.0) | (fourth == -2.0)
    c = select(half_turn | (fourth == 1.0), -c, c)
    s = select(half_turn | (fourth == -1.0), -s, s)
    return c, s


@inlined
def _polynomial_cosine(x: Any) -> Any:
    return _polynomial_cos_sin(x)[0]


@inlined
def _polynomial_sine(x: Any) -> Any:
    return _polynomial_cos_sin(x)[1]


@compiled_as(_polynomial_cosine)
def cosine(x: Any) -> Any:
    """Cosine of a direction that a design gives, within 2 roundings.

    NaN beyond a million rad. The same polynomials in every reading, for the same bits on every machine.
    """
    context = context_of(x)
    return _polynomial_cos_sin(np.asarray(x, dtype=float))[0][()] if context is None else context.cos(x)


@compiled_as(_polynomial_sine)
def sine(x: Any) -> Any:
    """Sine of a direction that a design gives: see `cosine`."""
    context = context_of(x)
    return _polynomial_cos_sin(np.asarray(x, dtype=float))[1][()] if context is None else context.sin(x)
