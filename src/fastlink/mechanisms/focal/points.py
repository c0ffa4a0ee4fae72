"""Facts of the joints of the focal mechanism in one position, whatever drives it.

All directions are unit vectors, as complex numbers: u of MA, v of NB, e of AB, g of SF, and w = exp(i omega) of the
paper's angle omega. Of these five any follows from the other four,

    e g = -k u v w,    k the sign of (1 + rho) lambda,

and F stands off P and Q by -p u w and q v w. What drives gives three of them: see `rocker` and `crank`.
"""

from __future__ import annotations

from typing import Any

from fastlink.catalogue.catalogue import Catalogue
from fastlink.mechanisms._shared.laws import along, moment, product, total, turned
from fastlink.mechanisms.focal.by_crank import by_crank, either, quantities, steps
from fastlink.mechanisms.focal.design_facts import length_of
from fastlink.mechanisms.focal.inputs import DESIGN, WUNDERLICH, focal
from fastlink.numerics.elementary import NOT_A_NUMBER, atan2, select, sqrt

POSITION = f"{DESIGN}#position"
FIGURES = f"{WUNDERLICH}, Figs. 1 and 2"


# -- products of directions -----------------------------------------------------------------------------------


def declare_products(catalogue: Catalogue, w: str) -> None:
    """Declare the directions u w of PF and v w of QF but for their signs, u v, and u v w of FT."""
    step = catalogue.steps(units="1", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)")
    for made, one, two in (("f", "u", w), ("h", "v", w), ("uv", "u", "v"), ("uwv", "uv", w)):
        parts = {"u": f"{one}_x", "v": f"{one}_y", "x": f"{two}_x", "y": f"{two}_y"}
        step.vector(turned, f"{made}_*", f"{made}_*", f"Product of the directions {one} and {two}", **parts)


@focal.quantity(units="1", symbol="lambda < 1/2", source=POSITION, internal=True)
def far_P(x: Any) -> Any:
    """1 where P and Q are farther from M and N than A and B are, or beyond them, else 0."""
    return select(x < -0.5, 1.0, 0.0)


@focal.quantity(units="1", symbol="t", source=POSITION, internal=True)
def QP_start(far_P: Any, t: Any, lambda_: Any, s_d: Any, s_c: Any) -> Any:
    """(lambda - 1) d/c, or where P is far away lambda d/c."""
    return select(far_P == 1.0, lambda_ * (s_d / s_c), t)


@focal.quantity(units="1", symbol="b/c", source=POSITION, internal=True)
def QP_v(far_P: Any, s_b: Any, s_c: Any) -> Any:
    """Ratio b/c where P is far away, else 0."""
    return far_P * (s_b / s_c)


@focal.quantity(units="1", symbol="a/c", source=POSITION, internal=True)
def QP_u(far_P: Any, s_a: Any, s_c: Any) -> Any:
    """Ratio a/c where P is far away, else 0."""
    return far_P * (s_a / s_c)


@either(units="1", symbol="x", source=POSITION, internal=True)
def QP_x(far_P: Any, e_x: Any, QP_start: Any, QP_v: Any, v_x: Any, QP_u: Any, u_x: Any) -> Any:
    """Vector from P to Q over c, times lambda, x: by way of A and B, or where P is far away by M and N."""
    # c e + (lambda - 1) d, where c e = d + b v - a u may nearly be d
    return (1.0 - far_P) * e_x + (QP_start + (QP_v * v_x - QP_u * u_x))


# -- joints -----------------------------------------------------------------------------------------------------

joint = quantities(units="m", source=FIGURES)
joint.vector(product, "A_*", "A_*", "Joint A on MA", x="a", y="u_*")
joint.vector(product, "P_*", "P_*", "Joint P on MA", x="m", y="u_*")
joint(along, "B_x", "B_x", "Joint B on NB, x", start="d", length="b", direction="v_x")
joint(product, "B_y", "B_y", "Joint B on NB, y", x="b", y="v_y")
joint(along, "Q_x", "Q_x", "Joint Q on NB, x", start="d", length="n", direction="v_x")
joint(product, "Q_y", "Q_y", "Joint Q on NB, y", x="n", y="v_y")
joint = focal.quantities(units="m", source=f"{WUNDERLICH}, eqs. (1.3), (1.7)")
joint.vector(length_of, "F_*", "F_*", "Joint F", scaled="MF_*")


