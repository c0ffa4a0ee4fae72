"""Facts of the joints of the focal mechanism in one position, whatever drives it.

All directions are unit vectors, as complex numbers: u of MA, v of NB, e of AB, g of SF, and w = exp(i omega) of the
paper's angle omega. Of these five any follows from the other four,

    e g = -k u v w,    k the sign of (1 + rho) lambda,

and F stands off P and Q by -p u w and q v w. What drives gives three of them: see `rocker` and `crank`.
"""

from __future__ import annotations

from typing import Any

from fastlink.catalogue.catalogue import Catalogue
from fastlink.mechanisms.focal.declare import DESIGN, WUNDERLICH
from fastlink.mechanisms.focal.design_facts import length_of
from fastlink.mechanisms.focal.drives import either
from fastlink.mechanisms.planar_4r.rates import product
from fastlink.numerics.elementary import atan2

POSITION = f"{DESIGN}#position"
FIGURES = f"{WUNDERLICH}, Figs. 1 and 2"


def real_part(a_x: Any, a_y: Any, b_x: Any, b_y: Any) -> Any:
    """Return the first component of the product of two directions."""
    return a_x * b_x - a_y * b_y


def imaginary_part(a_x: Any, a_y: Any, b_x: Any, b_y: Any) -> Any:
    """Return the second component of the product of two directions."""
    return a_x * b_y + a_y * b_x


def along(start: Any, length: Any, direction: Any) -> Any:
    """Return what a length along a direction leads to."""
    return start + length * direction


def angle(x: Any, y: Any) -> Any:
    """Return the angle of a vector in (-pi, pi]."""
    # + 0.0 turns -0.0 into 0.0, so that the straight angle is pi and never -pi.
    return atan2(y + 0.0, x)


# -- the design -----------------------------------------------------------------------------------------------


# -- directions of PF and QF ----------------------------------------------------------------------------------

for _axis, _law in (("x", real_part), ("y", imaginary_part)):
    for _name, _rocker, _bar in (("f", "u", "PF"), ("h", "v", "QF")):
        either(
            units="1",
            symbol=f"{_rocker} w",
            source=f"{WUNDERLICH}, eqs. (1.3), (1.4)",
            internal=True,
            name=f"{_name}_{_axis}",
            meaning=f"Direction of {_bar} but for its sign, {_axis}",
            given={"a_x": f"{_rocker}_x", "a_y": f"{_rocker}_y", "b_x": "w_x", "b_y": "w_y"},
        )(_law)


def fifth_x(crank_sign: Any, uwv_x: Any, uwv_y: Any, x: Any, y: Any) -> Any:
    """First component of e or g from the other one."""
    return -crank_sign * (uwv_x * x + uwv_y * y)


def fifth_y(crank_sign: Any, uwv_x: Any, uwv_y: Any, x: Any, y: Any) -> Any:
    """Second component of e or g from the other one."""
    return crank_sign * (uwv_x * y - uwv_y * x)


def declare_T(catalogue: Catalogue, start: str, length: str, direction: str) -> None:
    """Declare T, at a length along a direction from another joint."""
    for axis in "xy":
        catalogue.quantity(
            units="m",
            symbol=f"T_{axis}",
            source=f"{WUNDERLICH}, eq. (3.2)",
            name=f"T_{axis}",
            meaning=f"Joint T on AB, {axis}",
            given={"start": f"{start}_{axis}", "length": length, "direction": f"{direction}_{axis}"},
        )(along)


def declare_fifth(catalogue: Catalogue, name: str, bar: str, other: str, w: str) -> None:
    """Declare e or g, the direction of `bar`, from the other one of them."""
    products = (real_part, imaginary_part)
    for made, one, two in (("uv", "u", "v"), ("uwv", "uv", w)):
        for axis, law in zip("xy", products, strict=True):
            catalogue.quantity(
                units="1",
                symbol=f"{made}_{axis}",
                source=POSITION,
                internal=True,
                name=f"{made}_{axis}",
                meaning=f"Product of directions, {axis}",
                given={"a_x": f"{one}_x", "a_y": f"{one}_y", "b_x": f"{two}_x", "b_y": f"{two}_y"},
            )(law)
    for axis, fifth in (("x", fifth_x), ("y", fifth_y)):
        catalogue.quantity(
            units="1",
            symbol=f"{name}_{axis}",
            source=POSITION,
            internal=True,
            name=f"{name}_{axis}",
            meaning=f"Direction of {bar}, {axis}",
            given={"x": f"{other}_x", "y": f"{other}_y"},
        )(fifth)


# -- joints -----------------------------------------------------------------------------------------------------

for _point, _bar, _length, _direction in (("A", "MA", "a", "u"), ("P", "MA", "m", "u")):
    for _axis in "xy":
        either(
            units="m",
            symbol=f"{_point}_{_axis}",
            source=FIGURES,
            name=f"{_point}_{_axis}",
            meaning=f"Joint {_point} on {_bar}, {_axis}",
            given={"x": _length, "y": f"{_direction}_{_axis}"},
        )(product)

for _point, _bar, _start, _length, _direction in (
    ("B", "NB", "d", "b", "v"),
    ("Q", "NB", "d", "n", "v"),
):
    either(
        units="m",
        symbol=f"{_point}_x",
        source=FIGURES,
        name=f"{_point}_x",
        meaning=f"Joint {_point} on {_bar}, x",
        given={"start": _start, "length": _length, "direction": f"{_direction}_x"},
    )(along)

for _point, _length in (("B", "b"), ("Q", "n")):
    either(
        units="m",
        symbol=f"{_point}_y",
        source=FIGURES,
        name=f"{_point}_y",
        meaning=f"Joint {_point} on NB, y",
        given={"x": _length, "y": "v_y"},
    )(product)

for _axis in "xy":
    either(
        units="m",
        symbol=f"F_{_axis}",
        source=f"{WUNDERLICH}, eqs. (1.3), (1.7)",
        name=f"F_{_axis}",
        meaning=f"Joint F, {_axis}",
        given={"scaled": f"MF_{_axis}"},
    )(length_of)

# -- angles -----------------------------------------------------------------------------------------------------


@either(units="rad", symbol="omega", source=f"{WUNDERLICH}, eq. (1.1)")
def omega_angle(w_x: Any, w_y: Any) -> Any:
    """Angle omega of the bars at P, from PM to PF where m and p have one sign."""
    return atan2(w_y + 0.0, w_x)


@either(units="1", symbol="k", source=POSITION, internal=True)
def P_sign(ratio_sign: Any, lambda_sign: Any) -> Any:
    """Sign of m p, which is that of n p."""
    return ratio_sign * lambda_sign


@either(units="rad", symbol="mu_P", source=POSITION)
def transmission_angle_P(P_sign: Any, w_x: Any, w_y: Any) -> Any:
    """Transmission angle at P: between PM and PF."""
    return atan2(abs(w_y), P_sign * w_x)


@either(units="rad", symbol="mu_Q", source=POSITION)
def transmission_angle_Q(lambda_sign: Any, w_x: Any, w_y: Any) -> Any:
    """Transmission angle at Q: between QN and QF."""
    return atan2(abs(w_y), -(lambda_sign * w_x))


@either(units="rad", symbol="mu_F", source=POSITION)
def transmission_angle_F(ratio_sign: Any, u_x: Any, u_y: Any, v_x: Any, v_y: Any) -> Any:
    """Transmission angle at F: between FP and FQ."""
    return atan2(abs(u_x * v_y - u_y * v_x), -(ratio_sign * (u_x * v_x + u_y * v_y)))
