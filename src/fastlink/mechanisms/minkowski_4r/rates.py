"""Facts of motion of the Minkowskian 4R: the rates of psi by theta.

With (u, v) the null coordinates of AB, (a p, a/p) and (b q, b/q) those of the cranks, and d their product
b q v - b u/q, which is the root of the discriminant,

    psi'  = a (p v - u/p)/d
    psi'' = a b g {(p q v^2 - u^2/(p q)) (u - v) - h^2 (p/q - q/p) [a (p - 1/p) + b (q - 1/q)]}/d^3

where each null coordinate is right to a few roundings of its own. With N = (AC)^2, S = sinh^2(theta/2), C = 1 + S, the
limits S1 and S2 of S, P = S1 - S, Q = S2 - S and n = N + h^2 - b^2 the same is

    psi'  = (a/N) [g sh(theta) n/d - (g ch(theta) - a)]
    psi'' = 16 a^3 g^3 (n/N) [C P S2 + S Q (1 + S1)]/d^3
            + (a g sh(theta)/N^2) [2 a g sh(theta) (h^2 - b^2)/d - (g^2 - a^2)]

which keeps its digits where the linkage nearly folds (p, q, u/v near 1, d near 0) and loses them where N
is near 0 and for great theta. The form with the smaller terms is used. Where psi follows theta, psi' is
1 - g (u - v)/d.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import opposite_product, product, same, square_difference, twice_product
from fastlink.mechanisms.minkowski_4r import coupler, position  # noqa: F401 (whose rates these are)
from fastlink.mechanisms.minkowski_4r.inputs import NUMERICS, minkowski_4r
from fastlink.numerics.compensated import sum_of_four
from fastlink.numerics.elementary import NOT_A_NUMBER, select

RATES = f"{NUMERICS}#rates"
# Of the longest link.
SHORTEST = 2.0**-128


@minkowski_4r.quantity(units="1", symbol="c", source=RATES, internal=True)
def rate_unit(s_a: Any, s_b: Any, s_g: Any, s_h: Any, product_one: Any) -> Any:
    """Twice the product of a and g over its power of two; NaN where products of five lengths may underflow."""
    comparable = (s_a > SHORTEST) & (s_b > SHORTEST) & (s_g > SHORTEST) & (s_h > SHORTEST)
    return select(comparable, product_one, NOT_A_NUMBER)


@minkowski_4r.quantity(units="1", symbol="1/d", source=RATES, internal=True)
def per_root(half_root: Any, rate_unit: Any, branch_sign: Any, side: Any) -> Any:
    """Reciprocal of the root of the discriminant times r, with the sign of the root; NaN at a limit."""
    return branch_sign * side * 0.5 / (rate_unit * select(half_root == 0.0, NOT_A_NUMBER, half_root))


@minkowski_4r.quantity(units="1", symbol="N", source=RATES, internal=True)
def diagonal(alpha_r: Any, beta: Any, a_one: Any) -> Any:
    """(AC)^2 times r; NaN where A and C are lightlike separated."""
    product = (a_one * alpha_r) * (a_one * beta)
    return select(product == 0.0, NOT_A_NUMBER, product)


step = minkowski_4r.steps(units="1", source=RATES)
step(twice_product, "coupler_sum", "n", "(AC)^2 + h^2 - b^2, times r", x="product_one", y="AB_half")
_GROUND = "Square of the ground link less that of the input crank"
step(square_difference, "ground_excess", "g^2 - a^2", _GROUND, x="s_g", y="s_a")
_COUPLER = "Square of the coupler less that of the output crank"
step(square_difference, "coupler_excess", "h^2 - b^2", _COUPLER, x="s_h", y="s_b")
step(
    twice_product,
    "twice_s_a_s_g",
    "2 a g",
    "Twice the product of input crank and ground link",
    x="s_a",
    y="s_g",
)


@minkowski_4r.quantity(units="1", symbol="1 + S_1", source=RATES, internal=True)
def inner_square(s_a: Any, s_b: Any, s_g: Any, s_h: Any, product_one: Any) -> Any:
    """Times kappa: cosh^2(theta_min/2), (g + a - b - h) (g + a + b + h) kappa/(4 a g)."""
    short, _low = sum_of_four(s_g, s_a, -s_b, -s_h)
    return 0.5 * (short * ((s_g + s_a) + (s_b + s_h))) / product_one


@minkowski_4r.quantity(units="1", symbol="dpsi/dtheta", source=RATES)
def dpsi_dtheta(
    s_a: Any, s_g: Any, s_h: Any, sinh_r: Any, S_r: Any, p_r: Any, per_p: Any, r: Any, AB_u: Any, AB_v: Any,
    coupler_sum: Any, diagonal: Any, per_root: Any,
) -> Any:  # fmt: skip
    """Transmission ratio: rate of psi by theta."""
    one, other = s_a * s_h * per_root * (p_r * AB_v), s_a * s_h * per_root * (per_p * AB_u)
    odd = s_a * s_g * sinh_r * (coupler_sum * per_root) / diagonal
    ground, rise = s_a * ((s_g - s_a) * r) / diagonal, 2.0 * s_a * s_g * S_r / diagonal
    folded = abs(odd) + (abs(ground) + abs(rise)) < abs(one) + abs(other)
    ratio = select(folded, odd - (ground + rise), one - other)
    # Where psi follows theta, 1 is nearly all of it.
    u, v = s_g * s_h * per_root * AB_u, s_g * s_h * per_root * (AB_v * r)
    return select(abs(u) + abs(v) < 0.25, 1.0 - (u - v), ratio)


# Each form of psi'', with the sum of the sizes of its terms.


@minkowski_4r.quantity(units="1", symbol="1/d^3", source=RATES, internal=True)
def bend_scale(s_a: Any, s_b: Any, s_g: Any, s_h: Any, per_root: Any) -> Any:
    """Product a b g h^2/d^3, over the third power of r."""
    return s_a * s_b * s_g * (s_h * s_h) * per_root * per_root * per_root


@minkowski_4r.quantity(units="1", symbol="psi''", source=RATES, internal=True)
def null_bend(
    s_a: Any, s_b: Any, s_h: Any, sinh_r: Any, p_r: Any, per_p: Any, r: Any, CB_u: Any, CB_v: Any, AB_u: Any,
    AB_v: Any, bend_scale: Any,
) -> Any:  # fmt: skip
    """Psi'' by null coordinates, for abs(theta)."""
    squares = p_r * CB_u * (AB_v * AB_v) - per_p * CB_v * (AB_u * AB_u)
    heights = 2.0 * s_a * sinh_r + s_b * (CB_u - CB_v * r)
    turning = (p_r * CB_v - per_p * CB_u) * heights * r
    return bend_scale * (s_h * squares * (AB_u - AB_v * r) - turning)


@minkowski_4r.quantity(units="1", symbol="|psi''|", source=RATES, internal=True)
def null_bend_size(
    s_a: Any, s_b: Any, s_h: Any, sinh_r: Any, p_r: Any, per_p: Any, r: Any, CB_u: Any, CB_v: Any, AB_u: Any,
    AB_v: Any, bend_scale: Any,
) -> Any:  # fmt: skip
    """Sum of the sizes of the terms of null_bend."""
    squares = abs(p_r * CB_u) * (AB_v * AB_v) + abs(per_p * CB_v) * (AB_u * AB_u)
    heights = 2.0 * s_a * sinh_r + s_b * (abs(CB_u) + abs(CB_v) * r)
    turning = (abs(p_r * CB_v) + abs(per_p * CB_u)) * heights * r
    return abs(bend_scale) * (s_h * squares * (abs(AB_u) + abs(AB_v) * r) + turning)


@minkowski_4r.quantity(units="1", symbol="psi''", source=RATES, internal=True)
def odd_bend(
    inside: Any, outside: Any, outer_limit: Any, inner_square: Any, S_r: Any, r: Any, twice_s_a_s_g: Any,
    product_one: Any, coupler_sum: Any, diagonal: Any, per_root: Any,
) -> Any:  # fmt: skip
    """First term of psi'' by (AC)^2."""
    change = (r + S_r) * inside * outer_limit - S_r * outside * inner_square
    roots = per_root * per_root * per_root
    return 2.0 * twice_s_a_s_g * (product_one * product_one) * change * r * (coupler_sum / diagonal) * roots


@minkowski_4r.quantity(units="1", symbol="psi''", source=RATES, internal=True)
def tilt(sinh_r: Any, r: Any, twice_s_a_s_g: Any, diagonal: Any) -> Any:
    """Product a g sh(theta)/N^2."""
    return 0.5 * twice_s_a_s_g * (sinh_r / diagonal) * (r / diagonal)


@minkowski_4r.quantity(units="1", symbol="d2psi/dtheta2", source=RATES)
def d2psi_dtheta2(
    null_bend: Any, null_bend_size: Any, odd_bend: Any, tilt: Any, sinh_r: Any, twice_s_a_s_g: Any,
    coupler_excess: Any, ground_excess: Any, per_root: Any, side: Any,
) -> Any:  # fmt: skip
    """Rate of the transmission ratio by theta."""
    bent = tilt * (twice_s_a_s_g * sinh_r * coupler_excess * per_root)
    ground = tilt * ground_excess
    folded = abs(odd_bend) + (abs(bent) + abs(ground)) < null_bend_size
    return side * select(folded, odd_bend + (bent - ground), null_bend)


@minkowski_4r.quantity(units="1", symbol="lambda'", source=RATES, internal=True)
def AB_rate(
    s_a: Any, s_b: Any, s_g: Any, p_r: Any, per_p: Any, r: Any, CB_u: Any, CB_v: Any, per_root: Any
) -> Any:
    """Rate of the rapidity of AB by theta, a b (p/q - q/p)/d, or 1 - g b (q - 1/q)/d."""
    ratio = s_a * s_b * per_root * (p_r * CB_v - per_p * CB_u)
    u, v = s_g * s_b * per_root * CB_u, s_g * s_b * per_root * (CB_v * r)
    return select(abs(u) + abs(v) < 0.25, 1.0 - (u - v), ratio)


# -- declared derivatives by theta: of the tables, and where the closed form is there already --------------------


def constant() -> Any:
    """Return 0."""
    return 0.0


def half_sinh(sinh_r: Any, side: Any) -> Any:
    """Derivative of sinh^2(theta/2)."""
    return 0.5 * (side * sinh_r)


def cosh_part(r: Any, S_r: Any, side: Any) -> Any:
    """Derivative of sinh abs(theta)."""
    return side * (r + 2.0 * S_r)


def arm_grows(x: Any, rate: Any, side: Any) -> Any:
    """Derivative of the first null coordinate of an arm, for abs(theta)."""
    return side * (x * rate)


def arm_shrinks(x: Any, rate: Any, side: Any) -> Any:
    """Derivative of the second null coordinate of an arm."""
    return -(side * (x * rate))


def half_angle_slope(CB_ratio: Any, CB_scale: Any, dpsi_dtheta: Any) -> Any:
    """Derivative of (q - 1)/(q + 1)."""
    below = CB_ratio + CB_scale
    return 2.0 * (CB_ratio / below) * (CB_scale / below) * dpsi_dtheta


derivative = minkowski_4r.derivatives("theta")
derivative(constant, "side")
derivative(constant, "twos")
derivative(constant, "r")
derivative(product, "p_r", x="side", y="p_r")
derivative(opposite_product, "per_p", x="side", y="per_p")
derivative(half_sinh, "S_r")
derivative(cosh_part, "sinh_r")
derivative(same, "cosh_theta", x="sinh_theta")
derivative(same, "sinh_theta", x="cosh_theta")
derivative(same, "psi", x="dpsi_dtheta")
derivative(same, "AB_rapidity", x="AB_rate")
derivative(same, "dpsi_dtheta", x="d2psi_dtheta2")
derivative(half_angle_slope, "half_angle_root")
derivative(arm_grows, "CB_u", x="CB_u", rate="dpsi_dtheta")
derivative(arm_grows, "CB_far", x="CB_far", rate="dpsi_dtheta")
derivative(arm_shrinks, "CB_v", x="CB_v", rate="dpsi_dtheta")
derivative(arm_grows, "AB_u", x="AB_u", rate="AB_rate")
derivative(arm_grows, "AB_far", x="AB_far", rate="AB_rate")
derivative(arm_shrinks, "AB_v", x="AB_v", rate="AB_rate")
