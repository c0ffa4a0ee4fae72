"""The command line: one function for each command, and what all of them share.

Everything heavy is imported inside the commands, so that help comes at once.
"""

from __future__ import annotations

import contextlib
import functools
import io
import signal
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from inspect import Parameter, getdoc, signature, unwrap
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar, get_type_hints

import typer
import typer.core

import fastlink as fl
from fastlink.errors import (
    BRITISH,
    InputError,
    InputWarning,
    KeyPath,
    Pair,
    Piece,
    Remedy,
    ResultWarning,
    Setting,
    Wording,
    printable,
    suggest,
)

if TYPE_CHECKING:
    from fastlink.engine.extend import Extension


# -- The application, and what all its commands share: their wording of problems, their options


NOT_AS_WANTED, BAD_INPUT, INTERRUPTED, TERMINATED = 1, 2, 130, 143
C = TypeVar("C", bound=Callable[..., Any])

#: What arguments and options mean that several commands have; each command lists its own below what it does.
MEANINGS = {
    "STUDY.toml": "The study file.",
    "FILE": "A map.",
    "--branch B": "One of the branches, the two ways in which a loop closes; all if left out.",
    "--maximise NAME": "An objective; may be repeated.",
    "--minimise NAME": "An objective; may be repeated.",
    "--overwrite": "Replace an existing file.",
    "--quantities-file FILE.py": "The Python file that declares the map's own quantities, as a study names it; "
    "with --trust-code.",
    "--quiet": "Print neither progress nor summary.",
    "--to PICTURE": "png, svg or pdf by its ending; NAME.png if left out.",
    "--trust-code": "Run the Python file of quantities that is named.",
    "--where NAME=LO:HI": "A condition: a2=1.1:1.3, least_transmission_angle_deg=40:, status=rotates_fully; "
    "may be repeated.",
}

#: Names of commands in other programs, or in Python.
OTHER_NAMES = {
    "accuracy": ("benchmark", "error", "errors"),
    "best": ("front", "optimise", "optimize", "pareto", "rank", "sort", "top"),
    "check": ("fsck", "verify", "checksum"),
    "convert": ("export", "nccopy", "save", "to_netcdf", "transform"),
    "explore": ("browse", "dashboard", "serve", "view"),
    "explain": ("estimate", "forecast", "plan"),
    "info": ("describe", "finite", "head", "open", "print", "show", "summary"),
    "join": ("concat", "combine", "merge"),
    "mechanisms": ("list", "ls"),
    "new": ("init", "template"),
    "draw": ("animate", "linkage", "sketch"),
    "plot": ("map", "picture", "plot_designs", "plot_front", "plot_map"),
    "synthesise": ("design", "generate", "synthesis", "synthesize"),
    "tolerance": ("robustness", "sensitivity", "tolerances"),
    "run": ("compute", "evaluate", "run_study", "sweep"),
}


#: What is meant by an argument too many.
INSTEAD = {"best": "; write objectives as --minimise NAME", "quantities": "; write words as --find WORD"}
#: Of click, or of typer's own copy of it.
UsageError: Any = typer.BadParameter.__base__


@contextlib.contextmanager
def _printable_usage() -> Iterator[None]:
    """Show what typer itself says of a wrong command line as other problems are."""
    try:
        yield
    except UsageError as error:
        option = str(getattr(error, "option_name", "")).lstrip("-").replace("-", "_")
        if option and error.ctx is not None and error.ctx.info_name in ("accuracy", "explain", "run"):
            from fastlink.app.study import in_study

            error.message += f" ({there})" if (there := in_study(option)) else ""
        if type(error).__name__ != "NoArgsIsHelpError":  # whose message is the help
            command = "" if error.ctx is None else str(error.ctx.info_name)
            hint = INSTEAD.get(command, "") if "unexpected extra" in error.message else ""
            error.message = printable(f"{error.message}{hint}")
        raise


