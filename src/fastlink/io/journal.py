"""Which designs of a partial file are written, kept beside it, so that a killed run goes on where it was.

A thread brings the file's data to the disk while the sweep computes, and then notes which designs they are of: what the
journal names is there, even after a power cut. The system would otherwise wait some seconds or for much memory to be
dirty, and the last fsync would take it all at once.
"""

from __future__ import annotations

import json
import os
import struct
import threading
import zlib
from pathlib import Path
from typing import Any

__all__ = ["Journal", "Range", "joined", "journal_of", "missing", "read_journal"]

STEP_BYTES = 32 << 20
STEP_SECONDS = 1.0
RECORD = struct.Struct("<QQI")

Range = tuple[int, int]


def journal_of(part: Path) -> Path:
    """Return where the journal of a partial file is."""
    return part.with_name(part.name + ".journal")


def read_journal(part: Path, fingerprint: str) -> tuple[dict[str, Any], list[Range]] | None:
    """Return what a journal says of its run, and which designs are written; None where it is of another run.

    A record that a kill or a power cut has torn ends it.
    """
    try:
        head, _, records = journal_of(part).read_bytes().partition(b"\n")
        about = json.loads(head)
    except (OSError, ValueError):
        return None
    if not isinstance(about, dict) or about.get("fingerprint") != fingerprint:
        return None
    done = []
    for start, stop, check in RECORD.iter_unpack(records[: len(records) // RECORD.size * RECORD.size]):
        if check != _check(start, stop):
            break
        done.append((start, stop))
    return about, joined(done)


def joined(ranges: list[Range]) -> list[Range]:
    """Return ranges in order, those that touch as one.

    Examples
    --------
    >>> joined([(4, 6), (0, 2), (2, 4), (8, 9)])
    [(0, 6), (8, 9)]
    """
    result: list[Range] = []
    for start, stop in sorted(ranges):
        if result and start <= result[-1][1]:
            result[-1] = result[-1][0], max(stop, result[-1][1])
        else:
            result.append((start, stop))
    return result


def missing(done: list[Range], size: int) -> list[Range]:
    """Return what of 0 to `size` is not in ranges in order.

    Examples
    --------
    >>> missing([(0, 6), (8, 9)], 12)
    [(6, 8), (9, 12)]
    """
    ends = [0, *(stop for _, stop in done)]
    starts = [*(start for start, _ in done), size]
    return [(a, b) for a, b in zip(ends, starts, strict=True) if a < b]


def _check(start: int, stop: int) -> int:
    return zlib.crc32(struct.pack("<QQ", start, stop))


class Journal:
    """A thread that synchronises a file's data each time enough has come, and then notes what they are.

    A failure to synchronise is left to the last fsync, which reports it; nothing is noted then.

    Parameters
    ----------
    fd : int
        The partial file, open until `close`.
    part : Path
        Its name.
    about : dict
        What the journal says of the run: its fingerprint, and whatever finds the data again.
    done : list of (start, stop)
        What is written already.
    """

    def __init__(self, fd: int, part: Path, about: dict[str, Any], done: list[Range]) -> None:
        self._fd = fd
        self._path = journal_of(part)
        self._head = json.dumps(about).encode() + b"\n"
        self._pending_bytes = 0
        self._pending: list[Range] = list(done)
        self._own: int | None = None
        self._failed = self._closed = False
        self._changed = threading.Condition()
        self._thread: threading.Thread | None = None

    def add_bytes(self, count: int) -> None:
        """Take note of bytes that were written; thread-safe."""
        with self._changed:
            self._pending_bytes += count
            if self._thread is None and not self._closed:
                self._thread = threading.Thread(target=self._work, name="fastlink-journal", daemon=True)
                self._thread.start()
            if self._pending_bytes >= STEP_BYTES:
                self._changed.notify()

    def add(self, start: int, stop: int) -> None:
        """Take note of designs of which all is written; thread-safe."""
        with self._changed:
            self._pending.append((start, stop))

    def close(self, *, keep: bool) -> None:
        """Stop: note what was written if the partial file is kept, else remove the journal."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        if self._thread is not None:
            self._thread.join()
        if keep:
            self._commit()
        if self._own is not None:
            os.close(self._own)
            self._own = None
        if not keep:
            self._path.unlink(missing_ok=True)

    def _work(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(
                    lambda: self._closed or self._pending_bytes >= STEP_BYTES, timeout=STEP_SECONDS
                )
                if self._closed:
                    return
            self._commit()

    def _commit(self) -> None:
        with self._changed:
            # before the data are synchronised: what comes meanwhile is for the next time
            ranges, self._pending = joined(self._pending), []
            nbytes, self._pending_bytes = self._pending_bytes, 0
        if self._failed or not (ranges or nbytes):
            return
        try:
            _synchronise(self._fd)
            if not ranges:
                return
            if self._own is None:
                self._own = self._start()
            os.write(self._own, b"".join(RECORD.pack(a, b, _check(a, b)) for a, b in ranges))
            _synchronise(self._own)
        except OSError:
            self._failed = True

    def _start(self) -> int:
        """Begin a journal under its name, with its head on the disk."""
        fresh = self._path.with_name(self._path.name + ".new")
        fresh.write_bytes(self._head)
        os.replace(fresh, self._path)
        return os.open(self._path, os.O_RDWR | os.O_APPEND | getattr(os, "O_BINARY", 0))


def _synchronise(fd: int) -> None:
    getattr(os, "fdatasync", os.fsync)(fd)
