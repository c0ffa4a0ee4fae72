"""Sinks, which receive the results of a sweep block by block, from any thread."""

from __future__ import annotations

import threading
from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.io.progress import progress_bar
from fastlink.io.ranges import joined

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.engine.executor import Sink
    from fastlink.io.ranges import Range
    from fastlink.plan.plan import Plan

__all__ = ["ProgressBar", "StatusCounts", "into", "tee", "within"]


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

    ordered = joined(list(ranges))
    starts = [begin for begin, _ in ordered]
    return clip


_counting = threading.Lock()


class _Counts:
    """Numbers of designs by the value of a result.

    Parameters
    ----------
    index : int
        Which result.
    size : int
        More than its greatest value.
    """

    def __init__(self, index: int, size: int) -> None:
        self.index, self.size = index, size
        self.counts = np.zeros(size, dtype=np.int64)

    def take(self, start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        """Count the designs of a block; thread-safe."""
        self.merge(np.bincount(arrays[self.index], minlength=self.size))

    def merge(self, counts: NDArray[Any]) -> None:
        """Add numbers; thread-safe."""
        with _counting:
            self.counts += counts

    def report(self) -> NDArray[Any]:
        """Return the numbers."""
        return self.counts


class StatusCounts(_Counts):
    """Count the designs of each status."""

    def __init__(self, plan: Plan) -> None:
        self.flags = plan.catalogue.facts["status"].flags
        super().__init__([output.name for output in plan.outputs].index("status"), max(self.flags) + 1)

    def twin(self) -> _Counts:
        """Return an object that counts in another process, see `fastlink.engine.elsewhere`."""
        return _Counts(self.index, self.size)

    def attrs(self) -> dict[str, int]:
        """Return the counts as file attributes."""
        return {f"designs_{meaning}": int(self.counts[value]) for value, meaning in self.flags.items()}


class _Done:
    """Count designs."""

    def __init__(self) -> None:
        self.count = 0

    def take(self, start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        """Count the designs of a block."""
        self.count += stop - start

    def report(self) -> int:
        """Return their number."""
        return self.count


class ProgressBar:
    """A progress bar that threads may feed, by default visible on a terminal only."""

    def __init__(self, total: int, visible: bool | None) -> None:
        self.bar = progress_bar(total, " designs", visible)
        self.lock = threading.Lock()

    def take(self, start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        """Show that a block is done; thread-safe."""
        self.merge(stop - start)

    def merge(self, count: int) -> None:
        """Show that designs are done; thread-safe."""
        if self.bar is not None:
            with self.lock:
                self.bar.update(count)

    def twin(self) -> _Done:
        """Return an object that counts designs in another process."""
        return _Done()

    def __enter__(self) -> ProgressBar:
        return self

    def __exit__(self, *error: object) -> None:
        if self.bar is not None:
            self.bar.close()
