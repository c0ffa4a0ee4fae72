"""Shaking force and shaking moment of the slider-crank: minus the rates of momentum and of moment of momentum."""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import norm
from fastlink.mechanisms.slider_crank import forces  # noqa: F401 (declare the rates of momentum)
from fastlink.mechanisms.slider_crank.inputs import HAYES, PAGE, slider_crank
from fastlink.numerics.elementary import select

SHAKING = f"{HAYES}, section 5; {PAGE}#shaking-force-and-moment"


@slider_crank.quantity(units="N", symbol="F_x", source=SHAKING)
def shaking_force_x(p1_x: Any, p2_x: Any, p3_x: Any) -> Any:
    """Shaking force F14 + F34 on the ground, x."""
    return -(p1_x + p2_x + p3_x)


@slider_crank.quantity(units="N", symbol="F_y", source=SHAKING)
def shaking_force_y(p1_y: Any, p2_y: Any) -> Any:
    """Shaking force F14 + F34 on the ground, y."""
    return -(p1_y + p2_y)


whole = slider_crank.quantities(units="N", source=SHAKING)
_x, _y = "shaking_force_x", "shaking_force_y"
whole(norm, "shaking_force", "|F|", "Shaking force on the ground, magnitude", x=_x, y=_y)


@slider_crank.quantity(units="N m", symbol="dL_2/dt", source=SHAKING, internal=True)
def spin_rate2(
    moment2_A: Any, m2_omega_squared: Any, AB_x_bend: Any, A_x: Any, A_y: Any, G2_along: Any, G2_across: Any,
    one_less_H_squared: Any, A_cross_AG: Any, A_dot_AG: Any, alpha2: Any, I2_A: Any, m2: Any,
) -> Any:  # fmt: skip
    """Rate of moment of momentum of the connecting rod about O."""
    # A x p2 without A x A; of a short rod, which B drags along, without what its turning leaves across the line, too.
    across = AB_x_bend * (G2_across * A_x - G2_along * A_y)
    dragged = moment2_A + m2_omega_squared * (across + A_y * (G2_along * A_x + G2_across * A_y))
    # Where the rod turns as the crank, folded onto it, what is left of both terms is little: 22 roundings were lost.
    carried = alpha2 * (I2_A + m2 * A_dot_AG) + m2_omega_squared * (one_less_H_squared * A_cross_AG)
    return select(abs(one_less_H_squared) < 0.5, carried, dragged)


@slider_crank.quantity(units="N m", symbol="M_O", source=SHAKING)
def shaking_moment(spin_rate2: Any, e: Any, p3_x: Any) -> Any:
    """Shaking moment T14 + OB x F34 on the ground about O."""
    return e * p3_x - spin_rate2