def where_it_closes(scaled: Any, scale: Any, half_sine_omega: Any) -> Any:
    """Return a length from its scaled length; NaN where the crank points, and the dyads do not reach."""
    return select(half_sine_omega >= 0.0, scaled * scale, NOT_A_NUMBER)


joint = by_crank.quantities(units="m", source=f"{WUNDERLICH}, eqs. (1.3), (1.7)")
joint.vector(where_it_closes, "F_*", "F_*", "Joint F", scaled="MF_*")

# -- T, from A or B -----------------------------------------------------------------------------------------------


@focal.quantity(units="1", symbol="TB < AT", source=POSITION, internal=True)
def T_near_B(AT: Any, TB: Any) -> Any:
    """1 where T is nearer to B than to A, else 0."""
    return select(abs(TB) < abs(AT), 1.0, 0.0)


def unless_near_B(T_near_B: Any, length: Any) -> Any:
    """Return a length of the way to T by A, where it is taken, else 0."""
    return select(T_near_B == 1.0, 0.0, length)


def where_near_B(T_near_B: Any, length: Any) -> Any:
    """Return a length of the way to T by B, where it is taken, else 0."""
    return select(T_near_B == 1.0, length, 0.0)


@focal.quantity(units="m", symbol="AT", source=f"{WUNDERLICH}, eq. (3.2)", internal=True)
def T_along(T_near_B: Any, AT: Any, TB: Any) -> Any:
    """Distance of T from A along AB, or from B, negative on its side of A."""
    return select(T_near_B == 1.0, -TB, AT)


@focal.quantity(units="m", symbol="TB", source=f"{WUNDERLICH}, eq. (3.2)", internal=True)
def TB(c: Any, rho_plus_1: Any) -> Any:
    """Distance of B from T along AB."""
    return c / rho_plus_1


step = focal.steps(units="m", source=f"{WUNDERLICH}, eq. (3.2)")
step(product, "AT", "AT", "Distance of T from A along AB", x="T_share", y="c")
step(unless_near_B, "T_a", "a", length="a")
step(where_near_B, "T_b", "b", length="b")
step(where_near_B, "T_d", "d", length="d")


def T_component(T_a: Any, u: Any, T_b: Any, v: Any, T_along: Any, e: Any) -> Any:
    """Return a component of the bars from M or N to T."""
    return (T_a * u + T_b * v) + T_along * e


_WAY = "Bars of the shorter way to T, x"
steps(units="m", source=f"{WUNDERLICH}, eq. (3.2)")(
    T_component, "T_way_x", "T_x", _WAY, u="u_x", v="v_x", e="e_x"
)
joint = quantities(units="m", source=f"{WUNDERLICH}, eq. (3.2)")
joint(total, "T_x", "T_x", "Joint T on AB, x", x="T_d", y="T_way_x")
joint(T_component, "T_y", "T_y", "Joint T on AB, y", u="u_y", v="v_y", e="e_y")

# -- angles -----------------------------------------------------------------------------------------------------


@either(units="rad", symbol="omega", source=f"{WUNDERLICH}, eq. (1.1)")
def omega_angle(w_x: Any, w_y: Any) -> Any:
    """Angle omega of the bars at P, from PM to PF where m and p have one sign."""
    return atan2(w_y + 0.0, w_x)


@either(units="1", symbol="k", source=POSITION, internal=True)
def P_sign(ratio_sign: Any, lambda_sign: Any) -> Any:
    """Sign of m p, which is that of n p."""
    return ratio_sign * lambda_sign


@either(units="rad", symbol="mu_P", source=POSITION)
def transmission_angle_P(P_sign: Any, w_x: Any, w_y: Any) -> Any:
    """Transmission angle at P: between PM and PF, the same as BQF of (3.1)."""
    return atan2(abs(w_y), P_sign * w_x)


