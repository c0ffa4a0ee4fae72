"""Position and rates of the slider-crank against circle and line, textbooks, exact numbers, and the planar 4R."""

from __future__ import annotations

from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.support.slider_crank_configurations import PUMP, positions
from tests.support.slider_crank_oracle import DERIVED, DIGITS, Mechanism, facts

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING

RATES = ("slider_velocity", "slider_acceleration", "slider_jerk")
ROD_RATES = ("omega2", "alpha2", "jerk2")


def at(names, **given):
    return fl.evaluate("slider_crank", names, **given)


@pytest.mark.sample(3)
@pytest.mark.parametrize(
    "kind", ["random", "gap 1e-4", "toggle 1e-3", "stiff 1e3", "short 1e-1", "aligned 1e-3"]
)
@pytest.mark.parametrize("branch", [1, 2])
def test_position_and_rates_are_those_of_circle_and_line(kind, branch):
    drawn, tested = positions(kind, np.random.default_rng(1), 12), 0
    for values in zip(*drawn.values(), strict=True):
        one = dict(zip(drawn, map(float, values), strict=True)) | {"omega": 3.0}
        found = facts(["sigma", "slider_position", "theta2", *RATES, *ROD_RATES], one | {"branch": branch})
        if mp.isnan(found["sigma"]):
            continue
        with mp.workdps(DIGITS):
            other = Mechanism(one, branch)
            near = mp.mpf("1e-45") * (one["r"] + one["l"])  # 50 digits, some lost by the quadratic equation
            assert abs(found["slider_position"] - other.slider(one["theta"])) < near
            assert abs(found["theta2"] - other.rod(one["theta"])) < mp.mpf("1e-40")
            for order, (of_slider, of_rod) in enumerate(zip(RATES, ROD_RATES, strict=True), 1):
                for name, curve in ((of_slider, other.slider), (of_rod, other.rod)):
                    true = other.by_time(curve, one["theta"], order)
                    size = abs(true) + other.given["omega"] ** order
                    assert abs(found[name] - true) < DERIVED * size, (name, one)
        tested += 1
    assert tested > 4


def test_the_series_of_textbooks_for_no_offset():
    """x = l + r cos(theta) - r (lambda/2 sin^2 + lambda^3/8 sin^4 + lambda^5/16 sin^6) - ..., lambda = r/l."""
    r, l, theta = 0.03, 1.0, np.linspace(-3.0, 3.0, 25)
    ratio, s2 = r / l, np.sin(theta) ** 2
    found = at(["slider_position", "slider_acceleration"], r=r, l=l, e=0.0, omega=2.0, theta=theta, branch=1)
    series = l + r * np.cos(theta) - r * (ratio / 2 * s2 + ratio**3 / 8 * s2**2 + ratio**5 / 16 * s2**3)
    # What is left out is below 5/128 lambda^7 r/(1 - lambda^2), 3e-14; both sides take a few roundings of l.
    np.testing.assert_allclose(
        found["slider_position"], series, rtol=0, atol=0.05 * ratio**7 * r + 4 * UNIT_ROUNDING * l
    )
    A2, A4, A6 = (
        ratio + ratio**3 / 4 + 15 * ratio**5 / 128,
        ratio**3 / 4 + 3 * ratio**5 / 16,
        9 * ratio**5 / 128,
    )
    harmonics = np.cos(theta) + A2 * np.cos(2 * theta) - A4 * np.cos(4 * theta) + A6 * np.cos(6 * theta)
    # The second derivative of what is left out: at most 64 times as much.
    np.testing.assert_allclose(
        found["slider_acceleration"],
        -r * 4.0 * harmonics,
        rtol=0,
        atol=4 * r * (3 * ratio**7 + 16 * UNIT_ROUNDING),
    )


#: r, l, e and the rod along the line at theta = 0: w^2 = l^2 - e^2.
PYTHAGORAS = [(3, 13, 5, 12), (3, 13, -5, 12), (2, 5, 3, 4), (7, 25, 7, 24), (1, 17, -8, 15), (4, 5, 0, 5)]


@pytest.mark.parametrize(("r", "l", "e", "w"), PYTHAGORAS)
@pytest.mark.parametrize("branch", [1, 2])
def test_rational_configurations_are_exact(r, l, e, w, branch):
    """At theta = 0 all is rational: u = -e, u' = r, u'' = 0, u''' = -r, and w = sqrt(l^2 - u^2)."""
    s = 1 if branch == 1 else -1
    u, u1 = Fraction(-e), Fraction(r)
    w1 = -u * u1 / w
    w2 = -(u1 * u1 + w1 * w1) / w
    w3 = -(u * -r + 3 * w1 * w2) / w
    true = {
        "slider_position": r + s * w,
        "slider_velocity": s * w1,
        "slider_acceleration": -r + s * w2,
        "slider_jerk": s * w3,
        "omega2": Fraction(-s * r, w),
    }
    found = at(list(true), r=float(r), l=float(l), e=float(e), omega=1.0, theta=0.0, branch=branch)
    for name, value in true.items():
        # A dozen operations on numbers of at most 50, the terms of a sum within a factor 25 of each other.
        assert abs(Fraction(float(found[name])) - value) <= 16 * UNIT_ROUNDING * max(abs(value), r), name


