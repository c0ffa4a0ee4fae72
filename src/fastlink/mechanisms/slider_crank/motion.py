"""Facts of one design of the slider-crank: scaled lengths, toggles, status.

The rod stands square to the line where u = r sin(theta) - e is l or -l: toggles, at which the branches meet. With
Z = (1 - sin(theta))/2 and C = (1 + sin(theta))/2

    l - u = 2 r (Z - Z0),    Z0 = (r - l - e)/(2 r)
    l + u = 2 r (C - C0),    C0 = (r - l + e)/(2 r)

which makes it a planar 4R whose pivot D is at infinity, across the line: see docs/numerics.md.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared import laws
from fastlink.mechanisms._shared.laws import difference, opposite, opposite_product, product, same
from fastlink.mechanisms.planar_4r import position as planar
from fastlink.mechanisms.planar_4r.classes import STATUS_FLAGS
from fastlink.mechanisms.planar_4r.rates import per_sigma
from fastlink.mechanisms.slider_crank.inputs import PAGE, slider_crank
from fastlink.numerics.compensated import UNIT_ROUNDING, gap_product_quotient, sum_of_four
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER, atan2, cos, select, sin, sqrt
from fastlink.numerics.vectors import zero_where

SCALING = f"{PAGE}#scaling"
TOGGLES = f"{PAGE}#toggles"
STATUS = f"{PAGE}#status-and-class"


@slider_crank.quantity(units="1", symbol="valid", source=STATUS, internal=True)
def valid(r: Any, l: Any, e: Any) -> Any:
    """1 where both lengths are positive and finite and the offset is finite, else NaN."""
    lengths_are = (r > 0.0) & (l > 0.0) & (r < INFINITY) & (l < INFINITY)
    return select(lengths_are & (abs(e) < INFINITY), 1.0, NOT_A_NUMBER)


@slider_crank.quantity(units="m", symbol="|e|", source=SCALING, internal=True)
def size_e(e: Any) -> Any:
    """Distance of O from the line of the slider."""
    return abs(e)


_LENGTHS = {"a1": "r", "a2": "l", "a3": "size_e", "a4": "size_e"}
step = slider_crank.steps(units="1", source=SCALING)
step(laws.lift, "lift", "lift", **_LENGTHS)
step(laws.unit, "unit", "unit", units="m", **_LENGTHS)
step(laws.scaled, "s_r", "s_r", "scaled length of the crank", length="r")
step(laws.scaled, "s_l", "s_l", "scaled length of the connecting rod", length="l")
step(laws.scaled, "s_e", "s_e", "scaled offset", length="e")


@slider_crank.quantity(units="1", symbol="u P", source=STATUS, internal=True)
def gap_rounding(s_r: Any, s_l: Any, s_e: Any) -> Any:
    """Effect of half a unit in the last place of each length on a sum of them: less is zero."""
    return UNIT_ROUNDING * (s_r + s_l + abs(s_e))


@slider_crank.quantity(units="1", symbol="l - r + e", source=TOGGLES, internal=True, low="less_up_low")
def less_up(s_r: Any, s_l: Any, s_e: Any) -> Any:
    """L - r + e, scaled, right to a rounding: positive where the crank passes theta = pi/2."""
    high, low = sum_of_four(s_l, -s_r, s_e, 0.0)
    return high, low


@slider_crank.quantity(units="1", symbol="l - r - e", source=TOGGLES, internal=True, low="less_down_low")
def less_down(s_r: Any, s_l: Any, s_e: Any) -> Any:
    """L - r - e, scaled, right to a rounding: positive where the crank passes theta = -pi/2."""
    high, low = sum_of_four(s_l, -s_r, -s_e, 0.0)
    return high, low


@slider_crank.quantity(units="1", symbol="l + r - e", source=TOGGLES, internal=True)
def reach_up(s_r: Any, s_l: Any, s_e: Any) -> Any:
    """L + r - e, scaled, right to a rounding; negative where the line is too high to be reached."""
    total, _low = sum_of_four(s_l, s_r, -s_e, 0.0)
    return total


@slider_crank.quantity(units="1", symbol="l + r + e", source=TOGGLES, internal=True)
def reach_down(s_r: Any, s_l: Any, s_e: Any) -> Any:
    """L + r + e, scaled, right to a rounding; negative where the line is too low to be reached."""
    total, _low = sum_of_four(s_l, s_r, s_e, 0.0)
    return total


def toggle(less: Any, less_low: Any, s_r: Any, gap_rounding: Any, valid: Any) -> Any:
    """Minus a gap over 2 r; negative if there is no toggle."""
    high, low = gap_product_quotient(-less, -less_low, 1.0, 0.0, 0.5, s_r)
    none = abs(less) <= gap_rounding
    return zero_where(none, high) * valid, zero_where(none, low)


step = slider_crank.steps(units="1", source=TOGGLES)
_at = "at the {} toggle, (r - l {} e)/(2 r); negative if none"
step(
    *(toggle, "Z0", "Z_0", f"(1 - sin(theta))/2 {_at.format('upper', '-')}"),
    low="Z0_low",
    less="less_up",
    less_low="less_up_low",
)
step(
    *(toggle, "C0", "C_0", f"(1 + sin(theta))/2 {_at.format('lower', '+')}"),
    low="C0_low",
    less="less_down",
    less_low="less_down_low",
)


@slider_crank.quantity(units="1", symbol="assembles", source=STATUS, internal=True)
def assembles(reach_up: Any, reach_down: Any, valid: Any) -> Any:
    """1 where the design assembles at some angle, else 0."""
    return select((reach_up < 0.0) | (reach_down < 0.0), 0.0, select(valid == 1.0, 1.0, 0.0))


@slider_crank.quantity(units="1", symbol="status", source=STATUS, flags=STATUS_FLAGS)
def status(
    less_up: Any, less_down: Any, reach_up: Any, reach_down: Any, gap_rounding: Any, assembles: Any, valid: Any
) -> Any:  # fmt: skip
    """How the design assembles over a full turn of the crank."""
    change_point = (abs(less_up) <= gap_rounding) | (abs(less_down) <= gap_rounding)
    turns = (less_up >= 0.0) & (less_down >= 0.0)
    rigid = (abs(reach_up) <= gap_rounding) | (abs(reach_down) <= gap_rounding)
    code = select(change_point, 3.0, select(turns, 0.0, 1.0))
    code = select(rigid, 5.0, code)
    code = select(assembles == 1.0, code, 2.0)
    return select(valid == 1.0, code, 4.0)


# -- Facts of position of the slider-crank: slider, rod, transmission angle, closure

# The cosine of the rod's angle is a root of l^2 - u^2 = 4 r^2 p q, of which p and q are differences from
# the toggles in twice the working precision: nothing cancels, however near a toggle or a change point.


POSITION = f"{PAGE}#position"


@slider_crank.table(symbol="cos theta", source=POSITION)
def cos_theta(theta: Any) -> Any:
    """Cosine of the crank angle."""
    return cos(theta)


@slider_crank.table(symbol="sin theta", source=POSITION)
def sin_theta(theta: Any) -> Any:
    """Sine of the crank angle."""
    return sin(theta)


@slider_crank.table(symbol="Z", source=POSITION, low="Z_low")
def Z(theta: Any) -> Any:
    """(1 - sin(theta))/2, as the square that does not cancel."""
    root = cos(theta / 2) - sin(theta / 2)
    return root * root / 2


@slider_crank.table(symbol="C", source=POSITION, low="C_low")
def C(theta: Any) -> Any:
    """(1 + sin(theta))/2, as the square that does not cancel."""
    root = cos(theta / 2) + sin(theta / 2)
    return root * root / 2


@slider_crank.quantity(units="1", symbol="s", source=POSITION, internal=True)
def branch_sign(branch: Any) -> Any:
    """1 for branch 1, -1 for branch 2."""
    return 3.0 - 2.0 * branch


step = slider_crank.steps(units="1", source=POSITION)
step(planar.p, "p", "p", "(l - u)/(2 r), u = r sin(theta) - e")
step(planar.q, "q", "q", "(l + u)/(2 r)")


@slider_crank.quantity(units="1", symbol="sigma", source=POSITION, internal=True)
def sigma(p: Any, q: Any) -> Any:
    """Length of the rod along the line over 2 r; NaN where the loop does not close."""
    # two roots: of a crank that is short enough the product overflows
    return sqrt(p) * sqrt(q)


point = slider_crank.quantities(units="m", source=POSITION)
point(product, "A_x", "A_x", "Crank pin A, x", x="r", y="cos_theta")
point(product, "A_y", "A_y", "Crank pin A, y", x="r", y="sin_theta")


@slider_crank.quantity(units="m", symbol="AB_x", source=POSITION, internal=True)
def AB_x(r: Any, sigma: Any, branch_sign: Any) -> Any:
    """Vector from A to B, x."""
    return branch_sign * (2.0 * (r * sigma))


step(difference, "AB_y", "AB_y", "Vector from A to B, y", x="e", y="A_y", units="m")


@slider_crank.quantity(units="1", symbol="AB_y/r", source=POSITION, internal=True)
def drop(s_e: Any, s_r: Any, sin_theta: Any) -> Any:
    """Vector from A to B, y, over the crank: p - q without its cancellation."""
    return s_e / s_r - sin_theta


@slider_crank.quantity(units="m", symbol="x", source=POSITION)
def slider_position(A_x: Any, AB_x: Any) -> Any:
    """Position of the slider B on its line, from the foot of O."""
    return A_x + AB_x


@slider_crank.quantity(units="rad", symbol="theta_2", source=POSITION)
def theta2(AB_x: Any, AB_y: Any) -> Any:
    """Direction of the connecting rod AB in the ground frame."""
    # + 0.0 turns -0.0 into 0.0, so that the straight angle is pi and never -pi.
    return atan2(AB_y + 0.0, AB_x)


@slider_crank.quantity(units="rad", symbol="mu", source=f"{PAGE}#transmission-angle")
def transmission_angle(p: Any, q: Any) -> Any:
    """Transmission angle: between the rod BA and the upward normal of the line of the slider."""
    return 2.0 * atan2(sqrt(p), sqrt(q))


@slider_crank.quantity(units="1", symbol="e", source=POSITION)
def loop_residual(
    A_x: Any, A_y: Any, AB_x: Any, AB_y: Any, slider_position: Any, s_r: Any, s_l: Any, s_e: Any, lift: Any,
    unit: Any,
) -> Any:  # fmt: skip
    """Closure error of the loop and of the length AB, relative to the longest of r, l and |e|."""
    x = AB_x * lift / unit
    y = AB_y * lift / unit
    rod_error = sqrt(x * x + y * y) - s_l
    error_x = (A_x + AB_x - slider_position) * lift / unit
    error_y = (A_y + AB_y) * lift / unit - s_e
    longest = select(s_r > s_l, s_r, s_l)
    longest = select(longest > abs(s_e), longest, abs(s_e))
    return sqrt(rod_error * rod_error + (error_x * error_x + error_y * error_y)) / longest


# -- Facts of velocity, acceleration and jerk of the slider-crank, at constant crank speed

# With H = cos(theta)/(2 sigma), ' = d/dtheta and s = 1 or -1 by branch
#
#     theta2' = -s H,    x' = s H AB_y - A_y,    x'' = s (H' AB_y - H A_x) - A_x,
#     x''' = s (H'' AB_y - 2 H' A_x + H A_y) + A_y,    H' = N/(2 sigma^3),
#     N = Z0 C q - C0 Z p = Z0 (1 - C0) sin(theta) - Z^2 e/r = C0 (1 - Z0) sin(theta) - C^2 e/r.
#
# Where neither crank nor rod turns fully the first form of N adds what has one sign. Else that of the last
# two with the smaller of Z0 and C0 vanishes, factor by factor, where N does: near a change point, and where
# crank and rod align in a slider-crank without offset. The divisors 1/sigma are multiplied one by one: of a
# crank that is short enough their product underflows.


RATES = f"{PAGE}#rates"

step = slider_crank.steps(units="1", source=RATES)
step(per_sigma, "per_sigma", "1/sigma")


@slider_crank.quantity(units="m-1", symbol="1/(2 r)", source=RATES, internal=True)
def per_2_r(r: Any) -> Any:
    """Reciprocal of twice the crank."""
    return 0.5 / r


@slider_crank.quantity(units="m-1", symbol="1/AB_x", source=RATES, internal=True)
def per_AB_x(per_2_r: Any, per_sigma: Any, branch_sign: Any) -> Any:
    """Reciprocal of the rod's component along the line."""
    return branch_sign * (per_2_r * per_sigma)


