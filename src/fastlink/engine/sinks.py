"""What takes the results of a sweep as they come: counts of each status, a progress bar."""

from __future__ import annotations

import sys
import threading
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.engine.executor import Sink
    from fastlink.plan.plan import Plan

__all__ = ["Bar", "StatusCounts", "progress_bar", "tee"]


def tee(*takers: Sink) -> Sink:
    """Return what hands results on to each of several takers."""

    def deliver(start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        for take in takers:
            take(start, stop, arrays)

    return deliver


class StatusCounts:
    """How many designs have each status."""

    def __init__(self, plan: Plan) -> None:
        self.place = [output.name for output in plan.outputs].index("status")
        self.flags = plan.catalogue.facts["status"].flags
        self.counts = np.zeros(max(self.flags) + 1, dtype=np.int64)
        self.lock = threading.Lock()

    def take(self, start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        """Count the designs of a block; thread-safe."""
        found = np.bincount(arrays[self.place], minlength=self.counts.size)
        with self.lock:
            self.counts += found

    def attrs(self) -> dict[str, int]:
        """Return the counts as file attributes."""
        return {f"designs_{meaning}": int(self.counts[value]) for value, meaning in self.flags.items()}


class Bar:
    """A progress bar that threads may feed."""

    def __init__(self, total: int, short_repr: bool) -> None:
        self.bar: Any = None
        if short_repr:
            from tqdm import tqdm  # 15 ms, which nobody waits for who sees no bar

            self.bar = tqdm(total=total, unit=" designs", unit_scale=True, file=sys.stderr)
        self.lock = threading.Lock()

    def take(self, start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        """Show that a block is done; thread-safe."""
        if self.bar is not None:
            with self.lock:
                self.bar.update(stop - start)

    def __enter__(self) -> Bar:
        return self

    def __exit__(self, *error: object) -> None:
        if self.bar is not None:
            self.bar.close()


def progress_bar(total: int, progress: bool | None) -> Bar:
    """Return a bar that is shown if wanted, or by default on a terminal."""
    return Bar(total, sys.stderr.isatty() if progress is None else progress)
