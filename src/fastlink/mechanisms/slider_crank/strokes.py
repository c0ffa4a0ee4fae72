"""Facts of one design of the slider-crank, without any angle: class, ranges, dead centres, stroke, time ratio.

Dead centres are where crank and rod are in line: outer where they stretch, |OB| = l + r, inner where they overlap,
|OB| = |l - r|. Square roots are those of products of two sums of lengths, each right to a rounding.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fastlink.facts.fact import GradedRange, KnownExtremes
from fastlink.mechanisms._shared.laws import difference, product
from fastlink.mechanisms.planar_4r import graded as planar
from fastlink.mechanisms.planar_4r.classes import limit_root, twice_arctangent, unless_rounding
from fastlink.mechanisms.slider_crank.inputs import PAGE, slider_crank
from fastlink.mechanisms.slider_crank.motion import STATUS, TOGGLES
from fastlink.numerics.elementary import ANGLE_ROUNDING, NOT_A_NUMBER, PI, TWO_PI, atan2, select, sqrt

DEAD_CENTRES = f"{PAGE}#dead-centres"
CLASS_FLAGS = {
    0: "crank_turns_fully",
    1: "rod_turns_fully",
    2: "neither_turns_fully",
    3: "change_point",
    4: "change_point_isosceles",
    5: "never_assembles",
    6: "invalid_input",
}

step = slider_crank.steps(units="1", source=STATUS)
_surely = "zero within the rounding of the lengths"
step(unless_rounding, "sure_less_up", "l - r + e", f"l - r + e, {_surely}", factor="less_up")
step(unless_rounding, "sure_less_down", "l - r - e", f"l - r - e, {_surely}", factor="less_down")


@slider_crank.quantity(units="1", symbol="class", source=STATUS, flags=CLASS_FLAGS)
def grashof_class(sure_less_up: Any, sure_less_down: Any, assembles: Any, valid: Any) -> Any:
    """Type of the mechanism: what turns fully against the ground, which change point."""
    up, down = sure_less_up, sure_less_down
    code = select((up > 0.0) & (down > 0.0), 0.0, select((up < 0.0) & (down < 0.0), 1.0, 2.0))
    code = select((up == 0.0) | (down == 0.0), 3.0, code)
    code = select((up == 0.0) & (down == 0.0), 4.0, code)
    code = select(assembles == 1.0, code, 5.0)
    return select(valid == 1.0, code, 6.0)


@slider_crank.quantity(units="m", symbol="|e| - |l - r|", source=STATUS)
def grashof_excess(sure_less_up: Any, sure_less_down: Any, lift: Any, unit: Any, valid: Any) -> Any:
    """Shorter of crank and rod plus |e| minus the longer: negative where one turns fully, 0 at a change point."""
    up, down = abs(sure_less_up), abs(sure_less_down)
    alike = (sure_less_up > 0.0) == (sure_less_down > 0.0)
    size = select(up < down, up, down)
    return select(valid == 1.0, (select(alike, -size, size) + 0.0) * unit / lift, NOT_A_NUMBER)


@slider_crank.quantity(units="rad", symbol="theta", source=TOGGLES)
def theta_high(sure_less_up: Any, reach_down: Any, s_l: Any, s_e: Any, assembles: Any) -> Any:
    """Greatest reachable crank angle in [-pi/2, pi/2], pi/2 if no toggle is there; pi - theta on the other side."""
    toggle = atan2(s_e + s_l, sqrt(abs(sure_less_up)) * sqrt(reach_down))
    return select(assembles == 1.0, select(sure_less_up < 0.0, toggle, 0.5 * PI), NOT_A_NUMBER)


@slider_crank.quantity(units="rad", symbol="theta", source=TOGGLES)
def theta_low(sure_less_down: Any, reach_up: Any, s_l: Any, s_e: Any, assembles: Any) -> Any:
    """Least reachable crank angle in [-pi/2, pi/2], -pi/2 if no toggle is there; pi - theta on the other side."""
    toggle = atan2(s_e - s_l, sqrt(abs(sure_less_down)) * sqrt(reach_up))
    return select(assembles == 1.0, select(sure_less_down < 0.0, toggle, -0.5 * PI), NOT_A_NUMBER)


step = slider_crank.steps(units="1", source=TOGGLES)
_root = "square root of {}, scaled; 0 below zero"
for _name, _x, _of in (
    ("root_less_up", "sure_less_up", "l - r + e"),
    ("root_less_down", "sure_less_down", "l - r - e"),
    ("root_reach_up", "reach_up", "l + r - e"),
    ("root_reach_down", "reach_down", "l + r + e"),
):
    step(limit_root, _name, f"sqrt({_of})", _root.format(_of), x=_x, y="valid")

angle = slider_crank.quantities(units="rad", source=f"{PAGE}#transmission-angle")
_over = "transmission angle over the reachable range: at theta ="
angle(
    *(twice_arctangent, "transmission_angle_least", "mu", f"least {_over} pi/2, or 0 at a toggle"),
    sine="root_less_up",
    cosine="root_reach_up",
)
angle(
    *(twice_arctangent, "transmission_angle_greatest", "mu", f"greatest {_over} -pi/2, or pi at a toggle"),
    sine="root_reach_down",
    cosine="root_less_down",
)


# -- dead centres -------------------------------------------------------------------------------------------


@slider_crank.quantity(units="1", symbol="x_o", source=DEAD_CENTRES, internal=True)
def s_outer(reach_up: Any, reach_down: Any, assembles: Any) -> Any:
    """Distance of the outer dead centre from the foot of O, scaled."""
    return select(assembles == 1.0, sqrt(reach_up) * sqrt(reach_down), NOT_A_NUMBER)


@slider_crank.quantity(units="1", symbol="x_i", source=DEAD_CENTRES, internal=True)
def s_inner(sure_less_up: Any, sure_less_down: Any, assembles: Any) -> Any:
    """Distance of the inner dead centre from the foot of O, scaled; NaN where there is none."""
    product = sure_less_up * sure_less_down
    folds = (product >= 0.0) & (assembles == 1.0)
    root = sqrt(abs(sure_less_up)) * sqrt(abs(sure_less_down))
    return select(folds, root, NOT_A_NUMBER)


def in_metres(scaled: Any, lift: Any, unit: Any) -> Any:
    """Return a scaled length in metres."""
    return scaled * unit / lift


length = slider_crank.quantities(units="m", source=DEAD_CENTRES)
_foot = "dead centre from the foot of O on the line"
length(in_metres, "outer_dead_centre", "x_o", f"Distance of the outer {_foot}", scaled="s_outer")
length(
    *(in_metres, "inner_dead_centre", "x_i"),
    f"Distance of the inner {_foot}; NaN where rod and crank never overlap",
    scaled="s_inner",
)


@slider_crank.quantity(units="1", symbol="S", source=DEAD_CENTRES, internal=True)
def s_stroke(s_r: Any, s_l: Any, s_outer: Any, s_inner: Any, sure_less_up: Any, sure_less_down: Any) -> Any:
    """Distance between the slider's dead centres in one circuit, scaled."""
    # The squares of both distances differ by 4 r l: the difference of the distances does not cancel.
    between = 4.0 * (s_r * s_l) / (s_outer + s_inner)
    return select(sure_less_up * sure_less_down < 0.0, 2.0 * s_outer, between)


