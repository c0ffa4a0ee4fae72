"""Facts of one design of the Minkowskian 4R: the sums T_i, the limits of both cranks, branching, status.

Every limit is a product of two T_i over two lengths, and each T_i is summed without loss: nothing cancels near a
hyperbolic cosine of 1, and the signs, which decide which limits exist, are exact in the lengths as given. The input
`tolerance` is the one that widens them: a T_i, or a difference of two lengths, of no more than `tolerance` times the
sum of all four lengths then counts as 0. Ratios are formed length by length, so that no product overflows.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastlink.mechanisms._shared.laws import same
from fastlink.mechanisms.minkowski_4r.inputs import HEGEDUS, minkowski_4r
from fastlink.numerics.compensated import sum_of_four, two_sum
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER, select, sqrt
from fastlink.numerics.logarithm import arsinh
from fastlink.numerics.vectors import sign, zero_where

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
