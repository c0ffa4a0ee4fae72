"""The planar 4R: its inputs and its two assembly modes."""

from __future__ import annotations

from functools import partial
from typing import Any

from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import Input
from fastlink.mechanisms._shared.laws import build_on as _build_on

HAYES = "Hayes, Hninn, Irani"
NUMERICS = "docs/numerics.md"

#: The moving links by number.
LINKS = {1: "crank OA", 2: "coupler AB", 3: "output link DB"}

planar_4r = Catalogue(
    "planar_4r",
    "Euclidean planar four-bar linkage with four revolute joints, driven at O",
    branches={
        1: "B to the right of the directed line from A to D",
        2: "B to the left of the directed line from A to D",
    },
    position=Input("theta1", "rad", "theta_1", "input angle: direction of OA in the ground frame"),
)
planar_4r.closes = ("sigma", "p", "q")

length = partial(planar_4r.input, units="m", rule="positive")
length("a1", symbol="a_1", meaning="length of the input crank OA")
length("a2", symbol="a_2", meaning="length of the coupler AB")
length("a3", symbol="a_3", meaning="length of the output link DB")
length("a4", symbol="a_4", meaning="length of the ground link OD")

planar_4r.input(
    "omega1", units="rad s-1", symbol="omega_1", meaning="angular velocity of the crank, constant"
)

planar_4r.input("P_u", units="m", symbol="P_u", meaning="coupler point, along AB from A")
planar_4r.input("P_v", units="m", symbol="P_v", meaning="coupler point, to the left of AB")


def declare_link(number: int, link: str, frame: str) -> None:
    """Declare the mass data of a moving link, in its own frame."""
    centre = f"mass centre of the {link}"
    inertia = f"moment of inertia of the {link} about its mass centre"
    massive = partial(planar_4r.input, rule="non-negative")
    massive(f"m{number}", units="kg", symbol=f"m_{number}", meaning=f"mass of the {link}")
    massive(f"I{number}", units="kg m2", symbol=f"I_{number}", meaning=inertia)
    at = partial(planar_4r.input, units="m")
    at(f"G{number}_u", symbol=f"G_{number}u", meaning=f"{centre}, {frame}")
    at(f"G{number}_v", symbol=f"G_{number}v", meaning=f"{centre}, to the left of its axis")


declare_link(1, LINKS[1], "from O along OA")
declare_link(2, LINKS[2], "from A along AB")
declare_link(3, LINKS[3], "from D along DB")


build_on = partial(_build_on, planar_4r)


def plus(replaced: Any, further: Any) -> Any:
    """Add a further term."""
    return replaced + further


def less(replaced: Any, further: Any) -> Any:
    """Take a further term away."""
    return replaced - further
