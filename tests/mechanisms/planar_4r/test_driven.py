"""The planar 4R driven by any of its joints: the same configurations as driven at O, all six equations."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
from tests.support.configurations import DIGITS, LENGTHS, PLANAR, random_lengths

import fastlink as fl
from fastlink.facts.evaluate import read_facts
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING

JOINTS = (1, 2, 3, 4)
PAIRS = ("12", "13", "14", "23", "24", "34")
DRIVEN = {k: catalogue("planar_4r", f"joint_angle_{k}") for k in JOINTS}
# Facts are algebra: with 50 digits, and configurations whose amplification is below 1e6, they agree to 1e-40.
EXACT = mp.mpf(10) ** -40


def names_of(kind, but=()):
    return [f"{kind}{k}" for k in JOINTS if k not in but]


def others(k):
    """What is offered of the other three joints."""
    return [*names_of("joint_angle_", (k,)), *names_of("joint_omega_", (k,)), *names_of("joint_alpha_", (k,))]


def wrapped(angle):
    return angle - 2 * mp.pi * mp.nint(angle / (2 * mp.pi))


def configurations(n, seed):
    """Yield n configurations driven at O, with 50 digits, away from dead points of every joint."""
    rng = np.random.default_rng(seed)
    while n:
        lengths, t = random_lengths(rng, 1)[:, 0], rng.uniform(-np.pi, np.pi)
        given = {name: mp.mpf(float(x)) for name, x in zip(LENGTHS, lengths, strict=True)}
        given |= {"theta1": mp.mpf(float(t)), "omega1": mp.mpf(3), "branch": mp.mpf(1 + n % 2)}
        found = read_facts(PLANAR, [*names_of("joint_angle_"), *others(1)], given)
        if mp.isnan(found["sigma"]):
            continue
        found |= {"joint_omega_1": given["omega1"], "joint_alpha_1": mp.mpf(0)}
        if min(abs(mp.sin(found[name])) for name in names_of("joint_angle_")) > 0.01:
            n -= 1
            yield given, found


@pytest.fixture(autouse=True)
def _digits():
    with mp.workdps(DIGITS):
        yield


def solve(k, given, angle, rate, branch, names):
    lengths = {name: given[name] for name in LENGTHS}
    values = lengths | {f"joint_angle_{k}": angle, f"joint_omega_{k}": rate, "branch": mp.mpf(branch)}
    return read_facts(DRIVEN[k], names, values) | {f"joint_angle_{k}": angle, f"joint_omega_{k}": rate}


@pytest.mark.parametrize("k", JOINTS)
def test_a_configuration_is_one_of_the_two_of_each_joint(k):
    """Driven by joint k at the angle and the rate that it has, the other joints are where theta1 puts them."""
    far = f"joint_angle_{(k + 1) % 4 + 1}"
    for given, found in configurations(20, seed=k):
        angle, rate = found[f"joint_angle_{k}"], found[f"joint_omega_{k}"]
        branch = 1 if found[far] > 0 else 2
        same = solve(k, given, angle, rate, branch, others(k))
        other = solve(k, given, angle, rate, 3 - branch, [far])
        assert mp.sign(other[far]) == -mp.sign(same[far])
        for i in set(JOINTS) - {k}:
            assert abs(wrapped(same[f"joint_angle_{i}"] - found[f"joint_angle_{i}"])) < EXACT
            assert abs(same[f"joint_omega_{i}"] - found[f"joint_omega_{i}"]) < EXACT
            # At the constant rate of theta1 joint k accelerates: one more term of the chain rule.
            slope = same[f"joint_omega_{i}"] / rate
            bend = same[f"joint_alpha_{i}"] + slope * found[f"joint_alpha_{k}"]
            assert abs(bend - found[f"joint_alpha_{i}"]) < EXACT


def both_solutions(k, n, names):
    """Yield lengths and facts driven by joint k, in both branches, with the driven joint's own acceleration."""
    for given, found in configurations(n, seed=10 + k):
        for branch in (1, 2):
            rate = mp.mpf(2)
            solved = solve(k, given, found[f"joint_angle_{k}"], rate, branch, [*others(k), *names])
            yield given, solved | {f"joint_alpha_{k}": mp.mpf(0)}


