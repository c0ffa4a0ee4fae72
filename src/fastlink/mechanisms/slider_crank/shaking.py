"""Shaking force and shaking moment of the slider-crank: minus the rates of momentum and of moment of momentum."""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import norm
from fastlink.mechanisms.slider_crank import forces  # noqa: F401 (declare the rates of momentum)
from fastlink.mechanisms.slider_crank.inputs import HAYES, PAGE, slider_crank

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
    m2: Any, m2_omega_squared: Any, one_less_H_squared: Any, A_cross_AG: Any, A_dot_AG: Any, alpha2: Any,
    I2_A: Any,
) -> Any:  # fmt: skip
    """Rate of moment of momentum of the connecting rod about O."""
    centripetal = m2_omega_squared * (one_less_H_squared * A_cross_AG)
    return centripetal + alpha2 * (m2 * A_dot_AG + I2_A)


@slider_crank.quantity(units="N m", symbol="M_O", source=SHAKING)
def shaking_moment(spin_rate2: Any, e: Any, p3_x: Any) -> Any:
    """Shaking moment T14 + OB x F34 on the ground about O."""
    return e * p3_x - spin_rate2
