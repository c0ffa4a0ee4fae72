"""Pictures: what is drawn where, and what cannot be drawn."""

import doctest
import importlib
import subprocess
import sys

import matplotlib as mpl
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.refusals import refused

import fastlink as fl
from fastlink.pictures.labels import mathematical
from fastlink.pictures.style import ABSENT, WITHOUT_BOUND, limits_of

BARS = fl.round_bar(7750.0, 0.01)


@pytest.fixture(scope="module")
def maps():
    """Designs of every status, in three dimensions."""
    space = fl.grid(a1=[0.2, 0.5, 1.0, 3.0], a2=np.linspace(0.3, 1.5, 5), a3=0.8, a4=[0.9, 1.0], omega1=25.0)
    return fl.sweep("planar_4r", space, ["omega4_max", "omega4_min", "theta1_at_omega4_max"], links=BARS)


@pytest.fixture(scope="module")
def curves():
    """One design that assembles over part of the turn."""
    space = fl.grid(a1=1.2, a2=1.3, a3=0.8, a4=1.0, omega1=25.0)
    return fl.sweep("planar_4r", space, ["omega4", "theta4", "omega4_max", "A_x"], theta1=90)


def panels(figure):
    return [axes for axes in figure.axes if axes.get_label() != "<colorbar>"]


def bar(figure):
    (axes,) = [axes for axes in figure.axes if axes.get_label() == "<colorbar>"]
    return axes


def legend(figure):
    found = panels(figure)[0].get_legend()
    return [] if found is None else [text.get_text() for text in found.get_texts()]


# -- maps ------------------------------------------------------------------------------------------


def finite(values):
    """Return values with NaN for those that are not finite, as a map's cells have them."""
    return np.where(np.isfinite(values), values, np.nan)


def test_a_map_shows_the_values_where_they_belong(maps):
    figure = fl.plot_map(maps, "omega4_max", branch=2, at={"a4": 1.0})
    (axes,) = panels(figure)
    mesh = axes.collections[0]
    expected = maps["omega4_max"].sel(branch=2, a4=1.0).transpose("a2", "a1").values
    assert_array_equal(mesh.get_array().filled(np.nan), finite(expected))
    corners = mesh.get_coordinates()
    assert_allclose(corners[0, 1:3, 0], [0.35, 0.75])  # half-way between the values of a1
    assert axes.get_xlabel() == "length of the input crank OA $a_{1}$ [m]"
    assert axes.get_ylabel() == "length of the coupler AB $a_{2}$ [m]"
    assert bar(figure).get_ylabel() == r"max $\omega_{4}$ [rad s$^{-1}$]"
    assert axes.get_title() == "assembly mode 2"
    assert figure.get_suptitle().endswith("greatest over the cycle\n$a_{4}$ = 1 m")
    assert "$a_{3}$ = 0.8 m" in figure.get_supxlabel()


def test_what_does_not_assemble_is_grey_and_in_the_legend(maps):
    assert np.isnan(maps["omega4_max"].sel(a4=1.0)).any()
    figure = fl.plot_map(maps, "omega4_max", at={"a4": 1.0})
    (axes,) = panels(figure)
    assert axes.get_facecolor() == mpl.colors.to_rgba(ABSENT)
    short_repr = maps["omega4_max"].sel(branch=1, a4=1.0).T
    assert_array_equal(axes.collections[0].get_array().mask, ~np.isfinite(short_repr))
    assert any("does not assemble" in text for text in legend(figure))
    assert not any("never" in text for text in legend(figure))


def test_designs_that_do_not_turn_fully_are_veiled_and_named():
    space = fl.grid(a1=[0.5, 1.0, 1.5], a2=np.linspace(0.9, 1.5, 5), a3=0.8, a4=1.0)
    figure = fl.plot_map(fl.sweep("planar_4r", space, ["transmission_angle_max"]), "transmission_angle_max")
    assert any("assembles over part of the turn" in text for text in legend(figure))