length(
    *(in_metres, "stroke", "S", "Stroke: distance between the slider's dead centres in one circuit"),
    scaled="s_stroke",
)


@slider_crank.quantity(units="1", symbol="crank turns", source=STATUS, internal=True)
def crank_turns(sure_less_up: Any, sure_less_down: Any, assembles: Any) -> Any:
    """1 where the crank turns fully and this is not a change point, else 0."""
    turns = (sure_less_up > 0.0) & (sure_less_down > 0.0) & (assembles == 1.0)
    return select(turns, 1.0, 0.0)


@slider_crank.quantity(units="rad", symbol="theta_o", source=DEAD_CENTRES)
def theta_outer(crank_turns: Any, s_e: Any, s_outer: Any) -> Any:
    """Crank angle at the outer dead centre of branch 1, pi - theta in branch 2; NaN unless the crank turns fully."""
    return select(crank_turns == 1.0, atan2(s_e + 0.0, s_outer), NOT_A_NUMBER)


@slider_crank.quantity(units="rad", symbol="theta_i", source=DEAD_CENTRES)
def theta_inner(crank_turns: Any, s_e: Any, s_inner: Any) -> Any:
    """Crank angle at the inner dead centre of branch 1, pi - theta in branch 2; NaN unless the crank turns fully."""
    return select(crank_turns == 1.0, atan2(-s_e + 0.0, -s_inner), NOT_A_NUMBER)


@slider_crank.quantity(units="1", symbol="Q", source=DEAD_CENTRES)
def time_ratio(crank_turns: Any, s_e: Any, s_outer: Any, s_inner: Any, s_stroke: Any) -> Any:
    """Slow over quick stroke (quick return), at least 1; NaN unless the crank turns fully."""
    # The strokes take pi + beta and pi - beta; beta is the angle at O between both dead centres.
    beta = atan2(abs(s_e) * s_stroke, s_inner * s_outer + s_e * s_e)
    return select(crank_turns == 1.0, 1.0 + 2.0 * beta / (PI - beta), NOT_A_NUMBER)


# -- derivatives: those by the offset vanish with it, where generated ones cancel --------------------------------------


@slider_crank.quantity(units="1", symbol="|l - r|", source=DEAD_CENTRES, internal=True)
def s_folded(s_r: Any, s_l: Any) -> Any:
    """Distance OB at the inner dead centre, scaled."""
    return abs(s_l - s_r)


