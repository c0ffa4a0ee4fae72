"""Extremes of the slider-crank: against fine searches, 50 digits, polynomials, and its dead centres."""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.slider_crank_configurations import MASSES, PUMP, lengths

import fastlink as fl
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING

KINEMATIC = ("slider_position", "slider_velocity", "slider_acceleration", "theta2", "omega2", "alpha2")
FORCES = ("T41", "side_force", "shaking_force", "F32")
TURN = 2.0 * np.pi


def swept(names, designs, **options):
    return fl.sweep("slider_crank", fl.table(designs), names, threads=1, **options)


def extremes(names):
    return [f"{name}_{end}" for name in names for end in ("max", "min")]


def dense(names, one, branch, angles=20001):
    """Return the values over a fine turn by name."""
    theta = np.linspace(0.0, TURN, angles)
    return fl.evaluate("slider_crank", names, **one, theta=theta, branch=branch)


def zoomed(name, one, branch, theta, width):
    """Return the greatest value near the first angle and the least near the second, by ever finer samples."""
    signs = np.array([[1.0], [-1.0]])
    for _ in range(5):
        near = np.reshape(theta, (2, 1)) + np.linspace(-width, width, 201)
        values = signs * fl.evaluate("slider_crank", [name], **one, theta=near, branch=branch)[name]
        theta, width = near[[0, 1], np.argmax(values, axis=1)], width / 50
    return (signs[:, 0] * np.max(values, axis=1)).tolist()


def designs_of(kind, n, seed=3):
    drawn = dict(zip("rle", lengths(kind, np.random.default_rng(seed), n), strict=True))
    return drawn | {"omega": np.full(n, 1.5)} | {name: np.full(n, value) for name, value in MASSES.items()}


@pytest.mark.parametrize("count", [1, pytest.param(5, marks=pytest.mark.stress)])
@pytest.mark.parametrize("kind", ["random", "gap 1e-4", "stiff 1e3", "inline"])
def test_extremes_of_a_full_turn_are_those_of_a_fine_search(kind, count):
    designs = designs_of(kind, 40)
    names = [*KINEMATIC, *FORCES]
    ends = extremes(names)
    found = swept(["status", *ends, *(f"theta_at_{end}" for end in ends)], designs)
    tested = 0
    for i in np.flatnonzero(found.status.values == 0)[:count]:
        one = {name: float(values[i]) for name, values in designs.items()}
        for k, branch in enumerate((1, 2)):
            curves = dense(names, one, branch)
            for name, values in curves.items():
                if name == "theta2" and branch == 2:  # which passes pi
                    continue
                places = [float(found[f"theta_at_{name}_{end}"].values[i, k]) for end in ("max", "min")]
                outermost = zoomed(name, one, branch, places, 1e-6)
                size = np.max(abs(values))
                for end, pick, sign, near in zip(
                    ("max", "min"), (np.max, np.min), (1.0, -1.0), outermost, strict=True
                ):
                    here, where = float(found[f"{name}_{end}"].values[i, k]), (name, end, one, branch)
                    # No sample is beyond the extreme, and it is one, but by roundings of the samples.
                    assert sign * (here - pick(values)) >= -64 * UNIT_ROUNDING * size, where
                    assert abs(here - near) <= 64 * UNIT_ROUNDING * size, where
                    tested += 1
    assert tested > 30 * count


def test_the_extremes_of_the_position_are_the_dead_centres():
    designs = designs_of("random", 300)
    ends = extremes(["slider_position"])
    places = [f"theta_at_{name}" for name in ends]
    facts = ["theta_outer", "theta_inner", "stroke", "outer_dead_centre", "inner_dead_centre"]
    found = swept([*ends, *places, *facts, "grashof_class"], designs)
    turns = found.grashof_class.values == 0
    assert np.count_nonzero(turns) > 30
    of = {name: found[name].values[turns] for name in (*ends, *places, *facts)}
    greatest, least = of["slider_position_max"], of["slider_position_min"]
    size = 16 * UNIT_ROUNDING * of["outer_dead_centre"]
    for one, other in (
        (greatest[:, 0], of["outer_dead_centre"]),
        (least[:, 0], of["inner_dead_centre"]),
        (greatest[:, 1], -of["inner_dead_centre"]),
        (least[:, 1], -of["outer_dead_centre"]),
        (greatest[:, 0] - least[:, 0], of["stroke"]),
    ):
        assert np.all(abs(one - other) <= size)
    # Two units in the last place of the place in the range, whose angle is its arctangent, and roundings of pi.
    for name, angle in (
        ("slider_position_max", [of["theta_outer"], np.pi - of["theta_inner"]]),
        ("slider_position_min", [of["theta_inner"], np.pi - of["theta_outer"]]),
    ):
        off = of[f"theta_at_{name}"] - np.transpose(angle)
        assert np.all(abs(off - TURN * np.rint(off / TURN)) < 1e-13)