def test_what_grows_without_bound_is_marked(maps):
    short_repr = maps["omega4_max"].sel(branch=1, a4=1.0).T
    assert np.isposinf(short_repr).any()
    figure = fl.plot_map(maps, "omega4_max", at={"a4": 1.0})
    cells = panels(figure)[0].collections[1].get_array()
    assert_array_equal(cells.filled(False), np.isinf(short_repr))
    assert WITHOUT_BOUND in legend(figure)
    line = fl.plot_map(maps, "omega4_max", branch=1, at={"a4": 1.0, "a2": float(maps.a2[0])})
    assert WITHOUT_BOUND in [text.get_text() for text in line.axes[0].get_legend().get_texts()]


def test_gaps_along_a_sample_are_one_shape_however_many_they_are():
    space = fl.sobol(512, a1=(0.05, 2.0), a2=(0.05, 2.0), a3=(0.05, 2.0), a4=1.0, omega1=1.0)
    sample = fl.sweep("planar_4r", space, ["omega4_max"], branch=1)
    (axis,) = fl.plot_map(sample, "omega4_max").axes
    values = sample.omega4_max.values
    for shape, gaps in zip(axis.collections, (np.isnan(values), np.isposinf(values)), strict=True):
        shaded = np.zeros(512, dtype=bool)
        for path in shape.get_paths():
            low, high = path.get_extents().intervalx
            inside = np.arange(512)
            shaded |= (inside > low - 1e-9) & (inside < high + 1e-9)
        assert_array_equal(shaded, gaps)
        assert len(shape.get_paths()) > 20


def test_designs_that_assemble_without_a_value_are_not_called_unassembled():
    space = fl.grid(a1=[0.4, 0.9], a2=[1.1, 1.2], a3=0.8, a4=1.0)
    figure = fl.plot_map(fl.sweep("planar_4r", space, ["time_ratio"]), "time_ratio")
    assert "has no value" in legend(figure)
    assert "does not assemble" not in legend(figure)


def test_where_everything_turns_there_is_no_legend():
    space = fl.grid(a1=[0.2, 0.3], a2=1.2, a3=[0.7, 0.8], a4=1.0)
    figure = fl.plot_map(fl.sweep("planar_4r", space, ["transmission_angle_min"]), "transmission_angle_min")
    assert legend(figure) == []


def test_modes_that_agree_are_one_panel_and_others_two(maps):
    assert len(panels(fl.plot_map(maps, "omega4_max", at={"a4": 1.0}))) == 1
    differ = fl.plot_map(maps, "theta1_at_omega4_max", at={"a4": 1.0})
    assert [axes.get_title() for axes in panels(differ)] == ["assembly mode 1", "assembly mode 2"]
    assert_array_equal(
        panels(differ)[1].collections[0].get_array().filled(np.nan),
        maps["theta1_at_omega4_max"].sel(branch=2, a4=1.0).T,
    )


def test_the_order_of_an_axis_does_not_matter(maps):
    shuffled = maps.isel(a1=[2, 0, 3, 1])
    for dataset in (maps, shuffled):
        figure = fl.plot_map(dataset, "omega4_max", branch=1, at={"a4": 0.9})
        values = panels(figure)[0].collections[0].get_array().filled(np.nan)
        assert_array_equal(values, finite(maps["omega4_max"].sel(branch=1, a4=0.9).T))


def test_a_dimension_is_fixed_at_the_nearest_value(maps):
    figure = fl.plot_map(maps, "omega4_max", branch=1, at={"a4": 0.94})
    assert figure.get_suptitle().endswith("$a_{4}$ = 0.9 m")


def test_a_code_has_a_colour_for_each_value(maps):
    figure = fl.plot_map(maps, "status", at={"a4": 1.0})
    meanings = maps["status"].attrs["flag_meanings"].split()
    present = [meanings[code].replace("_", " ") for code in np.unique(maps["status"].sel(a4=1.0))]
    assert len(present) >= 3
    assert legend(figure) == present
    assert len(figure.axes) == 1


@pytest.fixture(scope="module")
def types():
    """Minkowskian linkages of many types."""
    lengths = np.linspace(0.125, 4.0, 32)
    names = ["linkage_type", "assembly_count_future", "theta_max", "status"]
    return fl.sweep("minkowski_4r", fl.grid(a=lengths, b=lengths, g=1.0, h=1.0), names)


