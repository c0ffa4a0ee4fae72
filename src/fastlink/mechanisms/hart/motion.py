"""Facts of position of Hart's linkage, driven by MA.

With u = e^(i phi) and p = Z - Z0, q = C - C0, sigma^2 = p q of the four-bar MABN (docs/numerics.md) the bars from M to
F are, for lambda > 0 (else they are turned round),

    MP = m u,    PF = m (p - q + 2 i s sigma),    so that F = m (C0 - Z0) + i m (sin phi + 2 s sigma):

the line, without any angle of the four-bar, whatever kappa is. P and Q are A and B as seen from M and N, over lambda,
and e^(i omega) is minus PF over u and p.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastlink.mechanisms._shared import laws
from fastlink.mechanisms._shared.laws import (
    KNOWN_OF_MABN,
    along,
    borrow,
    borrow_range,
    borrow_tables,
    opposite,
    product,
    quotient,
    same,
    size,
    total,
)
from fastlink.mechanisms.hart.inputs import PAGE, WUNDERLICH, hart
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.numerics.compensated import (
    UNIT_ROUNDING,
    gap_product_quotient,
    pair_product,
    sum_of_four,
    two_product,
    two_sum,
)
from fastlink.numerics.elementary import NOT_A_NUMBER, atan2, select, sqrt
from fastlink.numerics.vectors import largest, zero_where

# -- Facts of one design of Hart's linkage, over a power of two near its longest given bar

# Whether it assembles, where its toggles are, how long its line is: all of it follows from r - e and r + e
# for four reaches r = (1 +- K)(m +- n), with K = |kappa| and e = d, or -d where K > 1. They are products of
# sums in twice the working precision, so no difference from d cancels. But for factors 1 +- K they are the
# eight factors of the four-bar MABN (eq. (1) of Hayes et al.), which lose all digits where kappa is near 1
# or -1; these do not.


NUMERICS = f"{PAGE}#numerics"
#: Beyond these powers of two the fourth power of kappa, or of its inverse, is not a double.
LEAST_KAPPA, GREATEST_KAPPA = 2.0**-200, 2.0**200

step = hart.steps(units="1", source=NUMERICS)
# the facts of the scale are made for four lengths: three are given
step(laws.valid, "lengths_are_valid", "lengths_are_valid", a1="m", a2="n", a3="d", a4="d")
step(laws.lift, "lift", "lift", a1="m", a2="n", a3="d", a4="d")
step(laws.unit, "unit", "unit", a1="m", a2="n", a3="d", a4="d", units="m")
step(laws.scaled, "s_m", "s_m", "scaled length m", length="m")
step(laws.scaled, "s_n", "s_n", "scaled length n", length="n")
step(laws.scaled, "s_d", "s_d", "scaled length d", length="d")
step(size, "K", "K", "Size of kappa", x="kappa")


@hart.quantity(units="1", symbol="valid", source=NUMERICS, internal=True)
def valid(lengths_are_valid: Any, K: Any) -> Any:
    """1 where the lengths are, and kappa is not 0, 1 or -1, nor beyond its limits; else NaN."""
    within = (K >= LEAST_KAPPA) & (K <= GREATEST_KAPPA) & (K != 1.0)
    return select(within & (lengths_are_valid == 1.0), 1.0, NOT_A_NUMBER)


@hart.quantity(units="1", symbol="sgn lambda", source=NUMERICS, internal=True)
def lambda_sign(K: Any) -> Any:
    """1 where P lies on the ray from M through A, -1 where it lies beyond M; and alike for Q."""
    return select(K < 1.0, 1.0, -1.0)


step(opposite, "minus_K", "minus_K", "-K", x="K")
step(opposite, "minus_s_n", "minus_s_n", "minus the scaled length n", x="s_n")
step(product, "e", "e", "d, or -d where K > 1, scaled", x="lambda_sign", y="s_d")
step(opposite, "minus_e", "minus_e", "-e", x="e")


@hart.quantity(units="1", symbol="|lambda|", source=NUMERICS, internal=True, low="size_lambda_low")
def size_lambda(K: Any, lambda_sign: Any) -> Any:
    """Size of 1 - kappa^2."""
    less, less_low = two_sum(1.0, -K)
    more, more_low = two_sum(1.0, K)
    high, low = pair_product(less, less_low, more, more_low)
    return lambda_sign * high, lambda_sign * low


# -- reaches --------------------------------------------------------------------------------------------------


def reach(K: Any, s_m: Any, s_n: Any) -> Any:
    """Return (1 + K)(m + n)."""
    k, k_low = two_sum(1.0, K)
    sum_, sum_low = two_sum(s_m, s_n)
    return pair_product(k, k_low, sum_, sum_low)


@hart.quantity(units="1", symbol="u P", source=NUMERICS, internal=True)
def gap_rounding(far_sum: Any, s_d: Any) -> Any:
    """Effect of half a unit in the last place of each length on a reach less d, which counts as 0 below it."""
    return UNIT_ROUNDING * (far_sum + s_d)


def unless_rounding(reach: Any, reach_low: Any, other: Any, gap_rounding: Any) -> Any:
    """Return the sum of a reach and another length, 0 within the rounding of the lengths."""
    total, _low = sum_of_four(reach, reach_low, other, 0.0)
    return zero_where(abs(total) <= gap_rounding, total)


def declare_reach(name: str, text: str, **given: str) -> None:
    """Declare a reach, its excess over e and -e, and the excess of its square over that of d."""
    low, less, plus = f"{name}_low", f"{name}_less", f"{name}_plus"
    step(reach, name, text, text, low=low, **given)
    step(unless_rounding, less, text, f"{text} - e", reach=name, reach_low=low, other="minus_e")
    step(unless_rounding, plus, text, f"{text} + e", reach=name, reach_low=low, other="e")
    step(product, f"{name}_excess", text, f"square of {text} less that of d", x=less, y=plus)


declare_reach("far_sum", "(1 + K)(m + n)", K="K", s_n="s_n")
declare_reach("far_difference", "(1 + K)(m - n)", K="K", s_n="minus_s_n")
declare_reach("near_sum", "(1 - K)(m + n)", K="minus_K", s_n="s_n")
declare_reach("near_difference", "(1 - K)(m - n)", K="minus_K", s_n="minus_s_n")


@hart.quantity(units="1", symbol="assembles", source=f"{PAGE}#stroke", internal=True)
def assembles(far_sum_excess: Any, near_difference_excess: Any, valid: Any) -> Any:
    """1 where |1 - K||m - n| <= d <= (1 + K)(m + n), else 0."""
    within = (far_sum_excess >= 0.0) & (near_difference_excess <= 0.0)
    return select(within & (valid == 1.0), 1.0, 0.0)


# -- toggles of the four-bar MABN by phi ----------------------------------------------------------------------


def toggle(
    near_sum: Any, near_sum_low: Any, far_difference: Any, far_difference_low: Any, other: Any, divisor: Any,
    s_m: Any, gap_rounding: Any, valid: Any,
) -> Any:  # fmt: skip
    """Return (near_sum + other)(far_difference + other)/(4 m divisor)."""
    f, f_low = sum_of_four(near_sum, near_sum_low, other, 0.0)
    g, g_low = sum_of_four(far_difference, far_difference_low, other, 0.0)
    high, low = gap_product_quotient(f, f_low, g, g_low, s_m, divisor)
    none = (abs(f) <= gap_rounding) | (abs(g) <= gap_rounding)
    return select(valid == 1.0, zero_where(none, high), NOT_A_NUMBER), zero_where(none, low)


_INNER = "squared sine of half of phi at the inner toggle, negative if none"
_OUTER = "squared cosine of half of phi at the outer toggle, negative if none"
step(toggle, "Z0", "Z_0", _INNER, other="minus_e", divisor="minus_e", low="Z0_low")
step(toggle, "C0", "C_0", _OUTER, other="e", divisor="e", low="C0_low")


# -- The four-bar MABN of Hart's linkage, driven by MA: a planar 4R, whose position and graded range it
#    reuses

# Its toggles are those of `design_facts`, in which lambda is divided out, as it is here where lengths are
# over lengths.


PLANAR = "docs/numerics.md"
POSITION = f"{WUNDERLICH}, eqs. (1.2) to (1.4); {NUMERICS}"


length = hart.steps(units="m", source=NUMERICS)
length(size, "size_a", "size_a", "length MA", x="a")
length(size, "size_b", "size_b", "length NB", x="b")
length(size, "size_c", "size_c", "length AB", x="c")
step(product, "s_a", "s_a", "scaled length MA", x="size_lambda", y="s_m")
step(product, "s_b", "s_b", "scaled length NB", x="size_lambda", y="s_n")
step(product, "s_c", "s_c", "scaled length AB", x="K", y="s_d")


@hart.quantity(units="1", symbol="MN - MA", source=NUMERICS, internal=True)
def ground_excess(s_d: Any, s_m: Any, size_lambda: Any, size_lambda_low: Any) -> Any:
    """Length MN less MA, scaled, right to a rounding."""
    arm, arm_low = pair_product(size_lambda, size_lambda_low, s_m, 0.0)
    total, _low = sum_of_four(s_d, -arm, -arm_low, 0.0)
    return total


@hart.quantity(units="1", symbol="AB - NB", source=NUMERICS, internal=True)
def coupler_excess(K: Any, s_d: Any, s_n: Any, size_lambda: Any, size_lambda_low: Any) -> Any:
    """Length AB less NB, scaled, right to a rounding."""
    coupler, coupler_low = two_product(K, s_d)
    arm, arm_low = pair_product(size_lambda, size_lambda_low, s_n, 0.0)
    total, _low = sum_of_four(coupler, coupler_low, -arm, -arm_low)
    return total


@hart.quantity(units="1", symbol="-2 delta", source=f"{PLANAR}#position", internal=True)
def output_offset(s_n: Any, coupler_excess: Any, s_m: Any, s_d: Any) -> Any:
    """NB (AB - NB)/(2 MA MN), lambda divided out."""
    return (s_n * coupler_excess) / (2.0 * (s_m * s_d))


@hart.quantity(units="1", symbol="2 beta", source=f"{PLANAR}#position", internal=True)
def coupler_offset(K: Any, coupler_excess: Any, s_a: Any) -> Any:
    """AB (AB - NB)/(2 MA MN), MN divided out."""
    return (K * coupler_excess) / (2.0 * s_a)


@hart.quantity(units="1", symbol="gamma_0", source=f"{PLANAR}#rates", internal=True)
def gamma0(ground_excess: Any, s_a: Any, s_d: Any) -> Any:
    """(MN - MA)^2/(4 MA MN): squared distance of A and N over 4 MA MN, at phi = 0."""
    return ground_excess * ground_excess / (4.0 * (s_a * s_d))


@hart.quantity(units="1", symbol="lambda", source=f"{PLANAR}#rates", internal=True)
def crank_excess(ground_excess: Any, s_d: Any) -> Any:
    """(MA - MN)/(2 MN)."""
    return -(0.5 * ground_excess) / s_d


@hart.quantity(units="1", symbol="kappa", source=f"{PLANAR}#rates", internal=True)
def squares_excess(coupler_excess: Any, s_b: Any, s_c: Any, s_a: Any, s_d: Any) -> Any:
    """(AB^2 - NB^2)/(4 MA MN)."""
    return coupler_excess * (s_c + s_b) / (4.0 * (s_a * s_d))


@hart.quantity(units="m", symbol="AN_x", source=f"{PLANAR}#position", internal=True)
def AN_x(ground_excess: Any, size_a: Any, Z: Any, lift: Any, unit: Any) -> Any:
    """Vector from A to N, x."""
    return ground_excess * unit / lift + 2.0 * size_a * Z


@hart.quantity(units="1", symbol="w", source=f"{PLANAR}#extremes", internal=True)
def range_width(
    far_sum_less: Any, far_sum_plus: Any, near_difference_less: Any, near_difference_plus: Any, Z0: Any,
    C0: Any, s_m: Any, s_n: Any, e: Any, K: Any, assembles: Any,
) -> Any:  # fmt: skip
    """Width of the reachable range of phi in Z; NaN where the design never assembles."""
    to_pi = far_sum_plus * near_difference_plus / (4.0 * (s_m * e))
    from_0 = -(far_sum_less * near_difference_less) / (4.0 * (s_m * e))
    high = C0 > 0.0
    width = select(Z0 > 0.0, select(high, K * (s_n / s_m), to_pi), select(high, from_0, 1.0))
    return select(assembles == 1.0, width, NOT_A_NUMBER)


def near_factor(K: Any, lambda_sign: Any, reach: Any) -> Any:
    """Return a factor of MABN that has 1 + K as a factor, from the other one."""
    return (1.0 + K) * (lambda_sign * reach)


def far_factor(K: Any, reach: Any) -> Any:
    """Return a factor of MABN that has 1 - K as a factor, from the other one; with its size."""
    return abs(1.0 - K) * reach


for _law, _name, _reach in (
    (near_factor, "sure_A1", "near_sum_less"),
    (near_factor, "factor_B2", "near_difference_less"),
    (near_factor, "factor_C2", "near_difference_plus"),
    (far_factor, "factor_A2", "far_sum_less"),
    (far_factor, "factor_D2", "far_sum_plus"),
    (far_factor, "sure_B1", "far_difference_less"),
    (far_factor, "sure_C1", "far_difference_plus"),
):
    _letters = f"{_name[-2]}_{_name[-1]}"
    step(_law, _name, _letters, f"factor {_name[-2:]} of MABN, zero within rounding", reach=_reach)

PREFIX = "bar_"
#: The names of MABN's values as a planar 4R.
NAMES = {"a1": "size_a", "a2": "size_c", "a3": "size_b", "a4": "d"}
NAMES |= {"s1": "s_a", "s2": "s_c", "s3": "s_b", "s4": "s_d"}
NAMES |= {"theta1": "phi", "cos_theta1": "cos_phi", "sin_theta1": "sin_phi", "p": "past_Z0", "q": "past_C0"}
NAMES |= {"DB_x": "NB_x", "DB_y": "B_y", "theta4": "psi", "output_ratio": "dpsi_dphi"}
NAMES |= {
    name: name
    for name in ("sure_A1", "sure_B1", "sure_C1", "factor_A2", "factor_B2", "factor_C2", "factor_D2")
}
NAMES |= {
    name: name for name in ("Z", "Z_low", "C", "C_low", "Z0", "Z0_low", "C0", "C0_low", "sigma", "per_sigma")
}
NAMES |= {
    name: name
    for name in ("coupler_offset", "branch_sign", "output_offset", "gamma0", "crank_excess", "range_width")
}
NAMES |= {"kappa": "squares_excess", "AD_x": "AN_x", "assembles": "assembles", "valid": "valid"}
NAMES |= {name: name for name in ("A_x", "A_y", "AB_x", "AB_y", "grashof_class")}

borrow_tables(hart, planar_4r, NAMES)

LABELS: dict[str, dict[str, Any]] = {
    "A_x": {"source": POSITION},
    "A_y": {"source": POSITION},
    "AB_x": {},
    "AB_y": {},
    "DB_y": {"symbol": "B_y", "meaning": "Joint B, y", "source": POSITION, "internal": False},
    "theta4": {"symbol": "psi", "meaning": "Direction of NB in the ground frame", "source": POSITION},
    "output_ratio": {
        "symbol": "dpsi/dphi",
        "meaning": "Rate of the direction of NB by that of MA",
        "source": f"{WUNDERLICH}, eq. (2.4), differentiated",
        "internal": False,
    },
    "grashof_class": {
        "meaning": "Type of the four-bar MABN, with the crank MA, the coupler AB and the output link NB"
    },
}
borrow(hart, planar_4r, NAMES, PREFIX, LABELS)

assert planar_4r.graded is not None
borrow_range(
    hart,
    planar_4r,
    NAMES,
    PREFIX,
    cells={"psi": planar_4r.graded.cells["theta4"], "dpsi_dphi": planar_4r.graded.cells["omega4"]},
    max_extrema={
        "psi": planar_4r.graded.max_extrema["theta4"],
        "dpsi_dphi": planar_4r.graded.max_extrema["omega4"],
    },
    known=KNOWN_OF_MABN,
    not_differentiable=("F_x", "F_along_AB", "F_deviation", "closure_residual"),
    wraps_at={"psi": "B_y", "omega_angle": "sine_part"},
)


# -- the bars from M to F -------------------------------------------------------------------------------------


@hart.quantity(units="m", symbol="m", source=POSITION, internal=True)
def m_along(m: Any, lambda_sign: Any, valid: Any) -> Any:
    """Length of MP along MA, with a sign."""
    return select(valid == 1.0, lambda_sign * m, NOT_A_NUMBER)


@hart.quantity(units="1", symbol="p - q", source=POSITION, internal=True)
def PF_along(past_Z0: Any, past_C0: Any, sigma: Any) -> Any:
    """PF over m, x; NaN where the loop does not close."""
    return select(sigma >= 0.0, past_Z0 - past_C0, NOT_A_NUMBER)


@hart.quantity(units="1", symbol="2 s sigma", source=POSITION, internal=True)
def PF_across(sigma: Any, branch_sign: Any) -> Any:
    """PF over m, y."""
    return branch_sign * (2.0 * sigma)


def middle(start: Any, length: Any, direction: Any) -> Any:
    """Return where the middle of a bar is."""
    return start + 0.5 * (length * direction)


def from_start(start: Any, x: Any, lambda_: Any) -> Any:
    """Return start + x/lambda."""
    return start + x / lambda_


joint = hart.quantities(units="m", source=POSITION)
joint(product, "P_x", "P_x", "Joint P, x", x="m_along", y="cos_phi")
joint(product, "P_y", "P_y", "Joint P, y", x="m_along", y="sin_phi")
joint(middle, "PF_mid_x", "PF_mid_x", "Middle of PF, x", start="P_x", length="m_along", direction="PF_along")
joint(middle, "PF_mid_y", "PF_mid_y", "Middle of PF, y", start="P_y", length="m_along", direction="PF_across")
joint(total, "B_x", "B_x", "Joint B, x", x="d", y="NB_x")
joint(along, "F_y", "F_y", "Joint F, y", start="P_y", length="m_along", direction="PF_across")
joint(from_start, "Q_x", "Q_x", "Joint Q, x", start="d", x="NB_x")
joint(quotient, "Q_y", "Q_y", "Joint Q, y", x="B_y", y="lambda_")


@hart.quantity(units="m", symbol="F_x", source=f"{POSITION}, eq. (7.5)")
def F_x(line_x: Any, sigma: Any) -> Any:
    """Point F, x: that of its line, where the linkage assembles."""
    return select(sigma >= 0.0, line_x, NOT_A_NUMBER)


@hart.quantity(units="1", symbol="kappa n/m sin omega", source=POSITION, internal=True)
def sine_part(PF_along: Any, PF_across: Any, cos_phi: Any, sin_phi: Any) -> Any:
    """Sine of omega times K n/m."""
    return PF_along * sin_phi - PF_across * cos_phi


@hart.quantity(units="1", symbol="kappa n/m cos omega", source=POSITION, internal=True)
def cosine_part(PF_along: Any, PF_across: Any, cos_phi: Any, sin_phi: Any) -> Any:
    """Cosine of omega times K n/m."""
    return -(PF_along * cos_phi + PF_across * sin_phi)


@hart.quantity(units="rad", symbol="omega", source=f"{WUNDERLICH}, eqs. (1.1) to (1.3)")
def omega_angle(sine_part: Any, cosine_part: Any, kappa: Any) -> Any:
    """Angle omega of eq. (1.3), the angle MPF; half a turn more where kappa is negative."""
    sign = select(kappa < 0.0, -1.0, 1.0)
    return atan2(sign * sine_part + 0.0, sign * cosine_part)


@hart.quantity(units="m rad-1", symbol="dF_y/dphi", source=f"{PAGE}#rates-and-extremes")
def dF_y_dphi(m_along: Any, sine_part: Any, per_sigma: Any, branch_sign: Any) -> Any:
    """Rate of F along its line by the direction of MA."""
    return -(branch_sign * (0.5 * m_along * (sine_part * per_sigma)))


# -- rounding errors -----------------------------------------------------------------------------------------


@hart.quantity(units="1", symbol="u", source=NUMERICS)
def F_deviation(P_x: Any, m_along: Any, PF_along: Any, line_x: Any, m: Any, n: Any, K: Any) -> Any:
    """Distance of the end of MP and PF as computed from the line, in units of 2^-53 (MP + PF)."""
    return abs((P_x + m_along * PF_along) - line_x) / (UNIT_ROUNDING * (m + K * n))


@hart.quantity(units="m", symbol="l", source=NUMERICS, internal=True)
def longest(m: Any, n: Any, d: Any, K: Any, size_a: Any, size_b: Any, size_c: Any) -> Any:
    """Longest of the bars."""
    return largest(largest(m, n, d, size_c), largest(size_a, size_b, K * m, K * n), 0.0, 0.0)


def bar_error(x: Any, y: Any, x0: Any, y0: Any, length: Any, longest: Any) -> Any:
    """Return by how much the distance of two joints misses the length of their bar, over the longest bar."""
    u = (x - x0) / longest
    v = (y - y0) / longest
    return sqrt(u * u + v * v) - length / longest


def fixed_bar_error(x: Any, y: Any, x0: Any, length: Any, longest: Any) -> Any:
    """Return the same of a bar from a ground pivot."""
    u = (x - x0) / longest
    v = y / longest
    return sqrt(u * u + v * v) - length / longest


step = hart.steps(units="m", source=NUMERICS)
step(product, "size_p", "|p|", "Length PF", x="K", y="n")
step(product, "size_q", "|q|", "Length QF", x="K", y="m")


def declare_bar(name: str, law: Callable[..., Any], ends: str, **given: str) -> None:
    """Declare by how much the distance of two joints misses the length of their bar."""
    meaning = f"by how much the distance {ends} misses the length of its bar, over the longest bar"
    to = {"x": f"{ends[1]}_x", "y": f"{ends[1]}_y"}
    hart.steps(units="1", source=NUMERICS)(law, name, ends, meaning, **to, **given)


BAR_ERRORS = ("AB_error", "PF_error", "QF_error", "NB_error", "NQ_error")
declare_bar("AB_error", bar_error, "AB", x0="A_x", y0="A_y", length="size_c")
declare_bar("PF_error", bar_error, "PF", x0="P_x", y0="P_y", length="size_p")
declare_bar("QF_error", bar_error, "QF", x0="Q_x", y0="Q_y", length="size_q")
declare_bar("NB_error", fixed_bar_error, "NB", x0="d", length="size_b")
declare_bar("NQ_error", fixed_bar_error, "NQ", x0="d", length="n")


@hart.quantity(units="1", symbol="r", source=NUMERICS)
def closure_residual(AB_error: Any, PF_error: Any, QF_error: Any, NB_error: Any, NQ_error: Any) -> Any:
    """Closure error of the bars AB, PF, QF, NB and NQ by the joints as computed, relative to the longest bar."""
    moving = AB_error * AB_error + (PF_error * PF_error + QF_error * QF_error)
    return sqrt(moving + (NB_error * NB_error + NQ_error * NQ_error))


hart.derivatives("phi")(same, "F_y", x="dF_y_dphi")


# -- Facts of one design of Hart's linkage: its bars, where the line is and how much of it F traces, the
#    kite

# With t = y of F, eqs. (1.5) say t^2 = G - H cos(omega), H = 2 K m n, and G - H and G + H are products of
# reaches less d: F runs from one end of its segment to the other and back while omega turns. Where G > H
# the segment does not reach the line MN, and there is a second one, its mirror image.


STROKE = f"{PAGE}#stroke"
KITE = f"{WUNDERLICH}, eq. (7.6)"
STATUS_FLAGS = {
    0: "one_segment",
    1: "two_segments",
    2: "change_point",
    3: "rigid",
    4: "never_assembles",
    5: "kappa_is_0",
    6: "kappa_is_1_or_minus_1",
    7: "invalid_input",
    8: "beyond_range",
}
KITE_FLAGS = {0: "no", 1: "kite_with_m_equal_p", 2: "kite_with_n_equal_q"}


@hart.quantity(units="1", symbol="lambda", source=f"{WUNDERLICH}, eq. (7.3)")
def lambda_(lambda_sign: Any, size_lambda: Any, valid: Any) -> Any:
    """Factor a/m = b/n, 1 - kappa^2: negative where A and P lie on opposite sides of M."""
    return select(valid == 1.0, lambda_sign * size_lambda, NOT_A_NUMBER)


def ratio_times(ratio: Any, length: Any, valid: Any) -> Any:
    """Return ratio times length."""
    return select(valid == 1.0, ratio * length, NOT_A_NUMBER)


def minus_ratio_times(ratio: Any, length: Any, valid: Any) -> Any:
    """Return minus ratio times length."""
    return select(valid == 1.0, -(ratio * length), NOT_A_NUMBER)


length = hart.quantities(units="m", source=f"{WUNDERLICH}, eq. (7.2)")
_KAPPA, _LAMBDA = {"ratio": "kappa"}, {"ratio": "lambda_"}
length(ratio_times, "p", "p", "Length of PF, kappa n, with the sign of kappa", **_KAPPA, length="n")
length(minus_ratio_times, "q", "q", "Length of QF, -kappa m, with the sign of -kappa", **_KAPPA, length="m")
length = hart.quantities(units="m", source=f"{WUNDERLICH}, eq. (7.4)")
length(
    ratio_times, "a", "a", "Length of MA along MP: negative on the extension beyond M", **_LAMBDA, length="m"
)
length(
    ratio_times, "b", "b", "Length of NB along NQ: negative on the extension beyond N", **_LAMBDA, length="n"
)
length(ratio_times, "c", "c", "Length of AB, kappa d, with the sign of kappa", **_KAPPA, length="d")


@hart.quantity(
    units="m", symbol="x", source=f"{WUNDERLICH}, eq. (7.5), corrected: {PAGE}#where-the-paper-differs"
)
def line_x(m: Any, lambda_sign: Any, Z0: Any, Z0_low: Any, C0: Any, C0_low: Any, assembles: Any) -> Any:
    """Where the line of F crosses MN, from M: d/2 + (1 - kappa^2)(m^2 - n^2)/(2 d)."""
    return select(assembles == 1.0, lambda_sign * m * ((C0 - Z0) + (C0_low - Z0_low)), NOT_A_NUMBER)


# -- the stroke -----------------------------------------------------------------------------------------------


@hart.quantity(units="1", symbol="sqrt(G + H)", source=STROKE, internal=True)
def outer_end(far_sum_excess: Any, near_difference_excess: Any, s_d: Any) -> Any:
    """Root of G + H, scaled; NaN where the linkage never assembles."""
    return 0.5 * (sqrt(far_sum_excess) * sqrt(-near_difference_excess) / s_d)


@hart.quantity(units="1", symbol="sqrt|G - H|", source=STROKE, internal=True)
def inner_end(near_sum_excess: Any, far_difference_excess: Any, s_d: Any) -> Any:
    """Root of the size of G - H, scaled."""
    return 0.5 * (sqrt(abs(near_sum_excess)) * sqrt(abs(far_difference_excess)) / s_d)


@hart.quantity(units="1", symbol="G > H", source=STROKE, internal=True)
def stays_off(near_sum_excess: Any, far_difference_excess: Any) -> Any:
    """1 where F does not reach MN, else 0."""
    return select((near_sum_excess < 0.0) != (far_difference_excess < 0.0), 1.0, 0.0)


@hart.quantity(units="m", symbol="y_{outer}", source=STROKE)
def F_y_outer(outer_end: Any, lift: Any, unit: Any, assembles: Any) -> Any:
    """Greatest distance of F from MN, where MPF and NQF are stretched; as far on the other side."""
    return select(assembles == 1.0, outer_end * unit / lift, NOT_A_NUMBER)


@hart.quantity(units="m", symbol="y_{inner}", source=STROKE)
def F_y_inner(inner_end: Any, stays_off: Any, lift: Any, unit: Any, assembles: Any) -> Any:
    """Least distance of F from MN, where MPF and NQF are folded; 0 where its line is traced across MN."""
    height = select(stays_off == 1.0, inner_end * unit / lift, 0.0)
    return select(assembles == 1.0, height, NOT_A_NUMBER)


@hart.quantity(units="m", symbol="stroke", source=STROKE)
def stroke(F_y_outer: Any, F_y_inner: Any, m: Any, n: Any, K: Any) -> Any:
    """Length of the line that F traces without disassembly."""
    # the squares of both ends differ by 4 K m n
    segment = 4.0 * (m / (F_y_outer + F_y_inner)) * (K * n)
    return select(F_y_inner > 0.0, segment, 2.0 * F_y_outer)


# -- the kite -------------------------------------------------------------------------------------------------


@hart.quantity(units="1", symbol="kite", source=KITE, flags=KITE_FLAGS)
def is_kite(
    near_sum_excess: Any, far_difference_excess: Any, far_difference: Any, lambda_sign: Any, valid: Any
) -> Any:
    """Whether MABN is a kite, so that F's line passes through M (a = c, b = d), or through N (b = c, a = d)."""
    kite = (near_sum_excess == 0.0) & (far_difference_excess == 0.0) & (valid == 1.0)
    return select(kite, select(far_difference * lambda_sign < 0.0, 1.0, 2.0), 0.0)


