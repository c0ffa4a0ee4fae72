"""Forces of the slider-crank against free bodies one by one, energy, momentum, and the planar 4R."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
from tests.support.slider_crank_configurations import MASSES, PUMP, family
from tests.support.slider_crank_oracle import DERIVED, DIGITS, Mechanism, facts

import fastlink as fl
from fastlink.errors import InputError
from fastlink.numerics.compensated import UNIT_ROUNDING

FORCES = ("F41_x", "F41_y", "F21_x", "F21_y", "F32_x", "F32_y", "side_force", "T41")
SHAKING = ("shaking_force_x", "shaking_force_y", "shaking_moment")
LOAD = ("slider_load",)


def cases(kinds=("random", "gap 1e-4", "toggle 1e-3", "stiff 1e3", "isosceles 1e-3"), n=5):
    """Configurations that assemble, with all inputs."""
    for kind in kinds:
        drawn = family(kind, np.random.default_rng(2), n)
        for values in zip(*drawn.values(), strict=True):
            one = dict(zip(drawn, map(float, values), strict=True))
            for branch in (1, 2):
                if not mp.isnan(facts(["sigma"], one | {"branch": branch})["sigma"]):
                    yield one, branch


CASES = list(cases())


def assert_close(found, true, scale):
    # The rates of the free bodies are differences, see the oracle.
    for name, value in true.items():
        assert abs(found[name] - value) <= DERIVED * scale, (name, found[name], value)


@pytest.mark.parametrize("F_load", [0.0, 7.0])
def test_forces_are_those_of_the_free_bodies(F_load):
    assert len(CASES) > 30
    for one, branch in CASES:
        loaded = {"F_load": F_load} if F_load else {}
        found = facts(FORCES, one | {"branch": branch} | loaded, LOAD if F_load else ())
        with mp.workdps(DIGITS):
            true = Mechanism(one, branch).free_bodies(one["theta"], F_load)
            # forces and torques per length
            scale = max(abs(value) for value in true.values()) * (1 + one["l"])
            assert_close(found, true, scale * (1 + 1 / one["l"]))


def test_magnitudes_and_the_power():
    found = fl.evaluate(
        "slider_crank",
        [*FORCES, *SHAKING, "F41", "F21", "F32", "shaking_force", "input_power"],
        **(PUMP | MASSES),
        theta=np.linspace(0.0, 6.0, 20),
        branch=1,
    )
    for name in ("F41", "F21", "F32", "shaking_force"):
        np.testing.assert_allclose(
            found[name], np.hypot(found[f"{name}_x"], found[f"{name}_y"]), rtol=4 * UNIT_ROUNDING
        )
    np.testing.assert_array_equal(found["input_power"], found["T41"] * PUMP["omega"])
    np.testing.assert_array_equal(found["side_force"], found["F32_y"])


@pytest.mark.parametrize("F_load", [0.0, -3.0])
def test_the_torque_feeds_the_kinetic_energy(F_load):
    for one, branch in CASES[::4]:
        loaded = {"F_load": F_load} if F_load else {}
        found = facts(["T41", "slider_velocity"], one | {"branch": branch} | loaded, LOAD if F_load else ())
        with mp.workdps(DIGITS):
            other = Mechanism(one, branch)
            mass, omega = other.given, other.given["omega"]

            def energy(theta, other=other, mass=mass):
                speeds = [other.by_time(lambda t, i=i: other.centre(i, t), theta, 1) for i in (1, 2, 3)]
                turning = mass["I2"] * other.by_time(other.rod, theta, 1) ** 2
                moving = sum(
                    mass[f"m{i}"] * abs(speed) ** 2 for i, speed in zip((1, 2, 3), speeds, strict=True)
                )
                return (moving + turning) / 2

            theta, step = mp.mpf(one["theta"]), mp.mpf("1e-12")
            fed = (energy(theta + step) - energy(theta - step)) / (2 * step) * omega
            given = found["T41"] * omega + F_load * found["slider_velocity"]
            # A third derivative of up to (1e-3)^-4 of the energy times step^2, and 1e-30/step of its own differences.
            assert abs(given - fed) <= mp.mpf("1e-11") * (abs(fed) + energy(theta) * abs(omega))


def test_shaking_is_the_loss_of_momentum():
    for one, branch in CASES[::4]:
        found = facts(SHAKING, one | {"branch": branch})
        with mp.workdps(DIGITS):
            other = Mechanism(one, branch)
            mass = other.given
            accelerations = [other.acceleration(i, one["theta"]) for i in (1, 2, 3)]
            centres = [other.centre(i, mp.mpf(one["theta"])) for i in (1, 2, 3)]
            lost = -sum(mass[f"m{i}"] * a for i, a in zip((1, 2, 3), accelerations, strict=True))
            moment = -mass["I2"] * other.by_time(other.rod, one["theta"], 2) - sum(
                mass[f"m{i}"] * (mp.conj(at) * a).imag
                for i, at, a in zip((1, 2, 3), centres, accelerations, strict=True)
            )
            scale = sum(mass[f"m{i}"] * abs(a) for i, a in zip((1, 2, 3), accelerations, strict=True))
            assert abs(found["shaking_force_x"] - lost.real) <= DERIVED * scale
            assert abs(found["shaking_force_y"] - lost.imag) <= DERIVED * scale
            size = abs(moment) + scale * (abs(centres[1]) + abs(centres[2]) + one["l"])
            assert abs(found["shaking_moment"] - moment) <= DERIVED * size


@pytest.mark.parametrize("F_load", [0.0, 5.0])
def test_what_shakes_the_ground_are_its_reactions(F_load):
    for one, branch in CASES[::3]:
        loaded = {"F_load": F_load} if F_load else {}
        names = [*FORCES, *SHAKING, "slider_position"]
        found = facts(names, one | {"branch": branch} | loaded, LOAD if F_load else ())
        with mp.workdps(DIGITS):
            scale = sum(abs(value) for value in found.values())
            assert abs(found["shaking_force_x"] + found["F41_x"]) < 1e-30 * scale
            assert abs(found["shaking_force_y"] + found["F41_y"] + found["side_force"]) < 1e-30 * scale
            moment = -found["T41"] - found["slider_position"] * found["side_force"]
            assert abs(found["shaking_moment"] - moment) < 1e-30 * scale * (1 + abs(found["slider_position"]))


def test_a_planar_4r_with_ground_and_output_link_ever_longer():
    """The slider is a point mass at B: the output link of a planar 4R with its mass centre there."""
    theta = np.array([-2.0, -0.7, 0.4, 1.2, 2.6])
    r, l, e = 0.25, 1.0, 0.125
    masses = {name: value for name, value in MASSES.items() if name != "m3"}
    names = ["T41", "F21", "F41"]
    at = {"r": r, "l": l, "e": e, "omega": 2.0, "theta": theta, "branch": 1}
    here = fl.evaluate("slider_crank", names, **at, **masses, m3=0.5)
    left = []
    for far in (2.0**12, 2.0**13):
        there = fl.evaluate(
            "planar_4r",
            ["T41", "F21", "F41"],
            a1=r,
            a2=l,
            a3=far,
            a4=far + e,
            omega1=2.0,
            theta1=theta - np.pi / 2,
            branch=1,
            **masses,
            m3=0.5,
            I3=0.0,
            G3_u=far,
            G3_v=0.0,
        )
        left.append({name: there[name] - here[name] for name in there})
    for name in here:
        # as in test_slider_crank_motion.py
        np.testing.assert_allclose(left[0][name], 2.0 * left[1][name], rtol=0.01, atol=1e-9, err_msg=name)
        assert 0.0 < np.max(abs(left[0][name])) < 1e-2


def test_links_of_a_round_bar_are_those_of_the_planar_4r():
    links = fl.round_bar(7850.0, 0.01)
    names = ["m1", "I1", "G1_u", "m2", "I2", "G2_u", "G2_v"]
    from fastlink.mechanisms import catalogue

    planar, slider = catalogue("planar_4r"), catalogue("slider_crank")
    for name in names:
        one = planar.variants["round_bar"][name]
        assert one.function is slider.variants["round_bar"][name].function
    found = fl.evaluate("slider_crank", ["T41"], **PUMP, m3=0.8, theta=1.0, branch=1, links=links)
    mass = 7850.0 * np.pi * 0.01**2
    given = {
        f"{what}{i}{end}": value
        for i, a in ((1, PUMP["r"]), (2, PUMP["l"]))
        for what, end, value in (
            ("m", "", mass * a),
            ("I", "", mass * a * (a * a / 12 + 0.25e-4)),
            ("G", "_u", a / 2),
            ("G", "_v", 0.0),
        )
    }
    same = fl.evaluate("slider_crank", ["T41"], **PUMP, m3=0.8, theta=1.0, branch=1, **given)
    # the masses here are rounded a few times themselves
    np.testing.assert_allclose(found["T41"], same["T41"], rtol=32 * UNIT_ROUNDING)


def test_a_missing_mass_is_named():
    with pytest.raises(InputError, match="m3"):
        fl.evaluate("slider_crank", ["T41"], **PUMP, theta=1.0, branch=1, links=fl.round_bar(7850.0, 0.01))
