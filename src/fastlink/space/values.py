"""Check the values that are given for inputs."""

from __future__ import annotations

import math
import numbers
import reprlib
from decimal import Decimal
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fastlink._text import counted
from fastlink.errors import InputError, KeyPath

Floats = NDArray[np.float64]
NUMBERS = "write a number or a flat list of numbers"


def short_repr(value: object) -> str:
    """Return the repr of a value for a message: short and on one line."""
    return " ".join(reprlib.repr(value).split())


def numbers_of(where: str, name: str, given: Any) -> Floats:
    """Return the values given for an input as a new 0-d or 1-D array, or refuse them."""
    if isinstance(given, np.ma.MaskedArray) and given.dtype.kind in "iuf":
        given = np.ma.filled(given.astype(np.float64), np.nan)
    try:
        values = np.asarray(given)
    except ValueError:  # nested lists of unequal length
        raise InputError("is a ragged list", where=(where, name), remedy=NUMBERS) from None
    if values.ndim > 1:
        raise InputError(f"has {values.ndim} dimensions", where=(where, name), remedy=NUMBERS)
    if values.dtype.kind in "mM":
        raise InputError("holds dates or durations", where=(where, name), remedy="write numbers")
    if values.dtype.kind not in "iuf":
        _refuse_non_numbers(where, name, given)
    try:
        return values.astype(np.float64)
    except OverflowError:
        what = "holds a number beyond the range of a double"
        raise InputError(what, where=(where, name), remedy="write a smaller one") from None


def _refuse_non_numbers(where: str, name: str, given: Any) -> None:
    cells = np.asarray(given, dtype=object)
    if cells.ndim == 0 and not _is_number(cells[()]):
        raise InputError(f"is {short_repr(cells[()])}, not a number", where=(where, name), remedy=NUMBERS)
    for index, cell in enumerate(cells.ravel()):
        if not _is_number(cell):
            what = f"is {short_repr(cell)}, not a number"
            raise InputError(what, where=(where, name, index), remedy="write a number")


def _is_number(cell: object) -> bool:
    return isinstance(cell, (numbers.Real, Decimal)) and not isinstance(cell, bool)


def constant(where: str, name: str, given: Any) -> float:
    """Return the number given for one input, or refuse it."""
    value = numbers_of(where, name, given)
    if value.ndim:
        raise InputError(
            f"holds {counted(len(value), 'value')}", where=(where, name), remedy="write one number"
        )
    if not np.isfinite(value):
        raise InputError(f"is {value}", where=(where, name), remedy="write a finite number")
    return float(value)


def check_whole(
    where: KeyPath, value: Any, least: int, most: float = math.inf, remedy: str | None = None
) -> int:
    """Return a whole number from `least` to `most`, or refuse the value."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or not least <= value <= most:
        remedy = remedy or f"write a whole number of at least {least}"
        raise InputError(f"is {short_repr(value)}", where=where, remedy=remedy)
    return int(value)


def first_invalid(values: Floats) -> int | None:
    """Return the index of the first value that is NaN or infinite."""
    bad = np.flatnonzero(~np.isfinite(values))
    return int(bad[0]) if bad.size else None


def frozen(values: Floats) -> Floats:
    """Return the array itself, made read-only."""
    values.setflags(write=False)
    return values
