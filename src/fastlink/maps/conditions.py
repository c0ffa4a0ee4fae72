"""Conditions on the rows of a map: masks, meanings of a code, ranges of values."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import short_number, short_repr
from fastlink.errors import InputError, Pair, Problems
from fastlink.maps.flags import check_flags, flags_of
from fastlink.options import check_choice
from fastlink.space.dataset import STATUS
from fastlink.space.degrees import RADIANS, angle_of, check_angle, radians, remark_on_angles
from fastlink.space.values import as_real

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

__all__ = ["Condition", "check_along", "conditions"]


@dataclass(frozen=True)
class Condition:
    """A set of values that a variable must have in a row.

    Attributes
    ----------
    array : xarray.DataArray
        The variable.
    codes : tuple of int or None
        The codes that it may have.
    low, high : float
        Where there are no codes: the ends of its range, which belong to it.
    """

    array: xr.DataArray
    codes: tuple[int, ...] | None = None
    low: float = -math.inf
    high: float = math.inf

    def __str__(self) -> str:
        name = str(self.array.name)
        if self.codes is not None:
            meanings = [meaning for meaning, code in flags_of(self.array).items() if code in self.codes]
            return f"{name} is {' or '.join(meanings)}"
        ends = [(">=", self.low), ("<=", self.high)]
        limits = [f"{sign} {short_number(end)}" for sign, end in ends if math.isfinite(end)]
        return f"{name} {' and '.join(limits)}" if limits else name

    def holds(self, values: NDArray[Any]) -> NDArray[np.bool_]:
        """Return where values meet it; NaN never does."""
        if self.codes is not None:
            first, *others = self.codes  # a third of the time of numpy.isin
            found: NDArray[np.bool_] = values == first
            for code in others:
                found |= values == code
            return found
        if self.array.dtype.kind == "b":
            return np.asarray(values, dtype=bool)
        return (values >= self.low) & (values <= self.high)


def conditions(maps: xr.Dataset, where: Any) -> list[Condition]:
    """Return the conditions that a caller gives, or refuse them.

    Parameters
    ----------
    maps : xarray.Dataset
        The map.
    where : DataArray, str, list of str, mapping or None
        A mask; meanings of ``status``; or for each variable or input its least and greatest value, each None for no
        limit, or the meanings of a code.
    """
    if where is None:
        return []
    if isinstance(where, str) or (isinstance(where, (list, tuple)) and where):
        if STATUS not in maps:
            what = "the map has no variable 'status'"
            raise InputError(what, where=("where",), remedy="give a mask, such as maps.a1 < 0.5")
        return [_of_code(maps[STATUS], "where", where)]
    if isinstance(where, Mapping) and not hasattr(where, "data_vars"):
        problems, made = Problems(), list[Condition]()
        for name, given in where.items():
            with problems.at():
                made.append(_of_name(maps, name, given))
        problems.stop()
        return made
    if getattr(getattr(where, "dtype", None), "kind", "") != "b" or not hasattr(where, "dims"):
        remedy = (
            "write ranges such as {'a1': (None, 0.5)}, a meaning of status, or a mask such as maps.a1 < 0.5"
        )
        raise InputError(f"is {short_repr(where)}, not a mask", where=("where",), remedy=remedy)
    for dim, length in where.sizes.items():
        check_along(where.name, str(dim), length, maps.sizes)
    return [Condition(where)]


def check_along(name: Any, dim: str, length: int, sizes: Mapping[Any, int]) -> None:
    """Refuse a condition that does not have the rows of a map along a dimension."""
    if sizes.get(dim) != length:
        what = f"{name or 'the mask'} has {length} along {dim!r}, the rows have {sizes.get(dim, 'no such dimension')}"
        raise InputError(what, where=("where",), remedy="give a mask made from the same map")


def _of_code(array: xr.DataArray, where: str, meanings: Any) -> Condition:
    codes = check_flags(array, where, [meanings] if isinstance(meanings, str) else list(meanings))
    return Condition(array, tuple(codes))


def _of_name(maps: xr.Dataset, name: Any, given: Any) -> Condition:
    """Return the condition on one variable or input; the limits of an angle NAME in degrees as NAME_deg."""
    known = [str(one) for one, array in maps.variables.items() if array.dtype.kind in "iuf"]
    angle = angle_of(name) if isinstance(name, str) and name not in known else ""
    array = maps[angle if angle in known else check_choice(("where",), name, known)]
    if flags_of(array) and isinstance(given, (str, list, tuple)):
        return _of_code(array, name, given)
    where, remedy = ("where", name), ("write ", Pair(unlimited=True))
    if flags_of(array):
        what = f"{array.name} is a code, and given {short_repr(given)}"
        raise InputError(what, where=where, remedy=f"write one of its meanings, {', '.join(flags_of(array))}")
    if not isinstance(given, (list, tuple)) or len(given) != 2:
        raise InputError(f"is {short_repr(given)}", where=where, remedy=remedy)
    low, high = (_limit(name, *end) for end in zip(given, (-math.inf, math.inf), strict=True))
    if not low <= high:
        raise InputError(f"runs from {low:g} to {high:g}", where=where, remedy="exchange the ends")
    units = str(array.attrs.get("units", "1"))
    if angle:
        check_angle(name, angle, units, ())
        low, high = float(radians(low)), float(radians(high))
    elif units == RADIANS:
        remark_on_angles(name, [end for end in (low, high) if math.isfinite(end)], "where")
    return Condition(array, None, low, high)


def _limit(name: str, end: Any, otherwise: float) -> float:
    """Return one end of a range, or refuse it."""
    if end is None:
        return otherwise
    if (number := as_real(end)) is not None:
        return number
    what, remedy = f"ends at {short_repr(end)}", "write a number, or None for no limit"
    raise InputError(what, where=("where", name), remedy=remedy)
