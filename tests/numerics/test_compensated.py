"""Sums and products that keep every digit: exact in rational numbers, with twice the digits of any reading."""

from fractions import Fraction

import numpy as np
import pytest

from fastlink.numerics import compensated
from fastlink.precision.reference import CONTEXT

#: By function what it is of exact numbers, and how many arguments it takes.
EXACT = {
    "two_sum": (lambda a, b: a + b, 2),
    "two_product": (lambda a, b: a * b, 2),
    "sum_of_four": (lambda a, b, c, d: a + b + c + d, 4),
    "pair_product": (lambda a, a_low, b, b_low: (a + a_low) * (b + b_low), 4),
    "pair_quotient": (lambda a, a_low, b, b_low: (a + a_low) / (b + b_low), 4),
    "square_sum": (lambda a, f, f_low, b: a * a + (f + f_low) * b * b, 4),
    "gap_product_quotient": (
        lambda f, f_low, g, g_low, x, y: (f + f_low) * (g + g_low) / (4 * x * y),
        6,
    ),
}
#: Which arguments are low parts, roundings of those before them.
LOW = {
    "pair_product": (1, 3),
    "pair_quotient": (1, 3),
    "square_sum": (2,),
    "gap_product_quotient": (1, 3),
}


def drawn(name, rng, digits):
    """Return arguments, the low parts roundings of those before them in so many digits."""
    numbers = list(rng.uniform(0.5, 2.0, EXACT[name][1]))
    for k in LOW.get(name, ()):
        numbers[k] = numbers[k - 1] * float(rng.uniform(-1.0, 1.0)) * 10.0**-digits
    return numbers


def fraction(x):
    """Return the exact value of a double or an mpmath number."""
    if isinstance(x, float):
        return Fraction(x)
    sign, mantissa, exponent, _ = x._mpf_
    return (-1) ** sign * Fraction(int(mantissa)) * Fraction(2) ** exponent


@pytest.mark.parametrize("name", EXACT)
@pytest.mark.parametrize(("reading", "bits"), [(float, 53), (CONTEXT.mpf, CONTEXT.prec)])
def test_a_pair_has_twice_the_digits(name, reading, bits):
    rng, exact = np.random.default_rng(5), EXACT[name][0]
    for _ in range(50):
        arguments = [reading(x) for x in drawn(name, rng, int(bits * 0.3) + 1)]
        high, low = getattr(compensated, name)(*arguments)
        right = exact(*map(fraction, arguments))
        # some products of low parts are left out: each is a rounding of a rounding
        assert abs(fraction(high) + fraction(low) - right) <= 16 * abs(right) * Fraction(2) ** (-2 * bits)
        assert abs(fraction(high) - right) <= abs(right) * Fraction(2) ** (1 - bits)


@pytest.mark.parametrize("reading", [float, CONTEXT.mpf])
def test_a_sum_that_cancels_keeps_what_is_left(reading):
    numbers = [reading(x) for x in (1.0, 2.0**-60, -1.0, 2.0**-110)]
    high, low = compensated.sum_of_four(*numbers)
    assert fraction(high) + fraction(low) == Fraction(2) ** -60 + Fraction(2) ** -110
