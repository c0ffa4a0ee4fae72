"""Reductions over the cycle run over the positions at which the linkage can be assembled.

The crank pin has a place at every crank angle, also where the other links do not reach: that is no part of the motion.
"""

import math
from typing import Any

import numpy as np
import pytest
from tests.support.configurations import draw
from tests.support.sweeps import sweep_4r, sweep_both

import fastlink as fl
from fastlink.mechanisms import NAMES, catalogue, inputs_of

LINKS = {"a1": 1.0, "a2": 0.6, "a3": 0.7, "a4": 1.2}  # no link turns fully
ALL = np.linspace(0.0, 2.0 * np.pi, 97)[:-1]


def swept(names: list[str], **options: Any) -> Any:
    return fl.sweep("planar_4r", fl.grid(**LINKS), names, branch=1, verify=0, **options)


REDUCED = {
    "mean": lambda values: values.mean(),
    "rms": lambda values: math.sqrt((values * values).mean()),
    "max": lambda values: values.max(),
    "min": lambda values: values.min(),
    "peak": lambda values: abs(values).max(),
}
EXTREMES = ("max", "min", "peak")
SLOPED = 2  # of every sixth quantity from there on the first one changes with the first input


@pytest.mark.sample(4)
@pytest.mark.parametrize(
    ("mechanism", "drive"),
    [(name, drive) for name in NAMES for drive in inputs_of(name) if drive not in ("F_y", "sigma")],
)
def test_reductions_run_over_positions_that_assemble(mechanism: str, drive: str) -> None:
    """Of what the driven link alone determines: with F and with the focal crank nothing is."""
    known, rng = catalogue(mechanism, drive), np.random.default_rng(3)
    design = draw(known.inputs, rng, 60)
    design |= {one: np.ones(60) for one, of in known.inputs.items() if of.choices}
    positions = ALL if known.position.units == "rad" else np.linspace(-1.5, 1.5, 60)
    columns = {name: values[:, None] for name, values in design.items()}
    numbers = [name for name in known.public if known.varies(name) and not known.public[name].flags]
    numbers = [name for name in numbers if name != "shaking_moment_at"]
    found = fl.evaluate(mechanism, numbers, input=drive, branch=1.0, **columns, **{drive: positions})
    there = {name: np.isfinite(np.broadcast_to(of, (60, positions.size))) for name, of in found.items()}
    always = [name for name in numbers if there[name].mean() > 0.95]  # a half-angle tangent is infinite at pi
    name = next(name for name in always if there[name].all() and np.ptp(found[name]) > 0.0)
    closes = np.any([there[other] for other in numbers if other not in always], axis=0)
    part = closes.any(axis=1) & ~closes.all(axis=1)
    assert part.sum() > 5
    asked = [*(f"{name}_{how}" for how in REDUCED), f"{drive}_at_{name}_max"]
    options = {"input": drive, "branch": 1, "verify": 0, drive: positions, "extrema": "sampled"}
    maps = sweep_both(mechanism, fl.table(design), asked, **options)
    for k in np.flatnonzero(part):
        values = np.broadcast_to(found[name], closes.shape)[k][closes[k]]
        for how, reduce in REDUCED.items():
            # sums of fewer than 100 terms, each right to 2 roundings
            off = abs(float(maps[f"{name}_{how}"][k]) - reduce(values))
            assert off < 100 * 2.0**-52 * abs(values).max()
        assert float(maps[asked[-1]][k]) in positions[closes[k]]


def test_a_mean_over_the_motion_is_an_integral() -> None:
    limit = math.acos((1.0 + 1.44 - 1.69) / 2.4)  # |AD| = a2 + a3
    maps = swept(["A_x_mean", "A_x_rms", "A_x_max", "A_x_min", "A_x_fluctuation"], theta1=20_000)
    # equal steps leave an error of the share of one step of the motion, times the range of cosines
    step = 2.0 * math.pi / 20_000 / (2.0 * limit)
    assert abs(float(maps.A_x_mean.item()) - math.sin(limit) / limit) < 2.0 * step
    square = 0.5 + math.sin(2.0 * limit) / (4.0 * limit)
    assert abs(float(maps.A_x_rms.item()) - math.sqrt(square)) < 2.0 * step
    assert float(maps.A_x_min.item()) <= float(maps.A_x_mean.item()) <= float(maps.A_x_max.item())
    assert np.isnan(maps.A_x_fluctuation.item())  # which needs a whole turn