@either(units="rad", symbol="mu_Q", source=POSITION)
def transmission_angle_Q(lambda_sign: Any, w_x: Any, w_y: Any) -> Any:
    """Transmission angle at Q: between QN and QF, the same as FPA of (3.1)."""
    return atan2(abs(w_y), -(lambda_sign * w_x))


# -- mu_F, that of MA and NB ------------------------------------------------------------------------------------


def sine_by_others(
    u_cross_v: Any, s_b: Any, s_c: Any, s_d: Any, u_x: Any, u_y: Any, e_x: Any, e_y: Any
) -> Any:  # fmt: skip
    """Sine of the angle from MA to NB: long rockers are nearly parallel, by as much as AB and MN are across them."""
    by_others = (s_c * (u_x * e_y - u_y * e_x) + s_d * u_y) / s_b
    return select(s_c + s_d < s_b, by_others, u_cross_v)


step = steps(units="1", source=POSITION)
step(moment, "u_cross_v", "(u, v)", "Sine of the angle from MA to NB", x="u_x", y="u_y", F_x="v_x", F_y="v_y")
step(sine_by_others, "u_v", "(u, v)")


@focal.quantity(units="1", symbol="c d < a b", source=POSITION, internal=True)
def by_direction_of_AB(
    s_a: Any, s_b: Any, s_c: Any, s_d: Any, sine_parallel: Any, sine_antiparallel: Any, cosine_parallel: Any,
    cosine_antiparallel: Any,
) -> Any:  # fmt: skip
    """1 where AB revolves and changes the angle of MA and NB by less than its own, else 0."""
    sine = select(sine_parallel < sine_antiparallel, sine_parallel, sine_antiparallel)
    cosine = select(cosine_parallel < cosine_antiparallel, cosine_parallel, cosine_antiparallel)
    return select((s_c * s_d < s_a * s_b) & (sine > 0.0) & (cosine > 0.0), 1.0, 0.0)


@either(units="1", symbol="(1 - e_x)/2", source=POSITION, internal=True)
def opposite_share(e_x: Any, e_y: Any) -> Any:
    """Squared sine of half the direction of AB."""
    return 0.5 * select(e_x > 0.0, e_y * e_y, (1.0 - e_x) * (1.0 - e_x)) / (1.0 + abs(e_x))


@either(units="1", symbol="(1 + e_x)/2", source=POSITION, internal=True)
def parallel_share(e_x: Any, e_y: Any) -> Any:
    """Squared cosine of half the direction of AB."""
    return 0.5 * select(e_x > 0.0, (1.0 + e_x) * (1.0 + e_x), e_y * e_y) / (1.0 + abs(e_x))


def between(parallel_share: Any, at_parallel: Any, opposite_share: Any, at_antiparallel: Any) -> Any:
    """Return a squared half-angle of MA and NB, from those where AB is parallel and antiparallel to MN."""
    return parallel_share * at_parallel + opposite_share * at_antiparallel


step = steps(units="1", source=POSITION)
_HALF = "squared {} of half the angle of MA and NB, times 4 a b"
step(
    between, "swing_sine", "s_F", _HALF.format("sine"),
    at_parallel="sine_parallel", at_antiparallel="sine_antiparallel",
)  # fmt: skip
step(
    between, "swing_cosine", "c_F", _HALF.format("cosine"),
    at_parallel="cosine_parallel", at_antiparallel="cosine_antiparallel",
)  # fmt: skip


@either(units="rad", symbol="mu_F", source=POSITION)
def transmission_angle_F(
    by_direction_of_AB: Any, swing_sine: Any, swing_cosine: Any, ratio_sign: Any, u_x: Any, u_y: Any,
    v_x: Any, v_y: Any, u_v: Any,
) -> Any:  # fmt: skip
    """Transmission angle at F: between FP and FQ."""
    by_AB = by_direction_of_AB == 1.0
    y = select(by_AB, 2.0 * sqrt(swing_sine * swing_cosine), abs(u_v))
    x = select(by_AB, swing_cosine - swing_sine, u_x * v_x + u_y * v_y)
    return atan2(y, -(ratio_sign * x))
