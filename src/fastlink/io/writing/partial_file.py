"""The partial file of a map: its lock, its room and its final name.

No file is ever emptied in place: a name may be a second one of a finished map. A new run makes a new file, and gives it
the name of the partial one.
"""

from __future__ import annotations

import contextlib
import errno
import os
import stat
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeVar

from fastlink.io.checksums import seek_lock
from fastlink.io.place import refused
from fastlink.io.renaming import exclusive_rename
from fastlink.io.writing.journal import journal_of

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


def fresh_name(part: Path) -> Path:
    """Return the name of a partial file while it is laid out."""
    return part.with_name(part.name + ".new")


@contextlib.contextmanager
def claimed(part: Path) -> Iterator[None]:
    """Hold the name of a partial file while a new one is laid out; an old file loses the name.

    Refused when a live process writes it. The name is gone when the body fails.
    """
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
    """Begin a partial file: claim its name, lay the file out, and hold it.

    Parameters
    ----------
    part : Path
        Its name.
    lay : callable
        Makes the file at the path that is given to it.

    Returns
    -------
    fd : int
        The open file.
    result : object
        That of `lay`.
    """
    fresh = fresh_name(part)
    with claimed(part):
        journal_of(part).unlink(missing_ok=True)
        try:
            result = lay(fresh)
            return laid_out(fresh, part), result
        except BaseException:
            fresh.unlink(missing_ok=True)
            raise


def laid_out(fresh: Path, part: Path) -> int:
    """Give a laid-out file the claimed name, hold it, and return its file number."""
    if fcntl is None:
        os.replace(fresh, part)  # an open file cannot be renamed there
        return opened(part)
    return adopt(opened(fresh), fresh, part)


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
    """Hold the partial file of a killed run; return its file number, None if absent.

    A file with a second name is none: it was published, or somebody keeps it. Refused when a live process writes it.
    """
    try:
        fd = _hold(part)
    except FileNotFoundError:
        return None
    if fd is not None and os.fstat(fd).st_nlink != 1:
        os.close(fd)
        return None
    return fd


def held_folder(folder: Path) -> int | None:
    """Hold a folder; return its file number, None where none can be opened. Refused when a live process has it."""
    if fcntl is None:
        return None
    fd = os.open(folder, os.O_RDONLY)
    try:
        _lock(fd, folder)
    except BaseException:
        os.close(fd)
        raise
    return fd


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
    """Give a synchronised partial file its final name; `overwrite` replaces a file.

    The file stays open where it keeps its name, and is closed where it has the final one.
    """
    if fcntl is None:
        os.close(fd)  # an open file cannot be renamed there
        _rename(part, final, overwrite)
        return
    _flock(fd, fcntl.LOCK_SH)  # readers may open it from its first moment on
    _rename(part, final, overwrite)
    with contextlib.suppress(OSError):  # its bytes are on the disk already
        os.close(fd)
    synchronise_folder(final.parent)


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


def _rename(part: Path, final: Path, overwrite: bool) -> None:
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
