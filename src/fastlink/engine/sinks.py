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


class StatusCounts:
    """Count the designs of each status."""

    def __init__(self, plan: Plan) -> None:
        self.index = [output.name for output in plan.outputs].index("status")
        self.flags = plan.catalogue.facts["status"].flags
        self.counts = np.zeros(max(self.flags) + 1, dtype=np.int64)
        self.lock = threading.Lock()

    def take(self, start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        """Count the designs of a block; thread-safe."""
        counts = np.bincount(arrays[self.index], minlength=self.counts.size)
        with self.lock:
            self.counts += counts

    def attrs(self) -> dict[str, int]:
        """Return the counts as file attributes."""
        return {f"designs_{meaning}": int(self.counts[value]) for value, meaning in self.flags.items()}


class ProgressBar:
    """A progress bar that threads may feed, by default visible on a terminal only."""

    def __init__(self, total: int, visible: bool | None) -> None:
        self.bar = progress_bar(total, " designs", visible)
        self.lock = threading.Lock()

    def take(self, start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        """Show that a block is done; thread-safe."""
        if self.bar is not None:
            with self.lock:
                self.bar.update(stop - start)

    def __enter__(self) -> ProgressBar:
        return self

    def __exit__(self, *error: object) -> None:
        if self.bar is not None:
            self.bar.close()
