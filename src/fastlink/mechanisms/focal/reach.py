"""Reach of the bars: where the crank SF stops, and the least transmission angles at P, Q and F.

omega, the angle of P and Q, is extreme where the crank lies in the ground line (`dyad`); phi - psi, that of F, where AB
is parallel to MN: there a, b and d - c, or d + c, make a triangle.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import opposite_product, product
from fastlink.mechanisms.focal.design_facts import PREFIX
from fastlink.mechanisms.focal.inputs import DESIGN, WUNDERLICH, focal
from fastlink.numerics.elementary import NOT_A_NUMBER, atan2, select, sqrt

CRANK = f"{WUNDERLICH}, section 6; {DESIGN}#the-crank"
CRANK_FLAGS = {
    0: "turns_fully",
    1: "stops_where_MPF_is_stretched",
    2: "stops_where_MPF_is_folded",
    3: "stops_where_MPF_is_stretched_and_where_it_is_folded",
    4: "passes_a_change_point",
    5: "no_crank",
}


@focal.quantity(units="1", symbol="crank", source=CRANK, internal=True)
def has_crank(status: Any) -> Any:
    """1 where there is a crank SF, else 0."""
    return select(status == 0.0, 1.0, 0.0)


@focal.quantity(units="1", symbol="change point", source=CRANK, internal=True)
def folds(grashof_class: Any) -> Any:
    """1 where all bars of the four-bar may lie in line, else 0."""
    # the change points of planar_4r.classes.CLASS_FLAGS
    return select((grashof_class >= 8.0) & (grashof_class <= 12.0), 1.0, 0.0)


@focal.quantity(units="1", symbol="crank", source=CRANK, flags=CRANK_FLAGS)
def crank_type(
    sine_at_0: Any, sine_at_pi: Any, cosine_at_0: Any, cosine_at_pi: Any, P_sign: Any, folds: Any,
    has_crank: Any,
) -> Any:  # fmt: skip
    """Whether the crank SF turns fully, and the position that stops it."""
    no_sine = (sine_at_0 < 0.0) | (sine_at_pi < 0.0)
    no_cosine = (cosine_at_0 < 0.0) | (cosine_at_pi < 0.0)
    # of m and p with one sign MPF is stretched at omega = pi, else at omega = 0
    at_pi = select(no_cosine, select(P_sign > 0.0, 1.0, 2.0), 0.0)
    at_0 = select(no_sine, select(P_sign > 0.0, 2.0, 1.0), 0.0)
    code = select(folds == 1.0, 4.0, at_pi + at_0)
    return select(has_crank == 1.0, code, 5.0)


def least_acute_angle(
    sine: Any, cosine: Any, other_sine: Any, other_cosine: Any, folds: Any, known: Any
) -> Any:
    """Least angle in [0, pi/2] between two lines, from numbers in proportion to both extremes of their half-angle."""
    steep, other_steep = sine > cosine, other_sine > other_cosine
    one = atan2(sqrt(select(steep, cosine, sine)), sqrt(select(steep, sine, cosine)))
    other = atan2(
        sqrt(select(other_steep, other_cosine, other_sine)),
        sqrt(select(other_steep, other_sine, other_cosine)),
    )
    aligns = (sine <= 0.0) | (cosine <= 0.0) | (other_sine <= 0.0) | (other_cosine <= 0.0)
    angle = select(aligns | (folds == 1.0), 0.0, 2.0 * select(one < other, one, other))
    return select(known == 1.0, angle, NOT_A_NUMBER)


#: Of the triangle with the sides a, b and d -+ c: squared half-angle sine and cosine between a and b, times 4 a b.
A1, A2, B1, B2, C1, C2, D1, D2 = (
    f"{PREFIX}factor_{name}" for name in ("A1", "A2", "B1", "B2", "C1", "C2", "D1", "D2")
)
_PARALLEL = "squared half-angle of MA and NB where AB is parallel to MN, over a common factor"
_ANTIPARALLEL = "squared half-angle of MA and NB where AB is antiparallel to MN, over a common factor"
step = focal.steps(units="1", source=CRANK)
step(opposite_product, "sine_parallel", "B1 C1", _PARALLEL, x=B1, y=C1)
step(product, "cosine_parallel", "A2 D2", _PARALLEL, x=A2, y=D2)
step(opposite_product, "sine_antiparallel", "B2 C2", _ANTIPARALLEL, x=B2, y=C2)
step(product, "cosine_antiparallel", "A1 D1", _ANTIPARALLEL, x=A1, y=D1)

_PQ = "Least acute angle between MP and PF, that of NQ and QF, over the whole motion"
_F = "Least acute angle between PF and QF, that of MA and NB, over the whole motion"
_ENDS = {
    "sine": "sine_at_0",
    "cosine": "cosine_at_0",
    "other_sine": "sine_at_pi",
    "other_cosine": "cosine_at_pi",
}
_SIDES = {"sine": "sine_parallel", "cosine": "cosine_parallel"}
_SIDES |= {"other_sine": "sine_antiparallel", "other_cosine": "cosine_antiparallel"}
least = focal.quantities(units="rad", source=CRANK)
least(least_acute_angle, "transmission_angle_PQ_least", "mu_PQ", _PQ, known="has_crank", **_ENDS)
least(least_acute_angle, "transmission_angle_F_least", "mu_F", _F, known="assembles", **_SIDES)
