"""Facts of force of the planar 4R: mass centres, joint reactions, driving torque.

F_ij is the force of link i on link j, T41 the driving torque on the crank. The moments of links 3 and 2
give F32, everything else follows link by link; the divisor AB x DB is 2 a1 a4 sigma up to sign, which
keeps its digits at a toggle where a cross product of the vectors does not.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms.planar_4r.inputs import HAYES, planar_4r
from fastlink.numerics.vectors import cross, magnitude

REACTIONS = f"{HAYES}, eq. (9)"
CENTRES = f"{HAYES}, Fig. 2"


@planar_4r.quantity(units="rad2 s-2", symbol="omega_1^2", source=REACTIONS, internal=True)
def omega1_squared(omega1: Any) -> Any:
    """Square of the input speed."""
    return omega1 * omega1


@planar_4r.quantity(units="1", symbol="G_2u/a_2", source=CENTRES, internal=True)
def G2_along(G2_u: Any, a2: Any) -> Any:
    """Mass centre of the coupler along its axis, over its length."""
    return G2_u / a2


@planar_4r.quantity(units="1", symbol="G_2v/a_2", source=CENTRES, internal=True)
def G2_across(G2_v: Any, a2: Any) -> Any:
    """Mass centre of the coupler across its axis, over its length."""
    return G2_v / a2


@planar_4r.quantity(units="1", symbol="G_3u/a_3", source=CENTRES, internal=True)
def G3_along(G3_u: Any, a3: Any) -> Any:
    """Mass centre of the output link along its axis, over its length."""
    return G3_u / a3


@planar_4r.quantity(units="1", symbol="G_3v/a_3", source=CENTRES, internal=True)
def G3_across(G3_v: Any, a3: Any) -> Any:
    """Mass centre of the output link across its axis, over its length."""
    return G3_v / a3


@planar_4r.quantity(units="N", symbol="-m_1 omega_1^2 G_1u", source=REACTIONS, internal=True)
def crank_force_along(m1: Any, omega1_squared: Any, G1_u: Any) -> Any:
    """Rate of momentum of the crank, along its axis."""
    return -(m1 * omega1_squared) * G1_u


@planar_4r.quantity(units="N", symbol="-m_1 omega_1^2 G_1v", source=REACTIONS, internal=True)
def crank_force_across(m1: Any, omega1_squared: Any, G1_v: Any) -> Any:
    """Rate of momentum of the crank, across its axis."""
    return -(m1 * omega1_squared) * G1_v


@planar_4r.quantity(units="N", symbol="m_1 a_CG1x", source=REACTIONS, internal=True)
def p1_x(crank_force_along: Any, crank_force_across: Any, cos_theta1: Any, sin_theta1: Any) -> Any:
    """Rate of momentum of the crank, x."""
    return crank_force_along * cos_theta1 - crank_force_across * sin_theta1


@planar_4r.quantity(units="N", symbol="m_1 a_CG1y", source=REACTIONS, internal=True)
def p1_y(crank_force_along: Any, crank_force_across: Any, cos_theta1: Any, sin_theta1: Any) -> Any:
    """Rate of momentum of the crank, y."""
    return crank_force_along * sin_theta1 + crank_force_across * cos_theta1


@planar_4r.quantity(units="m", symbol="AG_2x", source=CENTRES, internal=True)
def AG_x(G2_along: Any, G2_across: Any, AB_x: Any, AB_y: Any) -> Any:
    """Mass centre of the coupler from A, x."""
    return G2_along * AB_x - G2_across * AB_y


@planar_4r.quantity(units="m", symbol="AG_2y", source=CENTRES, internal=True)
def AG_y(G2_along: Any, G2_across: Any, AB_x: Any, AB_y: Any) -> Any:
    """Mass centre of the coupler from A, y."""
    return G2_along * AB_y + G2_across * AB_x


@planar_4r.quantity(units="m s-2", symbol="a_Ax", source=REACTIONS, internal=True)
def a_Ax(omega1_squared: Any, A_x: Any) -> Any:
    """Acceleration of A, x."""
    return -(omega1_squared * A_x)


@planar_4r.quantity(units="m s-2", symbol="a_Ay", source=REACTIONS, internal=True)
def a_Ay(omega1_squared: Any, A_y: Any) -> Any:
    """Acceleration of A, y."""
    return -(omega1_squared * A_y)


@planar_4r.quantity(units="rad2 s-2", symbol="omega_2^2", source=REACTIONS, internal=True)
def omega2_squared(omega2: Any) -> Any:
    """Square of the coupler's angular velocity."""
    return omega2 * omega2


