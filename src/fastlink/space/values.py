"""Check the values that are given for inputs."""

from __future__ import annotations

import math
import numbers
import sys
from collections.abc import Callable, Mapping
from decimal import Decimal
from typing import Any, SupportsFloat, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from fastlink._text import counted, short_repr
from fastlink.errors import InputError, KeyPath

T = TypeVar("T")
Floats = NDArray[np.float64]
NUMBERS = "write a number or a flat list of numbers"
#: Most values of a list or range: 10^8 take 10 s and 0.8 GB to read.
MOST_LISTED = 10**8
#: Most axes of an array of NumPy.
MOST_DIMS = 64
#: Packages whose objects are read by their own rules: an error inside is a defect, and shows.
OWN = ("builtins", "numpy", "pandas", "xarray")


def units_of(name: str, given: Any) -> dict[str, str]:
    """Return the unit that labelled values state in their attributes, by name; empty without one."""
    attrs = given.attrs if has(given, "dtype") and has(given, "attrs") else None
    unit = attrs.get("units") if isinstance(attrs, Mapping) else None
    return {} if unit is None else {name: str(unit)}


def check_no_quantity(where: str, name: str, given: Any) -> None:
    """Refuse values of a package for units, whose units a conversion to an array would drop in silence."""
    if type(given) in (float, int, np.ndarray):
        return
    try:
        unit = _unit_of_quantity(given)
    except Exception:  # whatever a class of somebody's does when it is asked
        return
    if unit is not None:
        remedy = "write plain numbers in SI units, angles in rad, such as by .m_as('m') or .to_value('m')"
        raise InputError(f"has the unit {short_repr(unit)}", where=(where, name), remedy=remedy)


def _unit_of_quantity(given: Any) -> Any:
    """Return the unit of a value of a package for units, of labelled ones or of a list of these; None without."""
    if hasattr(given, "dims"):  # a DataArray, whose data may have units
        given = given.data
    values = [given]
    if isinstance(given, (list, tuple)) and given and type(given[0]) is not float:
        values += (given[0], given[-1])
    for value in values:
        if hasattr(value, "magnitude") or hasattr(value, "to_value"):
            return getattr(value, "units", None) or getattr(value, "unit", None)
    return getattr(getattr(given, "dtype", None), "units", None)  # of pandas with a package for units


def numbers_of(where: str, name: str, given: Any, most_dims: int = 1) -> Floats:
    """Return the values given for an input as a new array of at most so many dimensions, or refuse them."""
    path = (where, name)
    if type(given) is float or (  # the most common ones, at once: a third of the time
        type(given) is np.ndarray and given.dtype == np.float64 and given.ndim <= most_dims
    ):
        return np.array(given)
    check_no_quantity(where, name, given)
    if isinstance(given, (bytes, bytearray, memoryview)):
        raise InputError(f"is {short_repr(given)}, not a number", where=path, remedy=NUMBERS)
    if isinstance(given, (list, tuple)) and not {bool, np.bool_}.isdisjoint(map(type, given)):
        _refuse_non_numbers(where, name, given)  # numpy takes True among numbers for 1
    if isinstance(given, np.ma.MaskedArray):
        given = unmasked(given)
    check_length(path, given)
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
        with np.errstate(over="raise"):  # a longer float than a double
            return values.astype(np.float64)
    except (OverflowError, ValueError, FloatingPointError):  # Decimal("sNaN") is a ValueError
        what = "holds a number beyond the range of a double"
        raise InputError(what, where=path, remedy="write a smaller one") from None


def check_length(where: KeyPath, given: Any, remedy: str = f"write at most {MOST_LISTED}") -> None:
    """Refuse a list or a range of more values than can be read in seconds."""
    if not has(given, "dtype") and listed(given) > MOST_LISTED:
        raise InputError(f"holds {counted(listed(given), 'value')}", where=where, remedy=remedy)


def has(value: Any, name: str) -> bool:
    """Tell whether an object has an attribute, whatever its class does when it is asked."""
    try:
        return hasattr(value, name)
    except Exception:
        return False


def read_or_none(read: Callable[..., T], source: Any, *args: Any, **options: Any) -> T | None:
    """Return what a function reads from an object, None where somebody's class fails when it is read.

    Examples
    --------
    >>> class Sulky:
    ...     def __len__(self):
    ...         raise RuntimeError
    >>> read_or_none(len, [1.0, 2.0]), read_or_none(len, Sulky())
    (2, None)
    """
    try:
        return read(source, *args, **options)
    except InputError:
        raise
    except Exception:  # whatever a class of somebody's does when it is asked
        if type(source).__module__.partition(".")[0] in OWN:
            raise
        return None


def unmasked(given: np.ma.MaskedArray[Any, Any]) -> NDArray[Any]:
    """Return an array with NaN in place of what is masked."""
    cells: Any = given.astype(np.float64 if given.dtype.kind in "iuf" else object)
    return np.asarray(cells.filled(np.nan))


def cells_of(given: Any) -> NDArray[Any]:
    """Return the elements of an array in its own type, those of a list as objects; all that is neither as one."""
    try:
        return np.asarray(given, dtype=None if has(given, "dtype") else object)
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


def check_input_name(where: str, name: str) -> None:
    """Refuse a name that no input can have."""
    if not (name.isascii() and name.isidentifier()):
        what, remedy = f"{short_repr(name)} is no name of an input", "name it by the input, such as a2"
        raise InputError(what, where=(where,), remedy=remedy)


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
    # to NumPy a duration is a kind of integer
    return isinstance(cell, (numbers.Real, Decimal)) and not isinstance(cell, (bool, np.timedelta64))


def as_real(value: object) -> float | None:
    """Return a real number as a float, and None of anything else: of NaN and of what is beyond doubles too."""
    if not is_number(value):
        return None
    try:
        number = float(cast(SupportsFloat, value))
    except (OverflowError, ValueError):  # Decimal("sNaN") is a ValueError
        return None
    return None if math.isnan(number) else number


def constant(where: str, name: str, given: Any) -> float:
    """Return the number given for one input, or refuse it."""
    values = numbers_of(where, name, given)
    if values.ndim:
        raise InputError(
            f"holds {counted(len(values), 'value')}", where=(where, name), remedy="write one number"
        )
    value = float(values)
    if not math.isfinite(value):
        raise InputError(f"is {value}", where=(where, name), remedy="write a finite number")
    return value


def axis_of(where: str, name: str, values: Floats) -> Floats:
    """Return the values of an axis, or refuse them: there is none, or one is not finite or repeated."""
    if values.size == 0:
        raise InputError("is an empty axis", where=(where, name), remedy="give it at least one value")
    bad = first_invalid(values)
    if bad is not None:
        raise InputError(f"is {values[bad]}", where=(where, name, bad), remedy="write a finite number")
    order = np.argsort(values, kind="stable")
    repeats = np.flatnonzero(np.diff(values[order]) == 0)
    if repeats.size:
        first, second = order[repeats[0]], order[repeats[0] + 1]
        what = f"holds {values[first]} twice (at {first} and {second})"
        raise InputError(what, where=(where, name), remedy="give each value once")
    return frozen(values)


def first_invalid(values: Floats) -> int | None:
    """Return the index of the first value that is NaN or infinite."""
    bad = np.flatnonzero(~np.isfinite(values))
    return int(bad[0]) if bad.size else None


def frozen(values: Floats) -> Floats:
    """Return the array itself, made read-only."""
    values.setflags(write=False)
    return values
