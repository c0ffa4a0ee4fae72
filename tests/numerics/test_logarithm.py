"""Logarithms: compiled and plain, against mpmath and IEEE 754, and as facts differentiate them."""

import itertools
import re

import mpmath as mp
import numpy as np
import pytest
from tests.support.compiled import Compiled

from fastlink.numerics import logarithm
from fastlink.numerics.compensated import UNIT_ROUNDING

FUNCTIONS = {"log": mp.log, "log1p": mp.log1p, "arsinh": mp.asinh}
SPECIAL = np.array([0.0, -0.0, 1.0, np.inf, -np.inf, np.nan, -1.0, -2.0, 5e-324, 2.2e-308, 1.7e308])


COMPILED = Compiled(logarithm, *(f"{name}(a)" for name in FUNCTIONS))
QUOTIENTS = Compiled(logarithm, "log_quotient(a, b, c)", "quotient_sign(a, b)")


def both_readings(name, x):
    compiled = COMPILED(x)[list(FUNCTIONS).index(name)]
    with np.errstate(over="ignore"):  # of the square that is not selected
        plain = getattr(logarithm, name)(x)
    np.testing.assert_array_equal(compiled, plain)  # NaN equals NaN here
    return compiled


def arguments(name, rng):
    """Everywhere, over all exponents, and where a logarithm loses digits if it is written naively."""
    every = np.exp(rng.uniform(-744, 709, 1500))
    if name == "log":
        steps = 1.0 + np.arange(-40, 41) * UNIT_ROUNDING
        return np.concatenate([rng.uniform(0.5, 2.0, 3000), 1.0 + rng.normal(0.0, 1e-5, 1000), steps, every])
    near = rng.uniform(0.0, 3.0, 3000), np.exp(rng.uniform(-50, 0, 1000))
    if name == "arsinh":
        return np.concatenate([*near, every])
    joints = rng.uniform(-0.32, -0.27, 500), rng.uniform(0.40, 0.43, 500)
    return np.concatenate([*near, *joints, -np.exp(rng.uniform(-744, -1e-6, 1500)), every])


@pytest.mark.parametrize(("name", "units"), [("log", 2), ("log1p", 2), ("arsinh", 3)])
def test_within_a_few_units_in_the_last_place(name, units):
    x = arguments(name, np.random.default_rng(5))
    got = both_readings(name, x)
    with mp.workdps(40):
        for argument, value in zip(x, got, strict=True):
            exact = FUNCTIONS[name](mp.mpf(float(argument)))
            # spacing(|exact|) is a unit in the last place; log of 1 is exact.
            assert abs(mp.mpf(float(value)) - exact) <= units * np.spacing(abs(float(exact)))


@pytest.mark.parametrize(("name", "library"), [("log", np.log), ("log1p", np.log1p)])
def test_special_values_are_those_of_ieee(name, library):
    with np.errstate(all="ignore"):
        expected = library(SPECIAL)
    got = both_readings(name, SPECIAL)
    np.testing.assert_array_equal(np.isnan(got), np.isnan(expected))
    known = ~np.isnan(expected)
    np.testing.assert_array_equal(np.signbit(got[known]), np.signbit(expected[known]))
    # 2 units of ours and 1 of the library's.
    np.testing.assert_allclose(got[known], expected[known], rtol=6 * UNIT_ROUNDING, atol=0.0)


def test_mpmath_reads_zero_and_below_alike():
    for function, edge in ((logarithm.log, 0), (logarithm.log1p, -1)):
        assert function(mp.mpf(edge)) == -mp.inf
        assert mp.isnan(function(mp.mpf(edge) - 1))


def both_quotients(x, y, twos):
    logs, signs = QUOTIENTS(x, y, twos)
    np.testing.assert_array_equal(logs, logarithm.log_quotient(x, y, twos))
    np.testing.assert_array_equal(signs, logarithm.quotient_sign(x, y))
    return logs, signs


def test_the_logarithm_of_a_quotient_is_within_three_units_in_the_last_place():
    """Near 1, near the change of the power of two, over all exponents, and beyond the range of doubles."""
    rng = np.random.default_rng(6)
    near = 1.0 + rng.normal(0.0, 1e-9, 1000)
    x = np.concatenate([near, rng.uniform(0.5, 2.0, 3000), 2.0 ** rng.uniform(-1020.0, 1021.0, 1000)])
    y = np.concatenate(
        [rng.permutation(near), rng.uniform(0.5, 2.0, 3000), 2.0 ** rng.uniform(-1020.0, 1021.0, 1000)]
    )
    x *= rng.choice([-1.0, 1.0], x.size)
    twos = np.where(rng.random(x.size) < 0.3, rng.integers(-(2**20), 2**20, x.size), 0) * 1.0
    logs, signs = both_quotients(x, y, twos)
    np.testing.assert_array_equal(signs, np.sign(x))
    with mp.workdps(40):
        for a, b, k, value in zip(x, y, twos, logs, strict=True):
            exact = mp.log(abs(mp.mpf(float(a)) / mp.mpf(float(b)))) + int(k) * mp.ln2
            assert abs(mp.mpf(float(value)) - exact) <= 3 * np.spacing(abs(float(exact)))
            assert logarithm.log_quotient(mp.mpf(float(a)), mp.mpf(float(b)), int(k)) == exact
            assert logarithm.quotient_sign(mp.mpf(float(a)), mp.mpf(float(b))) == mp.sign(a)


def test_a_quotient_beyond_its_range_has_no_logarithm_and_no_sign():
    inside = [2.0**-1021, -1.0, np.nextafter(2.0**1022, 0.0)]
    outside = [0.0, -0.0, np.nextafter(2.0**-1021, 0.0), 5e-324, 2.0**1022, np.inf, -np.inf, np.nan]
    for wrong, right in itertools.product(outside, inside):
        logs, signs = both_quotients(
            np.array([wrong, right, wrong]), np.array([right, wrong, wrong]), np.zeros(3)
        )
        assert np.isnan(logs).all()
        assert (signs == 0.0).all()
    logs, signs = both_quotients(
        *map(np.array, zip(*itertools.product(inside, inside), strict=True)), np.zeros(9)
    )
    assert np.isfinite(logs).all()
    assert (abs(signs) == 1.0).all()
    one = mp.mpf(1)
    for zero in ((0 * one, one), (one, 0 * one), (mp.nan, one)):
        assert mp.isnan(logarithm.log_quotient(*zero, 0))
        assert logarithm.quotient_sign(*zero) == 0


def test_every_operation_is_of_whole_vectors_and_nothing_is_called():
    lines = [line for compiled in (COMPILED, QUOTIENTS) for line in compiled.llvm().splitlines()]
    assert sum(" fmul <" in line for line in lines) > 30
    assert not [line for line in lines if re.search(r" f(add|sub|mul|div) double", line)]
    called = {name for line in lines for name in re.findall(r"call \S+ .*?@(\S+?)\(", line)}
    assert {name for name in called if not name.startswith("llvm.")} == {"kernel.0"}
