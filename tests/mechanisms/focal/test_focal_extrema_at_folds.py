"""Extremes of focal mechanisms within the last cell beside a fold."""

import numpy as np
import pytest

import fastlink as fl


@pytest.mark.parametrize("completion", [1.0, 2.0])
def test_a_point_far_away_that_swings_round_beside_a_fold_has_its_greatest_height(completion):
    """T is 3e9 lengths away where rho nears -1, and AB turns within 1e-9 rad of sigma = 0: T_y_max was 0."""
    kite = {"a": 6.0, "b": 6.0, "c": 2.0, "d": 2.0, "rho": -0.9999999993232827, "completion": completion}
    ends = [f"T_y_{end}{of}" for end in ("max", "min") for of in ("", "_error")]
    found = fl.sweep("focal", fl.grid(**kite), ends, input="sigma", branch=1, verify=0)
    most, above, least, below = (float(found[name]) for name in ends)
    octaves = 2.0 ** np.linspace(-60.0, 1.5, 800)
    sigma = np.concatenate([octaves, -octaves])
    curve = fl.evaluate("focal", ["T_y", "T_y_error"], input="sigma", sigma=sigma, branch=1, **kite)
    told = np.isfinite(curve["T_y"]) & np.isfinite(curve["T_y_error"])
    value, error = curve["T_y"][told], curve["T_y_error"][told]
    assert np.max(value) > 1e9
    assert np.all(value - error <= most + above)
    assert np.all(value + error >= least - below)
