"""Evaluate ranges of designs on a worker of a cluster, and report."""

from __future__ import annotations

import contextlib
import platform
import threading
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._version import __version__
from fastlink.codegen.cache import environment
from fastlink.engine.elsewhere import unpacked
from fastlink.engine.executor import Job, block_length, run
from fastlink.engine.sinks import into
from fastlink.errors import InputError
from fastlink.io.writing.elsewhere import NotHereError

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["SAME_VERSION", "Report", "about", "difference", "evaluate_range"]

#: Sweeps whose kernels a worker keeps.
KEPT = 4
SAME_VERSION = "install the version of this process on all workers"


@dataclass(frozen=True)
class Report:
    """The report of a task.

    Attributes
    ----------
    seconds : float
        How long the evaluation took.
    reports : list
        What the twins of the sink's travellers have gathered; None where the results come back instead.
    arrays : list of array
        The results, where they come back.
    """

    seconds: float
    reports: list[Any] | None
    arrays: list[NDArray[Any]] = field(default_factory=list)


def about() -> tuple[str, str, str]:
    """Return the version of fastlink, the hash of what makes and runs kernels, and the version of Python."""
    return __version__, environment().hex(), ".".join(platform.python_version_tuple()[:2])


_loading = threading.Lock()
_jobs: dict[str, Job] = {}


def _job(data: bytes, name: str) -> Job:
    """Return the job of a sweep; its kernels are compiled, or loaded from the cache, once in this process."""
    with _loading:
        if name not in _jobs:
            _jobs[name] = unpacked(data)[0]
            while len(_jobs) > KEPT:
                del _jobs[next(iter(_jobs))]
        return _jobs[name]


def evaluate_range(
    data: tuple[bytes, bytes | None], name: str, start: int, stop: int, *, block: int | None, same: Any
) -> Report:
    """Evaluate designs on a worker.

    Parameters
    ----------
    data : (job, sink)
        As packed by `fastlink.engine.elsewhere`; None for a sink that does not travel.
    name : str
        The name of the sweep.
    start, stop : int
        Range of designs.
    block : int, optional
        Designs per block.
    same : tuple
        What `about` must return here.
    """
    if about() != same:
        raise InputError(f"a worker {difference(about(), same)}", where=("client",), remedy=SAME_VERSION)
    job = _job(data[0], name)
    length = min(block or block_length(job.shapes, job.size, 1), stop - start)
    options: dict[str, Any] = {"block": length, "pending": [(start, stop)]}
    if data[1] is not None:
        sink, twins = unpacked(data[1])
        with contextlib.suppress(NotHereError), contextlib.ExitStack() as stack:
            for twin in twins:
                if isinstance(twin, contextlib.AbstractContextManager):
                    stack.enter_context(twin)
            started = time.perf_counter()
            run(job, sink=sink, **options)
            seconds = time.perf_counter() - started
            return Report(seconds, [twin.report() for twin in twins])
    arrays = [np.empty((stop - start, *shape), dtype) for shape, dtype in job.shapes]
    keep = into(arrays)
    started = time.perf_counter()
    run(job, sink=lambda first, last, results: keep(first - start, last - start, results), **options)
    return Report(time.perf_counter() - started, None, arrays)


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