@pytest.mark.parametrize("k", JOINTS)
def test_both_solutions_close_the_polygon_and_stay_closed(k):
    """The polygon of the convention, and its first and second derivative, from nothing but the joints."""
    for given, joints in both_solutions(k, 10, []):
        direction, spin, bend = mp.pi, mp.mpf(0), mp.mpf(0)
        position = velocity = acceleration = mp.mpc(0)
        for i in JOINTS:
            direction += joints[f"joint_angle_{i}"]
            spin += joints[f"joint_omega_{i}"]
            bend += joints[f"joint_alpha_{i}"]
            link = given[f"a{i}"] * mp.expj(direction)
            position += link
            velocity += 1j * spin * link
            acceleration += (1j * bend - spin**2) * link
        assert abs(position) < EXACT
        assert abs(velocity) < EXACT
        assert abs(acceleration) < EXACT
        assert abs(wrapped(direction - mp.pi)) < EXACT
        assert abs(spin) < EXACT
        assert abs(bend) < EXACT


@pytest.mark.parametrize("k", JOINTS)
def test_the_six_equations_and_their_derivatives_hold(k):
    """Equations (1) to (6), (7) and (8) of all pairs, with v'' = (theta'' + v theta'^2)(1 + v^2)/2."""
    for given, joints in both_solutions(k, 6, names_of("v")):
        a, b, c, d = (given[name] for name in LENGTHS)
        v = {str(i): joints[f"v{i}"] for i in JOINTS}
        dv, ddv = {}, {}
        for i in JOINTS:
            x, rate, bend = joints[f"v{i}"], joints[f"joint_omega_{i}"], joints[f"joint_alpha_{i}"]
            assert abs(x - mp.tan(joints[f"joint_angle_{i}"] / 2)) < EXACT * (1 + x**2)
            dv[str(i)] = rate * (1 + x**2) / 2
            ddv[str(i)] = (bend + x * rate**2) * (1 + x**2) / 2
        factors = {
            "A": (a - b + c - d, a + b + c - d),
            "B": (a + b - c - d, a - b - c - d),
            "C": (a - b - c + d, a + b - c + d),
            "D": (a + b + c + d, a - b + c + d),
        }
        for pair, (equation, cross) in {
            "12": ("A1B2 A2B1 C1D2 C2D1", -8 * b * d),
            "13": ("A1B1 A2B2 C2D2 C1D1", mp.mpf(0)),
            "14": ("A1A2 B1B2 C1C2 D1D2", -8 * a * c),
            "23": ("A1D2 B2C1 B1C2 A2D1", -8 * a * c),
            "24": ("A1C1 B2D2 A2C2 B1D1", mp.mpf(0)),
            "34": ("A1C2 B1D2 A2C1 B2D1", 8 * b * d),
        }.items():
            P, Q, R, S = (
                factors[t[0]][int(t[1]) - 1] * factors[t[2]][int(t[3]) - 1] for t in equation.split()
            )
            i, j = pair
            x, y, dx, dy, ddx, ddy = v[i], v[j], dv[i], dv[j], ddv[i], ddv[j]
            slope_x, slope_y = 2 * (P * y**2 + Q) * x + cross * y, 2 * (P * x**2 + R) * y + cross * x
            small = EXACT * (1 + x**2) ** 2 * (1 + y**2) ** 2
            assert abs(P * x**2 * y**2 + Q * x**2 + R * y**2 + cross * x * y + S) < small
            assert abs(slope_x * dx + slope_y * dy) < small
            second = 2 * (P * y**2 + Q) * dx**2 + 2 * (P * x**2 + R) * dy**2
            second += 2 * (4 * P * x * y + cross) * dx * dy
            assert abs(slope_x * ddx + slope_y * ddy + second) < small


