"""Facts of force of the planar 4R: mass centres, joint reactions, driving torque.

F_ij is the force of link i on link j, T41 the driving torque on the crank. The moments of links 3 and 2
give F32, the other forces follow link by link; the divisor AB x DB is 2 a1 a4 sigma up to sign, which
keeps its digits at a toggle where a cross product of the vectors does not.

The torque is that of the power: sum of m_i a_Gi . v_Gi + I_i alpha_i omega_i over omega1. With n = omega2/omega1, the
acceleration of the coupler's mass centre, -omega1^2 A + alpha2 J AG - omega2^2 AG, times its velocity over omega1,
J (A + n AG), is

    alpha2 AG . (A + n AG) - omega1^2 n (n - 1) A x AG:

where the links turn nearly as one (a4 is short), every term is as small as the torque, while A x F21 and the sum of
the moments about O are small differences of great forces. Products of parallel vectors are left out, not computed.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from fastlink.facts.names import Below, Quantity
from fastlink.mechanisms._shared.laws import along, difference, moment, norm, product, square, total, turned
from fastlink.mechanisms.planar_4r import (  # noqa: F401 (declare what is replaced)
    dense,
    forces,
    position,
    rates,
)
from fastlink.mechanisms.planar_4r.inputs import HAYES, LINKS, build_on, less, planar_4r, plus
from fastlink.mechanisms.planar_4r.position import CENTRES, DB, EQUATION_9, OUTPUT, THETA1, about_fixed
from fastlink.numerics.elementary import PI, cosine, select, sine
from fastlink.numerics.vectors import cross

REACTIONS = EQUATION_9


step = planar_4r.steps(units="rad2 s-2", source=REACTIONS)
step(square, "omega1_squared", "omega_1^2", "Square of the input speed", x="omega1")
step(square, "omega2_squared", "omega_2^2", "Square of the coupler's angular velocity", x="omega2")
step(square, "omega4_squared", "omega_4^2", "Square of the output link's angular velocity", x="omega4")


def crank_force(m1: Any, omega1_squared: Any, centre: Any) -> Any:
    """Return the rate of momentum of the crank, along or across its axis."""
    return -(m1 * omega1_squared) * centre


_RATE = "Rate of momentum of the crank"
_P1 = {"u": "crank_force_along", "v": "crank_force_across", **THETA1}
step = planar_4r.steps(units="N", source=REACTIONS)
step(crank_force, "crank_force_along", "-m_1 omega_1^2 G_1u", f"{_RATE}, along its axis", centre="G1_u")
step(crank_force, "crank_force_across", "-m_1 omega_1^2 G_1v", f"{_RATE}, across its axis", centre="G1_v")
step.vector(turned, "p1_*", "m_1 a_CG1*", _RATE, **_P1)
step.vector(product, "p2_*", "m_2 a_CG2*", "Rate of momentum of the coupler", x="m2", y="G2_a*")
_AXIS = "its axis, over its length"
_CENTRE = "Mass times centre of the output link"
_G3 = {"u": "m3_G3_along", "v": "m3_G3_across", **DB}
step = planar_4r.steps(units="kg", source=CENTRES)
step(product, "m3_G3_along", "m_3 G_3/a_3", f"{_CENTRE} along {_AXIS}", x="m3", y="G3_along")
step(product, "m3_G3_across", "m_3 G_3/a_3", f"{_CENTRE} across {_AXIS}", x="m3", y="G3_across")
step.vector(turned, "m3_DG_*", "m_3 DG_3*", f"{_CENTRE} from D", **_G3, units="kg m")


_G3 = {**OUTPUT, "x": "m3_DG_x", "y": "m3_DG_y"}
step.vector(about_fixed, "p3_*", "m_3 a_CG3*", "Rate of momentum of the output link", **_G3, units="N")


def about_pivot(inertia: Any, mass: Any, G_u: Any, G_v: Any) -> Any:
    """Moment of inertia of a link about its fixed pivot."""
    return inertia + mass * (G_u * G_u + G_v * G_v)


step = planar_4r.steps(units="kg m2", source=CENTRES)
_I1 = {"inertia": "I1", "mass": "m1", "G_u": "G1_u", "G_v": "G1_v"}
_I3 = {"inertia": "I3", "mass": "m3", "G_u": "G3_u", "G_v": "G3_v"}
step(about_pivot, "I1_O", "I_1O", "Moment of inertia of the crank about O", **_I1)
step(about_pivot, "I3_D", "I_3D", "Moment of inertia of the output link about D", **_I3)


_I2 = {"inertia": "I2", "mass": "m2", "G_u": "G2_u", "G_v": "G2_v"}
step(about_pivot, "I2_A", "I_2A", "Moment of inertia of the coupler about A", **_I2)
step = planar_4r.steps(units="kg rad2 s-2", source=REACTIONS)
step(product, "m2_omega1_squared", "m_2 omega_1^2", "Mass times squared speed", x="m2", y="omega1_squared")


@planar_4r.quantity(units="m2", symbol="A x AG", source=REACTIONS, internal=True)
def A_cross_AG(a1: Any, G2_along: Any, G2_across: Any, AB_u: Any, AB_v: Any) -> Any:
    """Cross product of the crank pin and the coupler's mass centre from it, of the angle between them."""
    return a1 * (G2_along * AB_v + G2_across * AB_u)


