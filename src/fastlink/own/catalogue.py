"""The catalogue of a mechanism with a user's declarations beside its own, which stay as they are."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache
from typing import Any

from fastlink.catalogue.catalogue import Catalogue
from fastlink.errors import InputError, suggest
from fastlink.facts.fact import CatalogueError, Fact, System
from fastlink.facts.names import (
    Derivative,
    ErrorBound,
    ListOfExtrema,
    Quantity,
    Reduced,
    Trust,
    bounded_of,
    error_name,
    root_of,
)
from fastlink.own.definition import Definition, OwnInput, OwnQuantity, check_dimension, function_of
from fastlink.own.kinks import MOST_KINKS, only_name, split
from fastlink.symbolic.derivative import NoDerivative

__all__ = ["extended", "own_names", "used"]


@lru_cache(maxsize=64)
def extended(
    base: Catalogue, version: int, definition: Definition, first: Catalogue | None = None
) -> Catalogue:
    """Return a catalogue with these declarations, the same one for the same declarations.

    Parameters
    ----------
    base : Catalogue
        That of the mechanism.
    version : int
        Its version.
    definition : Definition
        The declarations.
    first : Catalogue, optional
        That by the first input, with the declarations, where `base` is that by another one: a quantity that depends on
        what is not offered there is not offered, either.

    Raises
    ------
    InputError
        A name is taken, a parameter is unknown, or units do not fit.
    """
    own = base.copied()
    own.definition = definition
    if first is not None:
        own.first = first  # type: ignore[attr-defined]
    for one in definition:
        try:
            if isinstance(one, OwnInput):
                _check_free(own, one.name, "input")
                labels: dict[str, Any] = {"units": one.units, "symbol": one.symbol, "meaning": one.meaning}
                own.input(one.name, **labels, rule=one.rule, default=one.default)
            elif first is None or all(map(own.declares, map(_plain(own), one.parameters))):
                _declare(own, one)
        except CatalogueError as error:
            what = str(error).removeprefix(f"{own.name}: ")
            raise InputError(what, where=(one.name,), remedy="call it otherwise") from None
    return own


def _plain(catalogue: Catalogue) -> Any:
    """Return a function that returns the quantity whose derivative a name is, else the name."""

    def plain(name: str) -> str:
        tree = catalogue.parse(name)
        return plain(str(tree.of)) if isinstance(tree, Derivative) else name

    return plain


def own_names(catalogue: Catalogue, names: Iterable[str]) -> set[str]:
    """Return those of these names that a user has declared as quantities."""
    return {name for name in names if name in catalogue.facts and catalogue.facts[name].own}


def used(catalogue: Catalogue, steps: Iterable[Fact | System], inputs: Iterable[str] = ()) -> Definition:
    """Return what a user has declared of that which some steps and inputs depend on."""
    if not catalogue.definition:
        return ()
    names = {root_of(catalogue.parse(step.name)) for step in steps if isinstance(step, Fact) and step.own}
    names.update(inputs)
    for one in reversed(catalogue.definition):
        if isinstance(one, OwnQuantity) and one.name in names:
            names.update(root_of(catalogue.parse(parameter)) for parameter in one.parameters)
            names.update(one.parameters)
    return tuple(one for one in catalogue.definition if one.name in names)


def _check_free(catalogue: Catalogue, name: str, noun: str) -> None:
    """Refuse a name that stands for something else."""
    if catalogue.is_public(name):
        kind = "is a quantity"
    elif name in catalogue.variables:
        kind = "is an input"
    elif catalogue.declares(name):
        kind = "is a step within the facts"
    else:
        return
    of = "" if catalogue.is_public(name) and catalogue.facts[name].own else f" of {catalogue.name}"
    raise InputError(f"{kind}{of} already", where=(name,), remedy=f"call the {noun} otherwise")


def _declare(catalogue: Catalogue, one: OwnQuantity) -> None:
    _check_free(catalogue, one.name, "quantity")
    units = [_units_of(catalogue, one, parameter) for parameter in one.parameters]
    check_dimension(one, units)
    labels: dict[str, Any] = {"units": one.units, "symbol": one.symbol, "meaning": one.meaning}
    catalogue.quantity(**labels, source=f"declared in {one.file}")(one.function)
    catalogue.facts[one.name] = replace(catalogue.facts[one.name], own=True)
    graded = catalogue.graded
    if graded is None:
        return
    jumps = one.jumps or own_names(catalogue, one.parameters) & set(graded.not_differentiable)
    if jumps or not _declare_kinks(catalogue, one, labels):
        names = (*graded.not_differentiable, one.name)
        catalogue.graded = replace(graded, not_differentiable=names)


def _declare_kinks(catalogue: Catalogue, one: OwnQuantity, labels: dict[str, Any]) -> bool:
    """Declare what vanishes at kinks and the smooth quantities between them; return False of too many kinks."""
    graded = catalogue.graded
    assert graded is not None
    known = {name: pieces for name, (_, pieces) in graded.kinks.items()}
    found = split(one.fact, one.parameters, known)
    if found is None:
        return True
    inner = tuple(switch for name in one.parameters if name in known for switch in graded.kinks[name][0])
    if found.too_many or len(inner) + len(found.switches) + len(found.pieces) > MOST_KINKS:
        return False
    kinks = *inner, *_steps_of(catalogue, one.name, "kink", found.switches, labels, one.file)
    pieces = _steps_of(catalogue, one.name, "piece", found.pieces, labels, one.file)
    catalogue.graded = replace(graded, kinks={**graded.kinks, one.name: (kinks, pieces)})
    return True


def _steps_of(
    catalogue: Catalogue, name: str, noun: str, texts: Iterable[str], labels: dict[str, Any], file: str
) -> tuple[str, ...]:
    """Declare texts as steps within the facts, and return their names; one that is a parameter is that."""
    names = []
    for k, text in enumerate(texts):
        if (own := only_name(text)) and catalogue.is_quantity(own):
            names.append(own)
            continue
        names.append(step := f"{name}_{noun}{k}")
        function = function_of(step, text.replace(f"def {name}(", f"def {step}(", 1) + "\n")
        catalogue.quantity(**labels, source=f"declared in {file}", internal=True)(function)
        catalogue.facts[step] = replace(catalogue.facts[step], own=True)
    return tuple(names)


def _units_of(catalogue: Catalogue, one: OwnQuantity, name: str) -> str:
    """Return the units of a parameter, or refuse what a quantity cannot depend on."""
    if name in catalogue.variables:
        return catalogue.variables[name].units
    if name == "branch":
        return "1"
    tree = catalogue.parse(name)
    of = bounded_of(tree)
    if isinstance(of, (Reduced, ListOfExtrema)) and catalogue.is_quantity(str(of.of)):
        what = f"the parameter {name} is of the whole cycle, and a quantity is of one input position"
        asked = ", ".join(str(Reduced(Quantity(one.name), how)) for how in ("max", "mean"))
        remedy = f"take {of.of}, and ask for the extremes of {one.name}: {asked}"
        raise InputError(what, where=(one.name,), remedy=remedy)
    if isinstance(tree, (ErrorBound, Trust)) and catalogue.is_quantity(str(tree.of)):
        what = f"the parameter {name} is an error bound"
        raise InputError(
            what, where=(one.name,), remedy=f"take {tree.of}; {error_name(one.name)} follows by itself"
        )
    if name == one.name:
        what = "depends on itself"
        raise InputError(what, where=(one.name,), remedy="take parameters that are declared before")
    if not catalogue.is_quantity(name):
        internal = catalogue.declares(name)
        what = f"the parameter {name} is {'a step within the facts' if internal else 'unknown'}"
        known = [*catalogue.public, *catalogue.variables]
        raise InputError(what, where=(one.name,), remedy=suggest(name, known))
    fact = catalogue.public_fact(name)
    _check_derivative(catalogue, one, name)
    return fact.units


def _check_derivative(catalogue: Catalogue, one: OwnQuantity, name: str) -> None:
    try:
        catalogue.resolve(name)
    except NoDerivative as error:
        raise InputError(
            f"the parameter {error.what}", where=(one.name,), remedy="take another one"
        ) from None
