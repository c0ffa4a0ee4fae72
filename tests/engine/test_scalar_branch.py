"""A single assembly mode is a scalar coordinate, as xarray's users expect; a list of one is a dimension."""

import numpy as np
import pytest
import xarray as xr
from tests.support.four_bar import sweep_4r

import fastlink as fl
from fastlink.app.report import contents

LENGTHS = {"a1": 0.4, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
SPACE = fl.grid(a2=[1.1, 1.2, 5.0], **LENGTHS)
NAMES = ["omega4", "omega4_max", "omega4_extrema", "grashof_class"]


@pytest.fixture(scope="module")
def both():
    return sweep_4r(SPACE, NAMES, theta1=24)


@pytest.mark.parametrize(
    "branch", [2, np.int64(2), np.array(2), xr.DataArray(2)], ids=lambda b: type(b).__name__
)
def test_a_scalar_is_a_coordinate_and_a_list_a_dimension(both, branch):
    one = fl.sweep("planar_4r", SPACE, NAMES, theta1=24, branch=branch)
    listed = fl.sweep("planar_4r", SPACE, NAMES, theta1=24, branch=[2])
    xr.testing.assert_equal(one, both.sel(branch=2))
    xr.testing.assert_equal(listed, both.sel(branch=[2]))
    assert one.branch.dims == ()
    assert one.branch.attrs["comment"] == both.branch.attrs["comment"]


def test_the_file_has_the_same_labels(tmp_path, both):
    options = {"theta1": 24, "branch": 2, "to": tmp_path / "map.h5", "verify": 2}
    with sweep_4r(SPACE, NAMES, **options) as one:
        xr.testing.assert_equal(one, both.sel(branch=2))
        assert one.attrs["verify_mismatches"] == 0
        assert int(one.branch) == 2
        assert "assembly mode" in contents(one)


def test_what_does_not_depend_on_the_assembly_mode_has_none():
    found = fl.sweep("planar_4r", SPACE, ["grashof_class"], branch=2)
    assert "branch" not in found.coords


def test_functions_of_maps_take_one_assembly_mode():
    bars = fl.round_bar(density=7750.0, radius=0.01)
    names = ["T41_fluctuation"]
    one = fl.sweep("planar_4r", SPACE, names, links=bars, branch=1)
    several = sweep_4r(SPACE, names, links=bars)
    xr.testing.assert_equal(
        fl.planar.flywheel_inertia(one, C_s=0.02), fl.planar.flywheel_inertia(several, C_s=0.02).sel(branch=1)
    )
    chebyshev = fl.grid(a=[5.0, 5.5], b=5.0, c=2.0, d=4.0, rho=1.0, completion=1)
    options = {"input": "sigma", "sigma": np.linspace(3.3, 6.0, 9)}
    one = fl.sweep("focal", chebyshev, ["T_x", "T_y"], branch=1, **options)
    several = fl.sweep("focal", chebyshev, ["T_x", "T_y"], **{"branch": (1, 2)} | options)
    xr.testing.assert_equal(fl.focal.T_deviation(one), fl.focal.T_deviation(several).sel(branch=1))
