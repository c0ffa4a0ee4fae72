"""Limits, types, branching and status of the Minkowskian 4R: the paper's examples, tables and theorems, exactly."""

from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.configurations import DIGITS
from tests.support.sweeps import sweep_both

import fastlink as fl
from fastlink.errors import InputError
from fastlink.facts.evaluate import read_facts
from fastlink.mechanisms.minkowski_4r import minkowski_4r
from fastlink.numerics.compensated import UNIT_ROUNDING

# == Designs of the Minkowskian 4R by the conditions of the paper's theorems, and their facts ================

MANY = 10_000
LENGTHS = "abgh"
#: What the sums T_i add up: signs of a, b, g, h.
SUMS = {
    "T1": (-1, 1, 1, -1),
    "T2": (1, 1, -1, -1),
    "T3": (-1, -1, 1, -1),
    "T4": (-1, 1, 1, 1),
    "T5": (1, 1, 1, -1),
    "T6": (1, -1, 1, 1),
    "T7": (1, 1, 1, 1),
    "T8": (-1, 1, -1, 1),
}
FACTS = [
    name
    for name, fact in minkowski_4r.facts.items()
    if name in SUMS or (not fact.internal and fact.formula.place.startswith("design_facts.facts"))
]


def facts(lengths, names=FACTS, **given):
    """Return facts of designs (4, n) by name; codes as their meanings."""
    values = dict(zip(LENGTHS, np.asarray(lengths, dtype=float), strict=True)) | given
    with np.errstate(all="ignore"):
        found = read_facts(minkowski_4r, names, values, minkowski_4r.variants_selected_by(given))
    return {name: decoded(name, found[name]) for name in names}


def decoded(name, values):
    flags = minkowski_4r.facts[name].flags
    if not flags:
        return values
    meanings = np.full(max(flags) + 1, "", dtype=object)
    meanings[list(flags)] = list(flags.values())
    return meanings[np.asarray(values).astype(int)]


def random_lengths(rng, n):
    return np.exp(rng.uniform(-0.9, 0.9, (4, n)))


def whole(rng, n):
    """Three whole numbers of 1024ths, whose sums are exact."""
    return rng.integers(512, 2048, (3, n)) / 1024.0


def one_long(link, excess):
    """Make lengths of which one is the sum of the others, and more by an excess of 1 or nothing."""

    def make(rng, n):
        others = whole(rng, n)
        total = np.sum(others, axis=0)
        return np.insert(
            others, LENGTHS.index(link), total + excess * rng.integers(1, 1024, n) / 1024.0, axis=0
        )

    return make


def reducible(sign):
    """Make lengths with T1 = 0 (sign 1: h = g + b - a) or T2 = 0 (sign -1: h = a + b - g)."""

    def make(rng, n):
        a, b, g = whole(rng, 2 * n)
        h = b + sign * (g - a)
        return np.array([a, b, g, h])[:, h > 0.2][:, :n]

    return make


#: Theorem: designs that meet its condition, and the type it gives them.
THEOREMS = {
    "3.12": (one_long("g", 1), "strange_superrocker_crank"),
    "3.13": (one_long("a", 1), "strange_superrocker_superrocker"),
    "3.14": (one_long("h", 1), "strange_crank_superrocker"),
    "3.15": (one_long("b", 1), "strange_crank_crank"),
    "3.16": (one_long("g", 0), "rigid_rocker_crank"),
    "3.17": (one_long("a", 0), "rigid_rocker_rocker"),
    "3.18": (one_long("h", 0), "rigid_crank_rocker"),
    "3.19": (one_long("b", 0), "rigid_crank_crank"),
    "3.20": (reducible(1), "reducible_crank_crank"),
}


def all_kinds(rng, n):
    """Whole lengths of every kind: with g = b, h = a, g = a and b = h now and then."""
    a, b, g, h = rng.integers(1, 64, (4, n)).astype(float)
    g = np.where(rng.random(n) < 0.2, b, g)
    h = np.where(rng.random(n) < 0.2, a, h)
    g = np.where(rng.random(n) < 0.1, a, g)
    return np.array([a, b, g, np.where(rng.random(n) < 0.2, b, h)])


