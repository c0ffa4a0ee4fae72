"""Facts of velocity, acceleration and jerk of the slider-crank, at constant crank speed.

With H = cos(theta)/(2 sigma), ' = d/dtheta and s = 1 or -1 by branch

    theta2' = -s H,    x' = s H AB_y - A_y,    x'' = s (H' AB_y - H A_x) - A_x,
    x''' = s (H'' AB_y - 2 H' A_x + H A_y) + A_y,    H' = N/(2 sigma^3),
    N = Z0 C q - C0 Z p = Z0 (1 - C0) sin(theta) - Z^2 e/r = C0 (1 - Z0) sin(theta) - C^2 e/r.

Where neither crank nor rod turns fully the first form of N adds what has one sign. Else that of the last two with the
smaller of Z0 and C0 vanishes, factor by factor, where N does: near a change point, and where crank and rod align in a
slider-crank without offset. The divisors 1/sigma are multiplied one by one: of a crank that is short enough their
product underflows.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import opposite_product, product
from fastlink.mechanisms.planar_4r.rates import per_sigma
from fastlink.mechanisms.slider_crank.inputs import PAGE, slider_crank
from fastlink.numerics.elementary import select

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
