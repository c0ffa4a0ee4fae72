"""The pictures of a page, by its own commands: ``python -m docs.images.pages gallery``, ``drawing`` or ``start``.

The commands of the page run from the first to the last, in a folder where data/ is that of the repository; each
picture that the page shows becomes small and stands in docs/images. A part of a name, as in ``gallery hayes``, makes
only the pictures that have it in their names.
"""

from __future__ import annotations

import io
import re
import shlex
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import chdir, redirect_stdout
from pathlib import Path

from PIL import Image
from tests.support.commands import code_blocks

from fastlink.app.cli import app

DOCS = Path(__file__).resolve().parents[1]
DATA = DOCS.parent / "data"
WIDTH, COLOURS = 880, 256
OUTPUTS = ("--to", "--animate")


def blocks_of(page: str) -> list[list[list[str]]]:
    """Return the blocks of a page, each a list of commands, each a list of arguments."""
    blocks = code_blocks(page, "sh")
    return [[shlex.split(line, comments=True) for line in block.splitlines() if line] for block in blocks]


def shown_on(page: str) -> dict[str, str]:
    """Return the place below docs/ of each picture that a page shows, by its name."""
    places = re.findall(r"\]\((images/[\w/]+\.(?:png|gif))\)", page)
    return {Path(place).name: place for place in places}


def output_of(arguments: list[str]) -> str:
    """Return the picture that a command writes, or nothing."""
    given = [arguments[arguments.index(key) + 1] for key in OUTPUTS if key in arguments]
    return given[0] if given else ""


def run(arguments: list[str]) -> None:
    """Run a command here, as a shell would."""
    program, *rest = arguments
    place = rest.index(">") if ">" in rest else len(rest)
    if program != "fastlink":
        return  # what the pictures do not need
    told = io.StringIO()
    with redirect_stdout(told):
        done = app(rest[:place], standalone_mode=False)
    for name in rest[place + 1 :]:
        Path(name).write_text(told.getvalue(), encoding="utf-8")
    if done:
        raise RuntimeError(shlex.join(arguments))


def make(page: str, part: str = "") -> Iterator[tuple[str, Path]]:
    """Run the commands of a page in the current folder; yield each picture that it shows, and its file."""
    shown = {name: place for name, place in shown_on(page).items() if part in name}
    for block in blocks_of(page):
        if shown.keys() & set(map(output_of, block)):
            for arguments in block:
                name = output_of(arguments)
                if arguments[1] in ("new", "run") or name in shown:
                    run(arguments)
                if name in shown:
                    yield shown[name], Path(name)


def shrink(source: Path, target: Path) -> None:
    """Write a picture with few colours, not wider than a page."""
    if source.suffix == ".gif":
        shutil.copyfile(source, target)
        return
    with Image.open(source) as picture:
        small = picture.convert("RGB")
        small.thumbnail((WIDTH, 10 * WIDTH), Image.Resampling.LANCZOS)
        few = small.quantize(COLOURS, method=Image.Quantize.FASTOCTREE)
        small = small.quantize(COLOURS, palette=few, dither=Image.Dither.NONE)
        small.save(target, optimize=True)


def main(name: str, part: str = "") -> None:
    """Make the pictures of a page."""
    page = (DOCS / f"{name}.md").read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        Path("data").symlink_to(DATA)
        for place, picture in make(page, part):
            shrink(picture, DOCS / place)
            print(place, (DOCS / place).stat().st_size)


if __name__ == "__main__":
    main(*sys.argv[1:])
