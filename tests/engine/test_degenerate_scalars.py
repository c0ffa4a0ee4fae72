"""One configuration has the bits that it has in an array, however degenerate: no division of Python's own numbers."""

import numpy as np
import pytest

import fastlink as fl
from fastlink.facts.evaluate import evaluate_on_doubles
from fastlink.facts.tables import angle_tables
from fastlink.mechanisms import NAMES, catalogue, inputs_of

POSITIONS = [0.0, np.pi, np.pi / 2, 1.0, -1.0, 0.3, 2.0 * np.pi]
#: Small whole numbers meet in change points, kites and folded positions; zeros where the rule allows them.
NUMBERS = {"any": [0.0, 1.0, -1.0, 2.0, 0.5]}
DRIVEN = [(mechanism, input) for mechanism in NAMES for input in inputs_of(mechanism)]


def drawn(mechanism, known, rng):
    """Return a degenerate design, an input position and an assembly mode."""
    design = {
        name: rng.choice(list(given.choices) or NUMBERS.get(given.rule, [1.0, 1.0, 2.0, 0.5, 3.0]))
        for name, given in known.items()
    }
    return design | {
        mechanism.position.name: rng.choice(POSITIONS),
        "branch": rng.choice(list(mechanism.branches)),
    }


def assert_same_alone(mechanism, variants, n, rng):
    known, position = mechanism.known_inputs(variants), mechanism.position.name
    tables = (position, *mechanism.tables, *mechanism.table_low_parts)
    names = [name for name in mechanism.public if not mechanism.public[name].flags]
    bounds = [] if "dense" in variants else [f"{name}_error" for name in names]
    steps = list(mechanism.dependencies([*mechanism.public, *bounds], {*known, *tables, "branch"}, variants))
    for _ in range(n):
        values = drawn(mechanism, known, rng)
        tabled = angle_tables(mechanism, tables, np.array([values[position]]))
        values |= zip(tables, tabled[:, 0], strict=True)
        alone = {name: np.float64(value) for name, value in values.items()}
        together = {name: np.array([value], dtype=float) for name, value in values.items()}
        evaluate_on_doubles(steps, alone)
        evaluate_on_doubles(steps, together)
        for step in steps:
            for name in step.names:
                np.testing.assert_array_equal(
                    np.ravel(alone[name]), np.ravel(together[name]), f"{name} {values}"
                )


@pytest.mark.sample(3)
@pytest.mark.parametrize(("mechanism", "input"), DRIVEN)
def test_every_quantity_alone_is_as_in_an_array(mechanism, input):
    rng = np.random.default_rng(3)
    assert_same_alone(catalogue(mechanism, input), (), 5, rng)


@pytest.mark.parametrize(
    ("mechanism", "name", "inputs"),
    [
        ("minkowski_4r", "phi_error", {"a": 3.0, "b": 0.5, "g": 0.5, "h": 2.0, "theta": 1.0}),
        ("hart", "closure_residual", {"m": 1.0, "n": 1.0, "d": 1.0, "kappa": 0.0, "phi": 1.0}),
    ],
)
def test_evaluate_returns_what_an_array_has(mechanism, name, inputs):
    alone = fl.evaluate(mechanism, [name], **inputs)[name]
    (together,) = fl.evaluate(
        mechanism, [name], **{**inputs, next(iter(inputs)): [next(iter(inputs.values()))]}
    )[name]
    np.testing.assert_array_equal(alone, together)
    assert not np.isfinite(alone)
