"""The pages are true: their examples run, their links lead somewhere."""

import doctest
import importlib
import inspect
import pkgutil
import re
import shutil
import subprocess
import sys
from pathlib import Path

import nbformat
import numpy
import pytest
from nbclient import NotebookClient

import fastlink
import fastlink as fl
from fastlink.mechanisms import NAMES, catalogue
from tests.support import papers
from tests.support.commands import code_blocks, run_command, run_commands

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
def test_the_examples_of_the_documents(document, folder):
    for sheet in code_blocks(document.read_text(), "facts"):
        if named := re.match(r"# (\w+\.facts)", sheet):
            Path(named[1]).write_text(sheet)
    result = doctest.testfile(str(document), module_relative=False, encoding="utf-8")
    assert result.failed == 0
    with_commands = ("start.md", "design_search.md", "performance.md")
    if document.name in with_commands or document.parent.name == "how_to":
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


# == README, CONTRIBUTING and the notebook are true: what they show runs =====================================

README = (ROOT / "README.md").read_text()


def test_the_python_example_of_the_readme(folder, capsys):
    (example,) = code_blocks(README, "python")
    (folder / "maps.h5").write_text("of an earlier run")
    exec(compile(example, "README.md", "exec"), {})
    assert re.fullmatch(r"a2 = 1\.\d{3} m, a3 = \d\.\d{3} m\n", capsys.readouterr().out)
    fl.open(folder / "maps.h5").close()


@pytest.mark.parametrize("count", [9, pytest.param(101, marks=pytest.mark.stress)])
def test_the_main_job_of_the_readme(folder, count):
    shutil.copytree(ROOT / "data", "data")
    study = folder / "data" / "studies" / "crank_rocker_map.toml"
    assert study.read_text().count(", 101]}") == 3
    study.write_text(study.read_text().replace(", 101]}", f", {count}]}}"))
    (first, *_) = code_blocks(README, "sh")
    install, run = first.strip().split(" && ")
    assert install == "python -m pip install ."
    # of designs with 50 digits, which take as long as all the rest
    fewer = "" if count == 101 else " --verify 2"
    assert f"{count**3:,}" in run_command(run + fewer)[1].stdout
    plot = re.search(r"`(fastlink plot [^`]*)`", README)
    assert plot is not None
    run_command(plot.group(1))
    assert list(folder.glob("*.png"))


@pytest.mark.stress
def test_the_command_lines_of_the_readme(folder):
    (lines,) = [block for block in code_blocks(README, "sh") if "fastlink new" in block]
    run_commands(lines)
    assert (folder / "study.h5").exists()


def test_ci_calls_the_readmes_test_command():
    (test_command,) = {block.strip() for block in code_blocks(README, "sh") if "pytest" in block}
    assert test_command in (ROOT / ".ci" / "run").read_text().splitlines()


def test_the_quantity_and_the_reduction_of_contributing_work(tmp_path):
    page = (ROOT / "CONTRIBUTING.md").read_text()
    (quantity,), (reduction,) = code_blocks(page, "facts"), code_blocks(page, "python")
    script = tmp_path / "contributing_example.py"
    script.write_text(
        f"import sys; sys.path.insert(0, {str(ROOT)!r})\n"
        "from fastlink.facts.sheet import read_sheet\nfrom fastlink.mechanisms.planar_4r import planar_4r\n"
        f"read_sheet({quantity!r}, 'example', planar_4r)\n"
        f"from fastlink.plan.query import Reduction, register\n{reduction}\nimport fastlink as fl\n"
        "design = fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=25.0)\n"
        "asked = ['output_power', 'alpha4', 'omega4', 'omega4_range', 'omega4_max', 'omega4_min']\n"
        "options = dict(links=fl.round_bar(7750.0, 0.01), theta1=8, extrema='sampled', verify=1)\n"
        "result = fl.sweep('planar_4r', design, asked, **options)\n"
        "spin = result.output_power / result.alpha4 / result.omega4\n"
        # 0.62 pi kg of 0.8 m about its end; each side took a few roundings
        "assert (abs(spin / (0.62 * 3.141592653589793 * (0.64 / 3 + 0.25e-4)) - 1) < 1e-14).all()\n"
        "assert (result.omega4_range == result.omega4_max - result.omega4_min).all()\n"
        # one subtraction
        "assert result.omega4_range.attrs['error_max_roundings'] <= 1\n"
    )
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.stress
def test_the_notebook_runs(tmp_path):
    notebook = nbformat.read(ROOT / "docs" / "how_to" / "first_map.ipynb", as_version=4)
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    shown = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert sum("image/png" in output.get("data", {}) for output in shown) == 2
    assert not [output for output in shown if "Warning" in output.get("text", "")]
    assert not any(
        cell.get("outputs") for cell in nbformat.read(ROOT / "docs/how_to/first_map.ipynb", 4).cells
    )


