"""Facts of position of the planar 4R: the dyad AB, DB, coupler point, angles, closure.

With Z = sin^2(theta1/2), C = cos^2(theta1/2) every factor is a difference Z - Z0 or C - C0 from a toggle,
in twice the working precision: nothing cancels, however near the toggle or the change point.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import (
    angle,
    difference,
    half,
    opposite,
    opposite_product,
    product,
    quotient,
    same,
    total,
    turned,
)
from fastlink.mechanisms.planar_4r import classes  # noqa: F401 (on which it builds)
from fastlink.mechanisms.planar_4r.inputs import HAYES, LINKS, NUMERICS, planar_4r
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER, atan2, cos, select, sin, sqrt
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
step(scaled_norm, "coupler_length", "|AB|", _COMPUTED.format("coupler"), **AB, units="1")
step(scaled_norm, "output_length", "|DB|", _COMPUTED.format("output"), **DB, units="1")


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


# -- Facts of the four joints of the planar 4R, in the convention of the six input-output equations

# Equations (1) to (6) hold for the closed polygon traversed a1, a2, a3, a4: with link directions phi_i (OA,
# AB, BD, DO; phi_0 = phi_4 = pi) the joint angles are phi_i - phi_(i-1). In terms of the ground-frame
# angles:
#
#     joint_angle_1 = theta1 - pi,       joint_angle_2 = theta2 - theta1,
#     joint_angle_3 = theta4 + pi - theta2,    joint_angle_4 = -theta4,    all in (-pi, pi].
#
# Each comes from its own cosine and sine, never from a difference of angles. See docs/conventions.md.


JOINTS = f"{HAYES}, eqs. (1) to (6)"
JOINT_RATES = f"{HAYES}, eq. (7) for all pairs"
JOINT_ACCELERATIONS = f"{HAYES}, eq. (8) for all pairs"

# -- vectors: cosine and sine of each joint angle times a length ---------------------------------------


@planar_4r.quantity(units="m", symbol="AD_u", source=JOINTS, internal=True)
def AD_u(a1: Any, a4: Any, Z: Any) -> Any:
    """Vector from A to D, along OA."""
    return (a4 - a1) - 2.0 * a4 * Z


@planar_4r.quantity(units="m", symbol="AD_v", source=JOINTS, internal=True)
def AD_v(a4: Any, sin_theta1: Any) -> Any:
    """Vector from A to D, to the left of OA."""
    return -(a4 * sin_theta1)


@planar_4r.quantity(units="m", symbol="AB_u", source=JOINTS, internal=True)
def AB_u(coupler_along: Any, height: Any, AD_u: Any, AD_v: Any, branch_sign: Any) -> Any:
    """Vector from A to B, along OA."""
    return coupler_along * AD_u - branch_sign * (height * AD_v)


@planar_4r.quantity(units="m", symbol="AB_v", source=JOINTS, internal=True)
def AB_v(coupler_along: Any, height: Any, AD_u: Any, AD_v: Any, branch_sign: Any) -> Any:
    """Vector from A to B, to the left of OA."""
    # + 0.0 turns -0.0 into 0.0, so that the straight angle is pi and never -pi.
    return (coupler_along * AD_v + branch_sign * (height * AD_u)) + 0.0


@planar_4r.quantity(units="1", symbol="sqrt p", source=JOINTS, internal=True)
def root_p(p: Any) -> Any:
    """Cosine of half the third joint angle, times sqrt(p + q)."""
    return sqrt(p)


@planar_4r.quantity(units="1", symbol="sqrt q", source=JOINTS, internal=True)
def root_q(q: Any) -> Any:
    """Sine of half the third joint angle, times sqrt(p + q), without its sign."""
    return sqrt(q)


@planar_4r.quantity(units="1", symbol="sign theta_3", source=JOINTS, internal=True)
def joint_sign_3(root_p: Any, branch_sign: Any) -> Any:
    """Sign of the third joint angle; the straight angle is pi in both branches."""
    return select(root_p == 0.0, 1.0, -branch_sign)


# -- angles and half-angle tangents ------------------------------------------------------------------


@planar_4r.quantity(units="rad", symbol="theta_1 (eqs. 1-6)", source=JOINTS)
def joint_angle_1(cos_theta1: Any, sin_theta1: Any) -> Any:
    """Joint angle at O: from the ground link DO to the crank OA, theta1 - pi."""
    return atan2(0.0 - sin_theta1, -cos_theta1)


@planar_4r.quantity(units="rad", symbol="theta_2 (eqs. 1-6)", source=JOINTS)
def joint_angle_2(AB_u: Any, AB_v: Any) -> Any:
    """Joint angle at A: from the crank OA to the coupler AB, theta2 - theta1."""
    return atan2(AB_v, AB_u)


@planar_4r.quantity(units="rad", symbol="theta_3 (eqs. 1-6)", source=JOINTS)
def joint_angle_3(root_p: Any, root_q: Any, joint_sign_3: Any, sigma: Any) -> Any:
    """Joint angle at B: from the coupler AB to the output link BD, theta4 + pi - theta2."""
    angle = joint_sign_3 * (2.0 * atan2(root_q, root_p))
    # Times -1 the compiler may or may not turn the sign of a NaN; selected, its bits are always the same.
    return select(sigma >= 0.0, angle, NOT_A_NUMBER)


@planar_4r.quantity(units="rad", symbol="theta_4 (eqs. 1-6)", source=JOINTS)
def joint_angle_4(DB_x: Any, DB_y: Any) -> Any:
    """Joint angle at D: from the output link BD to the ground link DO, -theta4."""
    return atan2(0.0 - DB_y, DB_x)


@planar_4r.quantity(units="1", symbol="v_1", source=JOINTS)
def v1(half_sine: Any, C: Any, Z: Any) -> Any:
    """Tangent of half the first joint angle, -cot(theta1/2)."""
    # the sine of the angle is exactly 0 at half a turn, too, where joint_angle_1 = 0 is the input
    return select(half_sine == 0.0, select(Z > C, 0.0, INFINITY), -C / half_sine)


@planar_4r.quantity(units="1", symbol="v_2", source=JOINTS)
def v2(AB_u: Any, AB_v: Any, a2: Any) -> Any:
    """Tangent of half the second joint angle."""
    return select(AB_u < 0.0, (a2 - AB_u) / AB_v, AB_v / (a2 + abs(AB_u)))


@planar_4r.quantity(units="1", symbol="v_3", source=JOINTS)
def v3(root_p: Any, root_q: Any, joint_sign_3: Any, sigma: Any) -> Any:
    """Tangent of half the third joint angle."""
    return select(sigma >= 0.0, joint_sign_3 * (root_q / root_p), NOT_A_NUMBER)


@planar_4r.quantity(units="1", symbol="v_4", source=JOINTS)
def v4(DB_x: Any, DB_y: Any, a3: Any) -> Any:
    """Tangent of half the fourth joint angle, -tan(theta4/2)."""
    y = 0.0 - DB_y
    return select(DB_x < 0.0, (a3 - DB_x) / y, y / (a3 + abs(DB_x)))


# -- rates at constant input speed ---------------------------------------------------------------------


@planar_4r.quantity(units="1", symbol="(a_4 - a_1)/(2 a_1)", source=JOINT_RATES, internal=True)
def ground_excess(s1: Any, s4: Any) -> Any:
    """(a4 - a1)/(2 a1)."""
    return 0.5 * (s4 - s1) / s1


@planar_4r.quantity(units="rad s-1", symbol="d theta_2/dt (eqs. 1-6)", source=JOINT_RATES)
def joint_omega_2(
    half_omega1: Any, ground_excess: Any, Z: Any, per_gamma: Any, odd_rate: Any, coupler_share: Any,
    branch_sign: Any,
) -> Any:  # fmt: skip
    """Rate of the second joint angle, omega2 - omega1."""
    return branch_sign * (odd_rate * coupler_share) - half_omega1 * ((ground_excess + Z) * per_gamma)


def of_both_branches(x: Any, branch_sign: Any) -> Any:
    """Return 2 x, with the sign of the branch."""
    return branch_sign * (2.0 * x)


def backwards(x: Any) -> Any:
    """Return 0 - x: not -0.0 where x is 0."""
    return 0.0 - x


_THIRD, _FOURTH = "Rate of the third joint angle, omega4 - omega2", "Rate of the fourth joint angle, -omega4"
rate = planar_4r.quantities(units="rad s-1", source=JOINT_RATES)
rate(of_both_branches, "joint_omega_3", "d theta_3/dt (eqs. 1-6)", _THIRD, x="odd_rate")
rate(backwards, "joint_omega_4", "d theta_4/dt (eqs. 1-6)", _FOURTH, x="omega4")
_SECOND = "Second derivative of the second joint angle, alpha2 - alpha1"
_THIRD = "Second derivative of the third joint angle, alpha4 - alpha2"
_FOURTH = "Second derivative of the fourth joint angle, -alpha4"
rate = planar_4r.quantities(units="rad s-2", source=JOINT_ACCELERATIONS)
rate(of_both_branches, "joint_alpha_3", "d2 theta_3/dt2 (eqs. 1-6)", _THIRD, x="H_rate")
rate(same, "joint_alpha_2", "d2 theta_2/dt2 (eqs. 1-6)", _SECOND, x="alpha2")
rate(backwards, "joint_alpha_4", "d2 theta_4/dt2 (eqs. 1-6)", _FOURTH, x="alpha4")


# -- time derivatives of the half-angle tangents ---------------------------------------------------------


def slope_of_tangent(v: Any) -> Any:
    """Derivative of the tangent of half an angle with respect to the angle."""
    return 0.5 * (1.0 + v * v)


def second_derivative(v: Any, v_slope: Any, rate: Any, acceleration: Any) -> Any:
    """Second time derivative of the tangent of half an angle; the paper leaves out the factor v."""
    return v_slope * (acceleration + v * (rate * rate))


def steady_second_derivative(v: Any, v_slope: Any, rate: Any) -> Any:
    """Second time derivative of the tangent of half an angle that grows at a constant rate."""
    return v_slope * (v * (rate * rate))


V_DOT, V_DDOT = f"{HAYES}, section 2, v-dot", f"{HAYES}, section 2, v-double-dot, corrected (docs/errata.md)"
step = planar_4r.steps(units="rad-1", source=V_DOT)
first = planar_4r.quantities(units="s-1", source=V_DOT)
second = planar_4r.quantities(units="s-2", source=V_DDOT)
for _i, _nth in enumerate(("first", "second", "third", "fourth"), 1):
    _rate, _tangent = (
        "omega1" if _i == 1 else f"joint_omega_{_i}",
        f"the tangent of half the {_nth} joint angle",
    )
    _v = {"v": f"v{_i}", "v_slope": f"v{_i}_slope", "rate": _rate}
    step(slope_of_tangent, f"v{_i}_slope", f"(1 + v_{_i}^2)/2", v=f"v{_i}")
    _x = {"x": f"v{_i}_slope", "y": _rate}
    first(product, f"v{_i}_dot", f"dv_{_i}/dt", f"Time derivative of {_tangent}", **_x)
    _law = second_derivative if _i > 1 else steady_second_derivative
    _v |= {"acceleration": f"joint_alpha_{_i}"} if _i > 1 else {}
    second(_law, f"v{_i}_ddot", f"d2v_{_i}/dt2", f"Second time derivative of {_tangent}", **_v)


# -- for the residuals (classes.py) ------------------------------------------------------------------


@planar_4r.quantity(units="1", symbol="a_1 a_4/(a_2 a_3)", source=JOINTS, internal=True)
def per_p_plus_q(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 a4/(a2 a3), which is 1/(p + q)."""
    return (s1 / s2) * (s4 / s3)


