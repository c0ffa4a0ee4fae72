"""Joint angles, half-angle tangents and the six input-output equations of the planar 4R."""

from __future__ import annotations

from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
from tests.support.configurations import LENGTHS, near_change_point, near_toggle, random_lengths
from tests.support.curve_designs import design_of

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING

PAIRS = ("12", "13", "14", "23", "24", "34")
ANGLES = [f"joint_angle_{i}" for i in (1, 2, 3, 4)]
TANGENTS = [f"v{i}" for i in (1, 2, 3, 4)]
RESIDUALS = [f"io_residual_{pair}" for pair in PAIRS]
RATES = [f"joint_omega_{i}" for i in (2, 3, 4)] + [f"joint_alpha_{i}" for i in (2, 3, 4)]


def configurations(kind, n=300):
    rng = np.random.default_rng(31)
    if kind == "random":
        lengths, theta = random_lengths(rng, n), rng.uniform(-np.pi, np.pi, n)
    elif kind == "gap":
        lengths, theta = near_change_point(rng, n, 1e-9)
    else:
        lengths, theta = near_toggle(rng, n, 1e-6)
    return dict(zip(LENGTHS, lengths, strict=True)) | {"omega1": rng.uniform(-30.0, 30.0, n), "theta1": theta}


def evaluate(names, inputs, branch):
    return fl.evaluate("planar_4r", names, branch=branch, **inputs)


def solve_position(a1, a2, a3, a4, t, branch):
    """Directions of AB and DB in 50 digits, by the law of cosines in the triangle ABD."""
    x, y = a4 - a1 * mp.cos(t), -a1 * mp.sin(t)
    distance = mp.sqrt(x * x + y * y)
    at_a = mp.acos((a2**2 + distance**2 - a3**2) / (2 * a2 * distance))
    theta2 = mp.atan2(y, x) + (at_a if branch == 2 else -at_a)
    b = (a1 * mp.cos(t) + a2 * mp.cos(theta2) - a4, a1 * mp.sin(t) + a2 * mp.sin(theta2))
    return theta2, mp.atan2(b[1], b[0])


def wrapped(angle):
    return angle - 2 * mp.pi * mp.ceil((angle - mp.pi) / (2 * mp.pi))


@pytest.mark.parametrize("branch", [1, 2])
@pytest.mark.parametrize("kind", ["random", "gap", "toggle"])
def test_joint_angles_are_the_turns_of_the_polygon(kind, branch):
    """phi_i - phi_(i-1) of the closed polygon O A B D, phi_0 = phi_4 = pi."""
    inputs = configurations(kind, 80)
    got = evaluate([*ANGLES, *TANGENTS], inputs, branch)
    tested = 0
    with mp.workdps(50):
        for i in np.flatnonzero(np.isfinite(got["joint_angle_2"])):
            *lengths, t = (mp.mpf(float(inputs[name][i])) for name in (*LENGTHS, "theta1"))
            theta2, theta4 = solve_position(*lengths, t, branch)
            directions = [mp.pi, t, theta2, theta4 + mp.pi, mp.pi]
            # What a rounding of lengths and angle does to an angle, at most: spread over the transmission sine.
            spread = sum(lengths) / min(lengths[1:3]) / abs(mp.sin(theta2 - theta4))
            for k in range(4):
                joint = wrapped(directions[k + 1] - directions[k])
                error = abs(wrapped(joint - mp.mpf(float(got[ANGLES[k]][i]))))
                assert error <= 16 * UNIT_ROUNDING * (spread if k else 1), (k, i)
                exact = mp.tan(joint / 2)
                # d tan(x/2) = (1 + tan^2)/2 dx, and a rounding or two of the quotient itself.
                allowed = 16 * UNIT_ROUNDING * ((spread if k else 0) * (1 + exact**2) / 2 + abs(exact))
                assert abs(mp.mpf(float(got[TANGENTS[k]][i])) - exact) <= allowed, (k, i)
            tested += 1
    assert tested > 25


