"""Outputs that are made at once: a fresh name until they are whole, then the final one."""

from __future__ import annotations

import contextlib
import errno
import os
import re
import shutil
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from fastlink.errors import InputError
from fastlink.io import partial_file
from fastlink.io.output_path import (
    NO_ROOM,
    exchange,
    exclusive_rename,
    exists_error,
    not_writable,
    part_of,
    reason,
    refused,
)
from fastlink.io.partial_file import uninterrupted

LESS = "compress or select more"
#: Names of files in a zarr store of version 2: labels, chunks, and either until they are whole.
OF_ZARR = re.compile(r"\.z[a-z]+|[\d.]+|.+\.[0-9a-f]{32}\.partial")


def failure(path: Path, error: Exception, where: str = "to", less: str = LESS) -> InputError:
    """Return the error of an output that cannot be written, such as on a full disk; `less` asks for a smaller one."""
    if getattr(error, "errno", None) in NO_ROOM or any(os.strerror(n) in str(error) for n in NO_ROOM):
        what = f"{path}: no room for the result ({reason(error)})"
        return refused(
            what,
            f"make room, choose another disk, or {less}" if less else "make room, or choose another disk",
            where,
        )
    return not_writable(path, error, where)


class _Output:
    """An output that gets its name when it is whole, and is removed where it does not."""

    def __init__(self, path: Path, overwrite: bool, where: str = "to", less: str = LESS) -> None:
        self.path, self.part, self._overwrite = path, part_of(path), overwrite
        self._failure = partial(failure, where=where, less=less)
        self._published = False

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if not self._published:
            self._discard()
        self._release()
        if isinstance(error, FileExistsError):
            raise exists_error(self.path) from error
        if isinstance(error, (OSError, RuntimeError)):
            raise self._failure(self.path, error) from error

    @contextlib.contextmanager
    def _refusing(self) -> Iterator[None]:
        """Turn an error of the system, or HDF5's words for one, into one that says what to do."""
        try:
            yield
        except (OSError, RuntimeError) as error:
            raise self._failure(self.path, error) from error

    def _discard(self) -> None:
        raise NotImplementedError

    def _release(self) -> None:
        """Give back what is held until the end."""


class OutputFile(_Output):
    """A file that gets its name when it is whole; a context manager.

    Attributes
    ----------
    part : Path
        Its name until it is whole.
    """

    def __init__(
        self,
        path: Path,
        overwrite: bool,
        lay: Callable[[Path], Any],
        where: str = "to",
        less: str = LESS,
    ) -> None:
        super().__init__(path, overwrite, where, less)
        with self._refusing():
            #: The open file.
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
    """A folder that gets its name when it is whole; a context manager."""

    def __init__(self, path: Path, overwrite: bool) -> None:
        super().__init__(path, overwrite)
        with self._refusing():
            if os.path.lexists(self.part):
                self._remove_left()
            self.part.mkdir()
            self._lock = partial_file.held_folder(self.part)

    def _remove_left(self) -> None:
        """Remove what a killed conversion left; nothing else."""
        if self.part.is_symlink() or not self.part.is_dir() or not _is_of_zarr(self.part):
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


def _is_of_zarr(folder: Path) -> bool:
    """Tell whether all files have names that zarr gives, also of a store that is half written or half removed."""
    return all(OF_ZARR.fullmatch(name) for _, _, names in os.walk(folder) for name in names)


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
    """Give back the lock of a folder, in which nothing is written by this number."""
    if fd is not None:
        with contextlib.suppress(OSError):
            os.close(fd)


def write_whole(
    path: Path, content: bytes | Callable[[], bytes], where: str = "to", *, overwrite: bool = True
) -> None:
    """Write a small file at once: the one that has its name stays until the new one is whole and on the disk."""
    final = Path(os.path.realpath(path))
    made = content if callable(content) else lambda: content
    with OutputFile(final, overwrite, lambda fresh: fresh.write_bytes(made()), where, less="") as out:
        out.publish()
