"""The focal mechanism of Burmester, after Wunderlich: its facts stand in the sheets beside this file.

The four-bar MABN stands on MN: M = (0, 0), N = (d, 0). Its rockers MA and NB carry P and Q at the distances m and n
from M and N (beyond the pivot where negative), and F hangs on PF = p and QF = q.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import GradedRange, Input, KnownExtremes
from fastlink.facts.sheet import read_sheets
from fastlink.mechanisms._shared.borrow import ByOtherInput, borrow, borrow_range, borrow_tables
from fastlink.mechanisms._shared.picture import Bar, Circle, Guide, Locus, Picture, Point, joint
from fastlink.mechanisms.planar_4r import planar_4r

__all__ = ["DRIVEN", "PICTURE", "focal"]

WUNDERLICH = "Wunderlich"
DESIGN = "docs/wunderlich.md"

#: The bars of the four-bar by the names of their lengths.
LINKS = {"a": "rocker MA", "b": "rocker NB", "c": "coupler AB", "d": "ground link MN"}

focal = Catalogue(
    "focal",
    "Burmester's focal mechanism: a planar four-bar MABN with a point F on bars from all four sides",
    branches={
        1: "B to the right of the directed line from A to N",
        2: "B to the left of the directed line from A to N",
    },
    position=Input("phi", "rad", "phi", "direction of MA in the ground frame"),
)
focal.closes = ("bar_sigma", "bar_p", "bar_q")
focal.most_asked = (
    "psi sigma dpsi_dphi dsigma_dphi F_x F_y T_x T_y T_straightness crank_type r m n p q phi_low phi_high "
    "least_transmission_angle transmission_angle_PQ_least status"
)
read_sheets(__file__, ("inputs",), focal)

# -- driven by the crank SF, a catalogue beside the one by the rocker MA: the sheet `both` holds for both

by_crank = ByOtherInput(
    focal,
    f"{focal.title}, driven by the crank SF",
    branches={
        1: "omega_angle from 0 to pi: P to the left of the directed line from M to F where m p > 0",
        2: "omega_angle from -pi to 0: P to the right of the directed line from M to F where m p > 0",
    },
    position=Input("sigma", "rad", "sigma", "direction of SF in the ground frame"),
    instead=("dphi_dsigma",),
)
by_crank.inputs, by_crank.variant_inputs = focal.inputs, focal.variant_inputs
TABLES = {"cos_theta1": "g_x", "sin_theta1": "g_y", "Z": "Z", "C": "C"}
borrow_tables(by_crank, planar_4r, TABLES)

# -- the four-bar MABN, a planar 4R: its design, position, class and graded range

LENGTHS = {"a1": "a", "a2": "c", "a3": "b", "a4": "d"}
SCALED = {f"s{length[1]}": f"s_{name}" for length, name in LENGTHS.items()}
FOUR_BAR = {**LENGTHS, **SCALED, "theta1": "phi", "theta4": "psi", "omega1": "omega"}
FOUR_BAR |= {name: name for name in ("valid", "unit", "assembles", "grashof_class", "grashof_excess")}
FOUR_BAR |= {
    "theta1_low": "phi_low",
    "theta1_high": "phi_high",
    "theta4_low": "psi_low",
    "theta4_high": "psi_high",
}
#: Before the names of all other facts that are the four-bar's.
PREFIX = "bar_"

OF_DESIGN: dict[str, dict[str, Any]] = {"valid": {}, "assembles": {}}
for _name, _here in SCALED.items():
    _meaning = f"scaled length of the {LINKS[_here[-1]]}"
    OF_DESIGN[_name] = {"symbol": _here, "meaning": _meaning, "source": f"{DESIGN}#numerics"}
FACTORS = (
    *(f"factor_{letter}{number}" for letter in "ABCD" for number in (1, 2)),
    *("sure_A1", "sure_B1", "sure_C1"),
)
NAMES = FOUR_BAR | {"cos_theta1": "u_x", "sin_theta1": "u_y", "DB_x": "NB_x", "DB_y": "NB_y"}
NAMES |= {
    "output_ratio": "dpsi_dphi",
    **{name: name for name in ("Z", "C", "Z_low", "C_low", "A_x", "A_y", "AB_x", "AB_y", "branch_sign")},
    **{name: name for name in ("from_low", "from_high", "side")},
}
borrow_tables(focal, planar_4r, NAMES)
DIRECTION_OF_NB = {
    "symbol": "psi",
    "meaning": "Direction of NB in the ground frame",
    "source": f"{WUNDERLICH}, eq. (2.2)",
}
RATIO = {
    "symbol": "d psi/d phi",
    "meaning": "Angular velocity of NB over that of MA",
    "source": f"{WUNDERLICH}, eq. (2.4), differentiated",
    "internal": False,
}
LABELS: dict[str, dict[str, Any]] = {"theta4": DIRECTION_OF_NB, "output_ratio": RATIO}
LABELS |= {name: {} for name in ("AB_x", "AB_y", "DB_x", "DB_y", "AB_v", "sigma", "per_sigma")}
CLASS_MEANING = (
    "Type of the four-bar; crank MA, coupler AB, output link NB: the bars that turn fully, or the longest"
)
RANGE_MEANING = "reachable direction of {}; 0 to pi on either side of MN, the same where the crank SF drives"

OF_CLASS: dict[str, dict[str, Any]] = {
    "grashof_class": {
        "meaning": CLASS_MEANING,
        "flags": {
            code: meaning.replace("_a1_a4", "_a_d").replace("_a1_a2", "_a_c")
            for code, meaning in planar_4r.facts["grashof_class"].flags.items()
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
}

POLES = (
    *("X_x", "X_y", "Y_x"),
    *(f"{points}_{part}" for points in ("PFQX", "SFTY", "PSQT") for part in ("x", "y", "radius")),
)

read_sheets(__file__, ("design_facts", "motion"), focal)
read_sheets(__file__, ("both",), focal, by_crank)
read_sheets(__file__, ("by_sigma",), by_crank)
borrow(focal, planar_4r, FOUR_BAR, PREFIX, OF_DESIGN | {name: {} for name in FACTORS} | OF_CLASS)
borrow(focal, planar_4r, NAMES, PREFIX, LABELS)
borrow_range(
    focal,
    planar_4r,
    NAMES,
    PREFIX,
    not_differentiable=("closure_residual", "F_path_residual", *POLES),
    wraps_at={
        "psi": "NB_y",
        "sigma": "MF_y",
        **dict.fromkeys(("omega_angle", "alpha", "beta", "chi"), "w_y"),
    },
)
by_crank.graded = GradedRange(
    antisymmetric=("side", "omega_sign"),
    vanishes_at_toggle="half_sine_omega",
    reciprocal="per_half_sine",
    bounded_factor="size_of_sine",
    vanish_at_one_end=(),
    not_differentiable=("closure_residual", "F_path_residual", *POLES),
    wraps_at={
        "phi": "u_y",
        "psi": "v_y",
        **dict.fromkeys(("omega_angle", "alpha", "beta", "chi"), "half_sine_omega"),
    },
    # the cosine of omega is linear in that of sigma
    known=dict.fromkeys(("omega_angle", "transmission_angle_P", "transmission_angle_Q"), KnownExtremes()),
)


@cache
def with_design_facts() -> Catalogue:
    """Return the catalogue of the crank with the facts of the design as a whole; after all declarations."""
    by_crank.adopt_design_facts()
    for chosen in focal.variant_inputs:
        by_crank.variants[chosen] = focal.variants[chosen]
    return by_crank


#: Figs. 1 to 5 of Wunderlich.
CENTRES, FOCUS = ("PFQX", "SFTY", "PSQT"), {"x": "F_x", "y": "F_y"}
PICTURE = Picture(
    points=(
        Point("M", 0.0, 0.0, "ground"),
        Point("N", "d", 0.0, "ground"),
        Point("S", "S_x", 0.0, "ground"),
        *(joint(name) for name in "ABPQTF"),
        joint("X", "mark", group="crossings"),
        Point("Y", "Y_x", 0.0, "mark", group="crossings"),
        *(joint(points, "mark", group="circles", is_named=False) for points in CENTRES),
    ),
    bars=(
        Bar("M S N", {"M N": "d"}, is_ground=True),
        Bar("M P A", {"M A": "a", "M P": "m"}),
        Bar("N Q B", {"N B": "b", "N Q": "n"}),
        Bar("A T B", {"A B": "c"}),
        Bar("P F", {"P F": "p"}),
        Bar("Q F", {"Q F": "q"}),
        Bar("S F", {"S F": "r"}),
        Bar("F T", {"F T": "FT"}),
    ),
    circles=(
        Circle("S", "r", group="path"),
        *(Circle(points, f"{points}_radius") for points in CENTRES),
    ),
    guides=(Guide(x="line_x", group="path"),),
    loci=(
        Locus("cubic", "focal.cubic_points", "points", "focal cubic", by="phi"),
        Locus("foci", "focal.inscribed_conics", "conic", "conic with the focus F", by="phi", given=FOCUS),
    ),
    traced={"path": "T"},
    usual="path cubic",
    title="focal mechanism, {grashof_class}",
)

#: The same mechanism by its other inputs.
DRIVEN = {by_crank.position.name: with_design_facts}
