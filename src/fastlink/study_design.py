"""The design space of a study, and what it lacks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.catalogue import Catalogue
from fastlink.cycle import Request
from fastlink.design import grid, latin_hypercube, sobol, table
from fastlink.errors import InputError
from fastlink.request import check_apart, check_inputs
from fastlink.space import DesignSpace
from fastlink.study_schema import Angles, Design, Problems

if TYPE_CHECKING:
    from numpy.typing import NDArray

SAMPLES = {"sobol": sobol, "latin_hypercube": latin_hypercube}


def angles_of(given: int | Angles | NDArray[Any]) -> int | NDArray[Any]:
    """Return the number of input angles, or the angles."""
    return np.asarray(_values(given)) if isinstance(given, Angles) else given


def _values(axis: Angles) -> Any:
    """Return the values of an axis, from its one key."""
    given = {name: value for name, value in axis if value is not None}
    if len(given) != 1:
        found = " and ".join(given) if given else "no key"
        raise InputError(f"has {found}; write exactly one of {', '.join(sorted(type(axis).model_fields))}")
    (kind, value), *_ = given.items()
    if kind == "values":
        return value
    low, high, n = value
    with np.errstate(all="ignore"):  # what overflows is found with its index, as any infinite value
        if kind == "linspace":
            return np.linspace(low, high, n)
        if not (low and high and (low > 0) == (high > 0)):
            raise InputError(f"geomspace runs from {low} to {high}; write ends of one sign, neither 0")
        return np.geomspace(low, high, n)


def space_of(found: Problems, path: Path, design: Design) -> DesignSpace | None:
    """Return the design space, or None when something is wrong with it."""
    before = len(found.lines)
    entries: dict[str, Any] = {}
    for name, entry in (design.model_extra or {}).items():
        with found.at(f"design.{name}"):
            entries[name] = _values(entry) if isinstance(entry, Angles) else entry
            grid(**{name: entries[name]})
    swept = [name for name, value in entries.items() if not isinstance(value, float)]
    kinds = [name for name in (*SAMPLES, "table") if getattr(design, name) is not None]
    if len(kinds) + bool(swept) > 1:
        both = [*kinds, *([f"axes ({', '.join(swept)})"] if swept else [])]
        found.add("design", f"has {' and '.join(both)}; write one of them, beside constants")
    if not (kinds or entries):
        found.add("design", "is empty; write a number or an axis for each input")
    if len(found.lines) > before:
        return None
    if not kinds:
        with found.at("design"):
            return grid(**entries)
        return None
    (kind,) = kinds
    with found.at(f"design.{kind}"):
        if kind == "table":
            space = table(path.parent / str(design.table))
        else:
            sample = getattr(design, kind)
            space = SAMPLES[kind](sample.n, seed=sample.seed, **sample.model_extra)
        for name in entries:
            if name in space.names:
                raise InputError(f"gives {name}, which stands in [design] too; write it once")
        return space.with_constants(entries)
    return None


def check_values(
    found: Problems, catalogue: Catalogue, design: Design, space: DesignSpace, alternatives: Sequence[str]
) -> None:
    """Check each input by itself, so that each is named."""
    inside = next((f"design.{kind}" for kind in (*SAMPLES, "table") if getattr(design, kind)), "design")
    for name in space.names:
        alone = replace(
            space,
            constants={name: space.constants[name]} if name in space.constants else {},
            axes={name: space.axes[name]} if name in space.axes else {},
            columns={name: space.columns[name]} if name in space.columns else {},
        )
        with found.at(f"{inside}.{name}" if alone.columns else f"design.{name}"):
            check_inputs(catalogue, alone, alternatives, False)
    with found.at("design"):
        check_apart(catalogue, space.names)


def missing_inputs(
    catalogue: Catalogue, requests: Sequence[Request], alternatives: Sequence[str], given: set[str]
) -> Iterator[tuple[str, str]]:
    """Yield each input that something asked for depends on and that nothing gives, and what to say of it."""
    known = catalogue.known_inputs(alternatives)
    absent = {name for name in known if name not in given and catalogue.lookup(name, alternatives) is None}
    tables = (catalogue.position.name, *catalogue.tables, *catalogue.table_low_parts)
    for request in requests:
        steps = catalogue.closure([request.quantity], {*given, *absent, *tables, "branch"}, alternatives)
        needed = absent & {need for step in steps for need in step.needs}
        for name in (name for name in known if name in needed):
            absent.discard(name)
            given.add(name)
            yield name, catalogue.absence(known[name], request.name)