@slider_crank.quantity(units="1", symbol="cos(theta)/2", source=RATES, internal=True)
def half_cosine(cos_theta: Any) -> Any:
    """Derivative of C by the crank angle, and minus that of Z."""
    return 0.5 * cos_theta


@slider_crank.quantity(units="1", symbol="s H", source=RATES, internal=True)
def H(half_cosine: Any, per_sigma: Any, branch_sign: Any) -> Any:
    """Minus the angular velocity of the rod over that of the crank."""
    return branch_sign * (half_cosine * per_sigma)


@slider_crank.quantity(units="1", symbol="form", source=RATES, internal=True)
def bend_form(s_r: Any, s_l: Any, less_up: Any, less_down: Any) -> Any:
    """Which form of N does not cancel: 0 the first, 1 that of the upper toggle or fold, 2 that of the lower one."""
    first = (less_up * less_down < 0.0) | (4.0 * s_l < s_r)
    return select(first, 0.0, select(abs(less_up) <= abs(less_down), 1.0, 2.0))


@slider_crank.quantity(units="1", symbol="N_S", source=RATES, internal=True)
def bend_sine(bend_form: Any, Z0: Any, C0: Any, reach_up: Any, reach_down: Any, s_r: Any) -> Any:
    """Factor of sin(theta) in N."""
    upper = Z0 * (0.5 * reach_up / s_r)
    lower = C0 * (0.5 * reach_down / s_r)
    return select(bend_form == 0.0, 0.0, select(bend_form == 1.0, upper, lower))


