"""Read tables of designs: mappings, data frames, datasets, CSV and Parquet files."""

from __future__ import annotations

import contextlib
import csv
import hashlib
import math
import os
import threading
from abc import ABC, abstractmethod
from array import array
from bisect import bisect_right
from collections import OrderedDict
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any, TextIO

import numpy as np
from numpy.typing import NDArray

from fastlink._text import counted, short_repr, unwritable, writable
from fastlink.errors import (
    InputError,
    KeyPath,
    Problem,
    Problems,
    Remedy,
    Setting,
    check_path,
    check_switch,
    door,
    not_a_file,
    suggest,
)
from fastlink.machine import check_memory
from fastlink.space.design_space import (
    BRANCH,
    DESIGN,
    EXTREMUM,
    Column,
    DesignSpace,
    Floats,
    axis_of,
    cells_of,
    check_input_name,
    check_no_quantity,
    constant,
    first_invalid,
    flat,
    has,
    numbers_of,
    read_or_none,
    sampled,
    units_of,
)

__all__ = [
    "CURVES",
    "FORMAT",
    "LAYOUTS",
    "MAPS",
    "STATUS",
    "Columns",
    "as_space",
    "check_name",
    "label_of",
    "or_keep",
    "read_csv",
    "read_parquet",
    "refused",
    "table",
]


# -- Collect the columns and constants of a table: the numbers of inputs, and labels of its rows


#: Names of columns that tell designs apart and are no inputs, whatever they hold; and endings of such names.
LABELS = frozenset({DESIGN, "id", "uuid", "name", "label", "index", "key"})
LONGEST_NAME = 200
LABEL_ENDINGS = ("_id", "_name", "_label")
#: A result that every map has: a table with such a column is made of the rows of a map.
OF_EVERY_MAP = "status"


def refused(what: str, remedy: Remedy) -> InputError:
    """Return the error of a table as a whole."""
    return InputError(what, where=("table",), remedy=remedy)


def or_keep(remedy: str, name: str) -> Remedy:
    """Return a remedy with another one, at doors that can: to keep the column as a coordinate."""
    link = " Or" if remedy.endswith("?") else ", or"
    return (remedy, (f"{link} pass ", Setting("keep", [name]), " to keep it as a coordinate of the result"))


def check_name(name: Any, position: int, others: Collection[str], inside: str = "") -> None:
    """Refuse a name of a column that is no text, empty or taken."""
    if not isinstance(name, str) or not name:
        raise refused(f"{inside}column {position + 1} is named {name!r}", "name it by the input it holds")
    if name in others:
        raise refused(f"{inside}two columns are named {name!r}", "name each by the input it holds")


def _check_label_name(name: str) -> None:
    """Refuse a name that no coordinate of a file can have."""
    if not name.isprintable() or "/" in name or len(name) > LONGEST_NAME:
        remedy = "write a short name without '/' and control characters"
        raise refused(f"a column is named {short_repr(name)}", remedy)


def is_label(name: str, keep: Collection[str]) -> bool:
    """Tell whether a column labels designs by its name alone."""
    low = name.lower()
    return name in keep or low in LABELS or low.endswith(LABEL_ENDINGS)


def is_text(values: NDArray[Any]) -> bool:
    """Tell whether values are texts alone, some of which may be missing."""
    if values.dtype.kind in "UT":
        return bool(values.size)
    if values.dtype.kind != "O":
        return False
    cells = values.ravel()
    first = next((cell for cell in cells if not _is_missing(cell)), None)
    return isinstance(first, str) and all(isinstance(cell, str) or _is_missing(cell) for cell in cells)


def _is_missing(cell: Any) -> bool:
    """Tell whether a cell holds None, NaN or the NA of pandas, which does not say whether it equals itself."""
    return (
        cell is None
        or type(cell).__name__ in ("NAType", "NaTType")
        or (isinstance(cell, float) and cell != cell)
    )


def label_of(values: Any, where: KeyPath) -> NDArray[Any]:
    """Return labels as numbers or as texts, which files can hold."""
    array = np.asarray(values)
    if array.dtype.kind in "iuf":
        return np.array(array)
    if array.dtype.kind == "b":
        return array.astype(np.int8)
    if array.dtype.kind in "mM":
        return array.astype(str)
    cells = ["" if _is_missing(cell) else str(cell) for cell in np.asarray(values, dtype=object).ravel()]
    for row, cell in enumerate(cells):
        if sign := unwritable(cell):
            what = f"holds {sign!r}, which no file can hold"
            raise InputError(what, where=(*where, row), remedy="write letters alone")
    return np.array(cells, dtype=str).reshape(array.shape)