def test_the_two_conventions():
    inputs = configurations("random")
    names = [*ANGLES, "theta2", "theta4", "omega2", "omega4", "alpha2", "alpha4", *RATES]
    for branch in (1, 2):
        got = evaluate(names, inputs, branch)
        closes = np.isfinite(got["theta4"])
        t = inputs["theta1"]
        for name, difference in (
            ("joint_angle_1", t - np.pi),
            ("joint_angle_2", got["theta2"] - t),
            ("joint_angle_3", got["theta4"] + np.pi - got["theta2"]),
            ("joint_angle_4", -got["theta4"]),
        ):
            # Both are right to the error of theta2 and theta4, here at most a few units at amplification 1e3.
            turn = np.abs(np.exp(1j * (got[name] - difference)) - 1)[closes]
            assert turn.max() <= 1e4 * UNIT_ROUNDING, name
        w = inputs["omega1"]
        for name, difference, size in (
            ("joint_omega_2", got["omega2"] - w, np.abs(got["omega2"]) + np.abs(w)),
            ("joint_omega_3", got["omega4"] - got["omega2"], np.abs(got["omega2"]) + np.abs(got["omega4"])),
            ("joint_omega_4", -got["omega4"], np.abs(got["omega4"])),
            ("joint_alpha_2", got["alpha2"], np.abs(got["alpha2"])),
            ("joint_alpha_3", got["alpha4"] - got["alpha2"], np.abs(got["alpha2"]) + np.abs(got["alpha4"])),
            ("joint_alpha_4", -got["alpha4"], np.abs(got["alpha4"])),
        ):
            # The rates have terms larger than their sum; relative to the largest of them, a few roundings.
            slack = 1e4 * UNIT_ROUNDING * (size + np.abs(w) * (1 + np.abs(w)))
            assert np.all(np.abs(got[name] - difference)[closes] <= slack[closes]), name


@pytest.mark.parametrize("branch", [1, 2])
@pytest.mark.parametrize("kind", ["random", "gap", "toggle"])
def test_all_six_residuals_are_a_few_roundings(kind, branch):
    inputs = configurations(kind)
    got = evaluate([*RESIDUALS, "joint_angle_2", "transmission_angle"], inputs, branch)
    closes = np.isfinite(got["joint_angle_2"])
    assert closes.sum() > 70
    # The cosines and sines are those of vectors that are right to a few roundings of their lengths, with lengths
    # of ratio below 10: no term is above 1, and each is off by at most some ten roundings times the amplification
    # of theta1 and the lengths, 1/sin(mu); near a toggle the common error of sigma drops out of the closure.
    for name in RESIDUALS:
        assert np.max(np.abs(got[name][closes])) <= 64 * UNIT_ROUNDING, name
        assert np.all(np.isnan(got[name][~closes])), name


