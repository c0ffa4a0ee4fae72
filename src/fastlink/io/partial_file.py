"""Partial files: their journal, lock, room and final name, and whether an output may be made."""

from __future__ import annotations

import contextlib
import errno
import json
import os
import signal
import stat
import sys
import threading
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import h5py

from fastlink.errors import KeyPath, Remedy, Setting, check_output
from fastlink.io.checksums import (
    Range,
    add,
    count_of,
    joined_ranges,
    of_file,
    seal,
    seal_is_broken,
    seek_lock,
)
from fastlink.io.layout import FINGERPRINT
from fastlink.io.output_path import (
    SLACK,
    check_writable,
    exclusive_rename,
    exists_error,
    free_bytes,
    no_room,
    not_writable,
    part_of,
    refused,
)
from fastlink.space.tables import FORMAT

# -- Record the designs that a partial file holds, to resume a killed run

# A thread synchronises the file's data while the sweep computes, and then records their designs: whatever
# the journal names is on the disk, even after a power cut. The system would otherwise wait some seconds or
# for much memory to be dirty, and the last fsync would write it all at once.


STEP_BYTES = 32 << 20
STEP_SECONDS = 1.0


def journal_of(part: Path) -> Path:
    """Return the path of the journal of a partial file."""
    return part.with_name(part.name + ".journal")


def fresh_name(path: Path) -> Path:
    """Return the name of a partial file or a journal until it is laid out."""
    return path.with_name(path.name + ".new")


def read_journal(part: Path) -> tuple[dict[str, Any], list[Range], dict[int, int]] | None:
    """Return the head, the written designs and the checksums of their values; None where no journal can be read."""
    # It ends before a record that a kill or a power cut has torn.
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
    return about, joined_ranges(written), sums


def _line(content: Any) -> bytes:
    """Return a line of the journal: JSON and its CRC-32."""
    text = json.dumps(content, separators=(",", ":")).encode()
    return b"%b %08x\n" % (text, zlib.crc32(text))


def _read(line: bytes) -> Any:
    """Return the content of a line, None of one that is torn or changed."""
    text, _, check = line.rpartition(b" ")
    return json.loads(text) if check == b"%08x" % zlib.crc32(text) and text else None


class Journal:
    """A thread that synchronises pending data of a file, then records their designs."""

    # After a failure to synchronise nothing is recorded any more: the system reports it once, and may then
    # take pages for written that are not. `error` keeps it.

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

    def add(self, ranges: Iterable[Range], addends: Iterable[tuple[int, int]]) -> None:
        """Add designs whose every result is written, and what they add to the checksums; thread-safe."""
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
            ranges, self._pending = joined_ranges(self._pending), []
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
            self.recorded = joined_ranges([*self.recorded, *ranges])
        except OSError as error:
            self.error = error

    def _start(self, first: bytes) -> int:
        """Create the journal with its head and first record, and return its open file number."""
        # It replaces that of an earlier run, whose designs the first record names: at no moment are they
        # without one.
        fresh = fresh_name(self._path)
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


# -- The partial file of a map: its lock, its room and its final name

# No file is ever emptied in place: a name may be a second one of a finished map. A new run makes a new
# file, and gives it the name of the partial one.


try:
    import fcntl
except ImportError:  # not POSIX: no locks, and a folder cannot be synchronised
    fcntl = None  # type: ignore[assignment]

R = TypeVar("R")

NO_LOCKS = {errno.ENOSYS, errno.EOPNOTSUPP, errno.ENOLCK}
NO_RESERVE = {errno.EINVAL, errno.EOPNOTSUPP, errno.ENOSYS}
NO_LINK = {errno.EPERM, errno.EOPNOTSUPP, errno.ENOSYS, errno.EMLINK}
#: Neither the system nor the file system can rename without replacing.
NO_EXCLUSIVE_RENAME = {errno.EINVAL, errno.EOPNOTSUPP, errno.ENOSYS, errno.EPERM}


