"""Joint angles and half-angle tangents driven by theta1 or any joint: the six equations, and what the joints do."""

from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.support.configurations import DIGITS, LENGTHS, design_of, near_change_point, random_lengths

import fastlink as fl
from fastlink.facts.evaluate import read_facts
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING

JOINTS = (1, 2, 3, 4)
DRIVES = ("theta1", *(f"joint_angle_{k}" for k in JOINTS))
#: Coefficients of each equation by the factors of the paper, and that of its mixed term over a1 a3 or a2 a4.
EQUATIONS = {
    "12": ("A1B2 A2B1 C1D2 C2D1", (0, -8)),
    "13": ("A1B1 A2B2 C2D2 C1D1", (0, 0)),
    "14": ("A1A2 B1B2 C1C2 D1D2", (-8, 0)),
    "23": ("A1D2 B2C1 B1C2 A2D1", (-8, 0)),
    "24": ("A1C1 B2D2 A2C2 B1D1", (0, 0)),
    "34": ("A1C2 B1D2 A2C1 B2D1", (0, 8)),
}
#: Facts are algebra: with 50 digits, and configurations whose amplification is below 1e6, they agree to 1e-40.
EXACT = mp.mpf(10) ** -40


def configurations(drive, n):
    """Yield lengths and the facts of all joints of n configurations with 50 digits, away from dead points."""
    rng, known = np.random.default_rng(len(drive)), catalogue("planar_4r", drive)
    own = "1" if drive == "theta1" else drive[-1]
    kinds = ("joint_angle_{}", "v{}", "v{}_dot", "v{}_ddot", "joint_omega_{}", "joint_alpha_{}")
    names = [kind.format(k) for k in JOINTS for kind in kinds]
    names = [name for name in names if name in known.public and name not in known.inputs]
    speed = "omega1" if drive == "theta1" else f"joint_omega_{own}"
    while n:
        values = {name: float(x) for name, x in zip(LENGTHS, random_lengths(rng, 1)[:, 0], strict=True)}
        values |= {drive: rng.uniform(-np.pi, np.pi), speed: 3.0, "branch": 1 + n % 2}
        given = {name: mp.mpf(value) for name, value in values.items()}
        found = read_facts(known, names, given)
        found |= {f"joint_omega_{own}": mp.mpf(3), f"joint_alpha_{own}": mp.mpf(0)}
        found.setdefault(f"joint_angle_{own}", given[drive])
        if all(abs(mp.sin(found[f"joint_angle_{k}"])) > 0.01 for k in JOINTS):
            n -= 1
            yield given, found


def coefficients(a, b, c, d, pair):
    """Return the coefficients of an equation by the products of its factors."""
    factors = {
        "A": (a - b + c - d, a + b + c - d),
        "B": (a + b - c - d, a - b - c - d),
        "C": (a - b - c + d, a + b - c + d),
        "D": (a + b + c + d, a - b + c + d),
    }
    equation, (of_ac, of_bd) = EQUATIONS[pair]
    P, Q, R, S = (factors[t[0]][int(t[1]) - 1] * factors[t[2]][int(t[3]) - 1] for t in equation.split())
    return P, Q, R, of_ac * a * c + of_bd * b * d, S


