"""Pictures of rows: scatter, corner, cumulative distributions, fronts."""

import numpy as np
import pytest
from matplotlib.collections import PathCollection, QuadMesh
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.refusals import refused

import fastlink as fl
from fastlink.pictures import cloud

NAMES = ["omega4_max", "transmission_angle_min"]


@pytest.fixture(scope="module")
def maps():
    """Designs of every status; some extremes are infinite, and some do not assemble."""
    space = fl.grid(
        a1=np.linspace(0.1, 3.0, 12), a2=np.linspace(0.3, 1.5, 9), a3=0.8, a4=[0.9, 1.0], omega1=25.0
    )
    return fl.sweep("planar_4r", space, [*NAMES, "grashof_class", "status"], branch=1, verify=0)


@pytest.fixture(scope="module")
def usable(maps):
    values = np.stack([maps[name].values.ravel() for name in NAMES])
    return values[:, np.isfinite(values).all(axis=0)]


def dots(axis):
    (found,) = [one for one in axis.collections if isinstance(one, PathCollection)]
    return found


def cells(axis):
    (found,) = [one for one in axis.collections if isinstance(one, QuadMesh)]
    return found


def words(axis):
    found = axis.get_legend()
    return [] if found is None else [text.get_text() for text in found.get_texts()]


def test_a_scatter_has_every_row_with_numbers_and_counts_the_others(maps, usable):
    figure = fl.plot_designs(maps, NAMES, degrees=True)
    (axis,) = figure.axes
    assert_allclose(dots(axis).get_offsets().T, [usable[0], np.rad2deg(usable[1])], rtol=4e-16)
    absent = int(np.isnan(maps.omega4_max).sum())
    infinite = int(np.isinf(maps.omega4_max).sum())
    assert absent
    assert infinite
    title = f"{usable.shape[1]} of {maps.omega4_max.size} rows, without {absent} not a number, {infinite} infinite"
    assert figure.get_suptitle() == title
    assert axis.get_ylabel().replace("\n", " ").endswith("[°]")


def test_conditions_are_those_of_best_and_stand_in_the_title(maps):
    where = {"status": "rotates_fully", "a2": (1.0, None)}
    figure = fl.plot_designs(maps, NAMES, where=where)
    expected = int(((maps.status == 0) & (maps.a2 >= 1.0)).sum())
    assert len(dots(figure.axes[0]).get_offsets()) == expected
    assert figure.get_suptitle() == f"{expected} rows where status is rotates fully and a2 is at least 1"


def test_a_third_quantity_colours(maps, usable):
    figure = fl.plot_designs(maps, [*NAMES, "a1"])
    axis, bar = figure.axes
    assert bar.get_ylabel() == "$a_{1}$ [m]"
    assert_array_equal(
        dots(axis).get_array(),
        maps.a1.broadcast_like(maps.omega4_max).values[np.isfinite(maps.omega4_max.values)],
    )
    coded = fl.plot_designs(maps, [*NAMES, "grashof_class"])
    assert "crank rocker" in words(coded.axes[0])


def test_many_rows_are_counted_in_cells(maps, usable, monkeypatch):
    monkeypatch.setattr(cloud, "MOST_POINTS", 20)
    (axis, bar) = fl.plot_designs(maps, NAMES).axes
    assert bar.get_ylabel() == "rows in a cell"
    found = cells(axis).get_array().filled(0.0)
    mesh = cells(axis).get_coordinates()
    expected, *_ = np.histogram2d(*usable, bins=[mesh[0, :, 0], mesh[:, 0, 1]])
    assert_array_equal(found, expected.T)
    coloured = fl.plot_designs(maps, [*NAMES, "a1"]).axes
    assert coloured[1].get_ylabel() == "mean of $a_{1}$ [m]"
    with refused("grashof_class", "where"):
        fl.plot_designs(maps, [*NAMES, "grashof_class"])


