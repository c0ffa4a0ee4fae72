"""The four-bar of a focal mechanism: its class and the ranges of its rockers, those of a planar 4R.

It moves as without its completion, so these are the ranges where the crank SF drives, too.
"""

from __future__ import annotations

from fastlink.mechanisms.borrow import borrow
from fastlink.mechanisms.focal.declare import DESIGN, focal
from fastlink.mechanisms.focal.design_facts import FOUR_BAR, PREFIX
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
