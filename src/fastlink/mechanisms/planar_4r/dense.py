"""The 9x9 system of the joint reactions as eq. (9) prints it, ``solver="dense"``.

It is there to be compared with the elimination, in error and in time.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import product, same
from fastlink.mechanisms.planar_4r.inputs import HAYES, LINKS, planar_4r
from fastlink.mechanisms.planar_4r.position import EQUATION_9
from fastlink.numerics.vectors import cross

UNKNOWNS = ("F41_x", "F41_y", "F21_x", "F21_y", "F32_x", "F32_y", "F43_x", "F43_y", "T41")
#: The right-hand side, vector b.
RIGHT_SIDE = (
    *("inertia_force1_x", "inertia_force1_y", "inertia_moment1"),
    *("inertia_force2_x", "inertia_force2_y", "inertia_moment2"),
    *("inertia_force3_x", "inertia_force3_y", "inertia_moment3"),
)
SHAKING = f"{HAYES}, section 5"


# -- vector b ----------------------------------------------------------------------------------------

force = planar_4r.quantities(units="N", source=EQUATION_9)
_B = "Inertia force of the {}: its mass times the acceleration of its mass centre, less the loads on it"
force.vector(same, "inertia_force1_*", "m_1 a_CG1*", _B.format(LINKS[1]), x="p1_*")
force.vector(same, "inertia_force2_*", "m_2 a_CG2*", _B.format(LINKS[2]), x="p2_*")
force.vector(same, "inertia_force3_*", "m_3 a_CG3*", _B.format(LINKS[3]), x="p3_*")


@planar_4r.quantity(units="N m", symbol="I_CG1 alpha_1", source=EQUATION_9)
def inertia_moment1(a1: Any) -> Any:
    """Inertia moment of the crank OA about its mass centre: zero at constant speed."""
    return 0.0 * a1


moment = planar_4r.quantities(units="N m", source=EQUATION_9)
_B = "Inertia moment of the {} about its mass centre, less the moment of the loads on it"
moment(product, "inertia_moment2", "I_CG2 alpha_2", _B.format(LINKS[2]), x="I2", y="alpha2")
moment(product, "inertia_moment3", "I_CG3 alpha_3", _B.format(LINKS[3]), x="I3_G", y="alpha4")

# -- the system --------------------------------------------------------------------------------------


@planar_4r.system("reactions", UNKNOWNS, variant="dense")
def reactions(
    r11_x: Any, r11_y: Any, r12_x: Any, r12_y: Any, r22_x: Any, r22_y: Any, r23_x: Any, r23_y: Any,
    r33_x: Any, r33_y: Any, r34_x: Any, r34_y: Any, inertia_force1_x: Any, inertia_force1_y: Any,
    inertia_force2_x: Any, inertia_force2_y: Any, inertia_force3_x: Any, inertia_force3_y: Any,
    inertia_moment1: Any, inertia_moment2: Any, inertia_moment3: Any,
) -> Any:  # fmt: skip
    """Rows and right-hand side of eq. (9)."""
    return (
        (1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, inertia_force1_x),
        (0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, inertia_force1_y),
        (-r11_y, r11_x, -r12_y, r12_x, 0.0, 0.0, 0.0, 0.0, 1.0, inertia_moment1),
        (0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, inertia_force2_x),
        (0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, inertia_force2_y),
        (0.0, 0.0, r22_y, -r22_x, -r23_y, r23_x, 0.0, 0.0, 0.0, inertia_moment2),
        (0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, inertia_force3_x),
        (0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0, inertia_force3_y),
        (0.0, 0.0, 0.0, 0.0, r33_y, -r33_x, -r34_y, r34_x, 0.0, inertia_moment3),
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
