"""Draw a variable of a map: check the request, select, draw, write."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastlink._text import short_repr
from fastlink.doors import door
from fastlink.errors import InputError, Setting
from fastlink.io.reader import as_map
from fastlink.maps.units import degrees as in_degrees
from fastlink.maps.units import degrees_along
from fastlink.plot.picture import checked_request, save
from fastlink.plot.selection import select

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["plot_map"]


@door
def plot_map(
    maps: Any,
    name: str,
    *,
    branch: int | None = None,
    at: Mapping[str, float] | None = None,
    panels: str | None = None,
    lines: str | None = None,
    degrees: bool = False,
    to: str | Path | None = None,
) -> Figure:
    """Draw one variable of a result.

    Over two dimensions it is a filled map, grey where the linkage does not assemble; over one, a line for each
    assembly mode. A further dimension is shown by `panels` or `lines`; all others are fixed by `at`.

    Parameters
    ----------
    maps : xarray.Dataset or path
        From `fastlink.sweep`, `fastlink.run_study` or `fastlink.open`, or the file of a map.
    name : str
        The variable.
    branch : int, optional
        One assembly mode; by default all, in one picture.
    at : mapping of str to float, optional
        Values at which dimensions are fixed, each at the nearest one in the result; angles in degrees if `degrees`.
    panels : str, optional
        A third dimension: a small map for each of at most six of its values, evenly over all, in the same colours.
    lines : str, optional
        A second dimension: a line for each of at most six of its values, in place of a map over both.
    degrees : bool, default False
        Show angles in degrees: axes, colours, values that are fixed and those in `at`.
    to : path, optional
        The picture to write; its ending (png, svg, pdf) is its kind. An existing one is replaced.

    Returns
    -------
    matplotlib.figure.Figure
        The figure; it is not part of matplotlib's global state and need not be closed.

    Raises
    ------
    InputError
        Not a map; unknown variable, dimension or branch; more than two dimensions left, or none; matplotlib is missing.

    Examples
    --------
    >>> import fastlink as fl
    >>> space = fl.grid(a1=0.4, a2=[1.1, 1.2, 1.3], a3=[0.7, 0.8], a4=[0.9, 1.0])
    >>> maps = fl.sweep("planar_4r", space, ["transmission_angle_min"])
    >>> figure = plot_map(maps, "transmission_angle_min", at={"a4": 1.0})
    >>> figure.axes[0].get_xlabel()
    'length of the coupler AB $a_{2}$ [m]'
    >>> grid = plot_map(maps, "transmission_angle_min", panels="a4")
    >>> [axis.get_title() for axis in grid.axes[:2]]
    ['$a_{4}$ = 0.9 m', '$a_{4}$ = 1 m']
    """
    path = checked_request(to, degrees)
    from fastlink.plot.draw import draw
    from fastlink.plot.figure import style

    if at is not None and (not isinstance(at, Mapping) or hasattr(at, "data_vars")):
        remedy = ("write such as ", Setting("at", {"a4": 1.0}))
        raise InputError(f"is {short_repr(at)}", where=("at",), remedy=remedy)
    splits = [(key, dim) for key, dim in (("panels", panels), ("lines", lines)) if dim is not None]
    if len(splits) > 1:
        raise InputError("is given beside panels", where=("lines",), remedy="leave one of them out")
    with as_map(maps) as dataset:
        if degrees:
            dataset = degrees_along(dataset)
        shown = select(dataset, name, branch, at or {}, *splits)
        if degrees:
            shown = replace(shown, variable=in_degrees(shown.variable))
        with style():
            figure = draw(dataset, shown)
            if path is not None:
                save(figure, path, "to")
    return figure
