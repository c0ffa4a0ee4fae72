"""Class, ranges, swing, transmission angle and time ratio of a design, against scans and 50 digits."""

from __future__ import annotations

import math
from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
from tests.support.configurations import DIGITS, LENGTHS, PLANAR, condition_sums, designs, reference

import fastlink as fl
from fastlink.mechanisms.planar_4r.classes import CLASS_FLAGS
from fastlink.numerics.compensated import UNIT_ROUNDING

CODES = {meaning: code for code, meaning in CLASS_FLAGS.items()}
FACTS = [
    "grashof_class",
    "grashof_excess",
    "theta1_low",
    "theta1_high",
    "theta4_low",
    "theta4_high",
    "swing",
    "transmission_angle_least",
    "transmission_angle_greatest",
    "time_ratio",
]
TABLE_1 = (0.4, 1.2, 0.8, 1.0)
NAMES_OF_LINKS = ("crank", "coupler", "output_link", "ground")


def facts(lengths):
    """Return the facts of designs (4, n), compiled, by name."""
    columns = dict(
        zip(LENGTHS, np.atleast_2d(np.asarray(lengths, dtype=float).T).T.reshape(4, -1), strict=True)
    )
    space = fl.table(columns, allow_invalid=True)
    found = fl.sweep("planar_4r", space, FACTS, theta1=[0.0], allow_invalid=True)
    return {name: found[name].values for name in FACTS}


def drawn(kind, n, seed=41):
    return designs(kind, np.random.default_rng(seed), n)


def closes(lengths, t):
    """Whether the loop closes: the triangle inequality of A, B, D."""
    a, b, c, d = lengths
    distance = np.hypot(a * np.cos(t) - d, a * np.sin(t))
    return (distance >= abs(b - c)) & (distance <= b + c)


def classical(lengths):
    """Type by Grashof's inequality and the place of the shortest or longest link, in rational numbers."""
    exact = [Fraction(float(value)) for value in lengths]
    order = sorted(exact)
    excess = order[3] + order[0] - order[1] - order[2]
    if order[3] > sum(order[:3]):
        return "never_assembles", excess
    if excess < 0:
        shortest = exact.index(order[0])
        return ("crank_rocker", "double_rocker", "rocker_crank", "double_crank")[shortest], excess
    return f"triple_rocker_longest_{NAMES_OF_LINKS[exact.index(order[3])]}", excess


@pytest.mark.parametrize("kind", ["random", "wide", "gap"])
def test_class_and_excess_are_the_classical_ones_in_rational_numbers(kind):
    lengths = drawn(kind, 2000)
    got = facts(lengths)
    seen = set()
    for i, one in enumerate(lengths.T):
        expected, excess = classical(one)
        rounding = UNIT_ROUNDING * one.sum()
        if abs(excess) <= 2 * rounding:
            continue
        assert CLASS_FLAGS[int(got["grashof_class"][i])] == expected, one
        seen.add(expected)
        # Summed without loss, rounded once.
        assert abs(Fraction(float(got["grashof_excess"][i])) - excess) <= 2 * UNIT_ROUNDING * abs(excess)
    assert len(seen) >= 8


def test_never_assembles_and_invalid():
    got = facts(
        [
            [1.0, 1.0, -1.0, 1.0, np.nan],
            [1.0, 5.0, 2.0, 1.0, 1.0],
            [1.0, 1.0, 2.0, 0.0, 1.0],
            [4.0, 2.0, 2, 1, 1],
        ]
    )
    assert [CLASS_FLAGS[int(code)] for code in got["grashof_class"]] == [
        "never_assembles",
        "never_assembles",
        *["invalid_input"] * 3,
    ]
    for name in FACTS[2:]:
        assert np.all(np.isnan(got[name])), name
    # Longest and shortest against the other two means something without an assembly too.
    np.testing.assert_array_equal(got["grashof_excess"], [3.0, 3.0, np.nan, np.nan, np.nan])


@pytest.mark.parametrize(
    ("lengths", "expected"),
    [
        ((1.0, 3.0, 1.0, 3.0), "change_point_parallelogram"),
        ((1.0, 3.0, 3.0, 1.0), "change_point_kite_a1_a4"),
        ((1.0, 1.0, 3.0, 3.0), "change_point_kite_a1_a2"),
        ((2.0, 2.0, 2.0, 2.0), "change_point_rhombus"),
        ((1.0, 4.0, 2.0, 5.0), "change_point"),
        # Equal though not in binary.
        ((0.1, 0.4, 0.3, 0.6), "change_point"),
        ((0.1, 0.3, 0.1, 0.1 + 0.2), "change_point_parallelogram"),
    ],
)
def test_change_points(lengths, expected):
    got = facts(lengths)
    assert CLASS_FLAGS[int(got["grashof_class"][0])] == expected
    assert got["grashof_excess"][0] == 0.0
    assert np.isnan(got["time_ratio"][0])


