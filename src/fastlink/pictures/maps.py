"""Draw a variable of a map: check the request, select, lay out panels."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from fastlink._text import short_number, short_repr
from fastlink.errors import InputError, Remedy, Setting, check_choice, check_whole, listed, suggest
from fastlink.io.where import is_scale, nearest
from fastlink.maps.units import degrees as in_degrees
from fastlink.maps.units import degrees_along, flags_of
from fastlink.pictures.labels import plain, units_text, valued
from fastlink.space.design_space import BRANCH, as_real
from fastlink.space.tables import STATUS
from fastlink.space.units import in_si, named_with_unit

if TYPE_CHECKING:
    import xarray as xr

    T = TypeVar("T", xr.DataArray, xr.Dataset)
    from matplotlib.figure import Figure


# -- Select what a picture shows: one variable, at fixed values of all dimensions but one or two


MOST_CELLS = 1600  # along each side, more than the pixels of a picture
MOST_BESIDE = 6  # values of one dimension, or panels, side by side
COUNTS = {1: "one", 2: "two", 3: "three"}


@dataclass(frozen=True)
class Selection:
    """A variable as a picture shows it."""

    #: Over one or two dimensions by growing coordinates, and over branches.
    variable: xr.DataArray
    #: Those dimensions.
    free: list[str]
    #: The value of each dimension that is fixed.
    fixed: dict[str, Any]
    #: The status of each cell, where the cells of a map are designs.
    status: xr.DataArray | None
    #: The labels along dimensions whose coordinates are not numbers; these have their places instead.
    names: dict[str, list[str]]
    #: The dimension whose values are shown beside each other.
    split: str | None = None


def select(
    dataset: xr.Dataset,
    name: str,
    branch: int | None,
    at: Mapping[str, float],
    split: tuple[str, Any] | None = None,
) -> Selection:
    """Return what a picture of a variable shows, or refuse the request.

    `split` is ``("panels", DIM)`` or ``("lines", DIM)``: the option and the dimension some of whose values are shown
    beside each other.
    """
    variable = _variable(dataset, name)
    at = values_at(at, {str(dim): variable[dim].attrs.get("units", "1") for dim in variable.dims})
    if branch is not None:
        variable = one_branch(variable, branch)
    if split is not None:
        _check_split(variable, *split, at)
    beside = None if split is None else str(split[1])
    places, fixed = _fixed(variable, at, beside)
    if variable.size == 0:
        empty = next(str(dim) for dim, length in variable.sizes.items() if not length)
        what = f"{name} has no values along {empty}"
        raise InputError(what, where=("plot",), remedy="select at least one value")
    variable = variable.isel(places)
    free = [str(dim) for dim in variable.dims if dim not in (BRANCH, beside)]
    _check_free(variable, name, free, split)
    status = _status(dataset, name, places, free, beside)
    drawn: list[xr.DataArray] = [variable] if status is None else [variable, status]
    names: dict[str, list[str]] = {}
    for dim in free if beside is None else [*free, beside]:
        along = variable[dim].values
        order = np.argsort(along, kind="stable") if is_scale(along) else np.arange(along.size)
        if dim == beside:  # by growing values, evenly over all of them
            order = order[spread(along.size, MOST_BESIDE)]
        elif len(free) == 2:
            order = order[:: -(-along.size // MOST_CELLS)]
        if dim != beside and not is_scale(along):
            names[dim] = [str(along[k]) for k in order]
            drawn = [_by_place(array, dim) for array in drawn]
        drawn = [array.isel({dim: order}) if dim in array.dims else array for array in drawn]
    read = [array.load() for array in drawn]
    return Selection(read[0], free, fixed, read[1] if status is not None else None, names, beside)


def _check_split(variable: xr.DataArray, option: str, dim: Any, at: Mapping[str, float]) -> None:
    """Refuse a dimension whose values cannot stand beside each other."""
    known = [str(key) for key in variable.dims if key != BRANCH]
    there = dict.fromkeys(map(str, variable.coords), listed(known))
    check_choice((option,), dim, known, f" to {variable.name}", lambda one: there.get(one, ""))
    if dim in at:
        raise InputError(f"{dim} is fixed by at", where=(option,), remedy="leave one of them out")


def spread(count: int, most: int) -> Any:
    """Return some of so many places, evenly over all, the first and the last among them.

    Examples
    --------
    >>> spread(5, 6).tolist(), spread(101, 6).tolist()
    ([0, 1, 2, 3, 4], [0, 20, 40, 60, 80, 100])
    """
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int))


def _variable(dataset: xr.Dataset, name: Any) -> xr.DataArray:
    """Return a variable of numbers, or refuse its name."""
    name = check_choice(("names",), name, [str(key) for key in dataset.data_vars])
    variable: xr.DataArray = dataset[name]
    if variable.dtype.kind not in "iufb":
        remedy = "draw a variable of numbers"
        raise InputError(f"{name} holds {variable.dtype}, not numbers", where=("names",), remedy=remedy)
    return variable


def one_branch(variable: T, branch: Any) -> T:
    """Return the part of a variable, or of a map, for one branch."""
    if BRANCH not in variable.coords:
        what = f"{getattr(variable, 'name', 'the map')} is the same in every branch"
        raise InputError(what, where=("branch",), remedy="leave it out")
    known = np.atleast_1d(variable[BRANCH].values).tolist()
    remedy = f"write one of {', '.join(map(str, known))}"
    if len(known) == 1:
        remedy = f"the map is of branch {known[0]} alone: leave it out, or compute both branches"
    if check_whole(("branch",), branch, min(known), max(known), remedy) not in known:
        raise InputError(f"{branch} is not in the result", where=("branch",), remedy=remedy)
    return variable.isel({BRANCH: [known.index(branch)]}) if BRANCH in variable.dims else variable


def _fixed(
    variable: xr.DataArray, at: dict[str, Any], beside: str | None
) -> tuple[dict[str, int], dict[str, Any]]:
    """Return place and value of each dimension that is fixed: by `at`, or as it has one value alone."""
    places: dict[str, int] = {}
    for key in variable.dims:
        if key in at and key != BRANCH:
            places[str(key)] = nearest_place(str(key), variable[key].values, at.pop(str(key)))
        elif variable.sizes[key] == 1 and key not in (BRANCH, beside):
            places[str(key)] = 0
    for dim in at:
        known = [str(key) for key in variable.dims if key != BRANCH]
        remedy: Remedy = listed(known) if dim in variable.coords or not known else suggest(dim, known)
        if dim == BRANCH:
            remedy = ("choose one by ", Setting("branch", 1))
        what = f"{short_repr(dim)} is not a dimension of {variable.name} that can be fixed"
        raise InputError(what, where=("at",), remedy=remedy)
    return places, {dim: variable[dim].values[place] for dim, place in places.items()}


def values_at(at: Any, units: Mapping[str, str]) -> dict[str, Any]:
    """Return the values of dimensions in the units of these, or refuse what is no mapping."""
    if not isinstance(at, Mapping) or hasattr(at, "data_vars"):
        remedy = ("write such as ", Setting("at", {"a4": 1.0}))
        raise InputError(f"is {short_repr(at)}", where=("at",), remedy=remedy)
    return in_si("at", at, units)


def nearest_place(dim: str, values: Any, value: Any) -> int:
    """Return the place of the nearest value along a dimension."""
    wanted = as_real(value)
    if wanted is None or not math.isfinite(wanted):
        remedy = named_with_unit(dim, value) or "write a finite number"
        raise InputError(f"is {short_repr(value)}", where=("at", dim), remedy=remedy)
    if not is_scale(values):
        what = f"has {'no values' if not values.size else 'coordinates that are not finite numbers'}"
        raise InputError(what, where=("at", dim), remedy=f"select by maps.isel({dim}=0)")
    low, high = float(values.min()), float(values.max())
    place = nearest(values, wanted, 1e-9 * max(abs(low), abs(high)))
    if place is None:
        remedy = f"write a number from {low:g} to {high:g}"
        raise InputError(f"is {wanted:g}, outside the result", where=("at", dim), remedy=remedy)
    return place


def _check_free(variable: xr.DataArray, name: str, free: list[str], split: tuple[str, Any] | None) -> None:
    """Refuse to draw over no dimension, or over more than two; lines run along one, panels have two."""
    if split is not None and len(free) == {"lines": 2, "panels": 1}[split[0]]:
        option, other = ("lines", "panels") if split[0] == "lines" else ("panels", "lines")
        what = f"{name} has the dimensions {', '.join([*free, str(split[1])])}"
        fix = (", or fix one by at",) if option == "lines" else ()
        raise InputError(what, where=(option,), remedy=("write ", Setting(other, str(split[1])), *fix))
    if len(free) > 2:
        what = f"{name} has the dimensions {', '.join(_listed(variable[dim]) for dim in free)}"
        values = variable[free[-1]].values
        middle = float(f"{values[len(values) // 2]:g}") if is_scale(values) else 0
        count = COUNTS.get(len(free) - 2, str(len(free) - 2))
        beside = (", or show some values side by side by ", Setting("panels", free[-1]))
        remedy = (f"fix {count} of them by ", Setting("at", {free[-1]: middle}), *(() if split else beside))
        raise InputError(what, where=("plot",), remedy=remedy)
    if not free:
        text = ", ".join(map(short_number, variable.values.ravel()))
        what = f"{name} has no dimension left to draw it over; its value is {text}"
        raise InputError(what, where=("plot",), remedy="leave one free")


def _listed(along: xr.DataArray) -> str:
    values = np.sort(along.values) if is_scale(along.values) else along.values
    return f"{along.name} ({along.size} from {short_number(values[0])} to {short_number(values[-1])})"


def _by_place(array: xr.DataArray, dim: str) -> xr.DataArray:
    """Return a variable with places, 0, 1, 2, ..., along a dimension, and without its labels."""
    labels = [name for name, coord in array.coords.items() if dim in coord.dims]
    attrs = array[dim].attrs
    return array.drop_vars(labels).assign_coords({dim: (dim, np.arange(array.sizes[dim]), attrs)})


def _status(
    dataset: xr.Dataset, name: str, places: Mapping[str, int], free: list[str], beside: str | None
) -> xr.DataArray | None:
    """Return the status of the designs of a map, or None if its cells are not designs."""
    if name == STATUS or STATUS not in dataset.data_vars:
        return None
    status = dataset[STATUS]
    status = status.isel({dim: place for dim, place in places.items() if dim in status.dims})
    known = set(status.dims) - {beside} == set(free)
    if not known or status.dtype.kind not in "iu" or not flags_of(status):
        return None
    return status.transpose(..., *reversed(free))


# -- The panels of a picture: branches, and values of a dimension that stand side by side


MOST_NAMES = 24  # along one side
MOST_BELOW = 3  # panels side by side where those of another branch stand below
#: Values that differ by less, relative to the greatest, are the same: several thousand roundings.
SAME = 1e-12


@dataclass(frozen=True)
class Panel:
    """One of the pictures, or lines, that stand side by side."""

    #: Which branches these are, and which value of the dimension that is split; empty where there are no
    # others.
    branches: str
    value: str
    #: The values.
    array: xr.DataArray
    #: The place along the dimension that is split, 0 where there is none.
    place: int = 0

    @property
    def title(self) -> str:
        """Return the text that tells it from the others."""
        return ", ".join(filter(None, (self.branches, self.value)))


def panels_of(shown: Selection) -> list[list[Panel]]:
    """Return rows of panels: branches, those that agree in one row; in each row the values of a dimension."""
    parts = _branches(shown.variable)
    alone = len(parts) == 1
    if shown.split is None:
        return [[Panel(title * (not alone), "", part) for title, part in parts]]
    along = shown.variable[shown.split]
    few = spread(along.size, MOST_BESIDE if alone or len(shown.free) == 1 else MOST_BELOW)
    titles = {int(k): valued(along, along.values[k]) for k in few}
    return [
        [Panel(branch * (not alone), title, part.isel({shown.split: k}), k) for k, title in titles.items()]
        for branch, part in parts
    ]


def branches_of(shown: Selection) -> str:
    """Return the branches of all panels where they are the same, and none says so."""
    parts = _branches(shown.variable)
    return parts[0][0] if len(parts) == 1 else ""


def _branches(variable: xr.DataArray) -> list[tuple[str, xr.DataArray]]:
    """Return title and values of each branch, or of all if they agree."""
    numbers = np.atleast_1d(variable[BRANCH].values).tolist() if BRANCH in variable.coords else []
    if BRANCH not in variable.dims:
        return [(f"branch {numbers[0]}" if numbers else "", variable)]
    count = variable.sizes[BRANCH]
    titles = [f"branch {b}" for b in numbers] or [f"branch {k} of {count}" for k in range(1, count + 1)]
    parts = [(title, variable.isel({BRANCH: k})) for k, title in enumerate(titles)]
    first = parts[0][1].values
    alike = all(np.allclose(part.values, first, rtol=1e-9, atol=0.0, equal_nan=True) for _, part in parts)
    if alike and len(parts) > 1 and numbers:
        return [(f"branches {' and '.join(map(str, numbers))} (they agree)", parts[0][1])]
    return parts


def sameness(variable: xr.DataArray, values: Any) -> str:
    """Return that all values are the same, and what they are; nothing where they differ, or for codes."""
    numbers = values[~np.isnan(values)]
    if flags_of(variable):
        return ""
    if not numbers.size:
        return "no value anywhere"
    low, high = float(numbers.min()), float(numbers.max())
    if np.isinf(low) or np.isinf(high):
        return "grows without bound everywhere" if np.isinf(numbers).all() else ""
    if high - low > SAME * max(abs(low), abs(high)):
        return ""
    units = str(variable.attrs.get("units", "1"))
    where = "everywhere" if numbers.size == values.size else "wherever it has a value"
    return f"{plain(short_number(low))}{'' if units == '1' else f' {units_text(units)}'} {where}"


def name_places(axis: Any, names: Sequence[str]) -> None:
    """Label an axis by the names of its places, not more than fit on it; those along x are turned."""
    step = -(-len(names) // MOST_NAMES)
    shown = [textwrap.shorten(plain(name), 24, placeholder="...") for name in names[::step]]
    axis.set_ticks(range(0, len(names), step), shown, rotation=30 if axis.axis_name == "x" else 0, ha="right")


# -- Draw a variable of a map: check the request, select, draw


def draw_variable(
    maps: xr.Dataset,
    name: Any,
    branch: int | None,
    at: Mapping[str, float] | None,
    panels: str | None,
    lines: str | None,
    degrees: bool,
) -> Figure:
    """Draw one variable of a map, over one or two of its dimensions."""
    from fastlink.pictures.charts import draw

    splits = [(key, dim) for key, dim in (("panels", panels), ("lines", lines)) if dim is not None]
    if len(splits) > 1:
        raise InputError("is given beside panels", where=("lines",), remedy="leave one of them out")
    if degrees:
        maps = degrees_along(maps)
    shown = select(maps, name, branch, {} if at is None else at, *splits)
    if degrees:
        shown = replace(shown, variable=in_degrees(shown.variable))
    return draw(maps, shown)
