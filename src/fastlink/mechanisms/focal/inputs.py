"""Burmester's focal mechanism: its inputs, its two completions and its two assembly modes.

The four-bar MABN stands on MN: M = (0, 0), N = (d, 0). Its rockers MA and NB carry P and Q at the distances m and n
from M and N (beyond the pivot where negative), and F hangs on PF = p and QF = q.
"""

from __future__ import annotations

from fastlink.catalogue.catalogue import Catalogue, Input

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