def test_the_transmission_angle_is_between_the_rod_and_the_normal():
    theta = np.linspace(-3.0, 3.0, 13)
    found = at(["transmission_angle", "theta2"], **PUMP, theta=theta, branch=1)
    cosine = (PUMP["r"] * np.sin(theta) - PUMP["e"]) / PUMP["l"]
    np.testing.assert_allclose(np.cos(found["transmission_angle"]), cosine, rtol=0, atol=8 * UNIT_ROUNDING)
    # BA = -AB is theta2 + pi; the normal is pi/2.
    np.testing.assert_allclose(
        found["transmission_angle"], found["theta2"] + np.pi / 2, rtol=0, atol=8 * UNIT_ROUNDING * np.pi
    )


LENGTHS = st.floats(0.2, 2.0)


@settings(max_examples=60, deadline=None)
@given(LENGTHS, LENGTHS, st.floats(0.01, 1.5), st.floats(-3.1, 3.1), st.sampled_from([1, 2]))
def test_the_mirror_image_at_the_line_through_O_has_the_same_bits(r, l, e, theta, branch):
    """theta to -theta and e to -e: every operation has its mirror image."""
    names = ["slider_position", "theta2", "A_y", *RATES, *ROD_RATES]
    with np.errstate(all="ignore"):
        one = at(names, r=r, l=l, e=e, omega=1.3, theta=theta, branch=branch)
        other = at(names, r=r, l=l, e=-e, omega=-1.3, theta=-theta, branch=branch)
    for name in names:
        across = name in ("theta2", "A_y", *ROD_RATES)
        np.testing.assert_array_equal(other[name], -one[name] if across else one[name], err_msg=name)


@settings(max_examples=40, deadline=None)
@given(LENGTHS, LENGTHS, st.floats(-1.0, 1.0), st.floats(-3.1, 3.1), st.integers(-79, 79))
def test_rates_grow_with_powers_of_the_speed(r, l, e, theta, power):
    names, powers = [*RATES, *ROD_RATES], [1, 2, 3, 1, 2, 3]
    with np.errstate(all="ignore"):
        one = at(names, r=r, l=l, e=e, omega=0.75, theta=theta, branch=1)
        fast = at(names, r=r, l=l, e=e, omega=0.75 * 2.0**power, theta=theta, branch=1)
    for name, order in zip(names, powers, strict=True):
        if np.isfinite(one[name]) and 1e-20 < abs(one[name]) < 1e20:
            assert fast[name] == np.ldexp(one[name], power * order), name


def test_a_planar_4r_with_ground_and_output_link_ever_longer():
    """D goes to infinity across the line: what is left of the difference halves when the lengths double."""
    theta = np.array([-2.0, -0.7, 0.4, 1.2, 2.6])
    r, l, e = 0.25, 1.0, 0.125
    names = ["theta2", "omega2", "alpha2", "jerk2", "transmission_angle"]
    for branch in (1, 2):
        here = at(names, r=r, l=l, e=e, omega=2.0, theta=theta, branch=branch)
        left = []
        for far in (2.0**10, 2.0**11):
            there = fl.evaluate(
                "planar_4r",
                names,
                a1=r,
                a2=l,
                a3=far,
                a4=far + e,
                omega1=2.0,
                theta1=theta - np.pi / 2,
                branch=branch,
            )
            there["theta2"] = there["theta2"] + np.pi / 2
            turns = {name: 2 * np.pi if name == "theta2" else np.inf for name in names}
            left.append({name: _remainder(there[name] - here[name], turns[name]) for name in names})
        for name in names:
            # (l + r)^2/(2 far) is how far B is off the line; the next term is as much smaller again, and (e/far).
            np.testing.assert_allclose(left[0][name], 2.0 * left[1][name], rtol=0.01, atol=1e-9, err_msg=name)
            assert 0.0 < np.max(abs(left[0][name])) < 0.05


def _remainder(x, period):
    return x if period == np.inf else x - period * np.rint(x / period)


def test_exactly_at_a_toggle_rates_are_infinite_and_beyond_it_nothing_is():
    with np.errstate(all="ignore"):
        found = at(
            ["slider_position", "omega2", "A_x"], r=2.0, l=1.0, e=1.0, omega=1.0, theta=[0.0, -0.5], branch=1
        )
    # e - r sin(0) = l: the rod is square to the line
    assert found["slider_position"][0] == 2.0
    assert abs(found["omega2"][0]) == np.inf
    assert np.isnan(found["slider_position"][1])
    assert np.isnan(found["omega2"][1])
    assert np.isfinite(found["A_x"][1])
