"""Pictures of maps that users have changed, and of values that are hard to draw."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.pictures.test_plot import bar, legend, panels
from tests.support.refusals import refused

import fastlink as fl
from fastlink.pictures.style import WITHOUT_BOUND


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("maps") / "maps.h5"
    space = fl.grid(a1=[0.2, 0.5, 1.0, 3.0], a2=np.linspace(0.3, 1.5, 5), a3=0.8, a4=1.0, omega1=25.0)
    fl.sweep("planar_4r", space, ["omega4_max", "theta4"], theta1=8, to=path, verify=0).close()
    return path


@pytest.fixture(scope="module")
def maps(path):
    with fl.open(path) as opened:
        return opened.load()


def drawn(maps, name, **options):
    """Draw all of a picture, text too."""
    figure = fl.plot_map(maps, name, **options)
    figure.draw_without_rendering()
    return figure


def test_a_path_is_as_good_as_a_map(path, maps):
    of_path, of_map = drawn(path, "omega4_max"), drawn(maps, "omega4_max")
    cells = [panels(figure)[0].collections[0].get_array() for figure in (of_path, of_map)]
    assert_array_equal(*cells)
    for thing in (None, 3, maps.omega4_max, maps.drop_attrs()):
        with refused("maps", "give"):
            fl.plot_map(thing, "omega4_max")


# -- degrees ---------------------------------------------------------------------------------------


def test_angles_in_degrees_along_axes_and_in_colours(maps):
    figure = drawn(maps, "theta4", branch=2, at={"theta1": 91.0}, degrees=True)
    assert figure.get_suptitle().endswith(r"$\theta_{1}$ = 90°")
    assert bar(figure).get_ylabel().endswith("[°]")
    cells = panels(figure)[0].collections[0].get_array().filled(np.nan)
    expected = np.rad2deg(maps.theta4.isel(branch=1, theta1=2).transpose("a2", "a1"))
    assert_array_equal(cells, expected)
    curve = drawn(maps, "theta4", branch=1, at={"a1": 0.2, "a2": 0.9}, degrees=True).axes[0]
    assert_allclose(curve.get_xlim(), (0.0, 360.0))
    assert [text.get_text() for text in curve.get_xticklabels()] == ["0", "90", "180", "270", "360"]
    with refused("theta1", "315"):
        fl.plot_map(maps, "theta4", at={"theta1": 400.0}, degrees=True)


def test_an_angle_in_degrees_is_cut_and_coloured_as_in_radians(maps):
    space = fl.grid(a1=1.2, a2=np.linspace(1.0, 2.0, 6), a3=0.8, a4=1.0)
    wide = fl.sweep("planar_4r", space, ["theta4"], theta1=40)
    (axes,) = panels(drawn(wide, "theta4", branch=2, degrees=True))
    assert axes.collections[0].get_cmap().name == "twilight_shifted"
    assert axes.collections[0].get_clim() == (-180.0, 180.0)
    lines = [
        drawn(wide, "theta4", branch=2, at={"a2": 1.0}, degrees=degrees).axes[0].get_lines()[0].get_ydata()
        for degrees in (False, True)
    ]
    assert np.isnan(lines[0]).any()
    assert_allclose(lines[1], np.rad2deg(lines[0]), rtol=4e-16)


def test_a_map_that_is_in_degrees_already_stays(maps):
    in_degrees = maps.fastlink.degrees()
    for degrees in (False, True):
        figure = drawn(in_degrees, "theta4", branch=2, at={"theta1": 90.0}, degrees=degrees)
        assert bar(figure).get_ylabel().endswith("[°]")


# -- what users make of maps -----------------------------------------------------------------------

CHANGES = {
    "one mode": lambda maps: maps.isel(branch=0),
    "mean": lambda maps: maps.mean("a2", keep_attrs=True),
    "without coordinates": lambda maps: maps.drop_vars(["a1", "a2", "branch", "theta1", "a3"]),
    "without status": lambda maps: maps.drop_vars("status"),
    "stacked": lambda maps: maps.stack(all=("a1", "a2")),
    "renamed": lambda maps: maps.rename(a1="crank", branch="mode", status="state"),
    "named designs": lambda maps: maps.assign_coords(a1=["a_$", "b$^2$", "x" * 99, ""], maker="someone"),
    "dates": lambda maps: maps.assign_coords(a1=np.array(["2020", "2021", "2022", "2023"], "M8[D]")),
    "equal coordinates": lambda maps: maps.assign_coords(a1=[1.0, 1.0, 2.0, 2.0]),
    "infinite coordinates": lambda maps: maps.assign_coords(a1=[1.0, np.nan, np.inf, 2.0]),
    "no labels": lambda maps: maps.map(lambda array: array.drop_attrs(), keep_attrs=False).assign_attrs(
        maps.attrs
    ),
    "damaged codes": lambda maps: maps.assign(status=maps.status.assign_attrs(flag_meanings="one two")),
    "single precision": lambda maps: maps.astype("f4"),
    "one of each": lambda maps: maps.isel(a1=[1], theta1=[2]),
    "transposed": lambda maps: maps.transpose("theta1", "branch", "a2", "a1"),
    "in slices": lambda maps: maps.isel(a1=slice(None, None, -1), a2=slice(0, 2)),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_whatever_became_of_a_map_is_drawn(maps, change):
    changed = change(maps.isel(branch=[0]))
    if "mode" in changed.dims:  # no assembly modes any more, but one dimension too many
        assert fl.plot_map(changed, "state")
        changed = changed.isel(mode=0)
    assert fl.plot_map(changed, "omega4_max")


def test_the_text_of_strange_labels_is_shown_as_it_is(maps):
    strange = maps.assign_attrs(maps.attrs).assign_coords(a1=["a_$", "b$^2$", "x" * 99, ""])
    strange["omega4_max"] = strange.omega4_max.assign_attrs(long_name="100 $", units=3, symbol="$x_")
    figure = drawn(strange, "omega4_max", branch=1)
    assert figure.get_suptitle() == r"100 \$"


def test_names_of_designs_stand_along_the_axis(maps):
    named = maps.assign_coords(a1=["north", "east", "south", "west"])
    (axes,) = panels(drawn(named, "omega4_max", branch=1))
    assert [text.get_text() for text in axes.get_xticklabels()] == ["north", "east", "south", "west"]
    cells = axes.collections[0].get_array().filled(np.nan)
    values = maps.omega4_max.isel(branch=0).transpose("a2", "a1").values
    assert_array_equal(cells, np.where(np.isfinite(values), values, np.nan))
    line = drawn(named, "omega4_max", branch=1, at={"a2": 0.9}).axes[0]
    assert [text.get_text() for text in line.get_xticklabels()] == ["north", "east", "south", "west"]
    with refused("a1", "isel"):
        fl.plot_map(named, "omega4_max", at={"a1": 1.0})


def test_the_status_of_equal_coordinates_is_that_of_the_cell(maps):
    changed = maps.assign_coords(a1=[2.0, 1.0, 2.0, 1.0])
    before = legend(drawn(maps, "omega4_max", branch=1))
    assert legend(drawn(changed, "omega4_max", branch=1)) == before


def test_a_map_of_one_mode_has_that_mode(maps):
    space = fl.grid(a1=[0.2, 0.5], a2=[1.1, 1.2], a3=0.8, a4=1.0, omega1=25.0)
    one = fl.sweep("planar_4r", space, ["omega4_max"], branch=2)
    assert "branch" not in one.dims
    for options in ({}, {"branch": 2}):
        assert panels(drawn(one, "omega4_max", **options))[0].get_title() == "assembly mode 2"
    with refused("branch", "2"):
        fl.plot_map(one, "omega4_max", branch=1)
    for wrong in (True, 1.5, "1", [1], np.array([1, 2])):
        with refused("branch", "write one of"):
            fl.plot_map(maps, "omega4_max", branch=wrong)


@pytest.mark.parametrize(
    ("name", "options", "key", "remedy"),
    [
        (None, {}, "name", "did you mean"),
        (["omega4_max"], {}, "name", "omega4_max"),
        ("note", {}, "numbers", "numbers"),
        ("imaginary", {}, "numbers", "numbers"),
        ("a1", {}, "name", "known"),
        ("omega4_max", {"at": [("a1", 0.2)]}, "at", "such as"),
        ("omega4_max", {"at": {3: 0.2}}, "at", "known"),
        ("omega4_max", {"at": {"a1": None}}, "at", "finite"),
        ("omega4_max", {"at": {"a1": np.array([1.0, 2.0])}}, "at", "finite"),
    ],
)
def test_requests_without_sense_are_refused(maps, name, options, key, remedy):
    more = maps.assign(note=("a1", list("abcd")), imaginary=maps.omega4_max * 1j)
    with refused(key, remedy):
        fl.plot_map(more, name, **options)


def test_what_is_empty_is_refused(maps):
    with refused("a1", "at least one"):
        fl.plot_map(maps.isel(a1=[]), "omega4_max")
    with refused("omega4_max", "leave one free"):
        fl.plot_map(maps.isel(a1=0, a2=0), "omega4_max")


# -- values ----------------------------------------------------------------------------------------

VALUES = {
    "all infinite": lambda values: np.full_like(values, np.inf),
    "both infinities": lambda values: np.where(
        np.arange(values.size).reshape(values.shape) % 2, np.inf, -np.inf
    ),
    "all NaN": lambda values: np.full_like(values, np.nan),
    "equal": lambda values: np.full_like(values, 3.7),
    "zero": np.zeros_like,
    "huge": lambda values: np.linspace(-1.0, 1.0, values.size).reshape(values.shape) * 1.7e308,
    "huge and positive": lambda values: np.geomspace(1e-300, 1.7e308, values.size).reshape(values.shape),
    "tiny": lambda values: np.geomspace(5e-324, 1e-310, values.size).reshape(values.shape),
    "one finite": lambda values: np.where(np.arange(values.size).reshape(values.shape) == 7, 1.0, np.inf),
    "close together": lambda values: np.linspace(1.0, 1.0 + 1e-15, values.size).reshape(values.shape),
    "counts and one huge": lambda values: np.where(values > 0, 1.0, 1e308),
}


@pytest.mark.sample(3)
@pytest.mark.parametrize("values", VALUES.values(), ids=VALUES)
def test_any_values_are_drawn(maps, values):
    changed = maps.assign(omega4_max=maps.omega4_max.copy(data=values(maps.omega4_max.values)))
    figure = drawn(changed, "omega4_max", branch=1)
    infinite = np.isinf(changed.omega4_max.isel(branch=0).values).any()
    assert (WITHOUT_BOUND in legend(figure)) == infinite
    assert fl.plot_map(changed, "omega4_max", branch=1, at={"a1": 0.2})