@planar_4r.quantity(units="rad2 s-2", symbol="omega_4^2", source=REACTIONS, internal=True)
def omega4_squared(omega4: Any) -> Any:
    """Square of the output link's angular velocity."""
    return omega4 * omega4


@planar_4r.quantity(units="N", symbol="m_2 a_CG2x", source=REACTIONS, internal=True)
def p2_x(m2: Any, a_Ax: Any, alpha2: Any, omega2_squared: Any, AG_x: Any, AG_y: Any) -> Any:
    """Rate of momentum of the coupler, x."""
    return m2 * (a_Ax - alpha2 * AG_y - omega2_squared * AG_x)


@planar_4r.quantity(units="N", symbol="m_2 a_CG2y", source=REACTIONS, internal=True)
def p2_y(m2: Any, a_Ay: Any, alpha2: Any, omega2_squared: Any, AG_x: Any, AG_y: Any) -> Any:
    """Rate of momentum of the coupler, y."""
    return m2 * (a_Ay + alpha2 * AG_x - omega2_squared * AG_y)


@planar_4r.quantity(units="kg", symbol="m_3 G_3/a_3", source=CENTRES, internal=True)
def m3_G3_along(m3: Any, G3_along: Any) -> Any:
    """Mass times centre of the output link along its axis, over its length."""
    return m3 * G3_along


@planar_4r.quantity(units="kg", symbol="m_3 G_3/a_3", source=CENTRES, internal=True)
def m3_G3_across(m3: Any, G3_across: Any) -> Any:
    """Mass times centre of the output link across its axis, over its length."""
    return m3 * G3_across


@planar_4r.quantity(units="kg m", symbol="m_3 DG_3x", source=CENTRES, internal=True)
def m3_DG_x(m3_G3_along: Any, m3_G3_across: Any, DB_x: Any, DB_y: Any) -> Any:
    """Mass times centre of the output link from D, x."""
    return m3_G3_along * DB_x - m3_G3_across * DB_y


@planar_4r.quantity(units="kg m", symbol="m_3 DG_3y", source=CENTRES, internal=True)
def m3_DG_y(m3_G3_along: Any, m3_G3_across: Any, DB_x: Any, DB_y: Any) -> Any:
    """Mass times centre of the output link from D, y."""
    return m3_G3_along * DB_y + m3_G3_across * DB_x


@planar_4r.quantity(units="N", symbol="m_3 a_CG3x", source=REACTIONS, internal=True)
def p3_x(alpha4: Any, omega4_squared: Any, m3_DG_x: Any, m3_DG_y: Any) -> Any:
    """Rate of momentum of the output link, x."""
    return -(alpha4 * m3_DG_y + omega4_squared * m3_DG_x)


@planar_4r.quantity(units="N", symbol="m_3 a_CG3y", source=REACTIONS, internal=True)
def p3_y(alpha4: Any, omega4_squared: Any, m3_DG_x: Any, m3_DG_y: Any) -> Any:
    """Rate of momentum of the output link, y."""
    return alpha4 * m3_DG_x - omega4_squared * m3_DG_y


def about_pivot(inertia: Any, mass: Any, G_u: Any, G_v: Any) -> Any:
    """Moment of inertia of a link about its fixed pivot."""
    return inertia + mass * (G_u * G_u + G_v * G_v)


step = planar_4r.steps(units="kg m2", source=CENTRES)
step(
    about_pivot,
    "I1_O",
    "I_1O",
    "Moment of inertia of the crank about O",
    inertia="I1",
    mass="m1",
    G_u="G1_u",
    G_v="G1_v",
)
step(
    about_pivot,
    "I3_D",
    "I_3D",
    "Moment of inertia of the output link about D",
    inertia="I3",
    mass="m3",
    G_u="G3_u",
    G_v="G3_v",
)


@planar_4r.quantity(units="N m", symbol="M_2", source=REACTIONS, internal=True)
def moment2_A(I2: Any, alpha2: Any, AG_x: Any, AG_y: Any, p2_x: Any, p2_y: Any) -> Any:
    """Rate of moment of momentum of the coupler about A, A held."""
    return I2 * alpha2 + cross(AG_x, AG_y, p2_x, p2_y)


@planar_4r.quantity(units="m-1", symbol="unit/(2 a_1 a_4)", source=REACTIONS, internal=True)
def unit_per_2_a1_a4(s1: Any, s4: Any, per_unit: Any) -> Any:
    """Power of two at or below the longest link over twice crank times ground."""
    return 0.5 / s1 / s4 * per_unit


