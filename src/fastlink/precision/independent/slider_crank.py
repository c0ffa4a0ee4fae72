"""The offset slider-crank from its closed loop; forces of three free bodies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fastlink.precision.independent.loops import (
    Link,
    Open,
    Series,
    bar_data,
    cross,
    reactions,
    rotation,
    solved,
    wrapped,
)

__all__ = ["DESIGN", "QUANTITIES", "configuration", "design"]

#: Quantities by the order of the derivatives that they need.
QUANTITIES = dict.fromkeys(("A_x", "A_y", "slider_position", "theta2", "transmission_angle"), 0)
QUANTITIES |= {"slider_velocity": 1, "slider_acceleration": 2, "slider_jerk": 3}
QUANTITIES |= {"omega2": 1, "alpha2": 2, "jerk2": 3}
FORCES = tuple(f"{force}{part}" for force in ("F41", "F21", "F32") for part in ("", "_x", "_y"))
FORCES += ("side_force", "T41", "input_power", "shaking_moment")
FORCES += ("shaking_force", "shaking_force_x", "shaking_force_y")
QUANTITIES |= dict.fromkeys(FORCES, 2)
DESIGN = ("outer_dead_centre", "inner_dead_centre", "stroke")


def configuration(ctx: Any, at: Mapping[str, Any], order: int, forces: bool, values: dict[str, Any]) -> None:
    """Add the quantities of one configuration."""
    r, l, e = (at[name] for name in "rle")
    values["A_x"], values["A_y"] = r * ctx.cos(at["theta"]), r * ctx.sin(at["theta"])
    drive = Series((at["theta"], *([ctx.mpf(1), ctx.mpf(0), ctx.mpf(0)][:order])))
    rise = e - r * ctx.sin(drive.terms[0])
    if abs(rise) > l:
        raise Open("the rod does not reach the line of the slider")
    along = ctx.sqrt((l - rise) * (l + rise)) * (1 if at["branch"] == 1 else -1)
    offset = ctx.mpc(0, e)

    def closure(unknown: list[Series], drive: Series) -> list[Series]:
        end = r * rotation(ctx, drive) + l * rotation(ctx, unknown[0]) - offset
        return [end.real - unknown[1], end.imag]

    start = (ctx.atan2(rise, along), r * ctx.cos(drive.terms[0]) + along)
    rod, slider = solved(ctx, closure, start, drive)
    directions = rotation(ctx, drive), rotation(ctx, rod)
    A = r * directions[0]
    values["slider_position"] = slider.terms[0]
    values["theta2"] = wrapped(ctx, rod.terms[0])
    values["transmission_angle"] = abs(wrapped(ctx, rod.terms[0] + ctx.pi - ctx.pi / 2))
    if "omega" in at:
        for prefix, curve, names in (
            ("slider_", slider, ("velocity", "acceleration", "jerk")),
            ("", rod, ("omega2", "alpha2", "jerk2")),
        ):
            of_time = curve.at_speed(at["omega"])
            values |= {f"{prefix}{name}": of_time.derivative(i) for i, name in enumerate(names[:order], 1)}
    if forces:
        values |= _forces(ctx, at, directions, A, slider + offset)


def _forces(
    ctx: Any, at: Mapping[str, Any], directions: tuple[Series, Series], A: Series, B: Series
) -> dict[str, Any]:
    """Return joint forces, torque, shaking force and moment."""
    zero, omega = ctx.mpf(0), at["omega"]
    # F41, F21, F32, T41, side force
    ends = ([(0, 1, ctx.mpc(0, 0)), (1, 1, A.terms[0])], [(1, -1, A.terms[0]), (2, 1, B.terms[0])])
    rates = directions[0], directions[1]
    links = []
    for i, (direction, origin, length) in enumerate(
        zip(rates, (0 * directions[0], A), (at["r"], at["l"]), strict=True), 1
    ):
        mass, inertia, local = bar_data(ctx, at, i, length)
        curve = (origin + local * direction).at_speed(omega)
        turning = direction.at_speed(omega)
        # of a direction u its second derivative is i alpha u - omega^2 u
        alpha = (turning.derivative(2) / turning.terms[0]).imag
        torque = 6 if i == 1 else None
        links.append(Link([(mass, curve)], inertia * alpha, curve.terms[0], ends[i - 1], torque))
    pushed = at["m3"] * B.at_speed(omega).derivative(2).real - at.get("F_load", zero)
    along, across = [0] * 8, [0] * 8
    along[4] = across[5] = -1
    across[7] = 1
    found = reactions(links, [[*along, pushed], [*across, zero]], ctx.mpc(0, 0))
    forces = {name: ctx.mpc(*found[2 * k : 2 * k + 2]) for k, name in enumerate(("F41", "F21", "F32"))}
    torque, side = found[6], found[7]
    on_ground = ctx.mpc(0, -side)
    forces["shaking_force"] = on_ground - forces["F41"]
    result = {name: abs(force) for name, force in forces.items()}
    result |= {f"{name}_x": force.real for name, force in forces.items()}
    result |= {f"{name}_y": force.imag for name, force in forces.items()}
    moment = -torque + cross(B.terms[0], on_ground)
    return result | {
        "side_force": side,
        "T41": torque,
        "input_power": torque * omega,
        "shaking_moment": moment,
    }


def design(ctx: Any, at: Mapping[str, Any], values: dict[str, Any]) -> None:
    """Add the dead centres of a design that assembles, by right triangles."""
    r, l, e = (at[name] for name in "rle")
    outer = (l + r - e) * (l + r + e)
    if outer < 0:
        raise Open("crank and rod do not reach the line of the slider")
    values["outer_dead_centre"] = ctx.sqrt(outer)
    values["stroke"] = 2 * ctx.sqrt(outer)
    inner = (abs(l - r) - e) * (abs(l - r) + e)
    values["inner_dead_centre"] = ctx.sqrt(inner) if inner >= 0 else ctx.nan
    if inner >= 0:
        values["stroke"] -= ctx.sqrt(outer) + ctx.sqrt(inner)