@planar_4r.quantity(units="N m", symbol="M_2", source=REACTIONS, internal=True)
def moment2_A(I2_A: Any, alpha2: Any, m2_omega1_squared: Any, A_cross_AG: Any) -> Any:
    """Rate of moment of momentum of the coupler about A, A held."""
    return I2_A * alpha2 + m2_omega1_squared * A_cross_AG


@planar_4r.quantity(units="m-1", symbol="unit/(2 a_1 a_4)", source=REACTIONS, internal=True)
def unit_per_2_a1_a4(s1: Any, s4: Any, per_unit: Any) -> Any:
    """Power of two at or below the longest link over twice crank times ground."""
    return 0.5 / s1 / s4 * per_unit


@planar_4r.quantity(units="kg m", symbol="I_3D unit/(2 a_1 a_4)", source=REACTIONS, internal=True)
def I3_D_per_2_a1_a4(I3_D: Any, unit_per_2_a1_a4: Any) -> Any:
    """Moment of inertia about D over twice crank times ground, times that power of two."""
    return I3_D * unit_per_2_a1_a4


def pull(moment: Any, per_2_a1_a4: Any, per_sigma: Any, branch_sign: Any) -> Any:
    """Force in the joint B that balances the moment of a link, for a length of that power of two."""
    return moment * (branch_sign * (per_2_a1_a4 * per_sigma))


_LENGTH = "for a length of that power of two"
_DB = f"Force in the joint B along DB that balances the coupler's moment, {_LENGTH}"
_AB = f"Force in the joint B along AB that balances the output link's moment, {_LENGTH}"
_M2 = {"moment": "moment2_A", "per_2_a1_a4": "unit_per_2_a1_a4"}
_M3 = {"moment": "alpha4", "per_2_a1_a4": "I3_D_per_2_a1_a4"}
step = planar_4r.steps(units="N", source=REACTIONS)
step(pull, "pull_along_DB", "M_2 unit/(AB x DB)", _DB, **_M2)
step(pull, "pull_along_AB", "I_3D alpha_4 unit/(AB x DB)", _AB, **_M3)


def force_in_B(pull_along_DB: Any, pull_along_AB: Any, AB: Any, DB: Any, per_unit: Any) -> Any:
    """Return a component of the force in the joint B from those along DB and AB."""
    return (pull_along_DB * DB + pull_along_AB * AB) * per_unit


force = planar_4r.quantities(units="N", source=REACTIONS)
force.vector(
    force_in_B, "F32_*", "F_32*", "Force of the output link on the coupler at B", AB="AB_*", DB="DB_*"
)
force.vector(difference, "F21_*", "F_21*", "Force of the coupler on the crank at A", x="F32_*", y="p2_*")
force.vector(difference, "F41_*", "F_41*", "Force of the ground on the crank at O", x="p1_*", y="F21_*")
force.vector(total, "F43_*", "F_43*", "Force of the ground on the output link at D", x="p3_*", y="F32_*")


