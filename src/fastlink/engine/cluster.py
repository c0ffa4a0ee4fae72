"""Run kernels on the workers of a dask.distributed cluster: tasks, and what comes back of them."""

from __future__ import annotations

import asyncio
import concurrent.futures
import contextlib
import itertools
import json
import math
import pickle
import platform
import queue
import socket
import threading
import time
import uuid
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from fastlink._text import __version__, short_repr
from fastlink.codegen.cache import environment
from fastlink.codegen.runtime.cells import LANES
from fastlink.engine.run import Job, Sink, block_length, row_bytes, run
from fastlink.engine.sinks import into
from fastlink.errors import InputError, KeyPath, Problems, remark, require_package
from fastlink.io.checksums import Range, count_of
from fastlink.io.output_path import reason
from fastlink.io.writer import NotSeenError

if TYPE_CHECKING:
    from distributed import Client, Future
    from numpy.typing import NDArray


class Keeper(Protocol):
    """What a worker keeps of the results of one task, picklable before it has any; it may be a context manager."""

    def report(self) -> Any:
        """Return what was kept, which travels back."""


# -- Evaluate ranges of designs on a worker of a cluster, and report


#: Sweeps whose kernels a worker keeps.
KEPT = 4
SAME_VERSION = "install the version of this process on all workers"


@dataclass(frozen=True)
class Report:
    """The seconds of a task, and what its keeper reports; the results where it has none, or cannot see the file."""

    seconds: float
    kept: Any = None
    arrays: list[NDArray[Any]] | None = None


def about() -> tuple[str, str, str]:
    """Return the version of fastlink, the hash of what makes and runs kernels, and the version of Python."""
    return __version__, environment().hex(), ".".join(platform.python_version_tuple()[:2])


_loading = threading.Lock()
_jobs: dict[str, Job] = {}


def _job(data: bytes, name: str) -> Job:
    """Return the job of a sweep; its kernels are compiled, or loaded from the cache, once in this process."""
    with _loading:
        if name not in _jobs:
            _jobs[name] = pickle.loads(data)
            while len(_jobs) > KEPT:
                del _jobs[next(iter(_jobs))]
        return _jobs[name]


def evaluate_range(
    data: tuple[bytes, bytes | None], name: str, start: int, stop: int, *, block: int | None, same: Any
) -> Report:
    """Evaluate designs on a worker."""
    if about() != same:
        raise InputError(f"a worker {difference(about(), same)}", ("client",), SAME_VERSION)
    job = _job(data[0], name)
    length = min(block or block_length(job.shapes, job.size, 1), stop - start)
    options: dict[str, Any] = {"block": length, "pending": [(start, stop)]}
    if data[1] is not None:
        sink, keeper = pickle.loads(data[1])
        is_context = isinstance(keeper, contextlib.AbstractContextManager)
        with contextlib.suppress(NotSeenError), keeper if is_context else contextlib.nullcontext():
            started = time.perf_counter()
            run(job, sink=sink, **options)
            seconds = time.perf_counter() - started
            return Report(seconds, keeper.report())
    arrays = [np.empty((stop - start, *shape), dtype) for shape, dtype in job.shapes]
    keep = into(arrays)
    started = time.perf_counter()
    run(job, sink=lambda first, last, results: keep(first - start, last - start, results), **options)
    return Report(time.perf_counter() - started, arrays=arrays)


def difference(found: Any, same: tuple[str, str, str]) -> str:
    """Return what is wrong with a worker, from what `about` returns there and here."""
    if isinstance(found, ImportError):
        return f"cannot import fastlink ({found})"
    if isinstance(found, BaseException):
        return f"cannot run fastlink ({type(found).__name__}: {found})"
    if found[2] != same[2]:
        return f"runs Python {found[2]}, and this process {same[2]}"
    if found[0] != same[0]:
        return f"has fastlink {found[0]}, and this process {same[0]}"
    return f"has another state of fastlink {found[0]} than this process"


# -- Run kernels over all designs on the workers of a dask.distributed cluster, range by range

# A worker that sees the file that is written writes its results into it and reports what that adds to the
# checksums, and the client reads there, at the end, what else it needs of them; from another the results come back.
# Which of both is found out in each task, by the worker itself. The bits are those of one thread: a range is
# evaluated by `fastlink.engine.run.run`, as here.


