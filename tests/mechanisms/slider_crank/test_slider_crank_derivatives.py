"""Derivatives of the slider-crank, generated and declared: against differences of 50 digits, and their precision."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
from tests.support.slider_crank_configurations import SLIDER_CRANK, family

import fastlink as fl
from fastlink.precision.reference import HighPrecision, error_in_roundings

QUANTITIES = (
    *("slider_position", "slider_velocity", "slider_acceleration", "slider_jerk"),
    *("theta2", "omega2", "alpha2", "jerk2", "transmission_angle"),
    *("T41", "side_force", "F21_x", "F21_y", "shaking_force_x", "shaking_force_y", "shaking_moment"),
)
OF_DESIGN = (
    *("stroke", "outer_dead_centre", "inner_dead_centre", "theta_low", "theta_high", "time_ratio"),
    *("transmission_angle_least", "transmission_angle_greatest"),
)
LENGTHS = ("r", "l", "e")
BY = (*LENGTHS, "theta")
PAIRS = [
    *((name, by) for name in QUANTITIES for by in BY),
    *((name, by) for name in OF_DESIGN for by in LENGTHS),
    *((name, by) for name in ("T41", "shaking_moment") for by in ("omega", "m2", "G2_v", "m3")),
]
#: In roundings of the derivative and of each input; 4.0 is the worst seen in 200 configurations.
MULTIPLE = 8
STEP = mp.mpf("1e-12")


def configurations(kind, n):
    drawn = family(kind, np.random.default_rng(7), n)
    for values in zip(*drawn.values(), strict=True):
        for branch in (1, 2):
            yield dict(zip(drawn, map(float, values), strict=True)) | {"branch": branch}


@pytest.mark.sample(2)
@pytest.mark.parametrize("kind", ["random", "gap 1e-4", "toggle 1e-3", "aligned 1e-3", "stiff 1e3"])
def test_derivatives_are_those_of_differences(kind):
    names = [f"d_{name}_d_{by}" for name, by in PAIRS]
    tested = 0
    for one in configurations(kind, 3):
        facts = HighPrecision(SLIDER_CRANK, ["sigma", *QUANTITIES, *OF_DESIGN, *names], one)
        here = facts.at(one)
        if mp.isnan(here["sigma"]):
            continue
        for by in {by for _, by in PAIRS}:
            size = abs(here[by]) or 1
            step = STEP * size
            above, below = (facts.moved(here, {by: here[by] + sign * step}) for sign in (1, -1))
            for name in (name for name, other in PAIRS if other == by):
                if not mp.isfinite(here[name]):
                    continue
                slope = (above[name] - below[name]) / (2 * step)
                bend = (above[name] - 2 * here[name] + below[name]) / step**2
                # step^2/6 times the third derivative, which is at most 1e12 times the second over the input
                near = STEP * (abs(slope) + abs(bend) * size + abs(here[name]) / size)
                found = here[f"d_{name}_d_{by}"]
                assert abs(found - slope) <= near, (name, by, one, found, slope)
                tested += 1
    assert tested > 60


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    "kind", ["random", "inline", "gap 1e-8", "toggle 1e-6", "aligned 1e-9", "isosceles 1e-3", "stiff 1e9"]
)
def test_derivatives_are_a_few_roundings_off(kind):
    names = [f"d_{name}_d_{by}" for name, by in PAIRS]
    tested = 0
    for one in configurations(kind, 3):
        facts = HighPrecision(SLIDER_CRANK, ["sigma", *names], one)
        true = facts.at(one)
        if mp.isnan(true["sigma"]):
            continue
        with np.errstate(all="ignore"):
            found = fl.evaluate("slider_crank", names, **one)
        condition = facts.condition(true, [name for name in one if name != "branch"])
        for name in names:
            if mp.isfinite(true[name]):
                error = error_in_roundings(float(found[name]), true[name], condition[name])
                assert error <= MULTIPLE, (name, one, error)
                tested += 1
    assert tested > 100
