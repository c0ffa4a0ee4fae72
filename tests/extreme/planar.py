"""The extreme cases of the planar 4R."""

from __future__ import annotations

import math
from fractions import Fraction

import mpmath as mp
import numpy as np

from tests.extreme.case import Case, Mechanism
from tests.extreme.exact import alone
from tests.support.configurations import LENGTHS, PLANAR

#: Mass centres and coupler point off all lines, so that nothing vanishes by symmetry.
POINTS = {
    "P_u": 0.7,
    "P_v": -0.4,
    "M_x": 0.3,
    "M_y": -0.6,
    "G1_u": 0.21,
    "G1_v": 0.07,
    "G2_u": 0.4,
    "G2_v": -0.13,
    "G3_u": 0.35,
    "G3_v": 0.09,
}
MASSES = {"m1": 1.5, "m2": 0.8, "m3": 2.1, "I1": 0.05, "I2": 0.11, "I3": 0.3}
CRANK_ROCKER = (0.375, 1.1, 0.8, 0.9)
ANGLE = 0.7


def status_of(lengths: tuple[float, ...]) -> str:
    """Return the status of a design by rational arithmetic and the rule of docs/numerics.md."""
    if not all(0.0 < length < math.inf for length in lengths):
        return "invalid_input"
    a, b, c, d = map(Fraction, lengths)
    total, inner, outer = a + b + c + d, (a - b + c - d, a + b - c - d), a - b - c + d
    if 2 * max(a, b, c, d) > total:
        return "never_assembles"
    if any(abs(gap) <= total / 2**53 for gap in (*inner, outer)):
        return "change_point"
    return "rotates_fully" if inner[0] * inner[1] > 0 > outer else "assembles_over_part_of_the_turn"


def case(name: str, lengths: tuple[float, ...], theta: float = ANGLE, **others: float) -> Case:
    given = {"omega1": 25.0} | POINTS | MASSES | dict(zip(LENGTHS, lengths, strict=True)) | others
    return Case(name, given | {"theta1": theta}, status_of(lengths))


def scaled(lengths: tuple[float, ...], by: float) -> tuple[float, ...]:
    return tuple(length * by for length in lengths)


# -- toggles ---------------------------------------------------------------------------------------------------


def beside_toggle(mu: float, end: str, inside: bool) -> Case:
    """A crank beside a toggle: its transmission angle is mu from 0 or pi, or would be beyond it.

    The nearer, the smaller the angle of the toggle itself: there a double is fine enough to be so near.
    """
    toggle, a, d = min(1.0, 3e6 * mu), 1.25, 1.0
    with mp.workdps(50):
        closest = (mp.mpf(a) - d) ** 2
        distance = float(mp.sqrt(closest + 4 * a * d * mp.sin(mp.mpf(toggle) / 2) ** 2))
        b, c = (0.8125 + distance, 0.8125) if end == "0" else (0.375 * distance, 0.625 * distance)
        least, most = (((mp.mpf(b) + sign * c) ** 2 - closest) / (4 * a * d) for sign in (-1, 1))
        away = (1 if inside else -1) * mp.tan(mp.mpf(mu) / 2) ** 2 * (most - least)
        theta = 2 * mp.asin(mp.sqrt(least + away if end == "0" else most - away))
    side = "inside" if inside else "beyond"
    return case(f"{mu:.0e} from {end}, {side}", (a, b, c, d), float(theta))


def toggles(full: bool) -> list[Case]:
    powers = range(1, 13) if full else (1, 4, 8, 12)
    return [
        beside_toggle(10.0**-power, end, inside)
        for power in powers
        for end in ("0", "pi")
        for inside in (True, False)
    ]


# -- change points ---------------------------------------------------------------------------------------------

#: Lengths with a1 + a4 = a2 + a3 and so on, in few bits: a gap added to a1 is exact; and the folded position.
FOLDED = {
    "a1+a3-a2-a4": ((1.25, 1.0, 0.875, 1.125), 0.0),
    "a1+a2-a3-a4": ((1.375, 1.25, 1.5, 1.125), 0.0),
    "a1+a4-a2-a3": ((1.25, 1.0, 1.125, 0.875), math.pi),
}
ULP = np.spacing(1.25)
GAPS = (1e-1, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14, 8 * ULP, 4 * ULP, 2 * ULP, ULP)
EQUAL = {
    "parallelogram": (1.0, 1.75, 1.0, 1.75),
    "kite about A": (1.0, 1.0, 1.75, 1.75),
    "kite about O": (1.0, 1.75, 1.75, 1.0),
    "all equal": (1.0, 1.0, 1.0, 1.0),
    "parallelogram not in binary": (0.1, 0.3, 0.1, 0.3),
    "0.1 + 0.6 = 0.3 + 0.4": (0.1, 0.3, 0.4, 0.6),
}


