"""Shaking force and shaking moment of the planar 4R.

They need no reaction at all: they are minus the rates of momentum and of moment of momentum, OG x m a_G without the
products of parallel vectors, as in `forces`.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import norm
from fastlink.mechanisms.planar_4r.inputs import HAYES, planar_4r

SHAKING = f"{HAYES}, section 5"


def minus_sum(p1: Any, p2: Any, p3: Any) -> Any:
    """Return minus the rate of momentum of all links."""
    return -(p1 + p2 + p3)


force = planar_4r.quantities(units="N", source=SHAKING)
_P = {f"p{link}": f"p{link}_*" for link in (1, 2, 3)}
_NET = {"x": "shaking_force_x", "y": "shaking_force_y"}
force.vector(minus_sum, "shaking_force_*", "F_*", "Shaking force F14 + F34 on the ground", **_P)
force(norm, "shaking_force", "|F|", "Shaking force on the ground, magnitude", **_NET)


@planar_4r.quantity(units="N m", symbol="dL_2/dt", source=SHAKING, internal=True)
def spin_rate2(
    I2: Any, m2: Any, alpha2: Any, coupler_ratio: Any, joint_ratio_2: Any, AG_x: Any, AG_y: Any, G2_x: Any,
    G2_y: Any, m2_omega1_squared: Any, A_cross_AG: Any,
) -> Any:  # fmt: skip
    """Rate of moment of momentum of the coupler about O."""
    centripetal = m2_omega1_squared * (((coupler_ratio + 1.0) * joint_ratio_2) * A_cross_AG)
    return alpha2 * (I2 + m2 * (AG_x * G2_x + AG_y * G2_y)) - centripetal


@planar_4r.quantity(units="N m", symbol="dL_3/dt", source=SHAKING, internal=True)
def spin_rate3(moment3_D: Any, a4: Any, p3_y: Any) -> Any:
    """Rate of moment of momentum of the output link about O."""
    return moment3_D + a4 * p3_y


@planar_4r.quantity(units="N m", symbol="M_O", source=SHAKING)
def shaking_moment(spin_rate2: Any, spin_rate3: Any) -> Any:
    """Shaking moment T14 + (a4, 0) x F34 on the ground about O."""
    return -(spin_rate2 + spin_rate3)


@planar_4r.quantity(units="N m", symbol="M", source=SHAKING)
def shaking_moment_at(shaking_moment: Any) -> Any:
    """Shaking moment on the ground about the point (M_x, M_y), O unless given."""
    return shaking_moment


@planar_4r.quantity(units="N m", symbol="DG_3 x p_3", source=SHAKING, internal=True)
def DG_cross_p3(alpha4: Any, DG_x: Any, DG_y: Any, m3_DG_x: Any, m3_DG_y: Any) -> Any:
    """Rate of moment of momentum about D of the output link's mass in its centre."""
    return alpha4 * (DG_x * m3_DG_x + DG_y * m3_DG_y)


@planar_4r.quantity(units="N m", symbol="T_14 + r_34 x F_34", source=SHAKING)
def shaking_moment_printed(
    T41: Any, pull_along_DB: Any, pull_along_AB: Any, moment3_D: Any, DG_along: Any, DG_across: Any,
    AB_x: Any, AB_y: Any, DB_x: Any, DB_y: Any, a3: Any, DG_cross_p3: Any, per_unit: Any,
) -> Any:  # fmt: skip
    """Shaking moment as printed, T14 + r34 x F34 with r34 from the output link's mass centre to D."""
    # DB x F32 is -moment3_D: a cross product of DB and AB would lose its digits where these align.
    F32_dot_DB = (pull_along_DB * (a3 * a3) + pull_along_AB * (AB_x * DB_x + AB_y * DB_y)) * per_unit
    return (DG_cross_p3 - (DG_along * moment3_D + DG_across * F32_dot_DB)) - T41
