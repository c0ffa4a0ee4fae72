"""What may drive the focal mechanism: the rocker MA, or the crank SF in a catalogue of its own.

What holds of both is declared in both by `either`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cache
from typing import Any, TypeVar

from fastlink.catalogue.catalogue import Catalogue, Input
from fastlink.catalogue.rows import Rows
from fastlink.errors import InputError, Setting
from fastlink.mechanisms.focal.declare import focal

F = TypeVar("F", bound=Callable[..., Any])


class _ByCrank(Catalogue):
    """The mechanism by its crank, which tells what belongs to the other drive."""

    def unknown(self, name: str, known: Iterable[str]) -> InputError:
        if name == self.position.name:
            what = f"quantity {name!r} is the input, and a coordinate of the result"
            return InputError(what, remedy="leave it out")
        if name in focal.public:
            what = f"quantity {name!r} is defined for input {focal.position.name!r} alone"
            here = ("leave ", Setting("input", self.position.name), " out, or ")
            return InputError(what, remedy=(here, "ask for such as 'dphi_dsigma'"))
        return super().unknown(name, known)


by_crank = _ByCrank(
    f"{focal.name} driven by sigma",
    f"{focal.title}, driven by the crank SF",
    branches={
        1: "omega_angle from 0 to pi: P to the right of the directed line from M to F",
        2: "omega_angle from -pi to 0: P to the left of the directed line from M to F",
    },
    position=Input("sigma", "rad", "sigma", "direction of SF in the ground frame"),
)
by_crank.inputs, by_crank.variant_inputs = focal.inputs, focal.variant_inputs


def quantities(*, units: str, source: str) -> Rows:
    """Return what declares quantities whatever drives, row by row."""
    return Rows((focal, by_crank), units, source, internal=False)


def steps(*, units: str, source: str) -> Rows:
    """Return what declares steps on the way whatever drives, row by row."""
    return Rows((focal, by_crank), units, source, internal=True)


def either(**labels: Any) -> Callable[[F], F]:
    """Declare a fact that holds whatever drives: see `Catalogue.quantity`."""

    def declare(law: F) -> F:
        for catalogue in (focal, by_crank):
            catalogue.quantity(**labels)(law)
        return law

    return declare


@cache
def with_design_facts() -> Catalogue:
    """Return the catalogue of the crank with what belongs to the design as a whole; after all declarations."""
    for name, fact in focal.facts.items():
        if not (focal.is_derivative(name) or focal.varies(name)):
            by_crank.facts.setdefault(name, fact)
    for chosen in focal.variant_inputs:
        by_crank.variants[chosen] = focal.variants[chosen]
    return by_crank
