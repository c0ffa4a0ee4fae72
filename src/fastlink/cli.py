"""The command line: one function for each command.

Everything heavy is imported inside the commands, so that help comes at once.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar, get_type_hints

import typer

from fastlink.errors import InputError, KeyPath, Piece, Setting, Wording

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["app", "main"]

BAD_INPUT, INTERRUPTED = 2, 130
C = TypeVar("C", bound=Callable[..., Any])

StudyFile = Annotated[Path, typer.Argument(metavar="STUDY.toml", help="The study file.", show_default=False)]
MapFile = Annotated[Path, typer.Argument(metavar="FILE", help="A map.", show_default=False)]
MechanismName = Annotated[
    str, typer.Argument(metavar="MECHANISM", help="Such as planar_4r.", show_default=False)
]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace an existing file.")]

app = typer.Typer(
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
        for name, hint in get_type_hints(function, include_extras=True).items():
            for declared in getattr(hint, "__metadata__", ()):
                # typer takes the first name of an option for its default until the command runs
                spelt = (declared.default, *(getattr(declared, "param_decls", None) or ()), declared.metavar)
                self.names[name] = next((one for one in spelt if isinstance(one, str)), name)

    def path(self, where: KeyPath) -> str:
        if not where or where[0] not in self.names:
            return super().path(where)
        return " ".join([self.names[str(where[0])], *map(str, where[1:])])

    def piece(self, piece: Piece) -> str | None:
        if not isinstance(piece, Setting):
            return super().piece(piece)
        option = self.names.get(piece.name)
        if option is None or piece.value is True:
            return option
        values = piece.value.items() if isinstance(piece.value, dict) else None
        texts = [str(piece.value)] if values is None else [f"{key}={value}" for key, value in values]
        return " ".join([option, *texts])


def main() -> None:
    """Run the command line of this process."""
    app(prog_name="fastlink")


def command(function: C) -> C:
    """Register a command that prints a line for each problem, never a traceback."""

    @functools.wraps(function)
    def guarded(*args: Any, **options: Any) -> None:
        try:
            function(*args, **options)
        except InputError as error:
            for line in error.lines(_Options(function)):
                typer.echo(f"fastlink: {line}", err=True)
            raise typer.Exit(BAD_INPUT) from None
        except KeyboardInterrupt as error:
            for note in ("interrupted", *getattr(error, "__notes__", ())):
                typer.echo(f"fastlink: {note}", err=True)
            raise typer.Exit(INTERRUPTED) from None

    registered: C = app.command()(guarded)  # type: ignore[assignment]
    return registered


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import PackageNotFoundError, version

        try:
            typer.echo(f"fastlink {version('fastlink-linkages')}")
        except PackageNotFoundError:  # run from a source tree that is not installed
            typer.echo("fastlink, not installed")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool,
        typer.Option("--version", help="Print the version.", callback=_print_version, is_eager=True),
    ] = False,
) -> None:
    """Planar linkages by the million: a design space in, one labelled HDF5 map out."""


@command
def run(
    study: StudyFile,
    to: Annotated[
        Path | None,
        typer.Option("--to", metavar="FILE", help="The HDF5 file to write, instead of the study's."),
    ] = None,
    threads: Annotated[
        int | None,
        typer.Option("--threads", metavar="N", help="Number of threads; one per processor if left out."),
    ] = None,
    overwrite: Overwrite = False,
    verify: Annotated[
        int | None,
        typer.Option(
            "--verify",
            metavar="N",
            help="Designs to verify with 50 digits; 64 if left out, 0 for none.",
        ),
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print neither progress nor summary.")] = False,
) -> None:
    """Run a study, and write its map."""
    from fastlink.report.summary import summary
    from fastlink.study.study import run_study

    progress = False if quiet else None
    maps = run_study(study, to=to, threads=threads, overwrite=overwrite, progress=progress, verify=verify)
    with maps:
        if not quiet:
            typer.echo(summary(maps))


@command
def explain(
    study: StudyFile,
    text: Annotated[bool, typer.Option("--text", help="Print the text of the kernels too.")] = False,
    ir: Annotated[bool, typer.Option("--ir", help="Print their LLVM text too.")] = False,
    asm: Annotated[
        bool, typer.Option("--asm", help="Print their assembly language for this processor too.")
    ] = False,
) -> None:
    """Explain what a study computes and what it leaves out; nothing is run."""
    from fastlink.diagnostics.explain import explain as explain_study

    typer.echo(explain_study(study).text(kernels=text, ir=ir, asm=asm))


@command
def quantities(
    mechanism: MechanismName,
    every: Annotated[
        bool, typer.Option("--all", help="List intermediate facts too, which cannot be requested by name.")
    ] = False,
    input: Annotated[
        str | None, typer.Option("--input", metavar="INPUT", help="The driven input, such as joint_angle_2.")
    ] = None,
) -> None:
    """List the quantities and inputs of a mechanism."""
    from fastlink.report.quantities import quantities as list_quantities

    typer.echo(str(list_quantities(mechanism, internal=every, input=input)))


@command
def info(
    file: MapFile,
) -> None:
    """Print what a map holds, and how it was computed."""
    from fastlink.report.summary import contents

    with _opened(file) as maps:
        typer.echo(contents(maps))


@command
def new(
    mechanism: MechanismName,
) -> None:
    """Print a commented study that runs as it is.

    For instance: fastlink new planar_4r > study.toml
    """
    from importlib.resources import files

    from fastlink.errors import suggest
    from fastlink.mechanisms import NAMES

    if mechanism not in NAMES:
        remedy = suggest(mechanism, NAMES)
        raise InputError(f"{mechanism!r} is unknown", where=("mechanism",), remedy=remedy)
    template = files("fastlink").joinpath("mechanisms", mechanism, "study.toml")
    typer.echo(template.read_text(encoding="utf-8"), nl=False)


@command
def accuracy(
    study: StudyFile,
    designs: Annotated[int, typer.Option("--designs", metavar="N", help="Number of sampled designs.")] = 64,
    outside: Annotated[
        bool, typer.Option("--outside", help="Add NumPy without any kernel, which takes longer.")
    ] = False,
    to: Annotated[Path | None, typer.Option("--to", metavar="FILE", help="An HDF5 file to write.")] = None,
    picture: Annotated[
        Path | None,
        typer.Option("--picture", metavar="PICTURE", help="Error over time: png, svg or pdf by its ending."),
    ] = None,
    overwrite: Overwrite = False,
) -> None:
    """Measure error and run time of a study by every method that the engine offers."""
    from fastlink.diagnostics import accuracy as measure
    from fastlink.diagnostics import accuracy_table

    options: dict[str, Any] = {"to": to, "picture": picture, "overwrite": overwrite}
    announce = functools.partial(typer.echo, err=True)
    measured = measure(study, designs=designs, outside=outside, announce=announce, **options)
    typer.echo(accuracy_table(measured))


@command
def cache(
    clear: Annotated[bool, typer.Option("--clear", help="Remove all compiled kernels.")] = False,
) -> None:
    """Print where compiled kernels are kept and how large they are, or remove them.

    The environment variables FASTLINK_CACHE_DIR and FASTLINK_CACHE_BYTES set another folder and another limit.
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


