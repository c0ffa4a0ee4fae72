"""The commands on studies: run, explain, accuracy, tolerance."""

from __future__ import annotations

import contextlib
import functools
import time
from pathlib import Path
from typing import Annotated, Any

import typer

from fastlink.cli.app import (
    Overwrite,
    QuantitiesFile,
    StudyFile,
    TrustCode,
    by_name,
    command,
    extension_of,
    text_of,
)
from fastlink.errors import InputError

__all__ = ["accuracy", "explain", "run", "tolerance"]


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
    *,
    restart: Annotated[
        bool, typer.Option("--restart", help="Throw away what an interrupted run has left in FILE.part.")
    ] = False,
    part: Annotated[
        str | None,
        typer.Option("--part", metavar="K/N", help="Run the K-th of N parts of the designs, to be joined."),
    ] = None,
    layout: Annotated[
        str | None,
        typer.Option(
            "--layout",
            metavar="LAYOUT",
            help="How the map is to be read: 'curves' design by design, 'maps' position by position.",
        ),
    ] = None,
    client: Annotated[
        str | None,
        typer.Option(
            "--dask",
            metavar="ADDRESS",
            help="Run on a dask.distributed cluster: the address of its scheduler, or its scheduler file.",
        ),
    ] = None,
    trust_code: TrustCode = False,
) -> None:
    """Run a study, and write its map; a map that is there and up to date is kept."""
    from fastlink.io.finished import WRITTEN
    from fastlink.report.summary import summary
    from fastlink.study.study import run_study

    progress, started = False if quiet else None, time.time_ns()
    options: dict[str, Any] = {
        "threads": threads,
        "overwrite": overwrite,
        "restart": restart,
        "verify": verify,
        "part": part,
        "layout": layout,
        "trust_code": trust_code,
    }
    with contextlib.ExitStack() as stack:
        if client is not None:
            from fastlink.engine.distributed import connected

            options["client"] = stack.enter_context(connected(("client",), client))
        maps = stack.enter_context(run_study(study, to=to, progress=progress, **options))
        if maps.attrs[WRITTEN] < started:
            typer.echo(f"{maps.encoding['source']} is up to date")
        if not quiet:
            typer.echo(summary(maps))
        if not quiet and "search" in maps.attrs:
            from fastlink.report.designs import listed

            found = maps.load()
            del found.attrs["selection"]  # which the summary has said
            typer.echo(listed(found, [str(name) for name, one in found.data_vars.items() if one.ndim == 1]))


@command
def explain(
    study: StudyFile,
    text: Annotated[bool, typer.Option("--text", help="Print the text of the kernels too.")] = False,
    ir: Annotated[bool, typer.Option("--ir", help="Print their LLVM text too.")] = False,
    asm: Annotated[
        bool, typer.Option("--asm", help="Print their assembly language for this processor too.")
    ] = False,
    measure: Annotated[
        bool | None,
        typer.Option(
            "--measure/--no-measure",
            help="Run a sample of the designs to say how long all take; by default if all is compiled already.",
            show_default=False,
        ),
    ] = None,
    *,
    trust_code: TrustCode = False,
) -> None:
    """Explain what a study computes, leaves out and needs: memory, file, time; nothing is compiled."""
    from fastlink.diagnostics.explain import explain as explain_study

    typer.echo(
        explain_study(study, measure=measure, trust_code=trust_code).text(kernels=text, ir=ir, asm=asm)
    )


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
    *,
    trust_code: TrustCode = False,
) -> None:
    """Measure error and run time of a study by every method that the engine offers."""
    from fastlink.diagnostics import accuracy as measure
    from fastlink.diagnostics import accuracy_table

    options: dict[str, Any] = {"to": to, "picture": picture, "overwrite": overwrite, "trust_code": trust_code}
    announce = functools.partial(typer.echo, err=True)
    measured = measure(study, designs=designs, outside=outside, announce=announce, **options)
    typer.echo(accuracy_table(measured))


@command
def tolerance(
    source: Annotated[
        Path,
        typer.Argument(metavar="FILE", help="A map, or a study (.toml).", show_default=False),
    ],
    tolerances: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="INPUT=T...",
            help="Of each input, in its unit or in per cent: a1=1e-4 a2=0.1%.",
            show_default=False,
        ),
    ] = None,
    *,
    quantities: Annotated[
        str | None,
        typer.Option("--quantities", metavar="A,B", help="Results; all that change if left out."),
    ] = None,
    contributions: Annotated[
        bool, typer.Option("--contributions", help="Add the change by each input alone.")
    ] = False,
    to: Annotated[Path | None, typer.Option("--to", metavar="FILE", help="Write a map of it.")] = None,
    overwrite: Overwrite = False,
    mechanism: QuantitiesFile = None,
    trust_code: TrustCode = False,
) -> None:
    """Tell what manufacturing tolerances do to the results of a map or a study.

    For instance: fastlink tolerance best.h5 a1=1e-4 a2=0.1% --contributions
    """
    from fastlink.diagnostics.tolerance import tolerance as found_by
    from fastlink.report.tolerances import changes_listed

    given = by_name(
        tolerances or [], "tolerances", "INPUT=T", {"a1": 1e-4}, _number_or_text, (tolerance, found_by)
    )
    names = None if quantities is None else [name.strip() for name in quantities.split(",")]
    options: dict[str, Any] = {"contributions": contributions, "to": to, "overwrite": overwrite}
    options["trust_code"] = trust_code
    if mechanism is not None and source.suffix.lower() == ".toml":
        what = "is for a map: a study names the file of its quantities itself"
        raise InputError(what, where=("mechanism",), remedy="leave it out")
    options["mechanism"] = extension_of(source, mechanism, trust_code)
    with found_by(source, names, **options, **given) as found:
        typer.echo(changes_listed(found))


def _number_or_text(text: str) -> float | str | None:
    """Return a value that is a number as one."""
    try:
        return float(text)
    except ValueError:
        return text_of(text)
