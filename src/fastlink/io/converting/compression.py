"""The compressions of converted files, by name and level, in the words of each library."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fastlink._text import short_repr
from fastlink.errors import InputError, Setting
from fastlink.io.dataset import Variable
from fastlink.io.ranges import pieces
from fastlink.io.reader import register_filter, require_package
from fastlink.options import check_choice

__all__ = ["Compression", "check_compression", "chunks_of"]

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
        if self.name == "zstd":
            return dict(hdf5plugin.Zstd(clevel=self.level))
        if self.name == "blosc":
            return dict(hdf5plugin.Blosc(cname="zstd", clevel=self.level, shuffle=hdf5plugin.Blosc.NOSHUFFLE))
        return dict(hdf5plugin.LZ4())

    def of_zarr(self) -> Any:
        """Return the codec of an array of zarr."""
        import numcodecs

        if self.name == "gzip":
            return numcodecs.GZip(level=self.level)
        if self.name == "lz4":
            return numcodecs.LZ4()
        return (
            numcodecs.Zstd(level=self.level)
            if self.name == "zstd"
            else numcodecs.Blosc(cname="zstd", clevel=self.level, shuffle=numcodecs.Blosc.SHUFFLE)
        )


def check_compression(value: Any, format: str) -> Compression | None:
    """Return a compression that is given as ``"zstd:3"`` or ``"gzip"``, or refuse it.

    Examples
    --------
    >>> str(check_compression("gzip", "hdf5"))
    'gzip:4'
    """
    if value is None:
        return None
    where = ("compress",)
    known = OF_FORMAT[format]
    if not known:
        remedy = "leave it out, and compress the file afterwards, or write a .parquet"
        raise InputError(f"is {short_repr(value)}, and CSV is plain text", where=where, remedy=remedy)
    name, colon, level = value.partition(":") if isinstance(value, str) else (value, "", "")
    name = check_choice(where, name, known)
    levels = LEVELS[name]
    number = None if levels is None else levels[2]
    if levels is None and colon:
        what = f"is {short_repr(value)}, and {name} has no levels"
        raise InputError(what, where=where, remedy=("write ", Setting("compress", name)))
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
