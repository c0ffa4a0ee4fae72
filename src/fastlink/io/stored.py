"""The checksums that stand in a file, and the values they are about."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py

from fastlink._text import counted, short_repr
from fastlink.errors import InputError
from fastlink.io.checksums import CHECKSUMS, OF_REST, OF_VALUES, of_file
from fastlink.io.ranges import Range

__all__ = ["Stored", "Values", "check_own", "open_to_read"]

#: What netCDF calls the scale of a dimension that has no labels.
NO_VARIABLE = b"This is a netCDF dimension but not a netCDF variable"


@dataclass(frozen=True)
class Values:
    """The values of a variable: where they begin in the file, their bytes, and the number of their first block."""

    offset: int
    nbytes: int
    itemsize: int
    first: int


@dataclass(frozen=True)
class Stored:
    """The checksums of a file.

    Attributes
    ----------
    block_bytes : int
        Bytes of a block of values.
    values : dict of str to Values
        The values of each variable.
    sums : list of int
        The checksum of each block, or None where there are not as many as blocks.
    rest, rest_at : int
        That of all else, and where it stands.
    """

    block_bytes: int
    values: dict[str, Values]
    sums: list[int | None]
    rest: int
    rest_at: int

    @classmethod
    def of(cls, file: Any) -> Stored:
        """Return those of an open file, which has them."""
        block_bytes, count = int(file[CHECKSUMS].attrs["block_bytes"]), 0
        if block_bytes < 1:
            raise ValueError(f"its blocks are of {block_bytes} bytes")
        values: dict[str, Values] = {}
        for name in str(file[CHECKSUMS].attrs["variables"]).split():
            found: h5py.Dataset = file[name]
            if found.id.get_offset() is None:
                raise ValueError(f"{name} has no place in the file")
            values[name] = Values(found.id.get_offset(), found.nbytes, found.dtype.itemsize, count)
            count += -(-found.nbytes // block_bytes)
        sums = file[OF_VALUES][:].tolist()
        rest, rest_at = int(file[OF_REST][0]), file[OF_REST].id.get_offset()
        return cls(block_bytes, values, sums if len(sums) == count else [None] * count, rest, rest_at)

    def blocks(self, name: str) -> Iterator[tuple[int, Range]]:
        """Yield the number of each block of a variable, and its range of bytes from the first value."""
        nbytes = self.values[name].nbytes
        for k, start in enumerate(range(0, nbytes, self.block_bytes)):
            yield self.values[name].first + k, (start, min(start + self.block_bytes, nbytes))

    def rest_is_intact(self, fd: int) -> bool:
        """Tell whether all but the values is as it was written."""
        values = {one.offset: one.nbytes for one in self.values.values()}
        return of_file(fd, values, (self.rest_at, self.rest_at + 4)) == self.rest


def check_own(path: Path, file: Any) -> None:
    """Refuse an open file that takes values from other files, or tells of many more than it holds.

    Files of strangers can name any file of their reader's, the bytes of which would appear as values and travel on.

    Raises
    ------
    InputError
        A link or the storage of a dataset leads to another file, or its values are not there.
    """

    def of_link(name: str, link: Any) -> str | None:
        foreign = isinstance(link, h5py.ExternalLink)
        return (
            f"{name} is a link to the file {short_repr(link.filename)}, which is not read"
            if foreign
            else None
        )

    def of_values(name: str, one: Any) -> str | None:
        if not isinstance(one, h5py.Dataset) or not one.size or one.is_virtual:  # see `parts.check_parts`
            return None
        if one.external:
            return f"the values of {name} are in the file {short_repr(one.external[0][0])}, which is not read"
        if one.chunks is None:
            held = one.id.get_storage_size() >= one.nbytes
        else:
            held = one.id.get_num_chunks() * math.prod(one.chunks) >= one.size
        # a netCDF dimension without labels has a length alone
        if held or one.attrs.get("NAME", b"").startswith(NO_VARIABLE):
            return None
        return f"it tells of {counted(one.size, 'value')} of {name}, and does not hold them"

    # h5py ends a visit at the first answer, and does not bear an exception there
    if what := file.visititems_links(of_link) or file.visititems(of_values):
        raise InputError(f"{path}: {what}", remedy="give a map that holds its values itself")


def open_to_read(path: str | os.PathLike[str]) -> int:
    """Return the file number of a file that is opened to be read."""
    return os.open(path, os.O_RDONLY | getattr(os, "O_BINARY", 0))
