"""The designs of a part of a sweep, and what it keeps of the whole."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from fastlink.engine import labels
from fastlink.space.design_space import DESIGN, DesignSpace
from fastlink.space.values import frozen

if TYPE_CHECKING:
    import xarray as xr

    from fastlink.engine.resolve import ResolvedSweep

__all__ = ["consecutive", "whole_coordinates"]


def consecutive(space: DesignSpace, start: int, stop: int) -> DesignSpace:
    """Return designs ``start`` to ``stop - 1`` of a space along the one dimension ``design``."""
    names = [*space.axes, *space.columns]
    rows = np.empty((len(names), stop - start))
    space.fill(names, start, stop, rows)
    columns = {name: frozen(row) for name, row in zip(names, rows, strict=True)}
    number = space._axis_indices(start, stop).get(DESIGN)
    own = {name: label if label.ndim == 0 else label[number] for name, label in space.labels.items()}
    if DESIGN not in own or space.dims != (DESIGN,):
        own[DESIGN] = np.arange(start, stop)
    shape = (stop - start,)
    return replace(space, dims=(DESIGN,), shape=shape, axes={}, columns=columns, labels=own)


def whole_coordinates(resolved: ResolvedSweep, start: int, stop: int) -> xr.Dataset:
    """Return the coordinates of a whole map that a part of its designs has not got itself.

    These are the axes; beside axes, those along ``design`` too, for the designs of the part. The attributes are the
    dimensions of the designs and their lengths.
    """
    space, coords = resolved.space, labels.coordinates_of(resolved)
    if space.dims == (DESIGN,):
        coords = coords.drop_vars(list(coords.coords))
    elif space.dims[:1] == (DESIGN,):
        inner = space.size // space.shape[0]
        coords = coords.isel({DESIGN: slice(start // inner, -(-stop // inner))})
    others = [name for name, one in coords.coords.items() if not {*one.dims} & {*space.dims}]
    shape = {"shape": np.array(space.shape)} if space.dims else {}
    coords = coords.drop_vars(others)
    coords.attrs = {"dims": " ".join(space.dims), **shape}
    return coords
