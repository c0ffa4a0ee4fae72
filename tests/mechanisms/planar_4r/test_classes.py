"""Class, ranges, swing, transmission angle and time ratio of a design: rational numbers, and the law of cosines."""

from collections import Counter
from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.support.configurations import (
    DIGITS,
    LENGTHS,
    apart_from_change_points,
    designs,
    random_lengths,
    reference,
)
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING

CLASS_FLAGS = catalogue("planar_4r").facts["grashof_class"].flags

CODES = {meaning: code for code, meaning in CLASS_FLAGS.items()}
LIMITS = [f"{joint}_{end}" for joint in ("theta1", "theta4") for end in ("low", "high")]
LIMITS += ["swing", "least_transmission_angle", "time_ratio"]
FACTS = ["grashof_class", "grashof_excess", *LIMITS]
NAMES_OF_LINKS = ("crank", "coupler", "output_link", "ground")


def facts(*lengths):
    """Return the facts of designs, compiled, by name; the class by its meaning."""
    columns = dict(zip(LENGTHS, np.array(lengths, dtype=float).T, strict=True))
    names = [*FACTS, "status"]
    space = fl.table(columns, allow_invalid=True)
    found = sweep_4r(space, names, theta1=[0.0], allow_invalid=True)
    classes = np.array([CLASS_FLAGS[int(code)] for code in found["grashof_class"].values])
    return {name: found[name].values for name in names} | {"grashof_class": classes}


def drawn(kind, n):
    return designs(kind, np.random.default_rng(41), n).T


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
def test_class_excess_and_status_are_the_classical_ones_in_rational_numbers(kind):
    lengths = drawn(kind, 2000)
    got = facts(*lengths)
    seen = set()
    for i, one in enumerate(lengths):
        expected, excess = classical(one)
        if abs(excess) <= 2 * UNIT_ROUNDING * one.sum():
            continue
        assert got["grashof_class"][i] == expected, one
        seen.add(expected)
        # Summed without loss, rounded once.
        assert abs(Fraction(float(got["grashof_excess"][i])) - excess) <= 2 * UNIT_ROUNDING * abs(excess)
        turning, other = expected in ("crank_rocker", "double_crank"), expected == "never_assembles"
        assert got["status"][i] == (0 if turning else 2 if other else 1)
    assert len(seen) >= 8


def test_never_assembles_and_invalid():
    impossible = [(1.0, 1.0, 1.0, 4.0), (1.0, 5.0, 1.0, 2.0)]
    invalid = [(-1.0, 2.0, 2.0, 2.0), (1.0, 1.0, 0.0, 1.0), (np.nan, 1.0, 1.0, 1.0)]
    got = facts(*impossible, *invalid)
    assert got["grashof_class"].tolist() == ["never_assembles"] * 2 + ["invalid_input"] * 3
    for name in LIMITS:
        assert np.all(np.isnan(got[name])), name
    # Longest and shortest against the other two means something without an assembly too.
    assert_array_equal(got["grashof_excess"], [3.0, 3.0, np.nan, np.nan, np.nan])


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
    assert got["grashof_class"] == expected
    assert got["status"] == 3
    assert got["grashof_excess"] == 0.0
    assert np.isnan(got["time_ratio"])


def status_of(lengths):
    """Return the status of a design by rational arithmetic and the rule of docs/numerics.md."""
    a, b, c, d = map(Fraction, lengths)
    total, inner, outer = a + b + c + d, (a - b + c - d, a + b - c - d), a - b - c + d
    if 2 * max(a, b, c, d) > total:
        return 2
    if any(abs(gap) <= total / 2**53 for gap in (*inner, outer)):
        return 3
    return 0 if inner[0] * inner[1] > 0 > outer else 1


def test_a_gap_counts_as_zero_where_it_is_within_the_rounding_of_the_lengths():
    """Of a1 in few bits, to which a gap is added exactly; up to all sizes of one length."""
    folded = ((1.25, 1.0, 0.875, 1.125), (1.375, 1.25, 1.5, 1.125), (1.25, 1.0, 1.125, 0.875))
    gaps = [0.0, *(k * 2.0**-52 for k in (1, 2, 4, 8)), *(10.0**-k for k in (1, 2, 4, 6, 8, 10, 12, 14))]
    cases = [(a + sign * gap, b, c, d) for a, b, c, d in folded for gap in gaps for sign in (1, -1)]
    cases += [tuple(x * (by if k == i else 1.0) for k, x in enumerate((0.375, 1.1, 0.8, 0.9)))
              for i in range(4) for by in (1e-20, 1e-8, 1.0, 1e8)]  # fmt: skip
    expected = [status_of(lengths) for lengths in cases]
    assert set(expected) == {0, 1, 2, 3}
    assert_array_equal(facts(*cases)["status"], expected)


