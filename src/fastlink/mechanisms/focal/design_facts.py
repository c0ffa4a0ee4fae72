"""Facts of one design of the focal mechanism: all its lengths, over a power of two near the four-bar's longest."""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import borrow, opposite_product, product, same
from fastlink.mechanisms.focal.inputs import DESIGN, GIVEN_LAMBDA, GIVEN_S, LINKS, WUNDERLICH, focal
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.numerics.compensated import (
    pair_product,
    pair_quotient,
    power_of_two_below,
    square_sum,
    sum_of_four,
    two_sum,
)
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER, atan2, select, sqrt
from fastlink.numerics.vectors import sign

# -- The two completions of a four-bar to a focal mechanism, by the ratio that is given

# With rho = mp : nq and x = lambda - 1 = pq : mn, the paper's condition on lambda (2.5) is one symmetric
# equation,
#
#     (1 + rho) (a^2 + rho b^2)/rho  =  (1 + x) (c^2 + x d^2)/x,    rho and x of one sign.
#
# So the laws below find x of a given rho by the pair c, d, and rho of a given x (`lambda_`) by the pair a,
# b. Their unknown is t u/v, where t and 1/t have the product 1: it is the square root of sums that do not
# cancel, and 1 + the unknown follows from the product of both roots, (1 + t u/v)(1 + u/(v t)) = W/v^2.


COMPLETION = f"{WUNDERLICH}, eq. (2.5); {DESIGN}#completion"


# -- the ratio that is given ----------------------------------------------------------------------------------


@focal.quantity(units="1", symbol="1 + rho", source=COMPLETION, internal=True, low="rho_plus_1_low")
def rho_plus_1(rho: Any) -> Any:
    """1 + rho."""
    return two_sum(1.0, rho)


@focal.quantity(
    units="1", symbol="rho", source=f"{WUNDERLICH}, eq. (1.9)", internal=True, variant=GIVEN_S, low="rho_low"
)
def rho(s: Any, scale: Any, s_d: Any) -> Any:
    """Ratio mp : nq of a given crank support."""
    support = s / scale
    rest, rest_low = two_sum(s_d, -support)
    return pair_quotient(support, 0.0, rest, rest_low)


def one_plus_ratio_of_support(s: Any, scale: Any, s_d: Any) -> Any:
    """1 + rho of a given crank support."""
    rest, rest_low = two_sum(s_d, -(s / scale))
    return pair_quotient(s_d, 0.0, rest, rest_low)


by_support = focal.steps(units="1", source=COMPLETION, variant=GIVEN_S)
by_support(one_plus_ratio_of_support, "rho_plus_1", "1 + rho", low="rho_plus_1_low")


def nothing(exact: Any) -> Any:
    """No low part."""
    return 0.0 * exact


@focal.quantity(
    units="1", symbol="lambda - 1", source=COMPLETION, internal=True, variant=GIVEN_LAMBDA, low="x_low"
)
def x(lambda_: Any) -> Any:
    """Ratio pq : mn of a given lambda."""
    return two_sum(lambda_, -1.0)


step = focal.steps(units="1", source=COMPLETION)
step(nothing, "rho_low", "0", exact="rho")
step = focal.steps(units="1", source=COMPLETION, variant=GIVEN_LAMBDA)
step(nothing, "lambda_low", "0", exact=GIVEN_LAMBDA)


# -- the other ratio ------------------------------------------------------------------------------------------


def mixed(ratio: Any, ratio_low: Any, first: Any, second: Any) -> Any:
    """first^2 + ratio second^2."""
    return square_sum(first, ratio, ratio_low, second)


def common(ratio: Any, plus_1: Any, mixed: Any) -> Any:
    """W, the value of both sides of the equation, over the squared unit."""
    return plus_1 * mixed / ratio


