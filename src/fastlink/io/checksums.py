"""Checksums of the values of a map, and of all else in its file.

The values of each variable, as they lie in the file, are divided into blocks of `BLOCK_BYTES`, the last may be
shorter; each has the CRC-32 of zlib. A block may be written in pieces, by any thread, in any order: the CRC of A
followed by B is that of A, shifted by the length of B, plus (modulo 2) that of B.
"""

from __future__ import annotations

import contextlib
import math
import os
import struct
import threading
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import accumulate, repeat
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from fastlink._text import counted, short_repr
from fastlink.errors import InputError

# -- Ranges of numbers, such as those of designs that are written: each from its start to before its stop


Range = tuple[int, int]
#: Ranges that are kept apart until they are joined.
FEW_RANGES = 64


def joined_ranges(ranges: list[Range]) -> list[Range]:
    """Return ranges in order, and join those that touch.

    >>> joined_ranges([(4, 6), (0, 2), (2, 4), (8, 9)])
    [(0, 6), (8, 9)]
    """
    result: list[Range] = []
    for start, stop in sorted(ranges):
        if result and start <= result[-1][1]:
            result[-1] = result[-1][0], max(stop, result[-1][1])
        else:
            result.append((start, stop))
    return result


def count_of(ranges: Iterable[Range]) -> int:
    """Return how many numbers are in ranges that do not overlap.

    >>> count_of([(0, 6), (8, 9)])
    7
    """
    return sum(stop - start for start, stop in ranges)


def missing(written: list[Range], size: int) -> list[Range]:
    """Return the parts of 0 to `size` that ordered ranges leave out.

    >>> missing([(0, 6), (8, 9)], 12)
    [(6, 8), (9, 12)]
    """
    ends = [0, *(stop for _, stop in written)]
    starts = [*(start for start, _ in written), size]
    return [(a, b) for a, b in zip(ends, starts, strict=True) if a < b]


class Ranges:
    """Ranges that are added one by one; joined from time to time, not each time, which would take ever longer.

    >>> ranges = Ranges([(0, 2)])
    >>> ranges.add(4, 6)
    >>> ranges.add(2, 4)
    >>> ranges.joined()
    [(0, 6)]
    """

    def __init__(self, ranges: Iterable[Range] = ()) -> None:
        self._ranges, self._most = list(ranges), FEW_RANGES

    def add(self, start: int, stop: int) -> None:
        """Add a range."""
        self._ranges.append((start, stop))
        if len(self._ranges) > self._most:
            self._ranges = joined_ranges(self._ranges)
            self._most = 2 * len(self._ranges) + FEW_RANGES

    def joined(self) -> list[Range]:
        """Return all ranges in order, those that touch joined."""
        return joined_ranges(self._ranges)


