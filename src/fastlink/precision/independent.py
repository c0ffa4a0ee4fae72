"""A second reference that shares no formula with the facts: the loops themselves, by Newton's iteration.

Each mechanism is written down once more as its papers draw it: links as vectors that close, forces as free bodies.
Positions solve these equations, rates follow by series of the drive (`loops`). Nothing of `mechanisms` may enter
here, and no form that is there because it does not cancel: digits are had by computing with more of them.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import TYPE_CHECKING, Any

from fastlink.facts.derivative import NoDependence
from fastlink.facts.evaluate import read_facts, steps_of
from fastlink.facts.fact import Fact, Loops, System
from fastlink.facts.formula import Formula
from fastlink.facts.names import Derivative, Quantity, Size
from fastlink.precision.loops import (
    Open,
    Series,
    Singular,
    angle_between,
    argument,
    chain,
    closed,
    context,
    coordinates,
    cross,
    drive_of,
    exponential,
    of_rounding,
    polygon,
    rates,
    reactions,
    rotation,
    solved,
    triangle_angle,
    wrapped,
)
from fastlink.precision.reference import CONTEXT, DIGITS, exact_turns, take

if TYPE_CHECKING:
    from fastlink.facts.catalogue import Catalogue


#: Angles are the same where they differ by whole turns.
TURNING = frozenset(("theta2", "theta4", "psi", "phi", "sigma", "omega_angle", "alpha", "beta", "chi"))
TURNING |= {f"joint_angle_{i}" for i in (1, 2, 3, 4)}
#: Modes, which are no numbers.
CODES = ("branch", "completion")
Values = dict[str, Any]


@dataclass(frozen=True)
class Model:
    """Values of one mechanism by one input, without its facts."""

    #: The quantities of a configuration, by the order of the derivatives that they need.
    orders: Mapping[str, int]
    #: The quantities of the design as a whole.
    of_design: Collection[str]
    #: Adds quantities, of a context, values, an order, whether forces are needed, and those found.
    configuration: Callable[[Any, Mapping[str, Any], int, bool, Values], None]
    #: Adds quantities of the design, of a context, values, and those found.
    design: Callable[[Any, Mapping[str, Any], Values], None]
    #: Quantities that need a linear system of all links.
    forces: Collection[str] = ()
    #: Returns how many digits the equations lose at values, None where these are too many.
    lost: Callable[[Mapping[str, Any]], int | None] = lambda _: 0

    def covers(self, name: str) -> bool:
        """Tell whether a quantity has an independent value."""
        return name in self.orders or name in self.of_design

    def values(self, ctx: Any, at: Mapping[str, Any], names: Iterable[str]) -> Values:
        """Return independent values: NaN where the loop does not close, none where nothing is determined."""
        given = {name: int(value) if name in CODES else ctx.mpf(value) for name, value in at.items()}
        fixed = [name for name in names if name in self.of_design]
        moving = [name for name in names if name in self.orders]
        order = max((self.orders[name] for name in moving), default=0)
        forces = any(name in self.forces for name in moving)
        found: Values = {}
        for wanted, compute in (
            (fixed, partial(self.design, ctx, given)),
            (moving, partial(self.configuration, ctx, given, order, forces)),
        ):
            values: Values = {}
            try:
                if wanted:
                    compute(values)
            except Singular:
                pass
            except Open:
                values = dict.fromkeys(wanted, ctx.nan) | values
            found |= {name: values[name] for name in wanted if name in values}
        return found


def _orders(*names: str) -> dict[str, int]:
    """Return the order of the derivatives that each name needs: the number of its text."""
    return {name: order for order, text in enumerate(names) for name in text.split()}


def _with_sizes(forces: Mapping[str, Any]) -> Values:
    """Return sizes and components of forces."""
    return {name: abs(force) for name, force in forces.items()} | coordinates(forces)


# -- The planar 4R from its closed polygon, driven at any joint; forces by eq. (9) of Hayes, Hninn, Irani


JOINT_FORCES = ("F41", "F21", "F32", "F43")
PLANAR_FORCES = _orders(
    "",
    "",
    "F41 F41_x F41_y F21 F21_x F21_y F32 F32_x F32_y F43 F43_x F43_y shaking_force shaking_force_x shaking_force_y "
    "T41 input_power shaking_moment shaking_moment_at shaking_moment_printed",
)
PLANAR_JOINTS = _orders(
    "joint_angle_1 joint_angle_2 joint_angle_3 joint_angle_4 v1 v2 v3 v4 transmission_angle A_x A_y B_x B_y P_x P_y",
    "joint_omega_1 joint_omega_2 joint_omega_3 joint_omega_4",
    "joint_alpha_1 joint_alpha_2 joint_alpha_3 joint_alpha_4",
)
FIXED_FRAME = PLANAR_JOINTS | PLANAR_FORCES
FIXED_FRAME |= _orders(
    "theta2 theta4 instant_centre_x instant_centre_y relative_centre_x",
    "omega2 omega4 P_vx P_vy P_speed mechanical_advantage",
    "alpha2 alpha4 P_ax P_ay curvature",
    "jerk2 jerk4",
)


def _planar_joints(ctx: Any, at: Mapping[str, Any], joint: int, order: int, values: Values) -> list[Series]:
    """Add the quantities of the four joints; return the directions of the four links over the drive."""
    _add_joint(ctx, values, joint, at[f"joint_angle_{joint}"])
    number = [(joint - 2 + k) % 4 for k in range(4)]  # of the links from 0: the one before the joint first
    drive = drive_of(ctx, at[f"joint_angle_{joint}"], order)
    found = polygon(ctx, [at[f"a{k + 1}"] for k in number], drive, at["branch"])
    directions = [found[number.index(k)] for k in range(4)]
    directions = [one - directions[3] + ctx.pi for one in directions]
    rate, acceleration = at.get(f"joint_omega_{joint}"), at.get(f"joint_alpha_{joint}", ctx.mpf(0))
    for i in range(4):
        angle = directions[i] - directions[i - 1]
        _add_joint(ctx, values, i + 1, angle.terms[0])
        if rate is not None:
            values |= rates(
                angle.at_speed(rate, acceleration), (f"joint_omega_{i + 1}", f"joint_alpha_{i + 1}")
            )
    values["transmission_angle"] = ctx.pi - abs(values[f"joint_angle_{(joint + 1) % 4 + 1}"])
    return directions


def _add_joint(ctx: Any, values: Values, joint: int, angle: Any) -> None:
    """Add the angle of a joint, and the tangent of its half."""
    cosine, sine = ctx.cos_sin(angle)
    values[f"joint_angle_{joint}"] = ctx.atan2(sine, cosine)
    if cosine > 0 or sine != 0:
        values[f"v{joint}"] = sine / (1 + cosine) if cosine > 0 else (1 - cosine) / sine


def _by_joint(ctx: Any, at: Mapping[str, Any], order: int, _: bool, values: Values) -> None:
    """Add the quantities of the linkage that is driven at a joint of its polygon."""
    joint = next(k for k in (1, 2, 3, 4) if f"joint_angle_{k}" in at)
    # a bar that is driven at the ground has its end where the loop does not close, too
    if joint == 1:
        values |= coordinates({"A": -at["a1"] * rotation(ctx, at["joint_angle_1"])})
    elif joint == 4:
        values |= coordinates({"B": at["a4"] + at["a3"] * rotation(ctx, -at["joint_angle_4"])})
    directions = _planar_joints(ctx, at, joint, order, values)
    _add_places(ctx, at, rotation(ctx, directions[0]), rotation(ctx, directions[1]), values)


def _fixed_frame(ctx: Any, at: Mapping[str, Any], order: int, forces: bool, values: Values) -> None:
    """Add the quantities of the linkage that is driven at O, in the frame of the ground."""
    speed = at.get("omega1"), at.get("alpha1", ctx.mpf(0))
    values |= coordinates({"A": at["a1"] * rotation(ctx, at["theta1"])})
    given = {**at, "joint_angle_1": at["theta1"] - ctx.pi}
    if "omega1" in at:
        given |= {"joint_omega_1": speed[0], "joint_alpha_1": speed[1]}
    directions = _planar_joints(ctx, given, 1, order, values)
    crank, coupler, output, _ = (rotation(ctx, one) for one in directions)
    places = _add_places(ctx, at, crank, coupler, values)
    for k, angle in {2: directions[1], 4: directions[2] - ctx.pi}.items():
        values[f"theta{k}"] = wrapped(ctx, angle.terms[0])
        if "omega1" in at:
            values |= rates(angle.at_speed(*speed), (f"omega{k}", f"alpha{k}", f"jerk{k}"))
    if order and (rate := directions[2].derivative(1)) != 0:
        values["mechanical_advantage"] = 1 / rate
    A, B, D = places["A"].terms[0], places["B"].terms[0], ctx.mpc(at["a4"], 0)
    if (across := cross(A, B - D)) != 0:
        values |= coordinates({"instant_centre": A * (cross(D, B - D) / across)})
    if (rise := (B - A).imag) != 0:
        values["relative_centre_x"] = A.real - A.imag * (B - A).real / rise
    if "P" in places and order:
        _add_point(at, places["P"], speed, order, values)
    if forces:
        _add_planar_forces(ctx, at, (crank, coupler, -output), places, speed, values)


def _add_places(
    ctx: Any, at: Mapping[str, Any], crank: Series, coupler: Series, values: Values
) -> dict[str, Series]:
    """Add the places of A, B and P by the turns of crank and coupler; return them over the drive."""
    places = {"A": at["a1"] * crank}
    places["B"] = places["A"] + at["a2"] * coupler
    if "P_u" in at and "P_v" in at:
        places["P"] = places["A"] + ctx.mpc(at["P_u"], at["P_v"]) * coupler
    values |= coordinates(places)
    return places


def _add_point(
    at: Mapping[str, Any], place: Series, speed: tuple[Any, Any], order: int, values: Values
) -> None:
    """Add velocity, acceleration and curvature of the coupler point."""
    if order >= 2 and (size := abs(place.derivative(1))) != 0:
        values["curvature"] = cross(place.derivative(1), place.derivative(2)) / size**3
    if "omega1" in at:
        of_time = rates(place.at_speed(*speed), "va")
        values |= {f"P_{name}x": vector.real for name, vector in of_time.items()}
        values |= {f"P_{name}y": vector.imag for name, vector in of_time.items()}
        values["P_speed"] = abs(of_time["v"])


def _add_planar_forces(
    ctx: Any,
    at: Mapping[str, Any],
    directions: tuple[Series, Series, Series],
    places: Mapping[str, Series],
    speed: tuple[Any, Any],
    values: Values,
) -> None:
    """Add what eq. (9) gives, with gravity, loads and counterweights."""
    zero = ctx.mpf(0)
    A, B, D = places["A"].terms[0], places["B"].terms[0], ctx.mpc(at["a4"], 0)
    origins = (0 * directions[0], places["A"], 0 * directions[2] + D)
    lengths = [at[f"a{i}"] for i in (1, 2, 3)]
    links = chain(ctx, at, lengths, origins, directions, (ctx.mpc(0, 0), A, B, D), speed)
    if "FP_x" in at or "FP_y" in at:
        load = ctx.mpc(at.get("FP_x", zero), at.get("FP_y", zero))
        links[1].loads.append((load, places["P"].terms[0]))
    omega4 = values["omega4"]
    links[2].load_torque = (
        at.get("T_load", zero)
        + at.get("T_load_linear", zero) * omega4
        + at.get("T_load_quadratic", zero) * omega4 * abs(omega4)
    )
    found = reactions(links, [], ctx.mpc(at.get("gravity_x", zero), at.get("gravity_y", zero)))
    forces = {name: ctx.mpc(*found[2 * k : 2 * k + 2]) for k, name in enumerate(JOINT_FORCES)}
    torque, on_ground = found[8], -forces["F43"]
    forces["shaking_force"] = on_ground - forces["F41"]
    moment = -torque + cross(D, on_ground)
    about = ctx.mpc(at.get("M_x", zero), at.get("M_y", zero))
    values |= _with_sizes(forces) | {
        "T41": torque,
        "input_power": torque * at["omega1"],
        "shaking_moment": moment,
        "shaking_moment_at": moment - cross(about, forces["shaking_force"]),
        "shaking_moment_printed": -torque + cross(D - links[2].centre, on_ground),
    }


PLANAR_DESIGN = _orders(
    "theta1_low theta1_high theta4_low theta4_high grashof_excess least_transmission_angle"
)


def _planar_design(ctx: Any, at: Mapping[str, Any], values: Values) -> None:
    """Add the facts of a design: of one that assembles the ranges of its angles, by triangles."""
    a1, a2, a3, a4 = (at[f"a{i}"] for i in (1, 2, 3, 4))
    lengths = sorted((a1, a2, a3, a4))
    values["grashof_excess"] = lengths[3] + lengths[0] - lengths[1] - lengths[2]
    if lengths[3] > lengths[0] + lengths[1] + lengths[2]:
        raise Open("one link is longer than the other three together")
    angle = partial(triangle_angle, ctx)
    least, greatest = max(abs(a4 - a1), abs(a2 - a3)), min(a1 + a4, a2 + a3)
    values |= {"theta1_low": angle(a1, a4, least), "theta1_high": angle(a1, a4, greatest)}
    values["least_transmission_angle"] = min(angle(a2, a3, least), ctx.pi - angle(a2, a3, greatest))
    least, greatest = max(abs(a3 - a4), abs(a1 - a2)), min(a3 + a4, a1 + a2)
    values["theta4_low"] = ctx.pi - angle(a3, a4, greatest)
    values["theta4_high"] = ctx.pi - angle(a3, a4, least)


# -- The offset slider-crank from its closed loop; forces of three free bodies


SLIDER_FORCES = _orders(
    "",
    "",
    "F41 F41_x F41_y F21 F21_x F21_y F32 F32_x F32_y shaking_force shaking_force_x shaking_force_y side_force "
    "T41 input_power shaking_moment",
)
SLIDER_CRANK = SLIDER_FORCES | _orders(
    "A_x A_y slider_position theta2 transmission_angle instant_centre_x instant_centre_y",
    "slider_velocity omega2 mechanical_advantage",
    "slider_acceleration alpha2",
    "slider_jerk jerk2",
)


def _slider_crank(ctx: Any, at: Mapping[str, Any], order: int, forces: bool, values: Values) -> None:
    """Add the quantities of one configuration."""
    r, l, e = (at[name] for name in "rle")
    values |= coordinates({"A": r * rotation(ctx, at["theta"])})
    drive = drive_of(ctx, at["theta"], order)
    rise = e - r * ctx.sin(drive.terms[0])
    if abs(rise) > l:
        raise Open("the rod does not reach the line of the slider")
    along = ctx.sqrt((l - rise) * (l + rise)) * (1 if at["branch"] == 1 else -1)

    def closure(unknown: list[Series], drive: Series) -> list[Series]:
        end = r * rotation(ctx, drive) + l * rotation(ctx, unknown[0]) - ctx.mpc(0, e)
        return [end.real - unknown[1], end.imag]

    start = (ctx.atan2(rise, along), r * ctx.cos(drive.terms[0]) + along)
    rod, slider = solved(ctx, closure, start, drive)
    values["slider_position"] = slider.terms[0]
    values["theta2"] = wrapped(ctx, rod.terms[0])
    values["transmission_angle"] = abs(wrapped(ctx, rod.terms[0] + ctx.pi - ctx.pi / 2))
    A, slope = r * rotation(ctx, at["theta"]), slider.derivative(1) if order else 0
    if slope != 0:
        values["mechanical_advantage"] = 1 / slope
    if A.real != 0:  # OA meets the line through B that is square to its own
        values |= coordinates({"instant_centre": A * (slider.terms[0] / A.real)})
    if "omega" in at:
        names = ("slider_velocity", "slider_acceleration", "slider_jerk")
        values |= rates(slider.at_speed(at["omega"]), names)
        values |= rates(rod.at_speed(at["omega"]), ("omega2", "alpha2", "jerk2"))
    if forces:
        directions = rotation(ctx, drive), rotation(ctx, rod)
        _add_slider_forces(ctx, at, directions, slider + ctx.mpc(0, e), values)


def _add_slider_forces(
    ctx: Any, at: Mapping[str, Any], directions: tuple[Series, Series], B: Series, values: Values
) -> None:
    """Add joint forces, torque, shaking force and moment."""
    zero, omega, A = ctx.mpf(0), at["omega"], at["r"] * directions[0]
    joints = (ctx.mpc(0, 0), A.terms[0], B.terms[0])
    links = chain(ctx, at, (at["r"], at["l"]), (0 * directions[0], A), directions, joints, (omega,))
    pushed = at["m3"] * B.at_speed(omega).derivative(2).real - at.get("F_load", zero)
    # of the unknowns F41, F21, F32, T41 and the side force
    slider = [[0, 0, 0, 0, -1, 0, 0, 0, pushed], [0, 0, 0, 0, 0, -1, 0, 1, zero]]
    found = reactions(links, slider, ctx.mpc(0, 0))
    forces = {name: ctx.mpc(*found[2 * k : 2 * k + 2]) for k, name in enumerate(JOINT_FORCES[:3])}
    torque, side = found[6], found[7]
    on_ground = ctx.mpc(0, -side)
    forces["shaking_force"] = on_ground - forces["F41"]
    values |= _with_sizes(forces) | {"side_force": side, "T41": torque, "input_power": torque * omega}
    values["shaking_moment"] = -torque + cross(B.terms[0], on_ground)


def _slider_design(ctx: Any, at: Mapping[str, Any], values: Values) -> None:
    """Add the dead centres of a design that assembles, by right triangles."""
    r, l, e = (at[name] for name in "rle")
    outer = (l + r - e) * (l + r + e)
    if outer < 0:
        raise Open("crank and rod do not reach the line of the slider")
    inner = (abs(l - r) - e) * (abs(l - r) + e)
    values["outer_dead_centre"] = ctx.sqrt(outer)
    values["inner_dead_centre"] = ctx.sqrt(inner) if inner >= 0 else ctx.nan
    values["stroke"] = ctx.sqrt(outer) - ctx.sqrt(inner) if inner >= 0 else 2 * ctx.sqrt(outer)


# -- The Minkowskian 4R from the closure of its loop in null coordinates: eqs. (5) and (9) of Hegedüs and Moore


MINKOWSKI = _orders(
    "A_x A_y B_x B_y X_x X_y psi phi cosh_zeta zeta AB_rapidity AB_orientation CB_orientation half_angle_root "
    "coefficient_A coefficient_B coefficient_C delta psi_remark lambda_AX mu_BX",
    "dpsi_dtheta",
    "d2psi_dtheta2",
)
MINKOWSKI_DESIGN = _orders(
    "T1 T2 T3 T4 T5 T7 theta_escape r_AX s_BX gamma cosh_theta_min cosh_theta_max cosh_psi_min cosh_psi_max"
)
#: Rapidities beyond which the equations take too many digits.
GREATEST = 4000


def _digits_of_rapidity(at: Mapping[str, Any]) -> int | None:
    """Return the digits that the loop loses, whose terms are e^theta and e^-theta; None if these are too many."""
    theta = abs(float(at.get("theta", 0.0)))
    return 50 * math.ceil(theta / 50) if theta <= GREATEST else None


def _minkowski_4r(ctx: Any, at: Mapping[str, Any], order: int, _: bool, values: Values) -> None:
    """Add the quantities of one configuration."""
    a, b, g, h = (at[name] for name in "abgh")
    drive = drive_of(ctx, at["theta"], order)
    p = ctx.exp(drive.terms[0])
    values |= _from_null("A", a * p, a / p)
    ch, sh = (p + 1 / p) / 2, (p - 1 / p) / 2
    # of Theorem 3.1
    A, B, C = 2 * g * b - 2 * a * b * ch, 2 * a * b * sh, h * h - g * g - b * b - a * a + 2 * a * g * ch
    values |= {"coefficient_A": A, "coefficient_B": B, "coefficient_C": C}
    sign = 1 if at["branch"] == 1 else -1
    if abs(B) < A:  # the closed form of the Remark has a value
        values["delta"] = ctx.atanh(B / A)
        cosh = C / ctx.sqrt(A * A - B * B)
        if cosh >= 1:
            values["psi_remark"] = sign * ctx.acosh(cosh) - values["delta"]
    try:
        square = closed(ctx, B * B + C * C - A * A, B * B + C * C + A * A, "no root of eq. (3) is real")
    except Open:
        values |= {"CB_orientation": ctx.mpf(0), "AB_orientation": ctx.mpf(0)}
        raise
    # y = top/below, q = (1 + y)/(1 - y) = e^psi, or -e^psi where CB is past-pointing
    top, below = -B + sign * ctx.sqrt(square), A + C
    q = (below + top) / (below - top) if below != top else 0
    k = (g + b * q - a * p) / h
    if k == 0 or q == 0:
        raise Singular("a root is infinite")
    signs = [1 if one > 0 else -1 for one in (q, k)]

    def closure(unknown: list[Series], drive: Series) -> list[Series]:
        CB, AB = (sign * exponential(ctx, one) for sign, one in zip(signs, unknown, strict=True))
        OA = exponential(ctx, drive)
        return [a * OA + h * AB - b * CB - g, a / OA + h / AB - b / CB - g]

    psi, rapidity = solved(ctx, closure, [ctx.log(abs(q)), ctx.log(abs(k))], drive)
    q, k = (sign * ctx.exp(one.terms[0]) for sign, one in zip(signs, (psi, rapidity), strict=True))
    values |= {"psi": psi.terms[0], "AB_rapidity": rapidity.terms[0]}
    values |= {"CB_orientation": ctx.mpf(signs[0]), "AB_orientation": ctx.mpf(signs[1])}
    values["phi"] = rapidity.terms[0] - drive.terms[0] + ctx.pi
    if q != -1:
        values["half_angle_root"] = (q - 1) / (q + 1)
    # of vectors (u, v) and (x, y) in null coordinates the scalar product is (u y + v x)/2
    values["cosh_zeta"] = (k / q + q / k) / 2
    if values["cosh_zeta"] >= 1:
        values["zeta"] = abs(rapidity.terms[0] - psi.terms[0])
    values |= _from_null("B", g + b * q, g + b / q)
    if "x" in at and "y" in at:
        AX = (at["x"] + at["y"]) * k, (at["x"] - at["y"]) / k
        BX = AX[0] - h * k, AX[1] - h / k
        values |= _from_null("X", a * p + AX[0], a / p + AX[1])
        for name, (u, v) in (("lambda_AX", AX), ("mu_BX", BX)):
            if u * v != 0:
                values[name] = ctx.log(abs(u / v)) / 2
    values |= rates(psi, ("dpsi_dtheta", "d2psi_dtheta2"))


def _from_null(name: str, u: Any, v: Any) -> Values:
    """Return the coordinates of a point from its null coordinates."""
    return {f"{name}_x": (u + v) / 2, f"{name}_y": (u - v) / 2}


def _minkowski_design(ctx: Any, at: Mapping[str, Any], values: Values) -> None:
    """Add the sums of lengths, and the limits of Theorems 3.8 and 3.10 as they stand there."""
    a, b, g, h = (at[name] for name in "abgh")
    values |= {"T1": g + b - h - a, "T2": a - g + b - h, "T3": g - a - b - h}
    values |= {"T4": g - a + b + h, "T5": a - h + g + b, "T7": g + b + a + h}
    values["cosh_theta_min"] = (a * a + g * g - (b + h) ** 2) / (2 * a * g)
    values["cosh_theta_max"] = (a * a + g * g - (b - h) ** 2) / (2 * a * g)
    values["cosh_psi_min"] = ((a - h) ** 2 - g * g - b * b) / (2 * b * g)
    values["cosh_psi_max"] = ((a + h) ** 2 - g * g - b * b) / (2 * b * g)
    values["theta_escape"] = abs(ctx.log(g / a))
    if "x" in at and "y" in at:
        x, y = at["x"], at["y"]
        AX, BX = (x + y, x - y), (x - h + y, x - h - y)
        values |= {"r_AX": ctx.sqrt(abs(AX[0] * AX[1])), "s_BX": ctx.sqrt(abs(BX[0] * BX[1]))}
        if values["r_AX"] * values["s_BX"] != 0:
            values["gamma"] = ctx.log(abs(BX[0] * AX[1] / (BX[1] * AX[0]))) / 2


# -- Five-bar linkages with Hart's relation of angles: Wunderlich's (1.2) to (1.4), from which F follows

# M = 0, N = d, P = m u, Q = d + n v and F = P - p u w = Q + q v w, with u, v, w complex numbers of size 1.


@dataclass(frozen=True)
class Position:
    """Directions MP, NQ and e^(i omega), as series of the drive."""

    u: Series
    v: Series
    w: Series


def _between_rockers(ctx: Any, lengths: Sequence[Any], phi: Series, branch: int) -> Series:
    """Return the direction of NB of a four-bar MABN where that of MA is given."""
    # traversed from N: what is an angle from NM to BN here is one from MN to NB
    return polygon(ctx, lengths, phi - ctx.pi, branch)[3]


def _closing(bars: Mapping[str, Any], u: Series, v: Series) -> Position:
    """Return the position of the dyads where the directions of MP and NQ are given."""
    m, n, p, q, d = (bars[name] for name in "mnpqd")
    opening = p * u + q * v
    if opening.terms[0] == 0:
        raise Singular("PF and QF coincide")
    return Position(u, v, (m * u - n * v - d) / opening)


def _by_F(
    ctx: Any, bars: Mapping[str, Any], joint_F: Callable[[Series], Series], drive: Series, omega_sign: int
) -> tuple[Position, list[Series]]:
    """Return the position where F is given, and the angles of MP and NQ."""
    m, n, p, q, d = (bars[name] for name in "mnpqd")
    F = joint_F(drive)
    at = F.terms[0]
    square = at.real * at.real + at.imag * at.imag
    cosine = (m * m + p * p - square) / (2 * m * p)
    size = (m * m + p * p + square) / abs(2 * m * p)
    sine_squared = closed(ctx, (1 - cosine) * (1 + cosine), size, "the dyad MPF does not reach F")
    omega = ctx.atan2(omega_sign * ctx.sqrt(sine_squared), cosine)
    seen = m - p * rotation(ctx, omega)

    def dyad(unknown: list[Series], drive: Series) -> list[Series]:
        missed = rotation(ctx, unknown[0]) * (m - p * rotation(ctx, unknown[1])) - joint_F(drive)
        return [missed.real, missed.imag]

    phi, turned = solved(ctx, dyad, (angle_between(ctx, seen, at), omega), drive)
    u, w = rotation(ctx, phi), rotation(ctx, turned)
    seen_from_N = n + q * w
    if seen_from_N.terms[0] == 0:
        raise Singular("F is N")
    v = (F - d) / seen_from_N
    return Position(u, v, w), [phi, argument(ctx, v)]


def _joints(bars: Mapping[str, Any], ratio: Any, at: Position) -> dict[str, Series]:
    """Return the joints A, B, P, Q and F."""
    m, n, d = (bars[name] for name in "mnd")
    places = {"P": m * at.u, "Q": n * at.v + d, "A": ratio * m * at.u, "B": ratio * n * at.v + d}
    return places | {"F": places["P"] - bars["p"] * at.u * at.w}


def _meeting(ctx: Any, A: Any, B: Any, d: Any) -> Values:
    """Return where MA and NB meet, and MN and AB, as far as they do."""
    found: Values = {}
    to_B = B - d
    sine = cross(A, to_B)
    if not of_rounding(ctx, sine, abs(A) * abs(to_B)):
        found |= coordinates({"X": A * (d * to_B.imag / sine)})
    if not of_rounding(ctx, B.imag - A.imag, abs(A.imag) + abs(B.imag)):
        found["Y_x"] = A.real - A.imag * (B.real - A.real) / (B.imag - A.imag)
    return found


CIRCLES = ("PFQX", "SFTY", "PSQT")


def _circles(ctx: Any, joints: Mapping[str, Any]) -> Values:
    """Return centre and radius of the circles whose first three points are known and not in line."""
    found: Values = {}
    for name in CIRCLES:
        if any(joint not in joints for joint in name[:3]):
            continue
        one, two, three = (joints[joint] for joint in name[:3])
        to_two, to_three = two - one, three - one
        area = cross(to_two, to_three)
        if of_rounding(ctx, area, abs(to_two) * abs(to_three)):
            continue
        # as far from the second and third point as from the first
        squares = (abs(to_two) ** 2, abs(to_three) ** 2)
        x = (squares[0] * to_three.imag - squares[1] * to_two.imag) / (2 * area)
        y = (squares[1] * to_two.real - squares[0] * to_three.real) / (2 * area)
        found |= {f"{name}_x": one.real + x, f"{name}_y": one.imag + y}
        found[f"{name}_radius"] = (x * x + y * y) ** 0.5
    return found


def _seen_from_AB(joints: Mapping[str, Any], A: Any, B: Any) -> Values:
    """Return joints in the frame of AB."""
    found: Values = {}
    for name, joint in joints.items():
        seen = (joint - A) * (B - A).conjugate() / abs(B - A)
        found |= {f"{name}_along_AB": seen.real, f"{name}_across_AB": seen.imag}
    return found


# -- Burmester's focal mechanism: its bars from (2.5) and (1.9), its joints from (1.3), (1.4) and (3.2)


FOCAL = _orders(
    "A_x A_y B_x B_y P_x P_y Q_x Q_y T_x T_y F_x F_y X_x X_y Y_x psi omega_angle alpha beta chi "
    "transmission_angle_P transmission_angle_Q transmission_angle_F PFQX_x PFQX_y PFQX_radius SFTY_x SFTY_y "
    "SFTY_radius PSQT_x PSQT_y PSQT_radius M_along_AB M_across_AB N_along_AB N_across_AB S_along_AB S_across_AB "
    "F_along_AB F_across_AB"
)
FOCAL_BY_ROCKER = FOCAL | _orders("sigma", "dpsi_dphi psi_rate dsigma_dphi sigma_rate")
FOCAL_BY_CRANK = FOCAL | _orders("phi", "dpsi_dsigma psi_rate dphi_dsigma phi_rate")
FOCAL_DESIGN = _orders("lambda_ m n p q r FT s S_x T_ratio line_x line_along_AB")


def _focal_design(ctx: Any, at: Mapping[str, Any], values: Values) -> None:
    """Add the bars of a design, by Newton's iteration on eq. (2.5)."""
    a, b, c, d = (at[name] for name in "abcd")
    rho: Any = at.get("rho")
    factor: Any = at.get("lambda_")
    squares = a * a + b * b + d * d - c * c
    # the quadratic equation that section 6 speaks of, for lambda or for rho; the first completion is the greater root
    if factor is None:
        share = at["s"] / d if "s" in at else rho / (1 + rho) if rho != -1 else None
        if share is not None:
            values["T_ratio"], values["s"], values["S_x"] = share, share * d, share * d
        if rho == 0 or share == 0 or share == 1:
            raise Singular("S is M or N")
        if "s" in at:
            rho = at["s"] / (d - at["s"])
        _assembled(a, b, c, d)
        sides = rho * b * b + a * a / rho
        roots = _roots(ctx, d * d, -(squares + sides), a * a + b * b + sides)
        factor = sorted(roots, key=lambda root: -abs(root - 1))[at["completion"] - 1]
    else:
        _assembled(a, b, c, d)
        none, one = a * a * (1 - factor), d * d * factor * factor - squares * factor + a * a + b * b
        roots = _roots(ctx, b * b * (1 - factor), one, none)
        rho = sorted(roots, key=lambda root: -abs(root))[at["completion"] - 1]
    if factor == 0 or factor == 1 or rho == 0:
        raise Singular("a bar has no length, or no end")
    square = (factor - 1) * a * a / (factor * factor * rho)
    if square <= 0:
        raise Open("p and q are imaginary")
    q = ctx.sqrt(square)
    start = [a / factor, b / factor, rho * (b / factor) * q / (a / factor), q]

    def equations(unknown: list[Series], _drive: Series) -> list[Series]:
        m, n, p, q = unknown
        ties = [a * n - b * m, b * m - (m * n + p * q)]
        ties.append(a * (m * m + n * n - p * p - q * q + d * d) - m * squares)
        return [*ties, a - factor * m if "lambda_" in at else m * p - rho * n * q]

    m, n, p, q = (one.terms[0] for one in solved(ctx, equations, start, Series((0 * a,))))
    values |= {"m": m, "n": n, "p": p, "q": q, "lambda_": 1 + p * q / (m * n)}
    weight = m * p + n * q
    if rho == -1:
        values["line_x"] = d / 2 + (m * m + p * p - n * n - q * q) / (2 * d)
        AP, BQ = p * q / n, p * q / m
        values["line_along_AB"] = c / 2 + (AP * AP + p * p - BQ * BQ - q * q) / (2 * c)
        return
    values["s"] = values["S_x"] = m * p * d / weight
    values["T_ratio"] = m * p / weight
    values["r"] = _radius(ctx, m, n, p, q, d)
    # section 3: fixed AB makes it the five-bar BQFPA
    values["FT"] = _radius(ctx, p * q / m, p * q / n, q, p, c)