def near_zero(rng, n):
    """Lengths with some T_i that is 0 but for the last bits, of exponents that differ."""
    bits = np.where(rng.random(n) < 0.5, 20, 52)
    mantissas = np.ldexp(np.rint(np.ldexp(rng.uniform(1.0, 2.0, (4, n)), bits)), -bits)
    lengths = np.ldexp(mantissas, rng.integers(-bits - 8, 3, (4, n)))
    signs = np.array(list(SUMS.values()))[rng.choice([0, 1, 2, 3, 4, 5, 7], n)].T
    # the longest link is what makes the sum vanish, as rounding allows, or a little more
    rest = np.where(np.arange(4)[:, None] == 2, 0.0, signs * lengths)
    last = abs(np.sum(rest, axis=0)) + rng.integers(-2, 3, n) * np.spacing(lengths[2])
    lengths[2] = np.where(last > 0.0, last, lengths[2])
    return lengths


def across(rng, n):
    """Lengths of 1e-20 to 1e20 in one design."""
    return 10.0 ** rng.uniform(-20, 20, (4, n))


#: Where signs and digits may get lost.
FAMILIES = {
    "random": lambda rng, n: np.exp(rng.uniform(-0.9, 0.9, (4, n))),
    "near 0": near_zero,
    "across": across,
    "small": lambda rng, n: 1e-20 * rng.uniform(0.5, 2.0, (4, n)),
    "large": lambda rng, n: 1e20 * rng.uniform(0.5, 2.0, (4, n)),
}


# == Limits, types, branching and status of the Minkowskian 4R: the paper's examples, tables and theorems, exactly

#: Table 3: the type of normal linkages that are not rigid, by the signs of T1 and T2.
TABLE_3 = {
    (1, 1): "irreducible_crank_crank",
    (1, -1): "irreducible_rocker_crank",
    (-1, 1): "irreducible_rocker_rocker",
    (-1, -1): "irreducible_crank_rocker",
}
ANGLES = ["theta_min", "theta_max", "psi_min", "psi_max", "theta_branching"]


def at_theta_0(lengths):
    """Return the coefficients of q^2, q, 1 for the output crank at theta = 0: |AC + CB|^2 = h^2."""
    a, b, g, h = lengths
    return b * (g - a), (g - a) ** 2 + b * b - h * h, b * (g - a)


#: Section 3.7: lengths, the hyperbolic cosines of the limits, T1 to T5, at the branching points, the type.
EXAMPLES = {
    1: ((1, 1, 4, 1), (1.625, 2.125, -2.125, -1.625), (3, -3, 1, 5, 5), 1.5, "strange_superrocker_crank"),
    2: ((1.2, 0.4, 0.4, 0.4), (1, 1.6666, 1, 7), (-0.8, 0.8, -1.6, 0, 1.6), np.nan, "rigid_rocker_rocker"),
    3: ((0.5, 1, 2, 2.5), (-4, 1, -0.25, 1), (0, -3, -2, 5, 1), -5, "reducible_crank_crank"),
    4: (
        *((0.6, 1, 0.7, 0.5), (-1.6666, 0.71428, -1.05714, -0.2), (0.6, 0.4, -1.4, 1.6, 1.8)),
        *(-0.5555, "irreducible_crank_crank"),
    ),
}


@pytest.mark.parametrize("number", EXAMPLES)
def test_the_examples_of_section_3_7(number):
    lengths, cosines, sums, branching, kind = EXAMPLES[number]
    # In binary 1.2 is not three times 0.4: that example needs a tolerance to be rigid.
    got = facts(lengths, tolerance=1e-15)
    names = ["cosh_theta_min", "cosh_theta_max", "cosh_psi_min", "cosh_psi_max"]
    # Printed to five digits, cut off.
    assert_allclose([got[name] for name in names], cosines, rtol=0, atol=1e-4)
    assert_allclose([got[f"T{i}"] for i in range(1, 6)], sums, rtol=0, atol=1e-15)
    assert got["linkage_type"] == kind
    assert_allclose(got["cosh_theta_branching"], branching, rtol=0, atol=1e-4)
    assert got["branching_kind"] == ("isolated_one_root_at_infinity" if number == 1 else "none")
    if number == 2:
        binary = facts(lengths)
        assert (binary["T4"], binary["linkage_type"]) == (UNIT_ROUNDING, "irreducible_rocker_rocker")


