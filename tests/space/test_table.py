"""Tables of designs from mappings, data frames, datasets and CSV files, and what is refused."""

import math
import pickle
import re
import sys
import tracemalloc
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
import xarray as xr
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal
from pyarrow import parquet
from tests.support.refusals import assert_refusal, refused
from tests.support.study_files import BARE, written
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.engine.resolve import resolve
from fastlink.space import tables
from fastlink.space.design_space import Column
from fastlink.space.tables import table

COLUMNS = {"a1": [0.4, 0.5, 0.6], "a2": [1.0, 1.5, 1.0]}


def assert_is_the_table(designs):
    assert (designs.kind, designs.dims, designs.shape) == ("table", ("design",), (3,))
    assert list(designs.columns) == list(COLUMNS)
    for name, values in COLUMNS.items():
        assert_array_equal(designs.columns[name], values)
        assert designs.columns[name].dtype == np.float64


def test_a_dataset():
    dataset = xr.Dataset(
        {"a1": ("design", COLUMNS["a1"]), "a4": 1.0},
        coords={
            "design": [5, 6, 7],
            "a2": ("design", COLUMNS["a2"]),
            "label": ("design", ["x", "y", "z"]),
            "rank": ("design", [3, 1, 2]),
            "a3": 0.8,
            "theta1": [0.0, 1.0],
        },
    )
    designs = table(dataset)
    assert_is_the_table(designs)
    assert designs.constants == {"a4": 1.0, "a3": 0.8}
    assert {name: label.tolist() for name, label in designs.labels.items()} == {
        "design": [5, 6, 7],
        "label": ["x", "y", "z"],
        "rank": [3, 1, 2],
    }


@pytest.mark.parametrize(
    "text",
    [
        "a1,a2\n0.4,1.0\n0.5,1.5\n0.6,1\n",
        "\ufeffa1,a2\r\n0.4,1.0\r\n0.5,1.5\r\n0.6,1e0",
        '\n a1 , "a2"\n\n0.4, 1.0\n , \n"0.5",1.5\n\n0.6,+1.00\n\n',
    ],
    ids=["plain", "byte-order mark and CRLF", "blank lines, spaces and quotes"],
)
@pytest.mark.parametrize("kind", [str, lambda path: path])
def test_a_csv_file(tmp_path, text, kind):
    path = tmp_path / "designs.csv"
    path.write_text(text, encoding="utf-8", newline="")
    designs = table(kind(path))
    assert_is_the_table(designs)
    assert designs.attrs == {"design_kind": "table", "design_source": "designs.csv"}


def test_invalid_designs_are_kept_when_allowed_but_no_text(tmp_path):
    path = tmp_path / "designs.csv"
    path.write_text("a1,a2\n0.4,\nnan,1.5\n-inf,1.0\n")
    expected = {"a1": [0.4, np.nan, -np.inf], "a2": [np.nan, 1.5, 1.0]}
    for source in (path, expected, pd.DataFrame(expected)):
        designs = table(source, allow_invalid=True)
        for name, values in expected.items():
            assert_array_equal(designs.columns[name], values)
    path = tmp_path / "d.csv"
    path.write_text("a1\nfour\n")
    with refused("'four'"):
        table(path, allow_invalid=True)


KEEP = "a finite number, or pass allow_invalid=True to keep such designs"
TABLE_ERRORS = {
    "unequal": ({"a1": [1, 2, 3], "a2": [1, 2]}, "column a2", "one per design"),
    "inf": ({"a1": [np.inf, 2]}, "row 0 (counted from 0) of column a1", KEEP),
    "nan constant": ({"a1": [1, 2], "a2": np.nan}, "a2", "a finite number"),
    "no rows": ({"a1": []}, "column a1", "at least one row"),
    "empty": ({}, "the table", "at least one column of values, or use grid"),
    "number as name": ({1: [1.0]}, "column 1", "name it by the input it holds"),
    "frame with twins": (
        pd.DataFrame([[1.0, 2.0]], columns=["a1", "a1"]),
        "two columns are named 'a1'",
        "name each by the input it holds",
    ),
    "map": (
        xr.Dataset({"omega4_max": (("design", "branch"), np.ones((3, 2)))}),
        "omega4_max",
        "1-D variables, for instance by dataset[['a1', 'a2']]",
    ),
    "two dimensions": (
        xr.Dataset({"a1": ("x", [1.0]), "a2": ("y", [1.0])}),
        "a1",
        "variables along one common dimension",
    ),
    "list": (
        [1.0],
        "[1.0]",
        "a mapping, an xarray.Dataset, a pandas.DataFrame or the path of a CSV or Parquet file",
    ),
}