@planar_4r.quantity(units="kg m", symbol="I_3D unit/(2 a_1 a_4)", source=REACTIONS, internal=True)
def I3_D_per_2_a1_a4(I3_D: Any, unit_per_2_a1_a4: Any) -> Any:
    """Moment of inertia about D over twice crank times ground, times that power of two."""
    return I3_D * unit_per_2_a1_a4


@planar_4r.quantity(units="N", symbol="M_2 unit/(AB x DB)", source=REACTIONS, internal=True)
def pull_along_DB(moment2_A: Any, unit_per_2_a1_a4: Any, per_sigma: Any, branch_sign: Any) -> Any:
    """Force in the joint B along DB that balances the coupler's moment, for a length of that power of two."""
    return moment2_A * (branch_sign * (unit_per_2_a1_a4 * per_sigma))


@planar_4r.quantity(units="N", symbol="I_3D alpha_4 unit/(AB x DB)", source=REACTIONS, internal=True)
def pull_along_AB(alpha4: Any, I3_D_per_2_a1_a4: Any, per_sigma: Any, branch_sign: Any) -> Any:
    """Force in the joint B along AB that balances the output link's moment, for a length of that power of two."""
    return alpha4 * (branch_sign * (I3_D_per_2_a1_a4 * per_sigma))


@planar_4r.quantity(units="N", symbol="F_32x", source=REACTIONS)
def F32_x(pull_along_DB: Any, pull_along_AB: Any, AB_x: Any, DB_x: Any, per_unit: Any) -> Any:
    """Force of the output link on the coupler at B, x."""
    return (pull_along_DB * DB_x + pull_along_AB * AB_x) * per_unit


@planar_4r.quantity(units="N", symbol="F_32y", source=REACTIONS)
def F32_y(pull_along_DB: Any, pull_along_AB: Any, AB_y: Any, DB_y: Any, per_unit: Any) -> Any:
    """Force of the output link on the coupler at B, y."""
    return (pull_along_DB * DB_y + pull_along_AB * AB_y) * per_unit


@planar_4r.quantity(units="N", symbol="F_21x", source=REACTIONS)
def F21_x(F32_x: Any, p2_x: Any) -> Any:
    """Force of the coupler on the crank at A, x."""
    return F32_x - p2_x


@planar_4r.quantity(units="N", symbol="F_21y", source=REACTIONS)
def F21_y(F32_y: Any, p2_y: Any) -> Any:
    """Force of the coupler on the crank at A, y."""
    return F32_y - p2_y


@planar_4r.quantity(units="N", symbol="F_41x", source=REACTIONS)
def F41_x(F21_x: Any, p1_x: Any) -> Any:
    """Force of the ground on the crank at O, x."""
    return p1_x - F21_x


@planar_4r.quantity(units="N", symbol="F_41y", source=REACTIONS)
def F41_y(F21_y: Any, p1_y: Any) -> Any:
    """Force of the ground on the crank at O, y."""
    return p1_y - F21_y


@planar_4r.quantity(units="N", symbol="F_43x", source=REACTIONS)
def F43_x(F32_x: Any, p3_x: Any) -> Any:
    """Force of the ground on the output link at D, x."""
    return p3_x + F32_x


@planar_4r.quantity(units="N", symbol="F_43y", source=REACTIONS)
def F43_y(F32_y: Any, p3_y: Any) -> Any:
    """Force of the ground on the output link at D, y."""
    return p3_y + F32_y


@planar_4r.quantity(units="N m", symbol="T_41", source=REACTIONS)
def T41(A_x: Any, A_y: Any, F21_x: Any, F21_y: Any) -> Any:
    """Driving torque of the ground on the crank."""
    return A_y * F21_x - A_x * F21_y


def force_magnitude(x: Any, y: Any) -> Any:
    """Length of a vector."""
    return magnitude(x, y)


force = planar_4r.quantities(units="N", source=REACTIONS)
force(
    force_magnitude, "F41", "|F_41|", "Force of the ground on the crank at O, magnitude", x="F41_x", y="F41_y"
)
force(
    force_magnitude,
    "F21",
    "|F_21|",
    "Force of the coupler on the crank at A, magnitude",
    x="F21_x",
    y="F21_y",
)
force(
    force_magnitude,
    "F32",
    "|F_32|",
    "Force of the output link on the coupler at B, magnitude",
    x="F32_x",
    y="F32_y",
)
force(
    force_magnitude,
    "F43",
    "|F_43|",
    "Force of the ground on the output link at D, magnitude",
    x="F43_x",
    y="F43_y",
)


@planar_4r.quantity(units="W", symbol="P_in", source=f"{REACTIONS}, T_41 omega_1")
def input_power(T41: Any, omega1: Any) -> Any:
    """Power of the driving torque."""
    return T41 * omega1
