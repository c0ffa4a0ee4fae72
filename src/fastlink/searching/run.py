"""Run a search: the sweep whose blocks are read and forgotten, then the refinement of what it has kept."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastlink._text import counted
from fastlink.engine.executor import run
from fastlink.engine.needs import check_needs, designs_per_block
from fastlink.engine.sinks import ProgressBar, within
from fastlink.errors import InputError
from fastlink.io.progress import progress_bar
from fastlink.io.ranges import Range, Ranges, joined, missing
from fastlink.precision import DESIGNS
from fastlink.searching.stream import Stream
from fastlink.searching.unfinished import Unfinished

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from fastlink.engine.distributed import Cluster
    from fastlink.io.parts import PartOfMap
    from fastlink.searching.result import Request
    from fastlink.searching.stream import Kept

__all__ = ["finished", "found_by"]


def found_by(
    request: Request,
    *,
    threads: int,
    block: int | None,
    progress: bool | None,
    verify: int | None,
    path: Path | None = None,
    restart: bool = False,
    of: PartOfMap | None = None,
    cluster: Cluster | None = None,
) -> tuple[xr.Dataset, xr.Dataset | None]:
    """Return the designs that a search finds; of a part the rows that it keeps, and what those who join it need.

    Parameters
    ----------
    request : Request
        What is searched for.
    threads, block, progress, verify
        As in `fastlink.sweep`.
    path : Path, optional
        The file of the search, beside which its state is kept.
    restart : bool
        Whether to throw away a state that is there.
    of : PartOfMap, optional
        Which part of the designs is searched; all unless given.
    cluster : Cluster, optional
        Whose workers search, instead of threads of this process.
    """
    stream = Stream(request.resolved, request.kept, request.along)
    unfinished = None if path is None else Unfinished(path, of.fingerprint if of else request.fingerprint)
    if unfinished is not None and restart:
        unfinished.remove()
    earlier = None if unfinished is None else unfinished.read()
    kept, done = earlier if earlier is not None else (stream.nothing(), [])
    started, resumed = time.perf_counter(), int(kept.designs.sum())
    check_needs(request.resolved, threads, block, 0, 0)
    if cluster is not None:
        cluster.check()
    first, last = of.range if of else (0, request.size)
    with ProgressBar(last - first, progress) as bar:
        bar.merge(resumed)
        gathering = _Gathering(unfinished, bar, stream, (first, last), kept, Ranges(done))
        gathering.all(threads, block, cluster)
    stream.settle(kept)
    seconds = time.perf_counter() - started
    about = {"designs_per_second": (last - first - resumed) / seconds, "run_time_s": seconds}
    about |= {"designs_of_earlier_runs": resumed} if resumed else {}
    about |= {"threads": cluster.threads} if cluster else {}
    whole = None
    if of:
        result, whole = request.of_part(stream, kept, of, about), request.whole(stream, kept, verify)
    else:
        if unfinished is not None and not len(kept.rows):
            unfinished.remove()
        verify = (0 if path is None else DESIGNS) if verify is None else verify
        result = finished(request, stream, kept, about, verify=verify, progress=progress)
    if unfinished is not None:
        unfinished.remove()
    return result, whole


def finished(
    request: Request,
    stream: Stream,
    kept: Kept,
    about: Mapping[str, Any],
    *,
    verify: int,
    progress: bool | None,
) -> xr.Dataset:
    """Return the result of a search, refined if it is to be, from what it has kept of all designs.

    Parameters
    ----------
    request, stream, kept
        The search, and what it has kept.
    about : mapping
        What is known of the sweep, as attributes: its time, its threads.
    verify, progress
        As in `fastlink.sweep`.
    """
    if not len(kept.rows):
        raise _nothing(request, stream, kept)
    most = len(kept.rows) if stream.several else min(request.choice.top, len(kept.rows))
    swept, refining = time.perf_counter(), progress_bar(most, " designs refined", progress)
    try:
        result = request.found(stream, kept, verify, refining.update if refining else lambda count: None)
    finally:
        if refining:
            refining.close()
    told, refinement = result.attrs.pop("selection", ""), time.perf_counter() - swept
    result.attrs |= {**request.about(), **request.counts(stream, kept, request.size), **about}
    result.attrs |= {"run_time_s": about["run_time_s"] + refinement, "refinement_time_s": refinement}
    for name in ("configurations", "configurations_per_second", "set_up_time_s"):
        result.attrs.pop(name, None)
    result.attrs["selection"] = f"{request.selection(kept, request.size)}{told}"
    return result


class _Gathered:
    """The best rows of some designs, which a search keeps.

    Parameters
    ----------
    stream : Stream
        Reads their results.
    rows : (start, stop)
        The designs that are searched; others, which kernels evaluate along with them, are left out.
    kept : Kept
        What is kept so far.
    done : Ranges
        Of which evaluated designs.
    """

    def __init__(self, stream: Stream, rows: Range, kept: Kept, done: Ranges) -> None:
        self.stream, self.rows, self.kept, self.done = stream, rows, kept, done

    def take(self, start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        """Read the results of evaluated designs."""
        own, axis = self.stream.nothing(), self.stream.resolved.scaling_axis

        def read(first: int, last: int, found: list[NDArray[Any]]) -> None:
            self.stream.read(first, last, found, own, self.kept)

        clipped = within([self.rows], read)
        (axis.over(clipped) if axis else clipped)(start, stop, arrays)
        self.merge((own, [(start, stop)]))

    def merge(self, report: tuple[Kept, list[Range]]) -> None:
        """Add what is kept of further designs, and which evaluated ones these are."""
        self.stream.merge(self.kept, report[0])
        for one in report[1]:
            self.done.add(*one)

    def report(self) -> tuple[Kept, list[Range]]:
        """Return what is kept, and of which evaluated designs."""
        self.stream.settle(self.kept)
        return self.kept, self.done.joined()


class _Gathering(_Gathered):
    """The same of all designs, in threads or on a cluster; from time to time its state is put beside the file."""

    def __init__(self, unfinished: Unfinished | None, bar: ProgressBar, *given: Any) -> None:
        super().__init__(*given)
        self.unfinished, self.bar, self.lock = unfinished, bar, threading.Lock()

    def twin(self) -> _Gathered:
        """Return an object that gathers in another process, see `fastlink.engine.elsewhere`."""
        stream = Stream(self.stream.resolved, self.stream.choice, self.stream.along)
        return _Gathered(stream, self.rows, stream.nothing(), Ranges())

    def merge(self, report: tuple[Kept, list[Range]]) -> None:
        """Add what is kept of further designs, also by a twin; thread-safe."""
        with self.lock:
            super().merge(report)
            if self.unfinished is not None and self.unfinished.is_due():
                self.unfinished.write(*self.report())
        self.bar.merge(int(report[0].designs.sum()))

    def all(self, threads: int, block: int | None, cluster: Cluster | None) -> None:
        """Evaluate all designs that are not done."""
        resolved, axis, before = self.stream.resolved, self.stream.resolved.scaling_axis, self.done.joined()
        job = resolved.job()
        if axis is not None:
            block = designs_per_block(resolved, threads, block)
        wanted = joined([*axis.evaluated(*self.rows)]) if axis else [self.rows]
        pending = missing(joined([*before, *missing(wanted, job.size)]), job.size)
        try:
            if cluster is not None:
                cluster.run(job, self.take, travels=True, block=block, pending=pending)
            else:
                apart = self.unfinished is not None
                run(job, sink=self.take, threads=threads, block=block, pending=pending, apart=apart)
        except BaseException as error:
            if self.unfinished is not None and (now := self.done.joined()):
                with contextlib.suppress(InputError):
                    self.unfinished.write(*self.report())
                    share = _count(now) / _count(wanted)
                    error.add_note(
                        f"{share:.0%} of the designs are searched, as {self.unfinished.path} says; "
                        "run the same again to go on"
                    )
            raise


def _count(ranges: list[Range]) -> int:
    return sum(stop - start for start, stop in ranges)


def _nothing(request: Request, stream: Stream, kept: Kept) -> InputError:
    """Return the error of a search that has found nothing, with what was in the way."""
    size = request.size * stream.rows.of_design
    reasons = [
        f"{count:,} fail {one.array.name}"
        for one, count in zip(request.choice.wanted, kept.failed.tolist(), strict=True)
        if count
    ]
    reasons += [f"{kept.not_numbers:,} have no number"] if kept.not_numbers else []
    reasons += [f"{kept.infinite:,} are infinite"] if kept.infinite else []
    what = f"none of {counted(size, 'row')} meets all conditions: {', '.join(reasons)}"
    return InputError(
        what, where=("where",), remedy="widen the conditions or the ranges, or search more designs"
    )
