"""Explore a map in a browser: the door."""

from __future__ import annotations

from contextlib import ExitStack
from os import PathLike
from pathlib import Path
from typing import Any

from fastlink.errors import check_switch, check_whole, door
from fastlink.io.reader import as_map
from fastlink.pictures.picture import require_matplotlib

__all__ = ["Page", "explore"]


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
