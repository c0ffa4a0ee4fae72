"""Facts of position of the planar 4R: the dyad AB, DB, coupler point, angles, closure.

With Z = sin^2(theta1/2), C = cos^2(theta1/2) every factor is a difference Z - Z0 or C - C0 from a toggle,
in twice the working precision: nothing cancels, however near the toggle or the change point.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms.planar_4r.inputs import HAYES, NUMERICS, planar_4r
from fastlink.numerics.elementary import atan2, cos, select, sin, sqrt
from fastlink.numerics.vectors import largest

POSITION = f"{NUMERICS}#position"
#: Below it the folded position of a change point is not distinguished from its neighbours.
LEAST_ANGLE = 2.0**-500


@planar_4r.table(symbol="cos theta_1", source=POSITION)
def cos_theta1(theta1: Any) -> Any:
    """Cosine of the input angle."""
    return cos(theta1)


@planar_4r.table(symbol="sin theta_1", source=POSITION)
def sin_theta1(theta1: Any) -> Any:
    """Sine of the input angle."""
    return sin(theta1)


@planar_4r.table(symbol="Z", source=POSITION, low="Z_low")
def Z(theta1: Any) -> Any:
    """Squared sine of half the input angle; 0 where it would be a number of few digits."""
    return select(abs(theta1) < LEAST_ANGLE, 0 * theta1, sin(theta1 / 2) * sin(theta1 / 2))


@planar_4r.table(symbol="C", source=POSITION, low="C_low")
def C(theta1: Any) -> Any:
    """Squared cosine of half the input angle."""
    return cos(theta1 / 2) * cos(theta1 / 2)


@planar_4r.quantity(units="1", symbol="s", source=POSITION, internal=True)
def branch_sign(branch: Any) -> Any:
    """-1 for branch 1, +1 for branch 2."""
    return 2.0 * branch - 3.0


@planar_4r.quantity(units="1", symbol="p", source=POSITION, internal=True)
def p(Z: Any, Z_low: Any, Z0: Any, Z0_low: Any) -> Any:
    """(|AD|^2 - (a2 - a3)^2)/(4 a1 a4)."""
    return (Z - Z0) + (Z_low - Z0_low)


@planar_4r.quantity(units="1", symbol="q", source=POSITION, internal=True)
def q(C: Any, C_low: Any, C0: Any, C0_low: Any) -> Any:
    """((a2 + a3)^2 - |AD|^2)/(4 a1 a4)."""
    return (C - C0) + (C_low - C0_low)


@planar_4r.quantity(units="1", symbol="sigma", source=POSITION, internal=True)
def sigma(p: Any, q: Any) -> Any:
    """Area of the triangle ABD over a1 a4; NaN where the loop does not close."""
    return sqrt(p * q)


@planar_4r.quantity(units="1", symbol="1/gamma", source=POSITION, internal=True)
def per_gamma(gamma0: Any, Z: Any) -> Any:
    """4 a1 a4/|AD|^2."""
    return 1.0 / (gamma0 + Z)


@planar_4r.quantity(units="m", symbol="AD_x", source=POSITION, internal=True)
def AD_x(a1: Any, a4: Any, Z: Any) -> Any:
    """Vector from A to D, x."""
    return (a4 - a1) + 2.0 * a1 * Z


@planar_4r.quantity(units="m", symbol="A_x", source=f"{HAYES}, Fig. 2")
def A_x(a1: Any, cos_theta1: Any) -> Any:
    """Moving pivot A, x."""
    return a1 * cos_theta1


@planar_4r.quantity(units="m", symbol="A_y", source=f"{HAYES}, Fig. 2")
def A_y(a1: Any, sin_theta1: Any) -> Any:
    """Moving pivot A, y."""
    return a1 * sin_theta1


@planar_4r.quantity(units="1", symbol="f_2", source=POSITION, internal=True)
def coupler_along(p: Any, coupler_offset: Any, per_gamma: Any) -> Any:
    """Foot of B on AD, from A, over |AD|."""
    return (0.5 * p + coupler_offset) * per_gamma


@planar_4r.quantity(units="1", symbol="f_3", source=POSITION, internal=True)
def output_along(p: Any, output_offset: Any, per_gamma: Any) -> Any:
    """Foot of B on AD, from D, over |AD|."""
    return (0.5 * p + output_offset) * per_gamma


@planar_4r.quantity(units="1", symbol="h", source=POSITION, internal=True)
def height(sigma: Any, per_gamma: Any) -> Any:
    """Distance of B from AD over |AD|."""
    return 0.5 * sigma * per_gamma


@planar_4r.quantity(units="m", symbol="AF_x", source=POSITION, internal=True)
def along_AB_x(coupler_along: Any, AD_x: Any) -> Any:
    """Foot of B on AD from A, x."""
    return coupler_along * AD_x


@planar_4r.quantity(units="m", symbol="AF_y", source=POSITION, internal=True)
def along_AB_y(coupler_along: Any, A_y: Any) -> Any:
    """Foot of B on AD from A, y."""
    return -(coupler_along * A_y)


@planar_4r.quantity(units="m", symbol="DF_x", source=POSITION, internal=True)
def along_DB_x(output_along: Any, AD_x: Any) -> Any:
    """Foot of B on AD from D, x."""
    return -(output_along * AD_x)


@planar_4r.quantity(units="m", symbol="DF_y", source=POSITION, internal=True)
def along_DB_y(output_along: Any, A_y: Any) -> Any:
    """Foot of B on AD from D, y."""
    return output_along * A_y


@planar_4r.quantity(units="m", symbol="FB_x", source=POSITION, internal=True)
def across_x(height: Any, A_y: Any) -> Any:
    """From the foot to B in branch 2, x."""
    return height * A_y


@planar_4r.quantity(units="m", symbol="FB_y", source=POSITION, internal=True)
def across_y(height: Any, AD_x: Any) -> Any:
    """From the foot to B in branch 2, y."""
    return height * AD_x


@planar_4r.quantity(units="m", symbol="AB_x", source=POSITION, internal=True)
def AB_x(along_AB_x: Any, across_x: Any, branch_sign: Any) -> Any:
    """Vector from A to B, x."""
    return along_AB_x + branch_sign * across_x


@planar_4r.quantity(units="m", symbol="AB_y", source=POSITION, internal=True)
def AB_y(along_AB_y: Any, across_y: Any, branch_sign: Any) -> Any:
    """Vector from A to B, y."""
    return along_AB_y + branch_sign * across_y


@planar_4r.quantity(units="m", symbol="DB_x", source=POSITION, internal=True)
def DB_x(along_DB_x: Any, across_x: Any, branch_sign: Any) -> Any:
    """Vector from D to B, x."""
    return along_DB_x + branch_sign * across_x


@planar_4r.quantity(units="m", symbol="DB_y", source=POSITION, internal=True)
def DB_y(along_DB_y: Any, across_y: Any, branch_sign: Any) -> Any:
    """Vector from D to B, y."""
    return along_DB_y + branch_sign * across_y


@planar_4r.quantity(units="m", symbol="F_x", source=POSITION, internal=True)
def foot_x(A_x: Any, along_AB_x: Any) -> Any:
    """Foot of B on AD, the same in both branches, x."""
    return A_x + along_AB_x


@planar_4r.quantity(units="m", symbol="F_y", source=POSITION, internal=True)
def foot_y(A_y: Any, along_AB_y: Any) -> Any:
    """Foot of B on AD, the same in both branches, y."""
    return A_y + along_AB_y


@planar_4r.quantity(units="m", symbol="B_x", source=f"{HAYES}, Fig. 2")
def B_x(foot_x: Any, across_x: Any, branch_sign: Any) -> Any:
    """Moving pivot B, x."""
    return foot_x + branch_sign * across_x


@planar_4r.quantity(units="m", symbol="B_y", source=f"{HAYES}, Fig. 2")
def B_y(foot_y: Any, across_y: Any, branch_sign: Any) -> Any:
    """Moving pivot B, y."""
    return foot_y + branch_sign * across_y


@planar_4r.quantity(units="1", symbol="P_u/a_2", source=POSITION, internal=True)
def P_along(P_u: Any, a2: Any) -> Any:
    """Coupler point along AB, over its length."""
    return P_u / a2


@planar_4r.quantity(units="1", symbol="P_v/a_2", source=POSITION, internal=True)
def P_across(P_v: Any, a2: Any) -> Any:
    """Coupler point across AB, over its length."""
    return P_v / a2


@planar_4r.quantity(units="m", symbol="AP_x", source=POSITION, internal=True)
def AP_x(AB_x: Any, AB_y: Any, P_along: Any, P_across: Any) -> Any:
    """Vector from A to the coupler point, x."""
    return P_along * AB_x - P_across * AB_y


@planar_4r.quantity(units="m", symbol="AP_y", source=POSITION, internal=True)
def AP_y(AB_x: Any, AB_y: Any, P_along: Any, P_across: Any) -> Any:
    """Vector from A to the coupler point, y."""
    return P_along * AB_y + P_across * AB_x


@planar_4r.quantity(units="m", symbol="P_x", source=f"{HAYES}, Fig. 2")
def P_x(A_x: Any, AP_x: Any) -> Any:
    """Coupler point P, x."""
    return A_x + AP_x


@planar_4r.quantity(units="m", symbol="P_y", source=f"{HAYES}, Fig. 2")
def P_y(A_y: Any, AP_y: Any) -> Any:
    """Coupler point P, y."""
    return A_y + AP_y


@planar_4r.quantity(units="rad", symbol="theta_2", source=f"{HAYES}, eq. (2)")
def theta2(AB_x: Any, AB_y: Any) -> Any:
    """Direction of the coupler AB in the ground frame."""
    # + 0.0 turns -0.0 into 0.0, so that the straight angle is pi and never -pi.
    return atan2(AB_y + 0.0, AB_x)


@planar_4r.quantity(units="rad", symbol="theta_4", source=f"{HAYES}, eq. (1)")
def theta4(DB_x: Any, DB_y: Any) -> Any:
    """Direction of the output link DB in the ground frame."""
    return atan2(DB_y + 0.0, DB_x)


@planar_4r.quantity(units="rad", symbol="mu", source=POSITION)
def transmission_angle(p: Any, q: Any) -> Any:
    """Transmission angle: between BA and BD."""
    return 2.0 * atan2(sqrt(p), sqrt(q))


@planar_4r.quantity(units="m", symbol="|AB|", source=POSITION, internal=True)
def coupler_length(AB_x: Any, AB_y: Any, lift: Any, unit: Any) -> Any:
    """Length of the computed coupler vector, scaled."""
    x = AB_x * lift / unit
    y = AB_y * lift / unit
    return sqrt(x * x + y * y)


@planar_4r.quantity(units="m", symbol="|DB|", source=POSITION, internal=True)
def output_length(DB_x: Any, DB_y: Any, lift: Any, unit: Any) -> Any:
    """Length of the computed output vector, scaled."""
    x = DB_x * lift / unit
    y = DB_y * lift / unit
    return sqrt(x * x + y * y)


@planar_4r.quantity(units="1", symbol="e_x", source=POSITION, internal=True)
def closure_x(
    s1: Any, s2: Any, s3: Any, s4: Any, cos_theta1: Any, AB_x: Any, DB_x: Any, a2: Any, a3: Any
) -> Any:
    """Closure error of the loop OABD, x, scaled."""
    return (s1 * cos_theta1 - s4) + (s2 * (AB_x / a2) - s3 * (DB_x / a3))


@planar_4r.quantity(units="1", symbol="e_y", source=POSITION, internal=True)
def closure_y(s1: Any, s2: Any, s3: Any, sin_theta1: Any, AB_y: Any, DB_y: Any, a2: Any, a3: Any) -> Any:
    """Closure error of the loop OABD, y, scaled."""
    return s1 * sin_theta1 + (s2 * (AB_y / a2) - s3 * (DB_y / a3))


@planar_4r.quantity(units="1", symbol="e", source=POSITION)
def loop_residual(
    closure_x: Any,
    closure_y: Any,
    coupler_length: Any,
    output_length: Any,
    s1: Any,
    s2: Any,
    s3: Any,
    s4: Any,
) -> Any:
    """Closure error of the loop and of the lengths AB and DB, relative to the longest link."""
    coupler_error = coupler_length - s2
    output_error = output_length - s3
    opening = closure_x * closure_x + closure_y * closure_y
    total = opening + (coupler_error * coupler_error + output_error * output_error)
    return sqrt(total) / largest(s1, s2, s3, s4)
