"""Places of A, B and P in the ground frame where another joint than O is driven.

The facts of `by_joint` are in the frame of link k - 1, which is held there, and in which the ground moves: its
direction turns what is known of A and B back. The joint that is opposite to the driven one is straight at the toggles,
where B or A is on the line OD and moves without bound: its place is by half the angle of that joint.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fastlink.catalogue.catalogue import Catalogue
from fastlink.mechanisms._shared.laws import (
    opposite,
    opposite_product,
    quotient,
    same,
    total,
    turned,
)
from fastlink.mechanisms.planar_4r.inputs import planar_4r
from fastlink.mechanisms.planar_4r.position import POSITION

__all__ = ["PLACES", "POINT", "declare_places"]

#: The inputs of the coupler point, and what is offered.
POINT = ("P_u", "P_v")
PLACES = tuple(f"{name}_{xy}" for name in "ABP" for xy in "xy")


def opposite_quotient(x: Any, y: Any) -> Any:
    """Return -x/y."""
    return -(x / y)


def back_x(u: Any, v: Any, x: Any, y: Any) -> Any:
    """Return the first component of minus (u, v) in a frame whose first axis is (x, y): v y - u x."""
    return v * y - u * x


def back_y(u: Any, v: Any, x: Any, y: Any) -> Any:
    """Return the second component: -u y - v x."""
    return -(u * y) - v * x


def far_x(start: Any, length: Any, C: Any, S: Any) -> Any:
    """Return the coordinate along OD of the end of a link, by the squares of half its angle."""
    return start + length * (C - S)


def far_A_x(a1: Any, joint_C1: Any, joint_S1: Any) -> Any:
    """A from O, x, where B is driven."""
    return a1 * (joint_S1 - joint_C1)


def far_y(length: Any, Y: Any) -> Any:
    """Return the coordinate across OD of the end of a link, by half the sine of its angle."""
    return -2.0 * (length * Y)


def along_ground(a3: Any, a4: Any, Z: Any) -> Any:
    """B from O, x, where D is driven."""
    return (a4 - a3) + 2.0 * a3 * Z


back = back_x, back_y
TURN = {"x": "turn_x", "y": "turn_y"}
CRANK = {"u": "driven_A_x", "v": "driven_A_y"}
AB, DB = {"u": "AB_x", "v": "AB_y"}, {"u": "DB_x", "v": "DB_y"}


def declare_places(driven: Catalogue, joint: int) -> None:
    """Declare the places where joint 2, 3 or 4 is driven, after the facts of the joints."""
    step = driven.steps(units="1", source=POSITION)
    place = driven.quantities(units="m", source=planar_4r.facts["A_x"].source)
    ground = "The turn from the frame of the held link to that of the ground"
    A, B, coupler = "Moving pivot A", "Moving pivot B", "Vector from A to B in the ground frame"
    if joint == 2:
        step(quotient, "turn_x", "t_x", f"{ground}, cosine", x="DB_x", y="a4")
        step(opposite_quotient, "turn_y", "t_y", f"{ground}, sine", x="DB_y", y="a4")
        place.vector(opposite_product, "A_*", "A_*", A, x="a1", y="turn_*")
        place(far_x, "B_x", "B_x", f"{B}, x", C="joint_C4", S="joint_S4", length="a3", start="a4")
        place(far_y, "B_y", "B_y", f"{B}, y", Y="joint_Y4", length="a3")
        step.vector(turned, "coupler_*", "AB_*", coupler, units="m", **CRANK, **TURN)
    elif joint == 3:
        step(opposite_quotient, "turn_x", "t_x", f"{ground}, cosine", x="AB_x", y="a4")
        step(quotient, "turn_y", "t_y", f"{ground}, sine", x="AB_y", y="a4")
        step(total, "from_O", "BO", "From B to O along AB", x="a2", y="DB_x", units="m")
        place(far_A_x, "A_x", "A_x", f"{A}, x")
        place(far_y, "A_y", "A_y", f"{A}, y", Y="joint_Y1", length="a1")
        place.vector(back, "B_*", "B_*", B, u="from_O", v="DB_y", **TURN)
        step.vector(opposite_product, "coupler_*", "AB_*", coupler, units="m", x="a2", y="turn_*")
    else:
        step(opposite, "turn_x", "t_x", f"{ground}, cosine", x="cos_theta1")
        step(same, "turn_y", "t_y", f"{ground}, sine", x="sin_theta1")
        place.vector(turned, "A_*", "A_*", A, **AB, **TURN)
        place(along_ground, "B_x", "B_x", f"{B}, x")
        place(opposite, "B_y", "B_y", f"{B}, y", x="AD_v")
        step.vector(back, "coupler_*", "AB_*", coupler, units="m", **DB, **TURN)
    for name in ("P_along", "P_across"):
        driven.facts[name] = planar_4r.facts[name]
    on_coupler = {"u": "P_along", "v": "P_across", "x": "coupler_x", "y": "coupler_y"}
    step.vector(turned, "AP_*", "AP_*", "Vector from A to the coupler point", units="m", **on_coupler)
    place.vector(total, "P_*", "P_*", "Coupler point P", x="A_*", y="AP_*")
    for name in PLACES:
        driven.facts[name] = replace(driven.facts[name], meaning=planar_4r.facts[name].meaning)
