"""Go on with the partial file of a run that did not end."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from fastlink.errors import remark
from fastlink.io.checksums import BLOCK_BYTES, add, block_count, of_pieces, read_all
from fastlink.io.dataset import Variable
from fastlink.io.place import SLACK
from fastlink.io.placement import Placement
from fastlink.io.ranges import Range, joined, missing
from fastlink.io.writing import partial_file
from fastlink.io.writing.journal import read_journal
from fastlink.io.writing.skeleton import copy_labels, places_of_values, scratch

__all__ = ["LayOut", "Resumed", "Rows", "SameRows", "first_blocks", "resume"]

LayOut = Callable[[Path], dict[str, int]]
#: Bytes that a thread reads at once, whole blocks.
READ_BYTES = 4 * BLOCK_BYTES


class Rows(Protocol):
    """Tells which rows of a file follow from a design that is evaluated, `length` from each."""

    @property
    def length(self) -> int:
        """How many rows follow from each design."""

    def ranges(self, start: int, stop: int) -> Iterable[Range]:
        """Return the ranges of rows that follow from a range of designs."""

    def evaluated(self, start: int, stop: int) -> Iterable[Range]:
        """Return the ranges of designs that a range of rows follows from."""


class SameRows:
    """The rows of a file whose designs are all evaluated."""

    length = 1

    def ranges(self, start: int, stop: int) -> list[Range]:
        """Return the range itself."""
        return [(start, stop)]

    evaluated = ranges


@dataclass(frozen=True)
class Resumed:
    """A partial file to go on with.

    Attributes
    ----------
    fd : int
        The open file, held.
    offsets : dict
        Where the values of each variable begin.
    ranges : list of (start, stop)
        The designs that are written, and as they were written.
    sums : dict
        The checksums of their values, by block.
    """

    fd: int
    offsets: dict[str, int]
    ranges: list[Range]
    sums: dict[int, int]


def first_blocks(variables: Sequence[Variable]) -> dict[str, int]:
    """Return the number of the first block of each variable."""
    counts = [block_count(variable.nbytes) for variable in variables]
    return {variable.name: sum(counts[:k]) for k, variable in enumerate(variables)}


def resume(
    part: Path,
    run: tuple[str, int, Rows],
    variables: Sequence[Variable],
    lay_out: LayOut,
) -> Resumed | None:
    """Hold the partial file of an earlier run of the same fingerprint, if there is one that can be gone on with.

    Its labels are laid out again, and its values read: designs whose values have changed since are to be written again.

    Parameters
    ----------
    part : Path
        The partial file.
    run : (fingerprint, size, rows)
        The hash of the request, its number of designs to evaluate, and the rows that follow from them.
    variables : sequence of Variable
        Those of the file.
    lay_out : callable
        Lays out the file anew at a path, and returns where the values of each variable begin.
    """
    fingerprint, size, rows = run
    journal = read_journal(part) if fingerprint else None
    if journal is None or journal[0].get("fingerprint") != fingerprint:
        return None
    fd = partial_file.reopened(part)
    if fd is None:
        return None
    about, ranges, sums = journal
    try:
        with scratch() as path:
            offsets = lay_out(path)
            if offsets != about["offsets"]:
                os.close(fd)
                return None
            # its own labels may be torn or changed
            copy_labels(path, fd, places_of_values(offsets, variables))
        partial_file.reserve(fd, SLACK)
        values = _Values(fd, offsets, variables, size, rows)
        whole, found = ranges, values.sums(ranges)  # what was cut off reads as zeros
        wrong = [block for block in sums.keys() | found.keys() if sums.get(block) != found.get(block)]
        if wrong:
            whole = values.without(wrong, whole)
            found = values.sums(whole)
            lost = _count(ranges) - _count(whole)
            remark(f"{part}: the values of {lost:,} designs have changed; they are computed again")
    except BaseException:
        os.close(fd)
        raise
    return Resumed(fd, offsets, whole, found)


class _Values:
    """The values in a partial file.

    Parameters
    ----------
    fd : int
        The open file.
    offsets : mapping of str to int
        Where the values of each variable begin.
    variables : sequence of Variable
        The variables.
    size : int
        The number of designs that are evaluated.
    rows : Rows
        The rows that follow from them.
    """

    def __init__(
        self, fd: int, offsets: Mapping[str, int], variables: Sequence[Variable], size: int, rows: Rows
    ) -> None:
        self.fd, self.offsets, self.variables, self.size, self.rows = fd, offsets, variables, size, rows
        self.first = first_blocks(variables)

    def placement(self, variable: Variable) -> Placement:
        """Return where the values of each design lie."""
        return variable.placement(self.size * self.rows.length)

    def sums(self, ranges: list[Range]) -> dict[int, int]:
        """Return the checksums of the values of some designs, by block."""
        groups = (
            (variable, places)
            for variable in self.variables
            for of_designs in ranges
            for start, stop in self.rows.ranges(*of_designs)
            for places in _groups(self.placement(variable).pieces(start, stop))
        )
        result: dict[int, int] = {}
        with ThreadPoolExecutor() as pool:
            for addends in pool.map(self._of_group, groups):
                add(result, addends)
        return result

    def _of_group(self, group: tuple[Variable, list[Range]]) -> list[tuple[int, int]]:
        variable, places = group
        offset, first = self.offsets[variable.name], self.first[variable.name]
        pieces = ((at, memoryview(read_all(self.fd, count, offset + at))) for at, count in places)
        return [(first + k, addend) for k, addend in of_pieces(pieces, variable.nbytes)]

    def without(self, blocks: list[int], ranges: list[Range]) -> list[Range]:
        """Return ranges without the designs that have values in some blocks."""
        gone = []
        for variable in self.variables:
            first = self.first[variable.name]
            for block in blocks:
                start, stop = ((block - first + k) * BLOCK_BYTES for k in (0, 1))
                if 0 <= start < variable.nbytes:
                    gone += self.placement(variable).rows_in(start, min(stop, variable.nbytes))
        designs = [piece for rows in gone for piece in self.rows.evaluated(*rows)]
        return missing(joined([*missing(ranges, self.size), *designs]), self.size)


def _groups(places: list[Range]) -> Iterator[list[Range]]:
    """Yield pieces of bytes, cut at whole blocks, together as many as are read at once."""
    group, nbytes = list[Range](), 0
    for position, count in places:
        stop = position + count
        for begin in [position, *range((position // READ_BYTES + 1) * READ_BYTES, stop, READ_BYTES)]:
            part = min(READ_BYTES - begin % READ_BYTES, stop - begin)
            if nbytes + part > READ_BYTES:
                yield group
                group, nbytes = [], 0
            group.append((begin, part))
            nbytes += part
    if group:
        yield group


def _count(ranges: list[Range]) -> int:
    return sum(stop - start for start, stop in ranges)
