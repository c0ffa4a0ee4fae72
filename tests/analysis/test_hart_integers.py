"""Hart's linkages of whole sizes, against brute force over all sizes and against the sweep."""

from fractions import Fraction
from itertools import product
from math import gcd

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.refusals import refused
from tests.support.sweeps import sweep_both

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING

SIZES = ("m", "n", "d", "p", "q", "a", "b", "c")


def by_force(greatest, movable):
    """Return the sizes of every linkage: all m, n, d and p = kappa n are tried, in fractions."""
    found = set()
    for m, n, d, p in product(*[range(1, greatest + 1)] * 4):
        if m > n or p * m % n:  # n <= m mirrored, or q no whole number
            continue
        kappa = Fraction(p, n)
        factor = 1 - kappa * kappa
        sizes = (m, n, d, p, -kappa * m, factor * m, factor * n, kappa * d)
        if factor == 0 or any(size.denominator > 1 or abs(size) > greatest for size in sizes):
            continue
        # MABN assembles if no bar is longer than the others together, and moves unless one is as long
        *others, longest = sorted(map(abs, (factor * m, factor * n, kappa * d, d)))
        if longest > sum(others) - movable or gcd(*(int(size) for size in sizes)) > 1:
            continue
        found.add(tuple(int(size) for size in sizes))
    return found


def rows(designs):
    return list(zip(*(designs[name].values.tolist() for name in SIZES), strict=True))


@pytest.mark.parametrize("movable", [False, True])
@pytest.mark.parametrize("greatest", [1, 3, 4, 20])
def test_the_list_is_that_of_brute_force(greatest, movable):
    listed = rows(fl.hart.integer_designs(greatest, movable=movable))
    assert len(set(listed)) == len(listed)
    assert set(listed) == by_force(greatest, movable)


def test_small_linkages_come_first_and_larger_limits_add_at_the_end():
    few, more = (rows(fl.hart.integer_designs(greatest)) for greatest in (20, 40))
    assert more[: len(few)] == few
    largest = [max(map(abs, row)) for row in more]
    assert largest == sorted(largest)
    for given in (0, 501, "8"):
        with refused("max_size", "write a whole number from 1 to 500"):
            fl.hart.integer_designs(given)
    with refused("movable", "write True or False"):
        fl.hart.integer_designs(8, movable="no")


def test_every_linkage_is_one_of_eqs_7_2_to_7_4_and_is_listed_once_by_scale():
    designs = fl.hart.integer_designs(150)
    m, n, d, p, q, a, b, c = (designs[name].values for name in SIZES)
    i, j = designs.kappa_numerator.values, designs.kappa_denominator.values
    assert (np.gcd(i, j) == 1).all()
    for whole in ((j * p - i * n), (j * q + i * m), (j * j * a - (j * j - i * i) * m), (j * c - i * d)):
        assert not whole.any()
    assert (j * j * b == (j * j - i * i) * n).all()
    assert (np.gcd.reduce([m, n, d, p, q, a, b, c]) == 1).all()
    assert ((m <= n) & (i > 0)).all()
    assert np.max(np.abs([m, n, d, p, q, a, b, c])) == 150
    assert_array_equal(designs.kappa, i / j)


def test_a_table_of_them_is_swept():
    designs = fl.hart.integer_designs(12)
    maps = sweep_both("hart", fl.table(designs), ["status", *"pqabc"], threads=1)
    for name in "pqabc":
        # kappa = i/j is rounded, its square too: 4 roundings
        assert_allclose(maps[name], designs[name].values, rtol=8 * UNIT_ROUNDING)
    codes = dict(zip(maps.status.flag_values, maps.status.flag_meanings.split(), strict=True))
    statuses = {codes[code] for code in np.unique(maps.status)}
    assert statuses == {"one_segment", "two_segments", "change_point", "rigid"}
    moving = fl.hart.integer_designs(12, movable=True)
    assert int((maps.status != 3).sum()) == moving.sizes["design"]