@pytest.mark.parametrize("drive", DRIVES)
def test_the_six_equations_and_their_derivatives_hold(drive):
    """Equations (1) to (6), (7) and (8) of all pairs, with v'' = (theta'' + v theta'^2)(1 + v^2)/2."""
    with mp.workdps(DIGITS):
        for given, joints in configurations(drive, 6):
            a, b, c, d = (given[name] for name in LENGTHS)
            v, dv, ddv = {}, {}, {}
            for i in JOINTS:
                rate, bend = joints[f"joint_omega_{i}"], joints[f"joint_alpha_{i}"]
                x = v[str(i)] = joints[f"v{i}"]
                assert abs(x - mp.tan(joints[f"joint_angle_{i}"] / 2)) < EXACT * (1 + x**2)
                dv[str(i)] = rate * (1 + x**2) / 2
                ddv[str(i)] = (bend + x * rate**2) * (1 + x**2) / 2
                for name, slope in ((f"v{i}_dot", dv[str(i)]), (f"v{i}_ddot", ddv[str(i)])):
                    assert abs(joints[name] - slope) < EXACT * (1 + x**2) ** 2
            for i, j in EQUATIONS:
                P, Q, R, cross, S = coefficients(a, b, c, d, i + j)
                x, y, dx, dy, ddx, ddy = v[i], v[j], dv[i], dv[j], ddv[i], ddv[j]
                slope_x, slope_y = 2 * (P * y**2 + Q) * x + cross * y, 2 * (P * x**2 + R) * y + cross * x
                small = EXACT * (1 + x**2) ** 2 * (1 + y**2) ** 2
                assert abs(P * x**2 * y**2 + Q * x**2 + R * y**2 + cross * x * y + S) < small
                assert abs(slope_x * dx + slope_y * dy) < small
                second = 2 * (P * y**2 + Q) * dx**2 + 2 * (P * x**2 + R) * dy**2
                second += 2 * (4 * P * x * y + cross) * dx * dy
                assert abs(slope_x * ddx + slope_y * ddy + second) < small


@pytest.mark.parametrize("k", JOINTS)
def test_status_tells_whether_the_driven_joint_turns(k):
    lengths = random_lengths(np.random.default_rng(50 + k), 400)
    a, b, c, d = lengths
    gaps = np.abs([a - b + c - d, a + b - c - d, a - b - c + d, a + b + c - d, a - b - c - d, a + b - c + d])
    # The forbidden range of the angle is wider than a step where no gap of the lengths is small.
    lengths = lengths[:, gaps.min(axis=0) > 0.05]
    inputs = {name: values[:, None] for name, values in zip(LENGTHS, lengths, strict=True)}
    angles, names = {f"joint_angle_{k}": np.linspace(-np.pi, np.pi, 360)}, ["transmission_angle", "status"]
    driven = fl.evaluate("planar_4r", [*names, "grashof_class"], input=f"joint_angle_{k}", **inputs, **angles)
    closes = np.isfinite(driven["transmission_angle"])
    flags = catalogue("planar_4r", f"joint_angle_{k}").facts["status"].flags
    told = np.array([flags[int(code)] for code in driven["status"][:, 0]])
    kinds = ["rotates_fully", "never_assembles", "assembles_over_part_of_the_turn"]
    expected = np.select([closes.all(axis=1), ~closes.any(axis=1)], kinds[:2], kinds[2])
    assert_array_equal(told, expected)
    assert set(told) == set(kinds)
    # What belongs to the linkage does not depend on what drives.
    at_o = fl.evaluate("planar_4r", ["grashof_class"], theta1=0.0, **inputs)
    assert_array_equal(driven["grashof_class"][:, :1], at_o["grashof_class"])


def test_straight_joints_are_pi_and_infinite():
    """Folded and stretched positions whose figures are exact: no -pi, no NaN."""
    names = [name for k in JOINTS for name in (f"joint_angle_{k}", f"v{k}")]
    # |AD| = 1 = a3 - a2 at theta1 = 0: B beyond A on the line through D, the coupler folded on the output link
    folded = {"a1": 3.0, "a2": 4.0, "a3": 7.0, "a4": 6.0, "theta1": 0.0}
    # |AD| = 9 = a2 + a3; theta1 as a double is not pi: 1.2e-16 off
    stretched = {"a1": 3.0, "a2": 5.0, "a3": 4.0, "a4": 6.0, "theta1": np.pi}
    for branch in (1, 2):
        got = fl.evaluate("planar_4r", names, branch=branch, **folded)
        for name in names:
            assert got[name] == (np.pi if "angle" in name else np.inf)
        got = fl.evaluate("planar_4r", names, branch=branch, **stretched)
        assert abs(got["v1"]) < 1e-16
        assert abs(got["joint_angle_3"]) < 1e-7
        assert abs(got["v3"]) < 1e-7


