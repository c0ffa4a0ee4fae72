"""Draw the rows of a map against each other: check the request, read, draw, write."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import counted, in_words, joined, short_repr
from fastlink.errors import InputError, Problems, Setting, check_choice, check_switch, door, require_package
from fastlink.io.reader import as_map
from fastlink.maps.best import MISSED, choice_of, chosen, conditions, listed, numeric
from fastlink.pictures.labels import constants_of, plain
from fastlink.pictures.maps import draw_variable, one_branch
from fastlink.pictures.picture import check_picture, save
from fastlink.space.design_space import BRANCH
from fastlink.space.tables import STATUS

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from fastlink.pictures.charts import Cloud


#: Kinds of pictures, and how many quantities they show.
KINDS = {"scatter": (2, 3), "corner": (2, 8), "cumulative": (1, 6)}
TITLE = 84  # letters in a line


@door
def plot(
    maps: Any,
    names: str | Sequence[str] = (),
    *,
    kind: str | None = None,
    minimise: str | Sequence[str] = (),
    maximise: str | Sequence[str] = (),
    where: Any = None,
    branch: int | None = None,
    at: Mapping[str, float] | None = None,
    panels: str | None = None,
    lines: str | None = None,
    degrees: bool = False,
    to: str | Path | None = None,
) -> Figure:
    """Draw a map: one variable over its inputs; or rows by several variables; or a Pareto front.

    *One variable*: over two dimensions a filled map, grey where the linkage does not assemble; over one, a line for
    each branch. A further dimension is shown by `panels` or `lines`; all others are fixed by `at`.

    *Rows*, by several names, or where `kind` or `where` is given: points, corners, or cumulative distributions. A row
    is a place along all dimensions of the names: a design, in a branch, and at one input position where they have them.
    Above 100,000 rows points become cells that are coloured by how many rows they hold, read block by block: the map
    may be larger than memory. Rows without a number are left out, and counted in the title.

    *A front*, by two to eight objectives: that of `fastlink.best`, exact, among all rows.

    Parameters
    ----------
    maps : xarray.Dataset or path
        From `fastlink.sweep`, `fastlink.run` or `fastlink.open`, or the file of a map.
    names : str or sequence of str
        A variable; or several, which may be inputs that are swept.
    kind : {"scatter", "corner", "cumulative"}, optional
        Of rows. ``"scatter"``: the second over the first, coloured by the third, which may be a code; ``"corner"``:
        each over each other, and each by itself; ``"cumulative"``: the share of rows that have at most a value. By
        default cumulative for one name, scatter for two and three, corner for more.
    minimise, maximise : str or sequence of str
        The objectives of a front, as in `fastlink.best`.
    where : mapping, str, list of str or xarray.DataArray, optional
        Which rows, as in `fastlink.best`.
    branch : int, optional
        One branch; by default all that the map has: in one picture, or as rows of their own.
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
        Not a map; a name, dimension, branch, kind or condition is unknown; too many or too few names, objectives or
        dimensions; no rows; options of different pictures; matplotlib is missing.

    Examples
    --------
    >>> space = fl.grid(a1=np.linspace(0.1, 0.5, 9), a2=np.linspace(0.9, 1.3, 9), a3=0.8, a4=[0.9, 1.0], omega1=25.0)
    >>> maps = fl.sweep("planar_4r", space, ["omega4_max", "transmission_angle_min"])
    >>> figure = fl.plot(maps, "omega4_max", at={"a4": 1.0})
    >>> figure.axes[0].get_xlabel()
    'length of the input crank OA $a_{1}$ [m]'
    >>> figure = fl.plot(maps, "omega4_max", panels="a4")
    >>> [axis.get_title() for axis in figure.axes[:2]]
    ['$a_{4}$ = 0.9 m', '$a_{4}$ = 1 m']
    >>> maps = maps.sel(a4=1.0)
    >>> figure = fl.plot(maps, ["omega4_max", "transmission_angle_min", "a1"], where="rotates_fully")
    >>> figure.get_suptitle()
    '80 rows where status is rotates fully'
    >>> figure = fl.plot(maps, minimise="omega4_max", maximise="a1", where="rotates_fully")
    >>> print(figure.get_suptitle())
    The front of 9 of 80 rows by the least omega4_max and greatest a1, where status is
    rotates fully
    """
    wanted, objectives = listed(names), [*listed(minimise), *listed(maximise)]
    of_rows = kind is not None or where is not None or len(wanted) > 1
    if objectives and (wanted or kind is not None):
        remedy = "leave it out, or the objectives"
        raise InputError("is given beside objectives", ("names" if wanted else "kind",), remedy)
    for option, value in (("at", at), ("panels", panels), ("lines", lines)):
        if (objectives or of_rows) and value is not None:
            rows = ("choose rows, such as by ", Setting("where", {STATUS: "rotates_fully"}))
            raise InputError("is of a map of one variable", (option,), rows)
    require_package("matplotlib", ("plot",))
    check_switch(("degrees",), degrees)
    path = None if to is None else check_picture(to, "to")
    kind = _kind(kind, wanted) if of_rows and not objectives else None
    if not (wanted or objectives):
        front = (", or objectives by ", Setting("minimise", "NAME"), " and ", Setting("maximise", "NAME"))
        raise InputError("is missing", ("names",), ("write a variable, such as omega4_max", *front))
    from fastlink.pictures.style import style

    with as_map(maps) as dataset, style():
        if branch is not None and (objectives or of_rows):
            dataset = one_branch(dataset, branch)
        if objectives:
            figure = _front(dataset, minimise, maximise, where, degrees)
        elif kind is not None:
            figure = _rows(dataset, wanted, kind, where, degrees)
        else:
            figure = draw_variable(dataset, wanted[0], branch, at, panels, lines, degrees)
        if path is not None:
            save(figure, path, "to")
    return figure


def _rows(maps: xr.Dataset, wanted: list[Any], kind: str, where: Any, degrees: bool) -> Figure:
    """Draw the rows of a map by some quantities."""
    from fastlink.pictures.charts import draw_corner, draw_cumulative, draw_scatter

    problems = Problems()
    for name in wanted:
        with problems.at():
            _check_name(maps, name)
    with problems.at():
        conditions(maps, where)
    problems.stop()
    if kind == "cumulative":
        clouds = [_cloud(maps, [name], where, degrees) for name in wanted]
        title = f"{max(cloud.considered for cloud in clouds):,} rows{_of(where)}"
        return _titled(draw_cumulative(clouds), maps, title, _branches_of(clouds))
    cloud = _cloud(maps, wanted, where, degrees)
    for column in cloud.columns[2:] if kind == "scatter" and cloud.points is None else ():
        if column.flags:
            example = {str(column.array.name): next(iter(column.flags))}
            what = f"{column.array.name} is a code, which colours single points, and there are {cloud.count:,} rows"
            remedy = ("choose a meaning by ", Setting("where", example))
            raise InputError(what, where=("names",), remedy=remedy)
    drawer = draw_scatter if kind == "scatter" else draw_corner
    return _titled(drawer(cloud), maps, cloud.note() + _of(where), _branches_of([cloud]))


def _front(maps: xr.Dataset, minimise: Any, maximise: Any, where: Any, degrees: bool) -> Figure:
    """Draw the Pareto front of a map among all its rows."""
    from fastlink.pictures.charts import draw_corner, draw_scatter

    found = chosen(choice_of(maps, minimise, maximise, where)).of(maps)
    if MISSED in found.coords:
        raise InputError("leaves no row of the map", ("where",), "widen the conditions")
    names = [*listed(minimise), *listed(maximise)]
    low, high = KINDS["corner"]
    if not low <= len(names) <= high:
        remedy = f"write {low} to {high}, or rank by `best`"
        raise InputError(f"a front of {counted(len(names), 'objective')}", where=("plot",), remedy=remedy)
    cloud = _cloud(maps, names, where, degrees)
    factors = [column.factor for column in cloud.columns]
    front = np.stack([found[name].values for name in names], axis=1) * factors
    drawer = draw_scatter if len(names) == low else draw_corner
    about, wanted = str(found.attrs["selection"]).removesuffix(cloud.noted), _of(where)
    title = about[:1].upper() + about[1:] + (wanted and f",{wanted}")
    return _titled(drawer(cloud, front), maps, title, cloud.noted.removeprefix(", "))


def _titled(figure: Figure, maps: xr.Dataset, title: str, remark: str) -> Figure:
    """Write title, remark and constants on a picture."""
    figure.suptitle(textwrap.fill(plain(title), TITLE), fontsize=10.5)
    below = "\n".join(filter(None, [remark, constants_of(maps)]))
    figure.supxlabel(below, fontsize=7.5, color="0.45")
    return figure


def _kind(kind: Any, names: Sequence[Any]) -> str:
    """Return what is drawn of so many names, or refuse it."""
    count = len(names)
    if kind is None:
        kind = "cumulative" if count == 1 else "scatter" if count < 4 else "corner"
    known = check_choice(("kind",), kind, list(KINDS))
    low, high = KINDS[known]
    if not low <= count <= high:
        what = f"holds {counted(count, 'name')}, and {known} shows {low} to {high}"
        raise InputError(what, where=("names",), remedy=f"write {low} to {high} names")
    twice = [name for k, name in enumerate(names) if name in names[:k]]
    if twice:
        raise InputError(f"holds {short_repr(twice[0])} twice", where=("names",), remedy="name it once")
    return str(known)


def _check_name(maps: xr.Dataset, name: Any) -> None:
    """Refuse a name that has no numbers along a dimension."""
    usable = numeric(maps)
    if isinstance(name, str) and name in maps.variables and name not in usable:
        alone = "it is one value" if maps[name].size == 1 else "it is not a number for each design"
        remedy = "write the name of a variable, or of an input, that has several"
        raise InputError(f"{name} cannot be drawn: {alone}", where=("names",), remedy=remedy)
    check_choice(("names",), name, usable)


def _cloud(maps: xr.Dataset, names: Sequence[str], where: Any, degrees: bool) -> Cloud:
    """Return the rows of a map by some columns, or refuse to draw none."""
    from fastlink.pictures.charts import Cloud, column_of

    cloud = Cloud([column_of(maps, name, degrees) for name in names], conditions(maps, where))
    if not cloud.count:
        what = f"{joined(names)} {'has' if len(names) == 1 else 'have'} no numbers in any of {cloud.considered:,} rows"
        raise InputError(what, where=("plot",), remedy="write other names, or fewer conditions")
    return cloud


def _branches_of(clouds: Sequence[Cloud]) -> str:
    """Return that rows are designs several times, where they are."""
    counts = [column.array.sizes.get(BRANCH, 1) for cloud in clouds for column in cloud.columns]
    return f"a design is a row in each of {max(counts)} branches" if max(counts) > 1 else ""


def _of(where: Any) -> str:
    """Return conditions in words."""
    if where is None:
        return ""
    if isinstance(where, (str, list, tuple)):
        where = {STATUS: where}
    if not isinstance(where, Mapping):
        return " of a mask"
    return f" where {joined([_condition(name, given) for name, given in where.items()])}"


def _condition(name: str, given: Any) -> str:
    if isinstance(given, str) or any(isinstance(one, str) for one in given):
        meanings = [given] if isinstance(given, str) else list(given)
        return f"{name} is {in_words(' or '.join(meanings))}"
    low, high = given
    if low is None or high is None:
        return f"{name} is at {f'most {high:g}' if low is None else f'least {low:g}'}"
    return f"{name} is {low:g} to {high:g}"
