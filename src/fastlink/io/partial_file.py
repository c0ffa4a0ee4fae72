"""The partial file of a map: its checks, lock, room and final name."""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import tempfile
import threading
from collections.abc import Iterator, Sequence
from pathlib import Path

from fastlink._text import size
from fastlink.errors import InputError, Remedy, Setting
from fastlink.options import check_output, not_a_file

try:
    import fcntl
except ImportError:  # not POSIX: no locks, and a folder cannot be synchronised
    fcntl = None  # type: ignore[assignment]

#: The remedy where a file exists.
EXISTS: Remedy = ("choose another name", (", or write ", Setting("overwrite", True)))
SLACK = 2**20  # for the labels, and for the attributes that are added at the end

_seek_lock = threading.Lock()

NO_LOCKS = {errno.ENOSYS, errno.EOPNOTSUPP, errno.ENOLCK}
NO_RESERVE = {errno.EINVAL, errno.EOPNOTSUPP, errno.ENOSYS}
NO_LINK = {errno.EPERM, errno.EOPNOTSUPP, errno.ENOSYS, errno.EMLINK}


def part_of(path: Path) -> Path:
    """Return the name of a file while it is being written."""
    return path.with_name(path.name + ".part")


def reason(error: BaseException) -> str:
    """Return the reason of a failure on one line."""
    text = getattr(error, "strerror", None) or str(error)
    return " ".join(str(text).split())


def check_target(path: str | Path, nbytes_needed: int, overwrite: bool, sources: Sequence[Path] = ()) -> Path:
    """Return the absolute path of an output file, or refuse it.

    To be called before anything is computed.

    Parameters
    ----------
    path : str or path
        The file to make; its folder must exist.
    nbytes_needed : int
        Bytes of all values.
    overwrite : bool
        Whether an existing file may be replaced.
    sources : sequence of Path
        Files that the values are computed from, which must stay.
    """
    target = Path(os.path.realpath(check_output(("to",), path)))
    check_place(target)
    if target.exists() and not overwrite:
        raise exists_error(target)
    if any(target.exists() and target.samefile(source) for source in sources):
        raise _refused(f"{path}: the study is read from that file", "choose another name")
    try:
        if (fd := reopened(part_of(target))) is not None:
            os.close(fd)
    except OSError as error:
        raise _not_writable(target, error) from error
    if nbytes_needed + SLACK > _free(target) + _held_by(part_of(target)):
        raise no_room(target, nbytes_needed)
    return target


def existing_file(path: str | Path) -> Path | None:
    """Return the absolute path of an output that is a file already, None where there is none."""
    target = Path(os.path.realpath(check_output(("to",), path)))
    try:
        return target if target.is_file() else None
    except OSError:
        return None


def check_place(path: Path, where: str = "to", example: str = "maps.h5") -> None:
    """Refuse a path at which no file can be written, before anything is computed for it.

    Parameters
    ----------
    path : Path
        The file; its folder must exist.
    where : str
        The option that names it.
    example : str
        A name for a file of its kind.
    """
    try:
        if other := not_a_file(path):
            remedy = (
                f"add a file name, for instance {path / example}" if path.is_dir() else "choose another name"
            )
            raise _refused(f"{path} {other}", remedy, where)
        if not path.parent.is_dir():
            raise _refused(f"{path}: there is no folder {path.parent}", "create it or choose another", where)
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise _not_writable(path, error, where) from error


def _not_writable(path: Path, error: OSError, where: str = "to") -> InputError:
    return _refused(f"{path} cannot be written ({reason(error)})", "choose another place", where)


def _refused(what: str, remedy: Remedy, where: str = "to") -> InputError:
    return InputError(what, where=(where,), remedy=remedy)


def exists_error(path: Path, why: str = "") -> InputError:
    """Return the error of a file that may not be replaced."""
    return _refused(f"{path}: the file exists{why and f', {why}'}", EXISTS)


def no_room(path: Path, nbytes: int, error: Exception | None = None) -> InputError:
    """Return the error of a disk that is too small for a file."""
    why = f" ({reason(error)})" if error else ""
    return _refused(
        f"{path} needs {size(nbytes)} but {size(_free(path))} are free{why}",
        "ask for fewer quantities or designs, or choose another disk",
    )


