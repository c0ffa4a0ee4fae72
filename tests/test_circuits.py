"""Circuits: linkages of every class are moved along their configuration curve to see what they reach."""

from __future__ import annotations

import numpy as np
import pytest

import fastlink as fl
from configurations import LENGTHS, random_lengths
from fastlink.mechanisms.planar_4r.classes import CLASS_FLAGS

#: Step on the torus of theta1 and theta2 [rad], and steps that go around every curve (two turns of both angles: 18 rad).
STEP, STEPS = 0.01, 4000
#: Input angles at which configurations are looked for.
ANGLES = np.linspace(-np.pi, np.pi, 37)[:-1] + 0.03


def facts(lengths):
    """Class and circuits of designs (4, n)."""
    space = fl.table(dict(zip(LENGTHS, lengths, strict=True)))
    found = fl.sweep(
        "planar_4r", space, ["grashof_class", "circuit_count", "circuit", "theta2"], theta1=ANGLES
    )
    return {name: found[name].values for name in ("grashof_class", "circuit_count", "circuit", "theta2")}


def moved(lengths, theta1, theta2):
    """Follow the curve |OA + AB - OD| = a3 from one configuration of each design."""
    a, b, c, d = lengths
    size = a + b + c + d
    path = np.empty((2, STEPS, theta1.size))
    e = np.array([theta1, theta2])
    direction = np.zeros_like(e)
    for k in range(STEPS):
        for _ in range(5):
            A, AB = a * np.exp(1j * e[0]), b * np.exp(1j * e[1])
            DB = A + AB - d
            slope = np.array([np.real(1j * A * DB.conj()), np.real(1j * AB * DB.conj())])
            # Newton's step across the curve; the first one lands from the tangent, the others polish.
            e = e - slope * (0.5 * (np.abs(DB) ** 2 - c * c) / np.sum(slope * slope, axis=0))
        assert np.all(np.abs(np.abs(DB) - c) < 1e-9 * size)
        path[:, k] = e
        tangent = np.array([-slope[1], slope[0]]) / np.hypot(*slope)
        # Onwards, never back.
        tangent *= np.where(np.sum(tangent * direction, axis=0) < 0.0, -1.0, 1.0)
        direction = tangent
        e = e + STEP * tangent
    return path


def on_path(path, i, theta1, theta2):
    """Whether configurations lie on the path of design i: a sample within a step, turns apart."""
    offsets = [
        np.abs(np.exp(1j * path[k, :, i]) - np.exp(1j * angle)[:, None])
        for k, angle in enumerate((theta1, theta2))
    ]
    return np.min(np.hypot(*offsets), axis=1) <= STEP


def test_a_moved_linkage_reaches_its_circuit_and_no_other():
    lengths = random_lengths(np.random.default_rng(51), 400)
    a, b, c, d = lengths
    gaps = np.array(
        [a - b + c - d, a + b - c - d, a - b - c + d, a + b + c - d, a + b - c + d, a - b + c + d]
    )
    # At a change point two circuits touch; a gap g parts them by about sqrt(g/length), here 0.2 rad, twenty steps.
    lengths = lengths[:, np.abs(np.vstack([gaps, -a + b + c + d])).min(axis=0) > 0.1]
    got = facts(lengths)
    seen = {}
    closes = np.isfinite(got["circuit"])
    np.testing.assert_array_equal(closes, np.isfinite(got["theta2"]))
    count = np.zeros(lengths.shape[1])
    left = closes.copy()
    for _ in range(3):
        # Start each design from a configuration that no motion has reached yet.
        todo = np.flatnonzero(left.any(axis=(1, 2)))
        start = [np.argwhere(left[i])[0] for i in todo]
        theta1 = np.array([ANGLES[place[1]] for place in start])
        theta2 = np.array([got["theta2"][i][tuple(place)] for i, place in zip(todo, start, strict=True)])
        path = moved(lengths[:, todo], theta1, theta2)
        for k, i in enumerate(todo):
            where = np.argwhere(closes[i])
            reached = on_path(path, k, ANGLES[where[:, 1]], got["theta2"][i][closes[i]])
            own = got["circuit"][i][tuple(start[k])]
            np.testing.assert_array_equal(
                reached, got["circuit"][i][closes[i]] == own, err_msg=str(lengths[:, i])
            )
            left[i][tuple(where[reached].T)] = False
            count[i] += 1
    assert not left.any()
    for i, code in enumerate(got["grashof_class"]):
        # A range narrower than the distance of the angles may be missed.
        if count[i] or CLASS_FLAGS[int(code)] == "never_assembles":
            assert count[i] == got["circuit_count"][i]
            seen[CLASS_FLAGS[int(code)]] = seen.get(CLASS_FLAGS[int(code)], 0) + 1
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
    got = fl.evaluate("planar_4r", ["circuit_count", "circuit"], branch=[[1], [2]], theta1=ANGLES, **given)
    np.testing.assert_array_equal(got["circuit_count"], count)
    assert set(got["circuit"][np.isfinite(got["circuit"])]) <= {1.0, 2.0}
    assert np.all((got["circuit"] == 1) | np.isnan(got["circuit"])) or count == 2
