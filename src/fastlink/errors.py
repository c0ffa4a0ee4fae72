"""Errors that a user can mend, in the words of each door; the guard of the doors, and their checks."""

from __future__ import annotations

import difflib
import functools
import math
import os
import re
import sys
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from inspect import Parameter, Signature, signature
from numbers import Integral
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, ParamSpec, Self, TypeAlias, TypeVar, overload

from fastlink._text import counted, joined, short_repr

P = ParamSpec("P")
R = TypeVar("R")


# -- Errors that a user can mend, in the words of each door


#: Known names in a suggestion, and problems with a line each; the others are counted.
MOST_SHOWN, MOST_LINES = 12, 20
#: Signs of a line, and of its end, where the remedy stands, if it has to be cut.
LONGEST_LINE, LAST_SIGNS = 390, 160
#: Letters of the longest name that is compared with known ones, which takes a second for 100,000; of the longest word
#: that is shown whole, and of the beginning and the end of a longer one.
LONGEST_NAME, FIRST_LETTERS, LAST_LETTERS = 200, 100, 60
#: Names of options in other programs.
OTHER_NAMES = {
    "attrs": ("attributes", "metadata"),
    "branch": ("assembly", "assembly_mode", "branches", "mode", "modes"),
    "block": ("batch", "batch_size", "chunk", "chunks", "chunksize"),
    "minimise": ("by", "cost", "loss", "objective", "sort"),
    "n": ("count", "designs", "n_samples", "num", "number", "points", "samples", "size"),
    "overwrite": ("clobber", "exist_ok", "force", "replace"),
    "progress": ("progressbar", "show_progress", "tqdm", "verbose"),
    "quantities": ("names", "outputs", "results", "variables"),
    "seed": ("random_seed", "random_state", "rng"),
    "subject": ("mechanism", "study"),
    "space": ("data", "design", "designs", "df", "grid", "table"),
    "threads": ("cores", "cpus", "n_jobs", "n_workers", "processes", "workers"),
    "top": ("count", "k", "limit", "n"),
    "where": ("condition", "conditions", "constraints", "filter"),
    "to": ("file", "filename", "fname", "out", "outfile", "output", "path", "save", "savefig"),
}
#: Verbs that continue the path of a problem; other texts follow a colon.
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
        """Return a path as text, such as ``design: a2[3]``."""
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
    """Bad input: one or several problems, each with the path to it from a parameter, and what to write instead."""

    def __init__(self, what: str, where: KeyPath = (), remedy: Remedy = "") -> None:
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

    def attempt(self, function: Callable[P, R], /, *args: P.args, **options: P.kwargs) -> R:
        """Return what a function returns; note what it refuses, and go on with None, which `stop` lets nobody use."""
        try:
            return function(*args, **options)
        except InputError as error:
            self.noted += error.problems
            return None  # type: ignore[return-value]

    def at(self, *where: str | int) -> _Collecting:
        """Add the problems of an InputError, at a path unless they have one, and go on."""
        return _Collecting(self, where)

    def stop(self) -> None:
        """Raise InputError if there are problems."""
        if self.noted:
            raise InputError.of(self.noted, self.wording)


def printable(line: str) -> str:
    """Return a line of at most 390 signs that any terminal shows: others are escaped, addresses left out.

    Of a word of more than 200 signs the beginning and the end are shown.
    """
    line = re.sub(r" at 0x[0-9a-fA-F]+", "", line)
    if not line.isprintable():
        shown = (sign if sign.isprintable() else repr(sign)[1:-1] for sign in line)
        line = "".join(shown)
    long_word = rf"\S{{{LONGEST_NAME + 1},}}"
    line = re.sub(long_word, lambda word: f"{word[0][:FIRST_LETTERS]}...{word[0][-LAST_LETTERS:]}", line)
    if len(line) > LONGEST_LINE:
        line = f"{line[: LONGEST_LINE - LAST_SIGNS - 5]} ... {line[-LAST_SIGNS:]}"
    return line


class InputWarning(UserWarning):
    """A remark on input that is taken as it is, or in part, but may not be meant so."""


class ResultWarning(InputWarning):
    """A remark on a result that is not what was asked for; a command that makes it ends with the status 1."""


def remark(what: str, where: KeyPath = (), remedy: Remedy = "", kind: type[Warning] = InputWarning) -> None:
    """Warn of input at the line that called fastlink, by `InputWarning`."""
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and frame.f_globals.get("__name__", "").partition(".")[0] == __package__:
        frame, level = frame.f_back, level + 1
    text = printable(Wording().line(Problem(what, where, remedy)))
    warnings.warn(text, kind, stacklevel=level)