#: Seconds within which a scheduler answers.
ANSWERED_SECONDS = 10.0
#: Seconds of work in one task, at least: a lost worker loses this.
TASK_SECONDS = 1.0
#: Seconds that a task costs the client, whatever its length (1.6 to 2.0 ms measured); the share of its time for them.
TASK_COST, CLIENT_SHARE = 2e-3, 0.5
#: Most bytes of results in one task: where any have come back, and where workers have kept all so far.
TASK_BYTES, TASK_BYTES_KEPT = 32 << 20, 256 << 20
#: Tasks per thread of the workers that are handed out at once: one under way, one that waits for it.
AHEAD = 2
#: Designs of the first tasks, of which nothing is known; the next ones have at most so many times those before, and at
#: least this part of their seconds.
FIRST_DESIGNS, GROWTH, LEAST = 64, 8, 0.1
#: Seconds to wait for a report before a look at the number of workers.
PATIENCE = 0.5
#: Seconds for which the number of the workers' threads is believed.
KNOWN_SECONDS = 2.0
#: A cluster may lose what it was given so many times in a row without any result.
LOSSES = 5


def connected(where: KeyPath, address: str) -> Client:
    """Return a client of the scheduler at an address, or of that whose file is at a path."""
    require_package("distributed", where)
    from distributed import Client
    from distributed.comm import get_address_host_port

    try:
        if Path(address).is_file():
            address = json.loads(Path(address).read_text())["address"]
        # a client that nobody answers takes half a minute, and is loud
        socket.create_connection(get_address_host_port(address), ANSWERED_SECONDS).close()
        return Client(address, timeout=ANSWERED_SECONDS)
    except Exception as error:  # of all kinds, by what is wrong with the text
        what = f"no scheduler answers at {short_repr(address)} ({reason(error) or type(error).__name__})"
        remedy = "write the address that `dask scheduler` prints, such as tcp://10.0.0.1:8786, or its scheduler file"
        raise InputError(what, where, remedy) from None


class Cluster:
    """The workers of a client, for one sweep."""

    def __init__(self, client: Client) -> None:
        self.client = client
        self._known = -math.inf, 0

    @property
    def threads(self) -> int:
        """Number of threads of all workers, of which each runs one task at a time; not asked for at every call."""
        when, threads = self._known
        if time.monotonic() - when > KNOWN_SECONDS:
            threads = sum(self.client.nthreads().values())
            self._known = time.monotonic(), threads
        return threads

    def check(self) -> None:
        """Refuse workers without fastlink, or with another version; wait for the first worker."""
        if not self.threads:
            remark("the cluster has no workers yet; the sweep waits for the first", ("client",))
            self.client.wait_for_workers(1)
        same, problems = about(), Problems()
        for address, found in sorted(self.client.run(about, on_error="return").items()):
            if found != same:
                problems.add(f"the worker {address} {difference(found, same)}", ("client",), SAME_VERSION)
        problems.stop()

    def run(
        self,
        job: Job,
        sink: Sink,
        *,
        remote: tuple[Sink, Keeper, Callable[[Any], None]] | None = None,
        block: int | None = None,
        pending: Sequence[Range] | None = None,
    ) -> None:
        """Evaluate every design, as `fastlink.engine.run.run`; on any exception, what is under way is cancelled."""
        # `remote` is a sink for the workers, what it feeds, and what takes the reports of that here; `sink`
        # takes the results that come back.
        import cloudpickle

        data = cloudpickle.dumps(job), None if remote is None else cloudpickle.dumps(remote[:2])
        tasks = _Tasks(self, data, block)
        ranges = _Pending([(0, job.size)] if pending is None else pending)
        length = _Length(job)

        def take(start: int, stop: int, report: Report) -> None:
            if report.arrays is not None:
                length.bytes = TASK_BYTES
                sink(start, stop, report.arrays)
            elif remote is not None:
                remote[2](report.kept)

        # not in this thread, for the reason that `apart` of `fastlink.engine.run.run` has
        with concurrent.futures.ThreadPoolExecutor(1, "fastlink-take") as taker:
            try:
                while ranges.left or tasks.under_way:
                    while ranges.left and len(tasks.under_way) < AHEAD * max(self.threads, 1):
                        tasks.submit(*ranges.take(length.next(ranges.left, self.threads)))
                        if not tasks.done.empty():  # which says how long the next one is to be
                            break
                    for start, stop, report in tasks.finished():
                        length.learn(stop - start, report.seconds)
                        taker.submit(take, start, stop, report).result()
            finally:
                tasks.cancel()


class _Pending:
    """Designs that are not handed out yet."""

    def __init__(self, ranges: Sequence[Range]) -> None:
        self.ranges = list(reversed([(start, stop) for start, stop in ranges if start < stop]))
        self.left = count_of(self.ranges)

    def take(self, most: int) -> Range:
        """Return the next designs, at most so many."""
        start, stop = self.ranges.pop()
        end = min(start + most, stop)
        if end < stop:
            self.ranges.append((end, stop))
        self.left -= end - start
        return start, end


