"""Facts of position of the Minkowskian 4R: both cranks and the coupler in null coordinates.

The null coordinates of a vector are u = x + y and v = x - y. Turning by a rapidity t multiplies them by e^t and
e^-t: OA is (a p, a/p) with p = e^theta, CB is (b q, b/q), AC is (alpha, beta) = (g - a p, g - a/p), AB is AC + CB.
All is in terms of |theta|, of which p is the greater: for a negative theta u and v are exchanged. What grows like p is
tabled and computed times r, a power of two near 1/p, so nothing overflows.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastlink._text import in_words
from fastlink.mechanisms._shared import laws
from fastlink.mechanisms._shared.laws import (
    difference,
    opposite_product,
    product,
    same,
    square_difference,
    total,
    twice_product,
)
from fastlink.mechanisms.minkowski_4r.design_facts import POSITION, SCALING
from fastlink.mechanisms.minkowski_4r.inputs import HEGEDUS, NUMERICS, minkowski_4r
from fastlink.numerics.compensated import sum_of_four
from fastlink.numerics.elementary import (
    INFINITY,
    NOT_A_NUMBER,
    PI,
    binary_exponent,
    cosh,
    exp,
    ldexp,
    select,
    sinh,
    sqrt,
)
from fastlink.numerics.logarithm import arsinh, log_quotient, quotient_sign
from fastlink.numerics.vectors import size_power

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


# -- By how much a traced coupler point misses the coupler sextic

# The sextic is N(W) + 4 V^2 = 0 as `fastlink.minkowski.sextic` has it, here in null coordinates, in which
# products are formed coordinate by coordinate, with W and V times h, and over powers of r, so that nothing
# overflows.


SEXTIC = f"{NUMERICS}#sextic"


def first_null(along: Any, across: Any, side: Any) -> Any:
    """Return the first null coordinate of a point of the coupler, for abs(theta)."""
    return along + side * across


def second_null(along: Any, across: Any, side: Any) -> Any:
    """Return the second null coordinate."""
    return along - side * across


def traced(crank: Any, input_null: Any, along: Any, coupler_null: Any) -> Any:
    """Return a null coordinate of the coupler point in the ground frame."""
    return crank * input_null + along * coupler_null


step = minkowski_4r.steps(units="1", source=SEXTIC)
step(laws.scaled, "s_x", "s_x", "scaled coupler point along AB", length="x")
step(laws.scaled, "s_y", "s_y", "scaled coupler point across AB", length="y")
step(first_null, "s_u", "s_u", "first null coordinate of X in the coupler", along="s_x", across="s_y")
step(second_null, "s_v", "s_v", "second null coordinate of X in the coupler", along="s_x", across="s_y")
_U = {"crank": "s_a", "input_null": "p_r", "along": "s_u", "coupler_null": "AB_u"}
_V = {"crank": "s_a", "input_null": "per_p", "along": "s_v", "coupler_null": "AB_v"}
step(traced, "X_u", "X_u", "first null coordinate of X, scaled, times r", **_U)
step(traced, "X_v", "X_v", "second null coordinate of X, scaled", **_V)


@minkowski_4r.quantity(units="1", symbol="f", source=f"{HEGEDUS}, eq. (14), section 3.5; {SEXTIC}")
def sextic_residual(
    s_a: Any, s_b: Any, s_g: Any, s_h: Any, s_x: Any, s_y: Any, s_u: Any, s_v: Any, X_u: Any, X_v: Any,
    r: Any, side: Any,
) -> Any:  # fmt: skip
    """Value of the coupler sextic at the traced point, relative to the sizes of its terms."""
    k = s_u * s_v - s_a * s_a
    k_size = abs(s_u * s_v) + s_a * s_a
    c = (2.0 * (s_h * s_x) - s_a * s_a - s_h * s_h) + (s_b - s_g) * (s_b + s_g)
    c_size = (2.0 * (s_h * abs(s_x)) + s_a * s_a + s_h * s_h) + (s_b * s_b + s_g * s_g)
    norm = X_u * X_v
    norm_size = abs(norm)
    u, v = abs(X_u), abs(X_v)
    first = s_h * (norm + k * r) * (X_u - s_g * r) - s_v * ((s_g * X_u + c * r) * X_u - k * s_g * r * r)
    second = s_h * (norm + k * r) * (X_v - s_g) - s_u * r * ((s_g * X_v + c) * X_v - k * s_g)
    across = s_g * (0.5 * (X_u - X_v * r)) * (s_u * s_v - s_h * s_x) * side
    along = s_h * s_y * (norm - s_g * (0.5 * (X_u + X_v * r)))
    first_size = s_h * (norm_size + k_size * r) * (u + s_g * r)
    first_size = first_size + abs(s_v) * ((s_g * u + c_size * r) * u + k_size * s_g * r * r)
    second_size = s_h * (norm_size + k_size * r) * (v + s_g)
    second_size = second_size + abs(s_u) * r * ((s_g * v + c_size) * v + k_size * s_g)
    third_size = s_g * (0.5 * (u + v * r)) * (abs(s_u * s_v) + s_h * abs(s_x))
    third_size = third_size + s_h * abs(s_y) * (norm_size + s_g * (0.5 * (u + v * r)))
    third = across - along
    value = first * second + 4.0 * r * (third * third)
    return value / (first_size * second_size + 4.0 * r * (third_size * third_size))


# -- Facts of the Minkowskian 4R in the words of the paper: its angles, points in the ground frame, status


# Beyond it 2 arsinh(sqrt(x/2)) is log(2 x) to rounding.
GREAT = 2.0**100
CONFIGURATION_FLAGS = {
    0: "closes",
    1: "does_not_close",
    2: "root_at_infinity",
    3: "undetermined",
    4: "at_a_limit",
    5: "beyond_the_range_of_numbers",
    6: "invalid_input",
    7: "closes_zeta_undefined",
    8: "closes_half_angle_root_infinite",
    9: "closes_zeta_undefined_half_angle_root_infinite",
}


@minkowski_4r.quantity(units="1", symbol="th(psi/2)", source=f"{HEGEDUS}, eq. (3); {POSITION}")
def half_angle_root(CB_ratio: Any, CB_scale: Any, side: Any) -> Any:
    """Root of the tan-half-angle quadratic: th(psi/2), or its reciprocal where CB is past-pointing."""
    below = CB_ratio + CB_scale
    return select(below == 0.0, INFINITY, side * (CB_ratio - CB_scale) / select(below == 0.0, 1.0, below))


@minkowski_4r.quantity(units="1", symbol="phi", source=f"{HEGEDUS}, Theorem 3.5")
def phi(AB_ratio: Any, AB_takes_sum: Any, p_r: Any, twos: Any, side: Any) -> Any:
    """Coupler angle as printed: rapidity of AB less theta, plus pi."""
    return side * log_quotient(AB_ratio, p_r, select(AB_takes_sum == 1.0, 0.0, -twos)) + PI


@minkowski_4r.quantity(units="1", symbol="r (ch(zeta) - 1)", source=POSITION, internal=True)
def zeta_excess(outside: Any, product_one: Any, s_b: Any, s_h: Any) -> Any:
    """Hyperbolic cosine of the transmission angle less 1, times r."""
    return product_one * outside / s_b / s_h


@minkowski_4r.quantity(units="1", symbol="ch(zeta)", source=f"{HEGEDUS}, Theorem 3.6; {POSITION}")
def cosh_zeta(inside: Any, zeta_excess: Any, product_one: Any, s_b: Any, s_h: Any, r: Any) -> Any:
    """Hyperbolic cosine of the transmission angle; negative inside the inner limit, where no angle has it."""
    past = -1.0 - product_one * inside / s_b / s_h / r
    found = select(inside >= 0.0, past, select(zeta_excess >= 0.0, 1.0 + zeta_excess / r, NOT_A_NUMBER))
    return select(abs(found) < INFINITY, found, NOT_A_NUMBER)


@minkowski_4r.quantity(units="1", symbol="zeta", source=f"{HEGEDUS}, Theorem 3.6; {POSITION}")
def zeta(zeta_excess: Any, r: Any, twos: Any) -> Any:
    """Transmission angle: between the coupler and the output crank; NaN inside the inner limit."""
    great = zeta_excess > GREAT * r
    return select(
        great, log_quotient(2.0 * zeta_excess, 1.0, twos), 2.0 * arsinh(sqrt(0.5 * (zeta_excess / r)))
    )


# -- points ------------------------------------------------------------------------------------------------------


def finite(x: Any) -> Any:
    """Return x; NaN where it is beyond the range of numbers."""
    return select(abs(x) < INFINITY, x, NOT_A_NUMBER)


def first(offset: Any, along_u: Any, along_v: Any, u: Any, v: Any, side: Any) -> Any:
    """Return the first coordinate of a point from null coordinates."""
    return offset + 0.5 * (along_u * u + along_v * v)


def second(offset: Any, along_u: Any, along_v: Any, u: Any, v: Any, side: Any) -> Any:
    """Return the second coordinate."""
    return offset + side * (0.5 * (along_u * u - along_v * v))


@minkowski_4r.quantity(units="m", symbol="x + y", source=POSITION, internal=True)
def X_along_u(x: Any, y: Any, side: Any) -> Any:
    """First null coordinate of the coupler point in the coupler's frame, for abs(theta)."""
    return x + side * y