class _Collecting:
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
    """Return a path as text, such as ``design.a2.values[3]``."""
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
        if name in OTHER_NAMES.get(option, ()):
            return option
    folded = {one.casefold(): one for one in reversed(known)}
    near = difflib.get_close_matches(name, list(folded), n=1, cutoff=0.55)
    return folded[near[0]] if near else None


def suggest(name: object, known: Iterable[str]) -> str:
    """Return the remedy for an unknown name: the nearest known name, or all of them.

    A value that is no text, or longer than any name, has none that is near.
    """
    options = sorted(known)
    comparable = isinstance(name, str) and len(name) <= LONGEST_NAME
    if comparable and (near := nearest(str(name), options)) is not None:
        return f"did you mean {near!r}?"
    return listed(options)


class Suggesting:
    """Objects that answer the name of an attribute that they lack with the nearest."""

    if not TYPE_CHECKING:  # type checkers know the attributes

        def __getattr__(self, name):
            known = [one for one in dir(self) if not one.startswith("_")]
            raise AttributeError(f"there is no attribute {name!r}; {suggest(name, known)}")


def listed(options: Sequence[str]) -> str:
    """Return the remedy that lists known names, the first of many."""
    if not options:
        return "there is none"
    more = f", ... ({len(options)} in all)" if len(options) > MOST_SHOWN else ""
    return f"known: {', '.join(options[:MOST_SHOWN])}{more}"


# -- Guard public functions: a call that does not fit their parameters is refused with what to write


#: Parameters that the form of a call shows.
MOST_PARAMETERS = 6
#: What is added to a form; or a function of what is no parameter, which tells where it is written.
Hint: TypeAlias = str | Callable[[str], str]
BY_POSITION = (Parameter.POSITIONAL_ONLY, Parameter.POSITIONAL_OR_KEYWORD)


class CallError(InputError, TypeError):
    """A call that does not fit the parameters of a public function."""


def require_package(module: str, where: KeyPath) -> None:
    """Refuse what needs a package that is not installed."""
    if find_spec(module) is None:
        raise InputError(f"{module} is not installed", where, f"python -m pip install {module}")


#: Parameters that are understood in American spelling, too.
BRITISH = {"minimize": "minimise", "maximize": "maximise"}


@overload
def door(function: Callable[P, R]) -> Callable[P, R]: ...


@overload
def door(*, hint: Hint = "", name: str = "") -> Callable[[Callable[P, R]], Callable[P, R]]: ...


def door(function: Callable[P, R] | None = None, *, hint: Hint = "", name: str = "") -> Any:
    """Return a public function that refuses a wrong call with the nearest parameter, or with its form.

    A hint that is a function tells of what is no parameter where it is written, if it knows; of "" what others tell.

    A right call costs a tenth of a microsecond more. A TypeError that the function itself raises is passed on.
    """
    if function is None:
        return functools.partial(door, hint=hint, name=name)

    called = name or function.__name__
    other_spelling = BRITISH if BRITISH["minimize"] in signature(function).parameters else {}

    @functools.wraps(function)
    def guarded(*args: P.args, **options: P.kwargs) -> R:
        for american, british in other_spelling.items():
            if american in options and british not in options:
                options[british] = options.pop(american)
        try:
            return function(*args, **options)
        except TypeError:
            problems = _wrong_call(called, signature(function), args, options, hint)
            if problems is None:
                raise
        raise CallError.of(problems)

    return guarded