def _assembled(*lengths: Any) -> None:
    """Raise where one link of the four-bar is longer than the other three together."""
    if 2 * max(lengths) > sum(lengths):
        raise Open("the four-bar never assembles")


def _roots(ctx: Any, two: Any, one: Any, none: Any) -> tuple[Any, Any]:
    """Return the roots of a quadratic equation."""
    square = closed(ctx, one * one - 4 * two * none, one * one + abs(4 * two * none), "no root is real")
    if two == 0:
        raise Singular("a root is infinite")
    return tuple((sign * ctx.sqrt(square) - one) / (2 * two) for sign in (1, -1))


def _radius(ctx: Any, m: Any, n: Any, p: Any, q: Any, d: Any) -> Any:
    """Return the radius of the circle of F, eq. (1.8)."""
    squares = m * m + n * n + p * p + q * q - d * d
    top = m * m * n * n * (p * p + q * q) + (m * m + n * n) * p * p * q * q + m * n * p * q * squares
    if top <= 0:
        raise Singular("the circle of F has no radius")
    return ctx.sqrt(top) / abs(m * p + n * q)


def _focal(ctx: Any, at: Mapping[str, Any], order: int, _: bool, values: Values) -> None:
    """Add the quantities of one configuration."""
    by = "sigma" if "sigma" in at else "phi"
    drive, bars = drive_of(ctx, at[by], order), dict(at)
    if by == "sigma":
        _focal_design(ctx, at, bars)
        found, names = _by_crank(ctx, bars, drive, values)
    else:
        found, names = _by_rocker(ctx, at, bars, drive, values)
    places = _joints(bars, bars["lambda_"], found)
    values |= _focal_angles(ctx, bars, places, found.w.terms[0])
    if "T_ratio" in bars:
        places["T"] = places["A"] + bars["T_ratio"] * (places["B"] - places["A"])
        if by == "phi" and "r" in bars:
            names["sigma"] = argument(ctx, places["F"] - bars["s"])
    values |= coordinates(places) | _figures(ctx, bars, places)
    _add_angles(ctx, at, names, by, values)


