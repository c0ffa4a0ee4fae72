"""Facts of one design of the slider-crank: scaled lengths, toggles, status.

The rod stands square to the line where u = r sin(theta) - e is l or -l: toggles, at which the branches meet. With
Z = (1 - sin(theta))/2 and C = (1 + sin(theta))/2

    l - u = 2 r (Z - Z0),    Z0 = (r - l - e)/(2 r)
    l + u = 2 r (C - C0),    C0 = (r - l + e)/(2 r)

which makes it a planar 4R whose pivot D is at infinity, across the line: see docs/numerics.md.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared import lengths
from fastlink.mechanisms.planar_4r.classes import STATUS_FLAGS
from fastlink.mechanisms.slider_crank.inputs import PAGE, slider_crank
from fastlink.numerics.compensated import UNIT_ROUNDING, gap_product_quotient, sum_of_four
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER, select
from fastlink.numerics.vectors import zero_where

SCALING = f"{PAGE}#scaling"
TOGGLES = f"{PAGE}#toggles"
STATUS = f"{PAGE}#status-and-class"


@slider_crank.quantity(units="1", symbol="valid", source=STATUS, internal=True)
def valid(r: Any, l: Any, e: Any) -> Any:
    """1 where both lengths are positive and finite and the offset is finite, else NaN."""
    lengths_are = (r > 0.0) & (l > 0.0) & (r < INFINITY) & (l < INFINITY)
    return select(lengths_are & (abs(e) < INFINITY), 1.0, NOT_A_NUMBER)


@slider_crank.quantity(units="m", symbol="|e|", source=SCALING, internal=True)
def size_e(e: Any) -> Any:
    """Distance of O from the line of the slider."""
    return abs(e)


_LENGTHS = {"a1": "r", "a2": "l", "a3": "size_e", "a4": "size_e"}
step = slider_crank.steps(units="1", source=SCALING)
step(lengths.lift, "lift", "lift", **_LENGTHS)
step(lengths.unit, "unit", "unit", units="m", **_LENGTHS)
step(lengths.scaled, "s_r", "s_r", "scaled length of the crank", length="r")
step(lengths.scaled, "s_l", "s_l", "scaled length of the connecting rod", length="l")
step(lengths.scaled, "s_e", "s_e", "scaled offset", length="e")


@slider_crank.quantity(units="1", symbol="u P", source=STATUS, internal=True)
def gap_rounding(s_r: Any, s_l: Any, s_e: Any) -> Any:
    """Effect of half a unit in the last place of each length on a sum of them: less is zero."""
    return UNIT_ROUNDING * (s_r + s_l + abs(s_e))


@slider_crank.quantity(units="1", symbol="l - r + e", source=TOGGLES, internal=True, low="less_up_low")
def less_up(s_r: Any, s_l: Any, s_e: Any) -> Any:
    """L - r + e, scaled, right to a rounding: positive where the crank passes theta = pi/2."""
    high, low = sum_of_four(s_l, -s_r, s_e, 0.0)
    return high, low


@slider_crank.quantity(units="1", symbol="l - r - e", source=TOGGLES, internal=True, low="less_down_low")
def less_down(s_r: Any, s_l: Any, s_e: Any) -> Any:
    """L - r - e, scaled, right to a rounding: positive where the crank passes theta = -pi/2."""
    high, low = sum_of_four(s_l, -s_r, -s_e, 0.0)
    return high, low


@slider_crank.quantity(units="1", symbol="l + r - e", source=TOGGLES, internal=True)
def reach_up(s_r: Any, s_l: Any, s_e: Any) -> Any:
    """L + r - e, scaled, right to a rounding; negative where the line is too high to be reached."""
    total, _low = sum_of_four(s_l, s_r, -s_e, 0.0)
    return total


@slider_crank.quantity(units="1", symbol="l + r + e", source=TOGGLES, internal=True)
def reach_down(s_r: Any, s_l: Any, s_e: Any) -> Any:
    """L + r + e, scaled, right to a rounding; negative where the line is too low to be reached."""
    total, _low = sum_of_four(s_l, s_r, s_e, 0.0)
    return total


def toggle(less: Any, less_low: Any, s_r: Any, gap_rounding: Any, valid: Any) -> Any:
    """Minus a gap over 2 r; negative if there is no toggle."""
    high, low = gap_product_quotient(-less, -less_low, 1.0, 0.0, 0.5, s_r)
    none = abs(less) <= gap_rounding
    return zero_where(none, high) * valid, zero_where(none, low)


step = slider_crank.steps(units="1", source=TOGGLES)
_at = "at the {} toggle, (r - l {} e)/(2 r); negative if none"
step(
    *(toggle, "Z0", "Z_0", f"(1 - sin(theta))/2 {_at.format('upper', '-')}"),
    low="Z0_low",
    less="less_up",
    less_low="less_up_low",
)
step(
    *(toggle, "C0", "C_0", f"(1 + sin(theta))/2 {_at.format('lower', '+')}"),
    low="C0_low",
    less="less_down",
    less_low="less_down_low",
)


@slider_crank.quantity(units="1", symbol="assembles", source=STATUS, internal=True)
def assembles(reach_up: Any, reach_down: Any, valid: Any) -> Any:
    """1 where the design assembles at some angle, else 0."""
    return select((reach_up < 0.0) | (reach_down < 0.0), 0.0, select(valid == 1.0, 1.0, 0.0))


@slider_crank.quantity(units="1", symbol="status", source=STATUS, flags=STATUS_FLAGS)
def status(
    less_up: Any, less_down: Any, reach_up: Any, reach_down: Any, gap_rounding: Any, assembles: Any, valid: Any
) -> Any:  # fmt: skip
    """How the design assembles over a full turn of the crank."""
    change_point = (abs(less_up) <= gap_rounding) | (abs(less_down) <= gap_rounding)
    turns = (less_up >= 0.0) & (less_down >= 0.0)
    rigid = (abs(reach_up) <= gap_rounding) | (abs(reach_down) <= gap_rounding)
    code = select(change_point, 3.0, select(turns, 0.0, 1.0))
    code = select(rigid, 5.0, code)
    code = select(assembles == 1.0, code, 2.0)
    return select(valid == 1.0, code, 4.0)
