"""The offset slider-crank: crank, connecting rod, and a slider on a line that may miss the crank's pivot."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastlink.mechanisms._shared import laws
from fastlink.mechanisms._shared.picture import Bar, Circle, Force, Guide, Picture, Point, Torque, joint
from fastlink.mechanisms.slider_crank import forces, motion, strokes  # noqa: F401 (they declare its facts)
from fastlink.mechanisms.slider_crank.inputs import BARS, slider_crank

if TYPE_CHECKING:
    from collections.abc import Callable

    from fastlink.facts.catalogue import Catalogue

__all__ = ["DRIVEN", "PICTURE", "slider_crank"]


# -- Further names, in books and drawings, of the quantities and inputs of the slider-crank


_REACTION = "joint force, bearing force, bearing load, pin force, reaction force"

slider_crank.also_called(
    r="crank, crank radius, crank length, throw, a1, l1",
    l="rod, rod length, conrod, connecting rod, a2, l2",
    e="offset, eccentricity",
    omega="rpm, crank speed, angular speed, input speed",
    m3="piston mass",
    I1="J1, crank inertia",
    I2="J2, rod inertia",
    G1_u="centre of gravity, centre of mass of the crank, cog",
    G2_u="centre of mass of the rod",
    radius="bar radius, diameter, thickness, cross section",
    density="material, steel",
    F_load="load, external force, applied force, gas force, piston force",
)
slider_crank.also_called(
    slider_position="displacement, piston travel",
    slider_velocity="piston speed",
    theta2="rod angle",
    transmission_angle="pressure angle, force transmission",
    transmission_angle_least="worst transmission angle",
    T41="torque, driving torque, input torque, crank torque, motor torque, M41, T14",
    F41=f"{_REACTION}, main bearing force, ground reaction, reaction at O, F14",
    F21=f"{_REACTION}, crank pin force, reaction at A, F12",
    F32=f"{_REACTION}, wrist pin force, gudgeon pin force, piston pin force, reaction at B, F23",
    side_force="side thrust, guide force, normal force, F34",
    shaking_force="frame force, unbalance, balancing",
    shaking_moment="frame moment, shaking torque",
    input_power="power, motor power",
    T41_fluctuation="coefficient of fluctuation, flywheel, energy fluctuation",
    outer_dead_centre="top dead centre, TDC, dead centre",
    inner_dead_centre="bottom dead centre, BDC, dead centre",
    theta_outer="top dead centre angle",
    theta_inner="bottom dead centre angle",
    theta_low="limit angle, toggle angle, toggle position, singularity",
    theta_high="limit angle, toggle angle, toggle position, singularity",
    grashof_class="grashof condition, linkage type",
    time_ratio="quick return, advance to return ratio",
    stroke="travel, lift",
    status="feasible, feasibility, valid, assembles, assembly, closes",
    loop_residual="closure error, constraint violation",
)


# -- Crank and connecting rod made of a round bar; the slider's mass is given


laws.declare(slider_crank, BARS)


# -- The picture of the slider-crank: see docs/slider_crank.md


PICTURE = Picture(
    points=(Point("O", 0.0, 0.0, "ground"), joint("A"), Point("B", "slider_position", "e", "slider")),
    bars=(Bar("O A", {"O A": "r"}), Bar("A B", {"A B": "l"})),
    circles=(Circle("O", "r"),),
    guides=(Guide(y="e", slider="B"),),
    usual="limits",
    forces=(Force("F41", "O"), Force("F21", "A"), Force("F32", "B")),
    torques=(Torque("T41", "O"),),
)

#: No other input drives it.
DRIVEN: dict[str, Callable[[], Catalogue]] = {}
