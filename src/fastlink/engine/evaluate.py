"""Evaluate quantities at given configurations, without compiling anything."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from inspect import signature
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fastlink._text import counted
from fastlink.errors import InputError, KeyPath, Problem, Problems, Setting, check_switch, door
from fastlink.facts.catalogue import ELIMINATED, Catalogue
from fastlink.facts.evaluate import evaluate_on_doubles
from fastlink.facts.fact import Fact, Input, System
from fastlink.facts.powers import any_beyond_range
from fastlink.facts.tables import angle_tables
from fastlink.mechanisms import NAMES, inputs_of, name_of
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan import request
from fastlink.plan.query import check_names, parse_request, require_quantity
from fastlink.space.design_space import MOST_DIMS, Links, has, in_unit, numbers_of
from fastlink.space.units import RADIANS, remark_on_angles, remark_on_lengths

if TYPE_CHECKING:
    from fastlink.engine.extend import Extension


# -- Broadcast the numbers of a call: arrays by their shapes, DataArrays by the names of their dimensions


#: Most configurations at once; every value on the way is an array of as many.
MOST_CONFIGURATIONS = 10**8


def like(value: Any, numbers: NDArray[np.float64]) -> Any:
    """Return numbers with the labels of the value that they were read from."""
    if not hasattr(value, "dims"):
        return numbers
    import xarray as xr

    labelled = value if isinstance(value, xr.DataArray) else xr.DataArray(value)
    return labelled.copy(data=np.asarray(numbers))


def too_many(count: int, *inside: str) -> InputError:
    """Return the error of so many configurations that their arrays would fill the memory."""
    what = f"{counted(count, 'configuration')} are too many at once"
    return InputError(what, inside, f"write at most {MOST_CONFIGURATIONS}, or sweep them by fastlink.sweep")


def broadcast_inputs(function: str, values: Mapping[str, Any]) -> tuple[Any, dict[str, Any], tuple[int, ...]]:
    """Return a DataArray of the broadcast shape or else None, plain arrays, and the shape."""
    if not any(hasattr(value, "dims") for value in values.values()):
        return None, dict(values), _shape(function, {name: np.shape(of) for name, of in values.items()})
    import xarray as xr

    wrapped = [value if hasattr(value, "dims") else xr.DataArray(value) for value in values.values()]
    lengths: dict[Any, tuple[str, Any]] = {}
    for name, value in zip(values, wrapped, strict=True):
        for dim in value.dims:
            first, other = lengths.setdefault(dim, (name, value))
            if other.sizes[dim] != value.sizes[dim]:
                lengths_of = f"{counted(value.sizes[dim], 'value')} along {dim!r}, {first} {other.sizes[dim]}"
                raise InputError(f"has {lengths_of}", (function, name), "give equal lengths")
            index, known = value.indexes.get(dim), other.indexes.get(dim)
            if index is not None and known is not None and not index.equals(known):
                what = f"has other coordinates along {dim!r} than {first}"
                raise InputError(what, (function, name), "select those that both have")
            if index is not None and known is None:
                lengths[dim] = name, value
    shape = tuple(other.sizes[dim] for dim, (_, other) in lengths.items())
    if math.prod(shape) > MOST_CONFIGURATIONS:
        raise too_many(math.prod(shape), function)
    arrays = dict(zip(values, xr.broadcast(*wrapped), strict=True))
    template = next(iter(arrays.values())).astype(float)
    template.attrs = {}
    return template, {name: value.data for name, value in arrays.items()}, template.shape


def _shape(function: str, shapes: Mapping[str, tuple[int, ...]]) -> tuple[int, ...]:
    """Return the shape that all shapes broadcast to, or name two that do not broadcast."""
    try:
        shape = np.broadcast_shapes(*shapes.values())
    except ValueError:
        names = list(shapes)
        for k, name in enumerate(names):
            for other in names[:k]:
                try:
                    np.broadcast_shapes(shapes[name], shapes[other])
                except ValueError:
                    what = f"has the shape {shapes[name]}, which does not broadcast with {shapes[other]} of {other}"
                    remedy = "give equal lengths, or 1, along each axis"
                    raise InputError(what, (function, name), remedy) from None
        raise
    if shape and math.prod(shape) > MOST_CONFIGURATIONS:
        raise too_many(math.prod(shape), function)
    return shape


@door(hint="inputs are given by name, such as a1=0.5, or as **design")
def evaluate(
    mechanism: str | Extension,
    quantities: Iterable[str],
    *,
    branch: Any = 1,
    links: Links | None = None,
    input: str | None = None,
    solver: str = ELIMINATED,
    allow_invalid: bool = False,
    **inputs: Any,
) -> dict[str, Any]:
    """Evaluate quantities at given configurations, without compiling anything.

    For a few thousand configurations of any broadcastable shape; `fastlink.sweep` is for millions, with
    the same bits.

    Parameters
    ----------
    mechanism : str or Extension
        Name of the mechanism.
    quantities : sequence of str
        Names of quantities (not of their extremes or means over the cycle, which `fastlink.sweep` computes).
    branch : int or array_like
        Branch, or an array of them that is broadcast with the inputs.
    links : Links, optional
        Where mass data come from.
    input : str, optional
        What drives, as in `fastlink.sweep`.
    solver : {"eliminated", "dense"}
        As in `fastlink.sweep`.
    allow_invalid : bool, default False
        Evaluate impossible values too (NaN, a length that is not positive, a number beyond 2^-80 to 2^80, NaN in an
        array of branches) instead of refusing them; what depends on them is NaN or flagged.
    **inputs : float, array_like or xarray.DataArray
        The inputs and the input position (in other units by names such as ``theta1_deg``), broadcast against each
        other: arrays by their shapes, DataArrays by the names of their dimensions, whose coordinates must agree. A
        choice that is not given is its first.

    Returns
    -------
    dict
        Name to float, array or DataArray; a DataArray has the attributes ``units``, ``long_name``, ``symbol`` and
        ``references``, as in a map.

    Examples
    --------
    >>> fl.evaluate("planar_4r", ["B_y"], a1=3.0, a2=4.0, a3=5.0, a4=6.0, theta1=0.0, branch=2)["B_y"]
    4.0
    """
    catalogue, problems = find_catalogue(mechanism, input), Problems()
    if not _variables(catalogue, catalogue.version).issuperset(inputs):
        inputs = request.keywords_in_si(catalogue, "evaluate", inputs, problems, position=True)
    version = catalogue.version
    names = problems.attempt(check_names, "quantities", quantities) or ()
    of_design = bool(names) and problems.attempt(_check_quantities, catalogue, version, names) is False
    problems.attempt(request.check_model, catalogue, links, solver)
    allow_invalid = problems.attempt(check_switch, ("allow_invalid",), allow_invalid)
    of_links = links.values if isinstance(links, Links) else {}
    variants = request.selected_variants(catalogue, links, solver, inputs)
    if of_design and catalogue.position.name not in inputs:
        inputs = {**inputs, catalogue.position.name: 0.0}  # which nothing depends on
    given = _given(catalogue, version, name_of(mechanism), variants, tuple(of_links), tuple(inputs))
    problems.noted += given.problems
    values: dict[str, Any] = dict(given.defaults)
    values["branch"] = problems.attempt(_branches, catalogue, branch, allow_invalid is True)
    for name, value in {**of_links, **inputs}.items():
        if name in given.declared:
            values[name] = problems.attempt(_checked, given.declared[name], value, allow_invalid is True)
    if not problems.noted:
        recipe = problems.attempt(_recipe, catalogue, version, names, given)
    problems.stop()
    tables, steps = recipe
    template, arrays, shape = broadcast_inputs("evaluate", values)
    theta = arrays.pop(catalogue.position.name)
    if catalogue.position.units == RADIANS:
        remark_on_angles(catalogue.position.name, theta, "evaluate")
    if "radius" in arrays:
        lengths = [name for name, one in given.declared.items() if one.units == "m" and name in arrays]
        remark_on_lengths({name: float(np.max(abs(arrays[name]))) for name in lengths}, "evaluate")
    tabled = angle_tables(catalogue, tables, np.ravel(theta))
    arrays |= zip(tables, tabled.reshape(len(tables), *np.shape(theta)), strict=True)
    far = any_beyond_range(given.declared, arrays) if allow_invalid else np.False_
    if far.any():
        arrays |= {
            name: np.where(far, np.nan, value) for name, value in arrays.items() if name in given.declared
        }
    evaluate_on_doubles(steps, arrays)
    if allow_invalid:
        _leave_gaps(steps, arrays)
    if far.any() and (flag := request.flag_beyond_range(catalogue, names)):
        arrays["status"] = np.where(far, flag[1], arrays["status"])
    if template is None and not shape:
        return {name: float(arrays[name]) for name in names}
    results = {name: np.broadcast_to(arrays[name], shape) for name in names}
    if template is not None:
        labels = _labels(catalogue, version, names)
        labelled = {name: template.copy(data=np.array(results[name])).rename(name) for name in names}
        return {name: result.assign_attrs(labels[name]) for name, result in labelled.items()}
    return {name: value[()] for name, value in results.items()}


#: The keywords of `evaluate` besides mechanism, quantities and inputs.
_OPTIONS = tuple(signature(evaluate).parameters)[2:-1]


@dataclass(frozen=True, eq=False)
class _Given:
    """A request without its numbers: all that follows from the names of the given inputs."""

    #: Everything that has a value; the selected variants.
    names: tuple[str, ...]
    variants: tuple[str, ...]
    #: The inputs that may be given, with the input position.
    declared: dict[str, Input]
    #: The inputs that are not given, but for those of the links.
    defaults: dict[str, np.float64]
    #: Unknown names, and a missing input position.
    problems: list[Problem]


@lru_cache(maxsize=256)
def _given(
    catalogue: Catalogue,
    version: int,
    mechanism: str,
    variants: tuple[str, ...],
    of_links: tuple[str, ...],
    inputs: tuple[str, ...],
) -> _Given:
    position, known = catalogue.position, catalogue.known_inputs(variants)
    options = (*_OPTIONS, position.name)
    problems, others = Problems(), [name for name in inputs if name != position.name]
    for name in others:
        if name not in known and any(name in inputs_of(other) for other in NAMES):
            problems.attempt(request.check_keywords, mechanism, catalogue, [name], ())
            others = [other for other in others if other != name]
    problems.noted += request.name_problems(catalogue, others, known, "evaluate", options)
    if position.name not in inputs and not problems.noted:
        unit = "" if position.units == "1" else f" in {position.units}"
        problems.add(f"is missing ({position.meaning})", ("evaluate", position.name), f"give it{unit}")
    given = {*inputs, *of_links}
    codes = request.all_choices(catalogue, inputs, variants)
    numbers = request.constants_of(catalogue, None, variants) | {name: of[0] for name, of in codes.items()}
    defaults = {name: np.float64(value) for name, value in numbers.items() if name not in given}
    names = (*defaults, *given, "branch")
    return _Given(names, variants, {**known, position.name: position}, defaults, problems.noted)


@lru_cache(maxsize=64)
def _variables(catalogue: Catalogue, version: int) -> set[str]:
    """Return the names of every input, and of the input position."""
    return {*catalogue.all_inputs, catalogue.position.name}


@lru_cache(maxsize=256)
def _check_quantities(catalogue: Catalogue, version: int, names: tuple[str, ...]) -> bool:
    """Refuse unknown quantities, and what needs a whole cycle; tell whether one varies with the input position."""
    problems = Problems()
    for k, name in enumerate(names):
        with problems.at("quantities", k):
            require_quantity(name, catalogue)
    problems.stop()
    return any(catalogue.varies(name) for name in names)


@lru_cache(maxsize=256)
def _recipe(
    catalogue: Catalogue, version: int, names: tuple[str, ...], given: _Given
) -> tuple[tuple[str, ...], tuple[Fact | System, ...]]:
    """Return the functions of the input position that are read, and all steps; to resolve takes longer than to run."""
    position = catalogue.position.name
    tables = (position, *catalogue.tables, *catalogue.table_low_parts)
    try:
        steps = tuple(catalogue.dependencies(names, {*given.names, *tables}, given.variants))
    except InputError as error:
        missing: dict[KeyPath, Problem] = {}
        for name in names:
            absent = request.missing_inputs(catalogue, name, given.variants, given.names, "evaluate")
            missing |= {one.where: one for one in absent if one.where not in missing}
        raise InputError.of(request.joined_missing(missing.values())) if missing else error from None
    read = {*names, *(need for step in steps for need in step.depends_on)}
    return tuple(name for name in tables if name in read), steps


@lru_cache(maxsize=256)
def _labels(catalogue: Catalogue, version: int, names: tuple[str, ...]) -> dict[str, dict[str, Any]]:
    """Return the attributes of quantities, as in a map."""
    from fastlink.engine.labels import request_labels  # which the writer of maps shares

    labels = {name: request_labels(catalogue, parse_request(name, catalogue)) for name in names}
    for name in names:
        if catalogue.public_fact(name).flags:
            del labels[name]["units"]  # of a code
    return labels


def _branches(catalogue: Catalogue, branch: Any, allow_invalid: bool) -> Any:
    """Return branches as doubles of any shape, labelled if they are."""
    if type(branch) is int and branch in catalogue.branches:  # 2 us less than by an array
        return np.float64(branch)
    return like(branch, request.branch_codes(catalogue, branch, gaps=allow_invalid))


def _leave_gaps(steps: Iterable[Fact | System], arrays: dict[str, Any]) -> None:
    """Put NaN in place of all that depends on the branch where that is NaN."""
    gaps = np.isnan(arrays["branch"])
    if not np.any(gaps):
        return
    dependent = {"branch"}
    for step in steps:
        if not dependent.isdisjoint(step.depends_on):
            dependent.update(step.names)
            arrays.update({name: np.where(gaps, np.nan, arrays[name]) for name in step.names})


def _checked(declared: Input, value: Any, allow_invalid: bool) -> Any:
    """Return the values of an input as doubles of any shape, labelled if they are, or refuse them."""
    if type(value) is float and (allow_invalid or request.in_range(declared, value)):
        return np.float64(value)  # 5 us less than by an array
    size = value.size if has(value, "dtype") else 0
    if isinstance(size, int) and size > MOST_CONFIGURATIONS:
        raise too_many(size, "evaluate", declared.name)
    path = ("evaluate", declared.name)
    numbers = in_unit(path, value, numbers_of(*path, value, MOST_DIMS), declared.units)[()]
    if not allow_invalid and not np.all(request.in_range(declared, numbers)):
        keep = ((", or pass ", Setting("allow_invalid", True), " to get NaN there"),)
        raise InputError.of(
            request.value_problems(declared, np.asarray(numbers), "evaluate", keep, request.in_range)
        )
    return like(value, numbers)
