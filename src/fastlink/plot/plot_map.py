"""Pictures of maps: choose what is drawn, and check it; `fastlink.plot.draw` draws."""

from __future__ import annotations

import math
import numbers
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastlink.errors import InputError, Remedy, Setting, suggest

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["plot_map"]

INSTALL = "python -m pip install 'fastlink-linkages[plot]'"
BRANCH = "branch"


def plot_map(
    dataset: xr.Dataset,
    name: str,
    *,
    branch: int | None = None,
    at: Mapping[str, float] | None = None,
    to: str | Path | None = None,
) -> Figure:
    """Draw one variable of a result.

    Over two dimensions it is a filled map, where grey is what does not assemble; over one, a line for each
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
        Values at which dimensions are fixed; the nearest one in the result is taken.
    to : path, optional
        The picture to write, of a kind that its ending says (png, svg, pdf); replaced if it exists.

    Returns
    -------
    matplotlib.figure.Figure
        Without any global state of matplotlib: nothing to close.

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
    try:
        from fastlink.plot import draw as plot_draw
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] != "matplotlib":
            raise
        raise InputError("matplotlib is not installed", where=("plot",), remedy=INSTALL) from None
    place = None if to is None else _place(to, plot_draw.kinds())
    chosen, fixed = _chosen(dataset, name, branch, dict(at or {}))
    free = [str(dim) for dim in chosen.dims if dim != BRANCH]
    if len(free) > 2:
        what = f"{name} has the dimensions {_listed(chosen, free)}"
        value = Setting("at", {free[-1]: _middle(chosen, free[-1])})
        raise InputError(what, where=("plot",), remedy=(f"fix {_some(len(free) - 2)} of them by ", value))
    if not free:
        values = ", ".join(f"{value:g}" for value in chosen.values.ravel())
        what = f"{name} has no dimension left to draw it over; its value is {values}"
        raise InputError(what, where=("plot",), remedy="leave one free")
    with plot_draw.style():
        figure = plot_draw.draw(dataset, chosen.load(), free, fixed)
        if place is not None:
            try:
                figure.savefig(place)
            except OSError as error:
                what = f"{place} cannot be written ({error.strerror})"
                raise InputError(what, where=("to",), remedy="choose another place") from error
    return figure


def _place(to: str | Path, kinds: Mapping[str, str]) -> Path:
    place = Path(to).expanduser()
    kind = place.suffix.removeprefix(".").lower()
    if kind not in kinds:
        found = f"ends in {kind!r}" if kind else "has no ending"
        what, remedy = f"{place}: the name of the picture {found}", f"write one of {', '.join(sorted(kinds))}"
        raise InputError(what, where=("to",), remedy=remedy)
    if not place.parent.is_dir():
        what = f"{place}: there is no folder {place.parent}"
        raise InputError(what, where=("to",), remedy="create it or choose another")
    return place


def _chosen(
    dataset: xr.Dataset, name: str, branch: int | None, at: dict[str, float]
) -> tuple[xr.DataArray, dict[str, float]]:
    """Return the variable with dimensions fixed as asked, and what they are fixed at."""
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
        what = f"{dim!r} is no dimension of {name} that can be fixed"
        raise InputError(what, where=("at",), remedy=remedy)
    return variable, fixed


def _one_branch(variable: xr.DataArray, branch: int) -> xr.DataArray:
    if BRANCH not in variable.dims:
        what = f"{variable.name} is the same in every assembly mode"
        raise InputError(what, where=("branch",), remedy="leave it out")
    known = variable[BRANCH].values.tolist()
    if branch not in known:
        remedy = f"write one of {', '.join(map(str, known))}"
        raise InputError(f"{branch} is not in the result", where=("branch",), remedy=remedy)
    return variable.isel({BRANCH: [known.index(branch)]})


def _nearest(dim: str, values: Any, wanted: float) -> int:
    if isinstance(wanted, bool) or not isinstance(wanted, numbers.Real) or not math.isfinite(wanted):
        raise InputError(f"is {wanted!r}", where=("at", dim), remedy="write a finite number")
    low, high = float(values.min()), float(values.max())
    slack = 1e-9 * max(abs(low), abs(high))
    if not low - slack <= wanted <= high + slack:
        remedy = f"write a number from {low:g} to {high:g}"
        raise InputError(f"is {wanted:g}, outside the result", where=("at", dim), remedy=remedy)
    return int(abs(values - float(wanted)).argmin())


def _listed(variable: xr.DataArray, dims: list[str]) -> str:
    parts = []
    for dim in dims:
        values = variable[dim].values
        parts.append(f"{dim} ({len(values)} from {values.min():g} to {values.max():g})")
    return ", ".join(parts)


def _some(number: int) -> str:
    return {1: "one", 2: "two", 3: "three"}.get(number, str(number))


def _middle(variable: xr.DataArray, dim: str) -> float:
    values = variable[dim].values
    return float(f"{values[len(values) // 2]:g}")
