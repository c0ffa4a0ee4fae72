"""Select a part of a map by values, or by numbers, along its dimensions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from fastlink._text import short_number, short_repr
from fastlink.errors import InputError, Problems, Setting, remark, suggest
from fastlink.space.degrees import RADIANS, angle_of, check_angle, degrees_name, radians, remark_on_angles
from fastlink.space.values import as_real

__all__ = ["Indexer", "Selection", "selected"]

#: What is taken along a dimension: one number, which the result has no dimension for, or several.
Indexer = int | slice | NDArray[np.intp]
#: A value counts as an end of a range if it differs by four roundings: 1.1 + 0.1 is more than 1.2.
SLACK = 4 * 2.0**-52
NUMBER_SIGN, TO = "#", ":"
FORMS = (
    "write ",
    Setting("select", {"a2": "1.1:1.2"}),
    " for a range, a number for the nearest value, or '#3' or '#0:10' for numbers of values",
)


@dataclass
class Selection:
    """The conditions on what is taken of a map, and what meets them.

    Attributes
    ----------
    indexers : dict of str to Indexer
        What is taken along each dimension that is not taken whole.
    texts : list of str
        Each condition, such as ``a2=1.1:1.2``.
    """

    indexers: dict[str, Indexer] = field(default_factory=dict)
    texts: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        return "; ".join(self.texts)

    def add(self, dim: str, indexer: Indexer) -> None:
        """Take less along a dimension; both conditions have to hold."""
        if dim in self.indexers:
            indexer = np.intersect1d(_numbers(self.indexers[dim]), _numbers(indexer))
        self.indexers[dim] = _simple(indexer)


@dataclass(frozen=True)
class _Numbers:
    """Numbers of values along a dimension: one, or a slice of them."""

    value: int | slice


@dataclass(frozen=True)
class _Ends:
    """A range of values, both ends included."""

    low: float
    high: float


def selected(maps: xr.Dataset, given: Any) -> Selection:
    """Return what conditions take of a map, or refuse them.

    Parameters
    ----------
    maps : xarray.Dataset
        The map.
    given : mapping or None
        Conditions by the names of dimensions and coordinates: text as ``"1.1:1.2"``, ``"0.5"``, ``"#3"`` or
        ``"#0:10"``, a number, or a pair of ends, where None is no end. Angles in degrees by names that end in ``_deg``.

    Raises
    ------
    InputError
        A name is unknown, a condition cannot be read, or nothing meets it.

    Examples
    --------
    >>> maps = xr.Dataset(coords={"a2": [1.0, 1.1, 1.2, 1.3]})
    >>> selected(maps, {"a2": "1.1:1.2"})
    Selection(indexers={'a2': slice(1, 3, None)}, texts=['a2=1.1:1.2'])
    """
    selection, problems = Selection(), Problems()
    if given is None:
        return selection
    if not isinstance(given, Mapping):
        raise InputError(f"is {short_repr(given)}", where=("select",), remedy=FORMS)
    for name, condition in given.items():
        with problems.at("select", str(name)):
            _add(selection, maps, name, condition)
    problems.stop()
    for dim, indexer in selection.indexers.items():
        if not isinstance(indexer, int) and not _numbers(indexer).size:
            what = f"no value along {dim} meets {selection}"
            raise InputError(what, where=("select",), remedy="leave one of the conditions out")
    return selection


def _add(selection: Selection, maps: xr.Dataset, name: Any, condition: Any) -> None:
    """Add one condition to a selection."""
    coordinate, in_degrees = _coordinate(maps, name)
    dim = str(coordinate.dims[0]) if coordinate.dims else ""
    form = _form(name, condition, coordinate)
    if isinstance(form, _Numbers):
        if not dim:
            raise InputError("is one value for all designs, which has no numbers", remedy="select by values")
        taken: Indexer = _by_number(form.value, coordinate.size)
    elif isinstance(form, str):
        taken = np.flatnonzero(coordinate.values.astype(str).reshape(-1) == form)
    else:
        form = _in_radians(form) if in_degrees else form
        if coordinate.attrs.get("units") == RADIANS and not in_degrees:
            numbers = [form.low, form.high] if isinstance(form, _Ends) else form
            remark_on_angles(str(coordinate.name), numbers, "select")
        taken = _by_value(coordinate, form, is_axis=coordinate.name == dim)
    if isinstance(taken, np.ndarray) and not taken.size:
        raise InputError(f"{_text(condition)} takes nothing; {_span(coordinate)}", remedy="widen it")
    if dim:
        selection.add(dim, taken)
    selection.texts.append(f"{name}={_text(condition)}")


def _coordinate(maps: xr.Dataset, name: Any) -> tuple[xr.DataArray, bool]:
    """Return the coordinate of a condition, and whether its values are in degrees."""
    known = {str(key): coord for key, coord in maps.coords.items() if coord.ndim < 2}
    known |= {
        str(dim): xr.DataArray(np.arange(size), dims=str(dim), name=str(dim))
        for dim, size in maps.sizes.items()
        if str(dim) not in known
    }
    if name in known:
        return known[name], False
    angle = angle_of(name) if isinstance(name, str) else ""
    if angle in known:
        check_angle(str(name), angle, str(known[angle].attrs.get("units", "1")), ())
        return known[angle], True
    if name in maps.data_vars:
        what, remedy = "is a result, which has no dimension of its own", f"select by {', '.join(known)}"
        raise InputError(what, remedy=remedy)
    angles = [degrees_name(key) for key, one in known.items() if one.attrs.get("units") == RADIANS]
    raise InputError("is no dimension and no coordinate of the map", remedy=suggest(name, [*known, *angles]))


def _form(name: Any, condition: Any, coordinate: xr.DataArray) -> _Numbers | _Ends | float | str:
    """Return a condition as numbers of values, ends of a range, a value, or a text to be met."""
    is_text = coordinate.dtype.kind not in "iufb"
    if isinstance(condition, str):
        text = condition.strip()
        if text.startswith(NUMBER_SIGN):
            return _Numbers(_slice(text[1:]))
        if is_text:
            return text
        if TO in text:
            low, _, high = text.partition(TO)
            return _ends(_number(low, -math.inf), _number(high, math.inf))
        return _number(text, None)
    if is_text:
        raise InputError(f"is {short_repr(condition)}", remedy="write one of its texts")
    if isinstance(condition, (tuple, list)) and len(condition) == 2:
        low, high = condition
        return _ends(
            -math.inf if low is None else _real(low, condition),
            math.inf if high is None else _real(high, condition),
        )
    return _real(condition, condition)


def _real(value: Any, condition: Any) -> float:
    if (number := as_real(value)) is not None:
        return number
    raise InputError(f"is {short_repr(condition)}", remedy=FORMS)


def _number(text: str, default: float | None) -> float:
    """Return the number that a text says; an end may be left out."""
    if not text.strip() and default is not None:
        return default
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if math.isnan(number):
        raise InputError(f"{short_repr(text)} is not a number", remedy=FORMS)
    return number


def _ends(low: float, high: float) -> _Ends:
    if low > high:
        raise InputError(f"runs from {low:g} down to {high:g}", remedy="write the lesser end first")
    return _Ends(low, high)


def _slice(text: str) -> int | slice:
    """Return the numbers of values that a text after ``#`` says, as Python counts."""
    try:
        parts = [int(part) if part.strip() else None for part in text.split(TO)]
    except ValueError:
        parts = []
    if len(parts) == 1 and parts[0] is not None:
        return parts[0]
    if len(parts) not in (2, 3) or (len(parts) == 3 and parts[2] is not None and parts[2] < 1):
        remedy = "write such as #3, #0:10 (without the tenth) or #::4, counted from 0"
        raise InputError(f"'#{text}' is not a number of a value", remedy=remedy)
    return slice(*parts)


