"""Charts of maps: a variable over one dimension as lines, over two as maps; rows as points, cells, corners, fronts."""

from __future__ import annotations

import functools
import itertools
import textwrap
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from matplotlib.colors import LinearSegmentedColormap, ListedColormap, LogNorm
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.ticker import LogLocator, MaxNLocator
from matplotlib.transforms import ScaledTranslation
from scipy.ndimage import binary_opening, distance_transform_edt

from fastlink._text import in_words
from fastlink.maps.best import Choice, Condition, Objective, Reading, Rows
from fastlink.maps.units import DEGREE, RADIAN, flags_of, half_turn
from fastlink.pictures.labels import constants_of, label_of, plain, title_of
from fastlink.pictures.maps import branches_of, name_places, panels_of, sameness
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
    flag_looks,
    limits_of,
    near,
)
from fastlink.space.design_space import DESIGN

if TYPE_CHECKING:
    import xarray as xr

    from fastlink.pictures.maps import Panel, Selection


# -- Draw a variable over two dimensions, as a map, or as a grid of maps


CONTOURS = 8
# Contours that are nearer to each other than so many cells, or this part of a panel, are left out.
CELLS_APART, APART = 3, {False: 1 / 30, True: 1 / 14}
LABELS_APART = {False: 0.06, True: 0.14}  # of a panel
BESIDE, BELOW, NARROW = 32, 60, 34  # letters in a line of a legend, and of a label
COLUMNS = 3  # of a grid
LARGE, SMALL = (5.2, 5.0), (2.75, 2.5)  # panels, in inches
OUTSIDE = 1.5  # inches of titles and legend above and below a grid
ROOM = 14  # a number stands in an area whose middle is this part of a panel from its edge
MANY_CODES = 8  # so many colours are told apart by numbers in the map, too
DOT: dict[str, Any] = {"marker": ".", "color": "0.1", "markersize": 5.0, "linestyle": "none"}


def draw_maps(figure: Any, shown: Selection) -> None:
    """Draw a panel for each branch and each value of the dimension that is split."""
    variable, free, status = shown.variable, shown.free, shown.status
    rows = _wrapped(panels_of(shown))
    panels = [panel for row in rows for panel in row]
    coded = bool(flags_of(variable))
    axes = _axes(figure, shown, rows, coded)
    values = np.stack([panel.array.transpose(free[1], free[0]).values for panel in panels]).astype(float)
    codes, flags = codes_of(shown, panels), {} if status is None else flags_of(status)
    same = sameness(variable, values)
    infinite = np.isinf(values)
    values = np.where(infinite, np.nan, drawable(values))
    # neither has contours, neither grows without bound
    plain = coded or are_counts(values)
    veiled = _veiled(values, codes, flags)
    norm, colours, extend = _scale(variable, values, ~veiled)
    veiled &= not plain
    x, y = (variable[dim].values for dim in free)
    # hatching needs room: cells that are part of two by two such cells
    blocks = binary_opening(veiled, np.ones((1, 2, 2)))
    handles = flag_handles(variable, values)
    numbers = _numbered(variable, values, handles)
    for axis, panel, cells, beyond, veil, block in zip(
        axes, panels, values, infinite, veiled, blocks, strict=True
    ):
        axis.set_facecolor(ABSENT)
        drawn = flag_indices(variable, cells) if coded else near(cells, norm)
        image = _fill(axis, x, y, np.ma.masked_invalid(drawn), norm=norm, cmap=colours)
        if beyond.any():
            _fill(axis, x, y, np.ma.masked_equal(beyond, False), cmap=ListedColormap([INFINITE]))
        if not plain:
            if colours.name != CYCLIC and not same:
                _add_contours(axis, x, y, np.where(veil, np.nan, cells), norm, small=shown.split is not None)
            _add_veil(axis, x, y, block)
            down, along = np.nonzero(veil & ~block)
            axis.plot(x[along], y[down], **DOT)
        for code, number in numbers.items():
            _write_inside(axis, x, y, cells == code, number)
        axis.set_title(panel.title)
        if same:
            _write(axis, same)
    if not coded and not same:
        ticks = MaxNLocator(integer=True) if are_counts(values) else None
        bar = figure.colorbar(image, ax=list(axes), extend=extend, pad=0.02, ticks=ticks)
        bar.set_label(label_of(variable, name=False))
    handles += _reasons(codes, flags, veiled, blocks, infinite, np.isnan(values) & ~infinite)
    _add_legend(axes, handles, beside=coded)


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
    outside = 0.0 if shown.split is None else OUTSIDE
    figure.set_size_inches(legend + width * columns, height * len(rows) + outside)
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
                    name_places(axis.xaxis, shown.names[free[0]])
            if j == 0:
                axis.set_ylabel(textwrap.fill(label_of(variable[free[1]]), letters))
                if free[1] in shown.names:
                    name_places(axis.yaxis, shown.names[free[1]])
            if shown.split is not None:
                axis.xaxis.label.set_fontsize(8)
                axis.yaxis.label.set_fontsize(8)
                axis.title.set_fontsize(9.5 if len(rows) == 1 else 8.5)
                axis.tick_params(labelsize=8)
    return taken


