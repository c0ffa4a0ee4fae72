"""Write labelled HDF5 files block by block; only complete ones get their name.

The file is laid out once; then every block is one plain ``pwrite`` at a known offset, which any thread may do
in any order and which is faster than a write through HDF5. All this happens in ``NAME.part``; the last step
gives it its name.
"""

from __future__ import annotations

import errno
import math
import os
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from fastlink.errors import InputError
from fastlink.io import partial_file
from fastlink.io.dataset import FORMAT_VERSION, Variable, check_dims, plain_attrs
from fastlink.io.finished import marks, stamp
from fastlink.io.journal import Journal, Range, joined, journal_of, missing, read_journal
from fastlink.io.skeleton import lay_out, set_attrs
from fastlink.space.dataset import FORMAT

__all__ = ["Writer"]

NO_ROOM = {errno.ENOSPC, errno.EFBIG, getattr(errno, "EDQUOT", errno.ENOSPC)}


class Writer:
    """Writer of a labelled file, for any number of threads; a context manager.

    Nothing appears under the final name before `finish`; without it, or on an exception, leaving the context
    removes the partial file.

    Parameters
    ----------
    path : str or path
        The file to make.
    coords : xarray.Dataset
        Coordinates and first global attributes, without data.
    variables : sequence of Variable
        The variables to be written.
    attrs : mapping
        Further global attributes.
    overwrite : bool, default False
        Replace an existing file; a process that has it open goes on reading the old one.
    run : (fingerprint, size), optional
        A hash that no other run has, and the number of designs to evaluate. With it, `record` keeps the journal,
        and a killed run of the same fingerprint is resumed: `pending` are the designs that it left.
    """

    def __init__(
        self,
        path: str | Path,
        coords: xr.Dataset,
        variables: Sequence[Variable],
        attrs: Mapping[str, Any],
        *,
        overwrite: bool = False,
        run: tuple[str, int] | None = None,
    ) -> None:
        for variable in variables:
            check_dims(coords, variable)
        self._nbytes = coords.nbytes + sum(variable.nbytes for variable in variables)
        self.path = partial_file.check_target(path, self._nbytes, overwrite)
        self.part = partial_file.part_of(self.path)
        self._overwrite = overwrite
        self._variables = {variable.name: variable for variable in variables}
        self._values_written = dict.fromkeys(self._variables, 0)
        self._idle = threading.Condition()
        self._writing = 0
        self._closed = False
        self._fingerprint, self._size = run or ("", 0)
        self._ranges: list[Range] = []
        try:
            if not self._resumed():
                with partial_file.claimed(self.part):
                    journal_of(self.part).unlink(missing_ok=True)
                    self._offsets, self._fd = self._start(coords, variables, attrs)
        except (OSError, RuntimeError) as error:  # HDF5 reports a full disk as either
            raise self._failure(error) from error
        about = {"fingerprint": self._fingerprint, "offsets": self._offsets}
        self._journal = Journal(self._fd, self.part, about, self._ranges)

    def __enter__(self) -> Writer:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._closed:
            return
        if isinstance(error, KeyboardInterrupt) and self._ranges:
            self._keep(error)
        else:
            self._discard()

    @property
    def pending(self) -> list[Range]:
        """Ranges of designs that are not written yet."""
        return missing(self._ranges, self._size)

    def record(self, start: int, stop: int) -> None:
        """Record that all variables of some designs are written; thread-safe.

        Parameters
        ----------
        start, stop : int
            Numbers of designs as they are evaluated.
        """
        with self._idle:
            self._ranges = joined([*self._ranges, (start, stop)])
        self._journal.add(start, stop)

    @property
    def written(self) -> list[Range]:
        """Ranges of designs that are written, by this run or by the one that it resumes."""
        return list(self._ranges)

    def read(self, name: str, start: int, stop: int, row: tuple[int, ...]) -> NDArray[Any]:
        """Return written values: one row of a given shape per design, as in `write`."""
        dtype, length = self._variables[name].dtype, math.prod(row)
        with open(self.part, "rb") as file:
            file.seek(self._offsets[name] + start * length * dtype.itemsize)
            return np.fromfile(file, dtype, (stop - start) * length).reshape(stop - start, *row)

    def write(self, name: str, start: int, block: NDArray[Any]) -> None:
        """Write the values of consecutive designs of one variable; thread-safe.

        Parameters
        ----------
        name : str
            The variable.
        start : int
            Flat number of the first design, in C order over the swept dimensions.
        block : ndarray, C-contiguous
            One row per design; its other dimensions are the last ones of the variable.
        """
        position = self._position(name, start, block)
        with self._idle:
            if self._closed:
                raise ValueError(f"{self.path}: the file is closed")
            self._writing += 1
        try:
            partial_file.write_all(self._fd, block.reshape(-1).view(np.uint8).data, position)
        except OSError as error:
            raise self._failure(error) from error
        else:
            self._journal.add_bytes(block.nbytes)
            with self._idle:
                self._values_written[name] += block.size
        finally:
            with self._idle:
                self._writing -= 1
                self._idle.notify_all()

    def finish(
        self, attrs: Mapping[str, Any], of_variables: Mapping[str, Mapping[str, Any]] | None = None
    ) -> None:
        """Add the last attributes and give the file its name.

        Parameters
        ----------
        attrs : mapping
            Further global attributes, such as the run time.
        of_variables : mapping, optional
            Further attributes of variables, such as their errors.
        """
        last = plain_attrs({**attrs, **marks(self._fingerprint), FORMAT: FORMAT_VERSION})
        further = {name: plain_attrs(added) for name, added in (of_variables or {}).items()}
        for name, count in self._values_written.items():
            expected = math.prod(self._variables[name].shape)
            if count != expected:
                raise RuntimeError(f"{self.path}: {count} of {expected} values of {name} were written")
        self._close_to_writers()
        try:
            set_attrs(self._fd, self.part, last, further)
            os.fsync(self._fd)
            stamp(self.part, last)
        except BaseException as error:
            partial_file.discard(self._fd, self.part)
            if isinstance(error, OSError):
                raise self._failure(error) from error
            raise
        try:
            partial_file.publish(self._fd, self.part, self.path, self._overwrite)
        except OSError as error:
            what = f"{self.path}: cannot give the complete file its name ({partial_file.reason(error)})"
            remedy = f"it is kept as {self.part}, rename it"
            raise InputError(what, where=("to",), remedy=remedy) from error

    def _resumed(self) -> bool:
        """Resume a killed run of the same fingerprint, if there is one."""
        journal = read_journal(self.part, self._fingerprint) if self._fingerprint else None
        fd = None if journal is None else partial_file.reopened(self.part)
        if journal is None or fd is None:
            return False
        about, self._ranges = journal
        self._offsets, self._fd = about["offsets"], fd
        written = sum(stop - start for start, stop in self._ranges)
        for name, variable in self._variables.items():
            self._values_written[name] = math.prod(variable.shape) // self._size * written
        return True

    def _keep(self, error: KeyboardInterrupt) -> None:
        """Keep the partial file to be resumed."""
        self._close_to_writers(keep=True)
        os.close(self._fd)
        share = sum(stop - start for start, stop in self._ranges) / self._size
        error.add_note(f"{share:.0%} of the designs are kept in {self.part}; run the same again to go on")

    def _start(
        self, coords: xr.Dataset, variables: Sequence[Variable], attrs: Mapping[str, Any]
    ) -> tuple[dict[str, int], int]:
        """Lay the file out; return the offset of each variable and the file number."""
        fresh = self.part.with_name(self.part.name + ".new")
        try:
            partial_file.make_sure_of_room(fresh, coords.nbytes + partial_file.SLACK)
            offsets = lay_out(fresh, coords, variables, attrs)
            fd = partial_file.adopt(fresh, self.part)
        except BaseException:
            fresh.unlink(missing_ok=True)
            raise
        try:
            partial_file.reserve(
                fd, partial_file.SLACK
            )  # HDF5 gives back at the end what the attributes leave
        except BaseException:
            partial_file.discard(fd, self.part)
            raise
        return offsets, fd

    def _position(self, name: str, start: int, block: NDArray[Any]) -> int:
        """Return the offset of a block in the file, or refuse one that does not fit."""
        variable = self._variables[name]
        if block.dtype != variable.dtype:
            raise TypeError(f"{name}: block is {block.dtype}, the variable {variable.dtype}")
        if not block.flags.c_contiguous:
            raise ValueError(f"{name}: block is not C-contiguous")
        swept = len(variable.shape) - (block.ndim - 1)
        if block.ndim == 0 or swept < 0 or block.shape[1:] != variable.shape[swept:]:
            raise ValueError(f"{name}: a block of shape {block.shape} does not hold rows of {variable.shape}")
        designs = math.prod(variable.shape[:swept])
        if not 0 <= start <= start + len(block) <= designs:
            raise ValueError(f"{name}: designs {start} to {start + len(block)} of {designs}")
        return self._offsets[name] + start * math.prod(variable.shape[swept:]) * variable.dtype.itemsize

    def _failure(self, error: OSError | RuntimeError) -> InputError:
        if getattr(error, "errno", None) in NO_ROOM:
            return partial_file.no_room(self.path, self._nbytes, error)
        what = f"{self.path} cannot be written ({partial_file.reason(error)})"
        return InputError(what, where=("to",), remedy="choose another place")

    def _close_to_writers(self, *, keep: bool = False) -> None:
        """Refuse further writes and wait for those under way.

        The file number may soon be of another file.
        """
        with self._idle:
            if self._closed:
                raise ValueError(f"{self.path}: the file is closed")
            self._closed = True
            self._idle.wait_for(lambda: self._writing == 0)
        self._journal.close(keep=keep)

    def _discard(self) -> None:
        self._close_to_writers()
        partial_file.discard(self._fd, self.part)
