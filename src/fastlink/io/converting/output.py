"""The output of a conversion: a fresh name until it is whole, then the final one."""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from types import TracebackType
from typing import Self

from fastlink.errors import InputError
from fastlink.io.place import NO_ROOM, exists_error, part_of, reason, refused
from fastlink.io.reader import is_zarr
from fastlink.io.renaming import exchange, exclusive_rename
from fastlink.io.writing import partial_file
from fastlink.io.writing.finishing import uninterrupted

__all__ = ["OutputFile", "OutputFolder", "failure"]


def failure(path: Path, error: Exception) -> InputError:
    """Return the error of an output that cannot be written, such as on a full disk."""
    if getattr(error, "errno", None) in NO_ROOM or any(os.strerror(n) in str(error) for n in NO_ROOM):
        what = f"{path}: no room for the result ({reason(error)})"
        return refused(what, "make room, choose another disk, or compress or select more")
    return refused(f"{path} cannot be written ({reason(error)})", "choose another place")


class _Output:
    """An output that gets its name when it is whole, and is removed where it does not."""

    def __init__(self, path: Path, overwrite: bool) -> None:
        self.path, self.part, self._overwrite = path, part_of(path), overwrite
        self._published = False

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if not self._published:
            self._discard()
        self._release()
        _explain(self.path, error)

    def _discard(self) -> None:
        raise NotImplementedError

    def _release(self) -> None:
        """Give back what is held until the end."""


class OutputFile(_Output):
    """A file that gets its name when it is whole; a context manager.

    Parameters
    ----------
    path : Path
        The file to make.
    overwrite : bool
        Replace an existing file.
    lay : callable
        Makes the file as it is to begin with, at the path that is given to it.

    Attributes
    ----------
    fd : int
        The open file.
    part : Path
        Its name until it is whole.
    """

    def __init__(self, path: Path, overwrite: bool, lay: Callable[[Path], None]) -> None:
        super().__init__(path, overwrite)
        with _refusing(path):
            self.fd, _ = partial_file.begun(self.part, lay)

    def publish(self) -> None:
        """Give the whole file its name."""
        with uninterrupted():
            os.fsync(self.fd)
            partial_file.publish(self.fd, self.part, self.path, self._overwrite)
            self._published = True

    def _discard(self) -> None:
        partial_file.discard(self.fd, self.part)


class OutputFolder(_Output):
    """A folder that gets its name when it is whole; a context manager.

    Parameters
    ----------
    path : Path
        The folder to make.
    overwrite : bool
        Replace an existing zarr store.
    """

    def __init__(self, path: Path, overwrite: bool) -> None:
        super().__init__(path, overwrite)
        with _refusing(path):
            if os.path.lexists(self.part):
                self._remove_left()
            self.part.mkdir()
            self._lock = partial_file.held_folder(self.part)

    def _remove_left(self) -> None:
        """Remove what a killed conversion left; nothing else."""
        if (
            self.part.is_symlink()
            or not self.part.is_dir()
            or not (is_zarr(self.part) or _is_empty(self.part))
        ):
            raise refused(f"{self.part} is in the way", "remove it or choose another name")
        lock = partial_file.held_folder(self.part)
        try:
            shutil.rmtree(self.part)
        finally:
            _close(lock)

    def publish(self) -> None:
        """Give the whole folder its name."""
        for folder, _, names in os.walk(self.part):
            for name in names:
                fd = os.open(os.path.join(folder, name), os.O_RDONLY)
                try:
                    os.fsync(fd)
                finally:
                    os.close(fd)
            partial_file.synchronise_folder(Path(folder))
        with uninterrupted():
            if self._overwrite and self.path.exists():
                _replace(self.part, self.path)
            else:
                _rename(self.part, self.path)
            self._published = True
            partial_file.synchronise_folder(self.path.parent)

    def _discard(self) -> None:
        shutil.rmtree(self.part, ignore_errors=True)

    def _release(self) -> None:
        _close(self._lock)


def _is_empty(folder: Path) -> bool:
    return next(folder.iterdir(), None) is None


def _rename(part: Path, path: Path) -> None:
    """Rename a folder; fail where the name is taken."""
    try:
        exclusive_rename()(part, path)
    except OSError as error:
        if error.errno not in partial_file.NO_EXCLUSIVE_RENAME:
            raise
        if path.exists():
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST)) from None
        os.rename(part, path)


def _replace(part: Path, path: Path) -> None:
    """Give a folder the name of an old one, which is removed."""
    try:
        exchange()(part, path)
    except OSError as error:
        if error.errno not in partial_file.NO_EXCLUSIVE_RENAME:
            raise
        old = part.with_name(part.name + ".old")
        os.rename(path, old)
        os.rename(part, path)
        part = old
    shutil.rmtree(part, ignore_errors=True)


def _close(fd: int | None) -> None:
    if fd is not None:
        os.close(fd)


@contextlib.contextmanager
def _refusing(path: Path) -> Iterator[None]:
    """Turn an error of the system into one that says what to do."""
    try:
        yield
    except OSError as error:
        raise failure(path, error) from error


def _explain(path: Path, error: BaseException | None) -> None:
    """Raise the error of a result that could not be written in words; let others pass."""
    if isinstance(error, FileExistsError):
        raise exists_error(path) from error
    if isinstance(error, (OSError, RuntimeError)):
        raise failure(path, error) from error
