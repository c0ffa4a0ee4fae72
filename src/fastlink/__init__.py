"""Planar linkages by the million: a design space in, one labelled HDF5 map out.

Names are imported on first use, so that ``fastlink --help`` loads nothing heavy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fastlink.analysis import focal, hart, minkowski, planar
    from fastlink.diagnostics import accuracy, accuracy_table
    from fastlink.diagnostics.explain import explain
    from fastlink.engine.evaluate import evaluate
    from fastlink.engine.function import function
    from fastlink.engine.sweep import sweep
    from fastlink.errors import InputError
    from fastlink.io.writer import open_map as open
    from fastlink.plot.plot_map import plot_map
    from fastlink.report.quantities import quantities
    from fastlink.report.summary import summary
    from fastlink.space.links import round_bar
    from fastlink.space.samplers import DesignSpace, grid, latin_hypercube, sobol, table
    from fastlink.study.study import run_study

_PLACES = {
    "accuracy": ("fastlink.diagnostics", "accuracy"),
    "accuracy_table": ("fastlink.diagnostics", "accuracy_table"),
    "DesignSpace": ("fastlink.space.design_space", "DesignSpace"),
    "InputError": ("fastlink.errors", "InputError"),
    "evaluate": ("fastlink.engine.evaluate", "evaluate"),
    "explain": ("fastlink.diagnostics.explain", "explain"),
    "function": ("fastlink.engine.function", "function"),
    "grid": ("fastlink.space.samplers", "grid"),
    "latin_hypercube": ("fastlink.space.samplers", "latin_hypercube"),
    "open": ("fastlink.io.writer", "open_map"),
    "plot_map": ("fastlink.plot.plot_map", "plot_map"),
    "quantities": ("fastlink.report.quantities", "quantities"),
    "round_bar": ("fastlink.space.links", "round_bar"),
    "run_study": ("fastlink.study.study", "run_study"),
    "sobol": ("fastlink.space.samplers", "sobol"),
    "summary": ("fastlink.report.summary", "summary"),
    "sweep": ("fastlink.engine.sweep", "sweep"),
    "table": ("fastlink.space.samplers", "table"),
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


def __getattr__(name: str) -> Any:
    from importlib import import_module

    if name in _PACKAGES:
        return import_module(f"fastlink.analysis.{name}")
    if name not in _PLACES:
        raise AttributeError(f"module 'fastlink' has no attribute {name!r}")
    module, attribute = _PLACES[name]
    value = getattr(import_module(module), attribute)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_PLACES, *_PACKAGES})
