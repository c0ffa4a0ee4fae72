"""How many extremes the rates of a planar 4R with integer lengths have, exactly, double zeros too.

The derivative along the turn is a constant times e tau Y^(3/2) + s V for rates, U Y^(5/2) + s tau N for accelerations
(see `extrema_oracle`). An extremum is a zero of odd order; at theta1 = 0 and pi, where tau is 0 and infinite, the
orders of both terms in tau tell.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from flint import arb, ctx, fmpz_poly

from tests.support.extrema_oracle import BITS, Linkage, R, sign

#: The order of a term that is zero.
NEVER = 10**6


def without(poly: fmpz_poly, factor: fmpz_poly) -> fmpz_poly:
    """Return a polynomial without the zeros that it has in common with another."""
    while (common := poly.gcd(factor)).degree() > 0:
        poly = divmod(poly, common)[0]
    return poly


def reachable(linkage: Linkage, poly: fmpz_poly) -> Iterator[arb]:
    """Yield the positive zeros of odd order at which the loop closes, not at a toggle."""
    for root, multiplicity in without(without(poly, linkage.Y), linkage.g).complex_roots():
        r = root.real
        if (
            root.imag == 0
            and multiplicity % 2
            and r > 0
            and sign(linkage.p(r)) > 0
            and sign(linkage.q(r)) > 0
        ):
            yield r


def lowest(poly: fmpz_poly) -> int:
    return next((k for k in range(poly.degree() + 1) if poly[k] != 0), NEVER)


def highest(poly: fmpz_poly) -> int:
    return poly.degree() if poly != 0 else -NEVER


def exact_count(lengths: tuple[int, ...], quantity: str) -> int:
    """Count the extremes of a rate over the turn, in each branch alike, for a linkage that is no change point."""
    linkage = Linkage(np.array(lengths, dtype=float), quantity[-1])
    with ctx.workprec(2 * BITS):
        if quantity.startswith("omega"):
            even, odd = linkage.V, fmpz_poly([linkage.e])
            squared = 4 * odd**2 * R * linkage.Y**3 - even**2
            near = (1 + 2 * lowest(odd), 2 * lowest(even))
            far = (7 + 2 * highest(odd), 2 * highest(even))
        else:
            even, odd = linkage.U, linkage.N
            squared = 4 * even**2 * linkage.Y**5 - R * odd**2
            near = (1 + 2 * lowest(odd), 2 * lowest(even))
            far = (1 + 2 * highest(odd), 10 + 2 * highest(even))
        common = even.gcd(odd)
        # a common zero is one in both branches, which are the two halves of the turn
        count = 2 * len(list(reachable(linkage, common))) if common.degree() > 0 else 0
        rest = divmod(squared, common**2)[0] if common.degree() > 0 else squared
        count += len(list(reachable(linkage, rest)))
    at_0 = linkage.p[0] > 0 and linkage.q[0] > 0 and near[0] < near[1]
    at_pi = linkage.p[1] > 0 and linkage.q[1] > 0 and far[0] > far[1]
    return count + int(at_0) + int(at_pi)