def squared_root(root: Any, per_p_plus_q: Any) -> Any:
    """Return the square of a root of p or q, over p + q."""
    return root * root * per_p_plus_q


@planar_4r.quantity(units="1", symbol="sin(theta_3)/2", source=JOINTS, internal=True)
def joint_Y3(root_p: Any, root_q: Any, per_p_plus_q: Any, branch_sign: Any) -> Any:
    """Half the sine of the third joint angle."""
    return -branch_sign * (root_p * root_q * per_p_plus_q)


def squared_half_sine(x: Any, length: Any) -> Any:
    """Squared sine of half the angle of a vector of known length."""
    return 0.5 - 0.5 * (x / length)


def squared_half_cosine(x: Any, length: Any) -> Any:
    """Squared cosine of half the angle of a vector of known length."""
    return 0.5 + 0.5 * (x / length)


def half_of_sine(y: Any, length: Any) -> Any:
    """Half the sine of the angle of a vector of known length."""
    return 0.5 * (y / length)


def minus_half_of_sine(y: Any, length: Any) -> Any:
    """Minus half the sine of the angle of a vector of known length."""
    return -0.5 * (y / length)


_1, _3 = "half the first joint angle", "half the third joint angle"
step = planar_4r.steps(units="1", source=JOINTS)
step(same, "joint_S1", "sin^2(theta_1/2)", f"Squared sine of {_1}", x="C")
step(same, "joint_C1", "cos^2(theta_1/2)", f"Squared cosine of {_1}", x="Z")
step(opposite, "joint_Y1", "sin(theta_1)/2", "Half the sine of the first joint angle", x="half_sine")
step(squared_half_sine, "joint_S2", "sin^2(theta_2/2)", x="AB_u", length="a2")
step(squared_half_cosine, "joint_C2", "cos^2(theta_2/2)", x="AB_u", length="a2")
step(half_of_sine, "joint_Y2", "sin(theta_2)/2", y="AB_v", length="a2")
step(squared_root, "joint_S3", "sin^2(theta_3/2)", f"Squared sine of {_3}", root="root_q")
step(squared_root, "joint_C3", "cos^2(theta_3/2)", f"Squared cosine of {_3}", root="root_p")
step(squared_half_sine, "joint_S4", "sin^2(theta_4/2)", x="DB_x", length="a3")
step(squared_half_cosine, "joint_C4", "cos^2(theta_4/2)", x="DB_x", length="a3")
step(minus_half_of_sine, "joint_Y4", "sin(theta_4)/2", y="DB_y", length="a3")


