"""What errors of the arguments do to the result of an operation: texts over magnitudes and errors.

They bound the whole effect, not its first order only.
"""

from __future__ import annotations

from typing import Any

from fastlink.numerics.elementary import PI, select, sqrt

__all__ = ["of_direction", "of_logarithm", "of_product", "of_quotient", "of_root"]


def of_product(x: Any, y: Any, e_x: Any, e_y: Any) -> Any:
    """Return what errors of x and y do to x y."""
    return x * e_y + (y + e_y) * e_x


def of_quotient(quotient: Any, y: Any, e_x: Any, e_y: Any) -> Any:
    """Return what they do to x/y: infinite where y may be zero."""
    return (quotient * e_y + e_x) / select(e_y < y, y - e_y, 0.0)


def of_root(x: Any, root: Any, e: Any) -> Any:
    """Return what an error of x does to its root, which is not negative: e/(2 root), and what a chord has more."""
    return select(e < x, 0.5 * (e + e * (e / x)) / root, sqrt(e))


def of_direction(y: Any, x: Any, e_y: Any, e_x: Any) -> Any:
    """Return what errors of a vector do to its direction: pi where it may be any."""
    size = select(x < y, y, x)
    v = y / size
    u = x / size
    # The sine of the angle between both vectors; below 1/8 the angle exceeds its sine by less than 0.3 %.
    turn = (u * e_y + v * e_x) / ((u * u + v * v) * (size - (e_x + e_y)))
    return select((e_x + e_y < size) & (turn < 0.125), 1.003 * turn, PI)


def of_logarithm(x: Any, e: Any) -> Any:
    """Return what an error of x does to its logarithm: infinite where x may be zero."""
    return e / select(e < x, x - e, 0.0)