def _wrong_call(
    name: str, expected: Signature, args: Sequence[Any], options: Mapping[str, Any], hint: Hint
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
    also = f"; {told}" if (told := hint if isinstance(hint, str) else hint("")) else ""
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
    required = [one.name for one in parameters if one.name in named and one.default is Parameter.empty]
    missing = [key for key in required if key not in (*given, *options)]
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
            there = "" if isinstance(hint, str) else hint(key)
            problems.add("is not a parameter", (name, key), there or (suggest(key, named) if named else form))
    return problems.noted


def _form(name: str, parameters: Sequence[Parameter]) -> str:
    """Return a call with the parameters of a function, such as ``sobol(n, ranges=..., seed=..., **more)``."""
    shown = []
    for one in parameters[:MOST_PARAMETERS]:
        optional = one.default is not Parameter.empty or one.kind is Parameter.KEYWORD_ONLY
        stars = "**" if one.kind is Parameter.VAR_KEYWORD else ""
        shown.append(f"{stars}{one.name}{'=...' if optional else ''}")
    more = [] if len(parameters) <= MOST_PARAMETERS else ["..."]
    return f"{name}({', '.join([*shown, *more])})"


# -- Check the values of options: whole numbers, switches, names, paths; in the same words at every door


#: The greatest seed: a file holds no greater whole number.
MOST_SEED = 2**63 - 1
#: Bytes of a file's name and of a whole path that file systems have room for.
LONGEST_FILE_NAME, LONGEST_PATH = 255, 4095
#: Endings of files that are no HDF5; other programs would misread a map called so.
OTHER_FILES = frozenset(
    {".csv", ".json", ".mat", ".md", ".npy", ".npz", ".parquet", ".pdf", ".pkl", ".png", ".py", ".svg"}
    | {".toml", ".tsv", ".txt", ".xls", ".xlsx", ".yaml", ".yml", ".zarr", ".zip"}
)


def check_whole(
    where: KeyPath, value: Any, least: int, most: float = math.inf, remedy: str | None = None
) -> int:
    """Return a whole number from `least` to `most`, or refuse the value."""
    whole = isinstance(value, Integral) and not isinstance(value, bool)
    if whole and type(value).__name__ != "timedelta64" and least <= int(value) <= most:
        return int(value)
    bounds = f"of at least {least}" if most == math.inf else f"from {least} to {most}"
    raise InputError(f"is {short_repr(value)}", where, remedy or f"write a whole number {bounds}")


def check_switch(where: KeyPath, value: Any) -> bool:
    """Return True or False, or refuse what is neither: a text such as ``"no"`` would count as true."""
    if value is True or value is False:
        return value
    if type(value).__name__ in ("bool", "bool_") and type(value).__module__ == "numpy":
        return bool(value)
    raise InputError(f"is {short_repr(value)}", where, "write True or False")


def check_choice(
    where: KeyPath, value: Any, known: Sequence[str], to: str = "", meant: Callable[[str], str] | None = None
) -> str:
    """Return a name among the known ones, or refuse it with the nearest.

    `to` says of what they are names, such as ``" to planar_4r"``; `meant` gives the remedy for a text that means one.
    """
    if isinstance(value, str):
        for name in known:
            if name == value:
                return name
    text = value if isinstance(value, str) else short_repr(value)
    remedy = (meant(text) if meant else "") or suggest(text, known)
    raise InputError(f"{short_repr(value)} is unknown{to}", where, remedy)


def check_path(where: KeyPath, value: Any, example: str = "maps.h5") -> Path:
    """Return a path with ``~`` expanded, or refuse what no file can be called."""
    try:
        text = os.fspath(value)
    except Exception:  # no path, or whatever a class of somebody's does
        text = None
    if not isinstance(text, str):
        raise InputError(f"is {short_repr(value)}, not a path", where, f"write text, such as {example!r}")
    text = os.path.expanduser(text)
    if (fault := _fault(text)) is not None:
        raise InputError(f"{short_repr(text)} {fault}", where, f"write such as {example!r}")
    return Path(text)


def not_a_file(path: Path) -> str:
    """Return what stands at a path in place of a file, an empty text if nothing does; a pipe would be waited for."""
    if os.path.isfile(path) or not os.path.exists(path):
        return ""
    return "is a folder" if os.path.isdir(path) else "is a device or a pipe"


def check_output(where: KeyPath, value: Any) -> Path:
    """Return the path of a map that is to be written, or refuse a name that belongs to something else."""
    path = check_path(where, value)
    name = os.fspath(value)
    if name.endswith(os.sep) and not path.is_dir():
        what = f"{short_repr(name)} ends as the name of a folder does"
        raise InputError(what, where, f"write {str(path)!r}")
    if path.suffix.lower() in OTHER_FILES:
        what = f"{short_repr(name)} is not the name of an HDF5 file"
        raise InputError(what, where, f"write {path.with_suffix('.h5').name!r}")
    return path


def _fault(path: str) -> str | None:
    """Return why no file can have a path, None where one can."""
    if not path.strip():
        return "is empty"
    if (control := next((letter for letter in path if letter < " "), None)) is not None:
        return f"holds the control character {control!r}"
    try:
        encoded = os.fsencode(path)
    except UnicodeEncodeError as error:
        return f"holds {path[error.start]!r}, which no name of a file can"
    longest = max(len(name) for name in encoded.split(os.fsencode(os.sep)))
    if longest > LONGEST_FILE_NAME:
        return f"holds a name of {longest} bytes, and file systems have room for {LONGEST_FILE_NAME}"
    if len(encoded) > LONGEST_PATH:
        return f"has {len(encoded)} bytes, and a path has room for {LONGEST_PATH}"
    return None
