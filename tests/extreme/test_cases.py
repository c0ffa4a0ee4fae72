"""Every extreme case of every mechanism: a value within its tolerance, or none and the right flag."""

from __future__ import annotations

import numpy as np
import pytest

from tests.extreme.case import evaluated, outcomes, unknown
from tests.extreme.focal import FOCAL
from tests.extreme.hart import HART
from tests.extreme.minkowski import MINKOWSKI_4R
from tests.extreme.planar import PLANAR_4R

MECHANISMS = {mechanism.catalogue.name: mechanism for mechanism in (PLANAR_4R, MINKOWSKI_4R, FOCAL, HART)}
FAMILIES = [(name, family) for name, mechanism in MECHANISMS.items() for family in mechanism.families]
STRESS = pytest.param(True, marks=pytest.mark.stress, id="full")


@pytest.mark.sample(3)
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
