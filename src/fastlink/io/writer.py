"""Write labelled HDF5 files block by block; only complete ones get their name."""

from __future__ import annotations

import contextlib
import math
import os
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any, Literal, Protocol

import h5py
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from fastlink.errors import InputError, remark
from fastlink.io import partial_file
from fastlink.io.checksums import (
    ALGORITHM,
    BLOCK_BYTES,
    CHECKSUMS,
    OF_REST,
    OF_VALUES,
    Range,
    add,
    all_but,
    block_count,
    count_of,
    joined_ranges,
    missing,
    of_pieces,
    read_all,
)
from fastlink.io.layout import (
    FINGERPRINT,
    FORMAT_VERSION,
    WRITTEN,
    Placement,
    Variable,
    check_dims,
    plain_attrs,
)
from fastlink.io.output_path import SLACK, not_written, part_of, reason, refused
from fastlink.io.partial_file import (
    Journal,
    check_left,
    check_target,
    create,
    read_journal,
    released,
    reserve,
    synchronise,
    uninterrupted,
    write_all,
)
from fastlink.io.reader import LABELS, NAMES, WHOLE, Shown, Source, as_source
from fastlink.space.tables import FORMAT

# -- Put blocks of values in the order of the file, and cut them where its pieces end


#: Designs that are put in order at once: of each value as many as fill a few lines of the cache.
LINES = 32


class OfThread(threading.local):
    """Addends to checksums of designs that a thread has not recorded yet, and its room to put values in order."""

    def __init__(self) -> None:
        self.addends: list[tuple[int, int]] = []
        self._room = np.empty(0, np.uint8)

    def by_value(self, block: NDArray[Any]) -> NDArray[Any]:
        """Return a block value by value, in the room of this thread: it lasts until the next one."""
        rows = block.reshape(len(block), -1)
        if self._room.nbytes < rows.nbytes:
            self._room = np.empty(rows.nbytes, np.uint8)
        result = self._room[: rows.nbytes].view(rows.dtype).reshape(rows.shape[::-1])
        for k in range(0, len(rows), LINES):
            result[:, k : k + LINES] = rows[k : k + LINES].T
        return result


def cut(data: memoryview, places: list[Range]) -> Iterator[tuple[int, memoryview]]:
    """Yield the position of each piece and its bytes, which follow each other."""
    begin = 0
    for position, count in places:
        yield position, data[begin : begin + count]
        begin += count


# -- Lay out a map file: coordinates by xarray, contiguous variables by h5py


PAGE_BYTES = 4096
#: What a file that cannot be read or written raises, through HDF5 too.
OF_HDF5 = (OSError, EOFError, RuntimeError, KeyError)
ALIGNED = {"alignment_threshold": PAGE_BYTES, "alignment_interval": PAGE_BYTES}
#: The driver of HDF5 that opens a file without a name; the usual one asks for the name behind a link.
NAMELESS: Any = {"driver": "stdio"}


def lay_out(
    path: Path,
    coords: xr.Dataset,
    variables: Sequence[Variable],
    attrs: Mapping[str, Any],
    whole: xr.Dataset | None = None,
    shown: Shown | None = None,
) -> dict[str, int]:
    """Write labels to a file that exists, and reserve room for values; return the variables' offsets."""
    # `whole` are coordinates of the map that the file is a part of, `shown` the variables whose values stay
    # in parts.
    shown = shown or Shown({}, {})
    labels = coords.nbytes + (0 if whole is None else whole.nbytes) + shown.nbytes + SLACK
    with open(path, "r+b") as file:  # where HDF5 had no room it might crash the process, or not say why
        reserve(file.fileno(), labels)
        stored = [variable for variable in variables if variable.name not in shown.sources]
        file.truncate(labels + sum(variable.nbytes for variable in stored))
    labelled = coords.assign_attrs(plain_attrs(attrs))
    computed = [variable for variable in variables if variable.is_coordinate]
    computed.sort(key=lambda variable: variable.dims != (variable.name,))  # the dimension of the others first
    scales = [variable.name for variable in computed if variable.dims == (variable.name,)]
    along = [name for name, coord in coords.coords.items() if set(scales) & set(coord.dims)]
    _to_netcdf(path, labelled.drop_vars(along), "w")
    with h5py.File(path, "r+", **ALIGNED, **NAMELESS) as file:
        offsets = {variable.name: _create(file, coords, variable, [], shown) for variable in computed}
    if along:
        _to_netcdf(path, coords[along].reset_coords()[along].drop_attrs(deep=False), "a")
    with h5py.File(path, "r+", **ALIGNED, **NAMELESS) as file:
        if whole is not None:
            _keep_whole(file, whole)
        _keep_names(file, shown)
        offsets |= create_checksums(file, stored)
        results = [variable for variable in variables if not variable.is_coordinate]
        return offsets | {
            variable.name: _create(file, coords, variable, computed, shown) for variable in results
        }


