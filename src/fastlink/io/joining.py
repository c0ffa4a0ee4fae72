"""Put the parts of a map together: the coordinates and variables of the whole, and its values piece by piece."""

from __future__ import annotations

import contextlib
import glob
import hashlib
import math
import os
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr

from fastlink._text import counted, short_repr, unwritable
from fastlink.errors import InputError, Problem, Problems, check_path, remark
from fastlink.io.checksums import Range, Stored, check_own, open_to_read
from fastlink.io.layout import FINGERPRINT, HISTORY, MEASURED, WRITTEN, Variable, history
from fastlink.io.output_path import left_of, reason, refused
from fastlink.io.reader import (
    OF_PARTS,
    OR_COPY,
    WHOLE,
    Box,
    Part,
    PartOfMap,
    Shown,
    Source,
    as_dataset,
    check_open_files,
    check_seal,
    existing_map,
    is_hdf5,
    readable,
    scalar,
)
from fastlink.io.writer import Writer
from fastlink.machine import work_in_threads
from fastlink.space.design_space import DESIGN
from fastlink.space.tables import FORMAT

# -- The attributes of a joined map, from those of its parts


#: The number of parts that a map was joined from, and the seconds of all their threads.
JOINED, CORE_TIME = "joined_parts", "core_time_s"
#: What verification counts of a variable; the other attributes that it adds are errors.
COUNTS = ("verified_values", "verify_mismatches", "independent_values")
#: Global attributes that are sums over the parts, besides the numbers of designs.
SUMS = (
    *("configurations", "set_up_time_s", "run_time_s"),
    *("verified_designs", "verify_time_s", "verify_mismatches"),
)
#: What differs from part to part besides sums, and what parts may lack.
OF_VERIFICATION = ("verify_seed", "verify_left_out")
RATES = ("designs_per_second", "configurations_per_second")
EARLIER = "designs_of_earlier_runs"