def test_a_corner_has_each_pair_and_each_by_itself(maps):
    figure = fl.plot_designs(maps, [*NAMES, "a1", "a2"])
    shown = [axis for axis in figure.axes if axis.get_visible()]
    assert len(shown) == 4 + 6
    assert [axis.get_xlabel() for axis in shown[-4:]][2:] == ["$a_{1}$ [m]", "$a_{2}$ [m]"]
    assert not shown[0].collections
    (two,) = [axis for axis in fl.plot_designs(maps, NAMES, kind="corner").axes if axis.collections]
    assert len(dots(two).get_offsets())


@pytest.mark.parametrize("most", [cloud.MOST_POINTS, 20], ids=["points", "cells"])
def test_a_cumulative_distribution_counts_what_grows_without_bound(maps, usable, most, monkeypatch):
    monkeypatch.setattr(cloud, "MOST_POINTS", most)
    figure = fl.plot_designs(maps, "omega4_max", where={"a4": (1.0, 1.0)})
    (axis,) = figure.axes
    (line, _) = axis.get_lines()
    values = maps.omega4_max.sel(a4=1.0).values
    values = values[~np.isnan(values)]
    x, share = line.get_xdata(), line.get_ydata()
    assert_allclose(share, [100.0 * np.mean(values <= one) for one in x], atol=1e-10)
    (label,) = words(axis)
    assert f"{100 * np.isinf(values).mean():.3g} % without bound" in label
    two = fl.plot_designs(maps, NAMES, kind="cumulative")
    assert len(two.axes) == 2  # of different units


def test_a_front_is_that_of_best(maps):
    options = {"minimise": "omega4_max", "maximise": "transmission_angle_min", "where": "rotates_fully"}
    figure = fl.plot_front(maps, **options, degrees=True)
    front = fl.best(maps, **options)
    (line,) = figure.axes[0].get_lines()
    x, y = line.get_data()
    assert_array_equal(x, np.sort(front.omega4_max.values))
    assert_allclose(np.sort(y), np.sort(np.rad2deg(front.transmission_angle_min.values)), rtol=4e-16)
    assert words(figure.axes[0]) == ["all rows", "Pareto front"]
    three = fl.plot_front(maps, minimise="omega4_max", maximise=["transmission_angle_min", "a1"])
    assert len([axis for axis in three.axes if axis.get_visible()]) == 6


@pytest.mark.parametrize(
    ("options", "key", "remedy"),
    [
        ({"names": []}, "names", "omega4_max"),
        ({"names": 3}, "names", "omega4_max"),
        ({"names": ["omega4_mxa", "a1"]}, "names", "did you mean 'omega4_max'"),
        ({"names": ["a1", "a3"]}, "names", "swept"),
        ({"names": ["a1", "a1"]}, "names", "once"),
        ({"names": "a1", "kind": "scatter"}, "names", "2 to 3"),
        ({"names": NAMES, "kind": "scater"}, "kind", "did you mean 'scatter'"),
        ({"names": NAMES, "where": {"a2": (9.0, None)}}, "omega4_max", "fewer conditions"),
        ({"names": NAMES, "where": {"a2": 9.0}}, "a2", "None"),
        ({"names": NAMES, "branch": 2}, "branch", "1"),
    ],
)
def test_requests_without_sense_are_refused(maps, options, key, remedy):
    with refused(key, remedy):
        fl.plot_designs(maps, **options)


def test_a_front_of_one_objective_is_refused(maps):
    with refused("front", "fastlink.best"):
        fl.plot_front(maps, minimise="omega4_max")
    with refused("best", "minimise"):
        fl.plot_front(maps)


def test_a_map_has_its_pictures_itself(maps, tmp_path):
    for figure, other in (
        (maps.fastlink.plot("omega4_max", at={"a4": 1.0}), fl.plot_map(maps, "omega4_max", at={"a4": 1.0})),
        (maps.fastlink.plot.designs(NAMES, to=tmp_path / "a.png"), fl.plot_designs(maps, NAMES)),
        (
            maps.fastlink.plot.front(minimise="omega4_max", maximise="a1"),
            fl.plot_front(maps, minimise="omega4_max", maximise="a1"),
        ),
    ):
        assert figure.get_suptitle() == other.get_suptitle()
        assert len(figure.axes) == len(other.axes)
    assert (tmp_path / "a.png").exists()
