"""Circuits: which configurations a linkage of any class moves through without being taken apart."""

from collections import Counter

import numpy as np
import pytest
from tests.support.configurations import LENGTHS, random_lengths
from tests.support.curve_designs import apart_from_change_points
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.mechanisms import catalogue

CLASS_FLAGS = catalogue("planar_4r").facts["grashof_class"].flags


def test_a_circuit_is_a_branch_of_a_full_turn_or_both_over_one_range_of_the_angle():
    """Over a range that ends at toggles the branches meet there; apart from change points nothing else joins them."""
    lengths = random_lengths(np.random.default_rng(51), 400)
    lengths = lengths[:, apart_from_change_points(lengths)]
    space = fl.table(dict(zip(LENGTHS, lengths, strict=True)))
    names = ["grashof_class", "circuit_count", "circuit", "theta2"]
    got = sweep_4r(space, names, theta1=np.linspace(-np.pi, np.pi, 721)[:-1] + 0.003)
    circuit, closes = got.circuit.values, np.isfinite(got.theta2.values)
    np.testing.assert_array_equal(np.isfinite(circuit), closes)
    turns = closes.all(axis=(1, 2))
    assert (circuit[turns] == circuit[turns, :, :1]).all()
    assert (circuit[turns, 0] != circuit[turns, 1]).all()
    # elsewhere both branches are of one circuit, which changes from one range to the next alone
    rocking, there = circuit[~turns], closes[~turns, 0]
    np.testing.assert_array_equal(rocking[:, 0], rocking[:, 1])
    following, both = np.roll(rocking[:, 0], 1, axis=-1), there & np.roll(there, 1, axis=-1)
    np.testing.assert_array_equal(rocking[:, 0][both], following[both])
    ranges = (there & ~np.roll(there, 1, axis=-1)).sum(axis=-1)
    count = got.circuit_count.values
    # a range narrower than the distance of the angles may be missed
    seen = (ranges > 0) | (count[~turns] == 0)
    assert seen.mean() > 0.95
    np.testing.assert_array_equal(count[~turns][seen], ranges[seen])
    assert (count[turns] == 2).all()
    last = np.nanmax(np.where(there, rocking[:, 0], 0.0), axis=-1)
    np.testing.assert_array_equal(last[seen], ranges[seen])
    kinds = Counter(CLASS_FLAGS[int(code)] for code in got.grashof_class.values)
    assert len(kinds) == 9
    assert min(kinds.values()) >= 4


@pytest.mark.parametrize(
    ("lengths", "count"),
    [
        ((0.4, 1.2, 0.8, 1.0), 2),  # crank-rocker
        ((1.2, 0.4, 0.8, 1.0), 2),  # its coupler is the shortest
        ((1.0, 1.0, 1.0, 2.5), 1),
        ((1.0, 4.0, 2.0, 5.0), 1),  # a change point
        ((1.0, 3.0, 1.0, 3.0), 1),  # parallelogram
        ((1.0, 1.0, 1.0, 1.0), 1),
        ((1.0, 1.0, 1.0, 3.0), 1),  # stretched: one configuration
        ((1.0, 1.0, 1.0, 3.5), 0),
        ((1.0, -1.0, 1.0, 1.0), np.nan),
    ],
)
def test_counts(lengths, count):
    given = dict(zip(LENGTHS, lengths, strict=True))
    names, modes = ["circuit_count", "circuit"], [[1], [2]]
    got = fl.evaluate(
        "planar_4r",
        names,
        branch=modes,
        theta1=np.linspace(-np.pi, np.pi, 37)[:-1] + 0.03,
        allow_invalid=True,
        **given,
    )
    np.testing.assert_array_equal(got["circuit_count"], count)
    assert set(got["circuit"][np.isfinite(got["circuit"])]) <= {1.0, 2.0}
    assert np.all((got["circuit"] == 1) | np.isnan(got["circuit"])) or count == 2
