"""The extremes of derivatives by inputs are those of the derivative at one input position.

In the range that is searched a place moves with the lengths. A derivative that moved with it would have other extremes
wherever the motion has limits; so the refined ones are held against those of many samples.
"""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.extrema_errors import designs_of
from tests.support.registry import ENTRIES

import fastlink as fl
from fastlink.facts.names import derivative_name
from fastlink.plan.programs import Planner

DRIVEN = [e for e in ENTRIES if e.moves and e.catalogue.graded and e.solver == "eliminated" and not e.about]
#: A quantity of each input that changes with most inputs, and is finite.
OF = {
    "theta1": "B_x",
    "theta": "slider_position",
    "phi": "F_y",
    "sigma": "F_y",
    "joint_angle_1": "joint_angle_3",
    "joint_angle_2": "joint_angle_3",
    "joint_angle_3": "joint_angle_4",
    "joint_angle_4": "joint_angle_3",
}
SAMPLES = 500


def derivatives(entry, designs):
    """Return the derivatives of the quantity of an entry by its inputs whose extremes are searched."""
    catalogue = entry.catalogue
    name = next(n for n in (OF.get(entry.input, ""), "P_y", "F_y", "N_y") if n in entry.names)
    names = [derivative_name(name, by) for by in designs if by in catalogue.variables]
    variants = catalogue.variants_selected_by(designs)
    found = [n for n in names if Planner(catalogue, tuple(designs), tuple(variants)).search(n)]
    assert found
    return found


#: Others share their facts with one of these.
FIRST = {"theta1", "theta", "joint_angle_2"}
CASES = [
    pytest.param(entry, id=str(entry), marks=() if entry.input in FIRST else pytest.mark.stress)
    for entry in DRIVEN
]


@pytest.mark.parametrize("entry", CASES)
def test_extremes_of_derivatives_are_those_at_one_input_position(entry):
    designs = designs_of(entry, "random", 5, 6)
    names = derivatives(entry, designs)[:1]
    ends = [f"{name}_{end}" for name in names for end in ("max", "min")]
    options = {"input": entry.input, "allow_invalid": True, "progress": False, "verify": 0}
    found = fl.sweep(entry.mechanism, fl.table(designs), ends, **options)
    at = {"angles": SAMPLES, "extrema": "sampled"}
    sampled = fl.sweep(entry.mechanism, fl.table(designs), ends, **options, **at)
    for name in names:
        for end, sign in (("max", 1.0), ("min", -1.0)):
            exact, near = (sign * one[f"{name}_{end}"].values for one in (found, sampled))
            assert (np.isnan(exact) == np.isnan(near)).all()
            # the samples are among all positions, and not one of them is beyond the extreme
            assert (exact >= near - 1e-9 * abs(near))[~np.isnan(near)].all()
