"""The files of the parts of a map: found, complete, of one request, and their values checked as they are read."""

from __future__ import annotations

import contextlib
import glob
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr

from fastlink._text import counted, short_repr
from fastlink.errors import InputError, Problem, Problems, remark
from fastlink.io.checksums import crc32, read_all
from fastlink.io.merged import is_measured
from fastlink.io.parts import OF_PARTS, WHOLE, Part, PartOfMap
from fastlink.io.place import part_of, reason, refused
from fastlink.io.reader import check_seal, existing_map, is_hdf5, open_map
from fastlink.io.stored import Stored, open_to_read
from fastlink.options import check_path
from fastlink.space.dataset import FORMAT

__all__ = ["PartFile", "part_files"]

#: Endings of files that are being written, which a folder may hold too.
OF_WRITER = (".part", ".new", ".journal")
#: Parts that are named where many are missing.
MOST_NAMED = 5
GIVE_PARTS = (
    "give the files that sweeps with part=... or `fastlink run --part ...` have written, or their folder"
)
RUN_AGAIN = "run that part again"
#: Blocks that are read at once.
AT_ONCE = 8


@dataclass(frozen=True)
class PartFile:
    """The file of a part.

    Attributes
    ----------
    path : Path
        The file.
    of : PartOfMap
        Which part of which map it is.
    attrs : dict
        Its global attributes.
    stored : Stored
        Its checksums.
    measured : dict of str to dict
        What verification says of each variable.
    """

    path: Path
    of: PartOfMap
    attrs: Mapping[str, Any]
    stored: Stored
    measured: Mapping[str, Mapping[str, Any]]

    def dataset(self) -> xr.Dataset:
        """Return the part as a Dataset."""
        return open_map(self.path)

    def whole(self) -> xr.Dataset:
        """Return the coordinates that the part keeps of the whole."""
        coords = {}
        with h5py.File(self.path, "r") as file:
            for name, one in file[WHOLE].items():
                values = one.asstr()[:] if h5py.check_string_dtype(one.dtype) else one[:]
                coords[name] = ((name,), values, {key: _scalar(value) for key, value in one.attrs.items()})
            return xr.Dataset(coords=coords, attrs=dict(file[WHOLE].attrs))

    def check_labels(self) -> None:
        """Refuse the part if anything but its values has changed."""
        with self._opened() as fd:
            intact = self.stored.rest_is_intact(fd)
        if not intact:
            raise self._damaged("labels, attributes or checksums")

    def read(self, name: str, start: int, stop: int) -> Iterator[tuple[int, memoryview]]:
        """Yield bytes of the values of a variable in pieces with their positions; each block of them is checked.

        Raises
        ------
        InputError
            They have changed since they were written.
        """
        size, values = self.stored.block_bytes, self.stored.values[name]
        with self._opened() as fd:
            for first in range(start // size * size, stop, AT_ONCE * size):
                last = min(first + AT_ONCE * size, -(-stop // size) * size, values.nbytes)
                data = memoryview(read_all(fd, last - first, values.offset + first))
                for k in range(0, last - first, size):
                    if crc32(data[k : k + size]) != self.stored.sums[values.first + (first + k) // size]:
                        raise self._damaged(f"values of {name}")
                begin = max(first, start)
                yield begin, data[begin - first : stop - first]

    @contextlib.contextmanager
    def _opened(self) -> Iterator[int]:
        """Yield the number of the file, open to be read."""
        try:
            fd = open_to_read(self.path)
            try:
                yield fd
            finally:
                os.close(fd)
        except (OSError, EOFError) as error:
            raise refused(f"{self.path} cannot be read ({reason(error)})", RUN_AGAIN, "paths") from error

    def _damaged(self, what: str) -> InputError:
        what = f"{self.path}, part {self.of.part}: {what} have changed since they were written"
        return refused(what, f"{RUN_AGAIN}, with overwrite", "paths")


def part_files(paths: Any) -> list[PartFile]:
    """Return all parts of one map in order, or refuse them.

    Parameters
    ----------
    paths : path, or sequence of paths
        Files, folders whose parts are meant, or patterns such as ``maps.part-*.h5``.

    Raises
    ------
    InputError
        One is missing, is of another map, or two differ; a file is no part.
    """
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
        check_seal(existing_map(path))
        with h5py.File(path, "r") as file:
            attrs = {str(name): _scalar(value) for name, value in file.attrs.items()}
            of = PartOfMap.of(attrs)
            if of is not None and WHOLE in file:
                stored = Stored.of(file)
                measured = {name: _measured(file[name].attrs) for name in stored.values}
                return PartFile(path, of, attrs, stored, measured)
        if any(name in attrs for name in OF_PARTS):
            raise refused(
                f"{path}: what it says of its part has changed since it was written", RUN_AGAIN, "paths"
            )
        if chosen:
            what = "is a whole map, no part" if FORMAT in attrs else "is no part of a map"
            raise refused(f"{path} {what}", GIVE_PARTS, "paths")
    except InputError as error:
        raise InputError.of([Problem(one.what, ("paths",), one.remedy) for one in error.problems]) from None
    except (OSError, RuntimeError, KeyError, ValueError, TypeError) as error:
        raise refused(f"{path} cannot be read ({reason(error)})", GIVE_PARTS, "paths") from error
    return None


def _measured(attrs: Any) -> dict[str, Any]:
    """Return the attributes of a variable that come from verification."""
    return {name: _scalar(attrs[name]) for name in attrs if is_measured(name)}


def _scalar(value: Any) -> Any:
    """Return an attribute as xarray reads it: h5netcdf writes a number as an array of one."""
    return value[0] if isinstance(value, np.ndarray) and value.shape == (1,) else value


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
    if more := len(missing) - MOST_NAMED if len(missing) > MOST_NAMED else 0:
        problems.add(f"{counted(more, 'more part')} of {count} are missing", ("paths",), "run all of them")
    problems.stop()
    return [by_number[k] for k in range(1, count + 1)]


def _unfinished(parts: Sequence[PartFile], part: Part) -> Path | None:
    """Return what a run has left of a part beside others, if there is such a file."""
    for other in parts:
        path = other.path.with_name(other.path.name.replace(other.of.part.mark, part.mark))
        if path != other.path and part_of(path).exists():
            return part_of(path)
    return None
