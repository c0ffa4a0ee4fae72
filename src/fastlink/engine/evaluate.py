"""Evaluate quantities at given configurations, without compiling anything."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from fastlink.catalogue.catalogue import Catalogue, Fact, System
from fastlink.catalogue.declare import ELIMINATED
from fastlink.catalogue.evaluate import evaluate_step
from fastlink.catalogue.tables import angle_tables
from fastlink.doors import door
from fastlink.errors import InputError, Problems
from fastlink.mechanisms import NAMES, inputs_of
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.positions import check_keywords
from fastlink.plan.suggestions import require_quantity
from fastlink.plan.validate import (
    all_choices,
    check_branches,
    constants_of,
    unknown_input,
    variants_of,
)
from fastlink.space.links import Links
from fastlink.space.values import short_repr

__all__ = ["evaluate"]


@door
def evaluate(
    mechanism: str,
    quantities: Iterable[str],
    *,
    branch: Any = 1,
    links: Links | None = None,
    input: str | None = None,
    solver: str = ELIMINATED,
    **inputs: Any,
) -> dict[str, Any]:
    """Evaluate quantities at given configurations, without compiling anything.

    For a few thousand configurations of any broadcastable shape; `fastlink.sweep` is for millions, with
    the same bits.

    Parameters
    ----------
    mechanism : str
        Name of the mechanism.
    quantities : iterable of str
        Names of quantities (not of their extremes or means over the cycle).
    branch : int or array_like
        Assembly mode.
    links : Links, optional
        Where mass data come from.
    input : str, optional
        What drives, as in `fastlink.sweep`.
    solver : {"eliminated", "dense"}
        As in `fastlink.sweep`.
    **inputs : float, array_like or xarray.DataArray
        The inputs and the input position, broadcast against each other. A choice that is not given is its first.

    Returns
    -------
    dict
        Name to float, array or DataArray.

    Raises
    ------
    InputError
        A name is unknown or missing, or a branch is not an assembly mode.

    Examples
    --------
    >>> import fastlink as fl
    >>> fl.evaluate("planar_4r", ["B_y"], a1=3.0, a2=4.0, a3=5.0, a4=6.0, theta1=0.0, branch=2)["B_y"]
    4.0
    """
    catalogue = find_catalogue(mechanism, input)
    names = (quantities,) if isinstance(quantities, str) else tuple(quantities)
    of_links = dict(links.values) if links is not None else {}
    recipe = _recipe(
        catalogue,
        names,
        mechanism=mechanism,
        version=catalogue.version,
        solver=solver,
        model=None if links is None else links.model,
        of_links=tuple(of_links),
        inputs=tuple(inputs),
    )
    template, arrays = _to_arrays(recipe.defaults | of_links | inputs | {"branch": branch})
    if not np.all(sum(arrays["branch"] == mode for mode in catalogue.branches)):
        check_branches(catalogue, np.unique(branch))
    theta = arrays.pop(catalogue.position.name)
    tabled = angle_tables(catalogue, recipe.tables, np.ravel(theta))
    tabled = tabled.reshape(len(recipe.tables), *np.shape(theta))
    shape = np.broadcast_shapes(np.shape(theta), *(np.shape(value) for value in arrays.values()))
    arrays |= zip(recipe.tables, tabled, strict=True)
    with np.errstate(all="ignore"):
        for step in recipe.steps:
            evaluate_step(step, arrays)
    if template is None and not shape:
        return {name: float(arrays[name]) for name in names}
    results = {name: np.broadcast_to(arrays[name], shape) for name in names}
    if template is not None:
        return {name: template.copy(data=np.array(value)).rename(name) for name, value in results.items()}
    return {name: value[()] for name, value in results.items()}


@dataclass(frozen=True)
class _Recipe:
    """The steps from given inputs to quantities; to resolve takes longer than to run.

    Attributes
    ----------
    defaults : dict
        The inputs that are not given, but for those of the links.
    tables : tuple of str
        The functions of the input position that are read.
    steps : tuple of Fact or System
        Everything that is computed, in order.
    """

    defaults: dict[str, float]
    tables: tuple[str, ...]
    steps: tuple[Fact | System, ...]


@lru_cache(maxsize=256)
def _recipe(
    catalogue: Catalogue,
    names: tuple[str, ...],
    *,
    mechanism: str,
    version: int,
    solver: str,
    model: str | None,
    of_links: tuple[str, ...],
    inputs: tuple[str, ...],
) -> _Recipe:
    links = None if model is None else Links(model, {})
    variants = variants_of(catalogue, links, solver, inputs)
    for name in names:
        require_quantity(name, catalogue)
    _check_names(mechanism, catalogue, inputs, variants)
    codes = all_choices(catalogue, inputs, variants)
    defaults = constants_of(catalogue, links, variants) | {name: of[0] for name, of in codes.items()}
    position = catalogue.position.name
    if position not in inputs:
        declared = catalogue.position
        unit = "" if declared.units == "1" else f" in {declared.units}"
        what, where = f"is missing ({declared.meaning})", ("evaluate", position)
        raise InputError(what, where=where, remedy=f"give it{unit}")
    tables = (position, *catalogue.tables, *catalogue.table_low_parts)
    given = {*defaults, *inputs, *of_links, *tables, "branch"}
    steps = tuple(catalogue.dependencies(names, given, variants))
    read = {*names, *(need for step in steps for need in step.depends_on)}
    return _Recipe(defaults, tuple(name for name in tables if name in read), steps)


def _check_names(
    mechanism: str, catalogue: Catalogue, inputs: Iterable[str], variants: Iterable[str]
) -> None:
    """Refuse a keyword that is not an input, of which nothing would depend."""
    known, problems = catalogue.known_inputs(variants), Problems()
    for name in inputs:
        if name in (catalogue.position.name, *known):
            continue
        if any(name in inputs_of(other) for other in NAMES):
            with problems.at():
                check_keywords(mechanism, catalogue, [name], ())
        else:
            problems.noted.append(unknown_input(catalogue, name, known, "evaluate"))
    problems.stop()


def _to_arrays(values: Mapping[str, Any]) -> tuple[Any, dict[str, Any]]:
    """Return a DataArray of the broadcast shape, or None, and plain arrays."""
    labelled = {name: value for name, value in values.items() if hasattr(value, "dims")}
    if not labelled:
        # doubles of NumPy where there is one: twice as fast as arrays without axes
        return None, {name: _doubles(name, value)[()] for name, value in values.items()}
    import xarray as xr

    wrapped = {name: value if name in labelled else xr.DataArray(value) for name, value in values.items()}
    arrays = dict(zip(wrapped, xr.broadcast(*wrapped.values()), strict=True))
    template = next(iter(arrays.values())).astype(float)
    template.attrs = {}
    return template, {name: np.asarray(value.data, dtype=float) for name, value in arrays.items()}


def _doubles(name: str, value: Any) -> Any:
    try:
        return np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        what = f"is {short_repr(value)}"
        raise InputError(what, where=("evaluate", name), remedy="write numbers") from None