# -- Mass centres of the links: where they are, their accelerations, and the joints as seen from them

# r_ij runs from the mass centre of link i to joint j, as in eq. (9); O, A, B, D are joints 1, 2, 3, 4.


CENTRES = f"{HAYES}, Fig. 2"
EQUATION_9 = f"{HAYES}, eq. (9)"
THETA1 = {"x": "cos_theta1", "y": "sin_theta1"}

_AXIS = "its axis, over its length"
step = planar_4r.steps(units="1", source=CENTRES)
step(quotient, "G2_along", "G_2u/a_2", f"Mass centre of the coupler along {_AXIS}", x="G2_u", y="a2")
step(quotient, "G2_across", "G_2v/a_2", f"Mass centre of the coupler across {_AXIS}", x="G2_v", y="a2")
step(quotient, "G3_along", "G_3u/a_3", f"Mass centre of the output link along {_AXIS}", x="G3_u", y="a3")
step(quotient, "G3_across", "G_3v/a_3", f"Mass centre of the output link across {_AXIS}", x="G3_v", y="a3")
_OUTPUT = "Mass centre of the output link, with what is fixed to it,"
step(same, "DG_along", "DG_3u/a_3", f"{_OUTPUT} along {_AXIS}", x="G3_along")
step(same, "DG_across", "DG_3v/a_3", f"{_OUTPUT} across {_AXIS}", x="G3_across")
step = planar_4r.steps(units="m", source=CENTRES)
_G1 = {"u": "G1_u", "v": "G1_v", **THETA1}
_G3 = {"u": "DG_along", "v": "DG_across", **DB}
step.vector(turned, "OG_*", "OG_1*", "Mass centre of the crank from O", **_G1)
step.vector(turned, "AG_*", "AG_2*", "Mass centre of the coupler from A", u="G2_along", v="G2_across", **AB)
step.vector(turned, "DG_*", "DG_3*", "Mass centre of the output link from D", **_G3)

