"""A load on the slider along its line: there only if the design gives it."""

from __future__ import annotations

from functools import partial
from typing import Any

from fastlink.mechanisms._shared.reuse import build_on
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


build = partial(build_on, slider_crank, LOAD, source=f"{PAGE}#load")
build("F32_x", plus_load)
build("T41", less_load_torque)
build("shaking_force_x", plus_load)
build("shaking_moment", less_load_moment)