class Columns:
    """The columns, constants and labels of a table, checked one by one."""

    def __init__(self, keep: Collection[str], allow_invalid: bool, names: Collection[str] = ()) -> None:
        self.keep, self.allow_invalid = keep, allow_invalid
        self.of_map = OF_EVERY_MAP in names
        self.constants: dict[str, float] = {}
        self.columns: dict[str, Floats | Column] = {}
        self.labels: dict[str, NDArray[Any]] = {}
        self.units: dict[str, str] = {}
        self.doubtful: dict[str, Problem] = {}
        self.problems = Problems()
        for name in keep:
            if names and name not in names:
                self.problems.add(f"there is no column {name!r} to keep", ("table",), "leave it out")

    def add(self, name: str, given: Any) -> None:
        """Add a column or a constant; what is wrong with it is noted."""
        with self.problems.at():
            check_no_quantity("table", name, given)
            if is_label(name, self.keep) or is_text(cells_of(given)):
                self.add_label(name, given)
                return
            check_input_name("table", name)
            values = numbers_of("table", name, given)
            self.units |= units_of(name, given)
            if values.ndim == 0:
                self.constants[name] = constant("table", name, values)
            else:
                self.add_numbers(name, values, lambda row: f"row {row} (counted from 0) of column {name}")

    def add_label(self, name: str, given: Any) -> None:
        """Add labels of the designs."""
        _check_label_name(name)
        values = label_of(given, ("table", name))
        if values.ndim > 1:
            raise refused(f"column {name} has {values.ndim} dimensions", "give one label per design")
        if values.ndim:
            self._check_length(name, values)
        self.labels[name] = values

    def add_numbers(self, name: str, values: Floats, cell: Callable[[int], str]) -> None:
        """Add a column of numbers; `cell` words the place of one."""
        self._check_length(name, values)
        bad = None if self.allow_invalid else first_invalid(values)
        if bad is not None:
            self.doubt(name, cell(bad), values[bad])
        self.columns[name] = values

    def doubt(self, name: str, cell: str, value: object) -> None:
        """Note the first cell of a column that holds no finite number."""
        keep = (", or pass ", Setting("allow_invalid", True), " to keep such designs")
        problem = Problem(f"{cell} is {value}", ("table",), ("write a finite number", keep))
        if self.of_map:
            self.doubtful.setdefault(name, problem)
        else:
            self.problems.noted.append(problem)

    def _check_length(self, name: str, values: NDArray[Any]) -> None:
        if values.size == 0:
            raise refused(f"column {name} is empty", "give at least one row")
        others = {**self.columns, **{key: label for key, label in self.labels.items() if label.ndim}}
        for other, known in others.items():
            if len(known) != len(values):
                what = f"column {name} has {counted(len(values), 'value')} but {other} has {len(known)}"
                remedy = "give one per design, or combine all values by fl.grid(**...)"
                raise refused(what, remedy)

    def space(self, attrs: dict[str, str | int], *, single: bool = False) -> DesignSpace:
        """Return the designs, or refuse them with all their problems."""
        self.problems.stop()
        further: dict[str, Any] = {"units": self.units, "of_map": self.of_map, "doubtful": self.doubtful}
        if self.columns:
            return sampled("table", self.constants, self.columns, attrs, labels=self.labels, **further)
        if self.constants and single and not any(label.ndim for label in self.labels.values()):
            attrs = {"design_kind": "grid"}
            return DesignSpace("grid", (), (), self.constants, attrs=attrs, labels=self.labels, **further)
        for name, label in self.labels.items():
            text = next((str(cell) for cell in label.ravel()), "")
            raise refused(
                f"column {name} holds {short_repr(text)}, and no column holds numbers",
                "write a number for each input",
            )
        what = f"holds only single numbers ({', '.join(self.constants)})" if self.constants else "is empty"
        raise refused(f"the table {what}", "give at least one column of values, or use grid")


# -- Columns of tables in files that are too large for memory: read block by block, where they are looked at


#: Bytes of blocks that a table keeps at most, beside the last two, between which threads may be.
KEPT_BYTES = 64 << 20


