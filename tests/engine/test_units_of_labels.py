"""The unit that labelled values state is that of their input, is converted, or is refused; at every door."""

import numpy as np
import pytest
import xarray as xr
from tests.support.refusals import refused

import fastlink as fl

LENGTHS = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0}
DESIGN = LENGTHS | {"omega1": 25.0}
POINT = {"P_u": 0.5, "P_v": 0.1}


def labelled(values, units):
    values = np.asarray(values)
    return xr.DataArray(values, dims=["x"][: values.ndim], attrs={"units": units})


DOORS = {
    "sweep": lambda given: fl.sweep("planar_4r", fl.grid({**DESIGN, **given}), ["omega4_max"], branch=(1, 2)),
    "evaluate": lambda given: fl.evaluate("planar_4r", ["omega4"], **{**DESIGN, **given}, theta1=1.0),
    "function": lambda given: fl.function("planar_4r", ["a4"], ["omega4_max"], **without(given)),
    "curve_length": lambda given: fl.planar.curve_length({**LENGTHS, **POINT, **given}),
}


def without(given):
    return {name: value for name, value in {**DESIGN, **given}.items() if name != "a4"}


@pytest.mark.parametrize("unit", ["kg", "furlong", "m s-1", "mm2"])
@pytest.mark.parametrize("door", DOORS)
def test_a_unit_of_another_kind_is_refused(door, unit):
    with refused("a1", "convert it to m"):
        DOORS[door]({"a1": labelled(0.4, unit)})


@pytest.mark.parametrize("door", DOORS)
def test_the_unit_of_the_input_is_taken(door):
    DOORS[door]({"a1": labelled(0.4, "metre")})


@pytest.mark.parametrize("name", ["theta1", "theta1_deg"])
def test_positions_in_another_unit_are_refused(name):
    remedy = "convert it to degrees" if name.endswith("_deg") else "convert it to rad"
    unit = "turn" if name.endswith("_deg") else "mm"
    for call in (
        lambda: fl.sweep(
            "planar_4r", DESIGN, ["omega4"], **{name: labelled([0.1, 0.2], unit)}, branch=(1, 2)
        ),
        lambda: fl.evaluate("planar_4r", ["omega4"], **DESIGN, **{name: labelled(0.1, unit)}),
        lambda: fl.function("planar_4r", ["a4"], ["omega4"], **without({}), **{name: labelled([0.1], unit)}),
    ):
        with refused(name, remedy):
            call()


def test_labelled_degrees_are_converted_alike():
    degrees = fl.evaluate("planar_4r", ["omega4"], **DESIGN, theta1=labelled(60.0, "degree"))["omega4"]
    by_name = fl.evaluate("planar_4r", ["omega4"], **DESIGN, theta1_deg=60.0)["omega4"]
    both = fl.evaluate("planar_4r", ["omega4"], **DESIGN, theta1_deg=labelled(60.0, "degree"))["omega4"]
    assert float(degrees) == by_name == float(both)
    swept = fl.sweep("planar_4r", DESIGN, ["omega4"], theta1=labelled([60.0], "deg"), branch=1)
    assert swept.omega4.item() == by_name


@pytest.mark.parametrize("name", ["omega4", "d_omega4_d_a2", "omega4_error", "grashof_class", "status"])
def test_results_of_evaluate_are_labelled_as_in_a_map(name):
    angles = xr.DataArray([0.5, 1.0], dims="theta1")
    found = fl.evaluate("planar_4r", [name], **DESIGN, theta1=angles)[name]
    swept = fl.sweep("planar_4r", DESIGN, [name], theta1=angles, branch=(1, 2))[name]
    for label in ("units", "long_name", "symbol", "references"):
        assert found.attrs.get(label) == swept.attrs.get(label), label
    twice = fl.evaluate("planar_4r", [name], **DESIGN, theta1=angles)[name]
    found.attrs["units"] = "spoiled"
    assert twice.attrs.get("units") == swept.attrs.get("units")
