"""Starts that end in one design are told once, with their number, and the next different designs follow."""

from dataclasses import dataclass

import numpy as np
import pytest

import fastlink as fl
from fastlink.design.refine import FIRST_REACH, Descent, Outcome, Starts, is_one_design

mine = fl.extend("planar_4r")


@mine.quantity(units="1")
def wells(a1, a4):
    """Two wells of unlike depth over the crank, at 0.2 and 0.45 of the ground but for the slope."""
    x = a1 / a4
    return 400 * (x - 0.2) ** 2 * (x - 0.45) ** 2 + x / 10


#: The bottoms: where d/dx of 400 (x - 0.2)^2 (x - 0.45)^2 + x / 10 is 0, but for the hill between them.
BOTTOMS = np.polyder(400.0 * np.poly1d([0.2, 0.2, 0.45, 0.45], r=True) + np.poly1d([0.1, 0.0])).roots.real
BOTTOMS = np.sort(BOTTOMS)[[0, 2]]
RANGES = {"a1": (0.1, 0.55), "a2": 1.2, "a3": 0.8, "a4": 1.0}
#: The descent ends where less than 1e-10 is to be gained, so about the root of that over the curvature from the bottom.
NEAR = 1e-5


def check_wells(found):
    np.testing.assert_allclose(np.sort(found.a1), BOTTOMS, atol=NEAR)
    assert float(found.a1[0]) < float(found.a1[1])  # the deeper one first
    assert int(found.starts.sum()) > 2
    assert f"from {int(found.starts.sum())} of these to 2 different designs" in found.attrs["selection"]


def test_of_a_map_and_of_a_search():
    space = fl.sobol(200, RANGES, seed=1)
    maps = fl.sweep(mine, space, ["wells"], branch=1, progress=False)
    asked = {"minimise": "wells", "top": 4}
    found = fl.best(maps, **asked, refine=True, mechanism=mine)
    check_wells(found)
    searched = fl.search(mine, space, **asked, progress=False)
    np.testing.assert_array_equal(searched.a1, found.a1)
    np.testing.assert_array_equal(searched.starts, found.starts)


def test_designs_of_a_front_that_are_the_same_are_told_once():
    """Copies of a design, off by less than the refinement leaves undone, are one design of the front."""
    a1 = np.concatenate([np.linspace(0.2, 0.4, 5)] * 2) + np.repeat([0.0, 1e-12], 5)
    space = fl.table({"a1": a1, "a2": np.tile(np.linspace(1.0, 1.2, 5), 2), "a3": 0.8, "a4": 1.0})
    asked = {"minimise": "a1", "maximise": "swing"}
    maps = fl.sweep("planar_4r", space, ["swing"], branch=1, progress=False)
    assert fl.best(maps, **asked).sizes["design"] == 10
    found = fl.best(maps, **asked, refine="a2")
    # nothing but a2 may change: each start keeps its own a1, so that all ten differ
    assert found.sizes["design"] == 10
    found = fl.best(maps, **asked, refine=True)
    assert found.sizes["design"] <= 5
    assert int(found.starts.sum()) > found.sizes["design"]


@dataclass
class Line:
    """Points of a line, with one result that is to be least: what `is_one_design` asks of points."""

    curve: object

    limits = np.array([[-np.inf], [np.inf], [1.0]])

    def values(self, points):
        return self.curve(points), np.ones(len(points), dtype=bool)

    def place_of(self, design):
        return design


@pytest.mark.parametrize(
    ("hill", "apart", "same"),
    [
        (0.0, 1e-4, True),
        (1e-9, 1e-4, True),  # less than limits are kept by
        (1e-7, 1e-4, False),  # a hill
        (0.0, 2.0 * FIRST_REACH, False),  # farther than the refinement looks: a valley of equal designs
    ],
)
def test_what_lies_between_tells_whether_designs_are_one(hill, apart, same):
    line = Line(lambda points: 1.0 + hill * np.sin(np.pi * points / apart) ** 2)
    end = Descent(np.zeros(1), np.ones(1), Outcome.CONVERGED, np.ones(1))
    assert is_one_design(line, end, np.array([apart])) == same


def test_starts_are_the_best_of_each_neighbourhood():
    rng = np.random.default_rng(0)
    clusters = np.concatenate([centre + rng.uniform(-0.02, 0.02, (50, 2)) for centre in (0.2, 0.8)])
    starts = Starts(clusters, [()] * 100, 1000, top=10)
    order = []
    for row in starts:
        order.append(row)
        starts.ended(row, clusters[row])
    assert order == [0, 50]
    # of other assembly modes, or with other inputs that stay, they are no neighbours
    starts = Starts(clusters, [(k % 2,) for k in range(100)], 1000, top=10)
    assert [*starts] == [0, 1, 50, 51]
    # the number of starts is limited
    assert len([*Starts(rng.uniform(size=(2000, 6)), [()] * 2000, 10**9, top=3)]) == 10
