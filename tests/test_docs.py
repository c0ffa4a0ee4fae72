"""README, docs and docstrings are true: their examples run."""

from __future__ import annotations

import doctest
import importlib
import inspect
import os
import pkgutil
import re
import shutil
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

import fastlink
from fastlink.mechanisms import NAMES, catalogue
from tests.support.commands import code_blocks, run_command

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()
#: Its sections are run where their libraries are installed.
OTHERS = ROOT / "docs" / "how_to" / "search_with_other_libraries.md"
DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]


def modules():
    found = pkgutil.walk_packages(fastlink.__path__, "fastlink.")
    return sorted(module.name for module in found if not module.name.endswith(".__main__"))  # which would run


class Finder(doctest.DocTestFinder):
    """Finds the examples of guarded functions too: those of the module in which a function is written."""

    def _from_module(self, module, thing):
        return super()._from_module(module, inspect.unwrap(thing))


def examples_of(name):
    return [found for found in Finder().find(importlib.import_module(name), name) if found.examples]


@pytest.mark.parametrize("name", modules())
def test_docstring_examples(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    for example in examples_of(name):
        runner.run(example)
    assert runner.summarize(verbose=False).failed == 0


def test_examples_of_guarded_functions_are_found():
    assert "fastlink.engine.sweep.sweep" in [found.name for found in examples_of("fastlink.engine.sweep")]


@pytest.mark.parametrize("document", [d for d in DOCUMENTS if d != OTHERS], ids=lambda path: path.name)
def test_the_examples_of_the_documents(document, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
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


def run_commands(lines):
    """Run command lines in this process and folder."""
    for line in lines.strip().splitlines():
        run_command(line)


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_examples_are_fenced(document):
    """Elsewhere a page shows `>>>` as nested quotations."""
    text = re.sub(r"^```.*?^```$", "", document.read_text(), flags=re.MULTILINE | re.DOTALL)
    assert not re.findall(r"^>>> .*", text, flags=re.MULTILINE)


@pytest.mark.parametrize("name", ["", "planar", "minkowski", "focal", "hart"])
def test_completion_shows_public_names_alone(name):
    package = getattr(fastlink, name) if name else fastlink
    assert dir(package) == sorted(package.__all__)


def test_the_public_functions_have_examples():
    for name in fastlink.__all__:
        thing = getattr(fastlink, name)
        if callable(thing) and not isinstance(thing, type):
            assert ">>>" in (thing.__doc__ or ""), name


def test_the_python_example_of_the_readme(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (example,) = code_blocks(README, "python")
    for _ in range(2):  # the file of the first run is in the way of the second
        exec(compile(example, "README.md", "exec"), {})
        assert re.fullmatch(r"a2 = 1\.\d{3} m, a3 = \d\.\d{3} m\n", capsys.readouterr().out)
    assert (tmp_path / "maps.h5").exists()


def command(line, folder):
    """Run a command line of the README with the fastlink that is installed here."""
    scripts = str(Path(sys.executable).parent)
    environment = os.environ | {"PATH": f"{scripts}{os.pathsep}{os.environ['PATH']}"}
    done = subprocess.run(
        line, shell=True, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    return done.stdout


def test_the_main_job_of_the_readme(tmp_path):
    shutil.copytree(ROOT / "data", tmp_path / "data")
    (first, *_) = code_blocks(README, "sh")
    install, run = first.strip().split(" && ")
    assert install == "python -m pip install ."
    assert "1,030,301" in command(run, tmp_path)
    plot = re.search(r"`(fastlink plot [^`]*)`", README)
    assert plot is not None
    command(plot.group(1), tmp_path)
    assert list(tmp_path.glob("*.png"))


def test_the_command_lines_of_the_readme(folder):
    (lines,) = [block for block in code_blocks(README, "sh") if "fastlink new" in block]
    run_commands(lines)
    assert (folder / "study.h5").exists()


def test_ci_calls_the_readmes_test_command():
    (test_command,) = {block.strip() for block in code_blocks(README, "sh") if "pytest" in block}
    assert test_command in (ROOT / ".ci" / "run").read_text().splitlines()


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


def run_example(text):
    """Run a script of its own: a fact's text is read from its file."""
    path = Path(os.environ["FASTLINK_CACHE_DIR"]) / "contributing_example.py"
    path.write_text(f"import sys; sys.path.insert(0, '.')\n{text}")
    done = subprocess.run([sys.executable, str(path)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_the_quantity_of_contributing_works():
    example, *_ = code_blocks((ROOT / "CONTRIBUTING.md").read_text(), "python")
    run_example(
        "from typing import Any\n"
        "from fastlink.mechanisms.planar_4r.inputs import HAYES, planar_4r\nimport fastlink.mechanisms.planar_4r\n"
        + example
        + "\nimport fastlink as fl\n"
        "design = fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=25.0)\n"
        "asked = ['output_power', 'alpha4', 'omega4']\n"
        "result = fl.sweep('planar_4r', design, asked, links=fl.round_bar(7750.0, 0.01), theta1=8)\n"
        "spin = result.output_power / result.alpha4 / result.omega4\n"
        # 0.62 pi kg of 0.8 m about its end; each side took a few roundings
        "assert (abs(spin / (0.62 * 3.141592653589793 * (0.64 / 3 + 0.25e-4)) - 1) < 1e-14).all()\n"
    )


def test_the_reduction_of_contributing_works():
    *_, example = code_blocks((ROOT / "CONTRIBUTING.md").read_text(), "python")
    run_example(
        "from fastlink.plan.query import Reduction, register\n" + example + "\nimport fastlink as fl\n"
        "design = fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=25.0)\n"
        "asked = ['omega4_range', 'omega4_max', 'omega4_min']\n"
        "result = fl.sweep('planar_4r', design, asked, theta1=8, extrema='sampled', verify=1)\n"
        "assert (result.omega4_range == result.omega4_max - result.omega4_min).all()\n"
        # one subtraction
        "assert result.omega4_range.attrs['error_max_roundings'] <= 1\n"
    )


def test_the_notebook_runs(tmp_path):
    notebook = nbformat.read(ROOT / "docs" / "how_to" / "first_map.ipynb", as_version=4)
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    shown = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert sum("image/png" in output.get("data", {}) for output in shown) == 2
    assert not [output for output in shown if "Warning" in output.get("text", "")]
    assert not any(
        cell.get("outputs") for cell in nbformat.read(ROOT / "docs/how_to/first_map.ipynb", 4).cells
    )
