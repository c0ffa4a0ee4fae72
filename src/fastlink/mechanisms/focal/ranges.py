"""What the motion of a focal mechanism reaches, in closed form: the four-bar's class and ranges, transmission angles.

The four-bar moves as without its completion, so its class and the ranges of its rockers are those of a planar 4R; with
the crank SF turning they are the same. Two opposite bars of a four-bar enclose an extreme angle where the other two are
parallel; that is how far phi - psi goes (MA and NB), and omega (MP and PF of the four-bar MSFP).
"""

from __future__ import annotations

from typing import Any

from fastlink.geometry import gap
from fastlink.jit import NOT_A_NUMBER, atan2, select, sqrt
from fastlink.mechanisms.borrow import borrow
from fastlink.mechanisms.focal.declare import DESIGN, WUNDERLICH, focal
from fastlink.mechanisms.focal.design_facts import FOUR_BAR, PREFIX
from fastlink.mechanisms.focal.status import FIRST_CHANGE_POINT, LAST_CHANGE_POINT
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.mechanisms.planar_4r.classes import CLASS_FLAGS

CLASS_MEANING = (
    "Type of the four-bar: crank MA, coupler AB, output link NB; what turns fully, or is the longest"
)
RANGE_MEANING = "reachable direction of {}, 0 to pi on either side of MN; the same where the crank SF drives"

borrow(
    focal,
    planar_4r,
    FOUR_BAR,
    PREFIX,
    {
        "grashof_class": {
            "meaning": CLASS_MEANING,
            "flags": {
                code: meaning.replace("_a1_a4", "_a_d").replace("_a1_a2", "_a_c")
                for code, meaning in CLASS_FLAGS.items()
            },
        },
        "grashof_excess": {},
        **{
            f"theta{number}_{end}": {
                "symbol": angle,
                "meaning": f"{size} {RANGE_MEANING.format(bar)}",
                "source": f"{DESIGN}#the-crank",
            }
            for number, angle, bar in ((1, "phi", "MA"), (4, "psi", "NB"))
            for end, size in (("low", "Least"), ("high", "Greatest"))
        },
    },
)


def least_acute_angle(e: Any, f: Any, g: Any, h: Any, grashof_class: Any, assembles: Any) -> Any:
    """Least angle in [0, pi/2] of the lines of e and f over the motion of a four-bar with g and h opposite."""
    # Of the triangle with the sides e, f and g - h, or g + h: squared half-angle sine and cosine over common factors.
    inner_a, _low = gap(abs(g), -abs(h), -abs(e), abs(f))
    inner_b, _low = gap(abs(g), -abs(h), abs(e), -abs(f))
    inner_c, _low = gap(abs(e), abs(f), abs(g), -abs(h))
    inner_d, _low = gap(abs(e), abs(f), -abs(g), abs(h))
    outer_a, _low = gap(abs(e), abs(f), -abs(g), -abs(h))
    outer_b, _low = gap(abs(e), abs(f), abs(g), abs(h))
    outer_c, _low = gap(abs(g), abs(h), -abs(e), abs(f))
    outer_d, _low = gap(abs(g), abs(h), abs(e), -abs(f))
    folds = (inner_a * inner_b <= 0.0) | (outer_a <= 0.0)
    folds = folds | ((grashof_class >= FIRST_CHANGE_POINT) & (grashof_class <= LAST_CHANGE_POINT))
    least = atan2(sqrt(inner_a * inner_b), sqrt(inner_c * inner_d))
    left = atan2(sqrt(outer_a * outer_b), sqrt(outer_c * outer_d))
    angle = select(folds, 0.0, 2.0 * select(least < left, least, left))
    known = (assembles == 1.0) & (e == e) & (g == g)
    return select(known, angle, NOT_A_NUMBER)


for _name, _bars, _meaning in (
    ("transmission_angle_F_least", ("s_a", "s_b", "s_c", "s_d"), "PF and QF, which is that of MA and NB"),
    ("transmission_angle_PQ_least", ("s_m", "s_p", "s_r", "s_s"), "MP and PF, which is that of NQ and QF"),
):
    focal.quantity(
        units="rad",
        symbol="mu",
        source=f"{WUNDERLICH}, section 6; {DESIGN}#the-crank",
        name=_name,
        meaning=f"Least acute angle between {_meaning}, over the whole motion",
        given=dict(zip("efgh", _bars, strict=True)),
    )(least_acute_angle)
