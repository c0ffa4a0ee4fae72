"""The closed polygon of four links: positions by circle and circle, then Newton's iteration on its closure."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fastlink.precision.independent.series import Series, Singular, closed, rotation, solved, unit_vector

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["angle_between", "corner", "polygon", "triangle_angle", "wrapped"]


def corner(ctx: Any, base: Any, first: Any, second: Any, side: int) -> Any:
    """Return the vector from the start of a base to the apex of the triangle over it.

    Parameters
    ----------
    ctx : context
        Of the numbers.
    base : complex number
        The vector from start to end.
    first, second : number
        The lengths from the start and from the end to the apex.
    side : int
        1 for an apex to the left of the base, -1 to the right.

    Raises
    ------
    Open
        There is no such triangle.
    Singular
        The base has no length.
    """
    square = base.real * base.real + base.imag * base.imag
    if square == 0:
        raise Singular("the ends of the base coincide")
    along = (square + first * first - second * second) / (2 * square)
    reach = first * first / square
    size = reach + abs(along) * (1 + reach + second * second / square)
    across = closed(ctx, reach - along * along, size, "the lengths do not make a triangle")
    return base * ctx.mpc(along, side * ctx.sqrt(across))


def polygon(ctx: Any, lengths: Sequence[Any], turn: Series, branch: int) -> list[Series]:
    """Return the directions of the four links of a closed polygon, as angles from that of the first link.

    Parameters
    ----------
    ctx : context
        Of the numbers.
    lengths : sequence of 4
        The links in the order in which they are traversed.
    turn : Series
        The angle from the first link to the second.
    branch : int
        1 where the angle from the third link to the fourth is between 0 and pi, 2 where it is between -pi and 0.
    """
    first, second, third, fourth = lengths
    to_start = -(first + second * unit_vector(ctx, turn.terms[0]))
    apex = corner(ctx, to_start, third, fourth, -1 if branch == 1 else 1)
    last = to_start - apex
    start = [ctx.atan2(one.imag, one.real) for one in (apex, last)]

    def closure(unknown: list[Series], drive: Series) -> list[Series]:
        end = first + second * rotation(ctx, drive)
        end = end + third * rotation(ctx, unknown[0]) + fourth * rotation(ctx, unknown[1])
        return [end.real, end.imag]

    return [0 * turn, turn, *solved(ctx, closure, start, turn)]


def wrapped(ctx: Any, angle: Any) -> Any:
    """Return an angle within (-pi, pi]."""
    cosine, sine = ctx.cos_sin(angle)
    return ctx.atan2(sine, cosine)


def angle_between(ctx: Any, one: Any, other: Any) -> Any:
    """Return the angle from one vector to another, within (-pi, pi]."""
    cross = one.real * other.imag - one.imag * other.real
    return ctx.atan2(cross, one.real * other.real + one.imag * other.imag)


def triangle_angle(ctx: Any, one: Any, other: Any, opposite: Any) -> Any:
    """Return the angle between two sides of a triangle; 0 or pi where it folds."""
    least = max((opposite - one + other) * (opposite + one - other), 0 * one)
    greatest = max((one + other - opposite) * (one + other + opposite), 0 * one)
    return 2 * ctx.atan2(ctx.sqrt(least), ctx.sqrt(greatest))
