"""Forces with loads against Newton's and Euler's laws, both solvers, and what loads leave alone."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

import fastlink as fl
from configurations import (
    LENGTHS,
    LOADS,
    PLANAR,
    UNIT,
    all_loads,
    condition_sums,
    draw,
    masses_and_points,
    random_lengths,
)
from fastlink.plan import make_plan
from fastlink.reading import read_facts
from fastlink.request import alternatives_of, constants_of
from test_precision import MULTIPLE, assert_within, family

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


def configuration(seed, loads):
    """One random design with these loads, at an angle where it assembles, as numbers."""
    rng = np.random.default_rng(seed)
    while True:
        inputs = dict(zip(LENGTHS, random_lengths(rng, 1), strict=True)) | masses_and_points(rng, 1)
        for load in loads:
            inputs |= draw(PLANAR.alternative_inputs[load], rng, 1)
        one = {name: float(value[0]) for name, value in inputs.items()}
        one |= {"theta1": rng.uniform(-np.pi, np.pi), "branch": int(rng.integers(1, 3))}
        if fl.evaluate("planar_4r", ["transmission_angle"], **one)["transmission_angle"] > 0.2:
            return one


def facts(names, values, solver="eliminated"):
    """The facts on 50-digit numbers, with the sets of facts that the given inputs choose."""
    alternatives = alternatives_of(PLANAR, None, solver, values)
    values = {
        name: mp.mpf(value) for name, value in (constants_of(PLANAR, None, alternatives) | values).items()
    }
    return read_facts(PLANAR, names, values, alternatives)


class Bodies:
    """The three links as point masses and spins, positions from the facts alone: what Newton would write down."""

    def __init__(self, one):
        self.one = {name: mp.mpf(value) for name, value in one.items()}

    def __getitem__(self, name):
        return self.one.get(name, mp.mpf(0))

    def at(self, time):
        """Positions of everything at a time, the crank being driven from theta1 by omega1 and alpha1."""
        theta = self["theta1"] + self["omega1"] * time + self["alpha1"] * time**2 / 2
        found = facts(["A_x", "A_y", "B_x", "B_y"], {**self.one, "theta1": theta})
        a, b = mp.mpc(found["A_x"], found["A_y"]), mp.mpc(found["B_x"], found["B_y"])
        d = mp.mpc(self["a4"], 0)
        frames = {1: (0, a / abs(a)), 2: (a, (b - a) / abs(b - a)), 3: (d, (b - d) / abs(b - d))}
        return a, b, d, frames

    def points(self, link, frames):
        """Mass and place of the link's own mass centre and of its counterweight."""
        origin, axis = frames[link]
        yield self[f"m{link}"], origin + mp.mpc(self[f"G{link}_u"], self[f"G{link}_v"]) * axis
        if link != 2:
            direction = self.one.get(f"counterweight{link}_direction", mp.pi)
            arm = self[f"counterweight{link}_radius"] * mp.expj(direction)
            yield self[f"counterweight{link}_mass"], origin + arm * axis


def cross(a, b):
    return a.real * b.imag - a.imag * b.real


def newton_euler(one):
    """What Newton's and Euler's laws say of each link: force and moment about O that the joints must supply."""
    bodies = Bodies(one)
    step = mp.mpf(10) ** -12
    before, now, after = (bodies.at(t) for t in (-step, mp.mpf(0), step))
    gravity = mp.mpc(bodies["gravity_x"], bodies["gravity_y"])
    force, moment = {}, {}
    speed = {}
    for link in (1, 2, 3):
        angles = [mp.arg(frames[link][1] / now[3][link][1]) for *_, frames in (before, now, after)]
        speed[link] = (angles[2] - angles[0]) / (2 * step)
        moment[link] = bodies[f"I{link}"] * (angles[2] - 2 * angles[1] + angles[0]) / step**2
        force[link] = mp.mpc(0)
        places = zip(*(bodies.points(link, frames) for *_, frames in (before, now, after)), strict=True)
        for (mass, past), (_, place), (_, future) in places:
            supplied = mass * ((past - 2 * place + future) / step**2 - gravity)
            force[link] += supplied
            moment[link] += cross(place, supplied)
    origin, axis = now[3][2]
    load = mp.mpc(bodies["FP_x"], bodies["FP_y"])
    force[2] -= load
    moment[2] -= cross(origin + mp.mpc(bodies["P_u"], bodies["P_v"]) * axis, load)
    moment[3] -= bodies["T_load"] + bodies["T_load_linear"] * speed[3]
    moment[3] -= bodies["T_load_quadratic"] * speed[3] * abs(speed[3])
    return force, moment, now


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


