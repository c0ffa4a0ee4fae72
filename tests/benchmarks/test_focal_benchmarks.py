"""C and NumPy do the arithmetic of the kernels that they are timed against."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks import c_kernel, engine, focal, in_c, in_numpy, inputs
from fastlink.numerics.compensated import UNIT_ROUNDING

N, K = 70, 64  # designs of two blocks; the kernels are those of the benchmark


@pytest.mark.sample(2)
@pytest.mark.parametrize("case", focal.CASES, ids=lambda case: case.title)
@pytest.mark.parametrize("other", [in_c, in_numpy])
def test_the_same_bits(case, other):
    if other is in_c and not c_kernel.available():
        pytest.skip("the C kernels need gcc, which is not here")
    bound = focal.bind(case, N, K)
    call, arrays = other.bind(bound)
    call()
    assert np.mean(np.isfinite(bound.arrays[0])) > 0.4  # rockers do not turn fully
    for ours, theirs in zip(bound.arrays, arrays, strict=True):
        np.testing.assert_array_equal(theirs, ours)


@pytest.mark.parametrize("case", ["rates", "extremes"])
def test_curves_and_extremes_have_the_same_bits_in_c(case):
    if not c_kernel.available():
        pytest.skip("the C kernels need gcc, which is not here")
    program = engine.program_of(case, K)
    bound = engine.bind_results(program, inputs.INPUTS, inputs.designs(N), engine.angles(K))
    call, arrays = in_c.bind(bound)
    call()
    for ours, theirs in zip(bound.arrays, arrays, strict=True):
        np.testing.assert_array_equal(theirs, ours)


def test_the_quadratic_as_it_stands_agrees_where_it_does_not_cancel():
    n = 1000
    bound = focal.bind(focal.CASES[0], n, K)
    x = focal.four_bars(n)
    a, b, c, d, rho, _ = x
    W = (1 + rho) * (a**2 + rho * b**2) / rho
    half = (W - c**2 - d**2) / 2
    # The difference under the root has 8 roundings of W^2: with half^2 at most 100 times as large, and W at most 10
    # times, the root loses 4 * 100 * 100 roundings of its own size. What follows multiplies and divides a few times.
    sound = (half**2 < 100 * (half**2 - (c * d) ** 2)) & (abs(W) < 10 * abs(half))
    assert sound.mean() > 0.5
    for ours, theirs in zip(bound.arrays, focal.quadratic(x), strict=False):
        np.testing.assert_allclose(theirs[sound], ours[sound], rtol=5e4 * UNIT_ROUNDING)
