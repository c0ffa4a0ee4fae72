"""Facts of one design of the Minkowskian 4R: scaled lengths, limits, and the constants of the loop.

Lengths are divided by a power of two near the longest. The limits of theta are given as sinh^2(theta/2), in twice the
working precision, times kappa, the power of two of a g: so that quotients of unequal lengths do not overflow.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastlink.mechanisms._shared import laws
from fastlink.mechanisms._shared.laws import opposite, same
from fastlink.mechanisms.minkowski_4r.inputs import HEGEDUS, LINKS, NUMERICS, minkowski_4r
from fastlink.numerics.compensated import gap_product_quotient, power_of_two_below, sum_of_four, two_sum
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER, select, sqrt
from fastlink.numerics.logarithm import arsinh
from fastlink.numerics.vectors import sign, zero_where

POSITION = f"{NUMERICS}#position"
SCALING = f"{NUMERICS}#scaling"

step = minkowski_4r.steps(units="1", source=SCALING)
step(laws.valid, "valid", "valid", a1="a", a2="b", a3="g", a4="h")
step(laws.lift, "lift", "lift", a1="a", a2="b", a3="g", a4="h")
step(laws.unit, "unit", "unit", a1="a", a2="b", a3="g", a4="h", units="m")
step(laws.scaled, "s_a", "s_a", f"scaled hyperbolic length of the {LINKS['a']}", length="a")
step(laws.scaled, "s_b", "s_b", f"scaled hyperbolic length of the {LINKS['b']}", length="b")
step(laws.scaled, "s_g", "s_g", f"scaled hyperbolic length of the {LINKS['g']}", length="g")
step(laws.scaled, "s_h", "s_h", f"scaled hyperbolic length of the {LINKS['h']}", length="h")


def power_of_two(length: Any) -> Any:
    """The power of two at or below a scaled length."""
    return power_of_two_below(length)


def fraction(length: Any, power: Any) -> Any:
    """A scaled length over its power of two."""
    return length / power


step(power_of_two, "a_two", "a_two", length="s_a")
step(power_of_two, "g_two", "g_two", length="s_g")
step(fraction, "a_one", "a_one", length="s_a", power="a_two")
step(fraction, "g_one", "g_one", length="s_g", power="g_two")


@minkowski_4r.quantity(units="1", symbol="kappa", source=SCALING, internal=True)
def product_two(a_two: Any, g_two: Any) -> Any:
    """Power of two of the product of input crank and ground link."""
    return a_two * g_two


@minkowski_4r.quantity(units="1", symbol="c", source=SCALING, internal=True)
def product_one(a_one: Any, g_one: Any) -> Any:
    """Twice the product of input crank and ground link over its power of two."""
    return 2.0 * (a_one * g_one)


step(opposite, "minus_s_h", "-s_h", "Minus the scaled hyperbolic length of the coupler", x="s_h")


def limit(s_a: Any, s_b: Any, s_g: Any, reach: Any, a_one: Any, g_one: Any, valid: Any) -> Any:
    """Return (g - a - b - h) (g - a + b + h) kappa/(4 a g)."""
    f, f_low = sum_of_four(s_g, -s_a, -s_b, -reach)
    k, k_low = sum_of_four(s_g, -s_a, s_b, reach)
    high, low = gap_product_quotient(f, f_low, k, k_low, a_one, g_one)
    return high * valid, low


step = minkowski_4r.steps(units="1", source=POSITION)
_NONE = "negative if there is no such limit"
_INNER, _OUTER = f"kappa sinh^2(theta_min/2), {_NONE}", f"kappa sinh^2(theta_max/2), {_NONE}"
step(limit, "inner_limit", "S_0", _INNER, reach="s_h", low="inner_limit_low")
step(limit, "outer_limit", "S_0", _OUTER, reach="minus_s_h", low="outer_limit_low")


@minkowski_4r.quantity(units="1", symbol="g/a", source=POSITION, internal=True, low="ground_share_low")
def ground_share(s_g: Any, s_a: Any) -> Any:
    """Ground link over input crank."""
    return gap_product_quotient(s_g, 0.0, 4.0, 0.0, s_a, 1.0)


def arm_share(length: Any, g_one: Any) -> Any:
    """Return the length over 2 a g/kappa, times the fraction of a."""
    return length / (2.0 * g_one)


_UNITS = "in units of the roots of the quadratic"
step(arm_share, "b_share", "b_share", f"length of the {LINKS['b']} {_UNITS}", length="s_b")
step(arm_share, "h_share", "h_share", f"length of the {LINKS['h']} {_UNITS}", length="s_h")


def arm_product(length: Any, other: Any, product_one: Any) -> Any:
    """Return length (length + other) kappa/(2 a g)."""
    return length * (length + other) / product_one


_CB = "half the middle coefficient of the quadratic of CB"
_AB = "half the middle coefficient of the quadratic of AB"
step(arm_product, "CB_inner", "b (b + h)", f"{_CB} at the inner limit", length="s_b", other="s_h")
step(arm_product, "CB_outer", "b (b + h)", f"{_CB} at the outer limit", length="s_b", other="minus_s_h")
step(arm_product, "AB_inner", "b (b + h)", f"{_AB} at the inner limit", length="s_h", other="s_b")
step(arm_product, "AB_outer", "b (b + h)", f"{_AB} at the outer limit", length="minus_s_h", other="s_b")


# -- Facts of one design of the Minkowskian 4R: the sums T_i, the limits of both cranks, branching, status

# Every limit is a product of two T_i over two lengths, and each T_i is summed without loss: nothing cancels
# near a hyperbolic cosine of 1, and the signs, which decide which limits exist, are exact in the lengths as
# given. The input `tolerance` is the one that widens them: a T_i, or a difference of two lengths, of no
# more than `tolerance` times the sum of all four lengths then counts as 0. Ratios are formed length by
# length, so that no product overflows.


Law = Callable[..., Any]
LIMITS = f"{HEGEDUS}, section 3.6"
BRANCHING = f"{HEGEDUS}, Corollaries 3.2 to 3.4"
THEOREMS = "docs/minkowski_theorems.md"
TOLERANCE = "tolerance"
STATUS_FLAGS = {
    0: "assembles_at_every_theta",
    1: "assembles_over_part_of_theta",
    2: "branches_meet_at_theta_0",
    3: "undetermined_at_theta_0",
    4: "invalid_input",
    5: "beyond_range",
}
BRANCHING_FLAGS = {
    0: "none",
    1: "isolated_one_root_at_infinity",
    2: "isolated_undetermined_at_theta_0",
    3: "all_one_root_at_infinity",
    4: "all_and_undetermined_at_theta_0",
    5: "invalid_input",
}

minkowski_4r.input(
    TOLERANCE,
    units="1",
    symbol="epsilon",
    meaning="what counts as 0 of a T_i or a difference of lengths, over the sum of all lengths",
    rule="non-negative",
    variant=TOLERANCE,
    default=0.0,
)


@minkowski_4r.quantity(units="m", symbol="T_7", source=LIMITS, internal=True)
def length_sum(a: Any, b: Any, g: Any, h: Any) -> Any:
    """Sum of the four lengths, whatever they are."""
    return (a + b) + (g + h)


@minkowski_4r.quantity(units="1", symbol="valid", source=THEOREMS, internal=True)
def sums_are_valid(a: Any, b: Any, g: Any, h: Any, length_sum: Any) -> Any:
    """1 where the lengths are positive and their sum is finite, else 0."""
    positive = (a > 0.0) & (b > 0.0) & (g > 0.0) & (h > 0.0)
    return select(positive & (length_sum < INFINITY), 1.0, 0.0)


@minkowski_4r.quantity(units="m", symbol="T_7", source=LIMITS)
def T7(length_sum: Any, sums_are_valid: Any) -> Any:
    """Sum of the lengths, g + b + a + h."""
    return select(sums_are_valid == 1.0, length_sum, NOT_A_NUMBER)


# -- the sums T_i, and which of them count as 0 ----------------------------------------------------------------------


def two_against_two(p: Any, q: Any, r: Any, s: Any, sums_are_valid: Any) -> Any:
    """Return p + q - r - s, its sign exact."""
    total, _low = sum_of_four(p, q, -r, -s)
    return select(sums_are_valid == 1.0, total, NOT_A_NUMBER)


def three_against_one(p: Any, q: Any, r: Any, s: Any, sums_are_valid: Any) -> Any:
    """Return p + q + r - s, its sign exact."""
    total, _low = sum_of_four(p, q, r, -s)
    return select(sums_are_valid == 1.0, total, NOT_A_NUMBER)


def one_against_three(p: Any, q: Any, r: Any, s: Any, sums_are_valid: Any) -> Any:
    """Return p - q - r - s, its sign exact."""
    total, _low = sum_of_four(p, -q, -r, -s)
    return select(sums_are_valid == 1.0, total, NOT_A_NUMBER)


# Types need the signs of the sums only, which take a few operations: rounded, p + q and r + s are in the order of their
# exact values, and where both are one number, their rounding errors decide.


def sign_of_two(p: Any, q: Any, r: Any, s: Any) -> Any:
    """Return a number of the sign of p + q - r - s."""
    left, left_low = two_sum(p, q)
    right, right_low = two_sum(r, s)
    return select(left == right, left_low - right_low, left - right)


def sign_of_three(p: Any, q: Any, r: Any, s: Any) -> Any:
    """Return a number of the sign of p + q + r - s."""
    left, left_low = two_sum(p, q)
    right, right_low = two_sum(s, -r)
    return select(left == right, left_low - right_low, left - right)


def sign_of_one(p: Any, q: Any, r: Any, s: Any) -> Any:
    """Return a number of the sign of p - q - r - s."""
    left, left_low = two_sum(p, -q)
    right, right_low = two_sum(r, s)
    return select(left == right, left_low - right_low, left - right)


def difference(p: Any, q: Any) -> Any:
    """Return p - q, its sign exact."""
    return p - q


def zero_within(replaced: Any, tolerance: Any, length_sum: Any) -> Any:
    """Return a sum of lengths, 0 within the tolerance."""
    return zero_where(abs(replaced) <= tolerance * length_sum, replaced)


def declare_sure(name: str, symbol: str, source: str) -> None:
    """Declare a sum as it is, and where a tolerance is given, 0 within it."""
    sure, meaning = f"sure_{name}", f"{symbol}, 0 within the tolerance if one is given"
    minkowski_4r.steps(units="m", source=source)(same, sure, symbol, meaning, x=name)
    with_tolerance = minkowski_4r.steps(units="m", source=source, variant=TOLERANCE)
    with_tolerance(zero_within, sure, symbol, meaning, replaced=sure)


def declare_sum(name: str, meaning: str, law: Law, sign_law: Law, source: str = LIMITS, **given: str) -> None:
    """Declare a sum T_i, the same with 0 within the tolerance, and a number of its sign."""
    symbol = f"T_{name[1]}"
    declare = minkowski_4r.quantities if source == LIMITS else minkowski_4r.steps
    declare(units="m", source=source)(law, name, symbol, meaning, **given)
    declare_sure(name, symbol, LIMITS)
    labels = f"sign_{name}", symbol, f"number of the sign of {symbol}"
    minkowski_4r.steps(units="m", source=LIMITS)(sign_law, *labels, **given)
    with_tolerance = minkowski_4r.steps(units="m", source=LIMITS, variant=TOLERANCE)
    with_tolerance(same, *labels, x=f"sure_{name}")


def declare_difference(p: str, q: str) -> None:
    """Declare the difference of two lengths, and the same with 0 within the tolerance."""
    name, symbol = f"{p}_minus_{q}", f"{p} - {q}"
    minkowski_4r.steps(units="m", source=THEOREMS)(difference, name, symbol, symbol, p=p, q=q)
    declare_sure(name, symbol, THEOREMS)


declare_sum("T1", "g + b - h - a", two_against_two, sign_of_two, p="g", q="b", r="h", s="a")
declare_sum("T2", "a + b - g - h", two_against_two, sign_of_two, p="a", q="b", r="g", s="h")
declare_sum("T3", "g - a - b - h", one_against_three, sign_of_one, p="g", q="a", r="b", s="h")
declare_sum("T4", "g + b + h - a", three_against_one, sign_of_three, p="g", q="b", r="h", s="a")
declare_sum("T5", "a + g + b - h", three_against_one, sign_of_three, p="a", q="g", r="b", s="h")
# T6 and T8 are not in the paper: the fourth condition of "normal", and the third pairing of Grashof's criterion.
declare_sum("T6", "a + g + h - b", three_against_one, sign_of_three, THEOREMS, p="a", q="g", r="h", s="b")
declare_sum("T8", "b + h - a - g", two_against_two, sign_of_two, THEOREMS, p="b", q="h", r="a", s="g")
declare_difference("g", "a")
declare_difference("b", "h")
declare_difference("g", "b")


# -- limits ---------------------------------------------------------------------------------------------------


def cosh_above(first: Any, second: Any, x: Any, y: Any, sums_are_valid: Any) -> Any:
    """Return 1 + first second/(2 x y)."""
    return select(sums_are_valid == 1.0, 1.0 + 0.5 * (first / x) * (second / y), NOT_A_NUMBER)


def cosh_below(first: Any, second: Any, x: Any, y: Any, sums_are_valid: Any) -> Any:
    """Return 1 - first second/(2 x y)."""
    return select(sums_are_valid == 1.0, 1.0 - 0.5 * (first / x) * (second / y), NOT_A_NUMBER)


def angle_above(first: Any, second: Any, x: Any, y: Any) -> Any:
    """Return arch(1 + first second/(2 x y)), NaN unless that exceeds 1."""
    angle = 2.0 * arsinh(0.5 * sqrt(abs(first) / x) * sqrt(abs(second) / y))
    return select(sign(first) * sign(second) > 0.0, angle, NOT_A_NUMBER)


def angle_below(first: Any, second: Any, x: Any, y: Any) -> Any:
    """Return arch(1 - first second/(2 x y)), NaN unless that exceeds 1."""
    angle = 2.0 * arsinh(0.5 * sqrt(abs(first) / x) * sqrt(abs(second) / y))
    return select(sign(first) * sign(second) < 0.0, angle, NOT_A_NUMBER)


def declare_limit(
    name: str, meaning: str, theorem: str, laws: tuple[Law, Law], factors: tuple[str, str], lengths: str
) -> None:
    """Declare a limit of a crank, as an angle and as its hyperbolic cosine."""
    cosh_law, angle_law = laws
    given = {"first": factors[0], "second": factors[1], "x": lengths[0], "y": lengths[1]}
    symbol, source = name.replace("_", "_{") + "}", f"{HEGEDUS}, Theorem {theorem}"
    quantity = minkowski_4r.quantities(units="1", source=source)
    cosine = f"Hyperbolic cosine of {name} as the theorem has it: no angle below 1"
    quantity(cosh_law, f"cosh_{name}", f"ch({symbol})", cosine, **given)
    minkowski_4r.quantity(
        units="1",
        symbol=symbol,
        source=source,
        name=name,
        meaning=f"{meaning} range; NaN where there is no such limit",
        given=given,
        hides_reduction=True,  # psi_max is the limit, not the greatest psi of a cycle
    )(angle_law)


ABOVE, BELOW = (cosh_above, angle_above), (cosh_below, angle_below)
declare_limit("theta_min", "Greatest |theta| of the inner", "3.8", ABOVE, ("sure_T3", "sure_T4"), "ag")
declare_limit("theta_max", "Least |theta| of the outer", "3.8", BELOW, ("sure_T1", "sure_T2"), "ag")
declare_limit("psi_min", "Greatest |psi| of the inner", "3.10", BELOW, ("sure_T4", "sure_T5"), "bg")
declare_limit("psi_max", "Least |psi| of the outer", "3.10", BELOW, ("sure_T1", "T7"), "bg")


@minkowski_4r.quantity(units="1", symbol="ln(g/a)", source=f"{HEGEDUS}, eq. (3); {THEOREMS}#escape")
def theta_escape(a: Any, g: Any, g_minus_a: Any, sums_are_valid: Any) -> Any:
    """|ln(g/a)|: at this theta and minus it a root runs to infinity, A and C being lightlike separated."""
    # The hyperbolic sine of half of it is (sqrt(g/a) - sqrt(a/g))/2.
    angle = 2.0 * arsinh(0.5 * sqrt(abs(g_minus_a) / a) * sqrt(abs(g_minus_a) / g))
    return select(sums_are_valid == 1.0, angle, NOT_A_NUMBER)


# -- branching ------------------------------------------------------------------------------------------------


@minkowski_4r.quantity(units="1", symbol="undetermined", source=f"{THEOREMS}#branching", internal=True)
def pins_may_coincide(sure_T1: Any, sure_T2: Any) -> Any:
    """1 where g = a and b = h: at theta = 0 the pins A and C coincide and psi is undetermined; else 0."""
    return select((sure_T1 == 0.0) & (sure_T2 == 0.0), 1.0, 0.0)


@minkowski_4r.quantity(units="1", symbol="folded", source=f"{THEOREMS}#branching", internal=True)
def folds_at_every_theta(sure_T2: Any, sure_T8: Any) -> Any:
    """1 where g = b and h = a: B may lie at O whatever theta is; else 0."""
    return select((sure_T2 == 0.0) & (sure_T8 == 0.0), 1.0, 0.0)


@minkowski_4r.quantity(units="1", symbol="ch(theta)", source=BRANCHING)
def cosh_theta_branching(sure_T2: Any, sure_T3: Any, a: Any, sure_g_minus_b: Any, sums_are_valid: Any) -> Any:
    """Hyperbolic cosine of theta where A + C = 0 in eq. (3): no angle below 1; NaN where g = b."""
    # eq. (8) is 1 - T2 T3/(2 a (g - b))
    apart = (sums_are_valid == 1.0) & (sure_g_minus_b != 0.0)
    cosine = 1.0 - 0.5 * (sure_T2 / a) * (sure_T3 / select(apart, sure_g_minus_b, 1.0))
    return select(apart, cosine, NOT_A_NUMBER)


@minkowski_4r.quantity(units="1", symbol="theta", source=BRANCHING)
def theta_branching(sure_T2: Any, sure_T3: Any, a: Any, sure_g_minus_b: Any) -> Any:
    """The paper's branching point: |theta| where A + C = 0 in eq. (3); NaN where there is none, or all are."""
    apart = sure_g_minus_b != 0.0
    there = sign(sure_T2) * sign(sure_T3) * sign(sure_g_minus_b) <= 0.0
    root = sqrt(abs(sure_T2) / a) * sqrt(abs(sure_T3) / select(apart, abs(sure_g_minus_b), 1.0))
    return select(apart & there, 2.0 * arsinh(0.5 * root), NOT_A_NUMBER)


