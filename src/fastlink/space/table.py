"""Read tables of designs: mappings, data frames, datasets and CSV files."""

from __future__ import annotations

import csv
import math
import os
from array import array
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fastlink._text import counted
from fastlink.doors import door
from fastlink.errors import InputError, Remedy, Setting
from fastlink.space.design_space import DesignSpace, sampled
from fastlink.space.values import Floats, constant, first_invalid, numbers_of, short_repr


@door
def table(source: Any, *, allow_invalid: bool = False) -> DesignSpace:
    """Take one design per row of a table, along the dimension ``design``.

    Parameters
    ----------
    source : mapping, xarray.Dataset, pandas.DataFrame, str or path
        A mapping of names to columns of equal length, where a number is a constant; a Dataset, of which the
        1-D variables along one common dimension (and 1-D float coordinates that are not an index) are columns and
        0-d ones are constants; a DataFrame; or the path of a comma-separated UTF-8 file with the names in
        line 1.
    allow_invalid : bool, default False
        Keep rows that hold NaN, infinity or (in a file) an empty cell, instead of refusing the table.

    Returns
    -------
    DesignSpace
        Of kind ``"table"``.

    Examples
    --------
    >>> space = table({"a1": [0.4, 0.5, 0.6], "a2": [1.2, 1.2, 1.3], "a4": 1.0})
    >>> space.dims, space.size, space.constants
    (('design',), 3, {'a4': 1.0})
    """
    attrs: dict[str, str | int] = {"design_kind": "table"}
    if isinstance(source, (str, Path)):
        path = Path(os.path.expanduser(source))
        attrs["design_source"] = path.name
        return sampled("table", {}, _read_csv(path, allow_invalid), attrs)
    constants: dict[str, float] = {}
    columns: dict[str, Floats] = {}
    for name, given in _table_entries(source):
        values = numbers_of("table", name, given)
        if values.ndim == 0:
            constants[name] = constant("table", name, values)
        else:
            columns[name] = _column(name, values, columns, allow_invalid)
    if not columns:
        what = f"holds only single numbers ({', '.join(constants)})" if constants else "is empty"
        raise _refused(f"the table {what}", "give at least one column of values, or use grid")
    return sampled("table", constants, columns, attrs)


def _table_entries(source: Any) -> Iterator[tuple[str, Any]]:
    """Return name and values of each entry of a table that is in memory."""
    if hasattr(source, "data_vars"):
        return _dataset_entries(source)
    if hasattr(source, "columns") and hasattr(source, "to_numpy"):
        _check_names(list(source.columns))
        return ((name, source[name].to_numpy()) for name in source.columns)
    if isinstance(source, Mapping):
        _check_names(list(source))
        return iter(source.items())
    remedy = "give a mapping, an xarray.Dataset, a pandas.DataFrame or the path of a CSV file"
    raise _refused(f"{short_repr(source)} is not a table", remedy)


def _dataset_entries(dataset: Any) -> Iterator[tuple[str, Any]]:
    columns = dict(dataset.data_vars)
    for name, coord in dataset.coords.items():
        if name not in dataset.indexes and coord.ndim <= 1 and coord.dtype.kind == "f":
            columns[name] = coord
    _check_names(list(columns))
    along: dict[str, str] = {}
    for name, variable in columns.items():
        if variable.ndim > 1:
            remedy = "give 1-D variables, for instance by dataset[['a1', 'a2']]"
            raise InputError(
                f"has dimensions {tuple(variable.dims)}", where=("table", str(name)), remedy=remedy
            )
        for dim in variable.dims:
            along.setdefault(dim, name)
    if len(along) > 1:
        two = [f"{name} along {dim!r}" for dim, name in along.items()][:2]
        raise _refused(" but ".join(two), "give variables along one common dimension")
    return ((name, variable.values) for name, variable in columns.items())


