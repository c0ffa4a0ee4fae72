"""The attribute fastlink of maps: masks, infinite values, units, best designs."""

from decimal import Decimal

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.maps import best
from fastlink.maps.best import Rows, nondominated, undominated

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
    broken = maps.copy()
    broken["status"] = broken.status.assign_attrs(flag_values=[0, 1])
    with refused("status", "flag_values"):
        broken.fastlink.status_is("rotates_fully")


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


def test_infinite_values_become_nan_and_are_counted_and_a_finite_map_is_drawn_by_xarray(maps, path):
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
    pytest.importorskip("matplotlib").use("agg")
    mesh = maps.fastlink.finite().omega4_max.isel(a4=0, branch=0).plot()
    assert np.isfinite(mesh.get_clim()).all()


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
    with refused("omega4_mx", "omega4_max"):
        maps.fastlink.convert(omega4_mx="rpm")
    with refused("status", ""):
        maps.fastlink.convert(status="rpm")


NO_UNITS = ["Hz", "m", "", 3, None, "**", "furlongs per", "kg m2 s-"]
#: Which would be read for ever.
NO_UNITS += ["m**9**9**9**9", "(" * 3 + "m", "m" * 100, "m**99999999"]


@pytest.mark.parametrize("units", NO_UNITS)
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


@pytest.mark.sample(2)
@pytest.mark.parametrize("block", [7, 1000, *(pytest.param(n, marks=pytest.mark.stress) for n in (1, 3, 20))])
@pytest.mark.parametrize("largest", [True, False])
@pytest.mark.parametrize("name", ["omega4_max", "theta4"])
def test_the_best_designs_are_those_of_a_sort(maps, path, monkeypatch, block, largest, name):
    monkeypatch.setattr(best, "MOST_ROWS", block)
    mask = (maps.status == 0) & (maps.a4 > 0.95)
    inside = mask.broadcast_like(maps[name]).transpose(*maps[name].dims).values
    values = maps[name].values.ravel()
    places = np.flatnonzero(np.isfinite(values) & inside.ravel())
    expected = places[np.argsort(-values[places] if largest else values[places], kind="stable")][:9]
    with fl.open(path) as opened:
        rows = opened.fastlink.top(9, name, largest=largest, where=mask).load()
    assert_array_equal(rows[name], values[expected])
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


def test_meanings_of_status_select_and_the_best_are_swept_again_to_the_same_bits(maps):
    rows = maps.fastlink.top(5, "omega4_max", largest=False, where="rotates fully")
    assert (rows.status == 0).all()
    xr.testing.assert_identical(
        rows, maps.fastlink.top(5, "omega4_max", largest=False, where=maps.status == 0)
    )
    mean = maps.mean("a4").fastlink.top(2, "transmission_angle_min")
    assert mean.sizes["design"] == 2
    rows = maps.sel(branch=2).fastlink.top(7, "omega4_max", where="rotates fully")
    again = fl.sweep("planar_4r", rows.fastlink.designs, ["omega4_max", "transmission_angle_min"], branch=2)
    for name in ("omega4_max", "transmission_angle_min"):
        assert_array_equal(again[name], rows[name])


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


def test_stacked_maps_and_maps_without_variables(maps):
    stacked = maps.stack(both=("a1", "theta1"))
    assert_array_equal(stacked.fastlink.finite().theta4, stacked.theta4)
    assert stacked.fastlink.where_status("rotates_fully").theta4.sizes == stacked.theta4.sizes
    with refused("theta1", "unstack"):
        stacked.fastlink.degrees()
    assert maps.stack(both=("a1", "a2")).fastlink.degrees().theta4.attrs["units"] == "degree"
    empty = maps.fastlink.designs
    for call in (
        empty.fastlink.counts,
        lambda: empty.fastlink.top(1, "omega4_max"),
        lambda: fl.plot(empty, "omega4_max"),
    ):
        with refused("unknown", "there is none"):
            call()


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


# == The best designs of a map: by one objective, and the front of several ===================================


@pytest.fixture(scope="module")
def maps_best():
    space = fl.grid(
        a1=np.linspace(0.1, 1.5, 6), a2=np.linspace(0.65, 1.65, 7), a3=0.8, a4=[0.9, 1.0, 1.1], omega1=25.0
    )
    return sweep_4r(space, ["omega4_max", "transmission_angle_min", "theta4_max", "grashof_class"])


@pytest.fixture(scope="module")
def path_best(maps_best, tmp_path_factory):
    path = tmp_path_factory.mktemp("best") / "maps.h5"
    maps_best.to_netcdf(path, engine="h5netcdf")
    return path


def front_by_definition(points):
    """Return the rows that none beats, of equal ones the first: every pair is compared."""
    kept = []
    for k, point in enumerate(points):
        beaten = ((points <= point).all(axis=1) & (points < point).any(axis=1)).any()
        if not beaten and not (points[:k] == point).all(axis=1).any():
            kept.append(k)
    return kept