def exact_equation(lengths, pair):
    """Return the equation by elimination as a function of two half-angle tangents, all rational.

    Two neighbouring joints: the distance of the two far pivots. Two opposite joints: the diagonal.
    """
    lengths, (i, j) = [Fraction(float(value)) for value in lengths], (int(k) - 1 for k in pair)

    def value(x, y):
        # Homogeneous in half-angle tangents: cos = (1 - x^2)/(1 + x^2), times (1 + x^2)(1 + y^2).
        at_i, at_j = (1 - x * x, 2 * x, 1 + x * x), (1 - y * y, 2 * y, 1 + y * y)
        if j - i == 2:
            # Links on either side of the diagonal that joins the other two joints: i's links are i-1 and i.
            (p, q), (r, s) = (lengths[i - 1], lengths[i]), (lengths[j - 1], lengths[j])
            one = (p * p + q * q) * at_i[2] + 2 * p * q * at_i[0]
            return one * at_j[2] - ((r * r + s * s) * at_j[2] + 2 * r * s * at_j[0]) * at_i[2]
        # Neighbouring joints (joint 4 and joint 1 share link 4): the link between them is `middle`.
        first, (c1, s1, n1), (c2, s2, n2) = (3, at_j, at_i) if (i, j) == (0, 3) else (i, at_i, at_j)
        before, middle, after, closing = (lengths[(first - 1 + k) % 4] for k in range(4))
        along = before * c1 * n2 + middle * n1 * n2 + after * n1 * c2
        across = -before * s1 * n2 + after * n1 * s2
        # The squared closing link, divided by the one factor n1 n2 that both sides share.
        return (along * along + across * across - closing * closing * (n1 * n2) ** 2) / (n1 * n2)

    return value


@pytest.mark.parametrize("pair", EQUATIONS)
def test_io_coefficients_are_those_of_the_loop(pair):
    """The polynomial vanishes where the closing link of the loop has its length, with rational numbers."""
    for lengths in np.random.default_rng(32).integers(1, 30, (40, 4)):
        value = exact_equation(lengths, pair)
        c = [Fraction(float(entry)) for entry in fl.planar.io_coefficients(design_of(*lengths), pair=pair)]
        assert c == [*coefficients(*map(int, lengths), pair)]
        ratios = set()
        for x, y in ((2, 3), (1, -1), (0, 5), (7, 0), (-3, 4), (0, 0), (1, 2)):
            x, y = Fraction(x), Fraction(y)
            polynomial = c[0] * x * x * y * y + c[1] * x * x + c[2] * y * y + c[3] * x * y + c[4]
            assert (polynomial == 0) == (value(x, y) == 0)
            if polynomial:
                ratios.add(polynomial / value(x, y))
        # Equal up to one sign or number for all points.
        assert len(ratios) == 1, (lengths, pair)


def test_io_coefficients_broadcast_and_keep_their_digits_near_change_points():
    design = design_of(np.linspace(0.4, 0.6, 3)[:, None], 1.2, [0.8, 0.9], 1.0)
    c = fl.planar.io_coefficients(design, pair="13")
    assert c.shape == (3, 2, 5)
    assert_array_equal(c[1, 1], fl.planar.io_coefficients(design_of(0.5, 1.2, 0.9, 1.0), pair="13"))
    lengths, _theta = near_change_point(np.random.default_rng(33), 50, 1e-13)
    got = fl.planar.io_coefficients(design_of(*lengths), pair="14")
    for k, one in enumerate(lengths.T.tolist()):
        a, b, c_, d = map(Fraction, one)
        exact = (a + b - c_ - d) * (a - b - c_ - d)
        # Two factors right to a rounding each, and a product.
        assert abs(Fraction(float(got[k, 1])) - exact) <= 4 * UNIT_ROUNDING * abs(exact)


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
    with pytest.raises(fl.InputError, match=message):
        fl.planar.io_coefficients(**{"a1": 1.0, "a2": 2.0, "a3": 2.5, "a4": 2.0} | arguments)
