"""Check the global attributes that a caller adds to a map, before anything is computed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from fastlink._text import short_repr, unwritable
from fastlink.errors import InputError, KeyPath, Problems

__all__ = ["PLAIN", "check_attrs", "fault_of_value"]

#: Names that HDF5 and netCDF keep for themselves, besides those that begin with an underscore.
OF_FORMAT = ("CLASS", "DIMENSION_LIST", "NAME", "REFERENCE_LIST", "coordinates")
#: Bytes of a name: netCDF has room for 256, with a zero at the end.
LONGEST = 255
#: Whole numbers that HDF5 holds.
LEAST, GREATEST = -(2**63), 2**64 - 1
PLAIN = "write text, a number or a list of numbers"


def check_attrs(where: KeyPath, attrs: Any, reserved: Callable[[str], bool]) -> dict[str, Any]:
    """Return attributes that a file can hold under names that it does not use itself, or refuse them.

    Parameters
    ----------
    where : tuple
        The option.
    attrs : mapping of str to text, number or list of numbers
        The attributes.
    reserved : callable
        Tells whether the map itself has an attribute of a name.

    Examples
    --------
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