@pytest.mark.parametrize(("source", "key", "remedy"), TABLE_ERRORS.values(), ids=TABLE_ERRORS)
def test_a_bad_table_is_refused_in_one_line(source, key, remedy):
    with refused(key, remedy):
        table(source)


CSV_ERRORS = {
    "no text": ("", "d.csv", "the names of the columns in line 1, then one line per design"),
    "no header": ("0.4,1.0\n0.5,1.0\n", "d.csv line 1", "the names of the columns in line 1"),
    "no rows": ("a1,a2\n", "d.csv", "one line per design"),
    "unnamed": ("a1,\n0.4,0\n", "d.csv line 1", "name it by the input it holds"),
    "twins": ("a1,a1\n1,2\n", "d.csv line 1", "name each by the input it holds"),
    "decimal commas": ("a1;a2\n1;2\n0,5;2\n", "row 1 (line 3) of column a1", "decimal=','"),
    "decimal commas alone": ("a1;a2\n1,5;2\n0,5;2\n", "row 0 (line 2) of column a1", "with a point"),
    "commas of both kinds": ("a1,a2\n0,4,1,2\n", "line 2", "numbers with a point"),
    "comment": ("# a1,a2\n1,2\n", "d.csv line 1", "the names of the columns alone in line 1"),
    "short row": ("a1,a2\n1,2\n\n3\n", "d.csv line 4", "one cell per column"),
    "text": ("a1,a2\n1,2\n3,four\n", "row 1 (line 3) of column a2", "a number"),
    "empty cell": ("a1,a2\n1,\n", "row 0 (line 2) of column a2", KEEP),
    "a quote in a number": ('a1,a2\n0.4,"1.2"5\n', "CSV text", "UTF-8"),
    "digits of another script": ("a1,a2\n0.3,1.0\n0.4,١\n", "row 1 (line 3) of column a2", "a number"),
    "lines within quotes": ('name,a2\n"two\nlines",1.0\nx,y\n', "row 1 (line 4) of column a2", "a number"),
    "the first of two": ("a1,a2\n0.3,1\n0.3,x\n0.4\n", "line 4 has 1 cell", "one cell per column"),
    "an empty unit in a name": ("a1,a2 []\n0.4,1.0\n", "'a2 []'", "such as a2"),
    "a number among texts": ("a1,a2\nx,1\n2,1\n", "row 0 (line 2) of column a1 in d.csv is 'x'", "a number"),
    "overflow": ("a1\n1e999\n", "row 0 (line 2) of column a1", KEEP),
}


@pytest.mark.parametrize(("text", "key", "remedy"), CSV_ERRORS.values(), ids=CSV_ERRORS)
def test_a_bad_csv_file_is_refused_in_one_line(tmp_path, text, key, remedy):
    path = tmp_path / "d.csv"
    path.write_text(text, encoding="utf-8")
    with refused(key, remedy):
        table(path)


def test_files_that_cannot_be_read(tmp_path):
    missing = tmp_path / "none.csv"
    with refused(str(missing), "the path of a CSV file"):
        table(str(missing))
    with refused("~nobody-of-that-name/d.csv"):
        table("~nobody-of-that-name/d.csv")
    with refused(str(tmp_path), "the path of a CSV file"):
        table(tmp_path)
    with refused("is a device or a pipe", "the path of a CSV file"):
        table("/dev/zero")
    binary = tmp_path / "binary.csv"
    binary.write_bytes(b"a1,a2\n\xff\xfe\x00\n")
    with refused("binary.csv", "UTF-8"):
        table(binary)


# == Tables in files, small ones in memory and large ones block by block: the same designs, labels and refusals

FIXED = {"a1": 0.4, "a4": 1.0, "omega1": 25.0}


@pytest.fixture
def every_file_is_large(monkeypatch):
    monkeypatch.setattr(tables, "LARGE", 0)
    monkeypatch.setattr(tables, "BLOCK_ROWS", 3)


