"""Length and area of coupler curves: each within its own bound, and that below 1e-12, against 40 digits."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.support.arc_lengths import exact, reference
from tests.support.curve_designs import CURVE, design_of, evaluate
from tests.support.refusals import refused

import fastlink as fl
from fastlink.planar import curve_area, curve_length

#: What the documentation promises of lengths, and of areas in parts of the area that is swept.
PROMISED = 1e-12


def miss(value: Any, true: Any) -> float:
    """Return the distance of a double from a number of 40 digits; its subtraction by pairs of doubles."""
    return abs(float((true - exact(float(value))).mid()))


def near_cusp(design: list[float], branch: int, angle: float, gap: float) -> list[float] | None:
    """Return the design with P at a gap from the pole of the coupler, which rests at that angle."""
    ends = evaluate(["theta2"], design_of(*design), np.array([-1e-6, 0.0, 1e-6]) + angle, branch)["theta2"]
    if not np.isfinite(ends).all():
        return None
    ratio = (ends[2] - ends[0]) / 2e-6
    pole = gap - design[0] * np.exp(1j * (angle - ends[1])) / ratio
    return [*design, pole.real, pole.imag]


def designs(seed: int, count: int) -> Any:
    """Yield designs and branches: anywhere, next to change points, next to cusps and at them up to 1e-9."""
    rng = np.random.default_rng(seed)
    while count:
        kind, branch, gap = count % 6, int(rng.integers(1, 3)), 10.0 ** rng.uniform(-14.0, -1.0)
        lengths = rng.uniform(0.1, 3.0, 4)
        if kind == 1:
            lengths[3] = lengths[1] + lengths[2] - lengths[0] + gap * rng.choice([-1, 1])
        elif kind == 2:
            lengths[0] = abs(lengths[1] - lengths[2] + lengths[3]) + gap * rng.choice([-1, 1])
        elif kind == 3:
            lengths[2:] = lengths[0] * (1 + gap), lengths[1]
        if lengths.min() < 0.01:
            continue
        one = [*lengths, *rng.uniform(-2.0, 2.0, 2) * 10.0 ** rng.uniform(-3.0, 1.0)]
        if kind >= 4:
            one = near_cusp([*lengths], branch, rng.uniform(-3.0, 3.0), gap * (kind == 4))
        if one is not None:
            count -= 1
            yield list(map(float, one)), branch


def check(design: list[float], branch: int) -> None:
    length, bound = curve_length(design_of(*design), branch=branch, error=True)
    true = reference(design, branch)
    if true is None:
        assert np.isnan(length)
        assert np.isnan(bound)
        return
    assert miss(length, true) <= bound, (design, branch)
    assert bound <= PROMISED * length, (design, branch)
    area, bound = curve_area(design_of(*design), branch=branch, error=True)
    true = reference(design, branch, area=True)
    if true is None:
        assert np.isnan(area)
        return
    # |r x dr| is below |r| |dr|: a bound of the swept area, of which the error is a part.
    reach = design[0] + np.hypot(*design[4:])
    assert miss(area, true) <= bound <= PROMISED * 0.5 * reach * length, (design, branch)


@pytest.mark.parametrize("count", [12, pytest.param(1500, marks=pytest.mark.stress)])
def test_lengths_and_areas_lie_within_their_bounds(count):
    for design, branch in designs(61, count):
        check(design, branch)


def angle_of(a: float, b: float, opposite: Any) -> Any:
    """Return an angle of a triangle by the law of cosines."""
    return np.arccos((a * a + b * b - opposite * opposite) / (2.0 * a * b))


def test_circles_and_arcs_have_closed_forms():
    """A or B as the coupler point: turns and swings of the crank and the output link, whose ends are cusps."""
    cases = [
        ((0.5, 1.2, 0.8, 1.0, 0.0, 0.0), 2 * np.pi * 0.5),
        ((0.8, 1.2, 0.8, 0.3, 1.2, 0.0), 2 * np.pi * 0.8),
        ((0.4, 1.2, 0.8, 1.0, 1.2, 0.0), 1.6 * (angle_of(0.8, 1.0, 1.6) - angle_of(0.8, 1.0, 0.8))),
        # Rockers: one range around 0, around pi, and two, each between AD = abs(a2 - a3) and a2 + a3
        ((1.1, 0.7, 0.8, 1.3, 0.0, 0.0), 2.2 * angle_of(1.1, 1.3, 1.5)),
        ((1.5, 0.4, 1.2, 1.0, 0.0, 0.0), 3.0 * (angle_of(1.5, 1.0, 1.6) - angle_of(1.5, 1.0, 0.8))),
        ((1.2, 2.0, 0.5, 1.0, 0.0, 0.0), 2.4 * (np.pi - angle_of(1.2, 1.0, 1.5))),
    ]
    for branch in (1, 2):
        for design, length in cases:
            got, bound = curve_length(design_of(*design), branch=branch, error=True)
            # The closed forms in doubles: arccos of 3 roundings, magnified up to 3 times by its slope.
            assert abs(got - length) <= bound + 32 * 2.0**-53 * length, design
            assert bound <= PROMISED * length
    area, bound = curve_area(design_of(0.5, 1.2, 0.8, 1.0, 0.0, 0.0), error=True)
    assert abs(area - np.pi * 0.25) <= bound <= PROMISED * area


def test_lengths_of_any_size():
    design = np.array([0.4, 1.2, 0.8, 1.0, 0.7, 0.5])
    length, bound = curve_length(design_of(*design), branch=2, error=True)
    for exponent in (-75, -30, 30, 75):
        scaled, its_bound = curve_length(design_of(*np.ldexp(design, exponent)), branch=2, error=True)
        assert (scaled, its_bound) == (np.ldexp(length, exponent), np.ldexp(bound, exponent))
    # A link of almost no length: the crank, whose turn moves P by a share of it; and the ground.
    for lengths in ((1e-24, 1.2, 0.8, 1.0), (1.0, 1.2, 0.8, 1e-24), (1.0, 1.2, 1e-24, 1.0)):
        got, bound = curve_length(design_of(*lengths, 0.7, 0.5), branch=2, error=True)
        assert 0.0 < bound <= PROMISED * got, lengths


def test_single_positions_and_none():
    length, bound = curve_length(design_of(1.0, 1.0, 1.0, [3.0, 3.1], 0.3, 0.2), error=True)
    assert length[0] == bound[0] == 0.0  # stretched: it cannot move
    assert np.isnan([length[1], bound[1]]).all()


def test_the_error_is_given_if_it_is_asked_for():
    design = dict(zip(CURVE, (0.4, 1.2, 0.8, 1.0, 0.7, 0.5), strict=True))
    length, bound = curve_length(design, branch=[1, 2], error=True)
    assert length.shape == bound.shape == (2,)
    np.testing.assert_array_equal(curve_length(design, branch=[1, 2]), length)
    for function in (fl.planar.curve_length, fl.planar.curve_area):
        with refused("error", "True or False"):
            function(design, error="yes")
