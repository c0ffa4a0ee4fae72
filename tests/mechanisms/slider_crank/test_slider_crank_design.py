"""Status, class, ranges, dead centres and time ratio of slider-cranks, by exact arithmetic and by moving them."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import mpmath as mp
import numpy as np
import pytest
from tests.support.slider_crank_configurations import PUMP, SLIDER_CRANK, lengths
from tests.support.slider_crank_oracle import Mechanism

import fastlink as fl
from fastlink.mechanisms.slider_crank.strokes import CLASS_FLAGS
from fastlink.numerics.compensated import UNIT_ROUNDING

STATUS_FLAGS = SLIDER_CRANK.facts["status"].flags
SIDES = ("stroke", "outer_dead_centre", "inner_dead_centre", "theta_low", "theta_high", "time_ratio")


def at(names, **given):
    with np.errstate(all="ignore"):
        return fl.evaluate("slider_crank", names, theta=1.0, allow_invalid=True, **given)


def exact_class(r, l, e):
    e = abs(e)
    if e > r + l:
        return "never_assembles"
    if e == abs(l - r):
        return "change_point_isosceles" if e == 0 else "change_point"
    if e > abs(l - r):
        return "neither_turns_fully"
    return "crank_turns_fully" if l > r else "rod_turns_fully"


def test_classes_are_those_of_exact_arithmetic():
    seen = set()
    # Tenths are not doubles: a gap that is zero for the lengths meant is zero here.
    for r, l, e in product(range(1, 8), range(1, 8), range(-15, 16)):
        if abs(e) == r + l:  # assembles at one angle, or at none for the next doubles
            continue
        found = at(
            ["grashof_class", "grashof_excess", "status"],
            **{name: n / 10 for name, n in zip("rle", (r, l, e), strict=True)},
        )
        expected = exact_class(r, l, e)
        seen.add(expected)
        assert CLASS_FLAGS[int(found["grashof_class"])] == expected, (r, l, e)
        status = STATUS_FLAGS[int(found["status"])]
        assert status == {
            "crank_turns_fully": "rotates_fully",
            "change_point": "change_point",
            "change_point_isosceles": "change_point",
            "never_assembles": "never_assembles",
        }.get(expected, "assembles_over_part_of_the_turn")
        excess = Fraction(abs(e) - abs(l - r), 10)
        assert (
            abs(Fraction(float(found["grashof_excess"])) - excess)
            <= 4 * UNIT_ROUNDING * (r + l + abs(e)) / 10
        )
        assert (found["grashof_excess"] == 0) == (excess == 0)
    assert seen == set(CLASS_FLAGS.values()) - {"invalid_input"}


@pytest.mark.parametrize(
    "wrong", [{"r": 0.0}, {"l": -1.0}, {"r": np.inf}, {"l": np.nan}, {"e": np.inf}, {"e": np.nan}]
)
def test_what_is_no_length_is_invalid(wrong):
    given = {"r": 1.0, "l": 2.0, "e": 0.5} | wrong
    found = at(["status", "grashof_class", "stroke", "slider_position"], **given, branch=1)
    assert STATUS_FLAGS[int(found["status"])] == "invalid_input"
    assert CLASS_FLAGS[int(found["grashof_class"])] == "invalid_input"
    assert np.isnan(found["stroke"])
    assert np.isnan(found["slider_position"])


def reached(r, l, e, branch):
    """Move through a turn: the crank angles and the positions where it assembles."""
    theta = np.linspace(-np.pi, np.pi, 72001)
    with np.errstate(all="ignore"):
        x = fl.evaluate("slider_crank", ["slider_position"], r=r, l=l, e=e, theta=theta, branch=branch)
    there = np.isfinite(x["slider_position"])
    return theta[there], x["slider_position"][there]


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    ("r", "l", "e"),
    [(1, 3, 0.5), (1, 3, -1.5), (1, 3, 0), (3, 1, 0.5), (3, 1, -1), (2, 2.5, 1), (2, 1.5, -1), (1, 1, 1.5)],
)
def test_ranges_and_strokes_are_those_of_a_turn(r, l, e):
    found = at(list(SIDES), r=float(r), l=float(l), e=float(e))
    step = 2 * np.pi / 72000
    theta, x = reached(r, l, e, 1)
    other_x = reached(r, l, e, 2)[1]
    sines = np.sin(theta)
    assert abs(np.arcsin(sines.min()) - found["theta_low"]) <= 2 * np.sqrt(step)
    assert abs(np.arcsin(sines.max()) - found["theta_high"]) <= 2 * np.sqrt(step)
    # Both branches are one circuit where the crank does not turn; where the rod does, it has a twin at the other side.
    circuit = (
        x if found["theta_high"] == np.pi / 2 and found["theta_low"] == -np.pi / 2 else np.append(x, other_x)
    )
    if l < r and abs(e) < r - l:
        circuit = circuit[circuit > 0]
    # At dead centres x is stationary: half its second derivative, below 2 (r + l)^2/w, times step^2.
    near = 40 * (r + l) * step**2
    if abs(e) > abs(l - r):
        near = 40 * (r + l) * step**2
        assert np.isnan(found["inner_dead_centre"])
        assert abs(circuit.min() + found["outer_dead_centre"]) < near
    else:
        assert abs(circuit.min() - found["inner_dead_centre"]) < near
    assert abs(circuit.max() - found["outer_dead_centre"]) < near
    assert abs(np.ptp(circuit) - found["stroke"]) < 2 * near
    assert np.isnan(found["time_ratio"]) == (not l > r + abs(e))


@pytest.mark.parametrize("e", [0.02, -0.02, 0.0, 0.1199])
def test_dead_centres_and_quick_return_of_a_pump(e):
    r, l = PUMP["r"], PUMP["l"]
    names = ["theta_outer", "theta_inner", "time_ratio", "stroke", "outer_dead_centre", "inner_dead_centre"]
    found = at(names, r=r, l=l, e=e)
    outer, inner = (mp.mpf(float(found[f"theta_{end}"])) for end in ("outer", "inner"))
    other = Mechanism({"r": r, "l": l, "e": e}, 1)
    # asin e/(l + r) and pi + asin e/(l - r), see docs/slider_crank.md
    assert abs(outer - mp.asin(mp.mpf(e) / (mp.mpf(l) + r))) < 1e-15
    assert abs(mp.sin(inner) + mp.mpf(e) / (mp.mpf(l) - r)) < 1e-15
    assert mp.cos(inner) < 0
    for theta, end in ((outer, "outer"), (inner, "inner")):
        # stationary: what the last bit of theta does is of second order
        assert abs(other.slider(theta) - mp.mpf(float(found[f"{end}_dead_centre"]))) < 4 * UNIT_ROUNDING * (
            l + r
        )
    forward = (inner - outer) % (2 * mp.pi)
    slow = max(forward, 2 * mp.pi - forward)
    # two angles of a few roundings of pi each
    assert (
        abs(found["time_ratio"] - slow / (2 * mp.pi - slow)) < 16 * UNIT_ROUNDING * found["time_ratio"] ** 2
    )
    assert (found["time_ratio"] == 1.0) == (e == 0.0)


def test_least_and_greatest_transmission_angle_are_those_of_the_turn():
    rng = np.random.default_rng(5)
    designs = dict(zip("rle", lengths("random", rng, 200), strict=True))
    names = ["transmission_angle_least", "transmission_angle_greatest"]
    refined = ["transmission_angle_min", "transmission_angle_max"]
    found = fl.sweep("slider_crank", fl.table(designs), [*names, *refined], branch=1, threads=1)
    for of_design, of_turn in zip(names, refined, strict=True):
        one, other = found[of_design].values, found[of_turn].values
        np.testing.assert_array_equal(np.isnan(one), np.isnan(other))
        there = np.isfinite(one)
        assert np.count_nonzero(there) > 100
        # Near 0 and pi as the root of a gap that is right to a few roundings.
        np.testing.assert_allclose(one[there], other[there], rtol=16 * UNIT_ROUNDING, atol=0)


def test_near_a_change_point_the_stroke_keeps_its_digits():
    """l = r + |e| + gap: x_i^2 = (l - r - e)(l - r + e) is near 0, and the stroke near 2 sqrt(l r)."""
    for gap in (1e-3, 1e-9, 2.0**-50):
        r, e = 0.5, 0.25
        l = r + e + gap
        found = at(["stroke", "inner_dead_centre", "time_ratio"], r=r, l=l, e=e)
        with mp.workdps(40):
            far, near = mp.mpf(l) + r, mp.mpf(l) - r
            x_o, x_i = mp.sqrt(far**2 - mp.mpf(e) ** 2), mp.sqrt(near**2 - mp.mpf(e) ** 2)
            assert abs(found["stroke"] - (x_o - x_i)) <= 6 * UNIT_ROUNDING * (x_o - x_i)
            assert abs(found["inner_dead_centre"] - x_i) <= 6 * UNIT_ROUNDING * x_i
            beta = mp.asin(e / near) - mp.asin(e / far)
            ratio = (mp.pi + beta) / (mp.pi - beta)
            assert abs(found["time_ratio"] - ratio) <= 12 * UNIT_ROUNDING * ratio
