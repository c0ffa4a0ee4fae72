"""README, CONTRIBUTING and the notebook are true: what they show runs."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

import fastlink as fl
from tests.support.commands import code_blocks, run_command, run_commands

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()


def test_the_python_example_of_the_readme(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (example,) = code_blocks(README, "python")
    (tmp_path / "maps.h5").write_text("of an earlier run")
    exec(compile(example, "README.md", "exec"), {})
    assert re.fullmatch(r"a2 = 1\.\d{3} m, a3 = \d\.\d{3} m\n", capsys.readouterr().out)
    fl.open(tmp_path / "maps.h5").close()


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
