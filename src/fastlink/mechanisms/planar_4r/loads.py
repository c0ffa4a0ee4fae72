"""Loads of the planar 4R: gravity, a force on the coupler point, a torque on the output link.

Each load is a variant that one of its inputs selects; loads without inputs are left out, not zero.
Its facts build on what they replace, so that loads add up in any combination. A weight is part of the rate of
momentum, p_i = m_i (a_Gi - g): then every equation of forces holds as it stands, while moments and powers gain those of
the loads.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import along, moment, product, turned
from fastlink.mechanisms.planar_4r import dense, forces, shaking  # noqa: F401 (declare what is replaced)
from fastlink.mechanisms.planar_4r.centres import THETA1
from fastlink.mechanisms.planar_4r.inputs import HAYES, build_on, less, planar_4r, plus
from fastlink.numerics.vectors import cross

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
_G1, _G3 = {"x": "m1_OG_x", "y": "m1_OG_y"}, {"x": "m3_DG_x", "y": "m3_DG_y"}
_G = {"F_x": "weight2_x", "F_y": "weight2_y"}
step.vector(product, "weight2_*", "m_2 g", "Weight of the coupler", x="m2", y="gravity_*", units="N")
_WEIGHT2 = "Moment of the coupler's weight"
step(moment, "weight_moment2_A", "AG_2 x m_2 g", f"{_WEIGHT2} about A", x="AG_x", y="AG_y", **_G)
step(moment, "weight_moment2_O", "OG_2 x m_2 g", f"{_WEIGHT2} about O", x="G2_x", y="G2_y", **_G)
_POWER = "Power of the coupler's weight, over omega1"
step(moment, "weight_torque2", "(A + n AG_2) x m_2 g", _POWER, x="arm2_x", y="arm2_y", **_G)
_G = {"F_x": "gravity_x", "F_y": "gravity_y"}
step(moment, "weight_moment1", "OG_1 x m_1 g", "Moment of the crank's weight about O", **_G1, **_G)
step(moment, "weight_moment3", "DG_3 x m_3 g", "Moment of the output link's weight about D", **_G3, **_G)

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


_POWER = "Power of the load on the coupler point, over omega1"
_P = {"start": "load_moment_of_A", "length": "coupler_ratio", "direction": "load_moment_A"}
step(along, "load_torque2", "(A + n AP) x F_P", _POWER, **_P)


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
