"""Make the designs of a request those of its mechanism: what is an input, a result, a label, in which unit."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import short_repr
from fastlink.errors import InputError, Problem, Problems, Remedy, Setting, remark
from fastlink.plan.query import Results
from fastlink.plan.request import ALLOW, unknown_input
from fastlink.space import units
from fastlink.space.design_space import BRANCH, EXTREMUM, MODELS, Column, Converted, Links, axis_of, bounds_of
from fastlink.space.tables import head_of

if TYPE_CHECKING:
    from fastlink.facts.catalogue import Catalogue
    from fastlink.facts.fact import Input
    from fastlink.space.design_space import DesignSpace


#: The attribute of a result that names what stood beside its designs and is ignored.
IGNORED = "design_ignored"


def designs_of(
    catalogue: Catalogue, space: DesignSpace, links: Links | None, problems: Problems, gaps: bool = False
) -> DesignSpace:
    """Return the designs of a request: inputs alone, in the units of the mechanism, besides labels."""
    # Values in another unit are converted. Results that stand in a table or come with a map are left out, with a
    # warning that names them; they are in the attribute ``design_ignored`` of the result. Rows of a map that
    # differ only in branch or input position are one design.
    known, angles, lengths = _known_inputs(catalogue, catalogue.version)
    if space.labels:
        space = _inputs_of_labels(space, known, problems, gaps)
    space = _in_si(space, known, problems)
    if space.of_map or space.attrs.get("design_kind") == "table":
        space = _without_results(catalogue, space, known, problems)
        if space.of_map:
            space = _without_models(space, catalogue, links)
        for name, problem in space.doubtful.items():
            if name in space.columns:
                problems.noted.append(problem)
    if not known.keys() >= set(space.names):
        others = (name for name in space.names if name not in known)
        options = {name: no_input for name in others if (no_input := _no_input(catalogue, name))}
        problems.noted += options.values()
        space = without(space, options)
    for name in angles:
        if name in space.names and name not in space.comments:
            given = space.columns.get(name)
            values = given.sample() if isinstance(given, Column) else space.values(name)
            units.remark_on_angles(name, values, "design")
    of_links = links.values if isinstance(links, Links) else {}
    if "radius" in {*of_links, *space.names}:
        given = {**space.columns, **space.axes}
        given |= {name: np.array(one) for name, one in {**space.constants, **of_links}.items()}
        sizes = {name: max(map(abs, bounds_of(given[name]))) for name in lengths if name in given}
        units.remark_on_lengths(sizes, "design")
    if space.ignored and not problems.noted:
        names = ", ".join(space.ignored)
        what = f"results beside the designs are ignored: {names}"
        remark(what, remedy="a map's designs alone are maps.fastlink.designs")
        space = replace(space, attrs={**space.attrs, IGNORED: names})
    return space


@lru_cache(maxsize=64)
def _known_inputs(catalogue: Catalogue, version: int) -> tuple[dict[str, Input], list[str], list[str]]:
    """Return every input of a mechanism, and the names of angles and of lengths; found once for a version of it."""
    known = catalogue.all_inputs
    angles = [name for name, one in known.items() if one.units == units.RADIANS]
    return known, angles, [name for name, one in known.items() if one.units == "m"]


def without(space: DesignSpace, names: Iterable[str]) -> DesignSpace:
    """Return designs without some inputs and labels."""
    gone = set(names)
    dims = [(dim, length) for dim, length in zip(space.dims, space.shape, strict=True) if dim not in gone]

    by_name = ("axes", "constants", "columns", "labels", "doubtful")
    rest: dict[str, Any] = {
        part: {name: of for name, of in getattr(space, part).items() if name not in gone} for part in by_name
    }
    shape = tuple(length for _, length in dims)
    return replace(space, dims=tuple(dim for dim, _ in dims), shape=shape, **rest)


def _inputs_of_labels(
    space: DesignSpace, known: Mapping[str, Input], problems: Problems, gaps: bool
) -> DesignSpace:
    """Return designs whose labels are no inputs: an index may be one, texts alone stand for NaN if that is allowed."""
    heads = {name: head_of(name) for name in space.labels}
    inputs = {name: head for name, head in heads.items() if units.split(head[0], known)[0] in known}
    constants, columns = dict(space.constants), dict(space.columns)
    for name, (of, _) in inputs.items():
        label = space.labels[name]
        if label.dtype.kind not in "iuf" and not (gaps and label.ndim):
            text = next((str(cell) for cell in label.ravel()), "")
            mend = units.named_with_unit(of, text, shown=not label.ndim)
            remedy: Remedy = mend or ("write numbers", *((ALLOW,) if label.ndim else ()))
            problems.add(f"is {short_repr(text)}, not a number", ("design", name), remedy)
        elif label.ndim:
            is_text = label.dtype.kind not in "iuf"
            columns[of] = np.full(len(label), np.nan) if is_text else label.astype(np.float64)
        else:
            constants[of] = float(label)
    labels = {name: label for name, label in space.labels.items() if name not in inputs}
    stated = {**space.units, **{of: unit for of, unit in inputs.values() if unit}}
    return replace(space, constants=constants, columns=columns, labels=labels, units=stated)


def _in_si(space: DesignSpace, known: Mapping[str, Input], problems: Problems) -> DesignSpace:
    """Return designs whose inputs are in units of SI and called by their own names, or note what cannot be."""
    found: dict[str, tuple[str, str, Fraction]] = {}
    wrong, others = [], {name: name for name in space.names}
    for name in space.names:
        of, unit = units.split(name, known)
        if of not in known:
            continue
        expected, stated = known[of].units, space.units.get(name, "")
        try:
            factor, unit = units.conversion(of, unit, stated, expected, others)
        except InputError as error:
            problems.noted += [replace(one, where=("design", name)) for one in error.problems]
            wrong.append(name)
        else:
            if unit:
                found[name] = of, unit, factor
    return _converted(without(space, wrong), found, problems) if found or wrong else space


def _converted(
    space: DesignSpace, found: Mapping[str, tuple[str, str, Fraction]], problems: Problems
) -> DesignSpace:
    """Return designs with the values of some inputs multiplied, by the names of the inputs."""
    own = {name: of for name, (of, *_) in found.items()}

    def converted(values: Mapping[str, Any]) -> dict[str, Any]:
        return {
            own.get(name, name): _multiple(value, found[name][2]) if name in found else value
            for name, value in values.items()
        }

    axes = converted(space.axes)
    for name, of in own.items():
        if name in space.axes:  # two values that differ by less than a rounding are one in another unit
            problems.attempt(axis_of, "design", of, axes[of])
    constants = {name: float(value) for name, value in converted(space.constants).items()}
    doubtful = {own.get(name, name): problem for name, problem in space.doubtful.items()}
    parts: Any = {"constants": constants, "columns": converted(space.columns), "doubtful": doubtful}
    comments = space.comments | {of: units.comment(unit) for of, unit, _ in found.values()}
    dims = tuple(own.get(dim, dim) for dim in space.dims)
    return replace(space, dims=dims, axes=axes, comments=comments, **parts)


def _multiple(values: Any, factor: Fraction) -> Any:
    """Return a multiple of values; of those that are computed where they are looked at there."""
    if isinstance(values, Column):
        return Converted(values, factor)
    return np.asarray(units.scaled(values, factor))


def _without_results(
    catalogue: Catalogue, space: DesignSpace, known: Mapping[str, Input], problems: Problems
) -> DesignSpace:
    """Return the designs of a table without results of the mechanism, each design of a map once."""
    others = [name for name in (*space.columns, *space.constants, *space.labels) if name not in known]
    results = [name for name in others if name in Results(catalogue)]
    values = [name for name in results if name not in space.labels]  # a coordinate of a Dataset is no news
    of_map = space.of_map or bool(values)
    inside = (BRANCH, EXTREMUM, catalogue.position.name)
    cycle = [name for name in others if name in inside and of_map]
    rest = [name for name in others if name not in (*results, *cycle, *space.labels)]
    unknown = [name for name in rest if _no_input(catalogue, name) is None]
    problems.noted += [_unknown(catalogue, name) for name in unknown]
    along = [name for name in cycle if name in space.columns or np.ndim(space.labels.get(name, 0.0))]
    space = without(space, (*results, *cycle, *unknown))
    if along and space.columns:
        space = _each_once(space)
    return replace(space, of_map=of_map, ignored=(*space.ignored, *values))


def _no_input(catalogue: Catalogue, name: str) -> Problem | None:
    """Return the problem of an option that stands among the inputs, None of another name."""
    if name == BRANCH:
        return Problem("is not an input", ("design", name), "write it as an option of the sweep")
    if units.split(name, (catalogue.position.name,))[0] == catalogue.position.name:
        remedy = "write it as an option of the sweep; fastlink.evaluate takes one for each row"
        return Problem("is the input position, which each design runs through", ("design", name), remedy)
    return None


def _unknown(catalogue: Catalogue, name: str) -> Problem:
    """Return the problem of a column that is neither an input nor a result."""
    problem = unknown_input(catalogue, name, catalogue.inputs)
    also = f"{' Or' if str(problem.remedy).endswith('?') else ', or'} pass "
    keep = (also, Setting("keep", [name]), " to keep it as a coordinate of the result")
    return replace(problem, remedy=(str(problem.remedy), keep))


def _each_once(space: DesignSpace) -> DesignSpace:
    """Return every design of a table once, in the order in which each comes first."""
    rows = np.stack(list(map(np.asarray, space.columns.values())), axis=1)
    _, first = np.unique(rows, axis=0, return_index=True)
    if first.size == space.size:
        return space
    chosen = np.sort(first)
    columns = {name: column[chosen] for name, column in space.columns.items()}
    labels = {name: label[chosen] if label.ndim else label for name, label in space.labels.items()}
    return replace(space, shape=(chosen.size,), columns=columns, labels=labels)


def _without_models(space: DesignSpace, catalogue: Catalogue, links: Links | None) -> DesignSpace:
    """Return the designs of a map without the inputs of a model of links that the request does not take from them."""
    given = dict(links.values) if links is not None else {}
    own = () if links is None else catalogue.variant_inputs.get(links.model, {})
    of_models = {name for model in MODELS for name in catalogue.variant_inputs.get(model, {})}
    gone = [name for name in space.constants if name in of_models and (name in given or name not in own)]
    return replace(without(space, gone), ignored=(*space.ignored, *gone)) if gone else space