def _figures(ctx: Any, bars: Mapping[str, Any], places: Mapping[str, Series]) -> Values:
    """Return points, circles and joints in the frame of AB, as far as the joints are known."""
    joints = {name: place.terms[0] for name, place in places.items()}
    A, B, d = joints["A"], joints["B"], bars["d"]
    joints |= {"M": 0 * A, "N": 0 * A + d}
    if "s" in bars:
        joints["S"] = 0 * A + bars["s"]
    seen = {name: joints[name] for name in "MNSF" if name in joints}
    return _meeting(ctx, A, B, d) | _circles(ctx, joints) | _seen_from_AB(seen, A, B)


def _by_crank(
    ctx: Any, bars: Mapping[str, Any], drive: Series, values: Values
) -> tuple[Position, dict[str, Series]]:
    """Return the position that SF gives, and the angles of MA and NB; F is nowhere where both dyads do not reach it."""
    if "r" not in bars:
        raise Open("there is no crank")

    def joint_F(drive: Series) -> Any:
        return rotation(ctx, drive) * bars["r"] + bars["s"]

    try:
        found, angles = _by_F(ctx, bars, joint_F, drive, 1 if bars["branch"] == 1 else -1)
    except Singular:
        values |= coordinates({"F": joint_F(drive)})
        raise
    return found, dict(zip(("phi", "psi"), angles, strict=True))


