"""Record the designs that a partial file holds, to resume a killed run.

A thread synchronises the file's data while the sweep computes, and then records their designs: whatever the journal
names is on the disk, even after a power cut. The system would otherwise wait some seconds or for much memory to be
dirty, and the last fsync would write it all at once.
"""

from __future__ import annotations

import contextlib
import json
import os
import threading
import zlib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from fastlink.io.checksums import add
from fastlink.io.ranges import Range, joined

__all__ = ["Journal", "journal_of", "read_journal", "synchronise"]

STEP_BYTES = 32 << 20
STEP_SECONDS = 1.0


def journal_of(part: Path) -> Path:
    """Return the path of the journal of a partial file."""
    return part.with_name(part.name + ".journal")


def read_journal(part: Path) -> tuple[dict[str, Any], list[Range], dict[int, int]] | None:
    """Return the head, the written designs and the checksums of their values; None where no journal can be read.

    It ends before a record that a kill or a power cut has torn.
    """
    try:
        head, *lines = journal_of(part).read_bytes().split(b"\n")
    except OSError:
        return None
    about = _read(head)
    if not isinstance(about, dict):
        return None
    written: list[Range] = []
    sums: dict[int, int] = {}
    for line in lines:
        record = _read(line)
        if record is None:
            break
        written += [(start, stop) for start, stop in record[0]]
        add(sums, record[1])
    return about, joined(written), sums


def _line(content: Any) -> bytes:
    """Return a line of the journal: JSON and its CRC-32."""
    text = json.dumps(content, separators=(",", ":")).encode()
    return b"%b %08x\n" % (text, zlib.crc32(text))


def _read(line: bytes) -> Any:
    """Return the content of a line, None of one that is torn or changed."""
    text, _, check = line.rpartition(b" ")
    return json.loads(text) if check == b"%08x" % zlib.crc32(text) and text else None


class Journal:
    """A thread that synchronises pending data of a file, then records their designs.

    After a failure to synchronise nothing is recorded any more: the system reports it once, and may then take pages for
    written that are not. `error` keeps it.

    Parameters
    ----------
    fd : int
        The partial file, open until `close`.
    part : Path
        Its name.
    about : dict
        The head of the journal: the fingerprint of the run, and the offsets of its data.
    written : list of (start, stop)
        The designs that are written already, which the journal of an earlier run names.
    sums : mapping of int to int
        The checksums of their values, by block.
    """

    def __init__(
        self, fd: int, part: Path, about: dict[str, Any], written: list[Range], sums: Mapping[int, int]
    ) -> None:
        self._fd = fd
        self._path = journal_of(part)
        self._head = _line(about)
        self._pending_bytes = 0
        self._pending: list[Range] = list(written)
        self._sums = dict(sums)
        self._journal_fd: int | None = None
        self._closed = False
        self.error: OSError | None = None
        #: The designs that the journal names, this one or that of the earlier run until this one takes its place.
        self.recorded: list[Range] = list(written)
        self._changed = threading.Condition()
        self._thread: threading.Thread | None = None

    def add_bytes(self, count: int) -> None:
        """Count bytes that were written; thread-safe."""
        with self._changed:
            self._pending_bytes += count
            if self._thread is None and not self._closed:
                self._thread = threading.Thread(target=self._work, name="fastlink-journal", daemon=True)
                self._thread.start()
            if self._pending_bytes >= STEP_BYTES:
                self._changed.notify()

    def add(self, start: int, stop: int, addends: Iterable[tuple[int, int]]) -> None:
        """Add designs whose every result is written, and what they add to the checksums; thread-safe."""
        with self._changed:
            self._pending.append((start, stop))
            add(self._sums, addends)

    def add_all(self, ranges: Iterable[Range], addends: Iterable[tuple[int, int]]) -> None:
        """Add several ranges of designs at once; thread-safe."""
        with self._changed:
            self._pending += ranges
            add(self._sums, addends)

    def close(self) -> None:
        """Synchronise all data, and record the last designs."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        if self._thread is not None:
            self._thread.join()
        self._commit()
        fd, self._journal_fd = self._journal_fd, None
        if fd is not None:
            try:
                os.close(fd)
            except OSError as error:
                self.error = self.error or error

    def remove(self) -> None:
        """Remove the journal of a file that has its name, or that is thrown away."""
        with contextlib.suppress(OSError):  # the next run removes what is left
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
            # before the data are synchronised: designs that come meanwhile wait for the next time
            ranges, self._pending = joined(self._pending), []
            sums, self._sums = self._sums, {}
            nbytes, self._pending_bytes = self._pending_bytes, 0
        if self.error or not (ranges or nbytes):
            return
        try:
            synchronise(self._fd)
            if not ranges:
                return
            line = _line([ranges, list(sums.items())])
            if self._journal_fd is None:
                self._journal_fd = self._start(line)
            else:
                _append(self._journal_fd, memoryview(line))
                synchronise(self._journal_fd)
            self.recorded = joined([*self.recorded, *ranges])
        except OSError as error:
            self.error = error

    def _start(self, first: bytes) -> int:
        """Create the journal with its head and first record, and return its open file number.

        It replaces that of an earlier run, whose designs the first record names: at no moment are they without one.
        """
        fresh = self._path.with_name(self._path.name + ".new")
        fresh.unlink(missing_ok=True)  # never through a link
        try:
            with open(fresh, "xb") as file:
                file.write(self._head + first)
                file.flush()
                os.fsync(file.fileno())
            os.replace(fresh, self._path)
        except OSError:
            with contextlib.suppress(OSError):
                fresh.unlink(missing_ok=True)
            raise
        return os.open(self._path, os.O_RDWR | os.O_APPEND | getattr(os, "O_BINARY", 0))


def _append(fd: int, data: memoryview) -> None:
    """Append every byte, however few the system takes at a time."""
    while data:
        data = data[os.write(fd, data) :]


def synchronise(fd: int) -> None:
    """Bring the data of a file to the disk."""
    getattr(os, "fdatasync", os.fsync)(fd)
