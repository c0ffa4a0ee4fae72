"""Plane vectors, and choices among numbers, that the mechanisms share."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

from fastlink.numerics.compensated import power_of_two_below
from fastlink.numerics.compiler import compiled_as, inlined
from fastlink.numerics.elementary import context_of, select, sqrt

#: What facts may call; `as_given` is for those who evaluate them.
__all__ = [
    *("absolute", "choice", "cross", "largest", "magnitude", "sign", "size_power", "turn_rate", "zero_where"),
]

# `power_of_two_below` overflows from 2^971 on; a size that underflows counts as LEAST_SIZE.
SCALE_UP, SCALE_DOWN, LEAST_SIZE = 2.0**60, 2.0**-60, 2.0**-1000

_AS_GIVEN: ContextVar[list[Any] | None] = ContextVar("as_given", default=None)


@inlined
def cross(a_x: Any, a_y: Any, b_x: Any, b_y: Any) -> Any:
    """Return the moment a_x b_y - a_y b_x."""
    return a_x * b_y - a_y * b_x


@inlined
def largest(a: Any, b: Any, c: Any, d: Any) -> Any:
    """Return the largest of four numbers; not for numbers that may be NaN."""
    e = select(a > b, a, b)
    f = select(c > d, c, d)
    return select(e > f, e, f)


@inlined
def _zero_where(condition: Any, x: Any) -> Any:
    return select(condition, 0.0, x)


@compiled_as(_zero_where)
def zero_where(condition: Any, x: Any) -> Any:
    """Return 0 where x is zero within rounding, else x; the derivative is that of x.

    What this leaves out is an error, which `fastlink.facts.bounds` counts. See `as_given`, too.
    """
    left_out = _AS_GIVEN.get()
    if left_out is None:
        return _zero_where(condition, x)
    if context_of(x) is not None and condition and x != 0:
        left_out.append(x)
    return x


@contextmanager
def as_given(takes: bool = True) -> Iterator[list[Any]]:
    """Let `zero_where` return x itself, in evaluations without a kernel.

    Yields a list, which is filled with the numbers of mpmath that would have been zero.
    """
    left_out: list[Any] = []
    token = _AS_GIVEN.set(left_out if takes else None)
    try:
        yield left_out
    finally:
        _AS_GIVEN.reset(token)


@inlined
def size_power(x: Any, y: Any) -> Any:
    """Return a power of two near the size of a vector, whatever that is."""
    size = SCALE_UP * power_of_two_below(SCALE_DOWN * abs(x) + SCALE_DOWN * abs(y))
    return select(size == 0.0, LEAST_SIZE, size)


@inlined
def _scaled_magnitude(x: Any, y: Any) -> Any:
    size = size_power(x, y)
    # Exact, as the size is a power of two: one division takes the place of two here, and of four in derivatives.
    per_size = 1.0 / size
    u = x * per_size
    v = y * per_size
    return size * sqrt(u * u + v * v)


@compiled_as(_scaled_magnitude)
def magnitude(x: Any, y: Any) -> Any:
    """Return the length of the vector (x, y), whose squares may overflow or underflow."""
    context = context_of(x, y)
    return _scaled_magnitude(x, y) if context is None else context.sqrt(x * x + y * y)


@inlined
def turn_rate(y: Any, x: Any, dy: Any, dx: Any) -> Any:
    """Return the derivative of atan2(y, x); the squares of the ratios do not overflow."""
    size = select(abs(x) < abs(y), abs(y), abs(x))
    v = y / size
    u = x / size
    return (u * dy - v * dx) / (size * (u * u + v * v))


@inlined
def sign(x: Any) -> Any:
    """Return 1, 0 or -1 with the sign of x; 0 of NaN."""
    return select(x > 0.0, 1.0, select(x < 0.0, -1.0, 0.0))


@inlined
def choice(condition: Any, if_true: Any, if_false: Any) -> Any:
    """Select as `select` does where rounding may make the choice: its error bound covers both values then."""
    return select(condition, if_true, if_false)


@inlined
def absolute(x: Any) -> Any:
    """Return |x|, whose derivative changes its sign where rounding may decide of which sign x is."""
    return abs(x)
