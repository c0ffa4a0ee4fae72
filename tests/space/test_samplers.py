"""Design spaces: numbering, filling, sampling, and what is refused."""

import importlib
import itertools
import math
import pickle
import tracemalloc
import warnings
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal
from scipy.stats import chi2, qmc
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.engine.resolve import resolve
from fastlink.errors import InputWarning
from fastlink.space import samplers
from fastlink.space.samplers import Slices, grid, latin_hypercube, sobol, sobol_axes

table = importlib.import_module("fastlink.space.tables")  # `fastlink.table` is the function


def filled(designs, names, start, stop):
    out = np.full((len(names), stop - start), np.nan)
    designs.fill(names, start, stop, out)
    return out


@settings(max_examples=60, deadline=None)
@given(st.lists(st.integers(1, 7), min_size=0, max_size=4), st.data())
def test_a_grid_fills_any_range_in_c_order(lengths, data):
    axes = {f"a{k}": np.arange(length) + 10.0 * k for k, length in enumerate(lengths)}
    designs = grid(omega1=25.0, **axes)
    assert designs.dims == tuple(axes)
    assert designs.shape == tuple(lengths)
    mesh = dict(zip(axes, np.meshgrid(*axes.values(), indexing="ij"), strict=True)) if axes else {}
    expected = {name: values.ravel() for name, values in mesh.items()}
    expected["omega1"] = np.full(designs.size, 25.0)
    start = data.draw(st.integers(0, designs.size))
    stop = data.draw(st.integers(start, designs.size))
    names = data.draw(st.permutations(sorted(expected)))[: data.draw(st.integers(0, len(expected)))]
    for row, name in zip(filled(designs, names, start, stop), names, strict=True):
        assert_array_equal(row, expected[name][start:stop])


def test_a_grid_of_a_thousand_million_designs_costs_its_axes():
    tracemalloc.start()
    axis = np.linspace(1.0, 2.0, 1000)
    designs = grid(a2=axis, a3=axis, a4=axis)
    out = filled(designs, ["a2", "a3", "a4"], 10**9 - 4096, 10**9)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert designs.size == 10**9
    flat = np.arange(10**9 - 4096, 10**9)
    assert_array_equal(out, axis[np.array(np.unravel_index(flat, designs.shape))])
    assert peak < 2**20


def test_one_design_has_no_dimensions_and_constants_add_only_what_is_missing():
    designs = grid(a1=0.4, a2=np.float64(1.2), a3=np.array(0.8), a4=Fraction(1, 2))
    assert (designs.dims, designs.shape, designs.size) == ((), (), 1)
    assert designs.constants == {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 0.5}
    assert_array_equal(filled(designs, ["a4", "a1"], 0, 1), [[0.5], [0.4]])
    designs = grid(a1=0.4, a2=[1.0, 2.0]).with_constants({"a1": 9.0, "a2": 9.0, "omega1": 1})
    assert designs.constants == {"a1": 0.4, "omega1": 1.0}
    assert_array_equal(designs.axes["a2"], [1.0, 2.0])
    with refused("constants: m1", "a finite number"):
        designs.with_constants({"m1": np.inf})


def test_a_space_keeps_its_values_whatever_the_caller_does():
    axis = np.array([1.0, 2.0])
    designs = grid(a2=axis)
    axis[0] = 9.0
    assert_array_equal(designs.values("a2"), [1.0, 2.0])
    with pytest.raises(ValueError, match="read-only"):
        designs.values("a2")[0] = 9.0


def test_lacking_inputs_and_more_designs_than_can_be_numbered_are_refused():
    with refused("'omega_1'", "did you mean 'omega1'?"):
        grid(omega1=1.0).values("omega_1")
    with refused("'omega_1'", "did you mean 'omega1'?"):
        filled(grid(omega1=1.0), ["omega_1"], 0, 1)
    axis = np.arange(2.0**16)
    with refused("1.84e+19 designs", "a: 65536, b: 65536, c: 65536, d: 65536"):
        grid(a=axis, b=axis, c=axis, d=axis)