# -- in the ground frame --------------------------------------------------------------------------

_CENTRE = {i: f"Mass centre of the {link}" for i, link in LINKS.items()}
centre = planar_4r.quantities(units="m", source=CENTRES)
centre.vector(same, "G1_*", "G_1*", _CENTRE[1], x="OG_*")
centre.vector(total, "G2_*", "G_2*", _CENTRE[2], x="A_*", y="AG_*")
centre(total, "G3_x", "G_3x", f"{_CENTRE[3]}, x", x="a4", y="DG_x")
centre(same, "G3_y", "G_3y", f"{_CENTRE[3]}, y", x="DG_y")

# -- the joints from the mass centres -------------------------------------------------------------

joint = planar_4r.quantities(units="m", source=EQUATION_9)
_FROM = {i: f"from the mass centre of the {link}" for i, link in LINKS.items()}
joint.vector(opposite, "r11_*", "r_11*", f"Joint 1 {_FROM[1]}", x="OG_*")
joint.vector(difference, "r12_*", "r_12*", f"Joint 2 {_FROM[1]}", x="A_*", y="OG_*")
joint.vector(opposite, "r22_*", "r_22*", f"Joint 2 {_FROM[2]}", x="AG_*")
joint.vector(difference, "r23_*", "r_23*", f"Joint 3 {_FROM[2]}", x="AB_*", y="AG_*")
joint.vector(difference, "r33_*", "r_33*", f"Joint 3 {_FROM[3]}", x="DB_*", y="DG_*")
joint.vector(opposite, "r34_*", "r_34*", f"Joint 4 {_FROM[3]}", x="DG_*")