@slider_crank.quantity(units="1", symbol="N_ZZ", source=RATES, internal=True)
def bend_ZZ(bend_form: Any, s_e: Any, s_r: Any) -> Any:
    """Factor of -Z^2 in N."""
    return select(bend_form == 1.0, s_e / s_r, 0.0)


@slider_crank.quantity(units="1", symbol="N_CC", source=RATES, internal=True)
def bend_CC(bend_form: Any, s_e: Any, s_r: Any) -> Any:
    """Factor of -C^2 in N."""
    return select(bend_form == 2.0, s_e / s_r, 0.0)


@slider_crank.quantity(units="1", symbol="N_Zp", source=RATES, internal=True)
def bend_Zp(bend_form: Any, C0: Any) -> Any:
    """Factor of -Z p in N."""
    return select(bend_form == 0.0, C0, 0.0)


@slider_crank.quantity(units="1", symbol="N_Cq", source=RATES, internal=True)
def bend_Cq(bend_form: Any, Z0: Any) -> Any:
    """Factor of -C q in N."""
    return select(bend_form == 0.0, -Z0, 0.0)


@slider_crank.quantity(units="1", symbol="N/sigma^2", source=RATES, internal=True)
def bend(
    bend_sine: Any, bend_ZZ: Any, bend_CC: Any, bend_Zp: Any, bend_Cq: Any, sin_theta: Any, Z: Any, C: Any,
    p: Any, q: Any, per_sigma: Any,
) -> Any:  # fmt: skip
    """Derivative of H by the crank angle times 2 sigma."""
    upper = Z * ((bend_ZZ * per_sigma) * Z + (bend_Zp * per_sigma) * p)
    lower = C * ((bend_CC * per_sigma) * C + (bend_Cq * per_sigma) * q)
    return ((bend_sine * per_sigma) * sin_theta - (upper + lower)) * per_sigma


