"""The best designs of a map: by one objective, and the front of several."""

from decimal import Decimal

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.maps import best
from fastlink.maps.best import Rows, nondominated, undominated


@pytest.fixture(scope="module")
def maps():
    space = fl.grid(
        a1=np.linspace(0.1, 1.5, 6), a2=np.linspace(0.65, 1.65, 7), a3=0.8, a4=[0.9, 1.0, 1.1], omega1=25.0
    )
    return sweep_4r(space, ["omega4_max", "transmission_angle_min", "theta4_max", "grashof_class"])


@pytest.fixture(scope="module")
def path(maps, tmp_path_factory):
    path = tmp_path_factory.mktemp("best") / "maps.h5"
    maps.to_netcdf(path, engine="h5netcdf")
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
def test_the_front_of_a_map(maps, path, monkeypatch, block):
    monkeypatch.setattr(best, "MOST_ROWS", block)
    mask = (maps.status == 0) & (maps.a1 <= 0.7) & (maps.transmission_angle_min >= 0.1)
    names, signs = ["omega4_max", "transmission_angle_min", "a1"], [1.0, -1.0, -1.0]
    points, places, whole = expected_rows(maps, names, signs, mask)
    kept = front_by_definition(points)
    assert 3 < len(kept) < len(points)
    where = {"status": "rotates fully", "a1": (None, 0.7), "transmission_angle_min": (0.1, None)}
    found = fl.best(path, minimise="omega4_max", maximise=["transmission_angle_min", "a1"], where=where)
    order = np.lexsort(points[kept].T[::-1])
    chosen = places[np.array(kept)[order]]
    for dim, numbers in zip(whole.dims, np.unravel_index(chosen, whole.shape), strict=True):
        assert_array_equal(found[dim], maps[dim].values[numbers])
    assert_array_equal(found.omega4_max, points[kept][order][:, 0])
    assert found.a3.dims == ()
    assert f"front of {len(kept)} of {int(mask.sum()):,} rows" in found.attrs["selection"]


def test_one_objective_and_its_conditions(maps):
    found = fl.best(
        maps, maximise="transmission_angle_min", where={"status": "rotates_fully", "a4": (1.0, 1.0)}, top=4
    )
    inside = maps.transmission_angle_min.where((maps.status == 0) & (maps.a4 == 1.0)).values.ravel()
    assert_array_equal(found.transmission_angle_min, np.sort(inside[np.isfinite(inside)])[::-1][:4])
    assert (found.a4 == 1.0).all()
    assert_array_equal(
        found.a2,
        maps.fastlink.top(4, "transmission_angle_min", where={"status": "rotates_fully", "a4": (1, 1)}).a2,
    )
    assert fl.best(maps, minimise="omega4_max").sizes["design"] == 10


def test_a_condition_may_have_more_dimensions_than_the_objective(maps):
    """A design is a row in each assembly mode where the condition asks for one."""
    of_design = maps.assign(size=maps.a1 + maps.a2)
    found = fl.best(of_design, minimise="size", where={"theta4_max": (None, 0.0)}, top=5)
    wanted = (of_design["size"].where(maps.theta4_max <= 0.0)).values.ravel()
    assert_array_equal(found["size"], np.sort(wanted[np.isfinite(wanted)])[:5])
    assert (found.theta4_max <= 0.0).all()


def test_infinite_objectives_count_if_asked(maps):
    without = fl.best(maps, maximise=["omega4_max", "a1"])
    assert np.isfinite(without.omega4_max).all()
    assert "infinite" in without.attrs["selection"]
    assert np.isinf(fl.best(maps, maximise=["omega4_max", "a1"], infinite=True).omega4_max).any()


def test_what_is_found_is_swept_again_to_the_same_bits(maps):
    found = fl.best(maps.sel(branch=1), maximise=["transmission_angle_min", "a1"], where="rotates fully")
    again = fl.sweep("planar_4r", found.fastlink.designs, ["omega4_max"], branch=1)
    assert_array_equal(again.omega4_max, found.omega4_max)


def test_of_one_design_there_is_no_best():
    one = sweep_4r({"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0}, ["swing"])
    with refused("one alone", "sweep several"):
        fl.best(one, minimise="swing")
    with refused("swng", "'swing'"):
        fl.best(one, minimise="swng")


def test_where_nothing_meets_the_conditions_the_nearest_rows_are_the_answer(maps):
    with pytest.warns(fl.InputWarning, match=r"where: none of (.+) rows meets all conditions: \1 fail a1;"):
        found = fl.best(maps, minimise=["a1", "a2"], where={"a1": (9.0, None)}, top=None)
    with pytest.warns(fl.InputWarning, match="none of .* fail omega4_max; these miss least"):
        maps.fastlink.top(1, "omega4_max", where={"omega4_max": (None, 1e-9)})
    assert found.a1.values[0] == maps.a1.values.max()
    assert found.missed.values[0] == f"a1 >= 9 by {9.0 - found.a1.values[0]:.6g} m"
    assert "none of" in found.attrs["selection"]
    met = fl.best(maps, minimize="a1", where={"a1": (None, maps.a1.values.min())})
    assert "missed" not in met.coords
    with refused("fail status", "widen"):
        fl.best(maps, minimise="a1", where="invalid_input")


@pytest.mark.parametrize("form", [0.25, "0.25", "0.25:0.25", (0.25, 0.25)])
def test_a_number_is_to_be_met(maps, form):
    a1 = float(maps.a1.values[1])
    form = {float: a1, str: str(form).replace("0.25", repr(a1)), tuple: (a1, a1)}[type(form)]
    found = fl.best(maps, minimise="omega4_max", where={"a1": form})
    assert set(found.a1.values) == {a1}
    again = fl.best(maps, minimise="omega4_max", where={"a1": f"{a1!r}:"})
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
def test_questions_without_an_answer_are_refused(maps, key, remedy, options):
    with refused(key, remedy):
        fl.best(maps, **options)


def test_all_problems_are_told_together(maps):
    with pytest.raises(fl.InputError) as caught:
        fl.best(maps, minimise=["omega_max", "a77"], where={"a9": (0, 1), "a1": (2, 1)}, top=0)
    assert len(str(caught.value).splitlines()) == 5


@pytest.mark.parametrize("most", [1, 2, 7, 60])
def test_rows_are_read_as_they_are_numbered(most):
    values = xr.DataArray(np.arange(24.0).reshape(2, 3, 4), dims=("a", "b", "c"))
    rows = Rows.of([values.isel(b=0), values])
    for array in (
        values,
        values.isel(b=1),
        values.isel(a=0, b=0),
        values.isel(a=1, b=1, c=1),
        values.transpose("c", "a", "b"),
    ):
        whole = array.broadcast_like(values).transpose(*values.dims).values.ravel()
        read = [rows.read(array, block) for block in rows.blocks(most)]
        assert_array_equal(np.concatenate(read), whole)