arm = planar_4r.steps(units="m", source=REACTIONS)
_ARM = "Velocity of the coupler's mass centre over omega1, a quarter turn back"
arm.vector(along, "arm2_*", "A + n AG_2", _ARM, start="A_*", length="coupler_ratio", direction="AG_*")


@planar_4r.quantity(units="N m", symbol="T_2", source=REACTIONS, internal=True)
def torque2(
    I2: Any, m2: Any, alpha2: Any, coupler_ratio: Any, joint_ratio_2: Any, AG_x: Any, AG_y: Any, arm2_x: Any,
    arm2_y: Any, m2_omega1_squared: Any, A_cross_AG: Any,
) -> Any:  # fmt: skip
    """Power that the coupler takes up, over omega1."""
    centripetal = m2_omega1_squared * ((coupler_ratio * joint_ratio_2) * A_cross_AG)
    return alpha2 * (I2 * coupler_ratio + m2 * (AG_x * arm2_x + AG_y * arm2_y)) - centripetal


_POWER = "Power that the output link takes up, over omega1"
step = planar_4r.steps(units="N m", source=REACTIONS)
step(
    product, "moment3_D", "M_3", "Rate of moment of momentum of the output link about D", x="I3_D", y="alpha4"
)
step(product, "torque3", "T_3", _POWER, x="moment3_D", y="output_ratio")
torque = planar_4r.quantities(units="N m", source=f"{REACTIONS}, by its power")
torque(total, "T41", "T_41", "Driving torque of the ground on the crank", x="torque2", y="torque3")


force(norm, "F41", "|F_41|", "Force of the ground on the crank at O, magnitude", x="F41_x", y="F41_y")
force(norm, "F21", "|F_21|", "Force of the coupler on the crank at A, magnitude", x="F21_x", y="F21_y")
force(norm, "F32", "|F_32|", "Force of the output link on the coupler at B, magnitude", x="F32_x", y="F32_y")
force(norm, "F43", "|F_43|", "Force of the ground on the output link at D, magnitude", x="F43_x", y="F43_y")


@planar_4r.quantity(units="W", symbol="P_in", source=f"{REACTIONS}, T_41 omega_1")
def input_power(T41: Any, omega1: Any) -> Any:
    """Power of the driving torque."""
    return T41 * omega1


# -- Shaking force and shaking moment of the planar 4R

# They need no reaction at all: they are minus the rates of momentum and of moment of momentum, OG x m a_G
# without the products of parallel vectors, as in `forces`.


SHAKING = f"{HAYES}, section 5"


def minus_sum(p1: Any, p2: Any, p3: Any) -> Any:
    """Return minus the rate of momentum of all links."""
    return -(p1 + p2 + p3)


force = planar_4r.quantities(units="N", source=SHAKING)
_P = {f"p{link}": f"p{link}_*" for link in (1, 2, 3)}
_NET = {"x": "shaking_force_x", "y": "shaking_force_y"}
force.vector(minus_sum, "shaking_force_*", "F_*", "Shaking force F14 + F34 on the ground", **_P)
force(norm, "shaking_force", "|F|", "Shaking force on the ground, magnitude", **_NET)


@planar_4r.quantity(units="N m", symbol="dL_2/dt", source=SHAKING, internal=True)
def spin_rate2(
    I2: Any, m2: Any, alpha2: Any, coupler_ratio: Any, joint_ratio_2: Any, AG_x: Any, AG_y: Any, G2_x: Any,
    G2_y: Any, m2_omega1_squared: Any, A_cross_AG: Any,
) -> Any:  # fmt: skip
    """Rate of moment of momentum of the coupler about O."""
    centripetal = m2_omega1_squared * (((coupler_ratio + 1.0) * joint_ratio_2) * A_cross_AG)
    return alpha2 * (I2 + m2 * (AG_x * G2_x + AG_y * G2_y)) - centripetal


