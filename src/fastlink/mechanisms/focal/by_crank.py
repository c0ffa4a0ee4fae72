"""The focal mechanism driven by the crank SF, a catalogue beside the one by the rocker MA.

Facts that hold for both are declared in both by `either`, `quantities` and `steps`.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, TypeVar

from fastlink.catalogue.catalogue import Catalogue, Input
from fastlink.catalogue.rows import Rows
from fastlink.mechanisms._shared.other_input import ByOtherInput
from fastlink.mechanisms.focal.inputs import focal

F = TypeVar("F", bound=Callable[..., Any])


by_crank = ByOtherInput(
    focal,
    f"{focal.title}, driven by the crank SF",
    branches={
        1: "omega_angle from 0 to pi: P to the left of the directed line from M to F where m p > 0",
        2: "omega_angle from -pi to 0: P to the right of the directed line from M to F where m p > 0",
    },
    position=Input("sigma", "rad", "sigma", "direction of SF in the ground frame"),
    instead=("dphi_dsigma",),
)
by_crank.inputs, by_crank.variant_inputs = focal.inputs, focal.variant_inputs


def quantities(*, units: str, source: str) -> Rows:
    """Return rows of quantities that hold for both inputs."""
    return Rows((focal, by_crank), {"units": units, "source": source})


def steps(*, units: str, source: str) -> Rows:
    """Return rows of internal steps that hold for both inputs."""
    return Rows((focal, by_crank), {"units": units, "source": source, "internal": True})


def either(**labels: Any) -> Callable[[F], F]:
    """Declare a fact that holds for both inputs: see `Catalogue.quantity`."""

    def declare(law: F) -> F:
        for catalogue in (focal, by_crank):
            catalogue.quantity(**labels)(law)
        return law

    return declare


@cache
def with_design_facts() -> Catalogue:
    """Return the catalogue of the crank with the facts of the design as a whole; after all declarations."""
    by_crank.adopt_design_facts()
    for chosen in focal.variant_inputs:
        by_crank.variants[chosen] = focal.variants[chosen]
    return by_crank
