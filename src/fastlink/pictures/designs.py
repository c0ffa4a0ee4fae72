"""Draw the rows of a map against each other: check the request, read, draw, write."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import counted, in_words, joined, short_repr
from fastlink.errors import InputError, Problems, Setting, check_choice, door
from fastlink.io.reader import as_map
from fastlink.maps.best import MISSED, choice_of, chosen, conditions, listed, numeric
from fastlink.pictures.labels import constants_of, plain
from fastlink.pictures.maps import one_branch, plot_map
from fastlink.pictures.picture import checked_request, save
from fastlink.space.design_space import BRANCH
from fastlink.space.tables import STATUS

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from fastlink.pictures.charts import Cloud

__all__ = ["KINDS", "MapPlots", "plot_designs", "plot_front"]


#: Kinds of pictures, and how many quantities they show.
KINDS = {"scatter": (2, 3), "corner": (2, 8), "cumulative": (1, 6)}
TITLE = 84  # letters in a line


@door
def plot_designs(
    maps: Any,
    names: str | Sequence[str],
    *,
    kind: str | None = None,
    where: Any = None,
    branch: int | None = None,
    degrees: bool = False,
    to: str | Path | None = None,
) -> Figure:
    """Draw the designs of a map by some quantities: as points, as corners, or as cumulative distributions.

    Above 100,000 rows points become cells that are coloured by how many rows they hold, read block by block: the map
    may be larger than memory. Rows without a number are left out, and counted in the title.

    Parameters
    ----------
    maps : xarray.Dataset or path
        From `fastlink.sweep`, `fastlink.run_study` or `fastlink.open`, or the file of a map.
    names : str or sequence of str
        Variables, or inputs that are swept. A row is a place along all their dimensions: a design, in an assembly mode,
        and at one input position where they have them.
    kind : {"scatter", "corner", "cumulative"}, optional
        ``"scatter"``: the second over the first, coloured by the third, which may be a code; ``"corner"``: each over
        each other, and each by itself; ``"cumulative"``: the share of rows that have at most a value. By default
        cumulative for one name, scatter for two and three, corner for more.
    where : mapping, str, list of str or xarray.DataArray, optional
        Which rows, as in `fastlink.best`.
    branch : int, optional
        One assembly mode; by default all, as rows of their own.
    degrees : bool, default False
        Show angles in degrees.
    to : path, optional
        The picture to write; its ending (png, svg, pdf) is its kind. An existing one is replaced.

    Returns
    -------
    matplotlib.figure.Figure
        The figure; it is not part of matplotlib's global state and need not be closed.

    Raises
    ------
    InputError
        Not a map; a name, kind or condition is unknown; too many or too few names; no rows; matplotlib is missing.

    Examples
    --------
    >>> import numpy as np
    >>> import fastlink as fl
    >>> space = fl.grid(a1=np.linspace(0.1, 0.5, 9), a2=np.linspace(0.9, 1.3, 9), a3=0.8, a4=1.0, omega1=25.0)
    >>> maps = fl.sweep("planar_4r", space, ["omega4_max", "transmission_angle_min"], branch=1)
    >>> figure = fl.plot_designs(maps, ["omega4_max", "transmission_angle_min", "a1"], where="rotates_fully")
    >>> figure.get_suptitle()
    '80 rows where status is rotates fully'
    """
    path = checked_request(to, degrees)
    wanted = [names] if isinstance(names, str) else list(names) if isinstance(names, (list, tuple)) else []
    if not wanted:
        remedy = "write names of variables, such as ['omega4_max', 'a1']"
        raise InputError(f"is {short_repr(names)}", where=("names",), remedy=remedy)
    kind = _kind(kind, wanted)
    from fastlink.pictures.charts import draw_corner, draw_cumulative, draw_scatter

    with as_map(maps) as dataset:
        if branch is not None:
            dataset = one_branch(dataset, branch)
        problems = Problems()
        for name in wanted:
            with problems.at():
                _check_name(dataset, name)
        with problems.at():
            conditions(dataset, where)
        problems.stop()
        if kind == "cumulative":
            clouds = [_cloud(dataset, [name], where, degrees) for name in wanted]
            title = f"{max(cloud.considered for cloud in clouds):,} rows{_of(where)}"
            return _finished(lambda: draw_cumulative(clouds), dataset, title, path, _modes_of(clouds))
        cloud = _cloud(dataset, wanted, where, degrees)
        if kind == "scatter":
            _check_colour(cloud)
        drawer = draw_scatter if kind == "scatter" else draw_corner
        title = cloud.note() + _of(where)
        return _finished(lambda: drawer(cloud), dataset, title, path, _modes_of([cloud]))


@door
def plot_front(
    maps: Any,
    *,
    minimise: str | Sequence[str] = (),
    maximise: str | Sequence[str] = (),
    where: Any = None,
    branch: int | None = None,
    degrees: bool = False,
    to: str | Path | None = None,
) -> Figure:
    """Draw the Pareto front of a map by two objectives or more, among all its rows.

    Two objectives make one picture, more make corners. The front is that of `fastlink.best`, exact.

    Parameters
    ----------
    maps : xarray.Dataset or path
        From `fastlink.sweep`, `fastlink.run_study` or `fastlink.open`, or the file of a map.
    minimise, maximise : str or sequence of str
        The objectives, as in `fastlink.best`; two to eight.
    where, branch, degrees, to
        As in `fastlink.plot_designs`.

    Returns
    -------
    matplotlib.figure.Figure
        The figure; it is not part of matplotlib's global state and need not be closed.

    Raises
    ------
    InputError
        An objective or condition is unknown, there are not two objectives, or no rows; matplotlib is missing.

    Examples
    --------
    >>> import numpy as np
    >>> import fastlink as fl
    >>> space = fl.grid(a1=np.linspace(0.1, 0.5, 9), a2=np.linspace(0.9, 1.3, 9), a3=0.8, a4=1.0, omega1=25.0)
    >>> maps = fl.sweep("planar_4r", space, ["omega4_max", "transmission_angle_min"], branch=1)
    >>> figure = fl.plot_front(maps, minimise="omega4_max", maximise="a1", where="rotates_fully")
    >>> print(figure.get_suptitle())
    The front of 9 of 80 rows by the least omega4_max and greatest a1, where status is
    rotates fully
    """
    path = checked_request(to, degrees)
    from fastlink.pictures.charts import draw_corner, draw_scatter

    with as_map(maps) as dataset:
        if branch is not None:
            dataset = one_branch(dataset, branch)
        found = chosen(dataset, choice_of(dataset, minimise, maximise, where)).of(dataset)
        if MISSED in found.coords:
            raise InputError("leaves no row of the map", ("where",), "widen the conditions")
        names = [*listed(minimise), *listed(maximise)]
        low, high = KINDS["corner"]
        if not low <= len(names) <= high:
            remedy = f"write {low} to {high}, or list the best by fastlink.best"
            raise InputError(f"there are {counted(len(names), 'objective')}", where=("front",), remedy=remedy)
        cloud = _cloud(dataset, names, where, degrees)
        factors = [column.factor for column in cloud.columns]
        front = np.stack([found[name].values for name in names], axis=1) * factors
        drawer = draw_scatter if len(names) == low else draw_corner
        about, wanted = str(found.attrs["selection"]).removesuffix(cloud.noted), _of(where)
        title = about[:1].upper() + about[1:] + (wanted and f",{wanted}")
        return _finished(lambda: drawer(cloud, front), dataset, title, path, cloud.noted.removeprefix(", "))


def _finished(
    draw: Callable[[], Any], dataset: xr.Dataset, title: str, path: Path | None, remark: str = ""
) -> Figure:
    """Draw a picture, with title and constants, and write it."""
    from fastlink.pictures.style import style

    with style():
        figure: Figure = draw()
        figure.suptitle(textwrap.fill(plain(title), TITLE), fontsize=10.5)
        below = "\n".join(filter(None, [remark, constants_of(dataset)]))
        figure.supxlabel(below, fontsize=7.5, color="0.45")
        if path is not None:
            save(figure, path, "to")
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


def _check_colour(cloud: Cloud) -> None:
    """Refuse a code as the colour of cells."""
    for column in cloud.columns[2:]:
        if cloud.points is None and column.flags:
            example = {str(column.array.name): next(iter(column.flags))}
            what = f"{column.array.name} is a code, which colours single points, and there are {cloud.count:,} rows"
            remedy = ("choose a meaning by ", Setting("where", example))
            raise InputError(what, where=("names",), remedy=remedy)


def _check_name(maps: xr.Dataset, name: Any) -> None:
    """Refuse a name that has no numbers along a dimension."""
    usable = numeric(maps)
    if isinstance(name, str) and name in maps.variables and name not in usable:
        remedy = "write the name of a variable, or of an input that is swept"
        raise InputError(f"{name} is not a number for each design", where=("names",), remedy=remedy)
    check_choice(("names",), name, usable)


def _cloud(maps: xr.Dataset, names: Sequence[str], where: Any, degrees: bool) -> Cloud:
    """Return the rows of a map by some columns, or refuse to draw none."""
    from fastlink.pictures.charts import Cloud, column_of

    cloud = Cloud([column_of(maps, name, degrees) for name in names], conditions(maps, where))
    if not cloud.count:
        what = f"{joined(names)} {'has' if len(names) == 1 else 'have'} no numbers in any of {cloud.considered:,} rows"
        raise InputError(what, where=("plot",), remedy="write other names, or fewer conditions")
    return cloud


def _modes_of(clouds: Sequence[Cloud]) -> str:
    """Return that rows are designs several times, where they are."""
    counts = [column.array.sizes.get(BRANCH, 1) for cloud in clouds for column in cloud.columns]
    return f"a design is a row in each of {max(counts)} assembly modes" if max(counts) > 1 else ""


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


# -- Pictures of a map, from the map itself: ``maps.fastlink.plot``


class MapPlots:
    """The pictures of a map.

    Parameters
    ----------
    maps : xarray.Dataset
        The map.

    Examples
    --------
    >>> import fastlink as fl
    >>> space = fl.grid(a1=[0.2, 0.4, 0.6], a2=[1.1, 1.2, 1.3], a3=0.8, a4=1.0, omega1=25.0)
    >>> maps = fl.sweep("planar_4r", space, ["omega4_max", "transmission_angle_min"], branch=1)
    >>> figure = maps.fastlink.plot("omega4_max")
    >>> figure = maps.fastlink.plot.designs(["omega4_max", "transmission_angle_min"])
    >>> figure = maps.fastlink.plot.front(minimise="omega4_max", maximise="transmission_angle_min")
    """

    def __init__(self, maps: xr.Dataset) -> None:
        self._maps = maps

    @door
    def __call__(self, name: str, **options: Any) -> Figure:
        """Draw one variable over one or two inputs; options as in `fastlink.plot_map`."""
        return plot_map(self._maps, name, **options)

    @door
    def designs(self, names: str | Sequence[str], **options: Any) -> Figure:
        """Draw the rows by some quantities; options as in `fastlink.plot_designs`."""
        return plot_designs(self._maps, names, **options)

    @door
    def front(self, **options: Any) -> Figure:
        """Draw the Pareto front; options as in `fastlink.plot_front`."""
        return plot_front(self._maps, **options)
