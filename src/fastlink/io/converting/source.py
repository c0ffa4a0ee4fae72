"""The part of a map that a conversion reads, block by block."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from fastlink.errors import InputError, Problems
from fastlink.io.converting.selection import Indexer, Selection
from fastlink.io.dataset import Variable, plain_attrs
from fastlink.io.place import reason
from fastlink.io.ranges import pieces

__all__ = ["BLOCK_BYTES", "Index", "Source"]

#: Bytes of values that are read at once.
BLOCK_BYTES = 1 << 24
#: Coordinates along others that have more bytes are read block by block, like results.
FEW_BYTES = 1 << 20
#: A part of an array: a number or a slice by dimension.
Index = tuple[int | slice, ...]


class Source:
    """The part of a map that a conversion takes.

    Parameters
    ----------
    maps : xarray.Dataset
        The map; its values are read when they are used.
    selection : Selection
        What is taken along its dimensions.
    names : sequence of str
        The variables that are taken.
    dtype : numpy.dtype or None
        The type of floating-point numbers in the result; that of the map unless given.

    Attributes
    ----------
    coords : xarray.Dataset
        Coordinates of the result, besides the columns.
    columns : list of Variable
        Coordinates with a value for each design, where these are many.
    variables : list of Variable
        Its variables, with the attributes of the map.
    overflows : dict of str to int
        How many values have become infinite, by variable.
    """

    def __init__(
        self, maps: xr.Dataset, selection: Selection, names: Sequence[str], dtype: np.dtype[Any] | None
    ) -> None:
        self._maps, self._indexers = maps, selection.indexers
        coords = maps.drop_vars([name for name in maps.data_vars if name not in names])
        used = {dim for name in names for dim in maps[name].dims}
        # a dimension that no variable has tells nothing
        coords = coords.drop_vars([n for n, one in coords.coords.items() if not set(one.dims) <= used])
        coords = coords.drop_vars(list(coords.data_vars)).isel(
            {dim: indexer for dim, indexer in selection.indexers.items() if dim in coords.dims}
        )
        _check_kinds([maps[name] for name in names], list(coords.coords.values()))
        long = [
            str(name)
            for name, one in coords.coords.items()
            if _is_column(one) and one.dims[0] in coords.coords
        ]
        self.columns = [replace(self._variable(name, None), is_coordinate=True) for name in long]
        self.coords = coords.drop_vars(long).drop_encoding().load()
        self.coords.attrs = {}  # those of the result are other ones
        self.variables = [self._variable(name, dtype) for name in names]
        self.overflows: dict[str, int] = {}

    def remarks(self) -> dict[str, str]:
        """Return what is known of the values once all are written, as global attributes."""
        counts = ", ".join(f"{name}: {count}" for name, count in self.overflows.items())
        return {"rounding_overflows": counts} if counts else {}

    @property
    def nbytes(self) -> int:
        """Bytes of all values of the result."""
        return sum(variable.nbytes for variable in self.all)

    @property
    def all(self) -> list[Variable]:
        """All that is read block by block: the columns, then the variables."""
        return [*self.columns, *self.variables]

    def _variable(self, name: str, dtype: np.dtype[Any] | None) -> Variable:
        array = self._maps[name]
        kept = [dim for dim in array.dims if not isinstance(self._indexers.get(str(dim)), int)]
        shape = tuple(_length(self._indexers.get(str(dim)), array.sizes[dim]) for dim in kept)
        own = array.dtype if dtype is None or array.dtype.kind != "f" else dtype
        return Variable(name, tuple(map(str, kept)), shape, own, plain_attrs(array.attrs))

    def blocks(
        self, variable: Variable, steps: tuple[int, ...] = ()
    ) -> Iterator[tuple[Index, int, NDArray[Any]]]:
        """Yield the values of a variable in blocks: index, first flat number, values."""
        most = max(1, BLOCK_BYTES // self._maps[variable.name].dtype.itemsize)
        for index, first in pieces(variable.shape, most, steps):
            yield index, first, self.read(variable, index)

    def read(self, variable: Variable, index: Index) -> NDArray[Any]:
        """Return part of a variable of the result, in its type."""
        array = self._maps[variable.name].variable
        wanted = dict(zip(variable.dims, (*index, *[slice(None)] * len(variable.dims)), strict=False))
        lengths = dict(zip(variable.dims, variable.shape, strict=True))
        takes = [
            _within(self._indexers.get(str(dim)), wanted.get(str(dim), 0), lengths.get(str(dim), 1))
            for dim in array.dims
        ]
        try:
            values = np.ascontiguousarray(_taken(array, takes))
        except (OSError, RuntimeError, KeyError, ValueError) as error:
            what = f"{variable.name} cannot be read ({reason(error)})"
            raise InputError(what, where=("maps",), remedy="check the file by `fastlink check`") from error
        if values.dtype == variable.dtype:
            return values
        with np.errstate(over="ignore"):
            result = values.astype(variable.dtype)
        if result.itemsize < values.itemsize:
            if _is_bound(variable):  # a bound stays one
                result = np.where(result < values, np.nextafter(result, np.inf, dtype=result.dtype), result)
            beyond = int(np.count_nonzero(np.isinf(result) & np.isfinite(values)))
            if beyond:
                self.overflows[variable.name] = self.overflows.get(variable.name, 0) + beyond
        return result


def _check_kinds(variables: Sequence[xr.DataArray], coords: Sequence[xr.DataArray]) -> None:
    """Refuse values that are no numbers, and labels that are neither numbers nor text."""
    problems = Problems()
    for one in variables:
        if one.dtype.kind not in "iuf":
            remedy = "make numbers of them, such as by astype, or name others by quantities"
            problems.add(f"the values of {one.name} are of {one.dtype}, not numbers", ("maps",), remedy)
    for one in coords:
        of_text = one.dtype.kind == "O" and all(isinstance(label, str) for label in one.values.flat)
        if one.dtype.kind not in "iufU" and not of_text:
            what = f"the labels of {one.name} are of {one.dtype}, neither numbers nor text"
            problems.add(what, ("maps",), "give a map without it, such as by drop_vars")
    problems.stop()


def _is_column(coord: xr.DataArray) -> bool:
    """Tell whether a coordinate is read block by block."""
    return (
        coord.ndim == 1
        and coord.name not in coord.dims
        and coord.dtype.kind in "iuf"
        and coord.nbytes > FEW_BYTES
    )


def _is_bound(variable: Variable) -> bool:
    """Tell whether a variable bounds errors."""
    return str(variable.attrs.get("symbol", "")).startswith("err ")


def _length(indexer: Indexer | None, size: int) -> int:
    if isinstance(indexer, np.ndarray):
        return indexer.size
    return size if not isinstance(indexer, slice) else len(range(size)[indexer])


def _within(indexer: Indexer | None, wanted: int | slice, length: int) -> Indexer:
    """Return what is read of a dimension of the map, for a part of the result."""
    if isinstance(indexer, int):
        return indexer
    if isinstance(indexer, np.ndarray):
        return int(indexer[wanted]) if isinstance(wanted, int) else indexer[wanted]
    first = indexer.start if isinstance(indexer, slice) else 0
    if isinstance(wanted, int):
        return first + wanted
    start, stop, _ = wanted.indices(length)
    return slice(first + start, first + stop)


def _taken(array: xr.Variable, takes: list[Indexer]) -> NDArray[Any]:
    """Return part of an array: read from the first to the last number along each dimension, then picked."""
    spans = [
        slice(int(take[0]), int(take[-1]) + 1) if isinstance(take, np.ndarray) else take for take in takes
    ]
    lengths = [1 if isinstance(span, int) else span.stop - span.start for span in spans]
    if math.prod(lengths) * array.dtype.itemsize > 2 * BLOCK_BYTES:  # few numbers far from each other
        for k, take in enumerate(takes):
            if isinstance(take, np.ndarray) and take.size > 1:
                halves = (take[: take.size // 2], take[take.size // 2 :])
                axis = sum(not isinstance(one, int) for one in takes[:k])
                parts = [_taken(array, [*takes[:k], half, *takes[k + 1 :]]) for half in halves]
                return np.concatenate(parts, axis)
    values = np.asarray(array[tuple(spans)].values)
    axis = 0
    for take in takes:
        if isinstance(take, np.ndarray):
            values = np.take(values, take - take[0], axis)
        axis += not isinstance(take, int)
    return values