@pytest.mark.sample(4)
@pytest.mark.parametrize("theorem", THEOREMS)
def test_theorems_3_12_to_3_20_and_tables_1_and_2(theorem):
    make, expected = THEOREMS[theorem]
    lengths = make(np.random.default_rng(int(theorem[2:])), MANY)
    assert lengths.shape == (4, MANY)
    assert set(facts(lengths)["linkage_type"]) == {expected}


def test_theorem_3_21_a_crank_whatever_the_output():
    got = facts(reducible(-1)(np.random.default_rng(21), MANY))
    assert np.all(got["T2"] == 0.0)
    assert np.all(got["input_type"] == "crank")
    assert set(got["linkage_type"]) == {"reducible_crank_crank", "reducible_crank_rocker"}


def test_theorem_3_22_and_table_3():
    lengths = random_lengths(np.random.default_rng(22), 2 * MANY)
    normal = np.all(2.0 * lengths < np.sum(lengths, axis=0), axis=0)
    assert np.sum(normal) >= MANY
    got = facts(lengths[:, normal])
    assert np.all((got["T3"] < 0.0) & (got["T4"] > 0.0) & (got["T5"] > 0.0))
    for (first, second), kind in TABLE_3.items():
        chosen = (np.sign(got["T1"]) == first) & (np.sign(got["T2"]) == second)
        assert np.sum(chosen) > 100
        assert np.all(got["linkage_type"][chosen] == kind)
        # Grashof's criterion does not tell these types apart.
        assert len(set(got["grashof"][chosen])) == 2


@pytest.mark.parametrize(
    ("lengths", "words", "count"),
    [
        ((1.0, 1.0, 4.0, 1.0), "strange_superrocker_crank", 2),  # 3.12: not in three ranges
        ((2.0, 1.0, 1.0, 6.0), "strange_crank_superrocker", 2),  # 3.14: not through theta = 0
        ((1.0, 6.0, 2.0, 1.0), "strange_crank_crank", 2),  # 3.15: not through theta = 0
        ((2.0, 2.0, 1.0, 3.0), "reducible_crank_rocker", 2),  # 3.21: not through theta = 0
        ((0.5, 1.0, 0.75, 0.5), "irreducible_crank_crank", 2),  # Table 3: not through theta = 0
    ],
)
def test_counter_examples(lengths, words, count):
    got = facts(lengths)
    assert got["linkage_type"] == words
    assert got["assembly_count_future"] == count
    roots = np.roots(at_theta_0(lengths))
    # Both roots are real and negative at theta = 0: CB points to the past.
    assert np.all((roots.imag == 0.0) & (roots.real < 0.0))


def test_limits_and_orientations_are_those_of_the_loop():
    """Where the loop closes, and where with CB ahead, at 601 rapidities of the motion itself."""
    lengths = random_lengths(np.random.default_rng(24), 500)
    for long in range(4):
        lengths[long, long::8] += np.delete(lengths, long, axis=0)[:, long::8].sum(axis=0)
    got = facts(lengths)
    theta = np.linspace(0.0, 6.0, 601)[None, :] + 0.005
    given = dict(zip(LENGTHS, lengths[:, :, None], strict=True))
    names = ["psi", "CB_orientation"]
    found = [fl.evaluate("minkowski_4r", names, **given, theta=theta, branch=branch) for branch in (1, 2)]
    limits = {name: got[name][:, None] for name in got if got[name].dtype == float}
    inner, outer = (
        np.nan_to_num(limits[f"theta_{end}"], nan=x) for end, x in (("min", -1.0), ("max", np.inf))
    )
    closes = np.isfinite(found[0]["psi"])
    # a rocker stays within theta_min, a superrocker has a second range beyond theta_max, a crank has no limit
    cranks = (got["input_type"] == "crank")[:, None]
    assert_array_equal(closes, cranks | (theta <= inner) | (theta >= outer))
    assert set(got["input_type"]) == set(got["output_type"]) == {"crank", "rocker", "superrocker"}
    ahead = [of["CB_orientation"] > 0 for of in found]
    inner, outer = (
        np.nan_to_num(limits[f"theta_{end}_future"], nan=x) for end, x in (("min", -1.0), ("max", 0.0))
    )
    assert_array_equal(ahead[0] | ahead[1], (theta <= inner) | (theta >= outer))
    assert set(got["assembly_count_future"]) == {1.0, 2.0, 3.0}
    # with OA ahead, as it is here, the output is within its limits, and comes near to them
    inner, outer = (np.nan_to_num(limits[name], nan=-1.0) for name in ("psi_min_future", "psi_max"))
    for of, forth in zip(found, ahead, strict=True):
        size = np.where(forth, abs(of["psi"]), 0.0)
        assert ((size <= inner + 1e-9) | (size >= outer - 1e-9) | ~forth).all()


