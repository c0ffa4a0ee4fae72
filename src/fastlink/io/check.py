"""Check the bytes of a map against the checksums inside it."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from fastlink._text import size
from fastlink.doors import door
from fastlink.errors import InputError
from fastlink.io.checksums import CHECKSUMS, OF_REST, OF_VALUES, crc32, of_file, pread
from fastlink.io.place import reason
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
        Whether all else is as it was: labels, attributes, the checksums themselves.
    """

    path: Path
    nbytes: int
    damaged: dict[str, list[tuple[int, int]]] = field(default_factory=dict)
    rest_is_intact: bool = True

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
            lines.append(f"{self.path}: labels, attributes or checksums have changed")
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
            places = [
                (name, file[name].id.get_offset(), file[name].nbytes, file[name].dtype.itemsize)
                for name in names
            ]
            said, rest = file[OF_VALUES][:], int(file[OF_REST][0])
            rest_at = file[OF_REST].id.get_offset()
        return _compared(place, block_bytes, places, said, (rest_at, rest))
    except (OSError, RuntimeError, KeyError, ValueError, TypeError, EOFError) as error:
        remedy = "give a map that a sweep has written, or write it again"
        raise InputError(f"{place}: cannot be read ({reason(error)})", remedy=remedy) from error


def _compared(
    path: Path, block_bytes: int, places: list[tuple[str, int, int, int]], said: Any, rest: tuple[int, int]
) -> FileCheck:
    """Return the outcome, from where the values of each variable lie and the checksums in the file."""
    fd = os.open(path, os.O_RDONLY | getattr(os, "O_BINARY", 0))
    try:

        def of_block(span: tuple[int, int]) -> int:
            start, stop = span
            result = 0
            while start < stop:
                data = pread(fd, stop - start, start)
                start, result = start + len(data), crc32(data, result)
            return result

        spans = [
            (offset + k * block_bytes, offset + min((k + 1) * block_bytes, nbytes))
            for _, offset, nbytes, _ in places
            for k in range(-(-nbytes // block_bytes))
        ]
        with ThreadPoolExecutor() as pool:
            found = np.fromiter(pool.map(of_block, spans), "u4", len(spans))
        left_out = {offset: nbytes for _, offset, nbytes, _ in places}
        is_intact = of_file(fd, left_out, (rest[0], rest[0] + 4)) == rest[1]
        nbytes = os.fstat(fd).st_size
    finally:
        os.close(fd)
    wrong = found != said if len(said) == len(found) else np.ones(len(found), bool)
    damaged: dict[str, list[tuple[int, int]]] = {}
    first = 0
    for name, _, count, itemsize in places:
        blocks = np.flatnonzero(wrong[first : first + -(-count // block_bytes)])
        first += -(-count // block_bytes)
        for k in map(int, blocks):
            last = min((k + 1) * block_bytes, count) // itemsize - 1
            ranges = damaged.setdefault(name, [])
            start = k * block_bytes // itemsize
            if ranges and ranges[-1][1] + 1 == start:
                start = ranges.pop()[0]
            ranges.append((start, last))
    return FileCheck(path, nbytes, damaged, is_intact)
