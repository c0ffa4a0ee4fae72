"""Facts of force of the planar 4R: mass centres, joint reactions, driving torque.

F_ij is the force of link i on link j, T41 the driving torque on the crank. The moments of links 3 and 2
give F32, the other forces follow link by link; the divisor AB x DB is 2 a1 a4 sigma up to sign, which
keeps its digits at a toggle where a cross product of the vectors does not.

The torque is that of the power: sum of m_i a_Gi . v_Gi + I_i alpha_i omega_i over omega1. With n = omega2/omega1, the
acceleration of the coupler's mass centre, -omega1^2 A + alpha2 J AG - omega2^2 AG, times its velocity over omega1,
J (A + n AG), is

    alpha2 AG . (A + n AG) - omega1^2 n (n - 1) A x AG:

where the links turn nearly as one (a4 is short), every term is as small as the torque, while A x F21 and the sum of
the moments about O are small differences of great forces. Products of parallel vectors are left out, not computed.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import (
    along,
    difference,
    norm,
    product,
    square,
    total,
    turned,
)
from fastlink.mechanisms.planar_4r import angle_derivatives  # noqa: F401 (declares the ratios)
from fastlink.mechanisms.planar_4r.centres import CENTRES, EQUATION_9, OUTPUT, THETA1, about_fixed
from fastlink.mechanisms.planar_4r.inputs import planar_4r
from fastlink.mechanisms.planar_4r.position import DB

REACTIONS = EQUATION_9


step = planar_4r.steps(units="rad2 s-2", source=REACTIONS)
step(square, "omega1_squared", "omega_1^2", "Square of the input speed", x="omega1")
step(square, "omega2_squared", "omega_2^2", "Square of the coupler's angular velocity", x="omega2")
step(square, "omega4_squared", "omega_4^2", "Square of the output link's angular velocity", x="omega4")


def crank_force(m1: Any, omega1_squared: Any, centre: Any) -> Any:
    """Return the rate of momentum of the crank, along or across its axis."""
    return -(m1 * omega1_squared) * centre


_RATE = "Rate of momentum of the crank"
_P1 = {"u": "crank_force_along", "v": "crank_force_across", **THETA1}
step = planar_4r.steps(units="N", source=REACTIONS)
step(crank_force, "crank_force_along", "-m_1 omega_1^2 G_1u", f"{_RATE}, along its axis", centre="G1_u")
step(crank_force, "crank_force_across", "-m_1 omega_1^2 G_1v", f"{_RATE}, across its axis", centre="G1_v")
step.vector(turned, "p1_*", "m_1 a_CG1*", _RATE, **_P1)
step.vector(product, "p2_*", "m_2 a_CG2*", "Rate of momentum of the coupler", x="m2", y="G2_a*")
_AXIS = "its axis, over its length"
_CENTRE = "Mass times centre of the output link"
_G3 = {"u": "m3_G3_along", "v": "m3_G3_across", **DB}
step = planar_4r.steps(units="kg", source=CENTRES)
step(product, "m3_G3_along", "m_3 G_3/a_3", f"{_CENTRE} along {_AXIS}", x="m3", y="G3_along")
step(product, "m3_G3_across", "m_3 G_3/a_3", f"{_CENTRE} across {_AXIS}", x="m3", y="G3_across")
step.vector(turned, "m3_DG_*", "m_3 DG_3*", f"{_CENTRE} from D", **_G3, units="kg m")


_G3 = {**OUTPUT, "x": "m3_DG_x", "y": "m3_DG_y"}
step.vector(about_fixed, "p3_*", "m_3 a_CG3*", "Rate of momentum of the output link", **_G3, units="N")


def about_pivot(inertia: Any, mass: Any, G_u: Any, G_v: Any) -> Any:
    """Moment of inertia of a link about its fixed pivot."""
    return inertia + mass * (G_u * G_u + G_v * G_v)


step = planar_4r.steps(units="kg m2", source=CENTRES)
_I1 = {"inertia": "I1", "mass": "m1", "G_u": "G1_u", "G_v": "G1_v"}
_I3 = {"inertia": "I3", "mass": "m3", "G_u": "G3_u", "G_v": "G3_v"}
step(about_pivot, "I1_O", "I_1O", "Moment of inertia of the crank about O", **_I1)
step(about_pivot, "I3_D", "I_3D", "Moment of inertia of the output link about D", **_I3)


_I2 = {"inertia": "I2", "mass": "m2", "G_u": "G2_u", "G_v": "G2_v"}
step(about_pivot, "I2_A", "I_2A", "Moment of inertia of the coupler about A", **_I2)
step = planar_4r.steps(units="kg rad2 s-2", source=REACTIONS)
step(product, "m2_omega1_squared", "m_2 omega_1^2", "Mass times squared speed", x="m2", y="omega1_squared")


@planar_4r.quantity(units="m2", symbol="A x AG", source=REACTIONS, internal=True)
def A_cross_AG(a1: Any, G2_along: Any, G2_across: Any, AB_u: Any, AB_v: Any) -> Any:
    """Cross product of the crank pin and the coupler's mass centre from it, of the angle between them."""
    return a1 * (G2_along * AB_v + G2_across * AB_u)


