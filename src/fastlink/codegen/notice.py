"""A line on the terminal while kernels compile."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

__all__ = ["notice"]

#: Seconds after which the line appears that something compiles.
PATIENCE = 0.5
#: Seconds between two kernels that count as one wait.
PAUSE = 0.1
TEXT = "fastlink: compiling kernels, which are kept for next time ..."

#: When the wait at hand began, and when the last kernel was ready.
_began = _ended = float("-inf")


@contextmanager
def notice() -> Iterator[None]:
    """Show a line while something compiles for long, and wipe it out when that is done; on a terminal only."""
    global _began, _ended
    stream = sys.stderr
    if stream is None or not stream.isatty():
        yield
        return
    now = time.monotonic()
    if now - _ended > PAUSE:
        _began = now
    shown = threading.Event()

    def show() -> None:
        with suppress(OSError, ValueError):  # the stream may be closed
            stream.write(f"\r{TEXT}")
            stream.flush()
            shown.set()

    timer = threading.Timer(max(_began + PATIENCE - now, 0.0), show)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()
        if shown.is_set():
            stream.write(f"\r{' ' * len(TEXT)}\r")
            stream.flush()
        _ended = time.monotonic()
