"""The offset slider-crank: crank, connecting rod, and a slider on a line that may miss the crank's pivot.

Its facts stand in the sheets beside this file. The crank OA of length r turns about O = (0, 0), the connecting rod AB
of length l moves the slider B on the line y = e, which is parallel to the x axis. Links are numbered as in the planar
4R: 1 the crank, 2 the rod, 3 the slider, 4 the ground.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import GradedRange, Input, KnownExtremes
from fastlink.facts.sheet import read_sheets
from fastlink.mechanisms._shared.borrow import borrow
from fastlink.mechanisms._shared.picture import Bar, Circle, Force, Guide, Picture, Point, Torque, joint
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.numerics.elementary import PI

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["DRIVEN", "PICTURE", "slider_crank"]

slider_crank = Catalogue(
    "slider_crank",
    "Offset slider-crank: a crank at O, a connecting rod, and a slider on the line y = e",
    branches={
        1: "slider to the right of the crank pin A: its x is greater",
        2: "slider to the left of the crank pin A: its x is less",
    },
    position=Input("theta", "rad", "theta", "crank angle; direction of OA, from the line of the slider"),
)
slider_crank.closes = ("sigma", "p", "q")
slider_crank.most_asked = (
    "slider_position slider_velocity slider_acceleration slider_acceleration_peak theta2 omega2 "
    "transmission_angle least_transmission_angle stroke time_ratio grashof_class status outer_dead_centre "
    "inner_dead_centre T41 T41_peak side_force_peak F41_max F32_max shaking_force_max"
)
read_sheets(__file__, ("inputs", "motion", "strokes", "forces"), slider_crank)

# What the planar 4R says of its crank, its coupler and their joints holds here, too; the coupler is the rod.

NAMES = {"a1": "r", "a2": "l", "theta1": "theta", "omega1": "omega", "omega1_squared": "omega_squared"}
NAMES |= {"cos_theta1": "cos_theta", "sin_theta1": "sin_theta"}
NAMES |= {name: name for name in ("A_x", "A_y", "AB_x", "AB_y", "p2_x", "p2_y", "F32_x", "F32_y")}
FORCES = "docs/slider_crank.md#forces"
LABELS = {
    name: {
        "meaning": planar_4r.facts[name].meaning.replace("coupler", "connecting rod"),
        "source": f"Hayes, Hninn, Irani, eq. (9) of crank and coupler; {FORCES}",
    }
    for name in ("F21_x", "F21_y", "F41_x", "F41_y", "F41", "F21")
}
LABELS["F32"] = {"meaning": "Force of the slider on the connecting rod at B; its magnitude", "source": FORCES}
LABELS |= {name: {} for name in ("p1_x", "p1_y", "AG_x", "AG_y", "G2_along", "G2_across")}
borrow(slider_crank, planar_4r, NAMES, "", LABELS)

#: Half the number of cells for what has at most two extremes: see docs/slider_crank.md.
SIMPLE = ("slider_position", "theta2", "omega2", "transmission_angle")
slider_crank.graded = GradedRange(
    bounded_factor="sine_mu",
    cells=dict.fromkeys(SIMPLE, 16),
    max_extrema=dict.fromkeys(SIMPLE, 2),
    not_differentiable=("loop_residual",),
    wraps_at={"theta2": "AB_y"},
    poles={
        "mechanical_advantage": ("x_slope",),
        **dict.fromkeys(("instant_centre_x", "instant_centre_y"), ("half_cosine",)),
    },
    axis=PI / 2,
    known={
        "slider_position": KnownExtremes({1: ("place_inner",), 2: ("place_outer",)}),
        "A_x": KnownExtremes({1: ("place_along",), 2: ("place_along",)}),
        "theta2": KnownExtremes(jumps={2: ("place_on_line",)}, exchanged=False),
        **dict.fromkeys(("transmission_angle", "A_y"), KnownExtremes()),
    },
)

#: See docs/slider_crank.md.
PICTURE = Picture(
    points=(Point("O", 0.0, 0.0, "ground"), joint("A"), Point("B", "slider_position", "e", "slider")),
    bars=(Bar("O A", {"O A": "r"}), Bar("A B", {"A B": "l"})),
    circles=(Circle("O", "r"),),
    guides=(Guide(y="e", slider="B"),),
    usual="limits",
    title="slider-crank, {grashof_class}, stroke {stroke}",
    forces=(Force("F41", "O"), Force("F21", "A"), Force("F32", "B")),
    torques=(Torque("T41", "O"),),
)

#: No other input drives it.
DRIVEN: dict[str, Callable[[], Catalogue]] = {}
