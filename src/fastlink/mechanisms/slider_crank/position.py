"""Facts of position of the slider-crank: slider, rod, transmission angle, closure.

The cosine of the rod's angle is a root of l^2 - u^2 = 4 r^2 p q, of which p and q are differences from the toggles in
twice the working precision: nothing cancels, however near a toggle or a change point.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import difference, product
from fastlink.mechanisms.planar_4r import position as planar
from fastlink.mechanisms.slider_crank.inputs import PAGE, slider_crank
from fastlink.numerics.elementary import atan2, cos, select, sin, sqrt

POSITION = f"{PAGE}#position"


@slider_crank.table(symbol="cos theta", source=POSITION)
def cos_theta(theta: Any) -> Any:
    """Cosine of the crank angle."""
    return cos(theta)


@slider_crank.table(symbol="sin theta", source=POSITION)
def sin_theta(theta: Any) -> Any:
    """Sine of the crank angle."""
    return sin(theta)


@slider_crank.table(symbol="Z", source=POSITION, low="Z_low")
def Z(theta: Any) -> Any:
    """(1 - sin(theta))/2, as the square that does not cancel."""
    root = cos(theta / 2) - sin(theta / 2)
    return root * root / 2


@slider_crank.table(symbol="C", source=POSITION, low="C_low")
def C(theta: Any) -> Any:
    """(1 + sin(theta))/2, as the square that does not cancel."""
    root = cos(theta / 2) + sin(theta / 2)
    return root * root / 2


@slider_crank.quantity(units="1", symbol="s", source=POSITION, internal=True)
def branch_sign(branch: Any) -> Any:
    """1 for branch 1, -1 for branch 2."""
    return 3.0 - 2.0 * branch


step = slider_crank.steps(units="1", source=POSITION)
step(planar.p, "p", "p", "(l - u)/(2 r), u = r sin(theta) - e")
step(planar.q, "q", "q", "(l + u)/(2 r)")


@slider_crank.quantity(units="1", symbol="sigma", source=POSITION, internal=True)
def sigma(p: Any, q: Any) -> Any:
    """Length of the rod along the line over 2 r; NaN where the loop does not close."""
    # two roots: of a crank that is short enough the product overflows
    return sqrt(p) * sqrt(q)


point = slider_crank.quantities(units="m", source=POSITION)
point(product, "A_x", "A_x", "Crank pin A, x", x="r", y="cos_theta")
point(product, "A_y", "A_y", "Crank pin A, y", x="r", y="sin_theta")


@slider_crank.quantity(units="m", symbol="AB_x", source=POSITION, internal=True)
def AB_x(r: Any, sigma: Any, branch_sign: Any) -> Any:
    """Vector from A to B, x."""
    return branch_sign * (2.0 * (r * sigma))


step(difference, "AB_y", "AB_y", "Vector from A to B, y", x="e", y="A_y", units="m")


@slider_crank.quantity(units="1", symbol="AB_y/r", source=POSITION, internal=True)
def drop(s_e: Any, s_r: Any, sin_theta: Any) -> Any:
    """Vector from A to B, y, over the crank: p - q without its cancellation."""
    return s_e / s_r - sin_theta


@slider_crank.quantity(units="m", symbol="x", source=POSITION)
def slider_position(A_x: Any, AB_x: Any) -> Any:
    """Position of the slider B on its line, from the foot of O."""
    return A_x + AB_x


@slider_crank.quantity(units="rad", symbol="theta_2", source=POSITION)
def theta2(AB_x: Any, AB_y: Any) -> Any:
    """Direction of the connecting rod AB in the ground frame."""
    # + 0.0 turns -0.0 into 0.0, so that the straight angle is pi and never -pi.
    return atan2(AB_y + 0.0, AB_x)


@slider_crank.quantity(units="rad", symbol="mu", source=f"{PAGE}#transmission-angle")
def transmission_angle(p: Any, q: Any) -> Any:
    """Transmission angle: between the rod BA and the upward normal of the line of the slider."""
    return 2.0 * atan2(sqrt(p), sqrt(q))


@slider_crank.quantity(units="1", symbol="e", source=POSITION)
def loop_residual(
    A_x: Any, A_y: Any, AB_x: Any, AB_y: Any, slider_position: Any, s_r: Any, s_l: Any, s_e: Any, lift: Any,
    unit: Any,
) -> Any:  # fmt: skip
    """Closure error of the loop and of the length AB, relative to the longest of r, l and |e|."""
    x = AB_x * lift / unit
    y = AB_y * lift / unit
    rod_error = sqrt(x * x + y * y) - s_l
    error_x = (A_x + AB_x - slider_position) * lift / unit
    error_y = (A_y + AB_y) * lift / unit - s_e
    longest = select(s_r > s_l, s_r, s_l)
    longest = select(longest > abs(s_e), longest, abs(s_e))
    return sqrt(rod_error * rod_error + (error_x * error_x + error_y * error_y)) / longest
