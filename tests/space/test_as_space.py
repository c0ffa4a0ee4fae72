"""What stands in place of a design space: tables, one design, Datasets; and labels of designs."""

import pickle
import tracemalloc
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal
from tests.support.refusals import refused
from tests.support.study_files import BARE, LENGTHS, written
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.engine.resolve import resolve
from fastlink.space.design_space import Converted, Counted, Gathered, definition_of
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


def test_single_arrays_and_labels_that_no_file_can_hold_are_refused():
    with refused("space", "the whole Dataset"):
        as_space(xr.DataArray([1.0], dims="a2"))
    with refused("name[1]", "letters alone"):
        as_space({**COLUMNS, "name": ["x", "\0"]})
    with refused("name[0]", "letters alone"):
        as_space({**COLUMNS, "name": ["\ud800", "y"]})
    with refused("grid", "by name"):
        grid([1.0, 2.0])
    with refused("grid: a1", "write it once"):
        grid({"a1": 1.0}, a1=2.0)


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


@pytest.mark.parametrize("name", ["", "a 1", "\0", "é", "a/b"])
def test_names_that_no_input_has(name):
    with refused("grid", "such as a2"):
        grid(**{name: 1.0})


@pytest.mark.parametrize("name", ["a/b", "a\nb", "x" * 300])
def test_names_that_no_coordinate_can_have(name):
    with refused("table", "short name"):
        as_space({**COLUMNS, name: ["x", "y"]})


# == Columns that are computed where they are looked at, and consecutive designs of any space ================

FIXED = {"a1": 0.4, "a4": 1.0, "omega1": 25.0}


def whole(space):
    rows = np.empty((len(space.names), space.size))
    space.fill(space.names, 0, space.size, rows)
    return dict(zip(space.names, rows, strict=True))


@st.composite
def spaces(draw):
    lengths = draw(st.lists(st.integers(1, 6), max_size=3))
    axes = {f"a{k + 2}": np.arange(n) + 10.0 * k for k, n in enumerate(lengths)}
    if draw(st.booleans()):
        return fl.grid(a1=0.4, **axes)
    count = draw(st.integers(1, 12))
    table = fl.table({"a1": np.arange(count) + 0.5, "a2": np.arange(count)[::-1] + 0.25, "d": 1.0})
    return table.with_axis("c", [1.0, 2.0, 3.0]) if draw(st.booleans()) else table


@settings(max_examples=150, deadline=None)
@given(spaces(), st.data())
def test_consecutive_designs_are_those_of_the_space_in_any_blocks(space, data):
    start = data.draw(st.integers(0, space.size - 1))
    stop = data.draw(st.integers(start + 1, space.size))
    expected, some = whole(space), space.consecutive(start, stop)
    assert (some.dims, some.shape, set(some.names)) == (("design",), (stop - start,), set(space.names))
    assert some.constants == space.constants
    assert_array_equal(some.labels["design"], np.arange(start, stop))
    for name, values in whole(some).items():
        assert_array_equal(values, expected[name][start:stop])
    first = data.draw(st.integers(0, some.size - 1))
    last = data.draw(st.integers(first + 1, some.size))
    again = some.consecutive(first, last)
    rows = np.empty((len(some.names), last - first))
    some.fill(some.names, first, last, rows)
    for name, row in zip(some.names, rows, strict=True):
        assert_array_equal(row, expected[name][start + first : start + last])
        assert_array_equal(again.values(name) if name in again.columns else row, row)
    assert_array_equal(again.labels["design"], np.arange(start + first, start + last))
    assert [again.attrs[f"design_{what}"] for what in ("start", "stop", "total")] == [
        start + first,
        start + last,
        space.size,
    ]