@pytest.mark.parametrize("k", JOINTS)
def test_derivatives_by_the_driven_joint_are_its_rates(k):
    by, rate = f"joint_angle_{k}", mp.mpf(2)
    angles, omegas = (names_of(kind, (k,)) for kind in ("joint_angle_", "joint_omega_"))
    slopes = [f"d_{name}_d_{by}" for name in (*angles, *omegas)]
    for given, found in configurations(4, seed=20 + k):
        at = solve(k, given, found[by], rate, 2, [*others(k), *slopes, f"d_{angles[0]}_d_a1"])
        for angle, omega in zip(angles, omegas, strict=True):
            assert abs(at[f"d_{angle}_d_{by}"] * rate - at[omega]) < EXACT
            assert abs(at[f"d_{omega}_d_{by}"] * rate - at[omega.replace("omega", "alpha")]) < EXACT
        step = mp.mpf(10) ** -20
        moved = solve(k, given | {"a1": given["a1"] + step}, found[by], rate, 2, angles)
        # A difference of first order: off by the step times a second derivative below 1e6.
        assert abs((moved[angles[0]] - at[angles[0]]) / step - at[f"d_{angles[0]}_d_a1"]) < 1e-13


@pytest.mark.parametrize("k", JOINTS)
def test_status_tells_whether_the_driven_joint_turns(k):
    rng = np.random.default_rng(50 + k)
    lengths = random_lengths(rng, 400)
    a, b, c, d = lengths
    gaps = np.abs([a - b + c - d, a + b - c - d, a - b - c + d, a + b + c - d, a - b - c - d, a + b - c + d])
    # The forbidden range of the angle is wider than a step where no gap of the lengths is small.
    lengths = lengths[:, gaps.min(axis=0) > 0.05]
    inputs = {name: values[:, None] for name, values in zip(LENGTHS, lengths, strict=True)}
    angles = {f"joint_angle_{k}": np.linspace(-np.pi, np.pi, 360)}
    names = ["transmission_angle", "status", "grashof_class"]
    driven = fl.evaluate("planar_4r", names, input=f"joint_angle_{k}", **inputs, **angles)
    closes = np.isfinite(driven["transmission_angle"])
    codes = {meaning: code for code, meaning in DRIVEN[k].facts["status"].flags.items()}
    status = driven["status"][:, 0]
    np.testing.assert_array_equal(status == codes["rotates_fully"], closes.all(axis=1))
    np.testing.assert_array_equal(status == codes["never_assembles"], ~closes.any(axis=1))
    assert set(status) == {
        codes[f] for f in ("rotates_fully", "never_assembles", "assembles_over_part_of_the_turn")
    }
    # What belongs to the linkage does not depend on what drives.
    at_o = fl.evaluate("planar_4r", ["grashof_class"], theta1=0.0, **inputs)
    np.testing.assert_array_equal(driven["grashof_class"][:, :1], at_o["grashof_class"])


def test_joint_1_is_theta1_less_pi():
    theta = np.array([0.3, 1.7, 4.0])
    lengths = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0}
    names = ["joint_angle_4", "joint_omega_4", "joint_alpha_4"]
    at_o = fl.evaluate("planar_4r", names, **lengths, omega1=25.0, theta1=theta)
    driven = fl.evaluate(
        "planar_4r", names, input="joint_angle_1", **lengths, joint_omega_1=25.0, joint_angle_1=theta - np.pi
    )
    for name in names:
        # theta1 - pi is right to 2^-52; by it the acceleration changes by at most 25^2 * 60 here.
        np.testing.assert_allclose(driven[name], at_o[name], rtol=1e-14, atol=25**2 * 60 * 2 * UNIT_ROUNDING)


@pytest.mark.parametrize("k", JOINTS)
def test_the_half_tangent_of_the_driven_joint_is_that_of_its_angle(k):
    """tan(0) = 0 exactly: once it was infinite there, as at half a turn, where the sine is 0, too."""
    angles = np.array([0.0, -0.0, 1e-8, 1.0, np.pi])
    lengths = dict.fromkeys(("a1", "a2", "a3", "a4"), 1.0)
    found = fl.evaluate(
        "planar_4r", [f"v{k}"], input=f"joint_angle_{k}", **lengths, **{f"joint_angle_{k}": angles}
    )
    # -C/(sin/2) with C and sin right to a rounding each, and the division
    np.testing.assert_allclose(found[f"v{k}"], np.tan(0.5 * angles), rtol=8 * UNIT_ROUNDING, atol=0.0)
