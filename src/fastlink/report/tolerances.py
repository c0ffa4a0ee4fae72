"""List what tolerances do to the results of a map, a row for each result."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import aligned, counted, in_words, short_number
from fastlink.facts.names import Change, GradientStatus, Quantity

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["CONTRIBUTION", "TOLERANCED", "changes_listed"]

#: What `fastlink.tolerance` calls the changes by each input, and their dimension.
CONTRIBUTION, TOLERANCED = "contribution", "toleranced"


def changes_listed(found: xr.Dataset) -> str:
    """Return the changes of each result as a table: those of one design, else medians and the greatest.

    Parameters
    ----------
    found : xarray.Dataset
        Of `fastlink.tolerance`.
    """
    names = [str(name) for name in found.data_vars if _change(str(name), "worst") in found.data_vars]
    inputs = [str(name) for name in found[TOLERANCED].values] if TOLERANCED in found.dims else []
    one = all(found[name].size == 1 for name in names)
    head = ["", "", "value", "worst change", *([] if one else ["greatest"]), "rss change"]
    rows = [[*head, *(f"by {name}" for name in inputs), "flagged"]]
    for name in names:
        worst, rss = found[_change(name, "worst")], found[_change(name, "rss")]
        row = [name, found[name].attrs.get("units", ""), _median(found[name]), _median(worst)]
        row += [] if one else [short_number(_greatest(worst.values))]
        row.append(_median(rss))
        for of in inputs:
            part = found[f"{name}_{CONTRIBUTION}"].sel({TOLERANCED: of})
            row.append(_median(part if one else abs(part)))
        rows.append([*row, _flagged(found, name)])
    sizes = max((found[name].size for name in names), default=0)
    about = "" if one else f"medians of {counted(sizes, 'value')}, and the greatest worst change\n"
    return about + aligned(rows, right=2)


def _change(name: str, how: str) -> str:
    """Return the name of the change of a result."""
    return str(Change(Quantity(name), how))


def _median(array: xr.DataArray) -> str:
    """Return the median of the numbers among some values, as text."""
    values = np.asarray(array.values, dtype=float).ravel()
    values = values[np.isfinite(values)]
    return short_number(float(np.median(values))) if values.size else "nan"


def _greatest(values: Any) -> float:
    """Return the greatest number among some values, NaN if there is none."""
    return float(np.nanmax(values)) if np.isfinite(values).any() else float("nan")


def _flagged(found: xr.Dataset, name: str) -> str:
    """Return how many derivatives of a result are none or one-sided, as text."""
    if (status := str(GradientStatus(Quantity(name)))) not in found.variables:
        return "-"
    codes = found[status].values
    flags = found[status].attrs
    meanings = dict(zip(flags["flag_values"].tolist(), flags["flag_meanings"].split(), strict=True))
    bad = codes[codes != 0]
    if codes.size == 1:
        return in_words(meanings[int(codes.ravel()[0])]) if bad.size else "-"
    return f"{bad.size} of {codes.size}"
