"""Where opposite sides of the four-bar meet, and the circles of section 4 through the joints.

X = MA.NB and Y = MN.AB. With the directions u, v, e, g, w of `points` as complex numbers, (u, v) for the sine of the
angle from u to v, and k the sign of rho, the circles have the centres

    of P, F, Q, X:  (P + Q + i PQ cot)/2, cot that of the angle from u to v,
    of S, F, T, Y:  S + g (r e_y + i (r e_x + k FT))/(2 e_y),
    of P, S, Q, T:  S + i SP SQ conj(L)/(2 (SP, L)),        L = (e + t) = PQ lambda/c,

and the radii are their distances from F, S and S: F is at -i w (q u + p v)/(2 (u, v)) from the first, as its chord PQ
may be short and far away. S and Y are on MN, so the second is halfway between them. Where its points lie in line, a
circle is that line.
"""

from __future__ import annotations

from typing import Any

from fastlink.facts.fact import GradedRange, KnownExtremes
from fastlink.mechanisms._shared.laws import (
    ACROSS,
    ALONG,
    KNOWN_OF_MABN,
    across,
    along,
    borrow,
    borrow_range,
    difference,
    half,
    moment,
    opposite,
    product,
    quotient,
    turned,
)
from fastlink.mechanisms.focal.design_facts import FOUR_BAR, PREFIX
from fastlink.mechanisms.focal.inputs import DESIGN, WUNDERLICH, by_crank, focal, quantities, steps
from fastlink.mechanisms.focal.motion import DYAD, NAMES, of_nearer, unless, where, whether_nearer
from fastlink.mechanisms.planar_4r import graded, planar_4r
from fastlink.mechanisms.planar_4r.classes import CLASS_FLAGS
from fastlink.numerics.elementary import NOT_A_NUMBER, select, sqrt

CIRCLES = f"{WUNDERLICH}, section 4"
#: What passes infinity where lines are parallel or points in line, within the range of the input.
POLES = (
    *("X_x", "X_y", "Y_x"),
    *(f"{points}_{part}" for points in ("PFQX", "SFTY", "PSQT") for part in ("x", "y", "radius")),
)

# -- where opposite sides meet ----------------------------------------------------------------------------------


def reach_of_X(d: Any, v_y: Any, u_v: Any) -> Any:
    """Distance of X from M along MA."""
    return d * v_y / u_v


steps(units="m", source=CIRCLES)(reach_of_X, "MX", "MX")
place = quantities(units="m", source=CIRCLES)
place.vector(product, "X_*", "X_*", "Point X of MA and NB, infinite where they are parallel", x="MX", y="u_*")
place(
    quotient,
    "Y_x",
    "Y_x",
    "Point Y of MN and AB, infinite where they are parallel, x",
    x="M_across_AB",
    y="e_y",
)

# -- centres as seen from F or S, scaled --------------------------------------------------------------------------


def of_both(one: Any, x: Any, other: Any, y: Any) -> Any:
    """Return a component of the sum of two directions times lengths."""
    return one * x + other * y


def from_F_x(w_x: Any, w_y: Any, dyads_x: Any, dyads_y: Any, u_v: Any) -> Any:
    """Vector from F to the centre of P, F, Q, X, x."""
    return (w_x * dyads_y + w_y * dyads_x) / (2.0 * u_v)


def from_F_y(w_x: Any, w_y: Any, dyads_x: Any, dyads_y: Any, u_v: Any) -> Any:
    """Vector from F to the centre of P, F, Q, X, y."""
    return (w_y * dyads_y - w_x * dyads_x) / (2.0 * u_v)


def cotangent(u_v: Any, u_x: Any, u_y: Any, v_x: Any, v_y: Any) -> Any:
    """Cotangent of the angle from MA to NB, that of the angle at which PQ is seen from F."""
    return (u_x * v_x + u_y * v_y) / u_v


def chord(c: Any, lambda_: Any, way: Any) -> Any:
    """Return a component of the vector from P to Q."""
    return c / lambda_ * way


