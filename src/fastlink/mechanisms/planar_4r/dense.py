"""The 9x9 system of the joint reactions as eq. (9) prints it, ``solver="dense"``.

It is there to be compared with the elimination, in error and in time. r_ij runs from the mass centre of
link i to joint j: O, A, B, D are joints 1, 2, 3, 4.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms.planar_4r.declare import HAYES, planar_4r

UNKNOWNS = ("F41_x", "F41_y", "F21_x", "F21_y", "F32_x", "F32_y", "F43_x", "F43_y", "T41")
SHAKING = f"{HAYES}, section 5"


@planar_4r.system("reactions", UNKNOWNS, alternative="dense")
def reactions(
    G1_u: Any,
    G1_v: Any,
    cos_theta1: Any,
    sin_theta1: Any,
    A_x: Any,
    A_y: Any,
    AG_x: Any,
    AG_y: Any,
    AB_x: Any,
    AB_y: Any,
    G3_along: Any,
    G3_across: Any,
    DB_x: Any,
    DB_y: Any,
    p1_x: Any,
    p1_y: Any,
    p2_x: Any,
    p2_y: Any,
    p3_x: Any,
    p3_y: Any,
    I2: Any,
    I3: Any,
    alpha2: Any,
    alpha4: Any,
) -> Any:
    """Rows and right-hand side of eq. (9); the crank turns at constant speed, so I1 drops out."""
    OG_x = G1_u * cos_theta1 - G1_v * sin_theta1
    OG_y = G1_u * sin_theta1 + G1_v * cos_theta1
    DG_x = G3_along * DB_x - G3_across * DB_y
    DG_y = G3_along * DB_y + G3_across * DB_x
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
        (-r11_y, r11_x, -r12_y, r12_x, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0),
        (0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, p2_x),
        (0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, p2_y),
        (0.0, 0.0, r22_y, -r22_x, -r23_y, r23_x, 0.0, 0.0, 0.0, I2 * alpha2),
        (0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, p3_x),
        (0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0, p3_y),
        (0.0, 0.0, 0.0, 0.0, r33_y, -r33_x, -r34_y, r34_x, 0.0, I3 * alpha4),
    )


@planar_4r.quantity(units="N", symbol="F_x", source=SHAKING, alternative="dense")
def shaking_force_x(F41_x: Any, F43_x: Any) -> Any:
    """Shaking force F14 + F34 on the ground, x."""
    return -(F41_x + F43_x)


@planar_4r.quantity(units="N", symbol="F_y", source=SHAKING, alternative="dense")
def shaking_force_y(F41_y: Any, F43_y: Any) -> Any:
    """Shaking force F14 + F34 on the ground, y."""
    return -(F41_y + F43_y)


@planar_4r.quantity(units="N m", symbol="M_O", source=SHAKING, alternative="dense")
def shaking_moment(T41: Any, F43_y: Any, a4: Any) -> Any:
    """Shaking moment T14 + (a4, 0) x F34 on the ground about O."""
    return -T41 - a4 * F43_y
