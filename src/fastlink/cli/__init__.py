"""The command line: one function for each command, in the module of what the command is about.

Everything heavy is imported inside the commands, so that help comes at once.
"""

from __future__ import annotations

import io
import sys

from fastlink.cli import drawing, maps, mechanisms, studies
from fastlink.cli.app import app

__all__ = ["app", "main"]

# in the order of the help: from a first look at a mechanism to its maps
for function in (
    mechanisms.mechanisms,
    mechanisms.new,
    mechanisms.quantities,
    drawing.draw,
    studies.explain,
    studies.run,
    maps.join,
    maps.info,
    maps.check,
    maps.best,
    studies.tolerance,
    maps.convert,
    maps.plot,
    maps.explore,
    studies.accuracy,
    mechanisms.cache,
):
    app.command()(function)


def main() -> None:
    """Run the command line of this process."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and stream.errors == "strict":
            stream.reconfigure(errors="backslashreplace")  # names of files may hold what is no letter
    app(prog_name="fastlink")