def pieces(
    shape: tuple[int, ...], most: int, steps: tuple[int, ...] = ()
) -> Iterator[tuple[tuple[int | slice, ...], int]]:
    """Yield index and first flat number of consecutive pieces of an array, in C order.

    >>> list(pieces((2, 3), 2))[:2]
    [((0, slice(0, 2, None)), 0), ((0, slice(2, 3, None)), 2)]
    """
    if not math.prod(shape):
        return
    if not shape:
        yield (), 0
        return
    lead = next(k for k in range(len(shape)) if math.prod(shape[k + 1 :]) <= most or k == len(shape) - 1)
    below = math.prod(shape[lead + 1 :])
    rows = max(1, most // below)
    if steps:
        rows = rows // steps[lead] * steps[lead] or rows
    for number, outer in enumerate(np.ndindex(shape[:lead])):
        for start in range(0, shape[lead], rows):
            stop = min(start + rows, shape[lead])
            yield (*outer, slice(start, stop)), (number * shape[lead] + start) * below


try:  # the same numbers, three to five times as fast
    from isal.isal_zlib import crc32 as crc32
except ImportError:
    from zlib import crc32 as crc32


#: The group of the checksums: of the values, block by block, and of all else in the file.
CHECKSUMS, OF_VALUES, OF_REST = "checksums", "checksums/values", "checksums/rest"
ALGORITHM = (
    "CRC-32 of zlib. values: of each block_bytes of the values of a variable as they lie in the file, one variable "
    "after the other; rest: of the file without those values, the bytes of rest itself taken for zeros"
)
BLOCK_BYTES = 1 << 20
#: The polynomial of CRC-32, bits reversed: the greatest bit is the coefficient of x^0.
POLYNOMIAL, ONE = 0xEDB88320, 1 << 31
#: Pieces that are shifted one by one, which takes 20 us each; more of them as arrays.
FEW = 16
#: The power of x for any number of bytes of a block is the product of two: of less than a step, and of whole steps.
STEP = 1024
assert BLOCK_BYTES <= STEP * STEP
#: Bytes that are read at once.
READ_BYTES = 1 << 22
#: A seal stands behind the end of what HDF5 takes for its file. No 512 bytes hold both of its ends, and its length is
#: no power of two, by which one wrong bit could move the address of that end onto the end of the file.
SEAL, SHORTEST_SEAL, LENGTH_STEP = b"fastlink's seal.", 1040, 48
#: HDF5's first bytes, and where the version of its superblock, and the address of its end, stand by that version.
SIGNATURE, VERSION_AT, END_AT = b"\x89HDF\r\n\x1a\n", 8, {0: 40, 1: 44, 2: 28, 3: 28}
#: Held from a seek to what follows it, where the system cannot read or write at a position.
seek_lock = threading.Lock()


def block_count(nbytes: int) -> int:
    """Return the number of blocks of so many bytes.

    >>> block_count(0), block_count(1), block_count(BLOCK_BYTES + 1)
    (0, 1, 2)
    """
    return -(-nbytes // BLOCK_BYTES)


def of_pieces(pieces: Iterable[tuple[int, Any]], nbytes: int) -> list[tuple[int, int]]:
    """Return what pieces of the values of a variable add to the checksums of its blocks: block and addend."""
    blocks, crcs, shifts = [], [], []
    for position, data in pieces:
        end = position + len(data)
        for block in range(position // BLOCK_BYTES, block_count(end)):
            start, stop = block * BLOCK_BYTES, min((block + 1) * BLOCK_BYTES, nbytes)
            blocks.append(block)
            crcs.append(crc32(data[max(start - position, 0) : stop - position]))
            shifts.append(stop - min(stop, end))
    if len(blocks) < FEW:
        return list(zip(blocks, map(_shifted, crcs, shifts), strict=True))
    addends = _shifted(np.array(crcs, np.uint32), np.array(shifts))
    return list(zip(blocks, addends.tolist(), strict=True))


def add(sums: dict[int, int], addends: Iterable[tuple[int, int]]) -> None:
    """Add to the checksums of blocks."""
    for block, addend in addends:
        sums[block] = sums.get(block, 0) ^ addend


def of_file(fd: int, left_out: Mapping[int, int], zeros: tuple[int, int]) -> int:
    """Return the checksum of a file without some parts."""
    result = 0
    for position, data in all_but(fd, left_out):
        for place in range(max(zeros[0], position), min(zeros[1], position + len(data))):
            data[place - position] = 0
        result = crc32(data, result)
    return result


def all_but(fd: int, left_out: Mapping[int, int]) -> Iterator[tuple[int, bytearray]]:
    """Yield the positions and bytes of a file, in order, without those that begin somewhere and are so many."""
    gone = joined_ranges([(start, start + nbytes) for start, nbytes in left_out.items()])
    for start, stop in missing(gone, os.fstat(fd).st_size):
        for position in range(start, stop, READ_BYTES):
            yield position, read_all(fd, min(stop - position, READ_BYTES), position)


def seal(fd: int, values: Mapping[int, int], rest_at: int) -> tuple[int, bytes]:
    """Return what tells, without HDF5, whether the labels of a map are as they were written, and where it belongs."""
    # HDF5 itself loops for ever, or crashes, on some labels of which one bit is wrong.
    gone = joined_ranges([(start, start + nbytes) for start, nbytes in values.items() if nbytes])
    labels = of_file(fd, values, (rest_at, rest_at + 4))
    numbers = [len(gone), rest_at, labels, *(number for ends in gone for number in ends)]
    return _end_of_hdf5(fd), _sealed(numbers)


def _sealed(numbers: Sequence[int]) -> bytes:
    """Return the seal that holds some numbers."""
    head = SEAL + struct.pack(f"<{len(numbers)}Q", *numbers)
    head += struct.pack("<I", crc32(head))
    length = max(SHORTEST_SEAL, -(-(len(head) + len(SEAL)) // LENGTH_STEP) * LENGTH_STEP)
    return head.ljust(length - len(SEAL), b"\0") + SEAL


def seal_is_broken(path: str | os.PathLike[str]) -> bool:
    """Tell, without HDF5, whether a map's labels have changed since they were sealed."""
    # A file without a seal, of an earlier version or changed by HDF5 since, is not broken.
    return read_seal(path)[0]


def read_seal(path: str | os.PathLike[str]) -> tuple[bool, int | None]:
    """Return whether the seal of a file is broken, and the checksum of its labels where there is an intact one."""
    with open_to_read(path) as fd:
        try:
            size, end = os.fstat(fd).st_size, _end_of_hdf5(fd)
            if size < len(SEAL) or end == size:
                return False, None
            tail = bytes(read_all(fd, len(SEAL), size - len(SEAL)))
            data = bytes(read_all(fd, size - end, end)) if 0 <= end < size else b""
            if tail != SEAL and not data.startswith(SEAL):
                return False, None
            (count,) = struct.unpack_from("<Q", data, len(SEAL))
            numbers = struct.unpack_from(f"<{2 * count + 3}Q", data, len(SEAL))
            if data != _sealed(numbers):
                return True, None
            _, rest_at, labels, *ends = numbers
            gone = {first: last - first for first, last in zip(ends[::2], ends[1::2], strict=True)}
            broken = of_file(fd, gone | {end: size - end}, (rest_at, rest_at + 4)) != labels
            return broken, None if broken else labels
        except (struct.error, EOFError, OverflowError, ValueError):
            return True, None


def _end_of_hdf5(fd: int) -> int:
    """Return where HDF5's part of a file ends, as its superblock says; the end of one without it, -1 of no place."""
    size = os.fstat(fd).st_size
    head = bytes(read_all(fd, min(size, 64), 0))
    if not head.startswith(SIGNATURE) or size < 64:
        return size
    at = END_AT.get(head[VERSION_AT])
    return -1 if at is None else int(struct.unpack_from("<Q", head, at)[0])


def read_all(fd: int, count: int, position: int) -> bytearray:
    """Read every byte from a position on, however few the system gives at a time; thread-safe."""
    result = bytearray()
    while len(result) < count:
        rest, at = count - len(result), position + len(result)
        if hasattr(os, "pread"):
            data = os.pread(fd, rest, at)
        else:
            with seek_lock:
                os.lseek(fd, at, os.SEEK_SET)
                data = os.read(fd, rest)
        if not data:
            raise EOFError(f"the file ends at byte {at:,}")
        result += data
    return result


def _shifted(crc: Any, nbytes: Any) -> Any:
    """Return a CRC, or an array of them, as if so many more bytes followed, without what they add."""
    few, many = _powers()
    low, high = few[nbytes % STEP], many[nbytes // STEP]
    if isinstance(nbytes, int):
        return _product(_product(int(low), int(high)), crc) if nbytes else crc
    return _product(_product(low, high), crc)


@cache
def _powers() -> tuple[NDArray[np.uint32], NDArray[np.uint32]]:
    """Return x to the number of bits of 0, 1, 2, ... bytes, and of so many steps, modulo the polynomial."""
    byte = ONE >> 8
    few = list(accumulate(repeat(byte, STEP), _product, initial=ONE))
    many = list(accumulate(repeat(few[STEP], STEP), _product, initial=ONE))
    return np.array(few[:STEP], np.uint32), np.array(many, np.uint32)


def _product(a: Any, b: Any) -> Any:
    """Return a product modulo the polynomial, of numbers or of arrays of them."""
    result = 0
    for _ in range(32):
        result = result ^ b * (a >> 31)
        a = a << 1 & 0xFFFFFFFF
        b = b >> 1 ^ POLYNOMIAL * (b & 1)
    return result


# -- The checksums that stand in a file, and the values they are about


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
    """The checksums of a file."""

    #: Bytes of a block of values.
    block_bytes: int
    #: The values of each variable.
    values: dict[str, Values]
    #: The checksum of each block, or None where there are not as many as blocks.
    sums: list[int | None]
    #: That of all else, and where it stands.
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

    def blocks(self, name: str, start: int = 0, stop: int | None = None) -> Iterator[tuple[int, Range]]:
        """Yield the blocks of a variable that hold some bytes: number, and range of bytes from the first value."""
        size, nbytes = self.block_bytes, self.values[name].nbytes
        for first in range(start // size * size, nbytes if stop is None else stop, size):
            yield first // size, (first, min(first + size, nbytes))

    def read(self, fd: int, name: str, block: int) -> bytearray | None:
        """Return a block of the values of a variable, None where they have changed."""
        values, start = self.values[name], block * self.block_bytes
        data = read_all(fd, min(self.block_bytes, values.nbytes - start), values.offset + start)
        return data if crc32(data) == self.sums[values.first + block] else None

    def rest_is_intact(self, fd: int) -> bool:
        """Tell whether all but the values is as it was written."""
        values = {one.offset: one.nbytes for one in self.values.values()}
        return of_file(fd, values, (self.rest_at, self.rest_at + 4)) == self.rest


def check_own(path: Path, file: Any) -> None:
    """Refuse an open file that takes values from other files, or tells of many more than it holds."""
    # Files of strangers can name any file of their reader's, the bytes of which would appear as values and
    # travel on.

    def of_link(name: str, link: Any) -> str | None:
        if not isinstance(link, h5py.ExternalLink):
            return None
        return f"{name} is a link to the file {short_repr(link.filename)}, which is not read"

    def of_values(name: str, one: Any) -> str | None:
        if (
            not isinstance(one, h5py.Dataset) or not one.size or one.is_virtual
        ):  # see `fastlink.io.reader.check_parts`
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


@contextlib.contextmanager
def open_to_read(path: str | os.PathLike[str]) -> Iterator[int]:
    """Yield the file number of a file that is opened to be read."""
    fd = os.open(path, os.O_RDONLY | getattr(os, "O_BINARY", 0))
    try:
        yield fd
    finally:
        os.close(fd)