@planar_4r.quantity(units="N m", symbol="dL_3/dt", source=SHAKING, internal=True)
def spin_rate3(moment3_D: Any, a4: Any, p3_y: Any) -> Any:
    """Rate of moment of momentum of the output link about O."""
    return moment3_D + a4 * p3_y


@planar_4r.quantity(units="N m", symbol="M_O", source=SHAKING)
def shaking_moment(spin_rate2: Any, spin_rate3: Any) -> Any:
    """Shaking moment T14 + (a4, 0) x F34 on the ground about O."""
    return -(spin_rate2 + spin_rate3)


@planar_4r.quantity(units="N m", symbol="M", source=SHAKING)
def shaking_moment_at(shaking_moment: Any) -> Any:
    """Shaking moment on the ground about the point (M_x, M_y), O unless given."""
    return shaking_moment


@planar_4r.quantity(units="N m", symbol="DG_3 x p_3", source=SHAKING, internal=True)
def DG_cross_p3(alpha4: Any, DG_x: Any, DG_y: Any, m3_DG_x: Any, m3_DG_y: Any) -> Any:
    """Rate of moment of momentum about D of the output link's mass in its centre."""
    return alpha4 * (DG_x * m3_DG_x + DG_y * m3_DG_y)


@planar_4r.quantity(units="N m", symbol="T_14 + r_34 x F_34", source=SHAKING)
def shaking_moment_printed(
    T41: Any, pull_along_DB: Any, pull_along_AB: Any, moment3_D: Any, DG_along: Any, DG_across: Any,
    AB_x: Any, AB_y: Any, DB_x: Any, DB_y: Any, a3: Any, DG_cross_p3: Any, per_unit: Any,
) -> Any:  # fmt: skip
    """Shaking moment as printed, T14 + r34 x F34 with r34 from the output link's mass centre to D."""
    # DB x F32 is -moment3_D: a cross product of DB and AB would lose its digits where these align.
    F32_dot_DB = (pull_along_DB * (a3 * a3) + pull_along_AB * (AB_x * DB_x + AB_y * DB_y)) * per_unit
    return (DG_cross_p3 - (DG_along * moment3_D + DG_across * F32_dot_DB)) - T41


# -- Loads of the planar 4R: gravity, a force on the coupler point, a torque on the output link

# Each load is a variant that one of its inputs selects; loads without inputs are left out, not zero. Its
# facts build on what they replace, so that loads add up in any combination. A weight is part of the rate of
# momentum, p_i = m_i (a_Gi - g): then every equation of forces holds as it stands, while moments and powers
# gain those of the loads.


LOADS = f"{HAYES}, eq. (9), with loads"
GRAVITY, COUPLER_FORCE, OUTPUT_TORQUE, MOMENT_POINT = (
    "gravity",
    "coupler_force",
    "output_torque",
    "moment_point",
)


def load(variant: str, name: str, units: str, symbol: str, meaning: str) -> None:
    """Declare an input of a load, 0 unless given."""
    planar_4r.input(name, units=units, symbol=symbol, meaning=meaning, variant=variant, default=0.0)


load(GRAVITY, "gravity_x", "m s-2", "g_x", "acceleration of gravity, x")
load(GRAVITY, "gravity_y", "m s-2", "g_y", "acceleration of gravity, y")
load(COUPLER_FORCE, "FP_x", "N", "F_Px", "load on the coupler point P, x")
load(COUPLER_FORCE, "FP_y", "N", "F_Py", "load on the coupler point P, y")
load(OUTPUT_TORQUE, "T_load", "N m", "T_0", "load torque on the output link, constant part")
load(OUTPUT_TORQUE, "T_load_linear", "N m s", "T_1", "load torque on the output link over omega4")
_QUADRATIC = "load torque on the output link over omega4 |omega4|"
load(OUTPUT_TORQUE, "T_load_quadratic", "N m s2", "T_2", _QUADRATIC)
load(MOMENT_POINT, "M_x", "m", "M_x", "point of reference of shaking_moment_at, x")
load(MOMENT_POINT, "M_y", "m", "M_y", "point of reference of shaking_moment_at, y")


