"""The application, and what all its commands share: their wording of problems, their options."""

from __future__ import annotations

import contextlib
import functools
import signal
import threading
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar, get_args, get_type_hints

import typer
import typer.core

from fastlink.errors import InputError, InputWarning, KeyPath, Piece, Remedy, Setting, Wording, suggest

if TYPE_CHECKING:
    from fastlink.engine.extending import Extension

__all__ = [
    "MapFile",
    "MechanismName",
    "Overwrite",
    "QuantitiesFile",
    "StudyFile",
    "TrustCode",
    "app",
    "by_name",
    "command",
    "extension_of",
    "numbers_of",
    "text_of",
]

BAD_INPUT, INTERRUPTED, TERMINATED = 2, 130, 143
C = TypeVar("C", bound=Callable[..., Any])

StudyFile = Annotated[Path, typer.Argument(metavar="STUDY.toml", help="The study file.", show_default=False)]
MapFile = Annotated[Path, typer.Argument(metavar="FILE", help="A map.", show_default=False)]
MechanismName = Annotated[
    str, typer.Argument(metavar="MECHANISM", help="Such as planar_4r.", show_default=False)
]
TrustCode = Annotated[
    bool, typer.Option("--trust-code", help="Run the Python file of quantities that is named.")
]
QuantitiesFile = Annotated[
    Path | None,
    typer.Option(
        "--quantities-file",
        metavar="FILE.py",
        help="The Python file that declares the map's own quantities, as a study names it; with --trust-code.",
    ),
]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace an existing file.")]

#: What other programs, or Python, call a command.
ELSEWHERE = {
    "accuracy": ("benchmark", "error", "errors"),
    "best": ("front", "optimise", "optimize", "pareto", "rank", "sort", "top"),
    "check": ("fsck", "verify", "checksum"),
    "convert": ("export", "nccopy", "save", "to_netcdf", "transform"),
    "explore": ("browse", "dashboard", "serve", "view"),
    "explain": ("estimate", "forecast", "plan"),
    "info": ("describe", "head", "open", "print", "show", "summary"),
    "join": ("concat", "combine", "merge"),
    "mechanisms": ("list", "ls"),
    "new": ("init", "template"),
    "draw": ("animate", "linkage", "sketch"),
    "plot": ("map", "picture", "plot_map"),
    "tolerance": ("robustness", "sensitivity", "tolerances"),
    "run": ("compute", "evaluate", "run_study", "sweep"),
}


class _Commands(typer.core.TyperGroup):
    """The commands; an unknown one is answered with the one that is meant."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        name = args[0] if args else ""
        if self.get_command(ctx, name) is None and not name.startswith("-"):
            known = self.list_commands(ctx)
            meant = [command for command in known if name in ELSEWHERE.get(command, ())]
            if name == "help":
                remedy = "`fastlink --help` lists the commands"
            else:
                remedy = f"did you mean {meant[0]!r}?" if meant else suggest(name, known)
            typer.echo(f"fastlink: {name!r} is not a command; {remedy}", err=True)
            ctx.exit(BAD_INPUT)
        return super().resolve_command(ctx, args)


app = typer.Typer(
    cls=_Commands,
    add_completion=False,
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


class _Options(Wording):
    """Words problems in terms of a command's options and arguments.

    Parameters
    ----------
    function : callable
        The command.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self.names: dict[str, str] = {}
        self.switches: set[str] = set()
        for name, hint in get_type_hints(function, include_extras=True).items():
            for declared in getattr(hint, "__metadata__", ()):
                # typer takes the first name of an option for its default until the command runs
                spelt = (declared.default, *(getattr(declared, "param_decls", None) or ()), declared.metavar)
                option = self.names[name] = next((one for one in spelt if isinstance(one, str)), name)
                self.names.setdefault(option.strip("-").replace("-", "_"), option)
                self.switches |= {option} if get_args(hint)[0] is bool else set()

    def path(self, where: KeyPath) -> str:
        if not where or where[0] not in self.names:
            return super().path(where)
        return " ".join([self.names[str(where[0])], *map(str, where[1:])])

    def piece(self, piece: Piece) -> str | None:
        if not isinstance(piece, Setting):
            return super().piece(piece)
        option = self.names.get(piece.name)
        if option is None or piece.value is True or option in self.switches:
            return option
        values = piece.value.items() if isinstance(piece.value, dict) else None
        texts = [str(piece.value)] if values is None else [f"{key}={value}" for key, value in values]
        return " ".join([option, *texts] if option.startswith("-") else texts)


@contextlib.contextmanager
def _remarks_as_lines() -> Iterator[None]:
    """Print each remark on the input as a line, once, in place of Python's two that name a file of code."""
    said: set[str] = set()
    show_other = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *place: Any, **named: Any) -> None:
        if not issubclass(category, InputWarning):
            show_other(message, category, *place, **named)
        elif str(message) not in said:
            said.add(str(message))
            typer.echo(f"fastlink: {message}", err=True)

    with warnings.catch_warnings():
        warnings.simplefilter("always", InputWarning)
        warnings.showwarning = show
        yield


