"""Changes by tolerances from derivatives that are known, and the share of each input in them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.engine.resolve import resolve
from fastlink.facts.names import Change, Quantity
from fastlink.report.tolerances import CONTRIBUTION, TOLERANCED
from fastlink.searching.result import labels_of
from fastlink.symbolic.changes import is_tolerance, tolerance_name

if TYPE_CHECKING:
    import xarray as xr

    from fastlink.diagnostics.tolerance import Subject

__all__ = ["HOWS", "change_name", "from_derivatives", "with_contributions"]

HOWS = ("worst", "rss")


def change_name(name: str, how: str = "worst") -> str:
    """Return the name of the change of a result."""
    return str(Change(Quantity(name), how))


def from_derivatives(
    maps: xr.Dataset, subject: Subject, slopes: Mapping[str, Mapping[str, str]]
) -> xr.Dataset | None:
    """Return results and changes from the derivatives that a map has; None where it lacks one, or has other units."""
    space = subject.space
    if any(is_tolerance(name) and name not in space.constants for name in space.names):
        return None
    wanted = [name for of in slopes for name in (of, *(change_name(of, how) for how in HOWS))]
    labels = labels_of(resolve(subject.mechanism, space, wanted, **subject.options))
    results = [str(name) for name in labels.data_vars if name not in wanted or name in slopes]
    known = [*results, *(name for of in slopes.values() for name in of.values())]
    inputs = {by for of in slopes.values() for by in of}
    if not maps.data_vars.keys() >= {*known}:
        return None
    if any(maps[name].attrs.get("units") != labels[name].attrs.get("units") for name in (*results, *inputs)):
        return None
    found = maps[list(dict.fromkeys(known))].load()
    found = found.assign_coords({name: labels[name] for name in space.constants if is_tolerance(name)})
    changes: dict[str, xr.DataArray] = {}
    for name, of in slopes.items():
        terms = [abs(found[slope]) * _size(found, by) for by, slope in of.items()]
        for how, add in zip(HOWS, (np.add, np.hypot), strict=True):
            total = reduce(add, terms).transpose(*found[name].dims)
            changes[change_name(name, how)] = total.variable.copy(deep=False)
            changes[change_name(name, how)].attrs = labels[change_name(name, how)].attrs
    found = found.assign(changes)
    return found[[*map(str, labels.data_vars), *dict.fromkeys(known[len(results) :])]]


def with_contributions(found: xr.Dataset, slopes: Mapping[str, Mapping[str, str]]) -> xr.Dataset:
    """Return results with the change of each by each input alone."""
    if not slopes:
        return found
    import xarray as xr

    inputs = list(dict.fromkeys(by for of in slopes.values() for by in of))
    added: dict[str, Any] = {}
    for name, of in slopes.items():
        blank = xr.zeros_like(found[name])
        parts = [(found[of[by]] * _size(found, by) if by in of else blank).values for by in inputs]
        labels = {key: found[name].attrs[key] for key in ("units", "references") if key in found[name].attrs}
        meaning = f"Change by the tolerance of each input of: {found[name].attrs.get('long_name', name)}"
        labels |= {"long_name": meaning}
        added[f"{name}_{CONTRIBUTION}"] = (*found[name].dims, TOLERANCED), np.stack(parts, axis=-1), labels
    result = found.assign(added)
    label = {"long_name": "input that has a tolerance"}
    return result.assign_coords({TOLERANCED: ((TOLERANCED,), np.array(inputs), label)})


def _size(found: xr.Dataset, by: str) -> Any:
    """Return how far an input may be off."""
    own, share = tolerance_name(by), tolerance_name(by, relative=True)
    return abs(found[by]) * found[share] if share in found.variables else found[own]
