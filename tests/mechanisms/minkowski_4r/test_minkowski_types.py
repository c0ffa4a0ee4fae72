"""Limits and types of the Minkowskian 4R: the paper's examples, tables and theorems, and a scan of the loop."""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.minkowski_designs import (
    LENGTHS,
    MANY,
    THEOREMS,
    facts,
    one_long,
    random_lengths,
    reducible,
)
from tests.support.minkowski_scan import (
    STEP,
    closes,
    closes_ahead,
    quadratic_of_input,
    quadratic_of_output,
    ranges,
    rounding,
    scan,
)

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING

#: How many designs have limits that the scan tells apart.
MOST = 0.85
#: Table 3: the type of normal linkages that are not rigid, by the signs of T1 and T2.
TABLE_3 = {
    (1, 1): "irreducible_crank_crank",
    (1, -1): "irreducible_rocker_crank",
    (-1, 1): "irreducible_rocker_rocker",
    (-1, -1): "irreducible_crank_rocker",
}


@pytest.fixture(scope="module", params=THEOREMS)
def theorem(request):
    """A theorem's name, at least 10^5 designs that meet its condition, and their facts."""
    make, _ = THEOREMS[request.param]
    lengths = make(np.random.default_rng(int(request.param[2:])), MANY)
    assert lengths.shape == (4, MANY)
    return request.param, lengths, facts(lengths)


# -- what the paper prints ------------------------------------------------------------------------------------

#: Section 3.7: lengths, the hyperbolic cosines of the limits, T1 to T5, the type.
EXAMPLES = {
    1: ((1, 1, 4, 1), (1.625, 2.125, -2.125, -1.625), (3, -3, 1, 5, 5), "strange_superrocker_crank"),
    2: ((1.2, 0.4, 0.4, 0.4), (1, 1.6666, 1, 7), (-0.8, 0.8, -1.6, 0, 1.6), "rigid_rocker_rocker"),
    3: ((0.5, 1, 2, 2.5), (-4, 1, -0.25, 1), (0, -3, -2, 5, 1), "reducible_crank_crank"),
    4: (
        (0.6, 1, 0.7, 0.5),
        (-1.6666, 0.71428, -1.05714, -0.2),
        (0.6, 0.4, -1.4, 1.6, 1.8),
        "irreducible_crank_crank",
    ),
}
#: The hyperbolic cosine at the branching points; none in example 2 (g = b, h other than a).
BRANCHING = {1: 1.5, 2: np.nan, 3: -5, 4: -0.5555}
KINDS = {1: "isolated_one_root_at_infinity", 2: "none", 3: "none", 4: "none"}


@pytest.mark.parametrize("number", EXAMPLES)
def test_the_examples_of_section_3_7(number):
    lengths, cosines, sums, kind = EXAMPLES[number]
    # In binary 1.2 is not three times 0.4: that example needs a tolerance to be rigid.
    got = facts(lengths, tolerance=1e-15)
    names = ["cosh_theta_min", "cosh_theta_max", "cosh_psi_min", "cosh_psi_max"]
    # Printed to five digits, cut off.
    np.testing.assert_allclose([got[name] for name in names], cosines, rtol=0, atol=1e-4)
    np.testing.assert_allclose([got[f"T{i}"] for i in range(1, 6)], sums, rtol=0, atol=1e-15)
    assert got["linkage_type"] == kind
    np.testing.assert_allclose(got["cosh_theta_branching"], BRANCHING[number], rtol=0, atol=1e-4)
    assert got["branching_kind"] == KINDS[number]


def test_the_second_example_is_not_rigid_in_binary():
    got = facts(EXAMPLES[2][0])
    assert got["T4"] == UNIT_ROUNDING
    assert got["linkage_type"] == "irreducible_rocker_rocker"


@pytest.mark.sample(3)
def test_theorems_3_12_to_3_20_and_tables_1_and_2(theorem):
    name, _, got = theorem
    expected = THEOREMS[name][1]
    if expected is not None:
        same = got["linkage_type"] == expected
        assert np.all(same), got["linkage_type"][~same]


def test_theorem_3_21_a_crank_whatever_the_output():
    lengths = reducible(-1)(np.random.default_rng(21), MANY)
    got = facts(lengths)
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
        assert np.sum(chosen) > 1000
        assert np.all(got["linkage_type"][chosen] == kind)
        # Grashof's criterion does not tell these types apart.
        assert len(set(got["grashof"][chosen])) == 2


# -- the theorems against a scan ------------------------------------------------------------------------------


def resolved(*limits):
    """Which designs have limits so far from 0 and from each other that the scan sees each."""
    places = np.sort([np.zeros_like(limits[0]), *limits], axis=0)
    return ~np.any(np.diff(places, axis=0) <= STEP, axis=0)


def assert_same_changes(lengths, quadratic, starts, changes, inner, outer, kept):
    """The scan changes at the inner limit, then at the outer one, where there are such."""
    n = np.sum(~np.isnan(changes), axis=1)
    has_inner, has_outer = ~np.isnan(inner), ~np.isnan(outer)
    np.testing.assert_array_equal(n[kept], (has_inner.astype(int) + has_outer)[kept])
    np.testing.assert_array_equal(starts[kept], (has_inner | ~has_outer)[kept])
    for place, limit in ((0, np.where(has_inner, inner, outer)), (1, np.where(has_inner, outer, np.nan))):
        some = kept & ~np.isnan(limit)
        found = changes[some, place]
        error = abs(np.cosh(found) - np.cosh(limit[some]))
        assert np.all(error <= rounding(lengths[:, some], quadratic, found))