# -- accelerations --------------------------------------------------------------------------------


def about_fixed_x(alpha: Any, omega_squared: Any, x: Any, y: Any) -> Any:
    """Acceleration of a point of a link that turns about a fixed pivot, x; times the mass where x, y are."""
    return -(alpha * y + omega_squared * x)


def about_fixed_y(alpha: Any, omega_squared: Any, x: Any, y: Any) -> Any:
    """Acceleration of such a point, y."""
    return alpha * x - omega_squared * y


def about_moving_x(pivot: Any, alpha: Any, omega_squared: Any, x: Any, y: Any) -> Any:
    """Acceleration of a point of a link whose pivot moves, x."""
    return pivot - alpha * y - omega_squared * x


def about_moving_y(pivot: Any, alpha: Any, omega_squared: Any, x: Any, y: Any) -> Any:
    """Acceleration of such a point, y."""
    return pivot + alpha * x - omega_squared * y


about_fixed = about_fixed_x, about_fixed_y
about_moving = about_moving_x, about_moving_y
OUTPUT = {"alpha": "alpha4", "omega_squared": "omega4_squared"}

_ACCELERATION = {i: f"Acceleration of the mass centre of the {link}" for i, link in LINKS.items()}
_G2 = {"pivot": "a_A*", "alpha": "alpha2", "omega_squared": "omega2_squared", "x": "AG_x", "y": "AG_y"}
step = planar_4r.steps(units="m s-2", source=EQUATION_9)
step.vector(opposite_product, "a_A*", "a_A*", "Acceleration of A", x="omega1_squared", y="A_*")
centre = planar_4r.quantities(units="m s-2", source=EQUATION_9)
centre.vector(opposite_product, "G1_a*", "a_CG1*", _ACCELERATION[1], x="omega1_squared", y="OG_*")
centre.vector(about_moving, "G2_a*", "a_CG2*", _ACCELERATION[2], **_G2)
centre.vector(about_fixed, "G3_a*", "a_CG3*", _ACCELERATION[3], **OUTPUT, x="DG_x", y="DG_y")

# -- masses, moments of inertia -------------------------------------------------------------------

# whole, and about the mass centre of the whole: counterweights change them
for _i, _link in ((1, LINKS[1]), (3, LINKS[3])):
    _ABOUT = f"Moment of inertia of the {_link} about its mass centre"
    step(same, f"mass{_i}", f"m_{_i}", f"Whole mass of the {_link}", x=f"m{_i}", units="kg")
    step(same, f"I{_i}_G", f"I_CG{_i}", _ABOUT, x=f"I{_i}", units="kg m2")


# -- Coefficients and residuals of the six input-output equations

# The residuals are homogeneous: v_i = sin/cos of half the joint angle, multiplied by cos^2 cos^2 and
# divided by the squared sum of the lengths, so that they are finite at straight joints too and comparable
# between designs.


