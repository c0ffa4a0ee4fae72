"""The gradient of a function: the derivatives of its outputs by its inputs, as a sweep has them."""

import pickle

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.support.refusals import refused

import fastlink as fl

FIXED = {"a1": 0.4, "a4": 1.0, "omega1": 25.0}
NAMES = ["omega4_max", "theta1_at_omega4_max", "omega4_mean", "swing"]


def made(outputs=NAMES, inputs=("a2", "a3"), **options):
    return fl.function("planar_4r", list(inputs), list(outputs), **FIXED, **options)


def test_it_has_the_bits_of_a_sweep():
    x = np.array([[1.2, 1.3, 9.0], [0.8, 0.7, 0.8]])
    found = made().gradient(x)
    assert found.shape == (4, 2, 3)
    names = [f"d_{name}_d_{by}" for name in NAMES for by in ("a2", "a3")]
    swept = fl.sweep("planar_4r", fl.table({"a2": x[0], "a3": x[1]} | {k: np.full(3, v) for k, v in FIXED.items()}),
                     names, branch=1, progress=False)  # fmt: skip
    for k, name in enumerate(names):
        assert_array_equal(found[k // 2, k % 2], swept[name])
    assert_array_equal(made().gradient(x[:, 0]), found[..., 0])
    assert_array_equal(pickle.loads(pickle.dumps(made())).gradient(x), found)


def test_quantities_have_the_axes_of_the_function():
    curves = made(["omega4", "B_x"], theta1=[0.1, 0.2, 0.3], branch=[1, 2])
    assert curves.gradient([1.2, 0.8]).shape == (2, 2, 2, 3)
    assert curves.gradient([[1.2] * 5, [0.8] * 5]).shape == (2, 2, 5, 2, 3)


def test_what_does_not_depend_on_an_input_has_the_derivative_zero():
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


def test_a_wrong_shape_is_refused():
    with refused("x has the shape", "its first axis has 2 rows: a2, a3"):
        made().gradient([1.2, 0.8, 1.0])
