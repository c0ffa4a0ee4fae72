"""Planar linkages by the million: a design space in, one labelled HDF5 map out.

Names are imported on first use, so that ``fastlink --help`` loads nothing heavy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fastlink.design import DesignSpace, grid, latin_hypercube, sobol, table
    from fastlink.errors import InputError
    from fastlink.links import round_bar
    from fastlink.store import open_map as open
    from fastlink.sweep import sweep

_PLACES = {
    "DesignSpace": ("fastlink.space", "DesignSpace"),
    "InputError": ("fastlink.errors", "InputError"),
    "grid": ("fastlink.design", "grid"),
    "latin_hypercube": ("fastlink.design", "latin_hypercube"),
    "open": ("fastlink.store", "open_map"),
    "round_bar": ("fastlink.links", "round_bar"),
    "sobol": ("fastlink.design", "sobol"),
    "sweep": ("fastlink.sweep", "sweep"),
    "table": ("fastlink.design", "table"),
}

__all__ = [
    "DesignSpace",
    "InputError",
    "grid",
    "latin_hypercube",
    "open",
    "round_bar",
    "sobol",
    "sweep",
    "table",
]


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module 'fastlink' has no attribute {name!r}")
    from importlib import import_module

    module, attribute = _PLACES[name]
    value = getattr(import_module(module), attribute)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_PLACES})
