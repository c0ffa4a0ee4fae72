"""The exact count of extrema itself, against dense samples and the paper's printed figures."""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.configurations import LENGTHS
from tests.support.extrema_families import FAMILIES
from tests.support.extrema_oracle import RATES, counts, extrema

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING

DERIVATIVES = {"omega4": "alpha4", "omega2": "alpha2", "alpha4": "jerk4", "alpha2": "jerk2"}
#: Families whose extrema lie no closer to each other, and whose ranges are no narrower, than dense samples resolve.
SAMPLED = ("crank", "drag-link", "rocker input", "non-Grashof", "change-point gap", "near kite")


@pytest.mark.sample(6)
@pytest.mark.parametrize("family", SAMPLED)
@pytest.mark.parametrize("quantity", RATES)
def test_exact_counts_are_the_sign_changes_of_the_derivative(family, quantity):
    lengths = FAMILIES[family](np.random.default_rng(100 + len(family)), 25)
    # Equal steps of log tan(theta1/2), 0.01 apart from 1e-9 to 1e9: the extrema crowd towards 0 and pi.
    half = 2 * np.arctan(np.exp(np.linspace(-21, 21, 4001)))
    theta1 = np.concatenate([half, 2 * np.pi - half[::-1]])
    space = fl.table(dict(zip(LENGTHS, lengths, strict=True)) | {"omega1": 1.0})
    slope = DERIVATIVES[quantity]
    signs = np.sign(fl.sweep("planar_4r", space, [slope], theta1=theta1)[slope].values)
    changes = np.sum(signs * np.roll(signs, 1, axis=-1) < 0, axis=-1)
    exact = [counts(extrema(lengths[:, i], quantity)) for i in range(lengths.shape[1])]
    np.testing.assert_array_equal(changes, exact)


@pytest.mark.parametrize("quantity", RATES)
def test_values_and_angles_satisfy_the_facts(quantity):
    """The polynomials and the facts have no formula in common: values agree, and derivatives vanish, to rounding."""
    lengths = FAMILIES["crank"](np.random.default_rng(7), 40)
    for column in lengths.T:
        given = dict(zip(LENGTHS, column, strict=True)) | {"omega1": 1.0}
        for point in extrema(column, quantity):
            names = [quantity, DERIVATIVES[quantity]]
            found = fl.evaluate("planar_4r", names, theta1=point.theta1, branch=point.branch, **given)
            assert abs(found[quantity] - point.value) <= 8 * UNIT_ROUNDING * point.value_terms
            # A derivative of zero is off by a few roundings of its terms, and by what the angle's rounding makes.
            second = abs(point.slope_terms / point.theta1_terms)
            allowed = 8 * UNIT_ROUNDING * (point.slope_terms + 2 * np.pi * second)
            assert abs(found[DERIVATIVES[quantity]]) <= allowed


def test_table_2_of_the_paper():
    """Hayes et al., Table 2, as docs/errata.md corrects it."""
    # Printed angles are up to 1.8e-9 off (test_planar_4r.py); the text prints values to ten figures.
    for quantity, scale in (("omega4", 25.0), ("alpha4", 625.0)):
        found = extrema(np.array([0.4, 1.2, 0.8, 1.0]), quantity)
        printed = {
            "omega4": [(5.913849943, -23.95938172, -1), (1.667165012, 13.51343678, 1)],
            "alpha4": [(0.1482557001, 1062.775829, 1), (5.444944024, -462.6986574, -1)],
        }[quantity]
        mode_2 = [point for point in found if point.branch == 2]
        assert len(mode_2) == 2
        for theta1, value, kind in printed:
            (point,) = [point for point in mode_2 if point.kind == kind]
            assert abs(point.theta1 - theta1) <= 2e-9
            assert abs(point.value * scale - value) <= 5e-10 * abs(value)
