"""The Minkowskian planar 4R: its inputs and its two assembly modes."""

from __future__ import annotations

from fastlink.catalogue.catalogue import Catalogue, Input

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

for _name, _link in LINKS.items():
    minkowski_4r.input(
        _name, units="m", symbol=_name, meaning=f"hyperbolic length of the {_link}", rule="positive"
    )

for _name, _where in (
    ("x", "along AB from A"),
    ("y", "across AB, of rapidity AB where AB is future-pointing"),
):
    minkowski_4r.input(_name, units="m", symbol=_name, meaning=f"coupler point, {_where}")
