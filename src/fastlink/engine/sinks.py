"""Sinks, which receive the results of a sweep, and the memory that a sweep needs, counted beforehand."""

from __future__ import annotations

import math
import threading
from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import size as human_size
from fastlink.codegen.runtime.cells import LANES
from fastlink.engine.run import BLOCK_BYTES, Shapes, Sink, block_length, row_bytes
from fastlink.errors import InputError, Remedy, Setting
from fastlink.io.checksums import Range, joined_ranges
from fastlink.io.output_path import progress_bar
from fastlink.machine import ALWAYS_FITS, check_memory
from fastlink.space.design_space import DESIGN, Column
from fastlink.space.tables import MAPS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.codegen.kernel import Kernel
    from fastlink.engine.resolve import ResolvedSweep
    from fastlink.plan.programs import Plan


# -- Sinks, which receive the results of a sweep block by block, from any thread


def tee(*sinks: Sink) -> Sink:
    """Return a sink that passes results on to each of several sinks."""

    def pass_on(start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        for sink in sinks:
            sink(start, stop, arrays)

    return pass_on


def into(targets: Sequence[NDArray[Any]]) -> Sink:
    """Return a sink that copies results into the arrays of all designs."""

    def copy(start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        for target, array in zip(targets, arrays, strict=True):
            target[start:stop] = array

    return copy


def within(ranges: Sequence[Range], sink: Sink, first: int = 0) -> Sink:
    """Return a sink that passes on the results of designs in some ranges alone, numbered from `first` on."""

    def clip(start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        for k in range(max(bisect_right(starts, start) - 1, 0), bisect_left(starts, stop)):
            begin, end = max(start, ordered[k][0]), min(stop, ordered[k][1])
            if begin < end:
                sink(begin - first, end - first, [array[begin - start : end - start] for array in arrays])

    ordered = joined_ranges(list(ranges))
    starts = [begin for begin, _ in ordered]
    return clip


class StatusCounts:
    """Count the designs of each status."""

    def __init__(self, plan: Plan) -> None:
        self.flags = plan.catalogue.facts["status"].flags
        self.index = [output.name for output in plan.outputs].index("status")
        self.counts = np.zeros(max(self.flags) + 1, dtype=np.int64)
        self.lock = threading.Lock()

    def take(self, start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        """Count the designs of a block; thread-safe."""
        found = np.bincount(arrays[self.index].ravel(), minlength=len(self.counts))
        with self.lock:
            self.counts += found

    def attrs(self) -> dict[str, int]:
        """Return the counts as file attributes."""
        return {f"designs_{meaning}": int(self.counts[value]) for value, meaning in self.flags.items()}


class ProgressBar:
    """A progress bar that threads may feed, by default visible on a terminal only."""

    def __init__(self, total: int, visible: bool | None, what: str = " designs") -> None:
        self.bar = progress_bar(total, what, visible)
        self.lock = threading.Lock()

    def take(self, start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        """Show that a block is done; thread-safe."""
        self.merge(stop - start)

    def merge(self, count: int) -> None:
        """Show that designs are done; thread-safe."""
        if self.bar is not None:
            with self.lock:
                self.bar.update(count)

    def __enter__(self) -> ProgressBar:
        return self

    def __exit__(self, *error: object) -> None:
        if self.bar is not None:
            self.bar.close()


# -- The memory that a sweep needs, counted before anything of it is allocated


#: Buffers are small without a look at the kernels, up to so many positions, designs per block and verified designs.
FEW = 5_000
#: Bytes of a block that is written value by value: each value of its designs is a piece of the file, and the longer the
#: fewer.
MAPS_BYTES = 8 * BLOCK_BYTES
#: The remedy for a result that does not fit memory.
TO_FILE: Remedy = (
    *("write it to a file with ", Setting("to", "maps.h5")),
    ", or ask for fewer quantities, designs or positions",
)


@dataclass(frozen=True)
class Needs:
    """The bytes that a sweep takes at most, besides those of its design space."""

    #: All results.
    values: int
    #: Results of the blocks under way, scratch of the kernels and tables of the input position, for all
    #: threads.
    buffers: int
    #: Coordinates that the design space does not hold already.
    labels: int
    #: Coordinates that are computed where they are looked at: a file gets them block by block.
    columns: int
    #: The designs that are computed again, and their results.
    verification: int

    @property
    def in_memory(self) -> int:
        """All of it, for a result that stays in memory."""
        return self.values + self.columns + self.to_file

    @property
    def to_file(self) -> int:
        """All but the results and coordinates that a file gets block by block."""
        return self.buffers + self.labels + self.verification


def designs_per_block(resolved: ResolvedSweep, threads: int, block: int | None = None) -> int:
    """Return how many designs are evaluated at once: the given number, else as many as fit the cache."""
    axis = resolved.scaling_axis
    size = resolved.evaluated.size
    if block is not None:
        return max(1, min(block, size))
    length = block_length(resolved.shapes, size, threads, bytes_at_once(resolved))
    return length if axis is None or resolved.layout == MAPS else max(1, length // axis.length)


def bytes_at_once(resolved: ResolvedSweep) -> int:
    """Return how many bytes of results a thread writes at once."""
    return MAPS_BYTES if resolved.layout == MAPS else BLOCK_BYTES


def needs_of(resolved: ResolvedSweep, threads: int, block: int | None = None, verify: int = 0) -> Needs:
    """Return the memory that a sweep takes."""
    space, row = resolved.space, row_bytes(resolved.shapes)
    length = designs_per_block(resolved, threads, block)
    threads = max(1, min(threads, -(-resolved.evaluated.size // length)))
    of_block = sum(_buffer_bytes(kernel, length, resolved.positions.size) for kernel in resolved.kernels)
    of_block += length * row
    shared = sum(len(kernel.program.tables) for kernel in resolved.kernels) * resolved.positions.nbytes
    if resolved.layout == MAPS:  # in their new order
        of_block += max(row_bytes([of_result]) for of_result in resolved.shapes) * length
    if resolved.scaling_axis is not None:  # a piece of the results at several values of the axis
        of_block += max(bytes_at_once(resolved), length * row)
        shared += sum(factor.nbytes for factor in resolved.scaling_axis.factors if factor is not None)
    sample = min(verify, space.size) * (2 * row + 8 * len(space.names))
    numbers = 8 * space.shape[space.dims.index(DESIGN)] if DESIGN in space.dims else 0
    computed = [one for one in (*space.columns.values(), *space.labels.values()) if isinstance(one, Column)]
    columns, of_block = 0, threads * of_block
    if computed:  # with the numbers of the designs, and a block of each
        columns, numbers = numbers + sum(column.nbytes for column in computed), 0
        of_block += threads * length * (8 + sum(column.dtype.itemsize for column in computed))
    labels = numbers + resolved.positions.nbytes
    return Needs(row * space.size, of_block + shared, labels, columns, sample)


def _buffer_bytes(kernel: Kernel, length: int, positions: int) -> int:
    """Return the bytes of a kernel's designs, its table of angles and its scratch, of one thread."""
    lanes = -(-length // LANES) * LANES
    doubles = len(kernel.program.inputs) * lanes + len(kernel.program.tables) * positions
    arrays = kernel.source.scratch
    scratch = (math.prod(one.lengths(positions)) * np.dtype(one.dtype).itemsize for one in arrays)
    return 8 * doubles + sum(scratch)


def check_needs(resolved: ResolvedSweep, threads: int, block: int | None, verify: int, values: int) -> None:
    """Refuse a sweep that needs more memory than there is, before it runs; a small one is not looked at (1 us)."""
    few = resolved.positions.size < FEW and verify < FEW and (block is None or block < FEW)
    if few and values < ALWAYS_FITS // 2:
        return
    needs = needs_of(resolved, threads, block, verify)
    what = "a sweep of so many input positions, designs per block or verified designs"
    check_memory(needs.to_file, what, remedy="ask for fewer, or for fewer threads")
    if values:
        check_memory(needs.in_memory, "the result", remedy=TO_FILE)


def allocated(shapes: Shapes, size: int) -> list[NDArray[Any]]:
    """Return an array for each result of so many designs, or refuse them where the system does."""
    try:
        return [np.empty((size, *shape), dtype) for shape, dtype in shapes]
    except (MemoryError, ValueError):  # ValueError: more bytes than an address has
        what = f"the result needs {human_size(row_bytes(shapes) * size)} of memory, which this system refuses"
        raise InputError(what, remedy=TO_FILE) from None
