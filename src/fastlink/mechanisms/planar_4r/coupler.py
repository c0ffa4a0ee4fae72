"""Facts of the coupler curve of the planar 4R: velocity and acceleration of P, speed, curvature.

With n = omega2/omega1, ' = d/dtheta1, J the quarter turn to the left and w = AP

    P' = J (A + n w),    P'' = -A - n^2 w + n' J w,
    P' x P'' = (A + n w).(A + n^2 w) + n' (A x w).

The last line leaves out n n' (J w) x (J w), which is zero and, near a toggle, the largest term of all.
n and n' are the laws of `rates` for a crank that turns at 1 rad/s, so that the curvature, a
property of the curve alone, needs no input speed.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms.planar_4r import rates
from fastlink.mechanisms.planar_4r.inputs import HAYES, NUMERICS, planar_4r
from fastlink.numerics.elementary import sqrt
from fastlink.numerics.vectors import cross

RATES = f"{NUMERICS}#rates"
COUPLER = f"{NUMERICS}#coupler"
AT_P = f"{HAYES}, Fig. 2, differentiated; {COUPLER}"


@planar_4r.quantity(units="1", symbol="T/2", source=RATES, internal=True)
def mean_ratio(crank_excess: Any, Z: Any, per_gamma: Any) -> Any:
    """Mean of the transmission ratios over both branches."""
    return 0.5 * ((crank_excess + Z) * per_gamma)


@planar_4r.quantity(units="1", symbol="H/2", source=RATES, internal=True)
def half_H(H: Any) -> Any:
    """Half of H."""
    return 0.5 * H


@planar_4r.quantity(units="1", symbol="gamma'/(2 gamma)", source=RATES, internal=True)
def half_log_rate(log_rate: Any) -> Any:
    """Half the logarithmic derivative of gamma."""
    return 0.5 * log_rate


@planar_4r.quantity(units="1", symbol="C_0/4", source=RATES, internal=True)
def quarter_C0(C0: Any) -> Any:
    """A quarter of C0."""
    return 0.25 * C0


@planar_4r.quantity(units="1", symbol="Z_0/4", source=RATES, internal=True)
def quarter_Z0(Z0: Any) -> Any:
    """A quarter of Z0."""
    return 0.25 * Z0


step = planar_4r.steps(units="1", source=RATES)
step(rates.omega2, "coupler_ratio", "n", "omega2/omega1", mean_rate="mean_ratio", odd_rate="half_H")
step(
    rates.mean_acceleration,
    "mean_slope",
    "T'/2",
    "derivative of the mean of the ratios",
    gamma_rate="half_log_rate",
)
step(
    rates.H_rate,
    "H_slope",
    "H'/2",
    "half the derivative of H",
    C0_squared_rate="quarter_C0",
    Z0_squared_rate="quarter_Z0",
)
step(
    rates.kappa_rate,
    "kappa_slope",
    "H kappa gamma'/(2 gamma^2)",
    "half of H times the derivative of -kappa/gamma",
    gamma_rate="half_log_rate",
)
step(
    rates.alpha2,
    "coupler_slope",
    "n'",
    "derivative of omega2/omega1 by the input angle",
    mean_acceleration="mean_slope",
    H_rate="H_slope",
    kappa_rate="kappa_slope",
)


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


@planar_4r.quantity(units="m s-1", symbol="v_Px", source=AT_P)
def P_vx(omega1: Any, P_dx: Any) -> Any:
    """Velocity of the coupler point, x."""
    return omega1 * P_dx


@planar_4r.quantity(units="m s-1", symbol="v_Py", source=AT_P)
def P_vy(omega1: Any, P_dy: Any) -> Any:
    """Velocity of the coupler point, y."""
    return omega1 * P_dy


@planar_4r.quantity(units="m s-2", symbol="a_Px", source=AT_P)
def P_ax(omega1_squared: Any, P_ddx: Any) -> Any:
    """Acceleration of the coupler point, x."""
    return omega1_squared * P_ddx


@planar_4r.quantity(units="m s-2", symbol="a_Py", source=AT_P)
def P_ay(omega1_squared: Any, P_ddy: Any) -> Any:
    """Acceleration of the coupler point, y."""
    return omega1_squared * P_ddy


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
    A_x: Any,
    A_y: Any,
    AP_x: Any,
    AP_y: Any,
    P_dx: Any,
    P_dy: Any,
    coupler_ratio_squared: Any,
    coupler_slope: Any,
    per_unit: Any,
) -> Any:
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