def codes_of(shown: Selection, panels: Sequence[Panel]) -> Any:
    """Return the status of each cell of each panel, or None."""
    if shown.status is None:
        return None
    every = shown.status.values
    return np.stack([every if every.ndim == len(shown.free) else every[panel.place] for panel in panels])


def _veiled(values: Any, codes: Any, flags: Mapping[str, int]) -> Any:
    """Return the cells of designs with toggles, where rates grow without bound; none where all cells are such."""
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


def _fill(axis: Any, x: Any, y: Any, cells: Any, **colours: Any) -> Any:
    return axis.pcolormesh(x, y, cells, shading="nearest", rasterized=True, **colours)


def _write(axis: Any, text: str) -> None:
    """Write a text in the middle of a panel, in place of a scale of colours that would show nothing."""
    box = {"facecolor": "white", "edgecolor": "0.7", "boxstyle": "round,pad=0.5"}
    axis.text(0.5, 0.5, textwrap.fill(text, 30), transform=axis.transAxes, ha="center", va="center", bbox=box)


def _numbered(variable: xr.DataArray, values: Any, handles: Sequence[Any]) -> dict[int, int]:
    """Number the entries of a long legend, and return the number of each code that occurs."""
    present = [code for code in flags_of(variable).values() if (values == code).any()]
    if len(present) <= MANY_CODES:
        return {}
    for number, handle in enumerate(handles, 1):
        handle.set_label(f"{number}  {handle.get_label()}")
    return {code: number for number, code in enumerate(present, 1)}


def _write_inside(axis: Any, x: Any, y: Any, inside: Any, number: int) -> None:
    """Write the number of a code where most of its cells are around, unless it has no room."""
    depth = distance_transform_edt(np.pad(inside, 1))[1:-1, 1:-1]
    row, column = np.unravel_index(int(depth.argmax()), depth.shape)
    if depth[row, column] * ROOM > min(inside.shape):
        look: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": 7, "color": "0.1"}
        axis.text(
            x[column], y[row], str(number), **look, path_effects=[withStroke(linewidth=2.0, foreground="w")]
        )


def _reasons(
    codes: Any, flags: Mapping[str, int], veiled: Any, blocks: Any, infinite: Any, absent: Any
) -> list[Any]:
    """Return the legend of cells under the veil or with a dot, without bound, or without a value."""
    handles: list[Any] = []
    if blocks.any():
        label = _meanings(codes[blocks], flags)
        handles.append(Patch(facecolor=VEIL, edgecolor="0.35", linewidth=0, hatch="////", label=label))
    if (alone := veiled & ~blocks).any():
        handles.append(Line2D([], [], **DOT, label=_meanings(codes[alone], flags)))
    if infinite.any():
        handles.append(Patch(facecolor=INFINITE, label=WITHOUT_BOUND))
    if absent.any():
        label = _why_absent(None if codes is None else codes[absent], flags)
        handles.append(Patch(facecolor=ABSENT, label=label))
    return handles


