"""Planar linkages by the million: a design space in, one labelled HDF5 map out.

The public names are the imports below, each run when its name is first used, so that ``fastlink --help`` loads nothing
heavy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fastlink import focal as focal
    from fastlink import hart as hart
    from fastlink import minkowski as minkowski
    from fastlink import planar as planar
    from fastlink._text import __version__ as __version__
    from fastlink.app.accuracy import accuracy as accuracy
    from fastlink.app.explain import explain as explain
    from fastlink.app.report import quantities as quantities
    from fastlink.app.study import run as run
    from fastlink.app.tolerance import tolerance as tolerance
    from fastlink.design.best import best as best
    from fastlink.design.search import join as join
    from fastlink.design.search import search as search
    from fastlink.engine.evaluate import evaluate as evaluate
    from fastlink.engine.extend import extend as extend
    from fastlink.engine.function import function as function
    from fastlink.engine.sweep import sweep as sweep
    from fastlink.errors import InputError as InputError
    from fastlink.errors import InputWarning as InputWarning
    from fastlink.io.convert import convert as convert
    from fastlink.io.reader import check as check
    from fastlink.maps import open as open
    from fastlink.mechanisms import mechanism as mechanism
    from fastlink.mechanisms.linkage import linkage as linkage
    from fastlink.mechanisms.listing import mechanisms as mechanisms
    from fastlink.pictures.designs import plot as plot
    from fastlink.pictures.draw import draw as draw
    from fastlink.pictures.explore import explore as explore
    from fastlink.space.design_space import DesignSpace as DesignSpace
    from fastlink.space.design_space import round_bar as round_bar
    from fastlink.space.samplers import grid as grid
    from fastlink.space.samplers import latin_hypercube as latin_hypercube
    from fastlink.space.samplers import sobol as sobol
    from fastlink.space.tables import table as table
    from fastlink.synthesis.found import synthesise as synthesise
else:

    def _modules() -> dict[str, str]:
        """Return the module of each public name, read from the imports above."""
        import ast

        tree = ast.parse(__loader__.get_source(__name__))
        (block,) = [node for node in tree.body if isinstance(node, ast.If)]
        return {alias.name: statement.module for statement in block.body for alias in statement.names}

    _MODULES = _modules()
    __all__ = sorted(_MODULES)
    #: What others call what there is; and what replaces the names of 0.2.
    _MEANT = {
        "fl.search(...), or of a map fl.best(...)": "maximise maximize minimise minimize optimise optimize pareto",
        "fl.open(path)": "load load_dataset open_dataset read",
        "fl.sweep(...), or at single input positions fl.evaluate(...)": "analyse analyze compute simulate solve",
        "fl.draw(...) of a linkage, fl.plot(maps, name) or fl.explore(maps)": "animate figure show view visualize",
        "fl.convert(maps, to)": "export save to_csv write",
    }
    _GONE = {
        **{word: of for of, words in _MEANT.items() for word in words.split()},
        "accuracy_table": "fl.accuracy(study).fastlink.summary()",
        "finite": "maps.fastlink.finite()",
        "plot_designs": "fl.plot(maps, names), with kind='cumulative' of one name",
        "plot_front": "fl.plot(maps, minimise=..., maximise=...)",
        "plot_map": "fl.plot(maps, name)",
        "run_study": "fl.run(study)",
        "summary": "maps.fastlink.summary(), or fl.open(path).fastlink.summary()",
    }

    def __getattr__(name: str) -> object:
        from importlib import import_module

        if name not in _MODULES:
            raise _unknown(name)
        if _MODULES[name] == __name__:  # a package
            return import_module(f"{__name__}.{name}")
        value = getattr(import_module(_MODULES[name]), name)
        # a package of that name is there as soon as it is imported
        return globals().setdefault(name, value)

    def _unknown(name: str) -> Exception:
        """Return the error of a name that is not public, with the nearest that is."""
        # where a name is imported Python drops the text of an AttributeError, and keeps that of an ImportError
        import sys
        from importlib.util import find_spec

        from fastlink.errors import suggest

        remedy = f"write {_GONE[name]}" if name in _GONE else suggest(name, __all__)
        imported = sys._getframe(2).f_globals.get("__name__") == "importlib._bootstrap"
        if imported and find_spec(f"{__name__}.{name}") is None:
            return ImportError(f"cannot import {name!r} from 'fastlink'; {remedy}")
        return AttributeError(f"module 'fastlink' has no attribute {name!r}; {remedy}")

    def __dir__() -> list[str]:
        return __all__