@minkowski_4r.quantity(
    units="1", symbol="kind", source=f"{BRANCHING}; {THEOREMS}#branching", flags=BRANCHING_FLAGS
)
def branching_kind(
    theta_branching: Any, folds_at_every_theta: Any, pins_may_coincide: Any, sums_are_valid: Any
) -> Any:
    """Kind of branching where A + C = 0 in eq. (3): one root at infinity (q = -1), or psi undetermined."""
    isolated = select(theta_branching >= 0.0, 1.0, 0.0)
    code = select(folds_at_every_theta == 1.0, 3.0, isolated)
    code = select(pins_may_coincide == 1.0, select(folds_at_every_theta == 1.0, 4.0, 2.0), code)
    return select(sums_are_valid == 1.0, code, 5.0)


@minkowski_4r.quantity(units="1", symbol="status", source=f"{LIMITS}; {THEOREMS}#status", flags=STATUS_FLAGS)
def status(sure_T1: Any, sure_T2: Any, pins_may_coincide: Any, sums_are_valid: Any) -> Any:
    """Where the loop closes, with CB of either orientation: no design never does, theta being unbounded."""
    product = sign(sure_T1) * sign(sure_T2)
    code = select(product < 0.0, 1.0, select(product > 0.0, 0.0, 2.0))
    code = select(pins_may_coincide == 1.0, 3.0, code)
    return select(sums_are_valid == 1.0, code, 4.0)


