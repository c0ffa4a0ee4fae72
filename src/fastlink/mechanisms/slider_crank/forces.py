"""Facts of force of the slider-crank: joint forces, side force, driving torque.

F_ij is the force of link i on link j, as in the planar 4R, whose facts of crank and coupler hold here. The slider's
equation along the line gives F32_x, the moments of the rod about A give F32_y, which is the side force.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from fastlink.mechanisms._shared.laws import borrow, build_on, norm, product
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.mechanisms.slider_crank import (
    forces,  # noqa: F401 (declare the rates of momentum)
    motion,  # noqa: F401 (declare what the borrowed facts need)
)
from fastlink.mechanisms.slider_crank.inputs import HAYES, PAGE, slider_crank
from fastlink.numerics.elementary import select
from fastlink.numerics.vectors import cross

FORCES = f"{PAGE}#forces"
REACTIONS = f"{HAYES}, eq. (9) of crank and coupler; {FORCES}"
#: What things are called here; A and B are the same joints, the coupler is the rod.
NAMES = {"a1": "r", "a2": "l", "theta1": "theta", "omega1": "omega", "omega1_squared": "omega_squared"}
NAMES |= {"cos_theta1": "cos_theta", "sin_theta1": "sin_theta"}
NAMES |= {name: name for name in ("A_x", "A_y", "AB_x", "AB_y", "p2_x", "p2_y", "F32_x", "F32_y")}


step = slider_crank.steps(units="N", source=FORCES)
step(product, "p3_x", "m_3 a", "Rate of momentum of the slider", x="m3", y="slider_acceleration")


# -- the rod: without sums of parallel vectors that undo each other ------------------------------------------------


@slider_crank.quantity(units="m2", symbol="A x AG", source=FORCES, internal=True)
def A_cross_AG(A_x: Any, A_y: Any, AG_x: Any, AG_y: Any) -> Any:
    """Cross product of the crank pin and the rod's mass centre from it."""
    return cross(A_x, A_y, AG_x, AG_y)


@slider_crank.quantity(units="m2", symbol="A . AG", source=FORCES, internal=True)
def A_dot_AG(A_x: Any, A_y: Any, AG_x: Any, AG_y: Any) -> Any:
    """Scalar product of the crank pin and the rod's mass centre from it."""
    return A_x * AG_x + A_y * AG_y


@slider_crank.quantity(units="kg m2", symbol="I_2A", source=FORCES, internal=True)
def I2_A(I2: Any, m2: Any, G2_u: Any, G2_v: Any) -> Any:
    """Moment of inertia of the connecting rod about A."""
    return I2 + m2 * (G2_u * G2_u + G2_v * G2_v)


@slider_crank.quantity(units="kg rad2 s-2", symbol="m_2 omega^2", source=FORCES, internal=True)
def m2_omega_squared(m2: Any, omega_squared: Any) -> Any:
    """Mass of the connecting rod times the square of the crank's angular velocity."""
    return m2 * omega_squared


@slider_crank.quantity(units="N", symbol="m_2 a_CG2x", source=FORCES, internal=True)
def p2_x(m2_omega_squared: Any, A_x: Any, A_y: Any, AB_x_bend: Any, G2_along: Any, G2_across: Any) -> Any:
    """Rate of momentum of the connecting rod, x."""
    return m2_omega_squared * ((G2_along * AB_x_bend - A_x) - G2_across * A_y)


@slider_crank.quantity(units="N", symbol="m_2 a_CG2y", source=FORCES, internal=True)
def p2_y(m2_omega_squared: Any, A_y: Any, AB_x_bend: Any, G2_to_B: Any, G2_across: Any) -> Any:
    """Rate of momentum of the connecting rod, y."""
    return m2_omega_squared * (G2_across * AB_x_bend - G2_to_B * A_y)


@slider_crank.quantity(units="1", symbol="1 - G_2u/l", source=FORCES, internal=True)
def G2_to_B(G2_u: Any, l: Any) -> Any:
    """From the mass centre of the connecting rod to B along its axis, over its length."""
    return (l - G2_u) / l


@slider_crank.quantity(units="N m", symbol="M_2", source=FORCES, internal=True)
def moment2_A(I2_A: Any, alpha2: Any, m2_omega_squared: Any, A_cross_AG: Any) -> Any:
    """Rate of moment of momentum of the connecting rod about A, A held."""
    return I2_A * alpha2 + m2_omega_squared * A_cross_AG


@slider_crank.quantity(units="N", symbol="F_32x", source=FORCES)
def F32_x(p3_x: Any) -> Any:
    """Force of the slider on the connecting rod at B, x."""
    return -p3_x


@slider_crank.quantity(units="N", symbol="F_32y", source=FORCES)
def F32_y(moment2_A: Any, F32_x: Any, AB_y: Any, per_AB_x: Any) -> Any:
    """Force of the slider on the connecting rod at B, y."""
    return (moment2_A + AB_y * F32_x) * per_AB_x


def _borrow() -> None:
    """Declare what the planar 4R says of its crank, its coupler and their joints, too."""
    labels: dict[str, dict[str, Any]] = {
        name: {
            "meaning": planar_4r.facts[name].meaning.replace("coupler", "connecting rod"),
            "source": REACTIONS,
        }
        for name in ("F21_x", "F21_y", "F41_x", "F41_y", "F41", "F21")
    }
    labels["F32"] = {
        "meaning": "Force of the slider on the connecting rod at B, magnitude",
        "source": FORCES,
    }
    labels |= {name: {} for name in ("p1_x", "p1_y", "AG_x", "AG_y", "G2_along", "G2_across")}
    borrow(slider_crank, planar_4r, NAMES, "", labels)


