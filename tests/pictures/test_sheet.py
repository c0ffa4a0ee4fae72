"""docs/drawing.md: its commands write what they say, and its pictures are there and small."""

import re
import shlex
from pathlib import Path

import pytest
from tests.support.commands import code_blocks, run_command

from fastlink.mechanisms import NAMES, catalogue
from fastlink.pictures.draw import picture_of

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "drawing.md").read_text()
COMMANDS = "".join(code_blocks(PAGE, "sh")).splitlines()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("page")


@pytest.mark.parametrize("line", COMMANDS)
def test_the_commands_of_the_page(line, folder, monkeypatch):
    monkeypatch.chdir(folder)
    arguments, done = run_command(line)
    if ">" in line:
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
