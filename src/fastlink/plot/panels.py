"""The panels of a picture: assembly modes, and values of a dimension that stand side by side."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import short_number
from fastlink.maps.flags import flags_of
from fastlink.plot.labels import plain, units_text, valued
from fastlink.plot.selection import MOST_BESIDE, spread
from fastlink.space.design_space import BRANCH

if TYPE_CHECKING:
    import xarray as xr

    from fastlink.plot.selection import Selection

__all__ = ["Panel", "modes_of", "name_places", "panels_of", "sameness"]

MOST_NAMES = 24  # along one side
MOST_BELOW = 3  # panels side by side where those of another assembly mode stand below
#: Values that differ by less, relative to the greatest, are the same: several thousand roundings.
SAME = 1e-12


@dataclass(frozen=True)
class Panel:
    """One of the pictures, or lines, that stand side by side.

    Attributes
    ----------
    modes, value : str
        Which assembly modes these are, and which value of the dimension that is split; empty where there are no others.
    array : xarray.DataArray
        The values.
    place : int
        The place along the dimension that is split, 0 where there is none.
    """

    modes: str
    value: str
    array: xr.DataArray
    place: int = 0

    @property
    def title(self) -> str:
        """Return the text that tells it from the others."""
        return ", ".join(filter(None, (self.modes, self.value)))


def panels_of(shown: Selection) -> list[list[Panel]]:
    """Return rows of panels: assembly modes, those that agree in one row; in each row the values of a dimension."""
    if shown.split is None:
        return [[Panel(title, "", part) for title, part in _modes(shown.variable)]]
    along = shown.variable[shown.split]
    modes = _modes(shown.variable)
    alone = len(modes) == 1
    few = spread(along.size, MOST_BESIDE if alone or len(shown.free) == 1 else MOST_BELOW)
    titles = {int(k): valued(along, along.values[k]) for k in few}
    return [
        [Panel(mode * (not alone), title, part.isel({shown.split: k}), k) for k, title in titles.items()]
        for mode, part in modes
    ]


def modes_of(shown: Selection) -> str:
    """Return the assembly modes of all panels where they are of one row, and none says so."""
    modes = _modes(shown.variable)
    return modes[0][0] if shown.split is not None and len(modes) == 1 else ""


def _modes(variable: xr.DataArray) -> list[tuple[str, xr.DataArray]]:
    """Return title and values of each assembly mode, or of all if they agree."""
    numbers = np.atleast_1d(variable[BRANCH].values).tolist() if BRANCH in variable.coords else []
    if BRANCH not in variable.dims:
        return [(f"assembly mode {numbers[0]}" if numbers else "", variable)]
    count = variable.sizes[BRANCH]
    titles = [f"assembly mode {b}" for b in numbers] or [
        f"branch {k} of {count}" for k in range(1, count + 1)
    ]
    parts = [(title, variable.isel({BRANCH: k})) for k, title in enumerate(titles)]
    first = parts[0][1].values
    alike = all(np.allclose(part.values, first, rtol=1e-9, atol=0.0, equal_nan=True) for _, part in parts)
    if alike and len(parts) > 1 and numbers:
        return [(f"assembly modes {' and '.join(map(str, numbers))} (they agree)", parts[0][1])]
    return parts


def sameness(variable: xr.DataArray, values: Any) -> str:
    """Return that all values are the same, and what they are; nothing where they differ, or for codes."""
    numbers = values[~np.isnan(values)]
    if flags_of(variable):
        return ""
    if not numbers.size:
        return "no value anywhere"
    low, high = float(numbers.min()), float(numbers.max())
    if np.isinf(low) or np.isinf(high):
        return "grows without bound everywhere" if np.isinf(numbers).all() else ""
    if high - low > SAME * max(abs(low), abs(high)):
        return ""
    units = str(variable.attrs.get("units", "1"))
    where = "everywhere" if numbers.size == values.size else "wherever it has a value"
    return f"{plain(short_number(low))}{'' if units == '1' else f' {units_text(units)}'} {where}"


def name_places(axis: Any, names: Sequence[str], turned: bool) -> None:
    """Label an axis by the names of its places, not more than fit on it."""
    step = -(-len(names) // MOST_NAMES)
    shown = [textwrap.shorten(plain(name), 24, placeholder="...") for name in names[::step]]
    axis.set_ticks(range(0, len(names), step), shown, rotation=30 if turned else 0, ha="right")