@contextlib.contextmanager
def claimed(part: Path) -> Iterator[None]:
    """Hold the name of a partial file while it is laid out, and empty an old file.

    Refused when a live process writes it. The name is gone when the body fails.
    """
    if fcntl is None:
        part.unlink(missing_ok=True)  # refused by the system while another process has it open
        yield
        return
    while (fd := _hold(part, os.O_CREAT)) is None:
        pass
    try:
        os.ftruncate(fd, 0)
        yield
    except BaseException:
        part.unlink(missing_ok=True)
        raise
    finally:
        os.close(fd)


def adopt(fresh: Path, part: Path) -> int:
    """Give a laid-out file the claimed name, hold it, and return its file number."""
    if fcntl is None:
        os.replace(fresh, part)  # an open file cannot be renamed there
        return _open(part)
    fd = _open(fresh)
    try:
        _lock(fd, part)  # before it has the name: no moment without a holder
        os.replace(fresh, part)
    except BaseException:
        os.close(fd)
        raise
    return fd


def reopened(part: Path) -> int | None:
    """Hold the partial file of a killed run; return its file number, None if absent.

    Refused when a live process writes it.
    """
    try:
        return _hold(part)
    except FileNotFoundError:
        return None


def make_sure_of_room(path: Path, nbytes: int) -> None:
    """Fail if HDF5 will have no room for the labels, which might crash the process."""
    fd = _open(path, os.O_CREAT | os.O_TRUNC)
    try:
        reserve(fd, nbytes)
    finally:
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
    if fcntl is None:
        os.close(fd)  # an open file cannot be renamed there
        _rename(part, final, overwrite)
        return
    try:
        _flock(fd, fcntl.LOCK_SH)  # readers may open it from its first moment on
        _rename(part, final, overwrite)
    finally:
        os.close(fd)
    _synchronise_folder(final.parent)


def write_all(fd: int, data: memoryview, position: int) -> None:
    """Write every byte at a position, however few the system takes at a time."""
    while data:
        if hasattr(os, "pwrite"):
            count = os.pwrite(fd, data, position)
        else:
            with _seek_lock:
                os.lseek(fd, position, os.SEEK_SET)
                count = os.write(fd, data)
        data = data[count:]
        position += count


def discard(fd: int, part: Path) -> None:
    """Remove a partial file."""
    if fcntl is None:
        os.close(fd)  # an open file cannot be removed there
        part.unlink(missing_ok=True)
    else:
        part.unlink(missing_ok=True)
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


def _open(path: Path, flags: int = 0) -> int:
    return os.open(path, os.O_RDWR | flags | getattr(os, "O_BINARY", 0), 0o666)


def _lock(fd: int, part: Path) -> None:
    if fcntl is None:
        return
    try:
        _flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise _refused(f"{part}: another run is writing it", "wait for it or choose another name") from None


def _flock(fd: int, operation: int) -> None:
    """Lock or unlock; without locks in the file system, nobody holds any."""
    try:
        fcntl.flock(fd, operation)
    except OSError as error:
        if error.errno not in NO_LOCKS:
            raise


def _hold(part: Path, flags: int = 0) -> int | None:
    """Lock a partial file, and return its file number; None if its name has changed."""
    fd = _open(part, flags)
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
        os.link(part, final)  # unlike a rename, fails when the name is taken
    except OSError as error:
        if error.errno not in NO_LINK:
            raise
        if final.exists():
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST)) from None
        os.rename(part, final)
    else:
        part.unlink()


def _synchronise_folder(folder: Path) -> None:
    """Make the new name survive a power cut, on file systems that can."""
    with contextlib.suppress(OSError):
        fd = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(fd)
        finally:
            os.close(fd)


def _free(path: Path) -> int:
    return shutil.disk_usage(path.parent).free


def _held_by(part: Path) -> int:
    """Return the bytes that replacing an old partial file frees."""
    try:
        status = part.stat()
    except FileNotFoundError:
        return 0
    return getattr(status, "st_blocks", 0) * 512
