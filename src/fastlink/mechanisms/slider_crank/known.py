"""Where the slider-crank's extremes are, in closed form, so that they need not be searched.

The slider turns back at its dead centres, where crank and rod are in line; with the crank along its own line the pin A
does; the rod passes pi where A stands on the line of the slider. The angles of the rod follow sin(theta) alone: their
extremes are where the crank stands square to the line, and at toggles. At the outer dead centre sin(theta) is
e/(l + r), and

    Z : C = l + r - e : l + r + e      p : q the other way round      p : C = l : r      Z : q = r : l

and at the inner one, e/(r - l), Z : C = p : q = l - r + e : l - r - e, times l/r for p and r/l for q.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fastlink.facts.fact import KnownExtremes
from fastlink.mechanisms.slider_crank.graded import EXTREMES
from fastlink.mechanisms.slider_crank.inputs import slider_crank
from fastlink.mechanisms.slider_crank.strokes import grashof_class  # noqa: F401 (on whose sums it builds)
from fastlink.numerics.elementary import NOT_A_NUMBER, select, sqrt

__all__: list[str] = []


@slider_crank.quantity(units="1", symbol="x", source=EXTREMES, internal=True)
def place_outer(
    reach_up: Any, reach_down: Any, s_r: Any, s_l: Any, Z0: Any, C0: Any, range_width: Any
) -> Any:
    """Root of the ratio of the distances from both ends at the outer dead centre."""
    low, high = Z0 > 0.0, C0 > 0.0
    one = select(low, select(high, reach_down, s_l), select(high, s_r, reach_up))
    other = select(low, select(high, reach_up, s_r), select(high, s_l, reach_down))
    return select(range_width > 0.0, sqrt(one / other), NOT_A_NUMBER)


@slider_crank.quantity(units="1", symbol="x", source=EXTREMES, internal=True)
def place_inner(
    sure_less_up: Any, sure_less_down: Any, s_r: Any, s_l: Any, Z0: Any, C0: Any, range_width: Any
) -> Any:
    """Root of the ratio of the distances from both ends at the inner dead centre; NaN where there is none."""
    low, high = Z0 > 0.0, C0 > 0.0
    one = select(low, select(high, 1.0, s_l), select(high, s_r, 1.0))
    other = select(low, select(high, 1.0, s_r), select(high, s_l, 1.0))
    root = sqrt(sure_less_up / sure_less_down) * sqrt(one / other)
    return select(range_width > 0.0, root, NOT_A_NUMBER)


@slider_crank.quantity(units="1", symbol="x", source=EXTREMES, internal=True)
def place_along(s_r: Any, s_l: Any, s_e: Any, Z0: Any, C0: Any, range_width: Any) -> Any:
    """Root of the ratio of the distances from both ends where the crank lies along the line of the slider."""
    one, other = select(Z0 > 0.0, s_l + s_e, s_r), select(C0 > 0.0, s_l - s_e, s_r)
    return select(range_width > 0.0, sqrt(one / other), NOT_A_NUMBER)


@slider_crank.quantity(units="1", symbol="x", source=EXTREMES, internal=True)
def place_on_line(s_r: Any, s_l: Any, s_e: Any, Z0: Any, C0: Any, range_width: Any) -> Any:
    """Root of the ratio of the distances from both ends where A stands on the line; NaN where it never does."""
    one, other = select(Z0 > 0.0, s_l, s_r - s_e), select(C0 > 0.0, s_l, s_r + s_e)
    reached = (range_width > 0.0) & (abs(s_e) <= s_r)
    return select(reached, sqrt(one / other), NOT_A_NUMBER)


assert slider_crank.graded is not None
slider_crank.graded = replace(
    slider_crank.graded,
    known={
        "slider_position": KnownExtremes({1: ("place_inner",), 2: ("place_outer",)}),
        "A_x": KnownExtremes({1: ("place_along",), 2: ("place_along",)}),
        "theta2": KnownExtremes(jumps={2: ("place_on_line",)}, exchanged=False),
        **dict.fromkeys(("transmission_angle", "A_y"), KnownExtremes()),
    },
)
