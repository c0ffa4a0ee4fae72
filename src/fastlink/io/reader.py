"""Open finished maps, lazily, and refuse other files."""

from __future__ import annotations

import os
from pathlib import Path

import xarray as xr

from fastlink.doors import door
from fastlink.errors import InputError
from fastlink.io.dataset import FORMAT, FORMAT_VERSION
from fastlink.io.partial_file import part_of, reason

__all__ = ["is_hdf5", "open_map"]

SIGNATURE = b"\x89HDF\r\n\x1a\n"


def is_hdf5(path: Path) -> bool:
    """Tell whether a file begins as HDF5 does."""
    with path.open("rb") as file:
        return file.read(len(SIGNATURE)) == SIGNATURE


@door(name="open")
def open_map(path: str | Path) -> xr.Dataset:
    """Open a map that a sweep has written; values are read when they are used.

    Parameters
    ----------
    path : str or path
        The file.

    Returns
    -------
    xarray.Dataset
        Close it, or use it in a ``with`` statement, before deleting the file.

    Examples
    --------
    >>> import tempfile, numpy as np, xarray as xr
    >>> from fastlink.io.dataset import Variable
    >>> from fastlink.io.writer import Writer
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
    path = Path(os.path.expanduser(path))
    if not path.exists():
        part = part_of(path)
        hint = f"; {part.name} is of a run that has not finished" if part.exists() else ""
        raise InputError(f"{path}: there is no such file{hint}", remedy="give the path of a written map")
    if path.is_dir():
        raise InputError(f"{path}: is a folder", remedy="give the path of a map that a sweep has written")
    try:
        dataset = xr.open_dataset(path, engine="h5netcdf")
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        if path.suffix == ".toml" and not is_hdf5(path):
            what = f"{path}: is a study, not a map"
            raise InputError(what, remedy=f"`fastlink run {path}` makes its map") from error
        what = f"{path}: cannot be read as HDF5 ({reason(error)})"
        raise InputError(what, remedy="give a map that a sweep has written") from error
    version = dataset.attrs.get(FORMAT)
    if version is not None and version <= FORMAT_VERSION:
        return dataset
    dataset.close()
    if version is None:
        what = f"{path}: is not a finished map (it has no attribute {FORMAT!r})"
        raise InputError(what, remedy="other files open with xarray.open_dataset")
    what = f"{path}: has format {version}, this version reads up to {FORMAT_VERSION}"
    raise InputError(what, remedy="update fastlink")
