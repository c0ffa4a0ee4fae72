"""What stands in place of a design space: tables, one design, Datasets; and labels of designs."""

from decimal import Decimal

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from numpy.testing import assert_array_equal
from tests.support.refusals import refused

from fastlink.space.samplers import grid
from fastlink.space.tables import as_space, table

COLUMNS = {"a1": [0.4, 0.5], "a2": [1.1, 1.2]}
FRAME = pd.DataFrame(COLUMNS)
ROWS = [{"a1": 0.4, "a2": 1.1}, {"a1": 0.5, "a2": 1.2}]


class Polars:
    """The parts of a polars.DataFrame that are used: no index, names in a list."""

    columns = ("a1", "a2")

    def __getitem__(self, name):
        return pd.Series(COLUMNS[name])

    def __len__(self):
        return 2

    to_numpy = None


SOURCES = {
    "mapping": COLUMNS,
    "decimals of a database": {name: [Decimal(str(x)) for x in values] for name, values in COLUMNS.items()},
    "frame": FRAME,
    "nullable": FRAME.convert_dtypes(),
    "polars": Polars(),
    "records": FRAME.to_records(index=False),
    "rows": ROWS,
    "dataset": FRAME.to_xarray(),
    "dataset along another dimension": FRAME.to_xarray().rename(index="row").drop_vars("row"),
    "space": table(COLUMNS),
    "mapping of labelled arrays": {name: xr.DataArray(values, dims="k") for name, values in COLUMNS.items()},
}


@pytest.mark.parametrize("source", SOURCES.values(), ids=SOURCES)
def test_a_table_of_any_kind_is_a_space(source):
    for space in (as_space(source), table(source)):
        assert (space.kind, space.dims, space.size, space.constants) == ("table", ("design",), 2, {})
        for name, values in COLUMNS.items():
            assert_array_equal(space.columns[name], values)
        assert space.labels == {}


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("index", [True, False])
def test_a_file_of_pandas_is_read(tmp_path, separator, index):
    FRAME.to_csv(tmp_path / "designs.csv", sep=separator, index=index)
    space = as_space(str(tmp_path / "designs.csv"))
    assert list(space.columns) == ["a1", "a2"]
    assert space.labels == {}
    for name, values in COLUMNS.items():
        assert_array_equal(space.columns[name], values)


@pytest.mark.parametrize("one", [ROWS[0], FRAME.iloc[0], FRAME.iloc[0].to_dict(), grid(**ROWS[0])])
def test_single_numbers_are_one_design(one):
    space = as_space(one)
    assert (space.dims, space.constants) == ((), ROWS[0])


def test_coordinates_alone_are_a_grid():
    space = as_space(xr.Dataset(coords={"a2": [1.1, 1.2], "a3": [0.7, 0.8, 0.9], "a1": 0.4}))
    assert (space.kind, space.dims, space.shape) == ("grid", ("a2", "a3"), (2, 3))
    assert space.constants == {"a1": 0.4}
    flat = table(xr.Dataset(coords={"a2": [1.1, 1.2], "a3": [0.7, 0.8, 0.9], "a1": 0.4}))
    assert_array_equal(flat.columns["a2"], [1.1, 1.1, 1.1, 1.2, 1.2, 1.2])
    assert_array_equal(flat.columns["a3"], [0.7, 0.8, 0.9, 0.7, 0.8, 0.9])


NO_SPACES = {
    "nothing": None,
    "number": 42,
    "array": np.ones((3, 4)),
    "list": [1.0, 2.0],
    "set": {1.0, 2.0},
    "generator": (k for k in range(3)),
    "function": grid,
}


@pytest.mark.parametrize("source", NO_SPACES.values(), ids=NO_SPACES)
def test_anything_else_is_refused_with_what_is_possible(source):
    with refused("space", "fastlink.grid(...)"):
        as_space(source)


def test_one_array_of_a_map_is_refused_with_the_whole():
    with refused("space", "the whole Dataset"):
        as_space(xr.DataArray([1.0], dims="a2"))


