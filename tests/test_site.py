"""The site is built without a warning, and shows what a reader looks for."""

import os
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest

import fastlink as fl
from fastlink.mechanisms import NAMES

DOCS = Path(__file__).parents[1] / "docs"


pytestmark = pytest.mark.stress


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder = tmp_path_factory.mktemp("site")
    line = f"-m sphinx -q -W --keep-going -d {folder / 'trees'} {DOCS} {folder}"
    # furo asks Sphinx for what Sphinx is about to rename
    calm = {**os.environ, "PYTHONWARNINGS": ""}
    done = subprocess.run(
        [sys.executable, *line.split()], capture_output=True, text=True, check=False, env=calm
    )
    assert done.returncode == 0, done.stderr
    return folder


class Anchors(HTMLParser):
    """The anchors of a page."""

    def __init__(self, page):
        super().__init__()
        self.found = set()
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.found |= {value for name, value in attrs if name == "id"}


def test_every_page_is_reached_every_public_name_shown_and_every_generated_page_whole(site):
    pages = {str(page.relative_to(DOCS).with_suffix(".html")) for page in DOCS.rglob("*.md")}
    first = (site / "index.html").read_text()
    assert {page for page in pages if f'href="{page}' not in first} - {"index.html"} == set()
    shown, modules = Anchors((site / "api.html").read_text()).found, ("planar", "minkowski", "focal", "hart")
    public = {f"fastlink.{name}" for name in fl.__all__ if name not in (*modules, "__version__")}
    public |= {f"fastlink.{module}.{name}" for module in modules for name in getattr(fl, module).__all__}
    assert public - shown == set()
    quantities, papers = ((site / f"{name}.html").read_text() for name in ("quantities", "papers"))
    assert [name for name in NAMES if f'id="{name.replace("_", "-")}"' not in quantities] == []
    assert quantities.count("<tr") > 400
    assert papers.count("<tr") > 60