def command(function: C) -> C:
    """Return a command that prints a line for each problem and each remark, never a traceback."""

    @functools.wraps(function)
    def guarded(*args: Any, **options: Any) -> None:
        try:
            with _remarks_as_lines(), _terminable():
                function(*args, **options)
        except InputError as error:
            for line in error.lines(_Options(function)):
                typer.echo(f"fastlink: {line}", err=True)
            _print_notes(error)
            raise typer.Exit(BAD_INPUT) from None
        except KeyboardInterrupt as error:
            terminated = isinstance(error, _Terminated)
            typer.echo(f"fastlink: {'terminated' if terminated else 'interrupted'}", err=True)
            _print_notes(error)
            raise typer.Exit(TERMINATED if terminated else INTERRUPTED) from None

    return guarded  # type: ignore[return-value]


def by_name(
    texts: Iterable[str],
    where: str,
    form: str,
    example: Mapping[str, Any],
    read: Callable[[str], Any],
    doors: tuple[Callable[..., Any], ...] = (),
) -> dict[str, Any]:
    """Return what an option gives as ``NAME=VALUE``, by name.

    Parameters
    ----------
    texts : iterable of str
        The texts.
    where : str
        The parameter of the option.
    form : str
        The form of a text, for messages.
    example : mapping
        What to write instead.
    read : callable
        Reads a value; returns None for what is none.
    doors : tuple of callable
        Where such words stand among the arguments: the command, and the function to which they are keywords. None of
        their options can be a name.

    Examples
    --------
    >>> by_name(["a2 = 1.1:1.2"], "select", "NAME=VALUES", {}, str)
    {'a2': '1.1:1.2'}
    """
    given: dict[str, Any] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        key, options = name.replace("-", "_"), _Options(doors[0]).names if doors else {}
        if equals and (key in options or any(key in signature(one).parameters for one in doors)):
            is_option = options.get(key, "").startswith("-")
            remedy: Remedy = ("write ", Setting(key, value)) if is_option else "leave it out"
            raise InputError(f"{text!r} names an option, not an input", where=(where,), remedy=remedy)
        found = read(value) if equals and name else None
        if found is None:
            remedy = ("write such as ", Setting(where, dict(example)))
            what = (
                f"{name} is {value!r}, not a number"
                if equals and name and value
                else f"{text!r} is not {form}"
            )
            raise InputError(what, where=(where,), remedy=remedy)
        if name in given:
            raise InputError(f"{name} is given twice", where=(where,), remedy="write it once")
        given[name] = found
    return given


def text_of(value: str) -> str | None:
    """Return a value that is any text but an empty one."""
    return value or None


def numbers_of(value: str) -> float | list[float] | None:
    """Return a value that is a number, or a list of several separated by commas.

    Examples
    --------
    >>> numbers_of("0.4"), numbers_of("0,60"), numbers_of("x")
    (0.4, [0.0, 60.0], None)
    """
    numbers = [_number(one) for one in value.split(",")]
    known = [one for one in numbers if one is not None]
    if len(known) < len(numbers):
        return None
    return known if len(known) > 1 else known[0]


def _number(text: str) -> float | None:
    try:
        number = float(text)
    except ValueError:
        return None
    return None if number != number else number


class _Terminated(KeyboardInterrupt):
    """A request to end, such as a scheduler's; to be met as an interrupt is."""


@contextlib.contextmanager
def _terminable() -> Iterator[None]:
    """Meet SIGTERM as an interrupt, which keeps what is computed and says so."""

    def terminate(number: int, frame: Any) -> None:
        raise _Terminated

    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGTERM, terminate)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _print_notes(error: BaseException) -> None:
    """Print what an error has to add, such as where the designs are kept that were computed."""
    for note in getattr(error, "__notes__", ()):
        typer.echo(f"fastlink: {note}", err=True)


def _print_version(wanted: bool) -> None:
    if wanted:
        from fastlink._version import __version__

        typer.echo(f"fastlink {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool,
        typer.Option("--version", help="Print the version.", callback=_print_version, is_eager=True),
    ] = False,
) -> None:
    """Planar linkages by the million: a design space in, one labelled HDF5 map out."""


def extension_of(file: Path, own: Path | None, trusted: bool) -> Extension | None:
    """Return the extension that a Python file declares for a map, None where no file is named."""
    from fastlink.io.reader import open_map
    from fastlink.study.own import load_extension

    if own is None:
        return None
    with open_map(file) as maps:
        return load_extension(Path(), str(own), str(maps.attrs.get("mechanism")), trusted)
