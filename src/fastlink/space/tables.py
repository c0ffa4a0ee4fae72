"""Read tables of designs: mappings, data frames, datasets, CSV and Parquet files."""

from __future__ import annotations

import contextlib
import csv
import hashlib
import os
import re
import threading
from abc import ABC, abstractmethod
from bisect import bisect_right
from collections import Counter, OrderedDict, defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any, TextIO, TypeVar

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
    require_package,
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
from fastlink.space.units import is_unit, named_with_unit

T = TypeVar("T")


# -- Collect the columns and constants of a table: the numbers of inputs, and labels of its rows


#: Names of columns that tell designs apart and are no inputs, whatever they hold; and endings of such names.
LABELS = frozenset({DESIGN, "id", "uuid", "name", "label", "index", "key"})
LONGEST_NAME = 200
#: A name with its unit, as it heads a column.
HEAD = re.compile(r"(\w+)\s*[\[(]\s*([^\[\]()]+?)\s*[\])]")
LABEL_ENDINGS = ("_id", "_name", "_label")
#: Texts that stand for no number, whatever the column holds.
NO_VALUES = frozenset({"n/a", "n.a.", "na", "#n/a", "nan", "none", "null", "missing", "-", "--", "?", ""})
#: Cells without a finite number that a message names for each column.
MOST_CELLS = 6
#: A result that every map has: a table with such a column is made of the rows of a map.
OF_EVERY_MAP = "status"


def refused(what: str, remedy: Remedy) -> InputError:
    """Return the error of a table as a whole."""
    return InputError(what, where=("table",), remedy=remedy)


def check_name(name: Any, position: int, others: Collection[str], inside: str = "") -> None:
    """Refuse a name of a column that is no text, empty or taken."""
    if not isinstance(name, str) or not name:
        raise refused(f"{inside}column {position + 1} is named {name!r}", "name it by the input it holds")
    if name in others:
        raise refused(f"{inside}two columns are named {name!r}", "name each by the input it holds")


def is_label(name: str, keep: Collection[str]) -> bool:
    """Tell whether a column labels designs by its name alone."""
    low = name.lower()
    return name in keep or low in LABELS or low.endswith(LABEL_ENDINGS)


def head_of(name: str) -> tuple[str, str]:
    """Return the name and the unit in the head of a column, a1 and mm of ``a1 [mm]``, ``a1 mm``; else no unit."""
    if head := HEAD.fullmatch(name):
        return head[1], head[2]
    of, _, unit = name.rpartition(" ")
    return (of, unit) if of.isidentifier() and is_unit(unit) else (name, "")


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