def by_cosines(a, b, c, d):
    """Limits by the law of cosines, in the working precision of mpmath."""

    def angle(cosine):
        return mp.acos(max(mp.mpf(-1), min(mp.mpf(1), cosine)))

    limits = {
        "theta1_low": angle((a**2 + d**2 - (b - c) ** 2) / (2 * a * d)),
        "theta1_high": angle((a**2 + d**2 - (b + c) ** 2) / (2 * a * d)),
        "theta4_low": mp.pi - angle((c**2 + d**2 - (a + b) ** 2) / (2 * c * d)),
        "theta4_high": mp.pi - angle((c**2 + d**2 - (a - b) ** 2) / (2 * c * d)),
    }
    least, greatest = (angle((b**2 + c**2 - (a + sign * d) ** 2) / (2 * b * c)) for sign in (-1, 1))
    limits["least_transmission_angle"] = min(least, mp.pi - greatest)
    low, high = limits["theta4_low"], limits["theta4_high"]
    # two circuits have one half of the angles each
    limits["swing"] = high - low if low > 0 and high < mp.pi else 2 * (high - low)
    if a == min(a, b, c, d) and a + max(b, c, d) < (a + b + c + d) / 2:
        stretched = angle(((a + b) ** 2 + d**2 - c**2) / (2 * (a + b) * d))
        folded = angle(((b - a) ** 2 + d**2 - c**2) / (2 * (b - a) * d))
        x = abs(folded - stretched)
        limits["time_ratio"] = (mp.pi + x) / (mp.pi - x)
    return limits


@pytest.mark.parametrize("kind", ["random", "wide", "gap"])
def test_limits_are_those_of_the_law_of_cosines(kind):
    """With 50 digits; how many of them doubles keep is held with those of all other quantities (test_precision.py)."""
    tested = 0
    for one in drawn(kind, 60 if kind != "wide" else 250):
        found = reference([*LIMITS, "grashof_class"], dict(zip(LENGTHS, one, strict=True)))
        if found["grashof_class"] >= CODES["change_point"]:
            continue
        with mp.workdps(2 * DIGITS):
            expected = by_cosines(*(mp.mpf(float(value)) for value in one))
            for name, value in expected.items():
                assert abs(found[name] - value) <= mp.mpf(10) ** -35, (name, one)
                tested += 1
        assert mp.isnan(found["time_ratio"]) == ("time_ratio" not in expected)
    assert tested > 200


# == Circuits: which configurations a linkage of any class moves through without being taken apart ===========


def test_a_circuit_is_a_branch_of_a_full_turn_or_both_over_one_range_of_the_angle():
    """Over a range that ends at toggles the branches meet there; apart from change points nothing else joins them."""
    lengths = random_lengths(np.random.default_rng(51), 400)
    lengths = lengths[:, apart_from_change_points(lengths)]
    space = fl.table(dict(zip(LENGTHS, lengths, strict=True)))
    names = ["grashof_class", "circuit_count", "circuit", "theta2"]
    got = sweep_4r(space, names, theta1=np.linspace(-np.pi, np.pi, 721)[:-1] + 0.003)
    circuit, closes = got.circuit.values, np.isfinite(got.theta2.values)
    assert_array_equal(np.isfinite(circuit), closes)
    turns = closes.all(axis=(1, 2))
    assert (circuit[turns] == circuit[turns, :, :1]).all()
    assert (circuit[turns, 0] != circuit[turns, 1]).all()
    # elsewhere both branches are of one circuit, which changes from one range to the next alone
    rocking, there = circuit[~turns], closes[~turns, 0]
    assert_array_equal(rocking[:, 0], rocking[:, 1])
    following, both = np.roll(rocking[:, 0], 1, axis=-1), there & np.roll(there, 1, axis=-1)
    assert_array_equal(rocking[:, 0][both], following[both])
    ranges = (there & ~np.roll(there, 1, axis=-1)).sum(axis=-1)
    count = got.circuit_count.values
    # a range narrower than the distance of the angles may be missed
    seen = (ranges > 0) | (count[~turns] == 0)
    assert seen.mean() > 0.95
    assert_array_equal(count[~turns][seen], ranges[seen])
    assert (count[turns] == 2).all()
    last = np.nanmax(np.where(there, rocking[:, 0], 0.0), axis=-1)
    assert_array_equal(last[seen], ranges[seen])
    kinds = Counter(CLASS_FLAGS[int(code)] for code in got.grashof_class.values)
    assert len(kinds) == 9
    assert min(kinds.values()) >= 4


@pytest.mark.parametrize(
    ("lengths", "count"),
    [
        ((0.4, 1.2, 0.8, 1.0), 2),  # crank-rocker
        ((1.2, 0.4, 0.8, 1.0), 2),  # its coupler is the shortest
        ((1.0, 1.0, 1.0, 2.5), 1),
        ((1.0, 4.0, 2.0, 5.0), 1),  # a change point
        ((1.0, 3.0, 1.0, 3.0), 1),  # parallelogram
        ((1.0, 1.0, 1.0, 1.0), 1),
        ((1.0, 1.0, 1.0, 3.0), 1),  # stretched: one configuration
        ((1.0, 1.0, 1.0, 3.5), 0),
        ((1.0, -1.0, 1.0, 1.0), np.nan),
    ],
)
def test_counts(lengths, count):
    given = dict(zip(LENGTHS, lengths, strict=True))
    names, modes = ["circuit_count", "circuit"], [[1], [2]]
    got = fl.evaluate(
        "planar_4r",
        names,
        branch=modes,
        theta1=np.linspace(-np.pi, np.pi, 37)[:-1] + 0.03,
        allow_invalid=True,
        **given,
    )
    assert_array_equal(got["circuit_count"], count)
    assert set(got["circuit"][np.isfinite(got["circuit"])]) <= {1.0, 2.0}
    assert np.all((got["circuit"] == 1) | np.isnan(got["circuit"])) or count == 2