# -- Types of one design of the Minkowskian 4R, and its assemblies under the paper's standing assumption

# The types are those of Theorems 3.9 to 3.22, by exact signs of the T_i: they decide where the loop closes
# at all. The paper supposes that OA and CB are future-pointing; where that is so is another matter, the
# subject of the facts with `future` in their names. docs/minkowski_theorems.md lists the theorems whose
# words need one or the other.


FUTURE = f"{THEOREMS}#future-pointing-assemblies"
CRANK_FLAGS = {0: "crank", 1: "rocker", 2: "superrocker", 3: "invalid_input"}
# 4 kind + 2 (the input is not a crank) + (the output is not a crank)
LINKAGE_FLAGS = {
    0: "strange_crank_crank",
    1: "strange_crank_superrocker",
    2: "strange_superrocker_crank",
    3: "strange_superrocker_superrocker",
    4: "rigid_crank_crank",
    5: "rigid_crank_rocker",
    6: "rigid_rocker_crank",
    7: "rigid_rocker_rocker",
    8: "reducible_crank_crank",
    9: "reducible_crank_rocker",
    12: "irreducible_crank_crank",
    13: "irreducible_crank_rocker",
    14: "irreducible_rocker_crank",
    15: "irreducible_rocker_rocker",
    16: "invalid_input",
}
GRASHOF_FLAGS = {0: "l_plus_s_below_p_plus_q", 1: "l_plus_s_at_least_p_plus_q", 2: "invalid_input"}


