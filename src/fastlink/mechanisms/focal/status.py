"""Status of a design of the focal mechanism: whether there is a completion, and why not."""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms.focal.inputs import DESIGN, WUNDERLICH, focal
from fastlink.numerics.elementary import INFINITY, select

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


@focal.quantity(
    units="1", symbol="status", source=f"{WUNDERLICH}, sections 2 and 6; {DESIGN}#status", flags=STATUS_FLAGS
)
def status(
    rho: Any, x: Any, excess: Any, far_excess: Any, lambda_: Any, rho_plus_1: Any, completion: Any,
    assembles: Any, valid: Any,
) -> Any:  # fmt: skip
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
