"""The crank's angular acceleration alpha1, beside its speed omega1, in every configuration.

Accelerations gain alpha1 times the ratio of the velocities to omega1; giving alpha1 chooses these facts. The
jerks are those of a constant alpha1.
"""

from __future__ import annotations

from typing import Any

from fastlink.facts.names import Below, Quantity
from fastlink.mechanisms.planar_4r import coupler, joints, loads, slopes  # noqa: F401 (declare what is replaced)
from fastlink.mechanisms.planar_4r.declare import build_on, planar_4r

ACCELERATED = "acceleration"

planar_4r.input(
    "alpha1",
    units="rad s-2",
    symbol="alpha_1",
    meaning="angular acceleration of the crank",
    alternative=ACCELERATED,
    default=0.0,
)


def plus_product(replaced: Any, alpha1: Any, further: Any) -> Any:
    """Add alpha1 times a further term."""
    return replaced + alpha1 * further


def less_product(replaced: Any, alpha1: Any, further: Any) -> Any:
    """Take alpha1 times a further term away."""
    return replaced - alpha1 * further


def jerk(replaced: Any, omega1: Any, alpha1: Any, slope: Any) -> Any:
    """Angular jerk of a link at constant alpha1."""
    return replaced + (3.0 * (omega1 * alpha1)) * slope


for _name, _law, _further in (
    ("alpha2", plus_product, "coupler_ratio"),
    ("alpha4", plus_product, "output_ratio"),
    ("joint_alpha_3", plus_product, "joint_ratio_3"),
    ("a_Ax", less_product, "A_y"),
    ("a_Ay", plus_product, "A_x"),
    ("P_ax", plus_product, "P_dx"),
    ("P_ay", plus_product, "P_dy"),
    ("p1_x", less_product, "m1_OG_y"),
    ("p1_y", plus_product, "m1_OG_x"),
    ("couple1", plus_product, "I1_G"),
    ("T41", plus_product, "I1_O"),
    ("shaking_moment", less_product, "I1_O"),
):
    build_on(ACCELERATED, _name, _law, further=_further)

# theta2 - theta1 gains a difference of its own, which does not cancel.
steady = str(Below(Quantity("alpha2"), ACCELERATED))
build_on(ACCELERATED, "joint_alpha_2", plus_product, replaced=steady, further="joint_ratio_2")

for _name, _slope in (("jerk2", "coupler_slope"), ("jerk4", "output_slope")):
    build_on(ACCELERATED, _name, jerk, slope=_slope)