@hart.quantity(units="m", symbol="a", source=KITE)
def ellipse_a(is_kite: Any, m: Any) -> Any:
    """Semi-axis along the line of F of the ellipse of the middle of PF about M; NaN if that is none."""
    return select(is_kite == 1.0, 1.5 * m, NOT_A_NUMBER)


@hart.quantity(units="m", symbol="b", source=KITE)
def ellipse_b(is_kite: Any, m: Any) -> Any:
    """Semi-axis along MN of the ellipse of the middle of PF about M; NaN if that is none."""
    return select(is_kite == 1.0, 0.5 * m, NOT_A_NUMBER)


@hart.quantity(units="1", symbol="status", source=f"{STROKE}; {WUNDERLICH}, section 7", flags=STATUS_FLAGS)
def status(
    kappa: Any, F_y_inner: Any, far_sum_excess: Any, near_difference_excess: Any, near_sum_excess: Any,
    far_difference_excess: Any, assembles: Any, lengths_are_valid: Any, valid: Any,
) -> Any:  # fmt: skip
    """How F traces its line, or why there is none."""
    change_point = (near_sum_excess == 0.0) | (far_difference_excess == 0.0)
    rigid = (far_sum_excess == 0.0) | (near_difference_excess == 0.0)
    code = select(change_point, 2.0, select(F_y_inner > 0.0, 1.0, 0.0))
    code = select(rigid, 3.0, code)
    code = select(assembles == 1.0, code, 4.0)
    code = select(valid == 1.0, code, 7.0)
    code = select((lengths_are_valid == 1.0) & (abs(kappa) == 1.0), 6.0, code)
    return select((lengths_are_valid == 1.0) & (kappa == 0.0), 5.0, code)