class TableFile(ABC):
    """A table in a file, of which blocks of rows are read; thread-safe.

    Attributes
    ----------
    starts : list of int
        The number of the first row of each block.
    length : int
        The number of rows.
    """

    def __init__(self, path: Path) -> None:
        self.path, self.stamp = path.absolute(), _stamp(path)
        self.starts: list[int] = []
        self.length = 0
        self._new()

    def _new(self) -> None:
        self._lock, self._blocks = threading.Lock(), OrderedDict[int, dict[Any, Floats]]()

    @abstractmethod
    def load(self, block: int) -> dict[Any, Floats]:
        """Return the numbers of a block of rows, by column."""

    def read(self, key: Any, start: int, stop: int, out: NDArray[Any]) -> None:
        """Write numbers of rows ``start`` to ``stop - 1`` of a column into an array of as many."""
        block, first = bisect_right(self.starts, start) - 1, start
        while first < stop:
            begin = self.starts[block]
            last = min(stop, self.starts[block + 1] if block + 1 < len(self.starts) else self.length)
            out[first - start : last - start] = self._block(block)[key][first - begin : last - begin]
            block, first = block + 1, last

    def _block(self, block: int) -> dict[Any, Floats]:
        with self._lock:
            if block in self._blocks:
                self._blocks.move_to_end(block)
                return self._blocks[block]
            if _stamp(self.path) != self.stamp:
                remedy = "leave it as it is until the sweep has ended, and read it again"
                raise InputError(
                    f"{self.path} has changed since it was read", where=("table",), remedy=remedy
                )
            values = self._blocks[block] = self.load(block)
            while len(self._blocks) > 2 and sum(map(_nbytes, self._blocks.values())) > KEPT_BYTES:
                self._blocks.popitem(last=False)
            return values

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name not in ("_lock", "_blocks")}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._new()


class Walk:
    """The bounds and the hash of numbers that are walked through once.

    Examples
    --------
    >>> walk = Walk()
    >>> walk.add(np.array([3.0, 1.0]))
    >>> walk.add(np.array([2.0]))
    >>> walk.length, walk.bounds
    (3, (1.0, 3.0))
    """

    def __init__(self) -> None:
        self.length, self.hash = 0, hashlib.sha256()
        self.bounds = (np.inf, -np.inf)

    def add(self, values: Floats) -> None:
        """Add the next numbers."""
        if values.size:
            low, high = np.minimum(self.bounds[0], values.min()), np.maximum(self.bounds[1], values.max())
            self.bounds = float(low), float(high)
            self.length += values.size
            self.hash.update(np.ascontiguousarray(values, "<f8").data)


class FileColumn(Column):
    """A column of numbers of a table in a file."""

    def __init__(self, file: TableFile, key: Any, walk: Walk) -> None:
        super().__init__(walk.length, walk.bounds)
        self.file, self.key, self.digest = file, key, walk.hash.hexdigest()

    def read(self, start: int, stop: int, out: NDArray[Any]) -> None:
        """Write some values."""
        self.file.read(self.key, start, stop, out)

    @property
    def definition(self) -> tuple[Any, ...]:
        """A hash of all values."""
        return "file", self.length, self.digest


def _stamp(path: Path) -> tuple[int, int]:
    """Return the size of a file and the time of its last change."""
    try:
        about = path.stat()
    except OSError:
        return 0, 0
    return about.st_size, about.st_mtime_ns


def _nbytes(block: dict[Any, Floats]) -> int:
    return sum(values.nbytes for values in block.values())


# -- Read tables of designs from CSV files


#: What may separate columns where the first line holds no comma: other programs export these.
SEPARATORS = ";\t"
#: Bytes of files whose numbers are kept in memory; those of larger ones are read block by block.
LARGE = 64 << 20
#: Rows of such a block: as many as an evaluation takes at once.
BLOCK_ROWS = 4096