@minkowski_4r.quantity(units="m", symbol="x - y", source=POSITION, internal=True)
def X_along_v(x: Any, y: Any, side: Any) -> Any:
    """Second null coordinate of the coupler point in the coupler's frame, for abs(theta)."""
    return x - side * y


@minkowski_4r.quantity(units="m", symbol="C_y", source=POSITION, internal=True)
def C_y(g: Any) -> Any:
    """Ground pivot C, second coordinate."""
    return 0.0 * g


def declare_coordinate(name: str, meaning: str, equation: str, law: Callable[..., Any], **given: str) -> None:
    """Declare a coordinate of a point, and the same beyond the range of numbers."""
    point, source = f"point_{name}", f"{HEGEDUS}, {equation}; {POSITION}"
    minkowski_4r.steps(units="m", source=source)(law, point, name, f"{meaning}, whatever its size", **given)
    minkowski_4r.quantities(units="m", source=source)(finite, name, name, meaning, x=point)


_B = {"along_u": "b", "along_v": "b", "u": "CB_far", "v": "CB_v"}
_X = {"along_u": "X_along_u", "along_v": "X_along_v", "u": "AB_far", "v": "AB_v"}
declare_coordinate("A_x", "Moving pivot A, first coordinate", "eq. (5)", product, x="a", y="cosh_theta")
declare_coordinate("A_y", "Moving pivot A, second coordinate", "eq. (5)", product, x="a", y="sinh_theta")
declare_coordinate("B_x", "Moving pivot B, first coordinate", "eq. (5)", first, offset="g", **_B)
declare_coordinate("B_y", "Moving pivot B, second coordinate", "eq. (5)", second, offset="C_y", **_B)
declare_coordinate("X_x", "Coupler point X, first coordinate", "section 3.5", first, offset="point_A_x", **_X)
declare_coordinate(
    "X_y", "Coupler point X, second coordinate", "section 3.5", second, offset="point_A_y", **_X
)


