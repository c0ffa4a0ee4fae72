"""The designs of a part of a sweep, and what it keeps of the whole."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from fastlink.engine import labels

if TYPE_CHECKING:
    import xarray as xr

    from fastlink.engine.resolve import ResolvedSweep
    from fastlink.space.design_space import DesignSpace

__all__ = ["consecutive", "whole_coordinates"]


def consecutive(space: DesignSpace, start: int, stop: int) -> DesignSpace:
    """Return designs ``start`` to ``stop - 1`` of a space along the one dimension ``design``."""
    return replace(space.consecutive(start, stop), attrs=space.attrs)


def whole_coordinates(resolved: ResolvedSweep) -> xr.Dataset:
    """Return what a part of a sweep does not tell itself of the coordinates of the whole map.

    These are its axes, and as attributes the dimensions of its designs and their lengths.
    """
    space = resolved.space
    shape = tuple(len(values) for values in space.axes.values())
    of_axes = replace(space, dims=tuple(space.axes), shape=shape, columns={}, labels={}, constants={})
    axes = labels.sweep_coordinates(resolved.plan, of_axes, resolved.positions)
    axes = axes.drop_vars([name for name in axes.coords if name not in space.axes])
    axes.attrs = {"dims": " ".join(space.dims), **({"shape": np.array(space.shape)} if space.dims else {})}
    return axes