def beside_chord_x(P_x: Any, Q_x: Any, PQ_y: Any, seen_PQ: Any) -> Any:
    """Return the centre of a circle through P and Q, from where PQ is seen at an angle, x."""
    return 0.5 * ((P_x + Q_x) - PQ_y * seen_PQ)


def beside_chord_y(P_y: Any, Q_y: Any, PQ_x: Any, seen_PQ: Any) -> Any:
    """Return the centre of a circle through P and Q, from where PQ is seen at an angle, y."""
    return 0.5 * ((P_y + Q_y) + PQ_x * seen_PQ)


def between(S_x: Any, Y_x: Any, s_r: Any) -> Any:
    """Return the middle of S and Y on MN; NaN where S is at infinity or there is no F."""
    return select(s_r >= 0.0, 0.5 * (S_x + Y_x), NOT_A_NUMBER)


def FT_less_crank(lesser_root: Any, rho_plus_1: Any) -> Any:
    """FT less the crank, scaled: a root of the gaps of the four-bar."""
    return lesser_root / abs(rho_plus_1)


def across_crank(
    s_r: Any, ratio_sign: Any, s_FT: Any, s_FT_r: Any, e_x: Any, e_y: Any, parallel_share: Any,
    opposite_share: Any,
) -> Any:  # fmt: skip
    """Distance of the centre of S, F, T, Y from SF."""
    # r e_x + k FT cancels where k e_x is near -1: it is k (FT - r + r (1 + k e_x)), too
    share = select(ratio_sign > 0.0, parallel_share, opposite_share)
    apart = ratio_sign * (s_FT_r + 2.0 * (s_r * share))
    return select(ratio_sign * e_x < 0.0, apart, s_r * e_x + ratio_sign * s_FT) / (2.0 * e_y)


def size(length: Any) -> Any:
    """Return a length without its sign."""
    return abs(length)


def along_MN(start: Any, length: Any) -> Any:
    """Return how long the way from S along MN and a rocker is."""
    return abs(start) + abs(length)


def by_crank_and(s_r: Any, bar: Any) -> Any:
    """Return how long the way from S along the crank and PF or QF is."""
    return s_r + abs(bar)


def whether_shorter(by_F: Any, by_MN: Any) -> Any:
    """1 where the way by F is far shorter, else 0."""
    # the directions of its bars are products of four that the other way has as they are: some 16 roundings
    return select(16.0 * by_F < by_MN, 1.0, 0.0)


def shorter_of(way: Any, by_F: Any, by_MN: Any) -> Any:
    """Return the length of the way that is taken."""
    return select(way == 1.0, by_F, by_MN)


def from_S(by_F: Any, s_r: Any, g: Any, bar: Any, back: Any, start: Any, length: Any, direction: Any) -> Any:
    """Return the component along MN of the vector from S to P or Q."""
    return select(by_F == 1.0, s_r * g + bar * back, start + length * direction)


def length_across(s_c: Any, lambda_: Any) -> Any:
    """Return how far PQ leads away from MN at most, scaled."""
    return s_c / abs(lambda_)


def length_along(s_c: Any, lambda_: Any, t: Any) -> Any:
    """Return how far PQ leads along MN at most, scaled."""
    return s_c / abs(lambda_) * (1.0 + abs(t))


def shorter_by(own: Any, s_PQ: Any, far: Any) -> Any:
    """1 where the way along PQ is shorter than the own one, else 0."""
    return select(own + s_PQ < far, 1.0, 0.0)


def nearer_to_S(own_P_x: Any, own_P_y: Any, own_Q_x: Any, own_Q_y: Any, t: Any) -> Any:
    """1 where the area of S, P, Q has less of the rounding of SQ than of SP, else 0."""
    share = 1.0 + abs(t)
    return select(own_Q_x + share * own_Q_y < own_P_x + share * own_P_y, 1.0, 0.0)


