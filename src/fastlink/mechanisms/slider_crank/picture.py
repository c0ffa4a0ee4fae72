"""The picture of the slider-crank: see docs/slider_crank.md."""

from __future__ import annotations

from fastlink.mechanisms._shared.picture import Bar, Circle, Force, Guide, Picture, Point, Torque, joint

__all__ = ["PICTURE"]

PICTURE = Picture(
    points=(Point("O", 0.0, 0.0, "ground"), joint("A"), Point("B", "slider_position", "e", "slider")),
    bars=(Bar("O A", {"O A": "r"}), Bar("A B", {"A B": "l"})),
    circles=(Circle("O", "r"),),
    guides=(Guide(y="e", slider="B"),),
    usual="limits",
    forces=(Force("F41", "O"), Force("F21", "A"), Force("F32", "B")),
    torques=(Torque("T41", "O"),),
)
