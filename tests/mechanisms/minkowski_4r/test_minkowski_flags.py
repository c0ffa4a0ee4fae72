"""The Minkowskian 4R at adversarial lengths, rapidities and coupler points: right, or flagged, never a quiet NaN."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
from tests.support.configurations import condition_sums, reference
from tests.support.minkowski_configurations import adversarial

import fastlink as fl
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING

MINKOWSKI = catalogue("minkowski_4r")
ALL = [name for name in MINKOWSKI.public if MINKOWSKI.varies(name)]
#: What tells why a quantity is not a finite number, if it is not `configuration_status`.
FLAGS = {
    **dict.fromkeys(("X_x", "X_y", "sextic_residual"), "coupler_point_status"),
    **dict.fromkeys(("dpsi_dtheta", "d2psi_dtheta2"), "rates_status"),
    **dict.fromkeys(("psi_remark", "delta"), "remark_status"),
    **dict.fromkeys(("lambda_AX", "mu_BX"), "coupler_angles_status"),
}
#: Of degree 2 and linear in ch(theta): they are infinite where they are greater than any double, never NaN.
COEFFICIENTS = ("coefficient_A", "coefficient_B", "coefficient_C")
COORDINATES = ("A_x", "A_y", "B_x", "B_y", "X_x", "X_y")
BRANCHES = np.array([[1], [2]])
#: In roundings times condition, as in test_minkowski_4r.py.
MULTIPLE = 4


def beyond_the_doubles(names, inputs):
    """Tell which values of lengths are greater than any double: they are even where the longest link is near 1."""
    power = np.frexp(np.max([inputs[name] for name in "abgh"], axis=0))[1]
    near_1 = {name: value if name == "theta" else np.ldexp(value, -power) for name, value in inputs.items()}
    found = fl.evaluate("minkowski_4r", names, branch=BRANCHES, allow_invalid=True, **near_1)
    with np.errstate(over="ignore"):
        infinite = {name: np.isinf(np.ldexp(found[name], power)) for name in names}
    return {name: infinite[name] & (np.isfinite(found[name]) | (power >= 0)) for name in names}


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.stress)])
def test_what_is_no_finite_number_has_a_flag(seed):
    inputs = adversarial(np.random.default_rng(seed), 20000 * seed**4)
    inputs["a"][0] = -1.0
    inputs |= {name: np.append(values, np.ones(9)) for name, values in inputs.items()}
    for k, name in enumerate("abgh"):  # a length below 3e-39 of the longest
        inputs[name][-9:] = np.roll([1e-20, 1e20, 2e20, 1e20], k)[np.arange(9) % 4]
    inputs["theta"][-9:] = np.linspace(1.0, 90.0, 9)
    found = fl.evaluate("minkowski_4r", ALL, branch=BRANCHES, allow_invalid=True, **inputs)
    beyond = beyond_the_doubles(COORDINATES, inputs)
    for name in ALL:
        missing = ~np.isfinite(found[name])
        if name in COEFFICIENTS:
            missing = np.isnan(found[name])
        if name in beyond:
            missing &= ~(np.isinf(found[name]) & beyond[name])
        assert (found[FLAGS.get(name, "configuration_status")][missing] != 0).all(), name
    # Each flag is met, but for both roots' exceptions at once, and none is there without a cause.
    for name in ("configuration_status", *dict.fromkeys(FLAGS.values())):
        met = set(np.unique(found[name]).astype(int))
        assert met | {9} >= set(MINKOWSKI.public[name].flags)
        told = [of for of in ALL if FLAGS.get(of, "configuration_status") == name]
        missing = np.any([~np.isfinite(found[of]) for of in told], axis=0)
        if name == "configuration_status":
            missing |= found[name] == 4  # at a limit, where the rates are infinite
        assert (missing[found[name] != 0]).all(), name


def test_what_each_flag_of_a_closed_loop_says_is_so():
    inputs = adversarial(np.random.default_rng(3), 20000)
    found = fl.evaluate("minkowski_4r", ALL, branch=BRANCHES, allow_invalid=True, **inputs)
    code = found["configuration_status"]
    angles = ("psi", "AB_rapidity", "phi", "A_x", "A_y", "B_x", "B_y", "cosh_zeta", "loop_residual")
    beyond = dict.fromkeys(angles, np.zeros(code.shape, dtype=bool)) | beyond_the_doubles(COORDINATES, inputs)
    for closes in (0, 7, 8, 9):
        for name in angles:
            assert (np.isfinite(found[name]) | beyond[name])[code == closes].all(), name
    inside = (code == 7) | (code == 9)
    np.testing.assert_array_equal(
        np.isnan(found["zeta"][(code == 0) | (code >= 7)]), inside[(code == 0) | (code >= 7)]
    )
    assert (found["cosh_zeta"][inside] <= -1.0).all()
    assert (found["half_angle_root"][(code == 8) | (code == 9)] == np.inf).all()


@pytest.mark.parametrize("n", [60, pytest.param(1500, marks=pytest.mark.stress)])
def test_what_has_no_flag_is_right(n):
    inputs = adversarial(np.random.default_rng(7), n)
    names = [name for name in ALL if not MINKOWSKI.public[name].flags and "residual" not in name]
    found = fl.evaluate(
        "minkowski_4r", [*names, *set(FLAGS.values())], branch=BRANCHES, allow_invalid=True, **inputs
    )
    tested = 0
    for i in range(n):
        for k in (0, 1):
            one = {name: float(values[i]) for name, values in inputs.items()} | {"branch": k + 1}
            here = [name for name in names if np.isfinite(found[name][k, i])]
            # A power of two of the lengths too many and the reference itself underflows.
            if not here or abs(one["theta"]) > 1e5 or not all(np.isfinite([*one.values()])):
                continue
            true = reference(here, one, catalogue=MINKOWSKI)
            sums = condition_sums(here, one, catalogue=MINKOWSKI)
            for name in here:
                if mp.isnan(sums[name]):  # an end of what closes: no neighbour to measure by
                    continue
                # Rates that fall like e^-|theta| underflow where they are below 1e-200.
                bound = MULTIPLE * UNIT_ROUNDING * (sums[name] + abs(true[name])) + (
                    1e-200 if name in FLAGS else 0.0
                )
                bound += 2.0**-1074 if name in COEFFICIENTS else 0.0  # products of two lengths underflow
                error = abs(mp.mpf(float(found[name][k, i])) - true[name])
                assert error <= bound, (name, one, float(found[name][k, i]), true[name])
                tested += 1
    assert tested > 5 * n
