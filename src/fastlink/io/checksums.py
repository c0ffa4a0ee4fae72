"""Checksums of the values of a map, and of all else in its file.

The values of each variable, as they lie in the file, are divided into blocks of `BLOCK_BYTES`, the last may be
shorter; each has the CRC-32 of zlib. A block may be written in pieces, by any thread, in any order: the CRC of A
followed by B is that of A, shifted by the length of B, plus (modulo 2) that of B.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterable, Iterator, Mapping
from functools import cache, lru_cache
from typing import Any

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
    "of_piece",
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


def of_piece(data: Any, position: int, nbytes: int) -> Iterator[tuple[int, int]]:
    """Yield what a piece of the values of a variable adds to the checksums of its blocks.

    Parameters
    ----------
    data : buffer of bytes
        The piece.
    position : int
        Where it begins, in bytes from the first value.
    nbytes : int
        Bytes of all values.

    Yields
    ------
    block : int
    addend : int
    """
    end = position + len(data)
    for block in range(position // BLOCK_BYTES, block_count(end)):
        start, stop = block * BLOCK_BYTES, min((block + 1) * BLOCK_BYTES, nbytes)
        part = data[max(start - position, 0) : stop - position]
        yield block, _shifted(crc32(part), stop - min(stop, end))


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


@lru_cache(maxsize=4096)
def _power_of_x(nbytes: int) -> int:
    """Return x to the number of bits, modulo the polynomial."""
    result, k = ONE, 3
    while nbytes:
        if nbytes & 1:
            result = _product(_powers()[k % 32], result)  # x^(2^32) is x^1
        nbytes, k = nbytes >> 1, k + 1
    return result


def _shifted(crc: int, nbytes: int) -> int:
    """Return the CRC as if so many more bytes followed, without what they add."""
    return _product(_power_of_x(nbytes), crc) if nbytes else crc


@cache
def _powers() -> tuple[int, ...]:
    """Return x^(2^k) modulo the polynomial."""
    result = [ONE >> 1]
    while len(result) < 32:
        result.append(_product(result[-1], result[-1]))
    return tuple(result)


def _product(a: int, b: int) -> int:
    """Return a product modulo the polynomial."""
    result = 0
    while a:
        if a & ONE:
            result ^= b
        a = a << 1 & 0xFFFFFFFF
        b = b >> 1 ^ POLYNOMIAL if b & 1 else b >> 1
    return result
