"""Facts of one design of the planar 4R, without any angle: status, class, ranges, swing, transmission angle.

The signs of A1, B1, C1 of eq. (1) distinguish the eight types; a factor within the rounding of the lengths is
zero, as for `status`. NaN is selected, never computed: of two NaNs in a product the compiler keeps either, and their
bits differ. Every angle is twice an arctangent of square roots of products of two factors, which are
sums of four lengths without loss: nothing cancels near a change point.

The ranges are those of one turn in [0, pi]; the lower half is their mirror. Where the range has two limits
(low > 0, high < pi) the two halves are the circuits of `circuits`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastlink.mechanisms._shared import laws
from fastlink.mechanisms.planar_4r.inputs import HAYES, LINKS, NUMERICS, planar_4r
from fastlink.numerics.compensated import UNIT_ROUNDING, gap_product_quotient, sum_of_four
from fastlink.numerics.elementary import NOT_A_NUMBER, atan2, select, sqrt
from fastlink.numerics.vectors import zero_where

# -- Scaled lengths of the planar 4R, the effect of rounding on their sums, and their ratios


step = planar_4r.steps(units="1", source=f"{NUMERICS}#scaling")
step(laws.valid, "valid", "valid", source=f"{NUMERICS}#status")
step(laws.lift, "lift", "lift")
step(laws.unit, "unit", "unit", units="m")
step(laws.scaled, "s1", "s_1", f"scaled length of the {LINKS[1]}", length="a1")
step(laws.scaled, "s2", "s_2", f"scaled length of the {LINKS[2]}", length="a2")
step(laws.scaled, "s3", "s_3", f"scaled length of the {LINKS[3]}", length="a3")
step(laws.scaled, "s4", "s_4", "scaled length of the ground link OD", length="a4")


@planar_4r.quantity(units="m-1", symbol="1/unit", source=f"{NUMERICS}#scaling", internal=True)
def per_unit(lift: Any, unit: Any) -> Any:
    """Reciprocal of the power of two at or below the longest link."""
    return lift / unit


@planar_4r.quantity(units="1", symbol="u P", source=f"{NUMERICS}#status", internal=True)
def gap_rounding(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """Effect of half a unit in the last place of each length on a sum of them, which counts as 0 below it."""
    return UNIT_ROUNDING * ((s1 + s2) + (s3 + s4))


# -- ratios that positions and rates are made of -----------------------------------------------------------------


@planar_4r.quantity(units="1", symbol="1/(4 a_1 a_4)", source=f"{NUMERICS}#scaling", internal=True)
def per_4_s1_s4(s1: Any, s4: Any) -> Any:
    """Reciprocal of four times crank times ground, scaled."""
    return 0.25 / (s1 * s4)


@planar_4r.quantity(units="1", symbol="gamma_0", source=f"{NUMERICS}#rates", internal=True)
def gamma0(s1: Any, s4: Any, per_4_s1_s4: Any) -> Any:
    """(a1 - a4)^2/(4 a1 a4): squared distance of A and D over 4 a1 a4, at theta1 = 0."""
    return (s1 - s4) * (s1 - s4) * per_4_s1_s4


@planar_4r.quantity(units="1", symbol="lambda", source=f"{NUMERICS}#rates", internal=True)
def crank_excess(s1: Any, s4: Any) -> Any:
    """(a1 - a4)/(2 a4)."""
    return 0.5 * (s1 - s4) / s4


def squares_ratio(x: Any, y: Any, per_4_s1_s4: Any) -> Any:
    """Return (x^2 - y^2)/(4 a1 a4)."""
    return (x - y) * (x + y) * per_4_s1_s4


def offset(x: Any, y: Any, per_4_s1_s4: Any) -> Any:
    """Return x (x - y)/(2 a1 a4)."""
    return 2.0 * x * (x - y) * per_4_s1_s4


def offset_less(x: Any, y: Any, per_4_s1_s4: Any) -> Any:
    """Return y (x - y)/(2 a1 a4)."""
    return 2.0 * y * (x - y) * per_4_s1_s4


step = planar_4r.steps(units="1", source=f"{NUMERICS}#rates")
step(squares_ratio, "epsilon", "epsilon", "(a1^2 - a4^2)/(4 a1 a4)", x="s1", y="s4")
step(squares_ratio, "kappa", "kappa", "(a2^2 - a3^2)/(4 a1 a4)", x="s2", y="s3")
step = planar_4r.steps(units="1", source=f"{NUMERICS}#position")
step(offset, "coupler_offset", "2 beta", "a2 (a2 - a3)/(2 a1 a4)", x="s2", y="s3")
step(offset_less, "output_offset", "-2 delta", "a3 (a2 - a3)/(2 a1 a4)", x="s2", y="s3")


# -- The eight factors of the coefficients of the input-output equations, eq. (1), as sums without loss


def _factor(law: Callable[..., Any]) -> Callable[..., Any]:
    """Declare a factor of eq. (1), a sum without loss: high and low part."""
    name = law.__name__
    return planar_4r.quantity(
        units="1",
        symbol=f"{name[-2]}_{name[-1]}",
        source=f"{HAYES}, eq. (1)",
        internal=True,
        low=f"{name}_low",
    )(law)


@_factor
def factor_A1(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 - a2 + a3 - a4, scaled."""
    return sum_of_four(s1, -s2, s3, -s4)


