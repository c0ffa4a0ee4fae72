"""Checks of a request: inputs and their values, branches, links and solver."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable, Sequence
from functools import lru_cache, reduce
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.catalogue.catalogue import Catalogue, Input
from fastlink.catalogue.declare import ELIMINATED
from fastlink.errors import InputError, Model, Problem, Problems, suggest
from fastlink.plan.suggestions import input_remedy
from fastlink.space.links import Links

if TYPE_CHECKING:
    from fastlink.space.design_space import DesignSpace

__all__ = [
    "all_choices",
    "allowed",
    "check_branches",
    "check_inputs",
    "check_model",
    "constants_of",
    "selected_variants",
    "unknown_input",
    "variants_of",
]

RULES = {"positive": "greater than 0", "non-negative": "at least 0"}


def variants_of(
    catalogue: Catalogue, links: Links | None, solver: str, given: Iterable[str] = ()
) -> tuple[str, ...]:
    """Return the selected variants, each before the variants that it replaces facts of.

    Giving an input of a load selects its variant, see `Catalogue.variants_selected_by`.

    Raises
    ------
    InputError
        The mechanism has no such solver, or nothing depends on links.
    """
    check_model(catalogue, links, solver)
    return selected_variants(catalogue, links, solver, given)


def check_model(catalogue: Catalogue, links: Links | None, solver: str) -> None:
    """Refuse a solver and a model of the links that the mechanism does not have.

    Raises
    ------
    InputError
        With what there is.
    """
    problems = Problems()
    if solver not in catalogue.solvers and catalogue.solvers == (ELIMINATED,):
        what = f"{solver!r} is not a solver of {catalogue.name}, which has no linear system"
        problems.add(what, ("solver",), "leave solver out")
    elif solver not in catalogue.solvers:
        problems.add(f"{solver!r} is unknown", ("solver",), suggest(str(solver), catalogue.solvers))
    if links is not None and links.model not in catalogue.variant_inputs:
        problems.add(f"nothing of {catalogue.name} depends on mass", ("links",), "leave them out")
    problems.stop()


def selected_variants(
    catalogue: Catalogue, links: Links | None, solver: str, given: Iterable[str]
) -> tuple[str, ...]:
    """Return the selected variants where solver and links are checked already, see `variants_of`."""
    solved = () if solver == ELIMINATED else (solver,)
    return (*solved, *catalogue.variants_selected_by(given), *(() if links is None else (links.model,)))


def constants_of(catalogue: Catalogue, links: Links | None, variants: Iterable[str]) -> dict[str, float]:
    """Return the inputs that a design need not give: those of the links, and the defaults of the variants."""
    inputs = catalogue.known_inputs(variants).values()
    defaults = {known.name: known.default for known in inputs if known.default is not None}
    return defaults if links is None else defaults | dict(links.values)


def all_choices(
    catalogue: Catalogue, given: Iterable[str], variants: Iterable[str]
) -> dict[str, tuple[int, ...]]:
    """Return the codes of each input that has choices and is not given."""
    inputs = catalogue.known_inputs(variants)
    return {name: tuple(i.choices) for name, i in inputs.items() if i.choices and name not in given}


def check_inputs(
    catalogue: Catalogue, space: DesignSpace, variants: Sequence[str], allow_invalid: bool
) -> None:
    """Refuse an unknown input, and values that an input cannot have.

    Raises
    ------
    InputError
        With the input, the first bad value, its index and the values allowed.
    """
    known = catalogue.known_inputs(variants)
    problems = Problems()
    for name, other in _exclusive(catalogue, catalogue.version, tuple(space.names))[:1]:
        problems.add(f"{other} and {name} determine each other", ("design",), "leave one of them out")
    for name in space.names:
        value = space.constants.get(name)
        if name not in known:
            problems.noted.append(unknown_input(catalogue, name, known))
        elif not allow_invalid and (value is None or not allowed(known[name], value)):
            problems.noted += _bad_values(known[name], space)
    problems.stop()


@lru_cache(maxsize=256)
def _exclusive(catalogue: Catalogue, version: int, names: tuple[str, ...]) -> list[tuple[str, str]]:
    """Return the pairs of given inputs that determine each other."""
    return [
        (name, other)
        for name in names
        for other in catalogue.mutually_exclusive_inputs(name)
        if other in names
    ]


def allowed(declared: Input, value: Any) -> Any:
    """Tell whether an input may have a value; for an array, each of its values."""
    finite = abs(value) < math.inf
    if declared.choices:
        return finite & reduce(operator.or_, (value == code for code in declared.choices))
    if declared.rule == "positive":
        return finite & (value > 0)
    return finite & (value >= 0) if declared.rule == "non-negative" else finite


def unknown_input(catalogue: Catalogue, name: str, known: Iterable[str], parent: str = "design") -> Problem:
    """Return the problem of a name that is not among the known inputs."""
    for model, inputs in catalogue.variant_inputs.items():
        if name in inputs:
            remedy = ("write ", Model(model, tuple(inputs)), ", or leave it out")
            return Problem(f"belongs to links of model {model!r}", (parent, name), remedy)
    others = [key for inputs in catalogue.variant_inputs.values() for key in inputs]
    nearest = input_remedy(name, catalogue, [*known, *others])
    return Problem(f"is unknown to {catalogue.name}", (parent, name), nearest)


def _bad_values(declared: Input, space: DesignSpace) -> list[Problem]:
    """Return the first value that an input cannot have, if there is one."""
    name = declared.name
    values = space.values(name)
    bad = np.flatnonzero(~allowed(declared, values))[:1].tolist()
    rule = RULES.get(declared.rule, "")
    remedy = f"a finite number{' ' if rule else ''}{rule}"
    if declared.choices:
        remedy = "one of " + ", ".join(f"{code} ({meaning})" for code, meaning in declared.choices.items())
    return [
        Problem(
            f"is {values[k]} ({declared.meaning})",
            ("design", name, k) if values.size > 1 else ("design", name),
            f"write {remedy}",
        )
        for k in bad
    ]


def check_branches(catalogue: Catalogue, branch: Any) -> tuple[int, ...]:
    """Return the assembly modes as a tuple.

    Raises
    ------
    InputError
        None, an unknown or a repeated one is given.
    """
    where, remedy = ("branch",), f"write some of {', '.join(map(str, catalogue.branches))}"
    given = np.atleast_1d(np.asarray(branch, dtype=object)).tolist()
    for k, value in enumerate(given):
        if isinstance(value, bool) or value not in catalogue.branches:
            what = f"{value!r} is not an assembly mode of {catalogue.name}"
            raise InputError(what, where=where, remedy=remedy)
        if value in given[:k]:
            raise InputError(f"{value!r} is given twice", where=where, remedy="write each once")
    if not given:
        raise InputError("none is given", where=where, remedy=remedy)
    return tuple(int(value) for value in given)