_borrow()


@slider_crank.quantity(units="N", symbol="F_43y", source=FORCES)
def side_force(F32_y: Any) -> Any:
    """Side force: force of the guide on the slider, across the line."""
    return F32_y


# -- driving torque, of its power -----------------------------------------------------------------------------------


@slider_crank.quantity(units="1", symbol="1 - H^2", source=FORCES, internal=True)
def one_less_H_squared(Z0: Any, C0: Any, C: Any, p: Any, per_sigma: Any) -> Any:
    """Square of the crank's rate less that of the rod, over the former."""
    return -((C0 * per_sigma) * (p * per_sigma) + (Z0 * per_sigma) * (C * per_sigma))


@slider_crank.quantity(units="1", symbol="1 + H", source=FORCES, internal=True)
def one_plus_H(one_less_H_squared: Any, H: Any) -> Any:
    """Rate of the crank less that of the rod, over the former; where both are alike, too."""
    return one_less_H_squared / (1.0 + abs(H)) + (H + abs(H))


@slider_crank.quantity(units="N m", symbol="T_41", source=FORCES)
def T41(
    p3_x: Any, x_slope: Any, m2: Any, m2_omega_squared: Any, H: Any, one_plus_H: Any, A_cross_AG: Any,
    A_dot_AG: Any, alpha2: Any, I2_A: Any,
) -> Any:  # fmt: skip
    """Driving torque of the ground on the crank."""
    centripetal = m2_omega_squared * ((H * one_plus_H) * A_cross_AG)
    return p3_x * x_slope + (alpha2 * (m2 * A_dot_AG - H * I2_A) - centripetal)


power = slider_crank.quantities(units="W", source=FORCES)
power(product, "input_power", "P_in", "Power of the driving torque", x="T41", y="omega")


# -- Shaking force and shaking moment of the slider-crank: minus the rates of momentum and of moment of
#    momentum


SHAKING = f"{HAYES}, section 5; {PAGE}#shaking-force-and-moment"


@slider_crank.quantity(units="N", symbol="F_x", source=SHAKING)
def shaking_force_x(p1_x: Any, p2_x: Any, p3_x: Any) -> Any:
    """Shaking force F14 + F34 on the ground, x."""
    return -(p1_x + p2_x + p3_x)


@slider_crank.quantity(units="N", symbol="F_y", source=SHAKING)
def shaking_force_y(p1_y: Any, p2_y: Any) -> Any:
    """Shaking force F14 + F34 on the ground, y."""
    return -(p1_y + p2_y)


whole = slider_crank.quantities(units="N", source=SHAKING)
_x, _y = "shaking_force_x", "shaking_force_y"
whole(norm, "shaking_force", "|F|", "Shaking force on the ground, magnitude", x=_x, y=_y)


@slider_crank.quantity(units="N m", symbol="dL_2/dt", source=SHAKING, internal=True)
def spin_rate2(
    moment2_A: Any, m2_omega_squared: Any, AB_x_bend: Any, A_x: Any, A_y: Any, G2_along: Any, G2_across: Any,
    one_less_H_squared: Any, A_cross_AG: Any, A_dot_AG: Any, alpha2: Any, I2_A: Any, m2: Any,
) -> Any:  # fmt: skip
    """Rate of moment of momentum of the connecting rod about O."""
    # A x p2 without A x A; of a short rod, which B drags along, without what its turning leaves across the line, too.
    across = AB_x_bend * (G2_across * A_x - G2_along * A_y)
    dragged = moment2_A + m2_omega_squared * (across + A_y * (G2_along * A_x + G2_across * A_y))
    # Where the rod turns as the crank, folded onto it, what is left of both terms is little: 22 roundings were lost.
    carried = alpha2 * (I2_A + m2 * A_dot_AG) + m2_omega_squared * (one_less_H_squared * A_cross_AG)
    return select(abs(one_less_H_squared) < 0.5, carried, dragged)


@slider_crank.quantity(units="N m", symbol="M_O", source=SHAKING)
def shaking_moment(spin_rate2: Any, e: Any, p3_x: Any) -> Any:
    """Shaking moment T14 + OB x F34 on the ground about O."""
    return e * p3_x - spin_rate2


# -- A load on the slider along its line: there only if the design gives it


LOAD = "slider_load"

slider_crank.input(
    "F_load",
    units="N",
    symbol="F_load",
    meaning="load on the slider at B along its line, x",
    variant=LOAD,
    default=0.0,
)


def plus_load(replaced: Any, F_load: Any) -> Any:
    """Add the load."""
    return replaced + F_load


def less_load_moment(replaced: Any, F_load: Any, e: Any) -> Any:
    """Take the moment e F_load away."""
    return replaced - e * F_load


def less_load_torque(replaced: Any, F_load: Any, x_slope: Any) -> Any:
    """Take the torque away that the load gives the crank."""
    return replaced - F_load * x_slope


build = partial(build_on, slider_crank, LOAD, source=f"{PAGE}#load")
build("F32_x", plus_load)
build("T41", less_load_torque)
build("shaking_force_x", plus_load)
build("shaking_moment", less_load_moment)
