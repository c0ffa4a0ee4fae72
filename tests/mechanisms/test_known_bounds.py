"""Error bounds of extreme inputs: never NaN where a value is a number, infinite where powers of an angle underflow.

Extreme inputs have no sizes in common, so that steps of facts and of bounds overflow and underflow: an infinite error
meets a slope of 0, or another infinite one.
"""

from __future__ import annotations

import numpy as np
import pytest
from tests.mechanisms.test_degenerate_bounds import CASES, LAST, bounded, slopes
from tests.support.degenerate import FAMILIES

import fastlink as fl
from fastlink.facts.bounds import SMALL_ANGLE
from fastlink.mechanisms import catalogue, inputs_of
from fastlink.plan.request import variants_of

SIZES = np.array([0.0, 5e-324, *(10.0**k for k in (-300, -200, -150, -60, -8, 0, 8, 60, 150, 200, 300))])


def configurations(mechanism, drive, about, n):
    """Return configurations at degenerate sets, with their assembly modes."""
    rng = np.random.default_rng(7)
    inputs = FAMILIES[mechanism, drive, about](rng, n)
    n = inputs[drive].size
    return inputs | {"branch": inputs.get("branch", rng.integers(1, 3, n).astype(float))}


def with_extremes(of, inputs):
    """Return the same, every number in four an extreme one."""
    rng, n = np.random.default_rng(8), inputs["branch"].size
    known = of.known_inputs(of.variants_selected_by(inputs))
    for name, values in inputs.items():
        if name == "branch" or (name in known and known[name].choices):
            continue
        rule = known[name].rule if name in known else "any"
        size = rng.choice(SIZES[1:] if rule == "positive" else SIZES, n)
        drawn = size * rng.choice([-1.0, 1.0], n) if rule == "any" else size
        inputs = inputs | {name: np.where(rng.random(n) < 0.25, drawn, values)}
    return inputs


def found(mechanism, inputs, drive, names):
    """Return values, bounds and trusts as arrays (quantities, configurations)."""
    n = inputs["branch"].size
    asked = {ending: [f"{name}{ending}" for name in names] for ending in ("", "_error", "_trust")}
    values = fl.evaluate(mechanism, [one for each in asked.values() for one in each], input=drive, **inputs)
    return [np.array([np.broadcast_to(values[one], n) for one in each]) for each in asked.values()]


def assert_bounds_are_known(mechanism, drive, about, n, variables):
    of = catalogue(mechanism, drive)
    plain = configurations(mechanism, drive, about, n)
    for inputs in (plain, with_extremes(of, plain)):
        variants = variants_of(of, None, "eliminated", inputs)
        names = bounded(of, inputs)
        for by in variables:
            asked = slopes(of, names, by, variants) if by else names
            values, bounds, trusts = found(mechanism, inputs, drive, asked)
            finite = np.isfinite(values)
            assert [
                name for name, bad in zip(asked, finite & np.isnan(bounds), strict=True) if bad.any()
            ] == []
            assert (trusts[finite & ~(bounds < np.inf)] == 1.0).all()
            assert finite.sum() > n


@pytest.mark.sample(4)
@pytest.mark.parametrize(("mechanism", "drive", "about"), CASES)
def test_a_bound_is_a_number_where_the_value_is_one(mechanism, drive, about):
    first = drive == inputs_of(mechanism)[0] and not about
    assert_bounds_are_known(mechanism, drive, about, 200, ("", drive) if first else ("",))


@pytest.mark.stress
@pytest.mark.parametrize(("mechanism", "drive", "about"), CASES)
def test_many_bounds_are_numbers_where_the_values_are(mechanism, drive, about):
    assert_bounds_are_known(mechanism, drive, about, 20_000, ("", drive, LAST[mechanism]))


@pytest.mark.sample(4)
@pytest.mark.parametrize(
    ("mechanism", "drive", "about"),
    [one for one in CASES if catalogue(*one.values[:2]).position.units != "m"],
)
def test_of_angles_whose_powers_underflow_no_digit_is_known(mechanism, drive, about):
    of = catalogue(mechanism, drive)
    inputs = configurations(mechanism, drive, about, 40)
    names = [name for name in bounded(of, inputs) if of.varies(name)]
    small = 10.0 ** np.random.default_rng(9).uniform(-323, -61, inputs["branch"].size)
    for angles, known in ((small, False), (-small, False), (np.zeros_like(small), True)):
        values, bounds, trusts = found(mechanism, inputs | {drive: angles}, drive, names)
        finite = np.isfinite(values)
        assert finite.any()
        if known:
            assert (bounds[finite] < np.inf).any()
        else:
            assert (bounds[finite] == np.inf).all()
            assert (trusts[finite] == 1.0).all()


def test_sweeps_know_small_angles_too():
    linkage = fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=1.0)
    angles = [0.0, 0.5 * SMALL_ANGLE, -5e-324, SMALL_ANGLE, 1.0]
    names = ["omega4_error", "omega4_trust", "theta1_low_error", "omega4_error_max", "d_A_y_d_a1_error"]
    maps = fl.sweep("planar_4r", linkage, names, theta1=angles, branch=1)
    for name in ("omega4_error", "d_A_y_d_a1_error"):
        np.testing.assert_array_equal(np.isinf(maps[name].squeeze()), [False, True, True, False, False])
    np.testing.assert_array_equal(maps["omega4_trust"].squeeze(), [0, 1, 1, 0, 0])
    assert np.isinf(maps["omega4_error_max"]).all()
    assert not np.isinf(maps["theta1_low_error"]).any()  # it belongs to the design