class _Commands(typer.core.TyperGroup):
    """The commands; an unknown one is answered with the one that is meant."""

    def make_context(self, *args: Any, **options: Any) -> Any:
        with _printable_usage():
            return super().make_context(*args, **options)

    def invoke(self, ctx: Any) -> Any:
        with _printable_usage():
            return super().invoke(ctx)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        name = args[0] if args else ""
        if self.get_command(ctx, name) is None and not name.startswith("-"):
            known = self.list_commands(ctx)
            meant = [command for command in known if name in OTHER_NAMES.get(command, ())]
            if name == "help":
                remedy = "`fastlink --help` lists the commands"
            else:
                remedy = f"did you mean {meant[0]!r}?" if meant else suggest(name, known)
            typer.echo(f"fastlink: {printable(f'{name!r} is not a command; {remedy}')}", err=True)
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


def _spellings(function: Callable[..., Any]) -> dict[str, str]:
    """Return how each parameter of a command is written and what it means, from the end of its docstring."""
    names = list(signature(function).parameters)
    lines = getdoc(unwrap(function)).splitlines()[-len(names) :] if names else []  # type: ignore[union-attr]
    return dict(zip(names, lines, strict=True))


def _for_typer(parameter: Parameter, hint: Any, line: str) -> Parameter:
    """Return a parameter of a command with what typer has to know of it."""
    spelt, _, meaning = line.partition("  ")
    option, _, metavar = spelt.partition(" ")
    about: dict[str, Any] = {"help": meaning.strip() or MEANINGS[spelt], "metavar": metavar or None}
    if option.startswith("-"):
        others = [f"--{other}" for other, name in BRITISH.items() if name == parameter.name]
        declared = typer.Option(option, *others, **about, show_default=type(parameter.default) is int)
    else:
        declared = typer.Argument(**about | {"metavar": spelt}, show_default=False)
    return parameter.replace(annotation=Annotated[hint, declared])


class _Options(Wording):
    """The wording of problems in terms of a command's options and arguments."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.names: dict[str, str] = {}
        self.switches: set[str] = set()
        for name, line in _spellings(function).items():
            spelt = line.partition("  ")[0]
            option = self.names[name] = spelt.split(" ")[0]
            self.names.setdefault(option.strip("-").replace("-", "_"), option)
            self.switches |= {option} if option == spelt and option.startswith("-") else set()

    def path(self, where: KeyPath) -> str:
        if not where or where[0] not in self.names:
            return super().path(where)
        return " ".join([self.names[str(where[0])], *map(str, where[1:])])

    def piece(self, piece: Piece) -> str | None:
        if isinstance(piece, Pair):
            return "LO:HI, LO: or :HI" if piece.unlimited else "LO:HI"
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
    """Print each remark as a line, once, in place of Python's two that name a file of code; end with 1 after some."""
    said: dict[str, type[Warning]] = {}
    show_other = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *place: Any, **named: Any) -> None:
        if not issubclass(category, InputWarning):
            show_other(message, category, *place, **named)
        elif str(message) not in said:
            said[str(message)] = category
            typer.echo(f"fastlink: {message}", err=True)

    with warnings.catch_warnings():
        warnings.simplefilter("always", InputWarning)
        warnings.showwarning = show
        yield
    if ResultWarning in said.values():
        raise typer.Exit(NOT_AS_WANTED)


def command(function: C) -> C:
    """Return a command that prints a line for each problem and each remark, never a traceback.

    The last lines of its docstring are those of its parameters, in their order: as each is written, and after two
    blanks what it means.
    """

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

    lines, called, hints = _spellings(function), signature(function), get_type_hints(function)
    given = [_for_typer(one, hints[name], lines[name]) for name, one in called.parameters.items()]
    guarded.__signature__ = called.replace(parameters=given)  # type: ignore[attr-defined]
    guarded.__doc__ = "\n".join(getdoc(function).splitlines()[: -len(given) or None])  # type: ignore[union-attr]
    app.command()(guarded)
    return guarded  # type: ignore[return-value]


