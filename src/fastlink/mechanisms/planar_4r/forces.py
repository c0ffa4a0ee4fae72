"""Facts of force of the planar 4R: mass centres, joint reactions, shaking force and moment.

F_ij is the force of link i on link j, T41 the driving torque on the crank. The moments of links 3 and 2
give F32, everything else follows link by link; the divisor AB x DB is 2 a1 a4 sigma up to sign, which
keeps its digits at a toggle where a cross product of the vectors does not. The shaking force and moment
on the ground need no reaction at all: they are minus the rates of momentum and of moment of momentum.
"""

from __future__ import annotations

from typing import Any

from fastlink.geometry import cross
from fastlink.jit import sqrt
from fastlink.mechanisms.planar_4r.declare import HAYES, NUMERICS, planar_4r

REACTIONS = f"{HAYES}, eq. (9)"
CENTRES = f"{HAYES}, Fig. 2"
SHAKING = f"{HAYES}, section 5"


@planar_4r.quantity(units="rad2 s-2", symbol="omega_1^2", source=REACTIONS, internal=True)
def omega1_squared(omega1: Any) -> Any:
    """Square of the input speed."""
    return omega1 * omega1


@planar_4r.quantity(units="1", symbol="G_1u/a_1", source=CENTRES, internal=True)
def G1_along(G1_u: Any, a1: Any) -> Any:
    """Mass centre of the crank along its axis, over its length."""
    return G1_u / a1


@planar_4r.quantity(units="1", symbol="G_2u/a_2", source=CENTRES, internal=True)
def G2_along(G2_u: Any, a2: Any) -> Any:
    """Mass centre of the coupler along its axis, over its length."""
    return G2_u / a2


@planar_4r.quantity(units="1", symbol="G_3u/a_3", source=CENTRES, internal=True)
def G3_along(G3_u: Any, a3: Any) -> Any:
    """Mass centre of the output link along its axis, over its length."""
    return G3_u / a3


@planar_4r.quantity(units="1", symbol="G_1v/a_1", source=CENTRES, internal=True)
def G1_across(G1_v: Any, a1: Any) -> Any:
    """Mass centre of the crank across its axis, over its length."""
    return G1_v / a1


@planar_4r.quantity(units="1", symbol="G_2v/a_2", source=CENTRES, internal=True)
def G2_across(G2_v: Any, a2: Any) -> Any:
    """Mass centre of the coupler across its axis, over its length."""
    return G2_v / a2


@planar_4r.quantity(units="1", symbol="G_3v/a_3", source=CENTRES, internal=True)
def G3_across(G3_v: Any, a3: Any) -> Any:
    """Mass centre of the output link across its axis, over its length."""
    return G3_v / a3


@planar_4r.quantity(units="m", symbol="OG_1x", source=CENTRES, internal=True)
def OG_x(G1_along: Any, G1_across: Any, A_x: Any, A_y: Any) -> Any:
    """Mass centre of the crank from O, x."""
    return G1_along * A_x - G1_across * A_y


@planar_4r.quantity(units="m", symbol="OG_1y", source=CENTRES, internal=True)
def OG_y(G1_along: Any, G1_across: Any, A_x: Any, A_y: Any) -> Any:
    """Mass centre of the crank from O, y."""
    return G1_along * A_y + G1_across * A_x


@planar_4r.quantity(units="m", symbol="AG_2x", source=CENTRES, internal=True)
def AG_x(G2_along: Any, G2_across: Any, AB_x: Any, AB_y: Any) -> Any:
    """Mass centre of the coupler from A, x."""
    return G2_along * AB_x - G2_across * AB_y


@planar_4r.quantity(units="m", symbol="AG_2y", source=CENTRES, internal=True)
def AG_y(G2_along: Any, G2_across: Any, AB_x: Any, AB_y: Any) -> Any:
    """Mass centre of the coupler from A, y."""
    return G2_along * AB_y + G2_across * AB_x


@planar_4r.quantity(units="m", symbol="DG_3x", source=CENTRES, internal=True)
def DG_x(G3_along: Any, G3_across: Any, DB_x: Any, DB_y: Any) -> Any:
    """Mass centre of the output link from D, x."""
    return G3_along * DB_x - G3_across * DB_y


@planar_4r.quantity(units="m", symbol="DG_3y", source=CENTRES, internal=True)
def DG_y(G3_along: Any, G3_across: Any, DB_x: Any, DB_y: Any) -> Any:
    """Mass centre of the output link from D, y."""
    return G3_along * DB_y + G3_across * DB_x


@planar_4r.quantity(units="N", symbol="m_1 a_CG1x", source=REACTIONS, internal=True)
def p1_x(m1: Any, omega1_squared: Any, OG_x: Any) -> Any:
    """Rate of momentum of the crank, x."""
    return -(m1 * omega1_squared) * OG_x


@planar_4r.quantity(units="N", symbol="m_1 a_CG1y", source=REACTIONS, internal=True)
def p1_y(m1: Any, omega1_squared: Any, OG_y: Any) -> Any:
    """Rate of momentum of the crank, y."""
    return -(m1 * omega1_squared) * OG_y


@planar_4r.quantity(units="N", symbol="m_2 a_CG2x", source=REACTIONS, internal=True)
def p2_x(m2: Any, omega1_squared: Any, A_x: Any, alpha2: Any, omega2: Any, AG_x: Any, AG_y: Any) -> Any:
    """Rate of momentum of the coupler, x."""
    turning = -alpha2 * AG_y - omega2 * omega2 * AG_x
    return m2 * (turning - omega1_squared * A_x)


