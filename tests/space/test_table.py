"""Tables of designs from mappings, data frames, datasets and CSV files, and what is refused."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from numpy.testing import assert_array_equal
from tests.support.refusals import refused

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


def test_invalid_designs_are_kept_when_allowed(tmp_path):
    path = tmp_path / "designs.csv"
    path.write_text("a1,a2\n0.4,\nnan,1.5\n-inf,1.0\n")
    expected = {"a1": [0.4, np.nan, -np.inf], "a2": [np.nan, 1.5, 1.0]}
    for source in (path, expected, pd.DataFrame(expected)):
        designs = table(source, allow_invalid=True)
        for name, values in expected.items():
            assert_array_equal(designs.columns[name], values)


KEEP = "a finite number, or pass allow_invalid=True to keep such designs"
TABLE_ERRORS = {
    "unequal": (
        {"a1": [1, 2, 3], "a2": [1, 2]},
        "column a2",
        "one per design",
    ),
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
    "no text": (
        "",
        "d.csv",
        "the names of the columns in line 1, then one line per design",
    ),
    "no header": (
        "0.4,1.0\n0.5,1.0\n",
        "d.csv line 1",
        "the names of the columns in line 1",
    ),
    "no rows": ("a1,a2\n", "d.csv", "one line per design"),
    "unnamed": ("a1,\n0.4,0\n", "d.csv line 1", "name it by the input it holds"),
    "twins": (
        "a1,a1\n1,2\n",
        "d.csv line 1",
        "name each by the input it holds",
    ),
    "decimal commas": ("a1;a2\n1;2\n0,5;2\n", "row 1 (line 3) of column a1", "decimal=','"),
    "decimal commas alone": ("a1;a2\n1,5;2\n0,5;2\n", "row 0 (line 2) of column a1", "with a point"),
    "commas of both kinds": ("a1,a2\n0,4,1,2\n", "line 2", "numbers with a point"),
    "comment": (
        "# a1,a2\n1,2\n",
        "d.csv line 1",
        "the names of the columns alone in line 1",
    ),
    "short row": (
        "a1,a2\n1,2\n\n3\n",
        "d.csv line 4",
        "one cell per column",
    ),
    "text": (
        "a1,a2\n1,2\n3,four\n",
        "row 1 (line 3) of column a2",
        "a number",
    ),
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


def test_text_is_refused_even_where_invalid_designs_are_allowed(tmp_path):
    path = tmp_path / "d.csv"
    path.write_text("a1\nfour\n")
    with refused("'four'"):
        table(path, allow_invalid=True)


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