def less_chord(P_by_Q: Any, own: Any, other: Any, chord: Any) -> Any:
    """Return a component of the vector to P, by way of Q where that is the shorter one."""
    return select(P_by_Q == 1.0, other - chord, own)


def plus_chord(Q_by_P: Any, own: Any, other: Any, chord: Any) -> Any:
    """Return a component of the vector to Q, by way of P where that is the shorter one."""
    return select(Q_by_P == 1.0, other + chord, own)


def from_triangle_x(SP_SQ_x: Any, SP_SQ_y: Any, QP_x: Any, e_y: Any, SP_QP: Any) -> Any:
    """Vector from S to the centre of P, S, Q, T, x."""
    return (SP_SQ_x * e_y - SP_SQ_y * QP_x) / (2.0 * SP_QP)


def from_triangle_y(SP_SQ_x: Any, SP_SQ_y: Any, QP_x: Any, e_y: Any, SP_QP: Any) -> Any:
    """Vector from S to the centre of P, S, Q, T, y."""
    return (SP_SQ_x * QP_x + SP_SQ_y * e_y) / (2.0 * SP_QP)


step = steps(units="1", source=CIRCLES)
step.vector(
    *(of_both, "dyads_*", "q u + p v", "QF along MA and PF along NB, scaled"),
    one="s_q",
    x="u_*",
    other="s_p",
    y="v_*",
)
step.vector((from_F_x, from_F_y), "PFQX_off_*", "C - F", "Vector from F to the centre of P, F, Q, X")
step(cotangent, "seen_PQ", "cot(u, v)")
lengths = steps(units="m", source=CIRCLES)
lengths(chord, "PQ_x", "PQ_x", "Vector from P to Q, x", way="QP_x")
lengths(chord, "PQ_y", "PQ_y", "Vector from P to Q, y", way="e_y")
step(half, "half_r", "r/2", "Half the crank", x="s_r")
step(FT_less_crank, "s_FT_r", "FT - r")
step(across_crank, "crank_off", "h")
step.vector(
    *(turned, "SFTY_off_*", "C - S", "Vector from S to the centre of S, F, T, Y"),
    u="half_r",
    v="crank_off",
    x="g_x",
    y="g_y",
)
step(opposite, "minus_s_s", "-s", "Scaled distance from S to M", x="s_s")
step(opposite, "back_q", "-q", "Minus the scaled length QF", x="s_q")
step(length_along, "s_PQ_along", "PQ")
step(length_across, "s_PQ_across", "PQ")
#: The way from S to P and Q: along MN and a rocker, or along the crank and back along PF = -p f or QF = q h.
BARS = {"P": ("M", "minus_s_s", "s_m", "u", "s_p", "f"), "Q": ("N", "s_SN", "s_n", "v", "back_q", "h")}
for _to, (_pivot, _start, _length, _direction, _bar, _back) in BARS.items():
    _bars, _lengths = {"start": _start, "length": _length}, {"by_F": f"crank_{_to}", "by_MN": f"bars_{_to}"}
    _meaning = f"Vector from S to {_to} by {_pivot}{{}}, scaled"
    step(by_crank_and, f"crank_{_to}", "r + p", bar=_bar)
    step(along_MN, f"bars_{_to}", "|s| + m", **_bars)
    step(whether_shorter, f"{_to}_by_F", "way", **_lengths)
    step(shorter_of, f"own_{_to}_x", "length", way=f"{_to}_by_F", **_lengths)
    step(size, f"own_{_to}_y", "length", length=_length)
    _bars |= {"by_F": f"{_to}_by_F", "bar": _bar, "back": f"{_back}_x", "g": "g_x"}
    _label = f"S{_to}_x", _meaning.format(" or F") + ", x"
    step(from_S, f"own_S{_to}_x", *_label, direction=f"{_direction}_x", **_bars)
    step(product, f"own_S{_to}_y", f"S{_to}_y", _meaning.format("") + ", y", x=_length, y=f"{_direction}_y")
