"""Branching, escape, criteria and status of the Minkowskian 4R in exact arithmetic; signs, digits, tolerance."""

from __future__ import annotations

from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
from tests.support.configurations import DIGITS
from tests.support.minkowski_designs import FACTS, FAMILIES, LENGTHS, MANY, SUMS, all_kinds, decoded, facts
from tests.support.minkowski_scan import quadratic_of_output

import fastlink as fl
from fastlink.errors import InputError
from fastlink.facts.evaluate import read_facts
from fastlink.mechanisms.minkowski_4r import minkowski_4r
from fastlink.numerics.compensated import UNIT_ROUNDING

# -- branching, escape, Grashof, status -----------------------------------------------------------------------


def test_branching_is_where_q_is_minus_1_or_psi_is_undetermined():
    lengths = all_kinds(np.random.default_rng(8), MANY)
    a, b, g, h = lengths
    got = facts(lengths)
    # q = -1 puts B at (g - b, 0): |AB|^2 - h^2 there is linear in ch(theta), and exact in whole numbers.
    at_0 = (g - b - a) ** 2 - h * h
    slope = -2.0 * a * (g - b)
    everywhere = (at_0 == 0.0) & (slope == 0.0)
    somewhere = ~everywhere & ((at_0 == 0.0) | (at_0 * slope < 0.0))
    undetermined = (g == a) & (b == h)
    kinds = np.select(
        [undetermined & everywhere, undetermined, everywhere, somewhere],
        [
            "all_and_undetermined_at_theta_0",
            "isolated_undetermined_at_theta_0",
            "all_one_root_at_infinity",
            "isolated_one_root_at_infinity",
        ],
        "none",
    )
    np.testing.assert_array_equal(got["branching_kind"], kinds)
    assert len(set(kinds)) == 5
    np.testing.assert_array_equal(~np.isnan(got["theta_branching"]), somewhere)
    cosine = np.cosh(got["theta_branching"][somewhere])
    # Zero to the rounding of the cosine (4 units for cosh itself) and of four products.
    left = abs(at_0[somewhere] + slope[somewhere] * (cosine - 1.0))
    assert np.all(left <= 16 * UNIT_ROUNDING * (abs(at_0[somewhere]) + abs(slope[somewhere]) * cosine))
    # psi is undetermined where all three coefficients of the quadratic vanish.
    coefficients = np.array([abs(x) for x in quadratic_of_output(lengths, 0.0)])
    np.testing.assert_array_equal(np.all(coefficients == 0.0, axis=0), undetermined)


def test_eq_8_as_printed():
    lengths = np.random.default_rng(9).uniform(0.5, 2.0, (4, 1000))
    a, b, g, h = lengths
    printed = (a * a - h * h) / (2.0 * a * (g - b)) + (g - b) / (2.0 * a)
    # A quotient of differences of numbers below 4: 4 roundings of 8 each, over the divisor.
    np.testing.assert_array_less(
        abs(facts(lengths)["cosh_theta_branching"] - printed),
        32 * UNIT_ROUNDING * (1.0 + 4.0 / abs(a * (g - b))),
    )


def test_grashof_is_the_longest_and_the_shortest_against_the_others():
    lengths = all_kinds(np.random.default_rng(10), MANY)
    s, p, q, longest = np.sort(lengths, axis=0)
    expected = np.where(longest + s >= p + q, "l_plus_s_at_least_p_plus_q", "l_plus_s_below_p_plus_q")
    assert 0.1 < np.mean(longest + s >= p + q) < 0.9
    np.testing.assert_array_equal(facts(lengths)["grashof"], expected)


def test_status_says_where_the_loop_closes():
    lengths = all_kinds(np.random.default_rng(11), MANY)
    a, b, g, h = lengths
    got = facts(lengths)
    x, y, z = quadratic_of_output(lengths, 0.0)
    double = (y * y == 4.0 * x * z) & (abs(g - a) == abs(b - h))  # exact in whole numbers below 2^53
    expected = np.select(
        [(g == a) & (b == h), double, abs(g - a) > abs(b - h)],
        ["undetermined_at_theta_0", "branches_meet_at_theta_0", "assembles_over_part_of_theta"],
        "assembles_at_every_theta",
    )
    assert len(set(expected)) == 4
    np.testing.assert_array_equal(got["status"], expected)
    np.testing.assert_array_equal(expected == "assembles_over_part_of_theta", got["input_type"] != "crank")


