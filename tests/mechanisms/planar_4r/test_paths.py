"""Straightness and roundness of the path of a point, over given positions or the whole turn."""

import numpy as np
import pytest
from tests.support.configurations import draw
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.mechanisms import catalogue

HOEKEN = {"a1": 1.0, "a2": 2.5, "a3": 2.5, "a4": 2.0, "P_u": 5.0, "P_v": 0.0}
ARC = np.linspace(2.1, 4.2, 72)


@pytest.fixture(scope="module")
def paths():
    """Return designs, their sweep, and the points of their paths (design, branch, position, 2)."""
    columns = draw(catalogue("planar_4r").inputs, np.random.default_rng(5), 400)
    columns = {name: columns[name] for name in ("a1", "a2", "a3", "a4", "P_u", "P_v")}
    columns["a1"] *= np.where(np.arange(400) % 3, 0.2, 1.0)
    names = ["P_straightness", "P_roundness"]
    maps = sweep_4r(fl.table(columns), names, theta1=ARC, verify=0)
    wide = {name: values[:, None, None] for name, values in columns.items()}
    found = fl.evaluate("planar_4r", ["P_x", "P_y"], theta1=ARC, branch=np.array([[1], [2]]), **wide)
    return maps, np.stack([found["P_x"], found["P_y"]], axis=-1)


def test_a_path_that_is_nearly_straight_has_the_narrowest_strip(paths):
    """The reference is the convex hull. The sums of each point's distance have ten roundings of the path's size."""
    maps, points = paths
    whole = np.isfinite(points).all(axis=(-1, -2))
    exact = np.where(whole, fl.planar.straightness(points[..., 0], points[..., 1]), np.nan)
    found, size = maps.P_straightness.values, np.ptp(points, axis=-2).max(axis=-1)
    assert (np.isnan(found) == ~whole).all()  # a path of which points are missing has none
    straight = whole & (exact < 0.02 * size)
    assert straight.sum() > 10
    assert (abs(found - exact)[straight] <= 10 * 2.0**-52 * size[straight]).all()
    # others are not less, and hardly more: another edge of the hull may be a little better
    assert (found[whole] >= exact[whole] - 10 * 2.0**-52 * size[whole]).all()
    assert np.median(found[whole] / exact[whole]) < 1.0 + 1e-12
    assert (found[whole] <= 1.05 * exact[whole]).all()


def test_a_circle_is_round(paths):
    """A coupler point in A runs on the circle of the crank; others are off the circle of the same fit by NumPy."""
    crank = sweep_4r(fl.grid(**HOEKEN | {"P_u": 0.0}), ["P_roundness"], theta1=72, verify=0)
    assert (crank.P_roundness < 20 * 2.0**-52).all()
    maps, points = paths
    for design, branch in np.argwhere(np.isfinite(points).all(axis=(-1, -2)))[::40].tolist():
        own = points[design, branch] - points[design, branch].mean(axis=0)
        centre, *_ = np.linalg.lstsq(np.c_[own, np.ones(72)], (own * own).sum(axis=1), rcond=None)
        radii = np.hypot(*(own - centre[:2] / 2.0).T)
        expected = abs(radii - radii.mean()).max()
        # the centre is the solution of two equations: its condition is that of the fit, at most 1e6 here
        assert abs(float(maps.P_roundness[design, branch]) - expected) < 1e6 * 2.0**-52 * radii.max()


def test_hoekens_family_is_found():
    space = fl.sobol(
        20_000, seed=1, a1=(0.2, 1.0), a2=(0.5, 3.0), a3=(0.5, 3.0), a4=1.0, P_u=(0.0, 6.0), P_v=0.0
    )
    asked = {"theta1": ARC, "where": {"status": "rotates_fully"}, "branch": [1, 2], "top": 1}
    found = fl.search("planar_4r", space, ["P_roundness"], minimise="P_straightness", **asked)
    hoeken = fl.sweep("planar_4r", fl.grid(**HOEKEN), ["P_straightness"], theta1=ARC, branch=2, verify=0)
    share = float(hoeken.P_straightness.item()) / HOEKEN["a4"]
    assert 0.0 < found.P_straightness.item() < 2.0 * share
    assert (
        found.P_straightness.attrs["long_name"] == "Path of P: greatest distance from the best straight line"
    )
    assert found.P_straightness.attrs["units"] == "m"


def test_what_has_no_path_is_refused():
    for name, key, remedy in (
        ("Q_straightness", "'Q'", "P_straightness"),
        ("omega4_straightness", "'omega4'", "P_straightness"),
        ("d_P_straightness_d_a1", "no derivative", "P_straightness"),
        ("P_straightness_error", "error bound", "P_straightness"),
    ):
        with refused(key, remedy):
            sweep_4r(fl.grid(**HOEKEN), [name])
    assert "P_straightness" in [row.name for row in fl.quantities("planar_4r", find="straight line of P")]
