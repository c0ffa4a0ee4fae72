"""Forces at the crank where one link is far shorter than the others: right to roundings of their magnitudes.

Where the ground link is short, the others turn nearly as one, the crank passes on no torque, and its forces lie along
it: across it, they are roundings of a difference of vectors. All else is held to the rule of each quantity, by the
entry "of unequal lengths" of the registry.
"""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.configurations import UNEQUAL, unequal
from tests.support.precision import Truth, in_every_mode, plain
from tests.support.registry import ACROSS, ENTRIES, MULTIPLE

from fastlink.numerics.compensated import UNIT_ROUNDING

ENTRY = next(entry for entry in ENTRIES if str(entry) == "planar_4r of unequal lengths theta1")


@pytest.mark.parametrize("n", [12, pytest.param(600, marks=pytest.mark.stress)])
@pytest.mark.parametrize("kind", UNEQUAL)
def test_forces_at_the_crank_are_right_to_roundings_of_their_magnitude(kind, n):
    inputs = in_every_mode(ENTRY, unequal(kind, np.random.default_rng(n), n))
    computed = plain(ENTRY, ACROSS, inputs)
    truth = Truth(ENTRY, ACROSS, inputs)
    for i, one, true in truth.rows():
        condition = truth.facts.condition(true, truth.numbers)
        for name in ("F41", "F21"):
            parts = [f"{name}_x", f"{name}_y"]
            error = max(abs(float(computed[part][i] - true[part])) for part in parts)
            # What the rule allows of both components: they turn into each other with the frame.
            unit = UNIT_ROUNDING * float(sum(abs(true[part]) + condition[part] for part in parts))
            assert error <= MULTIPLE * unit, (name, one)
