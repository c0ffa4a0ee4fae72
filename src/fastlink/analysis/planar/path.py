"""The path of a coupler point as pieces between the ends of the input's range, free of poles at toggles.

With q = sin^2(theta1/2) the distance AD has the square f^2 = (a4 - a1)^2 + 4 a1 a4 q. The triangle ABD is flat at q-
and at q+,

    4 a1 a4 (q - q-) = f^2 - (a2 - a3)^2,    4 a1 a4 (q+ - q) = (a2 + a3)^2 - f^2,

and the linkage assembles from max(q-, 0) to min(q+, 1). Near a toggle the point moves as the root of the distance d of
the angle from there: its path is smooth in v = sqrt(d). All factors are written with d, so that the digits of theta1
set no limit: the facts of the mechanism take theta1 itself, which has none left of d there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fastlink.numerics.compensated import UNIT_ROUNDING, sum_of_four

__all__ = ["Paths", "paths_of"]

#: Roundings of each term of a velocity, counted: S by its factors 12, AD 4, the turn of conj(BD) 6, twice that in f^2.
ROUNDINGS = 24.0


@dataclass(frozen=True, eq=False)
class Paths:
    """Paths of designs, each in up to four pieces: theta1 below or above 0, from its least or greatest size.

    Attributes
    ----------
    a1, a2, a3, a4, p : ndarray
        Lengths and the coupler point u + iv of each design, divided by a power of two of the lengths.
    side : ndarray
        1 in branch 2, -1 in branch 1.
    exponent : ndarray of int
        That power.
    toggles : ndarray of bool, shape (2, n)
        Whether the least size of theta1 is a toggle; and the greatest.
    outside : ndarray, shape (2, n)
        -q- and q+ - 1: how far the flat triangles are outside of the turn.
    low, high : ndarray, shape (2, n)
        The least and greatest size of theta1; as it is, and as its distance from pi.
    extent : ndarray
        Their difference; NaN where the linkage does not assemble.
    """

    a1: Any
    a2: Any
    a3: Any
    a4: Any
    p: Any
    side: Any
    exponent: Any
    toggles: Any
    outside: Any
    low: Any
    high: Any
    extent: Any

    def pieces(self) -> tuple[Any, Any, Any, Any, Any]:
        """Return design, sign of theta1 and end (0: least, 1: greatest) of each piece, its width and layer in v."""
        own = np.flatnonzero(self.extent > 0.0)
        owner, sign, end = (
            part.ravel() for part in np.meshgrid(own, np.array([-1.0, 1.0]), np.array([0, 1]), indexing="ij")
        )
        toggle = self.toggles[end, owner]
        half = 0.5 * self.extent[owner]
        near = np.where(end == 0, self.low[0, owner], self.high[1, owner])
        gap = 2.0 * np.sqrt(np.maximum(self.outside[end, owner], 0.0))
        layer = np.where(toggle, np.sqrt(near), np.where(gap > 0.0, gap, np.inf))
        return owner, sign, end, np.where(toggle, np.sqrt(half), half), layer

    def samples(self, count: int) -> tuple[Any, Any]:
        """Return input angles of each design, about so many, closer together near toggles; and which follow on.

        They ascend from -pi or the least angle, and the first one follows a turn later as the last.
        """
        steps = max(count // 4, 1)
        v = np.concatenate([[1e-3], np.arange(1, 2 * steps, 2)]) / (2.0 * steps)
        half = 0.5 * self.extent[:, None]
        d = [half * np.where(toggle[:, None], v * v, v) for toggle in self.toggles]
        upper = np.pi - (self.high[1][:, None] + d[1])
        angles = np.concatenate([self.low[0][:, None] + d[0], upper[:, ::-1]], axis=1)
        around = np.concatenate([-angles[:, ::-1], angles, 2.0 * np.pi - angles[:, -1:]], axis=1)
        follows = np.ones((angles.shape[0], around.shape[1] - 1), dtype=bool)
        follows[:, angles.shape[1] - 1], follows[:, -1] = ~self.toggles
        return around, follows

    def motion(self, owner: Any, sign: Any, end: Any, v: Any) -> tuple[Any, Any, Any]:
        """Return the point P, its derivative by v with theta1 growing, and a bound of that one's roundings."""
        a1, a2, a3, a4 = (part[owner] for part in (self.a1, self.a2, self.a3, self.a4))
        toggle, side = self.toggles[end, owner], self.side[owner]
        d = np.where(toggle, v * v, v)
        rest = self.extent[owner] - d
        first = end == 0
        angle = self.low[0, owner] + np.where(first, d, rest)
        complement = self.high[1, owner] + np.where(first, rest, d)
        q, sine = np.sin(0.5 * angle) ** 2, np.sin(np.minimum(angle, complement))
        below = self._gap(0, owner, np.where(first, d, rest), angle, complement)
        above = self._gap(1, owner, np.where(first, rest, d), angle, complement)
        crank = np.where(angle < complement, np.cos(angle), -np.cos(complement)) + 1j * sign * sine
        S = 4.0 * a1 * a4 * np.sqrt(below) * np.sqrt(above)
        x, y = (a4 - a1) + 2.0 * a1 * q, -sign * a1 * sine  # AD
        gaps = x * x + y * y, 4.0 * a1 * a4 * below, 4.0 * a1 * a4 * above
        (at_A, size_A), (at_D, size_D) = _projection(a2, a3, *gaps), _projection(a3, a2, *gaps)
        half, step = 0.5 / gaps[0], np.where(toggle, 2.0 * v, 1.0)
        AB, BD = (
            (x + 1j * y) * (along + 1j * across) * half
            for along, across in ((at_A, side * S), (at_D, -side * S))
        )
        # theta2' = 2 a1 Im(e^(i theta1) conj(B - D)) / S
        turn = -2.0 * a1 * side * (crank * BD.conj()).imag * (step / S)
        arm, reach = AB * (self.p[owner] / a2), np.abs(self.p[owner] / a2)
        velocity = 1j * (a1 * crank * step + turn * arm)
        # Bounds of components: |x| and |y| for those of AD, size_A and size_D for the projections
        x, y = np.abs(x), np.abs(y)
        along, across = (x * size_D + y * S) * half, (x * S + y * size_D) * half
        unsure = 2.0 * a1 * (sine * along + (np.abs(crank.real) + sine) * across) * (step / S)
        noise = a1 * step + (np.abs(turn) * (x + y) * (size_A + S) * half + unsure * np.abs(AB)) * reach
        return a1 * crank + arm, velocity, ROUNDINGS * UNIT_ROUNDING * noise

    def _gap(self, end: int, owner: Any, d: Any, angle: Any, complement: Any) -> Any:
        """Return q - q- (end 0) or q+ - q (end 1) at the distance d from that end of the range."""
        there, complement_there = (self.low if end == 0 else self.high)[:, owner]
        between = np.minimum(0.5 * (angle + there), 0.5 * (complement + complement_there))
        at_toggle = np.sin(0.5 * d) * np.sin(between)
        passing = np.sin(0.5 * d) ** 2 + self.outside[end, owner]
        return np.where(self.toggles[end, owner], at_toggle, passing)