def test_equal_lengths_part_the_ranges():
    """With g = a both roots leave at theta = 0, with b = h at theta_max: no q is left in the quadratic there."""
    a, b, _, h = all_kinds(np.random.default_rng(23), 2000)
    h = np.where(b == h, b + 1.0, h)
    got = facts([a, b, a, h])
    x, y, z = quadratic_of_output((a, b, a, h), 0.0)
    assert np.all((x == 0.0) & (y != 0.0) & (z == 0.0))
    np.testing.assert_array_equal(got["assembly_count_future"], 2.0)
    np.testing.assert_array_equal(got["theta_max_future"], 0.0)
    g = a + np.where(a > 1.0, -1.0, 1.0)
    got = facts([a, b, g, b])
    # The same angle by two formulas, each right to 12 units of 2^-53 (see test_angles_keep_every_digit).
    np.testing.assert_allclose(got["theta_max"], got["theta_escape"], rtol=24 * UNIT_ROUNDING)
    np.testing.assert_array_equal(got["theta_max_future"], got["theta_escape"])


# -- signs and digits ------------------------------------------------------------------------------------------

ANGLES = ["theta_min", "theta_max", "psi_min", "psi_max", "theta_escape", "theta_branching"]
COSINES = ["cosh_theta_min", "cosh_theta_max", "cosh_psi_min", "cosh_psi_max", "cosh_theta_branching"]


@pytest.mark.sample(2)
@pytest.mark.parametrize("family", FAMILIES)
def test_sums_are_right_to_a_rounding_and_their_signs_exact(family):
    lengths = FAMILIES[family](np.random.default_rng(12), 4000)
    got = facts(lengths, list(SUMS))
    zeros = 0
    for i, one in enumerate(lengths.T):
        exact = [Fraction(float(x)) for x in one]
        for name, signs in SUMS.items():
            total = sum(sign * x for sign, x in zip(signs, exact, strict=True))
            found = Fraction(float(got[name][i]))
            # T7 is a sum of positive numbers: two roundings.
            assert abs(found - total) <= 2 * Fraction(UNIT_ROUNDING) * abs(total), (name, one)
            assert (found > 0) == (total > 0)
            assert (found < 0) == (total < 0)
            zeros += total == 0
    assert zeros > 100 or family != "near 0"


def with_50_digits(lengths, names):
    with mp.workdps(DIGITS):
        columns = [
            read_facts(minkowski_4r, names, dict(zip(LENGTHS, map(mp.mpf, map(float, one)), strict=True)))
            for one in lengths.T
        ]
        return {name: [column[name] for column in columns] for name in names}


@pytest.mark.sample(2)
@pytest.mark.parametrize("family", FAMILIES)
def test_angles_keep_every_digit(family):
    """Relative to the lengths as given, however near a limit is to 0.

    In units of 2^-53: each T_i 1, each of the two quotients 1, halved by the roots, which add 1 each, and their product
    1: 5. The area function has 3 units in the last place, 6, and a condition number below 1.
    """
    lengths = FAMILIES[family](np.random.default_rng(13), 300)
    got, exact = facts(lengths, ANGLES), with_50_digits(lengths, ANGLES)
    seen = 0
    for name in ANGLES:
        for found, expected in zip(got[name], exact[name], strict=True):
            assert np.isnan(found) == bool(mp.isnan(expected)), name
            if not np.isnan(found):
                assert np.isfinite(found)
                assert abs(mp.mpf(float(found)) - expected) <= 12 * UNIT_ROUNDING * expected, name
                seen += 1
    assert seen > 400


@pytest.mark.parametrize("family", ["random", "near 0", "small", "large"])
def test_cosines_are_right_to_a_few_roundings(family):
    """1 + w, w being right to 6 units of 2^-53: two T_i, two quotients, two products, or g - b."""
    lengths = FAMILIES[family](np.random.default_rng(14), 300)
    got, exact = facts(lengths, COSINES), with_50_digits(lengths, COSINES)
    for name in COSINES:
        for found, expected in zip(got[name], exact[name], strict=True):
            if mp.isnan(expected):
                assert np.isnan(found)
            else:
                bound = UNIT_ROUNDING * (7 * abs(expected - 1) + abs(expected))
                assert abs(mp.mpf(float(found)) - expected) <= bound, name


def test_the_escape_is_the_logarithm():
    lengths = FAMILIES["across"](np.random.default_rng(15), 500)
    expected = [abs(mp.log(mp.mpf(float(g)) / mp.mpf(float(a)))) for a, _, g, _ in lengths.T]
    found = facts(lengths, ["theta_escape"])["theta_escape"]
    # As the angles above; mp.log has 53 bits itself.
    assert all(abs(x - y) <= 16 * UNIT_ROUNDING * y for x, y in zip(found, expected, strict=True))


