"""Pictures of maps: what is drawn where, of whatever users make of a map, and what cannot be drawn."""

import subprocess
import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.collections import PathCollection, QuadMesh
from matplotlib.contour import ContourSet
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.refusals import refused
from tests.support.sweeps import BARS, sweep_4r, sweep_both

import fastlink as fl
from fastlink.pictures import charts
from fastlink.pictures.labels import mathematical
from fastlink.pictures.style import ABSENT, WITHOUT_BOUND, limits_of

A1 = [0.2, 0.5, 1.0, 3.0]
NAMES = ["omega4_max", "transmission_angle_min"]


@pytest.fixture(scope="module")
def maps():
    """Designs of every status, in three dimensions."""
    space = fl.grid(a1=A1, a2=np.linspace(0.3, 1.5, 5), a3=0.8, a4=[0.9, 1.0], omega1=25.0)
    return sweep_4r(space, [*NAMES, "theta1_at_omega4_max", "grashof_class", "time_ratio"])


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """The file of a map with curves, of which it has one value along the ground link."""
    path = tmp_path_factory.mktemp("maps") / "maps.h5"
    space = fl.grid(a1=A1, a2=np.linspace(0.3, 1.5, 5), a3=0.8, a4=1.0, omega1=25.0)
    sweep_4r(space, ["omega4_max", "theta4"], theta1=8, to=path, verify=0).close()
    return path


@pytest.fixture(scope="module")
def flat(path):
    with fl.open(path) as opened:
        return opened.load()


@pytest.fixture(scope="module")
def curves():
    """One design that assembles over part of the turn."""
    space = fl.grid(a1=1.2, a2=1.3, a3=0.8, a4=1.0, omega1=25.0)
    return sweep_4r(space, ["omega4", "theta4", "omega4_max"], theta1=90)


@pytest.fixture(scope="module")
def types():
    """Minkowskian linkages of many types."""
    lengths = np.linspace(0.125, 4.0, 32)
    names = ["linkage_type", "assembly_count_future", "theta_max"]
    return sweep_both("minkowski_4r", fl.grid(a=lengths, b=lengths, g=1.0, h=1.0), names)


def drawn(maps, name, **options):
    """Draw all of a picture, text too."""
    figure = fl.plot(maps, name, **options)
    figure.draw_without_rendering()
    return figure


def panels(figure):
    return [axes for axes in figure.axes if axes.get_label() != "<colorbar>"]


def bar(figure):
    (axes,) = [axes for axes in figure.axes if axes.get_label() == "<colorbar>"]
    return axes


def words(axis):
    found = axis.get_legend()
    return [] if found is None else [text.get_text().replace("\n", " ") for text in found.get_texts()]


def legend(figure):
    return words(panels(figure)[0])


def cells(axis):
    return axis.collections[0].get_array().filled(np.nan)


def finite(values):
    """Return values with NaN for those that are not finite, as a map's cells have them."""
    return np.where(np.isfinite(values), values, np.nan)


def test_a_map_shows_the_values_where_they_belong(maps):
    figure = fl.plot(maps, "omega4_max", branch=2, at={"a4": 0.97})
    (axes,) = panels(figure)
    expected = maps["omega4_max"].sel(branch=2, a4=1.0).transpose("a2", "a1").values
    assert_array_equal(cells(axes), finite(expected))
    corners = axes.collections[0].get_coordinates()
    assert_allclose(corners[0, 1:3, 0], [0.35, 0.75])  # half-way between the values of a1
    assert axes.get_xlabel() == "length of the input crank OA $a_{1}$ [m]"
    assert axes.get_ylabel() == "length of the coupler AB $a_{2}$ [m]"
    assert bar(figure).get_ylabel() == r"max $\omega_{4}$ [rad s$^{-1}$]"
    # the nearest
    assert figure.get_suptitle().endswith("greatest over the cycle\n$a_{4}$ = 1 m, branch 2")
    assert "$a_{3}$ = 0.8 m" in figure.get_supxlabel()
    shuffled = fl.plot(maps.isel(a1=[2, 0, 3, 1]), "omega4_max", branch=2, at={"a4": 1.0})
    assert_array_equal(cells(panels(shuffled)[0]), finite(expected))


def test_what_has_no_value_or_grows_without_bound_is_marked_and_in_the_legend(maps):
    values = maps["omega4_max"].sel(branch=1, a4=1.0).T
    assert np.isnan(values).any()
    assert np.isposinf(values).any()
    figure = fl.plot(maps, "omega4_max", at={"a4": 1.0})
    (axes,) = panels(figure)
    assert axes.get_facecolor() == mpl.colors.to_rgba(ABSENT)
    assert_array_equal(np.isnan(cells(axes)), ~np.isfinite(values))
    assert_array_equal(axes.collections[1].get_array().filled(False), np.isinf(values))
    text = " ".join(legend(figure))
    assert "does not assemble" in text
    assert WITHOUT_BOUND in text
    assert "never" not in text
    line = fl.plot(maps, "omega4_max", branch=1, at={"a4": 1.0, "a2": float(maps.a2[0])})
    assert WITHOUT_BOUND in legend(line)
    assert legend(fl.plot(maps.isel(a1=0, a2=[2, 3]), NAMES[1])) == []
    partial = maps.sel(a4=1.0).isel(a1=[1, 2], a2=[2, 3])
    assert "has no value" in (found := legend(fl.plot(partial, "time_ratio")))
    assert "does not assemble" not in found
    assert any("assembles over part of the turn" in word for word in legend(fl.plot(partial, NAMES[1])))