@minkowski_4r.quantity(units="1", symbol="input", source=f"{HEGEDUS}, Theorem 3.9", flags=CRANK_FLAGS)
def input_type(sign_T1: Any, sign_T2: Any, sign_T3: Any, sign_T4: Any, sums_are_valid: Any) -> Any:
    """How the input crank moves where CB may point either way."""
    outer = select(sign(sign_T1) * sign(sign_T2) < 0.0, 1.0, 0.0)
    code = select(sign(sign_T3) * sign(sign_T4) > 0.0, 2.0, outer)
    return select(sums_are_valid == 1.0, code, 3.0)


@minkowski_4r.quantity(units="1", symbol="output", source=f"{HEGEDUS}, Theorem 3.11", flags=CRANK_FLAGS)
def output_type(sign_T1: Any, sign_T4: Any, sign_T5: Any, sums_are_valid: Any) -> Any:
    """How the output crank moves where OA may point either way."""
    outer = select(sign_T1 < 0.0, 1.0, 0.0)
    code = select(sign(sign_T4) * sign(sign_T5) < 0.0, 2.0, outer)
    return select(sums_are_valid == 1.0, code, 3.0)


@minkowski_4r.quantity(
    units="1", symbol="type", source=f"{HEGEDUS}, Theorems 3.12 to 3.22, Tables 1 to 3", flags=LINKAGE_FLAGS
)
def linkage_type(
    sign_T1: Any, sign_T2: Any, sign_T3: Any, sign_T4: Any, sign_T5: Any, sign_T6: Any, input_type: Any,
    output_type: Any, sums_are_valid: Any,
) -> Any:  # fmt: skip
    """Strange, rigid, reducible or irreducible, and the motions of input and output."""
    strange = (sign_T3 > 0.0) | (sign_T4 < 0.0) | (sign_T5 < 0.0) | (sign_T6 < 0.0)
    rigid = (sign_T3 == 0.0) | (sign_T4 == 0.0) | (sign_T5 == 0.0) | (sign_T6 == 0.0)
    reducible = (sign_T1 == 0.0) | (sign_T2 == 0.0)
    kind = select(strange, 0.0, select(rigid, 4.0, select(reducible, 8.0, 12.0)))
    code = kind + (select(input_type > 0.0, 2.0, 0.0) + select(output_type > 0.0, 1.0, 0.0))
    return select(sums_are_valid == 1.0, code, 16.0)


