"""The picture of error against run time, with every method named."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["draw"]

#: Smaller errors are drawn as this one, half a rounding of a double.
LEAST = 2.0**-54
COLUMNS = 2
#: Of the names of points: the size of their letters, how far they may stand from their points, and in which directions.
SIZE, DISTANCES = 6.5, (5.0, 12.0, 20.0, 30.0, 42.0)
PIECES = 40  # of a line between two points, which names keep free
DIRECTIONS = ((1.0, 0.0), (0.7, 0.9), (0.7, -0.9), (-1.0, 0.0), (-0.7, 0.9), (-0.7, -0.9))


def draw(measured: xr.Dataset) -> Figure:
    """Return the work-precision diagram, with a panel for each quantity."""
    from fastlink.plot.figure import NotebookFigure

    quantities = [str(name) for name in measured["quantity"].values]
    columns = min(COLUMNS, len(quantities))
    lines = -(-len(quantities) // columns)
    figure = NotebookFigure(figsize=(5.6 * columns, 4.2 * lines), dpi=160)
    panels = [figure.add_subplot(lines, columns, k + 1) for k in range(len(quantities))]
    points = [
        _draw_panel(axes, measured.sel(quantity=quantity), quantity)
        for axes, quantity in zip(panels, quantities, strict=True)
    ]
    figure.draw_without_rendering()  # which settles where the panels are
    figure.set_layout_engine("none")
    for axes, named in zip(panels, points, strict=True):
        _name_points(axes, named)
    return figure


def _draw_panel(axes: Any, measured: xr.Dataset, quantity: str) -> list[tuple[str, float, float]]:
    """Draw error over time of all methods for one quantity; return their names and places."""
    from matplotlib.ticker import LogLocator, NullLocator

    measured = measured.isel(way=np.flatnonzero(np.isfinite(measured["error_max"].values)))
    times, errors = measured["ns_per_design"].values, np.maximum(measured["error_max"].values, LEAST)
    on_front = measured["pareto"].values == 1
    order = np.flatnonzero(on_front)[np.argsort(times[on_front])]
    axes.plot(times[order], errors[order], color="tab:blue", zorder=1)
    axes.scatter(times, errors, c=np.where(on_front, "tab:blue", "0.6"), s=18, zorder=2)
    axes.set(xscale="log", yscale="log", title=quantity, xlabel="run time per design / ns")
    axes.set_ylabel("largest relative error")
    axes.margins(x=0.3, y=0.2)
    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        if high < 10.0 * low:  # less than a decade, in which numbers stand at whole powers of ten alone
            middle = np.sqrt(low * high)
            axis.set_view_interval(middle / 10.0, 10.0 * middle, ignore=True)
        axis.set_major_locator(LogLocator(numticks=8))
        axis.set_minor_locator(NullLocator())
    axes.grid(color="0.9", linewidth=0.6)
    return list(zip(measured["way"].values.tolist(), times.tolist(), errors.tolist(), strict=True))


def _name_points(axes: Any, points: list[tuple[str, float, float]]) -> None:
    """Write the names of points beside them, each where it hides neither a point nor another name."""
    unit = axes.figure.dpi / 72.0
    places = axes.transData.transform([(x, y) for _, x, y in points])
    frame = tuple(axes.get_window_extent().extents / unit)
    (front,) = axes.lines
    corners = axes.transData.transform(front.get_xydata())
    along = [np.linspace(a, b, PIECES) for a, b in itertools.pairwise(corners)]
    kept = np.concatenate([places, *along]) / unit
    taken = [(x - 3.0, y - 3.0, x + 3.0, y + 3.0) for x, y in kept.tolist()]
    for (name, x, y), place in sorted(zip(points, places / unit, strict=True), key=lambda one: one[0][2]):
        width, height = 0.56 * SIZE * len(name), 1.2 * SIZE
        area = width * height
        tried = [
            (shift_x if shift_x >= 0 else shift_x - width, shift_y - 0.5 * height)
            for distance in DISTANCES
            for shift_x, shift_y in (distance * np.array(DIRECTIONS)).tolist()
        ]
        boxes = [(place[0] + a, place[1] + b, place[0] + a + width, place[1] + b + height) for a, b in tried]
        # what lies outside the frame is hidden too
        hidden = [sum(_overlap(box, one) for one in taken) + area - _overlap(box, frame) for box in boxes]
        best = int(np.argmin(hidden))
        taken.append(boxes[best])
        shift = (tried[best][0], tried[best][1] + 0.5 * height)
        arrow = {"arrowstyle": "-", "color": "0.6", "linewidth": 0.5} if best >= len(DIRECTIONS) else None
        axes.annotate(
            name,
            (x, y),
            xytext=shift,
            textcoords="offset points",
            fontsize=SIZE,
            va="center",
            arrowprops=arrow,
        )


def _overlap(one: tuple[float, ...], other: tuple[float, ...]) -> float:
    """Return the area that two boxes (left, lower, right, upper) share."""
    width = min(one[2], other[2]) - max(one[0], other[0])
    height = min(one[3], other[3]) - max(one[1], other[1])
    return max(0.0, width) * max(0.0, height)
