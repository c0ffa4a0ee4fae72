"""Error against run time: the methods, their errors, the front, the file, the picture, bad input."""

import itertools

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from matplotlib.text import Text
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.app import accuracy as module
from fastlink.app.accuracy import draw, front
from fastlink.numerics.compensated import UNIT_ROUNDING

STUDY = """
mechanism = "planar_4r"
quantities = ["omega4_max", "transmission_angle", "omega4_max_error", "status"]
[design]
a1 = {linspace = [0.3, 0.5, 40]}
a2 = 1.2
a3 = 0.8
a4 = 1.0
omega1 = 25.0
"""
# Of a curve as of an extreme: what tests/mechanisms/test_precision.py allows, times a condition number of at most 100.
SMALL = 400 * UNIT_ROUNDING


@pytest.fixture(scope="module", autouse=True)
def few_rounds():
    """Time each method for a moment only: no test is about how long it takes."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "MOST_ROUNDS", 2)
        patch.setattr(module, "SECONDS", 1e-4)
        yield


@pytest.fixture(scope="module")
def folder_of_study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("accuracy")
    (folder / "study.toml").write_text(STUDY)
    return folder


@pytest.fixture(scope="module")
def measured(folder_of_study):
    return fl.accuracy(
        folder_of_study / "study.toml",
        designs=6,
        outside=True,
        to=folder_of_study / "accuracy.h5",
        picture=folder_of_study / "accuracy.png",
    )


def errors(measured, quantity):
    found = measured["error_max"].sel(quantity=quantity).dropna("way")
    return {str(name): float(found.sel(way=name)) for name in found["way"].values}


def test_every_method_is_as_accurate_as_it_can_be(measured):
    found = errors(measured, "omega4_max")
    assert found["refined"] < SMALL
    # a maximum at most half a step away: error of the second order in the step, so 128 steps for 1 are 1/16384
    assert found["4096 angles"] < found["32 angles"] / 1000
    assert 1e-9 < found["4096 angles"] < found["360 angles"] < found["32 angles"] < 0.1
    curves = errors(measured, "transmission_angle")
    assert set(curves) == {"eliminated", "NumPy"}
    assert curves["eliminated"] < SMALL
    assert curves["NumPy"] < SMALL


def test_what_is_written_of_each(measured, folder_of_study):
    assert measured.sizes == {"way": measured.sizes["way"], "quantity": 2}
    assert measured.attrs["designs"] == 6
    assert "a1 = {linspace" in measured.attrs["study"]
    one = measured.sel(way="refined", quantity="omega4_max")
    assert one["values"] == 6
    assert one["missed"] == 0
    assert one["ns_per_design"] > 0
    assert one["error_median"] <= one["error_99"] <= one["error_max"]
    assert np.isnan(measured["error_max"].sel(way="refined", quantity="transmission_angle"))
    with xr.open_dataset(folder_of_study / "accuracy.h5", engine="h5netcdf") as written:
        xr.testing.assert_equal(written, measured)
    assert (folder_of_study / "accuracy.png").stat().st_size > 10_000


def test_the_table_marks_the_front_and_bounds_of_extremes_are_left_out(measured):
    table = measured.fastlink.summary()
    assert [line for line in table.splitlines() if line and not line.startswith((" ", "*"))] == [
        "omega4_max",
        "transmission_angle",
    ]
    starred = [line for line in table.splitlines() if line.startswith("*")]
    assert len(starred) == int(measured["pareto"].sum())
    # Samples have none, so that a study with them could not be measured at all.
    assert "omega4_max_error" in measured.attrs["left_out"]


def test_a_method_on_the_front_is_beaten_by_none():
    one = xr.Dataset(
        {
            "error_max": (("way", "quantity"), [[1e-3], [1e-3], [1e-9], [1e-16], [2e-16], [np.nan]]),
            "ns_per_design": (("way", "quantity"), [[1.0], [2.0], [3.0], [5.0], [4.0], [np.nan]]),
        }
    )
    # the last digit is not a difference
    assert front(one)[:, 0].tolist() == [1, 0, 1, 0, 1, 0]


def test_infinite_extremes_at_toggles_are_found_by_refinement_only(folder_of_study):
    study = folder_of_study / "toggle.toml"
    study.write_text(STUDY.replace("[0.3, 0.5, 40]", "[1.3, 1.4, 4]").replace(', "transmission_angle"', ""))
    measured = fl.accuracy(study, designs=4)
    assert (measured["missed"].sel(way="refined") == 0).all()
    of_samples = measured.sel(way="4096 angles", quantity="omega4_max")
    assert (
        int(of_samples.missed) == int(of_samples["values"]) == 3
    )  # infinite there; the fourth is a change point


def test_dense_and_eliminated_reactions(folder_of_study):
    study = folder_of_study / "forces.toml"
    bars = '[links]\nmodel = "round_bar"\ndensity = 7750.0\nradius = 0.01\n'
    study.write_text(STUDY.replace('"omega4_max", "transmission_angle"', '"F32_x"') + bars)
    found = errors(fl.accuracy(study, designs=4), "F32_x")
    assert set(found) == {"eliminated", "dense"}
    assert max(found.values()) < 4 * SMALL


@pytest.mark.parametrize(
    ("old", "new", "key", "remedy"),
    [
        ('"omega4_max", "transmission_angle", ', "", "quantities", "one of these"),
        ("omega1", "omega", "design.omega", ""),
    ],
)
def test_bad_input(folder_of_study, old, new, key, remedy):
    study = folder_of_study / "bad.toml"
    study.write_text(STUDY.replace(old, new))
    with refused(key, remedy):
        fl.accuracy(study)


def test_a_picture_that_cannot_be_written_is_refused_before_anything_is_measured(folder_of_study):
    said = []
    with refused("picture.xyz", "write one of"):
        fl.accuracy(
            folder_of_study / "study.toml", picture=folder_of_study / "picture.xyz", announce=said.append
        )
    assert said == []


def test_change_points_are_counted_in_a_line_of_their_own(tmp_path):
    """Doubles cannot tell them from their neighbours, whose extremes are others: a sweep verifies none as wrong."""
    a2 = np.linspace(1.0, 1.4, 9)
    columns = {"a1": np.append((1.8 - a2)[:6], [0.3] * 3), "a2": a2, "a3": np.full(9, 0.8), "a4": np.ones(9)}
    pd.DataFrame(columns).to_csv(tmp_path / "designs.csv", index=False)
    text = (
        'mechanism = "planar_4r"\nquantities = ["transmission_angle_min"]\ndesign = {table = "designs.csv"}\n'
    )
    (tmp_path / "study.toml").write_text(text)
    measured = fl.accuracy(tmp_path / "study.toml", designs=9)
    refined = measured.sel(way="refined", quantity="transmission_angle_min")
    assert (int(refined.change_points), int(refined["values"]), int(refined.missed)) == (6, 3, 0)
    assert float(refined.error_max) < 1e-14
    assert "6 designs left out: change points" in measured.fastlink.summary()
    maps = sweep_4r(fl.table(columns), ["transmission_angle_min"], verify=9)
    assert maps.attrs["verify_mismatches"] == 0


# == The picture of error against run time: names and ticks can be read ======================================

# as of omega4_max in docs/accuracy.md: methods whose times and errors are nearly the same
CROWDED = {
    "32 angles": (60, 3e-3), "64 angles": (84, 9e-4), "128 angles": (150, 2e-4), "256 angles": (290, 5e-5),
    "360 angles": (350, 2.8e-5), "360 angles, relaxed": (270, 2.8e-5), "512 angles": (540, 1.3e-5),
    "1024 angles": (950, 3.5e-6), "2048 angles": (1800, 7e-7), "4096 angles": (2500, 2e-7),
    "refined": (335, 4e-16), "refined, relaxed": (210, 4e-16), "NumPy, 360 angles": (1.1e6, 1.5e-5),
    "scipy, brentq": (4.7e6, 3e-16), "scipy, minimize_scalar": (5.4e6, 4e-16),
}  # fmt: skip
ALIKE = {"eliminated": (870.0, 1.1e-12), "dense": (910.0, 1.3e-12), "NumPy": (1200.0, 1.2e-12)}


@pytest.mark.parametrize("methods", [CROWDED, ALIKE], ids=["crowded", "alike"])
def test_no_label_covers_another(methods, tmp_path):
    times, errors = np.array(list(methods.values())).T
    measured = xr.Dataset(
        {
            name: (("way", "quantity"), values[:, None])
            for name, values in {"ns_per_design": times, "error_max": errors, "pareto": times < 300}.items()
        },
        {"way": list(methods), "quantity": ["omega4_max"]},
    )
    figure = draw(measured)
    figure.savefig(tmp_path / "accuracy.png")
    (axes,) = figure.axes
    boxes = [Text.get_window_extent(text) for text in axes.texts]  # without its line
    assert sorted(text.get_text() for text in axes.texts) == sorted(methods)
    assert not [(a, b) for a, b in itertools.combinations(boxes, 2) if a.overlaps(b)]
    for axis in (axes.xaxis, axes.yaxis):
        low, high = sorted(axis.get_view_interval())
        ticks = [tick for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
        assert len(ticks) >= 1
        shown = [tick.label1.get_window_extent() for tick in ticks]
        assert not [(a, b) for a, b in itertools.combinations(shown, 2) if a.overlaps(b)]
