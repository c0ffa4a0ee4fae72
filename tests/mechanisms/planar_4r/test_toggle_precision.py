"""The planar 4R near its toggles, relative to the lengths and angle as given."""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.configurations import LENGTHS, PLANAR, near_toggle

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.precision.reference import CONTEXT, HighPrecision

NAMES = ["transmission_angle", "omega2", "omega4", "alpha2", "alpha4"]


@pytest.mark.parametrize("offset", [1e-3, 1e-6, 1e-9])
def test_near_a_toggle_nothing_is_lost_though_the_condition_number_explodes(offset):
    """Relative to the lengths and angle as given, a toggle costs no digit at all."""
    n = 60
    lengths, theta = near_toggle(np.random.default_rng(24), n, offset)
    inputs = dict(zip(LENGTHS, lengths, strict=True)) | {"omega1": np.full(n, 25.0), "theta1": theta}
    found = fl.evaluate("planar_4r", NAMES, branch=2, **inputs)
    facts = HighPrecision(PLANAR, NAMES, [*inputs, "branch"])
    errors = []
    for i in range(n):
        exact = facts.at({name: values[i] for name, values in inputs.items()} | {"branch": 2})
        if not CONTEXT.isnan(exact["omega4"]):
            errors.append(
                [
                    float(abs(found[name][i] - exact[name]) / abs(exact[name])) / UNIT_ROUNDING
                    for name in NAMES
                ]
            )
    assert len(errors) > n // 2
    # Twelve operations on factors that are right to a rounding each; the naive form is off by 0.1/offset units.
    assert np.median(errors, axis=0).max() <= 4
    assert np.max(errors) <= 40
