"""docs/gallery.md, docs/drawing.md: each picture is there, small, and made by a command that runs."""

import importlib.util
import re
import shlex
from pathlib import Path

import pytest
from tests.support.commands import code_blocks, run_command

from fastlink.mechanisms import NAMES, catalogue
from fastlink.pictures.draw import picture_of

DOCS = Path(__file__).parents[2] / "docs"
SPEC = importlib.util.spec_from_file_location("pages", DOCS / "images" / "pages.py")
pages = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(pages)
GALLERY, DRAWING = ((DOCS / name).read_text(encoding="utf-8") for name in ("gallery.md", "drawing.md"))
BLOCKS = [block for block in pages.blocks_of(GALLERY) if block[0][1] == "run"]
SHOWN = pages.shown_on(GALLERY)
LINES = "".join(code_blocks(DRAWING, "sh")).splitlines()
FEW = 5


def few(text):
    """Return a study of few designs."""
    counts = r"(space = \[[^,\]]*,[^,\]]*,\s*)(\d+)"
    text = re.sub(counts, lambda found: found[1] + str(min(FEW, int(found[2]))), text)
    text = re.sub(r"^\[output\]$", "[output]\nverify = 0", text, flags=re.MULTILINE)
    return re.sub(r"^n = \d+$", "n = 16", text, flags=re.MULTILINE)


def test_each_picture_is_there_and_small_and_has_one_command():
    commands = [arguments for block in pages.blocks_of(GALLERY) for arguments in block]
    made = [pages.output_of(arguments) for arguments in commands if arguments[1] != "run"]
    assert sorted(made) == sorted(SHOWN)
    assert {path.name for path in (DOCS / "images" / "gallery").iterdir()} == set(SHOWN)
    sizes = [(DOCS / place).stat().st_size for place in SHOWN.values()]
    assert min(sizes) > 1000
    assert sum(sizes) < 3_000_000
    drawn = re.findall(r"images/(\w+\.png)", DRAWING)
    assert all((DOCS / "images" / name).stat().st_size < 60_000 for name in drawn)
    assert set() < set(drawn) <= {name for line in LINES for name in shlex.split(line)}


def test_each_entry_says_what_to_see_and_every_figure_of_the_papers_has_one():
    for entry in re.split(r"^### ", GALLERY, flags=re.MULTILINE)[1:]:
        words, _, picture = entry.partition("\n")[2].partition("```sh")
        assert words.strip().endswith("."), entry
        assert "](images/" in picture, entry
    for paper, first, last in (("Hayes", 1, 4), ("Heged", 9, 24), ("Wunderlich", 1, 7)):
        part = re.search(rf"^## {paper}.*?(?=^## )", GALLERY, flags=re.MULTILINE | re.DOTALL)[0]
        named = set()
        for low, high in re.findall(r"^### Figs?\. (\d+)(?: (?:to|and) (\d+))?", part, flags=re.MULTILINE):
            named |= set(range(int(low), int(high or low) + 1))
        assert named == set(range(first, last + 1)), paper


@pytest.mark.parametrize("mechanism", NAMES)
def test_the_page_names_every_word(mechanism):
    table = "".join(line for line in DRAWING.splitlines() if line.startswith("|"))
    assert all(f"`{word}`" in table for word in picture_of(mechanism, catalogue(mechanism)).words)


@pytest.mark.sample(2)
@pytest.mark.parametrize("line", [line for line in LINES if ">" not in line])
def test_the_commands_of_the_page(line, folder):
    for study in (line for line in LINES if ">" in line):
        run_command(study)
    arguments, done = run_command(line)
    (place,) = [arguments[arguments.index(key) + 1] for key in ("--to", "--animate") if key in arguments]
    assert done.output.strip() == place
    assert Path(place).stat().st_size > 1000


@pytest.mark.parametrize(
    "block", [BLOCKS[0], *(pytest.param(one, marks=pytest.mark.stress) for one in BLOCKS[1:])]
)
def test_the_maps_of_the_gallery_in_short(block, folder):
    """Each study runs, of few designs, and the last picture of its map is drawn; what is refused stops the pages."""
    (folder / "data" / "studies").mkdir(parents=True)
    for path in (DOCS.parent / "data" / "studies").iterdir():
        (folder / "data" / "studies" / path.name).write_text(
            few(path.read_text(encoding="utf-8")), encoding="utf-8"
        )
    run, *_, last = block
    for arguments in (run, last):
        pages.run(arguments)
    assert (folder / pages.output_of(last)).stat().st_size > 1000
    with pytest.raises(RuntimeError, match="no_such"):
        pages.run(["fastlink", "draw", "no_such_mechanism", "--to", "a.png"])


@pytest.mark.stress
def test_the_pictures_of_the_gallery(folder):
    (folder / "data").symlink_to(DOCS.parent / "data")
    made = {picture.name for _, picture in pages.make(GALLERY) if picture.stat().st_size > 1000}
    assert made == set(SHOWN)