@minkowski_4r.quantity(units="1", symbol="Grashof", source=f"{HEGEDUS}, section 3.6", flags=GRASHOF_FLAGS)
def grashof(sign_T1: Any, sign_T2: Any, sign_T8: Any, sums_are_valid: Any) -> Any:
    """Grashof's criterion with the reversed triangle inequality: longest plus shortest against the other two."""
    # Each has b with one other link against the rest. If b is l or s, the two that do not pair l with s have one sign
    # and the third is l + s - p - q; if b is p or q, they have two signs and the third is p + q - l - s.
    criterion = sign(sign_T1) * sign(sign_T2) * sign(sign_T8) >= 0.0
    return select(sums_are_valid == 1.0, select(criterion, 1.0, 0.0), 2.0)


# -- future-pointing assemblies -------------------------------------------------------------------------------


@minkowski_4r.quantity(units="1", symbol="outer", source=FUTURE, internal=True)
def outer_range_points_ahead(sure_g_minus_a: Any, sure_b_minus_h: Any) -> Any:
    """1 where (g - a)(h - b) > 0: CB points to the future in both branches from theta_max to theta_escape."""
    return select(sign(sure_g_minus_a) * sign(sure_b_minus_h) < 0.0, 1.0, 0.0)


@minkowski_4r.quantity(units="1", symbol="through 0", source=FUTURE, internal=True)
def crosses_theta_0(outer_range_points_ahead: Any, pins_may_coincide: Any, sign_T1: Any, sign_T2: Any) -> Any:
    """1 where every theta has a future-pointing assembly, else 0."""
    ahead = (outer_range_points_ahead == 1.0) & (sign(sign_T1) * sign(sign_T2) >= 0.0)
    return select(ahead | (pins_may_coincide == 1.0), 1.0, 0.0)


