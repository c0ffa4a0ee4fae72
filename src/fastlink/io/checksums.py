"""Checksums of the values of a map, and of all else in its file.

The values of each variable, as they lie in the file, are divided into blocks of `BLOCK_BYTES`, the last may be
shorter; each has the CRC-32 of zlib. A block may be written in pieces, by any thread, in any order: the CRC of A
followed by B is that of A, shifted by the length of B, plus (modulo 2) that of B.
"""

from __future__ import annotations

import os
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
