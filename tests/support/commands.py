"""Commands that pages show, run in this process."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

from click.testing import Result
from typer.testing import CliRunner

from fastlink.app.cli import app


def code_blocks(text: str, language: str) -> list[str]:
    """Return the blocks of a page that are in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


def run_command(line: str) -> tuple[list[str], Result]:
    """Run a command line in the current folder, its output into a file if it says so; return arguments and result."""
    program, *arguments = shlex.split(line, comments=True)
    assert program == "fastlink"
    target = arguments[arguments.index(">") + 1 :] if ">" in arguments else []
    arguments = arguments[: arguments.index(">")] if target else arguments
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, f"{line}: {done.output}"
    for name in target:
        Path(name).write_text(done.stdout)
    return arguments, done


def run_commands(lines: str) -> None:
    """Run command lines one after the other."""
    for line in lines.strip().splitlines():
        run_command(line)
