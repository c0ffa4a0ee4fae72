"""Hart's linkage with AB held fixed (section 7): joints in the frame of AB, with its origin in A.

With E = u v w, the product of the directions of MP and NQ and of exp(i omega), and * for the conjugate

    AB = kappa d E,   F - A = -kappa E (F - N)*,   M - A = -a E (v w)*,   N - B = -b E (u w)*.

So F runs along a straight line perpendicular to AB, and is off AB |kappa| times as far as off MN.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.frame import ACROSS, ALONG, M_across, M_along, across, along
from fastlink.mechanisms._shared.laws import opposite_product, product, quotient, turned
from fastlink.mechanisms.hart.by_line import by_line
from fastlink.mechanisms.hart.inputs import WUNDERLICH, hart
from fastlink.numerics.elementary import NOT_A_NUMBER, select

HELD = f"{WUNDERLICH}, section 7"


@hart.quantity(units="m", symbol="x_AB", source=HELD)
def line_along_AB(K: Any, d: Any, line_x: Any) -> Any:
    """Place of the line of F in the frame of AB, from A towards B."""
    return K * (d - line_x)


def on_line(line_along_AB: Any, closes: Any) -> Any:
    """Return the place of the line where the linkage assembles."""
    return select(closes == closes, line_along_AB, NOT_A_NUMBER)


# -- driven by MA -----------------------------------------------------------------------------------------------

step = hart.steps(units="1", source=HELD)
step.vector(quotient, "e_*", "e_*", "Direction of AB", x="AB_*", y="size_c")
seen = hart.quantities(units="m", source=HELD)
MA = {"a": "size_a", "u_x": "cos_phi", "u_y": "sin_phi"}
seen(M_along, "M_along_AB", "M_AB", ALONG.format("M"), **MA)
seen(M_across, "M_across_AB", "M_AB", ACROSS.format("M"), **MA)
seen(along, "N_along_AB", "N_AB", ALONG.format("N"), place="d", **MA)
seen(across, "N_across_AB", "N_AB", ACROSS.format("N"), place="d", **MA)
seen(on_line, "F_along_AB", "F_AB", ALONG.format("F"), closes="B_y")
seen(product, "F_across_AB", "F_AB", ACROSS.format("F"), x="K", y="F_y")

# -- driven by F ------------------------------------------------------------------------------------------------


def less_bar(c: Any, b: Any, uw_x: Any) -> Any:
    """Return how far N is along AB from A, by way of B."""
    return abs(c) - b * uw_x


def off_AB(K: Any, F_y: Any, w_y: Any) -> Any:
    """Return how far F is to the left of AB where the linkage assembles."""
    return select(w_y == w_y, K * F_y, NOT_A_NUMBER)


step = by_line.steps(units="1", source=HELD)
step.vector(
    turned, "uw_*", "u w", "Direction of BN turned over, seen from AB", u="u_x", v="u_y", x="w_x", y="w_y"
)
step.vector(
    turned, "vw_*", "v w", "Direction of AM turned over, seen from AB", u="v_x", v="v_y", x="w_x", y="w_y"
)
seen = by_line.quantities(units="m", source=HELD)
seen(opposite_product, "M_along_AB", "M_AB", ALONG.format("M"), x="a", y="vw_x")
seen(product, "M_across_AB", "M_AB", ACROSS.format("M"), x="a", y="vw_y")
seen(less_bar, "N_along_AB", "N_AB", ALONG.format("N"))
seen(product, "N_across_AB", "N_AB", ACROSS.format("N"), x="b", y="uw_y")
seen(on_line, "F_along_AB", "F_AB", ALONG.format("F"), closes="w_y")
seen(off_AB, "F_across_AB", "F_AB", ACROSS.format("F"))