class _Length:
    """How many designs make a task, by the last report."""

    # A task takes one thread `TASK_SECONDS`, and on many threads longer: so long that the client, to whom
    # each costs `TASK_COST`, has time for all of them.

    def __init__(self, job: Job) -> None:
        self.row, self.bytes = max(row_bytes(job.shapes), 1), TASK_BYTES_KEPT
        self.length, self.rate, self.trusted = FIRST_DESIGNS, 0.0, FIRST_DESIGNS

    def next(self, left: int, threads: int) -> int:
        """Return the number of the next task: towards the end fewer, so that no thread has nothing to do."""
        threads = max(threads, 1)
        share, least = -(-left // (AHEAD * threads)), 1.0
        most = max(1, (self.bytes if self.rate else TASK_BYTES) // self.row)
        if self.rate:
            pace = TASK_COST * threads  # of tasks that long the client is just not the slowest
            self.length = int(self.rate * max(TASK_SECONDS, pace / CLIENT_SHARE))
            least = self.rate * max(TASK_SECONDS * LEAST, pace)
        self.length = max(1, min(self.length, self.trusted, most))
        length = int(max(1, min(self.length, max(share, least))))
        return length if length < LANES else length // LANES * LANES

    def learn(self, designs: int, seconds: float) -> None:
        """Take account of how long a task of so many designs took."""
        self.rate, self.trusted = designs / max(seconds, 1e-6), GROWTH * max(self.length, designs)


class _Tasks:
    """The tasks of a sweep that are handed out."""

    def __init__(self, cluster: Cluster, data: tuple[bytes, bytes | None], block: int | None) -> None:
        self.client, self.data, self.block = cluster.client, data, block
        self.name, self.numbers = uuid.uuid4().hex, itertools.count()
        self.under_way: dict[Future, Range] = {}
        self.done: queue.SimpleQueue[Future] = queue.SimpleQueue()
        self.losses = 0
        self._scatter()

    def _scatter(self) -> None:
        self.client.wait_for_workers(1)  # a scatter does not wait long
        (self.scattered,) = self.client.scatter([self.data], broadcast=True, hash=False)

    def submit(self, start: int, stop: int) -> None:
        """Hand out a range of designs."""
        key, how = f"fastlink-{self.name}-{next(self.numbers)}", {"block": self.block, "same": about()}
        data = self.scattered, self.name, start, stop
        future = self.client.submit(evaluate_range, *data, **how, key=key, pure=False)
        self.under_way[future] = start, stop
        future.add_done_callback(self.done.put)

    def finished(self) -> Iterator[tuple[int, int, Report]]:
        """Yield the ranges that are done and their reports, after a short wait for the first."""
        with contextlib.suppress(queue.Empty):
            future = self.done.get(timeout=PATIENCE)
            start, stop = self.under_way.pop(future)
            if future.status == "error":
                raise self._failure(start, stop, future.exception())
            try:
                report = future.result()
            except (concurrent.futures.CancelledError, asyncio.CancelledError):
                self._again(start, stop)
                return
            self.losses = 0
            yield start, stop, report

    def _again(self, start: int, stop: int) -> None:
        """Hand out designs again whose task or data the cluster has lost."""
        if self.client.status != "running" or self.losses >= LOSSES:
            raise InputError("the cluster has lost its tasks", ("client",), "look at its log")
        if self.scattered.status != "finished":
            self.losses += 1
            self._scatter()
        self.submit(start, stop)

    def _failure(self, start: int, stop: int, error: BaseException | None) -> BaseException:
        """Return the error of a task in the words of the sweep."""
        if isinstance(error, InputError):
            return error
        if isinstance(error, ImportError):
            return InputError(f"a worker {difference(error, about())}", ("client",), SAME_VERSION)
        if type(error).__name__ == "KilledWorker":
            what = f"workers die of designs {start} to {stop - 1}: {error}"
            return InputError(what, ("client",), "give workers more memory, or look at their log")
        if isinstance(error, OSError):
            return InputError(f"a worker cannot write the file ({error})", ("to",), "choose another place")
        return error or RuntimeError(f"designs {start} to {stop - 1} have failed on a worker")

    def cancel(self) -> None:
        """Cancel what is under way; what a worker has begun it ends, to the same bits."""
        with contextlib.suppress(Exception):
            self.client.cancel(list(self.under_way), force=True)
        self.under_way.clear()
