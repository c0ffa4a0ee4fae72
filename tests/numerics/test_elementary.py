"""Elementary functions and sums: compiled and plain, against mpmath and IEEE 754."""

import itertools

import mpmath as mp
import numpy as np
import pytest
from tests.support.compiled import Compiled

from fastlink.numerics import compensated, elementary
from fastlink.numerics.compensated import UNIT_ROUNDING

ATAN2 = Compiled(elementary, "atan2(a, b)")
DIRECTION = Compiled(elementary, "cosine(a)", "sine(a)")


def both_readings(y, x):
    compiled = ATAN2(y, x)
    with np.errstate(all="ignore"):
        plain = elementary.atan2(y, x)
    np.testing.assert_array_equal(compiled.view(np.int64), plain.view(np.int64))
    return compiled


def test_atan2_is_within_two_units_in_the_last_place_in_all_quadrants():
    rng = np.random.default_rng(1)
    angle = rng.uniform(-np.pi, np.pi, 6000)
    # The first third anywhere, the second near the axes and diagonals, the third over all exponents.
    angle[2000:4000] = np.round(angle[2000:4000] / (np.pi / 4)) * (np.pi / 4) + rng.normal(0, 1e-3, 2000)
    radius = np.exp(rng.uniform(-5, 5, 6000))
    radius[4000:] = np.exp(rng.uniform(-600, 600, 2000))
    y, x = radius * np.sin(angle), radius * np.cos(angle)
    got = both_readings(y, x)
    with mp.workdps(40):
        for a, b, value in zip(y, x, got, strict=True):
            exact = mp.atan2(mp.mpf(float(a)), mp.mpf(float(b)))
            assert abs(mp.mpf(float(value)) - exact) <= 2 * np.spacing(abs(float(exact)))


def test_atan2_has_signed_zeros_and_infinities_as_ieee():
    special = [0.0, -0.0, 1.0, -1.0, np.inf, -np.inf, 5e-324, -1e-310, 1e308, -1.7e308]
    y, x = (np.array(column) for column in zip(*itertools.product(special, special), strict=True))
    got, expected = both_readings(y, x), np.arctan2(y, x)
    np.testing.assert_array_equal(np.signbit(got), np.signbit(expected))
    # 2 units of ours and 1 of the library's.
    assert np.all((np.abs(got - expected) <= 3 * np.spacing(np.abs(expected))) | (got == expected))
    exact = np.isin(expected, [0.0, np.pi, -np.pi, np.pi / 2, -np.pi / 2])
    np.testing.assert_array_equal(got[exact], expected[exact])


@pytest.mark.parametrize(("y", "x"), [(np.nan, 1.0), (1.0, np.nan), (np.nan, np.nan), (np.nan, -0.0)])
def test_atan2_keeps_nan(y, x):
    assert np.isnan(both_readings(np.array([y]), np.array([x]))[0])


def test_two_product_is_exact():
    rng = np.random.default_rng(3)
    for a, b in rng.normal(size=(300, 2)) * np.exp(rng.uniform(-100, 100, (300, 1))):
        p, e = compensated.two_product(float(a), float(b))
        with mp.workdps(60):
            assert mp.mpf(p) + mp.mpf(e) == mp.mpf(float(a)) * mp.mpf(float(b))


def test_gap_product_quotient_has_thirty_digits():
    rng = np.random.default_rng(4)
    for _ in range(300):
        f, g, x, y = (float(v) for v in rng.uniform(0.1, 2.0, 4))
        f_low, g_low = f * UNIT_ROUNDING * 0.3, -g * UNIT_ROUNDING * 0.4
        high, low = compensated.gap_product_quotient(f, f_low, g, g_low, x, y)
        with mp.workdps(60):
            exact = (mp.mpf(f) + f_low) * (mp.mpf(g) + g_low) / (4 * mp.mpf(x) * y)
            # Each of the dropped terms is of second order in the rounding unit; there are fewer than 16.
            assert abs(mp.mpf(high) + low - exact) <= 16 * mp.mpf(UNIT_ROUNDING) ** 2 * abs(exact)


def test_power_of_two_below():
    for x in [1.0, 1.5, 1.9999999999999998, 2.0, 3e-150, 7e150, 0.4]:
        assert compensated.power_of_two_below(x) == 2.0 ** np.floor(np.log2(x))


def test_square_root_below_zero_is_nan_in_every_reading():
    assert mp.isnan(elementary.sqrt(mp.mpf(-1)))
    with np.errstate(invalid="ignore"):
        assert np.isnan(elementary.sqrt(-1.0))


def test_cosine_and_sine_are_within_two_units_in_the_last_place_and_one_text():
    rng = np.random.default_rng(4)
    x = np.concatenate(
        [rng.uniform(-7, 7, 3000), np.arange(-32, 33) * (np.pi / 4), rng.uniform(-1e6, 1e6, 500)]
    )
    beyond = np.array([1.1e6, np.inf, -np.inf, np.nan])
    cosines, sines = DIRECTION(np.append(x, beyond))
    assert np.isnan([*cosines[-4:], *sines[-4:]]).all()
    np.testing.assert_array_equal(cosines[:-4], elementary.cosine(x))
    np.testing.assert_array_equal(sines[:-4], elementary.sine(x))
    with mp.workdps(40):
        for angle, c, s in zip(x, cosines, sines, strict=False):
            exact = mp.mpf(float(angle))
            # Near a zero the last part of pi/2, of 2^-101 pi, bounds the error: far below a rounding of 1e-16.
            assert abs(mp.mpf(float(c)) - mp.cos(exact)) <= 2 * np.spacing(abs(c) + 1e-16)
            assert abs(mp.mpf(float(s)) - mp.sin(exact)) <= 2 * np.spacing(abs(s) + 1e-16)