# -- residual and status -----------------------------------------------------------------------------------------


@minkowski_4r.quantity(units="1", symbol="e", source=POSITION)
def loop_residual(
    s_a: Any, s_b: Any, s_g: Any, s_h: Any, p_r: Any, per_p: Any, r: Any, AB_u: Any, AB_v: Any, CB_u: Any,
    CB_v: Any,
) -> Any:  # fmt: skip
    """Closure error of the loop in null coordinates, relative to the sizes of its terms."""
    u_terms = (s_a * p_r + s_h * abs(AB_u)) + (s_g * r + s_b * abs(CB_u))
    v_terms = (s_a * per_p + s_h * abs(AB_v)) + (s_g + s_b * abs(CB_v))
    e_u = ((s_a * p_r - s_g * r) + (s_h * AB_u - s_b * CB_u)) / u_terms
    e_v = ((s_a * per_p - s_g) + (s_h * AB_v - s_b * CB_v)) / v_terms
    return sqrt(e_u * e_u + e_v * e_v)


@minkowski_4r.quantity(
    units="1", symbol="configuration", source=f"{NUMERICS}#configurations", flags=CONFIGURATION_FLAGS
)
def configuration_status(
    half_root: Any, CB_orientation: Any, AB_orientation: Any, CB_ratio: Any, CB_scale: Any, AB_ratio: Any,
    CB_half: Any, alpha_r: Any, beta: Any, inside: Any, B_x: Any, A_x: Any, cosh_zeta: Any,
    loop_residual: Any, valid: Any,
) -> Any:  # fmt: skip
    """Whether the loop closes in this configuration, and why a quantity of it is not a finite number."""
    escaped = CB_orientation * AB_orientation == 0.0
    lightlike = (alpha_r == 0.0) | (beta == 0.0)
    pins_coincide = (alpha_r == 0.0) & (beta == 0.0) & (CB_half == 0.0)
    ratios = (CB_ratio == CB_ratio) & (AB_ratio == AB_ratio) & (loop_residual == loop_residual)
    small = (A_x == A_x) & (B_x == B_x) & (cosh_zeta == cosh_zeta) & ratios
    code = select(inside >= 0.0, 7.0, 0.0) + select(CB_ratio + CB_scale == 0.0, 8.0, 0.0)
    code = select(code == 15.0, 9.0, code)
    code = select(half_root == 0.0, 4.0, code)
    code = select(small, code, 5.0)
    code = select(escaped, select(pins_coincide, 3.0, select(lightlike, 2.0, 5.0)), code)
    code = select(half_root == half_root, code, 1.0)
    return select(valid == 1.0, code, 6.0)


