"""Checks of a request: inputs, branches, input positions, options."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache, reduce
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.catalogue.catalogue import Catalogue, Input
from fastlink.catalogue.declare import ELIMINATED
from fastlink.errors import InputError, Problem, Problems, Samples, Setting, suggest
from fastlink.mechanisms import NAMES, inputs_of
from fastlink.plan.query import Extrema, parse_request
from fastlink.space.links import Links
from fastlink.space.values import first_invalid, short_repr

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from fastlink.space.design_space import DesignSpace

__all__ = [
    "all_choices",
    "allowed",
    "check_branches",
    "check_extrema",
    "check_inputs",
    "check_keywords",
    "check_model",
    "check_positions",
    "check_turn",
    "constants_of",
    "given_angles",
    "selected_variants",
    "unknown_input",
    "variants_of",
]

EXTREMA: tuple[Extrema, ...] = ("refined", "sampled")
ANGLES = 360
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
            remedy = "choose that model, or leave it out"
            return Problem(f"belongs to links of model {model!r}", (parent, name), remedy)
    others = [key for inputs in catalogue.variant_inputs.values() for key in inputs]
    return Problem(f"is unknown to {catalogue.name}", (parent, name), suggest(name, [*known, *others]))


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


def check_keywords(
    mechanism: str, catalogue: Catalogue, names: Iterable[str], options: Iterable[str]
) -> None:
    """Refuse a keyword that is neither an option nor the name of the input that drives the mechanism.

    `names` are the keywords that are not options, `options` those that are, for a hint.

    Raises
    ------
    InputError
        With the name of the input, or the nearest option.
    """
    position, problems = catalogue.position.name, Problems()
    for name in names:
        if name == position:
            continue
        if any(name in inputs_of(other) for other in NAMES):
            own = name in inputs_of(mechanism)
            other = (f", or, to drive {name}, write ", Setting("input", name)) if own else ()
            problems.add(f"the input is {position}", (name,), (f"write its positions as {position}", other))
        else:
            problems.add("is not an option", (name,), suggest(name, {*options, position}))
    problems.stop()


def given_angles(catalogue: Catalogue, angles: Any, positions: Mapping[str, Any]) -> tuple[str, Any]:
    """Return the input positions that were given, and by which name; else the usual ones.

    Raises
    ------
    InputError
        They are given both as `angles` and by the name of the input.
    """
    name = catalogue.position.name
    values = positions.get(name)
    if values is not None:
        if angles is not None:
            raise InputError("angles are given too", where=(name,), remedy="write one of them")
        return name, values
    if angles is not None:
        return "angles", angles
    return name, ANGLES if catalogue.positions is None else np.linspace(*catalogue.positions)


def check_extrema(extrema: str | None, catalogue: Catalogue, angles: Any) -> Extrema:
    """Return the search for extrema: refined over a whole turn, unless the angles themselves are given.

    Raises
    ------
    InputError
        The search is unknown, or does not go with an array of angles.
    """
    chosen = np.ndim(angles) > 0
    if extrema is None:
        return "sampled" if chosen else "refined"
    if extrema not in EXTREMA:
        raise InputError(f"{extrema!r} is unknown", where=("extrema",), remedy=suggest(str(extrema), EXTREMA))
    if chosen and extrema == "refined":
        name = catalogue.position.name
        what = f"'refined' is over the whole turn of {name}, but {name} is an array"
        other = ", or a number of angles" if catalogue.positions is None else ""
        remedy = ("write ", Setting("extrema", "sampled"), other)
        raise InputError(what, where=("extrema",), remedy=remedy)
    return "refined" if extrema == "refined" else "sampled"


def check_turn(catalogue: Catalogue, names: Iterable[str], angles: Any) -> None:
    """Refuse an array of angles for a reduction that needs equal steps over a whole turn.

    Raises
    ------
    InputError
        With the name of the reduction.
    """
    if np.ndim(angles) == 0:
        return
    problems = Problems()
    for k, request in enumerate(parse_request(name, catalogue) for name in names):
        if request.reduction is not None and request.reduction.whole:
            what = f"{request.name!r} is over a whole turn, but {catalogue.position.name} is an array"
            remedy = "write a number of angles" if catalogue.positions is None else "leave it out"
            problems.add(what, ("quantities", k), remedy)
    problems.stop()


def check_positions(catalogue: Catalogue, given: int | ArrayLike, key: str = "angles") -> NDArray[Any]:
    """Return the input positions: a number of equal steps over one turn, or the positions themselves.

    Parameters
    ----------
    catalogue : Catalogue
        The mechanism.
    given : int or array_like
        A number of positions, or these.
    key : str
        The name by which it was given.

    Raises
    ------
    InputError
        The number is not positive, or a position is not finite or repeated.
    """
    name, noun = catalogue.position.name, "angles in rad" if catalogue.positions is None else "numbers"
    if catalogue.positions is not None and np.ndim(given) == 0:
        what = f"{given!r} is not an array, and {name} has no bounds"
        remedies = ("write them all, such as ", Samples(*catalogue.positions))
        raise InputError(what, where=(key,), remedy=remedies)
    if isinstance(given, (int, np.integer)) and not isinstance(given, bool):
        if given < 1:
            what, remedy = f"{given} input angles", "write a number of at least 1, or an array in rad"
            raise InputError(what, where=(key,), remedy=remedy)
        return np.arange(int(given)) * (2.0 * np.pi / int(given))
    try:
        values = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        values = np.empty((0, 0))
    if values.ndim != 1 or isinstance(given, (bool, str)):
        turning = "a number of angles, or " if catalogue.positions is None else ""
        remedy = f"write {turning}a flat array of {noun}"
        raise InputError(f"is {short_repr(given)}", where=(key,), remedy=remedy)
    if values.size == 0:
        raise InputError("the array of input positions is empty", where=(key,), remedy="give at least one")
    if (bad := first_invalid(values)) is not None:
        raise InputError(f"is {values[bad]}", where=(key, bad), remedy=f"write finite {noun}")
    order = np.argsort(values, kind="stable")
    twice = np.flatnonzero(np.diff(values[order]) == 0.0)
    if twice.size:
        first, second = sorted(order[twice[0] : twice[0] + 2].tolist())
        what = f"{values[first]} stands twice (at {first} and {second})"
        raise InputError(what, where=(key,), remedy="give each position once")
    return np.array(values)
