"""Choose the colours of a variable for the page, as a picture of it has them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from matplotlib.colors import CenteredNorm, LogNorm, to_hex

from fastlink.maps.flags import flags_of
from fastlink.maps.units import half_turn
from fastlink.plot.colours import CYCLIC, FLAGS, are_counts, colours_of, drawable

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["COLOURS", "colour_tables", "scale_of"]

#: The colour maps that scales name: even in lightness, and told apart by the colour-blind.
COLOURS = ("viridis", "RdBu_r", CYCLIC)
STEPS = 256


def colour_tables() -> dict[str, list[str]]:
    """Return each colour map as a list of colours."""
    places = np.linspace(0.0, 1.0, STEPS)
    return {name: [to_hex(one) for one in matplotlib.colormaps[name](places)] for name in COLOURS}


def scale_of(variable: xr.DataArray, sample: Any, regular: Any = None) -> dict[str, Any]:
    """Return how values become colours, from a sample of them.

    Parameters
    ----------
    variable : xarray.DataArray
        The variable, for its attributes.
    sample : array
        Values of it.
    regular : array of bool, optional
        Which of them are of designs without toggles, where these are told apart.
    """
    if flags := flags_of(variable):
        colours = {str(code): FLAGS[k % len(FLAGS)] for k, code in enumerate(flags.values())}
        return {"kind": "codes", "colours": colours, "pools": False}
    values = np.ravel(np.asarray(sample, dtype=float))
    if are_counts(values):
        low, high = float(np.nanmin(values)), float(np.nanmax(values))
        return {"kind": "counts", "low": low - 0.5, "high": high + 0.5, "map": "viridis", "pools": False}
    values = np.where(np.isfinite(values), drawable(values), np.nan)
    inside = np.ones(values.shape, bool) if regular is None or not np.any(regular) else np.ravel(regular)
    norm, colours, extend = colours_of(values, inside, half_turn(variable.attrs.get("units")))
    low, high = float(norm.vmin), float(norm.vmax)
    if isinstance(norm, CenteredNorm):
        low, high = norm.vcenter - norm.halfrange, norm.vcenter + norm.halfrange
    kind = "log" if isinstance(norm, LogNorm) else "linear"
    # an angle and that half a turn further on have no mean
    scale = {"kind": kind, "low": float(low), "high": float(high), "map": colours.name, "extend": extend}
    return {**scale, "pools": colours.name != CYCLIC}