def excess(
    ratio: Any, ratio_low: Any, plus_1: Any, plus_1_low: Any, mixed: Any, mixed_low: Any, u: Any, v: Any
) -> Any:
    """|W - (u + v)^2|, or with a negative ratio |W - (u - v)^2|, negative where no root is real."""
    # (1 + ratio)(first^2 + ratio second^2) - ratio (u +- v)^2 in twice the working precision, over a power of two
    two = power_of_two_below(abs(ratio))
    side, side_low = pair_product(plus_1 / two, plus_1_low / two, mixed, mixed_low)
    reach, reach_low = two_sum(u, select(ratio < 0.0, -v, v))
    reach, reach_low = pair_product(reach, reach_low, reach, reach_low)
    other, other_low = pair_product(ratio / two, ratio_low / two, reach, reach_low)
    high, _low = sum_of_four(side, side_low, -other, -other_low)
    return high / abs(ratio / two)


def far_excess(excess: Any, u: Any, v: Any) -> Any:
    """The excess with the other sign of v; negative where the roots are real, but not of the sign of the ratio."""
    return excess + 4.0 * (u * v)


def root(value: Any, assembles: Any) -> Any:
    """Square root of an excess, of a four-bar that assembles."""
    return select(assembles == 1.0, sqrt(value), NOT_A_NUMBER)


def root_of_ratio(root_near: Any, root_far: Any, u: Any, v: Any, completion: Any) -> Any:
    """Square root of the size of the unknown ratio."""
    size = 0.5 * (root_near + root_far)
    other = select(completion == 2.0, u / size, NOT_A_NUMBER)
    return select(completion == 1.0, size / v, other)


def one_plus_found(
    ratio_sign: Any, root: Any, common: Any, excess: Any, root_near: Any, root_far: Any, u: Any, v: Any,
    completion: Any,
) -> Any:  # fmt: skip
    """1 + the unknown ratio."""
    # Of the negative ratios, 1 + ratio is (middle -+ R)/(2 v^2), of the product W/v^2: the greater first.
    R = root_near * root_far
    middle = select(u < v, (v - u) * (v + u) + common, -(excess + 2.0 * v * (u - v)))
    greater = middle + select(middle < 0.0, -R, R)
    far = greater / (2.0 * (v * v))
    near = select(greater == 0.0, 0.0, 2.0 * common / greater)
    is_far = select(middle < 0.0, completion == 1.0, completion == 2.0)
    ratio = ratio_sign * (root * root)
    return select(ratio < -0.5, select(is_far, far, near), 1.0 + ratio)


def with_sign(ratio_sign: Any, root: Any) -> Any:
    """A ratio of its sign and the square root of its size."""
    return ratio_sign * (root * root)


def root_of_size(ratio: Any) -> Any:
    """Square root of the size of the ratio that is given."""
    return sqrt(abs(ratio))


def declare_completion(
    variant: str | None, pair: dict[str, str], known: str, found: tuple[str, str, str]
) -> None:
    """Declare the unknown ratio, from the given one and the two pairs of lengths."""
    root_found, ratio_found, plus_1_found = found
    given = {**pair, "root": root_found}
    step = focal.steps(units="1", source=COMPLETION, variant=variant)
    step(sign, "ratio_sign", "sgn rho", x=pair["ratio"])
    step(mixed, "mixed", "a^2 + rho b^2", low="mixed_low", **given)
    step(common, "common", "W", **given)
    step(excess, "excess", "|W - (c + d)^2|", **given)
    step(far_excess, "far_excess", "|W - (c - d)^2|", **given)
    step(root, "root_near", "sqrt|W - (c + d)^2|", value="excess")
    step(root, "root_far", "sqrt|W - (c - d)^2|", value="far_excess")
    step(root_of_size, known, "sqrt|rho|", **given)
    step(root_of_ratio, root_found, "sqrt|lambda - 1|", **given)
    step(with_sign, ratio_found, "lambda - 1", **given)
    if plus_1_found != GIVEN_LAMBDA:
        step(one_plus_found, plus_1_found, "lambda", **given)
        return
    quantity = focal.quantities(units="1", source=COMPLETION, variant=variant)
    quantity(one_plus_found, GIVEN_LAMBDA, "lambda", "Factor a/m = b/n", **given)