def test_what_never_assembles_has_no_mean() -> None:
    names = ["A_x_mean", "A_x_rms", "A_x_max", "status"]
    maps = sweep_4r(fl.grid(a1=1.0, a2=0.1, a3=0.2, a4=5.0), names, theta1=36, verify=0)
    assert all(np.isnan(maps[name]).all() for name in names[:3])


def test_derivatives_of_means_count_the_same_positions() -> None:
    names = ["A_x_mean", "d_A_x_mean_d_a1", "A_x_mean_gradient_status"]
    given = swept(names, theta1=ALL)
    # A_x is a1 cos(theta1): the derivative of the mean of samples is that mean over a1, of 1
    assert math.isclose(float(given.d_A_x_mean_d_a1.item()), float(given.A_x_mean.item()), rel_tol=1e-14)
    assert int(given.A_x_mean_gradient_status.item()) == 7  # of the sampled positions that assemble
    turn = swept(names, theta1=96)
    assert np.isnan(turn.d_A_x_mean_d_a1.item())  # the limits of the integral move
    assert int(turn.A_x_mean_gradient_status.item()) == 10


def test_the_verification_counts_the_same_positions(tmp_path: Any) -> None:
    names = ["A_x_mean", "A_y_rms", "G1_x_max", "v1_dot_min", "A_x_min"]
    space = fl.grid(a1=np.linspace(0.5, 1.5, 8), a2=0.6, a3=0.7, a4=1.2, G1_u=0.3, G1_v=0.1, omega1=2.0)
    maps = sweep_4r(space, names, theta1=60, extrema="sampled", to=tmp_path / "map.h5", verify=8)
    assert all(maps[name].attrs["verify_mismatches"] == 0 for name in names)
    assert all(maps[name].attrs["error_max_relative"] < 1e-14 for name in names)


@pytest.mark.sample(1)
@pytest.mark.parametrize("part", range(6))
@pytest.mark.parametrize("mechanism", [name for name in NAMES if catalogue(name).graded is not None])
def test_a_peak_is_the_greatest_magnitude(mechanism: str, part: int) -> None:
    """With its place, error bound and derivatives: those of the greatest value, or of the least."""
    known, rng = catalogue(mechanism), np.random.default_rng(3)
    numbers = [
        name
        for name in known.public
        if known.has_reductions(name) and not known.public[name].flags and not known.is_derivative(name)
    ]
    at, first = known.position.name, next(iter(known.inputs))
    names = numbers[part::6]
    design = draw(known.inputs, rng, 12)
    asked = [f"{form}_{how}" for name in names for form in (name, f"{at}_at_{name}") for how in EXTREMES]
    design |= {one: np.ones(12) for one, of in known.inputs.items() if of.choices}
    for extrema in ("refined", "sampled"):
        has_slope = extrema == "refined" and part == SLOPED
        asked += [f"d_{names[0]}_{how}_d_{first}" for how in EXTREMES if has_slope]
        maps = sweep_both(mechanism, fl.table(design), asked, extrema=extrema, verify=0)
        for name in names:
            high, low, peak = (maps[f"{name}_{how}"].values for how in EXTREMES)
            np.testing.assert_array_equal(peak, np.maximum(high, -low), err_msg=name)
            high_at, low_at, place = (maps[f"{at}_at_{name}_{how}"].values for how in EXTREMES)
            apart = ~(high == -low)  # where both are as great, either place is one of the peak
            np.testing.assert_array_equal(place[apart], np.where(high > -low, high_at, low_at)[apart], name)
        if has_slope:
            high, low, _ = (maps[f"{names[0]}_{how}"].values for how in EXTREMES)
            slopes = [maps[f"d_{names[0]}_{how}_d_{first}"].values for how in EXTREMES]
            np.testing.assert_array_equal(slopes[2], np.where(high > -low, slopes[0], -slopes[1]))


def test_a_peak_has_an_error_bound_and_is_verified() -> None:
    names = ["alpha4_peak", "alpha4_peak_error", "alpha4_max_error", "alpha4_min_error", "theta4_peak"]
    space = fl.grid(a1=0.3, a2=np.linspace(0.6, 1.2, 7), a3=0.8, a4=1.0, omega1=2.0)
    maps = sweep_4r(space, names, verify=7)
    assert maps.alpha4_peak.attrs["long_name"].endswith("greatest magnitude over the cycle")
    assert maps.attrs["verify_mismatches"] == 0
    assert maps.alpha4_peak.attrs["independent_max_difference"] < 1e-30  # of 50 digits
    both = np.maximum(maps.alpha4_max_error, maps.alpha4_min_error)
    assert ((maps.alpha4_peak_error > 0.0) & (maps.alpha4_peak_error <= both)).all()