@planar_4r.quantity(units="N", symbol="m_2 a_CG2y", source=REACTIONS, internal=True)
def p2_y(m2: Any, omega1_squared: Any, A_y: Any, alpha2: Any, omega2: Any, AG_x: Any, AG_y: Any) -> Any:
    """Rate of momentum of the coupler, y."""
    turning = alpha2 * AG_x - omega2 * omega2 * AG_y
    return m2 * (turning - omega1_squared * A_y)


@planar_4r.quantity(units="N", symbol="m_3 a_CG3x", source=REACTIONS, internal=True)
def p3_x(m3: Any, alpha4: Any, omega4: Any, DG_x: Any, DG_y: Any) -> Any:
    """Rate of momentum of the output link, x."""
    return m3 * (-alpha4 * DG_y - omega4 * omega4 * DG_x)


@planar_4r.quantity(units="N", symbol="m_3 a_CG3y", source=REACTIONS, internal=True)
def p3_y(m3: Any, alpha4: Any, omega4: Any, DG_x: Any, DG_y: Any) -> Any:
    """Rate of momentum of the output link, y."""
    return m3 * (alpha4 * DG_x - omega4 * omega4 * DG_y)


@planar_4r.quantity(units="kg m2", symbol="I_3D", source=CENTRES, internal=True)
def I3_D(I3: Any, m3: Any, G3_u: Any, G3_v: Any) -> Any:
    """Moment of inertia of the output link about D."""
    return I3 + m3 * (G3_u * G3_u + G3_v * G3_v)


@planar_4r.quantity(units="N m", symbol="M_2", source=REACTIONS, internal=True)
def moment2_A(I2: Any, alpha2: Any, AG_x: Any, AG_y: Any, p2_x: Any, p2_y: Any) -> Any:
    """Moment about A that the joint B must give the coupler."""
    return I2 * alpha2 + cross(AG_x, AG_y, p2_x, p2_y)


@planar_4r.quantity(units="N m", symbol="M_3", source=REACTIONS, internal=True)
def moment3_D(I3_D: Any, alpha4: Any) -> Any:
    """Moment about D of the force of the output link on the coupler."""
    return -(I3_D * alpha4)


@planar_4r.quantity(units="m-2", symbol="1/(2 a_1 a_4)", source=REACTIONS, internal=True)
def per_2_a1_a4(a1: Any, a4: Any) -> Any:
    """Reciprocal of twice crank times ground."""
    return 0.5 / a1 / a4


@planar_4r.quantity(units="m-2", symbol="1/(AB x DB)", source=REACTIONS, internal=True)
def per_AB_cross_DB(per_2_a1_a4: Any, per_sigma: Any, branch_sign: Any) -> Any:
    """Reciprocal of the cross product of AB and DB."""
    return branch_sign * (per_2_a1_a4 * per_sigma)


@planar_4r.quantity(units="N", symbol="F_32x", source=REACTIONS)
def F32_x(moment2_A: Any, moment3_D: Any, AB_x: Any, DB_x: Any, per_AB_cross_DB: Any) -> Any:
    """Force of the output link on the coupler at B, x."""
    return (moment2_A * DB_x - moment3_D * AB_x) * per_AB_cross_DB


@planar_4r.quantity(units="N", symbol="F_32y", source=REACTIONS)
def F32_y(moment2_A: Any, moment3_D: Any, AB_y: Any, DB_y: Any, per_AB_cross_DB: Any) -> Any:
    """Force of the output link on the coupler at B, y."""
    return (moment2_A * DB_y - moment3_D * AB_y) * per_AB_cross_DB


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
    return -cross(A_x, A_y, F21_x, F21_y)


@planar_4r.quantity(units="N", symbol="F_x", source=SHAKING)
def shaking_force_x(p1_x: Any, p2_x: Any, p3_x: Any) -> Any:
    """Shaking force F14 + F34 on the ground, x."""
    return -(p1_x + p2_x + p3_x)


@planar_4r.quantity(units="N", symbol="F_y", source=SHAKING)
def shaking_force_y(p1_y: Any, p2_y: Any, p3_y: Any) -> Any:
    """Shaking force F14 + F34 on the ground, y."""
    return -(p1_y + p2_y + p3_y)


@planar_4r.quantity(units="N", symbol="|F|", source=SHAKING)
def shaking_force(shaking_force_x: Any, shaking_force_y: Any) -> Any:
    """Shaking force on the ground, magnitude."""
    return sqrt(shaking_force_x * shaking_force_x + shaking_force_y * shaking_force_y)


@planar_4r.quantity(units="N m", symbol="dL_2/dt", source=SHAKING, internal=True)
def spin_rate2(I2: Any, alpha2: Any, A_x: Any, A_y: Any, AG_x: Any, AG_y: Any, p2_x: Any, p2_y: Any) -> Any:
    """Rate of moment of momentum of the coupler about O."""
    return I2 * alpha2 + cross(A_x + AG_x, A_y + AG_y, p2_x, p2_y)


@planar_4r.quantity(units="N m", symbol="dL_3/dt", source=SHAKING, internal=True)
def spin_rate3(I3: Any, alpha4: Any, a4: Any, DG_x: Any, DG_y: Any, p3_x: Any, p3_y: Any) -> Any:
    """Rate of moment of momentum of the output link about O."""
    return I3 * alpha4 + cross(a4 + DG_x, DG_y, p3_x, p3_y)


@planar_4r.quantity(units="N m", symbol="M_O", source=SHAKING)
def shaking_moment(spin_rate2: Any, spin_rate3: Any) -> Any:
    """Shaking moment T14 + (a4, 0) x F34 on the ground about O."""
    return -(spin_rate2 + spin_rate3)