@contextlib.contextmanager
def claimed(part: Path) -> Iterator[None]:
    """Hold the name of a partial file while a new one is laid out; an old file loses the name."""
    # Refused when a live process writes it. The name is gone when the body fails.
    if fcntl is None:
        part.unlink(missing_ok=True)  # refused by the system while another process has it open
        yield
        return
    while (fd := _hold(part, os.O_CREAT)) is None:
        pass
    try:
        if os.fstat(fd).st_size or os.fstat(fd).st_nlink != 1:
            fd = _replaced(fd, part)  # now, and not later: its room may be needed
        yield
    except BaseException:
        part.unlink(missing_ok=True)
        raise
    finally:
        os.close(fd)


def _replaced(fd: int, part: Path) -> int:
    """Replace a held file by an empty one of the same name, and hold that."""
    empty = fresh_name(part)
    try:
        return adopt(create(empty), empty, part)
    finally:
        os.close(fd)


def create(path: Path) -> int:
    """Create an empty file, whatever had its name before, and return its file number."""
    path.unlink(missing_ok=True)
    return opened(path, os.O_CREAT | os.O_EXCL)


def begun(part: Path, lay: Callable[[Path], R]) -> tuple[int, R]:
    """Begin a partial file: claim its name, lay the file out, and hold it."""
    fresh = fresh_name(part)
    with claimed(part):
        journal_of(part).unlink(missing_ok=True)
        try:
            result = lay(fresh)
            if fcntl is not None:
                return adopt(opened(fresh), fresh, part), result
            os.replace(fresh, part)  # an open file cannot be renamed there
            return opened(part), result
        except BaseException:
            fresh.unlink(missing_ok=True)
            raise


def adopt(fd: int, fresh: Path, part: Path) -> int:
    """Give an open file the name of the partial one, and hold it."""
    try:
        _lock(fd, part)  # before it has the name: no moment without a holder
        os.replace(fresh, part)
    except BaseException:
        os.close(fd)
        raise
    return fd


def reopened(part: Path) -> int | None:
    """Hold the partial file of a killed run; return its file number, None if absent."""
    # A file with a second name is none: it was published, or somebody keeps it. Refused when a live process
    # writes it.
    try:
        fd = _hold(part)
    except FileNotFoundError:
        return None
    if fd is not None and os.fstat(fd).st_nlink != 1:
        os.close(fd)
        return None
    return fd


@contextlib.contextmanager
def held_folder(folder: Path) -> Iterator[None]:
    """Hold a folder, where one can be opened; refused when a live process has it."""
    if fcntl is None:
        yield
        return
    fd = os.open(folder, os.O_RDONLY)
    try:
        _lock(fd, folder)
        yield
    finally:
        with contextlib.suppress(OSError):
            os.close(fd)


def reserve(fd: int, extra: int) -> None:
    """Reserve room for a whole file and some more, so that a full disk shows at once."""
    if not hasattr(os, "posix_fallocate"):
        return
    try:
        os.posix_fallocate(fd, 0, os.fstat(fd).st_size + extra)
    except OSError as error:
        if error.errno not in NO_RESERVE:
            raise


def publish(fd: int, part: Path, final: Path, overwrite: bool) -> None:
    """Give a synchronised partial file its final name; `overwrite` replaces a file."""
    # The file stays open where it keeps its name, and is closed where it has the final one.
    if fcntl is None:
        os.close(fd)  # an open file cannot be renamed there
        rename(part, final, overwrite)
        return
    _flock(fd, fcntl.LOCK_SH)  # readers may open it from its first moment on
    rename(part, final, overwrite)
    with contextlib.suppress(OSError):  # its bytes are on the disk already
        os.close(fd)
    synchronise_folder(final.parent)


def write_seal(fd: int, values: Mapping[int, int], rest_at: int, left_out: Mapping[int, int]) -> None:
    """Write the seal of all but values, then the checksum of all but what is left out, which has its own."""
    position, sealed = seal(fd, values, rest_at)
    write_all(fd, memoryview(sealed), position)
    rest = of_file(fd, left_out, (rest_at, rest_at + 4))
    write_all(fd, memoryview(rest.to_bytes(4, sys.byteorder)), rest_at)


