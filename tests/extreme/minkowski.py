"""The extreme cases of the Minkowskian 4R."""

from __future__ import annotations

import math
from fractions import Fraction

import mpmath as mp

from fastlink.mechanisms import catalogue
from tests.extreme.case import Case, Mechanism
from tests.extreme.exact import alone
from tests.support.minkowski_designs import LENGTHS

#: One design of each way to close: at every theta, outside of a limit, inside and outside of limits.
DESIGNS = ((1.0, 2.0, 3.5, 2.25), (1.0, 2.0, 1.25, 1.5), (1.0, 0.75, 3.5, 1.0))
RAPIDITY = 0.625
#: A unit in the last place of 2.125.
ULP = 2.0**-51


def status_of(lengths: tuple[float, ...]) -> str:
    """Return the status of a design by rational arithmetic: the signs of T1 and T2."""
    a, b, g, h = map(Fraction, lengths)
    if g == a and b == h:
        return "undetermined_at_theta_0"
    product = (g - a + b - h) * (a - g + b - h)
    if product == 0:
        return "branches_meet_at_theta_0"
    return "assembles_over_part_of_theta" if product < 0 else "assembles_at_every_theta"


def case(
    name: str, lengths: tuple[float, ...], theta: float = RAPIDITY, x: float = 0.3, y: float = -0.7
) -> Case:
    inputs = dict(zip(LENGTHS, lengths, strict=True)) | {"x": x, "y": y, "theta": theta}
    return Case(name, inputs, status_of(lengths))


def beside_limit(zeta: float, end: str, closes: bool) -> Case:
    """A rapidity beside a limit of the input, where sinh^2 of half the transmission angle is that of zeta.

    The nearer, the smaller the limit itself: there a double is fine enough to be so near.
    """
    limit, a, g = min(0.5, 3e6 * zeta), 2.0, 1.0
    with mp.workdps(50):
        diagonal = float(mp.sqrt((mp.mpf(a) - g) ** 2 - 4 * a * g * mp.sinh(mp.mpf(limit) / 2) ** 2))
        b, h = (0.8125 + diagonal, 0.8125) if end == "outer" else (0.375 * diagonal, 0.625 * diagonal)
        reach = mp.mpf(b) - h if end == "outer" else mp.mpf(b) + h
        place = ((mp.mpf(a) - g) ** 2 - reach**2) / (4 * a * g)
        away = mp.mpf(b) * h / (a * g) * mp.sinh(mp.mpf(zeta) / 2) ** 2 * (1 if closes else -1)
        theta = 2 * mp.asinh(mp.sqrt(place + away if end == "outer" else place - away))
    return case(f"{zeta:.0e} {'from' if closes else 'beyond'} the {end} limit", (a, b, g, h), float(theta))


def limits(full: bool) -> list[Case]:
    powers = range(1, 13) if full else (1, 6, 12)
    sizes = [10.0**-power for power in powers]
    return [
        beside_limit(size, end, closes)
        for size in sizes
        for end in ("inner", "outer")
        for closes in (True, False)
    ]


def rapidities(full: bool) -> list[Case]:
    sizes = (0.0, 5e-324, 1e-300, 1e-160, 1e-8, 30.0, 350.0, 700.0, 720.0, 1e4)
    return [
        case(f"theta = {theta:.0e}, design {i}", lengths, theta)
        for i, lengths in enumerate(DESIGNS if full else DESIGNS[:1])
        for size in sizes
        for theta in ((size, -size) if size else (size,))
    ]


def escapes(full: bool) -> list[Case]:
    """A and C lightlike separated: one root escapes to infinity."""
    away = (0.0, 1e-15, -1e-15, 1e-12, 1e-8, -1e-4) if full else (0.0, 1e-15, -1e-8)
    found = [
        case(
            f"ln(g/a) times 1 + {part:.0e}, design {i}, {side:+d}",
            lengths,
            side * math.log(lengths[2]) * (1.0 + part),
        )
        for i, lengths in enumerate(DESIGNS)
        for part in away
        for side in ((1, -1) if full else (1,))
    ]
    same = [
        case(f"g = a at {theta:.0e}", (1.5, 2.0, 1.5, 0.875), theta) for theta in (0.0, 1e-300, 1e-160, 1e-8)
    ]
    return found + same


