"""The crank's angular acceleration alpha1, beside its speed omega1, in every configuration.

Accelerations gain alpha1 times the ratio of the velocities to omega1; giving alpha1 chooses these facts. The
jerks are those of a constant alpha1.
"""

from __future__ import annotations

from typing import Any

from fastlink.facts.names import Below, Quantity
from fastlink.mechanisms.planar_4r import angle_derivatives, coupler, forces, joints, loads  # noqa: F401 (declare what is replaced)
from fastlink.mechanisms.planar_4r.inputs import build_on, planar_4r

ACCELERATED = "acceleration"

planar_4r.input(
    "alpha1",
    units="rad s-2",
    symbol="alpha_1",
    meaning="angular acceleration of the crank",
    variant=ACCELERATED,
    default=0.0,
)


def mass_times_dot(mass: Any, A_x: Any, A_y: Any, x: Any, y: Any) -> Any:
    """Mass times the scalar product of the crank pin and a vector."""
    return mass * (A_x * x + A_y * y)


step = planar_4r.steps(units="kg m2", source=forces.REACTIONS, variant=ACCELERATED)
_A = "Mass of the coupler times the scalar product of A and"
step(mass_times_dot, "m2_A_dot_AG", "m_2 A . AG_2", f"{_A} AG", mass="m2", x="AG_x", y="AG_y")
step(mass_times_dot, "m2_A_dot_OG", "m_2 A . OG_2", f"{_A} OG", mass="m2", x="G2_x", y="G2_y")
step(
    mass_times_dot,
    "m2_A_dot_arm",
    "m_2 A . (A + n AG_2)",
    f"{_A} A + n AG",
    mass="m2",
    x="arm2_x",
    y="arm2_y",
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


build_on(ACCELERATED, "alpha2", plus_product, further="coupler_ratio")
build_on(ACCELERATED, "alpha4", plus_product, further="output_ratio")
build_on(ACCELERATED, "joint_alpha_3", plus_product, further="joint_ratio_3")
build_on(ACCELERATED, "v1_ddot", plus_product, further="v1_slope")
build_on(ACCELERATED, "a_Ax", less_product, further="A_y")
build_on(ACCELERATED, "a_Ay", plus_product, further="A_x")
build_on(ACCELERATED, "P_ax", plus_product, further="P_dx")
build_on(ACCELERATED, "P_ay", plus_product, further="P_dy")
build_on(ACCELERATED, "G1_ax", less_product, further="OG_y")
build_on(ACCELERATED, "G1_ay", plus_product, further="OG_x")
build_on(ACCELERATED, "p1_x", less_product, further="m1_OG_y")
build_on(ACCELERATED, "p1_y", plus_product, further="m1_OG_x")
build_on(ACCELERATED, "inertia_moment1", plus_product, further="I1_G")
build_on(ACCELERATED, "moment2_A", plus_product, further="m2_A_dot_AG")
build_on(ACCELERATED, "spin_rate2", plus_product, further="m2_A_dot_OG")
build_on(ACCELERATED, "torque2", plus_product, further="m2_A_dot_arm")
build_on(ACCELERATED, "T41", plus_product, further="I1_O")
build_on(ACCELERATED, "shaking_moment", less_product, further="I1_O")
build_on(ACCELERATED, "jerk2", jerk, slope="coupler_slope")
build_on(ACCELERATED, "jerk4", jerk, slope="output_slope")

# theta2 - theta1 gains a difference of its own, which does not cancel.
steady = str(Below(Quantity("alpha2"), ACCELERATED))
build_on(ACCELERATED, "joint_alpha_2", plus_product, replaced=steady, further="joint_ratio_2")
