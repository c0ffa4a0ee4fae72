"""Put the parts of a map together: the coordinates and variables of the whole, and its values piece by piece."""

from __future__ import annotations

import hashlib
import math
import os
import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from fastlink._text import unwritable
from fastlink.io.dataset import Variable
from fastlink.io.finished import FINGERPRINT, WRITTEN
from fastlink.io.history import HISTORY, history
from fastlink.io.merged import is_measured, merged, merged_errors
from fastlink.io.part_files import PartFile
from fastlink.io.parts import OF_PARTS, OR_COPY, Box, Shown, Source, check_open_files
from fastlink.io.place import refused
from fastlink.io.ranges import Range
from fastlink.io.writing.writer import Writer
from fastlink.space.dataset import FORMAT
from fastlink.space.design_space import DESIGN
from fastlink.threads import work_in_threads

__all__ = ["JoinedMap"]

#: Bytes of designs that are recorded together, for each few variables: what a kill loses is read again.
PIECE_BYTES, FEW = 256 << 20, 8


class JoinedMap:
    """The map that parts make together, as one sweep of the whole request writes it.

    Parameters
    ----------
    parts : sequence of PartFile
        All parts, in order.

    Attributes
    ----------
    coords : xarray.Dataset
        Coordinates, and the global attributes that are known before its values.
    variables : list of Variable
        The results, and the coordinates that are copied piece by piece.
    designs : int
        The number of designs.
    """

    def __init__(self, parts: Sequence[PartFile]) -> None:
        self.parts, self.designs = parts, parts[0].of.designs
        self._whole = parts[0].whole()
        self._dims = tuple(str(self._whole.attrs["dims"]).split())
        self._shape = tuple(map(int, np.atleast_1d(self._whole.attrs["shape"]))) if self._dims else ()
        #: Consecutive designs that share each entry of a table or a sample.
        self._shared = math.prod(self._shape[1:])
        for part in parts:
            part.check_labels()
        with parts[0].dataset() as opened:
            labels = {name: [values] for name, values in self._labels(opened, parts[0]).items()}
            for part in parts[1:] if labels else ():
                with part.dataset() as other:
                    for name, values in self._labels(other, part).items():
                        labels[name].append(values)
            self.coords = self._coordinates(opened, {name: np.concatenate(v) for name, v in labels.items()})
            self.variables = [self._variable(one) for one in opened.data_vars.values()]
            self.variables += [self._column(opened[name]) for name in self._streamed(opened)]

    @property
    def fingerprint(self) -> str:
        """The hash of the whole request."""
        return self.parts[0].of.whole

    def run(self, shown: Shown | None) -> tuple[str, int]:
        """Return the hash of these parts, or of what is shown of them, and the number of designs."""
        what = (
            ("joined", [part.stored.sums for part in self.parts]) if shown is None else ("shown", shown.files)
        )
        return hashlib.sha256(repr((self.fingerprint, *what)).encode()).hexdigest(), self.designs

    def shown_in(self, folder: Path) -> Shown | None:
        """Return what a map in a folder can show of the parts, so that it need not be copied; None of one design.

        Raises
        ------
        InputError
            A part is not in the folder or below it, or has no seal by which a later change of it would be seen.
        """
        if not self._dims:
            return None
        check_open_files(len(self.parts))
        files = dict[str, int]()
        for part in self.parts:
            real = Path(os.path.realpath(part.path))
            if not real.is_relative_to(folder):
                remedy = ("write the map into the folder of its parts, or into one above", OR_COPY)
                raise refused(f"{part.path} is not in {folder} or below", remedy)
            name = real.relative_to(folder).as_posix()
            if unwritable(name):
                what, remedy = "has a name that no map can hold", ("give it a name of letters", OR_COPY)
                raise refused(f"{part.path} {what}", remedy, "paths")
            if part.labels is None:
                what = f"{part.path} has no seal, which another program has taken"
                raise refused(what, ("run that part again, with overwrite", OR_COPY), "paths")
            files[name] = part.labels
        # the numbers of designs that several rows share are other ones in the map than in its parts.
        names = [one for one in self.variables if one.name != DESIGN or self._shared == 1]
        return Shown(files, {one.name: list(self._sources(one, list(files))) for one in names})

    def _sources(self, variable: Variable, files: Sequence[str]) -> Iterator[Source]:
        """Yield where the values of a variable are in the files of the parts."""
        own, inner = variable.shape[: variable.leading], variable.shape[variable.leading + len(self._shape) :]

        def around(begin: tuple[int, ...], counts: tuple[int, ...], step: int = 1) -> Box:
            starts = (*[0] * len(own), *begin, *[0] * len(inner))
            return starts, (*[1] * len(own), *[step] * len(begin), *[1] * len(inner)), (*own, *counts, *inner)

        for part, name in zip(self.parts, files, strict=True):
            start, stop = part.of.range
            shape = (*own, stop - start, *inner)
            if variable.is_coordinate:  # of the first of the designs that share an entry
                inner, shared, first = (), self._shared, -(-start // self._shared)
                if count := -(-stop // shared) - first:
                    yield (
                        name,
                        (stop - start,),
                        around((first,), (count,)),
                        around((-start % shared,), (count,), shared),
                    )
            else:
                at = 0
                for begin, counts in _boxes(self._shape, start, stop):
                    count = math.prod(counts)
                    yield name, shape, around(begin, counts), around((at,), (count,))
                    at += count

    def last_attrs(self, name: str) -> dict[str, Any]:
        """Return the global attributes that the map has at its end, in a file of some name."""
        before = str(self.parts[0].attrs.get(HISTORY, ""))
        made = {HISTORY: history(f"join {len(self.parts)} parts to {name}", before)}
        return merged([part.attrs for part in self.parts]) | {FINGERPRINT: self.fingerprint} | made

    @property
    def errors(self) -> dict[str, dict[str, Any]]:
        """The measured errors of each variable, as attributes."""
        names = [variable.name for variable in self.variables if not variable.is_coordinate]
        return {name: merged_errors([part.measured[name] for part in self.parts]) for name in names}

    def copy(
        self, writer: Writer, threads: int, done: Callable[[int, int], None], shown: Shown | None = None
    ) -> None:
        """Write the values that are missing in a file; `done` takes each range of designs that is written."""
        copied = [one for one in self.variables if shown is None or one.name not in shown.sources]
        if not copied:  # a kill from now on leaves what the same join goes on with
            for designs in writer.pending:
                writer.record(*designs)
                done(*designs)
            return
        pieces, lock, stop = self._pieces(writer.pending), threading.Lock(), threading.Event()

        def work() -> None:
            while not stop.is_set():
                with lock:
                    part, start, end = next(pieces, (None, 0, 0))
                if part is None:
                    return
                for variable in copied:
                    if variable.is_coordinate:
                        self._copy_column(variable, part, (start, end), writer)
                    else:
                        self._copy_values(variable, part, (start, end), writer)
                writer.record(start, end)
                done(start, end)

        work_in_threads(work, threads, "fastlink-join", stop)

    def _pieces(self, pending: Sequence[Range]) -> Iterator[tuple[PartFile | None, int, int]]:
        """Yield designs to copy, so many at once that few blocks of a part are read for two pieces."""
        of_design = sum(variable.nbytes for variable in self.variables) / self.designs
        step = max(1, int(PIECE_BYTES * -(-len(self.variables) // FEW) / max(of_design, 1.0)))
        if any(variable.leading for variable in self.variables):  # a piece would be of all blocks
            step = self.designs
        for part in self.parts:
            first, last = part.of.range
            for start, stop in pending:
                for begin in range(max(first, start), min(last, stop), step):
                    yield part, begin, min(begin + step, last, stop)

    def _copy_values(self, variable: Variable, part: PartFile, designs: Range, writer: Writer) -> None:
        """Copy the values of some designs of a part."""
        (first, last), (start, stop) = part.of.range, designs
        of_whole = variable.placement(self.designs)
        of_part = replace(of_whole, rows=last - first)
        places = iter(of_whole.pieces(start, stop))
        position, room = next(places)
        for begin, count in of_part.pieces(start - first, stop - first):
            for _, data in part.read(variable.name, begin, begin + count):
                pieces, rest = [], data
                while rest:
                    if not room:
                        position, room = next(places)
                    pieces.append((position, rest[:room]))
                    taken = len(pieces[-1][1])
                    position, room, rest = position + taken, room - taken, rest[taken:]
                writer.write_pieces(variable.name, pieces)

    def _copy_column(self, column: Variable, part: PartFile, designs: Range, writer: Writer) -> None:
        """Copy a coordinate of some designs of a part, the first of those that share an entry."""
        first, itemsize, shared = part.of.range[0], column.dtype.itemsize, self._shared
        start, stop = ((design - first) * itemsize for design in designs)
        for position, data in part.read(column.name, start, stop):
            begin = first + position // itemsize
            values = np.frombuffer(data, column.dtype)[-begin % shared :: shared]
            if column.name == DESIGN:  # flat numbers, unless none are shared
                values = values // shared
            writer.write(column.name, -(-begin // shared), np.ascontiguousarray(values))

    def _streamed(self, opened: xr.Dataset) -> list[str]:
        """Return the coordinates of tables and samples that stand among the values of a part."""
        if DESIGN not in self._dims:
            return []
        elsewhere = {*opened.data_vars, *self._whole.coords}
        return [name for name in self.parts[0].stored.values if name not in elsewhere]

    def _labels(self, opened: xr.Dataset, part: PartFile) -> dict[str, Any]:
        """Return the other coordinates of a part along the designs of a table, each design once."""
        if DESIGN not in self._dims:
            return {}
        left_out, start = {*self._streamed(opened), *self._whole.coords}, part.of.range[0]
        found = {
            str(name): one.values[-start % self._shared :: self._shared]
            for name, one in opened.coords.items()
            if one.dims == (DESIGN,) and name not in left_out
        }
        if DESIGN in self._whole.coords:  # the numbers of a table, of all designs that have rows in the part
            found[DESIGN] = part.whole()[DESIGN].values[int(start % self._shared > 0) :]
        elif DESIGN in found:
            found[DESIGN] = found[DESIGN] // self._shared
        return found

    def _coordinates(self, opened: xr.Dataset, labels: dict[str, Any]) -> xr.Dataset:
        """Return the coordinates of the whole: those of the first part, the axes, and those along all designs."""
        coords: dict[str, Any] = {
            str(name): one.variable.load() for name, one in opened.coords.items() if DESIGN not in one.dims
        }
        coords |= {str(name): one.variable for name, one in self._whole.coords.items() if name != DESIGN}
        for name, values in labels.items():
            coords[name] = ((DESIGN,), values, opened[name].attrs)
        last = {
            *merged([part.attrs for part in self.parts]),
            FINGERPRINT,
            HISTORY,
            WRITTEN,
            FORMAT,
            *OF_PARTS,
        }
        attrs = {name: value for name, value in opened.attrs.items() if name not in last}
        return xr.Dataset(coords=coords, attrs=attrs).drop_encoding()

    def _variable(self, found: xr.DataArray) -> Variable:
        """Return a result of the whole, from that of a part."""
        own = [(str(dim), found.sizes[dim]) for dim in found.dims if dim != DESIGN]
        swept = list(zip(self._dims, self._shape, strict=True))
        leading = found.dims.index(DESIGN) if swept else 0
        axes = own + swept if leading else swept + own
        attrs = {str(name): value for name, value in found.attrs.items() if not is_measured(str(name))}
        dims, shape = tuple(dim for dim, _ in axes), tuple(length for _, length in axes)
        return Variable(str(found.name), dims, shape, found.dtype, attrs, leading)

    def _column(self, found: xr.DataArray) -> Variable:
        """Return a coordinate of the whole that is copied piece by piece."""
        shape = (self._shape[0],)
        return Variable(str(found.name), (DESIGN,), shape, found.dtype, found.attrs, is_coordinate=True)


def _boxes(
    shape: tuple[int, ...], start: int, stop: int
) -> Iterator[tuple[tuple[int, ...], tuple[int, ...]]]:
    """Yield the boxes, first indices and lengths, that consecutive values of an array in C order are, in order.

    >>> list(_boxes((3, 4), 2, 9))
    [((0, 2), (1, 2)), ((1, 0), (1, 4)), ((2, 0), (1, 1))]
    """
    if len(shape) == 1:
        yield (start,), (stop - start,)
        return
    of_row, at = math.prod(shape[1:]), start
    while at < stop:
        row, begin = divmod(at, of_row)
        if not begin and (rows := (stop - at) // of_row):
            yield (row, *[0] * len(shape[1:])), (rows, *shape[1:])
            at += rows * of_row
        else:
            end = min(of_row, begin + stop - at)
            for first, counts in _boxes(shape[1:], begin, end):
                yield (row, *first), (1, *counts)
            at += end - begin