@_factor
def factor_A2(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 + a2 + a3 - a4, scaled."""
    return sum_of_four(s1, s2, s3, -s4)


@_factor
def factor_B1(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 + a2 - a3 - a4, scaled."""
    return sum_of_four(s1, s2, -s3, -s4)


@_factor
def factor_B2(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 - a2 - a3 - a4, scaled."""
    return sum_of_four(s1, -s2, -s3, -s4)


@_factor
def factor_C1(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 - a2 - a3 + a4, scaled."""
    return sum_of_four(s1, -s2, -s3, s4)


@_factor
def factor_C2(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 + a2 - a3 + a4, scaled."""
    return sum_of_four(s1, s2, -s3, s4)


@_factor
def factor_D1(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 + a2 + a3 + a4, scaled."""
    return sum_of_four(s1, s2, s3, s4)


@_factor
def factor_D2(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 - a2 + a3 + a4, scaled."""
    return sum_of_four(s1, -s2, s3, s4)


# -- Toggles of the planar 4R: where the coupler and the output link are in line, in twice the working
#    precision


@planar_4r.quantity(units="1", symbol="Z_0", source=f"{NUMERICS}#toggles", internal=True, low="Z0_low")
def Z0(
    factor_A1: Any, factor_A1_low: Any, factor_B1: Any, factor_B1_low: Any, s1: Any, s4: Any,
    gap_rounding: Any, valid: Any,
) -> Any:  # fmt: skip
    """Squared half-angle sine at the inner toggle, -A1 B1/(4 a1 a4); negative if none."""
    high, low = gap_product_quotient(factor_A1, factor_A1_low, -factor_B1, -factor_B1_low, s1, s4)
    none = (abs(factor_A1) <= gap_rounding) | (abs(factor_B1) <= gap_rounding)
    return zero_where(none, high) * valid, zero_where(none, low)


@planar_4r.quantity(units="1", symbol="C_0", source=f"{NUMERICS}#toggles", internal=True, low="C0_low")
def C0(
    factor_C1: Any, factor_C1_low: Any, factor_D1: Any, factor_D1_low: Any, s1: Any, s4: Any,
    gap_rounding: Any, valid: Any,
) -> Any:  # fmt: skip
    """Squared half-angle cosine at the outer toggle, C1 D1/(4 a1 a4); negative if none."""
    high, low = gap_product_quotient(factor_C1, factor_C1_low, factor_D1, factor_D1_low, s1, s4)
    none = abs(factor_C1) <= gap_rounding
    return zero_where(none, high) * valid, zero_where(none, low)


STATUS = f"{HAYES}, eq. (1); {NUMERICS}#status"
TOGGLES = f"{NUMERICS}#toggles"
STATUS_FLAGS = {
    0: "rotates_fully",
    1: "assembles_over_part_of_the_turn",
    2: "never_assembles",
    3: "change_point",
    4: "invalid_input",
    5: "assembles_in_one_position",
    6: "beyond_range",
}
CLASS_FLAGS = {
    0: "crank_rocker",
    1: "double_crank",
    2: "double_rocker",
    3: "rocker_crank",
    4: "triple_rocker_longest_crank",
    5: "triple_rocker_longest_coupler",
    6: "triple_rocker_longest_output_link",
    7: "triple_rocker_longest_ground",
    8: "change_point",
    9: "change_point_parallelogram",
    10: "change_point_kite_a1_a4",
    11: "change_point_kite_a1_a2",
    12: "change_point_rhombus",
    13: "never_assembles",
    14: "invalid_input",
}


@planar_4r.quantity(units="1", symbol="assembles", source=STATUS, internal=True)
def assembles(factor_A2: Any, factor_B2: Any, factor_C2: Any, factor_D2: Any, valid: Any) -> Any:
    """1 where the design assembles at some angle, else 0."""
    one_too_long = (factor_A2 < 0.0) | (factor_B2 > 0.0) | (factor_C2 < 0.0) | (factor_D2 < 0.0)
    return select(one_too_long, 0.0, select(valid == 1.0, 1.0, 0.0))


@planar_4r.quantity(units="1", symbol="rigid", source=STATUS, internal=True)
def rigid(factor_A2: Any, factor_B2: Any, factor_C2: Any, factor_D2: Any, gap_rounding: Any) -> Any:
    """1 where one link is as long as the others together: they lie in one line."""
    crank_or_coupler = (abs(factor_A2) <= gap_rounding) | (abs(factor_B2) <= gap_rounding)
    output_or_ground = (abs(factor_C2) <= gap_rounding) | (abs(factor_D2) <= gap_rounding)
    return select(crank_or_coupler | output_or_ground, 1.0, 0.0)


@planar_4r.quantity(units="1", symbol="status", source=STATUS, flags=STATUS_FLAGS)
def status(
    factor_A1: Any, factor_B1: Any, factor_C1: Any, gap_rounding: Any, rigid: Any, assembles: Any, valid: Any
) -> Any:  # fmt: skip
    """How the design assembles over a full turn of the input."""
    change_point = (
        (abs(factor_A1) <= gap_rounding) | (abs(factor_B1) <= gap_rounding) | (abs(factor_C1) <= gap_rounding)
    )
    turns = (factor_A1 * factor_B1 >= 0.0) & (factor_C1 <= 0.0)
    code = select(change_point, 3.0, select(turns, 0.0, 1.0))
    code = select(rigid == 1.0, 5.0, code)
    code = select(assembles == 1.0, code, 2.0)
    return select(valid == 1.0, code, 4.0)


def unless_rounding(factor: Any, gap_rounding: Any) -> Any:
    """Return a factor, zero where it is at most the rounding of the lengths."""
    return zero_where(abs(factor) <= gap_rounding, factor)


step = planar_4r.steps(units="1", source=STATUS)
step(unless_rounding, "sure_A1", "A_1", "A1, zero within the rounding of the lengths", factor="factor_A1")
step(unless_rounding, "sure_B1", "B_1", "B1, zero within the rounding of the lengths", factor="factor_B1")
step(unless_rounding, "sure_C1", "C_1", "C1, zero within the rounding of the lengths", factor="factor_C1")


@planar_4r.quantity(units="1", symbol="class", source=STATUS, flags=CLASS_FLAGS)
def grashof_class(sure_A1: Any, sure_B1: Any, sure_C1: Any, assembles: Any, valid: Any) -> Any:
    """Type of the linkage: the links that turn fully, or the longest link, or the kind of change point."""
    a = sure_A1 > 0.0
    b = sure_B1 > 0.0
    c = sure_C1 > 0.0
    # One sign differs, or none: the link that it names is the shortest (Grashof) or the longest (not).
    with_a = select(b, select(c, 4.0, 1.0), select(c, 2.0, 6.0))
    without_a = select(b, select(c, 3.0, 5.0), select(c, 7.0, 0.0))
    code = select(a, with_a, without_a)
    A_zero, B_zero, C_zero = sure_A1 == 0.0, sure_B1 == 0.0, sure_C1 == 0.0
    code = select(A_zero | B_zero | C_zero, 8.0, code)
    code = select(B_zero & C_zero, 9.0, code)
    code = select(A_zero & B_zero, 10.0, code)
    code = select(A_zero & C_zero, 11.0, code)
    code = select(A_zero & B_zero & C_zero, 12.0, code)
    code = select(assembles == 1.0, code, 13.0)
    return select(valid == 1.0, code, 14.0)


@planar_4r.quantity(units="m", symbol="l + s - p - q", source=STATUS)
def grashof_excess(sure_A1: Any, sure_B1: Any, sure_C1: Any, lift: Any, unit: Any, valid: Any) -> Any:
    """Longest plus shortest link minus the other two: negative in Grashof's linkages, 0 at a change point."""
    # It is the least of |A1|, |B1|, |C1|, with the sign of their product.
    size = select(abs(sure_A1) < abs(sure_B1), abs(sure_A1), abs(sure_B1))
    size = select(size < abs(sure_C1), size, abs(sure_C1))
    sign = select(sure_A1 < 0.0, -1.0, 1.0) * select(sure_B1 < 0.0, -1.0, 1.0)
    sign = select(sure_C1 < 0.0, -sign, sign)
    return select(valid == 1.0, (sign * size + 0.0) * unit / lift, NOT_A_NUMBER)


# -- square roots of squared half-angle sines and cosines at the limits, over common factors -----------------


def limit_root(x: Any, y: Any) -> Any:
    """Half-angle sine or cosine at a limit, over a common factor: sqrt(x y), 0 without such a limit."""
    product = x * y
    return select(product > 0.0, sqrt(product), 0.0)


def opposite_limit_root(x: Any, y: Any) -> Any:
    """Half-angle sine or cosine at a limit, over a common factor: sqrt(-x y), 0 without such a limit."""
    product = -(x * y)
    return select(product > 0.0, sqrt(product), 0.0)


def product_root(x: Any, y: Any) -> Any:
    """Half-angle sine or cosine at a limit, over a common factor: sqrt(x y), both factors positive."""
    return sqrt(x) * sqrt(y)


def opposite_product_root(x: Any, y: Any) -> Any:
    """Half-angle sine or cosine at a limit, over a common factor: sqrt(-x y), the second factor negative."""
    return sqrt(x) * sqrt(-y)


step = planar_4r.steps(units="1", source=TOGGLES)
step(opposite_limit_root, "sine_low_1", "sqrt(-A_1 B_1)", x="sure_A1", y="sure_B1")
step(product_root, "cosine_low_1", "sqrt(C_2 D_2)", x="factor_C2", y="factor_D2")
step(opposite_product_root, "sine_high_1", "sqrt(-A_2 B_2)", x="factor_A2", y="factor_B2")
step(limit_root, "cosine_high_1", "sqrt(C_1 D_1)", x="sure_C1", y="factor_D1")
step(opposite_limit_root, "sine_low_4", "sqrt(-B_1 D_1)", x="sure_B1", y="factor_D1")
step(product_root, "cosine_low_4", "sqrt(A_2 C_2)", x="factor_A2", y="factor_C2")
step(opposite_product_root, "sine_high_4", "sqrt(-B_2 D_2)", x="factor_D2", y="factor_B2")
step(limit_root, "cosine_high_4", "sqrt(A_1 C_1)", x="sure_A1", y="sure_C1")
step(limit_root, "sine_least_mu", "sqrt(A_1 B_1)", x="sure_A1", y="sure_B1")
step(opposite_limit_root, "cosine_greatest_mu", "sqrt(-C_1 D_1)", x="sure_C1", y="factor_D1")


def twice_arctangent(sine: Any, cosine: Any, assembles: Any) -> Any:
    """Angle in [0, pi] from two numbers in proportion to its half-angle's sine and cosine."""
    return select(assembles == 1.0, 2.0 * atan2(sine, cosine), NOT_A_NUMBER)


def declare_limit(name: str, symbol: str, meaning: str, sine: str, cosine: str) -> None:
    """Declare an angle at a limit."""
    limit = planar_4r.quantities(units="rad", source=TOGGLES)
    limit(twice_arctangent, name, symbol, meaning, sine=sine, cosine=cosine)


_LEAST = "Least transmission angle over the reachable range: at theta1 = 0, or 0 at a toggle"
_GREATEST = "Greatest transmission angle over the reachable range: at theta1 = pi, or pi at a toggle"
declare_limit("theta1_low", "theta_1", "Least reachable |theta1|, 0 if none", "sine_low_1", "cosine_low_1")
declare_limit(
    "theta1_high", "theta_1", "Greatest reachable |theta1|, pi if none", "sine_high_1", "cosine_high_1"
)
declare_limit("theta4_low", "theta_4", "Least reachable |theta4|, 0 if none", "sine_low_4", "cosine_low_4")
declare_limit(
    "theta4_high", "theta_4", "Greatest reachable |theta4|, pi if none", "sine_high_4", "cosine_high_4"
)
declare_limit("transmission_angle_least", "mu", _LEAST, "sine_least_mu", "sine_high_1")
declare_limit("transmission_angle_greatest", "mu", _GREATEST, "cosine_low_1", "cosine_greatest_mu")


@planar_4r.quantity(units="rad", symbol="Delta theta_4", source=TOGGLES)
def swing(
    sine_low_4: Any, cosine_low_4: Any, sine_high_4: Any, cosine_high_4: Any, theta4_high: Any, s1: Any,
    s2: Any, s3: Any, s4: Any, assembles: Any,
) -> Any:  # fmt: skip
    """Angle that the output link sweeps in one circuit; 2 pi where it turns fully."""
    # sin^2(high/2) - sin^2(low/2) = a1 a2/(a3 a4): the difference of the limits does not cancel.
    sine = 16.0 * ((s1 * s2) * (s3 * s4)) / (sine_high_4 * cosine_low_4 + cosine_high_4 * sine_low_4)
    cosine = cosine_high_4 * cosine_low_4 + sine_high_4 * sine_low_4
    between = 2.0 * atan2(sine, cosine)
    about_pi = 4.0 * atan2(cosine_low_4, sine_low_4)
    limited = select(cosine_high_4 > 0.0, between, about_pi)
    angle = select(sine_low_4 > 0.0, limited, 2.0 * theta4_high)
    return select(assembles == 1.0, angle, NOT_A_NUMBER)


@planar_4r.quantity(units="1", symbol="Q", source=f"{HAYES}, eq. (1); output at rest where OA and AB align")
def time_ratio(
    sure_A1: Any, sure_B1: Any, sure_C1: Any, factor_A2: Any, factor_B2: Any, factor_C2: Any, factor_D1: Any,
    factor_D2: Any, assembles: Any,
) -> Any:  # fmt: skip
    """Slow over quick stroke of a crank-rocker, at least 1; NaN of others."""
    # Half the angles at O in the triangles OBD with OB = a1 + a2 (stretched) and a2 - a1 (folded).
    sine_stretched, cosine_stretched = sqrt(-sure_B1 * factor_A2), sqrt(factor_C2 * factor_D1)
    sine_folded, cosine_folded = sqrt(-sure_C1 * factor_D2), sqrt(sure_A1 * factor_B2)
    sine = abs(sine_folded * cosine_stretched - cosine_folded * sine_stretched)
    cosine = cosine_folded * cosine_stretched + sine_folded * sine_stretched
    # The strokes take pi + 2 x and pi - 2 x of the crank's turn, tan x = sine/cosine; pi/2 - x has the inverse.
    ratio = 1.0 + 2.0 * atan2(sine, cosine) / atan2(cosine, sine)
    crank_rocker = (sure_A1 < 0.0) & (sure_B1 < 0.0) & (sure_C1 < 0.0)
    return select(crank_rocker & (assembles == 1.0), ratio, NOT_A_NUMBER)


# -- Circuits of the planar 4R: which configurations reach each other without taking the linkage apart

# In a linkage of Grashof's kind the shortest link turns fully against its two neighbours, and the other two
# joints never straighten: the sign of either distinguishes the two circuits. Where crank or ground is the
# shortest, B is such a joint, and its sign is that of the branch. Where coupler or output link is the
# shortest, O is, and its sign is that of sin theta1; the branches of each half meet at its toggles. Every
# other linkage that assembles has one circuit: at a change point the two touch.


CIRCUITS = f"{NUMERICS}#circuits"


@planar_4r.quantity(units="1", symbol="N_c", source=CIRCUITS)
def circuit_count(grashof_class: Any) -> Any:
    """Number of circuits, sets of configurations that reach each other; 0 if the design never assembles."""
    # The codes of classes.CLASS_FLAGS: Grashof's four, then the linkages with one circuit.
    count = select(grashof_class <= 3.0, 2.0, select(grashof_class <= 12.0, 1.0, 0.0))
    return select(grashof_class <= 13.0, count, NOT_A_NUMBER)


@planar_4r.quantity(units="1", symbol="c", source=CIRCUITS)
def circuit(grashof_class: Any, sin_theta1: Any, branch_sign: Any, sigma: Any) -> Any:
    """Circuit that the configuration belongs to: by branch, by the half of theta1 (1 above 0), or 1."""
    branch = 1.5 + 0.5 * branch_sign
    half = select(sin_theta1 > 0.0, 1.0, 2.0)
    number = select(grashof_class <= 1.0, branch, select(grashof_class <= 3.0, half, 1.0))
    return select(sigma >= 0.0, number, NOT_A_NUMBER)
