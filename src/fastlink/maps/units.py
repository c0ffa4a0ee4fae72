"""Units of maps, the codes of their flags, and infinite values."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import cache
from typing import Any, TypeVar

import numpy as np
import xarray as xr

from fastlink._text import short_repr
from fastlink.errors import InputError, KeyPath, check_choice, require_package, suggest
from fastlink.space.units import factor_of, is_unit, scaled

# -- Convert the units of maps: by the table of units, others by pint


RADIAN, DEGREE = "rad", "degree"  # in the spelling of CF
#: What is in no unit, or makes a sum of pint's that may take for ever, such as m**9**9**9.
ENDLESS = re.compile(r"[()\x00-\x1f]|\d{4}|(\*\*|\^)[^*^/ ]*(\*\*|\^)|.{80}", re.DOTALL)
POWER = re.compile(r"(?<=[A-Za-z])(-?\d+)")

T = TypeVar("T", xr.Dataset, xr.DataArray)


def units_of(maps: xr.Dataset) -> dict[str, str]:
    """Return the units of each variable and coordinate that has any; ``1`` for pure numbers."""
    return {str(name): str(of.attrs["units"]) for name, of in maps.variables.items() if "units" in of.attrs}


def check_units(array: Any, units: str, where: KeyPath) -> None:
    """Refuse a variable that says it is in other units than those that a formula takes."""
    own = getattr(array, "attrs", {}).get("units", units)
    if own != units:
        remedy = f"give the map as it was before it was converted, in {units}"
        raise InputError(f"is in {short_repr(own)}", where, remedy)


def half_turn(units: object) -> float | None:
    """Return 180 degrees in units of an angle, or None for other units."""
    return {RADIAN: float(np.pi), DEGREE: 180.0}.get(str(units))


def degrees(maps: T) -> T:
    """Return a copy whose angles in radians, coordinates too, are in degrees; rates stay as they are."""
    result = degrees_along(maps)
    if isinstance(result, xr.DataArray):
        return _scaled(result, np.rad2deg, DEGREE) if _is_angle(result) else result
    return result.assign(_in_degrees(result.data_vars))


def degrees_along(maps: T) -> T:
    """Return a copy whose coordinates in radians are in degrees."""
    return _along(maps, _in_degrees(maps.coords))


def _in_degrees(arrays: Mapping[Any, xr.DataArray]) -> dict[Any, xr.Variable]:
    """Return those of some variables that are angles in radians, in degrees."""
    angles = {name: array for name, array in arrays.items() if _is_angle(array)}
    return {name: _scaled(array, np.rad2deg, DEGREE).variable for name, array in angles.items()}


def convert(maps: xr.Dataset, of_all: Sequence[Any], given: dict[str, Any]) -> xr.Dataset:
    """Return a copy in other units: with all variables and coordinates of a kind in one of it, others by name."""
    known, found = units_of(maps), dict[str, Any]()
    for unit in of_all:
        alike = [name for name, own in known.items() if isinstance(unit, str) and factor_of(unit, own)]
        for name in alike:
            if name in found:
                what = f"{found[name]!r} and {unit!r} are of one kind"
                raise InputError(what, ("units",), "write one of them")
            found[name] = unit
        if not alike:
            what = f"{short_repr(unit)} is a unit of nothing in the map"
            names = ", ".join(dict.fromkeys(known.values()))
            raise InputError(what, ("units",), f"write units of {names}, such as 'mm', or NAME='mile'")
    given = found | given
    for name in given:
        if name not in known:
            what = f"{name!r} is not a variable with units" if name in maps.variables else "is unknown"
            raise InputError(what, (name,), suggest(name, known))
    changed = {name: converted(maps[name], units, name) for name, units in given.items()}
    along = {name: array.variable for name, array in changed.items() if name in maps.coords}
    results = {name: array.variable for name, array in changed.items() if name not in along}
    return _along(maps.assign(results), along)


def converted(array: xr.DataArray, units: Any, name: str = "units") -> xr.DataArray:
    """Return a copy of a variable in other units."""
    own = array.attrs.get("units")
    if own is None or array.dtype.kind not in "iuf":
        what = f"{array.name!r} has no units to convert"
        raise InputError(what, (name,), "give numbers with the attribute 'units'")
    if isinstance(units, str) and (unit := factor_of(units, str(own))) is not None:
        return _scaled(array, lambda values: _multiple(values, 1 / unit), units)
    factor = _factor(str(own), units, name)
    return _scaled(array, lambda values: values * factor, units)


def _multiple(values: Any, factor: Fraction) -> Any:
    """Return a multiple of values, each rounded once; chunks of dask stay chunks."""
    if hasattr(values, "map_blocks"):
        return values.map_blocks(_multiple, factor, dtype=values.dtype)
    return scaled(values, factor).astype(values.dtype if values.dtype.kind == "f" else np.float64)


def _along(maps: T, changed: dict[Any, xr.Variable]) -> T:
    """Return a copy with other coordinates; those of a stacked dimension are bound together."""
    for name in changed:
        index = maps.indexes.get(name)
        if index is not None and index.nlevels + (name not in maps.dims) > 1:
            raise InputError("is of a stacked dimension", (str(name),), "unstack the map first")
    return maps.assign_coords(changed)


def _is_angle(array: xr.DataArray) -> bool:
    return bool(array.attrs.get("units") == RADIAN and array.dtype.kind == "f")


def _scaled(array: xr.DataArray, law: Callable[[Any], Any], units: str) -> xr.DataArray:
    """Return a copy with other values and units; chunks of dask stay chunks."""
    result = array.copy(data=law(array.data))
    result.attrs["units"] = units
    return result


@cache
def _registry() -> Any:
    require_package("pint", ("convert",))
    import pint

    return pint.UnitRegistry()


def _parsed(text: Any, name: str) -> Any:
    """Return pint's unit of a text: ``rad s-1`` as CF writes it, or ``rad/s``."""
    registry = _registry()
    try:
        if not isinstance(text, str) or not text.strip() or not text.isprintable() or ENDLESS.search(text):
            raise ValueError("not a unit")
        return registry.parse_units(POWER.sub(r"**\1", text) if text.strip() != "1" else "")
    except Exception as error:  # pint's parser raises whatever its tokens run into
        what = f"{short_repr(text)} is not a unit"
        raise InputError(what, (name,), "write such as 'rpm', 'degree' or 'N mm'") from error