def read_csv(path: Path, keep: Collection[str], allow_invalid: bool) -> Columns:
    """Return the columns of a CSV file; blank lines are skipped.

    Numbers of a large file are looked at once and read again, block by block, where they are needed; labels are kept.
    """
    if other := not_a_file(path):
        raise refused(f"{path} {other}", "give the path of a CSV file")
    try:
        with _opened(path) as file:
            blocks = _Blocks(path, file) if path.stat().st_size > LARGE else None
            return _Reader(path.name, iter(file.readline, ""), blocks).columns(keep, allow_invalid)
    except OSError as error:
        raise refused(f"cannot read {path}: {error.strerror}", "give the path of a CSV file") from error
    except (UnicodeDecodeError, csv.Error) as error:
        if path.is_file() and _is_hdf5(path):
            remedy = f"if it is a map, give fastlink.open('{path}')"
            raise refused(f"{path} is an HDF5 file", remedy) from error
        raise refused(f"{path} is not CSV text ({error})", "save it as comma-separated UTF-8") from error


def _opened(path: Path) -> TextIO:
    return path.open(encoding="utf-8-sig", newline="")


def _csv_rows(lines: Iterable[str], separator: str) -> Any:
    """Return a reader of the rows of some lines."""
    return csv.reader(lines, skipinitialspace=True, strict=True, delimiter=separator)


