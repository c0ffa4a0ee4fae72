"""Convert a finished map to another format, compressed, in part, or with fewer digits."""

from __future__ import annotations

import contextlib
import os
import shlex
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from fastlink._text import short_repr, unwritable
from fastlink.doors import door
from fastlink.errors import InputError, KeyPath, Problems, remark, suggest
from fastlink.io.attributes import PLAIN, fault_of_value
from fastlink.io.converting.compression import Compression, check_compression
from fastlink.io.converting.labels import labelled
from fastlink.io.converting.selection import Selection, selected
from fastlink.io.converting.source import Source
from fastlink.io.place import exists_error, part_of, refused
from fastlink.io.progress import progress_bar
from fastlink.io.reader import COMPRESSION, as_map, is_zarr, require_package
from fastlink.io.writing.target import check_made_at_once
from fastlink.options import check_path, check_switch
from fastlink.space.dataset import STATUS

__all__ = ["check_conversion", "convert"]

#: The format of a file by the ending of its name.
FORMATS = {
    ".h5": "hdf5",
    ".hdf5": "hdf5",
    ".nc": "hdf5",
    ".nc4": "hdf5",
    ".zarr": "zarr",
    ".csv": "csv",
    ".parquet": "parquet",
}
#: Packages that write a format.
NEEDS = {"zarr": "zarr", "parquet": "pyarrow"}
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
        What to write, by its ending: ``.h5`` or ``.nc`` (HDF5, which is netCDF-4), ``.zarr``, ``.csv`` or ``.parquet``.
        CSV and Parquet have one row per configuration, with all inputs as columns.
    select : mapping, optional
        What to take, by the names of dimensions and inputs: ``"1.1:1.2"`` or ``(1.1, 1.2)`` a range with both ends,
        ``0.5`` the nearest value, ``"#3"`` and ``"#0:10"`` numbers of values as Python counts. Angles in degrees by
        names that end in ``_deg``.
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
    form, compression, kind = "", None, None
    with problems.at():
        form = _format(to)
        compression = check_compression(compress, form)
    with problems.at():
        kind = _dtype(dtype)
    with problems.at():
        check_switch(("overwrite",), overwrite)
    with problems.at():
        progress if progress is None else check_switch(("progress",), progress)
    with as_map(maps) as dataset:
        _check_texts(dataset, form, problems)
        selection, names = Selection(), []
        with problems.at():
            names = _quantities(dataset, quantities)
        with problems.at():
            selection = selected(dataset, select)
        problems.stop()
        source = Source(dataset, selection, names, kind)
        path = _target(to, form, dataset, 0 if compression or form != "hdf5" else source.nbytes, overwrite)
        command = _command(dataset, to, selection, quantities, dtype, compression)
        attrs = labelled(dataset, source, selection, command)
        with _shown(source.nbytes, progress) as show:
            _write(path, source, attrs, form, compression, overwrite, show)
    if source.overflows:
        what = f"values that are infinite in {kind}: {', '.join(f'{n:,} of {k}' for k, n in source.overflows.items())}"
        remark(what, ("dtype",), "keep float64 if they matter")
    return path


def _write(
    path: Path,
    source: Source,
    attrs: dict[str, Any],
    form: str,
    compression: Compression | None,
    *more: Any,
) -> None:
    """Write the result in its format."""
    from fastlink.io.converting import hdf5_file, tables, zarr_folder

    if compression is not None:
        attrs[COMPRESSION] = str(compression)
    writers = {
        "hdf5": hdf5_file.write_plain
        if compression is None
        else partial(hdf5_file.write_compressed, compression=compression),
        "zarr": partial(zarr_folder.write_zarr, compression=compression),
        "csv": tables.write_csv,
        "parquet": partial(tables.write_parquet, compression=compression),
    }
    if form in ("csv", "parquet"):
        tables.check_table(source.variables)
    writers[form](path, source, attrs, *more)


def _format(to: Any) -> str:
    """Return the format of the result by the ending of its name, or refuse it."""
    path = check_path(("to",), to, "out.nc")
    form = FORMATS.get(path.suffix.lower())
    if form is None:
        what = f"{short_repr(os.fspath(path))} ends in {path.suffix or 'nothing'!r}, which names no format"
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
    texts = [(repr(name), name) for name in of_all]
    of_all = {} if form == "csv" else of_all  # which holds none
    texts += [(f"the name of {key!r}", str(key)) for attrs in of_all.values() for key in attrs]
    texts += [
        (f"{name}: {key}" if name else str(key), value)
        for name, attrs in of_all.items()
        for key, value in attrs.items()
        if isinstance(value, str)
    ]
    texts += [
        (str(name), label)
        for name, one in maps.coords.items()
        if one.dtype.kind in "OU"
        for label in map(str, one.values.flat)
    ]
    for what, text in texts:
        if sign := unwritable(text):
            remedy = "open it by fastlink.open, write letters alone there, and convert that"
            problems.add(f"{what} holds {sign!r}, which no file can hold", ("maps",), remedy)
    for key, value in maps.attrs.items():
        if not isinstance(value, str) and (fault := fault_of_value(value)):
            problems.add(f"the attribute {key!r} {fault}", ("maps",), f"{PLAIN}, or remove it")


def check_conversion(maps: xr.Dataset, to: Any, overwrite: bool) -> None:
    """Refuse a result that could not be written, before what it holds is computed from a map."""
    _target(to, _format(to), maps, 0, overwrite)


def _target(to: Any, form: str, maps: xr.Dataset, nbytes: int, overwrite: bool) -> Path:
    """Return the path of the result, or refuse it."""
    source = maps.encoding.get("source")
    sources = [Path(source)] if isinstance(source, (str, os.PathLike)) and os.path.exists(source) else []
    if form == "zarr":
        return _folder(to, sources, overwrite)
    return check_made_at_once(to, nbytes, overwrite, sources, partial(check_path, example="out.nc"))


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


@contextlib.contextmanager
def _shown(nbytes: int, visible: bool | None) -> Iterator[Any]:
    """Yield what is to be told of bytes that are done."""
    bar = progress_bar(nbytes, "B", visible)
    try:
        yield bar.update if bar is not None else lambda count: None
    finally:
        if bar is not None:
            bar.close()
