"""Laws of facts in several mechanisms: products, quotients, signs, points along a direction."""

from __future__ import annotations

from typing import Any

from fastlink.numerics.elementary import atan2


def same(x: Any) -> Any:
    """Return x."""
    return x


def opposite(x: Any) -> Any:
    """Return -x."""
    return -x


def twice(x: Any) -> Any:
    """Return 2 x."""
    return 2.0 * x


def size(x: Any) -> Any:
    """Return |x|."""
    return abs(x)


def total(x: Any, y: Any) -> Any:
    """Return x + y."""
    return x + y


def mean(x: Any, y: Any) -> Any:
    """Return the mean of two numbers."""
    return 0.5 * (x + y)


def product(x: Any, y: Any) -> Any:
    """Return x y."""
    return x * y


def opposite_product(x: Any, y: Any) -> Any:
    """Return -x y."""
    return -(x * y)


def quotient(x: Any, y: Any) -> Any:
    """Return x/y."""
    return x / y


def along(start: Any, length: Any, direction: Any) -> Any:
    """Return the coordinate at a length along a direction from a point."""
    return start + length * direction


def angle(x: Any, y: Any) -> Any:
    """Return the angle of a vector in (-pi, pi]."""
    # + 0.0 turns -0.0 into 0.0, so that the straight angle is pi and never -pi.
    return atan2(y + 0.0, x)
