"""Lay out a map file: coordinates by xarray, contiguous variables by h5py."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import h5py
import numpy as np
import xarray as xr

from fastlink.io.checksums import (
    ALGORITHM,
    BLOCK_BYTES,
    CHECKSUMS,
    OF_REST,
    OF_VALUES,
    all_but,
    block_count,
)
from fastlink.io.dataset import Variable, plain_attrs
from fastlink.io.parts import LABELS, NAMES, WHOLE, Shown, Source, as_source
from fastlink.io.place import SLACK
from fastlink.io.writing.partial_file import create, released, reserve, write_all

PAGE_BYTES = 4096
#: What a file that cannot be read or written raises, through HDF5 too.
OF_HDF5 = (OSError, EOFError, RuntimeError, KeyError)
ALIGNED = {"alignment_threshold": PAGE_BYTES, "alignment_interval": PAGE_BYTES}
#: The driver of HDF5 that opens a file without a name; the usual one asks for the name behind a link.
NAMELESS: Any = {"driver": "stdio"}


def lay_out(
    path: Path,
    coords: xr.Dataset,
    variables: Sequence[Variable],
    attrs: Mapping[str, Any],
    whole: xr.Dataset | None = None,
    shown: Shown | None = None,
) -> dict[str, int]:
    """Write labels to a file that exists, and reserve room for values; return the variables' offsets.

    `whole` are coordinates of the map that the file is a part of, `shown` the variables whose values stay in parts.
    """
    shown = shown or Shown({}, {})
    labels = coords.nbytes + (0 if whole is None else whole.nbytes) + shown.nbytes + SLACK
    with open(path, "r+b") as file:  # where HDF5 had no room it might crash the process, or not say why
        reserve(file.fileno(), labels)
        stored = [variable for variable in variables if variable.name not in shown.sources]
        file.truncate(labels + sum(variable.nbytes for variable in stored))
    labelled = coords.assign_attrs(plain_attrs(attrs))
    computed = [variable for variable in variables if variable.is_coordinate]
    computed.sort(key=lambda variable: variable.dims != (variable.name,))  # the dimension of the others first
    scales = [variable.name for variable in computed if variable.dims == (variable.name,)]
    along = [name for name, coord in coords.coords.items() if set(scales) & set(coord.dims)]
    _to_netcdf(path, labelled.drop_vars(along), "w")
    with h5py.File(path, "r+", **ALIGNED, **NAMELESS) as file:
        offsets = {variable.name: _create(file, coords, variable, [], shown) for variable in computed}
    if along:
        _to_netcdf(path, coords[along].reset_coords()[along].drop_attrs(deep=False), "a")
    with h5py.File(path, "r+", **ALIGNED, **NAMELESS) as file:
        if whole is not None:
            _keep_whole(file, whole)
        _keep_names(file, shown)
        offsets |= create_checksums(file, stored)
        results = [variable for variable in variables if not variable.is_coordinate]
        return offsets | {
            variable.name: _create(file, coords, variable, computed, shown) for variable in results
        }


def lay_labels(path: Path, coords: xr.Dataset, attrs: Mapping[str, Any]) -> None:
    """Create the file with its coordinates and global attributes alone."""
    with scratch() as other:
        with open(other, "r+b") as file:
            reserve(file.fileno(), coords.nbytes + SLACK)
        _to_netcdf(other, coords.assign_attrs(plain_attrs(attrs)), "w")
        _copy_to_new(other, path, {})


def as_bytes(dataset: xr.Dataset) -> bytes:
    """Return the HDF5 file of a small dataset, made in memory."""
    with scratch() as file:
        _to_netcdf(file, dataset, "w")
        return file.read_bytes()


def create_checksums(file: Any, variables: Sequence[Variable]) -> dict[str, int]:
    """Create the checksums of the values of some variables, and of all else; return their offsets."""
    group = file.create_group(CHECKSUMS)
    about = {"algorithm": ALGORITHM, "block_bytes": BLOCK_BYTES}
    for name, value in plain_attrs(about | {"variables": " ".join(v.name for v in variables)}).items():
        group.attrs[name] = value
    sizes = {OF_VALUES: sum(block_count(variable.nbytes) for variable in variables), OF_REST: 1}
    offsets = {
        name: _reserved(group, name.partition("/")[2], (n,), "u4")[1] for name, n in sizes.items() if n
    }
    if OF_VALUES not in offsets:
        file.create_dataset(OF_VALUES, (0,), "u4")
    return offsets


def _keep_whole(file: Any, whole: xr.Dataset) -> None:
    """Keep coordinates of a whole map in a group.

    They are plain arrays: the netCDF library would take their dimensions for those of the same name outside.
    """
    group = file.create_group(WHOLE)
    group.attrs.update(plain_attrs(whole.attrs))
    for name, coord in whole.coords.items():
        values = coord.values.astype(object) if coord.dtype.kind == "U" else coord.values
        group.create_dataset(name, data=values, track_times=False).attrs.update(plain_attrs(coord.attrs))


def _keep_names(file: Any, shown: Shown) -> None:
    """Keep the names of the parts whose values a map shows, and the checksums of their labels."""
    if shown.files:
        names = np.array([os.fsencode(name) for name in shown.files])
        file.create_dataset(NAMES, data=names, track_times=False)
        file.create_dataset(LABELS, data=np.array(list(shown.files.values()), "u4"), track_times=False)


def _to_netcdf(path: Path, coords: xr.Dataset, mode: Literal["w", "a"]) -> None:
    """Write coordinates to a file, or to one that has others."""
    # without _FillValue: None xarray declares NaN a fill value of every coordinate
    encoding = {name: {"_FillValue": None} for name in coords.variables}
    store = xr.backends.H5NetCDFStore.open(str(path), mode, **NAMELESS)
    try:
        coords.dump_to_store(store, encoding=encoding)
    finally:
        store.close()


@contextlib.contextmanager
def scratch() -> Iterator[Path]:
    """Yield the path of an empty file for HDF5 to write: in memory and without a name, where the system has such files.

    An error of the disk amid HDF5's own writes may end the process by a violation of memory; amid ours, which copy the
    file to its place, it is an exception. A file without a name is gone with the process, however that ends.
    """
    if hasattr(os, "memfd_create"):
        fd = os.memfd_create("fastlink.h5")
        try:
            path = Path(f"/proc/self/fd/{fd}")
            if path.exists():
                yield path
                return
        finally:
            os.close(fd)
    fd, name = tempfile.mkstemp(".h5", "fastlink-")
    os.close(fd)
    try:
        yield Path(name)
    finally:
        os.unlink(name)


def laid_in_memory(
    path: Path, lay_out: Callable[[Path], dict[str, int]], variables: Sequence[Variable]
) -> dict[str, int]:
    """Create the file that `lay_out` lays out, by way of memory; return the variables' offsets."""
    with scratch() as other:
        offsets = lay_out(other)
        _copy_to_new(other, path, places_of_values(offsets, variables))
    return offsets