def _factor(own: str, units: Any, name: str) -> float:
    """Return the factor from one unit to another of the same kind: 1 rad/s is not 1 Hz, though both are 1/s to pint."""
    same, roots = False, list[Any]()
    if not (is_unit(own) and is_unit(units)):
        roots = [_registry().get_root_units(_parsed(unit, name)) for unit in (own, units)]
        same = dict(roots[0][1]._units) == dict(roots[1][1]._units)
    if not same:
        what = f"{short_repr(units)} is not of the kind of {own!r}"
        similar = ", ".join(sorted(map(repr, _EXAMPLES.get(own, (own,)))))
        raise InputError(what, (name,), f"write such as {similar}")
    return float(roots[0][0] / roots[1][0])


_EXAMPLES = {
    "rad s-1": ("rpm", "degree/s"),
    "rad": ("degree", "turn"),
    "m": ("mm", "inch"),
    "N": ("kN", "lbf"),
    "N m": ("N mm", "lbf ft"),
    "W": ("kW",),
    "kg": ("g", "lb"),
}


# -- Read the codes of a variable by CF's attributes ``flag_values`` and ``flag_meanings``


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


def check_flags(array: xr.DataArray, where: KeyPath, meanings: Sequence[Any]) -> list[int]:
    """Return the codes of some meanings of a variable, of which spaces may stand for underscores, or refuse them."""
    flags = flags_of(array)
    if not flags:
        what = f"{array.name!r} has no codes with meanings"
        raise InputError(what, where, "give a variable with flag_values and flag_meanings")
    if array.dtype.kind not in "iu":
        what = f"{array.name!r} holds values that are not codes"
        raise InputError(what, where, "make masks before averaging, and before masking codes")
    if not meanings:
        raise InputError("is empty", where, f"write one of {', '.join(flags)}")
    spelt = [one.strip().replace(" ", "_") if isinstance(one, str) else one for one in meanings]
    names = [name if name in flags else one for name, one in zip(spelt, meanings, strict=True)]
    return [flags[check_choice(where, one, list(flags), f" to {array.name}")] for one in names]


def has_flag(array: xr.DataArray, codes: Sequence[int]) -> xr.DataArray:
    """Return where a variable has one of some codes, as a mask without attributes of its own."""
    mask = array.isin(codes)
    mask.attrs = {}
    return mask


def flag_counts(array: xr.DataArray) -> dict[str, int] | None:
    """Return how many values have each meaning, None where they are no codes, as averages are not even if whole."""
    flags = flags_of(array)
    if not flags or array.dtype.kind not in "iu":
        return None
    values, counts = np.unique(array.values, return_counts=True)
    by_code = dict(zip(values.tolist(), counts.tolist(), strict=True))
    return {meaning: int(by_code.get(code, 0)) for meaning, code in flags.items()}


# -- Replace infinite values of maps by NaN, which plots and statistics leave out


REPLACED = "infinite_values"  # attribute: how many infinite values a variable had


def finite(array: xr.DataArray) -> xr.DataArray:
    """Return a variable with NaN in place of infinite values, and their number as an attribute."""
    if array.dtype.kind != "f":
        return array
    if array.chunks is not None:
        return array.where(~np.isinf(array))
    infinite = np.isinf(array.values)
    count = int(np.count_nonzero(infinite))
    if not count:
        return array
    result = array.copy(data=np.where(infinite, np.nan, array.values).astype(array.dtype))
    result.attrs[REPLACED] = count + int(array.attrs.get(REPLACED, 0))
    return result