#: Which equation of the paper, and products of which factors multiply v_i^2 v_j^2, v_i^2, v_j^2 and 1.
IO_PRODUCTS = {
    "12": (2, "A1 B2", "A2 B1", "C1 D2", "C2 D1"),
    "13": (3, "A1 B1", "A2 B2", "C2 D2", "C1 D1"),
    "14": (1, "A1 A2", "B1 B2", "C1 C2", "D1 D2"),
    "23": (4, "A1 D2", "B2 C1", "B1 C2", "A2 D1"),
    "24": (5, "A1 C1", "B2 D2", "A2 C2", "B1 D1"),
    "34": (6, "A1 C2", "B1 D2", "A2 C1", "B2 D1"),
}
#: The coefficient of v_i v_j is this number times the product of these two lengths; there is none in 13 and 24.
IO_CROSS = {
    "12": (-8.0, "2", "4"),
    "14": (-8.0, "1", "3"),
    "23": (-8.0, "1", "3"),
    "34": (8.0, "2", "4"),
}


@planar_4r.quantity(units="1", symbol="1/(4 s^2)", source=f"{HAYES}, eqs. (1) to (6)", internal=True)
def per_sum_squared(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """Reciprocal of the squared sum of the scaled lengths."""
    total = (s1 + s2) + (s3 + s4)
    return 1.0 / (total * total)


def io_product(first: Any, second: Any, per_sum_squared: Any) -> Any:
    """Product of two factors over the squared sum of the lengths."""
    return first * second * per_sum_squared


def io_cross(x: Any, y: Any, per_sum_squared: Any) -> Any:
    """Eight times the product of two lengths over the squared sum of all."""
    return 8.0 * (x * y) * per_sum_squared


def residual(vivj: Any, vi: Any, vj: Any, one: Any, S_i: Any, C_i: Any, S_j: Any, C_j: Any) -> Any:
    """Residual of an equation without a term in v_i v_j."""
    return (vivj * S_i * S_j + one * C_i * C_j) + (vi * S_i * C_j + vj * C_i * S_j)


def residual_plus_cross(squares: Any, cross: Any, Y_i: Any, Y_j: Any) -> Any:
    """Residual of an equation with a positive coefficient of v_i v_j."""
    return squares + cross * Y_i * Y_j


def residual_minus_cross(squares: Any, cross: Any, Y_i: Any, Y_j: Any) -> Any:
    """Residual of an equation with a negative coefficient of v_i v_j."""
    return squares - cross * Y_i * Y_j


step = planar_4r.steps(units="1", source=f"{HAYES}, eqs. (1) to (6)")
OVER = "over the squared sum of the lengths"
step(io_cross, "io_cross_13", "8 a_1 a_3", "8 a1 a3 over the squared sum of the lengths", x="s1", y="s3")
step(io_cross, "io_cross_24", "8 a_2 a_4", "8 a2 a4 over the squared sum of the lengths", x="s2", y="s4")


def declare_residual(pair: str) -> None:
    """Declare the residual of the equation of two joints, and its coefficients."""
    i, j = pair[0], pair[1]
    equation, *products = IO_PRODUCTS[pair]
    source = f"{HAYES}, eq. ({equation})"
    step = planar_4r.steps(units="1", source=source)
    terms = {"S_i": f"joint_S{i}", "C_i": f"joint_C{i}", "S_j": f"joint_S{j}", "C_j": f"joint_C{j}"}
    for term, two in zip(("vivj", "vi", "vj", "one"), products, strict=True):
        first, second = str(two).split()
        terms[term] = f"io_{pair}_{term}"
        symbol, meaning = f"{first[0]}_{first[1]} {second[0]}_{second[1]}", f"{first} {second} {OVER}"
        step(io_product, terms[term], symbol, meaning, first=f"factor_{first}", second=f"factor_{second}")
    name, symbol = f"io_residual_{pair}", f"r_{pair}"
    meaning = f"Residual of the input-output equation of joints {i} and {j}, over the squared sum of lengths"
    quantity = planar_4r.quantities(units="1", source=source)
    if pair not in IO_CROSS:
        quantity(residual, name, symbol, meaning, **terms)
        return
    number, x, y = IO_CROSS[pair]
    squares = f"io_{pair}_squares"
    step(residual, squares, symbol, f"{meaning}, but for v_i v_j", **terms)
    with_cross = residual_plus_cross if number > 0.0 else residual_minus_cross
    halves = {"Y_i": f"joint_Y{i}", "Y_j": f"joint_Y{j}"}
    quantity(with_cross, name, symbol, meaning, squares=squares, cross=f"io_cross_{x}{y}", **halves)


for _pair in IO_PRODUCTS:
    declare_residual(_pair)