def _check_names(names: Sequence[Any], inside: str = "") -> None:
    for index, name in enumerate(names):
        if not isinstance(name, str) or not name:
            raise _refused(f"{inside}column {index + 1} is named {name!r}", "name it by the input it holds")
        if name == "design":
            what = f"{inside}'design' is the name of the dimension"
            raise _refused(what, "leave out or rename that column")
        if name in names[:index]:
            raise _refused(f"{inside}two columns are named {name!r}", "name each by the input it holds")


def _refused(what: str, remedy: Remedy) -> InputError:
    return InputError(what, where=("table",), remedy=remedy)


def _column(name: str, values: Floats, others: Mapping[str, Floats], allow_invalid: bool) -> Floats:
    """Return the values of a table column, or refuse them."""
    if values.size == 0:
        raise _refused(f"column {name} is empty", "give at least one row")
    for other, known in others.items():
        if len(known) != len(values):
            what = f"column {name} has {counted(len(values), 'value')} but {other} has {len(known)}"
            raise _refused(what, "give one per design")
    bad = None if allow_invalid else first_invalid(values)
    if bad is not None:
        raise _invalid_cell(f"row {bad} (counted from 0) of column {name}", values[bad])
    return values


def _invalid_cell(cell: str, value: object) -> InputError:
    keep = (", or pass ", Setting("allow_invalid", True), " to keep such designs")
    return _refused(f"{cell} is {value}", ("write a finite number", keep))


def _read_csv(path: Path, allow_invalid: bool) -> dict[str, Floats]:
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            return _parse_csv(path.name, csv.reader(file, skipinitialspace=True), allow_invalid)
    except OSError as error:
        raise _refused(f"cannot read {path}: {error.strerror}", "give the path of a CSV file") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise _refused(f"{path} is not CSV text ({error})", "save it as comma-separated UTF-8") from error


def _parse_csv(file: str, reader: Any, allow_invalid: bool) -> dict[str, Floats]:
    """Return the columns of a CSV file; blank lines are skipped."""
    rows = (row for row in reader if any(cell.strip() for cell in row))
    names = _csv_names(file, next(rows, None), reader.line_num)
    columns = [array("d") for _ in names]
    for number, row in enumerate(rows):
        if len(row) != len(names):
            cells = counted(len(row), "cell")
            what = f"{file} line {reader.line_num} has {cells} but the header has {len(names)}"
            raise _refused(what, "write one cell per column")
        for name, column, text in zip(names, columns, row, strict=True):
            value = _number(text)
            if value is None or not math.isfinite(value):
                _check_cell(
                    f"row {number} (line {reader.line_num}) of column {name} in {file}", text, allow_invalid
                )
            column.append(math.nan if value is None else value)
    if not columns[0]:
        raise _refused(f"{file} has a header but no rows", "write one line per design")
    return {name: np.array(column) for name, column in zip(names, columns, strict=True)}


def _check_cell(cell: str, text: str, allow_invalid: bool) -> None:
    """Refuse a CSV cell that is not a finite number, unless these are allowed."""
    text = text.strip()
    if text and _number(text) is None:
        raise _refused(f"{cell} is {short_repr(text)}, not a number", "write a number")
    if not allow_invalid:
        raise _invalid_cell(cell, text or "empty")


def _csv_names(file: str, header: list[str] | None, line: int) -> list[str]:
    if header is None:
        remedy = "write the names of the columns in line 1, then one line per design"
        raise _refused(f"{file} is empty", remedy)
    names = [name.strip() for name in header]
    where = f"{file} line {line}"
    for name in names:
        if _number(name) is not None:
            what = f"{where} holds {name} instead of a name"
            raise _refused(what, "write the names of the columns in line 1")
        if ";" in name or "\t" in name:
            raise _refused(f"{where} reads {short_repr(name)}", "separate the columns by commas")
        if name.startswith("#"):
            what = f"{where} starts with '#'"
            raise _refused(what, "write the names of the columns alone in line 1")
    _check_names(names, f"{where}: ")
    return names


def _number(text: str) -> float | None:
    """Return a text as a number, or None."""
    try:
        return float(text)
    except ValueError:
        return None