@pytest.mark.parametrize(("start", "stop"), [(-1, 1), (0, 3), (2, 1)])
def test_designs_outside_the_space_are_refused(start, stop):
    with refused("start" if start < 0 else "stop", "to 2"):
        grid(a1=[1.0, 2.0]).fill(["a1"], start, stop, np.empty((1, 4)))


GRID_ERRORS = {
    "empty": ([], "grid: a2", "at least one value"),
    "inf in axis": ([1.0, -np.inf], "grid: a2[1]", "a finite number"),
    "repeat": ([1.0, 2.0, 3.0, 2.0], "grid: a2", "each value once"),
    "two dimensions": (np.ones((2, 2)), "grid: a2", "a flat list of numbers"),
    "text in list": ([1.0, "x"], "grid: a2[1]", "a number"),
    "durations": (np.array([1], "m8[ns]"), "grid: a2", "numbers"),
    "too large": (10**400, "grid: a2", "a smaller one"),
}


@pytest.mark.parametrize(("values", "key", "remedy"), GRID_ERRORS.values(), ids=GRID_ERRORS)
def test_a_bad_axis_is_refused_in_one_line(values, key, remedy):
    with refused(key, remedy):
        grid(a1=0.4, a2=values)


def test_sobol_gives_scipys_first_points_and_notices_another_way(monkeypatch):
    n = 1000
    designs = sobol(n, seed=3, a1=(0.2, 0.4), a4=1.0, a2=(-1.0, 1.0))
    assert (designs.dims, designs.shape) == (("design",), (n,))
    points = qmc.Sobol(2, scramble=True, rng=np.random.default_rng(3)).random(1024)[:n]
    assert_array_equal(designs.columns["a1"], 0.2 + points[:, 0] * (0.4 - 0.2))
    assert_array_equal(designs.columns["a2"], -1.0 + points[:, 1] * 2.0)
    assert designs.constants == {"a4": 1.0}

    class Changed(qmc.Sobol):
        def random(self, n=1, workers=1):
            return 1.0 - super().random(n)

    monkeypatch.setattr(qmc, "Sobol", Changed)
    with pytest.raises(RuntimeError, match="another way"):
        fl.sobol(8, a1=UNIT)


@pytest.mark.parametrize("sample", [sobol, latin_hypercube])
def test_a_sample_is_repeated_by_its_seed_and_says_where_it_comes_from(sample):
    designs = sample(20, seed=5, a1=(0.2, 0.4))
    assert_array_equal(designs.columns["a1"], sample(20, seed=5, a1=(0.2, 0.4)).columns["a1"])
    assert not np.array_equal(designs.columns["a1"], sample(20, a1=(0.2, 0.4)).columns["a1"])
    assert designs.attrs["design_kind"] == designs.kind == sample.__name__
    assert designs.attrs["design_n"] == 20
    assert designs.attrs["design_seed"] == 5
    assert designs.attrs["design_ranges"] == "a1=(0.2, 0.4)"
    assert (
        designs.attrs.keys() >= {"design_bits", "design_scipy"}
        or "permutation" in designs.attrs["design_method"]
    )


def test_a_range_is_not_left_by_rounding():
    assert -0.1 + 1.0 * (0.2 - -0.1) > 0.2

    class Corner(Slices):
        def unit(self, start, stop, out):
            out[:] = 1.0

    assert_array_equal(Corner(3, (-0.1, 0.2), 0, 0), 0.2)


SAMPLE_ERRORS = {
    "no designs": ({"n": 0}, "n", "an integer from 1 to 1125899906842624"),
    "negative seed": ({"seed": -1}, "seed", "an integer from 0 to"),
    "three": ({"a1": (1, 2, 3)}, "a1", "(lo, hi), or a number for a constant"),
    "reversed": ({"a1": (0.5, 0.4)}, "a1", "(lo, hi) with lo < hi"),
    "infinite": ({"a1": (0.5, np.inf)}, "a1", "finite ends"),
    "nan constant": ({"a2": np.nan}, "a2", "a finite number"),
    "text": ({"a1": "0..1"}, "a1", "a flat list of numbers"),
    "no range": ({"a1": 1.0}, "input", "(lo, hi) for at least one, or use a grid"),
}