def test_gaps_along_a_sample_are_one_shape_however_many_they_are():
    space = fl.sobol(512, a1=(0.05, 2.0), a2=(0.05, 2.0), a3=(0.05, 2.0), a4=1.0, omega1=1.0)
    sample = fl.sweep("planar_4r", space, ["omega4_max"], branch=1)
    (axis,) = fl.plot(sample, "omega4_max").axes
    (line,) = axis.get_lines()
    assert line.get_linestyle() == "None"
    assert_array_equal(line.get_xdata(), np.arange(512))
    values, inside = sample.omega4_max.values, np.arange(512)
    for shape, gaps in zip(axis.collections, (np.isnan(values), np.isposinf(values)), strict=True):
        shaded = np.zeros(512, dtype=bool)
        for one in shape.get_paths():
            low, high = one.get_extents().intervalx
            shaded |= (inside > low - 1e-9) & (inside < high + 1e-9)
        assert_array_equal(shaded, gaps)
        assert len(shape.get_paths()) > 20


def test_modes_that_agree_are_one_panel_others_two_and_one_alone_has_its_name(maps):
    assert len(panels(fl.plot(maps, "omega4_max", at={"a4": 1.0}))) == 1
    differ = panels(fl.plot(maps, "theta1_at_omega4_max", at={"a4": 1.0}))
    assert [axes.get_title() for axes in differ] == ["branch 1", "branch 2"]
    assert_array_equal(cells(differ[1]), maps["theta1_at_omega4_max"].sel(branch=2, a4=1.0).T)
    space = fl.grid(a1=[0.2, 0.5], a2=[1.1, 1.2], a3=0.8, a4=1.0, omega1=25.0)
    one = fl.sweep("planar_4r", space, ["omega4_max"], branch=2)
    assert "branch" not in one.dims
    for options in ({}, {"branch": 2}):
        assert drawn(one, "omega4_max", **options).get_suptitle().endswith("branch 2")
    with refused("branch", "2"):
        fl.plot(one, "omega4_max", branch=1)


def test_a_code_of_many_values_has_a_legend_beside_the_axes(types):
    figure = fl.plot(types, "linkage_type")
    codes = types["linkage_type"].attrs["flag_values"].tolist()
    meanings = types["linkage_type"].attrs["flag_meanings"].split()
    present = [meanings[codes.index(code)].replace("_", " ") for code in np.unique(types["linkage_type"])]
    assert len(present) >= 8
    assert legend(figure) == [f"{number}  {name}" for number, name in enumerate(present, 1)]
    (axes,) = figure.axes
    of_code = dict(enumerate(np.unique(types["linkage_type"]), 1))
    assert len(axes.texts) > 3  # in the areas
    for text in axes.texts:
        x, y = text.get_position()
        assert types["linkage_type"].sel(a=x, b=y) == of_code[int(text.get_text())]
    # Codes with gaps between them: each has a colour of its own, the one that the legend shows.
    mesh = axes.collections[0]
    patches = dict(zip(present, axes.get_legend().get_patches(), strict=True))
    for code, name in zip(np.unique(types["linkage_type"]), present, strict=True):
        (place,) = np.unique(mesh.get_array()[code == types["linkage_type"].values.T])
        assert_allclose(mesh.cmap(mesh.norm(place)), patches[name].get_facecolor())
    assert len({patch.get_facecolor() for patch in patches.values()}) == len(present)
    figure.draw_without_rendering()
    assert axes.get_legend().get_window_extent().x0 >= axes.get_window_extent().x1
    assert axes.get_window_extent().height > 0.7 * figure.bbox.height


def test_codes_and_counts(types):
    space = fl.grid(a=1.0, b=1.0, g=np.linspace(1.0, 4.0, 5), h=1.0)
    figure = fl.plot(sweep_both("minkowski_4r", space, ["CB_orientation"]), "CB_orientation", branch=1)
    assert set(legend(figure)) <= {"past pointing", "none", "future pointing"}
    assert set(np.unique(panels(figure)[0].collections[0].get_array().compressed())) <= {0.0, 1.0, 2.0}
    figure = fl.plot(types, "assembly_count_future")
    (axes,) = panels(figure)
    assert len(axes.collections) == 1  # steps, and no contours
    assert_array_equal(axes.collections[0].get_clim(), (0.5, 3.5))
    assert legend(figure) == []
    # theta_max is where a design assembles over part of theta only: a veil would cover all that there is
    assert legend(fl.plot(types, "theta_max")) == ["has no value"]


