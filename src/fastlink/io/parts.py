"""Parts of a map: consecutive designs in files of their own, which `fastlink.join` puts together."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Integral
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from fastlink._text import counted, short_repr
from fastlink.errors import InputError, KeyPath, Setting
from fastlink.io.checksums import sealed_labels
from fastlink.io.dataset import FINGERPRINT
from fastlink.io.place import reason
from fastlink.io.ranges import Range
from fastlink.io.stored import check_own

__all__ = [
    "LABELS",
    "NAMES",
    "OF_PARTS",
    "OR_COPY",
    "WHOLE",
    "Box",
    "Part",
    "PartOfMap",
    "PartsError",
    "Shown",
    "Source",
    "as_source",
    "check_open_files",
    "check_part",
    "check_parts",
    "check_size",
    "scalar",
    "shown_parts",
]

#: The global attributes of a part, see `PartOfMap`; they are not those of the whole map.
OF_PARTS = ("part_number", "part_count", "part_start", "part_stop", "whole_designs", "whole_fingerprint")
#: The group of a part that holds coordinates of the whole map.
WHOLE = "whole"
#: The group of a joined map whose values stay in the files of its parts: their names from its folder on, and the
#: checksums of their labels.
SHOWN, NAMES, LABELS = "parts", "parts/names", "parts/labels"
#: HDF5 looks there for the files of a virtual dataset before the folder of the map.
ELSEWHERE = "HDF5_VDS_PREFIX"
#: Files that a process has open besides those of parts.
OTHER_FILES = 64
AGAIN = "put it back, or run that part again if need be, and join the parts again with overwrite"
#: A piece of the remedy where parts cannot stay what the map shows.
OR_COPY = (", or write ", Setting("copy", True), " for one file of its own")
#: More parts than any cluster has jobs.
MOST_PARTS = 10**6


@dataclass(frozen=True)
class Part:
    """The `number`-th of `count` nearly equal parts, from 1 on.

    Examples
    --------
    >>> print(Part(3, 16), Part(3, 16).range(1000), Part(3, 16).path(Path("maps.h5")))
    3/16 (125, 187) maps.part-03-of-16.h5
    """

    number: int
    count: int

    def __str__(self) -> str:
        return f"{self.number}/{self.count}"

    def range(self, designs: int) -> Range:
        """Return the first of its designs, and the first after them."""
        return designs * (self.number - 1) // self.count, designs * self.number // self.count

    @property
    def mark(self) -> str:
        """Its mark in the name of its file."""
        return f".part-{self.number:0{len(str(self.count))}}-of-{self.count}"

    def path(self, whole: Path) -> Path:
        """Return the file of the part beside that of the whole map."""
        return whole.with_name(f"{whole.stem}{self.mark}{whole.suffix}")


def check_part(where: KeyPath, value: Any) -> Part:
    """Return the part of a pair (k, n), or of a text ``"k/n"``, or refuse the value.

    Examples
    --------
    >>> check_part(("part",), (17, 16))
    Traceback (most recent call last):
    fastlink.errors.InputError: part is (17, 16); write k of n parts with k from 1 to n, such as part='3/16'
    """
    pair = value
    if isinstance(value, str) and (found := re.fullmatch(r"(\d{1,9})/(\d{1,9})", value, re.ASCII)):
        pair = [int(number) for number in found.groups()]
    if isinstance(pair, (list, tuple)) and len(pair) == 2 and all(map(_is_whole, pair)):
        number, count = map(int, pair)
        if 1 <= number <= count <= MOST_PARTS:
            return Part(number, count)
    remedy = ("write k of n parts with k from 1 to n", (", such as ", Setting("part", "3/16")))
    raise InputError(f"is {short_repr(value)}", where=where, remedy=remedy)


def check_size(where: KeyPath, part: Part, designs: int) -> None:
    """Refuse parts some of which would have no design."""
    if part.count > designs:
        what = f"is {part}, but there {'is' if designs == 1 else 'are'} {counted(designs, 'design')}"
        remedy = f"write at most {counted(designs, 'part')}, of one design at least"
        raise InputError(what, where=where, remedy=remedy)


@dataclass(frozen=True)
class PartOfMap:
    """A part of a certain map.

    Attributes
    ----------
    part : Part
        Which part.
    whole : str
        The hash of the whole request, which its parts and their joined map share.
    designs : int
        The number of designs of the whole map.
    """

    part: Part
    whole: str
    designs: int

    @property
    def range(self) -> Range:
        """Return the first of its designs, and the first after them."""
        return self.part.range(self.designs)

    @property
    def fingerprint(self) -> str:
        """The hash of the part, which no other part has."""
        return hashlib.sha256(f"{self.whole} {self.part}".encode()).hexdigest()

    def attrs(self) -> dict[str, Any]:
        """Return the global attributes that tell which part it is."""
        return dict(
            zip(
                OF_PARTS,
                (self.part.number, self.part.count, *self.range, self.designs, self.whole),
                strict=True,
            )
        )

    @classmethod
    def of(cls, attrs: Mapping[str, Any]) -> PartOfMap | None:
        """Return what the global attributes of a map tell, None of what is no part."""
        try:
            number, count, start, stop, designs = (int(attrs[name]) for name in OF_PARTS[:-1])
            found = cls(Part(number, count), str(attrs[OF_PARTS[-1]]), designs)
        except (KeyError, TypeError, ValueError):
            return None
        return found if 1 <= number <= count <= designs and (start, stop) == found.range else None


class PartsError(InputError):
    """The files of the parts whose values a map shows are not those that were joined."""


#: First indices, steps and counts along the dimensions of an array.
Box = tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...]]
#: The name of a file, the shape of a variable there, and the box of its values that are those of a box of the map.
Source = tuple[str, tuple[int, ...], Box, Box]


@dataclass(frozen=True)
class Shown:
    """Values that a joined map shows of the files of its parts, as virtual datasets of HDF5.

    Attributes
    ----------
    files : dict of str to int
        The checksum of the labels of each part, by its name from the folder of the map on.
    sources : dict of str to list of (file, shape, box, own box)
        The pieces of each variable: the file, the shape there, the box of the map, and the box of the file.
    """

    files: dict[str, int]
    sources: dict[str, list[Source]]

    @property
    def nbytes(self) -> int:
        """Bytes that the names and boxes take at most, about."""
        pieces = [(variable, one) for variable, sources in self.sources.items() for one in sources]
        return sum(256 + len(name) + len(one[0]) + 64 * len(one[1]) for name, one in pieces)


def shown_parts(path: Path) -> dict[Path, int]:
    """Return the files of the parts whose values a map shows, with the checksums of their labels; of most maps none.

    Raises
    ------
    PartsError
        A virtual dataset is of another file than of a part that the map names, from its own folder on, in it or below.
    """
    return _shown(path)[0]


def _shown(path: Path) -> tuple[dict[Path, int], set[str]]:
    """Return the parts whose values a map shows, and the names of these values there."""
    folder = Path(os.path.realpath(path)).parent
    found, used, variables = dict[str, int](), set[str](), set[str]()

    def add(_: str, one: Any) -> None:
        if isinstance(one, h5py.Dataset) and one.is_virtual:
            for source in one.virtual_sources():
                used.add(source.file_name)
                variables.add(source.dset_name)

    with h5py.File(path, "r") as file:
        check_own(path, file)
        file.visititems(add)
        if used and NAMES in file and LABELS in file:
            names = [os.fsdecode(name) for name in file[NAMES][:].tolist()]
            found = dict(zip(names, file[LABELS][:].tolist(), strict=True))
    for name in sorted({*found, *(used - set(map(as_source, found)))}):
        real = Path(os.path.realpath(folder / name))
        if name not in found or os.path.isabs(name) or not real.is_relative_to(folder):
            what = f"{path}: shows values of {short_repr(name)}, which is no part of it in its folder"
            raise PartsError(what, remedy="move the parts into the folder of the map, and join them there")
    return {folder / name: labels for name, labels in found.items()}, variables


def check_parts(path: Path) -> bool:
    """Tell whether a map shows values of parts; refuse it unless these are the parts that were joined, and all there.

    HDF5 reads fill values where the file of a virtual dataset is missing, or cannot be opened.

    Raises
    ------
    PartsError
        A part is missing or has changed, a source of values is no part of the map, or too few files can be open.
    """
    shown, variables = _shown(path)
    if not shown:
        return False
    check_open_files(len(shown))
    with h5py.File(path, "r") as file:
        whole = str(file.attrs.get(FINGERPRINT))
    for part, labels in shown.items():
        try:
            if why := _fault(part, labels, whole, variables):
                raise PartsError(f"{path}: its part {part} {why}", remedy=AGAIN)
        except OSError as error:
            raise PartsError(
                f"{path}: its part {part} cannot be read ({reason(error)})", remedy=AGAIN
            ) from error
    return True


def _fault(part: Path, labels: int, whole: str, variables: set[str]) -> str:
    """Return why a file is not the part of a map that was joined, an empty text if it is."""
    if not part.exists():
        return "is missing"
    if sealed_labels(part) != labels:
        return "has changed since the parts were joined"
    with h5py.File(part, "r") as file:
        of = PartOfMap.of({name: scalar(file.attrs.get(name)) for name in OF_PARTS})
        here = all(file[name].file == file and file[name].id.get_offset() is not None for name in variables)
    return "" if here and of is not None and of.whole == whole else "is of another map"


def as_source(name: str) -> str:
    """Return the name of a file as that of the source of a virtual dataset, where HDF5 counts by signs of per cent."""
    return name.replace("%", "%%")


def check_open_files(count: int) -> None:
    """Refuse to have so many parts open at once, where HDF5 would read fill values of those that it cannot open."""
    if os.environ.get(ELSEWHERE):
        what = f"{ELSEWHERE} is set, by which HDF5 takes values from files of another folder"
        raise PartsError(what, remedy=f"unset {ELSEWHERE}")
    try:
        import resource
    except ImportError:  # not POSIX: no such limit
        return
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    if most != resource.RLIM_INFINITY and count + OTHER_FILES > most:
        what = f"{counted(count, 'part')} must be open at once, and this process may open {counted(most, 'file')}"
        raise PartsError(what, remedy=(f"raise the limit by `ulimit -n {count + 10 * OTHER_FILES}`", OR_COPY))


def scalar(value: Any) -> Any:
    """Return an attribute as xarray reads it: h5netcdf writes a number as an array of one."""
    return value[0] if isinstance(value, np.ndarray) and value.shape == (1,) else value


def _is_whole(value: Any) -> bool:
    return (
        isinstance(value, Integral) and not isinstance(value, bool) and type(value).__name__ != "timedelta64"
    )
