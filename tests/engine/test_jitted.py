"""Functions that numba's compiled code calls: the same bits, nothing compiled twice, nothing shared."""

from concurrent.futures import ThreadPoolExecutor

import numba
import numpy as np
import pytest

import fastlink as fl

BAR = fl.round_bar(density=7750.0, radius=0.01)
FIXED = {"a1": 0.4, "a4": 1.0, "omega1": 25.0}
LENGTHS = np.random.default_rng(3).uniform(0.5, 1.5, (2, 150))
LENGTHS[:, :4] = [[1.0, np.nan, -1.0, 0.0], [0.4, 1.0, 1.0, 1.0]]
#: One design is beyond the range of numbers.
FAR = LENGTHS * np.where(np.arange(150) == 9, 2.0**100, 1.0)


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("names", "options"),
    [
        (["omega4", "status"], {"theta1": 40}),
        (["omega4_max", "shaking_force_max", "status"], {"links": BAR, "branch": (2, 1)}),
    ],
)
def test_a_jitted_function_has_the_bits_of_the_function(names, options):
    function = fl.function("planar_4r", ["a2", "a3"], names, **FIXED, **options)
    jitted = function.jitted
    together = function(LENGTHS)
    np.testing.assert_array_equal(jitted(LENGTHS), together)
    np.testing.assert_array_equal(jitted(LENGTHS[:, 7]), together[:, 7])
    np.testing.assert_array_equal(jitted(FAR), function(FAR))
    with ThreadPoolExecutor(4) as pool:
        for result in pool.map(lambda _: jitted(LENGTHS), range(40)):
            np.testing.assert_array_equal(result, together)


def test_choices_are_checked():
    function = fl.function(
        "focal", ["completion", "b"], ["status", "m", "grashof_excess"], a=5.0, c=2.0, d=4.0, rho=1.0
    )
    x = np.array([[1.0, 2.0, 9.0, 1.5], [5.0] * 4])
    np.testing.assert_array_equal(function.jitted(x), function(x))
    np.testing.assert_array_equal(np.isnan(function(x)[1]), [False, False, True, True])


def test_a_design_loop_in_numba_and_rows_that_it_has_not():
    function = fl.function("planar_4r", ["a2", "a3"], ["omega4_max", "transmission_angle_min"], **FIXED)
    evaluate = function.jitted
    with pytest.raises(ValueError, match="as many rows"):
        evaluate(np.ones(3))

    @numba.njit
    def slowest(low, high, steps):
        best = np.array([np.inf, np.nan, np.nan])
        for i in range(steps):
            for j in range(steps):
                x = low + (high - low) * np.array([i, j]) / (steps - 1)
                omega, angle = evaluate(x)
                if angle > np.radians(30.0) and omega < best[0]:
                    best[:] = omega, x[0], x[1]
        return best

    low, high = np.array([1.0, 0.6]), np.array([1.4, 1.0])
    result = slowest(low, high, 30)
    axes = [low[k] + (high[k] - low[k]) * np.arange(30) / 29 for k in (0, 1)]
    omega, angle = function(np.array(np.meshgrid(*axes, indexing="ij")))
    assert result[0] == omega[angle > np.radians(30.0)].min()