BY_RHO = {"ratio": "rho", "ratio_low": "rho_low", "plus_1": "rho_plus_1", "plus_1_low": "rho_plus_1_low"}
BY_RHO |= {"first": "s_a", "second": "s_b", "u": "s_c", "v": "s_d"}
BY_X = {"ratio": "x", "ratio_low": "x_low", "plus_1": GIVEN_LAMBDA, "plus_1_low": "lambda_low"}
BY_X |= {"first": "s_c", "second": "s_d", "u": "s_a", "v": "s_b"}
declare_completion(None, BY_RHO, "root_rho", ("root_x", "x", GIVEN_LAMBDA))
declare_completion(GIVEN_LAMBDA, BY_X, "root_x", ("root_rho", "rho", "rho_plus_1"))


SCALING = f"{DESIGN}#numerics"

#: The four-bar MABN as a planar 4R: its lengths, and the other names that differ here.
LENGTHS = {"a1": "a", "a2": "c", "a3": "b", "a4": "d"}
SCALED = {f"s{length[1]}": f"s_{name}" for length, name in LENGTHS.items()}
FOUR_BAR = {**LENGTHS, **SCALED, "theta1": "phi", "theta4": "psi", "omega1": "omega"}
FOUR_BAR |= {name: name for name in ("valid", "lift", "unit", "assembles", "grashof_class", "grashof_excess")}
FOUR_BAR |= {
    "theta1_low": "phi_low",
    "theta1_high": "phi_high",
    "theta4_low": "psi_low",
    "theta4_high": "psi_high",
}
#: Before the names of all other facts that are the four-bar's.
PREFIX = "bar_"

LABELS: dict[str, dict[str, Any]] = {"valid": {}, "assembles": {}}
for _name, _here in SCALED.items():
    _meaning = f"scaled length of the {LINKS[_here[-1]]}"
    LABELS[_name] = {"symbol": _here, "meaning": _meaning, "source": SCALING}
borrow(focal, planar_4r, FOUR_BAR, PREFIX, LABELS)


def carried(length: Any, lambda_: Any, x: Any, rho: Any) -> Any:
    """Distance of P or Q from the pivot of its rocker, scaled."""
    return select((x / rho > 0.0) & (lambda_ != 0.0), length / lambda_, NOT_A_NUMBER)


step = focal.steps(units="1", source=f"{WUNDERLICH}, eq. (2.5)")
step(carried, "s_m", "m", "scaled length MP along MA", length="s_a")
step(carried, "s_n", "n", "scaled length NQ along NB", length="s_b")


@focal.quantity(units="1", symbol="p", source=f"{WUNDERLICH}, eqs. (1.9), (2.6)", internal=True)
def s_p(ratio_sign: Any, root_rho: Any, root_x: Any, s_n: Any) -> Any:
    """Scaled length PF, of the sign of rho."""
    return ratio_sign * (root_rho * root_x * abs(s_n))


@focal.quantity(units="1", symbol="q", source=f"{WUNDERLICH}, eqs. (1.9), (2.6)", internal=True)
def s_q(root_rho: Any, root_x: Any, s_m: Any) -> Any:
    """Scaled length QF."""
    return root_x / root_rho * abs(s_m)


@focal.quantity(units="1", symbol="r", source=f"{WUNDERLICH}, eq. (1.8)", internal=True)
def s_r(root_rho: Any, root_x: Any, rho_plus_1: Any, s_c: Any, lambda_: Any) -> Any:
    """Scaled length SF."""
    none = (rho_plus_1 == 0.0) | (lambda_ == 0.0)
    return select(none, NOT_A_NUMBER, root_rho * s_c / (abs(rho_plus_1) * root_x))


