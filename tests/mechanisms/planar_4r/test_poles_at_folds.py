"""Forces at the folded position of a change point: infinite or not, however small the factor of the pole is."""

from __future__ import annotations

import numpy as np
import pytest

import fastlink as fl

#: A pole of 1e-2 N rad beside a force of 1e17 N: at 1e-18 rad it is an eighth of it.
SLIGHT = {
    "a1": 1.6823248747042314,
    "a2": 0.8218529211969361,
    "a3": 1.870642532478739,
    "a4": 0.6335352634224285,
}
SLIGHT |= {
    "G1_u": 2.165636772873317,
    "G1_v": 1.6330095174970076,
    "m1": 1.5277567034739066,
    "I1": 1.6018125237513423,
}
SLIGHT |= {"G2_u": 1.7715374484872615e-05, "G2_v": 7.801004392402442e-05, "m2": 1.3939954046048655e-12}
SLIGHT |= {
    "I2": 1.668504653860576,
    "G3_u": -0.9116197211306453,
    "G3_v": 39409.3853798669,
    "m3": 0.05077435801952945,
}
SLIGHT |= {"I3": 0.18001001067124656, "omega1": -278186.6583963102, "gravity_x": 5.591592854268862e-06}
SLIGHT |= {"gravity_y": 0.20324983197614532}
FORCES = ("F21", "F32", "F41", "F43")


def change_points(seed, n):
    """Return change points of whole lengths, a1 + a2 = a3 + a4, with masses and mass centres of any size."""
    rng = np.random.default_rng(seed)
    lengths = rng.integers(1, 9, (4, n)).astype(float)
    lengths[1] = lengths[2] + lengths[3]  # a1 + a2 = (a3 + a1) + a4
    lengths[2] += lengths[0]
    design = dict(zip(("a1", "a2", "a3", "a4"), lengths, strict=True)) | {
        "omega1": 10.0 ** rng.uniform(-6, 6, n)
    }
    for k in (1, 2, 3):
        design |= {f"m{k}": 10.0 ** rng.uniform(-12, 2, n), f"I{k}": 10.0 ** rng.uniform(-9, 3, n)}
        design[f"G{k}_u"] = lengths[k - 1] * rng.uniform(-2.0, 2.0, n)
        across = rng.choice([0.0, 1.0], n) * 10.0 ** rng.uniform(-6, 6, n)
        design[f"G{k}_v"] = np.where(rng.random(n) < 0.7, across, 0.0)
    return design


def assert_infinite_where_they_grow(design):
    """Return how many of the greatest forces of designs are infinite, and how many there are."""
    n = design["a1"].size
    asked = [f"{name}_{end}" for name in FORCES for end in ("max", "max_error")]
    maps = fl.sweep("planar_4r", fl.table(design), asked, verify=0)
    infinite = 0
    for branch in (1.0, 2.0):
        near, nearer = (
            fl.evaluate("planar_4r", FORCES, theta1=np.full(n, theta), branch=branch, **design)
            for theta in (1e-50, 1e-55)
        )
        for name in FORCES:
            # a pole grows by 1e5 from there to there, a sum of other powers not at all
            grows = nearer[name] > 1e4 * near[name]
            most = maps[f"{name}_max"].sel(branch=branch).values
            np.testing.assert_array_equal(np.isinf(most), grows)
            assert np.all(np.isinf(maps[f"{name}_max_error"].sel(branch=branch).values[grows]))
            infinite += grows.sum()
    return infinite, 2 * len(FORCES) * n


@pytest.mark.stress
def test_a_slight_pole_is_infinite():
    design = {name: np.array([value]) for name, value in SLIGHT.items()}
    assert assert_infinite_where_they_grow(design)[0] > 0


def test_forces_are_infinite_where_they_have_a_pole():
    infinite, of = assert_infinite_where_they_grow(change_points(1, 500))
    assert 0.2 * of < infinite < 0.8 * of


@pytest.mark.stress
def test_forces_of_many_change_points_are_infinite_where_they_have_a_pole():
    assert_infinite_where_they_grow(change_points(2, 100_000))
