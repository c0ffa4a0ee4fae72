"""The crank's angular acceleration alpha1, beside its speed omega1, in every configuration.

Rates of the second order gain alpha1 times what a crank that turns at 1 rad/s gives to the first; giving alpha1
chooses these facts. The jerks are those of a constant alpha1.
"""

from __future__ import annotations

from typing import Any

from fastlink.catalogue import BELOW
from fastlink.mechanisms.planar_4r import coupler, joints, loads, rates  # noqa: F401 (declare what is replaced)
from fastlink.mechanisms.planar_4r.declare import HAYES, build_on, planar_4r, plus

ACCELERATED = "acceleration"
SOURCE = f"{HAYES}, eqs. (7) and (8), with alpha_1"

planar_4r.input(
    "alpha1",
    units="rad s-2",
    symbol="alpha_1",
    meaning="angular acceleration of the crank",
    alternative=ACCELERATED,
    default=0.0,
)


@planar_4r.quantity(
    units="rad s-2", symbol="alpha_1/2", source=SOURCE, internal=True, alternative=ACCELERATED
)
def half_alpha1(alpha1: Any) -> Any:
    """Half the input acceleration."""
    return 0.5 * alpha1


#: The laws of the rates for a crank whose speed is the number alpha1.
SCALED = {"half_omega1": "half_alpha1", "odd_rate": "odd_tangent", "mean_rate": "mean_tangent"}
for _name, _symbol, _law, _given in (
    ("mean_tangent", "alpha_1 T/2", rates.mean_rate, SCALED),
    ("odd_tangent", "alpha_1 H/2", rates.odd_rate, SCALED),
    ("tangent2", "alpha_1 omega_2/omega_1", rates.omega2, SCALED),
    ("tangent4", "alpha_1 omega_4/omega_1", rates.omega4, SCALED),
    ("joint_tangent_2", "alpha_1 (omega_2/omega_1 - 1)", joints.joint_omega_2, SCALED),
    ("joint_tangent_3", "alpha_1 (omega_4 - omega_2)/omega_1", joints.joint_omega_3, SCALED),
):
    planar_4r.quantity(
        units="rad s-2",
        symbol=_symbol,
        source=SOURCE,
        internal=True,
        alternative=ACCELERATED,
        name=_name,
        given=_given,
    )(_law)


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
    ("alpha2", plus, "tangent2"),
    ("alpha4", plus, "tangent4"),
    ("joint_alpha_3", plus, "joint_tangent_3"),
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
build_on(
    ACCELERATED, "joint_alpha_2", plus, replaced=f"alpha2{BELOW}{ACCELERATED}", further="joint_tangent_2"
)

planar_4r.quantity(
    units="1",
    symbol="(omega_4/omega_1)'",
    source=SOURCE,
    internal=True,
    alternative=ACCELERATED,
    name="slope4",
    given={"mean_acceleration": "mean_slope", "H_rate": "H_slope", "kappa_rate": "kappa_slope"},
)(rates.alpha4)
for _name, _slope in (("jerk2", "coupler_slope"), ("jerk4", "slope4")):
    build_on(ACCELERATED, _name, jerk, slope=_slope)
