"""Run kernels over all designs, in blocks that threads take one by one, each with buffers of its own."""

from __future__ import annotations

import math
import os
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.codegen.kernel import MachineCode, load_kernel
from fastlink.codegen.runtime.cells import LANES
from fastlink.machine import work_in_threads

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.codegen.source import Source
    from fastlink.engine.scaling import FarDesigns


# -- Bind kernels to the buffers of one thread: designs, angles, scratch, results


#: Bytes; the last is an odd number of lines, so that all lines of a page have their turn.
CACHE_LINE, PAGE, SKEW = 64, 4096, 9 * 64
#: Designs in the longest vector of a processor: a kernel reads no design beyond the last such group.
VECTOR = 8
#: Index of the number of designs in the table of addresses: after two arrays with a length each.
COUNT = 4
#: A thread keeps the scratch of so many kernels, each of so many bytes at most: extremes of rates need 1 to
#: 3 MB, of forces 14.
KEPT, KEPT_BYTES = 8, 16 << 20

Fill = Callable[[int, int, "NDArray[Any]"], None]


@dataclass(frozen=True)
class KernelTask:
    """One kernel of a request, compiled, with the data that it runs on."""

    #: Its text.
    source: Source
    #: The rows of its designs.
    inputs: tuple[str, ...]
    #: What compiles it.
    backend: str
    #: Its machine code, which does not travel: another process compiles the text, or has it in its cache.
    code: Callable[..., None]
    #: Its angle array.
    angles: NDArray[Any]
    #: Which results of the job it gives, in the order of its arguments.
    results: tuple[int, ...]
    #: ``fill(start, stop, x)`` writes the inputs of designs start to stop into ``x[:, :stop - start]``.
    fill: Fill

    @classmethod
    def loaded(cls, source: Source, inputs: tuple[str, ...], backend: str, *data: Any) -> KernelTask:
        """Return a task whose machine code is compiled or loaded here."""
        return cls(source, inputs, backend, load_kernel(source, backend), *data)

    def __reduce__(self) -> tuple[Any, ...]:
        data = self.angles, self.results, self.fill
        return KernelTask.loaded, (self.source, self.inputs, self.backend, *data)


class _KeptScratch(threading.local):
    """Scratch of this thread's last kernels."""

    # To get its pages takes as long as to evaluate one design.

    def __init__(self) -> None:
        self.arrays: dict[tuple[tuple[tuple[int, ...], str], ...], list[NDArray[Any]]] = {}


_scratch = _KeptScratch()


