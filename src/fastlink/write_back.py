"""Start writing to the disk while the sweep still computes, so that little is left to wait for at the end."""

from __future__ import annotations

import os
import threading

__all__ = ["WriteBack"]

STEP_BYTES = 32 << 20


class WriteBack:
    """A thread that asks the system to write a file's data each time enough has come.

    Without it the system waits some seconds or for much memory to be dirty, and the last fsync takes it all at
    once. A failure is left to that fsync, which reports it.

    Parameters
    ----------
    fd : int
        An open file; it must stay open until `close`.
    """

    def __init__(self, fd: int) -> None:
        self._fd = fd
        self._pending = 0
        self._closed = False
        self._changed = threading.Condition()
        self._thread: threading.Thread | None = None

    def add(self, nbytes: int) -> None:
        """Take note of bytes written; thread-safe."""
        with self._changed:
            self._pending += nbytes
            if self._pending < STEP_BYTES or self._closed:
                return
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, name="fastlink-write-back", daemon=True)
                self._thread.start()
            self._changed.notify()

    def close(self) -> None:
        """Stop, after the write-back under way."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        if self._thread is not None:
            self._thread.join()

    def _work(self) -> None:
        sync = getattr(os, "fdatasync", os.fsync)
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._closed or self._pending >= STEP_BYTES)
                if self._closed:
                    return
                self._pending = 0
            try:
                sync(self._fd)
            except OSError:
                return
