"""Make the designs of a request those of its mechanism: what is an input, a result, a label, in which unit."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import short_repr
from fastlink.errors import InputError, Problem, Problems, remark
from fastlink.plan.query import parse_request
from fastlink.plan.request import unknown_input
from fastlink.space.design_space import (
    BRANCH,
    COMMENT,
    DEGREE_UNIT,
    DEGREES,
    EXTREMUM,
    MODELS,
    RADIANS,
    Column,
    Converted,
    angle_of,
    as_floats,
    axis_of,
    check_angle,
    degrees_name,
    has_unit,
    remark_on_angles,
    unit_remedy,
)
from fastlink.space.tables import or_keep

if TYPE_CHECKING:
    from fastlink.facts.catalogue import Catalogue
    from fastlink.facts.fact import Input
    from fastlink.space.design_space import DesignSpace, Links


#: The attribute of a result that names what stood beside its designs and is ignored.
IGNORED = "design_ignored"


def designs_of(
    catalogue: Catalogue, space: DesignSpace, links: Links | None, problems: Problems
) -> DesignSpace:
    """Return the designs of a request: inputs alone, in the units of the mechanism, besides labels."""
    # Angles in degrees are converted. Results that stand in a table or come with a map are left out, with a
    # warning that names them; they are in the attribute ``design_ignored`` of the result. Rows of a map that
    # differ only in assembly mode or input position are one design.
    known, angles = _known_inputs(catalogue, catalogue.version)
    if space.labels:
        space = _inputs_of_labels(space, known, problems)
    if space.units:
        space = _check_units(space, known, problems)
    if any(map(angle_of, space.names)):
        space = _in_radians(space, known, problems)
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
            remark_on_angles(name, values, "design")
    if space.ignored and not problems.noted:
        names = ", ".join(space.ignored)
        what = f"results beside the designs are ignored: {names}"
        remark(what, remedy="a map's designs alone are maps.fastlink.designs")
        space = replace(space, attrs={**space.attrs, IGNORED: names})
    return space


@lru_cache(maxsize=64)
def _known_inputs(catalogue: Catalogue, version: int) -> tuple[dict[str, Input], tuple[str, ...]]:
    """Return every input of a mechanism, and the names of those that are angles; found once for a version of it."""
    known = catalogue.all_inputs
    return known, tuple(name for name, declared in known.items() if declared.units == RADIANS)


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


def _inputs_of_labels(space: DesignSpace, known: Mapping[str, Input], problems: Problems) -> DesignSpace:
    """Return designs whose labels are no inputs: an index may be one, texts may not."""
    inputs = [name for name in space.labels if name in known or angle_of(name) in known]
    constants, columns = dict(space.constants), dict(space.columns)
    for name in inputs:
        label = space.labels[name]
        if label.dtype.kind not in "iuf":
            text = next((str(cell) for cell in label.ravel()), "")
            problems.add(f"is {short_repr(text)}, not a number", ("design", name), "write numbers")
        elif label.ndim:
            columns[name] = label.astype(np.float64)
        else:
            constants[name] = float(label)
    labels = {name: label for name, label in space.labels.items() if name not in inputs}
    return replace(space, constants=constants, columns=columns, labels=labels)


def _check_units(space: DesignSpace, known: Mapping[str, Input], problems: Problems) -> DesignSpace:
    """Refuse values that state another unit than that of their input; degrees are converted."""
    degrees = []
    for name, unit in space.units.items():
        angle = "" if name in known else angle_of(name)
        if name not in space.names or not (name in known or angle in known):
            continue
        expected = DEGREE_UNIT if angle else known[name].units
        if unit in DEGREES and expected == RADIANS:
            degrees.append(name)
        elif not has_unit(unit, expected):
            problems.add(f"has the unit {unit!r}", ("design", name), unit_remedy(expected))
    return _renamed(space, {name: name for name in degrees}, problems)


def _in_radians(space: DesignSpace, known: Mapping[str, Input], problems: Problems) -> DesignSpace:
    """Return designs without angles in degrees."""
    renamed, wrong = {}, []
    for name in space.names:
        angle = "" if name in known else angle_of(name)
        if angle in known:
            try:
                check_angle(name, angle, known[angle].units, space.names)
                renamed[name] = angle
            except InputError as error:
                (problem,) = error.problems
                problems.add(problem.what, ("design", name), problem.remedy)
                wrong.append(name)
    return _renamed(without(space, wrong), renamed, problems)


def _renamed(space: DesignSpace, angles: Mapping[str, str], problems: Problems) -> DesignSpace:
    """Return designs with angles in radians, by the names of the inputs."""
    if not angles:
        return space

    def converted(values: Mapping[str, Any]) -> dict[str, Any]:
        return {
            angles.get(name, name): _in_radians_where_read(value) if name in angles else value
            for name, value in values.items()
        }

    axes = converted(space.axes)
    for name in angles:
        if name in space.axes:  # two angles that differ by less than a rounding are one in radians
            problems.attempt(axis_of, "design", angles[name], axes[angles[name]])
    constants = {name: float(value) for name, value in converted(space.constants).items()}
    doubtful = {angles.get(name, name): problem for name, problem in space.doubtful.items()}
    parts: Any = {"constants": constants, "columns": converted(space.columns), "doubtful": doubtful}
    comments = space.comments | dict.fromkeys(angles.values(), COMMENT)
    dims = tuple(angles.get(dim, dim) for dim in space.dims)
    return replace(space, dims=dims, axes=axes, comments=comments, **parts)


def _in_radians_where_read(degrees: Any) -> Any:
    """Return values in radians; those that are computed where they are looked at are converted there."""
    return Converted(degrees, as_floats) if isinstance(degrees, Column) else as_floats(degrees)


def _without_results(
    catalogue: Catalogue, space: DesignSpace, known: Mapping[str, Input], problems: Problems
) -> DesignSpace:
    """Return the designs of a table without results of the mechanism, each design of a map once."""
    others = [name for name in (*space.columns, *space.constants, *space.labels) if name not in known]
    results = [name for name in others if _is_result(catalogue, name)]
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


def _is_result(catalogue: Catalogue, name: str) -> bool:
    try:
        parse_request(name, catalogue)
    except InputError:
        return False
    return True


def _no_input(catalogue: Catalogue, name: str) -> Problem | None:
    """Return the problem of an option that stands among the inputs, None of another name."""
    if name == BRANCH:
        return Problem("is not an input", ("design", name), "write it as an option of the sweep")
    if name in (catalogue.position.name, degrees_name(catalogue.position.name)):
        remedy = "write it as an option of the sweep; fastlink.evaluate takes one for each row"
        return Problem("is the input position, which each design runs through", ("design", name), remedy)
    return None


def _unknown(catalogue: Catalogue, name: str) -> Problem:
    """Return the problem of a column that is neither an input nor a result."""
    problem = unknown_input(catalogue, name, catalogue.inputs)
    return replace(problem, remedy=or_keep(str(problem.remedy), name))


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
