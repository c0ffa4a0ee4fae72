"""Parts of a map by values: what a name means, ranges, the nearest value, and what a selection takes of a map."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from fastlink._text import short_number, short_repr
from fastlink.errors import InputError, Problems, Remedy, Setting, remark, suggest
from fastlink.space.design_space import as_real
from fastlink.space.units import RADIANS, check_unit, remark_on_angles, scaled, split, usual_name


@dataclass(frozen=True)
class Range:
    """A range of values, both ends included."""

    low: float = -math.inf
    high: float = math.inf

    def holds(self, values: NDArray[Any], slack: float = 0.0) -> NDArray[np.bool_]:
        """Return where values are in it, or off by no more than some slack; NaN never is."""
        return (values >= self.low - slack) & (values <= self.high + slack)

    @property
    def ends(self) -> list[float]:
        """The ends that there are."""
        return [end for end in (self.low, self.high) if math.isfinite(end)]


def named(known: Mapping[str, Any], name: Any) -> tuple[str, Fraction | None]:
    """Return which variable a name means, an empty text for none, and its unit in that of the variable, if it has one.

    So of NAME_deg, which means NAME in degrees.
    """
    of, unit = split(name, known)
    if not unit:
        return (name if name in known else ""), None
    return of, check_unit(of, unit, str(known[of].attrs.get("units", "1")))


def in_units(array: xr.DataArray, values: Range, where: str, factor: Fraction | None) -> Range:
    """Return a range in the units of an array; radians that look like degrees are remarked on."""
    if factor is not None:
        return Range(*(float(scaled(end, factor)) for end in (values.low, values.high)))
    if array.attrs.get("units") == RADIANS:
        given = values.low if values.low == values.high else values.ends
        remark_on_angles(str(array.name), given, where)
    return values


def is_scale(values: NDArray[Any]) -> bool:
    """Tell whether coordinates are finite numbers, among which there is a nearest one."""
    return bool(values.size and values.dtype.kind in "iuf" and np.isfinite(values).all())


def nearest(values: NDArray[Any], value: float, slack: float) -> int | None:
    """Return the place of the nearest value, None if all are off by more than the slack on one side."""
    if not values.min() - slack <= value <= values.max() + slack:
        return None
    return int(np.argmin(abs(values - value)))


# -- What conditions take of a map along its dimensions: by values, or by numbers of values


#: What is taken along a dimension: one number, which the result has no dimension for, or several.
Indexer = int | range | NDArray[np.intp]
#: A value counts as an end of a range if it differs by four roundings: 1.1 + 0.1 is more than 1.2.
SLACK = 4 * 2.0**-52
NUMBER_SIGN, TO = "#", ":"
ENDLESS = (-math.inf, math.inf)
FORMS = (
    "write ",
    Setting("select", {"a2": "1.1:1.2"}),
    " for a range, a number for the nearest value, or '#3' or '#0:10' for numbers of values",
)


@dataclass
class Selection:
    """What conditions take of a map, by dimension, and their texts, such as ``a2=1.1:1.2``."""

    indexers: dict[str, Indexer] = field(default_factory=dict)
    texts: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        return "; ".join(self.texts)

    def add(self, dim: str, indexer: Indexer) -> None:
        """Take less along a dimension; both conditions have to hold."""
        if dim in self.indexers:
            indexer = np.intersect1d(self.indexers[dim], indexer)
        if isinstance(indexer, np.ndarray) and indexer.size and indexer[-1] - indexer[0] == indexer.size - 1:
            indexer = range(int(indexer[0]), int(indexer[-1]) + 1)  # which is read at once
        self.indexers[dim] = indexer

    def size(self, dim: str, size: int) -> int:
        """Return how many values are taken along a dimension of some size."""
        indexer = self.indexers.get(dim, range(size))
        return 1 if isinstance(indexer, int) else len(indexer)


def selected(maps: xr.Dataset, given: Any) -> Selection:
    """Return what conditions take of a map, or refuse them.

    Examples
    --------
    >>> maps = xr.Dataset(coords={"a2": [1.0, 1.1, 1.2, 1.3]})
    >>> selected(maps, {"a2": "1.1:1.2"})
    Selection(indexers={'a2': range(1, 3)}, texts=['a2=1.1:1.2'])
    """
    selection, problems = Selection(), Problems()
    if given is None:
        return selection
    if not isinstance(given, Mapping):
        raise InputError(f"is {short_repr(given)}", where=("select",), remedy=FORMS)
    for name, condition in given.items():
        with problems.at("select", str(name)):
            coordinate, factor = _coordinate(maps, name)
            taken = _taken(coordinate, condition, factor)
            if not isinstance(taken, int) and not len(taken):
                raise InputError(f"{_text(condition)} takes nothing; {_span(coordinate)}", remedy="widen it")
            for dim in coordinate.dims:
                selection.add(str(dim), taken)
            selection.texts.append(f"{name}={_text(condition)}")
    problems.stop()
    for dim, indexer in selection.indexers.items():
        if not isinstance(indexer, int) and not len(indexer):
            what = f"no value along {dim} meets {selection}"
            raise InputError(what, where=("select",), remedy="leave one of the conditions out")
    return selection


def _coordinate(maps: xr.Dataset, name: Any) -> tuple[xr.DataArray, Fraction | None]:
    """Return the coordinate of a condition, and the unit of its values in that of the coordinate; see `named`."""
    known = {str(key): coord for key, coord in maps.coords.items() if coord.ndim < 2}
    known |= {
        str(dim): xr.DataArray(np.arange(size), dims=str(dim), name=str(dim))
        for dim, size in maps.sizes.items()
        if str(dim) not in known
    }
    key, factor = named(known, name)
    if key in known:
        return known[key], factor
    if name in maps.data_vars:
        what, remedy = "is a result, which has no dimension of its own", f"select by {', '.join(known)}"
        raise InputError(what, remedy=remedy)
    others = [usual_name(key, one.attrs.get("units", "")) for key, one in known.items()]
    raise InputError("is no dimension and no coordinate of the map", remedy=suggest(name, {*known, *others}))


def _taken(coordinate: xr.DataArray, condition: Any, factor: Fraction | None) -> Indexer:
    """Return what a condition takes along the dimension of a coordinate; of a single value, whether it takes it."""
    values, text = np.atleast_1d(coordinate.values), condition.strip() if isinstance(condition, str) else None
    if text is not None and text.startswith(NUMBER_SIGN):
        if not coordinate.dims:
            raise InputError("is one value for all designs, which has no numbers", remedy="select by values")
        return _by_number(text[1:], values.size)
    if values.dtype.kind not in "iufb":
        if text is None:
            raise InputError(f"is {short_repr(condition)}", remedy="write one of its texts")
        return np.flatnonzero(values.astype(str) == text)
    given = form_of(condition, FORMS)
    limits = given if isinstance(given, Range) else Range(given, given)
    limits = in_units(coordinate, limits, "select", factor)
    slack = SLACK * max(map(abs, limits.ends), default=0.0)
    if isinstance(given, Range):
        return np.flatnonzero(limits.holds(values, slack))
    form, is_axis = limits.low, coordinate.name in coordinate.dims
    if is_axis and values.dtype.kind == "f" and is_scale(values):
        place = nearest(values, form, slack)
        if place is None:
            return range(0)
        if abs(values[place] - form) > slack:
            near = short_number(float(values[place]))
            what = f"{short_number(form)} is not among the values: the nearest, {near}, is taken"
            remark(what, ("select", str(coordinate.name)))
        return place
    found = np.flatnonzero(abs(values - form) <= slack)
    return int(found[0]) if is_axis and found.size == 1 else found


def form_of(condition: Any, remedy: Remedy) -> Range | float:
    """Return a condition as a range or as a value: ``(lo, hi)``, ``"lo:hi"``, ``"lo:"``, a number or its text."""
    if isinstance(condition, str):
        if TO not in condition:
            return _number(condition, remedy)
        ends = [_number(end, remedy, none) for end, none in zip(condition.split(TO, 1), ENDLESS, strict=True)]
    elif isinstance(condition, (tuple, list)) and len(condition) == 2:
        pairs = zip(condition, ENDLESS, strict=True)
        ends = [none if end is None else _real(end, condition, remedy) for end, none in pairs]
    else:
        return _real(condition, condition, remedy)
    if ends[0] > ends[1]:
        what = f"runs from {ends[0]:g} down to {ends[1]:g}"
        raise InputError(what, remedy="write the lesser end first")
    return Range(*ends)


def _real(value: Any, condition: Any, remedy: Remedy) -> float:
    if (number := as_real(value)) is not None:
        return number
    raise InputError(f"is {short_repr(condition)}", remedy=remedy)


def _number(text: str, remedy: Remedy, default: float | None = None) -> float:
    """Return the number that a text says; an end may be left out."""
    if not text.strip() and default is not None:
        return default
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if math.isnan(number):
        raise InputError(f"{short_repr(text)} is not a number", remedy=remedy)
    return number


def _by_number(text: str, size: int) -> Indexer:
    """Return the numbers of values that a text after ``#`` says, as Python counts."""
    try:
        parts = [int(part) if part.strip() else None for part in text.split(TO)]
    except ValueError:
        parts = []
    if len(parts) == 1 and parts[0] is not None:
        if not -size <= parts[0] < size:
            what = f"'#{parts[0]}' is beyond the {size} values"
            raise InputError(what, remedy=f"write #0 to #{size - 1}")
        return parts[0] % size
    if len(parts) not in (2, 3) or (len(parts) == 3 and parts[2] is not None and parts[2] < 1):
        remedy = "write such as #3, #0:10 (without the tenth) or #::4, counted from 0"
        raise InputError(f"'#{text}' is not a number of a value", remedy=remedy)
    return range(size)[slice(*parts)]


def _span(coordinate: xr.DataArray) -> str:
    """Return what values a coordinate has, for a message."""
    values, name = np.atleast_1d(coordinate.values), coordinate.name
    if values.dtype.kind in "iuf" and values.size >= 4:
        units = coordinate.attrs.get("units", "1")
        return f"{name} runs from {values.min():g} to {values.max():g}{'' if units == '1' else f' {units}'}"
    shown = (f"{one:g}" if values.dtype.kind in "iuf" else short_repr(str(one)) for one in values[:4])
    return f"{name} is {', '.join(shown)}{', ...' if values.size > 4 else ''}"


def _text(condition: Any) -> str:
    """Return a condition as on the command line."""
    if isinstance(condition, (tuple, list)):
        return TO.join("" if end is None else f"{end!s}" for end in condition)
    return str(condition).strip()