def test_a_code_of_many_values_has_a_legend_beside_the_axes(types):
    figure = fl.plot_map(types, "linkage_type")
    codes = types["linkage_type"].attrs["flag_values"].tolist()
    meanings = types["linkage_type"].attrs["flag_meanings"].split()
    present = [meanings[codes.index(code)].replace("_", " ") for code in np.unique(types["linkage_type"])]
    assert len(present) >= 8
    assert [label.replace("\n", " ") for label in legend(figure)] == present
    (axes,) = panels(figure)
    # Codes with gaps between them: each has a colour of its own, the one that the legend shows.
    short_repr = axes.collections[0]
    patches = dict(zip(present, axes.get_legend().get_patches(), strict=True))
    for code, name in zip(np.unique(types["linkage_type"]), present, strict=True):
        (place,) = np.unique(short_repr.get_array()[code == types["linkage_type"].values.T])
        np.testing.assert_allclose(short_repr.cmap(short_repr.norm(place)), patches[name].get_facecolor())
    assert len({patch.get_facecolor() for patch in patches.values()}) == len(present)
    figure.draw_without_rendering()
    assert axes.get_legend().get_window_extent().x0 >= axes.get_window_extent().x1
    assert axes.get_window_extent().height > 0.7 * figure.bbox.height


def test_an_orientation_has_its_colours_though_it_is_negative():
    space = fl.grid(a=1.0, b=1.0, g=np.linspace(1.0, 4.0, 5), h=1.0)
    figure = fl.plot_map(fl.sweep("minkowski_4r", space, ["CB_orientation"]), "CB_orientation", branch=1)
    (axes,) = panels(figure)
    assert set(legend(figure)) <= {"past pointing", "none", "future pointing"}
    assert set(np.unique(axes.collections[0].get_array().compressed())) <= {0.0, 1.0, 2.0}


def test_a_count_has_steps_and_no_contours(types):
    figure = fl.plot_map(types, "assembly_count_future")
    (axes,) = panels(figure)
    assert len(axes.collections) == 1
    assert_array_equal(axes.collections[0].get_clim(), (0.5, 3.5))
    assert legend(figure) == []


def test_no_veil_covers_all_that_there_is(types):
    """theta_max is where a design assembles over part of theta only."""
    assert legend(fl.plot_map(types, "theta_max")) == ["has no value"]


def test_a_map_over_the_input_angle():
    space = fl.grid(a1=1.2, a2=np.linspace(1.0, 2.0, 6), a3=0.8, a4=1.0)
    figure = fl.plot_map(fl.sweep("planar_4r", space, ["theta4"], theta1=40), "theta4", branch=2)
    (axes,) = panels(figure)
    assert axes.get_ylabel().endswith(r"$\theta_{1}$ [rad]")
    # an angle that passes from pi to -pi has a cyclic map
    assert axes.collections[0].get_cmap().name == "twilight_shifted"
    assert axes.collections[0].get_clim() == (-np.pi, np.pi)


def test_a_map_of_nothing_but_nan():
    space = fl.grid(a1=[5.0, 6.0], a2=[0.2, 0.3], a3=0.8, a4=1.0)
    maps = fl.sweep("planar_4r", space, ["transmission_angle_min"])
    assert np.isnan(maps["transmission_angle_min"]).all()
    assert legend(fl.plot_map(maps, "transmission_angle_min")) == ["does not assemble"]


def test_very_large_maps_are_thinned():
    space = fl.grid(a1=np.linspace(0.1, 0.3, 4000), a2=[1.1, 1.2], a3=0.8, a4=1.0)
    figure = fl.plot_map(fl.sweep("planar_4r", space, ["status"]), "status")
    assert panels(figure)[0].collections[0].get_array().shape == (2, 1334)


def test_a_few_outliers_do_not_use_up_the_colours():
    values = np.concatenate((np.linspace(1.0, 2.0, 100), [1e6]))
    low, high, extend = limits_of(values, values, 2.0)
    assert low == 1.0
    assert 1.9 < high < 2.2
    assert extend == "max"
    assert limits_of(values[:-1], values[:-1], 2.0) == (1.0, 2.0, "neither")
    assert limits_of(np.ones(3), np.ones(3), 2.0) == (0.5, 1.5, "neither")