def by_name(
    texts: Iterable[str] | None,
    where: str,
    form: str,
    example: Mapping[str, Any],
    read: Callable[[str], Any],
    doors: tuple[Callable[..., Any], ...] = (),
) -> dict[str, Any]:
    """Return what an option gives as ``NAME=VALUE``, by name; None of `read` is what is no value.

    `doors` are the command and the function to which such words are keywords: none of their options can be a name.
    """
    from fastlink.space.units import named_with_unit

    given: dict[str, Any] = {}
    for text in texts or ():
        name, equals, value = (part.strip() for part in text.partition("="))
        key, options = name.replace("-", "_"), _Options(doors[0]).names if doors else {}
        if equals and (key in options or any(key in signature(one).parameters for one in doors)):
            is_option = options.get(key, "").startswith("-")
            remedy: Remedy = ("write ", Setting(key, value)) if is_option else "leave it out"
            raise InputError(f"{text!r} names an option, not an input", (where,), remedy)
        found = read(value) if equals and name else None
        if found is None:
            is_pair = equals and name and value
            what = f"{name} is {value!r}, not a number" if is_pair else f"{text!r} is not {form}"
            such = ("write such as ", Setting(where, dict(example)))
            raise InputError(what, (where,), named_with_unit(name, name and value) or such)
        if name in given:
            raise InputError(f"{name} is given twice", (where,), "write it once")
        given[name] = found
    return given


def _parts(text: str) -> list[str]:
    return [name.strip() for name in text.split(",")]


def text_of(value: str) -> str | None:
    """Return a value that is any text but an empty one."""
    return value or None


def numbers_of(value: str) -> float | list[float] | None:
    """Return a value that is a number, or a list of several separated by commas."""
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
        typer.echo(f"fastlink {fl.__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool,
        typer.Option("--version", help="Print the version.", callback=_print_version, is_eager=True),
    ] = False,
) -> None:
    """Planar linkages by the million: a design space in, one labelled HDF5 map out."""


def print_summary(maps: Any) -> None:
    """Print the summary of a map that was made, and the designs that a whole search has found."""
    from fastlink.app.report import listed, summary
    from fastlink.io.reader import PartOfMap

    typer.echo(summary(maps))
    if {"search", "synthesis"} & set(maps.attrs) and PartOfMap.of(maps.attrs) is None:
        found = maps.load()
        found.attrs.pop("selection", None)  # which the summary has said
        names = [str(name) for name, one in found.data_vars.items() if one.ndim == 1]
        typer.echo(listed(found, names, degrees="deg" in str(maps.attrs.get("study"))))  # as the study is


def extension_of(file: Path, own: Path | None, trusted: bool) -> Extension | None:
    """Return the extension that a Python file declares for a map, None where no file is named."""
    from fastlink.app.study import load_extension

    if own is None:
        return None
    with fl.open(file) as maps:
        return load_extension(Path(), str(own), str(maps.attrs.get("mechanism")), trusted)


# -- The commands in the order of the help: from a first look at a mechanism to its maps


EXAMPLE = {"a1": 0.4}


@command
def mechanisms() -> None:
    """List the mechanisms."""
    typer.echo(str(fl.mechanisms()))


@command
def new(
    mechanism: str,
) -> None:
    """Print a commented study that runs as it is.

    For instance: fastlink new planar_4r > study.toml

    MECHANISM  Such as planar_4r; linkage for one by its joints.
    """
    from importlib.resources import files

    from fastlink.errors import check_choice
    from fastlink.mechanisms import NAMES, SHEET, catalogue

    declared = "linkage"
    if not mechanism.endswith(SHEET) and mechanism != declared:
        catalogue(mechanism)  # which says what an unknown name may mean
    check_choice(("mechanism",), mechanism, (*NAMES, declared))
    template = files("fastlink").joinpath("mechanisms", mechanism, "study.toml")
    typer.echo(template.read_text(encoding="utf-8"), nl=False)


@command
def quantities(
    mechanism: str | None = None,
    every: bool = False,
    input: str | None = None,
    find: str | None = None,
    source: bool = False,
) -> None:
    """List the quantities and inputs of a mechanism, or find them by what they mean.

    MECHANISM|STUDY.toml  Such as planar_4r; or that of a study; all with --find.
    --all  List intermediate facts too, which cannot be requested by name.
    --input INPUT  The driven input, such as joint_angle_2.
    --find PHRASE  Only what a phrase means, such as torque.
    --source  Show the formula of each, and the sheet and the line where it stands.
    """
    if mechanism is not None and mechanism.lower().endswith(".toml"):
        from fastlink.app.study import mechanism_of_study

        mechanism = mechanism_of_study(mechanism)
    found = fl.quantities(mechanism, internal=every, input=input, find=find)
    typer.echo(found.formulas() if source else str(found))


