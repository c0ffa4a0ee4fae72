"""Coefficients and residuals of the six input-output equations.

The residuals are homogeneous: v_i = sin/cos of half the joint angle, multiplied by cos^2 cos^2 and divided by
the squared sum of the lengths, so that they are finite at straight joints too and comparable between designs.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms.planar_4r import factors, joints  # noqa: F401 (on which it builds)
from fastlink.mechanisms.planar_4r.inputs import HAYES, planar_4r

#: Which equation of the paper, and products of which factors multiply v_i^2 v_j^2, v_i^2, v_j^2 and 1.
IO_PRODUCTS = {
    "12": (2, "A1 B2", "A2 B1", "C1 D2", "C2 D1"),
    "13": (3, "A1 B1", "A2 B2", "C2 D2", "C1 D1"),
    "14": (1, "A1 A2", "B1 B2", "C1 C2", "D1 D2"),
    "23": (4, "A1 D2", "B2 C1", "B1 C2", "A2 D1"),
    "24": (5, "A1 C1", "B2 D2", "A2 C2", "B1 D1"),
    "34": (6, "A1 C2", "B1 D2", "A2 C1", "B2 D1"),
}
#: The coefficient of v_i v_j is this number times the product of these two lengths; there is none in 13 and 24.
IO_CROSS = {
    "12": (-8.0, "2", "4"),
    "14": (-8.0, "1", "3"),
    "23": (-8.0, "1", "3"),
    "34": (8.0, "2", "4"),
}


@planar_4r.quantity(units="1", symbol="1/(4 s^2)", source=f"{HAYES}, eqs. (1) to (6)", internal=True)
def per_sum_squared(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """Reciprocal of the squared sum of the scaled lengths."""
    total = (s1 + s2) + (s3 + s4)
    return 1.0 / (total * total)


def io_product(first: Any, second: Any, per_sum_squared: Any) -> Any:
    """Product of two factors over the squared sum of the lengths."""
    return first * second * per_sum_squared


def io_cross(x: Any, y: Any, per_sum_squared: Any) -> Any:
    """Eight times the product of two lengths over the squared sum of all."""
    return 8.0 * (x * y) * per_sum_squared


def residual(vivj: Any, vi: Any, vj: Any, one: Any, S_i: Any, C_i: Any, S_j: Any, C_j: Any) -> Any:
    """Residual of an equation without a term in v_i v_j."""
    return (vivj * S_i * S_j + one * C_i * C_j) + (vi * S_i * C_j + vj * C_i * S_j)


def residual_plus_cross(squares: Any, cross: Any, Y_i: Any, Y_j: Any) -> Any:
    """Residual of an equation with a positive coefficient of v_i v_j."""
    return squares + cross * Y_i * Y_j


def residual_minus_cross(squares: Any, cross: Any, Y_i: Any, Y_j: Any) -> Any:
    """Residual of an equation with a negative coefficient of v_i v_j."""
    return squares - cross * Y_i * Y_j


step = planar_4r.steps(units="1", source=f"{HAYES}, eqs. (1) to (6)")
OVER = "over the squared sum of the lengths"
step(io_cross, "io_cross_13", "8 a_1 a_3", "8 a1 a3 over the squared sum of the lengths", x="s1", y="s3")
step(io_cross, "io_cross_24", "8 a_2 a_4", "8 a2 a4 over the squared sum of the lengths", x="s2", y="s4")


def declare_residual(pair: str) -> None:
    """Declare the residual of the equation of two joints, and its coefficients."""
    i, j = pair[0], pair[1]
    equation, *products = IO_PRODUCTS[pair]
    source = f"{HAYES}, eq. ({equation})"
    step = planar_4r.steps(units="1", source=source)
    terms = {"S_i": f"joint_S{i}", "C_i": f"joint_C{i}", "S_j": f"joint_S{j}", "C_j": f"joint_C{j}"}
    for term, product in zip(("vivj", "vi", "vj", "one"), products, strict=True):
        first, second = str(product).split()
        terms[term] = f"io_{pair}_{term}"
        symbol, meaning = f"{first[0]}_{first[1]} {second[0]}_{second[1]}", f"{first} {second} {OVER}"
        step(io_product, terms[term], symbol, meaning, first=f"factor_{first}", second=f"factor_{second}")
    name, symbol = f"io_residual_{pair}", f"r_{pair}"
    meaning = f"Residual of the input-output equation of joints {i} and {j}, over the squared sum of lengths"
    quantity = planar_4r.quantities(units="1", source=source)
    if pair not in IO_CROSS:
        quantity(residual, name, symbol, meaning, **terms)
        return
    number, x, y = IO_CROSS[pair]
    squares = f"io_{pair}_squares"
    step(residual, squares, symbol, f"{meaning}, but for v_i v_j", **terms)
    with_cross = residual_plus_cross if number > 0.0 else residual_minus_cross
    halves = {"Y_i": f"joint_Y{i}", "Y_j": f"joint_Y{j}"}
    quantity(with_cross, name, symbol, meaning, squares=squares, cross=f"io_cross_{x}{y}", **halves)


for _pair in IO_PRODUCTS:
    declare_residual(_pair)