def test_large_maps_are_thinned_and_outliers_do_not_use_up_the_colours():
    space = fl.grid(a1=np.linspace(0.1, 0.3, 4000), a2=[1.1, 1.2], a3=0.8, a4=1.0)
    figure = fl.plot(sweep_4r(space, ["status"]), "status")
    assert cells(panels(figure)[0]).shape == (2, 1334)
    values = np.concatenate((np.linspace(1.0, 2.0, 100), [1e6]))
    low, high, extend = limits_of(values, values, 2.0)
    assert (low, extend) == (1.0, "max")
    assert 1.9 < high < 2.2
    assert limits_of(values[:-1], values[:-1], 2.0) == (1.0, 2.0, "neither")
    assert limits_of(np.ones(3), np.ones(3), 2.0) == (0.5, 1.5, "neither")


@pytest.fixture(scope="module")
def solid():
    space = fl.grid(
        a1=np.linspace(0.2, 0.9, 8), a2=np.linspace(0.6, 1.4, 5), a3=[0.7, 0.8, 0.9], a4=1.0, omega1=25.0
    )
    return sweep_4r(space, ["omega4_max", "theta1_at_omega4_max", "grashof_class"])


def test_a_grid_has_a_map_for_values_over_the_whole_input(solid):
    figure = fl.plot(solid, "omega4_max", panels="a1", branch=1)
    axes = panels(figure)
    shown = solid.a1.values[[0, 1, 3, 4, 6, 7]]  # at most six of the eight, with both ends
    assert [axis.get_title() for axis in axes] == [f"$a_{{1}}$ = {value:.3g} m" for value in shown]
    assert len({axis.collections[0].get_clim() for axis in axes}) == 1  # one scale of colours
    assert bar(figure).get_ylabel() == r"max $\omega_{4}$ [rad s$^{-1}$]"
    low, high = bar(figure).get_ylim()
    for axis, value in zip(axes, shown, strict=True):
        expected = finite(solid.omega4_max.sel(branch=1, a1=value).transpose("a3", "a2").values)
        inside = (expected >= low) & (expected <= high)
        assert_array_equal(np.isnan(cells(axis)), np.isnan(expected))
        assert_array_equal(cells(axis)[inside], expected[inside])
    # only the outer panels are labelled
    assert [bool(axis.get_xlabel()) for axis in axes] == [False] * 3 + [True] * 3
    assert [bool(axis.get_ylabel()) for axis in axes] == [True, False, False] * 2
    assert any("without bound" in word for axis in axes for word in words(axis))


def test_assembly_modes_that_differ_have_a_row_each_and_codes_a_legend(solid):
    axes = panels(fl.plot(solid, "theta1_at_omega4_max", panels="a1"))
    rows = ["branch 1"] * 3 + ["branch 2"] * 3
    assert [axis.get_title().partition(",")[0] for axis in axes] == rows
    figure = fl.plot(solid, "omega4_max", panels="a1")
    assert len(panels(figure)) == 6
    assert figure.get_suptitle().endswith("branches 1 and 2 (they agree)")
    codes = panels(fl.plot(solid, "grashof_class", panels="a3"))
    assert (len(codes), "crank rocker" in words(codes[-1])) == (3, True)


def test_curves_are_a_line_for_each_mode_and_a_single_number_is_stated(curves):
    figure = fl.plot(curves, "omega4")
    assert legend(figure) == ["branch 1", "branch 2", "does not assemble"]
    for branch, line in zip((1, 2), figure.axes[0].get_lines(), strict=True):
        assert_array_equal(line.get_ydata(), curves["omega4"].sel(branch=branch))
        assert_array_equal(line.get_xdata(), curves["theta1"])
    assert [text.get_text() for text in figure.axes[0].get_xticklabels()][2] == r"$\pi$"
    (line,) = fl.plot(curves, "omega4", branch=2).axes[0].get_lines()
    assert_array_equal(line.get_ydata(), curves["omega4"].sel(branch=2))
    value = float(curves["omega4_max"].sel(branch=1))
    with pytest.raises(fl.InputError, match=rf"its value is {value:g}; leave one free$"):
        fl.plot(curves, "omega4_max", branch=1)


def test_a_line_for_each_value_of_an_input(solid):
    figure = fl.plot(solid, "omega4_max", lines="a1", at={"a3": 0.8}, branch=2)
    lines = [line for line in panels(figure)[0].get_lines() if line.get_linestyle() != "None"]
    assert len(lines) == len({line.get_color() for line in lines}) == 6
    values = solid.omega4_max.sel(branch=2, a1=0.2, a3=0.8).values
    assert_array_equal(finite(lines[0].get_ydata()), finite(values))
    assert legend(figure)[0] == "$a_{1}$ = 0.2 m"
    both = fl.plot(solid, "theta1_at_omega4_max", lines="a1", at={"a3": 0.8})
    assert {line.get_linestyle() for line in panels(both)[0].get_lines()} == {"-", "--", "None"}


