"""Draw a variable over one dimension as lines, over two as a map or as a grid of maps."""

from __future__ import annotations

import textwrap
import warnings
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from matplotlib.colors import ListedColormap, LogNorm
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, MaxNLocator

from fastlink._text import in_words
from fastlink.maps.units import RADIAN, flags_of, half_turn
from fastlink.pictures.labels import constants_of, label_of, title_of
from fastlink.pictures.maps import Selection, modes_of, name_places, panels_of, sameness
from fastlink.pictures.style import (
    ABSENT,
    CYCLIC,
    INFINITE,
    LINES,
    VEIL,
    WITHOUT_BOUND,
    NotebookFigure,
    are_counts,
    colours_of,
    count_colours,
    drawable,
    flag_colours,
    flag_handles,
    flag_indices,
    limits_of,
    near,
)
from fastlink.space.design_space import DESIGN

if TYPE_CHECKING:
    import xarray as xr

    from fastlink.pictures.maps import Panel, Selection

__all__ = ["cut", "draw"]


# -- Draw a variable over two dimensions, as a map, or as a grid of maps


CONTOURS = 8
BESIDE, BELOW, NARROW = 32, 60, 40  # letters in a line of a legend, and of a label
COLUMNS = 3  # of a grid
LARGE, SMALL = (5.2, 5.0), (2.75, 2.5)  # panels, in inches


def draw_maps(figure: Any, shown: Selection) -> None:
    """Draw a panel for each assembly mode and each value of the dimension that is split."""
    variable, free, status = shown.variable, shown.free, shown.status
    rows = _wrapped(panels_of(shown))
    panels = [panel for row in rows for panel in row]
    axes = _axes(figure, shown, rows, bool(flags_of(variable)))
    values = np.stack([panel.array.transpose(free[1], free[0]).values for panel in panels]).astype(float)
    codes, flags = _codes(status, panels), {} if status is None else flags_of(status)
    same = sameness(variable, values)
    infinite = np.isinf(values)
    values = np.where(infinite, np.nan, drawable(values))
    plain = bool(flags_of(variable)) or are_counts(
        values
    )  # neither has contours, neither grows without bound
    veiled = _veiled(values, codes, flags)
    norm, colours, extend = _scale(variable, values, ~veiled)
    veiled &= not plain
    x, y = (variable[dim].values for dim in free)
    for axis, panel, cells, beyond, veil in zip(axes, panels, values, infinite, veiled, strict=True):
        axis.set_facecolor(ABSENT)
        drawn = flag_indices(variable, cells) if flags_of(variable) else near(cells, norm)
        image = _fill(axis, x, y, np.ma.masked_invalid(drawn), norm=norm, cmap=colours)
        if beyond.any():
            _fill(axis, x, y, np.ma.masked_equal(beyond, False), cmap=ListedColormap([INFINITE]))
        if not plain:
            if colours.name != CYCLIC and not same:
                _add_contours(axis, x, y, np.where(veil, np.nan, cells), norm, small=shown.split is not None)
            _add_veil(axis, x, y, veil)
        axis.set_title(panel.title)
        if same:
            _write(axis, same)
    handles = flag_handles(variable, values) if flags_of(variable) else []
    if not flags_of(variable) and not same:
        bar = figure.colorbar(image, ax=list(axes), extend=extend, pad=0.02, ticks=_bar_ticks(values))
        bar.set_label(label_of(variable, name=False))
    handles += _reasons(codes, flags, veiled, infinite, np.isnan(values) & ~infinite)
    _add_legend(axes, handles, beside=bool(flags_of(variable)))


def _wrapped(rows: list[list[Panel]]) -> list[list[Panel]]:
    """Return rows of panels of which none is long: one row of many values becomes several."""
    if len(rows) > 1 and all(len(row) == 1 for row in rows):
        return [[row[0] for row in rows]]
    (first, *others) = rows
    if others or len(first) <= COLUMNS:
        return rows
    columns = 2 if len(first) == 4 else COLUMNS
    return [first[k : k + columns] for k in range(0, len(first), columns)]


