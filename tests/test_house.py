"""The house: few arguments by position, docstrings that begin well.

The layers stand in pyproject.toml, as contracts of import-linter; `lint-imports` checks them.
"""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[1] / "src" / "fastlink"
FILES = sorted(SOURCE.rglob("*.py"))
MOST_POSITIONAL = 6
#: The parameters of a fact are the names of what it depends on.
FACTS = SOURCE / "mechanisms"


def functions(path):
    """Yield every function of a file."""
    return (node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.FunctionDef))


def each(files):
    return pytest.mark.parametrize("path", files, ids=lambda path: str(path.relative_to(SOURCE)))


@each([path for path in FILES if FACTS not in path.parents])
def test_functions_take_few_arguments_by_position(path):
    given = {
        f.name: [a.arg for a in (*f.args.posonlyargs, *f.args.args) if a.arg not in ("self", "cls")]
        for f in functions(path)
    }
    assert {name: names for name, names in given.items() if len(names) > MOST_POSITIONAL} == {}


@each(FILES)
def test_docstrings_say_what_is_done(path):
    tree = ast.parse(path.read_text())
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef)
    texts = (ast.get_docstring(node) or "" for node in ast.walk(tree) if isinstance(node, documented))
    assert [text.partition("\n")[0] for text in texts if text.startswith("What ")] == []


def test_numba_is_imported_only_where_it_is_asked_for():
    """It takes longer to import than all else together."""
    script = """
import sys
import fastlink as fl
space = fl.grid(a1=0.4, a2=1.1, a3=0.8, a4=1.0, omega1=1.0)
fl.sweep("planar_4r", space, ["omega4", "omega4_max"], angles=40)
assert "numba" not in sys.modules
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
