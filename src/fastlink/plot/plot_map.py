"""Check a request for a picture of a map, and select its data."""

from __future__ import annotations

import math
import numbers
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastlink.doors import door
from fastlink.errors import InputError, Remedy, Setting, suggest
from fastlink.plot.picture import check_picture, require_matplotlib, save

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["plot_map"]

BRANCH = "branch"


@door
def plot_map(
    dataset: xr.Dataset,
    name: str,
    *,
    branch: int | None = None,
    at: Mapping[str, float] | None = None,
    to: str | Path | None = None,
) -> Figure:
    """Draw one variable of a result.

    Over two dimensions it is a filled map, grey where the linkage does not assemble; over one, a line for each
    assembly mode. Further dimensions are fixed by `at`.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `fastlink.sweep`, `fastlink.run_study` or `fastlink.open`.
    name : str
        The variable.
    branch : int, optional
        One assembly mode; by default all, in one picture.
    at : mapping of str to float, optional
        Values at which dimensions are fixed, each at the nearest one in the result.
    to : path, optional
        The picture to write; its ending (png, svg, pdf) is its kind. An existing one is replaced.

    Returns
    -------
    matplotlib.figure.Figure
        The figure; it is not part of matplotlib's global state and need not be closed.

    Raises
    ------
    InputError
        Unknown variable, dimension or branch; more than two dimensions left, or none; matplotlib is missing.

    Examples
    --------
    >>> import fastlink as fl
    >>> space = fl.grid(a1=0.4, a2=[1.1, 1.2, 1.3], a3=[0.7, 0.8], a4=[0.9, 1.0])
    >>> maps = fl.sweep("planar_4r", space, ["transmission_angle_min"])
    >>> figure = plot_map(maps, "transmission_angle_min", at={"a4": 1.0})
    >>> figure.axes[0].get_xlabel()
    'length of the coupler AB $a_{2}$ [m]'
    """
    require_matplotlib("plot")
    from fastlink.plot.draw import draw, style

    path = None if to is None else check_picture(to, "to")
    variable, fixed = _select(dataset, name, branch, dict(at or {}))
    free = [str(dim) for dim in variable.dims if dim != BRANCH]
    if len(free) > 2:
        what = f"{name} has the dimensions {_listed(variable, free)}"
        value = Setting("at", {free[-1]: _middle(variable, free[-1])})
        count = {1: "one", 2: "two", 3: "three"}.get(len(free) - 2, str(len(free) - 2))
        raise InputError(what, where=("plot",), remedy=(f"fix {count} of them by ", value))
    if not free:
        values = ", ".join(f"{value:g}" for value in variable.values.ravel())
        what = f"{name} has no dimension left to draw it over; its value is {values}"
        raise InputError(what, where=("plot",), remedy="leave one free")
    with style():
        figure = draw(dataset, variable.load(), free, fixed)
        if path is not None:
            save(figure, path, "to")
    return figure


def _select(
    dataset: xr.Dataset, name: str, branch: int | None, at: dict[str, float]
) -> tuple[xr.DataArray, dict[str, float]]:
    """Return the variable with dimensions fixed, and the values at which they are fixed."""
    if name not in dataset.data_vars:
        known = [str(key) for key in dataset.data_vars]
        nearest = suggest(str(name), known)
        raise InputError(f"there is no variable {name!r}", where=("name",), remedy=nearest)
    variable = dataset[name]
    if branch is not None:
        variable = _one_branch(variable, branch)
    fixed: dict[str, float] = {}
    for dim in [str(dim) for dim in variable.dims if dim != BRANCH]:
        values = variable[dim].values
        if dim in at:
            index = _nearest(dim, values, at.pop(dim))
        elif len(values) == 1:
            index = 0
        else:
            continue
        fixed[dim] = values[index].item()
        variable = variable.isel({dim: index})
    for dim in at:
        known = [str(key) for key in dataset[name].dims if key != BRANCH]
        remedy: Remedy = suggest(dim, known) if known else "it has none"
        if dim == BRANCH:
            remedy = ("choose an assembly mode by ", Setting("branch", 1))
        what = f"{dim!r} is not a dimension of {name} that can be fixed"
        raise InputError(what, where=("at",), remedy=remedy)
    return variable, fixed


def _one_branch(variable: xr.DataArray, branch: int) -> xr.DataArray:
    if BRANCH not in variable.dims and BRANCH in variable.coords:
        variable = variable.expand_dims(BRANCH)
    if BRANCH not in variable.dims:
        what = f"{variable.name} is the same in every assembly mode"
        raise InputError(what, where=("branch",), remedy="leave it out")
    known = variable[BRANCH].values.tolist()
    if branch not in known:
        remedy = f"write one of {', '.join(map(str, known))}"
        raise InputError(f"{branch} is not in the result", where=("branch",), remedy=remedy)
    return variable.isel({BRANCH: [known.index(branch)]})


def _nearest(dim: str, values: Any, value: float) -> int:
    if isinstance(value, bool) or not isinstance(value, numbers.Real) or not math.isfinite(value):
        raise InputError(f"is {value!r}", where=("at", dim), remedy="write a finite number")
    low, high = float(values.min()), float(values.max())
    slack = 1e-9 * max(abs(low), abs(high))
    if not low - slack <= value <= high + slack:
        remedy = f"write a number from {low:g} to {high:g}"
        raise InputError(f"is {value:g}, outside the result", where=("at", dim), remedy=remedy)
    return int(abs(values - float(value)).argmin())


def _listed(variable: xr.DataArray, dims: list[str]) -> str:
    parts = []
    for dim in dims:
        values = variable[dim].values
        parts.append(f"{dim} ({len(values)} from {values.min():g} to {values.max():g})")
    return ", ".join(parts)


def _middle(variable: xr.DataArray, dim: str) -> float:
    values = variable[dim].values
    return float(f"{values[len(values) // 2]:g}")