def write_all(fd: int, data: memoryview, position: int) -> None:
    """Write every byte at a position, however few the system takes at a time."""
    while data:
        if hasattr(os, "pwrite"):
            count = os.pwrite(fd, data, position)
        else:
            with seek_lock:
                os.lseek(fd, position, os.SEEK_SET)
                count = os.write(fd, data)
        data = data[count:]
        position += count


def discard(fd: int, part: Path) -> None:
    """Remove a partial file, if the system lets it be removed; the next run will replace it."""
    with contextlib.suppress(OSError):
        if fcntl is None:
            os.close(fd)  # an open file cannot be removed there
        part.unlink(missing_ok=True)
    if fcntl is not None:
        with contextlib.suppress(OSError):
            os.close(fd)


@contextlib.contextmanager
def released(fd: int) -> Iterator[None]:
    """Release the lock of a partial file for a moment."""
    if fcntl is None:
        yield
        return
    _flock(fd, fcntl.LOCK_UN)
    try:
        yield
    finally:
        _flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)


def opened(path: Path, flags: int = 0) -> int:
    """Open a file, not what a link leads to."""
    flags |= getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0)
    try:
        fd = os.open(path, os.O_RDWR | flags, 0o666)
    except OSError as error:
        what = {errno.ELOOP: "is a symbolic link", errno.EISDIR: "is a folder"}.get(error.errno or 0)
        if what is None:
            raise
        raise refused(f"{path} {what}", "remove it or choose another name") from None
    if not stat.S_ISREG(os.fstat(fd).st_mode):
        os.close(fd)
        raise refused(f"{path} is not a file", "remove it or choose another name")
    return fd


def _lock(fd: int, part: Path) -> None:
    if fcntl is None:
        return
    try:
        _flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise refused(f"{part}: another run is writing it", "wait for it or choose another name") from None


def _flock(fd: int, operation: int) -> None:
    """Lock or unlock; without locks in the file system, nobody holds any."""
    try:
        fcntl.flock(fd, operation)
    except OSError as error:
        if error.errno not in NO_LOCKS:
            raise


def _hold(part: Path, flags: int = 0) -> int | None:
    """Lock a partial file, and return its file number; None if its name has changed."""
    fd = opened(part, flags)
    try:
        _lock(fd, part)
        if os.path.samestat(os.fstat(fd), os.stat(part)):
            return fd
    except FileNotFoundError:  # its holder gave it its final name meanwhile
        pass
    except BaseException:
        os.close(fd)
        raise
    os.close(fd)
    return None


def rename(part: Path, final: Path, overwrite: bool) -> None:
    """Give a file or a folder its final name; `overwrite` replaces a file, else it fails where the name is taken."""
    if overwrite:
        os.replace(part, final)
        return
    try:
        exclusive_rename()(part, final)  # at no moment has the file two names
    except OSError as error:
        if error.errno not in NO_EXCLUSIVE_RENAME:
            raise
    else:
        return
    try:
        os.link(part, final)  # unlike a rename, fails when the name is taken
    except OSError as error:
        if error.errno not in NO_LINK:
            raise
        if final.exists():
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST)) from None
        os.rename(part, final)
    else:
        part.unlink()


def synchronise_folder(folder: Path) -> None:
    """Make the new name survive a power cut, on file systems that can."""
    with contextlib.suppress(OSError):
        fd = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(fd)
        finally:
            os.close(fd)


def given_back(part: Path) -> int:
    """Return the bytes that replacing an old partial file frees."""
    try:
        status = os.lstat(part)
    except FileNotFoundError:
        return 0
    return getattr(status, "st_blocks", 0) * 512 if status.st_nlink == 1 else 0


# -- The output file of a run: whether it may be made, and what an earlier run left under its name


