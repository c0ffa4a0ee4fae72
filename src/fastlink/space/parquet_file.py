"""Read tables of designs from Parquet files, by pyarrow."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from fastlink.errors import InputError
from fastlink.memory import check_memory
from fastlink.options import not_a_file
from fastlink.space.columns import Columns, check_name, is_label, refused
from fastlink.space.design_space import DESIGN
from fastlink.space.table_file import FileColumn, TableFile, Walk
from fastlink.space.values import Floats, check_input_name, first_invalid

__all__ = ["is_parquet", "read_parquet"]

INSTALL = "python -m pip install 'fastlink-linkages[parquet]'"
MAGIC = b"PAR1"
#: Bytes of numbers that are kept in memory; those of larger files are read row group by row group.
LARGE = 64 << 20
#: How pandas calls a column that holds an index without a name.
INDEX = "__index_level_"


def is_parquet(path: Path) -> bool:
    """Tell whether a file begins as a Parquet file does, or is called so."""
    try:
        with path.open("rb") as file:
            return path.suffix.lower() == ".parquet" or file.read(len(MAGIC)) == MAGIC
    except OSError:
        return path.suffix.lower() == ".parquet"


def read_parquet(path: Path, keep: Collection[str], allow_invalid: bool) -> Columns:
    """Return the columns of a Parquet file.

    Numbers of a large file are looked at once and read again, by row group, where they are needed; labels are kept.

    Raises
    ------
    InputError
        With the row of the table and what to write there.
    """
    if other := not_a_file(path):
        raise refused(f"{path} {other}", "give the path of a Parquet file")
    try:
        from pyarrow import ArrowException
    except ImportError as error:
        raise InputError("pyarrow is not installed", where=("table",), remedy=INSTALL) from error
    try:
        with path.open("rb"):
            pass
    except OSError as error:
        raise refused(f"cannot read {path}: {error.strerror}", "give the path of a Parquet file") from error
    try:
        with _opened(path) as file:
            return _columns(path, file, keep, allow_invalid)
    except (OSError, ArrowException) as error:
        (why, *_) = str(error).splitlines() or [type(error).__name__]
        raise refused(f"{path} cannot be read as Parquet ({why})", "write it again") from error


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """Open a Parquet file by the bytes of its name, of which pyarrow would have letters."""
    from pyarrow import OSFile, parquet

    with OSFile(os.fsencode(path)) as source, parquet.ParquetFile(source) as file:
        yield file


def _columns(path: Path, file: Any, keep: Collection[str], allow_invalid: bool) -> Columns:
    from pyarrow import types

    names, rows = list(file.schema_arrow.names), file.metadata.num_rows
    for position, name in enumerate(names):
        check_name(name, position, names[:position], f"{path.name}: ")
    if not rows:
        raise refused(f"{path.name} has no rows", "write one row per design")
    indices = [name for name in names if name.startswith(INDEX)]
    found = Columns((*keep, *(_label(name) for name in indices)), allow_invalid, [*map(_label, names)])
    kinds = {name: file.schema_arrow.field(name).type for name in names}
    numeric = [
        name
        for name in names
        if (types.is_integer(kinds[name]) or types.is_floating(kinds[name]))
        and not is_label(name, found.keep)
    ]
    is_large = 8 * rows * len(numeric) > LARGE
    walked = _walked(path, file, numeric, found) if is_large else {}
    for name in names:
        if name not in walked:
            found.add(_label(name), _cells(file.read([name]).column(0)))
            continue
        with found.problems.at():
            check_input_name("table", name)
            found.columns[name] = walked[name]
    _add_index(found, file.schema_arrow.pandas_metadata, rows)
    return found


def _add_index(found: Columns, about: dict[str, Any] | None, rows: int) -> None:
    """Add the index of a DataFrame that is a range, of which the file holds no more than its ends; not 0, 1, 2 ..."""
    for index in (about or {}).get("index_columns", ()):
        if isinstance(index, dict) and index.get("kind") == "range":
            numbers = np.arange(index["start"], index["stop"], index["step"])
            if index["name"] not in (None, DESIGN, "index") or not np.array_equal(numbers, np.arange(rows)):
                found.add_label(index["name"] or "index", numbers)


def _label(name: str) -> str:
    """Return the name of a column, of an index without one such as that of a DataFrame."""
    if not name.startswith(INDEX):
        return name
    level = name.removeprefix(INDEX).rstrip("_")
    return "index" if level == "0" else f"level_{level}"


def _cells(column: Any) -> Any:
    """Return the values of a column as an array; numbers that are missing are NaN."""
    if hasattr(column.type, "value_type") and hasattr(column.type, "index_type"):  # categories
        column = column.cast(column.type.value_type)
    return column.to_numpy()


def _walked(path: Path, file: Any, names: list[str], found: Columns) -> dict[str, FileColumn]:
    """Look at all numbers of a file, row group by row group."""
    groups = _Groups(path, names)
    walks = {name: Walk() for name in names}
    doubted = set[str]()
    for group in range(file.num_row_groups):
        groups.begin(file.metadata.row_group(group).num_rows)
        for name, values in groups.load(group).items():
            bad = None if found.allow_invalid or name in doubted else first_invalid(values)
            if bad is not None:
                doubted.add(name)
                row = groups.starts[group] + bad
                found.doubt(name, f"row {row} (counted from 0) of column {name}", values[bad])
            walks[name].add(values)
    return {name: FileColumn(groups, name, walk) for name, walk in walks.items()}


class _Groups(TableFile):
    """The row groups of a Parquet file.

    Parameters
    ----------
    path : Path
        The file.
    names : list of str
        The columns of numbers.
    """

    def __init__(self, path: Path, names: list[str]) -> None:
        super().__init__(path)
        self.names, self.sizes = names, list[int]()

    def begin(self, rows: int) -> None:
        """Note the rows of the next group."""
        self.starts.append(self.length)
        self.sizes.append(rows)
        self.length += rows

    def load(self, block: int) -> dict[Any, Floats]:
        """Return the numbers of a row group, by column."""
        nbytes = 16 * self.sizes[block] * len(self.names)  # as they are read, and as numbers
        remedy = "write smaller ones, such as row_group_size=100_000"
        check_memory(nbytes, f"a row group of {self.path.name}", where=("table",), remedy=remedy)
        with _opened(self.path) as file:
            table = file.read_row_group(block, columns=self.names)
        return {name: np.asarray(_cells(table.column(name)), np.float64) for name in self.names}
