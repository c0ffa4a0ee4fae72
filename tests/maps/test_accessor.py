"""The attribute fastlink of maps: masks, infinite values, units, best designs."""

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.maps import best

NAMES = ["omega4_max", "theta4", "transmission_angle_min", "grashof_class"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("maps")


@pytest.fixture(scope="module")
def path(folder):
    """A map with designs of several statuses, and infinite extremes."""
    space = fl.grid(a1=[0.2, 0.5, 1.0, 3.0], a2=np.linspace(0.3, 1.5, 5), a3=0.8, a4=[0.9, 1.0], omega1=25.0)
    sweep_4r(space, NAMES, theta1=8, to=folder / "maps.h5", verify=2).close()
    return folder / "maps.h5"


@pytest.fixture(scope="module")
def maps(path):
    with fl.open(path) as opened:
        return opened.load()


# -- masks -----------------------------------------------------------------------------------------


def test_masks_are_those_of_the_codes(maps):
    mask = maps.fastlink.status_is("rotates fully", "change_point")
    assert_array_equal(mask, maps.status.isin([0, 3]))
    assert mask.any()
    assert not mask.all()
    assert_array_equal(maps.status.fastlink.status_is("rotates fully"), maps.status == 0)
    cranks = maps.fastlink.status_is("crank_rocker", of="grashof_class")
    assert_array_equal(cranks, maps.grashof_class == 0)
    assert sum(maps.fastlink.counts().values()) == maps.status.size
    assert maps.fastlink.counts()["rotates_fully"] == int((maps.status == 0).sum())


def test_what_is_masked_keeps_types_dimensions_and_labels(maps):
    masked = maps.fastlink.where_status("rotates_fully")
    inside = (maps.status == 0).broadcast_like(maps.theta4).transpose(*maps.theta4.dims)
    assert_array_equal(masked.theta4, np.where(inside, maps.theta4, np.nan))
    assert masked.theta4.dims == maps.theta4.dims
    assert masked.theta4.attrs == maps.theta4.attrs
    assert masked.status.dtype == maps.status.dtype


def test_unknown_meanings_and_variables_are_refused(maps):
    with refused("rotates_fuly", "rotates_fully"):
        maps.fastlink.status_is("rotates_fuly")
    with refused("stat", "status"):
        maps.fastlink.status_is("rotates_fully", of="stat")
    with refused("omega4_max", "flag_values"):
        maps.fastlink.status_is("rotates_fully", of="omega4_max")
    with refused("meanings", "rotates_fully"):
        maps.fastlink.status_is()
    with refused("meanings", "rotates_fully"):
        maps.status.fastlink.status_is(3)
    with refused("status", "before averaging"):
        maps.mean("a1").fastlink.counts()


def test_codes_whose_attributes_are_damaged_have_no_meanings(maps):
    broken = maps.copy()
    broken["status"] = broken.status.assign_attrs(flag_values=[0, 1])
    with refused("status", "flag_values"):
        broken.fastlink.status_is("rotates_fully")


# -- infinite values -------------------------------------------------------------------------------


def test_infinite_values_become_nan_and_are_counted(maps, path):
    infinite = np.isinf(maps.omega4_max.values)
    assert infinite.any()
    for result in (maps.fastlink.finite(), fl.open(path).fastlink.finite()):
        values = result.omega4_max.values
        assert_array_equal(values, np.where(infinite, np.nan, maps.omega4_max.values))
        assert result.omega4_max.attrs["infinite_values"] == infinite.sum()
        assert "infinite_values" not in result.theta4.attrs
    assert "infinite_values" not in maps.omega4_max.attrs
    again = maps.omega4_max.fastlink.finite().fastlink.finite()
    assert again.attrs["infinite_values"] == infinite.sum()


def test_a_finite_map_is_drawn_by_xarray(maps):
    pytest.importorskip("matplotlib").use("agg")
    mesh = maps.fastlink.finite().omega4_max.isel(a4=0, branch=0).plot()
    assert np.isfinite(mesh.get_clim()).all()


# -- units -----------------------------------------------------------------------------------------


def test_angles_become_degrees_and_rates_stay(maps):
    result = maps.fastlink.degrees()
    assert result.theta4.attrs["units"] == result.theta1.attrs["units"] == "degree"
    # one product and one rounded factor
    assert_allclose(result.theta4, maps.theta4 * (180 / np.pi), rtol=4e-16)
    assert_allclose(result.theta1, np.arange(0.0, 360.0, 45.0), rtol=4e-16)
    assert_array_equal(result.omega4_max, maps.omega4_max)
    assert maps.theta1.attrs["units"] == "rad"
    xr.testing.assert_identical(result.fastlink.degrees(), result)
    xr.testing.assert_identical(maps.theta4.fastlink.degrees(), result.theta4)
    assert_array_equal(result.theta4.sel(theta1=90.0), np.rad2deg(maps.theta4.isel(theta1=2)))


def test_units_are_converted_by_name(maps):
    pytest.importorskip("pint")
    result = maps.fastlink.convert(omega4_max="rpm", a1="mm", theta4="degree")
    assert_allclose(result.omega4_max, maps.omega4_max * (30 / np.pi), rtol=1e-15)  # three roundings
    assert_allclose(result.a1, [200.0, 500.0, 1000.0, 3000.0], rtol=1e-15)
    assert result.sel(a1=500.0, method="nearest").sizes["a2"] == 5
    assert maps.fastlink.units["omega4_max"] == "rad s-1"
    assert result.fastlink.units["omega4_max"] == "rpm"
    assert_allclose(maps.omega4_max.fastlink.convert("degree/s"), np.rad2deg(maps.omega4_max), rtol=1e-15)


@pytest.mark.parametrize("units", ["Hz", "m", "", 3, None, "**", "furlongs per", "kg m2 s-"])
def test_units_of_another_kind_are_refused(maps, units):
    pytest.importorskip("pint")
    with refused("omega4_max", "rpm"):
        maps.fastlink.convert(omega4_max=units)


def test_units_of_every_quantity_are_read_by_pint():
    pytest.importorskip("pint")
    from fastlink.maps.units import _parsed
    from fastlink.mechanisms import NAMES, catalogue

    units = {fact.units for name in NAMES for fact in catalogue(name).facts.values()}
    assert {"rad s-1", "N m", "1", "kg m2"} <= units
    for text in units:
        _parsed(text, text)


def test_names_without_units_are_refused(maps):
    with refused("omega4_mx", "omega4_max"):
        maps.fastlink.convert(omega4_mx="rpm")
    with refused("status", ""):
        maps.fastlink.convert(status="rpm")


# -- best designs ----------------------------------------------------------------------------------


def best_by_sorting(maps, name, n, largest, inside):
    values = maps[name].values.ravel()
    places = np.flatnonzero(np.isfinite(values) & inside.ravel())
    order = np.argsort(-values[places] if largest else values[places], kind="stable")
    return places[order][:n]


@pytest.mark.sample(2)
@pytest.mark.parametrize("block", [7, 1000, *(pytest.param(n, marks=pytest.mark.stress) for n in (1, 3, 20))])
@pytest.mark.parametrize("largest", [True, False])
@pytest.mark.parametrize("name", ["omega4_max", "theta4"])
def test_the_best_designs_are_those_of_a_sort(maps, path, monkeypatch, block, largest, name):
    monkeypatch.setattr(best, "MOST_ROWS", block)
    mask = (maps.status == 0) & (maps.a4 > 0.95)
    inside = mask.broadcast_like(maps[name]).transpose(*maps[name].dims).values
    expected = best_by_sorting(maps, name, 9, largest, inside)
    with fl.open(path) as opened:
        rows = opened.fastlink.top(9, name, largest=largest, where=mask).load()
    assert_array_equal(rows[name], maps[name].values.ravel()[expected])
    places = np.unravel_index(expected, maps[name].shape)
    for dim, numbers in zip(maps[name].dims, places, strict=True):
        assert_array_equal(rows[dim], maps[dim].values[numbers])
    assert rows.a3.dims == ()
    assert rows.a3 == 0.8
    assert rows.sizes == {"design": 9}


def test_equal_values_and_few_values(maps):
    flat = maps.assign(same=xr.zeros_like(maps.omega4_max).where(maps.omega4_max.notnull()))
    rows = flat.fastlink.top(4, "same")
    assert_array_equal(rows.a1, flat.same.stack(all=[...]).dropna("all").a1[:4])
    everything = maps.fastlink.top(10**6, "omega4_max", infinite=True)
    assert everything.sizes["design"] == int(maps.omega4_max.notnull().sum())
    assert everything.omega4_max[0] == np.inf
    assert "infinite" in maps.fastlink.top(3, "omega4_max").attrs["selection"]
    with refused("fail status", "widen"):
        maps.fastlink.top(3, "omega4_max", where="invalid_input")


def test_meanings_of_status_select(maps):
    rows = maps.fastlink.top(5, "omega4_max", largest=False, where="rotates fully")
    assert (rows.status == 0).all()
    xr.testing.assert_identical(
        rows, maps.fastlink.top(5, "omega4_max", largest=False, where=maps.status == 0)
    )
    mean = maps.mean("a4").fastlink.top(2, "transmission_angle_min")
    assert mean.sizes["design"] == 2


def test_rankings_without_sense_are_refused(maps):
    with refused("omega_max", "omega4_max"):
        maps.fastlink.top(3, "omega_max")
    with refused("status", "where"):
        maps.fastlink.top(3, "status")
    with refused("n", "1"):
        maps.fastlink.top(0, "omega4_max")
    with refused("by", "assign"):
        maps.fastlink.top(3, maps.omega4_max)
    with refused("where", "mask"):
        maps.fastlink.top(3, "omega4_max", where=maps.omega4_max)
    with refused("theta1", "same map"):
        maps.fastlink.top(3, "omega4_max", where=maps.theta4 > 0)
    with refused("where", "rotates_fully"):
        maps.fastlink.top(3, "omega4_max", where="turns fully")


def test_the_best_designs_are_swept_again_to_the_same_bits(maps):
    rows = maps.sel(branch=2).fastlink.top(7, "omega4_max", where="rotates fully")
    again = fl.sweep("planar_4r", rows.fastlink.designs, ["omega4_max", "transmission_angle_min"], branch=2)
    for name in ("omega4_max", "transmission_angle_min"):
        assert_array_equal(again[name], rows[name])


@pytest.mark.parametrize("text", ["m**9**9**9**9", "(" * 3 + "m", "m" * 100, "m**99999999"])
def test_units_that_take_for_ever_are_refused(maps, text):
    pytest.importorskip("pint")
    with refused("a1", "rpm"):
        maps.fastlink.convert(a1=text)


def test_averages_of_codes_are_no_codes(maps):
    """The mean of 0 and 2 is not 1."""
    for call in (
        lambda mean: mean.fastlink.status_is("rotates_fully"),
        lambda mean: mean.status.fastlink.status_is("rotates_fully"),
        lambda mean: mean.fastlink.where_status("rotates_fully"),
        lambda mean: mean.fastlink.top(2, "omega4_max", where="rotates_fully"),
    ):
        with refused("status", "before averaging"):
            call(maps.mean("a1"))


def test_stacked_maps(maps):
    stacked = maps.stack(both=("a1", "theta1"))
    assert_array_equal(stacked.fastlink.finite().theta4, stacked.theta4)
    assert stacked.fastlink.where_status("rotates_fully").theta4.sizes == stacked.theta4.sizes
    with refused("theta1", "unstack"):
        stacked.fastlink.degrees()
    assert maps.stack(both=("a1", "a2")).fastlink.degrees().theta4.attrs["units"] == "degree"


def test_a_map_whose_file_is_gone_is_refused(maps, tmp_path):
    maps.to_netcdf(tmp_path / "gone.h5", engine="h5netcdf")
    opened = fl.open(tmp_path / "gone.h5")
    opened.close()
    (tmp_path / "gone.h5").unlink()
    for call in (
        lambda: opened.fastlink.finite(),
        lambda: fl.plot(opened, "omega4_max", at={"a4": 1.0}),
        lambda: opened.fastlink.top(1, "omega4_max"),
        opened.fastlink.counts,
        opened.fastlink.degrees,
    ):
        with refused("maps", "give the result of a sweep"):
            call()


def test_a_map_without_variables(maps):
    empty = maps.fastlink.designs
    for call in (
        empty.fastlink.counts,
        lambda: empty.fastlink.top(1, "omega4_max"),
        lambda: fl.plot(empty, "omega4_max"),
    ):
        with refused("unknown", "there is none"):
            call()
