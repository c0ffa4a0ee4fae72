"""Facts of position of the Minkowskian 4R: both cranks and the coupler in null coordinates.

The null coordinates of a vector are u = x + y and v = x - y. Turning by a rapidity t multiplies them by e^t and
e^-t: OA is (a p, a/p) with p = e^theta, CB is (b q, b/q), AC is (alpha, beta) = (g - a p, g - a/p), AB is AC + CB.
All is in terms of |theta|, of which p is the greater: for a negative theta u and v are exchanged. What grows like p is
tabled and computed times r, a power of two near 1/p, so nothing overflows.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastlink.mechanisms.minkowski_4r.design_facts import POSITION, SCALING
from fastlink.mechanisms.minkowski_4r.inputs import HEGEDUS, minkowski_4r
from fastlink.numerics.elementary import (
    INFINITY,
    NOT_A_NUMBER,
    binary_exponent,
    cosh,
    exp,
    ldexp,
    select,
    sinh,
    sqrt,
)
from fastlink.numerics.logarithm import log_quotient, quotient_sign

# Scales of products of two numbers, and the inverse root of each: where both are tiny, and elsewhere.
UP, ROOT_DOWN, UP_TINY, ROOT_DOWN_TINY = 2.0**500, 2.0**-250, 2.0**1000, 2.0**-500
TINY = 2.0**-400
ORIENTATION_FLAGS = {-1: "past_pointing", 0: "none", 1: "future_pointing"}

# -- tables of the input rapidity ------------------------------------------------------------------------------


@minkowski_4r.table(symbol="sgn theta", source=SCALING)
def side(theta: Any) -> Any:
    """-1 for a negative input rapidity, else 1."""
    return select(theta < 0.0, -1.0, 1.0)


@minkowski_4r.table(symbol="k", source=SCALING)
def twos(theta: Any) -> Any:
    """Number of doublings nearest to e^abs(theta)."""
    return binary_exponent(abs(theta))


@minkowski_4r.table(symbol="r", source=SCALING)
def r(theta: Any) -> Any:
    """Power of two near e^-abs(theta); it may underflow, where nothing of its size counts."""
    return ldexp(1.0, -binary_exponent(abs(theta)))


@minkowski_4r.table(symbol="p r", source=POSITION, low="p_r_low")
def p_r(theta: Any) -> Any:
    """e^abs(theta) times r."""
    return ldexp(exp(abs(theta)), -binary_exponent(abs(theta)))


@minkowski_4r.table(symbol="1/p", source=POSITION, low="per_p_low")
def per_p(theta: Any) -> Any:
    """e^-abs(theta)."""
    return exp(-abs(theta))


@minkowski_4r.table(symbol="S r", source=POSITION, low="S_r_low")
def S_r(theta: Any) -> Any:
    """sinh^2(theta/2) times r."""
    return ldexp(sinh(theta / 2) * sinh(theta / 2), -binary_exponent(abs(theta)))


@minkowski_4r.table(symbol="r sinh", source=POSITION)
def sinh_r(theta: Any) -> Any:
    """Sinh of abs(theta), times r."""
    return ldexp(sinh(abs(theta)), -binary_exponent(abs(theta)))


@minkowski_4r.table(symbol="cosh theta", source=POSITION)
def cosh_theta(theta: Any) -> Any:
    """Hyperbolic cosine of the input rapidity."""
    return cosh(theta)


@minkowski_4r.table(symbol="sinh theta", source=POSITION)
def sinh_theta(theta: Any) -> Any:
    """Hyperbolic sine of the input rapidity."""
    return sinh(theta)


# -- the loop --------------------------------------------------------------------------------------------------


@minkowski_4r.quantity(units="1", symbol="s", source=POSITION, internal=True)
def branch_sign(branch: Any) -> Any:
    """1 for branch 1, -1 for branch 2: the sign of the root; the mirror theta -> -theta exchanges the branches."""
    return 3.0 - 2.0 * branch


@minkowski_4r.quantity(units="1", symbol="P", source=POSITION, internal=True)
def inside(inner_limit: Any, inner_limit_low: Any, S_r: Any, S_r_low: Any, r: Any, product_two: Any) -> Any:
    """((AC)^2 - (b + h)^2) r kappa/(4 a g): positive inside the inner limit."""
    return (inner_limit * r - S_r * product_two) + (inner_limit_low * r - S_r_low * product_two)


@minkowski_4r.quantity(units="1", symbol="Q", source=POSITION, internal=True)
def outside(outer_limit: Any, outer_limit_low: Any, S_r: Any, S_r_low: Any, r: Any, product_two: Any) -> Any:
    """((b - h)^2 - (AC)^2) r kappa/(4 a g): positive outside the outer limit."""
    return (S_r * product_two - outer_limit * r) + (S_r_low * product_two - outer_limit_low * r)


@minkowski_4r.quantity(units="1", symbol="sigma", source=POSITION, internal=True)
def half_root(inside: Any, outside: Any) -> Any:
    """Half the root of the discriminant, times r kappa/(2 a g); NaN where the loop does not close."""
    # Between the limits both are negative, else one is. Their product must not underflow, and the product of one with
    # the derivative of the other, which is as great as the shortest length is small, must not overflow.
    tiny = abs(inside) + abs(outside) < TINY
    root = sqrt(-(inside * select(tiny, UP_TINY, UP) * outside))
    return root * select(tiny, ROOT_DOWN_TINY, ROOT_DOWN)


@minkowski_4r.quantity(units="1", symbol="alpha", source=POSITION, internal=True)
def alpha_r(ground_share: Any, ground_share_low: Any, p_r: Any, p_r_low: Any, r: Any, a_two: Any) -> Any:
    """The greater null coordinate of AC for abs(theta), g - a p, times r over the fraction of a."""
    return a_two * ((ground_share * r - p_r) + (ground_share_low * r - p_r_low))


@minkowski_4r.quantity(units="1", symbol="beta", source=POSITION, internal=True)
def beta(ground_share: Any, ground_share_low: Any, per_p: Any, per_p_low: Any, a_two: Any) -> Any:
    """The other null coordinate of AC, g - a/p, over the fraction of a."""
    return a_two * ((ground_share - per_p) + (ground_share_low - per_p_low))


@minkowski_4r.quantity(units="1", symbol="m/2", source=POSITION, internal=True)
def CB_half(CB_inner: Any, CB_outer: Any, inside: Any, outside: Any, r: Any) -> Any:
    """(h^2 - b^2 - (AC)^2) r kappa/(4 a g): minus half the middle coefficient of the quadratic of q."""
    return select(inside >= 0.0, -(CB_inner * r + inside), outside - CB_outer * r)


@minkowski_4r.quantity(units="1", symbol="n/2", source=POSITION, internal=True)
def AB_half(AB_inner: Any, AB_outer: Any, inside: Any, outside: Any, r: Any) -> Any:
    """(h^2 - b^2 + (AC)^2) r kappa/(4 a g): the same for AB."""
    return select(inside >= 0.0, AB_inner * r + inside, AB_outer * r - outside)


# An arm of length l has u = (half + root)/beta and v = (half - root)/alpha, u v = l^2: the one that does not cancel
# gives the other. Its ratio is u r/l where the sum is that one, else u/l.


def takes_sum(half: Any, branch_sign: Any, side: Any) -> Any:
    """Return 1 where half and the signed root do not cancel, else 0."""
    return select(((half < 0.0) == (side < 0.0)) == (branch_sign > 0.0), 1.0, 0.0)


def arm_sum(half: Any, half_root: Any) -> Any:
    """Return the sum of half and root that does not cancel."""
    return select(half < 0.0, half - half_root, half + half_root)


def arm_ratio(total: Any, takes_sum: Any, length: Any, alpha_r: Any, beta: Any) -> Any:
    """Return u r/l or u/l; NaN where that is zero or infinite."""
    top = select(takes_sum == 1.0, total, length * alpha_r)
    bottom = select(takes_sum == 1.0, length * beta, total)
    found = top / select(bottom == 0.0, INFINITY, bottom)
    return select((abs(found) > 0.0) & (abs(found) < INFINITY), found, NOT_A_NUMBER)


def scale_of(takes_sum: Any, r: Any) -> Any:
    """Return the factor of the ratio."""
    return select(takes_sum == 1.0, r, 1.0)


def grown(ratio: Any, takes_sum: Any, r: Any) -> Any:
    """Return u r/l."""
    return ratio * select(takes_sum == 1.0, 1.0, r)


def far(ratio: Any, scale: Any) -> Any:
    """Return u/l, whatever its size."""
    return ratio / scale


def shrunk(ratio: Any, scale: Any) -> Any:
    """Return v/l."""
    return scale / ratio


def sum_rapidity(total: Any, length: Any, beta: Any, twos: Any) -> Any:
    """Return the logarithm of abs(u)/l where the sum is that one."""
    return log_quotient(total, length * beta, twos)


def other_rapidity(total: Any, length: Any, alpha_r: Any) -> Any:
    """Return the logarithm of abs(u)/l where it is not."""
    return log_quotient(length * alpha_r, total, 0.0)


def rapidity(takes_sum: Any, sum_rapidity: Any, other_rapidity: Any, side: Any) -> Any:
    """Return the logarithm of abs(u)/l, with the sign for a negative theta."""
    return side * select(takes_sum == 1.0, sum_rapidity, other_rapidity)


def sum_orientation(total: Any, length: Any, beta: Any) -> Any:
    """Return the sign of u where the sum is that one."""
    return quotient_sign(total, length * beta)


def other_orientation(total: Any, length: Any, alpha_r: Any) -> Any:
    """Return the sign of u where it is not."""
    return quotient_sign(length * alpha_r, total)


def orientation(takes_sum: Any, sum_orientation: Any, other_orientation: Any) -> Any:
    """Return 1 for a future-pointing, -1 for a past-pointing arm, 0 where there is none."""
    return select(takes_sum == 1.0, sum_orientation, other_orientation)


def declare_arm(arm: str, length: str, angle: tuple[str, str, str, str]) -> None:
    """Declare the null coordinates, the rapidity and the orientation of CB or AB."""
    given = {
        "half": f"{arm}_half",
        "takes_sum": f"{arm}_takes_sum",
        "length": length,
        "ratio": f"{arm}_ratio",
        "scale": f"{arm}_scale",
        "total": f"{arm}_sum",
        "sum_rapidity": f"{arm}_sum_rapidity",
        "other_rapidity": f"{arm}_other_rapidity",
        "sum_orientation": f"{arm}_sum_orientation",
        "other_orientation": f"{arm}_other_orientation",
    }
    steps = minkowski_4r.steps(units="1", source=POSITION)

    def step(law: Callable[..., Any], name: str, meaning: str) -> None:
        steps(law, f"{arm}_{name}", name, f"{meaning}, of {arm}", **given)

    step(takes_sum, "takes_sum", "1 where the sum of half and root does not cancel")
    step(arm_sum, "sum", "the sum of half and root that does not cancel")
    step(sum_rapidity, "sum_rapidity", "rapidity where that sum is the first null coordinate, for abs(theta)")
    step(other_rapidity, "other_rapidity", "rapidity where it is not, for abs(theta)")
    step(sum_orientation, "sum_orientation", "orientation where that sum is the first null coordinate")
    step(other_orientation, "other_orientation", "orientation where it is not")
    step(arm_ratio, "ratio", "first null coordinate over the length, times scale")
    step(scale_of, "scale", "what the ratio is multiplied by")
    step(grown, "u", "first null coordinate over the length, times r")
    step(far, "far", "first null coordinate over the length")
    step(shrunk, "v", "second null coordinate over the length")
    name, symbol, of, equation = angle
    quantity = minkowski_4r.quantities(units="1", source=f"{HEGEDUS}, {equation}; {POSITION}")
    quantity(rapidity, name, symbol, f"Rapidity of {of}", **given)
    code = minkowski_4r.quantities(units="1", source=POSITION, flags=ORIENTATION_FLAGS)
    meaning = f"Whether {arm} is future- or past-pointing; 0 where it is not determined"
    code(orientation, f"{arm}_orientation", f"sgn {arm}", meaning, **given)


declare_arm("CB", "b_share", ("psi", "psi", "the output crank CB", "eq. (3)"))
declare_arm("AB", "h_share", ("AB_rapidity", "theta + phi - pi", "the coupler AB", "eq. (9)"))