@slider_crank.quantity(units="1", symbol="neither", source=DEAD_CENTRES, internal=True)
def has_no_inner(sure_less_up: Any, sure_less_down: Any) -> Any:
    """1 where crank and rod never overlap, else 0."""
    return select(sure_less_up * sure_less_down < 0.0, 1.0, 0.0)


def outer_by_length(s_r: Any, s_l: Any, s_outer: Any) -> Any:
    """Derivative of the outer dead centre by the crank or the rod."""
    return (s_l + s_r) / s_outer


def inner_by_r(s_r: Any, s_l: Any, s_inner: Any) -> Any:
    """Derivative of the inner dead centre by the crank."""
    return (s_r - s_l) / s_inner


def inner_by_l(s_r: Any, s_l: Any, s_inner: Any) -> Any:
    """Derivative of the inner dead centre by the rod."""
    return (s_l - s_r) / s_inner


def dead_centre_by_e(s_e: Any, root: Any) -> Any:
    """Derivative of a dead centre by the offset."""
    return -(s_e / root)


def stroke_by_e(s_e: Any, s_outer: Any, s_inner: Any, s_stroke: Any, has_no_inner: Any) -> Any:
    """Derivative of the stroke by the offset."""
    return select(has_no_inner == 1.0, -2.0 * s_e / s_outer, s_e * s_stroke / (s_inner * s_outer))


def stroke_by_r(
    s_r: Any, s_l: Any, s_e: Any, s_outer: Any, s_inner: Any, s_folded: Any, has_no_inner: Any
) -> Any:
    """Derivative of the stroke by the crank: that of the shorter length, or of the longer."""
    shorter = (s_l + s_r) / s_outer + s_folded / s_inner
    between = (s_l + s_r) * s_inner + s_folded * s_outer
    longer = -4.0 * ((s_e / s_inner) * (s_e / s_outer)) * (s_r * s_l) / between
    return select(has_no_inner == 1.0, 2.0 * (s_l + s_r) / s_outer, select(s_r <= s_l, shorter, longer))


def transmission_by_l(u: Any, s_l: Any, x: Any, y: Any, lift: Any, unit: Any) -> Any:
    """Derivative of an extreme transmission angle by the rod; of one at a toggle there is none."""
    return select(x * y > 0.0, (u / s_l) / (x * y) * lift / unit, 0.0)


@slider_crank.quantity(units="1", symbol="r - e", source=TOGGLES, internal=True)
def s_above(s_r: Any, s_e: Any) -> Any:
    """Height of A over the line of the slider at theta = pi/2, scaled."""
    return s_r - s_e


@slider_crank.quantity(units="1", symbol="-r - e", source=TOGGLES, internal=True)
def s_below(s_r: Any, s_e: Any) -> Any:
    """Height of A over the line of the slider at theta = -pi/2, scaled."""
    return -(s_r + s_e)


derivative = slider_crank.derivatives("r")
derivative(outer_by_length, "outer_dead_centre")
derivative(inner_by_r, "inner_dead_centre")
derivative(stroke_by_r, "stroke")

derivative = slider_crank.derivatives("l")
derivative(outer_by_length, "outer_dead_centre")
derivative(inner_by_l, "inner_dead_centre")
derivative(stroke_by_r, "stroke", s_r="s_l", s_l="s_r")
_least, _greatest = "transmission_angle_least", "transmission_angle_greatest"
derivative(transmission_by_l, _least, u="s_above", x="root_less_up", y="root_reach_up")
derivative(transmission_by_l, _greatest, u="s_below", x="root_less_down", y="root_reach_down")

derivative = slider_crank.derivatives("e")
derivative(dead_centre_by_e, "outer_dead_centre", root="s_outer")
derivative(dead_centre_by_e, "inner_dead_centre", root="s_inner")
derivative(stroke_by_e, "stroke")


# -- The reachable range of the crank, graded as that of the planar 4R: where to look for extremes

# The mirror is that at the normal of the line: it exchanges theta and pi - theta, and the branches.


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
    scaled = f"scale of the graded samples, {at}"
    step(planar.grade, scale, "scale", scaled, near=near_end, width="range_width")
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


# -- Where the slider-crank's extremes are, in closed form, so that they need not be searched

# The slider turns back at its dead centres, where crank and rod are in line; with the crank along its own
# line the pin A does; the rod passes pi where A stands on the line of the slider. The angles of the rod
# follow sin(theta) alone: their extremes are where the crank stands square to the line, and at toggles. At
# the outer dead centre sin(theta) is e/(l + r), and
#
#     Z : C = l + r - e : l + r + e      p : q the other way round      p : C = l : r      Z : q = r : l
#
# and at the inner one, e/(r - l), Z : C = p : q = l - r + e : l - r - e, times l/r for p and r/l for q.


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
