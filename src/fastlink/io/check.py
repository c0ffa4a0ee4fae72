"""Check the bytes of a map against the checksums inside it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from itertools import repeat
from pathlib import Path
from typing import Any, NamedTuple

import h5py

from fastlink._text import size
from fastlink.doors import door
from fastlink.errors import InputError
from fastlink.io.checksums import CHECKSUMS, OF_REST, OF_VALUES, crc32, of_file, read_all
from fastlink.io.place import reason
from fastlink.io.ranges import Range, joined
from fastlink.io.reader import existing_map

__all__ = ["FileCheck", "check"]


@dataclass(frozen=True)
class FileCheck:
    """The outcome of `check`; true where every byte is as it was written.

    Attributes
    ----------
    path : Path
        The file.
    nbytes : int
        Its size.
    damaged : dict of str to list of (first, last)
        The values that changed, by variable: numbers of values in C order, both included, of whole blocks.
    rest_is_intact : bool
        Whether all else is as it was: labels, attributes, the checksums themselves;
        where `is_compressed`, the values too.
    is_compressed : bool
        Whether the file has one checksum of all its bytes, as compressed ones have.
    """

    path: Path
    nbytes: int
    damaged: dict[str, list[tuple[int, int]]] = field(default_factory=dict)
    rest_is_intact: bool = True
    is_compressed: bool = False

    def __bool__(self) -> bool:
        return self.rest_is_intact and not self.damaged

    def __str__(self) -> str:
        if self:
            return f"{self.path} ({size(self.nbytes)}) is as it was written"
        lines = [
            f"{self.path}: values of {name} have changed, between number {first:,} and {last:,}"
            for name, ranges in self.damaged.items()
            for first, last in ranges
        ]
        if not self.rest_is_intact:
            what = "values, " if self.is_compressed else ""
            lines.append(f"{self.path}: {what}labels, attributes or checksums have changed")
        return "\n".join(lines)


@door
def check(path: str | Path) -> FileCheck:
    """Check every byte of a map against the checksums that were written with it.

    Parameters
    ----------
    path : str or path
        A map that a sweep or a study has written.

    Returns
    -------
    FileCheck
        True where nothing has changed; it prints as a line for each part that has.

    Raises
    ------
    InputError
        The file cannot be read, or has no checksums.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import fastlink as fl
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "maps.h5")
    ...     space = fl.grid(a1=0.4, a2=[1.1, 1.2], a3=0.8, a4=1.0)
    ...     fl.sweep("planar_4r", space, ["transmission_angle_min"], to=path, verify=0).close()
    ...     bool(fl.check(path))
    True
    """
    place = existing_map(path)
    try:
        with h5py.File(place, "r") as file:
            if CHECKSUMS not in file:
                raise InputError(f"{place}: has no checksums", remedy="write it again by this version")
            block_bytes = int(file[CHECKSUMS].attrs["block_bytes"])
            names = str(file[CHECKSUMS].attrs["variables"]).split()
            blocks = [block for name in names for block in _blocks(name, file[name], block_bytes)]
            said, rest = file[OF_VALUES][:].tolist(), int(file[OF_REST][0])
            rest_at = file[OF_REST].id.get_offset()
        return _compared(place, blocks, said, rest_at, rest)
    except (OSError, RuntimeError, KeyError, ValueError, TypeError, EOFError) as error:
        remedy = "give a map that a sweep has written, or write it again"
        raise InputError(f"{place}: cannot be read ({reason(error)})", remedy=remedy) from error


class _Block(NamedTuple):
    """A block of values: of which variable, where in the file, and the numbers of its values."""

    variable: str
    start: int
    stop: int
    values: Range


def _blocks(name: str, values: h5py.Dataset, block_bytes: int) -> Iterator[_Block]:
    """Yield the blocks of a variable."""
    offset, itemsize = values.id.get_offset(), values.dtype.itemsize
    for start in range(0, values.nbytes, block_bytes):
        stop = min(start + block_bytes, values.nbytes)
        yield _Block(name, offset + start, offset + stop, (start // itemsize, stop // itemsize))


def _compared(path: Path, blocks: list[_Block], said: Any, rest_at: int, rest: int) -> FileCheck:
    """Return the outcome, from where values lie, their checksums, and where that of all else lies, and what it is."""
    fd = os.open(path, os.O_RDONLY | getattr(os, "O_BINARY", 0))
    try:
        with ThreadPoolExecutor() as pool:
            found = pool.map(lambda one: crc32(read_all(fd, one.stop - one.start, one.start)), blocks)
            # without as many checksums as blocks, no block has one
            pairs = zip(found, said if len(said) == len(blocks) else repeat(None), blocks, strict=False)
            wrong = [block for crc, expected, block in pairs if crc != expected]
        left_out = {block.start: block.stop - block.start for block in blocks}
        is_intact = of_file(fd, left_out, (rest_at, rest_at + 4)) == rest
        nbytes = os.fstat(fd).st_size
    finally:
        os.close(fd)
    ranges: dict[str, list[Range]] = {}
    for block in wrong:
        ranges.setdefault(block.variable, []).append(block.values)
    damaged = {name: [(first, end - 1) for first, end in joined(values)] for name, values in ranges.items()}
    return FileCheck(path, nbytes, damaged, is_intact, not blocks)
