"""Values, error bounds and extremes against a reference that shares no formula with them: the loops themselves.

Designs are drawn from all that is legal and from the neighbourhoods of every degenerate set. No value is beyond its
bound, no number is finite where there is none, no value exceeds the greatest of its cycle. An infinite bound claims
nothing.
"""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.against_loops import HEADER, Tally, campaign, count
from tests.support.neighbourhoods import DRAWN

#: Designs of each mechanism, of all its inputs together, in the long form: half an hour of one core each.
MANY = 1_000_000
#: In each run a few, by some inputs.
FEW = 40
QUICK = [("planar_4r", "theta1"), ("slider_crank", "theta"), ("minkowski_4r", "theta"), ("focal", "sigma")]
QUICK += [("hart", "phi"), ("planar_4r", "joint_angle_3")]


@pytest.mark.parametrize(("mechanism", "drive"), QUICK)
def test_some_designs(mechanism, drive):
    tally = campaign(mechanism, drive, FEW, extremes=False)
    assert tally.failures == {}
    # more than a few values of each design, where it assembles or does not
    assert tally.counts["values"] > 5 * FEW


@pytest.mark.stress
@pytest.mark.parametrize("mechanism", dict.fromkeys(mechanism for mechanism, _ in DRAWN))
def test_a_million_designs(mechanism, tell):
    drives = [drive for of, drive in DRAWN if of == mechanism]
    tallies = []
    for drive in drives:
        tallies.append(campaign(mechanism, drive, MANY // len(drives)))
    tell("\n".join([HEADER, *(tally.row() for tally in tallies)]))
    assert [tally.report() for tally in tallies if tally.failures] == []
    assert sum(tally.counts["values"] for tally in tallies) > 10 * MANY


def test_a_value_beyond_its_bound_and_one_where_there_is_none_are_failures():
    """One value is right, one is off by more than its bound, one is off but flagged, one belongs to an open loop."""
    tally = Tally("planar_4r", "theta1")
    values, bounds = np.array([[1.0], [1.5], [1.5], [2.0]]), np.array([[0.1], [0.1], [np.inf], [0.1]])
    exact, kinds = np.array([[1.05], [1.0], [1.0], [np.nan]]), np.array([[0], [0], [0], [1]])
    errors, radius = abs(values - exact), np.zeros((4, 1))
    count(
        tally,
        ["right", "off", "flagged", "open"],
        [{"a1": 1.0}],
        values,
        bounds,
        errors,
        radius,
        kinds,
        exact,
    )
    assert set(tally.failures) == {("beyond", "off"), ("finite where none", "open")}
    assert tally.counts["flagged"] == 1
    assert tally.worst == (pytest.approx(0.5), "right")
