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

from fastlink.mechanisms._shared.laws import half, product
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


def quarter(x: Any) -> Any:
    """Return x/4."""
    return 0.25 * x


step = planar_4r.steps(units="1", source=RATES)
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
