"""The eight factors of the six input-output equations, their coefficients and residuals.

The residuals are homogeneous: v_i = sin/cos of half the joint angle, multiplied by cos^2 cos^2 and divided by
the squared sum of the lengths, so that they are finite at straight joints too and comparable between designs.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastlink.mechanisms.planar_4r.declare import HAYES, planar_4r
from fastlink.numerics.compensated import gap

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


def _factor(law: Callable[..., Any]) -> Callable[..., Any]:
    """Declare a factor of eq. (1), a sum without loss: high and low part."""
    name = law.__name__
    return planar_4r.quantity(
        units="1",
        symbol=f"{name[-2]}_{name[-1]}",
        source=f"{HAYES}, eq. (1)",
        internal=True,
        low=f"{name}_low",
    )(law)


@_factor
def factor_A1(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 - a2 + a3 - a4, scaled."""
    return gap(s1, -s2, s3, -s4)


@_factor
def factor_A2(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 + a2 + a3 - a4, scaled."""
    return gap(s1, s2, s3, -s4)


@_factor
def factor_B1(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 + a2 - a3 - a4, scaled."""
    return gap(s1, s2, -s3, -s4)


@_factor
def factor_B2(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 - a2 - a3 - a4, scaled."""
    return gap(s1, -s2, -s3, -s4)


@_factor
def factor_C1(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 - a2 - a3 + a4, scaled."""
    return gap(s1, -s2, -s3, s4)


@_factor
def factor_C2(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 + a2 - a3 + a4, scaled."""
    return gap(s1, s2, -s3, s4)


@_factor
def factor_D1(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 + a2 + a3 + a4, scaled."""
    return gap(s1, s2, s3, s4)


@_factor
def factor_D2(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """a1 - a2 + a3 + a4, scaled."""
    return gap(s1, -s2, s3, s4)


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


for _x, _y in ("13", "24"):
    planar_4r.quantity(
        units="1",
        symbol=f"8 a_{_x} a_{_y}",
        source=f"{HAYES}, eqs. (1) to (6)",
        internal=True,
        name=f"io_cross_{_x}{_y}",
        meaning=f"8 a{_x} a{_y} over the squared sum of the lengths",
        given={"x": f"s{_x}", "y": f"s{_y}"},
    )(io_cross)

for _pair, (_equation, *_products) in IO_PRODUCTS.items():
    _i, _j = _pair[0], _pair[1]
    _given = {
        f"{_letter}_{_k}": f"joint_{_letter}{_n}" for _k, _n in (("i", _i), ("j", _j)) for _letter in "SC"
    }
    _source = f"{HAYES}, eq. ({_equation})"
    for _term, _product in zip(("vivj", "vi", "vj", "one"), _products, strict=True):
        _first, _second = _product.split()
        _given[_term] = f"io_{_pair}_{_term}"
        planar_4r.quantity(
            units="1",
            symbol=f"{_first[0]}_{_first[1]} {_second[0]}_{_second[1]}",
            source=_source,
            internal=True,
            name=_given[_term],
            meaning=f"{_first} {_second} over the squared sum of the lengths",
            given={"first": f"factor_{_first}", "second": f"factor_{_second}"},
        )(io_product)
    _labels: Any = {
        "units": "1",
        "symbol": f"r_{_pair}",
        "source": _source,
        "name": f"io_residual_{_pair}",
        "meaning": f"residual of the input-output equation of joints {_i} and {_j}, over the squared sum of lengths",
    }
    if _pair in IO_CROSS:
        _squares = {"name": f"io_{_pair}_squares", "meaning": f"{_labels['meaning']}, but for v_i v_j"}
        planar_4r.quantity(**_labels | _squares, internal=True, given=_given)(residual)
        _number, _x, _y = IO_CROSS[_pair]
        _given = {
            "squares": _squares["name"],
            "cross": f"io_cross_{_x}{_y}",
            "Y_i": f"joint_Y{_i}",
            "Y_j": f"joint_Y{_j}",
        }
        planar_4r.quantity(**_labels, given=_given)(
            residual_plus_cross if _number > 0.0 else residual_minus_cross
        )
    else:
        planar_4r.quantity(**_labels, given=_given)(residual)