@pytest.mark.parametrize("pair", PAIRS)
def test_residuals_notice_a_wrong_joint(pair):
    """With the coefficients of `io_coefficients` the equation of the paper vanishes, and at no other angle."""
    inputs = configurations("random")
    got = evaluate(TANGENTS, inputs, 2)
    closes = np.isfinite(got["v2"])
    c = np.moveaxis(
        fl.planar.io_coefficients({name: inputs[name][closes] for name in LENGTHS}, pair=pair), -1, 0
    )
    x, y = (got[f"v{k}"][closes] for k in pair)

    def value(x, y):
        terms = [c[0] * x**2 * y**2, c[1] * x**2, c[2] * y**2, c[3] * x * y, c[4]]
        return np.abs(sum(terms)) / np.max(np.abs(terms), axis=0)

    # v's are right to amplification times rounding: 1e3 at worst here, times the ten operations of the sum.
    assert np.max(value(x, y)) <= 1e5 * UNIT_ROUNDING
    assert np.median(value(x, 1.01 * y)) > 1e-4


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("branch", [1, 2])
def test_velocity_and_acceleration_equations_hold_for_all_pairs(pair, branch):
    """Equations (7) and (8): the first two derivatives, with v'' = (theta'' + v theta'^2)(1 + v^2)/2."""
    inputs = configurations("random")
    got = evaluate([*TANGENTS, *RATES, "transmission_angle"], inputs, branch)
    good = np.sin(got["transmission_angle"]) > 0.05
    assert good.sum() > 50
    rate = {"1": inputs["omega1"]} | {k: got[f"joint_omega_{k}"] for k in "234"}
    bend = {"1": 0.0 * inputs["omega1"]} | {k: got[f"joint_alpha_{k}"] for k in "234"}
    v = {k: got[f"v{k}"] for k in "1234"}
    dv = {k: rate[k] * (1 + v[k] ** 2) / 2 for k in v}
    ddv = {k: (bend[k] + v[k] * rate[k] ** 2) * (1 + v[k] ** 2) / 2 for k in v}
    A, B, C, K, D = np.moveaxis(fl.planar.io_coefficients(inputs, pair=pair), -1, 0)
    i, j = pair
    x, y, dx, dy, ddx, ddy = v[i], v[j], dv[i], dv[j], ddv[i], ddv[j]
    velocity = [(2 * A * y**2 * x) * dx, 2 * B * x * dx, K * y * dx]
    velocity += [(2 * A * x**2 * y) * dy, 2 * C * y * dy, K * x * dy]
    # Each v, v' and v'' is right to roundings times 1/sin^k(mu) <= 20^3, relative to the largest term.
    allowed = 256 * UNIT_ROUNDING * 20**3
    size = np.max(np.abs(velocity), axis=0)
    assert np.all((np.abs(sum(velocity)) <= allowed * size)[good])
    acceleration = [
        (2 * A * y**2 * x + 2 * B * x + K * y) * ddx,
        (2 * A * x**2 * y + 2 * C * y + K * x) * ddy,
        2 * (A * y**2 + B) * dx**2,
        2 * (A * x**2 + C) * dy**2,
        2 * (4 * A * x * y + K) * dx * dy,
    ]
    # The factors of v'' cancel at a dead point of either joint; their own terms are the scale there.
    scale = (
        np.max(np.abs(acceleration), axis=0)
        + (np.abs(2 * A * y**2 * x) + np.abs(2 * B * x) + np.abs(K * y)) * np.abs(ddx)
        + (np.abs(2 * A * x**2 * y) + np.abs(2 * C * y) + np.abs(K * x)) * np.abs(ddy)
        + 2 * (np.abs(A * y**2) + np.abs(B)) * dx**2
        + 2 * (np.abs(A * x**2) + np.abs(C)) * dy**2
    )
    assert np.all((np.abs(sum(acceleration)) <= allowed * scale)[good])
    assert D.shape == A.shape


def test_straight_joints_are_pi_and_infinite():
    """Folded and stretched positions whose figures are exact: no -pi, no NaN."""
    crank = {"a1": 3.0, "a2": 4.0, "a3": 5.0, "a4": 6.0}
    at_zero = {k: evaluate([*ANGLES, *TANGENTS], crank | {"theta1": 0.0}, k) for k in (1, 2)}
    for k in (1, 2):
        assert at_zero[k]["joint_angle_1"] == np.pi
        assert at_zero[k]["v1"] == np.inf
    # |AD| = 1 = a3 - a2 at theta1 = 0: B beyond A on the line through D, the coupler folded on the output link.
    folded = {"a1": 3.0, "a2": 4.0, "a3": 7.0, "a4": 6.0, "theta1": 0.0}
    stretched = {"a1": 3.0, "a2": 5.0, "a3": 4.0, "a4": 6.0, "theta1": np.pi}
    for branch in (1, 2):
        got = evaluate([*ANGLES, *TANGENTS], folded, branch)
        assert got["joint_angle_3"] == np.pi
        assert got["v3"] == np.inf
        # theta2 = pi: from the crank's direction 0 it is pi, and DB points along -x: -theta4 = -pi, that is pi.
        assert got["joint_angle_2"] == np.pi
        assert got["joint_angle_4"] == np.pi
        assert got["v2"] == np.inf
        assert got["v4"] == np.inf
        # Stretched: |AD| = 9 = a2 + a3. theta1 as a double is not pi: 1.2e-16 off.
        got = evaluate([*ANGLES, *TANGENTS], stretched, branch)
        assert abs(got["v1"]) < 1e-16
        assert abs(got["joint_angle_3"]) < 1e-7
        assert abs(got["v3"]) < 1e-7
    got = evaluate(RESIDUALS, folded, 1)
    assert all(abs(value) <= 64 * UNIT_ROUNDING for value in got.values())