def lay_labels(path: Path, coords: xr.Dataset, attrs: Mapping[str, Any]) -> None:
    """Create the file with its coordinates and global attributes alone."""
    with scratch() as (other, fd):
        reserve(fd, coords.nbytes + SLACK)
        _to_netcdf(other, coords.assign_attrs(plain_attrs(attrs)), "w")
        with os.fdopen(create(path), "r+b", buffering=0) as file:
            copy_labels(fd, file.fileno(), {})


def as_bytes(dataset: xr.Dataset) -> bytes:
    """Return the HDF5 file of a small dataset, made in memory."""
    with scratch() as (path, _):
        _to_netcdf(path, dataset, "w")
        return path.read_bytes()


def create_checksums(file: Any, variables: Sequence[Variable]) -> dict[str, int]:
    """Create the checksums of the values of some variables, and of all else; return their offsets."""
    group = file.create_group(CHECKSUMS)
    about = {"algorithm": ALGORITHM, "block_bytes": BLOCK_BYTES}
    group.attrs.update(plain_attrs(about | {"variables": " ".join(v.name for v in variables)}))
    sizes = {OF_VALUES: sum(block_count(variable.nbytes) for variable in variables), OF_REST: 1}
    offsets = {
        name: _reserved(group, name.partition("/")[2], (n,), "u4")[1] for name, n in sizes.items() if n
    }
    if OF_VALUES not in offsets:
        file.create_dataset(OF_VALUES, (0,), "u4")
    return offsets


def _keep_whole(file: Any, whole: xr.Dataset) -> None:
    """Keep coordinates of a whole map in a group."""
    # They are plain arrays: the netCDF library would take their dimensions for those of the same name
    # outside.
    group = file.create_group(WHOLE)
    group.attrs.update(plain_attrs(whole.attrs))
    for name, coord in whole.coords.items():
        values = coord.values.astype(object) if coord.dtype.kind == "U" else coord.values
        group.create_dataset(name, data=values, track_times=False).attrs.update(plain_attrs(coord.attrs))


def _keep_names(file: Any, shown: Shown) -> None:
    """Keep the names of the parts whose values a map shows, and the checksums of their labels."""
    if shown.files:
        names = np.array([os.fsencode(name) for name in shown.files])
        file.create_dataset(NAMES, data=names, track_times=False)
        file.create_dataset(LABELS, data=np.array(list(shown.files.values()), "u4"), track_times=False)


def _to_netcdf(path: Path, coords: xr.Dataset, mode: Literal["w", "a"]) -> None:
    """Write coordinates to a file, or to one that has others."""
    # without _FillValue: None xarray declares NaN a fill value of every coordinate
    encoding = {name: {"_FillValue": None} for name in coords.variables}
    store = xr.backends.H5NetCDFStore.open(str(path), mode, **NAMELESS)
    try:
        coords.dump_to_store(store, encoding=encoding)
    finally:
        store.close()


