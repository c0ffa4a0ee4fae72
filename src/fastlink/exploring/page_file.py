"""Write a map as one page that needs neither Python nor a network."""

from __future__ import annotations

import base64
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from fastlink._text import size
from fastlink.errors import InputError
from fastlink.exploring.assembly import page_of
from fastlink.exploring.content import content_of
from fastlink.exploring.values import Values
from fastlink.io.output import write_whole
from fastlink.io.place import check_place
from fastlink.options import check_path

__all__ = ["check_page", "write_page"]

#: Bytes of values, before they are compressed, that a page may carry: a browser keeps all of them in memory.
MOST_BYTES = 64 << 20
ENDINGS, EXAMPLE = (".html", ".htm"), "page.html"


def check_page(to: Any) -> Path:
    """Return the path of a page to write, or refuse it."""
    path = check_path(("to",), to, EXAMPLE)
    if path.suffix.lower() not in ENDINGS:
        raise InputError(f"{path}: a page ends in .html", where=("to",), remedy=f"write such as {EXAMPLE}")
    check_place(path, "to", EXAMPLE)
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
    array, kind = values.maps[name], _kind(values, name)
    apart = np.ascontiguousarray(values.part(name, {}), dtype=kind).reshape(-1, 1).view(np.uint8).T
    data = base64.b64encode(zlib.compress(apart.tobytes())).decode()
    return {"type": kind.str[1:], "dims": [str(dim) for dim in array.dims], "data": data}
