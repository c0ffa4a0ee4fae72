"""The designs of a part of a sweep, and what it keeps of the whole."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.engine import labels
from fastlink.space.column import Counted, part_of
from fastlink.space.design_space import DESIGN

if TYPE_CHECKING:
    import xarray as xr

    from fastlink.engine.resolve import ResolvedSweep
    from fastlink.space.design_space import DesignSpace

__all__ = ["consecutive", "whole_coordinates"]


def consecutive(space: DesignSpace, start: int, stop: int) -> DesignSpace:
    """Return designs ``start`` to ``stop - 1`` of a space along the one dimension ``design``."""
    return replace(space.consecutive(start, stop), attrs=space.attrs)


def whole_coordinates(resolved: ResolvedSweep, start: int, stop: int) -> xr.Dataset:
    """Return what a part of a sweep does not tell itself of the coordinates of the whole map.

    These are its axes; the numbers that a table gives its designs, of those with rows in the part, where several rows
    follow from each; and as attributes the dimensions of the designs and their lengths.
    """
    space = resolved.space
    dims, own = dict(zip(space.dims, space.shape, strict=True)), dict[str, Any]()
    shared = space.size // dims.pop(DESIGN, space.size)
    if shared > 1 and not isinstance(number := space.labels.get(DESIGN), (Counted, type(None))):
        own[DESIGN] = part_of(number, 1, start // shared, -(-stop // shared))
        dims = {DESIGN: len(own[DESIGN]), **dims}
    kept = {"dims": tuple(dims), "shape": tuple(dims.values()), "columns": {}, "constants": {}, "labels": own}
    coords = labels.sweep_coordinates(resolved.plan, replace(space, **kept), resolved.positions)  # type: ignore[arg-type]
    coords = coords.drop_vars([name for name in coords.coords if name not in (*space.axes, *own)])
    coords.attrs = {"dims": " ".join(space.dims), **({"shape": np.array(space.shape)} if space.dims else {})}
    return coords