def test_a_change_point_is_a_dot_and_what_grows_without_bound_a_bar_of_its_line():
    """Of two lines one has its change point at a2 = 1.2, the other none; beyond it the force has no bound."""
    space = fl.grid(a1=0.4, a2=np.linspace(1.0, 1.4, 9), a3=0.8, a4=[0.8, 1.2], omega1=25.0)
    maps = fl.sweep("planar_4r", space, ["shaking_force_max"], links=BARS)
    (axis,) = fl.plot(maps, "shaking_force_max", lines="a4").axes
    dots = [line for line in axis.get_lines() if line.get_linestyle() == "None"]
    ((place, value),) = [line.get_xydata()[0] for line in dots]
    at = maps.shaking_force_max.sel(a4=0.8)
    assert (place, value) == (1.2, float(at.sel(a2=1.2, method="nearest")))
    line, other = (one for one in axis.get_lines() if one.get_linestyle() != "None")
    assert_array_equal(np.isfinite(line.get_ydata()), np.isfinite(at) & (maps.a2 != place))
    assert np.isfinite(other.get_ydata()).all()
    (bar_of_line,) = axis.collections
    assert_allclose(bar_of_line.get_facecolor()[0], line.get_color())
    assert bar_of_line.get_paths()[0].get_extents().y0 > 0.9
    assert_allclose(bar_of_line.get_paths()[0].get_extents().intervalx, [1.225, 1.4])
    alone = fl.plot(maps.sel(a4=0.8), "shaking_force_max").axes[0]
    assert alone.collections[0].get_paths()[0].get_extents().y0 == 0.0
    assert words(alone) == [WITHOUT_BOUND, "change point"]  # and no entry of the one line


def test_change_points_along_a_line_of_cells_are_dots_and_contours_have_room():
    space = fl.grid(a1=0.4, a2=np.linspace(1.0, 1.4, 41), a3=np.linspace(0.6, 1.0, 41), a4=1.0, omega1=25.0)
    maps = fl.sweep("planar_4r", space, ["shaking_force_max", "status"], links=BARS)
    figure = fl.plot(maps, "shaking_force_max")
    (axis,) = panels(figure)
    (dots,) = axis.get_lines()
    there = maps.status.values == maps.status.attrs["flag_meanings"].split().index("change_point")
    assert len(dots.get_xdata()) == there.sum() > 10
    assert legend(figure) == ["change point", WITHOUT_BOUND]
    (contours,) = [one for one in axis.collections if isinstance(one, ContourSet)]
    assert 1 < len(contours.levels) < 7  # of eight; those near the toggles are on each other


def test_angles_in_degrees_along_axes_and_in_colours(flat):
    figure = drawn(flat, "theta4", branch=2, at={"theta1": 91.0}, degrees=True)
    assert figure.get_suptitle().endswith(r"$\theta_{1}$ = 90°, branch 2")
    expected = np.rad2deg(flat.theta4.isel(branch=1, theta1=2).transpose("a2", "a1"))
    assert_array_equal(cells(panels(figure)[0]), expected)
    for degrees in (False, True):  # a map that is in degrees already stays
        other = drawn(flat.fastlink.degrees(), "theta4", branch=2, at={"theta1": 90.0}, degrees=degrees)
        assert bar(figure).get_ylabel() == bar(other).get_ylabel()
    assert bar(figure).get_ylabel().endswith("[°]")
    curve = drawn(flat, "theta4", branch=1, at={"a1": 0.2, "a2": 0.9}, degrees=True).axes[0]
    assert_allclose(curve.get_xlim(), (0.0, 360.0))
    assert [text.get_text() for text in curve.get_xticklabels()] == ["0", "90", "180", "270", "360"]
    with refused("theta1", "315"):
        fl.plot(flat, "theta4", at={"theta1": 400.0}, degrees=True)


def test_an_angle_that_passes_half_a_turn_is_cut_and_has_cyclic_colours():
    space = fl.grid(a1=1.2, a2=np.linspace(1.0, 2.0, 6), a3=0.8, a4=1.0)
    wide, lines = sweep_4r(space, ["theta4"], theta1=40), []
    for degrees, half in ((False, np.pi), (True, 180.0)):
        (axes,) = panels(drawn(wide, "theta4", branch=2, degrees=degrees))
        assert axes.get_ylabel().endswith(rf"$\theta_{{1}}$ [{'°' if degrees else 'rad'}]")
        assert axes.collections[0].get_cmap().name == "twilight_shifted"
        assert axes.collections[0].get_clim() == (-half, half)
        curve = drawn(wide, "theta4", branch=2, at={"a2": 1.0}, degrees=degrees)
        lines.append(curve.axes[0].get_lines()[0].get_ydata())
    values = wide.theta4.sel(branch=2, a2=1.0).values
    jumps = int((np.abs(np.diff(values)) > np.pi).sum())
    assert jumps > 0
    assert np.isnan(lines[0]).sum() == np.isnan(values).sum() + jumps
    assert_array_equal(lines[0][np.isfinite(lines[0])], values[np.isfinite(values)])
    assert_allclose(lines[1], np.rad2deg(lines[0]), rtol=4e-16)


