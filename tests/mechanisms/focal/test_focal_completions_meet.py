"""Where both completions meet: the last bit of the inputs decides whether there is one."""

from __future__ import annotations

from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
from tests.support.focal_designs import GIVEN, LENGTHS, random_designs

import fastlink as fl

BARS = ("lambda_", "m", "n", "p", "q", "r", "FT")
COMPLETED, NONE = 0.0, 1.0


def quadratic(given, lengths, sign):
    """Return the coefficients of the discriminant times the denominators, by powers of what is given, least first.

    W - (u +- v)^2 = 0 with W = (1 + x)(f^2 + x g^2)/x, where x is the given ratio; s = d x/(1 + x).
    """
    a, b, c, d = map(Fraction, lengths)
    f, g, u, v = (c, d, a, b) if given == "lambda_" else (a, b, c, d)
    of_ratio = (f * f, f * f + g * g - (u + sign * v) ** 2, g * g)
    if given == "rho":
        return of_ratio
    p, q, r = of_ratio
    if given == "lambda_":  # x = lambda - 1
        return p - q + r, q - 2 * r, r
    return p * d * d, q * d - 2 * p * d, p - q + r  # x = s/(d - s), times (d - s)^2


def ratio_of(given, value, d):
    """Return rho of s, lambda - 1 of lambda, exactly."""
    value = Fraction(value)
    if given == "s":
        return value / (Fraction(d) - value)
    return value - 1 if given == "lambda_" else value


def meeting(rng, n, given):
    """Yield lengths, a ratio within three last bits of where completions meet, and whether they exist, exactly."""
    designs = random_designs(rng, n)
    for lengths in zip(*(designs[name].tolist() for name in LENGTHS), strict=True):
        if 2 * max(lengths) >= sum(lengths):  # the four-bar never assembles
            continue
        for sign in (1, -1):
            p, q, r = (mp.mpf(one.numerator) / one.denominator for one in quadratic(given, lengths, sign))
            if q * q < 4 * p * r:
                continue
            root = float((-q + rng.choice([-1, 1]) * mp.sqrt(q * q - 4 * p * r)) / (2 * r))
            for steps in range(-3, 4):
                value = root + steps * float(np.spacing(root))
                x = ratio_of(given, value, lengths[3])
                if (x > 0) == (sign > 0):
                    parts = enumerate(quadratic(given, lengths, sign))
                    excess = sum(part * Fraction(value) ** k for k, part in parts)
                    # W - (u +- v)^2 is that over x: real roots need it positive, or with a negative x negative
                    yield lengths, value, excess >= 0


@pytest.mark.parametrize("given", GIVEN)
def test_the_last_bit_decides_whether_there_is_a_completion(given):
    with mp.workdps(60):
        lengths, values, exist = zip(*meeting(np.random.default_rng(5), 60, given), strict=True)
    design = dict(zip(LENGTHS, np.array(lengths).T, strict=True)) | {given: np.array(values)}
    names = [name for name in BARS if name != given]
    for completion in (1, 2):
        found = fl.evaluate("focal", ["status", *names], **design, completion=completion, phi=1.0, branch=1)
        np.testing.assert_array_equal(found["status"], np.where(exist, COMPLETED, NONE))
        for name in names:
            np.testing.assert_array_equal(np.isfinite(found[name]), exist)
    assert 0.2 < np.mean(exist) < 0.8
    assert len(exist) > 200
