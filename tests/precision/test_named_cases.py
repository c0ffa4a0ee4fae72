"""Configurations where a computation may go wrong, against the loops: toggles, change points, limits, scales, angles.

No value is beyond its bound, none is a number where there is none, and the status is that of rational arithmetic. Those
of the focal mechanism, of Hart's linkage and of the slider-crank are families of the registry.
"""

import math
from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
from tests.support.against_loops import Tally, compare
from tests.support.configurations import LENGTHS
from tests.support.minkowski_designs import LENGTHS as MINKOWSKI_LENGTHS

import fastlink as fl
from fastlink.mechanisms import catalogue

#: Mass centres and coupler point off all lines, so that nothing vanishes by symmetry.
OTHERS = {"omega1": 25.0, "P_u": 0.7, "P_v": -0.4, "M_x": 0.3, "M_y": -0.6}
OTHERS |= {"G1_u": 0.21, "G1_v": 0.07, "G2_u": 0.4, "G2_v": -0.13, "G3_u": 0.35, "G3_v": 0.09}
MASSES = {"m1": 1.5, "m2": 0.8, "m3": 2.1, "I1": 0.05, "I2": 0.11, "I3": 0.3}
CRANK_ROCKER = (0.375, 1.1, 0.8, 0.9)
ULP = 2.0**-52
SMALL = (5e-324, 1e-300, 1e-160, 1e-16, -1e-8)


def resized(lengths, by):
    """Yield the lengths with one of them times each factor, and with its neighbour nearly as long."""
    for i in range(4):
        for factor in by:
            changed = [length * factor if k == i else length for k, length in enumerate(lengths)]
            yield tuple(changed)
            if factor > 1.0:
                changed[(i + 1) % 4] = changed[i] + 0.25
                yield tuple(changed)


# -- planar 4R: lengths, theta1, what else is not as above ---------------------------------------------------------


def planar_status(lengths):
    """Return the status of a design by rational arithmetic and the rule of docs/numerics.md."""
    a, b, c, d = map(Fraction, lengths)
    total, inner, outer = a + b + c + d, (a - b + c - d, a + b - c - d), a - b - c + d
    if 2 * max(a, b, c, d) > total:
        return "never_assembles"
    if any(abs(gap) <= total / 2**53 for gap in (*inner, outer)):
        return "change_point"
    return "rotates_fully" if inner[0] * inner[1] > 0 > outer else "assembles_over_part_of_the_turn"


def beside_toggle(mu, end, side):
    """A crank whose transmission angle is mu from 0 or pi, or would be beyond it.

    The nearer, the smaller the angle of the toggle itself: there a double is fine enough to be so near.
    """
    toggle, a, d = min(1.0, 3e6 * mu), 1.25, 1.0
    with mp.workdps(50):
        closest = (mp.mpf(a) - d) ** 2
        distance = float(mp.sqrt(closest + 4 * a * d * mp.sin(mp.mpf(toggle) / 2) ** 2))
        b, c = (0.8125 + distance, 0.8125) if end == 0 else (0.375 * distance, 0.625 * distance)
        least, most = (((mp.mpf(b) + sign * c) ** 2 - closest) / (4 * a * d) for sign in (-1, 1))
        away = side * mp.tan(mp.mpf(mu) / 2) ** 2 * (most - least)
        theta = 2 * mp.asin(mp.sqrt(least + away if end == 0 else most - away))
    return (a, b, c, d), float(theta), {}


#: a1 + a3 = a2 + a4 and so on in few bits, so that a gap added to a1 is exact; and the folded position.
FOLDED = (
    ((1.25, 1.0, 0.875, 1.125), 0.0),
    ((1.375, 1.25, 1.5, 1.125), 0.0),
    ((1.25, 1.0, 1.125, 0.875), math.pi),
)
#: A parallelogram, two kites, a rhombus, and what is equal in decimals alone.
EQUAL = ((1.0, 1.75, 1.0, 1.75), (1.0, 1.0, 1.75, 1.75), (1.0, 1.75, 1.75, 1.0), (1.0, 1.0, 1.0, 1.0),
         (0.1, 0.3, 0.1, 0.3), (0.1, 0.6, 0.3, 0.4))  # fmt: skip