def _axes(figure: Any, shown: Selection, rows: list[list[Panel]], is_code: bool) -> list[Any]:
    """Return the axes of all panels, row by row, labelled at the outer ones."""
    columns = len(rows[0])
    width, height = LARGE if shown.split is None else SMALL
    legend = 3.0 if is_code else 1.6
    figure.set_size_inches(legend + width * columns, height * len(rows) + 0.9 * (len(rows) > 1))
    grid = figure.subplots(len(rows), columns, sharex=True, sharey=True, squeeze=False)
    variable, free = shown.variable, shown.free
    letters = BELOW if shown.split is None else NARROW
    taken = []
    for i, row in enumerate(rows):
        for j, axis in enumerate(grid[i]):
            if j >= len(row):
                axis.set_visible(False)
                grid[i - 1][j].tick_params(labelbottom=True)
                continue
            taken.append(axis)
            if i == len(rows) - 1 or j >= len(rows[i + 1]):
                axis.set_xlabel(textwrap.fill(label_of(variable[free[0]]), letters))
                if free[0] in shown.names:
                    name_places(axis.xaxis, shown.names[free[0]], turned=True)
            if j == 0:
                axis.set_ylabel(textwrap.fill(label_of(variable[free[1]]), letters))
                if free[1] in shown.names:
                    name_places(axis.yaxis, shown.names[free[1]], turned=False)
            if shown.split is not None:
                axis.xaxis.label.set_fontsize(8)
                axis.yaxis.label.set_fontsize(8)
                axis.title.set_fontsize(9.5)
                axis.tick_params(labelsize=8)
    return taken


def _codes(status: xr.DataArray | None, panels: Sequence[Panel]) -> Any:
    """Return the status of each cell of each panel, or None."""
    if status is None:
        return None
    return np.stack([status.values if status.ndim == 2 else status.values[panel.place] for panel in panels])


def _veiled(values: Any, codes: Any, flags: Mapping[str, int]) -> Any:
    """Return the cells of designs with toggles, where rates grow without bound.

    There are none where all cells are such: a veil over all of them would distinguish nothing.
    """
    if codes is None:
        return np.zeros(values.shape, bool)
    present = np.isfinite(values)
    veiled = present & (codes != next(iter(flags.values())))
    return veiled & (present & ~veiled).any()


def _scale(variable: xr.DataArray, values: Any, regular: Any) -> tuple[Any, Any, str]:
    """Return norm, colour map and open ends for codes, counts or numbers."""
    if flags_of(variable):
        return flag_colours(variable)
    if are_counts(values):
        return count_colours(values)
    return colours_of(values, regular, half_turn(variable.attrs.get("units")))


def _bar_ticks(values: Any) -> Any:
    return MaxNLocator(integer=True) if are_counts(values) else None


def _fill(axis: Any, x: Any, y: Any, cells: Any, **colours: Any) -> Any:
    return axis.pcolormesh(x, y, cells, shading="nearest", rasterized=True, **colours)


def _write(axis: Any, text: str) -> None:
    """Write a text in the middle of a panel, in place of a scale of colours that would show nothing."""
    box = {"facecolor": "white", "edgecolor": "0.7", "boxstyle": "round,pad=0.5"}
    axis.text(0.5, 0.5, textwrap.fill(text, 30), transform=axis.transAxes, ha="center", va="center", bbox=box)


def _reasons(codes: Any, flags: Mapping[str, int], veiled: Any, infinite: Any, absent: Any) -> list[Patch]:
    """Return the legend of cells under the veil, without bound, or without a value."""
    handles = []
    if veiled.any():
        label = _meanings(codes[veiled], flags)
        handles.append(Patch(facecolor=VEIL, edgecolor="0.35", linewidth=0, hatch="////", label=label))
    if infinite.any():
        handles.append(Patch(facecolor=INFINITE, label=WITHOUT_BOUND))
    if absent.any():
        label = _why_absent(None if codes is None else codes[absent], flags)
        handles.append(Patch(facecolor=ABSENT, label=label))
    return handles