step(chord, "s_PQ_x", "PQ_x", "Vector from P to Q, scaled, x", c="s_c", way="QP_x")
step(chord, "s_PQ_y", "PQ_y", "Vector from P to Q, scaled, y", c="s_c", way="e_y")
for _part, _size in (("x", "s_PQ_along"), ("y", "s_PQ_across")):
    _P, _Q, _SP, _SQ = (f"{_name}_{_part}" for _name in ("own_P", "own_Q", "own_SP", "own_SQ"))
    step(shorter_by, f"P_by_Q_{_part}", "way", own=_Q, s_PQ=_size, far=_P)
    step(shorter_by, f"Q_by_P_{_part}", "way", own=_P, s_PQ=_size, far=_Q)
    _ends = {"chord": f"s_PQ_{_part}"}
    _meaning = f"Vector from S to {{}}, scaled, {_part}"
    _labels = f"SP_{_part}", "SP", _meaning.format("P")
    step(less_chord, *_labels, P_by_Q=f"P_by_Q_{_part}", own=_SP, other=_SQ, **_ends)
    _labels = f"SQ_{_part}", "SQ", _meaning.format("Q")
    step(plus_chord, *_labels, Q_by_P=f"Q_by_P_{_part}", own=_SQ, other=_SP, **_ends)
step.vector(turned, "SP_SQ_*", "SP SQ", "Product of SP and SQ", u="SP_x", v="SP_y", x="SQ_x", y="SQ_y")
step(nearer_to_S, "Q_nearer_S", "way")
step.vector(
    of_nearer,
    "near_S_*",
    "SP or SQ",
    "Vector from S to P or Q, scaled",
    near_N="Q_nearer_S",
    from_M="own_SP_*",
    from_N="own_SQ_*",
)
_AREA = "Twice the area of S, P, Q, scaled, over c/lambda"
step(moment, "SP_QP", "(SP, L)", _AREA, x="near_S_x", y="near_S_y", F_x="QP_x", F_y="e_y")
_OFF = "Vector from S to the centre of P, S, Q, T"
step.vector((from_triangle_x, from_triangle_y), "PSQT_off_*", "C - S", _OFF)

# -- circles -----------------------------------------------------------------------------------------------------


def radius(scale: Any, x: Any, y: Any) -> Any:
    """Return the distance of a centre from a point of the circle."""
    return scale * sqrt(x * x + y * y)


for _points in ("PFQX", "SFTY", "PSQT"):
    _of = f"of the circle through {', '.join(_points)}"
    centre, _off = quantities(units="m", source=CIRCLES), f"{_points}_off"
    if _points == "PFQX":
        centre(beside_chord_x, "PFQX_x", "C_x", f"Centre {_of}, x")
        centre(beside_chord_y, "PFQX_y", "C_y", f"Centre {_of}, y")
    else:
        if _points == "SFTY":
            centre(between, "SFTY_x", "C_x", f"Centre {_of}, x")
        else:
            _from_S = {"start": "S_x", "length": "scale", "direction": f"{_off}_x"}
            centre(along, "PSQT_x", "C_x", f"Centre {_of}, x", **_from_S)
        centre(product, f"{_points}_y", "C_y", f"Centre {_of}, y", x="scale", y=f"{_off}_y")
    centre(radius, f"{_points}_radius", "R", f"Radius {_of}", x=f"{_off}_x", y=f"{_off}_y")


# -- The motion with AB held fixed (section 3): joints in the frame of AB, with its origin in A and its
#    x-axis towards B

# With the directions u, v, e, g of `points` M is -a u/e there, a point of MN at x is (x - a u)/e, or by way
# of B c + (x - d - b v)/e: by the shorter bars, of which c is not across AB. T = AT. F hangs on T and on P,
#
#     F = AT -+ FT g = -((lambda - 1) m + p w) u/e,    - where rho is positive,
#
# of which the way with the shorter bars is taken: T is far away where rho nears -1, P where lambda nears 0.


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