@command
def plot(
    file: MapFile,
    name: Annotated[
        str,
        typer.Argument(metavar="NAME", help="The variable; `fastlink info` lists them.", show_default=False),
    ],
    branch: Annotated[
        int | None, typer.Option("--branch", metavar="B", help="One assembly mode; all if left out.")
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option(
            "--at", metavar="DIM=VALUE", help="Fix a dimension at its nearest value; may be repeated."
        ),
    ] = None,
    to: Annotated[
        Path | None,
        typer.Option("--to", metavar="PICTURE", help="png, svg or pdf by its ending; NAME.png if left out."),
    ] = None,
) -> None:
    """Draw a variable of a map."""
    from fastlink.plot.plot_map import plot_map

    fixed = _fixed(at or [])
    picture = to if to is not None else Path(f"{name}.png")
    with _opened(file) as maps:
        plot_map(maps, name, branch=branch, at=fixed, to=picture)
    typer.echo(str(picture))


@contextmanager
def _opened(file: Path) -> Iterator[xr.Dataset]:
    from fastlink.io import open as open_map

    with open_map(file) as maps:
        yield maps


def _fixed(texts: list[str]) -> dict[str, float]:
    """Return the dimensions and values of ``--at DIM=VALUE``."""
    fixed: dict[str, float] = {}
    for text in texts:
        dim, equals, number = text.partition("=")
        try:
            value = float(number)
        except ValueError:
            value = float("nan")
        dim = dim.strip()
        if not (equals and dim) or value != value:
            remedy = ("write such as ", Setting("at", {"a4": 1.0}))
            raise InputError(f"{text!r} is not DIM=VALUE", where=("at",), remedy=remedy)
        if dim in fixed:
            raise InputError(f"{dim} is fixed twice", where=("at",), remedy="write it once")
        fixed[dim] = value
    return fixed


if __name__ == "__main__":
    main()