@slider_crank.quantity(units="1", symbol="N'/(sigma^2 cos theta)", source=RATES, internal=True)
def bend_rate(
    bend_sine: Any, bend_ZZ: Any, bend_CC: Any, bend_Zp: Any, bend_Cq: Any, Z: Any, C: Any, p: Any, q: Any,
    per_sigma: Any,
) -> Any:  # fmt: skip
    """Derivative of N by the crank angle, over sigma^2 cos(theta)."""
    upper = (bend_ZZ * per_sigma) * Z + (0.5 * (bend_Zp * per_sigma)) * (p + Z)
    lower = (bend_CC * per_sigma) * C + (0.5 * (bend_Cq * per_sigma)) * (q + C)
    return ((bend_sine * per_sigma) + (upper - lower)) * per_sigma


@slider_crank.quantity(units="1", symbol="s H'", source=RATES, internal=True)
def H_slope(bend: Any, per_sigma: Any, branch_sign: Any) -> Any:
    """Derivative of H by the crank angle."""
    return branch_sign * (bend * (0.5 * per_sigma))


@slider_crank.quantity(units="1", symbol="s H''", source=RATES, internal=True)
def H_bend(half_cosine: Any, drop: Any, bend: Any, bend_rate: Any, per_sigma: Any, branch_sign: Any) -> Any:
    """Second derivative of H by the crank angle."""
    further = (0.75 * bend) * ((drop * per_sigma) * per_sigma)
    return branch_sign * ((bend_rate - further) * (half_cosine * per_sigma))


