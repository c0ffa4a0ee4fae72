"""Run kernels over all designs, in blocks that threads take one by one.

It knows neither names nor files: arrays in, arrays out. Blocks are small, because a static
split stalls for a whole time slice when another process holds a core.
"""

from __future__ import annotations

import math
import os
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.codegen.runtime.cells import LANES
from fastlink.engine.binding import BoundKernel, KernelTask, aligned
from fastlink.threads import work_in_threads

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.engine.sizes import BlockUnits, UnitsOfDesigns

__all__ = [
    *("BLOCK_BYTES", "Job", "Shapes", "Sink", "block_length", "default_threads", "row_bytes", "run"),
]

# Larger blocks leave the caches (two threads gain 1.2 instead of 1.9 at 16 MB), smaller ones pay for being handed out.
BLOCK_BYTES = 4 << 20
BLOCK_DESIGNS = 4096

Sink = Callable[[int, int, "list[NDArray[Any]]"], None]
#: Of each result: the lengths of its axes besides the design, and its dtype.
Shapes = Sequence[tuple[tuple[int, ...], str]]


@dataclass(frozen=True)
class Job:
    """Kernels that together give all results of all designs.

    Attributes
    ----------
    tasks : sequence of KernelTask
        They run one after the other on each block.
    shapes : sequence of (shape, dtype)
        Of each result.
    size : int
        Number of designs.
    units : UnitsOfDesigns, optional
        Those of designs that are far from 1.
    """

    tasks: Sequence[KernelTask]
    shapes: Shapes
    size: int
    units: UnitsOfDesigns | None = None


def default_threads() -> int:
    """Return the number of processors this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity is not None else os.cpu_count() or 1


def row_bytes(shapes: Shapes) -> int:
    """Return the bytes of all results of one design."""
    return sum(math.prod(shape) * np.dtype(dtype).itemsize for shape, dtype in shapes)


def block_length(shapes: Shapes, size: int, threads: int, nbytes: int = BLOCK_BYTES) -> int:
    """Return the designs per block: results fit the cache, or so many bytes, and threads get several."""
    share = -(-size // (4 * threads))
    length = max(1, min(BLOCK_DESIGNS, nbytes // max(row_bytes(shapes), 1), share))
    return length if length < LANES else length // LANES * LANES


def run(
    job: Job,
    *,
    targets: Sequence[NDArray[Any]] | None = None,
    sink: Sink | None = None,
    threads: int = 1,
    block: int | None = None,
    pending: Sequence[tuple[int, int]] | None = None,
    apart: bool = False,
) -> None:
    """Evaluate every design.

    Parameters
    ----------
    job : Job
        The kernels and their data.
    targets : sequence of array, optional
        Result arrays of all designs, designs first; results go straight into them. Without them, each thread has
        buffers of its own.
    sink : callable, optional
        ``sink(start, stop, arrays)`` is called for each finished block, from any thread; the arrays
        are reused afterwards.
    threads : int
        Number of threads.
    block : int, optional
        Designs per block; any value gives the same bits.
    pending : sequence of (start, stop), optional
        The designs to evaluate; all unless given.
    apart : bool
        Whether the calling thread evaluates nothing itself: an interrupt may leave a writer's lock in its hands,
        on which the writer's own thread would wait for ever.
    """
    ranges = [(0, job.size)] if pending is None else pending
    size = sum(stop - start for start, stop in ranges)
    length = min(block or block_length(job.shapes, size, threads), max(1, size))
    blocks = ((k, min(k + length, stop)) for start, stop in ranges for k in range(start, stop, length))
    threads = min(threads, max(1, sum(-(-(stop - start) // length) for start, stop in ranges)))
    lock, stop = threading.Lock(), threading.Event()

    def work() -> None:
        kernels = [BoundKernel(task, length) for task in job.tasks]
        shapes = enumerate(job.shapes if targets is None else ())
        own = [aligned((length, *shape), dtype, k) for k, (shape, dtype) in shapes]
        while not stop.is_set():
            with lock:
                start, end = next(blocks, (0, 0))
            if start == end:
                break
            arrays = [a[: end - start] for a in own] if targets is None else [a[start:end] for a in targets]
            units = None if job.units is None else job.units.at(start, end)
            for kernel in kernels:
                _evaluate(kernel, start, end, arrays, units)
            if units is not None:
                units.leave(arrays)
            if sink is not None:
                sink(start, end, arrays)
        for kernel in kernels:
            kernel.release()

    if threads == 1 and not apart:
        work()
        return
    # any number of threads gives the same bits
    work_in_threads(work, threads, "fastlink", stop)


def _evaluate(
    kernel: BoundKernel, start: int, end: int, arrays: Sequence[NDArray[Any]], units: BlockUnits | None
) -> None:
    """Evaluate designs start to end into the arrays of the job."""
    count = end - start
    kernel.task.fill(start, end, kernel.designs)
    if units is not None:
        units.enter(kernel.task.inputs, kernel.designs)
    # Lanes beyond the last design repeat it; their results are not stored.
    kernel.designs[:, count:] = kernel.designs[:, count - 1 : count]
    kernel.bind([arrays[k] for k in kernel.task.results])(count)
