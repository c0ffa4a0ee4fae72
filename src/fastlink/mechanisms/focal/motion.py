"""Facts of the joints of the focal mechanism in one position, whatever drives it.

All directions are unit vectors, as complex numbers: u of MA, v of NB, e of AB, g of SF, and w = exp(i omega) of the
paper's angle omega. Of these five any follows from the other four,

    e g = -k u v w,    k the sign of (1 + rho) lambda,

and F stands off P and Q by -p u w and q v w. What drives gives three of them: see `rocker` and `crank`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastlink.facts.catalogue import Catalogue
from fastlink.mechanisms._shared.laws import (
    along,
    angle,
    borrow,
    borrow_tables,
    difference,
    half,
    moment,
    opposite,
    opposite_product,
    product,
    quotient,
    same,
    total,
    turned,
    twice,
)
from fastlink.mechanisms.focal.design_facts import FOUR_BAR, PREFIX, length_of
from fastlink.mechanisms.focal.inputs import (
    DESIGN,
    GIVEN_LAMBDA,
    WUNDERLICH,
    by_crank,
    either,
    focal,
    quantities,
    steps,
)
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.numerics.compensated import square_sum, two_product
from fastlink.numerics.elementary import NOT_A_NUMBER, atan2, select, sqrt
from fastlink.numerics.vectors import largest, sign

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


# -- The dyads of F, seen from the crank: sin^2(omega/2) and cos^2(omega/2) where the crank lies in the
#    ground line

# In between they are mixed: sin^2(omega/2) = C s_0 + Z s_pi with C = cos^2(sigma/2), Z = sin^2(sigma/2),
# sums of positive terms while the crank turns. The crank can stand in the ground line with omega = 0 or pi
# only where the four-bar folds. So the differences of lengths in the cosine theorem hold its gaps as
# factors: with D = d + k c, D' = d - k c, k = 1 or -1, the sizes R >= L of sqrt(W - D^2) and K = (1 +
# rho)(a^2 + rho b^2)
#
#     s = |lambda|/(4 a b kappa (1 + rho) K) [D (a + rho b) + ..(a - b)] [..(a + b) - D' (a - rho b)]
#
# with kappa = sqrt(x/rho), where .. is sqrt|rho| R or sqrt|rho| L with its sign. A bracket that cancels is
# the quotient of gaps by its other form:
#
#     D^2 (a + rho b)^2 - rho (W - D^2)(a - b)^2 = (D - a + b)(D + a - b) K,
#     rho (W - D'^2)(a + b)^2 - D'^2 (a - rho b)^2 = (a + b - D')(a + b + D') K.


DYAD = f"{DESIGN}#the-crank"


FACTORS = (
    *(f"factor_{letter}{number}" for letter in "ABCD" for number in (1, 2)),
    *("sure_A1", "sure_B1", "sure_C1"),
)
borrow(focal, planar_4r, FOUR_BAR, PREFIX, {name: {} for name in FACTORS})


step = focal.steps(units="1", source=DYAD)
step(product, "K", "K", "(1 + rho)(a^2 + rho b^2), scaled", x="rho", y="common")
step(quotient, "V", "V", "(1 + rho)(a^2 + rho b^2)/lambda, scaled", x="K", y="lambda_")


@focal.quantity(units="1", symbol="sqrt|rho| R", source=DYAD, internal=True)
def greater_root(root_rho: Any, root_x: Any, s_c: Any, s_d: Any) -> Any:
    """Greater of both square roots, times that of the size of rho."""
    return root_rho * (root_x * s_d + s_c / root_x)


@focal.quantity(units="1", symbol="sqrt|rho| L", source=DYAD, internal=True)
def lesser_root(root_rho: Any, root_near: Any, completion: Any) -> Any:
    """Lesser of both square roots, times that of the size of rho, negative in completion 2."""
    return select(completion == 1.0, root_rho, -root_rho) * root_near


@focal.quantity(
    units="1", symbol="sqrt|rho| L", source=DYAD, internal=True, variant=GIVEN_LAMBDA, name="lesser_root"
)
def lesser_root_of_lambda(root_rho: Any, root_x: Any, x: Any, lambda_: Any, s_c: Any, s_d: Any) -> Any:
    """Lesser of both square roots, times that of the size of rho, as it is with lambda given."""
    return root_rho * (select(x < 0.0, (s_d - s_c) - lambda_ * s_d, x * s_d - s_c) / root_x)


@focal.quantity(units="1", symbol="|lambda|/(4 a b kappa (1 + rho))", source=DYAD, internal=True)
def per_dyad(s_a: Any, s_b: Any, lambda_: Any, root_x: Any, root_rho: Any, rho_plus_1: Any) -> Any:
    """|lambda|/(4 a b kappa (1 + rho)), scaled."""
    return abs(lambda_) / (4.0 * (s_a * s_b) * (root_x / root_rho) * rho_plus_1)


@focal.quantity(units="1", symbol="sgn lambda", source=DYAD, internal=True)
def lambda_sign(lambda_: Any) -> Any:
    """Sign of lambda."""
    return select(lambda_ < 0.0, -1.0, 1.0)


@focal.quantity(units="1", symbol="k", source=DYAD, internal=True)
def crank_sign(rho_plus_1: Any, lambda_sign: Any) -> Any:
    """Sign of (1 + rho) lambda."""
    return select(rho_plus_1 < 0.0, -lambda_sign, lambda_sign)


step(opposite, "minus_lambda_sign", "k", "The opposite sign", x="lambda_sign")
step(opposite, "minus_crank_sign", "k", "The opposite sign", x="crank_sign")


@focal.quantity(units="1", symbol="a + rho b", source=DYAD, internal=True)
def bars_sum(s_a: Any, s_b: Any, rho: Any) -> Any:
    """MA and rho times NB, scaled, right to a rounding."""
    part, low = two_product(rho, s_b)
    return (s_a + part) + low


@focal.quantity(units="1", symbol="a - rho b", source=DYAD, internal=True)
def bars_difference(s_a: Any, s_b: Any, rho: Any) -> Any:
    """MA less rho times NB, scaled, right to a rounding."""
    part, low = two_product(rho, s_b)
    return (s_a - part) - low


def of_half_angle(
    side: Any, spin: Any, lambda_sign: Any, ratio_sign: Any, greater_root: Any, lesser_root: Any, s_a: Any,
    s_b: Any, s_c: Any, s_d: Any, bars_sum: Any, bars_difference: Any, K: Any, per_dyad: Any, sure_A1: Any,
    sure_B1: Any, sure_C1: Any, A2: Any, B2: Any, C2: Any, D1: Any, D2: Any,
) -> Any:  # fmt: skip
    """Squared sine or cosine of omega/2 with the crank in the ground line."""
    root = select(side == ratio_sign, lesser_root, -greater_root)
    other_root = select(side == ratio_sign, greater_root, -lesser_root)
    first = side * ((s_a - s_b) * root)
    second = spin * ((s_d + side * s_c) * bars_sum)
    inner = select(side > 0.0, -(B2 * C2), -(sure_B1 * sure_C1))
    third = side * ((s_a + s_b) * other_root)
    fourth = spin * ((side * s_c - s_d) * bars_difference)
    outer = select(side > 0.0, A2 * D2, sure_A1 * D1)
    # the bracket that cancels holds K: it is divided out there
    one_cancels, two_cancels = first * second < 0.0, third * fourth < 0.0
    two = select(two_cancels, K * (outer / (third - fourth)), third + fourth)
    two_per_K = select(two_cancels, outer / (third - fourth), (third + fourth) / K)
    both_per_K = select(one_cancels, inner / (second - first) * two, (first + second) * two_per_K)
    return (spin * lambda_sign) * per_dyad * both_per_K


_FACTORS = {factor.removeprefix("factor_"): f"{PREFIX}{factor}" for factor in FACTORS}


def declare_dyad(name: str, what: str, side: str, spin: str) -> None:
    """Declare a squared sine or cosine of omega/2 with the crank in the ground line."""
    step(of_half_angle, name, "s", f"Squared {what}", side=side, spin=spin, **_FACTORS)


declare_dyad("sine_at_0", "sine of omega/2 at sigma = 0", "crank_sign", "lambda_sign")
declare_dyad("sine_at_pi", "sine of omega/2 at sigma = pi", "minus_crank_sign", "lambda_sign")
declare_dyad("cosine_at_0", "cosine of omega/2 at sigma = 0", "minus_crank_sign", "minus_lambda_sign")
declare_dyad("cosine_at_pi", "cosine of omega/2 at sigma = pi", "crank_sign", "minus_lambda_sign")

# -- F seen from M and N, where the dyads are straight: m - p or m + p, n + q or n - q ------------------------------


@focal.quantity(units="1", symbol="lambda p", source=DYAD, internal=True)
def lambda_p(ratio_sign: Any, lambda_sign: Any, root_rho: Any, root_x: Any, s_b: Any) -> Any:
    """PF times lambda, scaled."""
    return (ratio_sign * lambda_sign) * (root_rho * root_x * s_b)


@focal.quantity(units="1", symbol="|lambda| q", source=DYAD, internal=True)
def lambda_q(root_rho: Any, root_x: Any, s_a: Any) -> Any:
    """QF times the size of lambda, scaled."""
    return root_x / root_rho * s_a


@focal.quantity(units="1", symbol="m -+ p", source=DYAD, internal=True)
def straight_M(
    x: Any, s_m: Any, s_p: Any, P_sign: Any, V: Any, rho: Any, rho_plus_1: Any,
    s_a: Any, s_b: Any, lambda_p: Any,
) -> Any:  # fmt: skip
    """Difference of m and p, or sum where they have not one sign; of their product where P is far away."""
    product = V / rho_plus_1 - rho * (s_b * s_b)
    return select(x < -0.5, product / (s_a + abs(lambda_p)), s_m - P_sign * s_p)


@focal.quantity(units="1", symbol="n +- q", source=DYAD, internal=True)
def straight_N(
    x: Any, s_n: Any, s_q: Any, lambda_sign: Any, V: Any, rho: Any, rho_plus_1: Any,
    s_a: Any, s_b: Any, lambda_q: Any,
) -> Any:  # fmt: skip
    """Difference of n and q, or sum where they have not one sign; of their product where Q is far away."""
    product = (V / rho_plus_1 - s_a * s_a) / rho
    return select(x < -0.5, product / (s_b + abs(lambda_q)), s_n - lambda_sign * s_q)


def where_positive(sign: Any, length: Any) -> Any:
    """Return twice a length where a sign is positive, else 0."""
    return select(sign > 0.0, 2.0 * length, 0.0)


def minus_where_negative(sign: Any, length: Any) -> Any:
    """Return minus twice a length where a sign is negative, else 0."""
    return select(sign < 0.0, -2.0 * length, 0.0)


_CHANGE = "Change along the rocker with the squared half-angle"
step(where_positive, "M_of_sine", "2 p", _CHANGE, sign="P_sign", length="s_p")
step(minus_where_negative, "M_of_cosine", "2 p", _CHANGE, sign="P_sign", length="s_p")
step(minus_where_negative, "N_of_sine", "2 p", _CHANGE, sign="lambda_sign", length="s_q")
step(where_positive, "N_of_cosine", "2 p", _CHANGE, sign="lambda_sign", length="s_q")


@focal.quantity(units="1", symbol="p/m -+ 1", source=DYAD, internal=True)
def straight_lever_M(straight_M: Any, s_m: Any, P_sign: Any) -> Any:
    """PF over MP less its sign."""
    return -(P_sign * straight_M) / s_m


@focal.quantity(units="1", symbol="1 -+ q/n", source=DYAD, internal=True)
def straight_lever_N(straight_N: Any, s_n: Any, lambda_sign: Any) -> Any:
    """Its sign less QF over NQ."""
    return lambda_sign * straight_N / s_n


step(opposite, "minus_s_q", "-q", "Minus the scaled length QF", x="s_q")


# -- Driven by the crank SF: |MF| gives omega, both dyads turn with it, and AB closes by itself

#     u = z/(m - p w),  v = (z - d)/(n + q w),  z = s + r exp(i sigma),
#
# where both sides of a quotient have one length.


SIGMA = by_crank.position.name
#: The tables of the planar 4R, by their names here.
TABLES = {"cos_theta1": "g_x", "sin_theta1": "g_y", "Z": "Z", "C": "C"}

borrow_tables(by_crank, planar_4r, TABLES)

# -- w ----------------------------------------------------------------------------------------------------------


def mixed(at_0: Any, at_pi: Any, C: Any, Z: Any) -> Any:
    """Value that is linear in the cosine of sigma, from its values at 0 and pi."""
    return at_0 * C + at_pi * Z


step = by_crank.steps(units="1", source=f"{WUNDERLICH}, eq. (1.5); {DYAD}")
_SINE = {"at_0": "sine_at_0", "at_pi": "sine_at_pi"}
_COSINE = {"at_0": "cosine_at_0", "at_pi": "cosine_at_pi"}
step(mixed, "squared_half_sine", "sine^2(omega/2)", "Squared sine of omega/2", **_SINE)
step(mixed, "squared_half_cosine", "cosine^2(omega/2)", "Squared cosine of omega/2", **_COSINE)
step = by_crank.steps(units="1", source=f"{WUNDERLICH}, eq. (1.5)")
step(difference, "w_x", "cos omega", "Cosine of omega", x="squared_half_cosine", y="squared_half_sine")
step(twice, "size_of_sine", "|sin omega|", "Sine of omega without its sign", x="half_sine_omega")
step(product, "w_y", "sin omega", "Sine of omega", x="omega_sign", y="size_of_sine")


@by_crank.quantity(units="1", symbol="|sin omega|/2", source=f"{WUNDERLICH}, eq. (1.5)", internal=True)
def half_sine_omega(squared_half_sine: Any, squared_half_cosine: Any) -> Any:
    """Half the sine of omega without its sign; NaN where the dyads do not close."""
    return sqrt(squared_half_sine * squared_half_cosine)


@by_crank.quantity(units="1", symbol="2/|sin omega|", source=f"{WUNDERLICH}, eq. (1.5)", internal=True)
def per_half_sine(half_sine_omega: Any) -> Any:
    """Reciprocal of half the sine of omega; infinite at a dead centre."""
    return 1.0 / half_sine_omega


@by_crank.quantity(units="1", symbol="sgn omega", source=POSITION, internal=True)
def omega_sign(branch: Any) -> Any:
    """Sign of omega: 1 in branch 1, -1 in branch 2."""
    return 3.0 - 2.0 * branch


# -- u, v, e ------------------------------------------------------------------------------------------------------


step = by_crank.steps(units="1", source=f"{WUNDERLICH}, eq. (1.7)")
step(mixed, "MF_x", "z_x", "Vector from M to F, scaled, x", at_0="MF_at_0", at_pi="MF_at_pi")
step(mixed, "NF_x", "(z - d)_x", "Vector from N to F, scaled, x", at_0="NF_at_0", at_pi="NF_at_pi")
step(product, "MF_y", "z_y", "Vector from M to F, scaled, y", x="s_r", y="g_y")


def swing(of_sine: Any, of_cosine: Any, squared_half_sine: Any, squared_half_cosine: Any) -> Any:
    """Part of F seen from M or N along the rocker that changes with omega."""
    return of_sine * squared_half_sine + of_cosine * squared_half_cosine


step = by_crank.steps(units="1", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)")
step(swing, "swing_M", "(m - p w)_x", of_sine="M_of_sine", of_cosine="M_of_cosine")
step(swing, "swing_N", "(n + q w)_x", of_sine="N_of_sine", of_cosine="N_of_cosine")
step(total, "dyad_M_x", "(m - p w)_x", "F seen from M, scaled, along MP", x="straight_M", y="swing_M")
step(total, "dyad_N_x", "(n + q w)_x", "F seen from N, scaled, along NQ", x="straight_N", y="swing_N")
across = by_crank.steps(units="1", source=f"{WUNDERLICH}, eq. (1.3)")
across(opposite, "dyad_M_y", "(m - p w)_y", "F seen from M and MP, scaled, across MP", x="MF_across")
across = by_crank.steps(units="1", source=f"{WUNDERLICH}, eq. (1.4)")
across(product, "dyad_N_y", "(n + q w)_y", "F seen from N and NQ, scaled, across NQ", x="s_q", y="w_y")


def per_lengths(x: Any, y: Any, dyad_x: Any, bar: Any, size_of_sine: Any) -> Any:
    """Reciprocal of the product of two equal lengths, of both signs of omega."""
    dyad_y = bar * size_of_sine
    return 1.0 / sqrt((x * x + y * y) * (dyad_x * dyad_x + dyad_y * dyad_y))


def turned_x(x: Any, y: Any, dyad_x: Any, dyad_y: Any, per: Any) -> Any:
    """First component of a quotient of two vectors of one length."""
    return (x * dyad_x + y * dyad_y) * per


def turned_y(x: Any, y: Any, dyad_x: Any, dyad_y: Any, per: Any) -> Any:
    """Second component of a quotient of two vectors of one length."""
    return (y * dyad_x - x * dyad_y) * per


def declare_rocker(name: str, pivot: str, rocker: str, bar: str) -> None:
    """Declare the direction of a rocker: that of F from its pivot over that of the dyad."""
    per = f"per_{pivot}F"
    vectors = {"x": f"{pivot}F_x", "y": "MF_y", "dyad_x": f"dyad_{pivot}_x", "dyad_y": f"dyad_{pivot}_y"}
    step(per_lengths, per, f"1/{pivot}F^2", f"1/{pivot}F^2, scaled", bar=bar, **vectors)
    step(turned_x, f"{name}_x", f"{name}_x", f"Direction of {rocker}", per=per, **vectors)
    step(turned_y, f"{name}_y", f"{name}_y", f"Direction of {rocker}", per=per, **vectors)


declare_rocker("u", "M", "MA", "s_p")
declare_rocker("v", "N", "NB", "s_q")

# -- angles --------------------------------------------------------------------------------------------------

direction = by_crank.quantities(units="rad", source=FIGURES)
direction(angle, "phi", "phi", "Direction of MA in the ground frame", x="u_x", y="u_y")
direction(angle, "psi", "psi", "Direction of NB in the ground frame", x="v_x", y="v_y")

# -- rates --------------------------------------------------------------------------------------------------------


def rate(
    s_r: Any, base: Any, g_y: Any, x: Any, y: Any, at_0: Any, C: Any, at_pi: Any, Z: Any,
    straight_lever: Any, swing: Any, bar: Any, per_half_sine: Any, omega_sign: Any,
) -> Any:  # fmt: skip
    """Return how fast a rocker turns: as the line from its pivot to F, and as omega changes."""
    lever = straight_lever + swing / bar
    turning = omega_sign * ((0.5 * base) * (g_y * lever) * per_half_sine)
    along_crank = at_0 * C - at_pi * Z
    return s_r * (along_crank + turning) / (x * x + y * y)


def declare_rate(name: str, pivot: str, rocker: str, base: str, bar: str) -> None:
    """Declare how fast a rocker turns."""
    ratio = f"d{name}_dsigma"
    labels = ratio, f"d {name}/d sigma", f"Angular velocity of {rocker} over that of the crank SF"
    given = {"at_0": f"{pivot}F_at_0", "at_pi": f"{pivot}F_at_pi"}
    given |= {"base": base, "bar": bar, "x": f"{pivot}F_x", "y": "MF_y", "swing": f"swing_{pivot}"}
    quantity = by_crank.quantities(units="1", source=POSITION)
    quantity(rate, *labels, straight_lever=f"straight_lever_{pivot}", **given)
    velocity = by_crank.quantities(units="rad s-1", source=POSITION)
    velocity(product, f"{name}_rate", f"d {name}/dt", f"Angular velocity of {rocker}", x="omega", y=ratio)
    by_crank.derivatives(SIGMA)(same, name, x=ratio)


declare_rate("phi", "M", "MA", "s_s", "s_p")
declare_rate("psi", "N", "NB", "s_NS", "minus_s_q")


step = by_crank.steps(units="1", source=POSITION)
step(half, "half_sine", "sin(sigma)/2", "Half the sine of sigma", x="g_y")


@by_crank.quantity(units="1", symbol="-sr/(mp)", source=DYAD, internal=True)
def sine_change(s_s: Any, s_r: Any, s_m: Any, s_p: Any) -> Any:
    """How much sin^2(omega/2) grows over half a turn."""
    return -((s_s / s_m) * (s_r / s_p))


# of tables, and of the facts that replace them in the graded range
for _set in (None, "graded"):
    derivative = by_crank.derivatives(SIGMA, variant=_set)
    derivative(same, "Z", x="half_sine")
    derivative(opposite, "C", x="half_sine")
    derivative(opposite, "g_x", x="g_y")
    derivative(same, "g_y", x="g_x")
    derivative(product, "squared_half_sine", x="sine_change", y="half_sine")
    derivative(opposite_product, "squared_half_cosine", x="sine_change", y="half_sine")


# -- Driven by the rocker MA: the four-bar MABN is a planar 4R, which gives u, v and e; w closes the dyads
#    of F

# P and Q divide MA and NB alike, so that PQ is -(AB + (lambda - 1) MN)/lambda, and of (1.3), (1.4) is left
#
#     w = -sgn(lambda) (e + t)/|e + t| (|rho b u + a v|/(rho b u + a v)),    t = (lambda - 1) d/c.


#: The names that differ from those of the planar 4R.
NAMES = FOUR_BAR | {"cos_theta1": "u_x", "sin_theta1": "u_y", "DB_x": "NB_x", "DB_y": "NB_y"}
NAMES |= {
    "output_ratio": "dpsi_dphi",
    **{name: name for name in ("Z", "C", "Z_low", "C_low", "A_x", "A_y", "AB_x", "AB_y", "branch_sign")},
    **{name: name for name in ("from_low", "from_high", "side")},
}
borrow_tables(focal, planar_4r, NAMES)

DIRECTION_OF_NB = {
    "symbol": "psi",
    "meaning": "Direction of NB in the ground frame",
    "source": f"{WUNDERLICH}, eq. (2.2)",
}
RATIO = {
    "symbol": "d psi/d phi",
    "meaning": "Angular velocity of NB over that of MA",
    "source": f"{WUNDERLICH}, eq. (2.4), differentiated",
    "internal": False,
}
LABELS: dict[str, dict[str, Any]] = {"theta4": DIRECTION_OF_NB, "output_ratio": RATIO}
LABELS |= {name: {} for name in ("AB_x", "AB_y", "DB_x", "DB_y", "AB_v", "sigma", "per_sigma")}
borrow(focal, planar_4r, NAMES, PREFIX, LABELS)


step = focal.steps(units="1", source=FIGURES)
step.vector(quotient, "v_*", "v_*", "Direction of NB", x="NB_*", y="b")
step.vector(quotient, "e_*", "e_*", "Direction of AB", x="AB_*", y="c")


# -- w ----------------------------------------------------------------------------------------------------------


@focal.quantity(units="1", symbol="t", source=POSITION, internal=True)
def t(x: Any, s_c: Any, s_d: Any) -> Any:
    """(lambda - 1) d/c."""
    return x * s_d / s_c


step = focal.steps(units="1", source=POSITION)
step(product, "weight", "rho b", "Rho times NB, scaled", x="rho", y="s_b")


def weighted(weight: Any, u: Any, s_a: Any, v: Any) -> Any:
    """Sum of the directions of MA and NB, weighted."""
    return weight * u + s_a * v


step(weighted, "bars_x", "(rho b u + a v)_x", u="u_x", v="v_x")
step(weighted, "bars_y", "(rho b u + a v)_y", u="u_y", v="v_y")


@focal.quantity(units="1", symbol="2 a d/(b c)", source=POSITION, internal=True)
def sine_lever(s_a: Any, s_b: Any, s_c: Any, s_d: Any) -> Any:
    """Sine of the angle at B over the area of ABN over a d."""
    return 2.0 * (s_a / s_b) * (s_d / s_c)


@focal.quantity(units="1", symbol="sin(AB, NB)", source=POSITION, internal=True)
def sine_B(sine_lever: Any, bar_sigma: Any, branch_sign: Any) -> Any:
    """Sine of the angle from AB to NB, which no difference of their directions gives where both are long."""
    return branch_sign * (sine_lever * bar_sigma)


@focal.quantity(units="1", symbol="sin(MA, AB)", source=POSITION, internal=True)
def sine_A(bar_AB_v: Any, c: Any) -> Any:
    """Sine of the angle from MA to AB."""
    return bar_AB_v / c


@focal.quantity(units="1", symbol="w_x", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)", internal=True)
def along_bars(QP_x: Any, e_y: Any, bars_x: Any, bars_y: Any) -> Any:
    """Minus the cosine of omega, but for a factor with the sign of lambda."""
    return QP_x * bars_x + e_y * bars_y


@focal.quantity(units="1", symbol="w_y", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)", internal=True)
def across_bars(QP_x: Any, e_y: Any, bars_x: Any, bars_y: Any) -> Any:
    """Minus the sine of omega, but for the same factor."""
    return e_y * bars_x - QP_x * bars_y


@focal.quantity(units="1", symbol="1/|..|", source=POSITION, internal=True)
def per_bars(along_bars: Any, across_bars: Any, lambda_sign: Any) -> Any:
    """Reciprocal of that factor: both make a direction, however few digits are left of them."""
    return -lambda_sign / sqrt(along_bars * along_bars + across_bars * across_bars)


step = focal.steps(units="1", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)")
step(product, "closing_x", "cos omega", "Cosine of omega", x="along_bars", y="per_bars")
step(
    product, "closing_y", "sin omega", "Sine of omega, right to roundings of 1", x="across_bars", y="per_bars"
)


# -- the sine of omega, small where two long bars are nearly in line ------------------------------------------------


@focal.quantity(units="1", symbol="(1 + |t|)(|rho| b + a)/4", source=POSITION, internal=True)
def bars_scale(t: Any, weight: Any, s_a: Any) -> Any:
    """A quarter of what both vectors are at most, if nothing cancels."""
    return 0.25 * ((1.0 + abs(t)) * (abs(weight) + s_a))


@focal.quantity(units="1", symbol="w_y", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)", internal=True)
def across_by_sines(
    bars_scale: Any, along_bars: Any, across_bars: Any, weight: Any, s_a: Any, sine_A: Any, sine_B: Any, t: Any,
    bars_y: Any,
) -> Any:  # fmt: skip
    """The same as `across_bars`, with e across u and v known as the sines of the angles at A and B."""
    # where P and Q nearly meet both vectors cancel, and their quotient has to be that of the same two
    by_sines = (weight * sine_A - s_a * sine_B) - t * bars_y
    return select(abs(along_bars) > bars_scale, by_sines, across_bars)


step(product, "closing_sine", "sin omega", "Sine of omega", x="across_by_sines", y="per_bars")


def crank_x(crank_sign: Any, uwv_x: Any, uwv_y: Any, e_x: Any, e_y: Any) -> Any:
    """First component of the direction of SF, -k u v w/e."""
    return -crank_sign * (uwv_x * e_x + uwv_y * e_y)


def crank_y(crank_sign: Any, uwv_x: Any, uwv_y: Any, e_x: Any, e_y: Any) -> Any:
    """Second component of the direction of SF."""
    return crank_sign * (uwv_x * e_y - uwv_y * e_x)


declare_products(focal, "closing")
step = focal.steps(units="1", source=POSITION)
step.vector((crank_x, crank_y), "g_*", "g_*", "Direction of SF")


# -- rates ----------------------------------------------------------------------------------------------------------


of_rocker = focal.quantities(units="rad s-1", source=POSITION)
of_rocker(product, "psi_rate", "d psi/dt", "Angular velocity of NB", x="omega", y="dpsi_dphi")
of_rocker(product, "sigma_rate", "d sigma/dt", "Angular velocity of the crank SF", x="omega", y="dsigma_dphi")


# -- The angles alpha, beta and chi that F encloses with the joints of the four-bar

# Each is that of two vectors from F, in a frame along a bar. FM and FN are taken by the shorter way
# (`joint_F`), and so is FA: by way of P, with PA = (lambda - 1) m, or by way of T. A and F may nearly
# coincide (rho near 0): FA is never MA - MF. Across its bar each is a product: with MP or NQ times
# sin(omega).


@either(units="rad", symbol="alpha", source=f"{WUNDERLICH}, eq. (4.2)")
def alpha(
    s_n: Any, near_q: Any, near_n: Any, w_x: Any, w_y: Any, from_N_by_S_x: Any, from_N_by_S_y: Any, h_x: Any,
    h_y: Any,
) -> Any:  # fmt: skip
    """Angle from FN to FQ, and from AP to AF."""
    x = (near_q + near_n * w_x) + (h_x * from_N_by_S_x + h_y * from_N_by_S_y)
    return atan2(s_n * w_y + 0.0, x)


@either(units="rad", symbol="beta", source=f"{WUNDERLICH}, eq. (4.1)")
def beta(
    ratio_sign: Any, s_m: Any, near_p: Any, near_m: Any, w_x: Any, w_y: Any, by_S_x: Any, by_S_y: Any,
    f_x: Any, f_y: Any,
) -> Any:  # fmt: skip
    """Angle from FP to FM, and from BF to BQ."""
    x = (near_p - near_m * w_x) - (by_S_x * f_x + by_S_y * f_y)
    return atan2(ratio_sign * (s_m * w_y) + 0.0, ratio_sign * x)


# -- chi, in the frame along MA ----------------------------------------------------------------------------------


@focal.quantity(units="1", symbol="FT", source=POSITION, internal=True)
def held_FT_along(held_FT: Any, crank_sign: Any) -> Any:
    """Scaled distance of T from F along u v w, where that way is taken."""
    return -crank_sign * held_FT


step = steps(units="1", source=f"{WUNDERLICH}, eq. (1.3)")
step(product, "MF_across", "h", "Distance of F from MA to its right, scaled", x="s_p", y="w_y")


@either(units="1", symbol="MF_u", source=f"{WUNDERLICH}, eqs. (1.3), (1.7)", internal=True)
def MF_along(near_m: Any, near_p: Any, w_x: Any, by_S_x: Any, by_S_y: Any, u_x: Any, u_y: Any) -> Any:
    """Vector from M to F along MA, scaled."""
    return (near_m - near_p * w_x) + (by_S_x * u_x + by_S_y * u_y)


@either(units="1", symbol="FA_u", source=f"{WUNDERLICH}, eqs. (1.3), (3.2)", internal=True)
def FA_along(
    held_AP: Any, held_p: Any, w_x: Any, held_FT_along: Any, uwv_x: Any, uwv_y: Any, held_AT: Any, e_x: Any,
    e_y: Any, u_x: Any, u_y: Any,
) -> Any:  # fmt: skip
    """Vector from F to A along MA, scaled."""
    x = held_FT_along * uwv_x - held_AT * e_x
    y = held_FT_along * uwv_y - held_AT * e_y
    return (held_AP + held_p * w_x) + (x * u_x + y * u_y)


@either(units="rad", symbol="chi", source=f"{WUNDERLICH}, eq. (4.3)")
def chi(s_a: Any, MF_across: Any, MF_along: Any, FA_along: Any) -> Any:
    """Angle from FA to FM; from FN to FB it is pi - chi, or -chi where rho is negative."""
    x = MF_across * MF_across - MF_along * FA_along
    return atan2(s_a * MF_across + 0.0, x)


# -- Direction of the coupler AB where the crank SF drives: from that of SF, or from MA and NB

# e = -k u v w/g is right to the errors of the other four, and all of these may turn fast while AB hardly
# does (a or b short). c e = (d + b v) - a u is then right to its own: with the shorter rocker taken last, d
# + b v is as long as that and AB together, and where NB points towards M it is (d - b) + b (1 + v), which
# does not cancel. Where AB is shorter than both rockers, it is e that turns fast, and comes from the other
# four.


@focal.quantity(units="1", symbol="c < a, b", source=POSITION, internal=True)
def coupler_is_short(s_a: Any, s_b: Any, s_c: Any) -> Any:
    """1 where AB is shorter than MA and NB, else 0."""
    return select((s_c < s_a) & (s_c < s_b), 1.0, 0.0)


@focal.quantity(units="1", symbol="k", source=POSITION, internal=True)
def fifth_sign(coupler_is_short: Any, crank_sign: Any) -> Any:
    """Minus the sign of (1 + rho) lambda where AB is the shortest, else 0."""
    return -(coupler_is_short * crank_sign)


@focal.quantity(units="1", symbol="1/c", source=POSITION, internal=True)
def per_coupler(coupler_is_short: Any, s_c: Any) -> Any:
    """Reciprocal of c where AB is not the shortest, else 0."""
    return select(coupler_is_short == 1.0, 0.0, 1.0 / s_c)


@focal.quantity(units="1", symbol="b >= a", source=POSITION, internal=True)
def long_v(s_a: Any, s_b: Any) -> Any:
    """1 where NB is the longer rocker, else 0."""
    return select(s_a <= s_b, 1.0, 0.0)


@focal.quantity(units="1", symbol="b < a", source=POSITION, internal=True)
def long_u(long_v: Any) -> Any:
    """1 where MA is the longer rocker, else 0."""
    return 1.0 - long_v


def greater(x: Any, y: Any) -> Any:
    """Return the greater of two lengths."""
    return select(x > y, x, y)


def lesser(x: Any, y: Any) -> Any:
    """Return the lesser of two lengths."""
    return select(x > y, y, x)


def excess(s_d: Any, longer: Any) -> Any:
    """Length MN less the longer rocker."""
    return s_d - longer


step = focal.steps(units="1", source=POSITION)
step(greater, "longer", "max(a, b)", "Longer rocker, scaled", x="s_a", y="s_b")
step(lesser, "shorter", "min(a, b)", "Shorter rocker, scaled", x="s_a", y="s_b")
step(excess, "excess_of_d", "d - max(a, b)")


def from_other_pivot(s_d: Any, longer: Any, excess_of_d: Any, along: Any, across: Any) -> Any:
    """Return d + l t, along MN, for the longer rocker l as seen from the pivot of the other one."""
    towards = excess_of_d + longer * (across * across) / (1.0 + abs(along))
    return select(along < 0.0, towards, s_d + longer * along)


def of_longer(long_v: Any, v: Any, long_u: Any, u: Any) -> Any:
    """Return a component of the longer rocker: v, or -u as seen from A."""
    return long_v * v - long_u * u


def of_shorter(long_v: Any, v: Any, long_u: Any, u: Any) -> Any:
    """Return a component of the shorter rocker: -u, or v."""
    return long_u * v - long_v * u


step = by_crank.steps(units="1", source=POSITION)
step.vector(of_longer, "long_*", "t_*", "Direction of the longer rocker", v="v_*", u="u_*")
step(of_shorter, "short_x", "t_x", "Direction of the shorter rocker", v="v_x", u="u_x")
step(from_other_pivot, "far_x", "d + l t", along="long_x", across="long_y")
declare_products(by_crank, "w")


@by_crank.quantity(units="1", symbol="e_x", source=POSITION, internal=True)
def e_x(
    fifth_sign: Any, uwv_x: Any, uwv_y: Any, g_x: Any, g_y: Any, per_coupler: Any, far_x: Any, shorter: Any,
    short_x: Any,
) -> Any:  # fmt: skip
    """Direction of AB, x."""
    return fifth_sign * (uwv_x * g_x + uwv_y * g_y) + per_coupler * (far_x + shorter * short_x)


@by_crank.quantity(units="1", symbol="e_y", source=POSITION, internal=True)
def e_y(
    fifth_sign: Any, uwv_x: Any, uwv_y: Any, g_x: Any, g_y: Any, per_coupler: Any, s_a: Any, u_y: Any,
    s_b: Any, v_y: Any,
) -> Any:  # fmt: skip
    """Direction of AB, y."""
    return per_coupler * (s_b * v_y - s_a * u_y) - fifth_sign * (uwv_x * g_y - uwv_y * g_x)


# -- Facts of the joint F: its vectors from M, N and S, each by way of the joint in between that is nearest

# Every pivot has two bars to F: from M by way of P (m, p) or of S (s, r), from N by way of Q (n, q) or of
# S. A sum of two bars has the rounding of the longer one, and F may be next to M (rho near 0) or to N (rho
# large), while P and Q (lambda near 0) or S (rho near -1) are far away. So from each pivot the shorter way
# is taken, and the place of F is that from the pivot whose way is shorter; the lengths of the other ways
# count as 0. The height of F over MN is that over S, too: by the crank alone where this is shorter than PF
# or QF, however far S is from M and N.


def whether_nearer(one: Any, two: Any, far: Any, other: Any) -> Any:
    """1 where a way of two lengths is shorter than each of two others, else 0."""
    reach = abs(one) + abs(two)
    return select((reach < abs(far)) & (reach < abs(other)), 1.0, 0.0)


def where(way: Any, length: Any) -> Any:
    """Return a length of a way that is taken, else 0."""
    return select(way == 1.0, length, 0.0)


def unless(way: Any, length: Any) -> Any:
    """Return a length where another way is not taken, else 0."""
    return select(way == 1.0, 0.0, length)


@focal.quantity(units="1", symbol="d - s", source=f"{WUNDERLICH}, eq. (1.9)", internal=True)
def s_SN(s_d: Any, rho_plus_1: Any) -> Any:
    """Scaled distance from S to N along MN."""
    return s_d / rho_plus_1


step = focal.steps(units="1", source=POSITION)
_NEAR = "1 where S is nearer to {0} and F than {1} is, else 0"
step(
    whether_nearer, "near_crank", "|s| + r < |m|, |p|", _NEAR.format("M", "P"),
    one="s_s", two="s_r", far="s_m", other="s_p",
)  # fmt: skip
step(
    whether_nearer, "near_crank_N", "|d - s| + r < |n|, |q|", _NEAR.format("N", "Q"),
    one="s_SN", two="s_r", far="s_n", other="s_q",
)  # fmt: skip
by_S, by_S_N = {"way": "near_crank"}, {"way": "near_crank_N"}
step(where, "near_s", "s_s", length="s_s", **by_S)
step(where, "near_r", "s_r", length="s_r", **by_S)
step(unless, "near_m", "s_m", length="s_m", **by_S)
step(unless, "near_p", "s_p", length="s_p", **by_S)
step(where, "near_SN", "s_SN", length="s_SN", **by_S_N)
step(where, "near_r_N", "s_r", length="s_r", **by_S_N)
step(unless, "near_n", "s_n", length="s_n", **by_S_N)
step(unless, "near_q", "s_q", length="s_q", **by_S_N)

# -- by way of S; 0 where that is not taken ----------------------------------------------------------------------


def by_S_along(start: Any, length: Any, g: Any) -> Any:
    """Return a component of the vector from M or N to F by way of S."""
    return start + length * g


def by_S_across(length: Any, g: Any) -> Any:
    """Return the component of that vector across MN."""
    return length * g


step = steps(units="1", source=f"{WUNDERLICH}, eq. (1.7)")
step(opposite, "near_NS", "s - d", "Scaled distance from N to S, where that way is taken", x="near_SN")
_FROM = "Vector from {} to F by way of S, {}"
step(by_S_along, "by_S_x", "z_x", _FROM.format("M", "x"), start="near_s", length="near_r", g="g_x")
step(by_S_across, "by_S_y", "z_y", _FROM.format("M", "y"), length="near_r", g="g_y")
step(
    by_S_along,
    "from_N_by_S_x",
    "z_x - d",
    _FROM.format("N", "x"),
    start="near_NS",
    length="near_r_N",
    g="g_x",
)
step(by_S_across, "from_N_by_S_y", "z_y", _FROM.format("N", "y"), length="near_r_N", g="g_y")

# -- driven by the rocker -----------------------------------------------------------------------------------------


def whether_far(near_crank: Any) -> Any:
    """1 where F is computed from P, else 0."""
    return 1.0 - near_crank


@focal.quantity(units="1", symbol="sgn p m", source=POSITION, internal=True)
def near_P_sign(near_crank: Any, P_sign: Any) -> Any:
    """Sign of m p where F is computed from S, else 0."""
    return near_crank * P_sign


@focal.quantity(units="1", symbol="1/p", source=POSITION, internal=True)
def near_per_p(near_crank: Any, s_p: Any) -> Any:
    """Reciprocal of p where F is computed from S, else 0."""
    return select(near_crank == 1.0, 1.0 / s_p, 0.0)


focal.steps(units="1", source=POSITION)(whether_far, "far_crank", "1")


@focal.quantity(units="1", symbol="sin(MA, SF)", source=POSITION, internal=True)
def sine_of_crank(
    crank_sign: Any, sine_B: Any, e_x: Any, e_y: Any, v_x: Any, v_y: Any, closing_x: Any, closing_sine: Any
) -> Any:
    """Sine of the angle from MA to SF, which is -k v w/e."""
    return -crank_sign * (sine_B * closing_x + (e_x * v_x + e_y * v_y) * closing_sine)


@focal.quantity(units="1", symbol="sin omega", source=f"{WUNDERLICH}, eq. (1.3)", internal=True)
def by_S_sine(near_per_p: Any, near_s: Any, near_r: Any, sine_of_crank: Any, u_y: Any) -> Any:
    """Sine of omega by way of S: the height of F over MP, over p."""
    return near_per_p * (near_s * u_y - near_r * sine_of_crank)


@focal.quantity(units="1", symbol="cos omega", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)", internal=True)
def w_x(far_crank: Any, closing_x: Any, near_P_sign: Any, by_S_sine: Any) -> Any:
    """Cosine of omega."""
    # PF and PM are longer than FM where F is computed from S: omega is within pi/3 of 0 or pi
    return far_crank * closing_x + near_P_sign * sqrt(1.0 - by_S_sine * by_S_sine)


@focal.quantity(units="1", symbol="sin omega", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)", internal=True)
def w_y(far_crank: Any, closing_sine: Any, by_S_sine: Any) -> Any:
    """Sine of omega."""
    return far_crank * closing_sine + by_S_sine


# -- its place, from the pivot whose way is shorter ----------------------------------------------------------------


@focal.quantity(units="1", symbol="NF < MF", source=POSITION, internal=True)
def near_N(
    near_s: Any, near_m: Any, near_p: Any, near_SN: Any, near_r: Any, near_r_N: Any, near_n: Any, near_q: Any
) -> Any:
    """1 where the way from N to F is shorter than that from M, else 0."""
    from_M = (abs(near_s) + near_r) + (abs(near_m) + abs(near_p))
    from_N = (abs(near_SN) + near_r_N) + (abs(near_n) + near_q)
    return select(from_N < from_M, 1.0, 0.0)


def of_nearer(near_N: Any, from_M: Any, from_N: Any) -> Any:
    """Return a length of the way from M, or of that from N where this is shorter."""
    return select(near_N == 1.0, from_N, from_M)


@focal.quantity(units="1", symbol="MF_0", source=POSITION, internal=True)
def place_start(near_N: Any, near_s: Any, near_crank_N: Any, s_s: Any, s_d: Any) -> Any:
    """Where the way to F begins, by way of S at S itself: M, S or N, as seen from M, scaled."""
    return select(near_N == 1.0, select(near_crank_N == 1.0, s_s, s_d), near_s)


@focal.quantity(units="1", symbol="SF_0", source=POSITION, internal=True)
def crank_start(near_N: Any, near_crank: Any, near_crank_N: Any, s_s: Any, s_SN: Any) -> Any:
    """Where the way to F begins, as seen from S, scaled."""
    from_N = select(near_crank_N == 1.0, 0.0, s_SN)
    return select(near_N == 1.0, from_N, select(near_crank == 1.0, 0.0, -s_s))


step = focal.steps(units="1", source=POSITION)
step(of_nearer, "place_r", "s_r", from_M="near_r", from_N="near_r_N")
by_N = {"way": "near_N"}
step(unless, "place_m", "s_m", length="near_m", **by_N)
step(unless, "place_p", "s_p", length="near_p", **by_N)
step(where, "place_n", "s_n", length="near_n", **by_N)
step(where, "place_q", "s_q", length="near_q", **by_N)


# -- its height, by the crank where that is shorter still: S is on MN ----------------------------------------------


@focal.quantity(units="1", symbol="r < p, q", source=POSITION, internal=True)
def height_by_S(s_r: Any, place_p: Any, place_q: Any) -> Any:
    """1 where the crank is shorter than PF or QF, whichever is on the way that is taken, else 0."""
    # heights of P and Q are products, right to roundings of their own: only what stands off them has others
    return select(s_r < abs(place_p) + place_q, 1.0, 0.0)


@focal.quantity(units="1", symbol="r", source=POSITION, internal=True)
def height_r(height_by_S: Any, s_r: Any, place_r: Any) -> Any:
    """The crank where the height of F is taken from S, else 0, scaled."""
    return select(height_by_S == 1.0, s_r, place_r)


step = focal.steps(units="1", source=POSITION)
HEIGHT = {"place_r": "height_r"}
for _bar in "mpnq":
    HEIGHT[f"place_{_bar}"] = f"height_{_bar}"
    step(unless, f"height_{_bar}", f"s_{_bar}", way="height_by_S", length=f"place_{_bar}")


def way(
    place_r: Any,
    g: Any,
    place_m: Any,
    u: Any,
    place_p: Any,
    f: Any,
    place_n: Any,
    v: Any,
    place_q: Any,
    h: Any,
) -> Any:
    """Return a component of the bars of the shorter way."""
    return place_r * g + ((place_m * u - place_p * f) + (place_n * v + place_q * h))


def way_from(start: Any, way: Any) -> Any:
    """Return the component along MN of a vector to F."""
    return start + way


step = focal.steps(units="1", source=f"{WUNDERLICH}, eqs. (1.3), (1.4), (1.7)")
_BARS = {"g": "g_*", "u": "u_*", "f": "f_*", "v": "v_*", "h": "h_*"}
along_x = {name: bar.replace("*", "x") for name, bar in _BARS.items()}
along_y = {name: bar.replace("*", "y") for name, bar in _BARS.items()}
step(way, "way_x", "z_x", "Bars of the shorter way to F, scaled, x", **along_x)
step(way, "MF_y", "z_y", "Vector from M, N or S to F, scaled, y", **HEIGHT, **along_y)
step(way_from, "MF_x", "z_x", "Vector from M to F, scaled, x", start="place_start", way="way_x")
step(way_from, "SF_x", "z_x - s", "Vector from S to F, scaled, x", start="crank_start", way="way_x")
angle_of_crank = focal.quantities(units="rad", source=FIGURES)
angle_of_crank(angle, "sigma", "sigma", "Direction of the crank SF in the ground frame", x="SF_x", y="MF_y")


@focal.quantity(units="1", symbol="(1 + rho) kappa b/(2 d |lambda|)", source=POSITION, internal=True)
def crank_lever(rho_plus_1: Any, root_x: Any, root_rho: Any, s_b: Any, s_d: Any, lambda_: Any) -> Any:
    """p/(2 s)."""
    return 0.5 * rho_plus_1 * (root_x / root_rho) * (s_b / s_d) / abs(lambda_)


@focal.quantity(units="1", symbol="d sigma/d phi", source=POSITION)
def dsigma_dphi(crank_lever: Any, w_y: Any, bar_per_sigma: Any, branch_sign: Any) -> Any:
    """Angular velocity of the crank SF over that of MA."""
    return branch_sign * (crank_lever * w_y * bar_per_sigma)


def where_it_points(rho_plus_1: Any, rate: Any) -> Any:
    """Return the derivative of a direction, which the crank with S at infinity has not."""
    return select(rho_plus_1 == 0.0, NOT_A_NUMBER, rate)


focal.derivatives(focal.position.name)(where_it_points, "sigma", rate="dsigma_dphi")


# -- How well a computed position of the focal mechanism closes: measures of rounding errors


# -- the bars ---------------------------------------------------------------------------------------------------


def bar_error(
    from_x: Any, from_y: Any, to_x: Any, to_y: Any, length: Any, size: Any, lift: Any, unit: Any
) -> Any:
    """Return the difference of a bar from its length over the longest bar."""
    x = (to_x - from_x) * lift / unit
    y = (to_y - from_y) * lift / unit
    return abs(sqrt(x * x + y * y) - abs(length)) / size


def rocker_error(x: Any, y: Any, length: Any, size: Any, lift: Any, unit: Any) -> Any:
    """Return the difference of a bar with an end in M from its length over the longest bar."""
    x_scaled = x * lift / unit
    y_scaled = y * lift / unit
    return abs(sqrt(x_scaled * x_scaled + y_scaled * y_scaled) - length) / size


def pivot_error(x: Any, y: Any, place: Any, length: Any, size: Any, lift: Any, unit: Any) -> Any:
    """Return the difference of a bar with an end on MN from its length over the longest bar."""
    x_scaled = (x - place) * lift / unit
    y_scaled = y * lift / unit
    return abs(sqrt(x_scaled * x_scaled + y_scaled * y_scaled) - length) / size


@either(units="1", symbol="max", source=POSITION, internal=True)
def longest_bar(
    s_a: Any, s_b: Any, s_c: Any, s_d: Any, s_m: Any, s_n: Any, s_p: Any, s_q: Any, s_r: Any, s_FT: Any
) -> Any:
    """Longest of all bars, scaled."""
    four_bar = largest(s_a, s_b, s_c, s_d)
    dyads = largest(abs(s_m), abs(s_n), abs(s_p), abs(s_q))
    crank = select(s_r > s_FT, s_r, select(s_FT == s_FT, s_FT, 0.0))
    return largest(four_bar, dyads, crank, 0.0)


def declare_bar(bar: str, law: Callable[..., Any], **given: str) -> None:
    """Declare how far the ends of a bar are from its length."""
    step(law, f"error_{bar}", "e", size="longest_bar", **given)


def declare_moving(bar: str, length: str) -> None:
    """Declare the same of a bar without an end on MN."""
    start, end = bar[0], bar[1]
    ends = {"from_x": f"{start}_x", "from_y": f"{start}_y", "to_x": f"{end}_x", "to_y": f"{end}_y"}
    declare_bar(bar, bar_error, length=length, **ends)


step = steps(units="1", source=POSITION)
declare_moving("AB", "s_c")
declare_moving("PF", "s_p")
declare_moving("QF", "s_q")
declare_moving("TF", "s_FT")
declare_bar("MA", rocker_error, x="A_x", y="A_y", length="s_a")
declare_bar("NB", pivot_error, x="B_x", y="B_y", place="d", length="s_b")
declare_bar("SF", pivot_error, x="F_x", y="F_y", place="S_x", length="s_r")

# -- the ratios -------------------------------------------------------------------------------------------------


@either(units="1", symbol="e", source=f"{WUNDERLICH}, eq. (2.5)", internal=True)
def error_PQ(
    A_x: Any, A_y: Any, B_x: Any, B_y: Any, P_x: Any, P_y: Any, Q_x: Any, Q_y: Any, d: Any, lambda_: Any,
    longest_bar: Any, lift: Any, unit: Any,
) -> Any:  # fmt: skip
    """Error of MP : MA = NQ : NB = 1 : lambda."""
    x = abs(A_x - lambda_ * P_x) + abs((B_x - d) - lambda_ * (Q_x - d))
    y = abs(A_y - lambda_ * P_y) + abs(B_y - lambda_ * Q_y)
    return (x + y) * lift / unit / ((1.0 + abs(lambda_)) * longest_bar)


@either(units="1", symbol="e", source=f"{WUNDERLICH}, eq. (3.2)", internal=True)
def error_ST(
    A_x: Any, A_y: Any, B_x: Any, B_y: Any, T_x: Any, T_y: Any, S_x: Any, d: Any, rho: Any,
    longest_bar: Any, lift: Any, unit: Any,
) -> Any:  # fmt: skip
    """Error of AT : TB = MS : SN = rho."""
    x = abs((T_x - A_x) - rho * (B_x - T_x)) + abs(S_x - rho * (d - S_x))
    y = abs((T_y - A_y) - rho * (B_y - T_y))
    return (x + y) * lift / unit / ((1.0 + abs(rho)) * longest_bar)


def greater_error(x: Any, y: Any) -> Any:
    """Return the greater_error of two errors; NaN if one is."""
    return select((x > y) | (x != x), x, y)


_UP_TO = "Greatest error up to this one"
step(greater_error, "greatest_to_NB", "e", _UP_TO, x="error_MA", y="error_NB")
step(greater_error, "greatest_to_AB", "e", _UP_TO, x="greatest_to_NB", y="error_AB")
step(greater_error, "greatest_to_PF", "e", _UP_TO, x="greatest_to_AB", y="error_PF")
step(greater_error, "greatest_to_QF", "e", _UP_TO, x="greatest_to_PF", y="error_QF")
step(greater_error, "greatest_to_PQ", "e", _UP_TO, x="greatest_to_QF", y="error_PQ")


@either(units="1", symbol="e", source=POSITION)
def closure_residual(
    greatest_to_PQ: Any, error_SF: Any, error_TF: Any, error_ST: Any, rho_plus_1: Any
) -> Any:
    """Greatest closure error of the eight bars and of both ratios (2.5), (3.2), relative to the longest bar."""
    crank = select((error_SF > error_TF) | (error_SF != error_SF), error_SF, error_TF)
    support = select((crank > error_ST) | (crank != crank), crank, error_ST)
    rest = select(rho_plus_1 == 0.0, 0.0, support)
    return select((greatest_to_PQ > rest) | (greatest_to_PQ != greatest_to_PQ), greatest_to_PQ, rest)


@either(units="m", symbol="e_F", source=f"{WUNDERLICH}, eq. (1.6) over nq")
def F_path_residual(
    F_x: Any, F_y: Any, s_a: Any, s_b: Any, s_c: Any, s_d: Any, rho: Any, rho_plus_1: Any, root_rho: Any,
    root_x: Any, lambda_: Any, lift: Any, unit: Any,
) -> Any:  # fmt: skip
    """Distance of the computed F from its circle, or with rho = -1 from its straight line."""
    # (1 + rho) z zbar - rho d (z + zbar - d) = (a^2 + rho b^2)/lambda, over the gradient between F and the circle
    x = F_x * lift / unit
    y = F_y * lift / unit
    power = rho_plus_1 * (x * x + y * y) - rho * (s_d * (2.0 * x - s_d))
    sides, _low = square_sum(s_a, rho, 0.0, s_b)
    excess = power - sides / lambda_
    across = rho_plus_1 * x - rho * s_d
    radius = sqrt(across * across + (rho_plus_1 * y) * (rho_plus_1 * y))
    return abs(excess) / (radius + s_c * (root_rho / root_x)) * unit / lift


# -- Where F crosses MN: s + r with sigma = 0 and s - r with sigma = pi, as seen from M and N

# In between, z_x = (s + r) C + (s - r) Z with C = cos^2(sigma/2), Z = sin^2(sigma/2). Where S is far away,
# or M near the circle of F, one of both is a difference. It is the length of the dyad MPF there, |m - p
# w|^2 = (|m| - |p|)^2 + 4 |m p| s of the squared half-angle s of `dyad`, a sum of positive terms where F
# reaches it. Where it does not and S is far away, it is the power of M over the other one.
#
# Next to kites F passes a pivot: a = c and b = d, then the circle of F passes M, or a = d and b = c, then
# N. On which side is the sign of the power, which eq. (2.5) makes a sum of differences of lengths:
#
#     s^2 - r^2 = [(c^2 - a^2) + rho (d^2 - b^2)]/((1 + rho)(1 - x/rho)),
#     (d - s)^2 - r^2 = [(d^2 - a^2) + rho (c^2 - b^2)]/((1 + rho)(1 - x rho)),      x = lambda - 1.


#: A difference is as good as its terms where it is so much of them.
LEAST = 0.125


@focal.quantity(units="1", symbol="|1 + rho| < 1/2", source=POSITION, internal=True)
def far_S(rho_plus_1: Any) -> Any:
    """1 where S is far away, else 0."""
    return select(abs(rho_plus_1) < 0.5, 1.0, 0.0)


def power_of_M(rho: Any, s_d: Any, V: Any, rho_plus_1: Any) -> Any:
    """Power of M with respect to the circle of F, s^2 - r^2."""
    return (rho * (s_d * s_d) - V / rho_plus_1) / rho_plus_1


def power_of_N(s_d: Any, V: Any, rho_plus_1: Any) -> Any:
    """Power of N with respect to the circle of F, (d - s)^2 - r^2."""
    return (s_d * s_d - V / rho_plus_1) / rho_plus_1


def gap(longer: Any, shorter: Any) -> Any:
    """Difference of two squared lengths."""
    return (longer - shorter) * (longer + shorter)


def apart(share: Any) -> Any:
    """1 less a share, 0 where that cancels."""
    rest = 1.0 - share
    return select(abs(rest) > LEAST * (1.0 + abs(share)), rest, 0.0)


def power_by_gaps(one: Any, rho: Any, other: Any, rho_plus_1: Any, apart: Any) -> Any:
    """Power of M or N with respect to the circle of F, by differences of lengths."""
    return (one + rho * other) / (rho_plus_1 * apart)


def whether_by_gaps(
    total: Any, other: Any, one: Any, rho: Any, second: Any, rho_plus_1: Any, apart: Any
) -> Any:
    """1 where a total cancels and differences of lengths do not, else 0."""
    terms, size = abs(one) + abs(rho * second), abs(rho_plus_1 * apart)
    return select((abs(total) < LEAST * abs(other)) & (terms < LEAST * size * (other * other)), 1.0, 0.0)


def where_folded(fold_sign: Any, sine: Any, cosine: Any) -> Any:
    """Return the squared half-angle that is 0 where a dyad is folded: sine or cosine."""
    return select(fold_sign > 0.0, sine, cosine)


def dyad_length(straight: Any, one: Any, two: Any, squared: Any) -> Any:
    """Return the length of a dyad with the crank in MN, from that where it is folded; only where it reaches."""
    return sqrt(straight * straight + 4.0 * abs(one * two) * select(squared > 0.0, squared, 0.0))


def better_known(
    one: Any, two: Any, s_r: Any, squared: Any, dyad: Any, far_S: Any, power: Any, total: Any, other: Any,
    by_gaps: Any, power_by_gaps: Any,
) -> Any:  # fmt: skip
    """Return a total that cancels: from the dyad, if that is shorter than the crank and reaches, or from the power."""
    by_power = select(far_S == 1.0, power / other, total)
    by_power = select(by_gaps == 1.0, power_by_gaps / other, by_power)
    shorter = abs(one) + abs(two) < s_r
    return select(shorter & (squared >= 0.0), sign(by_power) * dyad, by_power)


def crossing_at_0(start: Any, total: Any, better: Any) -> Any:
    """Return where F crosses MN with sigma = 0: start + r."""
    return select(start < 0.0, better, total)


def crossing_at_pi(start: Any, total: Any, better: Any) -> Any:
    """Return where F crosses MN with sigma = pi: start - r."""
    return select(start > 0.0, better, total)


def declare_crossings(pivot: str, start: str, fold_sign: str, one: str, two: str) -> None:
    """Declare where F crosses MN, as seen from M or N."""
    gaps = {"one": f"{pivot}_gap_of_a", "second": f"{pivot}_gap_of_b", "apart": f"{pivot}_apart"}
    by_power = f"{pivot}_power_by_gaps"
    step(power_by_gaps, by_power, "s^2 - r^2", one=gaps["one"], other=gaps["second"], apart=gaps["apart"])
    sums = {"at_0": total, "at_pi": difference}
    for law, end, other in ((crossing_at_0, "at_0", "at_pi"), (crossing_at_pi, "at_pi", "at_0")):
        squared, dyad, better = (f"{pivot}_{what}_{end}" for what in ("squared", "dyad", "better"))
        sum_of = {side: f"{pivot}_sum_{side}" for side in sums}
        step(sums[end], sum_of[end], "s", x=start, y="s_r")
        step(where_folded, squared, "s", fold_sign=fold_sign, sine=f"sine_{end}", cosine=f"cosine_{end}")
        step(dyad_length, dyad, f"{pivot}F", straight=f"straight_{pivot}", one=one, two=two, squared=squared)
        given = {"one": one, "two": two, "squared": squared, "dyad": dyad, "power": f"power_of_{pivot}"}
        by_gaps, totals = f"{pivot}_by_gaps_{end}", {"total": sum_of[end], "other": sum_of[other]}
        step(whether_by_gaps, by_gaps, "|s - r| < s/8", **totals, **gaps)
        given |= {"by_gaps": by_gaps, "power_by_gaps": by_power}
        step(better_known, better, f"{pivot}F", **totals, **given)
        step(law, f"{pivot}F_{end}", f"{pivot}F", total=sum_of[end], start=start, better=better)


step = focal.steps(units="1", source=DYAD)
step(opposite, "s_NS", "-(d - s)", "Scaled distance from N to S along MN", x="s_SN")
step(power_of_M, "power_of_M", "s^2 - r^2")
step(power_of_N, "power_of_N", "(d - s)^2 - r^2")
step(gap, "M_gap_of_a", "c^2 - a^2", "c^2 - a^2, scaled", longer="s_c", shorter="s_a")
step(gap, "M_gap_of_b", "d^2 - b^2", "d^2 - b^2, scaled", longer="s_d", shorter="s_b")
step(gap, "N_gap_of_a", "d^2 - a^2", "d^2 - a^2, scaled", longer="s_d", shorter="s_a")
step(gap, "N_gap_of_b", "c^2 - b^2", "c^2 - b^2, scaled", longer="s_c", shorter="s_b")
step(quotient, "M_share", "x/rho", "x/rho", x="x", y="rho")
step(product, "N_share", "rho x", "rho x", x="rho", y="x")
step(apart, "M_apart", "1 - x/rho", share="M_share")
step(apart, "N_apart", "1 - rho x", share="N_share")
declare_crossings("M", "s_s", "P_sign", "s_m", "s_p")
declare_crossings("N", "s_NS", "minus_lambda_sign", "s_n", "s_q")
