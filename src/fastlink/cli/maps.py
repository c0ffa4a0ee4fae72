"""The commands on maps: info, plot."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fastlink.cli.app import MapFile, command
from fastlink.errors import InputError, Setting

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["info", "plot"]


@command
def info(
    file: MapFile,
) -> None:
    """Print what a map holds, and how it was computed."""
    from fastlink.report.summary import contents

    with _opened(file) as maps:
        typer.echo(contents(maps))


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
    from fastlink.maps import open as open_map

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