def _with_gaps(cells: NDArray[Any]) -> NDArray[Any]:
    """Return a column with NaN in place of texts and of cells that hold nothing."""
    gaps = [isinstance(cell, str) or _is_missing(cell) for cell in cells.ravel()]
    return np.where(np.reshape(gaps, cells.shape), np.nan, cells) if cells.ndim else cells


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

    def __init__(self, keep: Collection[str], allow_invalid: bool, names: Collection[str]) -> None:
        self.keep, self.allow_invalid = keep, allow_invalid
        self.of_map = OF_EVERY_MAP in names
        self.constants: dict[str, float] = {}
        self.columns: dict[str, Floats | Column] = {}
        self.labels: dict[str, NDArray[Any]] = {}
        self.units: dict[str, str] = {}
        #: By column the cells that hold no finite number, the first few by their places, and how many there are.
        self.bad, self.count = defaultdict[str, list[tuple[str, str]]](list), Counter[str]()
        self.problems, self.source = Problems(), ""
        for name in keep:
            if names and name not in names:
                self.problems.add(f"there is no column {name!r} to keep", ("table",), "leave it out")

    def add(self, name: str, given: Any) -> None:
        """Add a column or a constant; what is wrong with it is noted."""
        with self.problems.at():
            check_no_quantity("table", name, given)
            cells = cells_of(given)
            if is_label(name, self.keep) or is_text(cells):
                self.add_label(name, given)
                return
            check_input_name("table", head_of(name)[0])
            values = numbers_of("table", name, _with_gaps(cells) if cells.dtype.kind == "O" else given)
            self.units |= units_of(name, given)
            if values.ndim == 0:
                self.constants[name] = constant("table", name, values)
            else:
                self._check_length(name, values)
                self.check_finite(name, values, cells=cells)
                self.columns[name] = values

    def add_label(self, name: str, given: Any) -> None:
        """Add labels of the designs, or refuse them, and a name that no coordinate of a file can have."""
        if not name.isprintable() or "/" in name or len(name) > LONGEST_NAME:
            remedy = "write a short name without '/' and control characters"
            raise refused(f"a column is named {short_repr(name)}", remedy)
        values = label_of(given, ("table", name))
        if values.ndim > 1:
            raise refused(f"column {name} has {values.ndim} dimensions", "give one label per design")
        if values.ndim:
            self._check_length(name, values)
        self.labels[name] = values

    def take(self, name: str, numbers: Walk) -> None:
        """Take over the numbers of a column of a file, which were looked at."""
        with self.problems.at():
            check_input_name("table", head_of(name)[0])
            self.columns[name] = numbers.column()

    def check_finite(self, name: str, values: Floats, first: int = 0, cells: Any = None) -> None:
        """Note the rows of a column, whose values begin at some row, that hold no finite number, but what is shown."""
        if not self.allow_invalid and first_invalid(values) is not None:
            rows = np.flatnonzero(~np.isfinite(values))
            shown = [str(values[k]) if cells is None else short_repr(cells[k]) for k in rows[:MOST_CELLS]]
            found = [(f"row {first + k} (counted from 0)", of) for k, of in zip(rows, shown, strict=False)]
            self.doubt(name, found, len(rows))

    def doubt(self, name: str, cells: Sequence[tuple[str, str]], count: int) -> None:
        """Note cells of a column that hold no finite number, the first of so many."""
        self.bad[name] += cells
        self.count[name] += count

    def doubtful(self, *, may_label: bool) -> dict[str, Problem]:
        """By column the problem of its cells that hold no finite number; labels unless the inputs are known."""
        keep = (", or pass ", Setting("allow_invalid", True), " to keep such designs")
        found = {}
        for name, cells in self.bad.items():
            (place, value), *others = cells[:MOST_CELLS]
            shown = "".join(f", {other.partition(' (counted')[0]} is {one}" for other, one in others)
            more = f" and {self.count[name] - MOST_CELLS:,} more" if self.count[name] > MOST_CELLS else ""
            what = f"{place} of column {name}{self.source} is {value}{shown}{more}"
            texts = [value[1:-1].lower() for _, value in cells if value.startswith(("'", '"'))]
            is_label = may_label and {*texts} - NO_VALUES and not head_of(name)[1]
            label = (", or, if it is no input, pass ", Setting("keep", [name])) if is_label else ()
            found[name] = Problem(
                what, ("table",), (f"write a {'' if is_label else 'finite '}number", keep, label)
            )
        return found

    def _check_length(self, name: str, values: NDArray[Any]) -> None:
        if values.size == 0:
            raise refused(f"column {name} is empty", "give at least one row")
        others = {**self.columns, **{key: label for key, label in self.labels.items() if label.ndim}}
        for other, known in others.items():
            if len(known) != len(values):
                what = f"column {name} has {counted(len(values), 'value')} but {other} has {len(known)}"
                remedy = "give one per design, or combine all values by fl.grid(**...)"
                raise refused(what, remedy)

    def _without_units(self, named: Mapping[str, T]) -> dict[str, T]:
        """Return what is named by columns by their names without units, which are noted."""
        found = dict[str, T]()
        for head, value in named.items():
            name, unit = head_of(head)
            if name in found or (unit and name in named):
                raise refused(f"two columns are named {name!r}", "name each by the input it holds")
            found[name] = value
            self.units |= {name: unit} if unit else {}
        return found

    def space(self, attrs: dict[str, str | int], *, single: bool = False) -> DesignSpace:
        """Return the designs, or refuse them with all their problems.

        Of a request (`single`) cells without finite numbers are refused with all else that is wrong with its designs.
        """
        if not (self.of_map or (single and self.columns)):
            self.problems.noted += self.doubtful(may_label=True).values()
        self.problems.stop()
        doubtful = self._without_units(self.doubtful(may_label=False))
        self.columns, self.constants = self._without_units(self.columns), self._without_units(self.constants)
        further: dict[str, Any] = {"units": self.units, "of_map": self.of_map, "doubtful": doubtful}
        if self.columns:
            return sampled("table", self.constants, self.columns, attrs, labels=self.labels, **further)
        if self.constants and single and not any(label.ndim for label in self.labels.values()):
            attrs = {"design_kind": "grid"}
            return DesignSpace("grid", (), (), self.constants, attrs=attrs, labels=self.labels, **further)
        for name, label in self.labels.items():
            text = next((str(cell) for cell in label.ravel()), "")
            raise refused(
                f"column {name} holds {short_repr(text)}, and no column holds numbers",
                named_with_unit(name, text, shown=False) or "write a number for each input",
            )
        what = f"holds only single numbers ({', '.join(self.constants)})" if self.constants else "is empty"
        raise refused(f"the table {what}", "give at least one column of values, or use grid")


