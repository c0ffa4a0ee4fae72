"""Label arrays as an xarray Dataset with dimensions, coordinates and attributes."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from fastlink.io.placement import Placement
from fastlink.space.column import Column, Counted
from fastlink.space.dataset import FORMAT
from fastlink.space.design_space import DESIGN, DesignSpace

FORMAT_VERSION = 1
#: Global attribute of a map that a request has made: the hash of the request.
FINGERPRINT = "fingerprint"

#: Labels of coordinates along ``design`` that are no inputs.
OF_NUMBERS, OF_LABELS = {"long_name": "number of the design"}, {"long_name": "label of the design"}
Further = Mapping[str, tuple[tuple[str, ...], NDArray[Any], Mapping[str, Any]]]


@dataclass(frozen=True, eq=False)
class Variable:
    """One output of a sweep: its name, shape and labels, without its values.

    Attributes
    ----------
    name : str
        Name in the Dataset and in the file.
    dims : tuple of str
        Dimensions, in the order in which values lie in the file.
    shape : tuple of int
        Length of each dimension.
    dtype : numpy.dtype
        Of integers or floating-point numbers.
    attrs : dict
        Units, long name, symbol, flags, ...
    leading : int
        How many of the first dimensions are those that each design has of its own; 0 where the swept ones are first.
    is_coordinate : bool
        Whether it is no result but a coordinate that is written block by block.
    """

    name: str
    dims: tuple[str, ...]
    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    attrs: dict[str, Any]
    leading: int = field(default=0, repr=False)  # of which the dimensions tell
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
    """Return a Dataset that holds the coordinates of a sweep and no data.

    Parameters
    ----------
    space : DesignSpace
        Its axes become index coordinates, its columns and labels coordinates along ``design``, its constants
        scalars, and its `attrs` global attributes.
    described : mapping
        Attributes (units, long_name, symbol) of each input of the space.
    further : mapping of str to (dims, values, attrs)
        Coordinates that are not inputs, such as ``branch`` and ``theta1``.
    left_out : collection of str
        Coordinates along ``design`` that are written block by block, see `computed_coordinates`.
    """
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
    """Return the values of an input that is a code as the flags of results, integers; of others, as they are.

    Values that are no code leave all as they are, with the codes in their type, as CF wants it.
    """
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
    """Return the labelled Dataset of a sweep in memory, equal to that of a file.

    Parameters
    ----------
    coords : xarray.Dataset
        From `coordinates`.
    variables : sequence of Variable
        The results.
    arrays : mapping of str to ndarray
        Values of each variable, of any shape with as many elements; not copied when contiguous.
    attrs : mapping
        Global attributes, besides those of `coords`.
    """
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