LABELS = ["a_$", "b$^2$", "x" * 99, ""]
CHANGES = {
    "one mode": lambda maps: maps.isel(branch=0),
    "mean": lambda maps: maps.mean("a2", keep_attrs=True),
    "without coordinates": lambda maps: maps.drop_vars(["a1", "a2", "branch", "theta1", "a3"]),
    "without status": lambda maps: maps.drop_vars("status"),
    "stacked": lambda maps: maps.stack(all=("a1", "a2")),
    "renamed": lambda maps: maps.rename(a1="crank", branch="mode", status="state"),
    "named designs": lambda maps: maps.assign_coords(a1=LABELS, maker="someone"),
    "dates": lambda maps: maps.assign_coords(a1=np.array(["2020", "2021", "2022", "2023"], "M8[D]")),
    "equal coordinates": lambda maps: maps.assign_coords(a1=[1.0, 1.0, 2.0, 2.0]),
    "infinite coordinates": lambda maps: maps.assign_coords(a1=[1.0, np.nan, np.inf, 2.0]),
    "no labels": lambda maps: maps.map(lambda one: one.drop_attrs(), keep_attrs=False).assign_attrs(
        maps.attrs
    ),
    "damaged codes": lambda maps: maps.assign(status=maps.status.assign_attrs(flag_meanings="one two")),
    "single precision": lambda maps: maps.astype("f4"),
    "one of each": lambda maps: maps.isel(a1=[1], theta1=[2]),
    "transposed": lambda maps: maps.transpose("theta1", "branch", "a2", "a1"),
    "in slices": lambda maps: maps.isel(a1=slice(None, None, -1), a2=slice(0, 2)),
}


@pytest.mark.sample(4)
@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_whatever_became_of_a_map_is_drawn(flat, change):
    changed = change(flat.isel(branch=[0]))
    if "mode" in changed.dims:  # no assembly modes any more, but one dimension too many
        assert fl.plot(changed, "state")
        changed = changed.isel(mode=0)
    assert fl.plot(changed, "omega4_max")


def test_labels_of_designs_stand_along_the_axis_as_they_are(path, flat):
    named = flat.assign_coords(a1=["north", "east", "south", "west"])
    of_path, of_names = (drawn(one, "omega4_max", branch=1) for one in (path, named))
    assert_array_equal(cells(panels(of_names)[0]), cells(panels(of_path)[0]))
    for figure in (of_names, drawn(named, "omega4_max", branch=1, at={"a2": 0.9})):
        shown = [text.get_text() for text in panels(figure)[0].get_xticklabels()]
        assert shown == ["north", "east", "south", "west"]
    with refused("a1", "isel"):
        fl.plot(named, "omega4_max", at={"a1": 1.0})
    strange = flat.assign_coords(a1=LABELS)
    strange["omega4_max"] = strange.omega4_max.assign_attrs(long_name="100 $", units=3, symbol="$x_")
    assert drawn(strange, "omega4_max", branch=1).get_suptitle() == "100 \\$\nbranch 1"
    equal = flat.assign_coords(
        a1=[2.0, 1.0, 2.0, 1.0]
    )  # the status is that of the cell, not of its coordinate
    assert legend(drawn(equal, "omega4_max", branch=1)) == legend(drawn(flat, "omega4_max", branch=1))


def shaped(make):
    """Return a function that makes values of a shape from their count."""
    return lambda values: make(values.size).reshape(values.shape)


