"""The pages are true: their examples run, their links lead somewhere."""

import doctest
import re
from pathlib import Path

import pytest

from fastlink.mechanisms import NAMES, catalogue
from tests.support.commands import code_blocks, run_commands

ROOT = Path(__file__).parents[1]
#: Its sections are run where their libraries are installed.
OTHERS = ROOT / "docs" / "how_to" / "search_with_other_libraries.md"
#: Their examples take some seconds each: maps of a million values, mechanisms and quantities of one's own, searches.
LONG = ("start.md", "maps.md", "mechanisms.md", "own_mechanisms.md", "own_quantities.md", "synthesis.md")
LONG += ("performance.md",)
DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]


@pytest.mark.sample(14)
@pytest.mark.parametrize(
    "document",
    [pytest.param(d, marks=[pytest.mark.stress] * (d.name in LONG)) for d in DOCUMENTS if d != OTHERS],
    ids=lambda path: path.name,
)
def test_the_examples_of_the_documents(document, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for sheet in code_blocks(document.read_text(), "facts"):
        if named := re.match(r"# (\w+\.facts)", sheet):
            Path(named[1]).write_text(sheet)
    result = doctest.testfile(str(document), module_relative=False, encoding="utf-8")
    assert result.failed == 0
    if (
        document.name in ("start.md", "design_search.md", "performance.md")
        or document.parent.name == "how_to"
    ):
        run_commands("".join(code_blocks(document.read_text(), "sh")))


@pytest.mark.parametrize("library", ["pymoo", "emcee", "JAX"])
def test_examples_with_other_libraries(library):
    pytest.importorskip(library.lower())
    (section,) = [
        part for part in OTHERS.read_text().split("\n## ") if part.splitlines()[0].endswith(f"({library})")
    ]
    example = doctest.DocTestParser().get_doctest(section, {}, library, str(OTHERS), 0)
    assert len(example.examples) >= 10
    assert doctest.DocTestRunner().run(example).failed == 0


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_examples_are_fenced(document):
    """Elsewhere a page shows `>>>` as nested quotations."""
    text = re.sub(r"^```.*?^```$", "", document.read_text(), flags=re.MULTILINE | re.DOTALL)
    assert not re.findall(r"^>>> .*", text, flags=re.MULTILINE)


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_links_lead_somewhere(document):
    for target in re.findall(r"\]\(([^)#]+)", document.read_text()):
        if not target.startswith("http"):
            assert (document.parent / target).exists(), target


def anchor(heading):
    """Return what a link to a heading ends in."""
    return re.sub(r"[^a-z0-9 -]", "", heading.lower()).replace(" ", "-")


@pytest.mark.parametrize("mechanism", NAMES)
def test_every_section_that_a_source_names_exists(mechanism):
    for fact in catalogue(mechanism).facts.values():
        for name, section in re.findall(r"docs/(\w+\.md)#([\w-]+)", fact.source):
            headings = re.findall(r"^## (.*)$", (ROOT / "docs" / name).read_text(), flags=re.MULTILINE)
            assert section in map(anchor, headings), f"{fact.name}: {fact.source}"