def _add_contours(axis: Any, x: Any, y: Any, cells: Any, norm: Any, small: bool) -> None:
    """Draw lines of equal values, where they have room."""
    if min(cells.shape) < 2 * CONTOURS or not np.isfinite(cells).any():
        return
    is_log = isinstance(norm, LogNorm)
    locator = LogLocator(subs=(1.0, 2.0, 5.0)) if is_log else MaxNLocator(CONTOURS)
    levels = [level for level in locator.tick_values(norm.vmin, norm.vmax) if norm.vmin < level < norm.vmax]
    scaled = np.log10 if is_log else np.asarray
    with np.errstate(all="ignore"):
        heights, places = scaled(cells), scaled(levels)
        slopes = zip(cells.shape, np.gradient(heights), strict=True)
        rise = np.hypot(*(size * slope for size, slope in slopes))
    step = np.diff(places).min(initial=np.inf)
    steep = rise * max(CELLS_APART / min(cells.shape), APART[small]) > step
    near = [np.abs(heights - place) < 0.5 * step for place in places]
    levels = [level for level, one in zip(levels, near, strict=True) if 2 * (steep & one).sum() <= one.sum()]
    line = {"colors": "white", "linestyles": "solid", "linewidths": 0.7, "alpha": 0.8}
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "No contour levels were found")
        lines = axis.contour(x, y, np.ma.masked_invalid(cells), levels, **line)
    kept: list[Any] = []
    for label in axis.clabel(lines, fontsize=6.5 if small else 7.5, fmt="%g"):
        at = axis.transLimits.transform(label.get_position())
        if any(np.hypot(*(at - one)) < LABELS_APART[small] for one in kept):
            label.remove()
            continue
        kept.append(at)
        label.set_path_effects([withStroke(linewidth=0.9, foreground="0.25")])


def _add_veil(axis: Any, x: Any, y: Any, veiled: Any) -> None:
    """Cover the cells of designs with toggles with a light veil, and hatch them."""
    if not veiled.any():
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
    figure = axes[0].get_figure()
    if beside and rows > 1:
        figure.legend(**look | {"loc": "outside right center"}, fontsize=9)
    elif beside:
        axes[columns - 1].legend(**look, bbox_to_anchor=(1.02, 1.0))
    else:
        axis = axes[(rows - 1) * columns]
        few = not small and sum(len(handle.get_label()) for handle in handles) < BELOW
        under = axis.bbox.y0 - axis.xaxis.get_tightbbox(figure.canvas.get_renderer()).y0
        below = axis.transAxes + ScaledTranslation(0.0, -under / figure.dpi - 0.1, figure.dpi_scale_trans)
        place: dict[str, Any] = {"bbox_to_anchor": (0.0, 0.0), "bbox_transform": below}
        axis.legend(**look, **place, ncols=3 if few else 1, fontsize=8.5 if small else None)


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
MANY_POINTS = 10_000  # from so many to look for the best place of a legend takes longer than to draw them
OVER_EDGE: dict[str, Any] = {"clip_on": False, "zorder": 3.0, "in_layout": False}
MOST_ALONE = 5  # of fewer points none is set apart from its line
BAR = 0.025  # of the height: the bar of a line that grows without bound


def draw_lines(figure: Any, shown: Selection) -> None:
    """Draw a line for each branch and each value of the dimension that is split."""
    variable, (dim,) = shown.variable, shown.free
    axis = figure.subplots()
    x = variable[dim].values
    looks = _looks(shown)
    every = np.array([panel.array.values.astype(float) for panel, _ in looks])
    codes = codes_of(shown, [panel for panel, _ in looks])
    alone = _alone(None if _is_listed(shown) else codes, every)
    for (panel, look), values, apart in zip(looks, drawable(every), alone, strict=True):
        units = variable.attrs.get("units")
        axis.plot(*cut(x, np.where(apart, np.nan, values), units), label=panel.title, **look)
        if apart.any():
            axis.plot(x[apart], values[apart], **DOT | {"color": look["color"]}, **OVER_EDGE)
    beyond = np.isinf(every)
    _shade(axis, x, np.isnan(every).all(axis=0), ABSENT, "does not assemble")
    _shade(axis, x, beyond.any(axis=0) & ~np.isfinite(every).any(axis=0), INFINITE, WITHOUT_BOUND)
    if (others := beyond & np.isfinite(every).any(axis=0)).any():
        # at the upper edge, where the other lines go on below
        for k, ((_, look), there) in enumerate(zip(looks, others, strict=True)):
            _shade(axis, x, there, look["color"], "", 1.0 - BAR * (k + 1))
    _scale_along(axis, shown)
    axis.grid(color="0.9", linewidth=0.8)
    axis.set_axisbelow(True)
    axis.set_xlabel(label_of(variable[dim]))
    axis.set_ylabel(label_of(variable, name=False))
    _scale_across(axis, variable, every)
    named = [
        (handle, label) for handle, label in zip(*axis.get_legend_handles_labels(), strict=True) if label
    ]
    if others.any():
        named.append((Patch(facecolor="0.7"), f"{WITHOUT_BOUND} (a bar above)"))
    if shown.status is not None and alone.any():
        named.append((Line2D([], [], **DOT), _meanings(codes[alone], flags_of(shown.status))))
    if named:
        beside: dict[str, Any] = {"loc": "best" if len(x) < MANY_POINTS else "upper right"}
        if len(named) > MOST_INSIDE:
            beside = {"loc": "upper left", "bbox_to_anchor": (1.01, 1.0), "frameon": False, "fontsize": 9}
            figure.set_size_inches(9.2, 4.2)
        axis.legend(*zip(*named, strict=True), **beside)