@contextlib.contextmanager
def scratch() -> Iterator[tuple[Path, int]]:
    """Yield path and number of an empty file for HDF5 to write: in memory and nameless, where there are such files."""
    # An error of the disk amid HDF5's own writes may end the process by a violation of memory; amid ours,
    # which copy the file to its place, it is an exception. A file without a name is gone with the process,
    # however that ends.
    if hasattr(os, "memfd_create"):
        fd = os.memfd_create("fastlink.h5")
        try:
            path = Path(f"/proc/self/fd/{fd}")
            if path.exists():
                yield path, fd
                return
        finally:
            os.close(fd)
    fd, name = tempfile.mkstemp(".h5", "fastlink-")
    try:
        yield Path(name), fd
    finally:
        os.close(fd)
        os.unlink(name)


def copy_labels(source: int, target: int, values: Mapping[int, int]) -> None:
    """Give an open file all bytes of another besides values, which are so many from somewhere, and its length."""
    for position, labels in all_but(source, values):
        write_all(target, memoryview(labels), position)
    os.ftruncate(target, os.fstat(source).st_size)


def _create(
    file: Any, coords: xr.Dataset, variable: Variable, computed: Sequence[Variable], shown: Shown
) -> int:
    """Create one dataset with its labels, contiguous with its space unless it is shown; return its offset."""
    plist = _of_sources(variable, shown.sources[variable.name]) if variable.name in shown.sources else None
    dataset, offset = _reserved(file, variable.name, variable.shape, variable.dtype, plist)
    if variable.dims == (variable.name,):
        dataset.make_scale(variable.name)
    label(file, dataset, coords, variable, computed)
    return offset


def _of_sources(variable: Variable, sources: Sequence[Source]) -> Any:
    """Return the properties of a dataset whose values are those of datasets of the same name in other files."""
    # Other readers see NaN, or the least or greatest integer, where a file is missing.
    plist = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    whole = None if variable.dtype.kind == "f" else np.iinfo(variable.dtype)
    plist.set_fill_value(np.array(whole.min or whole.max if whole else np.nan, variable.dtype))
    for name, shape, box, own in sources:
        spaces = []
        for lengths, (starts, steps, counts) in ((variable.shape, box), (shape, own)):
            spaces.append(h5py.h5s.create_simple(lengths))
            spaces[-1].select_hyperslab(starts, counts, steps)
        plist.set_virtual(spaces[0], os.fsencode(as_source(name)), variable.name.encode(), spaces[1])
    return plist


def label(
    file: Any, dataset: Any, coords: xr.Dataset, variable: Variable, computed: Sequence[Variable] = ()
) -> None:
    """Give a dataset its dimensions, its attributes, and the names of further coordinates."""
    for axis, dim in enumerate(variable.dims):
        # unless attached, dimensions are matched by length and equal axes are swapped
        if dim != variable.name:
            dataset.dims[axis].attach_scale(file[dim])
    dataset.attrs.update(plain_attrs(variable.attrs))
    along = auxiliary(coords, variable, computed)
    if along and not variable.is_coordinate:
        dataset.attrs["coordinates"] = along


def auxiliary(coords: xr.Dataset, variable: Variable, computed: Sequence[Variable] = ()) -> str:
    """Return the names of the coordinates of a variable that are no axes of it, as CF lists them."""
    along = {str(name): coord.dims for name, coord in coords.coords.items()}
    along |= {one.name: one.dims for one in computed}
    return " ".join(
        name for name, dims in along.items() if name not in variable.dims and set(dims) <= set(variable.dims)
    )