def test_the_class_agrees_with_status():
    lengths = drawn("gap", 500)
    space = fl.table(dict(zip(LENGTHS, lengths, strict=True)))
    found = fl.sweep("planar_4r", space, ["status", "grashof_class"], theta1=[0.0])
    turning = {CODES["crank_rocker"], CODES["double_crank"]}
    for status, code in zip(found.status.values, found.grashof_class.values, strict=True):
        if code in turning:
            assert status == 0
        elif code < CODES["change_point"]:
            assert status == 1
        elif code < CODES["never_assembles"]:
            assert status == 3
        else:
            assert status == 2


@pytest.mark.parametrize("kind", ["random", "wide"])
def test_ranges_are_those_of_a_scan(kind):
    """Input range by asking at 4001 angles; output range by driving the linkage from the other side."""
    lengths = drawn(kind, 400 if kind == "random" else 2000)
    got = facts(lengths)
    t = np.linspace(0.0, np.pi, 4001)
    step = t[1]
    tested = 0
    for i, (a, b, c, d) in enumerate(lengths.T):
        for joint, mirrored, seen in (("theta1", (a, b, c, d), t), ("theta4", (c, b, a, d), np.pi - t)):
            low, high = got[f"{joint}_low"][i], got[f"{joint}_high"][i]
            there = seen[closes(mirrored, t)]
            if there.size == 0:
                # Never, or a range narrower than two samples.
                assert np.isnan(low) or high - low <= 2 * step
                continue
            # A sample lies within one step of either end, and none beyond (but for roundings).
            assert low - 1e-9 <= there.min() <= low + step + 1e-9
            assert high + 1e-9 >= there.max() >= high - step - 1e-9
            tested += 1
    assert tested > 400


def follow(lengths, n=4000):
    """Every configuration of a fine scan of the input, both branches: theta1, theta4, transmission angle."""
    a, b, c, d = lengths
    # Clustered at the ends: where the input has toggles the output moves as a square root.
    t = np.pi * np.cos(np.linspace(0.0, np.pi, n))
    distance2 = (a * np.cos(t) - d) ** 2 + (a * np.sin(t)) ** 2
    with np.errstate(invalid="ignore"):
        mu = np.arccos((b * b + c * c - distance2) / (2 * b * c))
        at_d = np.arccos((c * c + distance2 - b * b) / (2 * c * np.sqrt(distance2)))
    to_a = np.arctan2(a * np.sin(t), a * np.cos(t) - d)
    return t, to_a, at_d, mu


def test_swing_and_transmission_angle_are_those_of_a_scan():
    """The swing is the travel of the output along one circuit, followed configuration by configuration."""
    lengths = drawn("random", 300)
    got = facts(lengths)
    seen = set()
    for i, one in enumerate(lengths.T):
        a, b, c, d = one
        code = CLASS_FLAGS[int(got["grashof_class"][i])]
        if code == "never_assembles":
            continue
        # The output's own scan decides what closes; components of the set of output angles within a circuit.
        psi = np.linspace(-np.pi, np.pi, 20001)
        there = closes((c, b, a, d), psi)
        fraction = there.mean() * 2 * np.pi
        circuits = 2 if code in ("crank_rocker", "double_rocker") else 1
        # Two limits: the two circuits have one half of the angles each. Each end is within a step.
        assert abs(got["swing"][i] - fraction / circuits) <= 4 * psi[1] - 4 * psi[0]
        seen.add(code)
        t, _to_a, _at_d, mu = follow(one)
        mu = mu[np.isfinite(mu)]
        if mu.size:
            least, greatest = got["transmission_angle_least"][i], got["transmission_angle_greatest"][i]
            assert least - 1e-7 <= mu.min()
            assert greatest + 1e-7 >= mu.max()
            if code in ("crank_rocker", "double_crank"):
                # theta1 = 0 and pi are near samples: the angle is even about both, with bounded curvature.
                assert mu.max() >= greatest - 1e-2
                assert mu.min() <= least + 1e-2
            elif mu.size > 100:
                # A toggle is one end: the other configuration is near 0 or pi as the root of a step.
                assert min(least, np.pi - greatest) == 0.0
        assert t.size == 4000
    assert len(seen) == 8


