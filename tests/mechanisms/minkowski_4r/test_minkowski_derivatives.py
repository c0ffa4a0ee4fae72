"""Derivatives of the Minkowskian 4R that have names of their own."""

from __future__ import annotations

import numpy as np

import fastlink as fl


def test_the_derivative_of_psi_by_theta_is_the_transmission_ratio():
    one = {"a": 0.7, "b": 1.3, "g": 1.9, "h": 0.4, "theta": np.array([-5.0, 1.7, 60.0])}
    found = fl.evaluate(
        "minkowski_4r", ["d_psi_d_theta", "dpsi_dtheta", "d_dpsi_dtheta_d_theta", "d2psi_dtheta2"], **one
    )
    np.testing.assert_array_equal(found["d_psi_d_theta"], found["dpsi_dtheta"])
    np.testing.assert_array_equal(found["d_dpsi_dtheta_d_theta"], found["d2psi_dtheta2"])
