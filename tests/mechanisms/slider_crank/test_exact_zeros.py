"""A force that is exactly 0 at a sample of a search: its slope is no number there, and yet it is least."""

from __future__ import annotations

import numpy as np

import fastlink as fl

#: r = l + e but for 1e-15: F41 nearly has a pole at pi/2, and both its zeros stand in the middle of the graded range.
DESIGN = {
    "r": 1.048245833941114,
    "l": 2.8151436694020036,
    "e": -1.7668978354608884,
    "G1_u": 0.35166168617373966,
    "G1_v": 4.174227550120641,
    "G2_u": 2.8151436694020036,
    "G2_v": -0.002658583659505936,
    "m1": 0.0,
    "I1": 1.4162467717588534e-09,
    "m2": 0.0,
    "I2": 6.210836172235572e-05,
    "m3": 0.0,
    "omega": -1.0,
}


def test_a_zero_at_a_sample_is_the_least_value():
    names = ["F41_min", "F41_min_error", "F41_extrema", "F41_extrema_error"]
    maps = fl.sweep("slider_crank", fl.grid(**DESIGN), names, branch=2)
    # only I2 acts, so F41 is in proportion to alpha2 and changes its sign with it
    theta = np.linspace(np.pi / 2 - 1e-3, np.pi / 2 - 1e-4, 100)
    alpha2 = fl.evaluate("slider_crank", ["alpha2"], branch=2, theta=theta, **DESIGN)["alpha2"]
    assert alpha2.min() < 0.0 < alpha2.max()
    assert float(maps.F41_min) <= float(maps.F41_min_error)
    # and so it does on the other side: two zeros, two maxima
    kinds = maps.F41_extrema_kind.values[:4]
    np.testing.assert_array_equal(kinds, [-1, 1, -1, 1])
    zeros = maps.F41_extrema.values[:4][kinds < 0]
    assert np.all(zeros <= maps.F41_extrema_error.values[:4][kinds < 0])
