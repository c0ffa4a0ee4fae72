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

from fastlink.mechanisms._shared.laws import along, half, moment, product, quotient, turned
from fastlink.mechanisms.focal.by_crank import quantities, steps
from fastlink.mechanisms.focal.inputs import WUNDERLICH
from fastlink.mechanisms.focal.points import POSITION
from fastlink.numerics.elementary import NOT_A_NUMBER, select, sqrt

CIRCLES = f"{WUNDERLICH}, section 4"
#: What passes infinity where lines are parallel or points in line, within the range of the input.
POLES = (
    *("X_x", "X_y", "Y_x"),
    *(f"{points}_{part}" for points in ("PFQX", "SFTY", "PSQT") for part in ("x", "y", "radius")),
)

# -- where opposite sides meet ----------------------------------------------------------------------------------


def sine_by_others(
    u_cross_v: Any, s_b: Any, s_c: Any, s_d: Any, u_x: Any, u_y: Any, e_x: Any, e_y: Any
) -> Any:  # fmt: skip
    """Sine of the angle from MA to NB: long rockers are nearly parallel, by as much as AB and MN are across them."""
    by_others = (s_c * (u_x * e_y - u_y * e_x) + s_d * u_y) / s_b
    return select(s_c + s_d < s_b, by_others, u_cross_v)


def reach_of_X(d: Any, v_y: Any, u_v: Any) -> Any:
    """Distance of X from M along MA."""
    return d * v_y / u_v


step = steps(units="1", source=POSITION)
step(moment, "u_cross_v", "(u, v)", "Sine of the angle from MA to NB", x="u_x", y="u_y", F_x="v_x", F_y="v_y")
step(sine_by_others, "u_v", "(u, v)")
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


def between(S_x: Any, Y_x: Any) -> Any:
    """Return the middle of S and Y on MN; NaN where S is at infinity."""
    return select(S_x == S_x, 0.5 * (S_x + Y_x), NOT_A_NUMBER)


def across_crank(s_r: Any, ratio_sign: Any, s_FT: Any, e_x: Any, e_y: Any) -> Any:
    """Distance of the centre of S, F, T, Y from SF."""
    return (s_r * e_x + ratio_sign * s_FT) / (2.0 * e_y)


def from_S(length: Any, direction: Any, s_s: Any) -> Any:
    """Return the component along MN of the vector from S to P."""
    return length * direction - s_s


def length_of_chord(s_c: Any, lambda_: Any, t: Any) -> Any:
    """Return what PQ is at most, scaled."""
    return s_c / abs(lambda_) * (1.0 + abs(t))


def shorter_by(one: Any, two: Any, s_PQ: Any, far: Any, other: Any) -> Any:
    """1 where the way along PQ is shorter than the own one, else 0."""
    return select(abs(one) + abs(two) + s_PQ < abs(far) + abs(other), 1.0, 0.0)


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
step(across_crank, "crank_off", "h")
step.vector(
    *(turned, "SFTY_off_*", "C - S", "Vector from S to the centre of S, F, T, Y"),
    u="half_r",
    v="crank_off",
    x="g_x",
    y="g_y",
)
step(from_S, "SMP_x", "SP_x", "Vector from S to P by M, scaled, x", length="s_m", direction="u_x")
step(product, "SMP_y", "SP_y", "Vector from S to P by M, scaled, y", x="s_m", y="u_y")
step(
    along, "SNQ_x", "SQ_x", "Vector from S to Q by N, scaled, x", start="s_SN", length="s_n", direction="v_x"
)
step(product, "SNQ_y", "SQ_y", "Vector from S to Q by N, scaled, y", x="s_n", y="v_y")
step(chord, "s_PQ_x", "PQ_x", "Vector from P to Q, scaled, x", c="s_c", way="QP_x")
step(chord, "s_PQ_y", "PQ_y", "Vector from P to Q, scaled, y", c="s_c", way="e_y")
step(length_of_chord, "s_PQ", "PQ")
step(shorter_by, "P_by_Q", "way", one="s_n", two="s_SN", far="s_m", other="s_s")
step(shorter_by, "Q_by_P", "way", one="s_m", two="s_s", far="s_n", other="s_SN")
step.vector(
    less_chord, "SP_*", "SP", "Vector from S to P, scaled", own="SMP_*", other="SNQ_*", chord="s_PQ_*"
)
step.vector(
    plus_chord, "SQ_*", "SQ", "Vector from S to Q, scaled", own="SNQ_*", other="SMP_*", chord="s_PQ_*"
)
step.vector(turned, "SP_SQ_*", "SP SQ", "Product of SP and SQ", u="SP_x", v="SP_y", x="SQ_x", y="SQ_y")
_AREA = "Twice the area of S, P, Q, scaled, over c/lambda"
step(moment, "SP_QP", "(SP, L)", _AREA, x="SP_x", y="SP_y", F_x="QP_x", F_y="e_y")
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