# -- whole links ----------------------------------------------------------------------------------


step = planar_4r.steps(units="kg m", source=LOADS)
step(product, "m1_G1_u", "m_1 G_1u", "mass times centre of the crank, along", x="m1", y="G1_u")
step(product, "m1_G1_v", "m_1 G_1v", "mass times centre of the crank, across", x="m1", y="G1_v")
_G1 = {"u": "m1_G1_u", "v": "m1_G1_v", **THETA1}
step.vector(turned, "m1_OG_*", "m_1 OG_1*", "Mass times centre of the crank from O", **_G1)


# -- gravity --------------------------------------------------------------------------------------


def less_weight(replaced: Any, mass: Any, gravity: Any) -> Any:
    """Rate of momentum less the weight."""
    return replaced - mass * gravity


for _xy in "xy":
    build_on(GRAVITY, f"p1_{_xy}", less_weight, mass="mass1", gravity=f"gravity_{_xy}")
    build_on(GRAVITY, f"p2_{_xy}", less_weight, mass="m2", gravity=f"gravity_{_xy}")
    build_on(GRAVITY, f"p3_{_xy}", less_weight, mass="mass3", gravity=f"gravity_{_xy}")


def pull_less(replaced: Any, further: Any, unit_per_2_a1_a4: Any, per_sigma: Any, branch_sign: Any) -> Any:
    """Force in the joint B along AB that balances the moments about D, less a moment on the output link."""
    return replaced - further * (branch_sign * (unit_per_2_a1_a4 * per_sigma))


def less_sum(replaced: Any, x: Any, y: Any) -> Any:
    """Take the sum of two terms away."""
    return replaced - (x + y)


step = planar_4r.steps(units="N m", source=LOADS, variant=GRAVITY)
_G1, _OF_G3 = {"x": "m1_OG_x", "y": "m1_OG_y"}, {"x": "m3_DG_x", "y": "m3_DG_y"}
_G = {"F_x": "weight2_x", "F_y": "weight2_y"}
step.vector(product, "weight2_*", "m_2 g", "Weight of the coupler", x="m2", y="gravity_*", units="N")
_WEIGHT2 = "Moment of the coupler's weight"
step(moment, "weight_moment2_A", "AG_2 x m_2 g", f"{_WEIGHT2} about A", x="AG_x", y="AG_y", **_G)
step(moment, "weight_moment2_O", "OG_2 x m_2 g", f"{_WEIGHT2} about O", x="G2_x", y="G2_y", **_G)
_LOAD_POWER = "Power of the coupler's weight, over omega1"
step(moment, "weight_torque2", "(A + n AG_2) x m_2 g", _LOAD_POWER, x="arm2_x", y="arm2_y", **_G)
_G = {"F_x": "gravity_x", "F_y": "gravity_y"}
step(moment, "weight_moment1", "OG_1 x m_1 g", "Moment of the crank's weight about O", **_G1, **_G)
step(moment, "weight_moment3", "DG_3 x m_3 g", "Moment of the output link's weight about D", **_OF_G3, **_G)

build_on(GRAVITY, "pull_along_AB", pull_less, further="weight_moment3")
build_on(GRAVITY, "moment2_A", less, further="weight_moment2_A")
build_on(GRAVITY, "spin_rate2", less, further="weight_moment2_O")
build_on(GRAVITY, "moment3_D", less, further="weight_moment3")
build_on(GRAVITY, "DG_cross_p3", less, further="weight_moment3")
build_on(GRAVITY, "torque2", less, further="weight_torque2")
build_on(GRAVITY, "T41", less, further="weight_moment1")
build_on(GRAVITY, "shaking_moment", plus, further="weight_moment1")


# -- force on the coupler point -------------------------------------------------------------------


