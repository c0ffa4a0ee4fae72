"""Draw a variable over one or two dimensions, without matplotlib's global state."""

from __future__ import annotations

import contextlib
import textwrap
import warnings
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import ListedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, MaxNLocator

from fastlink.plot.colours import (
    CYCLIC,
    are_counts,
    colours_of,
    count_colours,
    flag_colours,
    flag_handles,
    flag_indices,
    limits_of,
)
from fastlink.plot.labels import constants_of, label_of, title_of

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["draw", "style"]

MOST_CELLS = 1600  # along each side, more than the pixels of a picture
ABSENT, INFINITE = "0.78", "0.45"
WITHOUT_BOUND = "grows without bound"
VEIL = (1.0, 1.0, 1.0, 0.55)
LINES = ("#0b5fa5", "#d1495b", "#2a9d5c", "#8a5fbf")
CONTOURS = 8
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


def draw(
    dataset: xr.Dataset, variable: xr.DataArray, free: Sequence[str], fixed: Mapping[str, float]
) -> Figure:
    """Return the figure of a variable, with a panel or line for each assembly mode."""
    for dim in free:
        variable = variable.sortby(dim)
    figure = Figure(layout="constrained")
    FigureCanvasAgg(figure)
    if len(free) == 1:
        figure.set_size_inches(7.2, 4.2)
        _draw_lines(figure, variable, free[0])
    else:
        step = {dim: slice(None, None, -(-variable.sizes[dim] // MOST_CELLS)) for dim in free}
        variable = variable.isel(step)
        _draw_maps(figure, variable, free, _status(dataset, variable, free, fixed))
    figure.suptitle(title_of(dataset, variable, fixed), fontsize=12)
    figure.supxlabel(constants_of(dataset), fontsize=7.5, color="0.45")
    return figure


# -- maps ------------------------------------------------------------------------------------------


def _status(
    dataset: xr.Dataset, variable: xr.DataArray, free: Sequence[str], fixed: Mapping[str, float]
) -> xr.DataArray | None:
    """Return the status of the designs of a map, or None if its cells are not designs."""
    if variable.name == "status" or "status" not in dataset:
        return None
    status = dataset["status"]
    status = status.sel({dim: value for dim, value in fixed.items() if dim in status.dims})
    if set(status.dims) != set(free) or "flag_values" not in status.attrs:
        return None
    return status.sel({dim: variable[dim] for dim in free}).transpose(free[1], free[0])


def _draw_maps(
    figure: Figure, variable: xr.DataArray, free: Sequence[str], status: xr.DataArray | None
) -> None:
    panels = _panels(variable)
    is_code = "flag_meanings" in variable.attrs
    figure.set_size_inches((3.0 if is_code else 1.6) + 5.2 * len(panels), 5.0)
    axes = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
    values = np.stack([panel.transpose(free[1], free[0]).values for _, panel in panels]).astype(float)
    infinite = np.isinf(values)
    values[infinite] = np.nan
    is_count = not is_code and are_counts(values)
    veiled = _veiled(values, status)
    norm, colours, extend = _scale(variable, values, ~veiled)
    veiled &= not (is_code or is_count)  # neither grows without bound
    x, y = (variable[dim].values for dim in free)
    for axis, (title, _), cells, beyond in zip(axes, panels, values, infinite, strict=True):
        axis.set_facecolor(ABSENT)
        drawn = flag_indices(variable, cells) if is_code else cells
        image = _fill(axis, x, y, np.ma.masked_invalid(drawn), norm=norm, cmap=colours)
        if beyond.any():
            _fill(axis, x, y, np.ma.masked_equal(beyond, False), cmap=ListedColormap([INFINITE]))
        if not (is_code or is_count):
            if colours.name != CYCLIC:
                _add_contours(axis, x, y, np.where(veiled, np.nan, cells), norm)
            _add_veil(axis, x, y, veiled)
        axis.set_xlabel(label_of(variable[free[0]]))
        axis.set_title(title)
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
    veiled = present & (status.values != status.attrs["flag_values"][0])
    return veiled & (present & ~veiled).any()


def _scale(variable: xr.DataArray, values: Any, regular: Any) -> tuple[Any, Any, str]:
    """Return norm, colour map and open ends for codes, counts or numbers."""
    if "flag_meanings" in variable.attrs:
        return flag_colours(variable)
    if are_counts(values):
        return count_colours(values)
    return colours_of(values, regular, variable.attrs.get("units") == "rad")


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
    pairs = zip(status.attrs["flag_values"], status.attrs["flag_meanings"].split(), strict=True)
    never = [code for code, meaning in pairs if meaning in ("never_assembles", "invalid_input")]
    fails = np.isin(status.values[absent], never)
    return " or ".join(["does not assemble"] * bool(fails.any()) + ["has no value"] * bool((~fails).any()))


def _meanings(status: xr.DataArray, veiled: Any) -> str:
    """Return what the statuses but the first mean, the most frequent one first."""
    pairs = zip(status.attrs["flag_values"], status.attrs["flag_meanings"].split(), strict=True)
    counts = {meaning: int((status.values[veiled] == code).sum()) for code, meaning in list(pairs)[1:]}
    present = sorted((meaning for meaning in counts if counts[meaning]), key=lambda meaning: -counts[meaning])
    return ", ".join(present).replace("_", " ")


def _panels(variable: xr.DataArray) -> list[tuple[str, xr.DataArray]]:
    """Return title and values of each assembly mode, or of all if they agree."""
    if "branch" not in variable.dims:
        scalar = variable.coords.get("branch")
        return [("" if scalar is None else f"assembly mode {scalar.item()}", variable)]
    parts = [(f"assembly mode {b.item()}", variable.sel(branch=b)) for b in variable["branch"]]
    first = parts[0][1].values
    alike = all(np.allclose(part.values, first, rtol=1e-9, atol=0.0, equal_nan=True) for _, part in parts)
    if alike and len(parts) > 1:
        modes = " and ".join(str(b.item()) for b in variable["branch"])
        return [(f"assembly modes {modes} (they agree)", parts[0][1])]
    return parts


# -- lines -----------------------------------------------------------------------------------------


def _draw_lines(figure: Any, variable: xr.DataArray, dim: str) -> None:
    axis = figure.subplots()
    coordinate = variable[dim]
    x = coordinate.values
    panels = _panels(variable)
    marks: dict[str, Any] = {"marker": "." if len(x) < 40 else ""}
    if dim == "design":
        marks = {"marker": ".", "linestyle": "none"}
    for (title, panel), colour in zip(panels, LINES, strict=False):
        cut_x, values = _cut(x, panel.values.astype(float), variable.attrs.get("units"))
        axis.plot(cut_x, values, color=colour, label=title, linewidth=1.6, **marks)
    every = np.array([panel.values.astype(float) for _, panel in panels])
    _shade(axis, x, np.isnan(every).all(axis=0), ABSENT, "does not assemble")
    _shade(axis, x, np.isinf(every).any(axis=0), INFINITE, WITHOUT_BOUND)
    if dim != "design":
        axis.set_xlim(x[0], x[-1])
    if coordinate.attrs.get("units") == "rad" and x[0] >= 0.0 and x[-1] <= 2.0 * np.pi:
        axis.set_xlim(0.0, 2.0 * np.pi)
        ticks = (r"$0$", r"$\pi/2$", r"$\pi$", r"$3\pi/2$", r"$2\pi$")
        axis.set_xticks(np.linspace(0.0, 2.0 * np.pi, 5), ticks)
    if "flag_meanings" in variable.attrs:
        names = [meaning.replace("_", " ") for meaning in variable.attrs["flag_meanings"].split()]
        axis.set_yticks(variable.attrs["flag_values"], names)
        axis.set_ylim(-0.5, max(variable.attrs["flag_values"]) + 0.5)
    axis.grid(color="0.9", linewidth=0.8)
    axis.set_axisbelow(True)
    axis.set_xlabel(label_of(coordinate))
    axis.set_ylabel(label_of(variable, name=False))
    if "flag_meanings" not in variable.attrs:
        every = np.concatenate([panel.values for _, panel in panels])
        low, high, extend = limits_of(every, every, 50.0)
        if extend != "neither":
            axis.set_ylim(low - 0.05 * (high - low), high + 0.05 * (high - low))
    handles, labels = axis.get_legend_handles_labels()
    if any(labels):
        named = [(handle, label) for handle, label in zip(handles, labels, strict=True) if label]
        axis.legend(*zip(*named, strict=True))


def _cut(x: Any, values: Any, units: str | None) -> tuple[Any, Any]:
    """Return a curve, cut where an angle passes from pi to -pi."""
    if units != "rad":
        return x, values
    jumps = np.flatnonzero(np.abs(np.diff(values)) > np.pi) + 1
    return np.insert(x.astype(float), jumps, x[jumps]), np.insert(values, jumps, np.nan)


def _shade(axis: Any, x: Any, absent: Any, colour: str, label: str) -> None:
    """Shade where there is no value to draw, half-way to the neighbours that have one."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], absent, [False])).astype(int)))
    middles = np.concatenate((x[:1], 0.5 * (x[:-1] + x[1:]), x[-1:]))
    for number, (start, stop) in enumerate(edges.reshape(-1, 2)):
        shown = "_further" if number else label  # matplotlib leaves out labels with an underscore
        axis.axvspan(middles[start], middles[stop], color=colour, linewidth=0, label=shown)