@command
def draw(
    mechanism: str,
    inputs: list[str] | None = None,
    design: int | None = None,
    at: list[str] | None = None,
    branch: int | None = None,
    input: str | None = None,
    *,
    strip: int | None = None,
    curves: list[str] | None = None,
    show: list[str] | None = None,
    degrees: bool = False,
    to: Path | None = None,
    animate: Path | None = None,
    frames: int = 60,
    trust_code: bool = False,
) -> None:
    """Draw a mechanism as it stands at an input position, to scale.

    For instance: fastlink draw planar_4r a1=0.4 a2=1.1 a3=0.8 a4=1.0 theta1_deg=60

    MECHANISM|STUDY.toml|FILE  Such as planar_4r; a study; a map.
    NAME=VALUE  Inputs, and the input position, such as theta1_deg=60; theta1_deg=0,60,120 for three side by side.
    --design N  The design of a study or a map, from 0.
    --at DIM=VALUE  The design at the nearest value; may be repeated.
    --branch B
    --input INPUT  The driven input, such as sigma.
    --strip N  N positions over the motion, side by side.
    --curves NAME  A quantity over the input, beside; may be repeated.
    --show WORD  Instead of the usual: path, circles, comb, forces, torques, all; may be repeated.
    --degrees  Show angles in degrees.
    --to PICTURE  png, svg or pdf; .dxf or .mm.svg: at true scale, in millimetres.
    --animate FILM  The motion: gif, html or mp4 by its ending.
    --frames N  Pictures of a film.
    --trust-code
    """
    from fastlink.space.design_space import taken_links

    given: dict[str, Any] = by_name(inputs, "inputs", "NAME=VALUE", EXAMPLE, numbers_of, (draw, fl.draw))
    fixed = by_name(at, "at", "DIM=VALUE", EXAMPLE, numbers_of) if at else None
    picture = to if to is not None or animate is not None else Path(f"{Path(mechanism).stem}.png")
    own: dict[str, Any] = {"at": fixed, "branch": branch, "input": input, "strip": strip, "show": show}
    own |= {"curves": curves or (), "degrees": degrees, "to": picture, "links": taken_links(given)}
    own |= {"animate": animate, "frames": frames, "trust_code": trust_code}
    fl.draw(mechanism, design, **own, **given)
    for path in filter(None, (picture, animate)):
        typer.echo(str(path))


@command
def explain(
    study: Path,
    kernels: bool = False,
    text: bool = False,
    ir: bool = False,
    asm: bool = False,
    measure: bool | None = None,
    *,
    trust_code: bool = False,
) -> None:
    """Explain what a study computes, leaves out and needs: memory, file, time; nothing is compiled.

    STUDY.toml
    --kernels  Print what each kernel computes, and what is left out.
    --text  Print the text of the kernels too.
    --ir  Print their LLVM text too.
    --asm  Print their assembly language for this processor too.
    --measure/--no-measure  Run a sample of the designs to say how long all take; by default if all is compiled already.
    --trust-code
    """
    found = fl.explain(study, measure=measure, trust_code=trust_code)
    typer.echo(found.text(kernels=kernels, code=text, ir=ir, asm=asm))