# -- lines -----------------------------------------------------------------------------------------


def test_curves_are_a_line_for_each_mode(curves):
    figure = fl.plot_map(curves, "omega4")
    (axes,) = figure.axes
    assert legend(figure) == ["assembly mode 1", "assembly mode 2", "does not assemble"]
    for branch, line in zip((1, 2), axes.get_lines(), strict=True):
        assert_array_equal(line.get_ydata(), curves["omega4"].sel(branch=branch))
        assert_array_equal(line.get_xdata(), curves["theta1"])
    assert [text.get_text() for text in axes.get_xticklabels()][2] == r"$\pi$"


def test_one_mode_is_one_line(curves):
    figure = fl.plot_map(curves, "omega4", branch=2)
    (line,) = figure.axes[0].get_lines()
    assert_array_equal(line.get_ydata(), curves["omega4"].sel(branch=2))


def test_an_angle_is_cut_where_it_passes_pi(curves):
    values = curves["theta4"].sel(branch=1).values
    jumps = int((np.abs(np.diff(values)) > np.pi).sum())
    assert jumps > 0
    (line,) = fl.plot_map(curves, "theta4", branch=1).axes[0].get_lines()
    drawn = line.get_ydata()
    assert np.isnan(drawn).sum() == np.isnan(values).sum() + jumps
    assert_array_equal(drawn[np.isfinite(drawn)], values[np.isfinite(values)])


def test_a_line_over_a_swept_input(maps):
    figure = fl.plot_map(maps, "omega4_max", branch=1, at={"a4": 1.0, "a1": 0.2})
    (line,) = figure.axes[0].get_lines()
    assert_array_equal(line.get_ydata(), maps["omega4_max"].sel(branch=1, a4=1.0, a1=0.2))


def test_designs_of_a_sample_are_points():
    space = fl.sobol(16, seed=1, a1=(0.2, 0.4), a2=1.2, a3=0.8, a4=1.0)
    figure = fl.plot_map(fl.sweep("planar_4r", space, ["transmission_angle_min"]), "transmission_angle_min")
    (line,) = figure.axes[0].get_lines()
    assert line.get_linestyle() == "None"
    assert len(line.get_xdata()) == 16


# -- files and state -------------------------------------------------------------------------------


