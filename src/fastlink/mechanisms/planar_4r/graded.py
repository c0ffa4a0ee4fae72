"""The reachable range of the input, graded: where to look for extremes, and the position from there.

In Z the singularities lie at 0 and Z0 below, at 1 and 1 - C0 above; the reachable range runs from the upper of the
lower two to the lower of the upper two. A place in it is two fractions of its width, `from_low` and
`from_high`, and the side of the ground line. Everything that the position facts need is then a sum of
positive terms, without any trigonometric function and without the second word of Z and C.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from fastlink.facts.fact import GradedRange, KnownExtremes
from fastlink.mechanisms._shared.laws import difference, opposite, product
from fastlink.mechanisms.planar_4r.inputs import NUMERICS, planar_4r
from fastlink.mechanisms.planar_4r.position import IO_PRODUCTS
from fastlink.numerics.elementary import NOT_A_NUMBER, TWO_PI, atan2, select, sqrt

EXTREMES = f"{NUMERICS}#extremes"
#: Of the first sample's distance from a toggle: so close that the highest power of 1/sigma is all there is.
NEAR_TOGGLE = 2.0**-60

# Between extremes of a rate its derivative has the sign of a polynomial of degree 6 in tan^2(theta1/2): never more
# than one maximum and one minimum by branch; that of an acceleration is of degree 11: at most 5 were found.
MONOTONE = ("omega2", "omega4", "theta2", "theta4", "transmission_angle")
ACCELERATIONS = ("alpha2", "alpha4")


@planar_4r.quantity(units="1", symbol="w", source=EXTREMES, internal=True)
def range_width(
    s1: Any, s2: Any, s3: Any, s4: Any, factor_A2: Any, factor_B2: Any, factor_C2: Any, factor_D2: Any,
    Z0: Any, C0: Any, per_4_s1_s4: Any, assembles: Any,
) -> Any:  # fmt: skip
    """Width of the reachable range in Z; NaN where the design never assembles."""
    low = Z0 > 0.0
    high = C0 > 0.0
    both = 4.0 * (s2 * s3)
    width = select(
        low,
        select(high, both, factor_C2 * factor_D2),
        select(high, -(factor_A2 * factor_B2), 4.0 * (s1 * s4)),
    )
    return select(assembles == 1.0, width * per_4_s1_s4, NOT_A_NUMBER)


def above_zero(x: Any) -> Any:
    """Return x where it is positive, else 0."""
    return select(x > 0.0, x, 0.0)


def below_zero(x: Any) -> Any:
    """Return -x where x is negative, else 0."""
    return select(x < 0.0, -x, 0.0)


step = planar_4r.steps(units="1", source=EXTREMES)
step(above_zero, "Z_least", "max(Z_0, 0)", "least Z of the reachable range", x="Z0")
step(below_zero, "p_least", "max(-Z_0, 0)", "least p of the reachable range", x="Z0")
step(above_zero, "C_least", "max(C_0, 0)", "least C of the reachable range", x="C0")
step(below_zero, "q_least", "max(-C_0, 0)", "least q of the reachable range", x="C0")


def grade(near: Any, width: Any) -> Any:
    """Root of the distance to the next singularity beyond the end over that to the other end; 1 if none."""
    return select(near > 0.0, sqrt(near / (width + near)), 1.0)


@planar_4r.quantity(units="1", symbol="near", source=EXTREMES, internal=True)
def near_low(Z0: Any, gamma0: Any) -> Any:
    """Distance in Z from the lower end of the range to the next singularity below it."""
    return select(Z0 == 0.0, gamma0, abs(Z0))


@planar_4r.quantity(units="1", symbol="near", source=EXTREMES, internal=True)
def near_high(C0: Any) -> Any:
    """Distance in Z from the upper end of the range to the next singularity above it."""
    return abs(C0)


def first_place(limit: Any, scale: Any) -> Any:
    """Where samples begin: at the end of the range, or just before a toggle or fold."""
    return select(limit >= 0.0, NEAR_TOGGLE * scale, 0.0)


def first_place_low(limit: Any, scale: Any, gamma0: Any) -> Any:
    """Where samples begin at the lower end: minus that place in a kite, whose fold has no direction of AD."""
    place = NEAR_TOGGLE * scale
    return select(limit >= 0.0, select((limit == 0.0) & (gamma0 == 0.0), -place, place), 0.0)


def is_toggle(limit: Any) -> Any:
    """1 where the range ends at a toggle, else 0."""
    return select(limit > 0.0, 1.0, 0.0)


def declare_end(end: str, where: str, limit: str, first: Callable[..., Any]) -> None:
    """Declare the facts that grade the samples at one end of the range."""
    at = f"at the {where} end of the range"
    near, scale = f"near_{end}", f"scale_{end}"
    step(grade, scale, "scale", f"scale of the graded samples, {at}", near=near, width="range_width")
    step(first, f"start_{end}", "start", f"place of the first sample, {at}", limit=limit, scale=scale)
    step(is_toggle, f"toggle_{end}", "toggle", f"1 for a toggle, else 0, {at}", limit=limit)


declare_end("low", "lower", "Z0", first_place_low)
declare_end("high", "upper", "C0", first_place)

planar_4r.graded = GradedRange(
    antisymmetric=("side", "branch_sign"),
    vanishes_at_toggle="sigma",
    reciprocal="per_sigma",
    bounded_factor="sine_mu",
    cells=dict.fromkeys(MONOTONE, 16) | dict.fromkeys(ACCELERATIONS, 32),
    max_extrema=dict.fromkeys(MONOTONE, 2) | dict.fromkeys(ACCELERATIONS, 5),
    not_differentiable=(
        "loop_residual",
        "joint_angle_1",
        *(f"io_residual_{pair}" for pair in IO_PRODUCTS),
        *(f"v{k}{of}" for k in range(1, 5) for of in ("", "_dot", "_ddot")),
    ),
    wraps_at={"theta2": "AB_y", "theta4": "DB_y", "joint_angle_2": "AB_v", "joint_angle_4": "DB_y"},
    divisors={"curvature": ("curve_rate", 5)},  # (P' x P'')/|P'|^3
    turns={"load_torque": "omega4"},  # T_2 omega4 |omega4|
)


@planar_4r.quantity(units="1", symbol="2 a_1 a_4/(a_2 a_3)", source=EXTREMES, internal=True)
def sine_scale(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """Sine of the transmission angle over sigma."""
    return 2.0 * (s1 / s2) * (s4 / s3)


step(product, "sine_mu", "sin mu", "Sine of the transmission angle", x="sigma", y="sine_scale")


def from_end(least: Any, range_width: Any, fraction: Any) -> Any:
    """Least value and the part of the width."""
    return least + range_width * fraction


graded = planar_4r.steps(units="1", source=EXTREMES, variant="graded")
graded(from_end, "Z", "Z", "Z at a place of the graded range", least="Z_least", fraction="from_low")
graded(from_end, "p", "p", "p at a place of the graded range", least="p_least", fraction="from_low")
graded(from_end, "C", "C", "C at a place of the graded range", least="C_least", fraction="from_high")
graded(from_end, "q", "q", "q at a place of the graded range", least="q_least", fraction="from_high")


@planar_4r.quantity(units="1", symbol="sin theta_1", source=EXTREMES, internal=True, variant="graded")
def sin_theta1(side: Any, Z: Any, C: Any) -> Any:
    """Sine of the input angle."""
    return side * (2.0 * sqrt(Z * C))


graded(difference, "cos_theta1", "cos theta_1", "Cosine of the input angle", x="C", y="Z")


@planar_4r.quantity(units="rad", symbol="theta_1", source=EXTREMES, internal=True, variant="graded")
def theta1(side: Any, Z: Any, C: Any) -> Any:
    """Input angle in [0, 2 pi), rounded."""
    half_turn = 2.0 * atan2(sqrt(Z), sqrt(C))
    mirrored = select(half_turn > 0.0, TWO_PI - half_turn, 0.0)
    return select(side > 0.0, half_turn, mirrored)


# -- Where angles of the planar 4R are greatest and least: closed forms, so that they need not be searched

# Each place is one where two links are in line or parallel, so that a triangle with two of the lengths and
# the sum or the difference of the other two as its sides gives it: the output link turns back where OA and
# AB align, the coupler where OA and DB are parallel, and an angle passes pi where its link points along the
# line that it is measured from. The eight factors F of eq. (1) give Z, C, p and q there without a
# difference; with m the side that is a sum
#
#     Z : C = F1 F2 : F3 F4      p : q = F2 F3 : F1 F4      p : C = r F2 : F4      Z : q = F2 : r F4
#
# where r is the ratio of the link that turns to the crank; with m the side that is a difference
#
#     Z : C = F1 F2 : F3 F4      p : q = F1 F4 : F2 F3      p : C = r F1 : F3      Z : q = F1 : r F3
#
# The two of them that count are the distances from the ends of the range. On the side of theta1 from 0 to
# pi each place is one of one branch; on the other side it is one of the other branch.


def root_of_ratio(
    low_part: Any, high_part: Any, one: Any, other: Any, turning: Any, fixed: Any, Z0: Any, C0: Any, range_width: Any
) -> Any:  # fmt: skip
    """Root of the ratio of the distances of a place from both ends; NaN if there is none."""
    low, high = Z0 > 0.0, C0 > 0.0
    above = select(low, select(high, one, turning), select(high, fixed, abs(other)))
    below = select(low, select(high, abs(other), fixed), select(high, turning, one))
    root = sqrt(low_part / high_part) * sqrt(above / below)
    return select(range_width > 0.0, root, NOT_A_NUMBER)


step(opposite, "minus_A1", "-A_1", "-A1, zero within the rounding of the lengths", x="sure_A1")
step(opposite, "minus_B1", "-B_1", "-B1, zero within the rounding of the lengths", x="sure_B1")
A1, B1, C1 = "sure_A1", "sure_B1", "sure_C1"
A2, B2, C2, D1, D2 = "factor_A2", "factor_B2", "factor_C2", "factor_D1", "factor_D2"
# The name and what is in line there; the factors; the link that turns, and the one that it is compared with.
PLACES = (
    ("place_stretched", "OA and AB stretch", ("minus_B1", D1, C2, A2), ("s2", "s1")),
    ("place_folded", "AB folds onto OA", (A1, C1, D2, B2), ("s2", "s1")),
    ("place_output_back", "DB points from D to O", ("minus_A1", C1, C2, A2), ("s3", "s4")),
    ("place_output_on", "DB points away from O", (B1, D1, D2, B2), ("s3", "s4")),
    ("place_opposite", "OA and DB are opposite", ("minus_A1", D1, D2, A2), ("s3", "s1")),
    ("place_parallel", "OA and DB are parallel", (B1, C1, C2, B2), ("s3", "s1")),
    ("place_coupler_back", "AB points from D to O", (A1, D1, C2, B2), ("s2", "s4")),
)
PARAMETERS = ("low_part", "high_part", "one", "other", "turning", "fixed")
for _name, _where, _factors, _links in PLACES:
    _given = dict(zip(PARAMETERS, (*_factors, *_links), strict=True))
    step(
        root_of_ratio,
        _name,
        "x",
        f"root of the ratio of the distances from both ends where {_where}",
        **_given,
    )


def root_of_either(
    low_part: Any, high_part: Any, one: Any, other: Any, turning: Any, fixed: Any,
    one_else: Any, other_else: Any, turning_else: Any, fixed_else: Any, Z0: Any, C0: Any, range_width: Any
) -> Any:  # fmt: skip
    """As `root_of_ratio` of that of two places which there is: of the second one the ratio of factors is opposite."""
    ratio, low, high = low_part / high_part, Z0 > 0.0, C0 > 0.0
    first = ratio >= 0.0
    this, that = select(first, one, one_else), abs(select(first, other, other_else))
    turns, stays = select(first, turning, turning_else), select(first, fixed, fixed_else)
    above = select(low, select(high, this, turns), select(high, stays, that))
    below = select(low, select(high, that, stays), select(high, turns, this))
    root = sqrt(abs(ratio)) * sqrt(above / below)
    return select(range_width > 0.0, root, NOT_A_NUMBER)


# Of two places of one branch, with opposite ratios of factors, one exists: half as much to evaluate.
EITHER = (
    ("place_folded_or_back", PLACES[1], PLACES[2]),
    ("place_on_or_stretched", PLACES[3], PLACES[0]),
)
for _name, (_, _where, _factors, _links), (_, _else, _others, _other_links) in EITHER:
    _given = dict(zip(PARAMETERS, (*_factors, *_links), strict=True))
    _else_given = dict(zip(PARAMETERS, (*_others, *_other_links), strict=True))
    _given |= {f"{key}_else": _else_given[key] for key in PARAMETERS[2:]}
    _meaning = f"root of the ratio of the distances from both ends where {_where} or {_else}"
    step(root_of_either, _name, "x", _meaning, **_given)


@planar_4r.quantity(units="1", symbol="x", source=EXTREMES, internal=True)
def place_crosswise(Z0: Any, C0: Any) -> Any:
    """Root of the ratio of the distances from both ends where the crank stands across the ground link."""
    below, above = 0.5 - select(Z0 > 0.0, Z0, 0.0), 0.5 - select(C0 > 0.0, C0, 0.0)
    return sqrt(below / above)


REST_OF_OUTPUT = {1: ("place_folded",), 2: ("place_stretched",)}
OUTPUT = KnownExtremes(REST_OF_OUTPUT, {1: ("place_output_back",)})
COUPLER = KnownExtremes({1: ("place_opposite",), 2: ("place_parallel",)}, {1: ("place_coupler_back",)})
IN_GROUND_LINE = {1: ("place_output_back",), 2: ("place_output_on",)}
#: Where the output link rests or points along the ground link: of a place of each kind there is one.
ALONG = KnownExtremes({1: ("place_folded_or_back",), 2: ("place_on_or_stretched",)})
#: Z alone determines these, and they grow with it or fall.
AT_ENDS = dict.fromkeys(("transmission_angle", "joint_angle_3", "A_x"), KnownExtremes())

assert planar_4r.graded is not None
planar_4r.graded = replace(
    planar_4r.graded,
    known={
        **AT_ENDS,
        "A_y": KnownExtremes({1: ("place_crosswise",), 2: ("place_crosswise",)}),
        "B_x": ALONG,
        "theta4": OUTPUT,
        "joint_angle_4": OUTPUT,
        "theta2": COUPLER,
        "joint_angle_2": KnownExtremes(IN_GROUND_LINE, {1: ("place_folded",)}),
    },
)