@st.composite
def clouds(draw):
    """Points with many ties, some objectives that agree or oppose each other."""
    rows, columns = draw(st.integers(1, 60)), draw(st.integers(2, 4))
    whole = st.integers(0, draw(st.integers(1, 30))).map(float)
    value = st.one_of(
        whole, whole, whole, st.sampled_from([np.inf, -np.inf])
    )  # infinities are values as others
    values = draw(st.lists(value, min_size=rows * columns, max_size=rows * columns))
    points = np.array(values).reshape(rows, columns)
    points[:, 1] = draw(st.sampled_from([points[:, 1], -points[:, 0], points[:, 0]]))
    return points


@given(clouds(), st.integers(0, 60))
@settings(max_examples=200, deadline=None)
def test_the_front_is_that_of_the_definition(points, cut):
    expected = front_by_definition(points)
    found = nondominated(points)
    assert sorted(found.tolist()) == expected
    assert_array_equal(np.lexsort(points[found].T[::-1]), np.arange(len(found)))
    front = points[:cut][nondominated(points[:cut])]
    left = undominated(points[cut:], front)
    assert {k - cut for k in expected if k >= cut} <= set(left.tolist())


def test_a_front_longer_than_what_is_compared_at_once():
    """All of 3,000 points of a sphere's octant are on the front, and none of those inside it."""
    rng = np.random.default_rng(5)
    outside = np.abs(rng.normal(size=(3000, 3)))
    outside /= np.linalg.norm(outside, axis=1)[:, None]
    points = np.concatenate((0.5 * outside[::2], outside))
    assert_array_equal(np.sort(nondominated(-points)), np.arange(1500, 4500))


def expected_rows(maps, names, signs, mask):
    """Return values of objectives and places of all rows that count, over every dimension of the first."""
    arrays = [sign * maps[name] for name, sign in zip(names, signs, strict=True)]
    *arrays, mask = xr.broadcast(*arrays, mask)
    points = np.stack([array.transpose(*arrays[0].dims).values.ravel() for array in arrays], axis=1)
    usable = np.isfinite(points).all(axis=1) & mask.transpose(*arrays[0].dims).values.ravel()
    places = np.flatnonzero(usable)
    return points[places], places, arrays[0]


@pytest.mark.parametrize("block", [5, 100])
def test_the_front_of_a_map(maps_best, path_best, monkeypatch, block):
    monkeypatch.setattr(best, "MOST_ROWS", block)
    mask = (maps_best.status == 0) & (maps_best.a1 <= 0.7) & (maps_best.transmission_angle_min >= 0.1)
    names, signs = ["omega4_max", "transmission_angle_min", "a1"], [1.0, -1.0, -1.0]
    points, places, whole = expected_rows(maps_best, names, signs, mask)
    kept = front_by_definition(points)
    assert 3 < len(kept) < len(points)
    where = {"status": "rotates fully", "a1": (None, 0.7), "transmission_angle_min": (0.1, None)}
    found = fl.best(path_best, minimise="omega4_max", maximise=["transmission_angle_min", "a1"], where=where)
    order = np.lexsort(points[kept].T[::-1])
    chosen = places[np.array(kept)[order]]
    for dim, numbers in zip(whole.dims, np.unravel_index(chosen, whole.shape), strict=True):
        assert_array_equal(found[dim], maps_best[dim].values[numbers])
    assert_array_equal(found.omega4_max, points[kept][order][:, 0])
    assert found.a3.dims == ()
    assert f"front of {len(kept)} of {int(mask.sum()):,} rows" in found.attrs["selection"]


def test_one_objective_and_its_conditions(maps_best):
    where = {"status": "rotates_fully", "a4": (1.0, 1.0)}
    found = fl.best(maps_best, maximise="transmission_angle_min", where=where, top=4)
    counts = (maps_best.status == 0) & (maps_best.a4 == 1.0)
    inside = maps_best.transmission_angle_min.where(counts).values.ravel()
    assert_array_equal(found.transmission_angle_min, np.sort(inside[np.isfinite(inside)])[::-1][:4])
    assert (found.a4 == 1.0).all()
    assert_array_equal(found.a2, maps_best.fastlink.top(4, "transmission_angle_min", where=where).a2)
    assert fl.best(maps_best, minimise="omega4_max").sizes["design"] == 10


def test_conditions_of_more_dimensions_and_infinite_objectives_count_as_asked(maps_best):
    """A design is a row in each assembly mode where the condition asks for one."""
    of_design = maps_best.assign(size=maps_best.a1 + maps_best.a2)
    found = fl.best(of_design, minimise="size", where={"theta4_max": (None, 0.0)}, top=5)
    wanted = (of_design["size"].where(maps_best.theta4_max <= 0.0)).values.ravel()
    assert_array_equal(found["size"], np.sort(wanted[np.isfinite(wanted)])[:5])
    assert (found.theta4_max <= 0.0).all()
    without = fl.best(maps_best, maximise=["omega4_max", "a1"])
    assert np.isfinite(without.omega4_max).all()
    assert "infinite" in without.attrs["selection"]
    assert np.isinf(fl.best(maps_best, maximise=["omega4_max", "a1"], infinite=True).omega4_max).any()