def _reserved(
    group: Any, name: str, shape: tuple[int, ...], dtype: Any, virtual: Any = None
) -> tuple[Any, int]:
    """Create one contiguous dataset with its space; return it and its offset, -1 of one that is virtual."""
    plist = virtual or h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    if not virtual:
        plist.set_layout(h5py.h5d.CONTIGUOUS)
        plist.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
        plist.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    plist.set_obj_track_times(False)  # time stamps would make equal results differ
    # low level: Group.create_dataset drops the property list of a scalar
    identifier = h5py.h5d.create(
        group.id,
        name.encode(),
        h5py.h5t.py_create(np.dtype(dtype), logical=True),
        h5py.h5s.create_simple(shape) if shape else h5py.h5s.create(h5py.h5s.SCALAR),
        plist,
    )
    offset = -1 if virtual else identifier.get_offset()
    if offset is None:
        raise RuntimeError(f"HDF5 has reserved no space for {name}")
    return h5py.Dataset(identifier), int(offset)


def set_attrs(
    fd: int,
    values: Mapping[int, int],
    attrs: Mapping[str, Any],
    of_variables: Mapping[str, Mapping[str, Any]],
) -> None:
    """Add attributes, global and of variables, to an open file whose values are so many bytes from somewhere."""
    with scratch() as (path, other):
        copy_labels(fd, other, values)
        with h5py.File(path, "r+", **NAMELESS) as file:
            for group, added in (("/", attrs), *of_variables.items()):
                file[group].attrs.update(added)
        copy_labels(other, fd, values)


def check_readable(fd: int, path: Path, variables: Sequence[Variable], offsets: Mapping[str, int]) -> None:
    """Fail unless a file that is locked by `fd` can be opened, and its variables are where they were laid."""
    with contextlib.ExitStack() as stack:
        try:
            # this process holds the lock that HDF5 would ask for
            file = stack.enter_context(h5py.File(path, "r", locking=False))
        except BlockingIOError:  # HDF5_USE_FILE_LOCKING=TRUE in the environment overrules locking=False
            stack.enter_context(released(fd))
            file = stack.enter_context(h5py.File(path, "r"))
        for variable in variables:
            found = file[variable.name]
            dims = tuple(str(scale[0].name).removeprefix("/") for scale in found.dims if len(scale))
            dims = dims or (variable.name,) * len(found.shape)  # a dimension itself
            layout = found.shape, found.dtype, dims, found.id.get_offset()
            if layout != (variable.shape, variable.dtype, variable.dims, offsets[variable.name]):
                raise RuntimeError(f"{variable.name} is not where it was laid out")


# -- Go on with the partial file of a run that did not end


LayOut = Callable[[Path], dict[str, int]]
#: Bytes that a thread reads at once, whole blocks.
READ_BYTES = 4 * BLOCK_BYTES


class Rows(Protocol):
    """Tells which rows of a file follow from a design that is evaluated, `length` from each."""

    @property
    def length(self) -> int:
        """How many rows follow from each design."""

    def ranges(self, start: int, stop: int) -> Iterable[Range]:
        """Return the ranges of rows that follow from a range of designs."""

    def evaluated(self, start: int, stop: int) -> Iterable[Range]:
        """Return the ranges of designs that a range of rows follows from."""


class SameRows:
    """The rows of a file whose designs are all evaluated."""

    length = 1

    def ranges(self, start: int, stop: int) -> list[Range]:
        """Return the range itself."""
        return [(start, stop)]

    evaluated = ranges


SAME_ROWS = SameRows()


def resume(
    part: Path, fingerprint: str, values: Callable[[int, Mapping[str, int]], ValuesFile], lay_out: LayOut
) -> tuple[ValuesFile, list[Range], dict[int, int]] | None:
    """Hold the partial file of an earlier run of the same fingerprint, if there is one that can be gone on with."""
    # Its labels are laid out again, and its values read: designs whose values have changed since are to be
    # written again.
    journal = read_journal(part) if fingerprint else None
    if journal is None or journal[0].get("fingerprint") != fingerprint:
        return None
    fd = partial_file.reopened(part)
    if fd is None:
        return None
    about, written, sums = journal
    try:
        with scratch() as (path, laid):
            offsets = lay_out(path)
            if offsets != about["offsets"]:
                os.close(fd)
                return None
            file = values(fd, offsets)
            copy_labels(laid, fd, file.extents)  # its own labels may be torn or changed
        reserve(fd, SLACK)
        whole, found = written, file.sums(written)  # what was cut off reads as zeros
        wrong = [block for block in sums.keys() | found.keys() if sums.get(block) != found.get(block)]
        if wrong:
            whole = file.without(wrong, written)
            found = file.sums(whole)
            lost = count_of(written) - count_of(whole)
            remark(f"{part}: the values of {lost:,} designs have changed; they are computed again")
    except BaseException:
        os.close(fd)
        raise
    return file, whole, found


