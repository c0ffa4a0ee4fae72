"""Fronts are those of the definition: rows that no other row beats, of equal ones the first."""

import numpy as np
import pytest

from fastlink.maps.best import nondominated


def by_definition(points):
    """Compare each row with each."""
    nowhere = (points[:, None] <= points[None]).all(axis=2)
    beats = nowhere & (points[:, None] < points[None]).any(axis=2)
    first = ~np.tril(nowhere & nowhere.T, -1).any(axis=1)
    return np.flatnonzero(~beats.any(axis=0) & first)


@pytest.mark.parametrize("objectives", [2, 3, 4])
@pytest.mark.parametrize("seed", range(8))
def test_a_front_is_that_of_the_definition(objectives, seed):
    rng = np.random.default_rng(seed)
    for count in (1, 2, 7, 60, 300):
        # whole numbers tie often; infinities are values as others
        points = (
            rng.integers(0, 6, (count, objectives)).astype(float)
            if seed % 2
            else rng.normal(size=(count, objectives))
        )
        points[rng.random(points.shape) < 0.02 * (seed // 2)] = np.inf
        points[rng.random(points.shape) < 0.01 * (seed // 2)] = -np.inf
        found = nondominated(points)
        np.testing.assert_array_equal(np.sort(found), by_definition(points))
        np.testing.assert_array_equal(np.lexsort(points[found].T[::-1]), np.arange(len(found)))


def test_three_objectives_of_which_no_row_beats_another():
    cuts = np.sort(np.random.default_rng(0).uniform(size=(20_000, 2)), axis=1)
    points = np.column_stack([cuts[:, 0], cuts[:, 1] - cuts[:, 0], 1.0 - cuts[:, 1]])
    assert len(nondominated(points)) == 20_000
