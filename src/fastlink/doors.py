"""Guard public functions: a call that does not fit their parameters is refused with what to write."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from inspect import Parameter, Signature, signature
from typing import Any, ParamSpec, TypeVar, overload

from fastlink._text import counted, joined
from fastlink.errors import InputError, Problem, Problems, nearest, suggest

__all__ = ["CallError", "door"]

P = ParamSpec("P")
R = TypeVar("R")

#: Parameters that the form of a call shows.
MOST_SHOWN = 6
BY_POSITION = (Parameter.POSITIONAL_ONLY, Parameter.POSITIONAL_OR_KEYWORD)


class CallError(InputError, TypeError):
    """A call that does not fit the parameters of a public function."""


@overload
def door(function: Callable[P, R]) -> Callable[P, R]: ...


@overload
def door(*, hint: str = "", name: str = "") -> Callable[[Callable[P, R]], Callable[P, R]]: ...


def door(function: Callable[P, R] | None = None, *, hint: str = "", name: str = "") -> Any:
    """Return a public function that refuses a wrong call with the nearest parameter, or with its form.

    A right call costs a tenth of a microsecond more. A TypeError that the function itself raises is passed on.

    Parameters
    ----------
    function : callable
        The function.
    hint : str
        What else to say where an argument is missing, or too many are given.
    name : str
        The public name, where it is not the function's own.

    Examples
    --------
    >>> @door
    ... def bar(density, radius=0.01):
    ...     return density * radius
    >>> bar(7750.0, raduis=0.02)
    Traceback (most recent call last):
    fastlink.doors.CallError: bar: raduis is not a parameter; did you mean 'radius'?
    >>> bar()
    Traceback (most recent call last):
    fastlink.doors.CallError: bar: density is missing; write bar(density, radius=...)
    """
    if function is None:
        return functools.partial(door, hint=hint, name=name)

    called = name or function.__name__

    @functools.wraps(function)
    def guarded(*args: P.args, **options: P.kwargs) -> R:
        try:
            return function(*args, **options)
        except TypeError:
            problems = _wrong_call(called, signature(function), args, options, hint)
            if problems is None:
                raise
        raise CallError.of(problems)

    return guarded


def _wrong_call(
    name: str, expected: Signature, args: Sequence[Any], options: Mapping[str, Any], hint: str
) -> list[Problem] | None:
    """Return the problems of a call that does not fit the parameters of a function, None of one that does."""
    try:
        expected.bind(*args, **options)
    except TypeError:
        pass
    else:
        return None
    parameters = list(expected.parameters.values())
    if parameters and parameters[0].name == "self":
        parameters, args = parameters[1:], args[1:]
    problems = Problems()
    also = f"; {hint}" if hint else ""
    form = f"write {_form(name, parameters)}{also}"
    by_position = [one for one in parameters if one.kind in BY_POSITION]
    named = {
        one.name for one in parameters if one.kind not in (Parameter.VAR_KEYWORD, Parameter.VAR_POSITIONAL)
    }
    given = [one.name for one in by_position[: len(args)]]
    if len(args) > len(by_position):
        most = f"at most {counted(len(by_position), 'argument')}" if by_position else "no argument"
        are = "is" if len(args) == 1 else "are"
        problems.add(f"takes {most} by position, {len(args)} {are} given", (name,), form)
    for key in (key for key in given if key in options):
        problems.add("is given both by position and by name", (name, key), f"write it once{also}")
    others = [key for key in options if key not in named]
    missing = [
        one.name
        for one in parameters
        if one.name in named and one.default is Parameter.empty and one.name not in (*given, *options)
    ]
    misspelt = {key: name for key in missing for name in reversed(others) if nearest(name, missing) == key}
    for key, near in misspelt.items():
        problems.add("is missing", (name, key), f"write {key} in place of {near}")
    absent = [key for key in missing if key not in misspelt]
    if len(absent) == 1:
        problems.add("is missing", (name, *absent), form)
    elif absent:
        problems.add(f"{joined(absent)} are missing", (name,), form)
    if not any(one.kind is Parameter.VAR_KEYWORD for one in parameters):
        for key in (key for key in others if key not in misspelt.values()):
            problems.add("is not a parameter", (name, key), suggest(key, named) if named else form)
    return problems.noted


def _form(name: str, parameters: Sequence[Parameter]) -> str:
    """Return a call with the parameters of a function, such as ``sobol(n, ranges=..., seed=..., **more)``."""
    shown = []
    for one in parameters[:MOST_SHOWN]:
        optional = one.default is not Parameter.empty or one.kind is Parameter.KEYWORD_ONLY
        stars = "**" if one.kind is Parameter.VAR_KEYWORD else ""
        shown.append(f"{stars}{one.name}{'=...' if optional else ''}")
    more = [] if len(parameters) <= MOST_SHOWN else ["..."]
    return f"{name}({', '.join([*shown, *more])})"
