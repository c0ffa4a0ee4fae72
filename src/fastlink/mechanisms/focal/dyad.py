"""The dyads of F, seen from the crank: sin^2(omega/2) and cos^2(omega/2) where the crank lies in the ground line.

In between they are mixed: sin^2(omega/2) = C s_0 + Z s_pi with C = cos^2(sigma/2), Z = sin^2(sigma/2), sums of positive
terms while the crank turns. The crank can stand in the ground line with omega = 0 or pi only where the four-bar folds.
So the differences of lengths in the cosine theorem hold its gaps as factors: with D = d + k c, D' = d - k c,
k = 1 or -1, the sizes R >= L of sqrt(W - D^2) and K = (1 + rho)(a^2 + rho b^2)

    s = |lambda|/(4 a b kappa (1 + rho) K) [D (a + rho b) + ..(a - b)] [..(a + b) - D' (a - rho b)]

with kappa = sqrt(x/rho), where .. is sqrt|rho| R or sqrt|rho| L with its sign. A bracket that cancels is the quotient
of gaps by its other form:

    D^2 (a + rho b)^2 - rho (W - D^2)(a - b)^2 = (D - a + b)(D + a - b) K,
    rho (W - D'^2)(a + b)^2 - D'^2 (a - rho b)^2 = (a + b - D')(a + b + D') K.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import opposite, product, quotient
from fastlink.mechanisms._shared.reuse import borrow
from fastlink.mechanisms.focal.design_facts import FOUR_BAR, PREFIX
from fastlink.mechanisms.focal.inputs import DESIGN, GIVEN_LAMBDA, focal
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.numerics.compensated import two_product
from fastlink.numerics.elementary import select

DYAD = f"{DESIGN}#the-crank"


FACTORS = (
    *(f"factor_{letter}{number}" for letter in "ABCD" for number in (1, 2)),
    *("sure_A1", "sure_B1", "sure_C1"),
)
borrow(focal, planar_4r, FOUR_BAR, PREFIX, {name: {} for name in FACTORS})


step = focal.steps(units="1", source=DYAD)
step(product, "K", "K", "(1 + rho)(a^2 + rho b^2), scaled", x="rho", y="common")
step(quotient, "V", "V", "(1 + rho)(a^2 + rho b^2)/lambda, scaled", x="K", y="lambda_")


@focal.quantity(units="1", symbol="sqrt|rho| R", source=DYAD, internal=True)
def greater_root(root_rho: Any, root_x: Any, s_c: Any, s_d: Any) -> Any:
    """Greater of both square roots, times that of the size of rho."""
    return root_rho * (root_x * s_d + s_c / root_x)


@focal.quantity(units="1", symbol="sqrt|rho| L", source=DYAD, internal=True)
def lesser_root(root_rho: Any, root_near: Any, completion: Any) -> Any:
    """Lesser of both square roots, times that of the size of rho, negative in completion 2."""
    return select(completion == 1.0, root_rho, -root_rho) * root_near


@focal.quantity(
    units="1", symbol="sqrt|rho| L", source=DYAD, internal=True, variant=GIVEN_LAMBDA, name="lesser_root"
)
def lesser_root_of_lambda(root_rho: Any, root_x: Any, x: Any, lambda_: Any, s_c: Any, s_d: Any) -> Any:
    """Lesser of both square roots, times that of the size of rho, as it is with lambda given."""
    return root_rho * (select(x < 0.0, (s_d - s_c) - lambda_ * s_d, x * s_d - s_c) / root_x)


@focal.quantity(units="1", symbol="|lambda|/(4 a b kappa (1 + rho))", source=DYAD, internal=True)
def per_dyad(s_a: Any, s_b: Any, lambda_: Any, root_x: Any, root_rho: Any, rho_plus_1: Any) -> Any:
    """|lambda|/(4 a b kappa (1 + rho)), scaled."""
    return abs(lambda_) / (4.0 * (s_a * s_b) * (root_x / root_rho) * rho_plus_1)


@focal.quantity(units="1", symbol="sgn lambda", source=DYAD, internal=True)
def lambda_sign(lambda_: Any) -> Any:
    """Sign of lambda."""
    return select(lambda_ < 0.0, -1.0, 1.0)


@focal.quantity(units="1", symbol="k", source=DYAD, internal=True)
def crank_sign(rho_plus_1: Any, lambda_sign: Any) -> Any:
    """Sign of (1 + rho) lambda."""
    return select(rho_plus_1 < 0.0, -lambda_sign, lambda_sign)


step(opposite, "minus_lambda_sign", "k", "The opposite sign", x="lambda_sign")
step(opposite, "minus_crank_sign", "k", "The opposite sign", x="crank_sign")


@focal.quantity(units="1", symbol="a + rho b", source=DYAD, internal=True)
def bars_sum(s_a: Any, s_b: Any, rho: Any) -> Any:
    """MA and rho times NB, scaled, right to a rounding."""
    part, low = two_product(rho, s_b)
    return (s_a + part) + low


@focal.quantity(units="1", symbol="a - rho b", source=DYAD, internal=True)
def bars_difference(s_a: Any, s_b: Any, rho: Any) -> Any:
    """MA less rho times NB, scaled, right to a rounding."""
    part, low = two_product(rho, s_b)
    return (s_a - part) - low


def of_half_angle(
    side: Any, spin: Any, lambda_sign: Any, ratio_sign: Any, greater_root: Any, lesser_root: Any, s_a: Any,
    s_b: Any, s_c: Any, s_d: Any, bars_sum: Any, bars_difference: Any, K: Any, per_dyad: Any, sure_A1: Any,
    sure_B1: Any, sure_C1: Any, A2: Any, B2: Any, C2: Any, D1: Any, D2: Any,
) -> Any:  # fmt: skip
    """Squared sine or cosine of omega/2 with the crank in the ground line."""
    root = select(side == ratio_sign, lesser_root, -greater_root)
    other_root = select(side == ratio_sign, greater_root, -lesser_root)
    first = side * ((s_a - s_b) * root)
    second = spin * ((s_d + side * s_c) * bars_sum)
    inner = select(side > 0.0, -(B2 * C2), -(sure_B1 * sure_C1))
    third = side * ((s_a + s_b) * other_root)
    fourth = spin * ((side * s_c - s_d) * bars_difference)
    outer = select(side > 0.0, A2 * D2, sure_A1 * D1)
    # the bracket that cancels holds K: it is divided out there
    one_cancels, two_cancels = first * second < 0.0, third * fourth < 0.0
    two = select(two_cancels, K * (outer / (third - fourth)), third + fourth)
    two_per_K = select(two_cancels, outer / (third - fourth), (third + fourth) / K)
    both_per_K = select(one_cancels, inner / (second - first) * two, (first + second) * two_per_K)
    return (spin * lambda_sign) * per_dyad * both_per_K


_FACTORS = {factor.removeprefix("factor_"): f"{PREFIX}{factor}" for factor in FACTORS}


def declare_dyad(name: str, what: str, side: str, spin: str) -> None:
    """Declare a squared sine or cosine of omega/2 with the crank in the ground line."""
    step(of_half_angle, name, "s", f"Squared {what}", side=side, spin=spin, **_FACTORS)


declare_dyad("sine_at_0", "sine of omega/2 at sigma = 0", "crank_sign", "lambda_sign")
declare_dyad("sine_at_pi", "sine of omega/2 at sigma = pi", "minus_crank_sign", "lambda_sign")
declare_dyad("cosine_at_0", "cosine of omega/2 at sigma = 0", "minus_crank_sign", "minus_lambda_sign")
declare_dyad("cosine_at_pi", "cosine of omega/2 at sigma = pi", "crank_sign", "minus_lambda_sign")

# -- F seen from M and N, where the dyads are straight: m - p or m + p, n + q or n - q ------------------------------


@focal.quantity(units="1", symbol="lambda p", source=DYAD, internal=True)
def lambda_p(ratio_sign: Any, lambda_sign: Any, root_rho: Any, root_x: Any, s_b: Any) -> Any:
    """PF times lambda, scaled."""
    return (ratio_sign * lambda_sign) * (root_rho * root_x * s_b)


@focal.quantity(units="1", symbol="|lambda| q", source=DYAD, internal=True)
def lambda_q(root_rho: Any, root_x: Any, s_a: Any) -> Any:
    """QF times the size of lambda, scaled."""
    return root_x / root_rho * s_a


@focal.quantity(units="1", symbol="m -+ p", source=DYAD, internal=True)
def straight_M(
    x: Any, s_m: Any, s_p: Any, P_sign: Any, V: Any, rho: Any, rho_plus_1: Any,
    s_a: Any, s_b: Any, lambda_p: Any,
) -> Any:  # fmt: skip
    """Difference of m and p, or sum where they have not one sign; of their product where P is far away."""
    product = V / rho_plus_1 - rho * (s_b * s_b)
    return select(x < -0.5, product / (s_a + abs(lambda_p)), s_m - P_sign * s_p)


@focal.quantity(units="1", symbol="n +- q", source=DYAD, internal=True)
def straight_N(
    x: Any, s_n: Any, s_q: Any, lambda_sign: Any, V: Any, rho: Any, rho_plus_1: Any,
    s_a: Any, s_b: Any, lambda_q: Any,
) -> Any:  # fmt: skip
    """Difference of n and q, or sum where they have not one sign; of their product where Q is far away."""
    product = (V / rho_plus_1 - s_a * s_a) / rho
    return select(x < -0.5, product / (s_b + abs(lambda_q)), s_n - lambda_sign * s_q)


def where_positive(sign: Any, length: Any) -> Any:
    """Return twice a length where a sign is positive, else 0."""
    return select(sign > 0.0, 2.0 * length, 0.0)


def minus_where_negative(sign: Any, length: Any) -> Any:
    """Return minus twice a length where a sign is negative, else 0."""
    return select(sign < 0.0, -2.0 * length, 0.0)


_CHANGE = "Change along the rocker with the squared half-angle"
step(where_positive, "M_of_sine", "2 p", _CHANGE, sign="P_sign", length="s_p")
step(minus_where_negative, "M_of_cosine", "2 p", _CHANGE, sign="P_sign", length="s_p")
step(minus_where_negative, "N_of_sine", "2 p", _CHANGE, sign="lambda_sign", length="s_q")
step(where_positive, "N_of_cosine", "2 p", _CHANGE, sign="lambda_sign", length="s_q")


@focal.quantity(units="1", symbol="p/m -+ 1", source=DYAD, internal=True)
def straight_lever_M(straight_M: Any, s_m: Any, P_sign: Any) -> Any:
    """PF over MP less its sign."""
    return -(P_sign * straight_M) / s_m


@focal.quantity(units="1", symbol="1 -+ q/n", source=DYAD, internal=True)
def straight_lever_N(straight_N: Any, s_n: Any, lambda_sign: Any) -> Any:
    """Its sign less QF over NQ."""
    return lambda_sign * straight_N / s_n


step(opposite, "minus_s_q", "-q", "Minus the scaled length QF", x="s_q")
