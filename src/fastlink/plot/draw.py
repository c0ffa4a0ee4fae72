"""Draw a variable over one or two dimensions, without matplotlib's global state."""

from __future__ import annotations

import contextlib
import textwrap
import warnings
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import ListedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, MaxNLocator

from fastlink.maps.flags import flags_of
from fastlink.maps.units import RADIAN, half_turn
from fastlink.plot.colours import (
    CYCLIC,
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
from fastlink.plot.labels import constants_of, label_of, plain, title_of
from fastlink.plot.selection import Selection
from fastlink.space.design_space import BRANCH

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["LINES", "cut", "draw", "style"]

MOST_NAMES = 24  # along one side
QUARTERS = (r"$0$", r"$\pi/2$", r"$\pi$", r"$3\pi/2$", r"$2\pi$")
ABSENT, INFINITE = "0.78", "0.45"
WITHOUT_BOUND = "grows without bound"
VEIL = (1.0, 1.0, 1.0, 0.55)
LINES = ("#0b5fa5", "#d1495b", "#2a9d5c", "#8a5fbf")
CONTOURS = 8
MANY = 10_000  # points from which to look for the best place of a legend takes longer than to draw them
BESIDE, BELOW = 32, 60  # letters in a line of a legend
STYLE = {
    "font.size": 10,
    "axes.titlesize": 10.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "hatch.color": "0.35",
    "hatch.linewidth": 0.5,
    "savefig.dpi": 160,
    "svg.hashsalt": "fastlink",  # equal pictures are equal files
}


@contextlib.contextmanager
def style() -> Iterator[None]:
    """Draw with settings of our own, and restore the user's."""
    with matplotlib.rc_context():
        matplotlib.rcParams.update({**matplotlib.rcParamsDefault, **STYLE, "backend": "agg"})
        yield


def draw(dataset: xr.Dataset, shown: Selection) -> Figure:
    """Return the figure of a variable, with a panel or line for each assembly mode."""
    figure = Figure(layout="constrained")
    FigureCanvasAgg(figure)
    if len(shown.free) == 1:
        figure.set_size_inches(7.2, 4.2)
        _draw_lines(figure, shown)
    else:
        _draw_maps(figure, shown)
    figure.suptitle(title_of(dataset, shown.variable, shown.fixed), fontsize=12)
    figure.supxlabel(constants_of(dataset), fontsize=7.5, color="0.45")
    return figure


def _name_places(axis: Any, names: Sequence[str], turned: bool) -> None:
    """Label an axis by the names of its places, not more than fit on it."""
    step = -(-len(names) // MOST_NAMES)
    shown = [textwrap.shorten(plain(name), 24, placeholder="...") for name in names[::step]]
    axis.set_ticks(range(0, len(names), step), shown, rotation=30 if turned else 0, ha="right")


# -- maps ------------------------------------------------------------------------------------------


def _draw_maps(figure: Figure, shown: Selection) -> None:
    variable, free, status = shown.variable, shown.free, shown.status
    panels = _panels(variable)
    is_code = bool(flags_of(variable))
    figure.set_size_inches((3.0 if is_code else 1.6) + 5.2 * len(panels), 5.0)
    axes = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
    values = np.stack([panel.transpose(free[1], free[0]).values for _, panel in panels]).astype(float)
    infinite = np.isinf(values)
    values = np.where(infinite, np.nan, drawable(values))
    is_count = not is_code and are_counts(values)
    veiled = _veiled(values, status)
    norm, colours, extend = _scale(variable, values, ~veiled)
    veiled &= not (is_code or is_count)  # neither grows without bound
    x, y = (variable[dim].values for dim in free)
    for axis, (title, _), cells, beyond in zip(axes, panels, values, infinite, strict=True):
        axis.set_facecolor(ABSENT)
        drawn = flag_indices(variable, cells) if is_code else near(cells, norm)
        image = _fill(axis, x, y, np.ma.masked_invalid(drawn), norm=norm, cmap=colours)
        if beyond.any():
            _fill(axis, x, y, np.ma.masked_equal(beyond, False), cmap=ListedColormap([INFINITE]))
        if not (is_code or is_count):
            if colours.name != CYCLIC:
                _add_contours(axis, x, y, np.where(veiled, np.nan, cells), norm)
            _add_veil(axis, x, y, veiled)
        axis.set_xlabel(label_of(variable[free[0]]))
        axis.set_title(title)
        if free[0] in shown.names:
            _name_places(axis.xaxis, shown.names[free[0]], turned=True)
    if free[1] in shown.names:
        _name_places(axes[0].yaxis, shown.names[free[1]], turned=False)
    axes[0].set_ylabel(label_of(variable[free[1]]))
    handles = flag_handles(variable, values) if is_code else []
    if not is_code:
        ticks = MaxNLocator(integer=True) if is_count else None
        bar = figure.colorbar(image, ax=list(axes), extend=extend, pad=0.02, ticks=ticks)
        bar.set_label(label_of(variable, name=False))
    handles += _reasons(status, veiled, infinite, np.isnan(values) & ~infinite)
    _add_legend(axes[-1] if is_code else axes[0], handles, beside=is_code)


def _veiled(values: Any, status: xr.DataArray | None) -> Any:
    """Return the cells of designs with toggles, where rates grow without bound.

    There are none where all cells are such: a veil over all of them would distinguish nothing.
    """
    if status is None:
        return np.zeros(values.shape[1:], bool)
    present = np.isfinite(values).any(axis=0)
    veiled = present & (status.values != next(iter(flags_of(status).values())))
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


def _reasons(status: xr.DataArray | None, veiled: Any, infinite: Any, absent: Any) -> list[Patch]:
    """Return the legend of cells under the veil, without bound, or without a value."""
    handles = []
    if veiled.any() and status is not None:
        label = _meanings(status, veiled)
        handles.append(Patch(facecolor=VEIL, edgecolor="0.35", linewidth=0, hatch="////", label=label))
    if infinite.any():
        handles.append(Patch(facecolor=INFINITE, label=WITHOUT_BOUND))
    if absent.any():
        handles.append(Patch(facecolor=ABSENT, label=_why_absent(status, absent.any(axis=0))))
    return handles


def _add_contours(axis: Any, x: Any, y: Any, cells: Any, norm: Any) -> None:
    if min(cells.shape) < 2 * CONTOURS or not np.isfinite(cells).any():
        return
    locator = LogLocator(subs=(1.0, 2.0, 5.0)) if isinstance(norm, LogNorm) else MaxNLocator(CONTOURS)
    levels = [level for level in locator.tick_values(norm.vmin, norm.vmax) if norm.vmin < level < norm.vmax]
    line = {"colors": "white", "linestyles": "solid", "linewidths": 0.7, "alpha": 0.8}
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "No contour levels were found")
        lines = axis.contour(x, y, np.ma.masked_invalid(cells), levels, **line)
    axis.clabel(lines, fontsize=7.5, fmt="%g")


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


def _add_legend(axis: Any, handles: Sequence[Any], beside: bool) -> None:
    """Add a legend below the axes; for codes beside them, as they have no colour bar."""
    for handle in handles:
        handle.set_label(textwrap.fill(handle.get_label(), BESIDE if beside else BELOW))
    if not handles:
        return
    if beside:
        place: dict[str, Any] = {"bbox_to_anchor": (1.02, 1.0)}
    else:
        columns = 3 if sum(len(handle.get_label()) for handle in handles) < BELOW else 1
        place = {"bbox_to_anchor": (0.0, -0.13), "ncols": columns}
    axis.legend(handles=handles, loc="upper left", frameon=False, borderaxespad=0.0, **place)


def _why_absent(status: xr.DataArray | None, absent: Any) -> str:
    """Return why cells have no value: also designs that assemble may lack one."""
    if status is None:
        return "does not assemble"
    never = [
        code for meaning, code in flags_of(status).items() if meaning in ("never_assembles", "invalid_input")
    ]
    fails = np.isin(status.values[absent], never)
    return " or ".join(["does not assemble"] * bool(fails.any()) + ["has no value"] * bool((~fails).any()))


def _meanings(status: xr.DataArray, veiled: Any) -> str:
    """Return what the statuses but the first mean, the most frequent one first."""
    others = list(flags_of(status).items())[1:]
    counts = {meaning: int((status.values[veiled] == code).sum()) for meaning, code in others}
    present = sorted((meaning for meaning in counts if counts[meaning]), key=lambda meaning: -counts[meaning])
    return ", ".join(present).replace("_", " ")


def _panels(variable: xr.DataArray) -> list[tuple[str, xr.DataArray]]:
    """Return title and values of each assembly mode, or of all if they agree."""
    numbers = np.atleast_1d(variable[BRANCH].values).tolist() if BRANCH in variable.coords else []
    if BRANCH not in variable.dims:
        return [(f"assembly mode {numbers[0]}" if numbers else "", variable)]
    count = variable.sizes[BRANCH]
    titles = [f"assembly mode {b}" for b in numbers] or [
        f"branch {k} of {count}" for k in range(1, count + 1)
    ]
    parts = [(title, variable.isel({BRANCH: k})) for k, title in enumerate(titles)]
    first = parts[0][1].values
    alike = all(np.allclose(part.values, first, rtol=1e-9, atol=0.0, equal_nan=True) for _, part in parts)
    if alike and len(parts) > 1 and numbers:
        return [(f"assembly modes {' and '.join(map(str, numbers))} (they agree)", parts[0][1])]
    return parts


# -- lines -----------------------------------------------------------------------------------------


def _draw_lines(figure: Any, shown: Selection) -> None:
    variable, (dim,) = shown.variable, shown.free
    axis = figure.subplots()
    coordinate = variable[dim]
    x = coordinate.values
    panels = _panels(variable)
    marks: dict[str, Any] = {"marker": "." if len(x) < 40 else ""}
    if dim == "design" or dim in shown.names:
        marks = {"marker": ".", "linestyle": "none"}
    for (title, panel), colour in zip(panels, LINES, strict=False):
        cut_x, values = cut(x, drawable(panel.values.astype(float)), variable.attrs.get("units"))
        axis.plot(cut_x, values, color=colour, label=title, linewidth=1.6, **marks)
    every = np.array([panel.values.astype(float) for _, panel in panels])
    _shade(axis, x, np.isnan(every).all(axis=0), ABSENT, "does not assemble")
    _shade(axis, x, np.isinf(every).any(axis=0), INFINITE, WITHOUT_BOUND)
    _scale_along(axis, shown)
    if flags := flags_of(variable):
        axis.set_yticks(list(flags.values()), [meaning.replace("_", " ") for meaning in flags])
        axis.set_ylim(min(flags.values()) - 0.5, max(flags.values()) + 0.5)
    axis.grid(color="0.9", linewidth=0.8)
    axis.set_axisbelow(True)
    axis.set_xlabel(label_of(coordinate))
    axis.set_ylabel(label_of(variable, name=False))
    if not flags:
        every = drawable(np.concatenate([panel.values for _, panel in panels]).astype(float))
        low, high, extend = limits_of(every, every, 50.0)
        if extend != "neither":
            axis.set_ylim(low - 0.05 * (high - low), high + 0.05 * (high - low))
    handles, labels = axis.get_legend_handles_labels()
    if any(labels):
        named = [(handle, label) for handle, label in zip(handles, labels, strict=True) if label]
        axis.legend(*zip(*named, strict=True), loc="best" if len(x) < MANY else "upper right")


def _scale_along(axis: Any, shown: Selection) -> None:
    """Set range and ticks of the axis that the lines run along: a turn has its quarters."""
    (dim,) = shown.free
    along = shown.variable[dim]
    x, half = along.values, half_turn(along.attrs.get("units"))
    if dim in shown.names:
        _name_places(axis.xaxis, shown.names[dim], turned=True)
    elif half is not None and x[0] >= 0.0 and x[-1] <= 2.0 * half:
        axis.set_xlim(0.0, 2.0 * half)
        ticks = QUARTERS if along.attrs["units"] == RADIAN else None
        axis.set_xticks(np.linspace(0.0, 2.0 * half, 5), ticks)
    elif dim != "design" and x[0] < x[-1]:
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
