"""Facts of the joints of the focal mechanism in one position, whatever drives it.

All directions are unit vectors, as complex numbers: u of MA, v of NB, e of AB, g of SF, and w = exp(i omega) of the
paper's angle omega. Of these five any follows from the other four,

    e g = -k u v w,    k the sign of (1 + rho) lambda,

and F stands off P and Q by -p u w and q v w. What drives gives three of them: see `rocker` and `crank`.
"""

from __future__ import annotations

from typing import Any

from fastlink.catalogue.catalogue import Catalogue
from fastlink.mechanisms._shared.laws import along, product
from fastlink.mechanisms.focal.by_crank import either, quantities, steps
from fastlink.mechanisms.focal.design_facts import length_of
from fastlink.mechanisms.focal.inputs import DESIGN, WUNDERLICH
from fastlink.numerics.elementary import atan2

POSITION = f"{DESIGN}#position"
FIGURES = f"{WUNDERLICH}, Figs. 1 and 2"


def real_part(a_x: Any, a_y: Any, b_x: Any, b_y: Any) -> Any:
    """Return the first component of the product of two directions."""
    return a_x * b_x - a_y * b_y


def imaginary_part(a_x: Any, a_y: Any, b_x: Any, b_y: Any) -> Any:
    """Return the second component of the product of two directions."""
    return a_x * b_y + a_y * b_x


# -- directions of PF and QF ----------------------------------------------------------------------------------

step = steps(units="1", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)")
_PF, _QF = "Direction of PF but for its sign", "Direction of QF but for its sign"
step(real_part, "f_x", "u w", f"{_PF}, x", a_x="u_x", a_y="u_y", b_x="w_x", b_y="w_y")
step(imaginary_part, "f_y", "u w", f"{_PF}, y", a_x="u_x", a_y="u_y", b_x="w_x", b_y="w_y")
step(real_part, "h_x", "v w", f"{_QF}, x", a_x="v_x", a_y="v_y", b_x="w_x", b_y="w_y")
step(imaginary_part, "h_y", "v w", f"{_QF}, y", a_x="v_x", a_y="v_y", b_x="w_x", b_y="w_y")


def fifth_x(crank_sign: Any, uwv_x: Any, uwv_y: Any, x: Any, y: Any) -> Any:
    """First component of e or g from the other one."""
    return -crank_sign * (uwv_x * x + uwv_y * y)


def fifth_y(crank_sign: Any, uwv_x: Any, uwv_y: Any, x: Any, y: Any) -> Any:
    """Second component of e or g from the other one."""
    return crank_sign * (uwv_x * y - uwv_y * x)


def declare_T(catalogue: Catalogue, start: str, length: str, direction: str) -> None:
    """Declare T, at a length along a direction from another joint."""
    T = catalogue.quantities(units="m", source=f"{WUNDERLICH}, eq. (3.2)")
    T(along, "T_x", "T_x", "Joint T on AB, x", start=f"{start}_x", length=length, direction=f"{direction}_x")
    T(along, "T_y", "T_y", "Joint T on AB, y", start=f"{start}_y", length=length, direction=f"{direction}_y")


def declare_fifth(catalogue: Catalogue, name: str, bar: str, other: str, w: str) -> None:
    """Declare e or g, the direction of `bar`, from the other one of them."""
    step = catalogue.steps(units="1", source=POSITION)
    for made, one, two in (("uv", "u", "v"), ("uwv", "uv", w)):
        parts = {"a_x": f"{one}_x", "a_y": f"{one}_y", "b_x": f"{two}_x", "b_y": f"{two}_y"}
        step(real_part, f"{made}_x", f"{made}_x", "Product of directions, x", **parts)
        step(imaginary_part, f"{made}_y", f"{made}_y", "Product of directions, y", **parts)
    from_other = {"x": f"{other}_x", "y": f"{other}_y"}
    step(fifth_x, f"{name}_x", f"{name}_x", f"Direction of {bar}, x", **from_other)
    step(fifth_y, f"{name}_y", f"{name}_y", f"Direction of {bar}, y", **from_other)


# -- joints -----------------------------------------------------------------------------------------------------

joint = quantities(units="m", source=FIGURES)
joint(product, "A_x", "A_x", "Joint A on MA, x", x="a", y="u_x")
joint(product, "A_y", "A_y", "Joint A on MA, y", x="a", y="u_y")
joint(product, "P_x", "P_x", "Joint P on MA, x", x="m", y="u_x")
joint(product, "P_y", "P_y", "Joint P on MA, y", x="m", y="u_y")
joint(along, "B_x", "B_x", "Joint B on NB, x", start="d", length="b", direction="v_x")
joint(product, "B_y", "B_y", "Joint B on NB, y", x="b", y="v_y")
joint(along, "Q_x", "Q_x", "Joint Q on NB, x", start="d", length="n", direction="v_x")
joint(product, "Q_y", "Q_y", "Joint Q on NB, y", x="n", y="v_y")
joint = quantities(units="m", source=f"{WUNDERLICH}, eqs. (1.3), (1.7)")
joint(length_of, "F_x", "F_x", "Joint F, x", scaled="MF_x")
joint(length_of, "F_y", "F_y", "Joint F, y", scaled="MF_y")

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
