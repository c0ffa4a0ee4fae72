"""The reachable range of sigma, graded as that of the planar 4R: MSFP is one, with the crank SF.

Of sin^2(omega/2) and cos^2(omega/2) one grows with Z = sin^2(sigma/2), from 0 at the lower toggle, and one falls, to 0
at the upper: they are |D| p and |D| q of the planar 4R, D being how much they change over half a turn.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastlink.catalogue.catalogue import GradedRange
from fastlink.mechanisms.focal.drives import by_crank
from fastlink.mechanisms.focal.dyad import DYAD
from fastlink.mechanisms.planar_4r import graded
from fastlink.numerics.elementary import select

SIGMA = by_crank.position.name


def declare(
    law: Callable[..., Any], name: str, given: dict[str, str] | None = None, alternative: str | None = None
) -> None:
    """Declare a step on the way."""
    by_crank.quantity(
        units="1", symbol=name, source=DYAD, internal=True, name=name, given=given, alternative=alternative
    )(law)


def whether_sine_falls(sine_at_0: Any, sine_at_pi: Any) -> Any:
    """1 where sin^2(omega/2) falls with Z, else 0."""
    return select(sine_at_0 > sine_at_pi, 1.0, 0.0)


def whether_sine_grows(sine_falls: Any) -> Any:
    """1 where sin^2(omega/2) grows with Z, else 0."""
    return 1.0 - sine_falls


def of_both(sine_falls: Any, falling: Any, growing: Any) -> Any:
    """The falling or the growing one of two squares: what sine is."""
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


declare(whether_sine_falls, "sine_falls")
declare(whether_sine_grows, "sine_grows")
declare(change_of_squares, "change")
for _place in ("at_0", "at_pi"):
    _squares = {"falling": f"sine_{_place}", "growing": f"cosine_{_place}"}
    declare(of_both, f"falling_{_place}", _squares)
    declare(of_both, f"growing_{_place}", {"falling": _squares["growing"], "growing": _squares["falling"]})
declare(minus_over, "Z0", {"x": "growing_at_0"})
declare(minus_over, "C0", {"x": "falling_at_pi"})
declare(range_width, "range_width")
declare(width_of_squares, "width_of_squares")
declare(graded.above_zero, "Z_least", {"x": "Z0"})
declare(graded.above_zero, "C_least", {"x": "C0"})
declare(graded.above_zero, "growing_least", {"x": "growing_at_0"})
declare(graded.above_zero, "falling_least", {"x": "falling_at_pi"})
for _end, _limit in (("low", "Z0"), ("high", "C0")):
    declare(near, f"near_{_end}", {"limit": _limit})
    declare(graded.grade, f"scale_{_end}", {"near": f"near_{_end}", "width": "range_width"})
    declare(graded.first_place, f"start_{_end}", {"limit": _limit, "scale": f"scale_{_end}"})
    declare(graded.is_toggle, f"toggle_{_end}", {"limit": _limit})

by_crank.graded = GradedRange(
    name="graded",
    ends=(("scale_low", "start_low", "toggle_low"), ("scale_high", "start_high", "toggle_high")),
    leaves=("from_low", "from_high", "side"),
    odd=("side", "omega_sign"),
    vanishing="half_sine_omega",
    inverse="per_half_sine",
    sine="size_of_sine",
    cells={},
    most={},
    rough=("closure_residual", "F_path_residual"),
    jumps={
        "phi": "u_y",
        "psi": "v_y",
        **dict.fromkeys(("omega_angle", "alpha", "beta", "chi"), "half_sine_omega"),
    },
)
_NAME = by_crank.graded.name
for _name, _least, _width, _fraction in (
    ("Z", "Z_least", "range_width", "from_low"),
    ("C", "C_least", "range_width", "from_high"),
    ("growing", "growing_least", "width_of_squares", "from_low"),
    ("falling", "falling_least", "width_of_squares", "from_high"),
):
    declare(graded.from_end, _name, {"least": _least, "range_width": _width, "fraction": _fraction}, _NAME)
declare(mixed, "squared_half_sine", alternative=_NAME)
declare(mixed, "squared_half_cosine", {"falling": "growing", "growing": "falling"}, _NAME)
declare(graded.cos_theta1, "g_x", alternative=_NAME)
declare(graded.sin_theta1, "g_y", alternative=_NAME)
declare(graded.theta1, SIGMA, alternative=_NAME)
