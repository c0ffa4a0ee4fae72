"""Checks of a request: inputs and their values, branches, links and solver."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import lru_cache, reduce
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import joined, short_repr
from fastlink.catalogue.catalogue import Catalogue, Input
from fastlink.catalogue.declare import ELIMINATED
from fastlink.catalogue.search import did_you_mean
from fastlink.errors import InputError, KeyPath, Model, Problem, Problems, Remedy, nearest, suggest
from fastlink.options import check_choice
from fastlink.plan.query import parse_request
from fastlink.plan.suggestions import input_remedy, suggest_input
from fastlink.space.column import Column, steps
from fastlink.space.links import MODELS, Links
from fastlink.space.values import cells_of, check_length, is_number, unmasked
from fastlink.symbolic.changes import is_tolerance

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.space.design_space import DesignSpace

__all__ = [
    "all_choices",
    "allowed",
    "branch_codes",
    "check_branches",
    "check_inputs",
    "check_model",
    "constants_of",
    "joined_missing",
    "missing_inputs",
    "name_problems",
    "selected_variants",
    "unknown_input",
    "value_problems",
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
    with problems.at():
        if catalogue.solvers == (ELIMINATED,) and not (isinstance(solver, str) and solver == ELIMINATED):
            what = f"{short_repr(solver)} is not a solver of {catalogue.name}, which has no linear system"
            raise InputError(what, where=("solver",), remedy="leave solver out")
        check_choice(("solver",), solver, catalogue.solvers)
    if links is not None and not isinstance(links, Links):
        remedy = "write fastlink.round_bar(density=..., radius=...), or leave links out"
        problems.add(f"is {short_repr(links)}, not a model of the links", ("links",), remedy)
    elif links is not None and links.model not in catalogue.variant_inputs:
        problems.add(f"nothing of {catalogue.name} depends on mass", ("links",), "leave them out")
    problems.stop()


def selected_variants(
    catalogue: Catalogue, links: Links | None, solver: str, given: Iterable[str]
) -> tuple[str, ...]:
    """Return the selected variants, see `variants_of`; what `check_model` refuses selects none."""
    solved = (solver,) if isinstance(solver, str) and solver != ELIMINATED else ()
    model = (links.model,) if isinstance(links, Links) else ()
    return (*solved, *catalogue.variants_selected_by(given), *model)


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
    of_sample = ("n", "seed") if space.kind in ("sobol", "latin_hypercube") else ()
    problems.noted += name_problems(catalogue, space.names, known, options=of_sample)
    for name in filter(known.__contains__, space.names):
        value = space.constants.get(name)
        if not allow_invalid and (value is None or not allowed(known[name], value)):
            column = space.columns.get(name)
            if isinstance(column, Column):
                problems.noted += _column_problems(known[name], column)
            else:
                problems.noted += value_problems(known[name], space.values(name), "design")
    problems.stop()


def name_problems(
    catalogue: Catalogue,
    names: Sequence[str],
    known: Iterable[str],
    parent: str = "design",
    options: Sequence[str] = (),
) -> list[Problem]:
    """Return the problems of names that are given for inputs: unknown ones, and pairs that determine each other.

    `parent` heads their paths; `options` are what else may be given there by name, for a hint.
    """
    exclusive = _exclusive(catalogue, catalogue.version, tuple(names))[:1]
    return [
        *(
            Problem(f"{other} and {name} determine each other", (parent,), "leave one of them out")
            for name, other in exclusive
        ),
        *(unknown_input(catalogue, name, known, parent, options) for name in names if name not in known),
    ]


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


def unknown_input(
    catalogue: Catalogue,
    name: str,
    known: Iterable[str],
    parent: str = "design",
    options: Sequence[str] = (),
) -> Problem:
    """Return the problem of a name that is not among the known inputs."""
    for model, inputs in catalogue.variant_inputs.items():
        if name in inputs:
            mend = ("write ", Model(model, tuple(inputs)), ", or leave it out")
            return Problem(f"belongs to links of model {model!r}", (parent, name), mend)
    if "tol" in name and (near := nearest(name, catalogue.tolerances)):
        return Problem(f"is unknown to {catalogue.name}", (parent, name), did_you_mean([near]))
    every = {*known, *(key for inputs in catalogue.variant_inputs.values() for key in inputs)}
    names = sorted(key for key in every if not is_tolerance(key))  # each input has two, by a rule
    option = nearest(name, options)
    near_an_option = option and not nearest(name, names) and not suggest_input(name, catalogue)
    remedy = suggest(name, options) if near_an_option else input_remedy(name, catalogue, names)
    return Problem(f"is unknown to {catalogue.name}", (parent, name), remedy)


def value_problems(
    declared: Input, values: NDArray[np.float64], parent: str, remedy: Remedy = ""
) -> list[Problem]:
    """Return the first value that an input cannot have, if there is one; a further remedy may be given."""
    bad = np.flatnonzero(~allowed(declared, values))[:1]
    if not bad.size:
        return []
    index: Sequence[Any] = np.unravel_index(bad[0], values.shape) if values.size > 1 else ()
    value = values.flat[bad[0]]
    rule = RULES.get(declared.rule, "")
    mend = f"write a finite number{' ' if rule else ''}{rule}"
    if declared.choices and np.isfinite(value):
        mend = "write one of " + ", ".join(
            f"{code} ({meaning})" for code, meaning in declared.choices.items()
        )
    where: KeyPath = (parent, declared.name, *(int(k) for k in index))
    return [Problem(f"is {value} ({declared.meaning})", where, (mend, *remedy) if remedy else mend)]


def _column_problems(declared: Input, column: Column) -> list[Problem]:
    """Return the first value of a column that an input cannot have, if its bounds do not rule it out."""
    if not declared.choices and all(allowed(declared, end) for end in column.bounds):
        return []
    for start, stop in steps(0, len(column)):
        values = column.piece(start, stop)
        for row in np.flatnonzero(~allowed(declared, values))[:1].tolist():
            (problem,) = value_problems(declared, values[row : row + 1], "design")
            return [replace(problem, where=(*problem.where, start + row))]
    return []


def missing_inputs(
    catalogue: Catalogue, name: str, variants: Sequence[str], given: Iterable[str], parent: str = "design"
) -> list[Problem]:
    """Return a problem for each input that a quantity depends on and nothing gives."""
    of_links = {name for model in MODELS for name in catalogue.variant_inputs.get(model, {})}
    known, has = catalogue.known_inputs(variants), set(given)
    absent = {
        name
        for name in known
        if name not in has and not is_tolerance(name) and catalogue.resolve(name, variants) is None
    }
    tables = (catalogue.position.name, *catalogue.tables, *catalogue.table_low_parts)
    request = parse_request(name, catalogue)
    steps = catalogue.dependencies([request.quantity], {*has, *absent, *tables, "branch"}, variants)
    needed = absent & {need for step in steps for need in step.depends_on}
    return [
        catalogue.missing_problem(known[key], request.name, "links" if key in of_links else parent)
        for key in known
        if key in needed
    ]


def joined_missing(problems: Iterable[Problem]) -> list[Problem]:
    """Return missing inputs with one problem for all mass data that a model of the links would give at once."""
    groups: dict[tuple[KeyPath, Remedy], list[Problem]] = {}
    for one in problems:
        models = one.remedy[1:] if isinstance(one.remedy, tuple) else ()
        groups.setdefault((one.where[:-1], models) if models else (one.where, ""), []).append(one)
    return [group[0] if len(group) == 1 else _joined(group) for group in groups.values()]


def _joined(group: Sequence[Problem]) -> Problem:
    names = joined([str(one.where[-1]) for one in group])
    dependents = list(dict.fromkeys(str(one.remedy[0]).partition(" ")[0] for one in group))
    needed = f"{joined(dependents)} depend{'' if dependents[1:] else 's'} on them: add them"
    return Problem(f"{names} are missing", group[0].where[:-1], (needed, *group[0].remedy[1:]))


def branch_codes(catalogue: Catalogue, branch: Any, *, gaps: bool = False) -> NDArray[np.float64]:
    """Return assembly modes as numbers of the same shape, among which NaN may stand if there may be gaps.

    Raises
    ------
    InputError
        One is unknown, or is not a number.
    """
    if isinstance(branch, np.ma.MaskedArray):
        branch = unmasked(branch)
    remedy = f"write some of {', '.join(map(str, catalogue.branches))}"
    check_length(("branch",), branch, remedy)
    values = cells_of(branch)
    if values.dtype.kind in "iuf":
        known = np.isin(values, tuple(catalogue.branches))
        bad = values[~(known | np.isnan(values) if gaps else known)].ravel()[:1].tolist()
    else:
        cells = values.ravel().tolist()
        bad = [cell for cell in cells if not (_is_branch(catalogue, cell) or (gaps and _is_gap(cell)))][:1]
    for value in bad:
        what = f"{short_repr(value)} is not an assembly mode of {catalogue.name}"
        raise InputError(what, where=("branch",), remedy=remedy)
    return values.astype(np.float64)


def _is_branch(catalogue: Catalogue, value: object) -> bool:
    return is_number(value) and isinstance(value, Real) and value in catalogue.branches


def _is_gap(value: object) -> bool:
    return isinstance(value, float) and math.isnan(value)


def check_branches(catalogue: Catalogue, branch: Any) -> tuple[int, ...]:
    """Return the assembly modes as a tuple.

    Raises
    ------
    InputError
        None, an unknown or a repeated one is given.
    """
    where, codes = ("branch",), branch_codes(catalogue, branch)
    if codes.ndim > 1:
        what, remedy = f"has {codes.ndim} dimensions", "write one number or a flat list of numbers"
        raise InputError(what, where=where, remedy=remedy)
    if not codes.size:
        remedy = f"write some of {', '.join(map(str, catalogue.branches))}"
        raise InputError("none is given", where=where, remedy=remedy)
    given = tuple(int(code) for code in codes.ravel()[: len(catalogue.branches) + 1])
    for k, value in enumerate(given):
        if value in given[:k]:
            raise InputError(f"{value} is given twice", where=where, remedy="write each once")
    return given