def test_what_is_found_is_swept_again_to_the_same_bits(maps_best):
    found = fl.best(maps_best.sel(branch=1), maximise=["transmission_angle_min", "a1"], where="rotates fully")
    again = fl.sweep("planar_4r", found.fastlink.designs, ["omega4_max"], branch=1)
    assert_array_equal(again.omega4_max, found.omega4_max)


def test_where_nothing_meets_the_conditions_the_nearest_rows_are_the_answer(maps_best):
    with pytest.warns(fl.InputWarning, match=r"where: none of (.+) rows meets all conditions: \1 fail a1;"):
        found = fl.best(maps_best, minimise=["a1", "a2"], where={"a1": (9.0, None)}, top=None)
    with pytest.warns(fl.InputWarning, match="none of .* fail omega4_max; these miss least"):
        maps_best.fastlink.top(1, "omega4_max", where={"omega4_max": (None, 1e-9)})
    assert found.a1.values[0] == maps_best.a1.values.max()
    assert found.missed.values[0] == f"a1 >= 9 by {9.0 - found.a1.values[0]:.6g} m"
    assert "none of" in found.attrs["selection"]
    met = fl.best(maps_best, minimize="a1", where={"a1": (None, maps_best.a1.values.min())})
    assert "missed" not in met.coords
    with refused("fail status", "widen"):
        fl.best(maps_best, minimise="a1", where="invalid_input")


@pytest.mark.parametrize("form", [0.25, "0.25", "0.25:0.25", (0.25, 0.25)])
def test_a_number_is_to_be_met(maps_best, form):
    a1 = float(maps_best.a1.values[1])
    form = {float: a1, str: str(form).replace("0.25", repr(a1)), tuple: (a1, a1)}[type(form)]
    found = fl.best(maps_best, minimise="omega4_max", where={"a1": form})
    assert set(found.a1.values) == {a1}
    again = fl.best(maps_best, minimise="omega4_max", where={"a1": f"{a1!r}:"})
    assert (again.a1 >= a1).all()


@pytest.mark.parametrize(
    ("key", "remedy", "options"),
    [
        ("objective", "minimise", {}),
        ("omega_max", "omega4_max", {"minimise": "omega_max"}),
        ("a1", "once", {"minimise": "a1", "maximise": "a1"}),
        ("status", "where", {"minimise": "status"}),
        ("a3", "omega4_max", {"minimise": "a3"}),
        ("minimise", "name", {"minimise": 3}),
        ("top", "leave it out", {"minimise": ["a1", "a2"], "top": 3}),
        ("top", "1", {"minimise": "a1", "top": 0}),
        ("infinite", "True or False", {"minimise": "a1", "infinite": "no"}),
        ("a9", "a4", {"minimise": "a1", "where": {"a9": (0, 1)}}),
        ("a1", "None", {"minimise": "a1", "where": {"a1": ("x", None)}}),
        ("a1", "or a number", {"minimise": "a1", "where": {"a1": (10**400, None)}}),
        ("a1", "or a number", {"minimise": "a1", "where": {"a1": (None, Decimal("sNaN"))}}),
        ("a1", "lesser end first", {"minimise": "a1", "where": {"a1": (1.0, 0.5)}}),
        ("status", "rotates_fully", {"minimise": "a1", "where": {"status": (0, 1)}}),
        ("status", "rotates_fully", {"minimise": "a1", "where": {"status": 0}}),
        ("where", "a1", {"minimise": "a1", "where": 7}),
        ("mask", "same map", {"minimise": "a1", "where": xr.DataArray([True, False], dims="a1")}),
    ],
)
def test_questions_without_an_answer_are_refused(maps_best, key, remedy, options):
    with refused(key, remedy):
        fl.best(maps_best, **options)


def test_of_one_design_there_is_no_best_and_all_problems_are_told_together(maps_best):
    with pytest.raises(fl.InputError) as caught:
        fl.best(maps_best, minimise=["omega_max", "a77"], where={"a9": (0, 1), "a1": (2, 1)}, top=0)
    assert len(str(caught.value).splitlines()) == 5
    one = sweep_4r({"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0}, ["swing"])
    with refused("one alone", "sweep several"):
        fl.best(one, minimise="swing")
    with refused("swng", "'swing'"):
        fl.best(one, minimise="swng")


@pytest.mark.parametrize("most", [1, 2, 7, 60])
def test_rows_are_read_as_they_are_numbered(most):
    values = xr.DataArray(np.arange(24.0).reshape(2, 3, 4), dims=("a", "b", "c"))
    rows = Rows.of([values.isel(b=0), values])
    parts = [values.isel(one) for one in ({}, {"b": 1}, {"a": 0, "b": 0}, {"a": 1, "b": 1, "c": 1})]
    for array in (*parts, values.transpose("c", "a", "b")):
        whole = array.broadcast_like(values).transpose(*values.dims).values.ravel()
        read = [rows.read(array, block) for block in rows.blocks(most)]
        assert_array_equal(np.concatenate(read), whole)
