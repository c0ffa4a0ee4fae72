"""Small mechanisms of tests, declared by sheets."""

from __future__ import annotations

from collections.abc import Mapping
from textwrap import dedent

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
