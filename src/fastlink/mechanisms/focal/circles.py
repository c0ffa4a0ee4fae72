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

from fastlink.mechanisms._shared.laws import along, half, moment, opposite, product, quotient, turned
from fastlink.mechanisms.focal.by_crank import quantities, steps
from fastlink.mechanisms.focal.inputs import WUNDERLICH
from fastlink.mechanisms.focal.joint_F import of_nearer
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