@focal.quantity(units="1", symbol="FT", source=f"{WUNDERLICH}, eq. (3.2)", internal=True)
def s_FT(root_rho: Any, root_x: Any, rho_plus_1: Any, s_d: Any, lambda_: Any) -> Any:
    """Scaled length FT."""
    none = (rho_plus_1 == 0.0) | (lambda_ == 0.0)
    return select(none, NOT_A_NUMBER, root_rho * s_d * root_x / abs(rho_plus_1))


@focal.quantity(units="1", symbol="AT/AB", source=f"{WUNDERLICH}, eq. (3.2)", internal=True)
def T_share(rho: Any, rho_plus_1: Any, valid: Any) -> Any:
    """Share rho/(1 + rho) of MS in MN, and of AT in AB."""
    share = select(abs(rho) < 2.0, rho / rho_plus_1, 1.0 - 1.0 / rho_plus_1)
    return select((rho_plus_1 == 0.0) | (valid != 1.0), NOT_A_NUMBER, share)


@focal.quantity(units="1", symbol="s", source=f"{WUNDERLICH}, eq. (1.9)", internal=True)
def s_s(s_d: Any, T_share: Any) -> Any:
    """Scaled position of the crank support S on MN."""
    return s_d * T_share


def share_of_support(s: Any, d: Any, valid: Any) -> Any:
    """Share s/d of MS in MN, and of AT in AB."""
    return select(valid == 1.0, s / d, NOT_A_NUMBER)


by_support = focal.steps(units="1", source=f"{WUNDERLICH}, eq. (3.2)", variant=GIVEN_S)
by_support(share_of_support, "T_share", "AT/AB")


# -- quantities ----------------------------------------------------------------------------------------------


@focal.quantity(units="m", symbol="unit/lift", source=SCALING, internal=True)
def scale(unit: Any, lift: Any) -> Any:
    """The length that scaled lengths are multiples of: a power of two."""
    return unit / lift


def length_of(scaled: Any, scale: Any) -> Any:
    """A length from its scaled length."""
    return scaled * scale


length = focal.quantities(units="m", source=f"{WUNDERLICH}, eq. (2.5)")
length(length_of, "m", "m", "Distance MP along MA, negative beyond M", scaled="s_m")
length(length_of, "n", "n", "Distance NQ along NB, negative beyond N", scaled="s_n")
length = focal.quantities(units="m", source=f"{WUNDERLICH}, eqs. (1.9), (2.6)")
length(length_of, "p", "p", "Length PF, of the sign of rho (see docs/focal.md)", scaled="s_p")
length(length_of, "q", "q", "Length QF", scaled="s_q")
length = focal.quantities(units="m", source=f"{WUNDERLICH}, eq. (1.8)")
length(length_of, "r", "r", "Length SF, radius of the circle of F: the crank", scaled="s_r")
length = focal.quantities(units="m", source=f"{WUNDERLICH}, section 3")
length(length_of, "FT", "FT", "Length FT", scaled="s_FT")
length = focal.quantities(units="m", source=f"{WUNDERLICH}, eqs. (1.8) corrected, (1.9)")
length(length_of, "s", "s", "Crank support S on MN, from M towards N", scaled="s_s")
length(same, "S_x", "S_x", "Crank support S, x", x="s")
by_support = focal.quantities(units="m", source=f"{WUNDERLICH}, eq. (1.9)", variant=GIVEN_S)
by_support(product, "S_x", "S_x", "Crank support S, x", x="s_s", y="scale")


@focal.quantity(units="1", symbol="AT/AB", source=f"{WUNDERLICH}, eq. (3.2)")
def T_ratio(T_share: Any) -> Any:
    """Share of AT in AB, the same as that of MS in MN."""
    return T_share


def height(s_a: Any, s_b: Any, c: Any, s_d: Any, valid: Any, scale: Any) -> Any:
    """Height of a trapezoid with the sides a = b, the base d and the other base c."""
    near, _low = sum_of_four(s_a, s_a, -s_d, c)
    far, _low = sum_of_four(s_a, s_a, s_d, -c)
    symmetric = (s_a == s_b) & (valid == 1.0)
    return select(symmetric, 0.5 * sqrt(near) * sqrt(far) * scale, NOT_A_NUMBER)


