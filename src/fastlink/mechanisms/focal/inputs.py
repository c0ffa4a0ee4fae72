"""Burmester's focal mechanism: its inputs, its two completions and its two assembly modes.

The four-bar MABN stands on MN: M = (0, 0), N = (d, 0). Its rockers MA and NB carry P and Q at the distances m and n
from M and N (beyond the pivot where negative), and F hangs on PF = p and QF = q.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, TypeVar

from fastlink.facts.catalogue import Catalogue, Rows
from fastlink.facts.fact import Input
from fastlink.mechanisms._shared.laws import ByOtherInput

WUNDERLICH = "Wunderlich"
DESIGN = "docs/focal.md"

#: The bars of the four-bar by the names of their lengths.
LINKS = {"a": "rocker MA", "b": "rocker NB", "c": "coupler AB", "d": "ground link MN"}
COMPLETIONS = {1: "root_of_greater_size", 2: "root_of_smaller_size"}
GIVEN_S, GIVEN_LAMBDA = "s", "lambda_"

focal = Catalogue(
    "focal",
    "Burmester's focal mechanism: a planar four-bar MABN with a point F on bars from all four sides",
    branches={
        1: "B to the right of the directed line from A to N",
        2: "B to the left of the directed line from A to N",
    },
    position=Input("phi", "rad", "phi", "direction of MA in the ground frame"),
)
focal.closes = ("bar_sigma", "bar_p", "bar_q")

focal.input("a", units="m", symbol="a", meaning=f"length of the {LINKS['a']}", rule="positive")
focal.input("b", units="m", symbol="b", meaning=f"length of the {LINKS['b']}", rule="positive")
focal.input("c", units="m", symbol="c", meaning=f"length of the {LINKS['c']}", rule="positive")
focal.input("d", units="m", symbol="d", meaning=f"length of the {LINKS['d']}", rule="positive")
focal.input(
    "rho", units="1", symbol="rho", meaning="ratio mp : nq = MS : SN, negative where S is not between M and N"
)
focal.input(
    GIVEN_S, units="m", symbol="s", meaning="crank support S on MN, from M towards N", variant=GIVEN_S
)
focal.input(GIVEN_LAMBDA, units="1", symbol="lambda", meaning="factor a/m = b/n", variant=GIVEN_LAMBDA)
_ROOT = "which root completes the four-bar: of lambda - 1, or of rho where lambda_ is given"
focal.input("completion", units="1", symbol="k", meaning=_ROOT, choices=COMPLETIONS)
focal.input(
    "omega", units="rad s-1", symbol="omega", meaning="angular velocity of the driving link, constant"
)


# -- The focal mechanism driven by the crank SF, a catalogue beside the one by the rocker MA

# Facts that hold for both are declared in both by `either`, `quantities` and `steps`.


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
