"""Open finished maps, lazily, and refuse other files."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from importlib.util import find_spec
from inspect import signature
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from fastlink._text import short_repr
from fastlink.doors import door
from fastlink.errors import InputError, KeyPath, suggest
from fastlink.io.checksums import SIGNATURE, seal_is_broken
from fastlink.io.dataset import FORMAT_VERSION
from fastlink.io.place import part_of, reason
from fastlink.options import check_path, not_a_file
from fastlink.space.dataset import FORMAT

__all__ = [
    "COMPRESSION",
    "as_dataset",
    "as_map",
    "check_seal",
    "is_hdf5",
    "is_zarr",
    "open_map",
    "register_filter",
    "require_package",
]

#: Options of xarray that are decided here.
DECIDED = ("filename_or_obj", "engine", "chunks", "kwargs")
GIVE_A_MAP = "give the result of a sweep, or the path of its file"
INSTALL_DASK = "python -m pip install dask"

#: Global attribute of a compressed file: what it is compressed by; what every HDF5 can read.
COMPRESSION, BUILT_IN = "compression", "gzip"
INSTALL_CONVERT = "python -m pip install 'fastlink-linkages[convert]'"
#: Any of these files tells that a folder is a zarr store.
OF_ZARR = (".zgroup", ".zmetadata", "zarr.json")


def is_hdf5(path: Path) -> bool:
    """Tell whether a file begins as HDF5 does."""
    with path.open("rb") as file:
        return file.read(len(SIGNATURE)) == SIGNATURE


def is_zarr(path: Path) -> bool:
    """Tell whether a folder is a zarr store."""
    return any(os.path.isfile(path / name) for name in OF_ZARR)


def require_package(module: str, where: KeyPath) -> None:
    """Refuse what needs a package of conversions that is not installed."""
    if find_spec(module) is None:
        raise InputError(f"{module} is not installed", where=where, remedy=INSTALL_CONVERT)


def register_filter(name: str) -> None:
    """Let HDF5 use the filter of hdf5plugin, not another package's, such as netCDF4's, which may not fit."""
    import hdf5plugin

    with contextlib.suppress(ValueError):  # of another name, which will be missed when values are read
        hdf5plugin.register(name, force=True)


@door(name="open")
def open_map(path: str | os.PathLike[str], *, chunks: Any = None, **options: Any) -> xr.Dataset:
    """Open a map that a sweep or a conversion has written; values are read when they are used.

    Parameters
    ----------
    path : str or path
        The file: HDF5, netCDF-4 or zarr.
    chunks : int, dict or "auto", optional
        Split variables into chunks of dask, as `xarray.open_dataset` does: ``{}`` as the file is, ``{"a1": 100}``,
        ``"auto"``. Needs dask.
    **options
        Further options of `xarray.open_dataset`, such as ``cache=False`` or ``drop_variables=["theta4"]``.

    Returns
    -------
    xarray.Dataset
        Close it, or use it in a ``with`` statement, before deleting the file.

    Raises
    ------
    InputError
        There is no such file, it is not a finished map, or an option is not one of xarray's.

    Examples
    --------
    >>> import tempfile, numpy as np, xarray as xr
    >>> from fastlink.io.dataset import Variable
    >>> from fastlink.io.writing.writer import Writer
    >>> coords = xr.Dataset(coords={"a2": ("a2", [1.0, 1.2], {"units": "m"})})
    >>> speed = Variable("omega4_max", ("a2",), (2,), np.dtype("f8"), {"units": "rad s-1"})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with Writer(f"{folder}/maps.h5", coords, [speed], {"title": "two designs"}) as writer:
    ...         writer.write("omega4_max", 0, np.array([31.0, 29.5]))
    ...         writer.finish({})
    ...     with open_map(f"{folder}/maps.h5") as maps:
    ...         maps.title, float(maps.omega4_max.sel(a2=1.2))
    ('two designs', 29.5)
    """
    path = existing_map(path, or_zarr=True)
    _check_options(chunks, options)
    engine = "zarr" if path.is_dir() else "h5netcdf"
    if engine == "zarr":
        require_package("zarr", ("path",))
    else:
        check_seal(path)
    try:
        dataset = xr.open_dataset(path, engine=engine, chunks=chunks, **options)
    except Exception as error:  # of h5py, h5netcdf, xarray and dask: there is no list of them
        _refuse_option(path, engine, chunks, options, error)
        if engine == "zarr":
            what = f"{path}: cannot be read as zarr ({reason(error)})"
            raise InputError(what, remedy="give a map that fastlink.convert has written") from error
        if path.suffix == ".toml" and not is_hdf5(path):
            what = f"{path}: is a study, not a map"
            raise InputError(what, remedy=f"`fastlink run {path}` makes its map") from error
        what = f"{path}: cannot be read as HDF5 ({_fault(path, error)})"
        raise InputError(what, remedy="give a map that a sweep has written") from error
    version = dataset.attrs.get(FORMAT)
    if isinstance(version, (int, np.integer)) and version <= FORMAT_VERSION:
        if engine != "zarr" and str(dataset.attrs.get(COMPRESSION, BUILT_IN)).partition(":")[0] != BUILT_IN:
            with contextlib.ExitStack() as stack:
                stack.callback(dataset.close)
                require_package("hdf5plugin", ("path",))
                register_filter(str(dataset.attrs[COMPRESSION]).partition(":")[0])
                stack.pop_all()
        return dataset
    dataset.close()
    if version is None:
        what = f"{path}: is not a finished map (it has no attribute {FORMAT!r})"
        raise InputError(what, remedy="other files open with xarray.open_dataset")
    what = f"{path}: has format {version}, this version reads up to {FORMAT_VERSION}"
    raise InputError(what, remedy="update fastlink")


@contextlib.contextmanager
def as_map(maps: Any) -> Iterator[xr.Dataset]:
    """Yield the map that a caller gives, as a Dataset or as the path of its file, or refuse it.

    Examples
    --------
    >>> import fastlink as fl
    >>> with as_map(fl.sweep("planar_4r", fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0), ["grashof_class"])) as maps:
    ...     int(maps.grashof_class)
    0
    """
    with as_dataset(maps) as dataset:
        if FORMAT not in dataset.attrs:
            what = f"is a Dataset without the attribute {FORMAT!r} of a map"
            remedy = (
                f"{GIVE_A_MAP}; under xarray.set_options(keep_attrs=True) its attributes outlast arithmetic"
            )
            raise InputError(what, where=("maps",), remedy=remedy)
        yield dataset


@contextlib.contextmanager
def as_dataset(maps: Any) -> Iterator[xr.Dataset]:
    """Yield a Dataset, whether or not it has all attributes of a map; or the map at a path."""
    if isinstance(maps, xr.Dataset):
        try:
            yield maps
        except FileNotFoundError as error:
            what = f"is of a file that is not there any more ({reason(error).partition(' (')[0]})"
            raise InputError(what, where=("maps",), remedy=GIVE_A_MAP) from error
    elif isinstance(maps, (str, os.PathLike)):
        with open_map(maps) as opened:
            yield opened
    else:
        one = isinstance(maps, xr.DataArray)
        what = f"is {'one variable' if one else short_repr(maps)}, not a map"
        remedy = "give the whole map" if one else GIVE_A_MAP
        raise InputError(what, where=("maps",), remedy=remedy)


def existing_map(path: Any, *, or_zarr: bool = False) -> Path:
    """Return the path of a file that may be a map, or of a zarr store where that may be one, or refuse it."""
    file = check_path(("path",), path)
    if is_zarr(file):
        if or_zarr:
            return file
        what = f"{file}: is a zarr store, which has no checksums of fastlink"
        raise InputError(what, remedy="check the .h5 file that it was made from")
    if other := not_a_file(file):
        raise InputError(f"{file}: {other}", remedy="give the path of a map that a sweep has written")
    if os.fspath(path).endswith(os.sep):
        raise InputError(f"{path}: is not a folder", remedy=f"write {str(file)!r}")
    if not os.path.exists(file):
        part = part_of(file)
        hint = f"; {part.name} is of a run that has not finished" if os.path.exists(part) else ""
        raise InputError(f"{file}: there is no such file{hint}", remedy="give the path of a written map")
    return file


def check_seal(path: Path) -> None:
    """Refuse a map whose labels have changed since they were written, before HDF5 reads them."""
    try:
        broken = seal_is_broken(path)
    except OSError as error:
        remedy = "give a map that a sweep has written"
        raise InputError(f"{path}: cannot be read ({reason(error)})", remedy=remedy) from error
    if broken:
        what = f"{path}: is damaged: labels or attributes have changed since they were written"
        raise InputError(what, remedy="take a copy of it, or write it again")


def _fault(path: Path, error: Exception) -> str:
    """Return why a file cannot be read as HDF5."""
    try:
        return reason(error) if is_hdf5(path) else "it does not begin as such a file does"
    except OSError as unreadable:
        return reason(unreadable)


def _check_options(chunks: Any, options: dict[str, Any]) -> None:
    """Refuse options that xarray does not have, or that need what is not installed."""
    known = [name for name in signature(xr.open_dataset).parameters if name not in DECIDED]
    for name in options:
        if name not in known:
            raise InputError(
                "is not an option of xarray.open_dataset", where=(name,), remedy=suggest(name, known)
            )
    if chunks is not None and find_spec("dask") is None:
        raise InputError("dask is not installed", where=("chunks",), remedy=INSTALL_DASK)


def _refuse_option(path: Path, engine: Any, chunks: Any, options: dict[str, Any], error: Exception) -> None:
    """Refuse the options where the file opens without them."""
    if chunks is None and not options:
        return
    try:
        xr.open_dataset(path, engine=engine).close()
    except Exception:
        return
    given = ("chunks",) if chunks is not None else tuple(options)[:1]
    what = f"cannot open {path.name} with such options ({reason(error)})"
    raise InputError(what, where=given, remedy="see xarray.open_dataset") from error
