"""The site, by Sphinx: ``python -m sphinx -W docs site`` writes it into the folder ``site``."""

import re
import sys
from importlib.metadata import version as version_of
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from pygments.lexers.special import TextLexer
from tests.support import papers

from fastlink.app import report

project = "fastlink"
author = "the fastlink developers"
release = version_of("fastlink-linkages")
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
html_theme = "furo"
html_title = f"fastlink {release}"
html_show_copyright = False
html_static_path = ["_static"]
html_css_files = ["site.css"]
# as GitHub does, by which the documents link to each other's sections
myst_heading_anchors = 4
autodoc_typehints = "none"  # the docstrings say them in words
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_ivar = True  # a field of a dataclass is one entry, not two


def plain(app, what, name, thing, options, lines):
    """Keep |x| and names such as lambda_, which mean something else to docutils, as the docstrings have them."""
    example = False
    for number, line in enumerate(lines):
        example = line.lstrip().startswith(">>>") or (example and bool(line.strip()))
        if not example:
            pieces = re.split(r"(``.*?``)", line)
            pieces[::2] = [re.sub(r"\||(?<=\w)_(?!\w)", r"\\\g<0>", piece) for piece in pieces[::2]]
            lines[number] = "".join(pieces)


#: Pages that are written, or go on, from catalogues and tables.
GENERATED = {"quantities": lambda _: report.document(), "papers": lambda text: text + papers.tables()}


def written(app, name, text):
    """Put the text of a generated page in place of what was read."""
    if name in GENERATED:
        text[0] = GENERATED[name](text[0])


def setup(app):
    """Let Sphinx call `plain` before it reads a docstring, and `written` as it reads a page."""
    app.add_lexer("facts", TextLexer)
    app.connect("autodoc-process-docstring", plain, priority=900)
    app.connect("source-read", written)
    app.connect("env-get-outdated", lambda *_: list(GENERATED))