def test_branching_is_where_q_is_minus_1_or_psi_is_undetermined():
    lengths = all_kinds(np.random.default_rng(8), MANY)
    a, b, g, h = lengths
    got = facts(lengths)
    # q = -1 puts B at (g - b, 0): |AB|^2 - h^2 there is linear in ch(theta), and exact in whole numbers.
    at_0, slope = (g - b - a) ** 2 - h * h, -2.0 * a * (g - b)
    everywhere = (at_0 == 0.0) & (slope == 0.0)
    somewhere = ~everywhere & ((at_0 == 0.0) | (at_0 * slope < 0.0))
    # psi is undetermined where all three coefficients of the quadratic vanish.
    undetermined = np.all(np.array(at_theta_0(lengths)) == 0.0, axis=0)
    assert_array_equal(undetermined, (g == a) & (b == h))
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
    assert_array_equal(got["branching_kind"], kinds)
    assert len(set(kinds)) == 5
    assert_array_equal(~np.isnan(got["theta_branching"]), somewhere)
    cosine = np.cosh(got["theta_branching"][somewhere])
    # Zero to the rounding of the cosine (4 units for cosh itself) and of four products.
    left = abs(at_0[somewhere] + slope[somewhere] * (cosine - 1.0))
    assert np.all(left <= 16 * UNIT_ROUNDING * (abs(at_0[somewhere]) + abs(slope[somewhere]) * cosine))
    with np.errstate(divide="ignore", invalid="ignore"):
        printed = (a * a - h * h) / (2.0 * a * (g - b)) + (g - b) / (2.0 * a)  # eq. (8)
    assert_allclose(got["cosh_theta_branching"][g != b], printed[g != b], rtol=1e-11, atol=1e-11)


def test_grashof_and_status_are_those_of_whole_lengths():
    lengths = all_kinds(np.random.default_rng(10), MANY)
    a, b, g, h = lengths
    got = facts(lengths)
    s, p, q, longest = np.sort(lengths, axis=0)
    expected = np.where(longest + s >= p + q, "l_plus_s_at_least_p_plus_q", "l_plus_s_below_p_plus_q")
    assert 0.1 < np.mean(longest + s >= p + q) < 0.9
    assert_array_equal(got["grashof"], expected)
    x, y, z = at_theta_0(lengths)
    double = (y * y == 4.0 * x * z) & (abs(g - a) == abs(b - h))  # exact in whole numbers below 2^53
    expected = np.select(
        [(g == a) & (b == h), double, abs(g - a) > abs(b - h)],
        ["undetermined_at_theta_0", "branches_meet_at_theta_0", "assembles_over_part_of_theta"],
        "assembles_at_every_theta",
    )
    assert len(set(expected)) == 4
    assert_array_equal(got["status"], expected)
    assert_array_equal(expected == "assembles_over_part_of_theta", got["input_type"] != "crank")


