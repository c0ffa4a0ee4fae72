"""Run a search: the sweep whose blocks are read and forgotten, then the refinement of what it has kept."""

from __future__ import annotations

import contextlib
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastlink._text import counted, joined
from fastlink.engine.executor import run
from fastlink.engine.needs import check_needs, designs_per_block
from fastlink.engine.sinks import ProgressBar
from fastlink.errors import InputError
from fastlink.io.progress import progress_bar
from fastlink.io.ranges import Ranges, missing
from fastlink.precision import DESIGNS
from fastlink.searching.stream import Stream
from fastlink.searching.unfinished import Unfinished

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from fastlink.searching.result import Request
    from fastlink.searching.stream import Kept

__all__ = ["found_by"]


def found_by(
    request: Request,
    *,
    threads: int,
    block: int | None,
    progress: bool | None,
    verify: int | None,
    path: Path | None = None,
    restart: bool = False,
) -> xr.Dataset:
    """Return the designs that a search finds.

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
    """
    stream = Stream(request.resolved, request.kept, request.along)
    unfinished = None if path is None else Unfinished(path, request.fingerprint)
    if unfinished is not None and restart:
        unfinished.remove()
    earlier = None if unfinished is None else unfinished.read()
    kept, done = earlier if earlier is not None else (stream.nothing(), [])
    started = time.perf_counter()
    with ProgressBar(request.resolved.space.size, progress) as bar:
        _read_all(stream, kept, Ranges(done), unfinished, threads=threads, block=block, bar=bar)
    stream.settle(kept)
    sweep_time = time.perf_counter() - started
    if not len(kept.rows):
        if unfinished is not None:
            unfinished.remove()
        raise _nothing(request, stream, kept)
    verify = (0 if path is None else DESIGNS) if verify is None else verify
    most = len(kept.rows) if stream.several else min(request.choice.top, len(kept.rows))
    swept, refining = time.perf_counter(), progress_bar(most, " designs refined", progress)
    try:
        result = request.found(stream, kept, verify, refining.update if refining else lambda count: None)
    finally:
        if refining:
            refining.close()
    about = result.attrs.pop("selection", "")
    axis = request.resolved.scaling_axis
    resumed = sum(stop - start for start, stop in done) * (axis.length if axis else 1)
    rate = (request.resolved.space.size - resumed) / sweep_time
    result.attrs |= {**request.about(), **request.counts(stream, kept), "designs_per_second": rate}
    result.attrs |= {
        "run_time_s": time.perf_counter() - started,
        "refinement_time_s": time.perf_counter() - swept,
    }
    if resumed:
        result.attrs["designs_of_earlier_runs"] = resumed
    for name in ("configurations", "configurations_per_second", "set_up_time_s"):
        result.attrs.pop(name, None)
    aims = joined([str(one) for one in request.choice.objectives])
    of = f"rows by the {aims}, of {counted(request.resolved.space.size, 'design')}"
    what = f"{len(kept.rows):,} of {kept.considered:,} {of}"
    result.attrs["selection"] = f"{what}{about}"
    if unfinished is not None:
        unfinished.remove()
    return result


def _read_all(
    stream: Stream,
    kept: Kept,
    done: Ranges,
    unfinished: Unfinished | None,
    *,
    threads: int,
    block: int | None,
    bar: ProgressBar,
) -> None:
    """Evaluate all designs that are not done, and keep the best."""
    resolved = stream.resolved
    check_needs(resolved, threads, block, 0, 0)
    job, axis, lock = resolved.job(), resolved.scaling_axis, threading.Lock()
    if axis is not None:
        block = designs_per_block(resolved, threads, block)

    def sink(start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        own = stream.nothing()

        def read(first: int, last: int, found: list[NDArray[Any]]) -> None:
            stream.read(first, last, found, own, kept)

        (axis.over(read) if axis else read)(start, stop, arrays)
        with lock:
            stream.merge(kept, own)
            done.add(start, stop)
            if unfinished is not None and unfinished.is_due():
                stream.settle(kept)
                unfinished.write(kept, done.joined())
        bar.merge((stop - start) * (axis.length if axis else 1))

    before = done.joined()
    bar.merge(sum(stop - start for start, stop in before) * (axis.length if axis else 1))
    try:
        pending = missing(before, job.size)
        run(job, sink=sink, threads=threads, block=block, pending=pending, apart=unfinished is not None)
    except BaseException as error:
        if unfinished is not None and (now := done.joined()):
            with contextlib.suppress(InputError):
                stream.settle(kept)
                unfinished.write(kept, now)
                share = sum(stop - start for start, stop in now) / job.size
                error.add_note(
                    f"{share:.0%} of the designs are searched, as {unfinished.path} says; run the same again to go on"
                )
        raise


def _nothing(request: Request, stream: Stream, kept: Kept) -> InputError:
    """Return the error of a search that has found nothing, with what was in the way."""
    size = request.resolved.space.size * stream.rows.of_design
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
