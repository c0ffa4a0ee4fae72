"""Check the bytes of a map against the checksums inside it."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import h5py

from fastlink._text import size
from fastlink.doors import door
from fastlink.errors import InputError
from fastlink.io.checksums import CHECKSUMS, crc32, read_all, seal_is_broken
from fastlink.io.place import reason
from fastlink.io.ranges import Range, joined
from fastlink.io.reader import existing_map
from fastlink.io.stored import Stored, open_to_read

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
        The values that changed, by variable: numbers of values in C order, both included, of whole blocks. Unknown,
        and empty, where the labels have changed that say where the values are.
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
        if seal_is_broken(place):
            return FileCheck(place, os.path.getsize(place), rest_is_intact=False)
        with h5py.File(place, "r") as file:
            if CHECKSUMS not in file:
                raise InputError(f"{place}: has no checksums", remedy="write it again by this version")
            stored = Stored.of(file)
        return _compared(place, stored)
    except (OSError, RuntimeError, KeyError, ValueError, TypeError, EOFError) as error:
        remedy = "give a map that a sweep has written, or write it again"
        raise InputError(f"{place}: cannot be read ({reason(error)})", remedy=remedy) from error


def _compared(path: Path, stored: Stored) -> FileCheck:
    """Return the outcome for a file with its checksums."""
    blocks = [(name, *block) for name in stored.values for block in stored.blocks(name)]
    fd = open_to_read(path)

    def is_intact(block: tuple[str, int, Range]) -> bool:
        name, number, (start, stop) = block
        return crc32(read_all(fd, stop - start, stored.values[name].offset + start)) == stored.sums[number]

    try:
        with ThreadPoolExecutor() as pool:
            wrong = [
                block for block, intact in zip(blocks, pool.map(is_intact, blocks), strict=True) if not intact
            ]
        rest_is_intact = stored.rest_is_intact(fd)
        nbytes = os.fstat(fd).st_size
    finally:
        os.close(fd)
    ranges: dict[str, list[Range]] = {}
    for name, _, (start, stop) in wrong:
        itemsize = stored.values[name].itemsize
        ranges.setdefault(name, []).append((start // itemsize, stop // itemsize))
    damaged = {name: [(first, end - 1) for first, end in joined(values)] for name, values in ranges.items()}
    return FileCheck(path, nbytes, damaged, rest_is_intact, not blocks)
