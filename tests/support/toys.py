"""Small mechanisms of tests, declared by sheets, and quantities of one's own, declared by texts."""

from __future__ import annotations

import linecache
import math
from collections.abc import Mapping
from textwrap import dedent
from typing import Any

import numpy as np

from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import Input
from fastlink.facts.sheet import read_sheet


def toy(text: str = "", branches: Mapping[int, str] = {1: "the only one"}) -> Catalogue:
    """Return a mechanism over an angle theta, whose sheet this is."""
    return add(Catalogue("toy", "a toy", branches, Input("theta", "rad", "theta", "input")), text)


def add(catalogue: Catalogue, text: str) -> Catalogue:
    """Declare the entries of a sheet."""
    read_sheet(dedent(text), "toy.facts", catalogue)
    return catalogue


def function_of(head: str, text: str, **names: Any) -> Any:
    """Return the function of a head and a text, which has its text as one of a file has."""
    file, lines = f"<{head}>", [f"def {head}:\n", f"    {text}\n"]
    linecache.cache[file] = (1, None, lines, file)
    scope = {"np": np, "math": math} | names
    exec(compile("".join(lines), file, "exec"), scope)
    return scope[head.partition("(")[0]]


def declare_all(extension: Any, quantities: Mapping[str, tuple[str, str]]) -> None:
    """Declare quantities, each by its head, its units and its value."""
    for head, (units, value) in quantities.items():
        extension.quantity(units=units)(function_of(head, f"return {value}"))
