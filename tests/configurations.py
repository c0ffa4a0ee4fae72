"""Random configurations of the planar 4R, easy and hard, and their reference with 50 digits."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from benchmarks.families import near_change_point as near_change_point
from benchmarks.families import near_toggle as near_toggle

from fastlink.catalogue import Catalogue, Input
from fastlink.exact import DIGITS as DIGITS
from fastlink.exact import UNIT as UNIT
from fastlink.exact import Exact
from fastlink.mechanisms import catalogue

PLANAR: Catalogue = catalogue("planar_4r")
LENGTHS = ("a1", "a2", "a3", "a4")
#: The sets of facts that giving one of their inputs chooses.
LOADS = tuple(
    name
    for name, inputs in PLANAR.alternative_inputs.items()
    if any(declared.default is not None for declared in inputs.values())
)


def draw(declared: Mapping[str, Input], rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Values for inputs, of either sign where they may."""
    inputs = {}
    for name, one in declared.items():
        size = rng.uniform(0.2, 2.0, n)
        inputs[name] = size if one.rule != "any" else size * rng.choice([-1.0, 1.0], n)
    return inputs


def masses_and_points(rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Every input but the lengths: mass centres anywhere, coupler point anywhere."""
    return draw({name: one for name, one in PLANAR.inputs.items() if name not in LENGTHS}, rng, n)


def all_loads(rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Every input of every load."""
    return {name: v for load in LOADS for name, v in draw(PLANAR.alternative_inputs[load], rng, n).items()}


def random_lengths(rng: np.random.Generator, n: int) -> np.ndarray:
    """Lengths (4, n) of all classes."""
    return rng.uniform(0.3, 2.0, (4, n))


def reference(
    names: list[str],
    inputs: dict[str, Any],
    alternatives: tuple[str, ...] = (),
    catalogue: Catalogue = PLANAR,
) -> dict[str, Any]:
    """Return the facts of one configuration with 50 digits."""
    found = Exact(catalogue, names, inputs, alternatives).at(inputs)
    return {name: found[name] for name in names}


def condition_sums(
    names: list[str],
    inputs: dict[str, Any],
    alternatives: tuple[str, ...] = (),
    catalogue: Catalogue = PLANAR,
) -> dict[str, Any]:
    """Return sum over the inputs of |x df/dx|: what one rounding of each input does to each quantity."""
    facts = Exact(catalogue, names, inputs, alternatives)
    return facts.condition(facts.at(inputs), [name for name in inputs if name != "branch"])
