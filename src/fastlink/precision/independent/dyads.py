"""Five-bar linkages with Hart's relation of angles: Wunderlich's (1.2) to (1.4), from which F follows.

M = 0, N = d, P = m u, Q = d + n v and F = P - p u w = Q + q v w, with u, v, w complex numbers of size 1.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fastlink.precision.independent.four_bar import angle_between, polygon
from fastlink.precision.independent.series import Series, Singular, closed, rotation, solved, unit_vector

__all__ = ["Position", "argument", "between_rockers", "by_F", "closing", "coordinates", "points"]


@dataclass(frozen=True)
class Position:
    """Directions MP, NQ and e^(i omega), as series of the drive."""

    u: Series
    v: Series
    w: Series


def between_rockers(ctx: Any, lengths: Sequence[Any], phi: Series, branch: int) -> Series:
    """Return the direction of NB of a four-bar MABN where that of MA is given.

    Parameters
    ----------
    ctx : context
        Of the numbers.
    lengths : sequence of 4
        MN, MA, AB and NB.
    phi : Series
        The direction of MA.
    branch : int
        1 where B lies to the right of the line from A to N, else 2.
    """
    # traversed from N: what is an angle from NM to BN here is one from MN to NB
    return polygon(ctx, lengths, phi - ctx.pi, branch)[3]


def closing(bars: Mapping[str, Any], u: Series, v: Series) -> Position:
    """Return the position of the dyads where the directions of MP and NQ are given."""
    m, n, p, q, d = (bars[name] for name in "mnpqd")
    opening = p * u + q * v
    if opening.terms[0] == 0:
        raise Singular("PF and QF coincide")
    return Position(u, v, (m * u - n * v - d) / opening)


def by_F(
    ctx: Any, bars: Mapping[str, Any], joint_F: Callable[[Series], Series], drive: Series, omega_sign: int
) -> tuple[Position, list[Series]]:
    """Return the position where F is given, and the angles of MP and NQ.

    Parameters
    ----------
    ctx : context
        Of the numbers.
    bars : mapping
        Lengths m, n, p, q and d, with their signs.
    joint_F : callable
        Returns F of the drive.
    drive : Series
        The input.
    omega_sign : int
        The sign of sin(omega).
    """
    m, n, p, q, d = (bars[name] for name in "mnpqd")
    F = joint_F(drive)
    at = F.terms[0]
    square = at.real * at.real + at.imag * at.imag
    cosine = (m * m + p * p - square) / (2 * m * p)
    size = (m * m + p * p + square) / abs(2 * m * p)
    sine_squared = closed(ctx, (1 - cosine) * (1 + cosine), size, "the dyad MPF does not reach F")
    omega = ctx.atan2(omega_sign * ctx.sqrt(sine_squared), cosine)
    seen = m - p * unit_vector(ctx, omega)

    def dyad(unknown: list[Series], drive: Series) -> list[Series]:
        missed = rotation(ctx, unknown[0]) * (m - p * rotation(ctx, unknown[1])) - joint_F(drive)
        return [missed.real, missed.imag]

    phi, turned = solved(ctx, dyad, (angle_between(ctx, seen, at), omega), drive)
    u, w = rotation(ctx, phi), rotation(ctx, turned)
    seen_from_N = n + q * w
    if seen_from_N.terms[0] == 0:
        raise Singular("F is N")
    v = (F - d) / seen_from_N
    return Position(u, v, w), [phi, argument(ctx, v)]


def argument(ctx: Any, vector: Series) -> Series:
    """Return the direction of a vector as an angle, over the drive."""
    first = ctx.atan2(vector.terms[0].imag, vector.terms[0].real)
    if len(vector.terms) == 1:
        return Series((first,))
    turning = (vector.differentiated() / vector).imag
    return Series((first, *(term / k for k, term in enumerate(turning.terms, 1))))


def points(bars: Mapping[str, Any], ratio: Any, at: Position) -> dict[str, Series]:
    """Return the joints A, B, P, Q and F."""
    m, n, d = (bars[name] for name in "mnd")
    places = {"P": m * at.u, "Q": n * at.v + d, "A": ratio * m * at.u, "B": ratio * n * at.v + d}
    return places | {"F": places["P"] - bars["p"] * at.u * at.w}


def coordinates(places: Mapping[str, Series]) -> dict[str, Any]:
    """Return the coordinates of points by the names of quantities."""
    found = {f"{name}_x": place.terms[0].real for name, place in places.items()}
    return found | {f"{name}_y": place.terms[0].imag for name, place in places.items()}