@planar_4r.quantity(units="N m", symbol="M_2", source=REACTIONS, internal=True)
def moment2_A(I2_A: Any, alpha2: Any, m2_omega1_squared: Any, A_cross_AG: Any) -> Any:
    """Rate of moment of momentum of the coupler about A, A held."""
    return I2_A * alpha2 + m2_omega1_squared * A_cross_AG


@planar_4r.quantity(units="m-1", symbol="unit/(2 a_1 a_4)", source=REACTIONS, internal=True)
def unit_per_2_a1_a4(s1: Any, s4: Any, per_unit: Any) -> Any:
    """Power of two at or below the longest link over twice crank times ground."""
    return 0.5 / s1 / s4 * per_unit


@planar_4r.quantity(units="kg m", symbol="I_3D unit/(2 a_1 a_4)", source=REACTIONS, internal=True)
def I3_D_per_2_a1_a4(I3_D: Any, unit_per_2_a1_a4: Any) -> Any:
    """Moment of inertia about D over twice crank times ground, times that power of two."""
    return I3_D * unit_per_2_a1_a4


def pull(moment: Any, per_2_a1_a4: Any, per_sigma: Any, branch_sign: Any) -> Any:
    """Force in the joint B that balances the moment of a link, for a length of that power of two."""
    return moment * (branch_sign * (per_2_a1_a4 * per_sigma))


_LENGTH = "for a length of that power of two"
_DB = f"Force in the joint B along DB that balances the coupler's moment, {_LENGTH}"
_AB = f"Force in the joint B along AB that balances the output link's moment, {_LENGTH}"
_M2 = {"moment": "moment2_A", "per_2_a1_a4": "unit_per_2_a1_a4"}
_M3 = {"moment": "alpha4", "per_2_a1_a4": "I3_D_per_2_a1_a4"}
step = planar_4r.steps(units="N", source=REACTIONS)
step(pull, "pull_along_DB", "M_2 unit/(AB x DB)", _DB, **_M2)
step(pull, "pull_along_AB", "I_3D alpha_4 unit/(AB x DB)", _AB, **_M3)


def force_in_B(pull_along_DB: Any, pull_along_AB: Any, AB: Any, DB: Any, per_unit: Any) -> Any:
    """Return a component of the force in the joint B from those along DB and AB."""
    return (pull_along_DB * DB + pull_along_AB * AB) * per_unit


force = planar_4r.quantities(units="N", source=REACTIONS)
force.vector(
    force_in_B, "F32_*", "F_32*", "Force of the output link on the coupler at B", AB="AB_*", DB="DB_*"
)
force.vector(difference, "F21_*", "F_21*", "Force of the coupler on the crank at A", x="F32_*", y="p2_*")
force.vector(difference, "F41_*", "F_41*", "Force of the ground on the crank at O", x="p1_*", y="F21_*")
force.vector(total, "F43_*", "F_43*", "Force of the ground on the output link at D", x="p3_*", y="F32_*")


arm = planar_4r.steps(units="m", source=REACTIONS)
_ARM = "Velocity of the coupler's mass centre over omega1, a quarter turn back"
arm.vector(along, "arm2_*", "A + n AG_2", _ARM, start="A_*", length="coupler_ratio", direction="AG_*")


@planar_4r.quantity(units="N m", symbol="T_2", source=REACTIONS, internal=True)
def torque2(
    I2: Any, m2: Any, alpha2: Any, coupler_ratio: Any, joint_ratio_2: Any, AG_x: Any, AG_y: Any, arm2_x: Any,
    arm2_y: Any, m2_omega1_squared: Any, A_cross_AG: Any,
) -> Any:  # fmt: skip
    """Power that the coupler takes up, over omega1."""
    centripetal = m2_omega1_squared * ((coupler_ratio * joint_ratio_2) * A_cross_AG)
    return alpha2 * (I2 * coupler_ratio + m2 * (AG_x * arm2_x + AG_y * arm2_y)) - centripetal


_POWER = "Power that the output link takes up, over omega1"
step = planar_4r.steps(units="N m", source=REACTIONS)
step(
    product, "moment3_D", "M_3", "Rate of moment of momentum of the output link about D", x="I3_D", y="alpha4"
)
step(product, "torque3", "T_3", _POWER, x="moment3_D", y="output_ratio")
torque = planar_4r.quantities(units="N m", source=f"{REACTIONS}, by its power")
torque(total, "T41", "T_41", "Driving torque of the ground on the crank", x="torque2", y="torque3")


force(norm, "F41", "|F_41|", "Force of the ground on the crank at O, magnitude", x="F41_x", y="F41_y")
force(norm, "F21", "|F_21|", "Force of the coupler on the crank at A, magnitude", x="F21_x", y="F21_y")
force(norm, "F32", "|F_32|", "Force of the output link on the coupler at B, magnitude", x="F32_x", y="F32_y")
force(norm, "F43", "|F_43|", "Force of the ground on the output link at D, magnitude", x="F43_x", y="F43_y")


@planar_4r.quantity(units="W", symbol="P_in", source=f"{REACTIONS}, T_41 omega_1")
def input_power(T41: Any, omega1: Any) -> Any:
    """Power of the driving torque."""
    return T41 * omega1
