"""Errors that a user can mend, in the words of each door."""

from __future__ import annotations

import difflib
import re
import sys
import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from types import TracebackType
from typing import Self, TypeAlias

__all__ = [
    *("InputError", "InputWarning", "KeyPath", "Model", "Pair", "Problem", "Problems", "Remedy", "Samples"),
    *("Setting", "Wording", "listed", "nearest", "path_text", "printable", "remark", "suggest"),
]

#: Known names in a suggestion, and problems with a line each; the others are counted.
MOST_SHOWN, MOST_LINES = 12, 20
#: Signs of a line, and of its end, where the remedy stands, if it has to be cut.
LONGEST_LINE, LAST_SIGNS = 390, 160
#: Letters of the longest name that is compared with known ones, which takes a second for 100,000; of the longest word
#: that is shown whole, and of the beginning and the end of a longer one.
LONGEST_NAME, FIRST_LETTERS, LAST_LETTERS = 200, 100, 60
#: What other programs call an option.
ELSEWHERE = {
    "attrs": ("attributes", "metadata"),
    "block": ("batch", "batch_size", "chunk", "chunks", "chunksize"),
    "n": ("count", "designs", "n_samples", "num", "number", "points", "samples", "size"),
    "overwrite": ("clobber", "exist_ok", "force", "replace"),
    "progress": ("progressbar", "show_progress", "tqdm", "verbose"),
    "quantities": ("names", "outputs", "results", "variables"),
    "seed": ("random_seed", "random_state", "rng"),
    "space": ("data", "design", "designs", "df", "grid", "table"),
    "threads": ("cores", "cpus", "n_jobs", "n_workers", "processes", "workers"),
    "to": ("file", "filename", "fname", "out", "outfile", "output", "path", "save", "savefig"),
}
#: Begin texts that read on after the path of a problem; a sentence of its own follows a colon.
PREDICATES = ("is ", "has ", "holds ", "runs ", "belongs ", "gives ", "takes ")

#: The path to a problem, from the parameter of a function: ``("design", "a2", 3)``, ``("branch",)``.
KeyPath: TypeAlias = tuple[str | int, ...]


@dataclass(frozen=True)
class Samples:
    """Equally spaced values, for a remedy."""

    first: float
    last: float
    count: int


@dataclass(frozen=True)
class Pair:
    """The two ends of a range, for a remedy; `unlimited` where one of them may be left open."""

    unlimited: bool = False


@dataclass(frozen=True)
class Setting:
    """An option with a value, for a remedy."""

    name: str
    value: object


@dataclass(frozen=True)
class Model:
    """A model of the links with the names of its inputs, for a remedy."""

    name: str
    inputs: tuple[str, ...]


Piece: TypeAlias = str | Samples | Pair | Setting | Model
#: A text; or pieces of it, where an inner tuple is left out at a door that lacks the option it names.
Remedy: TypeAlias = str | tuple[Piece | tuple[Piece, ...], ...]


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong, its path, and what to write instead."""

    what: str
    where: KeyPath = ()
    remedy: Remedy = ""


class Wording:
    """The wording of problems for callers in Python; other doors override its parts."""

    def line(self, problem: Problem) -> str:
        """Return a problem as one line."""
        path, remedy = self.path(problem.where), self.remedy(problem.remedy)
        if path:
            path += " " if problem.what.startswith(PREDICATES) else ": "
        return f"{path}{problem.what}{'; ' if remedy else ''}{remedy}"

    def remedy(self, remedy: Remedy) -> str:
        """Return a remedy as text."""
        text = ""
        for part in (remedy,) if isinstance(remedy, str) else remedy:
            pieces = [self.piece(piece) for piece in (part if isinstance(part, tuple) else (part,))]
            text += "".join(piece for piece in pieces if piece is not None) if None not in pieces else ""
        return text

    def path(self, where: KeyPath) -> str:
        """Return a path as text, such as ``design: a2[3]``.

        Examples
        --------
        >>> Wording().path(("design", "a2", 3)), Wording().path(("quantities", 0))
        ('design: a2[3]', 'quantities[0]')
        """
        return path_text(where).replace(".", ": ", 1)

    def within(self, door: Wording) -> Wording:
        """Return the wording of a file that was given at a door, whose options are written there."""
        return self

    def piece(self, piece: Piece) -> str | None:
        """Return a piece of a remedy, or None where this door has no such option."""
        if isinstance(piece, Samples):
            return f"numpy.linspace({piece.first:g}, {piece.last:g}, {piece.count})"
        if isinstance(piece, Pair):
            return "(lo, hi), None for no limit" if piece.unlimited else "(lo, hi)"
        if isinstance(piece, Model):
            return f"links=fl.{piece.name}({', '.join(f'{name}=...' for name in piece.inputs)})"
        return f"{piece.name}={piece.value!r}" if isinstance(piece, Setting) else piece


class InputError(ValueError):
    """Bad input: one or several problems.

    Parameters
    ----------
    what : str
        What is wrong.
    where : tuple of str and int, optional
        The path to it, from the parameter of the function that was called.
    remedy : str or tuple of pieces, optional
        What to write instead.
    """

    def __init__(self, what: str, *, where: KeyPath = (), remedy: Remedy = "") -> None:
        super().__init__(what)
        self.problems: tuple[Problem, ...] = (Problem(what, where, remedy),)
        self.wording: Wording | None = None

    @classmethod
    def of(cls, problems: Iterable[Problem], wording: Wording | None = None) -> Self:
        """Return the error of several problems, in the wording of a door."""
        error = cls("")
        error.problems, error.wording = tuple(problems), wording
        error.args = (str(error),)
        return error

    @property
    def what(self) -> str:
        """The first problem, without path and remedy."""
        return self.problems[0].what

    @property
    def where(self) -> KeyPath:
        """The path of the first problem."""
        return self.problems[0].where

    @property
    def remedy(self) -> Remedy:
        """The remedy of the first problem."""
        return self.problems[0].remedy

    def lines(self, wording: Wording | None = None) -> list[str]:
        """Return a line per problem, in the error's own wording or else the given one."""
        door = wording or Wording()
        chosen = door if self.wording is None else self.wording.within(door)
        shown = list(self.problems[:MOST_LINES])
        if more := len(self.problems) - len(shown):
            shown.append(Problem(f"and {more} more problem{'s' if more > 1 else ''}"))
        return [printable(chosen.line(problem)) for problem in shown]

    def __str__(self) -> str:
        return "\n".join(self.lines())