# -- Tables in files: read by blocks of rows, and again where they are looked at if they are too large for memory


#: Bytes of files whose numbers are kept in memory.
LARGE = 64 << 20
#: Bytes of blocks that the table of a larger file keeps at most, beside the last two, between which threads may be.
KEPT_BYTES = 64 << 20
#: How Parquet and HDF5 files begin, and how pandas calls a column of Parquet that holds an index without a name.
PARQUET, HDF5, INDEX = b"PAR1", b"\x89HDF", "__index_level_"
#: What may separate columns where the first line holds no comma: other programs export these.
SEPARATORS = ";\t"
#: Rows of a block of a CSV file: as many as an evaluation takes at once.
BLOCK_ROWS = 4096


def read_file(path: Path, keep: Collection[str], allow_invalid: bool) -> Columns:
    """Return the columns of a CSV or Parquet file; the numbers of a large one are looked at once, and not kept."""
    kind = "Parquet" if path.suffix.lower() == ".parquet" else "CSV"
    remedy = f"give the path of a {kind} file"
    if other := not_a_file(path):
        raise refused(f"{path} {other}", remedy)
    try:
        with path.open("rb") as file:
            begin = file.read(len(PARQUET))
    except OSError as error:
        raise refused(f"cannot read {path}: {error.strerror}", remedy) from error
    if kind == "Parquet" or begin == PARQUET:
        return _read_parquet(path, keep, allow_invalid)
    if begin == HDF5:
        raise refused(f"{path} is an HDF5 file", f"if it is a map, give fastlink.open('{path}')")
    if path.suffix.lower() == ".toml":
        raise refused(f"{path} is a study, not a table", f"run it by fastlink.run('{path}')")
    try:
        return CsvFile(path).columns(keep, allow_invalid)
    except OSError as error:
        raise refused(f"cannot read {path}: {error.strerror}", remedy) from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise refused(f"{path} is not CSV text ({error})", "save it as comma-separated UTF-8") from error


def _read_parquet(path: Path, keep: Collection[str], allow_invalid: bool) -> Columns:
    require_package("pyarrow", ("table",))
    from pyarrow import ArrowException

    try:
        return ParquetFile(path).columns(keep, allow_invalid)
    except (OSError, ArrowException) as error:
        (why, *_) = str(error).splitlines() or [type(error).__name__]
        raise refused(f"{path} cannot be read as Parquet ({why})", "write it again") from error


class _Kept:
    """The blocks of a table that were read last."""

    def __init__(self) -> None:
        self.lock, self.blocks = threading.Lock(), OrderedDict[int, dict[Any, Floats]]()

    def __reduce__(self) -> tuple[type[_Kept], tuple[()]]:
        return _Kept, ()  # another process has read none


class TableFile(ABC):
    """A table in a file, of which blocks of rows are read, numbered by the first row of each; thread-safe."""

    is_large: bool

    def __init__(self, path: Path) -> None:
        self.path, self.stamp, self.starts = path.absolute(), _stamp(path), [0]
        self._kept = _Kept()

    @abstractmethod
    def load(self, block: int) -> dict[Any, Floats]:
        """Return the numbers of a block of rows, by column."""

    def begin(self, rows: int) -> None:
        """Note the rows of the next block."""
        self.starts.append(self.starts[-1] + rows)

    def read(self, key: Any, start: int, stop: int, out: NDArray[Any]) -> None:
        """Write numbers of rows ``start`` to ``stop - 1`` of a column into an array of as many."""
        block, first = bisect_right(self.starts, start) - 1, start
        while first < stop:
            begin, end = self.starts[block : block + 2]
            last = min(stop, end)
            out[first - start : last - start] = self._block(block)[key][first - begin : last - begin]
            block, first = block + 1, last

    def _block(self, block: int) -> dict[Any, Floats]:
        with self._kept.lock:
            blocks = self._kept.blocks
            if block in blocks:
                blocks.move_to_end(block)
                return blocks[block]
            if _stamp(self.path) != self.stamp:
                remedy = "leave it as it is until the sweep has ended, and read it again"
                raise refused(f"{self.path} has changed since it was read", remedy)
            values = blocks[block] = self.load(block)
            while len(blocks) > 2 and sum(map(_nbytes, blocks.values())) > KEPT_BYTES:
                blocks.popitem(last=False)
            return values