def _alone(codes: Any, every: Any) -> Any:
    """Return the values of a status that both neighbours do not share, such as a change point: no line leads there."""
    if codes is None or codes.shape[-1] < MOST_ALONE:
        return np.zeros(every.shape, bool)
    changes = np.pad(np.diff(codes, axis=-1) != 0, ((0, 0), (1, 1)), constant_values=True)
    return changes[:, 1:] & changes[:, :-1] & np.isfinite(every)


def _looks(shown: Selection) -> list[tuple[Panel, dict[str, Any]]]:
    """Return each line and how it is drawn: values by colours of growing lightness, branches by dashes too."""
    rows = panels_of(shown)
    (dim,) = shown.free
    looks: list[tuple[Panel, dict[str, Any]]] = []
    for i, row in enumerate(rows):
        for k, panel in enumerate(row):
            shade = SHADES(0.9 * k / (len(row) - 1)) if len(row) > 1 else LINES[i % len(LINES)]
            marker = "." if shown.variable.sizes[dim] < 40 else ""
            look = {"color": shade, "linestyle": STYLES[i % len(STYLES)], "marker": marker, "linewidth": 1.6}
            if _is_listed(shown):
                look |= {"marker": ".", "linestyle": "none"}
            looks.append((panel, look))
    return looks


def _is_listed(shown: Selection) -> bool:
    """Tell whether the values are those of a list of designs, of which neighbours have nothing in common."""
    return shown.free[0] == DESIGN or shown.free[0] in shown.names


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
        name_places(axis.xaxis, shown.names[dim])
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