@pytest.mark.parametrize(("ending", "start"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_the_ending_is_the_kind_of_picture(maps, tmp_path, ending, start):
    place = tmp_path / f"map.{ending}"
    for _ in range(2):  # the second replaces the first
        fl.plot_map(maps, "omega4_max", at={"a4": 1.0}, to=place)
        assert place.read_bytes().startswith(start)


def test_matplotlib_is_left_as_it_was(maps):
    script = (
        "import sys, matplotlib\n"
        "matplotlib.rcParams['font.size'] = 31\n"
        "import fastlink as fl\n"
        "space = fl.grid(a1=[0.2, 0.3], a2=1.2, a3=0.8, a4=1.0)\n"
        "maps = fl.sweep('planar_4r', space, ['status'])\n"
        "figure = fl.plot_map(maps, 'status')\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
        "assert matplotlib.rcParams['font.size'] == 31\n"
        "print(figure.axes[0].xaxis.label.get_size())\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert float(done.stdout) == 10.0


# -- what cannot be drawn --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "options", "key", "remedy"),
    [
        ("omega_max", {}, "name", "did you mean 'omega4_max'?"),
        (
            "omega4_max",
            {},
            "plot: omega4_max",
            "fix one of them by at={'a4': 1.0}",
        ),
        (
            "omega4_max",
            {"at": {"a5": 1.0}},
            "at: 'a5'",
            "did you mean 'a4'?",
        ),
        (
            "omega4_max",
            {"at": {"branch": 1}},
            "at: 'branch'",
            "an assembly mode by branch=1",
        ),
        (
            "omega4_max",
            {"at": {"a4": 1.2}},
            "at: a4",
            "a number from 0.9 to 1",
        ),
        ("omega4_max", {"at": {"a4": "1"}}, "at: a4", "a finite number"),
        ("omega4_max", {"at": {"a4": np.inf}}, "at: a4", "a finite number"),
        ("omega4_max", {"branch": 3}, "branch", "one of 1, 2"),
        ("status", {"branch": 1}, "status", "leave it out"),
        ("omega4_max", {"to": "map.h5"}, "map.h5", "png"),
        ("omega4_max", {"to": "map"}, "map", "png"),
    ],
)
def test_bad_input(maps, name, options, key, remedy):
    with refused(key, remedy):
        fl.plot_map(maps, name, **options)


def test_a_single_number_is_stated_instead_of_drawn(curves):
    with pytest.raises(fl.InputError) as caught:
        fl.plot_map(curves, "omega4_max", branch=1)
    value = float(curves["omega4_max"].sel(branch=1))
    assert str(caught.value).endswith(f"its value is {value:g}; leave one free")


def test_a_folder_that_does_not_exist(maps, tmp_path):
    with pytest.raises(fl.InputError, match=r"there is no folder .*; create it or choose another"):
        fl.plot_map(maps, "omega4_max", at={"a4": 1.0}, to=tmp_path / "no" / "map.png")


def test_a_picture_that_cannot_be_written(maps, tmp_path):
    (tmp_path / "map.png").mkdir()
    with refused("map.png is a folder", "add a file name"):
        fl.plot_map(maps, "omega4_max", at={"a4": 1.0}, to=tmp_path / "map.png")


WITHOUT = """
import sys
sys.modules["matplotlib"] = None  # as where it is not installed
import fastlink as fl
from fastlink.app.cli import app

maps = fl.sweep("planar_4r", fl.grid(a1=0.4, a2=[1.1, 1.2], a3=0.8, a4=1.0), ["swing"], verify=0, to="maps.h5")
design = {"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0}
doors = [
    lambda: fl.plot_map(maps, "swing"),
    lambda: fl.plot_designs(maps, ["swing", "a2"]),
    lambda: fl.plot_front(maps, minimise="swing", maximise="a2"),
    lambda: fl.draw("planar_4r", **design),
    lambda: fl.explore(maps, to="page.html"),
    lambda: maps.fastlink.plot("swing"),
    lambda: maps.fastlink.plot.designs(["swing", "a2"]),
]
for door in doors:
    try:
        door()
    except fl.InputError as error:
        print(str(error).partition("matplotlib is not installed; python -m pip install ")[2])
draw = "draw planar_4r a1=0.4 a2=1.1 a3=0.8 a4=1.0 --to b.png"
for line in ("plot maps.h5 swing --to a.png", draw, "explore maps.h5 --to c.html"):
    try:
        print(app(line.split(), standalone_mode=False))
    except SystemExit as done:
        print(done.code)
"""


def test_without_matplotlib_the_message_has_the_remedy_at_every_door(folder):
    done = subprocess.run([sys.executable, "-c", WITHOUT], capture_output=True, text=True, check=False)
    *doors, plot, draw, explore = done.stdout.splitlines()
    assert all(remedy.startswith("'fastlink-linkages[") for remedy in doors), done.stderr
    assert (len(doors), plot, draw, explore) == (7, "2", "2", "2")


@pytest.mark.parametrize(
    ("symbol", "text"),
    [
        ("a_1", "$a_{1}$"),
        ("theta_1 at max omega_4", r"$\theta_{1}$ at max $\omega_{4}$"),
        ("max |F|", "max $|F|$"),
        ("G_1u", "$G_{1u}$"),
        ("mu", r"$\mu$"),
        ("1/(2 a_1)", "1/(2 $a_{1})$"),
    ],
)
def test_symbols_are_set_as_mathematics(symbol, text):
    assert mathematical(symbol) == text


@pytest.mark.parametrize("name", ["pictures.maps", "pictures.labels"])
def test_the_examples_run(name):
    result = doctest.testmod(importlib.import_module(f"fastlink.{name}"))
    assert result.attempted > 0
    assert result.failed == 0