@slider_crank.quantity(units="m", symbol="x'", source=RATES, internal=True)
def x_slope(H: Any, AB_y: Any, A_y: Any) -> Any:
    """Derivative of the slider's position by the crank angle."""
    return H * AB_y - A_y


@slider_crank.quantity(units="m", symbol="AB_x''", source=RATES, internal=True)
def AB_x_bend(H: Any, H_slope: Any, AB_y: Any, A_x: Any) -> Any:
    """Second derivative of AB_x by the crank angle; that of AB_y is A_y."""
    return H_slope * AB_y - H * A_x


@slider_crank.quantity(units="m", symbol="x''", source=RATES, internal=True)
def x_bend(AB_x_bend: Any, A_x: Any) -> Any:
    """Second derivative of the slider's position by the crank angle."""
    return AB_x_bend - A_x


@slider_crank.quantity(units="m", symbol="x'''", source=RATES, internal=True)
def x_third(H: Any, H_slope: Any, H_bend: Any, AB_y: Any, A_x: Any, A_y: Any) -> Any:
    """Third derivative of the slider's position by the crank angle."""
    return (H_bend * AB_y - 2.0 * (H_slope * A_x)) + (H * A_y + A_y)


@slider_crank.quantity(units="rad2 s-2", symbol="omega^2", source=RATES, internal=True)
def omega_squared(omega: Any) -> Any:
    """Square of the crank's angular velocity."""
    return omega * omega


@slider_crank.quantity(units="rad3 s-3", symbol="omega^3", source=RATES, internal=True)
def omega_cubed(omega: Any) -> Any:
    """Cube of the crank's angular velocity."""
    return omega * omega * omega


rate = slider_crank.quantities(units="rad s-1", source=RATES)
along = "of the slider along its line"
rate(product, "slider_velocity", "v", f"Velocity {along}", x="omega", y="x_slope", units="m s-1")
rate(
    *(product, "slider_acceleration", "a", f"Acceleration {along}"),
    x="omega_squared",
    y="x_bend",
    units="m s-2",
)
rate(product, "slider_jerk", "jerk", f"Jerk {along}", x="omega_cubed", y="x_third", units="m s-3")
rate(opposite_product, "omega2", "omega_2", "Angular velocity of the connecting rod", x="omega", y="H")
rate(
    *(opposite_product, "alpha2", "alpha_2", "Angular acceleration of the connecting rod"),
    x="omega_squared",
    y="H_slope",
    units="rad s-2",
)
rate(
    *(opposite_product, "jerk2", "jerk_2", "Angular jerk of the connecting rod"),
    x="omega_cubed",
    y="H_bend",
    units="rad s-3",
)


# -- Derivatives by the crank angle in closed form

# Derivatives of all facts are generated; those here are declared because a generated one would subtract
# nearly equal numbers near toggles or change points, or cost more. They hold where the position is graded
# too.


def sigma_slope(half_cosine: Any, drop: Any, per_sigma: Any) -> Any:
    """Derivative of sqrt(p q)."""
    return 0.5 * (half_cosine * (drop * per_sigma))