class FileColumn(Column):
    """A column of numbers of a table in a file."""

    def __init__(self, file: TableFile, key: Any, length: int, bounds: tuple[float, float], digest: str):
        super().__init__(length, bounds)
        self.file, self.key, self.digest = file, key, digest

    def read(self, start: int, stop: int, out: NDArray[Any]) -> None:
        """Write some values."""
        self.file.read(self.key, start, stop, out)

    @property
    def definition(self) -> tuple[Any, ...]:
        """A hash of all values."""
        return "file", self.length, self.digest


class Walk:
    """The numbers of a column, block by block: kept, or of a large file their bounds and hash."""

    def __init__(self, file: TableFile, key: Any) -> None:
        self.file, self.key, self.pieces = file, key, list[Floats]()
        self.hash, self.bounds = hashlib.sha256(), (np.inf, -np.inf)

    def add(self, values: Floats) -> None:
        """Add the next numbers."""
        if not self.file.is_large:
            self.pieces.append(values)
        elif values.size:
            low, high = np.minimum(self.bounds[0], values.min()), np.maximum(self.bounds[1], values.max())
            self.bounds = float(low), float(high)
            self.hash.update(np.ascontiguousarray(values, "<f8").data)

    def column(self) -> Floats | FileColumn:
        """Return all numbers."""
        if not self.file.is_large:
            return np.concatenate(self.pieces)
        return FileColumn(self.file, self.key, self.file.starts[-1], self.bounds, self.hash.hexdigest())


def _stamp(path: Path) -> tuple[int, int]:
    """Return the size of a file and the time of its last change."""
    try:
        about = path.stat()
    except OSError:
        return 0, 0
    return about.st_size, about.st_mtime_ns


def _nbytes(block: dict[Any, Floats]) -> int:
    return sum(values.nbytes for values in block.values())


# -- CSV files: by the module csv, for pandas fills rows that are too short, reads "1.2"5 as 1.25 and a cell up to a
#    zero byte, and counts neither blank lines nor those within quotes


