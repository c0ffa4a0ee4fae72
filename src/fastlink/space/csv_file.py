"""Read tables of designs from CSV files."""

from __future__ import annotations

import csv
import math
from array import array
from collections.abc import Collection, Iterable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from fastlink._text import counted, short_repr
from fastlink.options import not_a_file
from fastlink.space.columns import Columns, check_name, is_label, or_keep, refused
from fastlink.space.table_file import FileColumn, TableFile, Walk
from fastlink.space.values import check_input_name

__all__ = ["read_csv"]

#: What may separate columns where the first line holds no comma: other programs export these.
SEPARATORS = ";\t"
#: Bytes of files whose numbers are kept in memory; those of larger ones are read block by block.
LARGE = 64 << 20
#: Rows of such a block: as many as an evaluation takes at once.
BLOCK_ROWS = 4096


def read_csv(path: Path, keep: Collection[str], allow_invalid: bool) -> Columns:
    """Return the columns of a CSV file; blank lines are skipped.

    Numbers of a large file are looked at once and read again, block by block, where they are needed; labels are kept.

    Raises
    ------
    InputError
        With the line of the file and what to write there.
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


def _rows(lines: Iterable[str], separator: str) -> Any:
    """Return a reader of the rows of some lines."""
    return csv.reader(lines, skipinitialspace=True, strict=True, delimiter=separator)


def _is_hdf5(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(4) == b"\x89HDF"


class _Blocks(TableFile):
    """A CSV file, whose rows were all looked at, and the places of its blocks.

    Parameters
    ----------
    path : Path
        The file.
    file : text file
        The same, being read.
    """

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
            yield from _rows(file, self.separator)


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
        self.reader: Any = _rows(lines, self.separator)

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
