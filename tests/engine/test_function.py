"""`fastlink.function`: the bits of a sweep, as a function of arrays that threads, pickles and optimisers use."""

import pickle
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numba
import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.support.refusals import refused
from tests.support.sweeps import BARS

import fastlink as fl

FIXED = {"a1": 0.4, "a4": 1.0, "omega1": 25.0}
#: Crank-rockers, open chains and change points.
LENGTHS = np.random.default_rng(3).uniform(0.5, 1.5, (2, 150))
LENGTHS[:, :3] = [[1.0, 0.6, 1.6], [0.4, 1.0, 1.0]]
REQUESTS = {
    "refined": (["omega4_max", "theta1_at_omega4_max", "shaking_force_max"], {"links": BARS}),
    "sampled": (["omega4_max", "T41_rms", "status"], {"links": BARS, "extrema": "sampled", "theta1": 90}),
    "both": (
        ["omega4_mean", "transmission_angle_min", "status"],
        {"theta1": [0.1, 0.2, 0.7], "extrema": "sampled"},
    ),
    "curve": (["omega4", "status"], {"theta1": 40}),
    "list": (["omega4_extrema", "omega4_extrema_count"], {}),
    "dense": (["T41_max"], {"links": BARS, "solver": "dense", "extrema": "sampled", "theta1": 12}),
    "load": (["T41_max"], {"links": BARS, "gravity_y": -9.81}),
}


def swept(names, lengths=LENGTHS, branch=(1, 2), **options):
    fixed = FIXED | {name: options.pop(name) for name in ("gravity_y",) if name in options}
    space = fl.table({"a2": lengths[0], "a3": lengths[1]}).with_constants(fixed)
    return fl.sweep("planar_4r", space, names, branch=branch, allow_invalid=True, **options)


@pytest.mark.sample(4)
@pytest.mark.parametrize("request_name", REQUESTS)
@pytest.mark.parametrize("branch", [1, (2,), (2, 1)])
def test_a_function_has_the_bits_of_a_sweep(request_name, branch):
    names, options = REQUESTS[request_name]
    function = fl.function("planar_4r", ["a2", "a3"], names, branch=branch, **FIXED, **options)
    maps = swept(names, branch=branch, **options)
    outputs = function(LENGTHS.reshape(2, 5, 30))
    assert outputs.shape == (len(names), 5, 30, *function.shape)
    for row, name in zip(outputs.reshape(len(names), 150, *function.shape), names, strict=True):
        expected = maps[name]
        if "branch" not in expected.dims and branch != 1:
            expected = expected.expand_dims(branch=len(branch), axis=1)
        values = expected.values
        values = values.reshape(*values.shape, *[1] * (row.ndim - values.ndim))
        assert_array_equal(row, np.broadcast_to(values, row.shape))


@pytest.mark.parametrize("request_name", REQUESTS)
def test_one_design_has_the_bits_of_many(request_name):
    names, options = REQUESTS[request_name]
    function = fl.function("planar_4r", ["a2", "a3"], names, **FIXED, **options)
    together = function(LENGTHS)
    for k in (0, 1, 2, 149):
        assert_array_equal(function(LENGTHS[:, k]), together[:, k])


def test_any_number_of_designs_on_any_threads_has_the_bits_of_one_call():
    function = fl.function("planar_4r", ["a2", "a3"], ["omega4_max"], **FIXED)
    many = np.tile(LENGTHS, 17)
    assert_array_equal(function(many), np.tile(function(LENGTHS), 17))
    assert function(np.empty((2, 0))).shape == (1, 0)
    function = fl.function("planar_4r", ["a2", "a3"], ["omega4_max", "transmission_angle_min"], **FIXED)
    expected = function(LENGTHS)
    with ThreadPoolExecutor(8) as pool:
        for k, outputs in enumerate(pool.map(lambda k: function(LENGTHS[:, k % 150]), range(1200))):
            assert_array_equal(outputs, expected[:, k % 150])


def test_impossible_values_give_nan_and_change_nothing_else():
    names = ["shaking_force_max", "status"]
    function = fl.function(
        "planar_4r", ["a2", "a3", "density"], names, links=fl.round_bar(radius=0.01), **FIXED
    )
    good = np.array([1.2, 0.8, 7750.0])
    bad = np.tile(good[:, None], 7)
    for k, (row, value) in enumerate([(0, np.nan), (0, -1.0), (1, 0.0), (2, -1.0), (2, np.inf)]):
        bad[row, k] = value
    outputs = function(bad)
    assert_array_equal(np.isnan(outputs[0]), [True] * 5 + [False] * 2)
    assert_array_equal(outputs[1], [4, 4, 4, 0, 0, 0, 0])
    assert all(np.isnan(function(bad[:, k])[0]) for k in range(5))
    assert_array_equal(outputs[:, 5], function(good))