@command
def run(
    study: Path,
    to: Path | None = None,
    threads: int | None = None,
    overwrite: bool = False,
    verify: int | None = None,
    quiet: bool = False,
    *,
    restart: bool = False,
    part: str | None = None,
    layout: str | None = None,
    client: str | None = None,
    trust_code: bool = False,
) -> None:
    """Run a study, and write its map; a map that is there and up to date is kept.

    STUDY.toml
    --to FILE  The HDF5 file to write, instead of the study's.
    --threads N  Number of threads; one per processor if left out.
    --overwrite
    --verify N  Designs to verify with 50 digits; 64 if left out, 0 for none.
    --quiet
    --restart  Throw away what an interrupted run has left in FILE.part.
    --part K/N  Run the K-th of N parts of the designs, to be joined.
    --layout LAYOUT  How the map is to be read: 'curves' design by design, 'maps' position by position.
    --dask ADDRESS  Run on a dask.distributed cluster: the address of its scheduler, or its scheduler file.
    --trust-code
    """
    from fastlink.io.layout import WRITTEN

    progress, started = False if quiet else None, time.time_ns()
    options: dict[str, Any] = {"threads": threads, "overwrite": overwrite, "restart": restart, "part": part}
    options |= {"verify": verify, "layout": layout, "trust_code": trust_code}
    with contextlib.ExitStack() as stack:
        if client is not None:
            from fastlink.engine.cluster import connected

            options["client"] = stack.enter_context(connected(("client",), client))
        maps = stack.enter_context(fl.run(study, to=to, progress=progress, **options))
        if maps.attrs[WRITTEN] < started:
            typer.echo(f"{maps.encoding['source']} is up to date")
        if not quiet:
            print_summary(maps)


@command
def join(
    paths: list[Path],
    to: Path,
    copy: bool = False,
    overwrite: bool = False,
    restart: bool = False,
    quiet: bool = False,
    *,
    mechanism: Path | None = None,
    trust_code: bool = False,
) -> None:
    """Join the parts of a map, or of a search, that `fastlink run --part K/N` has written; values of a map stay there.

    For instance: fastlink join maps.part-*.h5 --to maps.h5

    PART...  The parts of a map or of a search, or their folder.
    --to FILE  The HDF5 file to write.
    --copy  Copy the values to one file, which does not need the parts.
    --overwrite
    --restart  Throw away what an interrupted join has left in FILE.part.
    --quiet
    --quantities-file FILE.py
    --trust-code
    """
    from fastlink.io.joining import part_files

    options: dict[str, Any] = {"progress": False if quiet else None, "copy": copy, "overwrite": overwrite}
    if mechanism is not None:
        options["mechanism"] = extension_of(part_files(paths)[0].path, mechanism, trust_code)
    with fl.join(paths, to=to, restart=restart, **options) as maps:
        if not quiet:
            print_summary(maps)


@command
def info(
    file: Path,
) -> None:
    """Print what a map holds, and how it was computed.

    FILE
    """
    from fastlink.app.report import contents

    typer.echo(contents(file))


@command
def check(
    file: Path,
) -> None:
    """Check every byte of a map against its checksums; the exit status is 1 where some have changed.

    FILE
    """
    found = fl.check(file)
    typer.echo(str(found))
    if not found:
        raise typer.Exit(NOT_AS_WANTED)


@command
def best(
    file: Path,
    *,
    minimise: list[str] | None = None,
    maximise: list[str] | None = None,
    where: list[str] | None = None,
    top: int | None = None,
    refine: bool = False,
    changing: str | None = None,
    degrees: bool = False,
    to: Path | None = None,
    overwrite: bool = False,
    mechanism: Path | None = None,
    trust_code: bool = False,
) -> None:
    """List the best designs of a map, by several objectives the Pareto front; the exit status is 1 if none is right.

    FILE
    --minimise NAME
    --maximise NAME
    --where NAME=LO:HI
    --top N  How many, by one objective; 10 if left out.
    --refine  Go on from them off the grid, by derivatives, within the conditions.
    --changing A,B  Inputs that --refine may change; all swept ones if left out.
    --degrees  Show angles in degrees, as where a condition is in degrees.
    --to FILE  Write them too: h5, nc, zarr, csv, parquet or xlsx by its ending.
    --overwrite
    --quantities-file FILE.py
    --trust-code
    """
    from fastlink.app.report import listed, refinement_columns
    from fastlink.io.convert import check_conversion
    from fastlink.space.units import DEGREES, split

    wanted = _conditions(where or [])
    options: dict[str, Any] = {"minimise": minimise or (), "maximise": maximise or ()}
    for name, given, mend in (("changing", changing, ""), ("mechanism", mechanism, ", or leave it out")):
        if given is not None and not refine:
            raise InputError("is given without --refine", (name,), f"add --refine{mend}")
    options["refine"] = refine if changing is None else _parts(changing)
    options |= {"where": wanted or None, "top": top, "mechanism": extension_of(file, mechanism, trust_code)}
    with fl.open(file) as maps:
        if to is not None:
            check_conversion(maps, to, overwrite)
        found = fl.best(maps, **options).load()
    if to is not None:
        fl.convert(found, to, overwrite=overwrite)
    names = [*(minimise or ()), *(maximise or ()), *wanted]
    in_degrees = degrees or any(split(name, found.variables)[1] in DEGREES for name in wanted)
    typer.echo(listed(found, [*names, *refinement_columns(found)], degrees=in_degrees))


