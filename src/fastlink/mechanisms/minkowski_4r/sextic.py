"""By how much a traced coupler point misses the coupler sextic.

The sextic is N(W) + 4 V^2 = 0 as `fastlink.minkowski.sextic` has it, here in null coordinates, in which products are
formed coordinate by coordinate, with W and V times h, and over powers of r, so that nothing overflows.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared import lengths
from fastlink.mechanisms.minkowski_4r import position  # noqa: F401 (on which it builds)
from fastlink.mechanisms.minkowski_4r.inputs import HEGEDUS, NUMERICS, minkowski_4r

SEXTIC = f"{NUMERICS}#sextic"


def first_null(along: Any, across: Any, side: Any) -> Any:
    """Return the first null coordinate of a point of the coupler, for abs(theta)."""
    return along + side * across


def second_null(along: Any, across: Any, side: Any) -> Any:
    """Return the second null coordinate."""
    return along - side * across


def traced(crank: Any, input_null: Any, along: Any, coupler_null: Any) -> Any:
    """Return a null coordinate of the coupler point in the ground frame."""
    return crank * input_null + along * coupler_null


step = minkowski_4r.steps(units="1", source=SEXTIC)
step(lengths.scaled, "s_x", "s_x", "scaled coupler point along AB", length="x")
step(lengths.scaled, "s_y", "s_y", "scaled coupler point across AB", length="y")
step(first_null, "s_u", "s_u", "first null coordinate of X in the coupler", along="s_x", across="s_y")
step(second_null, "s_v", "s_v", "second null coordinate of X in the coupler", along="s_x", across="s_y")
_U = {"crank": "s_a", "input_null": "p_r", "along": "s_u", "coupler_null": "AB_u"}
_V = {"crank": "s_a", "input_null": "per_p", "along": "s_v", "coupler_null": "AB_v"}
step(traced, "X_u", "X_u", "first null coordinate of X, scaled, times r", **_U)
step(traced, "X_v", "X_v", "second null coordinate of X, scaled", **_V)


@minkowski_4r.quantity(units="1", symbol="f", source=f"{HEGEDUS}, eq. (14), section 3.5; {SEXTIC}")
def sextic_residual(
    s_a: Any, s_b: Any, s_g: Any, s_h: Any, s_x: Any, s_y: Any, s_u: Any, s_v: Any, X_u: Any, X_v: Any,
    r: Any, side: Any,
) -> Any:  # fmt: skip
    """Value of the coupler sextic at the traced point, relative to the sizes of its terms."""
    k = s_u * s_v - s_a * s_a
    k_size = abs(s_u * s_v) + s_a * s_a
    c = (2.0 * (s_h * s_x) - s_a * s_a - s_h * s_h) + (s_b - s_g) * (s_b + s_g)
    c_size = (2.0 * (s_h * abs(s_x)) + s_a * s_a + s_h * s_h) + (s_b * s_b + s_g * s_g)
    norm = X_u * X_v
    norm_size = abs(norm)
    u, v = abs(X_u), abs(X_v)
    first = s_h * (norm + k * r) * (X_u - s_g * r) - s_v * ((s_g * X_u + c * r) * X_u - k * s_g * r * r)
    second = s_h * (norm + k * r) * (X_v - s_g) - s_u * r * ((s_g * X_v + c) * X_v - k * s_g)
    across = s_g * (0.5 * (X_u - X_v * r)) * (s_u * s_v - s_h * s_x) * side
    along = s_h * s_y * (norm - s_g * (0.5 * (X_u + X_v * r)))
    first_size = s_h * (norm_size + k_size * r) * (u + s_g * r)
    first_size = first_size + abs(s_v) * ((s_g * u + c_size * r) * u + k_size * s_g * r * r)
    second_size = s_h * (norm_size + k_size * r) * (v + s_g)
    second_size = second_size + abs(s_u) * r * ((s_g * v + c_size) * v + k_size * s_g)
    third_size = s_g * (0.5 * (u + v * r)) * (abs(s_u * s_v) + s_h * abs(s_x))
    third_size = third_size + s_h * abs(s_y) * (norm_size + s_g * (0.5 * (u + v * r)))
    third = across - along
    value = first * second + 4.0 * r * (third * third)
    return value / (first_size * second_size + 4.0 * r * (third_size * third_size))
