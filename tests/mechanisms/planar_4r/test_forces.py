"""Forces with loads against Newton's and Euler's laws, both solvers, and what loads leave alone."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
from tests.support.configurations import LENGTHS, LOADS, PLANAR, all_loads, masses_and_points, random_lengths
from tests.support.newton import Bodies, configuration, cross, facts, kinetic_energy, newton_euler

import fastlink as fl
from fastlink.codegen.kernel import kernel_of
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.plan.programs import make_program
from fastlink.plan.request import variants_of

FORCES = ("F41", "F21", "F32", "F43")
REACTIONS = [f"{force}_{axis}" for force in FORCES for axis in "xy"] + ["T41"]
SHAKING = [
    "shaking_force_x",
    "shaking_force_y",
    "shaking_moment",
    "shaking_moment_at",
    "shaking_moment_printed",
]
COMBINATIONS = [(), *((load,) for load in LOADS), ("gravity", "counterweight3"), tuple(LOADS)]


HAYES = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
BARS = fl.round_bar(7750.0, 0.01)
# Central differences: step^2 = 1e-24 times fourth derivatives over second ones, of the order 1e6 at most here.
RELATIVE = mp.mpf(10) ** -15


@pytest.mark.parametrize("solver", ["eliminated", "dense"])
@pytest.mark.parametrize("loads", COMBINATIONS, ids="+".join)
def test_reactions_and_shaking_loads_are_newtons(loads, solver):
    with mp.workdps(50):
        for seed in range(3):
            one = configuration(seed, loads)
            force, moment, (a, b, d, frames) = newton_euler(one)
            got = facts([*REACTIONS, *SHAKING, *FORCES, "shaking_force", "input_power"], one, solver)
            f41, f21, f32, f43 = (mp.mpc(got[f"{name}_x"], got[f"{name}_y"]) for name in FORCES)
            size = max(map(abs, (f41, f21, f32, f43, *force.values()))) * 10
            assert abs(f41 + f21 - force[1]) <= RELATIVE * size
            assert abs(f32 - f21 - force[2]) <= RELATIVE * size
            assert abs(f43 - f32 - force[3]) <= RELATIVE * size
            assert abs(got["T41"] + cross(a, f21) - moment[1]) <= RELATIVE * size
            assert abs(cross(b, f32) - cross(a, f21) - moment[2]) <= RELATIVE * size
            assert abs(cross(d, f43) - cross(b, f32) - moment[3]) <= RELATIVE * size
            shaking = mp.mpc(got["shaking_force_x"], got["shaking_force_y"])
            assert abs(shaking + f41 + f43) <= RELATIVE * size
            assert abs(got["shaking_moment"] + got["T41"] + cross(d, f43)) <= RELATIVE * size
            m = mp.mpc(one.get("M_x", 0.0), one.get("M_y", 0.0))
            about_m = got["shaking_moment"] - cross(m, shaking)
            assert abs(got["shaking_moment_at"] - about_m) <= RELATIVE * size
            masses = list(Bodies(one).points(3, frames))
            centre = sum(mass * place for mass, place in masses) / sum(mass for mass, _ in masses)
            printed = -got["T41"] + cross(d - centre, -f43)
            assert abs(got["shaking_moment_printed"] - printed) <= RELATIVE * size
            for name, value in zip((*FORCES, "shaking_force"), (f41, f21, f32, f43, shaking), strict=True):
                assert mp.almosteq(got[name], abs(value), rel_eps=RELATIVE)
            assert mp.almosteq(got["input_power"], got["T41"] * mp.mpf(one["omega1"]), rel_eps=RELATIVE)


# -- powers, mirror, and what is left alone -----------------------------------------------------------------


def test_input_power_balances_energy_and_loads():
    with mp.workdps(50):
        for seed in range(4):
            one = configuration(100 + seed, LOADS)
            bodies, step = Bodies(one), mp.mpf(10) ** -9
            rate = (kinetic_energy(bodies, step, step) - kinetic_energy(bodies, -step, step)) / (2 * step)
            *_, past = bodies.at(-step)
            *_, future = bodies.at(step)
            gravity = mp.mpc(bodies["gravity_x"], bodies["gravity_y"])
            load = mp.mpc(bodies["FP_x"], bodies["FP_y"])
            arm = mp.mpc(bodies["P_u"], bodies["P_v"])
            supplied = mp.mpf(0)
            for link in (1, 2, 3):
                places = zip(bodies.points(link, past), bodies.points(link, future), strict=True)
                for (mass, old), (_, new) in places:
                    velocity = (new - old) / (2 * step)
                    supplied += mass * (velocity * mp.conj(gravity)).real
            tip = [frames[2][0] + arm * frames[2][1] for frames in (past, future)]
            supplied += ((tip[1] - tip[0]) / (2 * step) * mp.conj(load)).real
            got = facts(["input_power", "omega4"], one)
            w = got["omega4"]
            torque = bodies["T_load"] + bodies["T_load_linear"] * w + bodies["T_load_quadratic"] * w * abs(w)
            # Differences: step^2 = 1e-18 times a third derivative over the first, below 1e5 here.
            assert mp.almosteq(got["input_power"], rate - supplied - torque * w, rel_eps=mp.mpf(10) ** -12)


MIRRORED = ("G1_v", "G2_v", "G3_v", "P_v", "omega1", "alpha1", "gravity_y", "FP_y", "T_load", "M_y")
MIRRORED += ("counterweight1_direction", "counterweight3_direction", "theta1")
ODD = ("T41", "shaking_moment", "shaking_moment_at", "shaking_moment_printed")


def test_the_mirror_in_the_ground_line_exchanges_the_branches_bit_by_bit():
    for seed in range(20):
        one = configuration(200 + seed, LOADS)
        other = {name: -value if name in MIRRORED else value for name, value in one.items()}
        other["branch"] = 3 - one["branch"]
        names = [*REACTIONS, *SHAKING, *FORCES, "shaking_force", "input_power"]
        got, mirrored = fl.evaluate("planar_4r", names, **one), fl.evaluate("planar_4r", names, **other)
        for name in names:
            sign = -1.0 if name in ODD or name.endswith("_y") else 1.0
            # Every operation is odd or even in what changes sign, and rounding is symmetric.
            assert mirrored[name] == sign * got[name], name


@pytest.mark.parametrize("load", LOADS)
def test_a_load_of_nothing_changes_nothing_but_roundings_and_a_load_not_given_is_not_computed(load):
    rng = np.random.default_rng(8)
    inputs = dict(zip(LENGTHS, random_lengths(rng, 1), strict=True)) | masses_and_points(rng, 1)
    inputs = {name: float(value[0]) for name, value in inputs.items()}
    names = [*REACTIONS, *SHAKING, "alpha4", "jerk4"]
    nothing = dict.fromkeys(PLANAR.variant_inputs[load], 0.0)
    chosen = variants_of(PLANAR, None, "eliminated", nothing)
    assert chosen == (load,)
    bare = kernel_of(make_program(PLANAR, names, given=tuple(inputs)))
    assert not any(name in bare.text for other in LOADS for name in PLANAR.variant_inputs[other])
    loaded = kernel_of(make_program(PLANAR, names, given=(*inputs, *nothing), variants=chosen))
    assert any(name in loaded.text for name in nothing)
    other_loads = set(LOADS) - {load}
    assert not any(n in loaded.text for key in other_loads for n in PLANAR.variant_inputs[key])
    for theta in rng.uniform(-np.pi, np.pi, 5):
        without = fl.evaluate("planar_4r", names, theta1=theta, **inputs)
        with_nothing = fl.evaluate("planar_4r", names, theta1=theta, **inputs, **nothing)
        alike = [name for name in names if "printed" not in name]
        # x + 0 and x - 0 are x; only the mass centre that r34 starts from takes another way with counterweights.
        assert all(np.array_equal(without[n], with_nothing[n], equal_nan=True) for n in alike)
        a, b = without["shaking_moment_printed"], with_nothing["shaking_moment_printed"]
        # Ten roundings of each of its terms, which are not larger than this.
        size = sum(abs(without[name]) for name in REACTIONS) * sum(
            abs(inputs[n]) for n in (*LENGTHS, "G3_u", "G3_v")
        )
        assert np.isnan(a) or abs(a - b) <= 10 * UNIT_ROUNDING * size


def test_dense_and_eliminated_agree_under_all_loads():
    rng = np.random.default_rng(9)
    n = 300
    inputs = dict(zip(LENGTHS, random_lengths(rng, n), strict=True)) | masses_and_points(rng, n)
    inputs |= all_loads(rng, n) | {"theta1": rng.uniform(-np.pi, np.pi, n)}
    names = [*REACTIONS, *SHAKING]
    eliminated = fl.evaluate("planar_4r", [*names, "transmission_angle"], **inputs)
    dense = fl.evaluate("planar_4r", names, solver="dense", **inputs)
    closes = np.isfinite(eliminated["T41"])
    assert closes.sum() > 60
    mu = eliminated["transmission_angle"]
    largest = np.max([np.abs(eliminated[name]) for name in REACTIONS], axis=0)
    arm = 1 + sum(np.abs(inputs[name]) for name in (*LENGTHS, "M_x", "M_y"))
    # Both are bounded by cond(9x9), about 10/sin(mu), times roundings of the largest unknown.
    allowed = 32 * UNIT_ROUNDING * (10 / np.sin(mu)) * largest * arm
    for name in names:
        assert np.all(np.abs(eliminated[name] - dense[name])[closes] <= allowed[closes]), name


# -- bad input ----------------------------------------------------------------------------------------------


def test_a_counterweight_without_a_mass_is_refused():
    with pytest.raises(
        fl.InputError, match=r"counterweight1_mass is missing \(counterweight on the crank OA"
    ):
        fl.sweep("planar_4r", fl.grid(**HAYES, counterweight1_radius=0.1), ["shaking_force_max"], links=BARS)


def test_a_misspelt_load_is_refused():
    with pytest.raises(fl.InputError, match="gravity_z"):
        fl.sweep("planar_4r", fl.grid(**HAYES, gravity_z=-9.81), ["T41_max"], links=BARS)


@pytest.mark.parametrize(
    "by", ["theta1", "omega1", "a2", *(n for k in LOADS for n in PLANAR.variant_inputs[k])]
)
def test_derivatives_hold_under_all_loads(by):
    names = ["T41", "F21", "shaking_force", "shaking_moment_at", "shaking_moment_printed", "alpha4"]
    one = configuration(300, LOADS)
    step = mp.mpf(10) ** -12
    with mp.workdps(50):
        up, down = (facts(names, {**one, by: mp.mpf(one[by]) + h}) for h in (step, -step))
        for name in names:
            derivative = f"d_{name}_d_{by}"
            if up[name] == down[name]:
                with pytest.raises(fl.InputError, match=f"{name} does not depend on {by}"):
                    facts([derivative], one)
                continue
            slope = (up[name] - down[name]) / (2 * step)
            # Central differences: step^2 times a third derivative, below 1e6 of the first or of 1 here.
            assert abs(facts([derivative], one)[derivative] - slope) <= RELATIVE * (1 + abs(slope))