class CsvFile(TableFile):
    """A table in a CSV file; blank lines are skipped."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self.is_large = path.stat().st_size > LARGE
        with self._opened() as file:
            first = next((line for line in file if line.strip()), "")
        self.separator = "," if "," in first else next((sign for sign in SEPARATORS if sign in first), ",")
        self.places, self.numeric = list[int](), list[int]()

    def _opened(self) -> TextIO:
        return self.path.open(encoding="utf-8-sig", newline="")

    def _reader(self, file: TextIO) -> Any:
        lines = iter(file.readline, "")  # a file that is iterated does not tell its place
        return csv.reader(lines, skipinitialspace=True, strict=True, delimiter=self.separator)

    def load(self, block: int) -> dict[Any, Any]:
        """Return the numbers of a block of rows, by column."""
        begin, end = self.starts[block : block + 2]
        with self._opened() as file:
            file.seek(self.places[block])
            columns = list(zip(*islice(filter(_is_row, self._reader(file)), end - begin), strict=True))
        return {key: _numbers(columns[key]) for key in self.numeric}

    def columns(self, keep: Collection[str], allow_invalid: bool) -> Columns:
        """Return all columns, or refuse the file."""
        with self._opened() as file:
            reader = self._reader(file)
            names = self._names(next(filter(_is_row, reader), None), reader)
            found = Columns(keep, allow_invalid, names)
            found.source = f" in {self.path.name}"
            columns = [CsvColumn(self, key, name, keep) for key, name in enumerate(names)]
            for rows, lines in self._divided(file, reader, len(names)):
                for column, texts in zip(columns, zip(*rows, strict=True), strict=True) if rows else ():
                    column.add(texts, lines)
                self.begin(len(rows))
        if not self.starts[-1]:
            raise refused(f"{self.path.name} has a header but no rows", "write one line per design")
        self.numeric = [column.key for column in columns if not column.is_text]
        for column in columns:
            column.give(found)
        return found

    def _divided(self, file: TextIO, reader: Any, count: int) -> Iterator[tuple[list[list[str]], list[int]]]:
        """Yield the rows of each block, and the lines in which they end."""
        while True:
            rows, lines = list[list[str]](), list[int]()
            if self.is_large:
                self.places.append(file.tell())
            try:
                for row in islice(filter(_is_row, reader), BLOCK_ROWS):
                    if len(row) != count:
                        raise self._other_length(len(row), count, reader.line_num)
                    rows.append(row)
                    lines.append(reader.line_num)
            except (InputError, UnicodeDecodeError, csv.Error):
                yield rows, lines  # what is wrong before comes first
                raise
            if not rows:
                return
            yield rows, lines

    def _other_length(self, cells: int, count: int, line: int) -> InputError:
        what = f"{self.path.name} line {line} has {counted(cells, 'cell')} but the header has {count}"
        points = ", and numbers with a point" if cells == 2 * count else ""
        return refused(what, f"write one cell per column{points}")

    def _names(self, header: list[str] | None, reader: Any) -> list[str]:
        """Return the names of the columns; the first may be empty, above the index of a DataFrame."""
        if header is None:
            remedy = "write the names of the columns in line 1, then one line per design"
            raise refused(f"{self.path.name} is empty", remedy)
        names = [name.strip() for name in header]
        where = f"{self.path.name} line {reader.line_num}"
        for position, name in enumerate(names):
            if _number(name) is not None:
                what = f"{where} holds {name} instead of a name"
                raise refused(what, "write the names of the columns in line 1")
            if name.startswith("#"):
                raise refused(f"{where} starts with '#'", "write the names of the columns alone in line 1")
            if len(names) == 1 and " " in name and not head_of(name)[1]:
                remedy = "separate columns by commas, semicolons or tabs"
                raise refused(f"{where} has one column, {short_repr(name)}", remedy)
            if position or name or len(names) == 1:
                check_name(name, position, names[:position], f"{where}: ")
        return names


class CsvColumn:
    """A column of a CSV file: of texts if its name or its first cell says so, else of numbers."""

    def __init__(self, file: CsvFile, key: int, name: str, keep: Collection[str]) -> None:
        self.file, self.key, self.name = file, key, name
        self.by_name = not name or is_label(name, keep)
        self.is_text: bool | None = self.by_name or None
        self.labels, self.walk = list[Any](), Walk(file, key)
        #: The first cells that hold no finite number, how many there are, and whether a comma makes all that do none.
        self.bad, self.count, self.commas = list[tuple[str, str]](), 0, True

    def add(self, texts: Sequence[str], lines: Sequence[int]) -> None:
        """Add the cells of a block: as texts as long as no cell holds a number, then as numbers."""
        if self.is_text is None:
            self.is_text = not _is_numeric(texts[0])
        if self.is_text and not self.by_name and any(_number(text) is not None for text in texts):
            self.is_text = False
            for block in self.labels:
                self.walk.add(np.full(len(block), np.nan))
        if self.is_text:
            stripped = list(map(str.strip, texts))
            self.labels.append(_whole(stripped) if self.by_name else stripped)
        if self.by_name:
            return
        numbers, first = _numbers(texts), self.file.starts[-1]
        if not self.is_text:
            self.walk.add(numbers)
        rows = np.flatnonzero(~np.isfinite(numbers)).tolist()
        self.count += len(rows)
        for row in rows:
            text = texts[row].strip()
            self.commas &= _has_comma(text)
            if len(self.bad) < MOST_CELLS:
                of = text or "empty" if _is_numeric(text) else short_repr(text)
                self.bad.append((f"row {first + row} (line {lines[row]})", of))

    def give(self, found: Columns) -> None:
        """Hand the whole column over to the table."""
        if not self.is_text:
            if self.bad and self.commas:
                raise self._decimal_comma()
            if self.bad and not found.allow_invalid:
                found.doubt(self.name, self.bad, self.count)
            found.take(self.name, self.walk)
            return
        labels: Any
        if all(isinstance(block, np.ndarray) for block in self.labels):
            labels = np.concatenate(self.labels)
        else:
            labels = [str(label) for block in self.labels for label in block]
        if not self.by_name and self.bad and all(map(_has_comma, filter(None, labels))):
            raise self._decimal_comma()
        if self.name or not np.array_equal(labels, np.arange(len(labels))):  # the index of a DataFrame
            found.add_label(self.name or "index", labels)

    def _decimal_comma(self) -> InputError:
        remedy = "write numbers with a point, or read the file by pandas.read_csv(..., decimal=',')"
        ((place, text), *_) = self.bad
        what = f"{place} of column {self.name} in {self.file.path.name} is {text}, not a number"
        return refused(what, remedy)


def _is_row(row: list[str]) -> bool:
    """Tell whether a cell of a row is not blank."""
    return any(map(str.strip, row))


def _whole(texts: list[str]) -> Any:
    """Return labels as whole numbers, which take less memory, where all are written as such: 7, not 007."""
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


def _is_numeric(text: str) -> bool:
    """Tell whether a cell holds a number or is empty."""
    return _number(text) is not None or not text.strip()


def _numbers(texts: Sequence[str]) -> Floats:
    """Return cells as numbers, NaN where one is empty or holds anything else."""
    every = "".join(texts)
    if every.isascii() and "_" not in every:
        with contextlib.suppress(ValueError):
            return np.fromiter(map(float, texts), np.float64, len(texts))
    return np.array([_number(text) for text in texts], np.float64)  # None is NaN to NumPy


# -- Parquet files, by pyarrow


class ParquetFile(TableFile):
    """A table in a Parquet file, whose blocks are its row groups."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self.names = list[str]()

    @contextlib.contextmanager
    def _opened(self) -> Iterator[Any]:
        """Open the file by the bytes of its name, of which pyarrow would have letters."""
        from pyarrow import OSFile, parquet

        with OSFile(os.fsencode(self.path)) as source, parquet.ParquetFile(source) as file:
            yield file

    def load(self, block: int) -> dict[Any, Floats]:
        """Return the numbers of a row group, by column."""
        with self._opened() as file:
            return self._group(file, block)

    def _group(self, file: Any, block: int) -> dict[Any, Floats]:
        # as they are read, and as numbers
        nbytes = 16 * file.metadata.row_group(block).num_rows * len(self.names)
        remedy = "write smaller ones, such as row_group_size=100_000"
        check_memory(nbytes, f"a row group of {self.path.name}", where=("table",), remedy=remedy)
        table = file.read_row_group(block, columns=self.names)
        return {name: np.asarray(_parquet_cells(table.column(name)), np.float64) for name in self.names}

    def columns(self, keep: Collection[str], allow_invalid: bool) -> Columns:
        """Return all columns, or refuse the file."""
        from pyarrow import types

        with self._opened() as file:
            schema, rows = file.schema_arrow, file.metadata.num_rows
            names = list(schema.names)
            for position, name in enumerate(names):
                check_name(name, position, names[:position], f"{self.path.name}: ")
            if not rows:
                raise refused(f"{self.path.name} has no rows", "write one row per design")
            indices = [_label(name) for name in names if name.startswith(INDEX)]
            found = Columns((*keep, *indices), allow_invalid, list(map(_label, names)))
            for name in names:
                kind = schema.field(name).type
                if (types.is_integer(kind) or types.is_floating(kind)) and not is_label(name, found.keep):
                    self.names.append(name)
            self.is_large = 8 * rows * len(self.names) > LARGE
            walks = self._walked(file, found)
            for name in names:
                if name in walks:
                    found.take(name, walks[name])
                else:
                    found.add(_label(name), _parquet_cells(file.read([name]).column(0)))
            _add_index(found, schema.pandas_metadata, rows)
            return found

    def _walked(self, file: Any, found: Columns) -> dict[str, Walk]:
        """Look at all numbers of the file, row group by row group."""
        walks = {name: Walk(self, name) for name in self.names}
        for group in range(file.num_row_groups):
            for name, values in self._group(file, group).items():
                found.check_finite(name, values, self.starts[-1])
                walks[name].add(values)
            self.begin(file.metadata.row_group(group).num_rows)
        return walks


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
    """Return the designs of a Dataset in its own dimensions, as table says; results of a map are left out."""
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
    dims, shape = (*space.dims, *axes), (*space.shape, *map(len, axes.values()))
    return replace(space, dims=dims, shape=shape, axes=axes, ignored=tuple(reader.results))


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
    """The variables of a Dataset that may give designs, and which are results of the map that it is."""

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


def as_space(source: Any, *, keep: Sequence[str] = (), allow_invalid: bool = False) -> DesignSpace:
    """Return the designs that stand in place of a design space: a table, one design, or those of a map."""
    space = _space_of(source, _kept(keep), allow_invalid, single=True)
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
        return read_file(path, keep, allow_invalid).space(attrs, single=single)
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