def null_arms(full: bool) -> list[Case]:
    """AB or CB nearly lightlike: far longer in the frame than in hyperbolic length."""
    found = []
    for size in (1e-8, 1e-12, 1e-20) if full else (1e-8, 1e-20):
        a, b, g, h = DESIGNS[0]
        found += [
            case(f"AB nearly lightlike, h = {size:.0e}", (a, b, g, size)),
            case(f"CB nearly lightlike, b = {size:.0e}", (a, size, g, h)),
        ]
    return found


#: Lengths for which one of the sums is zero: of T1, T2, T8 and of those that tell of one link as long as the others.
ZERO = {
    "T1": (1.25, 0.875, 1.5, 1.125),
    "T2": (1.25, 0.875, 1.5, 0.625),
    "T3": (0.75, 0.5, 2.125, 0.875),
    "T4": (2.125, 0.75, 0.5, 0.875),
    "T5": (0.75, 0.5, 0.875, 2.125),
    "T6": (0.75, 2.125, 0.5, 0.875),
    "T8": (1.25, 1.0, 0.5, 0.75),
}


def sums(full: bool) -> list[Case]:
    """Each sum T_i zero, and some last bits from zero: near the folded position, and far from it."""
    found = []
    for name, (a, b, g, h) in ZERO.items():
        for ulps in (0, 1, -1, 2, -3, 1000) if full else (0, 1, -1):
            lengths = (a, b, g + ulps * ULP, h)
            found += [
                case(f"{name} = {ulps} units in the last place at {theta:.0e}", lengths, theta)
                for theta in ((0.0, 1e-8, 0.5) if full else (0.0, 1e-8))
            ]
    equal = {"all equal": (1.0, 1.0, 1.0, 1.0), "pins may coincide": (1.0, 2.0, 1.0, 2.0)}
    equal |= {"g = b, h = a": (1.0, 2.0, 2.0, 1.0), "a = b, g = h": (1.0, 1.0, 2.0, 2.0)}
    return found + [
        case(f"{name} at {t:.0e}", lengths, t) for name, lengths in equal.items() for t in (0.0, 1e-8, 1.0)
    ]


def scales(full: bool) -> list[Case]:
    found = []
    for power in (20, 8, -8, -20) if full else (20, -20):
        by = 10.0**power
        scaled = tuple(length * by for length in DESIGNS[0])
        found.append(case(f"all lengths times 1e{power}", scaled, x=0.3 * by, y=-0.7 * by))
    for i, name in enumerate(LENGTHS):
        for by in (1e-8, 1e8):
            one = tuple(length * by if i == k else length for k, length in enumerate(DESIGNS[1]))
            found.append(case(f"{name} times {by:.0e}", one))
    return found


MINKOWSKI_4R = Mechanism(
    catalogue("minkowski_4r"),
    {
        "limits": limits,
        "rapidities": rapidities,
        "escapes": escapes,
        "null arms": null_arms,
        "sums": sums,
        "scales": scales,
    },
    loop="half_root",
    lengths=tuple(LENGTHS),
    free=("A_x", "A_y", "coefficient_A", "coefficient_B", "coefficient_C", "delta"),
    held={
        **dict.fromkeys(("inner_limit", "outer_limit"), alone),
        "alpha_r": lambda values: values["s_a"] * values["p_r"],
        "beta": lambda values: values["s_a"] * values["per_p"],
        "inside": lambda values: values["S_r"] * values["product_two"],
        "outside": lambda values: values["S_r"] * values["product_two"],
    },
)