def exact_coefficients(a, b, c, d, pair):
    """Coefficients by elimination, with rational numbers: the equation as polynomial identity in cosines.

    Two neighbouring joints: the distance of the two far pivots. Two opposite joints: the diagonal.
    """
    lengths = [Fraction(float(value)) for value in (a, b, c, d)]
    i, j = (int(k) - 1 for k in pair)

    def value(x, y):
        # Homogeneous in half-angle tangents: cos = (1 - x^2)/(1 + x^2), times (1 + x^2)(1 + y^2).
        cx, sx, nx = 1 - x * x, 2 * x, 1 + x * x
        cy, sy, ny = 1 - y * y, 2 * y, 1 + y * y
        if j - i == 2:
            # Links on either side of the diagonal that joins the other two joints: i's links are i-1 and i.
            p, q = lengths[i - 1], lengths[i]
            r, s = lengths[j - 1], lengths[j]
            return (
                (p * p + q * q) * nx * ny
                + 2 * p * q * cx * ny
                - (r * r + s * s) * nx * ny
                - 2 * r * s * cy * nx
            )
        # Neighbouring joints i, j (joint 4 and joint 1 share link 4): the link between them is `middle`.
        if (i, j) == (0, 3):
            i_, x_, y_ = 3, (cy, sy, ny), (cx, sx, nx)
        else:
            i_, x_, y_ = i, (cx, sx, nx), (cy, sy, ny)
        before, middle, after, closing = (lengths[(i_ - 1 + k) % 4] for k in range(4))
        (c1, s1, n1), (c2, s2, n2) = x_, y_
        along = before * c1 * n2 + middle * n1 * n2 + after * n1 * c2
        across = -before * s1 * n2 + after * n1 * s2
        # The squared closing link, divided by the one factor n1 n2 that both sides share.
        total = along * along + across * across - closing * closing * (n1 * n2) ** 2
        return total / (n1 * n2)

    return value


@pytest.mark.parametrize("pair", PAIRS)
def test_io_coefficients_are_those_of_the_loop(pair):
    """The polynomial vanishes where the closing link of the loop has its length, with rational numbers."""
    rng = np.random.default_rng(32)
    for lengths in rng.integers(1, 30, (40, 4)):
        value = exact_coefficients(*lengths, pair)
        c = [Fraction(float(entry)) for entry in fl.planar.io_coefficients(design_of(*lengths), pair=pair)]
        ratios = set()
        for x, y in ((2, 3), (1, -1), (0, 5), (7, 0), (-3, 4), (0, 0), (1, 2)):
            x, y = Fraction(x), Fraction(y)
            polynomial = c[0] * x * x * y * y + c[1] * x * x + c[2] * y * y + c[3] * x * y + c[4]
            expected = value(x, y)
            assert (polynomial == 0) == (expected == 0)
            if expected != 0:
                ratios.add(polynomial / expected)
        # Equal up to one sign or number for all points.
        assert len(ratios) == 1, (lengths, pair)


def test_io_coefficients_broadcast_and_keep_their_digits_near_change_points():
    c = fl.planar.io_coefficients(
        design_of(np.linspace(0.4, 0.6, 3)[:, None], 1.2, [0.8, 0.9], 1.0), pair="13"
    )
    assert c.shape == (3, 2, 5)
    one = fl.planar.io_coefficients(design_of(0.5, 1.2, 0.9, 1.0), pair="13")
    np.testing.assert_array_equal(c[1, 1], one)
    lengths, _theta = near_change_point(np.random.default_rng(33), 50, 1e-13)
    got = fl.planar.io_coefficients(design_of(*lengths), pair="14")
    with mp.workdps(50):
        for k, (a, b, c_, d) in enumerate(lengths.T.tolist()):
            a, b, c_, d = (mp.mpf(value) for value in (a, b, c_, d))
            exact = (a + b - c_ - d) * (a - b - c_ - d)
            # Two factors right to a rounding each, and a product.
            assert abs(mp.mpf(float(got[k, 1])) - exact) <= 4 * UNIT_ROUNDING * abs(exact)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"pair": "41"}, "pair: '41' is unknown; known: "),
        ({"a2": 0.0}, "a2 is 0.0 .*; write a finite number greater than 0"),
        ({"a3": float("nan")}, "a3 is nan .*; write a finite number greater than 0"),
        ({"a4": "long"}, "a4 is 'long', not a number; write a number"),
        ({"a1": [1.0, 2.0], "a2": [1.0, 2.0, 3.0]}, "does not broadcast"),
    ],
)
def test_io_coefficients_say_what_is_wrong(arguments, message):
    given = {"a1": 1.0, "a2": 2.0, "a3": 2.5, "a4": 2.0} | arguments
    with pytest.raises(fl.InputError, match=message):
        fl.planar.io_coefficients(**given)
