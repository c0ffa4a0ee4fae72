"""The commands on maps: join, info, check, best, convert, plot, explore."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from fastlink.cli.app import (
    MapFile,
    Overwrite,
    QuantitiesFile,
    TrustCode,
    by_name,
    command,
    extension_of,
    numbers_of,
    text_of,
)
from fastlink.errors import InputError, Setting

__all__ = ["best", "check", "convert", "explore", "info", "join", "plot"]

CHANGED = 1


@command
def info(
    file: MapFile,
) -> None:
    """Print what a map holds, and how it was computed."""
    from fastlink.report.summary import contents

    typer.echo(contents(file))


@command
def join(
    paths: Annotated[
        list[Path],
        typer.Argument(metavar="PART...", help="The parts of a map, or their folder.", show_default=False),
    ],
    to: Annotated[
        Path, typer.Option("--to", metavar="FILE", help="The HDF5 file to write.", show_default=False)
    ],
    overwrite: Overwrite = False,
    restart: Annotated[
        bool, typer.Option("--restart", help="Throw away what an interrupted join has left in FILE.part.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print neither progress nor summary.")] = False,
) -> None:
    """Join the parts of a map that `fastlink run --part K/N` has written.

    For instance: fastlink join maps.part-*.h5 --to maps.h5
    """
    from fastlink.engine.join import join
    from fastlink.report.summary import summary

    progress = False if quiet else None
    with join(paths, to=to, overwrite=overwrite, restart=restart, progress=progress) as maps:
        if not quiet:
            typer.echo(summary(maps))


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


Minimise = Annotated[
    list[str] | None, typer.Option("--minimise", metavar="NAME", help="An objective; may be repeated.")
]
Maximise = Annotated[
    list[str] | None, typer.Option("--maximise", metavar="NAME", help="An objective; may be repeated.")
]
Where = Annotated[
    list[str] | None,
    typer.Option(
        "--where",
        metavar="NAME=LO:HI",
        help="A condition: a2=1.1:1.3, transmission_angle_min_deg=40:, status=rotates_fully; may be repeated.",
    ),
]


@command
def best(
    file: MapFile,
    *,
    minimise: Minimise = None,
    maximise: Maximise = None,
    where: Where = None,
    top: Annotated[
        int | None, typer.Option("--top", metavar="N", help="How many, by one objective; 10 if left out.")
    ] = None,
    refine: Annotated[
        bool,
        typer.Option("--refine", help="Go on from them off the grid, by derivatives, within the conditions."),
    ] = False,
    changing: Annotated[
        str | None,
        typer.Option(
            "--changing", metavar="A,B", help="Inputs that --refine may change; all swept ones if left out."
        ),
    ] = None,
    degrees: Annotated[
        bool, typer.Option("--degrees", help="Show angles in degrees, as where a condition is in degrees.")
    ] = False,
    to: Annotated[
        Path | None,
        typer.Option(
            "--to", metavar="FILE", help="Write them too: h5, nc, zarr, csv or parquet by its ending."
        ),
    ] = None,
    overwrite: Overwrite = False,
    mechanism: QuantitiesFile = None,
    trust_code: TrustCode = False,
) -> None:
    """List the best designs of a map, by several objectives the Pareto front."""
    from fastlink.io.converting.convert import check_conversion
    from fastlink.io.converting.convert import convert as convert_map
    from fastlink.io.reader import open_map
    from fastlink.report.designs import listed, refinement_columns
    from fastlink.searching.best import best as find
    from fastlink.space.degrees import angle_of

    wanted = _conditions(where or [])
    options: dict[str, Any] = {
        "minimise": minimise or (),
        "maximise": maximise or (),
        "where": wanted or None,
    }
    if changing is not None and not refine:
        raise InputError("is given without --refine", where=("changing",), remedy="add --refine")
    if mechanism is not None and not refine:
        raise InputError(
            "is given without --refine", where=("mechanism",), remedy="add --refine, or leave it out"
        )
    options["refine"] = refine if changing is None else [name.strip() for name in changing.split(",")]
    options |= {"top": top, "mechanism": extension_of(file, mechanism, trust_code)}
    with open_map(file) as maps:
        if to is not None:
            check_conversion(maps, to, overwrite)
        found = find(maps, **options).load()
    if to is not None:
        convert_map(found, to, overwrite=overwrite)
    names = [*(minimise or ()), *(maximise or ()), *wanted]
    in_degrees = degrees or any(angle_of(name) for name in wanted)
    typer.echo(listed(found, [*names, *refinement_columns(found)], degrees=in_degrees))


def _conditions(texts: list[str]) -> dict[str, Any]:
    """Return the conditions of ``--where NAME=LO:HI`` and ``--where NAME=MEANING``."""
    form = "NAME=LO:HI or NAME=MEANING"
    wanted: dict[str, Any] = by_name(texts, "where", form, {"a2": "1.1:1.3"}, text_of)
    for name, condition in wanted.items():
        low, colon, high = (part.strip() for part in condition.partition(":"))
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
def convert(
    file: MapFile,
    to: Annotated[
        Path,
        typer.Option(
            "--to", metavar="OUT", help="h5, nc, zarr, csv or parquet by its ending.", show_default=False
        ),
    ],
    select: Annotated[
        list[str] | None,
        typer.Option(
            "--select",
            metavar="NAME=VALUES",
            help="Take a2=1.1:1.2 (both ends), theta1=0.5 (nearest), theta1_deg=90 or a2=#0:10; may be repeated.",
        ),
    ] = None,
    quantities: Annotated[
        str | None, typer.Option("--quantities", metavar="A,B", help="Variables to take; all if left out.")
    ] = None,
    dtype: Annotated[
        str | None, typer.Option("--dtype", metavar="TYPE", help="float32, or float64, for results.")
    ] = None,
    *,
    compress: Annotated[
        str | None,
        typer.Option("--compress", metavar="NAME:LEVEL", help="gzip, zstd, blosc or lz4, such as zstd:3."),
    ] = None,
    overwrite: Overwrite = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print no progress.")] = False,
) -> None:
    """Convert a map to another format, compressed, in part, or with fewer digits."""
    from fastlink.io.converting.convert import convert

    conditions = by_name(select or [], "select", "NAME=VALUES", {"a2": "1.1:1.2"}, text_of)
    names = None if quantities is None else [name.strip() for name in quantities.split(",")]
    options: dict[str, Any] = {"dtype": dtype, "compress": compress, "overwrite": overwrite}
    options["progress"] = False if quiet else None
    typer.echo(str(convert(file, to, select=conditions or None, quantities=names, **options)))


@command
def plot(
    file: MapFile,
    names: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="NAME...", help="A variable, or several; `fastlink info` lists them.", show_default=False
        ),
    ] = None,
    *,
    kind: Annotated[
        str | None,
        typer.Option(
            "--kind", metavar="KIND", help="Of all rows: scatter (X Y, and a colour), corner, or cumulative."
        ),
    ] = None,
    minimise: Minimise = None,
    maximise: Maximise = None,
    where: Where = None,
    branch: Annotated[
        int | None, typer.Option("--branch", metavar="B", help="One assembly mode; all if left out.")
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option(
            "--at", metavar="DIM=VALUE", help="Fix a dimension at its nearest value; may be repeated."
        ),
    ] = None,
    panels: Annotated[
        str | None,
        typer.Option("--panels", metavar="DIM", help="A small map for each of some values of a third input."),
    ] = None,
    lines: Annotated[
        str | None, typer.Option("--lines", metavar="DIM", help="A line for each of some values of an input.")
    ] = None,
    degrees: Annotated[
        bool, typer.Option("--degrees", help="Show angles in degrees, and read those of --at so.")
    ] = False,
    to: Annotated[
        Path | None,
        typer.Option("--to", metavar="PICTURE", help="png, svg or pdf by its ending; NAME.png if left out."),
    ] = None,
) -> None:
    """Draw a map: one variable over one or two inputs; or rows by several variables; or a Pareto front.

    For instance: fastlink plot maps.h5 omega4_max --at a4=1.0

    Of all rows: fastlink plot maps.h5 omega4_max transmission_angle_min --where status=rotates_fully

    A front: fastlink plot maps.h5 --minimise omega4_max --maximise transmission_angle_min
    """
    from fastlink.plot.plot_designs import plot_designs, plot_front
    from fastlink.plot.plot_map import plot_map

    given = names or []
    options = [one for one in given if one.find("=") > 0]
    for dim, value in by_name(options, "names", "NAME", {}, str, (plot, plot_map)).items():
        at_it = ("write ", Setting("at", {dim: value}))
        raise InputError(f"{dim}={value} is no variable", where=("names",), remedy=at_it)
    of_front, of_rows = bool(minimise or maximise), kind is not None or len(given) > 1 or bool(where)
    if of_front and (given or kind is not None):
        remedy = "leave out the names and --kind, or --minimise and --maximise"
        raise InputError("is given beside objectives", where=("names" if given else "kind",), remedy=remedy)
    if (of_front or of_rows) and (at or panels or lines):
        option = "at" if at else "panels" if panels else "lines"
        raise InputError("is of a map of one variable", where=(option,), remedy="choose rows by --where")
    if not (of_front or given):
        raise InputError("is missing", where=("names",), remedy="write a variable, such as omega4_max")
    picture = to if to is not None else Path(f"{'-'.join(given) or 'front'}.png")
    own: dict[str, Any] = {"branch": branch, "degrees": degrees, "to": picture}
    conditions = _conditions(where or []) or None
    if of_front:
        plot_front(file, minimise=minimise or (), maximise=maximise or (), where=conditions, **own)
    elif of_rows:
        plot_designs(file, given, kind=kind, where=conditions, **own)
    else:
        fixed = by_name(at or [], "at", "DIM=VALUE", {"a4": 1.0}, numbers_of)
        plot_map(file, given[0], at=fixed, panels=panels, lines=lines, **own)
    typer.echo(str(picture))


@command
def explore(
    file: MapFile,
    to: Annotated[
        Path | None,
        typer.Option(
            "--to", metavar="PAGE.html", help="Write one page that needs no Python, and serve nothing."
        ),
    ] = None,
    *,
    port: Annotated[
        int, typer.Option("--port", metavar="N", help="Where the page is served; 0 for a free port.")
    ] = 0,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open the page in the browser.", show_default=False)
    ] = True,
) -> None:
    """Show a map in the browser, with the mechanism of each design moving, until Ctrl-C.

    The page is served to this machine alone, to whoever has its address with the random token in it.
    """
    import contextlib
    import threading

    from fastlink.exploring.explore import explore as serve

    with serve(file, to=to, port=port, browser=browser) as page:
        if to is not None:
            typer.echo(str(to))
            return
        typer.echo(f"{page.url}\nCtrl-C ends it")
        with contextlib.suppress(KeyboardInterrupt):
            threading.Event().wait()
