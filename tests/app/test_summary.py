"""Summaries of maps, of parts of maps, and of what users have made of them."""

import numpy as np
import pytest
from tests.support.four_bar import sweep_4r
from tests.support.refusals import refused

import fastlink as fl
from fastlink.app.report import contents


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("maps") / "maps.h5"
    space = fl.grid(a1=[0.4, 0.6, 3.0], a2=[1.1, 1.2], a3=0.8, a4=1.0, omega1=25.0)
    sweep_4r(space, ["omega4_max", "theta4"], theta1=4, to=path, verify=2).close()
    return path


@pytest.fixture(scope="module")
def maps(path):
    with fl.open(path) as opened:
        return opened.load()


def test_a_path_is_as_good_as_a_map(path, maps):
    with fl.open(path) as opened:
        assert contents(path) == contents(opened)


def test_a_bare_dataset_is_told_from_a_map(maps):
    with refused("fastlink_map", "keep_attrs"):
        maps.drop_attrs().fastlink.summary()


def test_a_part_of_a_map_counts_its_own_designs(maps):
    part = maps.isel(a1=[0, 2])
    lines = part.fastlink.summary().splitlines()
    assert lines[0].split(maxsplit=1)[1] == "4 of the 6 of the sweep"
    (full,) = [line.split()[0] for line in lines if "rotates fully" in line]
    assert int(full) == int((part.status == 0).sum())
    assert "rotates" not in maps.mean("a1").fastlink.summary()


HOSTILE = {
    "one design": lambda maps: maps.isel(a1=0, a2=0),
    "no design": lambda maps: maps.isel(a1=[]),
    "one mode": lambda maps: maps.isel(branch=0),
    "mean": lambda maps: maps.mean("a1", keep_attrs=True),
    "mean of all": lambda maps: maps.mean(keep_attrs=True),
    "without coordinates": lambda maps: maps.drop_vars(["a1", "branch", "theta1", "a3"]),
    "without status": lambda maps: maps.drop_vars("status"),
    "stacked": lambda maps: maps.stack(all=("a1", "a2")),
    "renamed": lambda maps: maps.rename(a1="crank", omega4_max="fast", status="state"),
    "named designs": lambda maps: maps.assign_coords(
        a1=["x", "y", "z"], maker="someone", when=np.datetime64("2020")
    ),
    "numbers in words": lambda maps: maps.assign_attrs(designs="many", run_time_s=None, threads=[1, 2]),
    "not a number": lambda maps: maps.assign_attrs(designs=np.nan, run_time_s=np.inf, threads=-1),
    "no attributes of variables": lambda maps: maps.assign(
        {name: array.drop_attrs() for name, array in maps.data_vars.items()}
    ),
    "damaged codes": lambda maps: maps.assign(status=maps.status.assign_attrs(flag_meanings=3)),
    "text": lambda maps: maps.assign(note=("a1", ["a", "b", "c"])),
    "arithmetic": lambda maps: (maps * 2).assign_attrs(maps.attrs),
}


@pytest.mark.parametrize("change", HOSTILE.values(), ids=HOSTILE)
def test_whatever_became_of_a_map_is_summarised(maps, change):
    assert change(maps).fastlink.summary()
    assert contents(change(maps)).startswith("title")


def test_a_map_that_xarray_has_saved_is_a_map(maps, tmp_path):
    maps.isel(a1=[0, 1]).to_netcdf(tmp_path / "part.nc", engine="h5netcdf")
    assert "4 of the 6" in fl.open(tmp_path / "part.nc").fastlink.summary()
