"""What a sweep was asked for, checked at the door: inputs, branches, input positions, options."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache, reduce
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.catalogue import Catalogue, Input
from fastlink.cycle import Extrema, parse_request
from fastlink.declaration import ELIMINATED
from fastlink.errors import InputError, suggest
from fastlink.links import Links
from fastlink.mechanisms import NAMES, inputs_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from fastlink.space import DesignSpace

__all__ = [
    "all_choices",
    "allowed",
    "alternatives_of",
    "check_apart",
    "check_branches",
    "check_inputs",
    "check_keywords",
    "check_positions",
    "check_turn",
    "constants_of",
    "given_angles",
]

EXTREMA: tuple[Extrema, ...] = ("refined", "sampled")
ANGLES = 360
RULES = {"positive": "greater than 0", "non-negative": "at least 0"}


def alternatives_of(
    catalogue: Catalogue, links: Links | None, solver: str, given: Iterable[str] = ()
) -> tuple[str, ...]:
    """Return the chosen sets of facts, what replaces before what is replaced.

    Giving an input of a load (see `Catalogue.chosen_by`) chooses its facts.

    Raises
    ------
    InputError
        The mechanism has no such solver, or nothing depends on links.
    """
    if solver not in catalogue.solvers:
        raise InputError(_unknown_solver(catalogue, solver))
    if links is not None and links.model not in catalogue.alternative_inputs:
        raise InputError(f"links: nothing of {catalogue.name} depends on mass; leave them out")
    solved = () if solver == ELIMINATED else (solver,)
    return (*solved, *catalogue.chosen_by(given), *(() if links is None else (links.model,)))


def _unknown_solver(catalogue: Catalogue, solver: str) -> str:
    if catalogue.solvers == (ELIMINATED,):
        return f"solver {solver!r}: {catalogue.name} has no linear system to solve; leave solver out"
    return f"solver {solver!r} is unknown; {suggest(str(solver), catalogue.solvers)}"


def constants_of(catalogue: Catalogue, links: Links | None, alternatives: Iterable[str]) -> dict[str, float]:
    """Return the inputs that a design need not give: those of the links, and the defaults of the chosen sets."""
    inputs = catalogue.known_inputs(alternatives).values()
    defaults = {known.name: known.default for known in inputs if known.default is not None}
    return defaults | dict(links.values if links is not None else {})


def all_choices(
    catalogue: Catalogue, given: Iterable[str], alternatives: Iterable[str]
) -> dict[str, tuple[int, ...]]:
    """Return the codes of each input that has choices and is not given."""
    inputs = catalogue.known_inputs(alternatives).values()
    return {i.name: tuple(i.choices) for i in inputs if i.choices and i.name not in given}


def check_inputs(
    catalogue: Catalogue, space: DesignSpace, alternatives: Sequence[str], allow_invalid: bool
) -> None:
    """Refuse an unknown input, and values that no such thing can have.

    Raises
    ------
    InputError
        With the input, the first bad value, where it stands and what is allowed.
    """
    known = catalogue.known_inputs(alternatives)
    check_apart(catalogue, space.names)
    for name in space.names:
        if name not in known:
            raise InputError(_unknown_input(catalogue, name, known))
        value = space.constants.get(name)
        if not allow_invalid and (value is None or not allowed(known[name], value)):
            _check_values(known[name], space)


def check_apart(catalogue: Catalogue, names: Sequence[str]) -> None:
    """Refuse inputs that determine each other.

    Raises
    ------
    InputError
        With two of them.
    """
    for name, other in _exclusive(catalogue, catalogue.version, tuple(names)):
        raise InputError(f"design: {other} and {name} determine each other; leave one of them out")


@lru_cache(maxsize=256)
def _exclusive(catalogue: Catalogue, version: int, names: tuple[str, ...]) -> list[tuple[str, str]]:
    """Return the pairs of given inputs that determine each other."""
    return [(name, other) for name in names for other in catalogue.instead_of(name) if other in names]


def allowed(declared: Input, value: Any) -> Any:
    """Tell whether an input may have a value, or of each of an array whether it may."""
    finite = abs(value) < math.inf
    if declared.choices:
        return finite & reduce(operator.or_, (value == code for code in declared.choices))
    if declared.rule == "positive":
        return finite & (value > 0)
    return finite & (value >= 0) if declared.rule == "non-negative" else finite


def _unknown_input(catalogue: Catalogue, name: str, known: dict[str, Input]) -> str:
    for model, inputs in catalogue.alternative_inputs.items():
        if name in inputs:
            return f"design: {name!r} belongs to links of model {model!r}; choose that model, or leave it out"
    others = [key for key, inputs in catalogue.alternative_inputs.items() if key in inputs]
    return f"design: input {name!r} is unknown to {catalogue.name}; {suggest(name, [*known, *others])}"


def _check_values(declared: Input, space: DesignSpace) -> None:
    name = declared.name
    values = space.values(name)
    bad = ~allowed(declared, values)
    if bad.any():
        where = int(np.flatnonzero(bad)[0])
        place = f"{name}[{where}]" if values.size > 1 else name
        rule = RULES.get(declared.rule, "")
        remedy = f"a finite number{' ' if rule else ''}{rule}"
        if declared.choices:
            remedy = "one of " + ", ".join(
                f"{code} ({meaning})" for code, meaning in declared.choices.items()
            )
        raise InputError(f"design: {place} is {values[where]}; {declared.meaning}: write {remedy}")


def check_branches(catalogue: Catalogue, branch: Any) -> tuple[int, ...]:
    """Return the assembly modes as a tuple.

    Raises
    ------
    InputError
        None, an unknown or a repeated one is given.
    """
    allowed = ", ".join(map(str, catalogue.branches))
    given = np.atleast_1d(np.asarray(branch, dtype=object)).tolist()
    for k, value in enumerate(given):
        if isinstance(value, bool) or value not in catalogue.branches:
            raise InputError(
                f"branch: {value!r} is no assembly mode of {catalogue.name}; write some of {allowed}"
            )
        if value in given[:k]:
            raise InputError(f"branch: {value!r} is given twice; write each once")
    if not given:
        raise InputError(f"branch: none is given; write some of {allowed}")
    return tuple(int(value) for value in given)


def check_keywords(
    mechanism: str, catalogue: Catalogue, names: Iterable[str], options: Iterable[str]
) -> None:
    """Refuse a keyword that is neither an option nor the name of the input.

    Parameters
    ----------
    mechanism : str
        Its name.
    catalogue : Catalogue
        The mechanism by the input that drives it.
    names : iterable of str
        The keywords that are no options.
    options : iterable of str
        The options there are, for a hint.

    Raises
    ------
    InputError
        With the name of the input, or the nearest option.
    """
    position = catalogue.position.name
    for name in names:
        if name == position:
            continue
        if name in inputs_of(mechanism):
            raise InputError(
                f"{name}: the input is {position}; write its positions as {position}, or input={name!r} too"
            )
        if any(name in inputs_of(other) for other in NAMES):
            raise InputError(f"{name}: the input is {position}; write its positions as {position}")
        raise InputError(
            f"{name} is no option, and the input is {position}; {suggest(name, {*options, position})}"
        )


def given_angles(catalogue: Catalogue, angles: Any, positions: Mapping[str, Any]) -> Any:
    """Return the input positions that were given, as `angles` or by the name of the input, else the usual ones.

    Raises
    ------
    InputError
        They are given twice.
    """
    values = positions.get(catalogue.position.name)
    if values is not None:
        if angles is not None:
            raise InputError(f"{catalogue.position.name}: angles are given too; write one of them")
        return values
    if angles is not None:
        return angles
    return ANGLES if catalogue.positions is None else np.linspace(*catalogue.positions)


def check_extrema(extrema: str | None, catalogue: Catalogue, angles: Any) -> Extrema:
    """Return how extremes are found: refined over a whole turn, unless the angles themselves are given.

    Raises
    ------
    InputError
        The way is unknown, or does not go with an array of angles.
    """
    chosen = np.ndim(angles) > 0
    if extrema is None:
        return "sampled" if chosen else "refined"
    if extrema not in EXTREMA:
        raise InputError(f"extrema {extrema!r} is unknown; {suggest(str(extrema), EXTREMA)}")
    if chosen and extrema == "refined":
        name, other = (
            catalogue.position.name,
            ", or a number of angles" if catalogue.positions is None else "",
        )
        raise InputError(
            f"extrema: 'refined' is over the whole turn of {name}, but {name} is an array; "
            f"write extrema='sampled'{other}"
        )
    return "refined" if extrema == "refined" else "sampled"


def check_turn(catalogue: Catalogue, names: Iterable[str], angles: Any) -> None:
    """Refuse angles of their own for what needs equal steps over a whole turn.

    Raises
    ------
    InputError
        With the name that needs it.
    """
    if np.ndim(angles) == 0:
        return
    for request in (parse_request(name, catalogue) for name in names):
        if request.reduction is not None and request.reduction.whole:
            position = catalogue.position.name
            remedy = "write a number of angles" if catalogue.positions is None else "leave it out"
            raise InputError(
                f"quantity {request.name!r} is over a whole turn, but {position} is an array; {remedy}"
            )


def check_positions(catalogue: Catalogue, given: int | ArrayLike) -> NDArray[Any]:
    """Return the input positions: a number of equal steps over one turn, or the positions themselves.

    Raises
    ------
    InputError
        The number is not positive, or a position is not finite or repeated.
    """
    name, noun = catalogue.position.name, "angles in rad" if catalogue.positions is None else "numbers"
    if catalogue.positions is not None and np.ndim(given) == 0:
        usual = "numpy.linspace({:g}, {:g}, {})".format(*catalogue.positions)
        raise InputError(
            f"{name}: {given!r} is no array, and {name} has no bounds; write an array, such as {usual}"
        )
    if isinstance(given, (int, np.integer)) and not isinstance(given, bool):
        if given < 1:
            raise InputError(
                f"{name}: {given} input angles; write a number of at least 1, or an array in rad"
            )
        return np.arange(int(given)) * (2.0 * np.pi / int(given))
    try:
        values = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        values = np.empty((0, 0))
    if values.ndim != 1 or isinstance(given, (bool, str)):
        raise InputError(f"{name}: {given!r} is neither a number of angles nor a flat array of {noun}")
    if values.size == 0:
        raise InputError(f"{name}: the array of input angles is empty; give at least one")
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        raise InputError(f"{name}[{bad[0]}] is {values[bad[0]]}; write finite {noun}")
    order = np.argsort(values, kind="stable")
    twice = np.flatnonzero(np.diff(values[order]) == 0.0)
    if twice.size:
        first, second = sorted(order[twice[0] : twice[0] + 2].tolist())
        raise InputError(
            f"{name}: {values[first]} stands twice (at {first} and {second}); give each angle once"
        )
    return np.array(values)
