"""Time a request on a sample of its designs, to say beforehand how long all of them take."""

from __future__ import annotations

import contextlib
import statistics
import tempfile
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.engine.executor import Job, Sink, default_threads, row_bytes, run
from fastlink.engine.needs import designs_per_block
from fastlink.io.writing.partial_file import write_all
from fastlink.precision import Verification
from fastlink.space.design_space import sampled

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.engine.resolve import ResolvedSweep

__all__ = ["Timing", "timing_of"]

#: Seconds after which no more designs are evaluated, and bytes of results after which no more are.
PATIENCE, MOST_BYTES = 0.03, 64 << 20
#: The middle one of so many times counts: a time slice of another process, of some 10 ms, is in few of them.
REPEATS = 5
#: So many input positions are evaluated; the time of more grows in proportion.
MOST_POSITIONS = 4096
#: Pieces of the design space that are looked at, for designs that do not assemble take less time.
PIECES = 16
#: Designs that are computed again with 50 digits.
VERIFIED, SEED = 2, 0
#: Seconds that a file takes besides its values, for each of its variables: laying it out, reading its labels again.
FILE_SECONDS = 0.02


@dataclass(frozen=True)
class Timing:
    """The expected time of a request in seconds, measured on a sample of its designs.

    Attributes
    ----------
    evaluation : float
        Evaluating all designs, and writing them where there is a file.
    verification : float
        Computing some of them again with 50 digits.
    file : float
        Making the file.
    designs, positions : int
        How many designs were timed, and at how many input positions.
    """

    evaluation: float
    verification: float
    file: float
    designs: int
    positions: int

    @property
    def total(self) -> float:
        """All of it, besides compiling."""
        return self.evaluation + self.verification + self.file


def timing_of(
    request: ResolvedSweep,
    *,
    threads: int | None = None,
    block: int | None = None,
    verify: int = 0,
    folder: Path | None = None,
) -> Timing:
    """Time a sample of the designs of a request; kernels that are not compiled yet are compiled first.

    Parameters
    ----------
    request : ResolvedSweep
        The request.
    threads, block, verify
        As in `fastlink.sweep`.
    folder : Path, optional
        The folder of its file; there, a file without a name is written for a moment.
    """
    threads = threads or default_threads()
    for kernel in request.kernels:
        kernel.compiled(request.backend)
    total = request.positions.size
    sample = replace(request, positions=request.positions[:MOST_POSITIONS])
    started = time.perf_counter()
    job = sample.job()
    tables = time.perf_counter() - started
    length = designs_per_block(sample, threads, block)
    with _Scratch(job, folder if request.space.size > 1 else None) as scratch:
        axis = request.scaling_axis
        sink = scratch.write if axis is None else axis.over(scratch.write)
        seconds, designs = _evaluated(sample, job, sink, threads, length)
    growth = total / sample.positions.size if request.plan.uses_position else 1.0
    return Timing(
        growth * (tables + seconds / designs * job.size),
        _verification(request, verify),
        0.0 if folder is None else FILE_SECONDS * (len(request.plan.outputs) + len(request.space.names)),
        designs,
        sample.positions.size if request.plan.uses_position else 0,
    )


def _evaluated(sample: ResolvedSweep, job: Job, sink: Sink, threads: int, length: int) -> tuple[float, int]:
    """Evaluate more and more designs from all over the space; return the time of the last, and their number."""
    row = row_bytes(job.shapes) * (1 if sample.scaling_axis is None else sample.scaling_axis.length)
    most = max(1, min(job.size, MOST_BYTES // row))
    count = min(most, 2 * length)
    run(job, sink=sink, threads=threads, block=length, pending=_spread(job.size, 1))

    def timed(pending: list[tuple[int, int]]) -> float:
        started = time.perf_counter()
        run(job, sink=sink, threads=threads, block=length, pending=pending)
        return time.perf_counter() - started

    pending = _spread(job.size, count)
    while timed(pending) < PATIENCE and count < most:
        count = min(most, 4 * count)
        pending = _spread(job.size, count)
    seconds = statistics.median(timed(pending) for _ in range(REPEATS))
    return seconds, sum(stop - start for start, stop in pending)


def _spread(size: int, count: int) -> list[tuple[int, int]]:
    """Return ranges of about so many designs, evenly spread over all."""
    pieces = min(PIECES, count)
    each = -(-count // pieces)
    starts = np.linspace(0, size - each, pieces).astype(np.int64).tolist()
    ends = [0, *(start + each for start in starts)]
    return [
        (max(start, end), start + each)
        for start, end in zip(starts, ends, strict=False)
        if end < start + each
    ]


class _Scratch:
    """A file without a name that takes results for a moment, over and over; where there is none, memory.

    Parameters
    ----------
    job : Job
        The results.
    folder : Path or None
        Where the file is to be.
    """

    def __init__(self, job: Job, folder: Path | None) -> None:
        self.stack, self.folder = contextlib.ExitStack(), folder
        self.lock, self.position, self.fd = threading.Lock(), 0, -1

    def __enter__(self) -> _Scratch:
        if self.folder is not None:
            with contextlib.suppress(OSError):
                self.fd = self.stack.enter_context(tempfile.TemporaryFile(dir=self.folder)).fileno()
        return self

    def __exit__(self, *error: object) -> None:
        self.stack.close()

    def write(self, start: int, stop: int, arrays: Sequence[NDArray[Any]]) -> None:
        """Write the results of a block, as a sink does."""
        for array in arrays:
            if self.fd < 0:
                array.copy()
                continue
            with self.lock:
                position = self.position
                self.position = (position + array.nbytes) % MOST_BYTES
            with contextlib.suppress(OSError):  # a full disk is refused elsewhere
                write_all(self.fd, array.reshape(-1).view(np.uint8).data, position)


def _verification(request: ResolvedSweep, verify: int) -> float:
    """Return the expected time of the verification, from that of a few designs."""
    space, count = request.space, min(verify, request.space.size)
    if not count:
        return 0.0
    columns = space.at(space.some(VERIFIED, np.random.default_rng(SEED)))
    few = replace(request, space=sampled("table", {}, columns, {}), scaling_axis=None)
    job = few.job()
    arrays = [np.empty((job.size, *shape), dtype) for shape, dtype in job.shapes]
    run(job, targets=arrays)
    verification = Verification(few.plan, few.space, few.positions, job.size)
    verification.collect(0, job.size, arrays)
    return verification.expected_time(count)