_AP, _A = {"x": "AP_x", "y": "AP_y"}, {"x": "A_x", "y": "A_y"}
_FP = {"F_x": "FP_x", "F_y": "FP_y"}
_ABOUT_O = "Moment about O of the load on the coupler point, were it to act in A"
step = planar_4r.steps(units="N m", source=LOADS, variant=COUPLER_FORCE)
step(moment, "load_moment_A", "AP x F_P", "Moment of the load on the coupler point about A", **_AP, **_FP)
step(moment, "load_moment_of_A", "A x F_P", _ABOUT_O, **_A, **_FP)


_LOAD_POWER = "Power of the load on the coupler point, over omega1"
_OF_P = {"start": "load_moment_of_A", "length": "coupler_ratio", "direction": "load_moment_A"}
step(along, "load_torque2", "(A + n AP) x F_P", _LOAD_POWER, **_OF_P)


@planar_4r.quantity(units="N m", symbol="G_2P x F_P", source=LOADS, internal=True, variant=COUPLER_FORCE)
def load_moment_G(AP_x: Any, AP_y: Any, AG_x: Any, AG_y: Any, FP_x: Any, FP_y: Any) -> Any:
    """Moment of the load on the coupler point about the coupler's mass centre."""
    return cross(AP_x - AG_x, AP_y - AG_y, FP_x, FP_y)


build_on(COUPLER_FORCE, "moment2_A", less, further="load_moment_A")
build_on(COUPLER_FORCE, "spin_rate2", less_sum, x="load_moment_of_A", y="load_moment_A")
build_on(COUPLER_FORCE, "torque2", less, further="load_torque2")
build_on(COUPLER_FORCE, "inertia_moment2", less, further="load_moment_G")
build_on(COUPLER_FORCE, "F21_x", plus, further="FP_x")
build_on(COUPLER_FORCE, "F21_y", plus, further="FP_y")
build_on(COUPLER_FORCE, "shaking_force_x", plus, further="FP_x")
build_on(COUPLER_FORCE, "shaking_force_y", plus, further="FP_y")
build_on(COUPLER_FORCE, "inertia_force2_x", less, further="FP_x")
build_on(COUPLER_FORCE, "inertia_force2_y", less, further="FP_y")


# -- torque on the output link --------------------------------------------------------------------


@planar_4r.quantity(units="N m", symbol="T_load", source=LOADS, internal=True, variant=OUTPUT_TORQUE)
def load_torque(T_load: Any, T_load_linear: Any, T_load_quadratic: Any, omega4: Any) -> Any:
    """Load torque on the output link; its quadratic part changes sign with omega4."""
    return T_load + (T_load_linear + T_load_quadratic * abs(omega4)) * omega4


build_on(OUTPUT_TORQUE, "pull_along_AB", pull_less, further="load_torque")
build_on(OUTPUT_TORQUE, "moment3_D", less, further="load_torque")
build_on(OUTPUT_TORQUE, "inertia_moment3", less, further="load_torque")


# -- moment about any point -----------------------------------------------------------------------


def moved(replaced: Any, M_x: Any, M_y: Any, shaking_force_x: Any, shaking_force_y: Any) -> Any:
    """Shaking moment about M."""
    return replaced - cross(M_x, M_y, shaking_force_x, shaking_force_y)


build_on(MOMENT_POINT, "shaking_moment_at", moved)


# -- Counterweights on the crank and on the output link, as point masses

# Each belongs to its link: it changes the link's mass, mass centre and moment of inertia, nothing else. Its
# direction is that of the link's frame: pi (the default) is opposite to the link.


COUNTERWEIGHTS = f"{HAYES}, Fig. 2, with counterweights"


def weight_along(mass: Any, radius: Any, direction: Any) -> Any:
    """Mass times radius of a counterweight, along the link."""
    return (mass * radius) * cosine(direction)


def across(mass: Any, radius: Any, direction: Any) -> Any:
    """Mass times radius of a counterweight, to the left of the link."""
    return (mass * radius) * sine(direction)


def spin(mass: Any, radius: Any) -> Any:
    """Moment of inertia of a counterweight about the link's fixed pivot."""
    return mass * (radius * radius)


