"""The baselines of the Minkowskian 4R agree with the engine, so that what is timed is the same."""

from __future__ import annotations

import math

import numpy as np
from benchmarks import minkowski

from configurations import UNIT


def test_numpy_has_the_same_roots():
    x, theta = minkowski.designs(40), np.linspace(-4.0, 4.0, 57)
    _, (psi, orientation) = minkowski.bind(minkowski.PSI, x, theta)
    out = np.empty_like(psi), np.empty_like(orientation)
    tables = minkowski.angle_tables(minkowski.MINKOWSKI, minkowski.TABLES, theta)
    minkowski.null_form(minkowski.constants(x), tables, out)
    # The same operations but for the logarithm, of 2 units in the last place and one.
    np.testing.assert_allclose(out[0], psi, rtol=8 * UNIT, atol=8 * UNIT)
    np.testing.assert_array_equal(out[1], orientation)
    by_eq3, sign = minkowski.eq3(x, theta)
    np.testing.assert_array_equal(np.isnan(by_eq3), np.isnan(psi))
    np.testing.assert_array_equal(np.nan_to_num(sign), orientation)
    # Of 16 digits eq. (3) loses those of e^(psi + theta): four at most here.
    np.testing.assert_allclose(by_eq3, psi, rtol=0, atol=1e-10)


def test_errors_are_measured():
    families = {name: (own, by_eq3) for name, own, by_eq3 in minkowski.errors(4)}
    assert len(families) == len(minkowski.families(1))
    assert max(own for own, _ in families.values()) <= 4.0
    # Where cosh overflows there is no value.
    assert families["theta 400 ... 700"][1] == math.inf
    # The measure tells a wrong value.
    x, theta = minkowski.families(4)["any"]
    assert minkowski.worst(minkowski.ours(x, theta) + 1e-12, x, theta) > 100.0


def test_facts_are_positive_numbers():
    found = minkowski.measure(quick=True)
    assert all(math.isfinite(value) and value > 0 for _, value, _, _ in found)
