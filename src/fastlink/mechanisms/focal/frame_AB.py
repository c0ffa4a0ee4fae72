"""The motion with AB held fixed (section 3): joints in the frame of AB, with its origin in A and its x-axis towards B.

With the directions u, v, e, g of `points` M is -a u/e there, and T = AT. F hangs on T and on P,

    F = AT -+ FT g = -((lambda - 1) m + p w) u/e,    - where rho is positive,

and alike from B by way of T and of Q. Of these the way with the shortest bars is taken: T is far away where rho
nears -1, P and Q where lambda nears 0, and F may be next to A (rho near 0) or B (rho large).
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.frame import ACROSS, ALONG, M_across, M_along, across, along
from fastlink.mechanisms._shared.laws import product
from fastlink.mechanisms.focal.by_crank import quantities, steps
from fastlink.mechanisms.focal.inputs import WUNDERLICH, focal
from fastlink.mechanisms.focal.joint_F import of_nearer, unless, where, whether_nearer
from fastlink.numerics.elementary import NOT_A_NUMBER, select

HELD = f"{WUNDERLICH}, sections 3 and 7"

seen = quantities(units="m", source=HELD)
seen(M_along, "M_along_AB", "M_AB", ALONG.format("M"))
seen(M_across, "M_across_AB", "M_AB", ACROSS.format("M"))
for _joint, _place in (("N", "d"), ("S", "S_x")):
    seen(along, f"{_joint}_along_AB", f"{_joint}_AB", ALONG.format(_joint), place=_place)
    seen(across, f"{_joint}_across_AB", f"{_joint}_AB", ACROSS.format(_joint), place=_place)

# -- F: from A by way of P or T, or from B by way of Q or T, whichever is shortest -----------------------------------


@focal.quantity(units="1", symbol="TB", source=HELD, internal=True)
def s_TB(s_c: Any, rho_plus_1: Any) -> Any:
    """Scaled distance of B from T along AB."""
    return s_c / rho_plus_1


step = focal.steps(units="1", source=HELD)
step(product, "s_AP", "AP", "Scaled length from P to A along MA", x="x", y="s_m")
step(product, "s_BQ", "BQ", "Scaled length from Q to B along NB", x="x", y="s_n")
step(product, "s_AT", "AT", "Scaled distance of T from A along AB", x="T_share", y="s_c")
_NEAR = "1 where T is nearer to {0} and F than {1} is, else 0"
_A, _B = "|AT| + FT < |AP|, |p|", "|TB| + FT < |BQ|, q"
step(whether_nearer, "near_T", _A, _NEAR.format("A", "P"), one="s_AT", two="s_FT", far="s_AP", other="s_p")
step(whether_nearer, "near_T_B", _B, _NEAR.format("B", "Q"), one="s_TB", two="s_FT", far="s_BQ", other="s_q")


@focal.quantity(units="1", symbol="FT", source=HELD, internal=True)
def FT_of_sign(ratio_sign: Any, s_FT: Any) -> Any:
    """Scaled length FT with the sign of rho."""
    return ratio_sign * s_FT


by_T, by_T_B = {"way": "near_T"}, {"way": "near_T_B"}
step(where, "held_AT", "AT", length="s_AT", **by_T)
step(where, "held_FT", "FT", length="FT_of_sign", **by_T)
step(unless, "held_AP", "AP", length="s_AP", **by_T)
step(unless, "held_p", "p", length="s_p", **by_T)
step(where, "held_TB", "TB", length="s_TB", **by_T_B)
step(where, "held_FT_B", "FT", length="FT_of_sign", **by_T_B)
step(unless, "held_BQ", "BQ", length="s_BQ", **by_T_B)
step(unless, "held_q", "q", length="s_q", **by_T_B)


@focal.quantity(units="1", symbol="BF < AF", source=HELD, internal=True)
def held_by_B(
    held_AT: Any, held_FT: Any, held_AP: Any, held_p: Any, held_TB: Any, held_FT_B: Any, held_BQ: Any,
    held_q: Any,
) -> Any:  # fmt: skip
    """1 where the way from B to F is shorter than that from A, else 0."""
    from_A = (abs(held_AT) + abs(held_FT)) + (abs(held_AP) + abs(held_p))
    from_B = (abs(held_TB) + abs(held_FT_B)) + (abs(held_BQ) + held_q)
    return select(from_B < from_A, 1.0, 0.0)


def start_along(held_by_B: Any, held_AT: Any, held_TB: Any, s_c: Any) -> Any:
    """Where the way to F begins along AB: A or B, or T."""
    return select(held_by_B == 1.0, s_c - held_TB, held_AT)


in_hand = {"way": "held_by_B"}
step(start_along, "held_start", "AT")
step(of_nearer, "seen_FT", "FT", near_N="held_by_B", from_M="held_FT", from_N="held_FT_B")
step(unless, "seen_AP", "AP", length="held_AP", **in_hand)
step(unless, "seen_p", "p", length="held_p", **in_hand)
step(where, "seen_BQ", "BQ", length="held_BQ", **in_hand)
step(where, "seen_q", "q", length="held_q", **in_hand)


def bars(seen_AP: Any, u: Any, seen_p: Any, f: Any, seen_BQ: Any, v: Any, seen_q: Any, h: Any) -> Any:
    """Return a component of the vector from F to A by way of P, or to B by way of Q."""
    return (seen_AP * u + seen_p * f) + (seen_BQ * v - seen_q * h)


def F_seen_along(
    held_start: Any, seen_FT: Any, g_x: Any, F_back_x: Any, F_back_y: Any, e_x: Any, e_y: Any, scale: Any
) -> Any:
    """Return how far F is along AB from A."""
    return scale * ((held_start - seen_FT * g_x) - (F_back_x * e_x + F_back_y * e_y))


def F_seen_across(
    seen_FT: Any, g_y: Any, F_back_x: Any, F_back_y: Any, e_x: Any, e_y: Any, scale: Any
) -> Any:
    """Return how far F is to the left of AB."""
    return scale * ((F_back_x * e_y - F_back_y * e_x) - seen_FT * g_y)


step = steps(units="1", source=HELD)
step.vector(bars, "F_back_*", "FA", "Vector from F to A or B, scaled", u="u_*", f="f_*", v="v_*", h="h_*")
seen = quantities(units="m", source=HELD)
seen(F_seen_along, "F_along_AB", "F_AB", ALONG.format("F"))
seen(F_seen_across, "F_across_AB", "F_AB", ACROSS.format("F"))


@focal.quantity(units="m", symbol="x_AB", source=f"{WUNDERLICH}, section 7")
def line_along_AB(s_a: Any, s_b: Any, s_c: Any, lambda_: Any, x: Any, rho_plus_1: Any, scale: Any) -> Any:
    """Place of the straight line that F moves on in the frame of AB, from A towards B; NaN unless rho is -1."""
    offset = (s_a - s_b) * (s_a + s_b) * x / (lambda_ * s_c)
    on_a_line = (rho_plus_1 == 0.0) & (lambda_ != 0.0)
    return select(on_a_line, 0.5 * (s_c + offset) * scale, NOT_A_NUMBER)
