"""docs/gallery.md: each picture is there, small, and made by a command that runs."""

import importlib.util
import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
SPEC = importlib.util.spec_from_file_location("pages", DOCS / "images" / "pages.py")
pages = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(pages)
PAGE = (DOCS / "gallery.md").read_text(encoding="utf-8")
COMMANDS = [arguments for block in pages.blocks_of(PAGE) for arguments in block]
SHOWN = pages.shown_on(PAGE)
FEW = 5
MOST_BYTES = 3_000_000


def few(text):
    """Return a study of few designs."""
    text = re.sub(
        r"(space = \[[^,\]]*,[^,\]]*,\s*)(\d+)", lambda found: found[1] + str(min(FEW, int(found[2]))), text
    )
    text = re.sub(r"^\[output\]$", "[output]\nverify = 0", text, flags=re.MULTILINE)
    return re.sub(r"^n = \d+$", "n = 16", text, flags=re.MULTILINE)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Return a folder where data/ has the studies, of few designs."""
    studies = tmp_path / "data" / "studies"
    studies.mkdir(parents=True)
    for path in (DOCS.parent / "data" / "studies").iterdir():
        (studies / path.name).write_text(few(path.read_text(encoding="utf-8")), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_each_picture_is_there_and_small_and_has_one_command():
    made = [pages.output_of(arguments) for arguments in COMMANDS if arguments[1] != "run"]
    assert sorted(made) == sorted(SHOWN)
    files = [DOCS / place for place in SHOWN.values()]
    assert all(path.stat().st_size > 1000 for path in files)
    assert sum(path.stat().st_size for path in files) < MOST_BYTES
    kept = {path.name for path in (DOCS / "images" / "gallery").iterdir()}
    assert kept == set(SHOWN)


def test_each_entry_says_what_to_see():
    for entry in re.split(r"^### ", PAGE, flags=re.MULTILINE)[1:]:
        title, _, rest = entry.partition("\n")
        words, _, shown = rest.partition("```sh")
        assert words.strip().endswith("."), title
        assert "](images/" in shown, title


def test_every_figure_of_the_papers_has_an_entry():
    for figures in (("Hayes", 1, 4), ("Heged", 9, 24), ("Wunderlich", 1, 7)):
        paper, first, last = figures
        part = re.search(rf"^## {paper}.*?(?=^## )", PAGE, flags=re.MULTILINE | re.DOTALL)[0]
        named = set()
        for low, high in re.findall(r"^### Figs?\. (\d+)(?: (?:to|and) (\d+))?", part, flags=re.MULTILINE):
            named |= set(range(int(low), int(high or low) + 1))
        assert named == set(range(first, last + 1)), paper


BLOCKS = [block for block in pages.blocks_of(PAGE) if block[0][1] == "run"]


@pytest.mark.parametrize(
    "block", [BLOCKS[0], *(pytest.param(b, marks=pytest.mark.stress) for b in BLOCKS[1:])]
)
def test_the_maps_of_the_gallery_in_short(block, folder):
    """Each study runs, of few designs, and the last picture of its map is drawn."""
    run, *_, last = block
    for arguments in (run, last):
        pages.run(arguments)
    assert (folder / pages.output_of(last)).stat().st_size > 1000


@pytest.mark.stress
def test_the_pictures_of_the_gallery(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "data").symlink_to(DOCS.parent / "data")
    made = {picture.name for _, picture in pages.make(PAGE) if picture.stat().st_size > 1000}
    assert made == set(SHOWN)


def test_a_command_that_is_refused_stops_the_pages(folder):
    with pytest.raises(RuntimeError, match="no_such"):
        pages.run(["fastlink", "draw", "no_such_mechanism", "--to", "a.png"])