def _conditions(texts: list[str]) -> dict[str, Any]:
    """Return the conditions of ``--where NAME=LO:HI``, ``--where NAME=NUMBER`` and ``--where NAME=MEANING``."""
    form = "NAME=LO:HI, NAME=NUMBER or NAME=MEANING"
    return by_name(texts, "where", form, {"a2": "1.1:1.3"}, text_of)


@command
def synthesise(
    file: Path,
    *,
    motion: bool = False,
    function: bool = False,
    timing: str | None = None,
    closed: bool = False,
    exact: bool = False,
    rotation_length: float | None = None,
    turn_deg: str | None = None,
    travel: float | None = None,
    precision_points: int | None = None,
    mechanism: str = "planar_4r",
    quantities: str | None = None,
    where: list[str] | None = None,
    bounds: list[str] | None = None,
    fixed: list[str] | None = None,
    minimise: list[str] | None = None,
    maximise: list[str] | None = None,
    top: int = 10,
    seed: int = 0,
    to: Path | None = None,
    overwrite: bool = False,
    restart: bool = False,
) -> None:
    """Find four-bar linkages or slider-cranks for the points of a path, the poses of a body, or pairs of a function.

    CURVE.csv  Rows of x, y; of x, y, angle for --motion; of x, y for --function. Names in the first line.
    --motion  The rows are poses of a body.
    --function  The rows are pairs of input and output.
    --timing T1,T2,...  Crank angles in rad at the points of a path, or even.
    --closed  The path closes.
    --exact  All linkages through nine points, or five with timing.
    --rotation-length L  The length at which an error of direction counts, of more than five poses.
    --turn-deg IN,OUT  The turns of both shafts over the range of a function; IN of a slider-crank.
    --travel L  How far the slider of a slider-crank moves over that range, in m.
    --precision-points N  3 to 5 pairs in Chebyshev's spacing that are met exactly.
    --mechanism NAME  planar_4r or slider_crank.
    --quantities A,B  What else is computed of each.
    --where NAME=LO:HI
    --bounds NAME=LO,HI  The range of a length, pivot or angle of the linkage; may be repeated.
    --fixed NAME=NUMBER  A length, pivot or angle that is given; may be repeated.
    --minimise NAME
    --maximise NAME
    --top N  How many.
    --seed N  Of the starts.
    --to FILE.h5  Write them too, as a map.
    --overwrite
    --restart  Throw away what a stopped run has left.
    """
    from fastlink.app.report import listed

    if motion and function:
        raise InputError("is given beside --motion", ("function",), "write one of them")
    times: Any = timing if timing is None or timing == "even" else numbers_of(timing)
    if times != timing and not isinstance(times, list):
        raise InputError(f"is {timing!r}", ("timing",), "write numbers with commas, or even")
    of = "motion" if motion else "function" if function else "path"
    given: dict[str, Any] = {of: file, "timing": times}
    given |= {
        "closed": closed or None,
        "exact": exact,
        "travel": travel,
        "precision_points": precision_points,
        "rotation_length": rotation_length,
        "turn_deg": None if turn_deg is None else numbers_of(turn_deg),
    }
    ranges = by_name(bounds, "bounds", "NAME=LO,HI", {"a1": "0.1,1"}, numbers_of)
    given |= {"bounds": ranges or None, "where": _conditions(where or []) or None}
    given["fixed"] = by_name(fixed, "fixed", "NAME=NUMBER", {"O_x": "0"}, numbers_of) or None
    given |= {"minimise": minimise or (), "maximise": maximise or (), "top": top, "seed": seed}
    names = [] if quantities is None else _parts(quantities)
    found = fl.synthesise(mechanism, names, to=to, overwrite=overwrite, restart=restart, **given).load()
    if not found.sizes["design"]:
        raise InputError(str(found.attrs["reason"]), (), "widen the limits, or try other seeds")
    columns = [str(name) for name, one in found.data_vars.items() if one.dims == ("design",)]
    typer.echo(listed(found, columns))