QUANTITIES = [
    *(*REACTIONS, *FORCES, *SHAKING, "shaking_force", "input_power"),
    *(
        "alpha2",
        "alpha4",
        "jerk2",
        "jerk4",
        "joint_alpha_2",
        "joint_alpha_3",
        "joint_alpha_4",
        "P_ax",
        "P_ay",
    ),
]


@pytest.mark.parametrize("n", [4, pytest.param(300, marks=pytest.mark.stress)])
@pytest.mark.parametrize("kind", ["random", "gap 1e-8", "toggle 1e-6"])
def test_every_quantity_under_all_loads_is_a_few_roundings_off(kind, n):
    rng = np.random.default_rng(n)
    lengths, theta = family(kind, rng, n)
    inputs = dict(zip(LENGTHS, lengths, strict=True)) | masses_and_points(rng, n) | all_loads(rng, n)
    alternatives = alternatives_of(PLANAR, None, "eliminated", inputs)
    assert assert_within(QUANTITIES, inputs, theta, MULTIPLE, alternatives) > n // 2


# -- balancing ----------------------------------------------------------------------------------------------


def test_force_balance_leaves_no_shaking_force():
    rng = np.random.default_rng(31)
    n = 40
    designs = dict(zip(LENGTHS, random_lengths(rng, n), strict=True)) | masses_and_points(rng, n)
    weights = fl.planar.force_balance(designs, radius1=0.3, mass3=rng.uniform(0.2, 2.0, n))
    theta = rng.uniform(-np.pi, np.pi, n)
    names = ["shaking_force_x", "shaking_force_y"]
    tested = 0
    for i in range(n):
        one = {name: value[i] for name, value in (designs | weights).items()}
        one |= {"theta1": theta[i], "branch": 1 + i % 2}
        got = fl.evaluate("planar_4r", [*names, "shaking_force"], **one)
        if np.isnan(got["shaking_force"]):
            continue
        alternatives = alternatives_of(PLANAR, None, "eliminated", one)
        sums = condition_sums(names, one, alternatives)
        for name in names:
            # The exact force is zero but for the roundings of the weights, up to 8 of each term that they balance;
            # each term stands in the sum as that of a mass. The facts add their MULTIPLE.
            assert abs(got[name]) <= (MULTIPLE + 8) * UNIT * sums[name]
        bare = {name: value for name, value in one.items() if name not in weights}
        assert (
            fl.evaluate("planar_4r", ["shaking_force"], **bare)["shaking_force"] > 1e8 * got["shaking_force"]
        )
        tested += 1
    assert tested > 10


def test_the_free_radius_or_mass_is_kept_and_the_link_itself_is_the_default_radius():
    design = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0}
    bars = fl.round_bar(7750.0, 0.01)
    by_default = fl.planar.force_balance(design, links=bars)
    assert (by_default["counterweight1_radius"], by_default["counterweight3_radius"]) == (0.4, 0.8)
    # Mass centres at mid-length: products m1 a1/2 + m2 a1/2 and m3 a3/2 + m2 a3/2, opposite to the links.
    m1, m2, m3 = (7750.0 * np.pi * 1e-4 * a for a in (0.4, 1.2, 0.8))
    # Five roundings on either side.
    assert by_default["counterweight1_mass"] == pytest.approx((m1 + m2) / 2, rel=10 * UNIT)
    assert by_default["counterweight3_mass"] == pytest.approx((m3 + m2) / 2, rel=10 * UNIT)
    assert abs(by_default["counterweight1_direction"]) == np.pi
    chosen = fl.planar.force_balance(design, links=bars, mass1=2.0)
    product = chosen["counterweight1_mass"] * chosen["counterweight1_radius"]
    assert chosen["counterweight1_mass"] == 2.0
    assert product == pytest.approx(0.4 * (m1 + m2) / 2, rel=10 * UNIT)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"radius1": 0.1, "mass1": 2.0}, "radius1 and mass1 are given; write one"),
        ({"radius3": 0.0}, "radius3 must be positive and finite"),
        ({"mass3": "heavy"}, "mass3 is not a number"),
    ],
)
def test_bad_counterweights_are_refused(options, message):
    design = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0}
    with pytest.raises(fl.InputError, match=message):
        fl.planar.force_balance(design, links=fl.round_bar(7750.0, 0.01), **options)