@pytest.mark.parametrize("backend", ["llvm", "numba"])
def test_backends_have_the_same_bits(backend):
    function = fl.function("planar_4r", ["a2", "a3"], ["omega4"], theta1=40, backend=backend, **FIXED)
    assert_array_equal(function(LENGTHS)[0], swept(["omega4"], branch=1, theta1=40).omega4)


def test_a_pickled_function_is_the_same():
    function = fl.function(
        "planar_4r", ["a2", "a3"], ["shaking_force_max"], links=BARS, branch=(1, 2), **FIXED
    )
    again = pickle.loads(pickle.dumps(function))
    assert (again.inputs, again.quantities, again.shape) == (("a2", "a3"), ("shaking_force_max",), (2,))
    assert_array_equal(again(LENGTHS), function(LENGTHS))


@pytest.mark.parametrize(
    ("inputs", "outputs", "options", "key", "remedy"),
    [
        (["a2", "a7"], ["omega4_max"], FIXED, "a7", ""),
        (["a2", "a3"], ["omega5_max"], FIXED, "'omega5_max'", "did you mean 'omega4_max'"),
        (["a2", "a3"], ["omega4_max"], FIXED | {"a2": 1.0}, "a2", ""),
        (["a2", "a3"], ["omega4_max"], FIXED | {"a1": -1.0}, "a1", "greater than 0"),
        (["a2", "a3"], ["omega4_max"], FIXED | {"a1": [1.0, 2.0]}, "a1", "one number"),
        ("a2", ["omega4_max"], FIXED, "inputs", "['a2']"),
        (["a2", "a2"], ["omega4_max"], FIXED, "'a2'", "name it once"),
        (["a2", "a3"], ["omega4", "omega4_extrema"], FIXED, "omega4_extrema", "make a function of each"),
        (["a2", "theta1"], ["omega4_max"], FIXED, "'theta1'", "write theta1 as an option of the function"),
    ],
)
def test_wrong_requests_are_refused(inputs, outputs, options, key, remedy):
    with refused(key, remedy):
        fl.function("planar_4r", inputs, outputs, **options)


def test_wrong_arguments_and_choices_that_are_open_are_refused():
    function = fl.function("planar_4r", ["a2", "a3"], ["omega4_max"], **FIXED)
    for wrong in (1.0, [1.0], np.ones((3, 2))):
        with refused("x", "2 rows: a2, a3"):
            function(wrong)
    with refused("x has the shape", "its first axis has 2 rows: a2, a3"):
        made().gradient([1.2, 0.8, 1.0])
    with refused("completion", "one of 1"):
        fl.function("focal", ["b"], ["T_x"], a=1.0, c=1.1, d=1.4, rho=0.5)
    with pytest.raises(fl.InputError) as caught:
        fl.function("planar_4r", ["a9"], ["omega9_max"], a1=0.4, alpha9=1.0, solver="x")
    where = sorted(str(one.where) for one in caught.value.problems)
    assert where == ["('function', 'alpha9')", "('inputs', 'a9')", "('quantities', 0)", "('solver',)"]


