"""Columns of designs whose values are computed where they are looked at."""

from __future__ import annotations

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import NDArray

from fastlink.memory import check_memory

__all__ = [
    "STEP",
    "Column",
    "Consecutive",
    "Converted",
    "Counted",
    "Gathered",
    "bounds_of",
    "definition_of",
    "part_of",
    "read_into",
    "steps",
]

#: Values that are computed at once where many are walked through.
STEP = 1 << 16
#: Values that show in what unit all are given.
FEW = 100
FEWER = "read a part of it, such as column[:1000]"


class Column(NDArrayOperatorsMixin, ABC):
    """Values along the designs that are computed where they are looked at, and held nowhere.

    It reads as a 1-D array: ``column[10:20]``, ``numpy.asarray(column)``, ``column.min()``. Any division into blocks
    gives the same bits, from any thread.

    Parameters
    ----------
    length : int
        The number of values.
    bounds : (float, float)
        Two numbers between which all values are, ends included; NaN where nothing is known.

    Attributes
    ----------
    dtype : numpy.dtype
        Of numbers.
    """

    dtype: np.dtype[Any] = np.dtype(np.float64)
    ndim = 1

    def __init__(self, length: int, bounds: tuple[float, float]) -> None:
        self.length, self.bounds = length, bounds

    @abstractmethod
    def read(self, start: int, stop: int, out: NDArray[Any]) -> None:
        """Write values ``start`` to ``stop - 1`` into an array of as many; thread-safe."""

    @property
    @abstractmethod
    def definition(self) -> tuple[Any, ...]:
        """A tuple that tells these values from all others: its text is the same on any machine."""

    @property
    def shape(self) -> tuple[int]:
        """The number of values, as that of an array."""
        return (self.length,)

    @property
    def size(self) -> int:
        """The number of values."""
        return self.length

    @property
    def nbytes(self) -> int:
        """The bytes of all values in memory."""
        return self.length * self.dtype.itemsize

    def piece(self, start: int, stop: int) -> NDArray[Any]:
        """Return values ``start`` to ``stop - 1`` as a new array."""
        values = np.empty(stop - start, self.dtype)
        for first, last in steps(start, stop):
            self.read(first, last, values[first - start : last - start])
        return values

    def sample(self) -> list[float]:
        """Return the bounds and the first values, which show in what unit they are given."""
        return [*self.bounds, *self.piece(0, min(self.length, FEW)).tolist()]

    def __len__(self) -> int:
        return self.length

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        if copy is False:
            raise ValueError("the values are held nowhere: there is no array without a copy")
        check_memory(self.nbytes, f"an array of {self.length:,} values", remedy=FEWER)
        values = self.piece(0, self.length)
        return values if dtype is None else values.astype(dtype, copy=False)

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, slice):
            start, stop, step = key.indices(self.length)
            if step == 1:
                return self.piece(start, max(start, stop))
        elif isinstance(key, (int, np.integer)) and not isinstance(key, bool):
            number = range(self.length)[key]
            return self.piece(number, number + 1)[0]
        return np.asarray(self)[key]

    def __iter__(self) -> Iterator[Any]:
        for start, stop in steps(0, self.length):
            yield from self.piece(start, stop)

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        arrays = [np.asarray(given) if isinstance(given, Column) else given for given in inputs]
        return getattr(ufunc, method)(*arrays, **options)

    def __getattr__(self, name: str) -> Any:
        if not name.startswith("_") and hasattr(np.ndarray, name):
            return getattr(np.asarray(self), name)
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def __repr__(self) -> str:
        low, high = self.bounds
        return f"<{self.length:,} values from {low!r} to {high!r}, computed where they are looked at>"


class Gathered(Column):
    """Values of an axis or column of a design space at consecutive designs.

    Parameters
    ----------
    source : array or Column
        The values along their dimension.
    inner : int
        Designs that have the same value before the next one follows.
    first : int
        The number of the first design.
    length : int
        The number of designs.
    """

    def __init__(self, source: NDArray[Any] | Column, inner: int, first: int, length: int) -> None:
        super().__init__(length, bounds_of(source))
        self.source, self.inner, self.first, self.dtype = source, inner, first, source.dtype

    def read(self, start: int, stop: int, out: NDArray[Any]) -> None:
        """Write some values."""
        if start == stop:
            return
        index = np.arange(self.first + start, self.first + stop)
        if self.inner > 1:
            index //= self.inner
        if isinstance(self.source, Column):
            low = int(index[0])
            index -= low
            np.take(self.source.piece(low, low + int(index[-1]) + 1), index, out=out, mode="clip")
            return
        count = len(self.source)
        if (self.first + self.length - 1) // self.inner >= count:
            index -= index // count * count  # 3.6 us per 4096, numpy's remainder 7.3 us
        # "clip" writes in place, the default "raise" in a copy of the output; no index needs clipping
        np.take(self.source, index, out=out, mode="clip")

    @property
    def definition(self) -> tuple[Any, ...]:
        """The class and its parameters."""
        return "gathered", self.inner, self.first, self.length, definition_of(self.source)


