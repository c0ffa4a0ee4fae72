"""Convert a finished map to another format, compressed, in part, or with fewer digits."""

from __future__ import annotations

import contextlib
import csv
import io
import json
import math
import os
import shlex
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO

import h5py
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from fastlink._text import short_repr, unwritable
from fastlink.errors import (
    InputError,
    KeyPath,
    Problems,
    Setting,
    check_choice,
    check_path,
    check_switch,
    door,
    remark,
    require_package,
    suggest,
)
from fastlink.io import partial_file
from fastlink.io.checksums import OF_REST, pieces
from fastlink.io.layout import (
    FINGERPRINT,
    FORMAT_VERSION,
    HISTORY,
    MEASURED,
    PLAIN,
    SOURCE,
    WRITTEN,
    Variable,
    fault_of_value,
    history,
    plain_attrs,
)
from fastlink.io.output import output_file, output_folder
from fastlink.io.output_path import exists_error, part_of, progress_bar, reason, refused
from fastlink.io.partial_file import check_target
from fastlink.io.reader import (
    COMPRESSION,
    OF_PARTS,
    as_map,
    files_of,
    is_zarr,
    register_filter,
)
from fastlink.io.where import Indexer, Selection, selected
from fastlink.io.writer import Writer, auxiliary, create_checksums, label, lay_labels
from fastlink.space.design_space import BRANCH, DESIGN
from fastlink.space.tables import FORMAT, STATUS

# -- The compressions of converted files, by name and level, in the words of each library


#: The levels of each compression, from the fastest to the smallest, and the one that is taken unless given.
LEVELS: dict[str, tuple[int, int, int] | None] = {
    "gzip": (1, 9, 4),
    "zstd": (1, 22, 3),
    "blosc": (1, 9, 5),
    "lz4": None,
}
#: The compressions of each format; text has none.
OF_FORMAT = {
    "hdf5": ("gzip", "zstd", "blosc", "lz4"),
    "zarr": ("gzip", "zstd", "blosc", "lz4"),
    "parquet": ("gzip", "zstd", "lz4"),
    "csv": (),
    "xlsx": (),
}


@dataclass(frozen=True)
class Compression:
    """A compression and its level, None for one that has no levels."""

    name: str
    level: int | None

    def __str__(self) -> str:
        return self.name if self.level is None else f"{self.name}:{self.level}"

    def of_hdf5(self) -> dict[str, Any]:
        """Return the options of a dataset of h5py; the bytes of its numbers are shuffled first."""
        if self.name == "gzip":
            return {"compression": "gzip", "compression_opts": self.level}
        import hdf5plugin

        register_filter(self.name)
        if self.name == "lz4":
            return dict(hdf5plugin.LZ4())
        if self.name == "zstd":
            return dict(hdf5plugin.Zstd(clevel=self.level))
        return dict(hdf5plugin.Blosc(cname="zstd", clevel=self.level, shuffle=hdf5plugin.Blosc.NOSHUFFLE))

    def of_zarr(self) -> Any:
        """Return the codec of an array of zarr."""
        import numcodecs

        if self.name == "blosc":
            return numcodecs.Blosc(cname="zstd", clevel=self.level, shuffle=numcodecs.Blosc.SHUFFLE)
        level = {} if self.level is None else {"level": self.level}
        return numcodecs.get_codec({"id": self.name, **level})


def check_compression(value: Any, format: str) -> Compression | None:
    """Return a compression that is given as zstd:3 or gzip, or refuse it."""
    if value is None:
        return None
    where = ("compress",)
    known = OF_FORMAT[format]
    if not known:
        remedy = "leave it out, and compress the file afterwards, or write a .parquet"
        why = "CSV is plain text" if format == "csv" else "a workbook is compressed anyway"
        raise InputError(f"is {short_repr(value)}, and {why}", where=where, remedy=remedy)
    name, colon, level = value.partition(":") if isinstance(value, str) else (value, "", "")
    name = check_choice(where, name, known)
    levels = LEVELS[name]
    if colon and levels is None:
        what = f"is {short_repr(value)}, and {name} has no levels"
        raise InputError(what, where=where, remedy=("write ", Setting("compress", name)))
    number = None if levels is None else levels[2]
    if levels is not None and colon:
        number = int(level) if level.isdecimal() and level.isascii() and len(level) < 4 else -1
        if not levels[0] <= number <= levels[1]:
            example = Setting("compress", f"{name}:{levels[2]}")
            bounds = f", a level from {levels[0]} to {levels[1]}"
            raise InputError(f"is {short_repr(value)}", where=where, remedy=("write ", example, bounds))
    if format == "hdf5" and name != "gzip":
        require_package("hdf5plugin", ("compress",))
    return Compression(name, number)


