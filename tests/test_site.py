"""The site is built without a warning, and shows what a reader looks for."""

from __future__ import annotations

import os
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest

import fastlink as fl

DOCS = Path(__file__).parents[1] / "docs"


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


def test_every_page_is_reached_from_the_first(site):
    pages = {str(page.relative_to(DOCS).with_suffix(".html")) for page in DOCS.rglob("*.md")}
    first = (site / "index.html").read_text()
    assert {page for page in pages if f'href="{page}' not in first} - {"index.html"} == set()


@pytest.mark.sample(2)
@pytest.mark.parametrize("name", ["", "planar", "minkowski", "focal", "hart"])
def test_the_api_shows_every_public_name(site, name):
    package = getattr(fl, name) if name else fl
    shown = Anchors((site / "api.html").read_text()).found
    path = f"fastlink.{name}." if name else "fastlink."
    modules = {"planar", "minkowski", "focal", "hart", "__version__"}
    assert {path + public for public in package.__all__ if public not in modules} - shown == set()
