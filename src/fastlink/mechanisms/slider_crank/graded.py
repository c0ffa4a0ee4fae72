"""The reachable range of the crank, graded as that of the planar 4R: where to look for extremes.

The mirror is that at the normal of the line: it exchanges theta and pi - theta, and the branches.
"""

from __future__ import annotations

from typing import Any

from fastlink.catalogue.catalogue import GradedRange
from fastlink.mechanisms._shared.laws import difference, product
from fastlink.mechanisms.planar_4r import graded as planar
from fastlink.mechanisms.slider_crank.inputs import PAGE, slider_crank
from fastlink.numerics.elementary import ANGLE_ROUNDING, NOT_A_NUMBER, PI, TWO_PI, atan2, select, sqrt

EXTREMES = f"{PAGE}#extremes"
#: Half the number of cells for what has at most two extremes: see the page.
SIMPLE = ("slider_position", "theta2", "omega2", "transmission_angle")


step = slider_crank.steps(units="1", source=EXTREMES)


@slider_crank.quantity(units="1", symbol="w", source=EXTREMES, internal=True)
def range_width(s_r: Any, s_l: Any, reach_up: Any, reach_down: Any, Z0: Any, C0: Any, assembles: Any) -> Any:
    """Width of the reachable range in Z; NaN where the design never assembles."""
    low = Z0 > 0.0
    high = C0 > 0.0
    one_end = select(low, reach_down, reach_up)
    width = select(low & high, s_l, 0.5 * one_end) / s_r
    return select(assembles == 1.0, select(low | high, width, 1.0), NOT_A_NUMBER)


def near(limit: Any) -> Any:
    """Distance in Z from an end of the range to the next singularity beyond it; 1 at a change point."""
    return select(limit == 0.0, 1.0, abs(limit))


def declare_end(end: str, limit: str, tabled: str, past: str) -> None:
    """Declare what grades the samples at one end of the range, and what is least there."""
    at = f"at the {end} end of the range"
    near_end, scale = f"near_{end}", f"scale_{end}"
    step(planar.above_zero, f"{tabled}_least", f"max({limit}, 0)", f"least {tabled} of the range", x=limit)
    step(planar.below_zero, f"{past}_least", f"max(-{limit}, 0)", f"least {past} of the range", x=limit)
    step(near, near_end, "near", f"distance to the next singularity, {at}", limit=limit)
    graded = f"scale of the graded samples, {at}"
    step(planar.grade, scale, "scale", graded, near=near_end, width="range_width")
    first = f"place of the first sample, {at}"
    step(planar.first_place, f"start_{end}", "start", first, limit=limit, scale=scale)
    step(planar.is_toggle, f"toggle_{end}", "toggle", f"1 for a toggle, else 0, {at}", limit=limit)


declare_end("low", "Z0", "Z", "p")
declare_end("high", "C0", "C", "q")

slider_crank.graded = GradedRange(
    antisymmetric=("side", "branch_sign"),
    vanishes_at_toggle="sigma",
    reciprocal="per_sigma",
    bounded_factor="sine_mu",
    cells=dict.fromkeys(SIMPLE, 16),
    max_extrema=dict.fromkeys(SIMPLE, 2),
    not_differentiable=("loop_residual",),
    wraps_at={"theta2": "AB_y"},
    axis=PI / 2,
)


@slider_crank.quantity(units="1", symbol="2 r/l", source=EXTREMES, internal=True)
def sine_scale(s_r: Any, s_l: Any) -> Any:
    """Sine of the transmission angle over sigma."""
    return 2.0 * (s_r / s_l)


def minus_cosine(side: Any, Z: Any, C: Any) -> Any:
    """Cosine of the crank angle: Z grows with the angle to the left of the normal through O."""
    return -side * (2.0 * sqrt(Z * C))


step(product, "sine_mu", "sin mu", "Sine of the transmission angle", x="sigma", y="sine_scale")

place = slider_crank.steps(units="1", source=EXTREMES, variant="graded")
for _name, _fraction in (("Z", "from_low"), ("p", "from_low"), ("C", "from_high"), ("q", "from_high")):
    _meaning = f"{_name} at a place of the graded range"
    place(planar.from_end, _name, _name, _meaning, least=f"{_name}_least", fraction=_fraction)
place(minus_cosine, "cos_theta", "cos theta")
place(difference, "sin_theta", "sin theta", "Sine of the crank angle", x="C", y="Z")


@slider_crank.quantity(units="rad", symbol="theta", source=EXTREMES, internal=True, variant="graded")
def theta(side: Any, Z: Any, C: Any) -> Any:
    """Crank angle in [0, 2 pi), rounded."""
    angle = 0.5 * PI + side * (2.0 * atan2(sqrt(Z), sqrt(C)))
    turned = select(angle < 0.0, angle + TWO_PI, angle)
    # Without offset extremes stand at 0, and rounding must not make it a full turn.
    return select(abs(angle) <= PI * ANGLE_ROUNDING, 0.0, turned)
