"""The table [search] of a study: the designs that it searches, and what for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from fastlink.errors import InputError, Problem
from fastlink.searching.search import request_of
from fastlink.space.column import bounds_of
from fastlink.space.samplers import sobol
from fastlink.study.schema import KEYS

if TYPE_CHECKING:
    from fastlink.searching.result import Request
    from fastlink.space.design_space import DesignSpace

__all__ = ["asked_for", "request_of_search", "searched_space"]

#: The options of a search, and what they are unless a study gives them.
DEFAULTS: dict[str, Any] = {
    "minimise": (),
    "maximise": (),
    "where": None,
    "top": None,
    "infinite": False,
    "refine": True,
    "bounds": None,
}


def searched_space(space: DesignSpace, table: Mapping[str, Any]) -> DesignSpace:
    """Return the designs of a search: those of the study, or a sample of their ranges, or of other ones.

    Parameters
    ----------
    space : DesignSpace
        The designs of the study.
    table : mapping
        Its table [search].
    """
    if "samples" not in table:
        if "seed" in table:
            raise InputError("is given without samples", where=("seed",), remedy="write samples = 1_000_000")
        return space
    given = {**space.axes, **space.columns}
    ranges: dict[str, Any] = {name: bounds_of(values) for name, values in given.items()}
    ranges |= dict(table.get("bounds", {}))
    constants = {name: value for name, value in space.constants.items() if name not in ranges}
    try:
        return sobol(table["samples"], {**ranges, **constants}, seed=table.get("seed", 0))
    except InputError as error:
        raise InputError.of([_of_search(one) for one in error.problems]) from None


def _of_search(problem: Problem) -> Problem:
    """Return a problem of a sample with the path of the key of [search] that makes it."""
    _, *rest = problem.where or ("",)
    keys: dict[Any, tuple[str, ...]] = {"n": ("samples",), "seed": ("seed",)}
    name = rest[0] if rest else ""
    if name:
        return replace(problem, where=keys.get(name, ("bounds", str(name))))
    remedy = "write bounds = {a1 = [0.2, 0.5]}, or axes in [design]"
    return replace(problem, where=("samples",), remedy=remedy)


def asked_for(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return objectives, conditions and the refinement of a table [search], as a search takes them."""
    asked = DEFAULTS | {name: value for name, value in table.items() if name in DEFAULTS}
    return asked | ({"bounds": None} if "samples" in table else {})  # they are those of the sample


def request_of_search(
    mechanism: Any,
    space: DesignSpace,
    names: list[str],
    table: Mapping[str, Any],
    **options: Any,
) -> Request:
    """Return the request of the search of a study, or refuse it with all its problems; nothing is compiled."""
    of_sweep = {"branch": 1, "input": None, **options}
    if "options" not in of_sweep:
        of_sweep["options"] = KEYS["cycle"]
    return request_of(mechanism, space, names, asked_for(table), **of_sweep)