@pytest.mark.sample(6)
@pytest.mark.parametrize("crank", ["input", "output"])
def test_limits_and_types_are_those_of_a_scan(theorem, crank):
    """Theorems 3.8 to 3.11, where CB (for the input) or OA (for the output) may point either way."""
    _, lengths, got = theorem
    quadratic, angle = {"input": (quadratic_of_output, "theta"), "output": (quadratic_of_input, "psi")}[crank]
    inner, outer = got[f"{angle}_min"], got[f"{angle}_max"]
    kept = resolved(inner, outer)
    assert np.mean(kept) > MOST
    starts, changes = scan(lengths, quadratic, closes)
    assert_same_changes(lengths, quadratic, starts, changes, inner, outer, kept)
    types = np.array(["crank", "rocker", "superrocker"], dtype=object)
    np.testing.assert_array_equal(got[f"{crank}_type"][kept], types[np.sum(~np.isnan(changes), axis=1)][kept])


@pytest.mark.sample(3)
def test_what_assembles_with_CB_ahead_is_that_of_a_scan(theorem):
    _, lengths, got = theorem
    inner, outer = got["theta_min_future"], got["theta_max_future"]
    kept = resolved(inner, outer)
    assert np.mean(kept) > MOST
    starts, changes = scan(lengths, quadratic_of_output, closes_ahead)
    assert_same_changes(lengths, quadratic_of_output, starts, changes, inner, outer, kept)
    np.testing.assert_array_equal(got["assembly_count_future"][kept], ranges(starts, changes)[kept])


@pytest.mark.sample(3)
def test_what_assembles_with_OA_ahead_is_that_of_a_scan(theorem):
    _, lengths, got = theorem
    inner, outer = got["psi_min_future"], got["psi_max"]
    kept = resolved(inner, outer)
    assert np.mean(kept) > MOST
    starts, changes = scan(lengths, quadratic_of_input, closes_ahead)
    assert_same_changes(lengths, quadratic_of_input, starts, changes, inner, outer, kept)


# -- where the words of the theorems need CB of either orientation --------------------------------------------


def test_how_many_ranges_have_CB_ahead(theorem):
    """The table of docs/minkowski_theorems.md."""
    name, (a, b, g, h), got = theorem
    if name == "3.22":
        positive = got["T1"] > 0.0
        crank = positive == (got["T2"] > 0.0)
        through = crank & np.where(positive, a > g, g > a)
    else:
        # A crank goes through theta = 0 only if the right one of a and g is the longer.
        through = {"3.14": g > a, "3.18": g > a, "3.15": a > g, "3.19": a > g, "3.21": g == a}.get(
            name, np.full(MANY, name == "3.20")
        )
    inner = (got["T4"] < 0.0) if name == "3.22" else np.full(MANY, name == "3.13")
    np.testing.assert_array_equal(got["assembly_count_future"], np.where(through, 1, 2 + inner))
    np.testing.assert_array_equal(np.isnan(got["theta_min_future"]), ~inner)
    np.testing.assert_array_equal(np.isnan(got["psi_min_future"]), ~inner)
    # An outer range starts at the paper's limit, or where CB comes back from infinity.
    ahead = (g > a) == (h > b)
    expected = np.where(ahead & (g != a) & (h != b), got["theta_max"], got["theta_escape"])
    np.testing.assert_array_equal(got["theta_max_future"], np.where(through, np.nan, expected))


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
    x, y, z = quadratic_of_output(lengths, 0.0)
    roots = np.roots([x, y, z])
    # Both roots are real and negative at theta = 0: CB points to the past.
    assert np.all((roots.imag == 0.0) & (roots.real < 0.0))


def test_the_output_of_theorem_3_14_is_a_rocker_with_OA_ahead():
    lengths = one_long("h", 1)(np.random.default_rng(314), MANY)
    got = facts(lengths)
    assert np.all(got["psi_min"] > 0.0)
    # Over all of |psi| <= psi_min both roots p are negative, at psi = 0 in particular.
    x, y, z = quadratic_of_input(lengths, 0.0)
    assert np.all((y * y - 4.0 * x * z > 0.0) & (x * z > 0.0) & (x * y > 0.0))
    assert np.all(np.isnan(got["psi_min_future"]))


def test_the_orientations_of_the_engine_agree():
    """CB_orientation is +1 in some branch exactly where the facts `..._future` say so."""
    lengths = random_lengths(np.random.default_rng(24), 500)
    lengths[0, ::5] += lengths[1:, ::5].sum(axis=0)
    got = facts(lengths)
    theta = np.linspace(-5.0, 5.0, 101)[None, :] + 0.01
    given = dict(zip(LENGTHS, lengths[:, :, None], strict=True))
    ahead = [
        fl.evaluate("minkowski_4r", ["CB_orientation"], **given, theta=theta, branch=branch)["CB_orientation"]
        > 0
        for branch in (1, 2)
    ]
    inner = abs(theta) <= np.nan_to_num(got["theta_min_future"], nan=-1.0)[:, None]
    outer = abs(theta) >= np.nan_to_num(got["theta_max_future"], nan=0.0)[:, None]
    np.testing.assert_array_equal(ahead[0] | ahead[1], inner | outer)
    assert {1.0, 2.0, 3.0} == set(got["assembly_count_future"])