@pytest.mark.parametrize("sample", [sobol, latin_hypercube])
@pytest.mark.parametrize(("change", "key", "remedy"), SAMPLE_ERRORS.values(), ids=SAMPLE_ERRORS)
def test_a_bad_sample_is_refused_in_one_line(sample, change, key, remedy):
    with refused(key, remedy):
        sample(**{"n": 8, "a1": (0.2, 0.4), **change})


@pytest.mark.parametrize("sample", [sobol, latin_hypercube])
def test_an_input_called_as_a_parameter_is_given_in_a_mapping(sample):
    space = sample(4, {"n": (1.0, 2.0)}, seed=3, m=(1.0, 2.0), d=1.0)
    assert (space.size, list(space.columns), space.constants) == (4, ["n", "m"], {"d": 1.0})
    same = sample(n=4, ranges={"n": (1.0, 2.0), "m": (1.0, 2.0), "d": 1.0}, seed=3)
    np.testing.assert_array_equal(space.columns["n"], same.columns["n"])
    with refused("m", "once"):
        sample(4, {"m": (1.0, 2.0)}, m=1.0)
    with refused("ranges", "by name"):
        sample(4, 5.0)


def test_a_tuple_that_is_rather_a_range_gets_a_remark():
    with pytest.warns(
        InputWarning, match=r"a1: \(0.1, 0.4, 5\) is .* numpy.linspace\(0.1, 0.4, 5\)"
    ) as caught:
        grid(a1=(0.1, 0.4, 5), a2=(1.0, 1.4, 9))
    assert len(caught) == 1
    for axis in ([0.1, 0.4, 5], (0.1, 0.4, 5.0), (1.0, 2.0, 3), (0.1, 0.4, 0.7)):
        assert grid(a1=axis).size == 3


# == Sobol's sequence and Latin hypercubes, design by design: scipy's bits, one design in each slice =========

UNIT = (0.0, 1.0)


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 9), st.integers(0, 2**63 - 1), st.sampled_from([2**30, 2**31]), st.data())
def test_any_block_of_the_sequence_has_scipys_bits(dimensions, seed, n, data):
    axes = sobol_axes(n, seed, [UNIT] * dimensions)
    engine = qmc.Sobol(dimensions, rng=np.random.default_rng(seed), bits=30 if n == 2**30 else 53)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a number that is no power of two
        points = engine.random(20_000)
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


RANGES = {"a2": (1.0, 1.2), "a3": (0.7, 0.9), "a4": (1.0, 1.2), "a1": 0.4}


@pytest.mark.parametrize("sample", [sobol, latin_hypercube])
def test_the_fingerprint_is_that_of_the_definition(sample):
    def fingerprint(n=10**10, seed=1, **ranges):
        space = sample(n, RANGES | {"omega1": 2.0} | ranges, seed=seed)
        return resolve("planar_4r", space, ["omega4_max"], angles=5, branch=(1, 2)).fingerprint

    one, others = fingerprint(), [fingerprint(seed=2), fingerprint(n=10**10 + 1), fingerprint(a2=(1.0, 1.3))]
    assert len({one, *others}) == 4
    assert fingerprint() == one


@pytest.mark.parametrize("sample", [sobol, latin_hypercube])
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


@pytest.mark.parametrize("sample", [sobol, latin_hypercube])
def test_blocks_that_were_read_last_change_nothing(sample):
    column = sample(1000, a1=UNIT).columns["a1"]
    whole = np.asarray(column)
    for start, stop in [(3, 9), (3, 9), (3, 10), (4, 10), (3, 9), (0, 0), (3, 9)]:
        values = column.piece(start, stop)
        assert_array_equal(values, whole[start:stop])
        values[:] = -1.0  # of the caller
