"""Designs of every kind through a sweep: tables, maps fed back, labels, units, angles in degrees."""

import warnings

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from numpy.testing import assert_array_equal
from tests.support.four_bar import sweep_4r
from tests.support.refusals import refused

import fastlink as fl
from fastlink.app.report import contents

FIXED = {"a1": 0.4, "a4": 1.0, "omega1": 25.0}
GRID = fl.grid(a2=[1.1, 1.2, 5.0], a3=[0.7, 0.8], **FIXED)
NAMES = ["omega4_max"]
IGNORED = pytest.warns(fl.InputWarning, match="omega4_max, status")


def sweep(space, names=NAMES, **options):
    return sweep_4r(space, names, **options)


@pytest.fixture(scope="module")
def maps():
    return sweep(GRID)


FED_BACK = {
    "whole": lambda maps: maps,
    "one assembly mode": lambda maps: maps.sel(branch=1),
    "some couplers": lambda maps: maps.isel(a2=[2, 0]),
    "one design": lambda maps: maps.isel(a2=1, a3=1),
    "in another order": lambda maps: maps.transpose("branch", "a3", "a2"),
    "those that assemble": lambda maps: maps.where(maps.status < 2, drop=True),
}


@pytest.mark.parametrize("select", FED_BACK.values(), ids=FED_BACK)
def test_a_map_stands_for_its_designs_in_their_dimensions(maps, select):
    chosen = select(maps)
    with IGNORED:
        again = sweep(chosen)
    wanted = chosen.drop_vars("branch") if chosen.branch.ndim == 0 else chosen
    expected = maps.omega4_max.sel({name: wanted[name] for name in ("a2", "a3")})
    xr.testing.assert_equal(again.omega4_max, expected.transpose(*again.omega4_max.dims))
    assert again.attrs["design_ignored"] == "omega4_max, status"


FLAT = {
    "stacked": lambda maps: maps.stack(design=("a2", "a3")),
    "rows": lambda maps: maps.to_dataframe(),
    "rows of one assembly mode": lambda maps: maps.sel(branch=2).to_dataframe().reset_index(),
    "table of rows": lambda maps: fl.table(maps.to_dataframe().reset_index()),
}


@pytest.mark.parametrize("select", FLAT.values(), ids=FLAT)
def test_rows_of_a_map_are_its_designs_each_once(maps, select):
    with IGNORED:
        again = sweep(select(maps))
    assert again.omega4_max.dims == ("design", "branch")
    assert_array_equal(again.omega4_max.values.reshape(3, 2, 2), maps.omega4_max)
    assert_array_equal(again.a2, np.repeat(maps.a2, 2))


def test_a_file_of_the_rows_of_a_map(maps, tmp_path):
    maps.to_dataframe().to_csv(tmp_path / "rows.csv")
    with IGNORED:
        again = sweep(tmp_path / "rows.csv")
    assert_array_equal(again.omega4_max.values.reshape(3, 2, 2), maps.omega4_max)


def test_selected_designs_keep_their_numbers_and_may_get_other_inputs(maps):
    sample = fl.sobol(8, a2=(1.0, 1.4), a3=0.8, **FIXED)
    whole = sweep(sample)
    with IGNORED:
        chosen = sweep(whole.isel(design=[5, 3]).assign(omega1=50.0))
    assert chosen.design.values.tolist() == [5, 3]
    # twice the speed of the crank is twice every rate, a power of two without rounding
    assert_array_equal(chosen.omega4_max, 2.0 * whole.omega4_max.sel(design=[5, 3]))


def test_a_map_without_results_is_taken_in_silence(maps):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        again = sweep(maps.drop_vars(maps.data_vars))
    xr.testing.assert_equal(again.omega4_max, maps.omega4_max)
    assert "design_ignored" not in again.attrs


def test_choices_that_a_map_made_come_back():
    space = fl.table({"a": [5.0, 5.5], "b": 5.0, "c": 2.0, "d": 4.0, "rho": 1.0})
    whole = fl.sweep("focal", space, ["crank_type"], branch=(1, 2))
    with pytest.warns(fl.InputWarning, match="crank_type"):
        again = fl.sweep("focal", whole, ["crank_type"], branch=(1, 2))
    assert again.crank_type.dims == ("design", "completion")
    xr.testing.assert_equal(again.crank_type, whole.crank_type)


