"""The tables of what the three papers define and where fastlink computes it, at the end of papers.html.

They are written from the tables ``docs/papers/*.toml``. Each has the title
of a paper, the numbers of its numbered items by their spelling (``numbered``), and rows:

place : list of str
    Where the paper has it: numbered items as ``numbered`` spells them, or the words of an unnumbered one.
what : str
    What stands there.
names : list of str
    What computes it: ``planar_4r: omega4_max`` (a quantity of a mechanism, or an input), ``fl.planar.curve_area``
    (a public name), or the path of a study, a page or a picture.
tests : list of str
    Tests that hold it, ``tests/folder/test_file.py::test_name``.
note : str, optional
    Why nothing computes it, where `names` is empty; or how it differs from what is printed.
"""

from __future__ import annotations

import ast
import functools
import operator
import tomllib
from pathlib import Path
from typing import Any

import fastlink
from fastlink.mechanisms import catalogue
from fastlink.plan.query import parse_request

ROOT = Path(__file__).parents[2]
TABLES = ROOT / "docs" / "papers"


def papers() -> list[dict[str, Any]]:
    """Return the tables of all papers."""
    return [tomllib.loads(path.read_text()) for path in sorted(TABLES.glob("*.toml"))]


def numbered(paper: dict[str, Any]) -> list[str]:
    """Return the spelling of each numbered item of a paper.

    >>> numbered({"numbered": {"eq. ({})": [1, 2], "Table {}": 2}})
    ['eq. (1)', 'eq. (2)', 'Table 1', 'Table 2']
    """
    return [
        spelling.format(number)
        for spelling, numbers in paper["numbered"].items()
        for number in (range(1, numbers + 1) if isinstance(numbers, int) else numbers)
    ]


def problem(name: str) -> str | None:
    """Return why a name of a row is not there, None if it is."""
    if name.startswith("fl."):
        try:
            operator.attrgetter(name.removeprefix("fl."))(fastlink)
        except AttributeError as error:
            return str(error)
        return None
    mechanism, separator, quantity = name.partition(": ")
    if not separator:
        return None if (ROOT / name.partition("#")[0]).is_file() else f"there is no file {name}"
    try:
        found = catalogue(mechanism)
        if quantity not in found.known_inputs(found.variant_inputs):
            parse_request(quantity, found)
    except (ValueError, KeyError) as error:
        return str(error)
    return None


@functools.cache
def _tests_in(path: Path) -> frozenset[str]:
    tree = ast.parse(path.read_text())
    return frozenset(node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef))


def test_problem(test: str) -> str | None:
    """Return why a test of a row is not there, None if it is."""
    file, _, name = test.partition("::")
    if not (ROOT / file).is_file():
        return f"there is no file {file}"
    return None if name in _tests_in(ROOT / file) else f"{file} has no test {name}"


def _named(name: str) -> str:
    """Return a name as the page shows it: files as links."""
    if name.startswith("fl.") or ": " in name:
        return f"`{name}`"
    target = name.removeprefix("docs/") if name.startswith("docs/") else f"../{name}"
    return f"[{name}]({target})"


def _tested(test: str) -> str:
    file, _, name = test.partition("::")
    return f"[`{name}`](../{file})"


def tables() -> str:
    """Return the tables of the page."""
    parts = []
    for paper in papers():
        parts.append(f"\n## {paper['title']}\n\n{paper['authors']}.\n")
        parts.append("\n| where | what | computed by | held by |\n|---|---|---|---|\n")
        for row in paper["row"]:
            names = ", ".join(map(_named, row["names"]))
            notes = [part for part in (names, row.get("note", "")) if part]
            tests = ", ".join(map(_tested, row["tests"]))
            parts.append(f"| {', '.join(row['place'])} | {row['what']} | {'. '.join(notes)} | {tests} |\n")
    return "".join(parts)