# -- Facts of motion of the Minkowskian 4R: the rates of psi by theta

# With (u, v) the null coordinates of AB, (a p, a/p) and (b q, b/q) those of the cranks, and d their product
# b q v - b u/q, which is the root of the discriminant,
#
#     psi'  = a (p v - u/p)/d
#     psi'' = a b g {(p q v^2 - u^2/(p q)) (u - v) - h^2 (p/q - q/p) [a (p - 1/p) + b (q - 1/q)]}/d^3
#
# where each null coordinate is right to a few roundings of its own. With N = (AC)^2, S = sinh^2(theta/2), C
# = 1 + S, the limits S1 and S2 of S, P = S1 - S, Q = S2 - S and n = N + h^2 - b^2 the same is
#
#     psi'  = (a/N) [g sh(theta) n/d - (g ch(theta) - a)]
#     psi'' = 16 a^3 g^3 (n/N) [C P S2 + S Q (1 + S1)]/d^3
#             + (a g sh(theta)/N^2) [2 a g sh(theta) (h^2 - b^2)/d - (g^2 - a^2)]
#
# which keeps its digits where the linkage nearly folds (p, q, u/v near 1, d near 0) and loses them where N
# is near 0 and for great theta. The form with the smaller terms is used. Where psi follows theta, psi' is 1
# - g (u - v)/d.


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


# -- Flags of the Minkowskian 4R: why the coupler point or the rates are not finite numbers


CONFIGURATIONS = f"{NUMERICS}#configurations"
THERE = {0: "there", 1: "see_configuration_status", 2: "beyond_the_range_of_numbers"}


def with_reason(code: Any, configuration_status: Any) -> Any:
    """Return a code, 1 instead where the status of the configuration gives the reason."""
    lacking = (configuration_status > 0.0) & (configuration_status < 7.0)
    return select((code > 0.0) & lacking, 1.0, code)


def code_of_point(X_x: Any, X_y: Any, sextic_residual: Any) -> Any:
    """0 where the coupler point and its residual are finite, 2 where it is not, 3 where the residual alone is not."""
    missed = select(abs(sextic_residual) < INFINITY, 0.0, 3.0)
    return select((abs(X_x) < INFINITY) & (abs(X_y) < INFINITY), missed, 2.0)


def code_of_rates(dpsi_dtheta: Any, d2psi_dtheta2: Any) -> Any:
    """0 where both rates are finite, 2 where the first is not, 3 where the second alone is not."""
    return select(abs(dpsi_dtheta) < INFINITY, select(abs(d2psi_dtheta2) < INFINITY, 0.0, 3.0), 2.0)


def declare_flags(name: str, law: Callable[..., Any], what: str, third: str) -> None:
    """Declare the code of missing values, alone and after the reason that the configuration gives."""
    step = minkowski_4r.steps(units="1", source=CONFIGURATIONS)
    step(law, f"{name}_code", name)
    status = minkowski_4r.quantities(units="1", source=CONFIGURATIONS, flags=THERE | {3: third})
    meaning = f"Why {what} is not a finite number"
    status(with_reason, f"{name}_status", in_words(name), meaning, code=f"{name}_code")


declare_flags(
    "coupler_point", code_of_point, "the coupler point", "sextic_residual_beyond_the_range_of_numbers"
)
declare_flags("rates", code_of_rates, "a rate of psi", "second_rate_beyond_the_range_of_numbers")


# -- Facts of the Minkowskian 4R by the paper's own symbols: A, B, C of eq. (6), the Remark's form, the
#    coupler triangle

# A + B and A - B are 2 b times the null coordinates of AC, so that the Remark's root of A^2 - B^2 is 2 b
# |AC|: the limits and null coordinates of `position` keep its digits where its own terms cancel.


