"""The Pareto front of error against run time, as a table and as a picture."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import aligned
from fastlink.errors import InputError

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

__all__ = ["accuracy_table", "draw", "front"]

INSTALL = "python -m pip install 'fastlink-linkages[plot]'"
#: Below this a picture shows no difference: a rounding of a double.
LEAST = 2.0**-54
#: Errors below this are those of the last digit.
EQUAL = 2.0**-48
#: An error that is smaller by less is no smaller one.
ALIKE = 0.99
COLUMNS = 2


def front(measured: xr.Dataset) -> NDArray[np.int8]:
    """Return 1 where no other way to a quantity takes less time and has no larger error; a few roundings are equal."""
    errors, times = np.maximum(measured["error_max"].values, EQUAL), measured["ns_per_design"].values
    found = np.zeros(errors.shape, dtype=np.int8)
    for k in range(errors.shape[1]):
        order = np.lexsort((errors[:, k], times[:, k]))
        least = np.inf
        for way in order:
            if errors[way, k] < ALIKE * least:
                found[way, k], least = 1, errors[way, k]
    return found


def accuracy_table(measured: xr.Dataset) -> str:
    """Return the result of `fastlink.accuracy` as lines of text, the fastest way first.

    A star marks the ways that no other one beats in both error and time.

    Examples
    --------
    >>> import xarray as xr
    >>> of_one = {"error_max": 4e-16, "error_99": 3e-16, "error_median": 1e-16, "ns_per_design": 335.0}
    >>> counts = {"missed": 0, "values": 64, "pareto": 1}
    >>> measured = xr.Dataset(
    ...     {name: (("way", "quantity"), [[value]]) for name, value in (of_one | counts).items()},
    ...     {"way": ["refined"], "quantity": ["omega4_max"]},
    ... )
    >>> print(accuracy_table(measured))
    omega4_max
       way      ns/design  largest     99 %   median   missed
    *  refined        335  4.0e-16  3.0e-16  1.0e-16  0 of 64
    """
    head = ("", "way", "ns/design", "largest", "99 %", "median", "missed")
    blocks = []
    for quantity in measured["quantity"].values:
        one = measured.sel(quantity=quantity)
        rows: list[tuple[str, ...]] = [head]
        for k in np.argsort(one["ns_per_design"].values):
            way = one.isel(way=int(k))
            if not math.isnan(way["ns_per_design"]):
                rows.append(_row(way))
        blocks.append(f"{quantity}\n{aligned(rows, right=2)}")
    return "\n\n".join(blocks)


def _row(way: Any) -> tuple[str, ...]:
    errors = [float(way[name]) for name in ("error_max", "error_99", "error_median")]
    short_repr = ["-" if math.isnan(error) else f"{error:.1e}" for error in errors]
    missed = f"{int(way['missed'])} of {int(way['values'])}"
    star, name = "*" if int(way["pareto"]) else "", str(way["way"].values)
    return (star, name, f"{float(way['ns_per_design']):,.0f}", *short_repr, missed)


def draw(measured: xr.Dataset, to: str | Path) -> None:
    """Write the work-precision diagram: error over time, a panel for each quantity, the front as a line.

    Raises
    ------
    InputError
        Matplotlib is missing, or the picture cannot be written.
    """
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ModuleNotFoundError:
        raise InputError("matplotlib is not installed", where=("picture",), remedy=INSTALL) from None
    quantities = [str(name) for name in measured["quantity"].values]
    columns = min(COLUMNS, len(quantities))
    lines = -(-len(quantities) // columns)
    figure = Figure(figsize=(5.2 * columns, 3.9 * lines), layout="constrained")
    FigureCanvasAgg(figure)
    for k, quantity in enumerate(quantities):
        axes = figure.add_subplot(lines, columns, k + 1)
        one = measured.sel(quantity=quantity)
        one = one.isel(way=np.flatnonzero(np.isfinite(one["error_max"].values)))
        times, errors = one["ns_per_design"].values, np.maximum(one["error_max"].values, LEAST)
        best = np.flatnonzero(one["pareto"].values)
        best = best[np.argsort(times[best])]
        axes.plot(times[best], errors[best], color="tab:blue", zorder=1)
        axes.scatter(times, errors, c=np.where(one["pareto"].values == 1, "tab:blue", "0.6"), s=18, zorder=2)
        for way, x, y in zip(one["way"].values.tolist(), times, errors, strict=True):
            # below its point what stands beside another way of the same kind, so that neither hides the other
            side, *anchor = (-1, "right", "top") if way.endswith("relaxed") else (1, "left", "bottom")
            place: dict[str, Any] = dict(
                zip(("horizontalalignment", "verticalalignment"), anchor, strict=True)
            )
            place |= {"textcoords": "offset points", "rotation": 35, "rotation_mode": "anchor", "fontsize": 6}
            axes.annotate(way, (x, y), xytext=(3 * side, 3 * side), **place)
        axes.set(xscale="log", yscale="log", title=quantity, xlabel="run time per design / ns")
        axes.set_ylabel("largest relative error")
        axes.margins(x=0.25, y=0.2)
        axes.grid(color="0.9", linewidth=0.6)
    try:
        figure.savefig(Path(to), dpi=160)
    except (OSError, ValueError) as error:
        what = f"{to} cannot be written ({error})"
        raise InputError(what, where=("picture",), remedy="choose another name") from None