def _by_rocker(
    ctx: Any, at: Mapping[str, Any], bars: Values, drive: Series, values: Values
) -> tuple[Position, dict[str, Series]]:
    """Return the position that MA gives, and the angle of NB; what is there without dyads is added first."""
    a, b, c, d = (at[name] for name in "abcd")
    u = rotation(ctx, drive)
    values |= coordinates({"A": a * u})
    completed: ArithmeticError | None = None
    try:
        _focal_design(ctx, at, bars)
        values |= coordinates({"P": bars["m"] * u})
    except (Open, Singular) as error:
        completed = error
    try:
        psi = _between_rockers(ctx, (d, a, c, b), drive, at["branch"])
    except Open as error:
        # the bars that are not told here may exist, and P with them
        raise completed if isinstance(completed, Singular) else error from None
    v = rotation(ctx, psi)
    places = {"B": b * v + d}
    if "T_ratio" in bars:
        places["T"] = a * u + bars["T_ratio"] * (places["B"] - a * u)
    values |= coordinates(places) | _figures(ctx, bars, places | {"A": a * u})
    _add_angles(ctx, at, {"psi": psi}, "phi", values)
    if completed is not None:
        # PF and QF are parallel to MA and NB turned by omega, whatever their lengths
        sign = at["rho"] if "rho" in at else at["s"] * (d - at["s"]) if "s" in at else at["lambda_"] - 1
        if sign != 0:
            ahead = -1 if sign < 0 else 1
            values["transmission_angle_F"] = abs(angle_between(ctx, ahead * u.terms[0], -v.terms[0]))
        raise completed
    return _closing(bars, u, v), {"psi": psi}


