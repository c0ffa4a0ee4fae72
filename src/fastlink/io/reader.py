"""Open and check finished maps and the parts whose values they show; refuse other files, or those of other requests."""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import traceback
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from inspect import signature
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr

from fastlink._text import counted, short_repr, size
from fastlink.errors import (
    InputError,
    KeyPath,
    Setting,
    check_path,
    check_whole,
    door,
    not_a_file,
    require_package,
    suggest,
)
from fastlink.io.checksums import (
    CHECKSUMS,
    SIGNATURE,
    Range,
    Stored,
    check_own,
    joined_ranges,
    open_to_read,
    read_seal,
    seal_is_broken,
)
from fastlink.io.layout import FINGERPRINT, FORMAT_VERSION, WRITTEN, Variable, plain_attrs
from fastlink.io.output_path import existing_file, exists_error, left_of, reason
from fastlink.io.partial_file import forget_journal, forget_published
from fastlink.space.tables import FORMAT

# -- Open finished maps, lazily, and refuse other files


# -- Parts of a map: consecutive designs in files of their own, which `fastlink.join` puts together


#: The global attributes of a part, see `PartOfMap`; they are not those of the whole map.
OF_PARTS = ("part_number", "part_count", "part_start", "part_stop", "whole_designs", "whole_fingerprint")
#: The group of a part that holds coordinates of the whole map.
WHOLE = "whole"
#: The group of a joined map whose values stay in the files of its parts: their names from its folder on, and the
#: checksums of their labels.
SHOWN, NAMES, LABELS = "parts", "parts/names", "parts/labels"
#: HDF5 looks there for the files of a virtual dataset before the folder of the map.
VDS_PREFIX = "HDF5_VDS_PREFIX"
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

    >>> check_part(("part",), (17, 16))
    Traceback (most recent call last):
    fastlink.errors.InputError: part is (17, 16); write k of n parts with k from 1 to n, such as part='3/16'
    """
    pair = value
    if isinstance(value, str) and (found := re.fullmatch(r"(\d{1,9})/(\d{1,9})", value, re.ASCII)):
        pair = [int(number) for number in found.groups()]
    if isinstance(pair, (list, tuple)) and len(pair) == 2:
        with contextlib.suppress(InputError):
            count = check_whole(where, pair[1], 1, MOST_PARTS)
            return Part(check_whole(where, pair[0], 1, count), count)
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
    """A part of a certain map."""

    #: Which part.
    part: Part
    #: The hash of the whole request, which its parts and their joined map share.
    whole: str
    #: The number of designs of the whole map.
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
    """Values that a joined map shows of the files of its parts, as virtual datasets of HDF5."""

    #: The checksum of the labels of each part, by its name from the folder of the map on.
    files: dict[str, int]
    #: The pieces of each variable: the file, the shape there, the box of the map, and the box of the file.
    sources: dict[str, list[Source]]

    @property
    def nbytes(self) -> int:
        """Bytes that the names and boxes take at most, about."""
        pieces = [(variable, one) for variable, sources in self.sources.items() for one in sources]
        return sum(256 + len(name) + len(one[0]) + 64 * len(one[1]) for name, one in pieces)


def shown_parts(path: Path) -> dict[Path, int]:
    """Return the files of the parts whose values a map shows, with the checksums of their labels; of most maps none."""
    return _shown(path)[0]


def _shown(path: Path) -> tuple[dict[Path, int], set[str], str]:
    """Return the parts whose values a map shows, the names of these values there, and the hash of its request."""
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
        whole = str(file.attrs.get(FINGERPRINT))
        if used and NAMES in file and LABELS in file:
            names = [os.fsdecode(name) for name in file[NAMES][:].tolist()]
            found = dict(zip(names, file[LABELS][:].tolist(), strict=True))
    for name in sorted({*found, *(used - set(map(as_source, found)))}):
        real = Path(os.path.realpath(folder / name))
        if name not in found or os.path.isabs(name) or not real.is_relative_to(folder):
            what = f"{path}: shows values of {short_repr(name)}, which is no part of it in its folder"
            raise PartsError(what, remedy="move the parts into the folder of the map, and join them there")
    return {folder / name: labels for name, labels in found.items()}, variables, whole


def check_parts(path: Path) -> bool:
    """Tell whether a map shows values of parts; refuse it unless these are those that were joined, and all there."""
    # HDF5 reads fill values where the file of a virtual dataset is missing, or cannot be opened.
    shown, variables, whole = _shown(path)
    if not shown:
        return False
    check_open_files(len(shown))
    for part, labels in shown.items():
        try:
            if why := _fault_of_part(part, labels, whole, variables):
                raise PartsError(f"{path}: its part {part} {why}", remedy=AGAIN)
        except OSError as error:
            raise PartsError(
                f"{path}: its part {part} cannot be read ({reason(error)})", remedy=AGAIN
            ) from error
    return True


def _fault_of_part(part: Path, labels: int, whole: str, variables: set[str]) -> str:
    """Return why a file is not the part of a map that was joined, an empty text if it is."""
    if not part.exists():
        return "is missing"
    if read_seal(part)[1] != labels:
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
    if os.environ.get(VDS_PREFIX):
        what = f"{VDS_PREFIX} is set, by which HDF5 takes values from files of another folder"
        raise PartsError(what, remedy=f"unset {VDS_PREFIX}")
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


#: Options of xarray that are decided here.
DECIDED = ("filename_or_obj", "engine", "chunks", "kwargs")
GIVE_A_MAP = "give the result of a sweep, or the path of its file"

#: Global attribute of a compressed file: what it is compressed by; what every HDF5 can read.
COMPRESSION, BUILT_IN = "compression", "gzip"
#: Any of these files tells that a folder is a zarr store.
OF_ZARR = (".zgroup", ".zmetadata", "zarr.json")


def is_hdf5(path: Path) -> bool:
    """Tell whether a file begins as HDF5 does."""
    with path.open("rb") as file:
        return file.read(len(SIGNATURE)) == SIGNATURE


def is_zarr(path: Path) -> bool:
    """Tell whether a folder is a zarr store."""
    return any(os.path.isfile(path / name) for name in OF_ZARR)


def register_filter(name: str) -> None:
    """Let HDF5 use the filter of hdf5plugin, not another package's, such as netCDF4's, which may not fit."""
    import hdf5plugin

    with contextlib.suppress(ValueError):  # of another name, which will be missed when values are read
        hdf5plugin.register(name, force=True)


@door(name="open")
def open_map(path: str | os.PathLike[str], *, chunks: Any = None, **options: Any) -> xr.Dataset:
    """Open a map that a sweep or a conversion has written; values are read when they are used.

    Parameters
    ----------
    path : str or path
        The file: HDF5, netCDF-4 or zarr.
    chunks : int, dict or "auto", optional
        Split variables into chunks of dask, as `xarray.open_dataset` does: ``{}`` as the file is, ``{"a1": 100}``,
        ``"auto"``. Needs dask.
    **options
        Further options of `xarray.open_dataset`, such as ``cache=False`` or ``drop_variables=["theta4"]``.

    Returns
    -------
    xarray.Dataset
        Close it, or use it in a ``with`` statement, before deleting the file.

    Raises
    ------
    InputError
        There is no such file, it is not a finished map, a part whose values it shows is missing or has changed, or an
        option is not one of xarray's.

    Examples
    --------
    >>> import tempfile, numpy as np, xarray as xr
    >>> from fastlink.io.layout import Variable
    >>> from fastlink.io.writer import Writer
    >>> coords = xr.Dataset(coords={"a2": ("a2", [1.0, 1.2], {"units": "m"})})
    >>> speed = Variable("omega4_max", ("a2",), (2,), np.dtype("f8"), {"units": "rad s-1"})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with Writer(f"{folder}/maps.h5", coords, [speed], {"title": "two designs"}) as writer:
    ...         writer.write("omega4_max", 0, np.array([31.0, 29.5]))
    ...         writer.finish({})
    ...     with open_map(f"{folder}/maps.h5") as maps:
    ...         maps.title, float(maps.omega4_max.sel(a2=1.2))
    ('two designs', 29.5)
    """
    path = existing_map(path, or_zarr=True)
    _check_options(chunks, options)
    engine = "zarr" if path.is_dir() else "h5netcdf"
    if engine == "zarr":
        require_package("zarr", ("path",))
    else:
        check_seal(path)
    try:
        if engine == "h5netcdf" and is_hdf5(path) and check_parts(path):
            path = Path(os.path.realpath(path))  # whose folder the parts are in, not that of a link
        dataset = xr.open_dataset(path, engine=engine, chunks=chunks, **options)
    except InputError:
        raise
    except Exception as error:  # of h5py, h5netcdf, xarray and dask: there is no list of them
        _refuse_option(path, engine, chunks, options, error)
        if engine == "zarr":
            what = f"{path}: cannot be read as zarr ({reason(error)})"
            raise InputError(what, remedy="give a map that fastlink.convert has written") from error
        if path.suffix == ".toml" and not is_hdf5(path):
            what = f"{path}: is a study, not a map"
            raise InputError(what, remedy=f"`fastlink run {path}` makes its map") from error
        what = f"{path}: cannot be read as HDF5 ({_fault(path, error)})"
        raise InputError(what, remedy="give a map that a sweep has written") from error
    version = dataset.attrs.get(FORMAT)
    if isinstance(version, (int, np.integer)) and version <= FORMAT_VERSION:
        compressor = str(dataset.attrs.get(COMPRESSION, BUILT_IN)).partition(":")[0]
        if engine != "zarr" and compressor != BUILT_IN:
            with contextlib.ExitStack() as stack:
                stack.callback(dataset.close)
                require_package("hdf5plugin", ("path",))
                register_filter(compressor)
                stack.pop_all()
        return dataset
    dataset.close()
    if version is None:
        what = f"{path}: is not a finished map (it has no attribute {FORMAT!r})"
        raise InputError(what, remedy="other files open with xarray.open_dataset")
    what = f"{path}: has format {version}, this version reads up to {FORMAT_VERSION}"
    raise InputError(what, remedy="update fastlink")


@contextlib.contextmanager
def as_map(maps: Any) -> Iterator[xr.Dataset]:
    """Yield the map that a caller gives, as a Dataset or as the path of its file, or refuse it.

    >>> import fastlink as fl
    >>> with as_map(fl.sweep("planar_4r", fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0), ["grashof_class"])) as maps:
    ...     int(maps.grashof_class)
    0
    """
    with as_dataset(maps) as dataset:
        if FORMAT not in dataset.attrs:
            what = f"is a Dataset without the attribute {FORMAT!r} of a map"
            remedy = (
                f"{GIVE_A_MAP}; under xarray.set_options(keep_attrs=True) its attributes outlast arithmetic"
            )
            raise InputError(what, where=("maps",), remedy=remedy)
        yield dataset


@contextlib.contextmanager
def as_dataset(maps: Any) -> Iterator[xr.Dataset]:
    """Yield a Dataset, whether or not it has all attributes of a map; or the map at a path."""
    if isinstance(maps, xr.Dataset):
        try:
            yield maps
        except FileNotFoundError as error:
            what = f"is of a file that is not there any more ({reason(error).partition(' (')[0]})"
            raise InputError(what, where=("maps",), remedy=GIVE_A_MAP) from error
    elif isinstance(maps, (str, os.PathLike)):
        with readable(maps), open_map(maps) as opened:
            yield opened
    else:
        one = isinstance(maps, xr.DataArray)
        what = f"is {'one variable' if one else short_repr(maps)}, not a map"
        remedy = "give the whole map" if one else GIVE_A_MAP
        raise InputError(what, where=("maps",), remedy=remedy)


@contextlib.contextmanager
def readable(path: str | os.PathLike[str]) -> Iterator[None]:
    """Refuse a map that HDF5 cannot read or close any more, such as on a disk that fails."""
    try:
        yield
    except (OSError, RuntimeError, KeyError) as error:
        *_, (frame, _) = traceback.walk_tb(error.__traceback__)
        if "h5py" not in Path(frame.f_code.co_filename).parts:  # it is of something else
            raise
        what = f"{os.fspath(path)}: cannot be read ({reason(error)})"
        raise InputError(what, remedy="try again, or take a copy of it") from error


def files_of(maps: xr.Dataset) -> list[Path]:
    """Return the file that a map was opened from, if there is one, and those of the parts whose values it shows."""
    source = maps.encoding.get("source")
    if not isinstance(source, (str, os.PathLike)) or not os.path.exists(source):
        return []
    path = Path(source)
    with contextlib.suppress(OSError):  # no HDF5, or not to be read any more
        return [path, *shown_parts(path)]
    return [path]


def existing_map(path: Any, *, or_zarr: bool = False) -> Path:
    """Return the path of a file that may be a map, or of a zarr store where that may be one, or refuse it."""
    file = check_path(("path",), path)
    if is_zarr(file):
        if or_zarr:
            return file
        what = f"{file}: is a zarr store, which has no checksums of fastlink"
        raise InputError(what, remedy="check the .h5 file that it was made from")
    if other := not_a_file(file):
        raise InputError(f"{file}: {other}", remedy="give the path of a map that a sweep has written")
    if os.fspath(path).endswith(os.sep):
        raise InputError(f"{path}: is not a folder", remedy=f"write {str(file)!r}")
    if not os.path.exists(file):
        hint = f"; {left.name} is of a run that has not finished" if (left := left_of(file)) else ""
        raise InputError(f"{file}: there is no such file{hint}", remedy="give the path of a written map")
    if file == left_of(file.with_suffix("")) and read_seal(file)[1] is None:
        raise InputError(f"{file}: is of a run that has not finished", remedy="run the same again to go on")
    return file


def check_seal(path: Path) -> int | None:
    """Refuse a map whose labels have changed since they were written, before HDF5 reads them; else return their sum."""
    try:
        broken, labels = read_seal(path)
    except OSError as error:
        remedy = "give a map that a sweep has written"
        raise InputError(f"{path}: cannot be read ({reason(error)})", remedy=remedy) from error
    if broken:
        what = f"{path}: is damaged: labels or attributes have changed since they were written"
        raise InputError(what, remedy="take a copy of it, or write it again")
    return labels


def _fault(path: Path, error: Exception) -> str:
    """Return why a file cannot be read as HDF5."""
    try:
        return reason(error) if is_hdf5(path) else "it does not begin as such a file does"
    except OSError as unreadable:
        return reason(unreadable)


def _check_options(chunks: Any, options: dict[str, Any]) -> None:
    """Refuse options that xarray does not have, or that need what is not installed."""
    known = [name for name in signature(xr.open_dataset).parameters if name not in DECIDED]
    for name in options:
        if name not in known:
            raise InputError(
                "is not an option of xarray.open_dataset", where=(name,), remedy=suggest(name, known)
            )
    if chunks is not None:
        require_package("dask", ("chunks",))


def _refuse_option(path: Path, engine: Any, chunks: Any, options: dict[str, Any], error: Exception) -> None:
    """Refuse the options where the file opens without them."""
    if chunks is None and not options:
        return
    try:
        xr.open_dataset(path, engine=engine).close()
    except Exception:
        return
    given = ("chunks",) if chunks is not None else tuple(options)[:1]
    what = f"cannot open {path.name} with such options ({reason(error)})"
    raise InputError(what, where=given, remedy="see xarray.open_dataset") from error


# -- Tell whether a finished map is that of a request, and in what it differs


#: Steps of the times of files, in ns: of most file systems, Windows, microseconds, HFS+ and NFS 2, FAT.
STEPS = (1, 100, 1000, 10**9, 2 * 10**9)
#: Longer coordinates are not read to say in what two maps differ.
LONGEST_READ = 10**7
#: Differences that are named.
MOST_NAMED = 5


def finished_map(
    to: str | Path,
    fingerprint: str,
    *,
    verified: int,
    attrs: Mapping[str, Any],
    coords: xr.Dataset | None = None,
    variables: Sequence[Variable] = (),
) -> xr.Dataset | None:
    """Return an existing file, opened, if it is the finished map of a request, None where none is; else refuse it."""
    path = existing_file(to)
    if path is None:
        return None
    with contextlib.suppress(OSError):
        forget_published(path)
        forget_journal(path)
    try:
        found = open_map(path)
    except PartsError:
        raise
    except InputError:
        raise exists_error(path, "and is not a map") from None
    known = found.attrs
    same = known.get(FINGERPRINT) == fingerprint
    if same and known.get("verified_designs", 0) >= verified and _is_untouched(path, known):
        return found
    with found:
        if not same:
            why = _difference(found, coords, variables, plain_attrs(attrs))
        elif not _is_untouched(path, known):
            why = "changed or copied since it was written"
        else:
            why = f"with {known.get('verified_designs', 0)} verified designs, not {verified}"
    raise exists_error(path, why)


def _is_untouched(path: Path, attrs: Mapping[str, Any]) -> bool:
    """Tell whether a file has the time that its attributes say, to a step of its file system."""
    said, found = int(attrs.get(WRITTEN, -1)), path.stat().st_mtime_ns
    return any(said // step * step == found for step in STEPS)


def _difference(
    found: xr.Dataset, coords: xr.Dataset | None, variables: Sequence[Variable], attrs: Mapping[str, Any]
) -> str:
    """Return in what a map differs from a request, as far as a short look tells."""
    labels = {**({} if coords is None else coords.attrs), **attrs}
    if found.attrs.get("mechanism") != labels.get("mechanism"):
        return f"a map of {found.attrs.get('mechanism')}"
    part, wanted = (
        "a whole map" if of is None else f"part {of.part}" for of in map(PartOfMap.of, (found.attrs, labels))
    )
    if part != wanted:
        return f"{part}, not {wanted}"
    others = [
        name
        for name in labels
        if name not in OF_PARTS and not np.array_equal(np.asarray(found.attrs.get(name)), labels[name])
    ]
    if coords is None:
        return f"a map with other {', '.join(others[:MOST_NAMED])}" if others else "of another search"
    names = {variable.name for variable in variables if not variable.is_coordinate}
    computed = {variable.name for variable in variables if variable.is_coordinate}
    parts = ["quantities"] if names != set(map(str, found.data_vars)) else []
    both = [] if parts else [one for one in variables if one.name in found.variables]
    dims = [(one.dims, tuple(map(str, found[one.name].dims))) for one in both]
    parts += ["layout"] if any(a != b and sorted(a) == sorted(b) for a, b in dims) else []
    parts += [
        str(name)
        for name in dict.fromkeys([*coords.coords, *found.coords])
        if name not in computed
        and (name not in coords.coords or name not in found.coords or _differ(coords[name], found[name]))
    ]
    parts += ["versions" if name == "source" else name for name in others if name not in ("threads", "title")]
    parts = parts or [name for name in others if name == "title"]
    more = ", ..." if len(parts) > MOST_NAMED else ""
    return f"a map with other {', '.join(parts[:MOST_NAMED])}{more}" if parts else "a map by another version"


def _differ(one: xr.DataArray, other: xr.DataArray) -> bool:
    if one.shape != other.shape or one.size > LONGEST_READ:
        return one.shape != other.shape
    return not np.array_equal(one.values, other.values)


# -- Check the bytes of a map against the checksums inside it


@dataclass(frozen=True)
class FileCheck:
    """The outcome of `check`; true where every byte is as it was written.

    Attributes
    ----------
    path : Path
        The file.
    nbytes : int
        Its size.
    damaged : dict of str to list of (first, last)
        The values that changed, by variable: numbers of values in C order, both included, of whole blocks. Unknown,
        and empty, where the labels have changed that say where the values are.
    rest_is_intact : bool
        Whether all else is as it was: labels, attributes, the checksums themselves;
        where `is_compressed`, the values too.
    is_compressed : bool
        Whether the file has one checksum of all its bytes, as compressed ones have.
    parts : tuple of FileCheck
        Those of the parts whose values the file shows, where it was joined without a copy.
    """

    path: Path
    nbytes: int
    damaged: dict[str, list[tuple[int, int]]] = field(default_factory=dict)
    rest_is_intact: bool = True
    is_compressed: bool = False
    parts: tuple[FileCheck, ...] = ()

    def __bool__(self) -> bool:
        return self.rest_is_intact and not self.damaged and all(self.parts)

    def __str__(self) -> str:
        if self:
            of_parts = f"{counted(len(self.parts), 'part')} ({size(sum(part.nbytes for part in self.parts))})"
            more = f", and so are its {of_parts}" if self.parts else ""
            return f"{self.path} ({size(self.nbytes)}) is as it was written{more}"
        lines = [
            f"{self.path}: values of {name} have changed, between number {first:,} and {last:,}"
            for name, ranges in self.damaged.items()
            for first, last in ranges
        ]
        if not self.rest_is_intact:
            what = "values, " if self.is_compressed else ""
            lines.append(f"{self.path}: {what}labels, attributes or checksums have changed")
        lines += [str(part) for part in self.parts if not part]
        return "\n".join(lines)


@door
def check(path: str | Path) -> FileCheck:
    """Check every byte of a map against the checksums that were written with it.

    Parameters
    ----------
    path : str or path
        A map that a sweep or a study has written.

    Returns
    -------
    FileCheck
        True where nothing has changed; it prints as a line for each part that has.

    Raises
    ------
    InputError
        The file cannot be read, or has no checksums.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import fastlink as fl
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "maps.h5")
    ...     space = fl.grid(a1=0.4, a2=[1.1, 1.2], a3=0.8, a4=1.0)
    ...     fl.sweep("planar_4r", space, ["transmission_angle_min"], to=path, verify=0).close()
    ...     bool(fl.check(path))
    True
    """
    return _checked(existing_map(path))


def _checked(place: Path, *, is_part: bool = False) -> FileCheck:
    """Return the outcome for a file, and for the parts whose values it shows."""
    try:
        if seal_is_broken(place):
            return FileCheck(place, os.path.getsize(place), rest_is_intact=False)
        with h5py.File(place, "r") as file:
            check_own(place, file)
            if CHECKSUMS not in file:
                raise InputError(f"{place}: has no checksums", remedy="write it again by this version")
            stored = Stored.of(file)
        found = _compared(place, stored)
        shown = shown_parts(place) if found and not is_part else {}
        if shown and all(part.is_file() for part in shown):
            parts = tuple(_checked(part, is_part=True) for part in shown)
            found = replace(found, parts=parts, is_compressed=False)
        if shown and found:
            check_parts(place)  # they are whole, but may be others, or one is missing
        return found
    except InputError:
        raise
    except (OSError, RuntimeError, KeyError, ValueError, TypeError, EOFError, MemoryError) as error:
        with contextlib.suppress(OSError):
            if place.is_file() and not is_hdf5(place):
                open_map(place)  # which says what it is instead
        remedy = "give a map that a sweep has written, or write it again"
        raise InputError(f"{place}: cannot be read ({reason(error)})", remedy=remedy) from error


def _compared(path: Path, stored: Stored) -> FileCheck:
    """Return the outcome for a file with its checksums."""
    blocks = [(name, *block) for name in stored.values for block in stored.blocks(name)]

    def is_intact(block: tuple[str, int, Range]) -> bool:
        name, number, _ = block
        return stored.read(fd, name, number) is not None

    with open_to_read(path) as fd, ThreadPoolExecutor() as pool:
        intact = list(pool.map(is_intact, blocks))
        rest_is_intact = stored.rest_is_intact(fd)
        nbytes = os.fstat(fd).st_size
    wrong = [block for block, as_written in zip(blocks, intact, strict=True) if not as_written]
    ranges: dict[str, list[Range]] = {}
    for name, _, (start, stop) in wrong:
        itemsize = stored.values[name].itemsize
        ranges.setdefault(name, []).append((start // itemsize, stop // itemsize))
    damaged = {
        name: [(first, end - 1) for first, end in joined_ranges(values)] for name, values in ranges.items()
    }
    return FileCheck(path, nbytes, damaged, rest_is_intact, not blocks)
