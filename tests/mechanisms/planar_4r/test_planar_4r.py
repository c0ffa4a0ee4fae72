"""The planar 4R against the paper, against the closure solved anew, and against Newton's laws."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.support.configurations import LENGTHS, PLANAR, masses_and_points, random_lengths

import fastlink as fl
from fastlink.facts.evaluate import read_facts
from fastlink.numerics.compensated import UNIT_ROUNDING

TABLE_1 = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
EXACT_TABLE_1 = {"a1": "0.4", "a2": "1.2", "a3": "0.8", "a4": "1", "omega1": "25"}
# Table 2: branch, quantity, angle as printed, value (the two wrong -23.93938170 and 23.05038176 corrected).
TABLE_2 = [
    (1, "omega4", "0.36933536508", "-23.95938172"),
    (1, "omega4", "-1.667165012", "13.51343678"),
    (1, "alpha4", "0.8382412814", "462.6986574"),
    (1, "alpha4", "-0.1482557001", "-1062.775829"),
    (2, "omega4", "1.667165012", "13.51343678"),
    (2, "omega4", "5.913849943", "-23.95938172"),
    (2, "alpha4", "0.1482557001", "1062.775829"),
    (2, "alpha4", "5.444944024", "-462.6986574"),
]


# The printed angles come from a numerical search of flat extrema; against 50 digits the worst is 1.8e-9 off.
ANGLES_AS_PRINTED = 2e-9


def last_digit(text: str) -> float:
    """One unit of the last digit printed: some figures are cut, not rounded."""
    return 10.0 ** -len(text.partition(".")[2])


def exact_extremum(quantity: str, branch: int, near: str) -> mp.mpf:
    def value(theta):
        given = {name: mp.mpf(text) for name, text in EXACT_TABLE_1.items()}
        return read_facts(PLANAR, [quantity], given | {"theta1": theta, "branch": mp.mpf(branch)})[quantity]

    return mp.findroot(lambda theta: mp.diff(value, theta), mp.mpf(near))


@pytest.mark.parametrize(("branch", "quantity", "theta", "value"), TABLE_2)
def test_table_2_to_every_right_digit(branch, quantity, theta, value):
    with mp.workdps(50):
        place = exact_extremum(quantity, branch, theta)
    assert abs(float(place) - float(theta)) <= ANGLES_AS_PRINTED
    result = fl.sweep("planar_4r", fl.grid(**TABLE_1), [quantity], theta1=[float(place)], branch=branch)
    assert abs(float(result[quantity].squeeze()) - float(value)) <= last_digit(value)


@pytest.mark.parametrize("branch", [1, 2])
def test_sampled_extremes_approach_table_2(branch):
    asked = ["omega4_min", "omega4_max", "alpha4_min", "alpha4_max", "theta1_at_alpha4_max"]
    result = fl.sweep("planar_4r", fl.grid(**TABLE_1), asked, theta1=3600, branch=branch).squeeze()
    rows = [row for row in TABLE_2 if row[0] == branch]
    for quantity in ("omega4", "alpha4"):
        values = [float(value) for _, name, _, value in rows if name == quantity]
        # The nearest sample is half a step off: f'' h^2/8, with |f''| below 40 times the extremum here.
        allowed = 40 * (2 * np.pi / 3600) ** 2 / 8
        assert float(result[f"{quantity}_min"]) == pytest.approx(min(values), rel=allowed)
        assert float(result[f"{quantity}_max"]) == pytest.approx(max(values), rel=allowed)
    place = next(float(t) for _, name, t, v in rows if name == "alpha4" and float(v) > 0)
    # The best sample lies within one step of the extremum.
    assert abs(float(result.theta1_at_alpha4_max) - place % (2 * np.pi)) <= 2 * np.pi / 3600


def test_the_greatest_shaking_force_is_newtons_not_table_3():
    result = fl.sweep(
        "planar_4r",
        fl.grid(**TABLE_1),
        ["shaking_force_max", "theta1_at_shaking_force_max", "alpha4_max"],
        links=fl.round_bar(7750.0, 0.01),
        theta1=36000,
        branch=2,
    ).squeeze()
    assert float(result.shaking_force_max) == pytest.approx(2512.318, abs=1e-3)
    assert float(result.theta1_at_shaking_force_max) == pytest.approx(0.1096, abs=1e-4)
    # The bound that needs no solve: the output link's mass centre alone.
    m3 = 0.62 * np.pi
    assert m3 * 0.4 * float(result.alpha4_max) == pytest.approx(828, abs=1)


def samples(seed: int, n: int):
    """Random designs with all masses, one input angle each, both branches, as plain arrays."""
    rng = np.random.default_rng(seed)
    inputs = dict(zip(LENGTHS, random_lengths(rng, n), strict=True)) | masses_and_points(rng, n)
    return inputs, rng.uniform(-np.pi, np.pi, n)


def evaluate(names, inputs, theta, branch, **options):
    found = fl.evaluate("planar_4r", names, branch=branch, theta1=theta, **inputs, **options)
    return {name: np.asarray(value) for name, value in found.items()}


@pytest.mark.parametrize("branch", [1, 2])
def test_the_six_io_equations_hold(branch):
    """Equations (1) to (6), in the polygon convention, up to the rounding of their largest term."""
    inputs, theta = samples(11, 400)
    got = evaluate(["theta2", "theta4", "loop_residual"], inputs, theta, branch)
    closes = np.isfinite(got["theta4"])
    assert closes.sum() > 100
    a1, a2, a3, a4 = (inputs[name][closes] for name in LENGTHS)
    t1, t2, t4 = theta[closes], got["theta2"][closes], got["theta4"][closes]
    # Link directions of the closed polygon: OA, AB, BD, DO; joint angles are their differences.
    directions = [t1, t2, t4 + np.pi, np.full_like(t1, np.pi)]
    joints = [directions[k] - directions[k - 1] for k in range(4)]
    c, s = [np.cos(j / 2) for j in joints], [np.sin(j / 2) for j in joints]
    A1, A2, B1, B2 = a1 - a2 + a3 - a4, a1 + a2 + a3 - a4, a1 + a2 - a3 - a4, a1 - a2 - a3 - a4
    C1, C2, D1, D2 = a1 - a2 - a3 + a4, a1 + a2 - a3 + a4, a1 + a2 + a3 + a4, a1 - a2 + a3 + a4
    equations = {
        (0, 3): (A1 * A2, B1 * B2, C1 * C2, -8 * a1 * a3, D1 * D2),
        (0, 1): (A1 * B2, A2 * B1, C1 * D2, -8 * a2 * a4, C2 * D1),
        (0, 2): (A1 * B1, A2 * B2, C2 * D2, 0, C1 * D1),
        (1, 2): (A1 * D2, B2 * C1, B1 * C2, -8 * a1 * a3, A2 * D1),
        (1, 3): (A1 * C1, B2 * D2, A2 * C2, 0, B1 * D1),
        (2, 3): (A1 * C2, B1 * D2, A2 * C1, 8 * a2 * a4, B2 * D1),
    }
    # Homogeneous in sine and cosine. Each angle is wrong by its own conditioning: the closure amplifies
    # roundings by 1/sin of the transmission angle, here below 1e3 for all but the toggles, which are left out.
    sine = np.abs(np.sin(t4 - t2))
    good = sine > 1e-3
    for (i, j), (vij, vi, vj, both, one) in equations.items():
        terms = [
            vij * s[i] ** 2 * s[j] ** 2,
            vi * s[i] ** 2 * c[j] ** 2,
            vj * c[i] ** 2 * s[j] ** 2,
            both * s[i] * c[i] * s[j] * c[j],
            one * c[i] ** 2 * c[j] ** 2,
        ]
        scale = (a1 + a2 + a3 + a4) ** 2
        assert np.all(np.abs(sum(terms))[good] <= (64 * UNIT_ROUNDING * scale / sine)[good])
    # The residual of our own closure does not suffer from the toggle: lengths and loop close as they stand.
    assert np.all(got["loop_residual"][closes] <= 16 * UNIT_ROUNDING)


@pytest.mark.parametrize("branch", [1, 2])
def test_position_and_rates_against_a_newton_solve_of_the_closure(branch):
    """Newton on the loop equations and its linear derivatives: no formula in common with the facts."""
    inputs, theta = samples(12, 300)
    names = ["theta2", "theta4", "omega2", "omega4", "alpha2", "alpha4", "B_x", "B_y", "A_x", "A_y"]
    got = evaluate(names, inputs, theta, branch)
    tested = 0
    with mp.workdps(40):
        for i in np.flatnonzero(np.isfinite(got["theta4"])):
            a1, a2, a3, a4, w, t = (
                mp.mpf(float(v)) for v in (*(inputs[n][i] for n in LENGTHS), inputs["omega1"][i], theta[i])
            )

            def loop(x, y, a1=a1, a2=a2, a3=a3, a4=a4, t=t):
                return [
                    a1 * mp.cos(t) + a2 * mp.cos(x) - a3 * mp.cos(y) - a4,
                    a1 * mp.sin(t) + a2 * mp.sin(x) - a3 * mp.sin(y),
                ]

            x, y = mp.findroot(loop, (mp.mpf(float(got["theta2"][i])), mp.mpf(float(got["theta4"][i]))))
            jacobian = mp.matrix([[-a2 * mp.sin(x), a3 * mp.sin(y)], [a2 * mp.cos(x), -a3 * mp.cos(y)]])
            sine = abs(mp.sin(x - y))
            velocity = mp.lu_solve(jacobian, mp.matrix([a1 * w * mp.sin(t), -a1 * w * mp.cos(t)]))
            o2, o4 = velocity
            acceleration = mp.lu_solve(
                jacobian,
                mp.matrix(
                    [
                        a1 * w**2 * mp.cos(t) + a2 * o2**2 * mp.cos(x) - a3 * o4**2 * mp.cos(y),
                        a1 * w**2 * mp.sin(t) + a2 * o2**2 * mp.sin(x) - a3 * o4**2 * mp.sin(y),
                    ]
                ),
            )
            # Sizes of the right-hand sides over the smallest pivot: what a rounding of the data can do.
            spread = (a1 + a2 + a3 + a4) / min(a2, a3) / sine
            rate = abs(w) * spread
            allowed = 32 * UNIT_ROUNDING * spread
            assert abs(x - float(got["theta2"][i])) <= allowed
            assert abs(y - float(got["theta4"][i])) <= allowed
            assert abs(o2 - float(got["omega2"][i])) <= allowed * rate
            assert abs(o4 - float(got["omega4"][i])) <= allowed * rate
            assert abs(acceleration[0] - float(got["alpha2"][i])) <= allowed * rate**2 * spread
            assert abs(acceleration[1] - float(got["alpha4"][i])) <= allowed * rate**2 * spread
            side = (a4 - got["A_x"][i]) * (got["B_y"][i] - got["A_y"][i]) + got["A_y"][i] * (
                got["B_x"][i] - got["A_x"][i]
            )
            assert (side > 0) == (branch == 2)
            tested += 1
    assert tested > 100


FORCES = ("F41", "F21", "F32", "F43")


def force_scale(got):
    """Largest force of a configuration: the roundings of the others are relative to it."""
    return np.max([np.hypot(got[f"{name}_x"], got[f"{name}_y"]) for name in FORCES], axis=0)


@pytest.mark.parametrize("solver", ["eliminated", "dense"])
@pytest.mark.parametrize("branch", [1, 2])
def test_shaking_force_and_moment_are_what_the_ground_feels(branch, solver):
    inputs, theta = samples(13, 2000)
    names = [f"{f}_{c}" for f in FORCES for c in "xy"] + [
        "T41",
        "shaking_force_x",
        "shaking_force_y",
        "shaking_moment",
    ]
    got = evaluate(names, inputs, theta, branch, solver=solver)
    closes = np.isfinite(got["F41_x"])
    assert closes.sum() > 500
    # The solve is backward stable: relative to the largest force, cond(9x9) roundings, cond about 10/sin(mu).
    mu = evaluate(["transmission_angle"], inputs, theta, branch)["transmission_angle"]
    allowed = 16 * UNIT_ROUNDING * (10 / np.sin(mu)) * force_scale(got)
    for c in "xy":
        difference = got[f"shaking_force_{c}"] + got[f"F41_{c}"] + got[f"F43_{c}"]
        assert np.all(np.abs(difference)[closes] <= allowed[closes])
    arm = sum(inputs[name] for name in LENGTHS)
    moment = got["shaking_moment"] + got["T41"] + inputs["a4"] * got["F43_y"]
    assert np.all(np.abs(moment)[closes] <= (allowed * arm)[closes])


@pytest.mark.parametrize("branch", [1, 2])
def test_dense_and_eliminated_reactions_agree(branch):
    inputs, theta = samples(14, 2000)
    names = [f"{f}_{c}" for f in FORCES for c in "xy"] + ["T41", "shaking_force", "shaking_moment"]
    eliminated = evaluate(names, inputs, theta, branch)
    dense = evaluate(names, inputs, theta, branch, solver="dense")
    closes = np.isfinite(eliminated["F41_x"])
    mu = evaluate(["transmission_angle"], inputs, theta, branch)["transmission_angle"]
    arm = 1 + sum(inputs[name] for name in LENGTHS)
    # Errors of both are bounded by cond(9x9), about 10/sin(mu), times the rounding of the largest unknown.
    allowed = 16 * UNIT_ROUNDING * (10 / np.sin(mu)) * force_scale(eliminated) * arm
    for name in names:
        assert np.all(np.abs(eliminated[name] - dense[name])[closes] <= allowed[closes]), name


def test_input_power_is_the_rate_of_kinetic_energy():
    inputs, theta = samples(15, 40)
    names = ["T41", "omega2", "omega4", "A_x", "A_y", "theta2", "theta4", "B_x"]
    tested = 0
    with mp.workdps(50):
        for i in range(40):
            given = {name: mp.mpf(float(value[i])) for name, value in inputs.items()}
            given["branch"] = mp.mpf(1 + i % 2)

            def energy(t, given=given):
                f = read_facts(PLANAR, names, given | {"theta1": t})
                w1, w2, w4 = given["omega1"], f["omega2"], f["omega4"]

                def centre(u, v, angle):
                    return u * mp.cos(angle) - v * mp.sin(angle), u * mp.sin(angle) + v * mp.cos(angle)

                g2 = centre(given["G2_u"], given["G2_v"], f["theta2"])
                velocity2 = (-w1 * f["A_y"] - w2 * g2[1], w1 * f["A_x"] + w2 * g2[0])
                about_d = given["I3"] + given["m3"] * (given["G3_u"] ** 2 + given["G3_v"] ** 2)
                return (
                    given["m2"] * (velocity2[0] ** 2 + velocity2[1] ** 2) / 2
                    + given["I2"] * w2**2 / 2
                    + about_d * w4**2 / 2
                )

            t = mp.mpf(float(theta[i]))
            facts = read_facts(PLANAR, names, given | {"theta1": t})
            if mp.isnan(facts["B_x"]):
                continue
            h = mp.mpf(10) ** -12
            slope = (energy(t + h) - energy(t - h)) / (2 * h)
            # Central difference: h^2 = 1e-24 times a third derivative; 50 digits hide the cancellation.
            assert mp.almosteq(facts["T41"], slope, rel_eps=mp.mpf(10) ** -15)
            tested += 1
    assert tested > 15


@settings(max_examples=60, deadline=None)
@given(
    st.tuples(*[st.floats(0.1, 10.0)] * 4),
    # Below it the square of the angle times its roundings, and their products, are not normal numbers any more.
    st.floats(-3.1, 3.1).filter(lambda theta: theta == 0.0 or abs(theta) > 1e-60),
    st.integers(-300, 300),
)
def test_scale_by_a_power_of_two_changes_no_bit_of_angles_and_rates(lengths, theta, exponent):
    names = [
        "theta2",
        "theta4",
        "omega2",
        "omega4",
        "alpha2",
        "alpha4",
        "transmission_angle",
        "loop_residual",
    ]
    given_lengths = dict(zip(LENGTHS, lengths, strict=True))
    scaled = {name: value * 2.0**exponent for name, value in given_lengths.items()}
    one = fl.evaluate("planar_4r", names, theta1=theta, omega1=3.0, branch=2, **given_lengths)
    two = fl.evaluate("planar_4r", names, theta1=theta, omega1=3.0, branch=2, **scaled)
    np.testing.assert_equal(one, two)


@settings(max_examples=60, deadline=None)
@given(st.tuples(*[st.floats(0.1, 10.0)] * 4), st.floats(-3.1, 3.1))
def test_mirror_exchanges_the_branches(lengths, theta):
    given_lengths = dict(zip(LENGTHS, lengths, strict=True))
    even, odd = (
        ["omega2", "omega4", "jerk2", "jerk4", "B_x", "transmission_angle"],
        ["alpha2", "alpha4", "B_y"],
    )
    one = fl.evaluate("planar_4r", even + odd, theta1=theta, omega1=3.0, branch=1, **given_lengths)
    two = fl.evaluate("planar_4r", even + odd, theta1=-theta, omega1=3.0, branch=2, **given_lengths)
    np.testing.assert_array_equal([one[n] for n in even], [two[n] for n in even])
    np.testing.assert_array_equal([one[n] for n in odd], [-two[n] for n in odd])
