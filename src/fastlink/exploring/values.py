"""Read what a page shows of a map: a picture's values at the resolution of a screen, a row, a sample."""

from __future__ import annotations

import math
import threading
from collections import OrderedDict
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from fastlink.exploring.colours import scale_of
from fastlink.exploring.pooling import ONE, pooled
from fastlink.io.reader import is_hdf5
from fastlink.maps.flags import flags_of
from fastlink.space.dataset import STATUS
from fastlink.space.design_space import DESIGN

__all__ = ["MOST_CELLS", "Values"]

#: Cells along a side of a picture; values from which a scale of colours is chosen; designs of a sample.
MOST_CELLS, SAMPLED, MOST_DESIGNS = 720, 1 << 18, 100_000
#: Pictures that are kept for the next step.
KEPT = 32
#: The most values of which the cells of a picture are made, where these hold several.
MOST_POOLED = 1 << 26


class Values:
    """The values of a map, as a page wants them.

    Parameters
    ----------
    maps : xarray.Dataset
        The map, read where it is used.
    path : Path, optional
        The file that this map is, all of it and unchanged: a Dataset also remembers the file from which it was made.
    """

    def __init__(self, maps: xr.Dataset, path: Path | None = None) -> None:
        self.maps, self.path = maps, path
        self.lock = threading.Lock()
        self.mapped: dict[str, Any] = {}
        self.scales: dict[str, dict[str, Any]] = {}
        self.kept: OrderedDict[Any, NDArray[Any]] = OrderedDict()

    @property
    def names(self) -> list[str]:
        """The variables of numbers."""
        return [
            str(name) for name, one in self.maps.data_vars.items() if one.dtype.kind in "iuf" and one.size
        ]

    @property
    def step(self) -> int:
        """How many designs of a sample follow each other for one that is shown."""
        return -(-int(self.maps.sizes.get(DESIGN, 1)) // MOST_DESIGNS)

    def part(self, name: str, places: Mapping[str, int | slice]) -> NDArray[Any]:
        """Return a part of a variable or coordinate.

        Of a file without compression it is taken straight from the bytes, which is 10 times as fast as by HDF5.
        """
        variable = self.maps[name].variable
        index = tuple(places.get(str(dim), slice(None)) for dim in variable.dims)
        with self.lock:
            if name not in self.mapped:
                self.mapped[name] = _mapped(self.path, name, variable)
            source = self.mapped[name]
            return np.asarray(variable[index].values if source is None else source[index])

    def picture(
        self,
        name: str,
        axes: tuple[str, ...],
        at: Mapping[str, int],
        window: Mapping[str, tuple[int, int]],
        pool: str = ONE,
    ) -> tuple[NDArray[np.float32], dict[str, int], str]:
        """Return the values over one or two axes, the first along rows, the steps between them, and what they are.

        Parameters
        ----------
        name : str
            The variable.
        axes : tuple of str
            The dimensions that are shown.
        at : mapping of str to int
            The place along the others.
        window : mapping of str to (int, int)
            The first and the last place that is shown along an axis; all unless given.
        pool : str
            What a value is where it stands for several designs: one of them, or a key of `pooling.POOLS`, which is left
            for one of them where that has no sense, as of codes, or would take long.
        """
        dims = [str(dim) for dim in self.maps[name].dims]
        own = [dim for dim in dims if dim in axes]
        ranges, steps = {}, {}
        for dim in own:
            low, high = window.get(dim, (0, self.maps.sizes[dim] - 1))
            most = MOST_CELLS if len(axes) > 1 else MOST_CELLS * MOST_CELLS
            ranges[dim] = range(low, high + 1)
            steps[dim] = max(1, -(-len(ranges[dim]) // most))
        shape = [len(one) for one in ranges.values()]
        if max(steps.values()) == 1 or math.prod(shape) > MOST_POOLED or not self.scale(name)["pools"]:
            pool = ONE
        key = name, axes, str(ranges), str([at[dim] for dim in dims if dim not in own]), pool
        found = self.kept.get(key)
        if found is None:
            values = self._pictured(name, at, ranges, steps, pool)
            order = [own.index(axis) for axis in axes if axis in own]
            found = np.ascontiguousarray(values.transpose(order))
            with self.lock:
                self.kept[key] = found
                while len(self.kept) > KEPT:
                    self.kept.popitem(last=False)
        return found, steps, pool

    def _pictured(
        self, name: str, at: Mapping[str, int], ranges: dict[str, range], steps: dict[str, int], pool: str
    ) -> NDArray[np.float32]:
        """Return the values of a picture in the order of the variable's dimensions."""
        places: dict[str, int | slice] = {
            str(dim): at[str(dim)] for dim in self.maps[name].dims if dim not in ranges
        }
        if pool == ONE:
            places |= {dim: slice(one.start, one.stop, steps[dim]) for dim, one in ranges.items()}
            return self.part(name, places).astype(np.float32)
        (first, rows), *others = ranges.items()
        places |= {dim: slice(one.start, one.stop) for dim, one in others}
        columns, across = (len(others[0][1]), steps[others[0][0]]) if others else (1, 1)

        def read(some: slice) -> NDArray[Any]:
            return self.part(name, {**places, first: some}).reshape(-1, columns)

        found = pooled(read, rows, columns, (steps[first], across), pool)
        return found if others else found[:, 0]

    def column(self, name: str, at: Mapping[str, int]) -> NDArray[np.float32]:
        """Return the values of a variable or coordinate of the designs of a sample."""
        places: dict[str, int | slice] = {
            str(dim): at[str(dim)] for dim in self.maps[name].dims if dim != DESIGN
        }
        return self.part(name, {**places, DESIGN: slice(None, None, self.step)}).astype(np.float32)

    def row(self, at: Mapping[str, int]) -> dict[str, Any]:
        """Return all values of one place, those of inputs along ``design`` too."""
        found = {}
        for name in (*self.names, *map(str, self.maps.coords)):
            dims = [str(dim) for dim in self.maps[name].dims]
            if name in at or not set(dims) <= at.keys() or not dims:
                continue
            value = self.part(name, {dim: at[dim] for dim in dims})
            found[name] = value.item() if value.dtype.kind in "iuf" else str(value)
        return found

    def scale(self, name: str) -> dict[str, Any]:
        """Return how the values of a variable become colours, from a sample of all of them."""
        if name not in self.scales:
            array = self.maps[name]
            sizes = {str(dim): length for dim, length in array.sizes.items()}
            steps = _steps(sizes, SAMPLED)
            places: dict[str, int | slice] = {dim: slice(None, None, step) for dim, step in steps.items()}
            sample = self.part(name, places)
            self.scales[name] = scale_of(array, sample, self._regular(array, sample.shape, places))
        return self.scales[name]

    def _regular(self, array: xr.DataArray, shape: tuple[int, ...], places: Mapping[str, Any]) -> Any:
        """Return which values of a sample are of designs without toggles, None where that is not known."""
        if (
            STATUS not in self.names
            or array.name == STATUS
            or not set(self.maps[STATUS].dims) <= set(array.dims)
        ):
            return None
        status = self.maps[STATUS]
        if not (flags := flags_of(status)):
            return None
        codes = self.part(STATUS, {dim: one for dim, one in places.items() if dim in status.dims})
        own = [dim for dim in array.dims if dim in status.dims]
        codes = codes.transpose([status.dims.index(dim) for dim in own])
        whole = codes[tuple(slice(None) if dim in status.dims else None for dim in array.dims)]
        return np.broadcast_to(whole == next(iter(flags.values())), shape)


def _steps(sizes: Mapping[str, int], most: int) -> dict[str, int]:
    """Return steps along dimensions that leave about so many values, from the longest dimension first."""
    steps = dict.fromkeys(sizes, 1)

    def left(dim: str) -> int:
        return -(-sizes[dim] // steps[dim])

    while np.prod([left(dim) for dim in sizes], dtype=float) > most:
        steps[max(sizes, key=left)] += 1
    return steps


def _mapped(path: Path | None, name: str, variable: xr.Variable) -> Any:
    """Return the values of a variable as they lie in its file, None where they do not lie there as they are."""
    if path is None or not path.is_file() or not is_hdf5(path):
        return None
    with h5py.File(path, "r") as file:
        stored = file.get(name)
        if (
            not isinstance(stored, h5py.Dataset)
            or stored.chunks is not None
            or stored.shape != variable.shape
        ):
            return None
        offset = stored.id.get_offset()
        if offset is None or not stored.size:
            return None
        return np.memmap(path, dtype=stored.dtype, mode="r", offset=offset, shape=stored.shape)
