"""The four-bar of a focal mechanism, a planar 4R: its class, the ranges of its rockers, and the graded range of phi.

It moves as without its completion, so its ranges are those where the crank SF drives, too.
"""

from __future__ import annotations

from fastlink.mechanisms._shared.reuse import KNOWN_OF_MABN, borrow, borrow_range
from fastlink.mechanisms.focal.circles import POLES
from fastlink.mechanisms.focal.design_facts import FOUR_BAR, PREFIX
from fastlink.mechanisms.focal.inputs import DESIGN, focal
from fastlink.mechanisms.focal.rocker import NAMES
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.mechanisms.planar_4r.classes import CLASS_FLAGS

CLASS_MEANING = (
    "Type of the four-bar: crank MA, coupler AB, output link NB; the bars that turn fully, or the longest"
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

_lent = planar_4r.graded
assert _lent is not None
borrow_range(
    focal,
    planar_4r,
    NAMES,
    PREFIX,
    cells={"psi": _lent.cells["theta4"], "dpsi_dphi": _lent.cells["omega4"]},
    max_extrema={"psi": _lent.max_extrema["theta4"], "dpsi_dphi": _lent.max_extrema["omega4"]},
    known=KNOWN_OF_MABN,
    not_differentiable=("closure_residual", "F_path_residual", *POLES),
    wraps_at={
        "psi": "NB_y",
        "sigma": "MF_y",
        **dict.fromkeys(("omega_angle", "alpha", "beta", "chi"), "w_y"),
    },
)
