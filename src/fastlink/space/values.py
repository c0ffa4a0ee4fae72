"""Check the values that are given for inputs."""

from __future__ import annotations

import math
import numbers
import reprlib
import sys
from decimal import Decimal
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fastlink._text import counted
from fastlink.errors import InputError, KeyPath

Floats = NDArray[np.float64]
NUMBERS = "write a number or a flat list of numbers"
#: Most values of a list or range: 10^8 take 10 s and 0.8 GB to read.
MOST_LISTED = 10**8
#: Most axes of an array of NumPy.
MOST_DIMS = 64


def short_repr(value: object) -> str:
    """Return the repr of a value for a message: short and on one line."""
    try:
        return " ".join(reprlib.repr(value).split())
    except ValueError:  # a whole number of more digits than Python writes
        return f"a {type(value).__name__} of too many digits"


def numbers_of(where: str, name: str, given: Any, most_dims: int = 1) -> Floats:
    """Return the values given for an input as a new array of at most so many dimensions, or refuse them."""
    path = (where, name)
    if isinstance(given, np.ma.MaskedArray):
        given = unmasked(given)
    if not hasattr(given, "dtype") and listed(given) > MOST_LISTED:
        what = f"holds {counted(listed(given), 'value')}"
        raise InputError(what, where=path, remedy=f"write at most {MOST_LISTED}")
    try:
        values = np.asarray(given)
    except ValueError:  # nested lists of unequal length
        raise InputError("is a ragged list", where=path, remedy=NUMBERS) from None
    except Exception:  # whatever a class of somebody's does when it is converted
        raise InputError(f"is {short_repr(given)}, not a number", where=path, remedy=NUMBERS) from None
    if values.ndim > most_dims:
        raise InputError(f"has {values.ndim} dimensions", where=path, remedy=NUMBERS)
    if values.dtype.kind in "mM":
        raise InputError("holds dates or durations", where=path, remedy="write numbers")
    if values.dtype.kind not in "iuf":
        _refuse_non_numbers(where, name, given)
    try:
        return values.astype(np.float64)
    except (OverflowError, ValueError):  # Decimal("sNaN") is a ValueError
        what = "holds a number beyond the range of a double"
        raise InputError(what, where=path, remedy="write a smaller one") from None


def unmasked(given: np.ma.MaskedArray[Any, Any]) -> NDArray[Any]:
    """Return an array with NaN in place of what is masked."""
    cells: Any = given.astype(np.float64 if given.dtype.kind in "iuf" else object)
    return np.asarray(cells.filled(np.nan))


def cells_of(given: Any) -> NDArray[Any]:
    """Return the elements of an array in its own type, those of a list as objects; all that is neither as one."""
    try:
        return np.asarray(given, dtype=None if hasattr(given, "dtype") else object)
    except Exception:  # whatever a class of somebody's does when it is converted
        cell = np.empty((), dtype=object)
        cell[()] = given
        return cell


def listed(given: Any) -> int:
    """Return the number of elements of a list or the like, 0 of what has none."""
    try:
        return len(given)
    except OverflowError:  # range(10**30)
        return sys.maxsize
    except Exception:  # whatever a class of somebody's does
        return 0


def _refuse_non_numbers(where: str, name: str, given: Any) -> None:
    cells = np.asarray(given, dtype=object)
    if cells.ndim == 0 and not is_number(cells[()]):
        raise InputError(f"is {short_repr(cells[()])}, not a number", where=(where, name), remedy=NUMBERS)
    for index, cell in np.ndenumerate(cells):
        if not is_number(cell):
            what = f"is {short_repr(cell)}, not a number"
            raise InputError(what, where=(where, name, *index), remedy="write a number")


def is_number(cell: object) -> bool:
    """Tell whether an object is a real number; True and False are not."""
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
