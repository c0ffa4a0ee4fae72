"""docs/drawing.md: its commands write what they say, and its pictures are there and small."""

import re
import shlex
from pathlib import Path

import pytest
from typer.testing import CliRunner

from fastlink.cli import app
from fastlink.drawing.request import picture_of
from fastlink.mechanisms import NAMES, catalogue

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "drawing.md").read_text()
COMMANDS = "".join(re.findall(r"^```sh\n(.*?)^```", PAGE, flags=re.MULTILINE | re.DOTALL)).splitlines()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("page")


@pytest.mark.parametrize("line", COMMANDS)
def test_the_commands_of_the_page(line, folder, monkeypatch):
    monkeypatch.chdir(folder)
    (program, *arguments), _, redirected = shlex.split(line.partition(">")[0]), *line.partition(" > ")[1:]
    assert program == "fastlink"
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.output
    if redirected:
        Path(redirected).write_text(done.output)
        return
    (place,) = [arguments[arguments.index(key) + 1] for key in ("--to", "--animate") if key in arguments]
    assert done.output.strip() == place
    assert Path(place).stat().st_size > 1000


def test_the_pictures_of_the_page_are_small():
    names = re.findall(r"images/(\w+\.png)", PAGE)
    assert names
    assert all((DOCS / "images" / name).stat().st_size < 60_000 for name in names)
    written = {name for line in COMMANDS for name in shlex.split(line) if name.endswith(".png")}
    assert set(names) <= written


@pytest.mark.parametrize("mechanism", NAMES)
def test_the_page_names_every_word(mechanism):
    table = "".join(line for line in PAGE.splitlines() if line.startswith("|"))
    for word in picture_of(mechanism, catalogue(mechanism)).words:
        assert f"`{word}`" in table