@focal.quantity(units="1", symbol="-c", source=f"{WUNDERLICH}, eq. (6.2)", internal=True)
def minus_s_c(s_c: Any) -> Any:
    """Minus the scaled length of the coupler."""
    return -s_c


_H1 = "Distance of parallel MN and AB where a = b, NaN of others"
_H2 = "Distance of parallel MN and the opposite AB where a = b, NaN of others"
trapezoid = focal.quantities(units="m", source=f"{WUNDERLICH}, eq. (6.2)")
trapezoid(height, "h1", "h_1", _H1, c="s_c")
trapezoid(height, "h2", "h_2", _H2, c="minus_s_c")


@focal.quantity(units="m", symbol="x", source=f"{WUNDERLICH}, eq. (7.5) corrected")
def line_x(s_a: Any, s_b: Any, s_d: Any, lambda_: Any, rho_plus_1: Any, scale: Any) -> Any:
    """Place of the straight line that F moves on, x; NaN unless rho is -1."""
    offset = (s_a - s_b) * (s_a + s_b) / (lambda_ * s_d)
    on_a_line = (rho_plus_1 == 0.0) & (lambda_ != 0.0)
    return select(on_a_line, 0.5 * (s_d + offset) * scale, NOT_A_NUMBER)


# -- Reach of the bars: where the crank SF stops, and the least transmission angles at P, Q and F

# omega, the angle of P and Q, is extreme where the crank lies in the ground line (`dyad`); phi - psi, that
# of F, where AB is parallel to MN: there a, b and d - c, or d + c, make a triangle.


CRANK = f"{WUNDERLICH}, section 6; {DESIGN}#the-crank"
CRANK_FLAGS = {
    0: "turns_fully",
    1: "stops_where_MPF_is_stretched",
    2: "stops_where_MPF_is_folded",
    3: "stops_where_MPF_is_stretched_and_where_it_is_folded",
    4: "passes_a_change_point",
    5: "no_crank",
}


@focal.quantity(units="1", symbol="crank", source=CRANK, internal=True)
def has_crank(status: Any) -> Any:
    """1 where there is a crank SF, else 0."""
    return select(status == 0.0, 1.0, 0.0)


@focal.quantity(units="1", symbol="change point", source=CRANK, internal=True)
def folds(grashof_class: Any) -> Any:
    """1 where all bars of the four-bar may lie in line, else 0."""
    # the change points of planar_4r.classes.CLASS_FLAGS
    return select((grashof_class >= 8.0) & (grashof_class <= 12.0), 1.0, 0.0)


@focal.quantity(units="1", symbol="crank", source=CRANK, flags=CRANK_FLAGS)
def crank_type(
    sine_at_0: Any, sine_at_pi: Any, cosine_at_0: Any, cosine_at_pi: Any, P_sign: Any, folds: Any,
    has_crank: Any,
) -> Any:  # fmt: skip
    """Whether the crank SF turns fully, and the position that stops it."""
    no_sine = (sine_at_0 < 0.0) | (sine_at_pi < 0.0)
    no_cosine = (cosine_at_0 < 0.0) | (cosine_at_pi < 0.0)
    # of m and p with one sign MPF is stretched at omega = pi, else at omega = 0
    at_pi = select(no_cosine, select(P_sign > 0.0, 1.0, 2.0), 0.0)
    at_0 = select(no_sine, select(P_sign > 0.0, 2.0, 1.0), 0.0)
    code = select(folds == 1.0, 4.0, at_pi + at_0)
    return select(has_crank == 1.0, code, 5.0)


