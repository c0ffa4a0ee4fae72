"""Find the design that is drawn: by numbers, in a study, or in a map."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import counted, short_repr
from fastlink.engine.designs import designs_of
from fastlink.errors import InputError, Problems, Setting, suggest
from fastlink.io.reader import as_map
from fastlink.mechanisms import NAMES
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.options import check_path, check_whole
from fastlink.plot.selection import nearest_place
from fastlink.space.dataset import STATUS
from fastlink.space.degrees import DEGREES, degrees_name
from fastlink.space.design_space import BRANCH, DESIGN, EXTREMUM
from fastlink.space.links import Links, taken_links
from fastlink.space.values import has
from fastlink.study.study import read_study

if TYPE_CHECKING:
    from fastlink.engine.extending import Extension

__all__ = ["Source", "read_source"]

STUDY, MAPS = ".toml", (".h5", ".hdf5", ".nc", ".he5")


@dataclass(frozen=True)
class Source:
    """A design and what else its source says.

    Attributes
    ----------
    mechanism : str or Extension
        The mechanism.
    inputs : dict
        Inputs, and the input position, as they were given.
    branch : int, sequence of int or None
        The assembly mode of a row, or those of a study.
    links : Links or None
        Where mass data come from.
    input : str or None
        What drives.
    own : str
        The text of a map's own quantities, which is not run.
    """

    mechanism: str | Extension
    inputs: dict[str, Any]
    branch: Any = None
    links: Links | None = None
    input: str | None = None
    own: str = ""


def read_source(
    mechanism: Any, design: Any, at: Any, inputs: Mapping[str, Any], trust_code: bool = False
) -> Source:
    """Return the design that a caller names, or refuse it."""
    if has(mechanism, "data_vars") or _is_file(mechanism):
        if not has(mechanism, "data_vars"):
            mechanism = check_path(("mechanism",), mechanism)
        read = partial(_of_study, trust_code) if _ends(mechanism) == STUDY else _of_map
        found = read(mechanism, design, at)
        own = {key: value for key, value in found.inputs.items() if not _is_given(key, inputs)}
        return replace(found, inputs={**own, **inputs})
    find_catalogue(mechanism)
    if at is not None:
        remedy = "leave it out, and give inputs by name"
        raise InputError("selects a design of a study or a map", where=("at",), remedy=remedy)
    if design is not None and not isinstance(design, Mapping):
        what = f"is {short_repr(design)}"
        raise InputError(what, where=("design",), remedy="write the inputs by name, such as a1=0.4")
    names = {} if design is None else dict(design)
    if others := [name for name in names if not isinstance(name, str)]:
        raise InputError(f"names {short_repr(others[0])}", where=("design",), remedy="write names of inputs")
    if twice := [name for name in names if name in inputs]:
        raise InputError(f"{twice[0]} is given twice", where=("design",), remedy="write it once")
    return Source(mechanism, {**names, **inputs})


def _ends(source: Any) -> str:
    return Path(source).suffix.lower() if isinstance(source, (str, os.PathLike)) else ""


def _is_file(source: Any) -> bool:
    """Tell whether a caller means a file rather than a mechanism."""
    if isinstance(source, str) and (source in NAMES or "\0" in source):
        return False
    try:
        return isinstance(source, os.PathLike) or _ends(source) in (STUDY, *MAPS)
    except Exception:  # whatever a class of somebody's does
        return False


def _is_given(name: str, inputs: Mapping[str, Any]) -> bool:
    """Tell whether a caller gives an input of the source anew, in whichever unit."""
    return any({one, degrees_name(one)} & {name, degrees_name(name)} for one in inputs)


def _of_study(trust_code: bool, path: Any, design: Any, at: Any) -> Source:
    """Return a design of a study."""
    study, problems = read_study(path, trust_code), Problems()
    options = study.options
    links, input = options.get("links"), options.get("input")
    space = designs_of(find_catalogue(study.mechanism, input), study.space, links, problems)
    problems.stop()
    along = {dim: space.axes.get(dim, np.arange(n)) for dim, n in zip(space.dims, space.shape, strict=True)}
    place = np.ravel_multi_index(_places(along, design, at), space.shape) if along else 0
    inputs = {name: float(values[0]) for name, values in space.at(np.array([place])).items()}
    return Source(study.mechanism, inputs, options.get("branch"), links, input)


def _of_map(maps: Any, design: Any, at: Any) -> Source:
    """Return a design of a map, or of rows of it; of a row, its assembly mode and input position too."""
    with as_map(maps) as dataset:
        mechanism, input = str(dataset.attrs.get("mechanism")), str(dataset.attrs.get("input"))
        catalogue = find_catalogue(mechanism, input)
        dims = [*(dataset[STATUS].dims if STATUS in dataset else ()), *dataset.dims]
        outside = {BRANCH, EXTREMUM, catalogue.position.name}
        along = {
            str(dim): dataset[dim].values if dim in dataset.coords else np.arange(dataset.sizes[dim])
            for dim in dict.fromkeys(dims)
            if dim not in outside
        }
        row = dataset.isel(dict(zip(along, _places(along, design, at), strict=True)))
        known = {*catalogue.known_inputs(catalogue.variant_inputs), catalogue.position.name}
        inputs: dict[str, Any] = {}
        for name in known:
            if name in row.variables and row[name].ndim == 0:
                units = row[name].attrs.get("units")
                inputs[degrees_name(name) if units in DEGREES else name] = float(row[name])
        branch = int(row[BRANCH]) if BRANCH in row.coords and row[BRANCH].ndim == 0 else None
        own = str(dataset.attrs.get("own_quantities", ""))
    links = taken_links(inputs)
    return Source(mechanism, inputs, branch, links, input, own)


def _places(along: Mapping[str, Any], design: Any, at: Any) -> tuple[int, ...]:
    """Return the place of a design along each dimension: by its number in C order, or by values."""
    shape = tuple(len(values) for values in along.values())
    size = int(np.prod(shape, dtype=np.int64))
    if size == 0:
        raise InputError("there are no designs", where=("mechanism",), remedy="draw one of another map")
    if design is not None and at is not None:
        raise InputError("is given beside design", where=("at",), remedy="leave one of them out")
    if at is not None:
        return _nearest_places(along, at)
    if design is None and size > 1:
        dim = next(iter(along))
        example = {dim: float(along[dim][0])} if along[dim].dtype.kind in "iuf" else {}
        remedy = (
            "choose one by ",
            Setting(DESIGN, 0),
            *((", or ", Setting("at", example)) if example else ()),
        )
        raise InputError(f"there are {counted(size, 'design')}", where=("design",), remedy=remedy)
    number = 0 if design is None else check_whole(("design",), design, 0, size - 1)
    return tuple(int(k) for k in np.unravel_index(number, shape)) if shape else ()


def _nearest_places(along: Mapping[str, Any], at: Any) -> tuple[int, ...]:
    """Return the place that is nearest to given values along each dimension."""
    if not isinstance(at, Mapping) or hasattr(at, "data_vars"):
        remedy = ("write such as ", Setting("at", {"a4": 1.0}))
        raise InputError(f"is {short_repr(at)}", where=("at",), remedy=remedy)
    problems, places = Problems(), []
    for dim in at:
        if dim not in along:
            problems.add(f"{short_repr(dim)} is not a dimension of the designs", ("at",), suggest(dim, along))
    for dim, values in along.items():
        if dim not in at and len(values) > 1:
            problems.add(f"{dim} has {len(values)} values", ("at",), f"write which, such as {values[0]:g}")
        with problems.at():
            places.append(nearest_place(dim, values, at[dim]) if dim in at else 0)
    problems.stop()
    return tuple(places)
