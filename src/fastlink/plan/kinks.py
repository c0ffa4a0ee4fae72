"""Where facts turn sharply or have kinks: magnitudes, angles by the size of a sine, choices of users, loads."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from fastlink.catalogue.catalogue import Catalogue, CatalogueError, Fact, GradedRange, System
from fastlink.facts.names import derivative_name
from fastlink.numerics.compiler import syntax
from fastlink.numerics.elementary import atan2
from fastlink.numerics.vectors import absolute, choice, magnitude
from fastlink.plan.program import ExtremumSearch
from fastlink.symbolic.asymptotics import asymptotics
from fastlink.symbolic.derivative import NoDependence, NoDerivative

__all__ = [
    *("FINER", "folds", "has_sharp_terms", "is_magnitude", "is_sharp", "may_have_kinks"),
    *("searches_at_kinks", "searches_for_splits", "turns_of"),
]

#: What a user's fact calls where it has kinks.
KINKS = {absolute.__name__, choice.__name__}
#: Cells in place of one where a user's fact takes two or more magnitudes: where both almost vanish next to each other,
#: their sum turns twice within a fraction of a cell, which the samples of its slope do not show (5 of 1,001 differences
#: of forces on the crank missed their greatest value by up to 2 % with one cell, none with this many).
FINER = 8

#: What computes facts at positions of the graded range.
_StepsOf = Callable[[Sequence[str]], Sequence[Fact | System]]


def is_magnitude(step: Fact | System) -> bool:
    """Tell whether a fact is the magnitude of a vector and nothing else."""
    called = _last_call(step)
    return called is not None and _called(step, called) is magnitude


def folds(step: Fact | System) -> bool:
    """Tell whether a fact is an angle by the size of its sine: it turns back at 0 and at pi."""
    called = _last_call(step)
    if called is None or _called(step, called) is not atan2:
        return False
    sine = called.args[0]
    return isinstance(sine, ast.Call) and isinstance(sine.func, ast.Name) and sine.func.id == "abs"


def has_sharp_terms(steps: Sequence[Fact | System]) -> bool:
    """Tell whether the last of these steps, a user's, is computed from two magnitudes or more."""
    last = steps[-1]
    if not (isinstance(last, Fact) and last.own):
        return False
    own = (step for step in steps if isinstance(step, Fact) and step.own)
    within = sum(_calls_of_magnitude(step) for step in own)
    return within + sum(isinstance(step, Fact) and not step.own and is_magnitude(step) for step in steps) > 1


def _calls_of_magnitude(step: Fact) -> int:
    """Return how many magnitudes a user's fact computes itself."""
    calls = (node for node in ast.walk(syntax(step.function)) if isinstance(node, ast.Call))
    return sum(_called(step, call) is magnitude for call in calls)


def _last_call(step: Fact | System) -> ast.Call | None:
    """Return the call that is all of what a fact returns."""
    result = getattr(syntax(step.function).body[-1], "value", None)
    return result if isinstance(result, ast.Call) else None


def _called(step: Fact | System, call: ast.Call) -> object:
    return step.function.__globals__.get(call.func.id) if isinstance(call.func, ast.Name) else None


def is_sharp(catalogue: Catalogue, name: str) -> bool:
    """Tell whether a quantity is the magnitude of a vector, sharp where that almost vanishes."""
    return name in catalogue.public and is_magnitude(catalogue.facts[name])


def may_have_kinks(step: Fact | System) -> bool:
    """Tell whether a user's fact chooses between values that may meet."""
    return isinstance(step, Fact) and step.own and not KINKS.isdisjoint(step.function.__code__.co_names)


def searches_at_kinks(
    catalogue: Catalogue, search: ExtremumSearch, steps_of: _StepsOf
) -> list[ExtremumSearch]:
    """Return the searches for the kinks of a quantity, and for the extremes of what it is between them."""
    graded = catalogue.graded
    assert graded is not None
    switches, pieces = graded.kinks.get(search.quantity, ((), ()))
    slopes = [(name, name) for name in switches]
    fact = catalogue.facts.get(search.quantity)
    magnitudes = [name for name in fact.depends_on if is_sharp(catalogue, name)] if fact and fact.own else []
    smooth = dict.fromkeys((*pieces, *magnitudes))
    slopes += [(name, derivative_name(name, catalogue.position.name)) for name in smooth]
    found = (_search_of(catalogue, search, name, slope, steps_of) for name, slope in slopes)
    return [one for one in found if one is not None]


def _search_of(
    catalogue: Catalogue, search: ExtremumSearch, name: str, slope: str, steps_of: _StepsOf
) -> ExtremumSearch | None:
    """Return the search for the zeros of the slope of a quantity, or of a value itself, on behalf of another search."""
    graded = catalogue.graded
    assert graded is not None
    try:
        steps = steps_of((name, slope))
    except (CatalogueError, NoDerivative, NoDependence):
        return None  # the same at all positions, or of those of the whole alone
    divisor, power = graded.divisors.get(name, (name, 0)) if slope != name else (name, 0)
    if slope != name and is_magnitude(next(step for step in steps if name in step.names)):
        divisor, power = name, 1  # half the derivative of the square, which has no kink
    grades = asymptotics(graded, steps, (*graded.coordinates, "branch"))
    parity = grades[slope].parity if slope == name else -grades[name].parity  # the position is odd
    if search.mirrored and not parity:
        return None  # its mirror image is that of another part, which is searched where this one is not
    return replace(
        search,
        slope=slope,
        slope_order=max(round(grades[slope].order + power * grades[divisor].order), 0),
        slope_parity=parity,
        divisors=(divisor,) * power,
        onto=search.quantity,
        piece=slope != name,
        magnitude=False,
        kinked=False,
        turns=() if slope == name else turns_of(graded, name, steps),
        gradients=(),
    )


def searches_for_splits(
    catalogue: Catalogue, searches: Iterable[ExtremumSearch], steps_of: _StepsOf
) -> list[ExtremumSearch]:
    """Return the searches for the places at which cells of searches, which share samples, are split."""
    graded = catalogue.graded
    assert graded is not None
    first: dict[str, ExtremumSearch] = {}
    for search in searches:
        for name in search.turns:
            first.setdefault(name, search)  # it is the same for all
    found = (_search_of(catalogue, search, name, name, steps_of) for name, search in first.items())
    return [
        replace(
            one,
            quantity=one.slope,
            order=0,
            divided=one.slope not in graded.cells,
            splits=True,
            bounded_by=(),
        )
        for one in found
        if one is not None
    ]


def turns_of(graded: GradedRange, quantity: str, steps: Iterable[Fact | System]) -> tuple[str, ...]:
    """Return what vanishes where the slope of a quantity, which steps compute, jumps or has a kink."""
    names = {name for step in steps for name in step.names}
    switches, _ = graded.kinks.get(quantity, ((), ()))
    return (*(zero for name, zero in graded.turns.items() if name in names), *switches)