def least_acute_angle(
    sine: Any, cosine: Any, other_sine: Any, other_cosine: Any, folds: Any, known: Any
) -> Any:
    """Least angle in [0, pi/2] between two lines, from numbers in proportion to both extremes of their half-angle."""
    steep, other_steep = sine > cosine, other_sine > other_cosine
    one = atan2(sqrt(select(steep, cosine, sine)), sqrt(select(steep, sine, cosine)))
    other = atan2(
        sqrt(select(other_steep, other_cosine, other_sine)),
        sqrt(select(other_steep, other_sine, other_cosine)),
    )
    aligns = (sine <= 0.0) | (cosine <= 0.0) | (other_sine <= 0.0) | (other_cosine <= 0.0)
    angle = select(aligns | (folds == 1.0), 0.0, 2.0 * select(one < other, one, other))
    return select(known == 1.0, angle, NOT_A_NUMBER)


#: Of the triangle with the sides a, b and d -+ c: squared half-angle sine and cosine between a and b, times 4 a b.
A1, A2, B1, B2, C1, C2, D1, D2 = (
    f"{PREFIX}factor_{name}" for name in ("A1", "A2", "B1", "B2", "C1", "C2", "D1", "D2")
)
_PARALLEL = "squared half-angle of MA and NB where AB is parallel to MN, over a common factor"
_ANTIPARALLEL = "squared half-angle of MA and NB where AB is antiparallel to MN, over a common factor"
step = focal.steps(units="1", source=CRANK)
step(opposite_product, "sine_parallel", "B1 C1", _PARALLEL, x=B1, y=C1)
step(product, "cosine_parallel", "A2 D2", _PARALLEL, x=A2, y=D2)
step(opposite_product, "sine_antiparallel", "B2 C2", _ANTIPARALLEL, x=B2, y=C2)
step(product, "cosine_antiparallel", "A1 D1", _ANTIPARALLEL, x=A1, y=D1)

_PQ = "Least acute angle between MP and PF, that of NQ and QF, over the whole motion"
_F = "Least acute angle between PF and QF, that of MA and NB, over the whole motion"
_ENDS = {
    "sine": "sine_at_0",
    "cosine": "cosine_at_0",
    "other_sine": "sine_at_pi",
    "other_cosine": "cosine_at_pi",
}
_SIDES = {"sine": "sine_parallel", "cosine": "cosine_parallel"}
_SIDES |= {"other_sine": "sine_antiparallel", "other_cosine": "cosine_antiparallel"}
least = focal.quantities(units="rad", source=CRANK)
least(least_acute_angle, "transmission_angle_PQ_least", "mu_PQ", _PQ, known="has_crank", **_ENDS)
least(least_acute_angle, "transmission_angle_F_least", "mu_F", _F, known="assembles", **_SIDES)


# -- Status of a design of the focal mechanism: whether there is a completion, and why not


STATUS_FLAGS = {
    0: "completed",
    1: "no_real_lambda_or_rho",
    2: "p_q_and_r_imaginary",
    3: "F_on_a_straight_line",
    4: "lambda_is_0",
    5: "S_in_M_or_N",
    6: "four_bar_never_assembles",
    7: "invalid_input",
    8: "beyond_range",
}


@focal.quantity(
    units="1", symbol="status", source=f"{WUNDERLICH}, sections 2 and 6; {DESIGN}#status", flags=STATUS_FLAGS
)
def status(
    rho: Any, x: Any, excess: Any, far_excess: Any, lambda_: Any, rho_plus_1: Any, completion: Any,
    assembles: Any, valid: Any,
) -> Any:  # fmt: skip
    """Whether the four-bar has this completion, and why not."""
    code = select(rho_plus_1 == 0.0, 3.0, 0.0)
    code = select(lambda_ == 0.0, 4.0, code)
    code = select(excess < 0.0, 1.0, code)
    code = select(excess < INFINITY, code, 7.0)
    code = select(assembles == 1.0, code, 6.0)
    code = select(far_excess < 0.0, 2.0, code)
    code = select((rho == 0.0) | (abs(rho) == INFINITY) | (x == 0.0), 5.0, code)
    known = (valid == 1.0) & ((completion == 1.0) | (completion == 2.0))
    return select(known, code, 7.0)