def test_rates_of_the_rod_have_one_maximum_and_one_minimum_where_the_polynomial_says():
    """omega2' = 0 is (l^2 - r^2 - e^2) s + e r (1 + s^2) = 0 in s = sin(theta): two angles of a turning crank."""
    designs = designs_of("random", 400)
    found = swept(["omega2_extrema", "grashof_class"], designs)
    tested = 0
    for i in np.flatnonzero(found.grashof_class.values == 0):
        r, l, e = (designs[name][i] for name in "rle")
        np.testing.assert_array_equal(found.omega2_extrema_count.values[i], 2)
        roots = np.roots([e * r, l * l - r * r - e * e, e * r]) if e else np.array([0.0])
        (sine,) = roots[abs(roots) < 1.0]
        for k in range(2):
            places = found.theta_at_omega2_extrema.values[i, k]
            assert sorted(np.sign(found.omega2_extrema_kind.values[i, k])) == [-1, 1]
            # a root of a quadratic equation of coefficients right to a rounding
            np.testing.assert_allclose(np.sin(places), sine, rtol=1e-10, atol=1e-13)
            np.testing.assert_allclose(np.sum(np.cos(places)), 0.0, atol=1e-10)
            tested += 1
    assert tested > 60


def test_beyond_a_toggle_rates_grow_without_bound():
    designs = {"r": [2.0], "l": [1.0], "e": [0.25], "omega": [1.0]}
    found = swept(["slider_velocity_max", "slider_position_max", "omega2_max", "omega2_min"], designs)
    assert np.all(found.slider_velocity_max.values == np.inf)
    assert np.all(found.omega2_max.values == np.inf)
    assert np.all(found.omega2_min.values == -np.inf)
    assert np.all(np.isfinite(found.slider_position_max))


def test_where_the_rod_passes_pi_its_direction_reaches_both():
    one = {name: [PUMP[name]] for name in ("r", "l", "e")}
    found = swept(["theta2_max", "theta2_min"], one)
    np.testing.assert_array_equal(found.theta2_max.values[0, 1], np.pi)
    np.testing.assert_array_equal(found.theta2_min.values[0, 1], -np.pi)
    # sin(theta2) = (e - r sin(theta))/l is extreme where the crank is square to the line
    r, l, e = (PUMP[name] for name in "rle")
    np.testing.assert_allclose(found.theta2_max.values[0, 0], np.arcsin((e + r) / l), rtol=8 * UNIT_ROUNDING)
    np.testing.assert_allclose(found.theta2_min.values[0, 0], np.arcsin((e - r) / l), rtol=16 * UNIT_ROUNDING)


@pytest.mark.parametrize("kind", [pytest.param("inline", marks=pytest.mark.stress), "gap 1e-4", "stiff 1e3"])
def test_all_is_verified_with_50_digits(kind, folder):
    designs = designs_of(kind, 60)
    turning = designs["l"] > designs["r"] + abs(designs["e"])
    designs = {name: values[turning][:8] for name, values in designs.items()}
    names = [*extremes(["slider_velocity", "T41", "shaking_force"]), "alpha2", "stroke", "T41_mean"]
    swept([*names, "slider_acceleration_extrema"], designs, theta=12, verify=6, to="maps.h5")
    with fl.open("maps.h5") as maps:
        assert maps.attrs["verify_mismatches"] == 0
        assert "verify_failed" not in maps.attrs
        for name in (*names, "slider_acceleration_extrema"):
            # As tests/precision has it for the planar 4R.
            assert maps[name].attrs["error_max_roundings"] <= 16, name


def test_mirrored_searches_are_those_of_each_branch():
    """What the mirror theta to pi - theta says of the other branch is what a search of that branch says."""
    designs = designs_of("random", 50)
    names = [*extremes(["slider_velocity", "slider_acceleration"]), "theta_at_slider_acceleration_max"]
    both = swept(names, designs)
    for k, branch in enumerate((1, 2)):
        alone = swept(names, designs, branch=branch)
        for name in names:
            one, other = both[name].values[:, k], alone[name].values
            np.testing.assert_allclose(one, other, rtol=1e-13, atol=1e-13, err_msg=name)
    assert catalogue("slider_crank").graded.axis == np.pi / 2
