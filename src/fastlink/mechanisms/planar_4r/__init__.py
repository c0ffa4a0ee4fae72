"""The Euclidean planar 4R of Hayes, Hninn and Irani: its names in books, and what is drawn of it."""

from fastlink.mechanisms._shared import laws
from fastlink.mechanisms._shared.picture import Bar, Circle, Force, Picture, Point, Torque, joint
from fastlink.mechanisms.planar_4r import by_joint, classes, dense, forces, graded, position, rates  # noqa: F401 (they declare its facts)
from fastlink.mechanisms.planar_4r.inputs import LINKS, planar_4r

__all__ = ["DRIVEN", "PICTURE", "planar_4r"]


# -- Further names, in books and drawings, of the quantities and inputs of the planar 4R


_REACTION = "joint force, bearing force, bearing load, pin force, reaction force"

planar_4r.also_called(
    a1="crank, crank length, driver, l1, r2",
    a2="coupler, coupler length, connecting rod, l2, r3",
    a3="rocker, rocker length, output link, follower, l3, r4",
    a4="ground, ground link, base, fixed link, l4, r1",
    omega1="input speed, rpm, crank speed, angular speed, omega",
    alpha1="input acceleration",
    P_u="coupler point, p_x, AP",
    P_v="coupler point, p_y",
    m1="crank mass",
    m2="coupler mass",
    m3="rocker mass, output link mass",
    I1="J1, crank inertia",
    I2="J2, coupler inertia",
    I3="J3, rocker inertia",
    G1_u="centre of gravity, centre of mass of the crank, cog",
    G2_u="centre of mass of the coupler",
    G3_u="centre of mass of the output link",
    radius="bar radius, diameter, thickness, cross section",
    density="material, steel",
    gravity_y="gravity, g, weight",
    T_load="load torque, output torque, resistance, t_out",
    FP_x="external force, applied force, load",
    FP_y="external force, applied force, load",
)
planar_4r.also_called(
    theta2="coupler angle, theta3",
    theta4="output angle, rocker angle, psi",
    d_theta4_d_theta1="velocity ratio, transmission ratio, mechanical advantage, gear ratio",
    omega2="coupler speed, omega3",
    omega4="rocker speed, output speed",
    alpha2="coupler acceleration, alpha3",
    alpha4="acceleration, angular acceleration, output acceleration",
    jerk4="jerk",
    transmission_angle="pressure angle, force transmission, gamma",
    transmission_angle_least="worst transmission angle",
    A_x="position of A, crank pin",
    A_y="position of A, crank pin",
    B_x="position of B",
    B_y="position of B",
    P_x="coupler curve, coupler point, path, trace",
    P_y="coupler curve, coupler point, path, trace",
    P_speed="coupler point velocity",
    P_ax="coupler point acceleration",
    curvature="radius of curvature",
    G1_x="centre of gravity, centre of mass of the crank, cog, cg",
    G2_x="centre of gravity, centre of mass of the coupler, cog, cg",
    G3_x="centre of gravity, centre of mass of the output link, cog, cg",
    G1_ax="acceleration of the centre of gravity, a_cg1",
    G2_ax="acceleration of the centre of gravity, a_cg2",
    G3_ax="acceleration of the centre of gravity, a_cg3",
    inertia_force1_x="d'alembert force, rate of momentum",
    inertia_force2_x="d'alembert force, rate of momentum",
    inertia_force3_x="d'alembert force, rate of momentum",
    T41="torque, driving torque, input torque, crank torque, motor torque, M41, T14",
    F41=f"{_REACTION}, ground reaction, reaction at O, F14",
    F21=f"{_REACTION}, reaction at A, F12",
    F32=f"{_REACTION}, reaction at B, F23",
    F43=f"{_REACTION}, ground reaction, reaction at D, F34",
    shaking_force="frame force, unbalance, balancing",
    shaking_moment="frame moment, shaking torque",
    input_power="power, motor power",
    T41_fluctuation="coefficient of fluctuation, flywheel, energy fluctuation",
    grashof_class="grashof condition, crank-rocker, double crank, drag link, double rocker, linkage type",
    time_ratio="quick return, advance to return ratio",
    swing="stroke, oscillation angle, rocker angle range, output range",
    theta1_low="limit angle, toggle angle, toggle position, dead centre, singularity",
    theta1_high="limit angle, toggle angle, toggle position, dead centre, singularity",
    theta4_low="output limit angle",
    theta4_high="output limit angle",
    status="feasible, feasibility, valid, assembles, assembly, closes",
    circuit="assembly branch",
    loop_residual="closure error, constraint violation",
)


# -- Links made of a round bar: masses, inertias and mass centres from the lengths


laws.declare(planar_4r, {i: (link, f"a{i}") for i, link in LINKS.items()})


# -- The picture of the planar 4R: Figs. 1 and 2 of Hayes, Hninn and Irani


PICTURE = Picture(
    points=(
        Point("O", 0.0, 0.0, "ground"),
        Point("D", "a4", 0.0, "ground"),
        joint("A"),
        joint("B"),
        joint("P", "traced"),
        *(joint(f"G{number}", "mark", group="centres") for number in (1, 2, 3)),
    ),
    bars=(
        Bar("O D", {"O D": "a4"}, is_ground=True),
        Bar("O A", {"O A": "a1"}),
        Bar("A B P", {"A B": "a2"}),
        Bar("D B", {"D B": "a3"}),
    ),
    circles=(Circle("O", "a1"), Circle("D", "a3")),
    forces=(Force("F41", "O"), Force("F21", "A"), Force("F32", "B"), Force("F43", "D")),
    torques=(Torque("T41", "O"),),
    traced={"path": "P"},
)

#: The same linkage by its other inputs.
DRIVEN = by_joint.driven_catalogues()
