"""Derivatives by the crank angle in closed form.

Derivatives of all facts are generated; those here are declared because a generated one would subtract nearly equal
numbers near toggles or change points, or cost more. They hold where the position is graded too.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import opposite, opposite_product, product, same
from fastlink.mechanisms.slider_crank import position, rates  # noqa: F401 (whose derivatives these are)
from fastlink.mechanisms.slider_crank.inputs import slider_crank


def sigma_slope(half_cosine: Any, drop: Any, per_sigma: Any) -> Any:
    """Derivative of sqrt(p q)."""
    return 0.5 * (half_cosine * (drop * per_sigma))


def sigma_by_e(drop: Any, per_sigma: Any, r: Any) -> Any:
    """Derivative of sqrt(p q) by the offset."""
    return -0.25 * (drop * per_sigma) / r


def bend_by_e(drop: Any, s_e: Any, s_r: Any, sin_theta: Any, bend: Any, per_2_r: Any, per_sigma: Any) -> Any:
    """Derivative of N/sigma^2 by the offset."""
    of_N = (s_e / s_r) * sin_theta - 0.5 * (1.0 + sin_theta * sin_theta)
    return ((of_N + bend * drop) * per_sigma) * (per_2_r * per_sigma)


def bend_rate_by_e(drop: Any, bend_rate: Any, per_2_r: Any, per_sigma: Any) -> Any:
    """Derivative of N'/(sigma^2 cos(theta)) by the offset."""
    return ((1.0 + bend_rate) * (drop * per_sigma)) * (per_2_r * per_sigma)


def transmission_slope(half_cosine: Any, per_sigma: Any) -> Any:
    """Derivative of the transmission angle."""
    return -(half_cosine * per_sigma)


# w^2 = l^2 - AB_y^2 for the length w of the rod along the line, AB_x = s w, and cos(mu) = -AB_y/l


def rod_by_r(AB_y: Any, sin_theta: Any, per_AB_x: Any) -> Any:
    """Derivative of AB_x by the crank."""
    return (AB_y * per_AB_x) * sin_theta


def rod_by_l(l: Any, per_AB_x: Any) -> Any:
    """Derivative of AB_x by the rod."""
    return l * per_AB_x


def rod_by_e(AB_y: Any, per_AB_x: Any) -> Any:
    """Derivative of AB_x by the offset."""
    return -(AB_y * per_AB_x)


def transmission_by_r(sin_theta: Any, per_2_r: Any, per_sigma: Any) -> Any:
    """Derivative of the transmission angle by the crank."""
    return -(sin_theta * (per_2_r * per_sigma))


def transmission_by_l(AB_y: Any, l: Any, per_2_r: Any, per_sigma: Any) -> Any:
    """Derivative of the transmission angle by the rod."""
    return -((AB_y / l) * (per_2_r * per_sigma))


def transmission_by_e(per_2_r: Any, per_sigma: Any) -> Any:
    """Derivative of the transmission angle by the offset."""
    return per_2_r * per_sigma


for _set in (None, "graded"):
    derivative = slider_crank.derivatives("theta", variant=_set)
    derivative(opposite, "Z", x="half_cosine")
    derivative(same, "C", x="half_cosine")
    derivative(opposite, "p", x="half_cosine")
    derivative(same, "q", x="half_cosine")
    derivative(same, "sin_theta", x="cos_theta")
    derivative(opposite, "cos_theta", x="sin_theta")

derivative = slider_crank.derivatives("theta")
derivative(same, "H", x="H_slope")
derivative(same, "H_slope", x="H_bend")
derivative(opposite, "theta2", x="H")
derivative(same, "slider_position", x="x_slope")
derivative(same, "x_slope", x="x_bend")
derivative(same, "x_bend", x="x_third")
derivative(opposite, "AB_y", x="A_x")
derivative(opposite, "drop", x="cos_theta")
derivative(product, "slider_velocity", x="omega", y="x_bend")
derivative(product, "slider_acceleration", x="omega_squared", y="x_third")
derivative(opposite_product, "omega2", x="omega", y="H_slope")
derivative(opposite_product, "alpha2", x="omega_squared", y="H_bend")
derivative(product, "AB_x", x="H", y="AB_y")
derivative(sigma_slope, "sigma")
derivative(transmission_slope, "transmission_angle")

derivative = slider_crank.derivatives("r")
derivative(rod_by_r, "AB_x")
derivative(transmission_by_r, "transmission_angle")

derivative = slider_crank.derivatives("l")
derivative(rod_by_l, "AB_x")
derivative(transmission_by_l, "transmission_angle")

derivative = slider_crank.derivatives("e")
derivative(sigma_by_e, "sigma")
derivative(bend_by_e, "bend")
derivative(bend_rate_by_e, "bend_rate")
derivative(rod_by_e, "AB_x")
derivative(transmission_by_e, "transmission_angle")