def _add_contours(axis: Any, x: Any, y: Any, cells: Any, norm: Any, small: bool) -> None:
    if min(cells.shape) < 2 * CONTOURS or not np.isfinite(cells).any():
        return
    locator = LogLocator(subs=(1.0, 2.0, 5.0)) if isinstance(norm, LogNorm) else MaxNLocator(CONTOURS)
    levels = [level for level in locator.tick_values(norm.vmin, norm.vmax) if norm.vmin < level < norm.vmax]
    line = {"colors": "white", "linestyles": "solid", "linewidths": 0.7, "alpha": 0.8}
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "No contour levels were found")
        lines = axis.contour(x, y, np.ma.masked_invalid(cells), levels, **line)
    axis.clabel(lines, fontsize=6.5 if small else 7.5, fmt="%g")


def _add_veil(axis: Any, x: Any, y: Any, veiled: Any) -> None:
    """Cover the cells of designs with toggles with a light veil, and hatch them."""
    if min(veiled.shape) < 2 or not veiled.any():
        return
    _fill(axis, x, y, np.ma.masked_equal(veiled, False), cmap=ListedColormap([VEIL]))
    outer_x, outer_y = (
        np.concatenate(([1.5 * v[0] - 0.5 * v[1]], v, [1.5 * v[-1] - 0.5 * v[-2]])) for v in (x, y)
    )
    padded = np.pad(veiled.astype(float), 1, mode="edge")
    axis.contourf(outer_x, outer_y, padded, levels=[0.5, 1.5], colors="none", hatches=["////"])


def _add_legend(axes: Sequence[Any], handles: Sequence[Any], beside: bool) -> None:
    """Add a legend below the first column of panels; for codes beside the last, as they have no colour bar."""
    if not handles:
        return
    rows, columns = axes[0].get_gridspec().get_geometry()
    small = rows > 1 or columns > 2
    letters = BESIDE if beside else NARROW if small else BELOW
    for handle in handles:
        handle.set_label(textwrap.fill(handle.get_label(), letters))
    look: dict[str, Any] = {"handles": handles, "frameon": False, "loc": "upper left", "borderaxespad": 0.0}
    if beside and rows > 1:
        axes[0].get_figure().legend(**look | {"loc": "outside right upper"}, fontsize=9)
    elif beside:
        axes[columns - 1].legend(**look, bbox_to_anchor=(1.02, 1.0))
    elif small:
        axes[(rows - 1) * columns].legend(**look, bbox_to_anchor=(0.0, -0.27), fontsize=8.5)
    else:
        together = 3 if sum(len(handle.get_label()) for handle in handles) < BELOW else 1
        axes[0].legend(**look, bbox_to_anchor=(0.0, -0.13), ncols=together)


def _why_absent(codes: Any, flags: Mapping[str, int]) -> str:
    """Return why cells have no value: also designs that assemble may lack one."""
    if codes is None:
        return "does not assemble"
    never = [code for meaning, code in flags.items() if meaning in ("never_assembles", "invalid_input")]
    fails = np.isin(codes, never)
    return " or ".join(["does not assemble"] * bool(fails.any()) + ["has no value"] * bool((~fails).any()))


def _meanings(codes: Any, flags: Mapping[str, int]) -> str:
    """Return what the statuses but the first mean, the most frequent one first."""
    counts = {meaning: int((codes == code).sum()) for meaning, code in list(flags.items())[1:]}
    present = sorted((meaning for meaning in counts if counts[meaning]), key=lambda meaning: -counts[meaning])
    return in_words(", ".join(present))


# -- Draw a variable over one dimension, as lines


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


# -- Draw a variable over one or two dimensions, without matplotlib's global state


def draw(dataset: xr.Dataset, shown: Selection) -> NotebookFigure:
    """Return the figure of a variable, with a panel or line for each assembly mode."""
    figure = NotebookFigure()
    if len(shown.free) == 1:
        figure.set_size_inches(7.2, 4.2)
        draw_lines(figure, shown)
    else:
        draw_maps(figure, shown)
    titles = [title_of(dataset, shown.variable, shown.fixed), modes_of(shown)]
    figure.suptitle("\n".join(filter(None, titles)), fontsize=12)
    figure.supxlabel(constants_of(dataset), fontsize=7.5, color="0.45")
    return figure
