"""The offset slider-crank: its inputs and its two assembly modes.

The crank OA of length r turns about O = (0, 0), the connecting rod AB of length l moves the slider B on the line
y = e, which is parallel to the x axis. Links are numbered as in the planar 4R: 1 the crank, 2 the rod, 3 the slider, 4
the ground.
"""

from __future__ import annotations

from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import Input

PAGE = "docs/slider_crank.md"
HAYES = "Hayes, Hninn, Irani"

#: The links that are bars, by number: what they are and the name of their length.
BARS = {1: ("crank OA", "r"), 2: ("connecting rod AB", "l")}
_FRAMES = {1: "from O along OA", 2: "from A along AB"}

slider_crank = Catalogue(
    "slider_crank",
    "Offset slider-crank: a crank at O, a connecting rod, and a slider on the line y = e",
    branches={
        1: "slider to the right of the crank pin A: its x is greater",
        2: "slider to the left of the crank pin A: its x is less",
    },
    position=Input("theta", "rad", "theta", "crank angle: direction of OA, from the line of the slider"),
)
slider_crank.closes = ("sigma", "p", "q")

slider_crank.input("r", units="m", symbol="r", meaning="length of the crank OA", rule="positive")
slider_crank.input("l", units="m", symbol="l", meaning="length of the connecting rod AB", rule="positive")
slider_crank.input("e", units="m", symbol="e", meaning="offset: y of the line of the slider, of either sign")
slider_crank.input(
    "omega", units="rad s-1", symbol="omega", meaning="angular velocity of the crank, constant"
)

for _i, (_link, _) in BARS.items():
    slider_crank.input(
        f"m{_i}", units="kg", symbol=f"m_{_i}", meaning=f"mass of the {_link}", rule="non-negative"
    )
    slider_crank.input(
        f"I{_i}",
        units="kg m2",
        symbol=f"I_{_i}",
        meaning=f"moment of inertia of the {_link} about its mass centre",
        rule="non-negative",
    )
    slider_crank.input(
        f"G{_i}_u", units="m", symbol=f"G_{_i}u", meaning=f"mass centre of the {_link}, {_FRAMES[_i]}"
    )
    slider_crank.input(
        f"G{_i}_v",
        units="m",
        symbol=f"G_{_i}v",
        meaning=f"mass centre of the {_link}, to the left of its axis",
    )

slider_crank.input(
    "m3", units="kg", symbol="m_3", meaning="mass of the slider, its centre at B", rule="non-negative"
)
