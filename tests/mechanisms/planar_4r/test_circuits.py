"""Circuits: linkages of every class are moved along their configuration curve to see what they reach."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from tests.support.configurations import LENGTHS, random_lengths
from tests.support.curve_designs import ANGLES, apart_from_change_points, motions

import fastlink as fl
from fastlink.mechanisms import catalogue

CLASS_FLAGS = catalogue("planar_4r").facts["grashof_class"].flags


def test_a_moved_linkage_reaches_its_circuit_and_no_other():
    lengths = random_lengths(np.random.default_rng(51), 400)
    # At a change point two circuits touch; a gap g parts them by about sqrt(g/length), here 0.2 rad, ten steps.
    lengths = lengths[:, apart_from_change_points(lengths)]
    space = fl.table(dict(zip(LENGTHS, lengths, strict=True)))
    got = fl.sweep("planar_4r", space, ["grashof_class", "circuit_count", "circuit", "theta2"], theta1=ANGLES)
    circuit = got.circuit.values
    np.testing.assert_array_equal(np.isfinite(circuit), np.isfinite(got.theta2.values))
    count = np.zeros(lengths.shape[1])
    for i, _path, reached in motions(lengths):
        (own,) = np.unique(circuit[i][reached])
        np.testing.assert_array_equal(reached, circuit[i] == own, err_msg=str(lengths[:, i]))
        count[i] += 1
    names = [CLASS_FLAGS[int(code)] for code in got.grashof_class.values]
    # A range narrower than the distance of the angles may be missed.
    asked = (count > 0) | (np.array(names) == "never_assembles")
    np.testing.assert_array_equal(count[asked], got.circuit_count.values[asked])
    assert asked.mean() > 0.95
    seen = Counter(names)
    assert len(seen) == 9
    assert min(seen.values()) >= 4


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
    got = fl.evaluate("planar_4r", names, branch=modes, theta1=ANGLES, allow_invalid=True, **given)
    np.testing.assert_array_equal(got["circuit_count"], count)
    assert set(got["circuit"][np.isfinite(got["circuit"])]) <= {1.0, 2.0}
    assert np.all((got["circuit"] == 1) | np.isnan(got["circuit"])) or count == 2