def _copy_to_new(source: Path, path: Path, values: Mapping[int, int]) -> None:
    with os.fdopen(create(path), "r+b", buffering=0) as file:
        copy_labels(source, file.fileno(), values)


def places_of_values(offsets: Mapping[str, int], variables: Sequence[Variable]) -> dict[int, int]:
    """Return the bytes of all values, by where they begin."""
    return {offsets[variable.name]: variable.nbytes for variable in variables}


def copy_labels(path: Path, fd: int, values: Mapping[int, int]) -> None:
    """Give an open file all bytes of another besides values, which are so many from somewhere, and its length."""
    with open(path, "rb") as file:
        _copy(file.fileno(), fd, values)


def _copy(source: int, target: int, values: Mapping[int, int]) -> None:
    for position, labels in all_but(source, values):
        write_all(target, memoryview(labels), position)
    os.ftruncate(target, os.fstat(source).st_size)


def _create(
    file: Any, coords: xr.Dataset, variable: Variable, computed: Sequence[Variable], shown: Shown
) -> int:
    """Create one dataset with its labels, contiguous with its space unless it is shown; return its offset."""
    plist = _of_sources(variable, shown.sources[variable.name]) if variable.name in shown.sources else None
    dataset, offset = _reserved(file, variable.name, variable.shape, variable.dtype, plist)
    if variable.dims == (variable.name,):
        dataset.make_scale(variable.name)
    label(file, dataset, coords, variable, computed)
    return offset


