"""Check a picture's name before anything is drawn, and write it."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fastlink.errors import InputError, check_path
from fastlink.io.output import write_whole
from fastlink.io.output_path import check_writable

if TYPE_CHECKING:
    from matplotlib.figure import Figure


#: Endings of pictures: those that matplotlib writes in full quality.
KINDS = ("png", "svg", "pdf")


def check_picture(
    to: str | Path, where: str, *, kinds: Sequence[str] = KINDS, example: str = "map.png"
) -> Path:
    """Return the path of a picture to write; to be called before anything is drawn."""
    path = check_path((where,), to, example)
    kind = path.suffix.removeprefix(".")
    if kind.lower() not in kinds:
        ending = f"ends in {kind!r}" if kind else "has no ending"
        remedy = f"write one of {', '.join(kinds)}"
        raise InputError(f"{path}: the name of the picture {ending}", where=(where,), remedy=remedy)
    check_writable(path, where, example)
    return path


def save(figure: Figure, path: Path, where: str) -> None:
    """Write a picture; an existing one is replaced."""
    picture = io.BytesIO()
    figure.savefig(picture, format=path.suffix.removeprefix("."))
    write_whole(path, picture.getvalue(), where)
