"""Where facts turn sharply or have kinks: magnitudes, angles by the size of a sine, and choices of users."""

from __future__ import annotations

import ast
from collections.abc import Sequence

from fastlink.catalogue.catalogue import Catalogue, Fact, System
from fastlink.numerics.compiler import syntax
from fastlink.numerics.elementary import atan2
from fastlink.numerics.vectors import absolute, choice, magnitude

__all__ = ["FINER", "folds", "has_sharp_terms", "is_magnitude", "is_sharp", "may_have_kinks"]

#: What a user's fact calls where it has kinks.
KINKS = {absolute.__name__, choice.__name__}
#: Cells in place of one where a user's fact takes two or more magnitudes: where both almost vanish next to each other,
#: their sum turns twice within a fraction of a cell, which the samples of its slope do not show (5 of 1,001 differences
#: of forces on the crank missed their greatest value by up to 2 % with one cell, none with this many).
FINER = 8


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
