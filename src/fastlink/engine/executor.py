"""Run a kernel over all designs: blocks handed out to threads, all buffers owned here.

It knows no names and no files: arrays in, arrays out. Blocks are small and taken one by one, because a
static split stalls for a whole time slice when another process holds a core.
"""

from __future__ import annotations

import itertools
import math
import os
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.codegen.runtime.cells import LANES

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.codegen.source import Array

__all__ = ["Job", "Part", "Sink", "aligned", "block_length", "default_threads", "run"]

# Larger blocks leave the caches (two threads gain 1.2 instead of 1.9 at 16 MB), smaller ones pay for being handed out.
BLOCK_BYTES = 4 << 20
BLOCK_DESIGNS = 4096
CACHE_LINE = 64
#: How many kernels' scratch a thread keeps, and of how many bytes at most: those of refined extremes have 1 to 3 MB.
KEPT, KEPT_BYTES = 8, 4 << 20

Fill = Callable[[int, int, "NDArray[Any]"], None]
Sink = Callable[[int, int, "list[NDArray[Any]]"], None]


@dataclass(frozen=True)
class Part:
    """One kernel and what it runs on.

    Attributes
    ----------
    kernel : callable
        A compiled kernel.
    scratch : tuple of Array
        The arrays that it works in.
    inputs : int
        Rows of its design array.
    angles : array (tables, angles)
        Its angle array.
    results : tuple of int
        Which results of the job it gives, in the order of its arguments.
    fill : callable
        ``fill(start, stop, x)`` writes the inputs of designs start to stop into ``x[:, :stop - start]``.
    """

    kernel: Callable[..., None]
    scratch: tuple[Array, ...]
    inputs: int
    angles: NDArray[Any]
    results: tuple[int, ...]
    fill: Fill


@dataclass(frozen=True)
class Job:
    """Kernels that together give all results of all designs.

    Attributes
    ----------
    parts : sequence of Part
        They run one after the other on each block.
    outputs : sequence of (shape, dtype)
        What each design has of each result.
    size : int
        Number of designs.
    """

    parts: Sequence[Part]
    outputs: Sequence[tuple[tuple[int, ...], str]]
    size: int


class _Kept(threading.local):
    """Scratch of this thread's last kernels: its pages take as long to come as one design to be evaluated."""

    def __init__(self) -> None:
        self.arrays: dict[tuple[tuple[tuple[int, ...], str], ...], list[NDArray[Any]]] = {}


_kept = _Kept()


class _Bound:
    """A part with one thread's buffers."""

    def __init__(self, part: Part, length: int) -> None:
        self.part = part
        self.x = aligned((part.inputs, -(-length // LANES) * LANES))
        self.angles = aligned(part.angles.shape)
        self.angles[...] = part.angles
        n_angles = part.angles.shape[1]
        self.needed = tuple((array.lengths(n_angles), array.dtype) for array in part.scratch)
        self.scratch = _kept.arrays.pop(self.needed, []) or [aligned(*array) for array in self.needed]

    def __call__(self, start: int, end: int, arrays: Sequence[NDArray[Any]]) -> None:
        """Evaluate designs start to end into the arrays of the job."""
        count = end - start
        self.part.fill(start, end, self.x)
        # Lanes beyond the last design repeat it; their results are not stored.
        self.x[:, count:] = self.x[:, count - 1 : count]
        results = [arrays[k] for k in self.part.results]
        self.part.kernel(self.x, self.angles, count, self.angles.shape[1], *self.scratch, *results)

    def release(self) -> None:
        """Keep the scratch for this thread's next sweep."""
        if sum(array.nbytes for array in self.scratch) <= KEPT_BYTES:
            _kept.arrays[self.needed] = self.scratch
            while len(_kept.arrays) > KEPT:
                del _kept.arrays[next(iter(_kept.arrays))]


def default_threads() -> int:
    """Return the number of processors this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity is not None else os.cpu_count() or 1


def aligned(shape: tuple[int, ...], dtype: str = "float64") -> NDArray[Any]:
    """Return an uninitialised array that begins on a cache line: stores across two lines take longer."""
    size = math.prod(shape) * np.dtype(dtype).itemsize
    raw = np.empty(size + CACHE_LINE, dtype=np.uint8)
    start = -raw.ctypes.data % CACHE_LINE
    return raw[start : start + size].view(dtype).reshape(shape)


def block_length(job: Job, threads: int) -> int:
    """Return how many designs a block holds: results that fit the cache, and several blocks per thread."""
    row = sum(math.prod(shape) * np.dtype(dtype).itemsize for shape, dtype in job.outputs)
    share = -(-job.size // (4 * threads))
    length = max(1, min(BLOCK_DESIGNS, BLOCK_BYTES // max(row, 1), share))
    return length if length < LANES else length // LANES * LANES


def run(
    job: Job,
    *,
    targets: Sequence[NDArray[Any]] | None = None,
    deliver: Sink | None = None,
    threads: int = 1,
    block: int | None = None,
    todo: Sequence[tuple[int, int]] | None = None,
) -> None:
    """Evaluate every design.

    Parameters
    ----------
    job : Job
        The kernels and their data.
    targets : sequence of array, optional
        Whole result arrays, designs first; results go straight into them. Without, each block has
        buffers of its own.
    deliver : callable, optional
        ``deliver(start, stop, arrays)`` is called for each finished block, from any thread; the arrays
        are reused afterwards.
    threads : int
        Number of threads.
    block : int, optional
        Designs per block; any value gives the same bits.
    todo : sequence of (start, stop), optional
        The designs to evaluate; all unless given.
    """
    length = block or block_length(job, threads)
    ranges = [(0, job.size)] if todo is None else todo
    blocks = ((k, min(k + length, stop)) for start, stop in ranges for k in range(start, stop, length))
    threads = min(threads, max(1, sum(-(-(stop - start) // length) for start, stop in ranges)))
    lock, stop = threading.Lock(), threading.Event()

    def work() -> None:
        parts = [_Bound(part, length) for part in job.parts]
        own = (
            [] if targets is not None else [aligned((length, *shape), dtype) for shape, dtype in job.outputs]
        )
        while not stop.is_set():
            with lock:
                found = next(blocks, None)
            if found is None:
                break
            start, end = found
            arrays = [a[: end - start] for a in own] if targets is None else [a[start:end] for a in targets]
            for part in parts:
                part(start, end, arrays)
            if deliver is not None:
                deliver(start, end, arrays)
        for part in parts:
            part.release()

    if threads == 1:
        work()
        return
    with ThreadPoolExecutor(threads, thread_name_prefix="fastlink") as pool:
        futures = [pool.submit(work) for _ in itertools.repeat(None, threads)]
        try:
            done, _ = wait(futures, return_when=FIRST_EXCEPTION)
            for future in done:
                future.result()
        finally:
            # An exception or Ctrl-C: the other threads finish their block and no more.
            stop.set()