def _in_radians(form: _Ends | float) -> _Ends | float:
    if isinstance(form, _Ends):
        return _Ends(float(radians(form.low)), float(radians(form.high)))
    return float(radians(form))


def _by_number(numbers: int | slice, size: int) -> Indexer:
    if isinstance(numbers, int):
        if not -size <= numbers < size:
            what = f"'#{numbers}' is beyond the {size} values"
            raise InputError(what, remedy=f"write #0 to #{size - 1}")
        return numbers % size
    return np.arange(size)[numbers]


def _by_value(coordinate: xr.DataArray, form: _Ends | float, *, is_axis: bool) -> Indexer:
    """Return what a range, or a value, takes: of an axis of floats, a value takes the nearest."""
    values = np.atleast_1d(coordinate.values)
    if isinstance(form, _Ends):
        slack = SLACK * max((abs(end) for end in (form.low, form.high) if math.isfinite(end)), default=0.0)
        return np.flatnonzero((values >= form.low - slack) & (values <= form.high + slack))
    if values.dtype.kind == "f" and is_axis and np.isfinite(values).all():
        nearest = int(np.argmin(abs(values - form)))
        off, near = abs(values[nearest] - form), float(values[nearest])
        slack = SLACK * abs(form)
        if not values.min() - slack <= form <= values.max() + slack:
            return np.empty(0, dtype=np.intp)
        if off > slack:
            remark(
                f"{short_number(form)} is not among the values: the nearest, {short_number(near)}, is taken",
                ("select", str(coordinate.name)),
            )
        return nearest
    found = np.flatnonzero(abs(values - form) <= SLACK * abs(form))
    return int(found[0]) if is_axis and found.size == 1 else found


def _span(coordinate: xr.DataArray) -> str:
    """Return what values a coordinate has, for a message."""
    values = np.atleast_1d(coordinate.values)
    name = coordinate.name
    if values.dtype.kind not in "iuf" or values.size < 4:
        shown = ", ".join(
            short_repr(str(v)) if values.dtype.kind not in "iuf" else f"{v:g}" for v in values[:4]
        )
        return f"{name} is {shown}{', ...' if values.size > 4 else ''}"
    units = coordinate.attrs.get("units", "1")
    return f"{name} runs from {values.min():g} to {values.max():g}{'' if units == '1' else f' {units}'}"


def _text(condition: Any) -> str:
    """Return a condition as on the command line."""
    if isinstance(condition, (tuple, list)):
        return TO.join("" if end is None else f"{end!s}" for end in condition)
    return str(condition).strip()


def _numbers(indexer: Indexer) -> NDArray[np.intp]:
    if isinstance(indexer, np.ndarray):
        return indexer
    if isinstance(indexer, slice):
        return np.arange(indexer.start, indexer.stop)
    return np.array([indexer])


def _simple(indexer: Indexer) -> Indexer:
    """Return consecutive numbers as a slice, which is read at once."""
    if isinstance(indexer, np.ndarray) and indexer.size and indexer[-1] - indexer[0] == indexer.size - 1:
        return slice(int(indexer[0]), int(indexer[-1]) + 1)
    return indexer
