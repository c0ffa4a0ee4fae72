"""Descents of numbers alone: kinks, bent limits, places without numbers, several objectives."""

import numpy as np
import pytest

from fastlink.design.refine import Outcome, Task, descend

NONE = np.inf


def task(f, slopes, *, signs=(1.0,), low=(-NONE,), high=(NONE,), counts=None):
    """Return the task of results of single points, f(x) and its slopes."""

    def values(points):
        found = np.array([f(x) for x in points], dtype=float)
        return found, np.ones(len(points), bool) if counts is None else np.array([counts(x) for x in points])

    return Task(
        values, lambda p: np.array([slopes(x) for x in p], dtype=float), *map(np.array, (signs, low, high))
    )


def test_a_least_greatest_value_is_at_the_vertex_of_its_pieces():
    """max of three planes and a paraboloid: where the planes 3x - 1, 1 - x - y, 2y - 1 meet, x = 0.4, y = 0.5."""
    normals, offsets = np.array([[3.0, 0.0], [-1.0, -1.0], [0.0, 2.0]]), np.array([-1.0, 1.1, -0.8])

    def pieces(x):
        return normals @ x + offsets

    found = descend(
        task(lambda x: [pieces(x).max()], lambda x: [normals[pieces(x).argmax()]]), np.array([0.9, 0.05])
    )
    # 3x - 1 = 1.1 - x - y = 2y - 0.8
    vertex = np.linalg.solve([[4.0, 1.0], [3.0, -2.0]], [2.1, 0.2])
    assert found.outcome is Outcome.CONVERGED
    # SLSQP's precision is 1e-12 of the objective, the linear programs are exact on planes: 1e-9 of the ranges
    np.testing.assert_allclose(found.point, vertex, atol=1e-9)


def test_a_bent_limit_is_kept_and_named():
    """The greatest x + y within the quarter circle of radius 0.7: at 45 degrees."""
    found = descend(
        task(
            lambda x: [x.sum(), x @ x], lambda x: [np.ones(2), 2.0 * x],
            signs=(-1.0, 0.0), low=(-NONE, -NONE), high=(NONE, 0.49),
        ),
        np.array([0.1, 0.3]),
    )  # fmt: skip
    assert found.values[1] <= 0.49
    # limits are kept by 1e-9 of their size, and sqrt(2 * 0.49) changes by no more than that relatively
    assert found.values[0] == pytest.approx(np.sqrt(2.0 * 0.49), rel=3e-9)
    assert (found.limits, found.ends) == ({(1, 1)}, set())


def test_ends_of_inputs_are_named_and_where_nothing_can_be_gained_the_start_stays():
    found = descend(task(lambda x: [x[0] - x[1]], lambda x: [[1.0, -1.0]]), np.array([0.5, 0.5]))
    np.testing.assert_array_equal(found.point, [0.0, 1.0])
    assert found.ends == {(0, -1), (1, 1)}
    start = np.array([0.5, 0.25])
    found = descend(task(lambda x: [abs(x - start).sum()], lambda x: [np.sign(x - start + 1e-300)]), start)
    assert found.outcome is Outcome.NOTHING_TO_GAIN
    np.testing.assert_array_equal(found.point, start)
    found = descend(task(lambda x: [x[0]], lambda x: [[np.nan]]), np.array([0.5]))
    assert found.outcome is Outcome.NO_DERIVATIVE


@pytest.mark.parametrize("blocked_by", ["a code", "no number"])
def test_what_does_not_count_is_not_entered(blocked_by):
    def f(x):
        return [np.nan if blocked_by == "no number" and x[0] < 0.2 else x[0]]

    counts = (lambda x: x[0] >= 0.2) if blocked_by == "a code" else None
    found = descend(task(f, lambda x: [[1.0, 0.0]], counts=counts), np.array([0.9, 0.5]))
    assert found.outcome is Outcome.BLOCKED
    # steps shrink tenfold as long as they lead across the border
    assert 0.2 <= found.point[0] < 0.2 + 1e-6


def test_several_objectives_fall_together():
    """Least distances from two points: better in both until between them."""
    a, b = np.array([0.2, 0.2]), np.array([0.8, 0.2])
    found = descend(
        task(
            lambda x: [(x - a) @ (x - a), (x - b) @ (x - b)], lambda x: [2.0 * (x - a), 2.0 * (x - b)],
            signs=(1.0, 1.0), low=(-NONE, -NONE), high=(NONE, NONE),
        ),
        np.array([0.4, 0.9]),
    )  # fmt: skip
    assert (found.values < [0.2**2 + 0.7**2, 0.4**2 + 0.7**2]).all()
    assert found.point[1] == pytest.approx(0.2, abs=1e-5)  # values are quadratic there: 1e-10 of them
    assert 0.2 <= found.point[0] <= 0.8