def outcome(path, **options):
    """Return what a table gives: its columns, constants and labels, or the text of its refusal."""
    try:
        space = fl.table(path, **options)
    except fl.InputError as error:
        return str(error)
    columns = {name: np.asarray(values).tolist() for name, values in space.columns.items()}
    return repr((space.shape, space.constants, columns, {k: v.tolist() for k, v in space.labels.items()}))


CELLS = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False).map(repr),
    st.sampled_from(
        ["", " 1.5 ", "1e5", "nan", "inf", "x", "1_0", "1,5", '"2.5"', "7", "007", '"two\nlines"']
    ),
)
NUMBERS = st.floats(-1e9, 1e9).map(repr)


@settings(max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_a_text_file_reads_the_same_in_memory_and_block_by_block(tmp_path, monkeypatch, data):
    names = data.draw(
        st.lists(
            st.sampled_from(["a1", "a2", "a3", "maker", "part_id", ""]), min_size=1, max_size=4, unique=True
        )
    )
    kinds = [data.draw(st.sampled_from([NUMBERS, NUMBERS, CELLS])) for _ in names]
    rows = data.draw(st.lists(st.tuples(*kinds), max_size=11))
    ends = [
        data.draw(st.sampled_from(["\n", "\n", "\r\n", "\n\n", "\n , \n" if len(names) == 2 else "\n"]))
        for _ in rows
    ]
    text = ",".join(names) + "\n" + "".join(",".join(row) + end for row, end in zip(rows, ends, strict=True))
    path = tmp_path / "designs.csv"
    path.write_text(data.draw(st.sampled_from(["", "\ufeff"])) + text, newline="")
    allow_invalid = data.draw(st.booleans())
    expected = outcome(path, allow_invalid=allow_invalid)
    with monkeypatch.context() as patched:
        patched.setattr(tables, "LARGE", 0)
        patched.setattr(tables, "BLOCK_ROWS", data.draw(st.integers(1, 4)))
        assert outcome(path, allow_invalid=allow_invalid) == expected


FRAME = pd.DataFrame(
    {
        "a2": np.linspace(1.0, 1.4, 50),
        "a3": np.linspace(0.6, 1.0, 50),
        "maker": [f"No. {k % 7}" for k in range(50)],
        "part_id": np.arange(50) + 100,
    }
)
WRITERS = {
    "csv": lambda frame, path: frame.to_csv(path, index=False),
    "semicolons": lambda frame, path: frame.to_csv(path, index=False, sep=";"),
    "parquet": lambda frame, path: frame.to_parquet(path, row_group_size=7),
    "one group": lambda frame, path: frame.to_parquet(path),
    "categories": lambda frame, path: frame.astype({"maker": "category"}).to_parquet(path, row_group_size=20),
    "index": lambda frame, path: frame.set_index("part_id").to_parquet(path),
}


@pytest.mark.parametrize("write", WRITERS.values(), ids=WRITERS)
def test_a_large_file_is_a_table_that_is_held_nowhere(tmp_path, every_file_is_large, write):
    path = tmp_path / "designs"
    write(FRAME, path)
    space = fl.table(path)
    assert (space.kind, space.shape, space.attrs["design_source"]) == ("table", (50,), "designs")
    assert list(space.columns) == ["a2", "a3"]
    for name, column in space.columns.items():
        assert isinstance(column, Column)
        assert_array_equal(column, FRAME[name])
        assert column.bounds == (FRAME[name].min(), FRAME[name].max())
        assert_array_equal(pickle.loads(pickle.dumps(column))[5:20], FRAME[name][5:20])
    for name in ("maker", "part_id"):
        assert_array_equal(space.labels[name], FRAME[name])
    with ThreadPoolExecutor(4) as pool:
        pieces = list(pool.map(lambda k: space.columns["a3"].piece(k, k + 5), list(range(0, 50, 5)) * 10))
    assert_array_equal(np.concatenate(pieces), np.tile(FRAME["a3"], 10))


@pytest.mark.parametrize("write", [WRITERS["csv"], WRITERS["parquet"]], ids=["csv", "parquet"])
def test_a_sweep_of_a_large_file_has_the_bits_of_one_in_memory(tmp_path, every_file_is_large, write):
    path, names = tmp_path / "designs", ["omega4_max", "transmission_angle_min"]
    write(FRAME, path)
    space = fl.table(path).with_constants(FIXED)
    expected = sweep_4r(fl.table(FRAME).with_constants(FIXED), names)
    with sweep_4r(space, names, to=tmp_path / "m.h5", verify=2, block=8, threads=2) as maps:
        for name in expected.variables:
            assert_array_equal(maps[name], expected[name])
    part = sweep_4r(space.consecutive(11, 30), names)
    assert_array_equal(part.omega4_max, expected.omega4_max[11:30])
    assert_array_equal(part.maker, expected.maker[11:30])


def test_the_fingerprint_is_that_of_the_numbers(tmp_path, every_file_is_large):
    def fingerprint(frame, name, **options):
        frame.to_parquet(tmp_path / name, **options)
        space = fl.table(tmp_path / name).with_constants(FIXED)
        return resolve("planar_4r", space, ["omega4_max"], branch=(1, 2)).fingerprint

    frame = FRAME[["a2", "a3"]]
    one = fingerprint(frame, "one.parquet", row_group_size=7)
    (tmp_path / "again").mkdir()
    assert fingerprint(frame, "again/one.parquet", row_group_size=20) == one
    assert fingerprint(frame.assign(a3=frame.a3.to_numpy()[::-1]), "one.parquet") != one


@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize(
    ("change", "key", "remedy"),
    [
        ({"a2": [1.0, np.nan, 1.2, np.inf]}, "row 1 (counted from 0) of column a2", "a finite number"),
        ({"a2": [1.0, None, 1.2, 1.3]}, "row 1 (counted from 0) of column a2", "a finite number"),
        ({"a 2": [1.0, 1.1, 1.2, 1.3]}, "'a 2' is no name of an input", "such as a2"),
        ({"a2": pd.to_datetime(["2026-01-01"] * 4)}, "a2", "numbers"),
        ({"a2": [[1.0], [2.0], [1.0], [3.0]]}, "a2", "number"),
        ({"a2": []}, "no rows", "one row per design"),
    ],
)
def test_what_a_parquet_file_cannot_hold_is_refused(tmp_path, monkeypatch, large, change, key, remedy):
    path = tmp_path / "designs.parquet"
    pd.DataFrame(change).to_parquet(path, row_group_size=2)
    if large:
        monkeypatch.setattr(tables, "LARGE", 0)
    with pytest.raises(fl.InputError) as caught:
        fl.table(path)
    assert remedy in str(caught.value)
    assert_refusal(caught.value, key.split()[-1] if "row" in key else key.split(" is ")[0].strip("'"))


def test_other_bytes_are_refused_and_an_absent_pyarrow_is_named(tmp_path, monkeypatch):
    path = tmp_path / "designs.parquet"
    path.write_bytes(b"PAR1" + b"nothing" * 10)
    with refused("cannot be read as Parquet"):
        fl.table(path)
    with refused("none.parquet", "the path of a Parquet file"):
        fl.table(tmp_path / "none.parquet")
    FRAME.to_parquet(tmp_path / "d.parquet")
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with refused("pyarrow", "python -m pip install pyarrow"):
        fl.table(tmp_path / "d.parquet")


def test_invalid_numbers_are_kept_when_told(tmp_path, every_file_is_large):
    pd.DataFrame({"a2": [1.0, None, 1.2, np.inf]}).to_parquet(tmp_path / "d.parquet", row_group_size=2)
    space = fl.table(tmp_path / "d.parquet", allow_invalid=True)
    assert_array_equal(space.columns["a2"], [1.0, np.nan, 1.2, np.inf])
    assert math.isnan(space.columns["a2"].bounds[0])


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_a_file_that_changes_is_noticed(tmp_path, every_file_is_large, kind):
    WRITERS[kind](FRAME, tmp_path / "d")
    space = fl.table(tmp_path / "d")
    WRITERS[kind](FRAME[:40], tmp_path / "d")
    with refused("changed since it was read", "until the sweep has ended"):
        space.columns["a2"].piece(0, 5)


def test_a_study_takes_a_parquet_file(folder):
    FRAME[["a2", "a3"]].to_parquet("d.parquet")
    with fl.run(written(f'{BARE}design = {{table = "d.parquet", a1 = 0.4, a4 = 1.0}}')) as maps:
        assert maps.sizes["design"] == 50
        assert_array_equal(maps.a3, FRAME["a3"])


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_a_large_file_needs_little_memory(tmp_path, monkeypatch, kind):
    rows = 20_000
    table = pa.table({name: np.linspace(1.0, 1.4, rows) for name in ("a1", "a2", "a3", "a4")})
    path = tmp_path / "d"
    if kind == "csv":
        from pyarrow import csv

        csv.write_csv(table, path)
    else:
        parquet.write_table(table, path, row_group_size=500)
    monkeypatch.setattr(tables, "LARGE", 0)
    monkeypatch.setattr(tables, "BLOCK_ROWS", 500)
    monkeypatch.setattr(tables, "KEPT_BYTES", 0)
    tracemalloc.start()
    space = fl.table(path)
    out = np.empty((4, 500))
    for start in range(0, rows, 500):
        space.fill(["a1", "a2", "a3", "a4"], start, start + 500, out)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    # the numbers alone are 0.64 MB; three blocks of 500 rows have 0.05 MB of them, and one as texts of 80 bytes 0.16 MB
    assert peak < 8 * 4 * rows


@pytest.mark.parametrize("cells", [[0.8, "n/a"], ["n/a", "n/a"], ["red", 0.8], [None, 0.8], [None, None]])
@pytest.mark.parametrize("unit", ["", " [mm]"])
def test_an_input_without_numbers_is_kept_if_allowed_and_never_a_label(tmp_path, cells, unit):
    cells = [1000 * cell if unit and isinstance(cell, float) else cell for cell in cells]
    frame = pd.DataFrame({"a1": 0.4, "a2": 1.2, "a4": 1.0, f"a3{unit}": pd.Series(cells, dtype=object)})
    frame.to_csv(tmp_path / "d.csv", index=False)
    bad = [k for k, cell in enumerate(cells) if not isinstance(cell, float)]
    for source in (frame, tmp_path / "d.csv"):
        with pytest.raises(fl.InputError, match=r"write .*number.* allow_invalid=True") as caught:
            fl.sweep("planar_4r", source, ["swing"])
        assert "keep=" not in str(caught.value)
        kept = fl.sweep("planar_4r", source, ["swing"], allow_invalid=True)
        assert np.flatnonzero(np.isnan(kept.swing)).tolist() == bad
        assert np.flatnonzero(kept.status == 4).tolist() == bad


def test_all_bad_rows_are_named_at_once_and_may_be_kept(tmp_path):
    """Texts, empty cells and numbers that no length has; a study keeps them too."""
    rows = [[0.4, 1.2, 0.8, 1.0] for _ in range(500)]
    rows[17][1], rows[200][0], rows[333][1], rows[400][0] = "", -0.4, "n/a", 0.0
    lines = ["a1,a2,a3,a4", *(",".join(map(str, row)) for row in rows)]
    (tmp_path / "d.csv").write_text("\n".join(lines))
    with pytest.raises(fl.InputError) as caught:
        sweep_4r(tmp_path / "d.csv", ["swing"])
    cells, numbers = str(caught.value).splitlines()
    assert "row 17 (line 19) of column a2 in d.csv is empty, row 333 (line 335) is 'n/a'; write" in cells
    assert "a1[200] is -0.4, 0.0 at 400 (" in numbers
    kept = sweep_4r(tmp_path / "d.csv", ["swing"], allow_invalid=True)
    assert np.flatnonzero(np.isnan(kept.swing)).tolist() == [17, 200, 333, 400]
    study = 'mechanism = "planar_4r"\nquantities = ["swing"]\n[design]\ntable = "d.csv"\n'
    (tmp_path / "s.toml").write_text(study)
    with pytest.raises(fl.InputError) as caught:
        fl.run(tmp_path / "s.toml", to=tmp_path / "s.h5")
    assert re.findall(r"row 17 |-0.4, 0.0 at 400|allow_invalid = true", str(caught.value)) == [
        *("row 17 ", "allow_invalid = true"),
        *("-0.4, 0.0 at 400", "allow_invalid = true"),
    ]
    with pytest.raises(fl.InputError, match="allow_invalid=True"):  # of the sweep, after that of the table
        fl.sweep("planar_4r", fl.table(tmp_path / "d.csv", allow_invalid=True), ["swing"])
    (tmp_path / "s.toml").write_text(study + "allow_invalid = true\n")
    with fl.run(tmp_path / "s.toml", to=tmp_path / "s.h5") as found:
        np.testing.assert_array_equal(found.swing, kept.swing)
