"""Read the designs of an xarray Dataset: a table, the axes of a grid, or the map of a sweep."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from fastlink._text import short_repr
from fastlink.errors import InputError
from fastlink.space.columns import Columns, refused
from fastlink.space.design_space import BRANCH, DESIGN, EXTREMUM, DesignSpace
from fastlink.space.values import Floats, axis_of, numbers_of, units_of

__all__ = ["CURVES", "FORMAT", "LAYOUTS", "MAPS", "STATUS", "space_of_dataset"]

#: Global attribute of a map: the version of its layout; absent from a file that is not complete.
FORMAT = "fastlink_map"
#: The result that says how a design assembles, in every map.
STATUS = "status"
#: How the values of a map lie: all those of a design together, or those of all designs at one input position.
CURVES, MAPS = LAYOUTS = ("curves", "maps")
#: The dimensions of the results of a map that are none of designs.
OF_RESULTS = (BRANCH, EXTREMUM)


def space_of_dataset(dataset: Any, keep: Collection[str], allow_invalid: bool) -> DesignSpace:
    """Return the designs of a Dataset, in its own dimensions.

    Variables and coordinates along one dimension are columns, a dimension whose coordinate stands alone is an axis,
    scalars are constants, texts and other numbers along an index are labels. The results of a map, and their further
    dimensions, are left out.

    Raises
    ------
    InputError
        The variables are no table and no grid.
    """
    reader = _Reader(dataset)
    columns = Columns(keep, allow_invalid, [str(name) for name in (*dataset.data_vars, *dataset.coords)])
    columns.of_map |= reader.of_map
    inside = reader.table_dim()
    for name, variable in reader.entries.items():
        if variable.dims == () or variable.dims == (inside,):
            _add(columns, reader, name, variable)
    axes = {dim: axis for dim in reader.axes(inside) if (axis := reader.axis(dim, columns)) is not None}
    attrs: dict[str, str | int] = {"design_kind": "table" if inside else "grid"}
    if inside or not axes:
        space = columns.space(attrs, single=True)
    else:
        columns.problems.stop()
        further: dict[str, Any] = {"units": columns.units, "of_map": columns.of_map}
        labels = {name: label for name, label in columns.labels.items() if label.ndim == 0}
        space = DesignSpace("grid", (), (), columns.constants, attrs=attrs, labels=labels, **further)
    for dim, axis in axes.items():
        space = replace(
            space, dims=(*space.dims, dim), shape=(*space.shape, len(axis)), axes={**space.axes, dim: axis}
        )
    return replace(space, ignored=tuple(reader.results))


def _add(columns: Columns, reader: _Reader, name: str, variable: Any) -> None:
    """Add a variable of a table to its columns, constants or labels."""
    is_index = name in reader.dataset.dims
    whole = name not in reader.dataset.data_vars and variable.dtype.kind in "iu"
    if is_index or (whole and variable.ndim == 1 and "flag_values" not in variable.attrs):
        label, count = DESIGN if is_index and name == DESIGN else name, variable.size
        if not (
            is_index and variable.dtype.kind in "iu" and np.array_equal(variable.values, np.arange(count))
        ):
            with columns.problems.at():
                columns.add_label(label, variable.values)
        return
    columns.add(name, variable)


class _Reader:
    """The variables of a Dataset that may give designs.

    Attributes
    ----------
    of_map : bool
        Whether it is the result of a sweep.
    results : list of str
        The results of that sweep.
    entries : dict
        The other variables and coordinates by name.
    """

    def __init__(self, dataset: Any) -> None:
        self.dataset = dataset
        attrs = dataset.attrs
        self.of_map = FORMAT in attrs
        self.outside = {*OF_RESULTS, str(attrs.get("input", ""))} if self.of_map else set()
        self.results = [str(name) for name, one in dataset.data_vars.items() if self._is_result(one)]
        self.entries: dict[str, Any] = {}
        for key, one in {**dict(dataset.data_vars), **dict(dataset.coords)}.items():
            name = str(key)
            levels = getattr(dataset.indexes.get(key), "nlevels", 1) if key in dataset.dims else 1
            if levels > 1 or name in self.results or self.outside & {name, *map(str, one.dims)}:
                continue
            if not isinstance(key, str):
                raise refused(f"a variable is named {short_repr(key)}", "name it by the input it holds")
            self.entries[name] = one

    def _is_result(self, variable: Any) -> bool:
        return self.of_map and (
            "references" in variable.attrs or bool(self.outside & {*map(str, variable.dims)})
        )

    def table_dim(self) -> str:
        """Return the dimension along which the columns are, an empty text without any."""
        along: dict[str, str] = {}
        for name, variable in self.entries.items():
            if variable.ndim > 1:
                remedy = "give 1-D variables, for instance by dataset[['a1', 'a2']]"
                raise InputError(
                    f"has dimensions {tuple(variable.dims)}", where=("table", name), remedy=remedy
                )
            is_column = name in self.dataset.data_vars or variable.dtype.kind in "iuf"
            for dim in variable.dims if name not in self.dataset.dims and is_column else ():
                along.setdefault(str(dim), name)
        if len(along) > 1:
            two = [f"{name} along {short_repr(dim)}" for dim, name in along.items()][:2]
            raise refused(" but ".join(two), "give variables along one common dimension")
        return next(iter(along), "")

    def axes(self, inside: str) -> Iterator[str]:
        """Yield the dimensions that are axes, in the order of the results of a map."""
        if inside and not self.of_map:
            return
        first = [self.dataset[name].dims for name in ("status", *self.results) if name in self.results][:1]
        for dim in dict.fromkeys([*map(str, (*first, ())[0]), *map(str, self.dataset.dims)]):
            if dim != inside and dim in self.entries and self.entries[dim].dims == (dim,):
                yield dim

    def axis(self, dim: str, columns: Columns) -> Floats | None:
        """Return the values of an axis, None of one that holds texts; what is wrong is noted."""
        coordinate = self.entries[dim]
        if coordinate.dtype.kind not in "iuf":
            return None
        with columns.problems.at():
            columns.units |= units_of(dim, coordinate)
            return axis_of("table", dim, numbers_of("table", dim, coordinate.values))
        return None
