"""The command on pictures of mechanisms: draw."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from fastlink.cli.app import TrustCode, by_name, command, numbers_of

__all__ = ["draw"]

EXAMPLE = {"a1": 0.4}


@command
def draw(
    mechanism: Annotated[
        str,
        typer.Argument(
            metavar="MECHANISM|STUDY.toml|FILE", help="Such as planar_4r; a study; a map.", show_default=False
        ),
    ],
    inputs: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="NAME=VALUE",
            help="Inputs, and the input position, such as theta1_deg=60; theta1_deg=0,60,120 for three side by side.",
            show_default=False,
        ),
    ] = None,
    design: Annotated[
        int | None, typer.Option("--design", metavar="N", help="The design of a study or a map, from 0.")
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option("--at", metavar="DIM=VALUE", help="The design at the nearest value; may be repeated."),
    ] = None,
    branch: Annotated[
        int | None, typer.Option("--branch", metavar="B", help="One assembly mode; all if left out.")
    ] = None,
    input: Annotated[
        str | None, typer.Option("--input", metavar="INPUT", help="The driven input, such as sigma.")
    ] = None,
    *,
    strip: Annotated[
        int | None, typer.Option("--strip", metavar="N", help="N positions over the motion, side by side.")
    ] = None,
    curves: Annotated[
        list[str] | None,
        typer.Option("--curves", metavar="NAME", help="A quantity over the input, beside; may be repeated."),
    ] = None,
    show: Annotated[
        list[str] | None,
        typer.Option(
            "--show",
            metavar="WORD",
            help="Instead of the usual: path, circles, comb, forces, torques, all; may be repeated.",
        ),
    ] = None,
    degrees: Annotated[bool, typer.Option("--degrees", help="Show angles in degrees.")] = False,
    to: Annotated[
        Path | None,
        typer.Option("--to", metavar="PICTURE", help="png, svg or pdf by its ending; NAME.png if left out."),
    ] = None,
    animate: Annotated[
        Path | None,
        typer.Option("--animate", metavar="FILM", help="The motion: gif, html or mp4 by its ending."),
    ] = None,
    frames: Annotated[int, typer.Option("--frames", metavar="N", help="Pictures of a film.")] = 60,
    trust_code: TrustCode = False,
) -> None:
    """Draw a mechanism as it stands at an input position, to scale.

    For instance: fastlink draw planar_4r a1=0.4 a2=1.1 a3=0.8 a4=1.0 theta1_deg=60
    """
    from fastlink.drawing.draw import draw as draw_mechanism
    from fastlink.space.links import taken_links

    given: dict[str, Any] = by_name(
        inputs or [], "inputs", "NAME=VALUE", EXAMPLE, numbers_of, (draw, draw_mechanism)
    )
    fixed = by_name(at, "at", "DIM=VALUE", EXAMPLE, numbers_of) if at else None
    picture = to if to is not None or animate is not None else Path(f"{Path(mechanism).stem}.png")
    own: dict[str, Any] = {"at": fixed, "branch": branch, "input": input, "strip": strip, "show": show}
    own |= {"curves": curves or (), "degrees": degrees, "to": picture, "links": taken_links(given)}
    own |= {"animate": animate, "frames": frames, "trust_code": trust_code}
    draw_mechanism(mechanism, design, **own, **given)
    for path in filter(None, (picture, animate)):
        typer.echo(str(path))
