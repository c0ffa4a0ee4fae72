"""The commands on studies: run, explain, accuracy."""

from __future__ import annotations

import contextlib
import functools
import time
from pathlib import Path
from typing import Annotated, Any

import typer

from fastlink.cli.app import Overwrite, StudyFile, TrustCode, command

__all__ = ["accuracy", "explain", "run"]


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
