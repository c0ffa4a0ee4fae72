"""Facts of velocity and acceleration of the planar 4R, at constant input speed.

With gamma = |AD|^2/(4 a1 a4), sigma = sqrt(p q) and ' = d/dtheta1 the transmission ratios are

    omega4/omega1 = [1 + epsilon/gamma + s H (1 + kappa/gamma)]/2
    omega2/omega1 = [1 + epsilon/gamma - s H (1 - kappa/gamma)]/2,    H = sin(theta1)/(2 sigma),

the solution of eq. (7) without the half-angle of the output, and free of cancellation except at its own
zeros. 1 + kappa/gamma and 1 - kappa/gamma are twice the feet of B on AD, from A and from D, over |AD|: sums with p that
keep their digits where two short links stand on two long ones. H' needs no difference of large terms either:
H' = (C0 Z p - Z0 C q)/(2 sigma^3).
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import half, opposite, opposite_product, product, same, twice
from fastlink.mechanisms.planar_4r import (
    position,  # noqa: F401 (whose derivatives these are)
    rates,
)
from fastlink.mechanisms.planar_4r.inputs import HAYES, NUMERICS, planar_4r
from fastlink.numerics.elementary import INFINITY, select, sqrt
from fastlink.numerics.vectors import cross

RATES = f"{NUMERICS}#rates"


@planar_4r.quantity(units="1", symbol="1/sigma", source=RATES, internal=True)
def per_sigma(sigma: Any) -> Any:
    """Reciprocal of sigma; infinite at a toggle."""
    return 1.0 / sigma


step = planar_4r.steps(units="1", source=RATES)
step(half, "half_sine", "sin(theta_1)/2", "Derivative of gamma by the input angle", x="sin_theta1")
step(product, "H", "H", "Part of the ratios that changes sign with the branch", x="half_sine", y="per_sigma")
step(product, "kappa_per_gamma", "kappa/gamma", "(a2^2 - a3^2)/|AD|^2", x="kappa", y="per_gamma")
step = planar_4r.steps(units="rad s-1", source=RATES)
step(half, "half_omega1", "omega_1/2", "Half the input speed", x="omega1")
step(product, "odd_rate", "omega_1 H/2", "H times half the input speed", x="half_omega1", y="H")


@planar_4r.quantity(units="rad2 s-2", symbol="omega_1^2/2", source=RATES, internal=True)
def half_omega1_squared(omega1: Any) -> Any:
    """Half the squared input speed."""
    return 0.5 * (omega1 * omega1)


@planar_4r.quantity(units="rad s-1", symbol="omega_1 T/2", source=RATES, internal=True)
def mean_rate(half_omega1: Any, crank_excess: Any, Z: Any, per_gamma: Any) -> Any:
    """Mean of the angular velocity over both branches."""
    return half_omega1 * ((crank_excess + Z) * per_gamma)


def link_rate(mean_rate: Any, odd_rate: Any, share: Any, branch_sign: Any) -> Any:
    """Angular velocity of a link, or its ratio to that of the crank."""
    return mean_rate + branch_sign * (odd_rate * share)


rate = planar_4r.quantities(units="rad s-1", source=f"{HAYES}, eq. (7)")
rate(link_rate, "omega4", "omega_4", "Angular velocity of the output link", share="output_share")
rate = planar_4r.quantities(units="rad s-1", source=f"{HAYES}, eq. (7) for the pair 1-2")
rate(link_rate, "omega2", "omega_2", "Angular velocity of the coupler", share="coupler_share")


@planar_4r.quantity(units="rad2 s-2", symbol="omega_1^2 gamma'/(2 gamma)", source=RATES, internal=True)
def gamma_rate(half_omega1_squared: Any, half_sine: Any, per_gamma: Any) -> Any:
    """Logarithmic derivative of gamma times half the squared input speed."""
    return (half_omega1_squared * half_sine) * per_gamma


@planar_4r.quantity(units="rad s-2", symbol="omega_1^2 T'/2", source=RATES, internal=True)
def mean_acceleration(epsilon: Any, gamma_rate: Any, per_gamma: Any) -> Any:
    """Mean of the angular acceleration over both branches."""
    return -((epsilon * gamma_rate) * per_gamma)


def squared_rate(limit: Any, half_omega1_squared: Any) -> Any:
    """Return a squared sine or cosine times a quarter of the squared input speed."""
    return 0.5 * half_omega1_squared * limit


step = planar_4r.steps(units="rad2 s-2", source=RATES)
_TIMES = "times a quarter of the squared input speed"
step(squared_rate, "C0_squared_rate", "omega_1^2 C_0/4", f"C0 {_TIMES}", limit="C0")
step(squared_rate, "Z0_squared_rate", "omega_1^2 Z_0/4", f"Z0 {_TIMES}", limit="Z0")


@planar_4r.quantity(units="rad s-2", symbol="omega_1^2 H'/2", source=RATES, internal=True)
def H_rate(C0_squared_rate: Any, Z0_squared_rate: Any, Z: Any, C: Any, p: Any, q: Any, per_sigma: Any) -> Any:
    """Derivative of H times half the squared input speed."""
    return (C0_squared_rate * Z * p - Z0_squared_rate * C * q) * (per_sigma * per_sigma * per_sigma)


@planar_4r.quantity(
    units="rad s-2", symbol="omega_1^2 H kappa gamma'/(2 gamma^2)", source=RATES, internal=True
)
def kappa_rate(H: Any, kappa_per_gamma: Any, gamma_rate: Any) -> Any:
    """H times the derivative of -kappa/gamma times half the squared input speed."""
    return (H * kappa_per_gamma) * gamma_rate


def link_acceleration(
    mean_acceleration: Any, H_rate: Any, share: Any, kappa_rate: Any, branch_sign: Any
) -> Any:
    """Angular acceleration of a link, or the derivative of its ratio."""
    return mean_acceleration + branch_sign * (H_rate * share - kappa_rate)


rate = planar_4r.quantities(units="rad s-2", source=f"{HAYES}, eq. (8)")
rate(link_acceleration, "alpha4", "alpha_4", "Angular acceleration of the output link", share="output_share")
rate = planar_4r.quantities(units="rad s-2", source=f"{HAYES}, eq. (8) for the pair 1-2")
rate(link_acceleration, "alpha2", "alpha_2", "Angular acceleration of the coupler", share="coupler_share")


@planar_4r.quantity(units="1", symbol="gamma'/gamma", source=RATES, internal=True)
def log_rate(half_sine: Any, per_gamma: Any) -> Any:
    """Logarithmic derivative of gamma."""
    return half_sine * per_gamma


@planar_4r.quantity(units="1", symbol="-(1/gamma)'' gamma", source=RATES, internal=True)
def gamma_bend(cos_theta1: Any, half_sine: Any, log_rate: Any, per_gamma: Any) -> Any:
    """Second derivative of -1/gamma, times gamma."""
    return (0.5 * cos_theta1 - 2.0 * (half_sine * log_rate)) * per_gamma


@planar_4r.quantity(units="1", symbol="T''/2", source=RATES, internal=True)
def mean_bend(epsilon: Any, per_gamma: Any, gamma_bend: Any) -> Any:
    """Second derivative of the mean of the ratios."""
    return -(0.5 * ((epsilon * per_gamma) * gamma_bend))


@planar_4r.quantity(units="1", symbol="H''/2", source=RATES, internal=True)
def H_bend(half_sine: Any, C0: Any, Z0: Any, Z: Any, C: Any, p: Any, q: Any, per_sigma: Any) -> Any:
    """Half the second derivative of H."""
    slope = C0 * (p + Z) + Z0 * (q + C)
    factor = C0 * Z * p - Z0 * C * q
    bend = slope - (1.5 * (q - p)) * (factor * (per_sigma * per_sigma))
    return (0.25 * half_sine) * (bend * (per_sigma * per_sigma * per_sigma))


@planar_4r.quantity(units="1", symbol="-(2 H' k' + H k'')/2", source=RATES, internal=True)
def kappa_bend(H: Any, H_slope: Any, kappa_per_gamma: Any, log_rate: Any, gamma_bend: Any) -> Any:
    """Part of the second derivative of kappa/gamma in that of the ratios."""
    return kappa_per_gamma * (2.0 * (H_slope * log_rate) + 0.5 * (H * gamma_bend))


def bend(mean_bend: Any, H_bend: Any, share: Any, kappa_bend: Any, branch_sign: Any) -> Any:
    """Second derivative of a ratio."""
    return mean_bend + branch_sign * (H_bend * share - kappa_bend)


step = planar_4r.steps(units="1", source=RATES)
_OUTPUT, _COUPLER = (
    f"second derivative of {omega}/omega1 by the input angle" for omega in ("omega4", "omega2")
)
step(bend, "output_bend", "n_4''", _OUTPUT, share="output_share")
step(bend, "coupler_bend", "n''", _COUPLER, share="coupler_share")


@planar_4r.quantity(units="rad3 s-3", symbol="omega_1^3", source=RATES, internal=True)
def omega1_cubed(omega1_squared: Any, omega1: Any) -> Any:
    """Cube of the input speed."""
    return omega1_squared * omega1


jerk = planar_4r.quantities(units="rad s-3", source=f"{HAYES}, eq. (8), differentiated")
jerk(product, "jerk4", "jerk_4", "Angular jerk of the output link", x="omega1_cubed", y="output_bend")
jerk = planar_4r.quantities(units="rad s-3", source=f"{HAYES}, eq. (8) for the pair 1-2, differentiated")
jerk(product, "jerk2", "jerk_2", "Angular jerk of the coupler", x="omega1_cubed", y="coupler_bend")


# -- Facts of the coupler curve of the planar 4R: velocity and acceleration of P, speed, curvature

# With n = omega2/omega1, ' = d/dtheta1, J the quarter turn to the left and w = AP
#
#     P' = J (A + n w),    P'' = -A - n^2 w + n' J w,
#     P' x P'' = (A + n w).(A + n^2 w) + n' (A x w).
#
# The last line leaves out n n' (J w) x (J w), which is zero and, near a toggle, the largest term of all. n
# and n' are the laws of `rates` for a crank that turns at 1 rad/s, so that the curvature, a property of the
# curve alone, needs no input speed.


COUPLER = f"{NUMERICS}#coupler"
AT_P = f"{HAYES}, Fig. 2, differentiated; {COUPLER}"


@planar_4r.quantity(units="1", symbol="T/2", source=RATES, internal=True)
def mean_ratio(crank_excess: Any, Z: Any, per_gamma: Any) -> Any:
    """Mean of the transmission ratios over both branches."""
    return 0.5 * ((crank_excess + Z) * per_gamma)


def quarter(x: Any) -> Any:
    """Return x/4."""
    return 0.25 * x


step(half, "half_H", "H/2", "Half of H", x="H")
step(half, "half_log_rate", "gamma'/(2 gamma)", "Half the logarithmic derivative of gamma", x="log_rate")
step(quarter, "quarter_C0", "C_0/4", "A quarter of C0", x="C0")
step(quarter, "quarter_Z0", "Z_0/4", "A quarter of Z0", x="Z0")

RATIO = {"mean_rate": "mean_ratio", "odd_rate": "half_H"}
SLOPE = {"mean_acceleration": "mean_slope", "H_rate": "H_slope", "kappa_rate": "kappa_slope"}
_MEAN, _KAPPA = "derivative of the mean of the ratios", "half of H times the derivative of -kappa/gamma"
_SLOPE = "derivative of omega2/omega1 by the input angle"
_QUARTERS = {"C0_squared_rate": "quarter_C0", "Z0_squared_rate": "quarter_Z0"}
step(rates.link_rate, "coupler_ratio", "n", "omega2/omega1", share="coupler_share", **RATIO)
step(rates.mean_acceleration, "mean_slope", "T'/2", _MEAN, gamma_rate="half_log_rate")
step(rates.H_rate, "H_slope", "H'/2", "half the derivative of H", **_QUARTERS)
step(rates.kappa_rate, "kappa_slope", "H kappa gamma'/(2 gamma^2)", _KAPPA, gamma_rate="half_log_rate")
step(rates.link_acceleration, "coupler_slope", "n'", _SLOPE, share="coupler_share", **SLOPE)


@planar_4r.quantity(units="m", symbol="P_x'", source=COUPLER, internal=True)
def P_dx(A_y: Any, coupler_ratio: Any, AP_y: Any) -> Any:
    """Derivative of the coupler point by the input angle, x."""
    return -A_y - coupler_ratio * AP_y


@planar_4r.quantity(units="m", symbol="P_y'", source=COUPLER, internal=True)
def P_dy(A_x: Any, coupler_ratio: Any, AP_x: Any) -> Any:
    """Derivative of the coupler point by the input angle, y."""
    return A_x + coupler_ratio * AP_x


@planar_4r.quantity(units="1", symbol="n^2", source=COUPLER, internal=True)
def coupler_ratio_squared(coupler_ratio: Any) -> Any:
    """Squared ratio of coupler speed and input speed."""
    return coupler_ratio * coupler_ratio


@planar_4r.quantity(units="m", symbol="P_x''", source=COUPLER, internal=True)
def P_ddx(A_x: Any, coupler_ratio_squared: Any, coupler_slope: Any, AP_x: Any, AP_y: Any) -> Any:
    """Second derivative of the coupler point by the input angle, x."""
    return -A_x - (coupler_ratio_squared * AP_x + coupler_slope * AP_y)


@planar_4r.quantity(units="m", symbol="P_y''", source=COUPLER, internal=True)
def P_ddy(A_y: Any, coupler_ratio_squared: Any, coupler_slope: Any, AP_x: Any, AP_y: Any) -> Any:
    """Second derivative of the coupler point by the input angle, y."""
    return (coupler_slope * AP_x - coupler_ratio_squared * AP_y) - A_y


velocity = planar_4r.quantities(units="m s-1", source=AT_P)
velocity.vector(product, "P_v*", "v_P*", "Velocity of the coupler point", x="omega1", y="P_d*")
second = planar_4r.quantities(units="m s-2", source=AT_P)
second.vector(product, "P_a*", "a_P*", "Acceleration of the coupler point", x="omega1_squared", y="P_dd*")


@planar_4r.quantity(units="1", symbol="|P'|", source=COUPLER, internal=True)
def curve_rate(P_dx: Any, P_dy: Any, per_unit: Any) -> Any:
    """Length of the derivative of the coupler point by the input angle, scaled."""
    x = P_dx * per_unit
    y = P_dy * per_unit
    return sqrt(x * x + y * y)


@planar_4r.quantity(units="m s-1", symbol="v_P", source=AT_P)
def P_speed(omega1: Any, curve_rate: Any, per_unit: Any) -> Any:
    """Speed of the coupler point."""
    return abs(omega1) * (curve_rate / per_unit)


@planar_4r.quantity(units="1", symbol="P' x P''", source=COUPLER, internal=True)
def curve_turn(
    A_x: Any, A_y: Any, AP_x: Any, AP_y: Any, P_dx: Any, P_dy: Any, coupler_ratio_squared: Any,
    coupler_slope: Any, per_unit: Any,
) -> Any:  # fmt: skip
    """Cross product of the first two derivatives of the coupler point, scaled."""
    a_x = A_x * per_unit
    a_y = A_y * per_unit
    w_x = AP_x * per_unit
    w_y = AP_y * per_unit
    inward_x = a_x + coupler_ratio_squared * w_x
    inward_y = a_y + coupler_ratio_squared * w_y
    turn = cross(inward_x, inward_y, P_dx * per_unit, P_dy * per_unit)
    return turn + coupler_slope * cross(a_x, a_y, w_x, w_y)


@planar_4r.quantity(units="m-1", symbol="1/rho_P", source=AT_P)
def curvature(curve_turn: Any, curve_rate: Any, per_unit: Any) -> Any:
    """Curvature of the coupler curve, positive where it turns left as theta1 grows."""
    return (curve_turn / (curve_rate * curve_rate * curve_rate)) * per_unit


# -- Derivatives by the input angle in closed form

# Derivatives of all facts are generated (`fastlink.facts.derivative`); those here are declared because a
# generated one would subtract nearly equal numbers near toggles or change points, or cost more. With n2 =
# omega2/omega1, n4 = omega4/omega1 and ' = d/dtheta1
#
#     AB' = J n2 AB,   DB' = J n4 DB,   theta2' = n2,   n2' = coupler_slope,   n2'' = coupler_bend,
#
# and alike for n4. They hold at constant omega1 and where the position is graded too.


_SLOPE_4 = "derivative of omega4/omega1 by the input angle"
step(rates.link_rate, "output_ratio", "n_4", "omega4/omega1", share="output_share", **RATIO)
step(rates.link_acceleration, "output_slope", "n_4'", _SLOPE_4, share="output_share", **SLOPE)


@planar_4r.quantity(units="1", symbol="n - 1", source=RATES, internal=True)
def joint_ratio_2(
    half_H: Any, coupler_share: Any, ground_excess: Any, Z: Any, per_gamma: Any, branch_sign: Any
) -> Any:
    """Rate of the second joint angle over omega1."""
    return branch_sign * (half_H * coupler_share) - 0.5 * ((ground_excess + Z) * per_gamma)


step(product, "joint_ratio_3", "n_4 - n", "Rate of the third joint angle over omega1", x="branch_sign", y="H")
step(opposite, "joint_ratio_4", "-n_4", "Rate of the fourth joint angle over omega1", x="output_ratio")


# -- declared derivatives ------------------------------------------------------------------------------


def half_tangent(v: Any, ratio: Any) -> Any:
    """Derivative of the tangent of half an angle."""
    return (0.5 + 0.5 * (v * v)) * ratio


def sigma_slope(half_sine: Any, p: Any, q: Any, per_sigma: Any) -> Any:
    """Derivative of sqrt(p q)."""
    return 0.5 * (half_sine * (q - p)) * per_sigma


def half_tangent_1(Z: Any) -> Any:
    """Derivative of -cot(theta1/2)."""
    return select(Z == 0.0, INFINITY, 0.5 / Z)


# of tables, and of the facts that replace them in the graded range
for _set in (None, "graded"):
    derivative = planar_4r.derivatives("theta1", variant=_set)
    derivative(same, "Z", x="half_sine")
    derivative(opposite, "C", x="half_sine")
    derivative(same, "p", x="half_sine")
    derivative(opposite, "q", x="half_sine")
    derivative(same, "sin_theta1", x="cos_theta1")
    derivative(opposite, "cos_theta1", x="sin_theta1")

derivative = planar_4r.derivatives("theta1")
derivative(same, "transmission_angle", x="H")
derivative(same, "half_H", x="H_slope")
derivative(same, "H_slope", x="H_bend")
derivative(same, "mean_ratio", x="mean_slope")
derivative(same, "mean_slope", x="mean_bend")
derivative(same, "theta2", x="coupler_ratio")
derivative(same, "coupler_ratio", x="coupler_slope")
derivative(same, "coupler_slope", x="coupler_bend")
derivative(same, "theta4", x="output_ratio")
derivative(same, "output_ratio", x="output_slope")
derivative(same, "output_slope", x="output_bend")
derivative(same, "joint_angle_2", x="joint_ratio_2")
derivative(same, "joint_angle_3", x="joint_ratio_3")
derivative(same, "joint_angle_4", x="joint_ratio_4")
derivative(product, "omega2", x="omega1", y="coupler_slope")
derivative(product, "omega4", x="omega1", y="output_slope")
derivative(product, "joint_omega_2", x="omega1", y="coupler_slope")
derivative(product, "alpha2", x="omega1_squared", y="coupler_bend")
derivative(product, "alpha4", x="omega1_squared", y="output_bend")
derivative(product, "H_rate", x="omega1_squared", y="H_bend")
derivative(same, "joint_ratio_2", x="coupler_slope")
derivative(product, "AB_y", x="coupler_ratio", y="AB_x")
derivative(product, "DB_y", x="output_ratio", y="DB_x")
derivative(product, "B_y", x="output_ratio", y="DB_x")
derivative(product, "AB_v", x="joint_ratio_2", y="AB_u")
derivative(opposite_product, "AB_x", x="coupler_ratio", y="AB_y")
derivative(opposite_product, "DB_x", x="output_ratio", y="DB_y")
derivative(opposite_product, "B_x", x="output_ratio", y="DB_y")
derivative(opposite_product, "AB_u", x="joint_ratio_2", y="AB_v")
derivative(half_tangent_1, "v1")
derivative(half_tangent, "v2", v="v2", ratio="joint_ratio_2")
derivative(half_tangent, "v3", v="v3", ratio="joint_ratio_3")
derivative(half_tangent, "v4", v="v4", ratio="joint_ratio_4")
derivative(twice, "H", x="H_slope")
derivative(sigma_slope, "sigma")