def test_links_count_before_those_of_a_map():
    light, heavy = fl.round_bar(density=2700.0, radius=0.01), fl.round_bar(density=7750.0, radius=0.01)
    whole = sweep(GRID, ["T41_max"], links=heavy)
    with pytest.warns(fl.InputWarning, match="density, radius"):
        again = sweep(whole, ["T41_max"], links=light)
    xr.testing.assert_equal(again.T41_max, sweep(GRID, ["T41_max"], links=light).T41_max)
    with pytest.warns(fl.InputWarning, match="density, radius"):
        assert "density" not in sweep(whole).coords
    with pytest.warns(fl.InputWarning, match="T41_max, status"):
        again = sweep(whole, ["T41_max"], links=fl.round_bar())
    xr.testing.assert_equal(again.T41_max, whole.T41_max)


def test_only_results_are_ignored():
    table = {"a2": [1.1, 1.2], "a3": 0.8, **FIXED}
    with pytest.warns(fl.InputWarning, match="omega4_rms"):
        assert sweep({**table, "omega4_rms": [1.0, 2.0]}).attrs["design_ignored"] == "omega4_rms"
    with refused("omgea1", "did you mean 'omega1'? Or pass keep=['omgea1']"):
        sweep({**table, "omgea1": [1.0, 2.0]})
    with refused("omega4", "did you mean"):  # a grid is written by hand
        sweep(fl.grid(a2=1.1, a3=0.8, omega4=[1.0, 2.0], **FIXED))
    for name in ("branch", "theta1", "theta1_deg"):
        for space in ({**table, name: [1.0, 2.0]}, fl.grid(a2=1.1, a3=0.8, **{name: [1.0, 2.0]}, **FIXED)):
            with refused(name, "as an option of the sweep"):
                sweep(space)


LABELS = pd.DataFrame(
    {"a2": [1.1, 1.2, 5.0], "a3": 0.8, **FIXED, "maker": ["Müller", "", "B & C"]},
    index=pd.Index(["P1", "P2", "P3"], name="part"),
)


def test_labels_are_coordinates_in_memory_and_in_files(tmp_path):
    plain = sweep(LABELS.reset_index(drop=True).drop(columns="maker"))
    memory = sweep(LABELS)
    with sweep(LABELS, to=tmp_path / "map.h5", block=2, verify=2) as file:
        for result in (memory, file):
            assert result.part.values.tolist() == ["P1", "P2", "P3"]
            assert result.maker.values.tolist() == ["Müller", "", "B & C"]
            assert (
                result.omega4_max.set_index(design="part").sel(design="P2", branch=1)
                == plain.omega4_max[1, 0]
            )
            assert_array_equal(result.omega4_max, plain.omega4_max)
            assert "P1" in contents(result)
            assert result.omega4_max.to_dataframe().maker.iloc[0] == "Müller"
        xr.testing.assert_equal(memory, file)
    with xr.open_dataset(tmp_path / "map.h5", engine="netcdf4") as other:
        assert other.part.values.tolist() == ["P1", "P2", "P3"]
        assert other.omega4_max.dims == ("design", "branch")
    with sweep(LABELS, to=tmp_path / "map.h5", verify=2) as again:  # up to date
        assert again.attrs["written_time_ns"] == file.attrs["written_time_ns"]
    with refused("map.h5"):
        sweep(LABELS.assign(maker="x"), to=tmp_path / "map.h5")


def test_names_of_designs_as_their_dimension():
    dataset = xr.Dataset({"a2": ("design", [1.1, 1.2])}, coords={"design": ["P1", "P2"], "a3": 0.8, **FIXED})
    result = sweep(dataset)
    assert float(result.omega4_max.sel(design="P2", branch=1)) > 0.0
    picture = fl.plot(result, "omega4_max")
    assert [text.get_text() for text in picture.axes[0].get_xticklabels()] == ["P1", "P2"]


def test_a_map_is_swept_again_by_its_path(tmp_path):
    path = tmp_path / "maps.h5"
    sweep(GRID, to=path).close()
    with IGNORED:
        again = sweep(path, ["transmission_angle_min"])
    assert again.transmission_angle_min.dims == ("a2", "a3", "branch")
    with refused("maps.h5", "fastlink.open"):
        fl.table(path)
    (tmp_path / "other.csv").write_bytes(path.read_bytes()[:100])
    with refused("other.csv", "a map that a sweep has written"):
        sweep(tmp_path / "other.csv")
