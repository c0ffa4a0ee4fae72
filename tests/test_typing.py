"""The type hints that name mechanisms, quantities and inputs: the committed stubs are those of the catalogues."""

import inspect
from typing import get_args

import pytest

import fastlink as fl
from fastlink import typing
from fastlink.mechanisms import NAMES, inputs_of
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.query import parse_request
from tests.support import stub

FILES = stub.files()


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_the_stub_is_up_to_date(path):
    assert path.read_text(encoding="utf-8") == FILES[path], "stale: run `python -m tests.support.stub`"


@pytest.mark.parametrize("mechanism", NAMES)
def test_the_types_list_names_that_can_be_requested(mechanism):
    catalogues = [find_catalogue(mechanism, driver) for driver in inputs_of(mechanism)]
    for noun, known in (("Quantity", "public"), ("Input", "variables")):
        listed = get_args(getattr(typing, typing._alias(mechanism, noun)))
        assert set(listed) == {name for catalogue in catalogues for name in getattr(catalogue, known)}
    # of some thousand names, which are made alike, one in twenty
    for name in get_args(getattr(typing, typing._alias(mechanism, "Result")))[::20]:
        assert any(_can_request(name, catalogue) for catalogue in catalogues)


def _can_request(name, catalogue):
    try:
        return parse_request(name, catalogue).name == name
    except fl.InputError:
        return False


def test_signatures_keep_the_parameters_of_the_functions():
    for name in (*stub.BY_MECHANISM, *stub.OF_INPUTS):
        text = stub.signature_text(name, "hart" if name in stub.BY_MECHANISM else "")
        for parameter in inspect.signature(getattr(fl, name)).parameters.values():
            if parameter.kind is not inspect.Parameter.VAR_KEYWORD:
                assert f"    {parameter.name}: " in text
    with pytest.raises(AttributeError, match="Planar5rInput"):
        _ = typing.Planar5rInput
    assert dir(typing) == typing.__all__
