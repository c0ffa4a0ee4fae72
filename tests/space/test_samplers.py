"""Design spaces: numbering, filling, sampling, and what is refused."""

import importlib
import tracemalloc
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal
from scipy.stats import qmc
from tests.support.refusals import refused

from fastlink.errors import InputWarning
from fastlink.space.samplers import Slices, grid, latin_hypercube, sobol

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


def test_one_design_has_no_dimensions():
    designs = grid(a1=0.4, a2=np.float64(1.2), a3=np.array(0.8), a4=Fraction(1, 2))
    assert (designs.dims, designs.shape, designs.size) == ((), (), 1)
    assert designs.constants == {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 0.5}
    assert_array_equal(filled(designs, ["a4", "a1"], 0, 1), [[0.5], [0.4]])


def test_a_space_keeps_its_values_whatever_the_caller_does():
    axis = np.array([1.0, 2.0])
    designs = grid(a2=axis)
    axis[0] = 9.0
    assert_array_equal(designs.values("a2"), [1.0, 2.0])
    with pytest.raises(ValueError, match="read-only"):
        designs.values("a2")[0] = 9.0


def test_with_constants_adds_only_what_is_missing():
    designs = grid(a1=0.4, a2=[1.0, 2.0]).with_constants({"a1": 9.0, "a2": 9.0, "omega1": 1})
    assert designs.constants == {"a1": 0.4, "omega1": 1.0}
    assert_array_equal(designs.axes["a2"], [1.0, 2.0])
    with refused("constants: m1", "a finite number"):
        designs.with_constants({"m1": np.inf})


def test_an_input_without_a_value_is_named_with_the_nearest():
    with refused("'omega_1'", "did you mean 'omega1'?"):
        grid(omega1=1.0).values("omega_1")
    with refused("'omega_1'", "did you mean 'omega1'?"):
        filled(grid(omega1=1.0), ["omega_1"], 0, 1)


@pytest.mark.parametrize(("start", "stop"), [(-1, 1), (0, 3), (2, 1)])
def test_designs_outside_the_space_are_refused(start, stop):
    with refused("start" if start < 0 else "stop", "to 2"):
        grid(a1=[1.0, 2.0]).fill(["a1"], start, stop, np.empty((1, 4)))


GRID_ERRORS = {
    "empty": ([], "grid: a2", "at least one value"),
    "inf in axis": ([1.0, -np.inf], "grid: a2[1]", "a finite number"),
    "repeat": ([1.0, 2.0, 3.0, 2.0], "grid: a2", "each value once"),
    "two dimensions": (
        np.ones((2, 2)),
        "grid: a2",
        "a flat list of numbers",
    ),
    "text in list": ([1.0, "x"], "grid: a2[1]", "a number"),
    "durations": (np.array([1], "m8[ns]"), "grid: a2", "numbers"),
    "too large": (10**400, "grid: a2", "a smaller one"),
}


@pytest.mark.parametrize(("values", "key", "remedy"), GRID_ERRORS.values(), ids=GRID_ERRORS)
def test_a_bad_axis_is_refused_in_one_line(values, key, remedy):
    with refused(key, remedy):
        grid(a1=0.4, a2=values)


def test_more_designs_than_can_be_numbered_are_refused():
    axis = np.arange(2.0**16)
    with refused("1.84e+19 designs", "a: 65536, b: 65536, c: 65536, d: 65536"):
        grid(a=axis, b=axis, c=axis, d=axis)


def test_sobol_gives_the_first_points_of_scipys_sequence():
    n = 1000
    designs = sobol(n, seed=3, a1=(0.2, 0.4), a4=1.0, a2=(-1.0, 1.0))
    assert (designs.dims, designs.shape) == (("design",), (n,))
    points = qmc.Sobol(2, scramble=True, rng=np.random.default_rng(3)).random(1024)[:n]
    assert_array_equal(designs.columns["a1"], 0.2 + points[:, 0] * (0.4 - 0.2))
    assert_array_equal(designs.columns["a2"], -1.0 + points[:, 1] * 2.0)
    assert designs.constants == {"a4": 1.0}


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
