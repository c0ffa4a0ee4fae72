"""Sobol's sequence and Latin hypercubes, design by design: scipy's bits, one design in each slice."""

import itertools
import math
import pickle
import warnings
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal
from scipy.stats import chi2, qmc
from tests.support.four_bar import sweep_4r

import fastlink as fl
from fastlink.engine.resolve import resolve
from fastlink.space import samplers
from fastlink.space.samplers import Slices, sobol_axes

UNIT = (0.0, 1.0)


def scipys(dimensions, seed, bits, count):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a number that is no power of two
        return qmc.Sobol(dimensions, rng=np.random.default_rng(seed), bits=bits).random(count)


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 9), st.integers(0, 2**63 - 1), st.sampled_from([2**30, 2**31]), st.data())
def test_any_block_of_the_sequence_has_scipys_bits(dimensions, seed, n, data):
    axes = sobol_axes(n, seed, [UNIT] * dimensions)
    points = scipys(dimensions, seed, 30 if n == 2**30 else 53, 20_000)
    for _ in range(5):
        start = data.draw(st.integers(0, 20_000))
        stop = data.draw(st.integers(start, 20_000))
        for axis, column in zip(axes, points.T, strict=True):
            assert_array_equal(axis.piece(start, stop), column[start:stop])


def test_the_farthest_points_are_those_of_the_gray_code():
    engine = qmc.Sobol(2, rng=np.random.default_rng(5), bits=53)
    for n in (2**50, 2**40):
        for k, axis in enumerate(sobol_axes(n, 5, [UNIT] * 2)):
            for number in (n - 1, n // 3, 2**30):
                gray, point = number ^ (number >> 1), int(engine._shift[k])
                for bit in range(53):
                    point ^= int(engine._sv[k, bit]) if gray >> bit & 1 else 0
                assert Fraction(axis[number]) == Fraction(point, 2**53)


def test_another_way_of_scipy_is_noticed(monkeypatch):
    class Changed(qmc.Sobol):
        def random(self, n=1, workers=1):
            return 1.0 - super().random(n)

    monkeypatch.setattr(qmc, "Sobol", Changed)
    with pytest.raises(RuntimeError, match="another way"):
        fl.sobol(8, a1=UNIT)


@pytest.mark.parametrize("seed", [0, 1, 2**63 - 1])
def test_each_slice_holds_one_design_whatever_their_number(seed):
    for n in [*range(1, 70), 255, 256, 257, 1023, 1024, 1025, 4095, 4096, 4097, 9973, 65537]:
        numbers = Slices(n, UNIT, seed, 1).permutation(np.arange(n, dtype=np.uint64))
        assert_array_equal(np.sort(numbers), np.arange(n))


@pytest.mark.sample(2)
@pytest.mark.parametrize("n", [3, 1000, 65537, 2**32, 2**32 + 1, 10**10, 2**40 - 1, 2**49 + 1, 2**50])
def test_a_design_lies_in_its_slice(n):
    axis = Slices(n, UNIT, 3, 0)
    numbers = np.unique(np.linspace(0, n - 1, 300).astype(np.uint64))
    for number, k in zip(axis.permutation(numbers).tolist(), numbers.tolist(), strict=True):
        assert number <= Fraction(float(axis[k])) * n < number + 1


@settings(max_examples=40, deadline=None)
@given(st.one_of(st.integers(1, 2**33), st.integers(1, 2**50)), st.integers(0, 2**63 - 1), st.data())
def test_any_block_of_a_hypercube_has_the_same_bits_as_plain_integers_give(n, seed, data):
    axis = Slices(n, UNIT, seed, 2)
    start = data.draw(st.integers(0, n - 1))
    stop = min(n, start + data.draw(st.integers(1, 20)))
    for k in range(start, stop):
        assert axis[k] == axis.piece(start, stop)[k - start]
        assert int(axis.permutation(np.array([k], np.uint64))[0]) == permuted(axis, n, k)


def permuted(axis, n, number):
    """Return the image of a number by the integers of Python."""
    a, bits = math.isqrt(n - 1) + 1, 32 if n <= 2**32 else 64
    first, second, shift = samplers.MULTIPLIERS[bits]
    sizes = (a, -(-n // a))
    while True:
        sides = list(divmod(number, sizes[1]))
        for k, key in enumerate(axis.permutation.keys.tolist()):
            word = ((sides[1 - k % 2] ^ key) * first) % 2**bits
            word = (word ^ word >> shift) * second % 2**bits >> bits // 2
            sides[k % 2] = (sides[k % 2] + (word * sizes[k % 2] >> bits // 2)) % sizes[k % 2]
        number = sides[0] * sizes[1] + sides[1]
        if number < n:
            return number


def is_chance(counts, expected, freedom):
    """Tell whether counts are those of chance: a chi square that is exceeded once in 10^6 cases, at either end."""
    value = float(((counts - expected) ** 2 / expected).sum())
    return chi2.ppf(1e-6, freedom) < value < chi2.ppf(1.0 - 1e-6, freedom)


@pytest.mark.parametrize("n", [100_000, 2**32, 10**10, 2**50])
def test_axes_are_uncorrelated_and_fill_the_squares(n):
    count = 100_000
    start = n // 3 if n > count else 0
    axes = [Slices(n, UNIT, 7, k).piece(start, start + count) for k in range(4)]
    for one, other in itertools.combinations([*axes, np.roll(axes[0], 1), np.roll(axes[0], 317)], 2):
        # of independent pairs the correlation times sqrt(count) is normal: beyond 5 once in 1.7 million cases
        assert abs(np.corrcoef(one, other)[0, 1]) < 5.0 / math.sqrt(count)
        cells = np.histogram2d(one, other, bins=20, range=[UNIT, UNIT])[0]
        assert is_chance(
            cells, count / 400, 361 if n == count else 399
        )  # where all are taken, margins are fixed


def test_places_within_slices_are_uniform_and_independent_of_the_order():
    axis = Slices(100_000, (0.0, 100_000.0), 3, 0)
    values = np.asarray(axis)
    places = values - np.floor(values)
    assert is_chance(np.histogram(places, bins=100, range=UNIT)[0], 1000, 99)
    assert abs(np.corrcoef(places, values)[0, 1]) < 5.0 / math.sqrt(100_000)
    assert abs(np.corrcoef(places[1:], places[:-1])[0, 1]) < 5.0 / math.sqrt(100_000)


SAMPLES = {"sobol": fl.sobol, "latin_hypercube": fl.latin_hypercube}
RANGES = {"a2": (1.0, 1.2), "a3": (0.7, 0.9), "a4": (1.0, 1.2), "a1": 0.4}


@pytest.mark.parametrize("sample", SAMPLES.values(), ids=SAMPLES)
def test_the_fingerprint_is_that_of_the_definition(sample):
    def fingerprint(n=10**10, seed=1, **ranges):
        return resolve(
            "planar_4r", sample(n, RANGES | ranges, seed=seed), ["omega4_max"], angles=5, branch=(1, 2)
        ).fingerprint

    given_once = [
        fingerprint(omega1=2.0),
        fingerprint(seed=2, omega1=2.0),
        fingerprint(n=10**10 + 1, omega1=2.0),
    ]
    assert len({*given_once, fingerprint(omega1=2.0, a2=(1.0, 1.3))}) == 4
    assert fingerprint(omega1=2.0) == given_once[0]


@pytest.mark.parametrize("sample", SAMPLES.values(), ids=SAMPLES)
def test_a_part_of_ten_thousand_million_designs_is_swept(tmp_path, sample):
    part = sample(10**10, RANGES, seed=1).consecutive(5 * 10**9, 5 * 10**9 + 3000)
    names = ["transmission_angle_min"]
    expected = sweep_4r(part, names, threads=1, block=64)
    with sweep_4r(part, names, to=tmp_path / "m.h5", verify=2, threads=2) as maps:
        for name in ("a2", "a3", "a4", "design", *names):
            assert_array_equal(maps[name], expected[name])
    whole = sample(10**10, RANGES, seed=1)
    rows = np.empty((3, 3000))
    whole.fill(["a2", "a3", "a4"], 5 * 10**9, 5 * 10**9 + 3000, rows)
    assert_array_equal(rows, [expected.a2, expected.a3, expected.a4])
    again = pickle.loads(pickle.dumps(whole))
    again.fill(["a2", "a3", "a4"], 5 * 10**9, 5 * 10**9 + 3000, rows)
    assert_array_equal(rows, [expected.a2, expected.a3, expected.a4])


@pytest.mark.parametrize("sample", SAMPLES.values(), ids=SAMPLES)
def test_blocks_that_were_read_last_change_nothing(sample):
    column = sample(1000, a1=UNIT).columns["a1"]
    whole = np.asarray(column)
    for start, stop in [(3, 9), (3, 9), (3, 10), (4, 10), (3, 9), (0, 0), (3, 9)]:
        values = column.piece(start, stop)
        assert_array_equal(values, whole[start:stop])
        values[:] = -1.0  # of the caller
