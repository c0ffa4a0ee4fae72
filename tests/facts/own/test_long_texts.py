"""Texts of any length: each long chain of operations is computed in pieces, or refused in a line."""

import math
import random

import numpy as np
import pytest
from tests.support.refusals import refused

import fastlink as fl
from fastlink.app.study import load_extension
from fastlink.errors import InputError
from fastlink.facts.own import TOO_LONG
from fastlink.pictures.content import script_of

HEAD = """from math import *
import fastlink as fl
mine = fl.extend("planar_4r")
@mine.quantity(units="1")
def long(theta4, a1, a2):
    x = theta4
"""
DESIGN = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
FACTORS = [round(random.Random(k).uniform(0.5, 1.5), 3) for k in range(1000)]
TEXTS = {
    "sum": " + ".join(f"{k} * x" for k in FACTORS),
    "difference": " - ".join(f"{k} / x" for k in FACTORS),
    "product": " * ".join(f"({k} + 0.001 * x)" for k in FACTORS),
    "quotient": " / ".join(f"({k} + 0.001 * x)" for k in FACTORS),
    "signs": f"{'-' * 1001}x",
    "choices": f"{''.join(f'{k} if x < {k / 1000} else ' for k in range(1000))}x",
    "conditions": f"1.0 if {' & '.join(f'(x < {k + 5})' for k in range(1000))} else 0.0",
    "all": f"1.0 if {' and '.join(f'x < {k + 5}' for k in range(1000))} else 0.0",
    "comparisons": f"1.0 if x < {' < '.join(f'{k} + x' for k in range(1000))} else 0.0",
    "greatest": f"max({', '.join(f'{k} * x' for k in FACTORS)})",
    "magnitudes": " + ".join(f"abs({k} - x)" for k in FACTORS),
}


@pytest.fixture
def declared(tmp_path):
    """Return a function that declares a text, and returns the extension and the text as a function of Python."""

    def declare(text):
        (tmp_path / "mine.py").write_text(HEAD + text + "\n")
        extension = load_extension(tmp_path / "study.toml", "mine.py", "planar_4r", True)
        names = {}
        exec(
            compile(f"from math import *\ndef long{HEAD.rpartition('def long')[2]}{text}\n", "", "exec"),
            names,
        )
        return extension, names["long"]

    return declare


@pytest.mark.sample(1)
@pytest.mark.parametrize("kind", TEXTS)
def test_a_long_chain_has_the_value_that_python_gives_it(declared, kind):
    mine, function = declared(f"    return {TEXTS[kind]}")
    found = fl.evaluate(mine, ["theta4", "long"], theta1=1.0, branch=1, **DESIGN)
    assert found["long"] == function(found["theta4"], 0.4, 1.2)
    catalogue = mine.catalogue()
    assert script_of(catalogue, ["long"], list(DESIGN), ())[1] == ("long",)
    assert catalogue.resolve("long_error").depends_on
    if kind not in (
        "conditions",
        "all",
        "comparisons",
    ):  # they choose between numbers, which depend on nothing
        assert catalogue.resolve("d_long_d_a2").depends_on


@pytest.mark.sample(1)
@pytest.mark.parametrize("kind", ["sum", "conditions"])
def test_a_long_chain_is_taken_by_every_reader(declared, kind):
    text = TEXTS[kind] if kind == "conditions" else " + ".join(f"{k} * x" for k in FACTORS[:100])
    mine, function = declared(f"    return {text} + a2 / a1 * x")
    space = fl.grid(**DESIGN | {"a1": [0.3, 0.4]})
    smooth = ["d_long_d_a2", "long_max_error"] if kind == "sum" else []
    maps = fl.sweep(
        mine, space, ["theta4", "long", "long_error", "long_max", *smooth], branch=1, theta1=7, verify=1
    )
    expected = [
        [function(x, a1, 1.2) for x in row]
        for a1, row in zip((0.3, 0.4), maps.theta4.squeeze().values, strict=True)
    ]
    assert np.abs(maps.long.squeeze() - expected).max() <= 1e-13 * np.abs(expected).max()
    assert (maps.long_max.squeeze() >= maps.long.squeeze().max("theta1") * (1 - 1e-13)).all()
    assert float(maps.long_error.max()) < 1e-9


@pytest.mark.stress
def test_ten_thousand_terms(declared):
    lines = [f"    y = {'y + ' if k else ''}{TEXTS['sum']}" for k in range(10)]
    mine, function = declared("\n".join([*lines, "    return y"]))
    found = fl.evaluate(mine, ["theta4", "long"], theta1=1.0, branch=1, **DESIGN)
    assert math.isclose(found["long"], function(found["theta4"], 0.4, 1.2), rel_tol=1e-11)


def test_what_python_has_no_room_for_is_refused_in_a_line(declared):
    for text in (" + ".join(["x"] * 100_000), "-" * 100_000 + "x"):
        with refused("quantities_file", TOO_LONG[1]):
            declared(f"    return {text}")
    for text in ("x" + "**2" * 900, "x" + "[0]" * 900, f"1.0 if {'not ' * 900}x < 1.0 else 0.0"):
        with pytest.raises(InputError) as caught:
            declared(f"    return {text}")
        assert len(str(caught.value)) < 400


def test_more_kinks_than_are_searched_make_extremes_those_of_samples(declared):
    for count, sampled in ((3, False), (100, True)):
        mine, _ = declared(f"    return {' + '.join(f'abs({k} - x)' for k in FACTORS[:count])}")
        catalogue = mine.catalogue()
        assert ("long" in catalogue.graded.not_differentiable) is sampled
        assert ("long" in catalogue.graded.kinks) is not sampled
