"""Rank the rows of a map by one variable."""

from __future__ import annotations

from typing import Any

import xarray as xr

from fastlink.maps.best import objective, ranked
from fastlink.maps.conditions import check_along, conditions
from fastlink.maps.rows import Rows
from fastlink.options import check_switch, check_whole

__all__ = ["top"]


def top(maps: xr.Dataset, n: int, by: str, *, largest: bool, where: Any, infinite: bool) -> xr.Dataset:
    """Return the rows of a map with the greatest or least values of one variable; see `MapAccessor.top`."""
    n = check_whole(("n",), n, 1)
    check_switch(("largest",), largest)
    check_switch(("infinite",), infinite)
    key = objective(maps, "by", by, -1.0 if largest else 1.0)
    wanted = conditions(maps, where)
    rows = Rows.of([key.array])
    for condition in wanted:
        for dim, length in condition.array.sizes.items():
            check_along(condition.array.name, str(dim), length, rows.sizes)
    return ranked(rows, key, wanted, top=n, infinite=infinite).of(maps)
