"""Rows of a map: the places along some dimensions, read block by block, so that a map may be larger than memory."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from fastlink.io.ranges import pieces
from fastlink.space.design_space import DESIGN

__all__ = ["Block", "Rows", "numeric"]

#: Rows that are read at once.
MOST_ROWS = 1 << 20
#: A block of which such a share of rows is wanted is read whole: to read one row costs as much as 1,000 in a row.
DENSE = 1e-3


@dataclass(frozen=True)
class Block:
    """Consecutive rows.

    Attributes
    ----------
    index : tuple of int or slice
        Where they are, along the first dimensions.
    first, count : int
        The number of the first one, and how many they are.
    """

    index: tuple[int | slice, ...]
    first: int
    count: int


@dataclass(frozen=True)
class Rows:
    """The places along some dimensions, numbered in C order.

    Attributes
    ----------
    sizes : dict
        The dimensions and their lengths.
    """

    sizes: dict[str, int]

    @classmethod
    def of(cls, arrays: Iterable[xr.DataArray]) -> Rows:
        """Return the places along all dimensions that some variables have, those of the greatest one first."""
        sizes: dict[str, int] = {}
        for array in sorted(arrays, key=lambda array: -array.ndim):
            sizes |= {str(dim): length for dim, length in array.sizes.items() if str(dim) not in sizes}
        return cls(sizes)

    @property
    def shape(self) -> tuple[int, ...]:
        """The length of each dimension."""
        return tuple(self.sizes.values())

    def blocks(self, most: int = 0) -> Iterator[Block]:
        """Yield all rows in consecutive pieces of about `most`, `MOST_ROWS` unless given.

        Examples
        --------
        >>> list(Rows({"a1": 2, "a2": 3}).blocks(2))[:2]
        [Block(index=(0, slice(0, 2, None)), first=0, count=2), Block(index=(0, slice(2, 3, None)), first=2, count=1)]
        """
        for index, first in pieces(self.shape, most or MOST_ROWS):
            lead = index[-1]
            assert isinstance(lead, slice)
            yield Block(index, first, (lead.stop - lead.start) * math.prod(self.shape[len(index) :]))

    def read(self, array: xr.DataArray, block: Block) -> NDArray[Any]:
        """Return the values of a variable in the rows of a block; it has some of the dimensions, or none."""
        if not array.dims:
            return np.broadcast_to(array.values, block.count)
        parts = dict(zip(self.sizes, block.index, strict=False))  # the last dimensions are whole
        own = array.variable[{dim: part for dim, part in parts.items() if dim in array.dims}]
        kept = [dim for dim in self.sizes if not isinstance(parts.get(dim), int)]
        values = own.transpose(*(dim for dim in kept if dim in own.dims)).values
        values = values[tuple(slice(None) if dim in own.dims else None for dim in kept)]
        lengths = [self.sizes[dim] for dim in kept[1:]]
        whole = np.broadcast_to(values, (block.count // math.prod(lengths), *lengths))
        return whole.reshape(-1)

    def taken(self, maps: xr.Dataset, flat: NDArray[np.int64]) -> xr.Dataset:
        """Return everything that a map says of some rows, along ``design``."""

        def of(array: xr.DataArray) -> Any:
            if not array.dims:
                return array.variable.copy(deep=False)
            return (DESIGN,), self._values(array, flat), dict(array.attrs)

        def of_them(arrays: Any) -> dict[Any, Any]:
            return {name: of(array) for name, array in arrays.items() if set(array.dims) <= self.sizes.keys()}

        return xr.Dataset(of_them(maps.data_vars), of_them(maps.coords), dict(maps.attrs))

    def _values(self, array: xr.DataArray, flat: NDArray[np.int64]) -> NDArray[Any]:
        """Return the values of a variable in some rows: one by one where they are few, else by blocks."""
        values = np.empty(len(flat), dtype=array.dtype)
        numbers = np.unravel_index(flat, self.shape)
        places = dict(zip(self.sizes, numbers, strict=True))
        if array.ndim == 1:
            return np.asarray(array.values)[places[str(array.dims[0])]]
        order = np.argsort(flat, kind="stable")
        ordered = flat[order]
        for block in self.blocks():
            start, stop = np.searchsorted(ordered, (block.first, block.first + block.count))
            if stop - start > DENSE * block.count:
                values[order[start:stop]] = self.read(array, block)[ordered[start:stop] - block.first]
                continue
            for row in order[start:stop]:
                values[row] = array.variable[{dim: int(places[str(dim)][row]) for dim in array.dims}].values
        return values


def numeric(maps: xr.Dataset) -> list[str]:
    """Return the variables and coordinates that have numbers along dimensions."""
    return [str(name) for name, array in maps.variables.items() if array.dtype.kind in "iuf" and array.ndim]