@command
def tolerance(
    source: Path,
    tolerances: list[str] | None = None,
    *,
    quantities: str | None = None,
    contributions: bool = False,
    to: Path | None = None,
    overwrite: bool = False,
    mechanism: Path | None = None,
    trust_code: bool = False,
) -> None:
    """Tell what manufacturing tolerances do to the results of a map or a study.

    For instance: fastlink tolerance best.h5 a1=1e-4 a2=0.1% --contributions

    FILE  A map, or a study (.toml).
    INPUT=T...  Of each input, in its unit or in per cent: a1=1e-4 a2=0.1%.
    --quantities A,B  Results; all that change if left out.
    --contributions  Add the change by each input alone.
    --to FILE  Write a map of it.
    --overwrite
    --quantities-file FILE.py
    --trust-code
    """
    from fastlink.app.report import changes_listed

    given = by_name(
        tolerances, "tolerances", "INPUT=T", {"a1": 1e-4}, _number_or_text, (tolerance, fl.tolerance)
    )
    names = None if quantities is None else _parts(quantities)
    options: dict[str, Any] = {"contributions": contributions, "to": to, "overwrite": overwrite}
    options["trust_code"] = trust_code
    if mechanism is not None and source.suffix.lower() == ".toml":
        what = "is for a map: a study names the file of its quantities itself"
        raise InputError(what, ("mechanism",), "leave it out")
    options["mechanism"] = extension_of(source, mechanism, trust_code)
    with fl.tolerance(source, names, **options, **given) as found:
        typer.echo(changes_listed(found))


def _number_or_text(text: str) -> float | str | None:
    """Return a value that is a number as one."""
    return text_of(text) if (number := _number(text)) is None else number


@command
def convert(
    file: Path,
    to: Path,
    select: list[str] | None = None,
    quantities: str | None = None,
    dtype: str | None = None,
    *,
    compress: str | None = None,
    overwrite: bool = False,
    quiet: bool = False,
) -> None:
    """Convert a map to another format, compressed, in part, or with fewer digits.

    FILE
    --to OUT  h5, nc, zarr, csv, parquet or xlsx by its ending.
    --select NAME=VALUES  Take a2=1.1:1.2 (both ends), theta1=0.5 (nearest), theta1_deg=90 or a2=#0:10; may be repeated.
    --quantities A,B  Variables to take; all if left out.
    --dtype TYPE  float32, or float64, for results.
    --compress NAME:LEVEL  gzip, zstd, blosc or lz4, such as zstd:3.
    --overwrite
    --quiet  Print no progress.
    """
    conditions = by_name(select, "select", "NAME=VALUES", {"a2": "1.1:1.2"}, text_of)
    names = None if quantities is None else _parts(quantities)
    options: dict[str, Any] = {"dtype": dtype, "compress": compress, "overwrite": overwrite}
    options["progress"] = False if quiet else None
    typer.echo(str(fl.convert(file, to, select=conditions or None, quantities=names, **options)))


