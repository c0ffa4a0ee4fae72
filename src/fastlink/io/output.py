"""Outputs that are made at once: a fresh name until they are whole, then the final one."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from fastlink.io import partial_file
from fastlink.io.output_path import (
    NO_ROOM,
    exchange,
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


@contextlib.contextmanager
def _refusing(path: Path, where: str = "to", less: str = LESS) -> Iterator[None]:
    """Turn an error of the system, or HDF5's words for one, into what to do; `less` asks for a smaller output."""
    try:
        yield
    except FileExistsError as error:
        raise exists_error(path) from error
    except (OSError, RuntimeError) as error:
        if getattr(error, "errno", None) in NO_ROOM or any(os.strerror(n) in str(error) for n in NO_ROOM):
            what = f"{path}: no room for the result ({reason(error)})"
            remedy = (
                f"make room, choose another disk, or {less}" if less else "make room, or choose another disk"
            )
            raise refused(what, remedy, where) from error
        raise not_writable(path, error, where) from error


def _empty(path: Path) -> None:
    os.close(partial_file.create(path))


@contextlib.contextmanager
def output_file(
    path: Path, overwrite: bool, lay: Callable[[Path], Any] = _empty, where: str = "to", less: str = LESS
) -> Iterator[int]:
    """Yield the number of a new file, which gets its name after the body, and is removed where that fails."""
    part = part_of(path)
    with _refusing(path, where, less), contextlib.ExitStack() as undo:
        fd, _ = partial_file.begun(part, lay)
        undo.callback(partial_file.discard, fd, part)
        yield fd
        with uninterrupted():
            os.fsync(fd)
            partial_file.publish(fd, part, path, overwrite)
            undo.pop_all()


@contextlib.contextmanager
def output_folder(path: Path, overwrite: bool) -> Iterator[Path]:
    """Yield a new folder, which gets its name after the body, and is removed where that fails."""
    part = part_of(path)
    with _refusing(path):
        if os.path.lexists(part):
            _remove_left(part)
        part.mkdir()
        with partial_file.held_folder(part), contextlib.ExitStack() as undo:
            undo.callback(shutil.rmtree, part, ignore_errors=True)
            yield part
            for folder, _, names in os.walk(part):
                for name in names:
                    with open(os.path.join(folder, name), "rb") as file:
                        os.fsync(file.fileno())
                partial_file.synchronise_folder(Path(folder))
            with uninterrupted():
                if overwrite and path.exists():
                    _replace(part, path)
                else:
                    partial_file.rename(part, path, overwrite=False)
                undo.pop_all()
                partial_file.synchronise_folder(path.parent)


def _remove_left(part: Path) -> None:
    """Remove what a killed conversion left; nothing else."""
    if part.is_symlink() or not part.is_dir() or not _is_of_zarr(part):
        raise refused(f"{part} is in the way", "remove it or choose another name")
    with partial_file.held_folder(part):
        shutil.rmtree(part)


def _is_of_zarr(folder: Path) -> bool:
    """Tell whether all files have names that zarr gives, also of a store that is half written or half removed."""
    return all(OF_ZARR.fullmatch(name) for _, _, names in os.walk(folder) for name in names)


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


def write_whole(
    path: Path, content: bytes | Callable[[], bytes], where: str = "to", *, overwrite: bool = True
) -> None:
    """Write a small file at once: the one that has its name stays until the new one is whole and on the disk."""
    final = Path(os.path.realpath(path))
    made = content if callable(content) else lambda: content
    with output_file(final, overwrite, lambda fresh: fresh.write_bytes(made()), where, less=""):
        pass
