"""Derivatives by the input angle in closed form.

Derivatives of all facts are generated (`fastlink.symbolic.derivative`); those here are declared because a generated one
would subtract nearly equal numbers near toggles or change points, or cost more. With n2 = omega2/omega1,
n4 = omega4/omega1 and ' = d/dtheta1

    AB' = J n2 AB,   DB' = J n4 DB,   theta2' = n2,   n2' = coupler_slope,   n2'' = coupler_bend,

and alike for n4. They hold at constant omega1 and where the position is graded too.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import opposite, opposite_product, product, same, twice
from fastlink.mechanisms.planar_4r import coupler, joints, position, rates  # noqa: F401 (whose derivatives these are)
from fastlink.mechanisms.planar_4r.inputs import NUMERICS, planar_4r
from fastlink.numerics.elementary import INFINITY, select

RATES = f"{NUMERICS}#rates"


step = planar_4r.steps(units="1", source=RATES)
_SLOPE = "derivative of omega4/omega1 by the input angle"
step(rates.link_rate, "output_ratio", "n_4", "omega4/omega1", share="output_share", **coupler.RATIO)
step(rates.link_acceleration, "output_slope", "n_4'", _SLOPE, share="output_share", **coupler.SLOPE)


@planar_4r.quantity(units="1", symbol="n - 1", source=RATES, internal=True)
def joint_ratio_2(
    half_H: Any, coupler_share: Any, ground_excess: Any, Z: Any, per_gamma: Any, branch_sign: Any
) -> Any:
    """Rate of the second joint angle over omega1."""
    return branch_sign * (half_H * coupler_share) - 0.5 * ((ground_excess + Z) * per_gamma)


step(product, "joint_ratio_3", "n_4 - n", "Rate of the third joint angle over omega1", x="branch_sign", y="H")
step(opposite, "joint_ratio_4", "-n_4", "Rate of the fourth joint angle over omega1", x="output_ratio")


# -- declared derivatives ------------------------------------------------------------------------------


def half_tangent(v: Any, ratio: Any) -> Any:
    """Derivative of the tangent of half an angle."""
    return (0.5 + 0.5 * (v * v)) * ratio


def sigma_slope(half_sine: Any, p: Any, q: Any, per_sigma: Any) -> Any:
    """Derivative of sqrt(p q)."""
    return 0.5 * (half_sine * (q - p)) * per_sigma


def half_tangent_1(Z: Any) -> Any:
    """Derivative of -cot(theta1/2)."""
    return select(Z == 0.0, INFINITY, 0.5 / Z)


# of tables, and of the facts that replace them in the graded range
for _set in (None, "graded"):
    derivative = planar_4r.derivatives("theta1", variant=_set)
    derivative(same, "Z", x="half_sine")
    derivative(opposite, "C", x="half_sine")
    derivative(same, "p", x="half_sine")
    derivative(opposite, "q", x="half_sine")
    derivative(same, "sin_theta1", x="cos_theta1")
    derivative(opposite, "cos_theta1", x="sin_theta1")

derivative = planar_4r.derivatives("theta1")
derivative(same, "transmission_angle", x="H")
derivative(same, "half_H", x="H_slope")
derivative(same, "H_slope", x="H_bend")
derivative(same, "mean_ratio", x="mean_slope")
derivative(same, "mean_slope", x="mean_bend")
derivative(same, "theta2", x="coupler_ratio")
derivative(same, "coupler_ratio", x="coupler_slope")
derivative(same, "coupler_slope", x="coupler_bend")
derivative(same, "theta4", x="output_ratio")
derivative(same, "output_ratio", x="output_slope")
derivative(same, "output_slope", x="output_bend")
derivative(same, "joint_angle_2", x="joint_ratio_2")
derivative(same, "joint_angle_3", x="joint_ratio_3")
derivative(same, "joint_angle_4", x="joint_ratio_4")
derivative(product, "omega2", x="omega1", y="coupler_slope")
derivative(product, "omega4", x="omega1", y="output_slope")
derivative(product, "joint_omega_2", x="omega1", y="coupler_slope")
derivative(product, "alpha2", x="omega1_squared", y="coupler_bend")
derivative(product, "alpha4", x="omega1_squared", y="output_bend")
derivative(product, "H_rate", x="omega1_squared", y="H_bend")
derivative(same, "joint_ratio_2", x="coupler_slope")
derivative(product, "AB_y", x="coupler_ratio", y="AB_x")
derivative(product, "DB_y", x="output_ratio", y="DB_x")
derivative(product, "B_y", x="output_ratio", y="DB_x")
derivative(product, "AB_v", x="joint_ratio_2", y="AB_u")
derivative(opposite_product, "AB_x", x="coupler_ratio", y="AB_y")
derivative(opposite_product, "DB_x", x="output_ratio", y="DB_y")
derivative(opposite_product, "B_x", x="output_ratio", y="DB_y")
derivative(opposite_product, "AB_u", x="joint_ratio_2", y="AB_v")
derivative(half_tangent_1, "v1")
derivative(half_tangent, "v2", v="v2", ratio="joint_ratio_2")
derivative(half_tangent, "v3", v="v3", ratio="joint_ratio_3")
derivative(half_tangent, "v4", v="v4", ratio="joint_ratio_4")
derivative(twice, "H", x="H_slope")
derivative(sigma_slope, "sigma")
