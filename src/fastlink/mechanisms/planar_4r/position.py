"""Facts of position of the planar 4R: the dyad AB, DB, coupler point, angles, closure.

With Z = sin^2(theta1/2), C = cos^2(theta1/2) every factor is a difference Z - Z0 or C - C0 from a toggle,
in twice the working precision: nothing cancels, however near the toggle or the change point.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import (
    angle,
    half,
    opposite_product,
    product,
    quotient,
    same,
    total,
    turned,
)
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


point = planar_4r.quantities(units="m", source=f"{HAYES}, Fig. 2")
point(product, "A_x", "A_x", "Moving pivot A, x", x="a1", y="cos_theta1")
point(product, "A_y", "A_y", "Moving pivot A, y", x="a1", y="sin_theta1")


@planar_4r.quantity(units="1", symbol="1 + kappa/gamma", source=POSITION, internal=True)
def output_share(p: Any, coupler_offset: Any, per_gamma: Any) -> Any:
    """Twice the foot of B on AD, from A, over |AD|: factor of H in the ratio of the output link."""
    return (p + coupler_offset) * per_gamma


@planar_4r.quantity(units="1", symbol="kappa/gamma - 1", source=POSITION, internal=True)
def coupler_share(p: Any, output_offset: Any, per_gamma: Any) -> Any:
    """Twice the foot of B on AD, from D, towards A, over |AD|: factor of H in the ratio of the coupler."""
    return (output_offset - p) * per_gamma


step = planar_4r.steps(units="1", source=POSITION)
step(half, "coupler_along", "f_2", "Foot of B on AD, from A, over |AD|", x="output_share")
step(half, "output_along", "f_3", "Foot of B on AD, from D, towards A, over |AD|", x="coupler_share")


@planar_4r.quantity(units="1", symbol="h", source=POSITION, internal=True)
def height(sigma: Any, per_gamma: Any) -> Any:
    """Distance of B from AD over |AD|."""
    return 0.5 * sigma * per_gamma


def beside(foot: Any, across: Any, branch_sign: Any) -> Any:
    """Return a component of B, from its foot on AD."""
    return foot + branch_sign * across


step = planar_4r.steps(units="m", source=POSITION)
step(product, "along_AB_x", "AF_x", "Foot of B on AD from A, x", x="coupler_along", y="AD_x")
step(opposite_product, "along_AB_y", "AF_y", "Foot of B on AD from A, y", x="coupler_along", y="A_y")
step(product, "along_DB_x", "DF_x", "Foot of B on AD from D, x", x="output_along", y="AD_x")
step(opposite_product, "along_DB_y", "DF_y", "Foot of B on AD from D, y", x="output_along", y="A_y")
step(product, "across_x", "FB_x", "From the foot to B in branch 2, x", x="height", y="A_y")
step(product, "across_y", "FB_y", "From the foot to B in branch 2, y", x="height", y="AD_x")
step.vector(beside, "AB_*", "AB_*", "Vector from A to B", foot="along_AB_*", across="across_*")
step.vector(beside, "DB_*", "DB_*", "Vector from D to B", foot="along_DB_*", across="across_*")


@planar_4r.quantity(units="1", symbol="near O", source=POSITION, internal=True)
def from_A(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """1 where B is reached by shorter links from O than from D, else 0."""
    return select(s1 + s2 <= s3 + s4, 1.0, 0.0)


@planar_4r.quantity(units="m", symbol="F_x", source=POSITION, internal=True)
def foot_x(from_A: Any, A_x: Any, a4: Any, coupler_along: Any, output_along: Any, AD_x: Any) -> Any:
    """Foot of B on AD, x, the same in both branches."""
    return select(from_A == 1.0, A_x, a4) + select(from_A == 1.0, coupler_along, output_along) * AD_x


point(beside, "B_x", "B_x", "Moving pivot B, x", foot="foot_x", across="across_x")
point(same, "B_y", "B_y", "Moving pivot B, y", x="DB_y")


AB, DB = {"x": "AB_x", "y": "AB_y"}, {"x": "DB_x", "y": "DB_y"}
step(quotient, "P_along", "P_u/a_2", "Coupler point along AB, over its length", x="P_u", y="a2", units="1")
step(quotient, "P_across", "P_v/a_2", "Coupler point across AB, over its length", x="P_v", y="a2", units="1")
step.vector(turned, "AP_*", "AP_*", "Vector from A to the coupler point", u="P_along", v="P_across", **AB)
point.vector(total, "P_*", "P_*", "Coupler point P", x="A_*", y="AP_*")


direction = planar_4r.quantities(units="rad", source=f"{HAYES}, eq. (2)")
_DB = "Direction of the output link DB in the ground frame"
direction(angle, "theta2", "theta_2", "Direction of the coupler AB in the ground frame", **AB)
direction = planar_4r.quantities(units="rad", source=f"{HAYES}, eq. (1)")
direction(angle, "theta4", "theta_4", _DB, **DB)


@planar_4r.quantity(units="rad", symbol="mu", source=POSITION)
def transmission_angle(p: Any, q: Any) -> Any:
    """Transmission angle: between BA and BD."""
    return 2.0 * atan2(sqrt(p), sqrt(q))


def scaled_norm(x: Any, y: Any, lift: Any, unit: Any) -> Any:
    """Length of a vector, scaled."""
    u = x * lift / unit
    v = y * lift / unit
    return sqrt(u * u + v * v)


_COMPUTED = "Length of the computed {} vector, scaled"
step(scaled_norm, "coupler_length", "|AB|", _COMPUTED.format("coupler"), **AB)
step(scaled_norm, "output_length", "|DB|", _COMPUTED.format("output"), **DB)


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
    closure_x: Any, closure_y: Any, coupler_length: Any, output_length: Any, s1: Any, s2: Any, s3: Any,
    s4: Any,
) -> Any:  # fmt: skip
    """Closure error of the loop and of the lengths AB and DB, relative to the longest link."""
    coupler_error = coupler_length - s2
    output_error = output_length - s3
    opening = closure_x * closure_x + closure_y * closure_y
    total = opening + (coupler_error * coupler_error + output_error * output_error)
    return sqrt(total) / largest(s1, s2, s3, s4)
