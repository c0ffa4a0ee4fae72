"""What a map is made of: variables and where their values lie, attributes, the history."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from fastlink._text import __version__, short_repr, unwritable, writable
from fastlink.errors import InputError, KeyPath, Problems
from fastlink.io.checksums import Range
from fastlink.space.design_space import DESIGN, Column, Counted, DesignSpace
from fastlink.space.tables import FORMAT

# -- Tell where the values of designs lie among those of a variable: design by design, or value by value


@dataclass(frozen=True)
class Placement:
    """Where the rows of a variable lie, one row of values for each design.

    >>> Placement(10, 3, 8, by_value=False).pieces(2, 4)
    [(48, 48)]
    >>> Placement(10, 3, 8, by_value=True).pieces(2, 4)
    [(16, 16), (96, 16), (176, 16)]
    >>> crossed = Placement(12, 1, 8, by_value=False, shared=3)
    >>> crossed.pieces(2, 7), crossed.own(2, 7)
    ([(8, 16)], (1, 3))
    >>> Placement(10, 3, 8, by_value=True).rows_in(96, 104), Placement(10, 3, 8, by_value=False).rows_in(48, 56)
    ([(2, 3)], [(2, 3)])
    """

    #: Number of designs.
    rows: int
    #: Values of each design.
    values: int
    #: Bytes of a value.
    itemsize: int
    #: Whether the first value of all designs comes first, then the second one; else the first design, then
    #: the second.
    by_value: bool
    #: Designs that share a value, written with the first of them: of an input that further axes are crossed
    #: with.
    shared: int = 1

    def own(self, start: int, stop: int) -> Range:
        """Return the rows that follow from some designs; those of other designs are others."""
        return -(-start // self.shared), -(-stop // self.shared)

    def pieces(self, start: int, stop: int) -> list[Range]:
        """Return where the values of some designs lie: position and number of bytes of each piece."""
        start, stop = self.own(start, stop)
        count = (stop - start) * self.itemsize
        if not self.by_value or stop - start == self.rows:
            return [(start * self.values * self.itemsize, count * self.values)] if count else []
        first, step = start * self.itemsize, self.rows * self.itemsize
        return [(first + k * step, count) for k in range(self.values)] if count else []

    def rows_in(self, start: int, stop: int) -> list[Range]:
        """Return the designs that have values in a range of bytes."""
        if not self.by_value:
            of_row = self.values * self.itemsize
            first, last = start // of_row, -(-stop // of_row)
            return [(first * self.shared, min(self.rows, last * self.shared))]
        first, count = start // self.itemsize, -(-stop // self.itemsize) - start // self.itemsize
        begin = first % self.rows
        if count >= self.rows:
            return [(0, self.rows)]
        if begin + count <= self.rows:
            return [(begin, begin + count)]
        return [(0, begin + count - self.rows), (begin, self.rows)]


# -- Check the global attributes that a caller adds to a map, before anything is computed


#: Names that HDF5 and netCDF keep for themselves, besides those that begin with an underscore.
OF_FORMAT = ("CLASS", "DIMENSION_LIST", "NAME", "REFERENCE_LIST", "coordinates")
#: Bytes of a name: netCDF has room for 256, with a zero at the end.
LONGEST = 255
#: Whole numbers that HDF5 holds.
LEAST, GREATEST = -(2**63), 2**64 - 1
PLAIN = "write text, a number or a list of numbers"


def check_attrs(where: KeyPath, attrs: Any, reserved: Callable[[str], bool]) -> dict[str, Any]:
    """Return attributes that a file can hold under names that it does not use itself, or refuse them.

    >>> check_attrs(("attrs",), {"author": None}, lambda name: False)
    Traceback (most recent call last):
    fastlink.errors.InputError: attrs: author is None; write text, a number or a list of numbers
    """
    if not isinstance(attrs, Mapping):
        remedy = "write a mapping, such as {'author': 'A. Name'}"
        raise InputError(f"is {short_repr(attrs)}", where=where, remedy=remedy)
    problems = Problems()
    own = [name for name in attrs if isinstance(name, str) and reserved(name)]
    if own:
        verb = "are names" if own[1:] else "is a name"
        problems.add(f"{', '.join(own)} {verb} that the map itself writes", where, "choose another name")
    for name, value in attrs.items():
        if name in own:
            continue
        if (fault := _fault_of_name(name)) is not None:
            problems.add(f"{short_repr(name)} {fault}", where, "name it by letters, digits and underscores")
        elif (fault := fault_of_value(value)) is not None:
            problems.add(fault, (*where, name), PLAIN)
    problems.stop()
    return dict(attrs)


def _fault_of_name(name: object) -> str | None:
    """Return why a file can have no attribute of a name, None where it can."""
    if not isinstance(name, str):
        return "is not text"
    if not name or name != name.strip():
        return "is empty, or begins or ends with a space"
    if "/" in name or not name.isprintable():
        return "holds a slash, or a letter that cannot be printed"
    if name.startswith("_") or name in OF_FORMAT:
        return "is a name that HDF5 and netCDF keep for themselves"
    return f"is longer than {LONGEST} bytes" if len(name.encode()) > LONGEST else None


def fault_of_value(value: Any) -> str | None:
    """Return why a file cannot hold a value, None where it can."""
    if isinstance(value, str):
        sign = unwritable(value)
        return f"holds {sign!r}, which no file can hold" if sign else None
    if isinstance(value, (bool, np.bool_)):
        return None
    if isinstance(value, int):
        return None if LEAST <= value <= GREATEST else "is a whole number of more than 64 bits"
    try:
        numbers = np.asarray(value)
    except ValueError:  # nested lists of unequal length
        return f"is {short_repr(value)}"
    scalar = isinstance(value, (np.generic, float))
    if numbers.dtype.kind not in "iuf" or not (scalar or (numbers.ndim == 1 and numbers.size)):
        return f"is {short_repr(value)}"
    if numbers.dtype.kind == "f" and numbers.itemsize not in (4, 8):
        return f"is of {numbers.dtype}, which netCDF has not"
    return None


# -- The attribute ``history`` of CF: a line for each program that has made or changed a file


HISTORY = "history"
#: What the attributes begin with that are true of the map from which a file was converted, and not of the file.
SOURCE = "source_"


def history(command: str, before: str = "") -> str:
    """Return the history of a file after a command: its lines before, then time, version and the command.

    >>> history("sweep planar_4r").partition("Z ")[2].startswith("fastlink ")
    True
    """
    line = f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ} fastlink {__version__}: {writable(' '.join(command.split()))}"
    return f"{before}\n{line}" if before else line


# -- Label arrays as an xarray Dataset with dimensions, coordinates and attributes


FORMAT_VERSION = 1
#: Global attribute of a map that a request has made: the hash of the request.
FINGERPRINT = "fingerprint"
#: Global attribute of a map: the time at which it was finished, in ns since 1970.
WRITTEN = "written_time_ns"

#: How the names of attributes of a variable begin that verification measures on the designs of a whole run.
MEASURED = ("verified_values", "verify_mismatches", "independent_", "error_")
#: Labels of coordinates along ``design`` that are no inputs.
OF_NUMBERS, OF_LABELS = {"long_name": "number of the design"}, {"long_name": "label of the design"}
Further = Mapping[str, tuple[tuple[str, ...], NDArray[Any], Mapping[str, Any]]]


@dataclass(frozen=True, eq=False)
class Variable:
    """One output of a sweep: its name, shape and labels, without its values."""

    #: Name in the Dataset and in the file.
    name: str
    #: Dimensions, in the order in which values lie in the file.
    dims: tuple[str, ...]
    #: Length of each dimension.
    shape: tuple[int, ...]
    #: Of integers or floating-point numbers.
    dtype: np.dtype[Any]
    #: Units, long name, symbol, flags, ...
    attrs: dict[str, Any]
    #: How many of the first dimensions are those that each design has of its own; 0 where the swept ones are
    #: first.
    leading: int = field(default=0, repr=False)  # of which the dimensions tell
    #: Whether it is no result but a coordinate that is written block by block.
    is_coordinate: bool = field(default=False, repr=False)

    def __post_init__(self) -> None:
        if len(self.dims) != len(self.shape):
            raise ValueError(f"{self.name}: dimensions {self.dims} but shape {self.shape}")
        if self.dtype.kind not in "iuf":
            # h5py's booleans read as int8 in netCDF4: flags are integers with flag_values
            raise TypeError(f"{self.name}: dtype {self.dtype} is neither integer nor floating point")

    @property
    def nbytes(self) -> int:
        """Bytes of all values."""
        return math.prod(self.shape) * self.dtype.itemsize

    def placement(self, rows: int) -> Placement:
        """Return where so many rows of values lie, one row for each design."""
        if self.is_coordinate and rows:
            return Placement(rows, 1, self.dtype.itemsize, by_value=False, shared=rows // self.shape[0])
        values = math.prod(self.shape) // rows if rows else 0
        return Placement(rows, values, self.dtype.itemsize, by_value=self.leading > 0)

    def arranged(self, array: NDArray[Any]) -> NDArray[Any]:
        """Return values of all designs, design by design, in the dimensions of the variable; without a copy."""
        own, swept = self.shape[: self.leading], self.shape[self.leading :]
        order = (*range(len(swept), len(self.shape)), *range(len(swept)))
        return array.reshape(swept + own).transpose(order)


def coordinates(
    space: DesignSpace,
    described: Mapping[str, Mapping[str, Any]],
    further: Further,
    left_out: Collection[str] = (),
) -> xr.Dataset:
    """Return a Dataset that holds the coordinates of a sweep and no data."""
    coords: dict[str, Any] = {}
    for name, axis in space.axes.items():
        coords[name] = ((name,), *of_code(axis, plain_attrs(described[name])))
    if DESIGN in space.dims and DESIGN not in left_out:
        number = space.labels.get(DESIGN, np.arange(space.shape[space.dims.index(DESIGN)]))
        coords[DESIGN] = ((DESIGN,), np.asarray(number), OF_NUMBERS)
    for name, column in space.columns.items():
        if name not in left_out:
            coords[name] = ((DESIGN,), *of_code(np.asarray(column), plain_attrs(described[name])))
    for name, value in space.constants.items():
        coords[name] = ((), *of_code(value, plain_attrs(described[name])))
    for name, label in space.labels.items():
        if name != DESIGN and name not in left_out:
            coords[name] = ((DESIGN,) if label.ndim else (), np.asarray(label), OF_LABELS)
    for name, (dims, values, attrs) in further.items():
        if name in coords:
            raise ValueError(f"coordinate {name!r} is an input of the design space already")
        coords[name] = (dims, values, plain_attrs(attrs))
    return xr.Dataset(coords=coords, attrs=plain_attrs(space.attrs))


def of_code(values: Any, labels: dict[str, Any]) -> tuple[Any, dict[str, Any]]:
    """Return the values of an input that is a code as the flags of results, integers; of others, as they are."""
    # Values that are no code leave all as they are, with the codes in their type, as CF wants it.
    if "flag_values" not in labels:
        return values, labels
    codes = np.asarray(values)
    if np.isin(codes, labels["flag_values"]).all():
        return codes.astype(np.int32), labels
    return values, labels | {"flag_values": np.asarray(labels["flag_values"], codes.dtype)}


def computed_coordinates(
    space: DesignSpace, described: Mapping[str, Mapping[str, Any]]
) -> list[tuple[Variable, Column]]:
    """Return the coordinates along ``design`` that are computed where they are looked at, with their labels."""
    along = {name: values for name, values in {**space.columns, **space.labels}.items() if np.ndim(values)}
    found = {name: values for name, values in along.items() if isinstance(values, Column)}
    if not found:
        return []
    count = space.shape[space.dims.index(DESIGN)]
    if DESIGN not in along:
        found[DESIGN] = Counted(0, count)
    of_labels = dict.fromkeys(space.labels, OF_LABELS) | {DESIGN: OF_NUMBERS}
    attrs = {name: of_labels.get(name) or plain_attrs(described[name]) for name in found}
    return [
        (Variable(name, (DESIGN,), (count,), column.dtype, attrs[name], is_coordinate=True), column)
        for name, column in found.items()
    ]


def assemble(
    coords: xr.Dataset,
    variables: Sequence[Variable],
    arrays: Mapping[str, NDArray[Any]],
    attrs: Mapping[str, Any],
) -> xr.Dataset:
    """Return the labelled Dataset of a sweep in memory, equal to that of a file."""
    data = {}
    for variable in variables:
        check_dims(coords, coords.sizes, variable)
        values = arrays[variable.name].reshape(variable.shape)
        if values.dtype != variable.dtype:
            raise TypeError(f"{variable.name}: values are {values.dtype}, not {variable.dtype}")
        data[variable.name] = (variable.dims, values, plain_attrs(variable.attrs))
    return xr.Dataset(data, coords=coords.coords, attrs=coords.attrs | marked(attrs))


def marked(attrs: Mapping[str, Any]) -> dict[str, Any]:
    """Return global attributes with the version of the layout of a complete map."""
    return plain_attrs(attrs) | {FORMAT: FORMAT_VERSION}


def check_dims(coords: xr.Dataset, sizes: Mapping[Any, int], variable: Variable) -> None:
    """Refuse a variable with the name of a coordinate, or with other dimensions than those that have so many values."""
    if variable.name in coords.coords:
        raise ValueError(f"{variable.name}: a coordinate has that name")
    for dim, length in zip(variable.dims, variable.shape, strict=True):
        if sizes.get(dim) != length:
            raise ValueError(f"{variable.name}: {length} along {dim!r}, its coordinate {sizes.get(dim)}")


def plain_attrs(attrs: Mapping[str, Any]) -> dict[str, Any]:
    """Return attributes as text, numbers and 1-D arrays, which netCDF can hold."""
    return {name: _plain(name, value) for name, value in attrs.items()}


def _plain(name: str, value: Any) -> Any:
    if isinstance(value, str):
        return value
    if isinstance(value, (bool, np.bool_)):
        return int(value)
    if isinstance(value, (int, float, np.integer, np.floating)):
        return value
    numbers = np.asarray(value)
    if numbers.dtype.kind in "iuf" and numbers.ndim == 1 and numbers.size:
        return numbers
    raise TypeError(f"attribute {name!r}: {value!r} is neither text nor a number nor a list of numbers")
