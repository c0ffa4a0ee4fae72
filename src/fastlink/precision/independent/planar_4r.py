"""The planar 4R from its closed polygon, driven at any joint; forces by eq. (9) of Hayes, Hninn, Irani."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from typing import Any

from fastlink.precision.independent.loops import (
    Link,
    Open,
    Series,
    bar_data,
    cross,
    polygon,
    reactions,
    rotation,
    triangle_angle,
    unit_vector,
    wrapped,
)

__all__ = [
    "DESIGN",
    "FIXED_FRAME",
    "JOINTS",
    "PLACES",
    "add_driven_end",
    "add_places",
    "design",
    "fixed_frame",
    "joints",
]

#: Quantities by the order of the derivatives that they need.
JOINTS = {f"joint_angle_{i}": 0 for i in (1, 2, 3, 4)} | {f"v{i}": 0 for i in (1, 2, 3, 4)}
JOINTS |= {f"joint_omega_{i}": 1 for i in (1, 2, 3, 4)} | {f"joint_alpha_{i}": 2 for i in (1, 2, 3, 4)}
JOINTS |= {"transmission_angle": 0}
PLACES = dict.fromkeys(("A_x", "A_y", "B_x", "B_y", "P_x", "P_y"), 0)
FIXED_FRAME = PLACES | dict.fromkeys(("theta2", "theta4"), 0)
FIXED_FRAME |= {"omega2": 1, "omega4": 1, "alpha2": 2, "alpha4": 2, "jerk2": 3, "jerk4": 3}
FIXED_FRAME |= {"P_vx": 1, "P_vy": 1, "P_speed": 1, "P_ax": 2, "P_ay": 2, "curvature": 2}
JOINT_FORCES = ("F41", "F21", "F32", "F43")
FORCES: tuple[str, ...] = (
    *(f"{force}{part}" for force in JOINT_FORCES for part in ("", "_x", "_y")),
    "T41",
    "input_power",
)
FORCES += ("shaking_force", "shaking_force_x", "shaking_force_y")
FORCES += ("shaking_moment", "shaking_moment_at", "shaking_moment_printed")
FIXED_FRAME |= dict.fromkeys(FORCES, 2)
DESIGN: tuple[str, ...] = ("theta1_low", "theta1_high", "theta4_low", "theta4_high", "grashof_excess")
DESIGN += ("transmission_angle_least", "transmission_angle_greatest")


def joints(ctx: Any, at: Mapping[str, Any], joint: int, order: int, values: dict[str, Any]) -> list[Series]:
    """Add the quantities of the four joints; return the directions of the four links over the drive."""
    _add_joint(ctx, values, joint, at[f"joint_angle_{joint}"])
    number = [(joint - 2 + k) % 4 for k in range(4)]  # of the links from 0: the one before the joint first
    drive = Series((at[f"joint_angle_{joint}"], *([ctx.mpf(1), *[ctx.mpf(0)] * 3][:order])))
    found = polygon(ctx, [at[f"a{k + 1}"] for k in number], drive, at["branch"])
    directions = [found[number.index(k)] for k in range(4)]
    directions = [one - directions[3] + ctx.pi for one in directions]
    rate, acceleration = at.get(f"joint_omega_{joint}"), at.get(f"joint_alpha_{joint}", ctx.mpf(0))
    for i in range(4):
        angle = directions[i] - directions[i - 1]
        _add_joint(ctx, values, i + 1, angle.terms[0])
        if rate is not None:
            of_time = angle.at_speed(rate, acceleration)
            values |= {
                f"joint_{name}_{i + 1}": of_time.derivative(k + 1) for k, name in enumerate(RATES[:order])
            }
    far = (joint + 1) % 4
    values["transmission_angle"] = ctx.pi - abs(values[f"joint_angle_{far + 1}"])
    return directions


RATES = ("omega", "alpha")


def _add_joint(ctx: Any, values: dict[str, Any], joint: int, angle: Any) -> None:
    """Add the angle of a joint, and the tangent of its half."""
    cosine, sine = ctx.cos_sin(angle)
    values[f"joint_angle_{joint}"] = ctx.atan2(sine, cosine)
    if cosine > 0 or sine != 0:
        values[f"v{joint}"] = sine / (1 + cosine) if cosine > 0 else (1 - cosine) / sine


def fixed_frame(ctx: Any, at: Mapping[str, Any], order: int, forces: bool, values: dict[str, Any]) -> None:
    """Add the quantities of the linkage that is driven at O, in the frame of the ground."""
    values["A_x"], values["A_y"] = at["a1"] * ctx.cos(at["theta1"]), at["a1"] * ctx.sin(at["theta1"])
    given = {**at, "joint_angle_1": at["theta1"] - ctx.pi}
    if "omega1" in at:
        given |= {"joint_omega_1": at["omega1"], "joint_alpha_1": at.get("alpha1", ctx.mpf(0))}
    directions = joints(ctx, given, 1, order, values)
    crank, coupler, output, _ = (rotation(ctx, one) for one in directions)
    output = -output  # from D to B
    places = add_places(ctx, at, (crank, coupler), values)
    angles = {2: directions[1], 4: directions[2] - ctx.pi}
    values |= {f"theta{k}": wrapped(ctx, angle.terms[0]) for k, angle in angles.items()}
    if "omega1" in at and order:
        for k, angle in angles.items():
            of_time = angle.at_speed(at["omega1"], at.get("alpha1", ctx.mpf(0)))
            names = (f"omega{k}", f"alpha{k}", f"jerk{k}")[:order]
            values |= {name: of_time.derivative(i) for i, name in enumerate(names, 1)}
    if "P" in places and order:
        values |= _point(ctx, at, places["P"], order)
    if forces:
        values |= _forces(ctx, at, (crank, coupler, output), places, values)


def add_driven_end(ctx: Any, at: Mapping[str, Any], joint: int, values: dict[str, Any]) -> None:
    """Add the end of a bar that is driven at the ground: it has a place where the loop does not close, too."""
    if joint == 1:
        end = -at["a1"] * unit_vector(ctx, at["joint_angle_1"])
        values |= {"A_x": end.real, "A_y": end.imag}
    elif joint == 4:
        end = at["a4"] + at["a3"] * unit_vector(ctx, -at["joint_angle_4"])
        values |= {"B_x": end.real, "B_y": end.imag}


def add_places(
    ctx: Any, at: Mapping[str, Any], turns: tuple[Series, Series], values: dict[str, Any]
) -> dict[str, Series]:
    """Add the places of A, B and P by the turns of crank and coupler; return them over the drive."""
    crank, coupler = turns
    places = {"A": at["a1"] * crank}
    places["B"] = places["A"] + at["a2"] * coupler
    if "P_u" in at and "P_v" in at:
        places["P"] = places["A"] + ctx.mpc(at["P_u"], at["P_v"]) * coupler
    for name, place in places.items():
        values |= {f"{name}_x": place.terms[0].real, f"{name}_y": place.terms[0].imag}
    return places


def _point(ctx: Any, at: Mapping[str, Any], place: Series, order: int) -> dict[str, Any]:
    """Return velocity, acceleration and curvature of the coupler point."""
    values = {}
    if order >= 2:
        tangent, bend = place.derivative(1), place.derivative(2)
        speed = abs(tangent)
        if speed != 0:
            values["curvature"] = cross(tangent, bend) / speed**3
    if "omega1" in at:
        of_time = place.at_speed(at["omega1"], at.get("alpha1", ctx.mpf(0)))
        velocity = of_time.derivative(1)
        values |= {"P_vx": velocity.real, "P_vy": velocity.imag, "P_speed": abs(velocity)}
        if order >= 2:
            values |= {"P_ax": of_time.derivative(2).real, "P_ay": of_time.derivative(2).imag}
    return values


def _forces(
    ctx: Any,
    at: Mapping[str, Any],
    directions: tuple[Series, Series, Series],
    places: Mapping[str, Series],
    values: Mapping[str, Any],
) -> dict[str, Any]:
    """Return what eq. (9) gives, with gravity, loads and counterweights."""
    zero = ctx.mpf(0)
    speed = at["omega1"], at.get("alpha1", zero)
    A, B, D = places["A"].terms[0], places["B"].terms[0], ctx.mpc(at["a4"], 0)
    alphas = (at.get("alpha1", zero), values["alpha2"], values["alpha4"])
    # of the unknowns F41, F21, F32, F43, T41 each force acts on the link of its second number
    ends = ([(0, 1, ctx.mpc(0, 0)), (1, 1, A)], [(1, -1, A), (2, 1, B)], [(2, -1, B), (3, 1, D)])
    origins = (0 * directions[0], places["A"], 0 * directions[2] + D)
    links = []
    for i, (direction, origin, alpha) in enumerate(zip(directions, origins, alphas, strict=True), 1):
        mass, inertia, local = bar_data(ctx, at, i, at[f"a{i}"])
        points = [(mass, local)]
        if f"counterweight{i}_mass" in at:
            turn = at.get(f"counterweight{i}_direction", ctx.mpf(math.pi))
            arm = at[f"counterweight{i}_radius"] * unit_vector(ctx, turn)
            points.append((at[f"counterweight{i}_mass"], arm))
        curves = [(mass, (origin + arm * direction).at_speed(*speed)) for mass, arm in points]
        whole = sum(mass for mass, _ in curves)
        centre = curves[0][1].terms[0] if len(curves) == 1 else origin.terms[0]
        if whole != 0:
            centre = sum(mass * curve.terms[0] for mass, curve in curves) / whole
        links.append(Link(curves, inertia * alpha, centre, ends[i - 1], torque=8 if i == 1 else None))
    if "FP_x" in at or "FP_y" in at:
        load = ctx.mpc(at.get("FP_x", zero), at.get("FP_y", zero))
        links[1].loads.append((load, places["P"].terms[0]))
    omega4 = values["omega4"]
    links[2].load_torque = (
        at.get("T_load", zero)
        + at.get("T_load_linear", zero) * omega4
        + at.get("T_load_quadratic", zero) * omega4 * abs(omega4)
    )
    gravity = ctx.mpc(at.get("gravity_x", zero), at.get("gravity_y", zero))
    found = reactions(links, [], gravity)
    forces = {name: ctx.mpc(*found[2 * k : 2 * k + 2]) for k, name in enumerate(JOINT_FORCES)}
    torque, on_ground = found[8], -forces["F43"]
    forces["shaking_force"] = on_ground - forces["F41"]
    moment = -torque + cross(D, on_ground)
    about = ctx.mpc(at.get("M_x", zero), at.get("M_y", zero))
    result = {name: abs(force) for name, force in forces.items()}
    result |= {f"{name}_x": force.real for name, force in forces.items()}
    result |= {f"{name}_y": force.imag for name, force in forces.items()}
    return result | {
        "T41": torque,
        "input_power": torque * at["omega1"],
        "shaking_moment": moment,
        "shaking_moment_at": moment - cross(about, forces["shaking_force"]),
        "shaking_moment_printed": -torque + cross(D - links[2].centre, on_ground),
    }


def design(ctx: Any, at: Mapping[str, Any], values: dict[str, Any]) -> None:
    """Add the facts of a design: of one that assembles the ranges of its angles, by triangles."""
    a1, a2, a3, a4 = (at[f"a{i}"] for i in (1, 2, 3, 4))
    lengths = sorted((a1, a2, a3, a4))
    values["grashof_excess"] = lengths[3] + lengths[0] - lengths[1] - lengths[2]
    if lengths[3] > lengths[0] + lengths[1] + lengths[2]:
        raise Open("one link is longer than the other three together")

    angle = partial(triangle_angle, ctx)
    least, greatest = max(abs(a4 - a1), abs(a2 - a3)), min(a1 + a4, a2 + a3)
    values |= {"theta1_low": angle(a1, a4, least), "theta1_high": angle(a1, a4, greatest)}
    values["transmission_angle_least"] = angle(a2, a3, least)
    values["transmission_angle_greatest"] = angle(a2, a3, greatest)
    least, greatest = max(abs(a3 - a4), abs(a1 - a2)), min(a3 + a4, a1 + a2)
    values["theta4_low"] = ctx.pi - angle(a3, a4, greatest)
    values["theta4_high"] = ctx.pi - angle(a3, a4, least)
