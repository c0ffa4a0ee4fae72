"""The output file of a run: whether it may be made, and what an earlier run left under its name."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import h5py

from fastlink.errors import KeyPath, Remedy, Setting
from fastlink.io.checksums import seal_is_broken
from fastlink.io.dataset import FINGERPRINT
from fastlink.io.place import (
    SLACK,
    check_place,
    exists_error,
    free_bytes,
    no_room,
    not_writable,
    part_of,
    refused,
)
from fastlink.io.writing.journal import journal_of, read_journal
from fastlink.io.writing.partial_file import given_back, reopened
from fastlink.options import check_output
from fastlink.space.dataset import FORMAT

__all__ = ["check_left", "check_made_at_once", "check_target", "forget_journal", "forget_published"]

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
) -> Path:
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
    named : callable
        The check of its name, which is that of a map unless given.
    """
    target = Path(os.path.realpath(named(("to",), path)))
    check_place(target)
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
    return target


def check_made_at_once(
    path: str | Path,
    nbytes_needed: int,
    overwrite: bool,
    sources: Sequence[Path] = (),
    named: Callable[[KeyPath, Any], Path] = check_output,
) -> Path:
    """Return the absolute path of a file that no later run goes on with, or refuse it as `check_target` does.

    Refused too where a run to that name has left its part of a map, which would be lost.
    """
    target = check_target(path, nbytes_needed, overwrite, sources, named)
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
    """Refuse to replace what an earlier run of another request left: its designs, or a whole map.

    What is made at once, such as a conversion, is made again, and has no request.

    Raises
    ------
    InputError
        There is something; the message says how much, and how to go on.
    """
    part = part_of(path)
    journal = read_journal(part)
    if journal is not None and part.exists():
        about, written, _ = journal
        count, size = sum(stop - start for start, stop in written), about.get("size", 0)
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
