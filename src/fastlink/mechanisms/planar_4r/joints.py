"""Facts of the four joints of the planar 4R, in the convention of the six input-output equations.

Equations (1) to (6) hold for the closed polygon traversed a1, a2, a3, a4: with link directions phi_i (OA, AB,
BD, DO; phi_0 = phi_4 = pi) the joint angles are phi_i - phi_(i-1). In terms of the ground-frame angles:

    joint_angle_1 = theta1 - pi,       joint_angle_2 = theta2 - theta1,
    joint_angle_3 = theta4 + pi - theta2,    joint_angle_4 = -theta4,    all in (-pi, pi].

Each comes from its own cosine and sine, never from a difference of angles. See docs/conventions.md.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import opposite, product, same
from fastlink.mechanisms.planar_4r.inputs import HAYES, planar_4r
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER, atan2, select, sqrt

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


# -- for the residuals (factors.py) ------------------------------------------------------------------


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
