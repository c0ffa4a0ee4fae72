"""Explore a map in a browser: served on this machine, or written as one page."""

from __future__ import annotations

import base64
import contextlib
import hmac
import json
import math
import operator
import secrets
import threading
import zlib
from collections.abc import Iterator
from contextlib import ExitStack
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from os import PathLike
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

import numpy as np

from fastlink._text import size
from fastlink.errors import (
    InputError,
    check_path,
    check_switch,
    check_whole,
    door,
    printable,
    require_package,
)
from fastlink.io.output import write_whole
from fastlink.io.output_path import check_writable, reason
from fastlink.io.reader import as_map
from fastlink.maps.best import least
from fastlink.pictures.content import ONE, POOLS, Places, Ranges, Values, Window, content_of, page_of

# -- Write a map as one page that needs neither Python nor a network


#: Bytes of values, before they are compressed, that a page may carry: a browser keeps all of them in memory.
MOST_BYTES = 64 << 20
ENDINGS, EXAMPLE = (".html", ".htm"), "page.html"


def check_page(to: Any) -> Path:
    """Return the path of a page to write, or refuse it."""
    path = check_path(("to",), to, EXAMPLE)
    if path.suffix.lower() not in ENDINGS:
        raise InputError(f"{path}: a page ends in .html", where=("to",), remedy=f"write such as {EXAMPLE}")
    check_writable(path, "to", EXAMPLE)
    return path


def write_page(values: Values, path: Path) -> None:
    """Write the page of a map with all its values; an existing file is replaced.

    Results have the seven digits of 4 bytes, inputs all digits.
    """
    content = content_of(values)
    names = [*values.names, *(one["name"] for one in content["columns"])]
    total = sum(values.maps[name].size * _kind(values, name).itemsize for name in names)
    if total > MOST_BYTES:
        what = f"the page would hold {size(total)} of values, more than {size(MOST_BYTES)}"
        remedy = "take a part of the map by fastlink.convert, or leave it out"
        raise InputError(what, where=("to",), remedy=remedy)
    content |= {
        "served": False,
        "token": "",
        "arrays": {name: _packed(values, name) for name in names},
        "scales": {name: values.scale(name) for name in names},
    }
    write_whole(path, page_of(content).encode())


def _kind(values: Values, name: str) -> np.dtype[Any]:
    return np.dtype("<f4" if name in values.maps.data_vars else "<f8")


def _packed(values: Values, name: str) -> dict[str, Any]:
    """Return the dimensions of a variable or column, and its values compressed, the first bytes of all first."""
    kind = _kind(values, name)
    apart = np.ascontiguousarray(values.part(name, {}), dtype=kind).reshape(-1, 1).view(np.uint8).T
    data = base64.b64encode(zlib.compress(apart.tobytes())).decode()
    return {"type": kind.str[1:], "dims": values.dims(name), "data": data}


# -- Rank the designs of a region of a picture, and choose some of them to be drawn

#: Designs of a region that are drawn, and those that are listed as the best; values that are read at once.
MOST_ROWS, MOST_BEST, BLOCK = 1500, 12, 1 << 22