def _add_angles(
    ctx: Any, at: Mapping[str, Any], angles: Mapping[str, Series], by: str, values: Values
) -> None:
    """Add angles, and their rates where the series have them."""
    for name, angle in angles.items():
        values[name] = wrapped(ctx, angle.terms[0])
        values |= rates(angle, [f"d{name}_d{by}"])
        if len(angle.terms) > 1 and "omega" in at:
            values[f"{name}_rate"] = angle.derivative(1) * at["omega"]


def _focal_angles(ctx: Any, bars: Mapping[str, Any], places: Mapping[str, Series], w: Any) -> Values:
    """Return the angles at F, P and Q, from the joints."""
    A, P, Q, F = (places[name].terms[0] for name in "APQF")
    M, N = 0 * F, 0 * F + bars["d"]

    def between(corner: Any, one: Any, other: Any) -> Any:
        return angle_between(ctx, one - corner, other - corner)

    return {
        "omega_angle": ctx.atan2(w.imag, w.real),
        "alpha": between(F, N, Q),
        "beta": between(F, P, M),
        "chi": between(F, A, M),
        "transmission_angle_P": abs(between(P, M, F)),
        "transmission_angle_Q": abs(between(Q, N, F)),
        "transmission_angle_F": abs(between(F, P, Q)),
    }


