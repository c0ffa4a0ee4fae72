"""Columns that are computed where they are looked at, and consecutive designs of any space."""

import pickle
import tracemalloc
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal
from tests.support.four_bar import sweep_4r
from tests.support.refusals import refused

import fastlink as fl
from fastlink.engine.resolve import resolve
from fastlink.space.design_space import Consecutive, Converted, Counted, Gathered, definition_of

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


def test_a_part_of_a_part_with_one_more_axis_has_the_numbers_of_the_whole():
    crossed = fl.table({"a1": np.arange(10.0)}).consecutive(4, 9).with_axis("c", [1.0, 2.0])
    some = crossed.consecutive(3, 6)
    assert_array_equal(some.labels["design"], [11, 12, 13])  # design 4 of the table is 8 and 9 of the whole
    assert some.attrs["design_total"] == 20
    assert_array_equal(some.columns["a1"], [5.0, 6.0, 6.0])
    assert_array_equal(some.columns["c"], [2.0, 1.0, 2.0])


def test_labels_come_along():
    space = fl.table({"a2": [1.1, 1.2, 1.3], "maker": ["A", "B", "C"], "design": [7, 8, 9]})
    some = space.consecutive(1, 3)
    assert_array_equal(some.labels["maker"], ["B", "C"])
    assert_array_equal(some.labels["design"], [8, 9])
    crossed = space.with_axis("c", [1.0, 2.0]).consecutive(1, 4)
    assert_array_equal(crossed.labels["design"], [1, 2, 3])
    assert_array_equal(crossed.labels["maker"], ["A", "B", "B"])


@pytest.mark.parametrize(("start", "stop"), [(-1, 2), (3, 4), (1, 1), (0, 4), (0.0, 1)])
def test_designs_that_are_not_there_are_refused(start, stop):
    with refused("consecutive", "a whole number from"):
        fl.grid(a2=[1.0, 2.0, 3.0]).consecutive(start, stop)


def test_a_sweep_of_consecutive_designs_gives_the_bits_of_the_whole():
    space = fl.grid(a2=np.linspace(1.0, 1.4, 7), a3=np.linspace(0.6, 1.0, 11), **FIXED)
    names = ["omega4_max", "transmission_angle_min"]
    maps = sweep_4r(space, names)
    part = sweep_4r(space.consecutive(20, 60), names, threads=2, block=7)
    assert part.design.values.tolist() == list(range(20, 60))
    for name in names:
        assert_array_equal(part[name], maps[name].values.reshape(77, 2)[20:60])


def test_angles_in_degrees_are_converted_block_by_block():
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


COLUMNS = {
    "gathered": Gathered(np.linspace(1.0, 2.0, 7), 3, 5, 40),
    "gathered of a column": Gathered(Counted(3, 20), 2, 5, 30),
    "consecutive": Consecutive(Counted(10, 50), 7, 31),
    "counted": Counted(10**10, 33),
    "converted": Converted(Gathered(np.linspace(1.0, 2.0, 7), 1, 2, 20), Fraction(1, 1000)),
}


@pytest.mark.parametrize("column", COLUMNS.values(), ids=COLUMNS)
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
