"""Pictures of three inputs: grids of maps, lines; and quantities that are the same everywhere."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.pictures.test_plot import bar, finite, legend, panels
from tests.support.refusals import refused

import fastlink as fl

A1, A2, A3 = np.linspace(0.2, 0.9, 8), np.linspace(0.6, 1.4, 5), [0.7, 0.8, 0.9]


@pytest.fixture(scope="module")
def maps():
    space = fl.grid(a1=A1, a2=A2, a3=A3, a4=1.0, omega1=25.0)
    return fl.sweep("planar_4r", space, ["omega4_max", "theta1_at_omega4_max", "grashof_class"], verify=0)


def test_a_grid_has_a_map_for_values_over_the_whole_input(maps):
    figure = fl.plot_map(maps, "omega4_max", panels="a1", branch=1)
    axes = panels(figure)
    shown = A1[[0, 1, 3, 4, 6, 7]]  # at most six of the eight, the first and the last among them
    assert [axis.get_title() for axis in axes] == [f"$a_{{1}}$ = {value:.3g} m" for value in shown]
    limits = {axis.collections[0].get_clim() for axis in axes}
    assert len(limits) == 1  # one scale of colours
    assert bar(figure).get_ylabel() == r"max $\omega_{4}$ [rad s$^{-1}$]"
    for axis, value in zip(axes, shown, strict=True):
        expected = maps.omega4_max.sel(branch=1, a1=value).transpose("a3", "a2").values
        cells = axis.collections[0].get_array().filled(np.nan)
        low, high = np.nanmin(finite(expected)), np.nanmax(finite(expected))
        assert_array_equal(np.isnan(cells), ~np.isfinite(expected))
        assert np.nanmin(cells) >= low
        assert np.nanmax(cells) <= high
    # only the outer panels are labelled
    assert [bool(axis.get_xlabel()) for axis in axes] == [False] * 3 + [True] * 3
    assert [bool(axis.get_ylabel()) for axis in axes] == [True, False, False] * 2


def test_assembly_modes_that_differ_have_a_row_each(maps):
    axes = panels(fl.plot_map(maps, "theta1_at_omega4_max", panels="a1"))
    assert [axis.get_title().partition(",")[0] for axis in axes] == ["assembly mode 1"] * 3 + [
        "assembly mode 2"
    ] * 3
    figure = fl.plot_map(maps, "omega4_max", panels="a1")
    assert len(panels(figure)) == 6
    assert figure.get_suptitle().endswith("assembly modes 1 and 2 (they agree)")


def test_the_status_of_each_panel_is_its_own(maps):
    axes = panels(fl.plot_map(maps, "omega4_max", panels="a1", branch=1))
    partial = maps.status.sel(a1=A1[-1]).values != 0
    assert partial.any()
    assert (maps.status.sel(a1=A1[0]).values == 0).any()
    assert any(
        "without bound" in text.get_text()
        for axis in axes
        if axis.get_legend()
        for text in axis.get_legend().get_texts()
    )


def test_codes_over_a_third_input(maps):
    figure = fl.plot_map(maps, "grashof_class", panels="a3")
    assert len(panels(figure)) == 3
    words = [text.get_text() for text in panels(figure)[-1].get_legend().get_texts()]
    assert "crank rocker" in words


def test_a_line_for_each_value_of_an_input(maps):
    figure = fl.plot_map(maps, "omega4_max", lines="a1", at={"a3": 0.8}, branch=2)
    (axis,) = panels(figure)
    lines = axis.get_lines()
    assert len(lines) == 6
    assert len({line.get_color() for line in lines}) == 6
    values = maps.omega4_max.sel(branch=2, a1=A1[0]).sel(a3=0.8, method="nearest").values
    shown = lines[0].get_ydata()
    assert_array_equal(shown[np.isfinite(shown)], values[np.isfinite(values)])
    assert legend(figure)[0] == "$a_{1}$ = 0.2 m"
    both = fl.plot_map(maps, "theta1_at_omega4_max", lines="a1", at={"a3": 0.8})
    assert {line.get_linestyle() for line in panels(both)[0].get_lines()} == {"-", "--"}


@pytest.mark.parametrize(
    ("options", "key", "remedy"),
    [
        ({"panels": "a9"}, "panels", "did you mean"),
        ({"panels": 3}, "panels", "did you mean"),
        ({"lines": "a1"}, "lines", "panels"),
        ({"panels": "a1", "at": {"a3": 0.8}}, "panels", "lines"),
        ({"panels": "a1", "at": {"a1": 0.2}}, "panels", "leave"),
        ({"panels": "a1", "lines": "a2"}, "lines", "leave"),
        ({}, "omega4_max", "panels"),
    ],
)
def test_requests_that_do_not_fit_are_refused(maps, options, key, remedy):
    with refused(key, remedy):
        fl.plot_map(maps, "omega4_max", branch=1, **options)


# -- the same everywhere ---------------------------------------------------------------------------


def text_of(figure):
    return " ".join(text.get_text().replace("\n", " ") for axis in panels(figure) for text in axis.texts)


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda values: np.full_like(values, 1.25), "1.25 rad s$^{-1}$ everywhere"),
        (
            lambda values: np.where(np.isnan(values), np.nan, 1.25),
            "1.25 rad s$^{-1}$ wherever it has a value",
        ),
        (lambda values: np.full_like(values, np.inf), "grows without bound everywhere"),
        (lambda values: np.full_like(values, np.nan), "no value anywhere"),
        (lambda values: 1.25 * (1.0 + 2.0**-52 * (np.arange(values.size).reshape(values.shape) % 3)), "1.25"),
    ],
)
def test_a_quantity_that_is_the_same_everywhere_says_so(maps, make, text):
    holes = maps.omega4_max.copy(deep=True)
    holes[0, 0] = np.nan
    same = maps.assign(omega4_max=holes.copy(data=make(holes.values)))
    figure = fl.plot_map(same, "omega4_max", at={"a1": 0.2})
    assert text in text_of(figure)
    assert not [axes for axes in figure.axes if axes.get_label() == "<colorbar>"]


def test_a_quantity_that_varies_says_nothing(maps):
    figure = fl.plot_map(maps, "omega4_max", at={"a1": 0.2})
    assert "everywhere" not in text_of(figure)
    assert bar(figure)


def test_a_line_that_is_the_same_everywhere_says_so(maps):
    same = maps.assign(omega4_max=maps.omega4_max.copy(data=np.full(maps.omega4_max.shape, 2.5)))
    (axis,) = panels(fl.plot_map(same, "omega4_max", at={"a1": 0.2, "a2": 0.8}))
    assert axis.get_title() == "2.5 rad s$^{-1}$ everywhere"
    low, high = axis.get_ylim()
    assert low < 2.5 < high


def test_a_notebook_shows_a_figure(maps):
    figure = fl.plot_map(maps, "omega4_max", at={"a1": 0.2})
    assert figure._repr_png_().startswith(b"\x89PNG")
