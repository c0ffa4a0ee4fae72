"""Coordinates that are computed block by block are written so: equal to those in memory."""

import itertools

import netCDF4
import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_array_equal
from tests.support.four_bar import sweep_4r

import fastlink as fl
from fastlink.engine.resolve import resolve
from fastlink.engine.sweep import Evaluation
from fastlink.io.layout import Placement

FIXED = {"a1": 0.4, "a4": 1.0}
NAMES = ["omega4_max", "transmission_angle_min"]
GRID = fl.grid(a2=np.linspace(1.0, 1.4, 30), a3=np.linspace(0.6, 1.0, 40), omega1=2.0, **FIXED)
TABLE = fl.table(
    {"a2": np.linspace(1.0, 1.4, 900), "a3": 0.8, "maker": [f"No. {k}" for k in range(900)], **FIXED}
)
SPACES = {
    "of a grid": GRID.consecutive(100, 700),
    "of a table with texts": TABLE.with_constants({"omega1": 2.0}).consecutive(10, 610),
    "with a scaling axis": TABLE.consecutive(100, 500).with_axis("omega1", [1.0, 2.5, 7.0]),
    "with an axis": fl.grid(a2=np.linspace(1.0, 1.4, 500), omega1=2.0, **FIXED)
    .consecutive(100, 400)
    .with_axis("a3", [0.7, 0.8]),
}


def sweep(space, **options):
    return sweep_4r(space, NAMES, **{"verify": 1, "block": 16, "threads": 2, **options})


def without_times(maps):
    times = ("time", "per_second", "fingerprint", "threads", "history")
    attrs = {name: value for name, value in maps.attrs.items() if not any(word in name for word in times)}
    return maps.assign_attrs(attrs).drop_attrs(deep=False).assign_attrs(attrs)


@pytest.mark.parametrize("space", SPACES.values(), ids=SPACES)
def test_a_file_is_equal_to_the_result_in_memory(tmp_path, space):
    path = tmp_path / "m.h5"
    expected = sweep(space)
    with sweep(space, to=path) as maps:
        xr.testing.assert_identical(without_times(maps), without_times(expected))
    assert fl.check(path)
    with netCDF4.Dataset(path) as file:
        for name, coord in expected.coords.items():
            assert file[name].dimensions == coord.dims
            assert_array_equal(file[name][...], coord.values)
            assert all(file[name].getncattr(key) == value for key, value in coord.attrs.items())
    with sweep(space, to=path) as again:  # the same request: the file is opened as it is
        assert again.attrs["fingerprint"] == fl.open(path).attrs["fingerprint"]


def test_every_value_is_written_once_whatever_the_blocks():
    rng = np.random.default_rng(0)
    for rows, shared in [(100, 1), (100, 2), (12, 3), (7, 7)]:
        placement = Placement(rows, 1, 8, by_value=False, shared=shared)
        cuts = [0, *np.sort(rng.integers(0, rows, 6)).tolist(), rows]
        found = [k for start, stop in itertools.pairwise(cuts) for k in range(*placement.own(start, stop))]
        assert found == list(range(rows // shared))
        for k in found:
            ((first, last),) = placement.rows_in(8 * k, 8 * k + 8)
            assert placement.pieces(first, last) == [(8 * k, 8)]


def test_a_file_needs_no_memory_for_them():
    axis = np.linspace(1.0, 1.2, 2155)  # 2155^3 > 10^10
    space = fl.grid(a2=axis, a3=axis - 0.3, a4=axis, a1=0.4)
    part = space.consecutive(10**9, 9 * 10**9)
    resolved = resolve("planar_4r", part, ["grashof_class"], branch=(1, 2))
    evaluation = Evaluation(resolved, {}, 2, None, 0, in_memory=False)
    assert sum(variable.nbytes for variable, _ in evaluation.columns) == 8 * 10**9 * 8 * 4
    assert "a2" not in evaluation._coordinates()
    assert "design" not in evaluation._coordinates()
