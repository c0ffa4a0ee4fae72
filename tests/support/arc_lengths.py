"""Length and area of coupler curves with 40 digits, from the loop equations alone."""

from __future__ import annotations

from functools import cache, partial
from itertools import pairwise
from typing import Any

from flint import arb, ctx, fmpq

#: Digits of the arithmetic, nodes of a rule, what its two halves may change on a panel, panels towards each end.
DIGITS, NODES, TOLERANCE, DYADIC = 40, 32, 1e-17, 2


def exact(x: float) -> Any:
    """Return a double as it is."""
    return arb(fmpq(*float(x).as_integer_ratio()))


@cache
def rule() -> list[tuple[Any, Any]]:
    """Return nodes and weights of Clenshaw and Curtis on (0, 1): with the ends, so that no kink hides next to them."""
    pairs = []
    for k in range(NODES + 1):
        cosines = sum(
            (2 if 2 * j < NODES else 1) * (2 * j * k * arb.pi() / NODES).cos() / (4 * j * j - 1)
            for j in range(1, NODES // 2 + 1)
        )
        weight = (1 - cosines) / NODES
        node = (1 + (k * arb.pi() / NODES).cos()) / 2
        pairs.append((node, weight / 2 if k in (0, NODES) else weight))
    return pairs


def panel(along: Any, a: Any, b: Any) -> Any:
    """Return the rule on one panel."""
    return (b - a) * sum((weight * along(a + (b - a) * node) for node, weight in rule()), arb(0))


def integrated(along: Any, low: Any, high: Any, whole: Any, allowed: float) -> Any:
    """Return an integral by halving until nothing changes."""
    middle = (low + high) / 2
    halves = panel(along, low, middle), panel(along, middle, high)
    if abs(float(halves[0] + halves[1] - whole)) <= allowed:
        return halves[0] + halves[1]
    first = integrated(along, low, middle, halves[0], allowed)
    return first + integrated(along, middle, high, halves[1], allowed)


def reference(design: Any, branch: int, area: bool = False) -> Any:
    """Return length or area of an assembly mode; None where it does not assemble or is not closed.

    The circles about A and D meet in B, P turns with AB, and the velocities of the loop are solved for theta2'. With
    c = cos(theta1), AD is as long as abs(a2 - a3) at c = inner, as a2 + a3 at c = outer; the range of c is that of
    middle - half cos(s), 0 < s < pi. Of the roots of 1 + c and c - outer one, t, is a sine there, the other, g, has no
    zero; so at the other end. No quotient of zeros is left, but at a change point.
    """
    old, ctx.dps = ctx.dps, DIGITS
    try:
        a1, a2, a3, a4, u, v = (exact(x) for x in design)
        inner, outer = ((a1 * a1 + a4 * a4 - (a2 + sign * a3) ** 2) / (2 * a1 * a4) for sign in (-1, 1))
        toggles = outer > -1, inner < 1
        if not inner > -1 or not outer < 1 or (area and any(toggles)):
            return None
        low, high = (outer if toggles[0] else arb(-1)), (inner if toggles[1] else arb(1))
        side = 1 if branch == 2 else -1

        def along(s: Any, sign: int) -> Any:
            t = [(high - low).sqrt() * root for root in ((s / 2).sin(), (s / 2).cos())]
            c = low + t[0] * t[0]
            other = (1 + c if toggles[0] else c - outer), (1 - c if toggles[1] else inner - c)
            g = [part.sqrt() for part in other]
            sines = [(g if toggle else t)[k] for k, toggle in enumerate(toggles)]
            roots = [(t if toggle else g)[k] for k, toggle in enumerate(toggles)]
            rate = [t[k] / g[k] if toggle else 1 for k, toggle in enumerate(toggles)]
            A_x, A_y = a1 * c, sign * a1 * sines[0] * sines[1]
            x, y = a4 - A_x, -A_y
            square = a1 * a1 + a4 * a4 - 2 * a1 * a4 * c
            forth = (a2 * a2 - a3 * a3 + square) / (2 * square)
            across = side * a1 * a4 * roots[0] * roots[1] / square
            B_x, B_y = forth * x - across * y, forth * y + across * x  # from A
            C_x, C_y = B_x - x, B_y - y  # B from D
            # J A + n J (B - A) = m J (B - D): the product with B - D leaves n.
            crank, coupler = rate[0] * rate[1], -(A_x * C_y - A_y * C_x) / (side * a1 * a4 * g[0] * g[1])
            w_x, w_y = (u * B_x - v * B_y) / a2, (v * B_x + u * B_y) / a2
            d_x, d_y = -(crank * A_y + coupler * w_y), crank * A_x + coupler * w_x
            if area:
                return ((A_x + w_x) * d_y - (A_y + w_y) * d_x) / 2
            return (d_x * d_x + d_y * d_y).sqrt()

        ends = [arb.pi() / 2 ** (k + 1) for k in range(DYADIC)][::-1]
        marks = [arb(0), *ends, *(arb.pi() - end for end in ends[-2::-1]), arb.pi()]
        pieces = [(partial(along, sign=sign), a, b) for sign in (1, -1) for a, b in pairwise(marks)]
        coarse = [panel(*piece) for piece in pieces]
        allowed = TOLERANCE * sum(abs(float(part)) for part in coarse)
        return sum(
            (integrated(*one, part, allowed) for one, part in zip(pieces, coarse, strict=True)), arb(0)
        )
    finally:
        ctx.dps = old
