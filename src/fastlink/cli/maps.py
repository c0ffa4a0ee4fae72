"""The commands on maps: info, check, plot."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fastlink.cli.app import MapFile, command
from fastlink.errors import InputError, Setting

__all__ = ["check", "info", "plot"]

CHANGED = 1


@command
def info(
    file: MapFile,
) -> None:
    """Print what a map holds, and how it was computed."""
    from fastlink.report.summary import contents

    typer.echo(contents(file))


@command
def check(
    file: MapFile,
) -> None:
    """Check every byte of a map against its checksums; the exit status is 1 where some have changed."""
    from fastlink.io.check import check

    found = check(file)
    typer.echo(str(found))
    if not found:
        raise typer.Exit(CHANGED)


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
    degrees: Annotated[
        bool, typer.Option("--degrees", help="Show angles in degrees, and read those of --at so.")
    ] = False,
    to: Annotated[
        Path | None,
        typer.Option("--to", metavar="PICTURE", help="png, svg or pdf by its ending; NAME.png if left out."),
    ] = None,
) -> None:
    """Draw a variable of a map."""
    from fastlink.plot.plot_map import plot_map

    fixed = _fixed(at or [])
    picture = to if to is not None else Path(f"{name}.png")
    plot_map(file, name, branch=branch, at=fixed, degrees=degrees, to=picture)
    typer.echo(str(picture))


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