def test_labels_and_numbers_of_parts_are_those_of_the_whole():
    space = fl.table({"a2": [1.1, 1.2, 1.3], "maker": ["A", "B", "C"], "design": [7, 8, 9]})
    some = space.consecutive(1, 3)
    assert_array_equal(some.labels["maker"], ["B", "C"])
    assert_array_equal(some.labels["design"], [8, 9])
    crossed = space.with_axis("c", [1.0, 2.0]).consecutive(1, 4)
    assert_array_equal(crossed.labels["design"], [1, 2, 3])
    assert_array_equal(crossed.labels["maker"], ["A", "B", "B"])
    crossed = fl.table({"a1": np.arange(10.0)}).consecutive(4, 9).with_axis("c", [1.0, 2.0])
    some = crossed.consecutive(3, 6)
    assert_array_equal(some.labels["design"], [11, 12, 13])  # design 4 of the table is 8 and 9 of the whole
    assert some.attrs["design_total"] == 20
    assert_array_equal(some.columns["a1"], [5.0, 6.0, 6.0])
    assert_array_equal(some.columns["c"], [2.0, 1.0, 2.0])


@pytest.mark.parametrize(("start", "stop"), [(-1, 2), (3, 4), (1, 1), (0, 4), (0.0, 1)])
def test_designs_that_are_not_there_are_refused(start, stop):
    with refused("consecutive", "a whole number from"):
        fl.grid(a2=[1.0, 2.0, 3.0]).consecutive(start, stop)


def test_sweeps_of_consecutive_designs_give_the_bits_of_the_whole_in_degrees_too():
    space = fl.grid(a2=np.linspace(1.0, 1.4, 7), a3=np.linspace(0.6, 1.0, 11), **FIXED)
    names = ["omega4_max", "transmission_angle_min"]
    maps = sweep_4r(space, names)
    part = sweep_4r(space.consecutive(20, 60), names, threads=2, block=7)
    assert part.design.values.tolist() == list(range(20, 60))
    for name in names:
        assert_array_equal(part[name], maps[name].values.reshape(77, 2)[20:60])
    degrees = np.linspace(10.0, 80.0, 6)
    space = fl.grid(a2=[1.1, 1.2], a3=0.8, counterweight1_direction_deg=degrees, **FIXED)
    whole_map = sweep_4r(space, ["transmission_angle_min"])
    part = sweep_4r(space.consecutive(3, 9), ["transmission_angle_min"])
    radians = whole_map.counterweight1_direction.values
    assert_array_equal(radians, np.deg2rad(degrees))
    assert_array_equal(part.counterweight1_direction, np.tile(radians, 2)[3:9])


def test_values_that_an_input_cannot_have_are_named_with_their_number():
    space = fl.grid(a2=np.linspace(1.0, -0.5, 4), a3=[0.7, 0.8], **FIXED)
    sweep_4r(space.consecutive(0, 4), ["omega4_max"])  # none among these
    with refused("a2[3]", "a finite number greater than 0"):
        sweep_4r(space.consecutive(1, 8), ["omega4_max"])


def test_the_fingerprint_is_that_of_the_designs():
    def fingerprint(space):
        return resolve("planar_4r", space, ["omega4_max"], branch=(1, 2)).fingerprint

    space = fl.grid(a2=np.linspace(1.0, 1.4, 5), a3=[0.7, 0.8], **FIXED)
    one = fingerprint(space.consecutive(2, 8))
    assert one == fingerprint(fl.grid(a2=np.linspace(1.0, 1.4, 5), a3=[0.7, 0.8], **FIXED).consecutive(2, 8))
    others = [space, space.consecutive(2, 9), space.consecutive(1, 7)]
    others.append(fl.grid(a2=np.linspace(1.0, 1.4, 5), a3=[0.7, 0.9], **FIXED).consecutive(2, 8))
    assert len({one, *map(fingerprint, others)}) == 5


def test_a_part_of_ten_thousand_million_designs_needs_little_memory():
    axis = np.linspace(1.0, 1.2, 2155)  # 2155^3 > 10^10
    space = fl.grid(a2=axis, a3=axis - 0.3, a4=axis, a1=0.4)
    assert space.size > 10**10
    sweep_4r(space.consecutive(0, 1000), ["transmission_angle_min"])  # imports, kernel
    count = 100_000
    tracemalloc.start()
    maps = sweep_4r(space.consecutive(5 * 10**9, 5 * 10**9 + count), ["transmission_angle_min"])
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    # per design 2 x 8 bytes of results, 1 of status, 4 x 8 of coordinates: 4.9 MB, once more while they are labelled;
    # a thread's blocks of 4096 designs are below 1 MB
    assert peak < 2 * 49 * count + 2**22
    flat = maps.design.values[[0, -1]]
    assert_array_equal(maps.a4.values[[0, -1]], axis[flat % 2155])


