"""Draw a variable over one or two dimensions, by matplotlib's Agg alone and without its global state."""

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
    are_counts,
    colours_of,
    count_colours,
    flag_colours,
    flag_handles,
    flag_places,
    limits_of,
)
from fastlink.plot.labels import constants_of, label_of, title_of

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["draw", "kinds", "style"]

MOST_CELLS = 1600  # along each side: more than a picture has pixels
ABSENT, ENDLESS = "0.78", "0.45"
WITHOUT_BOUND = "grows without bound"
VEIL = (1.0, 1.0, 1.0, 0.55)
LINES = ("#0b5fa5", "#d1495b", "#2a9d5c", "#8a5fbf")
CONTOURS = 8
BESIDE, BELOW = 32, 60  # letters to a line of a legend
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


def kinds() -> Mapping[str, str]:
    """Return the kinds of pictures that can be written, by their endings."""
    found: Mapping[str, str] = FigureCanvasAgg.get_supported_filetypes()
    return found


@contextlib.contextmanager
def style() -> Iterator[None]:
    """Draw with the same settings whatever the user's own are, and leave those as they were."""
    with matplotlib.rc_context():
        matplotlib.rcParams.update({**matplotlib.rcParamsDefault, **STYLE, "backend": "agg"})
        yield


def draw(
    dataset: xr.Dataset, variable: xr.DataArray, free: Sequence[str], fixed: Mapping[str, float]
) -> Figure:
    """Return the figure of a variable over its free dimensions, in panels or lines by assembly mode."""
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
    """Return the status of the designs that a map shows, or None where its cells are no designs."""
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
    figure.set_size_inches((3.0 if "flag_meanings" in variable.attrs else 1.6) + 5.2 * len(panels), 5.0)
    axes = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
    values = np.stack([panel.transpose(free[1], free[0]).values for _, panel in panels]).astype(float)
    endless = np.isinf(values)
    values[endless] = np.nan
    x, y = (variable[dim].values for dim in free)
    # where a design does not rotate fully, rates grow without bound towards the ends of its motion
    odd = np.zeros(values.shape[1:], bool)
    if status is not None:
        there = np.isfinite(values).any(axis=0)
        odd = (status.values != status.attrs["flag_values"][0]) & there
        odd &= (there & ~odd).any()  # a veil over all that there is tells nothing apart
    flags, counts = "flag_meanings" in variable.attrs, are_counts(values)
    if flags:
        norm, colours, extend = flag_colours(variable)
    elif counts:
        norm, colours, extend = count_colours(values)
    else:
        norm, colours, extend = colours_of(values, ~odd, variable.attrs.get("units") == "rad")
    odd &= not (flags or counts)  # neither grows without bound
    for axis, (title, _), short_repr, beyond in zip(axes, panels, values, endless, strict=True):
        axis.set_facecolor(ABSENT)
        image = axis.pcolormesh(
            x,
            y,
            np.ma.masked_invalid(flag_places(variable, short_repr) if flags else short_repr),
            norm=norm,
            cmap=colours,
            shading="nearest",
            rasterized=True,
        )
        if beyond.any():
            cells = np.ma.masked_equal(beyond, False)
            axis.pcolormesh(x, y, cells, cmap=ListedColormap([ENDLESS]), shading="nearest", rasterized=True)
        if not (flags or counts):
            _add_contours(
                axis, x, y, np.where(odd, np.nan, short_repr), norm, colours.name == "twilight_shifted"
            )
            _veil(axis, x, y, odd)
        axis.set_xlabel(label_of(variable[free[0]]))
        axis.set_title(title)
    axes[0].set_ylabel(label_of(variable[free[1]]))
    handles = flag_handles(variable, values) if flags else []
    if odd.any() and status is not None:
        handles.append(
            Patch(facecolor=VEIL, edgecolor="0.35", linewidth=0, hatch="////", label=_meanings(status, odd))
        )
    if endless.any():
        handles.append(Patch(facecolor=ENDLESS, label=WITHOUT_BOUND))
    absent = np.isnan(values) & ~endless
    if absent.any():
        handles.append(Patch(facecolor=ABSENT, label=_why_absent(status, absent.any(axis=0))))
    if not flags:
        ticks = MaxNLocator(integer=True) if counts else None
        bar = figure.colorbar(image, ax=list(axes), extend=extend, pad=0.02, ticks=ticks)
        bar.set_label(label_of(variable, name=False))
    _add_legend(axes[-1] if flags else axes[0], handles, beside=flags)


