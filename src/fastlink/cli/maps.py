"""The commands on maps: info, check, best, plot."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from fastlink.cli.app import MapFile, command, numbers_by_name
from fastlink.errors import InputError, Setting

__all__ = ["best", "check", "info", "plot"]

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


Objectives = list[str] | None


@command
def best(
    file: MapFile,
    minimise: Annotated[
        Objectives, typer.Option("--minimise", metavar="NAME", help="An objective; may be repeated.")
    ] = None,
    maximise: Annotated[
        Objectives, typer.Option("--maximise", metavar="NAME", help="An objective; may be repeated.")
    ] = None,
    where: Annotated[
        list[str] | None,
        typer.Option(
            "--where",
            metavar="NAME=LO:HI",
            help="A condition: a2=1.1:1.3, transmission_angle_min_deg=40:, status=rotates_fully; may be repeated.",
        ),
    ] = None,
    top: Annotated[
        int | None, typer.Option("--top", metavar="N", help="How many, by one objective; 10 if left out.")
    ] = None,
    degrees: Annotated[bool, typer.Option("--degrees", help="Show angles in degrees.")] = False,
) -> None:
    """List the best designs of a map, by several objectives the Pareto front."""
    from fastlink.io.reader import open_map
    from fastlink.maps.best import best as find
    from fastlink.report.designs import listed

    wanted = _conditions(where or [])
    options: dict[str, Any] = {
        "minimise": minimise or (),
        "maximise": maximise or (),
        "where": wanted or None,
        "top": top,
    }
    with open_map(file) as maps:
        found = find(maps, **options).load()
    typer.echo(listed(found, [*(minimise or ()), *(maximise or ()), *wanted], degrees=degrees))


def _conditions(texts: list[str]) -> dict[str, Any]:
    """Return the conditions of ``--where NAME=LO:HI`` and ``--where NAME=MEANING``."""
    wanted: dict[str, Any] = {}
    for text in texts:
        name, equals, condition = (part.strip() for part in text.partition("="))
        low, colon, high = (part.strip() for part in condition.partition(":"))
        if not (equals and name and condition):
            remedy = ("write such as ", Setting("where", {"a2": "1.1:1.3"}))
            raise InputError(f"{text!r} is not NAME=LO:HI or NAME=MEANING", where=("where",), remedy=remedy)
        if name in wanted:
            raise InputError(f"{name} is named twice", where=("where",), remedy="write it once")
        wanted[name] = (_end(name, low), _end(name, high)) if colon else condition
    return wanted


def _end(name: str, text: str) -> float | None:
    """Return an end of a range, None for no limit."""
    try:
        return float(text) if text else None
    except ValueError:
        remedy = ("write such as ", Setting("where", {name: "1.1:1.3"}))
        raise InputError(f"{name} ends at {text!r}", where=("where",), remedy=remedy) from None


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

    fixed = numbers_by_name(at or [], "at", "DIM=VALUE", {"a4": 1.0})
    picture = to if to is not None else Path(f"{name}.png")
    plot_map(file, name, branch=branch, at=fixed, degrees=degrees, to=picture)
    typer.echo(str(picture))
