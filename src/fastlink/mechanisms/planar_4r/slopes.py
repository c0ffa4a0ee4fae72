"""Derivatives by the input angle in closed form.

Derivatives of all facts are generated (`fastlink.symbolic.derivative`); those here are declared because a generated one
would subtract nearly equal numbers near toggles or change points, or cost more. With n2 = omega2/omega1,
n4 = omega4/omega1 and ' = d/dtheta1

    AB' = J n2 AB,   DB' = J n4 DB,   theta2' = n2,   n2' = coupler_slope,   n2'' = coupler_bend,

and alike for n4. They hold at constant omega1 and where the position is graded too.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms.planar_4r import coupler, joints, position, rates  # noqa: F401 (whose derivatives these are)
from fastlink.mechanisms.planar_4r.declare import NUMERICS, planar_4r
from fastlink.numerics.elementary import INFINITY, select

RATES = f"{NUMERICS}#rates"


for _name, _of, _symbol, _law, _given in (
    ("output_ratio", "omega4/omega1", "n_4", rates.omega4, {"mean_rate": "mean_ratio", "odd_rate": "half_H"}),
    (
        *("output_slope", "derivative of omega4/omega1 by the input angle", "n_4'", rates.alpha4),
        {"mean_acceleration": "mean_slope", "H_rate": "H_slope", "kappa_rate": "kappa_slope"},
    ),
):
    planar_4r.quantity(
        units="1", symbol=_symbol, source=RATES, internal=True, name=_name, meaning=_of, given=_given
    )(_law)


@planar_4r.quantity(units="1", symbol="n - 1", source=RATES, internal=True)
def joint_ratio_2(
    half_H: Any, coupler_share: Any, ground_excess: Any, Z: Any, per_gamma: Any, branch_sign: Any
) -> Any:
    """Rate of the second joint angle over omega1."""
    return branch_sign * (half_H * coupler_share) - 0.5 * ((ground_excess + Z) * per_gamma)


@planar_4r.quantity(units="1", symbol="n_4 - n", source=RATES, internal=True)
def joint_ratio_3(H: Any, branch_sign: Any) -> Any:
    """Rate of the third joint angle over omega1."""
    return branch_sign * H


@planar_4r.quantity(units="1", symbol="-n_4", source=RATES, internal=True)
def joint_ratio_4(output_ratio: Any) -> Any:
    """Rate of the fourth joint angle over omega1."""
    return -output_ratio


# -- declared derivatives ------------------------------------------------------------------------------


def same(x: Any) -> Any:
    """Return x."""
    return x


def opposite(x: Any) -> Any:
    """Return -x."""
    return -x


def twice(x: Any) -> Any:
    """Return 2 x."""
    return 2.0 * x


def opposite_product(x: Any, y: Any) -> Any:
    """Return -x y."""
    return -(x * y)


def half_tangent(v: Any, ratio: Any) -> Any:
    """Derivative of the tangent of half an angle."""
    return (0.5 + 0.5 * (v * v)) * ratio


def sigma_slope(half_sine: Any, p: Any, q: Any, per_sigma: Any) -> Any:
    """Derivative of sqrt(p q)."""
    return 0.5 * (half_sine * (q - p)) * per_sigma


def half_tangent_1(Z: Any) -> Any:
    """Derivative of -cot(theta1/2)."""
    return select(Z == 0.0, INFINITY, 0.5 / Z)


for _set in (None, "graded"):
    for _of, _sign, _need in (
        ("Z", same, "half_sine"),
        ("C", opposite, "half_sine"),
        ("p", same, "half_sine"),
        ("q", opposite, "half_sine"),
        ("sin_theta1", same, "cos_theta1"),
        ("cos_theta1", opposite, "sin_theta1"),
    ):
        planar_4r.derivative(_of, "theta1", given={"x": _need}, alternative=_set)(_sign)

for _of, _need in (
    ("transmission_angle", "H"),
    ("half_H", "H_slope"),
    ("H_slope", "H_bend"),
    ("mean_ratio", "mean_slope"),
    ("mean_slope", "mean_bend"),
    ("theta2", "coupler_ratio"),
    ("coupler_ratio", "coupler_slope"),
    ("coupler_slope", "coupler_bend"),
    ("theta4", "output_ratio"),
    ("output_ratio", "output_slope"),
    ("output_slope", "output_bend"),
    *((f"joint_angle_{_i}", f"joint_ratio_{_i}") for _i in (2, 3, 4)),
):
    planar_4r.derivative(_of, "theta1", given={"x": _need})(same)

for _of, _x, _y in (
    ("omega2", "omega1", "coupler_slope"),
    ("omega4", "omega1", "output_slope"),
    ("joint_omega_2", "omega1", "coupler_slope"),
    ("alpha2", "omega1_squared", "coupler_bend"),
    ("alpha4", "omega1_squared", "output_bend"),
    ("H_rate", "omega1_squared", "H_bend"),
    ("AB_y", "coupler_ratio", "AB_x"),
    ("DB_y", "output_ratio", "DB_x"),
    ("B_y", "output_ratio", "DB_x"),
    ("AB_v", "joint_ratio_2", "AB_u"),
):
    planar_4r.derivative(_of, "theta1", given={"x": _x, "y": _y})(rates.product)

for _of, _x, _y in (
    ("AB_x", "coupler_ratio", "AB_y"),
    ("DB_x", "output_ratio", "DB_y"),
    ("B_x", "output_ratio", "DB_y"),
    ("AB_u", "joint_ratio_2", "AB_v"),
):
    planar_4r.derivative(_of, "theta1", given={"x": _x, "y": _y})(opposite_product)

for _i in (2, 3, 4):
    planar_4r.derivative(f"v{_i}", "theta1", given={"v": f"v{_i}", "ratio": f"joint_ratio_{_i}"})(
        half_tangent
    )

planar_4r.derivative("H", "theta1", given={"x": "H_slope"})(twice)
planar_4r.derivative("sigma", "theta1")(sigma_slope)
planar_4r.derivative("v1", "theta1")(half_tangent_1)
