"""Reductions over the cycle run over the positions at which the linkage can be assembled.

The crank pin has a place at every crank angle, also where the other links do not reach: that is no part of the motion.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import fastlink as fl

LINKS = {"a1": 1.0, "a2": 0.6, "a3": 0.7, "a4": 1.2}  # no link turns fully
ALL = np.linspace(0.0, 2.0 * np.pi, 97)[:-1]


def between(distance: float, one: float, other: float) -> bool:
    """Tell whether two links reach over a distance: the triangle exists."""
    return abs(one - other) <= distance <= one + other


@dataclass(frozen=True)
class Case:
    """A mechanism and input, a quantity that the driven link alone determines, and where the loop closes."""

    mechanism: str
    input: str
    design: dict[str, float]
    name: str
    quantity: Callable[[float], float]
    closes: Callable[[float], bool]
    positions: Any = None

    def sweep(self, names: list[str], **options: Any) -> Any:
        space = fl.grid(**self.design)
        return fl.sweep(self.mechanism, space, names, input=self.input, branch=1, verify=0, **options)


def reaches(crank: float, ground: float, one: float, other: float) -> Callable[[float], bool]:
    """Return whether two links reach from the end of a crank to the far pivot, by its angle."""

    def closes(angle: float) -> bool:
        end = crank * math.cos(angle), crank * math.sin(angle)
        return between(math.dist(end, (ground, 0.0)), abs(one), abs(other))

    return closes


def _by_joint_four(angle: float) -> bool:
    # the exterior angle at D: |OB|^2 = a3^2 + a4^2 + 2 a3 a4 cos
    a1, a2, a3, a4 = LINKS.values()
    return between(math.sqrt(a3 * a3 + a4 * a4 + 2.0 * a3 * a4 * math.cos(angle)), a1, a2)


def _minkowskian(theta: float) -> bool:
    # two spacelike bars reach over AC where (AC)^2 >= (b + h)^2, or <= (b - h)^2 with the other orientation
    return not 0.25 < 4.0 + 16.0 - 16.0 * math.cosh(theta) < 6.25


HART = {"m": 1.0, "n": 0.7, "d": 1.2, "kappa": 0.5}
FOUR_BAR = {name: float(value) for name, value in fl.evaluate("hart", ["a", "b", "c"], **HART).items()}
FOCAL = {"a": 1.0, "b": 0.7, "c": 0.6, "d": 1.2, "rho": 1.0, "completion": 1}
MINKOWSKI = {"a": 2.0, "b": 1.0, "g": 4.0, "h": 1.5}
SLIDER = {"r": 1.0, "l": 0.6, "e": 0.1}
CASES = [
    Case("planar_4r", "theta1", LINKS, "A_x", math.cos, reaches(1.0, 1.2, 0.6, 0.7)),
    Case("planar_4r", "joint_angle_4", LINKS, "v4", lambda angle: math.tan(angle / 2.0), _by_joint_four),
    Case("slider_crank", "theta", SLIDER, "A_y", math.sin, lambda angle: abs(math.sin(angle) - 0.1) <= 0.6),
    Case("focal", "phi", FOCAL, "A_x", math.cos, reaches(1.0, 1.2, 0.6, 0.7)),
    Case("hart", "phi", HART, "P_y", math.sin, reaches(FOUR_BAR["a"], 1.2, FOUR_BAR["b"], FOUR_BAR["c"])),
    Case(
        *("minkowski_4r", "theta", MINKOWSKI, "A_x", lambda theta: 2.0 * math.cosh(theta), _minkowskian),
        positions=np.linspace(-1.5, 1.5, 60),
    ),
]
REDUCED = {
    "mean": lambda values: values.mean(),
    "rms": lambda values: math.sqrt((values * values).mean()),
    "max": lambda values: values.max(),
    "min": lambda values: values.min(),
}


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.mechanism}-{case.input}")
def test_reductions_run_over_positions_that_assemble(case: Case) -> None:
    positions = ALL if case.positions is None else case.positions
    counted = [place for place in positions if case.closes(place)]
    assert 0 < len(counted) < len(positions)
    values = np.array([case.quantity(place) for place in counted])
    names = [f"{case.name}_{how}" for how in REDUCED] + [f"{case.input}_at_{case.name}_max"]
    maps = case.sweep([case.name, *names], **{case.input: positions})
    assert np.isfinite(maps[case.name]).all()  # a place of its own at every position
    for how, reduce in REDUCED.items():
        # sums of fewer than 100 terms, each right to 2 roundings
        expected, size = reduce(values), abs(values).max()
        assert abs(float(maps[f"{case.name}_{how}"].item()) - expected) < 100 * 2.0**-52 * size
    assert float(maps[names[-1]].item()) in np.array(counted)[values == values.max()] or math.isclose(
        case.quantity(float(maps[names[-1]].item())), values.max(), rel_tol=1e-15
    )


def test_a_mean_over_the_motion_is_an_integral() -> None:
    limit = math.acos((1.0 + 1.44 - 1.69) / 2.4)  # |AD| = a2 + a3
    maps = CASES[0].sweep(["A_x_mean", "A_x_rms", "A_x_max", "A_x_min", "A_x_fluctuation"], theta1=20_000)
    # equal steps leave an error of the share of one step of the motion, times the range of cosines
    step = 2.0 * math.pi / 20_000 / (2.0 * limit)
    assert abs(float(maps.A_x_mean.item()) - math.sin(limit) / limit) < 2.0 * step
    square = 0.5 + math.sin(2.0 * limit) / (4.0 * limit)
    assert abs(float(maps.A_x_rms.item()) - math.sqrt(square)) < 2.0 * step
    assert float(maps.A_x_min.item()) <= float(maps.A_x_mean.item()) <= float(maps.A_x_max.item())
    assert np.isnan(maps.A_x_fluctuation.item())  # which needs a whole turn


def test_what_never_assembles_has_no_mean() -> None:
    names = ["A_x_mean", "A_x_rms", "A_x_max", "status"]
    maps = fl.sweep("planar_4r", fl.grid(a1=1.0, a2=0.1, a3=0.2, a4=5.0), names, theta1=36, verify=0)
    assert all(np.isnan(maps[name]).all() for name in names[:3])


def test_derivatives_of_means_count_the_same_positions() -> None:
    names = ["A_x_mean", "d_A_x_mean_d_a1", "A_x_mean_gradient_status"]
    given = CASES[0].sweep(names, theta1=ALL)
    # A_x is a1 cos(theta1): the derivative of the mean of samples is that mean over a1, of 1
    assert math.isclose(float(given.d_A_x_mean_d_a1.item()), float(given.A_x_mean.item()), rel_tol=1e-14)
    assert int(given.A_x_mean_gradient_status.item()) == 7  # of the sampled positions that assemble
    turn = CASES[0].sweep(names, theta1=96)
    assert np.isnan(turn.d_A_x_mean_d_a1.item())  # the limits of the integral move
    assert int(turn.A_x_mean_gradient_status.item()) == 10


def test_the_verification_counts_the_same_positions(tmp_path: Any) -> None:
    names = ["A_x_mean", "A_y_rms", "G1_x_max", "v1_dot_min", "A_x_min"]
    space = fl.grid(a1=np.linspace(0.5, 1.5, 8), a2=0.6, a3=0.7, a4=1.2, G1_u=0.3, G1_v=0.1, omega1=2.0)
    maps = fl.sweep("planar_4r", space, names, theta1=60, extrema="sampled", to=tmp_path / "map.h5", verify=8)
    assert all(maps[name].attrs["verify_mismatches"] == 0 for name in names)
    assert all(maps[name].attrs["error_max_relative"] < 1e-14 for name in names)