def test_input_and_output_exchange():
    """Seen from C, with A and B and both cranks exchanged, T1 stays and the limits of psi are those of theta there.

    The vector CO is past-pointing, so that a hyperbolic cosine changes its sign.
    """
    a, b, g, h = np.exp(np.random.default_rng(17).uniform(-0.9, 0.9, (4, 2000)))
    one, other = facts([a, b, g, h]), facts([b, a, g, h])
    # both are 1 + w, with w right to 6 units of 2^-53 each
    for mine, theirs in (("cosh_psi_min", "cosh_theta_max"), ("cosh_psi_max", "cosh_theta_min")):
        bound = 16 * UNIT_ROUNDING * (2.0 + abs(one[mine]))
        assert np.all(abs(one[mine] + other[theirs]) <= bound), mine


# -- tolerance and bad input -----------------------------------------------------------------------------------


def test_a_tolerance_of_0_changes_nothing():
    lengths = all_kinds(np.random.default_rng(18), 2000)
    plain, given = facts(lengths), facts(lengths, tolerance=0.0)
    for name in FACTS:
        np.testing.assert_array_equal(plain[name], given[name], err_msg=name)


@pytest.mark.parametrize(
    ("lengths", "fact", "plain", "wide"),
    [
        ((1.0, 1.0, 3.001, 1.0), "linkage_type", "strange_superrocker_crank", "rigid_rocker_crank"),
        ((1.0, 3.001, 1.0, 1.0), "linkage_type", "strange_crank_crank", "rigid_crank_crank"),
        ((0.5, 1.0, 2.0, 2.501), "linkage_type", "irreducible_crank_rocker", "reducible_crank_crank"),
        ((1.0, 2.0, 1.001, 2.0), "grashof", "l_plus_s_below_p_plus_q", "l_plus_s_at_least_p_plus_q"),
        ((1.0, 2.0, 1.001, 2.0), "status", "assembles_over_part_of_theta", "undetermined_at_theta_0"),
        ((1.0, 2.0, 2.001, 1.0), "branching_kind", "none", "all_one_root_at_infinity"),
        ((2.0, 2.0, 1.0, 2.999), "branching_kind", "none", "isolated_one_root_at_infinity"),
        ((1.0, 2.0, 1.001, 2.0), "assembly_count_future", 2.0, 1.0),
    ],
)
def test_a_tolerance_widens_each_distinction(lengths, fact, plain, wide):
    # What is 0.001 counts as 0 from a tolerance of 0.001 over the sum of the lengths on.
    total = sum(lengths)
    assert facts(lengths)[fact] == plain
    assert facts(lengths, tolerance=0.0009 / total)[fact] == plain
    assert facts(lengths, tolerance=0.0011 / total)[fact] == wide
    assert facts(lengths, tolerance=0.0011 / total)["T1"] == facts(lengths)["T1"]


BAD = [0.0, -1.0, np.nan, np.inf]


def test_impossible_lengths_are_flagged():
    lengths = np.array([[bad if i == j else 1e308 for j in range(4)] for bad in BAD for i in range(4)]).T
    got = facts(lengths)
    for name in FACTS:
        if minkowski_4r.facts[name].flags:
            assert set(got[name]) == {"invalid_input"}, name
        else:
            assert np.all(np.isnan(got[name])), name


def test_a_classification_is_compiled_without_theta_and_has_the_same_bits():
    lengths = np.concatenate(
        [FAMILIES["near 0"](np.random.default_rng(19), 500), [[1.0], [2.0], [-1.0], [1.0]]], 1
    )
    space = fl.table(dict(zip(LENGTHS, lengths, strict=True)), allow_invalid=True)
    names = [name for name in FACTS if name in minkowski_4r.public]
    found = fl.sweep("minkowski_4r", space, names, allow_invalid=True)
    expected = facts(lengths)
    assert "theta" not in found.dims
    for name in names:
        np.testing.assert_array_equal(decoded(name, found[name].values), expected[name], err_msg=name)


def test_a_negative_tolerance_is_refused():
    with pytest.raises(InputError, match="tolerance"):
        fl.sweep("minkowski_4r", fl.grid(a=1.0, b=1.0, g=1.0, h=1.0, tolerance=-1e-9), ["linkage_type"])
