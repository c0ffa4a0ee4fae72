"""The two completions of a four-bar to a focal mechanism, by the ratio that is given.

With rho = mp : nq and x = lambda - 1 = pq : mn, the paper's condition on lambda (2.5) is one symmetric equation,

    (1 + rho) (a^2 + rho b^2)/rho  =  (1 + x) (c^2 + x d^2)/x,    rho and x of one sign.

So the laws below find x of a given rho by the pair c, d, and rho of a given x (`lambda_`) by the pair a, b. Their
unknown is t u/v, where t and 1/t have the product 1: it is the square root of sums that do not cancel, and
1 + the unknown follows from the product of both roots, (1 + t u/v)(1 + u/(v t)) = W/v^2.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms.focal.inputs import DESIGN, GIVEN_LAMBDA, GIVEN_S, WUNDERLICH, focal
from fastlink.numerics.compensated import (
    pair_product,
    pair_quotient,
    power_of_two_below,
    square_sum,
    sum_of_four,
    two_sum,
)
from fastlink.numerics.elementary import NOT_A_NUMBER, select, sqrt
from fastlink.numerics.vectors import sign

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
