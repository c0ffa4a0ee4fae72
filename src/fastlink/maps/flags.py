"""Read the codes of a variable by CF's attributes ``flag_values`` and ``flag_meanings``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.errors import InputError
from fastlink.options import check_choice

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["check_flags", "flag_counts", "flags_of", "has_flag"]


def flags_of(array: xr.DataArray) -> dict[str, int]:
    """Return the codes of a variable by their meanings; none where its attributes do not tell.

    Examples
    --------
    >>> import xarray as xr
    >>> flags_of(xr.DataArray([0, 1], attrs={"flag_values": [0, 1], "flag_meanings": "closes never_closes"}))
    {'closes': 0, 'never_closes': 1}
    """
    meanings = str(array.attrs.get("flag_meanings", "")).split()
    codes = np.atleast_1d(np.asarray(array.attrs.get("flag_values", ())))
    if codes.dtype.kind not in "iu" or codes.ndim != 1 or len(codes) != len(meanings):
        return {}
    return dict(zip(meanings, codes.tolist(), strict=True))


def check_flags(array: xr.DataArray, where: str, meanings: Sequence[Any]) -> list[int]:
    """Return the codes of some meanings of a variable, or refuse them.

    Spaces may stand for the underscores of a meaning.
    """
    flags = flags_of(array)
    if not flags:
        what = f"{array.name!r} has no codes with meanings"
        raise InputError(what, where=(where,), remedy="give a variable with flag_values and flag_meanings")
    if array.dtype.kind not in "iu":
        what = f"{array.name!r} holds values that are not codes"
        raise InputError(what, where=(where,), remedy="make masks before averaging, and before masking codes")
    if not meanings:
        raise InputError("is empty", where=("meanings",), remedy=f"write one of {', '.join(flags)}")
    spelt = [one.strip().replace(" ", "_") if isinstance(one, str) else one for one in meanings]
    return [flags[check_choice(("meanings",), one, list(flags), f" to {array.name}")] for one in spelt]


def has_flag(array: xr.DataArray, codes: Sequence[int]) -> xr.DataArray:
    """Return where a variable has one of some codes, as a mask without attributes of its own."""
    mask = array.isin(codes)
    mask.attrs = {}
    return mask


def flag_counts(array: xr.DataArray) -> dict[str, int] | None:
    """Return how many values have each meaning, or None where the values are not codes.

    An average of codes is not a code, even where it is a whole number.
    """
    flags = flags_of(array)
    if not flags or array.dtype.kind not in "iu":
        return None
    values, counts = np.unique(array.values, return_counts=True)
    by_code = dict(zip(values.tolist(), counts.tolist(), strict=True))
    return {meaning: int(by_code.get(code, 0)) for meaning, code in flags.items()}
