"""The 9x9 system of the joint reactions as eq. (9) prints it, ``solver="dense"``.

It is there to be compared with the elimination, in error and in time. r_ij runs from the mass centre of
link i to joint j: O, A, B, D are joints 1, 2, 3, 4.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import same, turned
from fastlink.mechanisms.planar_4r.forces import THETA1
from fastlink.mechanisms.planar_4r.inputs import HAYES, planar_4r
from fastlink.numerics.vectors import cross

EQUATION_9 = f"{HAYES}, eq. (9)"
UNKNOWNS = ("F41_x", "F41_y", "F21_x", "F21_y", "F32_x", "F32_y", "F43_x", "F43_y", "T41")
SHAKING = f"{HAYES}, section 5"


step = planar_4r.steps(units="N", source=EQUATION_9)
_G1 = {"u": "G1_u", "v": "G1_v", **THETA1}
step.vector(turned, "OG_*", "OG_1*", "Mass centre of the crank from O", **_G1, units="m")
step.vector(same, "joint_force2_*", "m_2 a_CG2*", "Sum of the joints' forces on the coupler", x="p2_*")


@planar_4r.quantity(units="N m", symbol="I_CG1 alpha_1", source=EQUATION_9, internal=True)
def couple1(a1: Any) -> Any:
    """Moment of the joints on the crank about its mass centre: zero at constant speed."""
    return 0.0 * a1


@planar_4r.quantity(units="N m", symbol="I_CG2 alpha_2", source=EQUATION_9, internal=True)
def couple2(I2: Any, alpha2: Any) -> Any:
    """Moment of the joints on the coupler about its mass centre."""
    return I2 * alpha2


step = planar_4r.steps(units="kg m2", source=EQUATION_9)
step(same, "I1_G", "I_CG1", "Moment of inertia of the crank about its mass centre", x="I1")
step(same, "I3_G", "I_CG3", "Moment of inertia of the output link about its mass centre", x="I3")


@planar_4r.quantity(units="N m", symbol="I_CG3 alpha_3", source=EQUATION_9, internal=True)
def couple3(I3_G: Any, alpha4: Any) -> Any:
    """Moment of the joints on the output link about its mass centre."""
    return I3_G * alpha4


@planar_4r.system("reactions", UNKNOWNS, variant="dense")
def reactions(
    OG_x: Any, OG_y: Any, A_x: Any, A_y: Any, AG_x: Any, AG_y: Any, AB_x: Any, AB_y: Any, DG_x: Any,
    DG_y: Any, DB_x: Any, DB_y: Any, p1_x: Any, p1_y: Any, joint_force2_x: Any, joint_force2_y: Any,
    p3_x: Any, p3_y: Any, couple1: Any, couple2: Any, couple3: Any,
) -> Any:  # fmt: skip
    """Rows and right-hand side of eq. (9)."""
    r11_x = -OG_x
    r11_y = -OG_y
    r12_x = A_x - OG_x
    r12_y = A_y - OG_y
    r22_x = -AG_x
    r22_y = -AG_y
    r23_x = AB_x - AG_x
    r23_y = AB_y - AG_y
    r33_x = DB_x - DG_x
    r33_y = DB_y - DG_y
    r34_x = -DG_x
    r34_y = -DG_y
    return (
        (1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, p1_x),
        (0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, p1_y),
        (-r11_y, r11_x, -r12_y, r12_x, 0.0, 0.0, 0.0, 0.0, 1.0, couple1),
        (0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, joint_force2_x),
        (0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, joint_force2_y),
        (0.0, 0.0, r22_y, -r22_x, -r23_y, r23_x, 0.0, 0.0, 0.0, couple2),
        (0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, p3_x),
        (0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0, p3_y),
        (0.0, 0.0, 0.0, 0.0, r33_y, -r33_x, -r34_y, r34_x, 0.0, couple3),
    )


def on_ground(x: Any, y: Any) -> Any:
    """Return minus the sum of two forces of the ground."""
    return -(x + y)


force = planar_4r.quantities(units="N", source=SHAKING, variant="dense")
_SHAKING = "Shaking force F14 + F34 on the ground"
force.vector(on_ground, "shaking_force_*", "F_*", _SHAKING, x="F41_*", y="F43_*")


@planar_4r.quantity(units="N m", symbol="M_O", source=SHAKING, variant="dense")
def shaking_moment(T41: Any, F43_y: Any, a4: Any) -> Any:
    """Shaking moment T14 + (a4, 0) x F34 on the ground about O."""
    return -T41 - a4 * F43_y


@planar_4r.quantity(units="N m", symbol="T_14 + r_34 x F_34", source=SHAKING, variant="dense")
def shaking_moment_printed(T41: Any, F43_x: Any, F43_y: Any, DG_x: Any, DG_y: Any) -> Any:
    """Shaking moment as printed, T14 + r34 x F34 with r34 from the output link's mass centre to D."""
    return cross(DG_x, DG_y, F43_x, F43_y) - T41
