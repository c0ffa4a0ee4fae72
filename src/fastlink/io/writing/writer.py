"""Write labelled HDF5 files block by block; only complete ones get their name.

The file is laid out once; then every block is one plain ``pwrite`` at a known offset, which any thread may do
in any order and which is faster than a write through HDF5. All this happens in ``NAME.part``; the last step
gives it its name.
"""

from __future__ import annotations

import contextlib
import math
import os
import threading
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from fastlink.errors import InputError
from fastlink.io.checksums import OF_REST, OF_VALUES, add, block_count, of_file, seal
from fastlink.io.dataset import FORMAT_VERSION, Variable, check_dims, plain_attrs
from fastlink.io.finished import marks, stamp
from fastlink.io.place import SLACK, not_written, part_of, reason, refused
from fastlink.io.ranges import Range, Ranges, missing
from fastlink.io.writing import partial_file
from fastlink.io.writing.blocks import OfThread
from fastlink.io.writing.elsewhere import WriterElsewhere, Written
from fastlink.io.writing.finishing import uninterrupted
from fastlink.io.writing.journal import Journal, synchronise
from fastlink.io.writing.resume import LayOut, Rows, SameRows, resume
from fastlink.io.writing.skeleton import OF_HDF5, check_readable, laid_in_memory, lay_out, set_attrs
from fastlink.io.writing.target import check_left, check_target
from fastlink.io.writing.values_file import ValuesFile
from fastlink.space.dataset import FORMAT

__all__ = ["Writer"]