step, lengths_AB = steps(units="1", source=HELD), steps(units="m", source=HELD)
seen = quantities(units="m", source=HELD)
lengths_AB(product, "SN", "SN", "Distance from S to N along MN", x="s_SN", y="scale")
lengths_AB(reach, "reach_BM", "b + d", place="d", bar="b")
lengths_AB(reach, "reach_AN", "a + d", place="d", bar="a")
lengths_AB(reach, "reach_BS", "b + |SN|", place="SN", bar="b")
lengths_AB(reach, "reach_AS", "a + |s|", place="S_x", bar="a")
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
        _of_end = {name: f"{_joint}_{_to}_{name}" for name in ("place", "bar", "x", "y")}
        step(_shorter, _way, "way", by_B=_by_B, by_A=_by_A)
        lengths_AB(_place, _of_end["place"], "x", way=_way, **_ends)
        lengths_AB(of_way, _of_end["bar"], "a or b", way=_way, by_B="b", by_A="a")
        step(of_way, _of_end["x"], "u_x or v_x", way=_way, by_B="v_x", by_A="u_x")
        step(of_way, _of_end["y"], "u_y or v_y", way=_way, by_B="v_y", by_A="u_y")
        if _law is across:
            _of_end = {
                "place": _of_end["place"],
                "a": _of_end["bar"],
                "u_x": _of_end["x"],
                "u_y": _of_end["y"],
            }
        else:
            _of_end["way"] = _way
        if (_joint, _to) == ("M", "across"):
            focal.quantities(units="m", source=HELD)(
                _law, "M_across_AB", "M_AB", _meaning.format("M"), **_of_end
            )
            seen_by_crank = by_crank.quantities(units="m", source=HELD)
            seen_by_crank(across_or_by_F, "M_across_AB", "M_AB", _meaning.format("M"), **_of_end)
            continue
        seen(_law, f"{_joint}_{_to}_AB", f"{_joint}_AB", _meaning.format(_joint), **_of_end)

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


# -- The four-bar of a focal mechanism, a planar 4R: its class, the ranges of its rockers, and the graded
#    range of phi

# It moves as without its completion, so its ranges are those where the crank SF drives, too.


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


# -- The reachable range of sigma, graded as that of the planar 4R: MSFP is one, with the crank SF

# Of sin^2(omega/2) and cos^2(omega/2) one grows with Z = sin^2(sigma/2), from 0 at the lower toggle, and
# one falls, to 0 at the upper: they are |D| p and |D| q of the planar 4R, D being how much they change over
# half a turn.


SIGMA = by_crank.position.name


def whether_sine_falls(sine_at_0: Any, sine_at_pi: Any) -> Any:
    """1 where sin^2(omega/2) falls with Z, else 0."""
    return select(sine_at_0 > sine_at_pi, 1.0, 0.0)


def whether_sine_grows(sine_falls: Any) -> Any:
    """1 where sin^2(omega/2) grows with Z, else 0."""
    return 1.0 - sine_falls


def of_both_falls(sine_falls: Any, falling: Any, growing: Any) -> Any:
    """The falling or the growing one of two squares, that of the sine."""
    return select(sine_falls == 1.0, falling, growing)


def change_of_squares(sine_change: Any) -> Any:
    """|D|, how much sin^2(omega/2) changes over half a turn."""
    return abs(sine_change)


def minus_over(x: Any, change: Any) -> Any:
    """Minus a square over how much it changes: a toggle."""
    return -x / change


def range_width(Z0: Any, C0: Any, growing_at_pi: Any, falling_at_0: Any, change: Any) -> Any:
    """Width of the reachable range in Z."""
    low = Z0 > 0.0
    high = C0 > 0.0
    one_end = select(low, growing_at_pi / change, select(high, falling_at_0 / change, 1.0))
    return select(low & high, 1.0 / change, one_end)


