"""Where angles of the planar 4R are greatest and least: closed forms, so that they need not be searched.

Each place is one where two links are in line or parallel, so that a triangle with two of the lengths and the sum or the
difference of the other two as its sides gives it: the output link turns back where OA and AB align, the coupler where
OA and DB are parallel, and an angle passes pi where its link points along the line that it is measured from.
The eight factors F of eq. (1) give Z, C, p and q there without a difference; with m the side that is a sum

    Z : C = F1 F2 : F3 F4      p : q = F2 F3 : F1 F4      p : C = r F2 : F4      Z : q = F2 : r F4

where r is the ratio of the link that turns to the crank; with m the side that is a difference

    Z : C = F1 F2 : F3 F4      p : q = F1 F4 : F2 F3      p : C = r F1 : F3      Z : q = F1 : r F3

The two of them that count are the distances from the ends of the range. On the side of theta1 from 0 to pi each place
is one of one branch; on the other side it is one of the other branch.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fastlink.facts.fact import KnownExtremes
from fastlink.mechanisms._shared.laws import opposite
from fastlink.mechanisms.planar_4r.graded import EXTREMES
from fastlink.mechanisms.planar_4r.inputs import planar_4r
from fastlink.numerics.elementary import NOT_A_NUMBER, select, sqrt


def root_of_ratio(
    low_part: Any, high_part: Any, one: Any, other: Any, turning: Any, fixed: Any, Z0: Any, C0: Any, range_width: Any
) -> Any:  # fmt: skip
    """Root of the ratio of the distances of a place from both ends; NaN if there is none."""
    low, high = Z0 > 0.0, C0 > 0.0
    above = select(low, select(high, one, turning), select(high, fixed, abs(other)))
    below = select(low, select(high, abs(other), fixed), select(high, turning, one))
    root = sqrt(low_part / high_part) * sqrt(above / below)
    return select(range_width > 0.0, root, NOT_A_NUMBER)


step = planar_4r.steps(units="1", source=EXTREMES)
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