COMPUTED = {
    "gathered": Gathered(np.linspace(1.0, 2.0, 7), 3, 5, 40),
    "gathered of a column": Gathered(Counted(3, 20), 2, 5, 30),
    "consecutive": Gathered(Counted(10, 50), 1, 7, 24),
    "counted": Counted(10**10, 33),
    "converted": Converted(Gathered(np.linspace(1.0, 2.0, 7), 1, 2, 20), Fraction(1, 1000)),
}


@pytest.mark.parametrize("column", COMPUTED.values(), ids=COMPUTED)
def test_a_column_reads_as_an_array(column):
    values = np.asarray(column)
    assert (values.shape, values.dtype) == (column.shape, column.dtype)
    assert len(column) == column.size == values.size
    assert values.nbytes == column.nbytes
    assert_array_equal(column[3:9], values[3:9])
    assert_array_equal(column[::-2], values[::-2])
    assert_array_equal(column[[1, 5]], values[[1, 5]])
    assert column[-1] == values[-1]
    assert list(column) == values.tolist()
    assert column.min() == values.min() >= column.bounds[0]
    assert column.max() == values.max() <= column.bounds[1]
    assert_array_equal(2 * column + 1, 2 * values + 1)
    assert_array_equal(pickle.loads(pickle.dumps(column)), values)
    assert definition_of(pickle.loads(pickle.dumps(column))) == column.definition
    assert "computed" in repr(column)
    with pytest.raises(IndexError):
        column[len(column)]
    with pytest.raises(AttributeError):
        column.nothing  # noqa: B018
    with pytest.raises(ValueError, match="copy"):
        np.array(column, copy=False)


def test_more_values_than_memory_holds_are_refused():
    with refused("100,000,000,000,000 values", "a part of it"):
        np.asarray(Counted(0, 10**14))


# == How a design space prints, also in a notebook ===========================================================


def test_a_grid_prints_its_axes_and_its_memory():
    space = fl.grid(a1=0.4, a2=np.linspace(1.0, 1.4, 101), a3=[0.7, 0.8], a4=1.0)
    first, header, *rows = str(space).splitlines()
    # 103 values of axes; four inputs of 202 designs
    assert first == "grid of 202 designs (101 x 2), 824 B in memory, 6.46 kB as a table of doubles"
    assert header.split() == ["input", "values", "from", "to", "units"]
    assert [row.split() for row in rows] == [
        ["a2", "101", "1", "1.4"],
        ["a3", "2", "0.7", "0.8"],
        ["a1", "one", "0.4"],
        ["a4", "one", "1"],
    ]
    page = space._repr_html_()
    assert page.count("<tr>") == 5
    assert "<td>1.4</td>" in page


def test_samples_tables_and_single_designs_print_themselves():
    assert repr(fl.grid(a1=0.4, a2=1.0, a3=1.0, a4=1.0)).startswith("grid of 1 design, 0 B in memory, 32 B")
    table = fl.table({"a1": [0.4, 0.5], "a2": [1.0, 1.1], "a3": 1.0, "a4": 1.0})
    assert "table of 2 designs" in repr(table)
    space = fl.sobol(10**10, a1=(0.1, 0.5), a2=(1.0, 2.0), a3=1.0, a4=1.0)
    assert "10,000,000,000 designs" in repr(space)
    assert "computed" in space._repr_html_()


def test_an_explanation_shows_first_what_a_run_needs(folder):
    page = fl.explain(written(f"{BARE}[design]\n{LENGTHS}"))._repr_html_()
    assert page.index("memory") < page.index("<details>") < page.index("left out")
