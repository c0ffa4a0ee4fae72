"""Precision of Hart's linkage: every quantity and derivative against 50 digits, near all where digits get lost."""

from __future__ import annotations

import mpmath as mp
import pytest
from tests.support.hart_configurations import (
    HART,
    INPUTS,
    QUANTITIES,
    at,
)

from fastlink.precision.reference import CONTEXT, Exact, in_roundings

#: In roundings of a double; 3.7 is the worst seen in 10^4 configurations of the families.
MULTIPLE = 4


# -- derivatives ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("by", INPUTS)
def test_every_quantity_has_its_derivative(by):
    one = {"m": 0.8, "n": 1.1, "d": 1.3, "kappa": 0.6, "phi": 1.2, "branch": 2}
    facts = Exact(HART, QUANTITIES, one)
    here, step = facts.at(one), CONTEXT.mpf(10) ** -18
    low, high = (facts.moved(here, {by: here[by] + k * step}) for k in (-1, 1))
    tested = 0
    for name in QUANTITIES:
        slope, derivative = (high[name] - low[name]) / (2 * step), f"d_{name}_d_{by}"
        if slope == 0 or mp.isnan(slope):
            continue
        found = at([derivative], **one)[derivative]
        slopes = Exact(HART, [derivative], one)
        condition = slopes.condition(slopes.at(one), INPUTS)[derivative]
        # The rule of precision; the difference quotient is right to 1e-30.
        assert in_roundings(float(found), slope, condition) <= MULTIPLE, name
        tested += 1
    assert tested >= (15 if by != "phi" else 8)