# -- Hart's straight-line linkage: its bars from (7.2) to (7.4), its joints from (1.3) and (1.4)


HART = _orders(
    "A_x A_y B_x B_y P_x P_y Q_x Q_y PF_mid_x PF_mid_y F_x psi omega_angle M_along_AB M_across_AB "
    "N_along_AB N_across_AB F_along_AB F_across_AB"
)
HART_BY_ROCKER = HART | _orders("F_y", "dF_y_dphi dpsi_dphi")
HART_BY_LINE = HART | _orders("phi", "dphi_dF_y dpsi_dF_y")
HART_DESIGN = _orders("p q a b c lambda_ line_x line_along_AB F_y_outer F_y_inner stroke")


def _hart_design(ctx: Any, at: Mapping[str, Any], values: Values) -> None:
    """Add the bars of a design, and of one that assembles its line, and how much of it F traces."""
    m, n, d, kappa = (at[name] for name in ("m", "n", "d", "kappa"))
    ratio = 1 - kappa * kappa
    if kappa == 0 or ratio == 0:
        raise Singular("bars have no length")
    p, q = kappa * n, -kappa * m
    values |= {"p": p, "q": q, "c": kappa * d, "lambda_": ratio, "a": ratio * m, "b": ratio * n}
    _assembled(*(abs(values[name]) for name in "abc"), d)
    # F where the circles about M and about N, of radii that belong to one omega, meet: on a line across MN
    line = d / 2 + (m * m + p**2 - n * n - q**2) / (2 * d)
    ends = [(m + sign * abs(p)) ** 2 - line * line for sign in (1, -1)]
    outer, inner = (ctx.sqrt(max(end, 0 * d)) for end in ends)
    AP, BQ, seen = m - values["a"], n - values["b"], abs(values["c"])
    values["line_along_AB"] = seen / 2 + (AP * AP + p**2 - BQ * BQ - q**2) / (2 * seen)
    values |= {"line_x": line, "F_y_outer": outer, "F_y_inner": inner}
    values["stroke"] = outer - inner if inner > 0 else 2 * outer


