"""Facts of the joints of the focal mechanism in one position, whatever drives it.

All directions are unit vectors, as complex numbers: u of MA, v of NB, e of AB, g of SF, and w = exp(i omega) of the
paper's angle omega. Of these five any follows from the other four,

    e g = -k u v w,    k the sign of (1 + rho) lambda,

and F stands off P and Q by -p u w and q v w. What drives gives three of them: see `rocker` and `crank`.
"""

from __future__ import annotations

from typing import Any

from fastlink.catalogue.catalogue import Catalogue
from fastlink.mechanisms._shared.laws import along, product, total, turned
from fastlink.mechanisms.focal.by_crank import either, quantities, steps
from fastlink.mechanisms.focal.design_facts import length_of
from fastlink.mechanisms.focal.inputs import DESIGN, WUNDERLICH
from fastlink.numerics.elementary import atan2

POSITION = f"{DESIGN}#position"
FIGURES = f"{WUNDERLICH}, Figs. 1 and 2"


# -- directions of PF and QF ----------------------------------------------------------------------------------

step = steps(units="1", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)")
step.vector(turned, "f_*", "u w", "Direction of PF but for its sign", u="u_x", v="u_y", x="w_x", y="w_y")
step.vector(turned, "h_*", "v w", "Direction of QF but for its sign", u="v_x", v="v_y", x="w_x", y="w_y")
step = steps(units="1", source=POSITION)
step(total, "QP_x", "x", "Vector from P to Q over c, times lambda, x", x="e_x", y="t")


def fifth_x(crank_sign: Any, uwv_x: Any, uwv_y: Any, x: Any, y: Any) -> Any:
    """First component of e or g from the other one."""
    return -crank_sign * (uwv_x * x + uwv_y * y)


def fifth_y(crank_sign: Any, uwv_x: Any, uwv_y: Any, x: Any, y: Any) -> Any:
    """Second component of e or g from the other one."""
    return crank_sign * (uwv_x * y - uwv_y * x)


def declare_T(catalogue: Catalogue, start: str, length: str, direction: str) -> None:
    """Declare T, at a length along a direction from another joint."""
    T = catalogue.quantities(units="m", source=f"{WUNDERLICH}, eq. (3.2)")
    T.vector(
        along, "T_*", "T_*", "Joint T on AB", start=f"{start}_*", length=length, direction=f"{direction}_*"
    )


def declare_fifth(catalogue: Catalogue, name: str, bar: str, other: str, w: str) -> None:
    """Declare e or g, the direction of `bar`, from the other one of them."""
    step = catalogue.steps(units="1", source=POSITION)
    for made, one, two in (("uv", "u", "v"), ("uwv", "uv", w)):
        parts = {"u": f"{one}_x", "v": f"{one}_y", "x": f"{two}_x", "y": f"{two}_y"}
        step.vector(turned, f"{made}_*", f"{made}_*", "Product of directions", **parts)
    from_other = {"x": f"{other}_x", "y": f"{other}_y"}
    step.vector((fifth_x, fifth_y), f"{name}_*", f"{name}_*", f"Direction of {bar}", **from_other)


# -- joints -----------------------------------------------------------------------------------------------------

joint = quantities(units="m", source=FIGURES)
joint.vector(product, "A_*", "A_*", "Joint A on MA", x="a", y="u_*")
joint.vector(product, "P_*", "P_*", "Joint P on MA", x="m", y="u_*")
joint(along, "B_x", "B_x", "Joint B on NB, x", start="d", length="b", direction="v_x")
joint(product, "B_y", "B_y", "Joint B on NB, y", x="b", y="v_y")
joint(along, "Q_x", "Q_x", "Joint Q on NB, x", start="d", length="n", direction="v_x")
joint(product, "Q_y", "Q_y", "Joint Q on NB, y", x="n", y="v_y")
joint = quantities(units="m", source=f"{WUNDERLICH}, eqs. (1.3), (1.7)")
joint.vector(length_of, "F_*", "F_*", "Joint F", scaled="MF_*")

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
    """Transmission angle at P: between PM and PF, the same as BQF of (3.1)."""
    return atan2(abs(w_y), P_sign * w_x)


@either(units="rad", symbol="mu_Q", source=POSITION)
def transmission_angle_Q(lambda_sign: Any, w_x: Any, w_y: Any) -> Any:
    """Transmission angle at Q: between QN and QF, the same as FPA of (3.1)."""
    return atan2(abs(w_y), -(lambda_sign * w_x))


@either(units="rad", symbol="mu_F", source=POSITION)
def transmission_angle_F(ratio_sign: Any, u_x: Any, u_y: Any, v_x: Any, v_y: Any) -> Any:
    """Transmission angle at F: between FP and FQ."""
    return atan2(abs(u_x * v_y - u_y * v_x), -(ratio_sign * (u_x * v_x + u_y * v_y)))