def _of_sources(variable: Variable, sources: Sequence[Source]) -> Any:
    """Return the properties of a dataset whose values are those of datasets of the same name in other files.

    Other readers see NaN, or the least or greatest integer, where a file is missing.
    """
    plist = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    whole = None if variable.dtype.kind == "f" else np.iinfo(variable.dtype)
    plist.set_fill_value(np.array(whole.min or whole.max if whole else np.nan, variable.dtype))
    for name, shape, box, own in sources:
        spaces = []
        for lengths, (starts, steps, counts) in ((variable.shape, box), (shape, own)):
            spaces.append(h5py.h5s.create_simple(lengths))
            spaces[-1].select_hyperslab(starts, counts, steps)
        plist.set_virtual(spaces[0], os.fsencode(as_source(name)), variable.name.encode(), spaces[1])
    return plist


def label(
    file: Any, dataset: Any, coords: xr.Dataset, variable: Variable, computed: Sequence[Variable] = ()
) -> None:
    """Give a dataset its dimensions, its attributes, and the names of further coordinates."""
    for axis, dim in enumerate(variable.dims):
        # unless attached, dimensions are matched by length and equal axes are swapped
        if dim != variable.name:
            dataset.dims[axis].attach_scale(file[dim])
    for name, value in plain_attrs(variable.attrs).items():
        dataset.attrs[name] = value
    along = auxiliary(coords, variable, computed)
    if along and not variable.is_coordinate:
        dataset.attrs["coordinates"] = along


def auxiliary(coords: xr.Dataset, variable: Variable, computed: Sequence[Variable] = ()) -> str:
    """Return the names of the coordinates of a variable that are no axes of it, as CF lists them."""
    along = {str(name): coord.dims for name, coord in coords.coords.items()}
    along |= {one.name: one.dims for one in computed}
    return " ".join(
        name for name, dims in along.items() if name not in variable.dims and set(dims) <= set(variable.dims)
    )


def _reserved(
    group: Any, name: str, shape: tuple[int, ...], dtype: Any, virtual: Any = None
) -> tuple[Any, int]:
    """Create one contiguous dataset with its space; return it and its offset, -1 of one that is virtual."""
    plist = virtual or h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    if not virtual:
        plist.set_layout(h5py.h5d.CONTIGUOUS)
        plist.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
        plist.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    plist.set_obj_track_times(False)  # time stamps would make equal results differ
    # low level: Group.create_dataset drops the property list of a scalar
    identifier = h5py.h5d.create(
        group.id,
        name.encode(),
        h5py.h5t.py_create(np.dtype(dtype), logical=True),
        h5py.h5s.create_simple(shape) if shape else h5py.h5s.create(h5py.h5s.SCALAR),
        plist,
    )
    offset = -1 if virtual else identifier.get_offset()
    if offset is None:
        raise RuntimeError(f"HDF5 has reserved no space for {name}")
    return h5py.Dataset(identifier), int(offset)


def set_attrs(
    fd: int,
    values: Mapping[int, int],
    attrs: Mapping[str, Any],
    of_variables: Mapping[str, Mapping[str, Any]],
) -> None:
    """Add attributes, global and of variables, to an open file whose values are so many bytes from somewhere."""
    with scratch() as path:
        with open(path, "r+b") as file:
            _copy(fd, file.fileno(), values)
        with h5py.File(path, "r+", **NAMELESS) as file:
            for group, added in (("/", attrs), *of_variables.items()):
                for name, value in added.items():
                    file[group].attrs[name] = value
        copy_labels(path, fd, values)


def check_readable(fd: int, path: Path, variables: Sequence[Variable], offsets: Mapping[str, int]) -> None:
    """Fail unless a file that is locked by `fd` can be opened, and its variables are where they were laid."""
    with opened(fd, path, "r") as file:
        for variable in variables:
            found = file[variable.name]
            dims = tuple(str(scale[0].name).removeprefix("/") for scale in found.dims if len(scale))
            dims = dims or (variable.name,) * len(found.shape)  # a dimension itself
            layout = found.shape, found.dtype, dims, found.id.get_offset()
            if layout != (variable.shape, variable.dtype, variable.dims, offsets[variable.name]):
                raise RuntimeError(f"{variable.name} is not where it was laid out")


@contextlib.contextmanager
def opened(fd: int, path: Path, mode: str) -> Iterator[Any]:
    """Open a file that is locked by `fd` by HDF5."""
    with contextlib.ExitStack() as stack:
        try:
            # this process holds the lock that HDF5 would ask for
            file = stack.enter_context(h5py.File(path, mode, locking=False))
        except BlockingIOError:  # HDF5_USE_FILE_LOCKING=TRUE in the environment overrules locking=False
            stack.enter_context(released(fd))
            file = stack.enter_context(h5py.File(path, mode))
        yield file
