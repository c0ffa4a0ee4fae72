"""The rules that extrema obey, by the million: alternation along each range, parity, mirror, counts by class."""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.extrema_families import FAMILIES, found
from tests.support.extrema_oracle import RATES
from tests.support.extrema_rules import TURN, broken, padded, zeros

#: Designs at a time: what the sweep returns then fits into the memory of a small machine.
CHUNK = 50_000
#: How many extrema there are per branch (both branches together, where the input does not turn fully): theorems for
#: omega (each ratio is met at most three times on the curve), exact counts of 10^4 designs for alpha.
COUNTS = {
    ("crank", "omega"): {4},
    ("drag-link", "omega"): {4},
    ("crank", "alpha"): {4, 8},
    ("drag-link", "alpha"): {4, 8},
    ("rocker input", "omega"): {0, 4},
    ("rocker input", "alpha"): {0, 4, 8},
    ("non-Grashof", "omega"): {0, 4},
    ("non-Grashof", "alpha"): {2, 6, 10},
}


@pytest.mark.sample(8)
@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("quantity", RATES)
def test_the_exact_extrema_obey_the_rules_and_the_rules_notice_a_loss(family, quantity):
    lengths = FAMILIES[family](np.random.default_rng(50 + len(family)), 25)
    _, theta1, _, kind = padded(lengths, quantity)
    assert not np.any(broken(lengths, quantity, theta1, kind))
    # Without its first extremum a branch breaks the rule, wherever it has one.
    present = kind[:, :, 0] != 0
    theta1[:, :, 0], kind[:, :, 0] = np.nan, 0
    np.testing.assert_array_equal(broken(lengths, quantity, theta1, kind), present)


@pytest.mark.sample(4)
@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("link", "24")
def test_an_acceleration_is_zero_where_the_rate_has_its_exact_extrema(family, link):
    lengths = FAMILIES[family](np.random.default_rng(70 + len(family)), 25)
    value, theta1, _, _ = padded(lengths, f"alpha{link}")
    _, _, count, _ = padded(lengths, f"omega{link}")
    np.testing.assert_array_equal(zeros(lengths, f"alpha{link}", theta1, value), count)


@pytest.mark.sample(2)
@pytest.mark.parametrize("n", [20_000, pytest.param(1_000_000, marks=pytest.mark.stress)])
@pytest.mark.parametrize("family", FAMILIES)
def test_no_design_breaks_a_rule(family, n):
    rng = np.random.default_rng(n + len(family))
    for _ in range(0, n, CHUNK):
        lengths = FAMILIES[family](rng, min(n, CHUNK))
        for quantity, (value, theta1, count, kind) in found(lengths, RATES).items():
            about = f"{family}, {quantity}"
            assert not np.any(broken(lengths, quantity, theta1, kind)), about
            there = np.arange(kind.shape[2]) < count[:, :, None]
            np.testing.assert_array_equal(kind != 0, there)
            np.testing.assert_array_equal(np.isfinite(value), there)
            np.testing.assert_array_equal(np.isfinite(theta1), there)
            assert not np.any(np.diff(theta1, axis=2) < 0), about
            # The double next to 2 pi is below it, and what is nearest to an angle just short of the turn.
            assert np.all((theta1 >= 0) & (theta1 <= TURN) | ~there), about
            # The mirror: what branch 1 does at theta1, branch 2 does at -theta1.
            np.testing.assert_array_equal(count[:, 0], count[:, 1])
            allowed = COUNTS.get((family, quantity[:-1]))
            if allowed is not None:
                assert set(np.unique(count.sum(axis=1))) <= allowed, about


@pytest.mark.sample(2)
@pytest.mark.parametrize("n", [20_000, pytest.param(1_000_000, marks=pytest.mark.stress)])
@pytest.mark.parametrize("family", FAMILIES)
def test_an_acceleration_is_zero_where_its_rate_has_extrema(family, n):
    """A maximum and a minimum of a rate that are both lost break no rule of that rate: its acceleration tells."""
    rng = np.random.default_rng(n + len(family))
    for _ in range(0, n, CHUNK):
        lengths = FAMILIES[family](rng, min(n, CHUNK))
        engine = found(lengths, RATES)
        for link in "24":
            value, theta1, _, _ = engine[f"alpha{link}"]
            crossings = zeros(lengths, f"alpha{link}", theta1, value)
            np.testing.assert_array_equal(crossings, engine[f"omega{link}"][2], f"{family}, link {link}")