def _shade(axis: Any, x: Any, absent: Any, colour: Any, label: str, low: float = 0.0) -> None:
    """Shade where there is no value to draw, half-way to the neighbours that have one."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], absent, [False])).astype(int)))
    if not edges.size:
        return
    middles = np.concatenate((x[:1], 0.5 * (x[:-1] + x[1:]), x[-1:]))
    starts, stops = middles[edges[::2]], middles[edges[1::2]]
    # as one shape: a sample has a span for every third design
    spans = list(zip(starts, stops - starts, strict=True))
    height, extent = axis.get_xaxis_transform(), (low, BAR if low else 1.0)
    axis.broken_barh(spans, extent, transform=height, color=colour, linewidth=0, label=label)
    axis.update_datalim([(starts[0], 0.0), (stops[-1], 0.0)], updatey=False)


# -- Draw a variable over one or two dimensions, without matplotlib's global state


def draw(dataset: xr.Dataset, shown: Selection) -> NotebookFigure:
    """Return the figure of a variable, with a panel or line for each branch."""
    figure = NotebookFigure()
    if len(shown.free) == 1:
        figure.set_size_inches(7.2, 4.2)
        draw_lines(figure, shown)
    else:
        draw_maps(figure, shown)
    figure.suptitle(title_of(dataset, shown.variable, shown.fixed, branches_of(shown)), fontsize=12)
    figure.supxlabel(constants_of(dataset), fontsize=7.5, color="0.45")
    return figure


# -- The rows of a map as points in a plane: one by one where they are few, else counted in cells


#: More rows than this are counted in cells.
MOST_POINTS = 100_000
CELLS = 140
#: A range that is so many times longer than that of its inner 96 % is cut; so many times greater, it is logarithmic.
FAR, WIDE = 5.0, 30.0
#: Of a range: the least that is shown about a front, and the margin.
LEAST_SHOWN, EDGE = 0.005, 0.06


@dataclass
class Column:
    """A variable or input as an axis of a picture."""

    #: Its values.
    array: xr.DataArray
    #: Into what is shown: of degrees, where angles are in degrees.
    factor: float = 1.0
    #: The range that is shown, of logarithms where `logarithmic`.
    low: float = 0.0
    high: float = 1.0
    #: Whether the scale is.
    logarithmic: bool = False

    @property
    def flags(self) -> dict[str, int]:
        """The codes by their meanings."""
        return flags_of(self.array)

    def show_around(self, values: Any) -> None:
        """Show the range of some values and as much again on both sides, as far as there are rows."""
        inside = self.scaled(values)
        low, high = float(inside.min()), float(inside.max())
        span = max(high - low, LEAST_SHOWN * (self.high - self.low))
        self.low = min(low, max(self.low, low - span)) - EDGE * span
        self.high = max(high, min(self.high, high + span)) + EDGE * span

    def label(self, name: bool = True) -> str:
        """Return name, symbol and units."""
        in_degrees = self.array[:0] if self.array.ndim else self.array
        if self.factor != 1.0:
            in_degrees = in_degrees.copy(deep=False).assign_attrs(units=DEGREE)
        return label_of(in_degrees, name)

    def settle(self, values: Any) -> None:
        """Settle scale and range from some of the values."""
        if self.flags:
            self.low, self.high = min(self.flags.values()) - 0.5, max(self.flags.values()) + 0.5
            return
        if values.size and values.min() > 0.0:
            inner = np.percentile(values, (2, 98))
            self.logarithmic = bool(inner[1] > WIDE * inner[0])
        scaled = self.scaled(values)
        low, high, _ = limits_of(scaled, scaled, FAR)
        margin = 0.02 * (high - low)
        self.low, self.high = low - margin, high + margin

    def scaled(self, values: Any) -> Any:
        """Return values as they stand along the axis."""
        return np.log10(values) if self.logarithmic else values

    def edges(self, count: int = CELLS) -> Any:
        """Return the ends of cells along the axis, as values."""
        ends = np.linspace(self.low, self.high, count + 1)
        return 10.0**ends if self.logarithmic else ends

    def places(self, values: Any, count: int = CELLS) -> tuple[Any, Any]:
        """Return the cell of each value, and whether it has one."""
        with np.errstate(all="ignore"):
            share = (self.scaled(values) - self.low) / (self.high - self.low)
        inside = (share >= 0.0) & (share <= 1.0)
        return np.minimum((np.where(inside, share, 0.0) * count).astype(np.int64), count - 1), inside


#: Rows in cells of some columns, and sums, by the names of these.
Cells = dict[tuple[str, ...], Any]


@dataclass
class Cloud:
    """The rows of a map that meet some conditions and have a number in every column."""

    #: What is read.
    columns: list[Column]
    #: The conditions.
    wanted: Sequence[Condition]
    #: Rows and columns, if they are at most `MOST_POINTS`.
    points: Any = None
    #: How many are shown, and how many meet the conditions.
    count: int = 0
    considered: int = 0
    #: How many grow without bound; which are not shown, in words.
    infinite: int = 0
    noted: str = ""
    names: Mapping[str, int] = field(init=False)

    def __post_init__(self) -> None:
        """Read all rows once: their number, scales and ranges."""
        self.names = {str(column.array.name): k for k, column in enumerate(self.columns)}
        held, kept, step = list[Any](), 0, 1
        reading = self._reading()
        for values in self._blocks(reading):
            self.count += len(values)
            held.append(values[::step])
            kept += len(held[-1])
            if kept > 2 * MOST_POINTS:
                held, step = [np.concatenate(held)[::2]], 2 * step
                kept = len(held[0])
        some = np.concatenate(held) if held else np.empty((0, len(self.columns)))
        for column, values in zip(self.columns, some.T, strict=True):
            column.settle(values)
        self.points = some if step == 1 and self.count <= MOST_POINTS else None
        self.considered, self.infinite = reading.tally.considered, reading.tally.infinite
        self.noted = reading.noted()

    def _reading(self) -> Reading:
        arrays = [column.array for column in self.columns]
        choice = Choice([Objective(array, 1.0) for array in arrays], list(self.wanted))
        return Reading(Rows.of(choice.arrays), choice)

    def _blocks(self, reading: Reading) -> Iterator[Any]:
        factors = np.array([column.factor for column in self.columns])
        for _, values in reading:
            yield drawable(values) * factors

    def cells(self, wanted: Sequence[tuple[str, ...]]) -> Cells:
        """Return the rows in each cell of one column, or of two (the second first); sums of a third; in one pass."""
        found = {names: np.zeros((2, *[CELLS] * len(names[:2]))) for names in wanted}
        used = {name for names in wanted for name in names[:2]}
        for values in [self.points] if self.points is not None else self._blocks(self._reading()):
            by_name = {name: values[:, k] for name, k in self.names.items()}
            places = {name: self.columns[self.names[name]].places(by_name[name]) for name in used}
            for names, (counts, sums) in found.items():
                own = [places[name] for name in names[:2]]
                inside = np.logical_and.reduce([one for _, one in own])
                flat = np.ravel_multi_index([cell[inside] for cell, _ in reversed(own)], counts.shape)
                counts += np.bincount(flat, minlength=counts.size).reshape(counts.shape)
                for name in names[2:]:
                    added = np.bincount(flat, by_name[name][inside], minlength=counts.size)
                    sums += added.reshape(counts.shape)
        return found

    def below(self, name: str) -> tuple[Any, Any]:
        """Return values of a column, growing, and how many rows have at most that."""
        k = self.names[name]
        if self.points is not None:
            return np.sort(self.points[:, k]), np.arange(1, self.count + 1)
        edges = self.columns[k].edges()
        counts = np.zeros(len(edges))
        for values in self._blocks(self._reading()):
            counts += np.searchsorted(np.sort(values[:, k]), edges, side="right")
        return edges, counts

    def note(self) -> str:
        """Return how many rows are shown, and why others are not."""
        some = "" if self.count == self.considered else f" of {self.considered:,}"
        return f"{self.count:,}{some} rows{self.noted}"


def column_of(maps: xr.Dataset, name: str, degrees: bool) -> Column:
    """Return a variable or an input as an axis."""
    array = maps[name]
    return Column(array, float(np.rad2deg(1.0)) if degrees and array.attrs.get("units") == RADIAN else 1.0)


# -- Draw the rows of a map as points or cells: two columns, corners of several, cumulative distributions,
#    fronts


FRONT = LINES[1]
#: From few rows to many; the lightest can still be told from white.
CROWD = LinearSegmentedColormap.from_list("crowd", ["#cfd8e6", "#7f9cc0", "#2f5d92", "#0b2545"])
FAINT = LinearSegmentedColormap.from_list("faint", ["#e4e4e4", "#8c8c8c"])
LETTERS = 46
QUARTILES, MIDDLE = (0, 25, 50, 75, 100), 50.0
#: Marks of a front that are so many have no rims.
MANY_MARKS = 400


def draw_scatter(cloud: Cloud, front: Any = None) -> Any:
    """Draw the rows over two columns; a third colours them; those of a front are marked and joined."""
    figure = NotebookFigure(figsize=(7.2, 5.2))
    axis = figure.subplots()
    names = tuple(cloud.names)
    x, y, *third = cloud.columns
    if front is not None:
        for column, values in zip((x, y), front.T, strict=True):
            column.show_around(values)
    counted = cloud.cells([names] if cloud.points is None else [])
    image = _fill_with_rows(axis, cloud, names, counted, faint=front is not None)
    axis.set_xlabel(textwrap.fill(x.label(), LETTERS + 14))
    axis.set_ylabel(textwrap.fill(y.label(), LETTERS))
    if front is not None:
        _mark(axis, front.T, joined=True)
        handles = [
            Line2D([], [], **_dots(False), label="all rows"),
            Line2D([], [], **_dots(True), label="Pareto front"),
        ]
        axis.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, frameon=False)
    elif third and third[0].flags:
        _code_legend(axis, third[0], cloud.points[:, 2])
    elif image is not None:
        label = (
            "mean of " * (cloud.points is None) + third[0].label(name=False) if third else "rows in a cell"
        )
        figure.colorbar(image, ax=axis, pad=0.02).set_label(label)
    return figure


def draw_corner(cloud: Cloud, front: Any = None) -> Any:
    """Draw every pair of columns as a scatter, and each column by itself as a histogram."""
    count = len(cloud.columns)
    size = 1.2 + min(2.6, 9.6 / count) * count
    figure = NotebookFigure(figsize=(size, 0.92 * size))
    grid = figure.subplots(count, count, squeeze=False)
    names = list(cloud.names)
    pairs = [(names[j], names[i]) for i in range(count) for j in range(i)] if cloud.points is None else []
    counted = cloud.cells([*((name,) for name in names), *pairs])
    for i, j in itertools.product(range(count), repeat=2):
        axis = grid[i][j]
        if j > i:
            axis.set_visible(False)
        elif i == j:
            _histogram(axis, cloud.columns[i], counted[names[i],][0])
        else:
            _fill_with_rows(axis, cloud, (names[j], names[i]), counted, faint=front is not None)
            if front is not None:
                _mark(axis, front[:, [j, i]].T, joined=False)
        _name_sides(axis, cloud.columns, i, j)
    if count > 2:
        arrays = [(column.label(name=False), column.array) for column in cloud.columns]
        words = [f"{symbol}: {plain(one.attrs.get('long_name', one.name))}" for symbol, one in arrays]
        text = "\n".join(words)
        figure.text(0.99, 0.9, text, ha="right", va="top", fontsize=8.5, linespacing=1.5, in_layout=False)
    return figure


def _name_sides(axis: Any, columns: Sequence[Column], i: int, j: int) -> None:
    """Label a panel of a corner at the outer sides."""
    axis.tick_params(labelsize=7.5, labelbottom=i == len(columns) - 1, labelleft=j == 0 < i)
    for label in axis.get_xticklabels():
        label.set_rotation(30)
    if i == len(columns) - 1:
        axis.set_xlabel(columns[j].label(name=False), fontsize=9)
    if j == 0 < i:
        axis.set_ylabel(columns[i].label(name=False), fontsize=9)


def _fill_with_rows(axis: Any, cloud: Cloud, names: tuple[str, ...], counted: Cells, faint: bool) -> Any:
    """Draw points, or cells where rows are many; return what a colour bar belongs to."""
    x, y, *third = (cloud.columns[cloud.names[name]] for name in names)
    _scales(axis, x, y)
    if cloud.points is None:
        counts, sums = counted[names]
        cells = np.ma.masked_equal(counts, 0.0)
        look: dict[str, Any] = {
            "norm": LogNorm(1.0, max(2.0, counts.max())),
            "cmap": FAINT if faint else CROWD,
        }
        if third:
            cells = np.ma.masked_array(sums / np.maximum(counts, 1.0), counts == 0.0)
            norm, colours, _ = colours_of(cells.filled(np.nan), np.ones(cells.shape, bool), None)
            look = {"norm": norm, "cmap": colours}
        return axis.pcolormesh(
            x.edges(), y.edges(), cells, rasterized=True, alpha=0.6 if faint else 1.0, **look
        )
    values = cloud.points[:, [cloud.names[name] for name in names]].T
    size = float(np.clip(3e4 / max(1, cloud.count), 1.0, 16.0))
    look = {"s": size, "linewidths": 0.0, "rasterized": cloud.count > 2000}
    if third and third[0].flags:
        colour_of = {code: colour for code, _, colour in flag_looks(third[0].array)}
        axis.scatter(values[0], values[1], c=[colour_of[int(one)] for one in values[2]], **look)
        return None
    if third:
        norm, shades, _ = colours_of(values[2][None], np.ones((1, cloud.count), bool), None)
        return axis.scatter(values[0], values[1], c=near(values[2], norm), norm=norm, cmap=shades, **look)
    axis.scatter(values[0], values[1], color="0.72" if faint else LINES[0], alpha=0.7, **look)
    return None


def _scales(axis: Any, x: Column, y: Column) -> None:
    """Set scales and ranges of both sides; codes have their meanings."""
    for column, side, limit in ((x, axis.xaxis, axis.set_xlim), (y, axis.yaxis, axis.set_ylim)):
        if column.logarithmic:
            (axis.set_xscale if side is axis.xaxis else axis.set_yscale)("log")
        limit(*column.edges(1))
        if column.flags:
            words = [textwrap.shorten(in_words(meaning), 24) for meaning in column.flags]
            side.set_ticks(list(column.flags.values()), words, fontsize=8)
    axis.grid(color="0.92", linewidth=0.7)
    axis.set_axisbelow(True)


def _dots(front: bool) -> dict[str, Any]:
    marks = {"linestyle": "-" if front else "none", "linewidth": 1.0, "marker": "o"}
    return {**marks, "color": FRONT if front else "0.72", "markersize": 5 if front else 4}


def _mark(axis: Any, points: Any, joined: bool) -> None:
    """Mark the rows of a front."""
    look = _dots(True) | ({} if joined else {"linestyle": "none"})
    order = np.argsort(points[0])
    rim = {"markeredgecolor": "white", "markeredgewidth": 0.4, "markersize": 4.0}
    if points.shape[1] > MANY_MARKS:  # rims of neighbours would cover all that is between them
        rim = {"markeredgewidth": 0.0, "markersize": 3.0}
    axis.plot(*points[:, order], **look | rim)


def _code_legend(axis: Any, column: Column, values: Any) -> None:
    """Name the colours of a code, those that occur."""
    handles = [
        Line2D([], [], linestyle="none", marker="o", color=colour, label=meaning)
        for code, meaning, colour in flag_looks(column.array)
        if (values == code).any()
    ]
    axis.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False, fontsize=9)


def _histogram(axis: Any, column: Column, counts: Any) -> None:
    """Draw how many rows have which value."""
    few = counts.reshape(-1, 4).sum(axis=1)
    axis.stairs(few, column.edges()[::4], fill=True, color=LINES[0], alpha=0.75)
    if column.logarithmic:
        axis.set_xscale("log")
    axis.set_xlim(*column.edges(1))
    axis.set_yticks([])
    axis.spines["left"].set_visible(False)


def draw_cumulative(clouds: Sequence[Cloud]) -> Any:
    """Draw the share of rows with at most a value, one picture for each unit."""
    groups: dict[str, list[tuple[Cloud, Column]]] = {}
    for cloud in clouds:
        (column,) = cloud.columns
        groups.setdefault(_unit(column), []).append((cloud, column))
    figure = NotebookFigure(figsize=(1.6 + 5.0 * len(groups), 4.4))
    axes = figure.subplots(1, len(groups), sharey=True, squeeze=False)[0]
    for axis, (unit, group) in zip(axes, groups.items(), strict=True):
        for k, (cloud, column) in enumerate(group):
            infinite = cloud.infinite
            values, counts = cloud.below(str(column.array.name))
            remark = f" ({_percent(infinite, cloud.count + infinite)} without bound)" if infinite else ""
            look = {"color": LINES[k % len(LINES)], "linestyle": STYLES[k % len(STYLES)], "linewidth": 1.7}
            label = f"{column.label(name=False)}{remark}"
            drawn = axis.plot if cloud.points is None else functools.partial(axis.step, where="post")
            drawn(values, 100.0 * counts / max(1, cloud.count + infinite), label=label, **look)
        if all(column.logarithmic for _, column in group):
            axis.set_xscale("log")
        ends = np.array([column.edges(1) for _, column in group])
        axis.set_xlim(ends[:, 0].min(), ends[:, 1].max())
        axis.set(ylim=(0.0, 100.0), yticks=QUARTILES)
        axis.axhline(MIDDLE, color="0.6", linewidth=0.8)
        axis.grid(color="0.9", linewidth=0.8)
        axis.set_axisbelow(True)
        axis.set_xlabel(textwrap.fill(group[0][1].label(), LETTERS + 14) if len(group) == 1 else unit)
        if len(group) > 1 or any(cloud.infinite for cloud, _ in group):
            axis.legend(loc="best", fontsize=9)
    axes[0].set_ylabel("share of rows with at most this [%]")
    return figure


def _unit(column: Column) -> str:
    return column.label(name=False).rpartition(" [")[2].rstrip("]") if "[" in column.label(False) else ""


def _percent(part: int, whole: int) -> str:
    return f"{100.0 * part / max(1, whole):.3g} %"
