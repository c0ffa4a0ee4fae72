"""Logarithms: compiled and plain, against mpmath and IEEE 754, and as facts differentiate them."""

from __future__ import annotations

import mpmath as mp
import numba
import numpy as np
import pytest

from fastlink import logarithm

FUNCTIONS = {"log": mp.log, "log1p": mp.log1p, "arsinh": mp.asinh}
SPECIAL = np.array([0.0, -0.0, 1.0, np.inf, -np.inf, np.nan, -1.0, -2.0, 5e-324, 2.2e-308, 1.7e308])


def loop_over(function):
    @numba.njit(error_model="numpy")
    def compiled(x, out):
        for i in range(x.size):
            out[i] = function(x[i])

    return compiled


LOOPS = {name: loop_over(getattr(logarithm, name)) for name in FUNCTIONS}


def both_readings(name, x):
    compiled = np.empty_like(x)
    LOOPS[name](x, compiled)
    with np.errstate(over="ignore"):  # of the square that is not selected
        plain = getattr(logarithm, name)(x)
    np.testing.assert_array_equal(compiled, plain)  # NaN equals NaN here
    return compiled


def arguments(name, rng):
    """Everywhere, over all exponents, and where a logarithm loses digits if it is written naively."""
    every = np.exp(rng.uniform(-744, 709, 1500))
    if name == "log":
        steps = 1.0 + np.arange(-40, 41) * 2.0**-53
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
    np.testing.assert_allclose(got[known], expected[known], rtol=6 * 2.0**-53, atol=0.0)


def test_mpmath_reads_zero_and_below_alike():
    for function, edge in ((logarithm.log, 0), (logarithm.log1p, -1)):
        assert function(mp.mpf(edge)) == -mp.inf
        assert mp.isnan(function(mp.mpf(edge) - 1))


def test_log_scaled_reaches_beyond_the_range_of_doubles():
    rng = np.random.default_rng(6)
    with mp.workdps(40):
        for x, twos in zip(np.exp(rng.uniform(-3, 3, 300)), rng.integers(-(2**20), 2**20, 300), strict=True):
            exact = mp.log(mp.mpf(float(x))) + int(twos) * mp.ln2
            got = logarithm.log_scaled(float(x), float(twos))
            assert abs(mp.mpf(float(got)) - exact) <= 2 * np.spacing(abs(float(exact)))


def test_the_loop_vectorises_and_calls_nothing():
    (text,) = LOOPS["log"].inspect_llvm().values()
    assert " x double>" in text
    assert not [line for line in text.splitlines() if "call" in line and "@log" in line]
