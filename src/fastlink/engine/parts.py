"""The designs of a part of a sweep, and what it keeps of the whole."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from fastlink.engine import labels
from fastlink.space.column import Counted, part_of
from fastlink.space.design_space import DESIGN, DesignSpace

if TYPE_CHECKING:
    from fastlink.engine.resolve import ResolvedSweep

__all__ = ["consecutive", "whole_coordinates"]


def consecutive(space: DesignSpace, start: int, stop: int) -> DesignSpace:
    """Return designs ``start`` to ``stop - 1`` of a space along the one dimension ``design``."""
    return replace(space.consecutive(start, stop), attrs=space.attrs)


def _along_designs(space: DesignSpace, start: int, stop: int) -> DesignSpace:
    """Return a space that has, beside axes, no more of its dimension ``design`` than some designs are made of."""
    if space.dims[:1] != (DESIGN,):
        return space
    inner = space.size // space.shape[0]
    first, last = start // inner, -(-stop // inner)
    columns = {name: part_of(values, 1, first, last) for name, values in space.columns.items()}
    own = {DESIGN: Counted(0, space.shape[0])} | space.labels
    along = {name: part_of(label, 1, first, last) if label.ndim else label for name, label in own.items()}
    return replace(space, shape=(last - first, *space.shape[1:]), columns=columns, labels=along)


def whole_coordinates(resolved: ResolvedSweep, start: int, stop: int) -> xr.Dataset:
    """Return the coordinates of a whole map that a part of its designs has not got itself.

    These are the axes; beside axes, those along ``design`` too, for the designs of the part. The attributes are the
    dimensions of the designs and their lengths.
    """
    space = resolved.space
    if space.dims == (DESIGN,):
        coords = xr.Dataset()
    else:
        coords = labels.coordinates_of(replace(resolved, space=_along_designs(space, start, stop)))
    others = [name for name, one in coords.coords.items() if not {*one.dims} & {*space.dims}]
    shape = {"shape": np.array(space.shape)} if space.dims else {}
    coords = coords.drop_vars(others)
    coords.attrs = {"dims": " ".join(space.dims), **shape}
    return coords