class Consecutive(Column):
    """Consecutive values of another column.

    Parameters
    ----------
    source : Column
        All values.
    start, stop : int
        The range of these.
    """

    def __init__(self, source: Column, start: int, stop: int) -> None:
        super().__init__(stop - start, source.bounds)
        self.source, self.start, self.dtype = source, start, source.dtype

    def read(self, start: int, stop: int, out: NDArray[Any]) -> None:
        """Write some values."""
        self.source.read(self.start + start, self.start + stop, out)

    @property
    def definition(self) -> tuple[Any, ...]:
        """The class and its parameters."""
        return "consecutive", self.start, self.length, self.source.definition


class Counted(Column):
    """Whole numbers that follow each other.

    Examples
    --------
    >>> Counted(10**10, 4)[1:3].tolist()
    [10000000001, 10000000002]
    """

    dtype = np.dtype(np.int64)

    def __init__(self, first: int, length: int) -> None:
        super().__init__(length, (float(first), float(first + length)))
        self.first = first

    def read(self, start: int, stop: int, out: NDArray[Any]) -> None:
        """Write some numbers."""
        out[:] = np.arange(self.first + start, self.first + stop)

    @property
    def definition(self) -> tuple[Any, ...]:
        """The class and its parameters."""
        return "counted", self.first, self.length


class Converted(Column):
    """Values of another column in another unit.

    Parameters
    ----------
    source : Column
        The values.
    convert : callable
        A growing function of an array.
    """

    def __init__(self, source: Column, convert: Callable[[Any], Any]) -> None:
        low, high = (float(convert(end)) for end in source.bounds)
        super().__init__(source.length, (low, high))
        self.source, self.convert = source, convert

    def read(self, start: int, stop: int, out: NDArray[Any]) -> None:
        """Write some values."""
        self.source.read(start, stop, out)
        out[:] = self.convert(out)

    @property
    def definition(self) -> tuple[Any, ...]:
        """The class and its parameters."""
        return "converted", self.convert.__name__, self.source.definition


def steps(start: int, stop: int) -> Iterator[tuple[int, int]]:
    """Yield the pieces in which many values are walked through.

    Examples
    --------
    >>> list(steps(0, 100_000))
    [(0, 65536), (65536, 100000)]
    """
    for first in range(start, stop, STEP):
        yield first, min(first + STEP, stop)


def read_into(values: NDArray[Any] | Column, start: int, stop: int, out: NDArray[Any]) -> None:
    """Write values ``start`` to ``stop - 1`` of an array or a column into an array of as many."""
    if isinstance(values, Column):
        values.read(start, stop, out)
    else:
        out[:] = values[start:stop]


def bounds_of(values: NDArray[Any] | Column) -> tuple[float, float]:
    """Return two numbers between which all values are, NaN where one is no number, or there is none."""
    if isinstance(values, Column):
        return values.bounds
    if not values.size or values.dtype.kind not in "iuf":
        return np.nan, np.nan
    return float(values.min()), float(values.max())


def definition_of(values: NDArray[Any] | Column) -> tuple[Any, ...]:
    """Return what values follow from, of an array a hash of them."""
    if isinstance(values, Column):
        return values.definition
    if values.dtype.kind in "iuf":
        return "values", str(values.dtype), hashlib.sha256(np.ascontiguousarray(values).data).hexdigest()
    return "texts", hashlib.sha256(repr(values.tolist()).encode()).hexdigest()


def part_of(values: NDArray[Any] | Column, inner: int, start: int, stop: int) -> NDArray[Any] | Column:
    """Return the values along one dimension at consecutive designs.

    Parameters
    ----------
    values : array or Column
        The values along their dimension.
    inner : int
        Designs that have the same value before the next one follows.
    start, stop : int
        The range of designs.
    """
    repeated = inner > 1 or stop > len(values)
    if repeated and values.dtype.kind not in "iuf":  # texts, which no file takes block by block
        return values[np.arange(start, stop) // inner % len(values)]
    if repeated:
        return Gathered(values, inner, start, stop - start)
    if isinstance(values, Column):
        return Consecutive(values, start, stop)
    return values[start:stop]
