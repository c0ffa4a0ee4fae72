"""The Minkowskian planar 4R: its inputs and its two assembly modes."""

from __future__ import annotations

from functools import partial

from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import Input

HEGEDUS = "Hegedüs, Moore"
NUMERICS = "docs/minkowski_numerics.md"

#: The links by the names of their lengths.
LINKS = {"a": "input crank OA", "b": "output crank CB", "g": "ground link OC", "h": "coupler AB"}

minkowski_4r = Catalogue(
    "minkowski_4r",
    "Planar four-bar linkage of the Minkowskian plane with four revolute joints, driven at O",
    branches={
        1: "the root with the plus sign of eq. (3)",
        2: "the root with the minus sign of eq. (3)",
    },
    position=Input("theta", "1", "theta", "input rapidity: of OA in the ground frame"),
    positions=(-4.0, 4.0, 401),
)
minkowski_4r.closes = ("half_root", "inside", "outside")

length = partial(minkowski_4r.input, units="m", rule="positive")
length("a", symbol="a", meaning=f"hyperbolic length of the {LINKS['a']}")
length("b", symbol="b", meaning=f"hyperbolic length of the {LINKS['b']}")
length("g", symbol="g", meaning=f"hyperbolic length of the {LINKS['g']}")
length("h", symbol="h", meaning=f"hyperbolic length of the {LINKS['h']}")

minkowski_4r.input("x", units="m", symbol="x", meaning="coupler point, along AB from A")
minkowski_4r.input(
    "y", units="m", symbol="y", meaning="coupler point, across AB, of rapidity AB where AB is future-pointing"
)
