"""Every extremum of the planar 4R's rates, from exact real root counts: nothing in common with the engine.

With r = tan^2(theta1/2) = tau^2, (1 + r)|AD|^2 = g, (1 + r)^2 S^2 = Y (S four times the area of ABD; g and Y are
polynomials of r with integer coefficients, the lengths being integers after a common power of two), e = a^2 - d^2,
k = b^2 - c^2, h = g + k(1 + r), s = -1 and +1 for the branches 1 and 2, and ' the derivative by r,

    omega4/omega1    = 1/2 + e(1 + r)/(2g) + s 2ad tau h/(g sqrt Y)
    alpha4/omega1^2  = ad(1 + r)(-2 e tau + s V/Y^(3/2))/g^2,          V = g h (Y - r Y') - 8ad k r Y
    jerk4/omega1^3   = ad(1 + r)(2 U Y^(5/2) + s tau N)/(2 g^3 Y^(5/2)),
                       U = -e [(1 + r) g + 2 r g - 4 (a + d)^2 r (1 + r)],
                       N = 2 [(g - 2 (a + d)^2 (1 + r)) V + (1 + r) g V'] Y - 3 (1 + r) g V Y'

for 0 < theta1 < pi. The coupler has the same with k -> -k and s -> -s; the mirror gives the rest of the turn: what
branch 1 does at theta1, branch 2 does at -theta1, accelerations with the other sign. Squared, the conditions are
(4 e^2 r Y^3 - V^2)/g^2 = 0, of degree 6, and (4 U^2 Y^5 - r N^2)/g^3 = 0, of degree 11. Their real roots are counted
and enclosed rigorously by FLINT; the sign of V or N at a root says to which branch it belongs. A simple root
changes the sign of the derivative, so it is an extremum; a double one is met on a set of designs of measure zero
only (a stationary inflection, no extremum, and what random designs do not hit): it is refused.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from math import lcm, pi

import numpy as np
from flint import arb, ctx, fmpz_poly

RATES = ("omega4", "omega2", "alpha4", "alpha2")
R, ONE_R = fmpz_poly([0, 1]), fmpz_poly([1, 1])
#: Enclosures start with these bits; where they do not settle a sign, with twice as many.
BITS = 160


@dataclass(frozen=True)
class Extremum:
    """One extremum of a rate over omega1 or of an acceleration over omega1^2.

    `value_terms` and `slope_terms` are the sums of the sizes of the terms that make up the value and its derivative;
    `theta1_terms` is the latter over the second derivative: so far a relative change of the terms moves the extremum.
    """

    branch: int
    theta1: float
    value: float
    kind: int
    value_terms: float
    slope_terms: float
    theta1_terms: float


def integers(lengths: np.ndarray) -> list[int]:
    """Return doubles times their smallest common denominator: the same linkage in another unit of length."""
    fractions = [Fraction(float(length)) for length in lengths]
    common = lcm(*(fraction.denominator for fraction in fractions))
    return [int(fraction * common) for fraction in fractions]


class Linkage:
    """The polynomials of one linkage and one of its moving links."""

    def __init__(self, lengths: np.ndarray, link: str) -> None:
        a, b, c, d = integers(lengths)
        self.side = 1 if link == "4" else -1
        self.low, self.high, self.ad = (a - d) ** 2, (a + d) ** 2, a * d
        self.e, self.k = (a - d) * (a + d), self.side * (b - c) * (b + c)
        self.g = fmpz_poly([self.low, self.high])
        self.p = self.g - ONE_R * (b - c) ** 2
        self.q = ONE_R * (b + c) ** 2 - self.g
        self.Y = self.p * self.q
        self.h = self.g + self.k * ONE_R
        slope = self.Y.derivative()
        self.V = self.g * self.h * (self.Y - R * slope) - 8 * self.ad * self.k * R * self.Y
        self.U = -self.e * (ONE_R * self.g + 2 * R * self.g - 4 * self.high * R * ONE_R)
        inner = (self.g - 2 * self.high * ONE_R) * self.V + ONE_R * self.g * self.V.derivative()
        self.N = 2 * inner * self.Y - 3 * ONE_R * self.g * self.V * slope

    def condition(self, quantity: str) -> fmpz_poly:
        """Return the polynomial whose positive roots in the reachable range are the stationary points."""
        if quantity.startswith("omega"):
            squared, factor = 4 * self.e**2 * R * self.Y**3 - self.V**2, self.g**2
        else:
            squared, factor = 4 * self.U**2 * self.Y**5 - R * self.N**2, self.g**3
        quotient, remainder = divmod(squared, factor)
        assert remainder == 0
        return quotient

    def reachable_roots(self, condition: fmpz_poly) -> Iterator[arb]:
        """Yield the simple roots r > 0 at which the loop closes."""
        for root, multiplicity in condition.complex_roots():
            if root.imag != 0:
                continue  # FLINT gives real roots the imaginary part 0 exactly
            r = root.real
            if sign(r) > 0 and sign(self.p(r)) > 0 and sign(self.q(r)) > 0:
                assert multiplicity == 1, "a double root: not a design for this oracle"
                yield r

    def extremum(self, quantity: str, condition: fmpz_poly, r: arb) -> tuple[int, Extremum]:
        """Return the sign s of the branch, and the extremum in 0 < theta1 < pi (its branch to be set)."""
        g, h, Y, V, U = (f(r) for f in (self.g, self.h, self.Y, self.V, self.U))
        tau, e, ad = r.sqrt(), self.e, self.ad
        slope = condition.derivative()(r)
        half = Y.sqrt()
        if quantity.startswith("omega"):
            s = sign(V) * sign(arb(e))
            value = (1 + e * (1 + r) / g + s * 4 * ad * tau * h / (g * half)) / 2
            # 2 e tau Y^(3/2) - s V =: -F has F (-4 e tau Y^(3/2)) = g^2 condition at its root; d/dtheta = tau(1+r)d/dr
            bend = -ad * (1 + r) * slope / (4 * e * tau * half**6) * tau * (1 + r)
        else:
            s = -sign(U) * sign(self.N(r))
            value = ad * (1 + r) * (-2 * e * tau + s * V / half**3) / g**2
            # F = 2 U Y^(5/2) + s tau N has F 4 U Y^(5/2) = g^3 condition at its root
            bend = ad * (1 + r) * slope / (8 * U * half**10) * tau * (1 + r)
        terms = self.terms(r)
        order = 0 if quantity.startswith("omega") else 1
        return s * self.side, Extremum(
            branch=0,
            theta1=float((2 * tau.atan()).mid()),
            value=float(value.mid()),
            kind=-sign(bend),
            value_terms=terms[order],
            slope_terms=terms[order + 1],
            theta1_terms=terms[order + 1] / abs(float(bend.mid())),
        )

    def terms(self, r: arb) -> list[float]:
        """Return the sums of the sizes of the terms of the rate and of its two derivatives, over omega1.

        As they stand in docs/numerics.md: what cancels between these terms is what a rounding can spoil.
        """
        scale = 4 * self.ad
        Z, C = r / (1 + r), 1 / (1 + r)
        p, q, gamma = (f(r) / (scale * (1 + r)) for f in (self.p, self.q, self.g))
        Z0, C0 = abs(arb(self.p[0]) / scale), abs(arb(self.q[1]) / scale)
        epsilon, kappa = abs(arb(self.e) / scale), abs(arb(self.k) / scale)
        sine, cosine, sigma = 2 * (Z * C).sqrt(), abs(C - Z), (p * q).sqrt()
        share = 1 + kappa / gamma
        H = sine / (2 * sigma)
        factor = C0 * Z * p + Z0 * C * q
        H_slope = factor / (2 * sigma**3)
        H_bend = (
            sine * (C0 * (p + Z) + Z0 * (q + C) + 3 * abs(q - p) * factor / (2 * sigma**2)) / (4 * sigma**3)
        )
        log_rate = sine / (2 * gamma)
        bend = (cosine / 2 + sine * log_rate) / gamma
        rate = 1 + epsilon / gamma + H * share
        first = epsilon * log_rate / gamma + H_slope * share + H * kappa / gamma * log_rate
        second = epsilon * bend / gamma + H_bend * share
        second += kappa / gamma * (2 * H_slope * log_rate + H * bend)
        return [float(total.mid()) / 2 for total in (rate, first, second)]


def sign(x: arb) -> int:
    """Return the sign of what a ball encloses."""
    if x > 0:
        return 1
    if x < 0:
        return -1
    raise ArithmeticError("the sign is not settled")


def extrema(lengths: np.ndarray, quantity: str) -> list[Extremum]:
    """Return every extremum of a rate of one linkage over the turn, by branch and input angle.

    Parameters
    ----------
    lengths : ndarray (4,)
        a1 ... a4, taken as the rational numbers that they are.
    quantity : str
        One of `RATES`, at omega1 = 1 rad/s.
    """
    linkage = Linkage(lengths, quantity[-1])
    condition = linkage.condition(quantity)
    mirrored = 1 if quantity.startswith("omega") else -1
    bits = BITS
    while True:
        try:
            with ctx.workprec(bits):
                found = [linkage.extremum(quantity, condition, r) for r in linkage.reachable_roots(condition)]
            break
        except ArithmeticError:
            bits *= 2
            assert bits <= 64 * BITS
    both = []
    for s, point in found:
        branch = 1 if s < 0 else 2
        both.append(replace(point, branch=branch))
        mirror = {
            "theta1": 2 * pi - point.theta1,
            "value": mirrored * point.value,
            "kind": mirrored * point.kind,
        }
        both.append(replace(point, branch=3 - branch, **mirror))
    return sorted(both, key=lambda point: (point.branch, point.theta1))


def counts(found: list[Extremum]) -> tuple[int, int]:
    """Return the number of extrema of branch 1 and of branch 2."""
    first = sum(point.branch == 1 for point in found)
    return first, len(found) - first