@minkowski_4r.quantity(units="1", symbol="N", source=FUTURE)
def assembly_count_future(crosses_theta_0: Any, sign_T4: Any, sums_are_valid: Any) -> Any:
    """Number of intervals of theta with a future-pointing assembly, isolated angles not counted."""
    apart = select(sign_T4 < 0.0, 3.0, 2.0)
    count = select(crosses_theta_0 == 1.0, 1.0, apart)
    return select(sums_are_valid == 1.0, count, NOT_A_NUMBER)


@minkowski_4r.quantity(units="1", symbol="theta_{min}", source=FUTURE)
def theta_min_future(theta_min: Any, sign_T4: Any) -> Any:
    """Greatest |theta| of the inner range with a future-pointing assembly; NaN where there is no such range."""
    return select(sign_T4 < 0.0, theta_min, NOT_A_NUMBER)


@minkowski_4r.quantity(units="1", symbol="theta_{max}", source=FUTURE)
def theta_max_future(
    theta_max: Any, theta_escape: Any, outer_range_points_ahead: Any, crosses_theta_0: Any
) -> Any:
    """Least |theta| of the outer ranges with a future-pointing assembly; NaN where 0 is between them."""
    limit = select(outer_range_points_ahead == 1.0, theta_max, theta_escape)
    return select(crosses_theta_0 == 1.0, NOT_A_NUMBER, limit)


@minkowski_4r.quantity(units="1", symbol="psi_{min}", source=FUTURE)
def psi_min_future(psi_min: Any, sign_T4: Any) -> Any:
    """Greatest |psi| of the inner range with OA pointing to the future; NaN where there is no such range."""
    return select(sign_T4 < 0.0, psi_min, NOT_A_NUMBER)
