"""Mass centres of the links: where they are, their accelerations, and the joints as seen from them.

r_ij runs from the mass centre of link i to joint j, as in eq. (9); O, A, B, D are joints 1, 2, 3, 4.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import (
    difference,
    opposite,
    opposite_product,
    quotient,
    same,
    total,
    turned,
)
from fastlink.mechanisms.planar_4r.inputs import HAYES, LINKS, planar_4r
from fastlink.mechanisms.planar_4r.position import AB, DB

CENTRES = f"{HAYES}, Fig. 2"
EQUATION_9 = f"{HAYES}, eq. (9)"
THETA1 = {"x": "cos_theta1", "y": "sin_theta1"}

_AXIS = "its axis, over its length"
step = planar_4r.steps(units="1", source=CENTRES)
step(quotient, "G2_along", "G_2u/a_2", f"Mass centre of the coupler along {_AXIS}", x="G2_u", y="a2")
step(quotient, "G2_across", "G_2v/a_2", f"Mass centre of the coupler across {_AXIS}", x="G2_v", y="a2")
step(quotient, "G3_along", "G_3u/a_3", f"Mass centre of the output link along {_AXIS}", x="G3_u", y="a3")
step(quotient, "G3_across", "G_3v/a_3", f"Mass centre of the output link across {_AXIS}", x="G3_v", y="a3")
_OUTPUT = "Mass centre of the output link, with what is fixed to it,"
step(same, "DG_along", "DG_3u/a_3", f"{_OUTPUT} along {_AXIS}", x="G3_along")
step(same, "DG_across", "DG_3v/a_3", f"{_OUTPUT} across {_AXIS}", x="G3_across")
step = planar_4r.steps(units="m", source=CENTRES)
_G1 = {"u": "G1_u", "v": "G1_v", **THETA1}
_G3 = {"u": "DG_along", "v": "DG_across", **DB}
step.vector(turned, "OG_*", "OG_1*", "Mass centre of the crank from O", **_G1)
step.vector(turned, "AG_*", "AG_2*", "Mass centre of the coupler from A", u="G2_along", v="G2_across", **AB)
step.vector(turned, "DG_*", "DG_3*", "Mass centre of the output link from D", **_G3)

# -- in the ground frame --------------------------------------------------------------------------

_CENTRE = {i: f"Mass centre of the {link}" for i, link in LINKS.items()}
centre = planar_4r.quantities(units="m", source=CENTRES)
centre.vector(same, "G1_*", "G_1*", _CENTRE[1], x="OG_*")
centre.vector(total, "G2_*", "G_2*", _CENTRE[2], x="A_*", y="AG_*")
centre(total, "G3_x", "G_3x", f"{_CENTRE[3]}, x", x="a4", y="DG_x")
centre(same, "G3_y", "G_3y", f"{_CENTRE[3]}, y", x="DG_y")

# -- the joints from the mass centres -------------------------------------------------------------

joint = planar_4r.quantities(units="m", source=EQUATION_9)
_FROM = {i: f"from the mass centre of the {link}" for i, link in LINKS.items()}
joint.vector(opposite, "r11_*", "r_11*", f"Joint 1 {_FROM[1]}", x="OG_*")
joint.vector(difference, "r12_*", "r_12*", f"Joint 2 {_FROM[1]}", x="A_*", y="OG_*")
joint.vector(opposite, "r22_*", "r_22*", f"Joint 2 {_FROM[2]}", x="AG_*")
joint.vector(difference, "r23_*", "r_23*", f"Joint 3 {_FROM[2]}", x="AB_*", y="AG_*")
joint.vector(difference, "r33_*", "r_33*", f"Joint 3 {_FROM[3]}", x="DB_*", y="DG_*")
joint.vector(opposite, "r34_*", "r_34*", f"Joint 4 {_FROM[3]}", x="DG_*")

# -- accelerations --------------------------------------------------------------------------------


def about_fixed_x(alpha: Any, omega_squared: Any, x: Any, y: Any) -> Any:
    """Acceleration of a point of a link that turns about a fixed pivot, x; times the mass where x, y are."""
    return -(alpha * y + omega_squared * x)


def about_fixed_y(alpha: Any, omega_squared: Any, x: Any, y: Any) -> Any:
    """Acceleration of such a point, y."""
    return alpha * x - omega_squared * y


def about_moving_x(pivot: Any, alpha: Any, omega_squared: Any, x: Any, y: Any) -> Any:
    """Acceleration of a point of a link whose pivot moves, x."""
    return pivot - alpha * y - omega_squared * x


def about_moving_y(pivot: Any, alpha: Any, omega_squared: Any, x: Any, y: Any) -> Any:
    """Acceleration of such a point, y."""
    return pivot + alpha * x - omega_squared * y


about_fixed = about_fixed_x, about_fixed_y
about_moving = about_moving_x, about_moving_y
OUTPUT = {"alpha": "alpha4", "omega_squared": "omega4_squared"}

_ACCELERATION = {i: f"Acceleration of the mass centre of the {link}" for i, link in LINKS.items()}
_G2 = {"pivot": "a_A*", "alpha": "alpha2", "omega_squared": "omega2_squared", "x": "AG_x", "y": "AG_y"}
step = planar_4r.steps(units="m s-2", source=EQUATION_9)
step.vector(opposite_product, "a_A*", "a_A*", "Acceleration of A", x="omega1_squared", y="A_*")
centre = planar_4r.quantities(units="m s-2", source=EQUATION_9)
centre.vector(opposite_product, "G1_a*", "a_CG1*", _ACCELERATION[1], x="omega1_squared", y="OG_*")
centre.vector(about_moving, "G2_a*", "a_CG2*", _ACCELERATION[2], **_G2)
centre.vector(about_fixed, "G3_a*", "a_CG3*", _ACCELERATION[3], **OUTPUT, x="DG_x", y="DG_y")

# -- masses, moments of inertia -------------------------------------------------------------------

# whole, and about the mass centre of the whole: counterweights change them
for _i, _link in ((1, LINKS[1]), (3, LINKS[3])):
    _ABOUT = f"Moment of inertia of the {_link} about its mass centre"
    step(same, f"mass{_i}", f"m_{_i}", f"Whole mass of the {_link}", x=f"m{_i}", units="kg")
    step(same, f"I{_i}_G", f"I_CG{_i}", _ABOUT, x=f"I{_i}", units="kg m2")
