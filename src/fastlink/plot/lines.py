"""Draw a variable over one dimension, as lines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np

from fastlink._text import in_words
from fastlink.maps.flags import flags_of
from fastlink.maps.units import RADIAN, half_turn
from fastlink.plot.colours import ABSENT, INFINITE, LINES, WITHOUT_BOUND, drawable, limits_of
from fastlink.plot.labels import label_of
from fastlink.plot.panels import name_places, panels_of, sameness
from fastlink.plot.selection import Selection
from fastlink.space.design_space import DESIGN

if TYPE_CHECKING:
    import xarray as xr

    from fastlink.plot.panels import Panel

__all__ = ["cut", "draw_lines"]

QUARTERS = (r"$0$", r"$\pi/2$", r"$\pi$", r"$3\pi/2$", r"$2\pi$")
STYLES = ("-", "--", ":", "-.")
SHADES = matplotlib.colormaps["viridis"].resampled(64)
MOST_INSIDE = 4  # entries of a legend that stands among the lines
MANY = 10_000  # points from which to look for the best place of a legend takes longer than to draw them


def draw_lines(figure: Any, shown: Selection) -> None:
    """Draw a line for each assembly mode and each value of the dimension that is split."""
    variable, (dim,) = shown.variable, shown.free
    axis = figure.subplots()
    x = variable[dim].values
    every = []
    for panel, look in _looks(shown):
        values = panel.array.values.astype(float)
        every.append(values)
        axis.plot(*cut(x, drawable(values), variable.attrs.get("units")), label=panel.title, **look)
    _shade(axis, x, np.isnan(every).all(axis=0), ABSENT, "does not assemble")
    _shade(axis, x, np.isinf(every).any(axis=0), INFINITE, WITHOUT_BOUND)
    _scale_along(axis, shown)
    axis.grid(color="0.9", linewidth=0.8)
    axis.set_axisbelow(True)
    axis.set_xlabel(label_of(variable[dim]))
    axis.set_ylabel(label_of(variable, name=False))
    _scale_across(axis, variable, np.array(every))
    handles, labels = axis.get_legend_handles_labels()
    if any(labels):
        named = [(handle, label) for handle, label in zip(handles, labels, strict=True) if label]
        beside: dict[str, Any] = {"loc": "best" if len(x) < MANY else "upper right"}
        if len(named) > MOST_INSIDE:
            beside = {"loc": "upper left", "bbox_to_anchor": (1.01, 1.0), "frameon": False, "fontsize": 9}
            figure.set_size_inches(9.2, 4.2)
        axis.legend(*zip(*named, strict=True), **beside)


def _looks(shown: Selection) -> list[tuple[Panel, dict[str, Any]]]:
    """Return each line and how it is drawn: values by colours of growing lightness, assembly modes by dashes too."""
    rows = panels_of(shown)
    (dim,) = shown.free
    looks: list[tuple[Panel, dict[str, Any]]] = []
    for i, row in enumerate(rows):
        for k, panel in enumerate(row):
            shade = SHADES(0.9 * k / (len(row) - 1)) if len(row) > 1 else LINES[i % len(LINES)]
            marker = "." if shown.variable.sizes[dim] < 40 else ""
            look = {"color": shade, "linestyle": STYLES[i % len(STYLES)], "marker": marker, "linewidth": 1.6}
            if dim == DESIGN or dim in shown.names:
                look |= {"marker": ".", "linestyle": "none"}
            looks.append((panel, look))
    return looks


def _scale_across(axis: Any, variable: xr.DataArray, every: Any) -> None:
    """Set range and ticks of the axis of the values; write where they are all the same."""
    if flags := flags_of(variable):
        axis.set_yticks(list(flags.values()), [in_words(meaning) for meaning in flags])
        axis.set_ylim(min(flags.values()) - 0.5, max(flags.values()) + 0.5)
        return
    values = drawable(every)
    low, high, extend = limits_of(values, values, 50.0)
    if same := sameness(variable, every):
        axis.set_ylim(low, high)
        axis.set_title(same)
    elif extend != "neither":
        axis.set_ylim(low - 0.05 * (high - low), high + 0.05 * (high - low))


def _scale_along(axis: Any, shown: Selection) -> None:
    """Set range and ticks of the axis that the lines run along: a turn has its quarters."""
    (dim,) = shown.free
    along = shown.variable[dim]
    x, half = along.values, half_turn(along.attrs.get("units"))
    if dim in shown.names:
        name_places(axis.xaxis, shown.names[dim], turned=True)
    elif half is not None and x[0] >= 0.0 and x[-1] <= 2.0 * half:
        axis.set_xlim(0.0, 2.0 * half)
        ticks = QUARTERS if along.attrs["units"] == RADIAN else None
        axis.set_xticks(np.linspace(0.0, 2.0 * half, 5), ticks)
    elif dim != DESIGN and x[0] < x[-1]:
        axis.set_xlim(x[0], x[-1])


def cut(x: Any, values: Any, units: Any) -> tuple[Any, Any]:
    """Return a curve, cut where an angle passes from half a turn to minus half a turn."""
    half = half_turn(units)
    if half is None:
        return x, values
    with np.errstate(invalid="ignore"):
        jumps = np.flatnonzero(np.abs(np.diff(values)) > half) + 1
    return np.insert(x.astype(float), jumps, x[jumps]), np.insert(values, jumps, np.nan)


def _shade(axis: Any, x: Any, absent: Any, colour: str, label: str) -> None:
    """Shade where there is no value to draw, half-way to the neighbours that have one."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], absent, [False])).astype(int)))
    if not edges.size:
        return
    middles = np.concatenate((x[:1], 0.5 * (x[:-1] + x[1:]), x[-1:]))
    starts, stops = middles[edges[::2]], middles[edges[1::2]]
    spans = list(
        zip(starts, stops - starts, strict=True)
    )  # as one shape: a sample has a span for every third design
    height = axis.get_xaxis_transform()
    axis.broken_barh(spans, (0.0, 1.0), transform=height, color=colour, linewidth=0, label=label)
    axis.update_datalim([(starts[0], 0.0), (stops[-1], 0.0)], updatey=False)
