"""Laws of facts in several mechanisms: products, quotients, signs, points along a direction."""

from __future__ import annotations

from typing import Any

from fastlink.numerics.elementary import atan2
from fastlink.numerics.vectors import cross, magnitude


def same(x: Any) -> Any:
    """Return x."""
    return x


def opposite(x: Any) -> Any:
    """Return -x."""
    return -x


def twice(x: Any) -> Any:
    """Return 2 x."""
    return 2.0 * x


def half(x: Any) -> Any:
    """Return x/2."""
    return 0.5 * x


def square(x: Any) -> Any:
    """Return x^2."""
    return x * x


def size(x: Any) -> Any:
    """Return |x|."""
    return abs(x)


def total(x: Any, y: Any) -> Any:
    """Return x + y."""
    return x + y


def difference(x: Any, y: Any) -> Any:
    """Return x - y."""
    return x - y


def mean(x: Any, y: Any) -> Any:
    """Return the mean of two numbers."""
    return 0.5 * (x + y)


def product(x: Any, y: Any) -> Any:
    """Return x y."""
    return x * y


def opposite_product(x: Any, y: Any) -> Any:
    """Return -x y."""
    return -(x * y)


def twice_product(x: Any, y: Any) -> Any:
    """Return 2 x y."""
    return 2.0 * (x * y)


def square_difference(x: Any, y: Any) -> Any:
    """Return x^2 - y^2."""
    return (x - y) * (x + y)


def quotient(x: Any, y: Any) -> Any:
    """Return x/y."""
    return x / y


def along(start: Any, length: Any, direction: Any) -> Any:
    """Return the coordinate at a length along a direction from a point."""
    return start + length * direction


def turned_x(u: Any, v: Any, x: Any, y: Any) -> Any:
    """Return the first component of (u, v) in a frame whose first axis is (x, y): u x - v y."""
    return u * x - v * y


def turned_y(u: Any, v: Any, x: Any, y: Any) -> Any:
    """Return the second component: u y + v x."""
    return u * y + v * x


#: The product of two complex numbers, u + i v and x + i y.
turned = turned_x, turned_y


def norm(x: Any, y: Any) -> Any:
    """Return the length of a vector."""
    return magnitude(x, y)


def moment(x: Any, y: Any, F_x: Any, F_y: Any) -> Any:
    """Return the moment of a force at (x, y) about the origin."""
    return cross(x, y, F_x, F_y)


def angle(x: Any, y: Any) -> Any:
    """Return the angle of a vector in (-pi, pi]."""
    # + 0.0 turns -0.0 into 0.0, so that the straight angle is pi and never -pi.
    return atan2(y + 0.0, x)