PRINTED = f"{NUMERICS}#the-papers-symbols"
EQUATION_6, REMARK = f"{HEGEDUS}, eq. (6)", f"{HEGEDUS}, eq. (7); {PRINTED}"
TRIANGLE = f"{HEGEDUS}, section 3.5; {PRINTED}"
REMARK_FLAGS = {
    0: "holds",
    1: "see_configuration_status",
    2: "A_not_above_the_size_of_B",
    3: "CB_past_pointing",
}
ANGLES_FLAGS = {0: "there", 1: "see_configuration_status", 2: "AX_lightlike", 3: "BX_lightlike"}

# -- eq. (6): A ch(psi) + B sh(psi) = C ------------------------------------------------------------------------------


@minkowski_4r.quantity(units="m2", symbol="A(theta)", source=EQUATION_6)
def coefficient_A(a: Any, b: Any, g: Any, cosh_theta: Any) -> Any:
    """Coefficient of ch(psi) in the constraint, 2 g b - 2 a b ch(theta)."""
    return 2.0 * b * (g - a * cosh_theta)


@minkowski_4r.quantity(units="m2", symbol="B(theta)", source=EQUATION_6)
def coefficient_B(a: Any, b: Any, sinh_theta: Any) -> Any:
    """Coefficient of sh(psi) in the constraint, 2 a b sh(theta)."""
    return 2.0 * b * (a * sinh_theta)


@minkowski_4r.quantity(units="m2", symbol="C(theta)", source=EQUATION_6)
def coefficient_C(a: Any, b: Any, g: Any, h: Any, S_r: Any, r: Any) -> Any:
    """Right-hand side of the constraint, h^2 - b^2 less the square of AC."""
    return ((h - b) * (h + b) - (g - a) * (g - a)) + 4.0 * a * g * (S_r / r)


# -- the Remark: psi = -delta ± arch(C/sqrt(A^2 - B^2)) -------------------------------------------------------------


@minkowski_4r.quantity(units="1", symbol="d", source=REMARK, internal=True)
def diagonal_root(alpha_r: Any, beta: Any, a_one: Any, r: Any) -> Any:
    """Scaled length of AC, sqrt(A^2 - B^2)/(2 b); NaN where A is at most abs(B)."""
    product = (sqrt(a_one * alpha_r) / sqrt(r)) * sqrt(a_one * beta)
    return select((alpha_r > 0.0) & (beta > 0.0), product, NOT_A_NUMBER)


@minkowski_4r.quantity(units="1", symbol="delta", source=REMARK)
def delta(s_a: Any, sinh_r: Any, r: Any, diagonal_root: Any, side: Any) -> Any:
    """Rapidity with th(delta) = B/A, that of the diagonal AC but for its sign; NaN where A is at most abs(B)."""
    return side * arsinh(s_a * sinh_r / r / diagonal_root)


@minkowski_4r.quantity(units="1", symbol="psi", source=REMARK)
def psi_remark(
    delta: Any,
    diagonal_root: Any,
    outside: Any,
    product_one: Any,
    r: Any,
    s_b: Any,
    s_h: Any,
    branch_sign: Any,
) -> Any:
    """Output angle by the Remark's closed form; NaN where it has none, though the loop may close."""
    # 4 b d sh^2(arch/2) = (h - b - d)(h + b + d) with d = |AC|, and (h - b - d)(h - b + d) = 4 a g Q.
    ratio = ((s_h + s_b) + diagonal_root) / ((s_h - s_b) + diagonal_root)
    half = sqrt(product_one * (outside / r) / s_b) * sqrt(0.5 * ratio / diagonal_root)
    return select((s_h > s_b) & (outside >= 0.0), branch_sign * (2.0 * arsinh(half)) - delta, NOT_A_NUMBER)


@minkowski_4r.quantity(units="1", symbol="remark", source=REMARK, internal=True)
def remark_code(psi_remark: Any, delta: Any) -> Any:
    """0 where the Remark's form holds, 2 where A is not above abs(B), 3 where it is, with roots past-pointing."""
    return select(psi_remark == psi_remark, 0.0, select(delta == delta, 3.0, 2.0))


_FLAG = minkowski_4r.quantities(units="1", source=REMARK, flags=REMARK_FLAGS)
_FLAG(
    with_reason,
    "remark_status",
    "remark",
    "Whether the Remark's closed form of psi holds",
    code="remark_code",
)

# -- the coupler triangle XAB ------------------------------------------------------------------------------------