def region_of(
    values: Values, name: str, axes: tuple[str, ...], at: Places, window: Window, *, largest: bool
) -> dict[str, Any]:
    """Return some designs of a region with all variables, and the best of all of them."""
    ranges = {dim: range(window[dim][0], window[dim][1] + 1) for dim in axes}
    some = _some(ranges)
    grid = np.meshgrid(*some.values(), indexing="ij")
    found = {
        one: values.along(one, at, some).ravel().tolist()
        for one in values.names
        if {*values.dims(one)} <= {*at, *axes}
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


def _best(values: Values, name: str, at: Places, ranges: Ranges, sign: float) -> Iterator[tuple[Any, ...]]:
    """Yield the numbers along each axis of the designs of least value times sign; of equal ones the first."""
    shape = tuple(map(len, ranges.values()))
    first = next(dim for dim in values.dims(name) if dim in ranges)
    whole, axis = ranges[first], list(ranges).index(first)
    step = max(1, BLOCK // max(1, math.prod(shape) // len(whole)))
    ranked, chosen = np.empty(0), np.empty(0, dtype=np.int64)
    for start in range(0, len(whole), step):
        part = {**ranges, first: whole[start : start + step]}
        flat = sign * values.along(name, at, part).ravel().astype(float)
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


# -- Serve the page of one map on this machine: to whoever has its token, and nothing else than that map


#: The address that no other machine reaches; the most letters of a request.
HOST, LONGEST = "127.0.0.1", 16_384
#: What a query raises that the page would not send: with other names, values or places, or nested too deep.
BAD_REQUEST = (LookupError, ValueError, TypeError, AttributeError, OverflowError, RecursionError)
#: Seconds after which a connection without requests is closed.
IDLE = 300.0
POLICY = (
    "default-src 'none'; script-src 'nonce-{}'; style-src 'unsafe-inline'; connect-src 'self'; img-src data:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)


class Server:
    """A map that is served, until it is closed."""

    def __init__(self, values: Values, port: int = 0) -> None:
        self.values, self.token, self.nonce = values, secrets.token_urlsafe(24), secrets.token_urlsafe(18)
        content = {**content_of(values), "served": True, "token": self.token}
        self.page = page_of(content, self.nonce).encode()
        try:
            self.http = ThreadingHTTPServer((HOST, port), self._handler())
        except OSError as error:
            what = f"{port} cannot be listened to ({error.strerror})"
            raise InputError(what, where=("port",), remedy="leave it out, and a free one is taken") from error
        self.http.daemon_threads = True
        self.thread = threading.Thread(target=self.http.serve_forever, name="fastlink explore", daemon=True)
        self.thread.start()

    @property
    def port(self) -> int:
        """The port."""
        return int(self.http.server_address[1])

    @property
    def url(self) -> str:
        """The address of the page, with the token without which it is refused."""
        return f"http://{HOST}:{self.port}/?token={self.token}"

    def close(self) -> None:
        """Stop serving."""
        self.http.shutdown()
        self.http.server_close()

    def _picture(self, query: dict[str, Any]) -> bytes:
        name = str(query["name"])
        pool = str(query.get("pool", ONE))
        if pool not in (ONE, *POOLS):
            raise ValueError(pool)
        axes = tuple(query["axes"])
        values, steps, pool = self.values.picture(name, axes, _places(query), _window(query), pool)
        return _framed({"steps": steps, "pooled": pool, "scale": self.values.scale(name)}, values)

    def _column(self, query: dict[str, Any]) -> bytes:
        name = str(query["name"])
        return _framed({"scale": self.values.scale(name)}, self.values.column(name, _places(query)))

    def _row(self, query: dict[str, Any]) -> bytes:
        return json.dumps(_numbers(self.values.row(_places(query)))).encode()

    def _region(self, query: dict[str, Any]) -> bytes:
        name, axes, largest = str(query["name"]), tuple(query["axes"]), bool(query["largest"])
        found = region_of(self.values, name, axes, _places(query), _window(query), largest=largest)
        best = [{**one, "row": _numbers(one["row"])} for one in found["best"]]
        return json.dumps({**found, "best": best}).encode()

    def _handler(self) -> type[BaseHTTPRequestHandler]:
        server = self

        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"
            # one answer, one packet: its head does not wait for the browser's word
            wbufsize, disable_nagle_algorithm = 1 << 16, True
            timeout = IDLE
            server_version, sys_version = "fastlink", ""

            def handle(self) -> None:
                with contextlib.suppress(ConnectionError):  # a browser that leaves before its answer
                    super().handle()

            def do_GET(self) -> None:
                status, kind, body = server.answered(self.path, self.headers)
                self.send_response(status)
                self.send_header("Content-Type", kind)
                self.send_header("Content-Length", str(len(body)))
                self.send_header("Cache-Control", "no-store")
                self.send_header("Referrer-Policy", "no-referrer")
                self.send_header("X-Content-Type-Options", "nosniff")
                self.send_header("Content-Security-Policy", POLICY.format(server.nonce))
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, format: str, *args: Any) -> None:
                """Print nothing: addresses hold the token."""

        return Handler

    def answered(self, path: str, headers: Any) -> tuple[int, str, bytes]:
        """Return status, type and body of the answer to a request.

        The name by which the browser knows this machine is checked too: another site's name may lead here.
        """
        text = "text/plain; charset=utf-8"
        if headers.get("Host") not in (f"{HOST}:{self.port}", f"localhost:{self.port}"):
            return 403, text, b"refused: this is not the address of the page"
        try:
            address = urlsplit(path)
            asked = parse_qs(address.query)
        except ValueError:
            return 400, text, b"not an address"
        given = headers.get("X-Token") if address.path != "/" else asked.get("token", [""])[0]
        if not hmac.compare_digest((given or "").encode(), self.token.encode()):
            return 403, text, b"refused: open the address that fastlink has printed, with its token"
        if address.path == "/":
            return 200, "text/html; charset=utf-8", self.page
        answers = {"picture": self._picture, "column": self._column, "row": self._row, "region": self._region}
        answer = answers.get(address.path.removeprefix("/"))
        if answer is None:
            return 404, text, b"there is nothing of that name"
        try:
            return 200, "application/octet-stream", answer(json.loads(asked["query"][0][:LONGEST]))
        except BAD_REQUEST as error:
            return 400, text, f"not a request of the page ({type(error).__name__})".encode()
        except Exception as error:  # whatever reading a file brings: the connection lives on
            return 500, text, printable(f"the map cannot be read ({reason(error)})").encode()


def _places(query: dict[str, Any]) -> Places:
    return {str(dim): operator.index(place) for dim, place in query["at"].items()}


def _window(query: dict[str, Any]) -> Window:
    return {
        str(dim): (operator.index(low), operator.index(high)) for dim, (low, high) in query["window"].items()
    }


def _numbers(found: dict[str, Any]) -> dict[str, Any]:
    """Return values for JSON, which has no words for NaN and infinities: these are texts that JavaScript reads."""
    words = {"nan": "NaN", "inf": "Infinity", "-inf": "-Infinity"}
    return {name: words.get(str(value), value) for name, value in found.items()}


def _framed(head: dict[str, Any], values: Any) -> bytes:
    """Return a head of JSON and doubles of half length, which begin at a multiple of four bytes."""
    text = json.dumps(head).encode()
    text += b" " * (-len(text) % 4)
    return len(text).to_bytes(4, "little") + text + np.ascontiguousarray(values, dtype="<f4").tobytes()


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


@door
def explore(maps: Any, *, to: str | Path | None = None, port: int = 0, browser: bool = True) -> Page:
    """Show a map in a browser, served on this machine alone, or write it as a page.

    The map as a picture, with a slider for each input that it does not show; the values under the cursor, and beside
    them the mechanism of that design, moving. The address has a random token, and nothing but this map is served.

    Parameters
    ----------
    maps : xarray.Dataset or path
        From `fastlink.sweep`, `fastlink.run` or `fastlink.open`, or the file of a map; read where it is looked
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
    require_package("matplotlib", ("explore",))
    check_switch(("browser",), browser)
    check_whole(("port",), port, 0, LAST_PORT)
    path = None if to is None else check_page(to)
    with ExitStack() as stack:
        values = Values(
            stack.enter_context(as_map(maps)), Path(maps) if isinstance(maps, (str, PathLike)) else None
        )
        if path is not None:
            write_page(values, path)
            return Page(path.absolute().as_uri(), ExitStack())
        server = Server(values, port)
        stack.callback(server.close)
        page = Page(server.url, stack.pop_all())
    if browser:
        import webbrowser

        webbrowser.open(page.url)
    return page