def test_equal_lengths_part_the_ranges():
    """With g = a both roots leave at theta = 0, with b = h at theta_max: no q is left in the quadratic there."""
    a, b, _, h = all_kinds(np.random.default_rng(23), 2000)
    h = np.where(b == h, b + 1.0, h)
    got = facts([a, b, a, h])
    assert_array_equal(got["assembly_count_future"], 2.0)
    assert_array_equal(got["theta_max_future"], 0.0)
    got = facts([a, b, a + np.where(a > 1.0, -1.0, 1.0), b])
    # The same angle by two formulas, each right to 12 units of 2^-53.
    assert_allclose(got["theta_max"], got["theta_escape"], rtol=24 * UNIT_ROUNDING)
    assert_array_equal(got["theta_max_future"], got["theta_escape"])


@pytest.mark.sample(2)
@pytest.mark.parametrize("family", FAMILIES)
def test_sums_are_right_to_a_rounding_and_their_signs_exact(family):
    lengths = FAMILIES[family](np.random.default_rng(12), 1000)
    got, zeros = facts(lengths, list(SUMS)), 0
    for i, one in enumerate(lengths.T):
        exact = [Fraction(float(x)) for x in one]
        for name, signs in SUMS.items():
            total = sum(sign * x for sign, x in zip(signs, exact, strict=True))
            found = Fraction(float(got[name][i]))
            # T7 is a sum of positive numbers: two roundings.
            assert abs(found - total) <= 2 * Fraction(UNIT_ROUNDING) * abs(total), (name, one)
            assert (found > 0, found < 0) == (total > 0, total < 0)
            zeros += total == 0
    assert zeros > 20 or family != "near 0"


@pytest.mark.sample(3)
@pytest.mark.parametrize("family", FAMILIES)
def test_angles_and_cosines_keep_every_digit(family):
    """Relative to the lengths as given, however near a limit is to 0; an angle is that of its hyperbolic cosine.

    In units of 2^-53: each T_i 1, each of the two quotients 1, halved by the roots, which add 1 each, and their product
    1: 5. The area function has 3 units in the last place, 6, and a condition number below 1.
    """
    lengths = FAMILIES[family](np.random.default_rng(13), 150)
    names = [*ANGLES, *(f"cosh_{name}" for name in ANGLES), "theta_escape"]
    got, seen = facts(lengths, names), 0
    with mp.workdps(DIGITS):
        for i, one in enumerate(lengths.T):
            exact = read_facts(
                minkowski_4r, names, dict(zip(LENGTHS, map(mp.mpf, map(float, one)), strict=True))
            )
            for name in names:
                found, expected = float(got[name][i]), exact[name]
                assert np.isnan(found) == bool(mp.isnan(expected)), name
                if np.isfinite(found):
                    size = 7 * abs(expected - 1) + abs(expected) if "cosh" in name else 12 * expected
                    assert abs(found - expected) <= UNIT_ROUNDING * size, name
                    seen += 1
            for name in ANGLES:
                cosine = exact[f"cosh_{name}"]
                assert mp.isnan(exact[name]) or abs(exact[name] - mp.acosh(cosine)) <= 1e-20 * (1 + cosine)
            escape = abs(mp.log(mp.mpf(float(one[2])) / mp.mpf(float(one[0]))))
            assert abs(exact["theta_escape"] - escape) <= mp.mpf(10) ** -40 * (1 + escape)
    assert seen > 200


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
    for tolerance in ({}, {"tolerance": 0.0}, {"tolerance": 0.0009 / total}):
        assert facts(lengths, **tolerance)[fact] == plain
    assert facts(lengths, tolerance=0.0011 / total)[fact] == wide
    assert facts(lengths, tolerance=0.0011 / total)["T1"] == facts(lengths)["T1"]
    with pytest.raises(InputError, match="tolerance"):
        sweep_both("minkowski_4r", fl.grid(a=1.0, b=1.0, g=1.0, h=1.0, tolerance=-1e-9), [fact])


def test_impossible_lengths_are_flagged():
    bad = [0.0, -1.0, np.nan, np.inf]
    lengths = np.array([[x if i == j else 1.0 for j in range(4)] for x in bad for i in range(4)]).T
    got = facts(lengths)
    for name in FACTS:
        if minkowski_4r.facts[name].flags:
            assert set(got[name]) == {"invalid_input"}, name
        else:
            assert np.all(np.isnan(got[name])), name