class Writer:
    """Writer of a labelled file, for any number of threads; a context manager.

    Nothing appears under the final name before `finish`. Without it, or on any exception, leaving the context keeps the
    partial file with its journal where `record` has noted designs, and says so in a note of the exception; else it
    removes the file.

    Parameters
    ----------
    path : str or path
        The file to make.
    coords : xarray.Dataset
        Coordinates and first global attributes, without data.
    variables : sequence of Variable
        The variables to be written, coordinates among them.
    attrs : mapping
        Further global attributes.
    overwrite : bool, default False
        Replace an existing file; a process that has it open goes on reading the old one.
    restart : bool, default False
        Throw away what an earlier run left under this name.
    run : (fingerprint, size), optional
        A hash that no other run has, and the number of designs to evaluate. With it, `record` keeps the journal,
        and a killed run of the same fingerprint is resumed: `pending` are the designs that it left.
    rows : Rows, optional
        The rows of the file that follow from each design that is evaluated; itself unless given.
    whole : xarray.Dataset, optional
        Coordinates of the whole map that this file is a part of, to be kept in a group.
    """

    def __init__(
        self,
        path: str | Path,
        coords: xr.Dataset,
        variables: Sequence[Variable],
        attrs: Mapping[str, Any],
        *,
        overwrite: bool = False,
        restart: bool = False,
        run: tuple[str, int] | None = None,
        rows: Rows | None = None,
        whole: xr.Dataset | None = None,
    ) -> None:
        of_coordinates = {v.name: v.shape[0] for v in variables if v.is_coordinate and v.dims == (v.name,)}
        for variable in variables:
            check_dims(coords, {**coords.sizes, **of_coordinates}, variable)
        lay_out_all = partial(lay_out, coords=coords, variables=variables, attrs=attrs, whole=whole)
        self._nbytes = coords.nbytes + sum(variable.nbytes for variable in variables)
        self.path = check_target(path, self._nbytes, overwrite)
        self.part = part_of(self.path)
        self._overwrite = overwrite
        self._variables = {variable.name: variable for variable in variables}
        self._values_written = dict.fromkeys(self._variables, 0)
        self._idle = threading.Condition()
        self._writing = 0
        self._closed = False
        self._fingerprint, self._size = run or ("", 0)
        self._rows = rows or SameRows()
        self._ranges = Ranges()
        self._sums = dict[int, int]()
        self._of_thread = OfThread()
        try:
            if restart or not self._resumed(lay_out_all):
                if not restart:
                    check_left(self.path, self._fingerprint)
                self._start(lay_out_all)
        except OF_HDF5 as error:
            raise self._failure(error) from error
        self._file = ValuesFile(self._fd, self._offsets, variables)
        about = {"fingerprint": self._fingerprint, "size": self._size, "offsets": self._offsets}
        self._journal = Journal(self._fd, self.part, about, self.written, self._sums)

    def __enter__(self) -> Writer:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._closed:
            return
        self._close_to_writers()
        self._keep_or_discard(error)

    @property
    def pending(self) -> list[Range]:
        """Ranges of designs that are not written yet."""
        return missing(self.written, self._size)

    def record(self, start: int, stop: int) -> None:
        """Record that all variables of some designs are written, by this thread; thread-safe.

        Parameters
        ----------
        start, stop : int
            Numbers of designs as they are evaluated.
        """
        with self._idle:
            self._ranges.add(start, stop)
        addends, self._of_thread.addends = self._of_thread.addends, []
        self._journal.add(start, stop, addends)

    @property
    def written(self) -> list[Range]:
        """Ranges of designs that are written, by this run or by the one that it resumes."""
        with self._idle:
            return self._ranges.joined()

    def values(self, name: str, row: tuple[int, ...]) -> NDArray[Any]:
        """Return the values in the file, read where they are looked at: one row of a given shape per design."""
        variable, designs = self._variables[name], self._size * self._rows.length
        shape = (*row, designs) if variable.leading else (designs, *row)
        try:
            found = np.memmap(self.part, variable.dtype, "r", self._offsets[name], shape)
        except OSError as error:
            raise self._failure(error) from error
        return np.moveaxis(found, -1, 0) if variable.leading else found

    def write(self, name: str, start: int, block: NDArray[Any]) -> None:
        """Write the values of consecutive designs of one variable; thread-safe.

        Parameters
        ----------
        name : str
            The variable.
        start : int
            Flat number of the first design, in C order over the swept dimensions.
        block : ndarray, C-contiguous
            One row per design; its other dimensions are those of the variable that are not swept.
        """
        self.write_pieces(name, self._file.pieces(name, start, block, self._of_thread))

    def write_pieces(self, name: str, pieces: Sequence[tuple[int, memoryview]]) -> None:
        """Write bytes of the values of a variable, each piece at its position from the first value; thread-safe."""
        with self._idle:
            if self._closed:
                raise ValueError(f"{self.path}: the file is closed")
            self._writing += 1
        try:
            if self._journal.error:  # what is written from now on would be lost
                raise self._journal.error
            added = self._file.put(name, pieces)
        except OSError as error:
            raise self._failure(error) from error
        else:
            nbytes = sum(len(data) for _, data in pieces)
            self._journal.add_bytes(nbytes)
            self._of_thread.addends += added
            with self._idle:
                add(self._sums, added)
                self._values_written[name] += nbytes // self._variables[name].dtype.itemsize
        finally:
            with self._idle:
                self._writing -= 1
                self._idle.notify_all()

    def twin(self) -> WriterElsewhere:
        """Return what writes in another process that knows the file by a token, in the place of its checksums."""
        token = {self._offsets[name]: os.urandom(4) for name in (OF_VALUES, OF_REST)}
        for position, data in token.items():
            partial_file.write_all(self._fd, memoryview(data), position)
        synchronise(self._fd)
        return WriterElsewhere(self.part, token, self._offsets, list(self._variables.values()))

    def merge(self, written: Written) -> None:
        """Record what a twin has written; thread-safe."""
        with self._idle:
            if self._journal.error:
                raise self._failure(self._journal.error)
            add(self._sums, written.addends.items())
            for name, count in written.values.items():
                self._values_written[name] += count
            for start, stop in written.ranges:
                self._ranges.add(start, stop)
        self._journal.add_bytes(written.nbytes)
        self._journal.add_all(written.ranges, written.addends.items())

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
        last = plain_attrs({**marks(self._fingerprint), **attrs, FORMAT: FORMAT_VERSION})
        further = {name: plain_attrs(added) for name, added in (of_variables or {}).items()}
        for name, count in self._values_written.items():
            expected = math.prod(self._variables[name].shape)
            if count != expected:
                raise RuntimeError(f"{self.path}: {count} of {expected} values of {name} were written")
        with uninterrupted():
            self._close_to_writers()
            try:
                if self._journal.error:
                    raise self._journal.error
                set_attrs(self._fd, self._file.places, last, further)
                self._write_checksums()
                os.fsync(self._fd)
                stamp(self.part, last)
                check_readable(self._fd, self.part, list(self._variables.values()), self._offsets)
            except BaseException as error:
                failure = self._failure(error) if isinstance(error, OF_HDF5) else error
                self._keep_or_discard(failure)
                raise failure from (None if failure is error else error)
            self._publish()

    def _write_checksums(self) -> None:
        """Write the checksums of all values, the seal of the labels, then the checksum of all else in the file."""
        variables, places = list(self._variables.values()), self._offsets
        blocks = sum(block_count(variable.nbytes) for variable in variables)
        sums = np.array([self._sums[block] for block in range(blocks)], "u4")
        partial_file.write_all(self._fd, sums.view(np.uint8).data, places[OF_VALUES])
        position, sealed = seal(self._fd, self._file.places, places[OF_REST])
        partial_file.write_all(self._fd, memoryview(sealed), position)
        rest = np.array([of_file(self._fd, self._file.places, (places[OF_REST], places[OF_REST] + 4))], "u4")
        partial_file.write_all(self._fd, rest.view(np.uint8).data, places[OF_REST])

    def _publish(self) -> None:
        try:
            partial_file.publish(self._fd, self.part, self.path, self._overwrite)
        except OSError as error:
            what = f"{self.path}: cannot give the complete file its name ({reason(error)})"
            failure = refused(what, f"make way for it and run the same again, or rename {self.part}")
            with contextlib.suppress(OSError):  # where it has been closed for its renaming
                os.close(self._fd)
            raise failure from error
        self._journal.remove()

    def _resumed(self, lay_out: LayOut) -> bool:
        """Go on with a run of the same fingerprint, if there is one."""
        variables = list(self._variables.values())
        run = self._fingerprint, self._size, self._rows
        found = resume(self.part, run, variables, lay_out)
        if found is None:
            return False
        self._fd, self._offsets, self._sums = found.fd, found.offsets, found.sums
        self._ranges = Ranges(found.ranges)
        rows = [of_rows for designs in found.ranges for of_rows in self._rows.ranges(*designs)]
        for name, variable in self._variables.items():
            placement = variable.placement(self._size * self._rows.length)
            nbytes = sum(count for of_rows in rows for _, count in placement.pieces(*of_rows))
            self._values_written[name] = nbytes // variable.dtype.itemsize
        return True

    def _keep_or_discard(self, error: BaseException | None) -> None:
        """Keep the partial file where its journal names designs, to be resumed; else remove it."""
        if not self._journal.recorded:
            partial_file.discard(self._fd, self.part)
            self._journal.remove()
            return
        with contextlib.suppress(OSError):
            os.close(self._fd)
        share = sum(stop - start for start, stop in self._journal.recorded) / self._size
        if error is not None:
            error.add_note(f"{share:.0%} of the designs are kept in {self.part}; run the same again to go on")

    def _start(self, lay_out: LayOut) -> None:
        """Lay the file out, and reserve its room."""
        lay = partial(laid_in_memory, lay_out=lay_out, variables=list(self._variables.values()))
        self._fd, self._offsets = partial_file.begun(self.part, lay)
        try:
            # HDF5 gives back at the end what the attributes leave
            partial_file.reserve(self._fd, SLACK)
        except BaseException:
            partial_file.discard(self._fd, self.part)
            raise

    def _failure(self, error: Exception) -> InputError:
        return not_written(self.path, self._nbytes, error)

    def _close_to_writers(self) -> None:
        """Refuse further writes, wait for those under way, and record what is written.

        The file number may soon be of another file.
        """
        with self._idle:
            if self._closed:
                raise ValueError(f"{self.path}: the file is closed")
            self._closed = True
            self._idle.wait_for(lambda: self._writing == 0)
        self._journal.close()