def change_points(full: bool) -> list[Case]:
    sizes = GAPS if full else (1e-8, 4 * ULP, ULP)
    from_fold = (0.0, 1e-12, 1e-8, -1e-3, 1.0) if full else (0.0, -1e-8)
    gapped = [
        case(f"{gap} = {size:.1e}, {away:.0e} from the fold", (a + size, b, c, d), fold + away)
        for gap, ((a, b, c, d), fold) in FOLDED.items()
        for size in (0.0, *sizes, *(-size for size in sizes))
        for away in from_fold
    ]
    equal = [
        case(f"{name} at {theta:.2g}", lengths, theta)
        for name, lengths in EQUAL.items()
        for theta in ((0.0, 1e-8, 1.0, math.pi / 2, math.pi) if full else (0.0, 1.0))
    ]
    return gapped + equal


# -- scales ----------------------------------------------------------------------------------------------------


def scales(full: bool) -> list[Case]:
    everything = [
        case(
            f"all lengths times 1e{power}",
            scaled(CRANK_ROCKER, 10.0**power),
            **{name: value * 10.0**power for name, value in POINTS.items()},
        )
        for power in (20, 8, -8, -20)
    ]
    one = []
    for i in range(4):
        short, long = list(CRANK_ROCKER), list(CRANK_ROCKER)
        short[i] *= 1e-8
        long[i] *= 1e8
        partner = long[:]
        partner[(i + 1) % 4] = long[i] + 0.25
        name = LENGTHS[i]
        one += [
            case(f"{name} times 1e-8", tuple(short)),
            case(f"{name} times 1e8", tuple(long)),
            case(f"{name} and the next times 1e8", tuple(partner), ANGLE if i != 3 else 1e-9),
        ]
    speeds = [case(f"omega1 = {speed:.0e}", CRANK_ROCKER, omega1=speed) for speed in SPEEDS]
    masses = [
        case("no mass at all", CRANK_ROCKER, **dict.fromkeys(MASSES, 0.0)),
        case("a crank without mass", CRANK_ROCKER, m1=0.0, I1=0.0),
        case("a coupler without mass", CRANK_ROCKER, m2=0.0, I2=0.0),
        case("a coupler of 1e12 times the density", CRANK_ROCKER, m2=0.8e12, I2=0.11e12),
        case("an output link of 1e-12 times the density", CRANK_ROCKER, m3=2.1e-12, I3=0.3e-12),
        case("a point at rest", CRANK_ROCKER, omega1=0.0),
    ]
    return everything + one + speeds + masses


SPEEDS = (1e20, -1e10, 1e-8, -1e-20)


# -- input angles ----------------------------------------------------------------------------------------------


def angles(full: bool) -> list[Case]:
    quarters = range(-4, 5) if full else (-2, -1, 0, 1, 2)
    found = [case(f"theta1 = {k} pi/2", CRANK_ROCKER, k * (math.pi / 2)) for k in quarters]
    small = (5e-324, 1e-300, 1e-160, 1e-16, -1e-8)
    great = (2e6 * math.pi, -2e6 * math.pi, 1e22, 1.7e308)
    found += [case(f"theta1 = {theta:.0e}", CRANK_ROCKER, theta) for theta in (*small, *great)]
    return found + [case(f"parallelogram at {theta:.0e}", EQUAL["parallelogram"], theta) for theta in small]


PLANAR_4R = Mechanism(
    PLANAR,
    {"toggles": toggles, "change points": change_points, "scales": scales, "angles": angles},
    loop="sigma",
    lengths=LENGTHS,
    free=(
        *("A_x", "A_y", "joint_angle_1", "v1", "v1_dot", "v1_ddot", "inertia_force1_x", "inertia_force1_y"),
        *(f"{name}{xy}" for name in ("G1_", "G1_a", "r11_", "r12_") for xy in "xy"),
    ),
    held={
        **dict.fromkeys(("Z0", "C0", "gamma0", "epsilon", "kappa", "crank_excess"), alone),
        **dict.fromkeys(("coupler_offset", "output_offset"), alone),
        "p": lambda values: values["Z"] + abs(values["Z0"]),
        "q": lambda values: values["C"] + abs(values["C0"]),
    },
)
