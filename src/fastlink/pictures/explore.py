"""Rank the designs of a region of a picture, and choose some of them to be drawn."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fastlink.errors import check_switch, check_whole, door
from fastlink.io.reader import as_map
from fastlink.maps.best import least
from fastlink.pictures.content import Values
from fastlink.pictures.picture import require_matplotlib

__all__ = ["Page", "explore", "region_of"]


#: Designs of a region that are drawn, and those that are listed as the best; values that are read at once.
MOST_ROWS, MOST_BEST, BLOCK = 1500, 12, 1 << 22

Ranges = dict[str, range]


def region_of(
    values: Values,
    name: str,
    axes: tuple[str, ...],
    at: Mapping[str, int],
    window: Mapping[str, tuple[int, int]],
    *,
    largest: bool,
) -> dict[str, Any]:
    """Return some designs of a region with all variables, and the best of all of them."""
    ranges = {dim: range(window[dim][0], window[dim][1] + 1) for dim in axes}
    some = _some(ranges)
    grid = np.meshgrid(*some.values(), indexing="ij")
    found = {
        one: _along(values, one, at, some).ravel().tolist()
        for one in values.names
        if {str(dim) for dim in values.maps[one].dims} <= {*at, *axes}
    }
    numbers = _best(values, name, at, ranges, -1.0 if largest else 1.0)
    places = [
        {**at, **{dim: ranges[dim][int(k)] for dim, k in zip(axes, one, strict=True)}} for one in numbers
    ]
    return {
        "count": math.prod(map(len, ranges.values())),
        "values": {key: [v if math.isfinite(v) else None for v in one] for key, one in found.items()},
        "axes": {dim: along.ravel().tolist() for dim, along in zip(axes, grid, strict=True)},
        "best": [{"at": place, "row": values.row(place)} for place in places],
    }


def _some(ranges: Ranges) -> Ranges:
    """Return ranges with steps that leave about so many designs as are drawn; the shortest keep most."""
    found, left = dict(ranges), MOST_ROWS
    for number, dim in enumerate(sorted(ranges, key=lambda one: len(ranges[one]))):
        most = math.floor(left ** (1.0 / (len(ranges) - number)) + 1e-9)
        found[dim] = ranges[dim][:: -(-len(ranges[dim]) // most)]
        left //= len(found[dim])
    return found


def _best(
    values: Values, name: str, at: Mapping[str, int], ranges: Ranges, sign: float
) -> Iterator[tuple[Any, ...]]:
    """Yield the numbers along each axis of the designs of least value times sign; of equal ones the first."""
    shape = tuple(map(len, ranges.values()))
    first = next(dim for dim in map(str, values.maps[name].dims) if dim in ranges)
    whole, axis = ranges[first], list(ranges).index(first)
    step = max(1, BLOCK // max(1, math.prod(shape) // len(whole)))
    ranked, chosen = np.empty(0), np.empty(0, dtype=np.int64)
    for start in range(0, len(whole), step):
        part = {**ranges, first: whole[start : start + step]}
        flat = sign * _along(values, name, at, part).ravel().astype(float)
        bound = ranked.max() if len(ranked) == MOST_BEST else np.inf
        finite = np.flatnonzero((flat <= bound) & np.isfinite(flat))
        numbers = list(np.unravel_index(finite, tuple(map(len, part.values()))))
        numbers[axis] = numbers[axis] + start
        ranked = np.concatenate([ranked, flat[finite]])
        chosen = np.concatenate([chosen, np.ravel_multi_index(tuple(numbers), shape)])
        order = np.argsort(chosen)
        kept = order[least(ranked[order], MOST_BEST)]
        ranked, chosen = ranked[kept], chosen[kept]
    return iter([np.unravel_index(one, shape) for one in chosen[np.lexsort((chosen, ranked))]])


def _along(values: Values, name: str, at: Mapping[str, int], ranges: Ranges) -> NDArray[Any]:
    """Return the values of a variable over ranges of places, in their order."""
    dims = [str(dim) for dim in values.maps[name].dims]
    slices = {dim: slice(one.start, one.stop, one.step) for dim, one in ranges.items()}
    found = values.part(name, {dim: slices.get(dim, at.get(dim, 0)) for dim in dims})
    own = [dim for dim in dims if dim in ranges]
    found = found.transpose([own.index(dim) for dim in ranges if dim in own])
    whole = found[tuple(slice(None) if dim in own else None for dim in ranges)]
    return np.broadcast_to(whole, tuple(map(len, ranges.values())))


# -- Explore a map in a browser: the door


LAST_PORT = 65535


class Page:
    """A map that is shown in a browser: served until it is closed, or written as a file.

    Attributes
    ----------
    url : str
        The address: on this machine, with the token without which it is refused, or that of the file.
    """

    def __init__(self, url: str, stack: ExitStack) -> None:
        self.url, self._stack = url, stack

    def close(self) -> None:
        """Stop serving."""
        self._stack.close()

    def __enter__(self) -> Page:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<fastlink page {self.url}>"

    def _repr_html_(self) -> str:
        return f'<a href="{self.url}" target="_blank" rel="noreferrer">Explore this map</a>'


def _served(maps: Any, port: int) -> Page:
    from fastlink.pictures.content import Values
    from fastlink.pictures.server import Server

    with ExitStack() as stack:
        server = Server(Values(stack.enter_context(as_map(maps)), _file_of(maps)), port)
        stack.callback(server.close)
        return Page(server.url, stack.pop_all())


def _file_of(maps: Any) -> Path | None:
    """Return the file that a caller names, None of a Dataset."""
    return Path(maps) if isinstance(maps, (str, PathLike)) else None


def _written(maps: Any, to: Any) -> Page:
    from fastlink.pictures.content import Values
    from fastlink.pictures.server import check_page, write_page

    path = check_page(to)
    with as_map(maps) as dataset:
        write_page(Values(dataset, _file_of(maps)), path)
    return Page(path.absolute().as_uri(), ExitStack())


@door
def explore(maps: Any, *, to: str | Path | None = None, port: int = 0, browser: bool = True) -> Page:
    """Show a map in a browser, served on this machine alone, or write it as a page.

    The map as a picture, with a slider for each input that it does not show; the values under the cursor, and beside
    them the mechanism of that design, moving. The address has a random token, and nothing but this map is served.

    Parameters
    ----------
    maps : xarray.Dataset or path
        From `fastlink.sweep`, `fastlink.run_study` or `fastlink.open`, or the file of a map; read where it is looked
        at, so that it may be larger than memory. Great maps are read fastest by their path.
    to : path, optional
        Write one page that carries the whole map and needs neither Python nor a network, such as ``page.html``, in
        place of serving it: for maps up to some 10 MB. An existing one is replaced.
    port : int, default 0
        Where it is served; 0 for a port that is free.
    browser : bool, default True
        Open the page in the browser of this machine.

    Returns
    -------
    Page
        With the address as ``url``; ``close()`` ends it, as the end of Python does.

    Raises
    ------
    InputError
        Not a map; a page cannot be written there, or would be too large; the port is taken; or matplotlib is missing,
        whose colours are used.

    Examples
    --------
    >>> import fastlink as fl
    >>> space = fl.grid(a1=[0.3, 0.4, 0.5], a2=[1.1, 1.2, 1.3], a3=0.8, a4=1.0, omega1=10.0)
    >>> maps = fl.sweep("planar_4r", space, ["omega4_max"], branch=1)
    >>> with fl.explore(maps, browser=False) as page:
    ...     page.url[:17]
    'http://127.0.0.1:'
    """
    require_matplotlib("explore", extra="explore")
    check_switch(("browser",), browser)
    check_whole(("port",), port, 0, LAST_PORT)
    if to is not None:
        return _written(maps, to)
    page = _served(maps, port)
    if browser:
        import webbrowser

        webbrowser.open(page.url)
    return page
