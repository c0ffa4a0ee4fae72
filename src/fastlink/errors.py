"""Errors a user can mend: where, what was found there, and what to write instead; each door words them its own way."""

from __future__ import annotations

import contextlib
import difflib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import TypeAlias

__all__ = [
    "InputError",
    "Pair",
    "Place",
    "Problem",
    "Problems",
    "Remedy",
    "Samples",
    "Setting",
    "Wording",
    "path_text",
    "suggest",
]

MOST_SHOWN = 12
#: How many problems are a line each; the others are counted.
MOST_LINES = 20
#: What is found begins with one of these where it reads on after the place; a sentence of its own follows a colon.
PREDICATES = ("is ", "has ", "holds ", "runs ", "belongs ", "gives ")

#: The path to what is wrong, from the parameter of a function: ``("design", "a2", 3)``, ``("branch",)``.
Place: TypeAlias = tuple[str | int, ...]


@dataclass(frozen=True)
class Samples:
    """Equally spaced values, for a remedy."""

    first: float
    last: float
    count: int


@dataclass(frozen=True)
class Pair:
    """Two ends, for a remedy."""

    low: str = "lo"
    high: str = "hi"


@dataclass(frozen=True)
class Setting:
    """An option with a value, for a remedy."""

    name: str
    value: object


Piece: TypeAlias = str | Samples | Pair | Setting
#: A text; or pieces of it, where an inner tuple is left out at a door that lacks the option it names.
Remedy: TypeAlias = str | tuple[Piece | tuple[Piece, ...], ...]


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong: what was found, where, and what to write instead."""

    what: str
    where: Place = ()
    remedy: Remedy = ""


class Wording:
    """How callers in Python are told; other doors override what they write in another way."""

    def line(self, problem: Problem) -> str:
        """Return a problem as one line."""
        place, remedy = self.place(problem.where), self.remedy(problem.remedy)
        if place:
            place += " " if problem.what.startswith(PREDICATES) else ": "
        return f"{place}{problem.what}{'; ' if remedy else ''}{remedy}"

    def remedy(self, remedy: Remedy) -> str:
        """Return what to write instead, as text."""
        if isinstance(remedy, str):
            return remedy
        text = ""
        for part in remedy:
            pieces = [self.piece(piece) for piece in (part if isinstance(part, tuple) else (part,))]
            text += "".join(piece for piece in pieces if piece is not None) if None not in pieces else ""
        return text

    def place(self, where: Place) -> str:
        """Return where something is wrong, such as ``design: a2[3]``.

        Examples
        --------
        >>> Wording().place(("design", "a2", 3)), Wording().place(("quantities", 0))
        ('design: a2[3]', 'quantities[0]')
        """
        return path_text(where).replace(".", ": ", 1)

    def piece(self, piece: Piece) -> str | None:
        """Return a piece of a remedy, or None where this door has no such thing."""
        if isinstance(piece, Samples):
            return f"numpy.linspace({piece.first:g}, {piece.last:g}, {piece.count})"
        if isinstance(piece, Pair):
            return f"({piece.low}, {piece.high})"
        return f"{piece.name}={piece.value!r}" if isinstance(piece, Setting) else piece


class InputError(ValueError):
    """Bad input: one or several problems, each with its place, what was found there and the remedy.

    Parameters
    ----------
    what : str
        What was found.
    where : tuple of str and int, optional
        The path to it, from the parameter of the function that was called.
    remedy : str or tuple of pieces, optional
        What to write instead.
    """

    def __init__(self, what: str, *, where: Place = (), remedy: Remedy = "") -> None:
        super().__init__(what)
        self.problems: tuple[Problem, ...] = (Problem(what, where, remedy),)
        self.wording: Wording | None = None

    @classmethod
    def of(cls, problems: Iterable[Problem], wording: Wording | None = None) -> InputError:
        """Return the error of several problems, in the words of a door."""
        error = cls("")
        error.problems, error.wording = tuple(problems), wording
        error.args = (str(error),)
        return error

    @property
    def what(self) -> str:
        """What was found, of the first problem."""
        return self.problems[0].what

    @property
    def where(self) -> Place:
        """The place of the first problem."""
        return self.problems[0].where

    @property
    def remedy(self) -> Remedy:
        """What to write instead, of the first problem."""
        return self.problems[0].remedy

    def lines(self, wording: Wording | None = None) -> list[str]:
        """Return a line for each problem, in the error's own words or else in those given."""
        chosen = self.wording or wording or Wording()
        lines, more = (
            [chosen.line(one) for one in self.problems[:MOST_LINES]],
            len(self.problems) - MOST_LINES,
        )
        return [*lines, chosen.line(Problem(f"and {more} more problems"))] if more > 0 else lines

    def __str__(self) -> str:
        return "\n".join(self.lines())


class Problems:
    """The problems of one request, noted as they are found and raised together."""

    def __init__(self, wording: Wording | None = None) -> None:
        self.wording = wording
        self.noted: list[Problem] = []

    def add(self, what: str, where: Place = (), remedy: Remedy = "") -> None:
        """Note a problem."""
        self.noted.append(Problem(what, where, remedy))

    @contextlib.contextmanager
    def at(self, *where: str | int) -> Iterator[None]:
        """Note the problems of an InputError, here where they have no place of their own, and go on."""
        try:
            yield
        except InputError as error:
            self.noted += [one if one.where else replace(one, where=where) for one in error.problems]

    def stop(self) -> None:
        """Raise InputError if anything was found."""
        if self.noted:
            raise InputError.of(self.noted, self.wording)


def path_text(where: Place) -> str:
    """Return a path as text, such as ``design.a2.values[3]``.

    Examples
    --------
    >>> path_text(("design", "a2", "values", 3))
    'design.a2.values[3]'
    """
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in where).removeprefix(".")


def suggest(name: str, known: Iterable[str]) -> str:
    """Return the remedy for an unknown name: the nearest known name, or all of them.

    Parameters
    ----------
    name : str
        What the user wrote.
    known : iterable of str
        What would have been accepted.

    Examples
    --------
    >>> suggest("omega_4", ["omega2", "omega4", "theta4"])
    "did you mean 'omega4'?"
    """
    options = sorted(known)
    near = difflib.get_close_matches(name, options, n=1, cutoff=0.5)
    if near:
        return f"did you mean {near[0]!r}?"
    more = f", ... ({len(options)} in all)" if len(options) > MOST_SHOWN else ""
    return f"known: {', '.join(options[:MOST_SHOWN])}{more}"
