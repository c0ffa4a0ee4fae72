"""Derivatives of the Minkowskian 4R: every quantity by every input and by theta, against 50-digit differences."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
from tests.support.configurations import DIGITS, UNIT, condition_sums

import fastlink as fl
from fastlink.engine.evaluate import read_facts
from fastlink.mechanisms import catalogue
from fastlink.symbolic.derivative import NoDerivative

MINKOWSKI = catalogue("minkowski_4r")
QUANTITIES = [name for name, fact in MINKOWSKI.public.items() if not fact.flags and "residual" not in name]


@pytest.mark.parametrize("by", [*"abghxy", "theta"])
def test_every_quantity_has_its_derivative(by):
    rng = np.random.default_rng(11)
    tested = 0
    for branch in (1, 2, 1, 2):
        one = {name: float(rng.uniform(0.3, 2.0)) for name in "abghxy"}
        one |= {"theta": float(rng.uniform(-3.0, 3.0)), "branch": branch}
        with mp.workdps(DIGITS):
            values, step = {name: mp.mpf(value) for name, value in one.items()}, mp.mpf(10) ** -18
            before, after = (
                read_facts(MINKOWSKI, QUANTITIES, values | {by: values[by] + k * step}) for k in (-1, 1)
            )
            slopes = {name: (after[name] - before[name]) / (2 * step) for name in QUANTITIES}
        for name, slope in slopes.items():
            derivative = f"d_{name}_d_{by}"
            try:
                found = fl.evaluate("minkowski_4r", [derivative], **one)[derivative]
            except NoDerivative:
                assert slope == 0 or mp.isnan(slope)
                continue
            assert np.isnan(found) == mp.isnan(slope)
            if not np.isnan(found):
                # The rule of precision; the difference quotient is right to 1e-18 of third derivatives.
                sums = condition_sums([derivative], one, catalogue=MINKOWSKI)
                assert abs(mp.mpf(float(found)) - slope) <= 4 * UNIT * (sums[derivative] + abs(slope)), name
                tested += 1
    assert tested >= 8


def test_the_derivative_of_psi_by_theta_is_the_transmission_ratio():
    one = {"a": 0.7, "b": 1.3, "g": 1.9, "h": 0.4, "theta": np.array([-5.0, 1.7, 60.0])}
    found = fl.evaluate(
        "minkowski_4r", ["d_psi_d_theta", "dpsi_dtheta", "d_dpsi_dtheta_d_theta", "d2psi_dtheta2"], **one
    )
    np.testing.assert_array_equal(found["d_psi_d_theta"], found["dpsi_dtheta"])
    np.testing.assert_array_equal(found["d_dpsi_dtheta_d_theta"], found["d2psi_dtheta2"])
