"""Forces at the folded position of a change point: infinite or not, however small the factor of the pole is."""

import numpy as np
from tests.support.sweeps import sweep_4r

import fastlink as fl

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
    maps = sweep_4r(fl.table(design), asked, verify=0)
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


def test_forces_are_infinite_where_they_have_a_pole():
    infinite, of = assert_infinite_where_they_grow(change_points(1, 500))
    assert 0.2 * of < infinite < 0.8 * of