def planar_4r():
    for k in range(1, 13):
        yield from (beside_toggle(10.0**-k, end, side) for end in (0, 1) for side in (1, -1))
    gaps = (*(10.0**-k for k in (1, 2, 4, 6, 8, 10, 12, 14)), 8 * ULP, 4 * ULP, 2 * ULP, ULP)
    for (a, b, c, d), fold in FOLDED:
        for gap in (0.0, *gaps, *(-gap for gap in gaps)):
            for away in (0.0, 1e-12, -1e-8, 1.0):
                yield (a + gap, b, c, d), fold + away, {}
    for lengths in EQUAL:
        yield from ((lengths, theta, {}) for theta in (0.0, 1e-8, 1.0, math.pi / 2, math.pi))
    for by in (1e20, 1e8, 1e-8, 1e-20):
        others = {name: value * by for name, value in OTHERS.items() if name != "omega1"}
        yield tuple(length * by for length in CRANK_ROCKER), 0.7, others
    yield from ((lengths, 0.7, {}) for lengths in resized(CRANK_ROCKER, (1e-8, 1e8)))
    yield from ((CRANK_ROCKER, 0.7, {"omega1": speed}) for speed in (1e20, -1e10, 1e-8, -1e-20, 0.0))
    changed = (dict.fromkeys(MASSES, 0.0), {"m1": 0.0, "I1": 0.0}, {"m2": 0.0, "I2": 0.0})
    for masses in (*changed, {"m2": 0.8e12, "I2": 0.11e12}, {"m3": 2.1e-12, "I3": 0.3e-12}):
        yield CRANK_ROCKER, 0.7, masses
    for theta in (*(k * (math.pi / 2) for k in range(-4, 5)), *SMALL, 2e6 * math.pi, 1e22, 1.7e308):
        yield CRANK_ROCKER, theta, {}
    yield from ((EQUAL[0], theta, {}) for theta in SMALL)


# -- Minkowskian 4R: lengths, theta, what else ---------------------------------------------------------------------

#: One design of each way to close: at every theta, outside of a limit, inside and outside of limits.
WAYS = ((1.0, 2.0, 3.5, 2.25), (1.0, 2.0, 1.25, 1.5), (1.0, 0.75, 3.5, 1.0))
#: Lengths for which one of T1 to T6 and T8 is zero.
ZERO = ((1.25, 0.875, 1.5, 1.125), (1.25, 0.875, 1.5, 0.625), (0.75, 0.5, 2.125, 0.875), (2.125, 0.75, 0.5, 0.875),
        (0.75, 0.5, 0.875, 2.125), (0.75, 2.125, 0.5, 0.875), (1.25, 1.0, 0.5, 0.75))  # fmt: skip
ALIKE = ((1.0, 1.0, 1.0, 1.0), (1.0, 2.0, 1.0, 2.0), (1.0, 2.0, 2.0, 1.0), (1.0, 1.0, 2.0, 2.0))


def minkowski_status(lengths):
    """Return the status of a design by the signs of T1 and T2."""
    a, b, g, h = map(Fraction, lengths)
    if g == a and b == h:
        return "undetermined_at_theta_0"
    product = (g - a + b - h) * (a - g + b - h)
    if product == 0:
        return "branches_meet_at_theta_0"
    return "assembles_over_part_of_theta" if product < 0 else "assembles_at_every_theta"