#: The remedy where a run left what another request would lose.
RESTART: Remedy = (
    "finish that run, choose another name",
    (", or write ", Setting("restart", True), " to throw it away"),
)


def check_target(
    path: str | Path,
    nbytes_needed: int,
    overwrite: bool,
    sources: Sequence[Path] = (),
    named: Callable[[KeyPath, Any], Path] = check_output,
    *,
    at_once: bool = False,
) -> Path:
    """Return the absolute path of an output file, or refuse it, before anything is computed.

    What is made at once, with which no later run goes on, is refused too where a run to that name has left its part of
    a map, which would be lost.
    """
    target = Path(os.path.realpath(named(("to",), path)))
    check_writable(target)
    if target.is_symlink():  # which realpath could not follow
        raise refused(f"{path}: its symbolic links lead back to themselves", "choose another name")
    part = part_of(target)
    try:
        forget_published(target)
        if (fd := reopened(part)) is not None:
            os.close(fd)
    except OSError as error:
        raise not_writable(target, error) from error
    if target.exists() and not overwrite:
        raise exists_error(target)
    if any(target.exists() and target.samefile(source) for source in sources):
        raise refused(f"{path} is a file that is read for it", "choose another name")
    if nbytes_needed + SLACK > free_bytes(target) + given_back(part):
        raise no_room(target, nbytes_needed)
    if at_once:
        check_left(target, "", "finish it by the same run, rename or remove it, or choose another name")
    return target


def forget_published(target: Path) -> None:
    """Remove what a kill left of a map that has its name: the second name, and the journal."""
    part = part_of(target)
    try:
        if os.path.samestat(os.lstat(part), os.lstat(target)):
            part.unlink()
            journal_of(part).unlink(missing_ok=True)
    except FileNotFoundError:  # never to be removed then: another run may begin at this moment
        return


def forget_journal(target: Path) -> None:
    """Remove the journal of a finished map, where the system did not let its run do so."""
    part = part_of(target)
    if target.exists() and not os.path.lexists(part):
        journal_of(part).unlink(missing_ok=True)


def check_left(path: Path, fingerprint: str, remedy: Remedy = RESTART) -> None:
    """Refuse to replace what an earlier run of another request left: its designs, or a whole map."""
    # What is made at once, such as a conversion, is made again, and has no request.
    part = part_of(path)
    journal = read_journal(part)
    if journal is not None and part.exists():
        about, written, _ = journal
        count, size = count_of(written), about.get("size", 0)
        same = about.get("fingerprint") == fingerprint
        whose = "laid out by another version of HDF5" if same else "of another request, or by another version"
        if count:
            raise refused(f"{part} holds {count:,} of {size:,} designs {whose}", remedy)
    elif _request_of(part) not in ("", fingerprint) and part.stat().st_nlink == 1:  # else it has another name
        raise refused(f"{part} is a whole map that has not got its name", remedy)


def _request_of(path: Path) -> str:
    """Return the fingerprint of a finished map, an empty text of what is none or has none."""
    try:
        if seal_is_broken(path):
            return ""
        with h5py.File(path, "r", locking=False) as file:
            return str(file.attrs.get(FINGERPRINT, "")) if FORMAT in file.attrs else ""
    except (OSError, RuntimeError):
        return ""


# -- Let the end of a run pass uninterrupted


@contextlib.contextmanager
def uninterrupted() -> Iterator[None]:
    """Put off an interrupt or a request to end until the body has passed."""
    # Python runs its handlers in the main thread alone: elsewhere nothing can interrupt.
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []

    def note(number: int, frame: Any) -> None:
        came.append(number)

    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    # others are the system's, which end the process at once, or were not set from Python and cannot be set again
    handlers = {number: handler for number, handler in handlers.items() if callable(handler)}
    for number in handlers:
        signal.signal(number, note)
    try:
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
        for came_number in dict.fromkeys(came):
            signal.raise_signal(came_number)