def test_time_ratio_is_that_of_a_scan():
    """Turn of the crank between the two extremes of the output, found by sampling and a parabola."""
    lengths = drawn("random", 1500)
    got = facts(lengths)
    cranks = np.flatnonzero((got["grashof_class"] == CODES["crank_rocker"]) & (got["grashof_excess"] < -0.05))
    assert cranks.size > 40
    t = np.linspace(-np.pi, np.pi, 20001)[:-1]
    for i in cranks:
        a, b, c, d = lengths[:, i]
        x, y = a * np.cos(t) - d, a * np.sin(t)
        distance2 = x * x + y * y
        at_d = np.arccos((c * c + distance2 - b * b) / (2 * c * np.sqrt(distance2)))
        theta4 = np.unwrap(np.arctan2(y, x) - at_d)
        places = []
        for k in (int(np.argmax(theta4)), int(np.argmin(theta4))):
            before, at, after = theta4[k - 1], theta4[k], theta4[(k + 1) % t.size]
            places.append(t[k] + 0.5 * (before - after) / (before - 2 * at + after) * (t[1] - t[0]))
        turn = abs(places[0] - places[1])
        turn = max(turn, 2 * np.pi - turn)
        # The parabola is right to the square of the step times f'''/f'', here some 1e3 at most.
        assert got["time_ratio"][i] == pytest.approx(turn / (2 * np.pi - turn), rel=1e3 * (t[1] - t[0]) ** 2)
    others = got["grashof_class"] != CODES["crank_rocker"]
    assert np.all(np.isnan(got["time_ratio"][others]))


def by_cosines(a, b, c, d):
    """Limits by the law of cosines, in the working precision of mpmath."""

    def angle(cosine):
        return mp.acos(max(mp.mpf(-1), min(mp.mpf(1), cosine)))

    limits = {
        "theta1_low": angle((a**2 + d**2 - (b - c) ** 2) / (2 * a * d)),
        "theta1_high": angle((a**2 + d**2 - (b + c) ** 2) / (2 * a * d)),
        "theta4_low": mp.pi - angle((c**2 + d**2 - (a + b) ** 2) / (2 * c * d)),
        "theta4_high": mp.pi - angle((c**2 + d**2 - (a - b) ** 2) / (2 * c * d)),
        "transmission_angle_least": angle((b**2 + c**2 - (a - d) ** 2) / (2 * b * c)),
        "transmission_angle_greatest": angle((b**2 + c**2 - (a + d) ** 2) / (2 * b * c)),
    }
    low, high = limits["theta4_low"], limits["theta4_high"]
    limits["swing"] = high - low if low > 0 and high < mp.pi else 2 * (high - low)
    if a == min(a, b, c, d) and a + max(b, c, d) < (a + b + c + d) / 2:
        stretched = angle(((a + b) ** 2 + d**2 - c**2) / (2 * (a + b) * d))
        folded = angle(((b - a) ** 2 + d**2 - c**2) / (2 * (b - a) * d))
        x = abs(folded - stretched)
        limits["time_ratio"] = (mp.pi + x) / (mp.pi - x)
    return limits


@pytest.mark.parametrize("kind", ["random", "wide", "gap"])
def test_limits_are_a_few_roundings_off(kind):
    """Against the law of cosines in 50 digits: error below 4 roundings of the value and of each input."""
    lengths = drawn(kind, 60 if kind != "wide" else 250, seed=43)
    got = facts(lengths)
    names = FACTS[1:]
    tested = 0
    for i, one in enumerate(lengths.T):
        given = dict(zip(LENGTHS, one, strict=True))
        if int(got["grashof_class"][i]) >= CODES["change_point"]:
            continue
        sums = condition_sums(names, given)
        own = reference(names, given)
        with mp.workdps(2 * DIGITS):
            expected = by_cosines(*(mp.mpf(float(value)) for value in one))
            for name, value in expected.items():
                assert abs(own[name] - value) <= mp.mpf(10) ** -35, (name, i)
                error = abs(mp.mpf(float(got[name][i])) - value)
                assert error <= 4 * UNIT_ROUNDING * (sums[name] + abs(value)), (name, i)
                tested += 1
            if "time_ratio" not in expected:
                assert np.isnan(got["time_ratio"][i])
    assert tested > 200