def beside_limit(zeta, end, side):
    """A rapidity beside a limit of the input, where sinh^2 of half the transmission angle is that of zeta."""
    limit, a, g = min(0.5, 3e6 * zeta), 2.0, 1.0
    with mp.workdps(50):
        diagonal = float(mp.sqrt((mp.mpf(a) - g) ** 2 - 4 * a * g * mp.sinh(mp.mpf(limit) / 2) ** 2))
        b, h = (0.8125 + diagonal, 0.8125) if end else (0.375 * diagonal, 0.625 * diagonal)
        reach = mp.mpf(b) - h if end else mp.mpf(b) + h
        place = ((mp.mpf(a) - g) ** 2 - reach**2) / (4 * a * g)
        away = side * mp.mpf(b) * h / (a * g) * mp.sinh(mp.mpf(zeta) / 2) ** 2
        theta = 2 * mp.asinh(mp.sqrt(place + away if end else place - away))
    return (a, b, g, h), float(theta), {}


def minkowski_4r():
    for k in range(1, 13):
        yield from (beside_limit(10.0**-k, end, side) for end in (0, 1) for side in (1, -1))
    for lengths in WAYS:
        sizes = (0.0, 5e-324, 1e-300, 1e-160, 1e-8, 30.0, 350.0, 700.0)
        yield from ((lengths, sign * size, {}) for size in sizes for sign in (1, -1))
        # A and C lightlike separated: one root escapes to infinity
        escape = math.log(lengths[2])
        for away in (0.0, 1e-15, -1e-15, 1e-12, 1e-8, -1e-4):
            yield from ((lengths, side * escape * (1.0 + away), {}) for side in (1, -1))
    yield from (((1.5, 2.0, 1.5, 0.875), theta, {}) for theta in (0.0, 1e-300, 1e-160, 1e-8))
    a, b, g, h = WAYS[0]
    for size in (1e-8, 1e-12, 1e-20):  # AB or CB nearly lightlike
        yield from (((a, b, g, size), 0.625, {}), ((a, size, g, h), 0.625, {}))
    for a, b, g, h in ZERO:
        for ulps in (0, 1, -1, 2, -3, 1000):
            yield from (((a, b, g + ulps * 2 * ULP, h), theta, {}) for theta in (0.0, 1e-8, 0.5))
    yield from ((lengths, theta, {}) for lengths in ALIKE for theta in (0.0, 1e-8, 1.0))
    for by in (1e20, 1e8, 1e-8, 1e-20):
        yield tuple(length * by for length in WAYS[0]), 0.625, {"x": 0.3 * by, "y": -0.7 * by}
    yield from ((lengths, 0.625, {}) for lengths in resized(WAYS[1], (1e-8, 1e8)))


CASES = {
    "planar_4r": (planar_4r, LENGTHS, OTHERS | MASSES, planar_status),
    "minkowski_4r": (minkowski_4r, MINKOWSKI_LENGTHS, {"x": 0.3, "y": -0.7}, minkowski_status),
}


@pytest.mark.parametrize("every", [6, pytest.param(1, marks=pytest.mark.stress)])
@pytest.mark.parametrize("mechanism", CASES)
def test_what_comes_out_of_named_cases(mechanism, every):
    make, names, others, status_of = CASES[mechanism]
    known = catalogue(mechanism)
    flags = {meaning: code for code, meaning in known.facts["status"].flags.items()}
    cases = list(make())[::every]
    rows = [
        {
            **others,
            **changed,
            **dict(zip(names, lengths, strict=True)),
            known.position.name: theta,
            "branch": branch,
        }
        for lengths, theta, changed in cases
        for branch in (1.0, 2.0)
    ]
    design = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    tally = Tally(mechanism, known.position.name)
    compare(tally, design)
    assert tally.failures == {}, tally.report()
    assert tally.counts["values"] > 20 * len(rows)
    expected = [flags[status_of(lengths)] for lengths, _, _ in cases for _ in (1, 2)]
    np.testing.assert_array_equal(fl.evaluate(mechanism, ["status"], **design)["status"], expected)
