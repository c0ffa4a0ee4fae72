"""Docstrings are true: their examples run, with fastlink as fl and numpy as np."""

import doctest
import importlib
import inspect
import pkgutil

import numpy
import pytest

import fastlink


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
def test_docstring_examples(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    for example in examples_of(name):
        runner.run(example)
    assert runner.summarize(verbose=False).failed == 0


def test_examples_of_guarded_functions_are_found():
    assert "fastlink.engine.sweep.sweep" in [found.name for found in examples_of("fastlink.engine.sweep")]


@pytest.mark.parametrize("name", ["", "planar", "minkowski", "focal", "hart"])
def test_completion_shows_public_names_alone(name):
    package = getattr(fastlink, name) if name else fastlink
    assert dir(package) == sorted(package.__all__)


def test_the_public_functions_have_examples():
    for name in fastlink.__all__:
        thing = getattr(fastlink, name)
        if callable(thing) and not isinstance(thing, type):
            assert ">>>" in (thing.__doc__ or ""), name