#: Values, and what a picture of them says.
VALUES = {
    "all infinite": (lambda values: np.full_like(values, np.inf), "grows without bound everywhere"),
    "both infinities": (
        shaped(lambda n: np.where(np.arange(n) // 2 % 2, np.inf, -np.inf)),
        "grows without bound everywhere",
    ),
    "all NaN": (lambda values: np.full_like(values, np.nan), "no value anywhere"),
    "equal": (lambda values: np.full_like(values, 1.25), "1.25 rad s$^{-1}$ everywhere"),
    "with gaps": (
        lambda values: np.where(np.isnan(values), values, 1.25),
        "1.25 rad s$^{-1}$ wherever it has a",
    ),
    "roundings": (
        shaped(lambda n: 1.25 * (1.0 + 2.0**-52 * (np.arange(n) % 3))),
        "1.25 rad s$^{-1}$ everywhere",
    ),
    "zero": (np.zeros_like, "0 rad s$^{-1}$ everywhere"),
    "huge": (shaped(lambda n: np.linspace(-1.0, 1.0, n) * 1.7e308), ""),
    "huge and positive": (shaped(lambda n: np.geomspace(1e-300, 1.7e308, n)), ""),
    "tiny": (shaped(lambda n: np.geomspace(5e-324, 1e-310, n)), ""),
    "one finite": (shaped(lambda n: np.where(np.arange(n) == 6, 1.0, np.inf)), ""),
    "counts and one huge": (lambda values: np.where(values > 0, 1.0, 1e308), ""),
}


@pytest.mark.sample(4)
@pytest.mark.parametrize(("values", "says"), VALUES.values(), ids=VALUES)
def test_any_values_are_drawn_and_what_is_the_same_everywhere_says_so(flat, values, says):
    changed = flat.assign(omega4_max=flat.omega4_max.copy(data=values(flat.omega4_max.values)))
    figure = drawn(changed, "omega4_max", branch=1)
    infinite = np.isinf(changed.omega4_max.isel(branch=0).values).any()
    assert (WITHOUT_BOUND in legend(figure)) == infinite
    text = " ".join(one.get_text().replace("\n", " ") for one in panels(figure)[0].texts)
    assert says in text
    assert ("where" in text) == bool(says)
    assert (len(figure.axes) == 1) == bool(says)  # without a scale of colours
    line = fl.plot(changed, "omega4_max", branch=1, at={"a1": 0.2}).axes[0]
    assert says.partition(" where")[0] in line.get_title()
    assert line.get_ylim()[0] < line.get_ylim()[1]


@pytest.fixture(scope="module")
def rows():
    """Designs of every status; some extremes are infinite, and some do not assemble."""
    a1, a2 = np.linspace(0.1, 3.0, 12), np.linspace(0.3, 1.5, 9)
    space = fl.grid(a1=a1, a2=a2, a3=0.8, a4=[0.9, 1.0], omega1=25.0)
    return fl.sweep("planar_4r", space, [*NAMES, "grashof_class", "status"], branch=1)


@pytest.fixture(scope="module")
def usable(rows):
    values = np.stack([rows[name].values.ravel() for name in NAMES])
    return values[:, np.isfinite(values).all(axis=0)]


def shown(axis, kind):
    (found,) = [one for one in axis.collections if isinstance(one, kind)]
    return found


def test_a_scatter_has_every_row_with_numbers_and_counts_the_others(rows, usable):
    figure = fl.plot(rows, NAMES, degrees=True)
    (axis,) = figure.axes
    places = [usable[0], np.rad2deg(usable[1])]
    assert_allclose(shown(axis, PathCollection).get_offsets().T, places, rtol=4e-16)
    absent, infinite = int(np.isnan(rows.omega4_max).sum()), int(np.isinf(rows.omega4_max).sum())
    assert min(absent, infinite) > 0
    without = f"without {absent} not a number, {infinite} infinite"
    assert figure.get_suptitle() == f"{usable.shape[1]} of {rows.omega4_max.size} rows, {without}"
    assert axis.get_ylabel().replace("\n", " ").endswith("[°]")
    where = {"status": "rotates_fully", "a2": (1.0, None)}  # conditions are those of best
    figure = fl.plot(rows, NAMES, where=where)
    expected = int(((rows.status == 0) & (rows.a2 >= 1.0)).sum())
    assert len(shown(figure.axes[0], PathCollection).get_offsets()) == expected
    assert figure.get_suptitle() == f"{expected} rows where status is rotates fully and a2 is at least 1"


def test_a_third_quantity_colours_and_a_corner_has_each_pair(rows):
    axis, scale = fl.plot(rows, [*NAMES, "a1"]).axes
    assert scale.get_ylabel() == "$a_{1}$ [m]"
    values = rows.a1.broadcast_like(rows.omega4_max).values[np.isfinite(rows.omega4_max.values)]
    assert_array_equal(shown(axis, PathCollection).get_array(), values)
    assert "crank rocker" in words(fl.plot(rows, [*NAMES, "grashof_class"]).axes[0])
    axes = [axis for axis in fl.plot(rows, [*NAMES, "a1", "a2"]).axes if axis.get_visible()]
    assert len(axes) == 4 + 6
    assert [axis.get_xlabel() for axis in axes[-4:]][2:] == ["$a_{1}$ [m]", "$a_{2}$ [m]"]
    assert not axes[0].collections
    (two,) = [axis for axis in fl.plot(rows, NAMES, kind="corner").axes if axis.collections]
    assert len(shown(two, PathCollection).get_offsets())


def test_many_rows_are_counted_in_cells(rows, usable, monkeypatch):
    monkeypatch.setattr(charts, "MOST_POINTS", 20)
    axis, scale = fl.plot(rows, NAMES).axes
    assert scale.get_ylabel() == "rows in a cell"
    mesh = shown(axis, QuadMesh)
    expected, *_ = np.histogram2d(
        *usable, bins=[mesh.get_coordinates()[0, :, 0], mesh.get_coordinates()[:, 0, 1]]
    )
    assert_array_equal(mesh.get_array().filled(0.0), expected.T)
    assert fl.plot(rows, [*NAMES, "a1"]).axes[1].get_ylabel() == "mean of $a_{1}$ [m]"
    with refused("grashof_class", "where"):
        fl.plot(rows, [*NAMES, "grashof_class"])


@pytest.mark.parametrize("most", [charts.MOST_POINTS, 20], ids=["points", "cells"])
def test_a_cumulative_distribution_counts_what_grows_without_bound(rows, most, monkeypatch):
    monkeypatch.setattr(charts, "MOST_POINTS", most)
    (axis,) = fl.plot(rows, "omega4_max", kind="cumulative", where={"a4": (1.0, 1.0)}).axes
    (line, _) = axis.get_lines()
    values = rows.omega4_max.sel(a4=1.0).values
    values = values[~np.isnan(values)]
    expected = [100.0 * np.mean(values <= one) for one in line.get_xdata()]
    assert_allclose(line.get_ydata(), expected, atol=1e-10)
    assert f"{100 * np.isinf(values).mean():.3g} % without bound" in words(axis)[0]
    assert len(fl.plot(rows, NAMES, kind="cumulative").axes) == 2  # of different units


def test_a_front_is_that_of_best(rows):
    options = {"minimise": "omega4_max", "maximise": "transmission_angle_min", "where": "rotates_fully"}
    (axis,) = fl.plot(rows, **options, degrees=True).axes
    front = fl.best(rows, **options)
    x, y = axis.get_lines()[0].get_data()
    assert_array_equal(x, np.sort(front.omega4_max.values))
    assert_allclose(np.sort(y), np.sort(np.rad2deg(front.transmission_angle_min.values)), rtol=4e-16)
    assert words(axis) == ["all rows", "Pareto front"]
    three = fl.plot(rows, minimise="omega4_max", maximise=["transmission_angle_min", "a1"])
    assert len([axis for axis in three.axes if axis.get_visible()]) == 6


def test_a_map_has_its_pictures_itself(rows, folder):
    fronts = {"minimise": "omega4_max", "maximise": "a1"}
    for figure, other in (
        (rows.fastlink.plot("omega4_max", at={"a4": 1.0}), fl.plot(rows, "omega4_max", at={"a4": 1.0})),
        (rows.fastlink.plot(NAMES, to="a.png"), fl.plot(rows, NAMES)),
        (rows.fastlink.plot(**fronts), fl.plot(rows, **fronts)),
    ):
        assert (figure.get_suptitle(), len(figure.axes)) == (other.get_suptitle(), len(other.axes))
    assert (folder / "a.png").exists()
    assert figure._repr_png_().startswith(b"\x89PNG")


@pytest.mark.parametrize(("ending", "start"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_the_ending_is_the_kind_of_picture(curves, tmp_path, ending, start):
    place = tmp_path / f"map.{ending}"
    place.write_text("which is replaced")
    fl.plot(curves, "omega4", branch=1, to=place)
    assert place.read_bytes().startswith(start)


DOORS = """
import sys
sys.modules["matplotlib"] = None  # as where it is not installed
import fastlink as fl
from fastlink.app.cli import app

maps = fl.sweep("planar_4r", fl.grid(a1=0.4, a2=[1.1, 1.2], a3=0.8, a4=1.0), ["swing"], verify=0, to="maps.h5")
design = {"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0}
doors = [
    lambda: fl.plot(maps, "swing"),
    lambda: fl.plot(maps, ["swing", "a2"]),
    lambda: fl.plot(maps, minimise="swing", maximise="a2"),
    lambda: fl.draw("planar_4r", **design),
    lambda: fl.explore(maps, to="page.html"),
    lambda: maps.fastlink.plot("swing"),
    lambda: maps.fastlink.plot(["swing", "a2"]),
]
for door in doors:
    try:
        door()
    except fl.InputError as error:
        print(str(error).partition("matplotlib is not installed; python -m pip install ")[2])
draw = "draw planar_4r a1=0.4 a2=1.1 a3=0.8 a4=1.0 --to b.png"
print(app(draw.replace("b.png", "b.dxf").split(), standalone_mode=False))
sys.modules["ezdxf"] = None
print(fl.draw("planar_4r", **design, to="b.mm.svg"))
for line in ("plot maps.h5 swing --to a.png", draw, "explore maps.h5 --to c.html"):
    try:
        print(app(line.split(), standalone_mode=False))
    except SystemExit as done:
        print(done.code)
del sys.modules["matplotlib"]
import matplotlib
matplotlib.rcParams["font.size"] = 31
figure = fl.plot(maps, "swing")
print("matplotlib.pyplot" in sys.modules, matplotlib.rcParams["font.size"], figure.axes[0].xaxis.label.get_size())
"""


def test_without_matplotlib_every_door_has_the_remedy_and_with_it_its_state_is_left_as_it_was(folder):
    done = subprocess.run([sys.executable, "-c", DOORS], capture_output=True, text=True, check=False)
    *doors, dxf, _, svg, plot, draw, explore, state = done.stdout.splitlines()
    assert all(remedy == "matplotlib" for remedy in doors), done.stderr
    assert (len(doors), plot, draw, explore) == (7, "2", "2", "2")
    assert state == "False 31.0 10.0"
    assert (dxf, svg) == ("b.dxf", "None")
    assert Path("b.dxf").read_text().startswith("  0\nSECTION")
    assert Path("b.mm.svg").read_text().startswith("<svg")


@pytest.mark.parametrize(
    ("symbol", "text"),
    [
        ("theta_1 at max omega_4", r"$\theta_{1}$ at max $\omega_{4}$"),
        ("max |F|", "max $|F|$"),
        ("G_1u", "$G_{1u}$"),
        ("mu", r"$\mu$"),
        ("1/(2 a_1)", "1/(2 $a_{1})$"),
    ],
)
def test_symbols_are_set_as_mathematics(symbol, text):
    assert mathematical(symbol) == text


def plot(name="omega4_max", **options):
    return lambda maps: fl.plot(maps.assign(note=("a1", list("abcd"))), name, **options)


def designs(names=(*NAMES,), **options):
    return lambda maps: fl.plot(maps, names if isinstance(names, (str, int)) else list(names), **options)


@pytest.mark.parametrize(
    ("draw", "key", "remedy"),
    [
        (plot("omega_max"), "names", "did you mean 'omega4_max'?"),
        (plot(None), "names", "did you mean"),
        (plot("note"), "numbers", "numbers"),
        (plot("a1"), "names", "known"),
        (
            plot(),
            "plot: omega4_max",
            "fix one of them by at={'a4': 1.0}, or show some values side by side by panels",
        ),
        (plot(at={"a5": 1.0}), "at: 'a5'", "known: a1, a2, a4"),
        (plot(at={"branch": 1}), "at: 'branch'", "choose one by branch=1"),
        (plot(at={"a4": 1.2}), "at: a4", "a number from 0.9 to 1"),
        (plot(at={"a4": "1"}), "at: a4", "a finite number"),
        (plot(at={"a4": np.inf}), "at: a4", "a finite number"),
        (plot(at=[("a1", 0.2)]), "at", "such as"),
        (plot(at={3: 0.2}), "at", "known"),
        (plot(branch=3), "branch", "one of 1, 2"),
        (plot(branch=True), "branch", "write one of"),
        (plot("status", branch=1), "status", "leave it out"),
        (plot(panels="a9"), "panels", "a1, a2, a4"),
        (plot(panels=3), "panels", "known"),
        (plot(lines="a1"), "lines", "panels"),
        (plot(panels="a1", at={"a2": 0.9}), "panels", "lines"),
        (plot(panels="a1", at={"a1": 0.2}), "panels", "leave"),
        (plot(panels="a1", lines="a2"), "lines", "leave"),
        (plot(at={"a4": 1.0}, to="no/map.png"), "no", "create it or choose another"),
        (plot(at={"a4": 1.0}, to="folder.png"), "folder.png is a folder", "add a file name"),
        (lambda maps: fl.plot(maps.isel(a1=[], a4=0), "omega4_max"), "a1", "at least one"),
        (lambda maps: fl.plot(maps.isel(a1=0, a2=0, a4=0), "omega4_max"), "omega4_max", "leave one free"),
        (lambda maps: fl.plot(None, "omega4_max"), "maps", "give"),
        (lambda maps: fl.plot(maps.omega4_max, "omega4_max"), "maps", "give"),
        (lambda maps: fl.plot(maps.drop_attrs(), "omega4_max"), "maps", "give"),
        (designs([]), "names", "omega4_max"),
        (designs(3), "names", "omega4_max"),
        (designs(["omega4_mxa", "a1"]), "names", "did you mean 'omega4_max'"),
        (designs(["a1", "a3"]), "names", "an input, that has several"),
        (designs(["a1", "a1"]), "names", "once"),
        (designs("a1", kind="scatter"), "names", "2 to 3"),
        (designs(kind="scater"), "kind", "did you mean 'scatter'"),
        (designs(where={"a2": (9.0, None)}), "omega4_max", "fewer conditions"),
        (designs(where={"a2": "x"}), "a2", "None"),
        (designs(branch=3), "branch", "1"),
        (lambda maps: fl.plot(maps, minimise="omega4_max"), "plot", "rank by `best`"),
        (lambda maps: fl.plot(maps), "names", "minimise"),
        (plot(minimise="a1"), "names", "or the objectives"),
        (designs([], kind="corner", minimise="a1"), "kind", "or the objectives"),
        (designs(at={"a4": 1.0}), "at", "where={'status': 'rotates_fully'}"),
        (designs([], minimise=["a1", "omega4_max"], panels="a4"), "panels", "where={'status':"),
    ],
)
def test_requests_without_sense_are_refused(maps, draw, key, remedy, folder):
    (folder / "folder.png").mkdir()
    with refused(key, remedy):
        draw(maps)
