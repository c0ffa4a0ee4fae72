"""Checksums of the values of a map, and of all else in its file.

The values of each variable, as they lie in the file, are divided into blocks of `BLOCK_BYTES`, the last may be
shorter; each has the CRC-32 of zlib. A block may be written in pieces, by any thread, in any order: the CRC of A
followed by B is that of A, shifted by the length of B, plus (modulo 2) that of B.
"""

from __future__ import annotations

import os
import struct
import threading
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fastlink.io.ranges import joined, missing

try:  # the same numbers, three to five times as fast
    from isal.isal_zlib import crc32
except ImportError:
    from zlib import crc32

__all__ = [
    "ALGORITHM",
    "BLOCK_BYTES",
    "CHECKSUMS",
    "OF_REST",
    "OF_VALUES",
    "add",
    "all_but",
    "block_count",
    "crc32",
    "of_file",
    "of_pieces",
    "read_all",
    "seal",
    "seal_is_broken",
    "seek_lock",
]

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
    """Return what pieces of the values of a variable add to the checksums of its blocks: block and addend.

    Parameters
    ----------
    pieces : iterable of (position, data)
        Where each begins, in bytes from the first value, and its bytes.
    nbytes : int
        Bytes of all values.
    """
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
    """Return the checksum of a file without some parts.

    Parameters
    ----------
    fd : int
        The open file.
    left_out : mapping of int to int
        Bytes that are left out, by where they begin.
    zeros : (start, stop)
        Bytes that count as zeros.
    """
    result = 0
    for position, data in all_but(fd, left_out):
        for place in range(max(zeros[0], position), min(zeros[1], position + len(data))):
            data[place - position] = 0
        result = crc32(data, result)
    return result


def all_but(fd: int, left_out: Mapping[int, int]) -> Iterator[tuple[int, bytearray]]:
    """Yield the positions and bytes of a file, in order, without those that begin somewhere and are so many."""
    gone = joined([(start, start + nbytes) for start, nbytes in left_out.items()])
    for start, stop in missing(gone, os.fstat(fd).st_size):
        for position in range(start, stop, READ_BYTES):
            yield position, read_all(fd, min(stop - position, READ_BYTES), position)


def seal(fd: int, values: Mapping[int, int], rest_at: int) -> tuple[int, bytes]:
    """Return what tells, without HDF5, whether the labels of a map are as they were written, and where it belongs.

    HDF5 itself loops for ever, or crashes, on some labels of which one bit is wrong.

    Parameters
    ----------
    fd : int
        The open file, with its labels and the checksums of its values.
    values : mapping of int to int
        Bytes of values, by where they begin.
    rest_at : int
        Where the checksum of all else stands, which covers the seal and is not covered by it.
    """
    gone = joined([(start, start + nbytes) for start, nbytes in values.items() if nbytes])
    labels = of_file(fd, values, (rest_at, rest_at + 4))
    numbers = [len(gone), rest_at, labels, *(number for ends in gone for number in ends)]
    head = SEAL + struct.pack(f"<{len(numbers)}Q", *numbers)
    head += struct.pack("<I", crc32(head))
    length = max(
        SHORTEST_SEAL, -(-(len(head) + len(SEAL)) // LENGTH_STEP) * LENGTH_STEP
    )  # a multiple of three
    return _end_of_hdf5(fd), head + bytes(length - len(head) - len(SEAL)) + SEAL


def seal_is_broken(path: str | os.PathLike[str]) -> bool:
    """Tell, without HDF5, whether a map's labels have changed since they were sealed.

    A file without a seal, of an earlier version or changed by HDF5 since, is not broken.

    Raises
    ------
    OSError
        The file cannot be read.
    """
    fd = os.open(path, os.O_RDONLY | getattr(os, "O_BINARY", 0))
    try:
        size, end = os.fstat(fd).st_size, _end_of_hdf5(fd)
        if size < len(SEAL) or end == size:
            return False
        tail = bytes(read_all(fd, len(SEAL), size - len(SEAL)))
        data = bytes(read_all(fd, size - end, end)) if 0 <= end < size else b""
        if tail != SEAL and not data.startswith(SEAL):
            return False
        count, rest_at, labels = struct.unpack_from("<3Q", data, len(SEAL))
        stop = len(SEAL) + 8 * (2 * count + 3)
        known = SEAL + data[len(SEAL) : stop]
        if data != known + struct.pack("<I", crc32(known)) + bytes(len(data) - stop - 4 - len(SEAL)) + SEAL:
            return True
        ends = struct.unpack_from(f"<{2 * count}Q", data, len(SEAL) + 24)
        gone = {first: last - first for first, last in zip(ends[::2], ends[1::2], strict=True)}
        return bool(of_file(fd, gone | {end: size - end}, (rest_at, rest_at + 4)) != labels)
    except (struct.error, EOFError, OverflowError, ValueError):
        return True
    finally:
        os.close(fd)


def _end_of_hdf5(fd: int) -> int:
    """Return where HDF5's part of a file ends, as its superblock says; the end of a file that has none."""
    size = os.fstat(fd).st_size
    head = bytes(read_all(fd, min(size, 64), 0))
    if not head.startswith(SIGNATURE) or size < 64 or head[VERSION_AT] not in END_AT:
        return size
    return int(struct.unpack_from("<Q", head, END_AT[head[VERSION_AT]])[0])


def read_all(fd: int, count: int, position: int) -> bytearray:
    """Read every byte from a position on, however few the system gives at a time; thread-safe.

    Raises
    ------
    EOFError
        The file ends before the last.
    """
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
    few = [ONE]
    while len(few) <= STEP:
        few.append(_product(few[-1], byte))
    many = [ONE]
    while len(many) <= STEP:
        many.append(_product(many[-1], few[STEP]))
    return np.array(few[:STEP], np.uint32), np.array(many, np.uint32)


def _product(a: Any, b: Any) -> Any:
    """Return a product modulo the polynomial, of numbers or of arrays of them."""
    result = 0
    for _ in range(32):
        result = result ^ b * (a >> 31)
        a = a << 1 & 0xFFFFFFFF
        b = b >> 1 ^ POLYNOMIAL * (b & 1)
    return result
