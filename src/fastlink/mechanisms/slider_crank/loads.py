"""A load on the slider along its line: there only if the design gives it."""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms.slider_crank import shaking  # noqa: F401 (declare what is replaced)
from fastlink.mechanisms.slider_crank.inputs import PAGE, slider_crank

LOAD = "slider_load"

slider_crank.input(
    "F_load",
    units="N",
    symbol="F_load",
    meaning="load on the slider at B along its line, x",
    variant=LOAD,
    default=0.0,
)


def plus_load(replaced: Any, F_load: Any) -> Any:
    """Add the load."""
    return replaced + F_load


def less_load_moment(replaced: Any, F_load: Any, e: Any) -> Any:
    """Take the moment e F_load away."""
    return replaced - e * F_load


def less_load_torque(replaced: Any, F_load: Any, x_slope: Any) -> Any:
    """Take the torque away that the load gives the crank."""
    return replaced - F_load * x_slope


for _name, _law in (
    ("F32_x", plus_load),
    ("T41", less_load_torque),
    ("shaking_force_x", plus_load),
    ("shaking_moment", less_load_moment),
):
    _fact = slider_crank.facts[_name]
    slider_crank.quantity(
        units=_fact.units,
        symbol=_fact.symbol,
        source=f"{PAGE}#load",
        internal=True,
        variant=LOAD,
        name=_name,
        meaning=_fact.meaning,
        given={"replaced": _name},
    )(_law)