def _groups(places: list[Range]) -> Iterator[list[Range]]:
    """Yield pieces of bytes, cut at whole blocks, together as many as are read at once."""
    group, nbytes = list[Range](), 0
    for position, count in places:
        stop = position + count
        for begin in [position, *range((position // READ_BYTES + 1) * READ_BYTES, stop, READ_BYTES)]:
            part = min(READ_BYTES - begin % READ_BYTES, stop - begin)
            if nbytes + part > READ_BYTES:
                yield group
                group, nbytes = [], 0
            group.append((begin, part))
            nbytes += part
    if group:
        yield group


# -- Write blocks of values where they lie in a laid-out file, and tell what they add to its checksums


class ValuesFile:
    """The values in a laid-out file, of so many designs that are evaluated and the rows that follow from each."""

    def __init__(
        self,
        fd: int,
        offsets: Mapping[str, int],
        variables: Sequence[Variable],
        size: int = 0,
        rows: Rows = SAME_ROWS,
    ) -> None:
        self.fd, self.offsets, self._size, self._rows = fd, dict(offsets), size, rows
        self._variables = {variable.name: variable for variable in variables}
        counts = [block_count(variable.nbytes) for variable in variables]
        self._first_block = {one.name: sum(counts[:k]) for k, one in enumerate(variables)}
        #: The bytes of the values of each variable, by where they begin.
        self.extents = {offsets[variable.name]: variable.nbytes for variable in variables}
        self.of_thread = OfThread()

    def pieces(self, name: str, start: int, block: NDArray[Any]) -> list[tuple[int, memoryview]]:
        """Return the bytes of a block, each piece with its position from the first value. See `Writer.write`."""
        places = self._places(name, start, block)
        in_order = self.of_thread.by_value(block) if self._variables[name].leading else block
        return list(cut(in_order.reshape(-1).view(np.uint8).data, places))

    def put(self, name: str, pieces: Sequence[tuple[int, memoryview]]) -> list[tuple[int, int]]:
        """Write pieces, and return what they add to the checksums; thread-safe."""
        for position, data in pieces:
            partial_file.write_all(self.fd, data, self.offsets[name] + position)
        return self._addends(name, pieces)

    def _addends(self, name: str, pieces: Iterable[tuple[int, Any]]) -> list[tuple[int, int]]:
        first = self._first_block[name]
        return [(first + k, addend) for k, addend in of_pieces(pieces, self._variables[name].nbytes)]

    def _places(self, name: str, start: int, block: NDArray[Any]) -> list[Range]:
        """Return where the pieces of a block lie among the values of its variable, or refuse one that does not fit."""
        variable = self._variables[name]
        if block.dtype != variable.dtype:
            raise TypeError(f"{name}: block is {block.dtype}, the variable {variable.dtype}")
        if not block.flags.c_contiguous:
            raise ValueError(f"{name}: block is not C-contiguous")
        shape, leading = variable.shape, variable.leading
        swept = leading or len(shape) - (block.ndim - 1)
        own, designs = (shape[:swept], shape[swept:]) if leading else (shape[swept:], shape[:swept])
        if block.ndim == 0 or swept < 0 or block.shape[1:] != own:
            raise ValueError(f"{name}: a block of shape {block.shape} does not hold rows of {shape}")
        count = math.prod(designs)
        if not 0 <= start <= start + len(block) <= count:
            raise ValueError(f"{name}: designs {start} to {start + len(block)} of {count}")
        return variable.placement(count).pieces(start, start + len(block))

    def places(self, ranges: Iterable[Range]) -> Iterator[tuple[str, list[Range]]]:
        """Yield where the values of some designs lie among those of each variable."""
        for name, variable in self._variables.items():
            placement = self._placement(variable)
            for designs in ranges:
                for start, stop in self._rows.ranges(*designs):
                    yield name, placement.pieces(start, stop)

    def sums(self, ranges: Iterable[Range]) -> dict[int, int]:
        """Return the checksums of the values of some designs, by block, as they are read."""

        def of_group(group: tuple[str, list[Range]]) -> list[tuple[int, int]]:
            name, places = group
            offset = self.offsets[name]
            pieces = ((at, memoryview(read_all(self.fd, count, offset + at))) for at, count in places)
            return self._addends(name, pieces)

        groups = ((name, group) for name, places in self.places(ranges) for group in _groups(places))
        result: dict[int, int] = {}
        with ThreadPoolExecutor() as pool:
            for addends in pool.map(of_group, groups):
                add(result, addends)
        return result

    def without(self, blocks: Sequence[int], ranges: list[Range]) -> list[Range]:
        """Return ranges without the designs that have values in some blocks."""
        gone = missing(ranges, self._size)
        for name, variable in self._variables.items():
            for block in blocks:
                start = (block - self._first_block[name]) * BLOCK_BYTES
                if 0 <= start < variable.nbytes:
                    stop = min(start + BLOCK_BYTES, variable.nbytes)
                    for rows in self._placement(variable).rows_in(start, stop):
                        gone += self._rows.evaluated(*rows)
        return missing(joined_ranges(gone), self._size)

    def _placement(self, variable: Variable) -> Placement:
        """Return where the values of each design lie."""
        return variable.placement(self._size * self._rows.length)


# -- Write into the file of a run from another process or machine that sees it, and report what was written


class NotSeenError(Exception):
    """The file of a run is not seen from this machine."""


@dataclass
class Written:
    """An account of what was written and is on the disk."""

    #: The designs whose every result is written.
    ranges: list[Range] = field(default_factory=list)
    #: What their values add to the checksums, by block.
    addends: dict[int, int] = field(default_factory=dict)
    #: The bytes of the values of each variable.
    nbytes: dict[str, int] = field(default_factory=dict)


class RemoteWriter:
    """A stand-in for a `Writer` in another process, for the designs of one task; a context manager."""

    # It opens the file anew for each task: the system reports an error of writing once for each time that a
    # file is open, and the synchronisation of one thread would take that of another.

    def __init__(
        self,
        part: Path,
        token: Mapping[int, bytes],
        offsets: Mapping[str, int],
        variables: Sequence[Variable],
    ) -> None:
        self._part, self._token, self._offsets = part, dict(token), dict(offsets)
        self._variables = [replace(variable, attrs={}) for variable in variables]
        self._written = Written()

    def __enter__(self) -> RemoteWriter:
        self._fd = self._opened()
        self._file = ValuesFile(self._fd, self._offsets, self._variables)
        return self

    def __exit__(self, *error: object) -> None:
        os.close(self._fd)

    def write(self, name: str, start: int, block: NDArray[Any]) -> None:
        """Write values, as `Writer.write`."""
        add(self._written.addends, self._file.put(name, self._file.pieces(name, start, block)))
        self._written.nbytes[name] = self._written.nbytes.get(name, 0) + block.nbytes

    def record(self, start: int, stop: int) -> None:
        """Note that all variables of some designs are written."""
        self._written.ranges.append((start, stop))

    def report(self) -> Written:
        """Return what was written, after it is on the disk: who gets this cannot synchronise another machine."""
        synchronise(self._fd)
        return self._written

    def _opened(self) -> int:
        """Return a number by which the file of the run, and no other with its name, is written."""
        # It is not read by that number: where it could be, NFS may write whole pages, with old values of
        # other machines.
        try:
            known = partial_file.opened(self._part)
        except (OSError, InputError) as error:
            raise NotSeenError from error
        try:
            for position, expected in self._token.items():
                if read_all(known, len(expected), position) != expected:
                    raise NotSeenError(self._part)
            fd = os.open(self._part, os.O_WRONLY | getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0))
            if not os.path.samestat(os.fstat(fd), os.fstat(known)):
                os.close(fd)
                raise NotSeenError(self._part)
        except (OSError, EOFError) as error:
            raise NotSeenError from error
        finally:
            os.close(known)
        return fd


# -- Write labelled HDF5 files block by block; only complete ones get their name

# The file is laid out once; then every block is one plain ``pwrite`` at a known offset, which any thread
# may do in any order and which is faster than a write through HDF5. All this happens in ``NAME.part``; the
# last step gives it its name.


class Writer:
    """Writer of a labelled file, for any number of threads; a context manager."""

    # Nothing appears under the final name before `finish`. Without it, or on any exception, leaving the
    # context keeps the partial file with its journal where `record` has noted designs, and says so in a note
    # of the exception; else it removes the file.

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
        shown: Shown | None = None,
    ) -> None:
        of_coordinates = {v.name: v.shape[0] for v in variables if v.is_coordinate and v.dims == (v.name,)}
        for variable in variables:
            check_dims(coords, {**coords.sizes, **of_coordinates}, variable)
        lay_out_all = partial(
            lay_out, coords=coords, variables=variables, attrs=attrs, whole=whole, shown=shown
        )
        variables = [one for one in variables if shown is None or one.name not in shown.sources]
        self._nbytes = coords.nbytes + sum(variable.nbytes for variable in variables)
        self.path = check_target(path, self._nbytes, overwrite)
        self.part = part_of(self.path)
        self._overwrite = overwrite
        self._variables = {variable.name: variable for variable in variables}
        self._nbytes_written = dict.fromkeys(self._variables, 0)
        self._idle = threading.Condition()
        self._writing = 0
        self._closed = False
        self._fingerprint, self._size = run or ("", 0)
        self._rows = rows or SAME_ROWS
        #: Ranges of designs that an earlier run has written.
        self.written: list[Range] = []
        self._sums = dict[int, int]()
        values = partial(ValuesFile, variables=variables, size=self._size, rows=self._rows)
        try:
            found = None if restart else resume(self.part, self._fingerprint, values, lay_out_all)
            if found is not None:
                self._file, self.written, self._sums = found
                for name, places in self._file.places(self.written):
                    self._nbytes_written[name] += sum(count for _, count in places)
            else:
                if not restart:
                    check_left(self.path, self._fingerprint)
                self._file = values(*self._started(lay_out_all))
        except OF_HDF5 as error:
            raise self._failure(error) from error
        #: Ranges of designs that are left to be written.
        self.pending = missing(self.written, self._size)
        self._fd, self._offsets = self._file.fd, self._file.offsets
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

    def record(self, start: int, stop: int) -> None:
        """Record that all variables of some designs are written, by this thread; thread-safe."""
        of_thread = self._file.of_thread
        addends, of_thread.addends = of_thread.addends, []
        self._journal.add([(start, stop)], addends)

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
        """Write the values of consecutive designs of one variable; thread-safe."""
        self.write_pieces(name, self._file.pieces(name, start, block))

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
            self._file.of_thread.addends += added
            with self._idle:
                add(self._sums, added)
                self._nbytes_written[name] += nbytes
        finally:
            with self._idle:
                self._writing -= 1
                self._idle.notify_all()

    def remote(self) -> RemoteWriter:
        """Return a writer for another process, which knows the file by a token, in the place of its checksums."""
        token = {self._offsets[name]: os.urandom(4) for name in (OF_VALUES, OF_REST)}
        for position, data in token.items():
            partial_file.write_all(self._fd, memoryview(data), position)
        synchronise(self._fd)
        return RemoteWriter(self.part, token, self._offsets, list(self._variables.values()))

    def merge(self, written: Written) -> None:
        """Record what a remote writer has written; thread-safe."""
        with self._idle:
            if self._journal.error:
                raise self._failure(self._journal.error)
            add(self._sums, written.addends.items())
            for name, count in written.nbytes.items():
                self._nbytes_written[name] += count
        self._journal.add_bytes(sum(written.nbytes.values()))
        self._journal.add(written.ranges, written.addends.items())

    def finish(
        self, attrs: Mapping[str, Any], of_variables: Mapping[str, Mapping[str, Any]] | None = None
    ) -> None:
        """Add the last attributes and give the file its name."""
        now = time.time_ns()
        marks = {FINGERPRINT: self._fingerprint, WRITTEN: now} if self._fingerprint else {}
        last = plain_attrs({**marks, **attrs, FORMAT: FORMAT_VERSION})
        further = {name: plain_attrs(added) for name, added in (of_variables or {}).items()}
        for name, nbytes in self._nbytes_written.items():
            variable = self._variables[name]
            if nbytes != variable.nbytes:
                count, expected = nbytes // variable.dtype.itemsize, math.prod(variable.shape)
                raise RuntimeError(f"{self.path}: {count} of {expected} values of {name} were written")
        with uninterrupted():
            self._close_to_writers()
            try:
                if self._journal.error:
                    raise self._journal.error
                set_attrs(self._fd, self._file.extents, last, further)
                self._write_checksums()
                os.fsync(self._fd)
                if marks:  # the time of the file is the one that it says, so that a later change of it shows
                    os.utime(self.part, ns=(now, now))
                check_readable(self._fd, self.part, list(self._variables.values()), self._offsets)
            except BaseException as error:
                failure = self._failure(error) if isinstance(error, OF_HDF5) else error
                self._keep_or_discard(failure)
                raise failure from (None if failure is error else error)
            self._publish()

    def _write_checksums(self) -> None:
        """Write the checksums of all values, the seal of the labels, then the checksum of all else in the file."""
        variables, places = list(self._variables.values()), self._offsets
        if blocks := sum(block_count(variable.nbytes) for variable in variables):
            sums = np.array([self._sums[block] for block in range(blocks)], "u4")
            partial_file.write_all(self._fd, sums.view(np.uint8).data, places[OF_VALUES])
        partial_file.write_seal(self._fd, self._file.extents, places[OF_REST], self._file.extents)

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

    def _keep_or_discard(self, error: BaseException | None) -> None:
        """Keep the partial file where its journal names designs, to be resumed; else remove it."""
        if not self._journal.recorded:
            partial_file.discard(self._fd, self.part)
            self._journal.remove()
            return
        with contextlib.suppress(OSError):
            os.close(self._fd)
        share = count_of(self._journal.recorded) / self._size
        if error is not None:
            error.add_note(f"{share:.0%} of the designs are kept in {self.part}; run the same again to go on")

    def _started(self, lay_out: LayOut) -> tuple[int, dict[str, int]]:
        """Lay the file out by way of memory, and reserve its room; return its number and the variables' offsets."""

        def lay(path: Path) -> dict[str, int]:
            with scratch() as (other, laid):
                offsets = lay_out(other)
                extents = {offsets[variable.name]: variable.nbytes for variable in self._variables.values()}
                with os.fdopen(create(path), "r+b", buffering=0) as file:
                    copy_labels(laid, file.fileno(), extents)
                    # HDF5 gives back at the end what the attributes leave
                    reserve(file.fileno(), SLACK)
            return offsets

        return partial_file.begun(self.part, lay)

    def _failure(self, error: Exception) -> InputError:
        return not_written(self.path, self._nbytes, error)

    def _close_to_writers(self) -> None:
        """Refuse further writes, wait for those under way, and record what is written."""
        # The file number may soon be of another file.
        with self._idle:
            if self._closed:
                raise ValueError(f"{self.path}: the file is closed")
            self._closed = True
            self._idle.wait_for(lambda: self._writing == 0)
        self._journal.close()