def _projection(one: Any, other: Any, square: Any, below: Any, above: Any) -> tuple[Any, Any]:
    """Return f^2 + one^2 - other^2, twice f times a link's projection on AD, and the size of its terms: the least.

    As it stands, and by f^2 = (one - other)^2 + below = (one + other)^2 - above, for a link far shorter than the other.
    """
    difference, total = one - other, one + other
    terms = (square, difference * total), (below, 2.0 * one * difference), (2.0 * one * total, -above)
    size = np.stack([np.abs(a) + np.abs(b) for a, b in terms])
    best = np.argmin(size, axis=0)
    return np.choose(best, [a + b for a, b in terms]), size.min(axis=0)


def paths_of(curve: dict[str, Any]) -> Paths:
    """Return the paths of designs: lengths, coupler points and assembly modes (n,) by name."""
    lengths = np.stack([curve[f"a{i}"] for i in (1, 2, 3, 4)])
    exponent = np.frexp(lengths.max(axis=0))[1]
    a1, a2, a3, a4 = np.ldexp(lengths, -exponent)
    p = np.ldexp(curve["P_u"], -exponent) + 1j * np.ldexp(curve["P_v"], -exponent)
    product = 4.0 * a1 * a4
    inner = [sum(sum_of_four(*terms)) for terms in ((a2, -a3, a4, -a1), (a3, -a2, a4, -a1))]
    outer = [sum(sum_of_four(*terms)) for terms in ((a2, a3, a1, -a4), (a2, a3, a4, -a1))]
    across = [sum(sum_of_four(*terms)) for terms in ((a1, a4, a3, -a2), (a1, a4, a2, -a3))]
    beyond = sum(sum_of_four(a1, a4, -a2, -a3)) * sum(sum_of_four(a1, a2, a3, a4)) / product
    # -q-, 1 - q-, q+ and 1 - q+, each by its factors: none cancels.
    least, from_least = inner[0] * inner[1] / product, across[0] * across[1] / product
    greatest = outer[0] * outer[1] / product
    low = (
        2.0 * np.arctan2(_root(-least), _root(from_least)),
        2.0 * np.arctan2(_root(from_least), _root(-least)),
    )
    high = 2.0 * np.arctan2(_root(greatest), _root(beyond)), 2.0 * np.arctan2(_root(beyond), _root(greatest))
    toggles = np.stack([least < 0.0, beyond > 0.0])
    # sin^2(high/2) - sin^2(low/2) = a2 a3/(a1 a4) between two toggles
    narrow = a2 * a3 / (a1 * a4) / np.sin(np.minimum(0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])))
    extent = np.where(toggles[0], low[1], np.where(toggles[1], high[0], np.pi))
    by_both = np.where(narrow < 0.5, 2.0 * np.arcsin(np.minimum(narrow, 0.5)), high[0] - low[0])
    extent = np.where(toggles.all(axis=0), by_both, extent)
    extent = np.where((greatest >= 0.0) & (from_least >= 0.0), extent, np.nan)
    side = np.where(curve["branch"] == 2, 1.0, -1.0)
    outside = np.stack([least, -beyond])
    return Paths(a1, a2, a3, a4, p, side, exponent, toggles, outside, np.stack(low), np.stack(high), extent)


def _root(x: Any) -> Any:
    return np.sqrt(np.maximum(x, 0.0))