LABELLED = {
    "names": (pd.DataFrame(COLUMNS, index=["x", "y"]), {"index": ["x", "y"]}),
    "named": (pd.DataFrame(COLUMNS, index=pd.Index([7, 9], name="part")), {"part": [7, 9]}),
    "filtered": (pd.DataFrame(COLUMNS, index=[3, 5]), {"index": [3, 5]}),
    "two levels": (
        pd.DataFrame(COLUMNS, index=pd.MultiIndex.from_tuples([("x", 1), ("y", 2)], names=["maker", None])),
        {"maker": ["x", "y"], "level_1": [1, 2]},
    ),
    "text": (FRAME.assign(maker=["x", None]), {"maker": ["x", ""]}),
    "id": ({**COLUMNS, "part_id": [7, 9]}, {"part_id": [7, 9]}),
    "category": (FRAME.assign(maker=pd.Categorical(["x", "y"])), {"maker": ["x", "y"]}),
    "scalar": ({**COLUMNS, "maker": "x"}, {"maker": "x"}),
    "coordinate": (FRAME.to_xarray().assign_coords(index=["x", "y"]), {"index": ["x", "y"]}),
    "dates": (
        pd.DataFrame(COLUMNS, index=pd.DatetimeIndex(["2026-01-01", "2026-01-02"], name="day").as_unit("s")),
        {"day": ["2026-01-01T00:00:00", "2026-01-02T00:00:00"]},
    ),
}


@pytest.mark.parametrize(("source", "labels"), LABELLED.values(), ids=LABELLED)
def test_what_tells_designs_apart_is_a_label(source, labels):
    space = as_space(source)
    assert list(space.columns) == ["a1", "a2"]
    assert {name: label.tolist() for name, label in space.labels.items()} == labels


def test_further_columns_are_kept_on_demand(tmp_path):
    frame = FRAME.assign(part_no=[7, 9], checked=[True, False])
    for keep in (["part_no", "checked"], ("checked", "part_no")):
        space = table(frame, keep=keep)
        assert {name: label.tolist() for name, label in space.labels.items()} == {
            "part_no": [7, 9],
            "checked": [1, 0],
        }
    FRAME.assign(part_no=["007", "009"]).to_csv(tmp_path / "d.csv", index=False)
    space = table(tmp_path / "d.csv", keep="part_no")
    assert space.labels["part_no"].tolist() == ["007", "009"]
    with refused("'part_nr'", "leave it out"):
        table(frame, keep=["part_no", "checked", "part_nr"])
    with refused("keep", "names of columns"):
        table(frame, keep=[7])


def test_labels_that_no_file_can_hold_are_refused():
    with refused("name[1]", "letters alone"):
        as_space({**COLUMNS, "name": ["x", "\0"]})
    with refused("name[0]", "letters alone"):
        as_space({**COLUMNS, "name": ["\ud800", "y"]})


class Quantity(list):
    """A list with a unit, as packages for units have: a conversion to an array drops it."""

    units = "millimeter"
    magnitude = 1100.0


def test_a_unit_is_not_dropped():
    for values in (Quantity([1100.0, 1200.0]), [Quantity(), Quantity()]):
        with refused("a2", ".m_as('m')"):
            grid(a2=values)
        with refused("a2", ".m_as('m')"):
            table({"a2": values})
    assert grid(a2=xr.DataArray([1.0], attrs={"units": "mm"})).units == {"a2": "mm"}
    assert table({"a2": xr.DataArray([1.0], attrs={"units": "mm"})}).units == {"a2": "mm"}
    fast = xr.DataArray(60.0, attrs={"units": "rpm"})
    assert grid(a2=1.0).with_axis("omega1", fast).units == {"omega1": "rpm"}
    assert grid(a2=1.0).with_constants({"omega1": fast, "a2": fast}).units == {
        "omega1": "rpm"
    }  # a2 keeps its value


AXES = {
    "range": range(3),
    "series": pd.Series([0, 1, 2]),
    "labelled": xr.DataArray([0, 1, 2], dims="k"),
    "tuple": (0.0, 1.0, 2.0),
}


@pytest.mark.parametrize("axis", AXES.values(), ids=AXES)
def test_axes_of_any_kind(axis):
    assert_array_equal(grid(a2=axis).axes["a2"], [0.0, 1.0, 2.0])
    assert grid({"a2": axis, "a1": 1.0}, a4=2.0).names == ("a2", "a1", "a4")


@pytest.mark.parametrize("axis", [(k for k in range(3)), {0.0, 1.0}, {"a": 1.0}.values(), map(float, "12")])
def test_what_has_no_order_or_length_is_no_axis(axis):
    with refused("grid: a2", "a flat list of numbers"):
        grid(a2=axis)


def test_a_grid_of_something_else():
    with refused("grid", "by name"):
        grid([1.0, 2.0])
    with refused("grid: a1", "write it once"):
        grid({"a1": 1.0}, a1=2.0)


@pytest.mark.parametrize("name", ["", "a 1", "\0", "é", "a/b"])
def test_names_that_no_input_has(name):
    with refused("grid", "such as a2"):
        grid(**{name: 1.0})


@pytest.mark.parametrize("name", ["a/b", "a\nb", "x" * 300])
def test_names_that_no_coordinate_can_have(name):
    with refused("table", "short name"):
        as_space({**COLUMNS, name: ["x", "y"]})