@command
def plot(
    file: Path,
    names: list[str] | None = None,
    *,
    kind: str | None = None,
    minimise: list[str] | None = None,
    maximise: list[str] | None = None,
    where: list[str] | None = None,
    branch: int | None = None,
    at: list[str] | None = None,
    panels: str | None = None,
    lines: str | None = None,
    degrees: bool = False,
    to: Path | None = None,
) -> None:
    """Draw a map: one variable over one or two inputs; or rows by several variables; or a Pareto front.

    For instance: fastlink plot maps.h5 omega4_max --at a4=1.0

    Of all rows: fastlink plot maps.h5 omega4_max least_transmission_angle --where status=rotates_fully

    A front: fastlink plot maps.h5 --minimise omega4_max --maximise least_transmission_angle

    FILE
    NAME...  A variable, or several; `fastlink info` lists them.
    --kind KIND  Of all rows: scatter (X Y, and a colour), corner, or cumulative.
    --minimise NAME
    --maximise NAME
    --where NAME=LO:HI
    --branch B
    --at DIM=VALUE  Fix a dimension at its nearest value; may be repeated.
    --panels DIM  A small map for each of some values of a third input.
    --lines DIM  A line for each of some values of an input.
    --degrees  Show angles in degrees, and read those of --at so.
    --to PICTURE
    """
    given = [one for name in names or [] for one in (_parts(name) if "=" not in name else [name])]
    options = [one for one in given if one.find("=") > 0]
    for dim, value in by_name(options, "names", "NAME", {}, str, (plot, fl.plot)).items():
        at_it = ("write ", Setting("at", {dim: value}))
        raise InputError(f"{dim}={value} is no variable", ("names",), at_it)
    picture = to if to is not None else Path(f"{'-'.join(given) or 'front'}.png")
    own: dict[str, Any] = {
        "kind": kind,
        "branch": branch,
        "degrees": degrees,
        "panels": panels,
        "lines": lines,
    }
    own |= {"minimise": minimise or (), "maximise": maximise or (), "where": _conditions(where or []) or None}
    own["at"] = by_name(at, "at", "DIM=VALUE", {"a4": 1.0}, numbers_of) or None
    fl.plot(file, given, **own, to=picture)
    typer.echo(str(picture))


@command
def explore(
    file: Path,
    to: Path | None = None,
    *,
    port: int = 0,
    browser: bool = True,
) -> None:
    """Show a map in the browser, with the mechanism of each design moving, until Ctrl-C.

    The page is served to this machine alone, to whoever has its address with the random token in it.

    FILE
    --to PAGE.html  Write one page that needs no Python, and serve nothing.
    --port N  Where the page is served; 0 for a free port.
    --browser/--no-browser  Open the page in the browser.
    """
    with fl.explore(file, to=to, port=port, browser=browser) as page:
        if to is not None:
            typer.echo(str(to))
            return
        typer.echo(f"{page.url}\nCtrl-C ends it")
        with contextlib.suppress(KeyboardInterrupt):
            threading.Event().wait()


@command
def accuracy(
    study: Path,
    designs: int = 64,
    outside: bool = False,
    to: Path | None = None,
    picture: Path | None = None,
    overwrite: bool = False,
    *,
    trust_code: bool = False,
) -> None:
    """Measure error and run time of a study by every method that the engine offers.

    STUDY.toml
    --designs N  Number of sampled designs.
    --outside  Add NumPy without any kernel, which takes longer.
    --to FILE  An HDF5 file to write.
    --picture PICTURE  Error over time: png, svg or pdf by its ending.
    --overwrite
    --trust-code
    """
    options: dict[str, Any] = {"to": to, "picture": picture, "overwrite": overwrite, "trust_code": trust_code}
    announce = functools.partial(typer.echo, err=True)
    measured = fl.accuracy(study, designs=designs, outside=outside, announce=announce, **options)
    typer.echo(measured.fastlink.summary())


@command
def cache(
    clear: bool = False,
) -> None:
    """Print where compiled kernels are kept and how large they are, or remove them.

    The environment variables FASTLINK_CACHE_DIR and FASTLINK_CACHE_BYTES set another folder and another limit.

    --clear  Remove all compiled kernels.
    """
    from fastlink._text import counted, size
    from fastlink.codegen import cache as kernel_cache

    state = kernel_cache.clear() if clear else kernel_cache.contents()
    kernels = f"{counted(state.kernels, 'kernel')} of {size(state.size)}"
    if clear:
        left = kernel_cache.contents().size
        remark = f"; {size(left)} could not be removed" if left else ""
        typer.echo(f"{state.folder}: {kernels} removed{remark}")
    else:
        typer.echo(f"{state.folder}: {kernels}; beyond {size(state.limit)} the oldest are removed")


def main() -> None:
    """Run the command line of this process."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and stream.errors == "strict":
            stream.reconfigure(errors="backslashreplace")  # names of files may hold what is no letter
    app(prog_name="fastlink")


if __name__ == "__main__":
    main()