def _hart(ctx: Any, at: Mapping[str, Any], order: int, _: bool, values: Values) -> None:
    """Add the quantities of one configuration."""
    by = "F_y" if "F_y" in at else "phi"
    bars = dict(at)
    try:
        _hart_design(ctx, at, bars)
    finally:
        if "a" in bars and by == "phi":
            along_MA = rotation(ctx, at["phi"])
            reach = bars["m"] if bars["a"] > 0 else -bars["m"]
            values |= coordinates({"A": abs(bars["a"]) * along_MA, "P": reach * along_MA})
    ratio, branch, drive = bars["lambda_"], at["branch"], drive_of(ctx, at[by], order)
    if by == "F_y":

        def joint_F(drive: Series) -> Any:
            return drive * ctx.mpc(0, 1) + bars["line_x"]

        side = 1 if (branch == 1) == (bars["kappa"] > 0) else -1
        found, angles = _by_F(ctx, bars, joint_F, drive, side)
        if ratio < 0:  # MA points away from P
            angles = [angle + ctx.pi for angle in angles]
    else:
        lengths = bars["d"], *(abs(bars[name]) for name in "acb")
        angles = [drive, _between_rockers(ctx, lengths, drive, branch)]
        sign = 1 if ratio > 0 else -1  # of MA and MP
        found = _closing(bars, *(sign * rotation(ctx, angle) for angle in angles))
    places = _joints(bars, ratio, found)
    places["PF_mid"] = (places["P"] + places["F"]) / 2
    w = found.w.terms[0]
    values |= {"omega_angle": ctx.atan2(w.imag, w.real)} | rates(places["F"].imag, [f"dF_y_d{by}"])
    for name, angle in zip(("phi", "psi"), angles, strict=True):
        values |= {name: wrapped(ctx, angle.terms[0])} | rates(angle, [f"d{name}_d{by}"])
    A, B, F = (places[name].terms[0] for name in "ABF")
    values |= coordinates(places) | _seen_from_AB({"M": 0 * A, "N": 0 * A + bars["d"], "F": F}, A, B)


# -- The models by mechanism and input


MODELS = {
    ("planar_4r", "theta1"): Model(FIXED_FRAME, PLANAR_DESIGN, _fixed_frame, _planar_design, PLANAR_FORCES),
    **{
        ("planar_4r", f"joint_angle_{k}"): Model(
            PLANAR_JOINTS, ("grashof_excess",), _by_joint, _planar_design
        )
        for k in (1, 2, 3, 4)
    },
    ("minkowski_4r", "theta"): Model(
        MINKOWSKI, MINKOWSKI_DESIGN, _minkowski_4r, _minkowski_design, lost=_digits_of_rapidity
    ),
    ("focal", "phi"): Model(FOCAL_BY_ROCKER, FOCAL_DESIGN, _focal, _focal_design),
    ("focal", "sigma"): Model(FOCAL_BY_CRANK, FOCAL_DESIGN, _focal, _focal_design),
    ("hart", "phi"): Model(HART_BY_ROCKER, HART_DESIGN, _hart, _hart_design),
    ("hart", "F_y"): Model(HART_BY_LINE, HART_DESIGN, _hart, _hart_design),
    ("slider_crank", "theta"): Model(
        SLIDER_CRANK,
        ("outer_dead_centre", "inner_dead_centre", "stroke"),
        _slider_crank,
        _slider_design,
        SLIDER_FORCES,
    ),
}


def _blocks(loops: Loops) -> list[tuple[list[str], Formula]]:
    """Return the equations of loops in parts, each with the unknowns that it determines after those before it.

    Equations with lines of their own before them are one part.
    """
    law, unknowns = loops.formula, set(loops.unknowns)
    rows = [ast.unparse(row) for row in getattr(law.result, "elts", [])]
    if len(law.statements) > 1:
        return [([*loops.unknowns], law)]
    left, found = {row: unknowns.intersection(re.findall(r"\w+", row)) for row in rows}, []
    while left:
        choices = ((own, [row for row, other in left.items() if other <= own]) for own in left.values())
        fitting = [(own, some) for own, some in choices if len(own) == len(some)]
        own, some = min(
            fitting, key=lambda pair: len(pair[0]), default=(set[str]().union(*left.values()), [*left])
        )
        parameters = [name for name in law.parameters if any(re.search(rf"\b{name}\b", row) for row in some)]
        lines = [f"return ({', '.join(some)},)"]
        ordered = [name for name in loops.unknowns if name in own]
        found.append((ordered, Formula(law.name, parameters, lines, law.names)))
        left = {row: other - own for row, other in left.items() if row not in some}
    return found


def _of_loops(catalogue: Catalogue, loops: Loops) -> Model:
    """Return the model of a mechanism whose sheet has the equations of its loops: their root nearest to its facts."""
    position, blocks = catalogue.position.name, _blocks(loops)

    @cache
    def equations_in(ctx: Any) -> list[Formula]:
        def cosine(angle: Any) -> Any:
            return rotation(ctx, angle).real

        def sine(angle: Any) -> Any:
            return rotation(ctx, angle).imag

        names = {
            "cos": cosine,
            "cosine": cosine,
            "sin": sine,
            "sine": sine,
            "PI": ctx.pi,
            "TWO_PI": 2 * ctx.pi,
        }
        found = []
        for _, law in blocks:
            constants = {name: ctx.mpf(x) for name, x in law.names.items() if isinstance(x, float)}
            found.append(Formula(law.name, law.parameters, law.lines, {**constants, **names}))
        return found

    def configuration(ctx: Any, at: Mapping[str, Any], order: int, further: bool, values: Values) -> None:
        zero, curves = 0 * ctx.mpf(1), dict[str, Series]()

        def known_at(drive: Series) -> dict[str, Any]:
            """Return what is known along the drive, or held where that is."""
            count = len(drive.terms)
            if count == 2 and drive.terms[1] == 0:
                return {name: Series((curve.terms[0], zero)) for name, curve in curves.items()}
            return {name: Series(curve.terms[:count]) for name, curve in curves.items()}

        start = read_facts(catalogue, loops.unknowns, {name: float(value) for name, value in at.items()})
        for (unknowns, _law), equation in zip(blocks, equations_in(ctx), strict=True):
            needed = set(equation.parameters).intersection(loops.unknowns).difference(curves, unknowns)
            if needed or not all(math.isfinite(start[name]) for name in unknowns):
                continue  # open, or it stands on a loop that is

            def equations(
                found: list[Series],
                drive: Series,
                unknowns: list[str] = unknowns,
                equation: Formula = equation,
            ) -> list[Series]:
                known = {**at, **known_at(drive), position: drive, **dict(zip(unknowns, found, strict=True))}
                rows = equation(*(known[name] for name in equation.parameters))
                return [Series([zero] * len(drive.terms)) + row for row in rows]

            first = [ctx.mpf(float(start[name])) for name in unknowns]
            series = solved(ctx, equations, first, drive_of(ctx, at[position], order))
            curves |= zip(unknowns, series, strict=True)
        if not curves:
            raise Open("the loop does not close")
        values |= {name: curve.terms[0] for name, curve in curves.items()}
        values |= {name: ctx.nan for name in loops.unknowns if name not in curves}
        for name, (unknown, speed, k) in loops.rates.items():
            if unknown not in curves:
                values[name] = ctx.nan
            elif len(curves[unknown].terms) > k:
                values[name] = curves[unknown].derivative(k) * at[speed] ** k

        if further:
            known = {**at, **values}
            models = (name for name, inputs in catalogue.variant_inputs.items() if inputs.keys() <= at.keys())
            for step in made_by(tuple(models)):
                if all(ctx.isfinite(known.get(need, ctx.nan)) for need in step.depends_on):
                    take(step, known)
            values |= {name: known.get(name, ctx.nan) for name in of_these}

    orders = {**dict.fromkeys(loops.unknowns, 0), **{name: k for name, (_, _, k) in loops.rates.items()}}
    of_these = _made_of(catalogue, orders)

    @cache
    def made_by(models: tuple[str, ...]) -> list[Fact | System]:
        """Return the steps of further quantities, where models of the links stand for inputs."""
        given, variants = _given(catalogue, orders)
        given -= {name for model in models for name in catalogue.variants.get(model, {})}
        return [exact_turns(step) for step in steps_of(catalogue, of_these, given, (*variants, *models))]

    return Model(orders | of_these, (), configuration, lambda ctx, at, values: None, tuple(of_these))


