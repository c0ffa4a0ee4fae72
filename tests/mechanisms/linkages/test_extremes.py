"""Extremes of declared linkages, which are searched in the pieces of the turn in which all dyads close."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.mechanisms.linkages.declared import FOUR_BAR, SIX_BAR, TURNING, four_bars, six_bars

import fastlink as fl
from fastlink.codegen.kernel import llvm_text
from fastlink.engine.resolve import resolve

#: Quantities of the planar 4R, and what the declared one calls them.
SHARED = {
    "theta4": "angle_DB",
    "omega2": "omega_AB",
    "alpha4": "alpha_DB",
    "P_x": "P_x",
    "P_speed": "P_speed",
    "transmission_angle": "transmission_angle_B",
}


def compare(designs: dict[str, Any], shared: dict[str, str]) -> None:
    """Compare extremes with those of the planar 4R, which is exact next to change points."""
    names = [f"{name}_{how}{of}" for name in shared for how in ("max", "min") for of in ("", "_error")]
    own = [name.replace(of, shared[of], 1) for of in shared for name in names if name.startswith(f"{of}_m")]
    known = fl.sweep("planar_4r", designs | {"omega1": 10.0}, names, branch=(1, 2))
    found = fl.sweep(FOUR_BAR, designs | {"omega": 10.0}, own, branch=(1, 2))
    for name, other in zip(names[::2], own[::2], strict=True):
        a, b = known[name].values, found[other].values
        # each is within its own bound of the exact one
        bound = known[f"{name}_error"].values + found[f"{other}_error"].values
        with np.errstate(invalid="ignore"):
            agree = (a == b) | (np.isnan(a) & np.isnan(b)) | (abs(a - b) <= bound)
        assert agree.all(), (name, np.argwhere(~agree)[:3], a[~agree][:3], b[~agree][:3])
    # where the planar 4R counts a gap as zero, the declared one sees which side it is on, if its bounds are finite
    decided = np.isfinite(found[own[1]].values).all(axis=1) & ~np.isin(known.status.values, (2, 3, 5))
    assert (found.status.values[decided] == known.status.values[decided, None]).all()


def test_a_declared_four_bar_has_the_extremes_of_the_planar_4r() -> None:
    compare(four_bars(600, seed=1), {"theta4": "angle_DB", "P_x": "P_x"})


@pytest.mark.stress
@pytest.mark.parametrize("seed", range(5))
def test_all_shared_quantities_of_many_four_bars(seed: int) -> None:
    compare(four_bars(20_000, seed=seed), SHARED)


def check_against_samples(
    count: int, seed: int, names: tuple[str, ...], arc: tuple[float, float] | None
) -> None:
    """Check that no sample is beyond an extreme, and that there are none where nothing closes."""
    designs, (low, high) = six_bars(count, seed), arc or (0.0, 2.0 * np.pi)
    ends = {} if arc is None else {"arc_start": low, "arc_end": high}
    wanted = [f"{name}_{how}" for name in names for how in ("max", "min")]
    maps = fl.sweep(SIX_BAR, designs | ends | {"omega": 10.0}, wanted, branch=(1, 2, 3, 4))
    positions = np.linspace(low, high, 2001)
    given = {name: of[:, None, None] for name, of in designs.items()}
    branches = np.arange(1, 5)[:, None]
    with np.errstate(all="ignore"):
        values = fl.evaluate(
            SIX_BAR, list({*names, "F_x"}), branch=branches, theta=positions, omega=10.0, **given
        )
    closes = np.isfinite(values["F_x"])
    for name in names:
        inside = np.where(closes, values[name], np.nan)
        most, least = (maps[f"{name}_{how}"].values for how in ("max", "min"))
        # rounding of the samples, some of which are next to limits, and of an arc's end
        slack = 1e-9 * (1.0 + sum(np.where(np.isfinite(of), abs(of), 0.0) for of in (most, least)))
        with np.errstate(invalid="ignore"):
            assert not (inside > (most + slack)[..., None]).any(), name
            assert not (inside < (least - slack)[..., None]).any(), name
            turning = closes.all(axis=-1)
            span = most - least
            # of a place a sample is within 1e-2 of what it spans of an extreme; rates have sharper peaks
            near = abs(np.max(values[name], axis=-1) - most) <= 1e-2 * span
        assert near[turning & np.isfinite(span)].all() or not name.endswith(("_x", "_y")), name
        assert np.isnan(most).sum() <= (~closes.any(axis=-1)).sum()


def test_no_sample_of_a_six_bar_is_beyond_its_extremes() -> None:
    check_against_samples(60, 2, ("F_x", "B_y", "omega_GF"), None)
    check_against_samples(60, 3, ("F_y",), (0.5, 2.5))


@pytest.mark.stress
@pytest.mark.parametrize("seed", range(10, 20))
def test_no_sample_of_many_six_bars(seed: int) -> None:
    names = ("F_x", "F_y", "angle_GF", "transmission_angle_F", "omega_GF", "F_speed", "alpha_PF")
    check_against_samples(1000, seed, names, None if seed % 2 else (1.0, 5.0))


def test_ranges_and_what_limits_them_are_verified(tmp_path: Any) -> None:
    names = [
        "theta_low",
        "theta_high",
        "theta_low_by",
        "theta_high_by",
        "F_x_max",
        "F_x_extrema",
        "omega_GF_min",
    ]
    maps = fl.sweep(
        SIX_BAR,
        six_bars(40, 4) | {"omega": 3.0},
        names,
        branch=(1, 2, 3, 4),
        to=tmp_path / "maps.h5",
        progress=False,
    )
    assert maps.attrs["verify_mismatches"] == 0
    assert maps.theta_low.error_max_relative < 1e-12
    assert maps.F_x_max.independent_max_difference < 1e-40
    assert {*np.unique(maps.theta_low_by)} == {0, 1, 2}


def test_kernels_need_no_other_compiler() -> None:
    # numba, which compiles what the translator refuses, takes half a minute for one
    wanted = ["F_x_max", "d_F_x_max_d_a1", "F_x_max_error", "F_x_extrema", "theta_low", "theta_low_by"]
    for kernel in resolve(SIX_BAR, TURNING | {"omega": 1.0}, wanted, branch=3).kernels:
        assert llvm_text(kernel.source)


def test_gradients_of_extremes_and_their_status_at_limits() -> None:
    number = fl.function(SIX_BAR, ["a1", "a5"], ["F_x_max"], branch=3, omega=1.0, **_without("a1", "a5"))
    start, step = np.array([0.1, 0.3]), 1e-6
    slope = [(number(start + step * e) - number(start - step * e))[0] / (2 * step) for e in np.eye(2)]
    # differences are off by the square of their step, and by a rounding over it
    assert np.allclose(number.gradient(start)[0], slope, rtol=0, atol=1e-8)
    maps = fl.sweep(FOUR_BAR, {"a1": 0.5, "a2": 0.4, "a3": 0.35, "a4": 0.6}, ["B_y_max", "d_B_y_max_d_a2"])
    assert int(maps.status) == 1
    assert np.isfinite(maps.B_y_max)


def _without(*names: str) -> dict[str, float]:
    return {name: value for name, value in TURNING.items() if name not in names}
