"""The distance of T from the straight line that fits its path best, from maps by either input."""

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_array_equal
from tests.support.focal_configurations import DRIVES, random_designs
from tests.support.refusals import refused
from tests.support.sweeps import sweep_both

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.precision.reference import CONTEXT as MP

CHEBYSHEV = {"a": 5.0, "b": 5.0, "c": 2.0, "d": 4.0, "rho": 1.0, "completion": 1}
DESIGNS = random_designs(np.random.default_rng(12), 150)
del DESIGNS["branch"], DESIGNS["completion"]
ANGLES = np.sort(np.random.default_rng(13).uniform(-3.0, 3.0, 50))


def swept(drive):
    return sweep_both("focal", fl.table(DESIGNS), ["T_x", "T_y"], input=drive, angles=ANGLES)


@pytest.mark.parametrize("drive", DRIVES)
def test_it_is_the_distance_from_the_line_that_fits_T(drive):
    maps = swept(drive)
    found = fl.focal.T_deviation(maps)
    assert_array_equal(found, fl.focal.straight_line(maps.T_x.values, maps.T_y.values).deviation)
    assert found.dims == maps.T_x.dims == ("design", "completion", "branch", drive)
    assert found.name == "T_deviation"
    assert found.attrs["units"] == "m"
    assert set(found.coords) == set(maps.T_x.coords)
    missing = np.isnan(maps.T_x.values)
    assert_array_equal(np.isnan(found), missing)
    # T there along all of a path, along a part, nowhere
    assert {0, ANGLES.size} < set(missing.sum(axis=-1).ravel())


@pytest.mark.parametrize("drive", DRIVES)
def test_it_is_exact_for_the_places_of_T(drive):
    found = swept(drive)
    curves = (found.T_x, found.T_y, fl.focal.T_deviation(found))
    paths = [curve.values.reshape(-1, ANGLES.size) for curve in curves]
    chosen = np.flatnonzero(np.isfinite(paths[0]).sum(axis=-1) > 2)[:40]
    assert chosen.size == 40
    for row in chosen:
        there = np.isfinite(paths[0][row])
        x, y = ([MP.mpf(value) for value in path[row][there]] for path in paths[:2])
        along, across = ([value - sum(values) / len(values) for value in values] for values in (x, y))
        squares = sum(p * p - q * q for p, q in zip(along, across, strict=True))
        products = 2 * sum(p * q for p, q in zip(along, across, strict=True))
        half = MP.atan2(products, squares) / 2
        exact = [q * MP.cos(half) - p * MP.sin(half) for p, q in zip(along, across, strict=True)]
        # Sums of up to 50: in each of 8 lanes 6 roundings, then 3; so the middle has 10 of the size of the path. The
        # direction has as many of all squares over those that tell along from across, and 5 of its functions.
        size = max(abs(value) for value in (*x, *y))
        spread = sum(p * p + q * q for p, q in zip(along, across, strict=True))
        bound = UNIT_ROUNDING * size * (20 + 40 * spread / MP.hypot(squares, products))
        errors = [abs(a - b) for a, b in zip(paths[2][row][there], exact, strict=True)]
        assert max(errors) <= bound


def test_paths_of_any_order_are_read_and_maps_without_that_of_T_refused(tmp_path):
    space = fl.grid(**CHEBYSHEV)
    sweep_both("focal", space, ["T_x", "T_y"], phi=12, to=tmp_path / "maps.h5", verify=0).close()
    with fl.open(tmp_path / "maps.h5") as maps:
        expected = fl.focal.T_deviation(maps)
        turned = maps.assign(T_x=maps.T_x.transpose("phi", ...))
        xr.testing.assert_identical(fl.focal.T_deviation(turned).transpose(*expected.dims), expected)
        changed = maps.assign(T_y=maps.T_y.assign_attrs(units="mm"))
    xr.testing.assert_identical(fl.focal.T_deviation(tmp_path / "maps.h5"), expected)
    with refused("mm", "same units"):
        fl.focal.T_deviation(changed)
    with refused("T_y", "sweep 'T_x' and 'T_y'"):
        fl.focal.T_deviation(sweep_both("focal", space, ["T_x"], phi=12))
    points = xr.Dataset({"T_x": ("design", [1.0]), "T_y": ("design", [1.0])})
    with refused("T_x", "sweep it over phi or sigma"):
        fl.focal.T_deviation(points)
    for thing in (None, 3, points.T_x):
        with refused("maps", "give"):
            fl.focal.T_deviation(thing)
