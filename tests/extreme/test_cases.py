"""Every extreme case of every mechanism: a value within its tolerance, or none and the right flag."""

from __future__ import annotations

import numpy as np
import pytest

import fastlink as fl
from tests.extreme.case import evaluated, outcomes, unknown
from tests.extreme.mechanisms import MECHANISMS
from tests.extreme.planar import PLANAR_4R

FAMILIES = [(name, family) for name, mechanism in MECHANISMS.items() for family in mechanism.families]
STRESS = pytest.param(True, marks=pytest.mark.stress, id="full")


@pytest.mark.sample(5)
@pytest.mark.parametrize("full", [pytest.param(False, id="small"), STRESS])
@pytest.mark.parametrize(("name", "family"), FAMILIES)
def test_what_comes_out(name, family, full):
    mechanism = MECHANISMS[name]
    cases = mechanism.families[family](full)
    found = evaluated(mechanism, cases)
    flags = mechanism.catalogue.facts["status"].flags
    seen: set[str] = set()
    for i, case in enumerate(cases):
        for branch in mechanism.catalogue.branches:
            values = {quantity: array[i] for quantity, array in found[branch].items()}
            assert case.status in (None, flags[int(values["status"])]), case.name
            result = outcomes(mechanism, case, branch, values)
            wrong = {quantity: outcome for quantity, outcome in result.items() if not outcome.right}
            assert wrong.keys() - unknown(mechanism, case, branch, wrong) == set(), (case.name, branch, wrong)
            seen.update(outcome.what for outcome in result.values())
    assert "value" in seen
    assert "underflow" not in seen


@pytest.mark.parametrize("name", MECHANISMS)
def test_compiled_sweeps_have_the_same_bits(name):
    """All cases as one table of designs, over the positions of all; a quantity's bits do not depend on the others."""
    mechanism = MECHANISMS[name]
    cases = [case for make in mechanism.families.values() for case in make(False)]
    position = mechanism.catalogue.position.name
    positions, places = np.unique([case.inputs[position] for case in cases], return_inverse=True)
    names = [name for name in cases[0].inputs if name != position]
    designs = fl.table({name: np.array([case.inputs[name] for case in cases]) for name in names})
    swept = fl.sweep(name, designs, mechanism.swept, threads=2, **{position: positions})
    expected = evaluated(mechanism, cases)
    for quantity in mechanism.swept:
        found = swept[quantity].transpose("design", ...).values
        for k, branch in enumerate(mechanism.catalogue.branches):
            dims = swept[quantity].dims
            one = found[:, k] if "branch" in dims else found
            one = one[np.arange(len(cases)), places] if position in dims else one
            np.testing.assert_array_equal(one, expected[branch][quantity], err_msg=quantity)


def test_the_runner_sees_what_is_wrong():
    """Some roundings more, a number for none, none for a number."""
    (crank,) = (case for case in PLANAR_4R.families["angles"](False) if case.name == "theta1 = 1 pi/2")
    beyond = next(case for case in PLANAR_4R.families["toggles"](False) if "beyond" in case.name)
    found, nothing = (
        {name: array[0] for name, array in evaluated(PLANAR_4R, [case])[1].items()}
        for case in (crank, beyond)
    )
    assert all(outcome.right for outcome in outcomes(PLANAR_4R, crank, 1, found).values())
    wrong = found | {
        "omega4": found["omega4"] * (1.0 + 1e-13),
        "theta4": np.nan,
        "circuit": 2.0,
        "F32": np.inf,
    }
    judged = outcomes(PLANAR_4R, crank, 1, wrong)
    assert {name for name, outcome in judged.items() if not outcome.right} == {
        "omega4",
        "theta4",
        "circuit",
        "F32",
    }
    judged = outcomes(PLANAR_4R, beyond, 1, nothing | {"alpha4": 0.0})
    assert [name for name, outcome in judged.items() if not outcome.right] == ["alpha4"]
