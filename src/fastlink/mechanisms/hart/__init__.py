"""Hart's straight-line linkage, as Wunderlich derives it from Burmester's focal mechanism.

Its facts stand in the sheets beside this file. M = (0, 0) and N = (d, 0) are fixed; MA and NB carry P and Q, AB joins
the two, and F hangs on PF and QF. Given are m = MP, n = NQ, d = MN, and kappa = PF/NQ = QF/MP = AB/MN.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import Input
from fastlink.facts.sheet import read_sheets
from fastlink.mechanisms._shared.borrow import ByOtherInput, borrow, borrow_range, borrow_tables
from fastlink.mechanisms._shared.picture import Bar, Guide, Picture, Point, joint
from fastlink.mechanisms.planar_4r import planar_4r

__all__ = ["DRIVEN", "PICTURE", "hart"]

WUNDERLICH = "Wunderlich"
POSITION = f"{WUNDERLICH}, eqs. (1.2) to (1.4); docs/wunderlich.md#numerics-of-the-six-bars"

hart = Catalogue(
    "hart",
    "Hart's straight-line linkage of six bars: F on bars from P and Q runs along a line perpendicular to MN",
    branches={
        1: "B to the right of the directed line from A to N",
        2: "B to the left of the directed line from A to N",
    },
    position=Input("phi", "rad", "phi", "direction of MA in the ground frame"),
)
hart.closes = ("sigma", "past_Z0", "past_C0")
hart.most_asked = (
    "F_y psi dF_y_dphi dpsi_dphi stroke line_x F_y_outer F_y_inner a b c p q status grashof_class is_kite "
    "F_deviation_max"
)
read_sheets(__file__, ("inputs",), hart)

# MABN, driven by MA, is a planar 4R, whose position and graded range it has.

PREFIX = "bar_"
#: The names of MABN's values as a planar 4R.
NAMES = {"a1": "size_a", "a2": "size_c", "a3": "size_b", "a4": "d"}
NAMES |= {"s1": "s_a", "s2": "s_c", "s3": "s_b", "s4": "s_d"}
NAMES |= {"theta1": "phi", "cos_theta1": "cos_phi", "sin_theta1": "sin_phi", "p": "past_Z0", "q": "past_C0"}
NAMES |= {"DB_x": "NB_x", "DB_y": "B_y", "theta4": "psi", "output_ratio": "dpsi_dphi"}
NAMES |= {
    name: name
    for name in ("sure_A1", "sure_B1", "sure_C1", "factor_A2", "factor_B2", "factor_C2", "factor_D2")
}
NAMES |= {
    name: name for name in ("Z", "Z_low", "C", "C_low", "Z0", "Z0_low", "C0", "C0_low", "sigma", "per_sigma")
}
NAMES |= {
    name: name
    for name in ("coupler_offset", "branch_sign", "output_offset", "gamma0", "crank_excess", "range_width")
}
NAMES |= {"kappa": "squares_excess", "AD_x": "AN_x", "assembles": "assembles", "valid": "valid"}
NAMES |= {name: name for name in ("A_x", "A_y", "AB_x", "AB_y", "grashof_class")}

borrow_tables(hart, planar_4r, NAMES)
read_sheets(__file__, ("motion",), hart)
LABELS: dict[str, dict[str, Any]] = {
    "A_x": {"source": POSITION},
    "A_y": {"source": POSITION},
    "AB_x": {},
    "AB_y": {},
    "DB_y": {"symbol": "B_y", "meaning": "Joint B, y", "source": POSITION, "internal": False},
    "theta4": {"symbol": "psi", "meaning": "Direction of NB in the ground frame", "source": POSITION},
    "output_ratio": {
        "symbol": "dpsi/dphi",
        "meaning": "Rate of the direction of NB by that of MA",
        "source": f"{WUNDERLICH}, eq. (2.4), differentiated",
        "internal": False,
    },
    "grashof_class": {
        "meaning": "Type of the four-bar MABN; with the crank MA, the coupler AB and the output link NB"
    },
}
borrow(hart, planar_4r, NAMES, PREFIX, LABELS)

borrow_range(
    hart,
    planar_4r,
    NAMES,
    PREFIX,
    not_differentiable=("F_x", "F_along_AB", "F_deviation", "closure_residual"),
    wraps_at={"psi": "B_y", "omega_angle": "sine_part"},
)

# -- driven by F itself along its line

by_line = ByOtherInput(
    hart,
    f"{hart.title}, driven by F along its line",
    branches={
        1: "F to the right of the directed line from M to P: omega from 0 to pi where kappa > 0",
        2: "F to the left of the directed line from M to P: omega from -pi to 0 where kappa > 0",
    },
    position=Input("F_y", "m", "y", "height of F over MN"),
    positions=(-1.0, 1.0, 401),
    instead=("dphi_dF_y", "dpsi_dF_y"),
)
by_line.inputs = hart.inputs


BAR_ERRORS = ("AB_error", "PF_error", "QF_error", "NB_error", "NQ_error")
read_sheets(__file__, ("by_line",), by_line)


@cache
def with_facts_of_hart() -> Catalogue:
    """Return the catalogue with the facts of the design as a whole, and those that measure the bars."""
    by_line.adopt_design_facts((*BAR_ERRORS, "closure_residual"))
    return by_line


#: Figs. 6 and 7 of Wunderlich.
PICTURE = Picture(
    points=(
        Point("M", 0.0, 0.0, "ground"),
        Point("N", "d", 0.0, "ground"),
        *(joint(name) for name in "ABPQF"),
        joint("PF_mid", "mark", group="ellipse", is_named=False),
    ),
    bars=(
        Bar("M N", {"M N": "d"}, is_ground=True),
        Bar("M P A", {"M A": "a", "M P": "m"}),
        Bar("N Q B", {"N B": "b", "N Q": "n"}),
        Bar("A B", {"A B": "c"}),
        Bar("P F", {"P F": "p"}),
        Bar("Q F", {"Q F": "q"}),
    ),
    guides=(Guide(x="line_x", group="line"),),
    traced={"path": "F", "ellipse": "PF_mid"},
    usual="path line",
    title="Hart's linkage, {grashof_class}, stroke {stroke}",
    spans={"F_y": ("F_y_outer", "F_y_outer")},
)

#: The same linkage driven by F along its line.
DRIVEN = {by_line.position.name: with_facts_of_hart}