class BoundKernel:
    """A kernel with the buffers of one thread."""

    def __init__(self, task: KernelTask, block: int) -> None:
        self.task, self.block = task, block
        #: The inputs, to be filled before a run; lanes beyond the last design repeat it.
        self.designs = aligned((len(task.inputs), -(-block // LANES) * LANES))
        self.angles = aligned(task.angles.shape)
        self.angles[...] = task.angles
        n_angles = task.angles.shape[1]
        self.layout = tuple((a.lengths(n_angles), a.dtype) for a in task.source.scratch)
        self.scratch = _scratch.arrays.pop(self.layout, []) or [aligned(*array) for array in self.layout]

    def arguments(self, results: Sequence[NDArray[Any]]) -> list[Any]:
        """Return the arguments of the kernel for a whole block."""
        return [self.designs, self.angles, self.block, self.angles.shape[1], *self.scratch, *results]

    def bind(self, results: Sequence[NDArray[Any]]) -> Callable[[int], None]:
        """Return ``run(count)``, which evaluates the first designs into arrays."""
        # The table of their addresses is filled once.
        code, arguments = self.task.code, self.arguments(results)
        if not isinstance(code, MachineCode):
            rest = arguments[3 : len(arguments) - len(results)]
            return lambda count: code(
                self.designs, self.angles, count, *rest, *(result[:count] for result in results)
            )
        table = code.table(*arguments)
        call, address = code.call, table.ctypes.data

        def run(count: int) -> None:
            table[COUNT] = count
            call(address)

        return run

    def release(self) -> None:
        """Keep the scratch for the next kernel of this thread that needs the same."""
        if sum(array.nbytes for array in self.scratch) <= KEPT_BYTES:
            _scratch.arrays[self.layout] = self.scratch
            while len(_scratch.arrays) > KEPT:
                del _scratch.arrays[next(iter(_scratch.arrays))]


def aligned(shape: tuple[int, ...], dtype: str = "float64", number: int | None = None) -> NDArray[Any]:
    """Return an uninitialised array on a cache line: stores across two take longer."""
    # Results have a number, and each begins elsewhere in its page: the first cache has 8 or 12 lines for each
    # place in pages, and where nine curves began at one, reactions took 1.1 to 1.2 times as long.
    size = math.prod(shape) * np.dtype(dtype).itemsize
    room = CACHE_LINE if number is None else PAGE
    raw = np.empty(size + room, dtype=np.uint8)
    start = ((number or 0) * SKEW - raw.ctypes.data) % room
    return raw[start : start + size].view(dtype).reshape(shape)


# -- Run kernels over all designs, in blocks that threads take one by one

# It knows neither names nor files: arrays in, arrays out. Blocks are small, because a static split stalls
# for a whole time slice when another process holds a core.


# Larger blocks leave the caches (two threads gain 1.2 instead of 1.9 at 16 MB), smaller ones pay for being handed out.
BLOCK_BYTES = 4 << 20
BLOCK_DESIGNS = 4096

Sink = Callable[[int, int, "list[NDArray[Any]]"], None]
#: Of each result: the lengths of its axes besides the design, and its dtype.
Shapes = Sequence[tuple[tuple[int, ...], str]]


@dataclass(frozen=True)
class Job:
    """Kernels that together give all results of all designs."""

    #: They run one after the other on each block.
    tasks: Sequence[KernelTask]
    #: Of each result.
    shapes: Shapes
    #: Number of designs.
    size: int
    #: The designs with numbers beyond the range, which have no results.
    far: FarDesigns | None = None


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


class Runner:
    """The kernels of a job with the buffers of one thread; results go to arrays of its own, or of all designs."""

    def __init__(self, job: Job, block: int, targets: Sequence[NDArray[Any]] | None = None) -> None:
        self.job, self.targets = job, targets
        self.kernels = [BoundKernel(task, block) for task in job.tasks]
        shapes = enumerate(job.shapes if targets is None else ())
        self.results = [aligned((block, *shape), dtype, k) for k, (shape, dtype) in shapes]
        self._calls = (
            [] if targets is not None else [self._bound(kernel, self.results) for kernel in self.kernels]
        )

    def run(self, count: int) -> None:
        """Evaluate the first designs that stand in the rows of the kernels."""
        for call in self._calls:
            call(count)

    def evaluate(self, start: int, end: int) -> list[NDArray[Any]]:
        """Evaluate designs start to end of the job, and return their results."""
        count, far = end - start, None if self.job.far is None else self.job.far.at(start, end)
        for kernel in self.kernels:
            kernel.task.fill(start, end, kernel.designs)
            if far is not None:
                kernel.designs[:, :count][:, far] = np.nan
            # Lanes beyond the last design repeat it; their results are not stored.
            kernel.designs[:, count:] = kernel.designs[:, count - 1 : count]
        if self.targets is None:
            arrays = [array[:count] for array in self.results]
            self.run(count)
        else:
            arrays = [array[start:end] for array in self.targets]
            for kernel in self.kernels:
                self._bound(kernel, arrays)(count)
        if self.job.far is not None and far is not None:
            self.job.far.flag(arrays, far)
        return arrays

    def release(self) -> None:
        """Keep the scratch of all kernels for the next runner of this thread."""
        for kernel in self.kernels:
            kernel.release()

    @staticmethod
    def _bound(kernel: BoundKernel, arrays: Sequence[NDArray[Any]]) -> Callable[[int], None]:
        return kernel.bind([arrays[k] for k in kernel.task.results])


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
    """Evaluate every design."""
    ranges = [(0, job.size)] if pending is None else pending
    size = sum(stop - start for start, stop in ranges)
    length = min(block or block_length(job.shapes, size, threads), max(1, size))
    blocks = ((k, min(k + length, stop)) for start, stop in ranges for k in range(start, stop, length))
    threads = min(threads, max(1, sum(-(-(stop - start) // length) for start, stop in ranges)))
    lock, stop = threading.Lock(), threading.Event()

    def work() -> None:
        runner = Runner(job, length, targets)
        while not stop.is_set():
            with lock:
                start, end = next(blocks, (0, 0))
            if start == end:
                break
            arrays = runner.evaluate(start, end)
            if sink is not None:
                sink(start, end, arrays)
        runner.release()

    if threads == 1 and not apart:
        work()
        return
    # any number of threads gives the same bits
    work_in_threads(work, threads, "fastlink", stop)
