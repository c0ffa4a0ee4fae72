"""Rapidities of any size: the loop closes as it does near them, and psi follows theta by a constant."""

from __future__ import annotations

import contextlib

import numpy as np
import pytest

import fastlink as fl
from fastlink.mechanisms import catalogue
from fastlink.precision.reference import CONTEXT, HighPrecision

DESIGN = {"a": 1.0, "b": 2.0, "g": 0.5, "h": 3.0}
NAMES = ("psi", "AB_rapidity", "dpsi_dtheta", "CB_orientation")
FLAGS = catalogue("minkowski_4r").public["configuration_status"].flags


@pytest.mark.parametrize("size", [1e3, 1e20, 1e42, 1e100, 1e300, 1e308])
@pytest.mark.parametrize("branch", [1, 2])
def test_the_loop_closes_at_any_rapidity(size, branch):
    names = (*NAMES, "configuration_status")
    for sign in (-1.0, 1.0):
        near = fl.evaluate("minkowski_4r", names, **DESIGN, theta=sign * 300.0, branch=branch)
        far = fl.evaluate("minkowski_4r", names, **DESIGN, theta=sign * size, branch=branch)
        assert FLAGS[int(far["configuration_status"])] == "beyond_the_range_of_numbers"  # as e^1000 is
        assert far["CB_orientation"] == near["CB_orientation"]
        assert abs(far["dpsi_dtheta"] - near["dpsi_dtheta"]) <= np.exp(-290.0)
        # beyond 300, e^-theta is nothing beside 1: a rapidity is a constant, or theta and a constant
        for name in NAMES[:2]:
            slope = np.rint(near[name] / (sign * 300.0))
            shift = near[name] - slope * sign * 300.0
            expected = slope * sign * size + shift
            # two roundings of 300 near, and three of the value, one of which is that of k log(2)
            assert abs(far[name] - expected) <= 2.0**-52 * 300.0 + 3 * 2.0**-53 * abs(expected)


@pytest.mark.parametrize("theta", [1e20, -1e100, 1e300])
def test_the_reference_closes_there_too(theta):
    mechanism = catalogue("minkowski_4r")
    found = fl.evaluate("minkowski_4r", ["psi"], **DESIGN, theta=theta)["psi"]
    exact = HighPrecision(mechanism, ["psi"], {**DESIGN, "theta": theta, "branch": 1.0})
    known = exact.at({**DESIGN, "theta": theta, "branch": 1.0})
    assert abs(CONTEXT.mpf(found) - known["psi"]) <= 4 * 2.0**-53 * abs(known["psi"])


def derivatives():
    """Return the derivatives of the psi, points and angles by every input."""
    mechanism = catalogue("minkowski_4r")
    names = ("psi", "AB_rapidity", "phi", "zeta", "dpsi_dtheta", "B_x", "B_y", "X_x", "X_y", "A_x")
    for name in names:
        for by in "abghxy":
            with contextlib.suppress(fl.InputError):
                mechanism.resolve(derivative := f"d_{name}_d_{by}")
                yield derivative


@pytest.mark.parametrize("n", [6, pytest.param(200, marks=pytest.mark.stress)])
def test_derivatives_hold_their_bounds_far_out(n):
    """Beyond 354, e^-theta times 2^-500 is subnormal: half of them were off by up to a factor of 2."""
    rng = np.random.default_rng(n)
    lengths = dict(zip("abgh", rng.uniform(0.3, 2.0, (4, n)), strict=True))
    theta = rng.choice([-1.0, 1.0], n) * np.linspace(345.0, 640.0, n)
    assert within_bounds(lengths | {"theta": theta}, rng) > 10 * n


@pytest.mark.parametrize("short", ["a", "g", "abgh"])
def test_derivatives_hold_their_bounds_where_links_are_short(short):
    """They are as great as the inverse of a length, which products with 2^1000 on the way have made infinite."""
    rng, n = np.random.default_rng(5), 8
    lengths = dict(zip("abgh", rng.uniform(0.3, 2.0, (4, n)), strict=True))
    for name in short:
        lengths[name] = lengths[name] * 2.0**-70
    theta = rng.choice([-1.0, 1.0], n) * rng.uniform(1.0, 4.0, n)
    if short != "abgh":  # AC is bent enough where e^theta makes up for the short link
        theta += np.copysign(50.0, theta)
    assert within_bounds(lengths | {"theta": theta}, rng) > 10 * n


def within_bounds(inputs, rng):
    """Compare all derivatives with 50 digits and their bounds; return how many have digits."""
    names, n = list(derivatives()), len(inputs["theta"])
    assert len(names) > 30
    inputs = inputs | {"x": rng.uniform(-2, 2, n), "y": rng.uniform(-2, 2, n)}
    branch = rng.integers(1, 3, n).astype(float)
    found = fl.evaluate("minkowski_4r", [*names, *(f"{one}_error" for one in names)], branch=branch, **inputs)
    exact = HighPrecision(catalogue("minkowski_4r"), names, [*inputs, "branch"])
    tested = 0
    for i in range(n):
        true = exact.at({name: values[i] for name, values in inputs.items()} | {"branch": branch[i]})
        for name in names:
            if CONTEXT.isnan(true[name]) or abs(true[name]) < 1e-290:  # bounds do not count underflow
                continue
            bound = found[f"{name}_error"][i]
            assert np.isfinite(found[name][i]), (name, i)
            assert abs(CONTEXT.mpf(found[name][i]) - true[name]) <= bound, (name, i)
            tested += bound < 1e-12 * abs(found[name][i])
    return tested
