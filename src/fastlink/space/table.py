"""Read tables of designs: mappings, data frames, datasets, CSV and Parquet files."""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

from fastlink._text import short_repr, writable
from fastlink.doors import door
from fastlink.errors import InputError, suggest
from fastlink.options import check_path, check_switch
from fastlink.space.columns import Columns, check_name, refused
from fastlink.space.csv_file import read_csv
from fastlink.space.dataset import space_of_dataset
from fastlink.space.design_space import DESIGN, DesignSpace, flat
from fastlink.space.parquet_file import is_parquet, read_parquet
from fastlink.space.values import has, read_or_none

__all__ = ["as_space", "table"]

SOURCES = "a mapping, an xarray.Dataset, a pandas.DataFrame or the path of a CSV or Parquet file"


@door
def table(source: Any, *, keep: Sequence[str] = (), allow_invalid: bool = False) -> DesignSpace:
    """Take one design per row of a table, along the dimension ``design``.

    Texts, a column that is called ``id``, ``name``, ``label``, ``index``, ``key`` or ends in ``_id``, ``_name`` or
    ``_label``, and an index that is not 0, 1, 2 ... are no inputs: they are coordinates of the result. Columns that
    hold results of the mechanism, such as those of a map, are left out with a warning.

    Parameters
    ----------
    source : mapping, xarray.Dataset, pandas.DataFrame, list of mappings, str or path
        A mapping of names to columns of equal length, where a number is a constant; a Dataset, of which the
        1-D variables along one common dimension (and 1-D coordinates) are columns and 0-d ones are constants; the
        result of a sweep, whose designs these are again; a DataFrame; one mapping for each design; or the path of
        a Parquet file, or of a UTF-8 file with the names in line 1 and columns separated by commas, semicolons or tabs.
        A file of more than 64 MB is looked at once, and its numbers are read where they are needed.
    keep : sequence of str
        Further columns that are no inputs, to be kept as coordinates of the result.
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
    allow_invalid = check_switch(("table", "allow_invalid"), allow_invalid)
    kept = _kept(keep)
    space = _space_of(source, kept, allow_invalid, single=False)
    if space is None:
        raise refused(f"{short_repr(source)} is not a table", f"give {SOURCES}")
    if not space.dims:
        what = f"the table holds only single numbers ({', '.join(space.constants)})"
        raise refused(what, "give at least one column of values, or use grid")
    return flat(space)


def as_space(source: Any, *, allow_invalid: bool = False) -> DesignSpace:
    """Return the designs that stand in place of a design space: a table, one design, or those of a map.

    Parameters
    ----------
    source : DesignSpace or source of `table`
        A mapping of single numbers is one design. The result of a sweep gives the designs that it is about, in its
        own dimensions.
    allow_invalid : bool
        As for `table`.

    Raises
    ------
    InputError
        It is none of these; the message says what is possible.

    Examples
    --------
    >>> as_space({"a1": 0.4, "a2": 1.2}).dims, as_space({"a1": [0.4, 0.5], "a2": 1.2}).dims
    ((), ('design',))
    """
    space = source if isinstance(source, DesignSpace) else _space_of(source, (), allow_invalid, single=True)
    if space is None:
        remedy = f"give fastlink.grid(...), fastlink.sobol(...), {SOURCES}"
        if has(source, "dims"):
            remedy = "give the whole Dataset, whose coordinates are the designs"
        raise InputError(f"is {short_repr(source)}, which gives no designs", where=("space",), remedy=remedy)
    return space


def _kept(keep: Any) -> tuple[str, ...]:
    """Return the names of columns to keep, or refuse what are no names."""
    listed = isinstance(keep, (list, tuple, set, frozenset))
    names = tuple(keep) if listed else (keep,)
    for name in names:
        if not isinstance(name, str):
            remedy = "write names of columns, such as ['part_no']"
            raise InputError(f"is {short_repr(keep)}", where=("table", "keep"), remedy=remedy)
    return names


def _space_of(source: Any, keep: Collection[str], allow_invalid: bool, *, single: bool) -> DesignSpace | None:
    """Return the designs of a source, None of one that has none."""
    if isinstance(source, DesignSpace):
        return source
    if isinstance(source, (str, os.PathLike)):
        path = check_path(("table",), source, "designs.csv")
        attrs: dict[str, str | int] = {"design_kind": "table", "design_source": writable(path.name)}
        read = read_parquet if is_parquet(path) else read_csv
        return read(path, keep, allow_invalid).space(attrs)
    return read_or_none(_space_in_memory, source, keep, allow_invalid, single=single)


def _space_in_memory(
    source: Any, keep: Collection[str], allow_invalid: bool, *, single: bool
) -> DesignSpace | None:
    """Return the designs of a table in memory, None of what is no table."""
    if has(source, "data_vars") and has(source, "coords"):
        return space_of_dataset(source, keep, allow_invalid)
    index = _index_entries(source) if has(source, "columns") else {}
    entries = _entries(source, index)
    if entries is None:
        return None
    for position, name in enumerate(entries):
        check_name(name, position, ())
    columns = Columns((*keep, *index), allow_invalid, entries)
    for name, given in entries.items():
        columns.add(name, given)
    return columns.space({"design_kind": "table"}, single=single)


def _entries(source: Any, index: dict[Any, Any]) -> dict[Any, Any] | None:
    """Return the entries of a table in memory by name, those of its index first; None of what is no table."""
    if has(source, "columns") and has(source, "to_numpy"):
        entries = dict(index)
        for position, name in enumerate(source.columns):
            check_name(name, position, entries)
            entries[name] = _cells(source[name])
        return entries
    if isinstance(source, Mapping):
        return dict(source)
    if has(source, "index") and has(source, "to_dict"):  # a row of a DataFrame
        return dict(source.to_dict())
    names = source.dtype.names if isinstance(source, np.ndarray) else None
    if names:  # an array of records
        return {name: source[name] for name in names}
    if isinstance(source, (list, tuple)) and source and all(isinstance(row, Mapping) for row in source):
        return _rows(source)
    return None


def _index_entries(frame: Any) -> dict[Any, Any]:
    """Return the levels of the index of a DataFrame; none of one that is 0, 1, 2 ..."""
    index: Any = getattr(frame, "index", None)
    length = len(frame)
    if not hasattr(index, "get_level_values"):
        return {}
    levels = [index.get_level_values(k) for k in range(index.nlevels)]
    if len(levels) == 1 and _is_default(levels[0], length):
        return {}
    usual = ["index"] if len(levels) == 1 else [f"level_{k}" for k in range(len(levels))]
    names = [level.name or name for level, name in zip(levels, usual, strict=True)]
    return {name: _cells(level) for name, level in zip(names, levels, strict=True)}


def _is_default(level: Any, length: int) -> bool:
    """Tell whether an index is 0, 1, 2 ... without another name than that of the dimension."""
    values = np.asarray(level)
    same = values.dtype.kind in "iu" and np.array_equal(values, np.arange(length))
    return same and level.name in (None, DESIGN, "index")


def _cells(series: Any) -> Any:
    """Return the values of a column of a DataFrame; numbers that are missing are NaN."""
    kind = getattr(getattr(series, "dtype", None), "kind", "")
    if kind in "iuf" and kind and hasattr(series.dtype, "na_value"):  # a nullable type of pandas
        return series.to_numpy(dtype=np.float64, na_value=np.nan)
    if hasattr(
        getattr(series, "dtype", None), "units"
    ):  # a package for units keeps its numbers in such columns
        return series
    return series.to_numpy()


def _rows(rows: Sequence[Mapping[Any, Any]]) -> dict[Any, Any]:
    """Return the columns of a list of designs, each of which gives the same inputs."""
    names = list(rows[0])
    for number, row in enumerate(rows):
        for name in row:
            if name not in names:
                raise refused(
                    f"row {number} (counted from 0) gives {short_repr(name)}, row 0 does not",
                    suggest(name, map(str, names)),
                )
        for name in names:
            if name not in row:
                raise refused(
                    f"row {number} (counted from 0) lacks {name!r}", "give the same inputs in each row"
                )
    return {name: [row[name] for row in rows] for name in names}
