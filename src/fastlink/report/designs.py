"""List designs that were selected from a map, a row each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from fastlink._text import aligned, short_number
from fastlink.maps.best import GAIN, REFINEMENT, STARTS
from fastlink.maps.flags import flags_of
from fastlink.maps.units import degrees as in_degrees
from fastlink.space.degrees import angle_of
from fastlink.space.design_space import DESIGN

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["listed", "refinement_columns"]

#: Rows of a list that are shown.
MOST_ROWS = 100


def listed(found: xr.Dataset, names: Sequence[str], *, degrees: bool = False) -> str:
    """Return designs as a table of their inputs and of some variables, below how they were selected.

    Parameters
    ----------
    found : xarray.Dataset
        Of `fastlink.best`, in memory.
    names : sequence of str
        The variables to show; one that ends in ``_deg`` is that of the angle.
    degrees : bool, default False
        Show angles in degrees.
    """
    about = str(found.attrs.get("selection", ""))
    maps = in_degrees(found) if degrees else found
    along = [(str(name), array) for name, array in maps.coords.items() if array.dims == (DESIGN,)]
    inputs = [name for name, array in along if array.dtype.kind in "iuf"]
    texts = [name for name, array in along if name not in inputs]
    shown = [name if name in maps.variables else angle_of(name) for name in names]
    columns = [
        _column(maps[name])
        for name in dict.fromkeys([*inputs, *shown, *texts])
        if maps[name].dims == (DESIGN,)
    ]
    rows = list(zip(*columns, strict=True))
    hidden = len(rows) - 2 - MOST_ROWS
    more = f"\n... and {hidden:,} more" if hidden > 0 else ""
    same = [maps[name] for name in maps.coords if not maps[name].dims and "units" in maps[name].attrs]
    constants = ", ".join(
        f"{array.name} = {short_number(array.item())}{_units(array, ' ')}" for array in same
    )
    below = f"\nthe same for all: {constants}" if constants else ""
    return f"{about}\n{aligned(rows[: 2 + MOST_ROWS], right=0)}{more}{below}"


def refinement_columns(found: xr.Dataset) -> list[str]:
    """Return the columns that a refinement has added: what was gained, how it ended, from how many starts."""
    names = [str(name) for name in found.data_vars]
    return [
        *(name for name in names if name.endswith(f"_{GAIN}")),
        *(name for name in names if name in (REFINEMENT, STARTS)),
    ]


def _column(array: xr.DataArray) -> list[str]:
    """Return name, units and values of a variable."""
    meanings = {code: meaning for meaning, code in flags_of(array).items()}
    values: list[Any] = array.values.tolist()
    return [
        str(array.name),
        _units(array),
        *(str(meanings.get(v, short_number(v))) for v in values),
    ]


def _units(array: xr.DataArray, before: str = "") -> str:
    units = str(array.attrs.get("units", "1"))
    return "" if units == "1" else before + units