def end_sum(x: Any, y: Any, h: Any) -> Any:
    """Return x - h + y, rounded once: BX may be nearly lightlike."""
    high, _low = sum_of_four(x, -h, y, 0.0)
    return high


def end_difference(x: Any, y: Any, h: Any) -> Any:
    """Return x - h - y, rounded once."""
    high, _low = sum_of_four(x, -h, -y, 0.0)
    return high


def modulus(u: Any, v: Any) -> Any:
    """Return the length of a vector by its null coordinates."""
    size = size_power(u, v)
    return size * sqrt(abs((u / size) * (v / size)))


def frame_rapidity(x: Any, y: Any, length: Any) -> Any:
    """Return the rapidity of a vector from the axis of its causal type; NaN of a lightlike one."""
    size = arsinh(select(abs(x) < abs(y), abs(x), abs(y)) / select(length > 0.0, length, NOT_A_NUMBER))
    return select((x < 0.0) == (y < 0.0), size, -size)


step, number = (
    declare(units="m", source=TRIANGLE) for declare in (minkowski_4r.steps, minkowski_4r.quantities)
)
step(difference, "BX_along", "x - h", "Coupler point along AB from B", x="x", y="h")
step(total, "AX_null_1", "x + y", "First null coordinate of AX against AB")
step(difference, "AX_null_2", "x - y", "Second null coordinate of AX against AB")
step(end_sum, "BX_null_1", "x - h + y", "First null coordinate of BX against AB")
step(end_difference, "BX_null_2", "x - h - y", "Second null coordinate of BX against AB")
number(
    modulus, "r_AX", "r", "Hyperbolic length of AX, whatever its causal type", u="AX_null_1", v="AX_null_2"
)
number(
    modulus, "s_BX", "s", "Hyperbolic length of BX, whatever its causal type", u="BX_null_1", v="BX_null_2"
)
step, number = (
    declare(units="1", source=TRIANGLE) for declare in (minkowski_4r.steps, minkowski_4r.quantities)
)
step(frame_rapidity, "AX_frame_rapidity", "AX", "Rapidity of AX against AB", x="x", y="y", length="r_AX")
step(
    frame_rapidity, "BX_frame_rapidity", "BX", "Rapidity of BX against AB", x="BX_along", y="y", length="s_BX"
)
_LIGHT = "NaN where it is lightlike"
number(total, "lambda_AX", "lambda", f"Rapidity of AX; {_LIGHT}", x="AB_rapidity", y="AX_frame_rapidity")
number(total, "mu_BX", "mu", f"Rapidity of BX; {_LIGHT}", x="AB_rapidity", y="BX_frame_rapidity")


def rate_where_there(x: Any, rate: Any) -> Any:
    """Derivative of a rapidity that differs from another one by a constant; NaN where it is none."""
    return select(x == x, rate, NOT_A_NUMBER)


derivative(rate_where_there, "lambda_AX", x="lambda_AX", rate="AB_rate")
derivative(rate_where_there, "mu_BX", x="mu_BX", rate="AB_rate")


@minkowski_4r.quantity(units="1", symbol="gamma", source=TRIANGLE)
def gamma(x: Any, y: Any, h: Any, BX_along: Any, r_AX: Any, s_BX: Any) -> Any:
    """Angle from AX to BX, mu - lambda; NaN where one of them is lightlike."""
    # r s ch(gamma) and r s sh(gamma), exchanged where one is spacelike and the other timelike
    product, moment = x * BX_along - y * y, h * y
    less = select(abs(product) < abs(moment), abs(product), abs(moment))
    there = (r_AX > 0.0) & (s_BX > 0.0)
    size = arsinh((less / select(there, r_AX, NOT_A_NUMBER)) / s_BX)
    return select((product < 0.0) == (moment < 0.0), size, -size)


@minkowski_4r.quantity(units="1", symbol="angles", source=TRIANGLE, internal=True)
def coupler_angles_code(r_AX: Any, s_BX: Any, AB_rapidity: Any) -> Any:
    """0 where AX and BX have rapidities, else the number of the reason."""
    light = select(r_AX == 0.0, 2.0, select(s_BX == 0.0, 3.0, 0.0))
    return select(AB_rapidity == AB_rapidity, light, 1.0)


_FLAG = minkowski_4r.quantities(units="1", source=TRIANGLE, flags=ANGLES_FLAGS)
_FLAG(
    with_reason, "coupler_angles_status", "angles", "Why lambda_AX or mu_BX is not a finite number",
    code="coupler_angles_code",
)  # fmt: skip