def near(limit: Any) -> Any:
    """Distance in Z from an end of the range to the next singularity beyond it; 1 where the four-bar folds."""
    return select(limit == 0.0, 1.0, abs(limit))


def width_of_squares(change: Any, range_width: Any) -> Any:
    """How much the squares change over the range."""
    return change * range_width


def mixed(sine_falls: Any, sine_grows: Any, falling: Any, growing: Any) -> Any:
    """The falling or the growing one of two squares."""
    return sine_falls * falling + sine_grows * growing


step = by_crank.steps(units="1", source=DYAD)
step(whether_sine_falls, "sine_falls", "sine_falls")
step(whether_sine_grows, "sine_grows", "sine_grows")
step(change_of_squares, "change", "change")
step(of_both_falls, "falling_at_0", "falling_at_0", falling="sine_at_0", growing="cosine_at_0")
step(of_both_falls, "growing_at_0", "growing_at_0", falling="cosine_at_0", growing="sine_at_0")
step(of_both_falls, "falling_at_pi", "falling_at_pi", falling="sine_at_pi", growing="cosine_at_pi")
step(of_both_falls, "growing_at_pi", "growing_at_pi", falling="cosine_at_pi", growing="sine_at_pi")
step(minus_over, "Z0", "Z0", x="growing_at_0")
step(minus_over, "C0", "C0", x="falling_at_pi")
step(range_width, "range_width", "range_width")
step(width_of_squares, "width_of_squares", "width_of_squares")
step(graded.above_zero, "Z_least", "Z_least", x="Z0")
step(graded.above_zero, "C_least", "C_least", x="C0")
step(graded.above_zero, "growing_least", "growing_least", x="growing_at_0")
step(graded.above_zero, "falling_least", "falling_least", x="falling_at_pi")
step(near, "near_low", "near_low", limit="Z0")
step(near, "near_high", "near_high", limit="C0")
step(graded.grade, "scale_low", "scale_low", near="near_low", width="range_width")
step(graded.grade, "scale_high", "scale_high", near="near_high", width="range_width")
step(graded.first_place, "start_low", "start_low", limit="Z0", scale="scale_low")
step(graded.first_place, "start_high", "start_high", limit="C0", scale="scale_high")
step(graded.is_toggle, "toggle_low", "toggle_low", limit="Z0")
step(graded.is_toggle, "toggle_high", "toggle_high", limit="C0")

by_crank.graded = GradedRange(
    antisymmetric=("side", "omega_sign"),
    vanishes_at_toggle="half_sine_omega",
    reciprocal="per_half_sine",
    bounded_factor="size_of_sine",
    cells={},
    max_extrema={},
    not_differentiable=("closure_residual", "F_path_residual", *POLES),
    wraps_at={
        "phi": "u_y",
        "psi": "v_y",
        **dict.fromkeys(("omega_angle", "alpha", "beta", "chi"), "half_sine_omega"),
    },
    # the cosine of omega is linear in that of sigma
    known=dict.fromkeys(("omega_angle", "transmission_angle_P", "transmission_angle_Q"), KnownExtremes()),
)
step = by_crank.steps(units="1", source=DYAD, variant=by_crank.graded.name)
step(graded.from_end, "Z", "Z", least="Z_least", fraction="from_low")
step(graded.from_end, "C", "C", least="C_least", fraction="from_high")
_LOW = {"range_width": "width_of_squares", "fraction": "from_low"}
_HIGH = {"range_width": "width_of_squares", "fraction": "from_high"}
step(graded.from_end, "growing", "growing", least="growing_least", **_LOW)
step(graded.from_end, "falling", "falling", least="falling_least", **_HIGH)
step(mixed, "squared_half_sine", "squared_half_sine")
step(mixed, "squared_half_cosine", "squared_half_cosine", falling="growing", growing="falling")
step(difference, "g_x", "g_x", "Cosine of the input angle", x="C", y="Z")
step(graded.sin_theta1, "g_y", "g_y")
step(graded.theta1, SIGMA, SIGMA)