# == Docstrings are true: their examples run, with fastlink as fl and numpy as np ============================


def modules():
    found = pkgutil.walk_packages(fastlink.__path__, "fastlink.")
    return sorted(module.name for module in found if not module.name.endswith(".__main__"))  # which would run


class Finder(doctest.DocTestFinder):
    """Finds the examples of guarded functions too: those of the module in which a function is written."""

    def _from_module(self, module, thing):
        return super()._from_module(module, inspect.unwrap(thing))


def examples_of(name):
    known = {"fl": fastlink, "np": numpy}
    found = Finder().find(importlib.import_module(name), name, extraglobs=known)
    return [one for one in found if one.examples]


@pytest.mark.parametrize("name", modules())
def test_docstring_examples(name, folder):
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    for example in examples_of(name):
        runner.run(example)
    assert runner.summarize(verbose=False).failed == 0


@pytest.mark.parametrize("name", ["", "planar", "minkowski", "focal", "hart"])
def test_completion_shows_public_names_alone(name):
    package = getattr(fastlink, name) if name else fastlink
    assert dir(package) == sorted(package.__all__)


def test_public_functions_have_examples_and_guarded_ones_are_found():
    for name in fastlink.__all__:
        thing = getattr(fastlink, name)
        if callable(thing) and not isinstance(thing, type):
            assert ">>>" in (thing.__doc__ or ""), name
    assert "fastlink.engine.sweep.sweep" in [found.name for found in examples_of("fastlink.engine.sweep")]


# == Each line of the three papers is computed, by a name that is there and held by a test that is there =====

PAPERS = {paper["authors"]: paper for paper in papers.papers()}
every_paper = pytest.mark.parametrize("paper", PAPERS.values(), ids=PAPERS)


@every_paper
def test_what_a_row_names_is_there(paper):
    problems = [papers.problem(name) for row in paper["row"] for name in row["names"]]
    problems += [papers.test_problem(test) for row in paper["row"] for test in row["tests"]]
    assert not [problem for problem in problems if problem]


@every_paper
def test_a_row_has_a_name_and_a_test_or_says_why_not(paper):
    unfounded = [row for row in paper["row"] if not (row["names"] and row["tests"]) and not row.get("note")]
    assert not unfounded


@every_paper
def test_every_numbered_item_has_a_row(paper):
    named = {place for row in paper["row"] for place in row["place"]}
    assert not [item for item in papers.numbered(paper) if item not in named]


@pytest.mark.parametrize(
    "name", ["planar_4r: omega5", "fl.planar.curve_ares", "data/studies/none.toml", "spatial_4r: omega4"]
)
def test_a_name_that_is_not_there_is_noticed(name):
    assert papers.problem(name)


@pytest.mark.parametrize("test", ["tests/test_docs.py::test_nothing", "tests/test_none.py::test_nothing"])
def test_a_test_that_is_not_there_is_noticed(test):
    assert papers.test_problem(test)
