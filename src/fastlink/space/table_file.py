"""Columns of tables in files that are too large for memory: read block by block, where they are looked at."""

from __future__ import annotations

import hashlib
import threading
from abc import ABC, abstractmethod
from bisect import bisect_right
from collections import OrderedDict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fastlink.errors import InputError
from fastlink.space.column import Column
from fastlink.space.values import Floats

__all__ = ["FileColumn", "TableFile", "Walk"]

#: Bytes of blocks that a table keeps at most, beside the last two, between which threads may be.
KEPT_BYTES = 64 << 20


class TableFile(ABC):
    """A table in a file, of which blocks of rows are read; thread-safe.

    Parameters
    ----------
    path : Path
        The file, which must not change from now on.

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
    """A column of numbers of a table in a file.

    Parameters
    ----------
    file : TableFile
        The table.
    key : str or int
        Its name or number there.
    walk : Walk
        What was seen of its numbers.
    """

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