def test_table_1():
    got = facts(TABLE_1)
    assert CLASS_FLAGS[int(got["grashof_class"][0])] == "crank_rocker"
    # The excess of the lengths as the doubles they are: each is off by half a unit at most.
    assert got["grashof_excess"][0] == pytest.approx(-0.2, abs=2 * UNIT_ROUNDING * sum(TABLE_1))
    assert (got["theta1_low"][0], got["theta1_high"][0]) == (0.0, np.pi)
    # |AD| = 0.6 and 1.4 with sides 1.2 and 0.8; |OB| = 0.8 and 1.6 with sides 0.8 and 1.0. A few roundings.
    for name, cosine in (
        ("transmission_angle_least", (2.08 - 0.36) / 1.92),
        ("transmission_angle_greatest", (2.08 - 1.96) / 1.92),
        ("theta4_low", -(1.64 - 2.56) / 1.6),
        ("theta4_high", -(1.64 - 0.64) / 1.6),
    ):
        assert got[name][0] == pytest.approx(math.acos(cosine), rel=1e-14), name
    assert got["swing"][0] == pytest.approx(math.acos(-0.625) - math.acos(0.575), rel=1e-14)


def test_textbook_linkages():
    # Centric: a1^2 + a4^2 = a2^2 + a3^2 makes both strokes equal.
    centric = facts((1.0, 5.0, 5.0, 7.0))
    assert CLASS_FLAGS[int(centric["grashof_class"][0])] == "crank_rocker"
    assert centric["time_ratio"][0] == pytest.approx(1.0, abs=1e-15)
    # Its swing: 2 arcsin(a1/a3).
    assert centric["swing"][0] == pytest.approx(2 * math.asin(1 / 5), rel=1e-14)
    # Watt's straight-line linkage: equal rockers, double rocker by Grashof's criterion.
    watt = facts((5.0, 2.0, 5.0, 8.0 - 0.5))
    assert CLASS_FLAGS[int(watt["grashof_class"][0])] == "double_rocker"
    # Chebyshev's: 5, 2, 5, 4, coupler shortest; Hoeken's: crank 1, ground 2, coupler and output 2.5.
    assert CLASS_FLAGS[int(facts((5.0, 2.0, 5.0, 4.0))["grashof_class"][0])] == "double_rocker"
    assert CLASS_FLAGS[int(facts((1.0, 2.5, 2.5, 2.0))["grashof_class"][0])] == "crank_rocker"
    # Drag link.
    drag = facts((2.0, 2.0, 2.5, 1.0))
    assert CLASS_FLAGS[int(drag["grashof_class"][0])] == "double_crank"
    assert drag["swing"][0] == 2 * np.pi


def test_scale_and_mirror():
    """A power of two changes no bit; exchanging crank and output link exchanges their ranges."""
    lengths = drawn("wide", 300)
    one, scaled = facts(lengths), facts(lengths * 2.0**300)
    for name in FACTS:
        factor = 2.0**300 if name == "grashof_excess" else 1.0
        np.testing.assert_array_equal(one[name] * factor, scaled[name])
    mirrored = facts(lengths[[2, 1, 0, 3]])
    for name, other in (("theta1_low", "theta4_high"), ("theta1_high", "theta4_low")):
        # Both are within a few roundings of pi of the exact value.
        np.testing.assert_allclose(
            one[name], np.pi - mirrored[other], rtol=0, atol=16 * UNIT_ROUNDING * np.pi
        )


def test_facts_of_the_design_have_no_angle():
    assert not any(PLANAR.varies(name) for name in FACTS)


def test_compiled_and_plain_facts_have_the_same_bits():
    lengths = drawn("gap", 300)
    compiled = facts(lengths)
    given = dict(zip(LENGTHS, lengths, strict=True))
    plain = fl.evaluate("planar_4r", FACTS, theta1=0.0, **given)
    for name in FACTS:
        np.testing.assert_array_equal(compiled[name], plain[name], err_msg=name)


def test_the_output_range_is_that_of_theta4_itself():
    """Angles theta4 at which an assembly exists, asked of the linkage itself: no role exchanged."""
    lengths = drawn("random", 40, seed=44)
    got = facts(lengths)
    t = np.linspace(-np.pi, np.pi, 20001)
    for i, one in enumerate(lengths.T):
        given = dict(zip(LENGTHS, one, strict=True))
        theta4 = np.abs(
            [fl.evaluate("planar_4r", ["theta4"], theta1=t, branch=k, **given)["theta4"] for k in (1, 2)]
        )
        if not np.isfinite(theta4).any():
            continue
        # Sampled at 20001 angles of theta1, theta4 moves as the square root of a step at a toggle of the input.
        assert got["theta4_low"][i] - 1e-9 <= np.nanmin(theta4) <= got["theta4_low"][i] + 0.1
        assert got["theta4_high"][i] + 1e-9 >= np.nanmax(theta4) >= got["theta4_high"][i] - 0.1
