"""Derivatives of the Minkowskian 4R that have names of their own."""

from __future__ import annotations

import numpy as np
import pytest

import fastlink as fl


def test_the_derivative_of_psi_by_theta_is_the_transmission_ratio():
    one = {"a": 0.7, "b": 1.3, "g": 1.9, "h": 0.4, "theta": np.array([-5.0, 1.7, 60.0])}
    found = fl.evaluate(
        "minkowski_4r", ["d_psi_d_theta", "dpsi_dtheta", "d_dpsi_dtheta_d_theta", "d2psi_dtheta2"], **one
    )
    np.testing.assert_array_equal(found["d_psi_d_theta"], found["dpsi_dtheta"])
    np.testing.assert_array_equal(found["d_dpsi_dtheta_d_theta"], found["d2psi_dtheta2"])


@pytest.mark.parametrize("by", "abgh")
def test_what_is_infinite_has_no_derivative(by):
    """Of branch 1 of this kite CB is past-pointing along the axis, and the root of the quadratic is infinite."""
    kite = {"a": 2.9233144391063974, "h": 2.9233144391063974, "b": 0.923320238192247, "g": 0.923320238192247}
    slope = f"d_half_angle_root_d_{by}"
    names = ["half_angle_root", slope, f"{slope}_trust"]
    root, value, trust = (
        fl.evaluate("minkowski_4r", names, branch=1, theta=-1.1524972054802625, **kite)[name]
        for name in names
    )
    assert np.isinf(root)
    assert np.isnan(value)
    assert trust == 2.0