def _add_contours(axis: Any, x: Any, y: Any, short_repr: Any, norm: Any, cyclic: bool) -> None:
    if min(short_repr.shape) < 2 * CONTOURS or not np.isfinite(short_repr).any() or cyclic:
        return
    locator = LogLocator(subs=(1.0, 2.0, 5.0)) if isinstance(norm, LogNorm) else MaxNLocator(CONTOURS)
    levels = [level for level in locator.tick_values(norm.vmin, norm.vmax) if norm.vmin < level < norm.vmax]
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "No contour levels were found")
        lines = axis.contour(
            x,
            y,
            np.ma.masked_invalid(short_repr),
            levels,
            colors="white",
            linestyles="solid",
            linewidths=0.7,
            alpha=0.8,
        )
    axis.clabel(lines, fontsize=7.5, fmt="%g")


def _veil(axis: Any, x: Any, y: Any, odd: Any) -> None:
    """Cover the cells of designs that do not rotate fully with a light veil, and hatch them."""
    if min(odd.shape) < 2 or not odd.any():
        return
    cells = np.ma.masked_equal(odd, False)
    axis.pcolormesh(x, y, cells, cmap=ListedColormap([VEIL]), shading="nearest", rasterized=True)
    outer_x, outer_y = (
        np.concatenate(([1.5 * v[0] - 0.5 * v[1]], v, [1.5 * v[-1] - 0.5 * v[-2]])) for v in (x, y)
    )
    padded = np.pad(odd.astype(float), 1, mode="edge")
    axis.contourf(outer_x, outer_y, padded, levels=[0.5, 1.5], colors="none", hatches=["////"])


def _add_legend(axis: Any, handles: Sequence[Any], beside: bool) -> None:
    """Explain below the axes; beside them what codes mean, which has no colour bar there."""
    for handle in handles:
        handle.set_label(textwrap.fill(handle.get_label(), BESIDE if beside else BELOW))
    if handles and beside:
        axis.legend(
            handles=handles, loc="upper left", bbox_to_anchor=(1.02, 1.0), frameon=False, borderaxespad=0.0
        )
    elif handles:
        columns = 3 if sum(len(handle.get_label()) for handle in handles) < 60 else 1
        axis.legend(
            handles=handles,
            loc="upper left",
            bbox_to_anchor=(0.0, -0.13),
            ncols=columns,
            frameon=False,
            borderaxespad=0.0,
        )


def _why_absent(status: xr.DataArray | None, absent: Any) -> str:
    """Tell why cells have no value: a design that assembles may have none for another reason."""
    if status is None:
        return "does not assemble"
    pairs = zip(status.attrs["flag_values"], status.attrs["flag_meanings"].split(), strict=True)
    never = [code for code, meaning in pairs if meaning in ("never_assembles", "invalid_input")]
    fails = np.isin(status.values[absent], never)
    return " or ".join(["does not assemble"] * bool(fails.any()) + ["has no value"] * bool((~fails).any()))


def _meanings(status: xr.DataArray, odd: Any) -> str:
    """Return what the statuses but the first mean, the most frequent one first."""
    pairs = zip(status.attrs["flag_values"], status.attrs["flag_meanings"].split(), strict=True)
    counts = {meaning: int((status.values[odd] == code).sum()) for code, meaning in list(pairs)[1:]}
    found = sorted((meaning for meaning in counts if counts[meaning]), key=lambda meaning: -counts[meaning])
    return ", ".join(found).replace("_", " ")


def _panels(variable: xr.DataArray) -> list[tuple[str, xr.DataArray]]:
    """Return a title and the values of each assembly mode; of all together where they are alike."""
    if "branch" not in variable.dims:
        return [("", variable)]
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
        places, values = _unwrapped(x, panel.values.astype(float), variable.attrs.get("units"))
        axis.plot(places, values, color=colour, label=title, linewidth=1.6, **marks)
    every = np.array([panel.values.astype(float) for _, panel in panels])
    _shade(axis, x, np.isnan(every).all(axis=0), ABSENT, "does not assemble")
    _shade(axis, x, np.isinf(every).any(axis=0), ENDLESS, WITHOUT_BOUND)
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


def _unwrapped(x: Any, values: Any, units: str | None) -> tuple[Any, Any]:
    """Return a curve that is cut where an angle passes from pi to -pi."""
    if units != "rad":
        return x, values
    jumps = np.flatnonzero(np.abs(np.diff(values)) > np.pi) + 1
    return np.insert(x.astype(float), jumps, x[jumps]), np.insert(values, jumps, np.nan)


def _shade(axis: Any, x: Any, absent: Any, colour: str, label: str) -> None:
    """Shade where there is no value to draw, half-way to the next place that has one."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], absent, [False])).astype(int)))
    middles = np.concatenate((x[:1], 0.5 * (x[:-1] + x[1:]), x[-1:]))
    for number, (start, stop) in enumerate(edges.reshape(-1, 2)):
        known = "_further" if number else label
        axis.axvspan(middles[start], middles[stop], color=colour, linewidth=0, label=known)