def sigma_by_e(drop: Any, per_sigma: Any, r: Any) -> Any:
    """Derivative of sqrt(p q) by the offset."""
    return -0.25 * (drop * per_sigma) / r


def bend_by_e(drop: Any, s_e: Any, s_r: Any, sin_theta: Any, bend: Any, per_2_r: Any, per_sigma: Any) -> Any:
    """Derivative of N/sigma^2 by the offset."""
    of_N = (s_e / s_r) * sin_theta - 0.5 * (1.0 + sin_theta * sin_theta)
    return ((of_N + bend * drop) * per_sigma) * (per_2_r * per_sigma)


def bend_rate_by_e(drop: Any, bend_rate: Any, per_2_r: Any, per_sigma: Any) -> Any:
    """Derivative of N'/(sigma^2 cos(theta)) by the offset."""
    return ((1.0 + bend_rate) * (drop * per_sigma)) * (per_2_r * per_sigma)


def transmission_slope(half_cosine: Any, per_sigma: Any) -> Any:
    """Derivative of the transmission angle."""
    return -(half_cosine * per_sigma)


# w^2 = l^2 - AB_y^2 for the length w of the rod along the line, AB_x = s w, and cos(mu) = -AB_y/l


def rod_by_r(AB_y: Any, sin_theta: Any, per_AB_x: Any) -> Any:
    """Derivative of AB_x by the crank."""
    return (AB_y * per_AB_x) * sin_theta


def rod_by_l(l: Any, per_AB_x: Any) -> Any:
    """Derivative of AB_x by the rod."""
    return l * per_AB_x


def rod_by_e(AB_y: Any, per_AB_x: Any) -> Any:
    """Derivative of AB_x by the offset."""
    return -(AB_y * per_AB_x)


def transmission_by_r(sin_theta: Any, per_2_r: Any, per_sigma: Any) -> Any:
    """Derivative of the transmission angle by the crank."""
    return -(sin_theta * (per_2_r * per_sigma))


def transmission_by_l(AB_y: Any, l: Any, per_2_r: Any, per_sigma: Any) -> Any:
    """Derivative of the transmission angle by the rod."""
    return -((AB_y / l) * (per_2_r * per_sigma))


def transmission_by_e(per_2_r: Any, per_sigma: Any) -> Any:
    """Derivative of the transmission angle by the offset."""
    return per_2_r * per_sigma


for _set in (None, "graded"):
    derivative = slider_crank.derivatives("theta", variant=_set)
    derivative(opposite, "Z", x="half_cosine")
    derivative(same, "C", x="half_cosine")
    derivative(opposite, "p", x="half_cosine")
    derivative(same, "q", x="half_cosine")
    derivative(same, "sin_theta", x="cos_theta")
    derivative(opposite, "cos_theta", x="sin_theta")

derivative = slider_crank.derivatives("theta")
derivative(same, "H", x="H_slope")
derivative(same, "H_slope", x="H_bend")
derivative(opposite, "theta2", x="H")
derivative(same, "slider_position", x="x_slope")
derivative(same, "x_slope", x="x_bend")
derivative(same, "x_bend", x="x_third")
derivative(opposite, "AB_y", x="A_x")
derivative(opposite, "drop", x="cos_theta")
derivative(product, "slider_velocity", x="omega", y="x_bend")
derivative(product, "slider_acceleration", x="omega_squared", y="x_third")
derivative(opposite_product, "omega2", x="omega", y="H_slope")
derivative(opposite_product, "alpha2", x="omega_squared", y="H_bend")
derivative(product, "AB_x", x="H", y="AB_y")
derivative(sigma_slope, "sigma")
derivative(transmission_slope, "transmission_angle")

derivative = slider_crank.derivatives("r")
derivative(rod_by_r, "AB_x")
derivative(transmission_by_r, "transmission_angle")

derivative = slider_crank.derivatives("l")
derivative(rod_by_l, "AB_x")
derivative(transmission_by_l, "transmission_angle")

derivative = slider_crank.derivatives("e")
derivative(sigma_by_e, "sigma")
derivative(bend_by_e, "bend")
derivative(bend_rate_by_e, "bend_rate")
derivative(rod_by_e, "AB_x")
derivative(transmission_by_e, "transmission_angle")