def test_a_missing_mass_is_named():
    with pytest.raises(
        fl.InputError, match=r"force_balance: m1 is missing \(mass of the crank OA \[kg\]\); add"
    ):
        fl.planar.force_balance({"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0})


# -- over the cycle -----------------------------------------------------------------------------------------

HAYES = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
BARS = fl.round_bar(7750.0, 0.01)


def test_fluctuation_is_that_of_the_kinetic_energy():
    """Without loads T41 omega1 is the rate of the kinetic energy: mean zero, fluctuation its greatest difference."""
    n = 720
    space = fl.grid(**{**HAYES, "a1": [0.3, 0.4, 0.9]})
    got = fl.sweep("planar_4r", space, ["T41_mean", "T41_fluctuation"], links=BARS, theta1=n)
    rate = fl.sweep(
        "planar_4r",
        fl.grid(**{**HAYES, "a1": [0.3, 0.4, 0.9]}, P_u=0.6, P_v=0.0),
        ["omega2", "omega4", "P_speed"],
        theta1=20 * n,
    )
    per_length = 7750.0 * np.pi * 1e-4
    m2, m3 = 1.2 * per_length, 0.8 * per_length
    inertia2, about_d = m2 * (1.44 / 12 + 0.25e-4), m3 * (0.64 / 3 + 0.25e-4)
    energy = (m2 * rate.P_speed**2 + inertia2 * rate.omega2**2 + about_d * rate.omega4**2) / 2
    expected = (energy.max("theta1", skipna=False) - energy.min("theta1", skipna=False)).values
    closes = np.isfinite(expected)
    assert closes[:2].all()
    assert not closes[2].any()
    assert np.isnan(got.T41_fluctuation.values[2]).all()
    # Third order in the step of 2 pi/720, 7e-7, times a third derivative of 30 times the range at these extremes; the
    # energy is sampled 20 times as fine, an error of half the second derivative times (step/40)^2, below 1e-6.
    np.testing.assert_allclose(got.T41_fluctuation.values[:2], expected[:2], rtol=3e-5)
    # The rectangle rule of a smooth periodic function: what is left is rounding, of terms of the size of the rms.
    assert np.all(np.abs(got.T41_mean.values[:2]) < 1e-12 * expected[:2])


def test_table_3_as_it_follows_from_table_1():
    design = fl.grid(**HAYES)
    got = fl.sweep(
        "planar_4r", design, ["shaking_force_extrema", "shaking_moment_extrema"], links=BARS, branch=2
    ).squeeze()
    forces, moments = got.shaking_force_extrema.values, got.shaking_moment_extrema.values
    # The figures of docs/errata.md, half a unit of the last.
    assert np.nanmax(forces) == pytest.approx(2512.318373, abs=5e-7)
    assert np.nanmin(forces) == pytest.approx(685.182260, abs=5e-7)
    assert np.nanmax(np.abs(moments)) == pytest.approx(2048.609105, abs=5e-7)
    places = got.theta1_at_shaking_force_extrema.values
    assert places[np.nanargmax(forces)] == pytest.approx(0.109628, abs=5e-7)
    assert places[np.nanargmin(forces)] == pytest.approx(5.546474, abs=5e-7)
    place = got.theta1_at_shaking_moment_extrema.values[np.nanargmax(np.abs(moments))]
    assert place == pytest.approx(0.219954, abs=5e-7)
    assert np.nanmin(forces) > 12 * 56.9764


def test_the_bound_and_the_printed_expression_of_table_3():
    curves = fl.sweep(
        "planar_4r",
        fl.grid(**HAYES),
        ["alpha4", "shaking_moment_printed"],
        links=BARS,
        branch=2,
        theta1=36000,
    ).squeeze()
    # The bound that needs no solve: the output link's mass centre alone.
    assert 0.62 * np.pi * 0.4 * float(curves.alpha4.max()) == pytest.approx(828.0, abs=0.5)
    printed = curves.shaking_moment_printed
    # The nearest sample is half a step off: f'' h^2/8 with |f''| below 100 times the value, 4e-7 of it.
    assert float(printed.max()) == pytest.approx(806.192, rel=2e-6)
    assert float(printed.min()) == pytest.approx(-399.354, rel=2e-6)


def test_the_shaking_force_of_table_3_from_positions_alone():
    bars = {name: value for name, value in zip(("density", "radius"), (7750.0, 0.01), strict=True)}
    with mp.workdps(50):
        links = read_facts(
            PLANAR,
            [
                f"{kind}{i}{axis}"
                for i in (1, 2, 3)
                for kind, axis in (("m", ""), ("I", ""), ("G", "_u"), ("G", "_v"))
            ],
            {name: mp.mpf(value) for name, value in (HAYES | bars).items()},
            ("round_bar",),
        )
        for theta, value in ((0.109628483542, "2512.318373"), (5.546473595953, "685.182260")):
            force, _, _ = newton_euler({**links, "theta1": theta, "branch": 2})
            # Extremes are flat: an error of 1e-12 rad is none.
            assert mp.almosteq(abs(sum(force.values())), mp.mpf(value), abs_eps=mp.mpf("5e-7"))


# -- powers, mirror, and what is left alone -----------------------------------------------------------------


def kinetic_energy(bodies, time, step):
    """Kinetic energy at a time, from positions alone."""
    before, after = bodies.at(time - step), bodies.at(time + step)
    total = mp.mpf(0)
    for link in (1, 2, 3):
        places = zip(*(bodies.points(link, frames) for *_, frames in (before, after)), strict=True)
        total += (
            sum(mass * abs((future - past) / (2 * step)) ** 2 for (mass, past), (_, future) in places) / 2
        )
        spin = mp.arg(after[3][link][1] / before[3][link][1]) / (2 * step)
        total += bodies[f"I{link}"] * spin**2 / 2
    return total


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
    nothing = dict.fromkeys(PLANAR.alternative_inputs[load], 0.0)
    chosen = alternatives_of(PLANAR, None, "eliminated", nothing)
    assert chosen == (load,)
    bare = make_plan(PLANAR, names, given=tuple(inputs))
    assert not any(name in bare.source for other in LOADS for name in PLANAR.alternative_inputs[other])
    loaded = make_plan(PLANAR, names, given=(*inputs, *nothing), alternatives=chosen)
    assert any(name in loaded.source for name in nothing)
    other_loads = set(LOADS) - {load}
    assert not any(n in loaded.source for key in other_loads for n in PLANAR.alternative_inputs[key])
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
        assert np.isnan(a) or abs(a - b) <= 10 * UNIT * size


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
    allowed = 32 * UNIT * (10 / np.sin(mu)) * largest * arm
    for name in names:
        assert np.all(np.abs(eliminated[name] - dense[name])[closes] <= allowed[closes]), name


# -- bad input ----------------------------------------------------------------------------------------------


def test_a_counterweight_without_a_mass_is_refused():
    with pytest.raises(
        fl.InputError, match=r"input 'counterweight1_mass' is missing \(counterweight on the crank OA"
    ):
        fl.sweep("planar_4r", fl.grid(**HAYES, counterweight1_radius=0.1), ["shaking_force_max"], links=BARS)


def test_a_misspelt_load_is_refused():
    with pytest.raises(fl.InputError, match="gravity_z"):
        fl.sweep("planar_4r", fl.grid(**HAYES, gravity_z=-9.81), ["T41_max"], links=BARS)


def test_fluctuation_needs_a_whole_turn():
    with pytest.raises(fl.InputError, match="'T41_fluctuation' is over a whole turn, but theta1 is an array"):
        fl.sweep("planar_4r", fl.grid(**HAYES), ["T41_fluctuation"], links=BARS, theta1=[0.0, 1.0])


@pytest.mark.parametrize("given", [0.0, -0.1, np.nan])
def test_a_bad_coefficient_of_fluctuation_is_refused(given):
    with pytest.raises(fl.InputError, match=r"C_s is .*; write a positive number"):
        fl.planar.flywheel_inertia({"T41_fluctuation": 1.0, "omega1": 25.0}, given)


def test_a_flywheel_needs_the_fluctuation():
    with pytest.raises(fl.InputError, match="'T41_fluctuation' is missing"):
        fl.planar.flywheel_inertia({"omega1": 25.0}, 0.02)
