"""`fl.evaluate` refuses what a sweep refuses: inputs, branches and positions that nothing would depend on."""

import numpy as np
import pytest
import xarray as xr
from tests.support.four_bar import sweep_4r
from tests.support.registry import ENTRIES

import fastlink as fl

DESIGN = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 1.0}
BAR = fl.round_bar(density=7850.0, radius=0.01)


def refused(*expected, mechanism="planar_4r", names=("T41",), **inputs):
    with pytest.raises(fl.InputError) as error:
        fl.evaluate(mechanism, names, **inputs)
    for part in expected:
        assert part in str(error.value)


def test_a_misspelt_input_is_refused():
    """It changed nothing: T41 was that without gravity."""
    refused(
        "gravty_y is unknown", "did you mean 'gravity_y'?", gravty_y=-9.8, theta1=1.0, links=BAR, **DESIGN
    )
    refused("foo is unknown", "known: ", foo=3.0, theta1=1.0, links=BAR, **DESIGN)


@pytest.mark.parametrize("branch", [3, 0, -1, 1.5, np.nan, [1, 2, 3]])
def test_a_branch_that_is_not_there_is_refused(branch):
    """It gave numbers of no assembly mode."""
    refused("branch", "write some of 1, 2", names=["theta4"], theta1=1.0, branch=branch, **DESIGN)


@pytest.mark.sample(5)
@pytest.mark.parametrize("entry", [entry for entry in ENTRIES if entry.moves], ids=str)
def test_a_gap_among_branches_is_a_gap_in_what_depends_on_them(entry):
    """A branch of NaN comes with a configuration of NaN, such as that of a cognate where nothing assembles."""
    one = {name: float(values[0]) for name, values in entry.drawn(next(iter(entry.families)), 5, 1).items()}
    one.pop("branch", None)
    given = {"input": entry.input, "solver": entry.solver, **one}
    modes = [fl.evaluate(entry.mechanism, entry.names, branch=branch, **given) for branch in (1, 2)]
    for gap in ([1, np.nan], np.array([1.0, np.nan]), np.ma.array([1, 1], mask=[0, 1])):
        found = fl.evaluate(entry.mechanism, entry.names, branch=gap, allow_invalid=True, **given)
        for name, values in found.items():
            first, second = np.broadcast_to(values, 2)
            np.testing.assert_equal(first, modes[0][name], err_msg=name)
            if modes[0][name] != modes[1][name]:
                assert np.isnan(second), name
    with pytest.raises(fl.InputError):
        fl.evaluate(entry.mechanism, entry.names, branch=gap, **given)


def test_the_position_of_another_input_names_the_right_one():
    design = {"m": 1.0, "n": 1.1, "d": 1.2, "kappa": 0.5}
    refused("F_y: the input is phi", "input='F_y'", mechanism="hart", names=["F_x"], F_y=1.0, **design)
    slider = {"r": 0.1, "l": 0.4, "e": 0.0}
    refused(
        "theta1: the input is theta",
        mechanism="slider_crank",
        names=["slider_position"],
        theta1=1.0,
        **slider,
    )


def test_what_is_of_the_design_needs_no_position():
    design = {"a1": 0.4, "a2": [1.2, 1.3], "a3": 0.8, "a4": 1.0}
    found = fl.evaluate("planar_4r", ["swing"], **design)["swing"]
    assert found.tolist() == fl.evaluate("planar_4r", ["swing"], theta1=1.0, **design)["swing"].tolist()
    assert found.shape == (2,)
    refused("theta1 is missing", "give it in rad", names=["swing", "theta4"], **design)


@pytest.mark.parametrize("name", ["omega4", "d_omega4_d_a2", "omega4_error", "grashof_class", "status"])
def test_results_of_evaluate_are_labelled_as_in_a_map(name):
    angles = xr.DataArray([0.5, 1.0], dims="theta1")
    found = fl.evaluate("planar_4r", [name], **DESIGN, theta1=angles)[name]
    swept = sweep_4r(DESIGN, [name], theta1=angles)[name]
    for label in ("units", "long_name", "symbol", "references"):
        assert found.attrs.get(label) == swept.attrs.get(label), label
    twice = fl.evaluate("planar_4r", [name], **DESIGN, theta1=angles)[name]
    found.attrs["units"] = "spoiled"
    assert twice.attrs.get("units") == swept.attrs.get("units")