class Problems:
    """The problems of one request, collected and raised together."""

    def __init__(self, wording: Wording | None = None) -> None:
        self.wording = wording
        self.noted: list[Problem] = []

    def add(self, what: str, where: KeyPath = (), remedy: Remedy = "") -> None:
        """Add a problem."""
        self.noted.append(Problem(what, where, remedy))

    def at(self, *where: str | int) -> _Noting:
        """Add the problems of an InputError, at a path unless they have one, and go on."""
        return _Noting(self, where)

    def stop(self) -> None:
        """Raise InputError if there are problems."""
        if self.noted:
            raise InputError.of(self.noted, self.wording)


def printable(line: str) -> str:
    """Return a line of at most 390 signs that any terminal shows: others are escaped, addresses left out.

    Of a word of more than 200 signs the beginning and the end are shown.

    Examples
    --------
    >>> printable(f"mechanism: {chr(27)}[31m is unknown").isprintable()
    True
    >>> len(printable(f"{'w' * 5000} is no option"))
    176
    """
    line = re.sub(r" at 0x[0-9a-fA-F]+", "", line)
    if not line.isprintable():
        shown = (sign if sign.isprintable() else repr(sign)[1:-1] for sign in line)
        line = "".join(shown)
    line = re.sub(
        rf"\S{{{LONGEST_NAME + 1},}}",
        lambda word: f"{word[0][:FIRST_LETTERS]}...{word[0][-LAST_LETTERS:]}",
        line,
    )
    if len(line) > LONGEST_LINE:
        line = f"{line[: LONGEST_LINE - LAST_SIGNS - 5]} ... {line[-LAST_SIGNS:]}"
    return line


class InputWarning(UserWarning):
    """A remark on input that is taken as it is, or in part, but may not be meant so."""


def remark(what: str, where: KeyPath = (), remedy: Remedy = "") -> None:
    """Warn of input at the line that called fastlink, by `InputWarning`."""
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and frame.f_globals.get("__name__", "").partition(".")[0] == __package__:
        frame, level = frame.f_back, level + 1
    text = printable(Wording().line(Problem(what, where, remedy)))
    warnings.warn(text, InputWarning, stacklevel=level)


class _Noting:
    """Context of `Problems.at`: a class, since a generator takes three times as long to enter and to leave."""

    __slots__ = ("problems", "where")

    def __init__(self, problems: Problems, where: KeyPath) -> None:
        self.problems, self.where = problems, where

    def __enter__(self) -> None:
        return None

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> bool:
        if not isinstance(error, InputError):
            return False
        self.problems.noted += [
            one if one.where else replace(one, where=self.where) for one in error.problems
        ]
        return True


def path_text(where: KeyPath) -> str:
    """Return a path as text, such as ``design.a2.values[3]``.

    Examples
    --------
    >>> path_text(("design", "a2", "values", 3))
    'design.a2.values[3]'
    """
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in where).removeprefix(".")


def nearest(name: object, known: Iterable[str]) -> str | None:
    """Return the known name that is nearest to a name by its letters, small or large, or that other programs call so.

    Examples
    --------
    >>> nearest("A1", ["a1", "a2"]), nearest("thread", ["to", "threads"]), nearest("x", ["to"])
    ('a1', 'threads', None)
    >>> nearest("n_jobs", ["to", "threads"])
    'threads'
    """
    known = sorted(known)
    try:
        name = str(name).casefold()
    except Exception:  # whatever a class of somebody's does
        return None
    for option in known:
        if name in ELSEWHERE.get(option, ()):
            return option
    folded = {one.casefold(): one for one in reversed(known)}
    near = difflib.get_close_matches(name, list(folded), n=1, cutoff=0.5)
    return folded[near[0]] if near else None


def suggest(name: object, known: Iterable[str]) -> str:
    """Return the remedy for an unknown name: the nearest known name, or all of them.

    A value that is no text, or longer than any name, has none that is near.

    Examples
    --------
    >>> suggest("omega_4", ["omega2", "omega4", "theta4"])
    "did you mean 'omega4'?"
    """
    options = sorted(known)
    comparable = isinstance(name, str) and len(name) <= LONGEST_NAME
    if comparable and (near := nearest(str(name), options)) is not None:
        return f"did you mean {near!r}?"
    return listed(options)


def listed(options: Sequence[str]) -> str:
    """Return the remedy that lists known names, the first of many."""
    if not options:
        return "there is none"
    more = f", ... ({len(options)} in all)" if len(options) > MOST_SHOWN else ""
    return f"known: {', '.join(options[:MOST_SHOWN])}{more}"
