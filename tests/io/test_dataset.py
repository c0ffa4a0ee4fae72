"""Labels: coordinates of every kind of design space, and the Dataset of a sweep in memory."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from fastlink.io.layout import Variable, assemble, coordinates, plain_attrs
from fastlink.space.samplers import grid
from fastlink.space.tables import table

METRE = {"units": "m", "long_name": "length", "symbol": "a"}
DESCRIBED = dict.fromkeys(["a1", "a2", "a3", "a4"], METRE)
BRANCH = {"branch": (("branch",), np.array([1, 2], dtype="i1"), {"long_name": "assembly mode"})}


def test_a_grid_has_axes_as_index_coordinates_and_constants_as_scalars():
    coords = coordinates(grid(a1=0.4, a2=[1.0, 2.0], a3=[3.0, 4.0, 5.0]), DESCRIBED, BRANCH)
    assert dict(coords.sizes) == {"a2": 2, "a3": 3, "branch": 2}
    assert set(coords.indexes) == {"a2", "a3", "branch"}
    assert not coords.data_vars
    assert_array_equal(coords["a3"], [3.0, 4.0, 5.0])
    assert coords["a1"].dims == ()
    assert float(coords["a1"]) == 0.4
    assert coords["a1"].attrs == coords["a2"].attrs == METRE
    assert coords["branch"].attrs == {"long_name": "assembly mode"}
    assert coords.attrs == {"design_kind": "grid"}


def test_a_table_has_its_columns_along_design():
    coords = coordinates(table({"a1": [0.4, 0.4, 0.6], "a4": 1.0}), DESCRIBED, {})
    assert dict(coords.sizes) == {"design": 3}
    assert set(coords.indexes) == {"design"}
    assert coords["design"].dtype.kind == "i"
    assert_array_equal(coords["design"], [0, 1, 2])
    assert coords["a1"].dims == ("design",)
    assert_array_equal(coords["a1"], [0.4, 0.4, 0.6])
    assert coords["a1"].attrs == METRE
    assert coords.attrs == {"design_kind": "table"}


def test_a_further_coordinate_does_not_hide_an_input():
    with pytest.raises(ValueError, match="'a1' is an input of the design space already"):
        coordinates(grid(a1=0.4), DESCRIBED, {"a1": ((), np.array(1.0), {})})


def test_assemble_refuses_what_does_not_fit():
    coords = coordinates(grid(a1=0.4, a2=[1.0, 2.0]), DESCRIBED, {})

    def attempt(name, dims, shape, dtype="f8"):
        assemble(
            coords, [Variable(name, dims, shape, np.dtype("f8"), {})], {name: np.zeros(shape, dtype)}, {}
        )

    attempt("x", ("a2",), (2,))
    with pytest.raises(ValueError, match="x: 3 along 'a2', its coordinate 2"):
        attempt("x", ("a2",), (3,))
    with pytest.raises(ValueError, match="x: 2 along 'branch', its coordinate None"):
        attempt("x", ("branch",), (2,))
    with pytest.raises(ValueError, match="a1: a coordinate has that name"):
        attempt("a1", ("a2",), (2,))
    with pytest.raises(TypeError, match="x: values are float32, not float64"):
        attempt("x", ("a2",), (2,), "f4")


def test_a_variable_knows_its_size_and_checks_itself():
    assert Variable("x", ("a", "b"), (3, 5), np.dtype("f4"), {}).nbytes == 60
    assert Variable("x", (), (), np.dtype("f8"), {}).nbytes == 8
    with pytest.raises(ValueError, match=r"x: dimensions \('a',\) but shape \(3, 5\)"):
        Variable("x", ("a",), (3, 5), np.dtype("f8"), {})
    with pytest.raises(TypeError, match="x: dtype bool is neither integer nor floating point"):
        Variable("x", ("a",), (3,), np.dtype(bool), {})


def test_attributes_are_plain():
    plain = plain_attrs({"t": "text", "b": True, "n": np.int8(3), "f": 0.5, "l": [1, 2]})
    assert {name: type(value) for name, value in plain.items()} == {
        "t": str,
        "b": int,
        "n": np.int8,
        "f": float,
        "l": np.ndarray,
    }


@pytest.mark.parametrize("value", [None, {"a": 1}, [], ["a", "b"], [[1, 2]], b"bytes"])
def test_other_attributes_are_refused(value):
    with pytest.raises(
        TypeError, match=r"attribute 'x': .* is neither text nor a number nor a list of numbers"
    ):
        plain_attrs({"x": value})
