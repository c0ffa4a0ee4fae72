"""Shaking force and shaking moment of the planar 4R.

They need no reaction at all: they are minus the rates of momentum and of moment of momentum.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import norm
from fastlink.mechanisms.planar_4r.centres import CENTRES
from fastlink.mechanisms.planar_4r.inputs import HAYES, planar_4r
from fastlink.numerics.vectors import cross

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
def spin_rate2(moment2_A: Any, A_x: Any, A_y: Any, p2_x: Any, p2_y: Any) -> Any:
    """Rate of moment of momentum of the coupler about O."""
    return moment2_A + cross(A_x, A_y, p2_x, p2_y)


@planar_4r.quantity(units="N m", symbol="dL_3/dt", source=SHAKING, internal=True)
def spin_rate3(I3_D: Any, alpha4: Any, a4: Any, p3_y: Any) -> Any:
    """Rate of moment of momentum of the output link about O."""
    return I3_D * alpha4 + a4 * p3_y


@planar_4r.quantity(units="N m", symbol="M_O", source=SHAKING)
def shaking_moment(spin_rate2: Any, spin_rate3: Any) -> Any:
    """Shaking moment T14 + (a4, 0) x F34 on the ground about O."""
    return -(spin_rate2 + spin_rate3)


@planar_4r.quantity(units="N m", symbol="M", source=SHAKING)
def shaking_moment_at(shaking_moment: Any) -> Any:
    """Shaking moment on the ground about the point (M_x, M_y), O unless given."""
    return shaking_moment


@planar_4r.quantity(units="m2", symbol="DG_3 x DB", source=CENTRES, internal=True)
def DG_cross_DB(G3_v: Any, a3: Any) -> Any:
    """Cross product of the output link's mass centre and B, both from D."""
    return -(G3_v * a3)


@planar_4r.quantity(units="N m", symbol="T_14 + r_34 x F_34", source=SHAKING)
def shaking_moment_printed(
    T41: Any, pull_along_DB: Any, pull_along_AB: Any, DG_cross_DB: Any, DG_x: Any, DG_y: Any, AB_x: Any,
    AB_y: Any, p3_x: Any, p3_y: Any, per_unit: Any,
) -> Any:  # fmt: skip
    """Shaking moment as printed, T14 + r34 x F34 with r34 from the output link's mass centre to D."""
    along_DB = pull_along_DB * per_unit
    along_AB = pull_along_AB * per_unit
    joint_B = along_DB * DG_cross_DB + along_AB * cross(DG_x, DG_y, AB_x, AB_y)
    return (joint_B + cross(DG_x, DG_y, p3_x, p3_y)) - T41
