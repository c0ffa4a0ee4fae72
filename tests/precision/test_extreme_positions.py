"""Positions from the least to the greatest double are held to a few roundings, as all others."""

import numpy as np
import pytest
from tests.support.precision import in_every_mode, plain, wrong
from tests.support.registry import ENTRIES

#: Angles are periodic, to the last double; the rapidities of the Minkowskian plane are not.
ANGLES = (0.0, 1e-300, 1e-160, -1e-8, np.pi / 2, -np.pi / 2, 2e6 * np.pi, 1e22, 1.7e308)
RAPIDITIES = (0.0, 1e-300, 1e-160, -1e-8, 30.0, -150.0, 350.0)
TURNED = [
    entry
    for entry in ENTRIES
    if entry.moves and entry.solver == "eliminated" and entry.catalogue.position.units != "m"
]


@pytest.mark.sample(5)
@pytest.mark.parametrize("entry", TURNED, ids=str)
def test_any_position_has_the_digits_of_others(entry):
    names = tuple(name for name in entry.names if name != "v1_ddot")  # beyond doubles next to its pole at 0
    positions = np.array(RAPIDITIES if entry.mechanism == "minkowski_4r" else ANGLES)
    inputs = in_every_mode(entry, entry.drawn("random", 5, positions.size) | {entry.input: positions})
    with np.errstate(all="ignore"):
        found, least, zero = (
            plain(entry, names, inputs | at)
            for at in ({}, *({entry.input: np.full(inputs["branch"].size, x)} for x in (5e-324, 0.0)))
        )
    too_far_off, numbers = wrong(entry, names, inputs, found)
    assert not too_far_off
    assert numbers > positions.size * len(names) // 8
    for name in names:  # of products with the least position no digit is left; and pi is -pi
        np.testing.assert_allclose(abs(least[name]), abs(zero[name]), rtol=0, atol=1e-300, err_msg=name)
