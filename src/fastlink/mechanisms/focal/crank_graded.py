"""The reachable range of sigma, graded as that of the planar 4R: MSFP is one, with the crank SF.

Of sin^2(omega/2) and cos^2(omega/2) one grows with Z = sin^2(sigma/2), from 0 at the lower toggle, and one falls, to 0
at the upper: they are |D| p and |D| q of the planar 4R, D being how much they change over half a turn.
"""

from __future__ import annotations

from typing import Any

from fastlink.catalogue.catalogue import GradedRange
from fastlink.facts.fact import KnownExtremes
from fastlink.mechanisms._shared.laws import difference
from fastlink.mechanisms.focal.by_crank import by_crank
from fastlink.mechanisms.focal.circles import POLES
from fastlink.mechanisms.focal.dyad import DYAD
from fastlink.mechanisms.planar_4r import graded
from fastlink.numerics.elementary import select

SIGMA = by_crank.position.name


def whether_sine_falls(sine_at_0: Any, sine_at_pi: Any) -> Any:
    """1 where sin^2(omega/2) falls with Z, else 0."""
    return select(sine_at_0 > sine_at_pi, 1.0, 0.0)


def whether_sine_grows(sine_falls: Any) -> Any:
    """1 where sin^2(omega/2) grows with Z, else 0."""
    return 1.0 - sine_falls


def of_both(sine_falls: Any, falling: Any, growing: Any) -> Any:
    """The falling or the growing one of two squares, that of the sine."""
    return select(sine_falls == 1.0, falling, growing)


def change_of_squares(sine_change: Any) -> Any:
    """|D|, how much sin^2(omega/2) changes over half a turn."""
    return abs(sine_change)


def minus_over(x: Any, change: Any) -> Any:
    """Minus a square over how much it changes: a toggle."""
    return -x / change


def range_width(Z0: Any, C0: Any, growing_at_pi: Any, falling_at_0: Any, change: Any) -> Any:
    """Width of the reachable range in Z."""
    low = Z0 > 0.0
    high = C0 > 0.0
    one_end = select(low, growing_at_pi / change, select(high, falling_at_0 / change, 1.0))
    return select(low & high, 1.0 / change, one_end)


def near(limit: Any) -> Any:
    """Distance in Z from an end of the range to the next singularity beyond it; 1 where the four-bar folds."""
    return select(limit == 0.0, 1.0, abs(limit))


def width_of_squares(change: Any, range_width: Any) -> Any:
    """How much the squares change over the range."""
    return change * range_width


def mixed(sine_falls: Any, sine_grows: Any, falling: Any, growing: Any) -> Any:
    """The falling or the growing one of two squares."""
    return sine_falls * falling + sine_grows * growing


step = by_crank.steps(units="1", source=DYAD)
step(whether_sine_falls, "sine_falls", "sine_falls")
step(whether_sine_grows, "sine_grows", "sine_grows")
step(change_of_squares, "change", "change")
step(of_both, "falling_at_0", "falling_at_0", falling="sine_at_0", growing="cosine_at_0")
step(of_both, "growing_at_0", "growing_at_0", falling="cosine_at_0", growing="sine_at_0")
step(of_both, "falling_at_pi", "falling_at_pi", falling="sine_at_pi", growing="cosine_at_pi")
step(of_both, "growing_at_pi", "growing_at_pi", falling="cosine_at_pi", growing="sine_at_pi")
step(minus_over, "Z0", "Z0", x="growing_at_0")
step(minus_over, "C0", "C0", x="falling_at_pi")
step(range_width, "range_width", "range_width")
step(width_of_squares, "width_of_squares", "width_of_squares")
step(graded.above_zero, "Z_least", "Z_least", x="Z0")
step(graded.above_zero, "C_least", "C_least", x="C0")
step(graded.above_zero, "growing_least", "growing_least", x="growing_at_0")
step(graded.above_zero, "falling_least", "falling_least", x="falling_at_pi")
step(near, "near_low", "near_low", limit="Z0")
step(near, "near_high", "near_high", limit="C0")
step(graded.grade, "scale_low", "scale_low", near="near_low", width="range_width")
step(graded.grade, "scale_high", "scale_high", near="near_high", width="range_width")
step(graded.first_place, "start_low", "start_low", limit="Z0", scale="scale_low")
step(graded.first_place, "start_high", "start_high", limit="C0", scale="scale_high")
step(graded.is_toggle, "toggle_low", "toggle_low", limit="Z0")
step(graded.is_toggle, "toggle_high", "toggle_high", limit="C0")

by_crank.graded = GradedRange(
    antisymmetric=("side", "omega_sign"),
    vanishes_at_toggle="half_sine_omega",
    reciprocal="per_half_sine",
    bounded_factor="size_of_sine",
    cells={},
    max_extrema={},
    not_differentiable=("closure_residual", "F_path_residual", *POLES),
    wraps_at={
        "phi": "u_y",
        "psi": "v_y",
        **dict.fromkeys(("omega_angle", "alpha", "beta", "chi"), "half_sine_omega"),
    },
    # the cosine of omega is linear in that of sigma
    known=dict.fromkeys(("omega_angle", "transmission_angle_P", "transmission_angle_Q"), KnownExtremes()),
)
step = by_crank.steps(units="1", source=DYAD, variant=by_crank.graded.name)
step(graded.from_end, "Z", "Z", least="Z_least", fraction="from_low")
step(graded.from_end, "C", "C", least="C_least", fraction="from_high")
_LOW = {"range_width": "width_of_squares", "fraction": "from_low"}
_HIGH = {"range_width": "width_of_squares", "fraction": "from_high"}
step(graded.from_end, "growing", "growing", least="growing_least", **_LOW)
step(graded.from_end, "falling", "falling", least="falling_least", **_HIGH)
step(mixed, "squared_half_sine", "squared_half_sine")
step(mixed, "squared_half_cosine", "squared_half_cosine", falling="growing", growing="falling")
step(difference, "g_x", "g_x", "Cosine of the input angle", x="C", y="Z")
step(graded.sin_theta1, "g_y", "g_y")
step(graded.theta1, SIGMA, SIGMA)