def test_what_is_slow_to_import_is_imported_where_it_is_used_only():
    """xarray and HDF5 take longer to import than all else: the first answer would come in twice the time."""
    script = (
        "import sys, fastlink as fl\n"
        f"made = fl.function('planar_4r', ['a2'], ['omega4_max'], a3=0.8, **{FIXED!r})\n"
        "made([1.2])\n"
        f"fl.evaluate('planar_4r', ['omega4'], a2=1.2, a3=0.8, theta1=0.3, **{FIXED!r})\n"
        "print([name for name in ('xarray', 'h5py', 'numba') if name in sys.modules])\n"
        "made.jitted; assert 'numba' in sys.modules\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == ["[]"]


# == The gradient of a function: the derivatives of its outputs by its inputs, as a sweep has them ===========

NAMES = ["omega4_max", "theta1_at_omega4_max", "omega4_mean", "swing"]


def made(outputs=NAMES, inputs=("a2", "a3"), **options):
    return fl.function("planar_4r", list(inputs), list(outputs), **FIXED, **options)


def test_it_has_the_bits_of_a_sweep():
    x = np.array([[1.2, 1.3, 9.0], [0.8, 0.7, 0.8]])
    found = made().gradient(x)
    assert found.shape == (4, 2, 3)
    names = [f"d_{name}_d_{by}" for name in NAMES for by in ("a2", "a3")]
    space = fl.table({"a2": x[0], "a3": x[1]}).with_constants(FIXED)
    swept = fl.sweep("planar_4r", space, names, branch=1)
    for k, name in enumerate(names):
        assert_array_equal(found[k // 2, k % 2], swept[name])
    assert_array_equal(made().gradient(x[:, 0]), found[..., 0])
    assert_array_equal(pickle.loads(pickle.dumps(made())).gradient(x), found)


def test_axes_are_those_of_the_function_and_what_does_not_depend_on_an_input_has_the_derivative_zero():
    curves = made(["omega4", "B_x"], theta1=[0.1, 0.2, 0.3], branch=[1, 2])
    assert curves.gradient([1.2, 0.8]).shape == (2, 2, 2, 3)
    assert curves.gradient([[1.2] * 5, [0.8] * 5]).shape == (2, 2, 5, 2, 3)
    both = made(["transmission_angle_min", "theta1_at_B_x_max"], ["a2", "a3", "P_u"])
    found = both.gradient([1.2, 0.8, 0.3])
    assert (found[:, :2] != 0.0).all()
    assert (found[:, 2] == 0.0).all()


def test_it_has_none_where_there_is_no_value_or_a_mean_is_taken_between_limits_that_move():
    """A crank-rocker, a double rocker, what never assembles: A_y depends on a1 alone, its range on all lengths."""
    inputs, others = ["a1", "a3", "omega1"], {"a2": 1.1, "a4": 1.0}
    designs = np.array([[0.4, 0.8, 1.0], [0.9, 0.3, 1.0], [0.1, 9.0, 1.0]]).T
    cycle = fl.function("planar_4r", inputs, ["A_y_mean", "A_y_rms", "A_y_max"], **others)
    mean, rms, greatest = cycle.gradient(designs)[:, 1]
    assert_array_equal(mean, [0.0, np.nan, np.nan])
    assert_array_equal(rms, mean)
    assert_array_equal(greatest[[0, 2]], [0.0, np.nan])
    at_one = fl.function("planar_4r", inputs, ["B_y"], theta1=[0.5], **others)
    value = at_one(designs)[0]
    assert 0 < np.isnan(value).sum() < 3
    assert_array_equal(at_one.gradient(designs)[0, 2], np.where(np.isnan(value), np.nan, 0.0))


@pytest.mark.parametrize("name", ["status", "omega4_extrema", "omega4_max_error"])
def test_what_has_no_derivative_is_refused(name):
    with refused("quantities[1]", "leave it out"):
        made(["omega4_max", name]).gradient([1.2, 0.8])


# == Functions that numba's compiled code calls: the same bits, nothing compiled twice, nothing shared =======

ROWS = LENGTHS.copy()
ROWS[:, :4] = [[1.0, np.nan, -1.0, 0.0], [0.4, 1.0, 1.0, 1.0]]
#: One design is beyond the range of numbers.
FAR = ROWS * np.where(np.arange(150) == 9, 2.0**100, 1.0)


def assert_jitted_has_the_bits(function):
    jitted, together = function.jitted, function(ROWS)
    assert_array_equal(jitted(ROWS), together)
    assert_array_equal(jitted(ROWS[:, 7]), together[:, 7])
    assert_array_equal(jitted(FAR), function(FAR))
    with ThreadPoolExecutor(4) as pool:
        for result in pool.map(lambda _: jitted(ROWS), range(40)):
            assert_array_equal(result, together)


@pytest.mark.stress
@pytest.mark.parametrize(
    ("names", "options"),
    [
        (["omega4", "status"], {"theta1": 40}),
        (["omega4_max", "shaking_force_max", "status"], {"links": BARS, "branch": (2, 1)}),
    ],
)
def test_a_jitted_function_has_the_bits_of_the_function(names, options):
    """Of values and codes; of rates by default, in the loop below, whose compilation takes most of the time."""
    assert_jitted_has_the_bits(fl.function("planar_4r", ["a2", "a3"], names, **FIXED, **options))


def test_choices_are_checked():
    function = fl.function(
        "focal", ["completion", "b"], ["status", "m", "grashof_excess"], a=5.0, c=2.0, d=4.0, rho=1.0
    )
    x = np.array([[1.0, 2.0, 9.0, 1.5], [5.0] * 4])
    assert_array_equal(function.jitted(x), function(x))
    assert_array_equal(np.isnan(function(x)[1]), [False, False, True, True])


def test_a_design_loop_in_numba_and_rows_that_it_has_not():
    function = fl.function("planar_4r", ["a2", "a3"], ["omega4_max", "transmission_angle_min"], **FIXED)
    assert_jitted_has_the_bits(function)
    evaluate = function.jitted
    with pytest.raises(ValueError, match="as many rows"):
        evaluate(np.ones(3))

    @numba.njit
    def slowest(low, high, steps):
        best = np.array([np.inf, np.nan, np.nan])
        for i in range(steps):
            for j in range(steps):
                x = low + (high - low) * np.array([i, j]) / (steps - 1)
                omega, angle = evaluate(x)
                if angle > np.radians(30.0) and omega < best[0]:
                    best[:] = omega, x[0], x[1]
        return best

    low, high = np.array([1.0, 0.6]), np.array([1.4, 1.0])
    result = slowest(low, high, 30)
    axes = [low[k] + (high[k] - low[k]) * np.arange(30) / 29 for k in (0, 1)]
    omega, angle = function(np.array(np.meshgrid(*axes, indexing="ij")))
    assert result[0] == omega[angle > np.radians(30.0)].min()