def declare_counterweight(link: int) -> None:
    """Declare the counterweight of one link, and the terms that it adds to either link."""
    name = f"counterweight{link}"
    mass, radius, direction = f"{name}_mass", f"{name}_radius", f"{name}_direction"
    given = partial(planar_4r.input, variant=name)
    on = f"counterweight on the {LINKS[link]}"
    given(mass, units="kg", symbol=f"m_W{link}", meaning=f"{on}: mass", rule="non-negative")
    distance, angle = f"{on}: distance from the link's fixed pivot", f"{on}: direction in the link's frame"
    given(radius, units="m", symbol=f"r_W{link}", meaning=distance, rule="non-negative")
    given(direction, units="rad", symbol=f"psi_W{link}", meaning=angle, default=PI)
    step = planar_4r.steps(units="kg m", source=COUNTERWEIGHTS, variant=name)
    step(weight_along, f"{name}_along", f"m_W{link} r cos psi", mass=mass, radius=radius, direction=direction)
    step(across, f"{name}_across", f"m_W{link} r sin psi", mass=mass, radius=radius, direction=direction)
    step(spin, f"{name}_spin", f"m_W{link} r^2", mass=mass, radius=radius, units="kg m2")
    build_on(name, f"mass{link}", plus, further=mass)


declare_counterweight(1)
declare_counterweight(3)


# -- on the crank ---------------------------------------------------------------------------------


def inward(replaced: Any, omega1_squared: Any, further: Any) -> Any:
    """Rate of momentum of the crank with its counterweight, in the crank's frame."""
    return replaced - omega1_squared * further


build_on("counterweight1", "m1_G1_u", plus, further="counterweight1_along")
build_on("counterweight1", "m1_G1_v", plus, further="counterweight1_across")
build_on("counterweight1", "crank_force_along", inward, further="counterweight1_along")
build_on("counterweight1", "crank_force_across", inward, further="counterweight1_across")
build_on("counterweight1", "I1_O", plus, further="counterweight1_spin")


# -- on the output link ---------------------------------------------------------------------------


def plus_quotient(replaced: Any, further: Any, length: Any) -> Any:
    """Add a term over a length."""
    return replaced + further / length


build_on("counterweight3", "m3_G3_along", plus_quotient, further="counterweight3_along", length="a3")
build_on("counterweight3", "m3_G3_across", plus_quotient, further="counterweight3_across", length="a3")
build_on("counterweight3", "I3_D", plus, further="counterweight3_spin")


# -- mass centres, which eq. (9) is about -----------------------------------------------------------


def reciprocal(whole: Any) -> Any:
    """Reciprocal of a link's whole mass; zero for a link without mass, whose mass centre is its fixed pivot."""
    return select(whole > 0.0, 1.0 / select(whole > 0.0, whole, 1.0), 0.0)


def about_centre(
    replaced: Any, own: Any, mass: Any, per_mass: Any, radius: Any, direction: Any, G_u: Any, G_v: Any
) -> Any:
    """Moment of inertia of a link with its counterweight about their mass centre."""
    u = G_u - radius * cosine(direction)
    v = G_v - radius * sine(direction)
    return replaced + ((own * per_mass) * mass) * (u * u + v * v)


def declare_centre(link: int, centre: str, moment: str, symbol: str, units: str) -> None:
    """Declare both components of a link's mass centre with its counterweight, and the moment of inertia about it."""
    name, per_mass = f"counterweight{link}", f"per_mass{link}"
    step = planar_4r.steps(units=units, source=COUNTERWEIGHTS, variant=name)
    step(reciprocal, per_mass, f"1/m_{link}", whole=f"mass{link}", units="kg-1")
    meaning = "Mass centre of a link with its counterweight, from its fixed pivot"
    for part in ("x", "y") if units == "m" else ("along", "across"):
        step(product, centre + part, symbol + part, meaning, x=moment + part, y=per_mass)
    own = {"own": f"m{link}", "per_mass": per_mass, "G_u": f"G{link}_u", "G_v": f"G{link}_v"}
    given = {part: f"{name}_{part}" for part in ("mass", "radius", "direction")}
    build_on(name, f"I{link}_G", about_centre, **own, **given)