def chunks_of(variable: Variable, nbytes: int) -> tuple[int, ...]:
    """Return the shape of the chunks of a variable, of consecutive values; empty for a single value."""
    if not variable.shape:
        return ()
    index, _ = next(pieces(variable.shape, max(1, nbytes // variable.dtype.itemsize)))
    divided = [1 if isinstance(part, int) else part.stop for part in index]
    return (*divided, *variable.shape[len(divided) :])


# -- The part of a map that a conversion reads, block by block


#: Bytes of values that are read at once.
BLOCK_BYTES = 1 << 24
#: Coordinates along others that have more bytes are read block by block, like results.
FEW_BYTES = 1 << 20
#: A part of an array: a number or a slice by dimension.
Index = tuple[int | slice, ...]


class Source:
    """The part of a map that a conversion takes: coordinates, columns of many designs, variables, read by blocks."""

    def __init__(
        self, maps: xr.Dataset, selection: Selection, names: Sequence[str], dtype: np.dtype[Any] | None
    ) -> None:
        self._maps, self._indexers = maps, selection.indexers
        indexers = {
            dim: slice(one.start, one.stop, one.step) if isinstance(one, range) else one
            for dim, one in selection.indexers.items()
        }
        # a dimension that no variable has tells nothing
        coords = maps[list(names)].drop_vars(names).isel(indexers, missing_dims="ignore")
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
        #: The global attributes of the result, and what is told of bytes that are done.
        self.attrs: dict[str, Any] = {}
        self.show: Callable[[int], Any] = lambda nbytes: None

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
        array, takes = self._maps[name], self._takes(name)
        kept = {dim: len(take) for dim, take in takes.items() if not isinstance(take, int)}
        kind = array.dtype if dtype is None or array.dtype.kind != "f" else dtype
        return Variable(name, tuple(kept), tuple(kept.values()), kind, plain_attrs(array.attrs))

    def _takes(self, name: str) -> dict[str, Indexer]:
        """Return what is taken of a variable along each of its dimensions."""
        sizes = self._maps[name].sizes
        return {str(dim): self._indexers.get(str(dim), range(size)) for dim, size in sizes.items()}

    def blocks(
        self, variable: Variable, steps: tuple[int, ...] = ()
    ) -> Iterator[tuple[Index, int, NDArray[Any]]]:
        """Yield the values of a variable in blocks: index, first flat number, values."""
        most = max(1, BLOCK_BYTES // self._maps[variable.name].dtype.itemsize)
        for index, first in pieces(variable.shape, most, steps):
            values = self.read(variable, index)
            yield index, first, values
            self.show(values.nbytes)

    def read(self, variable: Variable, index: Index) -> NDArray[Any]:
        """Return part of a variable of the result, in its type."""
        takes: dict[str, Any] = self._takes(variable.name)
        for dim, part in zip(variable.dims, index, strict=False):
            takes[dim] = takes[dim][part]
        single = tuple(
            axis for axis, take in enumerate(takes.values()) if isinstance(take, (int, np.integer))
        )
        several = [
            np.atleast_1d(take) if axis in single else take for axis, take in enumerate(takes.values())
        ]
        try:
            taken = _taken(self._maps[variable.name].variable, several)
            values = np.asarray(taken.squeeze(single), order="C")
        except (OSError, RuntimeError, KeyError, ValueError) as error:
            what = f"{variable.name} cannot be read ({reason(error)})"
            raise InputError(what, where=("maps",), remedy="check the file by `fastlink check`") from error
        if values.dtype == variable.dtype:
            return values
        with np.errstate(over="ignore"):
            result = values.astype(variable.dtype)
        if result.itemsize < values.itemsize:
            if str(variable.attrs.get("symbol", "")).startswith("err "):  # a bound of errors stays one
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


def _taken(array: xr.Variable, takes: list[Any]) -> NDArray[Any]:
    """Return part of an array: read from the first to the last number along each dimension, then picked."""
    lengths = [int(take[-1]) + 1 - int(take[0]) for take in takes]
    if math.prod(lengths) * array.dtype.itemsize > 2 * BLOCK_BYTES:  # few numbers far from each other
        for axis, (take, length) in enumerate(zip(takes, lengths, strict=True)):
            if 1 < len(take) < length:
                halves = (take[: len(take) // 2], take[len(take) // 2 :])
                parts = [_taken(array, [*takes[:axis], half, *takes[axis + 1 :]]) for half in halves]
                return np.concatenate(parts, axis)
    spans = tuple(slice(int(take[0]), int(take[-1]) + 1) for take in takes)
    values = np.asarray(array[spans].values)
    for axis, (take, length) in enumerate(zip(takes, lengths, strict=True)):
        if len(take) < length:
            picked = slice(None, None, take.step) if isinstance(take, range) else take - take[0]
            values = values[(slice(None),) * axis + (picked,)]
    return values


# -- The attributes of a converted map: what it holds of which map, and what is no longer true of it


#: Global attributes that are true of a whole run alone.
OF_RUN = ("designs_of_earlier_runs", "run_time_s", "set_up_time_s", "verified_designs")
OF_RUN_BEGIN = ("designs_per_", "configurations_per_", "verify_")
#: Measured on values as they were computed: of rounded values they say nothing.
OF_DOUBLES = ("error_median_relative", "error_max_roundings", "error_max_of_bound")


def labelled(maps: xr.Dataset, source: Source, selection: Selection, command: str) -> dict[str, Any]:
    """Return the global attributes of the result, and give those of its variables to the source."""
    given = {str(name): value for name, value in maps.attrs.items() if name not in (FORMAT, COMPRESSION)}
    of_file = (FINGERPRINT, WRITTEN, *OF_PARTS)  # nor can a converted part be joined
    attrs = {f"{SOURCE}{name}" if name in of_file else name: one for name, one in given.items()}
    if len(source.variables) < len(maps.data_vars):
        attrs = _titled(attrs, [str(name) for name in maps.data_vars], [v.name for v in source.variables])
    if selection.texts:
        attrs = _selected(maps, attrs, source, selection)
    for variable in source.variables:
        if selection.texts:
            named = [f"{SOURCE}{name}" if name.startswith(MEASURED) else name for name in variable.attrs]
            renamed = dict(zip(named, variable.attrs.values(), strict=True))
            variable.attrs.clear()
            variable.attrs.update(renamed)
        rounded = maps[variable.name].dtype.itemsize > variable.dtype.itemsize
        if rounded and variable.dtype.kind == "f":
            _round(variable)
    attrs[HISTORY] = history(command, str(given.get(HISTORY, "")))
    return plain_attrs(attrs)


def as_json(attrs: Mapping[str, Any]) -> dict[str, Any]:
    """Return attributes as JSON holds them."""
    return {
        str(name): value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value
        for name, value in attrs.items()
    }


def _titled(attrs: Mapping[str, Any], names: list[str], kept: list[str]) -> dict[str, Any]:
    """Return attributes whose title, if it lists the variables, lists those that are kept."""
    title = str(attrs.get("title", ""))
    listed = ", ".join(names)
    new = title.removesuffix(listed) + ", ".join(kept) if title.endswith(listed) else title
    return dict(attrs) | ({"title": new} if title else {})


def _selected(
    maps: xr.Dataset, attrs: Mapping[str, Any], source: Source, selection: Selection
) -> dict[str, Any]:
    """Return attributes that are true of a part of a map: its designs are counted, those of the run renamed."""
    sizes = {str(dim): selection.size(str(dim), size) for dim, size in maps.sizes.items()}
    designs = _design_dims(maps)
    fewer = [dim for dim in designs if dim in selection.indexers]
    of_run = (*OF_RUN, *OF_RUN_BEGIN, *(("design_",) if DESIGN in fewer else ()))
    result: dict[str, Any] = {}
    for name, value in attrs.items():
        if name == "designs" or name.startswith(of_run):
            result[f"{SOURCE}{name}"] = value
        elif not name.startswith("designs_") and name != "configurations":
            result[name] = value
    if DESIGN in fewer:
        result["design_kind"] = "grid" if isinstance(selection.indexers[DESIGN], int) else "table"
    result["selection"] = "; ".join(
        [*([str(attrs["selection"])] if "selection" in attrs else []), *selection.texts]
    )
    result["designs"] = math.prod(sizes[dim] for dim in designs)
    result |= _statuses(source)
    position = str(attrs.get("input", ""))
    if "configurations" in attrs:
        inner = [dim for dim in (BRANCH, position) if dim in sizes]
        result["configurations"] = result["designs"] * math.prod(sizes[dim] for dim in inner)
    if f"{position}_count" in attrs and position in sizes:
        result[f"{position}_count"] = sizes[position]
    return result


def _statuses(source: Source) -> dict[str, int]:
    """Return the numbers of designs with each status."""
    status = next((one for one in source.variables if one.name == STATUS and one.dtype.kind in "iu"), None)
    if status is None:
        return {}
    numbers = Counter[int]()
    for _, _, values in source.blocks(status):
        codes, counts = np.unique(values, return_counts=True)
        numbers.update(dict(zip(codes.tolist(), counts.tolist(), strict=True)))
    meanings = str(status.attrs.get("flag_meanings", "")).split()
    codes = np.atleast_1d(status.attrs.get("flag_values", ()))
    return {
        f"designs_{meaning}": numbers[code] for meaning, code in zip(meanings, codes.tolist(), strict=False)
    }


def _design_dims(maps: xr.Dataset) -> list[str]:
    """Return the dimensions of the design space of a map."""
    if STATUS in maps.variables:
        return list(map(str, maps[STATUS].dims))
    dims = [set(map(str, one.dims)) for one in maps.data_vars.values()]
    return sorted(set.intersection(*dims) if dims else set())


def _round(variable: Variable) -> None:
    """Let the attributes of a variable say what its rounding adds to the errors."""
    info = np.finfo(variable.dtype)
    unit, least = float(info.eps) / 2, float(info.smallest_subnormal) / 2
    for name in OF_DOUBLES:
        variable.attrs.pop(name, None)
    if "error_max_relative" in variable.attrs:
        # (1 + e)(1 + u) - 1, and a bit more than its own rounding
        e = float(variable.attrs["error_max_relative"])
        variable.attrs["error_max_relative"] = float(np.nextafter(e + unit * (1 + e), np.inf))
    variable.attrs["rounding"] = (
        f"float64 rounded to {variable.dtype}: off by at most {unit:.3g} of the value more than before; "
        f"by {least:.1g} below {float(info.smallest_normal):.3g}; infinite beyond {float(info.max):.3g}"
    )


# -- Write a converted map as HDF5 or netCDF-4, which is HDF5: as a sweep does, or compressed


#: Bytes of the values of a chunk, the unit of compression.
CHUNK_BYTES = 1 << 20


class _UntilItFails(io.FileIO):
    """A file for HDF5 to write; an error of the disk is kept for `check`, and what is written after it is dropped.

    HDF5 tries again what it could not write when the file is closed and when the process ends, and may then end it by a
    violation of memory.
    """

    def __init__(self, fd: int) -> None:
        super().__init__(fd, "r+b", closefd=False)
        self._error: OSError | None = None

    def check(self) -> None:
        """Raise the error that there was."""
        if self._error is not None:
            raise self._error

    def write(self, data: Any) -> int:
        """Write every byte, unless an earlier write has failed."""
        position, content = self.tell(), memoryview(data).cast("B")
        self._tried(partial_file.write_all, self.fileno(), content, position)
        self.seek(position + len(content))
        return len(content)

    def truncate(self, size: int | None = None) -> int:
        """Give the file a size, unless an earlier write has failed."""
        nbytes = self.tell() if size is None else size
        self._tried(os.ftruncate, self.fileno(), nbytes)
        return nbytes

    def _tried(self, call: Callable[..., Any], *arguments: Any) -> None:
        if self._error is None:
            try:
                call(*arguments)
            except OSError as error:
                self._error = error


def write_hdf5(path: Path, source: Source, overwrite: bool, compression: Compression | None) -> None:
    """Write a file: with contiguous variables and their checksums, or compressed."""
    if compression is not None:
        _write_compressed(path, source, overwrite, compression)
        return
    with Writer(path, source.coords, source.all, source.attrs, overwrite=overwrite) as writer:
        for variable in source.all:
            for _, first, values in source.blocks(variable):
                writer.write(variable.name, first, values.reshape(-1))
        writer.finish(source.remarks())


def _write_compressed(path: Path, source: Source, overwrite: bool, compression: Compression) -> None:
    """Write a file with compressed chunks, and one checksum of all its bytes."""
    lay = partial(lay_labels, coords=source.coords, attrs=source.attrs)
    with output_file(path, overwrite, lay) as fd:
        target = _UntilItFails(fd)
        with h5py.File(target, "r+") as file:
            filters = compression.of_hdf5()
            for variable in source.all:
                chunks = chunks_of(variable, CHUNK_BYTES)
                how = {"chunks": chunks, "shuffle": True, **filters} if chunks else {}
                dataset = file.create_dataset(variable.name, variable.shape, variable.dtype, **how)
                label(file, dataset, source.coords, variable, source.columns)
                for index, _, values in source.blocks(variable, chunks):
                    dataset[index] = values
                    target.check()
            file.attrs.update({**source.remarks(), FORMAT: FORMAT_VERSION})
            place = create_checksums(file, [])[OF_REST]
            file.flush()
            of_values: list[Any] = []
            for variable in source.all:
                if file[variable.name].chunks:
                    file[variable.name].id.chunk_iter(of_values.append)
        target.check()
        compressed = {int(chunk.byte_offset): int(chunk.size) for chunk in of_values}
        partial_file.write_seal(fd, compressed, place, {})


# -- Write a converted map as a zarr store, version 2 of the format, which most readers know


#: Bytes of the values of a chunk, which is a file.
ZARR_CHUNK_BYTES = 1 << 22
ZARR_FORMAT = 2


def write_zarr(path: Path, source: Source, overwrite: bool, compression: Compression | None) -> None:
    """Write a zarr store, chunk by chunk; without a compression by the library's own."""
    import zarr

    labels = source.coords.assign_attrs(as_json(source.attrs))
    with output_folder(path, overwrite) as folder:
        labels.to_zarr(
            folder,
            mode="a",
            zarr_format=ZARR_FORMAT,
            consolidated=False,
            encoding={name: {"_FillValue": None} for name in labels.coords},
        )
        group = zarr.open_group(str(folder), mode="r+", zarr_format=ZARR_FORMAT)
        for variable in source.all:
            described: dict[str, Any] = {"_ARRAY_DIMENSIONS": list(variable.dims), **as_json(variable.attrs)}
            along = auxiliary(source.coords, variable, source.columns)
            if along and not variable.is_coordinate:
                described["coordinates"] = along
            chunks = chunks_of(variable, ZARR_CHUNK_BYTES)
            array = group.create_array(
                variable.name,
                shape=variable.shape,
                dtype=variable.dtype,
                chunks=chunks or "auto",
                compressors="auto" if compression is None else compression.of_zarr(),
                fill_value=None,
                attributes=described,
            )
            for index, _, values in source.blocks(variable, chunks):
                array[index or ...] = values
        group.attrs.update(as_json({**source.remarks(), FORMAT: FORMAT_VERSION}))
        zarr.consolidate_metadata(str(folder), zarr_format=ZARR_FORMAT)


# -- Write a converted map as a long table, one row per configuration: CSV or Parquet


#: Bytes of a number as text, with the object that holds it, and of one in a column of a table.
TEXT_BYTES, NUMBER_BYTES = 100, 8
#: A function that returns the cells of some values.
Cells = Callable[[NDArray[Any]], NDArray[Any]]
#: Key of the attributes of a map in those of a Parquet file.
METADATA = "fastlink"


def check_table(variables: list[Variable]) -> None:
    """Refuse variables that no table has one row per configuration of."""
    widest = max(variables, key=lambda variable: len(variable.dims))
    for variable in variables:
        if other := [dim for dim in variable.dims if dim not in widest.dims]:
            inside = [dim for dim in widest.dims if dim not in variable.dims]
            along = f"{widest.name} along {', '.join(inside)}"
            what = (
                f"{variable.name} is along {', '.join(other)} but {along}, and a table has one kind of rows"
            )
            raise InputError(
                what, where=("quantities",), remedy="choose those of one kind, such as one of the two"
            )


def _fields(source: Source) -> dict[str, Any]:
    """Return the columns of a table by name: inputs along the dimensions of its rows, constants, then results."""
    dims = _widest(source).dims
    inputs: dict[str, Any] = {str(name): coord for name, coord in source.coords.coords.items()}
    inputs |= {column.name: column for column in source.columns}
    order = [*dims, *(name for name in inputs if name not in dims)]
    inside = [name for name in order if name in inputs and set(inputs[name].dims) <= set(dims)]
    inside.sort(key=lambda name: not inputs[name].dims)
    return {name: inputs[name] for name in inside} | {one.name: one for one in source.variables}


def _widest(source: Source) -> Variable:
    """Return the variable that has a value in each row."""
    return max(source.variables, key=lambda variable: len(variable.dims))


def _rows(source: Source, cell_bytes: int, cells: Cells) -> Iterator[list[NDArray[Any]]]:
    """Yield the cells of each column in a block of rows, those of values that many rows share made once."""
    fields, widest = _fields(source).values(), _widest(source)
    most = max(1, BLOCK_BYTES // (cell_bytes * len(fields)))
    of_rows = max(math.prod(one.shape) for one in source.variables)
    for index, _ in pieces(widest.shape, most):
        box = {dim: slice(0, size) for dim, size in zip(widest.dims, widest.shape, strict=True)}
        for dim, part in zip(widest.dims, index, strict=False):
            box[dim] = slice(part, part + 1) if isinstance(part, int) else part
        sizes = {dim: part.stop - part.start for dim, part in box.items()}
        columns = list[NDArray[Any]]()
        for one in fields:
            if isinstance(one, Variable):
                values = source.read(one, tuple(box[dim] for dim in one.dims))
            else:
                values = one.variable.isel({dim: box[dim] for dim in one.dims}).values
            columns.append(_spread(cells(values), one.dims, sizes))
        yield columns
        source.show(source.nbytes * math.prod(sizes.values()) // of_rows)


def _spread(values: NDArray[Any], dims: tuple[Any, ...], sizes: Mapping[Any, int]) -> NDArray[Any]:
    """Return values along some dimensions for each row, flat."""
    ordered = np.transpose(values, [dims.index(dim) for dim in sizes if dim in dims])
    places = tuple(slice(None) if dim in dims else None for dim in sizes)
    return np.broadcast_to(ordered[places], tuple(sizes.values())).ravel()


@contextlib.contextmanager
def _table_file(path: Path, overwrite: bool) -> Iterator[BinaryIO]:
    """Yield a new file to write a table to."""
    with output_file(path, overwrite) as fd, os.fdopen(os.dup(fd), "wb") as file:
        yield file


def write_csv(path: Path, source: Source, overwrite: bool, compression: Compression | None) -> None:
    """Write a CSV file; its numbers are read back with the same bits."""
    with _table_file(path, overwrite) as file:
        file.write((",".join(map(_quoted, _fields(source))) + "\n").encode())
        for columns in _rows(source, TEXT_BYTES, _texts):
            rows = zip(*(column.tolist() for column in columns), strict=True)
            file.write(("\n".join(map(",".join, rows)) + "\n").encode())


def write_parquet(path: Path, source: Source, overwrite: bool, compression: Compression | None) -> None:
    """Write a Parquet file, a row group for each block; without a compression by the library's own."""
    import pyarrow as pa
    from pyarrow import parquet

    fields = [
        pa.field(name, _arrow(pa, one.dtype), metadata=_as_texts(one.attrs))
        for name, one in _fields(source).items()
    ]
    schema = pa.schema(fields, metadata={METADATA: json.dumps(as_json(source.attrs))})
    options: dict[str, Any] = {}
    if compression is not None:
        options = {"compression": compression.name, "compression_level": compression.level}
    with _table_file(path, overwrite) as file, parquet.ParquetWriter(file, schema, **options) as writer:
        for columns in _rows(source, NUMBER_BYTES, np.asarray):
            arrays = [pa.array(column, field.type) for column, field in zip(columns, schema, strict=True)]
            writer.write_batch(pa.record_batch(arrays, schema=schema), row_group_size=len(arrays[0]))


def write_xlsx(path: Path, source: Source, overwrite: bool, compression: Compression | None) -> None:
    """Write an Excel workbook: a sheet of the rows, to 16 digits, and one that says what each column is."""
    import openpyxl

    fields, book = _fields(source), openpyxl.Workbook(write_only=True)
    sheet, about = book.create_sheet("designs"), book.create_sheet("columns")
    sheet.freeze_panes = "A2"
    with _table_file(path, overwrite) as file:
        sheet.append(list(fields))
        try:
            for columns in _rows(source, TEXT_BYTES, np.asarray):
                for row in zip(*(map(_cell, column.tolist()) for column in columns), strict=True):
                    sheet.append(row)
        except BaseException:
            sheet.close()  # its text waits in a file of its own
            raise
        about.append(["column", "units", "meaning"])
        for name, one in fields.items():
            about.append([name, *(_cell(str(one.attrs.get(key, ""))) for key in ("units", "long_name"))])
        for name, value in _as_texts(source.attrs).items():
            about.append([name, "", _cell(value)])
        book.save(file)


def _cell(value: Any) -> Any:
    """Return a value as Excel has it: nothing in place of NaN, infinity and signs without a picture as text."""
    if isinstance(value, str):
        return value if value.isprintable() else ascii(value)[1:-1]
    if not isinstance(value, float) or math.isfinite(value):
        return value
    return None if math.isnan(value) else repr(value)


def _texts(values: NDArray[Any]) -> NDArray[Any]:
    """Return numbers as the shortest texts that are read back as the same numbers."""
    flat = values.ravel()
    if values.dtype.kind == "f" and values.dtype.itemsize < 8:
        texts = [str(number) for number in flat]
    elif values.dtype.kind in "iuf":
        texts = list(map(repr, flat.tolist()))
    else:
        texts = [_quoted(str(text)) for text in flat.tolist()]
    result = np.empty(flat.size, dtype=object)
    result[:] = texts
    return result.reshape(values.shape)


def _quoted(text: str) -> str:
    """Return a text as a cell."""
    line = io.StringIO()
    csv.writer(line, lineterminator="").writerow([text])
    return line.getvalue()


def _arrow(pa: Any, dtype: np.dtype[Any]) -> Any:
    return pa.from_numpy_dtype(dtype) if dtype.kind in "iuf" else pa.string()


def _as_texts(attrs: Mapping[str, Any]) -> dict[str, str]:
    """Return attributes as texts, those that are none as JSON."""
    return {
        name: value if isinstance(value, str) else json.dumps(value) for name, value in as_json(attrs).items()
    }


# -- Convert a finished map to another format, compressed, in part, or with fewer digits


#: The format of a file by the ending of its name.
FORMATS = {
    ".h5": "hdf5",
    ".hdf5": "hdf5",
    ".nc": "hdf5",
    ".nc4": "hdf5",
    ".zarr": "zarr",
    ".csv": "csv",
    ".parquet": "parquet",
    ".xlsx": "xlsx",
}
#: Packages that write a format; forms of tables, and the rows of a sheet of Excel below its head.
NEEDS = {"zarr": "zarr", "parquet": "pyarrow", "xlsx": "openpyxl"}
TABLES, MOST_ROWS = ("csv", "parquet", "xlsx"), 2**20 - 1
TYPES = ("float32", "float64")


@door
def convert(
    maps: Any,
    to: str | os.PathLike[str],
    *,
    select: Mapping[str, Any] | None = None,
    quantities: Sequence[str] | None = None,
    dtype: str | None = None,
    compress: str | None = None,
    overwrite: bool = False,
    progress: bool | None = None,
) -> Path:
    """Convert a map to another format, compressed, in part, or with fewer digits.

    It is read and written in blocks of 16 MiB, so that the map may be larger than memory. Labels, units and attributes
    come along; what the attributes say is true of the result, and ``history`` says how it was made.

    Parameters
    ----------
    maps : path or xarray.Dataset
        The file of a map, or the result of `fastlink.sweep` or `fastlink.open`.
    to : path
        What to write, by its ending: ``.h5`` or ``.nc`` (HDF5, which is netCDF-4), ``.zarr``, ``.csv``,
        ``.parquet`` or ``.xlsx`` (Excel). The last three have one row per configuration, with all inputs as columns.
    select : mapping, optional
        What to take, by the names of dimensions and inputs: ``"1.1:1.2"`` or ``(1.1, 1.2)`` a range with both ends,
        ``0.5`` the nearest value, ``"#3"`` and ``"#0:10"`` numbers of values as Python counts. Other units by names
        that end in them, ``theta1_deg``.
    quantities : sequence of str, optional
        The variables to take, and ``status``; all unless given.
    dtype : {"float32", "float64"}, optional
        The type of floating-point results; inputs keep theirs, integers and codes too. Error bounds are rounded up.
    compress : str, optional
        ``"gzip"``, ``"zstd"`` or ``"blosc"``, with a level as in ``"zstd:3"``, or ``"lz4"``.
    overwrite : bool, default False
        Replace an existing file.
    progress : bool, optional
        Show a progress bar; by default on a terminal only.

    Returns
    -------
    pathlib.Path
        What was written.

    Raises
    ------
    InputError
        An option is wrong, nothing is selected, a package is missing, or there is no room.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import fastlink as fl
    >>> space = fl.grid(a1=0.4, a2=[1.1, 1.2, 1.3], a3=0.8, a4=1.0)
    >>> maps = fl.sweep("planar_4r", space, ["transmission_angle_min"], branch=1)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = fl.convert(maps, pathlib.Path(folder, "part.nc"), select={"a2": "1.1:1.2"}, dtype="float32")
    ...     with fl.open(path) as part:
    ...         dict(part.sizes), str(part.transmission_angle_min.dtype), part.selection
    ({'a2': 2}, 'float32', 'a2=1.1:1.2')
    """
    problems = Problems()
    form = problems.attempt(_format, to)
    compression = problems.attempt(check_compression, compress, form) if form else None
    kind = problems.attempt(_dtype, dtype)
    problems.attempt(check_switch, ("overwrite",), overwrite)
    if progress is not None:
        problems.attempt(check_switch, ("progress",), progress)
    with as_map(maps) as dataset:
        _check_texts(dataset, form, problems)
        names = problems.attempt(_quantities, dataset, quantities)
        selection = problems.attempt(selected, dataset, select)
        problems.stop()
        source = Source(dataset, selection, names, kind)
        path = _target(to, form, dataset, 0 if compression or form != "hdf5" else source.nbytes, overwrite)
        command = _command(dataset, to, selection, quantities, dtype, compression)
        source.attrs = labelled(dataset, source, selection, command)
        if compression is not None:
            source.attrs[COMPRESSION] = str(compression)
        if form in TABLES:
            check_table(source.variables)
        if form == "xlsx" and (rows := math.prod(_widest(source).shape)) > MOST_ROWS:
            what = f"the map has {rows:,} rows, and a sheet of Excel {MOST_ROWS:,}"
            raise InputError(what, ("to",), "write a .csv or a .parquet, or select a part")
        bar = progress_bar(source.nbytes, "B", progress)
        with contextlib.nullcontext() if bar is None else bar:
            if bar is not None:
                source.show = bar.update
            WRITERS[form](path, source, overwrite, compression)
    if source.overflows:
        what = f"values that are infinite in {kind}: {', '.join(f'{n:,} of {k}' for k, n in source.overflows.items())}"
        remark(what, ("dtype",), "keep float64 if they matter")
    return path


WRITERS = {
    "hdf5": write_hdf5,
    "zarr": write_zarr,
    "csv": write_csv,
    "parquet": write_parquet,
    "xlsx": write_xlsx,
}


def _format(to: Any) -> str:
    """Return the format of the result by the ending of its name, or refuse it."""
    path = check_path(("to",), to, "out.nc")
    form = FORMATS.get(path.suffix.lower())
    if form is None:
        ends = f"ends in {path.suffix!r}, which names no format" if path.suffix else "has no ending"
        what = f"{short_repr(os.fspath(path))} {ends}"
        raise InputError(what, where=("to",), remedy=f"write one of {', '.join(FORMATS)}")
    if form in NEEDS:
        require_package(NEEDS[form], ("to",))
    return form


def _dtype(dtype: Any) -> np.dtype[Any] | None:
    """Return the type of the numbers of the result, None where they keep theirs."""
    if dtype is None:
        return None
    name = ""
    if isinstance(dtype, (str, np.dtype)) or (isinstance(dtype, type) and issubclass(dtype, np.generic)):
        with contextlib.suppress(TypeError, ValueError, SyntaxError):
            name = np.dtype(dtype).name
    if name not in TYPES:
        what = f"is {short_repr(dtype)}"
        if name.startswith(("int", "uint", "bool")):
            what += ", which holds no fractions; codes and counts keep their integers anyway"
        raise InputError(what, where=("dtype",), remedy=f"write one of {', '.join(TYPES)}")
    kind: np.dtype[Any] = np.dtype(name)
    return kind


def _quantities(maps: xr.Dataset, quantities: Any) -> list[str]:
    """Return the variables to take, in the order of the map; `status` is always among them."""
    known = [str(name) for name in maps.data_vars]
    if quantities is None:
        return known
    where: KeyPath = ("quantities",)
    if isinstance(quantities, np.ndarray) and quantities.ndim == 1:
        quantities = quantities.tolist()
    if isinstance(quantities, str) or not isinstance(quantities, (Sequence, set, frozenset)):
        raise InputError(f"is {short_repr(quantities)}", where=where, remedy="write a list of names")
    if not quantities:
        raise InputError("is empty", where=where, remedy="leave it out for all variables")
    problems = Problems()
    for k, name in enumerate(given := list(quantities)):
        if not isinstance(name, str) or name not in known:
            problems.add(f"{short_repr(name)} is not in the map", where, suggest(name, known))
        elif name in given[:k]:
            problems.add(f"{name} is named twice", where, "write it once")
    problems.stop()
    return [name for name in known if name in quantities or name == STATUS]


def _check_texts(maps: xr.Dataset, form: str, problems: Problems) -> None:
    """Note names, attributes and labels that no file can hold; HDF5 reads bytes that are no letters as such."""
    of_all = {"": maps.attrs, **{str(name): one.attrs for name, one in maps.variables.items()}}
    attrs = {(name, str(key)): value for name, one in of_all.items() for key, value in one.items()}
    for (name, key), value in attrs.items():
        if not isinstance(value, str) and (fault := fault_of_value(value)):
            of = f" of {name}" if name else ""
            problems.add(f"the attribute {key!r}{of} {fault}", ("maps",), f"{PLAIN}, or remove it")
    texts = [(repr(str(name)), str(name)) for name in maps.variables]
    for (name, key), value in () if form == "csv" else attrs.items():  # CSV holds none
        texts.append((f"the name of {key!r}", key))
        if isinstance(value, str):
            texts.append((f"{name}: {key}" if name else key, value))
    for dim, one in maps.coords.items():
        if one.dtype.kind in "OU":
            texts += [(str(dim), label) for label in map(str, one.values.flat)]
    for what, text in texts:
        if sign := unwritable(text):
            remedy = "open it by fastlink.open, write letters alone there, and convert that"
            problems.add(f"{what} holds {sign!r}, which no file can hold", ("maps",), remedy)


def check_conversion(maps: xr.Dataset, to: Any, overwrite: bool) -> None:
    """Refuse a result that could not be written, before what it holds is computed from a map."""
    _target(to, _format(to), maps, 0, overwrite)


def _target(to: Any, form: str, maps: xr.Dataset, nbytes: int, overwrite: bool) -> Path:
    """Return the path of the result, or refuse it."""
    sources = files_of(maps)
    if form == "zarr":
        return _folder(to, sources, overwrite)
    named = partial(check_path, example="out.nc")
    return check_target(to, nbytes, overwrite, sources, named, at_once=True)


def _folder(to: Any, sources: Sequence[Path], overwrite: bool) -> Path:
    """Return the path of a folder to write, or refuse it: only a zarr store is ever replaced."""
    path = Path(os.path.realpath(check_path(("to",), to, "out.zarr")))
    if not path.parent.is_dir():
        raise refused(f"{path}: there is no folder {path.parent}", "create it or choose another")
    if path.exists():
        if not overwrite:
            raise exists_error(path)
        if not (path.is_dir() and is_zarr(path)):
            raise refused(f"{path} is no zarr store", "choose another name")
        if any(path.samefile(source) for source in sources):
            raise refused(f"{path} is read for it", "choose another name")
    part = part_of(path)
    if os.path.lexists(part) and not part.is_dir():
        raise refused(f"{part} is in the way", "remove it or choose another name")
    return path


def _command(
    maps: xr.Dataset,
    to: Any,
    selection: Selection,
    quantities: Sequence[str] | None,
    dtype: Any,
    compression: Compression | None,
) -> str:
    """Return the command line that makes the result."""
    source = maps.encoding.get("source")
    words = ["convert", os.path.basename(str(source)) if source else "a map in memory", "--to", Path(to).name]
    for text in selection.texts:
        words += ["--select", text]
    if quantities is not None:
        words += ["--quantities", ",".join(quantities)]
    if dtype is not None:
        words += ["--dtype", np.dtype(dtype).name]
    if compression is not None:
        words += ["--compress", str(compression)]
    return shlex.join(words)
