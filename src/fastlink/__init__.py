"""Planar linkages by the million: a design space in, one labelled HDF5 map out.

Names are imported on first use, so that ``fastlink --help`` loads nothing heavy.
"""

from __future__ import annotations

import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fastlink import focal, hart, minkowski, planar
    from fastlink.accuracy import accuracy, accuracy_table
    from fastlink.design import DesignSpace, grid, latin_hypercube, sobol, table
    from fastlink.engine.function import function
    from fastlink.errors import InputError
    from fastlink.explain import explain
    from fastlink.links import round_bar
    from fastlink.listing import quantities
    from fastlink.plot import plot_map
    from fastlink.reading import evaluate
    from fastlink.store import open_map as open
    from fastlink.study import run_study
    from fastlink.summary import summary
    from fastlink.sweep import sweep

_PLACES = {
    "accuracy": ("fastlink.accuracy", "accuracy"),
    "accuracy_table": ("fastlink.accuracy", "accuracy_table"),
    "DesignSpace": ("fastlink.space", "DesignSpace"),
    "InputError": ("fastlink.errors", "InputError"),
    "evaluate": ("fastlink.reading", "evaluate"),
    "explain": ("fastlink.explain", "explain"),
    "function": ("fastlink.engine.function", "function"),
    "grid": ("fastlink.design", "grid"),
    "latin_hypercube": ("fastlink.design", "latin_hypercube"),
    "open": ("fastlink.store", "open_map"),
    "plot_map": ("fastlink.plot", "plot_map"),
    "quantities": ("fastlink.listing", "quantities"),
    "round_bar": ("fastlink.links", "round_bar"),
    "run_study": ("fastlink.study", "run_study"),
    "sobol": ("fastlink.design", "sobol"),
    "summary": ("fastlink.summary", "summary"),
    "sweep": ("fastlink.sweep", "sweep"),
    "table": ("fastlink.design", "table"),
}

#: Packages that are imported when first named.
_PACKAGES = ("focal", "hart", "minkowski", "planar")

__all__ = [
    "DesignSpace",
    "InputError",
    "accuracy",
    "accuracy_table",
    "evaluate",
    "explain",
    "focal",
    "function",
    "grid",
    "hart",
    "latin_hypercube",
    "minkowski",
    "open",
    "planar",
    "plot_map",
    "quantities",
    "round_bar",
    "run_study",
    "sobol",
    "summary",
    "sweep",
    "table",
]


class _Package(ModuleType):
    """A package whose public names win over its files of the same name.

    Importing the file ``fastlink/table.py`` would otherwise replace the function `fastlink.table`.
    """

    def __setattr__(self, name: str, value: Any) -> None:
        if not (name in _PLACES and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package


def __getattr__(name: str) -> Any:
    from importlib import import_module

    if name in _PACKAGES:
        return import_module(f"fastlink.{name}")
    if name not in _PLACES:
        raise AttributeError(f"module 'fastlink' has no attribute {name!r}")
    module, attribute = _PLACES[name]
    value = getattr(import_module(module), attribute)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_PLACES, *_PACKAGES})