def _is_hdf5(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(4) == b"\x89HDF"


class _Blocks(TableFile):
    """A CSV file, whose rows were all looked at, and the places of its blocks."""

    def __init__(self, path: Path, file: TextIO) -> None:
        super().__init__(path)
        self.tell: Any = file.tell
        self.places: list[int] = []
        self.separator, self.numeric = ",", list[int]()

    def begin(self, row: int) -> None:
        """Note that a block begins with the row that is read next."""
        self.starts.append(row)
        self.places.append(self.tell())

    def finish(self, separator: str, numeric: list[int], length: int) -> None:
        """Note which columns hold numbers, when all rows are read."""
        self.separator, self.numeric, self.length, self.tell = separator, numeric, length, None

    def load(self, block: int) -> dict[Any, Any]:
        """Return the numbers of a block of rows, by column."""
        try:
            columns = list(zip(*islice(self._rows_from(block), BLOCK_ROWS), strict=True))
            count = min(BLOCK_ROWS, self.length - self.starts[block])
            return {key: np.fromiter(map(float, columns[key]), np.float64, count) for key in self.numeric}
        except (ValueError, IndexError):  # blank lines or empty cells among them
            given = (row for row in self._rows_from(block) if any(map(str.strip, row)))
            columns = list(zip(*islice(given, BLOCK_ROWS), strict=True))
        # an empty cell is None, which NumPy takes for NaN
        return {key: np.array([_number(text) for text in columns[key]], np.float64) for key in self.numeric}

    def _rows_from(self, block: int) -> Iterator[list[str]]:
        """Yield all rows from a block on, blank ones too."""
        with _opened(self.path) as file:
            file.seek(self.places[block])
            yield from _csv_rows(file, self.separator)


class _Column:
    """The cells of a column as numbers, or from its first cell on as texts.

    Attributes
    ----------
    name : str
        Its name.
    numbers : array of float
        Its numbers; NaN where a cell is empty.
    texts : list of str or None
        Its texts, if its name or its first cell says that it holds such.
    bad : tuple of (str, str) or None
        The first cell that holds no finite number, with its place.
    walk : Walk
        What was seen of its numbers before those that are kept.
    earlier : list of array or list of str
        Labels of earlier blocks: whole numbers take 8 bytes each, their texts 60.
    """

    def __init__(self, name: str, is_text: bool) -> None:
        self.name = name
        self.numbers = array("d")
        self.texts: list[str] | None = [] if is_text else None
        self.by_name = is_text
        self.bad: tuple[str, str] | None = None
        self.walk, self.earlier = Walk(), list[Any]()

    @property
    def labels(self) -> Any:
        """Its texts, as whole numbers where each is written as one."""
        if not self.by_name:
            return self.texts
        pieces = [*self.earlier, *([_whole(self.texts)] if self.texts else [])]
        if all(isinstance(piece, np.ndarray) for piece in pieces):
            return np.concatenate(pieces)
        return [text for piece in pieces for text in map(str, piece)]

    @property
    def is_empty(self) -> bool:
        """Whether no cell was a number yet."""
        return not self.numbers and not self.walk.length

    def pass_by(self) -> None:
        """Keep of the numbers so far no more than what they are between, and their hash; labels shortly."""
        if self.by_name and self.texts:
            self.earlier.append(_whole(self.texts))
            self.texts = []
        self.walk.add(np.array(self.numbers))
        self.numbers = array("d")


class _Reader:
    """Read one file, line by line."""

    def __init__(self, file: str, lines: Iterable[str], blocks: _Blocks | None) -> None:
        self.file, self.blocks = file, blocks
        first, lines = _first_line(lines)
        self.separator = "," if "," in first else next((s for s in SEPARATORS if s in first), ",")
        self.reader: Any = _csv_rows(lines, self.separator)

    def columns(self, keep: Collection[str], allow_invalid: bool) -> Columns:
        """Return the columns of the file."""
        rows = (row for row in self.reader if any(cell.strip() for cell in row))
        names = self._names(next(rows, None))
        found = Columns(keep, allow_invalid, names)
        columns = [_Column(name, not name or is_label(name, keep)) for name in names]
        number = -1
        self._begin(0, columns)
        for number, row in enumerate(rows):
            self._check_length(row, names)
            for column, text in zip(columns, row, strict=True):
                self._add(column, text, number, allow_invalid)
            if (number + 1) % BLOCK_ROWS == 0:
                self._begin(number + 1, columns)
        if number < 0:
            raise refused(f"{self.file} has a header but no rows", "write one line per design")
        self._begin(number + 1, columns)
        if self.blocks is not None:
            numeric = [k for k, column in enumerate(columns) if column.texts is None]
            self.blocks.finish(self.separator, numeric, number + 1)
        for position, column in enumerate(columns):
            self._take(found, column, position)
        return found

    def _begin(self, row: int, columns: list[_Column]) -> None:
        """Begin another block of rows of a large file."""
        if self.blocks is not None:
            self.blocks.begin(row)
            for column in columns:
                column.pass_by()

    def _add(self, column: _Column, text: str, number: int, allow_invalid: bool) -> None:
        """Add a cell to a column, or refuse what is neither a number nor one of its texts."""
        value = None if column.by_name else _number(text)
        if value is not None and column.texts is None:
            column.numbers.append(value)
            if not math.isfinite(value) and column.bad is None:
                column.bad = self._cell(number, column.name), text.strip()
            return
        text = text.strip()
        if column.by_name or (value is None and text and (column.texts is not None or column.is_empty)):
            column.texts = [] if column.texts is None else column.texts
            column.texts.append(text)
            if column.bad is None:
                column.bad = self._cell(number, column.name), text
        elif column.texts is not None:
            if text:  # a number among texts: the first text is wrong, unless all are labels
                raise self._no_number(column, *column.bad or ("", text))
            column.texts.append(text)
        elif text:
            raise self._no_number(column, self._cell(number, column.name), text)
        else:
            column.numbers.append(math.nan)
            column.bad = column.bad or (self._cell(number, column.name), "empty")

    def _take(self, found: Columns, column: _Column, position: int) -> None:
        """Hand a column that is read over to the table."""
        if column.texts is not None:
            if not column.by_name and all(map(_has_comma, filter(None, column.texts))) and column.bad:
                raise self._no_number(column, *column.bad)
            labels = column.labels
            if column.name or not np.array_equal(labels, np.arange(len(labels))):  # the index of a DataFrame
                found.add_label(column.name or "index", labels)
            return
        check_input_name("table", column.name)
        if column.bad is not None and not found.allow_invalid:
            found.doubt(column.name, *column.bad)
        blocks = self.blocks
        found.columns[column.name] = (
            np.array(column.numbers) if blocks is None else FileColumn(blocks, position, column.walk)
        )

    def _no_number(self, column: _Column, cell: str, text: str) -> Exception:
        remedy = or_keep("write a number", column.name)
        if _has_comma(text):
            remedy = "write numbers with a point, or read the file by pandas.read_csv(..., decimal=',')"
        return refused(f"{cell} is {short_repr(text)}, not a number", remedy)

    def _cell(self, number: int, name: str) -> str:
        return f"row {number} (line {self.reader.line_num}) of column {name} in {self.file}"

    def _check_length(self, row: list[str], names: list[str]) -> None:
        if len(row) != len(names):
            cells = counted(len(row), "cell")
            what = f"{self.file} line {self.reader.line_num} has {cells} but the header has {len(names)}"
            points = ", and numbers with a point" if len(row) == 2 * len(names) else ""
            raise refused(what, f"write one cell per column{points}")

    def _names(self, header: list[str] | None) -> list[str]:
        """Return the names of the columns; the first may be empty, above the index of a DataFrame."""
        if header is None:
            remedy = "write the names of the columns in line 1, then one line per design"
            raise refused(f"{self.file} is empty", remedy)
        names = [name.strip() for name in header]
        where = f"{self.file} line {self.reader.line_num}"
        for position, name in enumerate(names):
            if _number(name) is not None:
                what = f"{where} holds {name} instead of a name"
                raise refused(what, "write the names of the columns in line 1")
            if name.startswith("#"):
                what = f"{where} starts with '#'"
                raise refused(what, "write the names of the columns alone in line 1")
            if position or name or len(names) == 1:
                check_name(name, position, names[:position], f"{where}: ")
        return names


def _first_line(lines: Iterable[str]) -> tuple[str, Iterator[str]]:
    """Return the first line that is not blank, and all lines."""
    rest, blank = iter(lines), []
    for line in rest:
        blank.append(line)
        if line.strip():
            break

    def every() -> Iterator[str]:
        yield from blank
        yield from rest

    return (blank[-1] if blank else ""), every()


def _whole(texts: list[str]) -> Any:
    """Return labels as whole numbers where each is written as one, 7 but not 007; else as they are."""
    try:
        numbers = [int(text) for text in texts]
        return np.array(numbers, dtype=np.int64) if list(map(str, numbers)) == texts else texts
    except (ValueError, OverflowError):
        return texts


def _has_comma(text: str) -> bool:
    """Tell whether a text would be a number with a point in place of its comma."""
    return "," in text and _number(text.replace(",", ".", 1)) is not None


def _number(text: str) -> float | None:
    """Return a text as a number, or None; Python itself reads 1_0 as ten, and digits of other scripts."""
    try:
        return float(text) if text.isascii() and "_" not in text else None
    except ValueError:
        return None


# -- Read tables of designs from Parquet files, by pyarrow


INSTALL = "python -m pip install 'fastlink-linkages[parquet]'"
MAGIC = b"PAR1"
#: Bytes of numbers that are kept in memory; those of larger files are read row group by row group.
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
        with _opened_parquet(path) as file:
            return _columns(path, file, keep, allow_invalid)
    except (OSError, ArrowException) as error:
        (why, *_) = str(error).splitlines() or [type(error).__name__]
        raise refused(f"{path} cannot be read as Parquet ({why})", "write it again") from error


@contextlib.contextmanager
def _opened_parquet(path: Path) -> Iterator[Any]:
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
            found.add(_label(name), _parquet_cells(file.read([name]).column(0)))
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


def _parquet_cells(column: Any) -> Any:
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
    """The row groups of a Parquet file."""

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
        with _opened_parquet(self.path) as file:
            table = file.read_row_group(block, columns=self.names)
        return {name: np.asarray(_parquet_cells(table.column(name)), np.float64) for name in self.names}


# -- Read the designs of an xarray Dataset: a table, the axes of a grid, or the map of a sweep


#: Global attribute of a map: the version of its layout; absent from a file that is not complete.
FORMAT = "fastlink_map"
#: The result that says how a design assembles, in every map.
STATUS = "status"
#: How the values of a map lie: all those of a design together, or those of all designs at one input position.
CURVES, MAPS = LAYOUTS = ("curves", "maps")
#: The dimensions of the results of a map that are none of designs.
OF_RESULTS = (BRANCH, EXTREMUM)


def space_of_dataset(dataset: Any, keep: Collection[str], allow_invalid: bool) -> DesignSpace:
    """Return the designs of a Dataset, in its own dimensions.

    Variables and coordinates along one dimension are columns, a dimension whose coordinate stands alone is an axis,
    scalars are constants, texts and other numbers along an index are labels. The results of a map, and their further
    dimensions, are left out.
    """
    reader = _DatasetReader(dataset)
    columns = Columns(keep, allow_invalid, [str(name) for name in (*dataset.data_vars, *dataset.coords)])
    columns.of_map |= reader.of_map
    inside = reader.table_dim()
    for name, variable in reader.entries.items():
        if variable.dims == () or variable.dims == (inside,):
            _add(columns, reader, name, variable)
    axes = {dim: axis for dim in reader.axes(inside) if (axis := reader.axis(dim, columns)) is not None}
    attrs: dict[str, str | int] = {"design_kind": "table" if inside else "grid"}
    if inside or not axes:
        space = columns.space(attrs, single=True)
    else:
        columns.problems.stop()
        further: dict[str, Any] = {"units": columns.units, "of_map": columns.of_map}
        labels = {name: label for name, label in columns.labels.items() if label.ndim == 0}
        space = DesignSpace("grid", (), (), columns.constants, attrs=attrs, labels=labels, **further)
    for dim, axis in axes.items():
        space = replace(
            space, dims=(*space.dims, dim), shape=(*space.shape, len(axis)), axes={**space.axes, dim: axis}
        )
    return replace(space, ignored=tuple(reader.results))


def _add(columns: Columns, reader: _DatasetReader, name: str, variable: Any) -> None:
    """Add a variable of a table to its columns, constants or labels."""
    is_index = name in reader.dataset.dims
    whole = name not in reader.dataset.data_vars and variable.dtype.kind in "iu"
    if is_index or (whole and variable.ndim == 1 and "flag_values" not in variable.attrs):
        label, count = DESIGN if is_index and name == DESIGN else name, variable.size
        if not (
            is_index and variable.dtype.kind in "iu" and np.array_equal(variable.values, np.arange(count))
        ):
            with columns.problems.at():
                columns.add_label(label, variable.values)
        return
    columns.add(name, variable)


class _DatasetReader:
    """The variables of a Dataset that may give designs.

    Attributes
    ----------
    of_map : bool
        Whether it is the result of a sweep.
    results : list of str
        The results of that sweep.
    entries : dict
        The other variables and coordinates by name.
    """

    def __init__(self, dataset: Any) -> None:
        self.dataset = dataset
        attrs = dataset.attrs
        self.of_map = FORMAT in attrs
        self.outside = {*OF_RESULTS, str(attrs.get("input", ""))} if self.of_map else set()
        self.results = [str(name) for name, one in dataset.data_vars.items() if self._is_result(one)]
        self.entries: dict[str, Any] = {}
        for key, one in {**dict(dataset.data_vars), **dict(dataset.coords)}.items():
            name = str(key)
            levels = getattr(dataset.indexes.get(key), "nlevels", 1) if key in dataset.dims else 1
            if levels > 1 or name in self.results or self.outside & {name, *map(str, one.dims)}:
                continue
            if not isinstance(key, str):
                raise refused(f"a variable is named {short_repr(key)}", "name it by the input it holds")
            self.entries[name] = one

    def _is_result(self, variable: Any) -> bool:
        return self.of_map and (
            "references" in variable.attrs or bool(self.outside & {*map(str, variable.dims)})
        )

    def table_dim(self) -> str:
        """Return the dimension along which the columns are, an empty text without any."""
        along: dict[str, str] = {}
        for name, variable in self.entries.items():
            if variable.ndim > 1:
                remedy = "give 1-D variables, for instance by dataset[['a1', 'a2']]"
                raise InputError(
                    f"has dimensions {tuple(variable.dims)}", where=("table", name), remedy=remedy
                )
            is_column = name in self.dataset.data_vars or variable.dtype.kind in "iuf"
            for dim in variable.dims if name not in self.dataset.dims and is_column else ():
                along.setdefault(str(dim), name)
        if len(along) > 1:
            two = [f"{name} along {short_repr(dim)}" for dim, name in along.items()][:2]
            raise refused(" but ".join(two), "give variables along one common dimension")
        return next(iter(along), "")

    def axes(self, inside: str) -> Iterator[str]:
        """Yield the dimensions that are axes, in the order of the results of a map."""
        if inside and not self.of_map:
            return
        first = [self.dataset[name].dims for name in ("status", *self.results) if name in self.results][:1]
        for dim in dict.fromkeys([*map(str, (*first, ())[0]), *map(str, self.dataset.dims)]):
            if dim != inside and dim in self.entries and self.entries[dim].dims == (dim,):
                yield dim

    def axis(self, dim: str, columns: Columns) -> Floats | None:
        """Return the values of an axis, None of one that holds texts; what is wrong is noted."""
        coordinate = self.entries[dim]
        if coordinate.dtype.kind not in "iuf":
            return None
        with columns.problems.at():
            columns.units |= units_of(dim, coordinate)
            return axis_of("table", dim, numbers_of("table", dim, coordinate.values))
        return None


# -- Read tables of designs: mappings, data frames, datasets, CSV and Parquet files


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