def merged(parts: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return the global attributes that a map has at its end, from those of its parts."""
    # Numbers of designs and configurations, and times, are sums: ``run_time_s`` is that of the parts one
    # after the other, ``core_time_s`` that times their threads. Rates are those of a part, on the average.
    counts = {name for attrs in parts for name in attrs if name.startswith("designs_") and name != RATES[0]}
    sums = ["designs", *sorted(counts), *SUMS]
    result = {
        name: sum(attrs.get(name, 0) for attrs in parts) for name in sums if any(name in a for a in parts)
    }
    seconds = result.get("run_time_s", 0.0)
    result[CORE_TIME] = sum(attrs["run_time_s"] * attrs["threads"] for attrs in parts)
    result |= {"threads": max(attrs["threads"] for attrs in parts), JOINED: len(parts)}
    evaluated = result["designs"] - result.get(EARLIER, 0)
    for name, total in zip(RATES, ("designs", "configurations"), strict=True):
        if total in result and seconds > 0.0:
            result[name] = result[total] / result["designs"] * evaluated / seconds
    for attrs in parts:
        result |= {name: attrs[name] for name in OF_VERIFICATION if name in attrs}
    failed = dict.fromkeys(str(attrs["verify_failed"]) for attrs in parts if "verify_failed" in attrs)
    return result | ({"verify_failed": "; ".join(failed)} if failed else {})


def merged_errors(parts: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return what verification says of a variable, from what it says of it in each part."""
    # Counts are sums, errors the greatest of all parts; of their medians too, which the median of all does
    # not exceed.
    result: dict[str, Any] = {}
    for name in dict.fromkeys(name for attrs in parts for name in attrs):
        found = [attrs[name] for attrs in parts if name in attrs]
        result[name] = sum(found) if name in COUNTS else found[0] if isinstance(found[0], str) else max(found)
    return result


# -- The files of the parts of a map: found, complete, of one request, and their values checked as they are
#    read


#: Endings of files that are being written, which a folder may hold too.
OF_WRITER = (".part", ".new", ".journal")
#: Parts that are named where many are missing.
MOST_NAMED = 5
GIVE_PARTS = (
    "give the files that sweeps with part=... or `fastlink run --part ...` have written, or their folder"
)
RUN_AGAIN = "run that part again"


@dataclass(frozen=True)
class PartFile:
    """The file of a part."""

    #: The file.
    path: Path
    #: Which part of which map it is.
    of: PartOfMap
    #: Its global attributes.
    attrs: Mapping[str, Any]
    #: Its checksums.
    stored: Stored
    #: What verification says of each variable.
    measured: Mapping[str, Mapping[str, Any]]
    #: The checksum of all that is not values, and of their checksums, where it has a seal.
    labels: int | None

    def whole(self) -> xr.Dataset:
        """Return the coordinates that the part keeps of the whole."""
        coords = {}
        with readable(self.path), h5py.File(self.path, "r") as file:
            for name in file[WHOLE]:
                one = file[WHOLE][name]  # of what cannot be read items() has None
                values = one.asstr()[:] if h5py.check_string_dtype(one.dtype) else one[:]
                coords[name] = ((name,), values, {key: scalar(value) for key, value in one.attrs.items()})
            return xr.Dataset(coords=coords, attrs=dict(file[WHOLE].attrs))

    def check_labels(self) -> None:
        """Refuse the part if anything but its values has changed."""
        with self._opened() as fd:
            intact = self.stored.rest_is_intact(fd)
        if not intact:
            raise self._damaged("labels, attributes or checksums")

    def read(self, name: str, start: int, stop: int) -> Iterator[tuple[int, memoryview]]:
        """Yield bytes of the values of a variable in pieces with their positions; each block of them is checked."""
        with self._opened() as fd:
            for block, (first, _) in self.stored.blocks(name, start, stop):
                data = self.stored.read(fd, name, block)
                if data is None:
                    raise self._damaged(f"values of {name}")
                begin = max(first, start)
                yield begin, memoryview(data)[begin - first : stop - first]

    @contextlib.contextmanager
    def _opened(self) -> Iterator[int]:
        """Yield the number of the file, open to be read."""
        try:
            with open_to_read(self.path) as fd:
                yield fd
        except (OSError, EOFError) as error:
            raise refused(f"{self.path} cannot be read ({reason(error)})", RUN_AGAIN, "paths") from error

    def _damaged(self, what: str) -> InputError:
        what = f"{self.path}, part {self.of.part}: {what} have changed since they were written"
        return refused(what, f"{RUN_AGAIN}, with overwrite", "paths")


def part_files(paths: Any) -> list[PartFile]:
    """Return all parts of one map in order, or refuse them."""
    listed = list(paths) if isinstance(paths, (list, tuple, set, frozenset)) else [paths]
    problems, found = Problems(), dict[Path, PartFile]()
    for given in listed:
        with problems.at():
            for path, chosen in _expanded(given):
                real = Path(os.path.realpath(path))
                if real not in found and (part := _read(path, chosen)) is not None:
                    found[real] = part
    problems.stop()
    if not found:
        raise refused(f"{short_repr(paths)} holds no part of a map", GIVE_PARTS, "paths")
    return _complete(_of_one_map(list(found.values())))


def _expanded(given: Any) -> list[tuple[Path, bool]]:
    """Return the files of a path, a folder or a pattern, and whether each was chosen, not found in a folder."""
    path = check_path(("paths",), given, "maps.part-1-of-2.h5")
    if path.is_dir():
        return [(one, False) for one in sorted(path.iterdir()) if one.is_file()]
    if not path.exists() and glob.has_magic(str(path)):
        if files := sorted(glob.glob(str(path))):
            return [(Path(one), True) for one in files]
        raise refused(f"{short_repr(str(path))}: there is no such file", GIVE_PARTS, "paths")
    return [(path, True)]


def _read(path: Path, chosen: bool) -> PartFile | None:
    """Return a part; None of another file in a folder, which is refused where it was chosen."""
    try:
        if not chosen and (path.suffix in OF_WRITER or not is_hdf5(path)):
            return None
        labels = check_seal(existing_map(path))
        with h5py.File(path, "r") as file:
            check_own(path, file)
            attrs = {str(name): scalar(value) for name, value in file.attrs.items()}
            of = PartOfMap.of(attrs)
            if of is not None and WHOLE in file:
                stored = Stored.of(file)
                measured = {name: _measured(file[name].attrs) for name in stored.values}
                return PartFile(path, of, attrs, stored, measured, labels)
        if any(name in attrs for name in OF_PARTS):
            raise refused(
                f"{path}: what it says of its part has changed since it was written", RUN_AGAIN, "paths"
            )
        if chosen:
            what = "is a whole map, no part" if FORMAT in attrs else "is no part of a map"
            raise refused(f"{path} {what}", GIVE_PARTS, "paths")
    except InputError as error:
        raise InputError.of([Problem(one.what, ("paths",), one.remedy) for one in error.problems]) from None
    except (OSError, RuntimeError, KeyError, ValueError, TypeError, MemoryError) as error:
        raise refused(f"{path} cannot be read ({reason(error)})", GIVE_PARTS, "paths") from error
    return None


def _measured(attrs: Any) -> dict[str, Any]:
    """Return the attributes of a variable that come from verification."""
    return {name: scalar(attrs[name]) for name in attrs if name.startswith(MEASURED)}


def _of_one_map(parts: list[PartFile]) -> list[PartFile]:
    """Refuse parts of several maps, or of several divisions of one."""
    first, problems = parts[0], Problems()
    for part in parts[1:]:
        why = ""
        if part.of.whole != first.of.whole:
            sources = [str(one.attrs.get("source", "")) for one in (first, part)]
            by = "" if sources[0] == sources[1] else f" ({sources[0]}; {sources[1]})"
            why = f"of another request or by other versions{by}"
        elif part.of.part.count != first.of.part.count:
            why = f"part {part.of.part}, and {first.path.name} part {first.of.part}"
        if why:
            what = f"{part.path} and {first.path.name} do not belong together: it is {why}"
            problems.add(what, ("paths",), "give the parts of one map, all of the same n")
    problems.stop()
    return parts


def _complete(parts: Sequence[PartFile]) -> list[PartFile]:
    """Return the parts in order, each once; refuse two with different values, and a gap."""
    by_number: dict[int, PartFile] = {}
    problems = Problems()
    for part in parts:
        known = by_number.setdefault(part.of.part.number, part)
        if known is part:
            continue
        if (known.stored.sums, list(known.stored.values)) == (part.stored.sums, list(part.stored.values)):
            remark(f"{part.path} is part {part.of.part} as {known.path.name} is; one of them is read")
        else:
            what = f"{part.path} and {known.path.name} are both part {part.of.part}, with different values"
            problems.add(what, ("paths",), "give the right one, or run that part again")
    whole, count = parts[0].of, parts[0].of.part.count
    missing = [Part(k, count) for k in range(1, count + 1) if k not in by_number]
    for absent in missing[:MOST_NAMED]:
        start, stop = absent.range(whole.designs)
        which = f"part {absent.number} of {count} (designs {start:,} to {stop - 1:,}) is missing"
        if left := _unfinished(parts, absent):
            which += f"; {left.name} is of a run that has not finished"
        problems.add(which, ("paths",), f"run it, by part='{absent}' or `fastlink run --part {absent}`")
    if (more := len(missing) - MOST_NAMED) > 0:
        problems.add(f"{counted(more, 'more part')} of {count} are missing", ("paths",), "run all of them")
    problems.stop()
    return [by_number[k] for k in range(1, count + 1)]


def _unfinished(parts: Sequence[PartFile], part: Part) -> Path | None:
    """Return what a run has left of a part beside others, if there is such a file."""
    for other in parts:
        path = other.path.with_name(other.path.name.replace(other.of.part.mark, part.mark))
        if path != other.path and (left := left_of(path)):
            return left
    return None


#: Bytes of designs that are recorded together, for each few variables: what a kill loses is read again.
PIECE_BYTES, FEW = 256 << 20, 8


class JoinedMap:
    """The map that parts make together, as one sweep of the whole request writes it."""

    def __init__(self, parts: Sequence[PartFile]) -> None:
        #: The number of designs.
        self.parts, self.designs = parts, parts[0].of.designs
        self._whole = parts[0].whole()
        self._dims = tuple(str(self._whole.attrs["dims"]).split())
        self._shape = tuple(map(int, np.atleast_1d(self._whole.attrs["shape"]))) if self._dims else ()
        #: Consecutive designs that share each entry of a table or a sample.
        self._shared = math.prod(self._shape[1:])
        for part in parts:
            part.check_labels()
        with as_dataset(parts[0].path) as opened:
            labels = {name: [values] for name, values in self._labels(opened, parts[0]).items()}
            for part in parts[1:] if labels else ():
                with as_dataset(part.path) as other:
                    for name, values in self._labels(other, part).items():
                        labels[name].append(values)
            #: Coordinates, and the global attributes that are known before its values.
            self.coords = self._coordinates(opened, {name: np.concatenate(v) for name, v in labels.items()})
            #: The results, and the coordinates that are copied piece by piece.
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
        """Return what a map in a folder can show of the parts, so that it need not be copied; None of one design."""
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
                    length = len(pieces[-1][1])
                    position, room, rest = position + length, room - length, rest[length:]
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
        others = {*opened.data_vars, *self._whole.coords}
        return [name for name in self.parts[0].stored.values if name not in others]

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
        attrs = {
            str(name): value for name, value in found.attrs.items() if not str(name).startswith(MEASURED)
        }
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
