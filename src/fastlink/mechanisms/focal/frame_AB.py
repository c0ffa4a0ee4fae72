"""The motion with AB held fixed (section 3): joints in the frame of AB, with its origin in A and its x-axis towards B.

With the directions u, v, e, g of `points` M is -a u/e there, a point of MN at x is (x - a u)/e, or by way of B
c + (x - d - b v)/e: by the shorter bars, of which c is not across AB. T = AT. F hangs on T and on P,

    F = AT -+ FT g = -((lambda - 1) m + p w) u/e,    - where rho is positive,

of which the way with the shorter bars is taken: T is far away where rho nears -1, P where lambda nears 0.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.frame import ACROSS, ALONG, across
from fastlink.mechanisms._shared.laws import product
from fastlink.mechanisms.focal.by_crank import by_crank, quantities, steps
from fastlink.mechanisms.focal.inputs import WUNDERLICH, focal
from fastlink.mechanisms.focal.joint_F import unless, where, whether_nearer
from fastlink.numerics.elementary import NOT_A_NUMBER, select

HELD = f"{WUNDERLICH}, sections 3 and 7"

# -- joints of MN -----------------------------------------------------------------------------------------------------


def reach(place: Any, bar: Any) -> Any:
    """Return how long the way to a joint of MN is from an end of AB."""
    return abs(place) + bar


def shorter(by_B: Any, by_A: Any) -> Any:
    """1 where the way by B is the shorter one, else 0."""
    return select(by_B < by_A, 1.0, 0.0)


def shorter_with_AB(by_B: Any, by_A: Any, c: Any) -> Any:
    """1 where the way by B is the shorter one along AB, too, else 0."""
    return select(by_B + c < by_A, 1.0, 0.0)


def of_way(way: Any, by_B: Any, by_A: Any) -> Any:
    """Return what belongs to the way that is taken."""
    return select(way == 1.0, by_B, by_A)


def from_N(way: Any, back: Any) -> Any:
    """Return where M is, from the foot of the way that is taken."""
    return select(way == 1.0, -back, 0.0)


def from_M(way: Any, ahead: Any) -> Any:
    """Return where N is, from the foot of the way that is taken."""
    return select(way == 1.0, 0.0, ahead)


def from_either(way: Any, back: Any, ahead: Any) -> Any:
    """Return where a point between is, from the foot of the way that is taken."""
    return select(way == 1.0, -back, ahead)


def along_by(way: Any, c: Any, place: Any, bar: Any, x: Any, y: Any, e_x: Any, e_y: Any) -> Any:
    """Return how far a point of MN is along AB from A."""
    return select(way == 1.0, c, 0.0) + ((place - bar * x) * e_x - bar * y * e_y)


def across_or_by_F(
    place: Any, a: Any, u_x: Any, u_y: Any, e_x: Any, e_y: Any, F_x: Any, F_y: Any, QP_x: Any
) -> Any:
    """Return how far M is to the left of AB, by its rockers or by F, whichever terms are smaller."""
    # F is at -t F_y, the height of M over F F_x e_y - F_y e_x; by the crank F_y is a product of its own direction
    ahead, aside = (place - a * u_x) * e_y, a * u_y * e_x
    back, over = F_x * e_y, F_y * QP_x
    by_F = abs(back) + abs(over) < abs(ahead) + abs(aside)
    return select(by_F, back - over, -(ahead + aside))


step, lengths = steps(units="1", source=HELD), steps(units="m", source=HELD)
seen = quantities(units="m", source=HELD)
lengths(product, "SN", "SN", "Distance from S to N along MN", x="s_SN", y="scale")
lengths(reach, "reach_BM", "b + d", place="d", bar="b")
lengths(reach, "reach_AN", "a + d", place="d", bar="a")
lengths(reach, "reach_BS", "b + |SN|", place="SN", bar="b")
lengths(reach, "reach_AS", "a + |s|", place="S_x", bar="a")
#: The ways to a joint by B and by A, and where it is from the feet of both.
WAYS: dict[str, tuple[str, str, Any, dict[str, str]]] = {
    "M": ("reach_BM", "a", from_N, {"back": "d"}),
    "N": ("b", "reach_AN", from_M, {"ahead": "d"}),
    "S": ("reach_BS", "reach_AS", from_either, {"back": "SN", "ahead": "S_x"}),
}
for _joint, (_by_B, _by_A, _place, _ends) in WAYS.items():
    for _to, _shorter, _law, _meaning in (
        ("along", shorter_with_AB, along_by, ALONG),
        ("across", shorter, across, ACROSS),
    ):
        _way = f"{_joint}_{_to}_by_B"
        _of = {name: f"{_joint}_{_to}_{name}" for name in ("place", "bar", "x", "y")}
        step(_shorter, _way, "way", by_B=_by_B, by_A=_by_A)
        lengths(_place, _of["place"], "x", way=_way, **_ends)
        lengths(of_way, _of["bar"], "a or b", way=_way, by_B="b", by_A="a")
        step(of_way, _of["x"], "u_x or v_x", way=_way, by_B="v_x", by_A="u_x")
        step(of_way, _of["y"], "u_y or v_y", way=_way, by_B="v_y", by_A="u_y")
        if _law is across:
            _of = {"place": _of["place"], "a": _of["bar"], "u_x": _of["x"], "u_y": _of["y"]}
        else:
            _of["way"] = _way
        if (_joint, _to) == ("M", "across"):
            focal.quantities(units="m", source=HELD)(_law, "M_across_AB", "M_AB", _meaning.format("M"), **_of)
            seen_by_crank = by_crank.quantities(units="m", source=HELD)
            seen_by_crank(across_or_by_F, "M_across_AB", "M_AB", _meaning.format("M"), **_of)
            continue
        seen(_law, f"{_joint}_{_to}_AB", f"{_joint}_AB", _meaning.format(_joint), **_of)

# -- F ---------------------------------------------------------------------------------------------------------------


def mirrored_height(t: Any, F_y: Any) -> Any:
    """Return how far F is to the left of AB: its height over MN, mirrored, and as PA : MP is to AB : MN."""
    return -(t * F_y)


focal.quantities(units="m", source=HELD)(mirrored_height, "F_across_AB", "F_AB", ACROSS.format("F"))


def of_T_with_sign(way: Any, ratio_sign: Any, s_FT: Any) -> Any:
    """FT with the sign of rho where F is computed from T, else 0."""
    return select(way == 1.0, ratio_sign * s_FT, 0.0)


step = focal.steps(units="1", source=HELD)
step(product, "s_AP", "AP", "Scaled length AP along MA", x="x", y="s_m")
step(product, "s_AT", "AT", "Scaled distance of T from A along AB", x="T_share", y="s_c")
step(
    whether_nearer, "near_T", "|AT| + FT < |AP|, |p|", "1 where T is nearer to A and F than P is, else 0",
    one="s_AT", two="s_FT", far="s_AP", other="s_p",
)  # fmt: skip
by_T = {"way": "near_T"}
step(where, "held_AT", "AT", length="s_AT", **by_T)
step(of_T_with_sign, "held_FT", "FT", **by_T)
step(unless, "held_AP", "AP", length="s_AP", **by_T)
step(unless, "held_p", "p", length="s_p", **by_T)


def bars(held_AP: Any, u: Any, held_p: Any, f: Any) -> Any:
    """Return a component of the vector from F to A by way of P."""
    return held_AP * u + held_p * f


def F_seen_along(
    held_AT: Any, held_FT: Any, g_x: Any, FA_by_P_x: Any, FA_by_P_y: Any, e_x: Any, e_y: Any, scale: Any
) -> Any:  # fmt: skip
    """Return how far F is along AB from A."""
    return scale * ((held_AT - held_FT * g_x) - (FA_by_P_x * e_x + FA_by_P_y * e_y))


step.vector(bars, "FA_by_P_*", "FA", "Vector from F to A by way of P, scaled", u="u_*", f="f_*")
seen = focal.quantities(units="m", source=HELD)
seen(F_seen_along, "F_along_AB", "F_AB", ALONG.format("F"))


@focal.quantity(units="m", symbol="p/n", source=HELD, internal=True)
def lever_AN(P_sign: Any, crank_sign: Any, root_rho: Any, root_x: Any, scale: Any) -> Any:
    """FA over FN, with the sign of both mirrors, times the unit of length."""
    return P_sign * crank_sign * (root_rho * root_x) * scale


def F_mirrored_along(lever_AN: Any, NF_at_0: Any, C: Any, NF_at_pi: Any, Z: Any, half_sine_omega: Any) -> Any:
    """Return how far F is along AB from A, as the triangles NQF and FPA are similar; NaN where there is no AB."""
    from_A = lever_AN * (NF_at_0 * C - NF_at_pi * Z)  # NF along the crank
    return select(half_sine_omega >= 0.0, from_A, NOT_A_NUMBER)


def F_mirrored_across(t: Any, F_y: Any, half_sine_omega: Any) -> Any:
    """Return how far F is to the left of AB, by its height over MN; NaN where there is no AB."""
    return select(half_sine_omega >= 0.0, -(t * F_y), NOT_A_NUMBER)


seen = by_crank.quantities(units="m", source=HELD)
seen(F_mirrored_along, "F_along_AB", "F_AB", ALONG.format("F"))
seen(F_mirrored_across, "F_across_AB", "F_AB", ACROSS.format("F"))


@focal.quantity(units="m", symbol="x_AB", source=f"{WUNDERLICH}, section 7")
def line_along_AB(s_a: Any, s_b: Any, s_c: Any, lambda_: Any, x: Any, rho_plus_1: Any, scale: Any) -> Any:
    """Place of the straight line that F moves on in the frame of AB, from A towards B; NaN unless rho is -1."""
    offset = (s_a - s_b) * (s_a + s_b) * x / (lambda_ * s_c)
    on_a_line = (rho_plus_1 == 0.0) & (lambda_ != 0.0)
    return select(on_a_line, 0.5 * (s_c + offset) * scale, NOT_A_NUMBER)
