"""What becomes of a design of the focal mechanism: why there is no completion, and what stops the crank SF."""

from __future__ import annotations

from typing import Any

from fastlink.geometry import gap
from fastlink.jit import INFINITY, select
from fastlink.mechanisms.focal.declare import DESIGN, WUNDERLICH, focal
from fastlink.mechanisms.planar_4r.classes import CLASS_FLAGS

STATUS_FLAGS = {
    0: "completed",
    1: "no_real_lambda_or_rho",
    2: "p_q_and_r_imaginary",
    3: "F_on_a_straight_line",
    4: "lambda_is_0",
    5: "S_in_M_or_N",
    6: "four_bar_never_assembles",
    7: "invalid_input",
}
CRANK_FLAGS = {
    0: "turns_fully",
    1: "stops_where_MPF_is_stretched",
    2: "stops_where_MPF_is_folded",
    3: "stops_where_MPF_is_stretched_and_where_it_is_folded",
    4: "passes_a_change_point",
    5: "no_crank",
}
#: The change points among the classes of the four-bar.
FIRST_CHANGE_POINT, LAST_CHANGE_POINT = 8.0, 12.0
assert all(CLASS_FLAGS[code].startswith("change_point") for code in range(8, 13))


@focal.quantity(
    units="1", symbol="status", source=f"{WUNDERLICH}, sections 2 and 6; {DESIGN}#status", flags=STATUS_FLAGS
)
def status(
    rho: Any,
    x: Any,
    excess: Any,
    far_excess: Any,
    lambda_: Any,
    rho_plus_1: Any,
    completion: Any,
    assembles: Any,
    valid: Any,
) -> Any:
    """Whether the four-bar has this completion, and why not."""
    code = select(rho_plus_1 == 0.0, 3.0, 0.0)
    code = select(lambda_ == 0.0, 4.0, code)
    code = select(excess < 0.0, 1.0, code)
    code = select(excess < INFINITY, code, 7.0)
    code = select(assembles == 1.0, code, 6.0)
    code = select(far_excess < 0.0, 2.0, code)
    code = select((rho == 0.0) | (abs(rho) == INFINITY) | (x == 0.0), 5.0, code)
    known = (valid == 1.0) & ((completion == 1.0) | (completion == 2.0))
    return select(known, code, 7.0)


def beyond(s: Any, r: Any, m: Any, p: Any) -> Any:
    """|s| + r - |m| - |p|: positive where MPF, stretched, is too short for the crank."""
    high, _low = gap(abs(s), r, -abs(m), -abs(p))
    return high


def within(s: Any, r: Any, m: Any, p: Any) -> Any:
    """(|m| - |p|)^2 - (|s| - r)^2: positive where MPF, folded, is too long for the crank."""
    near, _low = gap(abs(m), -abs(p), -abs(s), r)
    far, _low = gap(abs(m), -abs(p), abs(s), -r)
    return near * far


for _law, _symbol in ((beyond, "|s| + r - |m| - |p|"), (within, "(|m| - |p|)^2 - (|s| - r)^2")):
    focal.quantity(
        units="1",
        symbol=_symbol,
        source=f"{DESIGN}#the-crank",
        internal=True,
        name=f"crank_{_law.__name__}",
        given={name: f"s_{name}" for name in "srmp"},
    )(_law)


@focal.quantity(
    units="1", symbol="crank", source=f"{WUNDERLICH}, section 6; {DESIGN}#the-crank", flags=CRANK_FLAGS
)
def crank_type(crank_beyond: Any, crank_within: Any, grashof_class: Any, status: Any) -> Any:
    """Whether the crank SF turns fully, and the dead centre that stops it."""
    stretched = select(crank_beyond > 0.0, 1.0, 0.0)
    folded = select(crank_within > 0.0, 2.0, 0.0)
    change_point = (grashof_class >= FIRST_CHANGE_POINT) & (grashof_class <= LAST_CHANGE_POINT)
    code = select(change_point, 4.0, stretched + folded)
    return select(status == 0.0, code, 5.0)