def _given(catalogue: Catalogue, orders: Mapping[str, int]) -> tuple[set[str], tuple[str, ...]]:
    """Return what quantities are made of where the loops are solved, and the variant with equations of all links."""
    solvers = tuple(solver for solver in catalogue.solvers if solver in catalogue.variants)
    return {*orders, *catalogue.all_inputs, catalogue.position.name, "branch"}, solvers[:1]


def _made_of(catalogue: Catalogue, orders: Mapping[str, int]) -> dict[str, int]:
    """Return further quantities, made of those of the loops alone or of what the equations of all links solve."""
    (given, variant), varies = _given(catalogue, orders), catalogue.varies
    found: dict[str, int] = {}
    for name in catalogue.public:
        try:
            steps = () if name in orders else tuple(catalogue.dependencies([name], {*given, *found}, variant))
        except NoDependence:  # of the derivative of a curve, which is given here
            continue
        own = {each for step in steps for each in step.names}
        known = (
            isinstance(step, System) or step.name in catalogue.public or not varies(step.name)
            for step in steps
        )
        if own and all(known):
            needs = {need for step in steps for need in step.depends_on} - own
            if needs <= {*given, *found}:
                order = max((orders.get(need, found.get(need, 0)) for need in needs), default=0)
                found |= dict.fromkeys(own, order)
    return found


def model_of(catalogue: Catalogue) -> Model | None:
    """Return the model of a mechanism by its input, if there is one."""
    if catalogue.loops is not None:
        return _of_loops(catalogue, catalogue.loops)
    mechanism, _, _ = catalogue.name.partition(" driven by ")
    return MODELS.get((mechanism, catalogue.position.name))


#: Where both references differ by more, in units of |f| + sum |x df/dx|, one of them is wrong: facts of some hundred
#: steps lose some digits of their 50.
TOLERANCE = CONTEXT.mpf(10) ** (8 - DIGITS)
#: Digits of the equations, which are not written so that nothing cancels; the second for what then differs.
FEW, MANY = DIGITS + 10, 6 * DIGITS


class IndependentValues:
    """Values of a mechanism's quantities that share no formula with its facts."""

    def __init__(self, catalogue: Catalogue, names: Iterable[str]) -> None:
        self.model, parsed = model_of(catalogue), catalogue.parse
        loops = () if catalogue.loops is None else catalogue.loops.unknowns
        self.turning = TURNING.union(name for name in loops if catalogue.facts[name].units == "rad")
        covered: list[str] = []
        #: By the input of a derivative, "" for none, the quantity that each name is made of.
        self._quantities: dict[str, dict[str, str]] = {}
        for name in names:
            tree = parsed(name)
            of = tree.of if isinstance(tree, (Derivative, Size)) and isinstance(tree.of, Quantity) else tree
            if self.model is not None and self.model.covers(str(of)):
                by = tree.by if isinstance(tree, Derivative) else ""
                self._quantities.setdefault(by, {})[name] = str(of)
                covered.append(name)
        self.names = tuple(covered)

    def difference(self, at: Mapping[str, Any], name: str, exact: Any, unit: Any) -> float | None:
        """Return the difference of one quantity, None if it has no independent value."""
        return self.differences(at, {name: exact}, {name: unit}).get(name) if name in self.names else None

    def values(self, at: Mapping[str, Any], digits: int = FEW) -> dict[str, Any]:
        """Return independent values at a configuration: NaN where the loop is open, none where undetermined."""
        lost = self.model.lost(at) if self.model is not None else None
        if self.model is None or lost is None:
            return {}
        found: dict[str, Any] = {}
        for by, quantities in self._quantities.items():
            if by:
                found |= self._differences(self.model, at, by, quantities, digits + lost)
                continue
            own = self.model.values(context(digits + lost), at, quantities.values())
            known = {name: of for name, of in quantities.items() if of in own}
            found |= {name: own[of] if name == of else abs(own[of]) for name, of in known.items()}
        return found

    def _differences(
        self, model: Model, at: Mapping[str, Any], by: str, quantities: Mapping[str, str], digits: int
    ) -> dict[str, Any]:
        """Return derivatives as central differences, which have the square of their step as error."""
        ctx = context(2 * digits)
        here = ctx.mpf(at[by])
        step = ctx.mpf(10) ** (-digits // 2) * (abs(here) if here != 0 else 1)
        below, above = (
            model.values(ctx, {**at, by: here + sign * step}, quantities.values()) for sign in (-1, 1)
        )
        found = {}
        for name, quantity in quantities.items():
            if quantity in below and quantity in above:
                change = above[quantity] - below[quantity]
                if quantity in self.turning and abs(change) > 3:
                    change -= 2 * ctx.pi * ctx.nint(change / (2 * ctx.pi))
                found[name] = change / (2 * step)
        return found

    def differences(
        self, at: Mapping[str, Any], exact: Mapping[str, Any], units: Mapping[str, Any]
    ) -> dict[str, float]:
        """Return by quantity the difference from exact values in units of their own, infinite if one is no number."""
        found = self._differences_from(exact, units, self.values(at))
        # few digits neither tell lines of links from links nearly in line, nor hold what these cancel
        if len(found) < len(self.names) or any(difference > TOLERANCE for difference in found.values()):
            found = self._differences_from(exact, units, self.values(at, MANY))
        return {name: float(difference) for name, difference in found.items()}

    def _differences_from(
        self, exact: Mapping[str, Any], units: Mapping[str, Any], values: Mapping[str, Any]
    ) -> dict[str, Any]:
        found = {}
        for name, value in values.items():
            one, other = CONTEXT.mpf(value), exact[name]
            if not (CONTEXT.isfinite(one) and CONTEXT.isfinite(other)):
                both = CONTEXT.isnan(one) == CONTEXT.isnan(other)
                found[name] = CONTEXT.zero if both else CONTEXT.inf
                continue
            difference = abs(one - other)
            if name in self.turning and difference > 3:
                difference = abs(difference - 2 * CONTEXT.pi)
            unit = units[name]
            found[name] = difference / unit if unit != 0 else CONTEXT.inf if difference else CONTEXT.zero
        return found
