"""Section 3 of the paper by its own symbols, against its formulas as they are printed, with 60 digits."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

import fastlink as fl
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING

FLAGS = {name: of.flags for name, of in catalogue("minkowski_4r").public.items() if of.flags}
NAMES = [
    *("coefficient_A", "coefficient_B", "coefficient_C", "psi", "psi_remark", "delta", "half_angle_root"),
    *("CB_orientation", "r_AX", "s_BX", "gamma", "lambda_AX", "mu_BX", "AB_orientation", "X_x", "X_y"),
    *("remark_status", "coupler_angles_status", "configuration_status"),
]
N = 300


def number(value):
    return mp.mpf(float(value))


@pytest.fixture(scope="module")
def drawn():
    """Configurations of every kind; the coupler point with AX and BX of every causal type."""
    rng = np.random.default_rng(31)
    inputs = dict(zip("abgh", rng.uniform(0.3, 3.0, (4, N)), strict=True)) | {
        "theta": rng.uniform(-2.0, 2.0, N)
    }
    inputs |= dict(zip("xy", rng.uniform(-3.0, 3.0, (2, N)), strict=True))
    inputs["h"][::3] += 2.0  # the Remark's form needs h > b
    branch = rng.integers(1, 3, N)
    return inputs | {"branch": branch}, fl.evaluate("minkowski_4r", NAMES, branch=branch, **inputs)


def each(drawn):
    """Yield inputs and values of each configuration that closes."""
    inputs, found = drawn
    for k in np.flatnonzero(np.isfinite(found["psi"])):
        given = {name: number(values[k]) for name, values in inputs.items()}
        yield given, {name: number(values[k]) for name, values in found.items()}


def printed(given):
    """A, B and C of Theorem 3.1, and the sizes of their terms."""
    a, b, g, h, theta = (given[name] for name in ("a", "b", "g", "h", "theta"))
    A, B = 2 * g * b - 2 * a * b * mp.cosh(theta), 2 * a * b * mp.sinh(theta)
    C = h**2 - g**2 - b**2 - a**2 + 2 * a * g * mp.cosh(theta)
    return A, B, C


def test_coefficients_and_roots_of_theorem_3_1(drawn):
    tested = 0
    with mp.workdps(60):
        for given, found in each(drawn):
            a, b, g, h, theta = (given[name] for name in ("a", "b", "g", "h", "theta"))
            A, B, C = printed(given)
            most = 2 * a * b * mp.cosh(theta) + 2 * a * g * mp.cosh(theta) + (a + b + g + h) ** 2
            # At most 6 operations on terms below `most`; the hyperbolic functions are within a unit.
            for name, true in (("A", A), ("B", B), ("C", C)):
                assert abs(found[f"coefficient_{name}"] - true) <= 8 * UNIT_ROUNDING * most
            sign = 1 if given["branch"] == 1 else -1
            root = (-B + sign * mp.sqrt(B * B + C * C - A * A)) / (A + C)  # eq. (3)
            assert abs(found["half_angle_root"] - root) <= mp.mpf("1e-9") * abs(
                root
            )  # the root, not its digits
            # eq. (6), with the orientation that the paper does not have
            CB = found["CB_orientation"]
            terms = A * CB * mp.cosh(found["psi"]), B * CB * mp.sinh(found["psi"])
            assert abs(sum(terms) - C) <= 40 * UNIT_ROUNDING * (mp.cosh(found["psi"]) + 1) * most * (
                1 + abs(found["psi"])
            )
            tested += 1
    assert tested > N // 2


def test_the_closed_form_of_the_remark_and_where_it_holds(drawn):
    held, not_held = 0, 0
    with mp.workdps(60):
        for given, found in each(drawn):
            A, B, C = printed(given)
            size = A * A - B * B
            assert np.isnan(float(found["delta"])) == (not abs(B) < A)
            status = FLAGS["remark_status"][int(found["remark_status"])]
            if not abs(B) < A:
                assert status == "A_not_above_the_size_of_B"
            elif C < 0:
                assert (status, found["CB_orientation"]) == ("CB_past_pointing", -1)
            else:
                assert (status, found["CB_orientation"]) == ("holds", 1)
                delta, arch = mp.atanh(B / A), mp.acosh(C / mp.sqrt(size))
                sign = 1 if given["branch"] == 1 else -1
                true = -delta + sign * arch
                # Both angles are right to 12 roundings of what they were computed from.
                far = 1 + (abs(A) + abs(B)) / mp.sqrt(size) + (C / mp.sqrt(size)) / mp.sqrt(C * C / size - 1)
                allowed = 50 * UNIT_ROUNDING * far * (1 + abs(delta) + arch)
                assert abs(found["delta"] - delta) <= allowed
                assert abs(found["psi_remark"] - true) <= allowed
                assert abs(found["psi_remark"] - found["psi"]) <= allowed
                held += 1
                continue
            assert mp.isnan(found["psi_remark"])
            not_held += 1
    assert held > N // 20
    assert not_held > N // 4


def test_the_coupler_triangle_and_its_circles(drawn):
    """r, s, gamma, lambda, mu by their definitions, then eqs. (10), with b, and (11)."""
    circles = 0
    with mp.workdps(60):
        for given, found in each(drawn):
            a, b, g, h, x, y = (given[name] for name in "abghxy")
            r, s, lam, mu, gamma = (found[name] for name in ("r_AX", "s_BX", "lambda_AX", "mu_BX", "gamma"))
            assert abs(r - mp.sqrt(abs(x * x - y * y))) <= 4 * UNIT_ROUNDING * r
            far = 1 + (abs(x) + h + abs(y)) ** 2 / s**2 + (abs(x) + abs(y)) ** 2 / r**2
            assert abs(s - mp.sqrt(abs((x - h) ** 2 - y * y))) <= 4 * UNIT_ROUNDING * s * far
            assert abs(mu - lam - gamma) <= 20 * UNIT_ROUNDING * (far + abs(lam) + abs(mu))
            if x * x <= y * y or (x - h) ** 2 <= y * y:
                continue
            X, Y, points = found["X_x"], found["X_y"], found["AB_orientation"]
            AX = [points * mp.sign(x) * r * of(lam) for of in (mp.cosh, mp.sinh)]
            BX = [points * mp.sign(x - h) * s * of(mu) for of in (mp.cosh, mp.sinh)]
            for vector, place, radius in ((AX, 0, a), (BX, g, b)):  # eqs. (11), (10)
                one, other = X - vector[0] - place, Y - vector[1]
                size = (abs(X) + abs(vector[0]) + place + abs(Y) + abs(vector[1])) ** 2
                assert abs(one**2 - other**2 - radius**2) <= 60 * UNIT_ROUNDING * far * size * (
                    1 + abs(lam) + abs(mu)
                )
            circles += 1
    assert circles > N // 8


def test_what_a_lightlike_side_leaves_undefined():
    design = {"a": 1.0, "b": 1.0, "g": 4.0, "h": 1.0, "theta": 1.7}
    names = ["r_AX", "s_BX", "gamma", "lambda_AX", "mu_BX", "coupler_angles_status"]
    at = fl.evaluate("minkowski_4r", names, **design, x=[0.75, 1.5, 0.0, 0.25], y=[0.75, -0.5, 0.0, 0.125])
    told = [FLAGS["coupler_angles_status"][int(code)] for code in at["coupler_angles_status"]]
    assert told == ["AX_lightlike", "BX_lightlike", "AX_lightlike", "there"]
    np.testing.assert_array_equal(np.isnan(at["gamma"]), [True, True, True, False])
    np.testing.assert_array_equal(np.isnan(at["lambda_AX"]), [True, False, True, False])
    np.testing.assert_array_equal(np.isnan(at["mu_BX"]), [False, True, False, False])
    np.testing.assert_array_equal(at["r_AX"] == 0.0, [True, False, True, False])
