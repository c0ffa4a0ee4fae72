"""Lay out a map file: coordinates by xarray, contiguous variables by h5py."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator, Mapping, Sequence
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
from fastlink.io.parts import WHOLE
from fastlink.io.place import SLACK
from fastlink.io.writing.partial_file import make_sure_of_room, released, write_all

PAGE_BYTES = 4096
ALIGNED = {"alignment_threshold": PAGE_BYTES, "alignment_interval": PAGE_BYTES}


def lay_out(
    path: Path,
    coords: xr.Dataset,
    variables: Sequence[Variable],
    attrs: Mapping[str, Any],
    whole: xr.Dataset | None = None,
) -> dict[str, int]:
    """Create the file with labels, without values; return the variables' offsets.

    `whole` are coordinates of the map that the file is a part of.
    """
    make_sure_of_room(path, coords.nbytes + (0 if whole is None else whole.nbytes) + SLACK)
    labelled = coords.assign_attrs(plain_attrs(attrs))
    computed = [variable for variable in variables if variable.is_coordinate]
    computed.sort(key=lambda variable: variable.dims != (variable.name,))  # the dimension of the others first
    scales = [variable.name for variable in computed if variable.dims == (variable.name,)]
    along = [name for name, coord in coords.coords.items() if set(scales) & set(coord.dims)]
    _to_netcdf(path, labelled.drop_vars(along), "w")
    with h5py.File(path, "r+", **ALIGNED) as file:
        offsets = {variable.name: _create(file, coords, variable, []) for variable in computed}
    if along:
        _to_netcdf(path, coords[along].reset_coords()[along].drop_attrs(deep=False), "a")
    with h5py.File(path, "r+", **ALIGNED) as file:
        if whole is not None:
            _keep_whole(file, whole)
        offsets |= create_checksums(file, variables)
        results = [variable for variable in variables if not variable.is_coordinate]
        return offsets | {variable.name: _create(file, coords, variable, computed) for variable in results}


def lay_labels(path: Path, coords: xr.Dataset, attrs: Mapping[str, Any]) -> None:
    """Create the file with its coordinates and global attributes alone."""
    make_sure_of_room(path, coords.nbytes + SLACK)
    _to_netcdf(path, coords.assign_attrs(plain_attrs(attrs)), "w")


def create_checksums(file: Any, variables: Sequence[Variable]) -> dict[str, int]:
    """Create the checksums of the values of some variables, and of all else; return their offsets."""
    group = file.create_group(CHECKSUMS)
    about = {"algorithm": ALGORITHM, "block_bytes": BLOCK_BYTES}
    for name, value in plain_attrs(about | {"variables": " ".join(v.name for v in variables)}).items():
        group.attrs[name] = value
    sizes = {OF_VALUES: sum(block_count(variable.nbytes) for variable in variables), OF_REST: 1}
    return {name: _reserved(group, name.partition("/")[2], (n,), "u4")[1] for name, n in sizes.items() if n}


def _keep_whole(file: Any, whole: xr.Dataset) -> None:
    """Keep coordinates of a whole map in a group.

    They are plain arrays: the netCDF library would take their dimensions for those of the same name outside.
    """
    group = file.create_group(WHOLE)
    group.attrs.update(plain_attrs(whole.attrs))
    for name, coord in whole.coords.items():
        values = coord.values.astype(object) if coord.dtype.kind == "U" else coord.values
        group.create_dataset(name, data=values, track_times=False).attrs.update(plain_attrs(coord.attrs))


def _to_netcdf(path: Path, coords: xr.Dataset, mode: Literal["w", "a"]) -> None:
    """Write coordinates to a file, or to one that has others."""
    # without _FillValue: None xarray declares NaN a fill value of every coordinate
    encoding = {name: {"_FillValue": None} for name in coords.variables}
    coords.to_netcdf(path, mode=mode, engine="h5netcdf", encoding=encoding)


def lay_labels_again(fresh: Path, fd: int, offsets: Mapping[str, int], variables: Sequence[Variable]) -> None:
    """Give a partial file the labels of one that was just laid out: its own may be torn or changed."""
    values = {offsets[variable.name]: variable.nbytes for variable in variables}
    with open(fresh, "rb") as file:
        for position, labels in all_but(file.fileno(), values):
            write_all(fd, memoryview(labels), position)
        os.ftruncate(fd, os.fstat(file.fileno()).st_size)


def _create(file: Any, coords: xr.Dataset, variable: Variable, computed: Sequence[Variable]) -> int:
    """Create one contiguous dataset with its space and labels; return its offset."""
    dataset, offset = _reserved(file, variable.name, variable.shape, variable.dtype)
    if variable.dims == (variable.name,):
        dataset.make_scale(variable.name)
    label(file, dataset, coords, variable, computed)
    return offset


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


def _reserved(group: Any, name: str, shape: tuple[int, ...], dtype: Any) -> tuple[Any, int]:
    """Create one contiguous dataset with its space; return it and its offset."""
    plist = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
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
    offset = identifier.get_offset()
    if offset is None:
        raise RuntimeError(f"HDF5 has reserved no space for {name}")
    return h5py.Dataset(identifier), int(offset)


def set_attrs(
    fd: int, path: Path, attrs: Mapping[str, Any], of_variables: Mapping[str, Mapping[str, Any]]
) -> None:
    """Add attributes, global and of variables, to a file that is locked by `fd`."""
    with opened(fd, path, "r+") as file:
        for group, added in (("/", attrs), *of_variables.items()):
            for name, value in added.items():
                file[group].attrs[name] = value


def check_readable(fd: int, path: Path, variables: Sequence[Variable], offsets: Mapping[str, int]) -> None:
    """Fail unless a file that is locked by `fd` can be opened, and its variables are where they were laid."""
    with opened(fd, path, "r") as file:
        for variable in variables:
            found = file[variable.name]
            dims = tuple(scale[0].name.removeprefix("/") for scale in found.dims if len(scale))
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
