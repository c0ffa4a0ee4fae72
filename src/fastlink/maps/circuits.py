"""Circuits of declared linkages: what one assembled linkage moves through without being taken apart."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from fastlink.errors import InputError
from fastlink.maps.units import check_flags, has_flag

#: Two branches meet where one dyad is in its limit: that place is found twice, by the same numbers.
SAME_PLACE = 1e-6


def circuits_of(maps: xr.Dataset) -> xr.DataArray:
    """Return the circuit of each range in each branch, see `fastlink.maps.MapAccessor.circuits`."""
    position = str(maps.attrs.get("input"))
    names = [f"{position}_{word}" for word in ("low", "high", "low_by", "high_by")]
    if not (names[2] in maps or any(name in maps for name in names) or maps.attrs.get("mechanism_sheet")):
        what = f"is of {maps.attrs.get('mechanism')}, which is no declared linkage"
        raise InputError(what, ("maps",), "sweep one of fl.linkage")
    for name in names:
        if name not in maps:
            remedy = f"sweep a declared linkage with {', '.join(names)}, in all its branches"
            raise InputError(f"has no {name}", ("maps",), remedy)
    gaps = str(maps[names[2]].attrs["flag_meanings"]).split()[1:]
    count = 2 ** len(gaps)
    if "branch" not in maps.dims or maps.branch.values.tolist() != [*range(1, count + 1)]:
        every = ", ".join(map(str, range(1, min(count, 4) + 1))) + (", ..." if count > 4 else "")
        raise InputError("has not all branches", ("maps",), f"sweep with branch=({every})")
    others = [one for one in maps[names[0]].dims if one not in ("branch", "extremum")]
    low, high, low_by, high_by = (maps[name].transpose(*others, "branch", "extremum") for name in names)
    shape = low.shape[:-2]
    ends = [one.values.reshape(-1, *one.shape[-2:]) for one in (low, low_by, high, high_by)]
    turning = check_flags(maps.status, ("status",), ["rotates_fully"])
    whole = has_flag(maps.status, turning).transpose(*others, "branch").values.reshape(-1, count)
    is_range = np.isfinite(ends[0]) | np.isfinite(ends[2])
    is_range[..., 0] |= whole
    room = max(1, int(is_range.sum(axis=-1).max(initial=0)))
    labels = _joined(is_range[..., :room], [one[..., :room] for one in ends])
    found = np.zeros(is_range.shape, dtype=np.int32)
    found[..., :room] = labels
    return xr.DataArray(
        found.reshape(*shape, *is_range.shape[1:]),
        dims=low.dims,
        coords=low.coords,
        name="circuit",
        attrs={
            "units": "1",
            "long_name": "Circuit of each range through which it moves; 0 where there is none",
        },
    )


def _joined(is_range: Any, ends: list[Any]) -> Any:
    """Return numbers of circuits from 1 on: ranges are of one if they meet where a dyad is in its limit."""
    designs, branches, room = is_range.shape
    nodes = np.arange(branches * room).reshape(1, branches, room)
    labels = np.where(is_range, nodes, branches * room)
    meets = []
    for at, by in (ends[:2], ends[2:]):
        # the other way to assemble the dyad that limits it there
        way = np.where(by > 0, 1 << np.maximum(by.astype(np.int64) - 1, 0), 0)
        other = np.arange(branches)[:, None] ^ way
        rows = np.arange(designs)[:, None, None]
        apart = abs(at[..., None] - at[rows, other])
        apart = np.where(by[rows, other] == by[..., None], np.minimum(apart, 2.0 * np.pi - apart), np.inf)
        apart = np.where(np.isnan(apart), np.inf, apart)
        nearest = apart.argmin(axis=-1)
        met = (by > 0) & (np.take_along_axis(apart, nearest[..., None], axis=-1)[..., 0] < SAME_PLACE)
        meets.append(np.where(met, other * room + nearest, nodes).reshape(designs, -1))
    labels = labels.reshape(designs, -1)
    before = None
    while before is None or not np.array_equal(labels, before):
        before = labels
        for met in meets:
            labels = np.minimum(labels, np.take_along_axis(labels, met, axis=1))
    first = (labels == np.arange(branches * room)) & is_range.reshape(designs, -1)
    numbers = np.concatenate([first.cumsum(axis=1), np.zeros((designs, 1), dtype=np.int64)], axis=1)
    return np.take_along_axis(numbers, labels, axis=1).reshape(is_range.shape)
