"""The planar 4R: its inputs and its two assembly modes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastlink.catalogue.catalogue import Catalogue, Input

HAYES = "Hayes, Hninn, Irani"
NUMERICS = "docs/numerics.md"

#: The moving links by number.
LINKS = {1: "crank OA", 2: "coupler AB", 3: "output link DB"}
LINK_FRAMES = {1: "from O along OA", 2: "from A along AB", 3: "from D along DB"}

planar_4r = Catalogue(
    "planar_4r",
    "Euclidean planar four-bar linkage with four revolute joints, driven at O",
    branches={
        1: "B to the right of the directed line from A to D",
        2: "B to the left of the directed line from A to D",
    },
    position=Input("theta1", "rad", "theta_1", "input angle: direction of OA in the ground frame"),
)

for _name, _meaning in (
    ("a1", "length of the input crank OA"),
    ("a2", "length of the coupler AB"),
    ("a3", "length of the output link DB"),
    ("a4", "length of the ground link OD"),
):
    planar_4r.input(_name, units="m", symbol=f"a_{_name[1]}", meaning=_meaning, rule="positive")

planar_4r.input(
    "omega1", units="rad s-1", symbol="omega_1", meaning="angular velocity of the crank, constant"
)

for _axis, _where in (("u", "along AB from A"), ("v", "to the left of AB")):
    planar_4r.input(f"P_{_axis}", units="m", symbol=f"P_{_axis}", meaning=f"coupler point, {_where}")

for _i, _link in LINKS.items():
    planar_4r.input(
        f"m{_i}", units="kg", symbol=f"m_{_i}", meaning=f"mass of the {_link}", rule="non-negative"
    )
    planar_4r.input(
        f"I{_i}",
        units="kg m2",
        symbol=f"I_{_i}",
        meaning=f"moment of inertia of the {_link} about its mass centre",
        rule="non-negative",
    )
    planar_4r.input(
        f"G{_i}_u", units="m", symbol=f"G_{_i}u", meaning=f"mass centre of the {_link}, {LINK_FRAMES[_i]}"
    )
    planar_4r.input(
        f"G{_i}_v",
        units="m",
        symbol=f"G_{_i}v",
        meaning=f"mass centre of the {_link}, to the left of its axis",
    )


def build_on(chosen: str, name: str, law: Callable[..., Any], **given: str) -> None:
    """Let a set of facts replace `name` by a law of what it replaces (the parameter `replaced`), labels kept."""
    base = planar_4r.facts[name]
    planar_4r.quantity(
        units=base.units,
        symbol=base.symbol,
        source=base.source,
        internal=True,
        alternative=chosen,
        name=name,
        meaning=base.meaning,
        given={"replaced": name, **given},
    )(law)


def plus(replaced: Any, further: Any) -> Any:
    """Add a further term."""
    return replaced + further


def less(replaced: Any, further: Any) -> Any:
    """Take a further term away."""
    return replaced - further