declare_centre(1, "OG_", "m1_OG_", "OG_1", "m")
declare_centre(3, "DG_", "m3_G3_", "DG_3/a_3 ", "1")


# -- The crank's angular acceleration alpha1, beside its speed omega1, in every configuration

# Accelerations gain alpha1 times the ratio of the velocities to omega1; giving alpha1 chooses these facts.
# The jerks are those of a constant alpha1.


ACCELERATED = "acceleration"

planar_4r.input(
    "alpha1",
    units="rad s-2",
    symbol="alpha_1",
    meaning="angular acceleration of the crank",
    variant=ACCELERATED,
    default=0.0,
)


def mass_times_dot(mass: Any, A_x: Any, A_y: Any, x: Any, y: Any) -> Any:
    """Mass times the scalar product of the crank pin and a vector."""
    return mass * (A_x * x + A_y * y)


step = planar_4r.steps(units="kg m2", source=forces.REACTIONS, variant=ACCELERATED)
_MASS_BY_A = "Mass of the coupler times the scalar product of A and"
step(mass_times_dot, "m2_A_dot_AG", "m_2 A . AG_2", f"{_MASS_BY_A} AG", mass="m2", x="AG_x", y="AG_y")
step(mass_times_dot, "m2_A_dot_OG", "m_2 A . OG_2", f"{_MASS_BY_A} OG", mass="m2", x="G2_x", y="G2_y")
step(
    mass_times_dot,
    "m2_A_dot_arm",
    "m_2 A . (A + n AG_2)",
    f"{_MASS_BY_A} A + n AG",
    mass="m2",
    x="arm2_x",
    y="arm2_y",
)


def plus_product(replaced: Any, alpha1: Any, further: Any) -> Any:
    """Add alpha1 times a further term."""
    return replaced + alpha1 * further


def less_product(replaced: Any, alpha1: Any, further: Any) -> Any:
    """Take alpha1 times a further term away."""
    return replaced - alpha1 * further


def jerk(replaced: Any, omega1: Any, alpha1: Any, slope: Any) -> Any:
    """Angular jerk of a link at constant alpha1."""
    return replaced + (3.0 * (omega1 * alpha1)) * slope


build_on(ACCELERATED, "alpha2", plus_product, further="coupler_ratio")
build_on(ACCELERATED, "alpha4", plus_product, further="output_ratio")
build_on(ACCELERATED, "joint_alpha_3", plus_product, further="joint_ratio_3")
build_on(ACCELERATED, "v1_ddot", plus_product, further="v1_slope")
build_on(ACCELERATED, "a_Ax", less_product, further="A_y")
build_on(ACCELERATED, "a_Ay", plus_product, further="A_x")
build_on(ACCELERATED, "P_ax", plus_product, further="P_dx")
build_on(ACCELERATED, "P_ay", plus_product, further="P_dy")
build_on(ACCELERATED, "G1_ax", less_product, further="OG_y")
build_on(ACCELERATED, "G1_ay", plus_product, further="OG_x")
build_on(ACCELERATED, "p1_x", less_product, further="m1_OG_y")
build_on(ACCELERATED, "p1_y", plus_product, further="m1_OG_x")
build_on(ACCELERATED, "inertia_moment1", plus_product, further="I1_G")
build_on(ACCELERATED, "moment2_A", plus_product, further="m2_A_dot_AG")
build_on(ACCELERATED, "spin_rate2", plus_product, further="m2_A_dot_OG")
build_on(ACCELERATED, "torque2", plus_product, further="m2_A_dot_arm")
build_on(ACCELERATED, "T41", plus_product, further="I1_O")
build_on(ACCELERATED, "shaking_moment", less_product, further="I1_O")
build_on(ACCELERATED, "jerk2", jerk, slope="coupler_slope")
build_on(ACCELERATED, "jerk4", jerk, slope="output_slope")

# theta2 - theta1 gains a difference of its own, which does not cancel.
steady = str(Below(Quantity("alpha2"), ACCELERATED))
build_on(ACCELERATED, "joint_alpha_2", plus_product, replaced=steady, further="joint_ratio_2")
