"""Put blocks of values in the order of the file, and cut them where its pieces end."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fastlink.io.ranges import Range

__all__ = ["OfThread", "cut"]

#: Designs that are put in order at once: of each value as many as fill a few lines of the cache.
LINES = 32


class OfThread(threading.local):
    """Addends to checksums of designs that a thread has not recorded yet, and its room to put values in order."""

    def __init__(self) -> None:
        self.addends: list[tuple[int, int]] = []
        self._room = np.empty(0, np.uint8)

    def by_value(self, block: NDArray[Any]) -> NDArray[Any]:
        """Return a block value by value, in the room of this thread: it lasts until the next one."""
        rows = block.reshape(len(block), -1)
        if self._room.nbytes < rows.nbytes:
            self._room = np.empty(rows.nbytes, np.uint8)
        result = self._room[: rows.nbytes].view(rows.dtype).reshape(rows.shape[::-1])
        for k in range(0, len(rows), LINES):
            result[:, k : k + LINES] = rows[k : k + LINES].T
        return result


def cut(data: memoryview, places: list[Range]) -> Iterator[tuple[int, memoryview]]:
    """Yield the position of each piece and its bytes, which follow each other."""
    begin = 0
    for position, count in places:
        yield position, data[begin : begin + count]
        begin += count
