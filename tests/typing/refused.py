"""Calls that type checkers refuse: `mypy` fails where one of these lines is accepted."""

from __future__ import annotations

import fastlink as fl
from fastlink.typing import Planar4rResult

SPACE = fl.grid(a1=0.4, a2=1.1, a3=0.8, a4=1.0, omega1=25.0)

fl.sweep("planar_4R", SPACE, ["omega4_max"], branch=(1, 2))  # type: ignore[call-overload]
fl.sweep("planar_4r", SPACE, ["omega4_max"], theta=72, branch=(1, 2))  # type: ignore[call-overload]
fl.sweep("planar_4r", SPACE, ["omega4_max"], input="theta", branch=(1, 2))  # type: ignore[call-overload]
fl.sweep("slider_crank", SPACE, ["omega2_max"], solver="dense", branch=(1, 2))  # type: ignore[call-overload]
fl.sweep("planar_4r", SPACE, ["omega4_max"], extrema="exact", branch=(1, 2))  # type: ignore[call-overload]
fl.sweep("planar_4r", SPACE, ["omega4_max"], thread=2, branch=(1, 2))  # type: ignore[call-overload]
fl.evaluate("planar_4r", ["omega4"], A1=0.4, theta1=1.0)  # type: ignore[call-overload]
fl.evaluate("hart", ["F_y"], m=1.0, n=0.8, d=1.2, kapa=0.5, phi=0.1)  # type: ignore[call-overload]
fl.function("planar_4r", ["a2"], ["omega4_max"], length_crank=0.4)  # type: ignore[call-overload]
fl.grid(a_1=0.4)  # type: ignore[call-arg]
fl.sobol(64, omega_1=(1.0, 2.0))  # type: ignore[call-arg]
WANTED: list[Planar4rResult] = ["omega5_max"]  # type: ignore[list-item]
